#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Frame by frame: the genuine owserver and owsd -l are asked the same, and answer the same."""

import re

import clients
import owsdtest
import peer
import served
from served import (ABSENT, ALIAS, BATTERY, BUS_LIST, DIR, DIRALL, DIRALLSLASH, ERROR, GET, GETSLASH,
                    KEY, LATCH, MEMORY, NOP, OWNET, PERSIST, PRESENT, READ, SIZE, SWITCH, THERMOMETER,
                    TRIM, UNCACHED, USUAL, WRITE, Closed)

T = THERMOMETER
PINS = "/3A.C99A66320DB7"


class Pair:
    """Both servers; what they answer differently is gathered."""

    def __init__(self, scene):
        self.genuine, self.ours = served.owserver(scene), served.owsd(scene)
        self.different = []
        self.count = 0

    def ask(self, *words, **how):
        def one(server):
            try:
                return server.frame(*words, **how)
            except Closed:
                return "closed"
        return one(self.genuine), one(self.ours)

    def equal(self, what, left, right):
        self.count += 1
        if left != right:
            self.different.append(f"{what}: genuine {str(left)[:400]}, ours {str(right)[:400]}")

    def same(self, *words, **how):
        """The whole answer."""
        left, right = self.ask(*words, **how)
        self.equal((words, how), left, right)

    def alike(self, *words, **how):
        """All but the data, which have the same shape: digits may differ."""
        def shape(frame):
            if isinstance(frame, str):
                return frame
            data = re.sub(rb" *-?[0-9.]+(E[-+][0-9]+)?",
                          lambda m: b"#%d" % (1 if len(m[0]) == 1 else len(m[0])), frame.data)
            return frame._replace(data=data)
        left, right = self.ask(*words, **how)
        self.equal((words, how), shape(left), shape(right))

    def raw(self, what, data):
        """Bytes of our own making: the frame, or closed."""
        def one(server):
            try:
                with server.connect() as s:
                    s.sendall(data)
                    return served.receive(s)
            except (Closed, ConnectionError):
                return "closed"
        self.equal(what, one(self.genuine), one(self.ours))

    def entries(self, path, flags=USUAL, drop=()):
        def one(server):
            frame = server.frame(DIRALL, path, flags=flags)
            names = sorted(frame.data.rstrip(b"\0").decode().split(","))
            return frame.ret, [n for n in names if not n.endswith(tuple(drop))] if drop else names
        self.equal(("DIRALL", path, hex(flags)), one(self.genuine), one(self.ours))

    def judge(self, at_least):
        assert not self.different, "\n".join([f"{len(self.different)} of {self.count} differ"] +
                                             self.different)
        assert self.count >= at_least, self.count


def test_texts_and_numbers(scene):
    pair = Pair(scene)
    for device in served.DEVICES:
        for name in ("address", "alias", "crc8", "family", "id", "r_address", "r_id", "type"):
            if (device, name) != (KEY, "type"):  # mock gives the key no name of its own
                pair.same(READ, f"{device}/{name}")
    for flags in (USUAL, USUAL | TRIM, 0, PERSIST):
        for path in (T + "/temperature", T + "/templow", BATTERY + "/VDD", LATCH + "/PIO"):
            pair.same(READ, path, flags=flags)
    for path in (T + "/temperature12", T + "/power", BATTERY + "/temperature", SWITCH + "/PIO.ALL",
                 SWITCH + "/PIO.BYTE", SWITCH + "/sensed.3", SWITCH + "/set_alarm", "/uncached" + T +
                 "/temperature", "/20.051758E95ED4/volt.ALL", "/1D.3158A35A255D/counters.ALL",
                 "/12.765A2E63339F/PIO.ALL", PINS + "/sensed.BYTE"):
        pair.alike(READ, path)
    pair.alike(READ, T + "/temperature", flags=USUAL | UNCACHED)
    for scale in range(4):
        for path in ("/temperature", "/templow"):
            pair.same(READ, T + path, flags=USUAL | scale << 16)
    for path in ("28.67C6697351FF/type", "/2867C6697351FF/type", "/28.67c6697351ff/type",
                 "/28.67C6697351FF.68/type", "/2867C6697351FF68/type", "/28.67C6697351FF.69/type",
                 "/alarm" + T + "/type", "/bus.0" + T + "/type", "/uncached/bus.0" + T + "/type",
                 "/bus.0/uncached" + T + "/type", "/uncached/alarm" + T + "/type"):
        pair.same(READ, path)
    pair.judge(100)


