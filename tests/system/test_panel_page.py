# SPDX-License-Identifier: Apache-2.0
"""The panel's page in a browser, against the real gateway and daemons."""

import json
import os
import re
import signal

import panel
import pytest
import rig
from playwright.sync_api import expect, sync_playwright

PATIENCE_MS = 40000
AXE = rig.BUILD / "web/node_modules/axe-core/axe.min.js"
PAGES = ("cut", "jobs", "setup", "tech", "alarms", "machine", "fleet")
expect.set_options(timeout=PATIENCE_MS)

WRONG = b"G21 G90\nG1 X5 F30\nG1 Y5 Q77\nM30\n"


@pytest.fixture(scope="module")
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=panel.CHROMIUM, args=panel.CHROMIUM_FLAGS)
        yield browser
        browser.close()


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


# Resolves when the key was pressed for long enough: it does not show it any more.
ENOUGH = """key => { window.enough = new Promise(done => {
    let on = false;
    const look = () => {
        const now = key.isConnected && key.classList.contains("pressed");
        if (on && !now) done();
        on = now;
    };
    new MutationObserver(look).observe(document.body, {
        subtree: true, childList: true, attributes: true });
    setTimeout(done, 30000);
}); }"""


def press(key):
    """Pressed for the second that it wants, by the page's own clock: on a busy
    host the page may see late that it is pressed."""
    expect(key).to_have_attribute("aria-disabled", "false")
    key.scroll_into_view_if_needed()
    key.hover()
    key.evaluate(ENOUGH)
    key.page.mouse.down()
    key.page.evaluate("window.enough")
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
    # The numbers stand beside their lines.
    tops = page.locator(".gutter pre, .editor textarea").evaluate_all(
        "all => all.map(e => e.getBoundingClientRect().top + "
        "parseFloat(getComputedStyle(e).paddingTop) + "
        "parseFloat(getComputedStyle(e).borderTopWidth))")
    assert abs(tops[0] - tops[1]) < 1
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
    expect(page.locator("dialog #conditions")).to_contain_text("C120")
    expect(page.locator("dialog #jobfaults tbody tr")).to_have_count(1)
    expect(page.locator("dialog")).to_contain_text("kJ")
    page.keyboard.press("Escape")
    with page.expect_download() as saved:
        page.locator("#historycsv").click()
    table = p.machine.ctl("history", "--csv")
    assert table.returncode == 0 and "C120=" in table.stdout
    with open(saved.value.path(), newline="") as f:
        assert f.read() == table.stdout.replace("\n", "\r\n")


def test_an_axis_that_is_moved_by_hand_has_no_feed_along_a_path(p, page):
    end_job(page, p)
    show(page, "cut")
    feed = page.locator(".feed .reading")
    client = p.machine.client
    assert client.ask("jog", text="X", arg=20).code == 0
    expect(feed.locator("b")).to_have_text("\u2013")
    expect(feed.locator("em")).to_have_count(0)
    assert client.ask("jog", text="X", arg=-20).code in (0, 1)
    client.status_where(lambda s: s.state == "idle", 60)


def test_an_axis_is_jogged_by_steps(p, page):
    page.goto(p.url + "/#/setup")
    before = p.machine.client.status().pos_mm[0]
    page.get_by_role("radio", name="1", exact=True).click()
    page.locator("#jog-X-plus").click()
    p.machine.client.status_where(
        lambda s: abs(s.pos_mm[0] - before - 1) < 1e-6, 20)
    expect(page.locator(".axes tr").first).to_contain_text(
        f"{before + 1:.3f}")
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
    page.get_by_role("radio", name="middle", exact=True).click()
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
    for name in PAGES:
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


def show(page, name):
    page.evaluate(f"location.hash = '#/{name}'")
    page.locator(f"main.page-{name}").wait_for()
    page.wait_for_timeout(150)


