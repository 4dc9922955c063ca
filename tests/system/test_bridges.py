#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sensors behind bridges: the shipped table, from the file to signals; errors with file and line."""

import json
import os
import signal
import subprocess

import owsdtest
from owsdtest import SOURCE

SHIPPED = SOURCE / "docs/examples/sensors.table"
CHIPS = """i2c speed 400
chip DS2482-100 0x18
DS28E17 19.0000000000E1  sht4x 0x44 mcp23017 0x20 temperature 21.5 humidity 40
DS28E18 56.0000000000E2  bme280 0x76 temperature -7 pressure 990
"""
PLACES = """at 19.0000000000E1 sht4x 0x44
at 19.0000000000E1 mcp23017 0x20 as io
at 56.0000000000E2 bme280 0x76
"""
SIGNALS = """OwsDrv {{
  TargetName "sim:{chips}"
  Period 0.05
  Bus {{ Target "sim:{chips}" Sensors "{table}" }}
  Item {{ Name "room" Path "/19.0000000000E1/temperature" Type "double" }}
  Item {{ Name "out" Path "/19.0000000000E1/io/latch" Type "double" IO "output" }}
  Item {{ Name "pressure" Path "/56.0000000000E2/pressure" Type "double" }}
}}
"""


def configuration(scene, places):
    chips = scene.file("net.sim", CHIPS)
    table = scene.file("sensors.table", SHIPPED.read_text() + places)
    return table, scene.file("bridges.rio", SIGNALS.format(chips=chips, table=table))


def test_sensors_of_the_shipped_table_are_signals(scene):
    _, rio = configuration(scene, PLACES)
    daemon = scene.owsd(rio)

    def listed():
        rows = json.loads(scene.owsctl(daemon, "--json", "list").stdout)
        return {row["name"]: row for row in rows}
    scene.until(lambda: listed()["room"]["measured"] and listed()["pressure"]["measured"], 30,
                listed)
    assert abs(listed()["room"]["value"] - 21.5) < 0.01, listed()
    assert abs(listed()["pressure"]["value"] - 990) < 0.1, listed()
    assert scene.owsctl(daemon, "set", "out", "513").returncode == 0
    scene.until(lambda: listed()["out"]["value"] == 513, 10, listed)


def test_a_table_that_was_edited_is_read_again_by_a_reload(scene):
    table, rio = configuration(scene, PLACES)
    daemon = scene.owsd(rio)
    scene.until(lambda: abs(float(scene.get(daemon, "room") or 0) - 21.5) < 0.01, 30, "room is good")
    daemon.signal(signal.SIGHUP)
    scene.until(lambda: daemon.log().count("signals from") == 2, 10, daemon.log)
    assert daemon.log().count("from down to up") == 1, "nothing has changed"
    table.write_text(table.read_text().replace("= -45 + 175 * u16(0)", "= -44 + 175 * u16(0)"))
    daemon.signal(signal.SIGHUP)
    scene.until(lambda: abs(float(scene.get(daemon, "room") or 0) - 22.5) < 0.01, 30, "room is new")
    table.write_text(table.read_text() + "nonsense\n")
    daemon.signal(signal.SIGHUP)
    owsdtest.logged(daemon, "all goes on as before")
    assert abs(float(scene.get(daemon, "room")) - 22.5) < 0.01


def test_an_error_of_the_table_is_reported_with_its_file_and_line(scene):
    table, rio = configuration(scene, "at 19.0000000000E1 nothing 0x44\n")
    line = len(SHIPPED.read_text().split("\n"))
    done = scene.owsd_once("--check", "-c", rio)
    assert done.returncode != 0, done
    assert "bridges.rio:4:" in done.stderr and "Sensors: " in done.stderr, done.stderr
    assert f"sensors.table:{line}: no sensor nothing stands above" in done.stderr, (table, done)


def test_a_table_that_is_a_pipe_is_refused_and_not_waited_for(scene):
    table, rio = configuration(scene, PLACES)
    daemon = scene.owsd(rio)
    scene.until(lambda: scene.get(daemon, "room"), 30, "room is good")
    table.unlink()
    os.mkfifo(table)
    daemon.signal(signal.SIGHUP)
    owsdtest.logged(daemon, "sensors.table: not a regular file")
    owsdtest.logged(daemon, "all goes on as before")
    done = scene.owsd_once("--check", "-c", rio)
    assert done.returncode == 2 and "not a regular file" in done.stderr, done
    daemon.stop()


if __name__ == "__main__":
    owsdtest.main()