def test_offset_and_size(scene):
    pair = Pair(scene)
    for size in (5, 12, 13, 65536, 65537, 1, 0, -1):
        pair.same(READ, T + "/temperature", size=size)
    for offset in (0, 4, 11, 12, 13, 100):
        pair.same(READ, T + "/temperature", size=12, offset=offset)
        pair.same(READ, T + "/address", size=4, offset=offset)
    pair.alike(READ, SWITCH + "/sensed.ALL", size=15)  # less is an error of simulated buses alone
    pair.judge(20)


def test_errors(scene):
    pair = Pair(scene)
    for path in (ABSENT + "/temperature", "/28.AABBCCDDEEFF77/temperature", T + "/nonsense", T, "/",
                 "/nonsense", "", T + "/temperature/", T + "/temperature.0", SWITCH + "/PIO",
                 SWITCH + "/PIO.8", SWITCH + "/PIO.A", T + "/temperature.ALL", SWITCH + "/pio.0",
                 "/99.112233445566/address", "/bus.9" + T + "/type", "/" + T + "/type",
                 "/bus.0", "/structure", "/structure/28", "/settings", "/settings/nothing", "/alarm",
                 "/uncached", "/simultaneous", "/statistics", "/system", "/" + "x" * 5000):
        for kind in (READ, DIRALL, GET, PRESENT):
            if kind == READ or path not in ("/", "", "/bus.0", "/alarm", "/uncached") and \
                    not path.startswith(("/s", T)):
                # a directory below a property of nothing: -20 of ours, nobody is asked for it
                if kind != DIRALL or path not in (ABSENT + "/temperature",
                                                  "/99.112233445566/address"):
                    pair.same(kind, path)
    for path in (T, T + "/type", T + "/nonsense", ABSENT, "/nonsense", "/"):
        pair.same(PRESENT, path)
    for kind in (DIR, DIRALL, DIRALLSLASH):
        pair.same(kind, T + "/temperature")
    for kind in (ERROR, SIZE, 11, 99, -1):
        pair.same(kind, T + "/type")
    pair.same(NOP, None)
    pair.same(NOP, T)
    pair.judge(60)


def test_writes(scene):
    pair = Pair(scene)
    for path, texts in (
            (T + "/templow", ("10", "abc", "", " 11", "12 ", "-3")),
            (T + "/nonsense", ("10",)), (ABSENT + "/templow", ("10",)), (T, ("10",)),
            (SWITCH + "/PIO.BYTE", ("255", "99999999999999999999999", "0")),
            # of a chip that is no output of the table
            (PINS + "/PIO.A", ("1", "yes", "on", "maybe", "0", "no")),
            (PINS + "/PIO.ALL", ("1,0", "1", "0,0")),
            (SWITCH + "/PIO", ("1",)), (SWITCH + "/sensed.BYTE", ("1",)),
            (SWITCH + "/latch.BYTE", ("1",)), (SWITCH + "/set_alarm", ("111111111", "0")),
            (T + "/alias", ("bus.0", "a/b", "boiler", "")), ("/simultaneous/temperature", ("1", "0")),
            ("/nonsense", ("1",)), ("/", ("1",)), ("/settings/timeout/nonsense", ("1",)),
            ("/settings/units/temperature_scale", ("C",)), ("/structure/28/temperature", ("1",))):
        for text in texts:
            pair.same(WRITE, path, data=text.encode())
    # the end of a line or of a string is none of a value, and blanks before it are not of an alias
    for path, value in ((T + "/alias", b"  kitchen"), (T + "/templow", b"1"),
                        (PINS + "/PIO.A", b"1"), ("/settings/units/pressure_scale", b"mbar"),
                        ("/settings/timeout/ftp", b"1")):
        for end in (b"\0", b"\r\n", b" "):
            pair.same(WRITE, path, data=value + end)
    pair.same(WRITE, T + "/templow", data=b"10", size=1)
    pair.same(WRITE, T + "/templow", data=b"10", size=0)
    pair.same(WRITE, MEMORY + "/pages/page.0", data=b"hello")
    pair.judge(40)
    # What is no value of its property is refused, where owserver takes its beginning, or any bit of it
    for path, text in ((T + "/templow", b"12abc"), (PINS + "/PIO.A", b"7"),
                       (PINS + "/PIO.ALL", b"1,0,1")):
        assert pair.genuine.frame(WRITE, path, data=text).ret == 0
        assert pair.ours.frame(WRITE, path, data=text).ret == -22
    # A number that does not fit is refused, and not cut to its lowest byte
    for text in (b"-1", b"256"):
        assert pair.ours.frame(WRITE, SWITCH + "/PIO.BYTE", data=text).ret == -34


