# SPDX-License-Identifier: Apache-2.0
"""Promises of the S-curve against Ruckig, a planner that is time-optimal."""
import os
import subprocess

import ruckig
from edmsim import HANGS_S, ROOT, seeded

PLANNER = str(ROOT / os.environ.get("EDM_BUILD", "build") / "peer" / "scurve")
CASES = 10000
WITHIN = 0.005


def random_case(rng):
    """Limits and a state from which letting go keeps within v_max."""
    v_max = 10 ** rng.uniform(0, 2.5)
    a_up = v_max * 10 ** rng.uniform(0, 2)
    a_down = a_up * (10 ** rng.uniform(-0.5, 0.5) if rng.random() < 0.5 else 1)
    j_max = a_up * 10 ** rng.uniform(0, 2)
    while True:
        v = rng.choice([0, rng.uniform(-v_max, v_max)])
        a = rng.choice([0, rng.uniform(-a_down, a_up)])
        if abs(v + a * abs(a) / (2 * j_max)) <= 0.999 * v_max:
            return v_max, a_up, a_down, j_max, v, a


def to_place(rng):
    case = random_case(rng)
    way = case[0] ** 2 / case[1] * 10 ** rng.uniform(-3, 1.3)
    return ("place", *case, rng.choice([-way, way]))


def to_speed(rng):
    case = random_case(rng)
    return ("speed", *case, rng.uniform(-0.999, 0.999) * case[0])


def ours(cases):
    text = "".join(" ".join([c[0], *map(repr, map(float, c[1:]))]) + "\n"
                   for c in cases)
    r = subprocess.run([PLANNER], input=text, capture_output=True, text=True,
                       check=True, timeout=HANGS_S)
    return list(map(float, r.stdout.split()))


def optimum(case):
    what, v_max, a_up, a_down, j_max, v, a, goal = case
    want = ruckig.InputParameter(1)
    want.max_velocity, want.max_jerk = [v_max], [j_max]
    want.max_acceleration, want.min_acceleration = [a_up], [-a_down]
    want.current_velocity, want.current_acceleration = [v], [a]
    if what == "place":
        want.target_position = [goal]
    else:
        want.control_interface = ruckig.ControlInterface.Velocity
        want.target_velocity = [goal]
    found = ruckig.Trajectory(1)
    try:
        ruckig.Ruckig(1).calculate(want, found)
    except ruckig.RuckigError:      # it finds none in some cases
        return None
    return found.duration


def compare(make):
    rng = seeded()
    cases = [make(rng) for _ in range(CASES)]
    times = ours(cases)
    assert len(times) == CASES
    compared = 0
    for case, t in zip(cases, times):
        best = optimum(case)
        if best is None:
            continue
        compared += 1
        assert abs(t - best) <= WITHIN * best + 1e-9, (case, t, best)
    assert compared >= 0.99 * CASES, compared


def test_a_place_is_come_to_in_ruckigs_time():
    compare(to_place)


def test_a_speed_is_come_to_in_ruckigs_time():
    compare(to_speed)
