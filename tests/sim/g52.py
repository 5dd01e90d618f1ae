# SPDX-License-Identifier: Apache-2.0
"""g52.py - one G5.2 curve as LinuxCNC moves along it and as edmsim does.

rs274 would not do: it prints NURBS_FEED whole, and what becomes of that is
decided behind it.  So LinuxCNC itself runs, without a real-time kernel, and
its position is sampled every millisecond.

How far a path is from its curve is measured on the curve as geomdl evaluates
it.
"""
import itertools
import math
import re
import shutil
import subprocess
from dataclasses import dataclass

import edmsim
from geomdl import NURBS

ROOT = edmsim.ROOT
LIMIT_S = 120
F = 600
PULSES_OFF = math.sqrt(0.5)	# the most of a lattice point in two axes
REST = "G4 P0.02"	# before and behind a curve
REST_ROWS = 5
CURVE_POINTS = 100000	# of the curve: their chords are 2e-5 um off it


@dataclass
class Curve:
    name: str
    order: int
    rows: list		# (x, y, weight), mm; the first weighs 1


CURVES = [
    Curve("quarter of a circle, radius 10 mm", 3,
          [(10, 0, 1), (10, 10, math.sqrt(0.5)), (0, 10, 1)]),
    Curve("wave of 90 mm", 4,
          [(0, 0, 1), (30, 40, 1), (45, -40, 1), (60, 40, 1), (90, 0, 1)]),
    Curve("hook with weights from 1 to 6", 4,
          [(0, 0, 1), (20, 0, 6), (24, 8, 2), (12, 12, 6), (8, 5, 3),
           (14, 5, 1)]),
]


def blade():
    """examples/blade.ngc: its knots are as even as those of G5.2."""
    text = (ROOT / "examples/blade.ngc").read_text()
    points = re.findall(r"^(?:G6\.2 P4 )?K\S+ X(\S+) Y(\S+)$", text, re.M)
    return Curve("`examples/blade.ngc`", 4,
                 [(float(x), float(y), 1) for x, y in points])


def gcode(curve):
    (x, y, _), first, *more = curve.rows
    return "\n".join(
        [f"G0 X{x} Y{y}", REST,
         "G5.2 X{} Y{} P{} L{}".format(*first, curve.order),
         *("X{} Y{} P{}".format(*row) for row in more), "G5.3", REST,
         ""])


def program(curves):
    """G61: LinuxCNC keeps to its path, else it rounds corners."""
    return f"G21 G17 G90 G61 F{F}\n" + "".join(map(gcode, curves)) + "M2\n"


# -- LinuxCNC ----------------------------------------------------------------

MACHINE = """[EMC]
VERSION = 1.1
[DISPLAY]
DISPLAY = ./ui
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = job.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = tool.tbl
[HAL]
HALFILE = motion.hal
[TRAJ]
NO_FORCE_HOMING = 1
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 100
[KINS]
KINEMATICS = trivkins
JOINTS = 3
"""
LIMITS = """MIN_LIMIT = -1000
MAX_LIMIT = 1000
MAX_VELOCITY = 100
MAX_ACCELERATION = 1000
"""
JOINT = "TYPE = LINEAR\nFERROR = 1000\nMIN_FERROR = 1000\n" + LIMITS

# Drives that stand where they are sent, and a row of X, Y and kind of motion a
# period.
HAL = """loadrt trivkins
loadrt motmod servo_period_nsec=1000000 num_joints=3
loadrt sampler depth=20000 cfg=ffs
net x joint.0.motor-pos-cmd joint.0.motor-pos-fb sampler.0.pin.0
net y joint.1.motor-pos-cmd joint.1.motor-pos-fb sampler.0.pin.1
net z joint.2.motor-pos-cmd joint.2.motor-pos-fb
net kind motion.motion-type sampler.0.pin.2
net on iocontrol.0.user-enable-out iocontrol.0.emc-enable-in
addf motion-command-handler servo-thread
addf motion-controller servo-thread
addf sampler.0 servo-thread
loadusr halsampler moves.txt
"""
FEEDS = "2", "3"	# kinds of motion: along a line, along an arc

