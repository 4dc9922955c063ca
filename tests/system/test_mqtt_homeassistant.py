#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What owsd-mqtt says to Home Assistant: a device for each chip, by its id, and one of the node."""

import json
import signal
import subprocess

import owsdtest
from mqtthouse import ABSENT, RELAY, ROOM, SENSOR, SWITCH, House, item, program
from owsdtest import raw, until

KEY = "01.213DDC8770E9"
CHIP = "homeassistant/device/owsd_28_A0B1C2000001/config"
PORTS = "homeassistant/device/owsd_29_A0B1C2000004/config"
NODE = "homeassistant/device/owsd_pi7/config"
# Keys of Home Assistant's schemas, as abbreviations of homeassistant/components/mqtt/abbreviations.py
ALLOWED = {"p", "uniq_id", "name", "stat_t", "val_tpl", "dev_cla", "unit_of_meas", "stat_cla", "exp_aft",
           "sug_dsp_prc", "json_attr_t", "json_attr_tpl", "cmd_t", "pl_on", "pl_off", "min", "max", "step",
           "mode", "stat_val_tpl", "on_cmd_type", "bri_cmd_t", "bri_stat_t", "bri_val_tpl", "bri_scl",
           "pl_open", "pl_cls", "pl_stop", "set_pos_t", "pos_t", "pos_tpl", "pos_clsd", "pos_open", "avty",
           "evt_typ", "t", "ent_cat"}
PROBLEM = f"owsd/pi7/chip/{SENSOR}/problem"


def device(house, topic):
    text = until(lambda: house.listener.last(topic), 20, f"{topic} is announced")
    message = json.loads(text)
    for id_, component in message["cmps"].items():
        assert set(component) <= ALLOWED, (id_, set(component) - ALLOWED)
        assert component.get("uniq_id", id_) == id_
    return message


def publish(house, topic, text, *options):
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "1", "-t", topic, "-m", text,
                    *options], check=True, timeout=owsdtest.PATIENCE)


def test_each_chip_that_was_there_is_a_device_by_its_id_behind_the_node(scene):
    house = House(scene, {**ROOM, "StaleAfter": 10, "LimitH": 30, "Decimals": 1}, RELAY, ABSENT, Link="http://pi7:8080/")
    message = device(house, CHIP)
    assert message["dev"] == {
        "ids": [SENSOR], "name": "room", "mdl": "DS18B20", "mf": "Maxim Integrated", "sn": SENSOR,
        "via_device": "owsd_pi7", "cu": "http://pi7:8080/"}, message
    assert message["o"]["name"] == "owsd"
    assert [a["t"] for a in message["avty"]] == ["owsd/pi7/state", f"owsd/pi7/chip/{SENSOR}/state"]
    assert message["avty_mode"] == "all" and message["qos"] == 1
    room = message["cmps"]["owsd_28_A0B1C2000001_temperature"]
    assert room["p"] == "sensor" and room["name"] is None and room["stat_t"] == "owsd/pi7/room"
    assert (room["dev_cla"], room["unit_of_meas"], room["stat_cla"]) == ("temperature", "°C", "measurement"), room
    assert room["sug_dsp_prc"] == 1 and room["exp_aft"] == 20, room
    assert room["val_tpl"] == "{{ value_json.v if value_json.good else None }}"
    # what is not in each message has a default: Home Assistant logs what is undefined
    assert "value_json.simulated | default(false)" in room["json_attr_tpl"], room
    alarm = message["cmps"]["owsd_28_A0B1C2000001_temperature_alarm"]
    assert (alarm["p"], alarm["dev_cla"], alarm["stat_t"]) == ("binary_sensor", "problem", "owsd/pi7/room/alarm")
    problem = message["cmps"]["owsd_28_A0B1C2000001_problem"]
    assert (problem["dev_cla"], problem["stat_t"], problem["avty"]) == ("problem", PROBLEM, [{"t": "owsd/pi7/state"}])
    house.says(PROBLEM, '{"problem":false,"health":"check function","why":null,"signal":null,"bad":0}')
    node = device(house, NODE)
    assert node["dev"]["ids"] == ["owsd_pi7"] and [a["t"] for a in node["avty"]] == ["owsd/pi7/state"]
    assert {c["stat_t"] for c in node["cmps"].values()} == {"owsd/pi7/health"}
    health = house.arrives("health", lambda m: m["down"] == 0)
    assert health["signals"] == 3 and [t["state"] for t in health["targets"]] == ["up"], health
    # without Write an output is only shown; who was never there is not announced
    relay = device(house, PORTS)["cmps"]["owsd_29_A0B1C2000004_PIO_0"]
    assert relay["p"] == "binary_sensor" and "cmd_t" not in relay, relay
    house.arrives("absent", lambda m: m["q"] == 8)
    assert "homeassistant/device/owsd_28_FFFFFFFFFFFF/config" not in house.kept("homeassistant/#")


