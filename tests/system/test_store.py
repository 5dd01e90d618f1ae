# SPDX-License-Identifier: Apache-2.0
"""The store on a disk that is full, read-only or fails: what runs goes on,
what is told is true, and no job is ever cut a second time."""

import errno
import hashlib
import json
import os
import subprocess

import pytest
import rig
from rig import QUICK_JOB, SLOW_JOB


class Failing(rig.Machine):
    """A machine whose edmd-jobs stores on a disk that fails on demand."""

    shim = None

    def __init__(self, folder, shim):
        super().__init__(folder)
        self.shim = shim
        self.errno = self.folder / "errno"

    def env(self, program):
        return {"LD_PRELOAD": rig.preload(self.shim),
                "EDM_DISK": str(self.store),
                "EDM_DISK_ERRNO": str(self.errno)
                } if program == "edmd-jobs" else {}

    def fail(self, number):
        self.errno.with_suffix(".new").write_text(str(number))
        self.errno.with_suffix(".new").rename(self.errno)

    def heal(self):
        self.errno.unlink()


@pytest.fixture
def failing(tmp_path, shim):
    m = Failing(tmp_path, shim)
    yield m
    if m.errno.exists():
        m.heal()
    m.close()
    m.sweep()


def degraded(c, why):
    return c.status_where(lambda s: s.store == f"degraded: {why}")


WORDS = {
    errno.ENOSPC: "the disk is full",
    errno.EROFS: "the disk is read-only",
    errno.EIO: "the disk fails: input/output error",
}


def told(c, job):
    """How often each kind of event of a job is in the history."""
    kinds = [e["kind"] for e in json.loads(c.ask("events").body)
             if e["job"] == job]
    return {k: kinds.count(k) for k in ("begun", "ended")}


def test_wherever_it_dies_a_begin_and_an_end_are_told_once(failing):
    """It ends at the Nth write after a start, and is started again."""
    m, c = failing, failing.client
    m.start()
    for n in range(2, 61, 2):
        job = f"job-{n}"
        assert c.submit(QUICK_JOB, job, hold=True).code == 0
        c.job_where(job, "ready")
        m.fail(-n)
        c.send_command("start")
        c.heard(lambda: m.jobs.poll() is not None or
                [e for e in c.events if (e.job, e.kind) == (job, "ended")])
        m.heal()
        # A write that has begun may still be its last one.
        asked = c.send_command("show", job)
        c.heard(lambda: m.jobs.poll() is not None or c.acks_to(asked))
        if m.jobs.poll() is not None:
            m.start_jobs()
            c.status_where(lambda s: s.daemon == "ok")
        if c.job(job)["state"] in ("queued", "ready"):
            c.job_where(job, "ready")
            c.ask("start")
        c.job_where(job, "done")
        assert told(c, job) == {"begun": 1, "ended": 1}, n


