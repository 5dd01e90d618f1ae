# SPDX-License-Identifier: Apache-2.0
"""What is set at the machine: 3B programs with offset, taper, scale, turn and image as
the same contour with words, and as its two circles say; a taper of NC code as G51."""
import itertools
import math

import numpy as np
import pytest

from edmsim import machine_text, places, run, seeded

PULSE_MM = 0.001
CONE = "B5000 B0 B5000 GX L1\nB5000 B0 B20000 GY NR1\nB5000 B0 B5000 GX L3\nDD\n"


@pytest.fixture
def machine(tmp_path):
    def write(keys=""):
        ini = tmp_path / "m.ini"
        ini.write_text(machine_text("offset_1_mm = 0.11\n" + keys, "absolute"))
        return ini
    return write


def rows(machine, dialect, text, *args):
    return np.array(places("--machine", machine, "--dialect", dialect, "--dry-run",
                           *args, text=text))


@pytest.mark.parametrize("taper, wire", [(0, 0.11), (1, 0), (-1.5, 0.11), (2, -0.11)])
def test_a_cone_is_its_two_circles(machine, taper, wire):
    """Where each guide goes: the contour's circle, less the offset square to the
    leaning wire, less the lean at that height."""
    at = rows(machine(), "3b", CONE, "--taper", taper, "--wire-offset", wire)
    slope = math.tan(math.radians(taper))
    beside = wire * math.sqrt(1 + slope * slope)
    for axes, z in (((0, 1), -20), ((6, 7), 80)):
        r = np.hypot(*(at[:, axes] * PULSE_MM).T)
        circle = 5 - beside - z * slope
        on = np.abs(r - circle) < 0.0015
        # All of it, but the way from the middle and back.
        first, last = np.flatnonzero(on)[[0, -1]]
        assert on[first:last + 1].all()
        turned = np.unwrap(np.arctan2(at[first:last + 1, axes[1]],
                                      at[first:last + 1, axes[0]]))
        assert abs(turned[-1] - turned[0] - 2 * math.pi) < 0.01


