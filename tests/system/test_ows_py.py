#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""ows.py beside the headers that it repeats in Python, as a program, and in an asyncio loop."""

import ctypes
import re
import subprocess
import sys

import owsdtest
from owsdtest import SOURCE, raw, until

import ows  # of owsdtest.PYTHON

HEADERS = [SOURCE / "src/public/ows.h", SOURCE / "src/public/ows_history.h"]
# Structures of the headers that ows.py reads
STRUCTURES = {"ows_by": ows._By, "ows_value": ows._Value, "ows_origin": ows._Origin,
              "ows_controller": ows._Controller, "ows_cursor": ows._Cursor, "ows_info": ows._Info,
              "ows_daemon": ows._Daemon, "ows_target": ows._Target, "ows_device": ows._Device,
              "ows_alarm": ows._Alarm, "ows_alarm_state": ows._AlarmState,
              "ows_commanded": ows._Commanded, "ows_history_signal": ows._Signal,
              "ows_history_item": ows._Item, "ows_history_point": ows._Point,
              "ows_history_who": ows._By, "ows_history_event": ows._Event}
TYPES = {"const char *": {ctypes.c_char_p, ctypes.c_void_p}, "double ": {ctypes.c_double},
         "int ": {ctypes.c_int}, "char ": {ctypes.c_char}, "struct ows_by ": {ows._By},
         "struct ows_history_who ": {ows._By}, "uint8_t ": {ctypes.c_uint8, ctypes.c_bool},
         **{f"{sign}int{bits}_t ": {getattr(ctypes, f"c_{sign}int{bits}")}
            for sign in ("", "u") for bits in (32, 64)}}


def text_of(headers):
    return "".join(re.sub(r"/\*.*?\*/", "", file.read_text(), flags=re.S) for file in headers)


def members(body):
    for line in filter(None, (part.strip() for part in body.split(";"))):
        kind = next(kind for kind in TYPES if line.startswith(kind))
        for name in line[len(kind):].replace("*", "").split(","):
            yield (kind, *re.fullmatch(r"\s*(\w+)(?:\[(\d+)\])?", name).groups())


def test_its_structures_are_those_of_the_headers(_):
    bodies = dict(re.findall(r"struct (\w+) \{(.*?)\n\};", text_of(HEADERS), re.S))
    for name, structure in STRUCTURES.items():
        wanted = list(members(bodies[name]))
        assert [m[1] for m in wanted] == [field for field, _ in structure._fields_], name
        for (kind, member, size), (_, has) in zip(wanted, structure._fields_):
            one = has._type_ if size else has
            assert one in TYPES[kind] and (not size or has._length_ == int(size)), (name, member)


def test_it_has_each_type_quality_and_reason_of_the_header(_):
    values, number = {}, 0
    for body in re.findall(r"enum \w+ \{(.*?)\}", text_of(HEADERS[:1]), re.S):
        for name, value in re.findall(r"OWS_(\w+)(?: = (\w+))?", body):
            number = int(value, 0) if value else number + 1
            values[name] = number
    values.update((name, int(value, 0)) for name, value in
                  re.findall(r"#define OWS_(DETAIL_\w+) +(\w+)", text_of(HEADERS[:1])))
    has = {**vars(ows), **{f"UNARMED_{u.name}": u for u in ows.Unarmed}}
    for name in [t.name for t in ows.Type] + [n for n in values if re.match("Q_|DETAIL|UNARMED", n)]:
        assert has[name] == values[name], name
    assert {f"UNARMED_{u.name}" for u in ows.Unarmed} == {n for n in values if "UNARMED" in n}
    # The words for all others are the library's
    for call, kind in ((ows._lib.ows_reason_text, "REASON"), (ows._lib.ows_limit_state_text, "LIMIT"),
                       (ows._lib.ows_alarm_kind_text, "ALARM")):
        for name in (n for n in values if n.startswith(kind + "_")):
            assert call(values[name]) not in (b"", b"unknown"), name


def start(scene):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature 21.5\n"
                                   "DS2408 29.000000000002\nDS2433 23.000000000003\n")
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [
        dict(Name=name, Path=path, Type=raw(kind), IO=raw("output"), **more)
        for name, path, kind, more in (
            ("relay", "/29.000000000002/PIO.0", "bool", {}),
            ("heater", "/28.000000000001/templow", "double", {"Unit": "°C", "Min": 5, "Max": 30}),
            ("title", "/23.000000000003/pages/page.0", "string", {}))], Period=0.05))
    return daemon, ows.Ows(daemon.name, control=True)


def test_a_value_has_its_unit_and_an_error_its_limits(scene):
    _, signals = start(scene)
    with signals:
        signals.set("heater", 21)
        until(lambda: signals["heater"].good, 10)
        assert re.fullmatch(r"<Value 21.0 °C, good, \d+\.\d s old>", repr(signals["heater"])), signals["heater"]
        try:
            signals.set("heater", 31)
            raise AssertionError("beyond Max")
        except ValueError as e:
            assert str(e) == "heater: a double with Min 5 and Max 30 cannot hold 31", e
        signals.set("relay", "on")
        signals.set("title", "on")
        until(lambda: signals["relay"].value is True and signals["title"].value == "on", 10,
              lambda: list(map(signals.get, signals)))


def test_it_is_a_program_too(scene):
    daemon, _ = start(scene)

    def run(*arguments):
        return subprocess.run([sys.executable, owsdtest.PYTHON / "ows.py", "-n", daemon.name, *arguments],
                              text=True, timeout=owsdtest.PATIENCE, capture_output=True)
    assert run("relay", "on").returncode == 0
    until(lambda: run("relay").stdout.startswith("relay\t1\tgood\t"), 10)
    assert len(run().stdout.splitlines()) == 3
    for arguments, status, said in ((("nobody",), 1, "no signal 'nobody'"), (("-x",), 2, "usage"),
                                    (("relay", "2"), 1, "relay: a bool cannot hold '2'")):
        done = run(*arguments)
        assert done.returncode == status and said in done.stderr, done
    daemon.name = "nobody-there"
    assert run().stderr == "no owsd of the name nobody-there runs\n", run()


def test_the_example_follows_changes_in_an_asyncio_loop(scene):
    daemon, signals = start(scene)
    example = scene.start([sys.executable, SOURCE / "docs/examples/follow.py", daemon.name],
                          {"PYTHONPATH": str(owsdtest.PYTHON)})
    with signals:
        until(lambda: "relay" in example.log(), 10, example.log)
        signals.set("relay", 1)
        until(lambda: "relay True, good" in example.log(), 10, example.log)
        daemon.signal(1)
        until(lambda: "reload" in daemon.log(), 10, daemon.log)
        until(signals.stale, 10)
        until(lambda: reopened(signals), 10)
        signals.set("title", "again")
        until(lambda: "title again, good" in example.log(), 10, example.log)
    assert example.running()


def reopened(signals):
    try:
        signals.reopen()
        return True
    except ows.NotRunning:
        return False


if __name__ == "__main__":
    owsdtest.main()
