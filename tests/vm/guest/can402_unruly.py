# SPDX-License-Identifier: Apache-2.0
"""What unruly drives, a PLC and others do on one bus; unruly.py plays drives.

    can402_unruly.py FOLDER SEED RUNS SCENE,...

Each scene leaves NAME.json and NAME.log.  After every harm an operator does
what the messages say, until the machine cuts again.
"""
import json
import random
import socket
import struct
import subprocess
import sys
import threading
import time

from can402 import CUTTING, FIFO, R, Scene, frame
from stranger import NODE, PERMIT, RTR, START, Stranger, examine, row

GIVE_UP_S = 60
NODES = {"X": 1, "Y": 2}
PLC = 32


class Shop(Scene):
    def __init__(self, name, traits):
        super().__init__(name, list(traits), [R / "unruly.py", "vcan0", FIFO,
                                              json.dumps(traits)])
        self.more["done"] = []
        self.job = str(R / f"{name}.ngc")
        self.tell("gap", 25)
        self.tell("known", 0)

    def begin(self):
        # A job that is submitted begins at once, if the drives are up by then.
        self.tell("allow", 0)
        self.submit(self.job)
        self.operate("begin")

    def operate(self, what):
        """Until it cuts; how often a reset and a home was needed."""
        end = time.monotonic() + GIVE_UP_S
        resets = homes = 0
        while time.monotonic() < end:
            now = self.status()
            state = now.get("state")
            if state in CUTTING:
                self.mark(f"{what}: cuts")
                return {"resets": resets, "homes": homes}
            if state == "fault":
                resets += self.ctl("reset")[0] == 0
            elif state == "hold":
                self.tell("allow", 0)
                if "homed" in self.ctl("start")[1]:
                    self.ctl("stop")
            elif state == "idle":
                homes += self.home(now["lost"])
                self.ctl("submit", self.job)
            time.sleep(0.1)
        self.in_vain(f"{what}: operated in vain: {self.status()}")

    def home(self, lost):
        """By the operator's word, and only where edmd asks for it.  All drives
        hold their axes meanwhile."""
        self.tell("allow", 0)
        self.tell("homing", 0)
        done = 0
        for axis in (a for a in NODES if a in lost):
            self.tell("known", NODES[axis])
            done += self.ctl("home", axis)[0] == 0
        return done

    def harm(self, what, do):
        """@do while it cuts, then back to the cut."""
        self.mark(f"{what}: harm")
        do()
        time.sleep(0.4)
        seen = self.status()
        self.more["done"].append(
            {"what": what, "state": seen.get("state"),
             "fault": seen.get("fault")} | self.operate(what))
        time.sleep(0.3)

    def finish(self):
        """The job ends by itself."""
        self.until("idle", 60, state="idle")


# -- Power --------------------------------------------------------------------

# Where the power goes, and what brings the drive there while it cuts.
PLACES = (
    [("following", "forget")] +
    [(state, "leave") for state in ("disabled", "ready", "on", "enabled")] +
    [("stopping", "quick"), ("reacting", "trip 5441"), ("fault", "trip 3210")] +
    [(place, "cycle") for place in (*(f"sdo {n}" for n in
                                      (1, 3, 4, 5, 6, 20, 45, 48, 49, 50)),
                                    "start", "operational", "disabled",
                                    "ready")])


def power(seed, runs):
    rng = random.Random(seed)
    with Shop("unruly-power", {1: {}, 2: {}}) as s:
        s.begin()
        for i in range(max(runs, len(PLACES))):
            where, by = PLACES[i] if i < len(PLACES) else rng.choice(PLACES)
            node = rng.choice((1, 2))
            s.harm(f"{i} {where} of {node} by {by}",
                   lambda: trap(s, rng, node, where, by))
        s.finish()


def trap(s, rng, node, where, by):
    """The trap springs when the drive comes there, now or by a start."""
    s.tell("trap", node, rng.choice((0, 0.05, 0.4, 1.5)), where)
    if where == "following":
        return
    verb, *args = by.split()
    s.tell(verb, node, *args)


