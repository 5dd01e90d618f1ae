# SPDX-License-Identifier: Apache-2.0
"""The jobs and alarms of a fleet, over DDS and in a file: each once, whatever
was killed meanwhile.

The peer is PyPI's cyclonedds; its types are written out here by hand from
messages/edm.idl.
"""

import contextlib
import dataclasses
import errno
import gc
import json
import os
import sqlite3
import subprocess
import time

import pytest
import rig
from rig import BUILD, QUICK_JOB, SLOW_JOB, until

pytest.importorskip("cyclonedds", reason="pip install cyclonedds")

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import appendable, key  # noqa: E402
from cyclonedds.idl.types import (  # noqa: E402
    bounded_str, float64, int64, uint32,
)
from cyclonedds.pub import DataWriter, Publisher  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
import test_fleet  # noqa: E402
from test_fleet import FleetMachine, edm_fleet  # noqa: E402


@dataclasses.dataclass
@appendable
class JobReport(IdlStruct, typename="edm.JobReport"):
    machine: bounded_str[31]
    key("machine")
    number: uint32
    key("number")
    job: bounded_str[63]
    name: bounded_str[63]
    state: bounded_str[15]
    reason: bounded_str[255]
    submitted_utime: int64
    first_utime: int64
    ended_utime: int64
    job_s: float64
    erode_s: float64
    path_mm: float64
    length_mm: float64
    depth_mm: float64
    energy_j: float64
    jumps: uint32
    retracts: uint32
    shorts: uint32
    arcs: uint32
    lines: uint32
    sha256: bounded_str[64]


@dataclasses.dataclass
@appendable
class Alarm(IdlStruct, typename="edm.Alarm"):
    machine: bounded_str[31]
    key("machine")
    number: uint32
    key("number")
    utime: int64
    kind: bounded_str[15]
    fault: bounded_str[31]
    job: bounded_str[63]
    place_mm: float64
    text: bounded_str[255]


class Reader:
    """Keeps every report and alarm of a machine."""

    def __init__(self, machine):
        self.machine = machine
        self.participant = DomainParticipant(0)
        qos = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)),
                  Policy.Durability.TransientLocal, Policy.History.KeepAll)
        self.readers = [
            DataReader(test_fleet.of_all(self.participant),
                       Topic(self.participant, name, kind), qos=qos)
            for name, kind in (("EDM_JobReport", JobReport),
                               ("EDM_Alarm", Alarm))]
        self.got = []

    def all(self, kind):
        for r in self.readers:
            self.got += r.take(N=1000)
        return [s for s in self.got
                if isinstance(s, kind) and s.machine == self.machine.name]

    def jobs(self):
        return [s.job for s in self.all(JobReport)]

    def close(self):
        self.readers = self.participant = None
        gc.collect()


@pytest.fixture
def cell(tmp_path):
    """A machine with its services and its edm-dds."""
    with FleetMachine(tmp_path / "machine") as m:
        m.start()
        m.start_dds()
        yield m


def cut(m, *jobs):
    for job in jobs:
        assert m.client.submit(QUICK_JOB, job).code == 0
        m.client.job_where(job, "done")


def alarm(m):
    assert m.client.ask("estop").code == 0
    m.client.status_where(lambda s: s.fault == "e-stop")
    assert m.client.ask("reset").code == 0
    m.client.status_where(lambda s: s.fault == "none")


def test_a_peer_hears_each_job_and_each_alarm_once(cell):
    early = Reader(cell)
    cut(cell, "one")
    until(lambda: early.jobs() == ["one"], 20)
    r = early.all(JobReport)[0]
    assert (r.state, r.reason, r.lines) == ("done", "", 4)
    assert abs(r.path_mm - 0.4) < 1e-6 and r.path_mm == r.length_mm
    assert 0 < r.job_s and r.erode_s == 0
    assert r.submitted_utime <= r.first_utime < r.ended_utime
    assert r.sha256 == cell.client.job("one")["sha256"]

    alarm(cell)
    cut(cell, "two")
    until(lambda: early.jobs() == ["one", "two"], 20)
    stop = until(lambda: [a for a in early.all(Alarm) if a.kind == "alarm"],
                 20)
    assert [a.fault for a in stop] == ["e-stop"]

    late = Reader(cell)
    until(lambda: sorted(late.jobs()) == ["one", "two"], 20)
    assert until(lambda: [a for a in late.all(Alarm) if a.kind == "alarm"],
                 20) == stop
    early.close()
    late.close()


def test_a_late_edm_dds_tells_the_whole_day(cell):
    """More than a page of the history."""
    cell.kill("dds")
    jobs = [f"job-{i}" for i in range(60)]
    for job in jobs:
        assert cell.client.submit(QUICK_JOB, job).code == 0
    cell.client.job_where(jobs[-1], "done", 60)
    cell.start_dds()
    late = Reader(cell)
    until(lambda: sorted(late.jobs()) == sorted(jobs), 20)
    late.close()


