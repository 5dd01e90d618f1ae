# SPDX-License-Identifier: Apache-2.0
"""What probing promises: the simulated block is found where it is."""
import json
import random

import pytest
from edmsim import ROOT, places, report, run

BLOCK = """
[axis.X]
start_mm = {at[0]}
[axis.Y]
start_mm = {at[1]}
[axis.Z]
start_mm = {at[2]}
[probe]
feed_mm_s = 2
[sim]
block = yes
block_x_min_mm = {low[0]}
block_x_max_mm = {high[0]}
block_y_min_mm = {low[1]}
block_y_max_mm = {high[1]}
block_top_mm = {top}
bore_x_mm = {bore[0]}
bore_y_mm = {bore[1]}
bore_mm = {bore[2]}
feeler_mm = {feeler}
"""


def machine(tmp_path, **given):
    values = {"low": (-10, -10), "high": (10, 10), "top": 0,
              "bore": (0, 0, 0), "feeler": 4, "at": (0, 0, 5)} | given
    path = tmp_path / "machine.ini"
    path.write_text(BLOCK.format(**values))
    return path


def end(m, text):
    """Where X Y Z stand at the end, mm."""
    return [p / 1000 for p in places("--machine", m, text=text)[-1][:3]]


@pytest.mark.parametrize("seed", range(4))
def test_the_centre_of_a_hole_is_found(tmp_path, seed):
    r = random.Random(seed)
    x, y = r.uniform(-3, 3), r.uniform(-3, 3)
    m = machine(tmp_path, bore=(x, y, 9), at=(x + r.uniform(-1, 1),
                                              y + r.uniform(-1, 1), 5))
    at = end(m, "G91 G0 Z-8\nG160\nG92 X0 Y0\nG90 G0 X1 Y-1\n")
    assert at[0] - 1 == pytest.approx(x, abs=0.002)
    assert at[1] + 1 == pytest.approx(y, abs=0.002)


def test_a_second_pass_finds_the_same_centre(tmp_path):
    m = machine(tmp_path, bore=(1.234, -2.345, 9), at=(2, -3, 5))
    once = end(m, "G91 G0 Z-8\nG160\n")
    assert end(m, "G91 G0 Z-8\nG160 L2\n") == pytest.approx(once, abs=0.001)


@pytest.mark.parametrize("seed", range(3))
def test_the_middle_of_a_block_is_found_from_outside(tmp_path, seed):
    r = random.Random(seed)
    low = [r.uniform(-12, -8), r.uniform(-12, -8)]
    high = [r.uniform(8, 12), r.uniform(8, 12)]
    m = machine(tmp_path, low=low, high=high, at=(0.7, -0.4, 5))
    at = end(m, "G161 I17 J17 K8\nG92 X0 Y0\n")
    for i in range(2):
        assert at[i] == pytest.approx((low[i] + high[i]) / 2, abs=0.002)
    assert at[2] == 5


def test_a_corner_is_found(tmp_path):
    m = machine(tmp_path, low=(-9.876, -8.765), at=(-17, -16, -2))
    at = end(m, "G162 X+ Y+ I10 J10\nG92 X-2.1 Y-2.1\nG90 G0 Z8\nG0 X0 Y0\n")
    assert at[:2] == pytest.approx((-9.876, -8.765), abs=0.002)


@pytest.mark.parametrize("way, face", [("X+", -9.5), ("X-", 9.25)])
def test_an_edge_is_found(tmp_path, way, face):
    sign = 1 if way == "X+" else -1
    m = machine(tmp_path, low=(-9.5, -10), high=(9.25, 10),
                at=(-20 * sign, 0, -2))
    at = end(m, f"G80 {way}\nG92 X{-2 * sign}\nG90 G0 X{-3 * sign}\n")
    assert at[0] == pytest.approx(face - 3 * sign, abs=0.002)


def test_the_upper_face_is_found_and_cut_from(tmp_path):
    m = machine(tmp_path, top=-1.5)
    text = "G80 Z-\nG92 Z0\nG90 G0 Z0.5\nM3\nG1 Z-0.2 F20\nM5\nG0 Z1\n"
    assert end(m, text)[2] == pytest.approx(-0.5, abs=0.002)
    r = report("--machine", m, text=text)
    assert r["outcome"] == "done" and r["removed_mm3"] > 0
    deepest = min(p[2] for p in places("--machine", m, text=text))
    assert deepest == pytest.approx(-1700, abs=2)


def test_a_limit_is_a_pulse_short_of_the_travel(tmp_path):
    m = machine(tmp_path, top=-1.5)
    at = end(m, "G80 Z-\nG81 Z+\nG81 X-\n")
    assert at == [-199.999, 0, 199.999]


def fault(m, text):
    r = run("--machine", m, "--report", "-", text=text)
    assert r.returncode == 1
    return json.loads(r.stdout)["fault"]


