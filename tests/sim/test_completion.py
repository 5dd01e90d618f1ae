# SPDX-License-Identifier: Apache-2.0
"""Completion of shells comes from the programs' own tables."""
import re
import subprocess

import pytest

from edmsim import HANGS_S, PROGRAM, ROOT

BUILD = PROGRAM[:-len("edmsim")]
PROGRAMS = ("edmctl", "edmsim", "edmd", "edmd-jobs", "edm-dds", "edm-fleet",
            "edm-panel", "edm-plan")


def completion(shell, *names):
    return subprocess.run(
        [ROOT / "packaging/completion", shell, *(BUILD + n for n in names)],
        capture_output=True, text=True, check=True, timeout=HANGS_S).stdout


def offered(words):
    """What bash offers for the last of the words."""
    script = completion("bash", words[0])
    function = "_" + words[0].replace("-", "_")
    quoted = " ".join(f"'{w}'" for w in words)
    r = subprocess.run(
        ["bash", "-c", f"{script}\nCOMP_WORDS=({quoted}); "
         f"COMP_CWORD={len(words) - 1}; {function}; "
         "printf '%s\\n' \"${COMPREPLY[@]}\""], capture_output=True, text=True,
        timeout=60, cwd=ROOT / "examples")
    assert r.stderr == ""
    return r.stdout.split()


@pytest.mark.parametrize("name", PROGRAMS)
def test_every_option_of_the_help_is_completed(name):
    text = subprocess.run([BUILD + name, "--help"], capture_output=True,
                          text=True, check=True).stdout
    options = set(re.findall(r"(?m)^  (--[a-z-]+)", text))
    assert options
    assert options <= set(offered([name, "--"]))
    zsh = completion("zsh", name)
    assert all(f"'{o}[" in zsh for o in options)


def test_verbs_values_and_files():
    assert offered(["edmctl", "off"]) == ["offset"]
    assert offered(["edmctl", "--machine", "queue", "mo"]) == ["move"]
    assert offered(["edmctl", "jog", ""])[-8:] == list("XYZABCUV")
    assert offered(["edmctl", "place", "X", "as"]) == ["as-seen"]
    assert offered(["edmctl", "move", "j7", "f"]) == ["front"]
    assert offered(["edmctl", "offset", "G5"])[:2] == ["G54", "G55"]
    assert offered(["edmctl", "set", "servo"]) == ["servo_v"]
    assert offered(["edmctl", "faults", "plc"]) == ["plc-lost"]
    assert offered(["edmctl", "drive", "get", "V"]) == ["V"]
    assert offered(["edmctl", "submit", "cavity"]) == ["cavity.ngc"]
    assert offered(["edmsim", "--machine", "wire.i"]) == ["wire.ini"]
    assert offered(["edmctl", "--plot", "--"]) == []
