# SPDX-License-Identifier: Apache-2.0
"""G43.4: the tip follows its lines, whatever the axes do.

The kinematics here are written anew, with 4 x 4 matrices.
"""

import math
import re

import numpy as np
import pytest
from edmsim import AXES, ROOT, places, pulses, report, run

EXAMPLES = ROOT / "examples"
INI = (EXAMPLES / "five-axis.ini").read_text()
NGC = (EXAMPLES / "five-axis.ngc").read_text()
TIP = np.array([0, 0, -75.0, 1])


def shift(v):
    m = np.eye(4)
    m[:3, 3] = v
    return m


def turn(axis, deg, at):
    c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    m = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)]["ABC".index(axis)]
    m[i, i] = m[j, j] = c
    m[i, j], m[j, i] = -s, s
    return shift(at) @ m @ shift(-np.array(at))


def tip(x, y, z, a, c):
    m = turn("C", c, [0, 0, -120]) @ turn("A", a, [0, 15, -80])
    return (m @ shift([x, y, z]) @ TIP)[:3]


def tips(rows):
    """The line and the tip of each row; every tenth point will do."""
    return [
        (r[0], tip(*(r[1 + AXES.index(a)] / 1e3 for a in "XYZAC")))
        for i, r in enumerate(rows)
        if i % 10 == 0 or rows[i + 1 : i + 2] and rows[i + 1][0] != r[0]
    ]


def off_line(p, a, b):
    d = b - a
    n = d @ d
    t = min(1, max(0, (p - a) @ d / n)) if n > 0 else 0
    return np.linalg.norm(p - a - t * d)


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("five")
    out = {}
    for um in (1, 100):
        ini = folder / f"{um}.ini"
        ini.write_text(INI.replace("tolerance_um = 1", f"tolerance_um = {um}"))
        out[um] = tips(
            pulses("--dry-run", "--machine", ini, text=NGC)
        )
    return out


# A pulse of each axis, half of it off: 0.5 um thrice, and 0.0005 degrees at
# up to 200 mm from the axis.
PULSES_UM = 0.5 * 3**0.5 + 2 * 200e3 * math.radians(0.0005)

LINES = [l for l in NGC.splitlines()]


def ends():
    """The tip's programmed places under G1, by line number."""
    at, out = {}, {}
    on = False
    for n, line in enumerate(LINES, 1):
        on = (on or "G43.4" in line) and "G49" not in line
        words = dict(re.findall(r"([XYZ])(-?[\d.]+)", line))
        if on and words or on and "G1" in line:
            before = dict(at)
            at.update({k: float(v) for k, v in words.items()})
            if "G1" in line:
                out[n] = tuple(
                    np.array([d[k] for k in "XYZ"]) for d in (before, at)
                )
    return out


@pytest.mark.parametrize("um", [1, 100])
def test_the_tip_keeps_to_its_programmed_lines(walked, um):
    want = ends()
    assert len(want) == 4
    most = 0
    for line, p in walked[um]:
        if line in want:
            most = max(most, 1e3 * off_line(p, *want[line]))
    assert most <= um + PULSES_UM, most


def test_a_wide_tolerance_is_used(walked):
    want = ends()
    most = max(1e3 * off_line(p, *want[l]) for l, p in walked[100]
               if l in want)
    assert most > 20, most


def test_the_tip_ends_where_it_was_sent(walked):
    last = {l: p for l, p in walked[1]}
    for line, (_, end) in ends().items():
        assert np.linalg.norm(last[line] - end) * 1e3 < PULSES_UM


def test_f_is_the_speed_of_the_tip(tmp_path):
    ini = tmp_path / "m.ini"
    ini.write_text(INI)
    text = "G90 F60\nG43.4\nG1 X20 Y0 Z-75 A0 C0\nG1 X-20 A10 C25\nM30\n"
    still = "G90 F60\nG43.4\nG1 X20 Y0 Z-75 A0 C0\nM30\n"
    s = [
        report("--dry-run", "--machine", ini, text=t)["virtual_s"]
        for t in (text, still)
    ]
    assert abs(s[0] - s[1] - 40) < 0.5


def test_there_and_back_is_the_same_way(tmp_path):
    ini = tmp_path / "m.ini"
    ini.write_text(INI)
    rows = places("--dry-run", "--there-and-back", "--machine", ini, text=NGC)
    n = (len(rows) - 1) // 3
    assert rows[: n + 1] == rows[n : 2 * n + 1][::-1] == rows[2 * n :]


