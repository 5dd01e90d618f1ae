# SPDX-License-Identifier: Apache-2.0
"""Figures that are turned, mirrored and scaled, against the same program
without, moved by hand: lines, arcs, helices, curves, offsets and tapers."""
import math

import numpy as np
import pytest

from edmsim import STRATEGIES, machine_text, places, pulses, run, seeded

WORK = "[work.G54]\nx = 3.125\ny = -1.5\n"
WORK_MM = np.array([3.125, -1.5])
PULSE_MM = 0.001


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    ini = tmp_path_factory.mktemp("figures") / "m.ini"
    ini.write_text(machine_text(more=WORK))
    ini.with_name("guides.ini").write_text(
        machine_text(guides="absolute", more=WORK))
    return ini


class Figure:
    """Where its places are, and the words for it."""

    def __init__(self):
        self.linear, self.shift = np.eye(2), np.zeros(2)
        self.z = self.z_shift = None
        self.on, self.off = [], []

    def then(self, linear, shift):
        self.linear, self.shift = linear @ self.linear, linear @ self.shift + shift

    def mirror(self, axes, at):
        for i in axes:
            d, t = np.eye(2), np.zeros(2)
            d[i, i], t[i] = -1, 2 * at[i]
            self.then(d, t)
        self.on.append("G51.1 " + " ".join(f"{'XY'[i]}{at[i]:.3f}" for i in axes))
        self.off.append("G50.1 " + " ".join(f"{'XY'[i]}0." for i in axes))

    def scale(self, by, at):
        self.then(by * np.eye(2), (1 - by) * np.array(at))
        self.z = by
        self.on.append(f"G51 X{at[0]:.3f} Y{at[1]:.3f} Z0. P{round(1000 * by)}")
        self.off.append("G50")

    def turn(self, deg, at):
        c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
        r = np.array([[c, -s], [s, c]])
        # The centre is scaled, too, where there is a scale.
        about = at if self.z is None else self.z * np.array(at) + self.scale_adds
        self.then(r, about - r @ about)
        self.on.append(f"G68 X{at[0]:.3f} Y{at[1]:.3f} R{deg:.3f}")
        self.off.append("G69")

    def places(self, xy):
        return xy @ self.linear.T + self.shift


def body(rng, curves):
    """Lines of a program, each of which names X and Y."""
    x, y, z = (rng.uniform(-1, 1) for _ in range(3))
    lines = [f"G0 X{x:.3f} Y{y:.3f} Z{z:.3f}"]
    for _ in range(rng.randint(3, 7)):
        u, v = round(rng.uniform(-1.5, 1.5), 3), round(rng.uniform(-1.5, 1.5), 3)
        kind = rng.choice(["line", "arc", "radius", "curve" if curves else "line"])
        if kind == "line":
            lines.append(f"G1 X{u} Y{v} Z{rng.uniform(-1, 1):.3f}")
        elif kind == "curve":
            i, j, p, q = (rng.uniform(-2, 2) for _ in range(4))
            lines.append(f"G5 X{u} Y{v} I{i:.3f} J{j:.3f} P{p:.3f} Q{q:.3f}")
        elif kind == "radius":
            r = math.hypot(u - x, v - y) * rng.uniform(0.51, 2)
            lines.append(f"G{rng.choice([2, 3])} X{u} Y{v} R{r + 0.01:.3f}")
        else:
            # A centre on the line square to the middle of the chord.
            k = rng.uniform(-2, 2)
            i, j = (u - x) / 2 - k * (v - y), (v - y) / 2 + k * (u - x)
            lines.append(f"G{rng.choice([2, 3])} X{u} Y{v} I{i:.6f} J{j:.6f}")
        x, y = u, v
    return [line.replace("-0.000", "0.000") for line in lines]


def xy_of(rows):
    return np.array([r[:2] for r in rows]) * PULSE_MM


def cells(xy):
    return np.round(xy / PULSE_MM).astype(np.int64) @ np.array([1 << 32, 1])


def assert_same_way(is_, wanted, by=1):
    """No place of one way is far from the other: both are rounded to pulses, one
    of them on the lattice that was turned and scaled by @by."""
    near = math.ceil(2 * (1 + by))
    around = [(x << 32) + y for x in range(-near, near + 1)
              for y in range(-near, near + 1)]
    for a, b in ((is_, wanted), (wanted, is_)):
        left, there = cells(a), np.unique(cells(b))
        for step in around:
            left = left[~np.isin(left + step, there)]
        assert not len(left), (len(left), len(a))
    assert np.abs(is_[-1] - wanted[-1]).max() <= near * PULSE_MM


