# SPDX-License-Identifier: Apache-2.0
"""Drives of CiA 402 that judge their master, on one CAN interface.

    unruly.py INTERFACE FIFO TRAITS

Written from CiA 301 and 402 alone.  A drive refuses what these let it refuse,
loses all settings when it loses power, and counts from 0 then.  It knows where
its axis truly is, and writes down what no master may do: the list "crimes".

TRAITS is JSON, a dict for each node: "absolute", "slow" (s for an SDO answer),
"shows" (SYNCs until 6061 shows a new mode; "enabled": only then), "enables" (s
from switched on to operation enabled), "wanders" (increments the axis moves by
itself while it is enabled for the first time), "twice" (each SDO is answered
twice), "stray" (PDOs of its own that it sends unless they are switched off),
"task" (its state machine runs once in so many SYNCs), "busy" (it aborts so many
SDOs after each boot), "boots" (boot-up messages), "falls" (it has no brake),
"at" (where it stands at first).

Orders come by the FIFO, a line each: see ORDERS.
"""
import heapq
import json
import os
import select
import socket
import struct
import sys
import time

NOT_READY, DISABLED, READY, ON, ENABLED, STOPPING, REACTING, FAULT = range(8)
NAMES = ("not-ready", "disabled", "ready", "on", "enabled", "stopping",
         "reacting", "fault")
WORDS = (0x0000, 0x0250, 0x0231, 0x0233, 0x0237, 0x0217, 0x021f, 0x0218)
PREOP, OPERATIONAL, STOPPED = 127, 5, 4

MISSING, SUBINDEX, LENGTH, RANGE = 0x06020000, 0x06090011, 0x06070010, 0x06090030
READ_ONLY, STATE, MAPPING, TOO_MUCH = (0x06010002, 0x08000022, 0x06040041,
                                       0x06040042)
COMMAND = 0x05040001
CSP = 8
GENERATOR = 0x3f1
WARNS = {"set": 0x80}
AT_LIMIT = {"set": 0x800}
SEEN_LATE = (AT_LIMIT, {"mute": 1})
LEAP = 60_000       # increments in a period that no machine here may ask for


class Abort(Exception):
    pass


