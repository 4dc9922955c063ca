#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make after a change of compiler, flags or libraries leaves what a clean build would have made,
and makes nothing that is so already. The compiler here writes down how it was called, so that
every rule of the makefiles is tried, on a tree with some of the sources."""

import os
import pathlib
import re
import shutil
import subprocess

import owsdtest
from owsdtest import SOURCE

COMPILER = r"""#!/bin/sh
here=$(dirname "$0")
case $1 in --version) cat "$here/version"; exit ;; -print-multiarch | -dumpmachine) exit ;; esac
out='' before=''
for word; do
    [ "$before" != -o ] || out=$word
    before=$word
done
if [ "$out" = /dev/null ]; then
    case "$*" in
    *-li2c*) test -e "$here/libi2c" ;;
    *-lgpiod*) grep -q -f "$here/libgpiod" - 2>/dev/null ;;
    esac
    exit
fi
echo "$out" >>"$here/calls"
{
    echo "$0 $*"
    cat "$here/version"
    for word; do
        case $word in "$out") ;; *.o | *.a) cksum <"$word" ;; esac
    done
} >"$out.new"
mv "$out.new" "$out"
"""
ARCHIVER = """#!/bin/sh
out=$2
shift 2
cat "$@" | cksum >"$out"
"""
MAKEFILES = ["Makefile", "board/faces", *(p.relative_to(SOURCE) for p in SOURCE.glob("tests/*/*.mk"))]
TARGETS = ["all", "examples", "unit-programs", "benches", "kernel-programs"]
# FILE of B for each source
OTHERS = {"system/{}": "tests/system/*.c", "system/{}.so": "tests/system/preload/*.c"}
MORE = ["reader.c", "control.cpp", "bench_shm_get.c", "fuzz.c", "replay.c", "fuzz_rio.c", "fuzz_serve.c"]
PROGRAMS = ["model/model", "kernel/endurance", "kernel/busdump", "gpiod-2/owsd"]


class Tree:
    """Some sources of each folder, and all that a makefile names."""

    def __init__(self, scene):
        self.path = scene.path / "tree"
        self.tools = scene.path / "tools"
        self.tools.mkdir()
        named = ""
        for name in MAKEFILES:
            self._copy(SOURCE / name)
            named += (SOURCE / name).read_text()
        # as endurance_truth, fuzz/heap_map.o, src/memory/shm/image.c
        words = set(re.findall(r"\w+", named))
        for top in ("src", "hal", "tests", "docs/examples"):
            for folder, _, names in os.walk(SOURCE / top):
                sources = sorted(n for n in names if n.endswith((".c", ".cpp")))
                for name in names:
                    file = pathlib.Path(folder, name)
                    is_named = file.stem in words if top == "tests" else str(file.relative_to(SOURCE)) in named
                    is_main = name.startswith("owsd_")  # of a face, by board/faces
                    if name in sources[:1] or name in MORE or is_main or file.suffix == ".proto" or \
                            is_named and file.suffix in (".c", ".h"):
                        self._copy(file)
        (self.path / "unity").mkdir()
        for name in ("unity.c", "unity.h"):
            (self.path / "unity" / name).touch()
        for name in ("cc", "cc2", "c++", "c++2"):
            self._tool(name, COMPILER)
        self._tool("ar", ARCHIVER)
        self.tool_files()
        targets = [*TARGETS, *(f"b/{name}" for name in PROGRAMS)]
        for name, pattern in OTHERS.items():
            targets += [f"b/{name.format(p.stem)}" for p in self.path.glob(pattern)]
        targets += [f"b/fuzz/{p.stem[5:]}" for p in self.path.glob("tests/fuzz/fuzz_*.c")]
        self.targets = targets

    def _copy(self, file):
        to = self.path / file.relative_to(SOURCE)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, to)

    def _tool(self, name, text):
        (self.tools / name).write_text(text)
        (self.tools / name).chmod(0o755)

    def tool_files(self):
        """The version of the compiler, and no library beside it."""
        (self.tools / "version").write_text("some compiler 1\n")
        for name in ("libi2c", "libgpiod"):
            (self.tools / name).unlink(missing_ok=True)

    def make(self, *variables, targets=None):
        """What was compiled and linked."""
        calls = self.tools / "calls"
        calls.write_text("")
        env = {key: value for key, value in os.environ.items() if key in ("PATH", "HOME", "TMPDIR", "LC_ALL")}
        command = ["make", "-s", "-j4", "B=b", "UNITY=unity", "PKG_CONFIG=false", f"CC={self.tools}/cc",
                   f"CXX={self.tools}/c++", f"AR={self.tools}/ar", "OBJCOPY=true", *variables,
                   *(targets or self.targets)]
        done = subprocess.run(command, cwd=self.path, env=env, capture_output=True, text=True,
                              timeout=owsdtest.PATIENCE)
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
        return sorted(calls.read_text().split())

    def made(self):
        return {str(p.relative_to(self.path)): p.read_text() for p in (self.path / "b").rglob("*")
                if p.is_file() and not p.is_symlink() and p.suffix not in (".dict", ".pc", ".gz")}

    def made_clean(self, *variables):
        shutil.rmtree(self.path / "b", ignore_errors=True)
        self.make(*variables)
        return self.made()


def differing(wanted, made):
    return sorted(name for name in wanted if wanted[name] != made.get(name))


# What a change is: variables, or files of the tools
CHANGES = {
    "CC": lambda tree: ([f"CC={tree.tools}/cc2"], {}),
    "another version of the compiler": lambda tree: ([], {"version": "some compiler 2\n"}),
    "CXX": lambda tree: ([f"CXX={tree.tools}/c++2"], {}),
    "CFLAGS": lambda tree: (["CFLAGS=-O3 -DWORDS='\"two words\"'"], {}),
    "CXXFLAGS": lambda tree: (["CXXFLAGS=-O3"], {}),
    "EXTRA_CFLAGS": lambda tree: (["EXTRA_CFLAGS=-fsanitize=thread"], {}),
    "CPPFLAGS": lambda tree: (["CPPFLAGS=-DX=1"], {}),
    "LDFLAGS": lambda tree: (["LDFLAGS=-Wl,-z,x"], {}),
    "WERROR": lambda tree: (["WERROR=1"], {}),
    "VERSION": lambda tree: (["VERSION=9.9.9"], {}),
    "libi2c is installed": lambda tree: ([], {"libi2c": ""}),
    "libgpiod 1 is installed": lambda tree: ([], {"libgpiod": "gpiod_chip_name"}),
    "libgpiod 2 is installed": lambda tree: ([], {"libgpiod": "gpiod_chip_get_info"}),
    "LIBI2C": lambda tree: (["LIBI2C=1"], {}),
    "LIBGPIOD": lambda tree: (["LIBGPIOD=2"], {}),
}
# Where only some of it is made again: no object in C, and no object at all
SOME = {"CXX": r"examples/", "CXXFLAGS": r"examples/", "LDFLAGS": r"(?!.*\.o$)"}

# They have some of the flags, and are made again for all of them
WITHOUT_ALL = {"b/unit/unity.o"} | {f"b/system/{p.stem}.so" for p in (SOURCE / "tests/system/preload").glob("*.c")}


def test_what_a_change_touches_is_made_again_and_nothing_else(scene):
    tree = Tree(scene)
    plain = tree.made_clean()
    assert len(plain) > 100, sorted(plain)
    for suffix in ("/owsd", "/libows.a", "/unit/unity.o", "/unit/test_endurance", "/kernel/simchip", "/model/model",
                   "/bench/bench_shm_get", "/system/bus", "/gpiod-2/library.o", "/src/memory/shm/image.o"):
        assert any(name.endswith(suffix) for name in plain), f"no {suffix}"
    assert any(n.startswith("b/system/") and n.endswith(".so") for n in plain)
    assert not tree.make(), "nothing has changed"
    shutil.copytree(tree.path / "b", tree.path / "plain", symlinks=True)
    for what, change in CHANGES.items():
        variables, files = change(tree)
        for name, text in files.items():
            (tree.tools / name).write_text(text)
        again = tree.make(*variables)
        made = tree.made()
        needless = {name for name in again if made[name] == plain.get(name)} - WITHOUT_ALL
        assert again, f"{what} changes nothing"
        assert again == sorted(set(again)), f"{what}: made twice: {again}"
        assert not needless, f"{what}: needlessly made: {needless}"
        if what in SOME:
            assert all(re.match(r"b/(" + SOME[what] + ")", name) for name in again), (what, again)
        assert not tree.make(*variables), f"{what}: nothing has changed since"
        clean = tree.made_clean(*variables)
        assert not (old := differing(clean, made)), f"{what}: as before in {old}"
        tree.tool_files()
        shutil.rmtree(tree.path / "b")
        shutil.copytree(tree.path / "plain", tree.path / "b", symlinks=True)
    assert not tree.make(), "the copies are as new as the files were"
    tree.make("WERROR=1")
    tree.make()
    assert not (old := differing(plain, tree.made())), f"changed back: as changed in {old}"


def test_make_without_a_goal_makes_the_programs(scene):
    tree = Tree(scene)
    tree.make(targets=["V=0"])
    for name in ("owsd", "owsctl", "libows.a"):
        assert (tree.path / "b" / name).exists(), f"make makes no {name}"
    assert tree.make(targets=["all"]) == [], "make all makes more"


def test_a_warning_that_was_let_through_is_an_error_with_werror(scene):
    tree = Tree(scene)
    (tree.path / "src/memory/shm/warned.c").write_text("int warned(int n);\nint warned(int n) { int x; return 0; }\n")
    command = ["make", "-s", "B=real", "CC=gcc", "LIBI2C=0", "LIBGPIOD=0", "real/src/memory/shm/warned.o"]
    for werror, status in (("0", 0), ("1", 2), ("0", 0)):
        done = subprocess.run([*command, f"WERROR={werror}"], cwd=tree.path, capture_output=True, text=True,
                              timeout=owsdtest.PATIENCE, env={"PATH": os.environ["PATH"]})
        assert done.returncode == status and "unused" in done.stderr, (werror, done)


if __name__ == "__main__":
    owsdtest.main()
