# SPDX-License-Identifier: Apache-2.0
"""What an operator sees in every state, at three sizes, in two languages.

What to do is whole and in sight, keys can be hit by a finger, nothing lies over
them, colours can be read, and no English is left in Chinese.
"""

import re

import panel_states
import pytest
from playwright.sync_api import expect
from test_panel_page import AXE, PATIENCE_MS, SIZES, chromium, show  # noqa: F401

TONGUES = ("en-GB", "zh-CN")

# What the first line begins with where the machine stands.
HEADS = dict.fromkeys(("power", "generator", "m-code", "override"), "Waits") | \
    dict.fromkeys(("stop", "optional-stop", "electrode", "setting", "held", "plc",
                   "reset", "restart"), "Held") | {"ready": "Ready"}

# Of the head: is the line whole, in sight, and beside the key Stop?
SAYS = """() => {
    const p = document.querySelector(".head .state p");
    const h = document.querySelector(".head .state h1");
    const s = document.querySelector("#stop").getBoundingClientRect();
    return [h, p].filter((e) => {
        const r = e.getBoundingClientRect();
        return e.scrollWidth > e.clientWidth + 1 ||
            e.scrollHeight > e.clientHeight + 1 || r.top < 0 || r.left < 0 ||
            r.right > s.left || r.bottom > innerHeight ||
            r.bottom > document.querySelector("main").getBoundingClientRect().top
    }).map((e) => e.textContent);
}"""

# What a finger is to hit, and is too small for it.
SMALL = """() => [...document.querySelectorAll(
    "button, a, select, input:not(.hidden)")].filter((e) => {
        const box = e.closest(".box") ?? e, r = box.getBoundingClientRect();
        return r.width > 0 && !e.matches(".skip, .toast") &&
            (r.width < 43.5 || r.height < 43.5);
    }).map((e) => { const r = e.getBoundingClientRect();
        return `${r.width.toFixed(0)} x ${r.height.toFixed(0)} ` +
            e.outerHTML.slice(0, 90); })"""

# What of the page Cut must be seen without scrolling, and is not.
HIDDEN = """sums => ["#start", ".foot .keys .key:nth-child(2)", "#retract",
    ...(sums ? [".cut-side .sums", ".cut-side .positions"] : [])].filter((q) => {
        const e = document.querySelector(q), r = e.getBoundingClientRect();
        const b = (e.closest(".cut-side") ?? document.body)
            .getBoundingClientRect();
        return r.top < b.top - 1 || r.bottom > b.bottom + 1 ||
            r.left < b.left - 1 || r.right > b.right + 1;
    })"""

# A place that stands in another line than its axis.
WRAPPED = """() => [...document.querySelectorAll(".positions li")].filter((e) =>
    Math.abs(e.querySelector("b").getBoundingClientRect().bottom -
        e.querySelector(".n").getBoundingClientRect().bottom) > 12)
    .map((e) => e.textContent)"""

# Words of the page, but for what is written by machines and programs.
WORDS = """() => {
    const of = [], walk = document.createTreeWalker(document.body,
        NodeFilter.SHOW_TEXT);
    for (let n; (n = walk.nextNode());) {
        const e = n.parentElement;
        if (!e.closest("code, pre, option, script, noscript, .skip, .who, .ofshop") &&
            e.getClientRects().length)
            of.push(n.textContent);
    }
    return of.join("\\n");
}"""
# Names, units, and what the people of Chinese shops write as it is.
LATIN = set("""
    edmd edm-panel edm-dds edmctl edm jobs dds panel systemctl start English tech
    csv mm min deg kj plc gpio can status mib xyz root dev shm status
    preempt dynamic smp rough rib copper graphite plate ngc cavity die next feel turn the part
    feed gain servo jump every edmsim tune openat lcm mhz udpm
    """.split())


def sentences(page, name):
    """English that is left: two words of it beside each other, or a head."""
    found = []
    for line in page.evaluate(WORDS).split("\n"):
        for words in re.findall(r"[A-Za-z]{2,}(?:[ ,;:]+[A-Za-z]{2,})+", line):
            if not all(w.lower() in LATIN for w in
                       re.findall("[A-Za-z]+", words)):
                found.append((name, words))
    for head in page.locator("th, h2, h3, dt, .field > span").all_inner_texts():
        if re.search("[A-Za-z]{3,}", head) and ".ngc" not in head and \
                not re.search("[\u4e00-\u9fff]", head) and \
                head.lower() not in LATIN:
            found.append((name, head))
    # Its own marks between its own words.
    found += re.findall("[\u4e00-\u9fff][,;:(][ \u4e00-\u9fff]?",
                        page.evaluate(WORDS))
    return found


def pages_of(chromium, p):
    made = {}
    for tongue in TONGUES:
        context = chromium.new_context(locale=tongue, viewport={
            "width": 1280, "height": 800})
        context.set_default_timeout(PATIENCE_MS)
        one = context.new_page()
        one.goto(p.url)
        expect(one.locator("#stop")).to_be_visible()
        one.evaluate(AXE.read_text())
        made[tongue] = one
    return made


# All that is wrong with a page at this size, when it is drawn.
WRONG = f"""async ([cut, sums]) => {{
    for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
    const of = (what, found) => found.map((one) => [what, one]);
    return [...of("cut off", ({SAYS})()), ...of("small", ({SMALL})()), ...(cut ?
        [...of("hidden", ({HIDDEN})(sums)), ...of("wrapped", ({WRAPPED})())] : [])];
}}"""


def look(page, name, tongue):
    """Page @name at each size: all that is wrong, and with which width."""
    show(page, name)
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        for what in page.evaluate(WRONG, [name == "cut", width > 640]):
            yield width, *what
    if tongue == "zh-CN":
        for what in sentences(page, name):
            yield width, "English", what


def contrast(page):
    wrong = []
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        got = page.evaluate("axe.run(document, {resultTypes: ['violations'], "
                            "runOnly: ['color-contrast']})")
        wrong += [(theme, n["html"]) for v in got["violations"]
                  for n in v["nodes"]]
    return wrong


def told(wrong, *where):
    wrong = [(*where, *one) for one in wrong]
    for one in wrong:
        print(*one, flush=True)
    return wrong


@pytest.mark.parametrize("walk", panel_states.WALKS)
def test_every_state_is_said_and_can_be_acted_on(tmp_path, chromium,  # noqa: F811
                                                 walk):
    p = panel_states.machine_of(walk, tmp_path)
    p.start()
    found, pages = [], {}
    try:
        pages = pages_of(chromium, p)
        for state, names in panel_states.WALKS[walk][2](p):
            for tongue, page in pages.items():
                for name in names:
                    found += told(look(page, name, tongue), state, name, tongue)
            found += told(contrast(page), state, "contrast")
            if state in HEADS:
                expect(pages["en-GB"].locator(".head h1")).to_have_text(
                    HEADS[state])
    finally:
        for page in pages.values():
            page.context.close()
        p.close()
    assert found == []
