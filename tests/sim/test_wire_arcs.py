# SPDX-License-Identifier: Apache-2.0
"""Arcs and lines with another taper each, against their own surfaces.

A motion with a taper makes a plane or a cone, whatever its neighbours do: on the
second plane it is the line beside it, or the arc round the same centre.  In the
middle of each motion the wire must be beside this line or arc, and nowhere nearer
to it.  Where motions lie close to each other on top, nothing is said of them.

EDM_SEED repeats a run, EDM_RUNS says how many.
"""
import math
import os
import random

import numpy as np
import shapely
from edmsim import run, seeded
from shapely.geometry import LineString, Point, Polygon
from test_wire_taper import BOUND_MM, HEIGHT, WIRE, planes, rows_of
from wire_contours import star, unit
from wire_oracle import ring_points

RUNS = int(os.environ.get("EDM_RUNS", 5))
DEGREES = [-1, -0.5, -0.2, 0, 0.2, 0.5, 1]


def filleted(rnd):
    """A polygon with large fillets, counter-clockwise: edges (x, y, centre)."""
    while True:
        v = star(rnd, rnd.randint(3, 6), 5, 9)
        edges = []
        for i, c in enumerate(v):
            (ux, uy, lu), (vx, vy, lv) = unit(v[i - 1], c), \
                unit(c, v[(i + 1) % len(v)])
            turn = math.atan2(ux * vy - uy * vx, ux * vx + uy * vy)
            r = rnd.uniform(1, 2.5)
            t = r * abs(math.tan(turn / 2))
            if abs(turn) < 0.1 or t > 0.4 * min(lu, lv):
                break
            a = (round(c[0] - ux * t, 4), round(c[1] - uy * t, 4))
            s = math.copysign(r, turn)
            edges += [(*a, None),
                      (round(c[0] + vx * t, 4), round(c[1] + vy * t, 4),
                       (round(a[0] - s * uy, 4), round(a[1] + s * ux, 4),
                        turn < 0))]
        else:
            start = tuple(round((p + q) / 2, 4)
                          for p, q in zip(edges[0][:2], edges[-1][:2]))
            return start, edges + [(*start, None)]


def beside(a, edge, by):
    """Places along the edge from a, moved by @by to its left."""
    at = np.array([a] + ring_points(a, [edge])[1:])
    if not edge[2]:
        x, y, _ = unit(a, edge)
        at = at[:1] + np.linspace(0, 1, 200)[:, None] * (at[-1] - at[0])
        return at + by * np.array([-y, x])
    out = at - np.array(edge[2][:2])
    r = np.hypot(*out.T)[:, None]
    return edge[2][:2] + out / r * (r + (by if edge[2][2] else -by))


class Leaning:
    """A job, and where each motion's surface is on top."""

    def __init__(self, rnd):
        self.start, self.edges = filleted(rnd)
        n = len(self.edges)
        self.degrees = [rnd.choice(DEGREES) for _ in range(n)]
        self.degrees[-1] = self.degrees[0]      # one edge, begun in its middle
        self.inside = rnd.random() < 0.5
        self.offset = rnd.choice([0.05, 0.125, 0.2])
        slopes = [math.tan(math.radians(a)) for a in self.degrees]
        self.wires = [self.offset * math.hypot(1, s) for s in slopes]
        from_ = [self.start] + [e[:2] for e in self.edges]
        self.top = [beside(a, e, HEIGHT * s)
                    for a, e, s in zip(from_, self.edges, slopes)]
        self.ways = [beside(a, e, HEIGHT * s +
                            (w if self.inside else -w))
                     for a, e, s, w in zip(from_, self.edges, slopes,
                                           self.wires)]
        x, y, _ = unit(self.start, self.edges[0])
        k = 4 if self.inside else -4
        self.far = self.start[0] - k * y, self.start[1] + k * x
        self.text = self.job()

    def job(self):
        def taper(i):
            a = self.degrees[i]
            return f"G51 A{a:g} " if a else "G50 "
        out = [f"F200 H1={self.offset}\nG0 X{self.far[0]:.4f} "
               f"Y{self.far[1]:.4f}",
               f"{'G41' if self.inside else 'G42'} H1 {taper(0)}"
               f"G1 X{self.start[0]:.4f} Y{self.start[1]:.4f}"]
        here = self.start
        for i, (x, y, c) in enumerate(self.edges):
            word = f"G1 X{x:.4f} Y{y:.4f}" if not c else \
                (f"G{2 if c[2] else 3} X{x:.4f} Y{y:.4f} "
                 f"I{c[0] - here[0]:.4f} J{c[1] - here[1]:.4f}")
            out.append(taper(i) + word)
            here = x, y
        out += [f"G40 G50 G1 X{self.far[0]:.4f} Y{self.far[1]:.4f}", "M2", ""]
        return "\n".join(out)

    def judged(self):
        """(motion, the middle of its surface on top, of the way beside it): those
        with nothing else of the outline close by."""
        raw = [LineString(p) for p in self.top]
        steps = [LineString([p[-1], q[0]]) if math.dist(p[-1], q[0]) > 1e-6
                 else Point(q[0]) for p, q in zip(self.top, self.top[1:])]
        for i, (at, way) in enumerate(zip(self.top, self.ways)):
            n = len(at)
            mid = slice(n // 4, 3 * n // 4 + 1)
            if n < 8 or i in (0, len(self.top) - 1):
                continue
            # The whole of what the wire needs there.
            room = Polygon([*at[mid], *way[mid][::-1]]).buffer(
                1.5 * max(self.wires))
            if all(not room.intersects(o) for k, o in enumerate(raw)
                   if k != i) and not any(room.intersects(s) for s in steps):
                yield i, at[mid], way[mid]


def test_each_motion_is_cut_along_its_own_surface():
    # The same in every `make check`; others with EDM_SEED.
    rnd = seeded() if "EDM_SEED" in os.environ else random.Random(8)
    cut = arcs = lines = refused = 0
    nearer = farther = 0
    for i in range(RUNS):
        c = Leaning(rnd)
        r = run("--machine", WIRE, "--check", text=c.text)
        about = f"{i}: {r.stderr.decode()}\n{c.text}"
        assert r.returncode in (0, 65), about
        if r.returncode:
            refused += 1
            continue
        cut += 1
        rows = rows_of(c.text)
        top = planes(rows)[1]
        on = (rows[:, 0] > 3) & (rows[:, 0] < len(c.edges) + 4)
        path = LineString(top[on][:, 1:])
        shapely.prepare(path)
        for k, at, way in c.judged():
            arcs += c.edges[k][2] is not None
            lines += c.edges[k][2] is None
            gap = LineString(at).distance(path) - c.wires[k]
            nearer = max(nearer, -gap)
            assert gap > -BOUND_MM, (k, gap, about)
            off = shapely.distance(shapely.points(way), path).max()
            farther = max(farther, off)
            assert off < BOUND_MM, (k, off, about)
    print(f"{cut} cut, {refused} refused; {arcs} arcs and {lines} lines, nearer "
          f"by {1000 * nearer:.2f} um at the worst, off by "
          f"{1000 * farther:.2f}")
    assert arcs > cut / 2 and lines > cut / 2
