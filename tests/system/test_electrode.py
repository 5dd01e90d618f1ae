# SPDX-License-Identifier: Apache-2.0
"""The table of electrodes: docs/electrodes.md."""

import json

import pytest
import rig
from test_power import die

# Down 1 mm by a condition that takes a tenth of it off the electrode.
TABLE = "condition, servo_v, wear\nC100, 20, 0.1\nC200, 20, -\n"
MACHINE = rig.NULL_MACHINE + "\n[tech]\ntable = shop.tech\n"
DOWN = b"G21 G90\nG0 Z2\nG0 Z1\nC100 G1 Z0 F60\nG0 Z2\nM30\n"
ENDS_LOW = b"G21 G90\nG0 Z1\nC100 G1 Z0 F240\nM30\n"


@pytest.fixture
def off(tmp_path):
    """A machine with a table of conditions; its programs are not started."""
    with rig.Machine(tmp_path, MACHINE) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        yield m


@pytest.fixture
def shop(off):
    off.start()
    return off


def add(m, n, *words):
    r = m.ctl("electrode", "add", str(n), *words)
    assert r.returncode == 0, r.stderr
    return r


def table(m):
    r = m.ctl("--json", "electrode", "list")
    assert r.returncode == 0, r.stderr
    return {e["n"]: e for e in json.loads(r.stdout)}


def test_a_turn_is_in_degrees_and_needs_a_c(tmp_path):
    with rig.Machine(tmp_path, rig.NULL_MACHINE +
                     "\n[axis.C]\npresent = no\n") as m:
        m.start()
        r = m.ctl("electrode", "add", "3", "c=400")
        assert r.returncode == 65 and "-360 to 360 degrees" in r.stderr
        r = m.ctl("electrode", "add", "3", "c=5")
        assert r.returncode == 65 and "no C that turns" in r.stderr
        add(m, 3, "c=0")


def test_the_table_is_kept_and_changed(machine):
    m = machine
    assert m.ctl("electrode", "list").stdout == "none\n"
    add(m, 3, "name=rib", "material=copper", "undersize=0.1", "length=42.5",
        "life=0.5", "minutes=60", "note=left of the box")
    add(m, 1)
    assert m.ctl("electrode", "set", "3", "wear=0.125", "y=-0.02",
                 "c=1.5").returncode == 0
    assert m.ctl("electrode", "use", "3").returncode == 0
    m.kill("jobs")
    m.start_jobs()
    m.client.status_where(lambda s: s.daemon == "ok")
    t = table(m)
    assert list(t) == [1, 3]
    assert t[3] == {
        "n": 3, "name": "rib", "material": "copper", "undersize_mm": 0.1,
        "length_mm": 42.5, "wear_mm": 0.125, "x_mm": 0,
        "y_mm": -0.02, "c_deg": 1.5, "spark_s": 0, "life_mm": 0.5,
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
            (("set", "3"), "electrode: not understood"),
            (("frob", "3"), "electrode: not understood")):
        r = m.ctl("electrode", *words)
        assert r.returncode != 0, words
        assert says in r.stderr, (words, r.stderr)
    assert list(table(m)) == [3]


def change(c, number):
    """It stands for another electrode, and somebody puts it in."""
    c.status_where(lambda s: s.stand == "electrode", 20)
    assert c.ask("done", arg=number).code == 0
    assert c.ask("start").code == 0


def cut(m, text, job, *words):
    c = m.client
    r = m.ctl("submit", "--id", job, "--name", job, *words, "-", input=text.decode())
    assert r.returncode == 0, r.stderr
    return c.job_where(job, "done", 20)


