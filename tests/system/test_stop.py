# SPDX-License-Identifier: Apache-2.0
"""A stop gets through, whatever becomes of edmd-jobs and whoever keeps it busy:
acts that end motion go to edmd itself, too."""

import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import textwrap
import threading

import panel
import pytest
from rig import BUILD, until

ROOT = pathlib.Path(__file__).resolve().parents[2]
LONG_JOB = b"G21 G90\nG1 X50 F60\nM30\n"
ENDED = {"estop": "fault", "hold": "hold", "stop": "idle"}


def runs(m):
    m.client.submit(LONG_JOB, "long")
    # What a busy edmd took too late was not done; then it waits for a start.
    until(lambda: m.client.status().job_state == "running" or
          m.client.ask("start").code == 0)
    m.client.status_where(lambda s: s.job_state == "running" and
                          s.feed_mm_s != 0)


def is_over(m, verb, how):
    """edmd-jobs is back, or goes on: what came of it, and only once."""
    if how == "killed":
        m.start_jobs()
    elif how == "stopped":
        m.jobs.send_signal(signal.SIGCONT)
    m.client.status_where(lambda s: s.daemon == "ok" and
                          s.state == ENDED[verb] and s.feed_mm_s == 0, 20)


@pytest.mark.parametrize("how", ["killed", "stopped"])
@pytest.mark.parametrize("verb", ENDED)
def test_without_edmd_jobs_edmctl_still_ends_motion(machine, verb, how):
    m = machine
    runs(m)
    m.jobs.send_signal({"killed": signal.SIGKILL,
                        "stopped": signal.SIGSTOP}[how])
    if how == "killed":
        m.jobs.wait()
    p = m.ctl("--timeout", "20", verb)
    assert p.returncode == 0, p.stderr
    assert "done by edmd itself; edmd-jobs does not answer" in p.stdout
    is_over(m, verb, how)


@pytest.mark.parametrize("verb", ENDED)
def test_with_edmd_jobs_it_is_done_once(machine, verb):
    """By both ways with one id: edmd-jobs answers, in its words."""
    m = machine
    runs(m)
    p = m.ctl(verb)
    assert (p.returncode, p.stdout) == (0, f"{verb}: done\n"), p.stderr
    is_over(m, verb, "")
    if verb == "estop":
        log = (m.folder / "edmd.log").read_text()
        assert log.count("fault e-stop") == 1, log


def test_python_ends_motion_without_edmd_jobs(machine):
    m = machine
    runs(m)
    code = textwrap.dedent("""
        import edm, os, signal, sys
        with edm.Client(sys.argv[1], timeout=20) as m:
            m.status()
            os.kill(int(sys.argv[2]), signal.SIGSTOP)
            m.hold()
            os.kill(int(sys.argv[2]), signal.SIGCONT)
    """)
    p = subprocess.run(
        [sys.executable, "-c", code, m.name, str(m.jobs.pid)], timeout=120,
        capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT / "clients/python")})
    assert p.returncode == 0, p.stderr
    is_over(m, "hold", "")


