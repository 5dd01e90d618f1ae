# SPDX-License-Identifier: Apache-2.0
"""Geometry: maps of errors between the path and what the drives are sent."""
import csv
import io

import pytest
from edmsim import ROOT, done, run

WORN = ROOT / "examples" / "worn.maps"
JOB = """G21 G90 G17 F600
G1 X40 Y-10
G2 X-60 Y20 R80
G1 Z-30
M2
"""
# Taken up as fast as the path can ask for it.
PACE = "".join(f"[axis.{a}]\nbacklash_mm_s = 1000\n" for a in "XYZ")

PITCH_X = [(-150, 12.5), (-100, 7), (-50, 2.5), (0, 0), (40, -1.5),
           (100, -6), (150, -8)]
STRAIGHT_Y = [(-150, 3), (0, 0), (75, -2.5), (150, 1)]


def between(points, x):
    """The file's own rule, written down anew."""
    if x <= points[0][0]:
        return points[0][1]
    for (a, ya), (b, yb) in zip(points, points[1:]):
        if x <= b:
            return ya + (yb - ya) * (x - a) / (b - a)
    return points[-1][1]


def errors_mm(x, z, over_k):
    return {
        "X": between(PITCH_X, x) / 1e3 - 60e-6 * z
        + 11.5e-6 * over_k * (x + 150),
        "Y": between(STRAIGHT_Y, x) / 1e3 + 35e-6 * x,
        "Z": 23e-6 * over_k * (z - 125),
    }


def rows(tmp_path, over_k, *args):
    machine = tmp_path / "m.ini"
    machine.write_text(f"[geometry]\nmaps = {WORN}\nover_k = {over_k}\n"
                       + PACE)
    text = done("--machine", machine, "--dry-run", "--trace", "-", *args,
                text=JOB).stdout.decode()
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.parametrize("over_k", [0, 4])
def test_the_tool_is_where_the_path_is(tmp_path, over_k):
    """Sent and erring, the machine stands on its place."""
    found = rows(tmp_path, over_k)
    assert len(found) > 10000
    off = off_uncured = 0
    for r in found[20:]:
        sent = {a: float(r[a + "_sent"]) for a in "XYZ"}
        e = errors_mm(sent["X"], sent["Z"], over_k)
        plain = errors_mm(float(r["X"]), float(r["Z"]), over_k)
        for a in "XYZ":
            off = max(off, abs(sent[a] + e[a] - float(r[a])))
            off_uncured = max(off_uncured, abs(plain[a]))
    assert off <= 0.6e-3
    assert off_uncured > 3e-3


def test_back_is_the_same_pulses_in_reverse(tmp_path):
    found = rows(tmp_path, 3, "--there-and-back")
    sent = {}
    for r in found[20:]:
        place = tuple(r[a] for a in "XYZ")
        drives = tuple(r[a + "_sent"] for a in "XYZ")
        assert sent.setdefault(place, drives) == drives
    assert len(found) > 1.5 * len(sent)


def test_a_file_that_is_none_is_refused_with_line_and_column(tmp_path):
    (tmp_path / "m.maps").write_text("pitch X\n-1 0\n1 25\n")
    (tmp_path / "m.ini").write_text("[geometry]\nmaps = m.maps\n")
    r = run("--machine", tmp_path / "m.ini", "--dry-run", text=JOB)
    assert r.returncode == 78
    assert b"m.ini:2:" in r.stderr
    assert b"m.maps:3:1: too steep from the point before it; at most 10 um" \
        in r.stderr
