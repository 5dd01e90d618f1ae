# SPDX-License-Identifier: Apache-2.0
"""Axes moved by hand: jog, home, step; alarms and doctor."""

import json
import signal
import subprocess
import time

import pytest
import rig


def idle_at(m, axis, mm, eps=2e-3):
    return m.client.status_where(
        lambda s: s.state == "idle" and abs(s.pos_mm[axis] - mm) <= eps
    )


def test_a_jog_moves_one_axis_and_a_job_begins_there(machine):
    assert machine.ctl("jog", "Y", "-1.5").returncode == 0
    s = idle_at(machine, 1, -1.5)
    assert s.pos_mm[0] == 0
    assert machine.client.submit(rig.QUICK_JOB, "job").code == 0
    machine.client.job_where("job", "done")
    idle_at(machine, 1, -1.5)


@pytest.mark.parametrize(
    "args, code, text",
    [
        (("X", "300"), 1, "travel"),
        (("Q", "1"), 65, "one of XYZABCUV"),
        (("XY", "1"), 65, "one of XYZABCUV"),
        (("X", "0"), 65, "+ or -"),
        (("X", "far"), 64, "no number"),
    ],
)
def test_a_jog_that_cannot_be_is_refused_in_words(machine, args, code, text):
    r = machine.ctl("jog", *args)
    assert r.returncode == code
    assert text in r.stderr
    assert machine.client.status().pos_mm[0] == 0


def test_nothing_jogs_with_a_job_loaded(machine):
    assert machine.client.submit(rig.SLOW_JOB, "job").code == 0
    machine.client.status_where(lambda s: s.place_mm > 0.1)
    r = machine.ctl("jog", "X", "1")
    assert r.returncode == 1
    assert "idle" in r.stderr


def test_an_axis_without_a_method_is_not_homed(machine):
    r = machine.ctl("home")
    assert r.returncode == 1
    assert "home_method" in r.stderr


def test_steps_and_override(machine):
    text = b"G21 G90 F600\nG1 X1\nG1 X2\nG1 X3\nM0\nG1 X4\nM30\n"
    c = machine.client
    assert c.submit(text, "job").code == 0
    c.status_where(lambda s: s.state == "hold" and abs(s.pos_mm[0] - 3) < 1e-3)
    assert machine.ctl("step", "-2").returncode == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 1) < 1e-3 and not s.feed_mm_s)
    assert machine.ctl("step", "+1").returncode == 0
    c.status_where(lambda s: abs(s.pos_mm[0] - 2) < 1e-3 and not s.feed_mm_s)
    r = machine.ctl("step", "-50")
    assert r.returncode == 1
    assert "nodes" in r.stderr
    assert machine.ctl("override", "50").returncode == 0
    r = machine.ctl("override", "201")
    assert r.returncode == 65
    assert "0 to 200" in r.stderr
    assert machine.ctl("start").returncode == 0
    c.job_where("job", "done")


def test_a_job_waits_for_homing_and_then_for_a_start(homing):
    homing.start()
    c = homing.client
    text = b"G21 G90 F600\nG0 Z19\nG0 X-19\nM30\n"
    assert c.submit(text, "job").code == 0
    c.hear(0.6)
    assert c.status().job == ""
    r = homing.ctl("start")
    assert r.returncode == 1
    assert "home it" in r.stderr
    assert homing.ctl("home").returncode == 0
    c.job_where("job", "ready", timeout=30)
    c.hear(1.5)
    assert c.job("job")["state"] == "ready", "it began by itself"
    assert homing.ctl("start").returncode == 0
    j = c.job_where("job", "done", timeout=30)
    assert j["state"] == "done"
    s = c.status_where(lambda s: s.state == "idle")
    assert s.pos_mm[0] == -19
    assert s.pos_mm[2] == 19


def test_alarms_tell_what_why_and_how(machine):
    r = machine.ctl("alarms")
    assert r.returncode == 0
    assert "fault      none" in r.stdout
    assert machine.ctl("estop").returncode == 0
    machine.client.status_where(lambda s: s.state == "fault")
    r = machine.ctl("alarms")
    assert r.returncode == 1
    for word in ("e-stop", "why", "clear", "edmctl reset", "without a job"):
        assert word in r.stdout
    a = json.loads(machine.ctl("--json", "alarms").stdout)
    assert a["fault"] == "e-stop"
    assert a["alarms"][0]["fault"] == "e-stop"
    assert a["clear"]
    assert machine.ctl("reset").returncode == 0
    machine.client.status_where(lambda s: s.state == "idle")
    assert machine.ctl("alarms").returncode == 0


