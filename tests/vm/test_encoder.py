# SPDX-License-Identifier: Apache-2.0
"""An axis on step and direction with an encoder, a brake and a line of power.

The axis is axis-sim.c, on a simulated chip: it counts the pulses that were
driven and moves A and B of its encoder, until it slips.
"""
import json

import pytest

both = pytest.mark.parametrize("edmd", ["edmd", "edmd2"])  # libgpiod 1, 2


def said(encoder, edmd):
    text = encoder.text(f"run-{edmd}.said")
    assert encoder.text(f"run-{edmd}.edmd-rc") == "0\n", text
    return text, encoder.text(f"run-{edmd}.log")


def test_the_kernel_has_nothing_to_complain_of(encoder):
    assert encoder.text("kernel") == "" and encoder.text("axis-sim.err") == ""


@both
def test_pulses_lost_are_a_fault_and_are_made_good(encoder, edmd):
    text, log = said(encoder, edmd)
    assert "early start 0" not in text and "\nstart 0" in text, text
    assert "fault following" in log
    assert "axis X: by its encoder it is not where its pulses went" in log
    ends = [line.split(" ", 2) for line in text.splitlines()
            if line.startswith("at ")]
    assert len(ends) == 2, text
    at, status = int(ends[0][1]), json.loads(ends[0][2])
    print(f"{edmd}: 50 pulses lost, made good: job at {status['pos_mm'][0]} mm,"
          f" axis at {at} counts of 0.5 um")
    assert status["pos_mm"][0] == 0.1


@both
def test_the_axis_ends_where_the_job_does(encoder, edmd):
    """To the count.  The second edmd begins where the first one left the axis,
    and calls that place 0."""
    begun = 0
    for name in ("edmd", "edmd2"):
        text, _ = said(encoder, name)
        ends = [int(line.split()[1]) for line in text.splitlines()
                if line.startswith("at ")]
        if name == edmd:
            assert ends[0] - begun == 200
        begun = ends[-1]


@both
def test_too_many_lost_pulses_lose_the_place(encoder, edmd):
    text, log = said(encoder, edmd)
    assert "axis X: its place is lost" in log
    assert "lost start 0" not in text and "lost start" in text
    assert "home 0" in text


@both
def test_the_brake_is_open_only_under_power(encoder, edmd):
    text, _ = said(encoder, edmd)
    for line in ("before: brake 0 enable 0", "travel: brake 1 enable 1",
                 "later: brake 0 enable 0", "reset: brake 0 enable 0",
                 "goes on: brake 1 enable 1"):
        assert line in text, text
