# SPDX-License-Identifier: Apache-2.0
"""A job that a power cut interrupted goes on: off the work, in along its own
path, and from there on as if nothing had been."""

import random

import pytest
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
