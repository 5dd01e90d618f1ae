# SPDX-License-Identifier: Apache-2.0
"""Another host on the network: what it sends is not taken without a key.

The other host is a network namespace behind a pair of virtual interfaces.
EDM_HOSTILE is the number of hostile packets; `make hostile` sends 100,000.

How late the cycle wakes depends on who else runs on this machine, so it is
printed, of a time with and of one without hostile packets, and not judged.  What
is judged is that nothing of such a packet comes to edmd: its cycle goes on, and
the threads that wait for commands and for lines of the log are not woken once.
"""

import collections
import os
import pathlib
import random
import re
import struct
import subprocess
import sys

import pytest
import rig
from rig import BUILD, NULL_MACHINE, command_t

HOSTILE = int(os.environ.get("EDM_HOSTILE", "5000"))
HERE, THERE = "10.99.7.1", "10.99.7.2"
pytestmark = pytest.mark.needs("a network of its own")

GROUP = ("239.255.76.67", 7667)

SENDER = """
import socket, struct, sys, time
here, group, ttl = sys.argv[1], sys.argv[2], int(sys.argv[3])
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
n = 0
while True:
    head = sys.stdin.buffer.read(4)
    if len(head) < 4:
        break
    packet = sys.stdin.buffer.read(struct.unpack(">I", head)[0])
    for to in (here, group):
        try:
            s.sendto(packet, (to, 7667))
            n += 1
        except OSError:
            pass
    if n % 40 == 0:
        time.sleep(0.002)
print(n)
"""


def ip(*words):
    subprocess.run(["ip", *words], check=True)


@pytest.fixture
def other_host():
    """How to run something there."""
    p = subprocess.Popen(["unshare", "-n", "sleep", "1000"])
    try:
        inside = ["nsenter", "-t", str(p.pid), "-n"]
        rig.until(lambda: os.readlink(f"/proc/{p.pid}/ns/net")
                  != os.readlink("/proc/self/ns/net"))
        ip("link", "add", "edm-here", "type", "veth", "peer", "name",
           "edm-there", "netns", str(p.pid))
        ip("addr", "add", f"{HERE}/24", "dev", "edm-here")
        ip("link", "set", "edm-here", "up", "multicast", "on")
        for words in (["addr", "add", f"{THERE}/24", "dev", "edm-there"],
                      ["link", "set", "edm-there", "up", "multicast", "on"],
                      ["link", "set", "lo", "up"],
                      ["route", "add", "224.0.0.0/4", "dev", "edm-there"]):
            subprocess.run([*inside, "ip", *words], check=True)
        yield inside
    finally:
        p.kill()
        p.wait()
        subprocess.run(["ip", "link", "del", "edm-here"], check=False,
                       capture_output=True)


def hostile(c, draw, n):
    """Packets that must not be taken, of all kinds."""
    def command(verb):
        m = command_t()
        m.utime, m.client, m.seq = 0, c.name, c.number()
        m.verb, m.job, m.arg, m.text = verb, "", 1.0, "X"
        return m.encode()

    def packet(channel, data):
        return (struct.pack(">II", 0x4c433032, draw.getrandbits(32))
                + f"EDM.{channel}.COMMAND".encode() + b"\0" + data)

    good = c.machine
    # Recorded: what was sent to another machine of the same key, and what was
    # taken here before.
    c.machine = "other"
    crossed = [packet(good, c.seal("COMMAND", command("jog")).encode())
               for _ in range(20)]
    c.machine = good
    taken = []
    for verb in ("estop", "reset"):
        data = c.seal("COMMAND", command(verb)).encode()
        c.publish_raw("COMMAND", data)
        taken.append(packet(good, data))
        c.hear(0.3)
    fresh = [packet(good, c.seal("COMMAND", command("jog")).encode())
             for _ in range(50)]
    for i in range(n):
        kind = i % 5
        if kind == 0:
            yield packet(good, command(draw.choice(("estop", "jog"))))
        elif kind == 1:
            yield draw.choice(taken)
        elif kind == 2:
            yield draw.choice(crossed)
        elif kind == 3:
            whole = draw.choice(fresh)
            yield whole[:draw.randrange(len(whole))]
        else:
            # Not in LCM's number: that is no part of the message.
            bad = bytearray(draw.choice(fresh))
            bad[draw.randrange(8, len(bad))] ^= 1 << draw.randrange(8)
            yield bytes(bad)


