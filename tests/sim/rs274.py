# SPDX-License-Identifier: Apache-2.0
"""rs274.py - what LinuxCNC's own interpreter says of a program.

rs274 is of Debian's package linuxcnc-uspace.  Tests that compare with it are marked
with `peer`.
"""
import os
import shutil
import subprocess

import pytest

RS274 = shutil.which("rs274")
peer = pytest.mark.skipif(
    not RS274, reason="no rs274 to compare with: apt install linuxcnc-uspace")


def canonical_calls(path, *options):
    """What it prints of the file at path.

    It keeps variables in the folder where it runs, and maps a file of tools in HOME.
    Two that run at once would cut that file under each other and end with SIGBUS, so
    each has the folder of its program.
    """
    r = subprocess.run([RS274, *options, "-g", path.name], cwd=path.parent,
                       env={**os.environ, "HOME": str(path.parent)},
                       capture_output=True, text=True, timeout=3600)
    assert r.returncode >= 0, (r.returncode, r.stderr)
    return r.stdout
