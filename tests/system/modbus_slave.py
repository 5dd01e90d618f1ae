# SPDX-License-Identifier: Apache-2.0
"""A generator as a Modbus slave, by PyPI's pymodbus, with moods of its own.

Holding registers, by the addresses of the requests: 10 peak current in 0.1 A,
11 on time in 0.1 us, 12 off time in 0.1 us, 13 open-circuit voltage, 14 bit 0
negative electrode, bit 1 iso pulse, bit 8 pump, 15 servo voltage in 0.1 V.  Input registers 30, 31: peak
current and on time as they are; 40, 41 good pulses, the high half first; 42, 43 arcs,
the low one first; 44, 45 energy in mJ; 46 its own fault.
"""

import asyncio
import contextlib
import os
import threading
import time
import tty

from pymodbus import FramerType
from pymodbus.datastore import (
    ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext,
)
from pymodbus.pdu import ExceptionResponse
from pymodbus.server import ModbusSerialServer, ModbusTcpServer

FIRST, LAST = 10, 15
LAYOUT = """
peak_a = register 10 scale 0.1
on_us = register 11 scale 0.1
off_us = register 12 scale 0.1
ignition_v = register 13
polarity = register 14 bit 0
iso = register 14 bit 1
pump = register 14 bit 8
servo_v = register 15 scale 0.1
"""
SUMS = """
told_sparks = input 40 bits 32
told_arcs = input 42 bits 32 first low
told_energy_j = input 44 bits 32 scale 0.001
told_fault = input 46
fault_words = 1 no water, 2 too warm
"""


class Slave:
    """It runs in a thread of its own until the with block ends."""

    def __init__(self, pty=False):
        self.lies = {}          # address: value that it tells instead
        self.refuses = {}       # address: exception code of a write
        self.late_s = 0         # before each answer
        self.silent = False
        self.mangle = None      # what becomes of the bytes of an answer
        self.writes = []        # (time, function, address, values)
        self.reads = 0
        self.asks = []          # when each request came; None: another link
        self.ready = threading.Event()
        self.block = ModbusSequentialDataBlock(0, [0] * 100)
        self.pty = pty
        self.where = None

    # -- What pymodbus asks

    def _connect(self, there):
        self.asks.append(None)

    def _pdu(self, sending, pdu):
        if not sending:
            self.asked = pdu
            self.asks.append(time.monotonic_ns())
            if pdu.function_code in (6, 16):
                values = list(pdu.registers)
                self.writes.append((time.monotonic(), pdu.function_code,
                                    pdu.address, values))
            elif pdu.function_code in (3, 4):
                self.reads += 1
            return pdu
        q = self.asked
        if q.function_code in (6, 16):
            for a in range(q.address, q.address + len(q.registers)):
                if a in self.refuses:
                    e = ExceptionResponse(q.function_code, self.refuses[a])
                    e.transaction_id, e.dev_id = pdu.transaction_id, pdu.dev_id
                    return e
        elif q.function_code in (3, 4) and hasattr(pdu, "registers"):
            for a, value in self.lies.items():
                if q.address <= a < q.address + len(pdu.registers):
                    pdu.registers[a - q.address] = value
        return pdu

    def _packet(self, sending, data):
        if not sending:
            return data
        if self.late_s:
            time.sleep(self.late_s)
        if self.silent:
            return b""
        return self.mangle(data) if self.mangle else data

    # -- Its registers

    def get(self, address):
        """Of what was written; the context counts from 1."""
        return self.block.getValues(address + 1, 1)[0]

    def count(self, sparks, arcs, mj, fault=0):
        self.block.setValues(41, [
            sparks >> 16, sparks & 0xffff, arcs & 0xffff, arcs >> 16,
            mj >> 16, mj & 0xffff, fault])

    def reset(self):
        """As after a loss of power."""
        self.block.setValues(1, [0] * 98)

    # -- Its life

    async def _serve(self):
        self.loop = asyncio.get_running_loop()
        context = ModbusServerContext(slaves=ModbusSlaveContext(
            hr=self.block, ir=self.block), single=True)
        more = {"trace_pdu": self._pdu, "trace_packet": self._packet,
                "trace_connect": self._connect}
        if self.pty:
            self.server = ModbusSerialServer(
                context, framer=FramerType.RTU, port=self.far, baudrate=19200,
                **more)
        else:
            self.server = ModbusTcpServer(
                context, address=("127.0.0.1", self.port), **more)
        task = asyncio.create_task(self.server.serve_forever())
        while not self.server.transport:
            await asyncio.sleep(0.01)
        self.ready.set()
        with contextlib.suppress(asyncio.CancelledError):
            await task

    def __enter__(self):
        if self.pty:
            self._join_ptys()
        else:
            self.port = 5020
            self.where = f"127.0.0.1:{self.port}"
        self.start()
        return self

    def start(self):
        self.ready.clear()
        self.thread = threading.Thread(
            target=lambda: asyncio.run(self._serve()), daemon=True)
        self.thread.start()
        assert self.ready.wait(30)

    def stop(self):
        asyncio.run_coroutine_threadsafe(
            self.server.shutdown(), self.loop).result(30)
        self.thread.join(30)

    def unplug(self):
        """The port of edmd goes, as that of a USB adapter does."""
        self.stop()
        for fd in self.slaves + self.masters:
            with contextlib.suppress(OSError):
                os.close(fd)

    def plug(self):
        """It comes back, under the name that udev gives it."""
        link = self.where
        self._join_ptys()
        os.unlink(link)
        os.symlink(self.where, link)
        self.where = link
        self.start()

    def _join_ptys(self):
        """Two pseudo terminals back to back are a serial line."""
        self.masters, names = [], []
        for _ in range(2):
            master, slave = os.openpty()
            tty.setraw(slave)
            self.masters.append(master)
            names.append((slave, os.ttyname(slave)))
        self.slaves = [n[0] for n in names]
        self.where, self.far = names[0][1], names[1][1]
        a, b = self.masters
        for one, other in ((a, b), (b, a)):
            threading.Thread(target=self._carry, args=(one, other),
                             daemon=True).start()

    @staticmethod
    def _carry(one, other):
        with contextlib.suppress(OSError):
            while data := os.read(one, 256):
                os.write(other, data)

    def __exit__(self, *what):
        with contextlib.suppress(Exception):
            self.stop()
