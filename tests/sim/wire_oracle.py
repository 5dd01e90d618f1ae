# SPDX-License-Identifier: Apache-2.0
"""wire_oracle.py - contours for a wire, and what their offset should be.

The geometry is that of two libraries that share nothing with edmd: parallels
of polygons are pyclipper's (Clipper), distances shapely's (GEOS).

A contour is a closed ring of edges (x, y, centre): a line to (x, y), or an arc
round centre = (cx, cy, clockwise).
"""
import math

import numpy as np
import pyclipper
import shapely
from shapely.geometry import LinearRing, LineString, Point, Polygon
from shapely.ops import nearest_points, substring

CHORD_MM = 0.0001       # arcs become chords this near to them
UM = 0.001


def arc_points(start, end, centre, clockwise, chord=CHORD_MM):
    """Places along an arc, without its start.  Where rounding has made its ends
    unequally far from the centre, the radius goes from the one to the other: a
    step at the end would be a corner of a small arc."""
    cx, cy = centre
    r = math.hypot(start[0] - cx, start[1] - cy)
    more = math.hypot(end[0] - cx, end[1] - cy) - r
    a = math.atan2(start[1] - cy, start[0] - cx)
    b = math.atan2(end[1] - cy, end[0] - cx)
    sweep = (a - b if clockwise else b - a) % (2 * math.pi)
    if math.hypot(end[0] - start[0], end[1] - start[1]) < 1e-7:
        sweep = 2 * math.pi
    step = 2 * math.acos(max(1 - chord / max(r, chord), -1))
    n = max(int(math.ceil(sweep / max(step, 1e-3))), 1)
    sign = -1 if clockwise else 1
    pts = [(cx + (r + more * i / n) * math.cos(a + sign * sweep * i / n),
            cy + (r + more * i / n) * math.sin(a + sign * sweep * i / n))
           for i in range(1, n)]
    return pts + [end]


def ring_points(start, edges):
    pts = [start]
    for x, y, centre in edges:
        if centre:
            pts += arc_points(pts[-1], (x, y), centre[:2], centre[2])
        else:
            pts.append((x, y))
    return pts


def ring_of(start, edges):
    """The contour as a polygon; its end is its start."""
    return Polygon(ring_points(start, edges)[:-1])


def write_job(start, far, edges, side, offset, more="", feed=200):
    """NC code of it: a straight lead from far to start, and back."""
    out = [f"G90 G90.1 F{feed} H1={offset:.4f}", f"G0 X{far[0]:.4f} Y{far[1]:.4f}",
           f"{side} H1 {more}".rstrip(), f"G1 X{start[0]:.4f} Y{start[1]:.4f}"]
    for x, y, c in edges:
        g = "G1" if not c else "G2" if c[2] else "G3"
        centre = f" I{c[0]:.4f} J{c[1]:.4f}" if c else ""
        out.append(f"{g} X{x:.4f} Y{y:.4f}{centre}")
    out += [f"G40 G50 G1 X{far[0]:.4f} Y{far[1]:.4f}", "M2", ""]
    return "\n".join(out)


# -- What the wire can do -----------------------------------------------------

SCALE = 2.0 ** 22       # places of Clipper are whole numbers
ARC_MM = 0.0001        # its round corners are this near


def ways_of(poly, offset, inside):
    """All rings that are @offset from a polygon's boundary, on one side."""
    clipper = pyclipper.PyclipperOffset(2.0, ARC_MM * SCALE)
    for ring in (poly.exterior, *poly.interiors):
        at = np.rint(np.asarray(ring.coords)[:-1] * SCALE).astype(np.int64)
        clipper.AddPath(at.tolist(), pyclipper.JT_ROUND,
                        pyclipper.ET_CLOSEDPOLYGON)
    rings = clipper.Execute((-offset if inside else offset) * SCALE)
    return [LinearRing(np.array(r) / SCALE) for r in rings if len(r) > 2]


