# SPDX-License-Identifier: MIT
"""A house with an owsd and owsd-modbus, and a client that asks as the specification has it."""

import socket
import struct

import owsdtest
from owsdtest import BUILD, raw, until

MODBUS = BUILD / "owsd-modbus"
SENSOR, OTHER, RELAY = "/28.A0B1C2000001", "/28.A0B1C2000002", "/29.A0B1C2000004"
GOOD, NO_PROPERTY, NO_DEVICE, NO_OWSD = 0xC0, 0x04, 0x08, 0x1A
DOUBLE, FLOAT, LONG, SHORT, QUALITY, AGE, ALARM, COUNT, DECIMALS, FLAGS = 0, 4, 6, 8, 9, 10, 12, 13, 14, 15
FUNCTION, ADDRESS, VALUE, FAILURE, BUSY, NO_TARGET = 1, 2, 3, 4, 6, 11


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", SENSOR + "/temperature", LimitH=20)
CELLAR = item("cellar", OTHER + "/temperature")
RELAYS = item("relays", RELAY + "/PIO.BYTE", "byte", "output")
TITLE = item("title", SENSOR + "/type", "string", PerFactor=20)
ABSENT = item("absent", "/28.FFFFFFFFFFFF/temperature")


def text(scene, port, *items, **keys):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n"
                      "DS18B20 28.A0B1C2000002 temperature -3.25\nDS2408 29.A0B1C2000004\n")
    block = {"Listen": f"127.0.0.1:{port}", **keys}
    more = {"Modbus": raw("{ " + " ".join(f'{k} "{v}"' for k, v in block.items()) + " }")} if port else {}
    return owsdtest.rio(f"sim:{wire}", items or (ROOM, RELAYS, TITLE, ABSENT), Period=0.05, Timeout=3, **more)


def serve(scene, daemon, *options, env=None):
    owsdtest.need(MODBUS)
    return scene.start([MODBUS, "-n", daemon.name, "-c", daemon.config, *options],
                       {"STATE_DIRECTORY": str(scene.path / "state"), **(env or {})})


class Refused(Exception):
    pass


class Client:
    """Asks as the specification has it, and takes nothing but an answer to what it asked."""

    def __init__(self, port, unit=1, host="127.0.0.1"):
        self.unit, self.number = unit, 0
        until(lambda: self.connects(host, port), 20, "owsd-modbus listens")

    def connects(self, host, port):
        try:
            self.socket = socket.create_connection((host, port), timeout=owsdtest.PATIENCE)
        except OSError:
            return False
        return True

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def exactly(self, n):
        data = b""
        while len(data) < n:
            more = self.socket.recv(n - len(data))
            if not more:
                raise ConnectionError("closed")
            data += more
        return data

    def frame(self, pdu):
        self.number += 1
        return struct.pack(">HHHB", self.number, 0, 1 + len(pdu), self.unit) + pdu

    def answer(self):
        number, protocol, length, unit = struct.unpack(">HHHB", self.exactly(7))
        assert (number, protocol, unit) == (self.number, 0, self.unit)
        return self.exactly(length - 1)

    def ask(self, pdu):
        self.socket.sendall(self.frame(pdu))
        answer = self.answer()
        if answer[0] & 0x80:
            assert answer[0] == pdu[0] | 0x80 and len(answer) == 2, answer
            raise Refused(answer[1])
        assert answer[0] == pdu[0], answer
        return answer[1:]

    def registers(self, address, count, function=3):
        answer = self.ask(struct.pack(">BHH", function, address, count))
        assert answer[0] == 2 * count == len(answer) - 1, answer
        return struct.unpack(f">{count}H", answer[1:])

    def number_at(self, address, form, function=3):
        words = self.registers(address, struct.calcsize(form) // 2, function)
        return struct.unpack(form, struct.pack(f">{len(words)}H", *words))[0]

    def write(self, address, form, *numbers):
        data = struct.pack(form, *numbers)
        return self.ask(struct.pack(">BHHB", 16, address, len(data) // 2, len(data)) + data)

    def write_one(self, address, number, function=6):
        return self.ask(struct.pack(">BHH", function, address, number))

    def bits(self, address, count, function=1):
        answer = self.ask(struct.pack(">BHH", function, address, count))
        return [answer[1 + i // 8] >> i % 8 & 1 for i in range(count)]

    def quality(self, place):
        return self.registers(16 * place + QUALITY, 1)[0]

    def becomes(self, place, quality):
        def now():
            try:
                return self.quality(place)
            except Refused as refusal:  # as long as it has no signal
                return f"exception {refusal}"

        until(lambda: now() == quality, 20, lambda: f"place {place} has quality {quality}, not {now()}")


def refused(call, *arguments):
    """With which exception; None: it is not."""
    try:
        call(*arguments)
    except Refused as why:
        return why.args[0]
    return None
