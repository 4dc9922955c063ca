#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who may include whom: what docs/design.md says of the layers, held against the sources."""

import re

import owsdtest
from owsdtest import SOURCE

# A folder, and the headers of others that its files may name: folders, or single headers.
# libows/ows.h and shm/layout.h are the words that owsd and its consumers have in common
MAY = {
    "hal": [],
    "hal/null": ["hal"],
    "hal/gpio": ["hal"],
    "hal/owserver": ["hal"],
    "hal/ds2482": ["hal", "hal/gpio/line.h"],
    "hal/sim": ["hal", "hal/ds2482"],
    "hal/native": ["hal", "hal/ds2482/ds2482.h", "hal/sim/master.h"],
    "hal/w1": ["hal/native"],
    "src/signal": ["hal/path.h", "src/libows/ows.h"],
    "src/shm": ["src/libows/ows.h"],
    "src/libows": ["src/shm", "src/signal"],
    "src/config": ["hal/path.h", "src/signal", "src/libows/ows.h", "src/printable.h"],
    "src/board": ["hal/ds2482", "src/printable.h"],
    "src/engine": ["hal", "src/config/config.h", "src/shm", "src/signal", "src/libows/ows.h",
                   "src/log.h"],
    "src/serve": ["hal", "hal/native", "hal/owserver/frame.h", "src/config", "src/engine/guest.h",
                  "src/shm", "src/signal", "src/libows/handle.h", "src/libows/ows.h",
                  "src/log.h"],
    "src/owsctl": ["hal", "hal/native/family.h", "src/board", "src/config", "src/signal",
                   "src/shm/remains.h", "src/libows/ows.h", "src/printable.h", "src/refused.h",
                   "src/standard.h"],
    "src": ["hal", "hal/gpio/line.h", "src/board/board.h", "src/config", "src/engine", "src/serve",
            "src/shm", "src/signal/utf8.h", "src/libows/ows.h"],
}
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


def test_every_folder_of_sources_has_its_place_among_the_layers(scene):
    folders = {str(f.parent.relative_to(SOURCE)) for top in ("src", "hal")
               for f in (SOURCE / top).rglob("*.c")}
    assert folders == set(MAY), folders ^ set(MAY)


def test_no_file_includes_what_its_layer_may_not_know(scene):
    wrong = []
    for folder, may in MAY.items():
        for file in sources(folder):
            for header in headers(file):
                assert (SOURCE / header).exists(), f"{file} includes {header}, which is not there"
                home = header.rpartition("/")[0]
                if home != folder and home not in may and header not in may:
                    wrong.append(f"{file.relative_to(SOURCE)} includes {header}")
    assert not wrong, "\n".join(wrong)


def test_no_leave_to_include_is_given_that_nobody_takes(scene):
    for folder, may in MAY.items():
        taken = {h for file in sources(folder) for h in headers(file)}
        taken |= {h.rpartition("/")[0] for h in taken}
        assert set(may) <= taken, f"{folder}: {set(may) - taken}"


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


if __name__ == "__main__":
    owsdtest.main()
