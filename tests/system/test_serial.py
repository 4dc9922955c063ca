#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd on serial adapters: a DS2480B that is never sent bytes too fast, and a passive one; pulled in
a transaction, back under another name, silent, noisy, of the wrong kind, used by another program."""

import json
import time

import owsdtest
import serialport
from owsdtest import logged, until

SENSORS = 20
# an E3 in an id is a command to a DS2480B, unless it is doubled
IDS = {f"s{n}": f"28.0000000000{0xE0 + n:02X}" for n in range(SENSORS)}
VALUES = {f"s{n}": n + 0.5 for n in range(SENSORS)}
HOUSE = "chip DS2482-100 0x18\nDS2413 3A.0000000000E3 as relay\n" + "".join(
    f"DS18B20 {IDS[name]} as {name} temperature {VALUES[name]}\n" for name in IDS)
ITEMS = [dict(Name=name, Path=f"/{IDS[name]}/temperature", Type="double", IO="input") for name in IDS] + \
    [dict(Name="relay", Path="/3A.0000000000E3/PIO.A", Type="bool", IO="output")]
NOTICED = 3  # a loss, and a return


def house(scene, adapter, scheme="serial"):
    """owsd on the adapter by a name of its own, which stays, as those below /dev/serial/by-id do."""
    name = scene.path / "adapter"
    point(name, adapter)
    return scene.owsd(owsdtest.rio(f"{scheme}:{name}", ITEMS), ready=False)


def point(name, adapter):
    name.unlink(missing_ok=True)
    name.symlink_to(adapter.name)


def values(scene, daemon):
    """Of the sensors that are good."""
    listed = json.loads(scene.owsctl(daemon, "list", "-a", "--json", "s*").stdout or "[]")
    return {s["name"]: s["value"] for s in listed if s["quality"] == "good"}


def all_good(scene, daemon):
    return values(scene, daemon) == VALUES


def none_good(scene, daemon):
    return not values(scene, daemon)


def test_twenty_sensors_and_an_output_work_and_no_byte_is_lost(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
    daemon = house(scene, adapter)
    until(lambda: all_good(scene, daemon), 20, lambda: scene.owsctl(daemon, "list").stdout)
    for value in ("1", "0"):
        assert scene.owsctl(daemon, "set", "relay", value).returncode == 0
        until(lambda: scene.get(daemon, "relay") == value, 10, "the relay follows")
    assert adapter.running() and adapter.stats()["overruns"] == 0
    assert adapter("unplug s3") == "ok"
    until(lambda: "s3" not in values(scene, daemon), 10, "a sensor that is away is not good")
    assert adapter("plug s3") == "ok"
    until(lambda: all_good(scene, daemon), 10, "it is back")
    assert adapter("short 0x18 for 6s") == "ok"
    until(lambda: none_good(scene, daemon), 10, "a short")
    until(lambda: all_good(scene, daemon), 20, "and its end")


def test_pulled_in_a_transaction_it_is_missed_and_is_found_under_another_name(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
    daemon = house(scene, adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good")
    for after in (1, 7, 14, 300):
        adapter(f"unplug {after}")
        until(lambda: not adapter.running(), 10, "it is pulled")
        pulled = time.monotonic()
        until(lambda: none_good(scene, daemon), NOTICED, "it is missed")
        logged(daemon, "the adapter is gone")
        adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
        point(scene.path / "adapter", adapter)
        until(lambda: all_good(scene, daemon), NOTICED, "all are good again")
        assert time.monotonic() - pulled < owsdtest.patience(2 * NOTICED)


def test_an_adapter_that_is_not_there_is_waited_for(scene):
    name = scene.path / "adapter"
    daemon = scene.owsd(owsdtest.rio(f"serial:{name}", ITEMS), ready=False)
    logged(daemon, f"no {name}: is the adapter plugged in?")
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
    point(name, adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good")


def test_a_silent_adapter_is_noticed_and_so_is_its_return(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
    daemon = house(scene, adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good")
    adapter("silent on")
    until(lambda: none_good(scene, daemon), NOTICED, "it is silent")
    logged(daemon, "nothing answers on")
    adapter("silent off")
    until(lambda: all_good(scene, daemon), NOTICED, "all are good again")


def test_turned_bits_never_become_values(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced", "--strict")
    daemon = house(scene, adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good")
    adapter("noise 97")
    end = time.monotonic() + 5
    while time.monotonic() < end:
        seen = values(scene, daemon)
        assert seen.items() <= VALUES.items(), seen
    assert adapter.running()
    adapter("noise 0")
    until(lambda: all_good(scene, daemon), 10, "all are good again")


def test_adapters_of_the_other_kind_are_named(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced")
    daemon = house(scene, adapter, "uart")
    logged(daemon, f"is serial:{scene.path}/adapter")
    daemon.stop()
    adapter = serialport.Adapter(scene, HOUSE, "--paced")
    daemon = house(scene, adapter)
    logged(daemon, f"a passive adapter, its target is uart:{scene.path}/adapter")


def test_a_passive_adapter_serves_pulled_and_plugged_in_too(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--paced")
    daemon = house(scene, adapter, "uart")
    until(lambda: all_good(scene, daemon), 20, lambda: scene.owsctl(daemon, "list").stdout)
    assert scene.owsctl(daemon, "set", "relay", "1").returncode == 0
    until(lambda: scene.get(daemon, "relay") == "1", 10, "the relay follows")
    adapter("unplug 100")
    until(lambda: none_good(scene, daemon), 10, "it is missed")
    adapter = serialport.Adapter(scene, HOUSE, "--paced")
    point(scene.path / "adapter", adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good again")
    adapter("short 0x18 for 6s")
    until(lambda: none_good(scene, daemon), 10, "a short")
    until(lambda: all_good(scene, daemon), 20, "and its end")


def test_another_program_at_the_adapter_is_named(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--paced")
    daemon = house(scene, adapter)
    until(lambda: all_good(scene, daemon), 20, "all are good")
    second = scene.owsd(owsdtest.rio(f"serial:{adapter.name}", ITEMS), ready=False)
    logged(second, f"in use by owsd (process {daemon.pid})")


if __name__ == "__main__":
    owsdtest.main()
