# SPDX-License-Identifier: Apache-2.0
"""What edm-plan promises: proofs, plans, and refusals."""
import json
import math
import os
import random
import signal
import struct
import subprocess
from pathlib import Path

import pytest

B = Path(os.environ.get("EDM_BUILD", "build")).resolve()
TOP = Path(__file__).resolve().parents[2]


def plan(*args, cwd=None, timeout=600):
    return subprocess.run([B / "edm-plan", *map(str, args)], cwd=cwd,
                          capture_output=True, text=True, timeout=timeout)


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """A coarse channel: quick, and of the same kind as the example."""
    d = tmp_path_factory.mktemp("channel")
    subprocess.run([TOP / "examples/channel.py", d, "--rings", "12",
                    "--around", "16", "--nodes", "24"], check=True)
    return d


def args(d, *more):
    return ["--part", d / "part.stl", "--electrode", d / "electrode.stl",
            "--machine", d / "machine.ini", "--chord", "0", *more]


# -- Bodies ----------------------------------------------------------------------

CUBE = [((0, 0, 0), (0, 1, 0), (1, 1, 0)), ((0, 0, 0), (1, 1, 0), (1, 0, 0)),
        ((0, 0, 1), (1, 0, 1), (1, 1, 1)), ((0, 0, 1), (1, 1, 1), (0, 1, 1)),
        ((0, 0, 0), (1, 0, 0), (1, 0, 1)), ((0, 0, 0), (1, 0, 1), (0, 0, 1)),
        ((1, 0, 0), (1, 1, 0), (1, 1, 1)), ((1, 0, 0), (1, 1, 1), (1, 0, 1)),
        ((1, 1, 0), (0, 1, 0), (0, 1, 1)), ((1, 1, 0), (0, 1, 1), (1, 1, 1)),
        ((0, 1, 0), (0, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1), (0, 1, 1))]


def box(lo, hi):
    return [tuple(tuple(lo[i] + p[i] * (hi[i] - lo[i]) for i in range(3))
                  for p in t) for t in CUBE]


def at_x(tris, x):
    return [tuple((p[0] + x, *p[1:]) for p in t) for t in tris]


def write_stl(path, tris):
    with open(path, "wb") as f:
        f.write(b" " * 80 + struct.pack("<I", len(tris)))
        for t in tris:
            f.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))


def write_text(path, tris):
    with open(path, "w") as f:
        f.write("solid a box\n")
        for t in tris:
            f.write("facet normal 0 0 0\nouter loop\n")
            for p in t:
                f.write("vertex %g %g %g\n" % p)
            f.write("endloop\nendfacet\n")
        f.write("endsolid\n")


def check_boxes(d, part, tool, program="G21 G90\nG1 X20 F60\nM2\n", *more):
    """--check of a tool that goes along X."""
    write_stl(d / "part.stl", part)
    write_stl(d / "electrode.stl", tool)
    (d / "p.ngc").write_text(program)
    return plan("--part", d / "part.stl", "--electrode", d / "electrode.stl",
                "--clearance", "0.1", "--chord", "0", *more, "--check",
                d / "p.ngc")


TOOL = box((-1, -1, -1), (1, 1, 1))
BESIDE = box((5, 2, -5), (25, 12, 5))


def test_a_free_program_is_proved(tmp_path):
    r = check_boxes(tmp_path, BESIDE, TOOL)
    assert r.returncode == 0, r.stderr
    assert "proved" in r.stdout and "least seen" in r.stdout


def test_a_thin_wall_between_any_two_nodes_is_met(tmp_path):
    wall = box((10.003, -9, -9), (10.013, 9, 9))
    r = check_boxes(tmp_path, wall, TOOL)
    assert r.returncode == 1
    assert "p.ngc:2: not free" in r.stdout
    assert "part's triangle" in r.stdout and "electrode's triangle" in r.stdout


