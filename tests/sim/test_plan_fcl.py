# SPDX-License-Identifier: Apache-2.0
"""Distances of edm-plan against those of FCL, another implementation; and those
of FCL against all pairs of triangles."""
import math
import os
import random
import struct
import subprocess
from pathlib import Path

import fcl
import numpy as np

B = Path(os.environ.get("EDM_BUILD", "build")).resolve()
TOP = Path(__file__).resolve().parents[2]
TABLE = np.array((0.0, 0.0, -60.0))     # examples/channel.py


def triangles(path):
    raw = Path(path).read_bytes()
    n = struct.unpack_from("<I", raw, 80)[0]
    return np.array([struct.unpack_from("<9f", raw, 84 + 50 * i + 12)
                     for i in range(n)]).reshape(-1, 3, 3)


def model(path):
    at = triangles(path).reshape(-1, 3)
    n = len(at) // 3
    m = fcl.BVHModel()
    m.beginModel(n, 3 * n)
    m.addSubModel(at, np.arange(3 * n).reshape(-1, 3))
    m.endModel()
    return m


def turn(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    r = np.eye(3)
    r[i, i] = r[j, j] = c
    r[i, j], r[j, i] = -s, s
    return r


def pose(q):
    """Of chain A B X Y Z C, by its definition."""
    ra, rb, rc = turn(0, q[3]), turn(1, q[4]), turn(2, q[5])
    t = np.array(q[:3])
    r = ra @ rb
    return r @ rc, r @ (t - TABLE) + TABLE


def test_distances_are_those_of_fcl(tmp_path):
    subprocess.run([TOP / "examples/channel.py", tmp_path, "--rings", "12",
                    "--around", "16", "--nodes", "24"], check=True)
    part, tool = model(tmp_path / "part.stl"), model(tmp_path / "electrode.stl")
    draw = random.Random(3).uniform
    dense = [[float(w[1:]) for w in line.split()[1:7]]
             for line in (tmp_path / "dense.ngc").read_text().splitlines()
             if line.startswith("G1")]
    poses = [[v + draw(-.6, .6) for v in q] for q in dense]
    poses += [[draw(-60, 60) for _ in range(3)] + [draw(-90, 90) for _ in
              range(3)] for _ in range(100)]
    lines = "".join(" ".join("%.9f" % v for v in q) + "\n" for q in poses)
    (tmp_path / "poses").write_text(lines)
    r = subprocess.run([B / "edm-plan", "--part", tmp_path / "part.stl",
                        "--electrode", tmp_path / "electrode.stl", "--machine",
                        tmp_path / "machine.ini", "--measure",
                        tmp_path / "poses"], capture_output=True, text=True,
                       check=True)
    ours = [float(line.split()[0]) for line in r.stdout.splitlines()]
    apart = 0
    still = fcl.CollisionObject(part, fcl.Transform())
    for q, mine in zip(poses, ours):
        rot, shift = pose(q)
        moved = fcl.CollisionObject(tool, fcl.Transform(rot, shift))
        theirs = fcl.distance(still, moved, fcl.DistanceRequest(),
                              fcl.DistanceResult())
        # FCL says 0 or less, by how much depends on the pair, if they touch.
        assert abs(mine - max(theirs, 0)) < 1e-5, q
        apart += mine > 0
    assert apart > 20 and apart < len(poses)


def dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def edges_apart(p, q, r, s):
    """Squared distances of segments p q from segments r s, all with all."""
    p, q, r, s = p[:, None], q[:, None], r[None], s[None]
    u, v, w = q - p, s - r, p - r
    a, b, c, d, e = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    det = a * c - b * b
    x = np.where(det > 1e-12 * a * c, np.clip(
        (b * e - c * d) / np.where(det > 0, det, 1), 0, 1), 0)
    y = np.clip((b * x + e) / c, 0, 1)
    x = np.clip((b * y - d) / a, 0, 1)
    gap = w + x[..., None] * u - y[..., None] * v
    return dot(gap, gap)


def corners_apart(at, tri):
    """Squared distances of points from triangles over which they are."""
    a, b, c = tri[None, :, 0], tri[None, :, 1], tri[None, :, 2]
    n = np.cross(b - a, c - a)
    p = at[:, None]
    over = np.ones((len(at), len(tri)), bool)
    for u, v in ((a, b), (b, c), (c, a)):
        over &= dot(np.cross(v - u, p - u), n) >= 0
    return np.where(over, dot(p - a, n) ** 2 / dot(n, n), np.inf)


def brute(part, tool):
    """All pairs of triangles.  Only for bodies that do not meet."""
    least = min(corners_apart(part.reshape(-1, 3), tool).min(),
                corners_apart(tool.reshape(-1, 3), part).min())
    for i in range(3):
        for k in range(3):
            least = min(least, edges_apart(
                part[:, i], part[:, (i + 1) % 3], tool[:, k],
                tool[:, (k + 1) % 3]).min())
    return math.sqrt(least)


def test_distances_of_fcl_are_those_of_brute_force(tmp_path):
    subprocess.run([TOP / "examples/channel.py", tmp_path, "--rings", "8",
                    "--around", "12", "--nodes", "12"], check=True)
    part, tool = tmp_path / "part.stl", tmp_path / "electrode.stl"
    still, moving = triangles(part), triangles(tool)
    fixed, body = fcl.CollisionObject(model(part), fcl.Transform()), model(tool)
    draw, apart = random.Random(4).uniform, 0
    for _ in range(25):
        q = [draw(-40, 40), draw(-40, 40), draw(-40, 40), draw(-70, 70),
             draw(-70, 70), draw(-180, 180)]
        rot, shift = pose(q)
        theirs = fcl.distance(fixed, fcl.CollisionObject(
            body, fcl.Transform(rot, shift)), fcl.DistanceRequest(),
            fcl.DistanceResult())
        if theirs <= 0:
            continue
        apart += 1
        assert abs(theirs - brute(still, moving @ rot.T + shift)) < 1e-5, q
    assert apart > 5
