# SPDX-License-Identifier: Apache-2.0
"""edm-plan --end-pose in cavities whose ways out are known, with FCL as the
judge of what is written."""
import json
import random
import re

import pytest
from plan_cavities import CASES, LIFT, Case, block_round, prism, tilt
from shapely.geometry import Polygon, box
from test_plan import plan
from test_plan_judge import least, model

# The one behind @ is turned about an axis by chance, of that seed.
QUICK = ["rib-5-1", "rib-25-0.4", "turns-1", "turns-3", "turns-2-narrow",
         "inclined-2", "dead-end", "dovetail", "rib-10-1@1", "turns-2@2",
         "inclined-4@3"]
CHAIN = [("X", 0), ("Y", 0), ("Z", 0)]


def ask(folder, case, *more, clearance=None):
    case.write(folder)
    return plan("--part", folder / "part.stl", "--electrode",
                folder / "electrode.stl", "--machine", folder / "machine.ini",
                "--clearance", clearance or case.gap / 2, "--chord", 0,
                "--end-pose", case.end, "--output", folder / "way.ngc",
                "--report", folder / "r.json", *more)


def bowl():
    cavity = Polygon([(-20, 0), (-20, -40), (-3, -40), (-3, -55), (3, -55),
                      (3, -40), (20, -40), (20, 0)])
    case = Case(block_round(cavity, 12, (-30, 30)),
                prism(box(-2, -54, 2, -34), -4, 4), 1, 1.0)
    write = case.write

    def with_short_travel(folder):
        write(folder)
        text = (folder / "machine.ini").read_text()
        (folder / "machine.ini").write_text(re.sub(
            r"(\[axis.Z\])[^[]*", r"\1\ntravel_min_mm = -60\n"
            r"travel_max_mm = -36\nstart_mm = -38\n", text))
    case.write = with_short_travel
    return case


def nodes(text):
    """Poses of the cut, from its mouth on."""
    at, out = dict.fromkeys("XYZ", 0.0), []
    for line in text.splitlines():
        for a, v in re.findall(r"([XYZ])(-?[0-9.]+)", line.split("(")[0]):
            at[a] = float(v)
        if line.startswith("M3") or line.startswith("G1"):
            out.append(dict(at))
    return out


@pytest.mark.parametrize("name", QUICK)
def test_a_known_way_is_found_in_as_few_blocks(tmp_path, name):
    name, _, seed = name.partition("@")
    case = CASES[name](tilt(int(seed))) if seed else CASES[name]()
    r = ask(tmp_path, case)
    assert r.returncode == 0, r.stderr
    way = json.loads((tmp_path / "r.json").read_text())["written"]
    assert way["blocks"] <= case.blocks
    assert way["proved_mm"] >= 0.95 * case.gap - 0.01
    path = nodes((tmp_path / "way.ngc").read_text())
    assert path[-1] == {"X": 0, "Y": 0, "Z": -LIFT}
    assert least(model(case.part), model(case.electrode), CHAIN,
                 path) >= case.gap / 2


def test_it_is_proved_that_a_cage_has_no_way_out(tmp_path):
    r = ask(tmp_path, CASES["caged"]())
    assert r.returncode == 1 and "it is proved that no way leads" in r.stderr
    assert not (tmp_path / "way.ngc").exists()


def test_a_machine_may_stand_in_a_bowl(tmp_path):
    """Its travel does not lead out of the part, but to where it stands."""
    case = bowl()
    r = ask(tmp_path, case)
    assert r.returncode == 0, r.stderr
    path = nodes((tmp_path / "way.ngc").read_text())
    assert path[-1] == {"X": 0, "Y": 0, "Z": -LIFT}
    assert least(model(case.part), model(case.electrode), CHAIN,
                 path) >= case.gap / 2


def test_a_way_that_is_not_found_says_how_far_it_came(tmp_path):
    """With a rotary axis nothing is proved of it: the search ends in time."""
    case = CASES["caged"]()
    case.chain = "X Y Z C"
    r = ask(tmp_path, case, "--budget", 2)
    assert r.returncode == 1
    assert re.search(r"no way out found that keeps 0.300 mm, in \d+ slides from "
                     r"\d+ places.*mm of the way", r.stderr)
    assert "electrode's triangle" in r.stderr
    assert not (tmp_path / "way.ngc").exists()


def test_the_same_bodies_give_the_same_way(tmp_path):
    case = CASES["inclined-1"]()
    assert ask(tmp_path, case).returncode == 0
    first = (tmp_path / "way.ngc").read_text()
    assert ask(tmp_path, case).returncode == 0
    assert (tmp_path / "way.ngc").read_text() == first


def with_needles(tris):
    """An edge of each triangle is cut in two, and a triangle without area is
    between it and its neighbour."""
    out = []
    for a, b, c in tris:
        mid = tuple((x + y) / 2 for x, y in zip(a, b))
        out += [(a, mid, c), (mid, b, c), (a, b, mid)]
    return out


@pytest.mark.parametrize("needles", (False, True))
def test_corners_may_be_a_little_apart(tmp_path, needles):
    draw = random.Random(5)
    case = CASES["turns-2"](tilt(5))

    def noisy(tris):
        return [tuple(tuple(x + draw.uniform(-1e-6, 1e-6) for x in p)
                      for p in t)
                for t in (with_needles(tris) if needles else tris)]
    case.part, case.electrode = noisy(case.part), noisy(case.electrode)
    r = ask(tmp_path, case)
    assert r.returncode == 0, r.stderr
    way = json.loads((tmp_path / "r.json").read_text())["written"]
    assert way["blocks"] <= case.blocks


def test_an_end_pose_outside_of_the_part_is_refused(tmp_path):
    case = CASES["rib-5-1"]()
    case.end = "X0,Y0,Z0"
    r = ask(tmp_path, case)
    assert r.returncode == 65 and "outside of the part" in r.stderr
