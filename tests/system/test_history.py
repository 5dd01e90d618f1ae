# SPDX-License-Identifier: Apache-2.0
"""What the history tells of a job: conditions, faults, energy, trail."""

import csv
import datetime
import io
import json
import subprocess
from xml.etree import ElementTree

import pytest
import rig
from test_power import die
from test_tech import JOB, MACHINE, TABLE, running

SUMS = ("job_s", "erode_s", "jumps", "retracts", "shorts", "arcs")


@pytest.fixture
def shop(tmp_path):
    with rig.Machine(tmp_path, MACHINE) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        yield m


def conditions_add_up(job):
    for key in SUMS:
        total = sum(c[key] for c in job["conditions"])
        assert total == pytest.approx(job[key], abs=1e-6), key


def trail(c, job):
    a = c.ask("trail", job)
    assert a.code == 0, a.reason
    return json.loads(a.body)


def test_conditions_have_their_times_and_add_up(shop):
    c = running(shop)
    job = c.job_where("job", "done")
    by = {x["condition"]: x for x in job["conditions"]}
    assert set(by) - {""} == {"C120", "C100"}
    # Each cuts 2 mm at 1 mm/s; a look every 20 ms may come late.
    assert by["C120"]["job_s"] > 0.5 and by["C100"]["job_s"] > 0.5
    conditions_add_up(job)
    # The power was never on.
    assert job["energy_j"] == 0
    assert job["faults"] == []
    assert job["first_us"] == job["begun_us"] > job["submitted_us"]
    listed = json.loads(c.ask("history").body)
    assert listed[0]["conditions"] == job["conditions"]


def test_a_fault_has_its_place_and_line(shop):
    c = running(shop)
    assert c.ask("estop").code == 0
    job = c.job_where("job", "fault")
    assert [f["fault"] for f in job["faults"]] == ["e-stop"]
    assert job["faults"][0]["line"] == 2
    assert job["faults"][0]["place_mm"] == pytest.approx(job["path_mm"])
    assert c.ask("reset").code == 0 and c.ask("start").code == 0
    job = c.job_where("job", "done")
    assert len(job["faults"]) == 1
    conditions_add_up(job)


def test_the_sums_of_a_resumed_job_are_those_of_all_its_parts(shop):
    c = running(shop)
    last = c.status_where(lambda s: s.place_mm > 2.3)
    first = c.job("job")["first_us"]
    die(shop)
    shop.start()
    c.status_where(lambda s: s.interrupted == "job", 10)
    assert c.ask("resume", "job", text="XYZABCUV").code == 0
    c.job_where("job", "ready")
    assert c.ask("start").code == 0
    job = c.job_where("job", "done", 60)
    conditions_add_up(job)
    assert job["job_s"] > last.job_s
    assert job["first_us"] == first < job["begun_us"]
    points = trail(c, "job")["points_um"]
    places = [p[3] for p in points]
    assert places == sorted(places) and places[-1] == 4000
    # From the beginning, not only from where it went on.
    assert places[0] < 2000


def test_an_interrupted_job_that_is_removed_keeps_what_it_cut(shop):
    c = running(shop)
    die(shop)
    shop.start()
    c.status_where(lambda s: s.interrupted == "job", 10)
    before = c.job("job")
    assert before["job_s"] > 0
    assert c.ask("remove", "job").code == 0
    after = c.job("job")
    assert after["state"] == "stopped" and "removed" in after["reason"]
    assert after["job_s"] == before["job_s"]
    assert after["path_mm"] == before["path_mm"]


def test_a_service_that_was_away_loses_no_sum(shop):
    c = running(shop)
    shop.kill("jobs")
    shop.start_jobs()
    job = c.job_where("job", "done", 20)
    conditions_add_up(job)
    assert {x["condition"] for x in job["conditions"]} - {""} <= {
        "C120", "C100"}


def test_the_trail_is_the_path_that_was_gone(shop):
    c = running(shop, b"G21 G90\nG1 X1 F120\nY1\nX0\nY0\nM30\n")
    c.job_where("job", "done")
    points = trail(c, "job")["points_um"]
    assert points[0][:4] == [0, 0, 0, 0]
    assert points[-1][:4] == [0, 0, 0, 4000]
    assert max(p[0] for p in points) == pytest.approx(1000, abs=100)
    assert max(p[1] for p in points) == pytest.approx(1000, abs=100)
    assert trail(c, "job")["retracts_um"] == []


# -- As a table and as a picture

