# SPDX-License-Identifier: Apache-2.0
"""What is done to strict drives in the guest; strict.py plays them.

Leaves NAME.json and NAME.log, as can402.py does.
"""
import json
import pathlib
import random
import struct
import sys
import threading
import time

from commission import commission
from can402 import CUTTING, FIFO, R, RUNNING, Scene, frame


def scene(name, traits):
    return Scene(name, list(traits), [R / "strict.py", "vcan0", FIFO,
                                      json.dumps(traits)])


def submit(s, name):
    return s.submit(str(R / f"{name}.ngc"))


def job(s, name):
    submit(s, name)
    return s.start()


def until_log(s, text, seconds):
    end = time.monotonic() + seconds
    while text not in pathlib.Path(R / "log").read_text():
        if time.monotonic() > end or s.edmd.poll() is not None:
            s.in_vain(f"waited in vain for {text}")
        time.sleep(0.05)


def whole():
    """Each with something of its own, and a job from end to end."""
    with scene("strict-up", {
        1: {"slow": {"60c2:1": 0.7, "1017:0": 0.7}},
        2: {"unmappable": ["6061"], "without": ["1006", "1007", "1019"]},
        3: {"fixed_ids": True, "mode_lag": 0.3, "not_ready": 1.0},
        4: {"identity": [0xfb, 0x64100000, 0x170, 77],
            "without": ["6007", "6502", "6061"]},
    }) as s:
        until_log(s, "(node 3) is up", 30)
        job(s, "strict-up")
        s.until("running", 10, state=RUNNING)
        s.until("idle", 60, state="idle")


def refused():
    """What they do not take is told with value, code and words."""
    with scene("strict-refused", {
        1: {"most": {"60c2:1": 8}},
        2: {"refuse": {"605a:0": "06090030"}},
        3: {"identity": [0xbad, 1, 2, 3]}, 4: {"without": ["1016"]},
        5: {"unmappable": ["60fd"]}, 6: {},
    }) as s:
        for n in 1, 2, 3, 4, 5, 6:
            until_log(s, f"(node {n}) refuses its configuration", 20)


def late():
    """One is switched on after the job was submitted; then off and on while
    it is being set up."""
    with scene("strict-late", {1: {}, 2: {"off": True}}) as s:
        s.tell("gap", 25)
        submit(s, "strict-late")
        time.sleep(1.5)
        s.mark("on")
        s.tell("on", 2)
        time.sleep(0.25)
        s.tell("off", 2)
        s.tell("on", 2)
        until_log(s, "(node 2) is up", 20)
        time.sleep(2)
        s.mark("start")
        s.more["before"] = s.status()
        s.more["start"] = s.start()
        s.until("cutting", 10, state=CUTTING)


def objects():
    """`edmctl drive`: what it shows, reads, sets and refuses."""
    with scene("strict-objects", {1: {}, 2: {"without": ["1010"]}}) as s:
        def drive(*words):
            return s.ctl("drive", *words)

        s.tell("gap", 25)
        until_log(s, "(node 1) is up", 30)
        until_log(s, "(node 2) is up", 30)
        out = s.more["out"] = {}
        out["cold"] = s.ctl("--json", "drive")
        out["get"] = [drive("get", "X", *what) for what in (
            ("6064",), ("position", "actual", "value"), ("60c2:2",),
            ("Statusword",), ("5fff",), ("1008",), ("6064",), ("nonsense",))]
        out["set"] = [drive("set", "X", *what) for what in (
            ("6065", "1500"), ("following error window", "2000000"),
            ("6064", "5"), ("607a", "5"), ("1016:1", "0"), ("605a", "1"),
            ("6065", "x"), ("6065", "1.5"))]
        out["store"] = [drive("store", axis) for axis in "XYZ"]
        s.tell("warn", 1, "3283", "0102030405")
        time.sleep(0.5)
        out["emcy"] = drive("emcy")
        job(s, "strict-faults")
        s.until("cutting", 10, state=CUTTING)
        out["scope"] = s.ctl("--json", "drive", "scope", "X", "0.5")
        out["in a cut"] = [drive("list"), drive("get", "Y", "6041"),
                           drive("set", "Y", "6065", "1400"),
                           drive("store", "X")]
        out["cuts on"] = s.status()
        s.ctl("stop")
        s.until("idle", 10, state="idle")
        out["torque"] = drive("set", "Y", "6065", "1400")
        s.ctl("estop")
        s.until("fault", 10, state="fault")
        time.sleep(0.5)
        out["without"] = drive("set", "Y", "6065", "1400")
        out["turned"] = drive("set", "Y", "polarity", "0x80")
        time.sleep(0.3)
        out["after"] = s.ctl("--json", "drive")
        out["alarms"] = s.ctl("alarms")
        out["reset"] = s.ctl("reset")


