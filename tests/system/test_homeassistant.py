#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the genuine Home Assistant makes of owsd-mqtt: it takes each kind of entity, what is lost is
unavailable there, and its commands move outputs."""

import json
import re
import signal
import subprocess

import owsdtest
from hajudge import HomeAssistant
from mqtthouse import RELAY, ROOM, SENSOR, SWITCH, Broker, House, item, program
from owsdtest import BUILD, SOURCE, raw, until

ATTIC, KEY, NOTE = "28.A0B1C2000002", "01.213DDC8770E9", "2D.A0B1C2000009"
PORTS = [f"29.A0B1C200001{n}" for n in range(4)]
WIRE = f"""
DS2408 {PORTS[0]}
DS2408 {PORTS[1]}
DS2408 {PORTS[2]}
DS2408 {PORTS[3]} pin.4 steps 0:1 2s:0 repeat 4s
DS2431 {NOTE}
DS2401 {KEY} as key
at 3s every 8s unplug key for 3s
"""
KINDS = [
    {**ROOM, "LimitH": 30, "Decimals": 1, "StaleAfter": 10},
    RELAY,
    item("lamp", f"/{SWITCH}/PIO.1", "bool", "output", Class="light"),
    item("gate", f"/{SWITCH}/PIO.2", "bool", "output", Class="cover"),
    item("door", f"/{SWITCH}/sensed.4", "bool", Class="door"),
    item("dial", f"/{PORTS[0]}/PIO.BYTE", "byte", "output", Max=200),
    item("dimmer", f"/{PORTS[1]}/PIO.BYTE", "byte", "output", Min=0, Max=200, Class="light"),
    item("blind", f"/{PORTS[2]}/PIO.BYTE", "byte", "output", Min=0, Max=200, Class="cover"),
    item("inputs", f"/{PORTS[3]}/sensed.BYTE", "byte", Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
         SetAlarm="set_alarm=133333333", ResetLatch="latch.BYTE=0"),
    item("note", f"/{NOTE}/pages/page.0", "string", "output"),
    item("kind", f"/{NOTE}/type", "string"),
    item("key", f"/{KEY}/present", "bool"),
]
BOARD = "ds2408_29_a0b1c2000004"


def test_it_takes_each_kind_of_entity_and_moves_outputs(scene):
    house = House(scene, *KINDS, wire=WIRE, Write=raw("on"), Link="http://pi7.local:8080/")
    judge = HomeAssistant(scene, house.broker.port)
    judge.shows("sensor.room", "21.5")
    judge.shows("binary_sensor.room_limit_alarm", "off")
    judge.shows("binary_sensor.room_problem", "off")
    registry = judge.device(SENSOR)
    assert (registry["manufacturer"], registry["model"], registry["serial_number"], registry["configuration_url"]) == (
        "Maxim Integrated", "DS18B20", SENSOR, "http://pi7.local:8080/"), registry
    judge.shows(f"binary_sensor.{BOARD}_door", "on")
    judge.shows("binary_sensor.owsd_pi7_bus", "on")
    judge.shows("sensor.ds2431_2d_a0b1c2000009_kind", "DS2431")
    # an output that nobody has commanded yet is unknown, and Home Assistant can command it
    for action, entity, data, name, value, state in (
            ("switch.turn_on", f"switch.{BOARD}_relay", {}, "relay", True, "on"),
            ("switch.turn_off", f"switch.{BOARD}_relay", {}, "relay", False, "off"),
            ("light.turn_on", f"light.{BOARD}_lamp", {}, "lamp", True, "on"),
            ("light.turn_off", f"light.{BOARD}_lamp", {}, "lamp", False, "off"),
            ("cover.open_cover", f"cover.{BOARD}_gate", {}, "gate", True, "open"),
            ("cover.close_cover", f"cover.{BOARD}_gate", {}, "gate", False, "closed"),
            ("number.set_value", "number.dial", {"value": 17}, "dial", 17, "17"),
            ("light.turn_on", "light.dimmer", {"brightness_pct": 50}, "dimmer", 100, "on"),
            ("light.turn_off", "light.dimmer", {}, "dimmer", 0, "off"),
            ("cover.open_cover", "cover.blind", {}, "blind", 200, "open"),
            ("cover.set_cover_position", "cover.blind", {"position": 50}, "blind", 100, "open"),
            ("cover.close_cover", "cover.blind", {}, "blind", 0, "closed"),
            ("text.set_value", "text.ds2431_2d_a0b1c2000009_note", {"value": "hello"}, "note", "hello", "hello")):
        judge.act(action, entity, **data)
        house.arrives(name, lambda m, v=value: m["good"] and m["v"] == v)
        judge.shows(entity, state)
    assert "mqtt:127.0.0.1" in scene.owsctl(house.daemon, "journal").stdout
    # events and keys
    until(lambda: judge.states()["event.inputs_device_event"][3] in ("raised", "returned"), 30, lambda: judge.states())
    until(lambda: judge.listener.last("judge/tag") == f"tag {KEY}", 30, "the key is a tag")
    assert not judge.complaints(), "\n".join(judge.complaints())
    # every component that was announced became an entity, but the tag
    announced = [c["p"] for topic, text in house.kept("homeassistant/device/#").items()
                 for c in json.loads(text)["cmps"].values()]
    kinds = sorted(e.split(".")[0] for e, (_, device, *_) in judge.states().items() if device != "None" and "backup" not in e)
    assert kinds == sorted(kind for kind in announced if kind != "tag"), (kinds, announced)
    assert set(announced) == {"sensor", "binary_sensor", "switch", "number", "light", "cover", "event", "tag", "text"}
    # another name of a signal is the same entity of the same device
    device = judge.states()[f"switch.{BOARD}_relay"][1]
    house.daemon.config.write_text(house.text(*[{**i, "Name": "pump"} if i is RELAY else i for i in KINDS]))
    house.daemon.signal(signal.SIGHUP)
    house.arrives("pump", lambda m: m["q"])
    judge.act("switch.turn_on", f"switch.{BOARD}_relay")
    house.arrives("pump", lambda m: m["v"] is True)
    judge.shows(f"switch.{BOARD}_relay", "on")
    # so is another chip in the place of the first, by Identity
    other = {**RELAY, "Name": "pump", "Path": f"/{PORTS[3]}/PIO.0", "Identity": RELAY["Path"]}
    house.daemon.config.write_text(house.text(*[other if i is RELAY else i for i in KINDS]))
    house.daemon.signal(signal.SIGHUP)
    until(lambda: json.loads(scene.owsctl(house.daemon, "--json", "list", "pump").stdout)[0]["path"] == other["Path"],
          20, "the other chip is served")
    for action, state, value in (("turn_off", "off", False), ("turn_on", "on", True)):
        judge.act(f"switch.{action}", f"switch.{BOARD}_relay")
        house.arrives("pump", lambda m, v=value: m["good"] and m["v"] is v)
        judge.shows(f"switch.{BOARD}_relay", state)
    assert judge.states()[f"switch.{BOARD}_relay"][1] == device
    assert not [e for e in judge.states() if "pump" in e], judge.states()
    assert not judge.complaints(), "\n".join(judge.complaints())


def test_what_is_lost_is_unavailable_within_its_time(scene):
    attic = item("attic", f"/{ATTIC}/temperature", StaleAfter=4)
    house = House(scene, {**ROOM, "StaleAfter": 4}, RELAY, attic,
                  wire=f"DS18B20 {ATTIC} as attic temperature 18.25\nat 5s every 40s unplug attic for 20s\n")
    judge = HomeAssistant(scene, house.broker.port)
    chip = f"owsd/pi7/chip/{ATTIC}/state"
    # a thermometer that is pulled off, and is put back
    judge.shows("sensor.attic", "18.25", 60)
    house.says(chip, "online")
    until(lambda: house.listener.last(chip) == "offline", 60, "it is pulled off")
    judge.shows("sensor.attic", "unavailable", 4)
    judge.shows("binary_sensor.attic_problem", "on", 4)
    assert judge.reason("binary_sensor.attic_problem") == "device absent", judge.states()
    assert judge.state("sensor.room") == "21.5", judge.states()
    judge.shows("sensor.attic", "18.25", 60)
    # owsd-mqtt hangs: the broker knows nothing of it yet
    house.face.freeze()
    judge.shows("sensor.room", "unavailable", 15)
    assert house.listener.last("owsd/pi7/state") == "online"
    house.face.thaw()
    judge.shows("sensor.room", "21.5")
    # owsd-mqtt dies, and comes again
    house.face.kill()
    judge.shows("sensor.room", "unavailable", 4)
    house.face = house.start()
    judge.shows("sensor.room", "21.5")
    # owsd dies
    house.daemon.kill()
    judge.shows("sensor.room", "unavailable", 10)
    assert not judge.complaints(), "\n".join(judge.complaints())


def test_the_blueprint_tells_of_alarms_and_of_what_is_lost(scene):
    wire = f"DS18B20 {ATTIC} as attic temperature 18.25\nat 5s every 60s unplug attic for 40s\n"
    house = House(scene, {**ROOM, "LimitH": 20}, RELAY, item("attic", f"/{ATTIC}/temperature"), wire=wire)
    told = {"action": "mqtt.publish", "data": {"topic": "judge/told", "payload": "{{ what }}"}}
    judge = HomeAssistant(scene, house.broker.port, owsdtest.SOURCE / "board/fleet/homeassistant.yaml",
                          actions=[told], patience={"seconds": 2})

    def tells(text, seconds=60):
        until(lambda: text in [t for _, _, t in judge.listener.all("judge/told")], seconds,
              lambda: f"{text}: {judge.listener.all('judge/told')}\n{judge.complaints()}")
    tells("room at pi7: high")
    tells(f"{ATTIC} at pi7 is lost", 120)
    house.face.kill()
    tells("pi7 is lost")
    assert not [t for _, _, t in judge.listener.all("judge/told") if t.startswith(SENSOR) or "relay" in t]
    assert not judge.complaints(), "\n".join(judge.complaints())


def test_a_ds9490r_at_the_kernel_is_there_goes_and_comes_back(scene):
    rig = SOURCE / "tests/kernel"
    files = [rig / "guest" / name for name in ("lib.sh", "w1lib.sh", "usblib.sh", "usb.sim", "homeassistant.sh", "homeassistant.sim")]
    programs = [BUILD / name for name in ("kernel/simchip", "owsd", "owsctl", "owsd-mqtt")]
    if not programs[0].exists():
        owsdtest.skip("the simulated adapter is not built: make kernel-programs")
    programs += [program(name) for name in ("mosquitto_pub", "mosquitto_sub")]
    broker = Broker(scene)
    judge = HomeAssistant(scene, broker.port)
    done = subprocess.run([rig / "boot", "--or-skip", "--time", "600", "--broker", str(broker.port), *(f"--program={p}" for p in programs),
                           *(f"--file={f}" for f in files), "homeassistant"], stdout=subprocess.PIPE, text=True, check=False)
    if skipped := re.search(r"^skip - (.*)", done.stdout, re.M):
        owsdtest.skip(skipped[1])
    assert done.returncode == 0, f"{done.stdout}\n{judge.states()}"
    assert not judge.complaints(), "\n".join(judge.complaints())


def test_one_of_2024_takes_messages_of_entities(scene):
    house = House(scene, {**ROOM, "LimitH": 30, "Decimals": 1}, RELAY, *KINDS[2:], wire=WIRE, Write=raw("on"), OldReaders=raw("on"),
                  Link="http://pi7.local:8080/")
    judge = HomeAssistant(scene, house.broker.port, year="2024")
    judge.shows("sensor.room", "21.5")
    judge.shows("binary_sensor.room_problem", "off")
    assert judge.device(SENSOR)["serial_number"] == SENSOR
    for action, state, value in (("turn_on", "on", True), ("turn_off", "off", False)):
        judge.act(f"switch.{action}", f"switch.{BOARD}_relay")
        house.arrives("relay", lambda m, v=value: m["good"] and m["v"] is v)
        judge.shows(f"switch.{BOARD}_relay", state)
    until(lambda: judge.listener.last("judge/tag") == f"tag {KEY}", 30, "the key is a tag")
    announced = [topic.split("/")[1] for topic in house.kept("homeassistant/+/owsd_pi7/+/config")]
    kinds = sorted(e.split(".")[0] for e, (_, device, *_) in judge.states().items() if device != "None")
    assert kinds == sorted(kind for kind in announced if kind != "tag"), (kinds, announced)
    assert not judge.complaints(), "\n".join(judge.complaints())
    # an entity that goes leaves it, and the others stay; it may still read the topic that is emptied behind it
    house.daemon.config.write_text(house.text(ROOM, *KINDS[2:], OldReaders=raw("on"), Write=raw("on")))
    house.daemon.signal(signal.SIGHUP)
    until(lambda: f"switch.{BOARD}_relay" not in judge.states(), 60, lambda: judge.states())
    judge.shows("sensor.room", "21.5")


if __name__ == "__main__":
    owsdtest.main(at_once=2)
