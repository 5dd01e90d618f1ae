# SPDX-License-Identifier: Apache-2.0
"""What probing found survives a crash of edmd, and a power cut."""

import pytest
import rig
from test_power import die

# A block whose upper face is at Z -1.5, and an electrode 0.5 mm over it.
BLOCK_MACHINE = """
[machine]
name = {name}
period_us = 1000
overrun_limit = 0
cpu = -1

[axis.Z]
start_mm = -1

[probe]
feed_mm_s = 1
fine_mm_s = 0.2

[sim]
block = yes
block_top_mm = -1.5

[jobs]
store = {store}
"""

JOB = b"G80 Z-\nG92 Z0\nG90 G0 Z0.4\nG4 P3\nG0 Z0.7\nM2\n"


@pytest.fixture
def block(tmp_path):
    with rig.Machine(tmp_path, BLOCK_MACHINE) as m:
        m.start()
        yield m


def come_back(machine):
    return machine.come_back(lambda s: s.job_state == "held")


def ends_over_the_face(machine):
    c = machine.client
    assert c.ask("start").code == 0
    c.job_where("job", "done")
    assert c.status().pos_mm[2] == pytest.approx(-0.8, abs=0.0015)


def test_places_still_count_from_the_contact(block):
    c = block.client
    assert c.submit(JOB, "job").code == 0
    c.status_where(lambda s: abs(s.pos_mm[2] + 1.1) < 0.0015)
    held = come_back(block)
    assert held.pos_mm[2] == pytest.approx(-1.1, abs=0.0015)
    c.hear(0.5)
    assert c.status().pos_mm == held.pos_mm, "it moved by itself"
    ends_over_the_face(block)


def test_a_probing_motion_that_was_under_way_is_made_again(block):
    c = block.client
    assert c.submit(JOB, "job").code == 0
    c.status_where(lambda s: s.state == "probe" and s.pos_mm[2] < -1.1)
    come_back(block)
    ends_over_the_face(block)


def power_cut(machine):
    die(machine)
    machine.start()
    c = machine.client
    c.status_where(lambda s: s.interrupted == "job", 10)
    assert c.status().pos_mm[2] == pytest.approx(-1)
    a = c.ask("resume", "job", text="XYZABCUV")
    assert a.code == 0, a.reason
    c.status_where(lambda s: s.state == "hold" and s.job_state == "ready", 10)


def test_a_power_cut_behind_the_contact(block):
    c = block.client
    assert c.submit(JOB, "job").code == 0
    c.status_where(lambda s: abs(s.pos_mm[2] + 1.1) < 0.0015)
    c.hear(1.2)     # the checkpoint has it
    power_cut(block)
    told = c.heard(lambda: [e.text for e in c.events
                            if e.kind == "waits" and e.job == "job"])[0]
    # Where the axis will be, and not what the program calls it.
    assert "Z-1.1" in told, told
    ends_over_the_face(block)


def test_a_power_cut_while_it_feels(block):
    c = block.client
    assert c.submit(JOB, "job").code == 0
    c.status_where(lambda s: s.state == "probe" and s.pos_mm[2] < -1.2)
    power_cut(block)
    ends_over_the_face(block)
