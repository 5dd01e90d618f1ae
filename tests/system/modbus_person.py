# SPDX-License-Identifier: Apache-2.0
"""A generator on Modbus (pymodbus) that sparks, and a person beside it.

edmd runs on lines that are bytes of a file.  At each write of it to them there
is a record with what the slave's registers had in that moment, so no spark is
missed: while its line is on, they have the condition of the place.  EDM_SEED
repeats what is chosen, EDM_SECONDS says for how long.
"""

import contextlib
import itertools
import math
import os
import random
import time

import lines_file
import rig
from modbus_slave import Slave

STEP, SPARK, OPEN, SHORT = 9, 2, 6, 7
MACHINE = """
[machine]
name = {name}
backend = gpio
period_us = 1000
overrun_limit = 0
cpu = -1

[axis.Z]
v_max_mm_s = 0.5
a_max_mm_s2 = 20

[jump]
v_max_mm_s = 0.5
height_mm = 0.08
every_s = 0.9

[gpio]
chip = file
step_Z = 9
dir_Z = 10
estop = 5
spark = 2
watchdog = 4
gap_open = 6
gap_short = 7

[gap]
source = lines
feed_max_mm_s = 0.4
approach_mm_s = 0.4
abort_count = 1000000

[generator]
interface = modbus
modbus = {where}
modbus_every_ms = 4
modbus_timeout_ms = 400
silent_ms = 1500
confirm_s = 2
settle_ms = 20
polarity_ms = 3
peak_a = register 10 scale 0.1
on_us = register 11 scale 0.1
off_us = register 12 scale 0.1
polarity = register 14 bit 0
{more}

[tech]
table = shop.tech

[jobs]
store = {store}
""" + "".join(f"[axis.{a}]\npresent = no\n" for a in "XYABCUV")

# So many requests behind a loss, on one link, all of it was told, and taken: what
# was under way, two that write, two that read, and the next one.
TELLS = 6

FIELDS = "peak_a", "on_us", "off_us"
VALUES = {"peak_a": (6, 6.2, 9, 12), "on_us": (8, 20, 50),
          "off_us": (20, 50, 100), "polarity": (1, -1)}
OWN = {"peak_a": 3, "on_us": 55, "off_us": 777, "polarity": 1}
CUTS, CUT_UM, EDGE_UM = 8, 120, 6


class Spark(Slave):
    """What it has goes into each record of the lines."""

    def __init__(self, chip):
        super().__init__()
        self.chip = chip
        put = self.block.setValues

        def has(address, values):
            put(address, values)
            chip.put_registers(0, self.block.getValues(11, 6))

        self.block.setValues = has
        self.reset()

    def reset(self, off=True):
        own = [*(round(10 * OWN[f]) for f in FIELDS), 0, 0, 0]
        if not off:
            own[2] = self.get(12)
        self.block.setValues(11, own)


def registers_of(values):
    return [round(10 * values[f]) for f in FIELDS], values["polarity"] < 0


