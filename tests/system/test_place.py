# SPDX-License-Identifier: Apache-2.0
"""A machine without home switches: a person says where an axis stands."""

import os
import re
import sys

import can_bus
import panel_states
import rig
from rig import QUICK_JOB

LONG_JOB = b"G21 G90\nG1 X4 F60\nG1 Y4\nG4 P0.2\nG1 X0\nM30\n"


def die(m):
    """What a power cut leaves: files."""
    m.kill("jobs")
    m.kill("edmd")
    m.sweep()


def jogged(m, axis, mm, to):
    assert m.ctl("jog", axis, str(mm), "--wait").returncode == 0
    i = "XYZ".index(axis)
    m.client.status_where(lambda s: abs(s.pos_mm[i] - to) < 1e-6)


def test_what_was_not_moved_stands_as_it_was_seen(idle):
    m, c = idle, idle.client
    m.start()
    jogged(m, "X", 12.5, 12.5)
    jogged(m, "Z", -3.25, -3.25)
    c.hear(1.5)                     # until it is on the disk
    die(m)
    m.start()
    s = c.status_where(lambda s: s.lost)
    assert s.lost == "XZ" and s.pos_mm[0] == 0
    jogged(m, "X", 1, 1)            # it is still known where it was
    p = m.ctl("place", "X", "as-seen")
    assert p.returncode == 0, p.stderr
    s = c.status_where(lambda s: abs(s.pos_mm[0] - 13.5) < 1e-6)
    assert c.status_where(lambda s: s.lost == "Z")
    p = m.ctl("place", "X", "as-seen")
    assert p.returncode == 1 and "seen last" in p.stderr
    assert m.ctl("place", "Z", "is", "7.5").returncode == 0
    c.status_where(lambda s: not s.lost and abs(s.pos_mm[2] - 7.5) < 1e-6)
    told = [e.text for e in c.events if e.kind == "placed"]
    assert told == [
        "X was shown at 1.000; somebody says that it stands at 13.500",
        "Z was shown at 0.000; somebody says that it stands at 7.500",
    ]


def test_a_second_power_cut_does_not_lose_what_was_seen(idle):
    m, c = idle, idle.client
    m.start()
    jogged(m, "X", 12.5, 12.5)
    c.hear(1.5)
    for _ in range(2):
        die(m)
        m.start()
        c.status_where(lambda s: s.lost == "X")
        c.hear(1.5)
    assert m.ctl("place", "X", "as-seen").returncode == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 12.5) < 1e-6)


def test_an_interrupted_job_goes_on_where_it_was(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.pos_mm[0] > 2)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut")
    for axis in "XYZABCUV":
        assert m.ctl("place", axis, "as-seen").returncode == 0
    at = c.status_where(lambda s: not s.job and s.pos_mm[0] > 1)
    assert at.pos_mm[0] < 4.01
    assert c.ask("resume", "cut", text="XYZABCUV").code == 0
    c.job_where("cut", "ready")
    assert c.ask("start").code == 0
    c.job_where("cut", "done", timeout=20)
    s = c.status_where(lambda s: not s.job)
    assert s.pos_mm[0] == 0 and abs(s.pos_mm[1] - 4) < 1e-6


def test_what_cannot_be_is_refused_with_what_would_be_accepted(machine):
    m, c = machine, machine.client
    for words, code, said in (
            (("X", "as-seen"), 1, "seen last"),
            (("X", "is", "1e9"), 1, "travel"),
            (("X", "is"), 64, "mm"),
            (("X", "was"), 64, "as-seen"),
            (("Q", "is", "1"), 65, "one of"),
    ):
        p = m.ctl("place", *words)
        assert (p.returncode, said in p.stderr) == (code, True), p.stderr
    assert c.submit(QUICK_JOB, "job", hold=True).code == 0
    c.job_where("job", "ready")
    p = m.ctl("place", "X", "is", "1")
    assert p.returncode == 1 and "idle" in p.stderr


def test_an_axis_that_something_homes_is_homed(homing):
    homing.start()
    p = homing.ctl("place", "X", "is", "1")
    assert p.returncode == 1 and "home" in p.stderr


# The drive of X knows its place when the power is back, that of Y does not.
KNOWS = can_bus.DRIVEN + """\
following_mm = 0.15

[axis.X]
absolute = yes

[jobs]
store = {store}

""" + "".join(f"[axis.{a}]\npresent = no\n" for a in "ZABCUV") + "".join(
    f"[axis.{a}]\ndrive_increments = -2000\ndrive_pulses = 1000\n"
    "travel_min_mm = -100\ntravel_max_mm = 100\n" for a in "XY")


def test_a_drive_that_knows_its_place_is_asked(tmp_path):
    fifo = tmp_path / "drives"
    os.mkfifo(fifo)
    with can_bus.Bus(tmp_path) as bus, rig.Machine(tmp_path, KNOWS) as m, \
            bus.program(sys.executable, panel_states.DRIVES, "can0", fifo,
                        "--every", 0.02, 1, 2):
        m.env = lambda program: bus.env()
        c = m.client

        def place(*words):
            while "not up yet" in (p := m.ctl("place", *words)).stderr:
                pass
            return p.returncode, p.stdout + p.stderr

        def cut_off(lost, push=0):
            c.hear(1.5)             # until it is on the disk
            die(m)
            fifo.write_text(f"leave 1\nleave 2\npush 1 {push}\n")
            m.start()
            c.status_where(lambda s: s.lost == lost, 30)

        m.start()
        rig.until(lambda: m.ctl("jog", "X", "5", "--wait").returncode == 0, 20)
        c.status_where(lambda s: s.pos_mm[0] == 5)
        cut_off("X")
        assert place("X", "as-seen")[0] == 0
        c.status_where(lambda s: not s.lost and abs(s.pos_mm[0] - 5) < 1e-6)

        cut_off("X", push=-6000)    # 3 mm, by hand
        code, said = place("X", "as-seen")
        assert code == 1
        assert "X was seen last at 5.000, and its drive tells 8.000" in said
        code, said = place("X", "is", "7")
        assert code == 0 and "stands at 7.000, and its drive tells 8.000" in said
        c.status_where(lambda s: not s.lost and abs(s.pos_mm[0] - 7) < 1e-6)

        # It is shown where it was seen, and stands elsewhere.
        code, said = place("X", "is", "0")
        assert code == 0 and "drive" not in said
        cut_off("X", push=-6000)
        told = [e.text for e in c.events if e.kind == "waits"]
        assert "X was seen last at 0.000, and its drive tells 3.000" in told[-1]
        assert m.ctl("mdi", "G0 X1").returncode == 1
        assert place("X", "is", "3")[0] == 0
        c.status_where(lambda s: not s.lost and abs(s.pos_mm[0] - 3) < 1e-6)

        assert c.submit(LONG_JOB, "cut", hold=True).code == 0
        rig.until(lambda: c.ask("start").code == 0)
        c.status_where(lambda s: s.job_state == "running" and s.place_mm > 0.2, 60)
        cut_off("XY", push=-6000)
        while "not up yet" in (a := c.ask("resume", "cut", text="XY")).reason:
            pass
        assert a.code != 0
        assert re.search(r"its drive tells that it stands at 7\.\d+: edmctl place X is",
                         a.reason), a.reason
        assert place("X", "is", "4")[0] == 0
        assert c.ask("resume", "cut", text="XY").code == 0
