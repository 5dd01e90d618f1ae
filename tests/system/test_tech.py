# SPDX-License-Identifier: Apache-2.0
"""Technology: tables, values set while a job runs, and their history."""

import hashlib
import json
import math
from pathlib import Path

import pytest
import rig
from rig import SLOW_JOB

ROOT = Path(__file__).resolve().parents[2]

TABLE = """
condition, servo_v [V], on_us [us]
C100, 20, 8
C120, 15, 40
"""

# Two conditions, 2 s each at 60 mm/min.
JOB = b"G21 G90\nC120 G1 X2 F60\nC100\nX4\nM30\n"

MACHINE = rig.NULL_MACHINE + "\n[tech]\ntable = shop.tech\n"


@pytest.fixture
def shop(tmp_path):
    """A machine with a table."""
    with rig.Machine(tmp_path, MACHINE) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        yield m


def running(machine, text=JOB, job="job"):
    c = machine.client
    assert c.submit(text, job).code == 0
    c.status_where(lambda s: s.job == job and s.place_mm > 0.3)
    return c


def changes(c, job="job"):
    return [(x["what"], x["was"], x["now"]) for x in c.job(job)["changes"]]


def test_status_tells_the_condition_in_force(shop):
    c = running(shop)
    assert c.status().condition == "C120"
    c.status_where(lambda s: s.condition == "C100" and s.place_mm > 2)


def test_a_set_and_its_taking_back_are_in_the_jobs_history(shop):
    c = running(shop)
    assert shop.ctl("set", "servo_v", "17").returncode == 0
    assert shop.ctl("set", "on_us", "50").returncode == 0
    assert shop.ctl("set", "servo_v", "default").returncode == 0
    c.job_where("job", "done")
    assert changes(c) == [
        ("condition", None, "C120"),
        ("servo_v", 15, 17),
        ("on_us", 40, 50),
        ("servo_v", 17, 15),
        ("condition", "C120", "C100"),
    ]
    places = [x["place_mm"] for x in c.job("job")["changes"]]
    assert places == sorted(places)
    assert places[-1] == pytest.approx(2, abs=0.01)
    shown = shop.ctl("show", "job").stdout
    assert "servo_v 15 -> 17" in shown
    assert "condition C120 -> C100" in shown


def test_a_set_belongs_to_its_condition(shop):
    c = running(shop)
    assert shop.ctl("set", "servo_v", "17").returncode == 0
    c.status_where(lambda s: s.condition == "C100")
    assert shop.ctl("set", "servo_v", "25").returncode == 0
    assert ("servo_v", 20, 25) in changes(c)


def test_a_set_out_of_range_is_refused_with_the_range(shop):
    c = running(shop)
    for key, value, words in (
        ("servo_v", "2000", "from 0.1 to 500 V"),
        ("polarity", "0", "1 or -1"),
        ("jump_mm", "450", "at most 400 mm, the travel of axis.X"),
        ("servo_v", "5", "<= servo_v <="),
        ("servo_x", "20", "did you mean servo_v"),
        ("roughness_um", "2", "no such field"),
    ):
        p = shop.ctl("set", key, value)
        assert p.returncode == 65, (key, value)
        assert words in p.stderr, p.stderr
    assert shop.ctl("set", "servo_v", "much").returncode == 64
    assert shop.ctl("set", "servo_v").returncode == 64
    assert changes(c) == [("condition", None, "C120")]


def test_a_job_without_a_condition_has_none_of_the_one_before(shop):
    c = shop.client
    for name, condition in ("a", b"C120 "), ("b", b""):
        text = b"G21 G90\n" + condition + b"G1 X0.5 F600\nX0\nM30\n"
        assert c.submit(text, name).code == 0
        c.job_where(name, "done")
    assert changes(c, "a") == [("condition", None, "C120")]
    assert changes(c, "b") == []


def test_a_value_below_0_is_a_value_and_no_option(shop):
    c = running(shop)
    assert shop.ctl("set", "polarity", "-1").returncode == 0
    assert ("polarity", 1, -1) in changes(c)
    p = shop.ctl("set", "servo_v", "-.5")
    assert p.returncode == 65
    assert "from 0.1 to 500 V" in p.stderr


def test_nothing_is_set_without_a_job(shop):
    p = shop.ctl("set", "servo_v", "20")
    assert p.returncode == 1
    assert "no job" in p.stderr


def test_not_a_number_takes_a_set_back_only(shop):
    c = running(shop)
    a = c.ask("set", arg=math.nan)
    assert a.code == 65
    assert "no such field" in a.reason


def test_a_refusal_is_whole_when_it_is_repeated_to_another_service(shop):
    c = running(shop)
    a = c.ask("set", text="servo_x", arg=20)
    assert a.reason.endswith("jump_short_of_mm")
    shop.kill("jobs")
    shop.start_jobs()
    c.acks.clear()
    c.status_where(lambda s: s.daemon == "ok")

    def repeated():
        c.send_command("set", "", 20, a.seq, "servo_x")
        return [x for x in c.acks_to(a.seq) if x.code != 100]

    (again, *_) = c.heard(repeated, 10)
    assert again.reason == a.reason


