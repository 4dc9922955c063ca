#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Device alarms from the simulated wire to the control program."""

import json

import owsdtest
from owsdtest import raw, until

NETWORK = """
i2c speed 400
chip DS2482-100 0x18
DS18B20 28.0000000000B1 as hall    temperature 21
DS2408  29.000000000001 as relays  pin.4 steps 0:1 2s:0 repeat 4s
at 11s every 11s brownout relays
"""
SWITCH = "/29.000000000001"


def config(target):
    return owsdtest.rio(target, [
        dict(Name="hall", Path="/28.0000000000B1/temperature12", Type=raw("double"),
             IO=raw("input")),
        dict(Name="inputs", Path=SWITCH + "/sensed.BYTE", Type=raw("byte"), IO=raw("input"),
             Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
             SetAlarm="set_alarm=133333333", ResetLatch="latch.BYTE=0"),
        dict(Name="relays", Path=SWITCH + "/PIO.BYTE", Type=raw("byte"), IO=raw("output"),
             InitValue="1"),
    ])


def history(scene, daemon):
    done = scene.owsctl(daemon, "--json", "alarms", "history")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def counter(scene, daemon, name):
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return next(c["value"] for c in stats["counters"] if c["name"] == name)


def test_an_input_change_is_an_alarm_with_its_value_and_a_restart_is_mended(scene):
    daemon = scene.owsd(config(f"sim:{scene.file('net.sim', NETWORK)}"))
    until(lambda: scene.get(daemon, "inputs"), 10, "the inputs are read")
    until(lambda: counter(scene, daemon, "alarms") >= 3, 20, "three changes of the input")
    until(lambda: counter(scene, daemon, "power_on_resets") >= 2, 20,
          "the restart (and the one before owsd began) was seen")
    until(lambda: any(a["name"] == "inputs" and a["event"] == "raised" for a in history(scene, daemon)), 10,
          "its alarm is in the history")
    until(lambda: any("power" in a["alarm"] for a in history(scene, daemon)), 10,
          "the restart is in the history")
    until(lambda: scene.get(daemon, "relays") == "1", 10, "the output has its value again")
    until(lambda: scene.get(daemon, "inputs_Alarm") is not None, 10, "it has its alarm")


def test_a_bus_without_alarm_search_reads_its_alarm_items_as_inputs(scene):
    # the null bus has no list of alarms
    daemon = scene.owsd(config("null:"), "-v")
    until(lambda: "read as ordinary inputs" in daemon.log(), 5, "said once")
    assert daemon.log().count("read as ordinary inputs") == 1


if __name__ == "__main__":
    owsdtest.main()
