# SPDX-License-Identifier: Apache-2.0
"""Random contours with other leads, open ones, several in one program, and with a
taper, against another geometry.  EDM_SEED repeats a run, EDM_RUNS says how many.
"""
import os
import random
import re

import pytest
from edmsim import run, seeded
from shapely import affinity
from test_wire_random import BOUND_MM
from wire_leads import ArcLed, Open, many
from wire_oracle import path_of, read_iso

RUNS = int(os.environ.get("EDM_RUNS", 25))


def contours():
    """The same in every `make check`; others with EDM_SEED."""
    return seeded() if "EDM_SEED" in os.environ else random.Random(3)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    ini = tmp_path_factory.mktemp("wire") / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    return ini


def ways_of(plain, text):
    """The ways, or None if it is refused; and what was said."""
    r = run("--machine", plain, "--emit", "iso", text=text)
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
