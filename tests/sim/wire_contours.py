# SPDX-License-Identifier: Apache-2.0
"""wire_contours.py - random contours of lines and arcs, as CAM writes them:
corners, chamfers, fillets as arcs and as chords, slots, notches, noise."""
import math

from shapely.geometry import LineString, Point, Polygon

from wire_oracle import (UM, can_be_cut, is_close, left_by, ring_of, way_of,
                         write_job)


def star(rnd, n, low, high):
    """A polygon round the origin, counter-clockwise."""
    turn = rnd.uniform(0, 7)
    return [(r * math.cos(a), r * math.sin(a)) for i in range(n)
            for a in [2 * math.pi * (i + rnd.uniform(-.3, .3)) / n + turn]
            for r in [rnd.uniform(low, high)]]


def unit(a, b):
    d = math.hypot(b[0] - a[0], b[1] - a[1])
    return (b[0] - a[0]) / d, (b[1] - a[1]) / d, d


def fillet(rnd, p, c, q, as_chords):
    """Edges round the corner c between p and q; without room, c alone."""
    ux, uy, lu = unit(p, c)
    vx, vy, lv = unit(c, q)
    turn = math.atan2(ux * vy - uy * vx, ux * vx + uy * vy)
    r = 10 ** rnd.uniform(-2, 0.3)
    t = r * abs(math.tan(turn / 2))
    if not 1e-3 < t < 0.4 * min(lu, lv) or abs(turn) < 0.02:
        return [(*c, None)]
    a = (c[0] - ux * t, c[1] - uy * t)
    b = (c[0] + vx * t, c[1] + vy * t)
    s = math.copysign(r, turn)
    o = (a[0] - s * uy, a[1] + s * ux)
    if not as_chords:
        return [(*a, None), (*b, (*o, turn < 0))]
    n = max(int(abs(turn) * r / rnd.choice([0.005, 0.02, 0.05, 0.2])), 1)
    first = math.atan2(a[1] - o[1], a[0] - o[0])
    return [(o[0] + r * math.cos(first + turn * i / min(n, 60)),
             o[1] + r * math.sin(first + turn * i / min(n, 60)), None)
            for i in range(min(n, 60) + 1)]


def slot(rnd, p, q):
    """A slot or a notch in the side from p to q, or a rib on it."""
    ux, uy, d = unit(p, q)
    w = min(10 ** rnd.uniform(-2, 0.2), 0.5 * d)
    depth = 10 ** rnd.uniform(-2, 0.3) * rnd.choice([-1, 1])
    at = rnd.uniform(0.1, 0.8) * (d - w)
    nar = rnd.choice([0, 0, 0, rnd.uniform(-.4, .4)]) * w
    pts = [(at, 0), (at + nar, depth), (at + w - nar, depth), (at + w, 0)]
    return [(p[0] + ux * x - uy * y, p[1] + uy * x + ux * y)
            for x, y in pts]


def vertices(rnd):
    kind = rnd.randrange(4)
    if kind == 0:
        return star(rnd, rnd.randint(3, 12), 2, 6)
    if kind == 1:
        return star(rnd, rnd.randint(12, 150), 5, rnd.choice([5.05, 5.5, 7]))
    v = star(rnd, rnd.randint(3, 8), 3, 7)
    out = []
    for i, p in enumerate(v):
        out.append(p)
        if rnd.random() < 0.4:
            out += slot(rnd, p, v[(i + 1) % len(v)])
    return out


def edges_of(rnd, v):
    """The corners of v, sharp, filleted or chamfered, to a micrometre."""
    style = rnd.choice(["sharp", "arcs", "chords", "mixed"])
    out = []
    for i, c in enumerate(v):
        p, q = v[i - 1], v[(i + 1) % len(v)]
        how = rnd.choice(["sharp", "arcs", "chords"]) if style == "mixed" \
            else style
        out += [(*c, None)] if how == "sharp" else \
            fillet(rnd, p, c, q, how == "chords")
    places = rnd.choice([3, 3, 4])
    out = [(round(x, places), round(y, places),
            c and (round(c[0], places), round(c[1], places), c[2]))
           for x, y, c in out]
    # An arc that rounding has spoiled is a line.
    ret, here = [], out[-1][:2]
    for x, y, c in out:
        if (x, y) == here:
            continue
        if c and (abs(math.hypot(here[0] - c[0], here[1] - c[1]) -
                      math.hypot(x - c[0], y - c[1])) > 1.8 * UM
                  or math.hypot(here[0] - c[0], here[1] - c[1]) < 2 * UM):
            c = None
        ret.append((x, y, c))
        here = (x, y)
    return ret


def begin_at(rnd, edges, poly, offset, inside):
    """The ring begun in the middle of a line: (start, edges, far), or None."""
    lines = [i for i in range(len(edges)) if not edges[i][2]]
    lines.sort(key=lambda i: -math.dist(edges[i - 1][:2], edges[i][:2]))
    way = way_of(poly, offset, inside, poly.representative_point().coords[0])
    for i in lines[:4]:
        p, q = edges[i - 1][:2], edges[i][:2]
        ux, uy, d = unit(p, q)
        s = (round((p[0] + q[0]) / 2, 4), round((p[1] + q[1]) / 2, 4))
        k = 1 if inside else -1
        near = (s[0] - uy * offset * k, s[1] + ux * offset * k)
        far = (s[0] - uy * (offset + .5) * k, s[1] + ux * (offset + .5) * k)
        lead = LineString([near, far])
        if lead.distance(poly.exterior) < offset - 0.1 * UM or (
                way and way.distance(Point(near)) > 0.5 * UM):
            continue
        ring = edges[i:] + edges[:i]
        return s, ring + [(*s, None)], far
    return None


class Contour:
    """A random contour, its NC code, and what should become of it."""

    def __init__(self, rnd):
        while True:
            self.edges = edges_of(rnd, vertices(rnd))
            if len(self.edges) < 3:
                continue
            poly = ring_of(self.edges[-1][:2], self.edges)
            if not poly.is_valid or poly.area < 0.1:
                continue
            self.offset = round(rnd.choice([0.05, 0.11, 0.125, 0.2,
                                            10 ** rnd.uniform(-1.5, .5)]), 4)
            self.inside = rnd.random() < 0.5
            begun = begin_at(rnd, self.edges, poly, self.offset, self.inside)
            if begun:
                break
        self.poly = poly
        self.start, self.ring, self.far = begun
        self.clockwise = rnd.random() < 0.5
        if self.clockwise:
            self.ring = reverse(self.start, self.ring)
        left = self.inside != self.clockwise
        self.text = write_job(self.start, self.far, self.ring,
                              "G41" if left else "G42", self.offset)

        self.about = poly, self.offset, self.inside, self.far

    def can_be_cut(self):
        return can_be_cut(*self.about)

    def is_close(self):
        return is_close(*self.about)

    def left_by(self, path, line=None):
        return left_by(*self.about, path, line)


def reverse(start, edges):
    """The same ring the other way round."""
    pts = [start] + [e[:2] for e in edges]
    return [(*pts[i], edges[i][2] and (*edges[i][2][:2], not edges[i][2][2]))
            for i in range(len(edges) - 1, -1, -1)]
