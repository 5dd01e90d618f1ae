# SPDX-License-Identifier: Apache-2.0
"""Pulses of the edge thread, by the kernel's trace, in virtual time.

An instruction is 1 ns there, as on a slow processor of 1 GHz; the figures are a
model, no board's.  docs/gpio.md says what they are worth.
"""
import pytest
from boot import EDGES
from test_virtual import points_by_steps, points_of_edmsim


def rises(text):
    """Times at which the one line traced goes up, and down."""
    up, down, was = [], [], "0"
    for row in text.splitlines():
        t, _, level = row.split()
        if level != was:
            (up if level == "1" else down).append(float(t))
        was = level
    return up, down


def test_edges_of_a_thread_keep_to_the_path_and_end_where_it_does(
        edges, tmp_path):
    """Within a period the axes go straight: a pulse off it, at the most."""
    assert edges.text("edges.rc") == "0\n", edges.text("edges.log")
    got = list(points_by_steps(edges.text("edges.trace")))
    path = [(0, 0, 0)]
    for p in points_of_edmsim(tmp_path, "edges.ini", "edges.ngc", EDGES):
        path.append(tuple(a + b for a, b in zip(path[-1], p)))
    at, i, worst = (0, 0, 0), 0, 0
    for p in got:
        at = tuple(a + b for a, b in zip(at, p))
        near = range(i, min(i + 60, len(path)))
        i = min(near, key=lambda k: max(abs(a - b)
                                        for a, b in zip(at, path[k])))
        worst = max(worst, max(abs(a - b) for a, b in zip(at, path[i])))
    print(f"edges: {len(got)} points, {len(path)} of the path, off it by "
          f"{worst} pulses")
    assert len(got) > 1000
    assert worst <= 1
    assert at == path[-1] and i == len(path) - 1


@pytest.mark.parametrize("name, slot_us, every_us, pulses", [
    ("even", 25, 100, 4000), ("fast", 6.25, 16.667, 16000)])
def test_edges_of_a_thread_are_evenly_spaced(edges, name, slot_us, every_us,
                                             pulses):
    """The one processor is the cycle's too: where that runs there is a gap,
    once a period, and the pulses behind it come as close as they may."""
    up, down = rises(edges.text(f"{name}.trace"))
    assert len(up) == len(down) == pulses
    # Where it goes at its full speed.
    full = slice(len(up) // 8, len(up) * 3 // 8) if name == "even" else \
        slice(len(up) * 4 // 10, len(up) * 6 // 10)
    mid = up[full]
    gaps = sorted((b - a) * 1e6 for a, b in zip(mid, mid[1:]))
    high = sorted((b - a) * 1e6 for a, b in zip(up, down))
    low = sorted((b - a) * 1e6 for a, b in zip(down, up[1:]))
    mean = (mid[-1] - mid[0]) / (len(mid) - 1) * 1e6
    near = sum(abs(g - every_us) < 1.3 * slot_us for g in gaps) / len(gaps)
    print(f"{name}: a pulse each {mean:.2f} us, {100 * near:.1f} % within a "
          f"slot, {gaps[0]:.1f} to {gaps[-1]:.1f} us; high from "
          f"{high[0]:.1f}, low from {low[0]:.1f} us")
    assert mean == pytest.approx(every_us, rel=0.01)
    assert near > 0.85
    assert gaps[0] > 2 * slot_us - 2 and gaps[-1] < every_us + 60
    assert high[0] > slot_us - 3 and low[0] > slot_us - 3
