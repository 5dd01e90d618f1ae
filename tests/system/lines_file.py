# SPDX-License-Identifier: Apache-2.0
"""A machine on the lines of a chip that is a file: build/tests/edmd-lines.

The test has the same levels in its memory, and each write of edmd as a record:
when it was, the lines, where the axis had come, the generator's registers.
"""

import collections
import mmap
import struct

import rig

NLINES, NREGISTERS = 64, 16
CHIP = struct.Struct(f"={NLINES}siI{NREGISTERS}H")
RECORD = struct.Struct(f"=Q{NLINES}siI{NREGISTERS}H")
REGISTERS = NLINES + 8

Record = collections.namedtuple("Record", "ns level at registers")


class Chip:
    def __init__(self, path, step):
        self.path = path
        path.write_bytes(CHIP.pack(b"", 0, step, *[0] * NREGISTERS))
        with open(path, "r+b") as f:
            self.memory = mmap.mmap(f.fileno(), CHIP.size)
        self.read_to = 0

    def put(self, line, level):
        self.memory[line] = level

    def level(self, line):
        return self.memory[line]

    def put_at(self, pulses):
        struct.pack_into("=i", self.memory, NLINES, pulses)

    def put_registers(self, first, values):
        struct.pack_into(f"={len(values)}H", self.memory,
                         REGISTERS + 2 * first, *values)

    def records(self):
        """Those that are new."""
        with open(f"{self.path}.trace", "rb") as f:
            f.seek(self.read_to)
            data = f.read()
        whole = len(data) // RECORD.size * RECORD.size
        self.read_to += whole
        for ns, level, at, _, *registers in RECORD.iter_unpack(data[:whole]):
            yield Record(ns, level, at, registers)


class Machine(rig.Machine):
    def __init__(self, folder, config, chip):
        super().__init__(folder, config)
        self.chip = chip

    def env(self, program):
        return {"EDM_LINES": str(self.chip.path)}

    def _command(self, program):
        name = "tests/edmd-lines" if program == "edmd" else program
        return [str(rig.BUILD / name)]
