# SPDX-License-Identifier: Apache-2.0
"""Lifts that leave the path: what edm-plan --check says of them, against the
points that edmsim passes in jumps.

EDM_SEED draws other orbits, EDM_RUNS more of them.
"""
import csv
import math
import os
import random
import subprocess

import pytest
from test_plan import B, box, check_boxes, plan, write_stl

SEED = int(os.environ.get("EDM_SEED", 10))
RUNS = int(os.environ.get("EDM_RUNS", 1))
PIN = box((-.5, -.5, 0), (.5, .5, 20))
ORBIT = "G21 G90\n%s\nG1 Z0.5 F60\nG130 Z-5 R2.5 Q0.5 P1\nM2\n"
# Between the centre line and the orbit, where only lifts pass.
BETWEEN = box((-1.5, -.2, -4), (-.9, .2, -2.5))


@pytest.mark.parametrize("word, code", [("G140", 0), ("G141", 1), ("G142", 0),
                                        ("G143", 1)])
def test_what_only_a_lift_meets_is_found(tmp_path, word, code):
    r = check_boxes(tmp_path, BETWEEN, PIN, ORBIT % word, "--any-size")
    assert r.returncode == code, r.stdout + r.stderr
    assert ("p.ngc:4: not free" in r.stdout and "in a lift beside the path" in
            r.stdout and "part's triangle" in r.stdout) == (code == 1)


def test_a_lift_that_is_free_is_proved(tmp_path):
    below = box((-10, -10, -12), (10, 10, -6))
    r = check_boxes(tmp_path, below, PIN, ORBIT % "G141")
    assert r.returncode == 0, r.stdout + r.stderr
    assert "beside them" in r.stdout


def test_a_lift_is_not_free_where_it_is_a_hair_too_near(tmp_path):
    """The pin comes to the centre within 0.1 mm of the wall beside it."""
    for gap, code in ((0.085, 1), (0.115, 0)):
        beside = box((-10, .5 + gap, -4), (10, 2, -3.9))
        r = check_boxes(tmp_path, beside, PIN, "G21 G90\nG142\nG1 Z-5 F60\n"
                        "M2\n")
        assert r.returncode == code, r.stdout


def orbit(draw, r):
    word = draw.choice(["G130", "G131", "G132", "G133"])
    return "%s Z%.3f R%.3f Q%.3f" % (word, draw.uniform(-.8, -.4), r,
                                     draw.uniform(.1, .2))


def between(draw, r):
    """A splinter between the centre line and the orbit: only lifts, and the
    ways to the orbit and from it, may come near."""
    a, at = draw.uniform(0, 6.28), draw.uniform(.35, r - .35)
    lo = [at * math.cos(a) - .05, at * math.sin(a) - .05, draw.uniform(-.9, -.2)]
    return box(lo, [x + .1 for x in lo])


def run_sim(d, program):
    """Lattice points of a run with many jumps, as axes."""
    (d / "m.ini").write_text(
        "[machine]\nbackend = sim\n[jump]\nevery_s = 0.3\nheight_mm = 9\n"
        "[gap]\narcing_share = 0\n[sim]\narea_mm2 = 0.5\nwear_ratio = 0\n"
        "removal_mm3_min = 3\n"
        "debris_per_mm = 0\nbridge_per_s = 0\narcing_gain = 0\n"
        "[kinematics]\nchain = X Y Z\n")
    (d / "p.ngc").write_text(program)
    r = subprocess.run([B / "edmsim", "--quiet", "--limit-s", "900", "--pulses",
                        d / "points.csv", "--machine", d / "m.ini", d / "p.ngc"],
                       capture_output=True, text=True)
    assert r.returncode == 0, r.stdout + r.stderr
    with open(d / "points.csv") as f:
        rows = list(csv.DictReader(f))
    at = {tuple(round(int(r[a]) / 50) for a in "XYZ"): r for r in rows}
    return [" ".join("%.6f" % (int(r[a]) * 0.001) for a in "XYZABC")
            for r in at.values()]


@pytest.mark.parametrize("seed", range(SEED, SEED + RUNS))
def test_no_point_of_a_jump_is_nearer_than_what_is_proved(tmp_path, seed):
    draw = random.Random(seed)
    r = draw.uniform(.9, 1.4)
    write_stl(tmp_path / "part.stl", between(draw, r) +
              (between(draw, r) if draw.random() < .5 else []))
    write_stl(tmp_path / "tool.stl", box((-.1, -.1, 0), (.1, .1, 4)))
    program = "G21 G90 G17\n%s\nG1 Z0.1 F300\n%s F300\nM2\n" % (
        draw.choice(["G141", "G143"]), orbit(draw, r))
    base = ["--part", tmp_path / "part.stl", "--electrode",
            tmp_path / "tool.stl", "--machine", tmp_path / "m.ini", "--chord",
            "0", "--any-size", "--accept-flaws"]
    poses = run_sim(tmp_path, program)
    (tmp_path / "poses").write_text("\n".join(poses) + "\n")
    r = plan(*base, "--measure", tmp_path / "poses")
    assert r.returncode == 0, r.stderr
    least = min(float(s.split()[0]) for s in r.stdout.splitlines())

    def check(mm):
        return plan(*base, "--clearance", "%.6f" % max(mm, 0), "--check",
                    tmp_path / "p.ngc").returncode

    assert check(least + 0.003) == 1
    # Lifts begin elsewhere, too.
    assert least < 0.1 or check(0.9 * least - 0.06) == 0
