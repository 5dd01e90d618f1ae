# SPDX-License-Identifier: Apache-2.0
"""CiA 402 drives on one CAN interface, each a canopen LocalNode.

drives.py INTERFACE COMMANDS [--every S] NODE...

Object dictionary, SDO, NMT, heartbeat and EMCY are canopen's, and what the
PDOs carry is read by it from what the master wrote.  Here are the state machine
of CiA 402, a motor, and the watch on SYNC and on the master's heartbeat.

With --every, a SYNC comes every S by definition, and there is no other clock: on a
bus that waits for its drives they miss nothing, however busy the host is.

COMMANDS is a FIFO with a line for each thing to do or to go wrong:
    emcy N CODE | brake N PERIODS | clear N | leave N | mute N | unmute N | skip N K |
    drop N K | jam N | unjam N | push N BY | lag N GAIN | reboot N | gap V |
    report FILE | quit
A report has a row for each SYNC: its time, the generator's flags, and of each
drive its state and its place.  It also has what came between the rows: each line
of COMMANDS, NMT, and the PLC's request where it is another than before, with its
time and the number of rows before it.
"""
import errno
import json
import math
import os
import select
import socket
import struct
import sys
import time

import canopen
from canopen.objectdictionary import (
    INTEGER16, INTEGER32, INTEGER8, ODRecord, ODVariable, ObjectDictionary, UNSIGNED8,
    UNSIGNED16, UNSIGNED32)

GAP_ID, GENERATOR_ID, PLC_ID = 0x3f0, 0x3f1, 0x220
ALIVE = 0x80                    # of the PLC's commands: turns with each request

NOT_READY, DISABLED, READY, SWITCHED_ON, ENABLED, STOPPING, REACTING, FAULT = (
    "not-ready", "disabled", "ready", "switched-on", "enabled", "stopping",
    "reacting", "fault")

STATUS = {NOT_READY: 0x0200, DISABLED: 0x0250, READY: 0x0231,
          SWITCHED_ON: 0x0233, ENABLED: 0x1237, STOPPING: 0x0217,
          REACTING: 0x021f, FAULT: 0x0218}

FRAME = struct.Struct("=IB3x8s")
COMMAND = struct.Struct("<Hi")
ANSWER = struct.Struct("<HiB")

SHUTDOWN, SWITCH_ON, ENABLE, OFF, QUICK = range(5)


def command_of(control):
    """What the bits of a controlword ask for."""
    if not control & 0x02:
        return OFF
    if not control & 0x04:
        return QUICK
    return {0x6: SHUTDOWN, 0xe: SHUTDOWN, 0x7: SWITCH_ON,
            0xf: ENABLE}[control & 0xf]


# As CiA 402 has it: (state, command) -> state.
MOVES = {
    (DISABLED, SHUTDOWN): READY,
    (READY, SWITCH_ON): SWITCHED_ON, (READY, ENABLE): SWITCHED_ON,
    (READY, OFF): DISABLED, (READY, QUICK): DISABLED,
    (SWITCHED_ON, ENABLE): ENABLED, (SWITCHED_ON, SHUTDOWN): READY,
    (SWITCHED_ON, OFF): DISABLED, (SWITCHED_ON, QUICK): DISABLED,
    (ENABLED, SWITCH_ON): SWITCHED_ON, (ENABLED, SHUTDOWN): READY,
    (ENABLED, OFF): DISABLED, (ENABLED, QUICK): STOPPING,
    (STOPPING, OFF): DISABLED,
}


