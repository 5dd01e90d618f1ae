# SPDX-License-Identifier: Apache-2.0
"""What is done to drives in the guest: a job, and each fault in turn.

Leaves NAME.json, what the drives saw and when what was done, and NAME.log.
"""
import json
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

R = pathlib.Path(sys.argv[1])
FIFO = R / "drives.fifo"


LOOK_S = 0.15           # between two looks: one costs as much as all drives do
READY_S = 60            # until daemons answer and drives are up
RUNNING = ("travel", "approach", "erode", "retract")
CUTTING = ("approach", "erode")


def frame(can_id, data):
    """Raw, onto the bus, as someone else's."""
    with socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as s:
        s.bind(("vcan0",))
        s.send(struct.pack("=IB3x8s", can_id, len(data), data.ljust(8, b"\0")))


class Vain(Exception):
    """What was waited for did not come: the rest of the scene is left out."""


class Scene:
    """Drives, daemons and a client; ends with its `with`, come what may."""

    def __init__(self, name, nodes, played=None):
        self.name, self.nodes, self.marks, self.more = name, nodes, [], {}
        self.began = time.monotonic()
        self.log = open(R / "log", "w+")
        # Else this machine goes on with the job that the last one left.
        for left in pathlib.Path("/dev/shm").glob("edmd.vm.*"):
            left.unlink()
        if not FIFO.exists():
            os.mkfifo(FIFO)
        self.fifo = os.open(FIFO, os.O_RDWR)
        self.drives = subprocess.Popen(
            [sys.executable, *(played or [R / "drives.py", "vcan0", FIFO,
                                          *map(str, nodes)])])
        self.report("first")        # they are up when they answer
        self.edmd = subprocess.Popen(
            [R / "edmd", "--config", R / f"{name}.ini"], stderr=self.log)
        self.jobs = subprocess.Popen(
            [R / "edmd-jobs", "--config", R / f"{name}.ini", "--store",
             R / f"store-{name}"], stderr=self.log)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, where):
        self.end()
        print(f"{self.name}: {time.monotonic() - self.began:.0f} s"
              f"{f', ended by {error}' if kind else ''}", flush=True)
        return kind is Vain

    def mark(self, what):
        self.marks.append((time.monotonic(), what))

    def tell(self, *words):
        os.write(self.fifo, (" ".join(map(str, words)) + "\n").encode())

    def report(self, name, what="report"):
        to = R / f"{name}.report"
        to.unlink(missing_ok=True)
        self.tell(what, to)
        while not to.exists():
            if self.drives.poll() is not None:
                raise SystemExit("the drives have died")
            time.sleep(0.02)
        return json.loads(to.read_text())

    def ctl(self, *args):
        p = subprocess.run([R / "edmctl", "--machine", "vm", *args],
                           capture_output=True, text=True)
        return p.returncode, p.stdout + p.stderr

    def status(self):
        code, text = self.ctl("--json", "status")
        return json.loads(text) if code == 0 else {"state": text}

    def until(self, what, seconds, **wanted):
        """Wait for a status; what it is then."""
        end = time.monotonic() + seconds
        while True:
            s = self.status()
            if all(s.get(k) in (v if isinstance(v, tuple) else (v,))
                   for k, v in wanted.items()):
                break
            if time.monotonic() > end:
                self.in_vain(f"{what}: waited in vain for {wanted}: {s}")
            time.sleep(LOOK_S)
        self.mark(what)
        return s

    def until_at(self, what, reached, seconds=60):
        """Wait for a place of X in mm."""
        end = time.monotonic() + seconds
        while not reached(self.status()["pos_mm"][0]):
            if time.monotonic() > end:
                self.in_vain(f"{what}: waited in vain: {self.status()}")
            time.sleep(LOOK_S)
        self.mark(what)

    def in_vain(self, what):
        self.mark(what)
        raise Vain(what)

    def submit(self, *args):
        """Again until edmd-jobs is there to take it."""
        end = time.monotonic() + READY_S
        while True:
            answer = self.ctl("submit", *args)
            if answer[0] == 0:
                return answer
            if time.monotonic() > end:
                self.in_vain(f"submitted in vain: {answer}")
            time.sleep(0.05)

    def start(self):
        """As an operator: again until the drives are up and it goes.  One
        that "starts when its turn comes" may still find them not up."""
        end = time.monotonic() + READY_S
        while True:
            answer = self.ctl("start")
            if answer[0] == 0 and "turn" not in answer[1]:
                return answer
            if self.status().get("state") in RUNNING:
                return 0, "it goes"
            if time.monotonic() > end:
                self.in_vain(f"started in vain: {answer}")
            time.sleep(0.05)

    def end(self):
        self.last = self.status()
        self.edmd.send_signal(signal.SIGTERM)
        self.edmd.wait()
        time.sleep(0.1)
        seen = self.report("last")
        self.jobs.terminate()
        self.jobs.wait()
        self.tell("quit")
        self.drives.wait()
        self.log.seek(0)
        pathlib.Path(f"{self.name}.log").write_text(self.log.read())
        pathlib.Path(f"{self.name}.json").write_text(json.dumps(
            {"status": self.last} | seen | {
                "marks": self.marks, "edmd": self.edmd.returncode}
            | self.more))


