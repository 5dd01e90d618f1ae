# SPDX-License-Identifier: Apache-2.0
"""What edmctl says to somebody in whose way something stands."""

import fcntl
import json
import os
import pty
import select
import signal
import socket
import struct
import subprocess
import termios
import time

import pyte
import pytest
import rig
from rig import BUILD, QUICK_JOB, SLOW_JOB, until
from test_local import ALONE
from edm import command_t, signed_t

# 9 mm at 60 mm/min take 9 s.
LONG_JOB = b"G21 G90\nG1 X9 F60\nM30\n"


def write(machine, name, text):
    path = machine.folder / name
    path.write_bytes(text)
    return str(path)


def ctl(*args, **env):
    return subprocess.run(
        [str(BUILD / "edmctl"), *args], capture_output=True, text=True,
        timeout=60, env={**os.environ, **env})


# -- Which machine


def test_a_wrong_name_is_told_with_those_that_are_heard(machine):
    p = ctl("--machine", "nosuch", "--url", rig.URL, "--timeout", "1",
            "status")
    assert p.returncode == 69
    assert f"heard machine {machine.name}; --machine NAME or " \
        "EDM_MACHINE=NAME chooses one" in p.stderr, p.stderr


def test_the_machine_may_come_from_the_environment(machine):
    p = ctl("--json", "status", EDM_MACHINE=machine.name)
    assert json.loads(p.stdout)["machine"] == machine.name
    # What is said on the command line is nearer.
    p = ctl("--machine", "other", "--timeout", "1", "status",
            EDM_MACHINE=machine.name)
    assert "machine other" in p.stderr
    p = ctl("status", EDM_MACHINE="a b")
    assert p.returncode == 64 and "EDM_MACHINE a b; 1 to 31" in p.stderr


# -- The network


@pytest.mark.needs("a network of its own")
@pytest.mark.parametrize("named", [True, False])
def test_no_multicast_is_told_in_our_words_alone(machine, named):
    """Also to somebody on whose host no service was started yet."""
    url = ["--url", rig.URL] if named else []
    p = subprocess.run(
        [*ALONE, "sh", "-c", "ip link set lo up; exec \"$@\"", "sh",
         str(BUILD / "edmctl"), "--machine", "nosuch", *url, "status"],
        capture_output=True, text=True, timeout=60)
    assert p.returncode == 69
    line, *others = p.stderr.splitlines()
    if named:
        assert line.startswith("edmctl: cannot open udpm://")
        assert others == []
    else:
        assert "no edmd-jobs listens at /dev/shm/edmd.nosuch.jobs" in line
        # And maybe those of other tests.
        assert others[0].startswith("edmctl: heard machine ")
    assert "ip route add 224.0.0.0/4 dev lo" in line


def test_a_port_that_another_program_holds_is_told(machine):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.bind(("0.0.0.0", 7999))
        p = machine.ctl("--url", "udpm://239.255.76.67:7999?ttl=0", "status")
    assert p.returncode == 69
    assert "another program holds port 7999" in p.stderr, p.stderr
    assert "ss -ulpn" in p.stderr


# -- What a job waits for


def test_submit_wait_says_what_it_waits_for(machine):
    c = machine.client
    c.submit(QUICK_JOB, "first", hold=True)
    c.job_where("first", "ready")
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "submit",
         write(machine, "q.ngc", QUICK_JOB), "--wait"],
        stdout=subprocess.PIPE, text=True)
    said = []
    while not any(x.startswith("waits: ") for x in said):
        line = p.stdout.readline()
        assert line, said
        said.append(line)
    assert said[-1] == "waits: job first, job.ngc, is before it and is " \
        "ready; edmctl start begins it\n"
    assert machine.ctl("start").returncode == 0
    out, _ = p.communicate(timeout=60)
    assert p.returncode == 0 and "job q.ngc: done" in out, out


def test_who_no_longer_waits_is_told_how_to_take_his_own_job_back(machine):
    c = machine.client
    c.submit(QUICK_JOB, "first", hold=True)
    c.job_where("first", "ready")
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "submit",
         write(machine, "q.ngc", QUICK_JOB), "--wait", "--id", "mine"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not p.stdout.readline().startswith("waits: "):
        assert p.poll() is None
    p.send_signal(signal.SIGINT)
    err = p.communicate(timeout=60)[1]
    # stop would end the first one.
    assert p.returncode == 75
    assert "job mine waits on" in err and "remove mine takes it" in err
    assert "stop" not in err


