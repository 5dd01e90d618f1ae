# SPDX-License-Identifier: Apache-2.0
"""edmd's threads make the system calls that docs/performance.md names."""
import pathlib

import calls
import pytest

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "docs/performance.md"


@pytest.mark.needs("to trace a process")
def test_edmd_makes_the_system_calls_that_are_written_down(tmp_path):
    text = DOCUMENT.read_text()
    written = text[text.index(calls.HEAD):].split("\n\n", 1)[0].splitlines()
    assert calls.table(tmp_path) == written
