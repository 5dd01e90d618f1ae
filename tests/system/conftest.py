# SPDX-License-Identifier: Apache-2.0
import pytest
import rig


@pytest.fixture
def idle(tmp_path):
    """A machine whose programs are not started yet."""
    m = rig.Machine(tmp_path)
    yield m
    m.close()
    if m.edmd or m.jobs:
        assert m.sweep() == [], "left in /dev/shm"


@pytest.fixture
def machine(idle):
    """A machine that stands idle, with no gap: it walks as programmed."""
    idle.start()
    return idle
