#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Engineering values, from the chips of the simulator to every face: the example of the docs."""

import contextlib
import json
import re
import signal
import sqlite3

import owsdtest
from owsdtest import SOURCE

import ows  # of owsdtest.PYTHON

EXAMPLE = SOURCE / "docs/examples/engineering.rio"
CHIPS = """i2c speed 400
chip DS2482-100 0x18
DS2450 20.000000000001 volt.A {a} volt.B 3 volt.C 2.5 volt.D 4.5
DS2408 29.000000000001
"""


def plant(scene, volts="3", **driver):
    """owsd on the example, with simulated chips; volts at the first input."""
    chips = scene.file("net.sim", CHIPS.format(a=volts))
    text = EXAMPLE.read_text().replace("localhost:4304", f"sim:{chips}")
    text = re.sub(r"(?m)^(\s+)Period .*", r"\1Period 0.02", text)
    for key, value in driver.items():
        text = text.replace("  Period ", f'  {key} "{value}"\n  Period ')
    daemon = scene.owsd(scene.file("plant.rio", text))
    scene.until(lambda: all(row["measured"] for row in listed(scene, daemon).values()), 20,
                lambda: listed(scene, daemon))
    return daemon


def listed(scene, daemon):
    return {row["name"]: row for row in json.loads(scene.owsctl(daemon, "--json", "list").stdout)}


def near(value, expected, by=0.01):
    return abs(value - expected) <= by


def test_the_example_is_a_configuration_without_fault(scene):
    done = scene.owsd_once("--check", "-c", EXAMPLE)
    assert done.returncode == 0 and not done.stderr, done
    again = scene.owsd_once("--check", "-c", scene.file("again.rio", done.stdout))
    assert again.stdout == done.stdout, again


def test_a_current_loop_is_shown_in_its_unit_and_the_raw_value_beside_it(scene):
    daemon = plant(scene)
    rows = listed(scene, daemon)
    pressure, level, oil, supply = (rows[n] for n in ("pressure", "level", "oil", "supply"))
    assert near(pressure["value"], 3) and near(pressure["raw"], 3) and pressure["good"], pressure
    assert (pressure["unit"], pressure["decimals"], pressure["description"]) == \
        ("bar", 2, "Cold water, supply"), pressure
    assert level["value"] == 50 and near(level["raw"], 3) and level["decimals"] == 1, level
    assert near(oil["value"], 30, 0.1) and oil["unit"] == "°C", oil
    assert near(supply["value"], 4.5) and supply["unit"] == "V" and supply["decimals"] == 3, supply
    assert near(float(scene.get(daemon, "pressure")), 3, 0.001)
    assert near(float(scene.get(daemon, "pressure_Raw")), 3)
    table = scene.owsctl(daemon, "list").stdout
    assert re.search(r"^NAME +VALUE +UNIT +QUALITY", table), table
    assert re.search(r"(?m)^level +50 +% +good", table), table
    assert re.search(r"(?m)^pressure +3 +bar +good", table), table


def test_a_broken_wire_is_out_of_range(scene):
    daemon = plant(scene, "0.2")
    pressure = listed(scene, daemon)["pressure"]
    assert not pressure["good"] and pressure["quality_code"] == 0x54, pressure
    assert near(pressure["value"], -1.2) and near(pressure["raw"], 0.2), pressure
    assert scene.owsctl(daemon, "get", "pressure").returncode == 3


def test_a_spike_of_seconds_in_a_freezer_is_in_no_value_no_alarm_and_no_history(scene):
    wire = scene.file("net.sim", "i2c speed 400\nchip DS2482-100 0x18\n"
                      "DS18B20 28.000000000004 temperature steps 0:-16 6s:80.5625 9s:-16.5\n")
    item = dict(Name="freezer", Path="/28.000000000004/temperature", Type="double", MaxStep=2, LimitH=-10)
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [item], Period=0.05, Recorder=owsdtest.raw(
        f'{{ Flush 1 Directory "{scene.path / "history"}" Record "raw" }}')))
    recorder = scene.start([owsdtest.BUILD / "owsd-recorder", "-n", daemon.name, "-c", daemon.config])
    owsdtest.logged(recorder, "recording 1 of 1")
    watch = scene.start([owsdtest.BUILD / "owsctl", "-n", daemon.name, "watch", "-l", "freezer"])
    seen = {}

    def over():
        row = listed(scene, daemon)["freezer"]
        assert not row["measured"] or row["value"] < -15, row
        seen[row["error"]] = row
        return row["value"] == -16.5 and row["good"] and not row["error"]
    scene.until(over, 30, lambda: listed(scene, daemon))
    held = [row for error, row in seen.items() if error and "a jump beyond MaxStep" in error]
    assert held and held[0]["age"] > 1, seen
    assert scene.owsctl(daemon, "--json", "alarms", "history").stdout.strip() == "[]"
    assert recorder.stop() == 0
    with contextlib.closing(sqlite3.connect(scene.path / "history" / "history.sqlite")) as db:
        kept = {value for value, quality in db.execute("select value, quality from raw") if quality == 0xC0}
    assert kept == {-16, -16.5}, kept
    assert "-16.5" in watch.log() and "80.5" not in watch.log(), watch.log()


def test_a_pressure_beyond_its_limit_is_an_alarm_in_bar(scene):
    daemon = plant(scene, "4.5")
    scene.until(lambda: "! high" in scene.owsctl(daemon, "list").stdout, 10, "the alarm")
    history = scene.owsctl(daemon, "alarms", "history").stdout
    assert re.search(r"pressure +high raised +5\.25 ", history), history


