# SPDX-License-Identifier: Apache-2.0
"""The host dies: everything is killed at once and /dev/shm is empty.

What the disk had by then is all there is.  Nothing moves by itself, the queue is
whole, the interrupted job says where it was, and no place is called certain
that is not.
"""

import os
import random
import time

import pytest
from rig import QUICK_JOB

# 12 mm at 60 mm/min take 12 s.
LONG_JOB = b"G21 G90\nG1 X4 F60\nG1 Y4\nG4 P0.2\nG1 X0\nM30\n"


def die(m):
    """What a power cut leaves: files."""
    m.kill("jobs")
    m.kill("edmd")
    m.sweep()


def seeds():
    first = int(os.environ.get("EDM_SEED", "1"))
    return range(first, first + int(os.environ.get("EDM_RUNS", "3")))


@pytest.mark.parametrize("seed", seeds())
def test_the_power_goes_at_a_random_instant(idle, seed):
    m, c = idle, idle.client
    print(f"EDM_SEED={seed}")
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    assert c.submit(QUICK_JOB, "behind").code == 0
    c.status_where(lambda s: s.job_state == "running")
    c.hear(random.Random(seed).uniform(0.3, 6))
    last = c.status()
    die(m)
    m.start()
    s = c.status_where(lambda s: s.interrupted == "cut", 10)
    # Nothing moved, nothing is loaded, and the places are not called sure.
    assert not s.job and s.state == "idle"
    assert "X" in s.lost and "Y" in s.lost
    c.hear(1)
    assert c.status().state == "idle"
    cut, behind = c.job("cut"), c.job("behind")
    assert behind["state"] == "queued"
    assert cut["state"] == "interrupted" and cut["begun_us"]
    # What STATUS said last, less a second at 1 mm/s, is the least; the cut went
    # on until it died.
    assert last.place_mm - 1.1 <= cut["path_mm"]
    assert "line" in cut["reason"] and "last seen" in cut["reason"]
    assert cut["job_s"] > 0
    # It is not begun again, and the next one only when it is out of the way.
    a = c.ask("start", "behind")
    assert a.code == 1 and "interrupted" in a.reason
    a = c.ask("start", "cut")
    assert a.code == 1 and "interrupted" in a.reason
    assert c.ask("remove", "cut").code == 0
    c.status_where(lambda s: not s.interrupted)
    assert c.job("cut")["state"] == "stopped"
    c.job_where("behind", "ready")
    assert c.ask("start").code == 0
    c.job_where("behind", "done")


def test_killed_twice_it_is_still_interrupted(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 1)
    die(m)
    for _ in range(2):
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
        die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert c.job("cut")["path_mm"] > 0.5


def test_a_torn_checkpoint_is_told_and_the_older_one_counts(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 3)
    die(m)
    (place,) = m.store.glob("*.place")
    data = bytearray(place.read_bytes())
    counts = [int.from_bytes(data[i * 4096 + 24:i * 4096 + 32], "little")
              for i in (2, 3)]
    newest = 2 + counts.index(max(counts))
    data[newest * 4096 + 200:newest * 4096 + 512] = bytes(312)
    place.write_bytes(data)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert 1 < c.job("cut")["path_mm"] <= 3.2
    log = (m.folder / "edmd-jobs.log").read_text()
    assert "torn" in log


def test_without_a_checkpoint_the_truth_is_that_nobody_knows(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 1)
    die(m)
    (place,) = m.store.glob("*.place")
    place.unlink()
    m.start()
    cut = c.job_where("cut", "stopped")
    assert "not known" in cut["reason"]


def test_a_job_that_ended_in_time_is_done(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(QUICK_JOB, "cut").code == 0
    c.job_where("cut", "done")
    die(m)
    m.start()
    c.hear(1)
    assert c.job("cut")["state"] == "done"
    assert c.status().interrupted == ""


def test_an_idle_machine_does_not_say_that_it_is_where_it_is_not(idle):
    """Its axes stand at X0.2, and the new edmd shows 0."""
    m, c = idle, idle.client
    there = b"G21 G90\nG1 X0.2 F600\nM30\n"
    m.start()
    assert c.status().lost == ""
    assert c.submit(there, "first").code == 0
    c.job_where("first", "done")
    c.hear(1)
    for _ in range(2):          # it is not forgotten by the next power cut
        die(m)
        m.start()
        s = c.status_where(lambda s: s.lost == "X", 10)
        assert s.pos_mm[0] == 0 and not s.interrupted
    assert any("X at 0.200, now shown at 0.000" in e.text for e in c.events)
    # Nothing begins until a person has seen where it stands.
    a = c.submit(there, "second")
    assert a.code == 0 and "see where it stands" in a.reason, a.reason
    c.job_where("second", "ready")
    c.hear(0.5)
    assert c.job("second")["state"] == "ready"
    assert "last seen" in c.ask("why").body
    # One start is for all that wait.
    assert c.submit(QUICK_JOB, "third").code == 0
    assert c.ask("start").code == 0
    c.job_where("second", "done")
    c.job_where("third", "done")
    assert c.status().lost == ""


def test_lines_begin_only_when_somebody_has_seen_where_it_stands(idle):
    """They never wait: what cannot begin now is refused."""
    m, c = idle, idle.client
    m.start()
    assert c.ask("mdi", text="G0 X0.2").code == 0
    c.status_where(lambda s: not s.job and s.pos_mm[0] == 0.2)
    c.hear(1)
    die(m)
    m.start()
    c.status_where(lambda s: s.lost == "X", 10)
    a = c.ask("mdi", text="G91 G0 X0.1")
    assert a.code == 1 and "see where it stands" in a.reason, a.reason
    assert c.status().pos_mm[0] == 0
    # With no job in the queue a start says only that.
    a = c.ask("start")
    assert a.code == 0 and "no job waits" in a.reason, a.reason
    assert c.ask("start").code == 1
    assert c.status().lost == ""
    assert c.ask("mdi", text="G91 G0 X0.1").code == 0
    c.status_where(lambda s: not s.job and s.pos_mm[0] == 0.1)


def test_what_was_interrupted_and_removed_leaves_the_axes_uncertain(idle):
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    assert c.submit(QUICK_JOB, "behind").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 1)
    die(m)
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert c.ask("remove", "cut").code == 0
    assert "X" in c.status_where(lambda s: not s.interrupted).lost
    c.job_where("behind", "ready")
    c.hear(0.5)
    assert c.job("behind")["state"] == "ready"
    assert c.ask("start").code == 0
    c.job_where("behind", "done")
    assert c.status().lost == ""


def test_with_its_service_dead_the_cut_leaves_an_older_checkpoint(idle):
    """edmd-jobs writes it; the cut goes on without it."""
    m, c = idle, idle.client
    m.start()
    assert c.submit(LONG_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 1)
    m.kill("jobs")
    time.sleep(1)
    m.kill("edmd")
    m.sweep()
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert 0 < c.job("cut")["path_mm"] < 4
