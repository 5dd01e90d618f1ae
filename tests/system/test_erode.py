# SPDX-License-Identifier: Apache-2.0
"""The whole way with a gap: a cavity eroded on the simulated sinker."""

import json
import pathlib
import re

import pytest
import rig

ROOT = pathlib.Path(__file__).resolve().parents[2]

CAVITY = b"G21 G90\nM3\nG1 Z-0.5 F5\nM30\n"


@pytest.fixture
def sinker(tmp_path):
    """The example machine, under a name and with a store of its own."""
    text = (ROOT / "examples/machine.ini").read_text()
    lines = [x for x in text.splitlines() if not x.startswith("store")]
    with rig.Machine(tmp_path) as m:
        m.config.write_text("\n".join(
            f"name = {m.name}" if x.startswith("name =") else x for x in lines
        ))
        yield m


def start(m, speed=None):
    """Start both programs; @speed is how many times real time."""
    if speed:
        m.config.write_text(re.sub(r"(?m)^speed *=.*$", f"speed = {speed}",
                                   m.config.read_text()))
    m.start_edmd()
    m.start_jobs("--store", str(m.store))
    m.client.status_where(lambda s: s.daemon == "ok")


def test_a_cavity_is_eroded_to_depth(sinker):
    start(sinker)
    path = sinker.folder / "cavity.ngc"
    path.write_bytes(CAVITY)
    p = sinker.ctl("submit", str(path), "--id", "cavity", "--wait",
                   timeout=120)
    assert p.returncode == 0, p.stdout + p.stderr
    sinker.client.hear(0.5)
    assert "erode" in {s.state for s in sinker.client.statuses}
    j = sinker.client.job("cavity")
    assert j["state"] == "done"
    # From the first spark, which comes within the gap.
    assert 0.5 - 0.06 < j["depth_mm"] <= 0.5
    assert j["path_mm"] == pytest.approx(0.5, abs=1e-3)
    assert j["jumps"] > 0


LIFTING = b"G21 G90\nM3\nG141\nG0 Z2\nG0 Z0.1\nG1 Z-0.5 F5\nM30\n"


def held_beside_the_path(sinker):
    """Hold it in a jump: how far beside, from the log of the next edmd."""
    c = sinker.client
    c.status_where(lambda s: s.state == "jump", timeout=30)
    assert c.ask("hold").code == 0
    c.hear(0.5)
    before = c.status()
    assert before.state == "hold"
    after = sinker.come_back(lambda s: s.job_state == "held")
    assert after.pos_mm == before.pos_mm, "it moved by itself"
    said = (sinker.folder / "edmd.log").read_text()
    # On a busy machine the hold may come when the jump is over.
    found = re.findall(r"([\d.]+) mm beside the path", said)
    return float(found[-1]) if found else 0.0


def test_edmd_killed_beside_the_path_is_held_there_and_start_comes_back(sinker):
    # A jump must last longer than a command takes on a busy machine.
    start(sinker, speed=1)
    c = sinker.client
    assert c.submit(LIFTING, "job").code == 0
    for _ in range(20):
        beside = held_beside_the_path(sinker)
        assert c.ask("start").code == 0
        if beside > 0:
            break
    assert beside > 0
    c.status_where(lambda s: s.state == "erode", timeout=10)
    assert c.ask("stop").code == 0
    c.job_where("job", "stopped")


HUNTING = {"servo_v": 9, "feed_gain_mm_s_v": 2, "feed_max_mm_s": 3,
           "every_s": 60}


def test_a_servo_that_hunts_is_warned_of_with_advice(sinker):
    text = sinker.config.read_text()
    for key, value in HUNTING.items():
        text = re.sub(rf"(?m)^{key} = \S+", f"{key} = {value}", text)
    sinker.config.write_text(text)
    start(sinker)
    path = sinker.folder / "deep.ngc"
    path.write_bytes(CAVITY.replace(b"0.5", b"4.0"))
    sinker.ctl("submit", str(path), "--id", "deep")
    c = sinker.client
    s = c.status_where(lambda s: s.hunts > 0, timeout=120)
    assert s.fault == "none" and s.retracts >= 20
    told = sinker.ctl("alarms").stdout
    assert re.search(r"(?m)^warning +hunting: \d+ times", told), told
    assert "raise servo_v, lower feed_gain_mm_s_v" in told
    # The same in the history below, once it is there.
    assert re.search(r"job deep.ngc: the gap servo hunts: 20 retracts", told)
    assert "warning    the gap servo hunts" in sinker.ctl("status").stdout
    # A service that comes reads what edmd has said again, and tells it once.
    sinker.kill("jobs")
    sinker.start_jobs("--store", str(sinker.store))
    c.status_where(lambda s: s.daemon == "ok" and s.job == "deep")
    places = [e["place_mm"] for e in json.loads(c.ask("events").body)
              if e["outcome"] == "hunting"]
    assert places and len(set(places)) == len(places)
    assert sinker.ctl("stop").returncode == 0
