# SPDX-License-Identifier: Apache-2.0
"""A PLC that knows CiA 301 and the EDS of its slave, and nothing else of it.

Everything that the slave sends is judged by the state that it was commanded to
be in; what CiA 301 does not let it do then is in the list `offences`.
"""
import configparser
import socket
import struct
import threading
import time

NODE = 32
PERMIT, START, ALIVE = 1, 2, 0x80
LOCKS = 0x1f
RTR = 0x40000000
SO_TIMESTAMP = 29       # Python has no name for it
# What may be under way while a command is: two periods, and a busy guest.
GRACE_S = 0.06
PREOP, OPERATIONAL, STOPPED = 0x7f, 5, 4
STATE_BY = {1: OPERATIONAL, 2: STOPPED, 0x80: PREOP, 0x81: PREOP, 0x82: PREOP}
SIZES = {2: 1, 3: 2, 4: 4, 5: 1, 6: 2, 7: 4, 9: 4}
# Abort codes of CiA 301.
MISSING, NO_SUB, READ_ONLY, RANGE = (0x06020000, 0x06090011, 0x06010002,
                                     0x06090030)
LENGTHS = (0x06070010, 0x06070012, 0x06070013)
COMMAND, STATE_NOW, NO_DATA = 0x05040001, 0x08000022, 0x08000024


def objects_of(eds):
    """Index, sub-index, size, access of each."""
    text = configparser.ConfigParser()
    text.read(eds)
    for name in text.sections():
        index, _, sub = name.partition("sub")
        if "AccessType" not in text[name]:
            continue
        yield (int(index, 16), int(sub or "0", 16),
               SIZES[int(text[name]["DataType"], 16)],
               text[name]["AccessType"])


class Stranger(threading.Thread):
    def __init__(self, interface):
        super().__init__(daemon=True)
        self.bus = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.bus.setsockopt(
            socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER,
            b"".join(struct.pack("=II", i, m) for i, m in (
                *((base + NODE, 0x7ff) for base in (
                    0x080, 0x180, 0x280, 0x380, 0x480, 0x580, 0x700)),
                (0x0a5, 0x7ff))))
        self.bus.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMP, 1)
        self.bus.bind((interface,))
        self.bus.settimeout(0.01)
        self.offences, self.beats, self.emergencies = [], [], []
        self.pdos, self.boots = 0, 0
        self.state, self.since = PREOP, time.time()
        self.command, self.talking, self.ended = PERMIT, True, False
        self.emcy_id, self.toggle = 0x080 + NODE, None
        self.answer, self.asked = None, False
        self.next, self.lock = 0, threading.Lock()

    # -- What it says --------------------------------------------------------

    def send(self, can_id, data):
        self.bus.send(struct.pack("=IB3x8s", can_id, len(data),
                                  bytes(data).ljust(8, b"\0")))

    def nmt(self, command, node=NODE):
        with self.lock:
            if command in STATE_BY and node in (0, NODE):
                self.state, self.since = STATE_BY[command], time.time()
                self.toggle = None
            if command in (0x81, 0x82):
                self.emcy_id = 0x080 + NODE
                self.beats.clear()
            self.send(0x000, [command, node])

    def run(self):
        while not self.ended:
            now = time.monotonic()
            if now >= self.next:
                self.next = now + 0.02
                if self.talking:
                    self.command ^= ALIVE
                    self.send(0x200 + NODE, [self.command, LOCKS, 0xe8, 3,
                                             0, 0, 0, 0])
            self.hear()

    # -- What it hears -------------------------------------------------------

    def offence(self, what):
        if len(self.offences) < 40:
            self.offences.append((time.time(), what))

    def hear(self):
        try:
            data, extra, _, _ = self.bus.recvmsg(16, 64)
        except socket.timeout:
            return
        at = struct.unpack("=qq", extra[0][2][:16])
        at = at[0] + at[1] * 1e-6
        can_id, size = struct.unpack_from("=IB", data)
        data = data[8:8 + size]
        with self.lock:
            settled = at > self.since + GRACE_S
            if can_id == 0x700 + NODE:
                self.hear_beat(at, data, settled)
            elif can_id == 0x580 + NODE:
                self.hear_answer(data, settled)
            elif can_id == self.emcy_id:
                self.hear_emergency(data, settled)
            elif can_id in (0x080 + NODE, 0x0a5):
                self.offence(f"emergency by {can_id:x}, not {self.emcy_id:x}")
            else:
                self.hear_pdo(can_id, data, settled)

    def hear_beat(self, at, data, settled):
        if len(data) != 1:
            self.offence(f"a heartbeat of {len(data)} bytes")
        elif data[0] == 0:
            self.boots += 1
        elif settled and data[0] != self.state:
            self.offence(f"a heartbeat of state {data[0]:x}, commanded "
                         f"{self.state:x}")
        self.beats.append(at)

    def hear_answer(self, data, settled):
        if len(data) != 8:
            self.offence(f"an SDO answer of {len(data)} bytes")
        elif not self.asked:
            self.offence(f"an SDO answer to no request: {data.hex()}")
        elif self.state == STOPPED and settled:
            self.offence("an SDO answer while stopped")
        self.answer, self.asked = data, False

    def hear_emergency(self, data, settled):
        if len(data) != 8:
            self.offence(f"an emergency of {len(data)} bytes")
            return
        code = struct.unpack_from("<H", data)[0]
        if self.state == STOPPED and settled:
            self.offence(f"emergency {code:x} while stopped")
        if (code != 0) != bool(data[2] & 1):
            self.offence(f"emergency {code:x} with error register {data[2]:x}")
        self.emergencies.append(code)

    def hear_pdo(self, can_id, data, settled):
        self.pdos += 1
        if self.state != OPERATIONAL and settled:
            self.offence(f"PDO {can_id:x} in state {self.state:x}")
        if can_id == 0x180 + NODE and len(data) == 8:
            if settled and data[1] & 1 == self.toggle:
                self.offence("its toggle did not turn")
            self.toggle = data[1] & 1 if settled else None

    def faults(self):
        """Emergencies that told one, and not its end."""
        return sum(code != 0 for code in self.emergencies)

    # -- What it asks --------------------------------------------------------

    def request(self, data, seconds=1.0):
        """Eight bytes there, eight back; None: no answer."""
        with self.lock:
            self.answer, self.asked = None, True
            self.send(0x600 + NODE, data)
        end = time.monotonic() + seconds
        while self.answer is None and time.monotonic() < end:
            time.sleep(0.005)
        self.asked = False
        return self.answer

    def read(self, index, sub, size=None):
        """Its value; a negative number: minus the abort code."""
        a = self.request(struct.pack("<BHB4x", 0x40, index, sub))
        if a is None:
            return None
        if a[1:4] != struct.pack("<HB", index, sub):
            self.offence(f"{index:04x}:{sub} answered as {a[1:4].hex()}")
        if a[0] == 0x80:
            return -struct.unpack_from("<I", a, 4)[0]
        n = 4 - (a[0] >> 2 & 3)
        if a[0] & 0xf3 != 0x43 or size not in (None, n):
            self.offence(f"{index:04x}:{sub} of {size} bytes: {a.hex()}")
        return int.from_bytes(a[4:4 + n], "little")

    def write(self, index, sub, size, value):
        """0: taken; minus the abort code."""
        return self.raw(struct.pack("<BHBI", 0x23 | (4 - size) << 2, index, sub,
                                    value & (1 << 8 * size) - 1))

    def raw(self, data):
        a = self.request(data)
        if a is None:
            return None
        if a[0] == 0x80:
            return -struct.unpack_from("<I", a, 4)[0]
        return 0 if a[0] == 0x60 else f"answer {a.hex()}"


