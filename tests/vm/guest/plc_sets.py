# SPDX-License-Identifier: Apache-2.0
"""A PLC that sets the generator: plc_sets.py INTERFACE SCENE ...

It scans each 10 ms, as PLCs do: what has come, the program, what goes out.  It
knows edmd by messages/edmd.eds and the generator by its own model, which needs
30 ms for a change.  What edmd must not do it writes down as offences.  Prints
JSON: times are of CLOCK_MONOTONIC, as those of the kernel's trace.

Scenes: idle (no job, until it is killed), good (until the job is done), or what a PLC or its generator does to a cut:
late, lies, refuses, silent, resets.
"""
import json
import sys
import time

import canopen

import st

NODE, SCAN_S, SLOW_S = 32, 0.01, 0.03
STATES = ("?", "idle", "travel", "approach", "erode", "retract", "jump",
          "hold", "fault")
VALUES = ("Current", "OnTime", "OffTime", "Voltage")


class Generator:
    """Sets what it is given SLOW_S later, all of it at once."""

    def __init__(self):
        self.real = dict.fromkeys(VALUES, 0) | {"Negative": 0, "Iso": 0,
                                                "Servo": 0}
        self.next, self.at, self.log = None, None, []

    def give(self, values, now):
        self.next, self.at = dict(values), now + SLOW_S

    def turn(self, now):
        if self.next and now >= self.at:
            self.real, self.next = self.next, None
            self.log.append((now, dict(self.real)))


