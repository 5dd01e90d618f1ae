# SPDX-License-Identifier: Apache-2.0
"""G43.5, the tool's direction by I J K, and G6.3, a body along two NURBS.

The machine's joints, the great circle and the rotations are written anew here;
the curves are geomdl's.
"""
import csv
import functools
import math

import numpy as np
import pytest
from edmsim import AXES, ROOT, done, pulses, report, run
from geomdl import NURBS

INI = (ROOT / "examples/five-axis.ini").read_text()
ROLL = INI.replace("[axis.B]\npresent = no", "[axis.B]\nv_max_mm_s = 60") \
    .replace("A(0 15 -80) X Y Z", "A(0 15 -80) X Y Z B(0 0 -75 / 0 0 1)")
UM = 1
# Half a pulse of each axis: thrice 0.5 um, and 0.0005 degrees of two rotaries
# at up to 200 mm; of the direction that of two or three rotaries.
OFF_UM = UM + 0.5 * 3**0.5 + 2 * 200e3 * math.radians(0.0005)
OFF_DEG = 2 * 0.001 + 3 * 0.0005
BEGIN = "G90\nG0 Z20\n"
END = "G49\nG0 Z40\nM30\n"


def turn(axis, deg):
    c, s = np.cos(np.radians(deg)), np.sin(np.radians(deg))
    i, j = {"X": (1, 2), "Z": (0, 1)}[axis]
    m = np.zeros((len(deg), 3, 3))
    m[:] = np.eye(3)
    m[:, i, i] = m[:, j, j] = c
    m[:, i, j], m[:, j, i] = -s, s
    return m


def poses(rows):
    """Tips in mm and rotations of the tool, seen from the work."""
    q = {n: np.array([r[1 + AXES.index(n)] for r in rows]) / 1e3
         for n in "XYZABC"}
    tip = np.stack([q["X"], q["Y"] - 15, q["Z"] - 75 + 80], axis=1)
    a, c = turn("X", q["A"]), turn("Z", q["C"])
    tip = np.einsum("nij,nj->ni", a, tip) + (0, 15, -80)
    tip = np.einsum("nij,nj->ni", c, tip)
    return tip, c @ a @ turn("Z", q["B"])


def walked(tmp_path, text, ini=INI, line=None):
    machine = tmp_path / "m.ini"
    machine.write_text(ini)
    rows = pulses("--dry-run", "--machine", machine, text=text)
    return poses([r for r in rows if line is None or r[0] in line])


def unit(v):
    return np.array(v, float) / np.linalg.norm(v)


def test_next_to_a_pole_f_is_kept_and_c_turns_one_way():
    """The linear axes go by 1e-7 mm and C by 90 degrees, at 100 a minute."""
    text = ("G0 X0 Y0 Z-5 A0.0010 C45\nG43.5\nF100\n"
            "G1 I-0.0000007008 J-0.0000007133 K1\nM2\n")
    machine = ("--machine", ROOT / "examples/machine-five-axis.ini",
               "--period-us", 200, "--limit-s", 400, "--dry-run")
    c = [r[1 + AXES.index("C")] for r in pulses(*machine, text=text)
         if r[0] == 4]
    assert c == sorted(c, reverse=True)
    once = report(*machine, text=text)
    assert 54 < once["virtual_s"] < 58
    both = report("--there-and-back", *machine, text=text)
    assert both["pulses"]["C"] == 3 * once["pulses"]["C"]


def test_past_a_pole_c_keeps_its_speed(tmp_path):
    """Within a percent: of a narrower peak, a rounding explains as much."""
    text = ("F140\nG0 X0 Y0 Z-5 A0.00008 C27.168\nG43.5\n"
            "G1 Z-6.625 I0.0082033554 J0.0055285474 K1\n"
            "G1 Y1.047 I0.0000006163 J0.0000112722 K1\nM2\n")
    done("--dry-run", "--there-and-back", "--machine",
         ROOT / "examples/machine-five-axis.ini", "--trace",
         tmp_path / "t.csv", text=text)
    with open(tmp_path / "t.csv") as f:
        c = np.array([float(row["C"]) for row in csv.DictReader(f)])
    ms = 20
    fastest = np.abs(c[ms:] - c[:-ms]).max() / ms * 1e3
    assert 59 < fastest < 60.6


