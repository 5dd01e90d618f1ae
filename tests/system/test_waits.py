# SPDX-License-Identifier: Apache-2.0
"""Nothing starts by itself, and nobody outside can end edmd or hold it up.

The rows of "Nothing starts by itself" in docs/threat-model.md, one test each,
and what another process of the host can do to edmd's objects.
"""

import fcntl
import os
import pathlib
import signal
import socket
import struct
import subprocess
import time

import pytest
import rig
from rig import BUILD, QUICK_JOB, SLOW_JOB, NULL_MACHINE, until



def waits(c, job, state="ready", seconds=1.5):
    """It waits, and goes on waiting."""
    c.job_where(job, state)
    before = c.status().pos_mm
    c.hear(seconds)
    assert c.job(job)["state"] == state, "it began by itself"
    assert c.status().pos_mm == before


def test_accepted_while_edmd_stands_it_waits_for_a_start(machine):
    c = machine.client
    c.status()
    machine.edmd.send_signal(signal.SIGSTOP)
    try:
        c.status_where(lambda s: s.daemon == "lost")
        a = c.submit(QUICK_JOB, "early")
        assert a.code == 0
        assert "waits for a start" in a.reason
    finally:
        machine.edmd.send_signal(signal.SIGCONT)
    c.status_where(lambda s: s.daemon == "ok")
    waits(c, "early")
    assert c.ask("start").code == 0
    c.job_where("early", "done")


def test_a_command_that_edmd_finds_too_late_is_not_done(machine):
    c = machine.client
    c.status()
    machine.edmd.send_signal(signal.SIGSTOP)
    try:
        a = machine.ctl("--timeout", "5", "jog", "X", "1")
        assert a.returncode == 69
        # A slow host may find first that edmd stands still.
        assert "not done" in a.stderr or "edmd is lost" in a.stderr
    finally:
        machine.edmd.send_signal(signal.SIGCONT)
    s = c.status_where(lambda s: s.daemon == "ok")
    c.hear(1.0)
    assert c.status().pos_mm[0] == s.pos_mm[0] == 0


def test_what_nobody_waits_for_any_more_sets_nothing_in_motion(machine):
    """edmd-jobs stands still, as over a disk that is slow; who asked for a jog
    and sent a job has gone when it goes on."""
    c = machine.client
    c.status()
    machine.jobs.send_signal(signal.SIGSTOP)
    jog = c.send_command("jog", text="X", arg=3.0)
    chunks = c.chunks(QUICK_JOB, "job")
    c.send(chunks)
    time.sleep(2)
    machine.jobs.send_signal(signal.SIGCONT)
    assert c.heard(lambda: c.acks_to(jog))[0].code == 100
    assert c.heard(lambda: c.acks_to(chunks[0].seq))[0].code == 100
    c.hear(1)
    s = c.status()
    assert (s.pos_mm[0], s.state, s.queue_len) == (0, "idle", 0)
    # Who still waits signs it again, and what ends a motion is done anyway.
    c.send_command("jog", text="X", arg=3.0, seq=jog)
    assert c.heard(lambda: [a for a in c.acks_to(jog) if a.code == 0])
    c.status_where(lambda s: s.pos_mm[0] == 3)
    machine.jobs.send_signal(signal.SIGSTOP)
    estop = c.send_command("estop")
    time.sleep(2)
    machine.jobs.send_signal(signal.SIGCONT)
    assert c.heard(lambda: c.acks_to(estop))[0].code == 0


def test_a_start_with_a_fault_latched_is_refused_for_good(machine):
    c = machine.client
    assert c.submit(QUICK_JOB, "job", hold=True).code == 0
    c.job_where("job", "ready")
    assert c.ask("estop").code == 0
    assert c.ask("start").code == 1
    assert c.ask("reset").code == 0
    c.hear(1.0)
    assert c.job("job")["begun_us"] == 0
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_accepted_with_a_fault_latched_it_waits_for_a_start(machine):
    c = machine.client
    assert c.ask("estop").code == 0
    assert c.submit(QUICK_JOB, "job").code == 0
    assert c.ask("reset").code == 0
    waits(c, "job")
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_a_start_while_not_homed_is_refused_for_good(homing):
    homing.start()
    c = homing.client
    assert c.submit(b"G21 G90 F600\nG0 Z19\nM30\n", "job", hold=True).code == 0
    a = c.ask("start")
    assert (a.code, "home it" in a.reason) == (1, True)
    assert homing.ctl("home").returncode == 0
    waits(c, "job", seconds=2.5)
    assert c.ask("start").code == 0
    c.job_where("job", "done", timeout=30)