def test_outputs_are_what_their_class_says_once_writing_is_on(scene):
    def out(number, kind, **more):
        return item(f"o{number}", f"/{SWITCH}/PIO.{number}", kind, "output", **more)
    house = House(scene, out(0, "bool"), out(1, "bool", Class="light"), out(2, "bool", Class="cover"),
                  item("all", f"/{SWITCH}/PIO.BYTE", "byte", "output", Max=100, Class="light"),
                  item("meter", f"/{SENSOR}/temperature", Class="energy"),
                  item("door", f"/{SWITCH}/sensed.4", "bool", Class="door"),
                  item("kind", f"/{SWITCH}/type", "string"), Write=raw("on"))
    found = device(house, PORTS)
    assert found["cmps"].pop("owsd_29_A0B1C2000004_problem")["stat_t"].endswith("/problem")
    parts = {c["stat_t"].rsplit("/", 1)[1]: c for c in found["cmps"].values()}
    assert {n: c["p"] for n, c in parts.items()} == {
        "o0": "switch", "o1": "light", "o2": "cover", "all": "number", "door": "binary_sensor",
        "kind": "sensor"}, parts
    assert found["dev"]["name"] == f"DS2408 {SWITCH}" and parts["o0"]["name"] == "o0"
    assert all(parts[n]["cmd_t"] == f"owsd/pi7/{n}/set" for n in ("o0", "o1", "o2", "all"))
    assert (parts["all"]["min"], parts["all"]["max"], parts["all"]["step"]) == (0, 100, 1)
    assert parts["door"]["dev_cla"] == "door" and "dev_cla" not in parts["o1"]
    assert parts["o2"]["pl_stop"] is None
    # of energy Home Assistant takes no measurement
    assert [c["stat_cla"] for c in device(house, CHIP)["cmps"].values() if c["p"] == "sensor"] == ["total_increasing"]


def test_all_is_announced_again_when_home_assistant_starts_and_no_more_often(scene):
    house = House(scene, ROOM)
    device(house, CHIP)
    house.says("owsd/pi7/state", "online")
    before = len(house.listener.all(CHIP))
    publish(house, "homeassistant/status", "offline")
    publish(house, "homeassistant/status", "online")
    until(lambda: len(house.listener.all(CHIP)) > before, 20, "it is announced again")
    for _ in range(20):
        publish(house, "homeassistant/status", "online")
    assert len(house.listener.all(CHIP)) <= before + 2, house.listener.all(CHIP)


def test_a_rename_keeps_the_entity_and_moves_its_topic(scene):
    house = House(scene, ROOM)
    first = device(house, CHIP)
    house.daemon.config.write_text(house.text({**ROOM, "Name": "cellar"}))
    house.daemon.signal(signal.SIGHUP)
    house.arrives("cellar", lambda m: m["v"] == 21.5)
    until(lambda: "owsd/pi7/cellar" in house.listener.last(CHIP), 20, "it is announced again")
    second = device(house, CHIP)
    assert list(first["cmps"]) == list(second["cmps"]) and first["dev"]["ids"] == second["dev"]["ids"]
    # the last thing that the old topic said is no number
    house.says("owsd/pi7/room", "")
    said = [p for _, t, p in house.listener.all("owsd/pi7/room")]
    assert said[-1] == "" and json.loads(said[-2])["v"] is None, said


def test_a_chip_that_is_replaced_keeps_its_device_and_entities(scene):
    house = House(scene, ROOM, RELAY)
    first = device(house, CHIP)
    other = item("room", f"/{SWITCH}/sensed.BYTE", Identity=ROOM["Path"])
    house.daemon.config.write_text(house.text(other, RELAY))
    house.daemon.signal(signal.SIGHUP)
    house.arrives("room", lambda m: m["good"] and m["v"] != 21.5)
    second = device(house, CHIP)
    assert list(first["cmps"]) == list(second["cmps"]) == [
        "owsd_28_A0B1C2000001_temperature", "owsd_28_A0B1C2000001_problem"], second
    assert first["dev"]["ids"] == second["dev"]["ids"] == [SENSOR], second
    # the number on it is that of the chip that is there
    assert (first["dev"]["sn"], second["dev"]["sn"]) == (SENSOR, SWITCH), second
    assert f"owsd/pi7/chip/{SENSOR}/state" in house.kept()


