# SPDX-License-Identifier: Apache-2.0
"""Command an edmd machine: signed messages over LCM."""

from .client import Client, NoAnswer, Refused
from .keys import Key, KeyFileError, find_key, read_key
from .messages import Ack, Event, Status

__all__ = [
    "Ack", "Client", "Event", "Key", "KeyFileError", "NoAnswer", "Refused",
    "Status", "find_key", "read_key",
]
