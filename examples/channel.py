#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""channel.py - a channel of a closed blisk and the electrode that fills it

        examples/channel.py [options] DIR

writes into DIR

        part.stl        the finished part round the channel
        electrode.stl   the electrode, with its stem and the holder's plate
        machine.ini     a six-axis sinker: [kinematics], travel
        dense.ngc       the way in, as a post-processor has it: 63 nodes

The channel follows an arc that is wrapped on the blisk: it goes 40 mm along and
turns by 65 degrees on the way.  Its section is an oblong with round corners that
leans as it goes.  The electrode is the channel at its end place, smaller all
round by the undersize.  Numbers are mm and degrees.

The electrode's mesh is given as it hangs with all axes at 0: straight above its
end place by LIFT.  --seed draws another channel of the same kind; --rings and
--around set how finely the surfaces are cut.
"""
import argparse
import math
import os
import random
import struct

LIFT = 60.0                     # of the electrode with all axes at 0
CORNER = 2.0                    # radius in the corners of a section
TABLE = (0.0, 0.0, -60.0)       # a point on the axes of A and B


class Channel:
    """Numbers of one channel."""

    def __init__(self, args):
        self.radius = args.radius
        self.turn = math.radians(args.turn)
        self.along = args.along
        self.wide, self.high = args.wide / 2, args.high / 2
        self.widen = args.widen / 2
        self.lean = math.radians(args.lean)
        self.twist = math.radians(args.twist)
        self.undersize = args.undersize
        # The arc: its chord has the length `along` in the unrolled plane.
        self.bend = self.along / 2 / math.sin(self.turn / 2)
        self.length = self.bend * self.turn

    def plane(self, s):
        """Unrolled place and direction at s along the centre line."""
        a = s / self.bend - self.turn / 2       # from the way down
        y = self.bend * (math.cos(a) - math.cos(self.turn / 2))
        z = -self.bend * (math.sin(a) + math.sin(self.turn / 2))
        return (y, z), (-math.sin(a), -math.cos(a))

    def frame(self, s):
        """Place, and the columns across, out and along, at s."""
        (y, z), (dy, dz) = self.plane(s)
        t = y / self.radius
        out = (math.cos(t), math.sin(t), 0.0)
        round_ = (-math.sin(t), math.cos(t), 0.0)
        place = (self.radius * (out[0] - 1), self.radius * out[1], z)
        way = tuple(dy * round_[i] + (dz if i == 2 else 0) for i in range(3))
        across = cross(out, way)
        return place, (across, out, way)

    def section(self, s, grow, n):
        """n points of the section at s, larger by grow."""
        share = min(max(s / self.length, 0), 1)
        a = self.wide + self.widen * (share - 0.5) + grow
        b = self.high + grow
        lean = self.lean + self.twist * (share - 0.5)
        place, (across, out, _) = self.frame(s)
        points = []
        r = CORNER + grow
        for k in range(n):
            corner, step = divmod(k, n // 4)
            t = math.pi / 2 * (corner + step / (n // 4 - 1))
            x = (a - r) * (1, -1, -1, 1)[corner] + r * math.cos(t)
            y = (b - r) * (1, 1, -1, -1)[corner] + r * math.sin(t)
            x, y = (x * math.cos(lean) - y * math.sin(lean),
                    x * math.sin(lean) + y * math.cos(lean))
            points.append(tuple(place[i] + x * across[i] + y * out[i]
                                for i in range(3)))
        return points


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0])


# -- Meshes ---------------------------------------------------------------------

def skin(rings, inward=False):
    """Triangles between rings of equally many points."""
    out = []
    for low, high in zip(rings, rings[1:]):
        n = len(low)
        for k in range(n):
            a, b, c, d = low[k], low[(k + 1) % n], high[(k + 1) % n], high[k]
            out += [(a, b, c), (a, c, d)] if not inward else \
                   [(a, c, b), (a, d, c)]
    return out


def cap(ring, flip):
    """A fan over a ring; its corner is the middle."""
    n = len(ring)
    mid = tuple(sum(p[i] for p in ring) / n for i in range(3))
    return [(mid, ring[(k + flip) % n], ring[(k + 1 - flip) % n])
            for k in range(n)]


def part(ch, rings, around):
    """A tube with walls of 6 mm round the channel, open at both ends."""
    stations = [ch.length * i / rings for i in range(rings + 1)]
    inner = [ch.section(s, 0, around) for s in stations]
    outer = [ch.section(s, 6, around) for s in stations]
    return (skin(outer) + skin(inner, inward=True) +
            skin([inner[0], outer[0]]) + skin([outer[-1], inner[-1]]))


def electrode(ch, rings, around):
    """The channel's shape, thinner; 8 mm of stem; the plate it is held by."""
    stem = max(rings // 5, 1)
    stations = ([-14, -8] + [-8 * (1 - i / stem) for i in range(stem)] +
                [ch.length * i / rings for i in range(rings + 1)])
    grows = [4, 4] + [-ch.undersize] * (len(stations) - 2)
    body = [ch.section(s, g, around) for s, g in zip(stations, grows)]
    tris = skin(body) + cap(body[0], 1) + cap(body[-1], 0)
    return [tuple((x, y, z + LIFT) for x, y, z in t) for t in tris]


def write_stl(path, tris, name):
    with open(path, "wb") as f:
        f.write(name.encode().ljust(80, b" ") + struct.pack("<I", len(tris)))
        for t in tris:
            f.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))


# -- The way in -------------------------------------------------------------------

