# SPDX-License-Identifier: Apache-2.0
"""Touching off on the panel, in a browser: the next job cuts at that zero."""

import json
import re

import panel
import pytest
from playwright.sync_api import expect
from test_mdi import offsets, places
from test_panel_page import chromium, page, press  # noqa: F401
from test_touch import PLATE, PULSE, first_cut, go


@pytest.fixture(scope="module")
def p(tmp_path_factory):
    one = panel.Panel(tmp_path_factory.mktemp("touch"), config=PLATE
                      + "[panel]\nport = {port}\nassets = {page}\n")
    one.start()
    yield one
    one.close()


def form(page, p, name, **fields):
    page.goto(p.url + "/#/setup")
    page.locator("#probe-form").select_option(label=name)
    for label, text in fields.items():
        page.get_by_label(label.replace("_", " ")).first.fill(text)


def test_a_bore_becomes_the_zero_of_the_next_job(p, page):  # noqa: F811
    m = p.machine
    go(m, "G53 G0 Z10", "G0 X12 Y-8", "G53 G0 Z0")
    form(page, p, "Centre of a hole", Farthest_way_to_a_wall="15")
    page.locator("#touch-into").select_option("G55")
    touched = page.locator(".felt")
    expect(touched).to_contain_text("now")
    # It lies in its form, and not over the stop.
    assert page.locator(".probe .felt").bounding_box()["y"] > \
        page.locator("#stop").bounding_box()["y"] + 40
    press(page.locator("#probe-run"))
    expect(touched.locator("tr", has_text="X")).to_contain_text("12.400")
    expect(touched.locator("tr", has_text="X")).to_contain_text("0.000")
    expect(touched.locator("tr", has_text="Y")).to_contain_text("\u22127.250")
    o = offsets(m)["G55"]
    assert o["touched"] == "XY"
    # Work coordinates first, those of the machine beside them.
    page.goto(p.url + "/#/cut")
    page.locator(".workchoice").select_option("G55")
    row = page.locator(".positions li").first
    expect(row.locator(".n")).to_have_text(re.compile("^.?0.00[01]$"))
    expect(row.locator(".mach")).to_contain_text("12.400")
    go(m, "G53 G0 Z10")
    at = first_cut(m, "G55")
    assert at[:2] == pytest.approx((12.4, -7.25), abs=1.5 * PULSE)


def test_a_probe_that_finds_nothing_says_so(p, page):  # noqa: F811
    m = p.machine
    go(m, "G53 G0 Z10")
    before = offsets(m)
    form(page, p, "Edge or face", At_most="1")
    expect(page.locator("#probe-run")).to_have_attribute("aria-disabled",
                                                         "false")
    page.get_by_label("At most").fill("one")
    expect(page.locator("#probe-run")).to_have_attribute("aria-disabled",
                                                         "true")
    page.get_by_label("At most").fill("1,5")
    press(page.locator("#probe-run"))
    expect(page.locator(".head h1")).to_contain_text("met nothing")
    m.client.ask("reset"), m.client.ask("stop")
    expect(page.locator(".felt .warn")).to_contain_text("Nothing")
    assert offsets(m) == before


def test_an_electrode_gets_its_length_here(p, page):  # noqa: F811
    m = p.machine
    assert m.ctl("electrode", "add", "7").returncode == 0
    form(page, p, "Electrode length")
    page.locator("#probe-run").click(force=True)
    expect(page.locator(".toast").last).to_contain_text("in the holder")
    assert m.ctl("electrode", "use", "7").returncode == 0
    go(m, "G53 G0 Z6", "G53 G0 X-10 Y0")
    form(page, p, "Electrode length", The_face_is_at="1,2")
    expect(page.locator(".felt")).to_contain_text("T7")
    press(page.locator("#probe-run"))
    expect(page.locator(".felt")).to_contain_text("2.000")
    e, = json.loads(m.ctl("--json", "electrode", "list").stdout)
    assert e["length_mm"] == pytest.approx(2, abs=PULSE)
