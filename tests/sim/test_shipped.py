# SPDX-License-Identifier: Apache-2.0
"""What is shipped works at the first try: machine files, and their jobs.

EDM_RUNS=100, as `make shipped` sets it, tries so many seeds of each; three
otherwise, of those that take no longer than a second.
"""
import json
import os
import random
import re
import resource
import subprocess
from pathlib import Path

import pytest

from edmsim import HANGS_S, PROGRAM, ROOT, done, run

EXAMPLES = ROOT / "examples"
JOBS = [("machine.ini", "cavity"), ("machine.ini", "orbit"),
        ("probe.ini", "probe"), ("wire.ini", "taper"),
        ("wire.ini", "wire-extrusion"), ("wire.ini", "wire-die"),
        ("wire.ini", "wire-gear"), ("wire.ini", "wire-plate"),
        ("five-axis.ini", "five-axis")]
QUICK = 4
RUNS = int(os.environ.get("EDM_RUNS", "0"))
FIRST = int(os.environ.get("EDM_SEED", "1"))


@pytest.mark.parametrize("machine, job", JOBS if RUNS else JOBS[:QUICK])
def test_a_shipped_job_is_done_on_its_machine(machine, job):
    bad = []
    for seed in range(FIRST, FIRST + (RUNS or 3)):
        r = run("--machine", EXAMPLES / machine, "--seed", seed, "--quiet",
                "--report", "-", EXAMPLES / f"{job}.ngc")
        outcome = json.loads(r.stdout)["outcome"] if r.stdout else r.stderr
        if outcome != "done":
            bad.append((seed, outcome))
    assert bad == []


def test_the_readme_shows_what_its_command_prints(tmp_path):
    """A line may end with "...": what follows depends on the host."""
    readme = (ROOT / "README.md").read_text()
    command = re.search(r"^    build/(edmsim .* --plot .*)$", readme, re.M)
    shown = readme[command.end():].split("\n\n")[1].splitlines()
    words = [ROOT / w if w.startswith("examples/") else w
             for w in command.group(1).split()[1:]]
    printed = subprocess.run([PROGRAM, *words], cwd=tmp_path, text=True,
                             capture_output=True).stdout.splitlines()
    assert len(printed) == len(shown) > 1
    for told, line in zip(shown, printed):
        told = told.strip()
        assert (line.startswith(told[:-3]) if told.endswith("...")
                else line == told), line


# To start from.  Each is understood, and has the backend that its name says.
START = {"machine-gpio.ini": "gpio", "machine-gpio-generator.ini": "gpio",
         "machine-modbus.ini": "gpio",
         "machine-can402.ini": "can402", "machine-can402-lines.ini": "can402",
         "machine-wire.ini": "gpio", "machine-five-axis.ini": "null",
         "template.ini": "null"}


@pytest.mark.parametrize("name", START)
def test_a_file_to_start_from_is_understood(name):
    assert f"\nbackend = {START[name]}" in (EXAMPLES / name).read_text()
    done("--machine", EXAMPLES / name, "--check",
         text="G21 G90 G0 X5.\nG1 Y5. F10\nM2\n")


CALLS = "G21 G90 T84\nM4\nG0 Z0\nF30\nC120\nG1 Z-2.\nC200\nG1 Z-3.\nM2\n"


def test_a_condition_that_does_not_reach_the_generator_is_refused(tmp_path):
    table = EXAMPLES / "copper-steel.tech"
    p = run("--machine", EXAMPLES / "machine-gpio.ini", "--tech", table,
            "--check", text=CALLS)
    assert p.returncode == 78
    assert f"{table}:20:1: error: C100: peak_a 6 A does not reach" in p.stderr.decode()
    assert "[generator] by_hand = peak_a" in p.stderr.decode()
    p = run("--machine", EXAMPLES / "machine-gpio.ini", "--check",
            text=CALLS)
    assert p.returncode == 65
    assert b"-:1:9: error: the pump, which nothing switches on" in p.stderr
    p = run("--machine", EXAMPLES / "machine-gpio.ini", "--check",
            text=CALLS.replace(" T84", ""))
    assert p.returncode == 65
    assert b"-:2:1: error: a negative electrode: polarity -1" in p.stderr


def test_edmd_refuses_it_too(tmp_path):
    edmd = Path(PROGRAM).parent / "edmd"
    text = (EXAMPLES / "machine-gpio.ini").read_text()
    (tmp_path / "m.ini").write_text(
        f"{text}\n[tech]\ntable = {EXAMPLES}/copper-steel.tech\n")
    p = subprocess.run([edmd, "--check", "--config", tmp_path / "m.ini"],
                       capture_output=True)
    assert p.returncode == 78
    assert "copper-steel.tech:20:1" in p.stderr.decode()
    assert "peak_a 6 A does not reach the generator" in p.stderr.decode()


