#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The simulated serial adapters serve the genuine programs as the true ones do: owserver and
digitemp find the devices and read what the scenario says, and never too fast."""

import os
import shutil
import subprocess

import owsdtest
import serialport

HOUSE = """chip DS2482-100 0x18
DS18B20 28.0000000000A1 as kitchen temperature 21.5
DS18B20 28.0000000000E3 as cellar temperature -3.25
DS18B20 28.0000000000A5 as wire temperature 4 parasite
DS2408 29.0000000000B1
DS2413 3A.0000000000E3
"""
DEVICES = ["/28.0000000000A1", "/28.0000000000A5", "/28.0000000000E3", "/29.0000000000B1",
           "/3A.0000000000E3"]


def digitemp(scene, program, *options):
    if shutil.which(program) is None:
        owsdtest.skip(f"{program} is not installed")
    done = subprocess.run([program, "-q", "-c", str(scene.path / "digitemprc"), *options], text=True,
                          capture_output=True, timeout=owsdtest.PATIENCE, env=serialport.environment())
    assert done.returncode == 0, done
    return done.stdout


def temperatures(scene, program, port):
    """What digitemp reads after it has searched."""
    digitemp(scene, program, "-s", port, "-i")
    return sorted(digitemp(scene, program, "-s", port, "-a", "-o", "%R %.2C").splitlines())


def served_by_owserver(scene, adapter, *options):
    server = scene.owserver(options=options, env=serialport.GENUINE)
    owsdtest.until(lambda: server.devices() == DEVICES, 30, lambda: f"devices: {server.devices()}")
    assert server.read("/uncached/28.0000000000A1/temperature") == "21.5"
    assert server.read("/uncached/28.0000000000E3/temperature") == "-3.25"
    assert server.read("/uncached/29.0000000000B1/sensed.BYTE") == "255"
    return server


def sees_a_short(server, adapter):
    assert adapter("short 0x18") == "ok"
    assert server.request(owsdtest.READ, "/uncached/28.0000000000A1/temperature")[0] < 0


def test_digitemp_reads_a_ds2480b_and_feeds_a_sensor_on_two_wires(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--strict")
    lines = temperatures(scene, "digitemp_DS9097U", adapter.name)
    assert [line.split()[1] for line in lines if line.startswith("28")] == ["21.50", "4.00", "-3.25"], lines
    assert adapter.stats()["conversions"] == 3, adapter.stats()


def test_owserver_reads_a_ds2480b(scene):
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--strict")
    server = served_by_owserver(scene, adapter, "-d", adapter.name)
    assert server.read("/uncached/28.0000000000A5/temperature") == "4"
    stats = adapter.stats()
    assert stats["overruns"] == 0 and stats["master_resets"] >= 1, stats
    sees_a_short(server, adapter)


def test_digitemp_reads_a_passive_adapter(scene):
    adapter = serialport.Adapter(scene, HOUSE)
    lines = temperatures(scene, "digitemp_DS9097", adapter.name)
    # nothing feeds the sensor on two wires
    assert [line.split()[1] for line in lines if line.startswith("28")] == ["21.50", "85.00", "-3.25"], lines


def test_owserver_reads_a_passive_adapter(scene):
    adapter = serialport.Adapter(scene, HOUSE)
    sees_a_short(served_by_owserver(scene, adapter, f"--passive={adapter.name}"), adapter)


def test_bytes_that_come_faster_than_the_wire_are_lost_and_end_the_strict_adapter(scene):
    """The adapter has one byte of buffer, and a byte takes the wire 0.56 ms."""
    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--strict")
    # not the terminal that controls the test: whose end ends the test, too
    with open(adapter.name, "r+b", buffering=0, opener=lambda path, how: os.open(path, how | os.O_NOCTTY)) as port:
        port.write(b"\xE1" + b"\xFF" * 200)
        owsdtest.until(lambda: adapter.stats()["answers"] == 200, 10, "200 bytes at 9600")
        assert adapter.stats()["overruns"] == 0
        port.write(b"\xE3\x73")  # 19 200
        owsdtest.until(lambda: adapter.stats()["baud"] == 19200, 10, "the speed is set")
        subprocess.run(["stty", "-F", adapter.name, "19200"], check=True)
        port.write(b"\xE1" + b"\xFF" * 10)
        owsdtest.until(lambda: adapter.stats()["answers"] == 211, 10, "ten bytes at 19 200")
        assert adapter.stats()["overruns"] == 0
        port.write(b"\xFF" * 200)
        assert adapter.wait() == 3


if __name__ == "__main__":
    owsdtest.main()
