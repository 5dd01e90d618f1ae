# SPDX-License-Identifier: Apache-2.0
"""DDS Security with the keys of edm-hall-keys, by Debian's plugins: who has none,
those of another hall, or those for something else, is not heard and hears nothing."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import test_fleet
from rig import QUICK_JOB, until

pytest.importorskip("cryptography")
PLUGINS = sorted(Path("/usr/lib").glob("*/*/libdds_security_auth.so"))
pytestmark = pytest.mark.skipif(
    not PLUGINS, reason="Cyclone DDS has no plugins for security here")
ROOT = Path(__file__).resolve().parents[2]
DOMAIN = 1 + os.getpid() % 230


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
    # hall, and with those of an office.
    for keys in (None, tmp_path / "next" / cell.name, office):
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
    (hall / "ca.key").write_text("torn")
    p = hall_keys(hall, "--machine", "b")
    assert p.returncode == 64 and "ca.key" in p.stderr
