# SPDX-License-Identifier: MIT
"""Arrows only go down: no circle between files, no room that uses one above it, small headers; and
what the engine, the values and the alarm machine keep out.

rooms.txt has the rooms, from the top down, and after the colon what each may use.
"""

import functools
import pathlib
import re

import graph
from tree import Skip, parallel

LIST = "tests/lint/rooms.txt"
TOPS = ["src", "hal"]
# Lists of tables of operations, and the tables in them: backends, families, simulated families. A
# dispatcher finds in the list what stands above it; that is its purpose, so it is not counted.
TABLES = r"bus_backends|\w+_bus|family_[0-9a-f]{2}|sim_families|sim_[a-z]+[0-9]\w*" \
    r"|sim_(hb|inferno)_\w+|sim_(lcd|iblss)"
# Headers whose functions stand in many files, by design: the consumers' headers, the verbs of
# owsctl and the paths of owsd-web, each in the file of its name
MANY = {"src/public/ows.h", "src/public/ows_history.h", "src/tool/owsctl/verbs.h",
        "src/faces/web/paths.h"}
# Lists that are included where FAMILY or BACKEND is defined: no headers of their own
PARTS = {"hal/chips/families.h", "hal/bus/schemes.h", "src/config/read/option_list.h", "src/ground/signal/words_list.h"}
FLAGS = ["-std=c17", "-D_GNU_SOURCE", "-D_FILE_OFFSET_BITS=64", "-I.", "-Wall", "-Wextra"]
# What the engine and the values may have of the C library: nothing that waits, reads or writes
PURE = {"assert.h", "errno.h", "float.h", "limits.h", "math.h", "stdbool.h", "stddef.h", "stdint.h",
        "stdio.h", "stdlib.h", "string.h", "strings.h"}
STREAMS = re.compile(r"\b(?:v?f?printf|f?puts|f?putc|putchar|perror|f(?:open|close|read|write|flush)|"
                     r"popen|system|getenv|exit|abort)\(")


@functools.cache
def graph_of(tree):
    return graph.Graph(tree, TOPS)


def allowed(tree):
    """Of each room, from the top down, the rooms that it may use."""
    if LIST not in tree.files:
        raise Skip(f"no {LIST}")
    return {room: uses.split() for room, uses in (row.split(":") for row in tree.text(LIST).splitlines())}


def between_rooms(found):
    """room -> room -> an arrow: the units, the last reason"""
    rooms = {}
    for here, to in found.without(TABLES).items():
        for there, why in to.items():
            a, b = graph.room_of(here), graph.room_of(there)
            if a != b:
                rooms.setdefault(a, {})[b] = here, there, why[-1]
    return rooms


def check_files_use_each_other_in_no_circle(tree):
    found = graph_of(tree)
    arrows = found.without(TABLES)
    for circle in found.circles(arrows):
        yield found.name(circle[0]), 1, f"a circle: {found.told(arrows, circle)}; take one arrow out"


def check_a_room_uses_only_the_rooms_that_the_list_names_and_those_stand_below(tree):
    may, found = allowed(tree), graph_of(tree)
    order = list(may)
    taken = between_rooms(found)
    rooms = {graph.room_of(graph.unit_of(f)): f for f in found.files}
    for room in rooms.keys() - may.keys():
        uses = " ".join(other for other in order if other in taken.get(room, {}))
        yield rooms[room], 1, f"{LIST} has no room {room}; add, above those that it uses: {room}: {uses}"
    for room, used in may.items():
        line = tree.line_of(LIST, f"{room}:")
        if room not in rooms:
            yield LIST, line, f"there is no room {room}; take it out"
        for other in used:
            if other not in order or order.index(other) <= order.index(room):
                yield LIST, line, f"{room} may use {other}, which does not stand below it; move one of them"
            elif other not in taken.get(room, {}):
                yield LIST, line, f"{room} does not use {other}; take that leave out"
        for other, (here, there, why) in taken.get(room, {}).items():
            if other not in used:
                file = found.name(here)
                yield file, tree.line_of(file, why.removeprefix("includes ")), \
                    f"{room} may not use {other}: {found.name(there)} ({why}); go another way, or say so in {LIST}"


def check_what_is_private_to_a_room_or_a_part_of_it_is_included_there_alone(tree):
    for file in tree.ending(".c", ".h"):
        for found in re.finditer(r'^#include "([\w/]+)/(?:state|private)\.h"', tree.text(file), re.M):
            if file.startswith(("src/", "hal/")) and not file.startswith(found[1] + "/"):
                yield file, tree.text(file).count("\n", 0, found.start()) + 1, \
                    f"this header is private to {found[1]}; use what that declares for others"


def check_each_header_declares_what_its_file_defines(tree):
    found = graph_of(tree)
    for header, line, function in found.functions():
        home = found.defined.get(function)
        if home and graph.unit_of(home) != graph.unit_of(header) and header not in MANY:
            yield header, line, f"{function}() stands in {home}; declare it in the header of that"


def check_each_header_compiles_alone(tree):
    headers = [f for f in tree.ending(".h") if f.startswith(("src/", "hal/")) and f not in PARTS]
    for output in parallel(["gcc", "-fsyntax-only", *FLAGS], headers):
        for file, line, text in re.findall(
                r"^(\S+?):(\d+):\d+: (?:(?:fatal )?error|warning): (?!#pragma once)(.*)$", output, re.M):
            yield file, int(line), f"{text}; include what the header uses"


def check_no_header_only_includes_others_and_every_include_leads_from_the_top(tree):
    found = graph_of(tree)
    for header in found.umbrellas():
        yield header, 1, "only includes other headers; have those who want them include them"
    for file, name in found.loose:
        yield file, tree.line_of(file, f'"{name}"'), f"{name} is no path from the top folder; write it so"


# --- What the engine keeps out ----------------------------------------------------------------------

def included(tree, file, sign):
    return re.findall(r'^\s*#\s*include\s+[%s]([^">]+)' % sign, tree.text(file), re.M)


def check_the_engine_and_the_values_do_no_input_and_output(tree):
    for file in tree.ending(".c", ".h"):
        if graph.room_of(file) in ("src/daemon/engine", "src/ground/signal"):
            for name in set(included(tree, file, "<")) - PURE:
                yield file, tree.line_of(file, f"<{name}>"), f"<{name}> waits, reads or writes; do that elsewhere"
            code = re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\])*"', "", tree.text(file), flags=re.S)
            for call in STREAMS.findall(code):
                yield file, tree.line_of(file, call), f"{call}...) is input or output; do that elsewhere"