def whole_job(name, nodes, lags=()):
    """Boot, enable, a job from end to end without a gap."""
    with Scene(name, nodes) as s:
        for node, gain in zip(nodes, lags):
            s.tell("lag", node, gain)
        s.submit("--name", "first", str(R / f"{name}.ngc"))
        s.start()
        s.until("running", 10, state=RUNNING)
        s.until("idle", 60, state="idle")
        if lags:
            time.sleep(1)           # 20 time constants: they arrive


def level(line):
    """What a program drives on a line of sim0."""
    chip = pathlib.Path("/sys/kernel/config/gpio-sim/sim0")
    return int(pathlib.Path(
        "/sys/devices/platform", (chip / "dev_name").read_text().strip(),
        (chip / "bank0/chip_name").read_text().strip(),
        f"sim_gpio{line}/value").read_text())


def brakes(name, nodes):
    """One drive after the other has a fault while X and Y go round a circle:
    first one that stands, then one that moves."""
    with Scene(name, nodes) as s:
        s.submit(str(R / f"{name}.ngc"))
        brake = s.more["brake"] = {"before": level(26)}
        s.start()
        for node in reversed(nodes):
            s.until(f"{node}: running", 10, state=RUNNING)
            time.sleep(0.4)
            brake[f"{node}: running"] = level(26)
            s.mark(f"{node}: harm")
            s.tell("emcy", node, "2310")
            s.until(f"{node}: fault", 5, state="fault")
            time.sleep(1)           # far longer than braking and the brake take
            brake[f"{node}: stands"] = level(26)
            s.mark(f"{node}: stands")
            s.ctl("reset")
            s.until(f"{node}: reset", 5, state="hold")
            s.start()
        s.until("idle", 60, state="idle")
        brake["idle"] = level(26)
    brake["ended"] = level(26)
    pathlib.Path("brake.json").write_text(json.dumps(brake))


def interface(what):
    subprocess.run(["ip", "link", "set", "vcan0", what], check=True)


def plan_of(s):
    """What is done, how, and how it is mended."""
    def stop_edmd():
        s.edmd.send_signal(signal.SIGSTOP)
        time.sleep(0.2)
        s.edmd.send_signal(signal.SIGCONT)

    return [
        ("emcy", lambda: s.tell("emcy", 1, "2310"), None),
        ("leave", lambda: s.tell("leave", 2), None),
        ("mute", lambda: s.tell("mute", 1), lambda: s.tell("unmute", 1)),
        ("sync", stop_edmd, None),
        ("skip", lambda: s.tell("skip", 2, 5), None),
        ("jam", lambda: s.tell("jam", 1), lambda: s.tell("unjam", 1)),
        ("reboot", lambda: s.tell("reboot", 2), None),
        ("bus-off", lambda: frame(0x20000040, bytes(8)),
         lambda: frame(0x20000100, bytes(8))),
        ("down", lambda: interface("down"), lambda: interface("up")),
        ("master", lambda: frame(0x000, b"\x80\x01"), None),
    ]


def faults(name, nodes):
    """Each fault in turn while it cuts, and back from it by reset."""
    with Scene(name, nodes) as s:
        s.tell("gap", 25)
        s.submit(str(R / f"{name}.ngc"))
        s.start()
        s.more["faults"] = {}
        for what, harm, mend in plan_of(s):
            s.more["faults"][what] = fault(s, what, harm, mend)
        s.until("cutting again", 10, state=CUTTING)
        s.more["faults"] |= harmless(s)
        s.tell("gap", 45)
        s.until("idle", 60, state="idle")


def fault(s, what, harm, mend):
    s.until(f"{what}: cutting", 10, state=CUTTING)
    time.sleep(0.3)
    s.mark(f"{what}: harm")
    harm()
    got = s.until(f"{what}: fault", 5, state="fault")
    time.sleep(0.3)
    if mend:
        mend()
        s.mark(f"{what}: mended")
    early = s.ctl("start")
    time.sleep(0.2)
    reset = s.ctl("reset")
    s.until(f"{what}: reset", 2, state=("hold", "fault"))
    time.sleep(0.5)
    held = s.status()
    start = s.start()               # the drives may still come up
    s.mark(f"{what}: start")
    return {"fault": got.get("fault"), "early": early, "reset": reset,
            "held": held.get("state"), "start": start}


