#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The main job with the genuine owserver: signals of a .rio file, live in shared memory."""

import json
import socket

import owsdtest
from owsdtest import open_files, raw, settled, until


def house(server, period=0.05, **driver):
    thermometer = next(d for d in server.devices(0) if d.startswith("/28."))
    switch = next(d for d in server.devices(0) if d.startswith("/29."))
    return owsdtest.rio(server.target, [
        dict(Name="room", Path=thermometer + "/temperature12", IOType=raw("0x0018"), InitValue="22"),
        dict(Name="relay", Path=switch + "/PIO.BYTE", IOType=raw("0x0022"), InitValue="0"),
        dict(Name="limit", Path=thermometer + "/temphigh", Type=raw("float"), IO=raw("output"),
             Readable=raw("on")),
        dict(Name="type", Path=thermometer + "/type", Type=raw("string"), IO=raw("input")),
        dict(Name="bits", Path=switch + "/sensed.ALL", Type=raw("string"), IO=raw("input")),
        dict(Name="pid", Path="/system/process/pid", Type=raw("dword"), IO=raw("input")),
    ], Period=period, **driver)


def values(scene, daemon):
    done = scene.owsctl(daemon, "--json", "list")
    assert done.returncode == 0, done.stderr
    return {s["name"]: s for s in json.loads(done.stdout)}


def all_good(scene, daemon):
    return all(s["good"] for s in values(scene, daemon).values() if s["name"] != "limit")


def test_signals_of_a_file_are_live(scene):
    server = scene.owserver(mock=["28", "29"])
    daemon = scene.owsd(house(server))
    until(lambda: all_good(scene, daemon), 10, "all signals are good")
    # a heart that did not beat for two seconds hides a value, on a slow machine, for a moment
    assert until(lambda: scene.get(daemon, "type"), 10) == "DS18B20"
    assert int(until(lambda: scene.get(daemon, "pid"), 10)) == server.pid
    assert len(until(lambda: scene.get(daemon, "bits"), 10).split(",")) == 8
    # what a mock device was told it tells: the value has come from there
    server.write(next(d for d in server.devices(0) if d.startswith("/28.")) + "/temphigh", "42.5")
    until(lambda: scene.get(daemon, "limit") == "42.5", 5, "the value follows")


def test_the_init_value_is_written_and_a_set_reaches_the_device(scene):
    server = scene.owserver(mock=["28", "29"])
    thermometer = next(d for d in server.devices(0) if d.startswith("/28."))
    daemon = scene.owsd(house(server))
    until(lambda: scene.get(daemon, "relay") == "0", 5, "InitValue is confirmed")
    assert scene.owsctl(daemon, "set", "limit", "33.25").returncode == 0
    until(lambda: server.read(thermometer + "/temphigh") == "33.25", 5, "owserver has it")


def test_every_attribute_of_the_manual_answers_with_and_without_prefix(scene):
    server = scene.owserver(mock=["28", "29"])
    daemon = scene.owsd(house(server))
    until(lambda: all_good(scene, daemon), 10, "all signals are good")
    readable = ["_Value", "_TRANSACTIONS", "_ReadEnable", "_RE", "_WriteEnable", "_WE", "_Alarm",
                "_PerFactor", "_PerCount", "_PerMax", "_PendCount", "_PendLast", "_PendMax",
                "_Period", "_Age", "_AgeMax", "_Raw"]
    for attribute in readable:
        for name in ("room" + attribute, f"{daemon.name}__room{attribute}"):
            float(until(lambda: scene.get(daemon, name), 10, name))
    for name in ("_TRANSACTIONS", "_RECONNECTS", f"{daemon.name}___TRANSACTIONS"):
        assert int(until(lambda: scene.get(daemon, name), 10, name)) >= 0
    for attribute in ("_DGNRESET", "_WriteOneShot", "_WOS"):
        assert scene.owsctl(daemon, "get", "room" + attribute).returncode != 0, attribute
        assert scene.owsctl(daemon, "set", "relay" + attribute, "1").returncode == 0, attribute
    assert scene.owsctl(daemon, "set", "room_RE", "0").returncode == 0
    until(lambda: scene.owsctl(daemon, "get", "room").returncode == 3, 5, "reading is disabled")
    assert until(lambda: scene.get(daemon, "room_RE"), 10) == "0"


