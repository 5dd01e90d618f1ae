# SPDX-License-Identifier: Apache-2.0
"""written.py - programs as people and post processors write them, each with the way
that the wire or the electrode takes, worked out by hand.

A file of tests/data/written has programs like this:

    == name, dialect
    the program
    -- way
    0,0 5,0 (5,2)+7,2           lines; an arc round (5, 2), + counter-clockwise
    -- refused
    words of the refusal
    -- faces
    0,0 5,0                     of the bottom, and in the next line of the top
    -- peer
                                LinuxCNC's own interpreter says the way

A place is X,Y or X,Y,Z.  What a program leaves out stays.  `x3` behind a place in
brackets repeats: [1,0 0,0]x3.
"""
import math
import re

import numpy as np

from edmsim import ROOT

FOLDER = ROOT / "tests/data/written"
STEP = math.radians(1)
TOKEN = re.compile(r"(?:\(([-\d.]+),([-\d.]+)\)([+-]))?([-\d.]+(?:,[-\d.]+)*)")


class Written:
    def __init__(self, file, name, dialect, text, kind, want):
        self.file = file
        self.name, self.dialect, self.text = name, dialect, text
        self.kind, self.want = kind, want


def programs(file):
    """All of a file."""
    ret = []
    for part in re.split(r"^== ", file.read_text(), flags=re.M)[1:]:
        head, rest = part.split("\n", 1)
        name, dialect = head.rsplit(", ", 1)
        text, kind, want = re.split(r"^-- (\w+)\n", rest, flags=re.M)
        ret.append(Written(file.stem, name, dialect, text, kind, want.strip()))
    return ret


def repeated(want):
    return re.sub(r"\[([^]]*)\]x(\d+)",
                  lambda m: " ".join([m[1]] * int(m[2])), want)


def angles(at, to, centre, sense):
    """Where an arc begins, and how far it turns; equal ends make a full circle."""
    a, b = (math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (at, to))
    sweep = sense * (b - a) % (2 * math.pi)
    if sweep < 1e-9 or 2 * math.pi - sweep < 1e-9:
        sweep = 2 * math.pi
    return a, sweep


def arc(at, to, centre, sense):
    """Places of an arc behind its start."""
    a, sweep = angles(at, to, centre, sense)
    n = max(int(sweep / STEP), 2)
    r = math.dist(at[:2], centre)
    z = at[2], to[2]
    return [(centre[0] + r * math.cos(a + sense * sweep * i / n),
             centre[1] + r * math.sin(a + sense * sweep * i / n),
             z[0] + (z[1] - z[0]) * i / n) for i in range(1, n)] + [to]


def way_of(want):
    """The places of a way, as it is worked out."""
    pts = []
    for cx, cy, sense, place in TOKEN.findall(repeated(want)):
        at = [float(v) for v in place.split(",")]
        at = (*at, *(pts[-1][len(at):] if pts else [0.0] * (3 - len(at))))
        if sense:
            pts += arc(pts[-1], at, (float(cx), float(cy)),
                       1 if sense == "+" else -1)
        else:
            pts.append(at)
    return pts


PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


def arc_in(plane, at, to, centre, sense, turns=0):
    """An arc of any plane: centre from the start, on its two axes."""
    order = PLANES[plane]
    p, q = ([v[i] for i in order] for v in (at, to))
    c = p[0] + centre[0], p[1] + centre[1]
    pts, z = [], p[2]
    rise = (q[2] - z) / (turns + angles(p, q, c, sense)[1] / (2 * math.pi))
    for k in range(turns):
        up = [*p[:2], z + rise * (k + 1)]
        pts += arc(p, up, c, sense)
        p = up
    pts += arc(p, q, c, sense)
    return [tuple(v[order.index(i)] for i in range(3)) for v in pts]


def way_of_iso(text):
    """The places of what edmsim --emit iso wrote, rapid ways too."""
    pts, g, plane = [(0.0, 0.0, 0.0)], 0, 17
    for line in text.splitlines():
        words = {w[0]: float(w[1:]) for w in line.split() if w[0] in "XYZIJKP"}
        for w in line.split():
            g = int(w[1]) if w in ("G0", "G1", "G2", "G3") else g
            plane = int(w[1:]) if w in ("G17", "G18", "G19") else plane
        at, to = pts[-1], tuple(words.get(x, v)
                                for x, v in zip("XYZ", pts[-1]))
        if not set(words) & set("XYZIJK"):
            continue
        if g > 1:
            centre = [words.get("IJK"[i], 0) for i in PLANES[plane][:2]]
            pts += arc_in(plane, at, to, centre, 1 if g == 3 else -1,
                          int(words.get("P", 1)) - 1)
        else:
            pts.append(to)
    return pts


CALL = re.compile(r"N\S+ +([A-Z0-9_]+)\((.*)\)")


def way_of_rs274(text):
    """The places of LinuxCNC's canonical calls; None if it refuses."""
    unit, plane, pts = 1.0, 17, [(0.0, 0.0, 0.0)]
    offset = {"SET_G5X_OFFSET": [0] * 3, "SET_G92_OFFSET": [0] * 3}
    for call, args in CALL.findall(text):
        args = [a.strip() for a in args.split(",")]
        shift = [sum(o[i] for o in offset.values()) for i in range(3)]
        if call == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCHES" in args[0] else 1.0
        elif call == "SELECT_PLANE":
            plane = {"XY": 17, "XZ": 18, "YZ": 19}[args[0][-2:]]
        elif call in offset:
            offset[call] = [float(a) * unit for a in args[-6:][:3]]
        elif call in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            pts.append(tuple(float(a) * unit + s
                             for a, s in zip(args, shift)))
        elif call == "ARC_FEED":
            v = [float(a) * unit for a in args]
            turns = int(float(args[4]))
            to, (a, b, c) = [0.0] * 3, PLANES[plane]
            to[a], to[b], to[c] = v[0] + shift[a], v[1] + shift[b], \
                v[5] + shift[c]
            centre = v[2] + shift[a] - pts[-1][a], v[3] + shift[b] - pts[-1][b]
            pts += arc_in(plane, pts[-1], tuple(to), centre,
                          1 if turns > 0 else -1, abs(turns) - 1)
    return pts


def along(pts):
    """How far each place of a way is along it."""
    steps = np.linalg.norm(np.diff(np.array(pts), axis=0), axis=1)
    return np.concatenate([[0], np.cumsum(steps)])


def differs(got, want):
    """What is not alike of two ways, or nothing: they are walked side by side."""
    a, b = along(got), along(want)
    near = 0.0025 + 1e-4 * b[-1]
    if abs(a[-1] - b[-1]) > near:
        return f"{a[-1]:.4f} mm instead of {b[-1]:.4f} mm"
    shares = np.linspace(0, 1, 500)
    p, q = (np.stack([np.interp(shares * w[-1], w, np.array(pts)[:, i])
                      for i in range(3)], 1)
            for w, pts in ((a, got), (b, want)))
    off = np.linalg.norm(p - q, axis=1)
    worst = int(off.argmax())
    return "" if off[worst] <= near else \
        f"{off[worst]:.4f} mm beside it at {q[worst].round(3)}"
