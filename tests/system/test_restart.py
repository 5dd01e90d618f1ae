# SPDX-License-Identifier: Apache-2.0
"""Either program is killed at any time: no job is lost, nothing moves."""

import os
import pathlib
import signal
import subprocess
import time

from rig import BUILD, QUICK_JOB, SLOW_JOB, NULL_MACHINE, until

LONG_JOB = b"G21 G90\nG1 X4 F60\nM30\n"


def begin(machine, text=LONG_JOB):
    c = machine.client
    assert c.submit(text, "job").code == 0
    c.status_where(lambda s: s.place_mm > 0.4)
    return c


def test_edmd_jobs_is_killed_and_finds_its_running_job(machine):
    c = begin(machine)
    place = c.statuses[-1].place_mm
    machine.kill("jobs")
    time.sleep(0.6)
    n = len(c.statuses)
    machine.start_jobs()
    s = c.heard(lambda: c.statuses[n:] and c.status_where(
        lambda s: s.daemon == "ok"))
    assert (s.job, s.job_state) == ("job", "running")
    assert s.place_mm > place + 0.4, "the cut did not go on meanwhile"
    j = c.job_where("job", "done")
    assert abs(j["job_s"] - 4) < 0.4, "it was held up"
    assert [e.kind for e in c.events].count("begun") == 1


def test_a_job_that_ends_while_edmd_jobs_is_away_is_recorded(machine):
    c = begin(machine, SLOW_JOB)
    assert c.submit(QUICK_JOB, "behind").code == 0
    machine.kill("jobs")
    time.sleep(2.5)
    machine.start_jobs()
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 2) < 1e-3
    c.job_where("behind", "done")


def test_a_job_that_ends_just_before_edmd_does_is_recorded(machine):
    """edmd-jobs is stopped over it, so it sees neither."""
    c = begin(machine, SLOW_JOB)
    log = machine.folder / "edmd.log"
    machine.jobs.send_signal(signal.SIGSTOP)
    until(lambda: "ended: done" in log.read_text())
    assert machine.end("edmd") == 0
    machine.jobs.send_signal(signal.SIGCONT)
    machine.start_edmd()
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 2) < 1e-3
    assert c.status_where(lambda s: s.daemon == "ok").interrupted == ""


def test_an_end_that_only_a_dead_edmd_saw_is_told(machine):
    """Both are killed before edmd-jobs has seen it; edmd's memory stays."""
    c = begin(machine, SLOW_JOB)
    log = machine.folder / "edmd.log"
    machine.jobs.send_signal(signal.SIGSTOP)
    until(lambda: "ended: done" in log.read_text())
    machine.kill("jobs")
    machine.kill("edmd")
    machine.start()
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 2) < 1e-3
    ended = c.heard(lambda: [e for e in c.events if e.kind == "ended"])
    assert [(e.job, e.outcome) for e in ended] == [("job", "done")]


def test_edmd_jobs_ends_in_order_and_the_job_goes_on(machine):
    c = begin(machine)
    place = c.statuses[-1].place_mm
    assert machine.end("jobs") == 0
    time.sleep(0.5)
    machine.start_jobs()
    s = c.status_where(lambda s: s.job_state == "running")
    assert s.place_mm > place + 0.3
    c.job_where("job", "done")


def test_a_job_that_was_held_at_once_stays_when_edmd_jobs_ends(machine):
    """It stood again before it was ever seen to run."""
    c = machine.client
    assert c.submit(b"G21 G90\nG1 X0.001 F60\nM0\nG1 X1\nM30\n",
                    "job").code == 0
    c.status_where(lambda s: s.job_state == "held")
    assert machine.end("jobs") == 0
    machine.start_jobs()
    s = c.status_where(lambda s: s.daemon == "ok")
    assert (s.job, s.job_state) == ("job", "held")
    assert c.job("job")["begun_us"]
    assert [e.kind for e in c.events].count("begun") == 1
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_a_queue_survives_edmd_jobs(machine):
    c = begin(machine, SLOW_JOB)
    for i in range(3):
        assert c.submit(QUICK_JOB, f"q{i}").code == 0
    machine.kill("jobs")
    machine.start_jobs()
    for i in range(3):
        c.job_where(f"q{i}", "done")