def test_axe_finds_nothing_serious(p, page):
    page.evaluate(AXE.read_text())
    found = []

    def look(where, rules=""):
        got = page.evaluate("axe.run(document, {resultTypes: ['violations']"
                            f"{rules}}})")
        found.extend((where, v["id"], v["impact"], v["nodes"][0]["html"])
                     for v in got["violations"]
                     if v["impact"] in ("serious", "critical"))

    # In the dark only the colours are others.
    for theme, rules in (("light", ""),
                         ("dark", ", runOnly: ['color-contrast']")):
        page.emulate_media(color_scheme=theme)
        for name in PAGES:
            show(page, name)
            look((name, theme), rules)
        show(page, "cut")
        page.locator("#chip-servo_v").click()
        look(("sheet", theme), rules)
        page.keyboard.press("Escape")
    assert found == []


# Where the keyboard is, and whether that can be seen.
FOCUSED = """() => {
    const e = document.activeElement;
    if (e === document.body || !document.querySelector("main").contains(e))
        return null;
    window.seen = window.seen ?? new Set();
    window.seen.add(e);
    const shown = [e, e.closest(".box"), e.closest(".editor")].some((b) => b &&
        getComputedStyle(b).outlineStyle !== "none" &&
        parseFloat(getComputedStyle(b).outlineWidth) >= 2);
    return shown ? "" : e.outerHTML.slice(0, 120);
}"""
UNSEEN = """() => [...document.querySelectorAll(
    "main button, main input, main select, main textarea")].filter((e) =>
        e.getBoundingClientRect().width > 0 && e.tabIndex >= 0 &&
        !window.seen?.has(e)).map((e) => e.outerHTML.slice(0, 120))"""


def test_the_keyboard_reaches_every_key_and_shows_where_it_is(p, page):
    # Of the table of the page Technology each cell is one.
    for name in (n for n in PAGES if n != "tech"):
        show(page, name)
        page.evaluate("window.seen = new Set(); "
                      "document.querySelector('main').focus()")
        for _ in range(120):
            page.keyboard.press("Tab")
            where = page.evaluate(FOCUSED)
            if where is None:
                break
            assert where == "", (name, where)
        assert page.evaluate(UNSEEN) == [], name


# What no scrolling sideways can reach, or lies under another key.
CUT_OFF = """() => [...document.querySelectorAll(
    "button, a, input, select, h2, .n")].filter((e) => {
        const r = e.getBoundingClientRect();
        return r.width > 0 && (r.right > innerWidth + 1 || r.left < -1) &&
            !e.closest(".scroll, .chips, .skip, .editor") &&
            !e.matches(".skip, .hidden");
    }).map((e) => e.outerHTML.slice(0, 120))"""


@pytest.mark.parametrize("size", [(1280, 800), (800, 480), (390, 844)])
def test_nothing_is_cut_off(p, page, size):
    page.set_viewport_size({"width": size[0], "height": size[1]})
    for name in PAGES:
        show(page, name)
        assert page.evaluate(CUT_OFF) == [], name
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
        stop = page.locator("#stop").bounding_box()
        assert stop["height"] >= 44 and stop["width"] >= 88
    show(page, "cut")
    for key in ("#start", "#hold", "#retract"):
        assert page.locator(key).bounding_box()["height"] >= 48, key
    # Stop lies over every sheet, but over none of its keys.
    for opens in ("#chip-servo_v", "#chip-condition", ".gap h2 button"):
        page.locator(opens).first.click()
        page.locator("dialog[open] header button").click()
        expect(page.locator("dialog[open]")).to_have_count(0)


def clicks(page):
    return page.evaluate("window.clicks")


def test_a_program_begins_at_a_line(p, page):
    page.goto(p.url + "/#/jobs")
    give(page, panel.JOB)
    expect(page.locator("#send")).to_have_attribute("aria-disabled", "false")
    page.locator("#fromline").fill("seven")
    expect(page.locator("#send")).to_have_attribute("aria-disabled", "true")
    page.locator("#fromline").fill("99")
    expect(page.locator("#sendstart")).to_have_attribute("aria-disabled",
                                                         "true")
    page.locator("#send").click()
    expect(page.locator(".toasts")).to_contain_text(
        "nothing moves on the path from line 99 on")
    page.locator("#fromline").fill("7")
    page.locator("#send").click()
    expect(page.locator(".toasts")).to_contain_text("off the work")
    s = p.machine.client.status_where(lambda s: s.state == "hold", 10)
    assert s.job_name == "part.ngc"
    picture = os.environ.get("EDM_PICTURES")
    if picture:
        page.screenshot(path=f"{picture}/from-line.png")
    end_job(page, p)


