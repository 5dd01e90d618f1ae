# SPDX-License-Identifier: Apache-2.0
"""The virtual machine: one boot a mode, its tests read what the guest wrote.

Each mode has a script in guest/, which runs as root in a folder that guest and
host share and leaves one file a result there.  The folders stay in
build-vm/runs, with the kernel's log in .vm/console.
"""

import os
import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = (ROOT / os.environ.get("EDM_BUILD", "build")).resolve()
BUILD_VM = ROOT / "build-vm"
BUILD2 = ROOT / "build-gpiod2"

ABSENT = "".join(f"[axis.{a}]\npresent = no\n" for a in "ABCUV")

HEAD = """
[machine]
name = vm
backend = {backend}
period_us = {period_us}
overrun_limit = 0
cpu = {cpu}
[jump]
height_mm = 0
"""

# 1 um a pulse, a pulse in two periods: so fast and no faster.
AXES = "".join(
    f"[axis.{a}]\nv_max_mm_s = {{v}}\n" for a in "XYZ") + ABSENT

LINES = """
[gpio]
chip = sim0
step_X = 0
dir_X = 1
step_Y = 2
dir_Y = 3
step_Z = 4
dir_Z = !5
"""

GAP = LINES + """
spark = sim1:0
watchdog = sim1:1
pump = 7
estop = 16
limit_X = 17
limit_Y = 17
door = 18
dielectric = 19
gap_open = 20
gap_spark = 21
gap_short = 22
[gap]
source = lines
retract_wait_s = 60
"""

# A generator on the rest of the second chip.
GENERATOR = GAP.replace("pump = 7\n", "") + """
[generator]
interface = lines
peak_a = lines sim1:2 sim1:3 !sim1:4 weights 3 6 12
on_us = lines sim1:5 sim1:6 codes 2 4 8 16
polarity = line sim1:7
pump = line sim1:8
sense = line sim1:9
settle_ms = 50
polarity_ms = 100
[tech]
table = levels.tech
"""

LEVELS = """condition, peak_a [A], on_us [us], polarity
C001, 6, 8, 1
C002, 16, 4, -1
C003, 16, 16, -1
"""

LEVELS_JOB = ("G21 G90 T84\nC001\nG1 X0.02 F6\nC002\nG1 X0.04\nC003\nG1 X0.06\n"
              "C001\nG1 X0.04\nM30\n")
FEEL_JOB = "G21 G90\nC001\nG80 X+\nM30\n"

# Two counts of the encoder are a pulse.
ENCODER = LINES + """
encoder_X = 24 25
following_mm = 0.02
resync_mm = 0.1
enable = 27
brake_X = 26
brake_ms = 50
[axis.X]
encoder_counts = 2
"""

ADC = LINES + """
spark = sim1:0
watchdog = sim1:1
estop = 16
adc = adc-sim
adc_ratio = 80
[gap]
source = voltage
"""

QUICK_JOB = "G21 G90\nG1 X0.02 F6\nG1 X0\nM30\n"
# Nobody sees its end, however slow the host is.
SLOW_JOB = "G21 G90\nG1 X100 F2\nG1 X0\nM30\n"

# Every octant, both directions of each axis, an arc each way, three axes.
PULSES_JOB = """G21 G90 G17
G1 X0.3 Y0.1 F240
G1 X0.35 Y0.4
G3 X0.15 Y0.6 I-0.2 J0
G1 X-0.1 Y0.5 Z-0.2
G1 X-0.3 Y0.05 Z0.1
G2 X-0.1 Y-0.15 I0.2 J0
G1 X0.05 Y-0.3
G0 Z0.2
G0 X0 Y0
G1 Z0
M30
"""

# 50000 pulses at half a pulse a period: 100000 periods.
LINE_JOB = "G21 G90\nG1 X50 F300\nM30\n"


# Under emulation 5 ms leave time for the rest.
def machine(backend="gpio", period_us=5000, cpu=-1, v=0.1, tail=LINES):
    return (HEAD.format(backend=backend, period_us=period_us, cpu=cpu) +
            AXES.format(v=v) + tail)