def both(machine, dialect, on, lines, *args):
    """The places without the figure and with it, from where the first of
    @lines ends."""
    ret = []
    for words in ([], on):
        head = ["G21 G90 F60"] + words
        rows = pulses("--machine", machine, "--dialect", dialect, "--dry-run",
                      *args, text="\n".join(head + lines) + "\n")
        n = sum(line <= len(head) + 1 for line, *_ in rows)
        ret.append([place for _, *place in rows[n - 1:]])
    return ret


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_any_figure_is_the_plain_one_moved(machine, strategy):
    rng = seeded()
    for _ in range(20):
        f = Figure()
        at = [round(rng.uniform(-2, 2), 3) for _ in range(2)]
        if rng.random() < 0.5:
            f.mirror(rng.choice([[0], [1], [0, 1]]), at)
        if rng.random() < 0.3:
            by = rng.choice([0.5, 1.005, 2, 1.337])
            f.scale(by, at[::-1])
            f.scale_adds = (1 - by) * np.array(at[::-1])
        if rng.random() < 0.7 or not f.on:
            f.turn(rng.choice([90, 180, -90, 30, 271.5, rng.uniform(-360, 360)]),
                   [round(rng.uniform(-2, 2), 3) for _ in range(2)])
        lines = body(rng, curves=False)
        plain, moved = both(machine, "fanuc-sinker", f.on, lines,
                            "--strategy", strategy)
        print("\n".join(f.on + lines))
        wanted = WORK_MM + f.places(xy_of(plain) - WORK_MM)
        assert_same_way(xy_of(moved), wanted, f.z or 1)
        assert abs(moved[-1][2] - (f.z or 1) * plain[-1][2]) < 3


def test_a_wire_beside_its_contour_and_leaning_is_moved_with_it(machine):
    """Offset and taper are the program's: in a mirror image they change their
    sides, and a scale leaves them alone."""
    rng, guides = seeded(), machine.with_name("guides.ini")
    contour = ["G0 X0 Y-4", "G42 D1 {side} A{deg} G1 X0 Y0", "X5 Y0",
               "G3 X9 Y4 I0 J4", "G1 X9 Y10", "G2 X4 Y15 I0 J5",
               "G1 X-2 Y15", "G40 G50 X-2 Y19"]
    for _ in range(8):
        f = Figure()
        if rng.random() < 0.6:
            f.mirror(rng.choice([[0], [1], [0, 1]]), [0.5, -0.25])
        f.turn(rng.choice([90, -35.5, rng.uniform(-180, 180)]), [1, 0.5])
        lines = [line.format(side=rng.choice(["G51", "G52"]), deg=rng.choice([0, 0.5]))
                 for line in contour]
        plain, moved = both(guides, "generic", f.on, lines)
        print("\n".join(f.on + lines))
        wanted = WORK_MM + f.places(xy_of(plain) - WORK_MM)
        assert_same_way(xy_of(moved), wanted)
        top = WORK_MM + f.places(
            np.array([r[6:8] for r in plain]) * PULSE_MM - WORK_MM)
        assert_same_way(np.array([r[6:8] for r in moved]) * PULSE_MM, top)


def test_a_curve_is_moved_by_its_points(machine):
    rng = seeded()
    for _ in range(10):
        f = Figure()
        f.mirror([rng.randrange(2)], [0.3, 0.7])
        f.turn(rng.uniform(-180, 180), [1, -1])
        lines = body(rng, curves=True)
        plain, moved = both(machine, "generic", f.on, lines)
        wanted = WORK_MM + f.places(xy_of(plain) - WORK_MM)
        assert_same_way(xy_of(moved), wanted)


def ends(machine, dialect, text):
    """Where it is at the end, less the work offset, in mm."""
    rows = places("--machine", machine, "--dialect", dialect, "--dry-run",
                  text=text)
    return np.round(np.array(rows[-1][:2]) * PULSE_MM - WORK_MM, 3).tolist()


