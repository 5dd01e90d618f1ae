# SPDX-License-Identifier: Apache-2.0
"""A client: asks until it is answered, and believes what is signed."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from nacl.exceptions import BadSignatureError
from nacl.signing import VerifyKey

from .keys import Key, KeyFileError, find_key, read_key
from .layout import to_be_signed
from .messages import Ack, Command, Event, JobChunk, Signed, Status
from .stop import VERBS, Stop, act_id
from .way import Way

CHUNK = 32768
WINDOW = 6
REPEAT_S = 0.3
AGAIN = 100
OVER = ("done", "fault", "stopped")


class NoAnswer(Exception):
    """The service did not answer in time: it was done, or not."""


class Refused(Exception):
    """The answer is no."""

    def __init__(self, ack: Ack) -> None:
        super().__init__(ack.reason)
        self.code, self.reason, self.body = ack.code, ack.reason, ack.body


@dataclass(frozen=True)
class Job:
    """A job as the service has it: its id, and all it says of it."""

    id: str
    about: dict[str, Any]


class Client:
    """Commands one machine.  One object belongs to one thread.

    key: a key file; without it that of $EDM_KEY, or the host's own.
    url: that of LCM; without it the socket of this host, else way.URL.
    timeout: how long an answer is waited for, s.
    """

    def __init__(self, machine: str = "edm", key: str | None = None,
                 url: str | None = None, timeout: float = 3.0) -> None:
        self.key: Key = read_key(key) if key else find_key(machine)
        if self.key.machine != machine:
            raise KeyFileError(
                f"the key is of machine {self.key.machine}, and machine "
                f"{machine} is asked for; name the other key, or the other "
                "machine")
        self.machine, self.timeout = machine, timeout
        self.name = f"python-{os.getpid()}-{secrets.token_hex(8)}"
        self._verify = VerifyKey(self.key.machine_key)
        self._seq = self._boot = self._ahead = self._count = self._heard = 0
        self._hello, self._hello_s = 0, 0.0
        # Boot and clock of a status that may be a recording.
        self._guess = self._guess_ahead = 0
        self._waits: dict[int, Ack | None] = {}
        self._status: Status | None = None
        self._statuses = 0
        self.on_event: Callable[[Event], None] | None = None
        self._is_here = url is None and self.key.role != "viewer"
        self._way = Way(machine, url)
        self._takes: dict[str, Callable[[Signed], None]] = {
            f"EDM.{machine}.ACK": self._take_ack,
            f"EDM.{machine}.STATUS": self._take_status,
            f"EDM.{machine}.EVENT": self._take_event,
        }

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self._way.close()

    # -- Signing and believing

    @staticmethod
    def _now() -> int:
        return time.monotonic_ns() // 1000

    def _publish(self, name: str, data: bytes) -> None:
        now = self._now() + self._ahead if self._boot else 0
        self._count = max(self._count + 1, now)
        self._sign(name, self._boot, self._count, data)

    def _sign(self, name: str, boot: int, count: int, data: bytes) -> None:
        channel = f"EDM.{self.machine}.{name}"
        signed = self.key.secret.sign(
            to_be_signed(channel, boot, count, data))
        self._way.publish(channel, Signed(
            self.key.public, boot, count, signed.signature, data).encode())

    def _take(self, channel: str, packet: bytes) -> None:
        take = self._takes.get(channel)
        try:
            s = Signed.decode(packet)
            if not take or s.key != self.key.machine_key:
                return
            self._verify.verify(
                to_be_signed(channel, s.boot, s.count, s.data), s.signature)
        except (ValueError, BadSignatureError):
            return
        take(s)

    def _is_news(self, s: Signed) -> bool:
        if not self._boot or s.boot != self._boot:
            self._guess, self._guess_ahead = s.boot, s.count - self._now()
            self._say_hello()
            return False
        if s.count <= self._heard:
            return False
        self._heard = s.count
        return True

    def _learn(self, s: Signed) -> None:
        if s.boot != self._boot:
            self._count, self._heard = 0, s.count
        self._boot, self._ahead = s.boot, s.count - self._now()
        self._hello = 0

    def _take_ack(self, s: Signed) -> None:
        a = Ack.decode(s.data)
        if a.client != self.name or a.key != self.key.public:
            return
        if a.seq not in self._waits and a.seq != self._hello:
            return
        if a.code == AGAIN or (a.seq == self._hello and a.code == 0):
            self._learn(s)
        elif a.seq == self._hello:
            raise Refused(a)
        if a.seq in self._waits and a.code != AGAIN:
            self._waits[a.seq] = a

    def _take_status(self, s: Signed) -> None:
        if self._is_news(s):
            self._status = Status.decode(s.data)
            self._statuses += 1

    def _take_event(self, s: Signed) -> None:
        if self._is_news(s) and self.on_event:
            self.on_event(Event.decode(s.data))

    def _say_hello(self) -> None:
        if time.monotonic() - self._hello_s < 0.2:
            return
        self._hello_s = time.monotonic()
        self._hello = self._hello or self._number()
        hello = Command(0, self.name, self._hello, "hello").encode()
        if self._guess and self._guess != self._boot:
            self._sign("COMMAND", self._guess,
                       self._now() + self._guess_ahead, hello)
        else:
            self._publish("COMMAND", hello)

    def _number(self) -> int:
        self._seq += 1
        return self._seq

    def hear(self, seconds: float = 0.05) -> None:
        """Take what comes, for so long at most."""
        if not self._boot:
            self._say_hello()
        packet = self._way.take(seconds)
        if packet:
            self._take(*packet)

    def _until(self, what: Callable[[], bool], timeout: float,
               again: Callable[[], None]) -> None:
        end, due = time.monotonic() + timeout, 0.0
        boot = self._boot
        while not what():
            now = time.monotonic()
            if now > end:
                raise NoAnswer(f"no answer from edmd-jobs of machine "
                               f"{self.machine}; is it running?")
            if self._boot and (now > due or boot != self._boot):
                boot, due = self._boot, now + REPEAT_S
                again()
            self.hear(0.02)

    # -- Asking

    def ask(self, verb: str, job: str = "", arg: float = 0.0,
            text: str = "", timeout: float | None = None) -> Ack:
        """Ask until it is answered.  Raises Refused unless the code is 0."""
        seq = self._number()
        self._waits[seq] = None
        act = self._end_motion(verb, seq)
        try:
            self._until(
                lambda: self._waits[seq] is not None or
                (act is not None and act.is_done()), timeout or self.timeout,
                lambda: self._publish("COMMAND", Command(
                    time.time_ns() // 1000, self.name, seq, verb, job, arg,
                    text).encode()))
            answer = self._waits[seq] or Ack(
                client=self.name, seq=seq, reason="done by edmd itself; "
                "edmd-jobs does not answer")
        finally:
            del self._waits[seq]
            if act:
                act.close()
        if answer.code:
            raise Refused(answer)
        return answer

    def _end_motion(self, verb: str, seq: int) -> Stop | None:
        """On the machine's host: such an act goes to edmd itself, too."""
        if not self._is_here or verb not in VERBS:
            return None
        return Stop(self.machine, verb,
                    act_id(self.key.public, self.name, seq))

    def _json(self, verb: str, job: str = "", arg: float = 0.0) -> Any:
        return json.loads(self.ask(verb, job, arg).body)

    def _pages(self, verb: str, rows: int = 0) -> list[dict[str, Any]]:
        """A list that may not fit one answer: each page begins behind the
        last job of the one before."""
        found: list[dict[str, Any]] = []
        while True:
            page = self._json(verb, found[-1]["job"] if found else "",
                              max(rows - len(found), 0))
            found += page
            if not page or 0 < rows <= len(found):
                return found

    def start(self, job: str = "") -> None:
        """Start the job that is ready or held, and the queue."""
        self.ask("start", job)

    def hold(self) -> None:
        """Power off, stop on the path."""
        self.ask("hold")

    def resume(self, job: str = "", axes: str = "") -> None:
        """Go on after a hold; or with a job that was interrupted.

        `axes`: letters of those that cannot be homed and whose places are
        right all the same, as the caller has seen.
        """
        self.ask("resume", job, text=axes)

    def stop(self) -> None:
        """End the job where it stands."""
        self.ask("stop")

    def estop(self) -> None:
        """Power off, no motion, until reset."""
        self.ask("estop")

    def reset(self) -> None:
        """Leave the fault, to held."""
        self.ask("reset")

    def retract(self, mm: float) -> None:
        """Back along the path, then held."""
        self.ask("retract", arg=mm)

    def step(self, nodes: int) -> None:
        """Held: to the Nth node of the path, ahead or back."""
        self.ask("step", arg=nodes)

    def done(self, number: int = 0) -> None:
        """What the job asks for is done; number: the electrode that is in."""
        self.ask("done", arg=number)

    def jog(self, axis: str, mm: float) -> None:
        """Idle: move one axis so far."""
        self.ask("jog", text=axis, arg=mm)

    def home(self, axis: str = "") -> None:
        """Idle: find the place of one axis, or of all."""
        self.ask("home", text=axis)

    def place(self, axis: str, mm: float) -> None:
        """Idle: say where an axis stands that nothing homes."""
        self.ask("place", text=f"{axis} is", arg=mm)

    def override(self, factor: float) -> None:
        """Speed of positioning, 0 to 2 times what is programmed."""
        self.ask("override", arg=factor)

    def set(self, field: str, value: float | None) -> None:
        """A value of the condition in force; None takes it back."""
        self.ask("set", text=field,
                 arg=float("nan") if value is None else value)

    def remove(self, job: str) -> None:
        """Take a job that has not begun out of the queue."""
        self.ask("remove", job)

    def queue(self) -> list[dict[str, Any]]:
        """The job loaded and those behind it."""
        return self._pages("queue")

    def history(self, rows: int = 0) -> list[dict[str, Any]]:
        """Jobs that have ended, newest first; all, or so many rows."""
        return self._pages("history", rows)

    def alarms(self) -> list[dict[str, Any]]:
        """The last alarms, newest first."""
        return list(self._json("alarms"))

    def show(self, job: str) -> dict[str, Any]:
        """All about one job."""
        return dict(self._json("show", job))

    # -- Jobs

    def submit(self, text: bytes, name: str, id: str | None = None,
               hold: bool = False, timeout: float = 120.0,
               from_line: int = 0, from_mm: float = 0.0,
               electrode: int = 0, setting: str = "") -> Job:
        """Send a job; returns when it is in the queue.

        from_line, from_mm: begin at this line of the text, or at this place
        of its path; the job then waits for start.
        electrode: it begins with this one; 0: with the one in the holder.
        setting: what is set for it, as "taper=3 turn=90" (docs/3b.md).
        id: the same id twice is one job; drawn without.
        name: for people; its end names the dialect.
        timeout: for all of it, compiling too.
        """
        job = id or secrets.token_hex(6)
        pieces = [text[i:i + CHUNK] for i in range(0, len(text), CHUNK)]
        pieces = pieces or [b""]
        digest = hashlib.sha256(text).digest()
        seqs = [self._number() for _ in pieces]
        for seq in seqs:
            self._waits[seq] = None

        def chunk(i: int) -> bytes:
            return JobChunk(
                time.time_ns() // 1000, self.name, seqs[i], job, name,
                len(text), digest, i, len(pieces), i * CHUNK, hold, from_line,
                from_mm, electrode, setting, pieces[i]).encode()

        try:
            verdict = self._send_chunks(seqs, chunk, timeout)
        finally:
            for seq in seqs:
                del self._waits[seq]
        if verdict.code:
            raise Refused(verdict)
        return Job(job, json.loads(verdict.body))

    def _verdict(self, seqs: list[int]) -> Ack | None:
        for seq in seqs:
            a = self._waits[seq]
            if a is not None and (a.code or a.body):
                return a
        return None

    def _send_chunks(self, seqs: list[int], chunk: Callable[[int], bytes],
                     timeout: float) -> Ack:
        end = time.monotonic() + timeout
        sent = [0.0] * len(seqs)
        first, reminded = 0, time.monotonic()
        while not (verdict := self._verdict(seqs)):
            now = time.monotonic()
            if now > end:
                raise NoAnswer("no word of what became of the job")
            while first < len(seqs) and self._waits[seqs[first]] is not None:
                first += 1
            for i in range(first, min(first + WINDOW, len(seqs))):
                if (self._boot and self._waits[seqs[i]] is None
                        and now - sent[i] > REPEAT_S):
                    self._publish("JOB", chunk(i))
                    sent[i] = now
            if first == len(seqs) and now - reminded > 1:
                reminded = now
                self._publish("JOB", chunk(0))
            self.hear(0.02)
        return verdict

    # -- Status

    def status(self, timeout: float | None = None) -> Status:
        """The first that is told from now on."""
        wait = timeout or self.timeout
        end = time.monotonic() + wait
        # What came since anything was asked last is old.
        while self._way.waits() and time.monotonic() < end:
            self.hear(0)
        n = self._statuses
        self._until(lambda: self._statuses > n, wait, lambda: None)
        assert self._status is not None
        return self._status

    def last_status(self) -> tuple[Status | None, int]:
        """The last one that hear() took, and how many there were."""
        return self._status, self._statuses

    def follow(self, job: str) -> Iterator[Status]:
        """Statuses, until the job has ended."""
        while self.show(job)["state"] not in OVER:
            yield self.status()
