# SPDX-License-Identifier: Apache-2.0
"""Promise of edm-limits: it says of any trace what share of its limits each axis
needs, and refuses what it cannot judge."""
import math
import os
import re
import subprocess
import sys

import pytest

from edmsim import ROOT, done
from speed_programs import machine, program
from speed_tube import DT_S

LINE = re.compile(r"^([A-CU-Z])  v +([\d.]+)  a +([\d.]+)  j +([\d.]+)  "
                  r"all +([\d.]+)  of ", re.M)
WHOLE = "--print-config"


def judged(*args, env=None):
    return subprocess.run(
        [sys.executable, ROOT / "clients/python/edm/limits.py", *map(str, args)],
        capture_output=True, text=True, timeout=3600,
        env={**os.environ, **(env or {})})


def whole(folder, of):
    """The machine file @of with all of its keys."""
    (folder / "whole.ini").write_bytes(done("--machine", of, WHOLE).stdout)
    return folder / "whole.ini"


def shares(text):
    return {m[1]: [float(x) for x in m.groups()[1:]] for m in
            LINE.finditer(text)}


def softer(file, axis, key, by):
    text = file.read_text()
    head, part, rest = re.split(rf"(\[axis\.{axis}\]\n)", text)
    n = float(re.search(rf"(?m)^{key} *= *(\S+)", rest)[1])
    file.write_text(head + part + re.sub(
        rf"(?m)^({key} *= *)\S+", rf"\g<1>{n * by:.6f}", rest, count=1))


def test_a_machine_that_keeps_its_limits_is_said_to(tmp_path):
    p, limits = program("wave", 3)
    of = machine(tmp_path, limits)
    done("--machine", of, "--dry-run", "--trace", tmp_path / "t.csv",
         text=p.text())
    file = whole(tmp_path, of)
    r = judged(file, tmp_path / "t.csv")
    assert r.returncode == 0, r.stdout + r.stderr
    found = shares(r.stdout)
    assert {"X", "Y"} & set(found)
    assert 0.9 < max(s[3] for s in found.values()) <= 1.05, r.stdout

    # The same motion of an axis that can do less.
    most = max(found, key=lambda a: found[a][1])
    softer(file, most, "a_max_mm_s2", found[most][1] / 1.4)
    r = judged(file, tmp_path / "t.csv")
    assert r.returncode == 1, r.stdout + r.stderr
    assert 1.3 < shares(r.stdout)[most][1] < 1.5, r.stdout


# A motion of 5 mm, from a stand to a stand, in 0.4 s; and what it needs.
S = 0.4
NEEDS = [5 * (math.pi / S) ** k for k in (1, 2, 3)]
FILE = "[speed]\ncorner_um = 1\n[axis.X]\npulse_mm = 0.0001\n" \
       "v_max_mm_s = {}\na_max_mm_s2 = {}\nj_max_mm_s3 = {}\n"


def move(folder, head="t_s,line,X", lost=()):
    """Of a machine of another maker: three columns."""
    rows = [f"{i * DT_S:.6f},7,{5 * (1 - math.cos(math.pi * i * DT_S / S)):.4f}"
            for i in range(round(S / DT_S)) if i not in lost]
    (folder / "t.csv").write_text("\n".join([head, *rows, ""]))
    return folder / "t.csv"


@pytest.mark.parametrize("which", range(3))
def test_each_limit_is_judged_by_itself(tmp_path, which):
    limits = [n / 1.2 if k == which else 9 * n for k, n in enumerate(NEEDS)]
    (tmp_path / "m.ini").write_text(FILE.format(*limits))
    r = judged(tmp_path / "m.ini", move(tmp_path))
    found = shares(r.stdout)["X"]
    assert r.returncode == 1
    assert 1.1 < found[which] < 1.21 and 1.1 < found[3] < 1.21, r.stdout
    assert all(s < 0.2 for k, s in enumerate(found[:3]) if k != which), r.stdout
    assert judged("--most", 1.3, tmp_path / "m.ini",
                  tmp_path / "t.csv").returncode == 0


def test_a_cycle_that_is_missing_is_no_step(tmp_path):
    (tmp_path / "m.ini").write_text(FILE.format(*[1.05 * n for n in NEEDS]))
    r = judged(tmp_path / "m.ini", move(tmp_path, lost=range(190, 215)))
    assert r.returncode == 0 and shares(r.stdout), r.stdout + r.stderr


def test_it_refuses_what_it_cannot_judge(tmp_path):
    (tmp_path / "m.ini").write_text(FILE.format(*NEEDS))
    (tmp_path / "short.ini").write_text("[speed]\ncorner_um = 5\n[axis.X]\n")
    (tmp_path / "none").mkdir()
    (tmp_path / "none/highspy.py").write_text("raise ImportError\n")
    trace = move(tmp_path)
    for args, code, said in (
            ((tmp_path / "no.ini", trace), 66, "no.ini"),
            ((tmp_path / "short.ini", trace), 78, "--print-config"),
            ((tmp_path / "m.ini", tmp_path / "no.csv"), 66, "no.csv"),
            (("--of", "is", tmp_path / "m.ini", trace), 65, "X_is")):
        r = judged(*args)
        assert r.returncode == code and said in r.stderr, (args, r.stderr)
    (tmp_path / "soft.ini").write_text(FILE.format(*[n / 2 for n in NEEDS]))
    r = judged(tmp_path / "soft.ini", trace,
               env={"PYTHONPATH": str(tmp_path / "none")})
    assert r.returncode == 69 and "highspy" in r.stderr
    move(tmp_path, head="t_s,line,Y")
    assert judged(tmp_path / "m.ini", trace).returncode == 65
