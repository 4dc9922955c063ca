#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the programs are compiled and linked with, and that it is Unity who runs the unit tests and counts
them."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess

import owsdtest
from owsdtest import BUILD, SOURCE, skip

UNIT = sorted((SOURCE / "tests/unit").glob("*/test_*.c"))
SUMMARY = re.compile(r"^(\d+) Tests (\d+) Failures (\d+) Ignored", re.M)
# These libraries as the linker knows them, and what we call in them
LIBRARIES = {"libi2c": ("libi2c.so.", "i2c_smbus_"), "libgpiod": ("libgpiod.so.", "gpiod_"),
             "libusb": ("libusb-1.0.so.", "libusb_")}


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
    words = (BUILD / "with/libraries").read_text().split()
    return dict(zip(words[::2], words[1::2]))


def test_the_programs_have_no_line_of_the_simulator_but_those_that_are_named_so(_scene):
    def defined(*files):
        return {words[-1] for words in map(str.split, output("nm", "--defined-only", *files).splitlines())
                if len(words) == 3 and words[1] in "TDRBVW"}
    simulator = defined(*(BUILD / "hal/sim").rglob("*.o")) - defined(BUILD / "hal/bus/table.o")
    assert "sim_bus" in simulator and simulator & defined(BUILD / "owsd-sim") > {"sim_bus", "sim_master"}
    for program in [BUILD / "owsctl", BUILD / "owsd", *BUILD.glob("owsd-*")]:
        if not program.name.endswith("-sim") and "gpiod" not in program.name:
            assert not simulator & defined(program), (program, sorted(simulator & defined(program)))


def test_the_programs_link_the_libraries_of_adapters(scene):
    said = found()
    for name, (soname, prefix) in LIBRARIES.items():
        for program in (owsdtest.OWSD, owsdtest.OWSCTL):
            has = any(n.startswith(soname) for n in needed(program))
            assert has == (said[name] != "no"), f"{program}: {needed(program)}, makefile: {said}"
            calls = [s for s in output("nm", "-D", "-u", program).split() if s.startswith(prefix)]
            assert bool(calls) == has, f"{program} links {name} and calls {calls}"


def test_owsd_mqtt_alone_links_libmosquitto(scene):
    has = found()["libmosquitto"] == "yes"
    assert (BUILD / "owsd-mqtt").exists() == has, found()
    for name in ("owsd", "owsctl", *(["owsd-mqtt"] if has else [])):
        links = any(n.startswith("libmosquitto") for n in needed(BUILD / name))
        assert links == (name == "owsd-mqtt"), f"{name}: {needed(BUILD / name)}"


def test_two_faces_alone_link_a_library_of_the_network(scene):
    has = found()["libcurl"] == "yes"
    assert (BUILD / "owsd-influx").exists() == has, found()
    if os.path.exists("/usr/include/curl/curl.h") or list(pathlib.Path("/usr/include").glob("*/curl/curl.h")):
        assert has, "curl/curl.h is here; was LIBCURL=0 given?"
    for name in ("owsd", "owsctl", *(["owsd-influx", "owsd-notify"] if has else [])):
        links = any(n.startswith("libcurl") for n in needed(BUILD / name))
        assert links == (name in ("owsd-influx", "owsd-notify")), f"{name}: {needed(BUILD / name)}"


def test_sqlite_is_linked_by_what_has_to_do_with_history_alone(scene):
    has = found()["libsqlite3"] == "yes"
    assert (BUILD / "owsd-recorder").exists() == has, found()
    if os.path.exists("/usr/include/sqlite3.h"):
        assert has, "sqlite3.h is here; was LIBSQLITE3=0 given?"
    for name in ("owsd", "owsctl", "owsd-writer", *(["owsd-recorder"] if has else [])):
        links = any(n.startswith("libsqlite3") for n in needed(BUILD / name))
        assert links == (has and name in ("owsctl", "owsd-recorder")), f"{name}: {needed(BUILD / name)}"


def test_owsd_web_alone_links_a_library_for_the_network(scene):
    if found()["libmicrohttpd"] == "no":
        assert not (BUILD / "owsd-web").exists()
        skip("there is no libmicrohttpd here: owsd-web is left out")
    for program in ("owsd", "owsctl", "owsd-web"):
        has = any(name.startswith("libmicrohttpd.so.") for name in needed(BUILD / program))
        assert has == (program == "owsd-web"), (program, needed(BUILD / program))


# KiB of text and data of a face, as size counts; and the most that it may be
FACES = {"owsd-influx": 200, "owsd-modbus": 204, "owsd-notify": 208, "owsd-recorder": 212, "owsd-mqtt": 328,
         "owsd-web": 384}


def test_a_face_has_no_family_of_chips_and_no_bus(_scene):
    def symbols(kinds, *files):
        lines = output("nm", "--defined-only", *files).splitlines()
        return {w[-1] for w in map(str.split, lines) if len(w) == 3 and w[1] in kinds}
    rooms = [o for part in ("chips", "bus", "native", "owserver", "w1", "netlink", "ds2482", "gpio")
             for o in (BUILD / "hal" / part).rglob("*.o")]
    below = symbols("TDRBVW", *rooms)
    assert {"family_of", "bus_create", "bus_backends", "owserver_bus", "i2c_bus"} <= below, len(below)
    assert below & symbols("TDRBVW", owsdtest.OWSD) >= {"family_of", "bus_create"}
    faces = [BUILD / name for name in FACES if (BUILD / name).exists()]
    assert faces
    for face in faces:
        assert not below & symbols("TDRBVW", face), (face.name, sorted(below & symbols("TDRBVW", face)))


