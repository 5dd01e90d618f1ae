# SPDX-License-Identifier: Apache-2.0
"""CiA 402 drives played by canopen on vcan0, in virtual time.

What the drives saw is judged here; guest/can402.py did it to them.
"""
import json
import math

import pytest
from boot import DRIVES
from test_plain import lit

MOVING = ("enabled", "stopping", "reacting")
PERIOD_S = 0.01


class Seen:
    def __init__(self, run, name):
        d = json.loads(run.text(f"{name}.json"))
        self.rows = [(t, flags & 1, [state for state, _ in drives],
                      [place for _, place in drives])
                     for t, flags, drives in d["rows"]]
        self.at = {what: t for t, what in d["marks"]}
        self.marks = [what for _, what in d["marks"]]
        self.d, self.log = d, run.text(f"{name}.log")

    def between(self, a, b):
        return [r for r in self.rows if self.at[a] <= r[0] <= self.at[b]]

    def since(self, mark, what):
        """Rows from the first SYNC on after @what, a line of what the drives
        were told or heard.  This does not depend on how long it took to get
        there from the @mark."""
        return self.rows[next(row for t, row, came in self.d["came"]
                              if t >= self.at[mark] and
                              came.startswith(what)):]

    def went_as_planned(self):
        assert not [m for m in self.marks if "in vain" in m], self.log
        assert self.d["edmd"] == 0


@pytest.fixture(scope="module")
def faults(can402):
    return Seen(can402, "faults")


def increments(axis, mm):
    _, per, pulses = DRIVES[axis]
    return math.floor(round(mm * 1000) * per / pulses)


def stands_at(seen, axes):
    """Each drive is where the machine's last pulse says, to the increment."""
    pos = seen.d["status"]["pos_mm"]
    at = [1000 * DRIVES[a][0] + increments(a, pos["XYZABCUV".index(a)])
          for a in axes]
    print(f"{axes}: pulses {[round(p * 1000) for p in pos]}, increments {at}")
    assert seen.rows[-1][3] == at


def test_the_kernel_has_nothing_to_complain_of(can402):
    assert "PREEMPT_RT" in can402.text("uname")
    assert can402.text("kernel") == ""


@pytest.mark.parametrize("name, axes, end", [
    ("two", "XY", [0.5, 0.25]),
    ("six", "XYZABC", [0.2, 0.1, -0.1, -0.4, 0.5, 0.1]),
])
def test_a_job_from_boot_to_end_leaves_drives_where_the_pulses_do(
        can402, name, axes, end):
    seen = Seen(can402, name)
    seen.went_as_planned()
    assert "program 1 ended: done" in seen.log
    assert seen.d["status"]["pos_mm"][:len(axes)] == end
    stands_at(seen, axes)


@pytest.mark.parametrize("name", ["two", "six", "faults"])
def test_nothing_moves_that_is_not_enabled(can402, name):
    rows = Seen(can402, name).rows
    enabled = 0
    for (_, _, states, was), (_, _, _, now) in zip(rows, rows[1:]):
        for state, a, b in zip(states, was, now):
            assert state in MOVING or a == b
            enabled += state == "enabled"
    assert enabled > 100


@pytest.mark.parametrize("name", ["two", "six", "faults"])
def test_enabling_moves_nothing_far(can402, name):
    """resync_mm_s is 1 mm/s: 10 pulses in a period, at the most."""
    rows = Seen(can402, name).rows
    nodes = {DRIVES[a][0]: a for a in DRIVES}
    seen = 0
    for (_, _, states, was), (_, _, after, now) in zip(rows, rows[1:]):
        for i, (before, state) in enumerate(zip(states, after)):
            if before == "enabled" or state != "enabled":
                continue
            _, per, pulses = DRIVES[nodes[i + 1]]
            assert abs(now[i] - was[i]) <= abs(11 * per / pulses) + 1
            seen += 1
    assert seen >= len(rows[0][2])


def off_the_circle(run, name):
    """How far the drives were from it, at most, in mm."""
    seen = Seen(run, name)
    seen.went_as_planned()
    assert "program 1 ended: done" in seen.log
    mm = [[(p - 1000 * node) * pulses / per / 1000 for p, (node, per, pulses)
           in zip(r[3], (DRIVES["X"], DRIVES["Y"]))] for r in seen.rows]
    assert min(x for x, _ in mm) < -3.9
    for x in mm[-1]:
        assert abs(x) < 0.001
    return max(abs(math.hypot(x + 2, y) - 2) for x, y in mm)


def places_mm(row, axes):
    return [(row[3][i] - 1000 * DRIVES[a][0]) * DRIVES[a][2] / DRIVES[a][1] /
            1000 for i, a in enumerate(axes)]


