# SPDX-License-Identifier: Apache-2.0
"""The queue and the history as wholes; texts of any length."""

import json
import time

from rig import QUICK_JOB


def fill(c, *names):
    for name in names:
        assert c.submit(QUICK_JOB, name, name=name, hold=True).code == 0


def order(c):
    return [j["job"] for j in json.loads(c.ask("queue").body)]


def test_to_the_front_to_the_back_and_all_away(machine):
    c = machine.client
    fill(c, "a", "b", "c", "d")
    c.job_where("a", "ready")
    assert machine.ctl("move", "d", "front").returncode == 0
    assert order(c) == ["a", "d", "b", "c"]
    assert machine.ctl("move", "d", "back").returncode == 0
    assert order(c) == ["a", "b", "c", "d"]
    p = machine.ctl("move", "d", "up")
    assert p.returncode == 64 and "-1, +1, front or back" in p.stderr
    p = machine.ctl("clear")
    assert p.returncode == 0 and p.stdout.count(" removed") == 3
    assert order(c) == ["a"]
    assert machine.ctl("clear").stdout == ""


def test_what_is_looked_for_is_found_and_summed(machine):
    c = machine.client
    for name in ("cavity-1", "cavity-2", "rib"):
        fill(c, name)
        c.job_where(name, "ready")
        assert c.ask("start").code == 0
        c.job_where(name, "done")
    fill(c, "cavity-3")
    c.job_where("cavity-3", "ready")
    assert c.ask("remove", "cavity-3").code == 0

    def found(words):
        return [j["job"] for j in json.loads(
            c.ask("history", text=words).body)]

    day = time.strftime("%Y-%m-%d")
    assert found("") == ["cavity-3", "rib", "cavity-2", "cavity-1"]
    assert found("CAVITY  done ") == ["cavity-2", "cavity-1"]
    assert found("stopped") == ["cavity-3"]
    assert found("T3") == [] and found('100% "\'') == []
    # The day may end while this runs.
    assert found(day[:4] + " rib") == ["rib"]
    after = c.ask("history", "cavity-2", text="cavity")
    assert [j["job"] for j in json.loads(after.body)] == ["cavity-1"]
    rows = json.loads(c.ask("totals", text="cavity").body)
    assert sum(r["jobs"] for r in rows) == 3
    assert sum(r["done"] for r in rows) == 2
    months = json.loads(c.ask("totals", arg=1).body)
    assert sum(r["jobs"] for r in months) == 4
    assert len(months[0]["time"]) == 7
    p = machine.ctl("totals", "rib")
    assert p.returncode == 0
    assert p.stdout.splitlines()[-1].split()[1:3] == ["1", "1"]


def test_lines_of_a_long_text(machine):
    """Longer than what is read at once; and one that is in the database."""
    c = machine.client
    whole = ["G21 G90"] + [f"G1 X{i % 7} F600 (line {i})"
                           for i in range(1, 150000)] + ["M30"]
    text = "\n".join(whole).encode() + b"\n"
    assert c.submit(text, "long", hold=True, timeout=60).code == 0

    def shown(first, job="long"):
        a = c.ask("text", job, first)
        return json.loads(a.body)["text"].splitlines() if a.code == 0 else []

    for first in (1, 2, 63, 64, 65, 128, 100000, len(whole) - 2):
        got = shown(first)
        assert got and got == whole[first - 1:first - 1 + len(got)]
    assert shown(len(whole)) == ["M30"]
    assert shown(len(whole) + 1) == [] and shown(10 ** 7) == []
    fill(c, "short")
    assert shown(1, "short")[0] == QUICK_JOB.decode().splitlines()[0]
    assert shown(1)[0] == "G21 G90"
