# SPDX-License-Identifier: Apache-2.0
"""A generator on CAN that tells what it was sent: can_generator.py INTERFACE STUCK

As examples/machine-can402.ini lays it out: 1009 and 1010 are its values, 1011 and
1012 what it has.  The bits of STUCK are always
0 in its peak current.  It ends when it is killed.
"""
import socket
import struct
import sys

FRAME = struct.Struct("<IB3x8s")


def main():
    stuck = int(sys.argv[2])
    s = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    s.bind((sys.argv[1],))
    values, negative = [0, 0, 0, 0, 0], 0
    while True:
        at, _, data = FRAME.unpack(s.recv(FRAME.size))
        if at == 1009:
            values[:3] = struct.unpack_from("<3H", data, 2)
            negative = data[0] >> 2 & 1
        elif at == 1010:
            values[3:] = struct.unpack_from("<2H", data)
        else:
            continue
        peak, on, off, ignition, servo = values
        told = struct.pack("<4H", peak & ~stuck, on, off, servo)
        s.send(FRAME.pack(1011, 8, told))
        s.send(FRAME.pack(1012, 3, struct.pack("<HB", ignition, negative)))


main()
