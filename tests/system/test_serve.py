#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The served owserver protocol: byte for byte as the genuine owserver, and what it adds."""

import os
import signal
import socket
import struct
import time

import owsdtest
from owsdtest import until

DIR, PRESENT, GET, DIRALLSLASH, GETSLASH = 4, 6, 8, 9, 10
NOP, READ, WRITE, DIRALL = 1, 2, 3, 7
PERSIST, UNCACHED = 0x4, 0x20


class Link:
    """A connection that stays open as long as the server lets it."""

    def __init__(self, port, host="127.0.0.1", path=None, seconds=10):
        if path:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.settimeout(seconds)
            self.socket.connect(path)
        else:
            self.socket = socket.create_connection((host, port), timeout=seconds)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def exactly(self, n):
        data = b""
        while len(data) < n:
            more = self.socket.recv(n - len(data))
            if not more:
                raise EOFError
            data += more
        return data

    def frame(self):
        """One answer: (ret, flags, size, offset, data); keep-alives are None."""
        _, length, ret, flags, size, offset = struct.unpack(">6i", self.exactly(24))
        if length < 0:
            return None
        return ret, flags, size, offset, self.exactly(length)

    def send(self, kind, path, data=b"", size=8192, flags=0x10A, offset=0):
        body = b"" if path is None else path.encode() + b"\0" + data
        self.socket.sendall(struct.pack(">6i", 0, len(body), kind, flags,
                                        len(data) if kind == WRITE else size, offset) + body)

    def answers(self):
        """All frames of the answer to a DIR."""
        frames = []
        while not frames or frames[-1][4]:
            frames.append(self.answer())
            if frames[-1][0] < 0:
                break
        return frames

    def answer(self):
        while True:
            frame = self.frame()
            if frame:
                return frame


def ask(port, kind, path, *arguments, **keys):
    """One request on a connection of its own; of a DIR all frames."""
    with Link(port) as link:
        link.send(kind, path, *arguments, **keys)
        return link.answers() if kind == DIR else link.answer()


def served(scene, config, *options, **keys):
    """An owsd that serves, and its port."""
    port = owsdtest.free_port()
    return scene.owsd(config, "-l", str(port), *options, **keys), port


def house(scene, *options):
    """On the simulated house of the demonstration."""
    folder = owsdtest.SOURCE / "board/demo"
    daemon, port = served(scene, folder / "house.rio", "-t", f"sim:{folder}/house.sim", *options)
    until(lambda: scene.get(daemon, "boiler"), 10, "boiler is good")
    return daemon, port


def names(answer):
    ret, _, size, _, data = answer
    assert ret == 0, ret
    assert len(data) == (size + 1 if size else 0)
    return data.rstrip(b"\0").decode().split(",") if data else []


def beside(scene):
    """A genuine owserver, and an owsd in front of it: two ports that shall answer the same."""
    server = scene.owserver(tester=["28", "29", "26", "10", "1D", "20"])
    daemon, port = served(scene, owsdtest.rio(server.target, []))
    until(lambda: ask(port, PRESENT, server.devices()[0])[0] == 0, 10, "the target is up")
    return server, daemon, port


def same(genuine, port, *arguments, **keys):
    want = ask(genuine.port, *arguments, **keys)
    have = ask(port, *arguments, **keys)
    assert have == want, f"{arguments} {keys}:\n have {have}\n want {want}"


def device(server, family):
    return next(d for d in server.devices() if d.startswith("/" + family))


def test_reads_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path in (t + "/temperature", t + "/type", t + "/address", t + "/power", t + "/alias",
                 s + "/sensed.BYTE", s + "/sensed.ALL", s + "/PIO.0", s + "/set_alarm",
                 "/uncached" + t + "/temperature", "/bus.0" + t + "/temperature",
                 "/structure/28/temperature", "/system/configuration/version",
                 "/bus.0/interface/settings/name", t.replace(".", "") + "/type",
                 t.lower() + "/type", t[1:] + "/type", device(server, "26") + "/B1-R1-A/pressure"):
        for kind in (READ, GET):
            same(server, port, kind, path)
            same(server, port, kind, path, flags=0x14A)
    for size, offset in ((5, 0), (12, 4), (12, 12), (65536, 0), (65537, 0), (0, 0), (-1, 0),
                         (2, 13), (12, -1), (0x7FFFFFFF, 0)):
        same(server, port, READ, t + "/temperature", size=size, offset=offset)


