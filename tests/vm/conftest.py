# SPDX-License-Identifier: Apache-2.0
"""A boot for each mode, and its tests read what it left."""

import os
import shutil
import subprocess

import power
import pytest
from boot import (ADC, BRAKES, BUILD, BUILD_VM, CAN402_LINES, CIRCLE, COMMISSION, CUT, EDGES, FAR, GAP, GAP_FRAMES, GENERATOR, HERE, LEVELS,
                  FEEL_JOB, LEVELS_JOB, LINES, LINES_CUT, LINES_TECH, ROUNDS,
                  ENCODER, QUICK_JOB, ROOT, Run, SHARED, SLOW_JOB, STRICT_HOME, STRICT_INPUTS, STRICT_MARKS, STRICT_REFUSED, STRICT_UP, TO_AND_FRO,
                  UNRULY_SCENES, VIRTUAL, checked, drives, lagging, machine)


@pytest.fixture(scope="session", autouse=True)
def machine_can_be():
    """What `make vm` found missing, if anything."""
    lacks = BUILD_VM / "lacks"
    if lacks.exists() and lacks.read_text():
        pytest.skip(f"the virtual machine needs {lacks.read_text().strip()}")


@pytest.fixture(scope="session")
def plain():
    """Two CPUs in real time."""
    return checked(Run("plain", {
        "null.ini": machine("null"),
        "sim.ini": machine("sim", tail="[sim]\nspeed = 5\n"),
        "gap.ini": machine(tail=GAP),
        "generator.ini": machine(tail=GENERATOR),
        "levels.tech": LEVELS, "levels.ngc": LEVELS_JOB, "feel.ngc": FEEL_JOB,
        "no-chip.ini": machine(tail=LINES.replace("sim0", "sim7")),
        "no-line.ini": machine(tail=LINES + "pump = 32\n"),
        "busy.ini": machine(tail=LINES + "pump = 6\n"),
        "rights.ini": machine(),
        "quick.ngc": QUICK_JOB,
        "slow.ngc": SLOW_JOB,
    }))


@pytest.fixture(scope="session")
def virtual():
    """One CPU in virtual time."""
    return checked(Run("virtual", VIRTUAL, "-d",
                       copies=(compiled("stop-latency"),)))


@pytest.fixture(scope="session")
def wake():
    """The same, for how late it wakes."""
    return checked(Run("wake", {"line.ini": VIRTUAL["line.ini"],
                                "line.ngc": VIRTUAL["line.ngc"]}, "-d"))


@pytest.fixture(scope="session")
def edges():
    """One CPU in virtual time, four times as fast."""
    return checked(Run("edges", EDGES, "-d", "-i", "0"))


def made(command):
    """What it said is told if it fails."""
    p = subprocess.run(command, text=True, stdout=subprocess.PIPE,
                       stderr=subprocess.STDOUT)
    assert p.returncode == 0, f"{command} ended with {p.returncode}:\n" + \
        p.stdout[-8000:]


def compiled(name):
    """A program of this folder, for the guest."""
    to = BUILD_VM / name
    subprocess.run(["cc", "-D_GNU_SOURCE", "-O1", f"-I{ROOT}/daemon/words", "-o", to, HERE / f"{name}.c"], check=True)
    return to


@pytest.fixture(scope="session")
def encoder():
    """An axis that slips, and then a converter; one CPU in virtual time."""
    return checked(Run("encoder", {
        "encoder.ini": machine(tail=ENCODER),
        "encoder.ngc": "G21 G90\nG1 X0.3 F6\nG1 X0.1\nM30\n",
        "back.ngc": "G21 G90\nG1 X0.2 F6\nM30\n",
        "wall.ngc": "G21 G90\nG1 X0.5 F6\nM30\n",
        "adc.ini": machine(period_us=1000, v=0.5, tail=ADC),
        "adc.ngc": SLOW_JOB,
    }, "-d", copies=(compiled("axis-sim"), HERE / "guest/adc.sh")))


@pytest.fixture(scope="session")
def can402():
    """Drives on vcan0, one CPU in virtual time."""
    guest = HERE / "guest"
    return checked(Run("can402", {
        "two.ini": drives("XY"),
        "two.ngc": "G21 G90\nG1 X2 Y1 F120\nG3 X1 Y2 I-1 J0\nG0 X0.5 Y0.25\n"
                   "M30\n",
        "six.ini": drives("XYZABC"),
        "six.ngc": "G21 G90\nG1 X1 Y-0.5 Z0.3 A2 B-1 C0.7 F60\n"
                   "G1 X0.2 Y0.1 Z-0.1 A-0.4 B0.5 C0.1\nM30\n",
        "lagging.ini": lagging("none"), "lagging.ngc": CIRCLE,
        "led.ini": lagging("feedforward"), "led.ngc": CIRCLE,
        "coupled.ini": lagging("feedforward+cross-coupled"), "coupled.ngc": CIRCLE,
        "brakes.ini": drives("XYZ", BRAKES, braked="Z"), "brakes.ngc": ROUNDS,
        "lines.ini": CAN402_LINES, "lines.tech": LINES_TECH,
        "lines.ngc": LINES_CUT,
        "shared.ini": drives("XY", GAP_FRAMES + SHARED), "shared.ngc": CUT,
        "faults.ini": drives("XY", GAP_FRAMES),
        "faults.ngc": CUT,
    }, "-d", copies=(guest / "drives.py", guest / "can402.py")))