def test_a_condition_that_is_not_in_the_table_is_refused(shop):
    a = shop.client.submit(b"G21 G90\nC121 G1 X1 F60\nM30\n", "job")
    assert a.code == 65
    assert "job.ngc:2:1: error: C121" in a.reason
    assert "C100, C120" in a.reason


def test_the_next_job_goes_by_the_table_as_it_is_then(shop):
    c = shop.client
    table = shop.folder / "shop.tech"

    def job(name):
        assert c.submit(b"G21 G90\nC100 G1 X0.1 F600\nM30\n", name).code == 0
        return c.job_where(name, "done")["tech_sha256"]

    assert job("one") == hashlib.sha256(TABLE.encode()).hexdigest()
    other = TABLE.replace("20, 8", "21, 8")
    table.write_text(other)
    assert job("two") == hashlib.sha256(other.encode()).hexdigest()
    table.write_text(TABLE.replace("20, 8", "20"))
    a = c.submit(b"G21 G90\nC100 G1 X0.1 F600\nM30\n", "three")
    assert a.code == 78
    assert "shop.tech:3:9: error: " in a.reason
    table.unlink()
    assert "No such file" in c.submit(SLOW_JOB, "four").reason


def test_history_is_kept_once_when_the_service_is_restarted(shop):
    c = running(shop)
    assert shop.ctl("set", "servo_v", "17").returncode == 0
    shop.kill("jobs")
    shop.start_jobs()
    c.job_where("job", "done")
    assert changes(c) == [
        ("condition", None, "C120"),
        ("servo_v", 15, 17),
        ("condition", "C120", "C100"),
    ]


def test_edmd_comes_back_in_the_condition_of_its_place(shop):
    c = running(shop)
    assert shop.ctl("set", "servo_v", "17").returncode == 0
    c.status_where(lambda s: s.condition == "C100" and s.place_mm > 2.3)
    s = shop.come_back(lambda s: s.state == "hold")
    assert s.condition == "C100"
    assert shop.ctl("set", "servo_v", "22").returncode == 0
    assert shop.ctl("start").returncode == 0
    c.job_where("job", "done")
    assert ("servo_v", 20, 22) in changes(c)


def test_a_store_of_the_version_before_is_taken_over(idle):
    import sqlite3

    idle.store.mkdir()
    db = sqlite3.connect(idle.store / f"{idle.name}.db")
    db.executescript(
        "CREATE TABLE job(n INTEGER PRIMARY KEY AUTOINCREMENT,"
        " id TEXT NOT NULL UNIQUE, name TEXT NOT NULL, sha256 TEXT NOT NULL,"
        " text BLOB NOT NULL, lines INTEGER NOT NULL,"
        " state TEXT NOT NULL DEFAULT 'queued', hold INTEGER NOT NULL,"
        " loaded INTEGER NOT NULL DEFAULT 0, submitted_us INTEGER NOT NULL,"
        " begun_us INTEGER NOT NULL DEFAULT 0,"
        " ended_us INTEGER NOT NULL DEFAULT 0,"
        " reason TEXT NOT NULL DEFAULT '', place_mm REAL, length_mm REAL,"
        " depth_mm REAL, job_s REAL, jumps INTEGER, retracts INTEGER,"
        " shorts INTEGER);"
        "INSERT INTO job(id, name, sha256, text, lines, state, hold,"
        " submitted_us) VALUES('old', 'old', '', '', 1, 'done', 0, 1);"
        "PRAGMA user_version=1;"
    )
    db.close()
    idle.start()
    old = idle.client.job("old")
    assert (old["state"], old["tech_sha256"], old["changes"]) == (
        "done", "", [])


def test_a_submit_is_refused_for_what_does_not_reach_the_generator(tmp_path):
    """By the service alone: there are no lines here for an edmd."""
    gpio = (ROOT / "examples/machine-gpio.ini").read_text()
    text = gpio.replace("name = edm", "name = {name}")
    with rig.Machine(tmp_path, text + "\n[jobs]\nstore = {store}\n"
                     "[tech]\ntable = shop.tech\n") as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start_jobs()
        a = m.client.submit(JOB, "job")
        assert a.code != 0
        assert "shop.tech:3:1: error: C100: on_us 8 us does not reach the " \
            "generator" in a.reason
        assert "[generator] by_hand = on_us" in a.reason


# -- Edited and saved on the host


def versions(m):
    return json.loads(m.ctl("--json", "tech", "versions").stdout)


