# SPDX-License-Identifier: Apache-2.0
"""Promises of orbits and of the ways out beside the path, in a simulated cut."""
import csv
import math

import pytest
from edmsim import ROOT, assert_neighbours, done, places, report, run

ORBIT = ("G21 G90 F20\nM3\n{mode}\nG0 Z1\nG0 Z0.1\n"
         "G130 Z-0.2 R0.1 Q0.1 P2\nM2\n")
MACHINE = """[gap]
retract = {retract}
[jump]
height_mm = 0.5
every_s = 1
escape = {escape}
"""


def machine(tmp_path, escape="path", retract="path"):
    file = tmp_path / "machine.ini"
    file.write_text(MACHINE.format(escape=escape, retract=retract))
    return file


def trace(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


def narrowest_jump(rows):
    """The least distance from the centre of the last jump's places."""
    jumps = [r for r in rows if r["state"] == "jump"]
    last = [r for r in jumps if float(r["t_s"]) >
            float(jumps[-1]["t_s"]) - 0.5]
    return min(math.hypot(float(r["X"]), float(r["Y"])) for r in last)


def cut(tmp_path, mode="", **keys):
    """Run the orbit; (report, rows of points, trace)."""
    r = report("--machine", machine(tmp_path, **keys),
               "--pulses", tmp_path / "p.csv", "--trace", tmp_path / "t.csv",
               text=ORBIT.format(mode=mode))
    with open(tmp_path / "p.csv", newline="") as f:
        points = [tuple(map(int, row[2:])) for row in list(csv.reader(f))[1:]]
    return r, points, trace(tmp_path / "t.csv")


def test_an_orbit_with_jumps_and_retracts_by_the_centre_is_done(tmp_path):
    r, points, rows = cut(tmp_path, escape="centre", retract="escape")
    assert r["outcome"] == "done" and r["end_error_pulses"] == 0
    assert r["jumps"] > 20
    assert_neighbours(points)
    assert points[-1][:3] == (0, 0, 100)
    assert narrowest_jump(rows) == 0


def test_the_word_of_the_program_overrides_the_machine_file(tmp_path):
    _, _, rows = cut(tmp_path, mode="G140", escape="centre")
    assert narrowest_jump(rows) > 0.09
    _, _, rows = cut(tmp_path, mode="G141", escape="path")
    assert narrowest_jump(rows) == 0


def test_a_dry_run_is_the_same_whatever_the_way_out(tmp_path):
    a, b = (places("--dry-run", "--machine", machine(tmp_path, escape=e),
                   text=ORBIT.format(mode="")) for e in ("path", "centre"))
    assert a == b


def test_check_counts_the_ways_out_and_what_has_none(tmp_path):
    text = ORBIT.format(mode="G141")
    said = done("--check", text=text).stdout.decode()
    assert ("escapes    5 of 6 cut segments; the others, 1, "
            "lift along the path") in said
    assert "escapes" not in done("--check", text=text.replace("G141", "")
                                 ).stdout.decode()


def test_the_time_of_a_cycle_ends_it_and_the_job_goes_on(tmp_path):
    r = report("--machine", machine(tmp_path), "--trace", tmp_path / "t.csv",
               text="G21 G90 F20\nM3\nG0 Z1\nG0 Z0.1\nG86 Z-5 S10\n"
                    "G1 X0.2\nM2\n")
    low = min(float(row["Z"]) for row in trace(tmp_path / "t.csv"))
    assert r["outcome"] == "done" and r["virtual_s"] < 200
    assert -1 < low < 0.05


CLOSED = """G6.2 P3 K0 X0 Y0
K0 X{0} Y0
K0 X{0} Y{0}
K1 X0 Y0
K2
K2
K2
"""


@pytest.mark.parametrize("motion", [
    "G130 R{0} P3", *(f"G{g} Z{{1}} R{{0}} Q{{2}} P3" for g in range(130, 136)),
    "G2 I{0}", CLOSED])
def test_inches_take_as_long_as_millimetres(motion):
    """Also where a motion ends where it began."""
    inch, mm = (report("--dry-run", text=f"{units} G90 F{4 * k}\nG1 Z{-.1 * k}\n"
                       + motion.format(.02 * k, -.14 * k, .01 * k)
                       + "\nM2\n")
                for units, k in (("G20", 1), ("G21", 25.4)))
    assert mm["pulses"] == inch["pulses"]
    assert abs(inch["virtual_s"] / mm["virtual_s"] - 1) < 1e-3


@pytest.mark.parametrize("line,column,words", [
    ("G130 Z-1 R0", 10, "an orbit of radius 0 mm"),
    ("G130 Z-1 I0.1 J0.2", 10, "leaves a radius of -0.1 mm"),
    ("G132 Z-1 R0.2", 1, "G132 without a step"),
    ("G130 Z-500 R0.2", 6, "beyond the travel"),
])
def test_a_wrong_orbit_is_refused_at_its_word(line, column, words):
    r = run("--check", text="F20\n" + line + "\n")
    assert r.returncode == 65
    assert f"-:2:{column}: error:" in r.stderr.decode()
    assert words in r.stderr.decode()


def test_the_example_is_done_within_a_pulse():
    r = report("--machine", ROOT / "examples/machine.ini",
               ROOT / "examples/orbit.ngc")
    assert r["outcome"] == "done" and r["end_error_pulses"] == 0
    assert r["deviation_um_max"] < 1
