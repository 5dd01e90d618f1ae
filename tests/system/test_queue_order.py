# SPDX-License-Identifier: Apache-2.0
"""The order of the queue, and lines of a job's text."""

import json

import rig


def names(machine):
    return [j["job"] for j in json.loads(machine.client.ask("queue").body)]


def test_a_job_that_waits_is_moved_and_stays_there(machine):
    c = machine.client
    for job in ("a", "b", "c", "d"):
        assert c.submit(rig.QUICK_JOB, job, hold=True).code == 0
    c.status_where(lambda s: s.job == "a" and s.job_state == "ready")
    assert machine.ctl("move", "d", "-1").returncode == 0
    assert machine.ctl("move", "d", "-1").returncode == 0
    assert names(machine) == ["a", "d", "b", "c"]
    # The first that waits cannot pass the one that is loaded.
    r = machine.ctl("move", "d", "-1")
    assert r.returncode == 1 and "the first that waits" in r.stderr
    assert machine.ctl("move", "b", "+1").returncode == 0
    assert names(machine) == ["a", "d", "c", "b"]
    machine.kill("jobs")
    machine.start_jobs()
    assert rig.until(lambda: names(machine)) == ["a", "d", "c", "b"]
    # And they are cut in that order.
    for job in ("a", "d", "c", "b"):
        rig.until(lambda: c.ask("start").code == 0)
        c.job_where(job, "done")


def test_what_cannot_be_moved_is_refused_in_words(machine):
    c = machine.client
    assert c.submit(rig.QUICK_JOB, "a", hold=True).code == 0
    c.status_where(lambda s: s.job_state == "ready")
    assert c.ask("move", "a", -1).code == 1
    assert c.ask("move", "none", -1).code == 66
    assert c.ask("move", "a", 3).code == 65
    assert c.ask("move", "a", float("nan")).code == 65


def test_lines_of_a_job_are_told(machine):
    c = machine.client
    text = b"(\xe7\x94\xb5 \xff\x07 \x1b[2J)\r\nG21 G90 F600\n" + b"".join(
        b"G1 X%d.5\n" % (i % 9) for i in range(500)) + b"M30"
    assert c.submit(text, "a", hold=True).code == 0
    got = json.loads(c.ask("text", "a", 1).body)
    lines = got["text"].split("\n")
    assert got["first"] == 1 and len(lines) == 201
    assert lines[0] == "(\u7535 ?? ?[2J)" and lines[1] == "G21 G90 F600"
    got = json.loads(c.ask("text", "a", 503).body)
    assert got == {"first": 503, "text": "M30\n"}
    for line in (0, -1, 504, 1e30, float("nan")):
        assert c.ask("text", "a", line).code == 66, line
    assert c.ask("text", "none", 1).code == 66


def test_a_queue_longer_than_an_answer_is_listed_whole(machine):
    c = machine.client
    for job in ("a", "b"):
        # A name that looks like the end of a page.
        assert c.submit(rig.QUICK_JOB, job, name='","job":"a',
                        hold=True).code == 0
    c.status_where(lambda s: s.job == "a" and s.job_state == "ready")
    rig.fill_queue(machine, "b", 500)
    wanted = ["a", "b"] + [f"job-{i:03}" for i in range(500)]
    assert rig.until(lambda: names(machine)) == wanted[:len(names(machine))]
    assert len(names(machine)) < len(wanted)
    r = machine.ctl("queue", "--json")
    assert [j["job"] for j in json.loads(r.stdout)] == wanted
    assert len(machine.ctl("queue").stdout.splitlines()) == 2 + len(wanted)
    # From behind any job; a job that never was is refused.
    after = json.loads(c.ask("queue", wanted[290]).body)
    assert [j["job"] for j in after] == wanted[291:]
    assert c.ask("queue", "never").code == 66
    with rig.store_of(machine) as db:
        db.execute("DELETE FROM job WHERE id LIKE 'job-%'")


def test_a_page_that_is_refused_ends_the_list_with_the_reason(machine):
    c = machine.client
    assert c.submit(rig.QUICK_JOB, "a", hold=True).code == 0
    assert c.submit(rig.QUICK_JOB, "b", hold=True).code == 0
    # It is listed as b?, which is no job: nobody knows what follows it.
    with rig.store_of(machine) as db:
        db.execute("UPDATE job SET id='b' || char(1) WHERE id='b'")
    c.status_where(lambda s: s.daemon == "ok")
    r = machine.ctl("queue")
    assert r.returncode == 66
    assert r.stderr.count("no such job") == 1 and len(r.stderr.split("\n")) == 2
