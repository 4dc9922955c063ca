#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the programs are linked with, and that it is Unity who runs the unit tests and counts them."""

import os
import re
import shutil
import subprocess

import owsdtest
from owsdtest import BUILD, SOURCE, skip

UNIT = sorted((SOURCE / "tests/unit").glob("test_*.c"))
SUMMARY = re.compile(r"^(\d+) Tests (\d+) Failures (\d+) Ignored", re.M)
# libi2c and libgpiod as the linker knows them, and what we call in them
LIBRARIES = {"libi2c": ("libi2c.so.", "i2c_smbus_"), "libgpiod": ("libgpiod.so.", "gpiod_")}


def output(*command):
    for program in ("readelf", "nm"):
        if command[0] == program and not shutil.which(program):
            skip(f"no {program} here (package binutils)")
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True,
                          timeout=owsdtest.PATIENCE).stdout


def needed(file):
    return re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-d", file))


def found():
    """{"libi2c": "yes" or "no", "libgpiod": "1", "2" or "no"}, as the makefile said it."""
    words = (BUILD / "libraries").read_text().split()
    return dict(zip(words[::2], words[1::2]))


def test_the_programs_link_libi2c_and_libgpiod(scene):
    said = found()
    for name, (soname, prefix) in LIBRARIES.items():
        for program in (owsdtest.OWSD, owsdtest.OWSCTL):
            has = any(n.startswith(soname) for n in needed(program))
            assert has == (said[name] != "no"), f"{program}: {needed(program)}, makefile: {said}"
            calls = [s for s in output("nm", "-D", "-u", program).split() if s.startswith(prefix)]
            assert bool(calls) == has, f"{program} links {name} and calls {calls}"


def test_the_makefile_found_what_is_installed(scene):
    said = found()
    for name, header in (("libi2c", "i2c/smbus.h"), ("libgpiod", "gpiod.h")):
        if os.path.exists(f"/usr/include/{header}"):
            assert said[name] != "no", f"{header} is here; was {name.upper()}=0 given?"
    version = owsdtest.OWSD
    told = subprocess.run([version, "-V"], capture_output=True, text=True,
                          timeout=owsdtest.PATIENCE).stdout
    assert ("with libi2c" in told) == (said["libi2c"] != "no"), told
    generation = re.search(r"with libgpiod (\d)", told)
    assert (generation.group(1) if generation else "no") == said["libgpiod"], told


def test_the_library_of_the_consumers_links_nothing_but_libc(scene):
    allowed = ("libc.so.", "libm.so.", "ld-linux", "libpthread.so.", "libasan", "libubsan", "libtsan",
               "libgcc_s", "libgcov")
    for name in needed(BUILD / "libows.so"):
        assert name.startswith(allowed), name


def test_every_unit_program_has_unity_and_none_is_missing(scene):
    programs = [BUILD / "unit" / file.stem for file in UNIT]
    if not any(p.exists() for p in programs):
        skip("the unit tests are not built (make unit)")
    for program in programs:
        assert program.exists(), f"{program.name}: there is a source and no program"
        symbols = set(output("nm", program).split())
        for symbol in ("UnityBegin", "UnityEnd", "UnityDefaultTestRun", "UnityConcludeTest"):
            assert symbol in symbols, f"{program.name} has no {symbol}"


def test_every_test_of_a_file_is_run_by_unity(scene):
    for file in UNIT:
        text = file.read_text()
        # a table of tests may be built by a macro: those files count themselves
        functions = set(re.findall(r"^(?:static )?void (test_\w+)\(void\)", text, re.M))
        run = set(re.findall(r"RUN_TEST\((test_\w+)\)", text))
        assert functions - run == set(), f"{file.name}: {functions - run} never run"
        assert "UNITY_BEGIN" in text and "UNITY_END" in text, file.name


def counted(*programs):
    done = subprocess.run(["sh", str(SOURCE / "tests/unit/run"), *map(str, programs)],
                          capture_output=True, text=True, timeout=200)
    return done.returncode, done.stdout.splitlines()[-1]


def test_the_count_of_a_run_is_that_of_unitys_summary(scene):
    programs = [BUILD / "unit" / name for name in ("test_table_3_1", "test_alarm_fsm", "test_printable")]
    if not programs[0].exists():
        skip("the unit tests are not built (make unit)")
    total = 0
    for program in programs:
        said = subprocess.run([program], cwd=SOURCE, capture_output=True, text=True,
                              timeout=200)
        tests, failures, ignored = map(int, SUMMARY.search(said.stdout).groups())
        source = (SOURCE / "tests/unit" / (program.name + ".c")).read_text()
        assert tests == source.count("RUN_TEST("), program.name
        assert (failures, ignored) == (0, 0)
        total += tests
    done = subprocess.run(["sh", "tests/unit/run", *map(str, programs)], cwd=SOURCE,
                          capture_output=True, text=True, timeout=200)
    assert done.stdout.splitlines()[-1] == f"{total} passed, 0 failed", done.stdout


def test_a_unit_program_that_says_nothing_or_lies_has_failed(scene):
    def program(name, text):
        path = scene.file(name, "#!/bin/sh\n" + text)
        os.chmod(path, 0o755)
        return path

    good = program("good", "echo '3 Tests 0 Failures 1 Ignored'\n")
    bad = program("bad", "echo '3 Tests 2 Failures 0 Ignored'\nexit 2\n")
    silent = program("silent", "exit 0\n")
    liar = program("liar", "echo '3 Tests 0 Failures 0 Ignored'\nexit 1\n")
    empty = program("empty", "echo '0 Tests 0 Failures 0 Ignored'\n")
    crash = program("crash", "echo 'a:1:test_b:PASS'\nkill -SEGV $$\n")
    assert counted(good) == (0, "2 passed, 0 failed, 1 skipped")
    assert counted(good, bad) == (1, "3 passed, 2 failed, 1 skipped")
    assert counted(silent) == (1, "0 passed, 1 failed")
    assert counted(liar) == (1, "3 passed, 1 failed")
    assert counted(empty) == (1, "0 passed, 1 failed")
    assert counted(crash) == (1, "0 passed, 1 failed")


if __name__ == "__main__":
    owsdtest.main()
