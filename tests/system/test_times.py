# SPDX-License-Identifier: Apache-2.0
"""The time left, on a machine that removes half of what is believed.

No test here asks how fast the host is: all times are those of the job.
"""

import json
import pathlib
import re
import sqlite3

import pytest
import rig

ROOT = pathlib.Path(__file__).resolve().parents[2]

SINK = b"G21 G90\nG0 Z1\nZ0\nM3\nF60\nC110\nG1 Z-0.8\nG0 Z1\nM30\n"
BELIEVED = 12.75


@pytest.fixture
def slow(tmp_path):
    """Both programs; edmd's process removes half of what the other thinks."""
    text = (ROOT / "examples/machine.ini").read_text()
    with rig.Machine(tmp_path) as m:
        text = re.sub(r"(?m)^name =.*$", f"name = {m.name}", text)
        text = re.sub(r"(?m)^speed *=.*$", "speed = 50", text)
        # Beside the folder of this machine file.
        text += f"\n[tech]\ntable = {ROOT}/examples/copper-steel.tech\n"

        def write(removal):
            m.config.write_text(re.sub(
                r"(?m)^removal_mm3_min *=[^;\n]*",
                f"removal_mm3_min = {removal} ", text))

        write(BELIEVED / 2)
        m.start_edmd()
        write(BELIEVED)
        m.start_jobs("--store", str(m.store))
        m.client.status_where(lambda s: s.daemon == "ok")
        yield m


def held(m, job, text=SINK):
    """A job that is loaded, and whose forecast is there."""
    c = m.client
    assert c.submit(text, job, hold=True).code == 0
    return c.status_where(lambda s: s.job == job and s.eta_s >= 0, timeout=30)


def test_before_the_cut_it_is_a_range_and_then_the_truth(slow):
    c = slow.client
    s = held(slow, "one")
    assert s.eta_by == "forecast"
    assert 0 < s.eta_min_s < 0.8 * s.eta_s
    assert s.eta_max_s > 1.2 * s.eta_s
    assert s.end_s == 0                     # it is held
    assert s.progress == 0
    n = len(c.statuses)
    assert c.ask("start").code == 0
    all_s = c.job_where("one", "done", timeout=60)["job_s"]
    assert all_s > 1.5 * s.eta_s            # it was believed to be quicker
    late = [t for t in c.statuses[n:]
            if t.job == "one" and all_s * 0.3 < t.job_s < all_s * 0.95]
    for t in late:
        assert t.eta_by == "cut"
        assert t.job_s + t.eta_s == pytest.approx(all_s, rel=0.3)
        assert t.progress == pytest.approx(t.job_s / all_s, abs=0.15)
    told = [e.text for e in c.events if e.kind == "longer"]
    assert told and "C110 takes 1." in told[-1]


def test_the_next_job_begins_with_what_was_learnt(slow):
    c = slow.client
    first = held(slow, "one")
    assert c.ask("start").code == 0
    all_s = c.job_where("one", "done", timeout=60)["job_s"]
    s = held(slow, "two")
    assert s.eta_by == "learnt"
    assert s.eta_condition == "C110"
    assert s.eta_factor > 1.4
    assert s.eta_s > 1.4 * first.eta_s
    assert s.eta_s == pytest.approx(all_s, rel=0.2)
    assert s.eta_max_s < 1.4 * s.eta_s      # and it is surer


# Much of its time is positioning, between the cuts of its condition.
HOLES = b"M3\nF60\nC110\nM98 P10 L3\nG90 G0 Z5\nM30\nO10\nG90 G0 Z.1\n" \
    b"G1 Z-.1\nG0 Z40\nG91 G0 X14 Y6\nG90\nM99\n"


def test_what_positioning_takes_at_a_low_override_is_no_slow_cut(slow):
    c = slow.client
    full = held(slow, "one", HOLES)
    assert c.ask("override", arg=0.1).code == 0
    n = len(c.statuses)
    assert c.ask("start").code == 0
    all_s = c.job_where("one", "done", timeout=60)["job_s"]
    assert all_s > 1.5 * full.eta_s
    late = [t for t in c.statuses[n:]
            if t.job == "one" and all_s * 0.3 < t.job_s < all_s * 0.9]
    assert late
    for t in late:
        assert t.eta_s == pytest.approx(all_s - t.job_s, rel=0.25)
    held(slow, "two")
    db = sqlite3.connect(next(slow.store.glob("*.db")))
    (name, passed, expected), = db.execute(
        "SELECT condition, passed_s, expected_s FROM learnt")
    assert name == "C110"
    assert passed / expected == pytest.approx(2, rel=0.2)


def test_a_service_that_comes_back_knows_it_again(slow):
    c = slow.client
    held(slow, "one")
    assert c.ask("start").code == 0
    c.status_where(lambda s: s.eta_by == "cut" and s.progress > 0.3,
                   timeout=60)
    assert c.ask("hold").code == 0
    before = c.status_where(lambda s: s.job_state == "held")
    slow.end("jobs")
    slow.start_jobs("--store", str(slow.store))
    after = c.status_where(lambda s: s.eta_s >= 0, timeout=30)
    assert after.eta_by == "cut"
    assert after.eta_s == pytest.approx(before.eta_s, rel=0.15)


def test_a_store_of_before_has_the_table(slow):
    """The step that makes it is taken once."""
    db = sqlite3.connect(next(slow.store.glob("*.db")))
    assert db.execute("SELECT count(*) FROM learnt").fetchone() == (0,)


