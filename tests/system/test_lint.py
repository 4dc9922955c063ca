#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make lint: its checks on a small tree that has each fault, and on the same tree without."""

import re
import shutil
import subprocess
import sys

import owsdtest
from owsdtest import SOURCE

MIT = "SPDX-License-Identifier: MIT"
HEAD = f"/* {MIT} */\n/* Something. */\n"
ROOMS = "src/x/a: src/x/b\nsrc/x/b:\nsrc/daemon/engine:\n"
SUITES = """[some]
rung = check
why = it is the only one
run = true
seconds = 1
paths = src
tests = good
"""
CLEAN = {
    "tests/lint/rooms.txt": ROOMS,
    "tests/suites": f"# {MIT}\n{SUITES}",
    "tests/system/test_good.py": f"# {MIT}\n",
    "src/x/a/a.h": f"/* {MIT} */\n/* Room src/x/a: first things. Uses src/x/b. */\n#ifndef SRC_X_A_A_H\n"
                 "#define SRC_X_A_A_H\n\nint a(void);\n\n#endif\n",
    "src/x/a/a.c": f'{HEAD}#include "src/x/a/a.h"\n#include "src/x/b/b.h"\n\nint a(void)\n{{\n\treturn b();\n}}\n',
    "src/x/b/b.h": f"/* {MIT} */\n/* Room src/x/b: second things. Uses nothing. */\n#ifndef SRC_X_B_B_H\n"
                 "#define SRC_X_B_B_H\n\nint b(void);\n\n#endif\n",
    "src/x/b/b.c": f'{HEAD}#include "src/x/b/b.h"\n\nint b(void)\n{{\n\treturn 1;\n}}\n',
    "src/x/a/part/state.h": f"/* {MIT} */\n/* What this part has. */\n#ifndef SRC_X_A_PART_STATE_H\n"
                          "#define SRC_X_A_PART_STATE_H\n\nstruct part {\n\tint x;\n};\n\n#endif\n",
    "src/x/a/part/p.c": f'{HEAD}#include "src/x/a/part/state.h"\n',
    "docs/a.3": f'.\\" {MIT}\n.TH A 3 "" "a" "Library functions"\n.SH NAME\na \\- first things\n'
                ".SH SYNOPSIS\n.B #include <a.h>\n.PP\n.B int a(void);\n",
    "src/daemon/engine/e.c": f"/* {MIT} */\n/* Room src/daemon/engine: the engine. Uses nothing. */\n\n"
                      "int e(void);\n\nint e(void)\n{\n\treturn 0;\n}\n",
}
ODD = f"# {MIT}\n{SUITES}[odd]\nrung = none\n".replace("= src\n", "= src/x/a src/daemon/engine\n")
# file, its text or what is added to it, and the finding, as a pattern
LONG = "word " * 20
FAULTS = [
    ("src/x/a/late.c", f'{HEAD}#include "src/x/a/a.h"\nint late( void );\n', r"src/x/a/late.c:4: not laid out"),
    ("docs/torn.md", "| a |\n|---|\n| 1 |\n\n| 2 |\n- \n", r"docs/torn.md:5: a row without a table"),
    ("docs/torn.md", "| a |\n|---|\n| 1 |\n\n| 2 |\n- \n", r"docs/torn.md:6: an empty item"),
    ("docs/run.md", "- One stands. - Two does not.\n", r"docs/run.md:1: begin a line with each item"),
    ("src/x/a/wide.c", f"{HEAD}/* {LONG} */\n", r"src/x/a/wide.c:3: 10\d columns; wrap the comment"),
    ("docs/blank.py", f"# {MIT}\nx = 1 \n", r"docs/blank.py:2: a blank at the end"),
    ("docs/bare.py", "x = 1\n", r"docs/bare.py:1: no SPDX lines"),
    ("docs/secret.md", "LoadCredential=x:" + "/etc/owsd/x\n", r"docs/secret.md:1: a credential in a directory"),
    ("tests/lint/budgets.tsv", "page\twords\tsemicolons\tstand-ins\ndocs/many.md\t9\t0\t0\n", None),
    ("docs/many.md", "It is long. " * 9, r"docs/many.md:1: 27 words, and 9 are its budget"),
    ("docs/fleet.md", "# Fleet\n", r'docs/fleet.md:1: end it with "## Next"'),
    ("docs/web.md", "## Next\n\n- [a](a)\n- [b](b), see `src/x/a/a.c`\n", r"docs/web.md:4: say it in tested.md"),
    ("src/x/a/twice.c", f"/* {MIT} */\n{HEAD}", r"src/x/a/twice.c:1: 2 SPDX lines"),
    ("src/x/a/long.c", HEAD + "\n" * 500, r"src/x/a/long.c:500: 502 lines; split the file"),
    ("src/x/a/guard.h", f"/* {MIT} */\n#ifndef SRC_X_A_A_H\n#define SRC_X_A_A_H\nint g(void);\n#endif\n",
     r"src/x/a/guard.h:2: SRC_X_A_A_H is the guard of src/x/a/a.h too"),
    ("src/x/a/unequal.h", f"/* {MIT} */\n#ifndef SRC_X_A_UNEQUAL_H\n#define SRC_X_A_EQUAL_H\nint u(void);\n#endif\n",
     r"src/x/a/unequal.h:2: #ifndef SRC_X_A_UNEQUAL_H, but #define SRC_X_A_EQUAL_H"),
    ("tests/unit/a/aid/nap.c", f"{HEAD}\nvoid nap(void)\n{{\n\tusleep(1); /* pace */\n\tusleep(1);\n}}\n",
     r"tests/unit/a/aid/nap.c:7: a bare sleep"),
    ("tests/nap.py", f"# {MIT}\ntime.sleep(1)  # pace\ntime.sleep(1)\n", r"tests/nap.py:3: a bare sleep"),
    ("tests/nap.sh", f"# {MIT}\nsleep 1 # pace\nwhile x; do sleep 1; done\n", r"tests/nap.sh:3: a bare sleep"),
    ("tests/unit/a/test_x.c", f"{HEAD}\nstatic void test_that(void)\n{{\n}}\n", r"test_x.c:4: test_that is not run"),
    ("tests/unit/b/test_x.c", HEAD, r"tests/unit/b/test_x.c:1: makes the same program as tests/unit/a/test_x.c"),
    ("tests/unit/b/x.c", HEAD, r"tests/unit/b/x.c:1: make unit would not find it"),
    ("docs/syntax.py", f"# {MIT}\nx = = 1\n", r"docs/syntax.py:2: .*python3 cannot read it"),
    ("docs/two.py", f"# {MIT}\ndef f(): pass\ndef f(): pass\n", r"docs/two.py:3: f stands here twice"),
    ("src/x/b/c.h", f"/* {MIT} */\n#ifndef SRC_X_B_C_H\n#define SRC_X_B_C_H\nenum c {{\n\tONE, /* THREE */\n\tTWO = 2,\n}};\n"
                  "int c(void);\n#endif\n", None),
    ("docs/c.3", f'.\\" {MIT}\n.TH C 3 "" "c" "Library functions"\n.SH NAME\nc \\- more\n.SH SYNOPSIS\n'
                 ".B #include <c.h>\n.SH CODES\nc() returns ONE.\n", r"docs/c.3:1: c.h has TWO: say what it is"),
    ("docs/bad.json", "{\n1}\n", r"docs/bad.json:2: .*make it JSON"),
    ("docs/bad.svg", "<svg>\n<g>\n</svg>\n", r"docs/bad.svg:3: .*make it XML"),
    ("docs/bad.sh", f"#!/bin/sh\n# {MIT}\nif true; then\n", r"docs/bad.sh:\d+: .*sh cannot read it"),
    ("src/x/b/up.c", f'{HEAD}#include "src/x/a/a.h"\n', r"src/x/b/up.c:3: src/x/b may not use src/x/a"),
    ("src/x/a/nosy.c", f'{HEAD}#include "src/x/a/part/state.h"\n',
     r"src/x/a/nosy.c:3: this header is private to src/x/a/part"),
    ("src/x/a/home.h", f"/* {MIT} */\n#ifndef SRC_X_A_HOME_H\n#define SRC_X_A_HOME_H\nint a(void);\n#endif\n",
     r"src/x/a/home.h:4: a\(\) stands in src/x/a/a.c"),
    ("src/x/a/alone.h", f"/* {MIT} */\n#ifndef SRC_X_A_ALONE_H\n#define SRC_X_A_ALONE_H\nuint8_t y(void);\n#endif\n",
     r"src/x/a/alone.h:4: .*include what the header uses"),
    ("src/x/a/only.h", f'/* {MIT} */\n#ifndef SRC_X_A_ONLY_H\n#define SRC_X_A_ONLY_H\n#include "src/x/a/a.h"\n#endif\n',
     r"src/x/a/only.h:1: only includes other headers"),
    ("src/x/a/loose.c", f'{HEAD}#include "a.h"\n', r"src/x/a/loose.c:3: a.h is no path from the top"),
    ("src/faces/mqtt/bare.c", f"{HEAD}\nint bare(void)\n{{\n\treturn 0;\n}}\n",
     r"src/faces/mqtt/bare.c:1: no unit test names a function of it, nor of 100 % of the lines of src/faces/mqtt"),
    ("src/x/c/new.c", HEAD, r"src/x/c/new.c:1: tests/lint/rooms.txt has no room src/x/c"),
    ("src/daemon/engine/talk.c", f'{HEAD}#include <sys/socket.h>\n', r"src/daemon/engine/talk.c:3: <sys/socket.h> waits"),
    ("src/daemon/engine/part/talk.c", f'{HEAD}#include <sys/socket.h>\n', r"src/daemon/engine/part/talk.c:3: <sys/socket.h> waits"),
    ("src/daemon/engine/say.c", f'{HEAD}\nint s(void)\n{{\n\treturn printf("x");\n}}\n', r"src/daemon/engine/say.c:6: printf\(\.\.\.\) is input or output"),
    ("tests/system/test_lost.py", f"# {MIT}\n", r"tests/system/test_lost.py:1: no suite runs it"),
    ("tests/suites", ODD, r"tests/suites:9: odd stands on no rung"),
    ("tests/suites", ODD, r"tests/suites:1: a change of src/x/b asks for no suite of system tests"),
    ("tests/suites", f"# {MIT}\n{SUITES}  gone\n", r"tests/suites:2: some names the test gone"),
]