class Drive:
    def __init__(self, bus, node, traits):
        self.bus, self.node, self.traits = bus, node, traits
        # Where the axis is, increments.
        self.true = traits.get("at", 1000 * node)
        self.powered, self.known, self.allowed = False, False, False
        self.jammed, self.trap, self.lies = False, None, {}
        self.wall, self.beyond = None, 0    # what it does not pass, and how far
                                            # behind that a target was
        self.homing = False             # the operator homes this or another
        self.wandered = False
        self.runs = 0                   # boots so far: answers of old ones fall
        if not traits.get("off"):
            self.power_on()

    # -- Power ---------------------------------------------------------------

    def power_on(self):
        if self.powered:
            return
        self.powered, self.nmt = True, PREOP
        self.runs += 1
        self.state, self.mode, self.shown = NOT_READY, 0, 0
        self.origin = 0 if self.traits.get("absolute") else self.true
        self.word = self.latched = self.target = None
        self.edge_seen = False
        self.sdos = self.syncs = self.ticks = 0
        self.busy = self.traits.get("busy", 0)
        self.beat_at = self.master_at = None
        self.error = 0
        self.since, self.ready_at = self.bus.now, self.bus.now + 1e9
        self.od = self.objects()
        self.bus.later(0.15, self.boot, self)

    def boot(self):
        for _ in range(self.traits.get("boots", 1)):
            self.bus.send(0x700 + self.node, b"\0")
        self.ready_at = self.bus.now + 0.1

    def power_off(self):
        self.powered = False
        self.runs += 1
        self.wandered = self.homing = False
        if not self.traits.get("absolute"):
            self.known = False

    def spring(self, what):
        """Loses power where a trap was set, for as long as that says."""
        if self.trap and self.trap[0] == what and self.powered:
            gone = self.trap[1]
            self.trap = None
            self.bus.note(f"node {self.node}: power lost at {what}")
            self.power_off()
            self.bus.later(gone, self.power_on)
            return True
        return False

    # -- Object dictionary ---------------------------------------------------

    def objects(self):
        """Index and sub-index: size, access, value, least, most."""
        n = self.node
        od = {(0x1000, 0): [4, "ro", 0x00020192, 0, 0],
              (0x1001, 0): [1, "ro", 0, 0, 0],
              (0x1005, 0): [4, "rw", 0x80, 0, 0xffffffff],
              (0x1006, 0): [4, "rw", 0, 0, 100000],
              (0x1007, 0): [4, "rw", 0, 0, 0xffffffff],
              (0x1016, 0): [1, "ro", 1, 0, 0],
              (0x1016, 1): [4, "rw", 0, 0, 0x007fffff],
              (0x1017, 0): [2, "rw", 0, 0, 65535],
              (0x1018, 0): [1, "ro", 4, 0, 0],
              (0x1019, 0): [1, "rw", 0, 0, 240],
              (0x6040, 0): [2, "rw", 0, 0, 65535],
              (0x6041, 0): [2, "ro", 0, 0, 0],
              (0x6060, 0): [1, "rw", 0, 0, 255],
              (0x6061, 0): [1, "ro", 0, 0, 0],
              (0x6064, 0): [4, "ro", 0, 0, 0],
              (0x607a, 0): [4, "rw", 0, 0, 0xffffffff],
              (0x6502, 0): [4, "ro", 0xa5, 0, 0],
              (0x605a, 0): [2, "rw", 2, 0, 6],
              (0x6007, 0): [2, "rw", 1, 0, 3],
              (0x605e, 0): [2, "rw", 2, 0, 2],
              (0x6065, 0): [4, "rw", 4000, 0, 0xffffffff],
              (0x6085, 0): [4, "rw", 100000, 1, 0xffffffff],
              (0x60c2, 0): [1, "ro", 2, 0, 0],
              (0x60c2, 1): [1, "rw", 1, 1, 255],
              (0x60c2, 2): [1, "ro", 0xfd, 0, 0]}
        for i, value in enumerate((0xabc, 0x100 + n, 3, 0x5000 + n)):
            od[0x1018, 1 + i] = [4, "ro", value, 0, 0]
        for i in range(2):
            ids = 0x100 * i
            od[0x1400 + i, 1] = [4, "cob", 0x40000200 + ids + n, 0, 0]
            od[0x1400 + i, 2] = [1, "type", 255, 0, 255]
            od[0x1800 + i, 1] = [4, "cob", 0x40000180 + ids + n, 0, 0]
            od[0x1800 + i, 2] = [1, "type", 255, 0, 255]
            for base, entry in (0x1600, 0x60400010), (0x1a00, 0x60410010):
                od[base + i, 0] = [1, "count", 1, 0, 8]
                for k in range(1, 9):
                    od[base + i, k] = [4, "map", entry if k == 1 else 0, 0, 0]
        return od

    def value(self, index, sub=0):
        return self.od[index, sub][2]

    def pdo_of(self, index):
        """The communication object of a mapping or of itself."""
        return index - 0x200 if index & 0xff00 in (0x1600, 0x1a00) else index

    def valid(self, index):
        return not self.value(self.pdo_of(index), 1) >> 31

    def store(self, key, size, new):
        if key not in self.od:
            raise Abort(SUBINDEX if any(k[0] == key[0] for k in self.od)
                        else MISSING)
        entry = self.od[key]
        if entry[0] != size:
            raise Abort(LENGTH)
        if entry[1] == "ro":
            raise Abort(READ_ONLY)
        if entry[1] == "rw":
            if not entry[3] <= new <= entry[4]:
                raise Abort(RANGE)
            self.check_value(key, new)
        else:
            self.check_pdo(key, entry, new)
        entry[2] = new

    def check_value(self, key, new):
        index, old = key[0], self.od[key][2]
        if index == 0x1005 and new & 0x7ff != 0x80:
            raise Abort(RANGE)
        if index == 0x1019 and (self.value(0x1006) != 0 or new == 1):
            raise Abort(STATE)
        if index == 0x6060:
            if new not in (1, 3, 6, 8):
                raise Abort(RANGE)
            self.syncs = 0
            self.mode = new
        if index == 0x605a and new not in (0, 1, 2, 5, 6):
            raise Abort(RANGE)
        if index == 0x60c2 and self.state == ENABLED and new != old:
            raise Abort(STATE)
        if index == 0x1016:
            self.master_at = None

    def check_pdo(self, key, entry, new):
        index, kind, old = key[0], entry[1], entry[2]
        if self.nmt != PREOP:
            raise Abort(STATE)
        if kind == "cob":
            # While it exists only its bit 31 may change; no 29 bits; bit 30
            # is the drive's.
            if (new ^ old) & 0x40000000 or new & 0x20000000:
                raise Abort(RANGE)
            if not old >> 31 and (new ^ old) & 0x7fffffff:
                raise Abort(RANGE)
            return
        if self.valid(index):
            raise Abort(STATE)
        if kind == "type" and 241 <= new <= 251:
            raise Abort(RANGE)
        if kind == "map":
            if self.value(index, 0) != 0:
                raise Abort(STATE)
            of = self.od.get((new >> 16, new >> 8 & 0xff))
            rx = index < 0x1a00
            if not of or of[0] * 8 != new & 0xff or \
                    (of[1] != "rw") == rx or new >> 16 < 0x6000:
                raise Abort(MAPPING)
        if kind == "count":
            bits = sum(self.value(index, k) & 0xff for k in range(1, new + 1))
            if bits > 64:
                raise Abort(TOO_MUCH)

    # -- SDO -----------------------------------------------------------------

    def hear_sdo(self, data):
        self.sdos += 1
        if self.spring(f"sdo {self.sdos}") or self.nmt == STOPPED or \
                self.state == NOT_READY and self.bus.now < self.since + 0.15:
            return
        command, index, sub = struct.unpack_from("<BHB", data)
        if self.busy > 0:
            self.busy -= 1
            self.bus.send(0x580 + self.node, struct.pack(
                "<BHBI", 0x80, index, sub, STATE))
            return
        try:
            if command == 0x40:
                answer = self.upload(index, sub)
            elif command & 0xf3 == 0x23:
                size = 4 - (command >> 2 & 3)
                new = int.from_bytes(data[4:4 + size], "little")
                self.store((index, sub), size, new)
                answer = struct.pack("<BHB4x", 0x60, index, sub)
            elif command == 0x80:
                return
            else:
                raise Abort(COMMAND)
        except Abort as e:
            self.bus.aborts.append((self.node, f"{index:04x}:{sub}",
                                    f"{e.args[0]:08x}"))
            answer = struct.pack("<BHBI", 0x80, index, sub, e.args[0])
        for _ in range(2 if self.traits.get("twice") else 1):
            self.bus.later(self.traits.get("slow", 0.001),
                           lambda: self.bus.send(0x580 + self.node, answer),
                           self)

    def upload(self, index, sub):
        if (index, sub) not in self.od:
            raise Abort(MISSING)
        size, _, value, _, _ = self.od[index, sub]
        value = {0x6041: self.statusword, 0x6061: lambda: self.shown,
                 0x6064: self.count}.get(index, lambda: value)()
        return struct.pack("<BHB", 0x43 | (4 - size) << 2, index, sub) + \
            (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")

    # -- NMT -----------------------------------------------------------------

    def hear_nmt(self, command):
        if command == 1:
            if self.spring("start"):
                return
            self.judge_setup()
            self.nmt = OPERATIONAL
        elif command in (2, 0x80):      # nobody leads it any more
            self.nmt = STOPPED if command == 2 else PREOP
            self.word = self.latched = None
            if self.state in (READY, ON, ENABLED, STOPPING):
                self.enter(DISABLED)
        elif command == 0x81:
            self.power_off()
            self.power_on()
        elif command == 0x82:           # its settings go, its count stays
            self.od = self.objects()
            self.nmt, self.mode = PREOP, 0
            self.word = self.latched = None
            if self.state in (ENABLED, ON, READY, STOPPING):
                self.state = DISABLED
            self.bus.later(0.05, lambda: self.bus.send(0x700 + self.node, b"\0"),
                           self)

    def judge_setup(self):
        """Started without a setting that its safety or its place needs."""
        v, n = self.value, self.node
        wrong = [what for what, bad in (
            ("no heartbeat", v(0x1017) == 0),
            ("does not watch its master", v(0x1016, 1) >> 16 == 0),
            ("RPDO1", v(0x1400, 1) != 0x40000200 + n or v(0x1400, 2) != 1),
            ("TPDO1", v(0x1800, 1) != 0x40000180 + n or v(0x1800, 2) != 1),
            ("RPDO1 mapping", [v(0x1600, k) for k in range(3)] !=
             [2, 0x60400010, 0x607a0020]),
            ("TPDO1 mapping", [v(0x1a00, k) for k in range(4)] !=
             [3, 0x60410010, 0x60640020, 0x60610008]),
            ("other PDOs", not (v(0x1401, 1) >> 31 and v(0x1801, 1) >> 31)),
            ("mode", v(0x6060) != CSP), ("period", v(0x60c2, 1) != 10),
            ("connection lost", v(0x6007) in (0, 1)),
            ("SYNC counter", v(0x1019) != 0)) if bad]
        if wrong and not self.bus.foreign_start:
            self.crime("was started without: " + ", ".join(wrong))

    # -- State machine -------------------------------------------------------

    def crime(self, what):
        if len(self.bus.crimes) < 40:
            self.bus.crimes.append((self.bus.now, f"node {self.node} {what}"))

    def enter(self, state):
        if state == self.state:
            return
        self.state, self.since, self.syncs = state, self.bus.now, 0
        self.spring(NAMES[state])

    def trip(self, code):
        self.error = code
        if self.state not in (REACTING, FAULT):
            self.bus.send(0x080 + self.node, struct.pack("<HB5x", code, 1))
            self.enter(REACTING)

    def wanted(self):
        """The next state by the controlword, one transition at a time."""
        w, s = self.word, self.state
        if w is None:
            return s
        if s in (READY, ON, ENABLED, STOPPING) and not w & 2:
            return DISABLED
        if s == ENABLED and not w & 4:
            return STOPPING
        if s in (READY, ON) and not w & 4:
            return DISABLED
        table = {DISABLED: {0x06: READY}, READY: {0x07: ON},
                 ON: {0x06: READY, 0x0f: ENABLED},
                 ENABLED: {0x07: ON, 0x06: READY},
                 STOPPING: {0x0f: ENABLED} if self.value(0x605a) >= 5 else {}}
        return table.get(s, {}).get(w & 0x8f, s)

    def step(self):
        now = self.bus.now
        if self.state == REACTING:
            if now > self.since + 0.03:
                self.enter(FAULT)
            return
        if self.state == FAULT:
            high = bool(self.word is not None and self.word & 0x80)
            if high and not self.edge_seen and now > self.since + 0.05 and \
                    not self.lies.get("stuck"):
                self.error = 0
                self.enter(DISABLED)
            self.edge_seen = high
            return
        if self.state == STOPPING and self.value(0x605a) < 5 and \
                now > self.since + 0.05:
            self.enter(DISABLED)
            return
        to = self.wanted()
        if self.traits.get("falls") and self.state in (ENABLED, STOPPING) and \
                to not in (ENABLED, STOPPING):
            self.crime("was let fall")
        if to == ENABLED and self.state == ON:
            if now < self.since + self.traits.get("enables", 0.03):
                return
            self.judge_enable()
        self.enter(to)

    def judge_enable(self):
        if not self.known and not self.homing:
            self.crime("was enabled, and nobody knows its place")
        if not self.allowed:
            self.crime("was enabled, and nobody gave a start")
        if self.target is None:
            self.crime("was enabled without a target")
        elif abs(self.target - self.count()) > 2:
            self.crime(f"was enabled {self.target - self.count()} off")
        if not self.wandered:
            self.true += self.traits.get("wanders", 0)
            self.wandered = True

    # -- SYNC ----------------------------------------------------------------

    def count(self):
        return wrap(self.true - self.origin)

    def follows(self):
        return self.state == ENABLED and self.mode == CSP and self.syncs > 2 \
            and self.value(0x6060) == CSP

    def statusword(self):
        w = self.lies.get("word", WORDS[self.state])
        if "word" not in self.lies and self.follows():
            w |= 0x1000
        return (w | self.lies.get("set", 0)) & ~self.lies.get("clear", 0)

    def show_mode(self):
        late = self.traits.get("shows", 0)
        if late == "enabled":
            self.shown = self.mode if self.state == ENABLED else 0
        elif self.syncs >= late:
            self.shown = self.mode
        return self.lies.get("mode", self.shown)

    def hear_rpdo(self, data):
        if self.nmt != OPERATIONAL or not self.valid(0x1400):
            return
        if len(data) != 6:
            self.trip(0x8210)
            return
        self.latched = struct.unpack("<Hi", data)

    def sync(self):
        if self.nmt != OPERATIONAL:
            return
        if self.spring("operational"):
            return
        self.syncs += 1
        if self.latched:
            self.word, target = self.latched
            self.move(target)
        self.ticks += 1
        if self.ticks % self.traits.get("task", 1) == 0:
            self.step()
        if self.powered and self.valid(0x1800):
            self.bus.send(self.value(0x1800, 1) & 0x7ff,
                          struct.pack("<HiB", self.statusword(), self.count(),
                                      self.show_mode() & 0xff))
        if self.follows() and self.syncs > 20:
            self.spring("following")

    def stopped(self, to):
        if self.wall is None:
            return to
        self.beyond = max(self.beyond, to - self.wall)
        return min(to, self.wall)

    def move(self, target):
        if self.follows() and self.target is not None:
            way = wrap(target - self.target)
            if abs(way) > LEAP:
                self.crime(f"had a target {way} from the one before")
            if way and not self.known:
                self.crime("was moved, and nobody knows its place")
            if not self.jammed:
                self.true = self.stopped(self.true +
                                         wrap(target - self.count()))
        self.target = target

    # -- Time ----------------------------------------------------------------

    def look(self):
        """Heartbeats, both ways; PDOs that it sends by itself."""
        now, ms = self.bus.now, self.value(0x1017)
        if self.state == NOT_READY and now > self.ready_at:
            self.enter(DISABLED)
        if not self.powered:            # a trap has sprung
            return
        if ms and (self.beat_at is None or now >= self.beat_at):
            self.beat_at = now + ms / 1000
            if not self.lies.get("mute"):
                self.bus.send(0x700 + self.node, bytes([self.nmt]))
        limit = self.value(0x1016, 1) & 0xffff
        if limit and self.master_at and now > self.master_at + limit / 1000:
            self.master_at = None
            if self.nmt == OPERATIONAL and self.state in (ENABLED, ON, READY):
                self.trip(0x8130)
        if self.traits.get("stray") and self.nmt == OPERATIONAL and \
                self.valid(0x1801):
            self.bus.send(0x280 + self.node, struct.pack("<H", 0x237))

    def hear_master(self, node):
        if self.value(0x1016, 1) >> 16 == node:
            self.master_at = self.bus.now


def wrap(x):
    return (x + (1 << 31)) % (1 << 32) - (1 << 31)


class Bus:
    def __init__(self, interface, traits):
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW,
                                    socket.CAN_RAW)
        self.socket.bind((interface,))
        self.now = time.monotonic()
        self.due, self.number = [], 0
        self.crimes, self.aborts, self.notes, self.rows = [], [], [], []
        self.sparks, self.bad_sparks = 0, 0
        self.gap = None
        self.foreign_start = False
        self.drives = [Drive(self, int(n), t) for n, t in traits.items()]

    def send(self, can_id, data):
        try:
            self.socket.send(struct.pack("=IB3x8s", can_id, len(data),
                                         data.ljust(8, b"\0")))
        except OSError:
            pass                        # as a cable that is out

    def later(self, seconds, what, drive=None):
        """Of @drive: not if it has lost its power meanwhile."""
        self.number += 1
        heapq.heappush(self.due, (self.now + seconds, self.number, what, drive,
                                  drive and drive.runs))

    def note(self, what):
        self.notes.append((self.now, what))

    def powered(self):
        return [d for d in self.drives if d.powered]

    def hear(self, can_id, data):
        if can_id & 0xe0000000:
            return
        if can_id == 0x80:
            self.sync()
        elif can_id == 0 and len(data) == 2:
            for d in self.powered():
                if data[1] in (0, d.node):
                    d.hear_nmt(data[0])
        elif can_id == GENERATOR and len(data) == 8:
            self.judge_sparks(data[0] & 1)
        elif can_id >> 7 == 0xe and len(data) == 1:
            for d in self.powered():
                d.hear_master(can_id & 0x7f)
        for d in self.powered():
            if can_id == 0x600 + d.node and len(data) == 8:
                d.hear_sdo(data)
            elif can_id == 0x200 + d.node:
                d.hear_rpdo(data)

    def judge_sparks(self, on):
        """A loss may be seen with the second SYNC behind it; a heartbeat that
        is missing after 0.25 s, and bit 11 may stand for 0.1 s.  A drive that
        goes along with its target, with bit 11, is not clipped."""
        self.sparks = on
        ill = [d for d in self.drives
               if not (d.powered and d.follows() and d.known and
                       (d.lies in ({}, WARNS) or
                        d.lies == AT_LIMIT and not d.jammed))]
        slowly = all(d.lies in SEEN_LATE for d in ill)
        self.bad_sparks = self.bad_sparks + 1 if on and ill else 0
        if self.bad_sparks == (30 if slowly else 5):
            self.crimes.append((self.now, "sparks where not all drives follow"))

    def sync(self):
        for d in self.powered():
            d.sync()
        if self.gap is not None:
            # One that never changes is a sensor that is stuck.
            self.send(0x3f0, struct.pack("<H", self.gap + len(self.rows) % 50))
        self.rows.append((self.now, self.sparks,
                          [(NAMES[d.state] if d.powered else "off", d.true)
                           for d in self.drives]))

    def turn(self, fifo):
        left = self.due[0][0] - time.monotonic() if self.due else 0.02
        ready, _, _ = select.select([self.socket, fifo], [], [],
                                    max(0, min(left, 0.02)))
        self.now = time.monotonic()
        if self.socket in ready:
            can_id, size, data = struct.unpack("=IB3x8s", self.socket.recv(16))
            self.hear(can_id, data[:size])
        while self.due and self.due[0][0] <= self.now:
            _, _, what, drive, run = heapq.heappop(self.due)
            if drive is None or drive.runs == run:
                what()
        for d in self.powered():
            d.look()
        return fifo in ready