def test_an_arc_is_followed_where_its_chord_is_free(tmp_path):
    # Above the middle of a half circle over 20 mm, where the chord is 10 mm off.
    post = box((9.9, 9.5, -5), (10.1, 14, 5))
    ok = check_boxes(tmp_path, post, TOOL)
    r = check_boxes(tmp_path, post, TOOL,
                    "G21 G90 G17\nG2 X20 Y0 I10 J0 F60\nM2\n")
    assert ok.returncode == 0 and r.returncode == 1
    assert "p.ngc:2: not free" in r.stdout


def test_a_curve_is_followed(tmp_path):
    text = ("G21 G90\nF60\nG6.2 P4 K0 X0 Y0\nK0 X5 Y%g\nK0 X15 Y%g\n"
            "K0 X20 Y0\nK1\nK1\nK1\nK1\n")
    post = box((9.9, 5, -5), (10.1, 14, 5))
    low = check_boxes(tmp_path, post, TOOL, text % (3, 3))
    high = check_boxes(tmp_path, post, TOOL, text % (8, 8))
    assert low.returncode == 0, low.stdout + low.stderr
    assert high.returncode == 1, high.stdout + high.stderr


def test_a_hundred_thousand_blocks_are_proved(tmp_path):
    n = 100000
    lines = ["G21 G90 F60"] + ["G1 X%.4f" % (20 * (i + 1) / n)
                               for i in range(n)]
    r = check_boxes(tmp_path, BESIDE, TOOL, "\n".join(lines) + "\nM2\n",
                    "--quiet")
    assert r.returncode == 0, r.stderr
    assert "100000 blocks" in r.stdout


@pytest.mark.parametrize("start, say", [
    (box((-9, -9, -9), (9, 9, 9)), "the electrode is inside the part"),
    (box((-.5, -.5, -.5), (.5, .5, .5)), "the part is inside the electrode"),
    (box((0.5, -9, -9), (9, 9, 9)), "they touch"),
])
def test_a_start_that_is_wrong_is_said(tmp_path, start, say):
    r = check_boxes(tmp_path, start, TOOL)
    assert r.returncode == 1 and say in r.stdout


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_text_and_binary_are_one(tmp_path, mark):
    text = tmp_path / "t.stl"
    write_text(text, BESIDE)
    text.write_text(mark + text.read_text(), encoding="utf-8")
    r = check_boxes(tmp_path, BESIDE, TOOL)
    s = plan("--part", tmp_path / "t.stl", "--electrode",
             tmp_path / "electrode.stl", "--clearance", "0.1", "--chord", "0",
             "--check", tmp_path / "p.ngc")
    assert s.returncode == 0, s.stderr
    assert r.stdout.split("\n")[1:] == s.stdout.split("\n")[1:]


def backward(tris):
    return [(a, c, b) for a, b, c in tris]


SMALL = box((30, 2, -5), (31, 3, -4))
IN_IT = box((10, 5, -2), (15, 9, 2))


@pytest.mark.parametrize("part, say, mm3", [
    (backward(BESIDE), "in 1 of 1 shells: triangle 1 (", 2000),
    (backward(BESIDE[:3]) + BESIDE[3:], "3 triangles that ran backward", 2000),
    (BESIDE + backward(SMALL), "in 1 of 2 shells: triangle 13 (", 2001),
    (backward(BESIDE) + SMALL, "in 1 of 2 shells: triangle 1 (", 2001),
    # A cavity has its outside inside, and is no fault.
    (BESIDE + backward(IN_IT), " mm3", 1920),
    (backward(BESIDE) + IN_IT, "in 2 of 2 shells: triangle 1 (", 1920),
    (BESIDE * 2, "12 triangles that are there twice", 2000),
])
def test_a_body_that_is_inside_out_is_turned_and_said(tmp_path, part, say, mm3):
    r = check_boxes(tmp_path, part, TOOL)
    assert r.returncode == 0, r.stderr
    assert say in r.stdout
    assert "%d mm3" % mm3 in r.stdout.splitlines()[0]
    assert ("exchanged" in r.stdout) == ("shells" in say)


