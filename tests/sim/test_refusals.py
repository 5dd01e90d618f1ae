# SPDX-License-Identifier: Apache-2.0
"""A bad input is refused with file, line, column, what was found and what
would be accepted; never by a crash, never slowly."""
import pathlib
import random
import re
import subprocess

import pytest
from edmsim import HANGS_S, PROGRAM, run

FORM = re.compile(r"^(?P<file>[^\n]*):(?P<line>\d+):(?P<column>\d+): error: "
                  r"(?P<found>[^\n]+?); (?P<wanted>[^\n]+)\n$")


def refused(tmp_path, data):
    job = tmp_path / "job.ngc"
    job.write_bytes(data if isinstance(data, bytes) else data.encode())
    r = run("--dry-run", job)
    assert r.returncode == 65, r.stderr
    assert r.stdout == b""
    told = FORM.match(r.stderr.decode())
    assert told, r.stderr
    assert told["file"] == str(job)
    return told


def nest(depth):
    text = ["G21 F60", "M98 P1", "M2"]
    for n in range(1, depth + 1):
        text += [f"O{n}", f"M98 P{n + 1}", "M99"]
    return "\n".join(text + [f"O{depth + 1}", "G91 G1 X1", "M99"])


@pytest.mark.parametrize("text, where, found", [
    ("", "1:1", "empty"),
    ("%\n%\n", "1:1", "empty"),
    ("(nothing here)\n", "1:1", "empty"),
    ("G21 F60\nG1 X1e999\n", "2:6", "an E right behind"),
    ("G21 F60\nG1 X--5\n", "2:4", "X--5"),
    ("G21 F60\nG1 Xnan\n", "2:4", "Xnan"),
    ("G21 F60\nG1 Xinf\n", "2:4", "Xinf"),
    ("G21 F60\nG1 X1.2.3\n", "2:8", "X1.2.3"),
    ("G21 F60\nG1 X\n", "2:4", "X"),
    ("G21 F60\nG1 X 1 2\n", "2:8", "without a letter"),
    ("G21 F60\nG2 X10 Y0 I3 J0\n", "2:4", "the arc starts"),
    ("G21 F60\nG2 X10 Y0\n", "2:1", "an arc without a centre"),
    ("G21 F60\nG2 X10 R2\n", "2:8", "a radius of 2"),
    ("G21 F60\nG1 X200.5\n", "2:4", "beyond the travel"),
    ("G21 F60\nG1 X1\nG1 Y-1 Z-2000\n", "3:8", "beyond the travel"),
    ("G21 F60\nG2 X0 Y0 I150 J0\n", "2:4", "beyond the travel"),
    ("G21 F0\nG1 X1\n", "1:5", "F0"),
    ("G21 F-5\nG1 X1\n", "1:5", "F-5"),
    ("G21\nG1 X1\n", "2:1", "no feed"),
    ("X5\n", "1:1", "no motion mode"),
    ("G21 F60 G33.1\n", "1:9", "G33.1"),
    ("G21 F60\nW12\n", "2:1", "W12"),
    ("G21 F60\nG1 X1 X2\n", "2:7", "second word X2"),
    ("G0 G1 X1 F60\n", "1:4", "G1 on a line with G0"),
    ("G21 F60\nG1 X1 (open\n", "2:7", "comment"),
    ("G21 F60\nM98 P1\nM2\nO1\nM98 P1\nM99\n", "5:5", "recursion"),
    ("G21 F60\nM98 P1\nM2\nO1\nM98 P2\nM99\nO2\nM98 P1\nM99\n", "8:5",
     "recursion"),
    ("G21 F60\nM98 P7\nM2\n", "2:5", "O7"),
    ("G21 F60\nM99\n", "2:1", "M99"),
    (b"G21 F60\nG1 X1\0\nX2\n", "2:6", "0x00"),
    ("G21 F60\nG1 X1 \u00e9\n", "2:7", "byte 0x"),
])
def test_bad_code_is_refused_where_it_stands(tmp_path, text, where, found):
    told = refused(tmp_path, text)
    assert f"{told['line']}:{told['column']}" == where
    assert found in told["found"]


def test_subprograms_nest_so_deep_and_no_deeper(tmp_path):
    assert "8" in refused(tmp_path, nest(9))["wanted"]
    job = tmp_path / "ok.ngc"
    job.write_text(nest(7))
    assert run("--dry-run", job).returncode == 0


