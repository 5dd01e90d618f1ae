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
    "drive B (node 5) refuses object 1a01:01, value 60fd0020, code 06040041: "
    "object cannot be mapped",
    "drive C (node 6) refuses object 60b8:00, value 0, code 06020000: "
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


@pytest.fixture(scope="module")
def objects(strict):
    seen = Seen(strict, "strict-objects")
    seen.went_as_planned()
    return seen.d["out"]


def drives_of(answer):
    assert answer[0] == 0, answer
    return json.loads(answer[1])["drives"]


def test_drives_are_told_in_words(objects):
    x, y = drives_of(objects["cold"])
    assert (x["axis"], x["node"], y["axis"], y["node"]) == ("X", 1, "Y", 2)
    assert x["phase"] == "up" and x["state"] == "ready to switch on"
    assert x["mode_name"] == "cyclic synchronous position"
    assert x["trouble"] == "well" and not x["lost"]
    assert "operation enabled" in objects["in a cut"][0][1]


def test_how_far_an_axis_is_behind_is_told(objects):
    assert objects["scope"][0] == 0, objects["scope"]
    seen = json.loads(objects["scope"][1])
    assert seen["cycles"] > 10 and seen["lost"] == 0
    assert 0.5 < seen["most_mm_s"] < 10
    assert seen["rms_um"] <= seen["most_um"] < 50


def test_an_object_is_read_by_number_and_by_name(objects):
    by_number, by_name, index, status, missing, long, again, nonsense = \
        objects["get"]
    assert by_number[0] == 0 and by_number == by_name == again
    assert "position actual value" in by_number[1]
    assert index[1].startswith("60c2:02  -3  0xfd")
    assert status[1].startswith("6041:00") and "statusword" in status[1]
    assert missing[0] == 1 and "06020000: no such object" in missing[1]
    assert long[0] == 1 and "more than four bytes" in long[1]
    assert nonsense[0] != 0 and "a number as 6064" in nonsense[1]


def test_an_object_is_set_or_it_is_said_why_not(objects):
    done, high, ro, target, beat, own, word, part = objects["set"]
    assert done == [0, "drive set: 6065:00 is 1500, it was 2000\n"], done
    assert "06090030: value out of range" in high[1]
    assert "06010002: read only" in ro[1]
    for answer in target, beat, own:
        assert answer[0] == 1 and "edmd writes this object itself" in answer[1]
    assert word[0] != 0 and part[0] != 0
    x, y, z = objects["store"]
    assert x[0] == 0 and "stored" in x[1]
    assert y[0] == 1 and "set them by drive_sdo" in y[1]
    assert z[0] != 0


def test_only_the_parameters_of_the_application_are_stored(objects, strict):
    assert Seen(strict, "strict-objects").d["stored"] == [[1, 3]]


def test_emergencies_are_kept_with_the_makers_field(objects):
    assert "3283 DC link voltage" in objects["emcy"][1]
    assert "register 04, maker's 01 02 03 04 05" in objects["emcy"][1]


def test_nothing_is_set_in_a_job_or_under_torque(objects):
    _, get, put, store = objects["in a cut"]
    assert get[0] == 0
    assert put[0] == 1 and "wants no job loaded" in put[1], put
    assert store[0] == 1 and "wants no job loaded" in store[1]
    assert objects["cuts on"]["state"] in ("approach", "erode")
    assert objects["torque"][0] == 1 and "has torque" in objects["torque"][1]
    assert objects["without"][0] == 0, objects["without"]


def test_a_set_that_turns_the_count_loses_the_place(objects):
    assert objects["turned"][0] == 0, objects["turned"]
    x, y = drives_of(objects["after"])
    assert y["lost"] and not x["lost"]
    assert "drive      Y (node 2): its place is lost" in objects["alarms"][1]


@pytest.fixture(scope="module")
def homes(strict):
    seen = Seen(strict, "strict-home")
    seen.went_as_planned()
    return seen


HOMES = {"X": (0, -334500, -3), "Y": (1, 17000, 5)}


def off_home_mm(seen, row, pos_mm, axis):
    """How far its drive is from where edmd says that it is."""
    drive, at, at_mm = HOMES[axis]
    _, per, pulses = DRIVES[axis]
    true_mm = at_mm + (row[2][drive][1] - at) * pulses / per / 1000
    return abs(true_mm - pos_mm["XYZ".index(axis)])


def test_drives_find_their_zeros_by_themselves(homes):
    out = homes.d["out"]
    for axis in "XYZ":
        assert out[f"home {axis}"][0] == 0, out[f"home {axis}"]
    assert all(a[0] == 0 for a in out["again"]), out["again"]
    assert out["homed"]["lost"] == ""
    assert out["homed"]["pos_mm"][:3] == [-3, 5, 2]
    there = [r for r in homes.rows if r[0] <= homes.at["there"]][-1]
    for axis in "XY":
        assert off_home_mm(homes, there, [-1, 4, 1], axis) < 0.0011
        assert off_home_mm(homes, homes.rows[-1], [-1, 4, 1], axis) < 0.0011