def test_doctor_finds_the_living_and_mends_the_missing(machine, tmp_path):
    rows = json.loads(machine.ctl("--json", "doctor").stdout)
    by = {r["what"]: r for r in rows}
    assert by["edmd"]["verdict"] == "good"
    assert str(machine.edmd.pid) in by["edmd"]["found"]
    assert by["edmd-jobs"]["verdict"] == "good"
    assert by["shared memory"]["verdict"] == "good"
    # Without a route clients of the host still have a socket.
    assert by["multicast route"]["verdict"] in ("good", "unused")
    for r in rows:
        assert bool(r["mend"]) == (r["verdict"] == "lacking")
    r = machine.ctl("--timeout", "0.3", "--machine", "nobody", "doctor")
    assert r.returncode == 1
    assert "systemctl start edmd-jobs" in r.stdout


def test_a_pitch_map_is_refused_with_its_line(idle):
    (idle.folder / "x.pitch").write_text("0 0\n10 5\n10 6\n")
    text = idle.config.read_text() + "\n[axis.X]\npitch_map = x.pitch\n"
    idle.config.write_text(text)
    r = rig.subprocess.run(
        [str(rig.BUILD / "edmd"), "--config", str(idle.config), "--check"],
        capture_output=True, text=True,
    )
    assert r.returncode == 78
    line = text.splitlines().index("pitch_map = x.pitch") + 1
    assert f":{line}:" in r.stderr
    assert "x.pitch:3" in r.stderr
    assert "rise" in r.stderr


def pressed(machine, *args):
    return subprocess.Popen(
        [str(rig.BUILD / "edmctl"), "--machine", machine.name, "jog-on",
         *args], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL,
                                    signal.SIGSTOP])
def test_a_press_moves_an_axis_until_nothing_is_heard_of_it(machine, number):
    # On a busy host a sign may be late: then it stands, and is pressed again.
    for _ in range(10):
        before = machine.client.status().pos_mm[1]
        p = pressed(machine, "Y", "20")
        try:
            rig.until(lambda: p.poll() is not None or
                      machine.client.status().pos_mm[1] > before + 0.5)
            over = p.poll() is not None
            p.send_signal(number)
            s = machine.client.status_where(lambda s: s.state == "idle")
            if number == signal.SIGINT and not over:
                assert p.wait(timeout=20) == 0
        finally:
            p.kill()
            p.wait()
        if s.pos_mm[1] > before + 0.5:
            break
    assert s.pos_mm[1] > before + 0.5
    assert machine.client.status_where(
        lambda t: t.utime > s.utime + 500000).pos_mm[1] == s.pos_mm[1]


@pytest.mark.parametrize("text, arg, code, words", [
    ("Y", 10, 65, "number"),
    ("Y 0 begin", 10, 65, "number"), ("Q 5 begin", 10, 65, "one of"),
    ("Y 16777216 begin", 10, 65, "number"), ("Y 5 bogus", 10, 65, "begin"),
    ("Y 5 begin", float("nan"), 65, "speed")])
def test_a_sign_that_begins_nothing_moves_nothing(machine, text, arg, code,
                                                  words):
    answer = machine.client.ask("jog-on", text=text, arg=arg)
    assert answer.code == code and words in answer.reason
    assert machine.client.status().state == "idle"


def test_a_sign_that_comes_late_moves_nothing(machine):
    c = machine.client
    c.ask("hello")
    signed = c.count + 1
    time.sleep(0.3)
    seq = c.send_command("jog-on", arg=10, text="Y 8 begin", count=signed)
    answer = c.heard(lambda: c.acks_to(seq))[0]
    assert answer.code == 69 and "late" in answer.reason
    # A sign that begins nothing, of a press that nobody knows.
    assert c.ask("jog-on", text="Y 9", arg=10).code in (1, 69)
    s = c.status_where(lambda s: s.state == "idle")
    assert s.pos_mm[1] == 0


# -- Begun, and how it ended --------------------------------------------------


