#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine owserver and owsd read every property of every simulated device, and their texts are
compared.

owserver reaches the device by a serial port (serial.c), owsd directly; each device of
compare/devices.sim is alone on a wire of its own, new for each of the two. Both are asked for the
same paths in the same order: what owserver's /structure states (tests/unit/data/owfs-structure.tsv),
of an array every element, or the first four, the middle one and the last if it has more than 16.

The verdicts are in tests/unit/data/compared.tsv, a line for each property: "same", "differs" or "not
compared", the number of texts that were compared, and, where it is not "same", why. The reasons are
written by hand; the rest is this program's:

    compare.py                    says what differs from that file
    compare.py --show             ... and every text that is not the same
    compare.py PART...            both, of these parts
    compare.py --write [PART...]  writes the file, or the lines of the families of these parts; the
                                  reasons stay
"""

import collections
import concurrent.futures
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import owsdtest
import served

DATA = owsdtest.SOURCE / "tests/unit/data"
DEVICES = owsdtest.SOURCE / "tests/system/compare/devices.sim"
COMPARED = DATA / "compared.tsv"
COLUMNS = ("family", "property", "verdict", "texts", "reason")
NO_DEVICE = {"simultaneous", "thermostat"}  # of /structure, but of no chip
SHORT = 16        # of a longer array some elements are read
WHOLE = 256       # of a longer one ALL is not read
SECONDS = 100     # for one read
AT_ONCE = 6

# Reads that end owserver 3.2p4
KILLS = {("DS2404", "memory"), ("DS2404", "pages/page")}
# A read of all bytes takes more than a minute (owserver cannot read a DS1977), or gives no more than
# another one
LONG = {("DS1977", "memory"), ("DS1996", "pages/page.ALL")}
# The elements of arrays without a bound: the text behind the dot
SPARSE = {"extension_characters": ["abc"], "is_index_prime": ["7", "8"],
          "911/automation_engine/global_memory": ["0", "1"]}
PASSWORD = ["0102030405060708"]
LAST_RESULT = {"20", "FE"}
COMMON = set("address alias crc8 family id locator r_address r_id r_locator type".split())
# What a current adds up to between the two, in Vh and Ah
SUMS = {"volthours": 1e-4, "amphours": 4e-3}
# Clocks go on between the two
CLOCK_S = 100
CLOCKS = re.compile(r"(^|/)(u?date|clock|counter/(seconds|samples))(\.\w+)?$")
BYTES_RUN = set("04 1E 21 26 2E 30 32 35 36 3D 41 51 7E A6 FC".split())
BYTES = re.compile(r"(^|/)(memory|pages/page)(\.\w+)?$")

Row = collections.namedtuple("Row", "family property type array access visibility")


def structure(name="owfs-structure.tsv"):
    """The properties that owserver states, without its directories."""
    with open(DATA / name, encoding="utf-8") as file:
        rows = [Row(*(r[:2] + [r[2], r[3], r[4], r[7]]))
                for r in csv.reader(file, delimiter="\t", quoting=csv.QUOTE_NONE)][1:]
    return [r for r in rows if r.type != "D"]


def devices():
    """(part, id, line) of each."""
    lines = [line for line in DEVICES.read_text().splitlines() if line and line[0] != "#"]
    return [(*line.split()[:2], line) for line in lines]


def elements(row):
    if row.array == "-":
        return [""]
    count, index, kind = row.array.split(":")
    if kind == "sparse":
        return [f".{e}" for e in SPARSE.get(row.property, PASSWORD)]
    names = [chr(ord("A") + i) if index == "letters" else str(i) for i in range(int(count))]
    if len(names) > SHORT:
        names = names[:4] + [names[len(names) // 2], names[-1]]
    names += ["ALL"] if int(count) <= WHOLE else []
    names += ["BYTE"] if row.type == "y" and kind == "aggregate" else []
    return [f".{n}" for n in names]


class Server:
    """One device behind owserver or owsd."""

    def __init__(self, genuine, line, target=None):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="compare-"))
        self.port = owsdtest.free_port()
        self.log = open(self.place / "log", "w", encoding="utf-8")
        self.started = []
        scenario = self.place / "one.sim"
        scenario.write_text(f"i2c speed 1000 combine any\nchip DS2482-100 0x18\n{line}\n")
        where = f"127.0.0.1:{self.port}"
        if genuine:
            serial = self.start(owsdtest.BUILD / "system/serial", scenario, stdout=subprocess.PIPE)
            name = serial.stdout.readline().strip()
            self.start("owserver", f"--passive={name}", "-p", where, "--foreground")
        else:
            target = target or f"sim:{scenario}"
            self.start(owsdtest.with_sim(owsdtest.OWSD, target), "-t", target, "-l", where, "-n", f"c{self.port}")

    def start(self, *command, stdout=None):
        program = subprocess.Popen([str(c) for c in command], stdin=subprocess.DEVNULL,
                                   stdout=stdout or self.log, stderr=self.log, text=True,
                                   env=dict(os.environ, OWS_DIR=str(self.place), TZ="UTC"))
        self.started.append(program)
        return program

    def frame(self, kind, path):
        server = served.Server(None, "127.0.0.1", self.port, None)
        with server.connect(SECONDS) as s:
            s.sendall(served.request(kind, path))
            return served.receive(s)

    def wait_for(self, device):
        def listed():
            try:
                return device in self.frame(served.DIRALL, "/").data.decode()
            except (OSError, served.Closed):
                return False
        owsdtest.until(listed, 30, lambda: f"{device} is listed:\n{(self.place / 'log').read_text()}")

    def text(self, path):
        """None and the reason where there is no text."""
        try:
            frame = self.frame(served.READ, path)
        except (OSError, served.Closed) as why:
            return None, str(why)
        return (frame.data, "") if frame.ret >= 0 else (None, str(frame.ret))

    def listed(self, path):
        """The properties below the path, without elements, without the path before them."""
        frame = self.frame(served.DIRALL, path)
        found = set()
        for entry in frame.data.rstrip(b"\0").decode().split(",") if frame.ret >= 0 else ():
            name = re.sub(r"\.\w+$", "", entry.split("/", 2)[2]).rstrip("/") if entry else ""
            if not name or name in found:
                continue
            found.add(name)
            found |= self.listed(f"/{entry.split('/', 2)[1]}/{name}")
        return found

    def end(self):
        for program in reversed(self.started):
            program.terminate()
        for program in self.started:
            try:
                program.wait(10)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()
            if program.stdout:
                program.stdout.close()
        self.log.close()
        shutil.rmtree(self.place, ignore_errors=True)


def walk(genuine, part, device, line):
    """{property and element: (text, error)} and what the directories list."""
    server = Server(genuine, line)
    rows = [r for r in structure() if r.family == device[:2]]
    # What does not measure, but shows the last result, is asked for behind what measures
    rows.sort(key=lambda r: r.family in LAST_RESULT and "latest" in r.property)
    answers = {}
    try:
        server.wait_for(device)
        # Which of several chips with this family it is, owsd learns at the first request
        for row in [r for r in rows if r.visibility == "always" and not COMMON & {r.property}][:2]:
            server.text(f"/{device}/{row.property}{elements(row)[0]}")
        listed = server.listed(f"/{device}")
        for row in rows:
            above = row.property.rpartition("/")[0]
            hidden = row.visibility in ("always", "hidden") and (not above or above in listed)
            if row.property not in listed and not hidden or (part, row.property) in KILLS:
                continue
            for element in elements(row):
                name = row.property + element
                if not {(part, row.property), (part, name)} & LONG:
                    answers[name] = server.text(f"/{device}/{name}")
            assert server.started[-1].poll() is None, f"{part}: {row.property} ends owserver"
        return answers, listed
    finally:
        server.end()


def seconds(text):
    """A clock's text as seconds."""
    text = text.decode("ascii", "replace").strip()
    if re.fullmatch(r"\d+", text):
        return int(text)
    try:
        return time.mktime(time.strptime(text, "%a %b %d %H:%M:%S %Y"))
    except ValueError:
        return None


