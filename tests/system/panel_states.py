# SPDX-License-Identifier: Apache-2.0
"""A machine with its panel, brought into every state in which people meet it.

Each walk is a generator: it brings the machine into a state, and gives its name
and the pages that show it.  The pictures (docs/pictures/panel) and the page's
tests walk through the same states.
"""

import os
import pathlib
import sys

import can_bus
import panel
import rig
from test_touch import PLATE

PAGES = ("cut", "jobs", "setup", "tech", "alarms", "machine", "fleet")
CUT = ("cut",)
OF_PANEL = "\n[panel]\nport = {port}\nassets = {page}\n"
TABLE = "condition, servo_v, on_us, off_us\nC100, 20, 10, 30\nC200, 20, 20, 50\n"

# It walks as programmed; a person sets its generator and changes electrodes.
SHOP = rig.NULL_MACHINE.replace("cpu = -1", "cpu = -1\noptional_stop = yes") + (
    "\n[axis.A]\npresent = no\n[axis.B]\npresent = no\n"
    "[tech]\ntable = shop.tech\n") + OF_PANEL
# No word of it can be done without a person.
STOPS = (b"G21 G90 F600\nG0 Z1\nM0 (turn the part)\nG0 Z2\nM1\nT3\nG0 Z3\nC200\n"
         b"G1 Z0\nG0 X60\nG1 Z-40 F8\nM30\n")

# Somebody sets its generator.
KNOBS = panel.CUT_MACHINE.replace("copper-steel.tech", "shop.tech") + (
    "\n[generator]\ninterface = none\nby_hand = on_us off_us\n")
SETS = b"G21 G90\nC200\nG1 Z-2 F30\nM30\n"

# A PLC, and a changer that it has.
WAITS = SHOP + """
[plc]
interface = can0
alive_ms = 5000
m_before = 6
m_timeout_s = 0
"""
WAITED = b"G21 G90 F600\nT3 M6\nG0 X60\nM30\n"

# Two drives, a gap, and a generator that tells what it has.
DRIVEN = can_bus.DRIVEN + """\
following_mm = 5
resync_mm = 10
gap_id = 1008

[gap]
servo_v = 15
feed_gain_mm_s_v = 0.1
feed_max_mm_s = 5
approach_mm_s = 1

[tech]
table = shop.tech

[generator]
interface = can
can_interface = can0
can_id = 1009
told_on_us = can 1011 byte 2 scale 0.1
silent_ms = 60000
confirm_s = 600


""" + "".join(f"[axis.{a}]\npresent = no\n" for a in "ZABC") + "".join(
    f"[axis.{a}]\ndrive_increments = 1000\ndrive_pulses = 1000\n"
    "travel_min_mm = -100\ntravel_max_mm = 100\nabsolute = yes\n"
    for a in "XY") + """
[jobs]
store = {store}
""" + OF_PANEL
POWERED = b"G21 G90\nG0 X1\nC200\nG1 X9 F60\nM30\n"
DRIVES = pathlib.Path(__file__).parents[1] / "vm/guest/drives.py"

# Each way takes so long that it can be looked at.
SLOW = panel.CUT_MACHINE.replace("height_mm = 1", "height_mm = 40") + "".join(
    f"\n[axis.{a}]\nv_max_mm_s = {v}\njog_mm_s = 0.5\n"
    for a, v in (("X", 5), ("Y", 5), ("Z", 1)))
DEEP = b"".join([b"G21 G90 G94\nT84\nM3\nC120\nG0 X20\nG0 X0 Y0 Z0\n"] + [
    f"G1 Z-{i / 10:.1f} F30\nG1 X{1 + i % 3} Y{i % 2}\nG3 X{-1 - i % 2} Y1 "
    f"R4\nG1 X0 Y0\n".encode() for i in range(1, 60)] + [b"M30\n"])

HOMED = """
[machine]
name = {name}
backend = sim
overrun_limit = 0
cpu = -1
require_home = yes

[axis.X]
home_method = switch
home_at_mm = -100
home_fast_mm_s = 0.5
travel_min_mm = -90

[axis.Y]
home_method = switch
home_at_mm = -100
travel_min_mm = -90

[sim]
home_off_mm = 12

[jobs]
store = {store}
""" + OF_PANEL

FEELS = PLATE.replace("speed = 20", "speed = 1") + OF_PANEL

WIRE = """
[machine]
name = {name}
strategy = point-by-point
overrun_limit = 0
cpu = -1
feed_default_mm_min = 5

[axis.Z]
present = no
[axis.A]
present = no
[axis.B]
present = no
[axis.C]
present = no

[wire]
guides = relative

[gap]
process = wire

[sim]
speed = 4
seed = 1
break_per_j = 0

[jobs]
store = {store}
""" + OF_PANEL
PLATE_CUT = b"G21 G90\nG1 X8 F5\nG1 Y8\nG1 X0\nG1 Y0\nM30\n"


