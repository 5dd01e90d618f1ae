# SPDX-License-Identifier: Apache-2.0
"""Promises of curves: one row of points, whatever feed, period and direction."""
import math
import random
import re

import pytest
from edmsim import ROOT, assert_neighbours, places, pulses, report, run
from speed_programs import machine, program

BLADE = ROOT / "examples/blade.ngc"
STRATEGIES = ["simultaneous", "centred", "min-switch"]
SIX_AXES = """G21 G90 G17 F{feed}
G6.2 P5 K0 X0 Y0 Z0 A0 B0 C0
K0 X10 Y4 Z-1 A10 B5 C12.
K0 X12 Y9 Z-3 A15 B2 C30. R2
K0 X4 Y14 Z-2 A5 B-6 C45. R2
K0 X-6 Y10 Z0 A-7 B-3 C30.
K0.4 X-4 Y3 Z1 A-3 B1 C12.
K0.7 X0 Y0 Z0 A0 B0 C0
K1
K1
K1
K1
K1
M2
"""


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_six_axes_meet_the_same_points_at_any_feed_and_period(strategy):
    rows = [places("--dry-run", "--strategy", strategy, "--period-us", period,
                   text=SIX_AXES.format(feed=feed))
            for feed, period in ((60, 1000), (3000, 1000), (900, 50))]
    assert len(rows[0]) > 1000
    assert rows[0] == rows[1] == rows[2]
    assert rows[0][0] == rows[0][-1]
    assert_neighbours(rows[0])


@pytest.mark.parametrize("kind, seed", [("wave", 4), ("spiral", 3)])
def test_so_do_curves_that_are_joined_from_lines(tmp_path, kind, seed):
    p, limits = program(kind, seed)
    of = machine(tmp_path, limits)
    rows = [places("--machine", of, "--dry-run", "--fit", "2", "--period-us",
                   period, text=p.text().replace("F6000", f"F{feed}"))
            for feed, period in ((6000, 1000), (200, 1000), (6000, 5000))]
    assert rows[0] == rows[1] == rows[2]


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_six_axes_go_back_by_the_points_they_came(strategy):
    there = places("--dry-run", "--strategy", strategy,
                   text=SIX_AXES.format(feed=3000))
    thrice = places("--dry-run", "--there-and-back", "--strategy", strategy,
                    text=SIX_AXES.format(feed=3000))
    assert thrice == there + there[-2::-1] + there[1:]


def test_the_blade_is_kept_to():
    r = report("--dry-run", BLADE)
    assert r["outcome"] == "done"
    assert r["deviation_um_max"] < 0.708
    assert r["end_error_pulses"] == 0


def circle(n):
    text = ["G21 G90 G17 F6000", "G0 X50 Y0"]
    for i in range(1, n + 1):
        a = math.tau * i / n
        text.append(f"G1 X{50 * math.cos(a):.4f} Y{50 * math.sin(a):.4f}")
    return "\n".join(text)


def test_lines_are_joined_within_the_tolerance_and_no_farther():
    joined = pulses("--dry-run", "--fit", "1", text=circle(2000))
    # The lines are up to 0.06 um inside the circle; a point has 0.707.
    assert all(abs(math.hypot(x, y) - 50000) < 1.8
               for line, x, y, *_ in joined if line > 2)
    assert joined[-1][1:3] == (50000, 0)
    # Each point is told to belong to a line of the source.
    assert all(0 < line <= 2002 for line, *_ in joined[1:])


def meander(seed):
    """A bending way, with a long line here and there among short ones."""
    rnd = random.Random(seed)
    n, a, x, y, dk = rnd.randint(10, 400), 0, 0.0, 0.0, 0
    k, big, at = rnd.choice([.02, .1, .3]), rnd.choice([1, 1, 30]), [(0, 0)]
    for _ in range(n):
        s = rnd.uniform(.05, .1) * (big if rnd.random() < .05 else 1)
        dk = max(-k, min(k, dk + rnd.gauss(0, k / 5)))
        a += dk * s
        x, y = x + s * math.cos(a), y + s * math.sin(a)
        at.append((round(x, 4), round(y, 4)))
    return at


