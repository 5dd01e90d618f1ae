# SPDX-License-Identifier: Apache-2.0
"""A wire machine tells which pass is cut, and how far the wire is beside it."""
import rig

MACHINE = rig.NULL_MACHINE + """
[wire]
guides = absolute
z_lower_mm = -20
z_upper_mm = 80
z_program_mm = 0
z_second_mm = 40
angle_max_deg = 30
"""

JOB = b"""G90 F600
H1=0.2 H2=0.15
G150 H1 F600
G150 H2 F600
G151 P100 X10 Y10
G152
M30
O100
G41 G1 X10 Y5
X15
Y15
X5
Y5
X10
G40 Y10
M99
"""


def test_status_tells_the_pass_and_its_offset(tmp_path):
    with rig.Machine(tmp_path, MACHINE) as m:
        m.start()
        c = m.client
        assert c.submit(JOB, "plate").code == 0
        told = {}
        while c.job("plate")["state"] not in ("done", "fault"):
            s = c.status_where(lambda s: True, timeout=20)
            if s.job == "plate" and s.wire_pass and s.wire_pass not in told:
                told[s.wire_pass] = (s.wire_passes, round(s.wire_offset_mm, 6))
                out = m.ctl("status").stdout
                assert "pass       " in out and " of 2, offset 0." in out, out
            if s.stand:
                c.ask("done")
                c.ask("start")
        assert told == {1: (2, 0.2), 2: (2, 0.15)}
        assert c.job("plate")["state"] == "done"
        # Behind it there is none.
        s = c.status_where(lambda s: not s.job, 10)
        assert (s.wire_pass, s.wire_offset_mm) == (0, 0)
