# SPDX-License-Identifier: Apache-2.0
"""Each cycle of a machine of the fleet, on request: while somebody reads it.

The peer is PyPI's cyclonedds; its types are written out from messages/edm.idl.
"""
import csv
import dataclasses
import signal
import subprocess
import time

import pytest
from rig import BUILD, SLOW_JOB, until
from test_fleet import fleet  # noqa: F401

pytest.importorskip("cyclonedds", reason="pip install cyclonedds")

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import appendable, final, key  # noqa: E402
from cyclonedds.idl.types import (  # noqa: E402
    array, bounded_str, float32, float64, int32, sequence, uint32, uint64,
)
from cyclonedds.pub import DataWriter, Publisher  # noqa: E402
from cyclonedds.sub import DataReader, Subscriber  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

IDLE, EROSION = 0, {1, 2, 3}


@dataclasses.dataclass
@final
class ScopeRow(IdlStruct, typename="edm.ScopeRow"):
    cycle: uint64
    place_mm: float64
    feed_mm_s: float32
    gap_v: float32
    line: uint32
    state: uint32
    position: array[int32, 8]
    actual: array[int32, 8]


@dataclasses.dataclass
@appendable
class Scope(IdlStruct, typename="edm.Scope"):
    machine: bounded_str[31]
    key("machine")
    period_s: float64
    pulse_mm: array[float64, 8]
    rows: sequence[ScopeRow, 512]


QOS = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)),
          Policy.Durability.Volatile, Policy.History.KeepLast(128))


def of(machine):
    return Qos(Policy.Partition([machine.name]))


@pytest.fixture
def shop(fleet):  # noqa: F811
    m, _ = fleet
    m.start()
    m.start_dds()
    return m


class Recorder:
    def __init__(self, machine, path):
        self.path = path
        self.p = subprocess.Popen(
            [str(BUILD / "edm-fleet"), "scope", str(path), "--machine",
             machine.name], stderr=subprocess.PIPE, text=True)

    def rows(self):
        with open(self.path, newline="") as f:
            return list(csv.DictReader(f))

    def end(self):
        self.p.send_signal(signal.SIGINT)
        said = self.p.communicate(timeout=60)[1]
        return self.p.returncode, said


def test_a_peer_that_reads_gets_each_cycle_from_now_on(shop):
    participant = DomainParticipant(0)
    reader = DataReader(Subscriber(participant, of(shop)),
                        Topic(participant, "EDM_Scope", Scope), qos=QOS)
    cycles = []

    def heard():
        for s in reader.take(N=64):
            if not isinstance(s, Scope):
                continue
            assert s.machine == shop.name and len(s.rows) <= 512
            assert s.period_s == pytest.approx(1e-3)
            cycles.extend(r.cycle for r in s.rows)
        return len(cycles) > 1500

    until(heard, 60)
    assert cycles == sorted(set(cycles))
    missed = cycles[-1] - cycles[0] + 1 - len(cycles)
    assert missed < len(cycles)


def test_the_csv_has_the_way_of_a_job(shop, tmp_path):
    r = Recorder(shop, tmp_path / "scope.csv")
    until(lambda: r.path.exists() and r.path.stat().st_size > 4096, 60)
    job = tmp_path / "a.ngc"
    job.write_bytes(SLOW_JOB)
    assert shop.ctl("submit", str(job)).returncode == 0
    until(lambda: any(x["state"] == "travel" and float(x["feed_mm_s"]) > 0
                      for x in r.rows()[:-1]), 60)
    code, said = r.end()
    rows = r.rows()
    assert code == 0 and f"{len(rows)} cycles of {shop.name}" in said, said
    t = [float(x["t_s"]) for x in rows]
    assert t[0] == 0 and t == sorted(set(t))
    # A lost cycle is told, and nothing stands in its place.
    lost = int(said.split(" lost")[0].split()[-1])
    assert round(t[-1] / 1e-3) + 1 == len(rows) + lost
    # It is the CSV of `edmctl record`.
    shop.ctl("reset")
    shop.ctl("submit", "--start", str(job))
    record = subprocess.run(
        [str(BUILD / "edmctl"), "--machine", shop.name, "record",
         str(tmp_path / "r.csv"), "--until-end"], capture_output=True,
        timeout=120)
    assert record.returncode == 0
    with open(tmp_path / "r.csv") as a, open(r.path) as b:
        assert a.readline() == b.readline()


def test_what_a_stranger_tells_in_another_partition_is_not_recorded(
        shop, tmp_path):
    r = Recorder(shop, tmp_path / "scope.csv")
    participant = DomainParticipant(0)
    topic = Topic(participant, "EDM_Scope", Scope)
    part = Publisher(participant, Qos(Policy.Partition([shop.name, "other"])))
    writer = DataWriter(part, topic, qos=QOS)
    row = ScopeRow(1 << 40, 77.0, 0.0, 0.0, 1, 99, [0] * 8, [0] * 8)
    until(lambda: r.path.exists() and r.path.stat().st_size > 4096, 60)
    for _ in range(20):
        writer.write(Scope(shop.name, 1e-3, [1e-3] * 8, [row]))
        time.sleep(0.02)
    n = len(r.rows())
    until(lambda: len(r.rows()) > n + 500, 60)
    assert r.end()[0] == 0
    assert not any(float(x["s_mm"]) == 77 for x in r.rows())


def test_an_edmd_that_is_started_anew_is_gone_on_with(shop, tmp_path):
    """Its cycles begin at 0 again; the time of the CSV goes on."""
    r = Recorder(shop, tmp_path / "scope.csv")
    until(lambda: r.path.exists() and len(r.rows()) > 2000, 60)
    n = len(r.rows())
    shop.edmd.kill()
    shop.edmd.wait()
    shop.start_edmd()
    until(lambda: len(r.rows()) > n + 2000, 60)
    assert r.end()[0] == 0
    t = [float(x["t_s"]) for x in r.rows()]
    assert t == sorted(set(t)) and t[-1] < 1e4


def test_a_full_disk_ends_it(shop):
    p = subprocess.run(
        [str(BUILD / "edm-fleet"), "scope", "/dev/full", "--machine",
         shop.name], capture_output=True, text=True, timeout=120)
    assert p.returncode == 74 and "/dev/full" in p.stderr, p.stderr


def test_a_machine_that_is_not_there_is_said(tmp_path):
    p = subprocess.Popen(
        [str(BUILD / "edm-fleet"), "scope", str(tmp_path / "x.csv"),
         "--machine", "nobody"], stderr=subprocess.PIPE, text=True)
    until(lambda: (tmp_path / "x.csv").exists(), 20)
    p.send_signal(signal.SIGTERM)
    said = p.communicate(timeout=60)[1]
    assert p.returncode == 1 and "0 cycles of nobody" in said, said


@pytest.mark.parametrize("args, wanted", [
    (["scope"], "scope FILE --machine NAME"),
    (["scope", "a.csv"], "scope FILE --machine NAME"),
    (["scope", "a.csv", "--machine", "a/b"], "--machine a/b"),
    (["scope", "/nowhere/a.csv", "--machine", "a"], "a file for the cycles"),
])
def test_scope_refuses_what_it_cannot_do(args, wanted):
    p = subprocess.run([str(BUILD / "edm-fleet"), *args], capture_output=True,
                       text=True, timeout=60)
    assert p.returncode in (64, 73) and wanted in p.stderr, p.stderr
