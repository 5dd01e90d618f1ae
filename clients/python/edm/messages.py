# SPDX-License-Identifier: Apache-2.0
"""The messages of edm.lcm; units are in the names, and edm.lcm says what each
field means.

A message is its fields in order, big-endian, as LCM lays them out, after eight
bytes that stand for its type.  This file is what messages/make-python prints.
"""

from __future__ import annotations

from dataclasses import dataclass

from . import layout as put
from .layout import Reader

Bytes = bytes
SIGNED = bytes.fromhex("49657b54b950317d")
COMMAND = bytes.fromhex("633b130fba8a2ccf")
ACK = bytes.fromhex("e7a36102b59e523d")
JOB_CHUNK = bytes.fromhex("02d6b52732df0242")
STATUS = bytes.fromhex("7ec5d2a64a6aab0a")
EVENT = bytes.fromhex("15ff8b6c83f6aeb8")


@dataclass(frozen=True)
class Signed:
    """signed_t"""

    key: Bytes = b""
    boot: int = 0
    count: int = 0
    signature: Bytes = b""
    data: Bytes = b""

    def encode(self) -> Bytes:
        return (SIGNED
                + put.exactly(32, self.key)
                + put.int64_t(self.boot)
                + put.int64_t(self.count)
                + put.exactly(64, self.signature)
                + put.int32_t(len(self.data)) + self.data)

    @staticmethod
    def decode(data: Bytes) -> Signed:
        r = Reader(data, SIGNED)
        m = Signed(
            r.take(32),
            r.int64_t(),
            r.int64_t(),
            r.take(64),
            r.take(r.int32_t()),
        )
        r.end()
        return m


@dataclass(frozen=True)
class Command:
    """command_t"""

    utime: int = 0
    client: str = ""
    seq: int = 0
    verb: str = ""
    job: str = ""
    arg: float = 0.0
    text: str = ""

    def encode(self) -> Bytes:
        return (COMMAND
                + put.int64_t(self.utime)
                + put.string(self.client)
                + put.int64_t(self.seq)
                + put.string(self.verb)
                + put.string(self.job)
                + put.double(self.arg)
                + put.string(self.text))

    @staticmethod
    def decode(data: Bytes) -> Command:
        r = Reader(data, COMMAND)
        m = Command(
            r.int64_t(),
            r.string(),
            r.int64_t(),
            r.string(),
            r.string(),
            r.double(),
            r.string(),
        )
        r.end()
        return m


@dataclass(frozen=True)
class Ack:
    """ack_t"""

    utime: int = 0
    key: Bytes = b""
    client: str = ""
    seq: int = 0
    code: int = 0
    reason: str = ""
    body: str = ""

    def encode(self) -> Bytes:
        return (ACK
                + put.int64_t(self.utime)
                + put.exactly(32, self.key)
                + put.string(self.client)
                + put.int64_t(self.seq)
                + put.int32_t(self.code)
                + put.string(self.reason)
                + put.string(self.body))

    @staticmethod
    def decode(data: Bytes) -> Ack:
        r = Reader(data, ACK)
        m = Ack(
            r.int64_t(),
            r.take(32),
            r.string(),
            r.int64_t(),
            r.int32_t(),
            r.string(),
            r.string(),
        )
        r.end()
        return m