class Made:
    """A tree of the test's own."""

    def __init__(self, scene):
        self.path = scene.path / "tree"
        for name, text in CLEAN.items():
            self.write(name, text)
        shutil.copy(SOURCE / ".clang-format", self.path)

    def write(self, name, text):
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def lint(self, *options):
        done = subprocess.run([sys.executable, SOURCE / "tests/lint/run", *options, self.path],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE)
        assert not done.stderr, done.stderr
        return done.stdout, done.returncode


def test_a_tree_without_faults_has_no_finding(scene):
    said, status = Made(scene).lint()
    assert status == 0 and re.search(r"^\d\d passed, 0 failed(, \d+ skipped)?$", said.splitlines()[-1]), said


def test_each_fault_is_found_where_it_is(scene):
    tree, missing = Made(scene), []
    for name, text, _ in FAULTS[:-1]:
        tree.write(name, text)
    said, status = tree.lint()
    wanted = [pattern for _, _, pattern in FAULTS[:-1] if pattern]
    tree.write(*FAULTS[-1][:2])
    said += tree.lint()[0]
    for pattern in [*wanted, FAULTS[-1][2]]:
        skipped = "skip c is laid out" in said and "laid out" in pattern
        if not skipped and not re.search("^.*" + pattern, said, re.M):
            missing.append(pattern)
    assert not missing and status == 1, (missing, said)


