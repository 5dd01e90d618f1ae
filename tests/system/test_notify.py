# SPDX-License-Identifier: Apache-2.0
"""edm-notify against a real broker and a web hook: who is called, and how
often."""

import contextlib
import http.server
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import threading

import pytest
import rig
from panel import free_port

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = "condition, servo_v\nC100, 20\n"
MACHINE = rig.NULL_MACHINE + "\n[tech]\ntable = shop.tech\n"
CHANGE = b"G21 G90 F600\nG0 Z2\nT3 M6\nG1 Z1\nG0 Z2\nM30\n"
SHORT = b"G21 G90\nG0 X1\nM30\n"


class Hook:
    """A web hook of this test: keeps what it is sent; may be out of order."""

    def __init__(self):
        self.got, self.broken = [], False
        self.does = None        # instead of an answer, for a message
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                if outer.does and outer.does(self, json.loads(body)):
                    return
                if not outer.broken:
                    outer.got.append(json.loads(body))
                self.send_response(503 if outer.broken else 204)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0),
                                                      Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/edm"
        threading.Thread(target=self.server.serve_forever,
                         daemon=True).start()

    def kinds(self):
        return [m.get("kind") for m in self.got]

    def until(self, kind, n=1, timeout=30):
        rig.until(lambda: self.kinds().count(kind) >= n, timeout)
        return [m for m in self.got if m.get("kind") == kind]


@pytest.fixture
def hook():
    h = Hook()
    yield h
    h.server.shutdown()
    h.server.server_close()


@pytest.fixture
def shop(tmp_path):
    with rig.Machine(tmp_path, MACHINE) as m:
        (tmp_path / "shop.tech").write_text(TABLE)
        m.start()
        m.client.status_where(lambda s: s.daemon == "ok")
        m.ctl("electrode", "add", "1"), m.ctl("electrode", "add", "3")
        m.ctl("electrode", "use", "1")
        yield m


def run(config, *words, without=()):
    """edm-notify; @without: modules that are not there."""
    hide = "".join(f"sys.modules[{n!r}] = None; " for n in without)
    return [sys.executable, "-c", f"import sys; {hide}"
            "from edm.notify import main; sys.exit(main())",
            "--config", str(config), *words]


ENV = {**os.environ, "PYTHONPATH": str(ROOT / "clients/python")}


@contextlib.contextmanager
def notify(m, to, more="", without=(), ends=signal.SIGTERM):
    config = m.folder / "notify.ini"
    state = m.folder / "state"
    state.mkdir(exist_ok=True)
    config.write_text(f"[notify]\nmachine = {m.name}\nstate = {state}\n"
                      f"page = http://press-1:7680/\n{more}\n{to}\n")
    with open(m.folder / "notify.log", "ab") as log:
        p = subprocess.Popen(run(config, without=without), stderr=log,
                             env=ENV | {"EDM_KEY": str(key_of(m))})
    try:
        rig.until(lambda: "calls" in said(m), 30)
        yield config
    finally:
        assert p.poll() is None, said(m)
        p.send_signal(ends)
        p.wait(20)


def key_of(m):
    return m.folder / "store" / f"{m.name}.key"


def said(m):
    return (m.folder / "notify.log").read_text()


def change(m):
    """It stands, and asks for electrode 3."""
    m.client.submit(CHANGE, "work")
    m.client.status_where(lambda s: s.stand == "electrode", 20)


def go_on(m):
    assert m.client.ask("done", arg=3).code == 0
    assert m.client.ask("start").code == 0
    m.client.job_where("work", "done", 30)


def test_a_stand_and_the_end_are_told_once_each(shop, hook):
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        change(shop)
        one, = hook.until("stands")
        assert "put electrode 3 in" in one["text"] and "line 3" in one["text"]
        assert one["machine"] == shop.name and one["job"] == "work"
        assert one["link"] == "http://press-1:7680/"
        go_on(shop)
        done, = hook.until("done")
        assert "job.ngc done" in done["text"]
        shop.client.ask("estop")
        fault, = hook.until("fault")
        assert "e-stop" in fault["text"]
        assert hook.kinds() == ["stands", "done", "fault"]


def test_it_is_told_again_until_somebody_has_seen_it(shop, hook):
    with notify(shop, f"[to.me]\nurl = {hook.url}",
                "repeat_min = 0.02") as config:
        change(shop)
        hook.until("stands", 3)
        r = subprocess.run(run(config, "--seen"), env=ENV, timeout=30)
        assert r.returncode == 0
        shop.client.hear(2)     # what was under way got there
        n = len(hook.got)
        shop.client.hear(4)
        assert len(hook.got) == n
        # Another cause is another thing to see.
        go_on(shop)
        shop.client.ask("estop")
        hook.until("fault", 2)