# -- What a drive may say, and do by itself -----------------------------------

HARMS = [
    ("mode 0, once", ["lie 1 mode 0"], 0.01),
    ("mode 6", ["lie 2 mode 6"], 0.3),
    ("bit 12, once", ["lie 1 clear 1000"], 0.01),
    ("bit 12", ["lie 2 clear 1000"], 1),
    ("bit 13", ["lie 1 set 2000"], 0.05),
    ("bit 11", ["lie 2 set 800"], 0.5),
    ("bit 11, and it stands", ["jam 2 1", "lie 2 set 800"], 0.5),
    ("quick stop of one", ["quick 1"], 0),
    ("quick stop of both", ["quick 1", "quick 2"], 0),
    ("leaves", ["leave 2"], 0),
    ("fault that stays", ["trip 1 7305", "lie 1 stuck 1"], 1),
    ("jam", ["jam 2 1"], 1),
    ("pushed", ["push 1 400"], 0),
    ("no heartbeat", ["lie 2 mute 1"], 1),
    ("both at once", ["trip 1 2310", "cycle 2"], 0),
    ("trips and is switched off", ["trip 2 3220", "cycle 2"], 0),
    ("leaves and is switched off", ["leave 1", "cycle 1"], 0),
]


def says(seed, runs):
    """Each harm, then pairs of them by chance."""
    rng = random.Random(seed)
    with Shop("unruly-says", {1: {"wanders": 4000},
                              2: {"shows": 20, "falls": True}}) as s:
        s.begin()
        for i in range(max(runs, len(HARMS))):
            which = [HARMS[i]] if i < len(HARMS) else rng.sample(HARMS, 2)
            s.harm(f"{i} {', '.join(h[0] for h in which)}",
                   lambda: [one_harm(s, h) for h in which])
        s.finish()


def one_harm(s, harm):
    _, orders, seconds = harm
    for order in orders:
        s.tell(order)
    time.sleep(seconds)
    s.tell("truth 0")
    s.tell("jam 0 0")


# -- Slow ones ----------------------------------------------------------------

def slow():
    """Both slow, one shows its mode when it is enabled and not before; then one
    is switched off while the other is being set up."""
    with Shop("unruly-slow", {1: {"slow": 0.7}, 2: {
            "slow": 0.05, "twice": True, "shows": "enabled", "enables": 1.5,
            "stray": True}}) as s:
        s.begin()
        s.harm("slow one is switched off", lambda: s.tell("cycle", 1))
        s.finish()


# -- Odd ones -----------------------------------------------------------------

ODD = [("fault", ["trip 1 2310"], 0),
       ("fault of the other", ["trip 2 2310"], 0),
       ("a word that is no state, once", ["lie 1 word 1267"], 0.01),
       ("a word that is no state", ["lie 2 word 0248"], 0.5),
       ("off", ["cycle 1"], 0)]


def odd():
    """They look at the controlword at each second SYNC, are busy when they were
    switched on, report words that CiA 402 does not have, and count round at
    2^31, where the job goes to and fro."""
    with Shop("unruly-odd", {
        1: {"task": 2, "busy": 4, "boots": 3, "absolute": True,
            "at": (1 << 31) - 40000},
        2: {"task": 2, "busy": 1, "absolute": True, "at": 3000 - (1 << 31)},
    }) as s:
        s.tell("known", 0)
        s.begin()
        for harm in ODD:
            s.harm(harm[0], lambda: one_harm(s, harm))
        s.finish()


def absolute():
    """A drive that knows its place is believed where the place agrees, and not
    moved where it does not."""
    with Shop("unruly-absolute", {n: {"absolute": True} for n in (1, 2)}) as s:
        s.tell("known", 0)
        s.begin()
        s.harm("off", lambda: s.tell("cycle", 1))
        s.harm("moved", lambda: moved(s))
        s.finish()


