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


def test_sides_that_turn_nothing_take_no_longer_than_as_one_move(tmp_path):
    """A positioning has no more than its weakest linear axis, so softer sides
    are no reason to stand."""
    for seed in range(POLYGONS):
        rng = random.Random(seed)
        axes = {axis: limits(rng, axis) for axis in "XYZ"}
        lines = polygon(rng, False)
        a, j = (min(x[i] for x in axes.values()) for i in (1, 2))
        apart = dry_s(machine(tmp_path, axes), text(lines))
        alike = dry_s(machine(tmp_path, {
            axis: (v, a, j) for axis, (v, *_) in axes.items()}), text(lines))
        assert apart <= alike * 1.001, seed
