# SPDX-License-Identifier: Apache-2.0
"""On a PREEMPT_RT kernel with two CPUs: what depends on no timing."""
import collections
import itertools
import math
import os
import pathlib
import subprocess
import sys
import time

import pytest
from boot import BUILD_VM, HERE


def test_the_kernel_is_preempt_rt(plain):
    assert "PREEMPT_RT" in plain.text("uname")
    assert plain.text("realtime").strip() == "1"


def test_the_kernel_has_nothing_to_complain_of(plain):
    assert plain.text("kernel") == ""


@pytest.mark.parametrize("machine", ["null", "sim"])
def test_a_job_sent_by_a_client_is_done(plain, machine):
    assert plain.text(f"smoke-{machine}.rc") == "0\n", \
        plain.text(f"smoke-{machine}") + plain.text(f"smoke-{machine}.log")
    assert plain.text(f"smoke-{machine}.edmd-rc") == "0\n"


@pytest.mark.parametrize("library", ["", "2"])
@pytest.mark.parametrize("what, code, found, mend", [
    ("no-chip", 78, "gpio.step_X: chip sim7: No such file", "gpiodetect"),
    ("no-line", 78, "gpio.pump: line 32 of sim0, which has 32", "0 to 31"),
    ("busy", 69, "gpio.pump: line 6 of sim0 is in use by gpioset",
     "gpioinfo"),
    ("rights", 77, "gpio.step_X: chip sim0: Permission denied",
     "usermod -aG gpio"),
])
def test_what_it_cannot_have_is_refused_with_line_and_remedy(
        plain, library, what, code, found, mend):
    text = plain.text(f"{what}.txt{library}")
    assert found in text and mend in text
    assert plain.text(f"{what}.rc{library}") == f"{code}\n"


def test_doctor_tells_how_fast_a_line_goes(plain):
    """What it measures is this host's; here a write of 100 us is seldom kept."""
    text = plain.text("pulses")
    assert plain.text("pulses.rc") == "0\n", text
    assert "a write takes" in text and "100.00 us" in text, text
    assert "edges_per_period = " in text, text


# The levels of sim1:2 ... 7 in each condition: weights 3 6 and 12, which is low
# when it is on; the code of the on time; polarity.  16 A are 15.
LEVELS = {"C001": (0, 1, 1, 0, 1, 0), "C002": (1, 0, 0, 1, 0, 1),
          "C003": (1, 0, 0, 1, 1, 1)}


def lit(text, lines=range(2, 8), spark=0, pump=8, sense=9):
    """Each time with sparks: when it began, when it ended, and the levels of the
    lines, which stay as they are."""
    level, found = collections.Counter(), []
    for row in text.splitlines():
        t, line, value, _ = row.split()
        t, line, value = float(t), int(line), int(value)
        if line == spark and value > level[line]:
            assert level[pump] and not level[sense], row
            found.append([t, math.inf, tuple(level[i] for i in lines)])
        elif line == spark and value < level[line]:
            found[-1][1] = t
        elif value != level[line] and line in (*lines, pump, sense):
            assert not level[spark], row
        level[line] = value
    return found


def test_lines_of_a_generator_change_only_without_sparks(plain):
    assert plain.text("generator.rc") == "0\n", plain.text("generator")
    found = lit(plain.text("generator.trace"))
    changes = [b[0] - a[1] for a, b in zip(found, found[1:]) if a[2] != b[2]]
    assert [key for key, _ in itertools.groupby(f[2] for f in found)] == [
        LEVELS[c] for c in ("C001", "C002", "C003", "C001")], found
    # A change of polarity waits for polarity_ms, and settle_ms besides.
    for off_s, least_s in zip(changes, (0.15, 0.05, 0.15)):
        assert off_s >= least_s - 0.002, found


def test_the_voltage_to_feel_by_is_on_without_sparks_alone(plain):
    rows = [r.split() for r in plain.text("generator.trace").splitlines()]
    sense = [(float(t), level) for t, line, level, _ in rows if line == "9"]
    on = next(t for t, level in sense if level == "1")
    off = [t for t, level in sense if level == "0" and t > on]
    assert off, plain.text("feel")
    sparks = [float(t) for t, line, level, _ in rows if line == "0" and level == "1"]
    assert sparks and not any(on <= t <= off[-1] for t in sparks)


@pytest.mark.parametrize("when, spark", [
    ("approach", 1), ("erode", 1), ("retract", 0), ("e-stop", 0),
    ("limit-switch", 0), ("door", 0), ("dielectric", 0)])
def test_sparks_are_on_where_they_may_be(plain, when, spark):
    assert f"{when}: spark {spark}\n" in plain.text("switches"), \
        plain.text("switches") + plain.text("lost.log")


def test_a_lost_chip_ends_sparks_pulses_and_the_watchdog(plain):
    text = plain.text("lost")
    assert "before: spark 1\n" in text, text + plain.text("switches")
    assert "io-lost: spark 0\n" in text, text
    assert "watchdog moved 0\n" in text, text
    assert "io-lost" in plain.text("lost.log")


def test_a_machine_ends_with_who_started_it(tmp_path):
    """A test that is killed leaves no machine behind."""
    script = tmp_path / "script"
    script.write_text("sleep 3600\n")
    job = tmp_path / "job"
    job.mkdir()
    starts = ("import subprocess, sys\n"
              "subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL)\n")
    p = subprocess.Popen(
        [sys.executable, "-c", starts, HERE / "vm-run", "-t", "3600", job,
         script], env=os.environ | {"VM_BUILD": str(BUILD_VM)})
    pid = job / ".vm/pid"
    try:
        until(lambda: pid.exists() and pid.read_text().strip())
        machine = pathlib.Path("/proc", pid.read_text().strip())
        assert machine.exists()
    finally:
        p.kill()
        p.wait()
    until(lambda: not machine.exists())


def until(true, seconds=120):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.1)
