# SPDX-License-Identifier: Apache-2.0
"""make install brings programs that find their files, and uninstall takes all back"""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def make(tmp_path):
    def run(what):
        done = subprocess.run(
            ["make", "-C", ROOT, what, f"DESTDIR={tmp_path}", "PREFIX=/usr"],
            capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        return {str(f.relative_to(tmp_path)) for f in tmp_path.rglob("*")
                if not f.is_dir()}
    return run


def test_what_is_installed_runs_and_is_taken_back(make, tmp_path):
    there = make("install")
    share = tmp_path / "usr/share/edmd"
    for program in ("edmd", "edmd-jobs", "edmctl", "edmsim"):
        done = subprocess.run([tmp_path / "usr/bin" / program, "--version"],
                              capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        assert any(f.startswith("usr/share/man/") and
                   pathlib.Path(f).stem == program for f in there), program
    done = subprocess.run(
        [tmp_path / "usr/bin/edmsim", "--machine", share / "examples/wire.ini",
         "--check", share / "examples/taper.ngc"],
        cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr

    mine = tmp_path / "etc/edmd/machine.ini"
    mine.write_text(mine.read_text() + "# mine\n")
    assert make("install") == there
    assert mine.read_text().endswith("# mine\n")
    assert make("uninstall") == {"etc/edmd/machine.ini"}
