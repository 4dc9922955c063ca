#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Device alarms from the simulated wire to the control program."""

import json
import subprocess
import sys

import owsdtest
import peer
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
        done = subprocess.run([sys.executable, "-c", PYTHON, owsdtest.PYTHON, daemon.name],
                              capture_output=True, text=True, check=True, timeout=60)
        return done.stdout.split()

    once, none = ["1", "0", "0", "0"], ["0"] * 4
    new = ["1"] * 4
    assert runs_of_owsctl() == new, "each run is a reader of its own"
    assert served() == once
    assert python() == once, "each handle is a reader of its own"
    assert python() == once
    assert runs_of_owsctl() == new
    assert served() == none
    assert json.loads(scene.owsctl(daemon, "--json", "get", "inputs_Alarm").stdout)[0]["value"] is True
    done = scene.owsctl(daemon, "get", "inputs_Alarm", "hall_Alarm", f"{daemon.name}__inputs_Alarm")
    assert done.stdout.split() == ["1", "0", "0"], "one handle, which has read it a moment before"
    # what another owsd counted means nothing
    daemon.stop()
    again = scene.owsd(config(f"sim:{scene.file('press.sim', ONE_ALARM)}"), "-l", port, name=daemon.name)
    until(lambda: counter(scene, again, "alarms"), 30, "the alarm of this one")
    assert runs_of_owsctl() == new


def test_a_bus_without_alarm_search_reads_its_alarm_items_as_inputs(scene):
    # the null bus has no list of alarms
    daemon = scene.owsd(config("null:"), "-v")
    until(lambda: "read as ordinary inputs" in daemon.log(), 5, "said once")
    assert daemon.log().count("read as ordinary inputs") == 1


def buttons_and_lamp(target):
    """The DS2408 of docs/alarms.md."""
    return owsdtest.rio(target, [
        dict(Name="buttons", Path=SWITCH + "/sensed.BYTE", Type=raw("byte"), Uncached=raw("on"),
             Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
             SetAlarm="set_alarm=133331111", ResetLatch="latch.BYTE=0"),
        dict(Name="lamp", Path=SWITCH + "/PIO.0", Type=raw("bool"), IO=raw("output"),
             InitValue="0", ReadBack=raw("0")),
    ], Period=0.05)


def without_set_alarm(target):
    text = buttons_and_lamp(target)
    return "\n".join(line for line in text.splitlines() if "SetAlarm" not in line) + "\n"


def transactions(scene, daemon, name):
    """Writes, of an output that is not read back."""
    return int(scene.owsctl(daemon, "get", name + "_TRANSACTIONS").stdout)


def one_restart(scene, daemon, why):
    """What is seen of one restart whose por stands: for seconds, and nothing more of it after."""
    key = "PorAlarm" if why.startswith("por") else "SetAlarm"
    said = "the alarm cannot be armed: " + (why if why.startswith(key) else f"{key}: {why}")
    until(lambda: said in daemon.log(), 20, daemon.log)
    # by the machine, or in its turn; a write that was on its way before is one more
    owsdtest.settled(lambda: transactions(scene, daemon, "lamp"))
    owsdtest.worked(daemon.name, 6)
    written = transactions(scene, daemon, "lamp")
    assert 1 <= written <= 2, f"its outputs are written once, not {written} times\n{daemon.log()}"
    assert daemon.log().count("the device has restarted") == 1, daemon.log()
    assert daemon.log().count(said) == 1, daemon.log()
    told = [(a["alarm"], a["event"]) for a in history(scene, daemon)]
    assert told.count(("device", "failed")) == 1 and len(told) == 2, told
    assert counter(scene, daemon, "power_on_resets") == 1
    assert scene.get(daemon, "buttons") is not None, "its value is good"
    listed = scene.owsctl(daemon, "list").stdout
    assert "! cannot be armed" in listed, listed
    alarms = scene.owsctl(daemon, "alarms").stdout
    assert f"\nbuttons: cannot be armed: {key} " in alarms and "IO input" not in alarms, alarms
    assert max(map(len, alarms.splitlines())) <= 80, alarms
    got = json.loads(scene.owsctl(daemon, "--json", "get", "buttons").stdout)
    assert got[0]["err"] and got[0]["good"], got


