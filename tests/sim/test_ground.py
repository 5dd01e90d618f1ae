# SPDX-License-Identifier: Apache-2.0
"""Promises of what a cut meets, simulated and planned, and of a dry picture."""
import pytest
from edmsim import ROOT, done, report

MACHINE = ROOT / "examples/machine.ini"
SUNK = "G21 G90 M3 F30\nG0 X0 Y0 Z0\nC120\nG1 Z-0.3\n"
TECH = ["--tech", ROOT / "examples/copper-steel.tech"]


def plan(*args, text):
    """The rows of the plan: condition, way, mm3, min, seconds of dwell."""
    said = done("--check", *args, text=text).stdout.decode().splitlines()
    at = next(i for i, row in enumerate(said) if row.startswith("plan"))
    rows = [row.split() for row in said[at + 2:-1]]
    return said[at], [(r[0], *(float(x.replace("-", "nan") if x == "-" else x)
                               for x in (r[4], r[6], r[7], r[8])))
                      for r in rows]


def test_another_turn_of_an_orbit_at_one_depth_costs_little():
    """C120 sinks, C110 widens by 0.1 mm, C100 goes round three times more."""
    r = report("--machine", MACHINE, *TECH, text=SUNK + "C110\nG130 R0.1 P1\n"
               "C100\nG130 R0.1 P3\nM2\n")
    took = {c["condition"]: c["virtual_s"] for c in r["conditions"]}
    assert took["C100"] < took["C110"] / 2
    without = report("--machine", MACHINE, *TECH, text=SUNK +
                     "C110\nG130 R0.1 P1\nM2\n")
    assert r["removed_mm3"] < 1.15 * without["removed_mm3"]


def test_the_plan_leaves_out_what_an_orbit_has_removed():
    words = SUNK + "C110\nG130 R0.1 P1\nG4 P3\nC100\nG130 R0.1 P3\n" \
        "C200\nG130 R0.12 P1\nM2\n"
    title, rows = plan("--machine", MACHINE, *TECH, text=words)
    assert title == "plan       for a frontal area of 100 mm2"
    sunk, turn, again, wider = rows
    assert sunk[0] == "C120" and sunk[2] == pytest.approx(30, abs=0.3)
    assert sunk[3] == pytest.approx(30 / 35, abs=0.02)
    # Its way is twice the radius and a turn; the dwell is its own.
    assert turn[1] == pytest.approx(0.1 + 0.2 * 3.1416, abs=0.002)
    assert 40 < turn[2] < 70 and turn[4] == 3 and sunk[4] == 0
    assert again[1] > 1.9 and again[2] == pytest.approx(0, abs=0.5)
    assert 2 < wider[2] < turn[2] / 3


def test_the_volume_planned_is_the_volume_cut():
    """Spiral, helix, and a slot that is cut twice."""
    for job in ("orbit", "cavity"):
        text = (ROOT / f"examples/{job}.ngc").read_text()
        _, rows = plan("--machine", MACHINE, text=text)
        r = report("--machine", MACHINE, text=text)
        assert r["removed_mm3"] == pytest.approx(sum(x[2] for x in rows),
                                                 rel=0.1)


SQUARE = "G1 X8. Y-8.\nY8.\nX-8.\nY-8.\nX0\n"


def test_the_plan_of_a_wire_has_its_kerf_and_what_a_second_pass_finds():
    words = "G90 F180 T84\nG0 X0 Y-8.\nE001\n" + SQUARE + \
        "E002\n" + SQUARE + "E003\nG1 Y-8.1\n" + \
        SQUARE.replace("8.", "8.1") + "M2\n"
    title, rows = plan("--machine", ROOT / "examples/wire.ini", text=words)
    assert title == "plan       for a kerf of 0.23 mm in work 40 mm high"
    first, same, wider = rows
    assert first[2] == pytest.approx(64 * 0.23 * 40, rel=0.02)
    assert same[2] < 1
    assert wider[2] == pytest.approx(64.8 * 0.1 * 40, rel=0.15)


def test_a_picture_of_a_dry_run_tells_cut_from_positioned(tmp_path):
    picture = tmp_path / "p.svg"
    done("--machine", MACHINE, "--dry-run", "--plot", picture,
         text="G21 G90 F300\nG0 X5.\nG1 Y5. C90.\nG0 Z2.\nM2\n")
    said = picture.read_text()
    for words in (">positioned<", ">cut<", "C, degree", ">Path<"):
        assert words in said
    done("--machine", MACHINE, "--dry-run", "--plot", picture,
         text="G21 G90 F300\nG0 X50. Z0.5\nG1 Y50.\nM2\n")
    assert "axes have scales of their own" in picture.read_text()


def test_a_picture_of_a_wire_has_the_upper_guide_whole(tmp_path):
    picture = tmp_path / "p.svg"
    done("--machine", ROOT / "examples/wire.ini", "--dry-run", "--plot",
         picture, ROOT / "examples/taper.ngc")
    said = picture.read_text()
    for words in (">upper guide<", "U, mm", "V, mm", ">40<"):
        assert words in said
