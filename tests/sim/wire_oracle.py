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

CHORD_MM = 0.0001       # arcs become chords this near to them
UM = 0.001


def arc_points(start, end, centre, clockwise, chord=CHORD_MM):
    """Places along an arc, without its start."""
    cx, cy = centre
    r = math.hypot(start[0] - cx, start[1] - cy)
    a = math.atan2(start[1] - cy, start[0] - cx)
    b = math.atan2(end[1] - cy, end[0] - cx)
    sweep = (a - b if clockwise else b - a) % (2 * math.pi)
    if math.hypot(end[0] - start[0], end[1] - start[1]) < 1e-7:
        sweep = 2 * math.pi
    step = 2 * math.acos(max(1 - chord / max(r, chord), -1))
    n = max(int(math.ceil(sweep / max(step, 1e-3))), 1)
    sign = -1 if clockwise else 1
    pts = [(cx + r * math.cos(a + sign * sweep * i / n),
            cy + r * math.sin(a + sign * sweep * i / n))
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


def rise_of(pts, side):
    """The most by which a line string turns to its side (+1: left)."""
    d = np.diff(pts, axis=0)
    d = d[np.hypot(*d.T) > 1e-9]
    a = np.arctan2(d[:, 1], d[:, 0])
    turns = (np.diff(a) + np.pi) % (2 * np.pi) - np.pi
    heading = np.concatenate([[0], np.cumsum(turns * side)])
    return (heading - np.minimum.accumulate(heading)).max()


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


def left_out(poly, way, offset, inside, about=2 * UM):
    """Stretches of the contour that a wire on the way does not come to, each
    (how far off it is, the turn of the way there, the most by which the
    contour turns inward)."""
    ring = poly.exterior
    if not ring.is_ccw:
        ring = LinearRing(list(ring.coords)[::-1])
    side = 1 if inside else -1
    pts = places_of(ring, way)
    far = shapely.distance(shapely.points(pts), way)
    if far.min() > offset + TOUCHED:
        return [(math.inf, math.pi, math.pi)]
    first = int(np.flatnonzero(far <= offset + TOUCHED)[0])
    pts, far = np.roll(pts, -first, axis=0), np.roll(far, -first)
    missed = np.concatenate([far > offset + TOUCHED, [False]]).astype(int)
    ends = np.flatnonzero(np.diff(missed)) + 1
    corners = np.asarray(way.coords)
    ret = []
    for a, b in zip(ends[::2], ends[1::2]):
        run = np.concatenate([pts[a - 1:b], [pts[b % len(pts)]]])
        # The wire stands as near as it can to both ends of it.
        both = np.hypot(*(corners - run[0]).T) + \
            np.hypot(*(corners - run[-1]).T)
        ret.append((far[a:b].max(), turn_at(way, corners[both.argmin()], side, about),
                    rise_of(run, side)))
    return ret


def can_be_cut(poly, offset, inside, at, hidden=2 * UM, more=0, about=2 * UM):
    """A place that the wire does not come to must lie no farther from it than
    the point of an inner corner does (docs/taper.md).  about: the way on which
    a corner turns."""
    way = way_of(poly, offset, inside, at)
    if way is None:
        return False
    for far, turn, rise in left_out(poly, way, offset, inside, about):
        if rise <= 2.1 + more or (rise <= turn + 0.5 + more and rise < 3):
            turn = max(turn, rise)
        reach = offset / math.cos(turn / 2) if turn < 3 else offset
        # What winds itself up goes on behind a neck.
        if rise > turn + 3.3 + more:
            reach = min(reach, offset / math.cos(2.1 / 2))
        if far > reach + hidden:
            return False
    return True


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