class Run:
    """What one boot left.  @limit: s of the host, ends what hangs; it is far
    above what a run needs, because a busy host is slow."""

    def __init__(self, mode, files, *options, limit=7200, copies=()):
        self.folder = BUILD_VM / "runs" / mode
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        lib2 = next((BUILD_VM / "libgpiod2").glob("usr/lib/*/libgpiod.so.3"))
        files = files | {
            "env": f"BUILD={BUILD}\nBUILD2={BUILD2}\nLIB2={lib2.parent}\n"
                   f"PYTHON={ROOT / '.venv/bin/python3'}\n",
            "lib.sh": (HERE / "guest/lib.sh").read_text(),
        }
        for name, text in files.items():
            (self.folder / name).write_text(text)
        for path in copies:
            to = self.folder / path.name
            (shutil.copytree if path.is_dir() else shutil.copy)(path, to)
        units = self.folder / "root/usr/lib/systemd/system"
        if units.is_dir():
            shutil.copytree(units, self.folder / "units")
        p = subprocess.run(
            [HERE / "vm-run", *options, "-t", str(limit), self.folder,
             HERE / f"guest/{mode}.sh"],
            env=os.environ | {"VM_BUILD": str(BUILD_VM)},
            capture_output=True, text=True)
        self.status, self.output = p.returncode, p.stdout + p.stderr

    def text(self, name):
        return (self.folder / name).read_text()

    def words(self, name):
        """Lines of "KEY VALUE" as a dict."""
        return dict(line.split(" ", 1)
                    for line in self.text(name).splitlines() if " " in line)


VIRTUAL = {
    "step.ini": machine(period_us=100, v=5),
    "slow.ini": machine(period_us=100, v=1,
                        tail=LINES + "high_cycles = 3\nlow_cycles = 2\n"
                        "dir_setup_cycles = 4\ndir_hold_cycles = 5\n"),
    "quadrature.ini": machine(period_us=100, v=5,
                              tail=LINES + "signal = quadrature\n"),
    "line.ini": machine(period_us=100, v=5),
    "stop.ini": machine(period_us=1000, tail=GAP),
    "pulses.ngc": PULSES_JOB,
    "line.ngc": LINE_JOB,
    "stop.ngc": SLOW_JOB,
}


# 40 writes in a period: a pulse in 50 us at the most, and in 12.5 us.
EDGES = {
    "edges.ini": machine(period_us=1000, v=20,
                         tail=LINES + "edges_per_period = 40\n"),
    "even.ini": machine(period_us=1000, v=20,
                        tail=LINES + "edges_per_period = 40\n"),
    "fast.ini": machine(period_us=250, v=80,
                        tail=LINES + "edges_per_period = 40\n"),
    "edges.ngc": PULSES_JOB.replace("F240", "F900"),
    "even.ngc": "G21 G90\nG1 X2 F600\nG1 X0\nM30\n",
    "fast.ngc": "G21 G90\nG1 X16 F3600\nM30\n",
}

# Increments and pulses of each drive: a fine encoder, turned round, coarse ...
DRIVES = {"X": (1, 524288, 5000), "Y": (2, -65536, 10000), "Z": (3, 10, 1),
          "A": (4, 3, 7), "B": (5, -1, 1), "C": (6, 1000, 360)}


def brake_of(axis, falls, braked):
    return "none" if axis in falls else "line" if axis in braked else "free"


def drives(axes, tail="", absolute="yes", falls="", braked=""):
    """A machine of drives, as many as there are letters."""
    nodes = "".join(f"node_{a} = {DRIVES[a][0]}\n" for a in axes)
    ratios = "".join(f"[axis.{a}]\ndrive_increments = {DRIVES[a][1]}\n"
                     f"drive_pulses = {DRIVES[a][2]}\n"
                     "travel_min_mm = -100\ntravel_max_mm = 100\n"
                     f"brake = {brake_of(a, falls, braked)}\n"
                     f"absolute = {absolute}\n"
                     for a in axes)
    absent = "".join(f"[axis.{a}]\npresent = no\n"
                     for a in "XYZABCUV" if a not in axes)
    return ("[machine]\nname = vm\nbackend = can402\nperiod_us = 10000\n"
            "overrun_limit = 5\n[jump]\nheight_mm = 0\n"
            f"[can402]\ninterface = vcan0\n{nodes}{tail}{ratios}{absent}")


GAP_FRAMES = """gap_id = 1008
following_mm = 0.05
[generator]
interface = can
can_interface = vcan0
can_id = 1009
[gap]
servo_v = 15
feed_gain_mm_s_v = 0.1
feed_max_mm_s = 5
approach_mm_s = 1
"""


# A PLC on the drives' own bus.
SHARED = """[plc]
interface = vcan0
alive_ms = 500
"""


# A strict drive each: what the machine file has to say of it.
STRICT_UP = """[axis.X]
drive_window_mm = 0.5
[axis.Y]
drive_fault_reaction = 1
[axis.Z]
drive_quick_stop_mm_s2 = 500
[axis.A]
drive_identity = fb 64100000 x 4d
drive_sdo = 6085:0=7a120/4 605e:0=1/2
drive_leave = 6502
"""

