# SPDX-License-Identifier: Apache-2.0
"""The fleet: what a DDS peer written by others hears of the machines.

The peer is PyPI's cyclonedds; its type is written out here by hand from
messages/edm.idl, so that what is tested is what is on the wire.
"""

import contextlib
import dataclasses
import gc
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest
import rig
from rig import BUILD, SLOW_JOB, until

pytest.importorskip("cyclonedds", reason="pip install cyclonedds")

from cyclonedds.core import InstanceState, Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlEnum, IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import appendable, key  # noqa: E402
from cyclonedds.idl.types import (  # noqa: E402
    array, bounded_str, float64, int64, uint32, uint64,
)
from cyclonedds.pub import DataWriter, Publisher  # noqa: E402
from cyclonedds.sub import DataReader, Subscriber  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

TOLD = """peak_a on_us off_us polarity ignition_v iso servo_v opens sparks arcs
shorts energy_j fault""".split()


class GeneratorState(IdlEnum, typename="edm.GeneratorState"):
    GENERATOR_UNDEFINED = 0
    GENERATOR_READY = 1
    GENERATOR_ACTIVE_LOW_VOLTAGE = 2
    GENERATOR_ACTIVE_HIGH_VOLTAGE = 3
    GENERATOR_ERROR = 4


@dataclasses.dataclass
@appendable
class MachineState(IdlStruct, typename="edm.MachineState"):
    machine: bounded_str[31]
    key("machine")
    host: bounded_str[63]
    state: bounded_str[15]
    fault: bounded_str[31]
    utime: int64
    cycle: uint64
    program: uint32
    line: uint32
    progress: float64
    place_mm: float64
    length_mm: float64
    depth_mm: float64
    feed_mm_s: float64
    gap_v: float64
    position_mm: array[float64, 8]
    generator_state: GeneratorState
    is_on: bool
    jumps: uint32
    retracts: uint32
    shorts: uint32
    overruns: uint32
    wake_late_max_us: float64
    outcome: bounded_str[15]
    stand: bounded_str[15]
    told_peak_a: float64
    told_on_us: float64
    told_off_us: float64
    told_polarity: float64
    told_ignition_v: float64
    told_iso: float64
    told_servo_v: float64
    told_opens: float64
    told_sparks: float64
    told_arcs: float64
    told_shorts: float64
    told_energy_j: float64
    told_fault: float64
    generator_fault: bounded_str[63]
    depth_far_mm: float64
    known: uint32


def of_all(participant):
    """A subscriber that hears the partitions of all machines."""
    return Subscriber(participant, Qos(Policy.Partition(["*"])))


class Peer:
    """Keeps the last sample of each machine and whether it is alive."""

    def __init__(self, *more):
        self.participant = DomainParticipant(0)
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.TransientLocal,
            Policy.History.KeepLast(1),
            Policy.Liveliness.ManualByTopic(duration(seconds=2)),
            *more,
        )
        self.topic = Topic(
            self.participant, "EDM_MachineState", MachineState
        )
        self.writing = qos
        self.reader = DataReader(of_all(self.participant), self.topic, qos=qos)

    def writer(self, machine):
        """In the partition of this machine."""
        part = Publisher(self.participant, Qos(Policy.Partition([machine])))
        return DataWriter(part, self.topic, qos=self.writing)

    def close(self):
        self.reader = self.topic = self.participant = None
        gc.collect()

    def look(self):
        got = {}
        for s in self.reader.read(N=100):
            if isinstance(s, MachineState):
                alive = s.sample_info.instance_state == InstanceState.Alive
                got[s.machine] = (s, alive)
        return got

    def where(self, machine, what, timeout=8):
        """The sample of a living machine for which what(sample) is true."""

        def heard():
            s, alive = self.look().get(machine.name, (None, False))
            return s if alive and what(s) else None

        return until(heard, timeout)

    def state(self, machine, state):
        return self.where(machine, lambda s: s.state == state)

    def gone(self, machine):
        until(lambda: not self.look()[machine.name][1], 8)


@pytest.fixture
def peer():
    p = Peer()
    yield p
    p.close()


class FleetMachine(rig.Machine):
    """A machine with its edm-dds."""

    dds = None

    def start_dds(self):
        self.dds = self._start("edm-dds", "--machine", self.name)

    def close(self):
        if self.dds and self.dds.poll() is None:
            assert self.end("dds") == 0
        super().close()


