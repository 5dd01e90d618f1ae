# SPDX-License-Identifier: Apache-2.0
"""Sides on which a rotary axis turns by different rates: moves stand between
them where that is quicker, and nowhere else."""

import math
import random

from speed_programs import axis_limits, machine
from test_dense import dry_s

POLYGONS = 20

# Each stand is judged beside its neighbours alone; a dwell takes a little.
MOST = 1.1


def polygon(rng, turns):
    """Its lines; C turns by up to 20 degrees on each if @turns."""
    at, x, y, lines = rng.uniform(0, 7), 0, 0, []
    for _ in range(rng.randint(3, 20)):
        length = 10 ** rng.uniform(-0.5, 1.1)
        at += rng.uniform(-2.9, 2.9)
        x += length * math.cos(at)
        y += length * math.sin(at)
        c = f" C{rng.uniform(-20, 20):.3f}" if turns else ""
        lines.append(f"G1 X{x:.3f} Y{y:.3f}{c}")
    return lines


def text(lines, feed=6000):
    return "\n".join([f"G21 G90 F{feed}", *lines, "M2", ""])


def with_stands(lines):
    """A dwell of 0.1 ms behind each line: none is a move with its neighbour."""
    return [word for line in lines for word in (line, "G4 P0.0001")]


def test_sides_that_turn_c_take_no_longer_than_with_stands(tmp_path):
    """They became one move, as soft as the softest side: up to twice as long."""
    shares = {}
    for seed in range(POLYGONS):
        rng = random.Random(seed)
        of = machine(tmp_path, {**{axis: axis_limits(rng, axis)
                                  for axis in "XYZ"},
                                "C": (60, rng.uniform(50, 500), 50000)})
        lines = polygon(rng, True)
        shares[seed] = (dry_s(of, text(lines)) /
                        dry_s(of, text(with_stands(lines))))
    assert not {k: round(x, 3) for k, x in shares.items() if x > MOST}


def zigzag(length, deg):
    """Lines on which C stays, and lines on which it turns, in turn."""
    x, c, lines = 0, 0, []
    for i in range(12):
        x += length if i % 2 else length / 10
        c += deg if i % 2 else 0
        lines.append(f"G1 X{x:.3f} Y{length if i % 2 else 0:.3f} C{c:.3f}")
    return lines


def test_short_sides_take_no_longer_than_with_stands(tmp_path):
    """They never come to the speed that their axes may go at.  With the ramps to
    that speed, stands seemed not to pay: up to 1.35 times as long."""
    shares = {}
    for seed in range(POLYGONS):
        rng = random.Random(seed)
        axes = {axis: (100, 10 ** rng.uniform(1.5, 2.5),
                       10 ** rng.uniform(3, 6)) for axis in "XYZ"}
        of = machine(tmp_path, {**axes, "C": (20, 10 ** rng.uniform(1, 2.5),
                                              10 ** rng.uniform(2, 3))})
        lines = zigzag(10 ** rng.uniform(-0.6, 0), rng.uniform(0.5, 5))
        shares[seed] = (dry_s(of, text(lines)) /
                        dry_s(of, text(with_stands(lines))))
    assert not {k: round(x, 3) for k, x in shares.items() if x > MOST}


# Three sides of 0.1 to 0.2 mm; C turns on the second one.
SHORT = [[(143, -118), (289, -232), (439, -341), (592, -445), (749, -544)],
         [(866, -693), (991, -834), (1124, -969), (1263, -1096), (1409, -1216),
          (1562, -1328), (1720, -1431), (1884, -1526)],
         [(2033, -1661), (2183, -1797), (2332, -1932), (2481, -2068),
          (2631, -2203), (2780, -2339), (2930, -2474), (3079, -2610)]]


def test_a_node_faster_than_its_side_comes_to_is_not_slow(tmp_path):
    """Roundings leave nodes that are slow beside what the axes may go at, but not
    beside what so short a side comes to.  Ramps were counted from them, and
    stands seemed not to pay: 1.22 times as long."""
    of = machine(tmp_path, {"X": (80, 1000, 20000), "Y": (80, 1000, 20000),
                            "C": (60, 300, 5000)})
    sides, c = [], 0
    for i, side in enumerate(SHORT):
        sides.append([])
        for x, y in side:
            c -= 0.05 * (i == 1)
            sides[-1].append(f"G1 X{x / 1e4} Y{y / 1e4} C{c:.4f}")
    stands = "\nG4 P0.0001\n".join("\n".join(k) for k in sides)
    assert dry_s(of, text(sum(sides, []))) <= MOST * dry_s(of, text([stands]))


def test_stands_cost_less_than_a_third_at_a_slow_f(tmp_path):
    """At F the corners are passed without slowing down, but for the stands that
    save time where it goes as fast as it can."""
    of = machine(tmp_path, {"C": (60, 10, 200)})
    for length, deg, feed in (0.1, 0.1, 20), (0.5, 0.1, 60), (0.3, 0.2, 10):
        x, lines = 0, []
        for i in range(40):
            x += 0 if i % 2 else length
            y, c = (length / 2, deg) if i % 4 in (1, 2) else (0, 0)
            lines.append(f"G1 X{x:.3f} Y{y:.3f} C{c:.3f}")
        at_f_s = 20 * 1.5 * length / feed * 60
        assert dry_s(of, text(lines, feed)) <= 1.33 * at_f_s


def test_sides_of_harder_axes_are_no_reason_to_stand(tmp_path):
    """A positioning has no more than its weakest linear axis.  A side of another
    one was taken to be as quick as that is: up to 1.1 times as long."""
    for seed in range(POLYGONS):
        rng = random.Random(seed)
        axes = {axis: (100, 10 ** rng.uniform(1.8, 3.2),
                       10 ** rng.uniform(4, 5)) for axis in "XYZ"}
        x, y = rng.uniform(1, 10), rng.uniform(1, 10)
        lines = [f"G1 X{p:.3f} Y{q:.3f}"
                 for p, q in ((x, 0), (x, y), (0, y), (0, 0)) * 3]
        weakest = tuple(min(v[i] for v in axes.values()) for i in range(3))
        apart, alike = (dry_s(machine(tmp_path, of), text(lines))
                        for of in (axes, dict.fromkeys("XYZ", weakest)))
        assert apart <= alike * 1.001, seed