def idle(c):
    for verb in ("hold", "reset", "stop"):
        c.ask(verb)
    c.status_where(lambda s: not s.job and s.state == "idle", 20)


def send(c, text, job, **more):
    a = c.submit(text, job, **more)
    assert a.code == 0, a.reason


def stand(c, name):
    return c.status_where(lambda s: s.stand == name, 20)


def moves(c):
    was = c.status().place_mm
    c.status_where(lambda s: s.place_mm > was, 20)


def stands(p):
    """Every reason to stand that needs neither a PLC nor a drive."""
    c = p.machine.client
    yield "idle", PAGES
    for n, words in ((1, "name=rough\nmaterial=copper\nlength=40\nlife=2"),
                     (3, "name=rib\nmaterial=graphite\nlength=32.5")):
        c.ask("electrode-add", arg=n, text=words)
    c.ask("electrode-use", arg=1)
    send(c, STOPS, "stops", name="plate 7.ngc", hold=True)
    stand(c, "ready")
    yield "ready", ("cut", "jobs", "setup", "tech")
    c.ask("start")
    stand(c, "stop")
    yield "stop", CUT
    c.ask("start")
    stand(c, "optional-stop")
    yield "optional-stop", CUT
    c.ask("start")
    stand(c, "electrode")
    yield "electrode", ("cut", "setup")
    c.ask("done", arg=3)
    c.status_where(lambda s: "3 is in" in s.asks)
    yield "electrode-done", CUT
    c.ask("override", arg=0)
    c.ask("start")
    stand(c, "override")
    yield "override", CUT
    c.ask("override", arg=1)
    c.status_where(lambda s: s.stand == "" and s.line == 11, 60)
    yield "walks", CUT
    c.ask("hold")
    stand(c, "held")
    yield "held", CUT
    c.ask("start")
    moves(c)
    c.ask("estop")
    c.status_where(lambda s: s.state == "fault")
    yield "fault", ("cut", "alarms")
    c.ask("reset")
    stand(c, "reset")
    yield "reset", CUT
    c.ask("start")
    moves(c)
    p.machine.come_back(lambda s: s.stand == "restart")
    yield "restart", ("cut", "alarms")
    c.ask("start")
    moves(c)
    for one in ("jobs", "edmd"):
        p.machine.kill(one)
    p.machine.sweep()
    p.machine.start()
    c.status_where(lambda s: s.interrupted, 20)
    yield "interrupted", ("cut", "jobs", "setup", "alarms")
    with p.session().live() as live:
        live.ask("remove", job="stops")
    c.status_where(lambda s: not s.interrupted, 20)
    yield "lost-place", ("cut", "setup", "alarms")


def sets(p):
    """A generator that a person sets."""
    c = p.machine.client
    send(c, SETS, "sets", name="rib.ngc")
    stand(c, "setting")
    yield "setting", CUT
    c.ask("done")
    c.status_where(lambda s: s.stand == "setting" and "done" not in s.asks)
    yield "setting-done", CUT


def cuts(p):
    """A die-sinker at its work, and what comes between."""
    c = p.machine.client
    c.ask("override", arg=0.1)
    send(c, DEEP, "deep", name="cavity-12.ngc")
    c.status_where(lambda s: s.state == "travel" and s.pos_mm[0] > 1, 60)
    yield "travel", CUT
    c.ask("override", arg=1)
    c.status_where(lambda s: s.state == "erode" and s.place_mm > 40.3, 200)
    for i in range(3):
        p.session().post(f"/api/jobs?name=next-{i}-%E7%94%B5.ngc&hold=1", DEEP)
    with p.session().live() as live:
        live.ask("set", text="servo_v", arg=18)
    c.status_where(lambda s: s.state == "erode", 60)
    yield "erode", PAGES
    c.status_where(lambda s: s.state == "jump", 200)
    yield "jump", CUT
    c.status_where(lambda s: s.state == "erode", 200)
    c.ask("retract", arg=3)
    c.status_where(lambda s: s.state == "hold" and not s.feed_mm_s, 60)
    yield "back", CUT
    c.ask("estop")
    c.status_where(lambda s: s.state == "fault")
    yield "fault-of-cut", ("cut", "alarms", "fleet")
    c.ask("reset")
    waits = [j.get("job") for j in panel.json.loads(c.ask("queue").body)][1]
    rig.fill_queue(p.machine, waits, 150)
    yield "queue-long", ("jobs",)
    with rig.store_of(p.machine) as db:
        db.execute("DELETE FROM job WHERE id LIKE 'job-%'")
    for job in panel.json.loads(c.ask("queue").body)[1:]:
        c.ask("remove", job["job"])
    idle(c)
    yield "history", ("jobs",)


