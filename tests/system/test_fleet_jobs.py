# SPDX-License-Identifier: Apache-2.0
"""Jobs that are given to machines over DDS: each once, whoever dies meanwhile.

The stranger is PyPI's cyclonedds; its types are written out here by hand from
messages/edm.idl.
"""

import dataclasses
import gc
import json
import os
import signal
import subprocess
import threading

import pytest
import rig
from rig import BUILD, QUICK_JOB, until

pytest.importorskip("cyclonedds", reason="pip install cyclonedds")

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import appendable  # noqa: E402
from cyclonedds.idl.types import (  # noqa: E402
    bounded_str, sequence, uint8,
)
from cyclonedds.pub import DataWriter, Publisher  # noqa: E402
from cyclonedds.sub import DataReader, Subscriber  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
import test_fleet  # noqa: E402

# --any means any machine, also that of a test beside this one.
DOMAIN = 1 + os.getpid() % 230


class FleetMachine(test_fleet.FleetMachine):
    def start_dds(self):
        self.dds = self._start("edm-dds", "--machine", self.name, "--domain",
                               str(DOMAIN))


def edm_fleet(*args, **more):
    return test_fleet.edm_fleet(*args, "--domain", str(DOMAIN), **more)


@dataclasses.dataclass
@appendable
class SignedPacket(IdlStruct, typename="edm.SignedPacket"):
    channel: bounded_str[63]
    packet: sequence[uint8, 65499]


@pytest.fixture
def hall(tmp_path):
    """Three machines with their services and their edm-dds."""
    with FleetMachine(tmp_path / "a") as a, FleetMachine(tmp_path / "b") as b, \
            FleetMachine(tmp_path / "c") as c:
        for m in (a, b, c):
            m.start()
            m.start_dds()
        yield [a, b, c]


@pytest.fixture
def cell(tmp_path):
    with FleetMachine(tmp_path / "machine") as m:
        m.start()
        m.start_dds()
        yield m


@pytest.fixture
def program(tmp_path):
    p = tmp_path / "part.ngc"
    p.write_bytes(QUICK_JOB)
    return str(p)


def jobs_of(m):
    """Ids of all jobs that the machine has or had."""
    lists = [[j["job"] for j in json.loads(m.client.ask(what).body)]
             for what in ("queue", "history")]
    for jobs in lists:
        assert len(jobs) == len(set(jobs)), jobs
    # One may have ended between the two questions.
    return list(dict.fromkeys(lists[0] + lists[1]))


def test_a_named_machine_holds_the_job_until_a_start(cell, program):
    p = edm_fleet("submit", program, "--machine", cell.name, "--json")
    assert p.returncode == 0, p.stderr
    got = json.loads(p.stdout)
    assert got["machine"] == cell.name
    assert jobs_of(cell) == [got["job"]["job"]]
    cell.client.status_where(lambda s: s.stand == "ready")
    assert cell.client.ask("start").code == 0
    cell.client.job_where(got["job"]["job"], "done")
    p = edm_fleet("submit", program, "--machine", cell.name, "--start",
                  "--id", "second")
    assert p.returncode == 0, p.stderr
    assert f"job second is at {cell.name}" in p.stdout
    cell.client.job_where("second", "done")


# -- Which one ---------------------------------------------------------------

def limited(m, lines):
    """Other limits in its machine file."""
    m.config.write_text(m.config.read_text() + lines)


def test_any_goes_to_the_machine_that_takes_it(tmp_path, program):
    """What fits, edmd-jobs says; who refused, and why, is told."""
    deep = tmp_path / "deep.ngc"
    deep.write_bytes(b"G21 G90\nG1 Z-140 F6000\nM30\n")
    with FleetMachine(tmp_path / "a") as a, FleetMachine(tmp_path / "b") as b:
        limited(a, "[axis.Z]\ntravel_min_mm = -100\n")
        limited(b, "[axis.Z]\ntravel_min_mm = -100\n")
        for m in (a, b):
            m.start()
            m.start_dds()
        p = edm_fleet("submit", str(deep), "--any", "--expect", "2")
        assert p.returncode == 65, p.stderr
        assert f"no machine fits {deep}" in p.stderr
        rows = [r for r in p.stderr.splitlines() if r.startswith("  ")]
        assert sorted(r.split(":")[0].strip() for r in rows) == sorted(
            [a.name, b.name])
        assert all("deep.ngc:2:" in r and "-100" in r for r in rows), rows
        assert jobs_of(a) == jobs_of(b) == []

        assert a.end("edmd") == 0 and a.end("jobs") == 0
        a.config.write_text(a.config.read_text().replace("-100", "-200"))
        a.start()
        p = edm_fleet("submit", str(deep), "--any", "--json", "--expect", "2")
        assert p.returncode == 0, p.stderr
        got = json.loads(p.stdout)
        assert got["machine"] == a.name
        assert jobs_of(a) == [got["job"]["job"]] and jobs_of(b) == []

        # It is at its start and not idle: the other one is next.
        p = edm_fleet("submit", program, "--any", "--json", "--expect", "2")
        assert p.returncode == 0, p.stderr
        assert json.loads(p.stdout)["machine"] == b.name

        # Now nobody is idle: it says whom it waits for, and gives nothing.
        with Dispatcher(program, "--any") as d:
            d.says("waits for an idle machine")
            assert "ready" in d.said and b.name in d.said
            assert a.client.ask("start").code == 0
            assert d.wait() == 0
        assert f"is at {a.name}" in d.out