@pytest.fixture
def fleet(tmp_path):
    """Two machines, not started."""
    folders = [tmp_path / "a", tmp_path / "b"]
    for f in folders:
        f.mkdir()
    machines = [FleetMachine(f) for f in folders]
    yield machines
    for m in machines:
        m.close()
        assert m.shm() == [], "left in /dev/shm"


def edm_fleet(*args, timeout=120):
    return subprocess.run(
        [str(BUILD / "edm-fleet"), *args],
        capture_output=True, text=True, timeout=timeout,
    )


def test_a_machine_is_absent_then_idle_then_absent(fleet, peer):
    m, _ = fleet
    m.start_dds()
    s = peer.state(m, "absent")
    assert (s.utime, s.cycle) == (0, 0)
    assert s.generator_state == GeneratorState.GENERATOR_UNDEFINED

    m.start_edmd()
    s = peer.state(m, "idle")
    assert s.fault == "none" and s.host
    assert s.generator_state == GeneratorState.GENERATOR_READY and not s.is_on
    peer.where(m, lambda later: later.cycle > s.cycle)

    assert m.end("edmd") == 0
    peer.state(m, "absent")


def test_two_machines_are_told_apart(fleet, peer):
    a, b = fleet
    for m in fleet:
        m.start_dds()
    b.start_edmd()
    peer.state(b, "idle")
    peer.state(a, "absent")

    a.start()
    peer.state(a, "idle")
    assert a.client.submit(SLOW_JOB, "job").code == 0
    half = peer.where(a, lambda s: s.state == "travel" and s.progress > 0.5)
    assert half.program > 0 and half.line == 2
    assert abs(half.length_mm - 2) < 1e-6
    assert abs(half.place_mm - 2 * half.progress) < 0.01
    assert abs(half.position_mm[0] - half.place_mm) < 2e-3
    assert abs(half.feed_mm_s - 1) < 0.01
    peer.state(a, "idle")
    s = peer.state(b, "idle")
    assert s.program == 0 and list(s.position_mm) == [0] * 8


def test_a_killed_edmd_is_lost_until_it_is_back(fleet, peer):
    m, _ = fleet
    m.start_edmd()
    m.start_dds()
    before = peer.state(m, "idle")

    m.kill("edmd")
    s = peer.state(m, "lost")
    assert s.cycle >= before.cycle, "the last it said is kept"
    assert s.generator_state == GeneratorState.GENERATOR_UNDEFINED and not s.is_on

    m.start_edmd()
    peer.state(m, "idle")


def test_a_cycle_that_stands_is_lost(fleet, peer):
    m, _ = fleet
    m.start_edmd()
    m.start_dds()
    peer.state(m, "idle")
    m.edmd.send_signal(signal.SIGSTOP)
    try:
        peer.state(m, "lost")
    finally:
        m.edmd.send_signal(signal.SIGCONT)
    peer.state(m, "idle")


@pytest.mark.parametrize("how", [
    signal.SIGTERM, signal.SIGKILL, signal.SIGSTOP,
])
def test_an_edm_dds_that_left_died_or_hangs_is_gone(fleet, peer, how):
    m, _ = fleet
    m.start_dds()
    peer.state(m, "absent")
    m.dds.send_signal(how)
    try:
        peer.gone(m)
    finally:
        m.dds.send_signal(signal.SIGCONT)
    if how == signal.SIGSTOP:
        peer.state(m, "absent")


def test_edm_fleet_lists_all_machines(fleet):
    a, b = fleet
    a.start_edmd()
    for m in fleet:
        m.start_dds()
    p = edm_fleet("--once", "--wait", "3", "--json")
    assert p.returncode == 0, p.stderr
    got = {m["machine"]: m for m in json.loads(p.stdout)["machines"]}
    assert got[a.name]["state"] == "idle"
    assert got[a.name]["generator_state"] == "ready"
    assert got[b.name]["state"] == "absent"

    p = edm_fleet("--once", "--wait", "3")
    lines = p.stdout.splitlines()
    assert lines[0].startswith("MACHINE")
    assert [r.split()[0] for r in lines[1:]] == sorted(
        [a.name, b.name])