def homes():
    """Each drive finds its zero by itself; then what ends that before."""
    with scene("strict-home", {
        1: {"home": {"at": -334500, "stale": True, "late": 15}},
        2: {"home": {"at": 17000, "leave": True, "torque": True,
                     "no10": True}, "mode_lag": 0.2},
        3: {"home": {}},
    }) as s:
        for n in 1, 2, 3:
            until_log(s, f"(node {n}) is up", 30)
        out = s.more["out"] = {}

        def home(axis):
            answer = s.ctl("home", axis, "--wait")
            s.mark(f"homed {axis} {len(out)}")
            return answer

        def begins(what):
            """Its drive is jammed while it looks for its zero."""
            s.tell("jam", 1)
            s.ctl("home", "X")
            time.sleep(1.5)
            s.mark(f"{what}: now")
            return s.status()["state"]

        def ends(what):
            s.tell("unjam", 1)
            time.sleep(0.5)
            out[f"{what}: lost"] = s.status()["lost"]

        for axis in "XYZ":
            out[f"home {axis}"] = home(axis)
        out["homed"] = s.status()
        out["again"] = [home("Z"), home("X")]
        out["job"] = job(s, "strict-home")
        s.until("job ends", 60, state="idle")
        s.mark("there")

        out["hold: state"] = begins("hold")
        s.ctl("hold")
        s.until("hold: idle", 10, state="idle")
        ends("hold")
        out["hold: home"] = home("X")

        out["estop: state"] = begins("estop")
        s.ctl("estop")
        s.until("estop: fault", 10, state="fault")
        ends("estop")
        out["estop: reset"] = s.ctl("reset")
        time.sleep(0.5)
        out["estop: home"] = home("X")

        s.tell("fails", 1)
        out["fails: home"] = home("X")
        out["fails: fault"] = s.status()["fault"]
        out["fails: reset"] = s.ctl("reset")
        out["fails: again"] = home("X")

        out["off: state"] = begins("off")
        s.tell("off", 1)
        s.until("off: fault", 10, state="fault")
        s.tell("on", 1)
        ends("off")
        time.sleep(1)
        out["off: reset"] = s.ctl("reset")
        time.sleep(2)
        out["off: home"] = home("X")
        out["last job"] = job(s, "strict-home")
        s.until("last job ends", 60, state="idle")


def asked():
    """Drives that answer late, abort, are reset meanwhile, or claim a mode that
    they do not have, while somebody asks for their objects and homes them."""
    with scene("strict-asked", {
        1: {"slow": {"6065:0": 1.5}, "home": {"at": 500}, "no6": True},
        2: {"home": {"at": 17000}, "refuse": {"6085:0": "08000020"}},
        3: {"home": {}},
    }) as s:
        for n in 1, 2, 3:
            until_log(s, f"(node {n}) is up", 30)
        out = s.more["out"] = {}

        def drive(*words):
            return s.ctl("drive", *words)

        out["late"] = [drive("get", "X", "6065"), drive("get", "X", "60c2:2"),
                       drive("get", "X", "1000")]
        time.sleep(2)
        out["after late"] = drive("get", "X", "60c2:2")
        out["aborts"] = drive("set", "Y", "6085", "5000")
        out["none"] = [drive("get", axis, "6064") for axis in "AQ"]
        out["many"] = drive("get", "X", "6064:300")
        asks = []
        other = threading.Thread(target=lambda: asks.append(
            drive("get", "X", "6065")))
        other.start()
        time.sleep(0.3)
        out["both"] = drive("get", "Y", "6064")
        s.tell("off", 1)
        other.join()
        out["off"] = asks[0]
        out["is off"] = drive("get", "X", "6064")
        s.tell("on", 1)
        s.until("fault", 10, state=("fault", "idle"))
        time.sleep(3)
        out["reset"] = s.ctl("reset")
        time.sleep(3)
        out["again"] = drive("get", "X", "1000")
        out["no mode 6"] = s.ctl("home", "X", "--wait")
        out["no mode 6: state"] = s.status()
        out["no mode 6: reset"] = s.ctl("reset")
        time.sleep(1)
        out["well"] = s.ctl("home", "Y", "--wait")


