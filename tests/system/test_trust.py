# SPDX-License-Identifier: Apache-2.0
"""Who may command: keys, roles, replays, strangers.

The client is written from messages/README.md with another library than
edmd's (rig.py).  docs/threat-model.md names these tests.
"""

import json
import os
import pathlib
import random
import shutil
import signal
import socket
import sqlite3
import stat
import struct
import subprocess
import sys
import tempfile
import time

import lcm
import pytest
import rig
from rig import BUILD, QUICK_JOB, Client, command_t, signed_t, until


def command(c, verb, seq=None, **more):
    m = command_t()
    m.utime, m.client, m.job, m.arg, m.text = 0, c.name, "", 0.0, ""
    m.seq = c.number() if seq is None else seq
    m.verb = verb
    for key, value in more.items():
        setattr(m, key, value)
    return m


def jog(c, mm=1.0, **more):
    return command(c, "jog", text="X", arg=mm, **more)


def stays(c, seconds=0.6):
    """Nothing moved, and nothing is answered to what was sent."""
    c.hear(seconds)
    s = c.status()
    assert (s.pos_mm[0], s.state) == (0, "idle")


def add_key(machine, name, role):
    r = machine.ctl("keys", "add", name, role, cwd=machine.folder)
    assert r.returncode == 0, r.stderr
    return machine.folder / f"{name}.key"


def test_an_unsigned_command_is_not_taken(machine):
    c = machine.client
    c.status()
    c.publish_raw("COMMAND", jog(c).encode())
    s = c.seal("COMMAND", jog(c).encode())
    s.signature = bytes(64)
    c.publish_raw("COMMAND", s.encode())
    stays(c)
    assert c.acks == []


def test_a_packet_sent_again_moves_nothing(machine):
    c = machine.client
    c.status()
    packets = []
    for verb in ("estop", "reset"):
        packets.append(c.seal("COMMAND", command(c, verb).encode()).encode())
        c.publish_raw("COMMAND", packets[-1])
        c.heard(lambda: len(c.acks) == len(packets))
    c.status_where(lambda s: s.state == "idle")
    for _ in range(3):
        c.publish_raw("COMMAND", packets[0])
        c.hear(0.2)
        assert c.status().state == "idle"
    assert len(c.acks) == 2


def test_a_packet_for_another_machine_or_channel_or_start_is_none(machine):
    c = machine.client
    c.status()
    good = c.machine
    c.machine = "other"
    s = c.seal("COMMAND", jog(c).encode())
    c.machine = good
    c.publish_raw("COMMAND", s.encode())
    c.publish_raw("COMMAND", c.seal("JOB", jog(c).encode()).encode())
    stays(c)
    assert c.acks == []
    for more in ({"boot": c.boot + 1}, {"boot": 0}, {"count": 10**15},
                 {"count": -10**15}, {"count": -2**63}):
        m = jog(c)
        c.publish("COMMAND", m.encode(), **more)
        assert c.heard(lambda: c.acks_to(m.seq))[0].code == 100
    stays(c, 0.2)


def test_an_unknown_key_is_told_so_and_does_nothing(machine):
    c = machine.client
    c.status()
    stranger = Client(machine.name, machine.folder / "no.key")
    words = rig.key_file(c.key)
    stranger.secret = rig.Ed25519PrivateKey.generate()
    stranger.public = stranger.secret.public_key().public_bytes_raw()
    stranger.machine_key = bytes.fromhex(words["machine-key"])
    a = stranger.ask("estop")
    assert a.code == 77
    assert "edmctl keys add" in a.reason
    log = (machine.folder / "edmd-jobs.log").read_text()
    assert stranger.public.hex()[:8] in log
    stays(c, 0.2)


def test_each_role_may_what_its_table_says(machine):
    viewer = Client(machine.name, add_key(machine, "eve", "viewer"))
    operator = Client(machine.name, add_key(machine, "otto", "operator"))
    for verb in ("queue", "history", "alarms", "hello", "electrodes"):
        assert viewer.ask(verb).code == 0
    for verb in ("start", "hold", "resume", "stop", "retract", "set", "estop",
                 "reset", "step", "jog", "home", "override", "remove", "keys",
                 "keys-add", "keys-remove", "electrode-add", "electrode-set",
                 "electrode-remove", "electrode-use", "electrode-measure"):
        a = viewer.ask(verb)
        assert a.code == 77, verb
        assert "viewer" in a.reason
    assert viewer.submit(QUICK_JOB, "no").code == 77
    for verb in ("keys", "keys-add", "keys-remove"):
        assert operator.ask(verb).code == 77, verb
    assert operator.submit(QUICK_JOB, "yes").code == 0
    operator.job_where("yes", "done")
    assert json.loads(operator.ask("hello").body)["role"] == "operator"