@pytest.mark.parametrize("part", (BESIDE, box((5, -2, -5), (25, 12, 5))))
def test_a_check_writes_the_files_that_are_asked_for(tmp_path, part):
    r = check_boxes(tmp_path, part, TOOL, "G21 G90\nG1 X20 F60\nM2\n",
                    "--report", "-", "--picture", tmp_path / "p.svg",
                    "--view", tmp_path / "v.html")
    report = json.loads(r.stdout)
    assert r.returncode == (0 if report["proved"] else 1)
    assert report["proved"] == (part is BESIDE)
    assert report["blocks"] == 1
    picture = (tmp_path / "p.svg").read_text()
    assert ("first contact red" in picture) != report["proved"]
    assert "POSES" in (tmp_path / "v.html").read_text()
    if not report["proved"]:
        assert "not free" in r.stderr
        contact = report["contact"]
        assert contact["line"] == 2
        assert 3.7 < contact["axes"]["X"] < 4
        assert contact["wanted_mm"] >= 0.1


def test_a_check_has_no_program_to_write(tmp_path):
    r = check_boxes(tmp_path, BESIDE, TOOL, "G1 X1 F60\nM2\n", "--output",
                    tmp_path / "out.ngc")
    assert r.returncode == 64 and "--report, --picture or --view" in r.stderr


def test_what_joining_edges_moves_is_kept_in_addition(tmp_path):
    near = [tuple(tuple(x + 4e-4 * (i % 2) for x in p) for p in t)
            for i, t in enumerate(box((0, 2, 0), (20, 12, 5)))]
    joined = check_boxes(tmp_path, near, TOOL)
    assert joined.returncode == 0, joined.stderr
    assert "corners that nearly meet are joined, by 0.000" in joined.stdout


def test_triangles_doubled_or_without_area_do_no_harm(tmp_path):
    bad = BESIDE + [((5, 2, -5), (5, 2, -5), (25, 12, 5))]
    r = check_boxes(tmp_path, bad, TOOL)
    assert r.returncode == 0 and "without area" in r.stdout, r.stderr
    # A triangle that is there twice leaves its edges with too many neighbours.
    r = check_boxes(tmp_path, BESIDE + BESIDE[:1], TOOL, "G1 X20 F60\nM2\n",
                    "--accept-flaws")
    assert r.returncode == 0, r.stderr


@pytest.mark.parametrize("part, say", [
    (BESIDE[1:], "3 open edges, triangle "),
    (BESIDE + box((20, 5, -9), (30, 9, 9)), " and triangle "),
    ([tuple(tuple(x / 1000 for x in p) for p in t) for t in BESIDE],
     "--unit inch"),
    ([tuple(tuple(x * 1000 for x in p) for p in t) for t in BESIDE],
     "--any-size"),
    ([((float("nan"), 2, -5),) + t[1:] if i == 3 else t
      for i, t in enumerate(BESIDE)], "triangle 4 has a corner at nan"),
    ([((1e30, 2, -5),) + t[1:] if i == 0 else t
      for i, t in enumerate(BESIDE)], "triangle 1 has a corner at 1e+30"),
    ([], "fewer than 4 triangles"),
    (box((5, 2, 0), (25, 12, 0)), "no volume, triangle 1 ("),
    ([((0, 0, 0), (1, 1, 1), (2, 2, 2))] * 8, "1 triangles are left of 8"),
    (at_x(BESIDE, 3e4), "its middle is at X 30015 mm"),
])
def test_a_bad_body_is_refused(tmp_path, part, say):
    r = check_boxes(tmp_path, part, TOOL)
    assert r.returncode == 65
    assert say in r.stderr and "part.stl" in r.stderr
    assert r.stdout == ""


def test_bodies_in_two_units_are_asked_about(tmp_path):
    r = check_boxes(tmp_path, box((50, 60, 0), (250, 260, 200)),
                    box((0, 0, 0), (1.5, 1.5, 1.5)))
    assert r.returncode == 65 and "--unit inch" in r.stderr