def test_files_of_genuine_shape_load_unchanged(scene):
    data = owsdtest.SOURCE / "tests/unit/data"
    files = sorted(data.glob("*.rio"))
    assert len(files) == 4, files
    for file in files:
        done = scene.owsd_once("--check", "-c", file)
        assert done.returncode == 0, f"{file.name}: {done.stderr}"
        again = scene.file("again.rio", done.stdout)
        assert scene.owsd_once("--check", "-c", again).stdout == done.stdout, file.name


def test_a_signal_that_cannot_work_is_reported_at_start_and_the_others_live(scene):
    server = scene.owserver(tester=["28", "29"])
    switch = next(d for d in server.devices(0) if d.startswith("/29."))
    thermometer = next(d for d in server.devices(0) if d.startswith("/28."))
    daemon = scene.owsd(owsdtest.rio(server.target, [
        dict(Name="good", Path=thermometer + "/temperature", Type=raw("double"), IO=raw("input")),
        dict(Name="text", Path=thermometer + "/type", Type=raw("double"), IO=raw("input")),
        dict(Name="readonly", Path=thermometer + "/temperature", Type=raw("double"),
             IO=raw("output"), InitValue="1"),
        dict(Name="writeonly", Path=switch + "/LCD_H/clear", Type=raw("bool"), IO=raw("input")),
        dict(Name="typo", Path=thermometer + "/temperatur", Type=raw("double"), IO=raw("input")),
        dict(Name="absent", Path="/28.AABBCCDDEEFF/temperature", Type=raw("double"),
             IO=raw("input")),
    ], Period=0.02))
    until(lambda: scene.get(daemon, "good"), 5, "the good one is good")

    def quality():
        return [values(scene, daemon)[n]["quality"] for n in
                ("text", "readonly", "writeonly", "typo", "absent")]
    until(lambda: quality() == ["wrong type", "access refused", "access refused",
                                "no such property", "device absent"], 5, "each has its reason")
    for name in ("text", "readonly", "writeonly"):
        owsdtest.logged(daemon, f'warning: "{name}" is')
    owsdtest.logged(daemon, "no such property: check its spelling")
    owsdtest.logged(daemon, "access refused: it can only be read, or only be written: IO input")
    until(lambda: scene.get(daemon, "good"), 10, "the good one is still good")


def test_signals_that_are_read_more_often_than_the_cache_is_renewed_are_named_once(scene):
    server = scene.owserver(tester=["28", "29"])
    thermometer = next(d for d in server.devices(0) if d.startswith("/28."))

    def started(**keys):
        daemon = scene.owsd(owsdtest.rio(server.target, [
            dict(Name=name, Path=thermometer + "/temperature", Type=raw("double"), IO=raw("input"),
                 **keys) for name in ("room", "hall")], Period=0.1))
        until(lambda: scene.get(daemon, "hall"), 10, "it reads")
        return daemon
    daemon = started()
    said = "may answer from a cache of 15 s, and 2 of its signals (room, ...) are read more often: Uncached on"
    owsdtest.logged(daemon, said)
    assert daemon.log().count("may answer from a cache") == 1
    for keys in (dict(Uncached=raw("on")), dict(PerFactor=150)):
        quiet = started(**keys)
        owsdtest.logged(quiet, "from down to up")
        assert "may answer from a cache" not in quiet.log(), keys


