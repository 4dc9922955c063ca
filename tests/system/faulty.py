# SPDX-License-Identifier: MIT
"""Faults of the machine for owsd and owsctl: a library before theirs, a small house that is served.

    faulty.env(scene, memory="17")        the 17th allocation fails; other faults: preload/faults.c
    faulty.house(scene)                   a configuration over simulated chips
"""

import contextlib
import json
import os
import struct
import subprocess

import owsdtest
from owsdtest import raw

LIBRARY = owsdtest.BUILD / "system" / "faults.so"
WIRE = """chip DS2482-100 0x18
DS18B20 28.A0B1C2000001 as room temperature 21.5 resolution 9
DS2408 29.A0B1C2000004 as board
"""
MORE = "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000002 temperature 19.5 resolution 9\n"
ROOM = dict(Name="room", Path="/28.A0B1C2000001/temperature9", Type=raw("double"), IO=raw("input"),
            Uncached=raw("on"))
HALL = dict(Name="hall", Path="/28.A0B1C2000002/temperature9", Type=raw("double"), IO=raw("input"),
            Uncached=raw("on"))
RELAYS = dict(Name="relays", Path="/29.A0B1C2000004/PIO.BYTE", Type=raw("byte"), IO=raw("output"))


def house(scene, more=False, **driver):
    """The text of a configuration; more: a second target, with the signal hall."""
    wire = scene.file("house.sim", WIRE)
    target = f"sim:{wire}"
    items = [ROOM, RELAYS]
    if more:
        target += f", sim:{scene.file('more.sim', MORE)}"
        items.append(HALL)
    return owsdtest.rio(target, items, Period=0.05, MaxRetries=1, Timeout=5, **driver)


def not_sanitized(why):
    """A sanitizer is a part of the program that these tests are not about."""
    program = owsdtest.OWSD.read_bytes()
    if b"__asan_init" in program or b"__tsan_init" in program:
        owsdtest.skip(why)


def env(scene, **faults):
    owsdtest.need(LIBRARY)
    not_sanitized("the sanitizer has a library of its own before the program's")
    if "memory" in faults and b"__gcov_" in owsdtest.OWSD.read_bytes():
        owsdtest.skip("what counts coverage takes memory itself, and looks not whether it has any")
    mark = scene.path / "mark"
    return {"LD_PRELOAD": str(LIBRARY), "FAULT_MARK": str(mark),
            **{f"FAULT_{name.upper()}": str(value) for name, value in faults.items()}}


def happened(scene):
    """Since the last call."""
    mark = scene.path / "mark"
    try:
        mark.unlink()
    except FileNotFoundError:
        return False
    return True


class Clock:
    """How far CLOCK_REALTIME and CLOCK_BOOTTIME are ahead, for all that got its env(), and whether the
    clock is synchronised; None: as it is."""

    def __init__(self, scene, name="clock"):
        self.path = scene.path / name
        self.path.write_bytes(bytes(24))

    def env(self, scene, **faults):
        return env(scene, clock=self.path, **faults)

    def jump(self, wall=0.0, boot=0.0, synchronised=None):
        now = struct.unpack("qqq", self.path.read_bytes())
        with open(self.path, "r+b", buffering=0) as file:
            file.write(struct.pack("qqq", now[0] + int(wall * 1e9), now[1] + int(boot * 1e9),
                                   now[2] if synchronised is None else 1 + synchronised))


class Traced(owsdtest.Owsd):
    """owsd as the child of strace; signals go to owsd itself."""

    @classmethod
    def start(cls, scene, config, prefix, *options):
        return cls(scene, config, scene.name(), options, None, prefix)

    def signal(self, number):
        with open(f"/proc/{self.pid}/task/{self.pid}/children", encoding="ascii") as file:
            children = file.read().split()
        if children:
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(children[0]), number)


def stop_all_of(daemon):
    """freeze(), and return when no thread of it runs any more."""
    daemon.freeze()

    def stopped():
        tasks = os.listdir(f"/proc/{daemon.pid}/task")
        return all(owsdtest.state_of(daemon.pid, task) == "T" for task in tasks)
    owsdtest.until(stopped, 10, "all its threads stop")


def ctl(scene, daemon, environment, *arguments):
    """owsctl under the same faults."""
    return subprocess.run([str(owsdtest.OWSCTL), "-n", daemon.name, *arguments], text=True,
                          timeout=owsdtest.PATIENCE, cwd=scene.path, stdin=subprocess.DEVNULL,
                          capture_output=True, env=dict(os.environ, **environment))


def leftovers(name):
    """What stands in the place under this name, without it."""
    return sorted(path.name.removeprefix(f"{name}.") for path in owsdtest.place().glob(f"{name}.*"))


def counters(scene, daemon):
    """Of owsd itself."""
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return {c["name"]: c["value"] for c in stats["counters"] if c["target"] is None}
