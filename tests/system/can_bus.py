# SPDX-License-Identifier: Apache-2.0
"""A CAN bus where the kernel has none, and the PLC of a machine on it.

Programs reach it with can_socket.c preloaded.  It carries frames; how a bus fails
is for tests/vm.
"""

import contextlib
import os
import pathlib
import select
import socket
import struct
import subprocess
import threading
import time

import rig

HERE = pathlib.Path(__file__).parent
FRAME = struct.Struct("=IB3x8s")
NODE = 32
SYNC = 0x80
ALIVE, HOLD, PERMIT = 0x80, 4, 1
LOCKS = 0x1f
REQUEST = struct.Struct("<BBHHBB")

# Two drives: X and Y.  The section goes on behind it.
DRIVEN = """
[machine]
name = {name}
backend = can402
period_us = 20000
overrun_limit = 0
cpu = -1

[can402]
interface = can0
node_X = 1
node_Y = 2
sdo_ms = 5000
enable_s = 600
"""


def wants(filters, can_id):
    return any(can_id & mask == value & mask for value, mask in filters or ())


class Bus:
    """Hands each frame to all others that want it, until the with block ends."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.shim = self.folder / "can_socket.so"
        subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(self.shim),
                        str(HERE / "can_socket.c")], check=True)
        self.door = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.door.bind(str(self.folder / "can"))
        self.door.listen()
        self.hears = {}         # end: [(id, mask)], or None before it is said
        self.paced, self.owe = None, set()      # who sends SYNC, waits for whom
        self.ended, self.loops = False, []
        self.loop(self._carry, 0)

    def env(self):
        return {"LD_PRELOAD": rig.preload(self.shim),
                "EDM_CAN": str(self.folder / "can")}

    @contextlib.contextmanager
    def program(self, *words):
        """Another one on the bus; it is there when it has said so."""
        n = len(self.hears)
        with open(self.folder / "program.log", "ab") as log, subprocess.Popen(
                [str(w) for w in words], env=os.environ | self.env(),
                stdout=log, stderr=log) as p:
            try:
                rig.until(lambda: len(self.hears) > n, 20)
                yield p
            finally:
                p.kill()

    def loop(self, turn, pause_s=0.02):
        """In a thread of its own until the bus ends."""
        def go():
            while not self.ended:
                turn()
                time.sleep(pause_s)
        self.loops.append(threading.Thread(target=go))
        self.loops[-1].start()

    def _carry(self):
        ready, _, _ = select.select([self.door, *self.hears], [], [], 0.2)
        for end in ready:
            if end is self.door:
                self.hears[self.door.accept()[0]] = None
                continue
            try:
                data = end.recv(512)
            except ConnectionResetError:
                data = b""
            if not data:
                self.hears.pop(end)
                self._has_read(end)
            elif data == b"pace":
                self.paced, self.hears[end], self.owe = end, (), {end}
                self._has_read(end)
            elif self.hears[end] is None:
                self.hears[end] = list(struct.iter_unpack("=II", data))
            elif data == b"read":
                self._has_read(end)
            else:
                self._carry_one(data, end)

    def _carry_one(self, data, end):
        if FRAME.unpack(data)[0] == SYNC:
            self.owe = {e for e in self.hears if e is not end and
                        wants(self.hears[e], SYNC)} | {end}
        self.send(data, end)
        if FRAME.unpack(data)[0] == SYNC:
            self._has_read(end)

    def _has_read(self, end):
        """All that came, or it is gone; when all have, the next SYNC may come."""
        if end not in self.owe:
            return
        self.owe.remove(end)
        if not self.owe:
            with contextlib.suppress(OSError):
                self.paced.send(b"!", socket.MSG_DONTWAIT)

    def tell(self, can_id, data):
        self.send(FRAME.pack(can_id, len(data), data.ljust(8, b"\0")))

    def send(self, data, who=None):
        can_id = FRAME.unpack(data)[0]
        for other, filters in list(self.hears.items()):
            if other is not who and wants(filters, can_id):
                with contextlib.suppress(OSError):      # it is gone, or full
                    other.send(data, socket.MSG_DONTWAIT)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ended = True
        for loop in self.loops:
            loop.join()
        for end in (self.door, *self.hears):
            end.close()


class Plc:
    """Permits; holds and does M codes as it is told."""

    def __init__(self, bus):
        self.bus = bus
        self.bits, self.done = PERMIT, 0
        bus.tell(0, bytes((1, NODE)))
        bus.loop(self.ask)

    def ask(self):
        self.bits ^= ALIVE
        self.bus.tell(0x200 + NODE, REQUEST.pack(
            self.bits, LOCKS, 1000, 0, self.done, 0))

    def hold(self, on):
        self.bits = self.bits & ~HOLD | HOLD * on