def test_a_circle_is_told_with_what_makes_it(scene):
    tree = Made(scene)
    tree.write("src/x/b/b.c", CLEAN["src/x/b/b.c"].replace('"\n\n', '"\n#include "src/x/a/a.h"\n\n').replace("1;", "a();"))
    said, status = tree.lint()
    assert "src/x/a/a.c:1: a circle: src/x/a/a.c -> src/x/b/b.c (b) -> src/x/a/a.c (a)" in said and status == 1, said


def test_data_and_headers_make_circles_too(scene):
    tree = Made(scene)
    tree.write("src/x/b/one.c", f"{HEAD}int shared = 1;\nextern int other;\nint one(void)\n{{\n\treturn other;\n}}\n")
    tree.write("src/x/b/two.c", f"{HEAD}int other = 1;\nextern int shared;\nint two(void)\n{{\n\treturn shared;\n}}\n")
    said, _ = tree.lint()
    assert "src/x/b/one.c -> src/x/b/two.c (other) -> src/x/b/one.c (shared)" in said, said


def test_mend_mends_layout_and_blanks(scene):
    tree = Made(scene)
    tree.write("src/x/b/b.c", CLEAN["src/x/b/b.c"].replace("\treturn 1;", "  return   1; ") + "\n\n")
    assert tree.lint()[1] == 1
    if "skip c is laid out" in tree.lint()[0]:
        owsdtest.skip("no clang-format of the right version")
    assert tree.lint("--mend")[1] == 0
    assert (tree.path / "src/x/b/b.c").read_text() == CLEAN["src/x/b/b.c"]
    assert tree.lint()[1] == 0


if __name__ == "__main__":
    owsdtest.main()
