# SPDX-License-Identifier: Apache-2.0
"""Drives that refuse what CiA 301 and 402 let them refuse, in virtual time.

They are guest/strict.py; guest/can402_strict.py did things to them.
"""
import json
import math

import pytest
from boot import DRIVES



class Seen:
    """Rows: time, sparks, and of each drive state, true place, count, mode."""

    def __init__(self, run, name):
        self.d = json.loads(run.text(f"{name}.json"))
        self.rows = [(t, flags & 1, drives)
                     for t, flags, drives in self.d["rows"]]
        self.marks = [what for _, what in self.d["marks"]]
        self.at = {what: t for t, what in self.d["marks"]}
        self.log = run.text(f"{name}.log")

    def between(self, a, b):
        return [r for r in self.rows if self.at[a] <= r[0] <= self.at[b]]

    def since(self, mark, what, end):
        """Rows from the first SYNC on after the drives were told @what, which
        takes as long from the @mark as it takes."""
        first = next(row for t, row, came in self.d["came"]
                     if t >= self.at[mark] and came == what)
        return [r for r in self.rows[first:] if r[0] <= self.at[end]]

    def went_as_planned(self):
        assert not [m for m in self.marks if "in vain" in m], \
            (self.marks, self.log)
        assert self.d["edmd"] == 0


def true_places(rows):
    return [[d[1] for d in r[2]] for r in rows]


@pytest.fixture(scope="module")
def up(strict):
    return Seen(strict, "strict-up")


@pytest.fixture(scope="module")
def faults(strict):
    return Seen(strict, "strict-faults")


@pytest.fixture(scope="module")
def attack(strict):
    return Seen(strict, "strict-attack")


def test_strict_drives_come_up_and_end_where_the_pulses_do(up):
    up.went_as_planned()
    assert "program 1 ended: done" in up.log
    pos = up.d["status"]["pos_mm"]
    assert pos[:4] == [0.2, 0.1, -0.1, -0.4]
    want = [1000 * DRIVES[a][0] + math.floor(
        round(pos["XYZABCUV".index(a)] * 1000) * DRIVES[a][1] / DRIVES[a][2])
        for a in "XYZA"]
    assert true_places(up.rows)[-1] == want


def test_nothing_is_asked_that_a_drive_must_refuse(up):
    """But for objects it does not have, what it cannot map, and the unit of
    60C2, which may be read-only."""
    assert {(code, what) for _, what, code in up.d["aborts"]
            if code not in ("06020000", "06040041")} <= {
        ("06010002", "60c2:2")}, up.d["aborts"]


def test_what_a_drive_lacks_is_told_in_words(up):
    assert ("drive Y (node 2): object 1a00:03, value 60610008, code 06040041: "
            "object cannot be mapped; goes on without") in up.log
    assert "drive Y (node 2) does not send its mode (6061)" in up.log
    assert "object 1006:00, value 2710, code 06020000: no such object" in up.log


@pytest.mark.parametrize("text", [
    "drive X (node 1): object 60c2:01, value a, code 06090030: "
    "value out of range",
    "drive Y (node 2) refuses object 605a:00, value 6, code 06090030: "
    "value out of range",
    "drive Z (node 3): object 1018:01 is bad, which does not go with the "
    "machine file",
    "drive A (node 4) refuses object 1016:01, value 0, code 06020000: "
    "no such object",
])
def test_a_refusal_is_told_with_object_value_code_and_words(strict, text):
    seen = Seen(strict, "strict-refused")
    seen.went_as_planned()
    assert text in seen.log


def test_nothing_starts_when_a_drive_is_switched_on_late(strict):
    seen = Seen(strict, "strict-late")
    seen.went_as_planned()
    before = seen.between("on", "start")
    assert len(before) > 200
    assert all(not r[1] for r in before), "sparks without a start"
    assert all(r[2][0][0] != "enabled" for r in before)
    assert len({tuple(p) for p in true_places(before)}) == 1
    assert seen.d["start"][0] == 0


# What is done, its fault, SYNCs until sparks are off.
FAULTS = [("mode", "drive", 3), ("ignores", "drive", 3),
          ("lags", "following", 3), ("limit", "drive", 14),
          ("jam", "following", 25)]
TOLD = {"mode": "mode", "ignores": "bits", "lags": "bits", "limit": "clip",
        "jam": "jam"}


def test_the_plan_was_done(faults):
    faults.went_as_planned()


