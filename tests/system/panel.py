# SPDX-License-Identifier: Apache-2.0
"""The panel to test: edm-panel beside a machine, and clients of our own.

The clients speak HTTP and web sockets by other libraries than the panel's, and
can be as rude as a test wants.
"""

import contextlib
import http.client
import json
import os
import pathlib
import signal
import socket
import ssl
import struct
import subprocess

import rig
from websockets.sync.client import connect

PAGE = rig.BUILD / "panel"
CHROMIUM = os.environ.get("EDM_CHROMIUM", "/usr/bin/chromium")
CHROMIUM_FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
    "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
    "--enable-unsafe-swiftshader",
]

# A cut at a gap, some times faster than real, that takes minutes.
CUT_MACHINE = """
[machine]
name = {name}
backend = sim
overrun_limit = 0
cpu = -1
feed_default_mm_min = 30

[axis.A]
present = no

[axis.B]
present = no

[gap]
feed_gain_mm_s_v = 0.02
servo_v = 15
short_v = 8
open_v = 60
feed_max_mm_s = 0.5
abort_count = 1000

[jump]
height_mm = 1
every_s = 2

[sim]
speed = {speed}
seed = 1

[tech]
table = copper-steel.tech

[jobs]
store = {store}

[panel]
port = {port}
assets = {page}
{more}
"""

JOB = b"""G21 G90 G94
T84
M3
C120
G0 X0 Y0 Z0
G1 Z-2 F30
G1 X1 Z-2.2
G1 X0 Z-2.4
M30
"""


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Panel:
    """edm-panel of a machine; ended by close()."""

    def __init__(self, folder, speed=20, more="", config=CUT_MACHINE,
                 address="127.0.0.1"):
        self.port = free_port()
        self.address = address
        self.folder = pathlib.Path(folder)
        text = config.replace("{port}", str(self.port)).replace(
            "{page}", str(PAGE)).replace("{speed}", str(speed)).replace(
            "{more}", more)
        table = pathlib.Path("examples/copper-steel.tech").read_text()
        (self.folder / "copper-steel.tech").write_text(table)
        self.machine = rig.Machine(folder, text)
        self.process = None
        self.beside = contextlib.ExitStack()    # what ends with it
        self.secure = "certificate" in more

    @property
    def url(self):
        return f"{'https' if self.secure else 'http'}://127.0.0.1:{self.port}"

    def start(self):
        assert PAGE.exists(), f"no page in {PAGE}; make panel"
        try:
            self.machine.start()
            self.start_panel()
        except BaseException:
            self.close()    # a fixture that fails is not asked to
            raise

    def start_panel(self):
        with open(self.folder / "panel.log", "ab") as log:
            self.process = subprocess.Popen(
                [str(rig.BUILD / "edm-panel"), "--config",
                 str(self.machine.config)], stdout=log, stderr=log)
        rig.until(self.listens)

    def listens(self):
        assert self.process.poll() is None, self.log()
        try:
            socket.create_connection(("127.0.0.1", self.port), 1).close()
        except OSError:
            return False
        return True

    def log(self):
        return (self.folder / "panel.log").read_text()

    def kill(self):
        self.process.kill()
        self.process.wait()

    def close(self):
        if self.process and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            assert self.process.wait(timeout=20) == 0, self.log()
        self.machine.close()
        self.beside.close()
        print(f"-- edm-panel\n{self.log()}")
        assert "ERROR: " not in self.log(), "a sanitizer spoke"

    # -- HTTP

    def connection(self, timeout=30):
        if not self.secure:
            return http.client.HTTPConnection("127.0.0.1", self.port,
                                              timeout=timeout)
        context = ssl.create_default_context()
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE
        return http.client.HTTPSConnection("127.0.0.1", self.port,
                                           timeout=timeout, context=context)

    def ask(self, method, path, body=None, headers=None):
        """One request; gives status, headers, bytes."""
        c = self.connection()
        c.request(method, path, body=body, headers=headers or {})
        r = c.getresponse()
        got = r.read()
        c.close()
        return r.status, r.headers, got

    def session(self):
        """A session of this host's user: cookie and token."""
        status, headers, body = self.ask("GET", "/api/session")
        assert status == 200
        cookie = headers["Set-Cookie"].split(";")[0]
        return Session(self, cookie, json.loads(body))

    def raw(self, data, timeout=15):
        """Bytes as they are; what comes back until it is closed."""
        got = b""
        with socket.create_connection(("127.0.0.1", self.port),
                                      timeout) as s:
            s.settimeout(timeout)
            try:
                s.sendall(data)
                while part := s.recv(65536):
                    got += part
            except (TimeoutError, ConnectionError):
                pass
        return got


class Session:
    def __init__(self, panel, cookie, who):
        self.panel, self.cookie, self.who = panel, cookie, who
        self.token = who["token"]

    def headers(self, **more):
        return {"Cookie": self.cookie, "Origin": self.panel.url,
                "X-Edm-Token": self.token, **more}

    def post(self, path, body=b"", **more):
        headers = {k: v for k, v in self.headers(**more).items() if v}
        status, _, got = self.panel.ask("POST", path, body, headers)
        return status, json.loads(got) if got else None

    def live(self, origin=None, cookie=None, **more):
        url = self.panel.url.replace("http", "ws", 1) + "/api/live"
        return Live(self, connect(
            url, subprotocols=["edm-panel"], open_timeout=20,
            origin=origin or self.panel.url, max_size=None,
            additional_headers={"Cookie": cookie or self.cookie}, **more))


    def raw_live(self):
        """A web socket as a bare socket, shaken hands with."""
        s = socket.create_connection(("127.0.0.1", self.panel.port), 10)
        s.sendall((f"GET /api/live HTTP/1.1\r\n"
                   f"Host: 127.0.0.1:{self.panel.port}\r\n"
                   "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                   "Sec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Protocol: edm-panel\r\n"
                   f"Origin: {self.panel.url}\r\n"
                   f"Cookie: {self.cookie}\r\n\r\n").encode())
        assert b" 101 " in s.recv(200)
        return s

    def frame(self, n, do, **more):
        """A request as a frame, masked with zeros."""
        text = json.dumps({"n": n, "token": self.token, "do": do,
                           **more}).encode()
        return (struct.pack("!BBH", 0x81, 0x80 | 126, len(text)) + bytes(4)
                + text)


class Live:
    """A web socket: the state as it was told last, and answers."""

    def __init__(self, session, ws):
        self.session, self.ws = session, ws
        self.n = 0
        self.state, self.told, self.hello = {}, 0, None
        self.answers = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ws.close()

    def take(self, timeout=5):
        m = json.loads(self.ws.recv(timeout))
        if "hello" in m:
            self.hello = m["hello"]
        if "whole" in m or "new" in m:
            self.state = {**({} if "whole" in m else self.state),
                          **m.get("whole", m.get("new"))}
            self.told += 1
        if "n" in m:
            self.answers[m["n"]] = m
        return m

    def where(self, what, timeout=10.0):
        rig.until(lambda: self.take() and what(self.state), timeout, 0)
        return self.state

    def send(self, do, **more):
        self.n += 1
        self.ws.send(json.dumps({"n": self.n, "token": self.session.token,
                                 "do": do, **more}))
        return self.n

    def ask(self, do, timeout=10.0, **more):
        n = self.send(do, **more)
        rig.until(lambda: n in self.answers or (self.take() and False) or
                  n in self.answers, timeout, 0)
        return self.answers.pop(n)
