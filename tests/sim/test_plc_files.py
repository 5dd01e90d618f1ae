# SPDX-License-Identifier: Apache-2.0
"""messages/edmd.eds and edmd.dbc: as written, and as PLC tools read them."""
import subprocess
import sys

import canopen
import cantools
import pytest

from edmsim import PROGRAM, ROOT

EDMD = PROGRAM.replace("edmsim", "edmd")
EDS, DBC = ROOT / "messages/edmd.eds", ROOT / "messages/edmd.dbc"
NODE = 32


WRITE = ROOT / "messages/plc-files"


def written(*args):
    subprocess.run([sys.executable, WRITE, "--edmd", EDMD, *args], check=True)


def test_the_kept_files_are_what_the_script_writes(tmp_path):
    kept = [EDS, DBC, ROOT / "docs/plc-signals.md"]
    new = [tmp_path / p.name for p in kept]
    written(*new)
    for a, b in zip(kept, new):
        assert a.read_text() == b.read_text(), f"{a.name}: make plc-files"


def pdos(od, first, count):
    """(bit, bits, name) of each mapped object, by PDO."""
    for i in range(count):
        at, ret = 0, []
        for k in range(1, od[first + i][0].default + 1):
            entry = od[first + i][k].default
            index, sub, bits = entry >> 16, entry >> 8 & 0xff, entry & 0xff
            ret.append((at, bits, od[index][sub].name))
            assert od[index][sub].pdo_mappable
            assert len(od[index][sub]) == bits
            at += bits
        assert at <= 64
        yield ret


def test_canopen_imports_the_eds():
    od = canopen.import_od(str(EDS), node_id=NODE)
    assert od.device_information.product_name == "edmd"
    assert [od[0x1400 + i][1].default for i in range(3)] == \
        [0x200 + NODE, 0x300 + NODE, 0x400 + NODE]
    assert [od[0x1800 + i][1].default & 0x7ff for i in range(6)] == \
        [0x180 + NODE, 0x280 + NODE, 0x380 + NODE, 0x480 + NODE, 0x500 + NODE,
         0x680 + NODE]
    assert od[0x2100][3].max == 2000 and od[0x2100][3].writable
    assert not od[0x2000][1].writable
    assert len(list(pdos(od, 0x1a00, 6))) == 6
    assert len(list(pdos(od, 0x1600, 3))) == 3


def test_eds_and_dbc_have_the_same_signals_in_the_same_places():
    od = canopen.import_od(str(EDS), node_id=NODE)
    db = cantools.database.load_file(DBC)
    frames = {m.frame_id: m for m in db.messages}
    assert len(frames) == 9
    for first, com, count in ((0x1600, 0x1400, 3), (0x1a00, 0x1800, 6)):
        for i, mapped in enumerate(pdos(od, first, count)):
            frame = frames[od[com + i][1].default & 0x7ff]
            for at, bits, name in mapped:
                inside = [s for s in frame.signals
                          if at <= s.start and s.start + s.length <= at + bits]
                assert inside, name
                whole = [s for s in inside if s.name == name]
                # Only what is taken bit by bit has no signal of its own.
                assert whole or all(s.length == 1 for s in inside)
                assert not whole or whole[0].length == bits


def test_numbers_have_the_units_of_the_table():
    db = cantools.database.load_file(DBC)
    told = db.decode_message("EdmdStatus", bytes([4, 2, 0, 0, 0x10, 0x27,
                                                  0x0c, 0xfe]))
    assert told["GapVoltage"] == pytest.approx(100)
    assert told["Feed"] == pytest.approx(-0.5)
    assert (str(told["State"]), told["Spark"], told["Held"]) == ("erode", 1, 0)
    asked = db.encode_message("PlcRequest", {
        "Permit": 1, "Start": 0, "Hold": 0, "Reset": 0, "Done": 0,
        "Alive": 1,
        "DoorClosed": 1, "LevelOk": 1, "TemperatureOk": 1, "NoFire": 1,
        "WireWhole": 1, "FeedOverride": 70, "ProgramSelect": 12,
        "McodeDone": 60, "AxisTemperature": 21.5})
    assert asked == bytes([0x81, 0x1f, 0xbc, 2, 12, 0, 60, 86])


def test_a_machine_file_decides_node_times_and_units(tmp_path):
    machine = tmp_path / "m.ini"
    machine.write_text("[machine]\nbackend = null\n[plc]\nnode = 5\n"
                       "cycle_ms = 40\nalive_ms = 300\n"
                       "[axis.X]\npulse_mm = 0.0005\n")
    dbc = tmp_path / "m.dbc"
    written("--machine", machine, dbc)
    db = cantools.database.load_file(dbc)
    status, ask = (db.get_message_by_name(n)
                   for n in ("EdmdStatus", "PlcRequest"))
    assert (status.frame_id, ask.frame_id) == (0x185, 0x205)
    assert (status.cycle_time, ask.cycle_time) == (40, 150)
    place = db.decode_message("EdmdPositionXY", (3000).to_bytes(4, "little") +
                              bytes(4))
    assert place["PositionX"] == pytest.approx(1.5)
    assert db.get_message_by_name("EdmdPositionXY").get_signal_by_name(
        "PositionX").unit == "mm"


def test_types_and_access_are_those_of_cia_301():
    od = canopen.import_od(str(EDS), node_id=NODE)
    types = canopen.objectdictionary.datatypes
    assert od[0x1008].data_type == types.VISIBLE_STRING
    assert od[0x1008].default == "edmd"
    assert od[0x1014].default == 0x80 + NODE
    assert all(v.writable for v in (od[0x1003][0], od[0x1014], od[0x1017]))
    assert not any(v.writable for v in (od[0x1000], od[0x1001], od[0x1018][1]))


def machine_check(tmp_path, plc, backend="null"):
    machine = tmp_path / "m.ini"
    machine.write_text(f"[machine]\nbackend = {backend}\n[plc]\n{plc}\n")
    return subprocess.run([EDMD, "--config", machine, "--check"],
                          capture_output=True, text=True)


@pytest.mark.parametrize("plc, line, found", [
    ("m_before = 60-59", 4, "60-59"),
    ("m_before = 256", 4, "256"),
    ("m_before = 60,61", 4, "60,61"),
    ("m_free = 3", 4, "M3"),
    ("m_free = 25-35", 4, "M30"),
    ("m_before = 60\nm_after = 50-60", 5, "M60"),
    ("m_redo = 60", 4, "M60"),
    ("m_before = 60\nm_redo = 60\nm_stop = 60", 6, "M60"),
])
def test_lists_of_m_codes_are_refused_with_line_and_number(
        tmp_path, plc, line, found):
    p = machine_check(tmp_path, plc)
    assert p.returncode == 78
    assert f"m.ini:{line}:" in p.stderr and found in p.stderr
    assert "; " in p.stderr


def test_lists_of_m_codes_are_taken(tmp_path):
    p = machine_check(tmp_path, "m_before = 60 62 70-75\nm_after = 76\n"
                      "m_free = 255\nm_redo = 70-72 255\nm_stop = 76\n")
    assert p.returncode == 0, p.stderr