def test_where_one_drive_has_a_fault_the_others_brake_on_the_path(can402):
    """A circle of 2 mm at 10 mm/s; Z, which stands, has the fault."""
    seen = Seen(can402, "brakes")
    seen.went_as_planned()
    rows = seen.since("3: harm", "emcy 3")
    rows = [r for r in rows if r[0] <= seen.at["3: stands"]]
    mm = [places_mm(r, "XY") for r in rows]
    ways = [math.dist(a, b) for a, b in zip(mm, mm[1:])]
    off = max(abs(math.hypot(x + 2, y) - 2) for x, y in mm)
    print(f"Z's fault: X and Y went on {sum(ways):.2f} mm, at most "
          f"{off * 1e3:.1f} um off the circle")
    assert ways[0] > 0.08 and 0.4 < sum(ways) < 1.2
    assert off < 0.003
    # Not on power any more, but only once they stood.
    last = max(i for i, way in enumerate(ways) if way > 0)
    assert all(r[2][:2] == ["enabled"] * 2 for r in rows[:last + 2])
    assert "enabled" not in rows[-1][2]
    assert not any(b > a + 0.02 for a, b in zip(ways, ways[1:]))


def test_a_drive_that_stopped_behind_the_path_comes_back_and_the_job_ends(
        can402):
    seen = Seen(can402, "brakes")
    rows = seen.between("1: harm", "1: stands")
    ways = [math.dist(*w) for w in zip((places_mm(r, "XY") for r in rows),
                                       (places_mm(r, "XY") for r in rows[1:]))]
    assert sum(ways) > 0.1
    assert "drive X (node 1) reports a fault" in seen.log
    assert "program 1 ended: done" in seen.log
    stands_at(seen, "XYZ")


def test_a_brake_on_a_line_is_open_under_torque_alone(can402):
    """Z's; after the faults of X and Y its own drive holds on until it has
    closed."""
    brake = json.loads(can402.text("brake.json"))
    assert brake == {"before": 0, "idle": 1, "ended": 0} | {
        f"{n}: {what}": is_open for n in (1, 2, 3)
        for what, is_open in (("running", 1), ("stands", 0))}


# Of examples/machine-can402-lines.ini: peak current, on and off time, ignition and
# servo voltage, polarity, iso.  C002 has all of its current and is negative.
FIELDS = (20, 21, 26, 14, 15, 18, 19, 23, 16, 17, 24, 22)
C001, C002, C003 = ((1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0),
                    (1, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1),
                    (1, 0, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0))
SETTLE_S = 0.03


def test_a_generator_on_lines_has_the_condition_of_each_place(can402):
    """The kernel's trace says what it has, and the drives where that is."""
    seen = Seen(can402, "lines")
    seen.went_as_planned()
    assert "program 1 ended: done" in seen.log
    found = lit(can402.text("lines.trace"), FIELDS, spark=2, pump=3, sense=25)
    changes = [b[0] - a[1] for a, b in zip(found, found[1:]) if a[2] != b[2]]
    print(f"{len(found)} times with sparks; a change takes "
          f"{[round(c * 1e3) for c in changes]} ms")
    assert {f[2] for f in found} == {C001, C002, C003}
    # Three on the way, and at least one back and forth.
    assert len(changes) >= 5 and min(changes) >= SETTLE_S
    looked = 0
    for t, _, _, place in seen.rows:
        x = (place[0] - 1000) / 524288 * 5
        has = [levels for on, off, levels in found if on < t < off]
        # What a drive tells is of two periods ago, at 1 mm/s.
        if has and abs(x - round(x)) > 0.03:
            assert has == [(C001, C002, C003, C001)[int(x)]], (t, x)
            looked += 1
    assert looked > 300


def test_drives_that_lag_are_led_along_the_path(can402):
    lagging, led, coupled = (off_the_circle(can402, n)
                             for n in ("lagging", "led", "coupled"))
    print(f"off a circle of 2 mm at 600 mm/min: {lagging * 1e3:.1f} um, "
          f"feedforward {led * 1e3:.1f} um, cross-coupled too "
          f"{coupled * 1e3:.1f} um")
    assert lagging > 0.05
    assert led < 0.01
    assert coupled < 0.01


# What is done, its fault, in the log, and SYNCs until sparks are off, from what
# comes to the drives or, if nothing does, from when it was done; 0: SYNC itself is
# what is missing.
FAULTS = [
    ("emcy", "drive", "drive X (node 1): emergency 2310", 4),
    ("leave", "drive", "drive Y (node 2) left operation enabled", 4),
    ("mute", "drive", "drive X (node 1) sends no heartbeat", 30),
    ("sync", "overrun", "emergency 8700", 0),
    ("skip", "drive", "drive Y (node 2) does not answer to SYNC", 7),
    ("jam", "following", "drive X (node 1) is too far from its target", 25),
    ("reboot", "drive", "drive Y (node 2) has restarted", 4),
    ("bus-off", "bus", "vcan0: bus off", 4),
    ("down", "bus", "vcan0 is down", 0),
    ("master", "bus", "another master on the bus", 4),
]
COMES = {what: what for what in ("emcy", "leave", "mute", "skip", "jam", "reboot")
         } | {"master": "nmt 8001"}


