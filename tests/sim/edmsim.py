# SPDX-License-Identifier: Apache-2.0
"""edmsim.py - run the program edmsim and read what it wrote.

EDM_BUILD names the folder the program is in; default: build.
"""
import json
import os
import pathlib
import random
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = str(ROOT / os.environ.get("EDM_BUILD", "build") / "edmsim")
AXES = "XYZABCUV"
STRATEGIES = ["simultaneous", "point-by-point"]


def machine_text(keys="offset_1_mm = 0.14", guides="off", between=(-20, 80),
                 planes=(0, 40), more=""):
    """A machine file: keys of [wire], guides at two heights, and the planes of
    a program.  With guides there are no other axes than X Y U V."""
    text = f"[machine]\nname = m\n[wire]\n{keys}\n"
    if guides != "off":
        text += (f"guides = {guides}\nz_lower_mm = {between[0]}\n"
                 f"z_upper_mm = {between[1]}\nz_program_mm = {planes[0]}\n"
                 f"z_second_mm = {planes[1]}\n")
        text += "".join(f"[axis.{a}]\npresent = no\n" for a in "ZABC")
    return text + more


# Ends what hangs: far above what any run needs, because a busy host is slow.
HANGS_S = 3600


def run(*args, text=None, **more):
    """Run edmsim; text goes to its stdin as the job."""
    if text is not None:
        args += ("-",)
        if isinstance(text, str):
            text = text.encode()
    return subprocess.run([PROGRAM, "--quiet", *map(str, args)], input=text,
                          capture_output=True, timeout=HANGS_S, **more)


def done(*args, text=None):
    """Run edmsim, which must succeed."""
    r = run(*args, text=text)
    assert r.returncode == 0, (r.returncode, r.stderr[-500:])
    return r


def report(*args, text=None):
    return json.loads(done("--report", "-", *args, text=text).stdout)


def pulses(*args, text=None, rows_of=done):
    """Rows of --pulses: (line, X, Y, Z, A, B, C, U, V)."""
    rows = rows_of("--pulses", "-", *args, text=text).stdout.splitlines()
    assert rows[0] == b"cycle,line,X,Y,Z,A,B,C,U,V"
    return [tuple(map(int, r.split(b",")[1:])) for r in rows[1:]]


def places(*args, text=None):
    """Rows of --pulses without cycle and line."""
    return [r[1:] for r in pulses(*args, text=text)]


def legs(rows):
    """The rows of each line, with the place it starts from before them."""
    ret, at = {}, rows[0][1:]
    for line, *place in rows[1:]:
        leg = ret.setdefault(line, [at])
        at = tuple(place)
        leg.append(at)
    return ret


def assert_neighbours(rows):
    """Each differs by at most a pulse an axis, and from the one before."""
    for a, b in zip(rows, rows[1:]):
        d = [abs(p - q) for p, q in zip(a, b)]
        assert max(d) == 1, (a, b)


def seeded():
    """A generator of random numbers; the seed is printed, EDM_SEED sets it."""
    seed = int(os.environ.get("EDM_SEED", time.time_ns() % 1000000))
    print(f"EDM_SEED={seed}")
    return random.Random(seed)