def electrode(p, n):
    rows = json.loads(p.machine.ctl("electrode", "list", "--json").stdout)
    return next((e for e in rows if e["n"] == n), None)


def test_the_table_of_electrodes_is_kept_here(p, page):
    page.goto(p.url + "/#/setup")
    card = page.locator(".electrodes")
    expect(card).to_contain_text("empty")
    page.locator("#el-add").click()
    sheet = page.locator("dialog[open]")
    expect(page.locator("#el-save")).to_have_attribute("aria-disabled", "true")
    for field, value in (("n", "3"), ("name", "rib"), ("material", "copper"),
                         ("length", "42,5"), ("life", "0.5")):
        page.locator(f"#el-{field}").fill(value)
    page.locator("#el-save").click()
    expect(sheet).to_have_count(0)
    e = electrode(p, 3)
    assert (e["name"], e["length_mm"], e["life_mm"]) == ("rib", 42.5, 0.5)
    # A number that is taken is refused, and the form stays as it is.
    page.locator("#el-add").click()
    page.locator("#el-n").fill("3")
    page.locator("#el-save").click()
    expect(page.locator(".toast").last).to_contain_text("there already")
    expect(page.locator("#el-n")).to_have_value("3")
    page.locator("dialog[open] header button").click()
    # Only what is changed here is sent: wear that came meanwhile stays.
    card.get_by_role("button", name="Electrode 3").click()
    p.machine.ctl("electrode", "set", "3", "wear=0.4")
    page.locator("#el-note").fill("left of the box")
    page.locator("#el-save").click()
    expect(sheet).to_have_count(0)
    e = electrode(p, 3)
    assert (e["note"], e["wear_mm"]) == ("left of the box", 0.4)
    expect(card).to_contain_text("20 %")
    # Into the holder, measured, out of the table.
    card.get_by_role("button", name="Electrode 3").click()
    press(page.locator("#el-use"))
    expect(card).to_contain_text("in the holder")
    show(page, "cut")
    expect(page.locator("#held")).to_contain_text("3")
    show(page, "setup")
    card.get_by_role("button", name="Electrode 3").click()
    press(page.locator("#el-measure"))
    expect(page.locator(".toast").last).to_contain_text(
        "no reference to measure at")
    page.locator("dialog[open] header button").click()
    card.get_by_role("button", name="Electrode 3").click()
    press(page.locator("#el-remove"))
    expect(card).to_contain_text("empty")
    assert electrode(p, 3) is None


def test_technology_is_saved_on_the_host_and_comes_back(p, page):
    file = p.folder / "copper-steel.tech"
    was = file.read_text()
    show(page, "tech")
    cell = page.get_by_label("C120 mean gap voltage to hold")
    before = cell.input_value()
    cell.fill("31")
    cell.press("Enter")
    press(page.locator("#techsave"))
    versions = page.locator(".versions li")
    expect(versions).to_have_count(2)
    expect(versions.first).to_contain_text("C120.servo_v=31")
    expect(cell).to_have_value("31")
    assert file.read_text() != was
    press(versions.nth(1).get_by_role("button", name="Take version 1 back"))
    expect(versions).to_have_count(3)
    expect(cell).to_have_value(before)
    assert file.read_text() == was


