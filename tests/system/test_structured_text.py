# SPDX-License-Identifier: Apache-2.0
"""examples/edmd.st is the program of the PLC on edmd's bus."""

import json
import struct
import sys

import can_bus
import pytest
import rig
from can_bus import NODE

ROOT = can_bus.HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests/vm/guest"))
import st  # noqa: E402

TEXT = (ROOT / "examples/edmd.st").read_text()
SET_BY_PLC = """
[plc]
interface = can0
alive_ms = 5000
m_before = 6
m_timeout_s = 0
[generator]
interface = plc
servo_v = plc
silent_ms = 5000
confirm_s = 20
[tech]
table = shop.tech
"""
TABLE = """condition, peak_a [A], on_us [us], off_us [us], ignition_v [V], servo_v [V], polarity
C200, 6, 8, 20, 180, 15, -1
C100, 12, 20, 50, 120, 22.5, 1
C300, 9, 20, -, -, 22.5, 1
"""
OWN = {"OwnOffTime": 300, "OwnVoltage": 900, "OwnServo": 200}
VALUES = ("Current", "OnTime", "OffTime", "Voltage")
JOB = b"G21 G90 F60\nC200 G1 X1\nT3 M6\nC100\nG1 X40\nM30\n"


class Bus(can_bus.Bus):
    """Keeps the last frame of each identifier."""

    def __init__(self, folder):
        self.last = {}
        super().__init__(folder)

    def send(self, data, who=None):
        can_id, _, body = can_bus.FRAME.unpack(data)
        self.last[can_id] = body
        super().send(data, who)


class Plc:
    """It scans both blocks; the generator and the changer need some scans."""

    def __init__(self, bus, pause_s=0.02):
        self.bus, self.bits = bus, can_bus.PERMIT
        self.in_holder, self.left, self.log = 1, 5, []
        self.real, self.anew = [0] * 7, True
        bus.loop(self.scan, pause_s)

    def begin(self):
        self.changer = st.Block(TEXT, "EdmdChanger")
        self.setter = st.Block(TEXT, "EdmdGenerator")
        self.busy, self.read, self.anew = 0, None, False

    def scan(self):
        f = self.bus.last
        if self.anew:
            self.begin()
        # Heartbeats until it is operational.
        if f.get(0x700 + NODE, b"\5")[0] != 5:
            self.bus.tell(0, bytes((1, NODE)))
        if {0x180 + NODE, 0x500 + NODE, 0x680 + NODE} <= f.keys():
            self.change(f)
            self.set(f)
        self.bits ^= can_bus.ALIVE
        self.bus.tell(0x200 + NODE, can_bus.REQUEST.pack(
            self.bits, can_bus.LOCKS, 1000, 0, self.changer["McodeDone"], 0))
        self.bus.tell(0x300 + NODE, struct.pack(
            "<HHBH", self.setter["InForce"], 0, self.real[5] | self.real[6] << 1,
            self.real[4]))
        self.bus.tell(0x400 + NODE, struct.pack("<4H", *self.real[:4]))

    def change(self, f):
        electrode, = struct.unpack_from("<H", f[0x500 + NODE])
        self.changer.scan(McodeWaiting=f[0x180 + NODE][3], Electrode=electrode,
                          InHolder=self.in_holder)
        if self.changer["PutIn"]:
            self.left -= 1
            self.in_holder = electrode if self.left == 0 else self.in_holder
        if self.changer["McodeDone"]:
            assert self.in_holder == electrode

    def set(self, f):
        b, was = self.setter, self.setter["Given"]
        number, bits = struct.unpack_from("<HB", f[0x500 + NODE], 5)
        values = struct.unpack("<4H", f[0x680 + NODE])
        b.scan(Asked=number, AskedNegative=bits & 1, AskedIso=bits >> 1 & 1,
               HasServo=1, ServoRead=self.read is not None,
               AskedServo=self.read or 0, Ready=self.busy == 0, **OWN,
               **{"Asked" + v: x for v, x in zip(VALUES, values)})
        self.busy -= self.busy > 0
        if b["Given"] not in (was, 0):
            self.busy = 3
            self.real = [b["Gen" + v] for v in
                         (*VALUES, "Servo", "Negative", "Iso")]
            self.log.append(self.real)
        self.read = self.sdo(f) if b["ReadServo"] else None

    def sdo(self, f):
        """2002:05; asked for anew until the answer is there."""
        if answer := f.pop(0x580 + NODE, None):
            assert answer[:4] == bytes((0x4b, 0x02, 0x20, 5)), answer
            return struct.unpack_from("<H", answer, 4)[0]
        if self.read is None:
            self.bus.tell(0x600 + NODE, bytes((0x40, 0x02, 0x20, 5)).ljust(8, b"\0"))
        return self.read


