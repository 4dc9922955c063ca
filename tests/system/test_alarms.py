#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Alarms on simulated devices: limits, history, acknowledgement, and the examples of the manual."""

import json
import re

import owsdtest
import peer

EXAMPLES = re.findall(r"^```rio\n(OwsDrv \{.*?)^```$",
                      (owsdtest.SOURCE / "docs/alarms.md").read_text(), re.M | re.S)
CHIP = "i2c speed 400\nchip DS2482-100 0x18\n"
FREEZER = "/28.000000000004/temperature9"


def alarms(scene, daemon, *words):
    done = scene.owsctl(daemon, "--json", "alarms", *words)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def history(scene, daemon, name):
    return [(a["alarm"], a["event"]) for a in alarms(scene, daemon, "history", name)]


def start(scene, network, text, *options):
    net = scene.file("net.sim", CHIP + network)
    return scene.owsd(text, "-t", f"sim:{net}", *options)


def items(**keys):
    return [dict(Name="freezer", Path=FREEZER, Type="double", Uncached="on", **keys)]


def freezer(scene, curve, **keys):
    return start(scene, f"DS18B20 28.000000000004 temperature {curve}\n",
                 owsdtest.rio("", items(**keys), Period=0.05))


def played(scene, server, **keys):
    """The freezer behind a peer; returns when its first value is there."""
    daemon = scene.owsd(owsdtest.rio(server.target, items(**keys), Period=0.05))
    scene.until(lambda: scene.get(daemon, "freezer") == "20", 10, "the first value")
    return daemon


def listed(scene, daemon):
    """What list says of the freezer: its line and its alarms."""
    table = scene.owsctl(daemon, "list").stdout.splitlines()
    row, = json.loads(scene.owsctl(daemon, "--json", "list").stdout)
    at = table[0].index("ALARM")
    return re.split("  +", table[1][at:])[0], row["alarms"]


def test_list_and_watch_show_the_alarm_that_stands(scene):
    with peer.Peer({FREEZER: "20"}) as server:
        daemon = played(scene, server, LimitH=30)
        assert listed(scene, daemon) == ("-", [])
        server[FREEZER] = "31"
        scene.until(lambda: alarms(scene, daemon), 15, "the alarm is raised")
        words, entries = listed(scene, daemon)
        assert words == "! high", words
        assert entries == [dict(alarm="high", state="unacknowledged", device=False)]
        line = scene.owsctl(daemon, "watch", "-c", "1").stdout
        assert re.search(r" freezer 31 good.*; alarm: ! high$", line.strip()), line
        assert scene.owsctl(daemon, "alarms", "ack", "freezer").returncode == 0
        words, entries = listed(scene, daemon)
        assert words == "high, acknowledged", words
        assert entries == [dict(alarm="high", state="acknowledged", device=False)]
        row = json.loads(scene.owsctl(daemon, "--json", "watch", "-c", "1").stdout)
        assert row["alarms"] == entries and row["good"]


def test_watch_tells_an_alarm_that_comes_to_stand_while_the_value_stays(scene):
    with peer.Peer({FREEZER: "20"}) as server:
        daemon = played(scene, server, LimitH=30)
        server[FREEZER] = "31"
        scene.until(lambda: alarms(scene, daemon), 15, "the alarm is raised")
        watch = scene.start([owsdtest.OWSCTL, "-n", daemon.name, "watch"])
        scene.until(lambda: "alarm: ! high" in watch.log(), 10, watch.log)
        assert scene.owsctl(daemon, "alarms", "ack", "freezer").returncode == 0
        scene.until(lambda: "31 good; alarm: high, acknowledged" in watch.log(), 10, watch.log)


def test_a_limit_alarm_lives_from_raised_to_acknowledged(scene):
    with peer.Peer({FREEZER: "20"}) as server:
        daemon = played(scene, server, LimitH=30, LimitHH=40)
        server[FREEZER] = "31"
        alarm, = scene.until(lambda: alarms(scene, daemon), 15, "the alarm is raised")
        assert (alarm["name"], alarm["alarm"], alarm["state"]) == ("freezer", "high", "unacknowledged")
        assert alarm["value"] == 31 and alarm["since"] and not alarm["device"]
        done = scene.owsctl(daemon, "alarms", "ack", "freezer")
        assert (done.returncode, done.stderr) == (0, "")
        assert alarms(scene, daemon)[0]["state"] == "acknowledged"
        first, second = alarms(scene, daemon, "history")
        assert (first["event"], first["before"], first["after"]) == ("raised", 20, 31)
        assert (second["event"], second["before"]) == ("acknowledged", None)
        owsdtest.logged(daemon, "freezer: alarm: high")


def test_an_alarm_that_returns_waits_to_be_acknowledged(scene):
    with peer.Peer({FREEZER: "20"}) as server:
        daemon = played(scene, server, LimitH=30, LimitHH=40)
        server[FREEZER] = "45"
        scene.until(lambda: ("high high", "raised") in history(scene, daemon, "freezer"), 20,
                    "the alarm is raised")
        server[FREEZER] = "20"
        scene.until(lambda: ("high high", "returned") in history(scene, daemon, "freezer"), 20,
                    "the alarm returns")
        owsdtest.logged(daemon, "freezer: alarm: high high: returned to normal")
        scene.until(lambda: [a["state"] for a in alarms(scene, daemon)] ==
                    ["returned to normal unacknowledged"], 10, "it waits")
        assert scene.owsctl(daemon, "alarms", "ack", "--all").returncode == 0
        assert alarms(scene, daemon) == []
        assert history(scene, daemon, "freezer") == [
            ("high high", "raised"), ("high high", "returned"), ("high high", "acknowledged")]