def test_a_value_is_saved_and_a_version_comes_back(shop, tmp_path):
    file = tmp_path / "shop.tech"
    assert versions(shop) == []
    p = shop.ctl("tech", "set", "C120.servo_v=30", "C100.on_us=-")
    assert p.returncode == 0 and "saved" in p.stdout, p.stderr
    assert "30" in file.read_text() and file.read_text() != TABLE
    v = versions(shop)
    assert [x["n"] for x in v] == [2, 1]
    assert v[0]["what"].split() == ["C120.servo_v=30", "C100.on_us=-"]
    assert v[0]["by"] and v[1]["what"] == "as it was found"
    assert shop.ctl("tech", "show", "1").stdout == TABLE
    # The next job has it.
    c = running(shop)
    assert json.loads(c.ask("values").body)["values"]["servo_v"] == 30
    c.ask("stop")
    c.status_where(lambda s: not s.job)
    assert shop.ctl("tech", "back", "1").returncode == 0
    assert file.read_text() == TABLE
    assert versions(shop)[0]["what"] == "version 1 again"
    # Saved as it is: no new version.
    assert shop.ctl("tech", "save", str(file)).returncode == 0
    assert len(versions(shop)) == 3
    assert [f.name for f in tmp_path.glob("shop.tech*")] == ["shop.tech"]


@pytest.mark.parametrize("words, says", [
    (("set", "C120.servo_v=9000"), "line 1: 'C120.servo_v=9000'"),
    (("set", "C120.servo_v=30", "C120.on_us=x"), "line 2: 'C120.on_us=x'"),
    (("set", "C999.servo_v=30"), "of a condition of the table"),
    (("set", "C120.nothing=30"), "a field of"), (("set", "C120"), "line 1"),
    (("set", "C120.servo_v="), "line 1"), (("set", "C120.servo_v=nan"), "line 1"),
    (("set", "C120.servo_v=30x"), "line 1"),
    # Each value is fine, and together they are upside down.
    (("set", "C120.window_high_v=12", "C120.window_low_v=11",
      "C120.servo_v=30"), "C120"),
    (("back", "7"), "versions has them"), (("back", "0"), "versions has them"),
    (("back", "1.5"), "versions has them"), (("show", "-1"), "versions has"),
])
def test_what_is_bad_is_refused_and_nothing_is_lost(shop, tmp_path, words, says):
    p = shop.ctl("tech", *words)
    assert p.returncode in (65, 66) and says in p.stderr, p.stderr
    assert (tmp_path / "shop.tech").read_text() == TABLE
    assert versions(shop) == []
    assert [f.name for f in tmp_path.glob("shop.tech*")] == ["shop.tech"]


def test_a_whole_table_that_is_bad_is_refused_with_its_line(shop, tmp_path):
    bad = tmp_path / "bad.txt"
    bad.write_text(TABLE + "C130, 9000, 8\n")
    p = shop.ctl("tech", "save", str(bad))
    assert p.returncode == 65 and "5:" in p.stderr and "servo_v" in p.stderr
    assert (tmp_path / "shop.tech").read_text() == TABLE
    bad.write_text(TABLE + "C130, 25, 8\n")
    assert shop.ctl("tech", "save", str(bad)).returncode == 0
    assert (tmp_path / "shop.tech").read_text() == TABLE + "C130, 25, 8\n"
    # A table that was spoiled by hand is put right by a version, and kept.
    (tmp_path / "shop.tech").write_text("nonsense")
    assert shop.ctl("tech", "set", "C120.servo_v=30").returncode == 65
    assert shop.ctl("tech", "back", "1").returncode == 0
    assert (tmp_path / "shop.tech").read_text() == TABLE
    assert shop.ctl("tech", "show", "3").stdout == "nonsense"


def test_who_could_read_the_table_can_read_it_then(shop, tmp_path):
    file, real = tmp_path / "shop.tech", tmp_path / "of the shop.tech"
    file.rename(real)
    file.symlink_to(real.name)
    real.chmod(0o664)
    assert shop.ctl("tech", "set", "C120.servo_v=30").returncode == 0
    assert file.is_symlink() and "30" in real.read_text()
    assert real.stat().st_mode & 0o7777 == 0o664
    assert sorted(f.name for f in tmp_path.glob("*tech*")) == [
        real.name, file.name]


def test_a_version_is_shown_whatever_it_has_in_it(shop, tmp_path):
    """More than a message takes, and comments of an old editor."""
    rows = "".join(f"C{1000 + i}, 20, {8 + i / 1000}\n" for i in range(4000))
    was = b"# caf\xe9, 20 \xb5m\n" + (TABLE + rows).encode()
    assert len(was) > 65536
    (tmp_path / "shop.tech").write_bytes(was)
    p = shop.ctl("tech", "set", "C120.servo_v=30", "C100.on_us=9")
    assert p.returncode == 0, p.stderr
    # What is not UTF-8 is a ? on a terminal, and comes back as it was.
    p = shop.ctl("tech", "show", "1")
    assert p.returncode == 0, p.stderr
    assert p.stdout == was.decode("ascii", "replace").replace("\ufffd", "?")
    assert shop.ctl("tech", "back", "1").returncode == 0
    assert (tmp_path / "shop.tech").read_bytes() == was
    assert versions(shop)[1]["what"] == "C120.servo_v=30 C100.on_us=9"


def test_without_a_table_there_is_nothing_to_save(machine):
    p = machine.ctl("tech", "set", "C120.servo_v=30")
    assert p.returncode == 1 and "names no table" in p.stderr
    assert machine.ctl("tech", "versions").stdout == "none was saved yet\n"
    assert machine.ctl("tech", "back").returncode == 64
