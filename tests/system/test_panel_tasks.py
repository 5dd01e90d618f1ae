# SPDX-License-Identifier: Apache-2.0
"""Tasks of an operator, counted: every tap, press and field on the panel.

docs/panel.md has the table.  What needs more than its row says fails here, and so
does what needs less: then the row is changed.
"""

import pathlib
import re

import panel
import panel_states
import pytest
from playwright.sync_api import expect
from test_panel_page import chromium, page, press  # noqa: F401
from test_place import die
from test_touch import PLATE

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/panel.md"
PART = b"G21 G90 G54\nG0 X0 Y0\nG0 Z0.5\nG1 Z0.05 F60\nG0 Z1\nM30\n"
FELT = PLATE + panel_states.OF_PANEL

# A field counts once, however long the text is that is typed into it.
COUNT = """() => { const counts = window.taps !== undefined;
    window.taps = window.fields = 0;
    if (counts) return;
    let last = null;
    addEventListener("pointerdown", (e) => {
        if (!e.target.matches("input:not([type=range])")) window.taps++;
        last = null; }, true);
    addEventListener("input", (e) => {
        if (e.target.type !== "file" && e.target !== last) window.fields++;
        last = e.target; }, true); }"""


def table():
    """Of docs/panel.md: task, taps, fields."""
    rows = re.findall(r"^\| ([^|]+?) \| (\d+) \| (\d+) \|$",
                      PAGE.read_text(), re.M)
    return {task: [int(taps), int(fields)] for task, taps, fields in rows}


def begin(page, p, name="cut"):     # noqa: F811
    """At that page, with nothing counted yet."""
    page.goto(f"{p.url}/#/{name}")
    page.locator(f"main.page-{name}").wait_for()
    page.evaluate(COUNT)


def end(page, task):                # noqa: F811
    got = page.evaluate("[window.taps, window.fields]")
    assert got == table()[task], (task, got)


def go_to(page, name):              # noqa: F811
    page.locator(f".rail a[href='#/{name}']").click()


@pytest.fixture
def p(tmp_path, request):
    one = panel_states.machine_of(request.param, tmp_path) \
        if request.param in panel_states.WALKS else \
        panel.Panel(tmp_path, config=request.param)
    one.start()
    yield one
    one.close()


def machine(which):
    return pytest.mark.parametrize("p", [which], indirect=True, ids=["machine"])


@machine(FELT)
def test_a_part_is_cut_at_a_zero_that_was_touched_off(p, page):  # noqa: F811
    """From a machine where nothing is set, on the panel alone."""
    begin(page, p)
    go_to(page, "setup")
    page.locator("#mdi").fill("G53 G0 X30 Y0")
    press(page.locator("#mdi-run"))
    expect(page.locator(".mdi")).to_contain_text("done")
    page.locator(".probing").get_by_role("radio", name="Z", exact=True).click()
    press(page.locator("#probe-run"))
    expect(page.locator(".felt")).to_contain_text("3.200")
    go_to(page, "jobs")
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Choose a file").click()
    chooser.value.set_files({"name": "own.ngc", "mimeType": "text/plain",
                             "buffer": PART})
    press(page.locator("#sendstart"))
    expect(page).to_have_url(re.compile("#/cut"))
    end(page, "cut a part at a zero that is touched off")
    p.machine.client.status_where(lambda s: not s.job, 60)
    go_to(page, "jobs")
    expect(page.locator(".jobs").last.locator("li", has_text="own.ngc").locator(
        ".job-done")).to_be_visible()


def at(p, walk, state):
    """The machine in a state of a walk."""
    for name, _ in panel_states.WALKS[walk][2](p):
        if name == state:
            return
    raise AssertionError(f"{walk} has no {state}")


@machine("stands")
def test_an_electrode_is_changed_and_nobody_guesses(p, page):  # noqa: F811
    at(p, "stands", "electrode")
    begin(page, p)
    expect(page.locator(".head .state p")).to_contain_text(
        "Put electrode 3 (rib, graphite) in; 1 (rough, copper) is in.")
    press(page.locator("#done"))
    press(page.locator("#start"))
    p.machine.client.status_where(lambda s: s.electrode == 3, 20)
    end(page, "change an electrode and go on")


