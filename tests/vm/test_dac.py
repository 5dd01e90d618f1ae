# SPDX-License-Identifier: Apache-2.0
"""Peak current and voltage of a generator by outputs of the kernel's industrial
I/O: adc-sim, in virtual time.  guest/dac.sh says what it does.
"""
import math

import pytest
from boot import ADC, Run, checked, machine

# Peak current and open-circuit voltage by outputs of that converter.
DAC = ADC + """
[generator]
interface = lines
peak_a = dac adc-sim voltage0 scale 6 to 10
ignition_v = dac adc-sim voltage1 scale 25 to 10
polarity = line sim1:7
settle_ms = 50
polarity_ms = 20
confirm_s = 2
[tech]
table = outputs.tech
"""
OUTPUTS = """condition, peak_a [A], ignition_v [V], polarity
C001, 6, 180, 1
C002, 16, 100, -1
C003, 60, 250, -1
"""
JOB = ("G21 G90\nC001\nG1 X0.1 F6\nC002\nG1 X0.2\nC003\nG1 X0.3\n"
       "C001\nG1 X0.2\nM30\n")

COUNT_V = 0.0025
# Sparks are line 0, the polarity is line 7.
SPARK, POLARITY = 0, 7


def outputs(peak_a, ignition_v):
    return math.floor(peak_a / 6 / COUNT_V + 1e-6), round(ignition_v / 25 / COUNT_V)


CONDITIONS = {}
for row in OUTPUTS.splitlines()[1:]:
    name, peak_a, ignition_v, polarity = row.split(", ")
    CONDITIONS[name] = (*outputs(float(peak_a), float(ignition_v)),
                        polarity == "-1")


@pytest.fixture(scope="module")
def run():
    """One CPU in virtual time."""
    return checked(Run("dac", {
        "dac.ini": machine(period_us=1000, v=0.5, tail=DAC),
        "in.ini": machine(period_us=1000, v=0.5, tail=DAC.replace(
            "adc-sim voltage0", "adc-sim voltage7")),
        "dac.ngc": JOB, "outputs.tech": OUTPUTS,
    }, "-d"))


@pytest.fixture(scope="module")
def dac(run):
    assert run.text("dac.edmd-rc") == "0\n", run.text("dac")
    return run.text("dac")


def events(text, first):
    """(time, what, level): what is a line, from the chip's first, or "out0"."""
    for row in text.splitlines():
        words = row.split()
        if "gpio_value:" in words:
            at = words.index("gpio_value:")
            yield float(words[at - 1][:-1]), int(words[at + 1]) - first, \
                int(words[-1])
        elif "output" in words:
            at = words.index("output")
            yield float(words[at - 2][:-1]), f"out{words[at + 1]}", int(words[-1])


def sparks_of(text):
    """What the generator was told while there were sparks, in order, with the time
    from the last change of an output to the first spark in s."""
    first = min(int(r.split("gpio_value:")[1].split()[0])
                for r in text.splitlines() if "gpio_value:" in r)
    level = {SPARK: 0, POLARITY: 0, "out0": 0, "out1": 0}
    changed, found = 0, []
    for t, what, value in events(text, first):
        if what == SPARK and value and not level[SPARK]:
            now = (level["out0"], level["out1"], bool(level[POLARITY]))
            if not found or found[-1][0] != now:
                found.append((now, t - changed))
        elif what != SPARK and value != level[what]:
            assert not level[SPARK], (t, what, value)
            changed = t
        level[what] = value
    return found


@pytest.mark.parametrize("trace", ["dac.trace", "slow.trace"])
def test_no_spark_before_the_outputs_are_those_of_the_place(run, dac, trace):
    """Also where each output takes 0.3 s."""
    assert ("slow job: done" if "slow" in trace else "\njob: done") in dac, dac
    found = sparks_of(run.text(trace))
    assert [f[0] for f in found] == [
        CONDITIONS[c] for c in ("C001", "C002", "C003", "C001")], found
    print(trace, [f"{1000 * t:.1f} ms" for _, t in found])
    assert all(t >= 0.05 for _, t in found), found


def test_a_channel_that_is_no_output_is_refused(dac):
    assert "generator.peak_a: " in dac and "out_voltage7_raw: No such file" in dac
    assert "a channel that is an output" in dac
    assert "no output: exit 78" in dac


def test_outputs_are_at_zero_before_and_after(dac):
    assert "begin: 0 0\n" in dac, dac
    assert "end: 0 0\n" in dac, dac


def test_an_output_that_is_too_slow_is_a_fault_without_sparks(run, dac):
    assert "too slow: spark 0" in dac, dac
    assert "peak_a is not in force in confirm_s: asked 6" in run.text("dac.log")


def test_an_output_that_fails_is_a_fault_with_its_field(run, dac):
    assert "deaf: spark 0" in dac, dac
    assert "the converter of peak_a: asked 6: Input/output error" in \
        run.text("dac.log")
    assert "again after deaf: spark 1" in dac, dac


def test_edmctl_says_that_it_is_a_converter(dac):
    row = next(r for r in dac.splitlines() if r.strip().startswith("peak_a"))
    assert "dac" in row and row.endswith(" 0 to 60"), row
