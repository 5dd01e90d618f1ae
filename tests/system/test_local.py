# SPDX-License-Identifier: Apache-2.0
"""Clients of the machine's own host need no network: they ask edmd-jobs by a
socket in the file system.  LCM's multicast is for all others."""

import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import textwrap
import time

import pytest
import rig
from rig import BUILD, QUICK_JOB, SLOW_JOB, until
from test_python import good

ALONE = ["unshare", *([] if os.getuid() == 0 else ["-r"]), "-n"]


class Local(rig.Client):
    """The client of the tests, by the socket instead of LCM's library: what
    goes there are the same packets."""

    def __init__(self, machine):
        super().__init__(machine)
        self.takes = {}
        for name, kind, where in (("ACK", rig.ack_t, self.acks),
                                  ("STATUS", rig.status_t, self.statuses),
                                  ("EVENT", rig.event_t, self.events)):
            self.takes[f"EDM.{machine}.{name}"] = kind, where
        self.way = self.connect()

    def connect(self):
        s = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        s.connect(f"/dev/shm/edmd.{self.machine}.jobs")
        return s

    def publish_raw(self, channel, data):
        self.way.send(b"LC02" + bytes(4) +
                      f"EDM.{self.machine}.{channel}".encode() + b"\0" + data)

    def hear(self, seconds=0.02):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.way.settimeout(left)
            try:
                packet = self.way.recv(65536)
            except TimeoutError:
                return
            assert packet[:4] == b"LC02", packet
            stop = packet.index(b"\0", 8)
            channel = packet[8:stop].decode()
            self._take(channel, packet[stop + 1:], *self.takes[channel])


class Lonely(rig.Machine):
    """Each of its programs has a network of its own, without any way out."""

    def _command(self, program):
        return [*ALONE, *super()._command(program)]

    def _clear(self):
        for verb in ("hold", "reset", "stop"):
            self.ctl(verb)
        # It is at its end a while behind the answer.
        rig.until(lambda: not json.loads(
            self.ctl("--json", "status").stdout)["job"])

    def ctl(self, *args):
        return subprocess.run(
            [*self._command("edmctl"), "--machine", self.name, "--timeout",
             "20", *args], capture_output=True, text=True, timeout=120)


@pytest.fixture
def lonely(tmp_path):
    with Lonely(tmp_path) as m:
        m.start_edmd()
        m.start_jobs()
        yield m


def log_of(m):
    return (m.folder / "edmd-jobs.log").read_text()


@pytest.mark.needs("a network of its own")
def test_without_any_network_all_of_one_host_goes_on(lonely):
    """No multicast, no route, no loopback: submit, watch, record, stop."""
    m = lonely
    text, csv = m.folder / "slow.ngc", m.folder / "run.csv"
    text.write_bytes(SLOW_JOB)
    until(lambda: m.ctl("status").returncode == 0)
    record = subprocess.Popen(
        [*m._command("edmctl"), "--machine", m.name, "record", str(csv),
         "--until-end"], stdout=subprocess.PIPE, text=True)
    until(lambda: csv.exists())
    p = m.ctl("submit", "--wait", str(text))
    assert p.returncode == 0, p.stderr
    assert record.wait(timeout=60) == 0
    assert csv.read_text().count("\n") > 100
    assert "done" in m.ctl("history").stdout
    assert m.ctl("watch", "--once").returncode == 0
    assert m.ctl("estop").returncode == 0
    assert "e-stop" in m.ctl("status").stdout
    said = [x for x in log_of(m).splitlines() if "multicast" in x]
    assert len(said) == 1 and "ip route add 224.0.0.0/4" in said[0], said


