# SPDX-License-Identifier: Apache-2.0
"""G5.2 beside LinuxCNC, and beside the curve as geomdl evaluates it."""
import g52
import pytest

PULSE_MM = 0.001
LINUXCNC_MM = 0.05	# its arcs are that near to the hook, to no other curve


@pytest.mark.parametrize("curve", [*g52.CURVES, g52.blade()],
                         ids=lambda curve: curve.name)
def test_lattice_points_round_the_curve_itself(curve, tmp_path):
    path = g52.path_of_edmsim(tmp_path, curve, PULSE_MM)
    off = g52.off_mm(path, g52.true_points(curve))
    assert off <= g52.PULSES_OFF * PULSE_MM + 1e-6


def test_weights_order_and_knots_are_linuxcncs(tmp_path):
    hook = g52.CURVES[-1]
    try:
        (path,), _ = g52.paths_of_linuxcnc(tmp_path, [hook])
    except g52.NoLinuxcnc as why:
        pytest.skip(f"no LinuxCNC to compare with: {why}")
    assert g52.off_mm(path, g52.true_points(hook)) < LINUXCNC_MM