def test_bodies_in_inches_are_asked_about(channel, tmp_path):
    """At 2 mm they are not too small for a body, but not in each other."""
    for name in ("part", "electrode"):
        data = bytearray((channel / (name + ".stl")).read_bytes())
        for i in range(84, len(data), 50):
            at = struct.unpack_from("<9f", data, i + 12)
            struct.pack_into("<9f", data, i + 12, *[v / 25.4 for v in at])
        (tmp_path / (name + ".stl")).write_bytes(data)
    for name in ("machine.ini", "dense.ngc"):
        (tmp_path / name).write_bytes((channel / name).read_bytes())
    out = tmp_path / "way.ngc"
    r = plan(*args(tmp_path, "--clearance", "0.3", "--output", out,
                   tmp_path / "dense.ngc"))
    assert r.returncode == 65 and "--unit" in r.stderr, r.stderr
    assert not out.exists()


@pytest.mark.parametrize("cut", [0, 40, 83, 84, 130, -1, -50])
def test_a_file_cut_short_is_refused(tmp_path, cut):
    check_boxes(tmp_path, BESIDE, TOOL)
    whole = (tmp_path / "part.stl").read_bytes()
    (tmp_path / "part.stl").write_bytes(whole[:cut])
    r = plan("--part", tmp_path / "part.stl", "--electrode",
             tmp_path / "electrode.stl", "--check", tmp_path / "p.ngc")
    assert r.returncode == 65 and "part.stl" in r.stderr


def test_any_cut_of_a_text_is_refused(tmp_path):
    check_boxes(tmp_path, BESIDE, TOOL)
    write_text(tmp_path / "part.stl", BESIDE)
    whole = (tmp_path / "part.stl").read_text()
    draw = random.Random(1)
    for cut in [draw.randrange(1, len(whole) - 12) for _ in range(12)]:
        (tmp_path / "part.stl").write_text(whole[:cut])
        r = plan("--part", tmp_path / "part.stl", "--electrode",
                 tmp_path / "electrode.stl", "--check", tmp_path / "p.ngc")
        assert r.returncode == 65, (cut, r.stdout, r.stderr)


def test_an_axis_without_a_joint_is_refused(tmp_path):
    r = check_boxes(tmp_path, BESIDE, TOOL, "G21 G90 F60\nG1 X1\nG1 B20\nM2\n")
    assert r.returncode == 65
    assert "p.ngc:3: error: axis B moves" in r.stderr


def test_an_axis_out_of_travel_is_refused(tmp_path):
    r = check_boxes(tmp_path, BESIDE, TOOL, "G21 G90 F60\nG1 X999\nM2\n")
    assert r.returncode == 65 and "p.ngc:2" in r.stderr


# -- Channels --------------------------------------------------------------------

def nodes_of(report):
    return [[n[a] for a in "XYZABC"] for n in report["written"]["nodes"]]


def test_a_plan_keeps_its_clearance_at_many_poses(channel, tmp_path):
    """Brute force: distances at poses along the written blocks."""
    r = plan(*args(channel, "--clearance", "0.3", "--on-path", "--no-pivot",
                   "--output", tmp_path / "way.ngc", "--report",
                   tmp_path / "r.json", "--picture", tmp_path / "w.svg",
                   "--view", tmp_path / "w.html", channel / "dense.ngc"))
    assert r.returncode == 0, r.stderr
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["fewest"]["blocks"] <= report["greedy"]["blocks"] < 8
    n = nodes_of(report)
    poses = int(os.environ.get("EDM_POSES", 60))
    for i, each in enumerate(report["written"]["each"]):
        lines = [" ".join("%.9f" % (a + k / poses * (b - a))
                          for a, b in zip(n[i], n[i + 1]))
                 for k in range(poses + 1)]
        (tmp_path / "poses").write_text("\n".join(lines) + "\n")
        m = plan(*args(channel, "--measure", tmp_path / "poses"))
        least = min(float(x.split()[0]) for x in m.stdout.splitlines())
        assert least >= each["proved_mm"] >= 0.3
        assert least <= each["proved_mm"] + 0.1
    for name in ("w.svg", "w.html"):
        text = (tmp_path / name).read_text()
        assert len(text) > 10000
        assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
    again = plan(*args(channel, "--clearance", "0.3", "--check",
                       tmp_path / "way.ngc"))
    assert again.returncode == 0, again.stdout


