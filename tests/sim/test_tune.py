# SPDX-License-Identifier: Apache-2.0
"""edmsim --tune: values for a kind of work, found on the simulated gap."""
import configparser
import json
import signal
import subprocess

import pytest

from edmsim import HANGS_S, PROGRAM, ROOT, run

WORK = ROOT / "tests/experiments/conditions/deep-poor-flushing.ini"
JOB = ROOT / "tests/experiments/sink.ngc"
QUICK = ("--tune", "--machine", WORK, "--budget", 24, "--limit-s", 20)


def tuned(*args):
    done = run(*QUICK, "--json", *args, JOB)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_worst_flushing_gets_fewer_shorts_and_more_removal():
    t = tuned()["test"]
    assert t["after"]["shorts_min"] < t["before"]["shorts_min"] / 2
    assert t["after"]["removal_mm3_min"] > t["before"]["removal_mm3_min"] * 1.2
    assert t["score"] > 0


def test_equal_seed_equal_values_another_seed_others():
    a, b, c = tuned(), tuned(), tuned("--seed", 77)
    assert a == b
    # The best of its trials may be the same one.
    assert a["train"]["score"] != c["train"]["score"]
    assert a["trials"] == 24


def test_the_lines_can_be_pasted_and_do_what_was_promised(tmp_path):
    done = run(*QUICK, JOB)
    assert done.returncode == 0, done.stderr
    new = configparser.ConfigParser(inline_comment_prefixes=";")
    new.read_string(done.stdout.decode())
    both = configparser.ConfigParser(inline_comment_prefixes=";")
    both.read(WORK)
    for section in new.sections():
        if not both.has_section(section):
            both.add_section(section)
        for key, value in new[section].items():
            both[section][key] = value
    machine = tmp_path / "m.ini"
    with open(machine, "w") as f:
        both.write(f)
    sums = {}
    for what, ini in (("before", WORK), ("after", machine)):
        r = run("--machine", ini, "--seed", 4711, "--limit-s", 30,
                "--report", "-", JOB)
        sums[what] = json.loads(r.stdout)
    assert sums["after"]["shorts"] < sums["before"]["shorts"]
    assert sums["after"]["removed_mm3"] > sums["before"]["removed_mm3"]


def test_keys_that_a_condition_gives_are_left_alone(tmp_path):
    table = tmp_path / "t.tech"
    table.write_text("condition,servo_v,jump_every_s\nC120,20,1\n")
    job = "G21 G90 F600\nG0 Z2\nZ0\nC120 G1 Z-9\nM2\n"
    done = run("--tune", "--json", "--machine", WORK, "--tech", table,
               "--budget", 2, "--limit-s", 2, text=job)
    assert done.returncode == 0, done.stderr
    keys = {k["key"] for k in json.loads(done.stdout)["keys"]}
    assert keys == {"feed_gain_mm_s_v", "integral_s", "retract_mm_s",
                    "height_mm"}
    assert b"servo_v is not tuned" in done.stderr


def test_an_interrupt_prints_the_best_so_far():
    p = subprocess.Popen(
        [PROGRAM, "--tune", "--machine", WORK, "--budget", "5000", JOB],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for line in p.stderr:
        if b"20 of 5000" in line:
            break
    p.send_signal(signal.SIGINT)
    out = p.communicate(timeout=HANGS_S)[0].decode()
    assert p.returncode == 1
    assert "interrupted" in out
    assert "servo_v" in out and "[gap]" in out


@pytest.mark.parametrize("args, said", [
    (("--budget", 3), "--tune"),
    (("--json",), "--tune"),
    (("--tune", "--report", "-"), "--report"),
    (("--tune", "--dry-run"), "dry-run"),
    (("--tune", "--budget", 0), "budget"),
])
def test_what_makes_no_sense_is_refused(args, said):
    done = run(*args, JOB)
    assert done.returncode == 64
    assert said in done.stderr.decode()