def test_a_restart_tells_nothing_twice(shop, hook):
    change(shop)
    for _ in range(2):
        with notify(shop, f"[to.me]\nurl = {hook.url}"):
            hook.until("stands")
            shop.client.hear(2)
    assert hook.kinds() == ["stands"]


def test_what_waits_when_it_is_killed_is_sent_by_the_next_one(shop, hook):
    """A job that is over is told once, and in no STATUS: it must not be lost.
    Neither is what waits for the end of quiet hours."""
    hook.broken = True
    to = f"[to.me/here]\nurl = {hook.url}"
    with notify(shop, to, "quiet = 00:00-24:00\nalways = fault stands",
                ends=signal.SIGKILL):
        change(shop)
        rig.until(lambda: "503" in said(shop), 30)
        go_on(shop)
        rig.until((shop.folder / "state" / "later.json").exists, 30)
    waits = shop.folder / "state" / "waits-me%2Fhere.json"
    assert len(json.loads(waits.read_text())) == 1
    hook.broken = False
    with notify(shop, to, "repeat_min = 0"):
        hook.until("stands")
        hook.until("done")
        shop.client.hear(1)
    assert hook.kinds() == ["stands", "done"]
    assert json.loads(waits.read_text()) == []


def test_no_more_wait_than_two_hundred(tmp_path):
    """Nor more than a text of 1000 characters each: the file is bounded."""
    code = ("import sys; from edm.notify import *\n"
            f"k = Kept(Path('{tmp_path}/w.json'))\n"
            "for i in range(205): k.put(Message(str(i), 'done', 'm', 'j', 't', "
            "'x' * TEXT_MAX, '', i), 'me')\n"
            f"print(*Kept(Path('{tmp_path}/w.json')).waits)")
    r = subprocess.run([sys.executable, "-c", code], env=ENV, timeout=60,
                       capture_output=True, text=True)
    assert r.stdout.split() == [str(i) for i in range(5, 205)], r.stderr
    assert r.stderr.count("given up") == 5
    assert (tmp_path / "w.json").stat().st_size < 200 * 1200


def test_quiet_hours_wait_but_for_what_is_always_told(shop, hook):
    with notify(shop, f"[to.me]\nurl = {hook.url}",
                "quiet = 00:00-24:00\nalways = fault"):
        change(shop)
        go_on(shop)
        shop.client.ask("estop")
        hook.until("fault")
        assert hook.kinds() == ["fault"]