def test_a_start_without_edmd_is_refused_for_good(idle):
    idle.start_jobs()
    c = idle.client
    c.status(10)
    assert c.submit(QUICK_JOB, "job").code == 0
    a = c.ask("start")
    assert (a.code, "edmd is not there" in a.reason) == (1, True)
    idle.start_edmd()
    waits(c, "job")
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_killed_over_a_start_the_job_waits(machine):
    """edmd-jobs is killed while its job stands ready: it does not try again."""
    c = machine.client
    assert c.submit(SLOW_JOB, "job", hold=True).code == 0
    c.job_where("job", "ready")
    machine.kill("jobs")
    db = machine.store / f"{machine.name}.db"
    subprocess.run(["python3", "-c", f"""
import sqlite3
d = sqlite3.connect({str(db)!r})
n = d.execute("SELECT n FROM job").fetchone()[0]
d.execute("UPDATE job SET hold=0")
d.execute("INSERT OR REPLACE INTO number VALUES('started', ?)", (n,))
d.commit()
"""], check=True)
    machine.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    waits(c, "job")


def test_a_program_that_begins_elsewhere_moves_nothing(machine):
    """A block with other start pulses, put there behind edmd-jobs' back."""
    c = machine.client
    assert c.submit(SLOW_JOB, "job", hold=True).code == 0
    c.job_where("job", "ready")
    at = c.status().pos_mm
    (name,) = machine.shm("program")
    path = pathlib.Path("/dev/shm", name)
    data = bytearray(path.read_bytes())
    zeros = bytes(4 * 8)
    assert zeros in data
    # Every run of eight zero pulses in the head becomes 5000 on X.
    start = data.index(zeros)
    data[start:start + 4] = struct.pack("<i", 5000)
    path.write_bytes(data)
    c.hear(0.5)
    assert c.status().pos_mm == at
    machine.kill("edmd")
    machine.start_edmd()
    c.status_where(lambda s: s.daemon == "ok")
    c.hear(1.0)
    assert c.status().pos_mm == at


# -- edmd's objects ---------------------------------------------------------------

def cutting(machine):
    c = machine.client
    assert c.submit(b"G21 G90\nG1 X9 F60\nM30\n", "job").code == 0
    c.status_where(lambda s: s.place_mm > 0.2)
    return c


@pytest.mark.parametrize("how", ["cut", "filled", "removed"])
def test_a_program_pulled_away_does_not_end_the_cut(machine, how):
    c = cutting(machine)
    (name,) = machine.shm("program")
    path = pathlib.Path("/dev/shm", name)
    if how == "cut":
        os.truncate(path, 0)
    elif how == "filled":
        path.write_bytes(os.urandom(path.stat().st_size))
    else:
        path.unlink()
    place = c.status().place_mm
    c.status_where(lambda s: s.place_mm > place + 0.5)
    assert machine.edmd.poll() is None


def test_nothing_but_a_socket_is_there_to_command_edmd_by(machine):
    path = pathlib.Path(f"/dev/shm/edmd.{machine.name}.command")
    assert path.is_socket()
    assert path.stat().st_mode & 0o777 == 0o660
    with pytest.raises(OSError):
        os.truncate(path, 0)


def test_nonsense_on_the_socket_moves_nothing(machine):
    c = machine.client
    c.status()
    draw = __import__("random").Random(3)
    for i in range(300):
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as s:
            s.connect(f"/dev/shm/edmd.{machine.name}.command")
            head = s.recv(100)
            instance = head[-4:]
            if i % 3 == 0:
                s.send(draw.randbytes(draw.randrange(1, 200)))
            else:
                # A whole command, of a verb that is none, or far too late.
                verb = draw.randrange(12, 2**32) if i % 3 == 1 else 10
                until_ns = 2**62 if i % 3 == 1 else draw.randrange(10**9)
                s.send(struct.pack("<QIIdq", draw.getrandbits(63) | 1, verb,
                                   draw.randrange(2**32),
                                   draw.choice((1.0, float("nan"), 1e308)),
                                   until_ns) + instance + bytes(4))
    c.hear(0.5)
    assert machine.edmd.poll() is None
    s = c.status_where(lambda s: s.daemon == "ok")
    assert s.pos_mm == (0,) * 8 or list(s.pos_mm) == [0] * 8
    # The service finds its way back.
    until(lambda: c.ask("override", arg=1).code == 0)


