#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What other programs make of owsd-mqtt: the flow for Node-RED, imported and run by a genuine one."""

import fcntl
import json
import os
import pathlib
import shutil
import subprocess

import owsdtest
from mqtthouse import RELAY, ROOM, House, program
from owsdtest import raw, until

# The Node-RED, and the Node.js that it runs on
NODE_RED = ("node-red@5.0.7", "node@22.23.3")
INSTALL_SECONDS = 600
FLOW = owsdtest.SOURCE / "board/fleet/node-red.json"


def node_red():
    """[command] of it, out of the user's cache or, once, from the registry of npm."""
    npm = shutil.which("npm") or owsdtest.skip("no npm here (package npm)")
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    base.mkdir(parents=True, exist_ok=True)
    place = base / "node-red"
    with open(base / "node-red.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "versions").exists() or (place / "versions").read_text() != str(NODE_RED):
            shutil.rmtree(place, ignore_errors=True)
            place.mkdir()
            try:
                done = subprocess.run([npm, "install", "--prefix", place, "--no-audit", "--no-fund", *NODE_RED], check=False,
                                      capture_output=True, text=True, timeout=INSTALL_SECONDS)
                last = done.stderr.strip().splitlines()[-1:]
            except subprocess.TimeoutExpired:
                done, last = None, "it takes too long"
            if not done or done.returncode:
                owsdtest.skip(f"not cached and cannot be had: Node-RED: {last}")
            (place / "versions").write_text(str(NODE_RED))
    return [place / "node_modules/node/bin/node", place / "node_modules/node-red/red.js"]


def test_the_flow_for_node_red_has_values_commands_and_answers(scene):
    command = node_red()
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
    place = scene.path / "node-red"
    place.mkdir()
    (place / "flows.json").write_text(json.dumps(flow))
    (place / "settings.js").write_text('module.exports = {flowFile: "flows.json", uiHost: "127.0.0.1", '
                                       f'uiPort: {owsdtest.free_port()}, telemetry: {{enabled: false}}}};\n')
    judge = scene.start([*command, "-u", place, "-s", place / "settings.js"], {"HOME": str(place)})
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


if __name__ == "__main__":
    owsdtest.main()