def same_bytes(a, b):
    """But for what counts: at most four bytes, each a little more or less."""
    differ = [(x - y) % 256 for x, y in zip(a, b) if x != y]
    return len(a) == len(b) and len(differ) <= 4 and \
        all(d <= CLOCK_S or d >= 256 - CLOCK_S for d in differ)


def same(family, name, a, b):
    if a == b:
        return True
    if CLOCKS.search(name):
        first, second = seconds(a), seconds(b)
        return first is not None and second is not None and abs(first - second) <= CLOCK_S
    if name in SUMS:
        return abs(float(a) - float(b)) <= SUMS[name]
    return family in BYTES_RUN and bool(BYTES.search(name)) and same_bytes(a, b)


class Verdicts:
    """What the walks say of each property."""

    def __init__(self):
        self.texts, self.bad = collections.Counter(), collections.defaultdict(list)
        self.silent = collections.defaultdict(list)

    def add(self, part, device, theirs, ours):
        family = device[:2]
        for name in sorted(theirs.keys() | ours.keys()):
            a, b = theirs.get(name, (None, "not listed")), ours.get(name, (None, "not listed"))
            key = (family, name.partition(".")[0])
            if a[0] is None and b[0] is None:
                self.silent[key].append((part, name, a[1], b[1]))
            elif a[0] is None or b[0] is None or not same(family, name, a[0], b[0]):
                self.bad[key].append((part, name, a[0] if a[0] is not None else a[1],
                                      b[0] if b[0] is not None else b[1]))
                self.texts[key] += 1
            else:
                self.texts[key] += 1

    def of(self, row):
        """(verdict, number of texts)"""
        key = (row.family, row.property)
        if key in self.bad:
            return "differs", self.texts[key]
        return ("same", self.texts[key]) if self.texts[key] else ("not compared", 0)

    def show(self, keys=None, parts=()):
        for key in sorted(self.bad.keys() | self.silent.keys() if keys is None else keys):
            bad, silent = ([text for text in texts.get(key, ()) if not parts or text[0] in parts]
                           for texts in (self.bad, self.silent))
            for part, name, a, b in bad:
                print(f"  {part} {name}: owserver {str(a)[:90]!s}, owsd {str(b)[:90]!s}")
            for part, name, a, b in silent[:1]:
                print(f"  {part} {name}: owserver {a}, owsd {b}: no text")


