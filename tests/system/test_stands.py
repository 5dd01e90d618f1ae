# SPDX-License-Identifier: Apache-2.0
"""Why a job stands, what it asks for, and what ends that: words/stands.h."""

import json
import pathlib
import re

import can_bus
import pytest
import rig
from test_power import die

MACHINE = rig.NULL_MACHINE + "\n[tech]\ntable = shop.tech\n"
TABLE = "condition, servo_v, on_us\nC100, 20, 10\nC200, 20, 20\n"
CHANGE = (b"G21 G90 F600\nG0 Z2\nT3 M6\nG1 Z1\nM0 (turn the part)\nG1 Z0\n"
          b"G0 Z2\nM30\n")
CHANGED = rig.NULL_MACHINE + """
[plc]
interface = can0
alive_ms = 10000
m_before = 6
m_timeout_s = 0
"""
BY_HAND = "\n[generator]\ninterface = none\nby_hand = on_us\n"
EMPTY = b"G21 G90 F600\nG0 Z2\nT0 M6\nG1 Z1\nM30\n"


@pytest.fixture
def off(tmp_path):
    with rig.Machine(tmp_path, MACHINE) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        yield m


@pytest.fixture
def shop(off):
    off.start()
    off.client.status_where(lambda s: s.daemon == "ok")
    return off


def ctl(m, *words, code=0, **more):
    r = m.ctl(*words, **more)
    assert r.returncode == code, (words, r.returncode, r.stdout, r.stderr)
    return r.stdout + r.stderr


def stands(m, name):
    return m.client.status_where(lambda s: s.stand == name, 20)


def at_the_change(m):
    ctl(m, "electrode", "add", "1", "name=rough")
    ctl(m, "electrode", "add", "3", "name=rib")
    ctl(m, "electrode", "use", "1")
    m.client.submit(CHANGE, "work")
    return stands(m, "electrode")


def test_a_start_is_for_the_stand_that_was_seen(shop):
    c = shop.client
    c.submit(b"G21 G90 F600\nG0 Z1\nM0 (one)\nG0 Z2\nM0 (two)\nG0 Z3\nM30\n",
             "twice", hold=True)
    stands(shop, "ready")
    ready = json.loads(c.ask("why").body)["stand"]
    one, two, three = (str(ready + i) for i in range(3))
    assert c.ask("start", text=one).code == 0
    c.status_where(lambda s: s.stand == "stop" and s.line == 3, 20)
    again = c.ask("start", text=one)
    assert again.code == 1 and "that stand is over" in again.reason
    assert c.ask("start", text=two).code == 0
    c.status_where(lambda s: s.stand == "stop" and s.line == 5, 20)
    shop.come_back(lambda s: s.stand == "stop")
    for seen in (one, two):
        assert "that stand is over" in c.ask("start", text=seen).reason
    assert c.ask("start", text="no").code == 65
    assert c.ask("start", text=three).code == 0
    c.job_where("twice", "done", 20)
    told = [e.text for e in c.events if e.kind == "stands"]
    assert len(told) == 2, told             # also after edmd was killed
    said = ctl(shop, "show", "twice")
    assert len(re.findall(r"line [35]: the program stops here: go on, says "
                          r"\S", said)) == 2, said


def held(m):
    out = json.loads(ctl(m, "--json", "electrode", "list"))
    return [e["n"] for e in out if e["held"]]


def test_an_electrode_is_asked_for_and_confirmed(shop):
    s = at_the_change(shop)
    assert "put electrode 3 rib in (1 is in); edmctl done 3" in s.asks
    assert "put electrode 3 rib in" in ctl(shop, "status")
    said = ctl(shop, "start", code=1)
    assert "not before this: put electrode 3 rib in" in said
    assert held(shop) == [1]
    said = ctl(shop, "done", "2", code=1)
    assert "not what the machine asks for: put electrode 3 rib in" in said
    ctl(shop, "start", code=1)
    ctl(shop, "done", "3")
    s = shop.client.status_where(lambda s: "3 is in" in s.asks)
    assert s.stand == "electrode" and held(shop) == [1]
    ctl(shop, "start")
    s = stands(shop, "stop")
    assert held(shop) == [3]
    assert "line 5: M0 (turn the part); edmctl start goes on" in s.asks
    ctl(shop, "start")
    shop.client.job_where("work", "done")
    s = shop.client.status_where(lambda s: s.job == "")
    assert (s.stand, s.asks, s.stand_s) == ("", "", 0)
    told = shop.log("edmd-jobs")
    who = "line 3: another electrode.*: done, says [a-z]"
    assert re.search(who, told)
    assert re.search(who, ctl(shop, "history", "work"))
    assert "stands: job job.ngc, line 5: the program stops" in told


