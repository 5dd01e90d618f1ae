# SPDX-License-Identifier: Apache-2.0
"""Promises of --pulses: which lattice points a program passes."""
import math

import pytest
from edmsim import (AXES, STRATEGIES, assert_neighbours, legs, places, pulses,
                    seeded)

PLANES = {"G17": "XY", "G18": "ZX", "G19": "YZ"}
OFFSETS = {"G17": "IJ", "G18": "KI", "G19": "JK"}
EPS = 1e-9


def mm(n):
    return f"{n / 1000:.4f}"


# -- Lines ---------------------------------------------------------------------

def within_half_a_pulse(at, end):
    """Is a place on the line from 0 to end within half a pulse, every axis?"""
    low, high = -EPS, 1 + EPS
    for p, d in zip(at, end):
        if d == 0:
            if abs(p) > 0.5:
                return False
            continue
        a, b = sorted(((p - 0.5) / d, (p + 0.5) / d))
        low, high = max(low, a), min(high, b)
    return low <= high + EPS


def square_to_line(at, end):
    (x, y), (dx, dy) = at, end
    return abs(dx * y - dy * x) / math.hypot(dx, dy)


def star(axes, reach):
    """There and home along every direction; line number to its end."""
    text, ends = ["G21 G90 F600"], {}
    for x in range(-reach, reach + 1):
        for y in range(-reach, reach + 1):
            if x == y == 0:
                continue
            text.append(f"G1 {axes[0]}{mm(x)} {axes[1]}{mm(y)}")
            ends[len(text)] = (x, y)
            text.append(f"G1 {axes[0]}0 {axes[1]}0")
    return "\n".join(text), ends


@pytest.mark.parametrize("axes", ["XY", "YZ", "ZX", "UV", "XA"])
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_line_ends_on_its_end_and_stays_near_in_all_octants(strategy, axes):
    text, ends = star(axes, 11)
    rows = pulses("--dry-run", "--strategy", strategy, text=text)
    assert rows[0][1:] == (0,) * 8
    column = [AXES.index(a) for a in axes]
    walked = legs(rows)
    for line, end in ends.items():
        leg = [tuple(p[c] for c in column) for p in walked[line]]
        assert leg[0] == (0, 0) and leg[-1] == end
        if strategy == "simultaneous":
            assert len(leg) - 1 == max(map(abs, end))
            assert all(within_half_a_pulse(p, end) for p in leg)
        else:
            assert len(leg) - 1 == sum(map(abs, end))
            assert all(square_to_line(p, end) <= 1 + EPS for p in leg)
    assert_neighbours([r[1:] for r in rows])


def test_point_by_point_moves_one_axis_at_a_time():
    rnd = seeded()
    text = ["G21 G90 F600"]
    for _ in range(200):
        text.append("G1 " + " ".join(f"{a}{mm(rnd.randint(-300, 300))}"
                                     for a in AXES if rnd.random() < 0.5))
    text = [t for t in text if t.strip() != "G1"]
    rows = places("--dry-run", "--strategy", "point-by-point",
                  text="\n".join(text))
    for a, b in zip(rows, rows[1:]):
        assert sum(abs(p - q) for p, q in zip(a, b)) == 1


def test_a_line_in_eight_axes_stays_within_half_a_pulse_of_each():
    rnd = seeded()
    for _ in range(100):
        end = [rnd.randint(-400, 400) for _ in AXES]
        if not any(end):
            continue
        text = "G21 F600\nG1 " + " ".join(a + mm(e)
                                          for a, e in zip(AXES, end))
        rows = places("--dry-run", "--strategy", "simultaneous", text=text)
        assert rows[-1] == tuple(end)
        assert all(within_half_a_pulse(p, end) for p in rows)


# -- Arcs ----------------------------------------------------------------------

RADIUS = 65
ON_CIRCLE = [(x, y) for x in range(-RADIUS, RADIUS + 1)
             for y in range(-RADIUS, RADIUS + 1)
             if x * x + y * y == RADIUS * RADIUS]


def arcs(plane):
    """Arcs about 0 between lattice points, both ways round, full circles."""
    (a, b), (i, j) = PLANES[plane], OFFSETS[plane]
    text, known = [f"G21 G90 {plane} F600"], {}
    for n, (x, y) in enumerate(ON_CIRCLE):
        for xe, ye in ON_CIRCLE[n % 5::5] + [(x, y)]:
            for g in "G2", "G3":
                text.append(f"G0 {a}{mm(x)} {b}{mm(y)}")
                text.append(f"{g} {a}{mm(xe)} {b}{mm(ye)} "
                            f"{i}{mm(-x)} {j}{mm(-y)}")
                known[len(text)] = (g, (x, y), (xe, ye))
    return "\n".join(text), known