def waits(p):
    """What a PLC does, and what it holds."""
    c, plc = p.machine.client, can_bus.Plc(p.bus)
    for n in (1, 3):
        c.ask("electrode-add", arg=n, text="name=rib")
    send(c, WAITED, "waits", name="plate 7.ngc", hold=True)
    stand(c, "ready")
    c.ask("start")
    stand(c, "m-code")
    yield "m-code", CUT
    plc.done = 6
    moves(c)
    plc.done = 0
    plc.hold(True)
    stand(c, "plc")
    yield "plc", CUT
    plc.hold(False)
    rig.until(lambda: c.ask("start").code == 0)
    moves(c)


def powers(p):
    """What is waited for by itself: a brake, and a generator."""
    c, drives = p.machine.client, p.folder / "drives"
    p.bus.loop(lambda: p.bus.tell(1011, bytes(8)))      # no on time yet
    send(c, POWERED, "powers", name="rib.ngc", hold=True)
    stand(c, "ready")
    drives.write_text("brake 1 100000\ngap 60\n")
    rig.until(lambda: c.ask("start").code == 0)
    stand(c, "power")
    yield "power", CUT
    drives.write_text("brake 1 5\n")
    stand(c, "generator")
    yield "generator", CUT


def homes(p):
    """A machine that has to be homed."""
    c = p.machine.client
    yield "unhomed", ("cut", "setup")
    c.ask("jog", text="Y", arg=20.0)
    c.status_where(lambda s: s.state == "jog")
    yield "jog", ("cut", "setup")
    c.ask("hold")
    c.status_where(lambda s: s.state == "idle", 20)
    c.ask("home")
    c.status_where(lambda s: s.state == "home")
    yield "home", ("cut", "setup")
    c.ask("hold")
    c.status_where(lambda s: s.state == "idle", 20)


def feels(p):
    """Touching off a plate."""
    c = p.machine.client
    p.machine.ctl("mdi", "G53 G0 X30 Y0")
    p.machine.ctl("offset", "G54", "Z=probe-9", "Z=0", timeout=300)
    yield "touched", ("setup",)
    send(c, b"G21 G90\nG53 G0 Z10\nG38.2 Z-20 F12\nM30\n", "feel",
             name="feel.ngc")
    c.status_where(lambda s: s.state == "probe", 60)
    yield "probe", CUT


def wires(p):
    c = p.machine.client
    yield "wire-idle", ("cut", "setup")
    send(c, PLATE_CUT, "die", name="die-plate.ngc")
    c.status_where(lambda s: s.state == "erode" and s.place_mm > 0.2, 120)
    yield "wire", ("cut", "jobs")


def gone(p):
    """What answers no more, one thing after another."""
    m, sig = p.machine, panel.signal
    m.jobs.send_signal(sig.SIGSTOP)
    rig.until(lambda: not_heard(p))
    yield "no-jobs", CUT
    m.jobs.send_signal(sig.SIGCONT)
    m.client.status_where(lambda s: s.daemon == "ok", 20)
    m.kill("edmd")
    m.client.status_where(lambda s: s.daemon != "ok", 20)
    yield "no-edmd", PAGES
    m.start_edmd()
    m.client.status_where(lambda s: s.daemon == "ok", 20)


def not_heard(p):
    with p.session().live() as live:
        live.where(lambda s: "jobs" in s)
        return not live.state["jobs"]


# Name, machine file, how fast it is, walk.
WALKS = {
    "stands": (SHOP, 1, stands),
    "sets": (KNOBS, 1, sets),
    "cuts": (SLOW, 1, cuts),
    "waits": (WAITS, 1, waits),
    "powers": (DRIVEN, 1, powers),
    "homes": (HOMED, 1, homes),
    "feels": (FEELS, 1, feels),
    "wires": (WIRE, 1, wires),
    "gone": (SHOP, 1, gone),
}

def machine_of(walk, folder):
    config, speed, _ = WALKS[walk]
    p = panel.Panel(folder, speed=speed, config=config)
    (p.folder / "shop.tech").write_text(TABLE)
    if "can0" in config:
        p.bus = p.beside.enter_context(can_bus.Bus(folder))
        p.machine.env = lambda program: p.bus.env()
    if "node_X" in config:
        os.mkfifo(p.folder / "drives")
        p.beside.enter_context(p.bus.program(
            sys.executable, DRIVES, "can0", p.folder / "drives", "--every",
            0.02, 1, 2))
    return p
