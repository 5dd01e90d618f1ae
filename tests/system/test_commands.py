# SPDX-License-Identifier: Apache-2.0
"""Commands to a running job, each answered once."""

import json
import subprocess
import time

import pytest
import rig
from rig import QUICK_JOB, SLOW_JOB


def running(machine, job="job", text=SLOW_JOB):
    c = machine.client
    assert c.submit(text, job).code == 0
    c.status_where(lambda s: s.job == job and s.place_mm > 0.3)
    return c


def stands(c):
    """Where it stands, after seeing that it does."""
    c.hear(0.1)
    first = c.status()
    c.hear(0.4)
    second = c.status()
    assert first.pos_mm == second.pos_mm
    assert second.feed_mm_s == 0
    return second


def test_hold_stops_and_resume_goes_on_to_the_end(machine):
    c = running(machine)
    assert c.ask("hold").code == 0
    c.status_where(lambda s: s.state == "hold" and s.job_state == "held")
    place = stands(c).place_mm
    assert 0.3 < place < 2
    assert c.ask("resume").code == 0
    c.status_where(lambda s: s.job_state == "running")
    j = c.job_where("job", "done")
    assert abs(j["path_mm"] - 2) < 1e-3


def test_retract_walks_back_along_the_path_and_holds(machine):
    c = running(machine)
    assert c.ask("hold").code == 0
    c.status_where(lambda s: s.state == "hold")
    before = stands(c)
    assert c.ask("retract", arg=0.2).code == 0
    c.status_where(
        lambda s: abs(s.place_mm - (before.place_mm - 0.2)) < 2e-3
        and s.state == "hold"
    )
    after = stands(c)
    assert abs(before.pos_mm[0] - after.pos_mm[0] - 0.2) < 2e-3
    assert after.progress >= before.progress - 1e-9
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_retract_by_no_length_is_refused(machine):
    c = machine.client
    for mm in (0, -1, float("nan"), float("inf"), 1e9):
        a = c.ask("retract", arg=mm)
        assert a.code == 65, mm
        assert "above 0" in a.reason


def test_stop_ends_the_job_and_the_queue_waits(machine):
    c = running(machine)
    assert c.submit(QUICK_JOB, "behind").code == 0
    assert c.ask("hold").code == 0
    c.status_where(lambda s: s.state == "hold")
    assert c.ask("stop").code == 0
    j = c.job_where("job", "stopped")
    assert 0 < j["path_mm"] < 2
    c.job_where("behind", "ready")
    c.hear(0.5)
    assert c.job("behind")["state"] == "ready"
    assert c.ask("start").code == 0
    c.job_where("behind", "done")


def test_estop_faults_and_the_job_goes_on_after_reset_and_start(machine):
    c = running(machine)
    assert c.submit(QUICK_JOB, "behind").code == 0
    assert c.ask("estop").code == 0
    s = c.status_where(lambda s: s.job_state == "fault")
    assert (s.state, s.fault) == ("fault", "e-stop")
    assert [e.outcome for e in c.events if e.kind == "alarm"] == ["e-stop"]
    assert c.ask("start").code == 1, "a reset is wanted"
    assert c.ask("reset").code == 0
    c.status_where(lambda s: s.job_state == "held")
    stands(c)
    assert c.ask("start").code == 0
    c.job_where("job", "done")
    c.job_where("behind", "done")


def test_a_refusal_tells_the_state_that_refused(machine):
    """Two resets at once: the second one finds an idle machine."""
    c = machine.client
    for _ in range(4):
        assert c.ask("estop").code == 0
        c.status_where(lambda s: s.state == "fault")
        both = [subprocess.Popen(
            [str(rig.BUILD / "edmctl"), "--machine", machine.name, "reset"],
            stderr=subprocess.PIPE, text=True) for _ in range(2)]
        said = [p.communicate(timeout=30)[1] for p in both]
        assert sorted(p.returncode for p in both) == [0, 1]
        assert "the machine is idle" in "".join(said)


