#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl metrics: what Prometheus and others read of owsd. The judges are the strict reader of
OpenMetrics of Prometheus' Python client and, where it is installed, promtool."""

import json
import re
import shutil
import subprocess

import clients
import owsdtest

SENSOR, RELAY = "/28.A0B1C2000001", "/29.A0B1C2000004"


def plant(scene):
    wire = scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {SENSOR[1:]} temperature 21.5\n"
                      f"DS2408 {RELAY[1:]}\n")
    text = owsdtest.rio(f"sim:{wire}", [
        dict(Name="room", Path=SENSOR + "/temperature", Type="double", IO="input", Unit="\\°",
             LimitH=owsdtest.raw("20")),
        dict(Name="relays", Path=RELAY + "/PIO.BYTE", Type="byte", IO="input"),
        dict(Name="latched", Path=RELAY + "/sensed.BYTE", Type="byte", IO="input",
             Alarm=owsdtest.raw("on"), LatchAlarm="latch.BYTE"),
        dict(Name="kind", Path=SENSOR + "/type", Type="string", IO="input", PerFactor=20),
        dict(Name="nobody", Path="/28.0102030405FF/temperature", Type="double", IO="input"),
    ], Period=0.05, Timeout=3)
    daemon = scene.owsd(text)
    for name, value in (("room", "21.5"), ("kind", "DS18B20"), ("relays", "0")):
        scene.until(lambda: scene.get(daemon, name) == value, 15, f"{name} has {value}")
    return daemon


def families(scene, daemon, *arguments):
    """The families by name, as the reader of the Python client has them."""
    parser = clients.python_client("prometheus_client.openmetrics.parser")
    done = scene.owsctl(daemon, "metrics", *arguments)
    assert done.returncode == 0, done
    return {family.name: family for family in parser.text_string_to_metric_families(done.stdout)}


def of(family, name):
    """The samples of a signal."""
    return [sample for sample in family.samples if sample.labels.get("signal") == name]


def test_values_quality_and_age_of_good_and_of_bad_signals(scene):
    daemon = plant(scene)
    found = families(scene, daemon)
    room, = of(found["ows_value"], "room")
    unit = json.loads(scene.owsctl(daemon, "list", "--json", "room").stdout)[0]["unit"]
    assert room.value == 21.5 and room.labels == {
        "owsd": daemon.name, "signal": "room", "device": SENSOR[1:], "unit": unit}, room
    assert "°" in unit and "\\" in unit, unit
    assert of(found["ows_value"], "relays")[0].value == 0
    # text has a quality and no value; what is not there has neither value nor age
    assert not of(found["ows_value"], "kind") and of(found["ows_quality"], "kind")[0].value == 192
    assert not of(found["ows_value"], "nobody") and not of(found["ows_age_seconds"], "nobody")
    assert of(found["ows_quality"], "nobody")[0].value < 192
    assert 0 <= of(found["ows_age_seconds"], "room")[0].value < 20
    assert of(found["ows_simulated"], "room")[0].value == 1
    assert of(found["ows_alarm"], "room")[0].value == 1 and not of(found["ows_alarm"], "relays")
    # without PorAlarm it does nothing
    scene.until(lambda: of(families(scene, daemon)["ows_alarm_unarmed"], "latched")[0].value == 1, 15, "unarmed")
    assert not of(found["ows_alarm_unarmed"], "room")
    assert found["ows_up"].samples[0].value == 1 and found["ows_target_up"].samples[0].value == 1


def test_counters_are_those_of_stats(scene):
    daemon = plant(scene)
    found = families(scene, daemon)
    stats = json.loads(scene.owsctl(daemon, "stats", "--json").stdout)
    names = {counter["name"] for counter in stats["counters"]}
    assert len(names) > 30, names
    for name in names:
        family = found["ows_" + (name[:-3] + "_seconds" if name.endswith("_us") else name)]
        assert family.type == "counter" and len(family.samples) == 1, family
    wire_us, = (counter["value"] for counter in stats["counters"] if counter["name"] == "bus_wire_us")
    assert 0 < found["ows_bus_wire_seconds"].samples[0].value <= wire_us / 1e6


