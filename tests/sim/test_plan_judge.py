# SPDX-License-Identifier: Apache-2.0
"""edm-plan --check of random programs, with FCL as the judge: rings, prisms and
foils, and poses from a chain that is multiplied out here.

EDM_SEED draws other ones, EDM_RUNS more of them.
"""
import math
import os
import random

import pytest
from test_plan import plan, write_stl

fcl = pytest.importorskip("fcl")
np = pytest.importorskip("numpy")

SEED = int(os.environ.get("EDM_SEED", 1))
RUNS = int(os.environ.get("EDM_RUNS", 4))
POSES = 60
CHAINS = {
    "X Y Z C(1 2 0) A(0 0 30)":
        [("X", 0), ("Y", 0), ("Z", 0), ("C", (1, 2, 0)), ("A", (0, 0, 30))],
    "A(0 0 -20) B(3 0 -20) X Y Z C(0 0 0)":
        [("A", (0, 0, -20)), ("B", (3, 0, -20)), ("X", 0), ("Y", 0), ("Z", 0),
         ("C", (0, 0, 0))],
    "C(0 0 0) X B(0 5 15) Y Z":
        [("C", (0, 0, 0)), ("X", 0), ("B", (0, 5, 15)), ("Y", 0), ("Z", 0)],
}


def ring(big, small, n, m, mid):
    def at(i, j):
        a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
        r = big + small * math.cos(b)
        return (mid[0] + r * math.cos(a), mid[1] + r * math.sin(a),
                mid[2] + small * math.sin(b))
    return [t for i in range(n) for j in range(m) for t in (
        (at(i, j), at(i + 1, j), at(i, j + 1)),
        (at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)))]


def prism(draw, low, high):
    n = draw.randint(5, 24)
    side = []
    for i in range(n):
        r, a = draw.uniform(1.5, 4), 2 * math.pi * i / n
        side.append((r * math.cos(a), r * math.sin(a)))
    tris = []
    for p, q in zip(side, side[1:] + side[:1]):
        tris += [((*p, low), (*q, low), (*p, high)),
                 ((*p, high), (*q, low), (*q, high)),
                 ((0, 0, low), (*q, low), (*p, low)),
                 ((0, 0, high), (*p, high), (*q, high))]
    return tris


def model(tris):
    at = np.asarray(tris, np.float32).astype(float).reshape(-1, 3)
    m = fcl.BVHModel()
    m.beginModel(len(at), len(tris))
    m.addSubModel(at, np.arange(len(at)).reshape(-1, 3))
    m.endModel()
    return m


def pose(chain, q):
    turn, shift = np.eye(3), np.zeros(3)
    for name, at in chain:
        k = "XYZABC".index(name)
        if k < 3:
            shift = shift + turn[:, k] * q[name]
            continue
        c, s = math.cos(math.radians(q[name])), math.sin(math.radians(q[name]))
        r, i, j = np.eye(3), (k + 1) % 3, (k + 2) % 3
        r[i, i] = r[j, j] = c
        r[i, j], r[j, i] = -s, s
        shift = shift + turn @ (np.array(at, float) - r @ np.array(at, float))
        turn = turn @ r
    return turn, shift


def program(draw, chain):
    at, lines = dict.fromkeys("XYZABC", 0.0), ["G21 G90"]
    nodes = [dict(at)]
    for _ in range(draw.randint(1, 4)):
        for a in draw.sample("XYZ", draw.randint(1, 3)):
            at[a] = round(draw.uniform(-14, 14) + 10 * (a == "Z"), 4)
        for a in [n for n, _ in chain if n in "ABC"]:
            at[a] = round(draw.uniform(-60, 60), 4)
        nodes.append(dict(at))
        lines.append("G1 " + " ".join("%s%.4f" % (a, at[a]) for a, _ in chain) +
                     " F100")
    return nodes, "\n".join(lines + ["M2"]) + "\n"


def least(part, tool, chain, nodes):
    """At many poses; 0 if they meet."""
    still, ret = fcl.CollisionObject(part, fcl.Transform()), math.inf
    for u, v in zip(nodes, nodes[1:]):
        for k in range(POSES + 1):
            q = {a: u[a] + k / POSES * (v[a] - u[a]) for a in u}
            moved = fcl.CollisionObject(tool, fcl.Transform(*pose(chain, q)))
            if fcl.collide(still, moved, fcl.CollisionRequest(),
                           fcl.CollisionResult()):
                return 0
            ret = min(ret, fcl.distance(still, moved, fcl.DistanceRequest(),
                                        fcl.DistanceResult()))
    return ret


@pytest.mark.parametrize("seed", range(SEED, SEED + RUNS))
def test_no_more_is_proved_than_fcl_sees(tmp_path, seed):
    draw = random.Random(seed)
    part = ring(draw.uniform(5, 12), draw.uniform(.5, 2),
                draw.choice([6, 17, 40]), draw.choice([4, 9, 16]),
                [draw.uniform(-3, 3) for _ in range(3)])
    if draw.random() < .4:
        z = draw.uniform(-14, -10)
        part += prism(draw, z, z + draw.choice([.002, .05, 3]))
    high = draw.uniform(8, 25)
    tool = [tuple((x + 6, y - 3, z + high) for x, y, z in t)
            for t in prism(draw, 0, draw.uniform(5, 30))]
    name, chain = draw.choice(sorted(CHAINS.items()))
    nodes, text = program(draw, chain)
    write_stl(tmp_path / "part.stl", part)
    write_stl(tmp_path / "tool.stl", tool)
    (tmp_path / "p.ngc").write_text(text)
    (tmp_path / "m.ini").write_text(
        "[machine]\nbackend = sim\n" +
        "".join("[axis.%s]\npulse_mm = 0.0001\ntravel_min_mm = -900\n"
                "travel_max_mm = 900\n" % a for a in "XYZABC") +
        "[axis.U]\npresent = no\n[axis.V]\npresent = no\n"
        "[kinematics]\nchain = %s\n" % name)
    mm = least(model(part), model(tool), chain, nodes)
    r = plan("--part", tmp_path / "part.stl", "--electrode",
             tmp_path / "tool.stl", "--machine", tmp_path / "m.ini", "--chord",
             "0", "--any-size", "--accept-flaws", "--clearance",
             "%.6f" % (mm + .0005 if mm else 0), "--check", tmp_path / "p.ngc")
    assert r.returncode == 1, r.stdout + r.stderr