def dictionary():
    od = ObjectDictionary()

    def variable(index, sub, kind, value, name, access="rw"):
        v = ODVariable(name, index, sub)
        v.data_type, v.access_type, v.default = kind, access, value
        return v

    def record(index, name, *kinds):
        r = ODRecord(name, index)
        r.add_member(variable(index, 0, UNSIGNED8, len(kinds), "count"))
        for sub, (kind, value) in enumerate(kinds, 1):
            r.add_member(variable(index, sub, kind, value, f"{name}{sub}"))
        od.add_object(r)

    u8, u16, u32 = UNSIGNED8, UNSIGNED16, UNSIGNED32
    for index, kind, value, name, access in (
            (0x1000, u32, 0x00020192, "device type", "ro"),
            (0x1001, u8, 0, "error register", "ro"),
            (0x1017, u16, 0, "producer heartbeat", "rw"),
            (0x6007, INTEGER16, 1, "abort connection option", "rw"),
            (0x603f, u16, 0, "error code", "ro"),
            (0x6040, u16, 0, "controlword", "rw"),
            (0x6041, u16, 0, "statusword", "ro"),
            (0x605a, u16, 2, "quick stop option", "rw"),
            (0x6060, INTEGER8, 0, "mode", "rw"),
            (0x6061, INTEGER8, 0, "mode shown", "ro"),
            (0x6064, INTEGER32, 0, "position actual", "ro"),
            (0x607a, INTEGER32, 0, "target position", "rw"),
            (0x6502, u32, 0x80, "supported modes", "ro")):
        od.add_object(variable(index, 0, kind, value, name, access))
    record(0x1016, "consumer heartbeat", (u32, 0))
    record(0x1018, "identity", (u32, 0x1234), (u32, 1))
    record(0x60c2, "interpolation time", (u8, 1), (INTEGER8, -3))
    for i in range(2):
        # As from a box: other mappings, by event, all switched on.
        record(0x1400 + i, "rpdo", (u32, 0x200 + 0x100 * i), (u8, 255))
        record(0x1600 + i, "rpdo map", (u32, 0x60600008), *[(u32, 0)] * 3)
        record(0x1800 + i, "tpdo", (u32, 0x180 + 0x100 * i), (u8, 255))
        record(0x1a00 + i, "tpdo map", (u32, 0x60410010), *[(u32, 0)] * 3)
    return od


class Clock:
    """Of this host, or made of SYNCs."""

    def __init__(self):
        self.every, self.syncs = 0, 0

    def __call__(self):
        return self.syncs * self.every if self.every else time.monotonic()


clock = Clock()


class Task:
    def __init__(self, net, can_id, data, period):
        self.net, self.id, self.data = net, can_id, bytes(data)
        self.period, self.due = period, clock() + period

    def stop(self):
        if self in self.net.tasks:
            self.net.tasks.remove(self)

    def update(self, data):
        self.data = bytes(data)


class Network(canopen.Network):
    """On a raw socket, without threads."""

    def __init__(self, interface):
        super().__init__()
        self.tasks = []
        self.sock = socket.socket(socket.PF_CAN, socket.SOCK_RAW,
                                  socket.CAN_RAW)
        self.sock.setblocking(False)
        self.sock.bind((interface,))

    def send_message(self, can_id, data, remote=False):
        data = bytes(data)
        try:
            self.sock.send(FRAME.pack(can_id, len(data), data.ljust(8, b"\0")))
        except OSError as e:
            if e.errno not in (errno.ENETDOWN, errno.ENOBUFS):
                raise

    def send_periodic(self, can_id, data, period, remote=False):
        task = Task(self, can_id, data, period)
        self.tasks.append(task)
        return task

    def beat(self, now):
        for task in self.tasks:
            if now >= task.due:
                task.due += task.period
                self.send_message(task.id, task.data)

    def read(self):
        for _ in range(100):
            try:
                frame = self.sock.recv(16)
            except BlockingIOError:
                return
            except OSError:         # the interface is down
                return
            can_id, size, data = FRAME.unpack(frame)
            if can_id < 0x800:
                self.notify(can_id, bytearray(data[:size]), 0.0)


