#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The flow of owsctl modbus-map, imported into a genuine Node-RED with node-red-contrib-modbus. Later
versions of that need a package that the registry of npm does not have."""

import json

import nodered
from modbushouse import ABSENT, CELLAR, GOOD, NO_DEVICE, NO_OWSD, Client, ROOM, serve, text
from owsdtest import free_port, main, until

NODES = "node-red-contrib-modbus@5.23.3"


def test_the_flow_has_of_each_signal_its_value_or_none_with_the_quality(scene):
    port, out = free_port(), scene.path / "messages"
    daemon = scene.owsd(text(scene, port, ROOM, CELLAR, ABSENT))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(2, GOOD)
    written = scene.owsctl(daemon, "modbus-map", "-d", scene.path / "state", "--as", "node-red", "--host", f"127.0.0.1:{port}")
    flow = json.loads(written.stdout)
    tab = next(node["id"] for node in flow if node["type"] == "tab")
    record = next(node for node in flow if node["type"] == "function")
    # in place of a person who reads the sidebar
    record["wires"][0].append("judge-line")
    flow += [{"id": "judge-line", "type": "function", "z": tab, "func": "return {payload: JSON.stringify(msg)};",
              "outputs": 1, "wires": [["judge-file"]]},
             {"id": "judge-file", "type": "file", "z": tab, "filename": str(out), "filenameType": "str",
              "appendNewline": True, "overwriteFile": "false", "wires": [[]]}]
    judge = nodered.start(scene, flow, NODES)

    def last(name):
        lines = out.read_text().splitlines(keepends=True) if out.exists() else []
        messages = [json.loads(line) for line in lines if line.endswith("\n")]
        return next((m for m in reversed(messages) if m["topic"] == name), {})

    def becomes(name, **expected):
        until(lambda: expected.items() <= last(name).items(), 90, lambda: f"{last(name)}\n{judge.log()[-3000:]}")
    becomes("room", payload=21.5, quality=GOOD, alarm=0x403)
    becomes("cellar", payload=-3.25, quality=GOOD, alarm=0)
    becomes("absent", payload=None, quality=NO_DEVICE, age=None)
    assert 0 <= last("cellar")["age"] < 10, last("cellar")
    daemon.kill()
    becomes("room", payload=None, quality=NO_OWSD)
    daemon = scene.owsd(daemon.config, name=daemon.name)
    becomes("room", payload=21.5, quality=GOOD)
    # a cable is cut: nothing more comes, until it is there again
    face.kill()
    count = len(out.read_text().splitlines())
    serve(scene, daemon)
    until(lambda: len(out.read_text().splitlines()) > count + 6, 60, lambda: judge.log()[-3000:])
    becomes("room", payload=21.5, quality=GOOD)


if __name__ == "__main__":
    main()