def test_what_is_begun_is_there_when_its_page_is_opened_again(p, page):
    show(page, "setup")
    page.locator("#mdi").fill("G0 X5")
    page.locator("#probe-form").select_option("hole")
    way = page.locator(".probing input").first
    way.fill("7.5")
    show(page, "tech")
    cell = page.get_by_label("C100 mean gap voltage to hold")
    cell.fill("21.5")
    cell.press("Enter")
    expect(page.locator("#techsave")).to_be_visible()
    show(page, "cut")
    show(page, "setup")
    expect(page.locator("#mdi")).to_have_value("G0 X5")
    expect(way).to_have_value("7.5")
    show(page, "tech")
    expect(page.locator("#techsave")).to_be_visible()
    expect(cell).to_have_value("21.5")


def test_the_lie_of_the_work_is_a_form(p, page):
    end_job(page, p)
    show(page, "setup")
    page.locator("#probe-form").select_option(label="Lie of the work")
    form = page.locator(".probe")
    expect(form.locator(".felt")).to_contain_text("Turn")
    expect(form.locator(".felt")).to_contain_text("0.0000\u00b0")
    # Along which axis is asked for a face above alone; nothing is cut off.
    expect(form.get_by_text("Along", exact=True)).to_have_count(0)
    form.get_by_role("radio", name="Z\u2212").click()
    expect(form.get_by_text("Along", exact=True)).to_be_visible()
    for choice in page.locator(".probing .choice").all():
        assert choice.evaluate("e => e.scrollWidth <= e.clientWidth")
    expect(form.locator(".felt")).to_contain_text("Rises along X")
    page.locator("#probe-form").select_option(label="Middle of the electrode")
    expect(form.locator(".drawing")).to_be_visible()
    # Without an electrode of the table there is nothing to give it to.
    expect(page.locator("#probe-run")).to_have_attribute("aria-disabled",
                                                         "true")


def offset(p, work):
    rows = json.loads(p.machine.ctl("offset", "--json").stdout)
    return next(r for r in rows if r["work"] == work)


def test_work_offsets_are_shown_and_changed_here(p, page):
    """As `edmctl offset` has them, whoever changed them."""
    end_job(page, p)
    page.goto(p.url + "/#/setup")
    card = page.locator(".offsets")
    expect(card).to_contain_text("G59.3")
    x = json.loads(p.machine.ctl("status", "--json").stdout)["pos_mm"][0]
    card.get_by_role("button", name="Work offset G54").click()
    sheet = page.locator("dialog[open]")
    save = page.locator("#off-save")
    expect(save).to_have_attribute("aria-disabled", "true")
    page.locator("#off-X").fill("five")
    expect(save).to_have_attribute("aria-disabled", "true")
    page.locator("#off-X").fill("2,5")
    save.click()
    expect(sheet).to_have_count(0)
    row = offset(p, "G54")
    assert (row["touched"], row["X"]) == ("X", pytest.approx(x - 2.5))
    expect(card).to_contain_text("*")
    # The origin itself, of two axes; the third stays.
    card.get_by_role("button", name="Work offset G54").click()
    page.get_by_role("radio", name="Origin at").click()
    page.locator("#off-X").fill("1.25")
    page.locator("#off-Y").fill("-3")
    save.click()
    expect(sheet).to_have_count(0)
    row = offset(p, "G54")
    assert (row["touched"], row["X"], row["Y"]) == ("XY", 1.25, -3)
    # What edmctl changes is seen here.
    p.machine.ctl("offset", "G59.3", "Z@7.125")
    expect(card).to_contain_text("7.125*")
    for work in ("G54", "G59.3"):
        card.get_by_role("button", name=f"Work offset {work}",
                         exact=True).click()
        page.locator("#off-clear").click()
        expect(sheet).to_have_count(0)
        assert offset(p, work)["touched"] == ""
    # A refusal is told, and the sheet stays.
    card.get_by_role("button", name="Work offset G55").click()
    page.locator("#off-Y").fill("20000000")
    save.click()
    expect(page.locator(".toast").last).to_contain_text("'Y=20000000'")
    expect(sheet).to_have_count(1)
    assert offset(p, "G55")["touched"] == ""