@pytest.mark.parametrize("name, calls", [
    ("machine-gpio-generator.ini", CALLS),
    ("machine-modbus.ini", CALLS.replace(" T84", "")),
    ("machine-can402.ini", CALLS), ("machine-can402-lines.ini", CALLS)])
def test_a_generator_has_the_conditions_of_the_table(name, calls):
    done("--machine", EXAMPLES / name, "--check", text=calls)
    p = run("--machine", EXAMPLES / name, "--check",
            text="G21 G90\nC120 M3\nG80 Z-\nM2\n")
    assert p.returncode == 0, p.stderr
    edmd = Path(PROGRAM).parent / "edmd"
    p = subprocess.run([edmd, "--check", "--config", EXAMPLES / name],
                       capture_output=True)
    assert p.returncode == 0, p.stderr


# What is told of a generator, and what comparators show, is simulated too; so a
# forecast is of the same machine.
@pytest.mark.parametrize("name", ["machine-gpio-generator.ini",
                                  "machine-modbus.ini", "machine-can402.ini",
                                  "machine-wire.ini"])
def test_the_file_of_a_real_machine_is_simulated(name):
    text = "G21 G90\nC120 M3\nF30\nG1 Y0.1\nC110\nG1 Y0.15\nM2\n"
    if name == "machine-wire.ini":
        text = text.replace("C120 M3", "").replace("C110", "")
    p = run("--machine", EXAMPLES / name, "--quiet", "--report", "-",
            text=text)
    report = json.loads(p.stdout)
    assert report["outcome"] == "done", p.stderr
    assert report["erosion_s"] > 0 and report["removed_mm3"] > 0, report


@pytest.mark.parametrize("name, job", [("machine-wire.ini", "taper"),
                                       ("machine-five-axis.ini", "five-axis")])
def test_one_of_a_kind_takes_the_jobs_of_its_kind(name, job):
    done("--machine", EXAMPLES / name, "--check", EXAMPLES / f"{job}.ngc")


def test_a_wire_machine_with_defaults_alone_cuts(tmp_path):
    (tmp_path / "m.ini").write_text("[gap]\nprocess = wire\n")
    for seed in (1, 2, 3):
        r = run("--machine", tmp_path / "m.ini", "--seed", seed, "--quiet",
                "--report", "-", text="G21 G90 F60\nG1 X3.\nY2.\nM2\n")
        r = json.loads(r.stdout)
        assert r["outcome"] == "done"
        assert r["shorts"] < 400


# The least and the most that the values of the machine file's defaults do in
# five kinds of work; docs/gap-servo.md has the table.
KINDS = {"shallow-open": (23, 5), "deep-poor-flushing": (5, 250),
         "large-area": (200, 5), "fine-finish": (1.5, 5),
         "arcing-steel": (27, 10)}


@pytest.mark.parametrize("kind", KINDS)
def test_the_defaults_sink_into_five_kinds_of_work(kind, tmp_path):
    text = (ROOT / f"tests/experiments/conditions/{kind}.ini").read_text()
    (tmp_path / "m.ini").write_text("\n".join(
        x for x in text.splitlines()
        if not x.startswith(("servo_v", "feed_gain"))))
    r = run("--machine", tmp_path / "m.ini", "--seed", 101, "--limit-s", 60,
            "--quiet", "--report", "-", ROOT / "tests/experiments/sink.ngc")
    r = json.loads(r.stdout)
    least_mm3, most_shorts = KINDS[kind]
    assert r["removed_mm3"] > least_mm3 and r["shorts"] <= most_shorts, r


# -- edmctl new-machine


def new_machine(path, answers, **more):
    return subprocess.run(
        [PROGRAM[:-len("edmsim")] + "edmctl", "new-machine", path], text=True,
        input="".join(f"{a}\n" for a in answers), capture_output=True,
        timeout=60, **more)


@pytest.mark.parametrize("backend", ["", "null", "sim", "gpio", "can402"])
@pytest.mark.parametrize("kind", ["sinker", "wire"])
def test_a_machine_file_comes_of_answers(tmp_path, kind, backend):
    path = tmp_path / "new.ini"
    p = new_machine(path, ["shop-2", kind, backend] + 100 * [""])
    assert p.returncode == 0, p.stderr
    assert f"\nname = shop-2\nbackend = {backend or 'null'}\n" in \
        path.read_text()
    done("--machine", path, "--check", text="G21 G90 G0 X5. Y5.\nM2\n")
    if backend == "sim":
        assert run("--machine", path, "--limit-s", 600,
                   text="G21 G90 F30\nG1 X1. Z-0.2\nM2\n" if kind == "sinker"
                   else "G21 G90 F30\nG1 X1.\nM2\n").returncode == 0