def test_directories(scene):
    pair = Pair(scene)
    for flags in (USUAL, OWNET, ALIAS, 0):
        pair.entries("/", flags, drop=() if not flags & BUS_LIST else ("/signals",))
    for format in range(6):
        pair.entries("/bus.0", USUAL | format << 24, drop=("/bus.0/interface",))
        pair.entries("/", OWNET | format << 24)
    for device in served.DEVICES:
        pair.entries(device)
        pair.entries("/uncached" + device)
    for path in ("/settings/units", "/settings/alias", "/settings/timeout", "/system",
                 "/settings/return_codes", "/system/process", "/structure/28",
                 "/bus.0" + T, "/bus.0/interface", T + "/errata", "/text" + T,
                 "/text/settings/units"):
        pair.entries(path)
    # the TMP1826 has that family code too, and owserver knows nothing of it
    pair.entries("/structure/26", drop=["/" + name for name in (
        "alert_high", "alert_low", "memory", "power", "temphigh", "templow", "tempoffset", "tempres")])
    for path in ("/text", "/json/uncached", "/uncached/text"):
        pair.entries(path, drop=("/signals",))
    # What docs/properties.md says is not there
    pair.entries("/statistics", drop=("/return_codes", "/cache", "/directory", "/threads"))
    pair.entries("/simultaneous", drop=("/iblss",))
    for path in (T, T + "/errata", "/settings/units"):
        for kind in (DIRALLSLASH, GETSLASH, GET, DIRALL):
            pair.same(kind, path)
    pair.judge(60)


def test_the_flags_of_a_directory(scene):
    """The offset of the last frame says what kinds of devices are there."""
    pair = Pair(scene)
    for path in ("/", "/bus.0", T, "/settings"):
        pair.equal(("DIR", path), *(server.listing(path)[1]._replace(flags=0)
                                    for server in (pair.genuine, pair.ours)))
        pair.equal(("DIRALL", path), *(server.frame(DIRALL, path).offset
                                       for server in (pair.genuine, pair.ours)))
    for path in ("/settings/units", T):
        pair.equal(("DIR entries", path), *(server.listing(path)[0]
                                            for server in (pair.genuine, pair.ours)))
    pair.judge(10)


def test_the_directories_beside_the_devices_are_read(scene):
    pair = Pair(scene)
    for path in ("/settings/units/temperature_scale", "/settings/units/pressure_scale",
                 "/settings/alias/list", "/settings/alias/unaliased", "/system/process/pidfile",
                 "/system/connections/nothing", "/structure/28/temperature", "/structure/29/PIO.ALL",
                 "/structure/28/type", "/structure/26/VDD", "/system/configuration/trim"):
        pair.same(READ, path)
    for name in ("directory", "ftp", "ha7", "network", "serial", "server", "usb", "w1", "stable",
                 "uncached"):  # with owserver's defaults
        pair.same(READ, "/settings/timeout/" + name)
    for name in ("directory", "ftp", "ha7", "network", "serial", "server", "usb", "w1"):
        for text in (b"17", b"abc", b"", b"90000"):
            pair.same(WRITE, "/settings/timeout/" + name, data=text)
            pair.same(READ, "/settings/timeout/" + name)
        # what is no whole number is none, where owserver takes its beginning
        assert pair.ours.frame(WRITE, "/settings/timeout/" + name, data=b"1.5").ret == -22
        pair.same(READ, "/settings/timeout/" + name)
    for path in ("/settings/timeout/volatile", "/settings/timeout/presence", "/system/process/pid",
                 "/system/connections/count_current_buses",
                 "/statistics/read/calls", "/statistics/write/calls",
                 "/simultaneous/temperature", "/simultaneous/present"):
        pair.alike(READ, path)
    for flags in (USUAL | 1 << 16, USUAL | 3 << 16, USUAL | 1 << 18):
        pair.same(READ, "/settings/units/temperature_scale", flags=flags)
        pair.same(READ, "/settings/units/pressure_scale", flags=flags)
    pair.judge(25)
    for server in (pair.genuine, pair.ours):  # each in its own words
        texts = server.frame(READ, "/settings/return_codes/text.ALL").data.split(b",")
        assert len(texts) == 211, texts
        assert server.frame(READ, "/settings/return_codes/text.19").data == texts[19] != b""