def test_few_clicks_lead_where_one_wants(p, page):
    page.goto(p.url + "/#/jobs")
    page.evaluate("""() => { window.clicks = 0;
        addEventListener("pointerdown", () => window.clicks++, true); }""")
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Choose a file").click()
    chooser.value.set_files({"name": "a.ngc", "mimeType": "text/plain",
                             "buffer": panel.JOB.replace(b"F30", b"F1")})
    expect(page.locator("#sendstart")).to_have_attribute("aria-disabled",
                                                         "false")
    press(page.locator("#sendstart"))
    expect(page.locator(".head h1")).to_have_text("Cutting")
    assert clicks(page) <= 3
    # The line of the program that is cut can be read.
    expect(page.locator(".progress code")).to_contain_text("G1 Z-2")

    page.evaluate("window.clicks = 0")
    page.locator("#chip-servo_v").click()
    page.locator("#more-servo_v").click()
    expect(page.locator(".stepper output")).to_have_text("16 V")
    assert clicks(page) == 2
    assert p.machine.client.status().state != "fault"
    expect(page.locator("#chip-servo_v")).to_have_class(re.compile("set"))
    page.keyboard.press("Escape")

    # Why it stands: read from any page, without a click.
    p.machine.client.ask("estop")
    for name in PAGES:
        show(page, name)
        expect(page.locator(".head h1")).to_have_text("Emergency stop")
        expect(page.locator(".head .state p")).to_contain_text("Release")
    assert clicks(page) == 2
    end_job(page, p)


def test_stop_is_reached_when_a_sheet_is_open(p, page):
    page.locator("#chip-servo_v").click()
    expect(page.locator(".sheet")).to_be_visible()
    at = page.locator("#stop").bounding_box()
    page.mouse.click(at["x"] + at["width"] / 2, at["y"] + at["height"] / 2)
    expect(page.locator(".head .dot")).to_have_class(re.compile("cross"))
    p.machine.client.status_where(lambda s: s.fault == "e-stop")
    end_job(page, p)


def test_a_file_of_another_system_has_its_error_where_it_stands(p, page):
    """Ends of lines are two bytes there; a comment of three a character."""
    page.goto(p.url + "/#/jobs")
    text = "G21 G90\r\n" * 50 + "(\u7535\u6781) G1 Q77\r\nM30\r\n"
    give(page, text.encode(), "\u7535" * 40 + "\u202e.ngc")
    expect(page.locator(".refusal")).to_contain_text("Line 51")
    expect(page.locator(".draft h2").first).to_have_text(
        re.compile("\u7535+_?\\.ngc$"))
    rig.until(lambda: page.evaluate("""() => {
        const e = document.querySelector("#editor");
        return e.value.slice(e.selectionStart).startsWith("Q77"); }"""))


def test_a_program_is_dropped_on_any_page(p, page):
    show(page, "machine")
    page.evaluate("""() => { const d = new DataTransfer();
        d.items.add(new File(["G21\\nG1 X1 F30\\nM30\\n"], "dropped.ngc"));
        for (const kind of ["dragover", "drop"])
            dispatchEvent(new DragEvent(kind, {dataTransfer: d,
                                               cancelable: true})); }""")
    expect(page.locator("main.page-jobs .draft h2").first).to_have_text(
        "dropped.ngc")
    expect(page.locator(".verdict .good")).to_be_visible()


def test_jobs_that_wait_change_places(p, page):
    session = p.session()
    for name in ("one.ngc", "two.ngc", "three.ngc"):
        session.post(f"/api/jobs?name={name}&hold=1", panel.JOB)
    show(page, "jobs")
    names = page.locator(".jobs").first.locator(".job b")
    expect(names).to_have_text(["one.ngc", "two.ngc", "three.ngc"])
    page.get_by_role("button", name="three.ngc: earlier").click()
    expect(names).to_have_text(["one.ngc", "three.ngc", "two.ngc"])
    end_jobs_of_queue(p)
    p.machine.client.status_where(lambda s: not s.job, 20)


