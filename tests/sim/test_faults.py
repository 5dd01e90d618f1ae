# SPDX-License-Identifier: Apache-2.0
"""One table of faults: edmctl and the documents say what it says."""
import json
import subprocess

from edmsim import PROGRAM, ROOT

EDMCTL = PROGRAM.replace("edmsim", "edmctl")


def edmctl(*args, code=0):
    r = subprocess.run([EDMCTL, *args], capture_output=True, text=True)
    assert r.returncode == code, r.stderr
    return r


def test_the_documents_have_the_table_of_the_code():
    table = subprocess.run([ROOT / "docs/faults", EDMCTL], check=True,
                           capture_output=True, text=True).stdout
    assert table in (ROOT / "docs/architecture.md").read_text(), "make faults"


def test_every_fault_is_told_without_a_machine():
    rows = json.loads(edmctl("--json", "faults").stdout)
    assert [r["number"] for r in rows] == list(range(1, len(rows) + 1))
    text = edmctl("faults").stdout
    for r in rows:
        assert r["fault"] in text and r["clear"] in text
        assert r["why"] in edmctl("faults", r["fault"]).stdout


def test_a_fault_that_is_none_is_refused():
    assert "edmctl faults" in edmctl("faults", "headache", code=64).stderr
