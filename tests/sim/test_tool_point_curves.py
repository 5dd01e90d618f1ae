# SPDX-License-Identifier: Apache-2.0
"""G43.4: the tip follows curves and arcs, the rotaries go with it.

The curve is geomdl's, the machine's joints are written anew.
"""

import math
import re

import numpy as np
import pytest
from edmsim import AXES, ROOT, places, pulses, report, run
from geomdl import NURBS

INI = (ROOT / "examples/five-axis.ini").read_text()
SAMPLES = 8000      # chords of some 10 um: less than 0.01 um off the curve

# Half a pulse of each axis off: 0.5 um thrice, and 0.0005 degrees of two
# rotaries at up to 200 mm from them.
PULSES_UM = 0.5 * 3**0.5 + 2 * 200e3 * math.radians(0.0005)

POINTS = [  # knot, X Y Z A C, weight
    (0, (30, 0, -60, 20, 0), 1),
    (0, (20, 20, -58, 30, 20), 2),
    (0, (0, -10, -64, 45, 70), 1),
    (0, (-10, 15, -62, 40, 100), 0.5),
    (0.3, (-25, 5, -60, 20, 90), 1),
    (0.7, (-30, 0, -60, 0, 90), 1),
]
KNOTS = [k for k, _, _ in POINTS] + [1] * 4


def place(*p):
    """Its words; with a point, for C100 would be a condition."""
    return " ".join(f"{a}{float(x)}" for a, x in zip("XYZAC", p))


BEGIN = "G90\nG0 Z20\nG43.4\nG0 X30 Y0 Z-60 A20 C0\nF120\n"
FIRST = BEGIN.count("\n") + 1
CURVE = "G6.2 P4 " + "\n".join(
    f"K{k} " + place(*p) + f" R{w}"
    for k, p, w in POINTS) + "\nK1" * 4 + "\n"
END = "G49\nG0 Z40\nM30\n"


def true_curve():
    c = NURBS.Curve(normalize_kv=False)
    c.degree = 3
    c.ctrlptsw = [[x * w for x in p] + [w] for _, p, w in POINTS]
    c.knotvector = KNOTS
    return np.array(c.evaluate_list(list(np.linspace(0, 1, SAMPLES))))


def helix(n=SAMPLES):
    """From X-30 Y0 Z-60 A0 C90, about X-20 Y0, left round to X-20 Y-10."""
    t = np.linspace(0, 1, n)
    at = math.pi * (1 + t / 2)
    return np.stack([-20 + 10 * np.cos(at), 10 * np.sin(at), -60 - 2 * t,
                     15 * t, 90 - 50 * t], axis=1)


def poses(rows):
    """The tip and A C of rows of pulses, all at once."""
    x, y, z, a, c = (np.array([r[1 + AXES.index(n)] for r in rows]) / 1e3
                     for n in "XYZAC")
    ca, sa = np.cos(np.radians(a)), np.sin(np.radians(a))
    cc, sc = np.cos(np.radians(c)), np.sin(np.radians(c))
    y, z = y - 15, z - 75 + 80
    y, z = ca * y - sa * z + 15, sa * y + ca * z - 80
    return np.stack([cc * x - sc * y, sc * x + cc * y, z, a, c], axis=1)


