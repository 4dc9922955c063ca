#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Outputs that lose their command, as the supply of their board fails or another program switches
them: over owsd's own bus, through an owserver which is another owsd, and through the genuine one,
which has the same wire behind a serial port (serial.c)."""

import json
import sys
import time

import owsdtest
from owsdtest import raw, until
import served

WIRE = """
i2c speed 400
chip DS2482-100 0x18
DS2408 29.000000000001 as relays
DS2413 3A.000000000001 as pair
"""
FAILING = """at 15s every 30s brownout relays
at 15s every 30s brownout pair
button unplug unplug pair
"""
COMMANDS = {"relays": ("/29.000000000001/PIO.BYTE", "byte", 255),
            "relay": ("/29.000000000001/PIO.0", "bool", 1),
            "lamp": ("/3A.000000000001/PIO.A", "bool", 1)}


def plant(scene, way, wire=WIRE + FAILING, **options):
    """The daemon whose outputs are looked at, and the server that has the wire."""
    items = [dict(Name=name, Path=path, Type=raw(kind), IO=raw("output"), ReadBack=raw("0.3"),
                  **options) for name, (path, kind, _) in COMMANDS.items()]
    wire = scene.file("wire.sim", wire)
    if way == "genuine":
        server = served.owserver_of(scene, wire)
        until(lambda: server.has(("/29.000000000001", "/3A.000000000001")), 30, "the devices")
        daemon = scene.owsd(owsdtest.rio(server.target, items, Period=raw("0.05")))
    elif way == "direct":
        server = served.owsd_of(scene, f"sim:{wire}", items=items, Period=raw("0.05"))
        daemon = server.program
        daemon.ready()
    else:
        server = served.owsd_of(scene, f"sim:{wire}", items=[])
        daemon = scene.owsd(owsdtest.rio(f"localhost:{server.port}", items, Period=raw("0.05")))
    for name, (_, _, value) in COMMANDS.items():
        until(lambda: scene.owsctl(daemon, "set", "-w", 5, name, value).returncode == 0, 20, name)
        until(lambda: scene.get(daemon, name) == str(value), 10, f"{name} is set")
    return daemon, server


def write(server, path, value):
    assert server.frame(served.WRITE, path, data=value).ret == 0, path


def row(scene, daemon, name):
    return next(r for r in json.loads(scene.owsctl(daemon, "--json", "list").stdout)
                if r["name"] == name)


def history(scene, daemon, name):
    done = scene.owsctl(daemon, "--json", "alarms", "history")
    return [e for e in json.loads(done.stdout)
            if e["name"] == name and e["alarm"] == "not as commanded"]


def writes(scene, daemon):
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return sum(c["value"] for c in stats["counters"] if c["name"] == "writes")


def looks(scene, daemon, name, times=3):
    """Let it be read back so often."""
    begun = row(scene, daemon, name)["count"]
    until(lambda: row(scene, daemon, name)["count"] >= begun + times, 20, f"{name} is read back")


def lines(daemon, name, text):
    return sum(text in line and f" {name} (" in f" {line}" for line in daemon.log().splitlines())


def marked_and_left_alone(scene, way, **options):
    daemon, _ = plant(scene, way, **options)
    looks(scene, daemon, "lamp", 2)
    assert not history(scene, daemon, "lamp"), "the command just given is no difference"
    written = writes(scene, daemon)
    for name, (_, _, value) in COMMANDS.items():
        until(lambda: row(scene, daemon, name)["quality"] == "not as commanded", 60, name)
        looks(scene, daemon, name)
        now = row(scene, daemon, name)
        assert (now["good"], now["quality_code"]) == (False, 0x1C), now
        assert (int(now["value"]), int(now["commanded"])) == (0, value), now
        assert f"commanded {value}" in scene.owsctl(daemon, "list", name).stdout
        entry, = history(scene, daemon, name)
        assert (entry["event"], entry["before"], entry["after"]) == ("raised", value, 0), entry
        until(lambda: lines(daemon, name, "not as commanded"), 10, "the log has it")
        assert lines(daemon, name, "not as commanded") == 1, daemon.log()
    # the same command again is no change
    again = scene.owsctl(daemon, "set", "-w", "2", "lamp", 1)
    assert again.returncode == 1 and "lamp_WriteOneShot" in again.stderr, again
    assert writes(scene, daemon) == written, "nothing was written"
    assert scene.owsctl(daemon, "set", "lamp_WOS", 1).returncode == 0
    until(lambda: scene.get(daemon, "lamp") == "1", 10, "written again by hand")
    assert [e["event"] for e in history(scene, daemon, "lamp")] == ["raised", "returned"]


def restored(scene, way):
    daemon, _ = plant(scene, way, Restore=raw("on"))
    for name in "relays", "lamp":
        until(lambda: len(history(scene, daemon, name)) >= 2, 60, f"{name} was lost and is back")
        until(lambda: scene.get(daemon, name) == str(COMMANDS[name][2]), 10, name)
        assert [e["event"] for e in history(scene, daemon, name)][:2] == ["raised", "returned"]
    for text in ("not as commanded", "the command is written again", "as commanded again"):
        until(lambda: len(history(scene, daemon, "lamp")) == 2 * lines(daemon, "lamp", text), 20,
              daemon.log)


def told_by_its_flag(scene, way):
    """The relays have a power-on flag, which is cleared; the lamp's chip has none."""
    daemon, server = plant(scene, way)
    write(server, "/29.000000000001/por", b"0")
    assert scene.owsctl(daemon, "set", "relays_WOS", 1).returncode == 0
    looks(scene, daemon, "relays", 5)
    until(lambda: row(scene, daemon, "lamp")["quality"] == "not as commanded", 60, "the restart")
    until(lambda: scene.get(daemon, "relays") == "255", 10, "the relays are on again")
    looks(scene, daemon, "lamp")
    assert row(scene, daemon, "lamp")["quality"] == "not as commanded"
    assert "written again" not in daemon.log()