@pytest.mark.needs("a network of its own")
def test_the_python_package_needs_no_network_either(lonely):
    code = ("import edm, sys; m = edm.Client(sys.argv[1], timeout=20); "
            "print(m.submit(b'G1 X1 F600\\nM30\\n', 'a.ngc').id, "
            "m.status().state)")
    until(lambda: lonely.ctl("status").returncode == 0)
    p = subprocess.run(
        [*ALONE, sys.executable, "-c", code, lonely.name],
        capture_output=True, text=True, timeout=120,
        env={**os.environ, "PYTHONPATH": str(
            pathlib.Path(__file__).resolve().parents[2] / "clients/python")})
    assert p.returncode == 0, p.stderr
    assert len(p.stdout.split()) == 2


@pytest.mark.needs("a network of its own")
def test_multicast_that_comes_later_is_joined(tmp_path):
    """As at boot, when the network is up later than the service."""
    m = rig.Machine(tmp_path)
    m.store.mkdir()
    log = m.folder / "edmd-jobs.log"
    p = subprocess.run(
        [*ALONE, "sh", "-ec", f"""
        '{BUILD}/edmd-jobs' --config '{m.config}' 2>'{log}' &
        n=0
        until grep -q 'no multicast' '{log}'
        do n=$((n + 1)); [ $n -lt 300 ]; sleep 0.1; done
        ip link set lo up multicast on
        ip route add 224.0.0.0/4 dev lo
        until grep -q 'there is multicast now' '{log}'
        do n=$((n + 1)); [ $n -lt 600 ]; sleep 0.1; done
        ip -4 maddr show dev lo | grep -q 239.255.76.67
        kill $!
        wait $!"""], capture_output=True, text=True, timeout=120)
    assert p.returncode == 0, p.stderr + log.read_text()
    assert m.sweep() == []


def test_status_and_events_come_by_the_socket_and_answers_only_there(machine):
    """And programs of LCM go on to hear all but the answers of others."""
    here, other, lcm = Local(machine.name), Local(machine.name), machine.client
    assert here.submit(QUICK_JOB, "one").code == 0
    here.heard(lambda: any(e.kind == "ended" or e.outcome == "done"
                           for e in here.events))
    other.heard(lambda: len(other.events) >= len(here.events))
    lcm.heard(lambda: len(lcm.events) >= len(here.events))
    assert here.status().machine == machine.name
    assert other.status().machine == machine.name
    assert lcm.status().machine == machine.name
    assert other.acks == [] and lcm.acks == []
    assert lcm.ask("queue").code == 0
    assert lcm.acks and other.acks == []


def test_who_asks_over_the_network_is_answered_there(machine):
    """Whoever asked by the socket at the same moment."""
    near, far = Local(machine.name), machine.client
    for client in (near, far):
        assert client.ask("queue").code == 0
    os.kill(machine.jobs.pid, signal.SIGSTOP)
    near.send_command("queue")
    seq = far.send_command("queue")
    os.kill(machine.jobs.pid, signal.SIGCONT)
    far.heard(lambda: far.acks_to(seq))
    assert far.ask("queue").code == 0


def test_who_repeats_a_packet_of_another_gets_no_answers_of_his(machine):
    near, far = Local(machine.name), machine.client
    m = rig.command_t()
    m.client, m.seq, m.verb = far.name, far.number(), "queue"
    packet = far.seal("COMMAND", m.encode()).encode()
    far.publish_raw("COMMAND", packet)
    far.heard(lambda: far.acks_to(m.seq))
    near.publish_raw("COMMAND", packet)
    near.hear(0.5)
    assert far.ask("queue").code == 0


def test_who_does_not_read_stops_nobody(machine):
    """Its packets are dropped when its end is full."""
    slow = Local(machine.name)
    assert slow.ask("queue").code == 0
    # More answers than any buffer holds, and none is read.
    for _ in range(1500):
        try:
            slow.way.settimeout(1)
            slow.send_command("history")
        except TimeoutError:
            break
    quick = Local(machine.name)
    for _ in range(50):
        assert quick.ask("queue").code == 0
    quick.status()
    assert machine.ctl("hold").returncode in (0, 1)
    # What it reads at last is whole.
    slow.hear(0.2)
    assert slow.statuses and slow.forged == 0


