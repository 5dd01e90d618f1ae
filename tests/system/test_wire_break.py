# SPDX-License-Identifier: Apache-2.0
"""A wire that is threaded and cut by an operator, and breaks in the cut: the
operator tries again until there is a wire, and the job goes on to its end."""
import pytest
import rig

MACHINE = rig.NULL_MACHINE.replace("backend = null", "backend = sim") + """
[nc]
dialect = fanuc-wire
[gap]
process = wire
wire_retreat_to = {to}
wire_retreat_mm = 0.05
[sim]
process = wire
break_per_j = {often}
rethread_s = 0.5
"""

HOLE_MM, END_MM = 0.2, 0.5
JOB = f"""G90 G01 F60.
G00 X{HOLE_MM}
M60
G01 X{END_MM}
M50
M02
""".encode()


# Some 7 breaks are expected, each with some 5 tries until the wire is threaded.
TRIES = 400
THREAD, CUT = 3, 5      # lines of M60, M50


def stands(c, line, at_mm):
    """It stands with a fault, or at the prompt of this line."""
    while True:
        s = c.status_where(
            lambda s: s.state == s.job_state == "fault" or
            (s.job_state == "held" and s.fault == "none" and
             s.line == line and abs(s.pos_mm[0] - at_mm) < 2e-3), timeout=60)
        if c.status().pos_mm == s.pos_mm:
            return s


@pytest.mark.parametrize("to", ["distance", "hole"])
def test_an_operator_threads_the_wire_until_the_job_is_done(tmp_path, to):
    config = MACHINE.replace("{to}", to).replace("{often}", "1")
    with rig.Machine(tmp_path, config) as m:
        m.start()
        c = m.client
        assert c.submit(JOB, "job").code == 0
        s = stands(c, THREAD, HOLE_MM)
        assert s.job_state == "held"
        assert c.ask("resume").code == 0
        broken_at = []
        while len(broken_at) < TRIES:
            s = stands(c, CUT, END_MM)
            if s.job_state != "fault":
                break
            assert s.fault == "wire-broken"
            broken_at.append(s.pos_mm[0])
            assert HOLE_MM - 2e-3 < s.pos_mm[0] < END_MM
            # A way forward that is refused, as there is no wire, ends at once.
            if to == "hole" and len(broken_at) == 1:
                assert s.pos_mm[0] == pytest.approx(HOLE_MM, abs=2e-3)
            assert c.ask("reset").code == 0
            assert c.ask("start").code == 0
        assert broken_at
        assert s.job_state == "held"
        a = c.ask("resume")
        assert a.code == 0, a.reason
        j = c.job_where("job", "done")
        assert j["path_mm"] == pytest.approx(END_MM, abs=2e-3)
        assert {f["fault"] for f in j["faults"]} == {"wire-broken"}