def test_a_drive_that_homes_is_told_nothing_that_it_may_not_be(homes):
    assert homes.d["offences"] == []
    assert not [a for a in homes.d["aborts"] if a[1] == "6060:0"]


def test_no_axis_leaps_when_its_drive_follows_again(homes):
    ends = 0
    for drive, axis in enumerate("XYZ"):
        _, per, pulses = DRIVES[axis]
        modes = [r[2][drive][3] for r in homes.rows]
        true = [r[2][drive][1] for r in homes.rows]
        for i in range(1, len(modes) - 15):
            if modes[i - 1] != 6 or modes[i] != 8:
                continue
            ends += 1
            for a, b in zip(true[i - 1:i + 15], true[i:i + 15]):
                assert abs(b - a) <= abs(2 * per / pulses), (axis, i)
    assert ends >= 9


def test_an_axis_that_would_fall_keeps_its_torque_while_its_drive_homes(homes):
    states = [r[2][2] for r in homes.rows]
    homing = [i for i, d in enumerate(states) if d[3] == 6]
    assert len(homing) > 10
    assert all(d[0] == "enabled" for d in states[homing[0] - 5:homing[-1] + 5])


@pytest.mark.parametrize("what", ["hold", "estop", "off"])
def test_what_ends_homing_leaves_an_axis_without_a_place(homes, what):
    out = homes.d["out"]
    assert out[f"{what}: state"] == "home"
    assert out[f"{what}: lost"] == "X"
    assert out[f"{what}: home"][0] == 0, out[f"{what}: home"]


def test_homing_that_fails_is_a_fault_and_is_done_again(homes):
    out = homes.d["out"]
    assert out["fails: home"][0] == 1
    assert out["fails: fault"] == "home-not-found"
    assert out["fails: again"][0] == 0, out["fails: again"]


@pytest.fixture(scope="module")
def asked(strict):
    seen = Seen(strict, "strict-asked")
    print(*seen.d["out"].items(), sep="\n")
    seen.went_as_planned()
    return seen.d["out"]


def test_a_late_answer_is_not_taken_for_another_objects(asked):
    late, index, kind = asked["late"]
    assert late[0] in (0, 1)            # in time, or told that it was not
    assert late[0] == 1 or late[1].startswith("6065:00")
    for answer in index, asked["after late"]:
        assert answer[0] == 1 or answer[1].startswith("60c2:02  -3"), answer
    assert asked["after late"][0] == 0
    assert kind[0] == 1 or kind[1].startswith("1000:00"), kind


def test_what_a_drive_aborts_is_told(asked):
    assert asked["aborts"][0] == 1 and "08000020" in asked["aborts"][1]


def test_a_drive_that_is_not_there_is_told(asked):
    for answer in asked["none"] + [asked["many"], asked["is off"]]:
        assert answer[0] not in (0, 69, 70) and len(answer[1]) > 20, answer


def test_a_drive_that_goes_while_it_is_asked_leaves_nobody_waiting(asked):
    assert asked["off"][0] != 0, asked["off"]
    assert asked["again"][0] == 0 and asked["again"][1].startswith("1000:00")


def test_a_mode_that_a_drive_claims_and_refuses_ends_its_homing(asked):
    assert asked["no mode 6"][0] == 1, asked["no mode 6"]
    assert asked["no mode 6: state"]["state"] == "fault"
    assert "X" in asked["no mode 6: state"]["lost"]
    assert asked["no mode 6: reset"][0] == 0
    assert asked["well"][0] == 0, asked["well"]


@pytest.fixture(scope="module")
def inputs(strict):
    seen = Seen(strict, "strict-inputs")
    seen.went_as_planned()
    return seen


def test_a_home_switch_wired_to_a_drive_is_found(inputs):
    out = inputs.d["out"]
    assert out["home"][0] == 0, out["home"]
    assert out["home: state"]["pos_mm"][0] == pytest.approx(-2, abs=1.1)
    at = [r for r in inputs.rows if r[0] <= inputs.at["home"]][-1][2][0][1]
    _, per, pulses = DRIVES["X"]
    mm = -3 + (at + 334500) * pulses / per / 1000
    # A place is a period old, and the switch is read a period later.
    assert abs(mm - out["home: state"]["pos_mm"][0]) < 0.03, mm
    assert out["job"][0] == 0, out["job"]
    assert "program 1 ended: done" in inputs.log


# True place of the mark that is home: where it begins, going toward - of the axis,
# which is + of Y's drive.
MARKS = {"X": (0, -347000 + 40, -3), "Y": (1, 27700, 4)}


@pytest.fixture(scope="module")
def marks(strict):
    seen = Seen(strict, "strict-marks")
    print(seen.d["out"], seen.d["marks"], seen.d["offences"], sep="\n")
    seen.went_as_planned()
    return seen


