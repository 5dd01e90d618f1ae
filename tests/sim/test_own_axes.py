# SPDX-License-Identifier: Apache-2.0
"""Promise of every move: it is as quick as the axes that it moves allow.

An axis that stands, or that goes evenly beside a bend, does not slow it down by
what it cannot do.
"""
import pytest

from speed_programs import machine
from test_dense import dry_s

WEAK = (50, 50, 2000)
STRONG = (50, 1000, 40000)


def both_s(folder, text, axis):
    """The time beside a weak @axis, and beside one that is as strong as X Y."""
    axes = dict.fromkeys("XYZC", STRONG)
    return [dry_s(machine(folder, {**axes, axis: limits}),
                  f"G21 G90 F60000\n{text}\nM2\n")
            for limits in (WEAK, STRONG)]


@pytest.mark.parametrize("move", ["G0 X20", "G0 X20\nG0 Y20",
                                  "G1 X10 Y10\nG1 X20",
                                  "G3 X20 Y0 I10 J0"])
def test_a_move_does_not_know_the_axes_that_stand(tmp_path, move):
    weak, strong = both_s(tmp_path, move, "Z")
    assert weak == strong


@pytest.mark.parametrize("axis, goes", [("Z", 0.05), ("C", 0.05)])
def test_an_axis_beside_an_arc_has_no_bend(tmp_path, axis, goes):
    """So little is within what the weak axis can do."""
    weak, strong = both_s(tmp_path, f"G3 X20 Y0 {axis}{goes} I10 J0", axis)
    assert weak == pytest.approx(strong, rel=1e-3)


def test_a_move_of_a_rotary_axis_has_all_of_it(tmp_path):
    weak, strong = both_s(tmp_path, "G0 C90", "X")
    assert weak == strong
