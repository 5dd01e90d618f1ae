# SPDX-License-Identifier: Apache-2.0
"""Random contours under a wire's offset, against shapely's geometry.

EDM_SEED repeats a run, EDM_RUNS says how many contours; `make wire-random`
tries ten thousand.
"""
import os

import pytest
from edmsim import run, seeded
from wire_contours import Contour
from wire_oracle import UM, path_of, read_iso

RUNS = int(os.environ.get("EDM_RUNS", 120))
BOUND_MM = 3 * UM       # docs/taper.md: nearer than the offset by this


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    ini = tmp_path_factory.mktemp("wire") / "plain.ini"
    ini.write_text("[machine]\nname = plain\n")
    return ini


def test_random_contours_are_cut_or_refused_as_geometry_has_it(plain):
    rnd = seeded()
    counts, nearest = {}, 0
    for i in range(RUNS):
        c = Contour(rnd)
        want = c.verdict()
        r = run("--machine", plain, "--emit", "iso", text=c.text)
        assert r.returncode in (0, 1, 65), (r.returncode, r.stderr)
        did = "refuse" if r.returncode else "cut"
        counts[want, did] = counts.get((want, did), 0) + 1
        about = f"contour {i}: {r.stderr.decode()}\n{c.text}"
        assert want in (did, "close"), f"{want} wanted, {did}: {about}"
        if r.returncode:
            assert b"-:" in r.stderr, about
            continue
        ways = read_iso(r.stdout.decode())
        gap = path_of(ways[2:-1]).distance(c.poly.exterior)
        nearest = max(nearest, c.offset - gap)
        assert gap >= c.offset - BOUND_MM, \
            f"{gap} mm near under {c.offset}: {about}"
    print(f"{counts}; nearer by {1000 * nearest:.2f} um at the worst")