@machine("sets")
def test_a_generator_is_set_by_hand(p, page):       # noqa: F811
    at(p, "sets", "setting")
    begin(page, p)
    expect(page.locator(".head .state p")).to_have_text(
        "At the generator, set C200: length of a pulse 20 \u00b5s, pause after a "
        "pulse 50 \u00b5s. Then confirm it on Cut.")
    asks = p.machine.ctl("status").stdout
    assert "set on_us 20 us, off_us 50 us for C200 at the generator" in asks, asks
    press(page.locator("#done"))
    press(page.locator("#start"))
    p.machine.client.status_where(lambda s: s.stand == "", 20)
    end(page, "say that the generator is set and go on")


# Walks as programmed, long enough to be cut off.
LONG = b"G21 G90\nG1 X40 F60\nG1 Y40\nM30\n"


@machine("stands")
def test_a_job_is_resumed_without_switches(p, page):        # noqa: F811
    """A power cut; every place is as it was seen last, says the operator."""
    m, c = p.machine, p.machine.client
    assert c.submit(LONG, "long").code == 0
    c.status_where(lambda s: s.pos_mm[0] > 2, 20)
    c.hear(1.5)                     # until it is on the disk
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted, 20)
    begin(page, p)
    expect(page.locator(".head h1")).to_have_text("Interrupted")
    page.locator("#resume").click()
    press(page.locator("#resumejob"))
    expect(page.locator(".head h1")).to_have_text("Ready")
    press(page.locator("#start"))
    c.status_where(lambda s: s.job_state == "running", 20)
    end(page, "resume a job after a power cut, without switches")


@machine(FELT)
def test_an_axis_is_told_where_it_stands(p, page):          # noqa: F811
    m, c = p.machine, p.machine.client
    assert m.ctl("mdi", "G0 X3").returncode == 0
    c.hear(1.5)
    die(m)
    m.start()
    c.status_where(lambda s: "X" in s.lost, 20)
    begin(page, p)
    go_to(page, "setup")
    press(page.locator("#seen-X"))
    c.status_where(lambda s: abs(s.pos_mm[0] - 3) < 1e-6, 20)
    end(page, "say that an axis stands as it was seen last")


@machine("cuts")
def test_a_cut_is_steered(p, page):                 # noqa: F811
    c = p.machine.client
    at(p, "cuts", "erode")
    begin(page, p)
    page.locator("#chip-servo_v").click()
    page.locator("#more-servo_v").click()
    expect(page.locator(".stepper output")).to_have_text("19 V")
    end(page, "raise the servo voltage of a cut by a step")
    page.keyboard.press("Escape")
    begin(page, p)
    page.locator("#hold").click()
    c.status_where(lambda s: s.state == "hold", 60)
    page.locator("#retract").click()
    press(page.locator("dialog .key", has_text="1 mm").first)
    end(page, "hold a cut and go 1 mm back")
    begin(page, p)
    page.locator("#stop").click()
    c.status_where(lambda s: s.state == "fault", 20)
    end(page, "stop everything")
    begin(page, p)
    page.locator("#reset").click()
    press(page.locator("#start"))
    c.status_where(lambda s: s.job_state == "running", 20)
    end(page, "reset a fault and go on")
    begin(page, p)
    go_to(page, "jobs")
    press(page.locator("#queueclear"))
    rows = page.locator(".jobs").first.locator("li")
    expect(rows).to_have_count(1)
    end(page, "remove all jobs that wait")
    for verb in ("hold", "stop"):
        c.ask(verb)


@machine("stands")
def test_the_reason_to_stand_needs_no_tap(p, page):         # noqa: F811
    """Each stand of the walk, on a phone, from whichever page is open."""
    said = {
        "ready": "press Start for 1 s", "stop": "stops in line 3: turn the part",
        "optional-stop": "line 5", "electrode": "Put electrode 3 (rib",
        "electrode-done": "Go on", "override": "set to 0 %",
        "held": "Held by command", "fault": "Release the button",
        "reset": "fault was reset", "restart": "started anew",
        "interrupted": "cut off", "lost-place": "is not certain. On Set up",
    }
    page.set_viewport_size({"width": 390, "height": 844})
    begin(page, p, "machine")
    for state, _ in panel_states.WALKS["stands"][2](p):
        if state not in said:
            continue
        why = page.locator(".head .state p")
        expect(why).to_contain_text(said.pop(state))
        expect(why).to_be_in_viewport(ratio=1)
    assert said == {}
    end(page, "read why it stands")
