# SPDX-License-Identifier: Apache-2.0
"""edm-gateway: what a factory's OPC UA client sees of the machines.  The client
is asyncua's, and knows only the names of OPC 40501-1."""

import argparse
import asyncio
import contextlib
import datetime
import importlib.util
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from rig import BUILD, SLOW_JOB, until
from test_fleet import FleetMachine, peer, stranger_says  # noqa: F401

pytest.importorskip("asyncua", reason="pip install asyncua")
pytest.importorskip("cyclonedds", reason="pip install cyclonedds")

from asyncua import Client, ua  # noqa: E402
from cryptography import x509  # noqa: E402
from cryptography.hazmat.primitives import hashes, serialization  # noqa: E402
from cryptography.hazmat.primitives.asymmetric import rsa  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
TOOL = "http://opcfoundation.org/UA/MachineTool/"
MACHINERY = "http://opcfoundation.org/UA/Machinery/"
# Beside the package of LCM's types, which has the same name.
SPEC = importlib.util.spec_from_file_location(
    "gateway", ROOT / "clients/python/edm/gateway.py")
GATEWAY = sys.modules["gateway"] = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(GATEWAY)
DI = "http://opcfoundation.org/UA/DI/"


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def run(*args, **more):
    return subprocess.Popen(
        [sys.executable, "-m", "edm.gateway", "--nodesets",
         str(BUILD / "nodesets"), "--fleet", str(BUILD / "edm-fleet"), *args],
        cwd=ROOT / "clients/python", text=True, **more)


class Factory:
    """One client, in a thread of its own."""

    def __init__(self, port, security=""):
        self.security = security
        self.url = f"opc.tcp://127.0.0.1:{port}/edm"
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever)
        self.thread.start()

    def do(self, what):
        return asyncio.run_coroutine_threadsafe(what, self.loop).result(60)

    def __enter__(self):
        until(self._comes, 60)
        return self

    def _comes(self):
        self.client = Client(self.url)
        self.do(self.client.set_security_string(self.security))
        try:
            self.do(self.client.connect())
        except (OSError, asyncio.TimeoutError):
            return False
        self.ns = {u: i for i, u in enumerate(
            self.do(self.client.get_namespace_array()))}
        self.machines = self.client.get_node(
            ua.NodeId(1001, self.ns[MACHINERY]))
        return True

    def __exit__(self, *what):
        with contextlib.suppress(Exception):
            self.do(self.client.disconnect())
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()
        self.loop.close()

    def names(self):
        return sorted(self.do(n.read_browse_name()).Name for n in self.do(
            self.machines.get_children(
                nodeclassmask=ua.NodeClass.Object)))

    def node(self, machine, *path):
        t = self.ns[TOOL]
        return self.do(self.machines.get_child(
            [f"{self.ns['urn:edm:machines']}:{machine}",
             *(p if ":" in p else f"{t}:{p}" for p in path)]))

    def own(self, machine, name):
        i = self.ns["urn:edm:machines"]
        return self.node(machine, f"{i}:Edm", f"{i}:{name}")

    def value(self, node):
        return self.do(node.read_value())

    def good(self, node):
        return self.do(node.read_data_value(False)).StatusCode.is_good()

@pytest.fixture
def shop(tmp_path):
    """A machine, its edm-dds and the gateway."""
    with FleetMachine(tmp_path) as m:
        m.start()
        m.start_dds()
        port = free_port()
        with open(tmp_path / "gateway.log", "w", encoding="utf-8") as log:
            p = run("--listen", f"127.0.0.1:{port}", stderr=log)
            try:
                with Factory(port) as f:
                    until(lambda: m.name in f.names(), 20)
                    f.gateway, f.port = p, port
                    yield m, f
            finally:
                p.terminate()
                p.wait(20)