STRICT_HOME = "following_mm = 0.05\n" + "".join(
    f"[axis.{axis}]\nhome_method = drive\ndrive_home = {method}\n"
    f"home_at_mm = {at}\nhome_fast_mm_s = 20\nhome_slow_mm_s = 1\n"
    for axis, method, at in (("X", 17, -3), ("Y", 2, 5), ("Z", 37, 2)))

STRICT_INPUTS = """following_mm = 0.05
[axis.X]
drive_inputs = limit_low:0 limit_high:1 home:2
home_method = switch
home_dir = -
home_fast_mm_s = 20
home_slow_mm_s = 1
home_at_mm = -3
[axis.Y]
drive_inputs = estop:!16
[jump]
v_max_mm_s = 20
"""

STRICT_MARKS = "following_mm = 0.05\n" + "".join(
    f"[axis.{axis}]\ndrive_inputs = {inputs}\nhome_method = switch-index\n"
    f"home_dir = -\nhome_at_mm = {at}\nhome_fast_mm_s = 20\n"
    "home_slow_mm_s = 1\n" for axis, inputs, at in (
        ("X", "home:2", -3), ("Y", "home:2", 4)))

COMMISSION = drives("XYZ", GAP_FRAMES + """[axis.X]
drive_inputs = limit_low:0 limit_high:1 home:2
home_method = switch
home_dir = -
home_fast_mm_s = 20
home_slow_mm_s = 5
[axis.Y]
drive_inputs = estop:!16
[jump]
v_max_mm_s = 20
""", "no").replace("_mm = -100", "_mm = -25").replace("_mm = 100", "_mm = 25")

UNRULY_SCENES = os.environ.get(
    "EDM_SCENES", "power,says,slow,plc,stranger,flood,jam,wall,odd,absolute").split(",")

STRICT_REFUSED = """[axis.C]
drive_inputs = home:2
home_method = switch-index
[axis.B]
drive_inputs = home:2
[axis.Z]
drive_identity = 1111
"""


def lagging(method):
    """Two drives that follow by gains of 30 and 21.5 1/s: what those come to
    where a target is held for 10 ms is what identification would find."""
    return drives("XY", "following_s = 0.1\n"
                  f"[contour]\nmethod = {method}\ncross_1_s = 4\n"
                  "[axis.X]\nloop_gain_1_s = 25.9\nloop_hz = 1000\n"
                  "[axis.Y]\nloop_gain_1_s = 19.3\nloop_hz = 1000\n")


# Slow to brake: from 10 mm/s in 0.5 mm.
BRAKES = ("[axis.X]\na_max_mm_s2 = 100\n[axis.Y]\na_max_mm_s2 = 100\n"
          "[gpio]\nchip = sim0\nbrake_Z = 26\nbrake_ms = 100\n")

# The shipped machine whose generator is on lines, at the pace of the guest.
CAN402_LINES = (ROOT / "examples/machine-can402-lines.ini").read_text()
for was, now in (("name = edm", "name = vm"), ("period_us = 2000", "period_us = 10000"),
                 ("interface = can0", "interface = vcan0"),
                 ("pinctrl-rp1", "sim0"), ("copper-steel.tech", "lines.tech"),
                 ("brake = drive", "brake = free")):
    assert was in CAN402_LINES, was
    CAN402_LINES = CAN402_LINES.replace(was, now)
CAN402_LINES += "feed_gain_mm_s_v = 0.1\nfeed_max_mm_s = 5\napproach_mm_s = 1\n"

LINES_TECH = """condition, peak_a [A], on_us [us], off_us [us], ignition_v [V], servo_v [V], iso
C001, 6, 8, 20, 180, 15, 0
C002, 30, 40, 100, 120, 20, 1
C003, 21, 20, 50, 180, 18, 0
"""
LINES_CUT = ("G21 G90 T84\nC001\nG1 X1 F60\nC002 M4\nG1 X2\nC003\nG1 X3\n"
             "C001 M3\nG1 X4\nM30\n")

CUT = "G21 G90\nG1 X10 Y3 F60\nM30\n"
TO_AND_FRO = "G21 G90\nG1 X4 Y1.2 F60\nG1 X0 Y0\nM30\n"
FAR = "G21 G90\nG1 X8 Y2.4 F60\nG1 X0 Y0\nM30\n"     # no harm outlasts it
CIRCLE = "G21 G90 G17\nG3 X0 Y0 I-2 J0 F600\nM30\n"
ROUNDS = "G21 G90 G17\n" + 5 * "G3 X0 Y0 I-2 J0 F600\n" + "M30\n"


def checked(run):
    assert run.status == 0, run.output
    return run