def test_a_loop_of_questions_keeps_no_stop_away(machine):
    """Each draws a name of its own, many more than edmd-jobs remembers."""
    m = machine
    runs(m)
    loops = [subprocess.Popen(
        ["sh", "-c", 'n=0; while [ $n -lt 700 ]; do n=$((n + 1)); '
         f'"{BUILD}/edmctl" --machine {m.name} queue >/dev/null || exit 1; '
         'done'], stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for p in loops:
        _, said = p.communicate(timeout=600)
        assert p.returncode == 0, said
    p = m.ctl("estop")
    assert (p.returncode, p.stdout) == (0, "estop: done\n"), p.stderr
    is_over(m, "estop", "")


def test_a_viewer_does_not_pass_by_edmd_jobs(machine):
    """On the host, who is in the group may stop; a key that may only look
    asks as it always did."""
    m = machine
    m.ctl("keys", "add", "eye", "viewer", cwd=m.folder)
    runs(m)
    p = m.ctl("--key", str(m.folder / "eye.key"), "hold")
    assert p.returncode == 77, p.stderr
    m.client.status_where(lambda s: s.job_state == "running")


def test_the_first_line_says_which_ways_are_left(machine):
    m = machine
    m.client.status()
    m.jobs.send_signal(signal.SIGSTOP)
    for verb in ("status", "watch"):
        p = m.ctl("--timeout", "1", verb)
        assert p.returncode == 69
        first = p.stderr.splitlines()[0]
        assert "hold, stop and estop go to edmd itself" in first
        assert "own emergency stop" in first
    m.edmd.send_signal(signal.SIGSTOP)
    p = m.ctl("--timeout", "1", "status")
    assert p.stderr.splitlines()[0] == "edmctl: no command reaches the " \
        "machine: use its own emergency stop"
    # Who asks for a stop in that hour is told the same.
    p = m.ctl("--timeout", "1", "estop")
    assert p.returncode == 69
    assert "use its own emergency stop" in p.stderr.splitlines()[0]
    m.edmd.send_signal(signal.SIGCONT)
    m.jobs.send_signal(signal.SIGCONT)
    m.client.status_where(lambda s: s.daemon == "ok", 20)


@pytest.fixture
def own(tmp_path):
    p = panel.Panel(tmp_path)
    p.start()
    yield p
    p.close()


@pytest.mark.parametrize("how", ["killed", "stopped"])
def test_the_panel_s_stop_works_without_edmd_jobs(own, how):
    m, me = own.machine, own.session()
    with me.live() as live:
        runs(m)
        live.where(lambda s: s.get("jobs") and
                   s["jobState"] == "running", 20)
        m.jobs.send_signal({"killed": signal.SIGKILL,
                            "stopped": signal.SIGSTOP}[how])
        if how == "killed":
            m.jobs.wait()
        live.where(lambda s: not s["jobs"] and s["daemon"] == "ok", 20)
        a = live.ask("estop")
        assert a["code"] == 0 and "edmd itself" in a["reason"], a
        live.where(lambda s: s["state"] == "fault", 20)
        is_over(m, "estop", how)


def test_every_thread_has_a_name(machine):
    for program, names in (
            (machine.edmd, {"edmd", "edmd-cycle", "edmd-commands",
                            "edmd-stops", "log"}),
            (machine.jobs, {"edmd-jobs", "jobs-checkpoint", "log"})):
        threads = pathlib.Path(f"/proc/{program.pid}/task").glob("*/comm")
        assert {t.read_text().strip() for t in threads} == names


class Deaf:
    """Listens where an edmd does, and takes the @nth act that is sent to it; the
    others it drops, as one whose places are full of others' connections."""

    def __init__(self, machine, nth):
        self.path = f"/dev/shm/edmd.{machine}.stop"
        self.acts = []
        self.nth = nth
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.bind(self.path)
        self.socket.listen(0)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while len(self.acts) < self.nth:
            end, _ = self.socket.accept()
            end.settimeout(60)
            with end:
                self.acts.append(end.recv(64))
                if len(self.acts) == self.nth:
                    magic, _, number = struct.unpack("=IIQ", self.acts[-1])
                    end.send(struct.pack("=IiQ", magic, 0, number))
                    end.recv(1)     # the other side closes

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.unlink(self.path)
        if self.thread.is_alive():  # a test that fails
            self.nth = 0
            socket.socket.shutdown(self.socket, socket.SHUT_RDWR)
        self.thread.join()
        self.socket.close()


@pytest.mark.parametrize("key", [True, False])
def test_an_act_that_edmd_dropped_is_given_to_it_again(machine, key):
    """Others may connect so often that an act finds no room at first."""
    m = machine
    name = f"{m.name}-deaf"
    argv = [str(BUILD / "edmctl"), "--machine", name, "--timeout", "30",
            "estop"]
    if key:
        m.ctl("keys", "add", "hand", "operator", cwd=m.folder)
        text = (m.folder / "hand.key").read_text().replace(m.name, name)
        (m.folder / "deaf.key").write_text(text)
        (m.folder / "deaf.key").chmod(0o600)
        argv[1:1] = ["--key", str(m.folder / "deaf.key")]
    with Deaf(name, 5) as deaf:
        p = subprocess.run(argv, capture_output=True, text=True, timeout=120)
    assert p.returncode == 0, p.stderr
    assert "done by edmd itself" in p.stdout
    assert len(deaf.acts) == 5 and len(set(deaf.acts)) == 1


def test_an_act_waits_for_an_edmd_that_starts(machine):
    m = machine
    m.jobs.send_signal(signal.SIGSTOP)
    m.kill("edmd")
    p = subprocess.Popen([str(BUILD / "edmctl"), "--machine", m.name,
                          "--timeout", "60", "estop"], stdout=subprocess.PIPE,
                         text=True)
    m.start_edmd()
    assert "done by edmd itself" in p.communicate(timeout=120)[0]
    assert p.returncode == 0
    m.jobs.send_signal(signal.SIGCONT)
    m.client.status_where(lambda s: s.fault == "e-stop", 20)