@contextlib.contextmanager
def broker(folder, port):
    conf = folder / "mosquitto.conf"
    conf.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
    p = subprocess.Popen(["mosquitto", "-c", str(conf)],
                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield p
    finally:
        p.terminate()
        p.wait(20)


needs_broker = pytest.mark.skipif(
    not shutil.which("mosquitto"), reason="mosquitto is not there")


@needs_broker
def test_a_broker_that_was_gone_gets_it_when_it_is_back(shop, hook, tmp_path):
    mqtt = pytest.importorskip("paho.mqtt.client")
    port, got = free_port(), []
    to = (f"[to.shop]\nurl = mqtt://127.0.0.1:{port}/shop/edm\n"
          f"[to.me]\nurl = {hook.url}\nkinds = stands")
    with notify(shop, to):
        change(shop)
        hook.until("stands")    # the other one does not wait for the broker
        rig.until(lambda: "shop: not sent, goes on trying" in said(shop), 30)
        with broker(tmp_path, port):
            c = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
            c.on_message = lambda *a: got.append(json.loads(a[2].payload))
            c.on_connect = lambda *a: c.subscribe("shop/edm", 1)
            rig.until(lambda: try_connect(c, port), 20)
            c.loop_start()
            rig.until(lambda: got, 60)
            go_on(shop)
            rig.until(lambda: len(got) > 1, 60)
            c.loop_stop()
    assert [m["kind"] for m in got] == ["stands", "done"]
    assert hook.kinds() == ["stands"]
    assert said(shop).count("shop: not sent") == 1


def try_connect(c, port):
    try:
        return c.connect("127.0.0.1", port) == 0
    except OSError:
        return False


def test_a_hook_that_fails_gets_it_later(shop, hook):
    hook.broken = True
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        change(shop)
        rig.until(lambda: "503" in said(shop), 30)
        hook.broken = False
        hook.until("stands", timeout=60)
        rig.until(lambda: "is there again" in said(shop))


def test_a_redirect_is_no_answer(shop, hook):
    """Followed, the call would be a GET, and nobody would be called."""
    def elsewhere(h, _):
        h.send_response(302)
        h.send_header("Location", hook.url + "/new")
        h.end_headers()
        return True

    hook.does = elsewhere
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        change(shop)
        rig.until(lambda: f"redirects to {hook.url}/new" in said(shop), 30)
        hook.does = None
        hook.until("stands", timeout=60)


def test_one_that_is_refused_keeps_back_no_other(shop, hook):
    def refuses(h, m):
        if m["kind"] == "stands":
            h.send_error(400)
        return m["kind"] == "stands"

    hook.does = refuses
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        change(shop)
        rig.until(lambda: "400" in said(shop), 30)
        go_on(shop)
        hook.until("done", timeout=60)
        hook.does = None
        hook.until("stands", timeout=60)


def test_many_stands_one_behind_the_other_are_told_once_each(shop, hook):
    """Somebody goes on at once, and edm-notify is killed in the middle."""
    lines = b"".join(b"G0 Z%d\nM0\n" % (n % 2) for n in range(30))
    to = f"[to.me]\nurl = {hook.url}"
    with notify(shop, to, ends=signal.SIGKILL):
        shop.client.submit(b"G21 G90 F600\n" + lines + b"M30\n", "many")
        for n in range(15):
            shop.client.status_where(lambda s, n=n: s.stand == "stop" and
                                     s.line == 2 * n + 3, 20)
            assert shop.client.ask("start").code == 0
        hook.until("stands", 3)
    with notify(shop, to):
        for n in range(15, 30):
            shop.client.status_where(lambda s, n=n: s.stand == "stop" and
                                     s.line == 2 * n + 3, 20)
            assert shop.client.ask("start").code == 0
        hook.until("done", timeout=60)
    told = [m["text"] for m in hook.got]
    # What was just sent when it was killed may come again.
    assert len(told) - len(set(told)) <= 1, told


def test_a_way_without_end_is_given_up_and_tried_again(shop, hook, tmp_path):
    """A hook that answers a byte a second, a broker that takes the connection
    and says nothing, a command that waits for another one."""
    over = threading.Event()

    def drips(h, _):
        while not over.wait(1):
            h.wfile.write(b"H")
        return True

    hook.does = drips
    script, pid = tmp_path / "call", tmp_path / "pid"
    script.write_text(f"#!/bin/sh\nsleep 1000 & echo $! > {pid}; wait\n")
    script.chmod(0o755)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        to = (f"[to.hook]\nurl = {hook.url}\n"
              f"[to.broker]\nurl = mqtt://127.0.0.1:"
              f"{mute.getsockname()[1]}/edm\n"
              f"[to.command]\nurl = command:{script}")
        with notify(shop, to):
            change(shop)
            for name in ("hook", "broker", "command"):
                rig.until(lambda n=name: f"{n}: not sent, goes on trying: no "
                          "end of it" in said(shop), 60)
            other = int(pid.read_text())
            hook.does = None
            over.set()
            hook.until("stands", timeout=60)
    rig.until(lambda: not pathlib.Path(f"/proc/{other}").exists(), 30)


@pytest.mark.parametrize("left", ["[{}]", "[]", "{", "[1]", '{"a": []}', ""])
def test_what_is_left_in_a_file_ends_nothing(shop, hook, left):
    state = shop.folder / "state"
    state.mkdir()
    for name in ("told", "later", "waits-me"):
        (state / f"{name}.json").write_text(left)
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        shop.client.ask("estop")
        hook.until("fault")


def test_a_command_works_without_apprise_and_paho(shop, tmp_path):
    out = tmp_path / "called"
    script = tmp_path / "call"
    script.write_text('#!/bin/sh\necho "$EDM_KIND $EDM_TEXT" >> '
                      f'{out}\ncat >> {out}.json\n')
    script.chmod(0o755)
    with notify(shop, f"[to.me]\nurl = command:{script}",
                without=("apprise", "paho.mqtt.publish")) as config:
        change(shop)
        rig.until(lambda: out.exists() and "stands" in out.read_text(), 30)
        for url, says in (("mqtt://x/y", "pip install paho-mqtt"),
                          ("mailto://x:y@z", "pip install apprise")):
            other = tmp_path / "other.ini"
            other.write_text(config.read_text() + f"[to.b]\nurl = {url}\n")
            r = subprocess.run(run(other, without=(
                "apprise", "paho.mqtt.publish")), env=ENV, timeout=60,
                capture_output=True, text=True)
            assert r.returncode == 78 and says in r.stderr, r.stderr
    json.loads(pathlib.Path(f"{out}.json").read_text())


def test_of_two_with_one_folder_the_second_is_refused(shop, hook):
    with notify(shop, f"[to.me]\nurl = {hook.url}") as config:
        r = subprocess.run(run(config), env=ENV, timeout=60,
                           capture_output=True, text=True)
        assert r.returncode == 78
        assert "another edm-notify uses it; [notify] state = " in r.stderr


def test_a_file_that_is_wrong_sends_nothing_of_what_waits(shop, tmp_path):
    out = tmp_path / "called"
    config, state = tmp_path / "notify.ini", tmp_path / "waiting"
    state.mkdir()
    (state / "waits-me.json").write_text(json.dumps([dict(
        cause="c", kind="stands", machine=shop.name, job="j", title="t",
        text="x", link="", utime=1)]))
    config.write_text(f"[notify]\nmachine = {shop.name}\nstate = {state}\n"
                      f"[to.me]\nurl = command:touch {out}\n"
                      "[to.b]\nurl = mqtt://x\n")
    env = ENV | {"EDM_KEY": str(key_of(shop))}
    for _ in range(5):
        r = subprocess.run(run(config), env=env, timeout=60,
                           capture_output=True, text=True)
        assert r.returncode == 78 and "a topic" in r.stderr
    assert not out.exists()
    config.write_text(config.read_text().replace("mqtt://x", "command:true"))
    p = subprocess.Popen(run(config), env=env, stderr=subprocess.DEVNULL)
    rig.until(out.exists, 30)
    p.terminate()
    p.wait(20)


def test_apprise_sends_it(shop, hook):
    pytest.importorskip("apprise")
    url = hook.url.replace("http://", "json://")
    with notify(shop, f"[to.me]\nurl = {url}") as config:
        r = subprocess.run(run(config, "--try"), env=ENV, timeout=60,
                           capture_output=True, text=True)
        assert r.returncode == 0 and "me: sent" in r.stdout, r.stderr
        change(shop)
        rig.until(lambda: len(hook.got) > 1, 30)
    test, stand = hook.got
    assert "calls you" in test["message"]
    assert "put electrode 3 in" in stand["message"]


def test_who_does_not_answer_is_told(shop, hook):
    with notify(shop, f"[to.me]\nurl = {hook.url}"):
        shop.kill("edmd")
        lost = hook.until("lost")
        assert "edmd is" in lost[0]["text"]
        # What it asked for before is not told again when it is back.
        shop.start_edmd()
        shop.client.status_where(lambda s: s.daemon == "ok", 20)


@pytest.mark.parametrize("text, says", [
    ("", "nobody to call"), ("[to.a]\n", "url"),
    ("[to.a]\nurl = http://x/\nkinds = alarm", "some of fault"),
    ("[to.a]\nurl = command:", "without a program"),
    ("[to.a]\nurl = mqtt://x/shop/#", "a topic"),
    ("quiet = 22-6-7\n[to.a]\nurl = http://x/", "two times of the day"),
    ("quiet = 25:00-6\n[to.a]\nurl = http://x/", "two times of the day"),
    ("repeat_min = often\n[to.a]\nurl = http://x/", "often"),
    ("[to.a", "README.md"),
    ("repeat_mins = 5\n[to.a]\nurl = http://x/", "repeat_mins: no such key"),
    ("[to.a]\nurl = http://x/\nkind = fault", "kind: no such key"),
    ("[To.a]\nurl = http://x/", "[To.a]: no such section"),
    ("[to]\nurl = http://x/", "[to]: no such section"),
    ("[to.a]\nurl = http://x/\nkinds =", "some of fault"),
    ("repeat_min = nan\n[to.a]\nurl = http://x/", "repeat_min = nan"),
    ("repeat_min = -1\n[to.a]\nurl = http://x/", "repeat_min = -1"),
    ("quiet = 22:75-6\n[to.a]\nurl = http://x/", "two times of the day"),
    ("[to.a]\nurl = http:///path", "without a host"),
    ("[to.a]\nurl = http://[::1/", "http: "),
    ("[to.a]\nurl = mqtt://x:99999/edm", "mqtt: "),
    ("[to.a]\nurl = command:/no/such/program", "that can be run"),
    ('[to.a]\nurl = command:"sh', "command: "),
])
def test_a_file_that_is_wrong_is_refused(tmp_path, text, says):
    config = tmp_path / "notify.ini"
    config.write_text(f"[notify]\nstate = {tmp_path}\n{text}\n")
    r = subprocess.run(run(config), env=ENV, timeout=60, capture_output=True,
                       text=True)
    assert r.returncode == 78 and says in r.stderr, r.stderr
