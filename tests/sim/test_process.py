# SPDX-License-Identifier: Apache-2.0
"""Promises of a simulated cut, of its report and of edmsim's exit codes."""
import json
import subprocess

import pytest
from edmsim import PROGRAM, ROOT, done, places, report, run

SINK = "G21 G90 F20\nM3\nG1 Z-0.6\nG0 Z1\nM2\n"


# -- Seeds ---------------------------------------------------------------------

def files_of(tmp_path, seed):
    names = tmp_path / "p.csv", tmp_path / "t.csv"
    done("--seed", seed, "--pulses", names[0], "--trace", names[1], text=SINK)
    return [n.read_bytes() for n in names]


def test_the_same_seed_gives_the_same_files_byte_for_byte(tmp_path):
    assert files_of(tmp_path, 7) == files_of(tmp_path, 7)


def test_another_seed_gives_other_files(tmp_path):
    a, b = files_of(tmp_path, 7), files_of(tmp_path, 8)
    assert a[0] != b[0] and a[1] != b[1]


def test_time_goes_on_there_and_back(tmp_path):
    name = tmp_path / "t.csv"
    text = "G21 G90 F600\nG1 X3\nM2\n"
    once = report("--dry-run", text=text)["cycles"]
    r = report("--dry-run", "--there-and-back", "--trace", name, text=text)
    at = [round(float(row.split(",")[0]) * 1e3)
          for row in name.read_text().splitlines()[1:]]
    assert at == list(range(1, r["cycles"] + 1))
    assert r["cycles"] > 2.1 * once


# -- The report ----------------------------------------------------------------

ALWAYS = {
    "outcome", "lines", "segments", "cycles", "virtual_s", "wall_s", "path_mm",
    "pulses", "switches", "deviation_um_max", "deviation_um_mean",
    "end_error_pulses", "compile_lines_s", "cycles_s",
}
OF_A_CUT = {
    "retracts", "retract_mm_max", "jumps", "jump_s", "erosion_s", "shorts",
    "arcs", "removed_mm3", "removal_mm3_min", "wear_mm", "burns", "hunts",
    "retracts_in_row_max",
}
COUNTS = {"lines", "segments", "cycles", "switches", "end_error_pulses",
          "retracts", "jumps", "shorts", "arcs", "burns", "hunts",
          "retracts_in_row_max"}


def check_kinds(r):
    assert isinstance(r["outcome"], str)
    assert all(isinstance(n, int) for n in r["pulses"].values())
    for key in r.keys() - {"outcome", "pulses", "fault"}:
        kind = int if key in COUNTS else float
        assert isinstance(r[key], kind) and r[key] >= 0, key


def test_the_report_of_a_dry_run_has_its_keys_and_units():
    r = report("--dry-run", "--period-us", 500,
               text="G21 G90 F60\nG1 X3 Y4\nG1 X0 Y0 Z1\n")
    assert set(r) == ALWAYS
    check_kinds(r)
    assert r["outcome"] == "done"
    assert (r["lines"], r["segments"]) == (3, 2)
    assert r["path_mm"] == pytest.approx(5 + 26 ** 0.5)
    assert r["pulses"] == {"X": 6000, "Y": 8000, "Z": 1000}
    assert r["virtual_s"] == pytest.approx(r["cycles"] * 500e-6)
    # 1 mm/s, and a little for speeding up and braking.
    assert r["path_mm"] <= r["virtual_s"] <= r["path_mm"] + 0.1
    assert r["end_error_pulses"] == 0
    assert 0 < r["deviation_um_mean"] < r["deviation_um_max"] <= 0.71
    assert r["cycles_s"] == pytest.approx(r["cycles"] / r["wall_s"], rel=0.01)


def test_switches_count_the_changes_of_the_moving_axis():
    r = report("--dry-run", "--strategy", "point-by-point",
               text="G21 G91 F60\nG1 X0.005\nG1 Y0.003\nG1 X0.001 Y0.001\n")
    # XXXXX YYY XY: from X to Y, to X, to Y.
    assert r["switches"] == 3
    assert r["pulses"] == {"X": 6, "Y": 4}


