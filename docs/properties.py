#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""properties.py: write docs/properties.md on the standard output, from

- what owserver states of each property (tests/unit/data/owfs-structure.tsv),
- what became of its text when owserver and owsd read the same simulated device
  (tests/unit/data/compared.tsv, which tests/system/compare.py makes and checks),
- what became of the values that both wrote to it
  (tests/unit/data/written.tsv, which tests/system/compare_writes.py makes and checks),
- what a user notices and no comparison shows (tests/unit/data/notes.tsv, made by hand),
- what the owsd of this build states of it.
"""

import collections
import pathlib
import re
import sys
import textwrap

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "tests/system"))
import compare  # noqa: E402
import compare_writes  # noqa: E402

WIDTH = 100
COUNTED = ("all", "same", "differs", "cannot be had", "not compared", "write-only")
PUT = ("writable", "written same", "written differs", "written not written")
REFUSED = "cannot be had: "
WRITE_ONLY = "can only be written"
OWSERVER_FAILS = re.compile(r"owserver (fails|cannot|shows an empty|refuses|reads back, and fails|takes a page for good only|sends the command that reads, and fails)|"
                            r"to (read|write) it ends owserver")
MANY = 10  # names that differ in a number, and are shown as one with a star
INTRO = """# Properties, one by one