@pytest.mark.parametrize("what, fault, syncs", FAULTS)
def test_what_the_drive_shows_ends_the_sparks(faults, what, fault, syncs):
    assert faults.d["out"][what]["fault"] == fault
    after = faults.since(f"{what}: harm", TOLD[what], f"{what}: stands")
    off = next(i for i, r in enumerate(after) if not r[1])
    print(f"{what}: sparks off after {off} SYNCs")
    assert off <= syncs
    assert not any(r[1] for r in after[off:])


@pytest.mark.parametrize("what, fault, syncs", FAULTS)
def test_the_job_goes_on_by_reset_and_start(faults, what, fault, syncs):
    out = faults.d["out"][what]
    assert out["reset"][0] == 0 and out["start"][0] == 0, out
    held = faults.between(f"{what}: stands", f"{what}: start")
    assert all(d[0] != "enabled" and not r[1] for r in held for d in r[2])


def test_mode_8_is_written_again_by_a_reset(faults):
    rows = faults.between("mode: start", "ignores: cutting")
    assert rows[-1][2][0][3] == 8
    assert "drive X (node 1) is not in mode 8" in faults.log


def test_a_following_error_is_seen_before_it_is_as_wide_as_the_gap(faults):
    """following_mm is 0.05: both axes are within 0.1 mm of the path."""
    before = faults.between("jam: cutting", "jam: harm")[-1]
    still = faults.between("jam: stands", "jam: start")[-1]
    pulses = [abs(a[1] - b[1]) * DRIVES[x][2] / abs(DRIVES[x][1])
              for x, a, b in zip("XY", before[2], still[2])]
    print("jam: X, Y moved by", pulses)
    assert pulses[0] < 100


def test_a_warning_is_told_and_stops_nothing(faults):
    assert faults.d["out"]["warning"]["state"] in ("approach", "erode")
    assert "warns: statusword 12b7, bit 7" in faults.log
    # A drive that goes along with its target is not clipped.
    assert faults.d["out"]["at its limit"]["state"] in ("approach", "erode")
    assert "bit 11: at an internal limit" in faults.log
    assert "drive X (node 1): emergency 3283" in faults.log


def never_moves_unplaced(seen, what, out, node):
    """From the power cut to the operator's word that it is where it is."""
    assert out["fault"] in ("drive", "following"), out
    assert all(s[0] != 0 for s in out["starts"] + out["steps"]), out
    assert out["home"][0] == 0, out
    assert out["again"][0] == 0, out
    rows = seen.since(f"{what}: harm", "off", f"{what}: homed")
    assert all(not r[1] for r in rows[6:]), "sparks with an unknown place"
    lost = next(i for i, r in enumerate(rows) if r[2][node - 1][0] in
                ("off", "not-ready", "disabled"))
    true = [r[2][node - 1][1] for r in rows[lost:]]
    pushed = len(set(true)) - 1
    assert pushed <= 1, "it moved with an unknown place"
    # Under power it comes by the home alone, which is the operator's.
    before = seen.since(f"{what}: harm", "off", f"{what}: idle")
    assert all(r[2][node - 1][0] not in ("enabled", "on")
               for r in before[lost:]), "under power with an unknown place"


def test_a_drive_that_was_off_is_not_moved_before_it_is_homed(faults):
    never_moves_unplaced(faults, "off", faults.d["out"]["off"], 2)
    assert "drive Y (node 2) was switched off: its place is lost" in faults.log


def test_power_cycles_at_any_time_never_move_or_spark(attack):
    attack.went_as_planned()
    assert len(attack.d["done"]) >= 1
    for i, out in enumerate(attack.d["done"]):
        never_moves_unplaced(attack, f"attack {i}", out, out["node"])


STEP_MM = 0.06      # feed_max_mm_s is 5: 0.05 mm in a period


def test_whatever_is_on_the_bus_nothing_sparks_or_leaps(strict):
    """Storms, wrong lengths, a second drive with the same node, NMT of others,
    bus off: each may end the cut, and the operator gets back to it."""
    seen = Seen(strict, "strict-noise")
    for done in seen.d["done"]:
        print(*done)
    seen.went_as_planned()
    ill = 0
    for (_, _, was), (t, sparks, now) in zip(seen.rows, seen.rows[1:]):
        well = all(d[0] == "enabled" and d[3] == 8 for d in now)
        ill = 0 if well else ill + 1
        assert not (sparks and ill > 4), (t, now)
        for axis, a, b in zip("XY", was, now):
            _, per, pulses = DRIVES[axis]
            mm = abs((b[1] - a[1]) * pulses / per / 1000)
            assert mm <= STEP_MM, (t, axis, mm, seen.log)
    # What says nothing of a fault ends no cut.
    for what, state, fault in seen.d["done"]:
        if what in ("storm", "lengths", "answers", "strange_ids"):
            assert fault == "none", (what, state, fault, seen.log)
