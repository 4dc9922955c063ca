#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Odd paths: components and extensions doubled, slashes, branches of branches. owsd on a simulated
wire, and owsd with the genuine owserver as its target, answer as the genuine owserver does."""

import re

import owsdtest
import served
from owsdtest import until
from served import (ABSENT, ALIAS, BATTERY, DIRALL, DIRALLSLASH, GET, MEMORY, OWNET, PRESENT, READ,
                    SWITCH, THERMOMETER)

KINDS = {"READ": READ, "DIRALL": DIRALL, "PRESENT": PRESENT, "GET": GET, "DIRALLSLASH": DIRALLSLASH}
T = THERMOMETER
PLAIN = ("/", "/uncached", "/alarm", "/bus.0", "/bus.0/interface", "/bus.0/interface/settings",
         "/bus.0/interface/settings/name", "/settings", "/settings/units",
         "/settings/units/temperature_scale", "/settings/return_codes",
         "/settings/return_codes/text.1", "/statistics", "/statistics/read", "/system",
         "/system/process", "/system/process/pidfile", "/structure", "/structure/28",
         "/structure/28/type", "/structure/29/PIO.ALL", "/simultaneous", "/simultaneous/temperature",
         "/simultaneous/iblss", T, T + "/type", T + "/errata", T + "/errata/die", SWITCH + "/PIO.0",
         SWITCH + "/PIO.ALL", SWITCH + "/sensed.BYTE", MEMORY + "/pages", MEMORY + "/pages/page.1",
         BATTERY + "/HIH4000/humidity", "/uncached" + T + "/type", "/alarm" + T + "/type",
         "/bus.0" + T + "/type", "/uncached/alarm" + T + "/type", "/alarm/uncached" + T + "/type",
         "/bus.0/uncached" + T + "/type", "/uncached/bus.0" + T + "/type", "/bus.0/alarm",
         "/alarm/bus.0", "/uncached/bus.0", "/bus.0/uncached", ABSENT, ABSENT + "/type")
ODD = ("//", "///", "/bus.1", "/bus.00", "/bus.", "/bus.-1", "/bus.9999999999", "/alarm/settings",
       "/uncached/settings", "/bus.0/settings", "/bus.0/system", "/bus.0/statistics",
       "/bus.0/structure", "/bus.0/structure/28/type", "/bus.0/simultaneous", "/alarm/simultaneous",
       "/alarm/structure/28", "/uncached/simultaneous", "/interface", "/bus.0/interface/nonsense",
       "/type", "/28", "/28/temperature", "/structure/2", "/structure/ZZ", "/structure/28.67C6697351FF",
       "/structure/26/HIH4000", "/structure/26/HIH4000/", "/structure/29/PIO", "/structure/29/PIO.7",
       "/structure/29/PIO.8", T + T, T + T + "/type", T + "/type" + T, "/nonsense/")
# What stands in the place of a device is written in any case, what is behind it is not
ODD += tuple(path for word in ("Uncached", "BUS.0", "Alarm", "Text", "Uncached/Bus.0", "Bus.0/Alarm")
             for path in (f"/{word}", f"/{word}{T}/type", f"/{word}{T}/Type"))
ODD += ("/Settings", "/SETTINGS/units/temperature_scale", "/Settings/Units", "/Structure/28/type",
        "/Structure/28/Type", "/Structure/29", "/Statistics/read/calls", "/Statistics/Read",
        "/System/process/pid", "/System/Process", "/Simultaneous", "/Simultaneous/temperature",
        "/Simultaneous/Temperature", "/bus.0/Interface/settings/name", "/Settings/return_codes/text.1",
        "/Settings/Return_codes/text.1", "/Bus.0/Simultaneous", "/Interface", "/Alarm/29,12")
BEHIND = (".ALL", ".BYTE", ".0", ".A", ".ALL.ALL")
# Where the genuine owserver does not look at what stands behind: there is no such name here
LAX = re.compile(r"(^|/)(uncached|alarm|bus\.\d+|settings|system|statistics|structure|simultaneous|"
                 r"interface)\.\D|/(settings|simultaneous|statistics|structure|system|interface|alarm"
                 r"|uncached|bus\.0)\.0|/(text|PIO|sensed|page)\.\w+\.\w")


def paths():
    found = list(PLAIN + ODD)
    for path in PLAIN:
        parts = path.strip("/").split("/")
        if path == "/":
            continue
        for i in range(len(parts)):
            found.append("/" + "/".join(parts[:i + 1] + parts[i:]))
            found.append("/" + "/".join(parts[:i] + [""] + parts[i:]))
        found += [path + "/", path + "//", path + "/.", path + "/..", path + "/nonsense", path[1:]]
        found += [path + end for end in BEHIND]
    return list(dict.fromkeys(found))


def outcome(server, kind, path):
    """The error, or what is told of a device's presence."""
    frame = server.frame(kind, path, flags=OWNET | ALIAS)
    return frame.ret if frame.ret < 0 else frame.data if kind == PRESENT else 0


def compare(genuine, server, excused):
    wrong, all_paths = [], paths()
    assert len(all_paths) > 500
    for path in all_paths:
        for name, kind in KINDS.items():
            want, have = (outcome(s, kind, path) for s in (genuine, server))
            if have != want and not excused(path, kind, have):
                wrong.append(f"{name} {path}: {have}, not {want}")
    assert not wrong, "\n".join([str(len(wrong)), *wrong[:40]])


def test_odd_paths_on_a_wire_are_answered_as_by_the_genuine_owserver(scene):
    compare(served.owserver(scene), served.owsd(scene),
            lambda path, kind, have: LAX.search(path) and have == -1 or
            # a property is no directory, whether its device is there or not
            path.strip("/") == ABSENT.strip("/") + "/type" and have == -20)


def test_odd_paths_through_an_owserver_are_answered_as_by_itself(scene):
    genuine = served.owserver(scene)
    server = served.owsd_of(scene, genuine.target, items=[])
    until(lambda: server.has(served.DEVICES), 20, "its devices are there")
    # a property that a device has not is told by READ, not by PRESENT: no second request is made
    compare(genuine, server, lambda path, kind, have: LAX.search(path) or (
        kind == PRESENT and isinstance(have, bytes) and any(d in path for d in served.DEVICES)))


if __name__ == "__main__":
    owsdtest.main(at_once=2)