EVIL = ['=cmd|"/c calc"!A1', "+1", "@SUM(A1)", "-2", 'a, "b"; c', "schön 漢字",
        "\uff1dfull", " =1", "plain.ngc"]


def table(machine, *args):
    p = machine.ctl("history", "--csv", *args)
    assert p.returncode == 0, p.stderr
    # newline="" leaves the ends of lines as they are.
    rows = list(csv.reader(io.StringIO(p.stdout, newline="")))
    assert all(len(r) == len(rows[0]) for r in rows)
    return [dict(zip(rows[0], r)) for r in rows[1:]]


def test_names_of_others_are_text_in_the_table(shop):
    c = shop.client
    for i, name in enumerate(EVIL):
        assert c.submit(JOB, f"e{i}", name=name, hold=True).code == 0
        c.job_where(f"e{i}", "ready")
        assert c.ask("remove", f"e{i}").code == 0
    rows = {r["job"]: r for r in table(shop)}
    assert len(rows) == len(EVIL)
    for i, name in enumerate(EVIL):
        got = rows[f"e{i}"]["name"]
        assert not got.startswith(("=", "+", "-", "@", "\t", "\r", "\uff1d"))
        wanted = name.replace("\n", "?").replace("\r", "?")
        assert got in (wanted, "'" + wanted)
    raw = subprocess.run(
        [str(rig.BUILD / "edmctl"), "--machine", shop.name, "history",
         "--csv"], capture_output=True, timeout=60).stdout
    assert raw.count(b"\r\n") == raw.count(b"\n") == len(EVIL) + 1
    # It never began: no time is told, and no energy.
    assert rows["e0"]["begun"] == "" and rows["e0"]["energy_j"] in ("", "0.000")


def test_the_table_has_what_the_json_has(shop):
    c = running(shop)
    assert c.ask("estop").code == 0
    c.job_where("job", "fault")
    assert c.ask("reset").code == 0 and c.ask("start").code == 0
    job = c.job_where("job", "done")
    row, = table(shop)
    assert row == table(shop, "job")[0]
    assert float(row["job_s"]) == pytest.approx(job["job_s"], abs=1e-3)
    assert row["conditions"].split(";")[-1].startswith("C100=")
    assert row["faults"].startswith("e-stop@") and row["faults"].endswith("/2")
    assert row["begun"] == datetime.datetime.fromtimestamp(
        job["first_us"] // 1000 / 1000, datetime.timezone.utc
    ).strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z"
    listed, = json.loads(shop.ctl("--json", "history").stdout)
    assert listed["faults"] == job["faults"]
    shown = shop.ctl("history", "job").stdout
    assert "e-stop" in shown and "C120" in shown


def test_a_picture_of_the_way_with_its_faults(shop):
    text = b"G21 G90\nG1 X1 F120\nY1\nX0\nY0\nM30\n"
    c = shop.client
    assert c.submit(text, "job", name='<b>"&').code == 0
    c.status_where(lambda s: s.job == "job" and s.place_mm > 0.5)
    assert c.ask("estop").code == 0
    c.job_where("job", "fault")
    assert c.ask("reset").code == 0 and c.ask("start").code == 0
    c.job_where("job", "done")
    file = shop.folder / "job.svg"
    p = shop.ctl("history", "job", "--picture", str(file))
    assert p.returncode == 0, p.stderr
    root = ElementTree.parse(file).getroot()
    svg = "{http://www.w3.org/2000/svg}"
    assert root.tag == svg + "svg"
    assert '<b>"&' in [t.text for t in root.iter(svg + "text")]
    way = [p.get("points").split() for p in root.iter(svg + "polyline")]
    assert sum(len(p) for p in way) > 10
    assert any("e-stop, line" in (t.text or "") for t in root.iter(
        svg + "title"))
    assert list(shop.folder.glob("*.part")) == []


def test_what_the_history_cannot_draw_is_refused(shop):
    c = shop.client
    assert c.submit(JOB, "never", hold=True).code == 0
    c.job_where("never", "ready")
    assert c.ask("remove", "never").code == 0
    file = shop.folder / "no.svg"
    for args, code in (
            (("history", "never", "--picture", str(file)), 66),
            (("history", "nosuch", "--picture", str(file)), 66),
            (("history", "--picture", str(file)), 64),
            (("history", "never", "--picture", "a.png"), 64),
            (("--json", "history", "--csv"), 64),
            (("history", "never", "--picture", "/nowhere/a.svg"), 66)):
        p = shop.ctl(*args)
        assert p.returncode == code and p.stderr, args
    assert not file.exists()