def test_endless_repeats_are_refused_not_carried_out(tmp_path):
    text = ["G21 F60", "M98 P1 L9999", "M2"]
    for n in range(1, 8):
        text += [f"O{n}", f"M98 P{n + 1} L9999", "M99"]
    text += ["O8", "N1", "M99"]
    refused(tmp_path, "\n".join(text))


def test_ten_megabytes_of_noise_are_refused(tmp_path):
    for seed in range(3):
        refused(tmp_path, random.Random(seed).randbytes(10 << 20))


def test_a_line_of_a_megabyte_is_refused(tmp_path):
    told = refused(tmp_path, "G21 F60\nG1 X1" + " " * (1 << 20) + "Y1\n")
    assert told["line"] == "2" and "4096" in told["found"] + told["wanted"]
    refused(tmp_path, b"\xff" * (1 << 20))
    refused(tmp_path, "X1" * (1 << 19))


def test_what_is_no_file_is_refused_by_name(tmp_path):
    for what in tmp_path / "missing.ngc", tmp_path:
        r = run("--dry-run", what)
        assert r.returncode == 66
        assert str(what) in r.stderr.decode() and r.stdout == b""


def test_a_refused_job_leaves_no_files(tmp_path):
    for name in "--pulses", "--trace", "--report":
        r = run("--dry-run", name, tmp_path / "out", text="G1 X")
        assert r.returncode == 65 and not (tmp_path / "out").exists()


def test_random_words_end_in_an_answer(tmp_path):
    """Whatever the words, the program answers; it is never killed."""
    rnd = random.Random(4)
    words = ("G0 G1 G2 G3 G4 G17 G18 G19 G20 G21 G28 G53 G54 G90 G91 G92 "
             "M0 M3 M5 M98 M99 O1 P1 L2 I1 J-1 K0.5 R2 X1 Y-2 Z3 A45 C120 "
             "E001 U1 V-1 F100 F0 X1e5 Y. Z-").split()
    codes = set()
    for _ in range(400):
        text = "\n".join(" ".join(rnd.sample(words, rnd.randint(1, 5)))
                         for _ in range(rnd.randint(1, 6)))
        r = run("--dry-run", "--limit-s", 5, text="G21 F60\n" + text)
        assert r.returncode in (0, 1, 65), (r.returncode, text)
        codes.add(r.returncode)
    assert codes >= {0, 65}, PROGRAM


def told_in_time(*args, **more):
    return subprocess.run(list(map(str, args)), capture_output=True, text=True,
                          timeout=20, **more)


def test_a_picture_that_has_no_place_is_refused_before_the_job_runs(tmp_path):
    job = tmp_path / "job.ngc"
    job.write_text("G21 F60\nG1 X1\n")
    r = run("--dry-run", "--pulses", tmp_path / "pulses.csv", "--plot",
            tmp_path / "none" / "x.png", job)
    assert r.returncode == 73
    assert b"No such file" in r.stderr
    assert not (tmp_path / "pulses.csv").exists(), "it ran"


@pytest.mark.parametrize("program, args", [
    ("edmsim", ("--check", "-", "--machine")),
    ("edmd", ("--check", "--config")),
    ("edmd-jobs", ("--config",)),
])
def test_a_folder_is_no_machine_file(tmp_path, program, args):
    r = told_in_time(pathlib.Path(PROGRAM).with_name(program), *args, tmp_path,
                     input="")
    assert r.returncode in (66, 74)
    assert "Is a directory; a machine file" in r.stderr


def test_what_has_no_lines_is_no_trace():
    edmctl = pathlib.Path(PROGRAM).with_name("edmctl")
    r = told_in_time(edmctl, "identify", "/dev/zero")
    assert r.returncode != 0
    assert "error" in r.stderr


def test_a_row_without_an_end_is_refused_where_it_begins(tmp_path):
    trace = tmp_path / "t.csv"
    trace.write_text("t_s,line,s_mm,feed_mm_s,gap_v,state,X,Y,Z,A,B,C,U,V\n"
                     + "1" * 9000 + "\n")
    edmctl = pathlib.Path(PROGRAM).with_name("edmctl")
    r = told_in_time(edmctl, "identify", trace)
    assert r.returncode != 0
    assert f"{trace}:" in r.stderr


def test_a_negative_number_is_told_as_it_was_written():
    edmctl = pathlib.Path(PROGRAM).with_name("edmctl")
    r = told_in_time(edmctl, "retract", "-1")
    assert r.returncode == 64
    assert r.stderr.startswith("edmctl: retract -1: ")