def test_a_removed_key_is_out_and_the_others_stay_through_a_restart(machine):
    guest = Client(machine.name, add_key(machine, "guest", "operator"))
    kept = Client(machine.name, add_key(machine, "kept", "operator"))
    assert guest.ask("queue").code == 0
    assert machine.ctl("keys", "remove", "guest").returncode == 0
    assert guest.ask("queue").code == 77
    machine.kill("jobs")
    machine.start_jobs()
    machine.client.status_where(lambda s: s.daemon == "ok")
    kept.status()
    assert kept.ask("queue").code == 0
    guest.status()
    assert guest.ask("queue").code == 77
    r = machine.ctl("keys", "list")
    assert "kept" in r.stdout and "guest" not in r.stdout
    assert machine.ctl("keys", "remove", "host").returncode == 1


def test_a_viewer_cannot_take_an_operator_s_answer(machine):
    """The same client name and seq, by another key."""
    eve = Client(machine.name, add_key(machine, "eve", "viewer"))
    c = machine.client
    c.status(), eve.status()
    eve.name = c.name
    eve.publish("COMMAND", command(eve, "estop", seq=1).encode())
    eve.heard(lambda: [a for a in eve.acks if a.code == 77])
    assert [a for a in c.acks
            if a.client == c.name and bytes(a.key) == c.public] == []
    assert c.ask("estop").code == 0
    c.status_where(lambda s: s.state == "fault")


def test_status_event_and_ack_of_another_key_are_not_believed(machine):
    """edmctl hears a forger say that the machine is in fault."""
    c = machine.client
    s = c.status()
    forger = rig.Ed25519PrivateKey.generate()
    s.state, s.fault, s.daemon = "fault", "\x1b[2Jfire", "ok"
    for i in range(40):
        m = signed_t()
        m.key = forger.public_key().public_bytes_raw()
        m.boot, m.count = c.boot, c.count + 10**6 + i
        data = s.encode()
        m.signature = forger.sign(rig.signed_bytes(
            f"EDM.{machine.name}.STATUS", m.boot, m.count, data))
        m.size, m.data = len(data), data
        c.publish_raw("STATUS", m.encode())
        if i == 20:
            r = machine.ctl("status")
            assert r.returncode == 0
            assert "fault      none" in r.stdout
            assert "\x1b" not in r.stdout


@pytest.mark.parametrize("what", ["lost", "wide", "foreign", "unreadable",
                                  "cut", "unknown"])
def test_a_bad_key_file_is_told_with_what_mends_it(machine, what, request):
    path = machine.folder / "some.key"
    path.write_text(pathlib.Path(machine.client.key).read_text())
    path.chmod(0o600)
    wanted = {
        "lost": "edmctl keys add", "wide": "make a new one",
        "foreign": "--machine other", "unreadable": "usermod -aG edm",
        "cut": "cut short", "unknown": "edmctl keys add",
    }[what]
    ctl, more = BUILD / "edmctl", {}
    if what == "lost":
        path.unlink()
    elif what == "wide":
        path.chmod(0o644)
    elif what == "foreign":
        path.write_text(path.read_text().replace(machine.name, "other"))
    elif what == "cut":
        path.write_text(path.read_text()[:100].rsplit("\n", 1)[0] + "\n")
    elif what == "unknown":
        fresh = add_key(machine, "fresh", "operator")
        assert machine.ctl("keys", "remove", "fresh").returncode == 0
        path = fresh
    elif what == "unreadable":
        if os.geteuid() != 0:
            path.chmod(0)
        else:
            # Its own tree and folder may be closed to others.
            place = pathlib.Path(tempfile.mkdtemp())
            request.addfinalizer(lambda: shutil.rmtree(place))
            place.chmod(0o755)
            ctl = shutil.copy(BUILD / "edmctl", place)
            path = pathlib.Path(shutil.copy(path, place))
            more = {"user": 65534, "group": 65534, "extra_groups": []}
    r = machine.ctl("--key", str(path), "hold", program=ctl, **more)
    assert r.returncode == 77, r.stderr
    assert wanted in r.stderr
    assert machine.client.status().state == "idle"


@pytest.mark.parametrize("which,what", [
    ("key", "wide"), ("key", "foreign"), ("key", "cut"),
    ("machine-key", "wide"), ("machine-key", "group"),
    ("machine-key", "foreign"), ("machine-key", "cut")])
