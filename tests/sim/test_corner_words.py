# SPDX-License-Identifier: Apache-2.0
"""Corners that ,R rounds and ,C cuts: against the same corner written out, and
by what an arc between two motions is."""
import math

import numpy as np
import pytest

from edmsim import machine_text, places, run, seeded


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    ini = tmp_path_factory.mktemp("corners") / "m.ini"
    ini.write_text(machine_text())
    return ini


def emitted(machine, text, dialect="fanuc-wire"):
    r = run("--machine", machine, "--dialect", dialect, "--emit", "iso", text=text)
    assert r.returncode == 0, r.stderr.decode()
    return r.stdout.decode()


def motions(iso):
    """Lines and arcs: (start, end, centre or None, sense)."""
    at, g, ret = np.zeros(2), "G0", []
    for line in iso.splitlines():
        words = line.split()
        g = next((w for w in words if w in ("G0", "G1", "G2", "G3")), g)
        v = {w[0]: float(w[1:]) for w in words if w[0] in "XYIJ"}
        if not v:
            continue
        to = np.array([v.get("X", at[0]), v.get("Y", at[1])])
        centre = at + [v.get("I", 0), v.get("J", 0)] if g in ("G2", "G3") else None
        ret.append((at, to, centre, {"G2": -1, "G3": 1}.get(g)))
        at = to
    return ret


def way(motion, at):
    """Its direction at one of its places."""
    start, end, centre, sense = motion
    if centre is None:
        d = end - start
    else:
        r = at - centre
        d = sense * np.array([-r[1], r[0]])
    return d / np.hypot(*d)


def written_out(points, sizes):
    """A closed polygon, its corners as lines and arcs that somebody computed."""
    lines = []
    for i, (p, (kind, size)) in enumerate(zip(points[1:-1], sizes)):
        a, b = points[i] - p, points[i + 2] - p
        a, b = a / np.hypot(*a), b / np.hypot(*b)
        half = math.acos(np.clip(a @ b, -1, 1)) / 2
        off = size if kind == "C" else size / math.tan(half)
        p, q = p + off * a, p + off * b
        lines.append(f"G01 X{p[0]:.6f} Y{p[1]:.6f}")
        left = a[0] * b[1] - a[1] * b[0] < 0
        lines.append(f"G0{1 if kind == 'C' else 3 if left else 2} "
                     f"X{q[0]:.6f} Y{q[1]:.6f}" +
                     (f" R{size:.6f}" if kind == "R" else ""))
    return lines + [f"G01 X{points[-1][0]:.6f} Y{points[-1][1]:.6f}"]


@pytest.mark.parametrize("wire", [False, True])
def test_corners_of_lines_are_those_that_are_written_out(machine, wire):
    rng = seeded()
    for _ in range(25):
        n = rng.randint(4, 7)
        angles = sorted(rng.uniform(0, math.pi / n) + 2 * math.pi * i / n
                        for i in range(n))
        ring = [np.array([rng.uniform(6, 9) * math.cos(a),
                          rng.uniform(6, 9) * math.sin(a)]) for a in angles]
        start = (ring[0] + ring[-1]) / 2
        points = [np.round(p, 3) for p in (start, *ring, start)]
        sizes = [(rng.choice("RC"), round(rng.uniform(0.2, 0.5), 3)) for _ in ring]
        out = np.round(start * 1.5, 3)
        head = ["G21 G90 F60", f"G00 X{out[0]:.3f} Y{out[1]:.3f}",
                f"{'G42 D1 ' if wire else ''}G01 X{start[0]:.3f} Y{start[1]:.3f}"]
        tail = [f"G40 X{out[0]:.3f} Y{out[1]:.3f}", "M02"]
        words = [f"G01 X{p[0]:.3f} Y{p[1]:.3f} ,{kind}{size}"
                 for p, (kind, size) in zip(points[1:], sizes)]
        words.append(f"G01 X{points[-1][0]:.3f} Y{points[-1][1]:.3f}")
        ways = [np.array(places("--machine", machine, "--dialect", "fanuc-wire",
                                "--dry-run", text="\n".join(head + body + tail)))
                for body in (words, written_out(points, sizes))]
        print("\n".join(head + words + tail))
        # The lattice places may be others where a rounding decides.
        cells = [np.unique(w[:, :2] @ np.array([1 << 32, 1])) for w in ways]
        near = [(x << 32) + y for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 0, 1, 2)]
        for a, b in (cells, cells[::-1]):
            for step in near:
                a = a[~np.isin(a + step, b)]
            assert not len(a), len(a)