def inputs():
    """A home and limit switches and an e-stop, wired to the drives."""
    with scene("strict-inputs", {
        1: {"inputs": {"0": -700000, "1": [300000], "2": -334500}},
        2: {"inputs": {"16": 1}},
    }) as s:
        for n in 1, 2:
            until_log(s, f"(node {n}) is up", 30)
        out = s.more["out"] = {}

        def does(what, *words):
            out[what] = s.ctl(*words)
            time.sleep(0.3)
            out[f"{what}: state"] = s.status()
            s.mark(what)

        does("home", "home", "X", "--wait")
        does("to high", "jog", "X", "12", "--wait")
        does("to high: reset", "reset")
        does("farther", "jog", "X", "0.1", "--wait")
        does("another axis", "jog", "Y", "1", "--wait")
        does("back", "jog", "X", "-1", "--wait")
        s.tell("input", 1, 0, 1)
        does("on at rest", "status")
        does("toward it", "jog", "X", "-0.1", "--wait")
        does("from it", "jog", "X", "0.1", "--wait")
        s.tell("input", 1, 0, 0)
        s.ctl("jog", "X", "-5")
        time.sleep(0.5)
        s.tell("input", 1, 1, 1)
        does("wrong end", "status")
        does("wrong end: reset", "reset")
        does("wrong end: on", "jog", "X", "-0.1", "--wait")
        does("wrong end: back", "jog", "X", "0.1", "--wait")
        s.tell("input", 1, 1, 0)
        does("again", "jog", "X", "-0.1", "--wait")
        s.ctl("jog", "X", "-1")
        time.sleep(0.3)
        s.tell("input", 2, 16, 0)
        s.until("estop", 5, state="fault")
        does("estop: pressed", "reset")
        s.tell("input", 2, 16, 1)
        time.sleep(0.3)
        does("estop: let go", "status")
        does("estop: reset", "reset")
        does("estop: jog", "jog", "X", "-0.1", "--wait")
        s.ctl("jog", "X", "-1")
        time.sleep(0.3)
        s.tell("loses", 2)
        s.until("loses", 5, state="fault")
        s.tell("finds", 2)
        time.sleep(0.3)
        does("loses: reset", "reset")
        time.sleep(2)
        out["job"] = job(s, "strict-inputs")
        s.until("job ends", 60, state="idle")


def marks():
    """Home switches at the drives, and index marks that they keep by themselves."""
    width = {"width": 40, "task": 0.03}
    with scene("strict-marks", {
        1: {"inputs": {"2": -334500},
            "probe": {"every": 20000, "from": 13000, "toggles": True, **width}},
        2: {"inputs": {"2": [20000]},
            "probe": {"every": 9000, "from": 700, "keeps": True, **width}},
    }) as s:
        for n in 1, 2:
            until_log(s, f"(node {n}) is up", 30)
        out = s.more["out"] = {}

        def home(what, axis):
            out[what] = s.ctl("home", axis, "--wait")
            time.sleep(0.3)
            out[f"{what}: state"] = s.status()
            s.mark(what)

        for n in range(3):
            home(f"X {n}", "X")
            home(f"Y {n}", "Y")
            if n < 2:
                out[f"away {n}"] = [s.ctl("jog", axis, "1", "--wait")
                                    for axis in "XY"]


def interpolated():
    """One that has mode 7 and not 8 beside one that has 8: home, a job, an
    e-stop in it, and on to its end."""
    with scene("strict-ip", {
        1: {"ip": True, "home": {"at": -334500}, "mode_lag": 0.1}, 2: {},
    }) as s:
        until_log(s, "(node 1) is up", 30)
        until_log(s, "(node 2) is up", 30)
        out = s.more["out"] = {}
        out["home"] = s.ctl("home", "X", "--wait")
        s.mark("homed")
        out["job"] = job(s, "strict-ip")
        s.until("running", 10, state=RUNNING)
        time.sleep(0.5)
        s.ctl("estop")
        s.until("estop", 10, state="fault")
        time.sleep(1)
        out["reset"] = s.ctl("reset")
        time.sleep(0.5)
        out["start"] = s.start()
        s.until("end", 60, state="idle")
        out["drives"] = s.ctl("--json", "drive")