def run(parts=()):
    verdicts = Verdicts()
    jobs = []
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        for part, device, line in devices():
            if not parts or part in parts:
                jobs.append((part, device, *(pool.submit(walk, genuine, part, device, line)
                                             for genuine in (True, False))))
    for part, device, theirs, ours in jobs:
        verdicts.add(part, device, theirs.result()[0], ours.result()[0])
    return verdicts


def recorded():
    """{(family, property): (verdict, texts, reason)}"""
    with open(COMPARED, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file][1:]
    assert all(len(r) == len(COLUMNS) for r in rows), "five columns each"
    return {(r[0], r[1]): (r[2], int(r[3]), r[4]) for r in rows}


def families_of(parts=()):
    return {device[:2] for part, device, _ in devices() if not parts or part in parts}


def whole(parts):
    """All parts of the families of these: a line of the file is of all parts of its family."""
    return [part for part, device, _ in devices() if device[:2] in families_of(parts)]


def rows_of(parts=()):
    families = families_of(parts)
    return [r for r in structure() if r.family not in NO_DEVICE and (not parts or r.family in families)]


def lines_of(verdicts, old, parts=()):
    """{(family, property): (verdict, texts, reason)}: of the families of the parts what the walks
    say, of the others what the file said."""
    families, lines = families_of(parts), {}
    for row in rows_of():
        key = (row.family, row.property)
        if row.family in families:
            verdict, texts = verdicts.of(row)
            lines[key] = (verdict, texts, "" if verdict == "same" else old.get(key, ("", 0, ""))[2])
        elif key in old:
            lines[key] = old[key]
    return lines


def write(lines):
    with open(COMPARED, "w", encoding="utf-8") as file:
        print(*COLUMNS, sep="\t", file=file)
        for key, line in lines.items():
            print(*key, *line, sep="\t", file=file)


def main():
    parts = [a for a in sys.argv[1:] if not a.startswith("--")]
    unknown = set(parts) - {part for part, _, _ in devices()}
    if unknown:
        sys.exit(f"not in {DEVICES.name}: {' '.join(sorted(unknown))}")
    began = time.monotonic()
    verdicts = run(whole(parts))
    counted = collections.Counter(verdicts.of(row)[0] for row in rows_of(parts))
    old = recorded() if COMPARED.exists() else {}
    if parts or "--show" in sys.argv:
        verdicts.show(parts=parts)
    if "--write" in sys.argv:
        write(lines_of(verdicts, old, parts))
    else:
        for row in rows_of(parts):
            was = old.get((row.family, row.property))
            if not was or was[:2] != verdicts.of(row):
                print(row.family, row.property, "recorded", was, "now", verdicts.of(row))
                verdicts.show([(row.family, row.property)])
    print(dict(counted), f"{time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
