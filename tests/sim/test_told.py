# SPDX-License-Identifier: Apache-2.0
"""What edmsim says of itself: hunting, what stands, what has no effect."""
import json
import re
import subprocess

import pytest

from edmsim import HANGS_S, PROGRAM, ROOT, run

MACHINE = (ROOT / "examples/machine.ini").read_text()
CAVITY = ROOT / "examples/cavity.ngc"


def with_keys(path, **keys):
    text = MACHINE
    for key, value in keys.items():
        text, n = re.subn(rf"(?m)^{key} = \S+", f"{key} = {value}", text)
        assert n == 1, key
    path.write_text(text)
    return path


def said(*args):
    return subprocess.run([PROGRAM, *map(str, args)], capture_output=True,
                          text=True, timeout=HANGS_S)


def test_a_servo_that_hunts_says_so_and_what_to_change(tmp_path):
    hunts = with_keys(tmp_path / "m.ini", servo_v=9, feed_gain_mm_s_v=2,
                      feed_max_mm_s=3, every_s=60)
    r = said("--machine", hunts, "--limit-s", 30, CAVITY)
    assert re.search(r"(?s)hunting +warning: \d+ times .*Raise\s+\[gap\] "
                     r"servo_v \(9; short_v is 8\).*--tune", r.stdout)
    r = json.loads(run("--machine", hunts, "--limit-s", 30, "--report", "-",
                       CAVITY).stdout)
    assert r["hunts"] > 0 and r["retracts_in_row_max"] >= 20


def test_one_that_does_not_says_nothing():
    r = said("--machine", ROOT / "examples/machine.ini", "--limit-s", 60,
             CAVITY)
    assert "hunting" not in r.stdout and "erosion" in r.stdout


@pytest.mark.parametrize("period_us", [50, 1000, 20000])
def test_a_run_ends_by_its_limit_or_its_end(tmp_path, period_us):
    job = tmp_path / "job.ngc"
    job.write_text("G91 F6000\nG1 X-2.084 Y3.542\nG1 X0.003 Y0.001\n"
                   "G1 X0.009 Y0.012\nG1 X-2.132 Y1.480\n"
                   "G1 X-0.264 Y0.363\nG1 X-1.520 Y-1.520\nM2\n")
    r = json.loads(run("--dry-run", "--there-and-back", "--period-us",
                       period_us, "--limit-s", 10, "--report", "-",
                       job).stdout)
    assert r["outcome"] == "done" and r["virtual_s"] < 3


def test_a_method_without_axes_that_lag_is_told(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text(MACHINE + "\n[contour]\nmethod = feedforward\n")
    r = said("--machine", machine, "--dry-run", CAVITY)
    assert "method feedforward has no effect" in r.stderr
    assert "[sim] loops = yes" in r.stderr


def test_the_trace_has_what_was_measured(tmp_path):
    machine, trace = tmp_path / "m.ini", tmp_path / "t.csv"
    machine.write_text(MACHINE + "\n[sim]\nlag_s = 0.02\n"
                       if "[sim]" not in MACHINE else
                       MACHINE.replace("[sim]", "[sim]\nlag_s = 0.02", 1))
    run("--machine", machine, "--limit-s", 5, "--trace", trace, CAVITY)
    head, *rows = [r.split(",") for r in trace.read_text().splitlines()]
    sent, is_ = head.index("Z_sent"), head.index("Z_is")
    off = [abs(float(r[sent]) - float(r[is_])) for r in rows]
    assert 0.1 < max(off) < 10     # it lags behind
    assert len(head) == len(rows[0])


@pytest.mark.parametrize("option", ["--trace", "--pulses", "--report"])
def test_a_full_disk_is_named(option):
    r = said("--machine", ROOT / "examples/machine.ini", "--quiet", "--dry-run",
             option, "/dev/full", CAVITY)
    assert r.returncode != 0
    assert "/dev/full: No space left on device" in r.stderr, r.stderr
