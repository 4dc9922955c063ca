#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The reader in Go, which was written from docs/shared-memory.md alone, sees what owsctl sees."""

import json
import os
import re
import shutil
import signal
import subprocess

import owsdtest
from owsdtest import raw

import ows  # of owsdtest.PYTHON

EXAMPLES = owsdtest.SOURCE / "docs/examples"
SENSOR, COUNTER, SWITCH = "/28.A0B1C2000001", "/1D.A0B1C2000002", "/29.A0B1C2000003"
NUMBERS = ("byte", "short", "long", "word", "dword", "large")


def item(name, path, kind, **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw("input"), **more)


EVERY_TYPE = [item("bool", SWITCH + "/sensed.3", "bool"), item("float", SENSOR + "/temperature", "float"),
              item("double", SENSOR + "/temperature", "double"), item("string", SENSOR + "/type", "string"),
              *(item(kind, COUNTER + "/counters.A", kind) for kind in NUMBERS),
              item("nobody", "/28.A0B1C2000009/temperature", "double"),
              dict(Name="relays", Path=SWITCH + "/PIO.BYTE", Type=raw("byte"), IO=raw("output"))]


def reader(scene):
    """The program, built by this machine's Go."""
    go = shutil.which("go") or shutil.which("/usr/local/go/bin/go")
    if not go:
        owsdtest.skip("there is no go")
    version = subprocess.run([go, "env", "GOVERSION"], capture_output=True, text=True, timeout=60).stdout
    numbers = re.match(r"go(\d+)\.(\d+)", version)
    if not numbers or tuple(map(int, numbers.groups())) < (1, 21):
        owsdtest.skip(f"{version.strip() or 'this go'} is older than go1.21")
    program = scene.path / "reader"
    done = subprocess.run([go, "build", "-o", program, EXAMPLES / "reader.go", EXAMPLES / "reader_lists.go"],
                          cwd=scene.path, capture_output=True, text=True, timeout=500,
                          env={**os.environ, "CGO_ENABLED": "0", "GOTOOLCHAIN": "local",
                               "GOCACHE": os.environ.get("GOCACHE", str(owsdtest.BUILD.resolve() / "go"))})
    assert done.returncode == 0, done.stderr
    return program


def rio(scene, *items, **driver):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.0625\n"
                      "DS2423 1D.A0B1C2000002 count.A 77\nDS2408 29.A0B1C2000003\n")
    return owsdtest.rio(f"sim:{wire}", items, **{"Period": 0.05, **driver})


