#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Clients of others at one owsd-modbus, all at once, while the wire is disturbed and the configuration
changes: none ever reads a wrong value, and no address moves. JUDGE_SECONDS is how long, a minute if
it is not set."""

import json
import os
import random
import shutil
import subprocess
import sys
import time

import clients
import owsdtest
from modbushouse import GOOD, Client, item, serve
from owsdtest import SOURCE, free_port, raw, until

SECONDS = float(os.environ.get("JUDGE_SECONDS", 60))
HERE = SOURCE / "tests/system/modbus"
PACKAGES = ("pymodbus==3.16.1", "umodbus==1.0.4")
ROOMS = [21.5, -3.5, 19.0, 55.5, 4.0, -20.5]
SENSORS = [f"28.A0B1C200001{i}" for i in range(len(ROOMS))]
SWITCH, RELAYS = "29.A0B1C2000020", 5
WIRE = "chip DS2482-100 0x18\n" + "".join(
    f"DS18B20 {sensor} as s{i} resolution 9 temperature {number}\n"
    for i, (sensor, number) in enumerate(zip(SENSORS, ROOMS))) + f"""DS2408 {SWITCH} as board
at 3s every 11s corrupt s0 chance 0.5 for 4s
at 4s every 13s unplug s1 for 3s
at 5s every 7s brownout s2
at 6s every 17s short 0x18 for 2s
at 7s every 19s unplug board for 2s
at 8s corrupt s3 each 5
"""


def text(scene, port, order):
    """The signals in an order of the moment, with others between them that come and go."""
    wire = scene.file("judges.sim", WIRE)
    items = [item(f"room{i}", f"/{sensor}/temperature9", Uncached=raw("on")) for i, sensor in enumerate(SENSORS)]
    items.append(item("relays", f"/{SWITCH}/PIO.BYTE", "byte", "output", InitValue=RELAYS))
    if order:
        items += [item(f"guest{order.randrange(5)}", f"/{SENSORS[0]}/templow"),
                  item(f"guest{5 + order.randrange(5)}", f"/{SENSORS[1]}/temphigh")]
        order.shuffle(items)
        for i, one in enumerate(items):
            one["Name"] += f"_{order.randrange(3)}" if i % 2 else ""
    return owsdtest.rio(f"sim:{wire}", items, Period=0.05, Timeout=3, Modbus=raw(f'{{ Listen "127.0.0.1:{port}" }}'))


def libmodbus(scene):
    """The program of client.c."""
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "libmodbus"], check=False, capture_output=True, text=True)
    if flags.returncode or not shutil.which("cc"):
        return None
    program = scene.path / "client"
    subprocess.run(["cc", "-O1", "-o", program, HERE / "client.c", *flags.stdout.split()], check=True, timeout=120)
    return program


def has(python, module):
    return bool(shutil.which(python)) and subprocess.run([python, "-c", f"import {module}"], check=False,
                                                         capture_output=True).returncode == 0


def judges(scene):
    """name -> [python, library, program]: those that can be had."""
    found = {}
    if shutil.which("mbpoll"):
        found["mbpoll"] = [sys.executable, "mbpoll"]
    if has("/usr/bin/python3", "pymodbus.client"):
        found["pymodbus of the distribution"] = ["/usr/bin/python3", "pymodbus"]
    program = libmodbus(scene)
    if program:
        found["libmodbus"] = [sys.executable, "libmodbus", program]
    if not found:
        owsdtest.skip("no client of Modbus here (packages mbpoll, python3-pymodbus, libmodbus-dev)")
    python = clients.environment("modbus-judges", PACKAGES) / "python"
    return {**found, "pymodbus": [python, "pymodbus"], "umodbus": [python, "umodbus"]}


def test_no_judge_reads_a_wrong_value_and_no_address_moves(scene):
    port, order = free_port(), random.Random(1)
    daemon = scene.owsd(text(scene, port, None))
    face = serve(scene, daemon)
    expected = [*ROOMS, RELAYS]
    with Client(port) as plc:
        for place in range(1, len(expected) + 1):
            plc.becomes(place, GOOD)
    running = {name: scene.start([python, HERE / "judge.py", library, port, SECONDS, json.dumps(expected), *program])
               for name, (python, library, *program) in judges(scene).items()}

    def wrong():
        return [f"{name}: {judge.log()[-2000:]}" for name, judge in running.items()
                if not judge.running() and judge.wait() != 0]
    begun, reloads = time.monotonic(), 0
    while any(judge.running() for judge in running.values()):
        assert time.monotonic() - begun < SECONDS + 60, "they end in time"
        assert not wrong(), wrong()
        if time.monotonic() - begun > 5 * (reloads + 1):
            reloads += 1
            daemon.config.write_text(text(scene, port, order))
            if reloads % 4 == 0:
                daemon.kill()
                daemon = scene.owsd(daemon.config, name=daemon.name)
            else:
                done = scene.owsctl(daemon, "reload", "-w", owsdtest.PATIENCE)
                assert done.returncode == 0, done
        time.sleep(0.2)  # a look
    assert not wrong(), wrong()
    assert reloads >= 4, "owsd was started again"
    for name, judge in running.items():
        counts = json.loads(judge.log().splitlines()[-1])
        print(f"{name}: {counts}")
        assert counts["good"] > 100 and counts["bad"] > 10, (name, counts)
    until(lambda: face.running(), 1, face.log)
    assert face.stop() == 0


if __name__ == "__main__":
    owsdtest.main()
