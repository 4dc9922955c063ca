#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""docs/first-family.md, replayed: its files and lines in a copy of the source, built, and read; and
the backend of docs/extending.md beside it.

A block after "`FILE`:" becomes that file. A block after "In `FILE`, after `LINE`:" is put after that
line. A console block is run in the copy, and its output compared.
"""

import os
import re
import shutil
import subprocess
import sys

import handbook
import owsdtest

PAGE = owsdtest.SOURCE / "docs/first-family.md"
BACKEND = owsdtest.SOURCE / "docs/extending.md"
EMPTY = owsdtest.SOURCE / "docs/examples/backend/empty.c"
BEFORE = re.compile(r"`([\w./-]+\.[ch])`[^`]*after\s+`([^`]+)`:$", re.I)


def copied(folder):
    """The source without what was built of it."""
    folder.mkdir()
    for name in (".clang-format", "Makefile", "LICENSE", "README.md", "NEWS.md", "src", "hal", "tests", "board", "docs"):
        source = owsdtest.SOURCE / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, folder / name)
    return folder


def paragraph_before(page, block):
    lines = page.read_text().split("\n")[:block.line - 1]
    while lines and not lines[-1].strip():
        lines.pop()
    begin = max((n for n, line in enumerate(lines) if not line.strip()), default=-1)
    return " ".join(lines[begin + 1:])


def put_after(file, line, text):
    rows = file.read_text().split("\n")
    found = [n for n, row in enumerate(rows, 1) if row.strip() == line]
    assert len(found) == 1, f"{file} has not one line {line}"
    at = found[0]
    file.write_text("\n".join([*rows[:at], *text.rstrip("\n").split("\n"), *rows[at:]]))


def run(folder, command):
    done = subprocess.run(["/bin/sh", "-c", command], cwd=folder, text=True, capture_output=True,
                          env={**os.environ, "MAKEFLAGS": f"-j{os.cpu_count()} CFLAGS=-O0"}, timeout=900,
                          check=False)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_the_page_adds_a_family_that_was_not_there(scene):
    folder, files, lines, outputs = copied(scene.path / "owsd"), 0, 0, 0
    for block in handbook.blocks(PAGE):
        place = BEFORE.search(paragraph_before(PAGE, block))
        if block.language in ("c", "sim"):
            assert block.file and not (folder / block.file).exists(), f"{block.file} is there already"
            (folder / block.file).write_text(block.text)
            files += 1
        elif place:
            put_after(folder / place[1], place[2], block.text)
            lines += 1
        elif block.language == "console":
            for command in re.split(r"^\$ ", block.text, flags=re.M)[1:]:
                command, _, expected = command.partition("\n")
                output = run(folder, command)
                assert expected.split() == output.split() or not expected, output
                outputs += bool(expected)
    assert (files, lines, outputs) == (3, 3, 5), (files, lines, outputs)
    a_backend_is_added(folder)


def a_backend_is_added(folder):
    """The backend of the other page, in the same copy: built, read, and rooms as lint wants them."""
    (folder / "hal/empty").mkdir()
    shutil.copy(EMPTY, folder / "hal/empty")
    lines = 0
    for block in handbook.blocks(BACKEND):
        before = paragraph_before(BACKEND, block)
        place = BEFORE.search(before)
        if place:
            put_after(folder / place[1], place[2], block.text)
            lines += 1
        elif "`tests/lint/rooms.txt`, above" in before:
            rooms = folder / "tests/lint/rooms.txt"
            rooms.write_text(rooms.read_text().replace("hal/null:", block.text + "hal/null:"))
            lines += 1
    assert lines == 2, lines
    run(folder, "make build/owsctl")
    assert "no device is there" in run(folder, "build/owsctl -t empty scan 2>&1 || true")
    lint = subprocess.run([sys.executable, folder / "tests/lint/run", folder], text=True,
                          capture_output=True, timeout=300, check=False)
    found = re.findall(r"^(?:tests/lint/rooms\.txt|hal/empty/).*", lint.stdout, re.M)
    assert "passed" in lint.stdout and not found, (found, lint.stderr)


if __name__ == "__main__":
    owsdtest.main()