# What is done while it cuts, and undone.
PLAN = [
    ("mode", ("mode", 1, 6), None),
    ("ignores", ("bits", 2, "0", "1000"), ("bits", 2, "0", "0")),
    ("lags", ("bits", 2, "2000", "0"), ("bits", 2, "0", "0")),
    ("limit", ("clip", 1), ("free", 1)),
    ("jam", ("jam", 1), ("unjam", 1)),
]


def faults():
    """Each thing in turn, then a warning, then power off."""
    with scene("strict-faults", {1: {}, 2: {}}) as s:
        s.tell("gap", 25)
        job(s, "strict-faults")
        out = s.more["out"] = {}
        for what, harm, mend in PLAN:
            out[what] = fault(s, what, harm, mend)
        s.until("warning: cutting", 10, state=CUTTING)
        s.tell("warn", 1, "3283")
        s.tell("bits", 1, "80", "0")
        time.sleep(0.5)
        out["warning"] = {"state": s.status().get("state")}
        s.tell("bits", 1, "800", "0")
        time.sleep(0.5)
        out["at its limit"] = {"state": s.status().get("state")}
        s.tell("bits", 1, "0", "0")
        out["off"] = power_cycle(s, "off", 2, 0.2)


def fault(s, what, harm, mend):
    s.until(f"{what}: cutting", 10, state=CUTTING)
    time.sleep(0.3)
    s.mark(f"{what}: harm")
    s.tell(*harm)
    got = s.until(f"{what}: fault", 5, state="fault")
    time.sleep(0.2)
    s.mark(f"{what}: stands")
    time.sleep(0.3)
    if mend:
        s.tell(*mend)
    reset = s.ctl("reset")
    time.sleep(0.3)
    s.mark(f"{what}: start")
    return {"fault": got.get("fault"), "reset": reset, "start": s.start()}


def power_cycle(s, what, node, seconds):
    """While it cuts; what an operator may then do, and what not."""
    s.until(f"{what}: cutting", 10, state=CUTTING)
    s.mark(f"{what}: harm")
    s.tell("off", node)
    time.sleep(seconds)
    s.tell("on", node)
    return lost(s, what, node)


def lost(s, what, node):
    got = s.until(f"{what}: fault", 5, state="fault")
    time.sleep(0.6)
    s.ctl("reset")
    time.sleep(0.6)
    starts = [s.ctl("start") for _ in range(3)]
    time.sleep(0.3)
    steps = [s.ctl("retract", "0.05")]
    s.mark(f"{what}: stop")
    s.ctl("stop")
    s.until(f"{what}: idle", 10, state="idle")
    homed = home(s, " XY"[node])
    s.mark(f"{what}: homed")
    s.until(f"{what}: idle again", 10, state="idle")
    again = submit(s, "strict-faults")      # it begins by itself
    return {"fault": got.get("fault"), "starts": starts, "steps": steps,
            "home": homed, "again": again}


def home(s, axis):
    """Again until the drives are up."""
    for _ in range(60):
        answer = s.ctl("home", axis)
        if answer[0] == 0:
            return answer
        time.sleep(0.1)
    s.in_vain(f"home {axis} in vain: {answer}")


def attack(seed, runs):
    """Power cycles at random instants: of approach, cut, hold, set-up, ..."""
    rng = random.Random(seed)
    with scene("strict-attack", {1: {}, 2: {}}) as s:
        s.tell("gap", 25)
        job(s, "strict-faults")
        s.more["done"] = []
        for i in range(runs):
            s.more["done"].append(cycle_at_random(s, rng, f"attack {i}"))


def cycle_at_random(s, rng, what):
    node = rng.choice((1, 2))
    s.until(f"{what}: running", 10, state=RUNNING)
    time.sleep(rng.uniform(0, 0.4))
    if rng.random() < 0.3:
        s.ctl("hold")
    s.mark(f"{what}: harm")
    s.tell("off", node)
    time.sleep(rng.choice((0, 0.02, 0.15, 0.4)))
    s.tell("on", node)
    # Once more while it boots, is set up, or has just come.
    if rng.random() < 0.5:
        time.sleep(rng.uniform(0, 0.6))
        s.tell("off", node)
        s.tell("on", node)
    if rng.random() < 0.3:
        s.tell("push", node, rng.randrange(-300, 300))
    return {"node": node} | lost(s, what, node)


# -- What else may be on a bus ------------------------------------------------

