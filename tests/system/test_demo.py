# SPDX-License-Identifier: Apache-2.0
"""examples/demo: what a signal in the middle of it leaves behind."""

import contextlib
import os
import pathlib
import signal
import subprocess
import time

import pytest
from rig import BUILD, until

ROOT = pathlib.Path(__file__).resolve().parents[2]


def left_of(name, folder):
    shm = [p.name for p in pathlib.Path("/dev/shm").glob(f"edmd.{name}.*")]
    ps = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True,
                        check=True).stdout
    return shm, [x for x in ps.splitlines() if name in x], os.listdir(folder)


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGINT,
                                    signal.SIGTERM])
def test_a_demo_that_is_interrupted_leaves_nothing(tmp_path, number):
    env = {**os.environ, "EDM_BUILD": str(BUILD), "TMPDIR": str(tmp_path)}
    p = subprocess.Popen([ROOT / "examples/demo"], cwd=ROOT, env=env,
                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                         start_new_session=True)
    name = f"demo-{p.pid}"
    try:
        until(lambda: os.path.exists(f"/dev/shm/edmd.{name}.program.1"))
        time.sleep(0.5)
        p.send_signal(number)
        # Long before the job's own end.
        assert p.wait(timeout=30) == 128 + number
        assert left_of(name, tmp_path) == ([], [], [])
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(p.pid, signal.SIGKILL)
        for path in pathlib.Path("/dev/shm").glob(f"edmd.{name}.*"):
            path.unlink()
