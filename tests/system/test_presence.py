#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Devices that are pulled off: alarm items, inputs that are read seldom and outputs that are not read
back show it as soon as an input of each period does. Over owsd's own bus, through an owserver which
is another owsd, and through the genuine one, which has the same wire behind a serial port."""

import json
import time

import owsdtest
from owsdtest import raw, until
import served

CHIPS = {name: f"/29.00000000000{n}" for n, name in
         enumerate(("plain", "alarm", "seldom", "silent", "initial"), 1)}
WIRE = ("i2c speed 400\nchip DS2482-100 0x18\n" +
        "".join(f"DS2408 {path[1:]} as {name}\n" for name, path in CHIPS.items()) +
        "".join(f"at 25s every 60s unplug {name} for 20s\n" for name in CHIPS))
ALARM = dict(Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por", SetAlarm="set_alarm=133333333",
             ResetLatch="latch.BYTE=0")
SOON = 6  # 3 s, and patience with a busy machine; an alarm item is read once a minute


def plant(scene, way):
    def item(name, kind, prop, **keys):
        return dict(Name=name, Path=f"{CHIPS[name]}/{prop}", Type=raw("byte"), IO=raw(kind), **keys)
    items = [item("plain", "input", "sensed.BYTE", Uncached=raw("on")),
             item("alarm", "input", "sensed.BYTE", **ALARM),
             item("seldom", "input", "sensed.BYTE", PerFactor=1000),
             item("silent", "output", "PIO.BYTE", ReadBack=0),
             item("initial", "output", "PIO.BYTE", ReadBack=0, InitValue="85")]
    wire = scene.file("wire.sim", WIRE)
    if way == "direct":
        server = served.owsd_of(scene, f"sim:{wire}", items=items)
        return server.program
    server = (served.owserver_of(scene, wire) if way == "genuine" else
              served.owsd_of(scene, f"sim:{wire}", items=[]))
    return scene.owsd(owsdtest.rio(f"{server.host}:{server.port}", items))


def rows(scene, daemon):
    return {row["name"]: row for row in json.loads(scene.owsctl(daemon, "--json", "list").stdout)}


def absent(scene, daemon):
    return {name for name, row in rows(scene, daemon).items() if row["quality"] == "device absent"}


def pulled_off_and_back(scene, way):
    daemon = plant(scene, way)
    until(lambda: scene.owsctl(daemon, "set", "-w", 5, "silent", 85).returncode == 0, 30, "set")
    until(lambda: all(row["good"] for row in rows(scene, daemon).values()), 20,
          lambda: rows(scene, daemon))
    until(lambda: absent(scene, daemon), 60, "they are pulled off")
    begun = time.monotonic()
    until(lambda: absent(scene, daemon) == set(CHIPS), 15, lambda: absent(scene, daemon))
    took = time.monotonic() - begun
    assert took < SOON, f"{took:.1f} s"
    until(lambda: all(row["good"] for row in rows(scene, daemon).values()), 60,
          lambda: rows(scene, daemon))
    for name in "silent", "initial":
        def read(path=f"/uncached{CHIPS[name]}/PIO.BYTE"):
            return scene.owsctl(daemon, "read", path)
        until(lambda: read().stdout.strip() == "85", 10, lambda: f"written again: {read()}")


def test_devices_of_its_own_bus_are_pulled_off(scene):
    pulled_off_and_back(scene, "direct")


def test_devices_of_an_owserver_are_pulled_off(scene):
    pulled_off_and_back(scene, "owsd")


def test_devices_of_the_genuine_owserver_are_pulled_off(scene):
    pulled_off_and_back(scene, "genuine")


if __name__ == "__main__":
    owsdtest.main()
