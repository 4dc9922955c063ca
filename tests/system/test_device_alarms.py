#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Device alarms from the simulated wire to the control program."""

import json
import os
import subprocess
import sys

import owsdtest
from owsdtest import raw, until

NETWORK = """
i2c speed 400
chip DS2482-100 0x18
DS18B20 28.0000000000B1 as hall    temperature 21
DS2408  29.000000000001 as relays  pin.4 steps 0:1 2s:0 repeat 4s
at 11s every 11s brownout relays
"""
SWITCH = "/29.000000000001"


def config(target):
    return owsdtest.rio(target, [
        dict(Name="hall", Path="/28.0000000000B1/temperature12", Type=raw("double"),
             IO=raw("input")),
        dict(Name="inputs", Path=SWITCH + "/sensed.BYTE", Type=raw("byte"), IO=raw("input"),
             Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
             SetAlarm="set_alarm=133333333", ResetLatch="latch.BYTE=0"),
        dict(Name="relays", Path=SWITCH + "/PIO.BYTE", Type=raw("byte"), IO=raw("output"),
             InitValue="1"),
    ])


def history(scene, daemon):
    done = scene.owsctl(daemon, "--json", "alarms", "history")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def counter(scene, daemon, name):
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return next(c["value"] for c in stats["counters"] if c["name"] == name)


def test_an_input_change_is_an_alarm_with_its_value_and_a_restart_is_mended(scene):
    daemon = scene.owsd(config(f"sim:{scene.file('net.sim', NETWORK)}"))
    until(lambda: scene.get(daemon, "inputs"), 10, "the inputs are read")
    until(lambda: counter(scene, daemon, "alarms") >= 3, 20, "three changes of the input")
    until(lambda: counter(scene, daemon, "power_on_resets") >= 2, 20,
          "the restart (and the one before owsd began) was seen")
    until(lambda: any(a["name"] == "inputs" and a["event"] == "raised" for a in history(scene, daemon)), 10,
          "its alarm is in the history")
    until(lambda: any("power" in a["alarm"] for a in history(scene, daemon)), 10,
          "the restart is in the history")
    until(lambda: scene.get(daemon, "relays") == "1", 10, "the output has its value again")
    until(lambda: scene.get(daemon, "inputs_Alarm") is not None, 10, "it has its alarm")


# Its latch remembers the InitValue that is written to it, and then nothing more happens
ONE_ALARM = """
chip DS2482-100 0x18
DS18B20 28.0000000000B1 as hall    temperature 21
DS2408  29.000000000001 as relays
"""
PYTHON = """
import sys
sys.path.insert(0, sys.argv[1])
import ows
with ows.Ows(sys.argv[2]) as signals:
    print(*(int(signals.get("inputs_Alarm").value) for _ in range(4)))
"""


def test_reading_the_alarm_flag_clears_it_for_this_reader_and_for_no_other(scene):
    port = owsdtest.free_port()
    daemon = scene.owsd(config(f"sim:{scene.file('press.sim', ONE_ALARM)}"), "-l", port)
    until(lambda: any(a["event"] == "returned" and a["name"] == "inputs"
                      for a in history(scene, daemon)), 30, "its one alarm has come and gone")

    def runs_of_owsctl():
        return [scene.owsctl(daemon, "get", "inputs_Alarm").stdout.strip() for _ in range(4)]

    def served():
        return [scene.owsctl(None, "-t", f"127.0.0.1:{port}", "read", "/signals/inputs_Alarm")
                .stdout.strip() for _ in range(4)]

    def python():
        done = subprocess.run([sys.executable, "-c", PYTHON, owsdtest.SOURCE / "src/libows", daemon.name],
                              capture_output=True, text=True, check=True, timeout=60)
        return done.stdout.split()

    once, none = ["1", "0", "0", "0"], ["0"] * 4
    assert runs_of_owsctl() == once
    assert served() == once
    assert python() == once, "each handle is a reader of its own"
    assert python() == once
    assert runs_of_owsctl() == none
    assert served() == none
    assert json.loads(scene.owsctl(daemon, "--json", "get", "inputs_Alarm").stdout)[0]["value"] is False
    done = scene.owsctl(daemon, "get", "inputs_Alarm", "hall_Alarm", f"{daemon.name}__inputs_Alarm")
    assert done.stdout.split() == ["0"] * 3, done
    # what another owsd counted means nothing
    daemon.stop()
    again = scene.owsd(config(f"sim:{scene.file('press.sim', ONE_ALARM)}"), "-l", port, name=daemon.name)
    until(lambda: counter(scene, again, "alarms"), 30, "the alarm of this one")
    assert runs_of_owsctl() == once


def test_what_owsctl_has_seen_is_kept_in_no_file_of_another(scene):
    daemon = scene.owsd(config(f"sim:{scene.file('press.sim', ONE_ALARM)}"))
    until(lambda: counter(scene, daemon, "alarms"), 30, "an alarm")
    seen, other = f"/dev/shm/owsd.{daemon.name}.seen.{os.geteuid()}", scene.file("other", "kept")
    os.symlink(other, seen)
    for _ in range(2):
        done = scene.owsctl(daemon, "get", "inputs_Alarm")
        assert (done.returncode, done.stdout) == (0, "1\n"), done
    assert other.read_text() == "kept"
    os.unlink(seen)
    os.mkfifo(seen)
    assert scene.owsctl(daemon, "get", "inputs_Alarm").stdout == "1\n"
    os.unlink(seen)
    with open(seen, "w", encoding="ascii") as f:
        f.write("999999999999999999999999\n-5 inputs\n7\n\0\x7f" + "9" * 5000)
    assert scene.owsctl(daemon, "get", "inputs_Alarm").stdout == "1\n"
    assert scene.owsctl(daemon, "get", "inputs_Alarm").stdout == "0\n"
    daemon.stop()
    assert scene.owsctl(None, "remove", daemon.name).returncode == 0
    assert not os.path.exists(seen)


def test_a_bus_without_alarm_search_reads_its_alarm_items_as_inputs(scene):
    # the null bus has no list of alarms
    daemon = scene.owsd(config("null:"), "-v")
    until(lambda: "read as ordinary inputs" in daemon.log(), 5, "said once")
    assert daemon.log().count("read as ordinary inputs") == 1


if __name__ == "__main__":
    owsdtest.main()
