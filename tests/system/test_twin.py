# SPDX-License-Identifier: Apache-2.0
"""The twin beside the machine: contour error, measured and predicted."""
import json

import rig

LOOPS = """
[axis.X]
loop_gain_1_s = 30
[axis.Y]
loop_gain_1_s = 15
"""

ROUND = b"""G21 G90 G17
M3
G1 X5 F600
G3 X5 Y0 I-5 J0
G3 X5 Y0 I-5 J0
M2
"""


def test_status_shows_what_is_measured_beside_what_is_predicted(tmp_path):
    with rig.Machine(tmp_path, rig.NULL_MACHINE + LOOPS) as m:
        m.start()
        c = m.client
        assert c.submit(ROUND, "job").code == 0
        # Axes that follow at once; models that lag by 0.33 and 0.67 mm.
        s = c.status_where(lambda s: s.contour_predicted_mm > 0.1, 10)
        assert 0 <= s.contour_mm < 0.005
        assert s.contour_predicted_mm < 0.5
        told = json.loads(m.ctl("status", "--json").stdout)
        assert told["contour_predicted_um"] > 100
        assert "predicted" in m.ctl("status").stdout
        c.job_where("job", "done", 20)


def test_without_loops_there_is_no_twin(machine):
    s = machine.client.status()
    assert (s.contour_mm, s.contour_predicted_mm) == (-1, -1)
    assert "contour_um" not in json.loads(
        machine.ctl("status", "--json").stdout)
