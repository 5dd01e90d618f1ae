# SPDX-License-Identifier: Apache-2.0
"""A job that a power cut interrupted goes on: off the work, in along its own
path, and from there on as if nothing had been."""

import random
import sqlite3

import pytest
import rig
from test_power import LONG_JOB, die, seeds

# Two cuts, each with a way down to the work.
CUT = (b"G21 G90 T84 M3\nG0 Z2\nG0 X0 Y0\nG0 Z0\nG1 X4 F60\nG0 Z2\n"
       b"G0 X1 Y5\nG0 Z0\nG1 X5\nM30\n")


def interrupted(m, c, at_mm, text=CUT):
    m.start()
    assert c.submit(text, "cut").code == 0
    last = c.status_where(lambda s: s.job_state == "running"
                          and s.place_mm > at_mm, 20)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    return last


def way_in(c, job):
    return c.heard(lambda: [e.text for e in c.events
                            if e.kind == "waits" and e.job == job])[0]


def resume(c, job="cut", axes="XYZABCUV"):
    a = c.ask("resume", job, text=axes)
    assert a.code == 0, a.reason
    c.job_where(job, "ready")


@pytest.mark.parametrize("seed", seeds())
def test_it_goes_on_to_its_end(idle, seed):
    m, c = idle, idle.client
    last = interrupted(m, c, random.Random(seed).uniform(0.1, 17))
    print(f"EDM_SEED={seed}: at {last.place_mm} mm")
    resume(c)
    c.hear(0.5)
    s = c.status()
    assert s.state == "hold" and not any(s.pos_mm), "it moves by itself"
    assert "off the work" in way_in(c, "cut")
    assert c.ask("start").code == 0
    cut = c.job_where("cut", "done", 60)
    # At the end of its path, and the sums are those of both parts.
    assert c.status().pos_mm[:3] == pytest.approx((5, 5, 0))
    assert not c.status().interrupted
    assert cut["path_mm"] == pytest.approx(cut["length_mm"])
    assert cut["job_s"] > last.job_s


def test_interrupted_again_it_goes_on_where_it_was(idle):
    m, c = idle, idle.client
    last = interrupted(m, c, 19)
    for _ in range(2):
        resume(c)
        # It comes in at the second cut, not at the first.
        way = way_in(c, "cut")
        assert "X1.000 Y5.000 Z0.000" in way, way
        assert c.ask("start").code == 0
        # Cut off again on the way in, before it has cut anything.
        c.status_where(lambda s: s.job_state == "running" and s.place_mm > 0.1)
        die(m)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        assert c.job("cut")["path_mm"] >= last.place_mm - 1.1
    resume(c)
    assert c.ask("start").code == 0
    c.job_where("cut", "done", 60)


def test_who_says_that_the_axes_are_where_they_were(idle):
    m, c = idle, idle.client
    interrupted(m, c, 1, LONG_JOB)
    # What it says is accepted: a start alone is not.
    waits = c.heard(lambda: [e.text for e in c.events if e.kind == "waits"
                             and "nothing measures" in e.text])[0]
    assert "edmctl resume JOB if one was interrupted" in waits
    a = c.ask("start")
    assert a.code == 1 and "resume it or remove it" in a.reason
    a = c.ask("resume", "cut")
    assert a.code == 1 and "not certain" in a.reason and "X" in a.reason
    a = c.ask("resume", "cut", text="X")
    assert a.code == 1 and "Y" in a.reason
    a = c.ask("resume", "nosuch")
    assert a.code == 66
    assert c.ask("start").code == 1
    resume(c)
    # The answer was for the axes of that edmd.
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert c.job("cut")["state"] == "interrupted"
    a = c.ask("resume", "cut")
    assert a.code == 1 and "not certain" in a.reason
    assert c.ask("remove", "cut").code == 0


def test_another_machine_file_is_refused(idle):
    m, c = idle, idle.client
    interrupted(m, c, 1, LONG_JOB)
    die(m)
    m.config.write_text(m.config.read_text().replace(
        "[jobs]", "[jobs]\nkeep_jobs = 999", 1))
    m.start()
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1 and "machine file" in a.reason
    assert c.job("cut")["state"] == "interrupted"


def test_a_checkpoint_from_before_the_resume_is_none_of_it(idle):
    """A place in the whole program is another one in what is left of it."""
    m, c = idle, idle.client
    interrupted(m, c, 18.5)
    was = c.job("cut")
    (place,) = m.store.glob("*.place")
    old = place.read_bytes()
    resume(c)
    assert c.ask("start").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 0.5)
    die(m)
    place.write_bytes(old)      # the disk had nothing of the second run
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    now = c.job("cut")
    assert now["path_mm"] == was["path_mm"]
    assert now["job_s"] == was["job_s"]
    assert "no checkpoint" in now["reason"]
    resume(c)
    assert "X1.000 Y5.000" in way_in(c, "cut")