def test_what_went_while_owsd_mqtt_was_down_is_emptied_and_nothing_of_others(scene):
    house = House(scene, {**ROOM, "LimitH": 30}, RELAY, item("type", f"/{SENSOR}/type", "string"))
    device(house, PORTS)
    house.says("owsd/pi7/state", "online")
    house.says("owsd/pi7/relay", house.listener.last("owsd/pi7/relay"))
    others = {"homeassistant/device/owsd_28_A0B1C2000003/config": '{"dev":{"via_device":"owsd_pi70"}}',
              "homeassistant/device/lamp/config": '{"dev":{"ids":["lamp"]}}', "owsd/pi70/room": "1",
              "owsd/pi7/room/note": "1"}
    for topic, text in others.items():
        publish(house, topic, text, "-r")
    house.face.stop()
    house.daemon.config.write_text(house.text({**ROOM, "Name": "cellar"}, item("type", f"/{SENSOR}/type", "string")))
    house.daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(house.daemon, "cellar"), 20, "owsd has reloaded")
    house.face = house.start()
    gone = {"owsd/pi7/room", "owsd/pi7/room/alarm", "owsd/pi7/relay", f"owsd/pi7/chip/{SWITCH}/state", f"owsd/pi7/chip/{SWITCH}/problem", PORTS}
    until(lambda: not gone & set(house.kept()), 30, lambda: gone & set(house.kept()), step=0.5)
    kept = house.kept()
    assert {t: kept.get(t) for t in others} == others, kept
    assert {CHIP, NODE, "owsd/pi7/cellar", "owsd/pi7/type", f"owsd/pi7/chip/{SENSOR}/state", PROBLEM, "owsd/pi7/health"} <= set(kept), kept
    assert kept["owsd/pi7/state"] == "online", kept


def test_an_entity_that_is_no_more_is_removed_and_its_device_stays(scene):
    lamp = item("lamp", f"/{SWITCH}/PIO.1", "bool", "output")
    house = House(scene, ROOM, RELAY, lamp, Write=raw("on"))
    device(house, PORTS)
    house.says("owsd/pi7/state", "online")
    house.daemon.config.write_text(house.text(ROOM, RELAY, Write=raw("off")))
    house.daemon.signal(signal.SIGHUP)

    def removal():
        # Home Assistant takes a platform alone for the end
        return [{i for i, c in json.loads(p)["cmps"].items() if c == {"p": "switch"}}
                for _, t, p in house.listener.all(PORTS) if p and '{"p":"switch"}' in p]
    until(removal, 30, lambda: house.listener.all(PORTS))
    # a switch that becomes a sensor is another entity
    assert "owsd_29_A0B1C2000004_PIO_1" in removal()[0], removal()
    until(lambda: '{"p":"switch"}' not in house.listener.last(PORTS), 20, lambda: device(house, PORTS))
    assert {c["p"] for c in device(house, PORTS)["cmps"].values()} == {"binary_sensor"}, device(house, PORTS)
    assert len(device(house, PORTS)["cmps"]) == 2
    # no message of the device was without its name
    assert {json.loads(p)["dev"]["name"] for _, _, p in house.listener.all(PORTS)} <= {f"DS2408 {SWITCH}", "relay"}


def test_a_reload_announces_what_is_another_alone_and_empties_nothing(scene):
    house = House(scene, ROOM, RELAY)
    device(house, PORTS)
    house.says("owsd/pi7/state", "online")
    before = {topic: len(house.listener.all(topic)) for topic in (CHIP, PORTS, NODE)}
    looks = house.broker.process.log().count("Received UNSUBSCRIBE")
    house.daemon.config.write_text(house.text({**ROOM, "Description": "the room"}, RELAY))
    house.daemon.signal(signal.SIGHUP)
    until(lambda: device(house, CHIP)["dev"]["name"] == "the room", 20, lambda: device(house, CHIP))
    # the look at what the broker keeps is over, too
    until(lambda: house.broker.process.log().count("Received UNSUBSCRIBE") > looks, 30, "the look is over")
    assert len(house.listener.all(CHIP)) == before[CHIP] + 1, house.listener.all(CHIP)
    assert {t: len(house.listener.all(t)) for t in (PORTS, NODE)} == {t: before[t] for t in (PORTS, NODE)}
    assert all(text for topic in before for _, _, text in house.listener.all(topic))


