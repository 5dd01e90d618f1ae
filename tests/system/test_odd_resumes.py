# SPDX-License-Identifier: Apache-2.0
"""What else may happen around a power cut: files that change, processes that
stand still, stores that were moved, answers that are given twice."""

import os
import shutil
import signal
import sqlite3

import pytest
import rig
from test_again import interrupted, resume, way_in
from test_electrode import DOWN, MACHINE as SHOP, TABLE, add, table
from test_power import die

# Two cuts of 2 mm at 60 mm/min.
CUT = (b"G21 G90 T84 M3\nG0 Z2\nG0 X0 Y0\nG0 Z0\nG1 X2 F60\nG0 Z2\n"
       b"G0 X1 Y5\nG0 Z0\nG1 X3\nM30\n")
END = (3, 5, 0)
MAP = "-100 {0}\n100 {0}\n"


def has_ended(m, c, at=END):
    assert c.ask("start").code == 0
    c.job_where("cut", "done", 60)
    assert c.status().pos_mm[:3] == pytest.approx(at)


# -- Files that change between the cut and the resume

FILES = {
    "pulse size": ("machine.ini", "[axis.X]\npulse_mm = 0.002\n"),
    "limits": ("machine.ini", "[axis.Y]\ntravel_max_mm = 4\n"),
    "joints": ("machine.ini", "[kinematics]\nchain = C(0 0 0) X Y Z\n"),
    "map": ("x.map", MAP.format(3)),
    "dialect": ("own.ini", "[dialect]\nbase = linuxcnc\n"),
}


@pytest.mark.parametrize("what", FILES)
def test_with_other_files_it_does_not_go_on(tmp_path, what):
    name, text = FILES[what]
    config = rig.NULL_MACHINE + (
        "[axis.X]\nbacklash_um = 1\npitch_map = x.map\n"
        "[nc]\ndialect = own.ini\n")
    (tmp_path / "x.map").write_text(MAP.format(2))
    (tmp_path / "own.ini").write_text("[dialect]\nbase = generic\n")
    with rig.Machine(tmp_path, config) as m:
        c = m.client
        interrupted(m, c, 5, CUT)
        die(m)
        path = tmp_path / name
        good = path.read_text()
        path.write_text(good + text if name == "machine.ini" else text)
        m.start()
        a = c.ask("resume", "cut", text="XYZABCUV")
        assert a.code == 1 and "machine file" in a.reason, a.reason
        assert c.job("cut")["state"] == "interrupted"
        die(m)
        path.write_text(good)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        resume(c)
        has_ended(m, c)


# -- Processes that stand still

def stop(process):
    os.kill(process.pid, signal.SIGSTOP)


def go_on(process):
    os.kill(process.pid, signal.SIGCONT)


