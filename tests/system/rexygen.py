# SPDX-License-Identifier: MIT
"""What REXYGEN's drivers do by their manuals and public examples: OwsDrv, which asks an owserver, and
MbDrv as a Modbus TCP master. Both take their own .rio file, read by a parser of its own here.

    driver = OwsDrv(text, server)           driver.cycle(): alarms, else a write, else a read
    driver = MbDrv(text, client)            client: of test_modbus.py
    driver.read(), driver.values            name -> value; None where there is none
"""

import collections
import re
import struct

import served

TOKEN = re.compile(r'\s*("(?:[^"\\]|\\.)*"|\[[^\]]*\]|[{}]|[^\s{}"]+)')


def parse(text):
    """The one block of a .rio file: (name, {key: value, block: [values]}). Adjacent strings are one; a key
    that begins with # is a comment with a value."""
    tokens = collections.deque(TOKEN.findall(re.sub(r'(?m)^\s*#.*$(?:\n#".*$)*', "", text)))

    def block():
        found = {}
        while tokens[0] != "}":
            key = tokens.popleft()
            if tokens[0] == "{":
                tokens.popleft()
                found.setdefault(key, []).append(block())
                continue
            value = tokens.popleft()
            if value[0] == '"':
                value = value[1:-1]
                while tokens[0][0] == '"':
                    value += tokens.popleft()[1:-1]
            found[key] = value
        tokens.popleft()
        return found

    name = tokens.popleft()
    assert tokens.popleft() == "{", name
    whole = block()
    assert not tokens, tokens
    return name, whole


# IOType of OwsDrv: the type of REXYGEN below, then the way
BOOL, FLOAT, DOUBLE, STRING = 1, 7, 8, 12
OUTPUT, PAST_CACHE = 0x20, 0x100
OwsItem = collections.namedtuple("OwsItem", "name path kind output init device sensed latch por set reset")


def ows_item(keys):
    kind, path = int(keys["IOType"], 16), keys["Path"]
    if kind & PAST_CACHE and not path.startswith("/uncached"):
        path = "/uncached" + path
    device, _, sensed = re.sub(r"^/uncached", "", path).rpartition("/")
    alarm = keys.get("Alarm") == "on"
    return OwsItem(keys["Name"], path, kind & 0x0F, bool(kind & OUTPUT), keys.get("InitValue"), device if alarm else None,
                   sensed, keys.get("LatchAlarm"), keys.get("PorAlarm"), keys.get("SetAlarm"), keys.get("ResetLatch"))


