#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""devices.py: write docs/devices.md on the standard output, from the tables of the chip families
(tests/system/families.c prints them), of owserver's /structure (tests/unit/data/owfs-structure.tsv)
and of the kernel's drivers (hal/w1). `make devices-page` writes it into its place.
"""

import collections
import math
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("OWSD_BUILD", SOURCE / "build"))
STRUCTURE = SOURCE / "tests/unit/data/owfs-structure.tsv"
READ, WRITE = 1, 2
LATCH, STAYS, CLEARS, POR = 1, 2, 4, 8
PLACES = 12  # what a row names at most; the others are counted

Property = collections.namedtuple(
    "Property", "name type access hidden least most decimals unit alarm holds size")

INTRO = """# The chips

{count} families of chips, and any I2C sensor [behind a DS28E17 (19) or DS28E18 (56)](bridges.md).
`make devices-page` writes this page from the tables of the program, and a test compares them.

- **No real chip was at hand.** Each was simulated bit by bit ([tested.md](tested.md)).
- **What it has** are the signals that `owsctl scan --rio` makes. `owsctl dir /ID` lists all
  properties, [properties.md](properties.md) compares them with owserver's.
- **The range** is what a chip can measure, with the error that its data sheet allows. A number
  outside is never a good value.
- **Read back**: owsd notices when the chip does not do what was written.
- **Alarm**: the chip takes part in the [alarm search](alarms.md). The names are the properties for
  `LatchAlarm` (*stays*: until `ResetLatch`) and `PorAlarm`.
- **Ways**: all adapters that owsd drives itself (`i2c:`, `usb:`, `serial:`, `uart:`,
  `w1:netlink`); with a star also the files of a driver of [the kernel](w1.md). An owserver knows
  all codes of this page but: {missing}.
"""


def families():
    """The families as families.c prints them: dictionaries."""
    said = subprocess.run([BUILD / "system/families"], check=True, capture_output=True, text=True).stdout
    found = []
    for line in said.splitlines():
        what, *rest = line.split("\t")
        if what == "family":
            code, chip, alarms, several = rest
            found.append(dict(code=code, type=chip, alarms=alarms == "1", several=several == "1", kinds=[],
                              scan=[], properties={}, simulated=[]))
        elif what == "kind":
            found[-1]["kinds"].append(rest[1])
        elif what == "scan":
            found[-1]["scan"].append(rest)
        elif what == "simulated":
            found[-1]["simulated"].append(rest[0])
        else:
            row = Property(rest[0], rest[1], int(rest[2]), rest[3] == "1", float(rest[4]), float(rest[5]),
                           int(rest[6]), rest[7], int(rest[8]), rest[9] == "1", int(rest[10]))
            found[-1]["properties"][row.name] = row
    return found


def usual():
    """{code: the chips}, of the one list of families."""
    text = (SOURCE / "hal/chips/families.h").read_text()
    return {code.upper(): chip for code, chip in re.findall(r"FAMILY\((\w\w)\) /\* (.*?) \*/", text)}


def driven():
    """The families that target w1 serves by a driver's own files."""
    text = "".join((SOURCE / f"hal/w1/{name}.c").read_text() for name in ("thermometer", "switches", "driver"))
    return {code.upper() for code in re.findall(r"(?:\.family = |DRIVER\(|EEPROM\()0x(\w\w)", text)}


def row_of(family, name):
    """The property that a scan's row names."""
    return family["properties"].get(re.split(r"\.(?=[^./]+$)", name)[0])


def number(x):
    return (f"{x:.0f}" if abs(x) >= 1000 else f"{x:.4g}").replace("-", "\u2212")


def measured(row):
    """"-55 to 125 C", or the unit alone, or nothing."""
    unit = row.unit or {"t": "\u00b0C", "p": "mbar", "g": "K"}.get(row.type, "")
    if row.least >= row.most or math.isinf(row.least):
        return unit
    if not unit and row.least == 0 and row.most >= 65535:
        return "counts"
    return f"{number(row.least)} {unit} and more" if math.isinf(row.most) else \
        f"{number(row.least)} to {number(row.most)} {unit}".strip()


def has(family):
    """What a scan makes signals of, those with one range together; else what the chip is for."""
    groups = collections.OrderedDict()
    for name, _ in family["scan"][:PLACES]:
        row = row_of(family, name)
        back = ""
        if row and row.access & WRITE and row.type in "yB":
            back = "output, read back" if row.holds else "output"
        groups.setdefault(", ".join(filter(None, [row and measured(row), back])), []).append(f"`{name}`")
    found = [", ".join(names) + (f" ({what})" if what else "") for what, names in groups.items()]
    more = len(family["scan"]) - PLACES
    if more > 0:
        found.append(f"{more} more")
    memory = family["properties"].get("memory")
    if memory:
        found.append(f"memory of {memory.size} bytes")
    if "date" in family["properties"]:
        found.append("clock")
    if not found:
        names = [p.name for p in family["properties"].values() if not p.hidden and p.type != "D" and p.access]
        found = ["properties as " + ", ".join(f"`{n}`" for n in names[:4])] if names else ["its id"]
    return "; ".join(found)


def alarm(family):
    """The latches, of each group whether they stay, and the power-on flags."""
    groups = collections.OrderedDict()
    for p in family["properties"].values():
        if p.alarm & LATCH and not p.hidden:
            groups.setdefault(" (stays)" if p.alarm & STAYS else "", []).append(p.name)
    por = [f"`{p.name}`" for p in family["properties"].values() if p.alarm & POR]
    return ", ".join([latches(names) + stays for stays, names in groups.items()] + por) or \
        ("yes" if family["alarms"] else "")


def latches(names):
    """Many of several chips by the chips' common name."""
    if len(names) > PLACES:
        names = dict.fromkeys(re.sub(r"^([A-Z]+)\d+/", r"\1*/", name) for name in names)
        folders = collections.OrderedDict()
        for folder, last in (name.rsplit("/", 1) for name in names):
            folders.setdefault(folder, []).append(last)
        names = [f"{folder}/{{{','.join(last)}}}" if len(last) > 1 else f"{folder}/{last[0]}"
                 for folder, last in folders.items()]
    return ", ".join(f"`{name}`" for name in names)


def line(cells):
    return "| " + " | ".join(cells) + " |"


def page():
    served = {row.split("\t")[0] for row in STRUCTURE.read_text().splitlines()[1:]}
    w1, names, found = driven(), usual(), families()
    assert all(family["simulated"] for family in found), "the page says that each was simulated"
    missing = [f["code"] for f in found if f["code"] not in served]
    out = [INTRO.format(count=len(found), missing=", ".join(missing)),
           line(["code", "chip", "what it has", "alarm"]), "|---|---|---|---|"]
    for family in found:
        code, chips = family["code"], names.get(family["code"], family["type"])
        others = [c for c in dict.fromkeys(family["kinds"] + family["simulated"])
                  if re.fullmatch(r"[A-Z]+\d\w*", c)]
        others = [c for c in others if c not in chips and code != "7E"]
        out.append(line([code + "*" * (code in w1), ", ".join([chips, *others]), has(family), alarm(family)]))
    return "\n".join([*out, ""])


if __name__ == "__main__":
    sys.stdout.write(page())