def swept(leg):
    """Radian turned about 0, + counter-clockwise, point by point."""
    turn = 0
    for (x, y), (u, v) in zip(leg, leg[1:]):
        turn += math.atan2(x * v - y * u, x * u + y * v)
    return turn


def wanted_sweep(g, start, end):
    turn = math.atan2(end[1], end[0]) - math.atan2(start[1], start[0])
    turn %= 2 * math.pi
    if start == end:
        turn = 2 * math.pi
    elif g == "G2":
        turn -= 2 * math.pi
    return -turn if g == "G2" and start == end else turn


def pixel_meets_circle(x, y):
    """Does the circle pass within half a pulse of the point, both axes?"""
    x, y = abs(x), abs(y)
    near = math.hypot(max(x - 0.5, 0), max(y - 0.5, 0))
    return near - EPS <= RADIUS <= math.hypot(x + 0.5, y + 0.5) + EPS


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_an_arc_ends_on_its_end_and_stays_near_in_all_octants(strategy, plane):
    text, known = arcs(plane)
    walked = legs(pulses("--dry-run", "--strategy", strategy, text=text))
    column = [AXES.index(a) for a in PLANES[plane]]
    for line, (g, start, end) in known.items():
        leg = [tuple(p[c] for c in column) for p in walked[line]]
        assert leg[0] == start and leg[-1] == end, line
        assert swept(leg) == pytest.approx(wanted_sweep(g, start, end))
        assert_neighbours(leg)
        if strategy == "simultaneous":
            assert all(pixel_meets_circle(*p) for p in leg)
        else:
            assert all(abs(math.hypot(*p) - RADIUS) <= 1 for p in leg)
            assert all(abs(x - u) + abs(y - v) == 1
                       for (x, y), (u, v) in zip(leg, leg[1:]))


def test_an_arc_about_a_centre_between_two_pulses_is_walked_whole():
    text = ["G21 G90 F600"]
    for n in range(200):
        x = 0.001 * n + 0.0005
        text.append(f"G0 X{x - 0.021:.4f} Y0")
        text.append(f"G2 X{x + 0.021:.4f} I0.021 Z{n % 3 / 1000}")
    for strategy in STRATEGIES:
        rows = places("--dry-run", "--strategy", strategy,
                      text="\n".join(text))
        assert_neighbours(rows)


# -- Whatever the feed, period and direction -----------------------------------

def random_program(rnd, feed, lines=60):
    text = [f"G21 G91 F{feed}"]
    for _ in range(lines):
        pick, r = rnd.random(), round(rnd.uniform(0.01, 0.3), 3)
        if pick < 0.6:
            text.append("G1 " + " ".join(
                f"{a}{rnd.uniform(-0.2, 0.2):.4f}" for a in "XYZAU"
                if rnd.random() < 0.7) + " V0.001")
        else:
            text.append(f"G{rnd.choice('23')} X{2 * r:.3f} I{r:.3f} "
                        f"Z{rnd.uniform(-0.1, 0.1):.4f}")
    return text


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_points_do_not_depend_on_feed_or_period(strategy):
    text = random_program(seeded(), 100)
    first = places("--dry-run", "--strategy", strategy, text="\n".join(text))
    assert_neighbours(first)
    for feed, period in (1, 20000), (37, 20), (600, 1000), (5000, 20000):
        text[0] = f"G21 G91 F{feed}"
        assert places("--dry-run", "--strategy", strategy, "--period-us",
                      period, text="\n".join(text)) == first


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_there_and_back_passes_the_same_points_in_reverse(strategy):
    text = "\n".join(random_program(seeded(), 500))
    once = places("--dry-run", "--strategy", strategy, text=text)
    rows = places("--dry-run", "--there-and-back", "--strategy", strategy,
                  text=text)
    n = len(once)
    assert rows[:n] == once
    assert rows[n - 1:2 * n - 1] == once[::-1]
    assert rows[2 * n - 2:] == once


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_cut_walks_the_points_of_the_dry_run_to_and_fro(strategy):
    text = "\n".join(random_program(seeded(), 100, lines=12))
    dry = places("--dry-run", "--strategy", strategy, text=text)
    cut = places("--strategy", strategy, text=text)
    # Where the path turns back on itself there are two places to be at.
    at = {0}
    assert cut[0] == dry[0] and cut[-1] == dry[-1]
    for row in cut[1:]:
        at = {n for m in at for n in (m - 1, m + 1)
              if 0 <= n < len(dry) and dry[n] == row}
        assert at, row
    assert len(cut) > len(dry)


def test_the_first_row_is_the_start_of_the_machine(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[axis.X]\nstart_mm = 1.5\n[axis.Z]\nstart_mm = -2\n")
    rows = places("--dry-run", "--machine", machine, text="G21 F100\nG1 X2")
    assert rows[0] == (1500, 0, -2000, 0, 0, 0, 0, 0)
    assert rows[-1] == (2000, 0, -2000, 0, 0, 0, 0, 0)
