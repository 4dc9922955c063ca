#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl scan of more devices than any plant has."""

import owsdtest
import peer


def test_a_scan_of_ten_thousand_devices_makes_a_configuration_of_all_of_them(scene):
    devices = [f"/28.{n:012X}" for n in range(10000)]
    values = {}
    for device in devices:
        values.update({device + "/type": "DS18B20", device + "/alias": "",
                       device + "/temperature12": "        21.5"})
    with peer.Peer(values) as server:
        # a program under the thread sanitizer on a busy machine takes minutes
        done = scene.owsctl(None, "-t", server.target, "scan", "--rio", seconds=300)
        assert done.returncode == 0, done
        table = scene.owsctl(None, "-t", server.target, "scan", seconds=300).stdout.splitlines()
    assert len(table) == 10001 and all("temperature12=21.5" in line for line in table[1:])
    file = scene.file("many.rio", done.stdout)
    checked = scene.owsd_once("--check", "-c", file, seconds=300)
    assert checked.returncode == 0, checked
    for n, device in ((1, devices[0]), (10000, devices[-1])):
        assert f'"temperature{n}"\n    Path                    "{device}/temperature12"' in done.stdout
    assert done.stdout.count("  Item {") == 10000


if __name__ == "__main__":
    owsdtest.main()
