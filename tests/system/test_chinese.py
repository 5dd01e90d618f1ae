# SPDX-License-Identifier: Apache-2.0
"""What edmd and edmd-jobs answer in whole sentences, and what a stand asks for, as
their sources have it, is shown in Chinese by the page's own function.  Other
sentences that are put together with values are not looked at."""

import json
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
WEB = ROOT / os.environ.get("EDM_BUILD", "build") / "web"
STRING = re.compile(r'"((?:[^"\\]|\\.)*)"')
JOINED = re.compile(r'(?:"(?:[^"\\]|\\.)*"\s*)+')
MACRO = re.compile(r"\b[A-Z][A-Z_]{3,}\b")


def calls(text, name):
    """The last argument of each call; strings may have any character."""
    for m in re.finditer(rf"\b{name}\(", text):
        at, depth, last = m.end(), 1, ""
        while depth:
            string = STRING.match(text, at)
            last += string.group() if string else text[at]
            at = string.end() if string else at + 1
            depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(text[at - 1], 0) \
                if not string else 0
            if depth == 1 and last.endswith(",") and not string:
                last = ""
        yield last[:-1]


def sentences():
    found = set(re.findall(r'\[ANSWER_\w+\]\s*=\s*"([^"]*)"',
                           (ROOT / "daemon/rt/names.c").read_text()))
    for path in (ROOT / "daemon/jobs").glob("*.c"):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
        for said in calls(text, "verbs_answer"):
            if not MACRO.search(STRING.sub("", said)):
                found |= {"".join(STRING.findall(j.group()))
                          for j in JOINED.finditer(said)}
    return sorted(found | asked())


# How asks.c puts a stand into words, and what comes of it.
THEN = "edmctl done{}, then edmctl start"
PUT = {
    "the program stops in line %u%s%s; %s": (
        "the program stops in line 3; edmctl start goes on",
        "the program stops in line 3: M0 (turn the part); edmctl start goes on"),
    "electrode %u is in; edmctl start goes on": (
        "electrode 3 is in; edmctl start goes on",),
    "take the electrode out%s; edmctl done 0, then edmctl start": (
        f"take the electrode out; {THEN.format(' 0')}",
        f"take the electrode out (1 is in); {THEN.format(' 0')}"),
    "put electrode %u%s%s in%s; edmctl done %u, then edmctl start": (
        f"put electrode 3 in; {THEN.format(' 3')}",
        f"put electrode 3 rib 2 in (1 is in); {THEN.format(' 3')}"),
    "the generator is set; edmctl start goes on": (
        "the generator is set; edmctl start goes on",),
    "set %s%s at the generator; edmctl done, then edmctl start": (
        f"set on_us 20 us, off_us 50 us at the generator; {THEN.format('')}",
        f"set on_us 20 us for C200 at the generator; {THEN.format('')}"),
    "%s: M%u; %s": (
        "the PLC carries out an M code: M6; it goes on by itself",),
    "%s%s%s; %s": (
        "it was held by command of host; edmctl start goes on, edmctl stop ends "
        "the job",),
}


def asked():
    """What a stand asks for, also as the reason of a refusal."""
    said = {"".join(STRING.findall(m.group())) for m in
            JOINED.finditer((ROOT / "daemon/jobs/asks.c").read_text())}
    assert set(PUT) <= said
    assert {s for s in said if "; " in s} - set(PUT) == {"%s; %s"}
    rows = (ROOT / "daemon/words/stands.h").read_text().replace("\\\n", "")
    whole = {f"{what}; {asks}" for what, asks in re.findall(
        r'STAND_BY_\w+,\s*"([^"]+)",\s*"([^"]+)"', rows)
        if "electrode" not in what and "by hand" not in what
        and "program stops" not in what and "optional stop" not in what
        and "M code" not in what}
    assert len(whole) > 7
    whole |= {one for put in PUT.values() for one in put}
    return {f"{why}{one}" for one in whole for why in
            ("", "not before this: ", "that is not what the machine asks for: ")}


def shown(tmp_path, function, whole):
    """What the page's own function makes of each."""
    made = tmp_path / "said.cjs"
    subprocess.run([WEB / "node_modules/.bin/esbuild", "--bundle",
                    "--format=cjs", "--log-level=error", f"--outfile={made}",
                    WEB / "src/zh{}.ts".format(
                        {"zhSaid": "said", "zhRefused": "nc"}[function])],
                   check=True, timeout=120)
    r = subprocess.run(
        ["node", "-e", f"const f = require('{made}').{function}; console.log("
         "JSON.stringify(JSON.parse(process.argv[1]).map((x) => f(x))))",
         json.dumps(whole)], capture_output=True, text=True, check=True,
        timeout=60)
    return json.loads(r.stdout)


def english(whole, put):
    return [a for a, b in zip(whole, put, strict=True)
            if not re.search("[\u4e00-\u9fff]", b) or b == a]


built = pytest.mark.skipif(not (WEB / "node_modules").is_dir(),
                           reason="the page was not built here")


@built
def test_what_is_refused_is_told_in_chinese(tmp_path):
    whole = sentences()
    assert len(whole) > 60
    assert english(whole, shown(tmp_path, "zhSaid", whole)) == []


# What goes wrong in most programs; a line of its own each.
WRONG = """G1 X5 Q77|G1 X5 F0|G0 X5000|C999|G2 X5 Y5 I1 F60|G2 X5 Y5 F60|G2 X5 R1 F60
G77 X5|M77|X5|G0 XX5|G0 X5 X6|G0 G1 X5|M98 P5|M99|G4|G54 G0 B5|G0 W5|#1=5
(comment|G0 X1.2.3|G28|G80 X|G1 Z-1 F-5|S500|G4 P-1|T99999|G92|G53|G1 Z-1 F60 R5
G41 D1 G1 X5 F60|M98 P1\\nM30\\nO1\\nM98 P1\\nM99|O1\\nG0 X1\\nO1\\nM99"""


@built
def test_what_is_wrong_in_a_program_is_told_in_chinese(tmp_path):
    whole = set()
    for text in re.split(r"[|\n]", WRONG):
        path = tmp_path / "part.ngc"
        path.write_text(text.replace("\\n", "\n") + "\nM30\n")
        r = subprocess.run(
            [WEB.parent / "edmsim", "--machine", ROOT / "examples/machine.ini",
             "--tech", ROOT / "examples/copper-steel.tech", "--check", path],
            capture_output=True, text=True, timeout=60)
        first, = re.findall(r"\d: error: (.*?); (.*)", r.stderr)[:1]
        whole |= set(first)
    whole = sorted(whole)
    assert len(whole) > 45
    assert english(whole, shown(tmp_path, "zhRefused", whole)) == []
    said = "part.ngc:3:7: Q77 has no use on this line; I and J, or R"
    put, = shown(tmp_path, "zhSaid", [said])
    assert put == "part.ngc，第 3 行第 7 列：Q77 在此行没有用处；接受的是：须有 I 和 J，或 R"
