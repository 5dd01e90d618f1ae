# SPDX-License-Identifier: Apache-2.0
"""edmctl: what it prints and what it exits with."""

import fcntl
import json
import os
import pty
import signal
import subprocess
import time
from contextlib import contextmanager

import pytest
from rig import BUILD, NULL_MACHINE, QUICK_JOB, SLOW_JOB, Machine, until


def write(machine, name, text):
    path = machine.folder / name
    path.write_bytes(text)
    return str(path)


def test_submit_wait_exits_0_and_reports(machine):
    p = machine.ctl("submit", write(machine, "q.ngc", SLOW_JOB), "--wait")
    assert p.returncode == 0, p.stderr
    assert "job q.ngc: done" in p.stdout
    assert "path       2.000 mm" in p.stdout
    for word in ("depth", "time", "jumps", "retracts", "shorts"):
        assert word in p.stdout


def test_submit_from_standard_input(machine):
    p = machine.ctl("--json", "submit", "-", "--name", "piped", "--wait",
                    input=QUICK_JOB.decode())
    assert p.returncode == 0, p.stderr
    job = json.loads(p.stdout)
    assert (job["name"], job["state"]) == ("piped", "done")


def test_a_big_job_gets_there_whole(machine):
    text = b"G21 G90 F600\n" + b"(%s)\n" % (b"x" * 99) * 30000 + QUICK_JOB
    p = machine.ctl("submit", write(machine, "big.ngc", text), "--wait")
    assert p.returncode == 0, p.stderr


def test_refused_code_is_told_with_file_line_and_column(machine):
    path = write(machine, "bad.ngc", b"G21\nG1 X5 Q7\n")
    p = machine.ctl("submit", path, "--name", "other")
    assert p.returncode == 65
    assert p.stderr.startswith(f"{path}:2:7: error: ")
    assert ";" in p.stderr


SLOT = b"""G90 F6000
H1=0.125
G0 X5 Y-2
G42 H1
G1 X5 Y0
X10
Y5
X6
Y4
X5.8
Y5
X0
Y0
X5
G40 Y-2
M2
"""


def test_what_is_cut_otherwise_than_written_is_told(idle):
    with open(idle.config, "a") as f:
        f.write("\n[wire]\ngouge = skip\n")
    idle.start()
    told = "slot.ngc:9: note: what lies between the motions of lines 9 and 11 " \
        "is too narrow for the wire and is left out (gouge = skip)"
    p = idle.ctl("submit", write(idle, "slot.ngc", SLOT), "--wait")
    assert p.returncode == 0, p.stderr
    assert told in p.stderr.splitlines(), p.stderr
    c = idle.client
    events = c.heard(lambda: [e for e in c.events if e.kind == "note"])
    assert [e.text for e in events] == [told]
    p = idle.ctl("show", events[0].job)
    assert "notes      " + told in p.stdout.splitlines(), p.stdout


def test_input_that_is_not_there(machine):
    assert machine.ctl("submit", "/no/such/file").returncode == 66
    assert machine.ctl("submit", str(machine.folder)).returncode == 66
    p = machine.ctl("submit", write(machine, "empty.ngc", b""))
    assert p.returncode == 65
    assert "empty" in p.stderr


@contextmanager
def slow_job_waited_for(machine):
    """edmctl submit --wait, with its job under way."""
    path = write(machine, "slow.ngc", SLOW_JOB)
    with subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "submit", path,
         "--wait"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as p:
        machine.client.status_where(lambda s: s.place_mm > 0.3)
        yield p


def test_a_job_that_is_stopped_exits_1(machine):
    with slow_job_waited_for(machine) as p:
        assert machine.ctl("hold").returncode == 0
        machine.client.status_where(lambda s: s.state == "hold")
        assert machine.ctl("stop").returncode == 0
        out, _ = p.communicate(timeout=60)
    assert p.returncode == 1
    assert "stopped" in out


def test_a_job_that_faults_exits_1(machine):
    with slow_job_waited_for(machine) as p:
        assert machine.ctl("estop").returncode == 0
        out, _ = p.communicate(timeout=60)
    assert p.returncode == 1
    assert "fault: e-stop" in out


def test_ctrl_c_leaves_the_job_running(machine):
    with slow_job_waited_for(machine) as p:
        p.send_signal(signal.SIGINT)
        _, err = p.communicate(timeout=60)
    assert p.returncode == 75
    assert "goes on" in err
    job = json.loads(machine.ctl("--json", "queue").stdout)[0]["job"]
    machine.client.job_where(job, "done")


def on_terminal(machine, *args):
    main, tty = pty.openpty()
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, *args],
        stdout=tty, stderr=tty, env={**os.environ, "TERM": "xterm"},
    )
    os.close(tty)
    out = b""
    while True:
        try:
            piece = os.read(main, 4096)
        except OSError:
            break
        if not piece:
            break
        out += piece
    os.close(main)
    return p.wait(), out.decode()


def test_submit_tells_how_long_it_takes(machine):
    """On the null machine there is nothing to run it on."""
    path = write(machine, "slow.ngc", SLOW_JOB)
    code, out = on_terminal(machine, "submit", path, "--hold")
    assert code == 0
    assert " takes 0 h 00 min 0" in out.splitlines()[-1]


def test_watch_redraws_one_line_on_a_terminal(machine):
    path = write(machine, "slow.ngc", SLOW_JOB)
    code, out = on_terminal(machine, "submit", path, "--wait")
    assert code == 0
    drawn = [x for x in out.split("\r") if "%" in x]
    assert len(drawn) > 1
    assert all("\n" not in x for x in drawn[:-1])
    assert any("=" in x and "left" in x for x in drawn)