def test_edm_fleet_shows_who_is_gone(fleet, peer):
    m, _ = fleet
    m.start_dds()
    peer.state(m, "absent")
    with subprocess.Popen(
        [str(BUILD / "edm-fleet"), "--watch", "--json"],
        stdout=subprocess.PIPE, text=True,
    ) as p:
        try:
            shown = iter(json.loads(line)["machines"] for line in p.stdout)
            next(s for s in shown if s and s[0]["state"] == "absent")
            m.kill("dds")
            next(s for s in shown if s[0]["state"] == "gone")
        finally:
            p.terminate()
        assert p.wait(5) == 0


def test_a_hostile_sample_is_shown_as_harmless_text(peer):
    """Nobody signs on DDS: any host may say what it likes."""
    words = dict(machine="\x1b[2Jx", host="\u202ehost\x9b", state="\x9b2J\n",
                 fault="\x1b]0;evil\x07", outcome="\x7f\r",
                 stand="\x1b[2J")
    s = MachineState(
        utime=-1, cycle=2**64 - 1, program=0, line=2**32 - 1,
        progress=math.nan, place_mm=math.inf, length_mm=-math.inf,
        depth_mm=1e308, feed_mm_s=-1e308, gap_v=math.nan,
        position_mm=[math.nan] * 8,
        generator_state=GeneratorState.GENERATOR_ERROR, is_on=True,
        jumps=0, retracts=0, shorts=0, overruns=0, wake_late_max_us=-1e308,
        generator_fault="\x1b[2J", depth_far_mm=math.inf, known=1,
        **{f"told_{n}": math.inf for n in TOLD}, **words)
    writer = peer.writer(words["machine"])
    writer.write(s)
    for more in ((), ("--json",)):
        p = edm_fleet("--once", "--wait", "3", *more)
        assert p.returncode == 0, p.stderr
        assert "?[2Jx" in p.stdout
        assert all(c == "\n" or " " <= c <= "~" for c in p.stdout), p.stdout
    del writer


def test_edm_fleet_hears_none(fleet):
    p = edm_fleet("--once", "--wait", "0.5")
    assert p.returncode == 1
    assert p.stdout == ""
    assert "no machine heard" in p.stderr


@pytest.mark.parametrize("args", [
    ["--domain", "231"], ["--wait", "0"], ["--nonsense"], ["more"],
])
def test_edm_fleet_refuses_what_it_does_not_know(args):
    assert edm_fleet(*args).returncode == 64


def test_edm_dds_once_needs_a_listener(fleet):
    m, _ = fleet
    once = [str(BUILD / "edm-dds"), "--machine", m.name, "--once"]
    assert subprocess.run(once, timeout=120).returncode == 1
    peer = Peer()
    try:
        assert subprocess.run(once, timeout=120).returncode == 0
        assert peer.look()[m.name][0].state == "absent"
    finally:
        peer.close()


def test_a_peer_may_ask_for_a_sample_each_second(fleet):
    m, _ = fleet
    m.start_dds()
    peer = Peer(Policy.Deadline(duration(seconds=1)))
    try:
        peer.state(m, "absent")
    finally:
        peer.close()


def listed(m, *more):
    """What edm-fleet says of a machine."""
    p = edm_fleet("--once", "--wait", "1", "--json", *more)
    return {r["machine"]: r for r in json.loads(p.stdout or '{"machines": []}')
            ["machines"]}.get(m.name, {})


def stranger_says(m, **more):
    """A sample of a stranger in the name of a machine."""
    words = dict(host="elsewhere", state="idle", fault="none",
                 outcome="none", stand="", generator_fault="")
    numbers = {f.name: 0 for f in dataclasses.fields(MachineState)}
    return MachineState(**numbers | words | dict(
        machine=m.name, position_mm=[0] * 8, is_on=False,
        generator_state=GeneratorState.GENERATOR_READY) | more)


@contextlib.contextmanager
def telling(sample, part=None):
    """A program of its own says it, 20 times a second."""
    p, stop = Peer(), threading.Event()
    writer = p.writer(sample.machine if part is None else part)

    def tell():
        while not stop.wait(0.05):
            writer.write(sample)

    t = threading.Thread(target=tell)
    t.start()
    try:
        yield
    finally:
        stop.set()
        t.join()
        del writer
        p.close()


