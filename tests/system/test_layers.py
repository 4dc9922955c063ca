#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who may include whom: what docs/design.md says of the layers, held against the sources."""

import re

import owsdtest
from owsdtest import SOURCE

# A folder, and the headers of others that its files may name: folders, or single headers.
# libows/ows.h and shm/layout.h are the words that owsd and its consumers have in common
MAY = {
    "hal/bus": [],
    "hal/null": ["hal/bus"],
    "hal/gpio": ["hal/bus"],
    "hal/owfs": ["hal/chips/family.h"],
    "hal/owserver": ["hal/bus", "hal/owfs"],
    "hal/wire": ["hal/bus", "hal/chips/family.h", "hal/native/files.h", "hal/owfs/path.h"],
    "hal/ds2482": ["hal/wire/link.h", "hal/gpio/line.h"],
    "hal/sim": ["hal/bus", "hal/ds2482", "hal/owfs/path.h", "hal/sim/chips", "hal/wire/link.h"],
    "hal/sim/chips": ["hal/sim"],
    "hal/chips": ["hal/wire"],
    "hal/native": ["hal/chips", "hal/ds2482/ds2482.h", "hal/owfs", "hal/sim/master.h", "hal/wire"],
    "hal/netlink": ["hal/w1/w1.h", "hal/wire/crc.h"],
    "hal/w1": ["hal/chips", "hal/native", "hal/netlink/netlink.h"],
    "src/signal": ["hal/owfs/path.h", "src/libows/ows.h"],
    "src/text": ["src/shm/futex.h", "src/signal/utf8.h"],
    "src/shm": ["src/libows/ows.h"],
    "src/libows": ["src/shm", "src/signal"],
    "src/config": ["hal/owfs/path.h", "src/signal", "src/libows/ows.h", "src/text/printable.h"],
    "src/board": ["hal/ds2482", "src/text/printable.h"],
    "src/engine": ["hal/bus/bus.h", "hal/owfs/path.h", "src/config", "src/shm",
                   "src/signal", "src/libows/ows.h", "src/text/log.h"],
    "src/serve": ["hal/bus", "hal/chips/family.h", "hal/native/native.h", "hal/owfs", "src/config",
                  "src/engine/guest.h", "src/shm", "src/signal", "src/libows", "src/text/log.h"],
    "src/owsctl": ["hal/bus/bus.h", "hal/chips/family.h", "hal/owfs/path.h", "src/board",
                   "src/config", "src/signal", "src/shm", "src/libows/ows.h",
                   "src/text/printable.h", "src/text/refused.h", "src/owsd/standard.h"],
    "src/host": ["hal/bus", "hal/gpio/line.h", "src/config", "src/engine", "src/serve/serve.h",
                 "src/shm", "src/libows/ows.h", "src/text/log.h"],
    "src/owsd": ["hal/bus/bus.h", "hal/gpio/line.h", "src/board", "src/config", "src/host",
                 "src/shm", "src/libows/ows.h", "src/text"],
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
