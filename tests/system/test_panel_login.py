# SPDX-License-Identifier: Apache-2.0
"""The panel beyond its host: TLS, users, roles, sessions.

docs/panel.md has a table of the OWASP ASVS requirements that these tests show.
"""

import json
import os
import socket
import ssl
import subprocess

import panel
import pytest
import rig


def certificate(folder):
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
         "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-subj",
         "/CN=test", "-keyout", folder / "key.pem", "-out",
         folder / "cert.pem"], check=True, capture_output=True)


@pytest.fixture(scope="module")
def far(tmp_path_factory):
    """A panel on all addresses: TLS, and users who log in."""
    folder = tmp_path_factory.mktemp("far")
    certificate(folder)
    more = (f"address = 0.0.0.0\nnames = 127.0.0.1\n"
            f"certificate = {folder}/cert.pem\nkey = {folder}/key.pem\n"
            f"users = {folder}/users\n")
    p = panel.Panel(folder, more=more)
    p.start()
    add_user(p, "anna", "operator")
    add_user(p, "ben", "viewer")
    yield p
    p.close()


def login(p, user, password):
    status, headers, body = p.ask(
        "POST", "/api/login", json.dumps({"user": user,
                                          "password": password}),
        {"Origin": p.url})
    who = json.loads(body)
    if status != 200:
        return status, who
    return status, panel.Session(p, headers["Set-Cookie"].split(";")[0], who)


def test_beyond_the_host_it_wants_a_certificate(tmp_path):
    p = panel.Panel(tmp_path, more="address = 0.0.0.0\n")
    done = subprocess.run([str(rig.BUILD / "edm-panel"), "--config",
                           str(p.machine.config)], capture_output=True,
                          text=True, timeout=30)
    assert done.returncode == 78
    assert "certificate" in done.stderr


def test_beyond_the_host_nobody_acts_without_a_login(far):
    status, headers, body = far.ask("GET", "/api/session")
    assert json.loads(body)["role"] == "none" and "Set-Cookie" not in headers
    assert far.ask("POST", "/api/check", b"G1", {"Origin": far.url})[0] == 401


def test_passwords_are_kept_as_argon2id(far):
    text = (far.folder / "users").read_text()
    assert "long word" not in text and text.count("$argon2id$") >= 2
    assert os.stat(far.folder / "users").st_mode & 0o77 == 0


def test_a_short_password_is_refused(far):
    done = subprocess.run(
        [str(rig.BUILD / "edm-panel"), "--config", str(far.machine.config),
         "--add-user", "eve", "viewer"], input="short\n", text=True,
        capture_output=True)
    assert done.returncode == 65 and "12" in done.stderr


def test_a_viewer_looks_on(far):
    status, ben = login(far, "ben", "ben has a long word")
    assert status == 200 and ben.who["role"] == "viewer"
    assert ben.post("/api/jobs?name=a.ngc", panel.JOB)[0] == 403
    context = ssl.create_default_context()
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    # This client reads in one thread and writes in another.  With TLS 1.3 a
    # ticket arrives while the request is written, and Python's ssl, which has
    # no lock before 3.13, may then lose the request.
    context.maximum_version = ssl.TLSVersion.TLSv1_2
    with ben.live(ssl=context) as live:
        live.where(lambda s: s.get("daemon") == "ok")
        assert live.ask("queue")["code"] == 0
        refused = live.ask("estop")
        assert refused["code"] == 77 and "viewer" in refused["reason"]
        assert live.state["fault"] == "none"


def test_who_logs_in_gets_a_new_session_that_ends(far):
    status, one = login(far, "anna", "anna has a long word")
    assert status == 200
    status, two = login(far, "anna", "anna has a long word")
    assert one.cookie != two.cookie and one.token != two.token
    status, headers, _ = far.ask("GET", "/api/session",
                                 headers={"Cookie": two.cookie})
    assert "Secure" in headers["Set-Cookie"]
    assert "max-age" in headers["Strict-Transport-Security"]
    assert one.post("/api/logout")[0] == 200
    assert one.post("/api/check", b"G1")[0] == 401
    assert two.post("/api/check", b"M30\n")[0] == 200


def add_user(p, name, role):
    done = subprocess.run(
        [str(rig.BUILD / "edm-panel"), "--config", str(p.machine.config),
         "--add-user", name, role], input=f"{name} has a long word\n",
        text=True, capture_output=True)
    assert done.returncode == 0, done.stderr


def test_who_is_changed_has_to_log_in_again(far):
    add_user(far, "carl", "operator")
    status, carl = login(far, "carl", "carl has a long word")
    assert status == 200
    assert carl.post("/api/check", b"M30\n")[0] == 200
    add_user(far, "carl", "viewer")
    rig.until(lambda: carl.post("/api/check", b"M30\n")[0] == 401)


def test_guessing_is_slowed_down(far):
    codes = [login(far, "anna", f"guess number {i}")[0] for i in range(8)]
    assert 429 in codes and 200 not in codes
    # Even the right word has to wait then.
    assert login(far, "anna", "anna has a long word")[0] == 429
    assert "was refused" in far.log()


def test_the_word_in_clear_is_not_spoken(far):
    plain = socket.create_connection(("127.0.0.1", far.port), 10)
    plain.settimeout(20)
    plain.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
    try:
        assert b"200" not in plain.recv(100)
    except ConnectionError:
        pass
    plain.close()
