# SPDX-License-Identifier: Apache-2.0
"""Faces that lean to different sides, and parts that vanish on the second plane.

EDM_SEED repeats a run, EDM_RUNS says how many.
"""
import math
import os
import random

import pytest
import shapely
from edmsim import run, seeded
from shapely.geometry import LinearRing
from test_wire_taper import BOUND_MM, HEIGHT, WIRE, job_of, planes, rows_of
from wire_faces import Faces

RUNS = int(os.environ.get("EDM_RUNS", 8))


def test_faces_that_lean_to_any_side_are_cut_as_geometry_has_it():
    # The same in every `make check`; others with EDM_SEED.
    rnd = seeded() if "EDM_SEED" in os.environ else random.Random(6)
    cut, worst = 0, 0
    for i in range(RUNS):
        c = Faces(rnd, HEIGHT)
        text = job_of(c.pts, c.start, c.far, c.degrees,
                      "G41" if c.inside else "G42", c.offset)
        r = run("--machine", WIRE, "--check", text=text)
        about = f"{i}: {r.stderr.decode()}\n{text}"
        assert r.returncode in (0, 65), about
        if r.returncode:
            assert b"leans" in r.stderr or b"a lead" in r.stderr or \
                not c.can_be_cut(), about
            continue
        cut += 1
        for outline, at in zip(c.outlines(), planes(rows_of(text))):
            last = len(c.pts) + 4
            on = at[(at[:, 0] >= 4) & (at[:, 0] <= last)][::13, 1:]
            on = shapely.points(on)
            near = shapely.distance(on, outline.exterior).min()
            if outline == c.outlines()[1] and not c.judged:
                continue
            worst = max(worst, min(c.wires) - near)
            assert near > min(c.wires) - BOUND_MM, about
            assert (shapely.contains(outline, on) == c.inside).all(), about
    print(f"{cut} of {RUNS} cut, nearer by {1000 * worst:.2f} um at the worst")
    assert cut > RUNS / 4


RIB = """F200 H1=0.2
G0 X5 Y-4
G42 H1 {taper} G1 X5 Y0
X20
Y15
X{right}
Y{tip}
X10
Y15
X0
Y0
X5
G40 G50 Y-4
M2
"""

# The taper carries the faces 0.7 mm inward, 1 degree over 40 mm.
RIBS = [
    ("G51 A1", 11, 18, "the faces of lines 7 and 10"),  # too thin
    ("G51 A1", 10.2, 15.2, "the faces of lines 7 and 10"),
    ("G51 A1", 15, 15.3, None),                         # lower than they move
    ("G51 A1", 15, 18, None),                           # thick
    ("G52 A1", 11, 12, "the faces of lines 7 and 10"),  # a slot that closes
    ("G52 A1", 15, 12, None),
    ("G52 A1", 11, 14.5, "the faces of lines 7 and 10"),  # lower than they move
]


@pytest.mark.parametrize("taper,right,tip,found", RIBS)
def test_what_is_left_of_a_rib_or_a_slot_above(taper, right, tip, found):
    text = RIB.format(taper=taper, right=right, tip=tip)
    r = run("--machine", WIRE, "--check", text=text)
    assert (r.returncode == 65) == bool(found), r.stderr
    assert not found or found in r.stderr.decode(), r.stderr


def test_an_edge_makes_a_short_face_long_enough_for_its_inner_corner():
    """The face of line 9 is shorter than it moves; that of line 8 gives it the
    length that it needs to meet the face of line 10."""
    text = """F200 H1=0.5
G0 X10 Y-6
G42 H1 G51 A-3 G1 X10 Y0
X20
G51 A3 Y15
G51 A1 X11.101
G51 A2 Y16.623
G51 A-1 X10
G51 A-3 Y15
X0
G51 A3 Y0
G51 A-3 X10
G40 G50 Y-6
M2
"""
    assert run("--machine", WIRE, "--check", text=text).returncode == 0


def test_a_hole_inside_the_part_above_is_no_place_to_begin():
    text = RIB.format(taper="G52 A3", right=15, tip=18)
    near = text.replace("Y-4", "Y-1")
    assert run("--machine", WIRE, "--check", text=text).returncode == 0
    r = run("--machine", WIRE, "--check", text=near)
    assert r.returncode == 65
    assert "a lead that comes within 0.0000 mm" in r.stderr.decode()
    assert "on the second plane" in r.stderr.decode()


def test_what_the_wire_reaches_from_beside_a_mouth_is_not_lost():
    """A groove wider than its mouth of 0.105 mm, into which the wire comes 11.6 um
    deep.  Its walls lean by 30 degrees at the most, or by more."""
    text = """F200 H1=0.125
G0 X2 Y4
G41 H1 G1 X0 Y4
Y0
X5
X{left} Y{deep}
X{right} Y{deep}
X5.105 Y0
X10
Y8
X0
Y4
G40 X2
M2
"""
    for by, deep, code in ((0.007, 0.013, 0), (0.02, 0.013, 65),
                           (0.007, 0.05, 65)):
        r = run("--machine", WIRE, "--check", text=text.format(
            left=5 - by, right=5.105 + by, deep=-deep))
        assert r.returncode == code, r.stderr


def rounded(radius, wave, chord):
    """A wavy circle as chords, its places to a micrometre."""
    n = int(2 * math.pi * radius / chord)
    at = [2 * math.pi * i / n for i in range(n)]
    return [(round(r * math.cos(a), 3), round(r * math.sin(a), 3))
            for a in at for r in [radius + wave * math.sin(6 * a)]]


@pytest.mark.parametrize("word,radius,chord", [
    ("G52 A1", 2, 0.01), ("G51 A1", 2, 0.005), ("G51 A1", 3.1, 0.01),
    ("G52 A1", 3.1, 0.02)])
def test_chords_that_are_short_against_their_rounding(word, radius, chord):
    """Moved by 0.7 mm, they lie on each other and cross hundreds of times."""
    pts = rounded(radius, 0.02, chord)
    out = [f"F200 H1=0.125\nG0 X{radius + 5} Y0",
           f"G42 H1 {word} G1 X{pts[0][0]:.3f} Y{pts[0][1]:.3f}"]
    out += [f"X{x:.3f} Y{y:.3f}" for x, y in pts[1:] + pts[:1]]
    text = "\n".join(out + [f"G40 G50 X{radius + 5} Y0", "M2", ""])
    rows = rows_of(text)
    on = (rows[:, 0] >= 4) & (rows[:, 0] <= len(pts) + 3)
    ring = LinearRing(pts)
    slope = math.tan(math.radians(1))
    wire = 0.125 * math.hypot(1, slope)
    shift = HEIGHT * slope * (1 if word.startswith("G52") else -1)
    for plane, by in zip(planes(rows), (0, shift)):
        off = shapely.distance(shapely.points(plane[on][:, 1:][::7]), ring)
        want = abs(wire + by)
        assert off.min() > want - BOUND_MM - 0.002
        assert off.max() < want + BOUND_MM + 0.01
