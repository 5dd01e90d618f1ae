# SPDX-License-Identifier: Apache-2.0
"""What is set for a job of a wire, in the form of the panel's page."""

import panel
import pytest
from panel_states import WIRE
from playwright.sync_api import expect
from test_panel import RECORDS
from test_panel_page import chromium, give, page  # noqa: F401


@pytest.fixture(scope="module")
def p(tmp_path_factory):
    p = panel.Panel(tmp_path_factory.mktemp("wire"), config=WIRE)
    p.start()
    yield p
    p.close()


def test_a_3b_contour_leans_by_what_the_form_says(p, page):  # noqa: F811
    page.goto(p.url + "/#/jobs")
    give(page, RECORDS, "cone.3b")
    verdict = page.locator(".draft .verdict")
    expect(verdict).to_contain_text("Understood: 4 lines, 8.28 mm of path.")
    page.locator("#setting summary").click()
    page.fill("#set-scale", "2")
    expect(verdict).to_contain_text("Understood: 4 lines, 16.5")
    page.fill("#set-taper", "85")
    expect(verdict).to_contain_text("taper=85")
    expect(page.locator("#send")).to_have_attribute("aria-disabled", "true")
    page.fill("#set-taper", "-0,5")
    page.get_by_role("radio", name="of X").click()
    expect(verdict).to_contain_text("Understood: 4 lines")
    expect(page.locator("#send")).to_have_attribute("aria-disabled", "false")
    page.locator("#send").click()
    expect(page.locator(".draft")).to_have_count(0)
    c = p.machine.client
    s = c.status_where(lambda s: s.job, 20)
    assert c.job(s.job)["setting"] == "scale=2 taper=-0.5 mirror=x"
