# SPDX-License-Identifier: Apache-2.0
"""Contour: loops identified from a trace, gains found along a job."""
import json
import math
import os
import pathlib
import random
import re
import subprocess

import pytest
from edmsim import HANGS_S, PROGRAM, report, run

EDMCTL = os.path.join(os.path.dirname(PROGRAM), "edmctl")
AXES = "XYZABCUV"
HEADING = ("t_s,line,s_mm,feed_mm_s,gap_v,state," + ",".join(AXES)
           + "".join(f",{a}_actual" for a in AXES))

JOB = """G21 G90 G17
M3
G1 X10 F1000
G3 X10 Y10 J5
G1 X0
G2 X0 Y0 J-5
M2
"""

LOOPS = """[axis.X]
loop_gain_1_s = 30
friction_mm_s = 0.3
[axis.Y]
loop_gain_1_s = 21.5
friction_mm_s = 0.3
"""


def follow(target, gain, hz, damping=0.7, steps=20, seed=1):
    """An axis of its own making, in small steps: not the library's model."""
    rnd = random.Random(seed)
    w, dt = 2 * math.pi * hz, 0.001 / steps
    p = v = a = kick = 0.0
    direction, keeps, said = 0, math.exp(-dt / 0.02), []
    for at in target:
        said.append(round((p + rnd.gauss(0, 0.0005)) * 1000) / 1000)
        u = gain * (at - said[-1])
        for _ in range(steps):
            a += dt * (w * w * (u - v) - 2 * damping * w * a)
            v += dt * a
            p += dt * (v + kick)
            kick *= keeps
            now = (v > 0.01) - (v < -0.01) or direction
            if now != direction and direction:
                kick = -0.3 * now
            direction = now
    return said


def trace(path, x, y, measured=True, **more):
    columns = [x, y, follow(x, 30, 66, **more), follow(y, 21.5, 54, **more)]
    with open(path, "w") as f:
        f.write((HEADING if measured else HEADING[:HEADING.index("V,") + 1])
                + "\n")
        for k, (tx, ty, ax, ay) in enumerate(zip(*columns)):
            row = [f"{k / 1000:.3f}", 1, 0, 0, 0, "travel", tx, ty]
            row += [0] * 6
            if measured:
                row += [ax, ay] + [0] * 6
            f.write(",".join(map(str, row)) + "\n")


def curve(n=6000):
    t = [k / 1000 for k in range(n)]
    return ([3 * math.sin(4 * s) + 0.3 * math.sin(23 * s) for s in t],
            [2 * math.sin(5 * s) + 0.4 * math.sin(19 * s) for s in t])


def identify(*args):
    return subprocess.run([EDMCTL, "identify", *map(str, args)],
                          capture_output=True, text=True, timeout=HANGS_S)


def test_a_noisy_trace_tells_the_loops(tmp_path):
    trace(tmp_path / "t.csv", *curve())
    r = identify("--json", tmp_path / "t.csv")
    assert r.returncode == 0, r.stderr
    x, y = json.loads(r.stdout)
    assert (x["axis"], y["axis"]) == ("X", "Y")
    for d, gain, hz in (x, 30, 66), (y, 21.5, 54):
        assert abs(d["loop_gain_1_s"]["value"] / gain - 1) < 0.01
        assert abs(d["loop_hz"]["value"] / hz - 1) < 0.05
        assert abs(d["loop_damping"]["value"] / 0.7 - 1) < 0.05
        assert abs(d["friction_mm_s"]["value"] / 0.3 - 1) < 0.15
        assert "backlash_mm" not in d


def the_loops_are_told(stdout):
    for d, gain, hz in zip(json.loads(stdout), (30, 21.5), (66, 54)):
        truth = {"loop_gain_1_s": gain, "loop_hz": hz, "loop_damping": 0.7,
                 "friction_mm_s": 0.3, "friction_s": 0.02}
        assert set(truth) == {k for k in d if isinstance(d[k], dict)}
        for key, value in truth.items():
            assert abs(d[key]["value"] / value - 1) < 0.05, (d["axis"], key)


def test_the_program_for_it_tells_every_number_within_5_percent(tmp_path):
    job = pathlib.Path(PROGRAM).parents[1] / "examples" / "identify.ngc"
    assert run("--machine", job.with_name("machine.ini"), "--dry-run",
               "--trace", tmp_path / "set.csv", job).returncode == 0
    with open(tmp_path / "set.csv") as f:
        rows = [r.split(",") for r in f.readlines()[1:]]
    x, y = ([float(r[i]) for r in rows] for i in (6, 7))
    for seed in (1, 2):
        trace(tmp_path / "t.csv", x, y, seed=seed, steps=100)
        r = identify("--json", tmp_path / "t.csv")
        assert r.returncode == 0, r.stderr
        the_loops_are_told(r.stdout)


