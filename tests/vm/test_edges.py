# SPDX-License-Identifier: Apache-2.0
"""Pulses of the edge thread, by the kernel's trace, in virtual time.

An instruction is 1 ns there, as on a slow processor of 1 GHz; the figures are a
model, no board's.  docs/gpio.md says what they are worth.
"""
import re

import pytest
from boot import EDGES
from test_virtual import points_by_steps, points_of_edmsim


def rises(text):
    """Times at which the one line traced goes up, and down."""
    up, down, was = [], [], "0"
    for row in text.splitlines():
        t, _, level, _ = row.split()
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


ROW = re.compile(r" *([\d.]+) us +(\d+) +([\d.]+) us +([\d.]+) us +(\d+) of "
                 r"(\d+)")
ALONE = 20000       # writes without a wait, before the trials


def test_doctor_tells_how_fast_a_line_goes_and_the_kernel_agrees(edges):
    """Each write that it speaks of is in the trace, and is as late as it says:
    where it calls none too late, none is half a slot off."""
    text = edges.text("pulses")
    assert edges.text("pulses.rc") == "0\n", text
    took = float(re.search(r"a write takes ([\d.]+) us", text)[1])
    rows = [tuple(map(float, m.groups())) for m in
            map(ROW.fullmatch, text.splitlines()) if m]
    writes = [(float(t) * 1e6, level) for t, _, level, _ in
              map(str.split, edges.text("pulses.trace").splitlines())]
    times = [t for t, _ in writes]
    # The chip's own first level is written when the line is requested.
    times = times[len(times) - 1 - ALONE - int(sum(r[5] for r in rows)):-1]
    print(text)
    assert took <= (times[ALONE - 1] - times[0]) / ALONE <= 1.5 * took + 1
    at = ALONE
    for slot, rate, late, worst, bad, n in rows:
        block = times[at:at + int(n)]
        at += int(n)
        gaps = [b - a for a, b in zip(block, block[1:])]
        assert rate == pytest.approx(1e6 / slot, abs=1)
        assert late <= worst
        if bad == 0:
            assert worst <= slot / 2
            assert sum(gaps) / len(gaps) == pytest.approx(slot, rel=0.01)
            assert slot / 2 - 2 <= min(gaps) and max(gaps) <= slot * 1.5 + 2
        else:
            assert worst > slot / 2 and max(gaps) > slot
    kept = [r for r in rows if r[4] == 0]
    assert kept and all(r[4] == 0 for r in rows[:-1])
    assert f"edges_per_period = {250 / kept[-1][0]:.0f} with period_us = 250" \
        in text
    levels = [level for _, level in writes[-1 - int(rows[0][5]):-1]]
    assert all(a != b for a, b in zip(levels, levels[1:]))


@pytest.mark.parametrize("line, why", [
    ("gpiochip0:6", "Device or resource busy"), ("gpiochip0:32", "Invalid"),
    ("gpiochip9:1", "No such file"), ("nine", "CHIP:NUMBER")])
def test_doctor_refuses_a_line_with_the_reason(edges, line, why):
    said = edges.text("pulses.refused").split(f"{line}:\n")[1]
    assert why in said.split("rc ")[0] and said.split("rc ")[1][:2] == "69"
