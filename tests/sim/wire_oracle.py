# SPDX-License-Identifier: Apache-2.0
"""wire_oracle.py - contours for a wire, and what their offset should be.

The geometry is shapely's (GEOS): buffers of polygons and distances.  Nothing
here knows how edmd joins or leaves out anything.

A contour is a closed ring of edges (x, y, centre): a line to (x, y), or an arc
round centre = (cx, cy, clockwise).
"""
import math

import numpy as np
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

def about(ring, pts, reach):
    """Places on a ring, @reach before and behind those next to @pts."""
    s = shapely.line_locate_point(ring, shapely.points(pts))
    return [shapely.get_coordinates(shapely.line_interpolate_point(
        ring, (s + d) % ring.length)) for d in (-reach, 0, reach)]


def turns_at(ring, pts, reach):
    """How far a ring turns about each of its places, in radian."""
    p = about(ring, pts, reach)
    a, b = p[1] - p[0], p[2] - p[1]
    return np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
                             (a * b).sum(axis=1)))


def corners_of(way):
    """Places where the wire turns in a corner, by how much, and which way a
    corner of the part lies from there (a unit vector)."""
    c = np.asarray(way.coords)[:-1]
    d = np.roll(c, -1, axis=0) - c
    a = np.arctan2(d[:, 1], d[:, 0])
    rough = np.abs((a - np.roll(a, 1) + np.pi) % (2 * np.pi) - np.pi)
    at = c[rough > 0.01]
    if not len(at):
        return at, np.empty(0), at
    p = about(way, at, 3 * UM)
    v = at - (p[0] + p[2]) / 2
    toward = v / np.maximum(np.hypot(*v.T), 1e-12)[:, None]
    return at, turns_at(way, at, 3 * UM), toward


def way_of(poly, offset, inside, at):
    """Where the wire's axis goes: the boundary, seen from at, of the places
    that are offset or more from the part.  None if there are none."""
    area = poly.buffer(-offset if inside else offset, quad_segs=256)
    if area.is_empty:
        return None
    parts = list(area.geoms) if hasattr(area, "geoms") else [area]
    rings = [r for p in parts for r in ([p.exterior] if inside else
                                        [p.exterior, *p.interiors])]
    # Outside, a lead from without meets the outermost ring.
    if not inside:
        return max(rings, key=lambda r: Polygon(r).area)
    return min(rings, key=lambda r: r.distance(Point(at)))


NEARER = 3 * UM         # docs/taper.md: the wire may come nearer by this


def verdict(poly, offset, inside, at):
    """As verdict_of(), but a contour that a wire with an offset less by the bound
    could cut is close to call: there it may go where it may not."""
    said = verdict_of(poly, offset, inside, at)
    if said == "refuse" and offset > NEARER and \
            verdict_of(poly, offset - NEARER, inside, at) != "refuse":
        return "close"
    return said


def verdict_of(poly, offset, inside, at):
    """What is to be said of it: "cut", "refuse", or "close" to call.

    A place of the contour is cut if the wire comes to it, or if it lies in an
    inner corner: within offset / cos(turn / 2) of a place where the wire turns,
    between the two places it touches there.  A place that is hidden by a
    corner of the contour alone is close to call.

    A buffer of GEOS leaves out hollows of a hundredth of its distance, so a
    place that is missed by no more than that is close to call, too.
    """
    blur = max(0.5 * UM, 0.01 * offset)
    sure = 4 * UM + blur
    way = way_of(poly, offset, inside, at)
    if way is None:
        return "refuse" if way_of(poly, offset * 0.98, inside, at) is None \
            else "close"
    ring = poly.exterior
    pts = np.asarray(shapely.segmentize(ring, 0.05).coords)
    shapely.prepare(way)
    shapely.prepare(ring)
    far = shapely.distance(shapely.points(pts), way)
    corners, turns, toward = corners_of(way)
    if (turns > 3.0).any():
        return "close"
    reach = offset / np.cos(turns / 2)
    vague = sure + reach * np.tan(turns / 2) * 0.004
    result = "cut"
    for i in np.flatnonzero(far > offset + 0.5 * UM):
        v = pts[i] - corners
        off = np.hypot(*v.T) if len(corners) else np.empty(0)
        between = np.einsum("ij,ij->i", v, toward) >= \
            off * np.cos(np.minimum(turns / 2 + 0.05, np.pi / 2))
        if (between & (off < reach + UM)).any():
            continue
        if (off < reach + vague).any() or far[i] < offset + sure:
            result = "close"
            continue
        order = np.argsort(np.hypot(*(pts - pts[i]).T))[:200]
        near = pts[order][np.hypot(*(pts[order] - pts[i]).T) < offset]
        own = max(turns_at(ring, near, w).max()
                  for w in (UM, 10 * UM, 50 * UM, offset / 4, offset / 2,
                            offset * 0.7))
        if own < 3.0 and far[i] > 1.05 * offset / math.cos(own / 2) + sure:
            return "refuse"
        result = "close"
    return result


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