def way_of(poly, offset, inside, at):
    """Where the wire's axis goes: the boundary, seen from at, of the places
    that are offset or more from the part, counter-clockwise.  None if there
    are none."""
    rings = ways_of(poly, offset, inside)
    if not rings:
        return None
    # Outside, a lead from without meets the outermost ring.
    way = min(rings, key=lambda r: r.distance(Point(at))) if inside else \
        max(rings, key=lambda r: Polygon(r).area)
    return way if way.is_ccw else LinearRing(list(way.coords)[::-1])


NEARER = 3 * UM         # docs/taper.md: the wire may come nearer by this
TOUCHED = 0.5 * UM      # a place so near to what the wire reaches is reached
AROUND = 200            # places that are kept on both sides of what is missed


def rise_of(pts, reached, side):
    """The most by which a line string turns to its side (+1: left), without what
    it turned before and at a place that is reached."""
    heading, low, most, last = 0.0, 0.0, 0.0, None
    for (x, y), here in zip(np.diff(pts, axis=0), reached):
        if math.hypot(x, y) < 1e-9:
            continue
        way = math.atan2(y, x)
        if last is not None:
            heading += side * math.remainder(way - last, 2 * math.pi)
        last = way
        low = heading if here else min(low, heading)
        most = max(most, heading - low)
    return most


def foot_of(pts, at, reach):
    """The nearest to @at of the places along the first @reach mm of pts."""
    line = substring(LineString(pts), 0, reach)
    return np.array(nearest_points(line, Point(at))[0].coords[0])


def turn_at(way, at, side, reach):
    """The turn of a ring about one of its places."""
    s = way.project(Point(at))
    p = [np.array(way.interpolate((s + d) % way.length).coords[0])
         for d in (-reach, 0, reach)]
    a, b = p[1] - p[0], p[2] - p[1]
    return math.atan2(a[0] * b[1] - a[1] * b[0], a @ b) * side


def places_of(ring, way):
    """Places along a ring, and those that the way comes nearest to in the middle
    of each of its edges: it may touch the ring over less than a micrometre."""
    corners = np.asarray(way.coords)
    mid = shapely.points((corners[:-1] + corners[1:]) / 2)
    even = shapely.points(np.asarray(shapely.segmentize(ring, 0.02).coords)[:-1])
    at = np.unique(np.concatenate([shapely.line_locate_point(ring, even),
                                   shapely.line_locate_point(ring, mid)]))
    return shapely.get_coordinates(shapely.line_interpolate_point(ring, at))


class Missed:
    """A stretch of the contour that a wire on the way does not come to, from the
    last place that it touches to the next one."""

    def __init__(self, pts, far, reach):
        self.pts, self.far, self.reach = pts, far, reach
        self.run, self.off = pts[reach:-reach], far[reach:-reach]

    def stand(self, way, side, about):
        """Where the wire stands: as near as it can to both ends of it."""
        corners = np.asarray(way.coords)
        both = np.hypot(*(corners - self.run[0]).T) + \
            np.hypot(*(corners - self.run[-1]).T)
        self.at = corners[both.argmin()]
        self.turn = turn_at(way, self.at, side, about)

    def beyond(self, offset):
        """How far each place is beyond a tangent of the wire where it touches
        the contour at the two ends."""
        most = 3 * math.sqrt(2 * TOUCHED * offset)
        ret = np.full(len(self.run), -math.inf)
        for pts in (self.pts[self.reach + 1::-1], self.pts[-self.reach - 2:]):
            foot = foot_of(pts, self.at, most)
            n = (foot - self.at) / math.dist(foot, self.at)
            ret = np.maximum(ret, (self.run - foot) @ n)
        return ret


