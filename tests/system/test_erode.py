# SPDX-License-Identifier: Apache-2.0
"""The whole way with a gap: a cavity eroded on the simulated sinker."""

import pathlib

import pytest
import rig

ROOT = pathlib.Path(__file__).resolve().parents[2]

CAVITY = b"G21 G90\nM3\nG1 Z-0.5 F5\nM30\n"


@pytest.fixture
def sinker(tmp_path):
    """The example machine, under a name and with a store of its own."""
    text = (ROOT / "examples/machine.ini").read_text()
    lines = [x for x in text.splitlines() if not x.startswith("store")]
    m = rig.Machine(tmp_path)
    m.config.write_text("\n".join(
        f"name = {m.name}" if x.startswith("name =") else x for x in lines
    ))
    m.start_edmd()
    m.start_jobs("--store", str(m.store))
    m.client.status_where(lambda s: s.daemon == "ok")
    yield m
    m.close()
    assert m.sweep() == [], "left in /dev/shm"


def test_a_cavity_is_eroded_to_depth(sinker):
    path = sinker.folder / "cavity.ngc"
    path.write_bytes(CAVITY)
    p = sinker.ctl("submit", str(path), "--id", "cavity", "--wait",
                   timeout=120)
    assert p.returncode == 0, p.stdout + p.stderr
    sinker.client.hear(0.5)
    assert "erode" in {s.state for s in sinker.client.statuses}
    j = sinker.client.job("cavity")
    assert j["state"] == "done"
    assert j["depth_mm"] == pytest.approx(0.5, abs=2e-3)
    assert j["path_mm"] == pytest.approx(0.5, abs=1e-3)
    assert j["jumps"] > 0
