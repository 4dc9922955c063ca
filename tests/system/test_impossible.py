#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a signal refuses as impossible, no door serves: on owsd's own buses, and over an owserver."""

import json
import socket
import struct
import urllib.request

import owsdtest
import peer
import webhouse
from owsdtest import raw, until

COLD, HOT, MONITOR, FINE = ("28.140000000000", "28.150000000000", "26.160000000000",
                            "28.170000000000")
RANGE = "a value out of the chip's range: "
GET = 8
POWER = "reading of a sensor without power"
# path, words of the reason, how the signal is bad
LIES = [(f"/{COLD}/temperature", RANGE + "-109.938", "device error"),
        (f"/{COLD}/temperature12", RANGE + "-109.938", "device error"),
        (f"/{HOT}/temperature12", POWER, "sensor power fault"),
        (f"/{MONITOR}/humidity", RANGE + "26", "device error")]
TRUTH = f"/{FINE}/temperature12"
SIM = f"""chip DS2482-100 0x18
DS18B20 {COLD} temperature -109.9375
DS18B20 {HOT} temperature 127.9
DS2438 {MONITOR} vad 9
DS18B20 {FINE} temperature 21.5
"""


def lying_peer():
    return peer.Peer({f"/{COLD}/temperature": "    -109.938", f"/{COLD}/temperature12": "    -109.938",
                      f"/{HOT}/temperature12": "          85", f"/{MONITOR}/humidity": "     264.516",
                      f"/{MONITOR}/VAD": "        9", f"/{COLD}/scratchpad": "!\xf9Kabcdef",
                      TRUTH: "        21.5"})


def request(port, kind, path):
    """The return code and the data of one request of a client."""
    body = path.encode() + b"\0"
    with socket.create_connection(("127.0.0.1", port), timeout=60) as s, s.makefile("rb") as answers:
        s.sendall(struct.pack(">6i", 0, len(body), kind, 0x10A, 8192, 0) + body)
        while True:
            _, length, code, *_ = struct.unpack(">6i", answers.read(24))
            if length >= 0:
                return code, answers.read(length)


def found(web, ids):
    """What the page's list of devices says: path of the property, value and reason."""
    asked = urllib.request.Request(f"{web.address}api/devices?ids={','.join(ids)}",
                                   headers={"X-Owsd": "1"})
    with urllib.request.urlopen(asked, timeout=60) as answer:
        devices = json.load(answer)["devices"]
    return {f"{d['path']}/{p['name']}": (p["value"], p["why"])
            for d in devices for p in d["properties"]}


def refused_at_each_door(scene, target):
    port = owsdtest.free_port()
    items = [dict(Name=f"s{i}", Path=path, Type=raw("double"), IO=raw("input"))
             for i, (path, *_) in enumerate([*LIES, (TRUTH,)])]
    daemon = scene.owsd(owsdtest.rio(target, items, Period=0.05, Timeout=10, MaxRetries=1,
                                     Web=raw("{ Configure on }")),
                        "-l", f"127.0.0.1:{port}")
    until(lambda: scene.get(daemon, f"s{len(LIES)}") == "21.5", 20, "the true one is good")
    assert request(port, peer.READ, TRUTH) == (12, b"        21.5")
    for i, (path, why, quality) in enumerate(LIES):
        until(lambda: quality in scene.owsctl(daemon, "list", f"s{i}").stdout, 20, path)
        for kind, way in ((peer.READ, "/uncached"), (GET, "")):
            assert request(port, kind, way + path) == (-5, b""), (kind, path)
        for at, words in ((daemon, []), (None, ["-t", target])):
            done = scene.owsctl(at, *words, "read", path)
            assert done.returncode == 1 and not done.stdout and why in done.stderr, done
        done = json.loads(scene.owsctl(daemon, "--json", "read", path).stdout)
        assert done[0]["value"] is None and why in done[0]["error"], done
    for at, words in ((daemon, []), (None, ["-t", target])):
        lines = scene.owsctl(at, *words, "scan").stdout.splitlines()
        for path, why, _ in LIES[1:]:
            assert why in next(line for line in lines if path[:16] in line), (path, lines)
    listed = found(webhouse.serve(scene, daemon), [COLD, HOT, MONITOR, FINE])
    for path, why, _ in LIES[1:]:
        value, said = listed[path]
        assert value is None and why in said, (path, listed)
    assert listed[TRUTH] == ("21.5", None), listed
    assert request(port, peer.READ, f"/{COLD}/scratchpad")[0] == 9
    assert request(port, peer.READ, f"/{MONITOR}/VAD")[0] > 0


def test_no_door_serves_it_on_a_bus_of_owsds_own(scene):
    scene.file("lies.sim", SIM)
    refused_at_each_door(scene, "sim:lies.sim")


def test_no_door_serves_it_over_an_owserver(scene):
    with lying_peer() as server:
        refused_at_each_door(scene, server.target)


if __name__ == "__main__":
    owsdtest.main()
