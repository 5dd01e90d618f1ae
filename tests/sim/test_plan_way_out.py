# SPDX-License-Identifier: Apache-2.0
"""edm-plan --end-pose in cavities whose ways out are known, with FCL as the
judge of what is written."""
import json
import re

import pytest
from plan_cavities import CASES, LIFT, tilt
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


def test_an_end_pose_outside_of_the_part_is_refused(tmp_path):
    case = CASES["rib-5-1"]()
    case.end = "X0,Y0,Z0"
    r = ask(tmp_path, case)
    assert r.returncode == 65 and "outside of the part" in r.stderr