def test_what_identify_prints_is_a_machine_file(tmp_path):
    trace(tmp_path / "t.csv", *curve())
    r = identify(tmp_path / "t.csv")
    keys = [s for s in r.stdout.splitlines() if re.match(r"\[|\w+ = ", s)]
    machine, job = tmp_path / "m.ini", tmp_path / "j.ngc"
    machine.write_text("\n".join(keys) + "\n[contour]\nmethod = feedforward\n")
    job.write_text(JOB)
    assert run("--machine", machine, "--tune-contour", job).returncode == 0


def test_identify_shows_what_is_predicted_beside_what_was(tmp_path):
    trace(tmp_path / "t.csv", *curve())
    for ending, begins in ("png", b"\x89PNG"), ("svg", b"<?xml"):
        picture = tmp_path / ("p." + ending)
        r = identify(tmp_path / "t.csv", "--plot", picture)
        assert r.returncode == 0, r.stderr
        assert picture.read_bytes().startswith(begins)
    n = [float(x) for x in re.search(r"contour error, um: (.*)", r.stdout)[1]
         .translate({ord(c): " " for c in ",;"}).split()
         if x.replace(".", "").isdigit()]
    largest, mean, predicted, predicted_mean, off, off_mean = n
    assert largest > 100
    assert abs(predicted - largest) < 0.02 * largest
    assert off < 5 and off_mean < 1
    assert identify(tmp_path / "t.csv", "--plot", "p.pdf").returncode == 64


@pytest.mark.parametrize("what, told", [
    ("line", "does not excite the loops"),
    ("short", "too short"),
    ("still", "no axis could be identified"),
    ("targets", "no X_actual"),
    ("holes", "cycles are missing"),
])
def test_a_trace_that_tells_nothing_is_refused(tmp_path, what, told):
    path = tmp_path / "t.csv"
    x, y = curve(100 if what == "short" else 3000)
    if what in ("line", "still"):
        x = [k * 0.002 * (what == "line") for k in range(3000)]
        y = [0.0] * 3000
    trace(path, x, y, measured=what != "targets")
    if what == "holes":
        rows = path.read_text().splitlines(True)
        path.write_text("".join(rows[:1000] + rows[1010:]))
    r = identify(path)
    assert r.returncode == 65
    assert told in r.stderr
    assert r.stdout == ""