def test_no_contact_and_contact_at_once_are_faults(tmp_path):
    m = machine(tmp_path)
    assert fault(m, "G80 Z4\n") == "no-contact"
    assert fault(m, "G80 Z+\n") == "no-contact"
    assert fault(m, "G80 Z-\nG80 X-\n") == "contact"


def test_the_example_finds_its_hole(tmp_path):
    m = ROOT / "examples" / "probe.ini"
    job = ROOT / "examples" / "probe.ngc"
    r = run("--machine", m, "--report", "-", job)
    assert r.returncode == 0, r.stderr
    assert json.loads(r.stdout)["outcome"] == "done"
    rows = run("--machine", m, "--pulses", "-", job).stdout.splitlines()
    x, y = (int(v) for v in rows[-1].split(b",")[2:4])
    assert abs(x - 12400) <= 2 and abs(y + 7250) <= 2


def test_a_block_without_an_inside_is_refused(tmp_path):
    m = machine(tmp_path, low=(10, -10), high=(10, 10))
    r = run("--machine", m, text="G80 Z-\n")
    assert r.returncode != 0
    assert b"block_x_min_mm 10 mm is not below" in r.stderr


def test_a_dry_run_leaves_probing_out(tmp_path):
    m = machine(tmp_path)
    assert report("--machine", m, "--dry-run",
                  text="G160\nG92 X0 Y0\nG90 G0 X3\n")["outcome"] == "done"


def test_what_would_leave_the_travel_is_told_at_the_contact(tmp_path):
    m = machine(tmp_path, low=(3, -10), at=(0, 0, -2))
    text = "G80 X+\nG92 X0\nG0 X-{}\nX0\nM2\n"
    assert end(m, text.format(201))[0] == pytest.approx(1, abs=0.002)
    r = run("--machine", m, "--pulses", tmp_path / "p.csv", "--report", "-",
            text=text.format(202))
    assert json.loads(r.stdout)["fault"] == "soft-limit"
    rows = (tmp_path / "p.csv").read_text().splitlines()
    assert int(rows[-1].split(",")[2]) == pytest.approx(1000, abs=2)


ARC = "M5\nG92 X0\nG0 X-20\nG2 X-20 Y0 I{} J0 F600\nM2\n"


@pytest.mark.parametrize("way, low, high", [
    ("X+", 3, 10), ("X-", -10, -3), ("X20", 3, 10)])
def test_an_arc_behind_a_contact_counts_from_it(tmp_path, way, low, high):
    """As written it would lie a travel farther on."""
    m = machine(tmp_path, low=(low, -10), high=(high, 10), at=(0, 0, -2))
    at = end(m, f"G80 {way}\n" + ARC.format(5))
    assert at[0] + 20 == pytest.approx(-1 if way == "X-" else 1, abs=0.002)


def last_place(tmp_path, m, text, *args):
    r = run("--machine", m, "--pulses", tmp_path / "p.csv", "--report", "-",
            *args, text=text)
    assert json.loads(r.stdout)["fault"] == "soft-limit"
    last = (tmp_path / "p.csv").read_text().splitlines()[-1].split(",")
    return [int(p) for p in last[2:5]]


def test_an_arc_that_would_leave_the_travel_is_told_at_the_contact(tmp_path):
    m = machine(tmp_path, low=(3, -10), at=(0, 0, -2))
    end(m, "G80 X+\n" + ARC.format(-90.495))
    for radius in (-90.51, -95, 110):
        x = last_place(tmp_path, m, "G80 X+\n" + ARC.format(radius))[0]
        assert x == pytest.approx(1000, abs=2)


@pytest.mark.parametrize("beyond", ["G0 Y{}", "G1 Y{} F600",
                                    "G1 Y-1 F60\nY{}\nY-1"])
def test_what_would_leave_the_travel_is_told_at_a_limit(tmp_path, beyond):
    m = machine(tmp_path)
    text = f"M5\nG81 Y+\nG92 Y0\nG0 Y-2\n{beyond}\nM2\n"
    places("--machine", m, text=text.format(0.001))
    assert last_place(tmp_path, m, text.format(0.002))[1] == 199999


def test_what_would_leave_the_travel_is_told_at_a_half(tmp_path):
    m = machine(tmp_path, bore=(0, 0, 9), at=(0.7, 0, -2))
    text = "G91\nG80 X-\nG0 X1\nG80 X+\nG82 X\nG90\nG92 X0\nG0 X{}\nM2\n"
    assert end(m, text.format(199.9))[0] == pytest.approx(199.9, abs=0.002)
    x = last_place(tmp_path, m, text.format(200.1))[0]
    assert x == pytest.approx(0, abs=2)


def test_a_dry_run_tells_where_it_stands_what_would_leave_the_travel(tmp_path):
    m = machine(tmp_path, at=(1, 0, 5))
    text = "G80 X-\nG92 X0\nG0 X{}\nM2\n"
    assert places("--dry-run", "--machine", m,
                  text=text.format(199))[-1][0] == 200000
    assert last_place(tmp_path, m, text.format(199.001),
                      "--dry-run") == [1000, 0, 5000]