def test_an_arc_between_any_two_motions_touches_both(machine):
    """It has its radius, both motions lead into it, and what is left of them lies
    on what was written."""
    rng = seeded()
    rounded = 0
    for _ in range(150):
        pts = [np.array([rng.uniform(-9, 9), rng.uniform(-9, 9)]) for _ in range(3)]
        if min(np.hypot(*(pts[1] - pts[0])), np.hypot(*(pts[2] - pts[1]))) < 2:
            continue
        size = round(rng.uniform(0.1, 1), 3)
        text = [f"G21 G90 F60", f"G01 X{pts[0][0]:.3f} Y{pts[0][1]:.3f}"]
        for i, corner in ((1, f",R{size}"), (2, "")):
            kind = rng.choice(["G01", "G02", "G03"])
            r = rng.uniform(0.6, 3) * np.hypot(*(pts[i] - pts[i - 1]))
            text.append(f"{kind} X{pts[i][0]:.3f} Y{pts[i][1]:.3f} " +
                        (f"R{r:.3f} " if kind != "G01" else "") + corner)
        text.append("M02")
        print("\n".join(text))
        plain = motions(emitted(machine, "\n".join(text).replace(f",R{size}", "")))
        r = run("--machine", machine, "--dialect", "fanuc-wire", "--emit", "iso",
                text="\n".join(text))
        if r.returncode == 65:
            assert b"larger than the motions beside it" in r.stderr
            continue
        a, fill, b = motions(r.stdout.decode())[-3:]
        if np.hypot(*(fill[1] - fill[0])) < 0.05:
            continue
        rounded += 1
        assert fill[2] is not None
        for at in fill[:2]:
            assert abs(np.hypot(*(at - fill[2])) - size) < 1e-5
        assert way(a, a[1]) @ way(fill, fill[0]) > 1 - 1e-5
        assert way(fill, fill[1]) @ way(b, b[0]) > 1 - 1e-5
        for is_, was in ((a, plain[-2]), (b, plain[-1])):
            assert (is_[2] is None) == (was[2] is None)
            if was[2] is not None:
                r = np.hypot(*(was[0] - was[2]))
                for at in is_[:2]:
                    assert abs(np.hypot(*(at - was[2])) - r) < 1e-4
    assert rounded > 60


@pytest.mark.parametrize("text, wanted", [
    ("G01 X5. ,R6.\nY3.\n", "1: error: a corner that is larger than"),
    ("G01 X5. ,R1.\n", "1: error: a corner to be rounded or cut, and no line"),
    ("G01 X5. ,R1.\nG00 Y5.\n", "1: error: a corner beside a rapid motion"),
    ("G01 X5. ,R1.\nG41 D1 Y5.\nY9.\nG40 X0\n", "a corner beside a lead"),
    ("G01 X5. ,C1.\nG03 X0. Y5. R5.\n", "a corner beside an arc that is to be cut"),
    ("G01 X5. ,R1. ,C1.\nY3.\n", "two words for one corner"),
    ("G01 X5. ,R-1.\nY3.\n", "a corner below 0"),
    ("G01 X5. ,A1.\nY3.\n", ",A1., a comma in front of something else"),
    ("G01 X5. ,R1\nY3.\n", "R1 without a decimal point"),
    ("G01 X5.\nG01 ,R1.\nY3.\n", "R1., a corner, without a motion in X Y"),
    ("G01 X5.\nX5. ,R1.\nY3.\n", "a corner behind a motion that goes nowhere"),
    ("G01 X5. ,R1.\nX0.\n", "or that turns back"),
])
def test_refused(machine, text, wanted):
    text = "G21 G90 F60\n" + text + "M02\n"
    r = run("--machine", machine, "--dialect", "fanuc-wire", "--check", text=text)
    assert r.returncode == 65, r.stdout
    line = wanted.split(":")[0]
    if line.isdigit():
        wanted = f":{int(line) + 1}:1{wanted[len(line):]}"
    assert wanted in r.stderr.decode(), r.stderr.decode()


def test_r_of_a_line_is_its_corner(machine):
    lines = "G90 G01 X5.0{} Y0;\nX5.0 Y5.0;\nM02;\n"
    assert emitted(machine, lines.format(" R1.0"), "sodick-wire") == \
        emitted(machine, lines.format(" ,R1.0").replace(";", ""), "fanuc-wire")


def test_what_stands_behind_a_corner_is_done_there_and_only_once(machine):
    """A stop between the two motions of a corner comes where the first one ends."""
    text = "G21 G90 F60\nG01 X5. ,R1.\nM00\nY5.\nM02\n"
    r = run("--machine", machine, "--dialect", "fanuc-wire", "--check", text=text)
    assert r.returncode == 0
    iso = emitted(machine, text)
    assert iso.count("M0\n") == 1
    assert iso.index("M0") < iso.index("G3")


# A line is used up by its corners, at one end, at both, at the last one.
USED_UP = [
    ("G01 X5. ,R2.5\nY5. ,R2.5\nX-5.\nY0",
     "G01 X2.5\nG03 X5. Y2.5 R2.5\nG03 X2.5 Y5. R2.5\nG01 X-5.\nY0"),
    ("G01 X5. ,R5.\nY5.\nX-5.\nY0", "G03 X5. Y5. R5.\nG01 X-5.\nY0"),
    ("G01 X5. ,C5.\nY5.\nX-5. ,C5.\nY0", "G01 X5. Y5.\nG01 X0\nX-5. Y0"),
]


@pytest.mark.parametrize("wire", ["", "G41 D1 ", "G41 D1 G52 T2. "])
@pytest.mark.parametrize("words, out", USED_UP)
def test_a_line_may_be_used_up_by_its_corners(machine, tmp_path, wire, words, out):
    if "T" in wire:
        machine = tmp_path / "guides.ini"
        machine.write_text(machine_text(guides="absolute"))
    ways = [places("--machine", machine, "--dialect", "fanuc-wire", "--dry-run",
                   text=f"G21 G90 F600\nG00 X0 Y2.\n{wire}G01 X0 Y0\n{body}\n"
                        "X-1.\nG40 G50 X0 Y2.\nM02\n") for body in (words, out)]
    assert ways[0] == ways[1]


def test_a_used_up_line_has_no_other_corner(machine):
    r = run("--machine", machine, "--dialect", "fanuc-wire", "--check",
            text="G21 G90 F60\nG01 X5. ,R5.\nY5. ,R1.\nX0\nM02\n")
    assert r.returncode == 65 and b"larger than the motions beside it" in r.stderr
