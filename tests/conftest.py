# SPDX-License-Identifier: Apache-2.0
"""What all tests share: signals as a terminal's shell leaves them, no size of
its window, and a network for each process of tests.

A program that is started by `nohup`, by `&` in a script or by a service
manager may ignore SIGHUP or SIGINT, and what it starts inherits that.  A shell
script cannot trap a signal that it ignored when it began.
"""

import ctypes
import os
import signal
import subprocess

CLONE_NEWNET = 0x40000000


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


if "PYTEST_XDIST_WORKER" in os.environ:
    own_network()
# A terminal that a test makes has a size of its own.
for name in ("COLUMNS", "LINES"):
    os.environ.pop(name, None)

signal.signal(signal.SIGHUP, signal.SIG_DFL)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)
signal.signal(signal.SIGTERM, signal.SIG_DFL)
signal.signal(signal.SIGINT, signal.default_int_handler)
