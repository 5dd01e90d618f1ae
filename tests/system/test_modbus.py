# SPDX-License-Identifier: Apache-2.0
"""A generator on Modbus: the slave is pymodbus, over TCP and over a pty."""

import json
import os
import pathlib
import re
import signal
import subprocess

import pytest
import rig
from modbus_slave import LAYOUT, SUMS, Slave

ROOT = pathlib.Path(__file__).resolve().parents[2]

MACHINE = rig.NULL_MACHINE + """
[tech]
table = shop.tech

[generator]
interface = modbus
modbus = {where}
modbus_every_ms = 20
silent_ms = 2000
modbus_timeout_ms = 900
confirm_s = 3
""" + LAYOUT

# The published one: 6 A, 8 us, 20 us, 180 V; and 15 V of servo voltage.
TABLE = """
condition, servo_v [V], peak_a [A], on_us [us], off_us [us], ignition_v [V]
C200, 15, 6, 8, 20, 180
C100, 20, 12, 20, 50, 120
"""

JOB = b"G21 G90\nC200 G1 X1 F60\nC100\nX2\nM30\n"
LONG_JOB = b"G21 G90\nC200 G1 X40 F60\nM30\n"


class Shop:
    def __init__(self, m, slave):
        self.m, self.slave, self.c = m, slave, m.client

    def told(self):
        o = json.loads(self.m.ctl("--json", "generator").stdout)
        return o, {f["name"]: f for f in o["fields"]}

    def until_in_force(self):
        rig.until(lambda: self.told()[0]["in_force"], 10)
        return self.told()[1]

    def cut(self, text=LONG_JOB):
        assert self.c.submit(text, "job").code == 0
        self.c.status_where(lambda s: s.place_mm > 0.1)
        self.until_in_force()

    def logs(self, words):
        """A machine without a gap has no sparks to end, and says it."""
        rig.until(lambda: words in self.m.log("edmd"), 10)


def make(tmp_path, slave, more=""):
    text = (MACHINE + more).replace("{where}", slave.where)
    return rig.Machine(tmp_path, text)


@pytest.fixture(params=["tcp", "rtu"])
def shop(request, tmp_path):
    with Slave(pty=request.param == "rtu") as slave:
        with make(tmp_path, slave) as m:
            (tmp_path / "shop.tech").write_text(TABLE)
            m.start()
            yield Shop(m, slave)


@pytest.fixture
def tcp(tmp_path):
    with Slave() as slave, make(tmp_path, slave) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        yield Shop(m, slave)


def test_a_condition_reaches_it_whole(shop):
    shop.cut(JOB)
    shop.c.job_where("job", "done")
    written = [w for w in shop.slave.writes if w[2] == 10 and w[1] == 16]
    assert [w[3][:4] for w in written][-2:] == [
        [60, 80, 200, 180], [120, 200, 500, 120]]
    assert shop.slave.get(15) == 200 and 150 in {
        w[3][15 - w[2]] for w in shop.slave.writes
        if w[2] <= 15 < w[2] + len(w[3])}
    told = shop.until_in_force()
    assert told["peak_a"]["told"] == pytest.approx(12)
    assert told["off_us"]["by"] == "register"
    values = json.loads(shop.c.ask("values").body)
    assert values["told"]["ignition_v"] == pytest.approx(120)
    # Nothing is written that the slave has.
    n, reads = len(shop.slave.writes), shop.slave.reads
    rig.until(lambda: shop.slave.reads > reads + 5)
    assert len(shop.slave.writes) == n


def test_c200_reaches_the_shipped_example_whole(tmp_path):
    """Its layout, at another place, and without its lines."""
    text = (ROOT / "examples/machine-modbus.ini").read_text()
    section = re.search(r"^\[generator\]\n(.*?)(?=^\[)", text, re.M | re.S)[1]
    layout = re.sub(r"^(interface|modbus\w*|silent_ms|sense) = .*\n", "", section,
                    flags=re.M)
    with Slave() as slave, rig.Machine(
            tmp_path, MACHINE.replace(LAYOUT, layout).replace(
                "{where}", slave.where)) as m:
        (tmp_path / "shop.tech").write_text(
            (ROOT / "examples/copper-steel.tech").read_text())
        m.start()
        assert m.client.submit(LONG_JOB, "job").code == 0
        rig.until(lambda: slave.get(15) == 150, 20)
        assert [slave.get(a) for a in range(10, 16)] == [60, 80, 200, 180, 0, 150]


