#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-mqtt as an edge node of Sparkplug B. pysparkplug reads what it publishes, and writes commands;
a host looks at each message as the standard has it."""

import json
import pathlib
import re
import signal
import time

import owsdtest
from clients import python_client
from mqtthouse import MQTT, RELAY, ROOM, SENSOR, SWITCH, Broker, House, Listener, item
from owsdtest import free_port, logged, raw, until
from test_mqtt_commands import journal, publish

PROBE = "28.A0B1C2000009"
ON = {"Write": raw("on")}
NODE_DEATH = "spBv1.0/plant/NDEATH/pi7"


def codec():
    return python_client("pysparkplug", pathlib.Path(__file__).with_name("sparkplug.txt"), "sparkplug")


class Host:
    """A host: reads what came, in its order, and complains of what is not as the standard has it."""

    def __init__(self, listener):
        self.listener, self.codec = listener, codec()
        self.pb = python_client("pysparkplug._protobuf", pathlib.Path(__file__).with_name("sparkplug.txt"), "sparkplug")
        self.read = 0
        self.heard = []   # (verb, device, metrics by name)
        self.births = {}  # device, None of the node: its birth
        self.seq = self.bdseq = None
        self.metrics = []  # (where its message is in heard, device, metric): all, in their order

    def look(self):
        """[(verb, device, {name: metric})] of all up to now."""
        for qos, retained, topic, payload in self.listener.lines()[self.read:]:
            self.read += 1
            if re.search("/[ND]CMD/|/STATE/", topic):
                continue
            where = self.codec.Topic.from_str(topic)
            assert (where.group_id, where.edge_node_id) == ("plant", "pi7"), topic
            verb = where.message_type.name.lower()
            assert retained == "0" and qos == ("1" if verb == "ndeath" else "0"), (topic, qos, retained)
            self.device = where.device_id
            self.heard.append((verb, where.device_id, self.take(verb, where.device_id, bytes.fromhex(payload))))
        return self.heard

    def take(self, verb, device, data):
        message = self.pb.Payload.FromString(data)
        times = [m.timestamp for m in message.metrics]
        assert message.timestamp > 1.6e12 and times == sorted(times), message
        if verb == "ndeath":
            death = self.codec.NDeath.decode(data)
            assert not message.HasField("seq") and len(message.metrics) == 1, message
            assert death.bd_seq_metric.name == "bdSeq"
            if self.births:
                assert death.bd_seq_metric.value == self.bdseq, (death, self.bdseq)
            self.births, self.seq = {}, None
            return {"bdSeq": death.bd_seq_metric}
        expected = 0 if verb == "nbirth" else (self.seq + 1) % 256
        assert message.HasField("seq") and message.seq == expected, (verb, device, message.seq, expected)
        self.seq = message.seq
        if verb == "nbirth":
            self.births = {}
        if verb.endswith("birth"):
            return self.birth(verb, device, data, message)
        if verb == "ddeath":
            assert not message.metrics and self.births.pop(device), message
            return {}
        birth = self.births[device]
        health = {m.alias for m in birth.metrics if m.name.startswith("Health/")}
        for metric in message.metrics:
            assert not metric.name and not metric.HasField("datatype") and metric.HasField("alias"), metric
            if metric.alias not in health:
                self.quality(metric)
        decoded = (self.codec.NData if verb == "ndata" else self.codec.DData).decode(data, birth=birth)
        return self.named(decoded.metrics, message.metrics)

    def birth(self, verb, device, data, message):
        decoded = (self.codec.NBirth if verb == "nbirth" else self.codec.DBirth).decode(data)
        for metric in message.metrics:
            assert metric.name and metric.datatype and metric.timestamp, metric
            assert metric.HasField("alias") != (metric.name == "Node Control/Rebirth"), metric
            if metric.name not in ("bdSeq", "Node Control/Rebirth") and not metric.name.startswith("Health/"):
                self.quality(metric)
        self.births[device] = decoded
        aliases = [m.alias for b in self.births.values() for m in b.metrics if m.alias is not None]
        assert len(set(aliases)) == len(aliases) and all(a < 2**53 for a in aliases), aliases
        found = self.named(decoded.metrics, message.metrics)
        if verb == "nbirth":
            self.bdseq = found["bdSeq"].value
            assert found["bdSeq"].datatype == self.codec.DataType.INT64
            assert found["Node Control/Rebirth"].value is False
        else:
            assert None in self.births, "a device is born before its node"
        return found

    @staticmethod
    def properties(metric):
        return dict(zip(metric.properties.keys, metric.properties.values))

    def quality(self, metric):
        """A value is a number if, and only if, it is good."""
        quality = self.properties(metric)["Quality"]
        assert quality.type == 3 and quality.int_value in (0, 192, 500), metric
        # nobody takes a value of the simulator for one of a plant
        if quality.int_value == 192:
            assert self.properties(metric)["Simulated"].boolean_value is True, metric
        assert metric.is_null == (quality.int_value != 192) == (metric.WhichOneof("value") is None), metric

    def named(self, decoded, raws):
        found = {}
        for metric, one in zip(decoded, raws):
            object.__setattr__(metric, "properties", self.properties(one))
            found[metric.name] = metric
            self.metrics.append((len(self.heard), self.device, metric))
        return found

    def hears(self, verb, device, fits=lambda m: True, after=0):
        """Where such a message is, and what it has."""
        def find():
            for i, (v, d, m) in enumerate(self.look()[after:], after):
                if v == verb and d == device and fits(m):
                    return i, m
            return None
        return until(find, 20, lambda: f"{verb} {device} comes: {self.heard[after:]}")


def start(scene, *items, wire="", env=None, **keys):
    codec()
    house = House(scene, *items, wire=wire, env=env, Profile="sparkplug", Topic="plant", **keys)
    # what came before is in the house's own listener alone, so the face starts again
    house.face.stop()
    (house.state / "number").unlink(missing_ok=True)
    listener = Listener(scene, house.broker.port, "spBv1.0/#", ["-F", "=%q\t%r\t%t\t%x"])
    house.face = house.start(env)
    return house, Host(listener)


def command(house, host, topic, *metrics, options=()):
    """metrics: (name or alias, type, value)."""
    sent = [host.codec.Metric(timestamp=1, name=n if isinstance(n, str) else None, alias=None if isinstance(n, str) else n,
                              datatype=host.codec.DataType[t], value=v, is_null=v is None) for n, t, v in metrics]
    data = host.codec.NCmd(timestamp=int(time.time() * 1000), metrics=tuple(sent)).encode(include_dtypes=True)
    publish(house, f"spBv1.0/plant/{topic}", data, *options)


def test_the_births_have_all_that_is_there_and_data_has_aliases_alone(scene):
    house, host = start(scene, ROOM, RELAY, item("absent", "/28.FFFFFFFFFFFF/temperature"),
                        item("cold", f"/{PROBE}/temperature", "short"), item("kind", f"/{SENSOR}/type", "string"),
                        wire=f"DS18B20 {PROBE} temperature -5\n")
    at, node = host.hears("nbirth", None)
    assert at == 0 and node["bdSeq"].value == 0 and set(node) == {
        "bdSeq", "Node Control/Rebirth", "Health/Targets Down", "Health/Signals Not Good", "Health/Errors", "Health/Reconnects"}, node
    types = host.codec.DataType
    _, room = host.hears("dbirth", SENSOR)
    assert room["room"].datatype == types.DOUBLE and room["room"].properties["engUnit"].string_value == "°C", room
    assert room["room"].properties["readOnly"].boolean_value is True
    host.hears("dbirth", PROBE)
    _, ports = host.hears("dbirth", SWITCH)
    assert ports["relay"].datatype == types.BOOLEAN and ports["relay"].properties["readOnly"].boolean_value is False

    def now(device, name):
        known = [m[name] for v, d, m in host.look() if d == device and name in m]
        return known[-1].value if known else None
    until(lambda: (now(SENSOR, "room"), now(SENSOR, "kind"), now(PROBE, "cold")) == (21.5, "DS18B20", -5), 20,
          lambda: host.heard)
    house.set("relay", "1")
    host.hears("ddata", SWITCH, lambda m: m["relay"].value is True)
    house.set("relay", "0")
    host.hears("ddata", SWITCH, lambda m: m["relay"].value is False)
    # who was never there is not born, and nothing of the other profiles stands at the broker
    assert not [h for h in host.look() if h[1] == "28.FFFFFFFFFFFF"], host.heard
    assert not house.kept() and not [t for _, t, _ in house.listener.all() if not t.startswith("spBv1.0/plant/")]


def test_at_a_common_start_all_devices_are_born_before_data_flows(scene):
    """A thermometer is read for the first time when a relay has been set many times."""
    house, host = start(scene, ROOM, RELAY)
    host.hears("dbirth", SENSOR)
    house.face.stop()
    house.daemon.stop()
    begun = len(host.look())
    house.daemon = scene.owsd(house.text(ROOM, RELAY), name=house.daemon.name)
    house.face = house.start()
    born = ("dbirth", SENSOR)
    for i in range(400):
        house.set("relay", str(i % 2))
        if born in [h[:2] for h in host.look()[begun:]]:
            break
    heard = [h[:2] for h in host.look()[begun:]]
    assert ("dbirth", SWITCH) in heard and ("nbirth", None) in heard, heard
    assert not [h for h in heard[:heard.index(born)] if h[0].endswith("data")], heard


def test_a_limit_alarm_is_a_metric_beside_its_signal(scene):
    house, host = start(scene, {**ROOM, "LimitH": 20}, RELAY, **ON)
    at, born = host.hears("dbirth", SENSOR)
    assert set(born) == {"room", "room/Alarm"} and born["room/Alarm"].datatype == host.codec.DataType.BOOLEAN, born
    assert born["room/Alarm"].properties["readOnly"].boolean_value is True

    def now():
        known = [m["room/Alarm"] for _, d, m in host.look() if d == SENSOR and "room/Alarm" in m]
        return known[-1].value
    until(lambda: now() is True, 20, lambda: host.heard)
    at = len(host.look())
    house.daemon.config.write_text(house.text({**ROOM, "LimitH": 30}, RELAY))
    house.daemon.signal(signal.SIGHUP)
    host.hears("dbirth", SENSOR, after=at)
    until(lambda: now() is False, 20, lambda: host.heard)
    command(house, host, f"DCMD/pi7/{SENSOR}", ("room/Alarm", "BOOLEAN", True))
    logged(house.face, "command to \"room/Alarm\" refused: the last birth has no such metric there")
    house.daemon.stop()
    until(lambda: now() is None, 20, lambda: host.heard)


def test_a_sensor_that_is_pulled_is_null_and_dead_and_comes_back(scene):
    _, host = start(scene, ROOM, item("probe", f"/{PROBE}/temperature"),
                    wire=f"DS18B20 {PROBE} as probe temperature 5\nat 3s every 6s unplug probe for 3s\n")
    lost, _ = host.hears("ddata", PROBE, lambda m: m["probe"].properties["Quality"].int_value == 0)
    dead, _ = host.hears("ddeath", PROBE, after=lost)
    born, _ = host.hears("dbirth", PROBE, after=dead)
    known = [m["probe"] for v, d, m in host.look()[born:] if d == PROBE and "probe" in m]
    assert known[0].value == 5 or host.hears("ddata", PROBE, lambda m: m["probe"].value == 5, born)
    assert not [h for h in host.look()[lost + 1:dead] if h[1] == PROBE], host.heard
    assert not [h for h in host.look() if h[:2] == ("ddeath", SENSOR)], host.heard


def test_a_host_that_asks_gets_the_births_again_and_one_that_asks_all_the_time_not_all_of_them(scene):
    house, host = start(scene, ROOM, RELAY)
    last, _ = host.hears("dbirth", SWITCH)
    command(house, host, "NCMD/pi7", ("Node Control/Rebirth", "BOOLEAN", True))
    again, node = host.hears("nbirth", None, after=last)
    assert node["bdSeq"].value == 0
    host.hears("dbirth", SENSOR, after=again)
    host.hears("dbirth", SWITCH, after=again)
    command(house, host, "NCMD/pi7", ("Node Control/Rebirth", "BOOLEAN", False))
    for _ in range(20):
        command(house, host, "NCMD/pi7", ("Node Control/Rebirth", "BOOLEAN", True))
    host.hears("nbirth", None, after=again + 1)
    births = len([h for h in host.look() if h[0] == "nbirth"])
    assert births < 12, host.heard


def test_commands_go_the_way_of_all_commands(scene):
    dial = item("dial", f"/{SWITCH}/PIO.BYTE", "byte", "output", Max=200)
    house, host = start(scene, ROOM, RELAY, dial, **ON)
    _, ports = host.hears("dbirth", SWITCH)
    until(lambda: "DCMD/pi7/+ (QoS 1)" in house.broker.process.log(), 20, "it listens to commands")
    assert "NCMD/pi7 (QoS 1)" in house.broker.process.log()
    relay, there = ports["relay"].alias, f"DCMD/pi7/{SWITCH}"
    command(house, host, there, (relay, "BOOLEAN", True), options=("-V", "5", "-D", "publish", "user-property", "person", "anna"))
    at, _ = host.hears("ddata", SWITCH, lambda m: m["relay"].value is True)
    until(lambda: '"anna"' in journal(house), 20, lambda: journal(house))
    command(house, host, there, ("relay", "BOOLEAN", False), ("dial", "UINT8", 17))
    host.hears("ddata", SWITCH, lambda m: "dial" in m and m["dial"].value == 17, at)
    until(lambda: '"mqtt:127.0.0.1"' in journal(house), 20, lambda: journal(house))
    refused = (
        (there, (relay, "DOUBLE", 1.0), "command to \"relay\" refused: its datatype is not that of the birth"),
        (there, ("relay", "STRING", "1"), "command to \"relay\" refused: its datatype is not that of the birth"),
        (there, ("relay", "BOOLEAN", None), "command to \"relay\" refused: it is null"),
        (there, ("dial", "UINT8", 201), "command to \"dial\" refused: \"201\" is no value for it: expected 0 to 200"),
        (there, (relay + 77, "BOOLEAN", True), f"command to \"alias {relay + 77}\" refused: the last birth has no such"),
        (there, ("room", "DOUBLE", 1.0), "command to \"room\" refused: the last birth has no such metric there"),
        ("NCMD/pi7", ("relay", "BOOLEAN", True), "command to \"relay\" refused: the last birth has no such metric there"),
        ("DCMD/pi7/28.FFFFFFFFFFFF", ("relay", "BOOLEAN", True), "the last birth has no such metric there"),
        (f"DCMD/pi7/{SENSOR}", ("room", "DOUBLE", 1.0), "command to \"room\" refused: it is an input"),
    )
    for topic, metric, words in refused:
        command(house, host, topic, metric)
        logged(house.face, words)
    command(house, host, there, ("dial", "UINT8", 3), options=("-r",))
    logged(house.face, "command to \"dial\" refused: it is retained")
    publish(house, f"spBv1.0/plant/{there}", b"\xff\xff")
    logged(house.face, "no payload of Sparkplug B")
    command(house, host, there, ("dial", "UINT8", 18))
    host.hears("ddata", SWITCH, lambda m: "dial" in m and m["dial"].value == 18, at)
    assert scene.get(house.daemon, "relay") == "0"


def test_without_write_nothing_is_set(scene):
    house, host = start(scene, ROOM, RELAY)
    host.hears("dbirth", SWITCH)
    command(house, host, "NCMD/pi7", ("relay", "BOOLEAN", True))
    logged(house.face, "Write is off")
    command(house, host, f"DCMD/pi7/{SWITCH}", ("relay", "BOOLEAN", True))
    until(lambda: house.face.log().count("command to \"relay\" refused: Write is off") == 2, 20, lambda: house.face.log())


def test_a_command_to_reboot_is_refused_with_a_reason(scene):
    house, host = start(scene, ROOM, RELAY, **ON)
    host.hears("dbirth", SENSOR)
    command(house, host, "NCMD/pi7", ("Node Control/Reboot", "BOOLEAN", True))
    logged(house.face, "command to \"Node Control/Reboot\" refused: nothing restarts a plant over a broker: "
                       "systemctl restart owsd-mqtt on the machine itself")
    # it goes on
    command(house, host, "NCMD/pi7", ("Node Control/Rebirth", "BOOLEAN", True))
    until(lambda: [h[0] for h in host.look()].count("nbirth") == 2, 20, lambda: host.heard)


def test_the_death_has_the_number_of_the_birth_and_each_connection_its_own(scene):
    house, host = start(scene, ROOM)
    host.hears("dbirth", SENSOR)
    house.face.kill()
    at, _ = host.hears("ndeath", None, lambda m: m["bdSeq"].value == 0)
    house.face = house.start()
    # another process goes on counting: a will of the last one that comes late is of no living session
    at, _ = host.hears("nbirth", None, lambda m: m["bdSeq"].value == 1, at)
    house.face.stop()
    at, _ = host.hears("ndeath", None, after=at)
    house.face = house.start()
    again, _ = host.hears("nbirth", None, after=at)
    assert again == at + 1, host.heard  # it died once
    port = house.broker.port
    house.broker.process.stop()
    house.broker.start()
    host.listener = Listener(scene, port, "spBv1.0/#", ["-F", "=%q\t%r\t%t\t%x"])
    host.read, after, host.births = 0, len(host.heard), {}
    at, node = host.hears("nbirth", None, after=after)
    assert node["bdSeq"].value == 3, node
    house.face.kill()
    _, death = host.hears("ndeath", None, after=at)
    assert death["bdSeq"].value == 3, death
    # after 255 comes 0, and a file that says nothing is as none
    for kept, number in (("255", 0), ("none", 0)):
        (house.state / "number").write_text(kept)
        house.face = house.start()
        at, _ = host.hears("nbirth", None, lambda m, n=number: m["bdSeq"].value == n, at + 1)
        house.face.stop()
        at, _ = host.hears("ndeath", None, after=at)


def test_after_a_reload_all_is_born_again_and_an_old_alias_means_nothing(scene):
    house, host = start(scene, RELAY, ROOM, **ON)
    _, ports = host.hears("dbirth", SWITCH)
    host.hears("dbirth", SENSOR)
    house.daemon.config.write_text(house.text({**RELAY, "Name": "pump"}, ROOM, **ON))
    at = len(host.look())
    house.daemon.signal(signal.SIGHUP)
    at, node = host.hears("nbirth", None, after=at)
    assert node["bdSeq"].value == 0
    _, again = host.hears("dbirth", SWITCH, after=at)
    assert set(again) == {"pump"} and again["pump"].alias != ports["relay"].alias, (ports, again)
    command(house, host, f"DCMD/pi7/{SWITCH}", (ports["relay"].alias, "BOOLEAN", True))
    logged(house.face, "the last birth has no such metric there")
    command(house, host, f"DCMD/pi7/{SWITCH}", (again["pump"].alias, "BOOLEAN", True))
    host.hears("ddata", SWITCH, lambda m: m["pump"].value is True, at)


def test_without_owsd_no_value_is_good_and_no_device_there(scene):
    house, host = start(scene, ROOM)
    at, _ = host.hears("dbirth", SENSOR)
    house.daemon.stop()
    at, _ = host.hears("ddata", SENSOR, lambda m: m["room"].is_null, at)
    at, _ = host.hears("ddeath", SENSOR, after=at)
    house.daemon = scene.owsd(house.daemon.config, name=house.daemon.name)
    at, _ = host.hears("nbirth", None, after=at)
    host.hears("dbirth", SENSOR, after=at)
    assert not [h for h in host.look() if h[0] == "ndeath"], host.heard


def test_what_other_profiles_have_left_is_emptied_when_this_one_comes(scene):
    codec()
    house = House(scene, ROOM, RELAY, Topic="plant")
    house.says("plant/pi7/state", "online")
    strangers = {"plant/pi8/room": "1", "homie/5/pi7/$state": "ready", "spBv1.0/STATE/host": "{}"}
    left = {"homie/5/owsd-pi7/$state": "lost", "/devices/owsd_pi7/meta": "{}"}
    for topic, text in {**strangers, **left}.items():
        publish(house, topic, text, "-r")
    assert len(house.kept()) > 8, house.kept()
    house.daemon.config.write_text(house.text(ROOM, RELAY, Profile="sparkplug"))
    house.face.signal(signal.SIGHUP)
    until(lambda: any("/NBIRTH/pi7" in t for _, t, _ in house.listener.all()), 20, lambda: house.face.log())
    until(lambda: house.kept() == strangers, 60, house.kept, step=0.5)


def test_a_session_waits_for_its_primary_host_and_ends_with_it(scene):
    house, host = start(scene, ROOM, RELAY, PrimaryHost="scada")

    def said(online, ms, times):
        """What comes behind it shows that it has come."""
        until(lambda: house.face.log().count("connected to") == times and
              "STATE/scada (QoS 1)" in house.broker.process.log().rpartition(" as owsd-pi7")[2], 20, lambda: house.broker.process.log())
        publish(house, "spBv1.0/STATE/scada", json.dumps({"timestamp": ms, "online": online}), "-r")
        command(house, host, "NCMD/pi7", ("none", "BOOLEAN", True))
    refused = "command to \"none\" refused: "
    logged(house.face, "nothing is published until the primary host scada is online")
    said(False, 1000, 1)
    said(True, 999, 1)
    publish(house, "spBv1.0/STATE/other", '{"online":true,"timestamp":5000}', "-r")
    until(lambda: house.face.log().count(refused) == 2, 20, lambda: house.face.log())
    assert not host.look(), host.heard
    said(True, 1000, 1)
    at, node = host.hears("nbirth", None)
    assert at == 0 and node["bdSeq"].value == 0, host.heard
    host.hears("dbirth", SWITCH)
    # the will of an older connection of the host comes late
    said(False, 999, 1)
    until(lambda: house.face.log().count(refused) == 4, 20, lambda: house.face.log())
    house.set("relay", "1")
    at, _ = host.hears("ddata", SWITCH, lambda m: m["relay"].value is True)
    publish(house, "spBv1.0/STATE/scada", '{ "online" : false, "timestamp" : 1000 }', "-r")
    at, _ = host.hears("ndeath", None, lambda m: m["bdSeq"].value == 0, at)
    logged(house.face, "the primary host scada is offline")
    said(False, 1001, 2)
    until(lambda: house.face.log().count(refused) == 5, 20, lambda: house.face.log())
    assert not host.look()[at + 1:], host.heard  # it dies once
    said(True, 2000, 2)
    at, node = host.hears("nbirth", None, after=at + 1)
    assert node["bdSeq"].value == 1, node
    _, ports = host.hears("dbirth", SWITCH, after=at)
    assert ports["relay"].value is True, ports


def test_ways_at_which_the_host_never_is_are_looked_at_in_turn_and_logged_once(scene):
    """It takes two minutes: owsd-mqtt waits for one at each way."""
    other = Broker(scene)
    house = House(scene, ROOM, Profile="sparkplug", Topic="plant", PrimaryHost="scada",
                  Broker=f"{other.url} | mqtt://127.0.0.1:{free_port()} | {{}}")
    until(lambda: other.process.log().count(" as owsd-pi7 ") == 2, 200, lambda: house.face.log(), step=0.5)
    until(lambda: other.process.log().count("STATE/scada (QoS 1)") == 2, 20, lambda: other.process.log())
    assert house.face.log().count("connected to") == 2, house.face.log()
    assert house.face.log().count("cannot be reached") == 1, house.face.log()
    publish(house, "spBv1.0/STATE/scada", '{"online":true,"timestamp":1000}', "-r", "-p", str(other.port))
    logged(house.face, f"the primary host scada is online, at {other.url}")


def test_a_group_has_no_slash(scene):
    owsdtest.need(MQTT)
    text = owsdtest.rio("sim:", [ROOM], Mqtt=raw('{ Profile "sparkplug" Topic "a/b" }'))
    done = scene.owsd_once("--check", "-c", scene.file("slash.rio", text))
    assert done.returncode == 2 and "group of Sparkplug" in done.stdout + done.stderr, done


if __name__ == "__main__":
    owsdtest.main(at_once=4)
