# SPDX-License-Identifier: Apache-2.0
"""Random contours under a wire's offset, against another geometry.

EDM_SEED repeats a run, EDM_RUNS says how many contours; `make wire-random`
tries ten thousand.
"""
import math
import os
import random

import pytest
from edmsim import ROOT, done, run, seeded
from shapely.geometry import LineString, Point
from wire_contours import Contour
from wire_oracle import UM, path_of, read_iso, write_job

RUNS = int(os.environ.get("EDM_RUNS", 120))


def contours():
    """The same contours in every `make check`; others with EDM_SEED."""
    return seeded() if "EDM_SEED" in os.environ else random.Random(2)


BOUND_MM = 3 * UM       # docs/taper.md: nearer than the offset by this


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    ini = tmp_path_factory.mktemp("wire") / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    return ini


def test_random_contours_are_cut_or_refused_as_geometry_has_it(plain):
    rnd = contours()
    counts, nearest, left, close = {"cut": 0, "refused": 0}, 0, 0, 0
    for i in range(RUNS):
        c = Contour(rnd)
        r = run("--machine", plain, "--emit", "iso", text=c.text)
        assert r.returncode in (0, 1, 65), (r.returncode, r.stderr)
        counts["refused" if r.returncode else "cut"] += 1
        about = f"contour {i}: {r.stderr.decode()}\n{c.text}"
        can = c.can_be_cut()
        if can != (r.returncode == 0):
            assert c.is_close(), about
            close += 1
        if r.returncode:
            assert b"-:" in r.stderr, about
            continue
        path = path_of(read_iso(r.stdout.decode())[2:-1])
        gap = path.distance(c.poly.exterior)
        nearest = max(nearest, c.offset - gap)
        assert gap >= c.offset - BOUND_MM, \
            f"{gap} mm near under {c.offset}: {about}"
        if can:
            left = max(left, c.left_by(path))
            assert left < BOUND_MM, f"{left} mm not cut: {about}"
    print(f"{counts}, {close} of them close to call and otherwise; "
          f"nearer by {1000 * nearest:.2f} um at the worst, "
          f"farther by {1000 * left:.2f}")
    assert close <= 2 + RUNS / 100


def emitted(plain, form, text, *more):
    out = done("--machine", plain, *more, "--emit", form, text=text).stdout
    return out.decode()


def test_4b_records_are_the_same_way_again(plain):
    rnd = contours()
    for _ in range(15):
        c = Contour(rnd)
        if run("--machine", plain, "--emit", "4b", text=c.text).returncode:
            continue
        way = path_of(read_iso(emitted(plain, "iso", c.text))[1:])
        back = emitted(plain, "4b", c.text)
        again = emitted(plain, "iso", back, "--dialect", "4b")
        again = path_of([("G1", *w[1:]) for w in read_iso(again)][1:])
        assert way.hausdorff_distance(again) < 2.5 * UM, back


@pytest.mark.parametrize("form", ["3b", "4b", "iso"])
def test_nothing_comes_out_of_what_records_have_no_word_for(form):
    r = run("--machine", ROOT / "examples/wire.ini", "--emit", form,
            ROOT / "examples/wire-plate.ngc")
    assert r.returncode == 65 and r.stdout == b""
    assert b"two contours at once" in r.stderr


@pytest.mark.parametrize("offset,code", [(2, 0), (2.84, 65), (3, 65)])
def test_a_wire_begun_inside_a_spiral_does_not_leave_the_rest_out(
        plain, offset, code):
    """A wall wound up with 5.68 mm between its turns; the hole lies at its
    inner end."""
    wall = [(r + a, a) for r, turns in ((2, 1), (1.4, -1))
            for a in [i / 10 for i in range(126)][::turns]]
    ring = [(round(r * math.cos(a), 4), round(r * math.sin(a), 4), None)
            for r, a in wall]
    text = write_job((1.7, 0), (1.7, -0.01 - offset), [*ring, (1.7, 0, None)],
                     "G42", offset)
    r = run("--machine", plain, "--check", text=text)
    assert r.returncode == code, r.stderr
    assert not code or b"a width of" in r.stderr or b"no room" in r.stderr


CURVES = [
    ("G5 X20 Y10 I6 J0 P0 Q-6",
     [(10, 0), (16, 0), (20, 4), (20, 10)]),
    ("G5.1 X20 Y10 I10 J0", [(10, 0), (16.667, 0), (20, 3.3333), (20, 10)]),
]


@pytest.mark.parametrize("word,points", CURVES)
def test_a_curve_keeps_the_offset(plain, word, points):
    text = f"""F200 H1=0.125
G0 X5 Y-5
G42 H1
G1 X5 Y0
X10
{word}
G1 Y20
X0
Y0
X5
G40 Y-5
M2
"""
    ways = read_iso(emitted(plain, "iso", text))[2:-1]
    way = path_of(ways)
    bezier = []
    for i in range(2001):
        t = i / 2000
        w = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t ** 3)
        bezier.append(tuple(sum(k * p[j] for k, p in zip(w, points))
                            for j in (0, 1)))
    curve = LineString(bezier)
    assert abs(way.distance(curve) - 0.125) < 1 * UM
    # Seen from the curve, too: the wire comes along all of it.
    for p in bezier[::50]:
        assert abs(way.distance(Point(p)) - 0.125) < 1.5 * UM
