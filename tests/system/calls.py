# SPDX-License-Identifier: Apache-2.0
"""System calls of edmd's threads, each time one of them wakes.

        tests/netns .venv/bin/python tests/system/calls.py

Prints the table of docs/performance.md; test_calls.py compares it with what is
there.  It has no clock: strace writes down each call, and what a thread calls is
counted from wait to wait.
"""
import contextlib
import pathlib
import re
import sys
import tempfile
from collections import Counter

import rig

WAKES = 100
PERIODS_US = 1000, 250
WAITS = {"the cycle": "clock_nanosleep", "main": "rt_sigtimedwait"}
HEAD = "| thread of edmd | machine | system calls each time it wakes |"

# Long enough to be looked at on a machine that is busy.
JOB = b"G21 G90\nM3\nG1 Z-40 F5\nM30\n"
MACHINE = """
[machine]
name = {name}
backend = sim
period_us = %d
overrun_limit = 0
cpu = -1

[jump]
every_s = 0.5

[jobs]
store = {store}
"""


class Traced(rig.Machine):
    """strace is beside edmd here, not around it: signals go to edmd."""

    def __init__(self, folder, period_us):
        super().__init__(folder, MACHINE % period_us)
        self.calls = pathlib.Path(folder) / "calls"

    def _command(self, program):
        if program != "edmd":
            return super()._command(program)
        return ["strace", "-D", "-f", "-o", str(self.calls),
                *super()._command(program)]

    def read(self):
        """[(thread, call)], in the order of the calls."""
        # Where there is no vdso for it, the time of day is a call as well.
        return [(tid, call) for tid, call in re.findall(
            r"^(\d+) +(\w+)\(", self.calls.read_text(), re.M)
            if call != "clock_gettime"]

    def threads(self):
        """{thread: name}; the first of all calls is main's."""
        calls = self.read()
        cycle = next(tid for tid, call in calls if call == WAITS["the cycle"])
        return {cycle: "the cycle", calls[0][0]: "main"}

    def counted(self):
        """{thread: its calls}, from now on until each has woken often."""
        begun, names = len(self.read()), self.threads()

        def enough():
            of = {}
            for tid, call in self.read()[begun:]:
                name = names.get(tid, "the others")
                of.setdefault(name, Counter())[call] += 1
            return all(of.get(name, {}).get(wait, 0) >= WAKES
                       for name, wait in WAITS.items()) and of

        return rig.until(enough, timeout=20, step=0.2)


def each_wake(of, name):
    """As `1 clock_nanosleep`; what there is less than once has decimals."""
    wakes = of[name][WAITS[name]]
    return ", ".join(f"{n / wakes:.4g} `{call}`"
                     for call, n in of[name].most_common())


def rows_of(m, period_us):
    m.start()
    idle = m.counted()
    assert m.client.submit(JOB, "cut").code == 0
    m.client.status_where(lambda s: s.state == "erode", timeout=20)
    at_work = m.counted()
    at = f"period {period_us} us"
    # To write the log, main wakes another thread: not while it is idle.
    return [("the cycle", f"{at}, idle", each_wake(idle, "the cycle")),
            ("the cycle", f"{at}, eroding", each_wake(at_work, "the cycle")),
            ("main", f"{at}, idle", each_wake(idle, "main")),
            ("the others", f"{at}, idle",
             ", ".join(idle.get("the others", ())) or "they do not wake")]


def table(folder):
    """Its lines."""
    lines = [HEAD, "|---|---|---|"]
    for period_us in PERIODS_US:
        with Traced(pathlib.Path(folder) / str(period_us), period_us) as m:
            lines += [f"| {' | '.join(r)} |" for r in rows_of(m, period_us)]
    return lines


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as d:
        with contextlib.redirect_stdout(sys.stderr):
            lines = table(d)
        print("\n".join(lines))
