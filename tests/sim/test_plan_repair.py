# SPDX-License-Identifier: Apache-2.0
"""What edm-plan does with a program that is too near, and with its other lines."""
import json
import re

import pytest
from test_plan import args, channel, plan   # noqa: F401


def shifted(d, to, first, last, mm):
    """Blocks @first to @last of the dense program, moved along X."""
    at, lines = -1, []
    for line in (d / "dense.ngc").read_text().splitlines():
        at += line.startswith("G1")
        if line.startswith("G1") and first <= at <= last:
            line = re.sub(r"X(-?[\d.]+)",
                          lambda m: "X%.4f" % (float(m[1]) + mm), line)
        lines.append(line)
    to.write_text("\n".join(lines) + "\n")


# So far that the program still does not touch, and so far that it does.
@pytest.mark.parametrize("mm", (0.6, 1.2))
def test_a_program_that_is_too_near_is_led_round(channel, tmp_path, mm):
    name, out = tmp_path / "near.ngc", tmp_path / "way.ngc"
    shifted(channel, name, 7, 15, mm)
    base = args(channel, "--clearance", "0.35")
    assert plan(*base, "--check", name).returncode == 1
    r = plan(*base, "--on-path", "--no-pivot", "--output", out, "--report",
             tmp_path / "r.json", name)
    assert r.returncode == 0, r.stderr
    assert "not free itself" in r.stderr
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["dense"]["repaired_nodes"] > 0
    assert report["written"]["proved_mm"] >= 0.35
    assert plan(*base, "--check", out).returncode == 0


def with_words(d, to):
    lines = (d / "dense.ngc").read_text().splitlines()
    blocks = [i for i, line in enumerate(lines) if line.startswith("G1")]
    back = ["G0" + lines[i][2:].replace(" F30", "") for i in blocks[-2::-1]]
    lines[blocks[9]] = "M1\n" + lines[blocks[9]]
    lines[blocks[0]] = "M0\n" + lines[blocks[0]]
    end = ["G4 P1", "M5"] + back
    to.write_text("\n".join(lines[:-1] + end + ["M2"]) + "\n")
    return blocks[9] + 2


def test_the_other_lines_of_the_program_are_carried_over(channel, tmp_path):
    name, out = tmp_path / "full.ngc", tmp_path / "way.ngc"
    inner = with_words(channel, name)
    base = args(channel, "--clearance", "0.3")
    r = plan(*base, "--on-path", "--no-pivot", "--output", out, name)
    assert r.returncode == 0, r.stderr
    text, dense = out.read_text(), name.read_text()
    # What is before and behind the way in stands as it stood.
    assert dense[:dense.index("G1")] in text
    assert text.endswith(dense[dense.index("G4 P1"):])
    assert "M1\n" not in text and f"line {inner}:" in r.stdout
    assert text.count("\nG1") < 8
    assert plan(*base, "--check", out).returncode == 0


def test_lines_that_would_mean_something_else_are_not(channel, tmp_path):
    """Increments behind the blocks would start from them."""
    name, out = tmp_path / "full.ngc", tmp_path / "way.ngc"
    with_words(channel, name)
    lines = name.read_text().splitlines()
    first = next(i for i, s in enumerate(lines) if s.startswith("G1"))
    lines[first] = lines[first].replace("G1", "G1 G20", 1)
    scaled = [re.sub(r"([XYZ])(-?[\d.]+)",
                     lambda m: m[1] + "%.7f" % (float(m[2]) / 25.4), s)
              if i >= first else s for i, s in enumerate(lines)]
    scaled[first] = scaled[first].replace("F30", "F1.18")
    name.write_text("\n".join(scaled) + "\n")
    base = args(channel, "--clearance", "0.3")
    r = plan(*base, "--on-path", "--no-pivot", "--output", out, name)
    assert r.returncode == 0, r.stderr
    assert "only positioning and blocks are written" in r.stdout
    assert "G4" not in out.read_text() and "G20" not in out.read_text()
    assert plan(*base, "--check", out).returncode == 0


def test_nodes_leave_the_path_in_an_end_zone_too(channel, tmp_path):
    """The end pose is nearer than the clearance, as a finishing pass has it."""
    name, out = tmp_path / "end.ngc", tmp_path / "way.ngc"
    shifted(channel, name, 22, 22, 0.6)
    base = args(channel, "--clearance", "0.35", "--end-zone", "8")
    assert plan(*args(channel, "--clearance", "0.45", "--output", out,
                      name)).returncode == 1
    r = plan(*base, "--no-pivot", "--output", out, "--report",
             tmp_path / "r.json", name)
    assert r.returncode == 0, r.stderr
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["end_mm"] < 0.4
    assert report["written"]["blocks"] <= report["fewest"]["blocks"]
    again = plan(*base, "--check", out)
    assert again.returncode == 0, again.stdout
    # The end pose is the nearest, and is told.
    assert "least seen %.4f mm" % report["end_mm"] in again.stdout


def test_many_nodes_in_one_place_leave_none_out_elsewhere(channel, tmp_path):
    """A program of more nodes than the search takes, nearly all in one block."""
    lines, before = [], None
    for line in (channel / "dense.ngc").read_text().splitlines():
        q = [float(v) for v in re.findall(r"[XYZABC](-?[\d.]+)", line)]
        if line.startswith("G1") and line.endswith("F30"):
            n = 900
            lines += ["G1 " + " ".join(
                "%s%.5f" % (a, x + (y - x) * i / n)
                for a, x, y in zip("XYZABC", before, q)) + " F30"
                for i in range(1, n)]
        if len(q) >= 6:
            before = q
        lines.append(line)
    name, out = tmp_path / "uneven.ngc", tmp_path / "way.ngc"
    name.write_text("\n".join(lines) + "\n")
    base = args(channel, "--clearance", "0.3", "--on-path", "--no-pivot",
                "--output", out, "--report", tmp_path / "r.json")
    blocks = []
    for program in (channel / "dense.ngc", name):
        r = plan(*base, program)
        assert r.returncode == 0, r.stderr
        report = json.loads((tmp_path / "r.json").read_text())
        assert report["dense"]["repaired_nodes"] == 0
        blocks.append(report["written"]["blocks"])
    assert blocks[1] <= blocks[0]
