# SPDX-License-Identifier: Apache-2.0
"""edmctl commission on the simulator, from a machine file with hardly a line to
the first cut.  What the machine is in truth the person knows, not the file."""
import json
import os
import pty
import re
import subprocess
import time

import pytest
from person import Person
from rig import BUILD, Machine

MACHINE = """
[machine]
name = {name}
backend = sim
cpu = -1
overrun_limit = 0
[jobs]
store = {store}
[axis.X]
v_max_mm_s = 60
home_method = switch
home_at_mm = -2
home_slow_mm_s = 2      ; the simulated switch is read once a period
home_fast_mm_s = 20
[axis.Z]
v_max_mm_s = 60
loop_gain_1_s = 30      ; what its loop truly is, by [sim] loops
[sim]
loops = yes
[jump]
v_max_mm_s = 60
""" + "".join(f"[axis.{a}]\npresent = no\n" for a in "YABCUV")

FIRST = "G21 G91\nM3\nG1 Z-0.05 F5\nM30\n"
TRUE_PULSE_MM = {"X": 0.01, "Z": 0.001}


def file_pulse_mm(machine, axis):
    part = machine.config.read_text().split(f"[axis.{axis}]")[1:]
    found = re.findall(r"pulse_mm = (\S+)", "".join(
        p.split("\n[")[0] for p in part))
    return float(found[-1]) if found else 0.001


def restart(machine):
    machine.end("jobs")
    machine.end("edmd")
    machine.start()
    return "done"


def rules(machine):
    """Of a person who looks at a machine whose X has ten times the pitch."""
    def measured(m):
        axis, mm = m.group(1), float(m.group(2))
        true = TRUE_PULSE_MM[axis] / file_pulse_mm(machine, axis)
        return f"{mm * true:.4f}"

    return [
        (r"\[go\]: $", "go"),
        (r"press the e-stop", "none"),
        (r"which way did", "+"),
        (r"(\w) was sent by (\S+); how far", measured),
        (r"is changed: restart", lambda _: restart(machine)),
        (r"homes by itself", "go"), (r"how often", "3"),
        (r"within (\S+) um; what does the dial", lambda m: m.group(1)), (r"set the dial", "yes"),
        (r"estop is not good yet", "next"),
        (r"gap is not good yet", "next"),
        (r"for how many seconds", "1"),
        (r"latency is not good yet", "next"),
        (r"away from the work", "yes"), (r"touch the work", "yes"),
        (r"a short program", str(machine.folder / "first.ngc")),
        (r"\[yes\]: ", "yes"), (r"not good yet \[again\]", "again"),
        (r"\[no\]: ", "go"),
    ]


def commission(machine, *more):
    return Person([BUILD / "edmctl", "--machine", machine.name, "--timeout",
                   "18", "commission", machine.config, *more], rules(machine))


def kept(machine):
    return json.loads(
        (machine.folder / "machine.ini.commission").read_text())


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("commission")
    (folder / "first.ngc").write_text(FIRST)
    with Machine(folder, MACHINE) as machine:
        real = folder / "real.ini"          # the machine file may be a link
        machine.config.rename(real)
        real.chmod(0o640)
        machine.config.symlink_to(real)
        machine.start()
        person = commission(machine)
        code = person.run()
        print(person.told())
        yield machine, person, code


def test_a_new_machine_is_walked_to_its_first_cut(walked):
    machine, person, code = walked
    steps = kept(machine)
    for name in ("power X", "direction X", "scale X", "scale Z", "home X",
                 "following Z", "backlash X", "cut"):
        assert steps[name]["good"], (name, steps[name])
    assert steps["estop"]["said"].startswith("there is no e-stop")
    assert code == 1            # the e-stop is still wrong


def test_a_scale_that_is_ten_times_off_is_corrected(walked):
    machine, person, _ = walked
    assert file_pulse_mm(machine, "X") == pytest.approx(0.01, rel=1e-3)
    assert "X goes 10 times as far as it is sent" in person.told()
    assert "; the simulated switch" in machine.config.read_text()
    assert machine.config.is_symlink()
    assert machine.config.stat().st_mode & 0o777 == 0o640


def test_how_an_axis_follows_is_measured_and_kept(walked):
    machine, person, _ = walked
    step = kept(machine)["following Z"]
    found = re.search(r"bandwidth is (\S+) Hz; the gain of its loop is (\S+) ",
                      step["said"])
    assert found, step["said"]
    # 30 / (2 pi), and a little more by the velocity loop.
    assert 4.5 < float(found.group(1)) < 6.5
    assert float(found.group(2)) == pytest.approx(30, rel=0.05)
    wrote = " ".join(step["wrote"])
    assert "[axis.Z] loop_gain_1_s = " in wrote and "loop_hz" in wrote
    assert "what comes of 1 2 4 8 Hz, %" in step["plot"]
    assert kept(machine)["latency"]["said"].count("cyclictest") == 1


