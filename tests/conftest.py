# SPDX-License-Identifier: Apache-2.0
"""What all tests share: signals as a terminal's shell leaves them.

A program that is started by `nohup`, by `&` in a script or by a service
manager may ignore SIGHUP or SIGINT, and what it starts inherits that.  A shell
script cannot trap a signal that it ignored when it began.
"""

import signal

signal.signal(signal.SIGHUP, signal.SIG_DFL)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)
signal.signal(signal.SIGTERM, signal.SIG_DFL)
signal.signal(signal.SIGINT, signal.default_int_handler)