def test_a_restart_without_setalarm_is_one_restart(scene):
    wire = scene.file("net.sim", "i2c speed 400\nchip DS2482-100 0x18\nDS2408 29.000000000001\n")
    file = scene.file("board.rio", without_set_alarm(f"sim:{wire}"))
    checked = scene.owsd_once("--check", "-c", file)
    assert checked.returncode == 0, checked
    assert "cannot be armed after a restart of its device: SetAlarm is not defined" in checked.stderr
    one_restart(scene, scene.owsd(file, "-v"), "SetAlarm is not defined")


BOARD = {SWITCH + "/" + name: value for name, value in (
    ("sensed.BYTE", "255"), ("latch.BYTE", "0"), ("por", "1"), ("set_alarm", "133331111"),
    ("PIO.0", "0"))}


def test_a_restart_whose_setalarm_or_por_is_refused_is_one_restart_until_that_heals(scene):
    for refused, why in (("set_alarm", "set_alarm cannot be written: "),
                         ("por", "por cannot be set to 0: ")):
        with peer.Peer(BOARD) as server:
            server.alarms = {SWITCH[1:]}
            server.readonly = {f"{way}{SWITCH}/{refused}" for way in ("", "/uncached")}
            daemon = scene.owsd(buttons_and_lamp(server.target), "-v")
            one_restart(scene, daemon, why)
            writes = [path for path, _ in server.writes if path.endswith("PIO.0")]
            assert 1 <= len(writes) <= 2, server.writes
            server.readonly = set()
            until(lambda: "armed again" in daemon.log(), 70, daemon.log)
            assert server[SWITCH + "/por"] == "0"
            assert "cannot be armed" not in scene.owsctl(daemon, "list").stdout
            server.values[SWITCH + "/por"] = b"1"
            until(lambda: counter(scene, daemon, "power_on_resets") == 2, 20, "the next is one more")
            until(lambda: server[SWITCH + "/por"] == "0", 20, "and is ended")
            assert daemon.stop() == 0


def test_a_mistyped_resetlatch_is_named_and_is_written_ever_rarer(scene):
    board = {**BOARD, SWITCH + "/por": "0", SWITCH + "/latch.BYTE": "8"}
    with peer.Peer(board) as server:
        server.alarms = {SWITCH[1:]}
        text = buttons_and_lamp(server.target).replace("latch.BYTE=0", "latch.BYT=0")
        daemon = scene.owsd(text)
        said = "the alarm cannot be reset: ResetLatch: latch.BYT cannot be written: "
        until(lambda: said in daemon.log(), 20, daemon.log)
        assert "alarm, latch.BYTE is 8" in daemon.log(), "the alarm is in the log without -v"
        assert "! cannot be reset" in scene.owsctl(daemon, "list").stdout
        alarms = scene.owsctl(daemon, "alarms").stdout
        assert "\nbuttons: cannot be reset: ResetLatch: " in alarms, alarms
        failed = [a for a in history(scene, daemon) if a["event"] == "failed"]
        assert [a["remark"].startswith("cannot be reset: ResetLatch: ") for a in failed] == [True], failed
        assert scene.get(daemon, "buttons") == "255", "its value is good, and is read"
        server.values[SWITCH + "/latch.BYT"] = b"0"
        until(lambda: "the alarm can be reset again" in daemon.log(), 70, daemon.log)
        assert daemon.log().count(said) == 1, daemon.log()
        assert "cannot be" not in scene.owsctl(daemon, "list").stdout


if __name__ == "__main__":
    owsdtest.main()
