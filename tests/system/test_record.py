# SPDX-License-Identifier: Apache-2.0
"""edmctl record: the cycles of a job as a CSV, and a picture of it."""

import csv
import subprocess
import time

from rig import BUILD, QUICK_JOB, SLOW_JOB


def recorder(machine, *args):
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "record", *args],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )
    time.sleep(0.3)
    assert p.poll() is None
    return p


def rows(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def test_a_job_is_recorded_to_its_end_and_drawn(machine):
    trace, picture = machine.folder / "t.csv", machine.folder / "t.png"
    p = recorder(machine, str(trace), "--until-end", "--plot", str(picture))
    assert machine.client.submit(SLOW_JOB, "job").code == 0
    out, err = p.communicate(timeout=120)
    assert p.returncode == 0, err
    assert " 0 cycles lost; the job is done" in out

    got = rows(trace)
    axes = "X Y Z A B C U V".split()
    assert list(got[0]) == (
        "t_s line s_mm feed_mm_s gap_v state".split()
        + axes
        + [a + "_actual" for a in axes]
    )
    # What is measured was commanded the cycle before.
    for before, r in zip(got, got[1:]):
        assert r["X_actual"] == before["X"]
    t = [float(r["t_s"]) for r in got]
    assert t[0] == 0
    # Every cycle, none twice.
    assert all(abs(b - a - 0.001) < 1e-6 for a, b in zip(t, t[1:]))
    assert "travel" in {r["state"] for r in got}
    assert max(float(r["s_mm"]) for r in got) == 2
    assert float(got[-1]["X"]) == 2
    assert picture.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")


def test_one_cycle_of_ten_keeps_each_change_of_state(machine):
    trace = machine.folder / "t.csv"
    p = recorder(machine, str(trace), "--until-end", "--every", "10")
    assert machine.client.submit(QUICK_JOB, "job").code == 0
    out, err = p.communicate(timeout=120)
    assert p.returncode == 0, err
    got = rows(trace)
    t = [float(r["t_s"]) for r in got]
    for before, r in zip(got, got[1:]):
        if before["state"] == r["state"]:
            ms = round(float(r["t_s"]) * 1000)
            assert ms % 10 == 0 and ms - 1000 * float(before["t_s"]) < 10.01
    assert len(t) < 1.5 * t[-1] * 100


def test_a_stopped_job_exits_1(machine):
    trace = machine.folder / "t.csv"
    p = recorder(machine, str(trace), "--until-end")
    assert machine.client.submit(SLOW_JOB, "job").code == 0
    machine.client.status_where(lambda s: s.place_mm > 0.2)
    assert machine.client.ask("stop").code == 0
    out, _ = p.communicate(timeout=120)
    assert p.returncode == 1
    assert "the job was stopped" in out


def test_what_cannot_be_recorded_is_refused(machine):
    trace = str(machine.folder / "t.csv")
    assert machine.ctl("record").returncode == 64
    assert machine.ctl("record", trace, "--every", "0").returncode == 64
    p = machine.ctl("record", trace, "--plot", "x.jpg")
    assert p.returncode == 64
    assert ".png or .svg is wanted" in p.stderr
    assert machine.ctl("record", "/no/such/t.csv").returncode == 73
    machine.end("jobs")
    machine.end("edmd")
    assert machine.ctl("record", trace).returncode == 69
