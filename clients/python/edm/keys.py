# SPDX-License-Identifier: Apache-2.0
"""Key files, as messages/README.md says."""

from __future__ import annotations

import os
import pwd
import stat
from dataclasses import dataclass, field
from pathlib import Path

from nacl.signing import SigningKey

STORE = Path("/var/lib/edmd")
SHARED = Path("/dev/shm")
SERVICE_USER = "edm-jobs"
FILE_MAX = 2048


class KeyFileError(Exception):
    """A key file that cannot be used; says what mends it."""


@dataclass(frozen=True)
class Key:
    """Somebody's key pair, and the machine's public key."""

    machine: str
    name: str
    role: str
    machine_key: bytes
    public: bytes
    secret: SigningKey = field(repr=False)


def _check(about: os.stat_result, path: Path, shared: bool) -> None:
    mode = about.st_mode
    if not stat.S_ISREG(mode):
        raise KeyFileError(f"key file {path} is not a plain file")
    if shared and not is_trusted(about.st_uid):
        raise KeyFileError(
            f"key file {path} belongs to a user who is neither root nor "
            f"{SERVICE_USER} nor you, so it is not used; remove it")
    if mode & 0o007:
        raise KeyFileError(
            f"key file {path} has mode {stat.S_IMODE(mode):04o}: everyone on "
            "this host may use it, and it counts as known to all; take the key "
            "back with edmctl keys remove, and make a new one")
    if mode & 0o020:
        raise KeyFileError(
            f"key file {path}: its group may write it; chmod g-w {path}")


def _read(path: Path, shared: bool) -> str:
    """Checked when it is open: a name may be another file a moment later."""
    fd = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK
                 | (os.O_NOFOLLOW if shared else 0))
    try:
        _check(os.fstat(fd), path, shared)
        return os.read(fd, FILE_MAX).decode("ascii")
    finally:
        os.close(fd)


def read_key(path: str | os.PathLike[str], shared: bool = False) -> Key:
    """Read and check a key file.

    shared: it lies where anybody may have made it, so its owner counts.
    """
    at = Path(path)
    try:
        text = _read(at, shared)
    except FileNotFoundError:
        raise KeyFileError(
            f"there is no key file {at}; edmd-jobs makes the host's key when "
            "it starts, and edmctl keys add NAME makes others") from None
    except PermissionError:
        raise KeyFileError(
            f"key file {at} may not be read by this user; who is in group edm "
            "may command: usermod -aG edm NAME, then log in again") from None
    except UnicodeDecodeError:
        raise KeyFileError(f"key file {at} is no text") from None
    except OSError as e:
        raise KeyFileError(f"key file {at}: {e.strerror}") from None
    return _parse(at, text)


def _parse(path: Path, text: str) -> Key:
    words: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        parts = line.split("#")[0].split()
        if len(parts) not in (0, 2):
            raise KeyFileError(f"key file {path}:{number}: not a word and its "
                               "value")
        if parts:
            words[parts[0]] = parts[1]
    try:
        if words["edmd-key"] != "1":
            raise KeyFileError(f"key file {path} is of version "
                               f"{words['edmd-key']}; this reads version 1")
        secret = SigningKey(bytes.fromhex(words["secret"]))
        key = Key(words["machine"], words["name"], words["role"],
                  bytes.fromhex(words["machine-key"]),
                  bytes.fromhex(words["public"]), secret)
    except KeyError as e:
        raise KeyFileError(f"key file {path} has no line {e}; it is cut "
                           "short, or no key file") from None
    except ValueError:
        raise KeyFileError(f"key file {path}: a key is 64 hex digits") from None
    if bytes(secret.verify_key) != key.public or len(key.machine_key) != 32:
        raise KeyFileError(f"key file {path}: its public key is not that of "
                           "its secret; make a new one")
    return key


def is_trusted(uid: int, service: str = SERVICE_USER) -> bool:
    """Is it root, the service, or this user?"""
    if uid in (0, os.geteuid()):
        return True
    try:
        return uid == pwd.getpwnam(service).pw_uid
    except KeyError:
        return False


def find_key(machine: str) -> Key:
    """The key this user has for the machine on this host: that of $EDM_KEY,
    the one edmd-jobs keeps, or that of a service started by hand."""
    named = os.environ.get("EDM_KEY")
    if named:
        return read_key(named)
    stored, shared = STORE / f"{machine}.key", SHARED / f"edmd.{machine}.key"
    if os.access(stored, os.R_OK) or not shared.exists():
        return read_key(stored)
    return read_key(shared, shared=True)
