# SPDX-License-Identifier: Apache-2.0
"""A client in JavaScript, written from messages/README.md alone (client.mjs)."""

import json
import pathlib
import re
import subprocess

import rig
from rig import QUICK_JOB

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parents[1]


def node(*args):
    return subprocess.run(["node", str(HERE / "client.mjs"), *map(str, args)],
                          capture_output=True, text=True, timeout=120)


def test_the_vectors_hold():
    r = node("vectors", ROOT / "messages/vectors.txt")
    assert r.returncode == 0, r.stderr


def test_the_page_has_the_types():
    page = (ROOT / "messages/README.md").read_text()
    told = dict(re.findall(r"\| `edm\.(\w+)` *\| `([0-9a-f]{16})` \|", page))
    kinds = ("signed_t", "command_t", "ack_t", "job_chunk_t", "status_t",
             "event_t")
    assert told == {k: getattr(rig, k)._get_packed_fingerprint().hex()
                    for k in kinds}


def test_it_commands_a_machine(machine):
    c = machine.client
    c.status()

    def ask(*args):
        r = node(c.key, *args)
        assert r.returncode == 0, r.stderr
        return json.loads(r.stdout)

    assert json.loads(ask("hello")["body"])["role"] == "service"
    assert ask("jog", "X", "0.5")["code"] == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 0.5) < 1e-6)
    assert ask("jog", "Q", "1")["code"] == 65
    path = machine.folder / "quick.ngc"
    path.write_bytes(QUICK_JOB)
    job = json.loads(ask("submit", path)["body"])["job"]
    c.job_where(job, "done")
