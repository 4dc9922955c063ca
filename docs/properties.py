#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""properties.py: write docs/properties.md on the standard output, from

- what owserver states of each property (tests/unit/data/owfs-structure.tsv),
- what became of its text when owserver and owsd read the same simulated device
  (tests/unit/data/compared.tsv, which tests/system/compare.py makes and checks),
- what became of the values that both wrote to it
  (tests/unit/data/written.tsv, which tests/system/compare_writes.py makes and checks),
- what a user notices and no comparison shows (tests/unit/data/notes.tsv, made by hand),
- what the owsd of this build states of it, and offers of a slave of each driver of the kernel's.
"""

import collections
import pathlib
import re
import sys
import tempfile
import textwrap

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "tests/system"))
import compare  # noqa: E402
import compare_writes  # noqa: E402
import owsdtest  # noqa: E402
import served  # noqa: E402

WIDTH = 100
COUNTED = ("all", "same", "differs", "cannot be had", "not compared", "write-only")
PUT = ("writable", "written same", "written differs", "written not written")
REFUSED = "cannot be had: "
WRITE_ONLY = "can only be written"
SCRATCHPAD = "50 05 4b 46 7f ff 0c 10 1c : crc=1c YES\n50 05 4b 46 7f ff 0c 10 1c t=85000\n"
# The attributes by which owsd knows that a driver of the kernel's has a slave of this family
THERMOMETER = {"w1_slave": SCRATCHPAD, "ext_power": "1\n"}
SWITCH = {"state": "", "output": ""}
DRIVEN = {"10": THERMOMETER, "22": THERMOMETER, "28": THERMOMETER, "3B": THERMOMETER,
          "42": THERMOMETER, "05": SWITCH, "12": SWITCH, "3A": SWITCH,
          "29": dict.fromkeys("state output activity cond_search_mask cond_search_polarity "
                              "status_control".split(), ""),
          "14": {"eeprom": ""}, "1C": {"eeprom": ""}, "23": {"eeprom": ""},
          "2D": {"eeprom": ""}, "1D": {"w1_slave": ""}, "26": {"page0": "\x08@\x15d\x02 \x01\0", "page1": "\1\2\3\4\5\6\7\0"}}
MASTER = "w1_bus_master1"

INTRO = """# Properties, one by one

What is another property here than with owserver, for who leaves it. owserver 3.2p4 states {all} properties of
{families} families in its `/structure`. Each was asked for twice, of the genuine owserver (over a DS9097) and of owsd
(over a DS2482), with the same simulated chip, alone on its wire.

`make properties-page` writes this page, and a test compares it.

| word | means |
|---|---|
| same | the texts are equal, byte for byte. Running clocks may differ by {clock} s, as may the bytes of a page in which they are, and what a current adds up to by {volt:g} Vh or {amp:g} Ah: it begins with 0, so its scale is not seen here. An array of more than {short} elements is compared in its first four, the middle and the last |
| differs | a text is another, or one of the two has none |
| cannot be had | owsd refuses it, and will |
| not compared | there was no text of either, or no such part is simulated |
| write-only | it cannot be read |
| written same | both accepted the same values, and then read the same; of what can only be written, from what can be read beside it |
| written differs | one of the two refused a value, or read another one then |
| not written | owsd refuses it |

{writable} of them can be written: the same values, two or more of each element that was chosen, by owserver to one
chip and by owsd to another, and read back past the caches. What is no legal value was written too; where the two
differ there alone, the property counts as "written same", and the last section has it.

Type, access, size, array and life, as `/structure` has them, are those of owserver for {stated} of
the {all}. The others are limits of the EDS0080 to EDS0085 and two names, see family 7E.