def test_the_power_fails_while_edmd_stands_still(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(CUT, "cut").code == 0
    c.status_where(lambda s: s.place_mm > 5 and s.job_state == "running", 20)
    stop(m.edmd)
    s = c.status_where(lambda s: s.daemon == "lost", 10)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert c.job("cut")["path_mm"] > s.place_mm - 1.1
    resume(c)
    has_ended(m, c)


def test_it_is_resumed_while_edmd_stands_still(idle):
    m, c = idle, idle.client
    interrupted(m, c, 5, CUT)
    stop(m.edmd)
    c.status_where(lambda s: s.daemon == "lost", 10)
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1 and "edmd" in a.reason, a.reason
    go_on(m.edmd)
    c.status_where(lambda s: s.daemon == "ok", 10)
    # It stops while the answer is under way: what was said counts, or not.
    c.send_command("resume", "cut", text="XYZABCUV")
    stop(m.edmd)
    c.hear(0.7)
    go_on(m.edmd)
    c.status_where(lambda s: s.daemon == "ok", 10)
    c.hear(0.5)
    assert not any(c.status().pos_mm), "it moves by itself"
    if c.job("cut")["state"] == "interrupted":
        resume(c)
    c.job_where("cut", "ready")
    has_ended(m, c)


def test_edmd_jobs_stands_still_in_a_cut(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(CUT, "cut").code == 0
    c.status_where(lambda s: s.place_mm > 5 and s.job_state == "running", 20)
    stop(m.jobs)
    c.hear(1.5)
    go_on(m.jobs)
    was = c.status_where(lambda s: s.place_mm > 6, 10)
    c.hear(1.2)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert c.job("cut")["path_mm"] >= was.place_mm
    resume(c)
    has_ended(m, c)


def test_the_job_ends_while_edmd_jobs_stands_still(idle):
    """Nobody wrote the end down: it goes over ground that was cut."""
    m, c = idle, idle.client
    m.start()
    assert c.submit(CUT, "cut").code == 0
    c.status_where(lambda s: s.line == 9 and s.pos_mm[0] > 1.5, 30)
    stop(m.jobs)
    c.hear(6)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    cut = c.job("cut")
    assert 14 < cut["path_mm"] < cut["length_mm"]
    resume(c)
    has_ended(m, c)


# -- Stores that were moved

def test_two_machines_on_one_folder_keep_their_own(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with rig.Machine(tmp_path / "a") as a, rig.Machine(tmp_path / "b") as b:
        b.store = a.store
        b.config.write_text(rig.NULL_MACHINE.format(name=b.name,
                                                    store=a.store))
        for m, at_mm in ((a, 5), (b, 1)):
            m.start()
            assert m.client.submit(CUT, "cut").code == 0
            m.client.status_where(lambda s: s.place_mm > at_mm, 20)
        die(a)
        die(b)
        for m, at_mm in ((b, 1), (a, 5)):
            m.start()
            m.client.status_where(lambda s: s.interrupted == "cut", 10)
            assert at_mm - 1.1 < m.client.job("cut")["path_mm"]
        for m in (a, b):
            resume(m.client)
            has_ended(m, m.client)


def test_a_checkpoint_of_another_machine_is_not_believed(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with rig.Machine(tmp_path / "a") as a, rig.Machine(tmp_path / "b") as b:
        interrupted(a, a.client, 5, CUT)
        die(a)
        b.start()
        assert b.client.submit(CUT, "cut").code == 0
        b.client.status_where(lambda s: s.place_mm > 1, 20)
        die(b)
        shutil.copy(a.store / f"{a.name}.place", b.store / f"{b.name}.place")
        b.start()
        cut = b.client.job_where("cut", "stopped")
        assert "not known" in cut["reason"]
        log = (b.folder / "edmd-jobs.log").read_text()
        assert "another machine" in log, log


def test_a_whole_store_of_another_machine_is_not_gone_on_with(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with rig.Machine(tmp_path / "a") as a, rig.Machine(tmp_path / "b") as b:
        interrupted(a, a.client, 5, CUT)
        die(a)
        b.store.mkdir()
        for end in ("db", "db-wal", "place"):
            at = a.store / f"{a.name}.{end}"
            if at.exists():
                shutil.copy(at, b.store / f"{b.name}.{end}")
        b.start()
        b.client.status_where(lambda s: s.interrupted == "cut", 10)
        r = b.client.ask("resume", "cut", text="XYZABCUV")
        assert r.code == 1 and "machine file" in r.reason, r.reason


@pytest.mark.parametrize("other", [CUT + b"(other)\n", b"G21 G90\nG1 X9 F60\n"])
def test_the_record_of_another_job_is_not_gone_on_with(idle, other):
    m, c = idle, idle.client
    interrupted(m, c, 5, CUT)
    die(m)
    at = m.store / f"{m.name}.db"
    with sqlite3.connect(at) as db:
        ((record,),) = db.execute("SELECT at FROM resume")
    c = m.forget_store()
    interrupted(m, c, 1, other)
    die(m)
    with sqlite3.connect(at) as db:
        db.execute("UPDATE resume SET at=?", (record,))
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1 and "checkpoint" in a.reason, a.reason


def test_an_old_store_is_taken_up(idle):
    """That of 0.1.0: what was done is done, what waits waits."""
    m, c = idle, idle.client
    m.store.mkdir()
    sql = os.path.join(os.path.dirname(__file__), "../data/store-0.1.0.sql")
    with sqlite3.connect(m.store / f"{m.name}.db") as db:
        db.executescript(open(sql).read())
        db.execute("UPDATE job SET state='running', loaded=1, begun_us=1 "
                   "WHERE id='old-queued'")
    m.start()
    # It ran, and that version kept no place.
    old = c.job_where("old-queued", "stopped")
    assert "not known" in old["reason"], old
    assert c.job("old-done")["state"] == "done"
    assert c.status().store == "ok"
    assert c.submit(CUT, "cut").code == 0


# -- Answers

def test_it_is_resumed_once(idle):
    m, c = idle, idle.client
    interrupted(m, c, 5, CUT)
    seqs = [c.send_command("resume", "cut", text="XYZABCUV")
            for _ in range(2)]
    answers = [c.heard(lambda: c.acks_to(n))[0] for n in seqs]
    assert sorted(a.code for a in answers) == [0, 1], answers
    c.job_where("cut", "ready")
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1 and "not interrupted" in a.reason, a.reason
    assert c.ask("start").code == 0
    c.status_where(lambda s: s.job_state == "running")
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 1
    c.job_where("cut", "done", 60)


@pytest.mark.parametrize("state", ["absent", "worn"])
def test_its_electrode_is_gone(tmp_path, state):
    with rig.Machine(tmp_path, SHOP) as m:
        c = m.client
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        add(m, 3, "length=2")
        assert m.ctl("electrode", "use", "3").returncode == 0
        assert c.submit(DOWN.replace(b"Z0", b"Z-2"), "cut").code == 0
        c.status_where(lambda s: s.job_state == "running"
                       and s.pos_mm[2] < 2.8 and s.place_mm > 1, 20)
        c.hear(1)
        die(m)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        worn = table(m)[3]["wear_mm"]
        m.ctl("electrode", "set", "3", f"state={state}")
        assert c.ask("resume", "cut", text="XYZABCUV").code == 0
        told = c.heard(lambda: [e.text for e in c.events
                                if e.job == "cut" and "electrode 3" in e.text
                                and f"is {state}" in e.text])
        assert told
        assert c.job("cut")["state"] == "interrupted"
        m.ctl("electrode", "set", "3", "state=there")
        resume(c)
        assert c.ask("start").code == 0
        c.job_where("cut", "done", 60)
        assert table(m)[3]["wear_mm"] >= worn


def test_the_tip_of_the_tool_is_programmed(tmp_path):
    """G43.4 is in force where it is interrupted."""
    config = rig.NULL_MACHINE + (
        "[axis.A]\ntravel_min_mm = -110\ntravel_max_mm = 110\n"
        "[axis.B]\npresent = no\n[kinematics]\n"
        "chain = C(0 0 -120) A(0 15 -80) X Y Z\ntip_z_mm = -75\n")
    text = (b"G21 G17 G90\nG0 Z20\nG43.4\nG0 X5 Y0 Z-60 A2 C0\nF600\n"
            b"G1 X2 Y1 Z-62 A6 C9\nG1 X-2 Y1 Z-63 A9 C18\nG49\nG0 Z20\nM30\n")
    with rig.Machine(tmp_path, config) as m:
        c = m.client
        m.start()
        assert c.submit(text, "cut").code == 0
        c.status_where(lambda s: s.job_state == "running" and s.line == 6, 120)
        c.hear(0.4)
        die(m)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        resume(c)
        assert way_in(c, "cut")
        assert c.ask("start").code == 0
        c.job_where("cut", "done", 120)
        end = c.status().pos_mm
        assert c.submit(text, "whole").code == 0
        c.job_where("whole", "done", 120)
        assert c.status().pos_mm == end