def test_the_wear_of_a_job_shifts_the_next(shop):
    m, c = shop, shop.client
    add(m, 3, "material=copper", "length=1.5", "wear=0.25")
    m.ctl("electrode", "use", "3")
    first = cut(m, ENDS_LOW, "first")
    # Z0 of the program, by 1.5 - 0.25 mm higher.
    assert c.status().pos_mm[2] == pytest.approx(1.25)
    assert table(m)[3]["wear_mm"] == pytest.approx(0.35)
    second = cut(m, ENDS_LOW, "second")
    assert c.status().pos_mm[2] == pytest.approx(1.15)
    assert table(m)[3]["wear_mm"] == pytest.approx(0.45)
    for job, before in ((first, 0.25), (second, 0.35)):
        e, = job["electrodes"]
        assert (e["electrode"], e["known"]) == (3, 1)
        assert e["shift_mm"] == pytest.approx(1.5 - before)
        assert e["wear_before_mm"] == pytest.approx(before)
        assert e["wear_after_mm"] == pytest.approx(before + 0.1)
    s = c.status()
    assert s.electrode == 3
    assert s.electrode_wear_mm == pytest.approx(0.45)
    assert "wear 0.3500 -> 0.4500" in m.ctl("show", "second").stdout


def test_without_a_table_nothing_is_shifted(shop):
    cut(shop, ENDS_LOW, "plain")
    assert shop.client.status().pos_mm[2] == 0
    assert shop.client.job("plain")["electrodes"] == []


def test_what_the_table_of_conditions_does_not_say_is_not_known(shop):
    add(shop, 3)
    shop.ctl("electrode", "use", "3")
    job = cut(shop, b"G0 Z1\nC200 G1 Z0 F240\n", "unknown")
    assert job["electrodes"][0]["known"] == 0
    assert job["electrodes"][0]["wear_after_mm"] == 0
    assert "and more" in shop.ctl("show", "unknown").stdout


@pytest.mark.parametrize("words, says", [
    (("state=absent",), "is absent"),
    (("state=worn",), "is worn out"),
    (("life=0.5", "wear=0.5"), "is worn out"),
    (("minutes=1", "sparked=1"), "is worn out"),
    (("life=0.5", "wear=0.45"), "takes about 0.1000 mm"),
])
def test_an_electrode_that_does_not_last_is_refused(shop, words, says):
    m = shop
    add(m, 1, "name=spare")
    add(m, 2, *words)
    for text, more in ((b"T2\n" + ENDS_LOW, ()),
                       (ENDS_LOW, ("--electrode", "2"))):
        r = m.ctl("submit", *more, "-", input=text.decode())
        assert r.returncode != 0
        assert says in r.stderr and "1 spare" in r.stderr, r.stderr
    r = m.ctl("submit", "-", input="G0 Z1\nT7\n")
    assert ":2:1: error: electrode 7" in r.stderr, r.stderr
    assert "T1 T2" in r.stderr
    r = m.ctl("submit", "--electrode", "7", "-",
              input=ENDS_LOW.decode())
    assert r.returncode != 0 and "electrode 7" in r.stderr
    assert m.client.ask("queue").body == "[]"


def test_one_that_went_away_meanwhile_makes_the_job_wait(shop, tmp_path):
    m, c = shop, shop.client
    add(m, 1)
    add(m, 2)
    m.ctl("electrode", "use", "1")
    assert c.submit(DOWN, "first").code == 0
    c.status_where(lambda s: s.job_state == "running")
    (tmp_path / "next.ngc").write_bytes(ENDS_LOW)
    assert m.ctl("submit", "--id", "next", "--electrode", "2",
                 str(tmp_path / "next.ngc")).returncode == 0
    # The one in use is the job's, so another job's is taken away.
    assert "when the job has ended" in m.ctl(
        "electrode", "set", "1", "state=absent").stderr
    assert m.ctl("electrode", "set", "2", "state=absent").returncode == 0
    c.ask("hold")
    c.ask("stop")
    c.job_where("first", "stopped")
    a = c.ask("start", "next")
    c.heard(lambda: [e for e in c.events if e.kind == "waits"
                     and "is absent" in e.text])
    assert c.job("next")["state"] == "queued"
    a = c.ask("start", "next")
    assert a.code == 1 and "is absent" in a.reason
    m.ctl("electrode", "set", "2", "state=there")
    c.job_where("next", "ready")
    assert c.ask("start").code == 0
    # The other one is in the holder: it stops for the change.
    c.status_where(lambda s: s.job == "next" and s.job_state == "held")
    change(c, 2)
    c.job_where("next", "done")