CUSPS = """G90
G43.5
G0 X-18.2076 Y-14.2305 Z-62.9387 I0.267473484 J0.251806611 K0.930081376
F4800
G6.3 P0 R0.9693 X-18.2076 Y-14.2305 Z-62.9387 Q1 I-0.11297 J0.155051 K0.126238
P0 R0.2 X-20.2085 Y-11.2578 Z-63.5488 Q1 I-0.11297 J0.155051 K0.126238
P0 R1 X-18.207 Y-14.2299 Z-62.9386 Q1 I0.122856 J-0.12973 K0.502129
P0 R0.2 X-20.208 Y-11.2579 Z-63.5497 Q1 I0.264092 J0.212041 K0.467024
P0.01 R5 X-18.2144 Y-14.2609 Z-62.9729 Q0.5 I-0.095343 J0.006574 K0.091985
P1.01 R1 X-20.2087 Y-11.2584 Z-63.5492 Q1 I-0.07491 J-0.328314 K-0.033617
P1.0101 R30 X-18.2144 Y-14.2609 Z-62.9729 Q2 I0.018548 J-0.617916 K0.320059
P2.0101 R1 X-20.2087 Y-11.2584 Z-63.5492 Q1 I0.083725 J0.329275 K-0.324489
P2.3101 R30 X-2.2906 Y-7.7618 Z-66.0941 Q1 I0.074692 J0.034919 K-0.373502
P2.3111
P2.3111
P2.3111
P2.3111
M2
"""


def test_on_peaks_as_wide_as_a_window_b_keeps_its_speed(tmp_path):
    """Its rate goes to and fro within 0.3 mm of lines, from their start on."""
    most, wide = 7.2, 0.29
    x = 0.0099 * np.arange(1, 300)
    b = most * np.sin(x / wide * 2 * np.pi) * wide / 2 / np.pi
    text = "G90 F3000\nG1 X0 B0\n" + "".join(
        f"X{x:.6f} B{b:.6f}\n" for x, b in zip(x, b)) + "M2\n"
    (tmp_path / "m.ini").write_text(
        "[machine]\nperiod_us = 100\nbackend = null\n"
        "[speed]\ncorner_um = 0.5\n" + "".join(
            f"[axis.{a}]\npulse_mm = 1e-5\nv_max_mm_s = {v}\n"
            "a_max_mm_s2 = 300\nj_max_mm_s3 = 1e5\n"
            "travel_min_mm = -100\ntravel_max_mm = 100\n"
            for a, v in (("X", 17.5), ("B", 3.45))))
    done("--machine", tmp_path / "m.ini", "--dry-run", "--trace",
         tmp_path / "t.csv", text=text)
    with open(tmp_path / "t.csv") as f:
        at = [float(row["B"]) for row in csv.DictReader(f)]
    v = max(abs(b - a) for a, b in zip(at, at[100:])) / 0.01
    assert 0.9 * 3.45 < v < 1.02 * 3.45


def test_at_a_cusp_a_keeps_its_acceleration(tmp_path):
    """It bends and speeds up there at once."""
    done("--dry-run", "--machine", ROOT / "examples/machine-five-axis.ini",
         "--trace", tmp_path / "t.csv", text=CUSPS)
    with open(tmp_path / "t.csv") as f:
        a = np.array([float(row["A"]) for row in csv.DictReader(f)])
    s = 0.02
    n = round(s * 1e3)
    most = np.abs(a[2 * n:] - 2 * a[n:-n] + a[:-2 * n]).max() / s**2
    assert 200 < most < 1.05 * 300 + 2 * 0.001 / s**2


