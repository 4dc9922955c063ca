#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine owserver and owsd are asked for all of /structure, /settings and /statistics.

Both list the directories, from the roots down, and say of each entry what READ, DIRALL, DIRALLSLASH
and PRESENT answer. In /statistics numbers are compared by their form, because they differ in each
run. tests/unit/data/compared-virtual.tsv has what is not the same: a path, a "*" in which is any
text, and why. The reasons are written by hand.

    compare_virtual.py            says what differs and is not recorded there, and what is there and
                                  does not differ
    compare_virtual.py --show     ... and every answer that differs
"""

import collections
import fnmatch
import re
import sys

import owsdtest
import served

RECORDED = owsdtest.SOURCE / "tests/unit/data/compared-virtual.tsv"
ROOTS = ("/structure", "/settings", "/statistics")
KINDS = {"READ": served.READ, "DIRALL": served.DIRALL, "DIRALLSLASH": served.DIRALLSLASH,
         "PRESENT": served.PRESENT}
NUMBER = re.compile(rb" *[\d.]+(E[+-]\d+)?( *,|$)")

Pair = collections.namedtuple("Pair", "path kind theirs ours")


def entries(data):
    return [e.decode() for e in data.rstrip(b"\0").split(b",") if e]


def answer(s, kind, path):
    """What is compared of an answer. All requests go over one connection."""
    s.sendall(served.request(kind, path, flags=served.USUAL | served.PERSIST))
    frame = served.receive(s)
    if frame.ret < 0 or kind == served.PRESENT:
        return frame.ret
    if kind == served.READ and path.startswith("/statistics/"):
        return ["number" if NUMBER.fullmatch(part) else part
                for part in re.findall(rb"[^,]*,?", frame.data)[:-1]]
    return frame.data if kind == served.READ else entries(frame.data)


def walk(genuine, ours):
    """[Pair] of all that either of them lists, and how many answers that are."""
    pairs, queue, asked = [], list(ROOTS), 0
    with genuine.connect() as a, ours.connect() as b:
        while queue:
            path, lists = queue.pop(), set()
            for name, kind in KINDS.items():
                both = answer(a, kind, path), answer(b, kind, path)
                asked += 1
                if both[0] != both[1]:
                    pairs.append(Pair(path, name, *both))
                if name == "DIRALL":
                    lists.update(*(found for found in both if isinstance(found, list)))
            queue += sorted(lists, reverse=True)
    return pairs, asked


def recorded():
    """{path: reason}"""
    with open(RECORDED, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file][1:]
    assert all(len(row) == 2 and row[1] for row in rows), "a path and a reason each"
    return dict(rows)


def is_recorded(pair, paths):
    """Its path is there, or it is a list of which only entries differ that are there."""
    if any(fnmatch.fnmatchcase(pair.path, path) for path in paths):
        return True
    if not all(isinstance(found, list) for found in pair[2:]) or pair.kind == "READ":
        return False
    rest = [[e for e in found if not any(fnmatch.fnmatchcase(e.rstrip("/"), p) for p in paths)]
            for found in pair[2:]]
    return rest[0] == rest[1]


def run(scene):
    return walk(served.owserver(scene), served.owsd(scene))


def unused(pairs, paths):
    """What is recorded and does not differ."""
    return [path for path in paths if not any(fnmatch.fnmatchcase(p.path, path) for p in pairs)]


def show(pair):
    theirs, ours = pair.theirs, pair.ours
    if isinstance(theirs, list) and isinstance(ours, list) and pair.kind != "READ":
        theirs, ours = ([e for e in x if e not in y] or "the rest in this order"
                        for x, y in ((theirs, ours), (ours, theirs)))
    print(f"  {pair.kind} {pair.path}: owserver {str(theirs)[:300]}, owsd {str(ours)[:300]}")


def main():
    with owsdtest.Scene() as scene:
        pairs, asked = run(scene)
    paths = recorded()
    fresh = [p for p in pairs if not is_recorded(p, paths)]
    for pair in pairs if "--show" in sys.argv else fresh:
        show(pair)
    for path in unused(pairs, paths):
        print(f"  {path}: recorded, and does not differ")
    print({"asked": asked, "differ": len(pairs), "not recorded": len(fresh)})


if __name__ == "__main__":
    main()