class Scene:
    def __init__(self, folder, seed):
        self.r = random.Random(seed)
        self.chip = lines_file.Chip(folder / "lines", STEP)
        self.chip.put(OPEN, 1)
        self.slave = Spark(self.chip)
        self.folder = folder
        self.blind = self.r.random() < 0.4
        self.losses, self.last_ns = [], 0
        self.sets, self.jobs, self.at_um = [], 0, 0
        self.sums = dict.fromkeys(
            ("sparks", "excused", "kills", "losses", "sets", "stands"), 0)

    def machine(self):
        text = MACHINE.replace("{where}", self.slave.where).replace(
            "{more}", "told_off_us = none\n" if self.blind else "")
        self.m = lines_file.Machine(self.folder, text, self.chip)
        return self.m

    # -- A program, and what its places ask for

    def make_table(self):
        r = self.r
        self.conds = [{f: r.choice(v) for f, v in VALUES.items()
                       if r.random() < 0.75} for _ in range(6)]
        rows = [", ".join([f"C10{i}"] + [str(c.get(f, "")) for f in VALUES])
                for i, c in enumerate(self.conds)]
        (self.folder / "shop.tech").write_text(
            "\n".join(["condition, " + ", ".join(VALUES), *rows, ""]))

    def program(self):
        """From where it stands, down or up."""
        down = self.jobs % 2 == 0
        self.way = -1 if down else 1
        self.far_um = self.way * self.at_um
        self.row = [self.r.randrange(6) for _ in range(CUTS)]
        if not down:
            self.row.reverse()
        ends = [-CUT_UM * (i + 1) for i in range(CUTS)] if down else \
            [-CUT_UM * i for i in reversed(range(CUTS))]
        words = ["G21 G90"]
        for i, end in zip(self.row if down else reversed(self.row), ends):
            words.append(f"C10{i} G1 Z{end / 1000:.3f} F30")
        return "\n".join([*words, "M30", ""]).encode()

    def cut_at(self, um):
        """Which, or None where another one is near."""
        n, rest = divmod(-um, CUT_UM)
        inner = EDGE_UM < rest < CUT_UM - EDGE_UM
        return n if inner and 0 <= n < CUTS else None

    def asked(self, cut, ns):
        """All that the condition of the cut may be just then."""
        cond = self.row[cut]
        may = {f: {self.conds[cond].get(f, OWN[f])} for f in VALUES}
        for begin, end, at, field, value in self.sets:
            if at != cond or ns < begin:
                continue
            new = {self.conds[cond].get(field, OWN[field])
                   if math.isnan(value) else value}
            may[field] = new if ns > end else may[field] | new
        return [registers_of(dict(zip(may, v)))
                for v in itertools.product(*may.values())]

    # -- Its sparks

    def told(self, loss):
        """When edmd knew that it lost its values then."""
        n = 0
        for ns in self.slave.asks:
            n = 0 if ns is None or ns < loss else n + 1
            if n == TELLS:
                return ns
        return math.inf

    def check(self):
        for k in self.chip.records():
            before, self.last_ns = self.last_ns, k.ns
            self.at_um = k.at
            self.far_um = max(self.far_um, self.way * k.at)
            cut = self.cut_at(k.at)
            if not k.level[SPARK] or cut is None:
                continue
            self.sums["sparks"] += 1
            has = k.registers[:3], bool(k.registers[4] & 1)
            if has in self.asked(cut, k.ns):
                continue
            # It lost them, and has not told it before the period began.
            assert any(loss <= k.ns and before <= self.told(loss)
                       for loss in self.losses), (
                k.ns, k.at, cut, self.row[cut], has, self.asked(cut, k.ns))
            self.sums["excused"] += 1

    # -- A person

    def ask(self, verb, **more):
        return self.m.client.ask(verb, **more)

    def set_one(self):
        """Where it stands, and is known which condition that is for: that of the
        farthest place."""
        self.ask("hold")
        self.m.client.status_where(lambda s: s.state in ("hold", "fault", "idle")
                                   and s.feed_mm_s == 0)
        self.check()
        cut = self.cut_at(self.way * self.far_um)
        if cut is None:
            return
        field = self.r.choice(list(VALUES))
        value = self.r.choice([*VALUES[field], math.nan])
        begin = time.monotonic_ns()
        if self.ask("set", text=field, arg=value).code == 0:
            self.sets.append((begin, time.monotonic_ns(), self.row[cut],
                              field, value))
            self.sums["sets"] += 1

    def set_by_hand(self):
        """What it is asked to: the generator's own.  It may be on its way back
        just then."""
        if self.r.random() < 0.4:
            self.retract()
            time.sleep(self.r.random() * 0.3)
        a = self.ask("why").body
        self.sums["stands"] += 1
        b = self.slave.block
        for i, f in enumerate(FIELDS):
            if f in a:
                b.setValues(11 + i, [round(10 * OWN[f])])
        if "polarity" in a:
            b.setValues(15, [0])

    def go_on(self):
        s = self.m.client.status()
        if s.stand == "setting":
            self.set_by_hand()
            self.ask("done")
        if s.faults:
            self.ask("reset")
        if not s.state in ("erode", "idle"):
            self.ask("start")

    def lose(self, off):
        """@off: also what it may not tell."""
        self.losses.append(time.monotonic_ns())
        self.slave.reset(off or not self.blind)
        self.sums["losses"] += 1

    def cut_link(self):
        self.slave.stop()
        time.sleep(self.r.random() * 0.3)
        if self.r.random() < 0.5:
            self.lose(True)
        self.slave.start()

    def kill(self):
        """In a job: nobody knows what it had before one that is over."""
        if self.m.client.status().state == "idle":
            return
        self.m.kill("edmd")
        self.chip.put(SPARK, 0)     # what the watchdog is for
        if self.r.random() < 0.3:
            self.lose(True)
        self.m.start_edmd()
        # It is taken to be where it was sent.
        s = self.m.client.status_where(lambda s: s.daemon == "ok", 30)
        self.check()
        self.chip.put_at(round(s.pos_mm[2] * 1000))
        if s.state == "idle":       # it was over just before
            self.lose(True)
        self.sums["kills"] += 1

    def mood(self):
        s = self.slave
        s.late_s = self.r.choice((0, 0, 0.003, 0.03, 0.1))
        with contextlib.ExitStack() as ends:
            which = self.r.randrange(5)
            if which == 0:
                s.silent = True
                ends.callback(setattr, s, "silent", False)
            elif which == 1:
                s.refuses = {self.r.choice((10, 11, 12, 14)):
                             self.r.choice((1, 2, 3, 4, 5, 6))}
                ends.callback(setattr, s, "refuses", {})
            elif which == 2:
                s.lies = {self.r.choice((10, 11, 12, 14)): 1}
                ends.callback(setattr, s, "lies", {})
            time.sleep(self.r.random() * 0.4)

    def retract(self):
        self.ask("hold")
        self.m.client.status_where(
            lambda s: s.state in ("hold", "fault", "idle"))
        self.ask("retract", arg=self.r.choice((0.02, 0.15, 0.4)))

    def short(self):
        self.chip.put(SHORT, 1)
        time.sleep(self.r.random() * 0.05)
        self.chip.put(SHORT, 0)

    def turn(self):
        what = self.r.choice((
            lambda: self.ask("hold"), self.set_one, self.set_one, self.set_one,
            self.retract, self.short, self.short, lambda: self.lose(False),
            self.cut_link, self.kill, self.mood, self.mood, self.mood,
            lambda: None))
        what()
        time.sleep(self.r.random() * 0.2)
        self.go_on()
        self.check()

    def job(self, until):
        name = f"job-{self.jobs}"
        text = self.program()
        self.sets = []
        assert self.m.client.submit(text, name).code == 0
        while time.monotonic() < until:
            self.turn()
            if self.m.client.job(name)["state"] == "done":
                self.check()
                self.jobs += 1
                return


def seconds():
    return float(os.environ.get("EDM_SECONDS", 25))


def test_no_spark_has_another_condition_than_its_place(tmp_path):
    seed = int(os.environ.get("EDM_SEED", random.getrandbits(32)))
    print(f"EDM_SEED={seed}")
    scene = Scene(tmp_path, seed)
    scene.make_table()
    with scene.slave:
        with scene.machine() as m:
            m.start()
            until = time.monotonic() + seconds()
            while time.monotonic() < until:
                scene.job(until)
            scene.check()
    print(scene.jobs, scene.sums)
    assert scene.sums["sparks"] > 0