class Sink:
    """edm-fleet record."""

    def __init__(self, folder, env=None):
        self.disk, self.log = folder / "disk", folder / "sink.log"
        self.disk.mkdir()
        self.file = self.disk / "fleet.db"
        self.env = env or {}
        self.start()

    def start(self):
        with open(self.log, "ab") as log:
            self.p = subprocess.Popen(
                [str(BUILD / "edm-fleet"), "record", "--database",
                 str(self.file)], stderr=log, env=os.environ | self.env)

    def kill(self):
        self.p.kill()
        self.p.wait()

    def end(self):
        self.p.terminate()
        return self.p.wait(60)

    def rows(self, what, m):
        if not self.file.exists():
            return []
        db = sqlite3.connect(self.file)
        try:
            return [r[0] for r in db.execute(
                f"SELECT {what} WHERE machine=? ORDER BY 1", (m.name,))]
        except sqlite3.OperationalError:    # it is being made
            return []
        finally:
            db.close()

    def has(self, m, *jobs):
        until(lambda: self.rows("job FROM report", m) == sorted(jobs), 30)


def told(sink, m, command, *more):
    p = edm_fleet(command, "--database", str(sink.file), "--json", *more)
    assert p.returncode == 0, p.stderr
    name = {"report": "report", "alarms": "alarms"}[command]
    return [r for r in json.loads(p.stdout)[name] if r["machine"] == m.name]


def test_nothing_is_lost_or_doubled_whoever_is_killed(cell, tmp_path):
    sink = Sink(tmp_path)
    cut(cell, "a")
    sink.has(cell, "a")
    sink.kill()
    cut(cell, "b")
    sink.start()
    sink.has(cell, "a", "b")
    cell.kill("dds")
    cut(cell, "c")
    alarm(cell)
    cell.start_dds()
    sink.has(cell, "a", "b", "c")
    cell.kill("jobs")
    cell.start_jobs()
    cell.client.status_where(lambda s: s.daemon == "ok")
    cut(cell, "d")
    sink.has(cell, "a", "b", "c", "d")
    cell.come_back(lambda s: True)
    assert cell.client.ask("hello").code == 0
    for which in ("dds", "jobs"):
        cell.kill(which)
    sink.kill()
    cell.start_jobs()
    cell.client.status_where(lambda s: s.daemon == "ok")
    cell.start_dds()
    sink.start()
    until(lambda: sink.rows("kind FROM alarm", cell).count("alarm") == 1, 30)
    cut(cell, "e")
    sink.has(cell, "a", "b", "c", "d", "e")
    assert sink.end() == 0
    assert [(r["jobs"], r["done"]) for r in told(sink, cell, "report",
                                                 "--week")] == [(5, 5)]
    alarms = told(sink, cell, "alarms", "--today")
    assert [a["fault"] for a in alarms].count("e-stop") == 1
    times = [a["utime"] for a in alarms]
    assert times == sorted(times, reverse=True)


def test_a_job_that_goes_on_after_a_fault_ends_again(cell, tmp_path):
    sink, c = Sink(tmp_path), cell.client
    early = Reader(cell)
    assert c.submit(SLOW_JOB, "slow").code == 0
    c.status_where(lambda s: s.state == "travel" and s.place_mm > 0.2)
    assert c.ask("estop").code == 0
    until(lambda: sink.rows("state FROM report", cell) == ["fault"], 30)
    assert c.ask("reset").code == 0
    assert c.ask("start").code == 0
    c.job_where("slow", "done")
    until(lambda: sink.rows("state FROM report", cell) == ["done"], 30)
    until(lambda: [r.state for r in early.all(JobReport)]
          == ["fault", "done"], 20)
    late = Reader(cell)
    until(lambda: [r.state for r in late.all(JobReport)] == ["done"], 20)
    assert sink.end() == 0
    early.close()
    late.close()


def test_the_times_of_a_machine_are_told(cell, tmp_path):
    sink = Sink(tmp_path)
    until(lambda: sink.rows("what FROM spent", cell), 30)
    cell.client.ask("estop")
    cell.client.status_where(lambda s: s.fault == "e-stop")
    until(lambda: "e-stop" in sink.rows("why FROM spent", cell), 30)
    cell.kill("dds")
    until(lambda: "gone" in sink.rows("why FROM spent", cell), 30)
    assert sink.end() == 0
    r = told(sink, cell, "report")[0]
    assert r["idle_h"] > 0 and r["stand_h"] > 0 and r["away_h"] > 0
    assert "e-stop 0.0" in r["why"] and "gone 0.0" in r["why"]
    assert (r["jobs"], r["cut_h"], r["energy_j"]) == (0, 0, None)