@pytest.mark.parametrize("number", WORDS, ids=errno.errorcode.get)
def test_a_disk_that_fails_in_a_cut_stops_nothing(failing, number):
    m = failing
    m.start()
    c = m.client
    assert c.status().store == "ok"
    assert c.submit(SLOW_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running")
    assert c.submit(QUICK_JOB, "behind").code == 0
    m.fail(number)
    # The cut goes on to its end, and that is told, with what it is worth.
    c.heard(lambda: [e for e in c.events if e.kind == "ended"], 20)
    ended = [e for e in c.events if e.kind == "ended"][0]
    assert ended.outcome == "done"
    assert f"not on the disk: {WORDS[number]}" in ended.text
    degraded(c, WORDS[number])
    assert c.job("cut")["state"] == "done"
    # Nothing new is taken or begun.
    a = c.submit(QUICK_JOB, "new")
    assert a.code == 74 and WORDS[number] in a.reason
    c.hear(0.5)
    assert c.job("behind")["state"] == "queued"
    a = c.ask("move", "behind", -1)
    assert a.code == 74 and WORDS[number] in a.reason
    # A service that is killed now has no disk to ask: edmd knows.
    m.kill("jobs")
    m.start_jobs()
    degraded(c, WORDS[number])
    assert c.job("cut")["state"] == "done"
    assert c.job("behind")["state"] == "queued"
    r = m.ctl("doctor", "--json")
    (row,) = [x for x in json.loads(r.stdout) if x["what"] == "store"]
    assert row["verdict"] == "lacking" and WORDS[number] in row["found"]
    # Room comes.
    m.heal()
    c.status_where(lambda s: s.store == "ok")
    assert c.job("cut")["state"] == "done"
    m.kill("jobs")
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    assert c.job("cut")["state"] == "done"
    # Killed while it was being loaded, it waits for a start.
    rig.until(lambda: c.job("behind")["state"] in ("ready", "done"))
    if c.job("behind")["state"] != "done":
        c.ask("start")
    c.job_where("behind", "done")
    begun = [e for e in c.events if e.kind == "begun" and e.job == "cut"]
    assert len(begun) <= 1


def test_a_job_is_removed_though_the_disk_is_full(failing):
    m = failing
    m.start()
    c = m.client
    for name in ("ready", "second", "third"):
        assert c.submit(QUICK_JOB, name, hold=True).code == 0
    c.job_where("ready", "ready")
    m.fail(errno.ENOSPC)
    # The first write that fails is the removal itself.
    for name in ("second", "ready"):
        a = c.ask("remove", name)
        assert a.code == 0, a.reason
        assert "in memory only: the disk is full" in a.reason
        assert c.job(name)["state"] == "stopped"
    # As it was told: who knew of it is gone, so the job is there again.
    m.kill("jobs")
    m.start_jobs()
    degraded(c, WORDS[errno.ENOSPC])
    assert c.job("second")["state"] == "queued"
    assert c.ask("remove", "second").code == 0
    # There is room: what was in memory goes to the disk, and stays.
    m.heal()
    c.status_where(lambda s: s.store == "ok")
    m.kill("jobs")
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    assert c.job("second")["state"] == "stopped"
    c.job_where("third", "ready")       # not while it is being loaded
    assert c.ask("remove", "third").reason == "removed"


def test_a_ready_job_cannot_begin_that_cannot_be_stored(failing):
    m = failing
    m.start()
    c = m.client
    assert c.submit(SLOW_JOB, "job", hold=True).code == 0
    c.job_where("job", "ready")
    m.fail(errno.ENOSPC)
    a = c.ask("start")
    assert a.code == 74 and "the disk is full" in a.reason
    c.hear(0.5)
    assert c.status().state in ("idle", "hold")
    assert c.status().job_s == 0
    m.heal()
    c.status_where(lambda s: s.store == "ok")
    c.job_where("job", "ready")
    assert c.ask("start").code == 0
    c.job_where("job", "done")


def test_after_the_host_died_on_a_full_disk_nothing_is_cut_again(failing):
    """The disk filled up in the cut; then the power went: /dev/shm is empty."""
    m = failing
    m.start()
    c = m.client
    assert c.submit(QUICK_JOB, "first").code == 0
    c.job_where("first", "done")
    assert c.submit(SLOW_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running")
    m.fail(errno.ENOSPC)
    c.heard(lambda: [e for e in c.events
                     if e.kind == "ended" and e.job == "cut"], 20)
    m.kill("jobs")
    m.kill("edmd")
    m.sweep()
    m.heal()
    m.start()
    c.hear(1)
    assert c.job("cut")["state"] != "queued"
    assert not c.status().job
    c.ask("start")
    c.hear(0.5)
    assert not c.status().job


def test_the_disk_is_read_only_from_the_start(failing):
    m = failing
    m.start()
    c = m.client
    assert c.submit(QUICK_JOB, "before").code == 0
    c.job_where("before", "done")
    assert c.submit(QUICK_JOB, "kept", hold=True).code == 0
    assert m.end("jobs") == 0
    m.fail(errno.EROFS)
    m.start_jobs()
    degraded(c, WORDS[errno.EROFS])
    assert c.job("before")["state"] == "done"
    assert c.submit(QUICK_JOB, "new").code == 74
    assert "goes on when there is room" in m.ctl("status").stdout
    m.heal()
    c.status_where(lambda s: s.store == "ok")
    assert c.submit(QUICK_JOB, "new").code == 0
    c.job_where("kept", "ready")
    c.ask("start")
    c.job_where("new", "done")


def test_a_damaged_store_is_set_aside_and_told(failing):
    m = failing
    m.start()
    c = m.client
    assert c.submit(QUICK_JOB, "before").code == 0
    c.job_where("before", "done")
    assert m.end("jobs") == 0
    (db,) = m.store.glob("*.db")
    db.write_bytes(b"no database at all" * 1000)
    m.start_jobs()
    c.heard(lambda: [e for e in c.events if e.outcome == "mended"])
    assert list(m.store.glob("*.db.damaged-*"))
    assert c.submit(QUICK_JOB, "new").code == 0


@pytest.mark.parametrize("how", ["emptied", "removed"])
def test_a_store_that_is_gone_is_told_and_nothing_starts(machine, how):
    """Its work offsets are gone, too: who does not know that cuts elsewhere."""
    m, c = machine, machine.client
    assert m.ctl("offset", "G54", "X=3").returncode == 0
    assert m.end("jobs") == 0
    for path in m.store.glob("*.db*"):
        path.unlink()
    if how == "emptied":
        (m.store / f"{m.name}.db").touch()
    m.start_jobs()
    c.heard(lambda: [e for e in c.events if e.outcome == "mended" and
                     "work offsets" in e.text])
    assert c.submit(QUICK_JOB, "new").code == 0
    c.job_where("new", "ready")
    c.hear(1.5)
    assert c.job("new")["state"] == "ready", "it began by itself"
    assert c.ask("start").code == 0
    c.job_where("new", "done")


@pytest.mark.parametrize("how", ["link", "fifo"])
@pytest.mark.parametrize("end", ["db", "db-wal", "lock", "place", "key",
                                 "machine-key", "db.probe"])
def test_a_link_or_fifo_in_the_store_is_not_followed(idle, end, how):
    m = idle
    m.store.mkdir()
    elsewhere = m.folder / "elsewhere"
    elsewhere.write_text("of somebody else\n")
    elsewhere.chmod(0o644)
    at = m.store / f"{m.name}.{end}"
    os.mkfifo(at) if how == "fifo" else at.symlink_to(elsewhere)
    m.start_jobs()
    if end == "db.probe":       # it is no file that has to be there
        rig.until(lambda: "machine test" in m.log("edmd-jobs"))
    else:
        assert m.jobs.wait(20) == 78
        assert f"{at} is a symbolic link, or no regular" in m.log("edmd-jobs")
    assert elsewhere.read_text() == "of somebody else\n"
    assert elsewhere.stat().st_mode & 0o777 == 0o644


def test_what_a_store_began_anew_has_is_not_taken_for_what_ended(machine):
    """The same number and the same text, sent later, is another job."""
    m, c = machine, machine.client
    assert c.submit(QUICK_JOB, "before").code == 0
    c.job_where("before", "done")
    assert m.end("jobs") == 0
    c = m.forget_store()
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    assert c.submit(QUICK_JOB, "after", hold=True).code == 0
    assert c.job("after")["n"] == 1
    m.kill("jobs")
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    c.hear(0.3)
    assert c.job("after")["state"] in ("ready", "queued")
    assert c.ask("start").code == 0
    c.job_where("after", "done")


@pytest.mark.parametrize("number", [errno.EROFS, errno.EIO])
def test_an_interrupted_job_is_found_when_the_disk_comes_back(failing, number):
    """Its service could not open the store, and the job behind must not begin."""
    m, c = failing, failing.client
    m.start()
    assert c.submit(SLOW_JOB, "cut").code == 0
    assert c.submit(QUICK_JOB, "behind").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 0.5)
    for which in ("jobs", "edmd"):
        m.kill(which)
    m.sweep()
    m.start()
    c.status_where(lambda s: s.interrupted == "cut", 10)
    assert m.end("jobs") == 0
    m.fail(number)
    m.start_jobs()
    c.status_where(lambda s: s.store.startswith("degraded"), 10)
    m.heal()
    c.status_where(lambda s: s.store == "ok" and s.interrupted == "cut", 20)
    c.hear(1)
    assert c.job("behind")["state"] == "queued"
    assert not c.status().job
    assert c.ask("remove", "cut").code == 0


LONG_TEXT = b"(" + b"x" * 61 + b")\n"
LONG_TEXT = LONG_TEXT * 8192 + QUICK_JOB        # 512 KiB


def text_files(m):
    return list(m.store.glob("*.text-*"))


def test_a_long_text_is_a_file_and_outlives_a_kill(machine):
    m, c = machine, machine.client
    assert c.submit(QUICK_JOB, "before", hold=True).code == 0
    assert c.submit(LONG_TEXT, "long").code == 0
    (text,) = text_files(m)
    assert text.read_bytes() == LONG_TEXT
    m.kill("jobs")
    m.start_jobs()
    c.job_where("before", "ready")
    assert c.ask("start").code == 0
    c.job_where("long", "done")


def test_a_long_text_that_is_damaged_or_foreign_is_not_cut(machine):
    m, c = machine, machine.client
    other = LONG_TEXT.replace(b"X0.2", b"X0.9")
    assert len(other) == len(LONG_TEXT) and other != LONG_TEXT
    wrong = LONG_TEXT.replace(b"X0.2", b"X0.?")     # no program at all
    for name, bad in (("other", other), ("cut", LONG_TEXT[:-1]),
                      ("wrong", wrong)):
        # Only the first of the queue is compiled already.
        assert c.submit(QUICK_JOB, f"before-{name}", hold=True).code == 0
        assert c.submit(LONG_TEXT, name).code == 0
        (text,) = text_files(m)
        text.write_bytes(bad)
        c.job_where(f"before-{name}", "ready")
        assert c.ask("start").code == 0
        assert "damaged" in c.job_where(name, "fault")["reason"]
    # Sent again it is written again.
    assert c.submit(LONG_TEXT, "again").code == 0
    c.job_where("again", "done")


def test_a_long_text_without_room_is_refused(failing):
    m, c = failing, failing.client
    m.start()
    m.fail(errno.ENOSPC)
    a = c.submit(LONG_TEXT, "long")
    assert a.code == 74 and "make room" in a.reason
    assert c.job("long") is None
    m.heal()
    assert c.heard(lambda: c.submit(LONG_TEXT, "later").code == 0)
    c.job_where("later", "done")


def text_file(m, text):
    return m.store / f"{m.name}.text-{hashlib.sha256(text).hexdigest()}"


def test_a_refused_or_interrupted_upload_leaves_no_text(machine):
    m, c = machine, machine.client
    assert c.submit(QUICK_JOB, "before", hold=True).code == 0
    # One id for two texts: one of them is refused after it was written.
    texts = [LONG_TEXT, b"(other)\n" + LONG_TEXT]
    both = [rig.Client(m.name), rig.Client(m.name)]
    sent = [d.chunks(t, "one") for d, t in zip(both, texts)]
    for d in both:
        d.status()
    for pair in zip(*sent):
        for d, chunk in zip(both, pair):
            d.send([chunk])
    codes = [d.heard(lambda d=d, s=s: d.verdict(s)).code
             for d, s in zip(both, sent)]
    assert 0 in codes and codes != [0, 0]
    wanted = text_file(m, texts[codes.index(0)])
    assert text_files(m) == [wanted]
    # A service that was killed over an upload leaves these.
    m.kill("jobs")
    text_file(m, b"killed before its row").write_bytes(LONG_TEXT)
    wanted.with_name(wanted.name + ".a1b2c3").write_bytes(b"half")
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    assert text_files(m) == [wanted]


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir,
                                  lambda path: path.symlink_to("/dev/zero")],
                         ids=["fifo", "folder", "link"])
def test_what_is_no_text_is_not_waited_for(machine, make):
    m, c = machine, machine.client
    assert c.submit(QUICK_JOB, "before", hold=True).code == 0
    assert c.submit(LONG_TEXT, "long").code == 0
    text_file(m, LONG_TEXT).unlink()
    make(text_file(m, LONG_TEXT))
    c.job_where("before", "ready")
    assert c.ask("start").code == 0
    assert "damaged" in c.job_where("long", "fault")["reason"]
    assert m.end("jobs") == 0
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")


def test_a_text_that_came_late_is_signed_by_the_present_clock(machine):
    """What the service told edmctl meanwhile is old when edmctl reads it."""
    m, c = machine, machine.client
    with subprocess.Popen(
            [str(rig.BUILD / "edmctl"), "--machine", m.name, "submit", "-"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE) as p:
        c.hear(3)               # a signature holds for 1.5 s
        p.communicate(QUICK_JOB)
    assert p.returncode == 0
