# SPDX-License-Identifier: Apache-2.0
"""A job whose work system is turned: edmd is killed in the cut, the host loses
its power, and the operator turns the system otherwise before it goes on."""

import math
import sqlite3

import pytest
import rig
from test_again import interrupted, resume
from test_power import die

TURN_DEG, AT = 30, (3, -2)
TURN_ROW = 8
# Out along X of the system, then along Y: 4 mm at 60 mm/min.
CUT = (b"G21 G90 G55 T84 M3\nG0 Z2\nG0 X0 Y0\nG0 Z0\nG1 X2 F60\nG1 Y2\nG0 Z2\n"
       b"M30\n")
TURNS = CUT.replace(b"G55", b"G10 L2 P2 X3 Y-2 R30\nG55")


def place(x, y, deg=TURN_DEG):
    c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    return AT[0] + c * x - s * y, AT[1] + s * x + c * y


def turn(m, deg):
    """What `edmctl offset` keeps of a skew."""
    with sqlite3.connect(m.store / f"{m.name}.db") as db:
        for row, value in ((0, AT[0]), (1, AT[1]), (TURN_ROW, deg)):
            db.execute("INSERT OR REPLACE INTO work VALUES (0, 1, ?, ?)",
                       (row, value))
    db.close()


def is_at(m, x, y):
    assert m.client.status().pos_mm[:2] == pytest.approx(place(x, y),
                                                         abs=2e-3)


def ready(m, text):
    m.start()
    die(m)
    if text is CUT:
        turn(m, TURN_DEG)


@pytest.mark.parametrize("text", [CUT, TURNS], ids=["kept", "written"])
def test_edmd_is_killed(idle, text):
    m, c = idle, idle.client
    ready(m, text)
    m.start()
    assert c.submit(text, "cut").code == 0
    c.status_where(lambda s: s.place_mm > 8.5, 20)
    held = m.come_back(lambda s: s.job_state == "held")
    assert (held.work, held.work_turn_deg) == ("G55", TURN_DEG)
    assert held.pos_mm[:2] == pytest.approx(place(*held.work_mm[:2]), abs=1e-3)
    assert c.ask("start").code == 0
    c.job_where("cut", "done", 30)
    is_at(m, 2, 2)


@pytest.mark.parametrize("text", [CUT, TURNS], ids=["kept", "written"])
@pytest.mark.parametrize("touched", [False, True], ids=["as-was", "turned"])
def test_the_power_fails(idle, text, touched):
    """It goes on as it began, whatever the table says now."""
    m, c = idle, idle.client
    ready(m, text)
    interrupted(m, c, 9.5, text)
    if touched:
        die(m)
        turn(m, -45)
        m.start()
        c.status_where(lambda s: s.interrupted == "cut", 10)
    resume(c)
    assert c.ask("start").code == 0
    c.job_where("cut", "done", 30)
    is_at(m, 2, 2)
