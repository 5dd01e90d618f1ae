# SPDX-License-Identifier: Apache-2.0
"""Drives that refuse whatever CiA 301 and 402 let a drive refuse.

strict.py INTERFACE COMMANDS TRAITS

Written from the standards, on a bare socket: no code of the daemon, none of
drives.py, no CANopen package.  TRAITS is JSON, node -> what is particular:
    slow       {"60c2:1": 0.7}: so long until that request is answered
    without    ["6061", ...]: objects it does not have
    unmappable ["6061"]: they are there, but in no PDO
    fixed_ids  its PDOs keep their identifiers
    not_ready  seconds after power-on in which its place reads 0
    mode_lag   seconds until 6061 shows what was written to 6060
    identity   [vendor, product, revision, serial]
    absolute   its count survives a power cycle
    refuse     {"605a:0": code}: that write is answered so
    most       {"60c2:1": 8}: a larger value is out of range
    off        it has no power at first
    inputs     {"2": -3000, "1": [3000]}: bit 2 of 60FD is 1 where its axis truly is
               at -3000 or below, bit 1 at 3000 or above; {"16": 1}: it is 1
    no6        6502 says mode 6, and 6060 refuses it
    ip         mode 7 in place of mode 8, without a buffer
    probe      a touch probe 1, with index marks each {"every": increments}, as wide
               as "width" and the first from "from" on; it looks at 60B8 each "task"
               s; "keeps": the first time it is switched on after a mark, it still
               has that one; "toggles": bit 6 is another with each mark
    home       it homes by itself in mode 6, with {"at": its true place; "stale":
               bit 12 is 1 from the beginning; "late": SYNCs until it begins;
               "leave": it counts anew only when it leaves the mode; "torque": it
               refuses another mode under torque; "no10": without bit 10}

COMMANDS is a FIFO, a line for each thing to do:
    input N BIT 0 or 1, whatever its axis does | loses N, finds N, its second TPDO |
    deaf N, it hears no SYNC | hears N | weak N, its supply breaks down | strong N |
    slow N OBJECT SECONDS | invert N BIT | off N | on N | push N INCREMENTS | mode N M | bits N SET CLEAR | emcy N CODE
    gap V LOUD: with more noise |
    fails N, its next homing; warn N CODE [MAKER], an emergency without a fault, MAKER 10 digits | jam N | unjam N |
    clip N, bit 11 and it stands | free N | gap V | nmt BYTE BYTE | report FILE | quit
where FILE leaves the true places alone.  A report has a row for each SYNC: its time, the generator's flags, and of each
drive its state, where the axis truly is, what the drive counts, and 6060.
"""
import json
import os
import select
import socket
import struct
import sys
import time

FRAME = struct.Struct("=IB3x8s")
GAP_ID, GENERATOR_ID = 0x3f0, 0x3f1

NO_OBJECT, NO_SUB = 0x06020000, 0x06090011
READ_ONLY, LENGTH = 0x06010002, 0x06070010
RANGE, NOT_NOW, UNMAPPABLE = 0x06090030, 0x08000022, 0x06040041
TOGETHER, COMMAND = 0x06040043, 0x05040001

NAME = b"strict drive"
SAVE, NOT_STORED = 0x65766173, 0x08000020

BOOTING, PREOP, OPERATIONAL, STOPPED = 0, 127, 5, 4


class Abort(Exception):
    pass


class Entry:
    def __init__(self, size, value=0, ro=False, low=0, high=None, values=None):
        self.size, self.value, self.ro = size, value, ro
        self.low = low
        self.high = (1 << 8 * size) - 1 if high is None else high
        self.values = values