ORDERS = {
    "on": lambda d: d.power_on(),
    "off": lambda d: d.power_off(),
    "cycle": lambda d: (d.power_off(), d.power_on()),
    "trap": lambda d, seconds, *what: setattr(
        d, "trap", (" ".join(what), float(seconds))),
    "known": lambda d, yes="1": setattr(d, "known", yes == "1"),
    "homing": lambda d: setattr(d, "homing", True),
    "allow": lambda d, yes="1": setattr(d, "allowed", yes == "1"),
    "trip": lambda d, code: d.trip(int(code, 16)),
    "quick": lambda d: d.state == ENABLED and d.enter(STOPPING),
    "leave": lambda d: d.state == ENABLED and d.enter(DISABLED),
    "jam": lambda d, yes="1": setattr(d, "jammed", yes == "1"),
    "wall": lambda d, ahead: setattr(d, "wall", d.true + int(ahead)),
    "clear": lambda d: setattr(d, "beyond", 0),
    "open": lambda d: setattr(d, "wall", None),
    "push": lambda d, by: setattr(d, "true", d.true + int(by)),
    "lie": lambda d, what, value: d.lies.__setitem__(what, int(value, 16)),
    "truth": lambda d: d.lies.clear(),
    "forget": lambda d: setattr(d, "trap", None),
}