# Bodies that turn back, or turn by a pole.  Their limits: v, a, j of X Y Z A C.
TURNS_BACK = (
    5, ((6, 22, 6, 37, 51), (1006, 1203, 249, 141, 131),
     (19668, 130361, 21443, 8041, 12832)), "X20 Y0 Z-60 A0.000415 C0", """F20000
G6.3 L4 P0 X20 Y0 Z-60 Q1 I0.000003618
P0 Z-60
P0 Z-60
P0 Q1 I0.000003088 J0.000000099 K-0.000012102
P1 Z-60
P1.0000001 Q1 I0.000003618
P1.0000101 Q1 I0.000003618
P1.0000201 Q1 I0.000003618
""" + "P1.0000301\n" * 4)
TURNS_BACK_AT_A_POLE = (
    1, ((14, 6, 39, 62, 84), (171, 1017, 396, 260, 103),
     (6117, 25396, 7498, 20502, 63943)), "X0 Y0 Z-60 A0 C0", """F600
G6.3 L7 P0 X0 Y0 Z-60 Q1
P0 X-0.004629 Y-0.00485 Z-60.004661 Q1 K0.017417593
P0 X0 Y0 Z-60 Q1 I0.018042819 K-0.012471297
P0 X-0.00368 Q1 I-0.007317978 J-0.003154055
P0 X-0.00368 Q1 I-0.007317978 J-0.003154055
P0 X0 Y0 Z-60 Q1 I0.018042819 K-0.012471297
P0 X-0.004629 Y-0.00485 Z-60.004661 Q1 K0.017417593
P1 X0 Y0 Z-60 Q1
""" + "P2\n" * 7)


@pytest.mark.parametrize("body", [TURNS_BACK, TURNS_BACK_AT_A_POLE],
                         ids=["beside its path", "at a pole"])
def test_where_it_turns_back_c_keeps_its_acceleration(tmp_path, body):
    """It is passed no faster than C can follow, however tiny its lines are."""
    um, limits, start, text = body
    (tmp_path / "m.ini").write_text(
        "[machine]\nbackend = null\n"
        + INI[INI.index("[kinematics]"):].replace("_um = 1", f"_um = {um}")
        + "".join(f"[axis.{x}]\npresent = no\n" for x in "BUV") + "".join(
        f"[axis.{x}]\npulse_mm = 2e-5\nv_max_mm_s = {v}\na_max_mm_s2 = {a}\n"
        f"j_max_mm_s3 = {j}\ntravel_min_mm = -9000\ntravel_max_mm = 9000\n"
        for x, v, a, j in zip("XYZAC", *limits)))
    done("--dry-run", "--machine", tmp_path / "m.ini", "--trace",
         tmp_path / "t.csv", text=f"G90 G43.4\nG0 {start}\n{text}M2\n")
    with open(tmp_path / "t.csv") as f:
        c = np.array([float(row["C"]) for row in csv.DictReader(f)])
    most = limits[1][4]
    for ms in (12, 24, 48):
        off = np.abs(c[2 * ms:] - 2 * c[ms:-ms] + c[:-2 * ms]).max()
        # Within corner_um and the tolerance of the tip C may be beside it.
        assert off < 1.05 * most * (ms / 1e3)**2 + 4 * 0.010, ms


AT_A_POLE = {
    "the tip stands": ("A0 C0", """F20000
G6.3 L5 P0 R1.306942 X0 Y0 Z-60 Q1
P0 R0.347643 Q1 I0.000013008 J0.000018021 K-0.000016749
P0 R0.452495 Q1
P0 R0.793186 Q1 I-0.000005009 J0.000006163 K0.0000157
P0 R2.068214 Q1
P1 R0.366084 Q1 I-0.000005505
P1 R0.514426 Q1
""" + "P2\n" * 5, 4.8),
    "it leaves it": ("A-0.00028 C-8.147295", """F4800
G6.3 L2 P0 X0 Y0 Z-60 Q0.997473562 I-0.000002435 J0.000000173 K-0.071038677
P0 Y-0.002586 Z-60.001017 Q0.997473562 I-0.000002435 J0.000000173 K-0.082049456
P1 Q0.997473562 I-0.005374664 J0.005153677 K-0.083577986
P2 Y0 Z-60 Q0.997473562 I-0.000002435 J0.000000173 K-0.071038677
P3
P3
""", 6),
}