def dictionary(node, traits):
    """As it comes from a box: mapped to other things, by event, switched on."""
    u8, u16, u32 = 1, 2, 4
    od = {
        (0x1000, 0): Entry(u32, 0x00020192, ro=True),
        (0x1001, 0): Entry(u8, 0, ro=True),
        (0x1005, 0): Entry(u32, 0x80),
        (0x1006, 0): Entry(u32, 0, high=1000000),
        (0x1007, 0): Entry(u32, 0, high=1000000),
        (0x1008, 0): Entry(u32, 0, ro=True),        # a name: see NAME
        (0x1010, 0): Entry(u8, 3, ro=True),
        (0x1010, 1): Entry(u32, 1), (0x1010, 2): Entry(u32, 1),
        (0x1010, 3): Entry(u32, 1),
        (0x607c, 0): Entry(u32, 7),
        (0x6098, 0): Entry(u8, 0, values=range(1, 38)),
        (0x6099, 0): Entry(u8, 2, ro=True),
        (0x6099, 1): Entry(u32, 1, low=1, high=10000000),
        (0x6099, 2): Entry(u32, 1, low=1, high=10000000),
        (0x609a, 0): Entry(u32, 1, low=1, high=1000000000),
        (0x607e, 0): Entry(u8, 0, values=(0, 0x80)),
        (0x1016, 0): Entry(u8, 1, ro=True), (0x1016, 1): Entry(u32, 0),
        (0x1017, 0): Entry(u16, 0),
        (0x1018, 0): Entry(u8, 4, ro=True),
        (0x1019, 0): Entry(u8, 10, high=240),
        (0x603f, 0): Entry(u16, 0, ro=True),
        (0x6040, 0): Entry(u16, 0), (0x6041, 0): Entry(u16, 0, ro=True),
        (0x605a, 0): Entry(u16, 2, values=(0, 1, 2, 5, 6)),
        (0x605e, 0): Entry(u16, 2, values=(0, 1, 2)),
        (0x6007, 0): Entry(u16, 1, values=(0, 1, 2, 3)),
        (0x6060, 0): Entry(u8, 1, values=(1, 3, 6, 8)),
        (0x6061, 0): Entry(u8, 1, ro=True),
        (0x6064, 0): Entry(u32, 0, ro=True),
        (0x6065, 0): Entry(u32, 2000, low=1, high=1000000),
        (0x607a, 0): Entry(u32, 0),
        (0x6085, 0): Entry(u32, 100000, low=1000, high=100000000),
        (0x60fd, 0): Entry(u32, 0, ro=True),
        (0x60b8, 0): Entry(u16, 0), (0x60b9, 0): Entry(u16, 0, ro=True),
        (0x60ba, 0): Entry(u32, 0, ro=True),
        (0x60c2, 0): Entry(u8, 2, ro=True),
        (0x60c2, 1): Entry(u8, 1, low=1, high=20),
        (0x60c2, 2): Entry(u8, 0xfd, ro=True),
        (0x6502, 0): Entry(u32, 0xa5, ro=True),
    }
    if traits.get("ip"):
        od |= {(0x60c0, 0): Entry(u16, 0, values=(0,)),
               (0x60c1, 0): Entry(u8, 1, ro=True),
               (0x60c1, 1): Entry(u32, 0),
               (0x6060, 0): Entry(u8, 1, values=(1, 3, 6, 7)),
               (0x6502, 0): Entry(u32, 0x65, ro=True)}
    identity = traits.get("identity", [0x1111, 0x2222, 1, node])
    for sub, value in enumerate(identity, 1):
        od[0x1018, sub] = Entry(u32, value, ro=True)
    for i in range(4):
        rpdo, tpdo = 0x200 + 0x100 * i + node, 0x180 + 0x100 * i + node
        # Bit 30 of one that receives means nothing, and must stay as it is.
        od |= {(0x1400 + i, 0): Entry(u8, 2, ro=True),
               (0x1400 + i, 1): Entry(u32, 0x40000000 | rpdo),
               (0x1400 + i, 2): Entry(u8, 255),
               (0x1800 + i, 0): Entry(u8, 5, ro=True),
               (0x1800 + i, 1): Entry(u32, 0x40000000 | tpdo),
               (0x1800 + i, 2): Entry(u8, 255)}
        for base, word in (0x1600, 0x60400010), (0x1a00, 0x60410010):
            od[base + i, 0] = Entry(u8, 1, high=8)
            for sub in range(1, 9):
                od[base + i, sub] = Entry(u32, word if sub == 1 else 0)
    for name, high in traits.get("most", {}).items():
        index, sub = name.split(":")
        od[int(index, 16), int(sub)].high = high
    if not traits.get("probe"):
        for index in 0x60b8, 0x60b9, 0x60ba:
            del od[index, 0]
    for name in traits.get("without", ()):
        for key in [k for k in od if k[0] == int(name, 16)]:
            del od[key]
    return od


