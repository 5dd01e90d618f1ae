# SPDX-License-Identifier: Apache-2.0
"""A generator on CAN that tells what it was sent: can_generator.py INTERFACE STUCK

Frames 1009 and 1010 are its values, 1011 what it has.  The bits of STUCK are always
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
    values = [0, 0, 0, 0]
    while True:
        at, _, data = FRAME.unpack(s.recv(FRAME.size))
        if at == 1009:
            values[:3] = struct.unpack_from("<3H", data, 2)
        elif at == 1010:
            values[3], = struct.unpack_from("<H", data)
        else:
            continue
        told = struct.pack("<4H", values[0] & ~stuck, *values[1:])
        s.send(FRAME.pack(1011, 8, told))


main()
