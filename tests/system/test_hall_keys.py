# SPDX-License-Identifier: Apache-2.0
"""DDS Security with the keys of edm-hall-keys, by Debian's plugins: who has none,
those of another hall, or those for something else, is not heard and hears nothing."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import test_fleet
from rig import QUICK_JOB, until

pytest.importorskip("cryptography")
from cryptography import x509  # noqa: E402
from cryptography.hazmat.primitives import serialization  # noqa: E402

PLUGINS = sorted(Path("/usr/lib").glob("*/*/libdds_security_auth.so"))
pytestmark = pytest.mark.skipif(
    not PLUGINS, reason="Cyclone DDS has no plugins for security here")
ROOT = Path(__file__).resolve().parents[2]
DOMAIN = 1 + os.getpid() % 230
# Beside the package of LCM's types, which has the same name.
SPEC = importlib.util.spec_from_file_location(
    "hall_keys", ROOT / "clients/python/edm/hall_keys.py")
KEYS = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(KEYS)


def hall_keys(folder, *args):
    return subprocess.run(
        [sys.executable, "-m", "edm.hall_keys", str(folder), *args],
        cwd=ROOT / "clients/python", capture_output=True, text=True,
        timeout=60)


def uri(folder):
    own = os.environ.get("CYCLONEDDS_URI")
    return (f"{own}," if own else "") + f"file://{folder}/dds.xml"


class Machine(test_fleet.FleetMachine):
    keys = None

    def env(self, program):
        more = {"CYCLONEDDS_URI": uri(self.keys)} if self.keys else {}
        return super().env(program) | more

    def start_dds(self):
        self.dds = self._start("edm-dds", "--machine", self.name, "--domain",
                               str(DOMAIN))


@pytest.fixture
def cell(tmp_path):
    """A machine whose edm-dds has keys of the hall."""
    with Machine(tmp_path / "machine") as m:
        p = hall_keys(tmp_path / "hall", "--machine", m.name, "--machine",
                      "other", "--office", "office")
        assert p.returncode == 0, p.stderr
        m.hall = tmp_path / "hall"
        m.keys = m.hall / m.name
        m.start()
        m.start_dds()
        yield m


def fleet(keys, *args):
    env = os.environ | ({"CYCLONEDDS_URI": uri(keys)} if keys else {})
    return subprocess.run(
        [str(test_fleet.BUILD / "edm-fleet"), *args, "--domain", str(DOMAIN)],
        env=env, capture_output=True, text=True, timeout=120)


def heard(keys):
    p = fleet(keys, "--once", "--wait", "1", "--json")
    return {m["machine"]: m["state"]
            for m in json.loads(p.stdout)["machines"]} if p.stdout else {}


def test_an_office_hears_the_machine_and_gives_it_a_job(cell, tmp_path):
    until(lambda: heard(cell.hall / "office") == {cell.name: "idle"}, 30)
    part = tmp_path / "part.ngc"
    part.write_bytes(QUICK_JOB)
    p = fleet(cell.hall / "office", "submit", str(part), "--machine",
              cell.name, "--start", "--id", "one")
    assert p.returncode == 0, p.stderr
    cell.client.job_where("one", "done")
    # What a machine has may not offer.
    p = fleet(cell.hall / "other", "submit", str(part), "--machine",
              cell.name, "--start", "--id", "two", "--wait", "3")
    assert p.returncode != 0
    history = json.loads(cell.client.ask("history").body)
    assert [j["job"] for j in history] == ["one"]


def test_a_stranger_hears_nothing_and_is_not_heard(cell, tmp_path):
    office = cell.hall / "office"
    until(lambda: heard(office) == {cell.name: "idle"}, 30)
    p = hall_keys(tmp_path / "next", "--office", "office", "--machine",
                  cell.name)
    assert p.returncode == 0
    for keys in (None, tmp_path / "next/office"):
        assert heard(keys) == {}
    # Somebody else in the machine's name, without keys, with those of another
    # hall, with those of an office, and of another machine.
    for keys in (None, tmp_path / "next" / cell.name, office,
                 cell.hall / "other"):
        with Machine(tmp_path / f"false-{bool(keys)}-{keys and keys.name}"
                     ) as false:
            false.name, false.keys = cell.name, keys
            false.start_dds()
            assert heard(office) == {cell.name: "idle"}
            assert heard(office) == {cell.name: "idle"}


def test_one_that_has_ended_is_not_heard(cell, tmp_path):
    p = hall_keys(cell.hall, "--office", "late", "--years", "0.002")
    assert p.returncode == 0, p.stderr
    assert heard(cell.hall / "late") == {}
    assert heard(cell.hall / "office") == {cell.name: "idle"}


def killed(hall, steps, *args):
    """A process that is killed before this step on the disk.  Return: its code."""
    pid = os.fork()
    if pid:
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])

    def counted(real):
        def step(*given, **more):
            nonlocal steps
            steps -= str(hall) in str(given[0])
            if steps == 0:
                os.kill(os.getpid(), signal.SIGKILL)
            return real(*given, **more)
        return step

    for name in "open", "replace", "mkdir", "rename", "rmdir", "unlink":
        setattr(os, name, counted(getattr(os, name)))
    os._exit(made(hall, *args))


def made(hall, *args):
    """In this process.  Return: its exit code."""
    with pytest.MonkeyPatch.context() as m:
        m.setattr(sys, "argv", ["edm-hall-keys", str(hall), *args])
        return KEYS.main()


def whole(folder):
    """A key, and the certificate for it."""
    pem = x509.load_pem_x509_certificate((folder / "identity.pem").read_bytes())
    key = serialization.load_pem_private_key(
        (folder / "identity.key").read_bytes(), None)
    assert key.public_key() == pem.public_key()
    return {f.name for f in folder.iterdir()} == {
        "ca.pem", "identity.pem", "identity.key", "governance.p7s",
        "permissions.p7s", "dds.xml"}


@pytest.mark.parametrize("renew", [[], ["--renew"]])
def test_killed_at_any_step_a_folder_is_whole_or_not_there(tmp_path, renew):
    """And the same command again makes it."""
    for n in range(1, 100):
        hall = tmp_path / f"hall-{n}"
        if renew:
            assert made(hall, "--machine", "a") == 0
        p = killed(hall, n, "--machine", "a", *renew)
        there = (hall / "a").exists()
        assert not there or whole(hall / "a"), n
        if p == 0:
            break
        assert p == -9
        assert made(hall, "--machine", "a", *["--renew"] * there) == 0, n
        assert whole(hall / "a"), n
        assert sorted(f.name for f in hall.iterdir()) == ["a", "ca.key",
                                                          "ca.pem"]
    assert n > 8


def test_nobody_is_good_for_longer_than_the_authority(tmp_path):
    hall = tmp_path / "hall"
    assert hall_keys(hall, "--machine", "a", "--years", "1").returncode == 0
    p = hall_keys(hall, "--machine", "b")
    assert p.returncode == 0
    ends = [x509.load_pem_x509_certificate(
        (hall / n).read_bytes()).not_valid_after_utc
        for n in ("ca.pem", "b/identity.pem")]
    assert ends[0] == ends[1] and f"good until {ends[0]:%Y-%m-%d}" in p.stdout
    # One that has ended: it began a day ago.
    hall = tmp_path / "old"
    p = hall_keys(hall, "--machine", "a", "--years", "1e-6")
    assert p.returncode == 64 and "another folder" in p.stderr
    assert not (hall / "a").exists()


def test_what_is_wrong_is_refused_and_changes_nothing(tmp_path):
    hall = tmp_path / "hall"
    for args, words in (
        ([], "nobody is named"),
        (["--machine", "a/b"], "'a/b': each name once"),
        (["--machine", "a", "--office", "a"], "'a': each name once"),
        (["--machine", "a", "--years", "0"], "more than 0"),
    ):
        p = hall_keys(hall, *args)
        assert p.returncode == 64 and words in p.stderr
        assert not hall.exists()
    assert hall_keys(hall, "--machine", "a").returncode == 0
    kept = {f: f.read_bytes() for f in hall.rglob("*") if f.is_file()}
    assert (hall / "a/identity.key").stat().st_mode & 0o77 == 0
    assert (hall / "ca.key").stat().st_mode & 0o77 == 0
    p = hall_keys(hall, "--machine", "a")
    assert p.returncode == 64 and "--renew" in p.stderr
    assert {f: f.read_bytes() for f in hall.rglob("*") if f.is_file()} == kept
    assert hall_keys(hall, "--machine", "a", "--renew").returncode == 0
    now = (hall / "a/identity.key").read_bytes()
    assert now != kept[hall / "a/identity.key"]
    assert (hall / "ca.pem").read_bytes() == kept[hall / "ca.pem"]
    # A name that is there is refused before another one is made.
    p = hall_keys(hall, "--machine", "new", "--machine", "a")
    assert p.returncode == 64 and not (hall / "new").exists()
    # The authority's own files are no folders of a machine.
    for name in "ca.key", "ca.pem":
        p = hall_keys(hall, "--machine", name, "--renew")
        assert p.returncode == 64 and "each name once" in p.stderr
    assert (hall / "ca.pem").read_bytes() == kept[hall / "ca.pem"]
    (hall / "ca.key").write_text("torn")
    p = hall_keys(hall, "--machine", "b")
    assert p.returncode == 64 and "ca.key" in p.stderr
