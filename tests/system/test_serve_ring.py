#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Servers that have each other as targets: what one has the others show, and nothing more."""

import time

import owsdtest
from owsdtest import until
from test_serve import DIRALL, READ, ask, stat

ROOM, HALL = "28.0000000000A1", "28.0000000000B2"
WIRE = "i2c speed 400\nchip DS2482-100 0x18\nDS18B20 {} as one temperature {}\n"


def item(name, device, **keys):
    return dict(Name=name, Path=f"/{device}/temperature", Type="double", IO="input", **keys)


def ring(scene, wire, *others, names=("room",), devices=(ROOM,), between=None, **driver):
    """Daemons of which each has the next as a target, the first the wire too; (daemon, port)."""
    ports = [owsdtest.free_port() for _ in range(2)]
    items = [item(n, d) for n, d in zip(names, devices)]
    back = f"localhost:{ports[0]}"
    if others:
        back = f"sim:{scene.file('b.sim', others[0])}, {back}"
    # an owserver does not start before what it leads to
    second = scene.owsd(owsdtest.rio(back, items, **driver), "-l", str(ports[1]))
    to_second = between(ports[1]) if between else f"localhost:{ports[1]}"
    first = scene.owsd(owsdtest.rio(f"sim:{scene.file('a.sim', wire)}, {to_second}", items, **driver), "-l", str(ports[0]))
    return [(first, ports[0]), (second, ports[1])]


def is_good(scene, daemon, name):
    return scene.owsctl(daemon, "get", name).returncode == 0


def test_each_has_what_the_other_has(scene):
    pair = ring(scene, WIRE.format(ROOM, 21.5), WIRE.format(HALL, 17.25), names=("room", "hall"),
                devices=(ROOM, HALL))
    for daemon, port in pair:
        until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room's thermometer")
        until(lambda: scene.get(daemon, "hall") == "17.25", 20, "the hall's thermometer")
        names = ask(port, DIRALL, "/")[4].rstrip(b"\0").decode().split(",")
        assert sorted(n for n in names if "28." in n) == [f"/{ROOM}", f"/{HALL}"]
        assert float(ask(port, READ, f"/uncached/{HALL}/temperature")[4]) == 17.25


def all_have_it(scene, pair, seconds):
    end, had = time.monotonic() + seconds, set()
    while len(had) < len(pair) and time.monotonic() < end:
        had |= {daemon for daemon, _ in pair if is_good(scene, daemon, "room")}
    return len(had) == len(pair)


def lost_on_all(scene, make):
    """make(SECONDS) is a ring whose device goes after so many seconds: more of them where that is
    before all have its value, as on a busy machine."""
    for seconds in (8, 25, 80):
        pair = make(seconds)
        if all_have_it(scene, pair, seconds):
            break
        for daemon, _ in pair:
            daemon.stop()
    else:
        raise AssertionError("the wire's value is not everywhere")
    for daemon, _ in pair:
        until(lambda: not is_good(scene, daemon, "room"), 40, "the device is gone")
    # and nobody gives it back to the other
    for _ in range(20):
        time.sleep(0.1)  # nobody does
        for daemon, _ in pair:
            assert not is_good(scene, daemon, "room")
    return pair


def test_a_value_does_not_outlive_its_device_in_a_ring(scene):
    pair = lost_on_all(scene, lambda seconds: ring(
        scene, WIRE.format(ROOM, 21.5) + f"at {seconds}s unplug one\n"))
    until(lambda: any(stat(scene, daemon, "served_came_round") for daemon, _ in pair), 30)


def test_a_ring_over_a_genuine_owserver_ends_too(scene):
    def between(port):
        return scene.owserver(options=["-s", f"127.0.0.1:{port}",
                                        "--timeout_volatile=1", "--timeout_presence=1"]).target

    lost_on_all(scene, lambda seconds: ring(
        scene, WIRE.format(ROOM, 21.5) + f"at {seconds}s unplug one\n", between=between, Timeout=4))


def test_an_owsd_that_is_its_own_target_has_no_devices_of_itself(scene):
    port = owsdtest.free_port()
    daemon = scene.owsd(owsdtest.rio(f"sim:{scene.file('a.sim', WIRE.format(ROOM, 21.5))}, "
                                     f"127.1:{port}", [item("room", ROOM), item("hall", HALL)]),
                        "-l", f"127.0.0.1:{port}")
    until(lambda: scene.get(daemon, "room") == "21.5", 20)
    until(lambda: "absent" in scene.owsctl(daemon, "list").stdout, 20)
    assert ask(port, DIRALL, "/", flags=0x100)[4].rstrip(b"\0").decode() == f"/{ROOM}"
    until(lambda: stat(scene, daemon, "served_came_round") > 0, 20)


def test_a_signal_of_a_signal_is_not_passed_on(scene):
    ports = [owsdtest.free_port() for _ in range(2)]
    pair = []
    for mine, other in zip(ports, reversed(ports)):
        items = [dict(Name="room", Path="/signals/room", Type="double", IO="input", InitValue=7)]
        pair.append(scene.owsd(owsdtest.rio(f"localhost:{other}", items, MaxRetries=0), "-l", str(mine)))
    until(lambda: stat(scene, pair[0], "served_requests") > 3, 20)
    for daemon in pair:
        assert not is_good(scene, daemon, "room")


if __name__ == "__main__":
    owsdtest.main()