def test_scales_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    for path in (device(server, "28") + "/temperature", device(server, "28") + "/templow",
                 device(server, "29") + "/sensed.BYTE", device(server, "10") + "/temperature",
                 device(server, "26") + "/B1-R1-A/pressure"):
        for scale in range(4):
            for pressure in range(6):
                same(server, port, READ, path, flags=0x10A | scale << 16 | pressure << 18)
                same(server, port, READ, path, flags=0x14A | scale << 16 | pressure << 18)


def test_directories_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path in ("/bus.0", "/bus.0/", t, t + "/", s, t + "/errata", "/alarm", "/structure",
                 "/structure/28", "/structure/29", "/simultaneous", "/settings",
                 "/settings/units", "/statistics", "/statistics/cache", "/system",
                 "/system/process", "/uncached" + t, "/bus.0" + t, "/bus.0/interface",
                 "/bus.0/interface/settings", "/uncached/bus.0", "/bus.0/alarm", t[1:], "bus.0",
                 t.replace(".", ""), device(server, "26"), device(server, "1D")):
        for kind in (DIRALL, DIRALLSLASH, DIR, GET, GETSLASH):
            same(server, port, kind, path)
    for device_format in range(6):
        same(server, port, DIRALL, "/bus.0", flags=0x10A | device_format << 24)
        same(server, port, DIRALL, "/", flags=0x108 | device_format << 24)


def test_the_root_is_that_of_the_genuine_owserver_and_has_signals(scene):
    server, _, port = beside(scene)
    same(server, port, DIRALL, "/", flags=0x108)
    same(server, port, DIRALL, "/uncached", flags=0x108)
    want, have = names(ask(server.port, DIRALL, "/")), names(ask(port, DIRALL, "/"))
    assert have == want + ["/signals"], have
    want, have = names(ask(server.port, DIRALL, "/uncached")), names(ask(port, DIRALL, "/uncached"))
    assert have == want + ["/uncached/signals"], have


def test_errors_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    absent = "/28.AABBCCDDEEFF"
    for path in (absent, absent + "/temperature", t + "/nonsense", t, "/", "/nonsense", "",
                 t + "/temperature/", t + "/temperature.0", s + "/PIO", s + "/PIO.8",
                 s + "/PIO.A", t + "/temperature.ALL", "/99.112233445566/address", "/bus.9",
                 "/bus.9" + absent, "/" + t + "//address", "/structure", "/settings",
                 "/28.AABBCCDDEEFF77/temperature", t + "/", "/x" * 2000, s + "/LCD_M/message"):
        for kind in (READ, DIRALL, DIR, PRESENT, GET, GETSLASH, DIRALLSLASH):
            # of a target that is an owserver, a property that is none is as present as its device
            if kind != PRESENT or path.count("/") < 2 or path.startswith(absent):
                same(server, port, kind, path, flags=0x108)
    for path in (None, ""):
        for kind in (NOP, READ, DIRALL, DIR, PRESENT, GET):
            same(server, port, kind, path, flags=0x108)
    for kind in (0, 5, 11, 99, -1):
        same(server, port, kind, t + "/address")


def test_writes_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path, data in ((t + "/templow", b"10"), (t + "/templow", b"10.5"), (t + "/templow", b"abc"),
                       (t + "/templow", b"12abc"), (t + "/templow", b""),
                       (t + "/temperature", b"10"), (t + "/address", b"1"),
                       (t + "/nonsense", b"1"), ("/28.AABBCCDDEEFF/templow", b"1"), (t, b"1"),
                       (s + "/PIO.BYTE", b"255"), (s + "/PIO.0", b"1"), (s + "/PIO.0", b"yes"),
                       (s + "/PIO.0", b"maybe"), (s + "/PIO.ALL", b"1,0,1"), (s + "/PIO", b"1"),
                       ("/", b"1"),
                       ("/simultaneous/temperature", b"1"), ("/settings/timeout/volatile", b"15"),
                       ("/settings/timeout/nonsense", b"15")):
        same(server, port, WRITE, path, data)
    for scale in range(4):
        same(server, port, WRITE, t + "/templow", b"50", flags=0x10A | scale << 16)


if __name__ == "__main__":
    owsdtest.main()
