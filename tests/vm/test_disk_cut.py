# SPDX-License-Identifier: Apache-2.0
"""The power fails between two writes of the disk, and what its cache had is
lost.

QEMU logs every write and flush of the guest's disk in the format of the
kernel's dm-log-writes.  Each cut makes the disk anew as it may have been at one
instant: all that was flushed, and of what was written after the last flush a
random part, the last write of it torn.  The store on that disk must be readable,
and must know of the job what it knew before.

EDM_SEED and EDM_CUTS choose other and more cuts.
"""

import os
import random
import shutil
import struct
import subprocess
import sys

import pytest
from power import Power
from test_torture import JOBS, MACHINE
from boot import ABSENT, ROOT

sys.path.insert(0, str(ROOT / "tests/system"))
import rig  # noqa: E402

SEED = int(os.environ.get("EDM_SEED", "1"))
CUTS = int(os.environ.get("EDM_CUTS", "12"))
SECTOR = 512
FLUSH, FUA, DISCARD, MARK = 1, 2, 4, 8
NAME = f"disk{os.getpid()}"


def log_of(path):
    """Its entries: first sector, flags, data."""
    data = path.read_bytes()
    magic, version, _, sector = struct.unpack_from("<QQQI", data)
    assert (magic, version, sector) == (0x6a736677736872, 1, SECTOR)
    at = SECTOR
    # Its head counts them only now and then.
    while at + SECTOR <= len(data):
        first, sectors, flags, size = struct.unpack_from("<4Q", data, at)
        if not (sectors or flags):
            break
        at += SECTOR
        length = 0 if flags & DISCARD else sectors * SECTOR
        yield first, flags, data[at:at + length], sectors
        at += length


def put(disk, entry, sectors=None):
    first, flags, data, count = entry
    if flags & DISCARD:
        data = bytes(count * SECTOR)
    if sectors is not None:
        data = data[:sectors * SECTOR]
    disk[first * SECTOR:first * SECTOR + len(data)] = data


def cut_at(before, log, n, dice):
    """The disk @before, when @log was written up to entry @n."""
    disk = bytearray(before)
    safe = max((i + 1 for i, e in enumerate(log[:n]) if e[1] & FLUSH),
               default=0)
    for entry in log[:safe]:
        put(disk, entry)
    # An entry that went by the cache is safe too.
    for i, entry in enumerate(log[safe:n], safe):
        if entry[1] & FUA or dice.random() < 0.5:
            torn = i == n - 1 and not entry[1] & (FUA | DISCARD)
            put(disk, entry, dice.randint(0, entry[3]) if torn else None)
    return safe, disk


def store_on(disk, folder):
    """The files of the store, after the file system's own journal."""
    image = folder / "image"
    image.write_bytes(disk)
    done = subprocess.run(["/sbin/e2fsck", "-fy", image], capture_output=True)
    assert done.returncode in (0, 1), done.stdout
    subprocess.run(["/sbin/debugfs", "-R", f"rdump /store {folder}", image],
                   check=True, capture_output=True)
    (folder / "store").mkdir(exist_ok=True)
    image.unlink()


def found(folder):
    """What edmd-jobs makes of it: the job, or None."""
    m = rig.Machine(folder)
    m.name, m.client = NAME, rig.Client(NAME)
    m.config.write_text(MACHINE.replace("name = vm", f"name = {NAME}") +
                        ABSENT + f"[jobs]\nstore = {m.store}\n")
    try:
        m.start()
        # It takes a moment to see that another edmd is there.
        m.client.status_where(lambda s: s.job_state != "running", 10)
        assert m.client.status().store == "ok"
        job = m.client.job("cut")
    finally:
        m.end("jobs")
        m.end("edmd")
        m.sweep()
    said = (folder / "edmd-jobs.log").read_text()
    for word in ("set aside", "recovered", "malformed", "unreadable"):
        assert word not in said, said
    return job


def way(job):
    """How far it came; one that waits has no place."""
    return job["path_mm"] or 0


@pytest.fixture(scope="module")
def run(guest):
    """A job that is interrupted, and goes on to its end."""
    p = Power(guest, "disk", {
        "torture.ini": MACHINE.replace("name = vm", f"name = {NAME}") + ABSENT,
        "job.ngc": JOBS["cuts"], "next.ngc": JOBS["curve"]})
    turns = []
    for kill_after_s in (4, None):
        before = p.disk.read_bytes()
        log = p.folder / f"log.{p.turn}"
        with open(log, "wb") as f:
            f.truncate(64 << 20)
        p.boot(kill_after_s, log)
        turns.append((before, list(log_of(log))))
        log.unlink()
    return turns


def test_no_cut_of_the_disk_leaves_a_store_that_cannot_be_read(run, tmp_path):
    dice = random.Random(SEED)
    print(f"EDM_SEED={SEED}")
    states, flushed, path, was = set(), 0, 0, None
    for turn, (before, log) in enumerate(run):
        flushes = sum(e[1] & FLUSH for e in log)
        assert flushes > 20, f"{flushes} flushes"
        print(f"{len(log)} writes and flushes, {flushes} of them flushes")
        flushed = 0
        for n in sorted(dice.sample(range(len(log) + 1), CUTS // 2)):
            safe, disk = cut_at(before, log, n, dice)
            folder = tmp_path / f"{turn}-{n}"
            folder.mkdir()
            store_on(disk, folder)
            job = found(folder)
            # A flush later it knows at least what it knew here.
            if safe >= flushed and was:
                assert job, f"turn {turn}, entry {n}: the job is gone"
                assert way(job) >= path - 1e-6, (turn, n, path, job)
            flushed = n
            if job:
                was, path = job, way(job)
                states.add(job["state"])
                assert job["state"] in ("ready", "queued", "interrupted",
                                        "done"), job
            shutil.rmtree(folder)
    assert "interrupted" in states, states