def switched_by_another(scene, way, **options):
    """Behind owsd's back, at the server: no cache on the way hides it."""
    daemon, server = plant(scene, way, WIRE, **options)
    looks(scene, daemon, "lamp")
    begun = time.monotonic()
    write(server, COMMANDS["lamp"][0], b"0")
    until(lambda: row(scene, daemon, "lamp")["quality"] == "not as commanded", 60, "it is seen")
    assert time.monotonic() - begun < owsdtest.patience(3)
    assert row(scene, daemon, "lamp")["value"] == 0
    until(lambda: lines(daemon, "lamp", "not as commanded"), 10, "the log has it")
    write(server, COMMANDS["lamp"][0], b"1")
    until(lambda: scene.get(daemon, "lamp") == "1", 60, "and its end")
    assert [e["event"] for e in history(scene, daemon, "lamp")] == ["raised", "returned"]
    assert all(scene.get(daemon, name) == str(COMMANDS[name][2]) for name in ("relays", "relay"))


def test_a_board_that_lost_its_supply_is_marked_on_the_own_bus(scene):
    marked_and_left_alone(scene, "direct")


def test_a_board_that_lost_its_supply_is_marked_through_an_owserver(scene):
    marked_and_left_alone(scene, "owserver")


def test_a_board_that_lost_its_supply_is_marked_through_the_genuine_owserver(scene):
    marked_and_left_alone(scene, "genuine")


def test_restore_writes_it_again_on_the_own_bus(scene):
    restored(scene, "direct")


def test_restore_writes_it_again_through_an_owserver(scene):
    restored(scene, "owserver")


def test_restore_writes_it_again_through_the_genuine_owserver(scene):
    restored(scene, "genuine")


def test_a_restart_that_a_flag_shows_is_mended_on_the_own_bus(scene):
    told_by_its_flag(scene, "direct")


def test_a_restart_that_a_flag_shows_is_mended_through_an_owserver(scene):
    told_by_its_flag(scene, "owserver")


def test_a_restart_that_a_flag_shows_is_mended_through_the_genuine_owserver(scene):
    told_by_its_flag(scene, "genuine")


def test_what_another_program_switches_is_marked(scene):
    for way in "owserver", "genuine":
        with owsdtest.Scene() as own:
            switched_by_another(own, way)


def test_what_is_read_in_the_cycle_too_is_marked_though_a_cache_has_the_command(scene):
    for way in "direct", "owserver", "genuine":
        with owsdtest.Scene() as own:
            marked_and_left_alone(own, way, Readable=raw("on"))


def test_a_board_that_is_unplugged_is_absent_and_not_another(scene):
    for way in "direct", "owserver":
        daemon, server = plant(scene, way)
        write(server, "/simulator/unplug", b"1")
        until(lambda: row(scene, daemon, "lamp")["quality"] == "device absent", 30, way)
        assert not history(scene, daemon, "lamp"), way
        assert row(scene, daemon, "relays")["good"], way


if __name__ == "__main__":
    sys.exit(owsdtest.main(at_once=2))
