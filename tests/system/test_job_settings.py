# SPDX-License-Identifier: Apache-2.0
"""What is set for a job goes with it: through the queue, into its forecast, through
a kill of edmd and a loss of power."""

import math

import pytest
import rig
from test_again import resume
from test_power import die
from test_wire_passes import MACHINE as WIRE

MACHINE = WIRE.replace("cpu = -1", "cpu = -1\nfeed_default_mm_min = 240")

# A circle of 1 mm, from its middle and back; a counter-clockwise one.
CONE = (b"B1000 B0 B1000 GX L1\nB1000 B0 B4000 GY NR1\nB1000 B0 B1000 GX L3\n"
        b"DD\n")
SETTING = "taper=0.5 wire-offset=0.1 scale=2 mirror=x"
SLOPE = math.tan(math.radians(0.5))


@pytest.fixture
def wire(tmp_path):
    with rig.Machine(tmp_path, MACHINE) as m:
        m.start()
        yield m


def radius(z):
    """Of the guide at that height.  Left is inside; in the image it is that, too."""
    return 2 - 0.1 * math.hypot(1, SLOPE) - z * SLOPE


def is_on_the_cone(s):
    """The lower guide and the upper one, on their circles, on one side."""
    at = s.pos_mm
    return (math.hypot(*at[:2]) == pytest.approx(radius(-20), abs=2e-3) and
            math.hypot(*at[6:]) == pytest.approx(radius(80), abs=2e-3) and
            at[0] * at[6] + at[1] * at[7] > 0)


def submit(c, job, text=CONE, name="cone.3b", setting=SETTING, **more):
    return c.submit(text, job, name=name, setting=setting, **more)


def begun(c, job="cone"):
    return c.status_where(lambda s: s.job == job and is_on_the_cone(s), 10)


def test_the_settings_are_those_of_one_job(wire):
    c = wire.client
    for job, setting in (("plain", ""), ("large", "scale=3"), ("cone", SETTING)):
        a = submit(c, job, setting=setting, hold=True)
        assert a.code == 0, a.reason
    assert [c.job(j)["setting"] for j in ("plain", "large", "cone")] == \
        ["", "scale=3", SETTING]

    def forecasts():
        s = [c.job(j)["forecast_s"] or 0 for j in ("plain", "large")]
        return s if min(s) > 0 else None
    takes = rig.until(forecasts, 10)
    assert takes[1] == pytest.approx(3 * takes[0], rel=0.1)


def test_edmd_is_killed(wire):
    c = wire.client
    assert submit(c, "cone").code == 0
    begun(c)
    held = wire.come_back(lambda s: s.job_state == "held")
    assert is_on_the_cone(held)
    assert c.ask("start").code == 0
    c.job_where("cone", "done", 10)
    assert c.status().pos_mm == pytest.approx([0] * 8, abs=1e-3)


def test_the_power_fails(wire):
    m, c = wire, wire.client
    assert submit(c, "cone").code == 0
    begun(c)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cone", 10)
    resume(c, "cone")
    assert c.ask("start").code == 0
    # Where it goes on, a person threads the wire.
    c.status_where(lambda s: s.stand == "stop", 10)
    assert c.ask("start").code == 0
    begun(c)
    c.job_where("cone", "done", 10)
    assert c.status().pos_mm == pytest.approx([0] * 8, abs=1e-3)


def test_the_height_of_the_work_is_that_of_the_job(tmp_path):
    with rig.Machine(tmp_path, MACHINE + "[gap]\nprocess = wire\n") as m:
        m.start()
        c = m.client
        assert c.status().height_mm == 40
        a = submit(c, "cone", setting="plane=5 second-plane=20", hold=True)
        assert a.code == 0, a.reason
        c.status_where(lambda s: s.job == "cone" and s.height_mm == 15, 20)


@pytest.mark.parametrize("setting, name, wanted", [
    ("taper=81", "cone.3b", "taper=81; a number from -80 to 80 degrees"),
    ("taper", "cone.3b", "taper where a setting should be; taper=3, or taper, wire-"),
    ("taper=1 taper=2", "cone.3b", "taper twice; once"),
    ("lean=1", "cone.3b", "lean where a setting should be"),
    ("plane=41", "cone.3b", "the second one above it"),
    ("taper=45", "cone.3b", "a taper that leans too far; up to wire.angle_max_deg"),
    ("turn=90", "cone.ngc", "set for NC code; its words, or 3B and 4B"),
    ("x" * 192, "cone.3b", "these settings cannot be taken"),
    ("taper=1\n", "cone.3b", "these settings cannot be taken"),
])
def test_refused(wire, setting, name, wanted):
    text = CONE if name.endswith("3b") else b"G1 X1 F60\nM30\n"
    a = submit(wire.client, "bad", text, name, setting)
    assert a.code == 65 and wanted in a.reason, a.reason
    assert wire.client.ask("show", "bad").code != 0


def test_the_same_id_with_other_settings_is_another_job(wire):
    c = wire.client
    assert submit(c, "cone", hold=True).code == 0
    assert submit(c, "cone", hold=True).reason == "this job is here already"
    a = submit(c, "cone", setting="taper=1", hold=True)
    assert a.code == 65 and "or other settings" in a.reason


def test_edmctl_sends_what_is_set(wire, tmp_path):
    job = tmp_path / "cone.3b"
    job.write_bytes(CONE)
    r = wire.ctl("submit", job, "--id", "cone", "--hold", "--taper", "-2", "--scale",
                 "1.5", "--mirror", "y")
    assert r.returncode == 0, r.stderr
    assert wire.client.job("cone")["setting"] == "taper=-2 scale=1.5 mirror=y"
    assert "taper=-2 scale=1.5 mirror=y" in wire.ctl("show", "cone").stdout
    r = wire.ctl("submit", job, "--mirror", "z")
    assert r.returncode == 65 and "mirror=z; none, x, y or exchange" in r.stderr
    assert ":0:0:" not in r.stderr