def test_a_command_goes_out_as_its_raw_value_and_comes_back(scene):
    daemon = plant(scene)
    done = scene.owsctl(daemon, "set", "-w", "20", "valve", "50")
    assert done.returncode == 0, done
    # 127.5 is no step of the ladder: the valve is as near as it can be
    scene.until(lambda: scene.get(daemon, "valve_Raw") == "128", 10, "written and read back")
    assert scene.get(daemon, "valve") == "50"
    assert "commanded" not in scene.owsctl(daemon, "list", "valve").stdout
    done = scene.owsctl(daemon, "set", "-w", "5", "valve", "100.1")
    assert done.returncode == 1 and "beyond the signal's range" in done.stderr, done
    assert scene.get(daemon, "valve_Raw") == "128"
    assert scene.owsctl(daemon, "set", "-w", "20", "valve", "100").returncode == 0
    scene.until(lambda: scene.get(daemon, "valve_Raw") == "255", 10, "all on")


def test_a_reload_that_changes_a_scale_changes_value_and_output(scene):
    daemon = plant(scene)
    assert scene.owsctl(daemon, "set", "-w", "20", "valve", "40").returncode == 0
    scene.until(lambda: scene.get(daemon, "valve_Raw") == "102", 10, "written")
    file = scene.path / "plant.rio"
    text = re.sub(r"Max +6.15", "Max 12.3", file.read_text().replace("1:0 5:6", "1:0 5:12"))
    file.write_text(text.replace("0:0 255:100", "0:0 100:100"))
    daemon.signal(signal.SIGHUP)
    scene.until(lambda: near(float(scene.get(daemon, "pressure") or 0), 6), 10, "twice the range")
    scene.until(lambda: scene.get(daemon, "valve_Raw") == "40", 10, "written in the new scale")
    assert scene.get(daemon, "valve") == "40"


def test_a_program_in_python_has_value_unit_and_raw_value(scene):
    daemon = plant(scene)
    with ows.Ows(daemon.name) as signals:
        info = signals.info("pressure")
        assert near(signals.get("pressure").value, 3) and near(signals.get("pressure_Raw").value, 3)
        assert (info.unit, info.decimals, info.points) == ("bar", 2, "1:0 5:6"), info
        assert (info.min, info.max, info.limit_h, info.limit_l) == (-0.15, 6.15, 5, None), info
        assert (info.family, info.device) == ("DS2450", "20.000000000001"), info
        assert info.calibrated == "2026-11-22", info
        level = signals.info("level")
        assert (level.scale, level.offset, level.filter, level.deadband) == (25, -25, 5, 2), level


def test_a_unit_converts_values_limits_and_commands(scene):
    chips = scene.file("net.sim", """i2c speed 400
chip DS2482-100 0x18
DS18B20 28.000000000001 temperature 20
EDS0068 7E.000000000001 temperature 20.5 humidity 45 pressure 1010 light 300
""")
    text = f"""OwsDrv {{
  TargetName "sim:{chips}"
  Period 0.05
  Item {{ Name room Path "/28.000000000001/temperature9" Type double Unit F LimitH 67 Min -40 }}
  Item {{ Name high Path "/28.000000000001/temphigh" Type double IO output Unit "°F" }}
  Item {{ Name air Path "/7E.000000000001/EDS0068/pressure" Type double Unit kPa }}
  Item {{ Name humid Path "/7E.000000000001/EDS0068/humidity" Type double }}
}}
"""
    file = scene.file("plant.rio", text)
    check = scene.owsd_once("--check", "-c", file)
    assert check.returncode == 0 and not check.stderr, check
    daemon = scene.owsd(file)
    scene.until(lambda: all(listed(scene, daemon)[n]["good"] for n in ("room", "air", "humid")), 20,
                lambda: listed(scene, daemon))
    rows = listed(scene, daemon)
    assert (rows["room"]["value"], rows["room"]["unit"], rows["room"]["raw"]) == (68, "°F", 20), rows["room"]
    assert near(rows["air"]["value"], 101) and rows["air"]["unit"] == "kPa", rows["air"]
    assert rows["humid"]["unit"] == "%" and rows["humid"]["value"] == 45, rows["humid"]
    assert "room" in scene.owsctl(daemon, "alarms").stdout
    scene.owsctl(daemon, "set", "high", "212")
    scene.until(lambda: scene.owsctl(daemon, "read", "28.000000000001/temphigh").stdout.strip() == "100", 10,
                lambda: listed(scene, daemon)["high"])
    row = scene.until(lambda: (r := listed(scene, daemon)["high"])["good"] and r, 10, "the output is good")
    assert row["value"] == 212 and row["unit"] == "°F" and row["raw"] == 100, row


def test_the_served_table_has_engineering_values_and_the_served_chip_its_own(scene):
    port = owsdtest.free_port()
    daemon = plant(scene, Listen=port)
    client = ("-t", f"localhost:{port}")

    def read(path):
        return scene.owsctl(None, *client, "read", path).stdout.strip()
    assert near(float(read("/signals/pressure")), 3), read("/signals/pressure")
    assert near(float(read("/signals/oil")), 30, 0.1)
    assert near(float(read("/signals/oil_Raw")), 2.5)
    assert near(float(read("/20.000000000001/volt.C")), 2.5)
    assert scene.owsctl(None, *client, "write", "/signals/valve", "20").returncode == 0
    scene.until(lambda: scene.get(daemon, "valve_Raw") == "51", 10, "set by a client")
    done = scene.owsctl(None, *client, "write", "/signals/valve", "120")
    assert done.returncode == 1 and "refuses this value" in done.stderr, done


if __name__ == "__main__":
    owsdtest.main()