def read(program, name, *arguments):
    """What it prints, line by line, and each of the columns."""
    done = subprocess.run([program, "-n", name, *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return [line.split("\t") for line in done.stdout.splitlines()]


def by_owsctl(scene, daemon):
    """The same columns: name, type, value, quality, err."""
    rows = json.loads(scene.owsctl(daemon, "--json", "list").stdout)
    return {row["name"]: (row["type"], row["value"], row["quality_code"], row["err"]) for row in rows}


def by_go(lines):
    def value(kind, text):
        if kind in ("float", "double"):
            return float(text)
        return text if kind == "string" else text == "1" if kind == "bool" else int(text)
    return {name: (kind, value(kind, text) if int(changes) else None, int(quality, 16), int(err))
            for name, kind, text, quality, _, err, changes, _ in lines}


def test_it_reads_every_type_as_owsctl_does(scene):
    program = reader(scene)
    daemon = scene.owsd(rio(scene, *EVERY_TYPE))
    scene.until(lambda: all(scene.get(daemon, i["Name"]) for i in EVERY_TYPE[:-2]), 10, "values")
    scene.until(lambda: by_owsctl(scene, daemon)["nobody"][2] == 8, 10, "it is absent")
    there = by_owsctl(scene, daemon)
    assert by_go(read(program, daemon.name)) == there, (read(program, daemon.name), there)
    assert there["float"][1] == 21.0625 and there["large"][1] == 77 and there["string"][1] == "DS18B20"
    assert [line[0] for line in read(program, daemon.name, "word", "bool")] == ["word", "bool"]
    with ows.Ows(daemon.name) as signals:
        detail = signals.get("word").detail
    assert detail & ows.DETAIL_SIMULATED
    assert read(program, daemon.name, "word")[0][7] == str(detail)
    missing = subprocess.run([program, "-n", daemon.name, "none"], capture_output=True, timeout=60)
    assert missing.returncode == 1


def test_it_lists_targets_infos_and_alarms_as_ows_py_does(scene):
    program = reader(scene)
    daemon = scene.owsd(rio(scene, item("room", SENSOR + "/temperature", "double", LimitH=20, LimitHH=30)))
    with ows.Ows(daemon.name) as signals:
        scene.until(lambda: list(signals.alarms()), 10, "the alarm")
        alarm, target = list(signals.alarms())[0], list(signals.targets())[0]
    [line] = read(program, daemon.name, "-l", "alarms")
    assert line[:5] == ["0", "room", str(alarm.occurred_ns), "4", "1"], line
    [line] = read(program, daemon.name, "-l", "targets")
    assert line == [target.name, "1", str(target.reconnects), str(target.group), str(target.moves)], line
    [line] = read(program, daemon.name, "-l", "info")
    assert line[0] == "room" and line[2] == SENSOR + "/temperature", line
    counters = {(name, int(target)) for name, target, _ in read(program, daemon.name, "-l", "counters")}
    assert ("transactions", 0) in counters or any(target == 0 for _, target in counters), counters


def test_it_follows_owsd_over_a_reload(scene):
    program = reader(scene)
    daemon = scene.owsd(rio(scene, EVERY_TYPE[2]))
    scene.until(lambda: scene.get(daemon, "double"), 10, "a value")
    following = scene.start([program, "-n", daemon.name, "-f", "600"])
    scene.until(lambda: "\ndouble\tdouble\t21.0625\t0xc0" in following.log(), 10, following.log)
    newer = scene.file("newer.rio", rio(scene, EVERY_TYPE[2], EVERY_TYPE[3]))
    os.replace(newer, daemon.config)
    daemon.signal(signal.SIGHUP)
    scene.until(lambda: "# another image\n" in following.log(), 10, following.log)
    after = following.log().partition("# another image\n")[2]
    assert "dead" not in after, after
    scene.until(lambda: "string\tstring\tDS18B20\t0xc0" in "\n".join(
        map("\t".join, read(program, daemon.name))), 10, "the new signal")
    scene.until(lambda: "\nstring\tstring\t" in following.log(), 10, following.log)


def test_values_of_a_killed_owsd_turn_bad_and_those_of_the_next_are_read(scene):
    program = reader(scene)
    config = rio(scene, EVERY_TYPE[2])
    daemon = scene.owsd(config)
    scene.until(lambda: scene.get(daemon, "double"), 10, "a value")
    following = scene.start([program, "-n", daemon.name, "-f", "600"])
    scene.until(lambda: "0xc0" in following.log(), 10, following.log)
    daemon.kill()
    scene.until(lambda: re.search("# owsd is dead\ndouble\tdouble\t21.0625\t0x1a", following.log()), 10,
                following.log)
    assert by_go(read(program, daemon.name))["double"] == by_owsctl(scene, daemon)["double"]
    scene.owsd(config, name=daemon.name)
    scene.until(lambda: re.search("# another image\n(.*\n)*double\tdouble\t", following.log()), 10,
                following.log)
    scene.until(lambda: "# owsd lives" in following.log().rpartition("# owsd is dead")[2], 10, following.log)
    again = "double\tdouble\t21.0625\t0xc0"
    scene.until(lambda: again in following.log().rpartition("# owsd lives")[2], 10, following.log)


def test_it_refuses_another_layout(scene):
    program = reader(scene)
    daemon = scene.owsd(rio(scene, EVERY_TYPE[2]))
    place = owsdtest.place()
    image = bytearray((place / f"{daemon.name}.image").read_bytes())
    for at, byte in ((0, 1), (4, 1), (8, 1), (29, 255), (257, 9)):
        broken = bytearray(image)
        broken[at] ^= byte
        other = scene.name()
        (place / f"{other}.image").write_bytes(broken)
        done = subprocess.run([program, "-n", other], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stdout) == (1, ""), (at, done)


if __name__ == "__main__":
    owsdtest.main()
