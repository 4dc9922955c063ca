#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd ends, dies, or is removed: no program beside it spins, and each finds the next one soon. A
broker and a database that were away are found soon, too; nobody spins for them, nor for peers that
hang up."""

import contextlib
import os
import pathlib
import re
import socket
import subprocess
import sys
import time

import mqtthouse
import owsdtest
import recorded
import webhouse
import ows
from owsdtest import BUILD, OWSCTL, SOURCE, free_port, raw, segment, until

POLLER = BUILD / "system" / "poller"
SENSOR = "/28.A0B1C2000001"
# A part of one processor, and how long it is looked at
IDLE, LOOK = 0.005, 4
FOUND = 2
# It keeps its watch of the descriptor while it lives, where follow.py takes it away between two waits
KEEPER = """
import asyncio, sys, ows

signals = ows.Ows(sys.argv[1])
look = signals.changes(0)

def news():
    signals.fileno()
    try:
        if next(look):
            print(flush=True)
            loop.call_soon(news)
    except ows.Stale:
        try:
            signals.reopen()
            loop.call_soon(news)
        except OSError:
            pass

loop = asyncio.new_event_loop()
loop.add_reader(signals.fileno(), news)
loop.run_forever()
"""


def text(scene, port, databases):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n")
    return owsdtest.rio(
        f"sim:{wire}", [dict(Name="room", Path=SENSOR + "/temperature", Type=raw("double"), IO=raw("input"))],
        Period=0.1, Timeout=3, Recorder=raw("{ Flush 1 }"), Web=raw("{ Write off }"),
        Mqtt=raw(f'{{ Broker "mqtt://127.0.0.1:{port}" Node "pi7" }}'),
        Influx=raw(f'{{ Url "http://127.0.0.1:{databases}/write" Every 1 ClockWait 0 }}'))


class Beside:
    """All that can run beside an owsd, each with what it has found of it."""

    def __init__(self, scene):
        self.scene, port = scene, free_port()
        mqtthouse.Broker(scene, port)
        self.text = text(scene, port, free_port())
        self.daemon = daemon = scene.owsd(self.text)
        self.name, python = daemon.name, {"PYTHONPATH": str(owsdtest.PYTHON)}
        writer = owsdtest.with_sim(BUILD / "owsd-writer", daemon.config, cwd=scene.path)
        keeper = scene.file("keeper.py", KEEPER)
        self.programs = {
            "owsd-recorder": recorded.record(scene, daemon),
            "owsd-web": webhouse.serve(scene, daemon),
            "owsd-mqtt": self.face("owsd-mqtt"),
            "owsd-influx": self.face("owsd-influx"),
            "owsd-writer": scene.start([writer, "-n", self.name, "-c", daemon.config]),
            "owsctl": scene.start([OWSCTL, "-n", self.name, "watch", "-l"]),
            "poller": scene.start([POLLER, self.name]),
            "follow.py": scene.start([sys.executable, SOURCE / "docs/examples/follow.py", self.name], python),
            "keeper.py": scene.start([sys.executable, keeper, self.name], python),
        }

    def face(self, program, *options):
        owsdtest.need(BUILD / program)
        return self.scene.start([BUILD / program, "-n", self.name, "-c", self.daemon.config, *options])

    def connected(self):
        """The programs that owsd has."""
        with contextlib.suppress(OSError), ows.Ows(self.name) as signals:
            return {controller.who.name for controller in signals.controllers()}
        return set()

    def lines(self):
        return {name: len(program.log().splitlines()) for name, program in self.programs.items()}

    def missing(self, before):
        """Those that have not found owsd: they are not connected, or print nothing of it."""
        connected, lines = self.connected(), self.lines()
        by_lines = {name for name in ("owsctl", "poller", "follow.py", "keeper.py") if lines[name] <= before[name]}
        return (set(self.programs) - {"owsd-writer", "owsctl"} - connected) | by_lines

    def all_there(self, before):
        until(lambda: not self.missing(before), 20, lambda: f"all find owsd: {self.missing(before)}", step=0.05)

    def start_again(self):
        """It is looked at from the moment that it is ready."""
        self.daemon = self.scene.owsd(self.daemon.config, name=self.name)


def spent(pid):
    """Processor time of all its threads, in seconds."""
    total = 0
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        with contextlib.suppress(FileNotFoundError):
            total += int((task / "schedstat").read_text().split()[0])
    return total / 1e9


def parts(beside):
    """What part of a processor each takes."""
    before = {name: spent(program.pid) for name, program in beside.programs.items()}
    begun = time.monotonic()
    time.sleep(LOOK)  # this is measured
    passed = time.monotonic() - begun
    return {name: (spent(program.pid) - before[name]) / passed for name, program in beside.programs.items()}


def nobody_spins(beside):
    time.sleep(5)  # what is done once, at the loss, is over
    found = parts(beside)
    assert not [name for name, program in beside.programs.items() if not program.running()]
    assert max(found.values()) <= IDLE, found


def judge(beside, end):
    beside.all_there(dict.fromkeys(beside.programs, 0))
    end()
    nobody_spins(beside)
    before = beside.lines()
    beside.start_again()
    begun = time.monotonic()
    beside.all_there(before)
    took = time.monotonic() - begun
    assert took <= FOUND * max(1, os.getloadavg()[0] / os.cpu_count()), took


def test_beside_an_owsd_that_was_stopped_no_program_spins(scene):
    beside = Beside(scene)
    judge(beside, lambda: beside.daemon.stop())


def test_beside_an_owsd_that_was_killed_no_program_spins(scene):
    beside = Beside(scene)
    judge(beside, lambda: beside.daemon.kill())


def test_beside_an_owsd_that_was_removed_no_program_spins(scene):
    beside = Beside(scene)

    def remove():
        beside.daemon.kill()
        for path in owsdtest.place().glob(f"{beside.name}.*"):
            path.unlink()
    judge(beside, remove)


def test_beside_an_owsd_that_hangs_no_program_spins(scene):
    beside = Beside(scene)
    beside.all_there(dict.fromkeys(beside.programs, 0))
    beside.daemon.freeze()
    nobody_spins(beside)
    before = beside.lines()
    beside.daemon.thaw()
    beside.all_there(before)


def reach(kind, place):
    peer = socket.socket(socket.AF_INET if isinstance(place, tuple) else socket.AF_UNIX, kind)
    peer.connect(place)
    return peer


def test_beside_peers_that_hang_up_half_or_say_half_a_word_no_program_spins(scene):
    beside = Beside(scene)
    beside.all_there(dict.fromkeys(beside.programs, 0))
    page, served = ("127.0.0.1", beside.programs["owsd-web"].port), str(segment(beside.name, "sock"))
    host = f"Host: 127.0.0.1:{page[1]}\r\n"
    words = [(page, b""), (page, b"GET / HTT"), (page, f"GET /api/info HTTP/1.1\r\n{host}\r\n".encode()),
             (page, f"GET /api/events HTTP/1.1\r\n{host}\r\n".encode()),
             (page, f"GET /api/signals HTTP/1.1\r\n{host}\r\n".encode() * 50),
             (str(segment(beside.name, "web")), b"GET / HTT"), (served, b""), (served, b"\0\0\0\0\0\0"),
             (str(segment(beside.name, "config")), b"")]
    peers = []
    for place, word in words:
        for half in (socket.SHUT_WR, socket.SHUT_RD, None):
            with contextlib.suppress(ConnectionRefusedError, BrokenPipeError):
                peer = reach(socket.SOCK_STREAM, place)
                if word:
                    peer.sendall(word)
                if half is not None:
                    peer.shutdown(half)
                peers.append(peer)
    control = reach(socket.SOCK_SEQPACKET, str(segment(beside.name, "control")))
    control.shutdown(socket.SHUT_WR)
    time.sleep(2)  # what is answered at once is over
    watched = {**{name: program.pid for name, program in beside.programs.items()}, "owsd": beside.daemon.pid}
    before = {name: spent(pid) for name, pid in watched.items()}
    time.sleep(LOOK)  # this is measured
    found = {name: (spent(pid) - before[name]) / LOOK for name, pid in watched.items()}
    # owsd reads its plant meanwhile
    assert max(found.values()) <= 10 * IDLE, found
    assert len(peers) > 20
    for peer in (*peers, control):
        peer.close()


def test_a_program_whose_output_nobody_reads_any_more_does_not_spin(scene):
    beside = Beside(scene)
    beside.all_there(dict.fromkeys(beside.programs, 0))
    read, write = os.pipe()
    mute = [subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=write, stderr=write)
            for command in ([BUILD / "owsd-recorder", "-n", beside.name, "-c", beside.daemon.config, "-d", scene.path / "other"],
                            [BUILD / "owsd-mqtt", "-n", beside.name, "-c", beside.daemon.config],
                            [OWSCTL, "-n", beside.name, "watch", "-l"])]
    try:
        os.close(write)
        os.set_blocking(read, False)
        said = []

        def logged():
            with contextlib.suppress(BlockingIOError):
                said.append(os.read(read, 65536))
            return re.search(rb"owsd-mqtt \d+\.\d+\.\d+: ", b"".join(said))
        until(logged, 20, "they log")
        os.close(read)
        beside.daemon.stop()  # which all log
        time.sleep(5)  # what is done once, at the loss, is over
        alive = [program for program in mute if program.poll() is None]
        assert len(alive) >= 2, mute
        before = {program.pid: spent(program.pid) for program in alive}
        time.sleep(LOOK)  # this is measured
        found = {program.pid: (spent(program.pid) - before[program.pid]) / LOOK for program in alive}
        assert max(found.values(), default=0) <= IDLE, found
    finally:
        for program in mute:
            program.kill()
            program.wait()


def test_a_broker_and_a_database_that_were_away_for_a_minute_are_found_within_15_seconds(scene):
    port, databases = free_port(), free_port()
    broker = mqtthouse.Broker(scene, port)
    database = socket.create_server(("127.0.0.1", databases))
    daemon = scene.owsd(text(scene, port, databases))
    faces = {}
    for n in range(4):
        config = scene.file(f"house{n}.rio", daemon.config.read_text().replace('"pi7"', f'"pi{n}"'))
        for program in ("owsd-mqtt", "owsd-influx"):
            faces[program, n] = scene.start([BUILD / program, "-n", daemon.name, "-c", config], {"no_proxy": "*"})

    def back():
        return sum(faces["owsd-mqtt", n].log().count("connected to") > 1 for n in range(4))

    until(lambda: all(faces["owsd-mqtt", n].log().count("connected to") for n in range(4)), 30, "all are connected")
    broker.process.kill()
    database.close()
    begun, spent_before = time.monotonic(), {key: spent(face.pid) for key, face in faces.items()}
    time.sleep(62)  # so long that a step that doubles is a minute
    passed = time.monotonic() - begun
    shares = {key: (spent(face.pid) - spent_before[key]) / passed for key, face in faces.items()}
    assert max(shares.values()) <= 2 * IDLE, shares  # owsd lives, and has changes
    broker.start()
    database = socket.create_server(("127.0.0.1", databases))
    database.settimeout(15 + 3)
    begun = time.monotonic()
    # each keeps its connection, as it gets no answer
    connections = [database.accept()[0] for _ in range(4)]
    until(lambda: back() == 4, 20, lambda: f"all are back: {back()}")
    took = time.monotonic() - begun
    assert took <= 15 * max(1, os.getloadavg()[0] / os.cpu_count() / 4), took
    for connection in connections:
        connection.close()
    database.close()


if __name__ == "__main__":
    owsdtest.main()
