# SPDX-License-Identifier: Apache-2.0
"""Technology tables: what conditions change, and what is refused."""

import re
import subprocess

import edmsim
import pytest
from edmsim import HANGS_S, PROGRAM, ROOT

MACHINE = str(ROOT / "examples/machine.ini")
JOB = b"G21 G90\nG0 Z1\nZ0\nC120 G1 Z-0.3 F30\nM2\n"


def table(tmp_path, text, name="t.tech"):
    path = tmp_path / name
    path.write_text(text)
    return str(path)


def report(tech, *more, job=JOB):
    return edmsim.report("--machine", MACHINE, "--tech", tech,
                         *more, text=job)


def test_a_condition_changes_how_the_gap_is_cut(tmp_path):
    def cut(values):
        return report(table(tmp_path, f"condition,servo_v,jump_every_s,"
                            f"feed_max_mm_s\nC120,{values}\n"))

    usual = cut("-,-,-")
    seldom = cut("-,20,-")
    slow = cut("-,-,0.002")
    assert {r["outcome"] for r in (usual, seldom, slow)} == {"done"}
    assert seldom["jumps"] < usual["jumps"] / 3
    assert slow["erosion_s"] > 1.4 * usual["erosion_s"]
    # Without a table the word is recorded and nothing is changed.
    bare = edmsim.report("--machine", MACHINE, text=JOB)
    for key in ("cycles", "jumps", "retracts", "removed_mm3"):
        assert bare[key] == usual[key], key


def test_each_stretch_goes_by_its_own_condition(tmp_path):
    tech = table(tmp_path, "condition,feed_max_mm_s\nC110,0.002\nC120,-\n")
    trace = tmp_path / "trace.csv"
    job = (b"G21 G90\nG0 Z1\nZ0\nF30\nC120 G1 Z-0.1\nC110 Z-0.12\n"
           b"C120 Z-0.2\nM2\n")
    report(tech, "--trace", str(trace), job=job)
    rows = [r.split(",") for r in trace.read_text().splitlines()[1:]]
    eroding = [(float(s), float(v)) for _, _, s, v, _, state, *_ in rows
               if state == "erode"]
    slow = [v for s, v in eroding if 2.102 < s < 2.118]
    fast = [v for s, v in eroding if s < 2.098 or s > 2.122]
    assert slow and max(slow) < 0.002 + 0.0011  # a pulse in a cycle is 1 mm/s
    assert sum(slow) / len(slow) < 0.0021
    assert max(fast) > 0.002


def test_the_report_has_what_each_condition_took(tmp_path):
    tech = table(tmp_path, "condition,feed_max_mm_s\nC110,0.002\nC120,-\n")
    r = report(tech, job=b"G21 G90\nG0 Z1\nZ0\nF30\nC120 G1 Z-0.1\n"
               b"C110 Z-0.15\nC120 Z-0.2\nM2\n")
    spent = {x["condition"]: x for x in r["conditions"]}
    assert set(spent) == {"C110", "C120"}
    assert sum(x["erosion_s"] for x in spent.values()) == pytest.approx(
        r["erosion_s"], abs=0.01)
    assert spent["C110"]["erosion_s"] < spent["C110"]["virtual_s"]


def test_a_sequence_sinks_rough_to_fine(tmp_path):
    r = edmsim.done("--machine", MACHINE, "--tech",
                    str(ROOT / "examples/copper-steel.tech"), "--check",
                    text=b"G21 G90\nG0 Z1\nZ0\nF30\nG120 P1 Z-2\nM2\n")
    rows = [x.split() for x in r.stdout.decode().splitlines()
            if x.lstrip().startswith("C1")]
    assert [x[0] for x in rows] == ["C120", "C110", "C100"]
    assert [float(x[3]) for x in rows] == [-1.88, -1.965, -2]
    assert [float(x[5]) for x in rows] == [0.08, 0.02, 0]
    assert float(rows[0][6]) == pytest.approx(188)
    assert float(rows[0][7]) == pytest.approx(188 / 35, abs=0.01)


def test_tables_of_the_project_are_taken_and_written_back(tmp_path):
    for name in ("copper-steel.tech", "sedm.enc"):
        def printed(path):
            return edmsim.done("--tech", path, "--print-tech").stdout.decode()

        once = printed(str(ROOT / "examples" / name))
        assert once == printed(table(tmp_path, once))


def test_the_table_of_the_machine_file_is_beside_it(tmp_path):
    table(tmp_path, "condition,servo_v\nC120,18\n", "shop.tech")
    machine = tmp_path / "m.ini"
    machine.write_text("[tech]\ntable = shop.tech\n")
    args = ("--machine", str(machine), "--check")
    edmsim.done(*args, text=JOB)
    r = edmsim.run(*args, text=JOB.replace(b"C120", b"C121"))
    assert r.returncode == 65
    assert b"-:4:1: error: C121, which is not in the technology table; " in (
        r.stderr)
    (tmp_path / "shop.tech").unlink()
    r = edmsim.run(*args, text=JOB)
    assert r.returncode == 66
    assert b"shop.tech: No such file" in r.stderr