def test_one_user_s_clients_leave_room_and_what_is_no_packet_is_dropped(
        machine):
    """The one beyond takes the place of the one that was silent longest."""
    first = Local(machine.name)
    ends = [first.way, first.connect()]
    c = Local(machine.name)
    assert c.ask("queue").code == 0
    more = []
    for _ in range(63):
        more.append(c.connect())
    until(lambda: is_closed(ends[0]) and is_closed(ends[1]))
    assert c.ask("queue").code == 0
    p = machine.ctl("queue")
    assert p.returncode == 0, p.stderr
    assert c.ask("queue").code == 0
    assert not is_closed(more[-1])
    for s, junk in zip(more[-2:], (b"x", b"LC02" + bytes(70))):
        s.send(junk)
    assert c.ask("queue").code == 0


def is_closed(s):
    s.setblocking(False)
    try:
        while s.recv(65536):
            pass
        return True
    except BlockingIOError:
        return False


def test_a_client_finds_the_service_again(machine):
    """Also one that was there before it."""
    code = """
        import edm, sys, signal
        m = edm.Client(sys.argv[1], timeout=60)
        print(m.status().state, flush=True)
        sys.stdin.readline()
        m.ask("hello")
        print(m.status().state, flush=True)
    """
    root = pathlib.Path(__file__).resolve().parents[2]
    p = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), machine.name],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": str(root / "clients/python")})
    assert p.stdout.readline() == "idle\n"
    watch = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "--json",
         "--timeout", "60", "watch", "--line"], stdout=subprocess.PIPE,
        text=True)
    assert watch.stdout.readline()
    machine.kill("jobs")
    machine.start_jobs()
    p.stdin.write("\n")
    out, _ = p.communicate(timeout=120)
    assert out == "idle\n"
    # What it printed before the kill may still be in the pipe.
    machine.client.status_where(lambda s: s.daemon == "ok")
    for _ in range(20):
        assert watch.stdout.readline()
    watch.send_signal(signal.SIGINT)
    watch.communicate(timeout=60)


@pytest.mark.skipif(os.getuid() != 0, reason="needs another user")
def test_a_stranger_who_listens_there_is_not_asked(idle):
    """Anybody may make a file in /dev/shm."""
    path = f"/dev/shm/edmd.{idle.name}.jobs"
    code = ("import os, socket, sys; os.setuid(65534); "
            "s = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET); "
            "s.bind(sys.argv[1]); s.listen(); os.chmod(sys.argv[1], 0o777); "
            "print('ready', flush=True); c, _ = s.accept(); "
            "print(len(c.recv(65536)), flush=True)")
    p = subprocess.Popen([sys.executable, "-c", code, path],
                         stdout=subprocess.PIPE, text=True)
    try:
        assert p.stdout.readline() == "ready\n"
        r = idle.ctl("--timeout", "1", "hold")
        assert r.returncode == 69, r.stderr
        out, _ = p.communicate(timeout=60)
        assert out == "0\n"
        good("""
            import edm, sys
            from edm.way import _connect
            assert _connect(sys.argv[1]) is None
        """, idle.name)
    finally:
        p.kill()
        pathlib.Path(path).unlink(missing_ok=True)


def test_an_url_that_is_named_means_the_network(machine):
    p = machine.ctl("--url", "udpm://239.255.76.67:7999?ttl=0", "--timeout",
                    "1", "queue")
    assert p.returncode == 69, p.stderr
    assert machine.ctl("--url", rig.URL, "queue").returncode == 0


def test_the_log_names_the_user_who_asked_by_the_socket(machine):
    c = Local(machine.name)
    c.status()
    s = c.seal("COMMAND", b"", boot=c.boot)
    s.signature = bytes(64)
    c.publish_raw("COMMAND", s.encode())
    until(lambda: f"uid {os.getuid()}, pid {os.getpid()}" in log_of(machine))
