# SPDX-License-Identifier: Apache-2.0
"""edmctl doctor --fix on a host that is a folder."""
import os
import subprocess

import pytest
from rig import BUILD

CORES = os.sysconf("SC_NPROCESSORS_CONF")
CPU = "sys/devices/system/cpu/cpu1"
KERNEL = {
    f"{CPU}/cpufreq/scaling_governor": "powersave\n",
    f"{CPU}/power/pm_qos_resume_latency_us": "0\n",
    "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor": "powersave\n",
    "proc/sys/kernel/sched_rt_runtime_us": "950000\n",
    "proc/irq/default_smp_affinity": "3\n",
    "proc/irq/9/smp_affinity_list": "0-1\n",
    "proc/77/comm": "irq/9-can7\n",
    "proc/78/comm": "irq/8-eth0\n",
}
MACHINE = """[machine]
backend = can402
cpu = {cpu}
[can402]
interface = can7
node_X = 1
[axis.Z]
present = no
"""

pytestmark = pytest.mark.skipif(CORES < 2, reason="needs two cores")


def fix(folder, cpu=1):
    for path, text in KERNEL.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    file = folder / "machine.ini"
    file.write_text(MACHINE.format(cpu=cpu))
    return subprocess.run(
        [BUILD / "edmctl", "doctor", "--fix", file, "--root", folder],
        capture_output=True, text=True)


def read(folder, path):
    return (folder / path).read_text()


def test_units_and_the_kernel_are_set(tmp_path):
    p = fix(tmp_path)
    assert p.returncode == 0, p.stdout + p.stderr
    units = "etc/systemd/system"
    assert "LimitRTPRIO=99" in read(
        tmp_path, f"{units}/edmd.service.d/realtime.conf")
    unit = read(tmp_path, f"{units}/edmd-realtime.service")
    assert f"edmctl doctor --fix \"{tmp_path / 'machine.ini'}\"\n" in unit
    assert read(tmp_path, f"{CPU}/cpufreq/scaling_governor") == "performance\n"
    assert read(tmp_path,
                f"{CPU}/power/pm_qos_resume_latency_us").startswith("n/a")
    assert read(tmp_path,
                "proc/sys/kernel/sched_rt_runtime_us").startswith("-1\n")
    mask = int(read(tmp_path, "proc/irq/default_smp_affinity").split()[0], 16)
    assert mask == (1 << CORES) - 1 - 2
    assert "1" not in read(
        tmp_path, "proc/irq/9/smp_affinity_list").split("\n")[0].split(",")


def test_an_adapter_that_comes_later_is_set_up_too(tmp_path):
    fix(tmp_path)
    rule = read(tmp_path, "etc/udev/rules.d/61-edmd-realtime.rules")
    assert rule.count("\n") == 1
    for part in ('KERNEL=="can7"', 'ATTR{tx_queue_len}="100"',
                 "try-restart edmd-realtime.service"):
        assert part in rule


def test_another_core_is_left_alone(tmp_path):
    fix(tmp_path)
    assert read(tmp_path, "sys/devices/system/cpu/cpu0/cpufreq/"
                "scaling_governor") == "powersave\n"


def test_the_bus_alone_is_raised_and_the_rest_is_told(tmp_path):
    out = fix(tmp_path).stdout
    assert "priority of irq/9-can7 (77): 79" in out and "eth0" not in out
    for line in ("isolcpus=1 ", "nohz_full=1 ", "rcu_nocbs=1 ",
                 "irqaffinity=0"):
        assert line in out
    # Each thing that is done says what it is worth.
    rows = out.split("\n\n")[0].splitlines()
    assert all(line.startswith(12 * " ") for line in rows[1::2]), out


def test_a_file_of_any_name_comes_into_the_unit(tmp_path):
    folder = tmp_path / "a 5% \"x\""
    folder.mkdir()
    fix(folder)
    unit = read(folder, "etc/systemd/system/edmd-realtime.service")
    assert '/a 5%% \\"x\\"/machine.ini"\n' in unit, unit


def test_what_cannot_be_written_is_told(tmp_path):
    (tmp_path / "etc").write_text("no folder")
    p = fix(tmp_path)
    assert p.returncode == 77
    assert p.stdout.count("Not a directory") == 3
    assert "written     /" in p.stdout      # the rest is done


def test_twice_is_as_once(tmp_path):
    first, again = fix(tmp_path), fix(tmp_path)
    assert first.stdout == again.stdout


@pytest.mark.parametrize("cpu", [-1, 1023])
def test_a_machine_without_a_core_of_its_own_is_refused(tmp_path, cpu):
    p = fix(tmp_path, cpu)
    assert p.returncode == 78 and "machine.cpu" in p.stderr
    assert not (tmp_path / "etc").exists()
