# SPDX-License-Identifier: Apache-2.0
"""examples/edmd.st, scan by scan, with an edmd that asks at random."""

import random
import sys

import pytest
from edmsim import ROOT

sys.path.insert(0, str(ROOT / "tests/vm/guest"))
import st  # noqa: E402

TEXT = (ROOT / "examples/edmd.st").read_text()
VALUES = ("Current", "OnTime", "OffTime", "Voltage", "Servo")
SCANS = 20000
OWN = {v: 8 + i for i, v in enumerate(VALUES)}
NOT_GIVEN = 65535


class Image:
    """Frames as a PLC sees them: those that came while it looked are there by half."""

    def __init__(self, rnd):
        self.rnd, self.before = rnd, (None, None)

    def of(self, now):
        """(values, number) of this scan."""
        torn = self.before[1] is not None and self.rnd.random() < 0.3
        seen = (self.before[0], now[1]) if torn else now
        self.before = now
        return seen


def test_the_changer_answers_when_the_electrode_is_in():
    rnd, b = random.Random(1), st.Block(TEXT, "EdmdChanger")
    image = Image(rnd)
    waiting = in_holder = electrode = busy = changes = stood = 0
    for _ in range(SCANS):
        if rnd.random() < 0.002:        # the PLC was switched off
            b = st.Block(TEXT, "EdmdChanger")
        number, asked = image.of((electrode, waiting))
        b.scan(McodeWaiting=asked, Electrode=number, InHolder=in_holder)
        if b["McodeDone"]:
            assert in_holder == electrode and not b["PutIn"]
        busy = busy + 1 if b["PutIn"] else 0
        if busy == 5:
            in_holder, changes = electrode, changes + 1
        stood = stood + 1 if waiting else 0
        assert stood < 40
        # edmd: the answer is taken, and must go before the next code.
        if waiting and b["McodeDone"] == waiting:
            waiting = 0
        elif not waiting and not b["McodeDone"] and rnd.random() < 0.3:
            waiting, electrode = 6, rnd.randrange(1, 5)
    assert changes > 100


class Edmd:
    """The servo's voltage is what it is when it is read.  After 0 its numbers may
    begin anew, once that was answered."""

    def __init__(self, rnd):
        self.rnd, self.number, self.asked = rnd, 0, {}
        self.ask(0)

    def ask(self, in_force):
        if self.number and self.rnd.random() < 0.1:
            self.number = 0
        elif self.number or in_force == 0:
            self.number = self.number + 1
        self.asked = {v: self.rnd.randrange(8) for v in VALUES}
        for v in OWN:
            if self.rnd.random() < 0.2:
                self.asked[v] = NOT_GIVEN

    def means(self, v):
        return OWN[v] if self.asked[v] == NOT_GIVEN else self.asked[v]

    def frames(self):
        return {"Asked" + v: self.asked[v] for v in VALUES[:4]}, self.number


class Read:
    """By SDO: it begins when it is wanted, is late, may fail, and says that it has
    ended for some scans longer, also if it is not wanted any more."""

    def __init__(self, rnd):
        self.rnd, self.left, self.value, self.end = rnd, None, 0, ""

    def scan(self, wanted, now):
        if self.left is None and wanted and not self.end:
            self.left = self.rnd.randrange(6)
        elif self.left:
            self.left -= 1
            self.value = now if self.rnd.random() < 0.7 else self.value
        elif self.left == 0:
            self.left = None
            self.value = now if self.value is None else self.value
            self.end = "ServoRead" if self.rnd.random() < 0.9 else "ServoFailed"
        elif self.end and not wanted and self.rnd.random() < 0.5:
            self.end, self.value = "", None


@pytest.mark.parametrize("servo", [0, 1])
def test_a_number_is_answered_while_the_generator_has_its_values(servo):
    rnd, b = random.Random(2), st.Block(TEXT, "EdmdGenerator")
    edmd, image, read = Edmd(rnd), Image(rnd), Read(rnd)
    real, left, answered, lost, stood, settled = {}, 0, 0, 0, 0, 0
    values = VALUES[:len(VALUES) - 1 + servo]
    for _ in range(SCANS):
        seen, number = image.of(edmd.frames())
        b.scan(**seen, Asked=number, HasServo=servo, Ready=left == 0,
               AskedServo=read.value or 0,
               **{"Own" + v: x for v, x in OWN.items()},
               **{e: e == read.end for e in ("ServoRead", "ServoFailed")})
        left -= left > 0
        wants = {v: b["Gen" + v] for v in VALUES}
        if b["Given"] and wants != settled:
            real, left, settled = wants, 3, wants
        if b["InForce"] == edmd.number != 0:
            assert left == 0
            assert all(real[v] == edmd.means(v) for v in values)
            answered += 1
        read.scan(b["ReadServo"], edmd.asked["Servo"])
        # It never stands for ever.
        stood = stood + 1 if b["InForce"] != edmd.number else 0
        assert stood < 200
        if rnd.random() < 0.01:         # the generator was switched off, and on
            real, left, settled, lost = {}, 4, 0, lost + 1
        if rnd.random() < 0.05:
            edmd.ask(b["InForce"])
    assert answered > 1000 and lost > 100


@pytest.mark.parametrize("was, now, odd", [
    (":= Asked;", ":= Aksed;", "'Aksed' as a name"),
    ("Given := 0", "Asked := 0", "Asked is an input"),
    ("END_IF;", "END_IF", "where ; belongs"),
    ("Given := 0", "Given := 70000", "Given cannot be 70000"),
    ("Given := 0", "Given := 1 + 1", "'+'"),
    ("Asked = 0 THEN", "Asked = 0", "where THEN belongs"),
    ("InForce : UINT;", "InForce : LREAL;", "'LREAL' where"),
])
def test_what_is_not_this_language_is_refused(was, now, odd):
    head, tail = TEXT.split("FUNCTION_BLOCK EdmdGenerator")
    tail = tail.replace(was, now, 1)
    with pytest.raises(st.Odd, match=odd.replace("+", r"\+")):
        st.Block(head + "FUNCTION_BLOCK EdmdGenerator" + tail,
                 "EdmdGenerator").scan(Asked=0)
