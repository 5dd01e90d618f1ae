# SPDX-License-Identifier: Apache-2.0
"""Programs as people write them: cut as it is worked out by hand, or refused."""
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString

from edmsim import machine_text, run
from rs274 import canonical_calls, peer
from written import FOLDER, differs, programs, way_of, way_of_iso, way_of_rs274

ALL = [pytest.param(p, id=f"{f.stem}:{p.name}",
                    marks=[peer] if p.kind == "peer" else [])
       for f in sorted(FOLDER.glob("*.txt")) for p in programs(f)]
OFFSETS = "offset_1_mm = 0.14\noffset_2_mm = 0.1"
MACHINE = machine_text(OFFSETS, more="[axis.Z]\ntravel_min_mm = -200\n"
                                     "travel_max_mm = 200\n")
# The guides are in the planes: X Y are the bottom's way, U V the top's.
GUIDES = machine_text(OFFSETS, "absolute", (0, 10), (0, 10))
PULSE_MM = 0.001


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    ini = tmp_path_factory.mktemp("written") / "m.ini"
    ini.write_text(MACHINE)
    ini.with_name("guides.ini").write_text(GUIDES)
    return ini


def faces_of(rows):
    """The ways of the bottom and of the top."""
    head = rows[0].split(",")
    at = PULSE_MM * np.array([[int(v) for v in r.split(",")]
                              for r in rows[1:]])
    return [at[:, [head.index(a) for a in axes]] for axes in ("XY", "UV")]


def assert_faces(p, guides):
    r = run("--machine", guides, "--dialect", p.dialect, "--dry-run",
            "--pulses", "-", text=p.text)
    assert r.returncode == 0, r.stderr
    for got, want in zip(faces_of(r.stdout.decode().splitlines()),
                         p.want.splitlines()):
        want = [at[:2] for at in way_of(want)]
        assert np.abs(got[-1] - want[-1]).max() < 2 * PULSE_MM, p.text
        assert LineString(got).hausdorff_distance(
            LineString(shapely.segmentize(LineString(want), 0.5))) < \
            2.5 * PULSE_MM, p.text


@pytest.mark.parametrize("p", ALL)
def test_a_program_is_cut_as_it_is_written_or_refused(p, machine, tmp_path):
    if p.kind == "faces":
        assert_faces(p, machine.with_name("guides.ini"))
        return
    if p.file == "guides":
        machine = machine.with_name("guides.ini")
    r = run("--machine", machine, "--dialect", p.dialect, "--emit", "iso",
            text=p.text)
    said = r.stderr.decode()
    if p.kind == "refused":
        assert r.returncode == 65 and p.want in said, r.stdout.decode() + said
        return
    assert r.returncode == 0, said
    job = tmp_path / "job.ngc"
    job.write_text(p.text)
    want = way_of_rs274(canonical_calls(job)) if p.kind == "peer" else \
        way_of(p.want)
    wrong = differs(way_of_iso(r.stdout.decode()), want)
    assert not wrong, wrong + "\n" + r.stdout.decode() + said
