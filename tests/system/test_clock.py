# SPDX-License-Identifier: Apache-2.0
"""Somebody sets the host's clock, by a day and by years: what runs goes on, and
queue, history and checkpoint say what they said."""

import os
import subprocess
import time

import pytest
import rig
from rig import QUICK_JOB, SLOW_JOB

DAY = 86400


@pytest.fixture(scope="session")
def shim(tmp_path_factory):
    out = tmp_path_factory.mktemp("shim") / "jumping_clock.so"
    source = os.path.join(os.path.dirname(__file__), "jumping_clock.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(out), source],
                   check=True)
    return out


class Jumping(rig.Machine):
    """A machine whose programs see the time of day that a test says."""

    def __init__(self, folder, shim):
        super().__init__(folder)
        self.shim = shim

    def env(self, program):
        return {"LD_PRELOAD": rig.preload(self.shim),
                "EDM_CLOCK": str(self.folder / "ahead")}

    def ahead(self, seconds):
        new = self.folder / "ahead.new"
        new.write_text(str(seconds))
        new.rename(self.folder / "ahead")


@pytest.fixture
def jumping(tmp_path, shim):
    m = Jumping(tmp_path, shim)
    yield m
    m.close()
    m.sweep()


@pytest.mark.parametrize("seconds", [DAY, -DAY, 3650 * DAY, -3650 * DAY])
def test_a_clock_that_is_set_in_a_cut_changes_nothing(jumping, seconds):
    m = jumping
    m.start()
    c = m.client
    assert c.submit(QUICK_JOB, "before").code == 0
    c.job_where("before", "done")
    assert c.submit(SLOW_JOB, "cut").code == 0
    c.status_where(lambda s: s.job_state == "running" and s.place_mm > 0)
    m.ahead(seconds)
    seen = c.status()
    assert (seen.daemon, seen.store, seen.fault) == ("ok", "ok", "none")
    assert c.submit(QUICK_JOB, "behind").code == 0
    c.job_where("cut", "done")
    c.job_where("behind", "done")
    ahead_s = c.job("behind")["submitted_us"] / 1e6 - time.time()
    assert ahead_s == pytest.approx(seconds, abs=600)
    cut = c.job("cut")
    assert 0 < cut["job_s"] < 600
    assert cut["path_mm"] == pytest.approx(cut["length_mm"])
    # Nothing was forgotten, and nothing is cut again, by the next service
    # either.
    m.kill("jobs")
    m.start_jobs()
    c.status_where(lambda s: s.daemon == "ok" and s.store == "ok")
    for job in ("before", "cut", "behind"):
        assert c.job(job)["state"] == "done"
    assert not c.status().job


@pytest.mark.parametrize("seconds", [DAY, -DAY])
def test_a_clock_that_is_set_between_a_power_cut_and_the_boot(jumping, seconds):
    m = jumping
    m.start()
    c = m.client
    assert c.submit(SLOW_JOB, "cut").code == 0
    place = c.status_where(lambda s: s.job_state == "running" and
                           s.place_mm > 0).place_mm
    c.hear(1.5)
    m.kill("jobs")
    m.kill("edmd")
    m.sweep()
    m.ahead(seconds)
    m.start()
    assert c.status_where(lambda s: s.interrupted).interrupted == "cut"
    cut = c.job("cut")
    assert cut["state"] == "interrupted"
    assert cut["path_mm"] >= place
    assert c.status().state == "idle"