def test_odd_frames(scene):
    pair = Pair(scene)
    path = (T + "/type").encode()
    header = served.header
    pair.raw("READ without payload", header(READ, 0, size=100))
    pair.raw("READ, path without NUL", header(READ, len(path), size=100) + path)
    pair.raw("version 1", header(READ, len(path) + 1, size=100, version=1) + path + b"\0")
    pair.raw("a foreign token", header(READ, len(path) + 1, size=100, version=0x10001) + path + b"\0" +
             bytes(range(16)))
    pair.raw("a negative payload", header(READ, -5, size=100))
    pair.raw("65535 tokens", header(READ, len(path) + 1, size=100, version=0x1FFFF) + path + b"\0")
    pair.raw("more data to write than there are",
             header(WRITE, len(T) + 11, size=500) + T.encode() + b"/templow\x0012")
    for text, size in ((b"/templow-9", 2), (b"/templow\x0012", 3), (b"/templow", 0),
                       (b"/templow11", 0)):
        pair.raw(f"WRITE without NUL, {text}, {size}",
                 header(WRITE, len(T) + len(text), size=size) + T.encode() + text)
        pair.same(READ, T + "/templow")
    pair.raw("HTTP", b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
    pair.raw("a huge payload", header(READ, 200000, size=100))
    pair.raw("a huge size", header(READ, len(path) + 1, size=0x7fffffff) + path + b"\0")
    pair.judge(10)


def test_a_connection_persists_when_asked_to(scene):
    for server in (served.owserver(scene), served.owsd(scene)):
        with server.connect() as s:
            for _ in range(3):
                for kind, path in ((READ, T + "/type"), (NOP, None), (READ, ABSENT + "/type"),
                                   (PRESENT, T), (DIRALL, T)):
                    s.sendall(served.request(kind, path, flags=USUAL | PERSIST))
                    assert served.receive(s).flags & PERSIST, (server.genuine, kind, path)
            s.sendall(served.request(READ, T + "/type"))
            frame = served.receive(s)
            assert frame.data == b"DS18B20" and not frame.flags & PERSIST
            assert s.recv(1) == b"", "closed after a request that does not ask to persist"


def test_requests_in_one_piece_are_answered_in_their_order(scene):
    names = ("type", "family", "id", "address", "crc8") * 5
    for server in (served.owserver(scene), served.owsd(scene)):
        alone = [server.frame(READ, f"{T}/{name}").data for name in names]
        with server.connect() as s:
            s.sendall(b"".join(served.request(READ, f"{T}/{name}", flags=USUAL | PERSIST)
                               for name in names))
            assert [served.receive(s).data for _ in names] == alone


def test_the_last_answer_comes_whole_whatever_was_sent_behind_its_request(scene):
    server = served.owsd(scene)
    last = served.request(READ, T + "/type")
    for behind in (b"", last, b"\0" * 5000):
        for _ in range(20):
            with server.connect() as s:
                s.sendall(last + behind)
                assert served.receive(s).data == b"DS18B20", behind
                try:
                    assert s.recv(1) == b"", behind
                except ConnectionResetError:
                    assert behind


def test_a_request_may_come_byte_by_byte(scene):
    for server in (served.owserver(scene), served.owsd(scene)):
        with server.connect() as s:
            for byte in served.request(READ, T + "/type"):
                s.sendall(bytes([byte]))
            assert served.receive(s).data == b"DS18B20"


def test_a_slow_answer_is_announced_by_keep_alives(scene):
    """owread gives a silent server up after two seconds."""
    path, other = (f"/28.AABBCCDDEEFF/{name}" for name in ("temperature", "type"))
    with peer.Peer({path: "     21.5", other: "DS18B20"}) as behind:
        server = served.owsd_of(scene, behind.target, items=[])
        owsdtest.until(lambda: server.frame(READ, other).ret > 0, 20, "the peer is read")
        behind.mode = "slow 3.5"
        with server.connect() as s:
            pings = [0]
            s.sendall(served.request(READ, path))
            frame = served.receive(s, pings)
            assert frame.ret > 0 and float(frame.data) == 21.5, frame
            assert pings[0] >= 1
        assert float(clients.Shell(scene, server).read(path)) == 21.5


if __name__ == "__main__":
    owsdtest.main(at_once=4)