def begun(m, *words):
    """Start it with --wait, and return the process once it has said begun."""
    p = subprocess.Popen(
        [rig.BUILD / "edmctl", "--machine", m.name, "--timeout", "30", *words,
         "--wait"], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert p.stdout.readline().strip() == f"{words[0]}: begun"
    return p


def ended(p):
    out, err = p.communicate(timeout=60)
    return p.returncode, out.strip(), err


def test_who_moves_an_axis_hears_that_it_has_begun(machine):
    r = machine.ctl("jog", "Y", "-1.5")
    assert r.stdout == "jog: begun\n"
    idle_at(machine, 1, -1.5)


def test_who_waits_hears_that_it_is_done(machine):
    r = machine.ctl("jog", "Y", "-1.5", "--wait")
    assert (r.returncode, r.stdout) == (0, "jog: begun\njog: done\n")
    assert abs(machine.client.status().pos_mm[1] + 1.5) < 2e-3
    r = machine.ctl("--json", "jog", "Y", "1.5", "--wait")
    assert json.loads(r.stdout) == {"verb": "jog", "moved": "there"}


@pytest.mark.parametrize("end", ("hold", "stop"))
def test_who_waits_hears_that_it_was_ended_on_its_way(machine, end):
    p = begun(machine, "jog", "Y", "-150")
    machine.client.status_where(lambda s: s.pos_mm[1] < -0.5)
    assert machine.ctl(end).returncode == 0
    code, out, err = ended(p)
    assert (code, out) == (1, "")
    assert "on its way" in err


def test_who_waits_hears_of_the_fault(machine):
    p = begun(machine, "jog", "Y", "-150")
    machine.client.status_where(lambda s: s.pos_mm[1] < -0.5)
    assert machine.ctl("estop").returncode == 0
    code, out, err = ended(p)
    assert (code, out) == (1, "")
    assert "fault e-stop" in err


def test_who_waits_for_another_motion_is_not_told_of_this_one(machine):
    p = begun(machine, "jog", "Y", "-150")
    machine.client.status_where(lambda s: s.pos_mm[1] < -0.5)
    p.send_signal(signal.SIGSTOP)
    assert machine.ctl("hold").returncode == 0
    machine.client.status_where(lambda s: s.state == "idle")
    assert machine.ctl("jog", "X", "0.1", "--wait").returncode == 0
    p.send_signal(signal.SIGCONT)
    code, out, err = ended(p)
    assert (code, out) == (69, "")
    assert "not known" in err


def test_who_stops_waiting_stops_nothing(machine):
    p = begun(machine, "jog", "Y", "-150")
    p.send_signal(signal.SIGINT)
    code, _, err = ended(p)
    assert code == 75, err
    assert "goes on" in err
    assert machine.client.status().state == "jog"


def test_ways_along_the_path_and_jobs_are_waited_for(machine):
    text = b"G21 G90 F600\nG1 X1\nG1 X2\nG1 X3\nM0\nG1 X4\nM30\n"
    c = machine.client
    assert c.submit(text, "job").code == 0
    c.status_where(lambda s: s.state == "hold" and abs(s.pos_mm[0] - 3) < 1e-3)
    for words, at in ((("step", "-2"), 1), (("step", "+1"), 2),
                      (("retract", "0.5"), 1.5), (("retract", "50"), 0)):
        r = machine.ctl(*words, "--wait")
        assert (r.returncode, r.stdout) == \
            (0, f"{words[0]}: begun\n{words[0]}: done\n"), r.stderr
        assert abs(c.status().pos_mm[0] - at) < 2e-3
    r = machine.ctl("start", "--wait", timeout=60)
    assert r.returncode == 0, r.stderr
    assert r.stdout.startswith("start: begun\n")
    assert "job job.ngc: done" in r.stdout


def test_homing_is_waited_for(homing):
    homing.start()
    r = homing.ctl("home", "--wait", timeout=60)
    assert (r.returncode, r.stdout) == (0, "home: begun\nhome: done\n")
    assert homing.ctl("home", "X").stdout == "home: begun\n"


# -- What a period took -------------------------------------------------------


def test_latency_has_what_a_period_took_beside_how_late_it_woke(machine):
    machine.client.status()
    got = json.loads(machine.ctl("--json", "latency", "0.5").stdout)
    took = got["took"]
    assert got["wakes"] > 0 and abs(took["periods"] - got["wakes"]) <= 2
    assert sum(took["bins_us"]) == took["periods"]
    assert len(took["bins_us"]) == 256 and took["bin_us"] == 1000 / 128
    assert 0 <= took["min_us"] <= took["mean_us"] <= took["max_us"]
    text = machine.ctl("latency").stdout
    assert "how late it woke" in text and "what a period took" in text