def test_the_report_of_a_cut_has_its_keys_and_units():
    r = report(text=SINK)
    assert set(r) == ALWAYS | OF_A_CUT
    check_kinds(r)
    assert r["outcome"] == "done"
    assert r["erosion_s"] + r["jump_s"] <= r["virtual_s"]
    assert r["jumps"] > 0 and r["jump_s"] > 0
    assert r["removal_mm3_min"] == pytest.approx(
        r["removed_mm3"] / r["virtual_s"] * 60)
    # A round of 5 mm, 0.6 mm deep less the air before it, and the gap.
    assert 0.5 < r["removed_mm3"] / 19.635 < 0.7
    assert r["wear_mm"] == pytest.approx(0.01 * r["removed_mm3"] / 19.635)


def test_a_report_goes_to_a_file_too(tmp_path):
    name = tmp_path / "r.json"
    done("--dry-run", "--report", name, text="G21 F60\nG1 X1\n")
    assert json.loads(name.read_text())["outcome"] == "done"


def test_the_trace_has_a_row_for_each_cycle(tmp_path):
    name = tmp_path / "t.csv"
    r = report("--trace", name, text=SINK)
    rows = name.read_text().splitlines()
    assert rows[0] == ("t_s,line,s_mm,feed_mm_s,gap_v,state,"
                       "X,Y,Z,A,B,C,U,V,open,spark,arc,short,debris,"
                       + ",".join(f"{a}_{kind}" for kind in ("sent", "is")
                                  for a in "XYZABCUV"))
    assert len(rows) - 1 == r["cycles"]
    states = {row.split(",")[5] for row in rows[1:]}
    assert {"travel", "approach", "erode", "jump"} <= states
    found = ["0"] * 8
    for row in rows[1:]:
        t, line, s, feed, gap, state, *more = row.split(",")
        axes, shares, debris = more[:8], more[8:12], more[12]
        # Nothing is added in this machine.  It measures before it sends, and
        # its axes do not lag: it finds what the row before sent.
        assert more[13:21] == axes and more[21:] == found
        found = axes
        assert abs(float(axes[2])) < 3 and float(gap) >= 0
        assert 0 <= float(debris) <= 1
        if any(shares):
            assert sum(map(float, shares)) == pytest.approx(1, abs=3e-4)
    # Shares are of pulses: with the power on only.
    by_state = {r.split(",")[5]: bool(r.split(",")[14]) for r in rows[1:]}
    assert by_state["erode"] and not by_state["jump"]


def test_a_dry_run_has_no_shares_and_no_debris(tmp_path):
    name = tmp_path / "t.csv"
    done("--dry-run", "--trace", name, text="G21 F60\nG1 X0.1\n")
    rows = name.read_text().splitlines()
    assert all(row.split(",")[14:19] == [""] * 5 for row in rows[1:])


@pytest.mark.parametrize("condition", sorted(
    p.name for p in (ROOT / "tests/experiments/conditions").glob("*.ini")))
def test_each_work_condition_can_be_cut(condition):
    r = report("--machine", ROOT / "tests/experiments/conditions" / condition,
               "--limit-s", 3600,
               text="G21 G90 F20\nT84\nM3\nG0 Z1\nG1 Z-0.05\nG0 Z1\nM2\n")
    assert r["outcome"] == "done" and r["removed_mm3"] > 0


def test_a_wire_with_the_pump_on_cuts_without_a_break_and_without_wear():
    text = "G21 G90 F60\nT84\nG1 X2\nG1 Y1\nM2\n"
    r = report("--machine", ROOT / "examples/wire.ini", text=text)
    assert r["outcome"] == "done" and r["wear_mm"] == 0
    # 3 mm of a kerf of 0.2 mm and two gaps, 40 mm high.
    assert r["removed_mm3"] == pytest.approx(3 * 0.23 * 40, rel=0.03)


def test_without_jumps_a_deep_rib_cuts_slower_and_burns(tmp_path):
    condition = ROOT / "tests/experiments/conditions/deep-poor-flushing.ini"
    text = "G21 G90 F20\nT84\nM3\nG0 Z10\nG1 Z-0.3\nG0 Z1\nM2\n"

    def cut(jump):
        machine = tmp_path / "m.ini"
        machine.write_text(f"{condition.read_text()}\n[jump]\n{jump}\n")
        return report("--machine", machine, text=text)

    none, high = cut("height_mm = 0"), cut("height_mm = 8\nevery_s = 1")
    assert high["virtual_s"] < none["virtual_s"]
    assert high["burns"] < none["burns"]