def test_a_name_that_two_programs_tell_is_disputed(fleet, peer):
    m, _ = fleet
    m.start_edmd()
    m.start_dds()
    peer.state(m, "idle")
    assert listed(m)["state"] == "idle"
    with telling(stranger_says(m, state="erode")):
        until(lambda: listed(m)["state"] == "disputed", 20)
        p = edm_fleet("--once", "--wait", "1")
        assert "told by two; also from" in p.stdout
    until(lambda: listed(m)["state"] == "idle", 20)


@pytest.mark.parametrize("part", ["", "other"])
def test_what_is_told_outside_of_a_machine_s_partition_is_not_heard(
        fleet, peer, part):
    """DDS Security gives each machine its own partition, and no other."""
    m, other = fleet
    m.start_edmd()
    m.start_dds()
    peer.state(m, "idle")
    with telling(stranger_says(m, state="erode"), part):
        peer.where(m, lambda s: s.state == "erode", 20)
        for _ in range(3):
            assert listed(m)["state"] == "idle"
    with telling(stranger_says(other), part):
        peer.state(other, "idle")
        assert listed(other) == {}


def test_an_edm_dds_that_is_started_anew_is_no_dispute(fleet, peer):
    m, _ = fleet
    m.start_edmd()
    with subprocess.Popen([str(BUILD / "edm-fleet"), "--watch", "--json"],
                          stdout=subprocess.PIPE, text=True) as p:
        try:
            for _ in range(3):
                m.start_dds()
                peer.state(m, "idle")
                m.kill("dds")
            m.start_dds()
            gone = until(lambda: listed(m)["state"] == "idle", 20)
        finally:
            p.terminate()
        shown = [r["state"] for line in p.stdout
                 for r in json.loads(line)["machines"]]
    assert gone and "disputed" not in shown and "idle" in shown, shown


def test_edm_fleet_waits_for_all_that_anybody_knows(fleet, peer):
    """A machine that others have found, and this listener not yet."""
    m, _ = fleet
    with telling(stranger_says(m, known=2)):
        p = edm_fleet("--once", "--wait", "0.5")
    assert p.returncode == 1
    assert "heard 1 of 2 machines" in p.stderr
    assert m.name in p.stdout
    for m in fleet:
        m.start_dds()
    peer.where(m, lambda s: s.known == 2)
    p = edm_fleet("--once", "--wait", "1")
    assert p.returncode == 0, p.stderr
    p = edm_fleet("--once", "--wait", "0.5", "--expect", "4")
    assert p.returncode == 1 and " of 4 machines" in p.stderr


def test_garbage_is_counted_and_not_told_packet_by_packet(fleet, peer):
    m, _ = fleet
    m.start_dds()
    peer.state(m, "absent")
    s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    ports = {rig.udp_port(r) for r in rig.udp_rows(m.dds.pid)}
    for _ in range(300):
        for port in ports:
            s.sendto(b"RTPS\x02\x05\x01\x10" + os.urandom(64),
                     ("127.0.0.1", port))
    peer.state(m, "absent")
    lines = (m.folder / "edm-dds.log").read_text().splitlines()
    assert len([r for r in lines if "DDS, " in r]) == 1, lines
    assert len(lines) < 4, lines


def test_edm_fleet_says_that_new_machines_still_came(fleet, peer):
    m, _ = fleet
    writers = []
    with subprocess.Popen([str(BUILD / "edm-fleet"), "--once", "--wait", "1"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as p:
        n = 0
        while p.poll() is None:
            s = stranger_says(m)
            s.machine, n = f"{m.name}-{n}", n + 1
            writers.append(peer.writer(s.machine))
            writers[-1].write(s)
            time.sleep(0.1)
        assert p.returncode == 1
        assert "new ones still came" in p.stderr.read()


def test_the_tool_of_cyclone_dds_lists_what_a_machine_tells(fleet, peer):
    """cyclonedds ls, of PyPI's cyclonedds, knows nothing of edmd."""
    m, _ = fleet
    m.start()
    m.start_dds()
    peer.state(m, "idle")

    def is_listed():
        p = subprocess.run(
            [sys.executable, "-m", "cyclonedds.tools.cli.main", "ls",
             "--suppress-progress-bar", "--runtime", "3"],
            capture_output=True, text=True, timeout=120)
        assert p.returncode == 0, p.stderr
        return all(f"EDM_{topic}" in p.stdout for topic in (
            "MachineState", "JobReport", "Alarm", "Scope", "JobOffer"))

    until(is_listed, 60)
