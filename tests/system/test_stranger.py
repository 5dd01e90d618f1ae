# SPDX-License-Identifier: Apache-2.0
"""What anybody on the host can put on the wire without a key: what was recorded,
and what is signed by a key of his own.  No client is turned away by it, or
believes it.

The service here is the test itself, with the machine's own key, so that what
comes when does not depend on who is quicker.
"""

import os
import pathlib
import subprocess
import sys
import threading
import time
import weakref

import lcm
import pytest
import rig
from rig import BUILD, URL, ack_t, command_t, signed_t, status_t, until

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOW, OLD = 4711, 815                   # boots
SINCE_S = 3600

PYTHON = """
import sys, edm
c = edm.Client(sys.argv[1], key=sys.argv[2], timeout=60)
if sys.argv[3] == "status":
    print("state", c.status().state)
else:
    print(c.ask(sys.argv[3]).reason)
"""


def pairs(path):
    words = rig.key_file(path)
    secret = rig.Ed25519PrivateKey.from_private_bytes(
        bytes.fromhex(words["secret"]))
    return secret, bytes.fromhex(words["public"])


class Service:
    """Signs as the machine, and answers as told."""

    def __init__(self, idle):
        idle.start_jobs()
        keys = [idle.store / f"{idle.name}.{k}" for k in ("key",
                                                          "machine-key")]
        until(lambda: all(k.exists() for k in keys))
        until(lambda: pathlib.Path(idle.client.key).exists())
        assert idle.end("jobs") == 0
        self.name, self.key = idle.name, keys[0]
        self.secret, self.public = pairs(keys[1])
        self.begun = time.monotonic() - SINCE_S
        self.asked = []                # boot and count of each hello
        self.net = lcm.LCM(URL)
        me = weakref.proxy(self)
        self.net.subscribe(f"EDM\\.{idle.name}\\.COMMAND",
                           lambda _, data: me.take(data))
        self.over = threading.Event()

    def clock(self):
        return int((time.monotonic() - self.begun) * 1e6)

    def send(self, channel, data, boot=NOW, count=None, secret=None,
             public=None):
        s = signed_t()
        s.key, s.boot = public or self.public, boot
        s.count = self.clock() if count is None else count
        s.signature = (secret or self.secret).sign(rig.signed_bytes(
            f"EDM.{self.name}.{channel}", s.boot, s.count, data))
        s.size, s.data = len(data), data
        self.net.publish(f"EDM.{self.name}.{channel}", s.encode())

    def tell(self, state, **more):
        s = status_t()
        for word in ("daemon", "fault", "faults", "job", "job_name",
                     "job_state", "condition", "store", "interrupted", "lost"):
            setattr(s, word, "")
        s.machine, s.state, s.daemon = self.name, state, "ok"
        self.send("STATUS", s.encode(), **more)

    def answer(self, s, m, code=0):
        a = ack_t()
        a.key, a.client, a.seq, a.code = s.key, m.client, m.seq, code
        a.reason, a.body = "done", ""
        self.send("ACK", a.encode())

    def is_now(self, s):
        return s.boot == NOW and abs(s.count - self.clock()) < 10e6

    def take(self, data):
        s = signed_t.decode(data)
        m = command_t.decode(bytes(s.data))
        self.asked.append((m.verb, s.boot, s.count))
        self.on_command(s, m)

    def serve(self, often, command):
        """Until the client @command ends; often() every 50 ms."""
        p = subprocess.Popen(command, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True,
                             env={**os.environ, "PYTHONPATH":
                                  str(ROOT / "clients/python")})
        end = time.monotonic() + 60
        while p.poll() is None and time.monotonic() < end:
            self.net.handle_timeout(50)
            often()
        p.kill()
        return p.returncode, p.stdout.read()


@pytest.fixture(params=["edmctl", "python"])
def client(request):
    """Its command line, for a machine, its key and a verb."""
    def of(service, verb):
        if request.param == "python":
            return [sys.executable, "-c", PYTHON, service.name,
                    str(service.key), verb]
        return [str(BUILD / "edmctl"), "--machine", service.name, "--key",
                str(service.key), "--timeout", "60", verb]
    return of


def test_who_signs_with_a_key_of_his_own_turns_nobody_away(idle, client):
    """He signs first; then the service answers."""
    service, heard = Service(idle), []
    stranger = rig.Ed25519PrivateKey.generate()
    public = stranger.public_key().public_bytes_raw()

    def on_command(s, m):
        heard.append(m.verb)
        if len(heard) > 3:
            service.answer(s, m, 0 if service.is_now(s) else 100)

    service.on_command = on_command
    rc, said = service.serve(
        lambda: service.tell("fault", secret=stranger, public=public),
        client(service, "hold"))
    assert (rc, "done" in said) == (0, True), said
    assert heard[-1] == "hold"


def test_a_recorded_status_is_not_news(idle, client):
    """It comes behind the ack that tells the boot, and was signed before."""
    service = Service(idle)

    def on_command(s, m):
        recorded = service.clock() - 60_000_000
        service.answer(s, m, 0 if service.is_now(s) else 100)
        service.tell("idle", count=recorded)

    service.on_command = on_command
    turns = []

    def often():
        # Long behind the recorded one.
        turns.extend([1] if service.asked else [])
        if len(turns) > 10:
            service.tell("fault")

    rc, said = service.serve(often, client(service, "status"))
    assert rc == 0 and "fault" in said and "idle" not in said, said


def test_a_hello_is_signed_for_the_status_that_was_heard(idle, client):
    """The service answers no hello of no start, as if others had used up all of
    such answers.  A recorded status of an earlier start leads nobody astray."""
    service, told = Service(idle), []

    def on_command(s, m):
        if service.is_now(s):
            service.answer(s, m)

    def often():
        told.append(1)
        if len(told) % 2:
            service.tell("idle", boot=OLD, count=10**15)
        else:
            service.tell("idle")

    service.on_command = on_command
    rc, said = service.serve(often, client(service, "hold"))
    assert (rc, "done" in said) == (0, True), said
    assert service.asked[0][1] == 0


def left_in_the_kernel(pid):
    """Packets that the socket of multicast of a process did not take."""
    return sum(int(r[12]) for r in rig.udp_rows(pid)
               if rig.udp_port(r) == rig.GROUP[1])


def test_a_packet_for_another_machine_wakes_no_service(idle):
    """All services of a host are in one group, so each packet comes to all of
    them; the kernel keeps those that are for another one."""
    net = lcm.LCM(URL)
    n = len(idle.name)

    def left():
        for channel in (f"EDM.{'x' * n}.COMMAND", f"EDM.{idle.name}.TRACE",
                        f"EDM.{idle.name}.JOBS", f"EDM.{idle.name}.COMMAN"):
            net.publish(channel, bytes(100))
        return left_in_the_kernel(idle.jobs.pid) >= 40

    idle.start_jobs()
    until(left)
    assert idle.client.ask("hello").code == 0
    assert idle.end("jobs") == 0
    assert "strange" not in (idle.folder / "edmd-jobs.log").read_text()
