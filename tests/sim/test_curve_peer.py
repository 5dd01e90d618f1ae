# SPDX-License-Identifier: Apache-2.0
"""NURBS beside two libraries of others: the same points on random curves."""
import os
import random
import subprocess

from geomdl import NURBS

from edmsim import HANGS_S, ROOT

PEER = ROOT / os.environ.get("EDM_BUILD", "build") / "peer"
CURVES = 100000
WITHIN = 1e-12          # of the 100 mm the points lie within
DERIVATIVES_WITHIN = 1e-11


def peer(name):
    r = subprocess.run([str(PEER / name), str(CURVES),
                        os.environ.get("EDM_SEED") or
                        str(random.randrange(1 << 32))],
                       capture_output=True, text=True, check=True, timeout=HANGS_S)
    return r.stdout


def test_points_and_derivatives_are_sisls():
    got = dict(line.split() for line in
               peer("nurbs_sisl").splitlines())
    assert float(got["derivative-0"]) < WITHIN, got
    for k in range(1, 4):
        assert float(got[f"derivative-{k}"]) < DERIVATIVES_WITHIN, got


def floats(line):
    return list(map(float, line.split()))


def test_points_are_geomdls():
    lines = iter(peer("nurbs").splitlines())
    for head in lines:
        degree, axes, n = map(int, head.split())
        knots, rows = floats(next(lines)), floats(next(lines))
        u, *point = floats(next(lines))
        derivative = floats(next(lines))
        curve = NURBS.Curve(normalize_kv=False)
        curve.degree = degree
        # geomdl knows no curve of one axis: that axis twice.
        twice = 1 if axes == 1 else 0
        curve.ctrlptsw = [rows[i * (axes + 1):i * (axes + 1) + twice] +
                          rows[i * (axes + 1):(i + 1) * (axes + 1)]
                          for i in range(n)]
        curve.knotvector = knots
        place, speed = curve.derivatives(u, 1)
        place, speed = place[twice:], speed[twice:]
        assert all(abs(a - b) < WITHIN * 100 for a, b in zip(place, point))
        most = max(map(abs, derivative))
        assert all(abs(a - b) < 1e-9 * (1 + most)
                   for a, b in zip(speed, derivative))
