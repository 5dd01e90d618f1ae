# SPDX-License-Identifier: Apache-2.0
"""Programs of post-processors in a random layout: blanks, comments, leading zeros,
case, line ends, empty lines.  They go where they go as they are written.  EDM_SEED
repeats a run, EDM_RUNS says how many layouts of each program.
"""
import operator
import os
import random
import re

import pytest
from edmsim import ROOT, run, seeded
from test_posts import FILES, POSTS, WIRE, dialect_of
from written import FOLDER, programs

RUNS = int(os.environ.get("EDM_RUNS", 3))

# sodick-wire.nc calls a file that is not there.
NAMES = sorted(set(FILES) - {"sodick-wire.nc"})
RECORDS = ("3b.3b", "4b.4b")
SINKERS = ("charmilles-cmd", "fanuc-sinker", "generic", "heekscnc", "linuxcnc",
           "sodick-sinker")


def layouts():
    """The same in every `make check`; others with EDM_SEED."""
    return seeded() if "EDM_SEED" in os.environ else random.Random(4)


@pytest.fixture(scope="module")
def wire(tmp_path_factory):
    path = tmp_path_factory.mktemp("layout") / "wire.ini"
    path.write_text(WIRE)
    return path


def way_of(dialect, wire, text):
    """All places in their order; what was said; the exit code."""
    machine = ROOT / "examples/machine.ini" if dialect in SINKERS else wire
    r = run("--machine", machine, "--dialect", dialect, "--dry-run", "--pulses",
            "-", text=text)
    rows = r.stdout.decode().splitlines()
    head = rows[0].split(",") if rows else []
    keep = [i for i, h in enumerate(head) if h in "XYZABCUV"]
    places = operator.itemgetter(*keep) if keep else None
    return [places(c.split(",")) for c in rows[1:]], r.stderr.decode(), \
        r.returncode


WORD = re.compile(r"(\([^)]*\)|;.*|<[^>]*>|[A-Za-z])")
NUMBER = re.compile(r"([+-]?)(\d+)(\.?)(\d*)")


# Where a length without a point counts its last decimal: 5.25 and 5250 are one.
LAST_DECIMAL = ("agievision", "skd2")
LENGTHS = "XYIJUV"


def counted(rnd, line):
    """Lengths of a line with and without their points, in micrometres."""
    def other(m):
        letter, sign, whole, point, rest = m.groups()
        um = int(whole + (rest or "").ljust(3, "0")) if point else int(whole)
        return letter + sign + rnd.choice(
            [f"{um}", f"{um // 1000}.{um % 1000:03d}"])
    return re.sub(rf"([{LENGTHS}])([+-]?)(\d+)(\.?)(\d{{0,3}})(?!\d)", other,
                  line)


def number(rnd, text, is_code):
    """Codes and labels have no sign, and no zeros behind a point."""
    def other(m):
        sign, whole, point, rest = m.groups()
        zeros = "0" * rnd.choice([0, 0, 1, 2])
        if is_code:
            return zeros + whole + point + rest
        return (sign or rnd.choice(["", "", "", "+"])) + zeros + whole + \
            point + rest + ("0" * rnd.choice([0, 0, 1, 2]) if point else "")
    return NUMBER.sub(other, text, 1)


def line_of(rnd, line):
    """The same line in another layout."""
    out, last = [], ""
    for part in WORD.split(line):
        if part[:1] in ("(", ";", "<"):
            out.append(part)
        elif part.isalpha() and len(part) == 1:
            out.append(rnd.choice(["", "", " ", "\t", "  "]))
            out.append(part.lower() if rnd.random() < 0.3 else part)
            last = part.upper()
        elif last and NUMBER.fullmatch(part.strip()):
            new = number(rnd, part.strip(), last in "GMNOPDHTLSQCE")
            out.append(rnd.choice(["", "", " "]) + new)
        else:
            out.append(part)
    return "".join(out)


def comment(rnd, line):
    if rnd.random() < 0.3 and not re.search(r"[%(;]", line):
        return line + rnd.choice([" (a note)", "(X1 G0)"])
    return line


def text_of(rnd, text, dialect):
    end = rnd.choice(["\n", "\r\n"])
    out = []
    for line in text.splitlines():
        if line.startswith("%"):
            out.append(line)
            continue
        if dialect in LAST_DECIMAL and "(" not in line and ";" not in line:
            line = counted(rnd, line)
        out.append(comment(rnd, line_of(rnd, line)) +
                   rnd.choice(["", "", " ", "\t"]))
        if rnd.random() < 0.1:
            out.append("")
    return end.join(out) + end


@pytest.mark.parametrize("name", NAMES)
def test_a_layout_changes_no_place(name, wire):
    rnd = layouts()
    text = (POSTS / name).read_text()
    want, said, code = way_of(dialect_of(name), wire, text)
    assert not code and want, said
    for i in range(RUNS):
        new = text_of(rnd, text, dialect_of(name)) if name not in RECORDS else \
            text.replace("\n", rnd.choice(["\n", "\r\n", "\n\n"]))
        got, said, code = way_of(dialect_of(name), wire, new)
        assert not code and got == want, f"{i}: {said}\n{new}"


COUNTED = [p for f in FOLDER.glob("*.txt") for p in programs(f)
           if p.dialect in LAST_DECIMAL and p.kind == "way" and
           "G70" not in p.text]       # inches count ten thousandths


@pytest.mark.parametrize("p", COUNTED, ids=lambda p: p.name)
def test_a_point_changes_no_place_where_micrometres_are_counted(p, wire):
    rnd = layouts()
    want, said, code = way_of(p.dialect, wire, p.text)
    assert not code and want, said
    for i in range(4 * RUNS):
        new = text_of(rnd, p.text, p.dialect)
        got, said, code = way_of(p.dialect, wire, new)
        assert not code and got == want, f"{i}: {said}\n{new}"
