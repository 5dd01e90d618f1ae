# SPDX-License-Identifier: Apache-2.0
"""speed_programs.py - random programs of six classes, to judge speeds by

A program is one smooth curve in short lines, or several with a corner between
each two.  The lines are rounded to some decimals, as programs are.
"""
import math
import random
import re

from edmsim import ROOT

KINDS = "wave", "step", "spiral", "noise", "corners", "comb"
LINES_MM = 0.005, 0.01, 0.02, 0.05, 0.1, 0.2
MM = 20                 # the way of a curve


class Program:
    """NC code: curves, each written in lines, one behind the other."""

    def __init__(self):
        self.lines = ["G21 G90 F6000"]
        self.curve_of = {}      # number of a line: which curve it is of
        self.curves = 0

    def write(self, places, decimals):
        """A curve: where it begins, which is where the last one ended, and where
        each of its lines ends."""
        if not self.curves:
            self.lines.append(f"G0 {words(places[0], decimals)}")
        for place in places[1:]:
            self.lines.append(f"G1 {words(place, decimals)}")
            self.curve_of[len(self.lines)] = self.curves
        self.curves += 1

    def text(self):
        return "\n".join(self.lines + ["M2", ""])


def words(place, decimals):
    return " ".join(f"{axis}{at:.{decimals}f}" for axis, at in place.items())


def along(f, way, mm):
    """Places of a curve by its way, a line apart."""
    n = max(1, round(way / mm))
    return [f(way * i / n) for i in range(n + 1)]


# -- Curves, by the way along them -----------------------------------------------

def plain_curve(rng):
    r, k = rng.choice([2, 5, 12]), rng.uniform(0.05, 0.8)
    turn = 1 / math.hypot(r, k)
    return rng.choice([
        lambda s: {"X": 0.8 * s, "Z": -0.6 * s},
        lambda s: {"X": r * math.sin(s / r), "Y": r * math.cos(s / r) - r},
        lambda s: {"X": r * math.sin(turn * s),
                   "Y": r * math.cos(turn * s) - r, "Z": -k * turn * s},
        lambda s: {"X": s, "Y": r / 4 * math.sin(k * s)},
    ])


def from_zero(f):
    begin = f(0)
    return lambda s: f(s) - begin


def wave_beside(rng):
    """Degrees: evenly, as a wave, as both, or as a wide step."""
    size, wave = 10 ** rng.uniform(-0.5, 1.3), 10 ** rng.uniform(-1, 0.1)
    even, begin = rng.uniform(-5, 5), rng.uniform(0, 6)
    return from_zero(rng.choice([
        lambda s: even * s,
        lambda s: size * math.sin(wave * s + begin),
        lambda s: size * math.sin(wave * s + begin) + even * s,
        lambda s: size / (1 + math.exp((MM / 2 - s) * wave)),
    ]))


def step_beside(rng):
    """Degrees: a narrow step, a narrow peak, or narrow waves."""
    size, width = 10 ** rng.uniform(-1.3, 1.3), 10 ** rng.uniform(-1, 0.5)
    at = rng.uniform(0.3, 0.7) * MM
    return from_zero(rng.choice([
        lambda s: size / (1 + math.exp(max(-60, min(60, (at - s) / width)))),
        lambda s: size * math.exp(-((s - at) / width) ** 2 / 2),
        lambda s: size / 4 * math.sin(2 * math.pi * s / max(1, 6 * width)),
    ]))


def spiral(rng):
    """A way of 60 mm at most, evenly by its length."""
    r0, r1 = rng.uniform(0.3, 2), rng.uniform(2, 8)
    turns, z = rng.uniform(0.5, 3), rng.choice([0, rng.uniform(-2, 2)])

    def at(u):
        r, a = r0 + (r1 - r0) * u, 2 * math.pi * turns * u
        return {"X": r * math.cos(a) - r0, "Y": r * math.sin(a),
                **({"Z": z * u} if z else {})}

    marks = [list(at(i / 2000).values()) for i in range(2001)]
    way = sum(map(math.dist, marks, marks[1:]))
    part = min(1, 60 / way)
    return (lambda s: at(part * s / (part * way))), part * way


# -- Classes -----------------------------------------------------------------------

def axis_limits(rng, axis):
    """v, a and j: as machines have them."""
    return (rng.choice((50, 80, 120) if axis in "XYZ" else (30, 60, 120)),
            rng.choice((500, 1000, 2000)), rng.choice((10000, 20000, 50000)))


def any_limits(rng):
    """As unequal as they come."""
    return {axis: (rng.randint(20, 120), round(10 ** rng.uniform(1.7, 3.3)),
                   round(10 ** rng.uniform(4, 5.3))) for axis in "XYZABC"}


