# SPDX-License-Identifier: Apache-2.0
"""The host's power fails at random instants: QEMU is killed while jobs run.

Each job begins on a disk that no machine has used.  The virtual machine boots,
the job runs, QEMU is killed, and so on; after some kills the job is left to
end.  After each boot nothing may have moved by itself, the queue must be whole,
and no older place may be kept than before.  How far the kept place is behind
the one that was seen last is printed: here that depends on how soon a busy host
serves a disk, and test_checkpoint bounds it by a clock of its own.  At last,
the way of the axes from the first spark on is compared with that of an
uninterrupted run.

EDM_SEED and EDM_CUTS (kills of each job) choose others; `make torture` does
300.
"""

import csv
import hashlib
import json
import os
import random
import subprocess

import pytest
from boot import ABSENT, BUILD
from power import Power

SEED = int(os.environ.get("EDM_SEED", "1"))
CUTS = int(os.environ.get("EDM_CUTS", "3"))
PERIOD_S, SPEED, PULSE_MM = 0.01, 10, 0.001
IN_CUT = {"erode", "approach", "jump", "retract"}
# Points that a period of a cut goes at most.
STEP = 50

MACHINE = f"""[machine]
name = vm
backend = sim
period_us = {PERIOD_S * 1e6:.0f}
overrun_limit = 0
cpu = -1
[axis.Z]
start_mm = 1
[jump]
height_mm = 0.2
every_s = 1
[probe]
feed_mm_s = 1
fine_mm_s = 0.2
[sim]
block = yes
block_top_mm = 0
speed = {SPEED}
"""

PLC = """[plc]
interface = vcan1
alive_ms = 5000
m_before = 60 61 64
m_after = 62
m_free = 63
"""

JOBS = {
    # Cuts with jumps, from one place to another.
    "cuts": "G21 G90 T84 M3\nG0 Z1\nG0 X0 Y0\nG0 Z0.1\nG1 Z-0.06 F60\n"
            "G1 X0.05\nG0 Z1\nG0 X2 Y1\nG0 Z0.1\nG1 Z-0.04\n"
            "G1 X2.1 Y1.05 Z-0.06\nG0 Z1\nM30\n",
    # It feels for the work, and counts from there.
    "probe": "G21 G90 T84 M3\nG80 Z-\nG92 Z0\nG0 Z0.2\nG1 Z-0.06 F60\nG1 Y0.05\n"
             "G0 Z0.5\nM0\nG0 X1\nG0 Z0.1\nG1 Z-0.05\nG0 Z0.5\nM30\n",
    # A curve and arcs on the way down.
    "curve": "G21 G90 G17 T84 M3\nG0 Z0.1\nG1 Z-0.05 F60\n"
             "G5.1 X0.1 Y0 I0.05 J0.1\nG3 X0 Y0 I-0.05 J0\n"
             "G2 X0.05 Y0.05 I0.05 J0\n"
             "G0 Z1\nM30\n",
    # Orbits, a stop for the operator between them, and ways out beside the path.
    "orbit": "G21 G90 G17 T84 M3\nD1=0.08\nF60\nG0 Z1\nG0 X0.5 Y0.5\n"
             "G0 Z0.1\nG130 Z-0.03 D1 J0.02 K0.01 Q0.05 P1\nG0 Z1\nM0\n"
             "G141\nG0 X1 Y0.5\nG0 Z0.1\nG134 Z-0.03 R0.04 A45 L4\n"
             "G0 Z1\nM30\n",
    # The PLC carries out M codes, and the machine waits for it.
    "mcode": "G21 G90 T84 M3\nG0 Z1\nG0 X0 Y0\nM60 G0 Z0.1\n"
             "G1 Z-0.03 F60\nM61 G1 X0.04\nM62 G1 X0.08\nG0 Z1\n"
             "M63 G0 X1\nG0 Z0.1\nG1 Z-0.02\nM64 G1 Y0.04\nG0 Z1\nM30\n",
}
CODES = [60, 61, 62, 63, 64]

ENDS = {"cuts": (2.1, 1.05, 1), "probe": (1, 0.05, 0.5),
        "curve": (0.05, 0.05, 1), "orbit": (1, 0.5, 1), "mcode": (1, 0.04, 1)}


class Left:
    """What is left to cut, in mm: the same in a whole job and in its rest."""

    def __init__(self):
        self.kept, self.run = None, []
        self.late_s = self.late_mm = 0

    def see(self, seen):
        """What edmd did in the turn that ended."""
        self.run = [s | {"left": s["length"] - s["far"]} for s in seen
                    if s["loaded"] and s["length"]]

    def keep(self, was):
        """The checkpoint that the next turn found."""
        left = was["length_mm"] - was["path_mm"]
        # On the way in ground is passed again that was cut before.
        newer = [s for s in self.run if s["left"] < left - 1e-4]
        if newer:
            last = self.run[-1]
            late_s = (last["cycle"] - newer[0]["cycle"]) * PERIOD_S
            late_mm = left - last["left"]
            self.late_s = max(self.late_s, late_s)
            if {last["state"], newer[0]["state"]} <= IN_CUT:
                self.late_mm = max(self.late_mm, late_mm)
        assert self.kept is None or left <= self.kept + 1e-4, \
            "an older place was kept"
        self.kept = left


def check_stood(p):
    """Nothing moves before somebody resumes and starts."""
    began = (p.share / f"begun.{p.turn}").exists()
    seen = p.seen()
    for s in seen:
        if s["state"] not in ("idle", "hold") or any(
                s[a] != seen[0][a] for a in "xyz"):
            assert began, ("it moved by itself", s)
            return