def test_edmd_checks_the_files_that_its_machine_file_names(tmp_path):
    """A table and a dialect that only a job needs, before there is a job."""
    path = tmp_path / "m.ini"
    (tmp_path / "bad.tech").write_text("condition,servo_v\nC1,much\n")
    (tmp_path / "bad.ini").write_text("[dialect]\nbase = nobody\n")

    def check(text):
        path.write_text("[machine]\nname = m\n" + text)
        p = subprocess.run([PROGRAM.replace("edmsim", "edmd"), "--config",
                            str(path), "--check"], capture_output=True,
                           text=True, timeout=HANGS_S)
        assert ("good" in p.stdout) == (p.returncode == 0)
        return p.returncode, p.stderr

    assert check("") == (0, "")
    code, told = check("[tech]\ntable = no.tech\n")
    assert code == 66 and f"{tmp_path}/no.tech: No such file" in told
    code, told = check("[tech]\ntable = bad.tech\n")
    assert code == 78 and f"{tmp_path}/bad.tech:2:4: error: " in told
    code, told = check("[nc]\ndialect = bad.ini\n")
    assert code == 78 and f"{tmp_path}/bad.ini:2:" in told
    code, told = check("[nc]\ndialect = fanuk\n")
    assert code == 78 and "dialect fanuk: no dialect" in told
    code, told = check("[tech]\ntable = no.tech\n[nc]\ndialect = no.ini\n")
    assert code == 66 and "no.tech" in told and "no.ini" in told


def test_edmd_says_that_it_cannot_read_a_pipe_twice():
    p = subprocess.run([PROGRAM.replace("edmsim", "edmd"), "--config",
                        "/dev/stdin", "--check"], capture_output=True,
                       input="[machine]\nname = m\n[tech]\ntable = no.tech\n",
                       text=True, timeout=HANGS_S)
    assert p.returncode == 0
    assert "were not read: it is not a file that can be read twice" in p.stdout


def test_a_bad_table_is_refused_with_its_place(tmp_path):
    bad = table(tmp_path, "# one\ncondition,servo_v,open_v\nC120,70,\n")
    r = edmsim.run("--machine", MACHINE, "--tech", bad, "--check",
                   text=JOB)
    assert r.returncode == 78
    assert f"{bad}:3:1: error: C120: servo_v 70 V is not below open_v 60 V of "\
        "the machine; servo_v below open_v\n" == r.stderr.decode()


def test_the_documentation_has_the_fields_there_are():
    fields = edmsim.done("--document-tech").stdout.decode()
    assert fields in (ROOT / "docs/technology.md").read_text()


# Fields that the machine file has too, by the names it has them.
SAME = {
    "servo_v": "servo_v", "window_low_v": "window_low_v",
    "window_high_v": "window_high_v", "short_v": "short_v",
    "gain_mm_s_v": "feed_gain_mm_s_v", "integral_s": "integral_s",
    "feed_max_mm_s": "feed_max_mm_s", "retract_mm_s": "retract_mm_s",
    "abort_count": "abort_count", "jump_mm": "height_mm",
    "jump_every_s": "every_s", "jump_depth_mm": "every_mm",
    "jump_short_of_mm": "short_of_mm",
}


def spans(text, column):
    """Least and most of each row of a table, the first of a name."""
    ret = {}
    for line in text.splitlines():
        cells = [x.strip() for x in line.split("|")]
        if not line.startswith("| `") or len(cells) < column + 2:
            continue
        found = re.search(r"from (\S+) to (\S+)", cells[column])
        if found:
            ret.setdefault(cells[1].strip("`"), tuple(map(float,
                                                          found.groups())))
    return ret


def test_a_field_takes_what_the_machine_file_takes():
    fields = spans(edmsim.done("--document-tech").stdout.decode(), 3)
    config = edmsim.done("--document-config").stdout.decode()
    keys = spans(config[config.index("[gap]"):], 4)
    for field, key in SAME.items():
        assert fields[field] == keys[key], field


def test_a_window_of_the_machine_file_binds_a_table_before_the_job(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[gap]\nwindow_high_v = 50\n")
    bad = table(tmp_path, "condition,servo_v\nC120,55\n")
    r = edmsim.run("--machine", machine, "--tech", bad, text=JOB)
    assert r.returncode == 78
    assert b"servo_v 55 V is not at most window_high_v 50 V of the machine" \
        in r.stderr


def test_a_jump_higher_than_the_travel_is_refused_in_a_table_too(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("".join(
        f"[axis.{a}]\ntravel_min_mm = -10\ntravel_max_mm = 20\n"
        for a in "XYZUV"))
    bad = table(tmp_path, "condition,jump_mm\nC120,31\n")
    r = edmsim.run("--machine", machine, "--tech", bad, text=JOB)
    assert r.returncode == 78
    assert f"{bad}:2:1: error: C120: jump_mm 31 mm is higher than any axis " \
        "travels; at most 30 mm, the travel of axis.X\n" == r.stderr.decode()
