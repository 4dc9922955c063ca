#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tests/mutate on a small tree: which faults it plants, what catches them, what survives."""

import json
import re
import shutil
import subprocess
import sys

import owsdtest
from owsdtest import SOURCE

LINES = """/* A comment: a < b. */
static const int table[] = {
	1, 2,
};
int add(int a, int b)
{
	static int calls = 4;
	const char *text = "a < b, 7";

	calls++;
	if (a < 10 && text)
		a = a + b; /* 3 < 4 */
	if (a < 10 ||
	    b > 1)
		note(a, "x");
	return a - 1;
}
"""
MAKEFILE = """build/unit/%: tests/unit/kit/%.c build/src/faces/kit/a.o
	@mkdir -p $(@D)
	@cc -o $@ $^
build/src/faces/kit/a.o: src/faces/kit/a.c
	@mkdir -p $(@D)
	@cc -Werror -Wall -c -o $@ $<
"""
ROOM = """int is_small(int x);
int is_small(int x)
{
	return x < 3;
}
"""
TEST = """#include <stdio.h>
int is_small(int x);
int main(void)
{
	int failures = !is_small(2) || is_small(%s);

	printf("1 Tests %%d Failures 0 Ignored\\n", failures);
	return failures;
}
"""


def tree_with(scene, limit):
    tree = scene.path / f"tree{limit}"
    for name, text in (("Makefile", MAKEFILE), ("src/faces/kit/a.c", ROOM), ("tests/unit/kit/test_face.c", TEST % limit),
                       (".gitignore", "build\n")):
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        (tree / name).write_text(text)
    shutil.copy(SOURCE / "tests/mutate", tree / "tests")
    subprocess.run(["git", "init", "-q"], cwd=tree, check=True, timeout=owsdtest.PATIENCE)
    return tree


def mutate(tree, *words):
    done = subprocess.run([sys.executable, tree / "tests/mutate", *words], capture_output=True, text=True,
                          timeout=owsdtest.PATIENCE)
    assert not done.stderr, done
    assert not (tree / "build/mutate").exists(), "the copy is left"
    assert (tree / "src/faces/kit/a.c").read_text() == ROOM
    return done.stdout, done.returncode


def test_faults_are_planted_in_functions_alone_and_each_is_one(scene):
    done = subprocess.run([sys.executable, "-c", "import importlib.machinery, importlib.util, json, sys\n"
                           "sys.dont_write_bytecode = True\n"
                           "loader = importlib.machinery.SourceFileLoader('mutate', sys.argv[1])\n"
                           "mutate = importlib.util.module_from_spec(importlib.util.spec_from_loader('mutate', loader))\n"
                           "loader.exec_module(mutate)\n"
                           "print(json.dumps(list(mutate.faults_of(sys.argv[2]))))", SOURCE / "tests/mutate", LINES],
                          capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=True)
    found = {}
    for number, new in json.loads(done.stdout):
        found.setdefault(number + 1, []).append(new.strip())
    assert found == {
        10: [";"],
        11: ["if (a <= 10 && text)", "if (a < 10 || text)", "if (a < 11 && text)", "if (a < 9 && text)",
             "if (!(a < 10 && text))"],
        12: ["a = a - b; /* 3 < 4 */", ";"],
        13: ["if (a <= 10 ||", "if (a < 10 &&", "if (a < 11 ||", "if (a < 9 ||"],
        14: ["b >= 1)", "b > 2)", "b > 0)"],
        15: [";"],
        16: ["return a + 1;", "return a - 2;", "return a - 0;"],
    }, found


def test_a_fault_that_a_unit_test_finds_is_caught(scene):
    said, status = mutate(tree_with(scene, 3), "kit")
    assert "survives" not in said and "ok   kit: 1 of 1 faults caught, 100 %" in said, said
    assert said.endswith("1 passed, 0 failed\n") and status == 0, said


def test_a_fault_that_none_finds_survives_and_is_shown(scene):
    said, status = mutate(tree_with(scene, 4), "kit", "--seed", "2")
    assert "--- src/faces/kit/a.c:4\n+++ survives\n@@ -1 +1 @@\n-\treturn x < 3;\n+\treturn x " in said, said
    assert "FAIL kit: 0 of 1 faults caught, 0 %, the floor is " in said and status == 1, said
    assert re.search(r"^0 passed, 1 failed$", said, re.M), said


def test_a_room_whose_tests_fail_without_a_fault_has_failed(scene):
    said, status = mutate(tree_with(scene, 2), "kit")
    assert "FAIL kit: without any fault: test_face" in said and status == 1, said


if __name__ == "__main__":
    owsdtest.main()
