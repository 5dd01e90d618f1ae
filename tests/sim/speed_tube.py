# SPDX-License-Identifier: Apache-2.0
"""speed_tube.py - what a motion asks of each axis, within the rounding

No axis follows what lies within a rounding.  So the question is whether there is
a motion of each axis that is near to where it was sent, each moment, and within
its limits.  The least share of its limits that suffices is found by a linear
program.  Nothing else is known here: neither how the program was made, nor how
its speed was.
"""
import importlib.util
import math
import re
import sys

import numpy as np

from edmsim import ROOT

TOLERANCE_MM, CORNER_MM = 0.001, 0.005      # [speed], as by default
DT_S = 1e-3             # between two samples
RATE_MOST = 20          # beside the path, a rounding of it counts so often


def limits_module():
    """The judge that users have.  By its path: tests of messages have another
    package of the name edm."""
    path = ROOT / "clients/python/edm/limits.py"
    spec = importlib.util.spec_from_file_location("edm_limits", path)
    sys.modules[spec.name] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


judge = limits_module()
least_share = judge.least_share


class Way:
    """A program of lines: its nodes, by the way along it."""

    def __init__(self, program):
        at, s = dict.fromkeys("XYZABC", 0.0), 0.0
        self.axes = sorted({a for line in program.lines[1:]
                            for a, _ in read(line)})
        self.s, self.nodes = [s], [[0.0] * len(self.axes)]
        self.parts = {}                 # of each curve, its nodes
        for number, line in enumerate(program.lines, 1):
            to = {**at, **dict(read(line))}
            way = math.dist([at[a] for a in "XYZ"], [to[a] for a in "XYZ"])
            at = to
            if not way:
                continue
            s += way
            self.s.append(s)
            self.nodes.append([at[a] for a in self.axes])
            if number in program.curve_of:
                part = self.parts.setdefault(program.curve_of[number],
                                             [len(self.s) - 2, 0])
                part[1] = len(self.s) - 1
        self.s, self.nodes = np.array(self.s), np.array(self.nodes)

    def sag_mm(self, k, first, last):
        """How far lines may be from their curve: by what they turn by."""
        x = self.nodes[first:last + 1, k]
        return np.abs(np.diff(x, 2)).max() / 8 if len(x) > 2 else 0

    def width(self, k, first, last, rate):
        """How near to its place on the lines axis @k has to be."""
        sag = min(self.sag_mm(k, first, last), CORNER_MM)
        beside = self.axes[k] not in "XYZ"
        return TOLERANCE_MM * (1 + (min(rate, RATE_MOST) if beside else 0)) + \
            (sag if sag > TOLERANCE_MM else 0)


def read(line):
    return [(a, float(v)) for a, v in
            re.findall(r"([XYZABC])(-?[\d.]+)", line)]


def windows(way, s):
    """Of all samples @s between two corners; each a first and a last one."""
    for first, last in way.parts.values():
        at = np.nonzero((s >= way.s[first] - 1e-9) &
                        (s <= way.s[last] + 1e-9))[0]
        for some in judge.windows(at):
            if len(some) >= judge.LEAST:
                yield some[0], some[-1]


def shares(way, s, limits, dt):
    """The places @s along @way, a time @dt apart.  Return: for each axis the
    largest share of its limits that is needed, and at which place."""
    ret = dict.fromkeys(way.axes, (0.0, 0.0))
    for a, b in windows(way, s):
        first, last = np.searchsorted(way.s, (s[a] + 1e-9, s[b] - 1e-9))
        for k, axis in enumerate(way.axes):
            x = np.interp(s[a:b + 1], way.s, way.nodes[:, k])
            rate = np.abs(np.diff(x)).sum() / max(1e-9, s[b] - s[a])
            width = way.width(k, max(first - 2, 0), last + 1, rate)
            share = least_share(x, width, limits[axis], dt)
            ret[axis] = max(ret[axis], (share, float(s[a])))
    return ret
