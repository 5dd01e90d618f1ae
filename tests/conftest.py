# SPDX-License-Identifier: Apache-2.0
"""What all tests share: signals as a terminal's shell leaves them, no size of
its window, a network for each process of tests, and what a host must let a test
do.

A program that is started by `nohup`, by `&` in a script or by a service
manager may ignore SIGHUP or SIGINT, and what it starts inherits that.  A shell
script cannot trap a signal that it ignored when it began.

A test that needs more than an ordinary container allows says so:

    @pytest.mark.needs("a network of its own")

Elsewhere it is skipped, and the reason is counted at the end.
"""

import collections
import ctypes
import functools
import os
import re
import signal
import subprocess

import pytest

CLONE_NEWNET = 0x40000000
WORKER = os.environ.get("PYTEST_XDIST_WORKER", "")


def own_network():
    """Loopback with multicast, as tests/netns makes it: two processes of tests
    side by side hear each other's machines otherwise."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWNET) < 0:
        e = ctypes.get_errno()
        raise OSError(e, f"a network of its own: {os.strerror(e)}; run pytest "
                      "-n under tests/netns")
    for command in ("link set lo up multicast on",
                    "route add 224.0.0.0/4 dev lo"):
        subprocess.run(["ip", *command.split()], check=True)


def own_addresses():
    """Beside others in the network that tests/netns found: of LCM the next
    port, of DDS another tag."""
    env, n = os.environ, int(WORKER.removeprefix("gw"))
    env["LCM_DEFAULT_URL"] = re.sub(
        r":(\d+)\?", lambda m: f":{int(m[1]) + 1 + n}?", env["LCM_DEFAULT_URL"])
    env["CYCLONEDDS_URI"] = env["CYCLONEDDS_URI"].replace(
        "</Tag>", f"-{n}</Tag>")


if WORKER:
    own_addresses() if "EDM_NET" in os.environ else own_network()
# A terminal that a test makes has a size of its own.
for name in ("COLUMNS", "LINES"):
    os.environ.pop(name, None)

signal.signal(signal.SIGHUP, signal.SIG_DFL)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)
signal.signal(signal.SIGTERM, signal.SIG_DFL)
signal.signal(signal.SIGINT, signal.default_int_handler)

# -- What the host lets a test do

# Each with a command that ends in order where it is allowed.
NEEDS = {
    "a network of its own": ["unshare", *["-r"] * (os.geteuid() != 0), "-n",
                             "ip", "link", "set", "lo", "up"],
    "mounts of its own": ["unshare", "-m", "mount", "-t", "tmpfs", "tmpfs",
                          "/dev/shm"],
    "another user": ["setpriv", "--reuid", "65534", "--regid", "65534",
                     "--clear-groups", "true"],
    "to trace a process": ["strace", "-o", "/dev/null", "true"],
}


@functools.cache
def refusal(need):
    """Why it is not allowed here; "" if it is."""
    p = subprocess.run(NEEDS[need], capture_output=True, text=True)
    return p.stderr.strip().splitlines()[-1] if p.stderr and p.returncode \
        else "not allowed" * (p.returncode != 0)


def pytest_configure(config):
    config.addinivalue_line(
        "markers", "needs(what, ...): skipped where the host does not allow it")


def pytest_runtest_setup(item):
    for mark in item.iter_markers("needs"):
        for need in mark.args:
            if why := refusal(need):
                pytest.skip(f"needs {need}: {why}")


# -- What a test leaves behind

def strange_files():
    """Files of the source tree that git does not know; none where git says
    nothing of it."""
    p = subprocess.run(["git", "ls-files", "-o", "-z", "--exclude-standard"],
                       capture_output=True)
    return {os.fsdecode(f) for f in p.stdout.split(b"\0") if f}


def pytest_sessionstart(session):
    session.strange_before = set() if WORKER else strange_files()
    if COUNTS:
        session.config.pluginmanager.register(Lines(session))


def pytest_sessionfinish(session):
    """A test writes in a folder of its own alone."""
    left = set() if WORKER else strange_files() - session.strange_before
    if left:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        print("\nleft in the source tree by a test:", *map(repr, sorted(left)))


def pytest_terminal_summary(terminalreporter):
    """The reasons, each with how many tests it kept from running."""
    skipped = collections.Counter(
        r.longrepr[2].removeprefix("Skipped: ")
        for r in terminalreporter.stats.get("skipped", []))
    for reason, n in sorted(skipped.items()):
        terminalreporter.write_line(f"skipped {n}: {reason}")
    if COUNTS:
        with open(COUNTS, "a", encoding="utf-8") as f:
            print("passed", len(terminalreporter.stats.get("passed", [])),
                  sep="\t", file=f)
            for reason, n in skipped.items():
                print("skipped", n, reason, sep="\t", file=f)
    if os.environ.get("EDM_COUNTS_ALL"):
        tell_all(terminalreporter)


def tell_all(terminalreporter):
    """What passed in all parts so far, before pytest's own last line."""
    passed, skipped = 0, collections.Counter()
    with open(COUNTS, encoding="utf-8") as f:
        for kind, n, *reason in (line.rstrip("\n").split("\t") for line in f):
            if kind == "passed":
                passed += int(n)
            else:
                skipped[reason[0]] += int(n)
    for reason, n in sorted(skipped.items()):
        terminalreporter.write_line(f"skipped in all parts {n}: {reason}")
    terminalreporter.write_line(
        f"{passed} tests passed in all parts, {sum(skipped.values())} skipped")


# -- Beside others, as in `make check`: lines in place of dots

COUNTS = "" if WORKER else os.environ.get("EDM_COUNTS", "")


def pytest_report_teststatus(report):
    if not COUNTS:
        return None
    if report.when == "call" or report.skipped:
        return report.outcome, "", ""
    return "error" if report.failed else "", "", ""


class Lines:
    """How many tests of how many have ended, each tenth of them; and at once
    each that failed."""

    def __init__(self, session):
        self.session, self.ended, self.told = session, 0, 0

    def pytest_runtest_logreport(self, report):
        if report.failed:
            print(f"  FAILED  {report.nodeid}", flush=True)
        self.ended += report.when == "teardown"
        tenth = 10 * self.ended // max(self.session.testscollected, 1)
        if tenth > self.told:
            self.told = tenth
            folder = os.path.dirname(report.fspath)
            print(f"  TESTS   {folder}: {self.ended} of "
                  f"{self.session.testscollected}", flush=True)
