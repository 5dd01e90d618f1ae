# SPDX-License-Identifier: Apache-2.0
"""The first day of docs/getting-started.md, on a machine that new-machine wrote."""

import pathlib
import re
import shlex
import subprocess

import rig

ROOT = pathlib.Path(__file__).resolve().parents[2]
# A job may be over before it is held, and a host of tests lacks things.
MAY_FAIL = {"hold": "no job is loaded", "start": "no job in the queue", "doctor": ""}


def commands():
    text = (ROOT / "docs/getting-started.md").read_text()
    for line in re.findall(r"(?m)^    (edmctl .*)$", text):
        for one in re.split(r" {3,}", line)[0].split(";"):
            yield shlex.split(one)[1:]


def test_every_command_is_carried_out(tmp_path):
    subprocess.run([rig.BUILD / "edmctl", "new-machine", tmp_path / "m.ini"],
                   input="shop\n\nsim\n" + "\n" * 60, text=True, check=True,
                   capture_output=True)
    text = (tmp_path / "m.ini").read_text().replace("= shop", "= {name}")
    (tmp_path / "part.ngc").write_text("G21 G90 G54\nG0 X0 Y0\nG0 Z1\n"
                                       "G1 Z-0.3 F30\nG0 Z5\nM2\n")
    with rig.Machine(tmp_path, text + "\n[sim]\nspeed = 60\n"
                     "\n[jobs]\nstore = {store}\n") as m:
        m.start()
        done = 0
        for words in commands():
            words = [str(tmp_path / w) if w == "part.ngc" else w for w in words]
            p = m.ctl(*words, timeout=300)
            assert p.returncode == 0 or (
                words[0] in MAY_FAIL and MAY_FAIL[words[0]] in p.stderr), \
                (words, p.stdout, p.stderr)
            done += 1
        assert done >= 12
        o = m.ctl("offset").stdout
        assert re.match(r"G54 +X +-?0\.\d+\* Y +-?0\.\d+\* Z +-5\.000\d\*", o), o


def test_a_start_while_the_job_is_being_loaded_is_kept(tmp_path):
    """Also of a job that was sent to be held."""
    with rig.Machine(tmp_path, rig.NULL_MACHINE) as m:
        m.start()
        for i in range(30):
            assert m.client.submit(rig.QUICK_JOB, f"j{i}", hold=True).code == 0
            a = m.client.ask("start")
            assert a.code == 0, (i, a.body)
            m.client.job_where(f"j{i}", "done")
