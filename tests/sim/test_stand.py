# SPDX-License-Identifier: Apache-2.0
"""Sides on which a rotary axis turns by different rates: moves stand between
them where that is quicker, and nowhere else."""

import math
import random

from test_dense import dry_s, limits, machine

POLYGONS = 20


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


def text(lines):
    return "\n".join(["G21 G90 F6000", *lines, "M2", ""])


def with_stands(lines):
    """A dwell of 0.1 ms behind each line: none is a move with its neighbour."""
    return [word for line in lines for word in (line, "G4 P0.0001")]


def test_sides_that_turn_c_take_no_longer_than_with_stands(tmp_path):
    """They became one move, as soft as the softest side: up to twice as long."""
    shares = {}
    for seed in range(POLYGONS):
        rng = random.Random(seed)
        of = machine(tmp_path, {**{axis: limits(rng, axis) for axis in "XYZ"},
                                "C": (60, rng.uniform(50, 500), 50000)})
        lines = polygon(rng, True)
        shares[seed] = (dry_s(of, text(lines)) /
                        dry_s(of, text(with_stands(lines))))
    assert not {k: round(x, 3) for k, x in shares.items() if x > 1 / 0.9}


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
