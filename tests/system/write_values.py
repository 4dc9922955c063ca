# SPDX-License-Identifier: MIT
"""What compare_writes.py writes to a property: legal values of its type, and of some chips those of
their data sheets; then what is none. A value is (bytes, offset)."""

import re

# Writes that change what other properties do, or that cannot be taken back: before and after them
# both servers get a new device
DISTURBS = {"lock", "memory", "pages/page", "mission/running", "mission/easystart", "command",
            "clock/running", "eeprom/erase", "control", "branch", "set_password/enabled",
            "enter_firmware_update", "exit_firmware_update", "hub/branch", "readonly/memory",
            "readonly/clock", "readonly/interval", "readonly/cycle", "PIO", "power", "out_of_testmode"}
# Legal values where those of the type are none
NUMBERS = {
    "wiper": "10 200", "tempres": "10 11", "errata/trim": "100 101", "frequency": "5 10",
    "set_alarm": "1 0", "mission/frequency": "5 10", "mission/easystart": "5",
    "udate": "1000000000 1000000060", "clock/udate": "1000000000 1000000060",
    "trigger/udate": "1100000000 1100000060", "readonly": "0 1", "itime": "4 64",
    "interval": "1 3", "user": "3 5", "ControlRegister": "12", "set_alarm/alarm_function": "1 0",
}
BY_FAMILY = {
    ("29", "set_alarm"): "133333333 111111111", ("12", "set_alarm"): "321 0",
    ("1C", "set_alarm"): "133 211", ("04", "set_alarm"): "10 111",
    ("05", "PIO"): "1 0", ("10", "temphigh"): "35 36", ("1F", "control"): "2 3",
    ("FC", "911/serial/baud_divisor"): "26 52", ("ED", "set_switch_type"): "1,2,3 0,1,2",
    ("29", "LCD_H/screenyx"): "1,1:compare",
    ("21", "alarm_dow"): "1 5", ("21", "alarm_state"): "1 0", ("27", "interval"): "1 3",
    ("26", "offset"): "8 16", ("A6", "offset"): "8 16", ("2E", "timer"): "10 20",
    ("35", "alarm_set"): "0.5 1", ("FF", "register"): "65 66", ("FF", "data"): "65 66",
}
INFERNO = {"rgbw_channel": "10,20,30,40,0 1,2,3,4,0", "relay_port": "1,0,1 0,1,1",
           "led_port": "1,0,1 0,1,1", "relay_mode": "2,1 0,1", "relay_timeout": "20,30 40,50"}
FLOATS = {
    "vbias": "0.0001 -0.0001", "currentbias": "0.0005 -0.0005", "vis_offset": "0.00001 0.00002",
    "B1-R1-A/gain": "10 20", "B1-R1-A/offset": "300 400", "volthours": "0.001 0.002",
    "amphours": "0.05 0.1",
    **{f"EDS008{n}/threshold/current_{end}": "0.01 0.02" for n in (0, 3) for end in ("hi", "low")},
}
DATES = "Sun Sep  9 01:46:40 2001,Mon Sep 10 02:00:00 2001"
EPROM = {"09", "0B", "0F", "12", "89", "8B", "8F"}
ADJACENT = 12  # of what is beside a property that can only be written so much is read


def targets(row, elements):
    """The elements that are written."""
    names = elements(row)
    if len(names) > 3 and row.array != "-" and not row.array.endswith("sparse"):
        plain = [n for n in names if n not in (".ALL", ".BYTE")]
        names = plain[:1] + plain[-1:] + [n for n in names if n in (".ALL", ".BYTE")]
    if row.family in EPROM and row.type == "b":
        names = names[:1]
    if row.type == "b":
        names = [n for n in names if n != ".ALL"] or names
    return [row.property + n for n in names]


def count_of(row):
    return int(row.array.split(":")[0]) if row.array[0].isdigit() else 1


def texts(row):
    """Legal texts for one element."""
    given = BY_FAMILY.get((row.family, row.property), NUMBERS.get(row.property))
    if row.family == "ED" and given is None:
        given = INFERNO.get(row.property.rstrip("0123456789"))
    if given is None and row.type in "fp":
        given = FLOATS.get(row.property)
    if given is not None:
        return given.split()
    kind = row.type
    if kind == "d":
        return DATES.split(",")
    return {"y": ["1", "0"], "u": ["1", "2"], "i": ["7", "3"], "f": ["1.5", "2.25"],
            "t": ["21", "-5"], "g": ["1.5", "-2"], "p": ["900", "1010.5"],
            "a": ["compare", "x"]}[kind]


def legal(row, name, size):
    if row.type == "b":
        if row.property == "LCD_H/redefchar_hex":
            return [(b"0102030405060708", 0)]
        whole = bytes((7 * i + 1) % 251 for i in range(min(size, 8)))
        return [(whole, 0)] + ([(b"\xa5\x5a\x3c", 3)] if size >= 6 and row.access == "rw" else [])
    values = texts(row)
    if name.endswith(".ALL"):
        n = count_of(row)
        values = [",".join(values[(i + k) % len(values)] for i in range(n)) for k in range(2)]
    elif name.endswith(".BYTE"):
        values = ["1", "2"]
    return [(v.encode(), 0) for v in values]


def illegal(row, name, size):
    """[(what is wrong with it, value)]"""
    if name.endswith((".ALL", ".BYTE")) or name.rpartition(".")[2] not in ("0", "A") and \
            "." in name:
        return []
    if row.type == "b":
        return [("nothing", (b"", 0)), ("too long", (b"\x55" * min(size + 4, 600), 0)),
                ("behind the end", (b"\x55", size))] if size <= 512 else [("nothing", (b"", 0))]
    if row.type == "a":
        return [("nothing", (b"", 0)), ("too long", (b"x" * (size + 10), 0))]
    if row.type == "y":
        return [("nothing", (b"", 0)), ("another type", (b"abc", 0)), ("range", (b"2", 0))]
    if row.type == "d":
        return [("nothing", (b"", 0)), ("another type", (b"abc", 0))]
    far = {"u": ["-1", "4294967296"], "i": ["-99999", "4294967296"]}.get(row.type, ["1e9", "nan"])
    return [("nothing", (b"", 0)), ("another type", (b"abc", 0))] + \
        [("range", (v.encode(), 0)) for v in far]


def values(row, name, size):
    """[(what is wrong with it, or "", (bytes, offset))]"""
    found = [("", v) for v in legal(row, name, size)]
    # An EPROM takes 12 V, which neither has, and owserver tries for long
    if row.family in EPROM and row.type == "b":
        return found[:1]
    return found + illegal(row, name, size)


def witnesses(row, rows, elements):
    """What can be read beside a property that can only be written."""
    above = row.property.rpartition("/")[0]
    found = [r for r in rows if "r" in r.access and r.property.rpartition("/")[0] == above
             and r.property not in COMMON and r.family == row.family]
    pages = [r for r in rows if r.property == "pages/page"]
    return [r.property + elements(r)[0] for r in found[:ADJACENT] + pages
            if not re.search(r"type[A-Z]/|WS603|TAI8570|T8A", r.property)]


COMMON = set("address alias crc8 family id locator r_address r_id r_locator type present".split())