def test_a_t_word_stops_for_the_change(shop):
    m, c = shop, shop.client
    add(m, 1, "length=1")
    add(m, 2, "length=1.5")
    m.ctl("electrode", "use", "1")
    text = (b"G21 G90\nT1\nG0 Z1\nC100 G1 Z0 F240\nG0 Z1\nT2\n"
            b"C100 G1 Z0 F240\nM30\n")
    assert c.submit(text, "two").code == 0
    c.status_where(lambda s: s.state == "hold" and s.place_mm > 1)
    assert c.status().electrode == 1
    change(c, 2)
    job = c.job_where("two", "done")
    assert c.status().pos_mm[2] == pytest.approx(1.5)
    assert c.status().electrode == 2
    t = table(m)
    assert t[1]["wear_mm"] == pytest.approx(0.1)
    # From Z1 with the first to Z0 with the second: 2 mm down to 1.5.
    assert t[2]["wear_mm"] == pytest.approx(0.05)
    assert [e["electrode"] for e in job["electrodes"]] == [1, 2]


def test_through_a_power_cut_the_shift_stays(off):
    m, c = off, off.client
    m.start()
    add(m, 3, "length=1", "wear=0.25", "life=10")
    m.ctl("electrode", "use", "3")
    assert c.submit(DOWN, "cut").code == 0
    last = c.status_where(lambda s: s.job_state == "running"
                          and s.place_mm > 4.2, 20)
    assert last.electrode_shift_mm == pytest.approx(0.75)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    worn = table(m)[3]["wear_mm"]
    done = c.job("cut")
    # What was cut by the last checkpoint, a tenth of it.
    assert done["electrodes"][0]["wear_after_mm"] == pytest.approx(worn)
    assert 0.25 < worn <= 0.35
    # Measured anew meanwhile: the job goes on as it began.
    m.ctl("electrode", "set", "3", "wear=0.5")
    a = c.ask("resume", "cut", text="XYZABCUV")
    assert a.code == 0, a.reason
    c.job_where("cut", "ready")
    assert c.ask("start").code == 0
    low = c.status_where(lambda s: s.state == "cut" or s.pos_mm[2] < 1, 20)
    assert low.electrode_shift_mm == pytest.approx(0.75)
    job = c.job_where("cut", "done", 30)
    assert c.status().pos_mm[2] == pytest.approx(2.75)
    parts = job["electrodes"]
    assert [e["shift_mm"] for e in parts] == pytest.approx([0.75, 0.75])
    # The ground that was cut is not counted twice.
    taken = sum(e["wear_after_mm"] - e["wear_before_mm"] for e in parts)
    assert taken == pytest.approx(0.1)
    row = m.ctl("history", "--csv").stdout.splitlines()[1]
    assert row.split(",")[-1] == ";".join(
        f"3={e['wear_after_mm'] - e['wear_before_mm']:.4f}" for e in parts)
    assert table(m)[3]["wear_mm"] == pytest.approx(
        0.5 + 0.1 - (worn - 0.25))


def test_a_dead_service_loses_no_wear(shop):
    m, c = shop, shop.client
    add(m, 3)
    m.ctl("electrode", "use", "3")
    assert c.submit(DOWN, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 3.2)
    m.kill("jobs")
    c.hear(2.5)
    m.start_jobs()
    job = c.job_where("cut", "done")
    assert job["electrodes"][0]["wear_after_mm"] == pytest.approx(0.1)
    assert table(m)[3]["wear_mm"] == pytest.approx(0.1)