def test_a_refusal_of_a_named_machine_names_line_and_file(cell, tmp_path):
    bad = tmp_path / "bad.ngc"
    bad.write_bytes(b"G21 G90\nG1 Q7\nM30\n")
    p = edm_fleet("submit", str(bad), "--machine", cell.name)
    assert p.returncode == 65
    assert f"{bad}:2:" in p.stderr and p.stdout == ""
    assert jobs_of(cell) == []


@pytest.mark.parametrize("args,code,said", [
    (["submit"], 64, "submit FILE"),
    (["submit", "x"], 64, "--machine NAME or --any"),
    (["submit", "x", "--any", "--machine", "y"], 64, "either"),
    (["submit", "x", "--any", "--id", "y"], 64, "only one machine"),
    (["submit", "x", "--machine", "y", "--id", 64 * "z"], 64, "1 to 63"),
    (["submit", "x", "--any", "--hold", "--start"], 64, "one of them"),
    (["submit", "x", "--machine", "a b"], 64, "1 to 31"),
    (["submit", "/nonexistent", "--any"], 66, "a file of NC code"),
    (["record", "x"], 64, "submit and scope take"),
])
def test_what_cannot_be_submitted_is_refused(args, code, said):
    p = edm_fleet(*args)
    assert p.returncode == code, p.stderr
    assert said in p.stderr and p.stdout == ""


def test_a_machine_that_is_not_there_is_said(cell, program):
    p = edm_fleet("submit", program, "--machine", "nowhere", "--wait", "0.3")
    assert p.returncode == 69
    assert f"nowhere is not heard; heard are: {cell.name}" in p.stderr


# -- Who may -----------------------------------------------------------------

def test_a_key_that_may_not_is_refused_by_the_machine(cell, program, tmp_path):
    keys = tmp_path / "keys"
    keys.mkdir()

    def add(role):
        key = keys / f"{cell.name}.key"
        key.unlink(missing_ok=True)
        subprocess.run([str(BUILD / "edmctl"), "--machine", cell.name, "keys",
                        "add", role, role], cwd=keys, check=True,
                       capture_output=True, timeout=120)
        (keys / f"{role}.key").rename(key)
        return key

    def submit():
        return edm_fleet("submit", program, "--machine", cell.name, "--keys",
                         str(keys))

    add("viewer")
    p = submit()
    assert p.returncode == 77 and "role operator" in p.stderr, p.stderr
    key = add("operator")
    p = submit()
    assert p.returncode == 0, p.stderr
    assert cell.client.ask("keys-remove", text="operator").code == 0
    p = submit()
    assert p.returncode == 77 and "key" in p.stderr, p.stderr
    key.write_text("nonsense\n")
    p = submit()
    assert p.returncode == 77 and str(key) in p.stderr, p.stderr
    assert len(jobs_of(cell)) == 1


class Stranger:
    """Offers, and hears what is offered and answered."""

    def __init__(self, m):
        self.participant = DomainParticipant(DOMAIN)
        part = Qos(Policy.Partition([m.name]))
        qos = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)),
                  Policy.Durability.Volatile, Policy.History.KeepLast(128))
        pub = Publisher(self.participant, qos=part)
        sub = Subscriber(self.participant, qos=part)
        offer, answer = (Topic(self.participant, name, SignedPacket)
                         for name in ("EDM_JobOffer", "EDM_JobAnswer"))
        self.qos = qos
        self.ends = [pub, sub, offer, answer]
        self.writer = DataWriter(pub, offer, qos=qos)
        self.offers = DataReader(sub, offer, qos=qos)
        self.answers = DataReader(sub, answer, qos=qos)
        self.heard, self.answered = [], []
        until(lambda: self.writer.get_matched_subscriptions())

    def listen(self):
        self.heard += self.offers.take(N=200)
        self.answered += self.answers.take(N=200)

    def offer(self, channel, packet):
        self.writer.write(SignedPacket(channel=channel,
                                       packet=list(packet)))

    def ack(self, m, client, code):
        """An ACK to a client of the test, with this code."""
        def got():
            self.listen()
            for a in self.answered:
                if a.channel == f"EDM.{m.name}.ACK":
                    client._take(a.channel, bytes(a.packet), rig.ack_t,
                                 client.acks)
            self.answered.clear()
            return [a for a in client.acks if a.client == client.name
                    and a.code == code]
        return until(got, 10)

    def close(self):
        self.writer = self.offers = self.answers = self.ends = None
        self.participant = None
        gc.collect()