def off_lines(x, y, at):
    def off(a, b):
        dx, dy = b[0] - a[0], b[1] - a[1]
        t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)
        t = min(1, max(0, t))
        return math.hypot(x - a[0] - t * dx, y - a[1] - t * dy)
    return min(map(off, at, at[1:]))


def test_between_its_points_too_a_joined_curve_is_near_the_lines():
    at = meander(5)
    text = "F600\n" + "".join(f"G1 X{x} Y{y}\n" for x, y in at[1:])
    rows = places("--dry-run", "--fit", "2", text=text)
    assert max(off_lines(x / 1e3, y / 1e3, at)
               for x, y, *_ in rows[::5]) < 0.0029


WAYS = {
    "a wave": lambda u: (40 * u, math.sin(40 * u)),
    "a star": lambda u: ((8 + 3 * math.cos(10 * math.pi * u)) *
                         math.cos(2 * math.pi * u) - 11,
                         (8 + 3 * math.cos(10 * math.pi * u)) *
                         math.sin(2 * math.pi * u)),
    "an eight": lambda u: (10 * math.sin(2 * math.pi * u),
                           5 * math.sin(4 * math.pi * u)),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_curve_takes_little_longer_than_its_short_lines(way):
    """It took 1.4 to 1.5 times as long."""
    text = "F6000\n" + "".join("G1 X{:.4f} Y{:.4f}\n".format(
        *WAYS[way](i / 5000)) for i in range(1, 5001))
    lines, curve = (report("--dry-run", "--fit", fit,
                           text=text)["virtual_s"]
                    for fit in ("0", "1"))
    assert curve < 1.28 * lines


def test_two_thousand_lines_are_a_few_curves():
    count = {}
    for fit in "0", "1":
        out = run("--check", "--fit", fit, text=circle(2000)).stdout.decode()
        count[fit] = int(dict(line.split(None, 1) for line in
                              out.splitlines())["segments"])
    assert count["0"] == 2001
    assert count["1"] < 40


def test_a_curve_slower_than_its_feed_is_noted():
    sharp = "F6000\nG5.1 X0.02 Y0 I0.01 J10\n"
    slow = run("--check", text=sharp).stdout.decode()
    assert "curves     1 in " in slow
    assert "from line 2 on: slower than F, it bends too much" in slow
    assert "slower" not in run("--check", text=sharp.replace(
        "F6000", "F3")).stdout.decode()


def test_a_curve_may_end_a_program_under_an_offset():
    r = run("--emit", "iso", text=b"F600\nG41 D1 H1=0.1\nG1 X5\n"
                                  b"G5.1 X10 Y0 I5 J5\n")
    assert r.returncode == 0, r.stderr
    # It arrives downwards, at X10 Y0: the wire is to the left of that.
    x, y = re.findall(r"X(\S+) Y(\S+)", r.stdout.decode())[-1]
    assert abs(float(x) - 10.1) < 0.0015 and abs(float(y)) < 0.0015


@pytest.mark.parametrize("lead_in,lead_out", [(1, 0), (0, 1)])
def test_a_curve_is_no_lead(lead_in, lead_out):
    curve = "G91 G5.1 X10 Y0 I5 J5\n"
    line = "G91 G1 X10\n"
    text = "F600\nG41 D1 H1=0.1\n" + (curve if lead_in else line) + line + \
        "G40\n" + (curve if lead_out else line) + line
    r = run("--check", text=text)
    assert r.returncode == 65
    assert f"{3 if lead_in else 6}:10: error: a curve over which the offset " \
        "or the taper is reached or left; G1, G2 or G3 as the lead" in \
        r.stderr.decode(), r.stderr


def test_a_mistake_in_a_curve_is_told_with_its_place():
    r = run(text="F1\nG6.2 P3 K0 X0\nK0 X9 R-1\nK0 X3\nK1\nK1\nK1\n")
    assert r.returncode == 65
    assert b"3:7: error: R-1, a weight of -1; a weight above 0" in r.stderr


def test_a_word_that_cuts_a_curve_short_is_told_with_its_place():
    for text, place in (("K0 X3 C100", b"3:7:"), ("K0 X3 G21", b"3:7:"),
                        ("G1 X3", b"3:1:"), ("X3 K0 G54", b"3:7:")):
        r = run(text=f"F1\nG6.2 P3 K0 X0\n{text}\n")
        assert place + b" error: " in r.stderr, (text, r.stderr)
