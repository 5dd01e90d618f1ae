# SPDX-License-Identifier: Apache-2.0
"""Random contours with other leads, open ones, and several in one program; leads of
any kind, in all dialects and with a taper; against another geometry.  EDM_SEED repeats a run, EDM_RUNS says how many.
"""
import math
import os
import random
import re

import numpy as np
import pytest
from edmsim import run, seeded
from shapely import affinity
from shapely.geometry import LineString, Point
from test_wire_random import BOUND_MM
from test_wire_taper import HEIGHT, WIRE, planes, rows_of
from wire_lead_arcs import Leaning, Led, hausdorff, lead_ways, sound_contour
from wire_leads import ArcLed, ArcsBehind, Open, Round, many, words
from wire_oracle import UM, path_of, read_iso, ring_of

RUNS = int(os.environ.get("EDM_RUNS", 25))


def contours():
    """The same in every `make check`; others with EDM_SEED."""
    return seeded() if "EDM_SEED" in os.environ else random.Random(3)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    ini = tmp_path_factory.mktemp("wire") / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    return ini


def ways_of(plain, text, *more):
    """The ways, or None if it is refused; and what was said."""
    r = run("--machine", plain, "--emit", "iso", *more, text=text)
    assert r.returncode in (0, 1, 65), (r.returncode, r.stderr)
    said = r.stderr.decode()
    return None if r.returncode else read_iso(r.stdout.decode()), said


def test_arcs_lead_in_and_out_without_a_gouge(plain):
    rnd = contours()
    cut = 0
    for i in range(RUNS):
        led = ArcLed(rnd)
        c = led.contour
        ways, said = ways_of(plain, led.text)
        about = f"contour {i}: {said}\n{led.text}"
        can = c.can_be_cut()
        if can != (ways is not None):
            assert c.is_close(), about
        if not ways:
            continue
        cut += 1
        path = path_of(ways[1:])
        assert path.distance(c.poly.exterior) >= c.offset - BOUND_MM, about
        if can:
            assert c.left_by(path) < BOUND_MM, about
    assert cut > RUNS / 3


def test_arcs_behind_straight_leads_touch_the_contour(plain):
    """The arcs are led to under the offset, and may begin where they end."""
    rnd = contours()
    cut = rounds = 0
    for i in range(4 * RUNS):
        led = ArcsBehind(rnd)
        c = led.contour
        whole = isinstance(c, Round)
        if not led.is_free() or not (whole or c.can_be_cut() and
                                     not c.is_close()):
            continue
        ways, said = ways_of(plain, led.text)
        about = f"contour {i}: {said}\n{led.text}"
        assert ways, about
        path = path_of(ways)
        assert path.distance(c.poly.exterior) >= c.offset - BOUND_MM, about
        # Beside the leads, and beside all of the contour.
        assert all(hausdorff(w, path) < LEAD_MM or w.within(path.buffer(
            LEAD_MM)) for w in led.ways), about
        assert c.poly.exterior.within(path.buffer(c.offset + BOUND_MM)) \
            if whole else c.left_by(path) < BOUND_MM, about
        cut, rounds = cut + 1, rounds + whole
    assert cut > RUNS and rounds


def test_a_part_of_a_contour_is_cut_as_far_as_it_goes(plain):
    rnd = contours()
    for i in range(RUNS):
        part = Open(rnd)
        c = part.contour
        ways, said = ways_of(plain, part.text)
        about = f"contour {i}: {said}\n{part.text}"
        assert ways or c.is_close(), about
        if not ways:
            continue
        path = path_of(ways[2:-1])
        assert path.distance(part.line) >= c.offset - BOUND_MM, about
        assert c.left_by(path, part.line) < BOUND_MM, about