def test_a_device_under_an_alias_is_found_by_its_id(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices(0)[0]
    server.write(path + "/alias", "boiler")
    server.write(path + "/temphigh", "30")
    daemon = scene.owsd(owsdtest.rio(server.target, [
        dict(Name="by_id", Path=path + "/temphigh", Type=raw("long"), IO=raw("input")),
        dict(Name="by_alias", Path="/boiler/temphigh", Type=raw("long"), IO=raw("input"))]))
    until(lambda: scene.get(daemon, "by_id") == "30" and scene.get(daemon, "by_alias") == "30", 5,
          "both are read")


def test_what_a_living_program_commanded_outlives_owsd_by_name_type_and_path(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices(0)[0]
    name = scene.name()

    def config(*names):
        return owsdtest.rio(server.target, [
            dict(Name=n, Path=path + p, Type=raw("float"), IO=raw("output"), InitValue="1")
            for n, p in names])
    daemon = scene.owsd(config(("high", "/temphigh"), ("low", "/templow")), name=name)
    program = scene.start(["python3", "-c", f"""
import sys, time
sys.path.insert(0, {str(owsdtest.PYTHON)!r})
import ows
h = ows.Ows({daemon.name!r}, control=True)
h.beat(2000)
h.set("high", 77)
while True:
    time.sleep(0.1)  # pace
    try:
        h.beat(2000)
    except ows.Stale:
        try:
            h.reopen()
        except OSError:
            pass
"""])
    until(lambda: server.read(path + "/temphigh") == "77", 5, "written")
    daemon.kill()
    server.write(path + "/temphigh", "5")
    # the order changed, and `low` is another path now
    daemon = scene.owsd(config(("low", "/errata/trim"), ("high", "/temphigh")), name=name)
    until(lambda: server.read(path + "/temphigh") == "77", 5, "the commanded value is written again")
    program.stop()
    assert daemon.stop() == 0


def test_an_output_goes_to_its_safe_value_when_its_program_stops_beating(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices(0)[0]
    daemon = scene.owsd(owsdtest.rio(server.target, [
        dict(Name="high", Path=path + "/temphigh", Type=raw("float"), IO=raw("output"),
             SafeValue="11")], Period=0.05))
    program = scene.start(["python3", "-c", f"""
import sys, time
sys.path.insert(0, {str(owsdtest.PYTHON)!r})
import ows
h = ows.Ows({daemon.name!r}, control=True)
while True:
    h.beat(300)
    h.set("high", 70)
    time.sleep(0.1)  # pace
"""])
    until(lambda: server.read(path + "/temphigh") == "70", 10, "it controls")
    program.freeze()
    until(lambda: server.read(path + "/temphigh") == "11", 5, "SafeValue is written")
    owsdtest.logged(daemon, "stopped beating")
    program.thaw()
    until(lambda: server.read(path + "/temphigh") == "70", 10, "it controls again")
    program.kill()
    until(lambda: server.read(path + "/temphigh") == "11", 5, "SafeValue is written")
    owsdtest.logged(daemon, "ended without a goodbye: 1 output goes to SafeValue")


def test_two_owsd_of_one_name_do_not_meet(scene):
    server = scene.owserver(mock=["28", "29"])
    daemon = scene.owsd(house(server))
    second = scene.owsd_once("-n", daemon.name, "-c", daemon.config)
    assert second.returncode == 1
    assert str(daemon.pid) in second.stderr, second.stderr
    assert daemon.running() and until(lambda: scene.get(daemon, "room"), 5)


def test_a_killed_owsd_is_taken_over(scene):
    server = scene.owserver(mock=["28", "29"])
    name = scene.name()
    config = scene.file("house.rio", house(server))
    daemon = scene.owsd(config, name=name)
    until(lambda: scene.get(daemon, "room"), 5, "good")
    daemon.kill()
    until(lambda: scene.owsctl(daemon, "get", "room").returncode == 3, 10, "age shows")
    again = scene.owsd(config, name=name)
    until(lambda: scene.get(again, "room"), 5, "good again")
    owsdtest.logged(again, f"taken over from owsd {daemon.pid}, which had not stopped\n")


def test_bad_files_start_nothing_and_say_where(scene):
    for text, expected in (
            ("OwsDrv {\n  Timeout \"x\"\n}\n", ":2:"),
            ("OwsDrv {\n  Item {\n", ":3:"),
            ("", ":1:"),
            ("OwsDrv {\n  Item {\n    Name \"a\"\n    Path \"/28.AABBCCDDEEFF/t\"\n"
             "    IOType 0x0011\n    InitValue \"7\"\n  }\n}\n", ":6:")):
        file = scene.file("bad.rio", text)
        done = scene.owsd_once("-n", scene.name(), "-c", file)
        assert done.returncode == 2, (text, done)
        assert f"bad.rio{expected}" in done.stderr, (text, done.stderr)
    assert scene.owsd_once("-c", "/nonexistent.rio").returncode == 2
    assert scene.owsd_once("-n", "a/b").returncode == 2
    assert scene.owsd_once("--rt", "0").returncode == 2


def test_a_wrong_option_is_named_and_steers_no_terminal(scene):
    for words, expected in ((("-x",), "unknown option: -x"),
                            (("-vx",), "unknown option: -x"),
                            (("--\x1b[2J",), "unknown option: --?[2J"),
                            (("-\x1b",), "unknown option: -?"),
                            (("--check=1",), "--check takes no value: --check=1"),
                            (("--version=3",), "--version takes no value: --version=3"),
                            (("--ver",), "--ver may be --verbose or --version"),
                            (("--rt",), "option without its argument: --rt"),
                            (("-c",), "option without its argument: -c"),
                            (("house.rio",), "unexpected argument 'house.rio'"),
                            (("--root", "/"), "--root goes with --board"),
                            (("-t", "null:") * 65, "-t null:: at most"),
                            (("-t", ""), "-t: a target expected"),
                            (("-l", "4304") * 17, "-l 4304: at most")):
        done = scene.owsd_once(*words)
        assert done.returncode == 2, (words, done)
        assert done.stderr.startswith(f"owsd: {expected}"), (words, done.stderr)
        assert "\x1b" not in done.stderr, (words, done.stderr)


def test_owsd_starts_while_owserver_is_down_and_finds_it_later(scene):
    server = scene.owserver(mock=["28", "29"])
    config = house(server)
    server.kill()
    daemon = scene.owsd(config)
    until(lambda: values(scene, daemon)["room"]["quality_code"] == 0x18, 5, "target down")
    assert values(scene, daemon)["room"]["value"] == 22
    scene.again(server)
    until(lambda: scene.get(daemon, "room"), 15, "good")
    assert until(lambda: scene.get(daemon, "_RECONNECTS"), 10) == "0"


def test_ipv6_and_host_names_reach_owserver(scene):
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError as why:
        owsdtest.skip(f"this machine has no ::1: {why}")
    server = scene.owserver(mock=["28", "29"], host="::1")
    daemon = scene.owsd(house(server))
    until(lambda: scene.get(daemon, "room"), 5, "over [::1]")
    server = scene.owserver(mock=["28", "29"])
    config = house(server).replace("127.0.0.1:", "localhost:")
    daemon = scene.owsd(config)
    until(lambda: scene.get(daemon, "room"), 5, "over a name")
    owsdtest.logged(daemon, f"localhost:{server.port}")


def test_memory_and_descriptors_stay_flat(scene):
    server = scene.owserver(mock=["28", "29"])
    daemon = scene.owsd(house(server, period=0.001))

    def kib():
        with open(f"/proc/{daemon.pid}/status", encoding="ascii") as file:
            return int(file.read().split("RssAnon:")[1].split()[0])

    def transactions():
        return int(scene.get(daemon, "_TRANSACTIONS") or 0)
    until(lambda: transactions() > 500, 100)
    files, seen = settled(lambda: len(open_files(daemon))), [kib()]
    # a sanitizer's own memory grows by steps: what leaks grows each time
    for _turn in range(5 if owsdtest.BUILD.name in ("asan", "tsan") else 1):
        count = transactions()
        until(lambda: transactions() > count + 4500, 300)  # noqa: B023
        seen.append(kib())
        if seen[-1] - seen[-2] <= 64:
            break
    assert seen[-1] - seen[-2] <= 64, seen
    until(lambda: len(open_files(daemon)) == files, 10, f"descriptors {files}")


if __name__ == "__main__":
    owsdtest.main()