def test_a_job_that_is_ready_outlives_edmd_jobs(machine):
    """The service puts it back when it ends, and loads it when it comes: the
    end of the first loading, which edmd still tells of, is not its end.  Texts
    of several lengths are ready at several moments after that."""
    c = machine.client
    for lines in (2, 500, 2000, 4000, 6000, 8000):
        job = f"job-{lines}"
        text = b"G21 G90 F600\n" + lines * b"G1 X1\nG1 X0\n" + b"M30\n"
        assert c.submit(text, job, hold=True).code == 0
        c.job_where(job, "ready")
        for _ in range(2):
            assert machine.end("jobs") == 0
            machine.start_jobs()
            until(lambda: c.ask("show", job).code == 0
                  and c.job(job)["state"] != "queued")
            j = c.job(job)
            assert j["state"] == "ready", (lines, j["state"], j["reason"])
        assert c.ask("stop").code == 0
        c.job_where(job, "stopped")


def test_edmd_is_killed_status_says_so_and_it_comes_back_held(machine):
    c = begin(machine)
    machine.kill("edmd")
    s = c.status_where(lambda s: s.daemon == "lost")
    assert (s.job, s.state) == ("job", "unknown")
    c.heard(lambda: [e for e in c.events if e.kind == "lost"])
    assert c.ask("resume").code == 69
    machine.start_edmd()
    held = c.status_where(
        lambda s: s.daemon == "ok" and s.job_state == "held"
    )
    assert held.job == "job" and held.state == "hold"
    assert 0.4 <= held.place_mm < 4
    c.hear(1.0)
    still = c.status()
    assert still.pos_mm == held.pos_mm, "it moved by itself"
    assert c.ask("resume").code == 0
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 4) < 1e-3
    assert [e.kind for e in c.events].count("begun") == 1


def test_edmd_comes_back_within_a_blink_and_nothing_moves(machine):
    c = begin(machine)
    machine.kill("edmd")
    machine.start_edmd()
    held = c.status_where(
        lambda s: s.daemon == "ok" and s.job_state == "held"
    )
    c.hear(0.7)
    assert c.status().pos_mm == held.pos_mm
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_both_are_killed_and_the_job_goes_on_as_it_was_compiled(machine):
    c = begin(machine)
    [program] = machine.shm("program")
    was = os.stat(f"/dev/shm/{program}")
    for which in ("edmd", "jobs"):
        machine.kill(which)
    machine.start_jobs()
    machine.start_edmd()
    held = c.status_where(
        lambda s: s.daemon == "ok" and s.job_state == "held"
    )
    assert 0.4 <= held.place_mm < 4
    # Another file would be another compile.
    assert machine.shm("program") == [program]
    still = os.stat(f"/dev/shm/{program}")
    assert (still.st_ino, still.st_mtime_ns) == (was.st_ino, was.st_mtime_ns)
    assert c.ask("start").code == 0
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 4) < 1e-3


def test_edmd_starts_anew_with_a_queue_and_the_queue_waits(machine):
    c = machine.client
    assert c.submit(QUICK_JOB, "first", hold=True).code == 0
    assert c.submit(QUICK_JOB, "second").code == 0
    c.job_where("first", "ready")
    machine.kill("edmd")
    machine.start_edmd()
    c.status_where(lambda s: s.daemon == "ok")
    c.hear(1.5)
    assert c.job("first")["state"] in ("ready", "queued")
    assert c.job("second")["state"] == "queued"
    c.job_where("first", "ready")
    assert c.ask("start").code == 0
    c.job_where("second", "done")


