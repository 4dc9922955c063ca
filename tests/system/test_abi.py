#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A program that was linked with the libraries of the last release runs with these: abidiff compares functions
and the structures of the public headers. A structure may have more members only in the place of its `spare`.
Planted changes show what is found."""

import os
import pathlib
import re
import shutil
import subprocess

import owsdtest
from owsdtest import SOURCE

LIBRARIES = ("libows", "libows-history")
# abidiff 2.2 takes a structure that has grown at its spare for unchanged: so sizes are compared beside it
SPARE = "[suppress_type]\ntype_kind = struct\nhas_data_member_inserted_at = offset_of(spare)\n"


def git(*words):
    """What git prints, None without a repository or without what was asked for."""
    done = subprocess.run(["git", "-C", SOURCE, *words], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else None


class Tree:
    """The sources of the libraries at a place, and what they become."""

    def __init__(self, path):
        self.path = path
        text = (path / "Makefile").read_text()
        self.version, self.so = (re.search(rf"^{name} *:= *(\S+)", text, re.M)[1] for name in ("VERSION", "SOMAJOR"))

    def make(self):
        wanted = [f"build/{name}.so.{self.version}" for name in LIBRARIES]
        without = {"MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKEOVERRIDES", "B", "CFLAGS", "EXTRA_CFLAGS"}
        done = subprocess.run(["make", "-s", f"-j{os.cpu_count()}", "CFLAGS=-O0 -g", *wanted], cwd=self.path, text=True,
                              capture_output=True, timeout=500, check=False,
                              env={k: v for k, v in os.environ.items() if k not in without})
        assert done.returncode == 0, done.stderr
        return self

    def sizes(self):
        """The bytes of each structure of the public headers."""
        headers = [self.path / f"src/public/{name}" for name in ("ows.h", "ows_history.h")]
        names = [name for header in headers for name in re.findall(r"^struct (\w+) \{", header.read_text(), re.M)]
        code = "".join(f'#include "{header}"\n' for header in headers) + "#include <stdio.h>\nint main(void)\n{\n" + \
            "".join(f'printf("%zu\\n", sizeof(struct {name}));\n' for name in names) + "return 0;\n}\n"
        (self.path / "sizes.c").write_text(code)
        subprocess.run([os.environ.get("CC", "cc").split()[-1], "-o", "sizes", "sizes.c"], cwd=self.path, check=True, timeout=100)
        said = subprocess.run([self.path / "sizes"], capture_output=True, text=True, check=True, timeout=100).stdout
        return dict(zip(names, said.split()))

    def library(self, name):
        return self.path / f"build/{name}.so.{self.version}"


def of_today(path):
    """A copy of this tree's sources."""
    path.mkdir()
    shutil.copytree(SOURCE, path, dirs_exist_ok=True, ignore=lambda at, names: {
        n for n in names if (pathlib.Path(at) == SOURCE and n not in ("Makefile", "src", "hal", "board", "tests"))
        or n == "__pycache__"})
    return Tree(path)


def broken(old, new):
    """What a program that was linked with the old tree's libraries would find changed in the new tree's."""
    had, has = old.sizes(), new.sizes()
    found = "".join(f"struct {name} has {has.get(name)} bytes, had {had[name]}\n" for name in had if had[name] != has.get(name))
    spare = new.path / "spare.abignore"
    spare.write_text(SPARE)
    for name in LIBRARIES:
        done = subprocess.run(["abidiff", "--no-added-syms", "--suppressions", spare,
                               "--headers-dir1", old.path / "src/public", "--headers-dir2", new.path / "src/public",
                               old.library(name), new.library(name)],
                              capture_output=True, text=True, timeout=200, check=False)
        assert done.returncode in (0, 4, 12), done.stdout + done.stderr
        found += done.stdout if done.returncode else ""
    return found


def needs_abidiff():
    if not shutil.which("abidiff"):
        owsdtest.skip("no abidiff here (sh board/install-deps abi)")


def test_programs_of_the_last_release_run_with_these_libraries(scene):
    needs_abidiff()
    if git("rev-parse", "--show-toplevel") != str(SOURCE.resolve()):
        owsdtest.skip("this tree is no git repository, which has the last release")
    tag = git("describe", "--tags", "--abbrev=0", "--match", "v[0-9]*", "HEAD^")
    if not tag:
        owsdtest.skip("no tag v... before this commit: there is no release to compare with")
    (scene.path / "old").mkdir()
    archive = subprocess.run(["git", "-C", SOURCE, "archive", tag], stdout=subprocess.PIPE, check=True).stdout
    subprocess.run(["tar", "-x", "-C", scene.path / "old"], input=archive, check=True)
    old, new = Tree(scene.path / "old"), of_today(scene.path / "new")
    if old.so == new.so:
        found = broken(old.make(), new.make())
        assert not found, f"since {tag}, which has libows.so.{old.so} too:\n{found}"


def changed(file, *pairs):
    text = file.read_text()
    for old, new in pairs:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    file.write_text(text)


def test_a_change_that_breaks_programs_is_found_and_no_other(scene):
    needs_abidiff()
    today, planted = of_today(scene.path / "today").make(), of_today(scene.path / "planted")
    header, code = planted.path / "src/public/ows.h", planted.path / "src/memory/libows/get.c"
    code.write_text(code.read_text() + "int ows_planted(void);\nint ows_planted(void) { return 0; }\n")
    member = re.search(r"^\tuint64_t wire; .*$", header.read_text(), re.M)[0]
    changed(header, (f"{member}\n\tuint64_t spare[3];", f"{member}\n\tint64_t planted;\n\tuint64_t spare[2];"))
    planted.make()
    assert broken(today, planted) == ""
    assert re.search(r"1 Removed function\b.*ows_planted", broken(planted, today), re.S)
    changed(header, ("struct ows_value {\n", "struct ows_value {\n\tdouble planted;\n"),
            ("nowhere */\n\tuint64_t spare[2];", "nowhere */\n\tlong grown;\n\tuint64_t spare[2];"))
    found = broken(today, planted.make())
    assert "'double planted'" in found and "struct ows_info has" in found, found


if __name__ == "__main__":
    owsdtest.main()