class Drive:
    def __init__(self, net, node):
        self.net = net
        self.node = net.create_node(node, dictionary())
        self.id = node
        self.muted = False
        self.brake = 5                      # periods until it is released
        self.place = 1000 * node            # increments
        self.lag_1_s = 0                    # its position gain; 0: at once
        self.node.add_write_callback(self.on_write)
        net.subscribe(0, self.on_nmt)
        self.boot()

    def boot(self):
        self.state, self.control, self.target = DISABLED, 0, self.place
        self.taken = 0                      # controlword, with the last SYNC
        self.fault, self.jammed, self.step = 0, False, 0
        self.skip = self.drop = self.enabling = 0
        self.running = False
        self.tpdo_id = 0
        self.master_s, self.master_heard = 0, None
        self.node.data_store.clear()
        self.node.nmt.stop_heartbeat()
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    # -- what the master set

    def on_nmt(self, can_id, data, timestamp):
        running = self.node.nmt.state == "OPERATIONAL"
        if running and not self.running:
            self.read_mapping()
        if self.running and not running:
            self.lose_master()
        self.running = running

    def read_mapping(self):
        node = self.node
        node.rpdo.read()
        node.tpdo.read()
        taken = [m for m in node.rpdo.values() if m.enabled]
        sent = [m for m in node.tpdo.values() if m.enabled]
        assert [[v.index for v in m] for m in taken] == [[0x6040, 0x607a]]
        assert [[v.index for v in m] for m in sent] == [[0x6041, 0x6064, 0x6061]]
        assert taken[0].trans_type == sent[0].trans_type == 1
        assert node.sdo[0x6060].raw == 8
        self.net.unsubscribe(taken[0].cob_id)
        self.net.subscribe(taken[0].cob_id, self.on_rpdo)
        self.tpdo_id = sent[0].cob_id
        self.period = (node.sdo[0x60c2][1].raw *
                       10.0 ** node.sdo[0x60c2][2].raw)

    def on_write(self, index, subindex, od, data):
        if (index, subindex) == (0x1016, 1):
            word = struct.unpack("<I", data)[0]
            self.master_s = (word & 0xffff) / 1000
            self.master_heard = None
            self.net.subscribe(0x700 + (word >> 16), self.on_master)

    def on_master(self, can_id, data, timestamp):
        self.master_heard = clock()

    def on_rpdo(self, can_id, data, timestamp):
        if self.drop > 0:
            self.drop -= 1
        elif self.running and len(data) == COMMAND.size:
            self.control, self.target = COMMAND.unpack(data)

    def lose_master(self):
        """Abort connection, by object 6007."""
        if self.node.sdo[0x6007].raw == 3:
            self.state = STOPPING if self.state == ENABLED else self.state
        else:
            self.fail(0x8130)

    # -- a period

    def sync(self):
        if self.running and self.skip == 0:
            self.net.send_message(self.tpdo_id, ANSWER.pack(
                STATUS[self.state], self.place, 8))
        self.skip = max(0, self.skip - 1)
        self.obey()
        self.move()

    def obey(self):
        rises = self.control & ~self.taken
        self.taken = self.control
        if self.state == FAULT:
            if rises & 0x80:
                self.fault = 0
                self.state = DISABLED
                self.node.emcy.reset()
            return
        to = MOVES.get((self.state, command_of(self.control)))
        if to == ENABLED:
            # As if a brake had to be released.
            self.enabling += 1
            if self.enabling < self.brake:
                return
        self.enabling = 0
        self.state = to or self.state

    def move(self):
        if self.state == ENABLED and not self.jammed:
            self.step = self.target - self.place
            if self.lag_1_s:
                self.step = round(self.step * -math.expm1(
                    -self.lag_1_s * self.period))
        elif self.state in (STOPPING, REACTING):
            self.step = int(self.step / 2)
            if self.step == 0:
                self.state = FAULT if self.state == REACTING else DISABLED
        else:
            self.step = 0
        self.place += self.step

    def fail(self, code):
        if self.state in (FAULT, REACTING):
            return
        self.state = REACTING if self.state in (ENABLED, STOPPING) else FAULT
        self.fault = code
        self.node.emcy.send(code, 1)

    def watch(self, now, synced):
        if self.state == ENABLED and now - synced > 5 * self.period:
            self.fail(0x8700)
        if (self.master_s and self.master_heard and
                now - self.master_heard > self.master_s):
            self.master_heard = None
            self.node.emcy.send(0x8130, 0x11)
            self.lose_master()


