# SPDX-License-Identifier: Apache-2.0
"""A make that is killed leaves nothing that the next would take for whole."""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Objects are made at once; at a link it is killed with the half of a program.
CC = """#!/bin/sh
link=yes was=
for a; do
        [ "$a" != -c ] || link=
        [ "$was" != -o ] || out=$a
        [ "$was" != -MF ] || : > "$a"
        was=$a
done
printf half > "$out"
[ -z "$link$HALF_OBJECTS" ] || kill -KILL 0
"""
AR = """#!/bin/sh
printf half > "$2"
[ -z "$HALF_ARCHIVES" ] || kill -KILL 0
"""


@pytest.mark.parametrize("what,half", [
    ("common/cmdline.o", "HALF_OBJECTS"),
    ("common.a", "HALF_ARCHIVES"),
    ("edmd", "")])
def test_a_killed_make_leaves_no_half(tmp_path, what, half):
    """Its whole group is killed, as by a closed container."""
    for name, text in (("cc", CC), ("ar", AR)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    p = subprocess.run(
        ["make", "-s", f"B={tmp_path}/b", f"CC={tmp_path}/cc",
         f"AR={tmp_path}/ar", "LTO=0", f"{tmp_path}/b/{what}"], cwd=ROOT,
        env={**os.environ, "HALF_OBJECTS": "", "HALF_ARCHIVES": "",
             **({half: "1"} if half else {})},
        start_new_session=True, capture_output=True, text=True, timeout=600)
    assert p.returncode == -9, p.stdout + p.stderr
    assert not (tmp_path / "b" / what).exists()
    assert (tmp_path / "b" / f"{what}.new").read_text() == "half"
