# SPDX-License-Identifier: Apache-2.0
"""A hostile user of the host: takes all that the panel has of one thing.

	crowd.py PORT WHAT

Says "ready" when it holds what it can, and goes on until its standard input
ends.  It needs nothing but Python, because it runs as the user nobody.
"""

import json
import os
import resource
import select
import socket
import struct
import sys
import time

PORT = int(sys.argv[1])
HOST = f"127.0.0.1:{PORT}"
# Every line makes 200 motions: reading it all takes longer than any limit.
BOMB = ("G21 G90 F30\nM98 P2\nM30\n"
        + "".join(f"O{i}\n" + f"M98 P{i + 1}\n" * 200 + "M99\n"
                  for i in range(2, 6))
        + "O6\nG91 G1 X0.001\nG1 X-0.001\nG90\nM99\n").encode()


def connect():
    return socket.create_connection(("127.0.0.1", PORT), 20)


def talk(s, text):
    """One request on @s; the head and the body of the answer."""
    s.sendall(text)
    got = b""
    while b"\r\n\r\n" not in got:
        part = s.recv(65536)
        if not part:
            return got, b""
        got += part
    head, body = got.split(b"\r\n\r\n", 1)
    for line in head.split(b"\r\n"):
        if line.lower().startswith(b"content-length:"):
            while len(body) < int(line[15:]):
                body += s.recv(65536)
    return head, body


def session():
    with connect() as s:
        head, body = talk(s, f"GET /api/session HTTP/1.1\r\nHost: {HOST}\r\n"
                             "\r\n".encode())
    cookie = head.split(b"edm_session=")[1].split(b";")[0].decode()
    return cookie, json.loads(body)["token"]


def head(me, path, length):
    cookie, token = me
    return (f"POST {path} HTTP/1.1\r\nHost: {HOST}\r\n"
            f"Origin: http://{HOST}\r\nCookie: edm_session={cookie}\r\n"
            f"X-Edm-Token: {token}\r\nContent-Length: {length}\r\n\r\n"
            ).encode()


def browser(me):
    s = connect()
    s.sendall((f"GET /api/live HTTP/1.1\r\nHost: {HOST}\r\n"
               "Upgrade: websocket\r\nConnection: Upgrade\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
               "Sec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Protocol: edm-panel\r\n"
               f"Origin: http://{HOST}\r\n"
               f"Cookie: edm_session={me[0]}\r\n\r\n").encode())
    return s


def frame(me, n, do, **more):
    text = json.dumps({"n": n, "token": me[1], "do": do, **more}).encode()
    return struct.pack("!BBH", 0x81, 0xfe, len(text)) + bytes(4) + text


# -- What is taken ---------------------------------------------------------------

def connections():
    held = [connect() for _ in range(900)]
    return lambda: held


def slow_heads():
    held = []
    for _ in range(500):
        s = connect()
        s.sendall(b"GET / HTTP/1.1\r\nHost: x")
        held.append(s)
    return lambda: held


def renewed():
    """Whoever is closed comes again."""
    held = [connect() for _ in range(500)]

    def step():
        gone, _, _ = select.select(held, [], [], 0.02)
        for s in gone:
            held.remove(s)
            s.close()
            held.append(connect())
    return step


def browsers():
    me = session()
    held = [browser(me) for _ in range(200)]

    def step():
        for s in select.select(held, [], [], 0.02)[0]:
            try:
                if s.recv(1 << 16):
                    continue
            except OSError:
                pass
            held.remove(s)
            held.append(browser(me))
    return step


def sessions():
    for _ in range(600):
        session()
    return lambda: time.sleep(0.1)


def uploads():
    me, held = session(), []

    def add():
        s = connect()
        s.sendall(head(me, "/api/check?name=slow.ngc", 1 << 20) + b"(slow")
        held.append(s)
    for _ in range(6):
        add()

    def step():
        time.sleep(0.2)
        for s in list(held):
            try:
                s.sendall(b"w")
            except OSError:
                held.remove(s)
                add()
    return step


def checks():
    me, held = session(), []

    def add():
        s = connect()
        s.sendall(head(me, "/api/check?name=bomb.ngc", len(BOMB)) + BOMB)
        held.append(s)
    for _ in range(8):
        add()

    def step():
        for s in select.select(held, [], [], 0.1)[0]:
            held.remove(s)
            s.close()
            add()
    return step


def paths():
    me = session()
    for i in range(30):
        text = f"G21 G90\nG1 X{i}.5 F60\nM30\n".encode()
        with connect() as s:
            talk(s, head(me, "/api/check?name=a.ngc", len(text)) + text)
    return lambda: time.sleep(0.1)


def questions():
    me = session()
    held = {browser(me): 0 for _ in range(60)}

    def step():
        for s in list(held):
            held[s] += 1
            try:
                s.sendall(frame(me, held[s], "past", arg=500))
            except OSError:
                del held[s]
        for s in select.select(list(held), [], [], 0)[0]:
            try:
                s.recv(1 << 20)
            except OSError:
                pass
    return step


def sockets():
    """Many of its own: who looks for one in a list of all has much to read."""
    there = socket.create_server(("127.0.0.1", 0), backlog=2000)
    held = []
    for _ in range(8000):
        held.append(socket.create_connection(there.getsockname(), 20))
        held.append(there.accept()[0])
    return connections()


def main():
    resource.setrlimit(resource.RLIMIT_NOFILE, (20000, 20000))
    os.setgroups([])
    os.setgid(65534)
    os.setuid(65534)
    step = globals()[sys.argv[2]]()
    print("ready", flush=True)
    while not select.select([sys.stdin], [], [], 0)[0]:
        step()


main()
