# SPDX-License-Identifier: Apache-2.0
"""Standard input, output and error of every program: full, closed."""
import os
import pathlib
import re
import signal
import subprocess

import pytest
from rig import BUILD, NULL_MACHINE, until

PROGRAMS = ("edmd", "edmd-jobs", "edmctl", "edmsim", "edm-dds", "edm-fleet",
            "edm-panel", "edm-plan")


@pytest.mark.parametrize("to, why", [(">/dev/full", "No space left on device"),
                                     (">&-", "Bad file descriptor")])
@pytest.mark.parametrize("program", PROGRAMS)
def test_what_cannot_be_printed_is_told_once(program, to, why):
    p = subprocess.run(["sh", "-c", f'"$0" --help {to}', BUILD / program],
                       stderr=subprocess.PIPE, text=True, timeout=60)
    assert p.returncode == 74
    assert p.stderr == f"{program}: standard output: {why}; " \
        "it is not complete\n"


@pytest.mark.parametrize("args", [
    ("--print-config",), ("--emit", "iso", "examples/cavity.ngc"),
    ("--print-tech", "--tech", "examples/copper-steel.tech"),
    ("--report", "-", "--limit-s", "1", "--quiet", "examples/cavity.ngc"),
    ("--pulses", "-", "--limit-s", "1", "--quiet", "examples/cavity.ngc")])
def test_half_an_output_is_no_success(args):
    with open("/dev/full", "w") as full:
        p = subprocess.run([BUILD / "edmsim", *args], stdout=full, timeout=60,
                           stderr=subprocess.PIPE, text=True)
    assert p.returncode == 74
    assert p.stderr.count("No space left on device") == 1, p.stderr


def test_no_file_of_edmd_becomes_its_standard_output(tmp_path):
    name = f"std{os.getpid()}"
    ini = tmp_path / "m.ini"
    ini.write_text(NULL_MACHINE.format(name=name, store=tmp_path))
    p = subprocess.Popen(["sh", "-c", 'exec "$0" "$@" <&- >&- 2>&-',
                          BUILD / "edmd", "--config", ini])
    try:
        status = f"edmd.{name}.status"
        until(lambda: any((d / status).exists() for d in (
            pathlib.Path("/dev/shm"), pathlib.Path("/dev/shm/edmd"))))
        assert {os.readlink(f"/proc/{p.pid}/fd/{fd}") for fd in range(3)} == \
            {"/dev/null"}
    finally:
        p.send_signal(signal.SIGTERM)
        assert p.wait(timeout=60) == 0


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_manual_has_the_options_that_there_are(program):
    p = subprocess.run([BUILD / program, "--list-options"], timeout=60,
                       capture_output=True, text=True)
    options = {line.split("\t")[1] for line in p.stdout.splitlines()
               if line.startswith("option\t")}
    page, = pathlib.Path("docs/man").glob(f"{program}.[18]")
    shown = {x for line in page.read_text().splitlines()
             if line.startswith(".It Fl")
             for x in re.findall(r"Fl -([a-z-]+)", line)}
    assert options == shown