def sealed(m, client, channel, message):
    return client.seal(channel, message.encode()).encode()


def test_a_stranger_gives_nothing_and_a_peer_with_a_key_does(cell, program):
    s, c = Stranger(cell), rig.Client(cell.name)
    job, command = f"EDM.{cell.name}.JOB", f"EDM.{cell.name}.COMMAND"
    c.status()      # its answers come by DDS

    def piece(name, client=c):
        return sealed(cell, client, "JOB",
                      client.chunks(QUICK_JOB, name, hold=True)[0])

    # Heard by a stranger while somebody gives a job, and said again.
    p = edm_fleet("submit", program, "--machine", cell.name)
    assert p.returncode == 0, p.stderr
    until(lambda: s.listen() or [h for h in s.heard if h.channel == job])
    had = jobs_of(cell)
    for h in list(s.heard):
        s.offer(h.channel, bytes(h.packet))

    # Not signed, of a wrong key, of another machine's channel, cut, too long.
    good = piece("cut")
    wrong = rig.Client(cell.name)
    wrong.load_key()
    wrong.boot, wrong.base = c.boot, c.base
    wrong.secret = rig.Ed25519PrivateKey.generate()
    wrong.public = wrong.secret.public_key().public_bytes_raw()
    s.offer(job, c.chunks(QUICK_JOB, "unsigned")[0].encode())
    s.offer(job, piece("wrong", wrong))
    s.offer("EDM.other.JOB", piece("other"))
    for n in (0, 1, 8, 123, 124, 200, len(good) - 1):
        s.offer(job, good[:n])
    s.offer(job, good + b"\0" * 1000)
    s.offer(job, os.urandom(60000))
    s.offer("", b"")

    # A command, by the host's own key, which may all: it is no offer.
    m = rig.command_t()
    m.client, m.seq, m.verb = c.name, c.number(), "start"
    s.offer(command, sealed(cell, c, "COMMAND", m))

    # Many who offer and say nothing of use leave room for one who does.
    crowd = [DataWriter(s.ends[0], s.ends[2], qos=s.qos) for _ in range(20)]
    for w in crowd:
        until(w.get_matched_subscriptions)
        w.write(SignedPacket(channel=job, packet=[0] * 200))
    p = edm_fleet("submit", program, "--machine", cell.name, "--id", "crowd")
    assert p.returncode == 0, p.stderr
    had.append("crowd")

    # What is right comes through, behind all that, and is answered.
    s.offer(job, piece("right"))
    s.ack(cell, c, 0)
    until(lambda: "right" in jobs_of(cell))
    assert sorted(jobs_of(cell)) == sorted([*had, "right"])
    assert not c.acks_to(m.seq)
    assert cell.client.status().stand == "ready", "nothing was started"
    assert cell.dds.poll() is None
    s.close()


# -- Who dies meanwhile ------------------------------------------------------

