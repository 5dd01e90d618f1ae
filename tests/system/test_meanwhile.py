# SPDX-License-Identifier: Apache-2.0
"""What is asked while a job is on its way into edmd, and what is read again by a
service that comes.

Nothing here waits for a time: edmd opens a program when the test lets it, and
what its PLC would say is written when the test wants it."""

import errno
import os
import pathlib
import subprocess

import pytest
import rig
from rig import QUICK_JOB, until

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parents[1]


class Gated(rig.Machine):
    """Its edmd stands where it opens a program, until open() is called."""

    def __init__(self, folder, shim):
        super().__init__(folder)
        self.shim, self.gate = shim, self.folder / "gate"
        os.mkfifo(self.gate)

    def env(self, program):
        return {"LD_PRELOAD": rig.preload(self.shim),
                "EDM_GATE": str(self.gate)} if program == "edmd" else {}

    def is_asked(self):
        """Does edmd stand there?  Return: the way on, or None."""
        try:
            return os.open(self.gate, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as e:
            assert e.errno == errno.ENXIO
            return None

    def open(self, way):
        self.gate.unlink()
        os.close(way)


@pytest.fixture
def gated(tmp_path):
    shim = tmp_path / "gate.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", shim, HERE / "gate.c",
                    "-ldl"], check=True)
    with Gated(tmp_path, shim) as m:
        m.start()
        yield m


def test_a_job_on_its_way_into_edmd_is_not_removed_and_that_is_said(gated):
    c = gated.client
    assert c.submit(QUICK_JOB, "job", hold=True).code == 0
    way = until(gated.is_asked)
    a = c.ask("remove", "job")
    assert a.code == 1 and "it is just being loaded" in a.reason
    assert c.job("job")["state"] == "queued"
    gated.open(way)
    c.job_where("job", "ready")
    assert c.ask("remove", "job").code == 0
    c.job_where("job", "stopped")


@pytest.fixture
def select(tmp_path, machine):
    """The PLC of the machine selects a job by its number."""
    tool = tmp_path / "select_job"
    subprocess.run(
        ["cc", "-D_GNU_SOURCE", "-o", tool, HERE / "select_job.c",
         *(ROOT / "daemon/shm").glob("*.c"), rig.BUILD / "common.a",
         *(f"-I{ROOT / d}" for d in ("daemon/shm", "daemon/words", "common",
                                     "libinterp/core/include"))], check=True)
    return lambda n: subprocess.run(
        [tool, f"/dev/shm/edmd.{machine.name}.status", str(n)], check=True)


def test_a_selection_is_followed_once(machine, select):
    c = machine.client
    for job in "one", "two":
        assert c.submit(QUICK_JOB, job, hold=True).code == 0
    c.job_where("one", "ready")
    select(2)
    c.job_where("two", "ready")
    log = machine.folder / "edmd-jobs.log"
    # A kill takes what its thread has not written yet.
    until(lambda: "is selected to be next" in log.read_text())
    for _ in range(2):
        machine.kill("jobs")
        machine.start_jobs()
        c.status_where(lambda s: s.daemon == "ok" and s.job == "two")
    # Behind what it has read again.
    select(1)
    c.job_where("one", "ready")
    until(lambda: log.read_text().count("job one ready") == 2)
    assert log.read_text().count("is selected to be next") == 2
