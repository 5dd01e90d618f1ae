# SPDX-License-Identifier: Apache-2.0
"""What a wire may leave out of a contour without a word, at the limits of the rule
in docs/taper.md: slots, necks and chambers in the floor of an opening."""
import math
import random
import re

import pytest
from edmsim import run
from wire_oracle import (is_left_by_a_corner, left_out, path_of, read_iso,
                         ring_of, way_of, write_job)

OFFSET = 0.125
WIRE = """[machine]
name = wire
[wire]
guides = absolute
z_lower_mm = 0
z_upper_mm = 40
z_program_mm = 0
z_second_mm = 40
"""
HALF = math.radians(15)     # of the notch
MOUTH = 0.6
DEEP = MOUTH / 2 / math.tan(HALF)


def opening(floor):
    """A square opening; floor: places in its bottom side, or arcs to them, as
    (x, y, (centre's x, y, clockwise))."""
    edges = [(round(x, 4), round(y, 4), c[0] if c else None) for x, y, *c in
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


def chamber(width, radius, at=0):
    """A round chamber, one arc, behind a mouth in the floor."""
    down = math.sqrt(radius ** 2 - width ** 2 / 4)
    return [(at, 0), (at + width, 0, (at + width / 2, -down, False))]


def hook(width):
    return [(0, 0), (0, -0.9), (0.9, -0.9), (0.9, -0.3), (0.9 - width, -0.3),
            (0.9 - width, -0.9 + width), (width, -0.9 + width), (width, 0)]


def nested(outer, inner):
    """A chamber behind a neck, and in its floor another one."""
    return [(0, 0), (0, -0.4), (-0.6, -0.4), (-0.6, -1), (-0.3, -1), (-0.3, -1.3),
            (-0.6, -1.3), (-0.6, -2), (inner, -2), (inner, -1.3),
            (inner - 0.3, -1.3), (inner - 0.3, -1), (outer + 0.6, -1),
            (outer + 0.6, -0.4), (outer, -0.4), (outer, 0)]


# The wire comes 0.05 mm deep into a slot of 0.2 mm, 0.0010 into one of 0.032.
CUT = {
    "a hook 2 um wider than the wire": hook(0.252),
    "a chamber behind a mouth as wide as the wire": chamber(0.2502, 0.6),
    "a neck as wide as the wire behind another": nested(0.2502, 0.2502),
    "two arcs that bulge, as far apart as the wire": [
        (0, 0), (0, -1, (-1, -0.5, True)), (0.4863, -1), (0.4863, 0, (1.4863, -0.5, True))],
    "a slot whose bottom the wire comes to": slot(0.2, 0.0495),
    "a slot with a micrometre left on its bottom": slot(0.2, 0.051),
    "a scratch": slot(0.032, 0.0025),
    "a notch": notch(),
    "a notch with ribs on its walls": notch(*step(-0.01)),
    "a notch with a micrometre of noise": notch(*step(0.001)),
    "a step": [(0, 0), (0, 0.06), (5, 0.06), (5, 0)],
}
MISSING = {
    "a hook 4 um narrower than the wire": hook(0.246),
    "a chamber behind a mouth 4 um narrower": chamber(0.246, 0.6),
    "a narrow neck behind another": nested(0.2502, 0.246),
    "a narrow neck in front of another": nested(0.246, 0.2502),
    "two arcs that bulge, 4 um nearer": [
        (0, 0), (0, -1, (-1, -0.5, True)), (0.4821, -1), (0.4821, 0, (1.4821, -0.5, True))],
    "a step that the wire touches in three places": [
        (2.339, -0.103), (2.382, -0.103), (2.459, -0.138), (2.632, -0.138),
        (2.654, -0.251), (2.756, -0.251), (2.778, -0.272), (2.863, -0.272),
        (2.863, -0.195), (2.965, -0.195), (2.965, -0.142), (3.159, -0.142),
        (3.168, -0.104), (3.44, -0.104), (3.44, 0)],
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


def notes_of(r):
    return re.findall(r"-:(\d+): note: (.*)", (r.stdout + r.stderr).decode())


BEGUN_IN_A_SLOT = b"""G90 F5 H1=0.125
G0 X0.0 Y1.0
G41 H1 G1 X-0.1 Y-0.5
Y-2.0
X0.1
Y0.0
X10.0
Y20.0
X-10.0
Y0.0
X-0.1
Y-0.5
G40 X0.0 Y1.0
M2
"""


def test_a_contour_begun_where_skip_leaves_out_is_told_another_beginning(
        tmp_path):
    for gouge, told in (("refuse", b"gouge = skip leaves out"),
                        ("skip", b"begins where the wire fits")):
        ini = tmp_path / "machine.ini"
        ini.write_text(f"[machine]\nname = plain\n[wire]\ngouge = {gouge}\n")
        r = run("--machine", ini, "--check", text=BEGUN_IN_A_SLOT)
        assert r.returncode == 65
        assert told in r.stderr, r.stderr
        assert (b"gouge = skip" in r.stderr) == (gouge == "refuse")


def test_skip_tells_each_part_that_it_leaves_out(tmp_path):
    floor = [*slot(0.2, 2), *[(x + 1, y) for x, y in slot(0.25, 2)],
             *[(x + 2, y) for x, y in slot(0.24, 2)],
             *[(x + 3, y) for x, y, *_ in slot(0.1, 0.5)]]
    told = notes_of(said_of(floor, tmp_path, "[wire]\ngouge = skip\n"))
    assert [int(line) for line, _ in told] == [6, 14, 18]
    assert [re.findall(r"lines (\d+) and (\d+)", text)[0]
            for _, text in told] == [("6", "8"), ("14", "16"), ("18", "20")]


def test_skip_tells_what_is_left_out_on_the_second_plane_alone(tmp_path):
    ini = tmp_path / "wire.ini"
    ini.write_text(WIRE + "gouge = skip\n")
    floor = [*slot(0.3, 1), *[(x + 1, y) for x, y in slot(0.35, 1)]]
    text = opening(floor)[2].replace("G41 H1", "G41 H1 G51 A0.05")
    told = notes_of(run("--machine", ini, "--check", text=text))
    assert [text for _, text in told] == [
        "what lies between the motions of lines 6 and 8 is too narrow for the "
        "wire on the second plane and is left out (gouge = skip)"]


def test_an_undercut_behind_a_cone_is_missing_on_the_second_plane(tmp_path):
    """On the top a cone stands round each edge of the mouth, and the wire touches
    it beside what it would leave out."""
    ini = tmp_path / "wire.ini"
    ini.write_text(WIRE)
    floor = [(2, 0), (2.34, -0.665), (2.321, -0.665), (2.321, -0.828),
             (2.671, -0.828), (2.671, -0.665), (2.651, -0.665), (2.992, 0)]
    text = opening(floor)[2].replace("H1=0.125", "H1=0.1")
    leaning = text.replace("G41 H1", "G41 H1 G51 A0.04119")
    assert run("--machine", ini, "--check", text=text).returncode == 0
    r = run("--machine", ini, "--check", text=leaning)
    assert r.returncode == 65
    assert b"on the second plane" in r.stderr


# A point of 4 degrees, and a horn between two arcs.
SHARP = {
    "walls": ([(0, 0), (0.2, -5.727), (0.4, 0)], 180 - 4),
    "arcs": ([(0, 0), (1.316, -1.879, (2, 0, False)),
              (0.3, 0, (2.0825, -0.2504, True))],
             None),
}


@pytest.mark.parametrize("what", SHARP)
def test_a_sharp_corner_is_cut_and_told(what, tmp_path):
    floor, turn = SHARP[what]
    r = said_of(floor, tmp_path)
    assert r.returncode == 0, r.stderr
    (line, text), = notes_of(r)
    left = float(re.search(r"leaves ([0-9.]+) mm", text).group(1))
    assert line == "6" and "lines 6 and 7" in text
    if turn:
        expect = OFFSET / math.cos(math.radians(turn) / 2) - OFFSET
        assert left == pytest.approx(expect, abs=0.01)


def test_a_contour_may_begin_in_a_sharp_corner(tmp_path):
    ini = tmp_path / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    edges = [(*at, None) for at in [(0.2, 0), (10, 0), (10, 20), (-10, 20),
                                    (-10, 0), (-0.2, 0), (0, -5.727)]]
    text = write_job((0, -5.727), (0, 3), edges, "G41", OFFSET)
    r = run("--machine", ini, "--check", text=text)
    assert r.returncode == 0, r.stderr
    assert len(notes_of(r)) == 1


@pytest.mark.parametrize("off", [0.0002, 0.001, -0.001])
def test_an_arc_that_nearly_comes_back_keeps_its_circle(off, tmp_path):
    """A keyhole whose ends are written so far from where its circle has them."""
    ini = tmp_path / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    centre = (0.15, -5 - math.sqrt(25 - 0.15 ** 2))
    floor = [(0, 0), (0, -5), (0.3, -5 + off, (*centre, False)), (0.3, 0)]
    floor = [(x, y, *c) for x, y, *c in floor]
    r = run("--machine", ini, "--emit", "iso", text=opening(floor)[2])
    assert r.returncode == 0, r.stderr
    path = path_of(read_iso(r.stdout.decode())[2:-1])
    far = [math.hypot(x - centre[0], y - centre[1])
           for x, y in path.segmentize(0.1).coords if y < -6]
    assert max(abs(d - (5 - OFFSET)) for d in far) < 0.002


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