def test_a_plan_that_cannot_be_is_refused_and_nothing_is_written(channel,
                                                                 tmp_path):
    out = tmp_path / "way.ngc"
    r = plan(*args(channel, "--clearance", "2", "--output", out,
                   channel / "dense.ngc"))
    assert r.returncode == 1 and "end pose" in r.stderr
    r = plan(*args(channel, "--clearance", "0.3", "--end-pose", "X3,Z-60",
                   "--output", out))
    assert r.returncode == 1 and "end pose" in r.stderr
    r = plan(*args(channel, "--clearance", "0.3", "--end-pose", "X3,Z-600",
                   "--output", out))
    assert r.returncode == 65 and "travel" in r.stderr
    assert not out.exists()


def on_a_terminal(cmd, stop_at):
    """Run it with a terminal as stderr, and press Ctrl-C when that is seen."""
    import pty
    outer, inner = pty.openpty()
    p = subprocess.Popen([str(c) for c in cmd], stdout=subprocess.PIPE,
                         stderr=inner, text=True)
    os.close(inner)
    seen = b""
    while True:
        try:
            more = os.read(outer, 4096)
        except OSError:
            break
        if not more:
            break
        if stop_at and stop_at in seen + more:
            p.send_signal(signal.SIGINT)
            stop_at = None
        seen += more
    out, _ = p.communicate(timeout=300)
    os.close(outer)
    return p.returncode, out, seen.decode(errors="replace")


def test_ctrl_c_writes_the_best_so_far(channel, tmp_path):
    out = tmp_path / "way.ngc"
    rc, said, seen = on_a_terminal(
        [B / "edm-plan", *args(channel, "--clearance", "0.3", "--output", out,
                               channel / "dense.ngc")], b"best: ")
    assert rc == 0, seen
    # Unless this test was so slow that the plan was ready before.
    assert "stopped" in said or "planned" in said
    assert plan(*args(channel, "--clearance", "0.3", "--check",
                      out)).returncode == 0


def test_ctrl_c_before_the_first_way_writes_nothing(channel, tmp_path):
    out = tmp_path / "way.ngc"
    rc, _, seen = on_a_terminal(
        [B / "edm-plan", *args(channel, "--clearance", "0.3", "--output", out,
                               "--end-pose", "Z-60")], b"a way out")
    # As above: a plan that was ready is written.
    assert out.exists() == (rc == 0)
    assert rc == 0 or "interrupted; nothing is written" in seen


def test_ctrl_c_while_files_are_loaded_ends_it_at_once(channel, tmp_path):
    """It reads its machine file from a pipe that stays open."""
    pipe, out = tmp_path / "machine.ini", tmp_path / "way.ngc"
    os.mkfifo(pipe)
    p = subprocess.Popen([B / "edm-plan", "--part", channel / "part.stl",
                          "--electrode", channel / "electrode.stl",
                          "--machine", pipe, "--output", out,
                          channel / "dense.ngc"])
    with open(pipe, "w"):
        p.send_signal(signal.SIGINT)
        try:
            assert p.wait(timeout=60) == -signal.SIGINT
        finally:
            p.kill()
    assert not out.exists()


@pytest.mark.parametrize("more", (-30, 7))
def test_a_binary_mesh_of_another_length_is_refused_with_both(channel,
                                                              tmp_path, more):
    raw = (channel / "part.stl").read_bytes()
    (tmp_path / "p.stl").write_bytes(raw[:more] if more < 0 else
                                     raw + bytes(more))
    r = plan("--part", tmp_path / "p.stl", "--electrode",
             channel / "electrode.stl", "--check", channel / "dense.ngc")
    assert r.returncode == 65
    assert "%d bytes where its" % (len(raw) + more) in r.stderr
    assert "take %d;" % len(raw) in r.stderr
