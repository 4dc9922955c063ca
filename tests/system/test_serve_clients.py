#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine clients of owserver against the genuine owserver, which proves the judge, and against
owsd -l, which is judged. What a client cannot ask is not asked; all that a client finds wrong is
told at once."""

import contextlib
import re
import traceback

import clients
import owsdtest
import served
from served import ABSENT, BATTERY, DEVICES, KEY, MEMORY, SWITCH, THERMOMETER

DEGREES = {"C": 21.5, "F": 70.7, "K": 294.65, "R": 530.37}
NAMES = {"f.i": "28.67C6697351FF", "fi": "2867C6697351FF", "f.i.c": "28.67C6697351FF.68",
         "f.ic": "28.67C6697351FF68", "fi.c": "2867C6697351FF.68", "fic": "2867C6697351FF68"}


class Judge:
    """Goes through the checks with one client of one server, and gathers what is wrong."""

    def __init__(self, client, server):
        self.client, self.server = client, server
        self.wrong, self.passed = [], []

    @contextlib.contextmanager
    def check(self, name):
        try:
            yield
            self.passed.append(name)
        except (AssertionError, clients.Refused, OSError, ValueError) as error:
            where = traceback.extract_tb(error.__traceback__)
            line = next(f for f in where if f.filename == __file__ and f.name != "check")
            self.wrong.append(f"{name}: {line.line}: {type(error).__name__} {error}")

    def refuses(self, call, *words, number=None):
        try:
            answer = call(*words)
        except clients.Refused as refused:
            if number is not None and refused.number is not None and "number" in self.client.can \
                    and self.client.remote:
                assert refused.number == number, (words, refused)
            return
        raise AssertionError(f"{words} is not refused: {answer}")

    def number(self, path, **how):
        return float(self.client.read(path, **how))

    # --- checks -----------------------------------------------------------------------------------
    def directory(self):
        with self.check("directory of the root"):
            assert set(DEVICES) <= set(self.client.dir("/"))
        with self.check("directory of a device"):
            listed = self.client.dir(THERMOMETER)
            assert {f"{THERMOMETER}/{name}" for name in
                    ("address", "temperature", "temperature9", "temphigh", "type")} <= set(listed)
            assert f"{SWITCH}/PIO.0" in self.client.dir(SWITCH)

    def reading(self):
        with self.check("read text"):
            assert self.client.read(THERMOMETER + "/type") == b"DS18B20"
            assert self.client.read(KEY + "/address") == b"01213DDC8770E9" + \
                self.client.read(KEY + "/crc8")
        with self.check("read a number"):
            assert self.number(THERMOMETER + "/temperature") == 21.5
            assert self.number(BATTERY + "/VDD") == 5
        with self.check("read an array"):
            assert re.fullmatch(rb"([01],){7}[01]", self.client.read(SWITCH + "/sensed.ALL"))
            assert self.client.read(SWITCH + "/sensed.0") in (b"0", b"1")
        if self.client.remote:
            with self.check("read without a slash in front, in lower case, without the dot"):
                for name in ("28.67C6697351FF", "/28.67c6697351ff", "/2867C6697351FF68"):
                    assert self.client.read(name + "/type") == b"DS18B20", name

    def writing(self):
        with self.check("write a number"):
            for value in (b"12", b"-7"):
                self.client.write(THERMOMETER + "/templow", value)
                assert self.number(THERMOMETER + "/templow") == float(value)
        with self.check("write a bit"):
            for value in (b"1", b"0"):
                self.client.write(served.LATCH + "/PIO", value)
                assert self.number(served.LATCH + "/PIO") == float(value)
        with self.check("write memory"):
            text = b"Hello, wire. 32 bytes of it here"
            self.client.write(MEMORY + "/pages/page.1", text)
            if self.client.tells:
                assert self.client.read(MEMORY + "/pages/page.1") == text

    def parts(self):
        """Of a memory. What mock keeps of a write that is less than the whole is nobody's value."""
        if "parts" not in self.client.can:
            return
        path = MEMORY + "/memory"
        before = bytes(i % 251 for i in range(128))
        with self.check("write a memory in parts"):
            self.client.write_at(path, before, 0)
            self.client.write_at(path, b"eight on", 8)
            self.client.write_at(path, b"the end", 121)
            self.client.write_at(MEMORY + "/pages/page.2", b"paged", 27)
            if not self.server.genuine:
                want = before[:8] + b"eight on" + before[16:91] + b"paged" + before[96:121] + b"the end"
                assert self.server.frame(served.READ, "/uncached" + path).data == want

    def errors(self):
        read, write = self.client.read, self.client.write
        with self.check("no such device"):
            self.refuses(read, ABSENT + "/temperature", number=-1)
            if self.client.tells:
                self.refuses(write, ABSENT + "/templow", b"1", number=-1)
        with self.check("no such property"):
            self.refuses(read, THERMOMETER + "/colour", number=-1)
            self.refuses(read, SWITCH + "/PIO.8", number=-1)
            if self.client.tells:
                self.refuses(write, THERMOMETER + "/colour", b"1", number=-1)
        with self.check("read of a directory"):
            self.refuses(read, THERMOMETER, number=-21)
        if self.client.tells:
            with self.check("write of what is only read"):
                # mock keeps what is written to others
                self.refuses(write, SWITCH + "/sensed.BYTE", b"1", number=-95)
            with self.check("write of what is no number"):
                self.refuses(write, THERMOMETER + "/templow", b"abc", number=-22)
        with self.check("no such directory"):
            self.refuses(self.client.dir, ABSENT, number=-1)

    def alarms(self):
        with self.check("no alarm"):
            self.client.write(THERMOMETER + "/templow", b"10")
            assert THERMOMETER not in "".join(self.client.dir("/alarm"))
        if not self.server.genuine and self.client.remote:
            with self.check("an alarm"):
                self.client.write(THERMOMETER + "/temphigh", b"20")
                assert self.number("/uncached" + THERMOMETER + "/temperature") == 21.5
                owsdtest.until(lambda: "/alarm" + THERMOMETER in self.client.dir("/alarm"), 10,
                               "an alarm is listed")
                self.client.write(THERMOMETER + "/temphigh", b"30")
        with self.check("read through the alarm directory"):
            assert self.client.read("/alarm" + THERMOMETER + "/type") == b"DS18B20"

    def ways(self):
        can = self.client.can
        if "scale" in can:
            with self.check("units"):
                self.client.write(THERMOMETER + "/templow", b"10")
                for scale, degrees in DEGREES.items():
                    value = self.number(THERMOMETER + "/temperature", scale=scale)
                    assert abs(value - degrees) < 0.01, (scale, value)
                    limit = self.number(THERMOMETER + "/templow", scale=scale)
                    assert abs(limit - (10 * (1.8 if scale in "FR" else 1) +
                                        {"C": 0, "F": 32, "K": 273.15, "R": 491.67}[scale])) < 0.01
        if "format" in can:
            with self.check("device formats"):
                for format, name in NAMES.items():
                    assert "/" + name in self.client.dir("/", format=format), format
                    assert f"{THERMOMETER}/type" in self.client.dir(THERMOMETER, format=format)
        if "size" in can:
            with self.check("offset and size"):
                path = THERMOMETER + "/address"
                assert self.client.read(path, size=4, offset=2) == b"67C6"
                assert self.client.read(path, size=4, offset=0) == b"2867"
                assert self.client.read(path, size=40, offset=14) == b"68"
        if "present" in can:
            with self.check("presence"):
                assert self.client.present(THERMOMETER)
                assert not self.client.present(ABSENT)
        if "get" in can:
            with self.check("owget"):
                value = self.client.get(THERMOMETER + "/type")
                assert value == b"DS18B20", value
                assert f"{THERMOMETER}/type\n" in self.client.get(THERMOMETER).decode()

    def aliases(self):
        with self.check("an alias"):
            self.client.write(THERMOMETER + "/alias", b"boiler")
            try:
                assert self.client.read(THERMOMETER + "/alias") == b"boiler"
                assert self.client.read("/boiler/type") == b"DS18B20"
                if self.client.remote and not isinstance(self.client, clients.Owsctl):
                    assert "/boiler" in self.client.dir("/")
                    assert "/boiler/type" in self.client.dir("/boiler")
            finally:
                self.client.write(THERMOMETER + "/alias", b"")

    def branches(self):
        """The directories beside the devices."""
        client = self.client
        with self.check("/uncached"):
            assert "/uncached" + THERMOMETER in client.dir("/uncached")
            assert client.read("/uncached" + THERMOMETER + "/type") == b"DS18B20"
        with self.check("/structure"):
            assert "/structure/28/temperature" in client.dir("/structure/28")
            text = client.read("/structure/28/temperature").decode()
            assert text.startswith("t,000000,000001,ro,000012,v,"), text
        with self.check("/simultaneous"):
            assert "/simultaneous/temperature" in client.dir("/simultaneous")
            client.write("/simultaneous/temperature", b"1")
        with self.check("/system"):
            assert "/system/process/pid" in client.dir("/system/process")
            assert client.read("/system/configuration/version")
            if client.remote:
                assert self.number("/system/process/pid") == self.server.program.pid
        with self.check("/statistics"):
            assert "/statistics/read/calls" in client.dir("/statistics/read")
            if client.remote:
                before = self.number("/statistics/read/calls")
                client.read(KEY + "/type")
                assert self.number("/statistics/read/calls") > before
        with self.check("/settings/units"):
            assert "/settings/units/temperature_scale" in client.dir("/settings/units")
            assert client.read("/settings/units/temperature_scale") == b"C"
            assert client.read("/settings/units/pressure_scale") == b"mbar"
        with self.check("/settings/return_codes"):
            texts = client.read("/settings/return_codes/text.ALL").split(b",")
            assert len(texts) == 211 and all(texts[0:3]), texts
        if client.remote:
            with self.check("/bus.N"):
                assert "/bus.0" + THERMOMETER in client.dir("/bus.0")
                assert client.read("/bus.0" + THERMOMETER + "/type") == b"DS18B20"
                assert "/bus.0/interface/settings" in client.dir("/bus.0/interface")

    def signals(self):
        if self.server.genuine or not self.client.remote:
            return
        with self.check("/signals"):
            listed = self.client.dir("/signals")
            assert {"/signals/room1", "/signals/relays"} <= set(listed), listed
            owsdtest.until(lambda: self.number("/signals/room1") == 21.5, 10, "room1 is good")
            assert self.number("/signals/room1_Age") >= 0
        with self.check("/signals are set"):
            self.client.write("/signals/relays", b"5")
            owsdtest.until(lambda: self.number("/uncached" + SWITCH + "/PIO.BYTE") == 5, 10,
                           "the output is written")
            self.client.write("/signals/relays", b"0")
        with self.check("/signals refuse"):
            self.refuses(self.client.write, "/signals/room1", b"5")
            self.refuses(self.client.write, "/signals/relays", b"many")
            self.refuses(self.client.read, "/signals/nothing")