HEAD = HEADING + "\n"
ROW = "0.001,1,0,0,0,travel" + ",0" * 16 + "\n"
BAD = {
    "nul": ("\0" * 10, ":1:1: error: a NUL byte"),
    "text": ("a job\n", ":1:1: error: not the heading of a trace"),
    "endless": (HEAD + "1" * 5000, ":2:4096: error: a line that does not end"),
    "short": (HEADING.replace(",V,", ",") + "\n", ":1:1: error: not the head"),
    "columns": (HEAD + ROW.replace(",0,0,0\n", "\n"), ":2:47: error: nothing"),
    "nan": (HEAD + ROW.replace("travel,0", "travel,nan"),
            ":2:22: error: nan"),
    "huge": (HEAD + ROW.replace("travel,0", "travel,1e300"),
             ":2:22: error: 1e300"),
    "binary": (HEAD + "\x7fELF\x01\n", ":2:1: error: ?ELF?"),
    "state": (HEAD + ROW.replace("travel", "asleep"), ":2:15: error: asleep"),
    "time": (HEAD + 2 * ROW, ":3: error: its time does not rise"),
    "empty": ("", ":1:1: error: an empty file"),
    "rows": (HEAD, "no two rows"),
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_no_trace_is_refused_with_its_place(tmp_path, what):
    text, told = BAD[what]
    (tmp_path / "t.csv").write_text(text)
    r = identify(tmp_path / "t.csv")
    assert (r.returncode, r.stdout) == (65, "")
    assert told in r.stderr and len(r.stderr) < 600, r.stderr


def test_a_file_without_end_is_refused_at_once(tmp_path):
    for path, code in ("/dev/zero", 65), ("/dev/urandom", 65), (tmp_path, 66):
        r = identify(path)
        assert (r.returncode, r.stdout) == (code, ""), r.stderr


def test_of_a_trace_without_end_the_first_rows_are_used(tmp_path):
    # An axis that jumps to and fro: refused as such, but with an end.
    script = ('BEGIN { print h; for (k = 1; k < 1e9; k++) '
              'printf "%.3f,1,0,0,0,travel,%d,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\\n",'
              ' k / 1000, 0 }')
    awk = subprocess.Popen(["awk", "-v", "h=" + HEADING, script],
                           stdout=subprocess.PIPE)
    r = subprocess.run([EDMCTL, "identify", "/dev/stdin"], stdin=awk.stdout,
                       capture_output=True, text=True, timeout=HANGS_S)
    awk.kill()
    awk.wait()
    assert r.returncode == 65
    assert "only the first 1048576 rows are used" in r.stderr
    assert "no axis could be identified" in r.stderr


def tune(tmp_path, machine, *args):
    (tmp_path / "m.ini").write_text(machine)
    (tmp_path / "j.ngc").write_text(JOB)
    return run("--machine", tmp_path / "m.ini", "--tune-contour", *args,
               tmp_path / "j.ngc")


def largest_um(text, what):
    return float(re.search(what + r": ([\d.]+) um largest", text)[1])


def test_tuning_tells_how_far_it_is(tmp_path):
    (tmp_path / "m.ini").write_text(LOOPS + "[contour]\nmethod = feedforward\n")
    (tmp_path / "j.ngc").write_text(JOB)
    r = subprocess.run([PROGRAM, "--machine", tmp_path / "m.ini",
                        "--tune-contour", "--budget", "40",
                        tmp_path / "j.ngc"], capture_output=True, text=True)
    assert r.returncode == 0, r.stderr
    told = [s.split(",")[0].strip() for s in r.stderr.splitlines()]
    assert told == ["20 of 40 trials", "40 of 40 trials"]
    assert run("--budget", "40", text=JOB).returncode == 64


@pytest.mark.parametrize("method", ["none", "zpetc"])
def test_a_method_without_gains_is_refused(tmp_path, method):
    r = tune(tmp_path, LOOPS + f"[contour]\nmethod = {method}\n")
    assert (r.returncode, r.stdout) == (65, b"")
    assert f"[contour] method = {method} has no gains".encode() in r.stderr
    assert b"feedforward, cross-coupled or predictive, joined by +" in r.stderr


ARC = "G21 G90 G17 F1000\nG1 X10\nG3 X0 Y10 I-10\nM2\n"
SAME = """G21 G90 G17 F1000
G1 X10
G6.2 P3 K0 X10 Y0
K0 Y10 R0.7071067811865476
K0 X0
K1
K1
K1
M2
"""


def test_a_curve_is_followed_as_the_arc_that_it_is(tmp_path):
    (tmp_path / "m.ini").write_text(LOOPS)
    arc, same = (report("--dry-run", "--machine", tmp_path / "m.ini", text=t)
                 for t in (ARC, SAME))
    for key in ("contour_um_max", "contour_um_mean"):
        assert same[key] == pytest.approx(arc[key], rel=0.02), key


def test_tuned_gains_beat_those_before(tmp_path):
    gains = ("[contour]\nmethod = feedforward+cross-coupled\nspeed = 0.9\n"
             "cross_1_s = 20\n")
    r = tune(tmp_path, LOOPS + gains)
    assert r.returncode == 0, r.stderr
    text = r.stdout.decode()
    alone = largest_um(text, "position loops alone")
    before = largest_um(text, "the gains it has")
    found = largest_um(text, "these gains")
    assert alone > 100
    assert found < before / 2 and found < alone / 30
    # What it prints is what it takes, and means the same again.
    again = tune(tmp_path, LOOPS + text[text.index("[contour]"):])
    assert abs(largest_um(again.stdout.decode(), "the gains it has")
               - found) < 0.1 * found


def test_a_dry_run_reports_the_contour_error_of_the_models(tmp_path):
    job = tmp_path / "j.ngc"
    job.write_text(JOB)

    def reported(machine):
        (tmp_path / "m.ini").write_text(machine)
        return report("--machine", tmp_path / "m.ini", "--dry-run", job)

    alone = reported(LOOPS)
    assert 100 < alone["contour_um_max"] < 300
    assert 10 < alone["contour_um_mean"] < alone["contour_um_max"]
    fed = reported(LOOPS + "[contour]\nmethod = feedforward\n")
    assert fed["contour_um_max"] < alone["contour_um_max"] / 10
    assert "contour_um_max" not in reported("")
    assert "contour_um_max" not in reported(LOOPS[:LOOPS.index("[axis.Y]")])


SWINGS = LOOPS.replace("21.5", "900")


def test_of_loops_that_swing_no_contour_error_is_told(tmp_path):
    (tmp_path / "m.ini").write_text(SWINGS)
    told = report("--machine", tmp_path / "m.ini", "--dry-run", text=JOB)
    assert "contour_um_max" not in told


@pytest.mark.parametrize("machine, code, told", [
    ("[contour]\nmethod = feedforward\n", 65, "loop_gain_1_s"),
    (LOOPS, 65, "method = none"),
    (SWINGS + "[contour]\nmethod = feedforward\n", 65,
     "[axis.Y] loop_gain_1_s = 900 swings of itself; below"),
    (LOOPS + "[contour]\nmethod = zpetc\n", 65, "no gains"),
    (LOOPS + "[contour]\nmethod = twin\n", 78, "contour.method twin"),
    (LOOPS + "[contour]\nmethod = twin+feedforward\n", 78, "zpetc joined"),
    (LOOPS + "[contour]\nmethod = feedforward+zpetc\n", 78, "not together"),
    (LOOPS + "[contour]\nmethod = magic\n", 78, "cross-coupled"),
])
def test_what_cannot_be_tuned_is_refused(tmp_path, machine, code, told):
    r = tune(tmp_path, machine)
    assert r.returncode == code
    assert told in r.stderr.decode()
    assert b"speed =" not in r.stdout


SIMULATED = "[sim]\nloops = yes\nmeasure_pulses = 0.5\n" + "".join(
    f"[axis.{a}]\npresent = no\n" for a in "ZABCUV") + LOOPS
SQUARE = """G21 G90 G17 F1000
G1 X8
G3 X10 Y2 J2
G1 Y8
G3 X8 Y10 I-2
G1 X0
G3 X-2 Y8 J-2
G1 Y2
G3 X0 Y0 I2
M2
"""


def in_the_cycle(tmp_path, method, *args):
    (tmp_path / "m.ini").write_text(
        SIMULATED + f"[contour]\nmethod = {method}\ncross_1_s = 90\n")
    return report("--machine", tmp_path / "m.ini", "--dry-run", *args,
                  text=SQUARE)


def test_the_cycle_leads_axes_that_lag(tmp_path):
    found = {m: in_the_cycle(tmp_path, m)["contour_um_max"] for m in
             ("none", "feedforward", "cross-coupled",
              "feedforward+cross-coupled")}
    assert found["none"] > 100
    assert found["cross-coupled"] < found["none"] / 3
    assert found["feedforward"] < found["none"] / 10
    assert found["feedforward+cross-coupled"] < found["feedforward"]


def test_what_it_sends_ends_on_the_path(tmp_path):
    trace = tmp_path / "t.csv"
    in_the_cycle(tmp_path, "feedforward+cross-coupled", "--trace", trace)
    rows = [r.split(",") for r in trace.read_text().splitlines()]
    x, sent = rows[0].index("X"), rows[0].index("X_sent")
    led = [abs(float(r[sent]) - float(r[x])) for r in rows[1:]]
    assert 0.3 < max(led) < 80 / 30
    assert led[-1] < 0.05          # it brakes to the end of the job
    assert rows[-1][x] == "0"


def test_a_drawn_trace_may_have_what_was_sent(tmp_path):
    in_the_cycle(tmp_path, "feedforward", "--plot", tmp_path / "t.png")
    assert (tmp_path / "t.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("method, told", [
    ("predictive", "the cycle knows"), ("zpetc", "feedforward+cross-coupled"),
    ("feedforward+predictive", "the cycle knows"),
    # Nothing of edmd corrects set values beforehand.
    ("twin", "none, or of feedforward"),
])
def test_what_the_cycle_has_not_is_refused_where_it_leads(tmp_path, method,
                                                         told):
    (tmp_path / "m.ini").write_text(
        SIMULATED + f"[contour]\nmethod = {method}\n")
    r = run("--machine", tmp_path / "m.ini", "--dry-run", text=SQUARE)
    assert r.returncode == 78
    assert told in r.stderr.decode()
    edmd = os.path.join(os.path.dirname(PROGRAM), "edmd")
    r = subprocess.run([edmd, "--config", str(tmp_path / "m.ini"), "--check"],
                       capture_output=True, text=True, timeout=HANGS_S)
    assert r.returncode == 78
    line = 1 + (tmp_path / "m.ini").read_text().splitlines().index(
        f"method = {method}")
    assert f"m.ini:{line}:" in r.stderr and told in r.stderr