@pytest.mark.parametrize("name", AT_A_POLE)
def test_at_a_pole_a_body_goes_on(name):
    """Its lines are some nanometres long there, or degrees."""
    start, text, most_s = AT_A_POLE[name]
    r = report("--dry-run", "--limit-s", 60, "--machine",
               ROOT / "examples/machine-five-axis.ini",
               text=f"G90 G43.4\nG0 X0 Y0 Z-60 {start}\n{text}M2\n")
    assert r["outcome"] == "done" and r["virtual_s"] < most_s


def angle_deg(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1),
                                 (a * b).sum(-1)))


WAYS = {
    "tilt": ((0.3, 0.2, 1), (-0.3, 0.4, 1)),
    "from upright": ((0, 0, 1), (0.3, -0.5, 1)),
    "to upright": ((0.3, -0.5, 1), (0, 0, 1)),
    "over upright": ((0.2, 0.1, 1), (-0.4, -0.2, 1)),
    "close by upright": ((0.3, 0.001, 1), (-0.3, 0.001, 1)),
    "turn alone": ((0.4, 0.2, 1), (-0.1, 0.3, 1)),
}


@pytest.mark.parametrize("name", WAYS)
def test_the_tool_turns_in_the_plane_of_both_directions(tmp_path, name):
    d0, d1 = WAYS[name]
    to = (30, 0, -60) if name == "turn alone" else (10, 5, -62)
    words = [" ".join(f"{a}{x:.6f}" for a, x in zip("IJK", d))
             for d in (d0, d1)]
    text = (BEGIN + f"G43.5\nG0 X30 Y0 Z-60 {words[0]}\nF120\n"
            f"G1 X{to[0]}. Y{to[1]}. Z{to[2]}. {words[1]}\n" + END)
    tip, rotation = walked(tmp_path, text, line=(6,))
    a, b = np.array((30, 0, -60.0)), np.array(to, float)
    d0, d1 = unit(d0), unit(d1)
    d = rotation[:, :, 2]
    side = np.cross(d0, d1)
    side /= np.linalg.norm(side)
    assert np.degrees(np.abs(np.arcsin(d @ side))).max() < OFF_DEG
    assert angle_deg(d[-1], d1) < OFF_DEG
    whole = angle_deg(d0, d1)
    done = angle_deg(d, d0) / whole
    assert done.min() >= 0 and done.max() < 1 + OFF_DEG / whole
    if name == "turn alone":
        assert np.linalg.norm(tip - a, axis=1).max() * 1e3 < OFF_UM
        return
    share = (tip - a) @ (b - a) / ((b - a) @ (b - a))
    off = np.linalg.norm(tip - a - np.outer(share, b - a), axis=1)
    assert off.max() * 1e3 < OFF_UM
    # The direction goes with the tip: at equal shares of both ways.
    length = np.linalg.norm(b - a) * 1e3
    assert np.abs(share - done).max() < OFF_UM / length + OFF_DEG / whole


def test_without_i_j_k_the_direction_stays(tmp_path):
    text = (BEGIN + "G43.5\nG0 X30 Y0 Z-60 I0.3 J0.2 K1\nF120\nG1 X10\n"
            "G3 X0 Y10 I-10 J0\nG1 Y0 K1\n" + END)
    _, rotation = walked(tmp_path, text, line=(6, 7))
    assert angle_deg(rotation[:, :, 2], unit((0.3, 0.2, 1))).max() < OFF_DEG
    _, rotation = walked(tmp_path, text, line=(8,))
    assert angle_deg(rotation[-1, :, 2], unit((0, 0, 1))) < OFF_DEG


