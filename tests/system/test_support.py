# SPDX-License-Identifier: Apache-2.0
"""One archive for who helps from afar: what is in it, and what is not."""

import errno
import gzip
import json
import os
import pty
import signal
import subprocess
import tarfile
import time

import pytest
import rig
from rig import QUICK_JOB, SLOW_JOB, key_file
from test_store import degraded, failing  # noqa: F401

FILES = {"README.txt", "versions.txt", "machine.ini", "doctor.txt",
         "latency.txt", "status.json", "snapshot.json", "checkpoint.json",
         "store.json", "events.json", "alarms.json", "queue.json",
         "history.json", "journal.txt", "edmd.log", "edmd-jobs.log"}

PASSWORD = "Correct-Horse-99"


@pytest.fixture
def shop(tmp_path):
    users = tmp_path / "panel.users"
    with rig.Machine(tmp_path, rig.NULL_MACHINE + f"""
[panel]
users = {users}
# the door's password: {PASSWORD}
""") as m:
        added = subprocess.run(
            [str(rig.BUILD / "edm-panel"), "--config", str(m.config),
             "--add-user", "anna", "operator"],
            input=f"{PASSWORD}\n{PASSWORD}\n", text=True,
            capture_output=True, timeout=60)
        assert added.returncode == 0, added.stderr
        m.start()
        yield m


def read(file):
    with tarfile.open(file) as tar:
        return {t.name.split("/")[1]: tar.extractfile(t).read().decode()
                for t in tar}


def secrets(m):
    found = [PASSWORD]
    found += [line.split()[2] for line in
              (m.folder / "panel.users").read_text().splitlines()
              if line and not line.startswith("#")]
    for key in [*m.store.glob("*.key"), *m.store.glob("*.machine-key"),
                *m.folder.glob("*.key")]:
        found.append(key_file(key)["secret"])
    return found


def nothing_left(m):
    return not list(m.folder.glob("*.part")) and not list(
        m.folder.glob("*.tar.gz"))


def test_everything_is_in_it_but_no_secret(shop):
    c = shop.client
    assert c.submit(QUICK_JOB, "job").code == 0
    c.job_where("job", "done")
    assert shop.ctl("keys", "add", "bob", "viewer",
                    cwd=shop.folder).returncode == 0
    hidden = secrets(shop)
    assert len(hidden) >= 5
    # A program that says too much.  What is only in bob.key, it cannot know.
    bob = key_file(shop.folder / "bob.key")["secret"]
    with open(shop.folder / "edmd.log", "a") as log:
        print("\n".join(x for x in hidden[1:] if x != bob)
              + f"\npassword={PASSWORD}", file=log)
    file = shop.folder / "help.tar.gz"
    p = shop.ctl("support", str(file))
    assert p.returncode == 0, p.stdout + p.stderr
    assert "No keys, no passwords" in p.stdout and "journal.txt" in p.stdout
    got = read(file)
    assert set(got) == FILES
    raw = gzip.decompress(file.read_bytes())
    for word in hidden:
        assert word.encode() not in raw
    # The secrets are hidden because they were found, not because all is.
    assert "edmd: machine" in got["edmd.log"]
    assert f"name = {shop.name}" in got["machine.ini"]
    assert json.loads(got["status.json"])["machine"] == shop.name
    assert json.loads(got["snapshot.json"])["state"] == "idle"
    assert json.loads(got["checkpoint.json"])["place"]["state"]
    assert json.loads(got["history.json"])[0]["job"] == "job"
    assert "ended" in {e["kind"] for e in json.loads(got["events.json"])}
    assert json.loads(got["store.json"])["machine_file"] == str(shop.config)
    assert "wakes" in got["latency.txt"] and "kernel" in got["doctor.txt"]
    assert os.stat(file).st_mode & 0o077 == 0


def test_a_file_that_is_there_is_not_replaced(shop):
    file = shop.folder / "mine"
    file.write_text("precious")
    p = shop.ctl("support", str(file))
    assert p.returncode == 73 and "is there already" in p.stderr
    assert file.read_text() == "precious"
    p = shop.ctl("support", "/nowhere/a.tar.gz")
    assert p.returncode == 73 and "No such file" in p.stderr
    assert nothing_left(shop)


def test_without_daemons_it_says_what_is_missing(tmp_path):
    m = rig.Machine(tmp_path)
    file = tmp_path / "help.tar.gz"
    p = m.ctl("--timeout", "0.3", "support", str(file))
    assert p.returncode == 0, p.stderr
    got = read(file)
    assert set(got) == FILES
    assert "did not answer" in got["history.json"]
    assert "no shared memory" in got["snapshot.json"]


def test_ctrl_c_leaves_nothing(shop):
    shop.kill("jobs")           # so that it has to wait
    master, slave = pty.openpty()
    p = subprocess.Popen(
        [str(rig.BUILD / "edmctl"), "--machine", shop.name, "--timeout", "60",
         "support", str(shop.folder / "help.tar.gz")],
        stdout=slave, stderr=subprocess.PIPE)
    # It has begun when the other name is there.
    rig.until(lambda: list(shop.folder.glob("*.part")))
    time.sleep(0.1)
    p.send_signal(signal.SIGINT)
    assert p.wait(60) == 75
    assert b"nothing is written" in p.stderr.read()
    os.close(master)
    os.close(slave)
    assert nothing_left(shop)
    shop.start_jobs()


def test_a_full_disk_leaves_nothing(shop):
    # As a limit of what this process may write: the same way out as a disk's.
    p = subprocess.run(
        ["sh", "-c", "trap '' XFSZ; ulimit -f 2; exec \"$@\"", "sh",
         str(rig.BUILD / "edmctl"), "--machine", shop.name, "support",
         str(shop.folder / "help.tar.gz")], capture_output=True, text=True,
        timeout=120)
    assert p.returncode == 74, p.stdout + p.stderr
    assert "help.tar.gz: " in p.stderr
    assert nothing_left(shop)


def test_a_degraded_store_is_told(failing):
    m, c = failing, failing.client
    m.start()
    assert c.submit(SLOW_JOB, "job").code == 0
    c.status_where(lambda s: s.job_state == "running")
    m.fail(errno.ENOSPC)
    c.job_where("job", "done", 20)
    degraded(c, "the disk is full")
    file = m.folder / "help.tar.gz"
    assert m.ctl("support", str(file)).returncode == 0
    got = read(file)
    assert json.loads(got["store.json"])["why"] == "the disk is full"
    # What the disk does not have is told from memory.
    job, = json.loads(m.ctl("--json", "history").stdout)
    assert sum(x["job_s"] for x in job["conditions"]) == pytest.approx(
        job["job_s"])
    svg = m.folder / "job.svg"
    assert m.ctl("history", "job", "--picture", str(svg)).returncode == 0
    m.heal()
    c.status_where(lambda s: s.store == "ok")
    m.kill("jobs")
    m.start_jobs()
    again, = json.loads(m.ctl("--json", "history").stdout)
    assert again == job
