# SPDX-License-Identifier: Apache-2.0
"""A PLC: plc.py eds|dbc|bad INTERFACE.  Prints what it saw as JSON.

eds  is CANopen master by PyPI canopen, from messages/edmd.eds
dbc  reads and writes plain frames by cantools, from messages/edmd.dbc
bad  is no good PLC at all
"""
import json
import sys
import threading
import time

import can

NODE = 32
STATES = ("?", "idle", "travel", "approach", "erode", "retract", "jump",
          "hold", "fault")
BITS = {"Permit": 0, "Start": 1, "Hold": 2, "Reset": 3, "Done": 4, "Alive": 7}
LOCKS = 0x1f


class Ear:
    """Requests and status frames, in the order in which they were sent."""

    def __init__(self, interface):
        self.bus = can.Bus(interface="socketcan", channel=interface,
                           can_filters=[{"can_id": i + NODE, "can_mask": 0x7ff}
                                        for i in (0x180, 0x200)])
        self.heard = []
        can.Notifier(self.bus, [self.heard.append], timeout=0.1)

    def sparking(self, silent):
        """Status frames with sparks behind the first request that takes
        something, or, if the PLC fell silent, behind its last one."""
        n = 0 if silent else None
        for m in list(self.heard):
            if m.arbitration_id != 0x200 + NODE:
                n = None if n is None else n + (m.data[1] >> 1 & 1)
            elif silent or (n is None and (not m.data[0] & 1 or
                                           m.data[1] != LOCKS)):
                n = 0
        return n


class Plc:
    """Sends its request each 20 ms with a turned toggle, keeps what comes."""

    def __init__(self):
        self.ask = {"command": 0, "locks": LOCKS, "override": 100.0,
                    "program": 0, "done": 0}
        self.seen = {}
        self.lock = threading.Lock()
        self.talking = True
        threading.Thread(target=self.talk, daemon=True).start()

    def talk(self):
        while True:
            if self.talking:
                with self.lock:
                    self.ask["command"] ^= 1 << BITS["Alive"]
                    self.send(self.ask)
            time.sleep(0.02)

    def say(self, **bits):
        """Command bits and other signals, at once."""
        with self.lock:
            for name, value in bits.items():
                if name in BITS:
                    self.ask["command"] &= ~(1 << BITS[name])
                    self.ask["command"] |= value << BITS[name]
                else:
                    self.ask[name] = value
            self.send(self.ask)

    def press(self, bit):
        self.say(**{bit: 1})
        time.sleep(0.1)
        self.say(**{bit: 0})

    def saw(self, **values):
        """One status frame."""
        self.seen.update(values)

    def until(self, what, timeout=60.0):
        end = time.monotonic() + timeout
        while not what(self.seen):
            if time.monotonic() > end:
                raise SystemExit(f"not seen: {self.seen}")
            time.sleep(0.005)
        return dict(self.seen)

    def until_state(self, *names):
        return self.until(lambda s: s.get("state") in names)