def test_the_service_does_not_start_with_a_bad_key_file(idle, which, what):
    idle.start_jobs()
    path = idle.store / f"{idle.name}.{which}"
    until(path.exists)
    until(lambda: pathlib.Path(idle.client.key).exists())
    assert idle.end("jobs") == 0
    if what == "wide":
        path.chmod(0o644)
    elif what == "group":
        path.chmod(0o640)
    elif what == "foreign":
        path.write_text(path.read_text().replace(idle.name, "other"))
    else:
        path.write_text("")
    idle.start_jobs()
    assert idle.jobs.wait(timeout=10) == 78
    log = (idle.folder / "edmd-jobs.log").read_text()
    assert "a new one is made" in log
    path.unlink()
    idle.start_jobs()
    until(path.exists)
    idle.client.secret = None
    idle.client.status(10)
    mode = stat.S_IMODE(path.stat().st_mode)
    assert mode == (0o640 if which == "key" else 0o600)


def test_who_may_read_the_key_may_lock_nothing(machine):
    """A lock takes no more than leave to read: the group reads the key alone.

    So it is when the store of an earlier version was open to the group.
    """
    def open_to_the_group():
        return sorted(p.name for p in machine.store.iterdir()
                      if p.stat().st_mode & 0o077)

    wanted = [f"{machine.name}.key"]
    assert open_to_the_group() == wanted
    machine.kill("jobs")
    for path in machine.store.iterdir():
        if path.suffix != ".machine-key":
            path.chmod(0o640)
    machine.start_jobs()
    machine.client.status_where(lambda s: s.daemon == "ok")
    assert open_to_the_group() == wanted
    for what in ("owner", "writer"):
        path = pathlib.Path(f"/dev/shm/edmd.{machine.name}.{what}")
        assert path.stat().st_mode & 0o077 == 0


def test_a_lost_machine_key_makes_old_key_files_say_so(machine):
    old = add_key(machine, "old", "operator")
    assert machine.end("jobs") == 0
    (machine.store / f"{machine.name}.machine-key").unlink()
    machine.start_jobs()
    machine.client.secret = None
    machine.client.status_where(lambda s: s.daemon == "ok")
    r = machine.ctl("--key", str(old), "queue")
    assert r.returncode == 77
    assert "get a new key file" in r.stderr
    assert machine.ctl("queue").returncode == 0


def datagram(channel, data):
    return struct.pack(">II", 0x4c433032, 1) + channel.encode() + b"\0" + data


def test_a_unicast_packet_is_not_even_read(machine):
    """As another host would send it: to the port, not to the group."""
    c = machine.client
    c.status()
    packet = datagram(f"EDM.{machine.name}.COMMAND",
                      c.seal("COMMAND", command(c, "estop").encode()).encode())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        for _ in range(20):
            s.sendto(packet, ("127.0.0.1", rig.GROUP[1]))
    stays(c)
    # The same packet, to the group, is a good one.
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        s.sendto(packet, rig.GROUP)
    c.status_where(lambda s: s.fault == "e-stop")


def test_names_that_move_a_terminal_are_refused(machine):
    c = machine.client
    for name in ("a\x1b[2Jb", "a\u009b2Jb", "a\u202eb", "a\u2066b", "a\u200fb",
                 "a\x7fb", "a\u0085b", "\ufeffa"):
        a = c.submit(QUICK_JOB, "bad", name=name)
        assert a.code == 65, repr(name)
    a = c.submit(b"G21 G90\n(\x1b]0;x\x07)G1 X1 F60 \xc2\x9b2J\n", "esc",
                 name="Gr\u00f6\u00dfe.ngc")
    assert a.code == 65
    path = machine.folder / "esc.ngc"
    path.write_bytes(b"G21\nG1 X5 \xe2\x80\xaeQ7\x1b[2J\n")
    r = subprocess.run(
        [str(BUILD / "edmctl"), "--machine", machine.name, "submit", path],
        capture_output=True, timeout=20)
    assert r.returncode == 65
    for bad in (b"\x1b", b"\xe2\x80\xae"):
        assert bad not in r.stderr
        assert bad not in (machine.folder / "edmd-jobs.log").read_bytes()


