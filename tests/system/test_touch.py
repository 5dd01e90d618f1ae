# SPDX-License-Identifier: Apache-2.0
"""A set-up that ends in a zero: what is felt goes into an offset or into an
electrode, and the next job cuts there."""

import json
import math
import sqlite3

import pytest
import rig
from test_mdi import offsets, places, said

# The plate of examples/probe.ini, and an electrode of 5 mm over its bore.
PLATE = """
[machine]
name = {name}
backend = sim
period_us = 1000
overrun_limit = 0
cpu = -1
[axis.Z]
start_mm = 10
[probe]
feed_mm_s = 2
fine_mm_s = 0.05
[sim]
speed = 20
noise_v = 0
block = yes
block_x_min_mm = -20
block_x_max_mm = 45
block_y_min_mm = -40
block_y_max_mm = 25
block_top_mm = 3.2
bore_x_mm = 12.4
bore_y_mm = -7.25
bore_mm = 12
feeler_mm = 5
[electrode]
measure = yes
measure_x_mm = -10
clear_z_mm = 20
measure_from_z_mm = 6
measure_to_z_mm = 0
[jobs]
store = {store}
"""
PULSE = 0.001
CUT = b"G21 G90 %s\nG0 X0 Y0\nG0 Z0.05\nG1 Z0 F60\nM30\n"


@pytest.fixture
def plate(tmp_path):
    with rig.Machine(tmp_path, PLATE) as m:
        m.start()
        yield m


def go(m, *lines):
    for line in lines:
        p = m.ctl("mdi", line)
        assert p.returncode == 0, p.stderr


def first_cut(m, work):
    """Where the next job stands at its first cut."""
    a = m.client.submit(CUT % work.encode(), "cut")
    assert a.code == 0, a.reason
    m.client.job_where("cut", "done", 60)
    return places(m)


# How the electrode gets beside it, what is felt, and where zero then is.
FORMS = {
    "edge": (["G0 X-30", "G0 Z0"], ["X=probe+15", "radius=2.5"],
             {"X": -20}),
    "edge with a number": (["G0 Y35", "G0 Z0"], ["Y=probe-20", "radius=2.5",
                                                 "Y=7"], {"Y": 18}),
    "bore": (["G0 X12 Y-8", "G0 Z0"], ["bore", "R15", "Q0.2", "L2"],
             {"X": 12.4, "Y": -7.25}),
    "boss": (["G0 X10 Y-10 Z6"], ["boss", "I45", "J45", "K5"],
             {"X": 12.5, "Y": -7.5}),
    "corner": (["G0 X-24 Y-44", "G0 Z0"],
               ["corner", "X+", "Y+", "I10", "J10", "Q0.5", "radius=2.5"],
               {"X": -20, "Y": -40}),
    "face": (["G0 X-10"], ["Z=probe-20"], {"Z": 3.2}),
}


@pytest.mark.parametrize("form", FORMS)
def test_the_next_job_cuts_at_what_was_felt(plate, form):
    way, words, zero = FORMS[form]
    m = plate
    go(m, *way)
    code, out = said(m.ctl("offset", "G55", *words))
    assert code == 0, out
    o = offsets(m)["G55"]
    assert o["touched"] == "".join(zero)
    # Before and after, in the answer and in the history.
    job, = [j for j in json.loads(m.ctl("--json", "history").stdout)
            if j["job"].startswith("offset-")]
    for axis, mm in zero.items():
        assert o[axis] == pytest.approx(mm, abs=PULSE)
        line = f"{axis} was 0.0000, is {o[axis]:.4f}"
        assert line in out and line in job["reason"], (out, job["reason"])
    # A feeler's line is written as long as the travel: its length says nothing.
    assert "path" not in out, out
    go(m, "G53 G0 Z10")
    at = first_cut(m, "G55")
    for axis, mm in zero.items():
        assert at["XYZ".index(axis)] == pytest.approx(mm, abs=1.5 * PULSE)


# A block that lies askew, and whose face rises along X.
ASKEW = PLATE.replace("bore_mm = 12", "bore_mm = 0").replace(
    "feeler_mm = 5", "feeler_mm = 5\nblock_turn_deg = 2\nblock_tilt_deg = 0.5")
WITH_C = ASKEW.replace("[probe]", "[axis.C]\npresent = yes\n"
                       "pulse_mm = 0.001\ntravel_min_mm = -200\n"
                       "travel_max_mm = 200\n[probe]")
MIDDLE = (12.5, -7.5)			# of the block


def near(m, x, y, z=0.0):
    """Beside the block, by machine places."""
    go(m, "G53 G0 Z10", f"G53 G0 X{x} Y{y}", f"G53 G0 Z{z}")


