#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What scripts for owserver have done for years, as owsd answers it from its first second on."""

import time

import clients
import owsdtest
import served
from owsdtest import until

WIRE = """i2c speed 400
chip DS2482-100 0x18
DS18B20 28.0000000000F5 temperature 20.5
DS18S20 10.0000000000F7 temperature 30
DS1822 22.0000000000F8 temperature 8
DS28EA00 42.0000000000F9 temperature 44
DS2450 20.0000000000FA volt.A 1.5
DS2409 1F.0000000000FB as coupler
branch coupler main
DS18B20 28.0000000000F6 temperature -3
DS2450 20.0000000000FC volt.A 2.5
"""
CHIPS = {"28.0000000000F5/latesttemp": 20.5, "10.0000000000F7/latesttemp": 30,
         "22.0000000000F8/latesttemp": 8, "42.0000000000F9/latesttemp": 44,
         "20.0000000000FA/latestvolt.A": 1.5, "28.0000000000F6/latesttemp": -3,
         "20.0000000000FC/latestvolt.A": 2.5}


def test_all_convert_a_second_passes_and_each_is_read_right_the_first_time(scene):
    server = served.owsd_of(scene, f"sim:{scene.file('habits.sim', WIRE)}", items="")
    branch = "/1F.0000000000FB/main"
    until(lambda: server.has(["/20.0000000000FA"]) and
          "/28.0000000000F6" in str(server.entries(branch)), 20, "all are found")
    shell = clients.Shell(scene, server)
    shell.write("/simultaneous/temperature", "1")
    shell.write("/simultaneous/voltage", "1")
    time.sleep(1)  # the script's own
    read = {path: float(shell.read(f"/uncached/{path}")) for path in CHIPS}
    assert {path: round(value, 2) for path, value in read.items()} == CHIPS


if __name__ == "__main__":
    owsdtest.main()
