# SPDX-License-Identifier: Apache-2.0
"""What somebody meets first: the template, a plan's dwells."""
from edmsim import ROOT, done


def test_the_template_is_a_machine_that_moves_nothing():
    text = (ROOT / "examples/template.ini").read_text()
    assert "\nbackend = null " in text
    done("--machine", ROOT / "examples/template.ini", "--check",
         text="G21 G90 G0 X99.\n")


def test_check_counts_the_dwells():
    r = done("--check", text="G0 X1.\nG4 P1.5\nG4 X2.\nM2\n")
    assert b"\ndwells     2, 3.500 s in all\n" in r.stdout
