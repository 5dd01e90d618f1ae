# SPDX-License-Identifier: Apache-2.0
"""What a wire may leave out of a contour without a word, at the limits of the rule
in docs/taper.md: slots, necks and chambers in the floor of an opening."""
import math
import random

import pytest
from edmsim import run
from wire_oracle import (is_left_by_a_corner, left_out, path_of, read_iso,
                         ring_of, way_of, write_job)

OFFSET = 0.125
HALF = math.radians(15)     # of the notch
MOUTH = 0.6
DEEP = MOUTH / 2 / math.tan(HALF)


def opening(floor):
    """A square opening; floor: places in its bottom side."""
    edges = [(round(x, 4), round(y, 4), None) for x, y in
             [*floor, (10, 0), (10, 20), (-10, 20), (-10, 0), (-5, 0)]]
    far = (-5, OFFSET + 0.5)
    return ring_of((-5, 0), edges), far, \
        write_job((-5, 0), far, edges, "G41", OFFSET)


def slot(width, depth):
    return [(0, 0), (0, -depth), (width, -depth), (width, 0)]


def notch(*steps):
    """A notch of 30 degrees.  Steps: (depth, how far the wall is behind that of
    the notch), on both sides."""
    left = [(-MOUTH / 2, 0)]
    for depth, behind in steps:
        left.append(((depth - DEEP) * math.tan(HALF) - behind, -depth))
    return [*left, (0, -DEEP), *[(-x, y) for x, y in left[::-1]]]


def step(behind):
    return (0.75, 0), (0.75, behind), (0.85, behind), (0.85, 0)


# The wire comes 0.05 mm deep into a slot of 0.2 mm, 0.0010 into one of 0.032.
CUT = {
    "a slot whose bottom the wire comes to": slot(0.2, 0.0495),
    "a slot with a micrometre left on its bottom": slot(0.2, 0.051),
    "a scratch": slot(0.032, 0.0025),
    "a notch": notch(),
    "a notch with ribs on its walls": notch(*step(-0.01)),
    "a notch with a micrometre of noise": notch(*step(0.001)),
    "a step": [(0, 0), (0, 0.06), (5, 0.06), (5, 0)],
}
MISSING = {
    "a slot with 6 um left on its bottom": slot(0.2, 0.056),
    "a slot of 0.1 mm depth": slot(0.2, 0.1),
    "a slot nearly as wide as the wire": slot(0.2375, 0.18),
    "a deep slot": slot(0.2, 3),
    "a groove": slot(0.032, 0.006),
    "a notch with undercuts of 6 um": notch(*step(0.006)),
    "a notch with undercuts": notch(*step(0.03)),
    "a notch that opens again": notch((0.75, 0), (0.75, 0.2), (1, 0.2)),
    "a dovetail": [(0, 0), (-0.2, -0.15), (0.44, -0.15), (0.24, 0)],
}


def said_of(floor, tmp_path, more=""):
    ini = tmp_path / "plain.ini"
    ini.write_text(f"[machine]\nname = plain\n{more}")
    return run("--machine", ini, "--check", text=opening(floor)[2])


def is_cut_by_rule(floor):
    poly, far, _ = opening(floor)
    way = way_of(poly, OFFSET, True, far)
    return all(is_left_by_a_corner(m, OFFSET, 1, 0.002, 0)
               for m in left_out(poly, way, OFFSET, True, 0.002))


@pytest.mark.parametrize("what", CUT)
def test_what_a_corner_leaves_anyway_is_left_out(what, tmp_path):
    r = said_of(CUT[what], tmp_path)
    assert r.returncode == 0, r.stderr
    assert is_cut_by_rule(CUT[what])


@pytest.mark.parametrize("what", MISSING)
def test_a_part_that_would_be_missing_is_refused(what, tmp_path):
    r = said_of(MISSING[what], tmp_path)
    assert r.returncode == 65
    assert b"a width of" in r.stderr or b"no room for the wire" in r.stderr
    assert not is_cut_by_rule(MISSING[what])


@pytest.mark.parametrize("what", MISSING)
def test_skip_leaves_it_out_with_a_note(what, tmp_path):
    r = said_of(MISSING[what], tmp_path, "[wire]\ngouge = skip\n")
    assert r.returncode == 0, r.stderr
    assert b"note" in r.stdout + r.stderr


def wave(rnd, noise):
    """A wavy circle whose inner corners are about as round as the wire, as short
    chords with noise, to a micrometre: (places, inside or not)."""
    inside = rnd.random() < 0.5
    radius, waves = rnd.uniform(1, 4), rnd.randint(2, 30)
    bend = 1 / (OFFSET * rnd.uniform(0.7, 1.5)) + (-1 if inside else 1) / radius
    high = min(max(bend, 0) * (radius / waves) ** 2, 0.25 * radius)
    n = min(int(2 * math.pi * radius / 10 ** rnd.uniform(-2.3, -0.8)), 2000)
    out = []
    for i in range(n):
        a = 2 * math.pi * (i + 0.5) / n
        r = radius + high * math.cos(waves * a) * (-1 if inside else 1) + \
            rnd.uniform(-noise, noise)
        at = round(r * math.sin(a), 3), round(-r * math.cos(a), 3)
        if out[-1:] != [at]:
            out.append(at)
    return out, inside


@pytest.mark.parametrize("noise", [0.0003, 0.001, 0.002])
def test_noise_is_cut_where_corners_are_as_round_as_the_wire(noise, tmp_path):
    ini = tmp_path / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    rnd = random.Random(7)
    for i in range(20):
        pts, inside = wave(rnd, noise)
        start = tuple(round((p + q) / 2, 4) for p, q in zip(pts[0], pts[-1]))
        edges = [(*p, None) for p in [*pts, start]]
        poly = ring_of(start, edges)
        if not poly.is_valid:
            continue
        far = start[0], start[1] + (OFFSET + 0.3) * (1 if inside else -1)
        text = write_job(start, far, edges, "G41" if inside else "G42", OFFSET)
        r = run("--machine", ini, "--emit", "iso", text=text)
        assert r.returncode == 0, f"{i}: {r.stderr}"
        path = path_of(read_iso(r.stdout.decode())[2:-1])
        assert path.distance(poly.exterior) > OFFSET - 0.003, i
