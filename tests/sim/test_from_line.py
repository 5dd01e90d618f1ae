# SPDX-License-Identifier: Apache-2.0
"""A program begins inside an orbit, a macro or a pass of the wire: behind the way
in its points are those of the whole program."""

import subprocess

import pytest

from edmsim import PROGRAM, ROOT, pulses, report, run

MACHINE = ROOT / "examples/machine.ini"
WIRE = ROOT / "examples/wire.ini"

ORBITS = """G21 G90 G17 T84 M3
D1=0.08
F60
G0 Z1
G0 X0.5 Y0.5
G0 Z0.1
G130 Z-0.03 D1 J0.02 K0.01 Q0.05 P1
G0 Z1
G0 X1
G0 Z0.1
G134 Z-0.03 R0.04 A45 L4
G0 Z1
M30
"""

# Twenty seconds at most in the orbit, which ends with positioning inside.
TIMED = """G21 G90 M3
D1=0.15
F30
G0 X0 Y0 Z0
G135 Z-0.12 D1 J0.03 Q0.03 P1 S20
G1 Z-0.4
M30
"""

# Five holes, each deeper; line 6 is done five times.
MACRO = """o100 sub
G0 X#1 Y0
G0 Z0.1
#3 = 0
o101 while [#3 LT 3]
  G1 Z[0 - #2 - #3 * 0.01]
  #3 = [#3 + 1]
o101 endwhile
G0 Z1
o100 endsub
G21 G90
F60
G0 Z1
#5 = 1
o102 while [#5 LE 5]
  o100 call [#5] [#5 * 0.02]
  #5 = [#5 + 1]
o102 endwhile
M2
"""

PASSES = (ROOT / "examples/wire-die.ngc").read_text()


def inside(text, machine, name, where):
    """The whole program's rows, and those of one that begins inside; behind
    its way in, which is line 0."""
    args = ["--machine", machine, "--dry-run"]
    if name:
        args += ["--dialect", name]
    whole = pulses(*args, text=text)
    part = pulses(*args, *where, text=text)
    begin = next(i for i, r in enumerate(part) if r[0])
    return whole, part[begin:]


@pytest.mark.parametrize("text, machine, name, line", [
    (ORBITS, MACHINE, None, 7), (ORBITS, MACHINE, None, 11),
    (TIMED, MACHINE, None, 5), (TIMED, MACHINE, None, 6),
    (MACRO, MACHINE, "linuxcnc", 6), (MACRO, MACHINE, "linuxcnc", 9),
    (PASSES, WIRE, None, 24), (PASSES, WIRE, None, 31),
])
def test_from_a_line(text, machine, name, line):
    whole, rest = inside(text, machine, name, ["--from-line", line])
    assert 10 < len(rest) <= len(whole)
    assert rest == whole[-len(rest):]


@pytest.mark.parametrize("text, machine, name", [
    (ORBITS, MACHINE, None), (MACRO, MACHINE, "linuxcnc"),
    (PASSES, WIRE, None), (TIMED, MACHINE, None)])
@pytest.mark.parametrize("part", [0.3, 0.55, 0.8])
def test_from_a_place(text, machine, name, part):
    more = ["--dialect", name] if name else []
    length = report("--machine", machine, "--dry-run", *more,
                    text=text)["path_mm"]
    whole, rest = inside(text, machine, name,
                         ["--from-place", part * length])
    assert 10 < len(rest) < len(whole)
    assert rest == whole[-len(rest):]


def test_in_the_last_of_many_rounds():
    """A place in the fifth call is not one in the first."""
    where = ["--machine", MACHINE, "--dry-run", "--dialect", "linuxcnc"]
    length = report(*where, text=MACRO)["path_mm"]
    r = run(*where, "--from-place", length - 1.2, "--pulses", "-", text=MACRO)
    assert r.returncode == 0, r.stderr
    at = [row.split(b",") for row in r.stdout.splitlines()[1:]]
    assert {row[2] for row in at if row[1] == b"6"} == {b"5000"}


def test_a_call_is_no_line_that_moves():
    r = run("--machine", MACHINE, "--dry-run", "--dialect", "linuxcnc",
            "--from-line", 16, text=MACRO)
    assert r.returncode == 65
    assert b"nothing moves on the path from line 16 on; a line that moves, as 13" \
        in r.stderr


def test_behind_the_last_positioning_nothing_is_left_to_move():
    said = subprocess.run(
        [PROGRAM, "--machine", MACHINE, "--check", "--from-place", "2.5", "-"],
        input=b"G21 G90 F60\nG1 X2\nG0 X3\nM2\n", capture_output=True,
        check=True).stderr
    assert b"then it moves no more" in said