def test_a_face_is_small(_scene):
    """As it is compiled for a user: a sanitizer, another rule of optimizing make it another size."""
    flags = (BUILD / "with/cc").read_text().split()
    if "-O2" not in flags or any(f.startswith(("-fsanitize", "-O0", "--coverage", "-m32")) for f in flags):
        skip("compiled otherwise than for a user")
    if not shutil.which("size"):
        skip("no size here (package binutils)")
    for name, most in FACES.items():
        if (BUILD / name).exists():
            text, data = map(int, output("size", BUILD / name).splitlines()[1].split()[:2])
            assert text + data <= most * 1024, f"{name}: {text + data} bytes, at most {most} KiB"


def test_the_tables_of_the_chip_families_stand_in_read_only_memory(scene):
    """A pointer in a row would move the whole table to memory that each process has for itself."""
    tables = 0
    for built in (BUILD / "hal/chips").rglob("*.o"):
        for kind in re.findall(r" ([a-zA-Z]) properties$", output("nm", built), re.M):
            assert kind == "r", f"{built.name}: nm says {kind} of its table"
            tables += 1
    assert tables >= 15, tables


def test_the_makefile_found_what_is_installed(scene):
    said = found()
    for name, header in (("libi2c", "i2c/smbus.h"), ("libgpiod", "gpiod.h"),
                         ("libusb", "libusb-1.0/libusb.h"), ("libmicrohttpd", "microhttpd.h")):
        if os.path.exists(f"/usr/include/{header}"):
            assert said[name] != "no", f"{header} is here; was {name.upper()}=0 given?"
    version = owsdtest.OWSD
    told = subprocess.run([version, "-V"], capture_output=True, text=True,
                          timeout=owsdtest.PATIENCE).stdout
    assert ("with libi2c" in told) == (said["libi2c"] != "no"), told
    assert ("with libusb" in told) == (said["libusb"] != "no"), told
    generation = re.search(r"with libgpiod (\d)", told)
    assert (generation.group(1) if generation else "no") == said["libgpiod"], told
    manual = (SOURCE / "docs/owsd.8").read_text()
    for name in re.findall(r"^with(?:out)? (lib\w+)", told, re.M):
        assert name in manual.split("\\-\\-version")[1].split(".TP")[0], f"owsd(8), -V, does not have {name}"
    asked = re.search(r"`owsd -V` say `(.*?)`", (SOURCE / "docs/doctor.md").read_text())[1]
    assert (asked in told) == (said["libi2c"] != "no"), (asked, told)


class Compiler:
    """The one that has built the programs, with its flags."""

    def __init__(self):
        command, _, flags = (BUILD / "with/cc").read_text().split(": ", 2)
        self.command, self.flags = shlex.split(command), shlex.split(flags)
        if not shutil.which(self.command[0]):
            skip(f"no {self.command[0]} here any more")
        self.machine = [flag for flag in self.flags if flag.startswith("-m") and "=" not in flag]

    def _asked(self, *flags):
        return subprocess.run([*self.command, *flags, "-x", "c", "-"], input="#include <stdint.h>\n", text=True,
                              capture_output=True, timeout=owsdtest.PATIENCE, cwd=SOURCE, check=False)

    def has(self, *flags):
        return self._asked(*self.machine, "-Werror", "-O2", *flags, "-S", "-o", os.devnull).returncode == 0

    def fortified(self):
        """What the library's headers make of it."""
        level = re.search(r"__USE_FORTIFY_LEVEL (\d)", self._asked(*self.flags, "-E", "-dM").stdout)
        return int(level.group(1)) if level else 0


def test_each_protection_that_the_compiler_has_is_taken(scene):
    compiler = Compiler()
    for flag in ("-fstack-protector-strong", "-fstack-clash-protection", "-fcf-protection",
                 "-mbranch-protection=standard"):
        assert (flag in compiler.flags) == compiler.has(flag), (flag, compiler.flags)
    if "-O0" in compiler.flags:
        skip("without optimisation the calls of the library are not checked")
    glibc = compiler.has("-include", "gnu/libc-version.h")
    best = 3 if compiler.has("-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=3") else 2
    assert compiler.fortified() == (best if glibc else 0), compiler.flags


def test_the_objects_and_programs_have_the_protections(scene):
    flags = Compiler().flags
    notes = output("readelf", "-n", BUILD / "core.a")
    for flag, note in (("-fcf-protection", "x86 feature: IBT, SHSTK"),
                       ("-mbranch-protection=standard", "AArch64 feature: BTI, PAC")):
        for member in notes.split("File: ")[1:] if flag in flags else ():
            assert note in member, f"{member}\nwithout {note}"
    # as gcc writes it down
    for line in re.findall(r"DW_AT_producer.*: (GNU C.*)",
                           output("readelf", "--debug-dump=info", "--dwarf-depth=1", BUILD / "core.a")):
        for flag in ("-fstack-protector-strong", "-fstack-clash-protection"):
            assert (flag in line) == (flag in flags), line
    for program in (owsdtest.OWSD, owsdtest.OWSCTL, BUILD / "libows.so"):
        stack = re.search(r"GNU_STACK .*?\s(R\S*)\s+0x\w+$", output("readelf", "-lW", program), re.M)
        assert stack and stack.group(1) == "RW", f"{program}: its stack is {stack and stack.group(1)}"
        assert "GNU_RELRO" in output("readelf", "-lW", program), program
        assert re.search(r"FLAGS.*NOW", output("readelf", "-d", program)), program
        assert re.search(r"Type:\s+DYN", output("readelf", "-h", program)), program
        if Compiler().fortified():
            assert "__snprintf_chk" in output("nm", "-D", "-u", program), program


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
        run = set(re.findall(r"RUN_TEST\(\s*(test_\w+)\)", text))
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
        source = next(file for file in UNIT if file.stem == program.name).read_text()
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