class OwsDrv:
    """By section 3.1 of its manual and its Table 3.1: one request at a time, each with one answer."""

    def __init__(self, text, server):
        name, keys = parse(text)
        assert name == "OwsDrv"
        self.items = [ows_item(item) for item in keys.get("Item", [])]
        self.most = int(keys.get("MaxConsAlarms", 5))
        self.server, self.socket = server, None
        self.transactions = self.reconnects = 0
        self.values = {item.name: None for item in self.items}
        self.set = {item.name: item.init for item in self.items if item.output and item.init}
        self.written, self.writes, self.reads, self.alarms = {}, 0, 0, collections.Counter()

    def ask(self, kind, path, data=b""):
        """The answer, or None: the server has an error for it."""
        self.transactions += 1
        if not self.socket:
            self.socket = self.server.connect()
            self.reconnects += 1
        self.socket.sendall(served.request(kind, path, flags=served.USUAL | served.PERSIST, data=data))
        frame = served.receive(self.socket)
        if not frame.flags & served.PERSIST:
            self.socket.close()
            self.socket = None
        return frame.data.rstrip(b"\0").decode().strip() if frame.ret >= 0 else None

    def read(self, path):
        return self.ask(served.READ, path)

    def write(self, path, value):
        return self.ask(served.WRITE, path, str(value).encode())

    def take(self, item, text):
        self.values[item.name] = text if text is None or item.kind == STRING else \
            float(text) if item.kind in (FLOAT, DOUBLE) else int(text)

    def cycle(self):
        """What the loop does until each input has been read once."""
        for _ in self.items:
            self.do_alarms()
            if not self.do_write():
                self.do_read()

    def do_write(self):
        """One changed output, in the order of the file, from where the last one stood."""
        outputs = [item for item in self.items if item.output]
        for i in range(len(outputs)):
            item = outputs[(self.writes + i) % len(outputs)]
            if item.name in self.set and self.written.get(item.name) != self.set[item.name]:
                if self.write(item.path, self.set[item.name]) is not None:
                    self.written[item.name] = self.set[item.name]
                self.writes = (self.writes + i + 1) % len(outputs)
                return True
        return False

    def do_read(self):
        inputs = [item for item in self.items if not item.output]
        if inputs:
            item = inputs[self.reads % len(inputs)]
            self.take(item, self.read(item.path))
            self.reads += 1

    def do_alarms(self):
        alarms = [item for item in self.items if item.device]
        if not alarms:
            return
        listed = self.ask(served.DIRALL, "/alarm") or ""
        for item in [item for item in alarms if item.device.strip("/") in listed][:self.most]:
            self.do_alarm(item)

    def do_alarm(self, item):
        """Rows 3 to 17."""
        if item.por is None:
            return
        if item.por and int(self.read(f"{item.device}/{item.por}")):
            what, _, value = (item.set or "").partition("=")
            if what and value:
                self.write(f"{item.device}/{what}", value)
                for output in self.items:
                    if output.output and output.init and output.path.startswith(item.device):
                        self.write(output.path, output.init)
            self.write(f"{item.device}/{item.por}", 0)
        if not item.latch or not any(int(n) for n in self.read(f"{item.device}/{item.latch}").split(",")):
            return
        self.alarms[item.name] += 1
        self.take(item, self.read(f"/alarm{item.device}/{item.sensed}"))
        what, _, value = (item.reset or "").partition("=")
        if what and value:
            self.write(f"/alarm{item.device}/{what}", value)
        self.take(item, self.read(f"{item.device}/{item.sensed}"))


# Type of MbDrv: where it stands, what it is, which way it goes
INPUT_BIT, COIL, REGISTER = 0, 1, 4
MB_FLOAT, MB_SIGNED, MB_WRITE, MB_READ, MB_DOUBLE = 0x40, 0x80, 0x100, 0x200, 0x200000
FORMS = {0: (">H", 1), MB_SIGNED: (">h", 1), MB_FLOAT: (">f", 2), MB_DOUBLE: (">d", 4)}
MbItem = collections.namedtuple("MbItem", "name address place form written")


def mb_item(keys):
    """ValueError: a type that is not known, or more values than one."""
    kind, count = int(keys["Type"], 16), int(keys["Count"])
    place, form = kind & 7, kind & ~(7 | MB_WRITE | MB_READ)
    if bool(kind & MB_WRITE) == bool(kind & MB_READ) or place not in (INPUT_BIT, COIL, REGISTER) or form not in FORMS or \
            (form and place != REGISTER) or count != FORMS[form][1] or keys["SlaveAdr"] != "0":
        raise ValueError(keys)
    return MbItem(keys["Name"], int(keys["RegisterAdr"]), place, FORMS[form][0], bool(kind & MB_WRITE))


class MbDrv:
    """A master with one slave: a request for each item."""

    def __init__(self, text, client):
        name, keys = parse(text)
        assert name == "Modbus" and len(keys["Slave"]) == 1, text
        self.slave = keys["Slave"][0]
        self.items = [mb_item(item) for item in keys["Item"]]
        self.values = {item.name: None for item in self.items if not item.written}
        self.client = client
        client.unit = int(self.slave["Subaddress"])

    def read(self, refused):
        for item in self.items:
            if not item.written:
                try:
                    self.values[item.name] = self.value(item)
                except refused:
                    self.values[item.name] = None

    def value(self, item):
        if item.place == REGISTER:
            return self.client.number_at(item.address, item.form)
        return self.client.bits(item.address, 1, 1 if item.place == COIL else 2)[0]

    def write(self, name, number):
        item = next(item for item in self.items if item.name == name and item.written)
        if item.place == REGISTER and struct.calcsize(item.form) > 2:
            self.client.write(item.address, item.form, number)
        elif item.place == REGISTER:
            self.client.write_one(item.address, struct.unpack(">H", struct.pack(item.form, number))[0])
        else:
            self.client.write_one(item.address, 0xFF00 if number else 0, 5)