class Dispatcher:
    """edm-fleet submit, whose lines are heard while it runs."""

    def __init__(self, path, *args):
        self.p = subprocess.Popen(
            [str(BUILD / "edm-fleet"), "submit", str(path), "--domain",
             str(DOMAIN), *args],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.said, self.out = "", ""
        self.thread = threading.Thread(target=self._read)
        self.thread.start()

    def _read(self):
        for line in self.p.stderr:
            self.said += line

    def says(self, what):
        until(lambda: what in self.said or self.p.poll() is not None, 30)
        assert what in self.said, self.said
        return self.said

    def wait(self):
        code = self.p.wait(300)
        self.thread.join()
        self.out = self.p.stdout.read()
        return code

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.p.poll() is None:
            self.p.kill()
            self.p.wait()
        self.thread.join()
        self.p.stdout.close()
        self.p.stderr.close()


@pytest.fixture
def long_program(tmp_path):
    """Some 200 pieces."""
    p = tmp_path / "long.ngc"
    p.write_text("G21 G90 F6000\n" + "G1 X0.2\nG1 X0.0\n" * 400_000 + "M30\n")
    return p


@pytest.mark.parametrize("who", ["dds", "jobs"])
def test_a_service_that_is_killed_under_an_offer_has_it_once(
        cell, long_program, who):
    with Dispatcher(long_program, "--any", "--json") as d:
        d.says(f"sends to {cell.name}")
        cell.kill(who)
        getattr(cell, f"start_{who}")()
        assert d.wait() == 0, d.said
    assert jobs_of(cell) == [json.loads(d.out)["job"]["job"]]
    assert cell.client.job(jobs_of(cell)[0])["lines"] == 800_002


def test_a_machine_that_vanishes_gives_the_offer_back(
        hall, long_program):
    """It has not got the whole job, so another machine gets it.  If it had got
    it before it was stopped, nobody else does, and it is there once."""
    with Dispatcher(long_program, "--any", "--json") as d:
        d.says("sends to ")
        name = d.said.split("sends to ")[1].split()[0]
        a = next(m for m in hall if m.name == name)
        a.jobs.send_signal(signal.SIGSTOP)
        a.kill("dds")
        until(lambda: d.p.poll() is not None or "may have" in d.said, 60)
        a.jobs.send_signal(signal.SIGCONT)
        a.start_dds()
        assert d.wait() == 0, d.said
    got = json.loads(d.out)
    assert (got["machine"] == a.name) == ("may have" in d.said), d.said
    at = {m.name: jobs_of(m) for m in hall}
    assert sorted(at.values()) == [[], [], [got["job"]["job"]]], at
    assert at[got["machine"]] == [got["job"]["job"]]


def test_a_dispatcher_that_is_killed_leaves_the_job_once_or_nowhere(
        cell, long_program):
    with Dispatcher(long_program, "--machine", cell.name, "--id", "x") as d:
        d.says(f"sends to {cell.name}")
    p = edm_fleet("submit", str(long_program), "--machine", cell.name, "--id",
                  "x", timeout=300)
    assert p.returncode == 0, p.stderr
    assert jobs_of(cell) == ["x"]
    p = edm_fleet("submit", str(long_program), "--machine", cell.name, "--id",
                  "x", timeout=300)
    assert p.returncode == 0 and "is here already" in p.stdout, p.stderr
    assert jobs_of(cell) == ["x"]


def test_a_silent_machine_keeps_what_it_may_have(hall, program):
    """One piece is the whole job: who got it and is silent may have it."""
    for m in hall[1:]:
        m.kill("dds")
    a = hall[0]
    # Its signed clock is known; then it hears, and does not answer.
    with Dispatcher(program, "--any", "--json") as d:
        d.says("offers job")
        a.jobs.send_signal(signal.SIGSTOP)
        a.kill("dds")
        until(lambda: d.p.poll() is not None
              or "may have" in d.said or "waits for" in d.said, 60)
        for m in hall[1:]:
            m.start_dds()
        a.jobs.send_signal(signal.SIGCONT)
        a.start_dds()
        assert d.wait() == 0, d.said
    got = json.loads(d.out)
    at = {m.name: jobs_of(m) for m in hall}
    assert sorted(at.values()) == [[], [], [got["job"]["job"]]], (at, d.said)
    if "may have" in d.said:
        assert got["machine"] == a.name


def dispatch(program, n, out):
    for _ in range(n):
        with Dispatcher(program, "--any", "--start", "--json") as d:
            out.append((d.wait(), d.out, d.said))


# One packet in ten is not sent.
LOSSY = os.environ.get(
    "CYCLONEDDS_URI", "<CycloneDDS><Domain></Domain></CycloneDDS>").replace(
    "</Domain>", "<Internal><Test><XmitLossiness>100</XmitLossiness></Test>"
    "</Internal></Domain>")


def test_two_dispatchers_give_each_job_once(hall, program, monkeypatch):
    """Also where one packet in ten is lost, both ways."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOSSY)
    for m in hall:
        m.kill("dds")
        m.start_dds()
    n = int(os.environ.get("EDM_DISPATCHED", "10"))
    out = [], []
    threads = [threading.Thread(target=dispatch, args=(program, n, out[i]))
               for i in (0, 1)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    runs = out[0] + out[1]
    assert [r[0] for r in runs] == [0] * (2 * n), runs
    given = [(json.loads(r[1])["machine"], json.loads(r[1])["job"]["job"])
             for r in runs]
    had = [(m.name, job) for m in hall for job in jobs_of(m)]
    assert sorted(had) == sorted(given)
    assert len({job for _, job in given}) == 2 * n
    for m in hall:
        for job in jobs_of(m):
            m.client.job_where(job, "done", 60)