def corner(x, y, deg=2):
    """A place of the block, as it lies."""
    dx, dy = x - MIDDLE[0], y - MIDDLE[1]
    c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    return MIDDLE[0] + c * dx - s * dy, MIDDLE[1] + s * dx + c * dy


def test_work_that_lies_askew_is_cut_as_it_lies(tmp_path):
    with rig.Machine(tmp_path, ASKEW) as m:
        m.start()
        near(m, 0, -46)
        code, out = said(m.ctl("offset", "G55", "skew", "Y+", "I20"))
        assert code == 0 and "turn from X toward Y was 0.0000, is" in out, out
        assert offsets(m)["G55"]["turn_deg"] == pytest.approx(2, abs=0.01)
        # Along X and Y of the block, each felt at one place.
        near(m, -27, -10)
        assert m.ctl("offset", "G55", "X=probe+15",
                     "radius=2.5").returncode == 0
        near(m, 10, -47)
        assert m.ctl("offset", "G55", "Y=probe+15",
                     "radius=2.5").returncode == 0
        near(m, 5, 0, 5)
        assert m.ctl("offset", "G55", "Z=probe-10").returncode == 0
        # The corner of the block is zero, and its X is the program's.
        a = m.client.submit(b"G21 G90 G55\nG0 X20 Y5\nM0\nM30\n", "there")
        assert a.code == 0, a.reason
        m.client.job_where("there", "held", 60)
        s = m.client.status_where(lambda s: s.stand == "stop", 10)
        assert s.pos_mm[:2] == pytest.approx(corner(0, -35), abs=0.01)
        # Told: which system, how it is turned, the program's own place.
        assert (s.work, round(s.work_turn_deg, 1)) == ("G55", 2.0)
        assert s.work_mm[:2] == pytest.approx((20, 5), abs=0.001)
        out = m.ctl("status").stdout
        assert "work       G55 X 20.000 Y 5.000" in out, out
        assert f"(turned by {s.work_turn_deg:.4f} degrees)" in out, out


def test_a_corner_of_a_turned_system_is_refused(tmp_path):
    with rig.Machine(tmp_path, ASKEW) as m:
        m.start()
        near(m, 0, -46)
        assert m.ctl("offset", "G55", "skew", "Y+", "I20").returncode == 0
        code, out = said(m.ctl("offset", "G55", "corner", "X+", "Y+"))
        assert code == 1 and "two edges" in out, out
        assert m.ctl("offset", "G55", "clear").returncode == 0
        assert offsets(m)["G55"]["turn_deg"] == 0


def test_contacts_that_are_not_of_one_face_turn_nothing(tmp_path):
    """Below the corner of a block that stands on it, along its other side."""
    with rig.Machine(tmp_path, ASKEW.replace("block_turn_deg = 2",
                                             "block_turn_deg = -30")) as m:
        m.start()
        before = offsets(m)
        x, y = corner(45, -40, -30)
        near(m, x + 5, y - 8)
        code, out = said(m.ctl("offset", "G55", "skew", "Y+", "I6"))
        assert "not of one face" in out, (code, out)
        assert offsets(m) == before
        near(m, x - 20, y - 8)
        code, out = said(m.ctl("offset", "G55", "skew", "Y+", "I-6"))
        assert code == 0, out
        assert offsets(m)["G55"]["turn_deg"] == pytest.approx(-30, abs=0.05)


def test_a_face_that_rises_is_told_along_each_axis(tmp_path):
    with rig.Machine(tmp_path, ASKEW) as m:
        m.start()
        near(m, 0, 0, 5)
        code, out = said(m.ctl("offset", "G54", "skew", "Z-", "I20"))
        assert code == 0 and "tilt along X was 0.0000, is" in out, out
        near(m, 0, 0, 5)
        code, out = said(m.ctl("offset", "G54", "skew", "Z-", "J-20"))
        assert code == 0, out
        o = offsets(m)["G54"]
        # The block is turned by 2 degrees, too.
        assert o["tilt_x_deg"] == pytest.approx(0.5, abs=0.01)
        assert o["tilt_y_deg"] == pytest.approx(0.5 * math.sin(
            math.radians(2)), abs=0.01)
        assert o["turn_deg"] == 0 and "tilt along Y was 0.0000" in out


def test_the_electrode_turns_with_the_work(tmp_path):
    with rig.Machine(tmp_path, WITH_C) as m:
        m.start()
        go(m, "G53 G0 C7")
        assert m.ctl("offset", "G55", "C=0").returncode == 0
        near(m, -26, -20)
        code, out = said(m.ctl("offset", "G55", "skew", "X+", "J20"))
        assert code == 0 and "; turn from X" in out, out
        o = offsets(m)["G55"]
        assert o["turn_deg"] == pytest.approx(2, abs=0.01)
        assert o["C"] == pytest.approx(7 + o["turn_deg"], abs=1e-9)


