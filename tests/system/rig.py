# SPDX-License-Identifier: Apache-2.0
"""A machine to test: edmd and edmd-jobs, and a client written by others.

The client is PyPI's lcm with the types that lcm-gen makes for Python, so that
what is tested is what is on the wire, not our own idea of it.
"""

import contextlib
import hashlib
import json
import os
import pathlib
import random
import re
import signal
import sqlite3
import struct
import subprocess
import sys
import time
import weakref

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import (
    Ed25519PrivateKey, Ed25519PublicKey,
)

BUILD = pathlib.Path(os.environ.get("EDM_BUILD", "build")).resolve()
sys.path.insert(0, str(BUILD / "python"))

import lcm  # noqa: E402
from edm import (  # noqa: E402
    ack_t, command_t, event_t, job_chunk_t, signed_t, status_t,
)

URL = os.environ.get("LCM_DEFAULT_URL", "udpm://239.255.76.67:7667?ttl=0")
GROUP = re.fullmatch(r"udpm://([0-9.]+):(\d+)\?ttl=0", URL).groups()
GROUP = GROUP[0], int(GROUP[1])
CHUNK = 32768

# No gap: the path is walked at the programmed feed, so times are known.
NULL_MACHINE = """
[machine]
name = {name}
backend = null
period_us = 1000
overrun_limit = 0
cpu = -1

[jobs]
store = {store}
"""

# 2 mm at 60 mm/min take 2 s.
SLOW_JOB = b"G21 G90\nG1 X2 F60\nM30\n"
QUICK_JOB = b"G21 G90\nG1 X0.2 F600\nG1 X0\nM30\n"


# A wait ends as soon as what it waits for is there.  The time at which it gives
# up is this much longer than on an idle machine, because tests also run beside
# others on a busy one.
PATIENCE = 6
NOT_DONE = "did not take it in time", "edmd is lost"


def until(what, timeout=5.0, step=0.01):
    """Wait for what() to be true; give what it returned."""
    end = time.monotonic() + timeout * PATIENCE
    while True:
        got = what()
        if got:
            return got
        assert time.monotonic() < end, f"not within {timeout} s"
        time.sleep(step)


def udp_rows(pid):
    """The rows of /proc/net/udp of a process: its sockets."""
    mine = set()
    for fd in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):    # closed meanwhile
            if m := re.match(r"socket:\[(\d+)\]", os.readlink(fd)):
                mine.add(m[1])
    rows = pathlib.Path("/proc/net/udp").read_text().splitlines()[1:]
    return [r.split() for r in rows if r.split()[9] in mine]


def udp_port(row):
    return int(row[1].split(":")[1], 16)


def preload(shim):
    """LD_PRELOAD of @shim, and of what stands there already."""
    return ":".join(filter(None, (str(shim), os.environ.get("LD_PRELOAD"))))


def key_file(path):
    """The words of a key file."""
    words = {}
    for line in pathlib.Path(path).read_text().splitlines():
        if line and not line.startswith("#"):
            word, value = line.split()
            words[word] = value
    return words


def signed_bytes(channel, boot, count, data):
    """What a signature is over, as messages/README.md says."""
    return (b"edmd 1\n" + channel.encode() + b"\n"
            + struct.pack(">qq", boot, count) + data)