# -- What a cut does -----------------------------------------------------------

def test_a_cut_that_only_shorts_is_a_fault(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[sim]\nbridge_per_s = 100\nbridge_mm = 10\n"
                       "bridge_settle_s = 100\ndebris_per_mm = 1000\n"
                       "[gap]\nretract_limit_mm = 0.1\n")
    r = run("--machine", machine, "--report", "-",
            text="G21 G90 F20\nM3\nG0 Z1\nZ0\nG1 Z-0.6\nM2\n")
    assert r.returncode == 1
    r = json.loads(r.stdout)
    assert r["outcome"] == "fault" and r["fault"] == "short-not-cleared"
    assert r["shorts"] > 0 and 0 < r["retract_mm_max"] < 0.11


def test_the_limit_ends_a_run_and_is_no_success():
    r = run("--limit-s", 2.5, "--report", "-", text=SINK)
    assert r.returncode == 1
    r = json.loads(r.stdout)
    assert r["outcome"] == "limit"
    assert r["virtual_s"] == pytest.approx(2.5, abs=0.002)


def test_power_switched_off_cuts_nothing():
    r = report(text="G21 G90 F20\nM5\nG1 Z-0.02\nM2\n")
    assert r["removed_mm3"] == 0 and r["erosion_s"] == 0


def test_a_programmed_stop_is_gone_on_from():
    text = "G21 G90 F60\nG1 X1\nM0\nG1 X2\nM2\n"
    assert places("--dry-run", text=text)[-1][0] == 2000


# -- Options and exit codes ------------------------------------------------------

def test_check_writes_the_files_of_a_dry_run(tmp_path):
    pulses = tmp_path / "p.csv"
    r = run("--check", "--report", "-", "--pulses", pulses, text=SINK)
    assert r.returncode == 0 and b"0.600 mm cut" in r.stderr
    told = json.loads(r.stdout)
    assert told["outcome"] == "done" and told["path_mm"] == pytest.approx(2.2)
    assert pulses.read_text().count("\n") > 2200


def test_check_reads_and_tells():
    r = run("--check", text=SINK)
    assert r.returncode == 0
    told = dict(row.split(None, 1) for row in r.stdout.decode().splitlines())
    assert told["lines"] == "5" and told["segments"] == "2"
    assert told["path"].startswith("2.200 mm: 0.600 mm cut")
    assert run("--check", text="G1 X").returncode == 65


@pytest.mark.parametrize("args, code", [
    (["--help"], 0),
    (["--version"], 0),
    (["--print-config"], 0),
    ([], 64),
    (["--no-such-option", "-"], 64),
    (["--period-us", "soon", "-"], 64),
    (["--period-us", "1e9", "-"], 64),
    (["--seed", "-1", "-"], 64),
    (["--strategy", "by-feel", "-"], 64),
    (["--dialect", "klingon", "-"], 64),
    (["--there-and-back", "-"], 64),
    (["one.ngc", "two.ngc"], 64),
    (["/no/such/job.ngc"], 66),
    (["--machine", "/no/such/machine.ini", "-"], 66),
    (["--pulses", "/no/such/folder/p.csv", "-"], 73),
    (["--trace", "/no/such/folder/t.csv", "-"], 73),
    (["--report", "/no/such/folder/r.json", "-"], 73),
    (["--plot", "/no/such/folder/p.svg", "-"], 73),
])
def test_exit_codes_are_those_of_sysexits(args, code):
    r = subprocess.run([PROGRAM, *args], input=SINK.encode(), timeout=60,
                       capture_output=True)
    assert r.returncode == code
    assert (code == 0) == (r.stderr == b"")


@pytest.mark.parametrize("text, where", [
    ("[gap]\nservo_v = 40\nservo = 40\n", "3:1"),
    ("[gap]\nservo_v = 1e9\n", "2:11"),
    ("[gap]\nservo_v = lots\n", "2:11"),
    ("[gasp]\n", "1:1"),
])
def test_a_bad_machine_file_is_refused_with_its_line(tmp_path, text, where):
    machine = tmp_path / "m.ini"
    machine.write_text(text)
    r = run("--machine", machine, text=SINK)
    assert r.returncode == 78
    found, wanted = r.stderr.decode().split("; ", 1)
    assert found.startswith(f"{machine}:{where.split(':')[0]}:")
    assert ": error: " in found and wanted.strip()