def row(what, got, wanted):
    """JSON has no bytes."""
    return what, got.hex() if isinstance(got, bytes) else got, wanted


def examine(p, eds):
    """(what, what came, what CiA 301 has) of all that a client may ask."""
    rows = []

    def ask(what, got, *wanted):
        rows.append(row(what, got, wanted))

    there = list(objects_of(eds))
    for index, sub, size, access in there:
        name = f"{index:04x}:{sub}"
        got = p.read(index, sub, size)
        if index == 0x1003 and sub > 0:
            ask(f"read {name}, no error", got, -NO_DATA, -0x08000000)
            continue
        ask(f"read {name}", got is not None and got >= 0, True)
        if index >= 0x2000 or got is None or got < 0:
            continue
        ask(f"write {name}, what it has", p.write(index, sub, size, got), 0)
        if access in ("ro", "const"):
            ask(f"write {name}, another", p.write(index, sub, size, got ^ 1),
                -READ_ONLY)
    for index, sub in (0x1f80, 0), (0x5fff, 7), (0xffff, 255), (0, 0):
        ask(f"read {index:x}", p.read(index, sub), -MISSING)
        ask(f"write {index:x}", p.write(index, sub, 4, 1), -MISSING)
    for index, sub in (0x1017, 1), (0x1018, 9), (0x2000, 99), (0x1003, 200):
        ask(f"read {index:x}:{sub}", p.read(index, sub), -NO_SUB,
            *([-NO_DATA] if index == 0x1003 else []))
    for size in 1, 4:
        ask(f"1017 by {size} bytes", p.write(0x1017, 0, size, 100),
            *(-code for code in LENGTHS))
    ask("2000:1", p.write(0x2000, 1, 1, 0), -READ_ONLY)
    for value in 1, 2, 255:
        ask(f"1003:0 = {value}", p.write(0x1003, 0, 1, value), -RANGE)
    for first in 0xa0, 0xc0, 0xe0, 0x00, 0x60, 0x70:
        ask(f"command {first:x}", p.raw(bytes([first, 0x17, 0x10, 0, 0, 0, 0,
                                               0])), -COMMAND)
    ask("segments are not offered", p.raw(struct.pack("<BHBI", 0x21, 0x1017, 0,
                                                      2)),
        -COMMAND, *(-code for code in LENGTHS))
    ask("an abort has no answer", p.request(struct.pack(
        "<BHBI", 0x80, 0x1017, 0, 0x05040000), 0.2), None)
    for size in range(8):
        ask(f"a request of {size} bytes", p.request(bytes([0x40, 0, 0x10, 0, 0,
                                                           0, 0, 0])[:size],
                                                    0.05), None)
    ask("it is there after all that", p.read(0x1000, 0, 4), 0)
    return rows
