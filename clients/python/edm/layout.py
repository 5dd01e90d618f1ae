# SPDX-License-Identifier: Apache-2.0
"""How LCM lays out the fields of a message, and what a signature is over."""

from __future__ import annotations

import struct


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

    def boolean(self) -> bool:
        return self.take(1) != b"\0"

    def int32_t(self) -> int:
        return int.from_bytes(self.take(4), "big", signed=True)

    def int64_t(self) -> int:
        return int.from_bytes(self.take(8), "big", signed=True)

    def double(self) -> float:
        return float(struct.unpack(">d", self.take(8))[0])

    def string(self) -> str:
        return self.take(self.int32_t())[:-1].decode("utf-8", "replace")

    def end(self) -> None:
        if self.at != len(self.data):
            raise ValueError("a message with something behind it")


def boolean(x: bool) -> bytes:
    return struct.pack(">?", x)


def int32_t(x: int) -> bytes:
    return struct.pack(">i", x)


def int64_t(x: int) -> bytes:
    return struct.pack(">q", x)


def double(x: float) -> bytes:
    return struct.pack(">d", x)


def string(text: str) -> bytes:
    """Its length with its NUL, and both."""
    data = text.encode() + b"\0"
    return int32_t(len(data)) + data


def exactly(n: int, data: bytes) -> bytes:
    if len(data) != n:
        raise ValueError(f"{len(data)} bytes; {n}")
    return data


def to_be_signed(channel: str, boot: int, count: int, data: bytes) -> bytes:
    """What a signature is over."""
    return (b"edmd 1\n" + channel.encode() + b"\n"
            + struct.pack(">qq", boot, count) + data)
