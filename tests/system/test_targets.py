#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several targets: different wires in one table, several ways to one wire, and auto."""

import itertools
import json
import os
import signal
import socket
import threading
import time

import owsdtest
import peer
from owsdtest import raw, until

import ows  # of owsdtest.PYTHON

GOOD = 0xC0
ONE, TWO, BOTH = "/28.A0B1C2000001", "/28.A0B1C2000002", "/28.A0B1C2000003"
RELAY = "/29.A0B1C2000004"


def listed(scene, daemon):
    done = scene.owsctl(daemon, "--json", "list")
    assert done.returncode == 0, done.stderr
    return {s["name"]: s for s in json.loads(done.stdout)}


def served(scene, daemon, name, target):
    """The value of the signal if it is good and from the target."""
    s = listed(scene, daemon)[name]
    return s["value"] if s["good"] and s["target"] == target else None


def targets(scene, daemon):
    done = scene.owsctl(daemon, "--json", "stats")
    assert done.returncode == 0, done.stderr
    return {t["name"]: t for t in json.loads(done.stdout)["targets"]}


def states(scene, daemon):
    return [t["state"] for t in targets(scene, daemon).values()]


def wire(scene, name, *devices):
    """A simulated wire as a target."""
    lines = ["chip DS2482-100 0x18", *devices]
    return f"sim:{scene.file(name, chr(10).join(lines) + chr(10))}"


def table(target, items, **driver):
    """Inputs by name: path; a name that ends with _out is a byte output."""
    rows = [dict(Name=name, Path=path, Type=raw("byte"), IO=raw("output"))
            if name.endswith("_out") else
            dict(Name=name, Path=path, Type=raw("double"), IO=raw("input"))
            for name, path in items.items()]
    return owsdtest.rio(target, rows, **{"Timeout": 6, "Period": 0.05, "MaxRetries": 1, **driver})


def test_two_wires_are_one_table(scene):
    a = wire(scene, "a.sim", "DS18B20 28.A0B1C2000001 temperature 21",
             "DS18B20 28.A0B1C2000003 temperature 23")
    b = wire(scene, "b.sim", "DS18B20 28.A0B1C2000002 temperature 22",
             "DS18B20 28.A0B1C2000003 temperature 33", "DS2408 29.A0B1C2000004")
    daemon = scene.owsd(table(f"{a}, {b}", {
        "one": ONE + "/temperature", "two": TWO + "/temperature", "both": BOTH + "/temperature",
        "relay_out": RELAY + "/PIO.BYTE", "pins": RELAY + "/sensed.BYTE"}))
    until(lambda: served(scene, daemon, "one", a) == 21, 10, "the first wire's")
    until(lambda: served(scene, daemon, "two", b) == 22, 20, "the second wire's")
    until(lambda: served(scene, daemon, "both", a) == 23, 10, "the first that has it")
    assert scene.owsctl(daemon, "set", "-w", "60", "relay_out", "5").returncode == 0
    until(lambda: served(scene, daemon, "pins", b) == 0xFA, 10, "an output of the second wire")
    shown = targets(scene, daemon)
    assert [shown[t]["wire"] for t in (a, b)] == [0, 1], shown
    until(lambda: states(scene, daemon) == ["up", "up"], 10)
    until(lambda: [targets(scene, daemon)[t]["signals"] for t in (a, b)] == [2, 3], 10)

    def threads():
        try:
            return {open(f"/proc/{daemon.pid}/task/{t}/comm").read().strip()
                    for t in os.listdir(f"/proc/{daemon.pid}/task")}
        except (FileNotFoundError, ProcessLookupError):  # one has just ended
            return set()
    until(lambda: {"owsd-engine", "owsd-bus0", "owsd-bus1"} <= threads(), 5, threads)
    assert scene.owsctl(daemon, "stats").stdout.count("search_passes of sim:") == 2


def test_sixty_four_wires_are_one_table(scene):
    wires = [wire(scene, f"{n}.sim", f"DS18B20 28.A0B1C20001{n:02X} temperature {n}") for n in range(64)]
    paths = {f"t{n}": f"/28.A0B1C20001{n:02X}/temperature" for n in range(64)}
    daemon = scene.owsd(table(", ".join(wires), paths))

    def others():
        shown = listed(scene, daemon)
        return {name: s for n, (name, s) in enumerate(shown.items())
                if not s["good"] or s["value"] != n or s["target"] != wires[n]}
    # rarely asked, as each time costs a machine with sanitizers more than owsd needs
    until(lambda: not others(), 120, lambda: str(others())[:2000], step=0.5)
    assert [t["wire"] for t in targets(scene, daemon).values()] == list(range(64))
    assert daemon.log().count("absent there") <= 64, "each device's last move is news, no other"
    daemon.signal(signal.SIGHUP)
    until(lambda: "64 targets, 64 of them" in daemon.log(), 20, "all stay")
    until(lambda: not others(), 30, lambda: str(others())[:2000], step=0.5)