def test_a_place_in_the_middle_wants_the_electrode_that_cuts_there(shop):
    m, c = shop, shop.client
    add(m, 1, "length=1")
    add(m, 2, "length=1.5")
    m.ctl("electrode", "use", "1")
    text = ("G21 G90\nG0 Z1\nC100 G1 Z0 F240\nG0 Z3\nT2\nG0 Z1\nG1 Z0\nX1\n"
            "G0 Z3\nM30\n")
    r = m.ctl("submit", "--id", "mid", "--from-line", "8", "-", input=text)
    assert r.returncode == 0, r.stderr
    c.job_where("mid", "ready")
    assert c.ask("start").code == 0
    # It stops for the second one, before it goes down.
    s = c.status_where(lambda s: s.job_state == "held")
    assert s.pos_mm[2] >= 2 and s.electrode == 1
    change(c, 2)
    job = c.job_where("mid", "done")
    assert c.status().electrode == 2
    assert c.status().pos_mm[2] == pytest.approx(4.5)
    # What was cut before the place takes nothing off.
    assert table(m)[2]["wear_mm"] == pytest.approx(0)
    assert job["electrodes"][-1]["shift_mm"] == pytest.approx(1.5)


MEASURES = """
[machine]
name = {name}
backend = sim
period_us = 1000
cpu = -1
overrun_limit = 0
[probe]
feed_mm_s = 2
[sim]
speed = 20
noise_v = 0
block = yes
block_x_min_mm = 40
block_x_max_mm = 60
block_top_mm = 1.2
[electrode]
measure = yes
measure_x_mm = 50
clear_z_mm = 20
measure_from_z_mm = 5
measure_to_z_mm = -2
reference_z_mm = 0
[jobs]
store = {store}
"""


@pytest.fixture
def prober(tmp_path):
    with rig.Machine(tmp_path, MEASURES) as m:
        m.start()
        yield m


def measured(m, *words):
    c = m.client
    r = m.ctl("electrode", "measure", "3", *words)
    assert r.returncode == 0, r.stderr
    job = r.stdout.split("job ")[1].split()[0]
    c.job_where(job, "ready", 20)
    assert c.ask("start").code == 0
    # The electrode is put in.
    if not c.job(job)["electrodes"]:
        c.status_where(lambda s: s.job_state == "held" or s.place_mm > 0)
        if c.status().job_state == "held":
            change(c, 3)
    c.job_where(job, "done", 60)
    c.heard(lambda: [e for e in c.events if e.kind == "electrode"
                     and "measured" in e.text])
    return table(m)[3]


def test_it_is_measured_at_the_reference(prober):
    m = prober
    add(m, 3, "state=worn", "life=0.4")
    assert "not known yet" in m.ctl("electrode", "measure", "3").stderr
    # As a new one: its length is what is measured.
    e = measured(m, "new")
    assert e["length_mm"] == pytest.approx(1.2, abs=2e-3)
    assert (e["wear_mm"], e["state"], e["held"]) == (0, "there", True)
    # It was longer when it was new: what is missing is wear.
    m.ctl("electrode", "set", "3", "length=1.5", "wear=0.1")
    e = measured(m)
    assert e["wear_mm"] == pytest.approx(0.3, abs=2e-3)
    assert e["state"] == "there"
    m.ctl("electrode", "set", "3", "length=1.7")
    e = measured(m)
    assert e["wear_mm"] == pytest.approx(0.5, abs=2e-3)
    assert e["state"] == "worn"


def test_what_cannot_be_measured_is_refused(machine):
    m = machine
    add(m, 3, "length=1")
    assert "measure = yes" in m.ctl("electrode", "measure", "3").stderr
    assert m.ctl("electrode", "measure", "4").returncode == 66
    assert "not understood" in m.ctl("electrode", "measure", "3", "old").stderr
