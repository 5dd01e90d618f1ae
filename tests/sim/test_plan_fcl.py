# SPDX-License-Identifier: Apache-2.0
"""Distances of edm-plan against those of FCL, another implementation."""
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


def model(path):
    raw = Path(path).read_bytes()
    n = struct.unpack_from("<I", raw, 80)[0]
    tris = np.array([struct.unpack_from("<9f", raw, 84 + 50 * i + 12)
                     for i in range(n)]).reshape(-1, 3)
    m = fcl.BVHModel()
    m.beginModel(n, 3 * n)
    m.addSubModel(tris, np.arange(3 * n).reshape(-1, 3))
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
