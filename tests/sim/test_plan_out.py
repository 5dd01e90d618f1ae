# SPDX-License-Identifier: Apache-2.0
"""What edm-plan writes: whole or not at all, and what its reader takes it for."""
import resource
import signal
import subprocess

import pytest

from test_plan import B, TOOL, box, plan, write_stl

CHAIN = """[machine]
backend = sim
[axis.C]
travel_min_mm = -2000
travel_max_mm = 2000
[axis.U]
present = no
[axis.V]
present = no
[kinematics]
chain = X Y Z C
"""


@pytest.fixture
def bodies(tmp_path):
    write_stl(tmp_path / "part.stl", box((30, 30, -5), (40, 40, 5)))
    write_stl(tmp_path / "electrode.stl", TOOL)
    (tmp_path / "m.ini").write_text(CHAIN)
    (tmp_path / "p.ngc").write_text("G21 G90\nG0 X1\nG1 X5 Y5 C60. F60\n"
                                    "X10 C120.\nM2\n")
    return tmp_path


def args(d, *more):
    return ["--part", d / "part.stl", "--electrode", d / "electrode.stl",
            "--machine", d / "m.ini", "--chord", "0", "--clearance", "0.1",
            "--any-size", *more]


def test_a_turn_of_whole_degrees_is_no_condition(bodies):
    out = bodies / "w.ngc"
    r = plan(*args(bodies, "--output", out, bodies / "p.ngc"))
    assert r.returncode == 0, r.stderr
    assert "C120." in out.read_text()
    s = subprocess.run([B / "edmsim", "--check", "--machine",
                        bodies / "m.ini", out], capture_output=True, text=True)
    assert s.returncode == 0, s.stderr


@pytest.mark.parametrize("name", ["part.stl", "electrode.stl", "m.ini",
                                  "p.ngc"])
def test_an_output_is_none_of_the_inputs(bodies, name):
    was = (bodies / name).read_bytes()
    (bodies / "link").symlink_to(bodies / name)
    for out in (bodies / name, bodies / "link"):
        r = plan(*args(bodies, "--output", out, bodies / "p.ngc"))
        assert r.returncode == 64 and "another file" in r.stderr
    r = plan(*args(bodies, "--output", bodies / "w.ngc", "--report",
                   bodies / name, bodies / "p.ngc"))
    assert r.returncode == 64 and not (bodies / "w.ngc").exists()
    assert (bodies / name).read_bytes() == was


def test_a_folder_that_is_not_there_is_said_before_all_else(bodies):
    r = plan(*args(bodies, "--output", bodies / "w.ngc", "--view",
                   bodies / "no" / "v.html", bodies / "none.ngc"))
    assert r.returncode == 73 and "v.html" in r.stderr
    assert "none.ngc" not in r.stderr


def test_a_disk_that_is_full_leaves_no_half_program(bodies):
    out = bodies / "w.ngc"
    out.write_text("(as it was)\n")

    def full():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (50, 50))

    r = subprocess.run([B / "edm-plan", *map(str, args(
        bodies, "--quiet", "--output", out, bodies / "p.ngc"))],
        capture_output=True, text=True, preexec_fn=full)
    assert r.returncode in (73, 74) and "w.ngc" in r.stderr
    assert out.read_text() == "(as it was)\n"
    assert sorted(p.name for p in bodies.iterdir()) == [
        "electrode.stl", "m.ini", "p.ngc", "part.stl", "w.ngc"]


@pytest.mark.parametrize("turn, free", [(-720, False), (-180, True),
                                        (200, True), (720, False)])
def test_a_turn_of_more_than_one_turn_is_followed(bodies, turn, free):
    """A post at 298 degrees, passed at that angle alone."""
    write_stl(bodies / "part.stl", box((8.8, -19.5, -1), (10.8, -17.5, 1)))
    write_stl(bodies / "electrode.stl", box((20, -1, -1), (22, 1, 1)))
    # Less than a turn passes it on the way down from 0 only beyond -50.
    start = 5 if turn > 0 else -75
    (bodies / "p.ngc").write_text("G21 G90\nG0 Z9\nC%d.\nZ0\nG1 C%d. F600\n"
                                  "M2\n" % (start, turn))
    r = plan(*args(bodies, "--check", bodies / "p.ngc"))
    assert (r.returncode == 0) == free, r.stdout + r.stderr
    if not free:
        assert "p.ngc:5: not free" in r.stdout