def send_there(inside, packets, ttl=1):
    data = b"".join(struct.pack(">I", len(p)) + p for p in packets)
    out = subprocess.run(
        [*inside, sys.executable, "-c", SENDER, HERE, GROUP[0], str(ttl)],
        input=data, capture_output=True, check=True, timeout=300).stdout
    assert int(out) >= len(packets), "they could not be sent"


def switches(machine):
    """How often each thread of edmd was put to sleep, or made room."""
    counts = {}
    for task in pathlib.Path(f"/proc/{machine.edmd.pid}/task").iterdir():
        words = (task / "status").read_text().split()
        counts[task.name] = sum(
            int(words[words.index(f"{kind}_ctxt_switches:") + 1])
            for kind in ("voluntary", "nonvoluntary"))
    return counts


def woken(machine, meanwhile):
    """How often each thread of edmd ran while meanwhile() did."""
    before = switches(machine)
    meanwhile()
    after = switches(machine)
    assert before.keys() == after.keys()
    return {tid: after[tid] - before[tid] for tid in after}


def wakes(machine):
    """The cycle's histogram: {us: times}."""
    out = machine.ctl("latency").stdout.split("what a period took")[0]
    return collections.Counter({
        int(us): int(n)
        for us, n in re.findall(r"^ *(\d+) us\+? +(\d+)$", out, re.M)})


def summary(counts):
    late = sorted(counts.elements())
    return (f"{len(late)} wakes, median {late[len(late) // 2]} us, "
            f"99 % {late[len(late) * 99 // 100]} us, most {late[-1]} us")


def edmd_does_not_notice(machine, hostile_time):
    """Neither in a quiet time, nor in a hostile one, and it cycles on."""
    start = wakes(machine)
    quiet = {}

    def is_quiet():
        """What was told before may still be on its way to the log."""
        quiet.update(woken(machine, lambda: machine.client.hear(3)))
        return list(quiet.values()).count(0) >= 2

    rig.until(is_quiet)
    between = wakes(machine)
    hostile_woken = woken(machine, hostile_time)
    end = wakes(machine)
    asleep = {tid for tid, n in quiet.items() if n == 0}
    for tid in asleep:
        assert hostile_woken[tid] == 0, "a packet came as far as edmd"
    assert (end - between).total() > 0, "the cycle stood still"
    print(f"{HOSTILE} hostile packets\nwithout: {summary(between - start)}\n"
          f"with:    {summary(end - between)}")


def nothing_was_done(c):
    c.hear(0.5)
    s = c.status()
    assert (s.pos_mm[0], s.state, s.fault) == (0, "idle", "none")


def test_what_another_host_sends_is_not_even_read(idle, other_host):
    idle.start()
    c = idle.client
    packets = list(hostile(c, random.Random(1), HOSTILE))
    c.status_where(lambda s: s.state == "idle")
    edmd_does_not_notice(idle, lambda: send_there(other_host, packets))
    nothing_was_done(c)


def test_with_a_key_another_host_may_command_and_nobody_else(idle, other_host):
    idle.start()
    c = idle.client
    r = idle.ctl("keys", "add", "otto", "operator", cwd=idle.folder)
    assert r.returncode == 0, r.stderr
    assert idle.end("jobs") == 0
    ip("route", "replace", "224.0.0.0/4", "dev", "edm-here")
    try:
        text = idle.config.read_text()
        idle.config.write_text(
            text + "\n[lcm]\nurl = udpm://239.255.76.67:7667?ttl=1\n")
        c = idle.client = rig.Client(idle.name)
        idle.start_jobs()
        c.status_where(lambda s: s.daemon == "ok", 10)
        packets = list(hostile(c, random.Random(2), HOSTILE))
        c.status_where(lambda s: s.state == "idle")
        edmd_does_not_notice(idle, lambda: send_there(other_host, packets))
        nothing_was_done(c)
        log = (idle.folder / "edmd-jobs.log").read_text()
        assert THERE in log, "it was not told from where"
        key = idle.folder / "otto.key"
        there = [*other_host, str(BUILD / "edmctl"), "--machine", idle.name,
                 "--url", "udpm://239.255.76.67:7667?ttl=1", "--timeout", "15"]
        r = subprocess.run([*there, "--key", str(key), "jog", "X", "1"],
                           capture_output=True, text=True, timeout=60)
        assert r.returncode == 0, r.stderr
        c.status_where(lambda s: abs(s.pos_mm[0] - 1) < 1e-6)
    finally:
        # It hears this host by the other route alone.
        idle.end("jobs")
        ip("route", "replace", "224.0.0.0/4", "dev", "lo")
