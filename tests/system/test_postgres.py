# SPDX-License-Identifier: Apache-2.0
"""edm-postgres: what edm-fleet recorded is in Debian's PostgreSQL, each row once,
whoever was killed or away meanwhile."""

import glob
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from rig import until
from test_fleet_record import Sink, alarm, cell, cut  # noqa: F401

psycopg = pytest.importorskip("psycopg", reason="pip install psycopg")
BIN = Path((sorted(glob.glob("/usr/lib/postgresql/*/bin")) or ["/none"])[-1])
ROOT = Path(__file__).resolve().parents[2]

pytestmark = [
    pytest.mark.skipif(not (BIN / "postgres").exists(),
                       reason="postgresql is not there"),
    pytest.mark.skipif(os.geteuid() == 0 and not shutil.which("setpriv"),
                       reason="needs setpriv"),
]


class Server:
    """A cluster of its own, by a user who is not root, on a socket alone."""

    def __init__(self):
        self.folder = Path(tempfile.mkdtemp(prefix="edm-postgres-"))
        self.as_user = []
        if os.geteuid() == 0:
            shutil.chown(self.folder, "postgres", "postgres")
            self.as_user = ["setpriv", "--reuid=postgres",
                            "--regid=postgres", "--clear-groups"]
        self.url = f"postgresql://hall@/postgres?host={self.folder}"
        self.run("initdb", "-D", self.folder / "data", "-U", "hall",
                 "-A", "trust", "--no-sync")
        self.start()

    def run(self, program, *args):
        subprocess.run([*self.as_user, BIN / program, *args], check=True,
                       cwd=self.folder, stdout=subprocess.DEVNULL, timeout=120)

    def start(self):
        self.p = subprocess.Popen(
            [*self.as_user, BIN / "postgres", "-D", self.folder / "data",
             "-k", self.folder, "-c", "listen_addresses="], cwd=self.folder,
            stderr=subprocess.DEVNULL)
        until(self._is_there, 60)

    def _is_there(self):
        try:
            psycopg.connect(self.url).close()
        except psycopg.OperationalError:
            return False
        return True

    def kill(self):
        """Without a word to its clients; it cleans up when it starts."""
        self.p.send_signal(signal.SIGQUIT)
        self.p.wait(60)

    def rows(self, what):
        try:
            with psycopg.connect(self.url) as db:
                return db.execute(f"SELECT {what} ORDER BY 1").fetchall()
        except (psycopg.errors.UndefinedTable,
                psycopg.errors.InvalidSchemaName):
            return []

    def close(self):
        self.kill()
        shutil.rmtree(self.folder)


@pytest.fixture
def server():
    s = Server()
    yield s
    s.close()


def copier(file, url, *more):
    return subprocess.Popen(
        [sys.executable, "-m", "edm.postgres", "--file", str(file),
         "--database", url, *more], cwd=ROOT / "clients/python",
        stderr=subprocess.PIPE, text=True)


def test_each_job_and_alarm_is_there_once_whatever_was_away(
        tmp_path, server, cell):  # noqa: F811
    sink = Sink(tmp_path)
    p = copier(sink.file, server.url)
    try:
        cut(cell, "one")
        until(lambda: server.rows("job FROM edm.report") == [("one",)], 60)
        server.kill()
        cut(cell, "two")
        alarm(cell)
        server.start()
        until(lambda: server.rows("job FROM edm.report") ==
              [("one",), ("two",)], 60)
        until(lambda: server.rows("fault FROM edm.alarm WHERE kind='alarm'")
              == [("e-stop",)], 60)
        p.kill()
        p.wait()
        cut(cell, "three")
        p = copier(sink.file, server.url)
        until(lambda: server.rows("job, state, lines FROM edm.report") ==
              [("one", "done", 4), ("three", "done", 4), ("two", "done", 4)],
              60)
        until(lambda: server.rows("what FROM edm.spent WHERE s>0"), 60)
    finally:
        p.terminate()
        p.wait(20)
        assert sink.end() == 0


def fill(file, first, n):
    with sqlite3.connect(file) as db:
        db.executemany(
            "INSERT INTO alarm VALUES('m', ?, ?, 'alarm', 'e-stop', 'j', 0.5,"
            " 'in words')", [(i, 1000 + i) for i in range(first, first + n)])
    db.close()


def report(file, state, ended):
    with sqlite3.connect(file) as db:
        db.execute("INSERT OR REPLACE INTO report(machine, job, number, state,"
                   " ended_us) VALUES('m', 'job', 7, ?, ?)", (state, ended))
    db.close()