# -- A body ------------------------------------------------------------------

KNOTS = [0, 0, 0, 0, 0.4, 1, 1, 1, 1]
PLACES = [(30, 0, -60), (20, 10, -60), (10, 15, -62), (0, 5, -60), (-8, 0, -61)]
TURNS = [(1, 0, 0, 0), (0.97, 0.15, 0.1, 0.1), (0.9, 0.3, 0.1, 0.2),
         (1.8, 0.6, 0.4, 0.6), (0.9, 0.1, 0.2, 0.3)]
WEIGHTS = [1, 2, 1, 0.5, 1]


def body_text():
    lines = []
    for i, (p, q, w) in enumerate(zip(PLACES, TURNS, WEIGHTS)):
        words = [f"{a}{float(x)}" for a, x in zip("XYZQIJK", (*p, *q))]
        lines.append(f"P{KNOTS[i]} R{w} " + " ".join(words))
    return ("G6.3 L4 " + "\n".join(lines) + "\n" +
            "".join(f"P{k}\n" for k in KNOTS[len(PLACES):]))


@functools.cache
def true_body(n=4000):
    """Tips and rotations along the two curves."""
    out = []
    for rows in (PLACES, TURNS):
        c = NURBS.Curve(normalize_kv=False)
        c.degree = 3
        c.ctrlptsw = [[x * w for x in p] + [w] for p, w in zip(rows, WEIGHTS)]
        c.knotvector = KNOTS
        out.append(np.array(c.evaluate_list(list(np.linspace(0, 1, n)))))
    tip, q = out
    q /= np.linalg.norm(q, axis=1)[:, None]
    w, x, y, z = q.T
    return tip, np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z),
                  2 * (x * z + w * y)], axis=1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
                  2 * (y * z - w * x)], axis=1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x),
                  1 - 2 * (x * x + y * y)], axis=1)], axis=1)


BODY = BEGIN + "G43.4\nG0 X30 Y0 Z-60\nF120\n" + body_text() + END
LINES = range(6, 6 + body_text().count("\n"))


def compare(tip, rotation, whole):
    """Of each point the nearest place on the true way: um off, degrees off."""
    true_tip, true_turn = true_body()
    off, turned = [], []
    steps = np.linalg.norm(np.diff(true_tip, axis=0), axis=1)
    step = steps.max()
    c = (np.einsum("nij,nij->n", true_turn[1:], true_turn[:-1]) - 1) / 2
    rate = (np.degrees(np.arccos(np.clip(c, -1, 1))) / steps).max()
    for p, m in zip(tip[::41], rotation[::41]):
        d = np.linalg.norm(true_tip - p, axis=1)
        near = d < d.min() + step
        off.append(d.min())
        # Every place that the tip may be meant for.
        r = np.einsum("nji,jk->nik", true_turn[near], m)
        if whole:
            c = (np.trace(r, axis1=1, axis2=2) - 1) / 2
            turned.append(np.degrees(np.arccos(np.clip(c, -1, 1))).min())
        else:
            turned.append(angle_deg(true_turn[near][:, :, 2], m[:, 2]).min())
    return 1e3 * np.array(off), np.array(turned), step, rate


@pytest.mark.parametrize("whole", [False, True])
def test_a_body_keeps_to_both_curves(tmp_path, whole):
    tip, rotation = walked(tmp_path, BODY, ROLL if whole else INI, LINES)
    assert len(tip) > 10000
    off, turned, step, rate = compare(tip, rotation, whole)
    # Between two samples the nearest one is half a step away at the most.
    assert off.max() < OFF_UM + 1e3 * step / 2
    # The rotation goes on while the tip goes on by what it is off its place.
    assert turned.max() < OFF_DEG + rate * (step / 2 + OFF_UM / 1e3)
    assert turned.max() < 0.1
    true_tip, true_turn = true_body(2)
    assert np.linalg.norm(tip[-1] - true_tip[-1]) * 1e3 < OFF_UM
    assert angle_deg(rotation[-1, :, 2], true_turn[-1, :, 2]) < OFF_DEG
    if whole:
        assert angle_deg(rotation[-1, :, 0], true_turn[-1, :, 0]) < OFF_DEG