def test_a_skew_is_kept_as_a_whole_or_not_at_all(tmp_path):
    """The store fails at the second row of it: no turn without its C."""
    with rig.Machine(tmp_path, WITH_C) as m:
        m.start()
        near(m, -26, -20)
        before = offsets(m)
        with sqlite3.connect(m.store / f"{m.name}.db") as db:
            db.execute("CREATE TRIGGER fails BEFORE INSERT ON work WHEN "
                       "new.axis=5 BEGIN SELECT RAISE(ABORT, ''); END")
        db.close()
        code, out = said(m.ctl("offset", "G55", "skew", "X+", "J20"))
        assert "the store failed" in out, (code, out)
        assert offsets(m) == before


def test_an_electrode_is_turned_straight_and_over_its_middle(tmp_path):
    """The block is the pin here: what turns it turns the electrode."""
    with rig.Machine(tmp_path, WITH_C) as m:
        m.start()
        assert m.ctl("electrode", "add", "3").returncode == 0
        code, out = said(m.ctl("offset", "T3", "skew", "Y+", "I20"))
        assert code == 1 and "not in the holder" in out, out
        assert m.ctl("electrode", "use", "3").returncode == 0
        go(m, "G53 G0 C5")
        near(m, 0, -46)
        code, out = said(m.ctl("offset", "T3", "skew", "Y+", "I20"))
        assert code == 0 and "C was 0.0000, is 3.00" in out, out
        # A middle that is asked for as 0.5 and 0.25 beside where it is.
        near(m, 12, -7, 6)
        code, out = said(m.ctl("offset", "T3", "boss", "I50", "J50", "K8",
                               "X=12", "Y=-7.25"))
        assert code == 0 and "X was 0.0000, is 0.4" in out, out
        e, = json.loads(m.ctl("--json", "electrode", "list").stdout)
        c, s = math.cos(math.radians(5)), math.sin(math.radians(5))
        assert e["x_mm"] == pytest.approx(c * 0.5 - s * 0.25, abs=0.05)
        assert e["y_mm"] == pytest.approx(-s * 0.5 - c * 0.25, abs=0.05)
        # Where C stands as straight, a program of 0 has its middle at 0.
        go(m, "G53 G0 Z10", "G0 C0", "G0 X0 Y0")
        at = places(m)
        deg = math.radians(at[5])
        assert at[5] == pytest.approx(e["c_deg"], abs=0.001)
        assert at[:2] == pytest.approx(
            (math.cos(deg) * e["x_mm"] - math.sin(deg) * e["y_mm"],
             math.sin(deg) * e["x_mm"] + math.cos(deg) * e["y_mm"]),
            abs=0.0015)
        # C turns, and the middle stays.
        go(m, "G0 C90")
        deg = math.radians(places(m)[5])
        assert places(m)[:2] == pytest.approx(
            (math.cos(deg) * e["x_mm"] - math.sin(deg) * e["y_mm"],
             math.sin(deg) * e["x_mm"] + math.cos(deg) * e["y_mm"]),
            abs=0.0015)
        code, out = said(m.ctl("mdi", "G1 F10 C80"))
        assert code != 0 and "C turned by G0" in out, out


def test_an_electrode_gets_its_length_from_a_face(plate):
    m = plate
    assert m.ctl("electrode", "add", "3").returncode == 0
    code, out = said(m.ctl("offset", "T3", "Z=probe-20", "Z=1.2", "new"))
    assert code == 1 and "electrode use 3" in out, out
    assert m.ctl("electrode", "use", "3").returncode == 0
    go(m, "G53 G0 X-10")
    code, out = said(m.ctl("offset", "T3", "Z=probe-20", "Z=1.2"))
    assert code == 1 and "not known yet" in out, out
    code, out = said(m.ctl("offset", "T3", "Z=probe-20", "Z=1.2", "new"))
    assert code == 0 and "2.0000 mm long" in out, out
    e, = json.loads(m.ctl("--json", "electrode", "list").stdout)
    assert e["length_mm"] == pytest.approx(2, abs=PULSE)
    # It is in force: the surface is Z1.2 with this electrode.
    go(m, "G53 G0 Z10")
    assert m.ctl("offset", "G54", "Z@1.2").returncode == 0
    assert first_cut(m, "G54")[2] == pytest.approx(3.2, abs=1.5 * PULSE)
    # By hand, over a gauge: where it stands, nothing moves.
    go(m, "G53 G0 Z6.2")
    code, out = said(m.ctl("offset", "T3", "Z=1.2", "new"))
    assert code == 0 and "was 2.0000 mm long, is 5.0000" in out, out


