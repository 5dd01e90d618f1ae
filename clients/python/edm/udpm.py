# SPDX-License-Identifier: Apache-2.0
"""LCM's short packets, by sockets of our own: what is longer nobody sends, and
LCM's reader of long ones ends the process over some that nobody signed."""

from __future__ import annotations

import re
import socket
import struct

MAGIC = b"LC02"
IP_MULTICAST_ALL = 49               # Linux: only groups that this socket joined
BUFFER = 4 << 20
PACKET = 65536


def join(channel: str, data: bytes) -> bytes:
    """A packet."""
    return MAGIC + bytes(4) + channel.encode() + b"\0" + data


def split(packet: bytes) -> tuple[str, bytes] | None:
    """Its channel and data."""
    end = packet.find(b"\0", 8)
    if packet[:4] != MAGIC or end < 0:
        return None
    return packet[8:end].decode("ascii", "replace"), packet[end + 1:]


def _read(url: str) -> tuple[str, int, int]:
    """Group, port and ttl of an URL."""
    m = re.fullmatch(r"udpm://([0-9.]+):(\d+)(?:\?ttl=(\d+))?", url)
    if not m:
        raise ValueError(f"URL {url}: udpm://GROUP:PORT?ttl=N is wanted")
    return m[1], int(m[2]), int(m[3] or 0)


class Udpm:
    """A group: publish to it, take what comes."""

    def __init__(self, url: str) -> None:
        group, port, ttl = _read(url)
        self._to = (group, port)
        self._out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        self._in = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._in.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._in.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
        self._in.setsockopt(socket.IPPROTO_IP, IP_MULTICAST_ALL, 0)
        self._in.bind(self._to)
        self._in.setsockopt(
            socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
            struct.pack("=4sI", socket.inet_aton(group), socket.INADDR_ANY))
        self._in.setblocking(False)

    def close(self) -> None:
        self._in.close()
        self._out.close()

    def fileno(self) -> int:
        return self._in.fileno()

    def publish(self, channel: str, data: bytes) -> None:
        self._out.sendto(join(channel, data), self._to)

    def take(self) -> tuple[str, bytes] | None:
        """The channel and data of a packet that waits."""
        return split(self._in.recv(PACKET))