@pytest.fixture(scope="session")
def strict():
    """Drives that refuse what they may, one CPU in virtual time."""
    guest = HERE / "guest"
    return checked(Run("strict", {
        "strict-up.ini": drives("XYZA", STRICT_UP, "no", falls="Z"),
        "strict-up.ngc": "G21 G90\nG1 X1 Y-0.5 Z0.3 A2 F60\n"
                         "G1 X0.2 Y0.1 Z-0.1 A-0.4\nM30\n",
        "strict-refused.ini": drives("XYZABC", STRICT_REFUSED, "no", falls="Y"),
        "strict-refused.ngc": CUT,
        "strict-late.ini": drives("XY", GAP_FRAMES, "no"),
        "strict-late.ngc": CUT,
        "strict-objects.ini": drives("XY", GAP_FRAMES, "no"),
        "strict-home.ini": drives("XYZ", STRICT_HOME, "no", falls="Z"),
        "strict-home.ngc": "G21 G90\nG1 X-1 Y4 Z1 F60\nM30\n",
        "strict-inputs.ini": drives("XY", STRICT_INPUTS, "no"),
        "strict-inputs.ngc": "G21 G90\nG1 X-1 Y4 F60\nM30\n",
        "strict-marks.ini": drives("XY", STRICT_MARKS, "no"),
        "strict-asked.ini": drives("XYZ", STRICT_HOME, "no", falls="Z"),
        "strict-commission.ini": COMMISSION,
        "first.ngc": "G21 G91\nG1 X-0.3 F60\nM30\n",
        "strict-ip.ini": drives("XY", STRICT_HOME.split("[axis.Y]")[0] +
                                "drive_mode = ip\n", "no"),
        "strict-ip.ngc": "G21 G90\nG1 X1 Y2 F60\nM30\n",
        "strict-faults.ini": drives("XY", GAP_FRAMES, "no"),
        "strict-faults.ngc": CUT,
        "strict-attack.ini": drives("XY", GAP_FRAMES, "no"),
        "strict-noise.ini": drives("XY", GAP_FRAMES, "no"),
        "strict.env": f"SEED={os.environ.get('EDM_SEED', 1)}\n"
                      f"RUNS={os.environ.get('EDM_RUNS', 4)}\n"
                      "SCENES=" + os.environ.get(
                          "EDM_SCENES", "up,refused,late,objects,homes,asked,inputs,marks,commission,ip,faults,attack,noise") + "\n",
    }, "-d", copies=[guest / n for n in (
        "can402.py", "strict.py", "can402_strict.py",
        "commission.py")] + [HERE.parent / "system/person.py"]))


@pytest.fixture(scope="session")
def unruly():
    """Drives that judge their master, a PLC and others on their bus."""
    guest = HERE / "guest"
    tail = {"slow": GAP_FRAMES.replace("gap_id", "sdo_ms = 1000\ngap_id"),
            "plc": GAP_FRAMES + SHARED, "stranger": GAP_FRAMES + SHARED}
    return checked(Run("unruly", {
        f"unruly-{name}.ini": drives(
            "XY", tail.get(name, GAP_FRAMES),
            "yes" if name == "absolute" else "no",
            falls="Y" if name == "says" else "")
        for name in UNRULY_SCENES
    } | {
        f"unruly-{name}.ngc": FAR if name == "stranger" else TO_AND_FRO
        for name in UNRULY_SCENES
    } | {
        "unruly.env": f"SEED={os.environ.get('EDM_SEED', 1)}\n"
                      f"RUNS={os.environ.get('EDM_RUNS', 0)}\n"
                      f"SCENES={','.join(UNRULY_SCENES)}\n",
    }, "-d", copies=[ROOT / "messages/edmd.eds"] + [guest / n for n in (
        "can402.py", "unruly.py", "stranger.py", "can402_unruly.py")]))


@pytest.fixture(scope="session")
def systemd():
    """systemd as PID 1, with what `make install` installs."""
    root = BUILD_VM / "root"
    shutil.rmtree(root, ignore_errors=True)
    made(["make", "-s", "-C", ROOT, "install", f"B={BUILD}",
          f"DESTDIR={root}", "PREFIX=/usr/local"])
    return checked(Run("systemd", {"service.ini": machine(cpu=1, tail=GAP),
                                   "slow.ngc": SLOW_JOB,
                                   "can.ini": drives("XY").replace(
                                       "vcan0", "can0")},
                       "-m", "systemd", copies=(
                           root, compiled("stop-thread"),
                           HERE / "guest/systemd_can.sh")))


@pytest.fixture(scope="session")
def packages():
    """What `make deb` makes, and the same once more as a later version; without
    python3-edm, whose python3-nacl the host need not have."""
    make = ["make", "-s", "-C", ROOT, "deb"]
    made(make)
    old, new = BUILD_VM / "old", BUILD_VM / "new"
    shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(ROOT / "build/deb", old)
    made([ROOT / "packaging/deb", ROOT / "build-deb",
          ROOT / "build-deb/deb/root", new, "0.1.1"])
    for deb in (*old.glob("python3*"), *new.glob("python3*")):
        deb.unlink()
    return checked(Run("packages", {
        "settings.ini": "overrun_limit = 0\ncpu = -1\nperiod_us = 5000\n",
        "job.ngc": "G21 G90\nG1 X0.2 F0.02\nG0 X0\nM30\n",
    }, "-m", "systemd", copies=(old, new)))


@pytest.fixture(scope="session")
def guest():
    """What the guests whose power fails go on from."""
    return power.Guest()
