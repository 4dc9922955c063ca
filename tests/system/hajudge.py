# SPDX-License-Identifier: MIT
"""The genuine Home Assistant, headless, at the broker of a house of mqtthouse.py.

    judge = HomeAssistant(scene, house.broker.port)
    judge.shows("sensor.room", "21.5")
    judge.act("switch.turn_on", "switch.relay")

It publishes each second what it has: its states, and of which device each is.
"""

import fcntl
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import mqtthouse
import owsdtest
from owsdtest import until

# What each version wants of the package index, and the Python that it runs on
WANTED = {"2025": ("hajudge.txt", (3, 13)), "2024": ("hajudge-2024.txt", (3, 11))}
INSTALL_SECONDS = 1500
READY_SECONDS = 300
# Of each entity, with nothing in it that makes a list or a number of it
LOOK = "{% for s in states %}{{ s.entity_id }}={{ s.state }}={{ device_id(s.entity_id) }}=" \
       "{{ state_attr(s.entity_id, 'quality') }}={{ state_attr(s.entity_id, 'event_type') }}=" \
       "{{ state_attr(s.entity_id, 'why') }}={{ state_attr(s.entity_id, 'unit_of_measurement') }};{% endfor %}"
CONFIGURATION = """
homeassistant: {{name: judge, latitude: 50, longitude: 14, elevation: 200, unit_system: metric,
                 time_zone: UTC, country: CZ}}
http: {{server_host: 127.0.0.1, server_port: {port}}}
logger: {{default: warning}}
automation:
- alias: look
  trigger: {{platform: time_pattern, seconds: "/1"}}
  action: {{service: mqtt.publish, data: {{topic: judge/states, payload: "{look}"}}}}
- alias: act
  mode: queued
  trigger: {{platform: mqtt, topic: judge/act}}
  action:
    service: "{{{{ trigger.payload_json.action }}}}"
    target: {{entity_id: "{{{{ trigger.payload_json.entity }}}}"}}
    data: "{{{{ trigger.payload_json.data }}}}"
- alias: tag
  mode: queued
  trigger: {{platform: event, event_type: tag_scanned}}
  action: {{service: mqtt.publish, data: {{topic: judge/tag,
             payload: "tag {{{{ trigger.event.data.tag_id }}}}"}}}}
"""


def _base(year):
    """A Python that this Home Assistant runs on."""
    major, minor = WANTED[year][1]
    homes = sorted(pathlib.Path.home().glob(f".pyenv/versions/{major}.{minor}.*/bin/python3"))
    for path in (sys.executable, shutil.which(f"python{major}.{minor}"), *map(str, homes)):
        if path and subprocess.run([path, "-c", f"import sys; sys.exit(sys.version_info[:2] != ({major}, {minor}))"],
                                   check=False, capture_output=True).returncode == 0:
            return path
    return owsdtest.skip(f"Home Assistant of {year} wants Python {major}.{minor}")


def python(year):
    """The Python that has it, out of the user's cache or, once and for some minutes, from the package index."""
    wanted = pathlib.Path(__file__).resolve().parent / WANTED[year][0]
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    try:
        base.mkdir(parents=True, exist_ok=True)
    except OSError:
        base = owsdtest.BUILD
    place = base / ("homeassistant" if year == "2025" else f"homeassistant-{year}")
    with open(base / "homeassistant.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / wanted.name).exists() or (place / wanted.name).read_text() != wanted.read_text():
            _install(place, wanted, _base(year))
    return place / "bin/python"


def _install(place, wanted, base):
    shutil.rmtree(place, ignore_errors=True)
    pip = [f"{place}/bin/python", "-m", "pip", "--quiet", "--disable-pip-version-check", "--retries", "1",
           "--timeout", "30", "install"]
    core = next(line for line in wanted.read_text().splitlines() if line.startswith("homeassistant=="))
    for command in ([base, "-m", "venv", str(place)], [*pip, "--no-deps", core], [*pip, "-r", str(wanted)]):
        # it has a list of the versions that it was tried with
        if known := list(place.glob("lib/python3.*/site-packages/homeassistant/package_constraints.txt")):
            command += ["-c", str(known[0])]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_SECONDS,
                                  check=False)
            last = ((done.stderr or done.stdout).strip().splitlines() or [""])[-1]
        except subprocess.TimeoutExpired:
            done, last = None, "it takes too long"
        if not done or done.returncode:
            shutil.rmtree(place, ignore_errors=True)
            owsdtest.skip(f"not cached and cannot be had: Home Assistant: {last}")
    shutil.copy(wanted, place)