def test_nothing_that_comes_between_answers_for_it(shop):
    """A hold, an emergency stop with its reset, a death of edmd."""
    at_the_change(shop)
    ctl(shop, "estop")
    shop.client.status_where(lambda s: s.state == "fault")
    ctl(shop, "reset")
    assert "electrode 3" in stands(shop, "electrode").asks
    ctl(shop, "start", code=1)
    shop.kill("edmd")
    shop.client.status_where(lambda s: s.daemon != "ok")
    shop.start_edmd()
    shop.client.status_where(lambda s: s.daemon == "ok")
    shop.client.status_where(lambda s: s.state == "fault" or
                             s.stand == "electrode")
    if shop.client.status().state == "fault":
        ctl(shop, "reset")
    stands(shop, "electrode")
    ctl(shop, "start", code=1)
    assert held(shop) == [1]
    ctl(shop, "done", "3")
    ctl(shop, "start")
    stands(shop, "stop")
    assert held(shop) == [3]


@pytest.mark.parametrize("confirms", [False, True])
def test_a_power_cut_at_the_change_asks_again(shop, confirms):
    """What was said before it is on no disk, and the holder may have been
    emptied since."""
    at_the_change(shop)
    if confirms:
        ctl(shop, "done", "3")
    die(shop)
    shop.start()
    shop.client.status_where(lambda s: s.interrupted == "work", 10)
    assert held(shop) == [1]
    a = shop.client.ask("resume", "work", text="XYZABCUV")
    assert a.code == 0, a.reason
    shop.client.job_where("work", "ready")
    ctl(shop, "start")
    s = stands(shop, "electrode")
    assert "put electrode 3 rib in (1 is in)" in s.asks
    ctl(shop, "done", "3")
    ctl(shop, "start")
    stands(shop, "stop")
    assert held(shop) == [3]


@pytest.mark.parametrize("words", [
    ["start"], ["resume"], ["start", "work"], ["resume", "work"], ["step", "+1"],
    ["done"], ["done", "1"], ["done", "--", "-3"], ["done", "3.5"]],
    ids="-".join)
def test_no_other_word_answers_for_it(shop, words):
    at_the_change(shop)
    place = shop.client.status().place_mm
    r = shop.ctl(*words)
    assert r.returncode != 0, (words, r.stdout)
    s = stands(shop, "electrode")
    assert s.place_mm == place and held(shop) == [1]


def test_a_way_back_in_the_middle_leaves_it_asked_for(shop):
    at_the_change(shop)
    ctl(shop, "retract", "0.5")
    shop.client.status_where(lambda s: s.state == "hold")
    ctl(shop, "start", code=1)
    ctl(shop, "stop")
    shop.client.job_where("work", "stopped")
    assert held(shop) == [1]


def test_an_empty_holder_is_asked_for(shop):
    ctl(shop, "electrode", "add", "1")
    ctl(shop, "electrode", "use", "1")
    shop.client.submit(EMPTY, "empty")
    s = stands(shop, "electrode")
    assert "take the electrode out (1 is in); edmctl done 0" in s.asks
    ctl(shop, "done", "0")
    ctl(shop, "start")
    shop.client.job_where("empty", "done")
    assert held(shop) == []


def test_a_number_is_no_answer_where_the_generator_is_to_be_set(off):
    off.config.write_text(off.config.read_text().replace("null", "sim") + BY_HAND)
    off.start()
    off.client.submit(b"G21 G90\nC200\nG1 Z-2 F30\nM30\n", "work")
    asked = stands(off, "setting").asks
    for number in (["1"], ["3"], ["--", "-1"]):
        assert f"not what the machine asks for: {asked}" in \
            ctl(off, "done", *number, code=1)
    ctl(off, "start", code=1)
    assert "confirmed" not in off.log("edmd-jobs")
    ctl(off, "done")
    off.client.status_where(lambda s: s.asks.startswith("the generator is set"))