def judged(scene, Kind, which):
    server = served.start(scene, which)
    client = Kind(scene, server)
    judge = Judge(client, server)
    try:
        for part in (judge.directory, judge.reading, judge.writing, judge.parts, judge.errors, judge.ways,
                     judge.branches, judge.signals, judge.alarms, judge.aliases):
            part()
    finally:
        client.close()
    wrong = [f"{len(judge.passed)} checks passed, wrong are", *judge.wrong]
    assert not judge.wrong, "\n".join(wrong)


def case(Kind, which):
    return lambda scene: judged(scene, Kind, which)


for _which in served.STARTS:
    for _kind in clients.ALL:
        globals()[f"test_{_kind.__name__}_of_{_which}".lower()] = case(_kind, _which)


def test_asyncowfs_locates_the_same_devices_with_the_same_fields(scene):
    """EVOK's scan: an entry of /structure that it cannot walk costs it all devices after."""
    found = [clients.Asyncowfs(scene, served.start(scene, which)).locate() for which in served.STARTS]
    assert len(found[0]) == len(DEVICES), found[0]
    assert found[0] == found[1], "\n".join(f"{name}: {found[0].get(name)} {found[1].get(name)}"
                                            for name in sorted({*found[0], *found[1]})
                                            if found[0].get(name) != found[1].get(name))


if __name__ == "__main__":
    owsdtest.main(at_once=8)