def test_a_log_that_nobody_reads_holds_nothing_up(idle):
    read, write = os.pipe()
    fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 4096)
    idle.edmd = subprocess.Popen(
        [str(BUILD / "edmd"), "--config", str(idle.config)], stderr=write,
        stdout=write)
    idle.jobs = subprocess.Popen(
        [str(BUILD / "edmd-jobs"), "--config", str(idle.config)],
        stderr=write, stdout=write)
    os.close(write)
    try:
        c = idle.client
        c.status_where(lambda s: s.daemon == "ok", 15)
        for i in range(40):
            assert c.ask("estop").code == 0
            assert c.ask("reset").code == 0
        assert c.submit(QUICK_JOB, "job").code == 0
        c.job_where("job", "done")
        assert idle.end("jobs") == 0
        assert idle.end("edmd") == 0
    finally:
        os.close(read)


def test_what_a_log_reader_missed_is_counted(idle):
    read, write = os.pipe()
    fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 4096)
    idle.edmd = subprocess.Popen(
        [str(BUILD / "edmd"), "--config", str(idle.config)], stderr=write,
        stdout=write)
    os.close(write)
    idle.start_jobs()
    c = idle.client
    c.status_where(lambda s: s.daemon == "ok", 15)
    for i in range(200):
        c.ask("estop"), c.ask("reset")
    got = b""
    os.set_blocking(read, False)
    def drained():
        nonlocal got
        try:
            got += os.read(read, 65536)
        except BlockingIOError:
            c.ask("estop"), c.ask("reset")
        return b"lines were dropped" in got
    until(drained, 20)
    assert idle.end("edmd") == 0
    os.close(read)


MOUNT = """
mount -t tmpfs tmpfs /dev/shm && mkdir -m 750 /dev/shm/edmd /dev/shm/edmd-jobs || exit 1
for what in status command owner writer program.1; do
        echo mine >/dev/shm/edmd.$1.$what || exit 1
done
exec sleep 1000
"""


@pytest.mark.needs("mounts of its own")
def test_a_stranger_s_file_blocks_no_start(idle):
    """/dev/shm/edmd is made when the host boots; what a stranger then makes in
    /dev/shm is not looked at."""
    p = subprocess.Popen(["unshare", "-m", "sh", "-c", MOUNT, "sh",
                          idle.name])
    shm = pathlib.Path("/proc", str(p.pid), "root", "dev", "shm")
    last = shm / f"edmd.{idle.name}.program.1"
    inside = ["nsenter", "-t", str(p.pid), "-m", f"--wd={os.getcwd()}"]
    try:
        until(lambda: last.exists() and last.read_text())
        idle.client.key = str(idle.store / f"{idle.name}.key")
        for program in ("edmd", "edmd-jobs"):
            setattr(idle, program.replace("edmd-", ""), subprocess.Popen(
                [*inside, str(BUILD / program), "--config",
                 str(idle.config)]))
        c = idle.client
        c.status_where(lambda s: s.daemon == "ok")
        assert c.submit(QUICK_JOB, "job").code == 0
        c.job_where("job", "done")
        assert idle.end("jobs") == 0 and idle.end("edmd") == 0
        for path in shm.glob(f"edmd.{idle.name}.*"):
            if not path.name.endswith(".key"):
                assert path.read_text() == "mine\n", path
    finally:
        p.kill()
        p.wait()


def test_a_read_lock_on_the_status_blocks_no_restart(machine):
    c = cutting(machine)
    c.ask("hold")
    place = c.status_where(lambda s: s.state == "hold").place_mm
    machine.kill("edmd")
    with open(f"/dev/shm/edmd.{machine.name}.status", "rb") as f:
        fcntl.lockf(f, fcntl.LOCK_SH)
        machine.start_edmd()
        s = c.status_where(lambda s: s.daemon == "ok" and s.state == "hold")
        assert abs(s.place_mm - place) < 1e-6, "the place was lost"
    r = subprocess.run(
        [str(BUILD / "edmd"), "--config", str(machine.config)],
        capture_output=True, text=True, timeout=20)
    assert r.returncode == 69, "a second edmd"


@pytest.mark.parametrize("ends", [("stop",), ("hold",), ("estop", "reset")])
def test_what_is_sent_while_motion_is_ended_waits_for_a_start(machine, ends):
    """A long text is checked for minutes: who ends motion meanwhile is not
    taken by surprise."""
    c = machine.client
    pieces = c.chunks(QUICK_JOB, "late", size=10)
    c.send(pieces[:-1])
    c.heard(lambda: all(c.acks_to(p.seq) for p in pieces[:-1]))
    a = c.ask(ends[0])
    assert a.code == 0, a.reason
    for verb in ends[1:]:
        assert c.ask(verb).code == 0
    c.send(pieces[-1:])
    a = c.heard(lambda: c.verdict(pieces))
    assert a.code == 0 and "it will wait for start" in a.reason, a.reason
    c.job_where("late", "ready")
    c.hear(0.5)
    assert c.job("late")["state"] == "ready", "it began by itself"
    assert c.ask("start").code == 0
    c.job_where("late", "done")
