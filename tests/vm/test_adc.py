# SPDX-License-Identifier: Apache-2.0
"""The gap by a converter of the kernel's industrial I/O: adc-sim, in virtual
time.  guest/adc.sh says what it does; a count is 0.04 V.
"""
import json

import pytest


@pytest.fixture(scope="module")
def adc(encoder):
    for n in 1, 2, 3:
        assert encoder.text(f"adc{n}.edmd-rc") == "0\n", encoder.text("adc")
    return encoder.text("adc"), [encoder.text(f"adc{n}.log") for n in (1, 2, 3)]


def test_another_reader_is_not_robbed(adc):
    said, _ = adc
    assert "a device that no other program reads" in said
    assert "in use: exit 69, its buffer 1" in said


def test_its_own_channel_alone_is_read(encoder, adc):
    """Two others of the scan were on before."""
    gap_v = json.loads(encoder.text("adc.json"))["gap_v"]
    print(f"400 counts of 0.04 V: {gap_v} V")
    assert abs(gap_v - 16) < 0.1


def test_a_gap_is_open_cut_and_short_as_it_says(adc):
    for line in "open: spark 1", "cuts: spark 1", "short: spark 0":
        assert line in adc[0], adc


def test_few_samples_are_told_and_are_no_fault(adc):
    said, (log, *_) = adc
    assert [line.split()[-1] for line in said.splitlines()
            if line.startswith("slow: ")] == ["none"], said
    assert "most periods have no sample of it" in log


def test_what_it_kept_during_a_pause_is_not_the_gap(adc):
    said, (log, *_) = adc
    assert "\nafter a pause: spark 0" in said
    assert "again after a pause: spark 1" in said
    assert "samples were lost" in log


@pytest.mark.parametrize("what", ["upper end", "lower end", "still", "off",
                                  "gone"])
def test_what_is_no_voltage_ends_the_sparks(adc, what):
    assert f"\n{what}: spark 0" in adc[0], adc


@pytest.mark.parametrize("what", ["upper end", "lower end", "still"])
def test_it_cuts_on_when_voltages_come_again(adc, what):
    assert f"again after {what}: spark 1" in adc[0], adc


def test_what_is_wrong_with_it_is_in_the_log(adc):
    _, (first, second, _) = adc
    assert "it is at the end of its range" in first
    assert "it cannot be read any more" in second
    assert (first + second).count("cycle: fault gap-lost") >= 5


def test_one_that_was_away_is_read_by_the_next_edmd(adc):
    said, _ = adc
    assert "a new edmd: spark 1" in said
    assert "bound again: spark 0" in said
    assert "bound again, a new edmd: spark 1" in said
