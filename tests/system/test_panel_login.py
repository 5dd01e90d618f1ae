# SPDX-License-Identifier: Apache-2.0
"""The panel beyond its host: TLS, users, roles, sessions.

docs/panel.md has a table of the OWASP ASVS requirements that these tests show.
"""

import json
import os
import pathlib
import pwd
import socket
import ssl
import subprocess

import panel
import pytest
import rig
from websockets.exceptions import ConnectionClosed


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
    # A frame that is not masked is refused over TLS, too.
    with ben.live(ssl=context) as live:
        live.take()
        live.ws.socket.sendall(b"\x81\x02{}")
        with pytest.raises(ConnectionClosed):
            while True:
                live.take()
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


def test_one_s_own_login_frees_no_guesses(far):
    """Who has an account guesses the words of others no faster."""
    wrong = [login(far, "anna", f"guess number {i}")[0] for i in range(3)]
    assert login(far, "ben", "ben has a long word")[0] == 200
    wrong += [login(far, "anna", f"guess number {i}")[0] for i in range(3)]
    assert wrong == [403] * 5 + [429]
    assert login(far, "ben", "ben has a long word")[0] == 429
    # The minute is over: as many as before.
    far.kill()
    far.start_panel()


AS_ROOT = """
import os, subprocess, sys
config, panel = sys.argv[1:]
subprocess.run(["mount", "--bind", f"{os.path.dirname(config)}/passwd",
                "/etc/passwd"], check=True)
subprocess.run([panel, "--config", config, "--add-user", "dora", "operator"],
               input=b"dora has a long word", check=True)
"""


@pytest.mark.skipif(os.getuid() != 0, reason="needs root")
@pytest.mark.needs("mounts of its own")
def test_what_root_writes_the_service_can_read(tmp_path):
    p = panel.Panel(tmp_path, more=f"users = {tmp_path}/users\n")
    passwd = pathlib.Path("/etc/passwd").read_text().replace("\n\n", "\n")
    (tmp_path / "passwd").write_text("".join(
        line + "\n" for line in passwd.splitlines()
        if not line.startswith("edm-panel:"))
        + "edm-panel:x:4711:4712::/nonexistent:/usr/sbin/nologin\n")
    for found in (None, 0o600):      # a new file; that of an earlier version
        done = subprocess.run(
            ["unshare", "--mount", "/usr/bin/python3", "-c", AS_ROOT,
             str(p.machine.config), str(rig.BUILD / "edm-panel")],
            text=True, capture_output=True)
        assert done.returncode == 0, done.stderr
        st = os.stat(tmp_path / "users")
        assert (st.st_uid, st.st_gid, st.st_mode & 0o777) == (0, 4712, 0o640)
        os.chown(tmp_path / "users", 0, 0)
        os.chmod(tmp_path / "users", 0o600)
    p.machine.close()


@pytest.mark.skipif(os.getuid() != 0, reason="needs root")
def test_without_the_service_s_user_the_folder_says_whose_it_is(tmp_path):
    p = panel.Panel(tmp_path, more=f"users = {tmp_path}/users\n")
    os.chown(tmp_path, 4713, 4714)
    add_user(p, "dora", "operator")
    st = os.stat(tmp_path / "users")
    service = [x for x in pwd.getpwall() if x.pw_name == "edm-panel"]
    assert st.st_uid == 4713
    assert st.st_gid == (service[0].pw_gid if service else 4714)
    p.machine.close()


@pytest.mark.parametrize("how", ["unreadable", "gone", "damaged"])
def test_users_that_cannot_be_read_are_told(far, how):
    """It is nobody's wrong password."""
    users = far.folder / "users"
    text = users.read_text()
    users.unlink()
    if how == "damaged":
        users.write_text("anna operator\n" + text)
    elif how == "unreadable":
        users.mkdir()
    try:
        status, got = login(far, "anna", "anna has a long word")
        assert status == 503 and "file of users" in got["found"], got
        assert f"nobody can log in: {users}: " in far.log()
    finally:
        users.rmdir() if how == "unreadable" else users.unlink(
            missing_ok=True)
        users.write_text(text)
        users.chmod(0o600)
    assert login(far, "anna", "anna has a long word")[0] == 200


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