def why(machine, job):
    return json.loads(machine.client.ask("why", job).body)["why"]


def test_why_names_what_ends_the_waiting(machine):
    c = machine.client
    assert c.ask("why", "nobody").code == 66
    assert why(machine, "") == ""
    c.submit(LONG_JOB, "a", hold=True)
    c.job_where("a", "ready")
    assert "edmctl start" in why(machine, "a")
    c.ask("start")
    c.status_where(lambda s: s.job_state == "running")
    c.submit(QUICK_JOB, "b")
    assert why(machine, "a") == ""
    assert "when that one has ended" in why(machine, "b")
    c.ask("hold")
    c.status_where(lambda s: s.job_state == "held")
    assert "edmctl stop" in why(machine, "a")
    assert "is held" in why(machine, "b")
    c.ask("estop")
    c.status_where(lambda s: s.job_state == "fault")
    assert "edmctl reset" in why(machine, "b")
    c.ask("reset")
    c.ask("stop")
    c.job_where("a", "stopped")
    c.job_where("b", "ready")
    assert why(machine, "b") == "it is ready; edmctl start begins it"
    machine.kill("edmd")
    c.status_where(lambda s: s.daemon != "ok", timeout=10)
    assert "edmd is" in why(machine, "b")
    machine.start_edmd()
    c.status_where(lambda s: s.daemon == "ok", timeout=10)


def test_show_is_of_now_when_a_job_goes_on_after_a_fault(machine):
    c = machine.client
    c.submit(LONG_JOB, "a")
    c.status_where(lambda s: s.place_mm > 0.5)
    c.ask("estop")
    stood = c.job_where("a", "fault")
    assert stood["reason"] == "e-stop" and 0.4 < stood["path_mm"] < 5
    c.ask("reset")
    c.ask("start")
    c.status_where(lambda s: s.job_state == "running" and
                   s.place_mm > stood["path_mm"] + 1)
    now = c.job("a")
    assert (now["state"], now["reason"], now["ended_us"]) == ("running", "", 0)
    assert now["path_mm"] > stood["path_mm"] + 0.5
    assert now["job_s"] > stood["job_s"]
    p = machine.ctl("show", "a")
    assert "e-stop" not in p.stdout.split("faults")[0]


# -- Commands


def test_a_command_in_the_wrong_state_says_what_the_machine_does(machine):
    c = machine.client
    c.submit(QUICK_JOB, "a", hold=True)
    c.job_where("a", "ready")
    p = machine.ctl("jog", "X", "1")
    assert p.stderr == "edmctl: jog: the machine is held; jog wants it " \
        "idle: no job loaded, no fault\n"


def test_axes_may_be_lower_case(machine):
    c = machine.client
    assert machine.ctl("jog", "x", "0.5").returncode == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 0.5) < 1e-9)
    p = machine.ctl("jog", "q", "1")
    assert p.returncode == 65 and "'q'" in p.stderr


def test_each_command_is_acknowledged_once(machine):
    """On a busy machine edmctl says it again before it hears the answer."""
    c = machine.client
    sent = []

    def hear_command(_, data):
        m = command_t.decode(bytes(signed_t.decode(data).data))
        sent.append((m.client, m.seq))

    c.lcm.subscribe(f"EDM\\.{machine.name}\\.COMMAND", hear_command)
    c.hear(0.2)
    c.acks.clear()
    sent.clear()
    assert machine.ctl("--url", rig.URL, "hold").returncode == 1
    until(lambda: c.hear(0.5) or len(c.acks) >= len(sent) > 0)
    assert sorted((a.client, a.seq) for a in c.acks) == sorted(sent)


# -- The whole terminal