def test_answers_are_judged_and_asked_for_again(tmp_path):
    path = tmp_path / "new.ini"
    p = new_machine(path, [
        "a b", 400 * "m", "m", "lathe", "sinker wire", "sinker", "pneumatic", "gpio", "XY", "XXZ", "xz",
        "10", "5 -5", "-5 5 7", "-5 5", "0", "2", "fast", "2.5",
        "-20 -1", "1", "4", "chip ; 9", "chip9", "1", "1 x", "3 4", "5 6", "klingon",
        "linuxcnc", "magic", "switch", "up", "-", "-5", "11", "!12"] + 30 * [""])
    assert p.returncode == 0, p.stderr
    text = path.read_text()
    for said in ("1 to 31 of A-Z", "one of sinker wire", "one of null sim",
                 "a sinker machine has Z", "the lower one first",
                 "2 numbers", "one of generic linuxcnc",
                 "letters, digits and", "one of none switch", "one of - +"):
        assert said in p.stderr, said
    assert "[axis.X]\npulse_mm = 0.002\ntravel_min_mm = -5\n" in text
    assert "[axis.Z]\npulse_mm = 0.001\ntravel_min_mm = -20\n" \
        "travel_max_mm = -1\n" in text and "start_mm = -10.5" in text
    assert "home_method = switch\nhome_at_mm = -5\nhome_dir = -" in text
    assert "home_X = 11\nlimit_X = !12\n" in text
    assert "step_Z = 5\ndir_Z = 6" in text and "chip = chip9" in text
    done("--machine", path, "--check", text="G21 G90 G0 X5.\nM2\n")


def test_gap_generator_joints_and_wire_are_asked_for(tmp_path):
    path = tmp_path / "new.ini"
    axis = ["", "", ""]
    p = new_machine(path, [
        "m", "sinker", "can402", "ZC"] + 2 * axis + ["can1", "1", "", "", "2",
        "", "", "", "absolute", "7", "", "389", "modbus", "192.168.1.5:502", "",
        "C(0 0 -120) X Y Z"])
    # No line ends the sparks yet.
    assert p.returncode == 78 and "spark = line N" in p.stderr
    text = path.read_text()
    for part in ("home_method = absolute\nhome_at_mm = 7\n",
                 "gap_id = 389\n", "source = can\n",
                 "interface = modbus\nmodbus = 192.168.1.5:502\n",
                 "chain = C(0 0 -120) X Y Z\n"):
        assert part in text, part
    path.unlink()
    p = new_machine(path, ["m", "wire", "sim", ""] + 4 * axis + [""]
                    + 4 * [""] + ["-30 90 25"])
    assert p.returncode == 0, p.stderr
    assert "z_lower_mm = -30\nz_upper_mm = 90\nz_second_mm = 25" in \
        path.read_text()


def test_what_edmd_refuses_is_told_by_who_writes_it(tmp_path):
    """Answers that are good one by one."""
    path = tmp_path / "new.ini"
    p = new_machine(path, ["m", "sinker", "gpio", "Z"] + 4 * [""] + ["3 3"]
                    + 30 * [""])
    assert p.returncode == 78
    assert "new.ini:" in p.stderr and "are both line 3" in p.stderr
    assert "mend that line" in p.stderr and path.exists()


def test_random_answers_become_files_that_edmd_takes_or_are_told(tmp_path):
    draw = random.Random(int(os.environ.get("EDM_SEED", "1")))
    path = tmp_path / "new.ini"
    seen = set()
    for _ in range(60):
        axes = draw.sample("XYZABCUV", draw.randint(3, 8))
        answers = ["m", draw.choice(["sinker", "wire"]),
                   draw.choice(["null", "sim", "gpio", "can402"]),
                   "".join(sorted({*axes, *"XYZ"}))]
        for _ in answers[3]:
            answers += [draw.choice(["", "-1 1", "5 20", "-100000 100000"]),
                        draw.choice(["", "0.001", "1000", "2.5"]),
                        draw.choice(["", "0.001", "100000", "1000"])]
        p = new_machine(path, answers + 60 * [""])
        good = subprocess.run(
            [PROGRAM, "--machine", path, "--print-config"],
            capture_output=True, timeout=HANGS_S).returncode == 0
        assert p.returncode == (0 if good else 78), p.stderr
        seen.add(good)
        path.unlink()
    assert seen == {True, False}


def test_half_a_file_is_not_left(tmp_path):
    path = tmp_path / "new.ini"
    p = new_machine(path, 100 * [""], restore_signals=False,
                    preexec_fn=lambda: resource.setrlimit(
                        resource.RLIMIT_FSIZE, (64, 64)))
    assert p.returncode == 73 and "File too large" in p.stderr
    assert not path.exists()


def test_nothing_is_written_without_all_answers(tmp_path):
    path = tmp_path / "new.ini"
    p = new_machine(path, ["m", "wire"])
    assert p.returncode == 66 and "nothing is written" in p.stderr
    assert not path.exists()
    for where in (tmp_path / "no" / "such.ini", "/dev/full/x"):
        p = new_machine(where, 100 * [""])
        assert p.returncode == 73 and str(where) in p.stderr
    path.write_text("mine")
    p = new_machine(path, 100 * [""])
    assert p.returncode == 73 and "there already" in p.stderr
    assert path.read_text() == "mine"
