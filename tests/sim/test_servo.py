# SPDX-License-Identifier: Apache-2.0
"""What the keys of [gap] and [jump] do to a cut, on the simulated gap."""
import json
import os
import subprocess

import pytest

from edmsim import PROGRAM, ROOT, report, run

BUILD = os.path.dirname(PROGRAM)

SINK = "G21 G90 F30\nG0 Z1\nZ0\nG1 Z-0.6\nM2\n"


@pytest.fixture
def cut(tmp_path):
    """Cut with a machine file; the report."""
    def cut(text, *args, job=SINK):
        machine = tmp_path / "m.ini"
        machine.write_text(text)
        return report("--machine", machine, *args, text=job)
    return cut


def mean_erode_v(trace):
    rows = [r.split(",") for r in trace.read_text().splitlines()[1:]]
    v = [float(r[4]) for r in rows if r[5] == "erode"]
    assert len(v) > 1000
    return sum(v) / len(v)


def test_an_integral_holds_the_gap_nearer_to_the_servo_voltage(cut, tmp_path):
    trace = tmp_path / "t.csv"
    off = []
    for integral in (0, 0.5):
        r = cut("[gap]\nservo_v = 22\nfeed_gain_mm_s_v = 0.002\n"
                f"integral_s = {integral}\n", "--trace", trace)
        assert r["outcome"] == "done"
        off.append(abs(mean_erode_v(trace) - 22))
    assert off[1] < off[0] / 2


def test_the_window_is_where_the_gap_works(cut, tmp_path):
    trace = tmp_path / "t.csv"
    v = []
    for high in (27, 33):
        cut(f"[gap]\nwindow_high_v = {high}\n", "--trace", trace)
        v.append(mean_erode_v(trace))
    assert 4 < v[1] - v[0] < 8


def test_jumps_come_by_depth(cut):
    never = "[gap]\narcing_share = 0\n[jump]\nevery_s = 86400\n"
    by_time = cut(never)
    by_depth = cut(never + "every_mm = 0.05\n")
    assert by_time["jumps"] == 0
    # 0.6 mm, less the air before it.
    assert 9 <= by_depth["jumps"] <= 12


def test_adaptive_jumps_keep_within_their_bounds(cut):
    r = cut("[jump]\nadaptive = yes\nevery_min_s = 1\nevery_max_s = 4\n")
    assert r["outcome"] == "done"
    assert r["erosion_s"] / 4 - 2 <= r["jumps"] <= r["erosion_s"] / 1


def test_arcs_are_answered_and_burn_less(cut):
    job = SINK.replace("G0 Z1\nZ0\n", "")  # no room to flush
    r = [cut(f"[gap]\narcing_share = {share}\n", job=job) for share in (0, 0.3)]
    assert r[0]["arcs"] == 0 and r[1]["arcs"] > 0
    assert r[1]["burns"] < r[0]["burns"]


def test_a_wire_never_jumps_and_retracts_by_micrometres(cut):
    r = cut("[gap]\nprocess = wire\nwire_retract_mm = 0.1\n"
            "[jump]\nevery_mm = 0.01\n[sim]\nbridge_mm = 0.02\n")
    assert r["outcome"] == "done" and r["jumps"] == 0
    assert r["retracts"] > 0 and r["retract_mm_max"] <= 0.1 + 1e-6


def test_a_wire_that_breaks_is_held_back_from_the_break(tmp_path):
    machine, trace = tmp_path / "m.ini", tmp_path / "t.csv"
    machine.write_text("[gap]\nprocess = wire\nwire_retreat_mm = 0.05\n"
                       "[sim]\nprocess = wire\nbreak_per_j = 1\n")
    r = run("--machine", machine, "--report", "-", "--trace", trace,
            text="G21 G90 F60\nT84\nG0 X1\nG1 X3\nM2\n")
    assert r.returncode == 1
    assert json.loads(r.stdout)["fault"] == "wire-broken"
    places = [float(row.split(",")[2])
              for row in trace.read_text().splitlines()[1:]]
    assert max(places) - places[-1] == pytest.approx(0.05, abs=0.002)


def test_each_way_back_ends_with_its_own_alarm(tmp_path):
    machine = tmp_path / "m.ini"
    job = SINK.replace("G1 Z-0.6", "G1 Z-0.2\nZ-0.6")
    faults = []
    for keys in ("retract_limit_mm = 0.05", "retract_to = motion",
                 "retract_to = start", "retract_max_s = 0.01",
                 "abort_count = 1"):
        machine.write_text("[sim]\nbridge_per_s = 100\nbridge_mm = 10\n"
                           "bridge_settle_s = 1000\ndebris_per_mm = 1000\n"
                           f"[gap]\n{keys}\n")
        r = run("--machine", machine, "--report", "-", text=job)
        assert r.returncode == 1
        faults.append(json.loads(r.stdout)["fault"])
    assert faults == ["short-not-cleared", "retract-at-start",
                      "retract-at-start", "retract-time", "retract-count"]


def test_a_window_upside_down_is_refused_with_its_line(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[gap]\nwindow_low_v = 15\nwindow_high_v = 12\n")
    r = run("--machine", machine, text=SINK)
    assert r.returncode == 78
    assert b"m.ini:3: error: gap.window_low_v 15 V is not at most " \
           b"window_high_v 12 V" in r.stderr


def test_the_tuning_table_has_the_time_of_the_whole_run(tmp_path):
    """Its first row is the example as it is."""
    with subprocess.Popen([ROOT / "docs" / "tuning"], text=True,
                          stdout=subprocess.PIPE,
                          env=os.environ | {"EDM_BUILD": BUILD,
                                            "TMPDIR": str(tmp_path)}) as p:
        row = [p.stdout.readline() for _ in range(3)][-1]
        p.terminate()
    r = report("--machine", ROOT / "examples" / "machine.ini", "--seed", 1,
               text=(ROOT / "examples" / "cavity.ngc").read_text())
    assert row == (
        f"| none | {r['virtual_s']:.1f} | {r['retracts']} | "
        f"{r['retract_mm_max']:.3f} | {r['jumps']} | "
        f"{r['removal_mm3_min']:.2f} | {r['outcome']} |\n")