def once(file, url):
    p = copier(file, url, "--once")
    said = p.communicate(timeout=120)[1]
    return p.returncode, said


def test_what_goes_on_is_as_it_ended_last(tmp_path, server):
    sink = Sink(tmp_path)
    until(lambda: sink.file.exists() and sink.rows("1 FROM spent", M) == [])
    assert sink.end() == 0
    fill(sink.file, 0, 2500)
    report(sink.file, "fault", 5)
    assert once(sink.file, server.url)[0] == 0
    assert server.rows("count(*) FROM edm.alarm") == [(2500,)]
    assert server.rows("state FROM edm.report") == [("fault",)]
    p = copier(sink.file, server.url)
    try:
        until(lambda: "copies" in p.stderr.readline(), 20)
        fill(sink.file, 2500, 1)
        until(lambda: server.rows("count(*) FROM edm.alarm") == [(2501,)], 60)
        report(sink.file, "done", 9)
        until(lambda: server.rows("state FROM edm.report") == [("done",)], 60)
    finally:
        p.terminate()
        p.wait(20)
    assert once(sink.file, server.url)[0] == 0
    assert server.rows("state, ended_us FROM edm.report") == [("done", 9)]
    assert server.rows("count(*) FROM edm.alarm") == [(2501,)]


def filled(tmp_path, n):
    sink = Sink(tmp_path)
    until(lambda: sink.file.exists() and sink.rows("1 FROM spent", M) == [])
    assert sink.end() == 0
    fill(sink.file, 0, n)
    return sink.file


def numbers(server):
    return [n for n, in server.rows("number FROM edm.alarm")]


def test_what_somebody_does_to_the_tables_ends_nothing(tmp_path, server):
    """They are made again, or what is wrong is said until it is right."""
    file = filled(tmp_path, 3)
    p = copier(file, server.url)
    try:
        until(lambda: numbers(server) == [0, 1, 2], 60)
        with psycopg.connect(server.url, autocommit=True) as db:
            db.execute("DROP TABLE edm.alarm")
        fill(file, 3, 1)
        until(lambda: numbers(server) == [0, 1, 2, 3], 60)
        with psycopg.connect(server.url, autocommit=True) as db:
            db.execute("ALTER TABLE edm.alarm RENAME COLUMN place_mm TO place")
        fill(file, 4, 1)
        while "place_mm" not in p.stderr.readline():
            assert p.poll() is None
        with psycopg.connect(server.url, autocommit=True) as db:
            db.execute("ALTER TABLE edm.alarm RENAME COLUMN place TO place_mm")
        until(lambda: numbers(server) == [0, 1, 2, 3, 4], 60)
    finally:
        p.terminate()
        p.wait(20)


def test_a_file_that_is_replaced_or_emptied_is_followed(tmp_path, server):
    file = filled(tmp_path, 3)
    p = copier(file, server.url)
    try:
        until(lambda: numbers(server) == [0, 1, 2], 60)
        with sqlite3.connect(file) as db:
            db.execute("DELETE FROM alarm")
        db.close()
        fill(file, 10, 1)
        until(lambda: numbers(server) == [0, 1, 2, 10], 60)
        (tmp_path / "next").mkdir()
        filled(tmp_path / "next", 0)
        fill(tmp_path / "next/disk/fleet.db", 20, 1)
        for old in file.parent.glob("fleet.db*"):
            old.unlink()
        os.rename(tmp_path / "next/disk/fleet.db", file)
        until(lambda: numbers(server) == [0, 1, 2, 10, 20], 60)
    finally:
        p.terminate()
        p.wait(20)


class M:
    name = "m"


def test_what_is_not_there_is_said(tmp_path, server):
    code, said = once(tmp_path / "none.db", server.url)
    assert code == 69 and "edm-fleet record writes it" in said
    assert not (tmp_path / "none.db").exists()
    (tmp_path / "text.db").write_text("this is no database, by far")
    code, said = once(tmp_path / "text.db", server.url)
    assert code == 69 and "not a database" in said
    sink = Sink(tmp_path)
    until(lambda: sink.file.exists() and sink.rows("1 FROM spent", M) == [])
    assert sink.end() == 0
    code, said = once(sink.file, f"postgresql://hall@/none?host={server.folder}")
    assert code == 69 and '"none" does not exist' in said
    with psycopg.connect(server.url, autocommit=True) as db:
        db.execute("CREATE USER guest")
    code, said = once(
        sink.file, f"postgresql://guest@/postgres?host={server.folder}")
    assert code == 69 and "may make the schema edm" in said
    code, said = once(sink.file, "nonsense")
    assert code == 69 and "a URL" in said
