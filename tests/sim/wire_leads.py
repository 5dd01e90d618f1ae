# SPDX-License-Identifier: Apache-2.0
"""wire_leads.py - random contours begun in other ways: with arcs for leads, open,
several in one program."""
import math

from shapely.geometry import LineString, Point

from wire_contours import Contour
from wire_oracle import ring_points


def words(x, y, centre=None):
    if not centre:
        return f"G1 X{x:.4f} Y{y:.4f}"
    return (f"{'G2' if centre[2] else 'G3'} X{x:.4f} Y{y:.4f} "
            f"I{centre[0]:.4f} J{centre[1]:.4f}")


def frame(c):
    """Where the contour's first motion goes to, and to the wire's side."""
    x, y = c.ring[0][0] - c.start[0], c.ring[0][1] - c.start[1]
    d = math.hypot(x, y)
    t = (x / d, y / d)
    side = 1 if c.inside != c.clockwise else -1
    return t, (-side * t[1], side * t[0]), side


class ArcLed:
    """A contour with quarters of a circle for leads, tangent to it: the offset
    is reached on a line in front of the arc, or on the arc itself."""

    def __init__(self, rnd):
        while True:
            c = Contour(rnd)
            t, n, side = frame(c)
            r = c.offset * rnd.uniform(1.2, 4) + rnd.uniform(0.05, 1)
            s = c.start

            def at(a, b, s=s, t=t, n=n, r=r):
                return (round(s[0] + r * (a * t[0] + b * n[0]), 4),
                        round(s[1] + r * (a * t[1] + b * n[1]), 4))
            centre = (*at(0, 1), side < 0)
            on_arc = rnd.random() < 0.5
            if LineString([at(-1, 1), at(1, 1)]).distance(
                    c.poly.exterior) > c.offset and \
                    self.is_free(c, r, on_arc):
                break
        self.contour = c
        g = "G41" if side > 0 else "G42"
        far = at(-1, 1) if on_arc else at(0, 1)
        out = ["G90 G90.1 F200", f"H1={c.offset:.4f}",
               f"G0 X{far[0]:.4f} Y{far[1]:.4f}", f"{g} H1"]
        if not on_arc:
            out.append(words(*at(-1, 1)))
        out.append(words(*s, centre))
        out += [words(*e) for e in c.ring]
        out.append(("G40 " if on_arc else "") + words(*at(1, 1), centre))
        if not on_arc:
            out.append("G40 " + words(*at(0, 1)))
        self.text = "\n".join(out + ["M2", ""])

    @staticmethod
    def is_free(c, r, on_arc):
        """The wire goes round the same centre, nearer to it; or comes from the
        programmed arc and is nearer to the contour."""
        centre = Point(c.start[0] + r * frame(c)[1][0],
                       c.start[1] + r * frame(c)[1][1])
        return centre.distance(c.poly.exterior) > \
            r + (c.offset if on_arc else 0) - 1e-6


class Open:
    """A part of a contour, led to and from square to its ends."""

    def __init__(self, rnd):
        while True:
            c = Contour(rnd)
            n = rnd.randint(1, len(c.ring) - 1)
            if not c.ring[n - 1][2] and c.can_be_cut():
                pts = ring_points(c.start, c.ring[:n])
                far, foot = self.lead_out(c, pts)
                if math.dist(pts[-2], pts[-1]) > 0.2 and \
                        LineString([far, foot]).distance(c.poly.exterior) > \
                        c.offset - 1e-4:
                    break
        self.contour, self.line = c, LineString(pts)
        g = "G41" if c.inside != c.clockwise else "G42"
        out = [f"G90 G90.1 F200 H1={c.offset:.4f}",
               f"G0 X{c.far[0]:.4f} Y{c.far[1]:.4f}",
               f"{g} H1 {words(*c.start)}"]
        out += [words(*e) for e in c.ring[:n]]
        out.append("G40 " + words(*far))
        self.text = "\n".join(out + ["M2", ""])

    @staticmethod
    def lead_out(c, pts):
        (x, y), end = pts[-2], pts[-1]
        d = math.dist((x, y), end)
        side = 1 if c.inside != c.clockwise else -1
        n = (-side * (end[1] - y) / d, side * (end[0] - x) / d)
        return [(round(end[0] + k * n[0], 4), round(end[1] + k * n[1], 4))
                for k in (c.offset + 0.5, c.offset)]


