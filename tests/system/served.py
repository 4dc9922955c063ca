# SPDX-License-Identifier: MIT
"""The same 1-Wire network behind two servers of the owserver protocol: the genuine owserver and
owsd. What a client is told by the one it must be told by the other.

    server = served.start(scene, "owserver")       or "owsd"
    server.target, server.host, server.port, server.genuine
    server.frame(served.READ, served.THERMOMETER + "/type")

The devices are those that owserver makes for `mock` in this order; mock keeps what is written to
most scalars, so start() gives the thermometer its 21.5 degrees there as sim has them.
"""

import collections
import socket
import struct

import owsdtest

ERROR, NOP, READ, WRITE, DIR, SIZE, PRESENT, DIRALL, GET, DIRALLSLASH, GETSLASH = range(11)
BUS_LIST, PERSIST, ALIAS, UNCACHED, TRIM, OWNET = 0x2, 0x4, 0x8, 0x20, 0x40, 0x100
USUAL = OWNET | ALIAS | BUS_LIST

THERMOMETER, BATTERY, SWITCH = "/28.67C6697351FF", "/26.4AEC29CDBAAB", "/29.F2FBE3467CC2"
OLD, MEMORY, LATCH, KEY = ("/10.54F81BE8E78D", "/2D.ABB2CDC69BB4", "/05.54110E827441",
                           "/01.213DDC8770E9")
DEVICES = sorted((THERMOMETER, BATTERY, SWITCH, OLD, "/12.765A2E63339F", "/3A.C99A66320DB7",
                  "/1D.3158A35A255D", "/20.051758E95ED4", MEMORY, LATCH, KEY))
FAMILIES = "28 26 29 10 12 3A 1D 20 2D 05 01".split()
ABSENT = "/28.AABBCCDDEEFF"

WIRE = """i2c speed 400 combine any
chip DS2482-100 0x18
DS18B20 28.67C6697351FF as thermometer temperature 21.5
DS2438 26.4AEC29CDBAAB as battery temperature 22 vdd 5 vad 2.3
DS2408 29.F2FBE3467CC2 as switch
DS18S20 10.54F81BE8E78D as old temperature 12.5
DS2406 12.765A2E63339F as pair
DS2413 3A.C99A66320DB7 as two
DS2423 1D.3158A35A255D as counter
DS2450 20.051758E95ED4 as volts
DS2431 2D.ABB2CDC69BB4 as memory
DS2405 05.54110E827441 as latch
DS2401 01.213DDC8770E9 as key
"""
SIGNALS = [
    dict(Name="room1", Path=f"{THERMOMETER}/temperature12", Type="double", IO="input"),
    dict(Name="relays", Path=f"{SWITCH}/PIO.BYTE", Type="byte", IO="output", InitValue=0),
]

Frame = collections.namedtuple("Frame", "version payload ret flags size offset data")


class Closed(Exception):
    """The server closed the connection instead of answering."""


def exactly(s, n):
    data = b""
    while len(data) < n:
        try:
            more = s.recv(n - len(data))
        except ConnectionError:
            more = b""
        if not more:
            raise Closed(f"after {len(data)} of {n} bytes")
        data += more
    return data


def header(kind, payload, flags=USUAL, size=0, offset=0, version=0):
    return struct.pack(">6i", version, payload, kind, flags, size, offset)


def request(kind, path="", flags=USUAL, data=b"", size=None, offset=0):
    body = (b"" if path is None else path.encode() + b"\0") + data
    if size is None:
        size = len(data) if kind == WRITE else 65536 if kind in (READ, GET, GETSLASH) else 0
    return header(kind, len(body), flags, size, offset) + body


def receive(s, pings=None):
    """The next frame that is no keep-alive; those are counted in pings[0]."""
    while True:
        words = struct.unpack(">6i", exactly(s, 24))
        if words[1] >= 0:
            return Frame(*words, exactly(s, words[1]))
        if pings:
            pings[0] += 1


class Server:
    """Where a server listens, and what one frame is answered with."""

    def __init__(self, program, host, port, genuine):
        self.program, self.host, self.port, self.genuine = program, host, port, genuine
        self.target = f"{host}:{port}"

    def connect(self, seconds=owsdtest.PATIENCE):
        s = socket.create_connection((self.host, self.port), timeout=seconds)
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return s

    def frame(self, kind, path="", **how):
        with self.connect() as s:
            s.sendall(request(kind, path, **how))
            return receive(s)

    def entries(self, path, flags=USUAL, kind=DIRALL):
        frame = self.frame(kind, path, flags=flags)
        assert frame.ret == 0, (path, frame)
        return sorted(e for e in frame.data.rstrip(b"\0").decode().split(",") if e)

    def has(self, devices):
        """It answers, and has all these devices."""
        frame = self.frame(DIRALL, "/")
        return frame.ret == 0 and set(devices) <= set(frame.data.rstrip(b"\0").decode().split(","))

    def listing(self, path, flags=USUAL):
        """By DIR: a frame for each entry; the entries and the last frame."""
        entries = []
        with self.connect() as s:
            s.sendall(request(DIR, path, flags=flags))
            while (frame := receive(s)).payload:
                entries.append(frame.data.rstrip(b"\0").decode())
        return sorted(entries), frame

    def answers(self):
        try:
            return self.frame(NOP, None).ret == 0
        except (OSError, Closed):
            return False


def owserver(scene, *options, families=FAMILIES):
    program = scene.owserver(mock=families, options=options)
    for path, value in ((THERMOMETER + "/temperature", "21.5"), (LATCH + "/PIO", "0"),
                        (THERMOMETER + "/templow", "10"), (THERMOMETER + "/temphigh", "30"),
                        (BATTERY + "/VDD", "5"), (BATTERY + "/VAD", "2.3")):
        program.write(path, value)
    return Server(program, program.host, program.port, True)


def owserver_of(scene, wire):
    """The genuine owserver with the wire of that scenario, behind a serial port (serial.c)."""
    serial = scene.start([owsdtest.BUILD / "system/serial", wire])
    owsdtest.until(lambda: serial.log().endswith("\n"), 10, "the serial port")
    program = scene.owserver(options=[f"--passive={serial.log().strip()}"])
    return Server(program, program.host, program.port, True)


def owsd_of(scene, target, *options, items=SIGNALS, **driver):
    """owsd -l on any target, as soon as it answers."""
    for _attempt in range(5):
        port = owsdtest.free_port()
        daemon = scene.owsd(owsdtest.rio(target, items, **driver), "-l", f"127.0.0.1:{port}",
                            *options, ready=False)
        server = Server(daemon, "127.0.0.1", port, False)
        owsdtest.until(lambda: server.answers() or not daemon.running(), 20, "owsd serves")
        if daemon.running():
            return server
        owsdtest.logged(daemon, "in use")
    raise AssertionError("no free port")


def owsd(scene, *options, limits=True, **driver):
    """The same network as owserver() makes, simulated by owsd."""
    server = owsd_of(scene, f"sim:{scene.file('served.sim', WIRE)}", *options, **driver)
    owsdtest.until(lambda: server.has(DEVICES), 20, "all devices are there")
    if not limits:
        return server
    for path, value in ((THERMOMETER + "/templow", b"10"), (THERMOMETER + "/temphigh", b"30")):
        assert server.frame(WRITE, path, data=value).ret == 0, path
    return server


STARTS = {"owserver": owserver, "owsd": owsd}


def start(scene, which):
    return STARTS[which](scene)
