# SPDX-License-Identifier: Apache-2.0
"""A long job that was interrupted is compiled before it is resumed.  What was
made is used only if it is what the resume itself would make."""

import os
import pathlib
import time

import pytest
import rig
from test_again import interrupted, resume
from test_odd_resumes import has_ended
from test_power import die

# As the cut of test_odd_resumes, and so long that it is a file.
CUT = (b"G21 G90 T84 M3\nG0 Z2\nG0 X0 Y0\nG0 Z0\nG1 X2 F60\nG0 Z2\n"
       b"G0 X1 Y5\nG0 Z0\nG1 X3\n" + b"(%s)\n" % (b"x" * 100) * 3000 + b"M30\n")
MACHINE = rig.NULL_MACHINE + "[nc]\ndialect = own.ini\n[tech]\ntable = own.tech\n"
DIALECT = "[dialect]\nbase = generic\n"
TABLE = "condition, servo_v [V]\nC120, 40\n"
READY = "cut is compiled before"
FAILED = "cut is not compiled before"


@pytest.fixture
def shop(tmp_path):
    (tmp_path / "own.ini").write_text(DIALECT)
    (tmp_path / "own.tech").write_text(TABLE)
    with rig.Machine(tmp_path, MACHINE) as m:
        yield m


def said(m, what):
    return (m.folder / "edmd-jobs.log").read_text().count(what)


def start(m, what=READY, before=None):
    """The power is back.  Wait until it has been compiled, or not."""
    n = said(m, what) if before is None else before
    m.start()
    m.client.status_where(lambda s: s.interrupted == "cut", 10)
    rig.until(lambda: said(m, what) > n, 20)


def dark(m):
    """The power goes, and the job is interrupted."""
    interrupted(m, m.client, 5, CUT)
    die(m)


def program(m):
    """The bytes of the loaded program."""
    return b"".join(pathlib.Path("/dev/shm", p).read_bytes()
                    for p in m.shm("program."))


def kept(m):
    """How many programs without a name the service has."""
    n = 0
    for fd in pathlib.Path(f"/proc/{m.jobs.pid}/fd").iterdir():
        try:
            path = os.readlink(fd)
        except FileNotFoundError:
            continue
        n += path.startswith("/dev/shm/") and path.endswith(" (deleted)")
    return n


def anew(m):
    """The same, compiled when it is resumed: before that its text was gone."""
    text = next(m.store.glob("*.text-*"))
    text.rename(m.folder / "away")
    start(m, FAILED)
    (m.folder / "away").rename(text)
    resume(m.client)
    return program(m)


def test_it_is_the_program_that_a_resume_makes(shop):
    m, c = shop, shop.client
    dark(m)
    start(m)
    assert kept(m) == 1
    text = next(m.store.glob("*.text-*"))
    text.rename(m.folder / "away")      # it is not read again
    resume(c)
    assert kept(m) == 0
    early = program(m)
    assert "was copied ahead" in (m.folder / "edmd.log").read_text()
    (m.folder / "away").rename(text)
    die(m)
    assert len(early) > 1000 and anew(m) == early
    has_ended(m, c)


def test_the_axes_moved_meanwhile(shop):
    m, c = shop, shop.client
    dark(m)
    start(m)
    n = said(m, READY)
    assert c.ask("jog", text="Y", arg=0.5).code == 0
    c.status_where(lambda s: abs(s.pos_mm[1] - 0.5) < 1e-6
                   and s.state == "idle", 10)
    rig.until(lambda: said(m, READY) > n, 20)
    assert c.ask("jog", text="X", arg=0.5).code == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 0.5) < 1e-6
                   and s.state == "idle", 10)
    resume(c)       # at once: for the place before
    has_ended(m, c)


def test_nothing_is_made_before_the_axes_are_homed(homing):
    m, c = homing, homing.client
    m.start()
    assert m.ctl("home").returncode == 0
    assert c.submit(CUT, "cut").code == 0
    c.job_where("cut", "ready")
    assert c.ask("start").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 1, 20)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    c.hear(2)                           # some looks
    assert said(m, READY) + said(m, FAILED) == 0
    assert m.ctl("home").returncode == 0
    rig.until(lambda: said(m, READY) == 1, 20)


@pytest.mark.parametrize("name, text", [
    ("own.ini", DIALECT + "[words]\nG21 = inches\n"),
    ("own.tech", TABLE.replace("40", "41")),
])
def test_a_file_was_another_meanwhile(shop, name, text):
    m, c = shop, shop.client
    dark(m)
    good = (m.folder / name).read_text()
    (m.folder / name).write_text(text)
    start(m)
    (m.folder / name).write_text(good)
    resume(c)
    early = program(m)
    die(m)
    assert anew(m) == early
    has_ended(m, c)


def test_another_table_is_still_refused(shop):
    m, c = shop, shop.client
    dark(m)
    start(m)
    (m.folder / "own.tech").write_text(TABLE.replace("40", "41"))
    assert c.ask("resume", "cut", text="XYZABCUV").code == 0
    c.heard(lambda: [e for e in c.events if "technology table is another"
                     in e.text])
    assert c.job("cut")["state"] == "interrupted"
    (m.folder / "own.tech").write_text(TABLE)
    resume(c)
    has_ended(m, c)


@pytest.mark.parametrize("after_s", [0.3, 0.6, 0.9, 1.5])
def test_the_service_is_killed_meanwhile(shop, after_s):
    m, c = shop, shop.client
    dark(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    time.sleep(after_s)
    m.kill("jobs")
    m.start_jobs()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    resume(c)
    has_ended(m, c)
    assert kept(m) == 0
    assert not m.shm("program.4")


def test_a_job_that_is_removed_keeps_nothing(shop):
    m, c = shop, shop.client
    dark(m)
    start(m)
    assert kept(m) == 1
    assert m.shm("program.") == ["edmd.%s.program.4294967295" % m.name]
    assert c.submit(rig.QUICK_JOB, "behind").code == 0
    assert c.ask("remove", "cut").code == 0
    rig.until(lambda: kept(m) == 0)
    assert not m.shm("program.4")
    c.job_where("behind", "ready")
    assert c.ask("start").code == 0
    c.job_where("behind", "done")
