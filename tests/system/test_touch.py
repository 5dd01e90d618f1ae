# SPDX-License-Identifier: Apache-2.0
"""A set-up that ends in a zero: what is felt goes into an offset or into an
electrode, and the next job cuts there."""

import json

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
    go(m, "G53 G0 Z10")
    at = first_cut(m, "G55")
    for axis, mm in zero.items():
        assert at["XYZ".index(axis)] == pytest.approx(mm, abs=1.5 * PULSE)


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
    (("T3", "bore"), "T3"), (("T0", "Z=1"), "'T0'"), (("T84", "Z=1"), "'T84'"),
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