def test_a_probe_that_finds_nothing_leaves_what_was(plate):
    m = plate
    assert m.ctl("offset", "G54", "X@1", "Y@2").returncode == 0
    before = offsets(m)
    code, out = said(m.ctl("offset", "G54", "X=probe+3", "radius=2.5"))
    assert code == 1 and "no-contact" in out, out
    assert offsets(m) == before
    m.client.ask("reset"), m.client.ask("stop")
    m.client.status_where(lambda s: s.state == "idle" and not s.job)
    # Out of the travel: the text of the cycle is refused, nothing moves.
    at = places(m)
    code, out = said(m.ctl("offset", "G54", "boss", "I45", "J4500", "K5"))
    assert code == 65 and "beyond the travel" in out, out
    assert places(m) == at and offsets(m) == before


def test_two_forms_at_once_touch_one_off(plate):
    m, c = plate, plate.client
    go(m, "G0 X-10")
    first = c.ask("offset", text="G54\nZ=probe-20")
    assert first.code == 0
    second = c.ask("offset", text="G55\nZ=probe-20")
    assert second.code == 1 and "not now" in second.reason
    c.job_where(first.reason, "done", 60)
    o = offsets(m)
    assert o["G54"]["touched"] == "Z" and o["G55"]["touched"] == ""


@pytest.mark.parametrize("words, says", [
    (("G54", "bore", "K5"), "'K5'"), (("G54", "bore", "R"), "'R'"),
    (("G54", "corner", "X+"), "corner"), (("G54", "corner", "X+", "Y2"), "'Y2'"),
    (("G54", "bore", "X@1"), "X@5"), (("G54", "bore", "boss"), "'boss'"),
    (("G54", "bore", "radius=2"), "radius"), (("G54", "radius=2", "X=1"), "radius"),
    (("G54", "X=probe-", "radius=-2"), "'radius=-2'"),
    (("G54", "bore", "clear"), "clear"), (("G54", "boss"), "boss"),
    (("G54", "X=1", "new"), "new"), (("T3", "X=probe-"), "T3"),
    (("T3", "corner", "X+", "Y+"), "T3"), (("T3", "boss", "I9", "K1", "new"), "new"),
    (("G54", "skew"), "skew Y+ I40"), (("G54", "skew", "Y+"), "I40"),
    (("G54", "skew", "Y+", "J5"), "I40"), (("G54", "skew", "Y+", "I0"), "'I0'"),
    (("G54", "skew", "Y+", "X-", "I5"), "one of X Y Z"), (("G54", "skew", "Y+", "I5", "Y=1"), "turn"),
    (("G54", "X=2e6"), "'X=2e6'; a number of mm from -1000000 to 1000000"),
    (("G54", "bore", "R2e6"), "'R2e6'; a number of mm from"), (("G54", "Z=probe-0"), "from 0.001 to 1"),
    (("G54", "X=probe-", "radius=1e5"), "'radius=1e5'; a number of mm from 0.0001 to 10000"),
    (("T3", "skew", "Z-", "I5"), "tilts"), (("T0", "Z=1"), "'T0'"), (("T84", "Z=1"), "'T84'"),
])
def test_what_fits_no_form_is_refused(plate, words, says):
    code, out = said(plate.ctl("offset", *words))
    assert code == 65 and says in out, (code, out)
    assert all(r["touched"] == "" for r in offsets(plate).values())


def test_what_was_and_what_is_now_is_told(machine):
    go(machine, "G0 X10")
    code, out = said(machine.ctl("offset", "G54", "X=0", "Y@9000"))
    assert code == 0, out
    assert "X was 0.0000, is 10.0000" in out
    assert "Y was 0.0000, is 9000.0000, beyond the travel" in out
    code, out = said(machine.ctl("offset", "G54", "clear"))
    assert code == 0 and "X was 10.0000, is 0.0000" in out, out


def test_where_it_stands_is_told_in_the_work_and_in_the_machine(machine):
    m = machine
    assert m.ctl("electrode", "add", "2", "length=4").returncode == 0
    assert m.ctl("electrode", "use", "2").returncode == 0
    go(m, "G53 G0 X10 Z9")
    assert m.ctl("offset", "G56", "X@7.5", "Z@1").returncode == 0
    m.client.hear(1.5)
    out = m.ctl("status").stdout
    assert "work       G54 X 10.000 Y 0.000 Z 5.000" in out, out
    assert "work       G56 X 2.500 Y 0.000 Z 4.000" in out
    assert "machine at X 10.000 Y 0.000 Z 9.000" in out
    assert out.index("work  ") < out.index("machine at")