# LinuxCNC has one lock file in /tmp, shared memory of fixed keys, a port, and
# ends what it started by name: here each is its own, and ends with it.  As
# root it does not run.
OWN = [ROOT / "tests/netns", "unshare", "--ipc", "--pid", "--fork",
       "--kill-child", "--mount", "--mount-proc", "sh", "-c",
       "mount --bind . /tmp && cd /tmp && exec unshare --user "
       "--map-user=1000 --map-group=1000 env HOME=/tmp linuxcnc -r job.ini"]


class NoLinuxcnc(Exception):
    """Why it did not run here."""


def machine():
    return MACHINE + "".join(
        f"[AXIS_{axis}]\n{LIMITS}[JOINT_{joint}]\n{JOINT}"
        for joint, axis in enumerate("XYZ"))


def run_linuxcnc(folder, text):
    """Rows of a program's motion: x, y, kind; and LinuxCNC's version."""
    if not shutil.which("linuxcnc"):
        raise NoLinuxcnc("it is not installed: apt install linuxcnc-uspace")
    shutil.copy(ROOT / "tests/peer/linuxcnc_ui", folder / "ui")
    for name, content in (("job.ngc", text), ("job.ini", machine()),
                          ("motion.hal", HAL), ("job.var", ""),
                          ("tool.tbl", ""), ("moves.txt", "")):
        (folder / name).write_text(content)
    try:
        said = subprocess.run(OWN, cwd=folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=LIMIT_S).stdout
    except subprocess.TimeoutExpired:
        raise NoLinuxcnc(f"it did not end in {LIMIT_S} s") from None
    ui = re.search(r"linuxcnc_ui: (done|.*)(?: with (.*))?", said)
    # The last row may be cut short where its writer was ended.
    rows = [row.split() for row in
            (folder / "moves.txt").read_text().splitlines()[:-1]]
    if not ui or ui[1] != "done" or ["overrun"] in rows:
        raise NoLinuxcnc(ui[1] if ui else (said.splitlines() or ["?"])[-1])
    return rows, ui[2]


def paths_of_linuxcnc(folder, curves):
    """The points of each curve, mm, and LinuxCNC's version."""
    rows, version = run_linuxcnc(folder, program(curves))
    paths = []
    for cut, group in itertools.groupby(range(len(rows)),
                                        lambda i: rows[i][2] in FEEDS):
        if cut:
            first, *_, last = group
            paths.append([(float(x), float(y))
                          for x, y, _ in rows[first - 1:last + REST_ROWS]])
    if len(paths) != len(curves):
        raise NoLinuxcnc(f"{len(paths)} curves came of {len(curves)}")
    return paths, version


# -- Ours --------------------------------------------------------------------

def path_of_edmsim(folder, curve, pulse_mm):
    """The lattice points of a curve, mm."""
    (folder / "m.ini").write_text("".join(
        f"[axis.{axis}]\npulse_mm = {pulse_mm}\n"
        "travel_min_mm = -100\ntravel_max_mm = 100\n" for axis in "XY"))
    rows = edmsim.pulses("--dry-run", "--machine", folder / "m.ini",
                         text=program([curve]).replace(" G61", ""))
    # Line 2 is the rapid; it may have no length.
    start = [(0,) * 9, *(row for row in rows if row[0] <= 2)][-1:]
    return [(x * pulse_mm, y * pulse_mm)
            for _, x, y, *_ in start + [row for row in rows if row[0] > 2]]


# -- How far off -------------------------------------------------------------

def true_points(curve):
    c = NURBS.Curve(normalize_kv=False)
    c.degree = degree = curve.order - 1
    c.ctrlptsw = [[x * w, y * w, w] for x, y, w in curve.rows]
    spans = len(curve.rows) - degree
    c.knotvector = [min(max(i / spans, 0), 1)
                    for i in range(-degree, spans + degree + 1)]
    c.sample_size = CURVE_POINTS
    return c.evalpts


def to_line(p, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy)
    t = min(max(t, 0), 1)
    return math.dist(p, (a[0] + t * dx, a[1] + t * dy))


def off_mm(path, true):
    """The farthest point of a path from its curve.

    The foot goes along the curve as the path does, so a path that leaves a
    part of the curve out is far off.
    """
    i, most = 1, 0
    for p in path:
        while i < len(true) - 2 and \
                math.dist(p, true[i + 1]) <= math.dist(p, true[i]):
            i += 1
        most = max(most, min(to_line(p, a, b) for a, b in
                             itertools.pairwise(true[i - 1:i + 2])))
    return max(most, math.dist(path[0], true[0]), math.dist(path[-1], true[-1]))