def rotation_from(a, b):
    """The rotation that takes frame a (columns) to frame b."""
    return [[sum(b[k][i] * a[k][j] for k in range(3)) for j in range(3)]
            for i in range(3)]


def times(m, v):
    return [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]


def times_back(m, v):
    return [sum(m[k][i] * v[k] for k in range(3)) for i in range(3)]


def pose(ch, back):
    """Rotation and shift of the electrode, `back` mm before its end place.

    The middle of what is inside follows the centre line, along its tangent.
    """
    s = (min(back, ch.length) + ch.length) / 2
    here, cols = ch.frame(s - back)
    end, end_cols = ch.frame(s)
    r = rotation_from(end_cols, cols)
    moved = times(r, end)
    return r, [here[i] - moved[i] for i in range(3)]


def axes(r, shift):
    """The axes of chain A B X Y Z C: A and B turn the work, C the electrode."""
    b = math.asin(max(-1, min(1, r[0][2])))
    a = math.atan2(-r[1][2], r[2][2])
    c = math.atan2(-r[0][1], r[0][0])
    # Where the point of the electrode that hangs at 0 0 LIFT has to go:
    p = [shift[i] - TABLE[i] for i in range(3)]
    ra = [[1, 0, 0], [0, math.cos(a), -math.sin(a)],
          [0, math.sin(a), math.cos(a)]]
    rb = [[math.cos(b), 0, math.sin(b)], [0, 1, 0],
          [-math.sin(b), 0, math.cos(b)]]
    q = times_back(rb, times_back(ra, p))
    return [q[0] + TABLE[0], q[1] + TABLE[1], q[2] + TABLE[2] - LIFT,
            math.degrees(a), math.degrees(b), math.degrees(c)]


def write_dense(path, ch, nodes):
    out = ch.length + 5
    with open(path, "w", encoding="ascii") as f:
        f.write("(the way into the channel, dense: %d nodes)\n"
                "G21 G90 G94 M5\n" % nodes)
        for k in range(nodes):
            q = axes(*pose(ch, out * (1 - k / (nodes - 1))))
            words = " ".join("%s%.4f" % (w, v + 0.0)
                             for w, v in zip("XYZABC", q))
            if k == 0:
                z = "G0 Z%.4f\n" % max(q[2], 0)
                f.write(z + "G0 X%.4f Y%.4f A%.4f B%.4f C%.4f\n" %
                        (q[0], q[1], *q[3:]))
                f.write("G0 %s\nM3\n" % words)
            else:
                f.write("G1 %s%s\n" % (words, " F30" if k == 1 else ""))
        f.write("M2\n")


MACHINE = """\
; SPDX-License-Identifier: Apache-2.0
;
; A sinker of six axes: the work on a table that tilts about A and B, 60 mm
; under the place of the channel's mouth, the electrode on X Y Z and a spindle C.

[machine]
name = channel
backend = sim
strategy = simultaneous

[axis.X]
travel_min_mm = -200
travel_max_mm = 200

[axis.Y]
travel_min_mm = -200
travel_max_mm = 200

[axis.Z]
travel_min_mm = -200
travel_max_mm = 200
v_max_mm_s = 80
a_max_mm_s2 = 1000

[axis.A]
travel_min_mm = -110        ; deg
travel_max_mm = 110
v_max_mm_s = 30
a_max_mm_s2 = 300

[axis.B]
travel_min_mm = -60         ; deg
travel_max_mm = 60
v_max_mm_s = 30
a_max_mm_s2 = 300

[axis.C]
v_max_mm_s = 60             ; deg/s
a_max_mm_s2 = 600

[axis.U]
present = no

[axis.V]
present = no

[kinematics]
chain = A(%g %g %g) B(%g %g %g) X Y Z C(0 0 0)
tolerance_um = 1

; Many jumps, as a channel of graphite needs: docs/experiments-jump.md.
[jump]
every_s = 0.543
height_mm = 3
""" % (TABLE + TABLE)


def arguments():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("dir")
    p.add_argument("--seed", type=int, help="draw a channel")
    p.add_argument("--rings", type=int, default=40)
    p.add_argument("--around", type=int, default=48,
                   help="points of a section, a multiple of 4")
    p.add_argument("--nodes", type=int, default=63)
    for name, value in (("radius", 90), ("turn", 65), ("along", 40),
                        ("wide", 8), ("widen", -0.2), ("high", 14),
                        ("lean", 3), ("twist", 0),
                        ("undersize", 0.95)):
        p.add_argument("--" + name, type=float, default=value)
    args = p.parse_args()
    if args.seed is not None:
        draw = random.Random(args.seed).uniform
        args.turn = draw(60, 70)
        args.lean = draw(-4, 4)
        args.wide = draw(7.5, 8.4)
        args.widen = draw(-0.4, 0.2)
        args.radius = draw(85, 95)
        args.undersize = draw(0.85, 1.0)
    return args


def main():
    args = arguments()
    ch = Channel(args)
    os.makedirs(args.dir, exist_ok=True)
    write_stl(os.path.join(args.dir, "part.stl"),
              part(ch, args.rings, args.around), "part")
    write_stl(os.path.join(args.dir, "electrode.stl"),
              electrode(ch, args.rings, args.around), "electrode")
    write_dense(os.path.join(args.dir, "dense.ngc"), ch, args.nodes)
    with open(os.path.join(args.dir, "machine.ini"), "w",
              encoding="ascii") as f:
        f.write(MACHINE)


if __name__ == "__main__":
    main()