class Plc:
    def __init__(self, interface):
        network = canopen.Network()
        network.connect(interface="socketcan", channel=interface)
        self.node = network.add_node(NODE, "edmd.eds")
        self.node.sdo.RESPONSE_TIMEOUT = 2
        self.node.tpdo.read()
        self.node.rpdo.read()
        self.frames = {}
        for n in (1, 5, 6):
            self.node.tpdo[n].add_callback(self.came)
        self.generator = Generator()
        self.offences, self.notes = [], []
        self.block = st.Block(open("edmd.st").read(), "EdmdGenerator")
        self.fault, self.servo = 0, 0
        self.given, self.scans = {}, {}
        self.bits = {"permit": 1}
        self.alive = 0
        # What is wrong with it.
        self.mute = self.late = False
        self.told = {}
        self.node.nmt.state = "OPERATIONAL"
        self.scan_at = time.monotonic()

    # -- Frames ---------------------------------------------------------------

    def came(self, pdo):
        self.frames |= {v.name.split(".")[1]: v.raw for v in pdo}

    def asked(self):
        f = self.frames
        return {v: f["Asked" + v] for v in VALUES} | {
            "Negative": f["AskedBits"] & 1, "Iso": f["AskedBits"] >> 1 & 1}

    def send(self, n, **values):
        pdo = self.node.rpdo[n]
        for name, value in values.items():
            pdo[name.replace("__", ".")].raw = value
        pdo.transmit()

    def answer(self):
        tell = self.generator.real | self.told
        self.send(2, Generator__InForce=self.block["InForce"],
                  Generator__GeneratorFault=self.fault,
                  Generator__ToldServo=tell["Servo"],
                  Generator__ToldBits=tell["Negative"] | tell["Iso"] << 1)
        self.send(3, **{"Generator__Told" + v: tell[v] for v in VALUES})

    # -- The program ----------------------------------------------------------

    def judge(self, number):
        """The values of the next number, and a status, may be on their way."""
        self.seen("other values under the same number",
                  number and number == self.block["Given"] and
                  self.asked() != self.given)
        self.seen("sparks before it is in force",
                  self.sparks() and number != self.block["InForce"] and
                  not self.fault)

    def seen(self, what, is_so):
        self.scans[what] = self.scans.get(what, 0) + 1 if is_so else 0
        if self.scans[what] == 4:
            self.offences.append((time.monotonic(), what))

    def program(self, now):
        b, number, asked = self.block, self.frames["Asked"], self.asked()
        self.judge(number)
        was, reads = b["Given"], b["ReadServo"]
        if reads:
            self.servo = self.node.sdo[0x2002][5].raw
        b.scan(Asked=number, HasServo=1, AskedServo=self.servo, ServoRead=reads,
               Ready=self.generator.next is None and not self.late,
               **{"Asked" + v: x for v, x in asked.items()})
        if b["Given"] not in (was, 0):
            self.given = asked
            self.generator.give({v: b["Gen" + v]
                                 for v in self.generator.real}, now)

    def scan(self):
        now = time.monotonic()
        self.generator.turn(now)
        if {"Asked", "AskedCurrent", "State"} <= self.frames.keys():
            self.program(now)
        self.alive ^= 0x80
        b = self.bits
        self.send(1, PLC__Command=self.alive | b.get("permit", 0) |
                  b.get("start", 0) << 1 | b.get("reset", 0) << 3,
                  PLC__Interlocks=0x1f, PLC__FeedOverride=1000)
        if not self.mute:
            self.answer()
        self.scan_at += SCAN_S
        time.sleep(max(0, self.scan_at - time.monotonic()))

    def scan_for(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.scan()

    def until(self, what, seconds=60):
        end = time.monotonic() + seconds
        while not ({"State", "Flags"} <= self.frames.keys() and what(self)):
            if time.monotonic() > end:
                raise SystemExit(f"not seen: {self.frames}")
            self.scan()

    def press(self, bit):
        self.bits[bit] = 1
        self.scan_for(0.1)
        self.bits[bit] = 0
        self.scan_for(0.1)

    def sparks(self):
        return self.frames["Flags"] >> 1 & 1

    def state(self):
        return STATES[self.frames["State"]]

    def note(self, what):
        self.notes.append((time.monotonic(), what, dict(self.frames)))

    # -- What is wrong with it ------------------------------------------------

    def lies(self):
        self.told = {"Current": 120}
        return self.answer, self.told.clear

    def refuses(self):
        self.fault = 3
        return self.answer, lambda: setattr(self, "fault", 0)

    def silent(self):
        self.mute = True
        return None, lambda: setattr(self, "mute", False)

    def resets(self):
        self.block["Given"] = self.block["InForce"] = 0
        self.generator.real = dict.fromkeys(self.generator.real, 0)
        self.generator.log.append((time.monotonic(),
                                   dict(self.generator.real)))
        return self.answer, lambda: None

    def ill(self, scene):
        """In a cut: the evidence, the fault, and back to a cut."""
        self.until(Plc.sparks)
        self.scan_for(0.2)
        self.note(scene)
        evidence, heal = getattr(self, scene)()
        if evidence:
            evidence()
        self.until(lambda p: p.state() == "fault")
        self.note(scene + ": fault")
        heal()
        self.scan_for(0.2)
        self.again()

    def again(self):
        self.press("reset")
        self.until(lambda p: p.state() == "hold")
        self.press("start")

    def begin_late(self):
        """It never says that it has it."""
        self.late = True
        self.press("start")
        self.note("late")
        self.until(lambda p: p.state() == "fault")
        self.note("late: fault")
        self.late = False
        self.again()


def main():
    interface, *scenes = sys.argv[1:]
    plc = Plc(interface)
    try:
        if scenes == ["idle"]:          # until it is killed
            plc.scan_for(3600)
        plc.until(lambda p: p.frames["Flags"] >> 6 & 1)     # loaded
        if scenes[0] == "late":
            plc.begin_late()
        else:
            plc.press("start")
        for scene in scenes[1:]:
            plc.ill(scene)
        if scenes == ["good"]:
            plc.until(lambda p: not p.frames["Flags"] >> 6 & 1, 60)
        else:
            plc.until(Plc.sparks)
    finally:
        print(json.dumps({"offences": plc.offences, "notes": plc.notes,
                          "generator": plc.generator.log}, indent=1))


main()
