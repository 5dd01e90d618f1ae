# SPDX-License-Identifier: Apache-2.0
"""Acts that end motion go to edmd itself, too: on the machine's own host it
takes them without edmd-jobs (daemon/words/stop_act.h)."""

from __future__ import annotations

import hashlib
import socket
import struct
import time
from pathlib import Path

from .way import connect

MAGIC = 0x65737470
VERBS = ("hold", "stop", "estop")
FOLDER = Path("/run/edmd")
AGAIN_S = 0.01                  # between two tries
ALONE_S = 0.5                   # then what edmd itself has done is told


def act_id(key: bytes, client: str, seq: int) -> int:
    """The number by which it is done once, whichever way it comes."""
    text = key + struct.pack("=q", seq) + client.encode()
    digest = hashlib.blake2b(text, digest_size=16).digest()
    return struct.unpack("=Q", digest[:8])[0] & (2 ** 63 - 1) or 1


class Stop:
    """One act, given to edmd, again and again until edmd has taken it."""

    def __init__(self, machine: str, verb: str, number: int) -> None:
        self._name = f"edmd.{machine}.stop"
        self._act = struct.pack("=IIQ", MAGIC, VERBS.index(verb), number)
        self._begun = time.monotonic()
        self._code: int | None = None
        self._socket: socket.socket | None = None
        self._give()

    def _give(self) -> None:
        self._tried = time.monotonic()
        self._socket = connect(FOLDER, "edmd", self._name)
        if self._socket:
            try:
                self._socket.send(self._act)
            except OSError:
                self.close()

    def close(self) -> None:
        if self._socket:
            self._socket.close()
        self._socket = None

    def _turn(self) -> None:
        if self._code is not None:
            return
        if not self._socket:
            if time.monotonic() > self._tried + AGAIN_S:
                self._give()
            return
        try:
            answer = self._socket.recv(16)
        except BlockingIOError:
            return
        except OSError:
            answer = b""
        self.close()
        if len(answer) == 16:
            self._code = struct.unpack("=IiQ", answer)[1]

    def is_done(self) -> bool:
        """Has edmd done it, and edmd-jobs had time to say so?"""
        self._turn()
        return self._code == 0 and time.monotonic() > self._begun + ALONE_S