def storm(s, rng, n):
    for _ in range(200):
        frame(0x80 + n, rng.randbytes(8))


def lengths(s, rng, n):
    for _ in range(100):
        base = rng.choice((0x080, 0x180, 0x580, 0x700, 0x3f0 - n))
        size = rng.choice([k for k in range(9) if k not in (1, 2, 6, 7, 8)])
        frame(base + n, rng.randbytes(size))


def answers(s, rng, n):
    """SDO answers to nothing: segments, toggled bits, blocks, aborts."""
    for _ in range(200):
        frame(0x580 + n, bytes([rng.randrange(256)]) + rng.randbytes(7))


def beats(s, rng, n):
    for _ in range(20):
        frame(0x700 + n, bytes([rng.choice((4, 5, 127, 0x85, 3, 255))]))
        time.sleep(0.01)


def flicker(s, rng, n):
    for _ in range(6):
        s.tell("bits", n, f"{1 << rng.randrange(16):x}",
               f"{1 << rng.randrange(16):x}")
        time.sleep(rng.choice((0.005, 0.01, 0.03)))
        s.tell("bits", n, "0", "0")
        time.sleep(0.02)


def other_mode(s, rng, n):
    s.tell("mode", n, rng.choice((0, 1, 3, 6, 255)))
    time.sleep(rng.choice((0.01, 0.1)))
    s.tell("mode", n, 8)


def double(s, rng, n):
    """Another one with its node, which stands elsewhere."""
    for _ in range(rng.choice((1, 3, 30))):
        frame(0x180 + n, struct.pack("<HiB", rng.choice((0x1237, 0x0250)),
                                     rng.randrange(-1 << 31, 1 << 31), 8))
        time.sleep(0.01)


def says_boot_up(s, rng, n):
    frame(0x700 + n, b"\0")


def off_bus(s, rng, n):
    frame(0x20000040, bytes(8))
    time.sleep(0.05)
    frame(0x20000100, bytes(8))


def foreign_nmt(s, rng, n):
    s.tell("nmt", rng.choice(("80", "2", "1")), f"{rng.choice((0, n)):x}")


def strange_ids(s, rng, n):
    for _ in range(100):
        frame(rng.choice((0x80000000, 0x40000000)) + 0x180 + n,
              rng.randbytes(7))


NOISE = [storm, lengths, answers, beats, flicker, other_mode, double,
         says_boot_up, off_bus, foreign_nmt, strange_ids]


def noise(seed, runs):
    """Each in turn and then by chance, each time back to the cut, as an
    operator would."""
    rng = random.Random(seed)
    with scene("strict-noise", {1: {}, 2: {}}) as s:
        s.tell("gap", 25)
        job(s, "strict-faults")
        s.more["done"] = []
        for i in range(runs):
            what = NOISE[i] if i < len(NOISE) else rng.choice(NOISE)
            recover(s, f"{i}")
            time.sleep(rng.uniform(0, 0.3))
            s.mark(f"{i} {what.__name__}: begins")
            what(s, rng, rng.choice((1, 2)))
            time.sleep(rng.uniform(0.05, 0.4))
            s.more["done"].append([what.__name__, s.status()["state"],
                                   s.status()["fault"]])
        recover(s, "last")


def recover(s, what):
    """What the messages tell an operator to do, until it cuts again."""
    end = time.monotonic() + 60
    while time.monotonic() < end:
        now = s.status().get("state")
        if now in CUTTING:
            return
        if now == "fault":
            s.ctl("reset")
        elif now == "hold" and "homed" in s.ctl("start")[1]:
            s.ctl("stop")
        elif now == "idle":
            for axis in "XY":           # refused, unless its place is lost
                s.ctl("home", axis)
                s.until(f"{what}: {axis} homed", 10, state="idle")
            submit(s, "strict-faults")
        time.sleep(0.1)
    s.in_vain(f"{what}: recovered in vain: {s.status()}")


if __name__ == "__main__":
    SCENES = {"up": whole, "refused": refused, "late": late,
              "objects": objects, "homes": homes, "asked": asked, "inputs": inputs, "marks": marks,
              "commission": commission, "ip": interpolated, "faults": faults,
              "attack": lambda: attack(int(sys.argv[2]), int(sys.argv[3])),
              "noise": lambda: noise(int(sys.argv[2]), 3 * int(sys.argv[3]))}
    for which in sys.argv[4].split(","):
        SCENES[which]()
