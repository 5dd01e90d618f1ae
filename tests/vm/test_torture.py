# SPDX-License-Identifier: Apache-2.0
"""The host's power fails at random instants: QEMU is killed while jobs run.

Each job begins on a disk that no machine has used.  The virtual machine boots,
the job runs, QEMU is killed, and so on; after EDM_CUTS kills the job is left to
end.  After each boot nothing may have moved by itself, the queue must be whole,
and the place that was kept must be near the place that was seen last.  At last,
what the axes did from the first spark on is compared with an uninterrupted run.

EDM_SEED and EDM_RUNS (kills of each job) choose others; `make torture` does
300.
"""

import csv
import json
import os
import random
import shutil
import subprocess
import time

import pytest
from boot import ABSENT, BUILD, BUILD_VM, HERE, ROOT

SEED = int(os.environ.get("EDM_SEED", "1"))
RUNS = int(os.environ.get("EDM_RUNS", "2"))
# What a checkpoint may be behind: 1 s of the machine's time or 0.05 mm.
LATE_S, LATE_MM = 1.0, 0.05
PULSE_MM = 0.001

MACHINE = """[machine]
name = vm
backend = sim
period_us = 5000
overrun_limit = 0
cpu = -1
[axis.Z]
start_mm = 1
[jump]
height_mm = 0.2
every_s = 1
[probe]
feed_mm_s = 1
fine_mm_s = 0.2
[sim]
block = yes
block_top_mm = 0
speed = 4
"""

JOBS = {
    # Cuts with jumps, from one place to another.
    "cuts": "G21 G90 T84 M3\nG0 Z1\nG0 X0 Y0\nG0 Z0.1\nG1 Z-0.06 F60\n"
            "G1 X0.05\nG0 Z1\nG0 X2 Y1\nG0 Z0.1\nG1 Z-0.04\n"
            "G1 X2.1 Y1.05 Z-0.06\nG0 Z1\nM30\n",
    # It feels for the work, and counts from there.
    "probe": "G21 G90 T84 M3\nG80 Z-\nG92 Z0\nG0 Z0.2\nG1 Z-0.06 F60\nG1 Y0.05\n"
             "G0 Z0.5\nM0\nG0 X1\nG0 Z0.1\nG1 Z-0.05\nG0 Z0.5\nM30\n",
    # A curve and arcs on the way down.
    "curve": "G21 G90 G17 T84 M3\nG0 Z0.1\nG1 Z-0.05 F60\n"
             "G5.1 X0.1 Y0 I0.05 J0.1\nG3 X0 Y0 I-0.05 J0\n"
             "G2 X0.05 Y0.05 I0.05 J0\n"
             "G0 Z1\nM30\n",
}


ENDS = {"cuts": (2.1, 1.05, 1), "probe": (1, 0.05, 0.5),
        "curve": (0.05, 0.05, 1)}


class Power:
    """A host with a disk."""

    def __init__(self, name):
        self.folder = BUILD_VM / "runs" / f"torture-{name}"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        lib2 = next((BUILD_VM / "libgpiod2").glob("usr/lib/*/libgpiod.so.3"))
        for file, text in {
            "env": f"BUILD={BUILD}\nBUILD2={ROOT / 'build-gpiod2'}\n"
                   f"LIB2={lib2.parent}\n",
            "lib.sh": (HERE / "guest/lib.sh").read_text(),
            "torture.ini": MACHINE + ABSENT,
            "cut.ngc": JOBS[name], "job": "cut.ngc\n",
        }.items():
            (self.folder / file).write_text(text)
        disk = self.folder / "disk"
        with open(disk, "wb") as f:
            f.truncate(64 << 20)
        subprocess.run(["/sbin/mkfs.ext4", "-q", disk], check=True)
        self.turn = 0

    def has(self, file):
        return (self.folder / f"{file}.{self.turn}").exists()

    def json(self, file):
        return json.loads((self.folder / f"{file}.{self.turn}").read_text())

    def text(self, file):
        path = self.folder / f"{file}.{self.turn}"
        return path.read_text() if path.exists() else ""

    def boot(self, kill_after_s):
        """Run it, and kill it so long after the job was started; None: do not.
        Return: was it killed?"""
        self.turn += 1
        (self.folder / "turn").write_text(f"{self.turn}\n")
        pid = self.folder / "pid"
        pid.unlink(missing_ok=True)
        vm = subprocess.Popen(
            [HERE / "vm-run", "-t", "900", self.folder,
             HERE / "guest/torture.sh"],
            env=os.environ | {
                "VM_BUILD": str(BUILD_VM),
                "VM_QEMU": f"-pidfile {pid} -drive file={self.folder}/disk,"
                           "format=raw,if=virtio,cache=writethrough",
            }, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        killed = False
        if kill_after_s is not None:
            while vm.poll() is None and not self.has("begun"):
                time.sleep(0.02)
            time.sleep(kill_after_s)
            if vm.poll() is None:
                os.kill(int(pid.read_text()), 9)
                killed = True
        output = vm.communicate()[0]
        assert killed or vm.returncode == 0, output + self.text("told")
        return killed


def check_came_back(p, last):
    """@last: what was seen last, or None."""
    came, stood = p.json("came"), p.json("stood")
    assert came["pos_mm"] == stood["pos_mm"], "it moved by itself"
    assert stood["state"] == "idle" or stood["job_state"] == "ready", stood
    if not came.get("interrupted"):
        # It had not begun, or it was done: both are on the disk.
        return
    was = p.json("show")
    assert was["state"] == "interrupted", was
    if last:
        behind = last["place_mm"] - was["path_mm"]
        assert behind <= LATE_MM + LATE_S * max(last["feed_mm_s"], 1), (
            last, was)
    assert "resume cut: " in p.text("told")


def lattice(folder):
    """Every point of a run that nothing interrupts, in pulses."""
    out = folder / "points.csv"
    subprocess.run([BUILD / "edmsim", "--quiet", "--machine",
                    folder / "torture.ini", "--dry-run", "--pulses", out,
                    folder / "cut.ngc"], check=True, capture_output=True)
    with open(out) as f:
        return {tuple(round(float(row[k])) for k in "XYZ")
                for row in csv.DictReader(f)}


def check_trace(folder):
    """From the first spark on the axes go where the whole program goes."""
    points, cut = lattice(folder), 0
    with open(folder / "trace.csv") as f:
        for row in csv.DictReader(f):
            if row["state"] not in ("erode", "approach"):
                continue
            at = tuple(round(float(row[k]) / PULSE_MM) for k in "XYZ")
            assert at in points, row
            cut += 1
    assert cut > 100


@pytest.mark.parametrize("name", JOBS)
def test_the_power_fails(name):
    dice = random.Random(f"{SEED} {name}")
    print(f"EDM_SEED={SEED}")
    p = Power(name)
    last, kills = None, 0
    for _ in range(RUNS):
        killed = p.boot(dice.uniform(0, 30))
        check_came_back(p, last)
        if not killed:
            break
        kills += 1
        last = p.json("seen") if p.has("seen") else last
    else:
        (p.folder / "record").touch()
        p.boot(None)
        check_came_back(p, last)
        # Its places count from a contact, which a dry run does not feel.
        if name != "probe":
            check_trace(p.folder)
    end = json.loads((p.folder / "end").read_text())
    assert end["pos_mm"][:3] == pytest.approx(ENDS[name], abs=0.003)
    ended = json.loads((p.folder / "history").read_text())[0]
    assert ended["state"] == "done", ended
    assert ended["path_mm"] == pytest.approx(ended["length_mm"])
    print(f"{kills} kills")
