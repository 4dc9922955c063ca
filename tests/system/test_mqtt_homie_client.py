#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a genuine controller of Homie 5 (ebus-sdk) makes of owsd-mqtt: it finds the device, follows its
values, sees when one is bad, and its commands move outputs."""

import os

import clients
import owsdtest
from mqtthouse import RELAY, ROOM, SENSOR, House, item
from owsdtest import raw, until

WANTED = ["ebus-sdk==0.27.0", "ebus-mqtt-client==0.8.0", "paho-mqtt==2.1.0"]
# A line for each thing that it notices; it carries out the lines that come
CONTROLLER = """
import sys
from ebus_sdk.homie import Controller
c = Controller(mqtt_cfg={"host": "127.0.0.1", "port": int(sys.argv[1])}, homie_domain="homie")
c.set_on_property_changed_callback(lambda device, node, name, value, *_: print(f"{node}/{name}={value};", flush=True))
c.set_on_device_discovered_callback(lambda device: print(f"found {device.device_id};", flush=True))
c.start_discovery()
for line in sys.stdin:
    device, node, name, value = line.split()
    have = c.get_device(device).get_node_properties(node)[name]
    print(f"{name} {have['datatype']} {have['settable']};", flush=True)
    c.set_property(device, node, name, value)
"""


def test_it_finds_the_device_follows_it_and_commands_it(scene):
    program = clients.environment("homie", WANTED) / "python"
    house = House(scene, ROOM, RELAY, item("pull", "/simulator/unplug", "bool", "output"), Profile="homie5",
                  wire=f"button unplug unplug {SENSOR}\n", Write=raw("on"))
    orders = scene.path / "orders"
    os.mkfifo(orders)
    judge = scene.start(["sh", "-c", 'exec "$0" -c "$1" "$2" < "$3"', program, CONTROLLER, str(house.broker.port),
                         orders])

    def notices(*lines):
        until(lambda: set(lines) <= {line.rstrip(";") for line in judge.log().splitlines()}, 30, lambda: f"{lines}: {judge.log()}")
    with open(orders, "w", encoding="ascii") as order:
        notices("found owsd-pi7", "28-a0b1c2000001/temperature=21.5")
        house.set("pull", 1)
        notices("28-a0b1c2000001/temperature=", "$alert/room=room: device absent")
        house.set("pull", 0)
        until(lambda: judge.log().split("=room: device absent;")[-1].count("temperature=21.5;"), 30, judge.log)
        order.write("owsd-pi7 29-a0b1c2000004 pio-0 true\n")
        order.flush()
        notices("pio-0 boolean True", "29-a0b1c2000004/pio-0=true")
        assert scene.get(house.daemon, "relay") == "1"


if __name__ == "__main__":
    owsdtest.main()
