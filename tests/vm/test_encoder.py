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
    assert len(ends) == 3, text
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
            assert [e - begun for e in ends] == [200, 400, 1000]
        begun = ends[-1]


@both
def test_an_axis_that_was_pushed_far_is_not_driven_back(encoder, edmd):
    text, _ = said(encoder, edmd)
    pushed = [line.split()[1:] for line in text.splitlines()
              if line.startswith(("pushed: ", "far: "))]
    assert len(pushed) == 2 and pushed[0] == pushed[1], text


@both
def test_nothing_presses_against_a_wall_that_does_not_yield(encoder, edmd):
    """From the stop on, no pulse goes toward it, and each way leads away from where
    the axis stands; when the wall is gone, a job ends where it says."""
    text, _ = said(encoder, edmd)
    rows = [line.rsplit(" ", 2) for line in text.splitlines()
            if line.startswith("wall: ")]
    at = [int(row[1]) for row in rows]
    pressed = [int(row[2]) for row in rows]
    print(f"{edmd}:", *rows, sep="\n")
    assert len(rows) == 7 and pressed[0] > 0, text
    assert set(pressed) == {pressed[0]}, text
    # Two counts are a pulse of 1 um.
    assert [a - at[0] for a in at] == [0, 0, -20, -40, -60, -60, -100], text


@both
def test_the_brake_is_open_only_under_power(encoder, edmd):
    text, _ = said(encoder, edmd)
    for line in ("before: brake 0 enable 0", "travel: brake 1 enable 1",
                 "later: brake 0 enable 0", "reset: brake 0 enable 0",
                 "goes on: brake 1 enable 1"):
        assert line in text, text
