# SPDX-License-Identifier: Apache-2.0
"""The panel's gateway: what it tells, what it refuses, what it survives.

docs/panel.md has a table of the OWASP ASVS requirements that these tests show.
"""

import concurrent.futures
import json
import os
import pathlib
import socket
import subprocess
import time

import numpy as np
import panel
import pytest
import rig
from websockets.exceptions import ConnectionClosed, InvalidStatus


@pytest.fixture
def me(p):
    return p.session()


# -- What it tells

def test_a_browser_is_told_the_state_ten_times_a_second(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok" and s["jobs"])
        assert live.hello["machine"] == p.machine.name
        assert [a["name"] for a in live.hello["axes"]] == list("XYZCUV")
        begun, n = time.monotonic(), live.told
        while live.told < n + 20:
            live.take()
        # Not faster than it says; a busy machine may be slower.
        assert time.monotonic() - begun > 1.5


def test_who_comes_late_has_a_past(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")
        rows = rig.until(lambda: live.ask("history", seconds=60,
                                          points=600)["body"])
        assert all(len(r) == 9 for r in rows)
        assert all(r[1] <= r[2] + 1e-3 and r[2] <= r[3] + 1e-3 for r in rows)
        assert live.ask("history", seconds=1e9, points=5)["code"] == 65


def test_a_text_with_an_error_is_refused_at_its_place(p, me):
    status, got = me.post("/api/check?name=a.ngc", b"G21\nG1 X5 Q77\n")
    assert status == 200 and not got["ok"]
    assert (got["line"], got["column"]) == (2, 7)
    assert "Q77" in got["found"] and got["wanted"]


def test_a_text_that_is_understood_has_a_path_to_draw(p, me):
    status, got = me.post("/api/check?name=a.ngc", panel.JOB)
    assert status == 200 and got["ok"], got
    status, _, path = p.ask("GET", f"/api/path?check={got['check']}",
                            headers=me.headers())
    head = path[:path.index(b"\n") + 1]
    told = json.loads(head)
    assert status == 200 and len(head) % 8 == 0
    assert len(path) == len(head) + told["points"] * (8 + 12 + 4 + 1)
    assert told["max"][2] - told["min"][2] == pytest.approx(2.4)


@pytest.mark.parametrize("guides", ["relative", "absolute"])
def test_the_upper_guide_is_drawn_where_it_is(tmp_path, guides):
    """Faces of 2 degrees and guides 100 mm apart, whichever way U V count."""
    ini = tmp_path / "m.ini"
    ini.write_text(pathlib.Path("examples/wire.ini").read_text().replace(
        "guides = relative ", f"guides = {guides} "))
    job = tmp_path / "a.ngc"
    job.write_text("""G90 F5 H1=0.15
G0 X105 Y-5
G41 H1 G51 A2
G1 X105 Y0
X100
Y10
X110
Y0
X105
G40 G50 Y-5
M2
""")
    with job.open() as text:
        out = subprocess.run([rig.BUILD / "edm-panel", "--work", "check",
                              "--config", ini, "--file-name", "a.ngc"],
                             stdin=text, capture_output=True,
                             timeout=60).stdout
    end = out.index(b"\n") + 1
    told = json.loads(out[:end])
    n = told["points"]
    low = np.frombuffer(out, np.float32, 3 * n, end + 8 * n).reshape(n, 3)
    up = np.frombuffer(out, np.float32, 2 * n, end + 24 * n).reshape(n, 2)
    off = np.abs(up - low[:, :2] - np.array(told["origin"][:2]))
    assert told["upper"]
    assert off.max() == pytest.approx(100 * np.tan(np.radians(2)), abs=0.01)


def test_a_check_reads_a_pipe_as_it_reads_a_file(tmp_path):
    ini = tmp_path / "m.ini"
    ini.write_text("[machine]\nname = m\n")
    check = [rig.BUILD / "edm-panel", "--work", "check", "--config", ini,
             "--file-name", "a.ngc"]
    job = tmp_path / "a.ngc"
    job.write_text("G90 F5 G1 X0\n" + "".join(
        f"G1 X{i % 7}. Y{i % 5}.\n" for i in range(9000)) + "M2\n")
    piped = subprocess.run(check, input=job.read_bytes(),
                           capture_output=True, timeout=60)
    with job.open() as text:
        read = subprocess.run(check, stdin=text, capture_output=True,
                              timeout=60)
    assert json.loads(read.stdout[:read.stdout.index(b"\n") + 1])["ok"]
    assert (piped.stdout, piped.returncode) == (read.stdout, read.returncode)


RECORDS = (b"B1000 B0 B1000 GX L1\nB1000 B0 B4000 GY NR1\nB1000 B0 B1000 GX L3\n"
           b"DD\n")


def test_what_is_set_for_a_job_is_checked_and_sent_with_it(p, me):
    plain, large = (me.post(f"/api/check?name=a.3b&set={s}", RECORDS)[1]
                    for s in ("", "scale%3D2%20turn%3D30"))
    assert plain["ok"] and large["ok"]
    assert large["length"] == pytest.approx(2 * plain["length"], rel=1e-3)
    bad = me.post("/api/check?name=a.3b&set=taper%3D81", RECORDS)[1]
    assert not bad["ok"] and bad["found"] == "taper=81", bad
    assert bad["wanted"] == "a number from -80 to 80 degrees"
    assert me.post(f"/api/check?name=a.3b&set={'x' * 192}", RECORDS)[0] == 400
    with me.live() as live:
        live.where(lambda s: s.get("jobs"))
        got = me.post("/api/jobs?name=a.3b&hold=1&set=scale%3D2", RECORDS)[1]
        assert got["code"] == 0, got
        assert live.ask("show", job=got["job"])["body"]["setting"] == "scale=2"
        live.where(lambda s: s["job"] == got["job"] and s["loaded"])
        assert live.ask("remove", job=got["job"])["code"] == 0
        live.where(lambda s: not s["job"])
        got = me.post("/api/jobs?name=a.3b&hold=1&set=scale%3D0", RECORDS)[1]
        assert got["code"] == 65 and "scale=0; a number from" in got["reason"]


def test_a_job_runs_from_upload_to_end(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("jobs"))
        # So long a cut that it cannot end before this test has asked all.
        text = panel.JOB.replace(b"Z-2.4", b"Z-40")
        status, got = me.post("/api/jobs?name=part.ngc&hold=1", text)
        assert status == 200 and got["code"] == 0, got
        live.where(lambda s: s["job"] == got["job"] and s["loaded"])
        assert live.state["jobName"] == "part.ngc"
        assert live.state["state"] == "hold"
        assert live.ask("start")["code"] == 0
        live.where(lambda s: s["state"] == "erode", 60)
        assert live.state["condition"] == "C120"
        assert live.state["values"]["peak_a"] == 30

        assert live.ask("set", text="servo_v", arg=22)["code"] == 0
        live.where(lambda s: s["values"]["servo_v"] == 22)
        assert live.state["set"] == ["servo_v"]
        refused = live.ask("set", text="servo_v", arg=2)
        assert refused["code"] == 65 and "servo_v" in refused["reason"]
        assert live.ask("set", text="servo_v", arg=None)["code"] == 0
        live.where(lambda s: s["values"]["servo_v"] == 15)

        status, _, path = p.ask(
            "GET", f"/api/path?program={live.state['program']}",
            headers=me.headers())
        assert status == 200 and b'"part.ngc"' in path[:400]

        assert live.ask("estop")["code"] == 0
        live.where(lambda s: s["fault"] == "e-stop")
        assert live.ask("reset")["code"] == 0
        live.where(lambda s: s["state"] == "hold")
        assert live.ask("stop")["code"] == 0
        live.where(lambda s: s["state"] == "idle" and not s["loaded"])
        status, _, body = p.ask("GET", "/api/path?program=99",
                                headers=me.headers())
        assert status == 404 and b"not there any more" in body, body
        past = live.ask("past", arg=5)["body"]
        assert past[0]["name"] == "part.ngc"
    assert f"operator, 127.0.0.1): start" in p.log()


def test_a_daemon_that_dies_is_told_and_found_again(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")
        p.machine.kill("edmd")
        live.where(lambda s: s["daemon"] != "ok", 20)
        assert live.ask("hold")["code"] != 0
        p.machine.start_edmd()
        live.where(lambda s: s["daemon"] == "ok", 20)
        p.machine.kill("jobs")
        live.where(lambda s: not s["jobs"], 20)
        p.machine.start_jobs()
        live.where(lambda s: s["jobs"], 20)
        rig.until(lambda: live.ask("queue")["code"] == 0, 20)


def test_a_queue_longer_than_an_answer_is_told_page_by_page(tmp_path):
    p = panel.Panel(tmp_path)
    p.start()
    try:
        c = p.machine.client
        for job in ("a", "b"):
            assert c.submit(rig.QUICK_JOB, job, hold=True).code == 0
        c.status_where(lambda s: s.job == "a" and s.job_state == "ready")
        rig.fill_queue(p.machine, "b", 420)
        wanted = ["a", "b"] + [f"job-{i:03}" for i in range(420)]
        with p.session().live() as live:
            rig.until(lambda: live.ask("queue")["code"] == 0, 20)
            got, pages, page = [], 0, live.ask("queue")["body"]
            while page:
                got += [j["job"] for j in page]
                pages += 1
                page = live.ask("queue", job=got[-1])["body"]
        assert got == wanted and pages > 1
    finally:
        with rig.store_of(p.machine) as db:
            db.execute("DELETE FROM job WHERE id LIKE 'job-%'")
        p.close()


def test_pages_and_programs_of_the_host_are_told(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("jobs"))
        tech = live.ask("tech")["body"]
        assert [r["name"] for r in tech["table"]["rows"]][:2] == [
            "C100", "C110"]
        doctor = live.ask("doctor", timeout=30)["body"]
        assert {"kernel", "edmd"} <= {f["what"] for f in doctor}
        assert sum(live.ask("latency")["body"]) > 0
        assert isinstance(live.ask("notes")["body"], list)


def test_a_press_that_is_old_or_begins_nothing_moves_nothing(p, me):
    with me.live() as live:
        live.where(lambda s: s.get("state") == "idle" and s["jobs"])
        at = live.state["pos"][1]
        # A heap that was held up: no sign names an answer of this moment.
        codes = [live.ask("press", text="Y", arg=5, press=1, heard=0)["code"]
                 for _ in range(5)]
        n = live.n
        time.sleep(0.4)
        late = live.ask("press", text="Y", arg=5, press=1, heard=n)
        assert codes == [0] * 5 and late["code"] == 69, late
        assert "press again" in late["reason"]
        assert live.ask("press", text="Y", arg=5, press=1,
                        heard=live.n)["code"] == 69
        assert live.ask("press", text="Y", arg=5, heard=0)["code"] == 65
        live.where(lambda s: s["state"] == "idle")
        assert live.state["pos"][1] == at


# -- What it refuses

def test_a_stranger_gets_nothing_but_the_page(p):
    assert p.ask("GET", "/")[0] == 200
    assert p.ask("GET", "/api/path?program=1")[0] == 401
    for path in ("/api/check", "/api/jobs", "/api/logout"):
        assert p.ask("POST", path, b"x", {"Origin": p.url})[0] == 401
    nobody = panel.Session(p, "edm_session=" + "0" * 64, {"token": "0" * 32})
    with pytest.raises((InvalidStatus, ConnectionClosed, EOFError, OSError)):
        nobody.live()


def test_an_act_without_the_sessions_token_is_refused(p, me):
    assert me.post("/api/check", b"G1", **{"X-Edm-Token": ""})[0] == 403
    assert me.post("/api/check", b"G1", **{"X-Edm-Token": "0" * 32})[0] == 403
    with me.live() as live:
        live.take()
        live.ws.send(json.dumps({"n": 1, "token": "0" * 32, "do": "estop"}))
        with pytest.raises(ConnectionClosed):
            while True:
                live.take()
    assert "without the token" in p.log()


def test_another_sites_page_is_refused(p, me):
    assert me.post("/api/check", b"G1", Origin="http://evil.example")[0] == 403
    assert me.post("/api/check", b"G1", Origin="")[0] == 403
    assert me.post("/api/check", b"G1", Origin="null")[0] == 403
    for origin in ("http://evil.example", f"http://127.0.0.1:{p.port + 1}",
                   "null"):
        with pytest.raises((InvalidStatus, ConnectionClosed, EOFError,
                            OSError)):
            me.live(origin=origin)


def test_a_name_that_was_bent_to_this_address_is_refused(p, me):
    for path in ("/", "/api/session"):
        got = p.raw(f"GET {path} HTTP/1.1\r\nHost: evil.example:{p.port}\r\n"
                    f"Connection: close\r\n\r\n".encode())
        assert b" 403 " in got.split(b"\r\n")[0], got[:80]


def test_a_request_is_taken_once(p, me):
    with me.live() as live:
        assert live.ask("queue")["code"] == 0
        live.n -= 1
        again = live.ask("estop")
        assert again["code"] == 76 and "before" in again["reason"]
        live.where(lambda s: s.get("daemon") == "ok")
        assert live.state["fault"] == "none"


def test_a_session_that_was_ended_is_over(p, me):
    with me.live() as live:
        live.take()
        assert me.post("/api/logout")[0] == 200
        # Nor is it told anything more.
        with pytest.raises(ConnectionClosed):
            while True:
                live.take()
    assert me.post("/api/check", b"G1")[0] == 401


@pytest.mark.parametrize("path", [
    "/../machine.ini", "/..%2f..%2fetc/passwd", "/assets/../../store",
    "//etc/passwd", "/assets/%00", "/index.html/x", "/.git/config", "/api",
    "/assets/", "/%2e%2e/%2e%2e/etc/passwd"])
def test_no_path_leads_out_of_the_page(p, path):
    got = p.raw(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                f"Connection: close\r\n\r\n".encode())
    assert b" 200 " not in got.split(b"\r\n")[0], got[:80]
    assert b"root:" not in got and b"[machine]" not in got


@pytest.mark.parametrize("path", ["/api/jobs", "/api/session", "/"])
@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE",
                                    "PATCH", "CONNECT", "HEAD"])
def test_other_methods_do_nothing(p, me, method, path):
    got = p.raw(f"{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                f"Cookie: {me.cookie}\r\nConnection: close\r\n\r\n".encode(),
                timeout=2 if method == "CONNECT" else 15)
    assert b" 200 " not in got.split(b"\r\n")[0]
    assert p.listens()


def test_a_text_that_is_too_long_is_refused_before_it_is_read(p, me):
    got = p.raw(f"POST /api/jobs HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                f"Cookie: {me.cookie}\r\nOrigin: {p.url}\r\n"
                f"X-Edm-Token: {me.token}\r\n"
                f"Content-Length: {80 << 20}\r\n\r\n".encode() + b"x" * 9999)
    assert b" 413 " in got.split(b"\r\n")[0]


def test_a_body_in_chunks_is_refused(p, me):
    head = "".join(f"{k}: {v}\r\n" for k, v in me.headers().items())
    got = p.raw(f"POST /api/check HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                f"{head}Transfer-Encoding: chunked\r\n\r\n"
                "5\r\nG21\r\n\r\n0\r\n\r\n".encode(), timeout=3)
    assert b" 411 " in got.split(b"\r\n")[0], got[:200]


@pytest.mark.parametrize("length", [
    "", "Content-Length: -1\r\n", "Content-Length: 0x9\r\n",
    f"Content-Length: {'9' * 40}\r\n", f"Content-Length: {'0' * 40}9\r\n",
    "Content-Length: 9, 9\r\n"])
def test_a_body_of_unknown_length_is_refused(p, me, length):
    head = "".join(f"{k}: {v}\r\n" for k, v in me.headers().items())
    got = p.raw(f"POST /api/check HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n"
                f"{head}{length}\r\nG1 X1 F5\n".encode())
    # Without an answer: what follows a length of 0 is no request, and a
    # connection that is closed upon unread bytes may lose what was said.
    assert not got or got.split(b" ")[1] in (b"411", b"413"), got[:200]
    assert got.count(b"HTTP/1.1") <= 1


@pytest.mark.parametrize("path, body, behind", [
    ("/api/check", panel.JOB, b"\n"), ("/api/login", b"{}", b"y" * 5000),
    ("/api/nothing", b"x", b"y")])
def test_bytes_behind_a_body_end_the_connection_alone(p, me, path, body,
                                                      behind):
    head = "".join(f"{k}: {v}\r\n" for k, v in me.headers().items())
    p.raw(f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\n{head}"
          f"Content-Length: {len(body)}\r\n\r\n".encode() + body + behind)
    assert me.post("/api/check", panel.JOB)[1]["ok"]


@pytest.mark.parametrize("name", [
    "", "%ff.ngc", "%ED%A0%80", "%E2%80%AEcgn.a", "%C2%9b31m", "x" * 64,
    "x" * 900])
def test_a_name_that_does_not_fit_is_refused(p, me, name):
    status, got = me.post(f"/api/check?name={name}", b"M30\n")
    assert status == 400 and "63 bytes" in got["wanted"]


def test_a_connection_that_stays_holds_no_upload(p, me):
    kept = []
    for _ in range(8):
        c = p.connection()
        c.request("POST", "/api/check?name=a.ngc", body=panel.JOB,
                  headers=me.headers())
        r = c.getresponse()
        assert r.status == 200, r.read()
        r.read()
        kept.append(c)
    for c in kept:
        c.close()


def test_frames_that_make_no_sense_end_the_connection_alone(p, me):
    with me.live() as other:
        for bad in ("", "{", "[]", "{}", '{"n":"1","do":2}', "x" * 70000,
                    '{"n":1,"do":"estop"}', b"\x00\xff\xfe", "[" * 30000,
                    '{"n":1e999,"do":"x"}', '{"n":1,"n":2,"do":"x"}'):
            with me.live() as live:
                live.take()
                live.ws.send(bad)
                with pytest.raises(ConnectionClosed):
                    for _ in range(300):
                        live.take()
        other.where(lambda s: s.get("daemon") == "ok")
        assert other.state["fault"] == "none"


def test_a_frame_behind_a_close_does_nothing(p, me):
    """Sent together: the page has said that it is gone."""
    with me.live() as other:
        for close in (b"\x88\x80", b"\x88\x82"):
            with me.raw_live() as s:
                text = b"" if close[1] == 0x80 else b"\x03\xe8"
                s.sendall(close + bytes(4) + text + me.frame(1, "estop"))
                s.settimeout(20)
                try:
                    while s.recv(65536):
                        pass
                except ConnectionError:
                    pass
        assert other.ask("queue")["code"] == 0  # behind whatever was asked
        n = other.told
        other.where(lambda s: other.told > n + 2)
        assert other.state["fault"] == "none"


def test_random_bytes_on_a_web_socket_end_it_alone(p, me):
    for _ in range(20):
        with me.raw_live() as s:
            try:
                s.sendall(os.urandom(2000))
            except OSError:
                pass
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")


def test_no_such_request_and_no_such_value_are_refused_in_words(p, me):
    with me.live() as live:
        assert live.ask("destroy")["code"] == 64
        assert live.ask("jog", text="Q", arg=1)["code"] != 0
        assert live.ask("retract", arg=-5)["code"] != 0
        assert live.ask("start", job="' OR 1=1 --")["code"] != 0
        assert live.ask("override", arg=99)["code"] == 65


def test_what_is_not_understood_does_not_pass_for_nothing(p, me):
    """Home without an axis homes all; an override of nothing stands still."""
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok" and s["jobs"])
        for what in ({"do": "home", "text": "X" * 64},
                     {"do": "home", "text": None},
                     {"do": "start", "job": 5}, {"do": "start", "job": "x" * 99},
                     {"do": "override"}, {"do": "override", "arg": "1"},
                     {"do": "jog", "text": "X", "arg": True}):
            a = live.ask(**what)
            assert a["code"] == 65 and "words" in a["reason"], what
        assert live.state["override"] == 1


def test_what_a_program_says_is_told_to_all_who_ask(p, me):
    with me.live() as live, me.live() as gone:
        gone.send("doctor")
        asked = [live.send("doctor") for _ in range(20)]
        gone.ws.close()
        rig.until(lambda: live.take(20) and
                  all(n in live.answers for n in asked), 20, 0)
        assert {live.answers[n]["code"] for n in asked} == {0}


def test_a_browser_that_asks_too_much_is_slowed_down(p, me):
    with me.live() as live:
        for _ in range(400):
            live.send("latency")
        codes = []
        while len(codes) < 400:
            m = live.take()
            if "n" in m:
                codes.append(m["code"])
        assert codes.count(75) > 100
        assert codes[0] == 0


def test_a_crowd_that_asks_for_the_past_keeps_nobody_out(p, me):
    crowd = [me.raw_live() for _ in range(20)]
    for s in crowd:
        for k in range(60):
            s.sendall(me.frame(k + 1, "history", seconds=3600, points=2000))
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok", 20)
        assert live.ask("queue", timeout=20)["code"] == 0
    for s in crowd:
        s.close()


def test_a_browser_that_does_not_read_costs_little(p, me):
    begun = resident_kb(p)
    with me.raw_live() as stuck:
        for i in range(110):
            try:
                stuck.sendall(me.frame(i + 1, "history", seconds=3600,
                                       points=2000))
            except OSError:
                break
        with me.live() as live:
            live.where(lambda s: s.get("daemon") == "ok")
            n = live.told
            while live.told < n + 30:
                live.take()
        assert resident_kb(p) - begun < 20000


def resident_kb(p):
    with open(f"/proc/{p.process.pid}/status") as f:
        return int(next(line.split()[1] for line in f
                        if line.startswith("VmRSS")))


def test_slow_and_many_connections_do_not_keep_others_out(p, me):
    slow = []
    for i in range(60):
        s = socket.create_connection(("127.0.0.1", p.port), 10)
        s.sendall(b"GET / HTTP/1.1\r\nHost: x")
        slow.append(s)
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok", 40)
    assert p.ask("GET", "/")[0] == 200
    # Who never ends a request is ended.
    for s in slow:
        s.settimeout(60)
        try:
            assert s.recv(4096) == b"" or True
        except ConnectionError:
            pass
        s.close()


def test_a_flood_of_connections_is_bounded(p, me):
    held = []
    for _ in range(600):
        try:
            held.append(socket.create_connection(("127.0.0.1", p.port), 2))
        except OSError:
            break
    fds = len(os.listdir(f"/proc/{p.process.pid}/fd"))
    for s in held:
        s.close()
    assert fds < 500
    rig.until(lambda: p.ask("GET", "/api/session")[0] == 200, 20, 0.2)


def test_the_page_may_run_nothing_that_is_not_its_own(p):
    _, headers, body = p.ask("GET", "/")
    csp = headers["Content-Security-Policy"]
    assert "default-src 'none'" in csp and "script-src 'self'" in csp
    assert "unsafe" not in csp and "frame-ancestors 'none'" in csp
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"
    _, headers, _ = p.ask("GET", "/api/session")
    cookie = headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    assert headers["Cache-Control"] == "no-store"


def test_a_program_that_explodes_is_ended_in_its_own_process(p, me):
    # A subprogram that calls another, a hundred times each, five deep.
    subs = "".join(f"O{i}\n" + f"M98 P{i + 1}\n" * 100 + "M99\n"
                   for i in range(2, 7)) + "O7\nG91 G1 X0.001\nG90\nM99\n"
    text = "G21 G90 F30\nM98 P2\nM30\n" + subs
    status, got = me.post("/api/check?name=bomb.ngc", text.encode())
    assert status == 200 and not got["ok"]
    with me.live() as live:
        live.where(lambda s: s.get("daemon") == "ok")
    assert resident_kb(p) < 100000


@pytest.mark.needs("another user")
def test_another_user_of_the_host_only_looks_on(p):
    code = ("import http.client,json,sys; c=http.client.HTTPConnection("
            f"'127.0.0.1',{p.port}); c.request('GET','/api/session'); "
            "print(json.load(c.getresponse())['role'])")
    done = subprocess.run(["/usr/bin/python3", "-c", code], user=65534,
                          group=65534, extra_groups=[], capture_output=True,
                          text=True, timeout=30)
    assert done.stdout.strip() == "viewer", done.stderr


@pytest.mark.needs("another user")
def test_a_cookie_serves_its_own_user_alone(p, me):
    """A browser sends it to every port of the host."""
    code = ("import http.client,json,sys; c=http.client.HTTPConnection("
            f"'127.0.0.1',{p.port}); c.request('GET','/api/session',"
            f"headers={{'Cookie': {me.cookie!r}}}); "
            "print(json.load(c.getresponse()))")
    done = subprocess.run(["/usr/bin/python3", "-c", code], user=65534,
                          group=65534, extra_groups=[], capture_output=True,
                          text=True, timeout=30)
    assert "'viewer'" in done.stdout, done.stderr
    assert me.token not in done.stdout


NOBODY = """
import os, socket, sys
port, own = int(sys.argv[1]), int(sys.argv[2])
os.setgroups([]), os.setgid(65534), os.setuid(65534)
s = socket.socket()
s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
s.bind(("127.0.0.1", own))
s.connect(("127.0.0.1", port))
s.sendall(b"GET /api/session HTTP/1.1\\r\\nHost: 127.0.0.1:%d\\r\\n"
          b"Connection: close\\r\\n\\r\\n" % port)
while got := s.recv(4096):
    sys.stdout.buffer.write(got)
"""


@pytest.mark.needs("another user")
def test_another_user_on_the_port_of_an_operator_only_looks_on(p):
    """Root has connections to elsewhere from that very port."""
    for _ in range(3):
        held, own = [], panel.free_port()
        for _ in range(12):
            there, here = socket.create_server(("127.0.0.1", 0)), \
                socket.socket()
            here.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            here.bind(("127.0.0.1", own))
            here.connect(there.getsockname())
            held += [there, here]
        done = subprocess.run(
            ["/usr/bin/python3", "-c", NOBODY, str(p.port), str(own)],
            capture_output=True, text=True, timeout=30)
        assert '"role":"viewer"' in done.stdout, done.stdout + done.stderr
        for s in held:
            s.close()


def test_many_at_once_are_told(p, me):
    def one(_):
        with p.session().live() as live:
            live.where(lambda s: s.get("daemon") == "ok", 40)
            n = live.told
            while live.told < n + 5:
                live.take(20)
            return True

    with concurrent.futures.ThreadPoolExecutor(50) as pool:
        assert all(pool.map(one, range(50)))
    assert resident_kb(p) < 100000