def check_queue(p, accepted):
    """What was accepted is there; what is done is in the history."""
    queue = {job["job"]: job for job in p.json("queue")}
    history = p.json("history")
    done = {job["job"]: job for job in history}
    there = set(queue) | set(done)
    # The power may fail between the store and the answer: then there is more
    # than was told, and from now on it must stay.
    assert accepted <= there <= {"cut", "next"}, (queue, done)
    accepted |= there
    assert not set(queue) & set(done), (queue, done)
    for name in queue:
        job = queue[name] = p.json(f"show-{name}")
        text = p.share / ("job.ngc" if name == "cut" else "next.ngc")
        sha256 = hashlib.sha256(text.read_bytes()).hexdigest()
        assert job["sha256"] == sha256, job
    assert all(job["state"] == "done" for job in history), history
    return queue.get("cut")


def check_came_back(p, left, accepted):
    check_stood(p)
    if (p.share / f"begun.{p.turn}").exists() or p.has("told"):
        cut = check_queue(p, accepted)
        if cut and cut["state"] == "interrupted":
            left.keep(cut)
    for line in p.text("told").splitlines():
        name, _, answer = line.partition(": ")
        if name in ("cut", "next") and "accepted" in answer:
            accepted.add(name)


def lattice(folder):
    """Every point of a run that nothing interrupts, in pulses."""
    out = folder / "points.csv"
    subprocess.run([BUILD / "edmsim", "--quiet", "--machine",
                    folder / "torture.ini", "--dry-run", "--pulses", out,
                    folder / "job.ngc"], check=True, capture_output=True)
    with open(out) as f:
        return [tuple(round(float(row[k])) for k in "XYZ")
                for row in csv.DictReader(f)]


def check_trace(name, folder):
    """From the first spark on the axes go along the whole program, point by
    point: between two periods of a cut it is at most @STEP points farther."""
    points, cut, before = lattice(folder), 0, None
    with open(folder / "trace.csv") as f:
        # Line 0 is the way in: off the work, or over ground that was cut.
        rows = [(row["state"] if row["line"] != "0" else "way in",
                 tuple(round(float(row[k]) / PULSE_MM) for k in "XYZ"))
                for row in csv.DictReader(f)]
    # A dry run does not feel: its places count from another contact.
    up = rows[-1][1][2] - points[-1][2] if name == "probe" else 0
    where = {}
    for i, (x, y, z) in enumerate(points):
        where.setdefault((x, y, z + up), []).append(i)
    for state, at in rows:
        # A lift may lead beside the path, and so may the approach after it.
        if state != "erode":
            before = before and (before[0], len(points))
            continue
        assert at in where, (state, at)
        reach = len(points) if before is None else before[1]
        now = {i for i in where[at] if before is None or
               any(abs(i - b) <= reach for b in before[0])}
        assert now, ("not along the path", at)
        before, cut = (now, STEP), cut + 1
    assert cut > 100


def check_codes(p):
    """No M code was left out, and none was told again that was done long ago:
    the program was at its line, or the one before."""
    order, at = [], -1
    for turn in range(1, p.turn + 1):
        path = p.share / f"plc.{turn}"
        told = path.read_text().splitlines() if path.exists() else []
        for code in [int(line.split()[1]) for line in told
                     if line.startswith("ask ")]:
            i = CODES.index(code)
            assert i <= at + 1, (f"M{CODES[at + 1]} was left out", order)
            assert i >= at - 1, (f"M{code} was told again", order)
            at, order = i, order + [(turn, code)]
    assert at == len(CODES) - 1, order


def check_end(p, name):
    ended = json.loads((p.share / "history").read_text())[0]
    assert ended["state"] == "done", ended
    assert ended["path_mm"] == pytest.approx(ended["length_mm"])
    if name == "mcode":
        check_codes(p)
    # When the power failed last, the job had ended already: the simulated
    # machine stands at its start after a boot, whatever it did before.
    if "done already" in p.text("told"):
        return
    end = p.seen()[-1]
    assert [end[a] * PULSE_MM for a in "xyz"] == pytest.approx(
        ENDS[name], abs=0.003)
    if (p.share / "trace.csv").exists():
        check_trace(name, p.share)


def one_job(guest, name, dice, left, most):
    """A job from its beginning to its end.  Return: kills, at most @most."""
    p = Power(guest, name, {
        "torture.ini": MACHINE + (PLC if name == "mcode" else "") + ABSENT,
        "job.ngc": JOBS[name], "next.ngc": JOBS["cuts"]})
    left.kept, left.run, accepted = None, [], set()
    kills, most = 0, min(most, dice.randint(4, 10))
    while True:
        if kills == most:
            (p.share / "record").touch()
        killed = p.boot(dice.uniform(0, 6) if kills < most else None)
        check_came_back(p, left, accepted)
        left.see(p.seen())
        if not killed:
            check_end(p, name)
            return kills
        kills += 1


@pytest.mark.parametrize("name", JOBS)
def test_the_power_fails(guest, name):
    dice, left = random.Random(f"{SEED} {name}"), Left()
    kills = jobs = 0
    print(f"EDM_SEED={SEED} {name}", flush=True)
    while kills < CUTS:
        kills += one_job(guest, name, dice, left, CUTS - kills)
        jobs += 1
        print(f"{name}: {kills} kills, {jobs} jobs to their end, checkpoint at "
              f"most {left.late_s:.2f} s and {left.late_mm:.4f} mm behind",
              flush=True)