def many(rnd, n):
    """A program of several contours, each in its place: (text, contours, the
    line each begins at)."""
    out, contours, first = ["G90 G90.1 F200"], [], []
    for i in range(n):
        c = Contour(rnd)
        lines = c.text.splitlines()
        first.append(len(out) + 1)
        out.append(f"(contour {i})")
        out += [lines[0].replace("G90 G90.1 F200 ", "")
                .replace("H1=", f"H{i + 1}=")]
        out += [shifted(x.replace(" H1", f" H{i + 1}"), 40 * i)
                for x in lines[1:] if x and not x.startswith("M2")]
        contours.append(c)
    return "\n".join(out + ["M2", ""]), contours, first


def shifted(line, by):
    """X and I of a line, farther to the right."""
    return " ".join(f"{w[0]}{float(w[1:]) + by:.4f}" if w[0] in "XI" else w
                    for w in line.split())


class Round:
    """A circle in one motion or in two, cut inside or outside."""

    def __init__(self, rnd):
        r = round(rnd.uniform(1, 6), 2)
        self.offset = rnd.choice([0.1, 0.125, 0.2])
        self.inside, self.clockwise = rnd.random() < .5, rnd.random() < .5
        centre = (0.0, 0.0, self.clockwise)
        half = [(-r, 0.0, centre)] if rnd.random() < .5 else []
        self.start, self.ring = (r, 0.0), half + [(r, 0.0, centre)]
        self.poly = Point(0, 0).buffer(r, 512)
        self.s = 1 if self.inside != self.clockwise else -1

    def frame(self):
        t = (0.0, -1.0 if self.clockwise else 1.0)
        return t, (-self.s * t[1], self.s * t[0]), self.s


class ArcsBehind:
    """A contour with a straight lead to an arc under the offset, which touches
    the contour; and out again.  Both may begin and end at one place."""

    def __init__(self, rnd):
        c = self.contour = Round(rnd) if rnd.random() < .3 else Contour(rnd)
        t, n, side = frame(c) if isinstance(c, Contour) else c.frame()
        r = c.offset * rnd.uniform(1.2, 4) + rnd.uniform(0.05, 1)
        by = [rnd.uniform(20, 300), rnd.uniform(20, 300)]
        if rnd.random() < .6:
            by = rnd.choice([[180, 180], [90, 90], [by[0], 360 - by[0]]])
        hole = rnd.choice([0, rnd.uniform(0, r), rnd.uniform(0, 2 * r)])
        hole = [hole, hole if by[0] + by[1] == 360 else rnd.uniform(0, r)]
        ways, far = [], []
        for k, (a, h) in enumerate(zip(by, hole)):
            # Seen from the contour; the lead out is the mirror image.
            a, m = math.radians(a), 1 if k else -1

            def at(x, y, m=m):
                return tuple(round(c.start[i] + m * x * t[i] + y * n[i], 4)
                             for i in (0, 1))
            far.append([at(r * math.sin(a), r * (1 - math.cos(a))),
                        at(r * math.sin(a) + h * math.cos(a) -
                           c.offset * 1.5 * math.sin(a),
                           r * (1 - math.cos(a)) + h * math.sin(a) +
                           c.offset * 1.5 * math.cos(a))])
            wire = [at((r - c.offset) * math.sin(a * j / 60),
                       r - (r - c.offset) * math.cos(a * j / 60))
                    for j in range(61)]
            ways.append(LineString(wire + [far[k][1]]))
        self.ways = ways
        centre = (*at(0, r), side < 0)
        out = ["G90 G90.1 F200", f"H1={c.offset:.4f}",
               f"G0 X{far[0][1][0]:.4f} Y{far[0][1][1]:.4f}",
               f"{'G41' if side > 0 else 'G42'} H1 {words(*far[0][0])}",
               words(*c.start, centre), *[words(*e) for e in c.ring],
               words(*far[1][0], centre), "G40 " + words(*far[1][1])]
        self.text = "\n".join(out + ["M2", ""])

    def is_free(self):
        """Is there room for the leads?"""
        return all(w.distance(self.contour.poly.exterior) >
                   self.contour.offset - 1e-3 for w in self.ways)
