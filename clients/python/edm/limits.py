# SPDX-License-Identifier: Apache-2.0
"""edm-limits: by how much does each axis keep its limits?

It takes the trace of any machine, as `edmsim --trace` and `edmctl record` write
it, and the machine file.  No axis follows what lies within a rounding.  So the
question is whether there is a motion near to each place of the trace, as near as
a corner may be passed, that is within the limits.  A linear program finds the
least share of them that suffices.  Nothing else is known here: neither the
program of the machine, nor how its speeds were found.
"""

from __future__ import annotations

import argparse
import configparser
import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, Iterator, List, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AXES = "XYZABCUV"
KEYS = "v_max_mm_s", "a_max_mm_s2", "j_max_mm_s3"
UNITS = "mm/s", "mm/s2", "mm/s3"
WINDOW = 120            # samples at a time; half of them again with the next ones
LEAST = 8               # of fewer nothing is said
STEP_S = 1e-3           # between two samples, at least
GAP = 1.5               # steps: a cycle is missing
MOST = 1.05
DIFFERENCES = (-1, 1), (1, -2, 1), (-1, 3, -3, 1)


class Refusal(Exception):
    """What was found, where, and what would be accepted."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


# -- The least share -------------------------------------------------------------

def asked_of(x: Array, scale: Sequence[float]) -> List[Array]:
    """The speed, the acceleration and the jerk, as shares of their limits."""
    return [np.diff(x, k + 1) * scale[k] for k in range(3)]


def largest(asked: Sequence[Array]) -> float:
    return max(float(np.abs(q).max()) for q in asked)


def least_share(x: Array, width: float, limits: Sequence[float],
                dt: float) -> float:
    """Of its v, a and j, what an axis needs to be within @width of each place
    @x, a time @dt apart.  An infinite limit asks for nothing."""
    scale = [1 / (limit * dt ** (k + 1)) for k, limit in enumerate(limits)]
    asked = asked_of(x, scale)
    raw = largest(asked)
    return raw if raw <= 1 else solve(len(x), width, scale, asked)


def solve(n: int, width: float, scale: Sequence[float],
          asked: Sequence[Array]) -> float:
    """Variables: by how much of the width each place is off, and the share."""
    try:
        import highspy  # type: ignore
    except ImportError:
        raise Refusal(69, "there is no module highspy, which solves linear "
                      "programs; python3 -m pip install 'clients/python[limits]'"
                      ) from None
    starts, index, value, upper = [0], [], [], []
    for order, row in enumerate(DIFFERENCES):
        for i in range(n - order - 1 if scale[order] > 0 else 0):
            by = width * scale[order]
            for sign in 1, -1:
                index += [*range(i, i + len(row)), n]
                value += [sign * by * c for c in row] + [-1]
                upper.append(-sign * asked[order][i])
                starts.append(len(index))
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = n + 1, len(upper)
    lp.col_cost_ = np.append(np.zeros(n), 1)
    lp.col_lower_ = np.append(-np.ones(n), 0)
    lp.col_upper_ = np.append(np.ones(n), highspy.kHighsInf)
    lp.row_lower_ = np.full(len(upper), -highspy.kHighsInf)
    lp.row_upper_ = np.array(upper)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = np.array(starts)
    lp.a_matrix_.index_ = np.array(index)
    lp.a_matrix_.value_ = np.array(value)
    h = highspy.Highs()
    h.setOptionValue("output_flag", False)
    h.setOptionValue("threads", 1)
    h.passModel(lp)
    h.run()
    assert h.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return float(h.getInfo().objective_function_value)


# Lengths of means.  They often show that a window does not ask for most.
MEANS = 3, 7, 15, 31


def is_less(x: Array, width: float, limits: Sequence[float], dt: float,
            share: float) -> bool:
    """Is a mean of neighbours near enough, and within that share?"""
    scale = [1 / (limit * dt ** (k + 1)) for k, limit in enumerate(limits)]
    for n in MEANS:
        edge = np.arange(n, 0, -1)
        if len(x) <= n:
            break
        y = np.concatenate([2 * x[0] - x[edge], x, 2 * x[-1] - x[-1 - edge[::-1]]])
        for _ in range(2):
            y = np.convolve(y, np.full(n, 1 / n), "same")
        y = y[n:-n]
        if np.abs(y - x).max() <= width and largest(asked_of(y, scale)) <= share:
            return True
    return False


# -- What is read ----------------------------------------------------------------

@dataclass
class Axis:
    pulse_mm: float
    limits: Tuple[float, float, float]


def read_machine(path: Path) -> Tuple[Dict[str, Axis], float]:
    """The axes of a machine file, and its corner_um in mm."""
    ini = configparser.ConfigParser(inline_comment_prefixes=(";", "#"),
                                    strict=False)
    try:
        with open(path, encoding="utf-8") as f:
            ini.read_file(f)
        axes = {a: Axis(ini.getfloat(f"axis.{a}", "pulse_mm"), (
            ini.getfloat(f"axis.{a}", KEYS[0]),
            ini.getfloat(f"axis.{a}", KEYS[1]),
            ini.getfloat(f"axis.{a}", KEYS[2])))
            for a in AXES if ini.has_section(f"axis.{a}") and
            ini.getboolean(f"axis.{a}", "present", fallback=True)}
        return axes, ini.getfloat("speed", "corner_um") / 1000
    except OSError as e:
        raise Refusal(66, f"{path}: {e.strerror}") from None
    except (configparser.Error, ValueError) as e:
        raise Refusal(78, f"{path}: {e}; a file with all keys is wanted, as "
                      f"edmd --config {path} --print-config prints it") from None


@dataclass
class Trace:
    t_s: Array
    line: List[str]
    places: Dict[str, Array]      # mm, degrees


def read_trace(path: Path, axes: Sequence[str], of: str) -> Trace:
    """The columns of @axes, X or with @of X_sent, X_is."""
    wanted = {a: f"{a}_{of}" if of else a for a in axes}
    try:
        with open(path, newline="", encoding="utf-8") as f:
            rows = list(csv.DictReader(f))
        return Trace(np.array([float(r["t_s"]) for r in rows]),
                     [r.get("line") or "" for r in rows],
                     {a: np.array([float(r[k]) for r in rows])
                      for a, k in wanted.items()})
    except OSError as e:
        raise Refusal(66, f"{path}: {e.strerror}") from None
    except KeyError as e:
        raise Refusal(65, f"{path}: no column {e}; a trace of edmsim --trace or "
                      "edmctl record is wanted") from None
    except (TypeError, ValueError) as e:
        raise Refusal(65, f"{path}: {e}; each row has a number in each of "
                      f"t_s, {', '.join(wanted.values())}") from None


def whole_parts(t_s: Array) -> Iterator[NDArray[np.intp]]:
    """Samples of which none is missing, STEP_S or more apart."""
    if len(t_s) < LEAST:
        return
    period = float(np.median(np.diff(t_s)))
    if not period > 0:
        raise Refusal(65, "t_s does not rise; seconds of each cycle are wanted")
    each = max(1, round(STEP_S / period))
    gaps = np.nonzero(np.abs(np.diff(t_s) - period) > (GAP - 1) * period)[0] + 1
    for part in np.split(np.arange(len(t_s)), gaps):
        if len(part[::each]) >= LEAST:
            yield part[::each]


def windows(part: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
    for i in range(0, len(part), WINDOW // 2):
        if i > 0 and len(part) - i <= WINDOW // 2:
            break
        yield part[i:i + WINDOW]


# -- What is said ----------------------------------------------------------------

@dataclass
class Need:
    """The largest share of an axis's limits, and the first sample of it."""
    share: float = 0
    at: int = 0