def test_an_edmd_without_its_program_ends_the_job_without_motion(machine):
    c = begin(machine)
    machine.kill("edmd")
    # As after a reboot: shared memory is empty.
    for name in machine.shm():
        subprocess.run(["rm", f"/dev/shm/{name}"], check=True)
    machine.start_edmd()
    j = c.job_where("job", "interrupted")
    assert "interrupted in travel" in j["reason"]
    assert j["path_mm"] > 0.3
    s = c.status_where(lambda s: not s.job)
    assert s.state == "idle"
    assert c.ask("remove", "job").code == 0
    # Its axes stand where the job was, and edmd shows another place.
    assert c.submit(QUICK_JOB, "next").code == 0
    c.job_where("next", "ready")
    assert c.ask("start").code == 0
    c.job_where("next", "done")


def test_without_edmd_jobs_are_taken_and_wait(idle):
    idle.start_jobs()
    c = idle.client
    assert c.status(5).daemon == "absent"
    a = c.submit(QUICK_JOB, "early")
    assert a.code == 0
    assert "edmd is not there" in a.reason
    assert c.ask("hold").code == 69
    idle.start_edmd()
    c.job_where("early", "ready")
    c.hear(0.5)
    assert c.job("early")["state"] == "ready"
    assert c.ask("start").code == 0
    c.job_where("early", "done")


def test_an_edmd_of_another_layout_is_told_once(idle):
    """It is looked for each 20 ms."""
    status = pathlib.Path(f"/dev/shm/edmd.{idle.name}.status")
    status.write_bytes(b"another")
    idle.start_jobs()
    for _ in range(5):
        assert idle.client.status(5).daemon == "absent"
    log = (idle.folder / "edmd-jobs.log").read_text()
    assert log.count("of another layout") == 1
    status.unlink()


def test_edmd_jobs_takes_no_url_that_leaves_the_host_without_a_key(tmp_path):
    for ttl in ("ttl=1", "ttl=0&ttl=1", "ttl=01", "ttl=-1", "ttl=0&x=1"):
        config = tmp_path / "machine.ini"
        config.write_text(
            NULL_MACHINE.format(name="x", store=tmp_path / "store")
            + f"[lcm]\nurl = udpm://239.255.76.67:7667?{ttl}\n"
        )
        p = subprocess.run(
            [str(BUILD / "edmd-jobs"), "--config", str(config)],
            capture_output=True, text=True, timeout=120,
        )
        assert p.returncode == 78, ttl
        assert "ttl" in p.stderr


def test_a_second_edmd_jobs_of_one_machine_is_refused(machine):
    p = subprocess.run(
        [str(BUILD / "edmd-jobs"), "--config", str(machine.config)],
        capture_output=True, text=True, timeout=120,
    )
    assert p.returncode == 75
    assert "in use" in p.stderr
    assert machine.jobs.poll() is None


def test_a_second_edmd_jobs_with_a_store_of_its_own_is_refused(machine):
    p = subprocess.run(
        [str(BUILD / "edmd-jobs"), "--config", str(machine.config),
         "--store", str(machine.folder / "other")],
        capture_output=True, text=True, timeout=120,
    )
    assert p.returncode == 75
    assert "one edmd-jobs for a machine" in p.stderr
    c = machine.client
    assert c.submit(QUICK_JOB, "a").code == 0
    c.job_where("a", "done")


def test_nothing_is_left_in_shared_memory(machine):
    c = machine.client
    assert c.submit(QUICK_JOB, "a").code == 0
    c.job_where("a", "done")
    until(lambda: c.hear(0.02) or not machine.shm("program"))
    assert c.submit(QUICK_JOB, "b", hold=True).code == 0
    c.job_where("b", "ready")
    assert machine.shm("program")
    assert machine.end("jobs") == 0
    assert not machine.shm("program")
    assert machine.end("edmd") == 0
    assert machine.shm() == []
