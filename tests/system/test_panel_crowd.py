# SPDX-License-Identifier: Apache-2.0
"""A user of the host who takes all that the panel has keeps no operator off it.

Each test runs beside crowd.py, which is the user nobody, and does what an
operator does: open the page, watch, check a program, end a motion.
"""

import contextlib
import json
import os
import pathlib
import socket
import struct
import subprocess
import time

import panel
import pytest
import rig

CROWD = pathlib.Path(__file__).parent / "crowd.py"
ALL = ["connections", "slow_heads", "renewed", "browsers", "sessions",
       "uploads", "checks", "paths", "questions", "sockets"]

pytestmark = pytest.mark.skipif(os.getuid() != 0,
                                reason="needs root, to be another user")


@contextlib.contextmanager
def crowd(p, what):
    proc = subprocess.Popen(["/usr/bin/python3", str(CROWD), str(p.port),
                             what], stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, text=True)
    try:
        assert proc.stdout.readline() == "ready\n"
        yield
        assert proc.poll() is None, "the crowd gave up"
    finally:
        proc.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            proc.wait(10)
        proc.kill()
        proc.wait()


@pytest.mark.parametrize("what", ALL)
def test_a_crowd_keeps_no_operator_out(p, what):
    before = p.session()
    _, kept = before.post("/api/check?name=mine.ngc", panel.JOB)
    with crowd(p, what):
        # The session and the path of before are still there.
        status, got = before.post("/api/check?name=a.ngc", panel.JOB)
        assert status == 200 and got["ok"], got
        assert p.ask("GET", f"/api/path?check={kept['check']}",
                     headers=before.headers())[0] == 200
        for _ in range(3):
            assert p.ask("GET", "/")[0] == 200
            me = p.session()
            assert me.who["role"] == "operator"
            with me.live() as live:
                live.where(lambda s: s.get("daemon") == "ok" and s["jobs"],
                           30)
                assert live.ask("queue", timeout=20)["code"] == 0
                assert live.ask("estop", timeout=20)["code"] == 0
                live.where(lambda s: s["fault"] == "e-stop", 20)
                assert live.ask("reset", timeout=20)["code"] == 0
                live.where(lambda s: s["fault"] == "none", 20)
            status, got = me.post("/api/check?name=a.ngc", panel.JOB)
            assert status == 200 and got["ok"], got


def test_a_watching_operator_is_not_sent_away(p):
    with p.session().live() as live:
        for what in ("browsers", "renewed", "sessions", "questions"):
            with crowd(p, what):
                n = live.told
                rig.until(lambda: live.take(20) and live.told > n + 20, 60, 0)
                assert live.ask("latency", timeout=20)["code"] == 0


def children(p):
    path = f"/proc/{p.process.pid}/task/{p.process.pid}/children"
    return pathlib.Path(path).read_text().split()


def test_a_check_whose_browser_leaves_is_ended(p):
    me = p.session()
    text = (b"G21 G90 F30\nM98 P2\nM30\n" + b"".join(
        b"O%d\n" % i + b"M98 P%d\n" % (i + 1) * 200 + b"M99\n"
        for i in range(2, 6)) + b"O6\nG91 G1 X.001\nG1 X-.001\nG90\nM99\n")
    rig.until(lambda: not children(p), 20)
    head = "".join(f"{k}: {v}\r\n" for k, v in me.headers().items())
    for _ in range(12):         # more than can run at a time
        with socket.create_connection(("127.0.0.1", p.port), 10) as s:
            s.sendall((f"POST /api/check?name=a.ngc HTTP/1.1\r\n"
                       f"Host: 127.0.0.1:{p.port}\r\n{head}"
                       f"Content-Length: {len(text)}\r\n\r\n").encode() + text)
            rig.until(lambda: children(p), 20, 0.01)
        rig.until(lambda: not children(p), 20, 0.01)
    assert me.post("/api/check?name=a.ngc", panel.JOB)[1]["ok"]


# -- What is no web socket -------------------------------------------------------

def unmasked(me, n, do, **more):
    text = json.dumps({"n": n, "token": me.token, "do": do, **more}).encode()
    return struct.pack("!BBH", 0x81, 126, len(text)) + text


def is_closed(s):
    s.settimeout(20)
    try:
        while s.recv(65536):
            pass
    except ConnectionError:
        pass
    return True


@pytest.mark.parametrize("before", [0, 1, 5])
def test_a_frame_that_is_not_masked_ends_the_connection(p, before):
    """RFC 6455, 5.1.  Nothing that came with it is done."""
    me = p.session()
    with me.raw_live() as s:
        for i in range(before):
            s.sendall(me.frame(i + 1, "queue"))
        s.sendall(unmasked(me, 100, "estop") + me.frame(101, "estop"))
        assert is_closed(s)
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")
        assert live.state["fault"] == "none"


def test_a_frame_before_the_answer_is_refused(p):
    me = p.session()
    head = (f"GET /api/live HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
            "Upgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: edm-panel"
            f"\r\nOrigin: {p.url}\r\nCookie: {me.cookie}\r\n\r\n").encode()
    for tail in (b"", b"\r\n\r\n"):
        got = p.raw(head + unmasked(me, 1, "estop", text="x" * 40) + tail)
        assert b" 101 " not in got
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")
        assert live.state["fault"] == "none"


@pytest.mark.parametrize("upgrade", ["h2c", "H2C", "h2c, websocket", "x"])
def test_another_protocol_is_refused(p, upgrade):
    got = p.raw((f"GET /api/session HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                 "Connection: Upgrade, HTTP2-Settings\r\n"
                 f"Upgrade: {upgrade}\r\n"
                 "HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n\r\n").encode()
                + b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes(9))
    assert b" 101 " not in got and b"edm_session" not in got, got
    assert p.listens()


def test_http_2_without_a_question_is_refused(p):
    settings = struct.pack("!HBBBI", 0, 4, 0, 0, 0)[0:9]
    got = p.raw(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + settings)
    assert b"edm_session" not in got and not got.startswith(b"\0"), got
    assert p.listens()