class EdsPlc(Plc):
    def __init__(self, interface):
        import canopen
        self.network = canopen.Network()
        self.network.connect(interface="socketcan", channel=interface)
        self.node = self.network.add_node(NODE, "edmd.eds")
        self.node.sdo.RESPONSE_TIMEOUT = 2
        self.node.tpdo.read()
        self.node.rpdo.read()
        self.node.tpdo[1].add_callback(self.heard)
        self.node.tpdo[2].add_callback(self.heard_job)
        self.node.tpdo[5].add_callback(self.heard_condition)
        self.node.nmt.state = "OPERATIONAL"
        super().__init__()

    def send(self, ask):
        pdo = self.node.rpdo[1]
        pdo["PLC.Command"].raw = ask["command"]
        pdo["PLC.Interlocks"].raw = ask["locks"]
        pdo["PLC.FeedOverride"].raw = round(ask["override"] * 10)
        pdo["PLC.ProgramSelect"].raw = ask["program"]
        pdo["PLC.McodeDone"].raw = ask["done"]
        pdo.transmit()

    def heard(self, pdo):
        flags = pdo["Machine.Flags"].raw
        self.saw(state=STATES[pdo["Machine.State"].raw],
                 fault=pdo["Machine.Fault"].raw, spark=flags >> 1 & 1,
                 loaded=flags >> 6 & 1, mcode=pdo["Machine.McodeWaiting"].raw,
                 gap=pdo["Machine.GapVoltage"].raw / 100,
                 feed=pdo["Machine.Feed"].raw / 1000)

    def heard_job(self, pdo):
        self.seen.update(job=pdo["Machine.Job"].raw,
                         line=pdo["Machine.Line"].raw)


    def heard_condition(self, pdo):
        self.seen.update(electrode=pdo["Machine.Electrode"].raw,
                         condition=pdo["Machine.Condition"].raw,
                         letter=pdo["Machine.ConditionLetter"].raw)


class DbcPlc(Plc):
    def __init__(self, interface):
        import cantools
        self.db = cantools.database.load_file("edmd.dbc")
        self.bus = can.Bus(interface="socketcan", channel=interface)
        self.bus.send(can.Message(arbitration_id=0, data=[1, NODE],
                                  is_extended_id=False))
        super().__init__()
        can.Notifier(self.bus, [self.heard], timeout=0.1)

    def send(self, ask):
        message = self.db.get_message_by_name("PlcRequest")
        locks = ("DoorClosed", "LevelOk", "TemperatureOk", "NoFire",
                 "WireWhole")
        signals = {name: ask["command"] >> bit & 1
                   for name, bit in BITS.items()}
        signals |= {name: ask["locks"] >> i & 1
                    for i, name in enumerate(locks)}
        signals |= {"FeedOverride": ask["override"], "AxisTemperature": 0,
                    "ProgramSelect": ask["program"], "McodeDone": ask["done"]}
        self.bus.send(can.Message(arbitration_id=message.frame_id,
                                  data=message.encode(signals),
                                  is_extended_id=False))

    def heard(self, m):
        try:
            message = self.db.get_message_by_frame_id(m.arbitration_id)
        except KeyError:
            return
        s = message.decode(m.data)
        if message.name == "EdmdStatus":
            self.saw(state=str(s["State"]), fault=str(s["Fault"]),
                     spark=s["Spark"], loaded=s["Loaded"],
                     mcode=s["McodeWaiting"], gap=s["GapVoltage"],
                     feed=s["Feed"])
        elif message.name == "EdmdJob":
            self.seen.update(job=s["Job"], line=s["Line"])
        elif message.name == "EdmdCondition":
            self.seen.update(electrode=s["Electrode"],
                             condition=s["Condition"],
                             letter=s["ConditionLetter"])


def feed_with(plc, override):
    """1 mm/s is as programmed."""
    plc.say(override=override)
    want = override / 100
    return plc.until(lambda s: abs(s["feed"] - want) < 0.1 * want)["feed"]


def carry_out(plc, code):
    """What was seen when the M code was told."""
    seen = plc.until(lambda s: s["mcode"] == code)
    plc.say(done=code)
    plc.until(lambda s: s["mcode"] == 0)
    plc.say(done=0)
    return seen


def cutting(plc):
    return plc.until(lambda s: s.get("spark") == 1)


def lost(plc, ret, name, lose, back):
    """Cut, lose something, see sparks and state; all well again, go on."""
    cutting(plc)
    plc.ear.heard.clear()
    lose()
    seen = plc.until_state("fault")
    ret[name] = dict(seen, sparking=plc.ear.sparking(name == "heartbeat"))
    back()
    time.sleep(0.2)
    ret[name]["after"] = plc.seen["state"]
    plc.press("Reset")
    plc.until_state("hold")
    plc.press("Start")
    cutting(plc)


def silence(plc):
    plc.talking = False


