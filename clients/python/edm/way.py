# SPDX-License-Identifier: Apache-2.0
"""How packets go: on the machine's own host by the socket of edmd-jobs, which
needs no network; else by multicast."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import stat
import struct
import time
from pathlib import Path

from .keys import is_trusted
from .udpm import PACKET, Udpm, join, split

URL = os.environ.get("LCM_DEFAULT_URL") or "udpm://239.255.76.67:7667?ttl=0"
AGAIN_S = 0.1
BUFFER = 4 << 20
# As common/places.h: anybody may make a file in the second.
FOLDER, ANYBODY = Path("/run/edmd-jobs"), Path("/dev/shm")


def _place(folder: Path, service: str) -> Path:
    try:
        about = os.lstat(folder)
    except OSError:
        return ANYBODY
    is_ours = (stat.S_ISDIR(about.st_mode) and not about.st_mode & 0o022
               and is_trusted(about.st_uid, service))
    return folder if is_ours else ANYBODY


def connect(folder: Path, service: str, name: str) -> socket.socket | None:
    """To the socket of a service, if that, root or this user listens."""
    s = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    s.setblocking(False)
    with contextlib.suppress(OSError):
        s.connect(str(_place(folder, service) / name))
        peer = s.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
        if is_trusted(struct.unpack("=iII", peer)[1], service):
            s.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
            return s
    s.close()
    return None


def _connect(machine: str) -> socket.socket | None:
    return connect(FOLDER, "edm-jobs", f"edmd.{machine}.jobs")


class Way:
    """To a machine: publish to it, take what comes.

    url: None: by the socket; or else by multicast at URL.
    """

    def __init__(self, machine: str, url: str | None) -> None:
        self._machine, self._may_be_here = machine, url is None
        self._local = _connect(machine) if self._may_be_here else None
        self._net = None if self._local else self._join(url)
        self._tried = time.monotonic()

    def _join(self, url: str | None) -> Udpm:
        try:
            return Udpm(url or URL)
        except OSError as e:
            raise OSError(e.errno, (
                f"no edmd-jobs of machine {self._machine} on this host, and "
                f"none can be asked by multicast: {e.strerror}")) from None

    def close(self) -> None:
        for end in (self._local, self._net):
            if end:
                end.close()
        self._local = self._net = None

    def publish(self, channel: str, data: bytes) -> None:
        if self._local:
            # It may be full, or its other end may be gone.
            with contextlib.suppress(OSError):
                self._local.send(join(channel, data))
        elif self._net:
            self._net.publish(channel, data)

    def _look(self) -> None:
        """The service may have been started anew."""
        if self._local or not self._may_be_here or \
                time.monotonic() - self._tried < AGAIN_S:
            return
        self._tried = time.monotonic()
        self._local = _connect(self._machine)
        if self._local and self._net:
            self._net.close()
            self._net = None

    def waits(self, seconds: float = 0) -> bool:
        """Is there a packet, or does one come in time?"""
        self._look()
        if not self._local and not self._net:
            time.sleep(min(seconds, AGAIN_S))
            return False
        end = self._local or self._net
        return bool(select.select([end], [], [], seconds)[0])

    def take(self, seconds: float) -> tuple[str, bytes] | None:
        """The next packet's channel and data, if one comes in time."""
        if not self.waits(seconds):
            return None
        if self._net:
            return self._net.take()
        assert self._local
        try:
            packet = self._local.recv(PACKET)
        except ConnectionError:
            packet = b""
        if packet:
            return split(packet)
        self._local.close()
        self._local = None
        return None
