#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make analyze reads again what changed, and nothing else: its script on a small tree, with gcc."""

import os
import re
import shutil
import subprocess
import sys

from owsdtest import SOURCE, main, skip

HEADER = "#define SIZE 4\nint first(int *from);\n"
CLEAN = '#include "src/a/a.h"\n\nint first(int *from)\n{\n\treturn from ? *from : SIZE;\n}\n'
FAULTY = '#include <stdlib.h>\n' + CLEAN.replace("return", "free(from);\n\treturn")


class Tree:
    def __init__(self, scene):
        if not shutil.which("gcc"):
            skip("no gcc")
        self.scene = scene
        self.root = scene.path / "tree"
        shutil.copytree(SOURCE / "tests/analyze", self.root / "tests/analyze")
        (self.root / "hal").mkdir()
        (self.root / "src/a").mkdir(parents=True)
        self.write(".clang-tidy", "Checks: '-*'\n")
        self.write("src/a/a.h", HEADER)
        self.write("src/a/a.c", CLEAN)

    def write(self, name, text):
        (self.root / name).write_text(text)

    def analyze(self, *flags, **more):
        """Known as clean before, and the line that sums it."""
        env = dict(os.environ, XDG_CACHE_HOME=str(self.scene.path / "cache"), **more)
        done = subprocess.run([sys.executable, self.root / "tests/analyze/run", "--tool", "gcc", "--", "gcc",
                               "-std=c17", "-I.", *flags], capture_output=True, text=True, timeout=100, env=env)
        known = re.search(r"gcc: \d+ files, of which (\d+) clean before", done.stdout)
        assert known, done.stdout + done.stderr
        return int(known[1]), done.stdout.splitlines()[-1]


def test_a_clean_file_is_read_once(scene):
    tree = Tree(scene)
    assert tree.analyze() == (0, "1 passed, 0 failed")
    assert tree.analyze() == (1, "1 passed, 0 failed")


def test_what_was_found_is_found_each_time(scene):
    tree = Tree(scene)
    tree.write("src/a/a.c", FAULTY)
    assert tree.analyze() == (0, "0 passed, 1 failed")
    assert tree.analyze() == (0, "0 passed, 1 failed")
    tree.write("src/a/a.c", CLEAN)
    assert tree.analyze() == (0, "1 passed, 0 failed")
    tree.write("src/a/a.c", FAULTY)
    assert tree.analyze() == (0, "0 passed, 1 failed")


def test_a_changed_header_a_flag_and_the_settings_have_it_read_again(scene):
    tree = Tree(scene)
    assert tree.analyze() == (0, "1 passed, 0 failed")
    tree.write("src/a/a.h", HEADER.replace("4", "5"))
    assert tree.analyze() == (0, "1 passed, 0 failed")
    assert tree.analyze("-DMORE") == (0, "1 passed, 0 failed")
    tree.write(".clang-tidy", "Checks: '-*,bugprone-*'\n")
    assert tree.analyze() == (0, "1 passed, 0 failed")
    assert tree.analyze() == (1, "1 passed, 0 failed")


def test_a_header_that_hides_another_has_it_read_again(scene):
    tree = Tree(scene)
    for name in ("one", "two"):
        (tree.root / name).mkdir()
    tree.write("two/b.h", "#define B 1\n")
    tree.write("src/a/a.c", "#include <b.h>\n" + CLEAN)
    assert tree.analyze("-Ione", "-Itwo") == (0, "1 passed, 0 failed")
    assert tree.analyze("-Ione", "-Itwo") == (1, "1 passed, 0 failed")
    tree.write("one/b.h", "#define B 1\n")
    assert tree.analyze("-Ione", "-Itwo") == (0, "1 passed, 0 failed")


def test_all_is_read_if_wanted(scene):
    tree = Tree(scene)
    assert tree.analyze() == (0, "1 passed, 0 failed")
    assert tree.analyze(OWSD_ANALYZE_ALL="1") == (0, "1 passed, 0 failed")
    assert tree.analyze(OWSD_ANALYZE_ALL="0") == (1, "1 passed, 0 failed")


if __name__ == "__main__":
    main()