class HomeAssistant:
    def __init__(self, scene, port, blueprint=None, year="2025", **inputs):
        """With a blueprint: its automation has these inputs."""
        self.broker_port, where = port, scene.path / "homeassistant"
        (where / ".storage").mkdir(parents=True)
        text = CONFIGURATION.format(port=owsdtest.free_port(), look=LOOK)
        if blueprint:
            (where / "blueprints/automation").mkdir(parents=True)
            shutil.copy(blueprint, where / "blueprints/automation")
            text += "- " + json.dumps({"alias": "blueprint", "use_blueprint": {"path": blueprint.name, "input": inputs}}) + "\n"
        (where / "configuration.yaml").write_text(text)
        entry = {"created_at": "2025-01-01T00:00:00+00:00", "modified_at": "2025-01-01T00:00:00+00:00",
                 "data": {"broker": "127.0.0.1", "port": port},
                 "options": {"discovery": True, "discovery_prefix": "homeassistant"},
                 "disabled_by": None, "discovery_keys": {}, "domain": "mqtt", "entry_id": "judge",
                 "minor_version": 2, "pref_disable_new_entities": False, "pref_disable_polling": False,
                 "source": "user", "subentries": [], "title": "judge", "unique_id": None, "version": 1}
        if year == "2024":
            entry["minor_version"] = 1
        (where / ".storage/core.config_entries").write_text(json.dumps(
            {"version": 1, "minor_version": 1 if year == "2024" else 5, "key": "core.config_entries", "data": {"entries": [entry]}}))
        self.registry = where / ".storage/core.device_registry"
        self.listener = mqtthouse.Listener(scene, port, "judge/#")
        self.process = scene.start([python(year), "-m", "homeassistant", "-c", where, "--skip-pip"], {"HOME": str(where), "PYTHONPATH": ""})
        until(self.states, READY_SECONDS, lambda: f"Home Assistant is ready: {self.process.log()[-3000:]}", step=0.2)

    def states(self):
        """{entity: (state, device, quality, event, why, unit)}"""
        text = self.listener.last("judge/states") or ""
        return {name: tuple(rest) for name, *rest in (e.split("=") for e in text.split(";") if e.strip())}

    def state(self, entity):
        return self.states().get(entity, (None,))[0]

    def reason(self, entity):
        return self.states()[entity][4]

    def device(self, identifier):
        """What its file of devices has of the one of this id; it writes it some seconds later."""
        def found():
            if not self.registry.exists():
                return None
            devices = json.loads(self.registry.read_text())["data"]["devices"]
            return next((d for d in devices if ["mqtt", identifier] in d["identifiers"]), None)
        return until(found, 60, lambda: f"{identifier} is in {self.registry}", step=0.5)

    def shows(self, entity, state, seconds=30):
        until(lambda: self.state(entity) == state, seconds,
              lambda: f"{entity} is {state}: {self.states()}\n{self.complaints()}", step=0.1)

    def act(self, action, entity, **data):
        text = json.dumps({"action": action, "entity": entity, "data": data})
        subprocess.run([mqtthouse.program("mosquitto_pub"), "-p", str(self.broker_port), "-q", "1", "-t", "judge/act",
                        "-m", text], check=True, timeout=owsdtest.PATIENCE)

    def complaints(self):
        """What its log has of MQTT, and of what came by it."""
        plain = re.sub(r"\x1b\[[0-9;]*m", "", self.process.log())
        return [line for line in plain.splitlines()
                if re.search(r" (WARNING|ERROR|CRITICAL) ", line) and re.search(r"mqtt|owsd|template|blueprint", line)]