def test_a_thermometer_unplugged_is_a_bad_alarm(scene):
    daemon = freezer(scene, "20\nat 3s unplug 28.000000000004", LimitH=30)
    alarm, = scene.until(lambda: alarms(scene, daemon), 20, "the alarm is raised")
    assert (alarm["alarm"], alarm["good"]) == ("bad", False)


def test_alarms_are_waited_for(scene):
    """ows_wait() is woken by an alarm as by a value."""
    daemon = freezer(scene, "steps 0:20 5s:31", LimitH=30)
    done = scene.owsctl(daemon, "wait", "freezer", ">", "30", "-t", "60")
    assert done.returncode == 0, done.stderr
    assert history(scene, daemon, "freezer") == [("high", "raised")]


def test_every_example_of_the_manual_is_a_configuration_without_faults(scene):
    assert len(EXAMPLES) == 8
    for number, text in enumerate(EXAMPLES):
        done = scene.owsd_once("-c", scene.file(f"example{number}.rio", text), "--check")
        assert (done.returncode, done.stderr) == (0, ""), (text, done.stderr)


def example(scene, name, network, told, device=("", "")):
    """The example with that signal on a simulated network, or of another device; waits until an alarm of it
    is entered of which told() is true."""
    text = next(t for t in EXAMPLES if f'"{name}"' in t)
    daemon = start(scene, network, text.replace(*device))
    scene.until(lambda: [a for a in alarms(scene, daemon, "history", name)
                         if (a["alarm"], a["event"]) == ("device", "raised")
                         and a["after"] is not None and told(a)],
                20, f"{name} raises its alarm")
    return daemon


def is_cleared(scene, daemon, name):
    scene.until(lambda: ("device", "returned") in history(scene, daemon, name), 10,
                "its latch is cleared")


def test_the_ds2408_of_the_manual_tells_a_short_press(scene):
    daemon = example(scene, "buttons", "DS2408 29.000000000001 pin.4 steps 0:1 3s:0 3.02s:1 repeat 4s\n",
                     lambda a: int(a["remark"]) == 16 and a["before"] == a["after"])
    is_cleared(scene, daemon, "buttons")


def test_the_ds2406_of_the_manual_tells_a_short_press(scene):
    daemon = example(scene, "doorbell", "DS2406 12.000000000002 pin.A steps 0:1 3s:0 3.02s:1 repeat 4s\n",
                     lambda a: a["remark"] == "1" and a["before"] == a["after"])
    is_cleared(scene, daemon, "doorbell")


def test_the_ds2450_of_the_manual_tells_a_voltage_too_high(scene):
    example(scene, "tank", "DS2450 20.000000000003 volt.A steps 0:2 4s:4.5\n",
            lambda a: a["after"] > 4)


def test_the_thermometer_of_the_manual_tells_a_high_temperature(scene):
    daemon = example(scene, "boiler",
                     "DS18B20 28.000000000004 temperature steps 0:20 5s:35\n",
                     lambda a: a["after"] == 35)
    scene.until(lambda: [a["state"] for a in alarms(scene, daemon)] == ["stands"], 10, "it stands")


def test_the_ds28ea00_of_the_manual_tells_a_high_temperature(scene):
    example(scene, "boiler", "DS28EA00 42.000000000005 temperature steps 0:20 5s:35\n",
            lambda a: a["after"] == 35, ("28.000000000004", "42.000000000005"))


def test_the_eds0065_of_the_manual_tells_a_high_humidity(scene):
    # from the factory its limit is 0
    example(scene, "cellar", "EDS0065 7E.000000000005 humidity steps 0:0 5s:80\n",
            lambda a: a["after"] == 80)


def test_the_ds2405_of_the_manual_tells_that_it_is_on(scene):
    text = next(t for t in EXAMPLES if '"valve"' in t)
    daemon = start(scene, "DS2405 05.000000000006\n", text)
    scene.until(lambda: scene.get(daemon, "valve") == "0", 10, "the valve is written")
    assert scene.owsctl(daemon, "set", "-w", "60", "valve", "1").returncode == 0
    scene.until(lambda: [a["state"] for a in alarms(scene, daemon)] == ["stands"], 10, "it is on")
    assert scene.owsctl(daemon, "set", "-w", "60", "valve", "0").returncode == 0
    scene.until(lambda: alarms(scene, daemon) == [], 10, "it is off")


def test_an_item_on_a_bus_without_alarm_search_is_shown(scene):
    daemon = scene.owsd(next(t for t in EXAMPLES if '"buttons"' in t), "-t", "null:")
    alarm, = scene.until(lambda: alarms(scene, daemon), 10, "it is shown")
    assert alarm["polled"] and "read as an input" in alarm["state"]


if __name__ == "__main__":
    owsdtest.main()