def harmless(s):
    """What is on a bus and must change nothing."""
    time.sleep(0.1)                 # else the drives may not have seen the sparks
    s.mark("harmless: begin")
    s.tell("drop", 1, 1)
    s.tell("skip", 2, 1)
    for size in range(9):
        for base in (0x180, 0x080, 0x700, 0x580):
            # Heartbeats of a wrong length, EMCY without a code in them, ...
            if (base, size) not in ((0x180, 7), (0x080, 8), (0x700, 1)):
                frame(base + 1, bytes(size))
        if size not in (2, 6):
            frame(0x3f0, bytes(size))
    for base, size in (0x180, 7), (0x080, 8), (0x700, 1), (0x580, 8):
        frame(base + 99, b"\xff" * size)
    frame(0x581, bytes.fromhex("8040600000000206"))
    frame(0x80000181, bytes(6))         # extended
    frame(0x40000181, b"")              # remote
    for _ in range(300):
        frame(0x181, b"\x37")
    time.sleep(0.5)
    got = s.status()
    s.mark("harmless: end")
    return {"harmless": got}


def lines(name, nodes):
    """A generator on lines: over each change of condition, and back by a short."""
    with Scene(name, nodes) as s:
        s.tell("gap", 25)
        s.submit(str(R / f"{name}.ngc"))
        s.start()
        for gap_v, beyond in (3, lambda x: x > 2.3), (25, lambda x: x < 1.8):
            s.until_at(f"gap of {gap_v} V", beyond)
            s.tell("gap", gap_v)
        s.until("idle", 60, state="idle")


class Plc(threading.Thread):
    """On the drives' own bus: its request each 20 ms, with a turned toggle."""

    NODE, LOCKS = 32, 0x1f

    def __init__(self):
        super().__init__(daemon=True)
        self.permit, self.talking, self.toggle = 1, True, 0

    def run(self):
        while self.talking:
            self.toggle ^= 0x80
            frame(0x200 + self.NODE, bytes(
                [self.toggle | self.permit, self.LOCKS, 0xe8, 3, 0, 0, 0, 0]))
            time.sleep(0.02)

    def nmt(self, command, node=NODE):
        frame(0x000, bytes([command, node]))


def shared(name, nodes):
    """A PLC of ours on the drives' bus, and all that it may say by NMT."""
    with Scene(name, nodes) as s:
        plc = Plc()
        s.tell("gap", 25)
        s.submit(str(R / f"{name}.ngc"))
        plc.nmt(1)
        plc.start()
        time.sleep(0.2)
        s.start()
        s.until("cutting", 10, state=CUTTING)
        time.sleep(0.1)
        s.mark("NMT")
        for node in Plc.NODE, 0:
            plc.nmt(1, node)
        time.sleep(0.5)
        s.more["after NMT"] = s.status()
        s.mark("NMT taken")
        s.more["taken"] = {}
        for what, take, give in (
                ("permit", lambda: setattr(plc, "permit", 0),
                 lambda: setattr(plc, "permit", 1)),
                ("stop", lambda: plc.nmt(2), lambda: plc.nmt(1)),
                ("reset", lambda: plc.nmt(0x81), lambda: plc.nmt(1)),
                ("stop all", lambda: plc.nmt(2, 0), lambda: plc.nmt(1))):
            s.more["taken"][what] = taken(s, what, take, give)
        s.until("cutting again", 10, state=CUTTING)
        s.tell("gap", 45)
        s.until("idle", 60, state="idle")
        plc.talking = False


def taken(s, what, take, give):
    """While it cuts: what ends it, and that it goes on when it is given back."""
    s.until(f"{what}: cutting", 10, state=CUTTING)
    time.sleep(0.3)
    s.mark(f"{what}: harm")
    take()
    s.until(f"{what}: fault", 5, state="fault")
    time.sleep(0.3)
    alarms = json.loads(s.ctl("--json", "alarms")[1])
    give()
    time.sleep(0.3)
    s.ctl("reset")
    s.until(f"{what}: reset", 5, state="hold")
    return {"fault": alarms["fault"], "faults": alarms["faults"],
            "start": s.start()}


if __name__ == "__main__":
    whole_job("two", [1, 2])
    whole_job("six", [1, 2, 3, 4, 5, 6])
    for name in "lagging", "led", "coupled":
        whole_job(name, [1, 2], lags=(30, 21.5))
    brakes("brakes", [1, 2, 3])
    lines("lines", [1, 2, 3])
    shared("shared", [1, 2])
    faults("faults", [1, 2])
