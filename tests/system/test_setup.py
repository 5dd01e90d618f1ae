# SPDX-License-Identifier: Apache-2.0
"""tests/setup: what it says where something cannot be had.

apt-get, sudo and node are stand-ins in front of the real ones: they fail as
those do.
"""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def setup(tmp_path, what="build", **stand_ins):
    """Run it with these programs in front; none of its packages is here."""
    bin_ = tmp_path / "bin"
    bin_.mkdir()
    programs = {"dpkg-query": "exit 1", "id": "echo 0"} | {
        name.replace("_", "-"): text for name, text in stand_ins.items()}
    for name, text in programs.items():
        (bin_ / name).write_text(f"#!/bin/sh\n{text}\n")
        (bin_ / name).chmod(0o755)
    p = subprocess.run(
        [ROOT / "tests/setup", *what.split()], capture_output=True, text=True,
        env=os.environ | {"PATH": f"{bin_}:/usr/bin:/bin"}, timeout=60)
    return p.returncode, p.stderr.splitlines()


THERE = 'shift 3; for p; do echo "$p installed"; done'
WITH_NETWORK = "exit 0"
NO_NETWORK = ("case $1 in update) exit 0;; esac\necho 'E: Failed to fetch "
              "http://x/y.deb  Temporary failure resolving x' >&2; exit 100")


@pytest.mark.parametrize("apt,sudo,user,code,told", [
    (NO_NETWORK, "exec \"$@\"", 0, 69, "no network"),
    ("echo 'E: You don\\047t have enough free space in /var/cache' >&2; "
     "exit 100", "exec \"$@\"", 0, 73, "the disk is full"),
    (WITH_NETWORK, "echo 'sudo: a password is required' >&2; exit 1", 1000,
     77, "no rights to install"),
])
def test_why_nothing_is_installed_is_told_in_a_line(tmp_path, apt, sudo, user,
                                                    code, told):
    got, err = setup(tmp_path, apt_get=apt, sudo=sudo, id=f"echo {user}")
    assert got == code, err
    (line,) = err
    assert line.startswith("setup: ") and told in line, line
    if user:
        assert "apt-get install" in line and "libinih-dev" in line


def test_who_may_not_install_goes_on_where_all_is_there(tmp_path):
    got, err = setup(tmp_path, dpkg_query=THERE, id="echo 1000",
                     apt_get="exit 99", sudo="exit 99")
    assert (got, err) == (0, [])


def test_a_node_that_is_too_old_is_told(tmp_path):
    got, err = setup(tmp_path, "panel", dpkg_query=THERE, npm="exit 0",
                     node="echo 16.20.2")
    assert got == 69
    (line,) = err
    assert "Node.js 16.20.2" in line and "18 or later" in line, line


def test_what_the_page_needs_of_the_network_is_told(tmp_path):
    got, err = setup(tmp_path, "modules .", npm="echo 'npm ERR! errno "
                     "EAI_AGAIN' >&2; exit 1")
    assert got == 69
    (line,) = err
    assert "no network" in line and line.endswith("make panel"), line


def test_a_make_that_failed_on_a_full_disk_is_told_so(tmp_path):
    full = ("echo Filesystem 1024-blocks Used Available Capacity Mounted; "
            "echo x 90000 82000 8000 91% /var/full")
    got, err = setup(tmp_path, "failed", df=full)
    assert got == 73
    (line,) = err
    assert "the disk is full, at /var/full only 7 MiB are free" in line
    (tmp_path / "more").mkdir()
    got, err = setup(tmp_path / "more", "failed",
                     df=full.replace(" 8000 ", " 80000 "))
    assert (got, err) == (1, [])