def order(bus, line):
    """False: the end."""
    verb, *args = line.split()
    if verb == "quit":
        return False
    if verb == "gap":
        bus.gap = int(float(args[0]) * 100)
    elif verb == "foreign-start":
        bus.foreign_start = args[0] == "1"
    elif verb == "stands":      # short: a long one costs answers to SYNC
        with open(args[0] + ".new", "w") as f:
            json.dump([[d.true, d.beyond] for d in bus.drives], f)
        os.rename(args[0] + ".new", args[0])
    elif verb == "report":
        report = {"rows": bus.rows, "crimes": bus.crimes,
                  "aborts": bus.aborts, "notes": bus.notes,
                  "traps": [d.trap for d in bus.drives]}
        with open(args[0] + ".new", "w") as f:
            json.dump(report, f)
        os.rename(args[0] + ".new", args[0])
    else:
        for d in bus.drives:
            if int(args[0]) in (0, d.node):
                ORDERS[verb](d, *args[1:])
    return True


def main(interface, fifo, traits):
    bus = Bus(interface, json.loads(traits))
    fd = os.open(fifo, os.O_RDWR | os.O_NONBLOCK)
    text = ""
    while True:
        if not bus.turn(fd):
            continue
        text += os.read(fd, 65536).decode()
        *lines, text = text.split("\n")
        if not all([order(bus, line) for line in lines if line]):
            return


if __name__ == "__main__":
    main(*sys.argv[1:4])