def test_done_where_nothing_is_asked_is_refused(shop):
    assert "no job is loaded" in ctl(shop, "done", "3", code=1)
    shop.client.submit(CHANGE.replace(b"T3 M6\n", b""), "work", hold=True)
    s = stands(shop, "ready")
    assert s.asks == "the job is ready; edmctl start begins it"
    assert "not what the machine asks for: the job is ready" in \
        ctl(shop, "done", code=1)
    ctl(shop, "done", "three", code=64)


def test_a_hold_says_whose_it_was(shop):
    shop.client.submit(b"G21 G90 F6\nG1 Z-20\nM30\n", "long")
    shop.client.status_where(lambda s: s.state not in ("idle", "hold"), 20)
    ctl(shop, "hold")
    s = stands(shop, "held")
    assert s.asks.startswith("it was held by command of ")
    why = shop.client.ask("why")
    assert "held by command" in why.body
    until = s.stand_s
    shop.client.status_where(lambda s: s.stand_s > until)
    ctl(shop, "override", "0")


def test_who_was_refused_has_held_nothing(shop):
    """Nor has who held it before."""
    ctl(shop, "keys", "add", "anna", "operator", cwd=shop.folder)
    anna = ("--key", str(shop.folder / "anna.key"))

    def held_by():
        said = stands(shop, "held").asks
        return re.search("by command of ([a-z]+);", said) and said

    shop.client.submit(b"G21 G90 F60\nG0 Z1\nG1 Z-20\nM30\n", "long")
    shop.client.status_where(lambda s: s.place_mm > 1.2, 20)
    ctl(shop, *anna, "hold")
    assert "command of anna;" in rig.until(held_by, 20)
    ctl(shop, "start")
    shop.client.status_where(lambda s: not s.stand, 20)
    ctl(shop, *anna, "done", code=1)
    ctl(shop, "retract", "0.1")
    assert "command of host;" in rig.until(held_by, 20)
    ctl(shop, *anna, "done", code=1)
    ctl(shop, "override", "0")
    assert "command of host;" in stands(shop, "held").asks


def test_what_a_plc_does_and_holds_is_said_and_is_no_time_of_the_job(tmp_path):
    """The line is that of the M code, and nobody takes the wait for slow cutting."""
    with can_bus.Bus(tmp_path) as bus, rig.Machine(tmp_path, CHANGED) as m:
        m.env = lambda program: bus.env()
        m.start()
        c, plc = m.client, can_bus.Plc(bus)
        ctl(m, "electrode", "add", "3", "name=rib")
        rig.until(lambda: c.submit(b"G21 G90 F60\nG1 X2\nG1 X4 T3 M6\nG1 X60\nM30\n",
                                   "work").code == 0)
        s = stands(m, "m-code")
        assert (s.line, s.asks) == (
            3, "the PLC carries out an M code: M6; it goes on by itself")
        later = c.status_where(lambda t: t.stand_s > s.stand_s + 2, 20)
        assert (later.eta_s, later.progress) == (s.eta_s, s.progress) != (-1, 0)
        plc.done = 6
        c.status_where(lambda s: s.line == 4, 20)
        plc.done = 0
        plc.hold(True)
        assert stands(m, "plc").asks == \
            "the PLC held it; once the PLC lets go, start goes on"
        assert "the PLC holds: nothing may move until" in ctl(m, "start", code=1)
        plc.bits &= ~can_bus.PERMIT
        plc.hold(False)
        rig.until(lambda: "may move now: the PLC took its permit away; edmctl "
                  "faults permit" in ctl(m, "start", code=1))
        plc.bits |= can_bus.PERMIT
        rig.until(lambda: c.ask("start").code == 0)
        c.status_where(lambda s: s.stand == "" and s.place_mm > 5, 60)


def test_every_stand_is_written_where_people_look():
    table = re.findall(r'^S\(\w+, "([a-z-]+)"',
                       pathlib.Path("daemon/words/stands.h").read_text(), re.M)
    assert len(table) > 10
    page = pathlib.Path("docs/architecture.md").read_text()
    web = pathlib.Path("clients/panel/web/src")
    words = [(web / f).read_text() for f in ("words.ts", "zh.ts")]
    for name in table:
        assert f"| `{name}` |" in page, name
        for text in words:
            assert f'"stand.{name}"' in text or name == "ready", name
