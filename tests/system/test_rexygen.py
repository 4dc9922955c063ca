#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A project of REXYGEN with owsd: OwsDrv before owsd's served protocol, MbDrv before owsd-modbus by the
file that owsctl makes, MQTTDrv and its blocks before owsd-mqtt. No REXYGEN runs here: what its drivers
do stands in rexygen.py, by the manuals and the public examples.

OWSD_REXYGEN names a directory with genuine .rio files (of the repository rexcontrols/REXexamples):
all of OwsDrv go through the same, and those of MbDrv are read to compare their form.
"""

import json
import math
import os
import pathlib
import re
import struct

import handbook
import owsdtest
import rexygen
import served
from mqtthouse import ABSENT, RELAY, ROOM, House, item, program
from owsdtest import SOURCE, free_port, raw, until
from test_modbus import PYMODBUS, Client, Refused, python_with_pymodbus, refused, serve

SHAPES = sorted((SOURCE / "tests/unit/data").glob("*.rio"))
CHIPS = {"10": "DS18S20 {0} temperature {1}", "26": "DS2438 {0} temperature {1} vdd 5 vad 2.3", "28": "DS18B20 {0} temperature {1}",
         "29": "DS2408 {0}"}


def genuine():
    named = os.environ.get("OWSD_REXYGEN")
    return sorted(pathlib.Path(named).rglob("*.rio")) if named else []


def text_of(path):
    """Files of REXYGEN for Windows are no UTF-8."""
    return path.read_bytes().decode("latin-1").replace("\r\n", "\n")


def of_driver(name, paths):
    """The texts that begin with that block, each once."""
    texts = {text: path for path in reversed(paths) if re.match(rf"\s*{name}\s*{{", text := text_of(path))}
    return sorted((path.name, text) for text, path in texts.items())


def network(scene, text):
    """A line with the chips that the file names, each with a temperature of its own."""
    ids = sorted(set(re.findall(r"/(\w\w\.\w{12})/", text)))
    lines = [CHIPS[rom[:2]].format(rom, 20.5 + i / 4) for i, rom in enumerate(ids)]
    return "sim:" + str(scene.file("plant.sim", "\n".join(["chip DS2482-100 0x18", *lines, ""])))


def shown(scene, daemon):
    """What owsctl list shows: name -> value; None: not good."""
    return {row["name"]: float(row["value"]) if row["good"] else None
            for row in json.loads(scene.owsctl(daemon, "--json", "list").stdout)}


def same(one, other):
    """The text of the served protocol has six digits."""
    return one.keys() == other.keys() and all(
        v is not None and other[k] is not None and math.isclose(v, other[k], rel_tol=1e-5, abs_tol=1e-5) for k, v in one.items())


def test_owsdrv_reads_and_writes_through_the_served_protocol_what_owsctl_shows(scene):
    for name, text in of_driver("OwsDrv", SHAPES + genuine()):
        # owsd reads the outputs, to show what OwsDrv has written
        config = scene.file("plant.rio", re.sub(r"0x([0-9A-Fa-f]+)2([0-9A-Fa-f])\b", r"0x\g<1>1\2", text))
        port = free_port()
        daemon = scene.owsd(config, "-t", network(scene, text), "-l", f"127.0.0.1:{port}")
        server = served.Server(daemon, "127.0.0.1", port, False)
        driver = rexygen.OwsDrv(text, server)

        def agree(driver=driver, daemon=daemon):
            driver.cycle()
            return same({**{k: float(v) for k, v in driver.written.items()},
                         **{k: v for k, v in driver.values.items() if k not in driver.written}}, shown(scene, daemon))
        outputs = [i.name for i in driver.items if i.output]
        until(agree, 30, lambda n=name, d=driver, o=daemon: f"{n}: {d.values}, {d.written}: {shown(scene, o)}")
        for number in (5, 160):
            driver.set.update(dict.fromkeys(outputs, number))
            until(agree, 30, lambda n=name, d=driver, o=daemon: f"{n}: {d.values}, {d.written}: {shown(scene, o)}")
        assert driver.reconnects == 1 and driver.transactions >= 3 * len(driver.items), (name, driver.transactions)
        assert daemon.stop() == 0


ALARM = """OwsDrv {
  MaxConsAlarms           5
  ItemCount               2
  Item {
    Name                    "lamps"
    Path                    "/29.066418000000/PIO.BYTE"
    IOType                  0x0022
    InitValue               "3"
  }
  Item {
    Name                    "contacts"
    Path                    "/29.066418000000/sensed.BYTE"
    IOType                  0x0012
    Alarm                   on
    LatchAlarm              "latch.BYTE"
    PorAlarm                "por"
    SetAlarm                "set_alarm=133333333"
    ResetLatch              "latch.BYTE=0"
  }
}
"""


def test_owsdrv_serves_the_alarms_of_the_manuals_ds2408(scene):
    """The device of its figure 3.3: after its power-on the alarm is set, then each change is one alarm."""
    server = served.owsd_of(scene, network(scene, ALARM), items="")
    until(lambda: server.has(["/29.066418000000"]), 20, "it is found")
    driver = rexygen.OwsDrv(ALARM, server)
    path = "/29.066418000000"

    def cycles_until(condition, what):
        def again():
            driver.cycle()
            return condition()
        until(again, 20, lambda: f"{what}: {driver.alarms} {driver.values}")
    cycles_until(lambda: driver.read(f"{path}/por") == "0", "the power-on was served")
    assert driver.read(f"{path}/set_alarm") == "133333333"
    cycles_until(lambda: driver.read(f"{path}/PIO.BYTE") == "3", "the InitValue was written")
    cycles_until(lambda: driver.read(f"{path}/latch.BYTE") == "0", "the latch was reset")
    served_before = driver.alarms["contacts"]
    for _ in range(4):
        driver.cycle()
    assert driver.alarms["contacts"] == served_before, "an alarm without a change"
    driver.set["lamps"] = 12
    cycles_until(lambda: driver.alarms["contacts"] > served_before, "a change is an alarm")
    assert driver.values["contacts"] == int(driver.read(f"{path}/sensed.BYTE")) == 255 - 12


BOTH = f"""OwsDrv {{
  Item {{
    Name                    "room"
    Path                    "{served.THERMOMETER}/temperature"
    IOType                  0x0018
  }}
  Item {{
    Name                    "limit"
    Path                    "{served.THERMOMETER}/temphigh"
    IOType                  0x0028
    InitValue               "30"
  }}
  Item {{
    Name                    "volts"
    Path                    "{served.BATTERY}/VDD"
    IOType                  0x0018
  }}
}}
"""


def test_owsdrv_is_answered_by_owsd_as_by_the_genuine_owserver(scene):
    for which in served.STARTS:
        server = served.start(scene, which)
        driver = rexygen.OwsDrv(BOTH, server)
        for number in ("30", "-12"):  # the mock of owserver keeps what is written to it
            driver.set["limit"] = number
            until(lambda d=driver, n=number: d.cycle() or d.written.get("limit") == n, 20, which)
            assert driver.read(f"{served.THERMOMETER}/temphigh") == number, which
        until(lambda d=driver: d.cycle() or (d.values["room"], d.values["volts"]) == (21.5, 5), 20, lambda d=driver: d.values)
        assert driver.read(served.ABSENT + "/temperature") is None, which


def with_modbus(text, port, more=""):
    block = f'\n  Modbus {{\n    Listen "127.0.0.1:{port}"\n    Write on\n    Allow "* 127.0.0.1"\n    {more}\n  }}'
    return text.replace("{", "{" + block, 1)


def by_mbdrv(scene, daemon, port, face):
    """The file of owsctl convert, and a master that has it."""
    made = scene.owsctl(daemon, "convert", "-d", scene.path / "state", "--mbdrv", daemon.config)
    assert made.returncode == 0 and not made.stderr, made
    assert face.running()
    driver = rexygen.MbDrv(made.stdout, Client(port))
    assert (driver.slave["IPaddress"], driver.slave["TCPport"]) == ("127.0.0.1", str(port)), driver.slave
    return driver


def give(driver, name, number):
    """A command that may have waited for too long is refused, and given again."""
    until(lambda: refused(driver.write, name, int(number)) is None, 20, name)


def test_mbdrv_reads_by_the_file_of_owsctl_convert_what_owsctl_shows(scene):
    for name, text in of_driver("OwsDrv", SHAPES + genuine()):
        port = free_port()
        daemon = scene.owsd(with_modbus(text, port), "-t", network(scene, text))
        face = serve(scene, daemon)
        driver = by_mbdrv(scene, daemon, port, face)
        names = [i["Name"] for i in rexygen.parse(text)[1]["Item"]]
        assert sorted(i.name for i in driver.items) == sorted(names + ["owsd_heart", "owsd_live", "owsd_order"]), name
        outputs = [i.name for i in driver.items if i.written]

        def agree(number=None, driver=driver, daemon=daemon, outputs=outputs):
            driver.read(Refused)
            now = shown(scene, daemon)
            commanded = {n: now[n] if number is None else number for n in outputs}
            return same({**{n: v for n, v in driver.values.items() if not n.startswith("owsd_")}, **commanded}, now)
        until(agree, 30, lambda n=name, d=driver, o=daemon: f"{n}: {d.values}: {shown(scene, o)}")
        for number in (5.0, 160.0):
            for output in outputs:
                give(driver, output, number)
            until(lambda n=number, a=agree: a(n), 30, lambda n=name, d=driver, o=daemon: f"{n}: {d.values}: {shown(scene, o)}")
        assert driver.values["owsd_live"] == 1 and driver.values["owsd_order"] == 3612558336.0, driver.values
        driver.client.socket.close()
        assert face.stop() == 0 and daemon.stop() == 0
        (scene.path / "state/map").unlink()


EACH = [item(f"{way}_{kind}", f"/29.A0B1C20000{n:02X}/PIO.{'0' if kind == 'bool' else 'BYTE'}", kind, way) for n, (way, kind) in
        enumerate((way, kind) for way in ("input", "output")
                  for kind in ("bool", "byte", "short", "long", "word", "dword", "float", "double", "large"))]


def test_mbdrv_reads_and_writes_each_type_and_a_bad_value_is_no_number(scene):
    ids = "".join(f"DS2408 29.A0B1C20000{n:02X}\n" for n in range(len(EACH)))
    wire = scene.file("each.sim", f"chip DS2482-100 0x18\n{ids}DS18B20 28.A0B1C2000001 temperature 21.5\n")
    more = [item("title", "/28.A0B1C2000001/type", "string"), item("room", "/28.A0B1C2000001/temperature"),
            item("gone", "/28.FFFFFFFFFFFF/temperature"), item("gone_bit", "/29.FFFFFFFFFFFF/PIO.0", "bool"),
            item("gone_byte", "/29.FFFFFFFFFFFF/PIO.BYTE", "byte")]
    port = free_port()
    daemon = scene.owsd(with_modbus(owsdtest.rio(f"sim:{wire}", EACH + more, Period=0.05, Timeout=3), port))
    face = serve(scene, daemon)
    made = scene.owsctl(daemon, "convert", "-d", scene.path / "state", "--mbdrv", daemon.config)
    assert made.stderr.rstrip().endswith("strings left out, which have no register: 1"), made
    driver = rexygen.MbDrv(made.stdout, Client(port))
    outputs = [i.name for i in driver.items if i.written]
    assert len(outputs) == 9 and "title" not in driver.values
    for number in (1, 100, 0):
        for name in outputs:
            give(driver, name, bool(number) if name == "output_bool" else number)

        def written(number=number):
            now = shown_numbers(scene, daemon, outputs)
            return all(v == (bool(number) if n == "output_bool" else number) for n, v in now.items())
        until(written, 30, lambda: str(shown_numbers(scene, daemon, outputs)))

    def read():
        driver.read(Refused)
        return driver.values["room"] == 21.5 and driver.values["input_byte"] == driver.values["input_double"] == 0
    until(read, 30, lambda: str(driver.values))
    assert math.isnan(driver.values["gone"]) and driver.values["gone_byte"] == -32768 and driver.values["gone_bit"] is None
    heart = driver.values["owsd_heart"]
    until(lambda: driver.read(Refused) or driver.values["owsd_heart"] != heart, 20, "the heart beats")
    daemon.kill()
    until(lambda: driver.read(Refused) or driver.values["owsd_live"] == 0, 20, "owsd is dead")
    driver.read(Refused)  # what stands before it in the file may have been read before
    assert math.isnan(driver.values["room"]) and driver.values["input_bool"] is None
    assert face.stop() == 0


def test_pymodbus_reads_what_owsctl_shows_at_the_addresses_of_the_file(scene):
    python = python_with_pymodbus()
    text = text_of(next(path for path in SHAPES if path.name == "four_thermometers.rio"))
    port = free_port()
    daemon = scene.owsd(with_modbus(text, port), "-t", network(scene, text))
    face = serve(scene, daemon)
    driver = by_mbdrv(scene, daemon, port, face)
    items = [i for i in driver.items if not i.name.startswith("owsd_")]
    asked = json.dumps([(i.address, struct.calcsize(i.form) // 2) for i in items])
    assert len(items) == 4

    def agree():
        done = scene._run([python, "-c", PYMODBUS, port, asked], 20)
        assert done.returncode == 0, done
        return same({i.name: struct.unpack(i.form, struct.pack(f">{len(words)}H", *words))[0]
                     for i, words in zip(items, json.loads(done.stdout))}, shown(scene, daemon))
    until(agree, 30, "the same values")
    assert face.stop() == 0


def test_a_word_order_that_is_wrong_shows_in_the_number_of_the_page(scene):
    said = (SOURCE / "docs/from-rexygen.md").read_text()
    for more, number in (("", 3612558336), ('WordOrder "little"', 843144691712)):
        port = free_port()
        daemon = scene.owsd(with_modbus(text_of(SHAPES[0]), port, more), "-t", network(scene, text_of(SHAPES[0])))
        face = serve(scene, daemon)
        driver = by_mbdrv(scene, daemon, port, face)
        driver.read(Refused)
        assert driver.values["owsd_order"] == number and str(number) in said
        driver.client.socket.close()
        assert face.stop() == 0 and daemon.stop() == 0


def shown_numbers(scene, daemon, names):
    return {n: float(row["value"]) for row in json.loads(scene.owsctl(daemon, "--json", "list", *names).stdout)
            if (n := row["name"]) and row["value"] is not None}


def test_the_form_is_that_of_genuine_files(scene):
    masters = [rexygen.parse(text)[1] for _, text in of_driver("Modbus", genuine())]
    if not masters:
        owsdtest.skip("OWSD_REXYGEN names no directory with files of MbDrv")
    made = scene.owsctl(None, "convert", "-d", scene.path, "--mbdrv", scene.file("each.rio", owsdtest.rio("localhost", EACH)))
    assert made.returncode == 0, made
    ours = rexygen.parse(made.stdout)[1]
    tcp = [keys for keys in masters if "Slave" in keys]
    # those that were of a serial line once have more keys
    assert set(ours) == min(map(set, tcp), key=len) and all(set(ours["Slave"][0]) == set(keys["Slave"][0]) for keys in tcp)
    assert {key for i in ours["Item"] for key in i} == {key for keys in tcp for key in keys["Item"][0]}
    known = {(i["Type"], i["Count"]) for keys in masters for i in keys["Item"]}
    assert {(i["Type"], i["Count"]) for i in ours["Item"]} <= known, known


# --- MQTT -----------------------------------------------------------------------------------------

def pjroct(text, *names, yerr):
    """The block PJROCT: numbers of a JSON text; yerr where there is none, as for a text, true, or null."""
    found = json.loads(text)
    return [float(found[n]) if isinstance(found.get(n), (int, float)) and not isinstance(found[n], bool) else yerr for n in names]


def recipe():
    """The file of MQTTDrv, and the topics, as the page has them."""
    page = SOURCE / "docs/from-rexygen.md"
    config = [b.text for b in handbook.blocks(page) if b.language == "json"]
    topics = set(re.findall(r"`(owsd/pi7/[\w/]+)`", page.read_text()))
    assert len(config) == 1 and topics >= {"owsd/pi7/temperature", "owsd/pi7/relay/set", "owsd/pi7/state"}, topics
    return json.loads(config[0]), topics


def test_mqttdrv_has_values_their_quality_and_commands_by_the_pages_recipe(scene):
    config, topics = recipe()
    assert config.keys() == {"client_id", "host", "port", "ping", "reconnect_timeout", "user", "pass", "will_enabled", "will_topic",
                             "will_qos", "will_retain", "will_msg"}
    room = {**ROOM, "Name": "temperature"}
    house = House(scene, room, RELAY, ABSENT, Write=raw("on"))
    who = ["-V", "mqttv311", "-h", "127.0.0.1", "-p", str(house.broker.port)]
    subscribed = [word for topic in sorted(topics) if not topic.endswith("/set") for word in ("-t", topic)]
    driver = scene.start([program("stdbuf"), "-oL", program("mosquitto_sub"), *who, "-i", config["client_id"], *subscribed,
                          "-t", "owsd/pi7/absent", "-t", "owsd/pi7/relay", "-F", "%t\t%p"])

    def last(topic):
        texts = [line.split("\t", 1)[1] for line in driver.log().split("\n")[:-1] if line.startswith(topic + "\t")]
        return texts[-1] if texts else None
    until(lambda: last("owsd/pi7/state") == "online", 20, driver.log)
    for name, parsed in (("temperature", [21.5, 192]), ("absent", [-300, 8])):
        until(lambda t=f"owsd/pi7/{name}", p=parsed: last(t) and pjroct(last(t), "v", "q", yerr=-300) == p, 20, driver.log)
    # as the block MqttPublish makes text of a bool, or of a number
    for value, is_on in (("1", True), ("0", False), ("on", True), ("0.000000", False)):
        done = scene._run([program("mosquitto_pub"), *who, "-t", "owsd/pi7/relay/set", "-m", value], 20)
        assert done.returncode == 0, done
        until(lambda on=is_on: last("owsd/pi7/relay") and json.loads(last("owsd/pi7/relay"))["v"] is on, 20, driver.log)
    house.face.kill()
    until(lambda: last("owsd/pi7/state") == "offline", 20, driver.log)


if __name__ == "__main__":
    owsdtest.main()
