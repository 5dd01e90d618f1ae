# SPDX-License-Identifier: Apache-2.0
"""Lines carried out at once, and work offsets that are touched off."""

import json

import pytest
import rig
from test_power import die
from test_probe_restart import BLOCK_MACHINE

CUT = b"G21 G90 G54\nG1 X1 F60\nG1 X3\nM2\n"


def said(p):
    return p.returncode, p.stdout + p.stderr


def places(m):
    return json.loads(m.ctl("--json", "status").stdout)["pos_mm"]


def offsets(m):
    p = m.ctl("--json", "offset")
    assert p.returncode == 0, p.stderr
    return {row["work"]: {k: v for k, v in row.items() if k != "at_mm"}
            for row in json.loads(p.stdout)}


# -- MDI


def test_lines_are_carried_out_at_once_and_are_in_the_history(machine):
    code, text = said(machine.ctl("mdi", "G0 X5"))
    assert code == 0 and "mdi: G0 X5: done" in text, text
    assert places(machine)[0] == pytest.approx(5)
    code, text = said(machine.ctl("mdi", "g91 g0 x-1.5", "g90 g0 y2"))
    assert code == 0, text
    assert places(machine)[:2] == pytest.approx((3.5, 2))
    names = [x["name"] for x in json.loads(machine.ctl(
        "--json", "history").stdout)]
    assert names == ["mdi: g91 g0 x-1.5", "mdi: G0 X5"]


def test_what_is_not_understood_moves_nothing(machine):
    for text, says in (("G0 X5000", "1:4: X 5000.0000 is beyond the travel"),
                       ("G0 X5\nG7 X1", "2:1: unknown word G7"),
                       ("", "empty program"), ("(nothing)", "empty program"),
                       ("G1 X1", "no feed given yet"),
                       ("M98 P1 L99999999\nM2\nO1\nM99", ""),
                       ("M98 P1 L99\nM2\nO1\nG91 F1 G5 X1 Y0 I50 J90 P-50 Q90"
                        "\nG1 X-1\nM99", "lattice points together"),
                       ("G0 X1 " + 4000 * " ", "4000 bytes at most"),
                       (5000 * " ", "more than 4095 bytes")):
        code, out = said(machine.ctl("mdi", text))
        assert code == 65 and says in out, (text, out)
    assert places(machine)[0] == 0
    assert machine.ctl("history").stdout == "none\n"
    assert machine.ctl("mdi").returncode == 64


def test_a_machine_that_is_not_idle_refuses_with_the_reason(machine):
    c = machine.client
    c.submit(CUT, "a", hold=True)
    c.job_where("a", "ready")
    code, out = said(machine.ctl("mdi", "G0 X1"))
    assert code == 1 and "not now: a job is loaded; edmctl stop" in out
    c.ask("start")
    c.status_where(lambda s: s.job_state == "running")
    assert said(machine.ctl("mdi", "G0 X1"))[0] == 1
    c.ask("estop")
    code, out = said(machine.ctl("mdi", "G0 X1"))
    assert code == 1 and "a fault is latched" in out
    c.ask("reset"), c.ask("stop")
    c.job_where("a", "stopped")
    c.status_where(lambda s: s.state == "idle" and not s.job)
    assert machine.ctl("mdi", "G0 X1").returncode == 0
    machine.kill("edmd")
    c.status_where(lambda s: s.daemon != "ok", timeout=10)
    code, out = said(machine.ctl("mdi", "G0 X1"))
    assert code == 1 and "edmd is not there" in out
    machine.start_edmd()
    c.status_where(lambda s: s.daemon == "ok")


def test_a_line_with_nothing_in_it_is_no_job_with_an_electrode_either(machine):
    assert machine.ctl("electrode", "add", "3").returncode == 0
    assert machine.ctl("electrode", "use", "3").returncode == 0
    for text in ("", " ", "M30"):
        code, out = said(machine.ctl("mdi", text))
        assert code == 65 and "empty program" in out, out
    assert machine.ctl("history").stdout == "none\n"