def test_jobs_that_wait_have_a_time_and_so_has_the_queue(slow):
    c = slow.client
    s = held(slow, "one")
    assert c.submit(SINK, "two", hold=True).code == 0
    assert c.submit(SINK.replace(b"Z-0.8", b"Z-0.4"), "three").code == 0
    told = c.status_where(lambda s: s.queue_s > 0 and s.queue_untold == 0,
                          timeout=60)
    rows = {j["job"]: j for j in json.loads(c.ask("queue").body)}
    takes = {k: rows[k]["forecast_s"] for k in rows}
    assert takes["one"] == pytest.approx(s.eta_s, rel=0.01)
    assert takes["two"] == pytest.approx(s.eta_s, rel=0.01)
    assert 0.3 < takes["three"] / takes["two"] < 0.7
    assert told.queue_s == pytest.approx(takes["two"] + takes["three"],
                                         abs=0.01)
    p = slow.ctl("queue")
    assert p.stdout.splitlines()[-1].startswith("all of it takes ")
    assert "; if nothing is held, it ends " in p.stdout
    assert c.ask("remove", job="two").code == 0
    left = c.status_where(lambda s: s.queue_len == 1)
    assert left.queue_s == pytest.approx(takes["three"], abs=0.01)


def test_what_cannot_be_forecast_says_why(slow):
    c = slow.client
    held(slow, "one")
    text = b"G21 G90\nG80 Z-\nG92 Z0\nM30\n"
    assert c.submit(text, "felt", hold=True).code == 0
    told = rig.until(lambda: [e for e in c.hear(0.05) or c.events
                              if e.kind == "forecast" and e.job == "felt"])
    assert "cannot be told: " in told[0].text
    assert c.status_where(lambda s: s.queue_untold == 1).queue_s == 0


# 10^5 s of machine time, in one dwell; and a cut that never gets on.
LONG = b"G21 G90\nG4 P900000\nM30\n"


def test_a_job_that_takes_long_keeps_no_other_from_its_forecast(slow):
    c = slow.client
    for job in ("machine", "waits"):
        assert c.submit(LONG, job, hold=True).code == 0
    c.status_where(lambda s: s.job == "machine", timeout=30)
    for job in ("one", "two"):
        assert c.submit(SINK, job, hold=True).code == 0

    def rows():
        return {j["job"]: j for j in json.loads(c.ask("queue").body)}
    told = rig.until(lambda: all((rows()[k].get("forecast_s") or -1) > 0
                                 for k in ("one", "two")) and rows(), 90, 0.2)
    # The others are not given up, only put off.
    assert (told["waits"].get("forecast_s") or -2) == -2
    assert told["waits"]["forecast_why"] == ""
    assert slow.ctl("queue").returncode == 0
    # One that comes while a long one is looked at goes in front of it, too.
    assert c.submit(SINK, "three", hold=True).code == 0
    rig.until(lambda: (rows()["three"].get("forecast_s") or -1) > 0, 90, 0.2)


def test_a_job_that_was_put_off_has_its_forecast_from_the_next_service(slow):
    c = slow.client
    held(slow, "machine")
    assert c.submit(SINK, "waits", hold=True).code == 0

    def row():
        return {j["job"]: j for j in json.loads(c.ask("queue").body)}["waits"]
    rig.until(lambda: (row().get("forecast_s") or -1) > 0, 90, 0.2)
    # As it stands where the service ends before it comes to it again.
    slow.end("jobs")
    with sqlite3.connect(slow.store / f"{slow.name}.db") as db:
        db.execute("UPDATE job SET forecast_s=-2 WHERE id='waits'")
    db.close()
    slow.start_jobs("--store", str(slow.store))
    c.status_where(lambda s: s.daemon == "ok", timeout=30)
    rig.until(lambda: (row().get("forecast_s") or -1) > 0, 90, 0.2)


def test_a_job_that_does_not_get_on_is_told_where(tmp_path):
    text = (ROOT / "examples/machine.ini").read_text()
    with rig.Machine(tmp_path) as m:
        for key, value in (("name", m.name), ("removal_mm3_min", "0.001"),
                           ("area_mm2", "1000000"),
                           ("perimeter_mm", "0")):
            text = re.sub(rf"(?m)^{key} *=[^;\n]*", f"{key} = {value} ", text)
        m.config.write_text(text)
        m.start_edmd()
        m.start_jobs("--store", str(m.store))
        m.client.status_where(lambda s: s.daemon == "ok")
        cut = SINK.replace(b"C110\n", b"")
        assert m.client.submit(b"G0 X1\nM30\n", "short", hold=True).code == 0
        m.client.status_where(lambda s: s.job == "short", timeout=30)
        assert m.client.submit(cut, "stuck", hold=True).code == 0

        def row():
            return {j["job"]: j for j in json.loads(
                m.client.ask("queue").body)}["stuck"]
        rig.until(lambda: row().get("forecast_s") == -1, 90, 0.2)
        assert "does not get on behind" in row()["forecast_why"]
        assert "line 6" in row()["forecast_why"]
        out = m.ctl("queue").stdout
        assert "no forecast: it does not get on behind" in out, out
        # One that ends by time has an end, however long that is.
        cut = cut.replace(b"G1 Z-0.8", b"G86 Z-0.8 S4000")
        assert m.client.submit(cut, "timed", hold=True).code == 0
        rig.until(lambda: json.loads(m.client.ask("queue").body)[-1].get(
            "forecast_s"), 90, 0.2)
        s = json.loads(m.client.ask("queue").body)[-1]
        assert s["job"] == "timed" and 4000 < s["forecast_s"] < 4600, s