What differs from owserver, for who leaves it. owserver 3.2p4 states {all} properties of {families} families in its
`/structure`. Genuine owserver (over a DS9097) and owsd (over a DS2482) were asked for each, twice, with the same
simulated chip alone on its wire. All adapters of owsd have this alike, but for [the kernel's
drivers](w1.md#what-there-is). `make properties-page` writes this page.

- **same**: the texts are equal, byte for byte. Running clocks may differ by {clock} s, what a current adds up to by
  {volt:g} Vh or {amp:g} Ah. An array of more than {short} elements is compared in its first four, the middle and the
  last.
- **differs**: a text is another, or one of the two has none.
- **cannot be had**: owsd refuses it, and will.
- **not compared**: neither had a text, or no such part is simulated.
- **written same**: both accepted the same values, and then read the same. Illegal values do not count.
- **written differs**: one of the two refused a value, or read another one then.
- **not written**: owsd refuses it.

{writable} can be written. Type, access, size, array and life in `/structure` are those of owserver for {stated} of the
{all}.

Not listed below: what was not compared, and where owserver fails or shows an empty text and owsd does not
(`tests/unit/data/compared.tsv` and `written.tsv` have these too).
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


def together(found, number):
    """Names that differ in one number, or in the letter of a type, as one."""
    groups = collections.OrderedDict()
    for name in found:
        match = re.fullmatch(number, name)
        groups.setdefault((match[1], match[3]) if match else name, []).append(match[2] if match else None)
    for key, parts in groups.items():
        if isinstance(key, str):
            yield key
            continue
        parts.sort(key=lambda part: (len(part), part))
        if len(parts) < 2:
            yield key[0] + parts[0] + key[1]
        elif [p for p in parts if not p.isdecimal()] or int(parts[-1]) - int(parts[0]) >= len(parts):
            yield f"{key[0]}{{{','.join(parts)}}}{key[1]}" if len(parts) < MANY else f"{key[0]}*{key[1]}"
        else:
            yield f"{key[0]}{parts[0]}..{parts[-1]}{key[1]}"


def in_folders(found):
    """Names of one folder as one, as long as it fits into a line."""
    folders = collections.OrderedDict()
    for name in found:
        folder, slash, last = name.rpartition("/")
        line = folders.setdefault(folder + slash if slash else name, [[]])
        if len(folder) + sum(len(n) + 1 for n in line[-1]) + len(last) > WIDTH - 20:
            line.append([])
        line[-1].append(last)
    for folder, lines in folders.items():
        for last in lines:
            yield folder.removesuffix(last[0]) + (f"{{{','.join(last)}}}" if len(last) > 1 else last[0])


def names(found):
    """Many names as a text: those that differ in a number, or are of one folder, are one."""
    for number in (r"(.*?)(\d+)()", r"(subkey|EDS00)(\d+)(/.*)", r"(type)([A-Z])(/.*)"):
        found = list(together(found, number))
    found = list(in_folders(n.strip() for n in found))
    return ", ".join(f"`{n}`" for n in found)


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
        if verdict not in ("same", "written same", "write-only", "not compared") and not OWSERVER_FAILS.match(reason):
            by.setdefault((reason, name), []).append(verdict)
    for (reason, name), verdicts in by.items():
        joined.setdefault((reason, tuple(verdicts)), []).append(name)
    return {(reason, tuple(found)): verdicts for (reason, verdicts), found in joined.items()}


def section(family, chip, by, marks):
    """A family: what is not the same, by reasons; the shared ones by their letters."""
    said = {}
    for (reason, found), verdicts in by.items():
        if reason not in marks:
            said.setdefault(reason, []).append(f"{names(found)}: {', '.join(verdicts)}")
    shared = ", ".join(sorted({marks[reason] for reason, _ in by if reason in marks}))
    lines = [item("; ".join(parts) + f". {reason if reason.startswith('ow') else reason[:1].upper() + reason[1:]}")
             for reason, parts in said.items()]
    return [f"**{family}** {chip}{shared and f': {shared}'}", "", *lines, *[""] * bool(lines)]


def shared_reason(mark, reason, of):
    """A reason of several families: what is not the same by it, of which."""
    groups = collections.OrderedDict()
    for family, found, verdicts in of:
        groups.setdefault((names(found), ", ".join(verdicts)), []).append(family)
    words = collections.OrderedDict()
    for (found, verdicts), families in groups.items():
        words.setdefault(verdicts, []).append(f"{found} of {' '.join(families)}")
    return item(f"({mark}) " + "; ".join(f"{', '.join(found)}: {verdicts}" for verdicts, found in words.items()) +
                f". {reason if reason.startswith('ow') else reason[:1].upper() + reason[1:]}")


def notes():
    """[(families, note)]"""
    with open(compare.DATA / "notes.tsv", encoding="utf-8") as file:
        return [line.rstrip("\n").split("\t") for line in list(file)[1:]]


def others(written):
    """[a line of each way in which what is no legal value differs]"""
    ways = {other for line in written.values() if line.verdict == "same" != line.others
            for other in line.others.split(", ")}
    return [item(f"**{other}**: {compare_writes.OTHERS[other]}") for other in sorted(ways)]


def chips():
    """{family: its usual chip}, of the one list of them."""
    text = (SOURCE / "hal/chips/families.h").read_text()
    return {code.upper(): chip for code, chip in re.findall(r"FAMILY\((\w\w)\) /\* (.*?) \*/", text)}


def page():
    recorded, written = compare.recorded(), compare_writes.recorded()
    rows = [r for r in compare.structure() if r.family not in compare.NO_DEVICE]
    stated, chip = build_states(rows), chips()
    families = sorted({r.family for r in rows})
    sums = collections.Counter()
    alike, reasons = [], {}
    for family in families:
        mine = [(r, recorded[r.family, r.property]) for r in rows if r.family == family]
        count = collections.Counter(verdict_of(record) for _, record in mine)
        puts = [(name, line) for (of, name), line in written.items() if of == family]
        count.update({"all": len(mine), "writable": len(puts)})
        count.update("written " + line.verdict for _, line in puts)
        sums.update(count)
        if count["all"] == count["same"] and count["writable"] == count["written same"]:
            alike.append(f"{family} ({chip.get(family, '')})")
        reasons[family] = by_reason(
            [(verdict_of(record), r.property, record[2].removeprefix(REFUSED)) for r, record in mine] +
            [(line.verdict if line.verdict == "not written" else f"written {line.verdict}", name, line.reason)
             for name, line in puts])
    shared = collections.Counter(reason for by in reasons.values() for reason in dict.fromkeys(r for r, _ in by))
    common = [reason for reason, n in shared.items() if n > 1]
    marks = {reason: chr(ord("a") + n) for n, reason in enumerate(common)}
    of = {reason: [(family, found, verdicts) for family in families for (other, found), verdicts in
                   reasons[family].items() if other == reason] for reason in common}
    below = [line for family in families if reasons[family] for line in
             section(family, chip.get(family, ""), reasons[family], marks)]
    intro = INTRO.format(all=sums["all"], writable=len(written), families=len(families), stated=len(stated),
                         clock=compare.CLOCK_S, short=compare.SHORT,
                         volt=compare.SUMS["volthours"], amp=compare.SUMS["amphours"])
    return "\n".join([
        "\n\n".join(p if p[0] in "#|" else fill(p) for p in intro.strip().split("\n\n")), "",
        "## What a user notices", "",
        fill("What no comparison shows:"),
        "", *[item(f"**{of}**: {note}") for of, note in notes()], "",
        "## How many", "",
        fill(", ".join(f"{sums[k]} {k}" for k in COUNTED[1:]) + "; of those that can be written " +
             ", ".join(f"{sums[k]} {k.removeprefix('written ')}" for k in PUT[1:]) + "."), "",
        fill(f"All is the same, read and written: {', '.join(alike)}."), "",
        "## Family by family", "",
        fill("What is not the same, and why. A family that is missing here differs only in what this page leaves out. "
             "A letter stands for a reason of several families:"), "",
        *[shared_reason(mark, reason, of[reason]) for reason, mark in marks.items()], "",
        *below,
        "## What is no legal value", "",
        fill('Where the two differ in these values alone, the property counts as "written same":'), "",
        *others(written)]) + "\n"


def fill(text):
    """A paragraph, or a list, with lines of WIDTH columns."""
    if text.startswith("- "):
        return "\n".join(item(" ".join(part.split())) for part in re.split(r"^- ", text, flags=re.M)[1:])
    return textwrap.fill(" ".join(text.split()), WIDTH, break_long_words=False,
                         break_on_hyphens=False)


if __name__ == "__main__":
    sys.stdout.write(page())
