# SPDX-License-Identifier: Apache-2.0
"""edmctl commission on strict drives that are wired wrongly in twelve ways.  A
person mends each when the walk has named it.  What is wired to what is known
here alone; the machine file does not have it.
"""
import json
import re
import subprocess
import threading
import time

from can402 import R, RUNNING, Scene, frame
from person import Person

# Increments for a mm of the slide: X turns the other way, Y has another screw.
PER_MM = {"X": -104857.6, "Y": -655.36, "Z": 10000}
NODE = {"X": 1, "Y": 2, "Z": 3}


class World:
    """The machine as it is, and who looks at it and mends it."""

    def __init__(self, s):
        self.s, self.tries = s, {}
        self.plugs = {"Y": "Z"}             # what moves when Y is sent
        self.low_bit, self.high_bit = 1, 0  # X's limit switches: swapped
        self.was = self.true()

    def true(self):
        return self.s.report("now", "where")

    def went_mm(self, axis):
        """Since it was looked at last."""
        was, self.was = self.was, self.true()
        at = NODE[axis] - 1
        return (self.was[at] - was[at]) / PER_MM[axis]

    def once(self, what):
        self.tries[what] = self.tries.get(what, 0) + 1
        return self.tries[what]

    def later(self, seconds, *words):
        threading.Timer(seconds, self.s.tell, words).start()

    # -- answers

    def presses_estop(self, _):
        if self.once("estop") > 1:          # before, it is not wired
            self.s.tell("input", 2, 16, 0)
            time.sleep(0.3)
        return "pressed"

    def frees_estop(self, _):
        self.s.tell("input", 2, 16, 1)
        time.sleep(0.3)
        return "yes"

    def begins_drives(self, _):
        n = self.once("drives")
        if n == 1:
            threading.Thread(target=self.twice, daemon=True).start()
        elif n == 2:
            self.s.tell("deaf", 2)
        elif n == 3:
            self.s.tell("hears", 2)
            self.s.tell("slow", 3, "1017:0", 9)
            self.s.tell("off", 3)
            self.s.tell("on", 3)
        else:
            self.s.tell("slow", 3, "1017:0", 0)
        if n == 4:
            time.sleep(12)                  # the late answers are over
        return "go"

    def twice(self):
        end = time.monotonic() + 10
        while time.monotonic() < end:
            frame(0x181, bytes.fromhex("31020000000008"))
            time.sleep(0.01)

    def begins_power(self, m):
        if m.group(1) == "X":
            self.s.tell("weak" if self.once("power") == 1 else "strong", 1)
        return "go"

    def which_way(self, m):
        axis = m.group(1)
        if axis in self.plugs:
            return self.plugs.pop(axis)
        self.s.mark(f"direction {axis}")
        return "+" if self.went_mm(axis) > 0 else "-"

    def how_far(self, m):
        return f"{self.went_mm(m.group(1)):.4f}"

    def dial(self, m):
        return f"{1000 * self.went_mm(m.group(1)):.2f}"

    def looks(self, answer):
        def look(_):
            self.was = self.true()
            return answer
        return look

    def press_limit(self, m):
        bit = self.high_bit if m.group(2) == "+" else self.low_bit
        self.pressed = bit
        self.later(0.5, "input", 1, bit, 1)
        return "go"

    def frees_limit(self, answer):
        def free(_):
            self.s.tell("input", 1, self.pressed, 0)
            time.sleep(0.3)
            if answer == "again":
                self.low_bit, self.high_bit = 0, 1
            return answer
        return free

    def begins_home(self, _):
        if self.once("home") < 3:
            self.s.tell("invert", 1, 2)
            time.sleep(0.3)
        return "go"

    def gap(self, wrong, loud, right):
        def answer(_):
            n = self.once(f"gap {right}")
            self.s.tell("gap", wrong if n == 1 else right,
                        400 if n == 2 else 1)
            time.sleep(0.5)
            return "yes"
        return answer

    def restarts(self, _):
        self.s.edmd.terminate()
        self.s.edmd.wait()
        self.s.jobs.terminate()
        self.s.jobs.wait()
        self.s.edmd = subprocess.Popen(
            [R / "edmd", "--config", R / f"{self.s.name}.ini"],
            stderr=self.s.log)
        self.s.jobs = subprocess.Popen(
            [R / "edmd-jobs", "--config", R / f"{self.s.name}.ini", "--store",
             R / f"store-{self.s.name}"], stderr=self.s.log)
        end = time.monotonic() + 30
        while self.s.status().get("daemon") != "ok" and \
                time.monotonic() < end:
            time.sleep(0.2)
        time.sleep(4)                       # drives come up
        return "done"

    def rules(self):
        return [
            (r"\ndrives: .*\[go\]: $", self.begins_drives),
            (r"\npower (.): .*\[go\]: $", self.begins_power),
            (r"\nhome .: .*\[go\]: $", self.begins_home),
            (r"\[go\]: $", "go"),
            (r"press the e-stop;", self.presses_estop),
            (r"is it free", self.frees_estop),
            (r"is changed: restart", self.restarts),
            (r"which way did (.)", self.which_way),
            (r"(.) was sent by \S+; how far", self.how_far),
            (r"(?s)press the limit switch of (.) at its (.) end.*\[no\]: $",
             self.press_limit),
            (r"is it off", self.frees_limit("yes")),
            (r"limits X is not good", self.frees_limit("again")),
            (r"how often", "3"),
            (r"set the dial", self.looks("yes")),
            (r"(.) is back within \S+ um; what does the dial", self.dial),
            (r"away from the work", self.gap(5, 400, 80)),
            (r"touch the work", self.gap(80, 400, 5)),
            (r"for how many seconds", "1"),
            (r"(limits [YZ]|generator|latency) is not good", "next"),
            (r"a short program", str(R / "first.ngc")),
            (r"first.ngc begins", self.begins_cut),
            (r"X moves by|moves by|\[no\]: $", self.looks("go")),
            (r"\[yes\]: $", "yes"), (r"\[again\]: $", "again"),
        ]

    def begins_cut(self, _):
        self.s.tell("gap", 25)
        time.sleep(0.5)
        return "go"


def commission():
    traits = {1: {"inputs": {"0": 0, "1": 0, "2": [600000]}},
              2: {"inputs": {"16": 1}}, 3: {}}
    with Scene("strict-commission", list(traits), [
            R / "strict.py", "vcan0", R / "drives.fifo",
            json.dumps(traits)]) as s:
        s.until("up", 60, daemon="ok")
        s.tell("gap", 80)
        world = World(s)
        person = Person([R / "edmctl", "--machine", "vm", "--timeout", "18",
                         "commission", R / "strict-commission.ini"],
                        world.rules())
        try:
            s.more["code"] = person.run()
        except Exception as e:          # what it did until then is told
            s.more["code"] = repr(e)
        s.more["out"] = person.out
        s.more["asked"] = person.asked
        for what in ".ini", ".ini.commission", ".ini.commission.html":
            path = R / f"strict-commission{what}"
            s.more[what] = path.read_text() if path.exists() else ""