def talk_again(plc):
    plc.talking = True


def drive(plc, ret):
    ret["first"] = plc.until(lambda s: s.get("loaded") and "line" in s)
    plc.say(program=2)
    ret["selected"] = plc.until(lambda s: s["job"] == 2 and s["loaded"])
    plc.press("Start")
    time.sleep(0.2)
    ret["without permit"] = plc.seen["state"]
    plc.say(Permit=1)
    plc.press("Start")
    ret["started"] = plc.until_state("travel")
    ret["feed"] = [feed_with(plc, o) for o in (100, 40, 100)]

    ret["change"] = carry_out(plc, 6)
    ret["mcode"] = carry_out(plc, 60)
    ret["cut"] = cutting(plc)

    plc.say(Hold=1)
    ret["held"] = plc.until_state("hold")
    plc.press("Start")
    time.sleep(0.2)
    ret["start while held"] = plc.seen["state"]
    plc.say(Hold=0)
    plc.press("Start")
    lost(plc, ret, "permit", lambda: plc.say(Permit=0),
         lambda: plc.say(Permit=1))
    lost(plc, ret, "door", lambda: plc.say(locks=LOCKS & ~1),
         lambda: plc.say(locks=LOCKS))
    lost(plc, ret, "heartbeat", lambda: silence(plc),
         lambda: talk_again(plc))
    ret["end"] = dict(plc.seen)


def objects(plc, ret):
    """What the SDO server answers."""
    import canopen
    sdo = plc.node.sdo
    ret["state by sdo"] = sdo["Machine"]["State"].raw
    for name, index, sub, data in (
            ("unknown", 0x3000, 0, b"\1"), ("no sub", 0x2000, 40, b"\1"),
            ("read only", 0x2000, 1, b"\1"),
            ("while pdos come", 0x2100, 3, b"\1\0")):
        try:
            sdo.download(index, sub, data)
            ret[name] = "taken"
        except canopen.SdoAbortedError as e:
            ret[name] = hex(e.code)


def bad(plc, ret):
    """Noise of all kinds while a good PLC lets it cut."""
    plc.say(Permit=1)
    plc.press("Start")
    carry_out(plc, 6)
    carry_out(plc, 60)
    cutting(plc)
    off = can.Message(arbitration_id=0x200 + NODE, is_extended_id=False)

    def send(**more):
        message = can.Message(arbitration_id=0x200 + NODE,
                              is_extended_id=False)
        for name, value in more.items():
            setattr(message, name, value)
        message.dlc = len(message.data)
        plc.bus.send(message)

    ret["no data"] = off.dlc
    for i in range(300):
        send(data=bytearray(i % 8))
        send(data=bytearray(8), arbitration_id=0x200 + NODE + 1)
        send(data=bytearray(8), is_extended_id=True)
        send(data=bytearray([1, 0xff, 0, 0, 0, 0, 0, 0]))
        send(data=bytearray([0x2f, 0, 0x30, 0, 1, 0, 0, 0]),
             arbitration_id=0x600 + NODE)
        send(data=bytearray([0x80, NODE + 1]), arbitration_id=0)
        send(data=bytearray([5]), arbitration_id=0x700 + NODE)
        time.sleep(0.005)
    ret["after noise"] = dict(plc.seen)
    # Two that are not of one mind: the one without permit wins.
    for i in range(10):
        send(data=bytearray([0x80 * (i & 1), LOCKS, 0xe8, 3, 0, 0, 0, 0]))
        time.sleep(0.02)
    ret["second master"] = plc.until_state("fault")


def main():
    kind, interface = sys.argv[1:]
    plc = EdsPlc(interface) if kind == "eds" else DbcPlc(interface)
    ret = {}
    plc.ear = Ear(interface)
    try:
        (bad if kind == "bad" else drive)(plc, ret)
        if kind == "eds":
            objects(plc, ret)
    finally:
        print(json.dumps(ret, indent=1))


main()