def contour(rng):
    """A rectangle with rounded corners, from a hole inside: whole um."""
    w, h, r = (1000 * rng.randint(6, 12) for _ in range(2)), 0, rng.randint(800, 2500)
    w, h = w
    b = [f"B{w // 2} B0 B{w // 2} GX L1"]
    nc = [(w // 2, 0, None)]
    x, y = w // 2, 0
    for dx, dy, cx, cy, quad in ((0, h // 2 - r, -r, 0, 1), (-(w - 2 * r), 0, 0, -r, 2),
                                 (0, -(h - 2 * r), r, 0, 3), (w - 2 * r, 0, 0, r, 4)):
        x, y = x + dx, y + dy
        way = abs(dx) + abs(dy)
        b.append(f"B{abs(dx)} B{abs(dy)} B{way} G{'X' if dx else 'Y'} "
                 f"L{1 if dx > 0 else 3 if dx < 0 else 2 if dy > 0 else 4}")
        nc.append((x, y, None))
        ex, ey = {1: (-r, r), 2: (-r, -r), 3: (r, -r), 4: (r, r)}[quad]
        b.append(f"B{abs(cx)} B{abs(cy)} B{r} G{'Y' if cy else 'X'} NR{quad}")
        x, y = x + ex, y + ey
        nc.append((x, y, (cx, cy)))
    b.append(f"B0 B{-y} B{-y} GY L2")
    nc.append((x, 0, None))
    b += [f"B{w // 2} B0 B{w // 2} GX L3", "DD"]
    return b, nc


def with_words(nc, taper, wire):
    words = ["G21 G90 F4800", f"{'G41' if wire > 0 else 'G42' if wire < 0 else 'G40'} D1",
             f"G51 A{taper}" if taper > 0 else f"G52 A{-taper}" if taper else "G50"]
    for x, y, centre in nc:
        words.append(f"G{3 if centre else 1} X{x / 1000} Y{y / 1000}" +
                     (f" I{centre[0] / 1000} J{centre[1] / 1000}" if centre else ""))
    return "\n".join(words + ["G40 G50", "G1 X0 Y0", "M2", ""])


def is_same_way(a, b):
    """Each place of the one is within a pulse of the other's: sums of a centre differ
    in their last bit, so a place between two pulses may go to either."""
    a, b = ({tuple(row) for row in p[:, [0, 1, 6, 7]]} for p in (a, b))
    steps = list(itertools.product((-1, 0, 1), repeat=4))
    return all(any(tuple(np.add(row, d)) in other for d in steps)
               for one, other in ((a, b), (b, a)) for row in one - other)


def test_what_is_set_is_what_words_say(machine):
    rng = seeded()
    for _ in range(12):
        b, nc = contour(rng)
        taper, wire = rng.choice([0, 0.5, -1.25]), rng.choice([0, 0.11, -0.11])
        print("\n".join(b))
        ini = machine()
        records = rows(ini, "3b", "\n".join(b) + "\n", "--taper", taper,
                       "--wire-offset", wire)
        words = rows(ini, "generic", with_words(nc, taper, wire))
        assert is_same_way(records, words)


def test_scale_turn_and_image_are_those_of_the_way(machine):
    rng = seeded()
    for _ in range(10):
        b, nc = contour(rng)
        scale, turn = rng.choice([1, 1.005, 2]), rng.choice([90, -30, 200.5])
        mirror = rng.choice(["none", "x", "y", "exchange"])
        at = rows(machine(f"record_scale = {scale}\nrecord_turn_deg = {turn}\n"
                          f"record_mirror = {mirror}"), "3b", "\n".join(b) + "\n")
        image = {"none": [[1, 0], [0, 1]], "x": [[-1, 0], [0, 1]],
                 "y": [[1, 0], [0, -1]], "exchange": [[0, 1], [1, 0]]}[mirror]
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        to = scale * np.array([[c, -s], [s, c]]) @ image
        # The end of each motion is passed, by both guides, in this order.
        k = 0
        for x, y, _ in nc + [(0, 0, None)]:
            want = to @ [x, y]
            near = np.abs(at[k:, [0, 1]] - want).max(axis=1) < 1.6
            assert near.any(), (x, y)
            k += int(np.argmax(near))
            assert (at[k, [0, 1]] == at[k, [6, 7]]).all()


# A die in two passes, with its way back, and a punch beside it in a figure.
PASSES = """G21 G90 F4800
H1=0.2 H2=0.15
G150 H1 F4800
G150 H2 F4800
G151 P100 X10 Y10
G152
G68 X-20 Y0 R30
G0 X-20 Y0
G42 D1 {words}
G1 X-20 Y5
G3 X-20 Y5 I0 J-5
G40 G50
G1 X-20 Y0
M30
O100
G41 {words} G1 X10 Y5
X15
Y15
X5
Y5
X10
G40 G50 Y10
M99
"""


@pytest.mark.parametrize("taper", [1.5, -2])
@pytest.mark.parametrize("planes", [(0, 40), (5, 25)])
def test_a_taper_of_nc_code_is_what_its_words_say(machine, tmp_path, taper, planes):
    """Under G41 and G42, in all passes, and in a figure that is turned."""
    words = f"G51 A{taper}" if taper > 0 else f"G52 A{-taper}"
    other = tmp_path / "other.ini"
    other.write_text(machine_text("", "absolute", planes=planes))
    told = rows(other, "generic", PASSES.format(words=words))
    set_so = rows(machine(), "generic", PASSES.format(words=""), "--taper", taper,
                  "--plane", planes[0], "--second-plane", planes[1])
    assert told.shape == set_so.shape and (told == set_so).all()


def test_a_taper_of_nc_code_leaves_what_has_no_offset(machine):
    text = "G21 G90 F600\nG1 X5\nG41 D1\nG1 X10 Y0\nG3 X10 Y0 I-10 J0\nG40\nG1 X5\nM30\n"
    at = rows(machine(), "generic", text, "--taper", 3)
    leans = np.abs(at[:, :2] - at[:, 6:]).max(axis=1)
    assert leans[:5001].max() == 0 and leans[-1] == 0 and leans.max() > 5000


@pytest.mark.parametrize("taper", [0, 1])
def test_a_record_that_leads_nowhere_is_no_lead(machine, taper):
    args = ("--wire-offset", 0.11, "--taper", taper)
    still = "B0 B0 B0 GX L1\n"
    assert (rows(machine(), "3b", CONE, *args) ==
            rows(machine(), "3b", still + CONE.replace("DD", still + "DD"), *args)).all()


@pytest.mark.parametrize("args, wanted", [
    (["--taper", "81"], "taper=81; a number from -80 to 80 degrees"),
    (["--taper", "x"], "taper=x; a number"),
    (["--taper", "nan"], "taper=nan; a number"),
    (["--scale", "0"], "scale=0; a number from 0.001 to 1000"),
    (["--mirror", "z"], "mirror=z; none, x, y or exchange"),
    (["--plane", "40", "--second-plane", "40"], "the second one above it"),
    (["--turn", "1 taper=3"], ""),
])
def test_options_that_are_refused(args, wanted):
    r = run("--dialect", "3b", "--check", *args, text=CONE)
    assert wanted in r.stderr.decode(), r.stderr.decode()
    assert r.returncode in (64, 65)


@pytest.mark.parametrize("text, args, wanted", [
    ("G1 X5 F60\nM30\n", ["--taper", 3], "has no wire offset; G41 or G42"),
    ("G41 D1\nG51 A2\nG1 X5 F60\nM30\n", ["--taper", 3], ":2:1: error: a taper of the"),
    ("G1 X5 F60\nM30\n", ["--turn", 90], "set for NC code; its words, or 3B and 4B"),
    ("G1 X5 F60\nM30\n", ["--taper", 31], "a taper that leans too far"),
    ("G1 X5 F60\nM30\n", ["--plane", 50], "a plane at 50 mm, and the second one at 40"),
])
def test_refused_of_nc_code(machine, text, args, wanted):
    r = run("--machine", machine(), "--dialect", "generic", "--check", *args, text=text)
    assert r.returncode == 65 and wanted in r.stderr.decode(), r.stderr.decode()


@pytest.mark.parametrize("dialect, text, args, wanted", [
    ("3b", CONE, ["--taper", 31], "a taper that leans too far; up to wire.angle"),
    ("3b", "B1 B0 B500 GX L1\nB1 B0 B500 GX L3\nDD\n", ["--wire-offset", 0.1],
     "fewer than three motions"),
    ("4b", "B500 B0 B500 B GX L1\nDD\n", ["--wire-offset", 0.1],
     "fourb_offset_um for it"),
    ("3b", "B50 B0 B50 GX L1\nB5000 B0 B20000 GY NR1\nB5 B0 B5 GX L3\nDD\n",
     ["--wire-offset", 0.11], "1:1: error: "),
])
def test_refused(machine, dialect, text, args, wanted):
    r = run("--machine", machine(), "--dialect", dialect, "--check", *args, text=text)
    assert r.returncode == 65, r.stdout
    assert wanted in r.stderr.decode(), r.stderr.decode()


def test_a_taper_without_guides_is_refused():
    r = run("--dialect", "3b", "--check", "--taper", 1, text=CONE)
    assert r.returncode == 65
    assert b"a taper on a machine without wire guides" in r.stderr