def test_targets_of_the_command_line_are_wires_with_ways(scene):
    a = wire(scene, "a.sim", "DS18B20 28.A0B1C2000001 temperature 21")
    b = wire(scene, "b.sim", "DS18B20 28.A0B1C2000002 temperature 22")
    config = table("null:", {"one": ONE + "/temperature", "two": TWO + "/temperature"})
    daemon = scene.owsd(config, "-t", f"127.0.0.1:{owsdtest.free_port()} | {a}", "-t", b)
    until(lambda: served(scene, daemon, "one", a) == 21, 15, "the second way of the first wire")
    until(lambda: served(scene, daemon, "two", b) == 22, 15, "the second wire")
    until(lambda: sorted(states(scene, daemon)) == ["suspended", "up", "up"], 10,
          lambda: targets(scene, daemon))
    assert [t["wire"] for t in targets(scene, daemon).values()] == [0, 0, 1]


THERE, HERE = 4, 23.5  # what tester's thermometer always has, and that of the simulated wire


def bar(scene):
    """A genuine owserver and a simulated wire with the same ids, as ways to one wire. Of owserver's
    devices one has its value from the start, the other keeps what is written to it."""
    server = scene.owserver(tester=["28"], mock=["28"])
    (room,), (limit,) = (server.devices(bus) for bus in range(2))
    assert float(server.read(room + "/temperature")) == THERE
    other = wire(scene, "other.sim", f"DS18B20 {room[1:]} temperature {HERE}", f"DS18B20 {limit[1:]}")
    limit += "/temphigh"
    daemon = scene.owsd(table(f"{server.target} | {other}", {
        "room": room + "/temperature", "limit_out": limit, "limit": limit}))
    until(lambda: served(scene, daemon, "room", server.target) == THERE, 10, "by owserver")
    assert scene.owsctl(daemon, "set", "-w", "60", "limit_out", "45").returncode == 0
    assert server.read(limit) == "45"
    until(lambda: states(scene, daemon) == ["up", "suspended"], 10)
    return server, other, daemon, limit


class Watch(threading.Thread):
    """Sees every state of a signal: (value, target) where it is good, None where not."""

    def __init__(self, daemon, name):
        super().__init__(daemon=True)
        self.signals, self.name_of_it = ows.Ows(daemon.name), name
        self.seen, self.ended = [], threading.Event()
        self.start()

    def run(self):
        names = {target.index: target.name for target in self.signals.targets()}
        while not self.ended.is_set():
            value = self.signals.get(self.name_of_it)
            here = (value.value, names[value.target]) if value.good else None
            if self.seen[-1:] != [here]:
                self.seen.append(here)
            time.sleep(0.001)  # pace

    def has(self, value, target):
        until(lambda: self.seen[-1:] == [(value, target)], 60, lambda: f"{value}: {self.seen}")

    def end(self):
        self.ended.set()
        self.join(owsdtest.PATIENCE)
        return self.seen


def returns_and_was_counted(scene, daemon, server, other, limit, watch):
    watch.has(THERE, server.target)
    until(lambda: server.read(limit) == "46", 10, "the output is written there again")
    until(lambda: states(scene, daemon) == ["up", "suspended"], 10)
    there, here = (THERE, server.target), (HERE, other)
    seen = watch.end()
    # each value with its own target, and never the one with the other's
    assert [state for state, _ in itertools.groupby(filter(None, seen))] == [there, here, there], seen
    # the value from before the move was not good while the simulated wire converted, most of a second
    assert seen[seen.index(here) - 1] is None, seen
    until(lambda: [targets(scene, daemon)[t]["moves"] for t in (other, server.target)] == [3, 3], 10,
          lambda: targets(scene, daemon))
    for said in (f"from {server.target} to {other}: ", f"from {other} to {server.target}: "):
        owsdtest.logged(daemon, said)


def test_a_way_that_is_killed_is_left_and_taken_again(scene):
    server, other, daemon, limit = bar(scene)
    watch = Watch(daemon, "room")
    watch.has(THERE, server.target)
    server.kill()
    watch.has(HERE, other)
    until(lambda: served(scene, daemon, "limit", other) == 45, 10, "the output went with it")
    until(lambda: states(scene, daemon) == ["suspended", "up"], 10)
    notes = [t["note"] for t in targets(scene, daemon).values()]
    assert notes[0] and notes[1] is None, notes
    assert scene.owsctl(daemon, "set", "-w", "60", "limit_out", "46").returncode == 0
    again = scene.again(server)
    returns_and_was_counted(scene, daemon, again, other, limit, watch)