All adapters that owsd drives have this alike. Target `w1` has what the kernel's drivers give: column "driver" counts
the listed properties that a driver's attributes stand for; see [w1.md](w1.md#what-there-is). A driver's readings were
not compared here.
"""


def build_states(rows):
    """The rows whose type, access, size, array and life this build states as owserver does."""
    raw = {}
    with open(compare.DATA / "owfs-structure.tsv", encoding="utf-8") as file:
        for line in list(file)[1:]:
            columns = line.rstrip("\n").split("\t")
            raw[columns[0], columns[1]] = columns[8]
    part, device, line = compare.devices()[0]
    server = compare.Server(False, line)
    try:
        server.wait_for(device)
        good = set()
        for row in rows:
            element = compare.elements(row)[0] if row.array != "-" else ""
            if row.array.startswith("sparse"):
                element = ".A" if "letters" in row.array else ".0"
            text, _ = server.text(f"/structure/{row.family}/{row.property}{element}")
            if text is not None and text.decode() == raw[row.family, row.property]:
                good.add((row.family, row.property))
        return good
    finally:
        server.end()


def kernel_gives():
    """{family: the properties that are listed of a slave with that family's driver}"""
    given = {}
    with tempfile.TemporaryDirectory(prefix="owsd-w1-") as place:
        root = pathlib.Path(place)
        (root / MASTER).mkdir()
        (root / MASTER / "uevent").write_text("")
        for number, (family, files) in enumerate(DRIVEN.items(), 1):
            name = f"{family.lower()}-{number:012x}"
            slave = root / MASTER / name
            slave.mkdir()
            for file, text in {"name": name, **files}.items():
                (slave / file).write_text(text)
            (root / name).symlink_to(f"{MASTER}/{name}")
        server = compare.Server(False, "", target=f"w1:root={root}")
        try:
            owsdtest.until(lambda: len(devices_of(server)) == len(DRIVEN), 30, "all are listed")
            for device in devices_of(server):
                given[device[:2]] = server.listed(f"/{device}")
        finally:
            server.end()
    return given


def devices_of(server):
    try:
        frame = server.frame(served.DIRALL, "/")
    except (OSError, served.Closed):
        return []
    return re.findall(r"(?<=/)[0-9A-F]{2}\.[0-9A-F]{12}(?=[,\0]|$)", frame.data.decode())


def together(found, number):
    """Names that differ in one number, or in the letter of a type, as one."""
    groups = collections.OrderedDict()
    for name in found:
        match = re.fullmatch(number, name)
        groups.setdefault((match[1], match[3]) if match else name, []).append(match[2] if match else None)
    for key, parts in groups.items():
        if isinstance(key, str):
            yield key
        elif len(parts) < 3:
            yield from (key[0] + part + key[1] for part in parts)
        elif [p for p in parts if not p.isdecimal()] or \
                list(map(int, parts)) != list(range(int(parts[0]), int(parts[0]) + len(parts))):
            yield f"{key[0]}{{{','.join(parts)}}}{key[1]}"
        else:
            yield f"{key[0]}{parts[0]}..{parts[-1]}{key[1]}"


def names(found):
    """Many names as a text: those that differ in a number are one."""
    for number in (r"(.*?)(\d+)()", r"(subkey|EDS00)(\d+)(/.*)", r"(type)([A-Z])(/.*)"):
        found = list(together(found, number))
    return ", ".join(f"`{n.strip()}`" for n in found)


def item(text):
    return textwrap.fill(text, WIDTH, initial_indent="- ", subsequent_indent="  ",
                         break_long_words=False, break_on_hyphens=False)


def verdict_of(record):
    verdict, _, reason = record
    return "cannot be had" if reason.startswith(REFUSED) else \
        "write-only" if reason == WRITE_ONLY else verdict


def by_reason(records):
    """{(reason, names): verdicts} of one family: what is not the same, read or written."""
    by, joined = collections.OrderedDict(), collections.OrderedDict()
    for verdict, name, reason in records:
        if verdict not in ("same", "written same", "write-only"):
            by.setdefault((verdict, reason), []).append(name)
    for (verdict, reason), found in by.items():
        joined.setdefault((reason, tuple(found)), []).append(verdict)
    return joined


def section(family, chip, by, marks, missing):
    """A family: what is not the same of it, by reasons, and what a driver of the kernel's does not give."""
    said = {}
    for (reason, found), verdicts in by.items():
        said.setdefault(reason, []).append(f"{names(found)}: {', '.join(verdicts)}")
    lines = [item("; ".join(parts) + (f" ({marks[reason]})" if reason in marks else f". {reason if reason.startswith('ow') else reason[:1].upper() + reason[1:]}"))
             for reason, parts in said.items()]
    lines += [item(f"Not of the kernel's driver: {names(missing)}")] if missing else []
    return [f"**{family}** ({chip})", "", *lines, ""] if lines else []


def notes():
    """[(families, note)]"""
    with open(compare.DATA / "notes.tsv", encoding="utf-8") as file:
        return [line.rstrip("\n").split("\t") for line in list(file)[1:]]


def others(written):
    """[a line of each way in which what is no legal value differs]"""
    by = collections.OrderedDict()
    for (family, name), line in written.items():
        for other in line.others.split(", ") if line.verdict == "same" != line.others else ():
            by.setdefault(other, collections.OrderedDict()).setdefault(family, []).append(name)
    return [item(f"**{other}**: {compare_writes.OTHERS[other]} ("
                 f"{sum(map(len, of.values()))} properties of {len(of)} families)")
            for other, of in sorted(by.items())]


def row_of(cells):
    return "| " + " | ".join(str(c or "") for c in cells) + " |"


def chips():
    """{family: its usual chip}, of the one list of them."""
    text = (SOURCE / "hal/chips/families.h").read_text()
    return {code.upper(): chip for code, chip in re.findall(r"FAMILY\((\w\w)\) /\* (.*?) \*/", text)}


def page():
    recorded, written = compare.recorded(), compare_writes.recorded()
    rows = [r for r in compare.structure() if r.family not in compare.NO_DEVICE]
    stated, given, chip = build_states(rows), kernel_gives(), chips()
    families = sorted({r.family for r in rows})
    sums = collections.Counter()
    table, alike, reasons, lacks = [], [], {}, {}
    for family in families:
        mine = [(r, recorded[r.family, r.property]) for r in rows if r.family == family]
        count = collections.Counter(verdict_of(record) for _, record in mine)
        puts = [(name, line) for (of, name), line in written.items() if of == family]
        count.update({"all": len(mine), "writable": len(puts)})
        count.update("written " + line.verdict for _, line in puts)
        listed = [r.property for r, _ in mine if r.visibility == "always"]
        lacks[family] = [p for p in listed if p not in given[family]] if family in given else []
        if family in given:
            count["given"], count["missing"] = len(listed) - len(lacks[family]), len(lacks[family])
        sums.update(count)
        if count["all"] == count["same"] and count["writable"] == count["written same"] and not lacks[family]:
            alike.append(f"{family} ({chip.get(family, '')})")
        else:
            table.append(row_of([family, chip.get(family, "")] + [
                of and f"{part}/{of}" for part, of in (
                    (count["same"], count["all"] - count["write-only"]), (count["written same"], count["writable"]),
                    (count["given"], count["given"] + count["missing"]))]))
        reasons[family] = by_reason(
            [(verdict_of(record), r.property, record[2].removeprefix(REFUSED)) for r, record in mine] +
            [(line.verdict if line.verdict == "not written" else f"written {line.verdict}", name, line.reason)
             for name, line in puts])
    shared = collections.Counter(reason for by in reasons.values() for reason in dict.fromkeys(r for r, _ in by))
    common = [reason for reason, n in shared.items() if n > 1]
    marks = {reason: chr(ord("a") + n) if n < 26 else f"a{chr(ord('a') + n - 26)}" for n, reason in enumerate(common)}
    below = [line for family in families for line in
             section(family, chip.get(family, ""), reasons[family], marks, lacks[family])]
    intro = INTRO.format(all=sums["all"], writable=len(written), families=len(families), stated=len(stated),
                         clock=compare.CLOCK_S, short=compare.SHORT,
                         volt=compare.SUMS["volthours"], amp=compare.SUMS["amphours"])
    return "\n".join([
        "\n\n".join(p if p[0] in "#|" else fill(p) for p in intro.strip().split("\n\n")), "",
        "## What a user notices", "",
        fill("What no comparison shows. The reasons of each property are further [below](#family-by-family)."),
        "", *[item(f"**{of}**: {note}") for of, note in notes()], "",
        "## How many", "",
        fill(", ".join(f"{sums[k]} {k}" for k in COUNTED[1:]) + "; of those that can be written " +
             ", ".join(f"{sums[k]} {k.removeprefix('written ')}" for k in PUT[1:]) + "."), "",
        "| | chip | read the same | written the same | driver |",
        "|---|---|---|---|---|", *table, "",
        fill(f"All is the same, read and written: {', '.join(alike)}."), "",
        "## Family by family", "",
        fill("What is not read, or not written, the same, and why. A letter stands for a reason that more "
             "than one family has. Target `w1` does not list what the driver of the kernel's does not "
             "give; over `w1:netlink` it is there."), "",
        *[item(f"({mark}) {reason}") for reason, mark in marks.items()], "",
        *below,
        "## What is no legal value", "",
        fill("Only what differs. owsd refuses what it cannot take as it is: a number that means "
             "something else, cut or wrapped, would be a false value in the chip."), "",
        *others(written)]) + "\n"


def fill(text):
    """A paragraph, or a list, with lines of WIDTH columns."""
    if text.startswith("- "):
        return "\n".join(item(" ".join(part.split())) for part in re.split(r"^- ", text, flags=re.M)[1:])
    return textwrap.fill(" ".join(text.split()), WIDTH, break_long_words=False,
                         break_on_hyphens=False)


if __name__ == "__main__":
    sys.stdout.write(page())
