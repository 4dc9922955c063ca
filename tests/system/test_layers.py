#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the engine, the values and the alarm machine keep out: input and output, and all else.

Which room may use which is in docs/design.md, and test_graph.py holds the sources against it.
"""

import pathlib
import re

import owsdtest
from owsdtest import SOURCE

# What the engine and the values may have of the C library: nothing that waits, reads or writes
PURE = {"assert.h", "errno.h", "float.h", "limits.h", "math.h", "stdbool.h", "stddef.h", "stdint.h",
        "stdio.h", "stdlib.h", "string.h", "strings.h"}
STREAMS = re.compile(r"\b(?:v?f?printf|f?puts|f?putc|putchar|perror|f(?:open|close|read|write|flush)|"
                     r"popen|system|getenv|exit|abort)\(")


def sources(folder):
    found = sorted((SOURCE / folder).glob("*.[ch]"))
    assert found, f"nothing in {folder}"
    return found


def included(file, sign):
    return re.findall(r'^\s*#\s*include\s+[%s]([^">]+)' % sign, file.read_text(), re.M)


def headers(file):
    """The headers of ours that a file names, from the top folder."""
    for name in included(file, '"'):
        beside = (file.parent / name).resolve()
        yield str(beside.relative_to(SOURCE)) if beside.exists() else name


def test_the_engine_and_the_values_do_no_input_and_output(scene):
    for folder in ("src/engine", "src/signal"):
        for file in sources(folder):
            foreign = set(included(file, "<")) - PURE
            assert not foreign, f"{file.relative_to(SOURCE)} includes {foreign}"
            code = re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\])*"', "", file.read_text(), flags=re.S)
            calls = STREAMS.findall(code)
            assert not calls, f"{file.relative_to(SOURCE)} calls {calls}"


def test_the_alarm_machine_is_a_function_of_its_own_header_alone(scene):
    assert list(headers(SOURCE / "src/engine/alarm_fsm.c")) == ["src/engine/alarm_fsm.h"]
    assert not list(headers(SOURCE / "src/engine/alarm_fsm.h"))


def test_the_files_of_the_engine_keep_to_the_stack_that_its_header_shows(scene):
    head = (SOURCE / "src/engine/engine.h").read_text().split("*/")[1]
    lines = re.findall(r"^ \*   (\w[\w ,]*?)  +(\S.*)$", head, re.M)
    layer = {name.strip(): height for height, (_, files) in enumerate(reversed(lines))
             for name in re.sub(r"\([^)]*\)", "", files).split(",")}
    made = {f.stem for f in sources("src/engine") if f.suffix == ".c"}
    assert set(layer) == made, set(layer) ^ made
    wrong = [f"{file.name} includes {header}" for file in sources("src/engine")
             for header in headers(file) if pathlib.Path(header).stem in layer
             and header.startswith("src/engine/") and file.stem in layer
             and layer[pathlib.Path(header).stem] > layer[file.stem]]
    assert not wrong, wrong


def test_every_c_file_begins_with_what_stands_in_it(scene):
    bare = []
    for top in ("src", "hal", "tests"):
        for file in sorted((SOURCE / top).rglob("*.c")):
            lines = file.read_text().splitlines()
            if not (lines[0].startswith("/* SPDX-") and lines[1].startswith("/*")):
                bare.append(str(file.relative_to(SOURCE)))
    assert not bare, "no sentence after the SPDX line of " + ", ".join(bare)


def test_no_comment_is_wider_than_100_columns(scene):
    token = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|/\*.*?\*/|//[^\n]*', re.S)
    wide = []
    for top in ("src", "hal", "tests"):
        for file in sorted((SOURCE / top).rglob("*.[ch]")):
            text = file.read_text()
            lines = text.expandtabs(8).split("\n")
            if max(map(len, lines)) <= 100:
                continue
            for found in token.finditer(text):
                first, last = (text.count("\n", 0, at) for at in found.span())
                wide += [f"{file.relative_to(SOURCE)}:{n + 1}" for n in range(first, last + 1)
                         if found[0].startswith("/") and len(lines[n]) > 100]
    assert not wide, "wrap the comments in " + ", ".join(wide)


if __name__ == "__main__":
    owsdtest.main()