def test_it_wants_an_operator_and_is_done_once(machine):
    c = machine.client
    assert c.ask("mdi", text="G91\nG0 X1").code == 0
    seq = c.seq
    c.status_where(lambda s: s.pos_mm[0] == 1 and s.state == "idle")
    c.send_command("mdi", seq=seq, text="G91\nG0 X1")
    c.hear(1)
    assert places(machine)[0] == 1
    # A service that is started anew knows it, too.
    machine.kill("jobs")
    machine.start_jobs()
    c.status_where(lambda s: s.daemon == "ok")
    c.send_command("mdi", seq=seq, text="G91\nG0 X1")
    c.hear(1)
    assert places(machine)[0] == 1


def test_what_controls_a_terminal_does_not_come_back(machine):
    p = machine.ctl("mdi", "(\x1b]0;title\x07\u202e) G0 X1")
    assert p.returncode == 0 and "\x1b" not in p.stdout
    (job,) = json.loads(machine.ctl("--json", "history").stdout)
    assert job["name"].isascii() and job["name"].startswith("mdi: (?]0;title?")


# -- Offsets


def test_an_offset_is_touched_off_kept_and_taken_back(machine):
    m = machine
    assert m.ctl("mdi", "G0 X10 Y4").returncode == 0
    assert m.ctl("offset", "G54", "X=0", "y=-2").returncode == 0
    assert m.ctl("offset", "g59.3", "Z@-12.5").returncode == 0
    o = offsets(m)
    assert (o["G54"]["X"], o["G54"]["Y"], o["G54"]["touched"]) == (10, 6, "XY")
    assert (o["G59.3"]["Z"], o["G59.3"]["touched"]) == (-12.5, "Z")
    assert o["G55"]["touched"] == ""
    m.kill("jobs")
    m.start_jobs()
    m.client.status_where(lambda s: s.daemon == "ok")
    assert offsets(m) == o
    assert m.ctl("mdi", "G54 G0 X1 Y0").returncode == 0
    assert places(m)[:2] == pytest.approx((11, 6))
    assert m.ctl("mdi", "G59.3 G0 Z0").returncode == 0
    assert places(m)[2] == pytest.approx(-12.5)
    text = m.ctl("offset").stdout
    assert "G54    X     10.0000* Y      6.0000* Z      0.0000 " in text
    assert m.ctl("offset", "G54", "clear").returncode == 0
    assert offsets(m)["G54"]["touched"] == ""
    assert m.ctl("mdi", "G0 X1 Y0").returncode == 0
    assert places(m)[:2] == pytest.approx((1, 0))


def test_the_machine_file_s_stay_where_nothing_was_touched_off(idle):
    with open(idle.config, "a") as f:
        f.write("[work.G55]\nx = 3\ny = 4\n")
    idle.start()
    assert idle.ctl("offset", "G55", "X@7").returncode == 0
    o = offsets(idle)["G55"]
    assert (o["X"], o["Y"], o["touched"]) == (7, 4, "X")
    assert idle.ctl("mdi", "G55 G0 X0 Y0").returncode == 0
    assert places(idle)[:2] == pytest.approx((7, 4))


def test_g10_agrees_with_it_and_ends_with_its_program(machine):
    m = machine
    assert m.ctl("mdi", "G0 X10").returncode == 0
    # Both ways say: here is X2.  Then X0 is at 8.
    assert m.ctl("mdi", "G10 L20 P2 X2", "G55 G0 X0").returncode == 0
    assert places(m)[0] == pytest.approx(8)
    assert offsets(m)["G55"]["X"] == 0
    assert m.ctl("mdi", "G0 X10").returncode == 0
    assert m.ctl("offset", "G55", "X=2").returncode == 0
    assert m.ctl("mdi", "G55 G0 X0").returncode == 0
    assert places(m)[0] == pytest.approx(8)
    # Under G91, G10 L2 begins from what was touched off.
    assert m.ctl("mdi", "G91 G10 L2 P2 X1", "G90 G55 G0 X0").returncode == 0
    assert places(m)[0] == pytest.approx(9)