def test_patterns_choose_signals(scene):
    daemon = plant(scene)
    assert [s.labels["signal"] for s in families(scene, daemon, "ro*")["ows_quality"].samples] == ["room"]
    done = scene.owsctl(daemon, "metrics", "none*")
    assert done.returncode == 1 and not done.stdout and "no signal matches" in done.stderr, done
    done = scene.owsctl(daemon, "metrics", "--json")
    assert done.returncode == 2 and "text" in done.stderr, done


def test_of_an_owsd_that_died_no_value_is_left(scene):
    daemon = plant(scene)
    daemon.kill()
    scene.until(lambda: families(scene, daemon)["ows_up"].samples[0].value == 0, 15, "owsd is known as dead")
    found = families(scene, daemon)
    assert not found["ows_value"].samples and found["ows_target_up"].samples[0].value == 0
    assert all(sample.value < 192 for sample in found["ows_quality"].samples)


def test_promtool_has_nothing_to_say_about_the_text_for_prometheus(scene):
    daemon = plant(scene)
    text = scene.owsctl(daemon, "metrics", "-p").stdout
    parser = clients.python_client("prometheus_client.parser")
    found = {family.name: family for family in parser.text_string_to_metric_families(text)}
    assert of(found["ows_value"], "room")[0].value == 21.5
    assert found["ows_reads"].type == "counter" and found["ows_reads"].samples[0].value > 0
    if not shutil.which("promtool"):
        owsdtest.skip("promtool is not installed (sh board/install-deps database)")
    done = subprocess.run(["promtool", "check", "metrics"], input=text, text=True, capture_output=True,
                          timeout=owsdtest.PATIENCE, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", ""), done


def test_each_metric_and_label_of_the_dashboard_is_printed(scene):
    dashboard = json.loads((owsdtest.SOURCE / "board/fleet/grafana.json").read_text())
    queries = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
    variables = dashboard["templating"]["list"]
    queries += [variable["query"] for variable in variables]
    assert len(queries) > 12, queries
    daemon = plant(scene)
    samples = [sample for family in families(scene, daemon).values() for sample in family.samples]
    printed = {sample.name for sample in samples}
    # job and instance are the labels of whoever scrapes
    labels = {label for sample in samples for label in sample.labels} | {"job", "instance"}
    named = set().union(*(re.findall(r"\bows_\w+", query) for query in queries))
    assert len(named) > 8 and named <= printed, named - printed
    used = set().union(*(re.findall(r"(\w+)=~?\"", query) for query in queries))
    used |= {label for query in queries for label in re.findall(r"label_values\(.*, (\w+)\)", query)}
    used |= set(re.findall(r"{{(\w+)}}", json.dumps(dashboard)))
    assert used <= labels, used - labels
    known = {variable["name"] for variable in variables} | {"__rate_interval"}
    assert set(re.findall(r"\${?(\w+)", json.dumps([queries, dashboard["panels"]]))) <= known
    ids = [panel["id"] for panel in dashboard["panels"]]
    assert len(ids) == len(set(ids))
    if promtool := shutil.which("promtool"):
        rules = scene.file("rules.yml", json.dumps({"groups": [{"name": "dashboard", "rules": [
            {"record": f"q{i}", "expr": re.sub(r"\$__rate_interval", "5m", panel_target["expr"])}
            for i, panel_target in enumerate(t for p in dashboard["panels"] for t in p["targets"])]}]}))
        done = subprocess.run([promtool, "check", "rules", rules], capture_output=True, text=True, check=False,
                              timeout=owsdtest.PATIENCE)
        assert done.returncode == 0, done


if __name__ == "__main__":
    owsdtest.main(at_once=1)
