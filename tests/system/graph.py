# SPDX-License-Identifier: MIT
"""The graph of a tree of C sources: which unit includes which, and which calls which.

A unit is x.c with x.h, or one of them alone; its name is the path without the ending. An arrow
leads from a unit to one whose header it includes, or whose object defines what it uses: a
function, or data. Calls through a pointer cannot be seen, and need not be: whoever fills the
pointer in names the function, and that is an arrow.
"""

import collections
import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile

COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
DECLARED = re.compile(r"^/\* (.*?):(\d+):NC \*/ extern .*?(\w+) \((?!\*)", re.M)
FLAGS = ["-std=c17", "-D_GNU_SOURCE", "-D_FILE_OFFSET_BITS=64", "-I.", "-Wall", "-Wextra",
         "-Werror"]


def unit_of(path):
    return os.path.splitext(path)[0]


def room_of(unit):
    return os.path.dirname(unit)


class Graph:
    """Of the C files below the folders tops of source, with their objects in build."""

    def __init__(self, source, build, tops):
        self.source, self.build = source, build
        self.files = sorted(str(f.relative_to(source)) for top in tops
                            for f in (source / top).rglob("*.[ch]"))
        self.text = {f: (source / f).read_text() for f in self.files}
        self.arrows = collections.defaultdict(dict)  # unit -> unit -> reasons, includes first
        self.loose = []  # includes that do not lead from the top of the tree to a file
        self.defined = {}  # symbol -> the .c whose object defines it
        self.includes()
        self.calls()

    def headers(self):
        return [f for f in self.files if f.endswith(".h")]

    def includes(self):
        for file, text in self.text.items():
            for name in INCLUDE.findall(text):
                if name in self.text:
                    self.arrow(file, name, f"includes {name}")
                else:
                    self.loose.append(f"{file} includes {name}")

    def arrow(self, here, there, why):
        here, there = unit_of(here), unit_of(there)
        if here != there:
            self.arrows[here].setdefault(there, []).append(why)

    def calls(self):
        """By the objects of the files that are there: the folder may have older ones."""
        objects = {self.build / f"{unit_of(f)}.o": f for f in self.files if f.endswith(".c")}
        missing = [str(o) for o in objects if not o.exists()]
        assert not missing, f"not built: {missing}"
        needed = []
        for line in (run(["nm", "-APg", *map(str, objects)]) if objects else "").splitlines():
            name, symbol, kind = re.match(r"(.*?\.o): (\S+) (\S)", line).groups()
            file = objects[type(self.build)(name)]
            if kind in "Uw":
                needed.append((file, symbol))
            elif symbol != "main":
                assert symbol not in self.defined, f"{symbol} in {file}, {self.defined[symbol]}"
                self.defined[symbol] = file
        for file, symbol in needed:
            if symbol in self.defined:
                self.arrow(file, self.defined[symbol], symbol)

    def without(self, symbols):
        """The arrows, but those of symbols that this pattern matches."""
        kept = {here: {there: [w for w in why if not re.fullmatch(symbols, w)]
                       for there, why in to.items()} for here, to in self.arrows.items()}
        return {here: {there: why for there, why in to.items() if why} for here, to in kept.items()}

    def name(self, unit):
        return unit + (".c" if unit + ".c" in self.text else ".h")

    def circles(self, arrows):
        """The shortest circle of each knot of units that reach each other, shortest first."""
        found = []
        left = set(arrows)
        while left:
            circle = min(filter(None, (shortest(arrows, u, left) for u in left)),
                         key=lambda c: (len(c), c), default=None)
            if circle is None:
                break
            found.append(circle)
            left -= knot(arrows, circle[0])
        return found

    def told(self, arrows, circle):
        """a.c -> b.c (function) -> a.c (function)"""
        line = self.name(circle[0])
        for here, there in zip(circle, circle[1:] + circle[:1]):
            line += f" -> {self.name(there)} ({arrows[here][there][-1]})"
        return line

    def declared(self, but):
        """Compile headers alone: what each declares, (header, line, function); what gcc says."""
        headers = [h for h in self.headers() if h not in but]
        with concurrent.futures.ThreadPoolExecutor(2) as two:
            done = list(two.map(self.compile_alone, headers))
        return [d for found, _ in done for d in found], [e for _, error in done for e in error]

    def compile_alone(self, header):
        with tempfile.TemporaryDirectory() as folder:
            info = pathlib.Path(folder, "declared")
            done = subprocess.run(["gcc", "-fsyntax-only", "-aux-info", info, *FLAGS, header],
                                  cwd=self.source, capture_output=True, text=True, timeout=60)
            text = info.read_text() if info.exists() else ""
        found = [(file, int(line), function) for file, line, function in DECLARED.findall(text)
                 if file == header]
        return found, [done.stderr] if done.returncode else []

    def umbrellas(self):
        """Headers that only include others."""
        def bare(text):
            code = COMMENT.sub("", text).split("\n")
            guard = re.search(r"^#ifndef (\w+)\n#define \1$", "\n".join(code), re.M)
            return not any(line.strip() and (guard is None or line != f"#define {guard[1]}") and
                           not re.match(r"#\s*(include|if|endif|else|elif)", line)
                           for line in code)
        return [h for h in self.headers() if bare(self.text[h])]


def run(command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout


def shortest(arrows, start, among):
    """The shortest way from a unit to itself, or None."""
    came = {}
    queue = collections.deque([start])
    while queue:
        here = queue.popleft()
        for there in sorted(arrows.get(here, ())):
            if there == start:
                circle = [here]
                while circle[-1] != start:
                    circle.append(came[circle[-1]])
                return circle[::-1]
            if there not in came and there in among:
                came[there] = here
                queue.append(there)
    return None


def reached(arrows, start):
    seen, todo = set(), [start]
    while todo:
        for there in arrows.get(todo.pop(), ()):
            if there not in seen:
                seen.add(there)
                todo.append(there)
    return seen


def knot(arrows, unit):
    """All units that a unit reaches and that reach it."""
    return {u for u in reached(arrows, unit) if unit in reached(arrows, u)}
