# SPDX-License-Identifier: Apache-2.0
"""The table of electrodes: docs/electrodes.md."""

import json


def add(m, n, *words):
    r = m.ctl("electrode", "add", str(n), *words)
    assert r.returncode == 0, r.stderr
    return r


def table(m):
    r = m.ctl("--json", "electrode", "list")
    assert r.returncode == 0, r.stderr
    return {e["n"]: e for e in json.loads(r.stdout)}


def test_the_table_is_kept_and_changed(machine):
    m = machine
    assert m.ctl("electrode", "list").stdout == "none\n"
    add(m, 3, "name=rib", "material=copper", "undersize=0.1", "length=42.5",
        "life=0.5", "minutes=60", "note=left of the box")
    add(m, 1)
    assert m.ctl("electrode", "set", "3", "wear=0.125").returncode == 0
    assert m.ctl("electrode", "use", "3").returncode == 0
    m.kill("jobs")
    m.start_jobs()
    m.client.status_where(lambda s: s.daemon == "ok")
    t = table(m)
    assert list(t) == [1, 3]
    assert t[3] == {
        "n": 3, "name": "rib", "material": "copper", "undersize_mm": 0.1,
        "length_mm": 42.5, "wear_mm": 0.125, "spark_s": 0, "life_mm": 0.5,
        "life_s": 3600, "left": 0.75, "state": "there", "held": True,
        "note": "left of the box"}
    assert ">   3  rib" in m.ctl("electrode", "list").stdout
    assert "left       75 %" in m.ctl("electrode", "show", "3").stdout
    assert m.ctl("electrode", "remove", "3").returncode == 0
    assert list(table(m)) == [1]
    assert m.ctl("electrode", "show", "3").returncode == 66


def test_what_cannot_be_is_refused_with_what_can(machine):
    m = machine
    add(m, 3)
    for words, says in (
            (("add", "3"), "is there already"),
            (("add", "84"), "not 80 to 99"),
            (("add", "1.5"), "a whole number"),
            (("add", "5", "length=long"), "0 to 2000 mm"),
            (("add", "5", "length=nan"), "0 to 2000 mm"),
            (("add", "5", "lenght=4"), "KEY one of name material"),
            (("add", "5", "name=" + 40 * "x"), "at most 31 bytes"),
            (("add", "5", "name=a\x1bb"), "control a terminal"),
            (("set", "3", "state=broken"), "there, worn or absent"),
            (("set", "7", "state=worn"), "electrode list has them"),
            (("remove", "7"), "electrode list has them"),
            (("use", "7"), "electrode list has them"),
            (("set", "3"), "electrode: what?"),
            (("frob", "3"), "electrode: what?")):
        r = m.ctl("electrode", *words)
        assert r.returncode != 0, words
        assert says in r.stderr, (words, r.stderr)
    assert list(table(m)) == [3]
