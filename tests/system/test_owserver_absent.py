#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owserver reads ones, without an error, of a device that is away while others are on its wire."""

import owsdtest
import peer
from owsdtest import raw, until

ROOM = "/28.A0B1C2000001/temperature"
POWER = "/28.A0B1C2000001/power"
VOLT = "/30.A0B1C2000002/volt"
WIPER = "/2C.A0B1C2000003/wiper"
THERE = "/30.A0B1C2000002/present"
ONES = {"power": "1", "volt": "-0.00488", "wiper": "255"}
PATHS = {"room": ROOM, "power": POWER, "volt": VOLT, "wiper": WIPER}


def house(target, **paths):
    return owsdtest.rio(target, [dict(Name=name, Path=path, Type=raw("double"), IO=raw("input"))
                                 for name, path in paths.items()], Period=0.05, Timeout=30)


def quality(scene, daemon, name):
    done = scene.owsctl(daemon, "get", name)
    return "good" if done.returncode == 0 else done.stderr


def test_ones_of_a_device_that_is_away_are_not_good(scene):
    with peer.Peer({ROOM: "21.5", POWER: "0", VOLT: "3.7", WIPER: "128", THERE: "1"}) as server:
        daemon = scene.owsd(house(server.target, there=THERE, **PATHS))
        for name in (*PATHS, "there"):
            until(lambda n=name: quality(scene, daemon, n) == "good", 30, f"{name} is good")
        server.pulled |= {"/" + PATHS[name].split("/")[1] for name in ONES}
        for name, ones in ONES.items():
            server[PATHS[name]] = ones
        server[THERE] = "0"
        for name in ONES:
            until(lambda n=name: "absent" in quality(scene, daemon, n), 30, f"{name} is absent")
        server.pulled.clear()
        server[THERE] = "1"
        # the same values of a device that is there
        for name, ones in ONES.items():
            until(lambda n=name, v=ones: quality(scene, daemon, n) == "good" and
                  float(scene.get(daemon, n)) == float(v), 90, f"{name} is good again")


def test_the_value_of_present_is_a_value_though_the_device_is_away(scene):
    with peer.Peer({ROOM: "21.5", THERE: "0"}) as server:
        server.pulled.add("/30.A0B1C2000002")
        daemon = scene.owsd(house(server.target, there=THERE))
        until(lambda: quality(scene, daemon, "there") == "good", 30, "present is 0, and good")
        assert float(scene.get(daemon, "there")) == 0


def test_what_has_a_checksum_costs_no_second_request(scene):
    with peer.Peer({ROOM: "21.5"}) as server:
        daemon = scene.owsd(house(server.target, room=ROOM))
        until(lambda: quality(scene, daemon, "room") == "good", 30, "room is good")
        until(lambda: server.reads(ROOM) > 5, 30, "it is read again and again")
        assert not [r for r in list(server.requests) if r.kind == peer.PRESENT]


def test_a_genuine_owserver_says_that_they_are_there(scene):
    server = scene.owserver(mock=["28", "30", "2C"])
    device = {path[1:3]: path for path in server.devices()}
    paths = {"volt": device["30"] + "/volt", "wiper": device["2C"] + "/wiper"}
    daemon = scene.owsd(house(server.target, **paths))
    for name in paths:
        until(lambda n=name: quality(scene, daemon, n) == "good", 30, f"{name} is good")


if __name__ == "__main__":
    owsdtest.main()