def test_a_machine_is_a_machine_tool_of_opc_40501(shop):
    m, f = shop
    top = f.node(m.name)
    kind = f.do(top.read_type_definition())
    assert (kind.Identifier, kind.NamespaceIndex) == (13, f.ns[TOOL])
    di = f.ns[DI]
    assert f.value(f.node(m.name, f"{di}:Identification",
                          f"{di}:SerialNumber")) == m.name
    generator = f.node(m.name, "Monitoring",
                       f"{f.ns['urn:edm:machines']}:Generator")
    assert f.do(generator.read_type_definition()).Identifier == 42
    assert f.value(f.node(m.name, "Monitoring", "MachineTool",
                          "OperationMode")) == 0
    state = ("Production", "ActiveProgram", "State", "0:CurrentState")
    assert f.value(f.node(m.name, *state)).Text == "Initializing"

    assert m.client.submit(SLOW_JOB, "job").code == 0
    current = f.node(m.name, *state)
    until(lambda: f.value(current).Text == "Running", 20)
    number = f.node(m.name, *state, "0:Number")
    kind = f.node(m.name, *state, "0:Id")
    assert f.value(number) == 1
    assert f.do(f.client.get_node(f.value(kind)).read_browse_name()) \
        .Name == "Running"
    assert f.value(f.node(m.name, "Monitoring", "MachineTool",
                          "OperationMode")) == 1
    x = f.own(m.name, "position_X_mm")
    until(lambda: f.value(x) > 0.1, 20)
    m.client.job_where("job", "done")
    until(lambda: f.value(current).Text == "Ended", 20)
    assert f.value(f.own(m.name, "outcome")) == "done"
    # It has no generator that tells its peak current.
    told = f.do(f.own(m.name, "told_peak_a").read_data_value(False))
    assert told.StatusCode.value == ua.StatusCodes.BadNoData


def test_a_client_can_change_nothing(shop):
    m, f = shop
    state = f.own(m.name, "state")
    for what in (
        state.write_value("erode"),
        f.node(m.name).add_variable(1, "mine", 1),
        f.node(m.name).delete(),
        f.client.delete_nodes([f.node(m.name)]),
    ):
        with pytest.raises((ua.UaStatusCodeError, ua.UaError)):
            r = f.do(what)
            if isinstance(r, tuple):
                r[1][0].check()
    assert f.value(state) == "idle" and m.name in f.names()


class Heard:
    def __init__(self):
        self.events = []

    def event_notification(self, event):
        self.events.append(event)


def test_a_fault_and_a_stand_are_events(shop):
    m, f = shop
    heard = Heard()
    s = f.do(f.client.create_subscription(100, heard))
    f.do(s.subscribe_events(
        f.node(m.name, "Notification"),
        f.client.get_node(ua.NodeId(35, f.ns[TOOL]))))
    assert m.client.submit(b"G21 G90\nG1 X0.1 F60\nM0\nX0.2\nM30\n", "j").code == 0

    def comes(words):
        return [e for e in heard.events if words in e.Message.Text]
    until(lambda: comes("stands: stop"), 20)
    e = comes("stands: stop")[0]
    assert e.Identifier == "stop" and e.SourceName == m.name
    assert e.Severity == 400
    assert len(comes("stands: stop")) == 1


def test_what_is_not_known_has_no_good_value(shop):
    m, f = shop
    gap, state = f.own(m.name, "gap_v"), f.own(m.name, "state")
    until(lambda: f.good(gap), 20)
    os.kill(m.dds.pid, signal.SIGKILL)
    m.dds.wait()
    until(lambda: f.value(state) == "gone", 30)
    assert not f.good(gap)
    assert not f.good(f.node(m.name, "Monitoring", "MachineTool",
                             "OperationMode"))
    m.start_dds()
    until(lambda: f.good(gap) and f.value(state) == "idle", 30)


def fleet_of(gateway):
    """Its edm-fleet."""
    with open(f"/proc/{gateway.pid}/task/{gateway.pid}/children",
              encoding="ascii") as children:
        return [int(x) for x in children.read().split()]


def test_an_edm_fleet_that_dies_is_begun_anew(shop):
    m, f = shop
    gap = f.own(m.name, "gap_v")
    until(lambda: f.good(gap), 20)
    first = fleet_of(f.gateway)
    os.kill(first[0], signal.SIGKILL)
    until(lambda: not f.good(gap), 20)
    until(lambda: f.good(gap), 40)
    assert fleet_of(f.gateway) != first