def test_a_repeated_command_is_answered_again_not_done_again(machine):
    c = running(machine)
    assert c.ask("hold").code == 0
    c.status_where(lambda s: s.state == "hold")
    before = stands(c)
    seq = c.send_command("retract", arg=0.1)
    for _ in range(3):
        c.hear(0.2)
        c.send_command("retract", arg=0.1, seq=seq)
    c.heard(lambda: len(c.acks_to(seq)) >= 3)
    assert {a.code for a in c.acks_to(seq)} == {0}
    assert abs(before.place_mm - 0.1 - stands(c).place_mm) < 2e-3


def test_commands_without_a_job_say_so(machine):
    c = machine.client
    for verb in ("hold", "resume", "start", "stop"):
        a = c.ask(verb)
        assert a.code == 1, verb
        assert a.reason
    assert c.ask("retract", arg=1).code == 1
    assert c.ask("show", "nobody").code == 66
    assert c.ask("start", "nobody").code == 66
    assert c.ask("remove", "nobody").code == 66
    a = c.ask("dance")
    assert a.code == 64
    assert "hold" in a.reason


def test_a_waiting_job_is_removed(machine):
    c = running(machine)
    assert c.submit(QUICK_JOB, "out").code == 0
    assert c.ask("remove", "out").code == 0
    assert c.job("out")["state"] == "stopped"
    assert c.ask("remove", "job").code == 1
    c.job_where("job", "done")
    c.hear(0.5)
    assert [e.job for e in c.events if e.kind == "begun"] == ["job"]


def test_a_client_that_has_just_come_hears_the_status_at_once(machine):
    """Not only when the next tenth of a second is over."""
    c = machine.client
    c.status()
    gaps = []

    def came():
        c.statuses.clear()
        for _ in range(5):
            c.send_guest()
            c.hear(0.03)
        at = [s.utime for s in c.statuses]
        gaps.extend(b - a for a, b in zip(at, at[1:]))
        return any(gap < 90000 for gap in gaps)

    # Without a guest two are never less than 100 ms apart.
    rig.until(came)
    # However many come, there are no more than 100 a second.
    c.statuses.clear()
    begun = time.monotonic()
    for _ in range(1000):
        c.send_guest()
    c.hear(0.3)
    assert len(c.statuses) <= 100 * (time.monotonic() - begun) + 12


# It takes a while to compile: some ten million lattice points.
LONG_TO_LOAD = (b"G21 G90 F6000\nM98 P1 L30\nM30\nO1\n"
                + b"G5 X100 Y0 I30 J60 P-30 Q-60\n"
                  b"G5 X0 Y0 I30 J60 P-30 Q-60\n" * 2 + b"M99\n")


@pytest.mark.parametrize("verb", ("stop", "hold"))
def test_what_is_about_to_begin_waits_for_start(machine, verb):
    """The answer to a stop is never followed by a motion."""
    c = machine.client
    assert c.submit(LONG_TO_LOAD, "job", timeout=20).code == 0
    a = c.ask(verb)
    assert a.code == 0, a.reason
    if a.reason == "done":      # it came late
        return
    assert "next start" in a.reason
    c.job_where("job", "ready")
    c.hear(0.5)
    assert c.job("job")["state"] == "ready" and c.status().place_mm == 0
    assert c.ask("start").code == 0
    c.status_where(lambda s: s.job_state == "running")


def test_lines_that_are_checked_do_not_begin_after_a_stop(machine):
    c = machine.client
    text = "F6000\n" + ("G5 X100 Y0 I30 J60 P-30 Q-60\n"
                        "G5 X0 Y0 I30 J60 P-30 Q-60\n") * 10
    seq = c.send_command("mdi", text=text, seq=c.number())
    c.ask("stop")
    a = c.heard(lambda: c.acks_to(seq))[0]
    if a.code == 0:         # the stop came late: they are loaded, or ended
        assert c.job(a.reason)["state"] != "done"
        return
    assert a.code == 1 and "came while it was checked" in a.reason, a.reason
    assert json.loads(c.ask("history").body) == []
