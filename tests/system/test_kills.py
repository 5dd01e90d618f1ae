# SPDX-License-Identifier: Apache-2.0
"""Each act once or not at all, and told so, whoever is killed when.

A command is sent; edmd, edmd-jobs or both are killed some milliseconds later
and started again; the client repeats it until it is answered.  What was told
must be what is, and the same command sent once more, when other things have
been done since, must do nothing.

EDM_KILLS is the number of kills, EDM_SEED what they are drawn by; `make kills`
makes 500.
"""

import json
import os
import random
import time

import rig
from rig import NULL_MACHINE, command_t

KILLS = int(os.environ.get("EDM_KILLS", "12"))
SEED = int(os.environ.get("EDM_SEED", "1"))
# To and fro: there is a way to go from wherever the round before left the axis,
# and on a busy machine too it does not end before it is looked at.
LONG_JOB = b"G21 G90\nF60\n" + 20 * b"G1 X9\nG1 X0\n" + b"M30\n"
NOT_DONE = ("it is not done", "it was not done", "wants ")


class Round:
    def __init__(self, machine, draw):
        self.m, self.c, self.draw = machine, machine.client, draw
        self.n = 0

    # -- One command

    def message(self, verb, **more):
        m = command_t()
        m.utime, m.client, m.seq = 0, self.c.name, self.c.number()
        m.verb, m.job, m.arg, m.text = verb, "", 0.0, ""
        for key, value in more.items():
            setattr(m, key, value)
        return m

    def send(self, m):
        self.c.publish("COMMAND", m.encode())

    def answer(self, m, timeout=20.0):
        """Repeat until it is answered for good."""
        end = time.monotonic() + timeout
        while True:
            for a in self.c.acks_to(m.seq):
                if a.code not in (75, 100):
                    return a
            assert time.monotonic() < end, f"{m.verb}: no answer"
            self.c.acks[:] = [a for a in self.c.acks if a.seq != m.seq]
            self.send(m)
            self.c.hear(0.3)

    def kill(self, which):
        for one in which:
            self.m.kill(one)
        for one in which:
            self.m.start_edmd() if one == "edmd" else self.m.start_jobs()
        self.c.status_where(lambda s: s.daemon == "ok", timeout=20)

    # -- How it stands

    def stands(self):
        """A status after which nothing moves."""
        for _ in range(200):
            a = self.c.status(10)
            self.c.hear(0.15)
            b = self.c.status(10)
            if a.pos_mm == b.pos_mm and a.state == b.state:
                return b
        raise AssertionError("it does not come to a stand")

    def do(self, verb, **more):
        return self.answer(self.message(verb, **more))

    def clear(self):
        """Idle, no job, no fault, an empty queue."""
        for _ in range(20):
            s = self.c.status(10)
            queue = json.loads(self.c.ask("queue").body)
            if s.state == "idle" and not s.job and not queue:
                return
            if s.state == "fault":
                self.do("reset")
            elif s.job and s.state != "hold":
                self.do("hold")
            for job in queue:
                self.do("remove", job=job["job"])
            self.do("stop")
            self.c.hear(0.2)
        raise AssertionError(f"not cleared: {rig.vars_of(s)}, {queue}")

    def job(self, state, **more):
        """One that runs, or is held, or waits."""
        self.n += 1
        job = f"job-{self.draw.getrandbits(40):x}"
        hold = state in ("ready",)
        assert self.c.submit(LONG_JOB, job, hold=hold).code == 0
        if state == "ready":
            self.c.job_where(job, "ready")
            return job
        self.c.status_where(lambda s: s.job == job and s.place_mm > 0.2, 10)
        if state == "held":
            assert self.do("hold").code == 0
            self.c.job_where(job, "held")
        return job


def jog(r, again):
    before = r.stands().pos_mm[1]
    m, a, killed = yield r.message("jog", text="Y", arg=1.0)
    moved = r.stands().pos_mm[1] - before
    assert moved < 1 + 1e-6, f"moved {moved} mm"
    if a.code == 0 and "edmd" not in killed:
        assert abs(moved - 1) < 1e-6
    if any(t in a.reason for t in NOT_DONE):
        assert moved == 0, (a.reason, moved)
    at = r.stands().pos_mm
    again(m)
    assert r.stands().pos_mm == at


def estop(r, again):
    m, a, _ = yield r.message("estop")
    assert (r.stands().fault == "e-stop") == (a.code == 0), a.reason
    r.do("reset")
    again(m)
    assert r.stands().fault == "none"


def reset(r, again):
    assert r.do("estop").code == 0
    m, a, _ = yield r.message("reset")
    assert (r.stands().fault == "none") == (a.code == 0), a.reason
    r.do("estop")
    again(m)
    assert r.stands().fault == "e-stop"