@pytest.fixture(params=[0.02, 0.2])
def shop(tmp_path, request):
    with Bus(tmp_path) as bus, rig.Machine(
            tmp_path, rig.NULL_MACHINE + SET_BY_PLC) as m:
        m.env = lambda program: bus.env()
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        assert m.ctl("electrode", "add", "3", "name=rib").returncode == 0
        yield m, Plc(bus, request.param)


def told(m):
    o = json.loads(m.ctl("--json", "generator").stdout)
    return o["in_force"], {f["name"]: f["told"] for f in o["fields"]}


def test_it_sets_the_generator_and_changes_the_electrode(shop):
    m, plc = shop
    c = m.client
    rig.until(lambda: c.submit(JOB, "work").code == 0)
    c.status_where(lambda s: s.line == 5, 60)
    assert (plc.in_holder, plc.left) == (3, 0)
    rig.until(lambda: told(m) == (True, {
        "peak_a": 12, "on_us": 20, "off_us": 50, "ignition_v": 120,
        "polarity": 1, "iso": 0, "servo_v": 22.5}), 20)
    # C200 of the paper came whole.
    assert [60, 80, 200, 1800, 150, 1, 0] in plc.log


def test_what_a_condition_does_not_give_is_the_generators_own(shop):
    m, plc = shop
    # Before the first job all of it is.
    rig.until(lambda: plc.real == [0, 0, 300, 900, 200, 0, 0], 20)
    text = b"G21 G90 F60\nC300 G1 X40\nM30\n"
    rig.until(lambda: m.client.submit(text, "work").code == 0)
    rig.until(lambda: plc.real == [90, 200, 300, 900, 225, 0, 0], 20)
    rig.until(lambda: told(m)[0], 20)


def test_after_edmd_was_killed_in_a_change_the_place_is_what_it_has(shop):
    """A number of before is no answer: the PLC goes on as if nothing were."""
    m, plc = shop
    c = m.client
    rig.until(lambda: c.submit(JOB, "work").code == 0)
    rig.until(lambda: plc.log and plc.log[-1][0] == 120, 20, step=0.001)
    m.kill("edmd")
    m.start_edmd()
    c.status_where(lambda s: s.daemon == "ok", 20)
    rig.until(lambda: told(m)[0], 10)
    assert plc.setter["InForce"] == plc.setter["Given"] != 0


def test_each_side_is_started_anew_while_the_electrode_is_changed(shop):
    m, plc = shop
    plc.left = 20
    rig.until(lambda: m.client.submit(JOB, "work").code == 0)
    rig.until(lambda: goes_on(m, lambda s: plc.left < 18), 60)
    plc.anew = True
    rig.until(lambda: not plc.anew)
    m.kill("edmd")
    m.start_edmd()
    # With the right electrode, which the scans assert, and the condition behind it.
    rig.until(lambda: goes_on(m, lambda s: s["line"] == 5), 60)
    assert plc.in_holder == 3
    plc.anew = True
    rig.until(lambda: goes_on(m, lambda s: told(m)[0] and plc.real[0] == 120), 60)


def goes_on(m, reached):
    s = json.loads(m.ctl("--json", "status").stdout or '{"line": 0}')
    return reached(s) or (m.ctl("reset") and m.ctl("start") and False)
