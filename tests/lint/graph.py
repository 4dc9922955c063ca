# SPDX-License-Identifier: MIT
"""The graph of a tree of C sources: which unit includes which, and which uses what of which.

A unit is x.c with x.h, or one of them alone; its name is the path without the ending. An arrow
leads from a unit to one whose header it includes, or whose .c defines what it uses: a function, or
data. It is read from the text, which clang-format has laid out: nothing has to be built. What a
macro of a header uses, that header uses. Calls through a pointer cannot be seen, and need not be:
whoever fills the pointer in names the function, and that is an arrow.
"""

import collections
import os
import re

COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
NOT_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|^\s*#\s*include[^\n]*', re.S | re.M)
# What begins in the first column and is no other file's to use, or no name at all
OWN = r"^(?!static\b|typedef\b|extern\b|return\b|struct \w+ \{|enum\b.*\{|union \w+ \{)"
FUNCTION = re.compile(OWN + r"[a-z_][\w *]*?\b(\w+)\((?:[^;{}])*\)\n\{", re.M)
DATA = re.compile(OWN + r"[a-z_][\w *]*?\b(\w+)(?:\[[^\]]*\])*(?: = |;)", re.M)
POINTER = re.compile(OWN + r"[a-z_][\w *]*?\(\*(\w+)(?:\[[^\]]*\])*\)\([^;{}]*?\)(?: = |;)", re.M)
PROTOTYPE = re.compile(r"^(?!static\b|typedef\b|#)(?:extern )?[a-z_][\w *]*?\b(\w+)\((?!\*)[^;{}]*\)[\w() ,]*;", re.M)
EXTERN = re.compile(r"^extern [^;(]*?\b(\w+)(?:\[[^\]]*\])*;|^extern [^;]*?\(\*(\w+)\)\([^;]*;", re.M)
# Not the member of something, nor the name of a type
NAME = re.compile(r"(?<![\w.])(?<!->)(?<!struct )(?<!enum )(?<!union )[A-Za-z_]\w*")


ROOMS_IN_ROOMS = {"hal/sim/chips", "hal/sim/serial", "hal/sim/usb"}


def unit_of(path):
    return os.path.splitext(path)[0]


def room_of(unit):
    """The folder above it that is a room: the folders of a room are its parts, except these. Those of
    src stand in groups."""
    folder = os.path.dirname(unit)
    depth = 3 if folder.startswith("src/") else 2
    return folder if folder in ROOMS_IN_ROOMS else "/".join(folder.split("/")[:depth])


class Graph:
    """Of the C files of a tree below the folders tops."""

    def __init__(self, tree, tops):
        # none.c stands in the place of its room in a build that lacks a library
        self.files = [f for f in tree.ending(".c", ".h")
                      if f.startswith(tuple(t + "/" for t in tops)) and not f.endswith("/none.c")]
        self.text = {f: tree.text(f) for f in self.files}
        self.code = {f: NOT_CODE.sub(" ", t) for f, t in self.text.items()}
        self.arrows = collections.defaultdict(dict)  # unit -> unit -> reasons, includes first
        self.loose = []  # includes that do not lead from the top of the tree to a file
        self.defined = {}  # symbol -> the .c that defines it
        self.told_by = {f: self.declarations(f) for f in self.files}
        self.included = {f: [n for n in INCLUDE.findall(t) if n in self.text] for f, t in self.text.items()}
        self.includes()
        self.uses()

    def headers(self):
        return [f for f in self.files if f.endswith(".h")]

    def includes(self):
        for file, text in self.text.items():
            for name in INCLUDE.findall(text):
                if name in self.text:
                    self.arrow(file, name, f"includes {name}")
                else:
                    self.loose.append((file, name))

    def arrow(self, here, there, why):
        here, there = unit_of(here), unit_of(there)
        if here != there and why not in self.arrows[here].setdefault(there, []):
            self.arrows[here][there].append(why)

    def declarations(self, file):
        """What the file says of what stands elsewhere."""
        found = {a or b for a, b in EXTERN.findall(self.code[file])}
        return found | set(PROTOTYPE.findall(self.code[file])) if file.endswith(".h") else found

    def seen(self, file):
        """What is declared where a file can see it."""
        done, todo, found = set(), [file], set()
        while todo:
            here = todo.pop()
            if here not in done:
                done.add(here)
                found |= self.told_by[here]
                todo += self.included[here]
        return found

    def uses(self):
        for file, code in self.code.items():
            if file.endswith(".c"):
                for kind in (FUNCTION, DATA, POINTER):
                    for name in kind.findall(code):
                        if name != "main":
                            self.defined.setdefault(name, file)
        for file, code in self.code.items():
            for name in set(NAME.findall(code)) & self.seen(file) & set(self.defined):
                if file.endswith(".c") or name not in self.told_by[file]:
                    self.arrow(file, self.defined[name], name)

    def functions(self):
        """Of each header what it declares: (header, line, function)."""
        return [(h, self.code[h][:m.start(1)].count("\n") + 1, m[1]) for h in self.headers()
                for m in PROTOTYPE.finditer(self.code[h])]

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

    def umbrellas(self):
        """Headers that only include others."""
        def bare(text):
            code = COMMENT.sub("", text).split("\n")
            guard = re.search(r"^#ifndef (\w+)\n#define \1$", "\n".join(code), re.M)
            return not any(line.strip() and (guard is None or line != f"#define {guard[1]}") and
                           not re.match(r"#\s*(include|if|endif|else|elif|pragma once)", line)
                           for line in code)
        return [h for h in self.headers() if bare(self.text[h])]


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
