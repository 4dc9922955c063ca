#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-mqtt beside a real owsd and a real mosquitto: what stands at the broker is what there is, and
what is bad has no number."""

import json
import re
import signal
import subprocess
import time

import owsdtest
from mqtthouse import ABSENT, RELAY, ROOM, SENSOR, Broker, House, Listener, item, program
from owsdtest import logged, raw, until

STATE = "owsd/pi7/state"


def test_values_stand_at_the_broker_with_quality_and_time_and_a_bad_one_without_a_number(scene):
    house = House(scene)
    room = house.arrives("room", lambda m: m["good"])
    # nobody takes it for a value of a plant
    assert room == {"v": 21.5, "good": True, "q": 192, "simulated": True, "t": room["t"]}, room
    assert room["t"] is None or abs(room["t"] / 1000 - time.time()) < 60, room
    absent = house.arrives("absent", lambda m: m["q"] == 8)
    assert (absent["v"], absent["good"], absent["why"]) == (None, False, "device absent"), absent
    house.says(STATE, "online")
    house.says(f"owsd/pi7/chip/{SENSOR}/state", "online")
    house.says("owsd/pi7/chip/28.FFFFFFFFFFFF/state", "offline")
    for value in (True, False, True):
        house.set("relay", int(value))
        house.arrives("relay", lambda m, v=value: m["v"] is v and m["good"])
    kept = house.kept("owsd/#")
    assert '"v":21.5' in kept["owsd/pi7/room"] and kept[STATE] == "online", kept
    # the state comes after what it is about
    topics = [t for _, t, _ in house.listener.all()]
    assert topics.index(STATE) > topics.index("owsd/pi7/room"), topics


def test_nothing_is_published_while_nothing_changes(scene):
    house = House(scene, ROOM)
    house.arrives("room", lambda m: m["good"])
    house.says(STATE, "online")
    # the counter of updates shows that it was measured meanwhile
    before = house.listener.all("owsd/pi7/room")
    count = scene.owsctl(house.daemon, "--json", "get", "room").stdout
    until(lambda: scene.owsctl(house.daemon, "--json", "get", "room").stdout.split('"count":')[1].split(",")[0] !=
          count.split('"count":')[1].split(",")[0], 20, "it is measured again")
    assert house.listener.all("owsd/pi7/room") == before


def test_health_of_a_plant_with_an_absent_chip_is_still(scene):
    """Also of one with an alarm that cannot be armed, an output that cannot be written, an alias."""
    house = House(scene, ROOM, RELAY, ABSENT,
                  item("away", "/29.FFFFFFFFFFFF/PIO.0", "bool", "output", InitValue=1),
                  item("latch", "/29.FFFFFFFFFFFE/sensed.0", "bool", Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
                       SetAlarm="set_alarm=133333333", ResetLatch="latch.BYTE=0"),
                  top={"PerFactor": 1})
    for name in ("absent", "away", "latch"):
        house.arrives(name, lambda m: m["q"] != 0x20 and not m["good"])

    def errors():
        """All counters of errors that are not 0."""
        lines = house.scene.owsctl(house.daemon, "metrics").stdout.splitlines()
        return {line for line in lines if line.startswith("ows_") and "error" in line.split("}")[0] and line[-2:] != " 0"}

    before = owsdtest.settled(errors, times=60)
    assert any("ows_device_errors_total" in line for line in before), before
    health = len(house.listener.all("owsd/pi7/health"))
    owsdtest.worked(house.daemon.name, 12)
    assert errors() == before, errors() ^ before
    assert len(house.listener.all("owsd/pi7/health")) <= health + 1, house.listener.all("owsd/pi7/health")


def test_a_killed_owsd_mqtt_leaves_its_will_and_an_ended_one_says_so(scene):
    house = House(scene)
    house.says(STATE, "online")
    house.face.kill()
    house.says(STATE, "offline")
    house.face = house.start()
    house.says(STATE, "online")
    begun = time.monotonic()
    assert house.face.stop() == 0
    assert time.monotonic() - begun < 5
    house.says(STATE, "offline")
    assert "will" not in house.face.log()


def test_a_chip_that_is_away_is_offline_though_nobody_knows_of_an_output_of_it(scene):
    gone = "29.FFFFFFFFFFFF"
    house = House(scene, ROOM, item("away", f"/{gone}/sensed.0", "bool"),
                  item("never", f"/{gone}/PIO.0", "bool", "output"))
    house.arrives("away", lambda m: m["q"] == 8)
    house.arrives("never", lambda m: m["q"] == 32)
    house.says(f"owsd/pi7/chip/{gone}/state", "offline")
    house.says(f"owsd/pi7/chip/{SENSOR}/state", "online")


def test_a_lost_owsd_takes_all_values_back_until_it_is_there_again(scene):
    house = House(scene)
    house.arrives("room", lambda m: m["good"])
    house.daemon.kill()
    house.says(STATE, "offline")
    room = house.arrives("room", lambda m: not m["good"])
    assert room["v"] is None and room["why"] == "owsd not running", room
    house.says(f"owsd/pi7/chip/{SENSOR}/state", "offline")
    scene.owsd(house.daemon.config, name=house.daemon.name)
    house.arrives("room", lambda m: m["good"])
    house.says(STATE, "online")
    house.says(f"owsd/pi7/chip/{SENSOR}/state", "online")


def test_a_value_within_its_deadband_does_not_expire(scene):
    house = House(scene, {**ROOM, "StaleAfter": 4, "Deadband": 50})
    house.arrives("room", lambda m: m["good"])
    seen = len(house.listener.all("owsd/pi7/room"))
    until(lambda: any(json.loads(text)["good"] for _, _, text in house.listener.all("owsd/pi7/room")[seen:]), 30, house.face.log)


def test_a_broker_that_comes_late_or_forgets_all_gets_all(scene):
    house = House(scene)
    house.arrives("room", lambda m: m["good"])
    house.broker.process.stop()
    logged(house.face, "is lost")
    house.set("relay", 1)
    # nothing was kept, and the listener is a new one too
    house.broker.start()
    house.listener = Listener(scene, house.broker.port)
    house.arrives("room", lambda m: m["good"])
    house.arrives("relay", lambda m: m["v"] is True)
    house.says(STATE, "online")
    assert house.face.log().count("is lost") == 1, house.face.log()
    # who hears nothing of the broker may not be ended by it
    house.broker.process.freeze()
    begun = time.monotonic()
    assert house.face.stop() == 0
    assert time.monotonic() - begun < 5
    house.broker.process.thaw()
    house.says(STATE, "offline")


def test_a_reload_moves_renamed_signals_and_empties_what_is_no_more(scene):
    house = House(scene, ROOM, ABSENT)
    house.arrives("room", lambda m: m["good"])
    house.daemon.config.write_text(house.text({**ROOM, "Name": "cellar"}, item("state", ROOM["Path"])))
    house.daemon.signal(signal.SIGHUP)
    house.arrives("cellar", lambda m: m["v"] == 21.5)
    # a name that is one of ours
    house.arrives("%73tate", lambda m: m["v"] == 21.5)
    house.says("owsd/pi7/room", "")
    house.says("owsd/pi7/absent", "")
    kept = house.kept("owsd/#")
    assert "owsd/pi7/room" not in kept and kept[STATE] == "online", kept


def test_what_a_person_does_with_an_alarm_is_an_event(scene):
    house = House(scene, {**ROOM, "LimitH": 20}, RELAY)
    house.says(STATE, "online")
    until(lambda: json.loads(house.listener.last("owsd/pi7/room/alarm") or "{}").get("active"), 20, "it is an alarm")
    assert scene.owsctl(house.daemon, "alarms", "ack", "room").returncode == 0
    until(lambda: '"event_type":"acknowledged"' in (house.listener.last("owsd/pi7/room/event") or ""), 20,
          lambda: house.listener.all("owsd/pi7/room/event"))


def test_another_topic_or_broker_of_the_file_is_taken_at_once(scene):
    house = House(scene, ROOM)
    house.says(STATE, "online")
    other = Broker(scene)
    listener = Listener(scene, other.port)
    house.daemon.config.write_text(house.text(ROOM, Broker=other.url, Topic="site/ows"))
    house.face.signal(signal.SIGHUP)
    until(lambda: listener.last("site/ows/pi7/state") == "online", 20, lambda: listener.all())
    until(lambda: '"v":21.5' in listener.last("site/ows/pi7/room"), 20, lambda: listener.all())
    house.says(STATE, "offline")


def test_stats_show_the_broker_the_counters_and_what_was_wrong_last(scene):
    house = House(scene, ROOM, RELAY, Write=raw("on"))

    def face():
        done = scene.owsctl(house.daemon, "--json", "stats")
        assert done.returncode == 0, done
        return (json.loads(done.stdout)["faces"] or [None])[0]

    def becomes(fits):
        return until(lambda: face() and fits(face()) and face(), 30, lambda: f"stats: {face()}", step=0.2)
    found = becomes(lambda f: f["counters"]["messages_acknowledged"] > 2)
    assert found["program"] == "owsd-mqtt" and found["pid"] == house.face.pid and found["alive"], found
    assert house.broker.url in found["status"] and found["connected"] and not found["trouble"], found
    assert found["counters"]["connects"] == 1 and not found["counters"]["messages_refused"], found
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-t", "owsd/pi7/relay/set", "-m", "7"],
                   check=True, timeout=owsdtest.PATIENCE)
    found = becomes(lambda f: f["counters"]["commands_refused"] == 1)
    assert 'command to "relay" refused: "7" is no value' in found["trouble"], found
    assert found["trouble_age"] < 60, found
    assert re.search(r"last error \S+( \S+)? ago: command to \"relay\" refused", scene.owsctl(house.daemon, "stats").stdout)
    house.broker.process.stop()
    found = becomes(lambda f: not f["connected"] and " lost" in f["trouble"] or "cannot be reached" in f["trouble"])
    house.broker.start()
    # its status is of its last tick
    becomes(lambda f: f["connected"] and f["counters"]["connects"] == 2 and f["status"].startswith("publishing to"))
    text = scene.owsctl(house.daemon, "stats").stdout
    assert f"owsd-mqtt, pid {house.face.pid}: publishing to" in text and "2  connects\n" in text, text
    # one that hangs or was killed is seen; one that ended has left nothing
    house.face.freeze()
    becomes(lambda f: not f["alive"])
    assert "silent" in scene.owsctl(house.daemon, "stats").stdout
    house.face.thaw()
    assert house.face.stop() == 0 and face() is None


if __name__ == "__main__":
    owsdtest.main(at_once=4)