def test_a_body_comes_to_a_pole_while_it_turns_about_itself(tmp_path):
    """The table turns up to the pole; at the pole it may have any angle."""
    to = [(30, 0, -60), (10, 5, -62), (0, -5, -60)]
    text = BEGIN + "G43.4\nG0 X30. Y0. Z-60.\nF120\n" + (
        "G6.3 L2 P0 X30. Y0. Z-60. Q1\n"
        "P0 X10. Y5. Z-62. Q1 I-0.2 J0.1\n"
        "P1 X0. Y-5. Z-60. Q1 K0.3\nP2\nP2\n") + END
    tip, rotation = walked(tmp_path, text, line=(6, 7, 8))
    off = []
    for a, b in zip(np.array(to[:-1], float), np.array(to[1:], float)):
        share = np.clip((tip - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        off.append(np.linalg.norm(tip - a - np.outer(share, b - a), axis=1))
    assert np.min(off, axis=0).max() * 1e3 < OFF_UM
    assert np.linalg.norm(tip[-1] - to[-1]) * 1e3 < OFF_UM
    assert angle_deg(rotation[-1, :, 2], unit((0, 0, 1))) < OFF_DEG


def test_a_body_goes_back_as_it_came(tmp_path):
    (tmp_path / "m.ini").write_text(INI)
    rows = pulses("--dry-run", "--there-and-back",
                  "--machine", tmp_path / "m.ini", text=BODY)
    at = [r[1:] for r in rows]
    n = len(at) // 3
    assert len(at) == 3 * n + 1 and n > 100000
    assert at[n:2 * n + 1] == at[n::-1]
    assert at[2 * n:] == at[:n + 1]


def test_turns_in_place_do_not_add_up(tmp_path):
    """C turns by 170 degrees while the tip goes on by a tenth of a mm."""
    ini = INI.replace("tolerance_um = 1", "tolerance_um = 20")
    to = [(0, 0, -75), (1, 1, -75), (1, 0, -75)]
    q = [(1, 0.0001, x, 0) for x in (-0.002, 0.003, 0.008)]
    words = [" ".join(f"{a}{x}" for a, x in zip("XYZQIJK", (*p, *r)))
             for p, r in zip(to, q)]
    text = ("G43.5\nG1 F120 Z-75 I-0.004 J-0.0002 K0.999992\nG6.3 L3 " +
            "\n".join("P0 " + w for w in words) + "\nP1\nP1\nP1\nM2\n")
    tip, _ = walked(tmp_path, text, ini, range(3, 9))
    c = NURBS.Curve(normalize_kv=False)
    c.degree, c.ctrlpts = 2, [list(map(float, p)) for p in to]
    c.knotvector = [0, 0, 0, 1, 1, 1]
    true = np.array(c.evaluate_list(list(np.linspace(0, 1, 4000))))
    off = [np.linalg.norm(true - p, axis=1).min() for p in tip[::41]]
    assert max(off) * 1e3 < OFF_UM + 20 - UM



def test_knots_far_from_0_are_as_fine(tmp_path):
    """Uneven weights: most of the way lies in a small part of the span."""
    def text(first, last):
        at = [f"X{x} Y{y} Z-60 R{w} Q1 I{-i}" for x, y, w, i in (
            (30, 0, 1, 0), (25, 5, 40, 0.1), (20, 0, 40, 0.2), (9, 0, 0.2, 0))]
        return (BEGIN + "G43.4\nG0 X30 Y0 Z-60\nF6000\nG6.3 " +
                "\n".join(f"P{first} {a}" for a in at) + "\n" +
                4 * f"P{last}\n" + END)
    near, _ = walked(tmp_path, text("0", "1"))
    far, _ = walked(tmp_path, text("100000", "100000.000001"))
    n, m = np.linspace(0, 1, 200), len(near)
    at = [near[np.minimum((n * m).astype(int), m - 1)],
          far[np.minimum((n * len(far)).astype(int), len(far) - 1)]]
    assert np.abs(at[0] - at[1]).max() < 0.01

@pytest.mark.parametrize("off", ["0.1", "0.02", "0.005", "0.0001", "0"])
def test_from_a_pole_it_goes_in_any_direction(tmp_path, off):
    """C jumps at the pole, by however little, and turns there in place."""
    ini = INI.replace("C(0 0 -120) A(0 15 -80) X Y Z",
                      "C(0 0 -120) X Y Z B(0 0 10)").replace(
        "[axis.B]\npresent = no", "[axis.B]\nv_max_mm_s = 30")
    (tmp_path / "m.ini").write_text(ini)
    r = run("--dry-run", "--limit-s", "60", "--machine",
            tmp_path / "m.ini", text="G43.5\nF6000\nG1 X0 Y0 Z0 I0 J0 K1\n"
            f"G1 X-10 Y0 I-0.3 J{off} K1\nG1 X10 Y0 I0.3 J{off} K1\nG49\n"
            "M2\n")
    assert r.returncode == 0, r.stderr


@pytest.mark.parametrize("text, column, told", [
    ("G43.5\nF120\nG1 X1 A5\n", 7, "G43.4 for angles"),
    ("G43.5\nF120\nG1 X1 I0 J0 K0\n", 1, "a direction of length 0"),
    ("G43.5\nF120\nG1 X1 I0 J0 K-1\n", 1, "opposite"),
    ("G43.4\nF120\nG1 X1 I1 J0 K-5\n", 7, "I1 has no use"),
    ("F120\nG49\nG6.3 P0 X1\n", 1, "G43.4 or G43.5 before it"),
    ("G43.4\nF120\nG6.3 X1\n", 1, "P and a knot"),
    ("G43.4\nF120\nG6.3 P0 X300\nP0 X1\nP0 Y1\nP0 Z1\nP1\nP1\nP1\nP1\n", None,
     "begins elsewhere than where it is: X0.0000 Y0.0000"),
    ("G43.4\nF120\nG6.3 P0 Q1\nP0 X1\nP0 Y1\nG1 X1\n", None, "P alone"),
    ("G43.4\nF120\nG6.3 L11 P0\n", 6, "an order of 2 to 10"),
    ("G43.4\nF120\nG6.3 P0 Q1\nP0 X1\n", None, "does not end"),
])
def test_what_is_no_pose_is_refused_with_its_place(tmp_path, text, column,
                                                   told):
    (tmp_path / "m.ini").write_text(INI)
    r = run("--dry-run", "--machine", tmp_path / "m.ini", text=text)
    err = r.stderr.decode()
    assert r.returncode == 65 and told in err, err
    if column:
        assert f":3:{column}: error" in err, err


@pytest.mark.parametrize("text", [
    "G43.4\nF120\nG6.3 L2 P0 Q1\nP0 X1 Q0\nP0.5 X2 I1\nP1\nP1\n",
    "G43.5\nF120\nG1 X1 I1 K1\n",
])
def test_what_the_rotaries_cannot_follow_is_refused(tmp_path, text):
    (tmp_path / "m.ini").write_text(
        INI.replace("C(0 0 -120) ", "") if "G1" in text else INI)
    r = run("--dry-run", "--machine", tmp_path / "m.ini", text=text)
    assert r.returncode == 65 and b"cannot point its tool" in r.stderr, \
        r.stderr
