# SPDX-License-Identifier: Apache-2.0
"""edmctl generator: what is asked and told, and values to try."""

import json

import pytest
import rig

MACHINE = rig.NULL_MACHINE + """
[generator]
by_hand = off_us
"""


@pytest.fixture
def knobs(tmp_path):
    """A machine whose generator has knobs."""
    with rig.Machine(tmp_path, MACHINE) as m:
        m.start()
        yield m


def fields(m):
    told = json.loads(m.ctl("--json", "generator").stdout)
    return {f["name"]: f for f in told["fields"]}


def test_each_field_is_shown(knobs):
    text = knobs.ctl("generator").stdout
    assert text.startswith("interface none; sparks off; ")
    assert list(fields(knobs)) == [
        "peak_a", "on_us", "off_us", "polarity", "ignition_v", "iso",
        "servo_v"]
    assert fields(knobs)["off_us"]["by"] == "hand"
    assert not fields(knobs)["peak_a"]["delivered"]


def test_what_cannot_be_tried_is_refused_with_what_would_be(knobs):
    for field, value, code, words in (
        ("peak_a", "6", 65, "[generator] peak_a = how it is reached"),
        ("off_us", "20", 65, "a person sets off_us"),
        ("servo_v", "20", 65, "[generator] servo_v = how it is reached"),
        ("gap_mm", "0.1", 65, "one of peak_a on_us off_us polarity"),
        ("peak_a", "much", 64, "'much' is no number"),
        ("", "6", 65, "one of peak_a"),
    ):
        p = knobs.ctl("generator", "set", field, value)
        assert p.returncode == code, p.stderr
        assert words in p.stderr
    assert knobs.ctl("generator", "set", "peak_a").returncode == 64
    assert knobs.ctl("generator", "sett").returncode == 64
    p = knobs.ctl("generator", "walk")
    assert p.returncode == 78
    assert "[generator] told_peak_a" in p.stderr


def test_a_walk_without_edmd_does_not_blame_the_machine_file(knobs):
    knobs.kill("edmd")
    rig.until(lambda: "edmd is not there" in knobs.ctl("generator").stdout)
    p = knobs.ctl("generator", "walk")
    assert p.returncode == 69
    assert "edmd is not there; systemctl status edmd" in p.stderr
    knobs.start_edmd()


def test_it_is_tried_without_a_job_only(knobs):
    assert knobs.ctl("generator", "set", "peak_a", "default").returncode == 0
    assert knobs.client.submit(rig.SLOW_JOB, "job", hold=True).code == 0
    knobs.client.status_where(lambda s: s.state == "hold")
    p = knobs.ctl("generator", "set", "peak_a", "default")
    assert p.returncode == 1
    assert "without sparks: no job loaded" in p.stderr