class Drive:
    def __init__(self, bus, node, traits):
        self.bus, self.node, self.traits = bus, node, traits
        self.true = 1000 * node             # increments, of the axis itself
        self.count = self.true
        self.offset, self.times = 0, 0      # of the count; power-ons
        self.powered = False
        self.loses = self.deaf = self.weak = False
        self.state = "off"
        self.slow = []                      # (when, frame) of late answers
        self.forced, self.inverted = {}, 0  # inputs
        self.loses = self.deaf = self.weak = False
        self.nmt = BOOTING
        if not traits.get("off"):
            self.power_on()

    # -- power

    def power_off(self):
        self.powered, self.state, self.nmt = False, "off", BOOTING
        self.slow = []

    def power_on(self):
        now = time.monotonic()
        if self.times and not self.traits.get("absolute"):
            self.offset = self.true         # an incremental encoder begins at 0
        self.times += 1
        self.powered, self.nmt = True, BOOTING
        self.od = dictionary(self.node, self.traits)
        self.state = "not-ready"
        self.born, self.ready_at = now + 0.1, now + 0.1 + self.traits.get(
            "not_ready", 0)
        self.control = self.taken = 0
        self.target = self.sent = None
        self.mode, self.mode_at, self.before = 1, 0, 1
        self.force_set = self.force_clear = 0
        self.jammed, self.enabling, self.segments = False, 0, False
        self.attained = self.traits.get("home", {}).get("stale", False)
        self.homing, self.failed, self.fails = None, False, False
        self.was4, self.renumber, self.waits = False, False, 0
        self.beat_at = self.heard_master = self.synced = None
        self.step = 0
        self.probe = Probe(self, self.traits.get("probe"))

    def get(self, index, sub=0):
        """0 of what it does not have."""
        e = self.od.get((index, sub))
        return e.value if e else 0

    # -- SDO

    def upload(self, key):
        if key not in self.od:
            raise Abort(NO_SUB if any(k[0] == key[0] for k in self.od)
                        else NO_OBJECT)
        if key == (0x6061, 0):
            return 1, self.mode_shown()
        if key == (0x6041, 0):
            return 2, self.status()
        if key == (0x60fd, 0):
            return 4, self.inputs()
        if key == (0x6064, 0):
            return 4, self.count & 0xffffffff
        if key == (0x60b9, 0):
            return 2, self.probe.status
        if key == (0x60ba, 0):
            return 4, self.probe.read()
        return self.od[key].size, self.od[key].value

    def download(self, key, size, value):
        index, sub = key
        if key not in self.od:
            raise Abort(NO_SUB if any(k[0] == index for k in self.od)
                        else NO_OBJECT)
        e = self.od[key]
        code = self.traits.get("refuse", {}).get(f"{index:04x}:{sub}")
        if code:
            raise Abort(int(code, 16))
        if e.ro:
            raise Abort(READ_ONLY)
        if size != e.size:
            raise Abort(LENGTH)
        if not e.low <= value <= e.high or (e.values and
                                            value not in e.values):
            raise Abort(RANGE)
        self.check(index, sub, value)
        if index == 0x1010:             # reads as before: it saves on command
            self.bus.stored.append((self.node, sub))
            return
        if key == (0x607e, 0) and value != e.value:
            self.count = -self.count
            self.offset = self.true - self.count
        e.value = value
        if key == (0x6060, 0):
            if self.step:
                self.offence("another mode while it moves")
            if self.mode == 6 and value != 6 and self.renumber:
                self.count_anew()
            if value == 6 and self.control & 0x10:
                self.offence("bit 4 before mode 6")
            self.homing = None
            self.before = self.mode_shown()
            self.mode, self.mode_at = value, time.monotonic()
        if key == (0x1016, 1):
            self.heard_master = None

    def check(self, index, sub, value):
        now = self.od[index, sub].value
        if index == 0x60b8:
            self.probe.check(now, value)
        if 0x1400 <= index < 0x1600 or 0x1800 <= index < 0x1a00:
            valid = not self.od[index, 1].value >> 31
            if self.nmt == OPERATIONAL:
                raise Abort(NOT_NOW)
            if sub == 1:
                self.check_cob(value, now, valid)
            elif valid:
                raise Abort(NOT_NOW)
        elif 0x1600 <= index < 0x1800 or 0x1a00 <= index < 0x1c00:
            self.check_mapping(index, sub, value)
        elif index == 0x1010 and value != SAVE:
            raise Abort(NOT_STORED)
        elif index in (0x1010, 0x607e) and self.state == "enabled":
            raise Abort(NOT_NOW)
        elif index == 0x1016:
            other, ms = value >> 16, value & 0xffff
            if other > 127 or value >> 24 or (ms and not other):
                raise Abort(RANGE)
        elif index == 0x1019 and self.get(0x1006):
            raise Abort(NOT_NOW)
        elif index == 0x1019 and value == 1:
            raise Abort(RANGE)
        elif index == 0x1005 and value & 0x7ff != 0x80:
            raise Abort(RANGE)
        elif index == 0x6060 and value == 6 and self.traits.get("no6"):
            raise Abort(RANGE)              # whatever 6502 says
        elif index == 0x6060 and value != self.mode and \
                self.state == "enabled" and \
                self.traits.get("home", {}).get("torque"):
            raise Abort(NOT_NOW)
        elif index in (0x6098, 0x6099, 0x609a, 0x607c) and \
                self.state == "enabled":
            raise Abort(NOT_NOW)
        elif index in (0x60c2, 0x605a) and self.state == "enabled":
            raise Abort(NOT_NOW)

    def check_cob(self, value, now, valid):
        if value >> 29 & 1 or (value ^ now) >> 30 & 1:
            raise Abort(RANGE)              # 29 bits, or another bit 30
        if valid and (value ^ now) & 0x1fffffff:
            raise Abort(RANGE)              # not while it exists
        if not valid and not value >> 31 and (value ^ now) & 0x1fffffff:
            raise Abort(RANGE)              # first the identifier, then valid
        if self.traits.get("fixed_ids") and (value ^ now) & 0x1fffffff:
            raise Abort(RANGE)
        if value & 0x7ff < 0x181:
            raise Abort(RANGE)

    def check_mapping(self, index, sub, value):
        comm = index - 0x200
        if not self.od[comm, 1].value >> 31:
            raise Abort(NOT_NOW)
        if sub == 0:
            bits = sum(self.od[index, i].value & 0xff
                       for i in range(1, value + 1))
            if bits > 64:
                raise Abort(0x06040042)
            return
        if self.od[index, 0].value:
            raise Abort(NOT_NOW)
        mapped = self.od.get((value >> 16, value >> 8 & 0xff))
        if not mapped:
            raise Abort(UNMAPPABLE)
        if f"{value >> 16:04x}" in self.traits.get("unmappable", ()) or \
                value & 0xff != 8 * mapped.size:
            raise Abort(UNMAPPABLE)

    def on_sdo(self, data):
        what, (index, sub) = data[0] >> 5, struct.unpack_from("<HB", data, 1)
        if what == 4:
            self.segments = False
            return
        answer = bytearray(8)
        answer[1:4] = data[1:4]
        try:
            if self.segments:           # it waits for them, or for an abort
                raise Abort(COMMAND)
            if what == 2 and index == 0x1008:
                self.segments = True
                answer[0] = 0x41
                struct.pack_into("<I", answer, 4, len(NAME))
            elif what == 2:
                size, value = self.upload((index, sub))
                answer[0] = 0x43 | (4 - size) << 2
                struct.pack_into("<I", answer, 4, value)
            elif what == 1 and data[0] & 3 == 3:
                size = 4 - (data[0] >> 2 & 3)
                value = int.from_bytes(data[4:4 + size], "little")
                self.download((index, sub), size, value)
                answer[0] = 0x60
            else:
                raise Abort(COMMAND)
        except Abort as e:
            answer[0] = 0x80
            struct.pack_into("<I", answer, 4, e.args[0])
            self.bus.aborts.append((self.node, f"{index:04x}:{sub}",
                                    f"{e.args[0]:08x}"))
        late = self.traits.get("slow", {}).get(f"{index:04x}:{sub}", 0)
        self.slow.append((time.monotonic() + late, bytes(answer)))

    # -- PDO, NMT, SYNC

    def on_nmt(self, command, node):
        if node not in (0, self.node) or self.nmt == BOOTING:
            return
        was = self.nmt
        if command in (0x81, 0x82):
            self.power_off()
            self.power_on()
            return
        self.nmt = {1: OPERATIONAL, 2: STOPPED, 0x80: PREOP}.get(
            command, self.nmt)
        if was == OPERATIONAL and self.nmt != OPERATIONAL:
            self.lose_master()

    def on_rpdo(self, data):
        size = sum(self.get(0x1600, i) & 0xff
                   for i in range(1, self.get(0x1600) + 1)) // 8
        if self.nmt != OPERATIONAL or self.get(0x1400, 1) >> 31:
            return
        if len(data) < size:
            self.emergency(0x8210)
            return
        at = 0
        for i in range(1, self.get(0x1600) + 1):
            word = self.get(0x1600, i)
            n = (word & 0xff) // 8
            value = int.from_bytes(data[at:at + n], "little")
            at += n
            if word >> 16 == 0x6040:
                self.control = value
            elif word >> 16 == (0x60c1 if self.traits.get("ip") else 0x607a):
                self.target = value - (1 << 32) if value >> 31 else value

    def inputs(self):
        word = 0
        for bit, at in self.traits.get("inputs", {}).items():
            on = (self.true >= at[0] if isinstance(at, list) else
                  at if at in (0, 1) else self.true <= at)
            word |= self.forced.get(bit, on) << int(bit)
        return word ^ self.inverted

    def mode_shown(self):
        if time.monotonic() - self.mode_at < self.traits.get("mode_lag", 0):
            return self.before
        return self.mode

    def status(self):
        word = {"not-ready": 0x0200, "disabled": 0x0250, "ready": 0x0231,
                "on": 0x0233, "enabled": 0x0237, "stopping": 0x0217,
                "held": 0x0217, "reacting": 0x021f, "fault": 0x0218}[self.state]
        if self.state == "enabled" and (
                self.mode_shown() == 8 or self.interpolates()):
            word |= 0x1000
        if self.mode_shown() == 6:
            still = self.step == 0 and self.homing in (None, "done", "failed")
            word |= self.attained << 12 | self.failed << 13 | (
                still and not self.traits.get("home", {}).get("no10")) << 10
        return (word | self.force_set) & ~self.force_clear

    def on_sync(self, now):
        if self.deaf:
            return
        self.synced = now
        if self.nmt != OPERATIONAL:
            return
        for k in range(4):
            if self.get(0x1800 + k, 1) >> 31 or self.get(0x1800 + k, 2) != 1 \
                    or (k == 1 and self.loses):
                continue
            data = b""
            for i in range(1, self.get(0x1a00 + k) + 1):
                word = self.get(0x1a00 + k, i)
                n = (word & 0xff) // 8
                size, value = self.upload((word >> 16, word >> 8 & 0xff))
                data += value.to_bytes(4, "little")[:n]
            self.bus.send(self.get(0x1800 + k, 1) & 0x7ff, data)
        self.obey()
        self.move()

    def obey(self):
        control, rises = self.control, self.control & ~self.taken
        if control & 0x10 and self.mode_shown() not in (6, 7):
            self.offence("bit 4 without mode 6 or 7")
        if rises & 0x10 and self.mode_shown() == 7 and \
                self.target != self.count:
            self.offence("it is to follow a target that is elsewhere")
        self.taken = control
        s = self.state
        if s == "fault":
            if rises & 0x80:
                self.state = "disabled"
                self.emergency(0)
            return
        if s in ("not-ready", "reacting", "stopping"):
            return
        if control & 2 == 0:
            self.state = "disabled"
        elif control & 4 == 0:
            if s == "enabled":
                self.state = "stopping"
            elif s != "held":
                self.state = "disabled"
        elif control & 0xf == 6 or control & 0xf == 0xe:
            if s in ("disabled", "on", "enabled"):
                self.state = "ready"
        elif control & 0xf == 7:
            self.state = {"ready": "on", "enabled": "on"}.get(s, s)
        elif s == "on" and self.weak:
            self.fail(0x3220)
        elif s in ("on", "held"):
            self.enabling += 1
            if self.enabling > 3:
                self.state = "enabled"
            return
        self.enabling = 0

    def interpolates(self):
        return self.mode_shown() == 7 and self.taken & 0x10

    def offence(self, what):
        self.bus.offences.append((self.node, what))

    def count_anew(self):
        """Its count is the offset 607C where its home is."""
        method = self.get(0x6098)
        at = self.true if method in (35, 37) else self.traits["home"]["at"]
        self.offset = at - self.get(0x607c)
        self.count = self.true - self.offset
        self.renumber = False

    def home_found(self):
        self.attained, self.homing = True, "done"
        self.renumber = True
        if not self.traits["home"].get("leave"):
            self.count_anew()

    def home_step(self):
        """How far it goes until the next SYNC."""
        h = self.traits.get("home", {})
        four, halts = bool(self.control & 0x10), bool(self.control & 0x100)
        rises, self.was4 = four and not self.was4, four
        if rises:
            self.homing, self.waits = "begins", h.get("late", 0)
        if self.homing not in (None, "done", "failed") and (halts or not four):
            self.homing = "stops"
        here = self.get(0x6098) in (35, 37)
        to = 0 if here else h.get("at", 0) - self.true
        fast, slow = (max(1, self.get(0x6099, sub) // 100) for sub in (1, 2))
        if self.homing == "begins":
            self.waits -= 1
            if self.waits < 0:
                self.failed = self.fails
                self.homing = "failed" if self.fails else "fast"
                self.fails = False
                # One that moves nothing may be so fast that nobody sees it.
                self.attained = self.attained and here
                if here and not self.failed:
                    self.home_found()
        elif self.jammed:
            return 0
        elif self.homing == "fast":
            if abs(to) > fast:
                return fast if to > 0 else -fast
            self.homing = "back"
            return to + (200 if to > 0 else -200)
        elif self.homing == "back":
            if to == 0:
                self.home_found()
            return max(-slow, min(slow, to))
        elif self.homing == "stops":
            if int(self.step / 2) == 0:
                self.homing = None
            return int(self.step / 2)
        return 0

    def move(self):
        if self.state == "enabled" and self.mode_shown() == 6:
            self.step = self.home_step()
        elif self.state == "enabled" and (
                self.mode_shown() == 8 or self.interpolates()) and \
                not self.jammed and self.target is not None and \
                not self.force_clear & 0x1000:
            self.step = self.target - self.count
        elif self.state in ("stopping", "reacting"):
            self.step = int(self.step / 2)
            if self.step == 0:
                self.state = ("fault" if self.state == "reacting" else
                              "held" if self.get(0x605a) in (5, 6) else
                              "disabled")
        else:
            self.step = 0
        self.true += self.step
        self.count = self.true - self.offset
        self.probe.pass_by(self.true - self.step, self.true)

    def emergency(self, code):
        self.bus.send(0x80 + self.node, struct.pack("<HBxxxxx", code,
                                                    1 if code else 0))

    def fail(self, code):
        if self.state in ("fault", "reacting", "off"):
            return
        self.state = "reacting" if self.state in ("enabled", "stopping",
                                                  "held") else "fault"
        self.emergency(code)

    def lose_master(self):
        option = self.get(0x6007)
        if option == 1:
            self.fail(0x8130)
        elif self.state == "enabled" and option in (2, 3):
            self.state = "stopping" if option == 3 else "disabled"

    # -- time

    def live(self, now):
        if not self.powered or now < self.born:
            return
        if self.nmt == BOOTING:
            self.nmt = PREOP
            self.bus.send(0x700 + self.node, b"\0")
            self.beat_at = now
        if self.state == "not-ready":
            self.count = 0
            if now >= self.ready_at:
                self.state = "disabled"
                self.count = self.true - self.offset
        self.probe.look(now)
        while self.slow and self.slow[0][0] <= now:
            if self.nmt != STOPPED:
                self.bus.send(0x580 + self.node, self.slow[0][1])
            self.slow.pop(0)
        beat = self.get(0x1017) / 1000
        if beat and now >= self.beat_at:
            self.bus.send(0x700 + self.node, bytes([self.nmt]))
            self.beat_at = max(self.beat_at + beat, now)
        word = self.get(0x1016, 1)
        if self.heard_master and word & 0xffff and \
                now - self.heard_master > (word & 0xffff) / 1000:
            self.heard_master = None
            self.emergency(0x8130)
            self.lose_master()
        cycle = self.get(0x60c2, 1) * 1e-3
        if self.state == "enabled" and self.synced and \
                now - self.synced > 5 * cycle:
            self.fail(0x8700)

    def hear(self, can_id, data, now):
        if not self.powered or self.nmt == BOOTING:
            return
        if can_id == 0x600 + self.node and len(data) == 8:
            if self.nmt != STOPPED:
                self.on_sdo(data)
        elif can_id == self.get(0x1400, 1) & 0x7ff:
            self.on_rpdo(data)
        elif can_id == 0x700 + (self.get(0x1016, 1) >> 16 & 0x7f) and can_id != 0x700:
            self.heard_master = now


class Probe:
    """Touch probe 1.  What it says is that of a task of its own, which looks at
    60B8 now and then: a 0 that it did not see was none."""

    ON, FIRST_OF, MARK, RISING, FALLING = 1, 2, 4, 0x10, 0x20

    def __init__(self, drive, traits):
        self.drive, self.traits = drive, traits or {}
        self.seen = self.status = self.place = 0
        self.new = self.old = False     # a mark came; it is not forgotten yet
        self.looked = 0

    def check(self, now, value):
        if value & ~(self.ON | self.FIRST_OF | self.MARK | self.RISING |
                     self.FALLING):
            raise Abort(RANGE)          # the second one, or another source
        if value & self.ON and not value & (self.RISING | self.FALLING):
            raise Abort(RANGE)
        if now & self.ON and value & self.ON:
            raise Abort(NOT_NOW)        # not while it is on
        if value & self.ON and self.seen & self.ON:
            self.drive.offence("its touch probe did not see that it was off")

    def read(self):
        if not self.status & 2:
            self.drive.offence("the place of a mark was read, and there is none")
        return self.place & 0xffffffff

    def look(self, now):
        if now - self.looked < self.traits.get("task", 0):
            return
        self.looked = now
        value = self.drive.get(0x60b8)
        rises = value & ~self.seen & self.ON
        self.seen = value
        if not value & self.ON:
            self.old, self.new = self.old or self.new, False
            self.status &= ~3
        elif rises:
            if self.old and self.traits.get("keeps"):
                self.status |= 2
            self.old = False
            self.status |= 1

    def pass_by(self, was, now):
        """Its edge rises where the mark begins, from whichever side."""
        if not (self.traits and self.seen & self.ON and now != was and
                not self.status & 2 and self.seen & self.MARK):
            return
        every, begin = self.traits["every"], self.traits.get("from", 0)
        if now < was:
            begin += self.traits.get("width", 0)
            edge = (was - 1 - begin) // every * every + begin
            met = edge >= now
        else:
            edge = -((begin - was - 1) // every) * every + begin
            met = edge <= now
        if not met:
            return
        self.drive.bus.marks.append((self.drive.node, edge))
        self.place = edge - self.drive.offset
        self.status |= 2
        self.new = True
        if self.traits.get("toggles"):
            self.status ^= 0x40


class Bus:
    def __init__(self, interface, commands, traits):
        self.sock = socket.socket(socket.PF_CAN, socket.SOCK_RAW,
                                  socket.CAN_RAW)
        self.sock.setblocking(False)
        self.sock.bind((interface,))
        self.aborts, self.rows, self.flags, self.gap_v = [], [], 0, 0.0
        self.stored, self.offences, self.marks = [], [], []
        self.noise, self.came = 0, []   # harm: when, after how many rows
        self.drives = {int(n): Drive(self, int(n), t)
                       for n, t in traits.items()}
        self.fifo = os.open(commands, os.O_RDWR | os.O_NONBLOCK)
        self.rest = b""

    def send(self, can_id, data):
        try:
            self.sock.send(FRAME.pack(can_id, len(data),
                                      bytes(data).ljust(8, b"\0")))
        except OSError:
            pass

    def read(self):
        for _ in range(200):
            try:
                frame = self.sock.recv(16)
            except OSError:
                return
            can_id, size, data = FRAME.unpack(frame)
            data, now = data[:size], time.monotonic()
            if can_id == 0 and size == 2:
                for d in self.drives.values():
                    if d.powered:
                        d.on_nmt(*data)
            elif can_id == 0x80 and size <= 1:
                self.sync(now)
            elif can_id == GENERATOR_ID:
                self.flags = data[0]
            elif can_id < 0x800:
                for d in self.drives.values():
                    d.hear(can_id, data, now)

    def sync(self, now):
        for d in self.drives.values():
            if d.powered and d.nmt != BOOTING:
                d.on_sync(now)
        if self.gap_v:
            self.noise = (self.noise * 5 + 3) % 16
            self.send(GAP_ID, struct.pack("<H", int(self.gap_v * 100) +
                                          self.noise * self.loud))
        self.rows.append((now, self.flags, [
            (d.state, d.true, d.count, d.mode if d.powered else 0)
            for d in self.drives.values()]))

    def command(self, words):
        what, args = words[0], words[1:]
        if what == "gap":
            self.gap_v = float(args[0])
            self.loud = int(args[1]) if args[1:] else 1
        elif what == "nmt":
            for d in self.drives.values():
                if d.powered:
                    d.on_nmt(int(args[0], 16), int(args[1], 16))
            self.send(0, bytes(int(a, 16) for a in args))
        elif what == "where":
            with open(args[0] + ".new", "w") as f:
                json.dump([d.true for d in self.drives.values()], f)
            os.rename(args[0] + ".new", args[0])
        elif what == "report":
            with open(args[0] + ".new", "w") as f:
                json.dump({"nodes": list(self.drives), "rows": self.rows,
                           "aborts": self.aborts, "came": self.came,
                           "stored": self.stored,
                           "offences": self.offences,
                           "marks": self.marks}, f)
            os.rename(args[0] + ".new", args[0])
            self.rows, self.aborts, self.came = [], [], []
        elif what == "quit":
            sys.exit(0)
        else:
            self.harm(self.drives[int(args[0])], what, args[1:])

    def harm(self, d, what, args):
        self.came.append((time.monotonic(), len(self.rows), what))
        if what == "off":
            d.power_off()
        elif what == "on":
            d.power_on()
        elif what == "push":
            d.true += int(args[0])
            d.count = d.true - d.offset
        elif what == "mode":
            d.mode, d.mode_at = int(args[0]), 0
        elif what == "bits":
            d.force_set, d.force_clear = (int(a, 16) for a in args)
        elif what == "emcy":
            d.fail(int(args[0], 16))
        elif what == "warn":
            self.send(0x80 + d.node, struct.pack(
                "<HB5s", int(args[0], 16), 4,
                bytes.fromhex(args[1] if args[1:] else "")))
        elif what == "input":
            d.forced[args[0]] = int(args[1])
        elif what in ("deaf", "hears"):
            d.deaf = what == "deaf"
        elif what in ("weak", "strong"):
            d.weak = what == "weak"
        elif what == "slow":
            d.traits["slow"] = {args[0]: float(args[1])}
        elif what == "invert":
            d.inverted ^= 1 << int(args[0])
        elif what in ("loses", "finds"):
            d.loses = what == "loses"
        elif what == "fails":
            d.fails = True
        elif what in ("jam", "unjam"):
            d.jammed = what == "jam"
        elif what in ("clip", "free"):
            d.jammed = what == "clip"
            d.force_set = 0x800 if d.jammed else 0

    def run(self):
        while True:
            ready, _, _ = select.select([self.sock, self.fifo], [], [], 0.02)
            if self.sock in ready:
                self.read()
            now = time.monotonic()
            for d in self.drives.values():
                d.live(now)
            if self.fifo not in ready:
                continue
            self.rest += os.read(self.fifo, 4096)
            *lines, self.rest = self.rest.split(b"\n")
            for line in lines:
                self.command(line.decode().split())


if __name__ == "__main__":
    Bus(sys.argv[1], sys.argv[2], json.loads(sys.argv[3])).run()