def moved(s):
    s.tell("off", 1)
    s.tell("push", 1, 60000)
    s.tell("on", 1)
    s.until("moved: fault", 10, state="fault")
    s.more["moved"] = []
    for _ in range(3):
        time.sleep(1)
        s.ctl("reset")
        s.until("moved: reset", 10, state="hold")
        s.start()
        s.more["moved"].append(s.until("moved: again", 10, state="fault"))
    s.mark("moved: back")
    s.tell("push", 1, -60000)


# -- Others on the bus --------------------------------------------------------

class Plc(threading.Thread):
    """A PLC of ours: its request each 20 ms, Alive turns each time.  It starts
    our node whenever its heartbeat says that it is not operational."""

    def __init__(self):
        super().__init__(daemon=True)
        self.ended = False
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW,
                                    socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER,
                               struct.pack("=II", 0x700 + PLC, 0x7ff))
        self.socket.bind(("vcan0",))
        self.socket.settimeout(0)

    def run(self):
        alive = 0
        while not self.ended:
            alive ^= 0x80
            frame(0x200 + PLC, bytes([alive | 1, 0x1f, 0xe8, 3, 0, 0, 0, 0]))
            self.look()
            time.sleep(0.02)

    def look(self):
        try:
            beat = self.socket.recv(16)
        except BlockingIOError:
            return
        if beat[8] != 5:
            nmt(1, PLC)


def nmt(command, node):
    frame(0x000, bytes([command, node]))


def plc(seed, runs):
    """Every NMT command to every node, to all, and some while a drive is being
    set up; a service tool writes into a drive that is enabled."""
    rng = random.Random(seed)
    with Shop("unruly-plc", {1: {}, 2: {}}) as s:
        p = Plc()
        p.start()
        s.begin()
        s.tell("foreign-start", 1)
        all_of = [(c, n) for n in (PLC, 0, 1) for c in (1, 2, 0x80, 0x82, 0x81)]
        for i, (command, node) in enumerate(all_of + [
                (rng.choice((1, 2, 0x80, 0x81, 0x82)), rng.choice((0, 2, PLC)))
                for _ in range(runs)]):
            s.harm(f"{i} NMT {command:x} {node:x}",
                   lambda: commanded(rng, command, node, i >= len(all_of), s))
        for index, sub, size, value in ((0x6060, 0, 1, 1), (0x607a, 0, 4, 0),
                                        (0x6040, 0, 2, 6), (0x1017, 0, 2, 0)):
            s.harm(f"tool writes {index:x}",
                   lambda: tool(1, index, sub, size, value))
        s.finish()
        p.ended = True


def commanded(rng, command, node, set_up, s):
    if set_up:
        s.tell("cycle", rng.choice((1, 2)))
        time.sleep(rng.uniform(0.1, 1))
    nmt(command, node)


def tool(node, index, sub, size, value):
    frame(0x600 + node, bytes([0x23 | (4 - size) << 2, index & 255, index >> 8,
                               sub]) + value.to_bytes(4, "little"))


# What a PLC may do to its slave; each ends with the slave operational.
def stopped(s, p):
    """Its heartbeat alone; what happened meanwhile is told afterwards."""
    p.nmt(2)
    time.sleep(0.5)
    told, pdos, beats = len(p.emergencies), p.pdos, len(p.beats)
    p.request(struct.pack("<BHB4x", 0x40, 0x1000, 0), 0.3)
    s.ask("an SDO while stopped", p.answer, None)
    s.ask("PDOs while stopped", p.pdos, pdos)
    s.ask("emergencies while stopped", len(p.emergencies), told)
    s.ask("heartbeats while stopped", len(p.beats) > beats + 1, True)
    p.nmt(0x80)
    time.sleep(0.2)
    code = p.emergencies[-1:]
    s.ask("its fault is told when it may speak", len(p.emergencies) > told, True)
    s.ask("1001", p.read(0x1001, 0, 1) & 1, 1)
    s.ask("1003:0", p.read(0x1003, 0, 1), p.faults())
    s.ask("1003:1", [p.read(0x1003, 1, 4)], code)
    s.ask("1003:0 = what it has", p.write(0x1003, 0, 1, p.faults()),
          -0x06090030)
    p.nmt(1)


