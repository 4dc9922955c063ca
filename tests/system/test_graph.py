#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Arrows only go down: no circle between files, no room that uses one above it, small headers.

The rooms, from the top down, and what each may use stand in docs/design.md ("Rooms"). A tree of
their own proves that these checks find what they look for.
"""

import pathlib
import re
import subprocess

import graph
import owsdtest
from owsdtest import BUILD, SOURCE

TOPS = ["src", "hal"]
# Lists of tables of operations, and the tables in them: backends, families, simulated families. A
# dispatcher finds in the list what stands above it; that is its purpose, so it is not counted.
TABLES = r"bus_backends|\w+_bus|family_[0-9a-f]{2}|sim_families|sim_[a-z]+[0-9]\w*" \
    r"|sim_(hb|inferno)_\w+|sim_(lcd|iblss|example_slave)"
# The words that owsd and its consumers have in common; it includes nothing
PUBLIC = "src/libows/ows"
# Headers whose functions stand in many files, by design: the consumers' headers, and the verbs
# of owsctl, each in the file of its name
MANY = {"src/libows/ows.h", "src/owsctl/verbs.h"}
# Lists that are included where FAMILY or BACKEND is defined: no headers of their own
PARTS = {"hal/chips/families.h", "hal/bus/schemes.h"}


ROOM = re.compile(r"^- `([\w/]+)`: .*? Uses (.*?)\.\n(?=- |\n)", re.M | re.S)


def allowed():
    """Of each room, from the top down, the rooms that it may use."""
    section = (SOURCE / "docs/design.md").read_text().split("\n## Rooms\n")[1].split("\n## ")[0]
    return {room: re.findall(r"`([\w/]+)`", uses) for room, uses in ROOM.findall(section + "\n")}


def tree():
    return graph.Graph(SOURCE, BUILD, TOPS)


def between_rooms(found):
    """room -> room -> an arrow, as text"""
    rooms = {}
    for here, to in found.without(TABLES).items():
        for there, why in to.items():
            a, b = graph.room_of(here), graph.room_of(there)
            if a != b and there != PUBLIC:
                arrow = f"{found.name(here)} -> {found.name(there)} ({why[-1]})"
                rooms.setdefault(a, {})[b] = arrow
    return rooms


def test_files_use_each_other_in_no_circle(scene):
    found = tree()
    arrows = found.without(TABLES)
    circles = [found.told(arrows, circle) for circle in found.circles(arrows)]
    assert not circles, "\n".join(circles)


def test_a_room_uses_only_the_rooms_that_the_design_names_and_those_stand_below(scene):
    may = allowed()
    order = list(may)
    rooms = {graph.room_of(unit) for unit in map(graph.unit_of, tree().files)}
    assert rooms == set(order), rooms ^ set(order)
    up = [f"{room} uses {used}" for room in order for used in may[room]
          if used not in order or order.index(used) <= order.index(room)]
    assert not up, up
    wrong = [why for room, to in between_rooms(tree()).items() for used, why in to.items()
             if used not in may[room]]
    assert not wrong, "\n".join(wrong)


def test_no_leave_is_given_that_nobody_takes(scene):
    taken = between_rooms(tree())
    spare = [(room, used) for room, uses in allowed().items() for used in uses
             if used not in taken.get(room, {})]
    assert not spare, spare


def test_the_main_header_of_a_room_says_what_the_room_is_and_what_it_may_use(scene):
    section = (SOURCE / "docs/design.md").read_text().split("\n## Rooms\n")[1].split("\n## ")[0]
    wrong = []
    for room, text in re.findall(r"^- `([\w/]+)`: (.*?)\n(?=- |\n)", section + "\n\n", re.M | re.S):
        expected = " ".join(f"Room {room}: {text}".replace("`", "").split())
        heads = [re.sub(r"\s+\*?\s*", " ", file.read_text().split("*/")[1])
                 for file in (SOURCE / room).glob("*.[ch]") if file.read_text().count("*/") > 1]
        if sum(expected in head for head in heads) != 1:
            wrong.append(f"{room}: no head comment, or several, have: {expected}")
    assert not wrong, "\n".join(wrong)


def test_each_header_compiles_alone_and_declares_what_its_file_defines(scene):
    found = tree()
    declared, errors = found.declared(PARTS)
    assert not errors, "\n".join(errors)
    wrong = []
    for header, line, function in declared:
        home = found.defined.get(function)
        if home is None and f"{function}(" in found.text.get(graph.unit_of(header) + ".c", ""):
            continue  # of a library that this build has not
        if graph.unit_of(home or "") != graph.unit_of(header) and header not in MANY:
            wrong.append(f"{header}:{line}: {function}() stands in {home}")
    assert len(declared) > 500
    assert not wrong, "\n".join(wrong)


def test_no_header_only_includes_others_and_every_include_leads_from_the_top(scene):
    found = tree()
    assert not found.umbrellas()
    assert not found.loose


def made(scene, **files):
    """A tree of its own, compiled: the graph of it."""
    top = pathlib.Path(scene.path, "tree")
    for name, text in files.items():
        file = top / "src" / name.replace("_", ".")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        if file.suffix == ".c":
            subprocess.run(["gcc", "-c", "-I.", f"src/{file.name}", "-o", f"src/{file.stem}.o"],
                           cwd=top, check=True, timeout=60)
    return graph.Graph(top, top, ["src"])


def test_a_circle_is_found_and_printed_with_its_functions(scene):
    found = made(scene, a_h="void a(void);\n", b_h="void b(void);\n", c_h="void c(void);\n",
                 a_c='#include "src/b.h"\nvoid a(void) { b(); }\n',
                 b_c='#include "src/c.h"\nvoid b(void) { c(); }\n',
                 c_c='#include "src/a.h"\n#include "src/b.h"\nvoid c(void) { a(); b(); }\n',
                 d_c='#include "src/a.h"\nvoid d(void) { a(); }\n')
    assert [found.told(found.arrows, c) for c in found.circles(found.arrows)] == [
        "src/b.c -> src/c.c (c) -> src/b.c (b)"]


def test_headers_that_include_each_other_are_a_circle_too(scene):
    found = made(scene, a_h='#include "src/b.h"\n', b_h='#include "src/a.h"\n')
    assert [found.told(found.arrows, c) for c in found.circles(found.arrows)] == [
        "src/a.h -> src/b.h (includes src/b.h) -> src/a.h (includes src/a.h)"]


def test_data_of_another_file_is_an_arrow_and_a_loose_include_is_seen(scene):
    found = made(scene, a_c="int shared = 1;\nint b(void);\nint a(void) { return b(); }\n",
                 b_c="extern int shared;\nint b(void) { return shared; }\n",
                 c_h='#include "b.h"\n')
    assert found.loose == ["src/c.h includes b.h"]
    assert [found.told(found.arrows, c) for c in found.circles(found.arrows)] == [
        "src/a.c -> src/b.c (b) -> src/a.c (shared)"]


if __name__ == "__main__":
    owsdtest.main()