# By hand, from what each word says.
@pytest.mark.parametrize("dialect, text, at", [
    # A mirror image for each axis, and both.
    ("sodick-wire", "G90 G00 X0 Y0;\nG05;\nG01 X3.0 Y1.0;\nM02;\n", [-3, 1]),
    ("sodick-wire", "G90 G00 X0 Y0;\nG05;\nG06;\nG01 X3.0 Y1.0;\nM02;\n", [-3, -1]),
    ("sodick-wire", "G90 G00 X1.0 Y1.0;\nG06;\nG91;\nG01 X3.0 Y1.0;\nM02;\n", [4, 0]),
    ("sodick-wire", "G90 G00 X0 Y0;\nG08;\nG01 X3.0 Y1.0;\nM02;\n", [1, 3]),
    ("sodick-wire", "G90 G00 X0 Y0;\nG05;\nG09;\nG01 X3.0 Y1.0;\nM02;\n", [3, 1]),
    ("sodick-wire", "G90 G00 X0 Y0;\nG26 RA90.0 RI1.0 RJ0;\nG01 X3.0 Y0;\nM02;\n",
     [1, 2]),
    ("sodick-sinker", "G90 G00 X0 Y0;\nG26 RA-90.0;\nG01 X3.0 Y1.0;\nM02;\n",
     [1, -3]),
    # A turn about where the machine stands goes on from there by distances.
    ("fanuc-wire", "G90 G00 X1. Y2.\nG68 R90.\nG91 G01 X3. F5.\nM02\n", [1, 5]),
    # One turn takes the place of the other.
    ("fanuc-wire", "G90 G00 X0 Y0\nG68 X0 Y0 R90.\nG68 X0 Y0 R180.\n"
     "G01 X3. Y1. F5.\nM02\n", [-3, -1]),
    # The centre is a place of the scaled program, and an offset none of it.
    ("fanuc-sinker", "G90 G00 X0 Y0\nG51 X0 Y0 P2000\nG68 X1. Y0 R90.\n"
     "G01 X2. Y0 F5.\nM02\n", [2, 2]),
    ("fanuc-sinker", "G20 G90 G00 X0 Y0\nG51 X1. Y0 P500\nG01 X3. Y1. F5.\nM02\n",
     [50.8, 12.7]),
    # A variable reads what the program says, not where that is.
    ("fanuc-sinker", "G90 G00 X0 Y0\nG51 X0 Y0 P2000\nG51.1\n", None),
    ("fanuc-sinker", "G90 G00 X2. Y1.\nG51 X0 Y0 P2000\nG68 X0 Y0 R90.\n"
     "G01 X2. Y1. F5.\nG01 X[#5001 + 1.] Y#5002\nM02\n", [-2, 6]),
])
def test_what_the_words_say(machine, dialect, text, at):
    if at is None:
        assert run("--machine", machine, "--dialect", dialect, "--check",
                   text=text).returncode == 65
    else:
        assert ends(machine, dialect, text) == at


@pytest.mark.parametrize("dialect, text, wanted", [
    ("fanuc-wire", "G90 G00 X1. Y0\nG68 X0 Y0 R45.\nG01 X3. F5.\n",
     "3:5: error: X3. alone behind a change of the figure's turn"),
    ("fanuc-wire", "G90 G00 X1. Y0\nG68 X0 Y0\n", "2:1: error: G68 without an angle"),
    ("fanuc-wire", "G90 G00 X1. Y0\nG68 X0 R45.\n", "half a centre"),
    ("fanuc-wire", "G91 G00 X1. Y0\nG68 X0 Y0 R45.\n", "G68 under G91"),
    ("fanuc-wire", "G00 X0 Y0\nG41 D1\nG01 X1. Y0 F5.\nG68 X0 Y0 R45.\n",
     "4:1: error: G68 under an offset or a taper; G40 and G50 before it"),
    ("fanuc-wire", "G68 X0 Y0 R45.\nG92 X0 Y0\n",
     "2:1: error: G92 in a figure that is turned"),
    ("fanuc-sinker", "G51 X0 Y0 P2.5\n", "a factor with a decimal point"),
    ("fanuc-sinker", "G51 X0 Y0 P0\n", "a factor of 0"),
    ("fanuc-sinker", "G51.1 Z0\n", "G51.1 with Z; X and Y"),
    ("fanuc-sinker", "G68 X0 Y0 R30. G01 X1. F5.\n", "a second word X1."),
    ("fanuc-sinker", "G68 X0 Y0 R30. G01 F5.\n", "a line of its own"),
    ("fanuc-sinker", "G18 G68 X0 Y0 R30.\nG02 X1. Y0 Z1. R2. F5.\n",
     "an arc beside the plane X Y"),
    ("sodick-wire", "G05;\nG08;\n", "2:1: error: G08 beside a mirror image"),
    ("sodick-wire", "G26 RX1.0 RY1.0;\n", "RX1.0 is not a word with a number"),
    ("linuxcnc", "G68 X0 Y0 R30\n", "no words of LinuxCNC"),
])
def test_refused(machine, dialect, text, wanted):
    r = run("--machine", machine, "--dialect", dialect, "--check", text=text)
    assert r.returncode == 65
    assert wanted in r.stderr.decode(), r.stderr.decode()


def test_there_and_back_is_one_way(machine):
    text = ("G21 G90 F60\nG51.1 X0.5\nG68 X1 Y1 R33.3\nG0 X0 Y0\nG1 X2 Y1\n"
            "G2 X1 Y-1 R2\nG69\nG50.1\nG0 X0 Y0\n")
    rows = places("--machine", machine, "--dry-run", "--there-and-back", text=text)
    n = (len(rows) - 1) // 3
    assert rows[:n + 1] == rows[n:2 * n + 1][::-1] == rows[2 * n:]