def off_mark_mm(marks, what, axis):
    """How far edmd is wrong about where the axis truly is."""
    drive, at, at_mm = MARKS[axis]
    row = [r for r in marks.rows if r[0] <= marks.at[what]][-1]
    _, per, pulses = DRIVES[axis]
    true_mm = at_mm + (row[2][drive][1] - at) * pulses / per / 1000
    return true_mm - marks.d["out"][f"{what}: state"]["pos_mm"]["XY".index(axis)]


@pytest.mark.parametrize("axis", "XY")
def test_the_place_of_an_index_mark_is_exact(marks, axis):
    """To a pulse, though 10 of them are the way of a period."""
    for n in range(3):
        assert marks.d["out"][f"{axis} {n}"][0] == 0, marks.d["out"]
        assert abs(off_mark_mm(marks, f"{axis} {n}", axis)) < 0.0016
    assert marks.d["offences"] == []


def test_a_limit_at_a_drive_stops_motion_that_way_only(inputs):
    out = inputs.d["out"]
    assert out["to high: state"]["fault"] == "limit-switch"
    assert "limit switch" in out["farther"][1] and out["farther"][0] == 1
    for what in "another axis", "back", "from it", "again":
        assert out[what][0] == 0, (what, out[what])
    assert out["on at rest: state"]["state"] == "idle"
    assert out["toward it"][0] == 1


def test_a_limit_at_the_wrong_end_bars_both_ways(inputs):
    out = inputs.d["out"]
    assert out["wrong end: state"]["fault"] == "limit-switch"
    for what in "wrong end: on", "wrong end: back":
        assert out[what][0] == 1 and "limit switch" in out[what][1], out[what]


def test_an_estop_at_a_drive_latches(inputs):
    out = inputs.d["out"]
    assert out["estop: pressed"][0] == 1, out["estop: pressed"]
    assert out["estop: let go: state"]["fault"] == "e-stop"
    assert out["estop: reset"][0] == 0 and out["estop: jog"][0] == 0


def test_inputs_that_do_not_come_any_more_stop_the_axes(inputs):
    out = inputs.d["out"]
    assert "drive Y (node 2) does not answer to SYNC" in inputs.log
    assert out["loses: reset"][0] == 0


def test_a_drive_in_mode_7_goes_the_same_way(strict):
    seen = Seen(strict, "strict-ip")
    seen.went_as_planned()
    out = seen.d["out"]
    for what in "home", "job", "reset", "start":
        assert out[what][0] == 0, out
    assert "program 1 ended: done" in seen.log
    assert seen.d["offences"] == []
    assert drives_of(out["drives"])[0]["mode_name"] == "interpolated position"
    assert off_home_mm(seen, seen.rows[-1], [1, 2], "X") < 0.0011
    modes = {r[2][0][3] for r in seen.rows if r[2][0][0] == "enabled"}
    assert modes == {6, 7}
    for (_, _, was), (t, _, now) in zip(seen.rows, seen.rows[1:]):
        if now[0][3] == 7:
            assert abs(now[0][1] - was[0][1]) * 5000 / 524288 / 1000 <= STEP_MM, t


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


# What is wired wrongly, and what the walk says of it.
WIRINGS = {
    "no e-stop": "estop, or estop:BIT in drive_inputs, is not what it is",
    "one node twice": "drive X (node 1): answers more often",
    "SYNC missing": "drive Y (node 2): does not answer to SYNC",
    "slow SDO": "drive Z (node 3): ",
    "weak power supply": "3220",
    "direction": "X goes the wrong way; it is turned in the machine file",
    "swapped axes": "what is Y moves Z: they are swapped; swap can402.node_Y",
    "scale by ten": "times as far as it is sent; its scale is corrected",
    "swapped limits": "X may not leave its switch at +: limit_low and",
    "inverted home": "X left a home switch that did not go off: it is inverted",
    "gap inverted": "the gap is inverted: 5.",
    "noise": "the gap is noisy",
}


@pytest.fixture(scope="module")
def commissioned(strict):
    seen = Seen(strict, "strict-commission")
    print(*seen.d["asked"], seen.d["out"], sep="\n")
    seen.went_as_planned()
    return seen.d


@pytest.mark.parametrize("what", WIRINGS)
def test_a_wrong_wiring_is_named_by_the_walk(commissioned, what):
    wrong = [line for line in commissioned["out"].splitlines()
             if line.startswith("WRONG: ")]
    assert [line for line in wrong if WIRINGS[what] in line], wrong


def test_what_is_mended_is_walked_to_the_first_cut(commissioned):
    steps = json.loads(commissioned[".ini.commission"])
    assert steps["cut"]["good"], steps["cut"]
    for name in ("estop", "drives", "power X", "direction X", "direction Y",
                 "scale X", "scale Y", "limits X", "home X", "following X",
                 "backlash Z", "gap", "watchdog"):
        assert steps[name]["good"], (name, steps[name])
    assert "drive_increments = -524288" in commissioned[".ini"]
    page = commissioned[".ini.commission.html"]
    assert page.count("<polyline") >= 8 and "nan" not in page
