# SPDX-License-Identifier: Apache-2.0
"""A PLC on a CAN interface of its own, while edmd cuts on a simulated machine.

guest/plc.py is the PLC, three times: from our EDS, from our DBC, and a bad one.
"""
import json
import sys

import pytest

from boot import HERE, ROOT, Run, checked, machine

PLC = """
[plc]
interface = vcan1
alive_ms = 1000
m_before = 6 60
[sim]
speed = 1
"""

# 12 mm of positioning at 1 mm/s, a changer, then an M code, then a cut.
CUT_JOB = "G21 G90 C120\nG0 X12\nT3 M6\nM60 G1 Z-5 F60\nM30\n"


@pytest.fixture(scope="module")
def plc():
    return checked(Run("plc", {
        "plc.ini": machine("sim", v=1, tail=PLC),
        "cut.ngc": CUT_JOB,
        "plc.env": f"PYTHON={sys.executable}\n",
        "edmd.eds": (ROOT / "messages/edmd.eds").read_text(),
        "edmd.dbc": (ROOT / "messages/edmd.dbc").read_text(),
        "plc.py": (HERE / "guest/plc.py").read_text(),
    }, "-d"))


def said(plc, kind):
    text = plc.text(f"{kind}.txt") + plc.text(f"{kind}.log")
    assert plc.text(f"{kind}.rc") == "0\n", text
    return json.loads(plc.text(f"{kind}.json"))


both = pytest.mark.parametrize("kind", ["eds", "dbc"])


@both
def test_it_sees_the_job_and_starts_it_when_it_permits(plc, kind):
    s = said(plc, kind)
    assert s["first"]["state"] == "hold" and s["first"]["job"] == 1
    assert s["selected"]["state"] == "hold"
    assert s["without permit"] == "hold"
    assert s["started"]["state"] == "travel"


@both
def test_its_override_scales_the_feed(plc, kind):
    feed = said(plc, kind)["feed"]
    assert feed == pytest.approx([1, 0.4, 1], rel=0.1)


@both
def test_the_cut_waits_for_its_m_code(plc, kind):
    s = said(plc, kind)
    assert s["mcode"]["spark"] == 0 and s["mcode"]["fault"] in (0, "none")
    assert s["cut"]["spark"] == 1


@both
def test_a_changer_is_told_its_electrode_and_what_cuts(plc, kind):
    s = said(plc, kind)
    assert s["change"]["electrode"] == 3 and s["change"]["state"] == "travel"
    assert (s["cut"]["letter"], s["cut"]["condition"]) == (ord("C"), 120)
    assert "electrode  3" in plc.text(f"{kind}.txt") or \
        "electrode 3" in plc.text(f"{kind}.txt")


@both
def test_hold_is_held(plc, kind):
    s = said(plc, kind)
    assert s["held"]["spark"] == 0
    assert s["start while held"] == "hold"


@both
@pytest.mark.parametrize("what, name", [
    ("permit", "permit"), ("door", "door"), ("heartbeat", "plc-lost")])
def test_what_it_takes_ends_the_sparks_and_is_named(plc, kind, what, name):
    s = said(plc, kind)[what]
    assert s["spark"] == 0 and s["state"] == "fault"
    # Counted in status frames, 4 periods each: one may be on its way.
    if what == "heartbeat":
        assert 30 <= s["sparking"] <= 52
    else:
        assert s["sparking"] <= 1
    assert s["after"] == "fault"
    assert f"fault {name} " in plc.text(f"{kind}.log")
    if kind == "dbc":
        assert s["fault"] == name


def test_sdo_answers_as_cia_301_has_it(plc):
    s = said(plc, "eds")
    assert s["state by sdo"] in (3, 4, 5, 6)
    assert (s["unknown"], s["no sub"], s["read only"],
            s["while pdos come"]) == ("0x6020000", "0x6090011", "0x6010002",
                                      "0x8000022")


def test_noise_is_not_believed_and_said_a_few_times(plc):
    s = said(plc, "bad")
    assert s["after noise"]["fault"] == "none"
    log = plc.text("bad.log")
    for what in ("wrong length", "out of range", "another device"):
        assert 1 <= log.count(what) <= 12, what


def test_a_second_master_that_does_not_permit_ends_the_sparks(plc):
    s = said(plc, "bad")["second master"]
    assert (s["state"], s["fault"], s["spark"]) == ("fault", "permit", 0)


def test_an_interface_there_is_not_is_refused_with_its_remedy(plc):
    assert plc.text("nowhere.rc") == "78\n"
    assert "plc.interface vcan7" in plc.text("nowhere.txt")
    assert "ip -brief link" in plc.text("nowhere.txt")