def test_without_a_file_the_last_day_is_told(cell):
    cut(cell, "one")
    alarm(cell)
    p = edm_fleet("report", "--json", "--wait", "3")
    assert p.returncode == 0, p.stderr
    r = [r for r in json.loads(p.stdout)["report"]
         if r["machine"] == cell.name][0]
    assert (r["jobs"], r["done"], round(r["path_mm"], 3)) == (1, 1, 0.4)
    p = edm_fleet("alarms", "--wait", "3")
    assert p.returncode == 0, p.stderr
    row = [r for r in p.stdout.splitlines() if cell.name in r
           and "e-stop" in r]
    assert len(row) == 1, p.stdout
    p = edm_fleet("report", "--week")
    assert p.returncode == 64 and "--database FILE" in p.stderr


def test_a_full_disk_of_the_sink_loses_nothing(cell, tmp_path, shim):
    full = tmp_path / "errno"
    sink = Sink(tmp_path, {"LD_PRELOAD": rig.preload(shim),
                           "EDM_DISK": str(tmp_path / "disk"),
                           "EDM_DISK_ERRNO": str(full)})
    cut(cell, "a")
    sink.has(cell, "a")
    full.write_text(str(errno.ENOSPC))
    cut(cell, "b", "c")
    until(lambda: "nothing is stored" in sink.log.read_text(), 30)
    assert sink.log.read_text().count("nothing is stored") == 1
    full.unlink()
    sink.has(cell, "a", "b", "c")
    until(lambda: "all is stored again" in sink.log.read_text(), 30)
    assert sink.end() == 0


def test_a_file_that_was_put_away_is_begun_anew(cell, tmp_path):
    sink = Sink(tmp_path)
    cut(cell, "a")
    sink.has(cell, "a")
    os.rename(sink.file, tmp_path / "disk/old.db")
    cut(cell, "b")
    sink.has(cell, "b")
    os.unlink(sink.file)
    cut(cell, "c")
    sink.has(cell, "c")
    # Its folder is away for a while: what comes is kept.
    os.rename(tmp_path / "disk", tmp_path / "away")
    cut(cell, "d")
    until(lambda: "nothing is stored" in sink.log.read_text(), 30)
    cut(cell, "e")
    os.rename(tmp_path / "away", tmp_path / "disk")
    sink.has(cell, "c", "d", "e")
    assert sink.end() == 0
    with contextlib.closing(sqlite3.connect(tmp_path / "disk/old.db")) as db:
        assert db.execute("SELECT job FROM report").fetchall() == [("a",)]


def test_hours_go_on_while_somebody_locks_the_file(cell, tmp_path):
    sink = Sink(tmp_path)

    def hours():
        return sum(sink.rows("s FROM spent", cell))
    until(hours, 30)
    begun, had = time.monotonic(), hours()
    with contextlib.closing(sqlite3.connect(sink.file, timeout=60,
                                            isolation_level=None)) as db:
        db.execute("BEGIN IMMEDIATE")
        until(lambda: "nothing is stored" in sink.log.read_text(), 30)
        time.sleep(15)
        locked = time.monotonic() - begun
    until(lambda: hours() > had + locked / 2, 30)
    assert sink.end() == 0


def test_a_report_in_another_s_name_is_not_kept(cell, tmp_path):
    sink, d = Sink(tmp_path), DomainParticipant(0)
    topic = Topic(d, "EDM_JobReport", JobReport)
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=10)),
              Policy.Durability.TransientLocal, Policy.History.KeepAll)
    ends = []
    for part in "other", cell.name:
        ends.append(DataWriter(Publisher(d, Qos(Policy.Partition([part]))),
                               topic, qos=qos))
        until(ends[-1].get_matched_subscriptions)
        ends[-1].write(JobReport(**{
            f.name: 0 if f.type in (int64, float64, uint32) else part[:9]
            for f in dataclasses.fields(JobReport)} | {
                "machine": cell.name, "number": len(ends)}))
    sink.has(cell, cell.name[:9])
    assert sink.end() == 0
    assert sink.rows("job FROM report", cell) == [cell.name[:9]]
    ends.clear()


def test_only_one_sink_writes_a_file(cell, tmp_path):
    sink = Sink(tmp_path)
    until(lambda: sink.rows("what FROM spent", cell), 30)
    p = edm_fleet("record", "--database", str(sink.file))
    assert p.returncode == 75 and "another edm-fleet record" in p.stderr
    assert sink.end() == 0


@pytest.mark.parametrize("args,code", [
    (["record"], 64), (["nonsense"], 64),
    (["report", "--database", "/nonexistent/file"], 66),
    (["record", "--database", "/nonexistent/file"], 66),
    (["alarms", "--database", __file__], 66),
])
def test_what_cannot_be_is_refused(args, code):
    p = edm_fleet(*args)
    assert p.returncode == code, p.stderr
    assert "edm-fleet: error:" in p.stderr