def test_a_way_that_hangs_is_left_and_taken_again(scene):
    server, other, daemon, limit = bar(scene)
    watch = Watch(daemon, "room")
    watch.has(THERE, server.target)
    server.freeze()
    watch.has(HERE, other)
    assert scene.owsctl(daemon, "set", "-w", "60", "limit_out", "46").returncode == 0
    server.thaw()
    returns_and_was_counted(scene, daemon, server, other, limit, watch)


def test_a_target_that_hangs_stalls_no_other(scene):
    b = wire(scene, "b.sim", "DS2408 29.A0B1C2000004")
    with peer.Peer({ONE + "/temperature": "      21.5"}) as server:
        daemon = scene.owsd(table(f"{server.target}, {b}", {
            "one": ONE + "/temperature", "pins": RELAY + "/sensed.BYTE"}, Timeout=600))
        until(lambda: served(scene, daemon, "one", server.target) == 21.5, 10)
        until(lambda: served(scene, daemon, "pins", b) == 255, 10)
        server.mode = "hang"
        until(lambda: server.requests and server.requests[-1].path == ONE + "/temperature", 5)
        for _ in range(3):
            before = listed(scene, daemon)["pins"]["count"]
            until(lambda: listed(scene, daemon)["pins"]["count"] > before + 5, 10, "goes on")
        until(lambda: served(scene, daemon, "pins", b) == 255, 10, "and good")
        daemon.stop()


def port_is_free(port):
    with socket.socket() as s:
        s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            s.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True


def test_a_liar_that_stands_first_does_not_keep_a_device_of_the_second_wire(scene):
    """It lists the device, takes writes of it and answers its reads, with what cannot be."""
    room, relay, pins = ONE + "/temperature", RELAY + "/PIO.BYTE", RELAY + "/sensed.BYTE"
    with peer.Peer({room: "-999.9", relay: "0", pins: "21.5", TWO + "/temperature": "18"}) as liar, \
            peer.Peer({room: "21.5", relay: "0", pins: "7"}) as true:
        rows = [dict(Name="pins", Path=pins, Type=raw("byte"), IO=raw("input")),
                dict(Name="relay_out", Path=relay, Type=raw("byte"), IO=raw("output")),
                dict(Name="room", Path=room, Type=raw("double"), IO=raw("input")),
                dict(Name="two", Path=TWO + "/temperature", Type=raw("double"), IO=raw("input"))]
        daemon = scene.owsd(owsdtest.rio(f"{liar.target}, {true.target}", rows, Timeout=6,
                                         Period=0.05, MaxRetries=1))
        until(lambda: served(scene, daemon, "room", true.target) == 21.5, 20, "the true one's")
        until(lambda: served(scene, daemon, "pins", true.target) == 7, 20, "the true one's")
        assert served(scene, daemon, "two", liar.target) == 18
        assert scene.owsctl(daemon, "set", "-w", "20", "relay_out", "3").returncode == 0
        assert (relay, b"3") in true.writes and (relay, b"3") not in liar.writes
        before = targets(scene, daemon)[true.target]["moves"]
        for _ in range(20):  # and there it stays
            seen = len(true.requests)
            until(lambda: len(true.requests) > seen, 10, "it reads on")
            assert served(scene, daemon, "room", true.target) == 21.5
        assert targets(scene, daemon)[true.target]["moves"] == before


def test_auto_says_what_is_missing_and_takes_what_comes(scene):
    with owsdtest.default_port():
        auto_finds(scene)


def auto_finds(scene):
    if not port_is_free(4304):
        owsdtest.skip("something listens at port 4304 of this machine")
    if os.path.exists("/sys/bus/w1/devices/w1_bus_master1"):
        owsdtest.skip("the kernel has a 1-Wire master")
    other = scene.owserver(mock=["28"])  # for the id
    room = other.devices()[0]
    other.kill()
    daemon = scene.owsd(table("null:", {"room": room + "/temperature"}), "-t", "auto")
    for what in ("localhost:4304: down", "i2c:auto: down", "w1: down", "no 1-Wire master"):
        until(lambda: what in daemon.log(), 20, what)
    # each reason once; what follows is one line for all ways
    until(lambda: daemon.log().count("nothing found; owsd looks again") == 2, 60, daemon.log)
    lines = daemon.log().splitlines()
    assert sum(": down: " in line for line in lines) == 3, lines
    assert sum(": the target is down" in line for line in lines) == 2, lines
    assert scene.get(daemon, "room") is None
    again = scene.owserver(mock=["28"], port=4304)
    again.write(room + "/temperature", 19.25)
    until(lambda: served(scene, daemon, "room", "localhost:4304") == 19.25, 90, "found")


if __name__ == "__main__":
    owsdtest.main()
