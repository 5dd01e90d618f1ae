# SPDX-License-Identifier: Apache-2.0
"""wire_lead_arcs.py - leads of any kind: lines, and arcs of 1 to 360 degrees that
meet the contour at any angle, on either side; and where the wire should go.

The rule is that of docs/taper.md: an arc keeps its centre and its sense; the wire
goes round it at the radius of the place where it is beside the contour.
"""
import math

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.ops import unary_union

from wire_contours import Contour
from wire_leads import frame, words
from wire_oracle import ring_points

SURE_MM = 0.004         # docs/taper.md: places nearer than that are close to call


def turned(v, by):
    c, s = math.cos(by), math.sin(by)
    return v[0] * c - v[1] * s, v[0] * s + v[1] * c


def angle_of(v):
    return math.atan2(v[1], v[0])


def off(a, b):
    return a[0] - b[0], a[1] - b[1]


def rounded(v):
    return round(v[0], 4), round(v[1], 4)


class Lead:
    """A lead to the place s, where the contour goes the way t and the wire is on
    the side n of it.  It is seen from its far end, a lead out backwards."""

    def __init__(self, rnd, s, t, n, largest=10):
        # The angle at which it meets the contour: above 0 from the wire's side.
        alpha = math.radians(rnd.choice(
            [0, 0, 0, 0, 90, 15, 45, rnd.uniform(0, 180),
             rnd.uniform(-180, 180)]))
        u = [math.cos(alpha) * t[i] - math.sin(alpha) * n[i] for i in (0, 1)]
        self.s, self.t, self.n = s, t, n
        r = 10 ** rnd.uniform(-1, math.log10(largest))
        self.sweep = 0
        if rnd.random() < 0.2:
            self.far = rounded((s[0] - r * u[0], s[1] - r * u[1]))
            self.centre = None
            return
        # Mostly from the wire's side, if it could be from either.
        to_n = turned(u, math.pi / 2)
        left = 1 if to_n[0] * n[0] + to_n[1] * n[1] > 0 else -1
        self.sense = left if rnd.random() < 0.8 else -left
        degrees = rnd.choice([90, 180, 360, rnd.uniform(1, 360),
                              rnd.uniform(1, 360), rnd.uniform(300, 360)])
        to_c = turned(u, self.sense * math.pi / 2)
        c = self.centre = rounded((s[0] + r * to_c[0], s[1] + r * to_c[1]))
        self.far = s if degrees == 360 else rounded(
            [c[i] + turned(off(s, c), -self.sense * math.radians(degrees))[i]
             for i in (0, 1)])
        self.sweep = self.turn(self.far, s)

    def turn(self, a, b):
        """From a to b round the centre, in its sense, in (0, 360] degrees."""
        by = (angle_of(off(b, self.centre)) - angle_of(off(a, self.centre))) \
            * self.sense % (2 * math.pi)
        return 2 * math.pi if math.dist(a, b) < 1e-7 else by

    def written(self):
        if not self.centre:
            return LineString([self.far, self.s])
        return LineString(self.round(self.far, self.sweep))

    def round(self, a, sweep):
        v = off(a, self.centre)
        k = max(int(abs(sweep) / 0.005), 2)
        return [tuple(self.centre[i] +
                      turned(v, self.sense * sweep * j / k)[i] for i in (0, 1))
                for j in range(k + 1)]

    def way(self, by):
        """Where the wire goes that ends @by mm beside s; None if it cannot."""
        at = [self.s[i] + by * self.n[i] for i in (0, 1)]
        if not self.centre:
            return LineString([self.far, at])
        v, w = off(self.s, self.centre), off(at, self.centre)
        if v[0] * w[0] + v[1] * w[1] <= 0:
            return None
        more = self.sense * math.atan2(v[0] * w[1] - v[1] * w[0],
                                       v[0] * w[0] + v[1] * w[1])
        r, f = math.hypot(*w), off(self.far, self.centre)
        k = r / math.hypot(*f)
        begin = [self.centre[i] + k * f[i] for i in (0, 1)]
        if (self.sweep + more) * r < 1e-6:
            return None
        return LineString([self.far, *self.round(begin, self.sweep + more)])

    def is_edge(self, by):
        """Is it close to call whether its arc has room for that?"""
        if not self.centre:
            return False
        return (self.way(by - SURE_MM) is None) != \
            (self.way(by + SURE_MM) is None) or (
                self.way(by) is not None and self.way(by).length < 0.01 or
                math.dist([self.s[i] + by * self.n[i] for i in (0, 1)],
                          self.centre) < 0.01)

    def side(self, offset):
        """The place at the offset back from the end: how far it is on the wire's
        side.  Below 0: the lead is written to come through the contour."""
        line = self.written()
        at = line.interpolate(max(line.length - offset, 0)).coords[0]
        d = off(at, self.s)
        return d[0] * self.n[0] + d[1] * self.n[1]

    def verdict(self, ring, own, by, offset):
        """What is to be said of it under a wire that keeps @offset from the
        rings; own: the parts of the contour that it may come through."""
        length, side = self.written().length, self.side(offset)
        if abs(length - offset) < 1e-3 or self.is_edge(by) or \
                abs(side) < 1e-4:
            return "close"
        way = self.way(by)
        if length <= offset or way is None:
            return "refuse"
        gap = way.distance(ring.difference(own.buffer(1e-6)) if side < 0
                           else ring)
        if offset - SURE_MM < gap < offset - 1e-4:
            return "close"
        return "cut" if gap >= offset - 1e-4 else "refuse"

    def words(self, out):
        at = self.far if out else self.s
        if not self.centre:
            return words(*at)
        return words(*at, (*self.centre, (self.sense > 0) == out))


