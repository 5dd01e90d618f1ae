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


@pytest.mark.skipif(not (WEB / "node_modules").is_dir(),
                    reason="the page was not built here")
def test_what_is_refused_is_told_in_chinese(tmp_path):
    made = tmp_path / "said.cjs"
    subprocess.run([WEB / "node_modules/.bin/esbuild", "--bundle",
                    "--format=cjs", "--log-level=error", f"--outfile={made}",
                    WEB / "src/zhsaid.ts"], check=True, timeout=120)
    whole = sentences()
    assert len(whole) > 60
    r = subprocess.run(
        ["node", "-e", f"const {{ zhSaid }} = require('{made}'); console.log("
         "JSON.stringify(JSON.parse(process.argv[1]).map(zhSaid)))",
         json.dumps(whole)], capture_output=True, text=True, check=True,
        timeout=60)
    english = [a for a, b in zip(whole, json.loads(r.stdout))
               if not re.search("[\u4e00-\u9fff]", b) or b == a]
    assert english == []