@dataclass(frozen=True)
class JobChunk:
    """job_chunk_t"""

    utime: int = 0
    client: str = ""
    seq: int = 0
    job: str = ""
    name: str = ""
    bytes: int = 0
    sha256: Bytes = b""
    chunk: int = 0
    chunks: int = 0
    offset: int = 0
    hold: bool = False
    from_line: int = 0
    from_mm: float = 0.0
    electrode: int = 0
    setting: str = ""
    data: Bytes = b""

    def encode(self) -> Bytes:
        return (JOB_CHUNK
                + put.int64_t(self.utime)
                + put.string(self.client)
                + put.int64_t(self.seq)
                + put.string(self.job)
                + put.string(self.name)
                + put.int64_t(self.bytes)
                + put.exactly(32, self.sha256)
                + put.int32_t(self.chunk)
                + put.int32_t(self.chunks)
                + put.int64_t(self.offset)
                + put.boolean(self.hold)
                + put.int32_t(self.from_line)
                + put.double(self.from_mm)
                + put.int32_t(self.electrode)
                + put.string(self.setting)
                + put.int32_t(len(self.data)) + self.data)

    @staticmethod
    def decode(data: Bytes) -> JobChunk:
        r = Reader(data, JOB_CHUNK)
        m = JobChunk(
            r.int64_t(),
            r.string(),
            r.int64_t(),
            r.string(),
            r.string(),
            r.int64_t(),
            r.take(32),
            r.int32_t(),
            r.int32_t(),
            r.int64_t(),
            r.boolean(),
            r.int32_t(),
            r.double(),
            r.int32_t(),
            r.string(),
            r.take(r.int32_t()),
        )
        r.end()
        return m