@pytest.mark.parametrize("damage", [
    lambda at: at[:800] + 16 * "0" + at[800:-40] + at[-24:],    # moved by a word
    lambda at: at[:-3], lambda at: "", lambda at: "0" + at,
    lambda at: at[at.index(";") + 1:],
])
def test_a_damaged_place_is_not_resumed(idle, damage):
    m, c = idle, idle.client
    interrupted(m, c, 18.5)
    die(m)
    with sqlite3.connect(m.store / f"{m.name}.db") as db:
        ((at,),) = db.execute("SELECT at FROM resume")
        db.execute("UPDATE resume SET at=?", (damage(at),))
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1 and "checkpoint" in a.reason, a.reason
    assert c.job("cut")["state"] == "interrupted"


def test_what_cannot_go_on_stays_interrupted(idle):
    """No way in is known, but the job is not gone."""
    m, c = idle, idle.client
    interrupted(m, c, 5, b"G21 G90\nG38.2 X1 F60\nG92 X0\n"
                b"G1 Y8 F60\nM30\n")
    assert c.ask("resume", "cut", text="XYZABCUV").code == 0
    told = c.heard(lambda: [e.text for e in c.events
                            if e.kind == "interrupted"
                            and "cannot go on" in e.text])[0]
    assert "nothing was positioned" in told and ":2:" in told
    assert c.job("cut")["state"] == "interrupted"
    assert c.ask("resume", "cut", text="XYZABCUV").code == 0
    assert c.ask("remove", "cut").code == 0


@pytest.mark.parametrize("where", [{"from_line": 9}, {"from_mm": 18.5}])
def test_it_begins_where_its_sender_says(machine, where):
    c = machine.client
    a = c.submit(CUT, "cut", **where)
    assert a.code == 0 and "X1.000 Y5.000" in a.reason, a.reason
    c.job_where("cut", "ready")
    c.hear(0.5)
    assert not any(c.status().pos_mm), "it moves by itself"
    assert "off the work" in way_in(c, "cut")
    assert c.ask("start").code == 0
    # Not where the first cut is: in front of the second, and then along it.
    c.status_where(lambda s: s.state == "travel" and s.pos_mm[1] > 4, 20)
    c.job_where("cut", "done", 60)
    assert c.status().pos_mm[:3] == pytest.approx((5, 5, 0))
    past = c.job("cut")
    assert past["path_mm"] == pytest.approx(past["length_mm"])


def test_a_begin_inside_survives_a_power_cut(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(CUT, "cut", from_line=9).code == 0
    c.job_where("cut", "ready")
    die(m)      # it has not begun: it waits as before
    m.start()
    c.status_where(lambda s: s.job_state == "ready" and s.state == "hold", 10)
    assert c.ask("start").code == 0
    last = c.status_where(lambda s: s.job_state == "running"
                          and s.pos_mm[0] > 2 and s.pos_mm[1] > 4.9, 20)
    c.hear(1.2)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    # Places are those of the whole program: its second cut is behind 17 mm.
    assert c.job("cut")["path_mm"] > 17 + last.pos_mm[0] - 1
    resume(c)
    assert "X1.000 Y5.000 Z0.000" in way_in(c, "cut")
    assert c.ask("start").code == 0
    c.job_where("cut", "done", 60)
    assert c.status().pos_mm[:3] == pytest.approx((5, 5, 0))


@pytest.mark.parametrize("where, code, why", [
    ({"from_line": 10}, 65, "nothing moves on the path from line 10 on"),
    ({"from_mm": 1e6}, 65, "nothing of the path is left"),
    ({"from_mm": -1}, 65, "cannot begin at this place"),
    ({"from_mm": float("nan")}, 65, "cannot begin at this place"),
    ({"from_line": -1}, 65, "cannot begin at this place"),
    ({"from_line": 9, "from_mm": 3}, 65, "cannot begin at this place"),
])
def test_a_place_that_is_not_there_is_refused(machine, where, code, why):
    c = machine.client
    a = c.submit(CUT, "cut", **where)
    assert a.code == code and why in a.reason, a.reason
    assert c.ask("show", "cut").code == 66


SPARKS = """
[machine]
name = {name}
backend = sim
overrun_limit = 0
cpu = -1

[sim]
speed = 4

[jobs]
store = {store}
"""


@pytest.fixture
def sparks(tmp_path):
    """A machine with a gap; its programs are not started yet."""
    with rig.Machine(tmp_path, SPARKS) as m:
        yield m


def test_what_was_set_stays_set_through_two_power_cuts(sparks):
    m, c = sparks, sparks.client
    m.start()
    assert c.submit(b"G21 G90\nM3\nG1 X-9 F5\nM30\n", "cut").code == 0
    c.status_where(lambda s: s.state == "erode", 20)
    assert c.ask("set", text="servo_v", arg=41).code == 0
    for _ in range(2):
        c.hear(1.5)     # the checkpoint has it
        die(m)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        resume(c)
        assert c.ask("start").code == 0
        c.status_where(lambda s: s.state == "erode", 20)
    assert c.ask("set", text="servo_v", arg=42).code == 0
    c.hear(0.5)
    sets = [x for x in c.job("cut")["changes"] if x["what"] == "servo_v"]
    assert [(x["was"], x["now"]) for x in sets][-1] == (41, 42)
