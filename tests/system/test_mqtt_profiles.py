#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The profiles homie5 and wirenboard of owsd-mqtt at a real mosquitto: what they publish is as their
conventions have it, no bad value passes for a good one, and commands go the way of all commands."""

import json
import re
import signal
import subprocess

import owsdtest
from mqtthouse import ABSENT, RELAY, ROOM, SENSOR, SWITCH, House, item, program
from owsdtest import logged, raw, until

PULL = item("pull", "/simulator/unplug", "bool", "output")
WIRE = f"button unplug unplug {SENSOR}\n"
DIAL = item("Dial_1", f"/{SWITCH}/PIO.BYTE", "byte", "output", Max=200)
ID = re.compile(r"[a-z0-9-]+\Z")
# By the convention: homieiot.github.io/specification, "Payloads"
PAYLOADS = {"float": r"-?[0-9]+(\.[0-9]+)?([eE]-?[0-9]+)?", "integer": "-?[0-9]+", "boolean": "true|false",
            "string": r"(?s:.+)"}


class Homie5:
    name, root, state, word = "homie5", "homie/5/owsd-pi7", "homie/5/owsd-pi7/$state", "ready"
    set, on, off = "/set", "true", "false"
    lost, ended = "lost", "disconnected"

    @staticmethod
    def topic(name):
        node = {"room": SENSOR, "pull": "signals", "absent": "28.FFFFFFFFFFFF"}.get(name, SWITCH)
        # by the property that the signal began with, not by its name
        id_ = {"relay": "pio-0", "pull": "simulator-unplug", "dial-1": "pio-byte", "kind": "type"}.get(name, "temperature")
        return f"{Homie5.root}/{node.lower().replace('.', '-')}/{id_}"

    @staticmethod
    def shows_bad(house, name, why):
        house.says(f"{Homie5.root}/$alert/{name}", f"{name}: {why}")
        assert Homie5.topic(name) not in house.kept(f"{Homie5.root}/#")

    @staticmethod
    def shows_good(house, name, text):
        house.says(Homie5.topic(name), text)
        simulated = "" if name == "pull" else f"{name}: simulated"
        house.says(f"{Homie5.root}/$alert/{name}", simulated)


class WirenBoard:
    name, root, state, word = "wirenboard", "/devices/owsd_pi7", "/devices/owsd_pi7/meta/error", ""
    set, on, off = "/on", "1", "0"
    lost, ended = "r", "r"

    @staticmethod
    def topic(name):
        return f"{WirenBoard.root}/controls/{name}"

    @staticmethod
    def shows_bad(house, name, _why):
        until(lambda: "r" in (house.listener.last(f"{WirenBoard.topic(name)}/meta/error") or ""), 20,
              lambda: house.listener.all())

    @staticmethod
    def shows_good(house, name, text):
        house.says(WirenBoard.topic(name), text)
        house.says(f"{WirenBoard.topic(name)}/meta/error", "")


BOTH = Homie5, WirenBoard


def start(scene, profile, *items, **keys):
    house = House(scene, *(items or (ROOM, RELAY, PULL)), wire=WIRE, Profile=profile.name, **keys)
    house.says(profile.state, profile.word)
    return house


def command(house, profile, name, text, *options):
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "1", "-t",
                    profile.topic(name) + profile.set, "-m", text, *options], check=True, timeout=owsdtest.PATIENCE)


def check_description(text):
    """The rules of the convention for $description."""
    device = json.loads(text)
    assert set(device) <= {"homie", "version", "nodes", "name", "type", "children", "root", "parent", "extensions"}
    assert re.fullmatch(r"5\.[0-9]+", device["homie"]) and type(device["version"]) is int, device
    for node_id, node in device["nodes"].items():
        assert ID.match(node_id) and set(node) <= {"name", "type", "properties"}, node
        assert node["properties"], node
        for property_id, found in node["properties"].items():
            assert ID.match(property_id), property_id
            assert set(found) <= {"name", "datatype", "format", "settable", "retained", "unit"}, found
            assert found["datatype"] in PAYLOADS and found["retained"] is True, found
            assert type(found["settable"]) is bool and all(found.get(k, "x") for k in ("name", "unit")), found
            if "format" in found:
                number = PAYLOADS[found["datatype"]]
                assert re.fullmatch(f"({number})?:({number})?", found["format"]) and found["format"] != ":", found
    return device


def test_homie5_describes_the_device_before_its_values_and_is_ready_behind_them(scene):
    kind = item("kind", f"/{SWITCH}/type", "string")
    house = start(scene, Homie5, {**ROOM, "Unit": "°C", "Min": -20, "Description": "Living room"}, RELAY, DIAL, kind,
                  PULL, Write=raw("on"))
    house.says(Homie5.topic("room"), "21.5")
    house.says(Homie5.topic("kind"), "DS2408")
    kept = house.kept(f"{Homie5.root}/#")
    nodes = check_description(kept[f"{Homie5.root}/$description"])["nodes"]
    assert set(nodes) == {SENSOR.lower().replace(".", "-"), SWITCH.lower().replace(".", "-"), "signals"}, nodes
    room = nodes[SENSOR.lower().replace(".", "-")]["properties"]["temperature"]
    assert room == {"name": "Living room", "datatype": "float", "format": "-20:", "unit": "°C", "settable": False,
                    "retained": True}, room
    board = nodes[SWITCH.lower().replace(".", "-")]
    assert board["name"] == f"DS2408 {SWITCH}" and board["type"] == "DS2408", board
    dial = board["properties"]["pio-byte"]
    assert dial == {"name": "Dial_1", "datatype": "integer", "format": "0:200", "settable": True,
                    "retained": True}, dial
    assert board["properties"]["type"]["datatype"] == "string"
    for topic, text in kept.items():
        levels = topic.split("/")[3:]
        if len(levels) == 2 and levels[0] != "$alert":
            datatype = nodes[levels[0]]["properties"][levels[1]]["datatype"]
            assert re.fullmatch(PAYLOADS[datatype], text), (topic, text)
    said = [(t[len(Homie5.root) + 1:], p) for _, t, p in house.listener.all() if t.startswith(Homie5.root)]
    room = f"{Homie5.topic('room')[len(Homie5.root) + 1:]}"
    order = [said.index(("$state", "init")), [t for t, _ in said].index("$description"),
             [t for t, _ in said].index(room), said.index(("$state", "ready"))]
    assert order == sorted(order), said
    assert "(d0, q2, r1, " in house.broker.process.log() and "owsd/pi7/health" not in house.kept("owsd/#")


def test_a_limit_alarm_stands_beside_its_signal(scene):
    for profile, standing, resting in ((Homie5, "room: high alarm", "room: simulated"), (WirenBoard, "1", "0")):
        topic = f"{Homie5.root}/$alert/room" if profile is Homie5 else f"{WirenBoard.topic('room')}__alarm"
        house = start(scene, profile, {**ROOM, "LimitH": 20})
        house.says(topic, standing)
        house.daemon.config.write_text(house.text({**ROOM, "LimitH": 30}))
        house.daemon.signal(signal.SIGHUP)
        house.says(topic, resting)
        if profile is WirenBoard:
            meta = json.loads(house.kept(f"{topic}/#")[f"{topic}/meta"])
            assert (meta["type"], meta["readonly"]) == ("alarm", True), meta
            house.daemon.stop()
            house.says(f"{topic}/meta/error", "r")
            house.daemon.config.write_text(house.text(ROOM))
            house.daemon = scene.owsd(house.daemon.config, name=house.daemon.name)
            # a signal without limits has no such control, nor does one stand there from before
            until(lambda: not house.kept(f"{topic}/#"), 60, lambda: house.kept(f"{topic}/#"), step=0.5)


def test_wirenboard_has_a_device_with_a_control_of_each_signal(scene):
    kind = item("kind", f"/{SWITCH}/type", "string")
    house = start(scene, WirenBoard, {**ROOM, "Unit": "°C", "Decimals": 1, "Description": "Living room"}, RELAY, DIAL,
                  kind, Write=raw("on"))
    for name, text in (("room", "21.5"), ("kind", "DS2408")):
        WirenBoard.shows_good(house, name, text)
    kept = house.kept("/devices/#")
    assert json.loads(kept["/devices/owsd_pi7/meta"]) == {"driver": "owsd", "title": {"en": "owsd pi7"}}
    meta = {name: json.loads(kept[f"{WirenBoard.topic(name)}/meta"]) for name in ("room", "relay", "dial_1", "kind")}
    assert meta == {
        "room": {"type": "value", "units": "deg C", "precision": 0.1, "order": 1, "readonly": True,
                 "title": {"en": "Living room (simulated)"}},
        "relay": {"type": "switch", "order": 2, "readonly": False, "title": {"en": "relay"}},
        "dial_1": {"type": "value", "max": 200, "precision": 1, "order": 3, "readonly": False,
                   "title": {"en": "Dial_1"}},
        "kind": {"type": "text", "order": 4, "readonly": True, "title": {"en": "kind (simulated)"}}}, meta
    # an output that nobody has commanded has no value that anybody may believe
    assert kept[f"{WirenBoard.topic('relay')}/meta/error"] == "r" and WirenBoard.topic("relay") not in kept, kept


def recovers(scene, profile):
    house = start(scene, profile, ROOM, PULL, ABSENT)
    profile.shows_good(house, "room", "21.5")
    house.set("pull", 1)
    profile.shows_bad(house, "room", "device absent")
    house.set("pull", 0)
    profile.shows_good(house, "room", "21.5")
    return [(t, p) for _, t, p in house.listener.all() if t.startswith(profile.root)]


def test_homie5_keeps_nothing_of_a_pulled_sensor_and_has_it_again_when_it_is_back(scene):
    said = recovers(scene, Homie5)
    values = [p for t, p in said if t == Homie5.topic("room")]
    # at the start it may have been bad until it was read first
    assert values[-3:] == ["21.5", "", "21.5"], values


def test_wirenboard_keeps_the_last_value_of_a_pulled_sensor_and_never_without_its_error(scene):
    said = recovers(scene, WirenBoard)
    error = f"{WirenBoard.topic('room')}/meta/error"
    steps = [(t == error, p) for t, p in said if t in (WirenBoard.topic("room"), error)]
    wrong = max(i for i, (is_error, text) in enumerate(steps) if is_error and text)
    # the value is new before the error goes, and comes behind it once more, as the conventions want it
    assert steps[wrong + 1:] == [(False, "21.5"), (True, ""), (False, "21.5")], steps
    assert steps[wrong - 1][1], steps


def test_commands_have_the_way_and_the_rights_of_all_commands(scene):
    for profile in BOTH:
        house = start(scene, profile, Write=raw("on"))
        for text in (profile.on, profile.off, profile.on):
            command(house, profile, "relay", text)
            profile.shows_good(house, "relay", text)
        journal = scene.owsctl(house.daemon, "journal").stdout
        assert "owsd-mqtt" in journal and "mqtt:127.0.0.1" in journal, journal
        command(house, profile, "relay", "7")
        logged(house.face, "command to \"relay\" refused: \"7\" is no value for it: expected 0 or 1")
        command(house, profile, "room", "20")
        logged(house.face, "command to \"room\" refused: it is an input")
        command(house, profile, "relay", profile.off, "-r")
        logged(house.face, "command to \"relay\" refused: it is retained")
        command(house, profile, "nobody", profile.on)
        logged(house.face, " refused: there is no such signal")
        assert house.listener.last(profile.topic("relay")) == profile.on
        assert scene.get(house.daemon, "relay") == "1"
        house.face.stop()


def refuses(scene, house, profile):
    until(lambda: f"{profile.set} (QoS" in house.broker.process.log(), 20, "it listens to commands")
    house.set("relay", 0)
    command(house, profile, "relay", profile.on)
    logged(house.face, "command to \"relay\" refused: Write is off in the block Mqtt")
    assert scene.get(house.daemon, "relay") == "0"


def test_without_write_nothing_can_be_commanded_and_says_so(scene):
    house = start(scene, Homie5)
    house.says(Homie5.topic("room"), "21.5")
    for node in json.loads(house.listener.last(f"{Homie5.root}/$description"))["nodes"].values():
        assert not any(p["settable"] for p in node["properties"].values()), node
    refuses(scene, house, Homie5)
    house.face.stop()
    house = start(scene, WirenBoard)
    until(lambda: house.listener.last(f"{WirenBoard.topic('relay')}/meta"), 20, "it has a meta")
    assert json.loads(house.listener.last(f"{WirenBoard.topic('relay')}/meta"))["readonly"] is True
    refuses(scene, house, WirenBoard)


def test_a_killed_owsd_mqtt_leaves_its_will_and_an_ended_one_its_goodbye(scene):
    for profile in BOTH:
        house = start(scene, profile)
        house.face.kill()
        house.says(profile.state, profile.lost)
        house.face = house.start()
        house.says(profile.state, profile.word)
        assert house.face.stop() == 0
        house.says(profile.state, profile.ended)


def test_a_lost_owsd_is_lost_and_none_of_its_values_is_good(scene):
    for profile in BOTH:
        house = start(scene, profile)
        profile.shows_good(house, "room", "21.5")
        house.daemon.kill()
        house.says(profile.state, profile.lost)
        if profile is Homie5:
            house.says(Homie5.topic("room"), "")
            # the state says it, and not an alert of each signal
            house.says(f"{Homie5.root}/$alert/room", "")
        else:
            profile.shows_bad(house, "room", "")
        house.daemon = scene.owsd(house.daemon.config, name=house.daemon.name)
        profile.shows_good(house, "room", "21.5")
        house.says(profile.state, profile.word)
        house.face.stop()


def test_a_reload_takes_back_all_of_a_signal_that_is_no_more(scene):
    for profile in BOTH:
        house = start(scene, profile, ROOM, RELAY, ABSENT, PULL)
        profile.shows_good(house, "room", "21.5")
        profile.shows_bad(house, "absent", "device absent")
        before = house.listener.last(f"{Homie5.root}/$description")
        house.daemon.config.write_text(house.text({**ROOM, "Name": "cellar"}, RELAY, PULL))
        house.daemon.signal(signal.SIGHUP)
        if profile is Homie5:  # the property stays, by its id, and has another name
            until(lambda: '"cellar"' in house.listener.last(f"{Homie5.root}/$description"), 20, "cellar comes")
            house.says(Homie5.topic("room"), "21.5")
        else:
            until(lambda: house.listener.last(WirenBoard.topic("cellar")) == "21.5", 20, "cellar comes")

        def rest(house=house, profile=profile):
            return [t for t in house.kept(f"{profile.root}/#")
                    if "room" in t or "absent" in t or t == Homie5.topic("absent")]
        until(lambda: not rest(), 40, rest, step=0.5)
        house.says(profile.state, profile.word)
        if profile is Homie5:
            after = house.listener.last(f"{Homie5.root}/$description")
            assert json.loads(after)["version"] > json.loads(before)["version"] and '"room"' not in after, after
            # a description changes while the device is "init" alone
            said = [(t, p) for _, t, p in house.listener.all() if t in (Homie5.state, f"{Homie5.root}/$description")]
            assert said[said.index((f"{Homie5.root}/$description", after)) - 1] == (Homie5.state, "init"), said
        house.face.stop()


def test_another_profile_empties_what_the_one_before_has_left_and_nothing_of_others(scene):
    house = House(scene, ROOM, RELAY)
    house.says("owsd/pi7/state", "online")
    strangers = {"owsd/pi8/room": "1", "homie/5/pi7/$state": "ready", "/devices/pi7/meta": '{"driver":"owsd"}',
                 "homeassistant/device/owsd_28_A0B1C2000009/config": '{"dev":{"via_device":"owsd_pi8"}}'}
    for topic, text in strangers.items():
        subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-r", "-t", topic, "-m", text],
                       check=True, timeout=owsdtest.PATIENCE)
    roots = {"plain": ("owsd/pi7/",), "homie5": ("homie/5/owsd-pi7/",), "wirenboard": ("/devices/owsd_pi7/",),
             "homeassistant": ("owsd/pi7/", "homeassistant/device/")}
    for profile, own in roots.items():
        house.daemon.config.write_text(house.text(ROOM, RELAY, Profile=profile))
        house.face.signal(signal.SIGHUP)

        def rest(own=own):
            return [t for t in house.kept() if t not in strangers and not t.startswith(own)]
        until(lambda own=own: any(t.startswith(own[-1]) for t in house.kept()) and not rest(), 60,
              lambda: (profile, rest(), house.face.log()), step=0.5)
    assert strangers.items() <= house.kept().items(), house.kept()


def test_a_profile_that_comes_while_owsd_is_lost_publishes_nothing_at_topics_of_the_one_before(scene):
    house = House(scene, ROOM, Profile="plain")
    house.arrives("room", lambda m: m["good"])
    house.daemon.kill()
    house.says("owsd/pi7/state", "offline")
    house.daemon.config.write_text(house.text(ROOM, Profile="wirenboard"))
    house.face.signal(signal.SIGHUP)
    house.says(WirenBoard.state, WirenBoard.lost)
    house.daemon = scene.owsd(house.daemon.config, name=house.daemon.name)
    WirenBoard.shows_good(house, "room", "21.5")
    assert not [t for _, t, _ in house.listener.all() if t.startswith("owsd/pi7/room/")], house.listener.all()


if __name__ == "__main__":
    owsdtest.main(at_once=4)