def test_watch_once_status_and_lists(machine):
    p = machine.ctl("watch", "--once")
    assert (p.returncode, p.stdout.count("\n")) == (0, 1)
    p = machine.ctl("--json", "status")
    s = json.loads(p.stdout)
    assert p.returncode == 0
    assert (s["machine"], s["daemon"]) == (machine.name, "ok")
    assert len(s["pos_mm"]) == 8
    assert "none" in machine.ctl("queue").stdout
    path = write(machine, "q.ngc", QUICK_JOB)
    p = machine.ctl("submit", path, "--id", "mine", "--wait")
    assert p.returncode == 0
    p = machine.ctl("submit", path, "--id", "mine")
    assert (p.returncode, "already" in p.stdout) == (0, True)
    assert "mine" in machine.ctl("history").stdout
    assert "done" in machine.ctl("show", "mine").stdout
    assert machine.ctl("show", "nobody").returncode == 66


def test_status_has_the_axes_of_the_machine(tmp_path):
    absent = "".join(f"[axis.{a}]\npresent = no\n" for a in "YABUV")
    m = Machine(tmp_path, NULL_MACHINE + absent)
    try:
        m.start()
        text = m.ctl("status").stdout
        assert "X 0.000 Z 0.000 C 0.000 (mm, degrees)" in text
        assert json.loads(m.ctl("status", "--json").stdout)["axes"] == "XZC"
    finally:
        m.close()
        m.sweep()


def test_watch_ends_by_ctrl_c_with_0(machine):
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, "watch"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )
    time.sleep(2.5)
    p.send_signal(signal.SIGINT)
    out, err = p.communicate(timeout=60)
    assert p.returncode == 0
    lines = out.splitlines()
    assert lines and len(set(lines)) == len(lines), "told once"
    assert "goes on" in err


@pytest.mark.parametrize("verb", ["status", "watch"])
def test_ctrl_c_while_a_full_pipe_blocks_is_an_interruption(machine, verb):
    """status is blocked as it ends, watch while it goes on."""
    read, write_end = os.pipe()
    room = fcntl.fcntl(write_end, fcntl.F_SETPIPE_SZ, 4096)
    assert os.write(write_end, b"x" * room) == room
    p = subprocess.Popen(
        [str(BUILD / "edmctl"), "--machine", machine.name, verb],
        stdout=write_end, stderr=subprocess.PIPE, text=True,
    )
    until(lambda: open(f"/proc/{p.pid}/syscall").read().startswith("1 0x1 "))
    p.send_signal(signal.SIGINT)
    _, err = p.communicate(timeout=60)
    os.close(write_end)
    with os.fdopen(read, "rb") as f:
        assert f.read() == b"x" * room, "nothing was added to find out why"
    assert p.returncode == 75
    assert err.endswith("edmctl: interrupted; standard output is not "
                        "complete\n")


def test_status_of_a_killed_edmd_exits_69(machine):
    machine.kill("edmd")
    until(lambda: machine.ctl("status").returncode == 69, timeout=3)
    p = machine.ctl("status")
    assert "lost" in p.stdout
    assert machine.ctl("hold").returncode == 69
    machine.start_edmd()


def test_no_service_is_told_within_the_timeout(idle):
    for verb in (["queue"], ["status"], ["watch"], ["hold"]):
        p = idle.ctl("--timeout", "1", *verb)
        assert p.returncode == 69, verb
        assert f"no answer from edmd-jobs of machine {idle.name}" in p.stderr
    path = write(idle, "q.ngc", QUICK_JOB)
    assert idle.ctl("--timeout", "1", "submit", path).returncode == 69


def test_a_list_has_its_columns_whatever_the_names_are(machine):
    c = machine.client
    for i, name in enumerate(("kurz", "Gesenk für Läufer", 63 * "x")):
        assert c.submit(QUICK_JOB, 20 * f"{i}", name=name, hold=True).code == 0
    c.job_where(20 * "0", "ready")
    head, *rows = [x for x in machine.ctl("queue").stdout.splitlines()
                   if not x.startswith("all of it takes ")]
    assert len(rows) == 3
    assert {r[head.index("STATE") - 1:][:3] for r in rows} <= {" re", " qu"}


@pytest.mark.parametrize("url", [
    "nonsense", "udpm://", "udpm://1.2.3.4:7667?ttl=0",
    "udpm://239.255.76.67:0?ttl=0", "udpm://239.255.76.67:7667?ttl=300",
    "udpm://239.255.76.67:7667"])
def test_a_wrong_url_is_wrong_usage(idle, url):
    p = idle.ctl("--url", url, "status")
    assert p.returncode == 64 and url in p.stderr


def test_a_verb_that_was_meant_is_named(idle):
    assert "no verb 'statsu'; did you mean status? --help" in \
        idle.ctl("statsu").stderr
    assert "no verb 'xyzzy'; --help" in idle.ctl("xyzzy").stderr


def test_usage(idle):
    assert idle.ctl("--help").returncode == 0
    assert "submit" in idle.ctl("--help").stdout
    assert idle.ctl("--version").stdout.startswith("edmctl ")
    for args in (
        [], ["dance"], ["submit"], ["hold", "now"], ["hold", "--wait"],
        ["retract"], ["retract", "x"], ["retract", "0"], ["--timeout", "0",
                                                          "queue"],
        ["--nonsense"], ["show"], ["show", "a", "b"],
    ):
        p = idle.ctl(*args)
        assert p.returncode == 64, args
        assert p.stderr, args