def test_a_stranger_s_name_ends_nothing(shop, peer):  # noqa: F811
    """That of a node of a machine, and others that no machine can have."""
    m, f = shop
    writers = []
    for name in f"{m.name}.gap_v", "a:b", "a/b", "..", "0:Server", "\x1b[2J", \
            "x" * 31:
        s = stranger_says(m)
        s.machine = name
        writers.append(peer.writer(name))
        writers[-1].write(s)
    until(lambda: f.names() == sorted([m.name, s.machine]), 30)
    was = f.value(f.own(m.name, "cycle"))
    until(lambda: f.value(f.own(m.name, "cycle")) > was, 20)
    assert f.names() == sorted([m.name, s.machine])
    assert f.gateway.poll() is None


SAYS = """#!/bin/sh
sleep 1; cat {0}/lines; : > {0}/said; exec sleep 600
"""


def test_what_was_said_meanwhile_is_over(tmp_path):
    """A gateway that is slower than edm-fleet shows what was said last."""
    (tmp_path / "lines").write_text("".join(
        json.dumps({"machines": [{"machine": "m", "n": n}]}) + "\n"
        for n in range(1000)))
    says = tmp_path / "says"
    says.write_text(SAYS.format(tmp_path))
    says.chmod(0o755)
    shown = []

    class Slow:
        async def show(self, m):
            shown.append(m["n"])
            while not (tmp_path / "said").exists():
                await asyncio.sleep(0.01)
            await asyncio.sleep(0.2)

    async def run_it():
        o = argparse.Namespace(fleet=str(says), domain=0)
        task = asyncio.create_task(GATEWAY.follow(Slow(), o))
        while 999 not in shown:
            await asyncio.sleep(0.01)
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task

    asyncio.run(asyncio.wait_for(run_it(), 300))
    assert len(shown) < 5, shown


def make_certificate(folder):
    """A key, and a certificate for it that it signed itself."""
    key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "hall")])
    now = datetime.datetime.now(datetime.timezone.utc)
    day = datetime.timedelta(days=1)
    certificate = (
        x509.CertificateBuilder().subject_name(name).issuer_name(name)
        .public_key(key.public_key()).serial_number(1)
        .not_valid_before(now - day).not_valid_after(now + day)
        .sign(key, hashes.SHA256()))
    (folder / "hall.pem").write_bytes(
        certificate.public_bytes(serialization.Encoding.PEM))
    (folder / "hall.key").write_bytes(key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption()))
    # asyncua's client goes by the name.
    os.link(folder / "hall.key", folder / "hall.key.pem")
    return str(folder / "hall.pem"), str(folder / "hall.key")


def test_with_a_certificate_it_speaks_encrypted_alone(tmp_path):
    port, (pem, key) = free_port(), make_certificate(tmp_path)
    p = run("--listen", f"127.0.0.1:{port}", "--certificate", pem,
            "--private-key", key, stderr=subprocess.PIPE)
    try:
        assert "opc.tcp://" in p.stderr.readline()
        with Factory(port, f"Basic256Sha256,SignAndEncrypt,{pem},{key}.pem") as f:
            assert f.names() == []
            with pytest.raises((ua.UaError, OSError, asyncio.TimeoutError)):
                f.do(Client(f.url, timeout=4).connect())
            assert f.names() == []
    finally:
        p.terminate()
        p.wait(20)


def test_it_refuses_with_a_reason(tmp_path):
    for args, words in (
        (["--nodesets", str(tmp_path)], "is not there; --nodesets FOLDER"),
        (["--certificate", "a.pem"], "belong together"),
        (["--fleet", str(tmp_path)], "is no program; --fleet PROGRAM"),
        (["--certificate", "/no/a.pem", "--private-key", "/no/b.pem"],
         "a certificate and its key"),
    ):
        p = run("--listen", f"127.0.0.1:{free_port()}", *args,
                stderr=subprocess.PIPE)
        assert p.wait(60) == 78
        assert words in p.stderr.read()
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        s.listen()
        p = run("--listen", f"127.0.0.1:{s.getsockname()[1]}",
                stderr=subprocess.PIPE)
        assert p.wait(60) == 69
        assert "--listen HOST:PORT that is free" in p.stderr.read()
