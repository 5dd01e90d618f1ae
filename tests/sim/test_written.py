# SPDX-License-Identifier: Apache-2.0
"""Programs as people write them: cut as it is worked out by hand, or refused."""
import pytest

from edmsim import run
from rs274 import canonical_calls, peer
from written import FOLDER, differs, programs, way_of, way_of_iso, way_of_rs274

ALL = [pytest.param(p, id=f"{f.stem}:{p.name}",
                    marks=[peer] if p.kind == "peer" else [])
       for f in sorted(FOLDER.glob("*.txt")) for p in programs(f)]
MACHINE = """[machine]
name = m
[wire]
offset_1_mm = 0.14
offset_2_mm = 0.1
[axis.Z]
travel_min_mm = -200
travel_max_mm = 200
"""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    ini = tmp_path_factory.mktemp("written") / "m.ini"
    ini.write_text(MACHINE)
    return ini


@pytest.mark.parametrize("p", ALL)
def test_a_program_is_cut_as_it_is_written_or_refused(p, machine, tmp_path):
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
