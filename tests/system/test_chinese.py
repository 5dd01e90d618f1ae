# SPDX-License-Identifier: Apache-2.0
"""What edmd and edmd-jobs answer in whole sentences, as their sources have it, is
shown in Chinese by the page's own function.  Sentences that are put together with
values are not looked at."""

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
    return sorted(found)


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
