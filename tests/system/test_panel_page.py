# SPDX-License-Identifier: Apache-2.0
"""The panel's page in a browser, against the real gateway and daemons."""

import panel
import pytest
from playwright.sync_api import expect, sync_playwright

PATIENCE_MS = 40000
expect.set_options(timeout=PATIENCE_MS)


@pytest.fixture(scope="module")
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=panel.CHROMIUM, args=panel.CHROMIUM_FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def p(tmp_path_factory):
    p = panel.Panel(tmp_path_factory.mktemp("page"))
    p.start()
    yield p
    p.close()


@pytest.fixture
def page(p, chromium):
    """The page in English; nothing may go wrong in its console, and nothing
    may be asked of another host."""
    context = chromium.new_context(locale="en-GB", viewport={
        "width": 1280, "height": 800})
    context.set_default_timeout(PATIENCE_MS)
    one = context.new_page()
    wrong, strangers = [], []
    one.on("pageerror", lambda e: wrong.append(str(e)))
    one.on("request", lambda r: strangers.append(r.url)
           if not r.url.startswith((p.url, p.url.replace("http", "ws"),
                                    "blob:", "data:")) else None)
    one.goto(p.url)
    expect(one.locator("h1")).not_to_have_text("Connection lost")
    yield one
    context.close()
    assert wrong == [] and strangers == []


def test_a_probing_form_makes_the_code_it_runs(p, page):
    page.goto(p.url + "/#/setup")
    code = page.locator(".probing pre")
    expect(code).to_contain_text("G80 X-10")
    page.get_by_role("radio", name="Centre of a hole").click()
    expect(code).to_contain_text("G160 R10 Q0.1 L2")
    page.get_by_label("Farthest way to a wall").fill("7,5")
    expect(code).to_contain_text("G160 R7.5")
    page.get_by_label("Farthest way to a wall").fill("seven")
    expect(page.locator("#probe-run")).to_have_attribute("aria-disabled",
                                                         "true")
    session = p.session()
    for name in ("Edge or face", "Centre of a hole", "Centre of a block",
                 "Corner"):
        page.get_by_role("radio", name=name).click()
        text = code.inner_text()
        status, got = session.post("/api/check?name=probe.ngc", text.encode())
        assert status == 200 and got["ok"], (name, text, got)


def test_an_axis_is_jogged_by_steps(p, page):
    page.goto(p.url + "/#/setup")
    before = p.machine.client.status().pos_mm[0]
    page.get_by_role("radio", name="1", exact=True).click()
    page.locator("#jog-X-plus").click()
    p.machine.client.status_where(
        lambda s: abs(s.pos_mm[0] - before - 1) < 1e-6, 20)
    expect(page.locator(".axes tr").first).to_contain_text("1.000")
    page.locator("#jog-X-minus").click()
    p.machine.client.status_where(lambda s: abs(s.pos_mm[0] - before) < 1e-6,
                                  20)
