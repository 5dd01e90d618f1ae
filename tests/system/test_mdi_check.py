# SPDX-License-Identifier: Apache-2.0
"""Lines that are carried out at once are checked beside the service's loop.

The technology table is a pipe that nobody writes, so a check lasts for as long
as a test wants, on any machine."""

import contextlib
import os

import pytest
import rig
from test_tech import MACHINE, TABLE

TEXT = "G91 G0 X1"


class Pipe:
    """Instead of the table; whoever reads it waits for give()."""

    def __init__(self, path):
        self.path = path
        path.unlink()
        os.mkfifo(path)

    def give(self):
        fd = os.open(self.path, os.O_WRONLY)
        self.path.unlink()
        self.path.write_text(TABLE)     # for the load that comes next
        os.write(fd, TABLE.encode())
        os.close(fd)


@pytest.fixture
def shop(tmp_path):
    (tmp_path / "shop.tech").write_text(TABLE)
    with rig.Machine(tmp_path, MACHINE) as m:
        m.start()
        yield m


def begin(m):
    """Lines whose check lasts: their pipe, and their number."""
    pipe = Pipe(m.folder / "shop.tech")
    return pipe, m.client.send_command("mdi", text=TEXT)


def again(m, seq):
    """The one who asked still waits, and says so."""
    m.client.send_command("mdi", seq=seq, text=TEXT)
    return m.client.acks_to(seq)


def answer(m, seq):
    def told():
        again(m, seq)
        m.client.hear(0.3)
        return [a for a in m.client.acks_to(seq) if a.code != 100]

    return m.client.heard(told, 10)[0]


def moved_mm(m):
    c = m.client
    c.status_where(lambda s: s.state == "idle" and not s.job)
    return c.status().pos_mm[0]


def test_all_else_is_answered_meanwhile(shop):
    c = shop.client
    pipe, seq = begin(shop)
    for _ in range(3):
        assert c.ask("queue").code == 0
        c.status()
    other = c.ask("mdi", text="G0 Y1")
    assert other.code == 1 and "other lines are being checked" in other.reason
    assert not again(shop, seq)
    pipe.give()
    a = answer(shop, seq)
    assert a.code == 0
    c.job_where(a.reason, "done")
    assert moved_mm(shop) == 1


def test_the_compiler_has_no_real_time_and_the_loop_keeps_it(shop):
    """Else it has all processors, and others wait for their answers."""
    loop = shop.jobs.pid
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(loop, os.SCHED_FIFO, os.sched_param(10))
    is_given = os.sched_getscheduler(loop)
    pipe, seq = begin(shop)
    assert shop.client.ask("queue").code == 0
    threads = [os.sched_getscheduler(int(t))
               for t in os.listdir(f"/proc/{loop}/task")]
    assert os.sched_getscheduler(loop) == is_given
    assert threads.count(os.SCHED_BATCH) == 1
    pipe.give()
    assert answer(shop, seq).code == 0


def test_lines_that_nobody_waits_for_any_more_do_not_begin(shop):
    c = shop.client
    pipe, seq = begin(shop)
    assert c.ask("queue").code == 0
    c.hear(2)
    pipe.give()
    (a,) = c.heard(lambda: c.acks_to(seq))
    assert a.code == 1 and "did not wait" in a.reason
    assert moved_mm(shop) == 0


def test_axes_that_moved_meanwhile_are_noticed(shop):
    c = shop.client
    pipe, seq = begin(shop)
    assert c.ask("jog", text="Y", arg=1).code == 0
    c.status_where(lambda s: s.pos_mm[1] == 1 and s.state == "idle")
    again(shop, seq)
    pipe.give()
    a = answer(shop, seq)
    assert a.code == 1 and "the axes moved" in a.reason
    assert moved_mm(shop) == 0


@pytest.mark.parametrize("way", ["kill", "end"])
def test_a_service_that_ends_over_it_leaves_it_to_the_next(shop, way):
    c = shop.client
    _, seq = begin(shop)
    assert c.ask("queue").code == 0
    if way == "kill":
        shop.kill("jobs")
    else:
        shop.jobs.terminate()
        shop.jobs.wait(30)
    (shop.folder / "shop.tech").unlink()
    (shop.folder / "shop.tech").write_text(TABLE)
    shop.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    a = answer(shop, seq)
    assert a.code == 0
    c.job_where(a.reason, "done")
    assert moved_mm(shop) == 1


@pytest.mark.parametrize("strategy", ["simultaneous", "point-by-point"])
def test_a_full_circle_of_100_mm_is_taken(tmp_path, strategy):
    config = rig.NULL_MACHINE.replace(
        "backend", f"strategy = {strategy}\nbackend")
    with rig.Machine(tmp_path, config) as m:
        m.start()
        a = m.client.ask("mdi", text="G2 I100 F60")
        assert a.code == 0, a.reason
        m.client.job_where(a.reason, "running")
        assert m.ctl("stop").returncode == 0