def test_whole_turns_are_seen(tmp_path):
    """Eight turns of C: looked at in eighths, the axes seem to stand."""
    ini = tmp_path / "m.ini"
    ini.write_text(INI.replace("tolerance_um = 1", "tolerance_um = 100")
                   .replace("[axis.C]", "[axis.C]\npulse_mm = 0.05"))
    text = "F3600\nG43.4\nG1 X2 Y0 Z-75 A0 C0\nG1 C2880.\nM30\n"
    rows = [(*r[:6], 50 * r[6])
            for r in pulses("--dry-run", "--machine", ini, text=text)]
    want = np.array([2, 0, -75])
    most = max(np.linalg.norm(p - want) for l, p in tips(rows) if l == 4)
    assert 1e3 * most <= 100 + PULSES_UM, most


def test_an_axis_of_no_joint_goes_at_f(tmp_path):
    ini = tmp_path / "m.ini"
    ini.write_text(INI.replace("[axis.U]\npresent = no\n", ""))
    r = report("--dry-run", "--machine", ini,
               text="F60\nG43.4\nG1 U5\nG49\nM30\n")
    assert r["outcome"] == "done"
    assert abs(r["virtual_s"] - 5) < 0.5


REFUSED = [
    ("G43.4", "", "kinematics.chain in the machine file"),
    ("G43.4 H7", INI, "not defined"),
    ("G43.4\nG28 Z0", INI, "G28 under G43.4"),
    ("G43.4\nG92 X0", INI, "G92 under G43.4"),
    ("G43.4\nG53 G0 X0", INI, "G53 under G43.4"),
    ("H1=0.1\nG43.4\nG41 H1", INI, "under G43.4"),
    ("G43.4\nG0 Z150", INI, "Z"),
]


@pytest.mark.parametrize("text, ini, why", REFUSED)
def test_what_it_cannot_do_is_refused_with_its_place(tmp_path, text, ini, why):
    path = tmp_path / "m.ini"
    path.write_text(ini)
    p = run("--check", "--machine", path, text=text + "\nM30\n")
    assert p.returncode == 65
    line = text.count("\n") + 1
    assert re.search(rf":{line}:\d+: error: ", p.stderr.decode()), p.stderr
    assert why in p.stderr.decode()


@pytest.mark.parametrize("chain, why", [
    ("C A X Y", "2 linear axes"),
    ("C A B X Y Z", "a third rotary"),
    ("B X Y Z", "an axis B, the machine has not"),
    ("C(1 2) X Y Z", "three numbers"),
])
def test_a_chain_that_is_none_is_refused_with_its_line(tmp_path, chain, why):
    ini = tmp_path / "m.ini"
    ini.write_text(re.sub("chain = .*", f"chain = {chain}", INI))
    p = run("--check", "--machine", ini, text="M30\n")
    assert p.returncode == 78
    n = next(i for i, l in enumerate(INI.splitlines(), 1) if "chain" in l)
    assert f":{n}:" in p.stderr.decode() and why in p.stderr.decode(), p.stderr


def last_z(text):
    """Of the machine, in mm, where the program ends."""
    r = pulses("--dry-run", "--machine", EXAMPLES / "five-axis.ini",
               text="G21 G90 F600\n" + text + "M2\n")
    return r[-1][1 + AXES.index("Z")] / 1e3


TO = "G1 X5. Y5. Z-70.\n"


@pytest.mark.parametrize("text, z", [
    ("G43.4\n" + TO, 5), ("H1=10.\nG43.4 H1\n" + TO, 15),
    ("H1=10.\nG43.4 H1\n" + TO + "G43.4\nG1 X6.\n", 15),
    ("H1=10.\nG43.4 H1\n" + TO + "G43.5\nG1 X6. I0. J0. K1.\n", 15),
    ("H1=10.\nG43.4 H1\n" + TO + "H1=12.\nG1 X6. Z-70.\n", 17),
    ("H1=10.\nG43.4 H1\n" + TO + "G49\nG43.4\nG1 X6. Z-70.\n", 5),
    ("H1=10.\nH2=1.\nG43.4 H1\n" + TO + "G43.4 H2\nG1 X6. Z-70.\n", 6),
])
def test_a_tool_keeps_its_length(text, z):
    assert last_z(text) == pytest.approx(z, abs=1e-3)


@pytest.mark.parametrize("text, column, found", [
    ("H1=10.\nH1\nG43.4\n", 1, "G43.4 without H, after an H on a line"),
    ("H1=10.\nG43.4 D1\n", 7, "D with G43.4"),
    ("H1=10.\nG43.4 H1\nH1\n", 1, "H1 under G43.4"),
])
def test_a_length_that_would_not_count_is_refused(text, column, found):
    r = run("--check", "--machine", EXAMPLES / "five-axis.ini", text=text)
    line = len(text.splitlines())
    assert f":{line}:{column}: error: {found}".encode() in r.stderr