def test_nothing_moves_without_an_answer(walked):
    _, person, _ = walked
    moves = [q for q in person.asked if re.search(r"moves by .*\[no\]: ", q)]
    assert len(moves) > 10 and all(q.endswith("go") for q in moves)


def test_the_report_has_every_step_and_pictures(walked):
    machine, _, _ = walked
    page = (machine.folder / "machine.ini.commission.html").read_text()
    for name in kept(machine):
        assert f"<th>{name}<td>" in page
    assert page.count("<polyline") > 4
    assert "nan" not in page and "inf" not in page


def test_the_walk_is_left_and_gone_on_with(walked):
    machine, _, _ = walked
    before = kept(machine)
    person = Person([BUILD / "edmctl", "--machine", machine.name, "commission",
                     machine.config, "again", "backlash X"],
                    [(r"estop: ", "skip"), (r"backlash X: ", "end")])
    assert person.run() == 1
    assert [re.search(r"\n(\w+ ?\w?): ", q).group(1)
            for q in person.asked if "[go]: " in q] == ["estop", "backlash X"]
    assert kept(machine) == before          # nothing was done


def test_the_file_of_another_machine_is_refused(walked, tmp_path):
    machine, _, _ = walked
    other = tmp_path / "other.ini"
    other.write_text(machine.config.read_text().replace(
        f"name = {machine.name}", "name = other"))
    p = machine.ctl("commission", str(other))
    assert p.returncode == 64 and "is the machine 'other'" in p.stderr
    assert not (tmp_path / "other.ini.commission").exists()


def test_an_axis_moves_while_the_key_is_held_and_no_longer(walked):
    """On a terminal, which repeats a key that is held."""
    machine, _, _ = walked
    ours, theirs = pty.openpty()
    p = subprocess.Popen(
        [BUILD / "edmctl", "--machine", machine.name, "commission",
         machine.config, "again", "following Z"], stdin=theirs,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def until(text):
        seen = b""
        while text not in seen:
            c = p.stderr.read(1)
            assert c, seen
            seen += c

    def place():
        return machine.client.status_where(lambda s: True).pos_mm[2]

    try:
        until(b"estop: ")
        os.write(ours, b"skip\n")
        until(b"following Z: ")
        os.write(ours, b"go\n")
        until(b"another key: not\n")
        before = place()
        time.sleep(0.5)
        assert place() == before            # no key, no motion
        for _ in range(100):                # held, until it has moved
            os.write(ours, b" ")
            if abs(place() - before) > 0.1:
                break
        machine.client.status_where(lambda s: s.state == "idle")
        stood = place()
        assert 0.1 < abs(stood - before) < 4.9  # 5 mm were to come
        time.sleep(0.3)
        assert place() == pytest.approx(stood, abs=0.002)   # its lag
    finally:
        p.kill()
        p.wait()
        os.close(ours)
        os.close(theirs)


def test_homing_ends_when_the_key_is_let_go(walked):
    machine, _, _ = walked
    assert machine.ctl("jog", "X", "30", "--wait").returncode == 0
    ours, theirs = pty.openpty()
    p = subprocess.Popen(
        [BUILD / "edmctl", "--machine", machine.name, "commission",
         machine.config, "again", "home X"], stdin=theirs,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        for text, answer in ((b"estop: ", b"skip\n"), (b"home X: ", b"go\n"),
                             (b"by itself [no]", b"go\n"),
                             (b"how often", b"1\n"), (b"not\n", b" ")):
            seen = b""
            while text not in seen:
                c = p.stderr.read(1)
                assert c, seen
                seen += c
            os.write(ours, answer)
        machine.client.status_where(lambda s: s.state == "home")
        machine.client.status_where(lambda s: s.state == "idle")
        assert p.stdout.readline() == \
            b"WRONG: X was not homed to its end\n"
        assert machine.client.status_where(lambda s: True).pos_mm[0] > 0
    finally:
        p.kill()
        p.wait()
        os.close(ours)
        os.close(theirs)


def test_a_step_that_is_not_there_is_refused(walked):
    machine, _, _ = walked
    p = machine.ctl("commission", str(machine.config), "again", "dance")
    assert p.returncode == 64 and "no step 'dance'; one of estop" in p.stderr
    p = machine.ctl("commission", "/nonexistent/machine.ini")
    assert p.returncode == 78 and "a machine file" in p.stderr