@pytest.mark.parametrize("name", ["", "x" * 64])
def test_an_id_is_refused_not_cut_short(tmp_path, name):
    edmctl = pathlib.Path(PROGRAM).with_name("edmctl")
    r = told_in_time(edmctl, "submit", "x.ngc", "--id", name)
    assert r.returncode == 64
    assert f"--id of {len(name)} bytes; 1 to 63 of" in r.stderr


def test_a_url_of_another_kind_is_refused_as_one():
    edmctl = pathlib.Path(PROGRAM).with_name("edmctl")
    r = told_in_time(edmctl, "--url", "http://x", "status")
    assert r.returncode == 64
    assert "--url http://x; " in r.stderr


def test_a_file_that_is_no_database_is_set_aside_and_kept(tmp_path):
    jobs = pathlib.Path(PROGRAM).with_name("edmd-jobs")
    config = tmp_path / "m.ini"
    config.write_text("[machine]\nname = garbage\n")
    text = "not a database, whatever it is\n"
    (tmp_path / "garbage.db").write_text(text)
    p = subprocess.Popen([jobs, "--config", config, "--store", tmp_path],
                         stderr=subprocess.PIPE, text=True)
    told = next(line for line in p.stderr if "kept as" in line)
    p.terminate()
    p.communicate(timeout=HANGS_S)
    assert p.returncode == 0
    assert not list(pathlib.Path("/dev/shm").glob("edmd.garbage.*"))
    assert "0 jobs were recovered" in told
    kept = pathlib.Path(told.rsplit("kept as ", 1)[1].strip())
    assert kept.parent == tmp_path and kept.read_text() == text


def edmd_on_gpio(tmp_path, text):
    config = tmp_path / "m.ini"
    config.write_text(
        "[machine]\nbackend = gpio\nname = refused\n[jump]\nv_max_mm_s = 5\n"
        + "".join(f"[axis.{a}]\npresent = no\n" for a in "YZABCUV") + text)
    edmd = pathlib.Path(PROGRAM).with_name("edmd")
    return told_in_time(edmd, "--config", config)


def test_a_chip_there_is_not_leaves_nothing_in_shared_memory(tmp_path):
    r = edmd_on_gpio(tmp_path, "[axis.X]\nv_max_mm_s = 5\n"
                     "[gpio]\nchip = nochip\nstep_X = 1\ndir_X = 2\n")
    assert r.returncode == 78
    assert r.stderr.startswith("error: edmd: gpio.step_X: chip nochip: ")
    assert "gpiodetect" in r.stderr
    assert not list(pathlib.Path("/dev/shm").glob("edmd.refused.*"))


def test_defaults_against_each_other_have_no_line(tmp_path):
    r = edmd_on_gpio(tmp_path, "[gpio]\nstep_X = 1\ndir_X = 2\n")
    assert r.returncode == 78
    assert "/m.ini: error: axis.X.v_max_mm_s 80 mm/s is faster" in r.stderr


@pytest.mark.parametrize("text, line", [
    ("G90 G1 X2. F5\n%\nX5.\nM2\n", 2), ("O0007\n%\nG90 G1 X2. F5\nX5.\n%\n", 2),
    ("(name)\n\nG1 X2. F5\n% (end)\n\n(note)\nG4 P1\n", 4),
])
def test_words_behind_a_percent_that_began_nothing_are_refused(text, line):
    r = run("--check", text=text)
    assert r.returncode == 65, r.stderr
    assert f"-:{line}:1: error: a % with words behind it".encode() in r.stderr


@pytest.mark.parametrize("text, noted", [
    ("%\nG1 X2. F5\nM2\n%\nX5.\n", True), ("\n(name)\n%\nG1 X2. F5\n%\nX5.\n", True),
    ("G1 X2. F5\nM2\n%\n\n(behind)\n", False), ("%\nG1 X2. F5\nM2\n%\n \n", False),
])
def test_words_behind_the_percent_that_ends_the_text_are_noted(text, noted):
    r = run("--check", text=text)
    assert r.returncode == 0, r.stderr
    assert (b"nothing behind the % that ends the text" in r.stderr) == noted


def test_c_of_three_digits_stays_an_axis_when_it_is_emitted():
    r = run("--emit", "iso", text="G90 G1 F100 X1.\nG1 C120.\nX2.\nM2\n")
    assert b"G1 C120.\n" in r.stdout, r.stdout