@dataclass(frozen=True)
class Status:
    """status_t"""

    utime: int = 0
    machine: str = ""
    daemon: str = ""
    state: str = ""
    fault: str = ""
    faults: str = ""
    job: str = ""
    job_name: str = ""
    job_state: str = ""
    line: int = 0
    lines: int = 0
    place_mm: float = 0.0
    length_mm: float = 0.0
    progress: float = 0.0
    pos_mm: tuple[float, ...] = ()
    axes: str = ""
    work: str = ""
    work_turn_deg: float = 0.0
    wire_pass: int = 0
    wire_passes: int = 0
    wire_offset_mm: float = 0.0
    work_mm: tuple[float, ...] = ()
    gap_v: float = 0.0
    feed_mm_s: float = 0.0
    depth_mm: float = 0.0
    depth_far_mm: float = 0.0
    process: str = ""
    height_mm: float = 0.0
    lean_deg: float = 0.0
    contour_mm: float = 0.0
    contour_predicted_mm: float = 0.0
    jumps: int = 0
    retracts: int = 0
    shorts: int = 0
    job_s: float = 0.0
    eta_s: float = 0.0
    eta_min_s: float = 0.0
    eta_max_s: float = 0.0
    eta_by: str = ""
    eta_condition: str = ""
    eta_factor: float = 0.0
    end_s: float = 0.0
    queue_len: int = 0
    queue_s: float = 0.0
    queue_untold: int = 0
    queue_end_s: float = 0.0
    overruns: int = 0
    wake_late_max_us: int = 0
    condition: str = ""
    store: str = ""
    interrupted: str = ""
    lost: str = ""
    hunts: int = 0
    electrode: int = 0
    electrode_shift_mm: float = 0.0
    electrode_wear_mm: float = 0.0
    stand: str = ""
    asks: str = ""
    stand_s: float = 0.0
    told_peak_a: float = 0.0
    told_on_us: float = 0.0
    told_off_us: float = 0.0
    told_polarity: float = 0.0
    told_ignition_v: float = 0.0
    told_iso: float = 0.0
    told_servo_v: float = 0.0
    told_opens: float = 0.0
    told_sparks: float = 0.0
    told_arcs: float = 0.0
    told_shorts: float = 0.0
    told_energy_j: float = 0.0
    told_fault: float = 0.0
    generator_fault: str = ""

    def encode(self) -> Bytes:
        return (STATUS
                + put.int64_t(self.utime)
                + put.string(self.machine)
                + put.string(self.daemon)
                + put.string(self.state)
                + put.string(self.fault)
                + put.string(self.faults)
                + put.string(self.job)
                + put.string(self.job_name)
                + put.string(self.job_state)
                + put.int32_t(self.line)
                + put.int32_t(self.lines)
                + put.double(self.place_mm)
                + put.double(self.length_mm)
                + put.double(self.progress)
                + b"".join(map(put.double, self.pos_mm))
                + put.string(self.axes)
                + put.string(self.work)
                + put.double(self.work_turn_deg)
                + put.int32_t(self.wire_pass)
                + put.int32_t(self.wire_passes)
                + put.double(self.wire_offset_mm)
                + b"".join(map(put.double, self.work_mm))
                + put.double(self.gap_v)
                + put.double(self.feed_mm_s)
                + put.double(self.depth_mm)
                + put.double(self.depth_far_mm)
                + put.string(self.process)
                + put.double(self.height_mm)
                + put.double(self.lean_deg)
                + put.double(self.contour_mm)
                + put.double(self.contour_predicted_mm)
                + put.int32_t(self.jumps)
                + put.int32_t(self.retracts)
                + put.int32_t(self.shorts)
                + put.double(self.job_s)
                + put.double(self.eta_s)
                + put.double(self.eta_min_s)
                + put.double(self.eta_max_s)
                + put.string(self.eta_by)
                + put.string(self.eta_condition)
                + put.double(self.eta_factor)
                + put.double(self.end_s)
                + put.int32_t(self.queue_len)
                + put.double(self.queue_s)
                + put.int32_t(self.queue_untold)
                + put.double(self.queue_end_s)
                + put.int32_t(self.overruns)
                + put.int32_t(self.wake_late_max_us)
                + put.string(self.condition)
                + put.string(self.store)
                + put.string(self.interrupted)
                + put.string(self.lost)
                + put.int32_t(self.hunts)
                + put.int32_t(self.electrode)
                + put.double(self.electrode_shift_mm)
                + put.double(self.electrode_wear_mm)
                + put.string(self.stand)
                + put.string(self.asks)
                + put.double(self.stand_s)
                + put.double(self.told_peak_a)
                + put.double(self.told_on_us)
                + put.double(self.told_off_us)
                + put.double(self.told_polarity)
                + put.double(self.told_ignition_v)
                + put.double(self.told_iso)
                + put.double(self.told_servo_v)
                + put.double(self.told_opens)
                + put.double(self.told_sparks)
                + put.double(self.told_arcs)
                + put.double(self.told_shorts)
                + put.double(self.told_energy_j)
                + put.double(self.told_fault)
                + put.string(self.generator_fault))

    @staticmethod
    def decode(data: Bytes) -> Status:
        r = Reader(data, STATUS)
        m = Status(
            r.int64_t(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.int32_t(),
            r.int32_t(),
            r.double(),
            r.double(),
            r.double(),
            tuple(r.double() for _ in range(8)),
            r.string(),
            r.string(),
            r.double(),
            r.int32_t(),
            r.int32_t(),
            r.double(),
            tuple(r.double() for _ in range(8)),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.string(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.int32_t(),
            r.int32_t(),
            r.int32_t(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.string(),
            r.string(),
            r.double(),
            r.double(),
            r.int32_t(),
            r.double(),
            r.int32_t(),
            r.double(),
            r.int32_t(),
            r.int32_t(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.int32_t(),
            r.int32_t(),
            r.double(),
            r.double(),
            r.string(),
            r.string(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.string(),
        )
        r.end()
        return m


@dataclass(frozen=True)
class Event:
    """event_t"""

    utime: int = 0
    machine: str = ""
    kind: str = ""
    job: str = ""
    outcome: str = ""
    place_mm: float = 0.0
    text: str = ""

    def encode(self) -> Bytes:
        return (EVENT
                + put.int64_t(self.utime)
                + put.string(self.machine)
                + put.string(self.kind)
                + put.string(self.job)
                + put.string(self.outcome)
                + put.double(self.place_mm)
                + put.string(self.text))

    @staticmethod
    def decode(data: Bytes) -> Event:
        r = Reader(data, EVENT)
        m = Event(
            r.int64_t(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.double(),
            r.string(),
        )
        r.end()
        return m