def left_out(poly, way, offset, inside, about):
    """All Missed of a contour, or None if the wire touches nothing of it."""
    ring = poly.exterior
    if not ring.is_ccw:
        ring = LinearRing(list(ring.coords)[::-1])
    pts = places_of(ring, way)
    far = shapely.distance(shapely.points(pts), way)
    if far.min() > offset + TOUCHED:
        return None
    first = int(np.flatnonzero(far <= offset + TOUCHED)[0])
    pts, far = np.roll(pts, -first, axis=0), np.roll(far, -first)
    missed = np.concatenate([far > offset + TOUCHED, [False]]).astype(int)
    ends = np.flatnonzero(np.diff(missed)) + 1
    ret = []
    for a, b in zip(ends[::2], ends[1::2]):
        i = np.arange(a - 1 - AROUND, b + 1 + AROUND) % len(pts)
        ret.append(Missed(pts[i], far[i], AROUND))
        ret[-1].stand(way, 1 if inside else -1, about)
    return ret


def is_left_by_a_corner(m, offset, side, hidden, more):
    """Is what is missed no more than an inner corner leaves (docs/taper.md)?"""
    reached = m.off <= offset + hidden
    rise, turn = rise_of(m.run, reached, side), m.turn
    if rise <= 2.1 + more or (rise <= turn + 0.5 + more and rise < 3):
        turn = max(turn, rise)
    elif (m.beyond(offset)[~reached] > hidden).any():
        return False
    reach = offset / math.cos(turn / 2) if turn < 3 else offset
    return m.off.max() <= reach + hidden


def can_be_cut(poly, offset, inside, at, hidden=2 * UM, more=0, about=2 * UM):
    """Can a wire cut it, by the rule of docs/taper.md?  hidden: so much may be
    missing anywhere; about: the way on which a corner turns."""
    way = way_of(poly, offset, inside, at)
    if way is None:
        return False
    missed = left_out(poly, way, offset, inside, about)
    return missed is not None and all(
        is_left_by_a_corner(m, offset, 1 if inside else -1, hidden, more)
        for m in missed)


def is_close(poly, offset, inside, at):
    """Is the answer another one for a wire that is nearer by the bound of
    docs/taper.md, or farther by a micrometre, or if corners are rounded?"""
    said = can_be_cut(poly, offset, inside, at)
    if can_be_cut(poly, max(offset - NEARER, UM), inside, at, 6 * UM,
                  0.05) != said:
        return True
    # Two corners of the way, so near to each other that they may be one.
    if can_be_cut(poly, offset, inside, at, about=6 * UM) != said:
        return True
    return said and not can_be_cut(poly, offset + UM, inside, at, UM, -0.05)


def verdict(poly, offset, inside, at):
    """What is to be said of it: "cut", "refuse" or "close" to call."""
    if is_close(poly, offset, inside, at):
        return "close"
    return "cut" if can_be_cut(poly, offset, inside, at) else "refuse"


def left_by(poly, offset, inside, at, path, line=None):
    """How far a path is, beyond the offset, from places of the contour, or of a
    line that is a part of it, that a wire can come to."""
    way = way_of(poly, offset, inside, at)
    pts = shapely.points(np.asarray(
        shapely.segmentize(line or poly.exterior, 0.1).coords))
    reached = shapely.distance(pts, way) <= offset + TOUCHED
    return shapely.distance(pts[reached], path).max() - offset


# -- What edmsim made of it -----------------------------------------------------

def read_iso(text):
    """Ways of --emit iso: (from, to, centre or None), from the first G1 on."""
    here, g, ways = (0.0, 0.0), None, []
    for line in text.splitlines():
        words = dict((w[0], w[1:]) for w in line.split() if w[0] in "XYIJ")
        codes = [w for w in line.split() if w in ("G0", "G1", "G2", "G3")]
        g = codes[0] if codes else g
        if not words:
            continue
        to = (float(words.get("X", here[0])), float(words.get("Y", here[1])))
        centre = None
        if g in ("G2", "G3"):
            centre = (here[0] + float(words.get("I", 0)),
                      here[1] + float(words.get("J", 0)), g == "G2")
        ways.append((g, here, to, centre))
        here = to
    return ways


def path_of(ways):
    """The ways as one line string, without the rapid ones."""
    pts = []
    for g, start, end, centre in ways:
        if g == "G0":
            continue
        if not pts:
            pts = [start]
        if centre:
            pts += arc_points(start, end, centre[:2], centre[2])
        else:
            pts.append(end)
    return LineString(pts)