def reset_with_a_fault(s, p, command):
    """By its default identifier again, and with the fault that stands."""
    s.ask("1014, off", p.write(0x1014, 0, 4, 0x80000000 + 0x80 + NODE), 0)
    s.ask("1014, another one", p.write(0x1014, 0, 4, 0x0a5), 0)
    s.ask("1017", p.write(0x1017, 0, 2, 40), 0)
    p.emcy_id = 0x0a5
    told = len(p.emergencies)
    p.command &= ~PERMIT
    time.sleep(0.5)
    s.ask("told by the other identifier", len(p.emergencies), told + 1)
    beats = p.beats[-6:]
    gaps = [round((b - a) * 1000) for a, b in zip(beats, beats[1:])]
    s.ask("heartbeats of 40 ms", all(30 <= g <= 50 for g in gaps) or gaps, True)
    told, boots = len(p.emergencies), p.boots
    p.nmt(command)
    time.sleep(0.5)
    s.ask("boot-up messages", p.boots, boots + 1)
    s.ask("told again after the reset", len(p.emergencies) > told, True)
    s.ask("1014 as it was", p.read(0x1014, 0, 4), 0x80 + NODE)
    s.ask("1017 as it was", p.read(0x1017, 0, 2), 100)
    s.ask("1003:0 begins anew", p.read(0x1003, 0, 1), len(p.emergencies) - told)
    p.command |= PERMIT
    p.nmt(1)


def silent(s, p):
    p.talking = False
    time.sleep(1)
    p.talking = True


def strange_frames(s, p):
    """Of wrong lengths, asked for by remote frames, to others, unknown."""
    for size in range(8):
        p.send(0x200 + NODE, bytes(size))
        if size != 2:
            p.send(0x000, bytes([2, NODE, 0, 0, 0, 0, 0])[:size])
    for base in 0x180, 0x280, 0x580, 0x700, 0x200:
        p.send(RTR + base + NODE, b"")
    for command in 0, 3, 0x7f, 0xff:
        p.nmt(command)
    for command in 1, 2, 0x80, 0x81:    # it has other slaves on this bus
        p.nmt(command, NODE + 1)
    p.send(0x200 + NODE, [p.command, 0xff, 0xe8, 3, 0, 0, 0, 0])
    p.send(0x100, bytes(6))             # TIME
    p.send(0x7e5, bytes(8))             # LSS
    p.send(0x080 + 100, bytes(8))       # its own emergency and heartbeat
    p.send(0x700 + 100, b"\5")


def comes_back_with_start(s, p):
    """The bit must rise while it is there."""
    p.talking = False
    time.sleep(1)
    p.command |= START
    p.talking = True
    time.sleep(0.5)
    s.ctl("reset")
    time.sleep(0.5)
    s.ask("nothing starts by itself", s.status()["state"], "hold")
    p.command &= ~START


def stranger():
    """A PLC that was written from CiA 301 alone, on the drives' bus."""
    with Shop("unruly-stranger", {1: {}, 2: {}}) as s:
        s.more["asked"] = []
        s.ask = lambda what, got, *wanted: s.more["asked"].append(
            row(what, got, wanted))
        p = Stranger("vcan0")
        p.start()
        while not p.beats:
            time.sleep(0.05)
        p.nmt(1)
        s.begin()
        s.harm("asks", lambda: s.more["asked"].extend(
            examine(p, str(R / "edmd.eds"))))
        s.harm("strange frames", lambda: strange_frames(s, p))
        for what, do in (
                ("stopped", stopped),
                ("reset communication", lambda *a: reset_with_a_fault(*a, 0x82)),
                ("reset node", lambda *a: reset_with_a_fault(*a, 0x81)),
                ("silent", silent), ("start", comes_back_with_start)):
            s.harm(what, lambda: do(s, p))
        # What a PLC must not do: both are another master.
        s.harm("SYNC", lambda: p.send(0x080, b""))
        s.harm("heartbeat", lambda: p.send(0x700 + 127, b"\5"))
        s.finish()
        p.ended = True
        s.more["offences"] = p.offences
        s.more["emergencies"] = p.emergencies


