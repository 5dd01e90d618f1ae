# SPDX-License-Identifier: Apache-2.0
"""The messages of edm.lcm, and the signed envelope around them.

A message is its fields in order, big-endian, as LCM lays them out, after eight
bytes that stand for its type.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

SIGNED = bytes.fromhex("49657b54b950317d")
COMMAND = bytes.fromhex("633b130fba8a2ccf")
ACK = bytes.fromhex("e7a36102b59e523d")
JOB_CHUNK = bytes.fromhex("9e1f02d601e2f309")
STATUS = bytes.fromhex("d6afeb84f882f7aa")
EVENT = bytes.fromhex("15ff8b6c83f6aeb8")


class Reader:
    """Takes fields off the front of a message."""

    def __init__(self, data: bytes, kind: bytes) -> None:
        if data[:8] != kind:
            raise ValueError("a message of another type")
        self.data, self.at = data, 8

    def take(self, n: int) -> bytes:
        if n < 0 or self.at + n > len(self.data):
            raise ValueError("a message that is cut short")
        self.at += n
        return self.data[self.at - n:self.at]

    def int32(self) -> int:
        return int.from_bytes(self.take(4), "big", signed=True)

    def int64(self) -> int:
        return int.from_bytes(self.take(8), "big", signed=True)

    def double(self) -> float:
        return float(struct.unpack(">d", self.take(8))[0])

    def string(self) -> str:
        return self.take(self.int32())[:-1].decode("utf-8", "replace")


def string(text: str) -> bytes:
    """A string as LCM lays it out: its length with its NUL, and both."""
    data = text.encode() + b"\0"
    return struct.pack(">i", len(data)) + data


@dataclass(frozen=True)
class Signed:
    """The envelope."""

    key: bytes
    boot: int
    count: int
    signature: bytes
    data: bytes

    def encode(self) -> bytes:
        return (SIGNED + self.key + struct.pack(">qq", self.boot, self.count)
                + self.signature + struct.pack(">i", len(self.data))
                + self.data)

    @staticmethod
    def decode(packet: bytes) -> Signed:
        r = Reader(packet, SIGNED)
        s = Signed(r.take(32), r.int64(), r.int64(), r.take(64),
                   r.take(r.int32()))
        if r.at != len(packet):
            raise ValueError("a message with something behind it")
        return s


def to_be_signed(channel: str, boot: int, count: int, data: bytes) -> bytes:
    """What a signature is over."""
    return (b"edmd 1\n" + channel.encode() + b"\n"
            + struct.pack(">qq", boot, count) + data)


@dataclass(frozen=True)
class Ack:
    """What the service answers; codes as in messages/README.md."""

    key: bytes
    client: str
    seq: int
    code: int
    reason: str
    body: str

    @staticmethod
    def decode(data: bytes) -> Ack:
        r = Reader(data, ACK)
        r.int64()
        return Ack(r.take(32), r.string(), r.int64(), r.int32(), r.string(),
                   r.string())


@dataclass(frozen=True)
class Event:
    """Something that happened."""

    utime: int
    machine: str
    kind: str
    job: str
    outcome: str
    place_mm: float
    text: str

    @staticmethod
    def decode(data: bytes) -> Event:
        r = Reader(data, EVENT)
        return Event(r.int64(), r.string(), r.string(), r.string(),
                     r.string(), r.double(), r.string())


@dataclass(frozen=True)
class Status:
    """How the machine is.  Units are in the names; pos_mm is X Y Z A B C U V,
    degrees for rotary axes."""

    utime: int
    machine: str
    daemon: str
    state: str
    fault: str
    faults: str
    job: str
    job_name: str
    job_state: str
    line: int
    lines: int
    place_mm: float
    length_mm: float
    progress: float
    pos_mm: tuple[float, ...]
    gap_v: float
    feed_mm_s: float
    depth_mm: float
    contour_mm: float
    contour_predicted_mm: float
    jumps: int
    retracts: int
    shorts: int
    job_s: float
    eta_s: float
    queue_len: int
    overruns: int
    wake_late_max_us: int
    condition: str
    store: str
    interrupted: str
    lost: str
    hunts: int
    electrode: int
    electrode_shift_mm: float
    electrode_wear_mm: float

    @staticmethod
    def decode(data: bytes) -> Status:
        r = Reader(data, STATUS)
        return Status(
            r.int64(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.int32(),
            r.int32(),
            r.double(),
            r.double(),
            r.double(),
            tuple(r.double() for _ in range(8)),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.double(),
            r.int32(),
            r.int32(),
            r.int32(),
            r.double(),
            r.double(),
            r.int32(),
            r.int32(),
            r.int32(),
            r.string(),
            r.string(),
            r.string(),
            r.string(),
            r.int32(),
            r.int32(),
            r.double(),
            r.double(),
        )


def command(client: str, seq: int, verb: str, job: str = "",
            arg: float = 0.0, text: str = "", utime: int = 0) -> bytes:
    """A COMMAND."""
    return (COMMAND + struct.pack(">q", utime) + string(client)
            + struct.pack(">q", seq) + string(verb) + string(job)
            + struct.pack(">d", arg) + string(text))


@dataclass(frozen=True)
class Chunk:
    """A piece of a job's text."""

    job: str
    name: str
    size: int
    sha256: bytes
    chunk: int
    chunks: int
    offset: int
    hold: bool
    data: bytes
    from_line: int = 0
    from_mm: float = 0.0
    electrode: int = 0

    def encode(self, client: str, seq: int, utime: int = 0) -> bytes:
        return (JOB_CHUNK + struct.pack(">q", utime) + string(client)
                + struct.pack(">q", seq) + string(self.job)
                + string(self.name) + struct.pack(">q", self.size)
                + self.sha256
                + struct.pack(">iiqbidii", self.chunk, self.chunks,
                              self.offset, self.hold, self.from_line,
                              self.from_mm, self.electrode,
                              len(self.data)) + self.data)
