# SPDX-License-Identifier: Apache-2.0
import os
import subprocess

import panel
import pytest
import rig

# A simulated machine whose switches lie 7.5 mm from where its pulses say.
HOME_MACHINE = """
[machine]
name = {name}
backend = sim
overrun_limit = 0
cpu = -1
require_home = yes

[sim]
home_off_mm = 7.5
speed = 4

[axis.X]
home_method = switch
home_at_mm = -20
home_fast_mm_s = 20
home_slow_mm_s = 2
backlash_um = 30

[axis.Z]
home_method = switch-index
home_dir = +
home_at_mm = 20
home_fast_mm_s = 20
home_slow_mm_s = 2
home_order = 1

[jobs]
store = {store}
"""


@pytest.fixture
def idle(tmp_path):
    """A machine whose programs are not started yet."""
    with rig.Machine(tmp_path) as m:
        yield m


@pytest.fixture
def machine(idle):
    """A machine that stands idle, with no gap: it walks as programmed."""
    idle.start()
    return idle


@pytest.fixture
def homing(tmp_path):
    """A machine that must be homed; its programs are not started yet."""
    with rig.Machine(tmp_path, HOME_MACHINE) as m:
        yield m


@pytest.fixture(scope="module")
def p(tmp_path_factory):
    """A panel with its machine, both started."""
    p = panel.Panel(tmp_path_factory.mktemp("panel"))
    p.start()
    yield p
    p.close()


@pytest.fixture(scope="session")
def shim(tmp_path_factory):
    """The preloaded library that lets a folder's disk fail."""
    out = tmp_path_factory.mktemp("shim") / "failing_disk.so"
    source = os.path.join(os.path.dirname(__file__), "failing_disk.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(out), source,
                    "-ldl"], check=True)
    return out
