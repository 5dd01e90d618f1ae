# SPDX-License-Identifier: Apache-2.0
"""What edm-plan --check proves of a program, against the lattice points that
edmsim passes when it walks it.

EDM_SEED draws other programs, EDM_RUNS more of them.
"""
import csv
import math
import os
import random
import subprocess

import pytest
from test_plan import B, box, plan, write_stl

CHAINS = ["A(0 0 -60) B(0 0 -60) X Y Z C", "X Y Z C(0 0 3) A(0.5 0 210)",
          "C(4 5 -60) X Y Z B(0 0 180)", "X Y Z C",
          "B(0 0 0 / 0 0.70710678 0.70710678) C(0 0 -50) Y X Z",
          "X Y Z A(10 20 30) B C(-5 3 1)"]
PULSE = 0.001
SEED = int(os.environ.get("EDM_SEED", 1))
RUNS = int(os.environ.get("EDM_RUNS", 6))


def machine(draw, chain):
    text = ("[machine]\nbackend = sim\nstrategy = %s\n%s" %
            (draw.choice(["simultaneous", "point-by-point"]),
             draw.choice(["", "fit_um = 50\n"])))
    for a in "XYZABC":
        text += ("[axis.%s]\npulse_mm = %g\ntravel_min_mm = -900\n"
                 "travel_max_mm = 900\nv_max_mm_s = 200\n"
                 "a_max_mm_s2 = 5000\n" % (a, PULSE))
    text += "[axis.U]\npresent = no\n[axis.V]\npresent = no\n"
    return text + "[kinematics]\nchain = %s\ntip_x_mm = %.2f\n" % (
        chain, draw.uniform(-20, 20))


def line(draw, rotaries):
    words = ["%s%.4f" % (a, draw.uniform(-18, 18))
             for a in draw.sample("XYZ", draw.randint(1, 3))]
    words += ["%s%.3f" % (a, draw.uniform(-90, 90)) for a in rotaries
              if draw.random() < 0.5]
    return ["G1 " + " ".join(words)]


def arc(draw, rotaries):
    r, a, b = draw.uniform(1, 12), draw.uniform(0, 6), draw.uniform(0, 6)
    i, j = r * math.cos(a), r * math.sin(a)
    more = "".join(" %s%.3f" % (c, draw.uniform(-40, 40))
                   for c in rotaries[:1])
    return ["G91", "G%d X%.6f Y%.6f I%.6f J%.6f Z%.3f%s" % (
        draw.choice((2, 3)), i + r * math.cos(b), j + r * math.sin(b), i, j,
        draw.uniform(-5, 5), more), "G90"]


def curve(draw, _):
    at = [" X%.3f Y%.3f Z%.3f" % tuple(draw.uniform(-15, 15)
                                       for _ in range(3)) for _ in range(5)]
    lines = ["K%d%s" % (max(0, i - 2), p) for i, p in enumerate(at)]
    return ["G1" + at[0], "G6.2 P3 " + lines[0]] + lines[1:] + ["K3"] * 3


def program(draw, rotaries):
    lines = ["G21 G90 G17 F60000"]
    for _ in range(draw.randint(2, 6)):
        lines += draw.choice([line, line, arc, curve])(draw, rotaries)
    return "\n".join(lines + ["M2"]) + "\n"


def walked(d):
    """At most 1500 of the lattice points, as axes X Y Z A B C."""
    subprocess.run([B / "edmsim", "--quiet", "--dry-run", "--pulses",
                    d / "points.csv", "--machine", d / "m.ini", d / "p.ngc"],
                   check=True, capture_output=True)
    with open(d / "points.csv") as f:
        rows = list(csv.DictReader(f))
    return [" ".join("%.6f" % (int(r[a]) * PULSE) for a in "XYZABC")
            for r in rows[::max(1, len(rows) // 1500)]]


@pytest.mark.parametrize("seed", range(SEED, SEED + RUNS))
def test_no_lattice_point_is_nearer_than_what_is_proved(tmp_path, seed):
    draw = random.Random(seed)
    chain = draw.choice(CHAINS)
    part = []
    for _ in range(draw.randint(2, 6)):
        lo = [draw.uniform(-40, 40) for _ in range(3)]
        part += box(lo, [x + draw.choice([0.004, 0.05, 1, 9]) for x in lo])
    write_stl(tmp_path / "part.stl", part)
    write_stl(tmp_path / "tool.stl", box((-1, -1, -1), (1, 1, 6)))
    (tmp_path / "m.ini").write_text(machine(draw, chain))
    (tmp_path / "p.ngc").write_text(program(draw, [c for c in "ABC"
                                                   if c in chain]))
    base = ["--part", tmp_path / "part.stl", "--electrode",
            tmp_path / "tool.stl", "--machine", tmp_path / "m.ini", "--chord",
            "0", "--any-size", "--accept-flaws"]
    (tmp_path / "poses").write_text("\n".join(walked(tmp_path)) + "\n")
    r = plan(*base, "--measure", tmp_path / "poses")
    assert r.returncode == 0, r.stderr
    least = min(float(s.split()[0]) for s in r.stdout.splitlines())
    if not 0 < least < 90:
        pytest.skip("it touches, or all of it is far away")

    def check(mm):
        return plan(*base, "--clearance", "%.6f" % mm, "--check",
                    tmp_path / "p.ngc").returncode

    assert check(least + 0.003) == 1
    # Between the points that were looked at it may be nearer, by a little.
    assert check(max(0.9 * least - 0.06, 0)) == 0
