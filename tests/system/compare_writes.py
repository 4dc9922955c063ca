#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine owserver and owsd write the same values to every property of every simulated device
that can be written, and what became of them is compared: was it accepted, and what is read then?

Both begin with the same device, alone on its wire (compare.py), and write the same in the same
order. As soon as they differ, both begin again with a new device. What is read after each write,
past the caches, is the property itself; of one that can only be written it is what can be read
beside it (WITNESSES). Behind the legal values come those that are none: nothing, another type, out
of range, too long.

The verdicts are in tests/unit/data/written.tsv, a line for each property: "same", "differs" or "not
written" (owsd refuses every legal value), the number of legal values that were written, what
differed of the others ("same": nothing; "-": the property is not the same, so neither are they), and
why. The reasons are written by hand; the rest is this
program's:

    compare_writes.py                    says what differs from that file
    compare_writes.py --show             ... and every answer that is not the same
    compare_writes.py PART...            both, of these parts
    compare_writes.py --write [PART...]  writes the file, or the lines of the families of these
                                         parts; the reasons stay
"""

import collections
import concurrent.futures
import re
import struct
import sys
import time

import compare
import owsdtest
import served
from write_values import DISTURBS, targets, values, witnesses

WRITTEN = compare.DATA / "written.tsv"
COLUMNS = ("family", "property", "verdict", "values", "others", "reason")
# What is wrong with a value that is no legal one, and what the two make of it
OTHERS = {
    "another type": "one of the two takes a text that is no number",
    "behind the end": "one of the two says that it wrote bytes behind the end of a memory; neither did",
    "nothing": "one of the two takes an empty text for a value",
    "range": "owserver writes another number in place of one that is out of range: the bits that fit "
             "(-1 is 65535, 4294967296 is 0), 0 of a limit that is none (1e9, nan), 1 of a 2 that shall "
             "be yes or no; owsd refuses it (-EINVAL), and the chip keeps what it had",
    "too long": "one of the two cuts what is too long, the other refuses it",
}
SECONDS = 25  # for one write
NO_ANSWER = f"no answer in {SECONDS} s"
LONG = 512  # of a longer memory its first page is read

Line = collections.namedtuple("Line", COLUMNS[2:])


class Pair:
    """The same device behind owserver and behind owsd."""

    def __init__(self, part, device, line):
        self.part, self.device, self.line = part, device, line
        self.servers, self.begun = (), 0

    def begin(self):
        self.end()
        self.begun += 1
        self.servers = [compare.Server(genuine, self.line) for genuine in (True, False)]
        for server in self.servers:
            server.wait_for(self.device)
        # Which of several chips with this family it is, both learn at the first request
        for row in [r for r in rows_of(self.device[:2], None) if r.visibility == "always"
                    and r.property not in compare.COMMON and "w" not in r.access][:2]:
            self.both(lambda s, n=row.property + compare.elements(row)[0]: read(s, self.device, n))

    def listed(self):
        return set.intersection(*(s.listed(f"/{self.device}") for s in self.servers))

    def both(self, ask):
        if len(self.servers) != 2:
            self.begin()
        return [ask(server) for server in self.servers]

    def ended(self, errors):
        """Has a write ended one of them, or does it never end? Both happen to owserver."""
        return NO_ANSWER in errors or any(s.started[-1].poll() is not None for s in self.servers)

    def end(self):
        for server in self.servers:
            server.end()
        self.servers = ()


def read(server, device, name):
    """(text, error)"""
    return server.text(f"/uncached/{device}/{name}")


def result(s):
    """What a write returns. Some never end in owserver, which says so each second."""
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        _, payload, ret, *_ = struct.unpack(">6i", served.exactly(s, 24))
        if payload >= 0:
            return ret
    raise TimeoutError(NO_ANSWER)


def put(server, device, name, value):
    """"" or the error."""
    data, offset = value
    try:
        with served.Server(None, "127.0.0.1", server.port, None).connect(SECONDS) as s:
            s.sendall(served.request(served.WRITE, f"/{device}/{name}", data=data, offset=offset))
            ret = result(s)
    except (OSError, served.Closed) as why:
        return str(why)
    return "" if ret >= 0 else str(ret)


def structure():
    """{row of owserver's structure: its size}"""
    sizes = {}
    with open(compare.DATA / "owfs-structure.tsv", encoding="utf-8") as file:
        for line in list(file)[1:]:
            columns = line.rstrip("\n").split("\t")
            if columns[2] != "D":
                row = compare.Row(*columns[:5], columns[7])
                sizes[row] = int(re.match(r"\d+", columns[5])[0])
    return sizes


SIZES = structure()


def rows_of(family, writable=True):
    """The rows of a family; writable None: all."""
    return [r for r in SIZES if r.family == family
            and (writable is None or ("w" in r.access) == writable)]


class Outcome:
    """What became of the values of one property."""

    def __init__(self):
        self.values = self.bad = self.refused = 0
        self.others, self.seen = set(), []

    def add(self, other, same, refused, seen):
        if other:
            if not same:
                self.others.add(other)
        else:
            self.values += 1
            self.bad += not same
            self.refused += refused
        if not same or refused:
            self.seen.append(seen)

    def join(self, outcome):
        self.values += outcome.values
        self.bad += outcome.bad
        self.refused += outcome.refused
        self.others |= outcome.others
        self.seen += outcome.seen

    def line(self, reason=""):
        verdict = "same" if self.values else "not written"
        if self.values and self.refused == self.values:
            verdict = "not written"
        elif self.bad:
            verdict = "differs"
        others = ", ".join(sorted(self.others)) or "same"
        others = others if verdict == "same" else "-"
        return Line(verdict, self.values, others, "" if verdict == "same" else reason)


def seen_after(pair, row, name, beside):
    """What both read once the property was written: [(name, text or error) ...] of each. beside: what
    is read of one that cannot be read itself."""
    names = [name]
    if row.access != "rw":
        names = beside
    elif row.property == "memory" and SIZES[row] > LONG:
        names = ["pages/page.0"]
    return pair.both(lambda s: [(n, *read(s, pair.device, n)) for n in names])


def alike(family, theirs, ours):
    for (name, a, a_err), (_, b, b_err) in zip(theirs, ours):
        if a is None or b is None:
            if a is not b:
                return False
        elif not compare.same(family, name, a, b) and not (
                name.endswith("date") and an_hour_off(a, b)):
            return False
    return True


def an_hour_off(a, b):
    """owserver leaves to chance whether a date that it is given is one of summer time."""
    a, b = compare.seconds(a), compare.seconds(b)
    return None not in (a, b) and 3600 <= b - a <= 3600 + compare.CLOCK_S


def read_beside(pair, row):
    """The properties beside one that can only be written, of which both read the same before."""
    names = witnesses(row, rows_of(row.family, None), compare.elements)
    theirs, ours = pair.both(lambda s: [(n, *read(s, pair.device, n)) for n in names])
    return [a[0] for a, b in zip(theirs, ours) if a[1] is not None and alike(row.family, [a], [b])]


def one_value(pair, row, name, value, other, outcome, beside):
    """True: both are as they were, or the same happened to them. They begin anew after what ended one."""
    errors = pair.both(lambda s: put(s, pair.device, name, value))
    if pair.ended(errors):
        pair.begin()
        outcome.add(other, False, bool(errors[1]), (pair.part, name, value, other, errors, [], []))
        return True
    theirs, ours = seen_after(pair, row, name, beside)
    same = bool(errors[0]) == bool(errors[1]) and alike(row.family, theirs, ours)
    outcome.add(other, same, bool(errors[1]),
                (pair.part, name, value, other, errors, [t[1:] for t in theirs[:3]],
                 [o[1:] for o in ours[:3]]))
    if pair.ended(errors):
        pair.begin()
        return True
    return same


def alike_again(pair, row, name, beside):
    """What was no legal value has left them different: does a legal one make them alike?"""
    legal = values(row, name, SIZES[row])[0][1]
    return one_value(pair, row, name, legal, "", Outcome(), beside)


def walk(part, device, line):
    """{row: Outcome} of a part."""
    pair, found = Pair(part, device, line), {}
    try:
        pair.begin()
        listed = pair.listed()
        for row in rows_of(device[:2]):
            above = row.property.rpartition("/")[0]
            hidden = row.visibility in ("always", "hidden") and (not above or above in listed)
            if row.property in compare.COMMON or row.property not in listed and not hidden:
                continue
            outcome = found[row] = Outcome()
            if (part, row.property) in DISTURBS or row.property in DISTURBS:
                pair.begin()
            beside = read_beside(pair, row) if row.access == "wo" else []
            for name in targets(row, compare.elements):
                for other, value in values(row, name, SIZES[row]):
                    same = one_value(pair, row, name, value, other, outcome, beside)
                    if not same and not (other and alike_again(pair, row, name, beside)):
                        pair.begin()
            if (part, row.property) in DISTURBS or row.property in DISTURBS:
                pair.begin()
        return found
    finally:
        pair.end()


def run(parts=()):
    """{(family, property): Outcome}"""
    outcomes = collections.defaultdict(Outcome)
    with concurrent.futures.ThreadPoolExecutor(compare.AT_ONCE) as pool:
        jobs = [pool.submit(walk, *device) for device in compare.devices()
                if not parts or device[0] in parts]
        for job in concurrent.futures.as_completed(jobs):
            for row, outcome in job.result().items():
                outcomes[row.family, row.property].join(outcome)
                if "--show" in sys.argv:
                    show(outcome)
    return outcomes


def keys(parts=()):
    """All that owserver states as writable, of the families of these parts."""
    families = compare.families_of(parts)
    return [(r.family, r.property) for r in SIZES if "w" in r.access and r.family in families
            and r.property not in compare.COMMON]


def recorded():
    """{(family, property): Line}"""
    if not WRITTEN.exists():
        return {}
    with open(WRITTEN, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file][1:]
    assert all(len(r) == len(COLUMNS) for r in rows), "six columns each"
    return {(r[0], r[1]): Line(r[2], int(r[3]), r[4], r[5]) for r in rows}


def lines_of(outcomes, old, parts=()):
    """Of the families of the parts what was found, of the others what the file said."""
    families, lines = compare.families_of(parts), {}
    for key in keys():
        was = old.get(key)
        if key[0] in families:
            lines[key] = outcomes.get(key, Outcome()).line(was.reason if was else "")
        elif was:
            lines[key] = was
    return lines


def show(outcome):
    for part, name, value, other, errors, theirs, ours in outcome.seen:
        print(f"  {part} {name} {other} <- {str(value[0])[:40]}"
              f"{f' at {value[1]}' if value[1] else ''}: owserver {errors[0] or 'ok'}, "
              f"{str(theirs)[:70]}; owsd {errors[1] or 'ok'}, {str(ours)[:70]}", flush=True)


def main():
    parts = [a for a in sys.argv[1:] if not a.startswith("--")]
    unknown = set(parts) - {part for part, _, _ in compare.devices()}
    if unknown:
        sys.exit(f"not in {compare.DEVICES.name}: {' '.join(sorted(unknown))}")
    began = time.monotonic()
    outcomes, old = run(compare.whole(parts)), recorded()
    lines = lines_of(outcomes, old, parts)
    for key in keys(parts):
        was = old.get(key)
        changed = not was or was[:3] != lines[key][:3]
        if "--write" not in sys.argv and changed:
            print(*key, "recorded", was and was[:3], "now", lines[key][:3])
        if "--show" not in sys.argv and (parts or changed and "--write" not in sys.argv):
            show(outcomes[key])
    if "--write" in sys.argv:
        with open(WRITTEN, "w", encoding="utf-8") as file:
            print(*COLUMNS, sep="\t", file=file)
            for key, line in lines.items():
                print(*key, *line, sep="\t", file=file)
    print(dict(collections.Counter(lines[key].verdict for key in keys(parts))),
          f"{time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
