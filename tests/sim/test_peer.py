# SPDX-License-Identifier: Apache-2.0
"""Random programs end their segments where LinuxCNC's interpreter does.

rs274 (Debian package linuxcnc-uspace) prints its canonical calls: end points
without offsets, in the units in force, four decimals.  All coordinates here
are multiples of 0.0254 mm, a thousandth of an inch, so those are exact in both
units.  edmsim's ends are read from the pulses of a machine whose pulse is
0.1 um.
"""
import math
import re
import subprocess

import pytest
from edmsim import HANGS_S, PROGRAM, seeded
from rs274 import canonical_calls, peer

PROGRAMS = 12
SEGMENTS = 60
GRID_MM = 0.0254
PULSE_MM = 0.0001
REACH = 25			# grid steps
TOLERANCE_MM = 1e-4
G54 = 3, -2, 5			# grid steps

pytestmark = peer

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
CENTRES = "IJK"
# Points on a circle, grid steps from its centre.
CIRCLE = [(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3),
          (-3, -4), (0, -5), (3, -4), (4, -3)]


class Writer:
    """A random program, and where it is, in grid steps."""

    def __init__(self, rnd):
        self.rnd = rnd
        self.at = [-n for n in G54]	# machine place less G54
        self.g92 = [0, 0, 0]
        self.inch = self.incremental = False
        self.plane = 17
        self.text = ["G21 G17 G90 G54 F100"]
        self.motions = []		# line numbers

    def number(self, steps):
        return f"{steps / 1000:.3f}" if self.inch else \
               f"{steps * GRID_MM:.4f}"

    def words(self, to, axes):
        ret = []
        for i in axes:
            n = to[i] - (self.at[i] if self.incremental else self.g92[i])
            ret.append("XYZ"[i] + self.number(n))
        return " ".join(ret)

    def say(self, text, motion=False):
        self.text.append(text)
        if motion:
            self.motions.append(len(self.text))

    def switch(self):
        pick = self.rnd.randrange(5)
        if pick == 0:
            self.inch = not self.inch
            self.say("G20 F4" if self.inch else "G21 F100")
        elif pick == 1:
            self.incremental = not self.incremental
            self.say("G91" if self.incremental else "G90")
        elif pick == 2:
            self.plane = self.rnd.choice(list(PLANES))
            self.say(f"G{self.plane}")
        elif pick == 3:
            i, n = self.rnd.randrange(3), self.rnd.randint(-9, 9)
            self.say("G92 " + "XYZ"[i] + self.number(n))
            self.g92[i] = self.at[i] - n
        else:
            self.say("G92.1")
            self.g92 = [0, 0, 0]

    def line(self):
        to = [self.rnd.randint(-REACH, REACH) for _ in range(3)]
        self.say(f"G{self.rnd.randrange(2)} " + self.words(to, range(3)), True)
        self.at = to

    def arc(self):
        a, b, c = PLANES[self.plane]
        p, q = self.rnd.sample(CIRCLE, 2)
        to = list(self.at)
        to[a] += q[0] - p[0]
        to[b] += q[1] - p[1]
        to[c] += self.rnd.choice((0, 0, self.rnd.randint(-5, 5)))
        g = self.rnd.choice((2, 3))
        turn = (math.atan2(q[1], q[0]) - math.atan2(p[1], p[0])) % math.tau
        if g == 2:
            turn = math.tau - turn
        if self.rnd.random() < 0.4 and abs(turn - math.pi) > 1e-6:
            centre = "R" + self.number(5 if turn < math.pi else -5)
        else:
            centre = CENTRES[a] + self.number(-p[0]) + " " + \
                     CENTRES[b] + self.number(-p[1])
        self.say(f"G{g} {self.words(to, (a, b, c))} {centre}", True)
        self.at = to

    def write(self):
        while len(self.motions) < SEGMENTS:
            self.rnd.choice((self.switch, self.line, self.arc, self.arc))()
        return "\n".join(self.text + ["M2", ""])


