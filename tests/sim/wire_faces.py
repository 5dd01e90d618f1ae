# SPDX-License-Identifier: Apache-2.0
"""wire_faces.py - outlines whose faces lean to different sides, and what is left
of them on the second plane.

The moved outline carries the part along: where it goes round a place
counter-clockwise, the part is there.  Which places these are is found with an
arrangement of shapely's and angles, without edmd's way of looking for them.
"""
import math

import numpy as np
from shapely.geometry import LinearRing, LineString, Point, Polygon
from shapely.ops import polygonize, unary_union

from wire_contours import star, unit
from wire_oracle import verdict


def comb(rnd):
    n = rnd.randint(2, 4)
    w, gap, h = rnd.uniform(1, 6), rnd.uniform(1, 6), rnd.uniform(.5, 12)
    pts = [(0, 0), (n * (w + gap), 0)]
    for i in range(n - 1, -1, -1):
        x = i * (w + gap)
        pts += [(x + gap + w, h + 10), (x + gap, h + 10), (x + gap, 10), (x, 10)]
    return pts


def step(rnd):
    s, x = rnd.uniform(.05, 3), rnd.uniform(3, 15)
    return [(0, 0), (20, 0), (20, 15), (x, 15), (x, 15 + rnd.choice([-s, s])),
            (0, 15 + rnd.choice([-s, s]) * .3)]


def rib(rnd):
    s, w = rnd.uniform(.05, 4) * rnd.choice([-1, 1]), rnd.uniform(.3, 5)
    return [(0, 0), (20, 0), (20, 15), (10 + w, 15), (10 + w, 15 + s),
            (10, 15 + s), (10, 15), (0, 15)]


def chords(rnd):
    n, r = rnd.randint(10, 40), rnd.uniform(.5, 6)
    turn = [math.pi / 2 * i / n for i in range(n + 1)]
    return [(0, 0), (14, 0)] + [(14 - r + r * math.cos(a),
                                 14 - r + r * math.sin(a)) for a in turn] + \
        [(0, 14)]


def some_star(rnd):
    return star(rnd, rnd.randint(4, 9), 8, 20)


def degrees_of(rnd, n):
    """One taper all round; any at each edge; several to one side."""
    one = rnd.choice([-3, -2, -1, .5, 1, 2, 3])
    some = rnd.choice([[one], [-3, -2, -1, 0, .5, 1, 2, 3],
                       [one, one / 2, 0]])
    return [rnd.choice(some) for _ in range(n)]


def moved(pts, shifts):
    """The corners of the moved outline; None where the rules for corners
    (docs/taper.md) want more than edges."""
    lines, ret = [], []
    for i, p in enumerate(pts):
        x, y, _ = unit(p, pts[(i + 1) % len(pts)])
        lines.append((p[0] - shifts[i] * y, p[1] + shifts[i] * x, x, y))
    for i in range(len(pts)):
        (ax, ay, ux, uy), (bx, by, vx, vy) = lines[i - 1], lines[i]
        a, b = shifts[i - 1], shifts[i]
        sin, cos = ux * vy - uy * vx, ux * vx + uy * vy
        reach = math.sqrt(max(a * a + b * b - 2 * a * b * cos, 0))
        if cos < -1e-6 or abs(sin) < 1e-3 or \
                (a != b and reach > 2.9 * abs(sin) * max(abs(a), abs(b))):
            return None
        t = ((bx - ax) * vy - (by - ay) * vx) / sin
        ret.append((ax + t * ux, ay + t * uy))
    return ret


def gone_round(ring):
    """The places that a ring goes round counter-clockwise."""
    at = np.array(ring + ring[:1])
    there = []
    for face in polygonize(unary_union(LineString(at))):
        d = at - face.representative_point().coords[0]
        turns = np.diff(np.arctan2(d[:, 1], d[:, 0]))
        turns = (turns + np.pi) % (2 * np.pi) - np.pi
        if turns.sum() > np.pi:
            there.append(face)
    return unary_union(there)


class Faces:
    """A random outline, its job, and both outlines of the part."""

    def __init__(self, rnd, height):
        top = None
        while not top or self.top.geom_type != "Polygon" or \
                self.top.exterior.distance(Point(self.start_above)) > 1e-3:
            pts = [(round(x, 3), round(y, 3)) for x, y in rnd.choice(
                [some_star, comb, step, rib, chords])(rnd)]
            if not (Polygon(pts).is_valid and LinearRing(pts).is_ccw):
                continue
            long = max(range(len(pts)),
                       key=lambda i, p=pts: math.dist(p[i - 1], p[i]))
            pts = pts[long:] + pts[:long]
            self.degrees = degrees_of(rnd, len(pts))
            slopes = [math.tan(math.radians(a)) for a in self.degrees]
            top = moved(pts, [height * s for s in slopes])
            if top:
                self.top = gone_round(top)
                self.begin(rnd, pts, height * slopes[-1])
        self.pts = pts
        self.wires = [self.offset * math.sqrt(1 + s * s) for s in slopes]
        turned = [(q[0] - p[0]) * (v[0] - u[0]) +
                  (q[1] - p[1]) * (v[1] - u[1]) < 0 for p, q, u, v in
                  zip(pts, pts[1:] + pts[:1], top, top[1:] + top[:1])]
        # Where two neighbours have vanished, their moved lines may leave
        # something of an edge that is not the part's.
        self.judged = not any(a and b for a, b in
                              zip(turned, turned[1:] + turned[:1]))
        self.whole = not any(turned) and LinearRing(top).is_simple

    def begin(self, rnd, pts, shift):
        """In the middle of the last edge; the lead is square to it."""
        self.inside = rnd.random() < .5
        self.offset = rnd.choice([.125, .2, .5])
        x, y, _ = unit(pts[-1], pts[0])
        s = [round((a + b) / 2, 4) for a, b in zip(pts[-1], pts[0])]
        k = 6 if self.inside else -6
        self.start, self.far = s, (s[0] - k * y, s[1] + k * x)
        self.start_above = s[0] - shift * y, s[1] + shift * x

    def outlines(self):
        return Polygon(self.pts), Polygon(self.top.exterior)

    def can_be_cut(self):
        """Every face is there on top, and the wire has room everywhere."""
        return self.whole and all(
            verdict(o, w, self.inside, self.far) == "cut"
            for o in self.outlines()
            for w in (min(self.wires), max(self.wires)))