class Stage:
    """All drives, the gap and the generator."""

    def __init__(self, interface, commands, nodes):
        self.net = Network(interface)
        self.drives = {n: Drive(self.net, n) for n in nodes}
        self.fifo = os.open(commands, os.O_RDWR | os.O_NONBLOCK)
        self.rows, self.flags, self.synced = [], 0, 0.0
        self.came, self.asked = [], None
        self.gap_v, self.noise = 0, 0
        self.rest = b""
        self.net.subscribe(0x80, self.on_sync)
        self.net.subscribe(GENERATOR_ID, self.on_generator)
        self.net.subscribe(0, self.on_nmt)
        self.net.subscribe(PLC_ID, self.on_request)

    def on_sync(self, can_id, data, timestamp):
        clock.syncs += 1
        self.synced = clock()
        for d in self.drives.values():
            d.sync()
        self.noise = (self.noise * 5 + 3) % 16
        if self.gap_v:
            self.net.send_message(GAP_ID, struct.pack(
                "<H", int(self.gap_v * 100) + self.noise))
        self.rows.append((self.synced, self.flags,
                          [(d.state, d.place) for d in self.drives.values()]))

    def on_generator(self, can_id, data, timestamp):
        self.flags = data[0]

    def comes(self, what):
        self.came.append((clock(), len(self.rows), what))

    def on_nmt(self, can_id, data, timestamp):
        self.comes(f"nmt {data.hex()}")

    def on_request(self, can_id, data, timestamp):
        asked = data[0] & ~ALIVE
        if asked != self.asked:
            self.comes(f"request {asked}")
        self.asked = asked

    def obey(self, words):
        what, args = words[0], words[1:]
        self.comes(" ".join(words))
        d = self.drives.get(int(args[0])) if len(args) > 0 and \
            what not in ("gap", "report") else None
        if what == "emcy":
            d.fail(int(args[1], 16))
        elif what == "brake":
            d.brake = int(args[1])
        elif what == "leave":
            d.state = DISABLED
        elif what in ("mute", "unmute"):
            d.node.nmt.stop_heartbeat()
            if what == "unmute":
                d.node.nmt.start_heartbeat(d.node.sdo[0x1017].raw)
        elif what in ("skip", "drop"):
            setattr(d, what, int(args[1]))
        elif what in ("jam", "unjam"):
            d.jammed = what == "jam"
        elif what == "push":
            d.place += int(args[1])
        elif what == "lag":
            d.lag_1_s = float(args[1])
        elif what == "reboot":
            d.boot()
        elif what == "gap":
            self.gap_v = float(args[0])
        elif what == "report":
            with open(args[0] + ".new", "w") as f:
                json.dump({"nodes": list(self.drives), "rows": self.rows,
                           "came": self.came}, f)
            os.rename(args[0] + ".new", args[0])
            self.rows, self.came = [], []
        elif what == "quit":
            sys.exit(0)

    def commands(self):
        try:
            self.rest += os.read(self.fifo, 4096)
        except BlockingIOError:
            return
        *lines, self.rest = self.rest.split(b"\n")
        for line in lines:
            self.obey(line.decode().split())

    def run(self):
        while True:
            ready, _, _ = select.select([self.net.sock, self.fifo], [], [],
                                        0.02)
            now = clock()
            if self.net.sock in ready:
                self.net.read()
            self.net.beat(now)
            for d in self.drives.values():
                d.watch(now, self.synced)
            if self.fifo in ready:
                self.commands()


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[2] == "--every":
        clock.every = float(words.pop(3))
        del words[2]
    Stage(*words[:2], [int(n) for n in words[2:]]).run()