def test_every_step_of_the_plan_was_done(faults):
    faults.went_as_planned()
    assert set(faults.d["faults"]) == {f[0] for f in FAULTS} | {"harmless"}


@pytest.mark.parametrize("what, fault, text, syncs", FAULTS)
def test_a_fault_has_its_name_and_its_words(faults, what, fault, text, syncs):
    assert faults.d["faults"][what]["fault"] == fault
    assert text in faults.log


@pytest.mark.parametrize("what, fault, text, syncs", FAULTS)
def test_a_fault_ends_sparks_and_motion(faults, what, fault, text, syncs):
    before = faults.between(f"{what}: cutting", f"{what}: harm")
    after = [r for r in faults.rows if r[0] > faults.at[f"{what}: harm"]]
    if what in COMES:
        after = faults.since(f"{what}: harm", COMES[what])
    assert before[-1][1] == 1, "no sparks to end"
    # A row is older than the generator's frame of its period.
    if syncs == 0:
        gap = next(i for i, (a, b) in
                   enumerate(zip(before[-1:] + after, after))
                   if b[0] - a[0] > 5 * PERIOD_S)
        after, syncs = after[gap:], 3
    off = next(i for i, r in enumerate(after) if not r[1])
    print(f"{what}: sparks off after {off} SYNCs, "
          f"{(after[off][0] - faults.at[f'{what}: harm']) * 1e3:.0f} ms")
    assert off <= syncs
    still = [r for r in faults.between(f"{what}: fault", f"{what}: start")
             if r[0] > after[off][0] + 0.1]
    held = [r for r in still if "enabled" not in r[2]]
    assert len(held) > 20
    assert all(r[1] == 0 and r[3] == held[0][3] for r in held)
    # Only what the start itself does comes after them.
    assert still[:len(held)] == held


@pytest.mark.parametrize("what, fault, text, syncs", FAULTS)
def test_after_a_fault_an_operator_resets_and_starts(
        faults, what, fault, text, syncs):
    got = faults.d["faults"][what]
    assert got["early"][0] != 0, "a start without a reset was taken"
    assert got["reset"][0] == 0 and got["start"][0] == 0
    assert got["held"] == "hold", "a reset alone started"


def test_what_is_malformed_is_told_a_few_times_and_changes_nothing(faults):
    assert faults.d["faults"]["harmless"]["fault"] == "none"
    rows = faults.between("harmless: begin", "harmless: end")
    assert len(rows) > 40
    assert all(r[1] == 1 and r[2] == ["enabled"] * 2 for r in rows)
    told = [line for line in faults.log.splitlines() if "wrong length" in line]
    assert 1 <= len(told) <= 10


@pytest.fixture(scope="module")
def shared(can402):
    return Seen(can402, "shared")


def test_a_plc_may_share_the_drives_bus(shared):
    """Its NMT to us and to all is no other master's, and stops nothing."""
    shared.went_as_planned()
    rows = shared.between("NMT", "NMT taken")
    assert len(rows) > 40
    assert all(r[1] == 1 and r[2] == ["enabled"] * 2 for r in rows)
    assert "another master" not in shared.log
    assert "program 1 ended: done" in shared.log
    stands_at(shared, "XY")


# What the PLC does, how it comes, and its faults.  An NMT stop of all nodes stops
# the drives too.  If one of their heartbeats tells it in the period in which edmd
# reads the NMT, both faults are new in this period, and the drive's has the higher
# rank.
@pytest.mark.parametrize("what, comes, first", [
    ("permit", "request 0", {"permit"}),
    ("stop", "nmt 0220", {"plc-lost"}),
    ("reset", "nmt 8120", {"plc-lost"}),
    ("stop all", "nmt 0200", {"plc-lost", "drive"})])
def test_what_the_plc_takes_ends_the_sparks(shared, what, comes, first):
    got = shared.d["taken"][what]
    print(f"{what}: first {got['fault']}, then all of {got['faults']}")
    assert got["fault"] in first
    assert first <= set(got["faults"].split())
    assert got["start"][0] == 0
    after = [r for r in shared.since(f"{what}: harm", comes)
             if r[0] <= shared.at[f"{what}: reset"]]
    off = next(i for i, r in enumerate(after) if not r[1])
    print(f"{what}: sparks off after {off} SYNCs")
    # edmd may have read the PLC already in the period of the first one.
    assert off <= 2
    assert not any(r[1] for r in after[off:])


def test_after_all_that_the_job_ends_where_its_pulses_do(faults):
    assert "program 1 ended: done" in faults.log
    assert faults.d["status"]["pos_mm"][:2] == [10, 3]
    stands_at(faults, "XY")
