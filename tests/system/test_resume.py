# SPDX-License-Identifier: Apache-2.0
"""What a killed edmd leaves to the next: axes, home, values set, a fault."""

import os

import pytest
import rig

CUT = b"G21 G90\nM3\nG1 X-15 F5\nM30\n"


@pytest.fixture
def screws(homing):
    """Homed, in a machine with play."""
    homing.start()
    assert homing.ctl("home").returncode == 0
    homing.client.status_where(
        lambda s: s.state == "idle" and s.pos_mm[0] < -19, timeout=20
    )
    return homing


def test_idle_axes_stand_where_they_stood_and_are_homed(screws):
    c = screws.client
    assert screws.ctl("jog", "X", "3").returncode == 0
    before = c.status_where(
        lambda s: s.state == "idle" and abs(s.pos_mm[0] + 17) < 0.1
    )
    after = screws.come_back(lambda s: s.state == "idle")
    assert after.pos_mm == before.pos_mm
    assert c.submit(CUT, "job", hold=True).code == 0
    c.job_where("job", "ready")
    assert c.status().pos_mm == before.pos_mm


def test_a_job_goes_on_with_what_was_set_and_without_a_new_home(screws):
    c = screws.client
    assert c.submit(CUT, "job").code == 0
    c.status_where(lambda s: s.state == "erode", timeout=20)
    assert screws.ctl("set", "servo_v", "41").returncode == 0
    held = screws.come_back(lambda s: s.job_state == "held")
    c.hear(0.5)
    assert c.status().pos_mm == held.pos_mm, "it moved by itself"
    # What is asked for again shows what it was.
    assert screws.ctl("set", "servo_v", "42").returncode == 0
    assert screws.ctl("start").returncode == 0
    c.status_where(lambda s: s.state == "erode", timeout=20)
    changes = c.job("job")["changes"]
    sets = [x for x in changes if x["what"] == "servo_v"]
    assert [(x["was"], x["now"]) for x in sets][-1] == (41, 42)


def change(machine, was, now):
    """Another machine file for the next edmd."""
    text = machine.config.read_text()
    assert was in text
    machine.config.write_text(text.replace(was, now))


def edmd_says(machine, words):
    """Its log is written by a thread that may be late."""
    log = machine.folder / "edmd.log"
    rig.until(lambda: words in log.read_text(), timeout=20)


def test_other_backlash_moves_nothing_and_is_told(screws):
    c = screws.client
    assert screws.ctl("jog", "X", "3").returncode == 0
    c.status_where(lambda s: s.state == "idle" and s.pos_mm[0] > -17.1)
    assert screws.ctl("jog", "X", "-1").returncode == 0
    before = c.status_where(
        lambda s: s.state == "idle" and abs(s.pos_mm[0] + 18) < 0.1
    )
    c.hear(0.3)
    change(screws, "backlash_um = 30", "backlash_um = 45")
    after = screws.come_back(lambda s: s.state == "idle")
    assert after.pos_mm == before.pos_mm
    edmd_says(screws, "by X -15; taken up when a command")


def test_axes_are_not_homed_to_a_place_that_is_another_now(screws):
    c = screws.client
    change(screws, "home_at_mm = -20", "home_at_mm = -21")
    screws.come_back(lambda s: s.state == "idle")
    edmd_says(screws, "home_at_mm of the machine file is not what")
    assert c.submit(CUT, "job", hold=True).code == 0
    c.hear(0.5)
    assert c.job("job")["state"] == "queued"
    assert screws.ctl("home").returncode == 0
    c.job_where("job", "ready")


def test_places_of_another_backend_are_not_believed(idle):
    c = idle.client
    idle.start()
    assert c.submit(rig.SLOW_JOB, "job").code == 0
    c.status_where(lambda s: s.pos_mm[0] > 0.3)
    idle.kill("edmd")
    change(idle, "backend = null", "backend = sim")
    idle.start_edmd()
    j = c.job_where("job", "interrupted")
    assert "edmd's log says why" in j["reason"]
    edmd_says(idle, "the backend, or a drive's node")
    assert c.status_where(lambda s: s.daemon == "ok").pos_mm[0] == 0


def test_an_e_stop_stays_latched(screws):
    c = screws.client
    assert c.submit(CUT, "job").code == 0
    c.status_where(lambda s: s.state == "erode", timeout=20)
    assert screws.ctl("estop").returncode == 0
    c.status_where(lambda s: s.state == "fault")
    s = screws.come_back(lambda s: s.state == "fault")
    assert s.fault == "e-stop"
    r = screws.ctl("start")
    assert r.returncode == 1
    assert "reset first" in r.stderr
    assert screws.ctl("reset").returncode == 0
    assert screws.ctl("start").returncode == 0
    c.status_where(lambda s: s.state == "erode", timeout=20)


def test_what_another_version_left_is_told_to_be_lost(idle):
    path = rig.pathlib.Path("/dev/shm", f"edmd.{idle.name}.status")
    path.write_bytes(bytes(4096))
    idle.start_edmd()
    edmd_says(idle, "is of another version")
    edmd_says(idle, "start_mm")


def test_a_program_that_was_swapped_is_not_gone_on_with(screws):
    c = screws.client
    assert c.submit(CUT, "job").code == 0
    c.status_where(lambda s: s.state == "erode", timeout=20)
    screws.kill("edmd")
    (name,) = screws.shm("program")
    path = rig.pathlib.Path("/dev/shm", name)
    # In place: edmd-jobs has it mapped, and may read it for the time left.
    with path.open("r+b") as block:
        block.seek(-1, os.SEEK_END)
        last = block.read(1)[0]
        block.seek(-1, os.SEEK_END)
        block.write(bytes([last ^ 1]))
    screws.start_edmd()
    j = c.job_where("job", "interrupted")
    assert "edmd's log says why" in j["reason"]
    edmd_says(screws, "is not the one that ran")