def test_a_long_queue_is_shown_page_by_page(p, page):
    session = p.session()
    for name in ("one.ngc", "two.ngc"):
        session.post(f"/api/jobs?name={name}&hold=1", panel.JOB)
    show(page, "jobs")
    rows = page.locator(".jobs").first.locator(".job")
    expect(rows).to_have_count(2)
    more = page.locator(".two > :first-child").get_by_role(
        "button", name="Show more")
    expect(more).to_have_count(0)
    waits = [j["job"] for j in json.loads(
        p.machine.client.ask("queue").body)][1]
    rig.fill_queue(p.machine, waits, 420)
    expect(more).to_be_visible()
    first = rows.count()
    assert 100 < first < 422
    # While nobody answers, what is known stays: the rows, and that there are more.
    os.kill(p.machine.jobs.pid, signal.SIGSTOP)
    try:
        expect(page.locator(".two > :first-child .note")).to_be_visible()
        assert (rows.count(), more.count()) == (first, 1)
    finally:
        os.kill(p.machine.jobs.pid, signal.SIGCONT)
    while rows.count() < 422:
        shown = rows.count()
        more.click()
        expect(rows.nth(shown)).to_be_attached()
    expect(rows).to_have_count(422)
    expect(more).to_have_count(0)
    with rig.store_of(p.machine) as db:
        db.execute("DELETE FROM job WHERE id LIKE 'job-%'")
    expect(rows).to_have_count(2)
    end_jobs_of_queue(p)
    p.machine.client.status_where(lambda s: not s.job, 20)


def end_jobs_of_queue(p):
    """All of them: one that is being loaded is not removed before it is."""
    def none():
        jobs = live.ask("queue")["body"]
        for job in jobs:
            live.ask("remove", job=job["job"])
        return not jobs
    with p.session().live() as live:
        rig.until(none, 20, 0.1)


def test_the_panel_dies_and_comes_back(p, page):
    page.evaluate("window.same = 1")
    p.kill()
    expect(page.locator(".head h1")).to_have_text("Connection lost")
    show(page, "cut")
    expect(page.locator("#start")).to_have_attribute("aria-disabled", "true")
    page.locator("#stop").click(force=True)
    expect(page.locator(".toast.bad")).to_contain_text("No connection")
    p.start_panel()
    expect(page.locator(".head h1")).to_have_text("Idle")
    # What is done on it after that is done: a new session was made.
    page.locator("#chip-override").click()
    page.get_by_role("button", name="50 %", exact=True).click()
    expect(page.locator("#chip-override")).to_contain_text("50")
    page.locator("#chip-override").click()
    page.get_by_role("button", name="100 %", exact=True).click()
    expect(page.locator("#chip-override")).to_contain_text("100")
    assert page.evaluate("window.same") == 1


def test_a_power_cut_is_told(p, page):
    """All of the machine is gone at once, and nothing of it is in memory."""
    client = p.machine.client
    # So long that it is not over, however late this process sees it begin.
    p.session().post("/api/jobs?name=night.ngc",
                     panel.JOB.replace(b"G1 Z-2 ", b"G1 Z-9 "))
    client.status_where(lambda s: s.state == "erode", 60)
    p.machine.kill("jobs")
    p.machine.kill("edmd")
    p.machine.sweep()
    p.machine.start()
    expect(page.locator(".head h1")).to_have_text("Interrupted")
    expect(page.locator(".badge.warn")).to_be_visible()
    page.locator("#start").click(force=True)
    expect(page.locator(".toast.bad")).to_contain_text("cut off")
    expect(page.locator(".positions")).to_contain_text("not certain")
    # Where to end it is said by the key that leads there.
    expect(page.locator("#retract")).to_contain_text("end")
    show(page, "alarms")
    expect(page.locator(".warnings")).to_contain_text("X Y Z")
    show(page, "jobs")
    row = page.locator(".jobs li", has_text="night.ngc").first
    expect(row).to_contain_text("interrupted")
    row.get_by_role("button", name="Resume").click()
    press(page.locator("#resumejob"))
    expect(page.locator(".head h1")).to_have_text("Ready")
    client.status_where(lambda s: s.state == "hold", 20)
    show(page, "cut")
    press(page.locator("#start"))
    client.status_where(lambda s: s.state == "erode", 60)
    end_job(page, p)


