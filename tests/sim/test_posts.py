# SPDX-License-Identifier: Apache-2.0
"""Programs in the style of post-processors, each read in its dialect.

tests/data/posts has them: written from public descriptions and examples, as
docs/nc-code.md names them, not from the reader's tables.
"""
import re

import pytest

from edmsim import ROOT, machine_text, run

POSTS = ROOT / "tests/data/posts"

WIRE = machine_text(guides="relative")

# The program defines its conditions: no column of them is used.
TECH = "condition, servo_v\nC999, 20\ninline C =" + " -" * 16 + "\n"

# The file's name begins with its dialect.  What generic says of it first (None:
# it takes it), and what is ignored or mentioned in its own.
FILES = {
    "3b.3b": ("B", []),
    "4b.4b": ("B5000 behind a :", []),
    "agievision.iso": ("G71", ["Y5000"]),
    "charmilles-cmd.iso": (None, []),
    "charmilles-robofil-440.iso": ("M15", ["M15", "M24", "M28", "G92", "/"]),
    "charmilles-robofil.iso": ("G38", ["G60", "G38", "G39"]),
    "fanuc-sinker-fusion.nc": ("G80", ["G80", "T01", "M03", "G43"]),
    "fanuc-sinker-helman.nc": ("G80", ["T1", "G80", "M3", "G43"]),
    "fanuc-wire-taper.nc": ("I30.", ["G92", "M60", "M50"]),
    "fanuc-wire.nc": ("M78", ["M78", "M82", "M60", "M50", "M79"]),
    "generic-gcodetools.ngc": (None, []),
    "heekscnc.ngc": ("G43", ["G43", "T1", "M03", "X-5"]),
    "linuxcnc-pcb.ngc": ("G64", ["lengths", "G64", "T1", "M6", "M3"]),
    "linuxcnc-plasma.ngc": ("G64", ["G64", "M52", "M68", "G10", "X10", "M3",
                                    "M67"]),
    "linuxcnc-vcarve.ngc": ("G64", ["G49", "G64", "T1", "M3"]),
    "makino-u32k.nc": ("M17", ["M06", "M17", "M07", "M18"]),
    "makino.nc": ("M60", ["M60", "T84", "M50"]),
    "mastercam-wire-hsm.nc": (None, []),
    "mastercam-wire.nc": ("M60", ["M60", "M20", "M21", "M50"]),
    "mitsubishi-wire.nc": ("L001", ["M91", "M20", "M78", "M80", "M82", "M84", "M90",
                                    "M01", "M85", "M83", "M81", "M21", "M58"]),
    "sodick-sinker.nc": (None, ["M05"]),
    "sodick-wire.nc": ("'='", ["Q", "G92", "G29", "T94"]),
}
DIALECTS = ["3b", "4b", "agievision", "charmilles-cmd",
            "charmilles-robofil-440", "charmilles-robofil", "fanuc-sinker",
            "fanuc-wire", "generic", "heekscnc", "linuxcnc",
            "makino", "mastercam-wire", "mitsubishi-wire",
            "sodick-sinker", "sodick-wire"]


def dialect_of(name):
    return next(d for d in DIALECTS if name.startswith(d))


@pytest.fixture(scope="module")
def wire(tmp_path_factory):
    path = tmp_path_factory.mktemp("posts") / "wire.ini"
    path.write_text(WIRE)
    return path


def check(name, dialect, wire):
    sinks = dialect_of(name) in ("charmilles-cmd", "fanuc-sinker", "generic",
                                 "heekscnc", "linuxcnc", "sodick-sinker")
    machine = ROOT / "examples/machine.ini" if sinks else wire
    tech = []
    if name == "sodick-wire.nc":
        tech = ["--tech", wire.parent / "wire.tech"]
        tech[1].write_text(TECH)
    return run("--machine", machine, "--dialect", dialect, "--check", *tech,
               POSTS / name)


def test_every_file_is_listed():
    assert {p.name for p in POSTS.iterdir()} == set(FILES)


@pytest.mark.parametrize("name", FILES)
def test_generic_says_what_a_word_means_elsewhere(name, wire):
    r = check(name, "generic", wire)
    word = FILES[name][0]
    if word is None:
        assert r.returncode == 0, r.stderr
    else:
        assert r.returncode == 65
        assert f"error: {word}".encode() in r.stderr or \
            f"unknown word {word}".encode() in r.stderr or \
            f"a second word {word}".encode() in r.stderr, r.stderr