class Terminal:
    """edmctl watch on a terminal of so many rows and columns."""

    def __init__(self, machine, rows, columns, term="xterm", more=()):
        self.main, tty = pty.openpty()
        self.screen = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.bytes = b""
        self.size(rows, columns)
        env = {**os.environ, "TERM": term, "LC_ALL": "C.UTF-8"}
        self.p = subprocess.Popen(
            [str(BUILD / "edmctl"), "--machine", machine.name, "watch",
             *more], stdin=tty, stdout=tty, stderr=tty, env=env)
        os.close(tty)

    def size(self, rows, columns):
        fcntl.ioctl(self.main, termios.TIOCSWINSZ,
                    struct.pack("HHHH", rows, columns, 0, 0))

    def read(self, seconds=0.1):
        while select.select([self.main], [], [], seconds)[0]:
            try:
                got = os.read(self.main, 65536)
            except OSError:
                return False
            if not got:
                return False
            self.bytes += got
            self.stream.feed(got)
        return True

    def text(self):
        self.read()
        return "\n".join(self.screen.display)

    def shows(self, word):
        until(lambda: word in self.text(), timeout=5)

    def press(self, key):
        os.write(self.main, key)

    def end(self):
        until(lambda: not self.read(), timeout=5)
        os.close(self.main)
        return self.p.wait(timeout=30)


def test_watch_fills_a_terminal(machine):
    c = machine.client
    c.submit(LONG_JOB, "a", name="Gesenk für Läufer", hold=True)
    c.job_where("a", "ready")
    t = Terminal(machine, 24, 80)
    t.shows("it is ready; edmctl start begins it")
    t.shows("Gesenk für Läufer")
    c.ask("start")
    t.shows("running")
    until(lambda: "60.0" in t.text() and "mm/min, the mean" in t.text())
    c.ask("estop")
    t.shows("FAULT e-stop: emergency stop")
    t.shows("release the button; edmctl reset")
    # The window of the gap is known, and stands beside its bar.
    t.shows("window ")
    assert "X " in t.screen.display[3] and "U " in t.screen.display[4]
    # A smaller one, then a larger one.
    for rows, columns in ((10, 30), (40, 120), (1, 1), (2, 300), (24, 80)):
        t.size(rows, columns)
        t.screen.resize(rows, columns)
        t.p.send_signal(signal.SIGWINCH)
        if rows >= 10:
            t.shows("FAULT e-stop")
    t.press(b"q")
    assert t.end() == 0
    assert "goes on" in "".join(x.rstrip() for x in t.screen.display)


def test_watch_shows_a_long_name_beside_the_state(machine):
    c = machine.client
    c.submit(LONG_JOB, "a", name=63 * "x", hold=True)
    c.job_where("a", "ready")
    t = Terminal(machine, 24, 80)
    t.shows(" ready")
    row, = [r for r in t.screen.display if "ready " in r and "line" in r]
    assert row.startswith(29 * "x" + " ready ") and row.count("x") == 29
    t.press(b"q")
    assert t.end() == 0


@pytest.mark.parametrize("rows, columns", [(4, 20), (5, 20), (24, 20),
                                           (4, 200)])
def test_watch_on_a_small_terminal(machine, rows, columns):
    t = Terminal(machine, rows, columns)
    t.shows(machine.name[:12])
    t.press(b"q")
    assert t.end() == 0


@pytest.mark.parametrize("term, more", [("dumb", ()), ("", ()),
                                        ("no-such-terminal", ()),
                                        ("xterm", ("--line",))])
def test_watch_without_a_screen_is_a_line(machine, term, more):
    t = Terminal(machine, 24, 80, term, more)
    until(lambda: b"no job, 0 wait" in (t.read(), t.bytes)[1])
    t.p.send_signal(signal.SIGINT)
    assert t.end() == 0
    assert b"\x1b[?1049h" not in t.bytes
    if term in ("dumb", ""):
        assert b"\x1b" not in t.bytes


def test_watch_gives_the_terminal_back_when_the_service_goes(machine):
    t = Terminal(machine, 24, 80, more=("--timeout", "1"))
    t.shows("idle")
    machine.kill("jobs")
    assert t.end() == 69
    # ncurses has left its second page, and the reason stands on the first.
    assert t.bytes.rindex(b"\x1b[?1049l") < t.bytes.rindex(b"no answer")
    machine.start_jobs()
