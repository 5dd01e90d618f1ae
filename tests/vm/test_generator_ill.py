# SPDX-License-Identifier: Apache-2.0
"""No spark has another condition than its place's, whatever happens to the cut.

guest/generator_ill.py disturbs it.  The kernel traces the pulses of X and the line
that allows sparks, so nothing that edmd says of itself is believed: the pulses give
the place, the place gives the condition and the electrode's polarity, and the
generator has written down what it had.
"""
import bisect
import json
import os
import random

import pytest
from boot import GAP, HERE, Run, checked, machine

SEED = int(os.environ.get("EDM_SEED", "45"))
EVENTS = int(os.environ.get("EDM_EVENTS", "40"))
CUT_UM, CUTS, NEAR_UM = 20, 400, 3
# silent_ms, and what it takes to end sparks: until then a loss may be unknown.
UNKNOWN_S = 0.2 + 0.05
NOTHING = (0,) * 6
# Registers: 0.1 A, 0.1 us, 0.1 us, V, 0.1 V; C202 has the servo's own voltage of
# the machine file.
OWN = 250
CONDS = {"C200": (60, 80, 200, 180, 150), "C201": (155, 500, 1000, 120, 225),
         "C202": (90, 80, 200, 90, OWN)}
WORDS = ("M3", "M4", "M5", "T84", "T85\nT84", "G4 P0.02")
CHANGE_EACH = 8

ILL = GAP.replace("pump = 7\n", "") + """
[generator]
interface = modbus
modbus = 127.0.0.1:5020
modbus_every_ms = 20
peak_a = register 10 scale 0.1
on_us = register 11 scale 0.1
off_us = register 12 scale 0.1
ignition_v = register 13
servo_v = register 14 scale 0.1
polarity = register 15 bit 0
told_peak_a = input 30 scale 0.1
told_on_us = input 31 scale 0.1
told_off_us = input 32 scale 0.1
told_ignition_v = input 33
told_servo_v = input 34 scale 0.1
told_polarity = input 35 bit 0
pump = line sim1:8
settle_ms = 200
[tech]
table = ill.tech
"""


def cuts(seed):
    """Text of the job, and what each cut has: values, or None for no sparks."""
    rnd = random.Random(seed)
    text, has, power, negative = ["G21 G90 T84"], [], True, 0
    for i in range(CUTS):
        cond = rnd.choice(list(CONDS))
        words = rnd.sample(WORDS, rnd.choice((0, 0, 1, 2, 3, 4)))
        if i % CHANGE_EACH == 0:        # a program has 63 at most
            words.append(f"T{1 + i // CHANGE_EACH % 2} M6")
            rnd.shuffle(words)
        for w in words:
            power = {"M3": True, "M4": True, "M5": False}.get(w, power)
            negative = {"M3": 0, "M4": 1}.get(w, negative)
        text += [cond] + words + [
            f"G1 X{(i + 1) * CUT_UM / 1000:.3f} F6"]
        has.append((*CONDS[cond], negative) if power else None)
    return "\n".join(text + ["M30", ""]), has


def tech():
    rows = [f"{c}, {p / 10:g}, {on / 10:g}, {off / 10:g}, {v}, " +
            ("-" if servo == OWN else f"{servo / 10:g}")
            for c, (p, on, off, v, servo) in CONDS.items()]
    return "\n".join(["condition, peak_a [A], on_us [us], off_us [us], "
                      "ignition_v [V], servo_v [V]"] + rows + [""])


@pytest.fixture(scope="module")
def run():
    return checked(Run("generator_ill", {
        "ill.ini": machine(tail=ILL), "ill.tech": tech(),
        "ill.ngc": cuts(SEED)[0], "seed": f"{SEED} {EVENTS}\n",
        "generator_ill.py": (HERE / "guest/generator_ill.py").read_text(),
    }, "-d"))


@pytest.fixture(scope="module")
def said(run):
    assert run.text("ill.rc") == "0\n", run.text("ill.txt") + run.text("ill.log")
    return json.loads(run.text("ill.json"))


def walk(run, said):
    """(from, to, [places in um]) of each time with sparks."""
    spark = run.text("spark").strip()
    rows = [(float(t), line, int(level)) for t, line, level, *_ in
            (r.split() for r in run.text("ill.trace").splitlines())]
    rows += [(t, "kill", 0) for t in said["kills"]]
    um, level, since, places, all_of = 0, {}, None, [], []
    plus = None
    for t, line, on in sorted(rows):
        if line in (spark, "kill"):
            if since is not None and not on:
                all_of.append((since, t, places))
            since = (since or t) if on else None
            places = [um] if on and not places or not on else places
        rises = line == "0" and on and not level.get("0")
        level[line] = on
        if rises:
            plus = level.get("1") if plus is None else plus
            um += 1 if level.get("1") == plus else -1
            places = places + [um] if since else []
    return all_of, um


def of_place(has, um, peaks):
    """What may be in force there; at a node, that of either side.  A person may
    have set one of @peaks in it."""
    at = {min(max(um + d, 0) // CUT_UM, len(has) - 1)
          for d in (-NEAR_UM, 0, NEAR_UM)}
    return [(peak, *has[i][1:]) for i in at if has[i]
            for peak in (has[i][0], *peaks)]


def had_during(had, begin, end):
    """What the generator had in that time and since when, the first one first."""
    times = [t for t, _ in had]
    first = bisect.bisect_right(times, begin) - 1
    return [(t, tuple(v)) for t, v in
            had[first:bisect.bisect_left(times, end)]]


def test_much_happened_to_it(run, said):
    sparks, um = walk(run, said)
    print(f"{len(sparks)} times with sparks, {um} um, {len(said['kills'])} kills, "
          f"{len(said['had'])} changes")
    assert len(said["did"]) == EVENTS
    assert len(sparks) > EVENTS / 2 and um > 200
    assert {v[0] for _, v in said["had"]} & {peak for _, peak in said["sets"]}


def test_each_spark_has_the_condition_of_its_place(run, said):
    has = cuts(SEED)[1]
    for begin, end, places in walk(run, said)[0]:
        since, values = had_during(said["had"], begin, end)[0]
        if values == NOTHING and begin - since < UNKNOWN_S:
            continue
        peaks = {peak for t, peak in said["sets"] if t < end}
        for um in places:
            assert values in of_place(has, um, peaks), (begin, um, values)


def test_nothing_changes_while_there_are_sparks_but_by_the_generator(run, said):
    """It may lose all.  Then the sparks end soon, before it has anything again."""
    for begin, end, _ in walk(run, said)[0]:
        had = had_during(said["had"], begin, end)
        assert [v for _, v in had[1:]] in ([], [NOTHING]), (begin, end, had)
        since, values = had[-1]
        assert values != NOTHING or end - since < UNKNOWN_S, (end, since)