def beside(p, way):
    """How far each pose is from the way, whose samples it passes in turn: in
    um, and the rotaries' from theirs at the nearest place, in 0.001 deg."""
    step = np.diff(way, axis=0)
    n2 = (step[:, :3]**2).sum(1)
    off, turn, at = [], [], 0
    for chunk in np.array_split(p, len(p) // 100):
        lo, hi = max(0, at - 60), at + 200
        d = chunk[:, None, :3] - way[None, lo:hi, :3][:, :len(n2) - lo]
        s = step[lo:hi]
        t = np.clip((d * s[:, :3]).sum(2) / n2[lo:hi], 0, 1)
        all_off = np.linalg.norm(d - t[..., None] * s[:, :3], axis=2)
        j = all_off.argmin(1)
        i = np.arange(len(j))
        there = way[lo + j, 3:] + t[i, j][:, None] * s[j, 3:]
        off.append(all_off[i, j])
        turn.append(np.abs(chunk[:, 3:] - there).max(1))
        at = lo + j[-1]
    assert at >= SAMPLES - 20
    return 1e3 * np.concatenate(off), 1e3 * np.concatenate(turn)


def steepest(way):
    """The most a rotary turns, degrees per mm of the tip."""
    step = np.diff(way, axis=0)
    return (np.abs(step[:, 3:]).max(1) /
            np.linalg.norm(step[:, :3], axis=1)).max()


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    folder = tmp_path_factory.mktemp("five")

    def make(um):
        ini = folder / f"{um}.ini"
        ini.write_text(INI.replace("tolerance_um = 1", f"tolerance_um = {um}"))
        return ini

    return make


HELIX = "G3 X-20. Y-10. Z-62. A15. C40. I10. J0\n"
WAYS = {
    "curve": (CURVE, true_curve),
    "helix": ("G0 X-30. Y0 Z-60. A0 C90.\n" + HELIX, helix),
}


def walked(machine, um, name):
    text, way = WAYS[name]
    rows = pulses("--dry-run", "--machine", machine(um),
                  text=BEGIN + text + END)
    first = FIRST + (name == "helix")
    last = FIRST + text.count("\n") - 1
    on = [r for r in rows if first <= r[0] <= last]
    assert len(on) > 10000
    return poses(on), way()


@pytest.mark.parametrize("name", WAYS)
@pytest.mark.parametrize("um", [0.2, 1, 100])
def test_the_tip_keeps_to_its_true_way_at_every_lattice_point(machine, um,
                                                              name):
    p, way = walked(machine, um, name)
    off, turn = beside(p, way)
    bound = um + PULSES_UM
    assert off.max() <= bound, off.max()
    # The nearest place may be beside the one meant by what the tip is off.
    assert turn.max() <= um + 1 + 2 * steepest(way) * bound, turn.max()
    if um == 100:
        assert off.max() > 20, off.max()


def test_the_lines_told_are_those_of_the_control_points(machine):
    rows = pulses("--dry-run", "--machine", machine(1),
                  text=BEGIN + CURVE + END)
    lines = {r[0] for r in rows if FIRST <= r[0] < FIRST + 10}
    assert lines == {FIRST, FIRST + 1, FIRST + 3}


def test_there_and_back_is_the_same_way(machine):
    rows = places("--dry-run", "--there-and-back", "--machine", machine(1),
                  text=BEGIN + CURVE + HELIX + END)
    n = (len(rows) - 1) // 3
    assert rows[: n + 1] == rows[n : 2 * n + 1][::-1] == rows[2 * n :]


@pytest.mark.parametrize("name", WAYS)
def test_f_is_the_speed_of_the_tip(machine, name):
    text, way = WAYS[name]
    text = BEGIN.replace("F120", "F20") + text
    s = [report("--dry-run", "--machine", machine(1), text=t + "M30\n")
         ["virtual_s"]
         for t in (text, "\n".join(text.splitlines()[:FIRST - 1 +
                                   (name == "helix")]) + "\n")]
    tip_mm = np.linalg.norm(np.diff(way()[:, :3], axis=0), axis=1).sum()
    assert abs(s[0] - s[1] - 3 * tip_mm) < 0.03 * 3 * tip_mm


def test_a_full_circle_is_one_wherever_the_axes_left_the_tip(machine):
    """The tip stands at 30 + rounding, the program says 30."""
    text = ("G90 F600\nG0 X31.2 A20.3 C30.7\nG43.4\nG91\nG3 I-5. J0\n"
            "G90\nG0 X30 Y0 Z-60 A20.3 C30.7\nG3 X30 Y0 I-5. J0\nM30\n")
    rows = pulses("--dry-run", "--machine", machine(1), text=text)
    for line, centre in (5, None), (8, (25, 0)):
        p = poses([r for r in rows if r[0] == line])
        if centre is None:
            centre = p[0, :2] - (5, 0)
        far = np.linalg.norm(p[:, :2] - centre, axis=1)
        assert len(p) > 10000
        assert np.abs(far - 5).max() * 1e3 < 1 + 2 * PULSES_UM


def test_rotaries_keep_to_their_curve_where_the_tip_stands(machine):
    """C by u, A by u squared: not a straight line from end to end."""
    text = ("F600\nG43.4\nG0 X20. Y0 Z-70. A0 C0\nG6.2 P3 K0 A0 C0\n"
            "K0 A0 C45.\nK0 A40. C90.\nK1\nK1\nK1\nM30\n")
    rows = pulses("--dry-run", "--machine", machine(1), text=text)
    p = poses([r for r in rows if r[0] == 4])
    still = np.linalg.norm(p[:, :3] - (20, 0, -70), axis=1)
    assert still.max() * 1e3 <= 1 + PULSES_UM
    a = 40 * (p[:, 4] / 90) ** 2
    assert np.abs(p[:, 3] - a).max() < 0.001 + 0.001 + 0.001
    assert p[-1, 3] > 39.99


def test_a_corner_at_a_knot_is_met(machine):
    """Degree 1: the control polygon itself, in pieces at its corners."""
    text = ("F600\nG43.4\nG0 X10. Y0 Z-60. A0 C0\nG6.2 P2 K0 X10. Y0 A0 C0\n"
            "K0 X0 Y5. A10. C10.\nK0.31 X-10. Y0 A0 C30.\nK1\nK1\nM30\n")
    rows = pulses("--dry-run", "--machine", machine(1000), text=text)
    p = poses([r for r in rows if 4 <= r[0] <= 6])
    near = np.linalg.norm(p[:, :3] - (0, 5, -60), axis=1).min()
    assert near * 1e3 < PULSES_UM


def test_a_turn_of_a_micrometre_in_a_long_curve_is_no_reason_to_refuse(
        machine):
    """Its two last points are one, and the one before them weighs little."""
    text = BEGIN + "G6.2 P8 K0\n" + "".join(f"K0 {p}\n" for p in (
        "X-1.3019 A-53.9419 R1.41727", "X17.0478 Y24.8621 Z14.0876 A-77.5243",
        "Y-10.2921 Z-77.2719 A-13.7342",
        "X-26.7545 Y32. Z-7.2691 A-59.7653 R2.90228",
        "X19.1473 Y-11.6875 A49.4735 C102.0607",
        "X15.3057 Y17.0542 Z1.5564 C-333.8073 R0.02637",
        "Z-77.3391 A31.266 C-177.3512",
    )) + "K0.446872 R1\n" + "K1\n" * 8
    r = report("--dry-run", "--machine", machine(0.01),
               text=text + END)
    assert r["outcome"] == "done"


@pytest.mark.parametrize("curve, end", [
    ("G5 X20. Y10. I5. J5. P-5. Q5.\nG5 X0 Y20. P0 Q-5.", (0, 20)),
    ("G5.1 X10. Y10. I5. J15.", (10, 10)),
    ("G5.2 X20. Y20. P2 L3\nX0 Y30.\nG5.3", (0, 30)),
    ("G18\nG2 X20. Z-60. R5.", (20, 0)),
    ("G2 X20. Y0 R-8.", (20, 0)),
])
def test_every_curve_and_arc_ends_where_it_says(machine, curve, end):
    text = f"F600\nG43.4\nG0 X30. Y0 Z-60. A20. C-20.\n{curve}\n"
    rows = pulses("--dry-run", "--machine", machine(1), text=text + "M30\n")
    last = poses(rows)[-1]
    assert np.linalg.norm(last[:3] - (*end, -60)) * 1e3 < PULSES_UM
    assert abs(last[3] - 20) < 0.001 and abs(last[4] + 20) < 0.001


REFUSED = [
    ("G6.2 P2 K0 X5. Y5.\nK0 X9.\nK1\nK1", 3, "a curve that begins at X 5"),
    ("G6.2 P2 K0 R1\nK0 X90. R0.00001\nK1\nK1", 4, "weight"),
    ("G6.2 P3 K0\nK1 X5.\nK2 X9.\nK3\nK4\nK5", 3, "begins at X"),
    ("G6.2 P2 K0 X0 Y0\nK0 X9000.\nK1\nK1", 3, "travel"),
    ("G2 X9. Y0 I4. J0", 3, "from its centre"),
    ("G3 X0 Y0 I900. J0", 3, "travel"),
]


@pytest.mark.parametrize("text, line, why", REFUSED)
def test_what_it_cannot_do_is_refused_with_its_place(machine, text, line, why):
    p = run("--check", "--machine", machine(1),
            text=f"F600\nG43.4\n{text}\nM30\n")
    said = p.stderr.decode()
    assert p.returncode == 65, said
    assert re.search(rf":{line}:(\d+:)? error: ", said), said
    assert why in said


def test_a_pose_out_of_reach_is_refused_in_the_line_that_leads_there(tmp_path):
    """With C between X and Y, both go one way at C90."""
    ini = tmp_path / "m.ini"
    ini.write_text(re.sub("chain = .*", "chain = X C(0 0 -120) Y Z", INI))
    p = run("--check", "--machine", ini,
            text="F600\nG43.4\nG0 X0 Y0 Z-60. C0\nG6.2 P2 K0 C0\nK0 C45.\n"
                 "K1 Y0 C90.\nK2\nK2\nM30\n")
    said = p.stderr.decode()
    assert p.returncode == 65 and ":5:" in said, said
    assert "a pose that the linear axes cannot reach; rotaries at" in said


def test_too_many_pieces_are_refused_with_the_remedy(machine):
    p = run("--check", "--machine", machine(0.001),
            text="F600\nG43.4\nG0 X90. Y0 Z-75. A0 C0\n"
                 "G3 X90. Y0 I-90. J0 A0 C36000.\nM30\n")
    said = p.stderr.decode()
    assert p.returncode == 65, said
    assert ":4:" in said and "more than 100000 pieces" in said
    assert "kinematics.tolerance_um" in said


TURNS_BACK = {
    "and tilts": "X20 Y2 Z-60 Q1 I0.1 J0.1",
    "a little beside its way": "X20 Y2.0001 Z-60 Q1 I0.1 J0.1",
    "going down": "X30 Y0 Z-62 Q1 I0.2",
    "while the tip stands": "X30 Y0 Z-60 Q1 I0.2 J0.1",
}


@pytest.mark.parametrize("there", TURNS_BACK.values(), ids=TURNS_BACK)
def test_a_body_that_turns_back_within_one_way_ends(there):
    """Where all axes turn back, the mean of their rates is zero."""
    text = ("G90 G43.4 F4800\nG0 X30 Y0 Z-60\n"
            "G6.3 L3 P0 R1 X30 Y0 Z-60 Q1\n"
            f"P0 R1 {there}\nP0 R1 X30 Y0 Z-60 Q1\nP1\nP1\nP1\nM2\n")
    r = report("--dry-run", "--limit-s", "60", "--machine",
               ROOT / "examples/machine-five-axis.ini", text=text)
    assert r["outcome"] == "done" and r["virtual_s"] < 6
