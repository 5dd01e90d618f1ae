# SPDX-License-Identifier: Apache-2.0
"""A start that edmd itself refuses: nobody asks it again but a person."""

import time

import pytest
import rig

# A limit switch that lies inside the travel.
LIMIT_MACHINE = """
[machine]
name = {name}
backend = sim
overrun_limit = 0
cpu = -1

[sim]
home_off_mm = -196
speed = 4

[axis.X]
home_method = switch
jog_mm_s = 10

[jobs]
store = {store}
"""


@pytest.fixture
def limited(tmp_path):
    with rig.Machine(tmp_path, LIMIT_MACHINE) as m:
        yield m


def on_the_switch(c):
    assert c.ask("jog", text="X", arg=15).code == 0
    c.status_where(lambda s: s.fault == "limit-switch", 20)
    assert c.ask("reset").code == 0
    c.status_where(lambda s: s.state == "idle")


def begins_nothing(c, job, seconds=2.5):
    """Longer than edmd-jobs waits before it asks anything again."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        assert c.status().state in ("idle", "hold")
        assert c.job(job)["begun_us"] == 0


def test_a_start_that_edmd_refused_is_not_repeated(limited):
    limited.start()
    c = limited.client
    on_the_switch(c)
    for job in ("first", "second"):
        assert c.submit(rig.SLOW_JOB, job).code == 0
    told = c.heard(lambda: [e for e in c.events if e.kind == "waits"], 20)
    assert told[0].job == "first" and "limit switch" in told[0].text
    begins_nothing(c, "first")
    assert c.ask("start").code == 1
    begins_nothing(c, "first")
    # The cause ends, and still a person must say so.
    for job in ("second", "first"):
        assert c.ask("remove", job).code == 0
    c.status_where(lambda s: not s.job and s.state == "idle")
    assert c.ask("jog", text="X", arg=-10).code == 0
    c.status_where(lambda s: s.state == "idle" and s.pos_mm[0] < 1, 20)
