# SPDX-License-Identifier: Apache-2.0
"""speed_tube.py - what a motion asks of each axis, within the rounding

No axis follows what lies within a rounding.  So the question is whether there is
a motion of each axis that is near to where it was sent, each moment, and within
its limits.  The least share of its limits that suffices is found by a linear
program.  Nothing else is known here: neither how the program was made, nor how
its speed was.
"""
import itertools
import math
import re

import highspy
import numpy as np

TOLERANCE_MM, CORNER_MM = 0.001, 0.005      # [speed], as by default
RATE_MOST = 20          # beside the path, a rounding of it counts so often
WINDOW = 120            # samples at a time; half of them again with the next ones
LEAST = 8               # of fewer nothing is said


def differences(n):
    """Rows of first, second and third differences of @n samples."""
    for order, row in enumerate(((-1, 1), (1, -2, 1), (-1, 3, -3, 1))):
        for i in range(n - order - 1):
            yield order, i, row


def least_share(x, width, limits, dt):
    """Of its v, a and j, what an axis needs to be within @width of each place @x,
    a time @dt apart."""
    scale = [1 / (limit * dt ** (k + 1)) for k, limit in enumerate(limits)]
    asked = [np.diff(x, k + 1) * scale[k] for k in range(3)]
    raw = max(np.abs(q).max() for q in asked)
    return raw if raw <= 1 else solve(len(x), width, scale, asked)


def solve(n, width, scale, asked):
    """Variables: by how much of the width each place is off, and the share."""
    starts, index, value, upper = [0], [], [], []
    for order, i, row in differences(n):
        by = width * scale[order]
        for sign in 1, -1:
            index += [*range(i, i + len(row)), n]
            value += [sign * by * c for c in row] + [-1]
            upper.append(-sign * asked[order][i])
            starts.append(len(index))
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = n + 1, len(upper)
    lp.col_cost_ = np.append(np.zeros(n), 1)
    lp.col_lower_ = np.append(-np.ones(n), 0)
    lp.col_upper_ = np.append(np.ones(n), highspy.kHighsInf)
    lp.row_lower_ = np.full(len(upper), -highspy.kHighsInf)
    lp.row_upper_ = np.array(upper)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = np.array(starts)
    lp.a_matrix_.index_ = np.array(index)
    lp.a_matrix_.value_ = np.array(value)
    h = highspy.Highs()
    h.setOptionValue("output_flag", False)
    h.setOptionValue("threads", 1)
    h.passModel(lp)
    h.run()
    assert h.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return h.getInfo().objective_function_value


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
        for i in itertools.count(0, WINDOW // 2):
            if len(at) - i < LEAST or (i > 0 and len(at) - i <= WINDOW // 2):
                break
            some = at[i:i + WINDOW]
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