def test_the_daemon_dies_and_comes_back(p, page):
    p.machine.kill("edmd")
    expect(page.locator(".head h1")).to_have_text("No signal")
    expect(page.locator(".head .state p")).to_contain_text("emergency stop")
    show(page, "setup")
    page.locator("#probe-run[aria-disabled=true]").wait_for()
    show(page, "alarms")
    expect(page.locator(".page-alarms .calm")).to_contain_text("edmd is dead")
    p.machine.start_edmd()
    expect(page.locator(".head h1")).to_have_text("Idle")
    p.machine.kill("jobs")
    expect(page.locator(".head .state p")).to_contain_text(
        "edmd-jobs does not answer")
    p.machine.start_jobs()
    expect(page.locator(".head .state p")).to_contain_text("No job is loaded")


CHANGE = b"G21 G90 F600\nG0 Z1\nT3\nG0 Z2\nM0 (look at it)\nG0 Z3\nM30\n"
SIZES = ((1280, 800), (800, 480), (390, 844))


def shot(page, name):
    if folder := os.environ.get("EDM_SHOTS"):
        page.screenshot(path=f"{folder}/{name}.png")


def test_the_page_says_what_it_stands_for_and_takes_the_answer(p, page):
    client = p.machine.client
    for n in (1, 3):
        client.ask("electrode-add", arg=n, text=f"name=e{n}")
    client.ask("electrode-use", arg=1)
    end_job(page, p)
    assert client.submit(CHANGE, "change", hold=True).code == 0
    client.job_where("change", "ready", 20)
    press(page.locator("#start"))
    why = page.locator(".head .state p")
    expect(why).to_have_text("Put electrode 3 (e3) in; 1 (e1) is in. Then "
                             "confirm it on Cut.")
    expect(page.locator("#start")).to_have_attribute("aria-disabled", "true")
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        for key in ("#done", "#start"):
            expect(page.locator(key)).to_be_in_viewport(ratio=1)
        expect(why).to_be_in_viewport(ratio=1)
        assert why.evaluate("e => e.scrollWidth <= e.clientWidth + 1")
        shot(page, f"electrode-{width}")
    press(page.locator("#done"))
    expect(why).to_have_text("Electrode 3 (e3) is in. Go on.")
    expect(page.locator("#done")).to_have_count(0)
    press(page.locator("#start"))
    expect(why).to_have_text("The program stops in line 5: look at it. Go on "
                             "when you are ready.")
    shot(page, "stop-390")
    press(page.locator("#start"))
    client.job_where("change", "done", 30)
    client.ask("electrode-use", arg=0)


# The second of a press is over when the test says so.
SECOND = """() => {
    const set = setTimeout, clear = clearTimeout, held = new Map();
    window.setTimeout = (f, ms, ...more) => ms !== 1000 ? set(f, ms, ...more) :
        (held.set(-1 - held.size, f), -held.size);
    window.clearTimeout = (n) => held.delete(n) || clear(n);
    window.over = () => { held.forEach((f) => f()); return held.size; };
}"""


def test_a_press_is_for_the_stand_it_was_begun_for(p, page):
    """Somebody else goes on, and the next stand comes, under the finger."""
    client = p.machine.client
    end_job(page, p)
    assert client.submit(b"G21 G90 F600\nG0 Z1\nM0 (one)\nG0 Z2\nM0 (two)\n"
                         b"G0 Z3\nM30\n", "twice").code == 0
    key, why = page.locator("#start"), page.locator(".head .state p")
    expect(why).to_contain_text("line 3")
    expect(key).to_have_attribute("aria-disabled", "false")
    page.evaluate(SECOND)
    key.hover()
    page.mouse.down()
    expect(key).to_have_class(re.compile("pressed"))
    assert client.ask("start").code == 0
    client.status_where(lambda s: s.stand == "stop" and s.line == 5, 20)
    expect(why).to_contain_text("line 5")
    assert page.evaluate("over()") == 1
    page.mouse.up()
    expect(page.locator(".toasts").last).to_contain_text(
        "that stand is over")
    expect(why).to_contain_text("line 5")
    assert client.ask("stop").code == 0
    client.job_where("twice", "stopped", 20)
    page.reload()