def test_a_walk_goes_through_each_step_and_all_is_as_before(shop):
    begin_as_before(shop)
    p = shop.m.ctl("generator", "walk", "--every", "9000", timeout=120)
    assert p.returncode == 0, p.stdout + p.stderr
    assert " 0 not told as asked; all is as it was before" in p.stdout
    peaks = [w[3][0] for w in shop.slave.writes if w[2] == 10]
    assert min(peaks) == 1 and max(peaks) >= 9000
    assert [shop.slave.get(a) for a in range(10, 16)] == BEFORE
    assert all(f["asked"] is None for f in shop.told()[1].values())


def test_a_walk_finds_what_is_told_otherwise(tcp):
    tcp.slave.lies[11] = 7
    p = tcp.m.ctl("generator", "walk", "--every", "40000", timeout=200)
    assert p.returncode == 1, p.stdout + p.stderr
    assert "on_us 0.1 us: asked 0.1, told 0.7" in p.stdout
    assert "peak_a" not in [r.split()[0] for r in p.stdout.splitlines()
                            if ": asked" in r]
    assert all(f["asked"] is None for f in tcp.told()[1].values())


def test_a_walk_that_a_job_ends_asks_for_nothing_more(tcp):
    walk = subprocess.Popen(
        [str(rig.BUILD / "edmctl"), "--machine", tcp.m.name, "generator",
         "walk"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    rig.until(lambda: tcp.slave.get(10) > 0, 20)
    tcp.cut()
    out, err = walk.communicate(timeout=60)
    # It was about to ask, or waited for what it had asked.
    assert walk.returncode in (1, 75), out
    assert "without sparks: no job loaded" in err
    assert tcp.slave.get(10) == 60


BEFORE = [60, 80, 200, 180, 1, 150]


def as_before(shop):
    rig.until(lambda: [shop.slave.get(a) for a in range(10, 16)] == BEFORE)
    rig.until(lambda: all(f["asked"] is None for f in shop.told()[1].values()))


def walks(shop, *every):
    return subprocess.Popen(
        [str(rig.BUILD / "edmctl"), "--machine", shop.m.name, "generator",
         "walk", *every], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True)


def read_anew(shop):
    reads = shop.slave.reads
    rig.until(lambda: shop.slave.reads > reads + 5)


def begin_as_before(shop):
    """edmd writes the pump's bit once it has read the bits beside it: who sets
    those in between loses them."""
    read_anew(shop)
    shop.slave.block.setValues(11, BEFORE)
    read_anew(shop)


def test_of_two_walks_at_once_each_ends_and_all_is_as_before(tcp):
    begin_as_before(tcp)
    both = [walks(tcp, "--every", e) for e in ("9000", "7000")]
    for w in both:
        out, err = w.communicate(timeout=200)
        assert w.returncode == 0 or (
            w.returncode == 75 and "somebody else asks for" in err), out + err
    as_before(tcp)


@pytest.mark.parametrize("how", ["kill", "terminate"])
def test_what_one_who_vanished_tried_is_not_what_the_next_job_has(tcp, how):
    """It gives no current: that is the one of before then.  Who is interrupted
    asks for that, and does not wait until it is taken."""
    begin_as_before(tcp)
    w = walks(tcp)
    rig.until(lambda: tcp.slave.get(10) not in (0, 60), 20)
    getattr(w, how)()
    w.communicate(timeout=60)
    tcp.cut(b"G21 G90\nG1 X40 F60\nM30\n")
    tcp.until_in_force()
    assert tcp.slave.get(10) == 60
    assert tcp.told()[1]["peak_a"]["told"] == pytest.approx(6)


def test_what_one_who_vanished_tried_ends_with_its_lease(tcp):
    """Nobody comes after it: confirm_s, and 10 s."""
    begin_as_before(tcp)
    assert tcp.m.ctl("generator", "set", "on_us", "20").returncode == 0
    w = walks(tcp)
    rig.until(lambda: tcp.slave.get(10) not in (0, 60), 20)
    w.kill()
    w.communicate(timeout=60)
    rig.until(lambda: tcp.slave.get(10) == 60, 40)
    rig.until(lambda: tcp.told()[1]["peak_a"]["asked"] is None)
    assert tcp.told()[1]["on_us"]["asked"] == 20    # as long as it is wanted


def sets(shop, value):
    assert shop.m.ctl("generator", "set", "peak_a", str(value)).returncode == 0
    rig.until(lambda: shop.slave.get(10) == 10 * value)


def test_a_walk_leaves_what_was_set(tcp):
    """At its end, and when it goes on after its lease: what was set meanwhile."""
    begin_as_before(tcp)
    sets(tcp, 9)
    p = tcp.m.ctl("generator", "walk", "--every", "9000", timeout=120)
    assert p.returncode == 0 and "all is as it was before" in p.stdout
    assert tcp.told()[1]["peak_a"]["asked"] == 9
    w = walks(tcp)
    rig.until(lambda: tcp.slave.get(10) != 90, 20)
    w.send_signal(signal.SIGSTOP)
    rig.until(lambda: tcp.slave.get(10) == 90, 40)
    sets(tcp, 7)
    w.send_signal(signal.SIGCONT)
    _, err = w.communicate(timeout=60)
    assert w.returncode == 75 and "somebody else asks for 7" in err
    assert tcp.until_in_force()["peak_a"]["asked"] == 7


def test_a_walk_of_one_that_falls_silent_ends(tmp_path):
    quick = "\nmodbus_timeout_ms = 90\nsilent_ms = 300\nconfirm_s = 0.05\n"
    with Slave() as slave, make(tmp_path, slave) as m:
        text = m.config.read_text()
        for line in ("modbus_timeout_ms = 900", "silent_ms = 2000",
                     "confirm_s = 3"):
            text = text.replace(line + "\n", "")
        m.config.write_text(text + quick)
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        Shop(m, slave).until_in_force()
        slave.silent = True
        p = m.ctl("generator", "walk")
        assert p.returncode == 1
        assert "8 of " in p.stdout and "8 not told as asked" in p.stdout


def test_an_edmd_that_dies_in_a_walk_has_nothing_tried(tcp):
    assert tcp.m.ctl("generator", "set", "peak_a", "6").returncode == 0
    rig.until(lambda: tcp.slave.get(10) == 60)
    tcp.m.kill("edmd")
    tcp.m.start_edmd()
    tcp.c.status_where(lambda s: s.daemon == "ok")
    rig.until(lambda: tcp.told()[0]["there"])
    assert tcp.told()[1]["peak_a"]["asked"] is None


@pytest.fixture
def sums(tmp_path):
    with Slave() as slave, make(tmp_path, slave, SUMS) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        slave.count(0x1FFF0, 7, 10)
        m.start()
        yield Shop(m, slave)


def test_what_it_counts_reaches_people(sums):
    sums.c.status_where(lambda s: s.told_sparks == 0)
    sums.slave.count(0x20010, 0x10007, 1510)
    s = sums.c.status_where(lambda s: s.told_energy_j > 0)
    assert s.told_sparks == 0x20 and s.told_arcs == 0x10000
    assert s.told_energy_j == pytest.approx(1.5)
    assert s.told_shorts != s.told_shorts and s.told_fault == 0
    told = json.loads(sums.c.ask("values").body)["told"]
    assert told["sparks"] == 0x20 and "shorts" not in told
    text = sums.m.ctl("status").stdout
    assert "sparks 32, arcs 65536, energy_j 1.5 J, fault 0" in text
    seen = json.loads(sums.m.ctl("--json", "status").stdout)
    assert seen["told_arcs"] == 65536 and "told_opens" not in seen


def test_its_own_fault_is_told_in_its_words(sums):
    sums.cut()
    sums.slave.count(0x1FFF0, 7, 10, fault=2)
    s = sums.c.status_where(lambda s: s.told_fault == 2)
    assert s.generator_fault == "2 too warm"
    sums.logs("generator: its own fault 2 too warm")
    assert "its own fault: 2 too warm" in sums.m.ctl("status").stdout
    values = json.loads(sums.c.ask("values").body)
    assert values["generator_fault"] == "2 too warm"


def test_the_fleet_hears_what_it_tells(sums):
    sums.slave.count(0x20010, 7, 10, fault=1)
    sums.c.status_where(lambda s: s.told_sparks == 0x20)
    dds = subprocess.Popen([rig.BUILD / "edm-dds", "--config", sums.m.config])
    try:
        p = subprocess.run([rig.BUILD / "edm-fleet", "--once", "--json"],
                           capture_output=True, text=True, timeout=60)
    finally:
        dds.terminate()
        dds.wait(60)
    [m] = json.loads(p.stdout)["machines"]
    assert m["told_sparks"] == 0x20 and m["told_opens"] is None
    assert m["generator_fault"] == "1 no water"


def test_one_that_lies_ends_the_sparks(shop):
    shop.cut()
    shop.slave.lies[10] = 75
    shop.logs("peak_a was in force and is no more: asked 6, told 7.5")
    rig.until(lambda: not shop.told()[0]["in_force"])


def test_one_that_was_reset_has_all_again_with_what_is_asked_next(tcp):
    tcp.cut(JOB)
    tcp.until_in_force()
    tcp.slave.reset()
    tcp.logs("was in force and is no more: asked 6, told 0")
    tcp.c.job_where("job", "done")
    assert tcp.slave.get(10) == 120 and tcp.slave.get(13) == 120
    assert tcp.until_in_force()["peak_a"]["told"] == pytest.approx(12)


def test_one_that_refuses_a_value_is_told_by_its_field(shop):
    shop.slave.refuses[12] = 3
    assert shop.c.submit(LONG_JOB, "job").code == 0
    shop.logs("it refuses off_us: asked 20, answered exception 3, no such "
              "value")
    rig.until(lambda: not shop.told()[0]["in_force"])


def test_one_without_function_16_is_written_singly(tcp):
    mangle = tcp.slave._pdu

    def no_16(sending, pdu):
        if sending and tcp.slave.asked.function_code == 16:
            tcp.slave.refuses = {a: 1 for a in range(10, 16)}
        else:
            tcp.slave.refuses = {}
        return mangle(sending, pdu)

    tcp.slave.stop()
    tcp.slave._pdu = no_16
    tcp.slave.start()
    tcp.cut()
    assert tcp.slave.get(10) == 60 and tcp.slave.get(12) == 200
    assert 6 in {w[1] for w in tcp.slave.writes}
    assert tcp.until_in_force()["off_us"]["told"] == pytest.approx(20)


def test_one_that_is_silent_is_a_fault(shop):
    shop.cut()
    shop.slave.silent = True
    shop.logs("it does not tell its peak_a any more")
    shop.logs("Modbus link is down")
    rig.until(lambda: not shop.told()[0]["in_force"])
    shop.slave.silent = False
    shop.logs("Modbus link is there")


def test_one_that_comes_late_is_waited_for(tcp):
    tcp.slave.late_s = 0.3
    assert tcp.m.ctl("generator", "set", "peak_a", "6").returncode == 0
    assert tcp.until_in_force()["peak_a"]["told"] == pytest.approx(6)


def test_a_link_that_is_cut_comes_back(tcp):
    tcp.cut()
    tcp.slave.stop()
    tcp.logs("it does not tell its peak_a any more")
    tcp.slave.start()
    tcp.logs("Modbus link is there")
    assert tcp.until_in_force()["peak_a"]["told"] == pytest.approx(6)


def test_a_serial_port_that_goes_is_opened_again_when_it_is_back(tmp_path):
    with Slave(pty=True) as slave:
        link = str(tmp_path / "usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0")
        os.symlink(slave.where, link)
        slave.where = link
        with make(tmp_path, slave) as m:
            (tmp_path / "shop.tech").write_text(TABLE)
            m.start()
            shop = Shop(m, slave)
            shop.cut()
            slave.unplug()
            shop.logs("it does not tell its peak_a any more")
            shop.logs("Modbus link is down")
            slave.plug()
            shop.logs("Modbus link is there")
            assert shop.until_in_force()["peak_a"]["told"] == \
                pytest.approx(6)


def of_another_unit(data):
    return bytes([data[0] ^ 1]) + data[1:]


def cut_and_lose(shop, mangle):
    shop.cut()
    shop.slave.mangle = mangle
    shop.logs("it does not tell its peak_a any more")
    shop.slave.mangle = None
    shop.logs("Modbus link is there")
    assert shop.until_in_force()["peak_a"]["told"] == pytest.approx(6)


def test_half_an_answer_is_none(shop):
    cut_and_lose(shop, lambda data: data[:len(data) // 2])


@pytest.mark.parametrize("shop", ["rtu"], indirect=True)
def test_an_answer_of_another_unit_is_none(shop):
    cut_and_lose(shop, of_another_unit)


def test_a_port_that_is_not_there_is_refused(tmp_path):
    for where, words in (
        ("/dev/ttyNONE7", "generator.modbus /dev/ttyNONE7: No such file"),
        ("/dev/null", "/dev/null: is no serial port"),
    ):
        slave = Slave()
        slave.where = where
        with make(tmp_path, slave) as m:
            (tmp_path / "shop.tech").write_text(TABLE)
            p = subprocess.run([rig.BUILD / "edmd", "--config", m.config],
                               capture_output=True, text=True, timeout=60)
            assert p.returncode == 78, p.stderr
            assert words in p.stderr
            assert "192.168.1.5:502" in p.stderr


def test_it_is_there_before_its_slave_is(tmp_path):
    slave = Slave()
    slave.port = 5020
    slave.where = "127.0.0.1:5020"
    with make(tmp_path, slave) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        shop = Shop(m, slave)
        assert shop.told()[1]["peak_a"]["told"] is None
        slave.start()
        try:
            assert m.ctl("generator", "set", "on_us", "8").returncode == 0
            assert shop.until_in_force()["on_us"]["told"] == pytest.approx(8)
        finally:
            slave.stop()