def test_names_of_an_old_store_are_cleaned_where_they_are_shown(idle):
    """Written before they were refused, or by another hand."""
    idle.start()
    c = idle.client
    assert c.submit(QUICK_JOB, "late").code == 0
    c.job_where("late", "done")
    assert c.ask("estop").code == 0
    assert c.submit(QUICK_JOB, "old", hold=True).code == 0
    assert idle.end("jobs") == 0
    bad = "\x1b]0;x\x07\u009b2J\u202eevil\u2066\x7f"
    with sqlite3.connect(idle.store / f"{idle.name}.db") as db:
        db.execute("UPDATE job SET name=?, reason=?", (bad, bad))
        db.execute("UPDATE job SET name=CAST(x'fffe41c3' AS TEXT) "
                   "WHERE id='late'")
        db.execute("UPDATE event SET job=?, outcome=?, text=?", (bad,) * 3)
    idle.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    for words in (["queue"], ["show", "old"], ["show", "late"], ["history"],
                  ["alarms"]):
        a = c.ask(words[0], *words[1:])
        assert "evil" in a.body or "late" in a.body
        told = [json.dumps(json.loads(a.body), ensure_ascii=False)]
        for more in ([], ["--json"]):
            r = idle.ctl(*more, *words)
            # 1: an alarm is there.
            assert r.returncode in (0, 1), r.stderr
            told.append(r.stdout)
        for text in told:
            for ch in ("\\u001b", *"\x1b\x07\u009b\u202e\u2066\x7f\ufffd"):
                assert ch not in text, (words, ch)
    for arg in (float("nan"), 1e300, -1e300):
        assert c.ask("history", arg=arg).code == 65
        assert c.ask("queue", arg=arg).code == 0


def strange_packets(c, draw, n):
    """Of no shape, of a wrong one, in LCM's pieces; nobody has signed them."""
    names = [f"EDM.{c.machine}.{what}".encode() + b"\0"
             for what in ("ACK", "STATUS", "EVENT", "COMMAND", "JOB")]
    sizes = (0, 10, 70000, 16 << 20, 2**31, 2**32 - 1)
    for _ in range(n):
        kind = draw.randrange(4)
        if kind == 0:
            yield draw.randbytes(draw.randrange(60))
        elif kind == 1:
            yield (b"LC02" + bytes(4) + draw.choice(names)
                   + draw.randbytes(draw.randrange(300)))
        elif kind == 2:
            yield b"LC02" + bytes(4) + b"A" * draw.randrange(1, 5000)
        else:
            yield (struct.pack(
                ">4sIIIHH", b"LC03", draw.randrange(8), draw.choice(sizes),
                draw.choice(sizes), draw.choice((0, 1, 5, 65535)),
                draw.choice((0, 1, 2, 65535))) + draw.choice(names)
                + draw.randbytes(draw.randrange(2000)))


def test_strange_packets_end_neither_clients_nor_the_service(machine):
    """Anybody on the host may send them."""
    c = machine.client
    c.status()
    root = pathlib.Path(__file__).parents[2]
    watchers = [
        subprocess.Popen([str(BUILD / "edmctl"), "--machine", machine.name,
                          "watch"], stdout=subprocess.DEVNULL),
        subprocess.Popen(
            [sys.executable, "-c", "import sys, edm\n"
             "m = edm.Client(sys.argv[1], timeout=60)\n"
             "while True: m.status()", machine.name],
            env={**os.environ, "PYTHONPATH": str(root / "clients/python")})]
    # In a test's own process LCM's library would end too.
    c.lcm = None
    try:
        time.sleep(1)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            for i, p in enumerate(strange_packets(c, random.Random(5), 20000)):
                s.sendto(p, rig.GROUP)
                if i % 100 == 0:
                    time.sleep(0.005)
        assert machine.ctl("queue").returncode == 0
        assert machine.ctl("jog", "X", "0.1").returncode == 0
        assert [w.poll() for w in watchers] == [None, None]
    finally:
        for w in watchers:
            w.kill()
            w.wait()
        machine.client = Client(machine.name)


def test_a_short_text_of_nested_calls_is_refused_soon_and_small(machine):
    text = ["G21 G90 F600", "M98 P1000 L999", "M30"]
    for depth in range(1, 8):
        text += [f"O{depth}000", f"M98 P{depth + 1}000 L999", "M99"]
    text += ["O8000", "G91 G1 X0.001", "G1 X-0.001", "G90", "M99"]
    c = machine.client
    a = c.submit("\n".join(text).encode() + b"\n", "bomb", timeout=120)
    assert a.code == 65
    assert "8000000 segments" in a.reason
    status = pathlib.Path(f"/proc/{machine.jobs.pid}/status").read_text()
    peak_kb = int(status.split("VmHWM:")[1].split()[0])
    assert peak_kb < 1500000
