# SPDX-License-Identifier: Apache-2.0
"""In virtual time (an instruction is 4 ns): pulses and when they come.

The kernel's trace of what edmd drives is compared with what edmsim says of the
same job and machine.  What the figures are worth: docs/realtime.md.
"""
import re
import subprocess

import pytest
from boot import BUILD, VIRTUAL

PERIOD_S = 100e-6
LATE_US = 40  # more, and it may as well belong to the next period
STEP, DIR = {0: 0, 2: 1, 4: 2}, {1: 0, 3: 1, 5: 2}
INVERTED = {5}


def writes(text):
    """The trace as writes: (time, {line: on}); one has each line once."""
    now, at = {}, 0.0
    for row in text.splitlines():
        t, line, level, _ = row.split()
        line = int(line)
        if line in now:
            yield at, now
            now = {}
        if not now:
            at = float(t)
        now[line] = (level == "1") != (line in INVERTED)
    if now:
        yield at, now


def points_by_steps(text):
    """Axes moved, with their sign, at each write where a step rises."""
    was = dict.fromkeys(STEP, False)
    for _, now in writes(text):
        rises = [a for line, a in STEP.items() if now[line] and not was[line]]
        if rises:
            yield tuple(1 if a in rises and now[2 * a + 1] else
                        -1 if a in rises else 0 for a in range(3))
        was = now


def points_by_quarters(text):
    """The same from A and B, decoded as an encoder's."""
    turns = {(False, False): 0, (True, False): 1, (True, True): 2,
             (False, True): 3}
    was = [0, 0, 0]
    for _, now in writes(text):
        # Line 5 is inverted for the step mode's sake; so is B of Z here.
        is_ = [turns[now[2 * a], now[2 * a + 1]] for a in range(3)]
        moved = [(b - a) % 4 for a, b in zip(was, is_)]
        assert 2 not in moved, "both lines of an axis changed at once"
        if any(moved):
            yield tuple(-1 if m == 3 else m for m in moved)
        was = is_


def points_of_edmsim(folder, machine, job, files=VIRTUAL):
    """Lattice points of the same job on the same machine."""
    (folder / "machine.ini").write_text(files[machine])
    (folder / "job.ngc").write_text(files[job])
    subprocess.run(
        [BUILD / "edmsim", "--machine", "machine.ini", "--dry-run", "--quiet",
         "--pulses", "pulses.csv", "job.ngc"], cwd=folder, check=True)
    rows = (folder / "pulses.csv").read_text().splitlines()[1:]
    at = [tuple(map(int, r.split(",")[2:5])) for r in rows]
    return [tuple(b - a for a, b in zip(p, q)) for p, q in zip(at, at[1:])]


@pytest.mark.parametrize("run, machine, decode", [
    ("step1", "step.ini", points_by_steps),
    ("step2", "step.ini", points_by_steps),
    ("slow", "slow.ini", points_by_steps),
    ("quadrature", "quadrature.ini", points_by_quarters),
])
def test_pulses_are_those_of_edmsim_point_by_point(
        virtual, tmp_path, run, machine, decode):
    assert virtual.text(f"{run}.rc") == "0\n", virtual.text(f"{run}.log")
    got = list(decode(virtual.text(f"{run}.trace")))
    want = points_of_edmsim(tmp_path, machine, "pulses.ngc")
    for axis, name in enumerate("XYZ"):
        for sign in (1, -1):
            n = sum(p[axis] == sign for p in want)
            print(f"{run}: {name}{'+' if sign > 0 else '-'} {n} pulses")
            assert n > 100
            assert sum(p[axis] == sign for p in got) == n, (name, sign)
    assert got == want


def test_direction_stands_still_around_each_step(virtual):
    """Set-up of 4 periods, hold of 5, high for 3, low for 2."""
    was, dir_at, fell_at, rose_at = None, [0] * 3, [0] * 3, [0] * 3
    least = {"setup": 9e9, "hold": 9e9, "high": 9e9, "low": 9e9}

    def note(what, seconds):
        least[what] = min(least[what], seconds)

    for t, now in writes(virtual.text("slow.trace")):
        for a in range(3) if was else ():
            step, direction = 2 * a, 2 * a + 1
            if now[direction] != was[direction]:
                note("hold", t - fell_at[a])
                dir_at[a] = t
            if now[step] and not was[step]:
                note("setup", t - dir_at[a])
                note("low", t - fell_at[a])
                rose_at[a] = t
            if was[step] and not now[step]:
                note("high", t - rose_at[a])
                fell_at[a] = t
        was = now
    in_periods = {k: v / PERIOD_S for k, v in least.items()}
    print(in_periods)
    for what, wanted in ("setup", 4), ("hold", 5), ("high", 3), ("low", 2):
        assert in_periods[what] > wanted - 0.5, in_periods


def test_no_edge_is_late_or_missing_in_100000_periods(virtual):
    rows = [r.split() for r in virtual.text("line.trace").splitlines()]
    edges, was = [], "0"
    for t, _, level, _ in rows:
        if level != was:
            edges.append(float(t))
        was = level
    assert len(edges) == 100000
    periods = round((edges[-1] - edges[0]) / PERIOD_S)
    grid = [(t - edges[0]) / PERIOD_S for t in edges]
    off = [(g - round(g)) * PERIOD_S * 1e6 for g in grid]
    usual = sorted(off)[len(off) // 2]
    late = sum(abs(o - usual) > LATE_US for o in off)
    peer = cyclictest(virtual)
    print(f"{len(edges)} edges in {periods} periods, late {late}, jitter "
          f"{max(off) - min(off):.0f} us; cyclictest beside it: "
          f"{peer['Max'] - peer['Min']} us")
    assert late == 0
    assert periods < 100000 * 1.01
    assert "0 overruns" in virtual.text("line.status")


@pytest.mark.parametrize("load", ["nothing", "busy", "crowd", "jobs"])
def test_from_a_stop_to_sparks_off_are_five_periods_at_most(virtual, load):
    """Behind edmd's own socket: beside eight busy processes, clients that
    connect and say nothing, and an edmd-jobs that stands."""
    acts = [r.split() for r in virtual.text("stops").splitlines()]
    assert all(len(a) == 4 and a[3] == "0" for a in acts), acts
    falls = [float(r[0]) for r in map(str.split, virtual.text(
        "stop.trace").splitlines()) if r[1] == "0" and r[2] == "0"]
    took = [min(t for t in falls if t > float(sent)) - float(sent)
            for name, sent, _, _ in acts if name == load]
    in_periods = [1e3 * t for t in took]
    print(load, "in periods:", *(f"{t:.1f}" for t in in_periods))
    assert len(in_periods) == 8
    assert max(in_periods) <= 5


def cyclictest(virtual):
    text = virtual.text("cyclictest.txt")
    found = {k: int(re.search(rf"# {k} Latencies: *(\d+)", text)[1])
             for k in ("Min", "Avg", "Max")}
    return found