@pytest.mark.parametrize("words, says", [
    (("G53", "X=0"), "'G53'; a system, G54 to G59.3"), (("G54",), "'G54'"),
    (("G54", "Q=0"), "'Q=0'"), (("G54", "X=zero"), "'X=zero'"),
    (("G54", "X=0", "X@1"), "'X@1'"), (("G54", "X=nan"), "'X=nan'"),
    (("G54", "X=0", "Z=probe"), "one axis at a time"),
    (("G54", "C=probe"), "'C=probe'"),
    (("G54", "X=probe"), "'X=probe'"), (("G54", "Z=probe*"), "'Z=probe*'"),
    (("G54", "X=1e300"), "'X=1e300'"), (("G54", 70 * "X"), "'XXXX"),
])
def test_what_cannot_be_is_refused(machine, words, says):
    code, out = said(machine.ctl("offset", *words))
    assert code == 65 and says in out, out
    assert all(r["touched"] == "" for r in offsets(machine).values())


def test_a_job_goes_on_with_the_offsets_of_its_beginning(machine):
    m, c = machine, machine.client
    assert m.ctl("offset", "G54", "X@1").returncode == 0
    c.submit(CUT, "a")
    c.status_where(lambda s: s.pos_mm[0] > 2.5)
    # A job that waits gets those of the time when its turn comes.
    c.submit(b"G21 G90 G54\nG0 X0\nM2\n", "b")
    code, out = said(m.ctl("offset", "G54", "X@5"))
    assert code == 1 and "a job is loaded" in out
    die(m)
    m.start()
    c.job_where("a", "interrupted")
    assert m.ctl("offset", "G54", "X@-3").returncode == 0
    r = m.ctl("resume", "a", "XYZABCUV")
    assert r.returncode == 0, r.stderr
    c.job_where("a", "ready")
    assert m.ctl("start").returncode == 0
    c.job_where("a", "done")
    # Where it ended: 3 from the origin of its beginning.
    assert any(abs(s.pos_mm[0] - 4) < 1e-3 for s in c.statuses)
    c.job_where("b", "done", timeout=20)
    assert places(m)[0] == pytest.approx(-3)


def test_an_axis_feels_for_its_origin(tmp_path):
    with rig.Machine(tmp_path, BLOCK_MACHINE) as m:
        m.start()
        code, out = said(m.ctl("offset", "G55", "Z=probe"))
        assert code == 0 and "touch off G55 Z=probe: done" in out, out
        o = offsets(m)["G55"]
        assert o["touched"] == "Z" and o["Z"] == pytest.approx(-1.5, abs=2e-3)
        assert m.ctl("mdi", "G55 G0 Z0.75").returncode == 0
        assert places(m)[2] == pytest.approx(-0.75, abs=2e-3)
        # Upward there is nothing.
        code, out = said(m.ctl("offset", "G56", "Z=probe+0.5"))
        assert code == 1 and "no-contact" in out, out
        assert offsets(m)["G56"]["touched"] == ""


def test_the_electrode_s_length_is_not_counted_twice(machine):
    m = machine
    assert m.ctl("electrode", "add", "1", "length=20").returncode == 0
    assert m.ctl("electrode", "use", "1").returncode == 0
    assert m.ctl("mdi", "G53 G0 Z30").returncode == 0
    assert m.ctl("offset", "G54", "Z=5").returncode == 0
    assert offsets(m)["G54"]["Z"] == pytest.approx(5)
    assert m.ctl("mdi", "G0 Z6").returncode == 0
    assert places(m)[2] == pytest.approx(31)
