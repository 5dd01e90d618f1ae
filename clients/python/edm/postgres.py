# SPDX-License-Identifier: Apache-2.0
"""edm-postgres: copies what edm-fleet record keeps into PostgreSQL.

The file of edm-fleet record stays what counts: it is on this host, and takes
what comes while the server is away.  Each row is known by its key, so what is
copied again changes nothing.  docs/fleet.md has the tables.
"""

from __future__ import annotations

import argparse
import importlib
import sqlite3
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

EVERY_S, AGAIN_S = 1.0, 5.0
ROWS = 1000
REAL = "double precision"


class Wrong(Exception):
    """It cannot be copied; says what would be accepted."""


@dataclass(frozen=True)
class Table:
    """Columns with their types, the key first; of a row that is there already,
    what becomes of it."""

    name: str
    columns: dict[str, str]
    keys: int
    again: str

    def made(self) -> str:
        """The statement that makes it."""
        rows = ", ".join(f"{c} {t}" for c, t in self.columns.items())
        return (f"CREATE TABLE IF NOT EXISTS edm.{self.name}({rows}, "
                f"PRIMARY KEY({self._key()}))")

    def _key(self) -> str:
        return ", ".join(list(self.columns)[:self.keys])

    def put(self) -> str:
        """The statement that puts a row in."""
        return (f"INSERT INTO edm.{self.name} AS old"
                f"({', '.join(self.columns)}) "
                f"VALUES({', '.join(['%s'] * len(self.columns))}) "
                f"ON CONFLICT({self._key()}) DO {self.again}")

    def new(self) -> str:
        """The question for what is behind a row."""
        return (f"SELECT rowid, {', '.join(self.columns)} FROM {self.name} "
                f"WHERE rowid>? ORDER BY rowid LIMIT {ROWS}")


def _columns(words: str, of: str) -> dict[str, str]:
    return dict.fromkeys(words.split(), of)


REPORT = (_columns("machine job", "text") | {"number": "bigint"}
          | _columns("name state reason", "text")
          | _columns("submitted_us first_us ended_us", "bigint")
          | _columns("job_s erode_s path_mm length_mm depth_mm energy_j", REAL)
          | _columns("jumps retracts shorts arcs lines", "bigint")
          | {"sha256": "text"})
TABLES = (
    # A job that ended by a fault may go on, and end again.
    Table("report", REPORT, 2, "UPDATE SET " + ", ".join(
        f"{c}=excluded.{c}" for c in list(REPORT)[2:])
        + " WHERE excluded.ended_us>old.ended_us"),
    Table("alarm", {"machine": "text", "number": "bigint", "utime": "bigint"}
          | _columns("kind fault job", "text")
          | {"place_mm": REAL, "text": "text"}, 3, "NOTHING"),
)
# Its rows grow; the day before today may still do so at midnight.
SPENT = Table("spent", _columns("day machine what why", "text") | {"s": REAL},
              4, "UPDATE SET s=greatest(old.s, excluded.s)")


@dataclass
class Copier:
    """What is in the server already, as far as this program knows."""

    last: dict[str, int] = field(default_factory=dict)
    spent: dict[tuple[str, ...], float] = field(default_factory=dict)

    def look(self, source: sqlite3.Connection, to: Any) -> int:
        """Copy what is new.  Return: rows."""
        n = 0
        for t in TABLES:
            top, = source.execute(
                f"SELECT coalesce(max(rowid), 0) FROM {t.name}").fetchone()
            if top < self.last.get(t.name, 0):
                self.last[t.name] = 0   # rows were taken out
            rows = source.execute(
                t.new(), (self.last.get(t.name, 0),)).fetchall()
            self._put(to, t, [r[1:] for r in rows])
            if rows:
                self.last[t.name] = rows[-1][0]
            n += len(rows)
        return n + self._look_spent(source, to)

    def _look_spent(self, source: sqlite3.Connection, to: Any) -> int:
        since = ("WHERE day>=date('now', 'localtime', '-1 day')"
                 if self.spent else "")
        rows = [r for r in source.execute(
            f"SELECT {', '.join(SPENT.columns)} FROM spent {since}")
            if self.spent.get(r[:4]) != r[4]]
        self._put(to, SPENT, rows)
        self.spent.update({r[:4]: r[4] for r in rows})
        return len(rows)

    @staticmethod
    def _put(to: Any, table: Table, rows: list[tuple[Any, ...]]) -> None:
        """All of them, or an error and none."""
        if not rows:
            return
        with to.transaction(), to.cursor() as c:
            c.executemany(table.put(), rows)


def say(text: str) -> None:
    """To the journal."""
    print(f"edm-postgres: {text}", file=sys.stderr, flush=True)


def _library() -> Any:
    try:
        return importlib.import_module("psycopg")
    except ImportError:
        raise Wrong("needs psycopg; pip install 'psycopg[binary]', or apt "
                    "install python3-psycopg") from None


def open_source(path: Path) -> sqlite3.Connection:
    """Only to read.  Raises sqlite3.Error."""
    return sqlite3.connect(f"file:{quote(str(path))}?mode=ro", uri=True,
                           timeout=EVERY_S)


def number_of(path: Path) -> int:
    """By which a file is the same, whatever its name."""
    return path.stat().st_ino if path.exists() else 0


def copy(o: argparse.Namespace, psycopg: Any) -> None:
    """Until the file or the server is away."""
    number, copier = number_of(o.file), Copier()
    source = open_source(o.file)
    with source, psycopg.connect(o.database, autocommit=True,
                                 connect_timeout=10) as to:
        source.execute("SELECT 1 FROM spent LIMIT 1")
        to.execute("CREATE SCHEMA IF NOT EXISTS edm")
        for t in (*TABLES, SPENT):
            to.execute(t.made())
        say(f"copies {o.file}")
        while True:
            if number_of(o.file) != number:
                raise sqlite3.OperationalError("it was replaced")
            n = copier.look(source, to)
            if n < ROWS and o.once:
                return
            if n < ROWS:
                time.sleep(EVERY_S)


def serve(o: argparse.Namespace) -> int:
    """Never gives up: the file or the server may come later."""
    psycopg, told = _library(), ""
    while True:
        try:
            copy(o, psycopg)
            return 0
        except sqlite3.Error as e:
            why = f"{o.file}: {e}; edm-fleet record writes it"
        except psycopg.Error as e:
            why = str(e).strip().replace("\n", " ")
            if isinstance(e, psycopg.ProgrammingError):
                why += ("; a URL, and a database in which this user may make "
                        "the schema edm and its tables, as they are here")
        if o.once:
            say(why)
            return 69
        if why != told:
            say(f"{why}; goes on trying")
        told = why
        time.sleep(AGAIN_S)


def main() -> int:
    """Return: as sysexits.h."""
    p = argparse.ArgumentParser(prog="edm-postgres", description=__doc__)
    p.add_argument("--file", type=Path, required=True,
                   help="that edm-fleet record writes")
    p.add_argument("--database", required=True, metavar="URL",
                   help="postgresql://USER@HOST/NAME; the password: "
                        "~/.pgpass or PGPASSWORD")
    p.add_argument("--once", action="store_true",
                   help="copy what is there, and end")
    try:
        return serve(p.parse_args())
    except Wrong as e:
        say(str(e))
        return 78
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
