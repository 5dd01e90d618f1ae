#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""plan_cavities.py - cavities whose ways out are known, for edm-plan --end-pose

        tests/sim/plan_cavities.py NAME DIR

writes part.stl, electrode.stl and machine.ini into DIR and prints the end pose,
the fewest blocks that are known, and the most clearance of them; without
arguments, the names.  A way of a prism is known, because its cavity is what the
electrode sweeps along it, and GAP mm more.

Numbers are mm and degrees.
"""
import math
import random
import sys
from pathlib import Path

import numpy as np
from shapely.geometry import MultiPoint, Polygon, box
from shapely.ops import unary_union

try:
    from test_plan import write_stl
except ModuleNotFoundError:
    sys.path.insert(0, str(Path(__file__).parent))
    from test_plan import write_stl

LIFT = 60.0                     # of the electrode with all axes at 0
WIDE = 25.0                     # half of the block, along Y
DEEP = 3.0                      # half of the bar, along Y


# -- Meshes --------------------------------------------------------------------

def ears(ring):
    """Triangles of a simple polygon, counterclockwise, as numbers of points."""
    left, out = list(range(len(ring))), []

    def turn(a, b, c):
        (ax, ay), (bx, by), (cx, cy) = ring[a], ring[b], ring[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    def is_ear(i):
        a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
        if turn(a, b, c) <= 1e-12:
            return False
        return not any(turn(a, b, k) >= 0 and turn(b, c, k) >= 0 and
                       turn(c, a, k) >= 0 for k in left if k not in (a, b, c))
    while len(left) > 3:
        i = next(i for i in range(len(left)) if is_ear(i))
        out.append((left[i - 1], left[i], left[(i + 1) % len(left)]))
        del left[i]
    return out + [tuple(left)]


def ring_of(polygon):
    r = list(polygon.exterior.coords)[:-1]
    if not polygon.exterior.is_ccw:
        r.reverse()
    keep = []
    for i, p in enumerate(r):
        a, b = r[i - 1], r[(i + 1) % len(r)]
        if abs((p[0] - a[0]) * (b[1] - a[1]) -
               (p[1] - a[1]) * (b[0] - a[0])) > 1e-9:
            keep.append(p)
    return keep


def prism(polygon, low, high, skip=None):
    """A polygon of X and Z, drawn along Y; @skip(p, q) leaves out a side."""
    r = ring_of(polygon)
    at = [[(x, y, z) for x, z in r] for y in (low, high)]
    tris = []
    for a, b, c in ears(r):
        tris += [(at[0][a], at[0][b], at[0][c]), (at[1][a], at[1][c], at[1][b])]
    for i in range(len(r)):
        k = (i + 1) % len(r)
        if skip and skip(r[i], r[k]):
            continue
        tris += [(at[0][i], at[1][i], at[1][k]), (at[0][i], at[1][k], at[0][k])]
    return tris


def turned(tris):
    return [(a, c, b) for a, b, c in tris]


def block_round(cavity, depth, wide=(-30, 40), half=WIDE):
    """A block with a cavity that is open at z = 0, or closed."""
    low = math.floor(cavity.bounds[1]) - 8
    tris = turned(prism(cavity, -depth, depth,
                        lambda p, q: p[1] == q[1] == 0))
    if cavity.bounds[3] < 0:
        return tris + prism(box(wide[0], low, wide[1], 0), -half, half)
    tris += prism(box(wide[0], low, wide[1], 0), -half, half,
                  lambda p, q: p[1] == q[1] == 0)
    # The top, with the mouth as a hole in it.
    x0, x1 = (f(x for x, z in ring_of(cavity) if z == 0) for f in (min, max))
    hole = [(x0, -depth), (x1, -depth), (x1, depth), (x0, depth)]
    rim = [(wide[0], -half), (wide[1], -half), (wide[1], half), (wide[0], half)]
    for i in range(4):
        k = (i + 1) % 4
        tris += [tuple((*p, 0.0) for p in t) for t in
                 ((rim[i], rim[k], hole[k]), (rim[i], hole[k], hole[i]))]
    return tris


def moved(tris, turn=np.eye(3), by=(0, 0, 0)):
    return [tuple(tuple(turn @ np.array(p) + by) for p in t) for t in tris]


def machine(chain="X Y Z"):
    text = "[machine]\nname = cavity\nfeed_default_mm_min = 60\n"
    text += "[kinematics]\nchain = %s\n" % chain
    for a in "XYZABCUV":
        text += "[axis.%s]\n" % a
        text += "travel_min_mm = -400\ntravel_max_mm = 400\n" \
            if a in chain else "present = no\n"
    return text


# -- Cavities --------------------------------------------------------------------

class Case:
    """Bodies, where the way ends, and what is known of the way."""

    def __init__(self, part, electrode, blocks, gap, chain="X Y Z", turn=None):
        turn = np.eye(3) if turn is None else turn
        self.part = moved(part, turn)
        self.electrode = moved(electrode, turn, (0, 0, LIFT))
        self.blocks, self.gap, self.chain = blocks, gap, chain
        self.end = "X0,Y0,Z%g" % -LIFT + (",C0" if "C" in chain else "")

    def write(self, folder):
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        write_stl(folder / "part.stl", self.part)
        write_stl(folder / "electrode.stl", self.electrode)
        (folder / "machine.ini").write_text(machine(self.chain))


def swept(way, bar, gap):
    """What a bar takes along a way, and @gap more."""
    bar = bar.buffer(gap, join_style="mitre")
    legs = [MultiPoint([(x + dx, z + dz) for dx, dz in (p, q)
                        for x, z in bar.exterior.coords]).convex_hull
            for p, q in zip(way, way[1:])]
    return unary_union(legs)


def along(way, bar, gap, more=(), turn=None):
    """A bar that went into a block along @way; the first of it is above."""
    cavity = unary_union([swept(w, bar, gap) for w in (way, *more)])
    cavity = cavity.intersection(box(-1000, -1000, 1000, 0))
    cavity = Polygon([(round(x, 6), round(z, 6) + 0.0)
                      for x, z in ring_of(cavity)])
    end = Polygon([(x + way[-1][0], z + way[-1][1])
                   for x, z in bar.exterior.coords])
    return Case(block_round(cavity, DEEP + gap),
                prism(end, -DEEP, DEEP),
                len(way) - 1, gap, turn=turn)


def bar_of(wide, high, lean=0.0):
    c, s = math.cos(math.radians(lean)), math.sin(math.radians(lean))
    return Polygon([(x * c + z * s, z * c - x * s)
                    for x, z in ((-wide / 2, -high / 2), (wide / 2, -high / 2),
                                 (wide / 2, high / 2), (-wide / 2, high / 2))])


def rib(lean, gap, turn=None):
    """A bar in a straight slot that leans."""
    s = math.tan(math.radians(lean))
    return along([(43 * s, 25), (0, -18)], bar_of(1.2, 35, lean), gap,
                 turn=turn)


def turns(n, gap, turn=None):
    """A bar under ledges, down and aside in turns."""
    way, x, z = [(0, 8)], 0, 0
    for i in range(n + 1):
        if i % 2 == 0:
            z -= 11
        else:
            x += (9, -13)[i // 2 % 2]
        way.append((x, z))
    return along(way, bar_of(3, 4), gap, turn=turn)


def drawn(seed, inclined, turn=None):
    """Legs by chance."""
    draw = random.Random(seed)
    n = draw.randint(2, 4)
    gap = draw.choice([0.4, 0.6, 1.0])
    way, x, z = [(0, 8), (0, -draw.uniform(8, 12))], 0, 0
    z = way[-1][1]
    for i in range(n - 1):
        if inclined:
            a = math.radians(draw.uniform(25, 65)) * (-1) ** i
            r = draw.uniform(9, 14)
            x, z = x + r * math.sin(a), z - r * math.cos(a)
        elif i % 2 == 0:
            x += draw.uniform(8, 12) * (-1) ** (i // 2)
        else:
            z -= draw.uniform(8, 12)
        way.append((x, z))
    return along(way, bar_of(draw.uniform(2, 4), draw.uniform(2, 4)), gap,
                 turn=turn)


def dead_end(gap):
    """A pocket goes on beyond the way out."""
    return along([(0, 8), (0, -12), (12, -12), (12, -24)], bar_of(3, 4), gap,
                 [[(12, -12), (24, -12)], [(0, -12), (-14, -12), (-14, -6)]])


def caged(gap):
    """A mouth that is too narrow: no way leads out."""
    wide = swept([(0, -10), (0, -22)], bar_of(6, 6), gap)
    mouth = box(-1.5, -12, 1.5, 0)
    cavity = unary_union([wide, mouth])
    return Case(block_round(cavity, DEEP + gap),
                prism(Polygon([(x, z - 22) for x, z in
                               bar_of(6, 6).exterior.coords]), -DEEP, DEEP),
                None, gap)


def dovetail(gap):
    """A foot under two ledges, open at both ends, along Y alone."""
    foot = unary_union([box(-6, -16, 6, -12), box(-2, -14, 2, 5)])
    slot = foot.buffer(gap, join_style="mitre").union(
        box(-2 - gap, -14, 2 + gap, 5)).intersection(box(-99, -99, 99, 0))
    body = box(-30, -24, 30, 0).difference(slot)
    return Case(prism(body, -20, 20), prism(foot, -26, 26), 1, gap)


def screw(turns_, gap, high=20.0, rings=60, each=6):
    """A square bar that is twisted, in a bore like it: Z and C together."""
    n = 4 * each

    def section(z, half):
        a = 2 * math.pi * turns_ * z / high
        c, s = math.cos(a), math.sin(a)
        out = []
        for k in range(n):
            side, t = divmod(k, each)
            u, v = half, half * (2 * t / each - 1)
            for _ in range(side):
                u, v = -v, u
            out.append((u * c - v * s, u * s + v * c, z))
        return out

    def skin(low, high_):
        return [t for k in range(n) for t in (
            (low[k], low[(k + 1) % n], high_[(k + 1) % n]),
            (low[k], high_[(k + 1) % n], high_[k]))]

    def lid(ring, up):
        mid = tuple(np.mean(ring, axis=0))
        return [(mid, ring[(k + 1 - up) % n], ring[(k + up) % n])
                for k in range(n)]
    zs = [-high + high * i / rings for i in range(rings + 1)]
    bore = [section(z, 4 + gap) for z in zs]
    bar = [section(z, 4) for z in zs]
    hull = [section(z, 9) for z in zs]
    tris = [t for a, b in zip(hull, hull[1:]) for t in skin(a, b)]
    tris += [t for a, b in zip(bore, bore[1:]) for t in turned(skin(a, b))]
    tris += skin(hull[-1], bore[-1]) + skin(bore[0], hull[0])
    tool = [t for a, b in zip(bar, bar[1:]) for t in skin(a, b)]
    tool += lid(bar[0], 0) + lid(bar[-1], 1)
    return Case(tris, tool, 1, gap, "X Y Z C")


def tilt(seed):
    """A rotation about a drawn axis."""
    draw = random.Random(seed)
    u = np.array([draw.gauss(0, 1) for _ in range(3)])
    u /= np.linalg.norm(u)
    a = math.radians(draw.uniform(5, 40))
    k = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return np.eye(3) + math.sin(a) * k + (1 - math.cos(a)) * k @ k


CASES = {}
for _lean in (2, 5, 10, 25):
    for _gap in (0.4, 1.0):
        CASES["rib-%d-%g" % (_lean, _gap)] = \
            lambda turn=None, a=_lean, g=_gap: rib(a, g, turn)
for _n in (1, 2, 3, 4, 5):
    CASES["turns-%d" % _n] = lambda turn=None, n=_n: turns(n, 1.0, turn)
CASES["turns-2-narrow"] = lambda turn=None: turns(2, 0.4, turn)
for _seed in range(1, 6):
    CASES["right-angles-%d" % _seed] = \
        lambda turn=None, s=_seed: drawn(s, False, turn)
    CASES["inclined-%d" % _seed] = \
        lambda turn=None, s=_seed: drawn(s, True, turn)
CASES["dead-end"] = lambda turn=None: dead_end(1.0)
CASES["dead-end-narrow"] = lambda turn=None: dead_end(0.4)
CASES["dovetail"] = lambda turn=None: dovetail(0.6)
CASES["screw"] = lambda turn=None: screw(0.5, 0.6)
CASES["screw-narrow"] = lambda turn=None: screw(0.5, 0.3)
CASES["screw-long"] = lambda turn=None: screw(0.8, 0.6)
CASES["caged"] = lambda turn=None: caged(0.6)


def main():
    if len(sys.argv) != 3:
        print("\n".join(CASES))
        return
    name, _, seed = sys.argv[1].partition("@")
    case = CASES[name](tilt(int(seed)) if seed else None)
    case.write(sys.argv[2])
    print(case.end, case.blocks, case.gap)


if __name__ == "__main__":
    main()