def smooth(rng, kind):
    limits = {axis: axis_limits(rng, axis) for axis in "XYZABC"}
    mm, decimals = rng.choice(LINES_MM), rng.choice((3, 3, 4, 5, 6))
    f, way = plain_curve(rng), MM
    if kind == "spiral":
        f, way = spiral(rng)
    elif kind == "noise":
        mm, decimals, way = rng.choice((0.002, 0.003)), 3, 6
    elif kind == "step" and rng.random() < 0.3:
        for axis in "ABC":
            limits[axis] = (rng.choice((30, 60)), rng.choice((50, 100, 300)),
                            rng.choice((3000, 10000)))
    turn = step_beside if kind == "step" else wave_beside
    beside = {axis: turn(rng) for axis in
              rng.sample("ABC", rng.choice((0, 1, 1, 2) if kind != "step" else
                                           (1, 1, 2)))} if kind != "spiral" \
        else {}
    p = Program()
    p.write(along(lambda s: {**f(s), **{a: h(s) for a, h in beside.items()}},
                  way, mm), decimals)
    return p, limits


def one_side(rng, at, heading, arc):
    """A line, or an arc to either side.  Return: the curve, its way, and where it
    heads at its end."""
    x, y = at["X"], at["Y"]
    r, left = 10 ** rng.uniform(-0.3, 1), rng.choice((-1, 1))
    if not arc:
        return (lambda s: {"X": x + s * math.cos(heading),
                           "Y": y + s * math.sin(heading)}), \
               rng.uniform(2, 12), heading
    way = r * rng.uniform(0.3, 3)
    cx = x - left * r * math.sin(heading)
    cy = y + left * r * math.cos(heading)

    def f(s):
        a = heading + left * s / r
        return {"X": cx + left * r * math.sin(a),
                "Y": cy - left * r * math.cos(a)}

    return f, way, heading + left * way / r


def corners(rng):
    """Lines and arcs by turns, with corners between them or none."""
    limits, p = any_limits(rng), Program()
    mm, decimals = rng.choice((0.05, 0.02, 0.01, 0.005)), rng.choice((3, 4, 6))
    turns, tangent = rng.random() < 0.4, rng.random() < 0.3
    at, heading = {"X": 0.0, "Y": 0.0}, rng.uniform(0, 7)
    if turns:
        at["C"] = 0.0
    for i in range(rng.choice((3, 5, 8))):
        heading += 0 if tangent else rng.uniform(-2.8, 2.8)
        f, way, heading = one_side(rng, at, heading, i % 2 == 1)
        c, dc = at.get("C", 0), rng.uniform(-20, 20)

        def g(s):
            return {**f(s), **({"C": c + dc * s / way} if turns else {})}

        p.write(along(g, way, mm), decimals)
        at = g(way)
    return p, limits


def comb(rng):
    """Teeth, or a zigzag."""
    limits, p = any_limits(rng), Program()
    step = round(10 ** rng.uniform(-1, 0.3), 3)
    mm = rng.choice((0.05, 0.02, 0.01, 0.005))
    zigzag, turns = rng.random() < 0.4, rng.random() < 0.3
    half = math.radians(rng.uniform(10, 170)) / 2
    at = {"X": 0.0, "Y": 0.0, **({"C": 0.0} if turns else {})}
    for i in range(rng.choice((6, 12, 20))):
        dx, dy = ((0, 3 * step), (step, 0), (0, -3 * step), (step, 0))[i % 4]
        if zigzag:
            a = half if i % 2 else -half
            dx = round(step * math.cos(a), 3)
            dy = round(step * math.sin(a), 3)
        way = math.hypot(dx, dy)
        dc = round(rng.uniform(-5, 5) * way, 3) if i % 2 else 0
        by = {"X": dx, "Y": dy, "C": dc}
        p.write(along(lambda s: {w: v + by[w] * s / way
                                 for w, v in at.items()}, way, mm), 3)
        at = {w: v + by[w] for w, v in at.items()}
    return p, limits


def program(kind, seed):
    """Return: a Program, and v, a and j of each axis."""
    rng = random.Random(f"{kind} {seed}")
    if kind == "corners":
        return corners(rng)
    if kind == "comb":
        return comb(rng)
    return smooth(rng, kind)


def machine(folder, limits):
    """A machine file whose axes have these v, a and j."""
    text = (ROOT / "examples/machine.ini").read_text()
    for axis, (v, a, j) in limits.items():
        text = re.sub(rf"(?m)^\[axis\.{axis}\]\n(?:\S.*\n)+",
                      f"[axis.{axis}]\nv_max_mm_s = {v}\n"
                      f"a_max_mm_s2 = {a}\nj_max_mm_s3 = {j}\n", text)
    (folder / "m.ini").write_text(text)
    return folder / "m.ini"