def test_contours_of_one_program_are_each_judged_for_themselves(plain):
    rnd = contours()
    for i in range(RUNS // 2):
        text, all_of_them, first = many(rnd, rnd.randint(2, 4))
        ways, said = ways_of(plain, text)
        about = f"program {i}: {said}\n{text}"
        can = [c.can_be_cut() for c in all_of_them]
        if all(can) != (ways is not None):
            assert any(c.is_close() for c in all_of_them), about
            continue
        if not ways:
            # The first one that cannot be cut is told.
            line = int(re.search(r"-:(\d+):", said)[1])
            bad = can.index(False)
            last = (first + [10 ** 6])[bad + 1]
            assert first[bad] <= line < last or \
                any(c.is_close() for c in all_of_them), about
            continue
        starts = [k for k, w in enumerate(ways) if w[0] == "G0"]
        for n, (c, a) in enumerate(zip(all_of_them, starts)):
            b = (starts + [len(ways)])[n + 1]
            path = affinity.translate(path_of(ways[a + 2:b - 1]), -40 * n)
            assert path.distance(c.poly.exterior) >= c.offset - BOUND_MM, about
            assert c.left_by(path) < BOUND_MM, about


SQUARE = "X20\nY15\nX0\nY0\nX5\n"


@pytest.mark.parametrize("hole,lead,end,found", [
    ("X5 Y0", "G1 X5 Y0", "Y-8", "a lead of 0.0000 mm"),
    ("X5 Y-0.1", "G1 X5 Y0", "Y-8", "a lead of 0.1000 mm"),
    ("X5 Y0.05", "G1 X5 Y0", "Y-8", "a lead of 0.0500 mm"),
    # Along the outline, not through it.
    ("X12 Y0", "G1 X5 Y0", "Y-8", "a lead that comes within 0.0000 mm"),
    ("X5 Y-8", "G1 X5 Y0", "X12 Y0", "a lead that comes within 0.0000 mm"),
    ("X5 Y-8", "G1 X5 Y0", "Y-0.05", "a lead of 0.0500 mm"),
    # Through it, as it is programmed.
    ("X5 Y4", "G1 X5 Y0", "Y4", None),
])
def test_leads_from_odd_places(hole, lead, end, found):
    text = f"G90 F200 H1=0.125\nG0 {hole}\nG42 H1\n{lead}\n{SQUARE}" \
        f"G40 {end}\nM2\n"
    r = run("--check", text=text)
    assert r.returncode == (65 if found else 0), r.stderr
    assert not found or found in r.stderr.decode(), r.stderr


def test_a_circle_between_two_leads_on_arcs_is_gone_round(plain):
    """The arc behind it is a lead, too: the wire goes round all of the circle but
    for the corner between both."""
    text = """G20 G90 G91.1 F7.874
H1=0.00591 H2=0.00787
G41 D1 G3 X-0.02706 Y-0.08808 I0.03051 J-0.05757
G2 X-0.02706 Y-0.08808 I-0.01276 J0.00514
G3 X-0.01280 Y-0.07160 I0.01736 J-0.00061
G42 D2 G2 X-0.01280 Y-0.07160 I-0.01550 J0.08561
M2
"""
    ways, said = ways_of(plain, text)
    assert ways, said
    path = path_of(ways)
    circle = Point(-0.03982 * 25.4, -0.08294 * 25.4).buffer(
        (math.hypot(0.01276, 0.00514) + 0.00591) * 25.4, 256).exterior
    assert all(path.distance(circle.interpolate(k / 360, normalized=True)) <
               0.01 for k in range(360))


def test_a_circle_stays_one_whose_ends_rounding_has_parted(plain):
    """They differ by nanometres: the wire goes round, not from one to the
    other."""
    text = """G90 G90.1 F200
H1=0.1250
G0 X-0.0118 Y-0.7910
G42 H1 G1 X-0.3330 Y-0.8333
G2 X1.0500 Y0.0000 I0.1074 J0.0000
G2 X1.0500 Y0.0000 I0.0000 J0.0000
G2 X-0.1047 Y-0.9184 I0.1074 J0.0000
G40 G1 X-0.4331 Y-0.6501
M2
"""
    ways, said = ways_of(plain, text)
    assert ways, said
    assert Point(0, 0).buffer(0.925, 256).exterior.within(
        path_of(ways).buffer(0.003))


@pytest.mark.parametrize("where, change", [
    ("G42 ", ""), ("H1=-0.15\n", ""), ("", "G42 "), ("G42 D2 ", "")])
def test_another_side_holds_from_the_start_of_its_motion(plain, where, change):
    """Two half circles of 5 mm, the second one from the other side."""
    text = "G90 F100 H1=0.15 H2=0.2\nG41 D1 G1 X5 Y0\nG3 X-5 Y0 I-5 J0\n" \
        f"{where}{change}G3 X5 Y0 I5 J0\nG40 G1 X8\nM2\n"
    ways, said = ways_of(plain, text)
    assert ways, said
    arcs = [w for w in ways if w[3]]
    radii = [math.dist(w[1], w[3][:2]) for w in arcs]
    assert np.allclose(radii, [4.85, 5.2 if "D2" in where else 5.15], atol=2 * UM)
    assert all(math.hypot(*w[3][:2]) < 2 * UM for w in arcs)
    # Across at the place, square to the contour.
    across = [w for w in ways if not w[3] and w[1][0] < 0]
    assert len(across) == 1 and abs(across[0][1][1] - across[0][2][1]) < UM


# -- A circle inside of an open contour ---------------------------------------

CIRCLES = [
    # The end of the circle is its begin: it is not left out between them.
    """G0 X-1.9558 Y-4.6016
G41 H1 G1 X0 Y0
X-9.2033 Y3.9115
G2 X-9.2033 Y3.9115 I0.3397 J0.7992
G1 X-18.4065 Y7.8231
G40 X-20.3623 Y3.2214
""", """G0 X0.8730 Y4.9232
G41 H1 G1 X0 Y0
X9.8464 Y-1.7459
G2 X9.8464 Y-1.7459 I-0.4345 J-2.2459
G1 X19.6928 Y-3.4919
G40 X20.5658 Y1.4313
""",
    # A lead in that comes too near to the last motion, and out to the first.
    """G0 X0 Y0
G41 H1 G1 X9.8856 Y-1.5083
G2 X9.8856 Y-1.5083 I0.2271 J-0.0346
G1 X0.6963 Y2.4359
G40 X-1.2758 Y-2.1587
""", """G0 X2.5001 Y4.3301
G42 H1 G1 X0 Y0
X-8.6602 Y5.0001
G3 X-8.6602 Y5.0001 I-0.1226 J0.0386
G40 G1 X-3.8909 Y3.4989
"""]


@pytest.mark.parametrize("text", CIRCLES)
def test_a_circle_of_an_open_contour_is_not_left_out_unsaid(plain, text):
    ways, said = ways_of(plain, f"G90 F5 H1=0.15\n{text}M2\n")
    assert not ways and ("no room for the wire" in said or "a lead" in said)


def circled(rnd):
    """A lead, a line perhaps, a full circle, and a line perhaps: the program,
    the lines, and the way of a wire round the circle."""
    side, sense = rnd.choice([1, -1]), rnd.choice([1, -1])
    r, turn, offset = rnd.uniform(0.3, 3), rnd.uniform(0, 6.28), 0.15
    head = rnd.choice([0, 90, 180, 270, rnd.uniform(0, 360)])
    tail = rnd.choice([0, 180, head, head + 90, head - 90,
                       rnd.uniform(0, 360)])

    def place(x, y, angle=0.0, far=0.0):
        x += far * np.cos(np.radians(angle))
        y += far * np.sin(np.radians(angle))
        return (round(x * np.cos(turn) - y * np.sin(turn), 4),
                round(x * np.sin(turn) + y * np.cos(turn), 4))
    at, centre = place(0, 0), place(0, 0, head + 90 * sense, r)
    begin = [[place(-10, 5 * side), place(-10, 0), at],
             [place(0, 0, head + 90 * side, 5), at],
             [place(0, 0, head + 180, 5), at]]
    before = rnd.choice(begin)
    out = [at] + rnd.choice([[], [place(0, 0, tail, 10)]])
    last = tail if out[1:] else head
    far = place(*((0, 0) if not out[1:] else (10 * np.cos(np.radians(tail)),
                10 * np.sin(np.radians(tail)))), last + 90 * side, 5)
    text = [f"G90 F5 H1={offset}", "G0 " + words(*before[0])[3:],
            f"G4{1 if side > 0 else 2} H1 {words(*before[1])}"]
    text += [words(*p) for p in before[2:]]
    text += [f"G{3 if sense > 0 else 2} X{at[0]} Y{at[1]} "
             f"I{centre[0] - at[0]:.4f} J{centre[1] - at[1]:.4f}"]
    text += [words(*p) for p in out[1:]] + ["G40 " + words(*far), "M2", ""]
    lines = [LineString(p) for p in (before[1:], out) if len(p) > 1]
    return "\n".join(text), lines, \
        Point(centre).buffer(r - side * sense * offset, 64).exterior


def test_circles_of_open_contours_are_gone_round_or_refused(plain):
    rnd = contours()
    cut = 0
    for i in range(5 * RUNS):
        text, lines, circle = circled(rnd)
        ways, said = ways_of(plain, text)
        if not ways:
            continue
        cut += 1
        path = path_of(ways)
        places = [circle.interpolate(k / 90, normalized=True)
                  for k in range(90)]
        # Where the wire has room beside the lines, but for a corner.
        left = [p for p in places if path.distance(p) > 0.01 and
                all(n.distance(p) > 0.1505 for n in lines)]
        assert len(left) <= 12, f"{i}: {said}\n{text}"
    assert cut


# -- Leads of any kind --------------------------------------------------------

LEAD_MM = 2.5 * UM      # its ends are rounded to pulses, and so are centres


def assert_goes_as_written(lead, ways, out, by, about):
    way = path_of(ways)
    want = lead.way(by)
    assert hausdorff(way, want) < LEAD_MM, about
    assert abs(way.length - want.length) < 10 * UM, about
    assert hausdorff(way, lead.written()) < by + LEAD_MM, about
    clockwise = lead.centre and (lead.sense > 0) == out
    assert all(w[3][2] == clockwise for w in ways if w[3]), about


def assert_led(led, ways, said):
    c = led.contour
    verdicts = led.verdicts
    about = f"{verdicts}: {said}\n{led.text()}"
    if "close" in verdicts:
        return None
    assert (ways is None) == ("refuse" in verdicts), about
    if not ways:
        assert "a lead " in said, about
        lines = [4, len(c.ring) + 5]
        bad = [k for k, v in zip(lines, verdicts) if v == "refuse"]
        assert int(re.search(r"-:(\d+):", said)[1]) in bad, about
        return "refuse"
    ways = [w for w in ways if w[0] != "G0"]
    mine, ways = lead_ways(ways, led.leads[0], False)
    assert_goes_as_written(led.leads[0], mine, False, c.offset, about)
    mine, ways = lead_ways(ways, led.leads[1], True)
    assert_goes_as_written(led.leads[1], mine, True, c.offset, about)
    path = path_of(ways)
    assert path.distance(c.poly.exterior) >= c.offset - BOUND_MM, about
    assert c.left_by(path) < BOUND_MM, about
    return "cut"


def test_leads_go_round_their_own_centres_or_are_refused(plain):
    rnd = contours()
    counts = {}
    for i in range(RUNS):
        contour = sound_contour(rnd)
        for _ in range(4):
            led = Led(rnd, contour)
            got = assert_led(led, *ways_of(plain, led.text()))
            counts[got] = counts.get(got, 0) + 1
    print(counts)
    assert counts["cut"] and counts["refuse"]


# Of each dialect with an offset: register, centres from the start of an arc.
DIALECTS = {
    "generic": ("D1", True), "linuxcnc": ("D1", True), "agie": ("D1", True),
    "agievision": ("D1", True), "charmilles-robofil": ("D1", False),
    "charmilles-robofil-440": ("D1", True), "chmer": ("H1", True),
    "fanuc-wire": ("D1", True), "makino": ("H1", True),
    "mastercam-wire": ("D1", True), "skd2": ("H1", True),
    "sodick-wire": ("H1", True),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_leads_are_the_same_in_all_dialects(tmp_path, dialect):
    rnd = contours()
    register, relative = DIALECTS[dialect]
    contour = sound_contour(rnd)
    ini = tmp_path / "m.ini"
    ini.write_text(f"[machine]\nname = m\n[wire]\n"
                   f"offset_1_mm = {contour.offset}\n")
    cut = 0
    for _ in range(max(RUNS // 3, 1)):
        led = Led(rnd, contour)
        text = led.text(register, "G90 F200." if dialect in
                        ("generic", "linuxcnc") else "G90", relative)
        cut += assert_led(led, *ways_of(ini, text, "--dialect", dialect)) == \
            "cut"
    assert cut


def test_leads_go_round_their_own_centres_on_both_planes():
    rnd = contours()
    counts = {"cut": 0, "refuse": 0, "close": 0}
    for i in range(RUNS // 2):
        led = Leaning(rnd, HEIGHT)
        r = run("--machine", WIRE, "--check", text=led.text())
        said = r.stderr.decode()
        about = f"{i}: {led.verdicts}: {said}\n{led.text()}"
        verdict = min(led.verdicts, key=["close", "refuse", "cut"].index)
        counts[verdict] += 1
        if verdict == "close":
            continue
        assert r.returncode == (0 if verdict == "cut" else 65), about
        assert not r.returncode or "a lead " in said, about
        if r.returncode:
            continue
        for by, at in zip(led.by, planes(rows_of(led.text()))):
            for lead, line in zip(led.leads, (4, 10)):
                first = np.flatnonzero(at[:, 0] == line)
                on = LineString(at[first[0] - 1:first[-1] + 1, 1:])
                assert hausdorff(on, lead.way(by)) < LEAD_MM + UM, about
    print(counts)
    assert counts["cut"] and counts["refuse"]

# -- Passes -------------------------------------------------------------------

def passed(rnd):
    """Passes over a rounded square from a quarter circle that leads in: the
    program, the square, its offsets, and whether the wire is inside."""
    w, h = round(rnd.uniform(4, 12), 2), round(rnd.uniform(4, 12), 2)
    r, rl = round(rnd.uniform(.5, 1.5), 2), round(rnd.uniform(.6, 1.6), 2)
    offsets = [.15, .11, .105][:rnd.randint(1, 3)]
    inside = rnd.random() < 0.5
    s = 1 if inside else -1
    corners = [(w / 2, -h / 2), (w / 2, h / 2), (-w / 2, h / 2),
               (-w / 2, -h / 2)]
    start, edges = (0, -h / 2), []
    for i, (x, y) in enumerate(corners):
        (ux, uy), (vx, vy) = [((1, 0), (0, 1), (-1, 0), (0, -1))[k % 4]
                              for k in (i, i + 1)]
        edges += [(x - r * ux, y - r * uy, None),
                  (x + r * vx, y + r * vy,
                   (x - r * ux + r * vx, y - r * uy + r * vy, False))]
    edges.append((*start, None))
    lead = 3 if inside else 2
    here, ways = start, []
    for x, y, c in edges:
        g = f"G3 X{x:.4f} Y{y:.4f} I{c[0] - here[0]:.4f} " \
            f"J{c[1] - here[1]:.4f}" if c else f"G1 X{x:.4f} Y{y:.4f}"
        ways, here = ways + [g], (x, y)
    hole = f"X{-rl} Y{-h / 2 + s * rl:.4f}"
    back = rnd.choice([f"G40 G1 {hole}",
                       f"G40 G{5 - lead} {hole} I0 J{s * rl}"])
    text = ["G90 F5", *[f"H{i + 1}={o}" for i, o in enumerate(offsets)],
            *[f"G150 H{i + 1} F5" for i in range(len(offsets))],
            f"G151 P100 {hole}", "G152", "M2", "O100",
            f"{'G41' if inside else 'G42'} G{lead} X0 Y{-h / 2:.4f} "
            f"I{rl} J0", *ways, back, "M99", ""]
    return "\n".join(text), ring_of(start, edges), offsets, inside


def test_passes_keep_their_offsets_behind_leads_on_arcs(plain):
    rnd = contours()
    for i in range(RUNS):
        text, square, offsets, inside = passed(rnd)
        ways, said = ways_of(plain, text)
        assert ways, f"{i}: {said}\n{text}"
        path = path_of(ways)
        assert path.distance(square.exterior) > offsets[-1] - BOUND_MM, text
        for by in offsets:
            want = square.buffer(-by if inside else by, 256).exterior
            assert max(path.distance(want.interpolate(k / 400, True))
                       for k in range(400)) < BOUND_MM, f"{i}, {by}:\n{text}"
