# SPDX-License-Identifier: Apache-2.0
"""The panel's page in Firefox: a part from the file to the cut, and each page.

`make panel-firefox` runs it; Firefox is not among what `make check` installs.
"""

import os

import firefox
import panel
import pytest

PAGES = ("cut", "jobs", "setup", "tech", "alarms", "machine", "fleet")
GIVE = """
const data = new DataTransfer();
data.items.add(new File([arguments[0]], arguments[1], {type: "text/plain"}));
const input = document.querySelector("#file");
input.files = data.files;
input.dispatchEvent(new Event("change", {bubbles: true}));
"""
# What lies outside of its own card, or makes the page wider than the screen.
WIDE = """
return document.documentElement.scrollWidth > window.innerWidth ?
    document.documentElement.scrollWidth : 0;
"""


@pytest.fixture(params=["en-GB", "zh-CN"])
def fox(request, tmp_path):
    fox = firefox.Firefox(tmp_path, request.param)
    yield fox
    fox.close()


def shown(fox, name):
    fox.run("location.hash = '#/' + arguments[0]", name)
    fox.until(lambda: fox.run(
        "return !!document.querySelector('main.page-' + arguments[0])", name))


def keep_picture(fox, name):
    folder = os.environ.get("EDM_PICTURES")
    if folder:
        fox.picture(f"{folder}/firefox-{name}.png")


def test_a_part_is_cut_and_every_page_is_there(p, fox):
    client = p.machine.client
    fox.open(p.url)
    fox.run("window.wrong = []; addEventListener('error',"
            " e => window.wrong.push(String(e.message)))")
    fox.until(lambda: fox.text(".head h1") in ("Idle", "空闲"))
    shown(fox, "jobs")
    fox.run(GIVE, "G21 G90\nG1 X5 F30\nG1 Y5 Q77\nM30\n", "wrong.ngc")
    fox.until(lambda: "Q77" in fox.text(".verdict"))
    fox.run(GIVE, panel.JOB.decode(), "part.ngc")
    fox.until(lambda: fox.text(".verdict .good"))
    fox.press("#sendstart")
    client.status_where(lambda s: s.state == "erode", 60)
    shown(fox, "cut")
    fox.until(lambda: "part.ngc" in fox.text(".view"))
    fox.until(lambda: fox.run(
        "return !!document.querySelector('.view canvas')"))
    fox.click("#hold")
    client.status_where(lambda s: s.state == "hold", 20)
    fox.press("#start")
    client.status_where(lambda s: s.state != "hold", 20)
    for name in PAGES:
        shown(fox, name)
        assert fox.run(WIDE) == 0, name
        fox.until(lambda: fox.text(".page"))
        keep_picture(fox, name)
    fox.click("#stop")
    client.status_where(lambda s: s.fault == "e-stop", 20)
    shown(fox, "alarms")
    fox.click("#reset")
    client.status_where(lambda s: s.fault == "none", 20)
    assert fox.run("return window.wrong") == []
    client.ask("stop")
    client.status_where(lambda s: not s.job, 20)