def read_back(d, out, *more):
    return subprocess.run([B / "edmsim", "--check", "--machine", d / "m.ini",
                           *more, out], capture_output=True, text=True)


SODICK = "%\nG21 G90 G54\nG0 X1.\nT84\nG1 X5. Y5. C60. F60\n"


def test_a_program_of_another_dialect_stays_in_it(bodies):
    """Its other lines, which generic does not know, are carried over."""
    (bodies / "p.ngc").write_text(SODICK + "X10. C120.\nT85\nM2\n")
    out = bodies / "w.ngc"
    r = plan(*args(bodies, "--dialect", "sodick-sinker", "--output", out,
                   bodies / "p.ngc"))
    assert r.returncode == 0, r.stderr
    text = out.read_text()
    assert text.startswith("%\nG21 G90 G54\nG0 X1.\nT84\n")
    assert text.endswith("T85\nM2\n") and "dialect generic" not in r.stdout
    assert read_back(bodies, out, "--dialect", "sodick-sinker").returncode == 0


def test_what_the_dialect_has_no_words_for_is_generic_and_said(bodies):
    """Increments: only the blocks are written, and M3 is not a word of it."""
    (bodies / "m.ini").write_text(CHAIN + "[nc]\ndialect = sodick-sinker\n")
    (bodies / "p.ngc").write_text(SODICK + "G91 X5. C60.\nX-2.\nT85\n"
                                  "G0 X5.\nM2\n")
    out = bodies / "w.ngc"
    r = plan(*args(bodies, "--on-path", "--output", out, bodies / "p.ngc"))
    assert r.returncode == 0, r.stderr
    assert "is in the dialect generic" in r.stdout
    assert read_back(bodies, out).returncode != 0
    assert read_back(bodies, out, "--dialect", "generic").returncode == 0


def test_a_curve_is_planned_with_its_feed_and_its_other_lines(bodies):
    curve = ("F60\nG6.2 P4 K0 X1 Y0\nK0 X1 Y5\nK0 X5 Y9\nK0 X10 Y9\nK1\nK1\nK1\n"
             "K1\n")
    (bodies / "p.ngc").write_text("G21 G90\nG0 X1\nM3\n" + curve +
                                  "M5\nG0 Z20\nM2\n")
    out = bodies / "w.ngc"
    r = plan(*args(bodies, "--on-path", "--output", out, bodies / "p.ngc"))
    assert r.returncode == 0, r.stderr
    text = out.read_text()
    assert "F60." in text and text.endswith("M5\nG0 Z20\nM2\n")
    assert "K1" not in text and "what it calls" not in r.stdout


def test_times_find_the_files_that_the_machine_file_names(bodies):
    """[nc] dialect stands beside the machine file; nothing is left there."""
    (bodies / "own.ini").write_text("[dialect]\nabout = own\nbase = generic\n")
    (bodies / "m.ini").write_text(CHAIN + "[nc]\ndialect = own.ini\n")
    was = sorted(p.name for p in bodies.iterdir())
    out = bodies / "w.ngc"
    r = plan(*args(bodies, "--times", "--no-pivot", "--output", out,
                   bodies / "p.ngc"))
    assert r.returncode == 0, r.stderr
    assert r.stdout.count("min with a stop at each node") == 3
    assert sorted(p.name for p in bodies.iterdir()) == sorted(was + ["w.ngc"])


def test_a_plan_is_written_though_its_times_cannot_be_told(bodies, tmp_path):
    """There is no edmsim beside it."""
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "edm-plan").write_bytes((B / "edm-plan").read_bytes())
    (alone / "edm-plan").chmod(0o755)
    out = bodies / "w.ngc"
    r = subprocess.run([alone / "edm-plan", *map(str, args(
        bodies, "--times", "--output", out, bodies / "p.ngc"))],
        capture_output=True, text=True)
    assert r.returncode != 0 and "edmsim" in r.stderr
    assert out.exists()