def sound_contour(rnd):
    while True:
        c = Contour(rnd)
        if len(c.ring) < 60 and c.can_be_cut() and not c.is_close():
            return c


class Led:
    """A contour with a lead in and a lead out of any kind: most of them can be
    cut."""

    def __init__(self, rnd, contour):
        c = self.contour = contour
        t, n, side = frame(c)
        self.code = "G41" if side > 0 else "G42"
        pts = ring_points(c.start, c.ring)
        # A lead through the contour comes through its first or last motion.
        first = c.ring[0][:2]
        last = ring_points(c.start, c.ring[:-1])[-1]
        self.own = unary_union([LineString([c.start, first]),
                                LineString([last, c.start])])
        self.ring = LineString(pts)
        self.leads, self.verdicts = zip(*[
            self.draw(rnd, c.start, way, n)
            for way in (t, (-t[0], -t[1]))])

    def draw(self, rnd, *frame):
        d = self.contour.offset
        wanted = ["cut"] if rnd.random() < 0.8 else ["cut", "refuse"]
        for _ in range(100):
            lead = Lead(rnd, *frame)
            v = lead.verdict(self.ring, self.own, d, d)
            if v in wanted:
                break
        return lead, v

    def text(self, register="H1", head="G90 G90.1 F200 H1={:.4f}", relative=False,
             end="M2"):
        c, (a, b) = self.contour, self.leads
        out = [head.format(c.offset), f"G0 X{a.far[0]:.4f} Y{a.far[1]:.4f}",
               f"{self.code} {register}", a.words(False)]
        out += [words(*e) for e in c.ring]
        out += ["G40 " + b.words(True), end, ""]
        if not relative:
            return "\n".join(out)
        here = (0.0, 0.0)
        for i, line in enumerate(out):
            w = {x[0]: float(x[1:]) for x in line.split() if x[0] in "XYIJ"}
            if "I" in w:
                out[i] = line[:line.index("I")] + \
                    f"I{w['I'] - here[0]:.4f} J{w['J'] - here[1]:.4f}"
            if "X" in w:
                here = w["X"], w["Y"]
        return "\n".join(out)


def lead_ways(ways, lead, out):
    """The ways of a lead among those of a job, and the others."""
    if out:
        ways = ways[::-1]
    n, arc = 0, None
    while n < len(ways) and not (n == 1 and not lead.centre) and \
            (not arc or ways[n][3] and math.dist(ways[n][3][:2], arc) < 1e-5):
        arc = arc or ways[n][3] and ways[n][3][:2]
        n += 1
    mine, rest = ways[:n], ways[n:]
    return (mine[::-1], rest[::-1]) if out else (mine, rest)


def hausdorff(a, b):
    """Of two line strings whose places lie close."""
    return max(shapely.distance(shapely.points(np.asarray(p.coords)), q).max()
               for p, q in ((a, b), (b, a)))


class Leaning:
    """A rectangle with a taper all round, with a lead in and a lead out of any
    kind.  Its top is a rectangle, too."""

    def __init__(self, rnd, height):
        self.offset = rnd.choice([0.1, 0.125, 0.2])
        slope = math.tan(math.radians(rnd.choice([0.2, 1, 3])))
        self.wire = self.offset * math.hypot(1, slope)
        # How far the top is moved to the wire's side.
        self.top = slope * height * rnd.choice([-1, 1])
        inside, clockwise = rnd.random() < .5, rnd.random() < .5
        w, h = rnd.uniform(5, 9), rnd.uniform(5, 9)
        pts = [(w, 0), (w, h), (-w, h), (-w, 0)]
        pts = [rounded(p) for p in (pts[::-1] if clockwise else pts)]
        t = (-1, 0) if clockwise else (1, 0)
        n = (0, 1 if inside else -1)
        left = inside != clockwise
        self.codes = "G41" if left else "G42", \
            "G51" if left == (self.top > 0) else "G52", \
            math.degrees(math.atan(slope))
        grow = -self.top if inside else self.top
        self.rings = [LineString([(-w - g, -g), (w + g, -g), (w + g, h + g),
                                  (-w - g, h + g), (-w - g, -g)])
                      for g in (0, grow)]
        self.own = [LineString(list(r.coords)[:2]) for r in self.rings]
        self.by = self.wire, self.wire + self.top
        self.leads, self.verdicts = zip(*[
            self.draw(rnd, (0.0, 0.0), way, n) for way in (t, (-t[0], 0))])
        self.pts = pts

    def draw(self, rnd, *frame):
        wanted = ["cut"] if rnd.random() < 0.8 else ["cut", "refuse"]
        for _ in range(100):
            lead = Lead(rnd, *frame, largest=2)
            v = [lead.verdict(*x, self.wire)
                 for x in zip(self.rings, self.own, self.by)]
            v = min(v, key=["close", "refuse", "cut"].index)
            if v in wanted:
                break
        return lead, v

    def text(self):
        (a, b), (side, lean, deg) = self.leads, self.codes
        out = [f"G90 G90.1 F200 H1={self.offset}",
               f"G0 X{a.far[0]:.4f} Y{a.far[1]:.4f}",
               f"{side} H1 {lean} A{deg:.7f}", a.words(False)]
        out += [words(*p) for p in [*self.pts, (0, 0)]]
        out += ["G40 G50 " + b.words(True), "M2", ""]
        return "\n".join(out)
