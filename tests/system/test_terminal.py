# SPDX-License-Identifier: Apache-2.0
"""What others wrote never moves a terminal: names of files, and what is in
them, in every option of every program."""

import os
import pathlib
import pty
import re
import subprocess

import pytest
import rig

# ESC and BEL, C1 in UTF-8 and as a bare byte, the direction of writing, CR.
EVIL = b"\x1b]0;x\x07\x1b[2J\xc2\x9b31m\x9b5n\xe2\x80\xae\x7f\x08\r\x1b[A"
BAD = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|"
                 rb"\xe2\x80[\x8b-\x8f\xa8-\xae]|(?<![\xc2-\xf4\x80-\xbf])"
                 rb"[\x80-\xbf]")
PROGRAMS = ["edmctl", "edmsim", "edmd", "edmd-jobs", "edm-plan", "edm-panel",
            "edm-dds", "edm-fleet"]
MACHINE = "examples/machine.ini"


def said(*args, data=b"", cwd=None):
    try:
        done = subprocess.run(args, input=data, capture_output=True,
                              timeout=60, cwd=cwd)
    except subprocess.TimeoutExpired as e:
        return (e.stdout or b"") + (e.stderr or b"")
    return done.stdout + done.stderr


def check(*args, told=True, **more):
    got = said(*args, **more)
    assert not BAD.search(got), got[-400:]
    assert got or not told


def options(program):
    """Each option that has a value."""
    text = said(rig.BUILD / program, "--help").decode()
    return sorted(set(re.findall(r"--([a-z][a-z-]*) [A-Z]", text)))


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_name_in_any_option_moves_no_terminal(program, tmp_path):
    names = options(program)
    assert names or program == "edmd"
    base = [] if program in ("edm-dds", "edm-fleet", "edmctl") else \
        ["--config" if program in ("edmd", "edmd-jobs", "edm-panel")
         else "--machine", MACHINE]
    evil = os.fsencode(tmp_path / "no") + b"/" + EVIL
    for name in names:
        check(rig.BUILD / program, *base, f"--{name}", evil, evil,
              told=False)
    check(rig.BUILD / program, evil, evil, evil)
    check(rig.BUILD / program, b"--" + EVIL)


@pytest.mark.parametrize("words", [
    ["submit"], ["show"], ["why"], ["remove"], ["record"], ["support"],
    ["keys", "add"], ["electrode", "show"], ["offset"], ["identify"],
    ["new-machine"], ["set"], ["jog"], ["log"]], ids=lambda w: w[0])
def test_a_name_in_any_verb_moves_no_terminal(words, tmp_path):
    check(rig.BUILD / "edmctl", *words, EVIL, cwd=tmp_path)
    check(rig.BUILD / "edmctl", "--machine", EVIL, *words, EVIL, cwd=tmp_path)


INSIDE = {
    "machine": [b"[%s]\n", b"[machine]\n%s = 1\n", b"[machine]\nname = %s\n",
                b"[machine]\nbackend = %s\n", b"%s\n", b"[nc]\ndialect = %s\n",
                b"[axis.%s]\nx = 1\n", b"[tech]\ntable = %s\n",
                b"[jobs]\nstore = %s\n", b"[lcm]\nurl = %s\n",
                b"[panel]\naddress = %s\n", b"[machine]\nmaps = %s\n"],
    "job": [b"%s\n", b"G1 X%s\n", b"(%s)\nQ1\n", b"G1 X1 ; %s\n",
            b"o<%s> call\n", b"O1 %s\n", b"M98 <%s>\n", b"C%s\n",
            b"#<%s> = 1\n", b"(MSG, %s)\nG1 X1 F1\n"],
    "dialect": [b"%s\n", b"[dialect]\nname = %s\n", b"[words]\nG1 = %s\n",
                b"base = %s\n", b"[%s]\n"],
    "tech": [b"%s\n", b"[%s]\n", b"C100 %s\n", b"name %s\n"],
}


@pytest.mark.parametrize("what", INSIDE)
def test_what_is_in_a_file_moves_no_terminal(what, tmp_path):
    machine = pathlib.Path(MACHINE).read_bytes()
    at = tmp_path / os.fsdecode(b"a" + EVIL)
    for text in INSIDE[what]:
        at.write_bytes(text.replace(b"%s", EVIL))
        config, job = tmp_path / "m.ini", "examples/cavity.ngc"
        config.write_bytes(machine)
        if what == "machine":
            config = at
        elif what == "job":
            job = at
        else:
            section, key = {"dialect": ("nc", "dialect"),
                            "tech": ("tech", "table")}[what]
            config.write_bytes(f"[machine]\nname = m\nbackend = sim\n"
                               f"[{section}]\n{key} = ".encode()
                               + os.fsencode(at) + b"\n")
        for program in ("edmsim", "edm-plan"):
            check(rig.BUILD / program, "--machine", config, "--check", job,
                  told=False)
        for program in ("edmd", "edmd-jobs"):
            check(rig.BUILD / program, "--config", config, "--check")


def test_a_terminal_is_drawn_on_by_the_program_alone(tmp_path):
    """Its own bar moves the cursor; the name in it does not."""
    at = tmp_path / os.fsdecode(b"a\x1b[2J.ngc")
    at.write_bytes(b"G21 G90 F30\n" + b"G1 X1\nG1 X0\n" * 2000 + b"M30\n")
    got = b""
    pid, fd = pty.fork()
    if pid == 0:
        os.execv(rig.BUILD / "edmsim", ["edmsim", "--machine", MACHINE,
                                        "--dry-run", str(at)])
    try:
        while part := os.read(fd, 4096):
            got += part
    except OSError:
        pass                    # the end of the terminal
    os.waitpid(pid, 0)
    os.close(fd)
    assert b"\x1b[2J" not in got and b"outcome" in got, got
    assert re.search(rb"\r *[0-9]+ %", got), got


def test_letters_of_all_scripts_are_shown(tmp_path):
    at = tmp_path / "m.ini"
    at.write_text("[machine]\nÜbermaß 放电 ñ € = 1\n")
    got = said(rig.BUILD / "edmsim", "--machine", at, "--check",
               "examples/cavity.ngc").decode()
    assert "?" not in got and "Übermaß 放电 ñ €" in got
