#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What owsd knows of each device that signals name, from the wire to owsctl stats: which chip it
is, its supply, and what it costs."""

import json

import owsdtest
from owsdtest import raw, until
from test_reload import reload

HOUSE = owsdtest.SOURCE / "board/demo/house.sim"
CLONE, FED, NOISY = "28.AA3C61551401", "28.A30000000000", "28.B20000000000"
RELAYS, GONE = "29.000000000001", "28.0102030405FF"


def item(name, path, kind="double", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw("input"), **more)


def text(target, *more):
    return owsdtest.rio(target, [
        item("outside", f"/{FED}/temperature12"), item("return", f"/{NOISY}/temperature12"),
        item("clone", f"/{CLONE}/temperature12"), item("relays", f"/{RELAYS}/sensed.BYTE", "byte"),
        item("nobody", f"/{GONE}/temperature12"), item("elsewhere", "/alias/temperature"), *more,
    ], Period=0.05, Timeout=3, MaxRetries=1)


def plant(scene):
    """The house of the demonstration, with a clone more and noise from the begin."""
    house = HOUSE.read_text().split("# What happens to it")[0]
    wire = scene.file("house.sim", house + f"DS18B20-B1 {CLONE} temperature 21.4375\n"
                      "at 0s corrupt return each 4\n")
    return f"sim:{wire}"


def stats(scene, daemon):
    return json.loads(scene.owsctl(daemon, "--json", "stats").stdout)


def devices(scene, daemon):
    return {device["id"]: device for device in stats(scene, daemon)["devices"]}


def counted(scene, daemon, name):
    return sum(counter["value"] for counter in stats(scene, daemon)["counters"]
               if counter["name"] == name)


def test_stats_has_identity_supply_and_costs_of_each_device(scene):
    target = plant(scene)
    daemon = scene.owsd(text(target))
    until(lambda: all(devices(scene, daemon)[device]["last_ok_age"] is not None
                      for device in (CLONE, FED, NOISY, RELAYS)), 20, "each has answered well")
    until(lambda: devices(scene, daemon)[NOISY]["retries"], 20, "the noise costs retries")
    until(lambda: devices(scene, daemon)[GONE]["errors"], 20, "what is not there is an error")
    known = devices(scene, daemon)
    assert list(known) == sorted([CLONE, FED, NOISY, RELAYS, GONE]), list(known)
    assert known[CLONE]["identity"] == "DS18B20 clone, family B1", known[CLONE]
    assert known[CLONE]["family"] == "DS18B20"
    assert known[RELAYS]["identity"] == "DS2408", known[RELAYS]
    assert known[FED]["channel"] == known[CLONE]["channel"] == 0, known
    assert known[FED]["power"] == "parasite" and known[CLONE]["power"] == "external", known
    for device in (CLONE, FED, NOISY, RELAYS):
        assert known[device]["target"] == target and known[device]["answers"] > 0, known
        assert known[device]["wire_us"] > 0 and known[device]["last_ok_age"] < 30, (device, known)
    assert known[FED]["retries"] == known[RELAYS]["retries"] == 0, known
    gone = known[GONE]
    assert gone["identity"] is gone["power"] is gone["last_ok_age"] is None, gone
    assert counted(scene, daemon, "bus_wire_us") >= sum(d["wire_us"] or 0 for d in known.values())


def test_a_reload_counts_on_and_a_restart_begins_anew(scene):
    target = plant(scene)
    daemon = scene.owsd(text(target))
    until(lambda: devices(scene, daemon)[NOISY]["retries"], 20, "the noise costs retries")
    until(lambda: devices(scene, daemon)[CLONE]["identity"], 20, "the clone is known")
    before = devices(scene, daemon)
    reload(scene, daemon, text(target, item("cellar", "/10.0000000000C1/temperature")))
    after = devices(scene, daemon)
    assert set(after) - set(before) == {"10.0000000000C1"}
    for device in before:
        for count in ("answers", "errors", "retries", "wire_us"):
            assert (after[device][count] or 0) >= (before[device][count] or 0), (device, count)
    assert after[CLONE]["identity"] == before[CLONE]["identity"]
    daemon.stop()
    daemon = scene.owsd(text(target), name=daemon.name)
    assert devices(scene, daemon)[RELAYS]["answers"] < before[RELAYS]["answers"]


def test_what_an_owserver_does_not_say_is_null_and_not_zero(scene):
    port = owsdtest.free_port()
    scene.owsd(text(plant(scene)), "-l", f"127.0.0.1:{port}")
    daemon = scene.owsd(text(f"127.0.0.1:{port}"))
    until(lambda: devices(scene, daemon)[CLONE]["last_ok_age"] is not None, 20, "an answer")
    clone = devices(scene, daemon)[CLONE]
    assert clone["identity"] is clone["power"] is None, clone
    assert clone["retries"] is clone["wire_us"] is None, clone
    assert clone["last_ok_age"] < 30, clone


def test_the_texts_of_stats_and_metrics_have_each_device(scene):
    daemon = scene.owsd(text(plant(scene)))
    until(lambda: devices(scene, daemon)[NOISY]["retries"], 20, "the noise costs retries")
    until(lambda: all(devices(scene, daemon)[device]["last_ok_age"] is not None
                      for device in (CLONE, FED, RELAYS)), 20, "each has answered well")
    rows = {line.split()[0]: line for line in scene.owsctl(daemon, "stats").stdout.splitlines()
            if line.strip()}
    assert rows["DEVICE"].split() == ["DEVICE", "IDENTITY", "HEALTH", "POWER", "TARGET", "REQUESTS", "ERRORS",
                                      "RETRIES", "WIRE", "LAST"]
    assert " parasite " in rows[FED] and "DS18B20 clone, family B1" in rows[CLONE], rows
    assert "%" in rows[CLONE] and rows[GONE].split()[1:4] == ["-", "failure", "-"], rows
    lines = scene.owsctl(daemon, "metrics").stdout.splitlines()
    label = f'owsd="{daemon.name}",device="{NOISY}"'
    retries = [line for line in lines if line.startswith(f"ows_device_retries_total{{{label}}}")]
    assert len(retries) == 1 and int(retries[0].split()[1]) > 0, retries
    for name, count in (("answers", 5), ("errors", 5), ("wire_seconds", 4)):
        found = [line for line in lines if line.startswith(f"ows_device_{name}_total{{")]
        assert len(found) == count, found


if __name__ == "__main__":
    owsdtest.main()