def flood(seed, runs):
    """As much as a bus of 1 Mbit/s carries, of what may be on one."""
    rng = random.Random(seed)
    kinds = {
        "highest": lambda: (rng.randrange(1, 0x7f), rng.randbytes(8)),
        "lowest": lambda: (rng.randrange(0x780, 0x7ff), rng.randbytes(8)),
        "emergencies": lambda: (0x80 + rng.choice((1, 2)), bytes(8)),
        "answers": lambda: (0x580 + rng.choice((1, 2)), rng.randbytes(8)),
        "requests": lambda: (0x600 + rng.choice((1, 2)), bytes(
            [0x40, rng.randrange(256), rng.choice((0x10, 0x60)), 0]) + bytes(4)),
        "gaps": lambda: (0x3f0, bytes([rng.randrange(256), 9])),
        "others": lambda: (0x180 + rng.randrange(3, 0x80), rng.randbytes(7)),
    }
    with Shop("unruly-flood", {1: {}, 2: {}}) as s:
        s.begin()
        for name in kinds:
            s.harm(name, lambda: stream(kinds[name], 0.5))
            s.harm(f"{name} while one comes up", lambda: (
                s.tell("cycle", 1), stream(kinds[name], 1)))
        s.finish()


def stream(make, seconds):
    """Some 20 frames in a period of 10 ms: more than Python drives take."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for _ in range(20):
            frame(*make())
        time.sleep(0.01)


# -- An obstacle that does not yield ------------------------------------------

def wall():
    """X comes to a wall while it cuts; then an operator's ways out."""
    with Shop("unruly-wall", {1: {}, 2: {}}) as s:
        s.begin()
        s.tell("wall", 1, 52429)       # 0.5 mm
        s.until("at the wall", 60, state="fault")
        time.sleep(1)
        s.more["wall"] = [beside_wall(s, *verb.split()) for verb in
                          ["", "reset"] + 3 * ["retract 0.05 --wait"] +
                          ["stop", "jog X -0.05 --wait"]]
        s.tell("open", 1)
        s.operate("open")
        s.finish()


def beside_wall(s, *verb):
    """Where X stands behind @verb, and how far in the wall a target was."""
    s.tell("clear", 1)
    s.tell("allow", 0)
    answer = s.ctl(*verb) if verb else None
    time.sleep(1)
    return [" ".join(verb), answer, *s.report("wall", "stands")[0]]


# -- A bus that is taken ------------------------------------------------------

def passes(what, rate):
    """The interface lets frames go at @rate, and keeps those that wait."""
    subprocess.run(["tc", "qdisc", what, "dev", "vcan0", "root", "tbf", "rate",
                    rate, "burst", "32", "limit", "1000000"], check=True)


def jam():
    """Somebody keeps the bus for a while: frames wait in the interface, and go
    out when it is free again.  How many SYNCs come at once then?"""
    with Shop("unruly-jam", {1: {}, 2: {}}) as s:
        passes("add", "1mbit")
        s.begin()
        for seconds in 0.05, 0.5, 3:
            s.harm(f"jam {seconds}", lambda: taken(s, seconds))
        s.finish()
    passes("del", "1mbit")


def taken(s, seconds):
    passes("change", "8bit")
    time.sleep(seconds)
    s.mark(f"free {seconds}")
    passes("change", "1mbit")


if __name__ == "__main__":
    SEED, RUNS = int(sys.argv[2]), int(sys.argv[3])
    SCENES = {"power": lambda: power(SEED, RUNS), "says": lambda: says(SEED, RUNS),
              "slow": slow, "plc": lambda: plc(SEED, RUNS),
              "flood": lambda: flood(SEED, RUNS), "jam": jam, "wall": wall,
              "odd": odd, "absolute": absolute, "stranger": stranger}
    for which in sys.argv[4].split(","):
        SCENES[which]()