def test_a_press_is_for_the_job_it_was_begun_for(p, page):
    """The job is ended, and the next one comes, while a finger is on the key."""
    client = p.machine.client
    end_job(page, p)
    for job in ("first", "second"):
        assert client.submit(b"G21 G90\nG0 Z1\nM30\n", job, name=f"{job}.ngc",
                             hold=True).code == 0
    key, why = page.locator("#start"), page.locator(".head .state p")
    expect(why).to_contain_text("first.ngc")
    expect(key).to_have_attribute("aria-disabled", "false")
    page.evaluate(SECOND)
    key.hover()
    page.mouse.down()
    expect(key).to_have_class(re.compile("pressed"))
    client.ask("stop")
    expect(why).to_contain_text("second.ngc")
    expect(key).not_to_have_class(re.compile("pressed"))
    assert page.evaluate("window.over()") == 0
    page.mouse.up()
    key.hover()
    page.mouse.down()
    expect(key).to_have_class(re.compile("pressed"))
    assert page.evaluate("window.over()") == 1
    page.mouse.up()
    client.job_where("second", "done", 20)


def test_a_form_shows_what_it_will_do_beside_its_key(p, page):
    """On a small panel nothing that says where the axis goes is out of sight."""
    end_job(page, p)
    page.set_viewport_size({"width": 800, "height": 480})
    show(page, "setup")
    key = page.locator("#probe-run")
    for form in ("edge", "hole", "corner"):
        page.locator("#probe-form").select_option(form)
        # What it is called when it is felt may be below.
        for field in page.locator(".probe .field").filter(
                has_not_text=re.compile("It is|Radius of")).all():
            expect(field).to_be_in_viewport(ratio=1)
            box, under = field.bounding_box(), key.bounding_box()
            assert box["y"] + box["height"] <= under["y"] + 1, (form, box, under)


# Is a line of text shown whole, with nothing of it cut off?
WHOLE = """e => e.scrollWidth <= e.clientWidth + 1 &&
    e.scrollHeight <= e.clientHeight + 1"""


def says_on_every_page(page, words):
    """In the head, which is above everything else of the page."""
    for name in PAGES:
        show(page, name)
        why = page.locator("header.head .state p")
        expect(why).to_contain_text(words)
        assert why.evaluate(WHOLE), (name, why.inner_text())
        main = page.locator("main.page").bounding_box()
        assert why.bounding_box()["y"] < main["y"]


def test_every_page_says_at_its_top_that_no_command_gets_through(p, page):
    """And names what is left: the machine's own emergency stop."""
    own = "own emergency stop"
    try:
        p.machine.jobs.send_signal(signal.SIGSTOP)
        says_on_every_page(page, "edmd-jobs does not answer. Hold, Stop and "
                           "E-stop go to edmd itself")
        says_on_every_page(page, own)
        p.machine.edmd.send_signal(signal.SIGSTOP)
        says_on_every_page(page, "No command reaches the machine. Use its "
                           + own)
    finally:
        p.machine.edmd.send_signal(signal.SIGCONT)
        p.machine.jobs.send_signal(signal.SIGCONT)
    expect(page.locator(".head .state p")).not_to_contain_text(own)
    p.kill()
    says_on_every_page(page, own)
    p.start_panel()
    expect(page.locator(".head .state p")).not_to_contain_text(own)


def test_the_3d_part_is_fetched_again_where_it_was_lost(page):
    page.route("**/scene-*.js", lambda r: r.abort())
    page.reload()
    expect(page.locator(".view")).to_contain_text("cannot be drawn")
    page.unroute("**/scene-*.js")
    expect(page.locator(".view")).not_to_contain_text("cannot be drawn")
    assert page.evaluate("() => !!window.edmScene")
