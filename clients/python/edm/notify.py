# SPDX-License-Identifier: Apache-2.0
"""edm-notify: calls somebody when a machine needs a person, or has a job done.

README.md beside the package has the file and what is told.  What a machine
needs is taken from its STATUS, so it is known however late one begins to
listen, and is over when the machine says so.
"""

from __future__ import annotations

import argparse
import configparser
import fcntl
import importlib
import json
import math
import os
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, NoReturn, TypeVar
from urllib.parse import quote, urlsplit

from .client import Client, NoAnswer, Refused
from .keys import KeyFileError
from .messages import Event, Status

KINDS = ("fault", "stands", "interrupted", "lost", "done")
# What somebody has done himself needs no call.
OWN_STANDS = ("", "ready", "held", "reset")
SEND_S, SILENT_S = 15.0, 10.0
AGAIN_S, AGAIN_MAX_S = 5.0, 300.0
WAITING_MAX, TEXT_MAX = 200, 1000


T = TypeVar("T")


class Wrong(Exception):
    """The file cannot be used; says what would be accepted."""


@dataclass(frozen=True)
class Message:
    """One call."""

    cause: str
    kind: str
    machine: str
    job: str
    title: str
    text: str
    link: str
    utime: int


class Kept:
    """Messages that wait, in a file, so that a kill loses none of them.  Of a
    cause only the last one waits."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.waits: OrderedDict[str, Message] = kept_in(
            path, lambda all: OrderedDict((one["cause"], Message(**one))
                                          for one in all), OrderedDict())

    def put(self, m: Message, whose: str) -> None:
        """The oldest is given up if too many wait."""
        self.waits[m.cause] = m
        if len(self.waits) > WAITING_MAX:
            lost = self.waits.popitem(last=False)[1]
            say(f"{whose}: over {WAITING_MAX} wait; given up: {lost.text}")
        self.write()

    def drop(self, m: Message) -> None:
        """It got there, unless there is another of its cause by now."""
        if self.waits.get(m.cause) is m:
            del self.waits[m.cause]
            self.write()

    def put_off(self, m: Message) -> None:
        """The others first: a way may refuse this one alone."""
        if m.cause in self.waits:
            self.waits.move_to_end(m.cause)

    def write(self) -> None:
        """Whole or not at all."""
        write_file(self.path, [asdict(m) for m in self.waits.values()],
                   "what waits is lost if this ends")


def kept_in(path: Path, of: Callable[[Any], T], nothing: T) -> T:
    """What an earlier run has left, by @of."""
    try:
        return of(json.loads(path.read_text()))
    except FileNotFoundError:
        return nothing
    except Exception as e:  # whatever is in it
        say(f"{path}: not read, begins anew: {type(e).__name__}: {e}")
        return nothing


def write_file(path: Path, what: Any, otherwise: str) -> None:
    """Whole, or the old one stays and the journal says what follows."""
    new = path.with_name(path.name + ".new")
    try:
        new.write_text(json.dumps(what))
        new.replace(path)
    except OSError as e:
        say(f"{new}: {e.strerror}; {otherwise}")


# -- Ways to somebody: each raises an Exception if it did not get there


def _command(line: str) -> Callable[[Message], None]:
    words = shlex.split(line)
    if not words or not shutil.which(words[0]):
        raise Wrong("command: without a program that can be run; "
                    "command:/path/program")

    def send(m: Message) -> None:
        subprocess.run(
            words, input=json.dumps(asdict(m)), text=True, check=True,
            stdout=sys.stderr, env=os.environ | {
                "EDM_" + k.upper(): str(v) for k, v in asdict(m).items()})
    return send


class _Stays(urllib.request.HTTPRedirectHandler):
    """A redirect would make a GET of it, which calls nobody."""

    def redirect_request(self, *a: Any) -> NoReturn:
        raise OSError(f"it redirects to {a[-1]}; write that into url")


def _webhook(url: str) -> Callable[[Message], None]:
    if not urlsplit(url).hostname:
        raise Wrong(f"{urlsplit(url).scheme}: without a host; "
                    "https://HOST/path")
    opener = urllib.request.build_opener(_Stays)

    def send(m: Message) -> None:
        r = urllib.request.Request(
            url, json.dumps(asdict(m)).encode(),
            {"Content-Type": "application/json"})
        with opener.open(r, timeout=SEND_S):
            pass
    return send


def _mqtt(url: str) -> Callable[[Message], None]:
    at = urlsplit(url)
    topic = at.path.lstrip("/")
    if not at.hostname or not topic or set(url) & set("+#"):
        raise Wrong(f"{at.scheme}://{at.hostname or ''}/{topic}: an address "
                    "and a topic without + and #; mqtt://HOST/shop/edm")
    tls = at.scheme == "mqtts"
    port = at.port or (8883 if tls else 1883)
    auth = ({"username": at.username, "password": at.password}
            if at.username else None)
    try:
        publish = importlib.import_module("paho.mqtt.publish")
    except ImportError:
        raise Wrong("mqtt needs paho-mqtt; pip install paho-mqtt, or apt "
                    "install python3-paho-mqtt") from None

    def send(m: Message) -> None:
        publish.single(topic, json.dumps(asdict(m)), qos=1,
                       hostname=at.hostname, auth=auth, port=port,
                       tls={} if tls else None)
    return send


def _apprise(url: str) -> Callable[[Message], None]:
    scheme = urlsplit(url).scheme or "?"
    try:
        apprise = importlib.import_module("apprise")
    except ImportError:
        raise Wrong(f"{scheme}: needs apprise; pip install apprise.  Without "
                    "it there are command:, http:, https: and mqtt:") from None
    to = apprise.Apprise()
    if not to.add(url):
        raise Wrong(f"{scheme}: apprise does not understand this URL")

    def send(m: Message) -> None:
        body = m.text + (f"\n{m.link}" if m.link else "")
        if not to.notify(title=m.title, body=body):
            raise OSError("apprise could not send it")
    return send


def way_of(url: str) -> Callable[[Message], None]:
    """How to send to this URL.  Raises Wrong."""
    try:
        if url.startswith("command:"):
            return _command(url[len("command:"):])
        if url.startswith(("http://", "https://")):
            return _webhook(url)
        return _mqtt(url) if url.startswith(("mqtt://", "mqtts://")) else \
            _apprise(url)
    except ValueError as e:
        raise Wrong(f"{url.partition(':')[0]}: {e}; README.md of the package "
                    "has the ways") from None


def attempt(url: str, m: Message) -> None:
    """Try it, in a process of its own: whatever the way does, it is over after
    SEND_S."""
    with subprocess.Popen([sys.executable, "-m", "edm.notify", "--send"],
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          text=True, start_new_session=True) as p:
        try:
            said, _ = p.communicate(json.dumps([url, asdict(m)]), SEND_S)
        except subprocess.TimeoutExpired:
            raise OSError(f"no end of it after {SEND_S:.0f} s") from None
        finally:
            if p.poll() is None:
                os.killpg(p.pid, signal.SIGKILL)
    if p.returncode:
        raise OSError(said.strip() or f"it ended with {p.returncode}")


def send_one() -> int:
    """The other side of attempt(), which may have been killed."""
    signal.alarm(int(2 * SEND_S))
    url, m = json.load(sys.stdin)
    try:
        way_of(url)(Message(**m))
    except Exception as e:  # whatever a service has to say
        print(f"{type(e).__name__}: {e}")
        return 1
    return 0


class Target:
    """Somebody who is called, by a thread of his own: a way that hangs keeps
    nobody waiting."""

    def __init__(self, name: str, url: str, kinds: tuple[str, ...],
                 state: Path) -> None:
        self.name, self.kinds, self._url = name, kinds, url
        way_of(url)
        self._kept = Kept(state / f"waits-{quote(name, safe='')}.json")
        self._new, self._down = threading.Condition(), False

    def start(self) -> None:
        """From now on what waits is sent."""
        threading.Thread(target=self._run, daemon=True).start()

    def put(self, m: Message) -> None:
        """Send it, now or when the way is there again."""
        if m.kind not in self.kinds:
            return
        with self._new:
            self._kept.put(m, self.name)
            self._new.notify()

    def _try(self, m: Message) -> bool:
        try:
            attempt(self._url, m)
        except OSError as e:
            if not self._down:
                say(f"{self.name}: not sent, goes on trying: {e}")
            self._down = True
            return False
        if self._down:
            say(f"{self.name}: is there again")
        self._down = False
        return True

    def _run(self) -> None:
        pause = AGAIN_S
        while True:
            with self._new:
                while not self._kept.waits:
                    self._new.wait()
                m = next(iter(self._kept.waits.values()))
            if self._try(m):
                pause = AGAIN_S
                with self._new:
                    self._kept.drop(m)
            else:
                with self._new:
                    self._kept.put_off(m)
                time.sleep(pause)
                pause = min(pause * 2, AGAIN_MAX_S)


def say(text: str) -> None:
    """To the journal."""
    print(f"edm-notify: {text}", file=sys.stderr, flush=True)


# -- What is to be told


def _needs(machine: str, s: Status | None, silent: bool) -> dict[str, Message]:
    """What the machine needs of a person now, by its cause."""
    if silent:
        return {"lost": _message("lost", "lost", machine, s or Status(),
                                 "edmd-jobs does not answer")}
    assert s is not None
    found = {}
    if s.daemon != "ok":
        found["lost"] = _message("lost", "lost", machine, s,
                                 f"edmd is {s.daemon}")
    if s.fault not in ("", "none"):
        cause = f"fault {s.fault} {s.job}"
        found[cause] = _message(cause, "fault", machine, s,
                                f"fault {s.faults or s.fault}, line {s.line}; "
                                "edmctl alarms says why and what clears it")
    elif s.interrupted:
        cause = f"interrupted {s.interrupted}"
        found[cause] = _message(cause, "interrupted", machine, s,
                                f"job {s.interrupted} was cut off; look at "
                                "the work, then resume or remove it")
    elif s.asks and s.stand not in OWN_STANDS:
        cause = f"stands {s.stand} {s.job} {s.line}"
        found[cause] = _message(cause, "stands", machine, s,
                                f"line {s.line}: {s.asks}")
    return found


def _message(cause: str, kind: str, machine: str, s: Status,
             text: str) -> Message:
    job = s.job_name or s.job
    return Message(cause, kind, machine, s.job, f"{machine}: {kind}",
                   (f"{job}: {text}" if job else text)[:TEXT_MAX], "", s.utime)


def is_quiet(hours: tuple[int, int] | None, minute: int) -> bool:
    """minute: of the day.  Hours may go over midnight."""
    if hours is None:
        return False
    begin, end = hours
    return (begin <= minute < end if begin <= end else
            minute >= begin or minute < end)


@dataclass
class Told:
    """A cause that was told: when last, and whether somebody has seen it."""

    at: float
    seen: bool = False


class Caller:
    """Decides who is told what, and when.  now: seconds since 1970."""

    def __init__(self, rules: Rules, targets: list[Target]) -> None:
        self.rules, self.targets = rules, targets
        self.later = Kept(rules.file("later.json"))     # of quiet hours
        self.told: dict[str, Told] = kept_in(
            rules.file("told.json"), lambda all: {
                k: Told(float(v[0]), bool(v[1])) for k, v in all.items()}, {})

    def _write(self) -> None:
        write_file(self.rules.file("told.json"), {
            k: (v.at, v.seen) for k, v in self.told.items()},
            "after a restart it is told again")

    def _put(self, m: Message) -> None:
        for t in self.targets:
            t.put(Message(**(asdict(m) | {"link": self.rules.page})))

    def _was_seen(self, since: float) -> bool:
        try:
            return self.rules.file("seen").stat().st_mtime > since
        except OSError:
            return False

    def look(self, needs: dict[str, Message], now: float, quiet: bool) -> None:
        """What the machine needs now; what it does not need any more is
        over.  While it is lost nobody knows."""
        before = {k: (v.at, v.seen) for k, v in self.told.items()}
        self.told = {k: v for k, v in self.told.items()
                     if k in needs or "lost" in needs}
        for cause, m in needs.items():
            t = self.told.get(cause)
            if t and not t.seen:
                t.seen = self._was_seen(t.at)
            if quiet and m.kind not in self.rules.always:
                continue
            every = self.rules.repeat_s
            # The clock may have been set back meanwhile.
            if t and (t.seen or every <= 0 or 0 <= now - t.at < every):
                continue
            self.told[cause] = Told(now)
            self._put(m)
        if {k: (v.at, v.seen) for k, v in self.told.items()} != before:
            self._write()
        if not quiet and self.later.waits:
            for m in self.later.waits.values():
                self._put(m)
            self.later.waits.clear()
            self.later.write()

    def ended(self, m: Message, quiet: bool) -> None:
        """A job is over: told once, after the quiet hours if need be."""
        if quiet and m.kind not in self.rules.always:
            self.later.put(m, "quiet hours")
        else:
            self._put(m)


# -- The file


@dataclass(frozen=True)
class Rules:
    """[notify] of the file."""

    machine: str
    key: str | None
    page: str
    repeat_s: float
    quiet: tuple[int, int] | None
    always: tuple[str, ...]
    state: Path

    def file(self, name: str) -> Path:
        """One of what is kept."""
        return self.state / name


def _minute(text: str) -> int:
    hour, minute = (int(n) for n in (text + ":0").split(":")[:2])
    if not (0 <= minute < 60 and 0 <= hour * 60 + minute <= 24 * 60):
        raise ValueError
    return hour * 60 + minute


def _kinds(where: str, text: str) -> tuple[str, ...]:
    found = tuple(text.replace(",", " ").split())
    for k in found or ("",):
        if k not in KINDS:
            raise Wrong(f"{where}: '{k}'; some of {' '.join(KINDS)}")
    return found


def _repeat_s(text: str) -> float:
    minutes = float(text)
    if not (math.isfinite(minutes) and minutes >= 0):
        raise ValueError(f"repeat_min = {text}; minutes, or 0: once")
    return 60 * minutes


def _known(c: configparser.ConfigParser) -> None:
    """A word that is not known was meant to be another one."""
    keys = {"notify": ("machine", "key", "page", "repeat_min", "quiet",
                       "always", "state"), "to": ("url", "kinds")}
    for s in c.sections():
        known = keys.get(s, keys["to"] if s.startswith("to.") else None)
        if known is None or s == "to":
            raise Wrong(f"[{s}]: no such section; [notify], and [to.NAME] for "
                        "each who is called")
        for key in set(c[s]) - set(c.defaults()) - set(known):
            raise Wrong(f"[{s}] {key}: no such key; {' '.join(known)}")


def _quiet(text: str) -> tuple[int, int] | None:
    if not text.strip():
        return None
    try:
        begin, end = (_minute(x) for x in text.split("-"))
    except ValueError:
        raise Wrong(f"[notify] quiet = {text}; two times of the day, as "
                    "22:00-06:30") from None
    return begin, end


def read_file(path: str) -> tuple[Rules, dict[str, tuple[str, Any]]]:
    """The rules, and for each target its URL and kinds.  Raises Wrong."""
    c = configparser.ConfigParser(interpolation=None)
    try:
        with open(path, encoding="utf-8") as f:
            c.read_file(f)
        _known(c)
        n = c["notify"] if "notify" in c else c["DEFAULT"]
        rules = Rules(
            n.get("machine", "edm"), n.get("key"), n.get("page", ""),
            _repeat_s(n.get("repeat_min", "10")),
            _quiet(n.get("quiet", "")),
            _kinds("[notify] always", n["always"]) if "always" in n else (),
            Path(n.get("state", "") or os.environ.get(
                "RUNTIME_DIRECTORY", "/run/edm-notify")))
        to = {s[3:]: (c[s]["url"], _kinds(f"[{s}] kinds", c[s].get(
            "kinds", " ".join(KINDS)))) for s in c.sections()
            if s.startswith("to.")}
    except (OSError, UnicodeDecodeError, ValueError, KeyError,
            configparser.Error) as e:
        raise Wrong(f"{path}: {e}; README.md of the package has an example"
                    ) from None
    if not to:
        raise Wrong(f"{path}: nobody to call; a section [to.NAME] with url =")
    return rules, to


# -- The service


class Service:
    """Follows one machine."""

    def __init__(self, rules: Rules, caller: Caller) -> None:
        self.rules, self.caller = rules, caller
        self.status: Status | None = None
        self.count, self.heard = -1, time.monotonic()

    def _quiet(self) -> bool:
        now = datetime.now()
        return is_quiet(self.rules.quiet, now.hour * 60 + now.minute)

    def on_event(self, e: Event) -> None:
        """What is over in a moment is in no STATUS."""
        if e.kind == "ended" and e.outcome == "done":
            self.caller.ended(Message(
                f"done {e.job} {e.utime}", "done", self.rules.machine, e.job,
                f"{self.rules.machine}: done", e.text[:TEXT_MAX], "", e.utime),
                self._quiet())

    def look(self, c: Client) -> None:
        """Take what came, and tell what there is to tell."""
        c.hear(0.2)
        s, n = c.last_status()
        if n != self.count:
            self.status, self.count = s, n
            self.heard = time.monotonic()
        silent = time.monotonic() - self.heard > SILENT_S
        if self.status or silent:
            self.caller.look(_needs(self.rules.machine, self.status, silent),
                             time.time(), self._quiet())

    def follow(self) -> None:
        """Until the machine cannot be followed."""
        with Client(self.rules.machine, self.rules.key) as c:
            c.on_event = self.on_event
            while True:
                self.look(c)


def keep_others_out(state: Path) -> None:
    """Two would send what waits there twice.  Raises Wrong."""
    try:
        # It is open until this process ends.
        fd = os.open(state / "lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC,
                     0o600)
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise Wrong(f"{state}: another edm-notify uses it; [notify] state = "
                    "another folder") from None
    except OSError:     # nothing is kept there, and nothing comes twice
        pass


def serve(path: str) -> int:
    """Never gives up: edmd-jobs may come later."""
    rules, to = read_file(path)
    targets = [Target(n, url, kinds, rules.state)
               for n, (url, kinds) in to.items()]
    keep_others_out(rules.state)
    for t in targets:
        t.start()
    service = Service(rules, Caller(rules, targets))
    say(f"machine {rules.machine}, calls {' '.join(to)}")
    while True:
        try:
            service.follow()
        except (OSError, NoAnswer, Refused) as e:
            say(f"{e}; goes on trying")
            time.sleep(AGAIN_S)


def try_all(path: str) -> int:
    """A call to everybody, to see that it gets there."""
    rules, to = read_file(path)
    failed = 0
    for name, (url, _) in to.items():
        try:
            way_of(url)
            attempt(url, Message(
                "test", "done", rules.machine, "", f"{rules.machine}: test",
                "edm-notify calls you when the machine needs a person",
                rules.page, time.time_ns() // 1000))
            print(f"{name}: sent")
        except OSError as e:
            print(f"{name}: {e}")
            failed = 1
    return failed


def main() -> int:
    """Return: as sysexits.h."""
    p = argparse.ArgumentParser(prog="edm-notify", description=__doc__)
    p.add_argument("--config", default="/etc/edmd/notify.ini")
    p.add_argument("--try", dest="test", action="store_true",
                   help="call everybody once, and end")
    p.add_argument("--seen", action="store_true",
                   help="somebody is on the way: repeat nothing that was told")
    p.add_argument("--send", action="store_true", help=argparse.SUPPRESS)
    a = p.parse_args()
    try:
        if a.send:
            return send_one()
        if a.seen:
            read_file(a.config)[0].file("seen").touch()
            return 0
        return try_all(a.config) if a.test else serve(a.config)
    except (Wrong, KeyFileError) as e:
        say(str(e))
        return 78
    except OSError as e:
        say(f"{e.filename}: {e.strerror}")
        return 77
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
