#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What other programs make of owsd-mqtt, each a genuine one: the flow for Node-RED, imported and run; Telegraf; and
wb-hass-gw, which PyPI does not have: a clone of github.com/Hacker-CB/wb-hass-gw below OWSD_PEERS."""

import json
import os
import pathlib
import subprocess

import clients
import gobuild
import nodered
import owsdtest
from mqtthouse import RELAY, ROOM, SENSOR, House, item, program
from owsdtest import raw, until

TELEGRAF = ("github.com/influxdata/telegraf/cmd/telegraf", "v1.37.2",
            "-tags", "custom,inputs.mqtt_consumer,outputs.file,parsers.json,serializers.json")
GATEWAY = ["gmqtt==0.8.0", "PyYAML==6.0.4", "voluptuous==0.11.7"]
PULL = dict(item("pull", "/simulator/unplug", "bool", "output"), InitValue="0")
FLOW = owsdtest.SOURCE / "board/fleet/node-red.json"


def test_the_flow_for_node_red_has_values_commands_and_answers(scene):
    house = House(scene, ROOM, RELAY, Write=raw("on"))
    flow = json.loads(FLOW.read_text())
    nodes = {node["id"]: node for node in flow}
    nodes["owsd-broker"].update(broker="127.0.0.1", port=str(house.broker.port))
    # in place of a person: one that publishes what is shown, and one that presses the button
    for shown, topic in (("owsd-number", "judge/number"), ("owsd-results", "judge/answer")):
        nodes[shown]["wires"][0].append(f"{shown}-topic")
        flow += [{"id": f"{shown}-topic", "type": "change", "z": "owsd-flow", "wires": [[f"{shown}-out"]],
                  "rules": [{"t": "set", "p": "topic", "pt": "msg", "to": f"'{topic}/' & $split(topic, '/')[2]", "tot": "jsonata"}]},
                 {"id": f"{shown}-out", "type": "mqtt out", "z": "owsd-flow", "topic": "", "broker": "owsd-broker", "wires": []}]
    flow.append({"id": "judge-press", "type": "mqtt in", "z": "owsd-flow", "topic": "judge/press", "broker": "owsd-broker",
                 "qos": "1", "datatype": "utf8", "inputs": 0, "wires": [["owsd-set"]]})
    judge = nodered.start(scene, flow)
    until(lambda: house.listener.last("judge/number/room") == "21.5", 90, lambda: judge.log()[-3000:])
    house.arrives("room", lambda m: m["good"])
    # the output that nobody has set is not good, so it is not shown, and has no other side
    assert house.listener.last("judge/number/relay") is None

    def press(text):
        subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "1", "-t", "judge/press", "-m", text],
                       check=True, timeout=owsdtest.PATIENCE)

    def answered(part):
        until(lambda: part in (house.listener.last("judge/answer/relay") or ""), 20, lambda: house.listener.all("judge/answer/relay"))
    press("toggle")
    answered("nothing says which the other one is")
    press("on")
    answered('"taken":true')
    until(lambda: house.listener.last("judge/number/relay") == "true", 20, "it is shown")
    press("toggle")
    until(lambda: house.listener.last("judge/number/relay") == "false", 20, "it is toggled")
    assert "error" not in judge.log().lower(), judge.log()


def test_telegraf_has_a_number_for_each_number_and_the_reason_where_there_is_none(scene):
    command, out = gobuild.program(*TELEGRAF), scene.path / "telegraf.json"
    house = House(scene, ROOM, RELAY, PULL, wire=f"button unplug unplug {SENSOR}\n")
    house.arrives("room", lambda m: m["good"])
    settings = scene.file("telegraf.conf", f"""
[agent]
  interval = "1s"
  flush_interval = "1s"
  omit_hostname = true
[[inputs.mqtt_consumer]]
  servers = ["tcp://127.0.0.1:{house.broker.port}"]
  topics = ["owsd/+/+"]
  data_format = "json"
  json_string_fields = ["why"]
[[outputs.file]]
  files = ["{out}"]
  data_format = "json"
""")
    judge = scene.start([command, "--config", settings], {"HOME": str(scene.path)})

    def fields(name):
        """The fields of each message of the signal, in their order."""
        lines = [json.loads(line) for line in out.read_text().splitlines(keepends=True) if line.endswith("\n")] if out.exists() else []
        return [line["fields"] for line in lines if line["tags"]["topic"] == f"owsd/pi7/{name}"]

    def has(name, fits):
        until(lambda: any(map(fits, fields(name))), 60, lambda: f"{fields(name)}\n{judge.log()[-3000:]}")
    has("room", lambda f: f["v"] == 21.5 and f["q"] == 192 and f["t"] > 0 and "why" not in f)
    house.set("pull", 1)
    has("room", lambda f: "v" not in f and f["q"] < 64 and f["why"] == "device absent")
    house.set("pull", 0)
    until(lambda: fields("room")[-1].get("v") == 21.5, 60, lambda: fields("room"))
    # a field has one type; that of a bool is left out by its parser
    assert {type(f["v"]) for f in fields("room") if "v" in f} == {float}, fields("room")
    house.set("relay", 1)
    has("relay", lambda f: f["q"] == 192 and "v" not in f)


def test_wb_hass_gw_makes_entities_of_what_stands_there_for_readers_of_meta(scene):
    peers = os.environ.get("OWSD_PEERS") or owsdtest.skip("OWSD_PEERS names no directory with clones")
    gateway = pathlib.Path(peers) / "wb-hass-gw/wb-hass-gw.py"
    if not gateway.exists():
        owsdtest.skip(f"not there: {gateway}")
    python = clients.environment("wb-hass-gw", GATEWAY) / "python"
    house = House(scene, ROOM, RELAY, PULL, Profile="wirenboard", OldReaders=raw("on"), Write=raw("on"),
                  wire=f"button unplug unplug {SENSOR}\n")
    broker = f"broker_host: 127.0.0.1, broker_port: {house.broker.port}"
    settings = scene.file("gateway.yaml", f"wirenboard: {{{broker}, client_id: wb}}\n"
                          f"homeassistant: {{{broker}, client_id: ha, topic_prefix: gw/}}\n")
    judge = scene.start([python, gateway, "-c", settings])
    control, heard = "gw/devices/owsd_pi7/controls", house.listener.last

    def hears(topic, text):
        until(lambda: heard(topic) == text, 30, lambda: f"{topic}: {house.listener.all(topic)}\n{judge.log()[-3000:]}")
    hears(f"{control}/room", "21.5")
    hears(f"{control}/room/availability", "1")
    sensor = json.loads(heard("homeassistant/sensor/owsd_pi7/room/config"))
    assert sensor["state_topic"] == f"{control}/room" and sensor["unit_of_measurement"] == "deg C", sensor
    until(lambda: heard("homeassistant/switch/owsd_pi7/relay/config"), 30, judge.log)
    switch = json.loads(heard("homeassistant/switch/owsd_pi7/relay/config"))
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "1", "-t", switch["command_topic"], "-m",
                    switch["payload_on"]], check=True, timeout=owsdtest.PATIENCE)
    hears(switch["state_topic"], switch["state_on"])
    assert scene.get(house.daemon, "relay") == "1"
    house.set("pull", 1)
    hears(f"{control}/room/availability", "0")
    house.set("pull", 0)
    hears(f"{control}/room/availability", "1")


if __name__ == "__main__":
    owsdtest.main()
