# SPDX-License-Identifier: Apache-2.0
"""edm-gateway: the machines of a fleet as an OPC UA server, for a factory.

Each machine that edm-fleet hears is an instance of MachineToolType of OPC
40501-1, and has beside that all that edm-dds tells of it.  Clients may read,
browse and subscribe; nothing can be written, and no job begins from here.
docs/fleet.md has the nodes.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import importlib
import json
import logging
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

NODESETS = "/usr/share/edmd/nodesets"
FILES = ("Di", "IA", "Machinery", "MachineTool")
OURS = "urn:edm:machines"
TOOL = "http://opcfoundation.org/UA/MachineTool/"
MACHINERY = "http://opcfoundation.org/UA/Machinery/"
# Of these node sets.
MACHINES, TOOL_TYPE, GENERATOR_TYPE, EVENT_TYPE = 1001, 13, 42, 35
AGAIN_S = 5.0
SEVERE, ASKS = 800, 400

# States of edm-dds in which nobody knows what the machine is doing.
UNKNOWN = ("absent", "lost", "gone", "disputed")
BY_HAND = ("jog", "home")
STANDS = ("hold", "fault")
# MachineOperationMode, EDMGeneratorState and the states of the program, by the
# numbers of OPC 40501-1; the last with the nodes of their kinds of state.
MANUAL, AUTOMATIC = 0, 1
GENERATOR = ("undefined", "ready", "active-low-voltage",
             "active-high-voltage", "error")
PROGRAM = (("Initializing", 135), ("Running", 138), ("Ended", 140),
           ("Interrupted", 139), ("Aborted", 141))
AXES = "XYZABCUV"
# As machines have them; of another name only a stranger can speak.
NAME = re.compile(r"[A-Za-z0-9_-]{1,31}\Z")
# Values of a node that wait for a client that takes none.
WAITING = 16


class Wrong(Exception):
    """It cannot be served; says what would be accepted."""


def _library() -> Any:
    try:
        return importlib.import_module("asyncua")
    except ImportError:
        raise Wrong("needs asyncua; pip install asyncua") from None


def _form(text: bytes) -> str:
    return "pem" if text.startswith(b"-----BEGIN") else "der"


def program_state(m: dict[str, Any]) -> int:
    """Of what edm-fleet says, the number in PROGRAM."""
    if not m["program"]:
        return {"none": 0, "done": 2}.get(m["outcome"], 4)
    if m["stand"] == "ready":
        return 0
    return 3 if m["state"] in STANDS else 1


def values_of(m: dict[str, Any]) -> dict[str, Any]:
    """All that edm-dds tells, but for what names the machine.  None: it does
    not know."""
    v = {k: x for k, x in m.items()
         if k not in ("machine", "position_mm", "heard_utime", "known")}
    return v | dict(zip((f"position_{a}_mm" for a in AXES),
                        m["position_mm"]))


@dataclass
class Machine:
    """Nodes of a machine, and what was written to each last."""

    nodes: dict[str, Any]
    notify: Any
    was: dict[str, Any] = field(default_factory=dict)
    told: tuple[str, str] = ("", "")


class Hall:
    """The address space."""

    def __init__(self, asyncua: Any) -> None:
        self.ua, self.a = asyncua.ua, asyncua
        self.server: Any = None
        self.machines: dict[str, Machine] = {}
        self.tool = self.machinery = self.ours = 0

    async def open(self, o: argparse.Namespace) -> None:
        """Load the node sets, and listen.  Raises Wrong."""
        crypto = importlib.import_module("asyncua.server.user_managers")
        role = importlib.import_module("asyncua.crypto.permission_rules")

        class Reader(crypto.UserManager):  # type: ignore[misc, name-defined]
            """Everybody may look."""

            def get_user(self, *_: Any, **__: Any) -> Any:
                return role.User(role=role.UserRole.User)

        self.server = self.a.Server(user_manager=Reader())
        await self.server.init()
        self.server.iserver.max_monitored_item_queue_size = WAITING
        self.server.set_endpoint(f"opc.tcp://{o.listen}/edm")
        self.server.set_server_name("edm-gateway")
        await self._secure(o, role)
        for name in FILES:
            path = Path(o.nodesets) / f"Opc.Ua.{name}.NodeSet2.xml"
            if not path.is_file():
                raise Wrong(f"{path} is not there; --nodesets FOLDER of the "
                            "OPC Foundation's node sets: DI 1.04, IA 1.01, "
                            "Machinery 1.02, MachineTool 1.01")
            await self.server.import_xml(path)
        self.tool = await self.server.get_namespace_index(TOOL)
        self.machinery = await self.server.get_namespace_index(MACHINERY)
        self.ours = await self.server.register_namespace(OURS)

    async def _secure(self, o: argparse.Namespace, role: Any) -> None:
        policy = self.ua.SecurityPolicyType
        rules = role.SimpleRoleRuleset()
        may = rules._permission_dict  # pylint: disable=protected-access
        may[role.UserRole.User].discard(self.ua.NodeId(
            self.ua.ObjectIds.WriteRequest_Encoding_DefaultBinary))
        if not o.certificate:
            self.server.set_security_policy([policy.NoSecurity],
                                            permission_ruleset=rules)
            return
        try:
            certificate = Path(o.certificate).read_bytes()
            key = Path(o.private_key).read_bytes()
            await self.server.load_certificate(
                certificate, format=_form(certificate))
            await self.server.load_private_key(key, format=_form(key))
        except (OSError, ValueError, TypeError) as e:
            raise Wrong(f"{o.certificate}, {o.private_key}: {e}; a "
                        "certificate and its key, PEM or DER") from None
        self.server.set_security_policy(
            [policy.Basic256Sha256_Sign, policy.Basic256Sha256_SignAndEncrypt],
            permission_ruleset=rules)

    def _standard(self, number: int) -> Any:
        return self.server.get_node(self.ua.NodeId(number, self.tool))

    async def _add(self, name: str, m: dict[str, Any]) -> Machine:
        ua, t = self.ua, self.tool
        machines = self.server.get_node(
            ua.NodeId(MACHINES, self.machinery))
        top = await machines.add_object(
            ua.NodeId(name, self.ours), ua.QualifiedName(name, self.ours),
            objecttype=ua.NodeId(TOOL_TYPE, t), instantiate_optional=False)
        spark = await (await top.get_child([f"{t}:Monitoring"])).add_object(
            self.ours, "Generator",
            objecttype=ua.NodeId(GENERATOR_TYPE, t))
        program = await top.get_child(
            [f"{t}:Production", f"{t}:ActiveProgram"])
        state = await program.get_child([f"{t}:State", "0:CurrentState"])
        di = await self.server.get_namespace_index(
            "http://opcfoundation.org/UA/DI/")
        for what, value in (
                ("Manufacturer", ua.LocalizedText("edm")),
                ("ProductInstanceUri", f"urn:{m['host']}:edm:{name}"),
                ("SerialNumber", name)):
            n = await top.get_child([f"{di}:Identification", f"{di}:{what}"])
            await n.write_value(value)
        nodes = {
            "Name": await program.get_child([f"{t}:Name"]),
            "NumberInList": await program.get_child(["0:NumberInList"]),
            "CurrentState": state,
            "Id": await state.get_child(["0:Id"]),
            "Number": await state.get_child(["0:Number"]),
            "OperationMode": await top.get_child(
                [f"{t}:Monitoring", f"{t}:MachineTool", f"{t}:OperationMode"]),
            "EDMGeneratorState": await spark.get_child(
                [f"{t}:EDMGeneratorState"]),
            "IsOn": await spark.get_child([f"{t}:IsOn"]),
        }
        own = await top.add_folder(self.ours, "Edm")
        for k, x in values_of(m).items():
            nodes[k] = await own.add_variable(
                ua.NodeId(f"{name}.{k}", self.ours),
                ua.QualifiedName(k, self.ours),
                self._typed(0.0 if x is None else x))
        notify = await self.server.get_event_generator(
            self._standard(EVENT_TYPE),
            await top.get_child([f"{t}:Notification"]))
        return Machine(nodes, notify)

    def _standard_values(self, m: dict[str, Any]) -> dict[str, Any]:
        ua, number = self.ua, program_state(m)
        word, node = PROGRAM[number]
        typed = ua.VariantType
        return {
            "Name": ua.Variant(str(m["program"] or ""), typed.String),
            "NumberInList": ua.Variant(m["program"] % 65536, typed.UInt16),
            "CurrentState": ua.Variant(ua.LocalizedText(word, "en"),
                                       typed.LocalizedText),
            "Id": ua.Variant(ua.NodeId(node, self.tool), typed.NodeId),
            "Number": ua.Variant(number, typed.UInt32),
            "OperationMode": ua.Variant(
                AUTOMATIC if m["program"] and m["state"] not in BY_HAND else
                MANUAL, typed.Int32),
            "EDMGeneratorState": ua.Variant(
                GENERATOR.index(m["generator_state"]), typed.Int32),
            "IsOn": ua.Variant(m["is_on"], typed.Boolean),
        }

    async def show(self, m: dict[str, Any]) -> None:
        """What edm-fleet says of a machine now."""
        name = m["machine"]
        if name not in self.machines:
            self.machines[name] = await self._add(name, m)
        at, ua = self.machines[name], self.ua
        code = ua.StatusCodes
        for k, x in (values_of(m) | self._standard_values(m)).items():
            status = (code.Good if k in ("state", "host", "rival") else
                      code.BadNoCommunication if m["state"] in UNKNOWN else
                      code.BadNoData if x is None else code.Good)
            if at.was.get(k) == (x, status):
                continue
            at.was[k] = (x, status)
            await self._write(at.nodes[k], x, status)
        await self._tell(at, m)

    def _typed(self, x: Any) -> Any:
        """None: no value."""
        ua = self.ua
        if isinstance(x, ua.Variant) or x is None:
            return x or ua.Variant()
        kind = {str: ua.VariantType.String, bool: ua.VariantType.Boolean,
                int: ua.VariantType.Int64, float: ua.VariantType.Double}
        return ua.Variant(x, kind[type(x)])

    async def _write(self, node: Any, x: Any, status: int) -> None:
        await self.server.write_attribute_value(node.nodeid, self.ua.DataValue(
            self._typed(x), self.ua.StatusCode(status)))

    async def _tell(self, at: Machine, m: dict[str, Any]) -> None:
        """An event for a fault, and for what a person is asked to do."""
        fault = "" if m["fault"] == "none" else m["fault"]
        stand = m["stand"]
        for was, now, how, words in (
                (at.told[0], fault, SEVERE, "fault"),
                (at.told[1], stand, ASKS, "stands")):
            if now and now != was and m["state"] not in UNKNOWN:
                at.notify.event.Severity = how
                at.notify.event.add_property(
                    "Identifier", now, self.ua.VariantType.String)
                at.notify.event.SourceName = m["machine"]
                await at.notify.trigger(
                    message=f"{m['machine']}: {words}: {now}")
        if m["state"] not in UNKNOWN:
            at.told = (fault, stand)

    async def nobody_tells(self) -> None:
        """edm-fleet has ended: of no machine is anything known."""
        for name, at in self.machines.items():
            for k, node in at.nodes.items():
                value = "gone" if k == "state" else at.was[k][0]
                status = (self.ua.StatusCodes.Good if k == "state" else
                          self.ua.StatusCodes.BadNoCommunication)
                at.was[k] = (value, status)
                await self._write(node, value, status)
            say(f"{name}: edm-fleet does not tell anything any more")


def say(text: str) -> None:
    """To the journal."""
    print(f"edm-gateway: {text}", file=sys.stderr, flush=True)


async def listen(lines: asyncio.StreamReader,
                 newest: asyncio.Queue[bytes]) -> None:
    """Only what was said last counts; nothing: it has ended."""
    while True:
        try:
            line = await lines.readline()
        except ValueError:
            line = b""
        if newest.full():
            newest.get_nowait()
        newest.put_nowait(line)
        if not line:
            return


async def follow(hall: Hall, o: argparse.Namespace) -> None:
    """What one edm-fleet says, until it ends."""
    child = await asyncio.create_subprocess_exec(
        o.fleet, "--watch", "--json", "--domain", str(o.domain),
        stdout=asyncio.subprocess.PIPE, limit=1 << 24)
    newest: asyncio.Queue[bytes] = asyncio.Queue(1)
    assert child.stdout
    listening = asyncio.create_task(listen(child.stdout, newest))
    try:
        while line := await newest.get():
            for m in json.loads(line)["machines"]:
                if NAME.match(m["machine"]):
                    await hall.show(m)
                # Clients are answered between two machines.
                await asyncio.sleep(0)
    finally:
        listening.cancel()
        with contextlib.suppress(ProcessLookupError):
            child.terminate()
        await child.wait()


async def serve(o: argparse.Namespace) -> None:
    """Never gives up: edm-fleet is begun anew."""
    asyncua = _library()
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    hall = Hall(asyncua)
    await hall.open(o)
    async with hall.server:
        say(f"opc.tcp://{o.listen}/edm, domain {o.domain}")
        while True:
            try:
                await follow(hall, o)
                say("edm-fleet has ended; goes on trying")
            except (FileNotFoundError, PermissionError):
                raise Wrong(f"{o.fleet} is no program; --fleet PROGRAM") \
                    from None
            except (OSError, ValueError) as e:
                say(f"edm-fleet: {e}; goes on trying")
            await hall.nobody_tells()
            await asyncio.sleep(AGAIN_S)


def options() -> argparse.Namespace:
    """Of the command line.  Raises Wrong."""
    p = argparse.ArgumentParser(prog="edm-gateway", description=__doc__)
    p.add_argument("--listen", default="127.0.0.1:4840", metavar="HOST:PORT",
                   help="where clients connect (%(default)s)")
    p.add_argument("--domain", type=int, default=0, help="of DDS (0)")
    p.add_argument("--nodesets", default=NODESETS, metavar="FOLDER",
                   help="of the OPC Foundation's (%(default)s)")
    p.add_argument("--certificate", metavar="FILE",
                   help="signed and encrypted connections alone, by this")
    p.add_argument("--private-key", metavar="FILE", help="of the certificate")
    p.add_argument("--fleet", default="edm-fleet", metavar="PROGRAM")
    o = p.parse_args()
    if bool(o.certificate) != bool(o.private_key):
        raise Wrong("--certificate and --private-key belong together")
    return o


def main() -> int:
    """Return: as sysexits.h."""
    try:
        asyncio.run(serve(options()))
    except Wrong as e:
        say(str(e))
        return 78
    except OSError as e:
        say(f"cannot listen: {e}; --listen HOST:PORT that is free")
        return 69
    except KeyboardInterrupt:
        pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