def hold(r, again):
    r.job("running")
    m, a, killed = yield r.message("hold")
    if a.code == 0 or "edmd" in killed:
        assert r.stands().state == "hold", a.reason
    r.do("resume")
    r.c.status_where(lambda s: s.state not in ("hold", "unknown"))
    again(m)
    assert r.c.status().state != "hold"


def goes_on(r, again, verb, state):
    r.job(state)
    m, a, killed = yield r.message(verb)
    if a.code == 0 and "edmd" not in killed:
        r.c.status_where(lambda s: s.job_state == "running")
    if any(t in a.reason for t in NOT_DONE):
        assert r.stands().job_state != "running", a.reason
    r.do("hold")
    at = r.stands()
    again(m)
    assert r.stands().pos_mm == at.pos_mm, "it went on by itself"


def resume(r, again):
    yield from goes_on(r, again, "resume", "held")


def start(r, again):
    yield from goes_on(r, again, "start", "ready")


def retract(r, again):
    r.job("held")
    before = r.stands().place_mm
    m, a, killed = yield r.message("retract", arg=0.05)
    back = before - r.stands().place_mm
    assert back < 0.05 + 2e-3, f"back {back} mm"
    if a.code == 0 and "edmd" not in killed:
        assert back > 0.05 - 2e-3
    at = r.stands().pos_mm
    again(m)
    assert r.stands().pos_mm == at


def stop(r, again):
    r.job("held")
    m, a, _ = yield r.message("stop")
    if any(t in a.reason for t in NOT_DONE):
        assert r.stands().job, a.reason
    r.clear()
    other = r.job("held")
    again(m)
    assert r.stands().job == other


def remove(r, again):
    r.job("held")
    assert r.c.submit(LONG_JOB, f"behind-{r.draw.getrandbits(40):x}").code == 0
    job = json.loads(r.c.ask("queue").body)[-1]["job"]
    m, a, _ = yield r.message("remove", job=job)
    assert a.code == 0, a.reason
    assert r.c.job(job)["state"] == "stopped"
    again(m)
    assert json.loads(r.c.ask("show", job).body)["state"] == "stopped"


def submit(r, again):
    m, a, killed = yield None
    rows = [j for j in json.loads(r.c.ask("queue").body)
            + json.loads(r.c.ask("history").body)
            if j["job"] == m]
    assert len(rows) == 1


def change(r, again):
    r.job("held")
    m, a, _ = yield r.message("set", text="feed_max_mm_min", arg=7.0)
    r.do("set", text="feed_max_mm_min", arg=9.0)
    job = r.c.status().job
    n = len(r.c.job(job)["changes"])
    again(m)
    assert len(r.c.job(job)["changes"]) == n


VERBS = [jog, estop, reset, hold, resume, start, retract, stop, remove, submit,
         change]
VICTIMS = [("edmd",), ("jobs",), ("edmd", "jobs"), ("jobs", "edmd")]


def one_round(r, verb, killed):
    def again(m):
        r.send(m)
        r.c.hear(0.4)

    r.clear()
    script = verb(r, again)
    m = next(script)
    delay = r.draw.choice((0, 0.001, 0.003, 0.01, 0.02, 0.05))
    delay *= r.draw.random()
    if m is None:
        m = f"job-{r.draw.getrandbits(40):x}"
        chunks = r.c.chunks(LONG_JOB, m, hold=True)
        r.c.send(chunks)
        time.sleep(delay)
        r.kill(killed)
        a = None
        for _ in range(40):
            r.c.send(chunks)
            r.c.hear(0.3)
            a = r.c.verdict(chunks)
            if a:
                break
        assert a and a.code == 0
    else:
        r.send(m)
        time.sleep(delay)
        r.kill(killed)
        a = r.answer(m)
    try:
        script.send((m, a, killed))
    except StopIteration:
        return
    raise AssertionError("the script has more to say")


def test_each_act_is_done_once_or_not_at_all_and_told_so(tmp_path):
    draw = random.Random(SEED)
    machine = rig.Machine(tmp_path, NULL_MACHINE)
    machine.start()
    r = Round(machine, draw)
    told = {}
    try:
        for i in range(KILLS):
            verb = VERBS[i % len(VERBS)]
            killed = draw.choice(VICTIMS)
            try:
                one_round(r, verb, killed)
            except BaseException:
                print(f"kill {i} of seed {SEED}: {verb.__name__}, {killed}")
                raise
            told[verb.__name__] = told.get(verb.__name__, 0) + 1
        print(f"{KILLS} kills: {told}")
    finally:
        machine.close()
        machine.sweep()