@pytest.mark.parametrize("name", FILES)
def test_its_dialect_takes_it_and_says_what_it_ignores(name, wire, tmp_path):
    dialect = dialect_of(name)
    if name == "sodick-wire.nc":
        # The control's own file is called: nobody but its user knows by heart
        # that it moves nothing.
        r = check(name, dialect, wire)
        assert r.returncode == 65 and b":6:1: error: Q: " in r.stderr
        text = (ROOT / f"dialects/{dialect}.ini").read_text()
        dialect = tmp_path / "mine.ini"
        dialect.write_text(re.sub("(?m)^Q = .*$", "Q = ignore-line: no motion",
                                  text))
    r = check(name, dialect, wire)
    assert r.returncode == 0, r.stderr
    said = re.findall(r": note: ([^ :]+)", r.stderr.decode())
    assert said == FILES[name][1]


def test_the_machine_file_names_the_dialect(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[machine]\nname = m\n[nc]\ndialect = linuxcnc\n")
    job = POSTS / "linuxcnc-vcarve.ngc"
    assert run("--machine", machine, "--check", job).returncode == 0
    machine.write_text("[machine]\nname = m\n[nc]\ndialect = mine.ini\n")
    r = run("--machine", machine, "--check", job)
    assert r.returncode == 78 and b"mine.ini: No such file" in r.stderr
    (tmp_path / "mine.ini").write_text("[dialect]\nbase = linuxcnc\n"
                                       "[words]\nM7 = refuse: mist; M8\n")
    r = run("--machine", machine, "--check", job)
    assert r.returncode == 65 and b":4:1: error: M7: mist; M8" in r.stderr
    (tmp_path / "mine.ini").write_text("[dialect]\nbase = linuxnc\n")
    r = run("--machine", machine, "--check", job)
    assert r.returncode == 78 and b"mine.ini:2:8: error: no base" in r.stderr


def test_check_lists_all_refusals_and_who_takes_the_text():
    r = check("linuxcnc-vcarve.ngc", "generic", None)
    said = r.stderr.decode().splitlines()
    assert [re.search(r":(\d+:\d+): error: (\w+)", s).groups()
            for s in said[:3]] == [
        ("2:13", "G64"), ("4:1", "M7"), ("14:1", "M9")]
    assert said[3].endswith(": 3 refusals")
    assert said[4].endswith(": taken by dialect linuxcnc heekscnc")


@pytest.mark.parametrize("text", [
    "", "\n(nothing)\n",				# all of the text
    "G0 X1.\nO7\nM99\n", "M98 P7\nM2\nO7 G0 X1.\n",	# a line
    "G0 X1. X2.\nM2\n",				# a word
])
def test_check_says_where_as_a_run_does(text):
    place = []
    for way in "--check", "--dry-run":
        r = run("--dialect", "generic", way, text=text)
        assert r.returncode == 65
        place.append(re.search(r"^-:([1-9]\d*:[1-9]\d*): error: .*",
                               r.stderr.decode(), re.M).group(0))
    assert place[0] == place[1]


def test_check_counts_the_refusal_of_a_record_too(tmp_path):
    for suffix in ("3b", "4b"):
        job = tmp_path / f"a.{suffix}"
        job.write_text("B1 B2 B\n")
        r = run("--machine", ROOT / "examples/wire.ini", "--check", job)
        said = r.stderr.decode().splitlines()
        assert r.returncode == 65 and ": error: " in said[0], said
        assert said[1].endswith(": 1 refusal") and len(said) == 2, said


def test_numbers_of_a_condition_that_mean_nothing_are_told():
    def said(dialect, text):
        r = run("--machine", ROOT / "examples/wire.ini", "--dialect", dialect,
                "--check", text=text)
        return r.returncode, re.findall(r"the numbers behind (\S+) have no effect|"
                                        r":(\d+:\d+): error: (\S+), which the",
                                        r.stderr.decode())
    defined = "E001= 60 6 20 5 1 0 50\nG1 X1.\n"
    assert said("skd2", defined + "M02\n") == (0, [("E001", "", "")])
    assert said("skd2", defined + "E001\nX2.\nM02\n") == \
        (65, [("E001", "", ""), ("", "3:1", "E001")])
    assert said("sodick-wire", "C001 = 10 15\nC001 G1 X1.\nM02\n") == \
        (65, [("C001", "", ""), ("", "2:1", "C001")])
    # What no program defines is called as it is, where there is no table.
    assert said("skd2", "E001\nG1 X1.\nM02\n") == (0, [])


def test_what_is_skipped_is_told_with_its_line():
    def said(dialect, text):
        r = run("--dialect", dialect, "--check", text=text)
        assert r.returncode == 0, r.stderr
        return re.findall(r":(\d+): note: (/|nothing behind)",
                          r.stderr.decode())
    assert said("generic", "G0 X1.\n/G0 X2.\n/X3.\nM2\n") == [("2", "/")]
    assert said("fanuc-sinker", "G0 X1.\nM30\n(A)\n\nX2.\nM30\n") == \
        [("5", "nothing behind")]
    assert said("generic", "%\nG0 X1.\nM30\n%\nrest\n") == \
        [("5", "nothing behind")]
    for text in ("%\nG0 X1.\nM30\n%\n", "G0 X1.\nM2\n\x1a",
                 "M98 P1\nM30\n; a\n(b)\nN5 O1\nG0 X2.\nM99\n",
                 "G0 X1.\nM2\n" + "\0" * 50):
        assert said("generic", text) == []


def test_words_beside_a_refused_word_are_not_told_as_well():
    r = run("--dialect", "fanuc-sinker", "--check",
            text="G54\nG51 X0 Y0 Z0\nG0 X1.\nM30\n")
    assert r.stderr.count(b"error:") == 1, r.stderr


BODY = "P0 X1. Q1\nP0 Y1. R2\nP0 Z1. K.4\nN8 P1\nP1\nP1\nP1 F7\nG1 X1. Q5\nM2\n"


@pytest.mark.parametrize("first", [
    "G43.4\nG6.3 P0 X9.",		# begins elsewhere
    "G43.4\nG6.3 L11 P0",
    "G43.4\nG6.3 P0 X..1",
    "\nG6.3 P0 X0.",			# G43.4 is missing
    "\nG6.4 P0 X0.",
])
def test_a_refused_curve_is_told_once(first):
    """Its other lines are not, but the next mistake is."""
    r = run("--machine", ROOT / "examples/five-axis.ini", "--check",
            text="F60\n" + first + "\n" + BODY)
    assert re.findall(r":(\d+):\d+: error:", r.stderr.decode()) == [
        "3", "11"], r.stderr


def test_a_refused_number_with_decimals_is_told_once():
    r = run("--dialect", "generic", "--check", text="M350.1 M8.\nG0 X1.\nM2\n")
    assert r.returncode == 65
    assert r.stderr.count(b"error:") == 2, r.stderr


def test_a_place_that_is_refused_is_listed_among_the_words():
    r = run("--dialect", "fanuc-sinker", "--check",
            text="G0 X1. X2.\nG90 G0 X900.\n#1=2\nG999\nX1.\n")
    said = r.stderr.decode().splitlines()
    assert ["-:1:8:" in said[0], "-:4:1:" in said[1], said[2]] == [
        True, True, "-: 2 refusals"]
    r = run("--dialect", "fanuc-sinker", "--check",
            text="G999\n" * 150 + "G0 X900.\n")
    assert r.stderr.decode().splitlines()[100] == \
        "-: 100 refusals, and perhaps more"


@pytest.mark.parametrize("dialect", ["fanuc-sinker", "fanuc-wire", "makino"])
def test_a_colon_is_an_o_in_iso_code(dialect):
    r = run("--dialect", dialect, "--check",
            text="%\n:1234 (PART)\nG90 G1 X1. F60.\nM98 P100\nM2\n"
                 ":100\nX2.\nM99\n%\n")
    assert r.returncode == 0, r.stderr
    assert b"path       2.000 mm" in r.stdout
    r = run("--dialect", dialect, "--check", text=":1\nG1 X1. F60.\n:2\nM2\n")
    assert r.returncode == 65 and b":3:1: error: the next program" in r.stderr


@pytest.mark.parametrize("end", ["\x1a", "\x1a\x1a", "\x1a\r\n", "%\r\n\x1a"])
def test_the_mark_behind_a_dos_file_is_no_word(end):
    text = "%\r\nG90 G21\r\nG1 X1. F60.\r\n"
    r = run("--check", text=text + end)
    assert r.returncode == 0, r.stderr
    r = run("--check", text=text + "\x1aX2.\r\n" + end)
    assert r.returncode == 65 and b":4:1: error: byte 0x1a" in r.stderr
