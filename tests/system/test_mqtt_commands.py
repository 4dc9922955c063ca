#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Commands from the broker: those that may come have their effect and their name in the journal, and
of all others nothing is left but a line of the log."""

import contextlib
import json
import pathlib
import re
import shlex
import signal
import socket
import subprocess
import threading
import time

import owsdtest
from mqtthouse import ABSENT, RELAY, ROOM, SENSOR, SWITCH, House, item, program
from owsdtest import logged, raw, segment, until
from writing import Writer

DIAL = item("dial", f"/{SWITCH}/PIO.BYTE", "byte", "output", Max=200)
LAMP = {**DIAL, "Min": 0, "Class": "light"}
ON = {"Write": raw("on")}


def publish(house, topic, text, *options, status=0):
    done = subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "1", "-t", topic,
                           *(["-m", text] if isinstance(text, str) and text else ["-s"] if text else ["-n"]),
                           *options], input=None if isinstance(text, str) else text, timeout=owsdtest.PATIENCE,
                          capture_output=True)
    assert done.returncode == status, done


def many(house, topic, lines):
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "0", "-t", topic, "-l"],
                   input="".join(f"{line}\n" for line in lines), text=True, check=True, timeout=owsdtest.PATIENCE)


def command(house, name, text, *options):
    publish(house, f"owsd/pi7/{name}/set", text, *options)


def transactions(house, name):
    return int(house.scene.get(house.daemon, f"{name}_TRANSACTIONS"))


def journal(house):
    done = house.scene.owsctl(house.daemon, "--json", "journal")
    assert done.returncode == 0, done
    return done.stdout


def ready(scene, *items, **keys):
    house = House(scene, *(items or (ROOM, RELAY)), **{**ON, **keys})
    house.says("owsd/pi7/state", "online")
    until(lambda: "owsd/pi7/+/set (QoS 1)" in house.broker.process.log(), 20, "it listens to commands")
    return house


def test_a_command_sets_the_output_and_the_journal_has_for_whom(scene):
    house = ready(scene, ROOM, RELAY, LAMP)
    for text, value in (("on", True), ("off", False), ("1", True), ("false", False)):
        command(house, "relay", text)
        house.arrives("relay", lambda m, v=value: m["v"] is v and m["good"])
    command(house, "relay", "on", "-V", "5", "-D", "publish", "user-property", "person", "anna")
    house.arrives("relay", lambda m: m["v"] is True)
    until(lambda: '"anna"' in journal(house), 20, lambda: journal(house))
    assert '"mqtt:127.0.0.1"' in journal(house) and '"owsd-mqtt"' in journal(house), journal(house)
    command(house, "dial", "17")
    house.arrives("dial", lambda m: m["v"] == 17)
    # of a light with Min and Max: all of it, or nothing
    command(house, "dial", "on")
    house.arrives("dial", lambda m: m["v"] == 200)
    command(house, "dial", "off")
    house.arrives("dial", lambda m: m["v"] == 0)
    # a person that cannot stand in a journal is none
    command(house, "relay", "off", "-V", "5", "-D", "publish", "user-property", "person", "a b\u202e")
    house.arrives("relay", lambda m: m["v"] is False)
    assert "a b" not in journal(house)


def test_a_command_has_an_answer_and_so_has_a_question(scene):
    house = ready(scene, ROOM, RELAY, LAMP)
    result = "owsd/pi7/relay/result"
    for text, answer in (("on", {"taken": True, "set": "on"}), ('{"v":false,"id":7}', {"taken": True, "set": "false", "id": 7}),
                         ("toggle", {"taken": True, "set": "toggle"}),
                         ("maybe", {"taken": False, "set": "maybe", "why": '"maybe" is no value for it: expected 0 or 1'})):
        command(house, "relay", text)
        until(lambda a=answer: json.loads(house.listener.last(result) or "{}") == a, 20, lambda: house.listener.all(result))
        # a toggle goes by the value that stands
        if text.startswith("{"):
            house.arrives("relay", lambda m: m["v"] is False)
    house.arrives("relay", lambda m: m["v"] is True)
    assert not any(retained for retained, _, _ in house.listener.all(result))
    # a light that is a number has two ends, but no other one before it was set
    command(house, "dial", "toggle")
    until(lambda: "nothing says which the other one is" in (house.listener.last("owsd/pi7/dial/result") or ""), 20, "it is refused")
    command(house, "dial", "on")
    house.arrives("dial", lambda m: m["v"] == 200)
    command(house, "dial", "toggle")
    house.arrives("dial", lambda m: m["v"] == 0)
    publish(house, "owsd/pi7/nobody/set", "1")
    until(lambda: "there is no such signal" in (house.listener.last("owsd/pi7/nobody/result") or ""), 20, "it is refused")
    # who asks gets the newest value
    house.arrives("room", lambda m: m["good"])
    publish(house, "owsd/pi7/room/get", '{"id":"a1"}')
    until(lambda: house.listener.last("owsd/pi7/room/result"), 20, "the value")
    value = json.loads(house.listener.last("owsd/pi7/room/result"))
    assert (value["v"], value["good"], value["id"]) == (21.5, True, "a1") and value["t"], value
    publish(house, "owsd/pi7/nobody/get", "")
    until(lambda: json.loads(house.listener.last("owsd/pi7/nobody/result")) == {"why": "there is no such signal"}, 20, "no value")


def test_a_signal_is_read_when_somebody_asks(scene):
    slow = dict(PerFactor=raw("20000"))
    house = ready(scene, {**ROOM, **slow}, RELAY)
    first = house.arrives("room", lambda m: m["good"] and m["t"])
    publish(house, "owsd/pi7/room/read", '{"id":7}')
    until(lambda: json.loads(house.listener.last("owsd/pi7/room/result") or "{}") == {"taken": True, "id": 7}, 20, house.face.log)
    # the same value, published for its time is another
    house.arrives("room", lambda m: m["good"] and m["t"] > first["t"])
    # a flood costs one reading in a period of 0.05 s
    reads, began = transactions(house, "room"), time.monotonic()
    many(house, "owsd/pi7/room/read", ["{}"] * 2000)
    logged(house.face, "command to \"room\" refused: more than 50 commands in a second")
    until(lambda: transactions(house, "room") > reads, 20, "it is read")
    reads = transactions(house, "room") - reads
    assert reads <= 20 * (time.monotonic() - began) + 2, reads
    # by hand it is a special signal
    now = transactions(house, "room")
    assert scene.owsctl(house.daemon, "set", "room_ReadOneShot", "1").returncode == 0
    until(lambda: transactions(house, "room") > now, 20, "it is read")
    # who may not command has nothing read
    house.daemon.config.write_text(house.text({**ROOM, **slow}, RELAY, Write=raw("off")))
    assert scene.owsctl(house.daemon, "reload").returncode == 0

    def refused():
        publish(house, "owsd/pi7/room/read", "")
        return "Write is off" in house.listener.last("owsd/pi7/room/result")
    until(refused, 20, house.face.log, step=0.5)


def test_by_mqtt_5_who_asks_names_the_topic_of_the_answer(scene):
    house = ready(scene)

    def ask(topic, text, reply):
        done = subprocess.run([program("mosquitto_rr"), "-V", "5", "-p", str(house.broker.port), "-W", "10", "-t", topic, "-e", reply,
                               "-m", text, "-D", "publish", "correlation-data", "c7", "-F", "%D %p"],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
        return done.stdout.strip()
    correlation, text = ask("owsd/pi7/relay/set", "on", "hmi/answers").split(" ", 1)
    assert (correlation, json.loads(text)) == ("c7", {"taken": True, "set": "on"})
    house.arrives("room", lambda m: m["good"])
    correlation, text = ask("owsd/pi7/room/get", "", "hmi/answers").split(" ", 1)
    assert correlation == "c7" and json.loads(text)["v"] == 21.5, text
    # who may command must not have owsd-mqtt publish where only that may
    for reply in ("owsd/pi8/relay/set", "homeassistant/device/x/config", "$SYS/x"):
        command(house, "relay", "off", "-V", "5", "-D", "publish", "response-topic", reply)
    until(lambda: len(house.listener.all("owsd/pi7/relay/result")) == 4, 20, lambda: house.listener.all())
    assert not [t for _, t, _ in house.listener.all() if t in ("owsd/pi8/relay/set", "homeassistant/device/x/config")]


def devices(house, *more):
    """The list of devices, by their ids, and the whole answer."""
    result = "owsd/pi7/chip/result"
    count = len(house.listener.all(result))
    publish(house, "owsd/pi7/chip/get", '{"id":"a1"}', *more)
    until(lambda: len(house.listener.all(result)) > count, 20, house.face.log)
    answer = json.loads(house.listener.last(result))
    assert answer["id"] == "a1", answer
    return {device["id"]: device for device in answer["devices"]}, answer


def test_a_list_has_the_devices_of_the_table_and_those_that_were_found(scene):
    house = ready(scene, ROOM, {**ROOM, "Name": "again"}, ABSENT)
    house.says(f"owsd/pi7/chip/{SENSOR}/state", "online")
    house.says("owsd/pi7/chip/28.FFFFFFFFFFFF/state", "offline")
    until(lambda: SWITCH in devices(house)[0], 20, lambda: devices(house)[1])
    found, answer = devices(house)
    assert sorted(found) == sorted([SENSOR, SWITCH, "28.FFFFFFFFFFFF"]) and answer["searched"], answer
    target = f"sim:{house.wire}"
    assert found[SENSOR] == {"id": SENSOR, "family": "28", "type": "DS18B20", "target": target, "path": f"/{SENSOR}",
                             "chip": SENSOR, "state": "online", "signals": ["room", "again"]}, answer
    assert found[SWITCH] == {"id": SWITCH, "family": "29", "target": target, "path": f"/{SWITCH}", "signals": []}, answer
    assert found["28.FFFFFFFFFFFF"]["state"] == "offline", answer
    # who may not ask owsd for what is on its wires gets the table, and why there is no more
    segment(house.daemon.name, "sock").unlink()
    found, answer = devices(house)
    assert sorted(found) == sorted([SENSOR, "28.FFFFFFFFFFFF"]) and answer["searched"] is False and answer["why"], answer


def test_where_owsd_has_never_run_a_list_is_refused_in_words(scene):
    house = ready(scene)
    assert house.face.stop() == 0 and house.daemon.stop() == 0
    listens, log = "owsd/pi7/+/get (QoS 1)", house.broker.process.log
    before = log().count(listens)
    house.face = house.start()
    until(lambda: log().count(listens) > before, 20, log)
    publish(house, "owsd/pi7/chip/get", '{"id":"a1"}')
    answer = house.arrives("chip/result", lambda m: m["id"] == "a1")
    assert answer == {"searched": False, "why": "owsd is away, or reloads: try again", "id": "a1"}, answer
    assert house.face.running()


def test_a_question_is_answered_once_while_the_broker_is_asked_what_it_keeps(scene):
    house = ready(scene)
    house.arrives("room", lambda m: m["good"])
    assert "Received UNSUBSCRIBE from owsd-pi7" not in house.broker.process.log(), "it looks"
    for topic, answer in (("chip/get", "chip/result"), ("room/get", "room/result"), ("relay/set", "relay/result")):
        publish(house, f"owsd/pi7/{topic}", '{"v":1,"id":"a1"}')
        house.arrives(answer, lambda m: m["id"] == "a1")
    publish(house, "owsd/pi7/relay/get", '{"id":"last"}')
    house.arrives("relay/result", lambda m: m["id"] == "last")
    answers = [t for _, t, _ in house.listener.all() if t.endswith("/result")]
    assert sorted(answers) == [f"owsd/pi7/{name}/result" for name in ("chip", "relay", "relay", "room")], answers


def test_a_signal_is_renamed_by_the_writer_and_keeps_what_it_is(scene):
    house = ready(scene, ROOM, RELAY, Rename=raw("on"))
    result, old = "owsd/pi7/room/result", house.daemon.config.read_text()

    def answers(name, text, words):
        count = len(house.listener.all(f"owsd/pi7/{name}/result"))
        publish(house, f"owsd/pi7/{name}/rename", text)
        until(lambda: len(house.listener.all(f"owsd/pi7/{name}/result")) > count, 40, house.face.log)
        assert words in house.listener.last(f"owsd/pi7/{name}/result"), house.listener.last(f"owsd/pi7/{name}/result")
    answers("room", "hall", f"owsd-writer is not there: sudo owsctl -n {house.daemon.name} enable mqtt")
    writer = Writer(scene, house.daemon.config, house.daemon.name)
    house.arrives("room", lambda m: m["good"])
    chip = house.last(f"chip/{SENSOR}/problem")
    for name, text, words in (("room", "relay", "there is an item"), ("room", "a b", "blank"), ("nobody", "hall", "no such signal"),
                              ("room", "", "it is empty")):
        answers(name, text, words)
    assert house.daemon.config.read_text() == old
    answers("room", '{"v":"hall","id":7}', '"taken":true')
    assert json.loads(house.listener.last(result)) == {"taken": True, "set": "hall", "id": 7}
    assert house.daemon.config.read_text() == old.replace('"room"', '"hall"')
    house.arrives("hall", lambda m: m["v"] == 21.5 and m["good"])
    until(lambda: house.listener.last("owsd/pi7/room") == "", 30, "the old topic is emptied")
    # the entity stays the same: its id is of what the signal is
    entity = json.loads(house.listener.last("homeassistant/device/owsd_28_A0B1C2000001/config"))["cmps"]
    assert [c["stat_t"] for c in entity.values() if c.get("uniq_id", "").endswith("temperature")] == ["owsd/pi7/hall"], entity
    assert house.last(f"chip/{SENSOR}/problem") == chip
    until(lambda: "rename by user" in writer.log() and 'for "mqtt:127.0.0.1"' in writer.log(), 20, writer.log)


def test_what_the_page_says_to_the_broker_does_what_it_says(scene):
    """The commands of docs/mqtt.md and owsd-mqtt(8), as they stand there, and their answers."""
    page = (owsdtest.SOURCE / "docs/mqtt.md").read_text()
    house = ready(scene, ROOM, RELAY, Rename=raw("on"))
    Writer(scene, house.daemon.config, house.daemon.name)
    house.set("relay", "1")
    house.arrives("relay", lambda m: m["good"])

    def run(command):
        name, *words = shlex.split(command)
        return subprocess.run([program(name), "-p", str(house.broker.port), *words], capture_output=True, text=True,
                              timeout=owsdtest.PATIENCE, check=False).stdout
    asked = re.findall(r"^(mosquitto_rr .*)\n(\{.*)$", page, re.M)
    assert len(asked) == 3, asked
    for command, answer in asked:
        said = json.loads(run(command + " -W 40"))
        assert said == json.loads(answer) if answer.endswith("}") else said["devices"][0]["type"] == "DS18B20", (command, said)
    assert house.face.stop() == 0 and house.kept("owsd/pi7/#")
    manual = (owsdtest.SOURCE / "docs/owsd-mqtt.8").read_text().replace("\\-", "-")
    empties = re.search("^mosquitto_sub .* --remove-retained .*$", manual, re.M)[0]
    run(empties.replace("OLDTOPIC", "owsd").replace("OLDNODE", "pi7"))
    assert not house.kept("owsd/pi7/#"), house.kept("owsd/pi7/#")


def test_a_flood_of_lists_and_renames_is_cut(scene):
    house = ready(scene, Rename=raw("on"))
    house.arrives("room", lambda m: m["good"])
    begun = time.monotonic()
    for topic, why in (("chip/get", "more than one list in a second: try again"),
                       ("room/rename", "more than one rename in 10 seconds: try again")):
        result = f"owsd/pi7/{topic.split('/')[0]}/result"

        def refused(topic=topic, result=result, why=why):
            """Answers of a flood are lost: some of one of them come."""
            many(house, f"owsd/pi7/{topic}", ["hall"] * 200)
            return any(why in text for _, _, text in house.listener.all(result))
        until(refused, 20, house.face.log, step=0.5)
        lists = sum("devices" in json.loads(text) for _, _, text in house.listener.all("owsd/pi7/chip/result"))
        assert lists <= 10 + time.monotonic() - begun + 1, lists

    def listed():
        publish(house, "owsd/pi7/chip/get", "")
        return "devices" in json.loads(house.listener.last("owsd/pi7/chip/result"))
    until(listed, 20, house.face.log, step=1.2)


def test_without_rename_a_broker_that_sends_one_unasked_is_refused(scene):
    topic = b"owsd/pi7/room/rename"

    def serve(listener):
        with contextlib.suppress(OSError):
            while True:
                with listener.accept()[0] as connection:
                    connection.recv(4096)
                    connection.sendall(b"\x20\x03\x00\x00\x00")
                    connection.recv(4096)
                    connection.sendall(bytes([0x30, len(topic) + 7, 0, len(topic)]) + topic + b"\x00hall")
                    while connection.recv(4096):
                        pass
    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=serve, args=(listener,), daemon=True).start()
        house = House(scene, ROOM, Broker=f"mqtt://127.0.0.1:{listener.getsockname()[1]}")
        logged(house.face, "command to \"room\" refused: Rename is off in the block Mqtt: set it to on there, and reload owsd")
        assert house.face.stop() == 0


def test_without_write_a_command_sets_nothing_and_the_log_says_why_and_what_to_do(scene):
    house = ready(scene, Write=raw("off"))
    house.set("relay", 0)
    command(house, "relay", "on")
    logged(house.face, "command to \"relay\" refused: Write is off in the block Mqtt: set it to on there, and reload owsd")
    assert house.face.log().count(" refused: ") == 1, house.face.log()
    assert "owsd-mqtt" not in journal(house) and scene.get(house.daemon, "relay") == "0"
    house.arrives("health", lambda m: m["commands_refused"] == 1 and "Write is off" in m["trouble"])


def test_what_is_no_command_is_a_line_of_the_log_and_nothing_else(scene):
    house = ready(scene, ROOM, RELAY, DIAL)
    house.set("relay", 0)
    house.set("dial", 7)
    house.arrives("dial", lambda m: m["v"] == 7)
    cases = [("relay", "2"), ("relay", "maybe"), ("dial", "toggle"), ("dial", "201"), ("dial", "1.5"), ("dial", "on"), ("dial", "off"),
             ("dial", "nan"), ("dial", '{"v":1'), ("dial", '{"id":1}'), ("room", "20"), ("nobody", "1"), ("relay_WriteEnable", "1"),
             ("_DGNRESET", "1"), ("dial", "9" * 2000), ("dial", b"1\0002"), ("dial", b"\xff\xfe"), ("relay", "")]
    for name, text in cases:
        command(house, name, text)
    health = house.arrives("health", lambda m: m["commands"] + m["commands_refused"] == len(cases))
    assert health["commands"] == 0, health
    assert "it is empty" in health["trouble"], health
    assert "command to \"relay\" refused: \"maybe\" is no value for it: expected 0 or 1" in house.face.log(), house.face.log()
    # nobody has to guess which of them was refused
    assert "command to \"dial\" refused: \"201\" is no value for it: expected 0 to 200" in house.face.log(), house.face.log()
    until(lambda: house.face.log().count(" refused: ") == len(cases), 20, lambda: house.face.log())
    assert scene.get(house.daemon, "dial") == "7" and "owsd-mqtt" not in journal(house)
    assert "relay_WriteEnable" not in scene.owsctl(house.daemon, "journal").stdout
    command(house, "dial", "8")
    house.arrives("dial", lambda m: m["v"] == 8)
    house.arrives("health", lambda m: m["commands"] == 1 and m["trouble"] == "")


def test_a_retained_command_of_last_week_and_one_of_now_are_refused(scene):
    house = House(scene, ROOM, RELAY)
    house.set("relay", 0)
    house.face.stop()
    command(house, "relay", "on", "-r")
    house.daemon.config.write_text(house.text(ROOM, RELAY, **ON))
    house.face = house.start()
    logged(house.face, "command to \"relay\" refused: it is retained")
    command(house, "relay", "on", "-r")
    until(lambda: (house.last("health") or {}).get("commands_refused", 0) >= 2, 20,
          lambda: house.last("health"))
    assert scene.get(house.daemon, "relay") == "0" and "owsd-mqtt" not in journal(house)


def test_a_flood_is_cut_and_logged_in_a_few_lines(scene):
    house = ready(scene, ROOM, DIAL)
    many(house, "owsd/pi7/dial/set", [n % 200 for n in range(5000)])
    logged(house.face, "more than 50 commands in a second")
    until(lambda: (house.last("health") or {}).get("commands_refused", 0) > 1000, 30,
          lambda: house.last("health"))
    assert house.face.running() and len(house.face.log().splitlines()) < 400, len(house.face.log().splitlines())

    def taken():
        # a busy machine may still be at the flood
        command(house, "dial", "11")
        return scene.get(house.daemon, "dial") == "11"
    until(taken, 20, "commands are taken again", step=0.5)
    # what is wrong with another one is not hidden by them
    command(house, "nobody", "1")
    logged(house.face, "command to \"nobody\" refused: there is no such signal")
    # those without a line are counted
    refused = house.arrives("health", lambda m: "nobody" in m["trouble"])["commands_refused"]
    assert house.face.stop() == 0
    # on a busy machine some have waited for too long: another reason, and a line of its own
    others = [int(n) for n in re.findall(r" refused: .* \((\d+) times since the last such line\)", house.face.log())]
    assert others and house.face.log().count(" refused: ") - len(others) + sum(others) == refused, house.face.log()


def peak_kib(program):
    return int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{program.pid}/status").read_text())[1])


def test_a_message_of_any_length_costs_nothing(scene):
    house = ready(scene)
    house.set("relay", 0)
    usual, huge = peak_kib(house.face), bytes(48 << 20)
    for topic in ("owsd/pi7/zz/set", "owsd/pi7/relay/set", "owsd/pi7/zz", "homeassistant/device/owsd_pi7/config"):
        publish(house, topic, huge, "-r")
    for write in ("on", "off"):
        house.face.stop()
        house.daemon.config.write_text(house.text(ROOM, RELAY, Write=raw(write)))
        house.face = house.start()
        house.says("owsd/pi7/state", "online")
        publish(house, "owsd/pi7/relay/set", huge)
        house.arrives("health", lambda m: m["commands"] == 0)
        command(house, "relay", "on")
        logged(house.face, "relay set to on" if write == "on" else "command to \"relay\" refused: Write is off")
        assert house.face.running() and peak_kib(house.face) < usual + 20000, (usual, peak_kib(house.face))
        assert house.face.log().count("connected to") == 1, house.face.log()


@contextlib.contextmanager
def flood(house, *topics):
    """Some 2000 commands a second to each of these, of other clients, as long as it lasts."""
    sender = [program("mosquitto_pub"), "-p", str(house.broker.port), "-q", "0", "-l", "-t"]
    clients = [subprocess.Popen([*sender, topic], stdin=subprocess.PIPE) for topic in topics]
    done = threading.Event()

    def send():
        while not done.wait(0.01):
            for client in clients:
                client.stdin.write(b"1\n" * 20)
                client.stdin.flush()
    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
        for client in clients:
            client.stdin.close()
            client.wait(owsdtest.PATIENCE)


def test_a_flood_of_others_starves_no_command(scene):
    house = ready(scene, ROOM, RELAY, item("pump", f"/{SWITCH}/PIO.1", "bool", "output"))
    house.set("relay", 0)
    with flood(house, "owsd/pi7/nosuch/set", "owsd/pi7/relay/set"):
        logged(house.face, "command to \"nosuch\" refused: there is no such signal")
        logged(house.face, "command to \"relay\" refused: more than 50 commands in a second")
        for n in range(1, 31):
            command(house, "pump", str(n % 2))
            house.arrives("pump", lambda m, n=n: m["v"] is bool(n % 2))
    assert "command to \"pump\" refused" not in house.face.log()


def test_commands_go_on_after_a_reload_and_a_restart_of_owsd(scene):
    house = ready(scene)
    command(house, "relay", "on")
    house.arrives("relay", lambda m: m["v"] is True)
    house.daemon.stop()
    house.says("owsd/pi7/state", "offline")
    command(house, "relay", "off")
    logged(house.face, "owsd does not answer")
    house.daemon = scene.owsd(house.daemon.config, name=house.daemon.name)
    house.says("owsd/pi7/state", "online")

    def off():
        command(house, "relay", "off")
        return (house.last("relay") or {}).get("v") is False
    until(off, 20, "the relay is off", step=0.3)


def test_the_first_command_to_a_name_that_a_reload_brought_is_taken(scene):
    house = ready(scene)
    command(house, "relay", "on")
    house.arrives("relay", lambda m: m["v"] is True)
    house.daemon.config.write_text(house.text(ROOM, {**RELAY, "Name": "pump"}))
    house.daemon.signal(signal.SIGHUP)
    house.arrives("pump", lambda m: m["v"] is True and m["good"])
    command(house, "pump", "off")
    house.arrives("pump", lambda m: m["v"] is False)


def test_a_refused_reload_stands_in_the_health_until_one_is_taken_over(scene):
    house = House(scene)
    house.arrives("health", lambda m: m["reload_refused"] == "")
    good = house.daemon.config.read_text()
    house.daemon.config.write_text(good + "Driver {\n")
    assert scene.owsctl(house.daemon, "reload").returncode == 1
    house.arrives("health", lambda m: f"{house.daemon.config}:" in m["reload_refused"])
    house.daemon.config.write_text(good)
    assert scene.owsctl(house.daemon, "reload").returncode == 0
    house.arrives("health", lambda m: m["reload_refused"] == "")


if __name__ == "__main__":
    owsdtest.main(at_once=4)