def needs(trace: Trace, name: str, axis: Axis, width: float) -> List[Need]:
    """Of v, of a, of j, each by itself; and of all of them at once."""
    x = trace.places[name]
    only = [[limit if k == i else math.inf for k, limit in
             enumerate(axis.limits)] for i in range(3)] + [list(axis.limits)]
    ret = [Need() for _ in only]
    for part in whole_parts(trace.t_s):
        dt = float(np.median(np.diff(trace.t_s[part])))
        for some in windows(part):
            if np.ptp(x[some]) == 0:
                continue
            for need, limits in zip(ret, only):
                if is_less(x[some], width, limits, dt, need.share):
                    continue
                share = least_share(x[some], width, limits, dt)
                if share > need.share:
                    need.share, need.at = share, int(some[0])
    return ret


def show(trace: Trace, name: str, axis: Axis, found: Sequence[Need]) -> str:
    unit = [u.replace("mm", "deg") if name in "ABC" else u for u in UNITS]
    limits = ", ".join(f"{v:g} {u}" for v, u in zip(axis.limits, unit))
    all_ = found[3]
    return (f"{name}  v {found[0].share:5.3f}  a {found[1].share:5.3f}  "
            f"j {found[2].share:5.3f}  all {all_.share:5.3f}  of {limits}; most "
            f"from {trace.t_s[all_.at]:.3f} s on, line {trace.line[all_.at]}")


def run(o: argparse.Namespace) -> int:
    axes, corner_mm = read_machine(o.machine)
    trace = read_trace(o.trace, list(axes), o.of)
    bad = False
    for name, axis in axes.items():
        if len(trace.t_s) < LEAST or np.ptp(trace.places[name]) == 0:
            continue
        width = o.within_um / 1000 if o.within_um else corner_mm + axis.pulse_mm
        found = needs(trace, name, axis, width)
        bad = bad or max(n.share for n in found) > o.most
        print(show(trace, name, axis, found), flush=True)
    return 1 if bad else 0


def main() -> int:
    p = argparse.ArgumentParser(
        prog="edm-limits", description=(__doc__ or "").split("\n\n", 1)[1],
        epilog="A line for each axis that moves: the share of each limit that it "
        "needs by itself, and of all at once.  The gap servo keeps v and a, but "
        "no jerk.  Exit: 0; 1 if an axis needs more than --most; 65, 66, 69, 78 "
        "as in sysexits.h.")
    p.add_argument("machine", type=Path, help="machine file with all keys")
    p.add_argument("trace", type=Path, help="CSV of each cycle")
    p.add_argument("--of", choices=("", "sent", "is"), default="",
                   help="the places that were sent or measured; default: those of "
                   "the path")
    p.add_argument("--within-um", type=float, default=0,
                   help="how near the motion has to be, um or 0.001 degrees; "
                   "default: corner_um of the machine file and a pulse")
    p.add_argument("--most", type=float, default=MOST,
                   help="of a limit; default: %(default)s")
    try:
        return run(p.parse_args())
    except Refusal as e:
        print(f"edm-limits: {e}", file=sys.stderr)
        return e.code


if __name__ == "__main__":
    sys.exit(main())