class Client:
    """Speaks LCM; keeps what it hears.  Signs with a key file, and checks what
    is signed, by another library than edmd's."""

    def __init__(self, machine, key=None):
        self.machine = machine
        self.key = key or f"/dev/shm/edmd.{machine}.key"
        self.secret = None
        self.boot, self.base, self.count = 0, 0, 0
        self.ended = set()      # the boots of services that were ended
        self.forged = 0
        self.lcm = lcm.LCM(URL)
        self.name = f"test-{os.getpid()}-{random.getrandbits(32):08x}"
        self.seq = 0
        self.acks, self.statuses, self.events = [], [], []
        self.counts = []                # of the statuses
        # LCM keeps its handlers for ever: one that knows this client would keep
        # it and its sockets, and select() ends at 1024 descriptors.
        me = weakref.proxy(self)
        for channel, kind, where in (
            ("ACK", ack_t, self.acks),
            ("STATUS", status_t, self.statuses),
            ("EVENT", event_t, self.events),
        ):
            subscription = self.lcm.subscribe(
                f"EDM\\.{machine}\\.{channel}",
                lambda channel, data, kind=kind, where=where: me._take(
                    channel, data, kind, where
                ),
            )
            subscription.set_queue_capacity(1000)

    # -- Signing and checking

    def load_key(self):
        """When it is there: the service makes it at its first start."""
        if self.secret is None and os.path.exists(self.key):
            words = key_file(self.key)
            self.secret = Ed25519PrivateKey.from_private_bytes(
                bytes.fromhex(words["secret"]))
            self.public = bytes.fromhex(words["public"])
            self.machine_key = bytes.fromhex(words["machine-key"])
        return self.secret is not None

    def _take(self, channel, data, kind, where):
        if not self.load_key():
            return
        s = signed_t.decode(data)
        try:
            assert bytes(s.key) == self.machine_key
            Ed25519PublicKey.from_public_bytes(bytes(s.key)).verify(
                bytes(s.signature),
                signed_bytes(channel, s.boot, s.count, bytes(s.data)))
        except (AssertionError, InvalidSignature):
            self.forged += 1
            return
        if s.boot not in self.ended:
            if s.boot != self.boot:     # its clock begins anew
                self.boot, self.count, self.base = s.boot, 0, -sys.maxsize
            # What comes late seems to come from a slower clock.
            self.base = max(self.base,
                            s.count - time.monotonic_ns() // 1000)
        elif kind is status_t:
            return      # it may say that all is well, and waited here
        if kind is status_t:
            self.counts.append(s.count)
        where.append(kind.decode(bytes(s.data)))

    def seal(self, channel, data, boot=None, count=None):
        """@data signed for a channel of this machine."""
        if self.boot == 0:
            until(lambda: self.hear(0.02) or self.boot)
        self.count = max(self.count + 1,
                         time.monotonic_ns() // 1000 + self.base)
        s = signed_t()
        s.key = self.public
        s.boot = self.boot if boot is None else boot
        s.count = self.count if count is None else count
        name = f"EDM.{self.machine}.{channel}"
        s.signature = self.secret.sign(
            signed_bytes(name, s.boot, s.count, data))
        s.size, s.data = len(data), data
        return s

    def publish(self, channel, data, **more):
        """@data, signed, on a channel of this machine."""
        self.publish_raw(channel, self.seal(channel, data, **more).encode())

    def publish_raw(self, channel, data):
        self.lcm.publish(f"EDM.{self.machine}.{channel}", data)

    def hear(self, seconds=0.02):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.lcm.handle_timeout(max(1, int(left * 1000)))

    def number(self):
        self.seq += 1
        return self.seq

    def acks_to(self, seq):
        return [
            a for a in self.acks if a.client == self.name and a.seq == seq
            and bytes(a.key) == self.public
        ]

    def heard(self, what, timeout=5.0):
        """Listen until what() is true; give what it returned."""
        end = time.monotonic() + timeout * PATIENCE
        while True:
            got = what()
            if got:
                return got
            assert time.monotonic() < end, (
                f"not heard within {timeout} s; last status: "
                f"{vars_of(self.statuses[-1]) if self.statuses else None}, "
                f"last acks: {[vars_of(a) for a in self.acks[-3:]]}"
            )
            self.hear()

    def send_command(self, verb, job="", arg=0.0, seq=None, text="",
                     count=None):
        m = command_t()
        m.utime = int(time.time() * 1e6)
        m.client = self.name
        m.seq = self.number() if seq is None else seq
        m.verb, m.job, m.arg, m.text = verb, job, float(arg), text
        self.publish("COMMAND", m.encode(), count=count)
        return m.seq

    def send_guest(self):
        """A hello of a client that knows no boot number yet."""
        m = command_t()
        m.client, m.seq, m.verb = self.name, self.number(), "hello"
        self.publish("COMMAND", m.encode(), boot=0)

    def ask(self, verb, job="", arg=0.0, timeout=6.0, text=""):
        """Ask, and ask again with the same seq, until answered."""
        seq = self.send_command(verb, job, arg, text=text)
        again = time.monotonic() + 0.5

        def answered():
            nonlocal again
            if time.monotonic() > again:
                self.send_command(verb, job, arg, seq, text)
                again += 0.5
            # 100: signed for a service that is gone; status told the new one.
            return [a for a in self.acks_to(seq) if a.code != 100]

        return self.heard(answered, timeout)[0]

    def chunks(self, text, job, name="job.ngc", size=CHUNK, hold=False,
               from_line=0, from_mm=0, setting=""):
        pieces = [text[i:i + size] for i in range(0, len(text), size)] or [b""]
        made = []
        for i, piece in enumerate(pieces):
            m = job_chunk_t()
            m.utime = int(time.time() * 1e6)
            m.client, m.seq = self.name, self.number()
            m.job, m.name = job, name
            m.bytes = len(text)
            m.sha256 = hashlib.sha256(text).digest()
            m.chunk, m.chunks, m.offset = i, len(pieces), i * size
            m.hold = hold
            m.from_line, m.from_mm = from_line, from_mm
            m.setting = setting
            m.size, m.data = len(piece), piece
            made.append(m)
        return made

    def send(self, chunks):
        for m in chunks:
            self.publish("JOB", m.encode())

    def verdict(self, chunks):
        """The ack that says what became of the job, if it is there."""
        seqs = {m.seq for m in chunks}
        for a in self.acks:
            if a.client == self.name and a.seq in seqs:
                if a.code != 100 and (a.code or a.body):
                    return a
        return None

    def submit(self, text, job, timeout=5.0, **more):
        chunks = self.chunks(text, job, **more)
        self.send(chunks)
        late = 0

        def answered():
            nonlocal late
            # 100: it came too late, or for a service that is gone.
            again = sum(a.code == 100 for c in chunks
                        for a in self.acks_to(c.seq))
            if again > late:
                late = again
                self.send(chunks)
            return self.verdict(chunks)

        return self.heard(answered, timeout)

    def status(self, timeout=2.0):
        """One that is told from now on."""
        return self.status_where(lambda s: True, timeout)

    def status_where(self, what, timeout=5.0):
        """The first, from now on, for which what(status) is true."""
        # What waited in the socket meanwhile is older.
        boot, now = self.boot, time.monotonic_ns() // 1000
        told, counted = len(self.statuses), len(self.counts)
        return self.heard(
            lambda: next((s for s, count in zip(self.statuses[told:],
                                                self.counts[counted:])
                          if (self.boot != boot or count >= now + self.base)
                          and what(s)), None),
            timeout,
        )

    def job(self, job):
        a = self.ask("show", job)
        return json.loads(a.body) if a.code == 0 else None

    def job_where(self, job, state, timeout=10.0):
        end = time.monotonic() + timeout * PATIENCE
        while (j := self.job(job))["state"] != state:
            assert time.monotonic() < end, f"job is {j}, not {state}"
            self.hear(0.05)
        return j


def vars_of(m):
    return {k: getattr(m, k) for k in m.__slots__}


class Machine:
    """edmd and edmd-jobs of one machine, in a folder of its own."""

    count = 0

    def __init__(self, folder, config=NULL_MACHINE):
        Machine.count += 1
        self.name = f"test{os.getpid()}-{Machine.count}"
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(exist_ok=True)
        self.store = self.folder / "store"
        self.config = self.folder / "machine.ini"
        self.config.write_text(
            config.format(name=self.name, store=self.store)
        )
        self.edmd = self.jobs = None
        self.client = Client(self.name)

    def start_edmd(self):
        self.edmd = self._start("edmd", "--config", str(self.config))
        until(lambda: self.shm("status"))

    def come_back(self, what):
        """Kill edmd and start it: the first status after that which is @what.

        A status from before says that all is well, so the service must have
        said that edmd is lost."""
        self.kill("edmd")
        self.client.status_where(lambda s: s.daemon != "ok")
        self.start_edmd()
        return self.client.status_where(
            lambda s: s.daemon == "ok" and what(s), timeout=30
        )

    def start_jobs(self, *more):
        self.client.ended.add(self.client.boot)
        self.jobs = self._start(
            "edmd-jobs", "--config", str(self.config), *more
        )

    def start(self):
        self.start_edmd()
        self.start_jobs()
        self.client.status_where(lambda s: s.daemon == "ok")

    def _command(self, program):
        return [str(BUILD / program)]

    def env(self, program):
        """What @program has in its environment beside ours."""
        return {}

    def _start(self, program, *args):
        with open(self.folder / f"{program}.log", "ab") as log:
            return subprocess.Popen(
                [*self._command(program), *args], stdout=log, stderr=log,
                env=os.environ | self.env(program)
            )

    def kill(self, which):
        p = getattr(self, which)
        p.kill()
        p.wait()

    def end(self, which):
        p = getattr(self, which)
        if p is None or p.poll() is not None:
            return None
        p.send_signal(signal.SIGTERM)
        return p.wait(timeout=60)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
        if self.edmd or self.jobs:
            assert self.sweep() == [], "left in /dev/shm"

    def close(self):
        """End both in order: a job that is still there is ended first."""
        if self.jobs and self.jobs.poll() is None:
            if self.edmd and self.edmd.poll() is None:
                self._clear()
            self.end("jobs")
        self.end("edmd")
        for log in ("edmd", "edmd-jobs"):
            path = self.folder / f"{log}.log"
            if path.exists():
                print(f"-- {log}\n{path.read_text()}")

    def _clear(self):
        try:
            # The one that is loaded cannot be removed; none may follow it.
            for job in json.loads(self.client.ask("queue").body)[1:]:
                self.client.ask("remove", job["job"])
            for verb in ("hold", "reset", "stop"):
                self.client.ask(verb)
                self.client.hear(0.1)
            self.client.status_where(lambda s: not s.job)
        except AssertionError as e:
            print(f"not cleared: {e}")

    def shm(self, what=""):
        """What is in /dev/shm of this machine."""
        return sorted(
            p.name
            for p in pathlib.Path("/dev/shm").glob(f"edmd.{self.name}.{what}*")
        )

    def sweep(self):
        """Remove what is left in /dev/shm; tell what it was."""
        left = self.shm()
        for name in left:
            pathlib.Path("/dev/shm", name).unlink()
        return left

    def forget_store(self):
        """Begin with an empty folder: also with new keys, for a new client."""
        for path in self.store.iterdir():
            path.unlink()
        self.client = Client(self.name)
        return self.client

    def log(self, program):
        return (self.folder / f"{program}.log").read_text()

    def ctl(self, *args, timeout=120, program=BUILD / "edmctl", **more):
        """On a busy host services that run answer late, or a cycle comes late,
        and what edmd did not take in time was not done: it is asked again."""
        runs = [x is not None and x.poll() is None
                for x in (self.jobs, self.edmd)]
        patience = ["--timeout", str(3 * PATIENCE)] if runs[0] else []
        for _ in range(PATIENCE):
            p = subprocess.run(
                [str(program), "--machine", self.name, *patience, *args],
                capture_output=True, text=True, timeout=timeout, **more,
            )
            if not runs[1] or not any(w in p.stderr for w in NOT_DONE):
                break
            time.sleep(0.2)
        return p


@contextlib.contextmanager
def store_of(machine):
    """While nobody else has it."""
    machine.kill("jobs")
    with sqlite3.connect(machine.store / f"{machine.name}.db") as db:
        yield db
    machine.start_jobs()


def fill_queue(machine, like, count):
    """So many copies of job @like that waits, job-000 and so on."""
    with store_of(machine) as db:
        cols = [c[1] for c in db.execute("PRAGMA table_info(job)")
                if c[1] not in ("n", "id")]
        for i in range(count):
            db.execute(f"INSERT INTO job(id, {', '.join(cols)}) SELECT ?, "
                       f"{', '.join(cols)} FROM job WHERE id=?",
                       (f"job-{i:03}", like))
        db.execute("INSERT INTO text SELECT job.n, text.text FROM job JOIN "
                   "text ON text.n=(SELECT n FROM job WHERE id=?) WHERE "
                   "job.id LIKE 'job-%'", (like,))