def test_old_readers_has_a_message_and_the_way_can_be_changed(scene):
    house = House(scene, ROOM, RELAY)
    sensor, problem = (f"homeassistant/{p}/owsd_pi7/owsd_28_A0B1C2000001_{name}/config"
                       for p, name in (("sensor", "temperature"), ("binary_sensor", "problem")))
    device(house, CHIP)
    for each, there, gone in (("on", {sensor, problem}, {CHIP, PORTS, NODE}), ("off", {CHIP, PORTS, NODE}, {sensor, problem})):
        house.daemon.config.write_text(house.text(ROOM, RELAY, OldReaders=raw(each)))
        house.face.signal(signal.SIGHUP)
        until(lambda t=there, g=gone: t <= set(house.kept()) and not g & set(house.kept()), 40, house.kept, step=0.5)
        # who took the old ones gets the new ones after their end
        lines = [(t, bool(p)) for _, t, p in house.listener.all()]
        assert max(lines.index((t, False)) for t in gone) < len(lines) - 1 - lines[::-1].index((min(there), True)), lines
    house.daemon.config.write_text(house.text(ROOM, OldReaders=raw("on")))
    house.daemon.signal(signal.SIGHUP)
    until(lambda: sensor in house.kept() and not [t for t in house.kept() if "29_A0B1" in t], 40, house.kept, step=0.5)
    text = json.loads(house.kept()[sensor])
    assert text["dev"]["ids"] == [SENSOR] and text["stat_t"] == "owsd/pi7/room" and len(text["avty"]) == 2, text
    assert [a["t"] for a in json.loads(house.kept()[problem])["avty"]] == ["owsd/pi7/state"]


def test_a_chip_that_is_away_has_a_problem_with_its_reason(scene):
    house = House(scene, ROOM, item("attic", "/28.A0B1C2000002/temperature"),
                  wire="DS18B20 28.A0B1C2000002 as attic temperature 18\nat 4s unplug attic\n")
    topic = PROBLEM.replace(SENSOR, "28.A0B1C2000002")
    house.says(topic, '{"problem":false,"health":"check function","why":null,"signal":null,"bad":0}')
    house.says(topic, '{"problem":true,"health":"failure","why":"device absent","signal":"attic","bad":1}')
    assert json.loads(house.listener.last(PROBLEM))["problem"] is False


def test_a_chip_that_is_written_in_two_ways_is_one_device(scene):
    house = House(scene, ROOM, item("coarse", f"/{SENSOR.replace('.', '').lower()}/temperature9"),
                  item("again", f"/uncached/{SENSOR}/temperature"))
    house.says("owsd/pi7/state", "online")
    message = device(house, CHIP)
    assert message["dev"]["ids"] == [SENSOR] and len(message["cmps"]) == 4, message
    assert {c["stat_t"] for c in message["cmps"].values()} - {PROBLEM} == {f"owsd/pi7/{n}" for n in ("room", "coarse", "again")}
    kept = house.kept()
    assert {t for t in kept if t.startswith("homeassistant/")} == {CHIP, NODE}, kept
    assert {t for t in kept if "/chip/" in t} == {f"owsd/pi7/chip/{SENSOR}/state", PROBLEM}, kept


def test_a_key_is_a_tag_each_time_it_comes(scene):
    house = House(scene, item("key", f"/{KEY}/present", "bool"), ROOM,
                  wire=f"DS2401 {KEY} as key\nat 3s every 5s unplug key for 2s\n")
    message = device(house, "homeassistant/device/owsd_01_213DDC8770E9/config")
    tags = [c for c in message["cmps"].values() if c["p"] == "tag"]
    assert tags == [{"p": "tag", "t": "owsd/pi7/key/tag"}], message
    # it was there at the start, and that is no coming
    assert not house.listener.all("owsd/pi7/key/tag")
    until(lambda: house.last("key") and not house.last("key")["v"], 20, "it is away")
    house.says("owsd/pi7/key/tag", KEY)


def test_another_place_of_discovery_and_none(scene):
    house = House(scene, ROOM, Discovery="ha/found")
    device(house, CHIP.replace("homeassistant", "ha/found"))
    house.daemon.config.write_text(house.text(ROOM, Profile="plain", Topic="plain"))
    house.face.signal(signal.SIGHUP)
    until(lambda: house.listener.last("plain/pi7/state") == "online", 20, "the profile is another")
    assert not [t for _, t, _ in house.listener.all() if t.startswith("homeassistant")]


if __name__ == "__main__":
    owsdtest.main(at_once=4)
