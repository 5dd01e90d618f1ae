# SPDX-License-Identifier: Apache-2.0
"""The panel's page in a browser, against the real gateway and daemons."""

import re
import signal

import panel
import pytest
from playwright.sync_api import expect, sync_playwright

PATIENCE_MS = 40000
expect.set_options(timeout=PATIENCE_MS)

WRONG = b"G21 G90\nG1 X5 F30\nG1 Y5 Q77\nM30\n"


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


def press(key):
    """Pressed for the second that it wants."""
    key.scroll_into_view_if_needed()
    key.hover()
    key.page.mouse.down()
    key.page.wait_for_timeout(1300)
    key.page.mouse.up()


def give(page, text, name="part.ngc"):
    page.set_input_files("#file", {"name": name, "mimeType": "text/plain",
                                   "buffer": text})


def end_job(page, p):
    """As it was before, whatever a test has done."""
    client = p.machine.client
    for verb in ("hold", "reset", "stop"):
        client.ask(verb)
    client.status_where(lambda s: not s.job, 20)


def test_a_part_from_its_error_to_the_history(p, page):
    page.goto(p.url + "/#/jobs")
    give(page, WRONG)
    expect(page.locator(".refusal")).to_contain_text("Line 3, column 7")
    expect(page.locator(".refusal")).to_contain_text("Q77")
    expect(page.locator(".gutter .bad")).to_have_text("3")
    expect(page.locator("#send")).to_have_attribute("aria-disabled", "true")

    # Mended where it stands: it is checked by itself.
    page.locator("#editor").fill(panel.JOB.decode())
    expect(page.locator(".verdict .good")).to_contain_text("9 lines")
    expect(page.locator("#sendstart")).to_have_attribute("aria-disabled",
                                                         "false")
    # A short press, as of a sleeve, starts nothing.
    page.locator("#sendstart").click()
    page.wait_for_timeout(300)
    assert p.machine.client.status().state == "idle"
    press(page.locator("#sendstart"))

    # The cut is watched.
    expect(page).to_have_url(re.compile("#/cut"))
    expect(page.locator(".head h1")).to_have_text("Cutting")
    expect(page.locator("#chip-condition")).to_contain_text("C120")
    expect(page.locator(".pathview-head h2")).to_contain_text("part.ngc")
    # A jump goes by within a tenth of a second of the wall's time.
    page.wait_for_function("Number([...document.querySelectorAll('.counts b')]"
                           "[0].textContent) > 0")
    p.machine.client.status_where(lambda s: s.place_mm > 0.8, 30)
    page.locator("#hold").click()
    expect(page.locator(".head h1")).to_have_text("Held")
    far = p.machine.client.status().place_mm
    page.locator("#retract").click()
    press(page.locator("dialog .key", has_text="0.5 mm").first)
    p.machine.client.status_where(lambda s: s.place_mm < far - 0.3, 20)
    expect(page.locator(".l-back")).to_be_visible()

    # A fault: read what to do without a click, reset, go on.
    press(page.locator("#start"))
    p.machine.client.status_where(lambda s: s.state in ("approach", "erode"),
                                  20)
    page.locator("#stop").click()
    expect(page.locator(".head h1")).to_have_text("Emergency stop")
    expect(page.locator(".head .state p")).to_contain_text("Release the button")
    page.goto(p.url + "/#/alarms")
    expect(page.locator(".alarm-now dl")).to_contain_text("part.ngc, line")
    page.locator("#reset").click()
    expect(page.locator(".head h1")).to_have_text("Held")
    page.goto(p.url + "/#/cut")
    press(page.locator("#start"))
    p.machine.client.status_where(lambda s: s.state in ("approach", "erode"),
                                  20)
    end_job(page, p)
    page.goto(p.url + "/#/jobs")
    expect(page.locator(".jobs").last).to_contain_text("part.ngc")
    page.locator(".jobs").last.locator(".job").first.click()
    expect(page.locator("dialog")).to_contain_text("C120")


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


def hold_until_it_moves(p, page, key):
    """On a busy host a sign may be late: then it is pressed again."""
    for _ in range(10):
        before = p.machine.client.status().pos_mm[1]
        key.hover()
        page.mouse.down()
        try:
            p.machine.client.status_where(
                lambda s: abs(s.pos_mm[1] - before) > 0.3, 3)
            return before
        except AssertionError:
            page.mouse.up()
    raise AssertionError("no press moved the axis")


def stands(p):
    """Where it stands, and goes on to stand."""
    c = p.machine.client
    s = c.status_where(lambda s: s.state == "idle", 20)
    return c.status_where(
        lambda t: t.utime > s.utime + 400000).pos_mm[1] == s.pos_mm[1]


def test_an_axis_moves_while_its_key_is_pressed(p, page):
    page.goto(p.url + "/#/setup")
    page.get_by_role("radio", name="while pressed").click()
    page.get_by_role("radio", name="middle").click()
    key = page.locator("#jog-Y-plus")
    # Let go.
    hold_until_it_moves(p, page, key)
    page.mouse.up()
    assert stands(p)
    # Slipped off.
    hold_until_it_moves(p, page, page.locator("#jog-Y-minus"))
    page.mouse.move(5, 5)
    assert stands(p)
    page.mouse.up()
    # The panel stops in the middle, and what it was sent meanwhile is old.
    hold_until_it_moves(p, page, key)
    p.process.send_signal(signal.SIGSTOP)
    try:
        assert stands(p)
    finally:
        p.process.send_signal(signal.SIGCONT)
    assert stands(p)
    page.mouse.up()
    # The page is gone.
    hold_until_it_moves(p, page, key)
    page.close()
    assert stands(p)


def test_both_languages(p, page):
    page.goto(p.url + "/#/machine")
    page.get_by_role("radio", name="\u4e2d\u6587").click()
    expect(page.locator(".rail")).to_contain_text("\u52a0\u5de5")
    for name in ("cut", "jobs", "setup", "tech", "alarms", "machine",
                 "fleet"):
        page.goto(p.url + f"/#/{name}")
        expect(page.locator("main.page")).to_be_visible()
        page.wait_for_timeout(150)
        words = page.locator("main.page h2").all_inner_texts()
        assert any(re.search("[\u4e00-\u9fff]", w) for w in words) or \
            name == "fleet", (name, words)
    p.machine.client.ask("estop")
    expect(page.locator(".head h1")).to_have_text("\u6025\u505c")
    p.machine.client.ask("reset")
    page.goto(p.url + "/#/machine")
    page.get_by_role("radio", name="English").click()
    expect(page.locator(".rail")).to_contain_text("Cut")
