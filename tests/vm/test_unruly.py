# SPDX-License-Identifier: Apache-2.0
"""Drives, a PLC and others that do what CiA 301 and 402 let them do.

guest/unruly.py plays the drives and writes down what no master may do;
guest/can402_unruly.py did it, and was the operator.
"""
import json
import math

import pytest
from boot import UNRULY_SCENES

scenes = pytest.mark.parametrize("name", UNRULY_SCENES)


@pytest.fixture(scope="module")
def seen(unruly):
    def read(name):
        d = json.loads(unruly.text(f"unruly-{name}.json"))
        return d | {"log": unruly.text(f"unruly-{name}.log")}
    return read


@scenes
def test_the_operator_gets_back_to_the_cut_each_time(seen, name):
    d = seen(name)
    for done in d["done"]:
        print(done)
    vain = [what for _, what in d["marks"] if "in vain" in what]
    assert not vain, (vain, d["log"])
    assert d["edmd"] == 0
    assert "ended: done" in d["log"]


@scenes
def test_no_drive_has_anything_to_complain_of(seen, name):
    """Neither motion nor sparks with a place nobody knows, no power without a
    start, no leap, none started that was not set up whole."""
    d = seen(name)
    assert d["crimes"] == [], (d["crimes"], d["marks"])


@scenes
def test_nothing_is_asked_that_a_drive_must_refuse(seen, name):
    """But for objects that it does not have, for the unit of 60C2, which may
    be read-only, and where another spoke."""
    d = seen(name)
    if name in ("plc", "flood", "stranger"):
        pytest.skip("others ask too")
    assert {(code, what) for _, what, code in d["aborts"]
            if code not in ("06020000", "06090011")} <= {
        ("06010002", "60c2:2")}, d["aborts"]


@scenes
def test_one_reset_is_enough(seen, name):
    """Two where a second thing happened on the way back."""
    assert all(d["resets"] <= 2 for d in seen(name)["done"]), seen(name)["done"]


@pytest.mark.skipif("power" not in UNRULY_SCENES, reason="not played")
def test_every_trap_has_sprung(seen):
    d = seen("power")
    assert d["traps"] == [None, None]
    assert len([n for _, n in d["notes"] if "power lost" in n]) >= 20


@pytest.mark.skipif("jam" not in UNRULY_SCENES, reason="not played")
def test_frames_that_had_to_wait_are_not_sent_stale(seen):
    """When the bus is free again, the interface has kept those of three periods
    at most."""
    d = seen("jam")
    for at, what in d["marks"]:
        if not what.startswith("free"):
            continue
        rows = [t for t, _, _ in d["rows"] if at <= t <= at + 1]
        assert len(rows) > 50, what
        most = max(sum(t <= u < t + 0.01 for u in rows) for t in rows)
        print(f"{what}: {most} SYNCs in one period")
        assert most <= 5, what


@pytest.mark.skipif("wall" not in UNRULY_SCENES, reason="not played")
def test_nothing_presses_against_a_wall_that_does_not_yield(seen):
    """From the stop on no target lies in it, but for a rounding to pulses, and each
    way leads away from where the axis stands."""
    rows = seen("wall")["wall"]
    print(*rows, sep="\n")
    pulse = 524288 / 5000
    assert all(row[1] is None or row[1][0] == 0 for row in rows)
    assert max(row[3] for row in rows) <= pulse / 2 + 1
    moved = [(row[2] - rows[0][2]) / pulse for row in rows]
    along = 50 * 4 / math.hypot(4, 1.2)         # pulses of X, 50 um of the line
    wanted = [0, 0, *(-along * i for i in (1, 2, 3, 3)), -3 * along - 50]
    assert all(abs(a - b) <= 2 for a, b in zip(moved, wanted)), (moved, wanted)


@pytest.mark.skipif("stranger" not in UNRULY_SCENES, reason="not played")
def test_a_plc_written_from_cia_301_finds_its_slave_as_that_has_it(seen):
    d = seen("stranger")
    rows = d["asked"]
    print(len(rows), "questions; emergencies", d["emergencies"])
    assert [r for r in rows if r[1] not in r[2]] == []
    assert len(rows) > 150
    assert d["offences"] == []
    done = {r["what"]: r for r in d["done"]}
    for what in "asks", "strange frames":
        assert done[what]["fault"] == "none" and done[what]["resets"] == 0
    for what, fault in (("stopped", "plc-lost"), ("silent", "plc-lost"),
                        ("SYNC", "bus"), ("heartbeat", "bus")):
        assert done[what]["fault"] == fault, done[what]
    assert "the last has identifier 080" in d["log"]
    assert "or give master_node another number" in d["log"]


@pytest.mark.skipif("odd" not in UNRULY_SCENES, reason="not played")
def test_only_its_power_costs_a_drive_its_place(seen):
    done = {d["what"]: d for d in seen("odd")["done"]}
    assert done["off"]["homes"] == 1
    assert all(d["homes"] == 0 for what, d in done.items() if what != "off")
    assert done["a word that is no state, once"]["state"] in ("approach", "erode")
    assert "reports a statusword that is no state" in seen("odd")["log"]
    assert "; asked again" in seen("odd")["log"]


@pytest.mark.skipif("absolute" not in UNRULY_SCENES, reason="not played")
def test_an_absolute_drive_needs_no_home_and_its_place_must_agree(seen):
    d = seen("absolute")
    assert all(done["homes"] == 0 for done in d["done"]), d["done"]
    assert [m["fault"] for m in d["moved"]] == ["following"] * 3
    at = {what: t for t, what in d["marks"]}
    rows = [r for t, _, r in d["rows"]
            if at["moved: fault"] < t < at["moved: back"]]
    assert len(rows) > 100
    assert all(r[0][0] != "enabled" for r in rows)
