# SPDX-License-Identifier: Apache-2.0
"""A cut that is disturbed at random: generator_ill.py FOLDER SEED EVENTS

The generator is a Modbus slave by the text of the protocol alone.  It takes what is
written at once, has it only some time later, in the order of the writes, and tells
in its input registers what it has.  edmd is killed, held, moved back, stopped by a
switch, shorted, a person sets a current and takes it back, and the generator is
switched off and on.  Prints JSON: what the
generator had and when, and when edmd was killed, by CLOCK_MONOTONIC as the kernel's
trace.
"""
import contextlib
import json
import pathlib
import random
import socket
import struct
import subprocess
import sys
import threading
import time

PORT, FIRST, NREGISTERS, TELLS = 5020, 10, 6, 30
SLOW_S = 0.15
now = time.monotonic


class Slave:
    """One connection after the other; `real` is what sparks would have."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.lock = threading.Lock()
        self.regs, self.real = [0] * NREGISTERS, [0] * NREGISTERS
        self.due, self.log, self.at = [], [(now(), [0] * NREGISTERS)], None
        self.listens = self.listen()
        for work in (self.serve, self.turn):
            threading.Thread(target=work, daemon=True).start()

    def listen(self):
        s = socket.socket()
        s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        s.bind(("127.0.0.1", PORT))
        s.listen(4)
        return s

    def turn(self):
        while True:
            with self.lock:
                while self.due and self.due[0][0] <= now():
                    self.has(self.due.pop(0)[1])
            time.sleep(0.002)

    def has(self, values):
        if values != self.real:
            self.real = list(values)
            self.log.append((now(), self.real))

    def restart(self):
        """As after a loss of power: the connection is gone too."""
        with self.lock:
            self.due, self.regs = [], [0] * NREGISTERS
            self.has(self.regs)
            if self.at:
                with contextlib.suppress(OSError):    # it was gone
                    self.at.shutdown(socket.SHUT_RDWR)

    def serve(self):
        while True:
            self.at, _ = self.listens.accept()
            with contextlib.suppress(OSError):
                self.answer_all(self.at)
            self.at.close()

    def take(self, s, n):
        data = b""
        while len(data) < n:
            more = s.recv(n - len(data))
            if not more:
                raise OSError("gone")
            data += more
        return data

    def answer_all(self, s):
        while True:
            number, _, size, unit = struct.unpack(">HHHB", self.take(s, 7))
            with self.lock:
                body = self.answer(self.take(s, size - 1))
            s.sendall(struct.pack(">HHHB", number, 0, len(body) + 1, unit) +
                      body)

    def answer(self, pdu):
        code, at, n = struct.unpack(">BHH", pdu[:5])
        if code in (3, 4):
            base, row = ((FIRST, self.regs) if code == 3 else
                         (TELLS, self.real))
            got = row[at - base:at - base + n]
            return struct.pack(f">BB{n}H", code, 2 * n, *got)
        values = [n] if code == 6 else struct.unpack(f">{n}H", pdu[6:])
        self.regs[at - FIRST:at - FIRST + len(values)] = values
        late = max([now() + self.random.random() * SLOW_S] +
                   [t for t, _ in self.due])
        self.due.append((late, list(self.regs)))
        return pdu[:5]


class Bench:
    def __init__(self, folder, seed):
        self.folder, self.random = pathlib.Path(folder), random.Random(seed)
        self.slave = Slave(seed)
        self.kills, self.did, self.sets = [], [], []
        self.edmd = None

    def ctl(self, *words):
        return subprocess.run(
            [self.folder / "edmctl", "--machine", "vm", *words],
            capture_output=True, text=True).stdout

    def state(self):
        text = self.ctl("--json", "status")
        return json.loads(text).get("state", "") if text else ""

    def start(self):
        self.edmd = subprocess.Popen(
            [self.folder / "edmd", "--config", self.folder / "ill.ini"],
            stderr=open(self.folder / "edmd.log", "a"))

    def goes_on(self):
        for _ in range(200):
            if self.state() in ("approach", "erode", "travel", "retract"):
                return True
            self.ctl("reset")
            for n in "12":          # where it stands for an electrode
                self.ctl("done", n)
            self.ctl("start")
            if '"done"' in self.ctl("--json", "jobs"):
                return False
            time.sleep(0.05)
        raise SystemExit("it does not go on: " + self.ctl("status"))

    def pull(self, line, up):
        c = pathlib.Path("/sys/kernel/config/gpio-sim/sim0")
        at = pathlib.Path("/sys/devices/platform",
                          (c / "dev_name").read_text().strip(),
                          (c / "bank0/chip_name").read_text().strip(),
                          f"sim_gpio{line}/pull")
        at.write_text("pull-up" if up else "pull-down")

    # -- What happens to it

    def kill(self):
        self.kills.append(now())
        self.edmd.kill()
        self.edmd.wait()
        self.start()

    def hold(self):
        self.ctl("hold")

    def back(self):
        self.ctl("hold")
        self.ctl("retract", f"{self.random.choice([0.005, 0.02, 0.05])}")

    def short(self):
        self.pull(20, False)
        self.pull(22, True)
        time.sleep(0.1)
        self.pull(22, False)
        self.pull(20, True)

    def estop(self):
        self.pull(16, True)
        time.sleep(0.05)
        self.pull(16, False)

    def restart(self):
        self.slave.restart()

    def set(self):
        count = self.random.choice([31, 42])
        self.sets.append((now(), count))
        self.ctl("set", "peak_a", f"{count / 10}")

    def set_in_hold(self):
        self.ctl("hold")
        self.set()

    def default(self):
        self.ctl("set", "peak_a", "default")

    def run(self, events):
        what = [self.kill, self.kill, self.hold, self.back, self.back,
                self.short, self.estop, self.restart, self.restart,
                self.set, self.set_in_hold, self.default]
        for _ in range(events):
            if not self.goes_on():
                break
            time.sleep(self.random.random() * 0.6)
            do = self.random.choice(what)
            self.did.append((now(), do.__name__))
            do()
        self.goes_on()
        self.ctl("stop")
        time.sleep(0.5)
        self.edmd.terminate()
        self.edmd.wait()


def main():
    folder, seed, events = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    b = Bench(folder, seed)
    b.start()
    for _ in range(200):
        if b.state():
            break
        time.sleep(0.05)
    for n in "12":
        print(b.ctl("electrode", "add", n, "name=rib"), file=sys.stderr)
    if not b.ctl("submit", folder + "/ill.ngc"):
        raise SystemExit("the job was not taken")
    b.run(events)
    json.dump({"had": b.slave.log, "kills": b.kills, "did": b.did,
               "sets": b.sets},
              sys.stdout)


main()