def parameters():
    """rs274's own file, in inches: G54 is 5221 to 5229."""
    numbers = [*range(5161, 5170), *range(5181, 5190), *range(5210, 5221)]
    numbers += [b + i for b in range(5221, 5382, 20) for i in range(10)]
    value = {5220: 1, **{5221 + i: n / 1000 for i, n in enumerate(G54)}}
    return "".join(f"{n}\t{value.get(n, 0):.6f}\n" for n in sorted(numbers))


CALL = re.compile(r"N\S+ +([A-Z0-9_]+)\((.*)\)")


def ends_of_rs274(tmp_path, text):
    job = tmp_path / "job.ngc"
    job.write_text(text)
    (tmp_path / "rs274.var").write_text(parameters())
    out = canonical_calls(job, "-v", "rs274.var")
    assert "_FEED(" in out, out
    unit, plane, ends = 1.0, 17, []
    offset = {"SET_G5X_OFFSET": [0] * 3, "SET_G92_OFFSET": [0] * 3}
    for call, args in CALL.findall(out):
        args = [a.strip() for a in args.split(",")]
        if call == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCHES" in args[0] else 1.0
        elif call == "SELECT_PLANE":
            plane = {"XY": 17, "XZ": 18, "YZ": 19}[args[0][-2:]]
        elif call in offset:
            args = args[-6:]
            offset[call] = [float(a) * unit for a in args[:3]]
        elif call in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            ends.append([float(a) * unit for a in args[:3]])
        elif call == "ARC_FEED":
            a, b, c = PLANES[plane]
            end = [0.0] * 3
            end[a], end[b], end[c] = (float(args[i]) * unit
                                      for i in (0, 1, 5))
            ends.append(end)
        else:
            continue
        if call.startswith(("STRAIGHT", "ARC")):
            ends[-1] = [e + sum(o[i] for o in offset.values())
                        for i, e in enumerate(ends[-1])]
    return ends


def machine():
    """No line is so short that it has no pulses."""
    text = ""
    for i, axis in enumerate("XYZ"):
        text += f"[axis.{axis}]\npulse_mm = {PULSE_MM}\n"
        text += "travel_min_mm = -50\ntravel_max_mm = 50\n"
    text += "[work.G54]\n"
    for i, axis in enumerate("xyz"):
        text += f"{axis} = {G54[i] * GRID_MM:.4f}\n"
    return text


def ends_of_edmsim(tmp_path, text, motions):
    """The last place of each line; a line of no length ends where it began."""
    (tmp_path / "job.ngc").write_text(text)
    (tmp_path / "m.ini").write_text(machine())
    with subprocess.Popen([PROGRAM, "--quiet", "--dry-run", "--machine",
                           "m.ini", "--pulses", "-", "job.ngc"], cwd=tmp_path,
                          stdout=subprocess.PIPE) as p:
        last = subprocess.run(
            ["awk", "-F,", "NR > 1 { at[$2] = $3 \" \" $4 \" \" $5 } "
             "END { for (n in at) print n, at[n] }"],
            stdin=p.stdout, capture_output=True, text=True, timeout=HANGS_S).stdout
    assert p.returncode == 0
    place = {}
    for row in last.splitlines():
        line, *xyz = map(int, row.split())
        place[line] = [n * PULSE_MM for n in xyz]
    ends, at = [], [0, 0, 0]
    for line in motions:
        at = place.get(line, at)
        ends.append(at)
    return ends


def test_segments_end_where_linuxcnc_ends_them(tmp_path):
    rnd = seeded()
    for _ in range(PROGRAMS):
        w = Writer(rnd)
        text = w.write()
        theirs = ends_of_rs274(tmp_path, text)
        ours = ends_of_edmsim(tmp_path, text, w.motions)
        assert len(theirs) == len(ours) == SEGMENTS
        for line, a, b in zip(w.motions, theirs, ours):
            off = max(abs(p - q) for p, q in zip(a, b))
            assert off <= TOLERANCE_MM, (line, w.text[line - 1], a, b)
        known = [(n + g) * GRID_MM for n, g in zip(w.at, G54)]
        assert ours[-1] == pytest.approx(known, abs=TOLERANCE_MM)
