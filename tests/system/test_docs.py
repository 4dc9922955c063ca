#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the documentation says, done: each block of each page is run or checked by its language.

sh, console  run by a shell that finds the programs of standin.py and a few harmless ones, and no
             others; absolute paths lie below a root of the test's own. In a console block the
             output is compared too: numbers and "..." stand for anything
c, cpp       compiled without a warning; whole programs are run, faces beside an owsd
python       run
sql          whole statements; test_history_readers.py runs them
rio, sim     read by owsd --check; by owsctl dir
json         parsed
conf         owfs.conf: keys that the genuine owserver knows
nginx        directives and blocks that end; test_web.py has nginx itself run it
udev         lines that board/udev has
text         anything but commands

Behind them stands an owsd on docs/stage.sim, with the names of docs/stage.rio. Besides: links lead
somewhere, files that are named exist, and a command within a sentence has an option that exists.
"""

import collections
import contextlib
import json
import os
import re
import shutil
import socket
import sqlite3
import struct
import subprocess
import sys
import textwrap
import time
import xml.etree.ElementTree

import handbook
import owsdtest
import standin

HERE = standin.HERE
SOURCE = owsdtest.SOURCE
HARMLESS = ("cat chmod cp cut diff env false grep head install ls mkdir mv printf rm sed sleep sort "
            "tail tee test timeout touch tr true wc").split()
BINUTILS = "ar as ld".split()
WARN = ["-Wall", "-Wextra", "-Werror", "-Wno-unused-variable", "-Wno-unused-but-set-variable",
        "-Wno-unused-function", *os.environ.get("EXTRA_CFLAGS", "").split()]
FACE = '"src/faces/kit/loop.h"'
OF_THE_SYSTEM = re.compile(r"(?<![\w./:@$}-])/(boot|dev(?!/(?:null|shm))|etc|sys|usr|var)/")
COMMAND = re.compile(r"(?:sudo +)?(%s)(?: |$)" % "|".join(re.escape(p) for p in standin.PROGRAMS))
PAGES = sorted([SOURCE / n for n in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "NEWS.md")
                if (SOURCE / n).exists()] + list((SOURCE / "docs").glob("*.md")))
MANUALS = sorted((SOURCE / "docs").glob("*.[1-8]"))


class Stage:
    """The place where a page is gone through from top to bottom."""

    def __init__(self, scene, page):
        self.scene, self.path, self.daemon = scene, scene.path, None
        self.root, bin_dir = self.path / "root", self.path / "bin"
        bin_dir.mkdir()
        for program in standin.PROGRAMS:
            (bin_dir / program).symlink_to(HERE / "standin.py")
        for program in HARMLESS + BINUTILS:
            (bin_dir / program).symlink_to(shutil.which(program) or f"/bin/{program}")
        (bin_dir / "python3").symlink_to(sys.executable)
        for name in ("docs", "board", "tests", "src", "hal", "Makefile"):
            (self.path / name).symlink_to(SOURCE / name)
        (self.path / "build").mkdir()
        for name in ("owsd", "owsd-sim", "owsctl", "owsctl-sim"):
            (self.path / "build" / name).symlink_to(HERE / "standin.py")
        (self.path / "build/libows.a").symlink_to(owsdtest.BUILD / "libows.a")
        for name in ("stage.sim", "stage.rio"):
            shutil.copy(HERE / "docs" / name, self.path)
        for name in ("plant.rio", "house.rio", "ow_cfg.rio"):
            shutil.copy(HERE / "docs" / "stage.rio", self.path / name)
        for example in (SOURCE / "docs/examples").glob("*.c*"):
            shutil.copy(example, self.path)
        self._make_examples(page)
        self._make_root()

    def _make_examples(self, page):
        """A page that is called as a folder of the examples begins in that."""
        for name in ("openplc", "linuxcnc"):
            shutil.copytree(SOURCE / "docs/examples" / name, self.path / name)
        self.cwd = self.path / page if page in ("openplc", "linuxcnc") else self.path
        server = self.path / "openplc/OpenPLC_v3/webserver"
        for folder in ("core", "st_files", "scripts"):
            (server / folder).mkdir(parents=True)
        for program in ("scripts/compile_program.sh", "core/openplc"):
            (server / program).symlink_to("/bin/true")

    def _make_root(self):
        """A Raspberry Pi 4 with a DS2482 board, as far as files tell."""
        files = {"proc/device-tree/model": b"Raspberry Pi 4 Model B Rev 1.1\0",
                 "boot/firmware/config.txt": b"dtparam=i2c_arm=on\n", "dev/i2c-1": b"",
                 "sys/bus/i2c/devices/i2c-1/of_node/clock-frequency": struct.pack(">I", 400000),
                 "var/lib/owsd/firstboot.done": b"", "etc/default/owsd": b"",
                 "sys/firmware/devicetree/base/serial-number": b"10000000abcd1234\0",
                 "sys/bus/i2c/drivers/ds2482/unbind": b"",
                 "sys/bus/i2c/devices/i2c-1/delete_device": b""}
        for name, content in files.items():
            file = self.root / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        for name in ("etc/owsd", "etc/udev/rules.d", "usr/share/owsd",
                     "etc/systemd/system/owsd@OWS.service.d"):
            (self.root / name).mkdir(parents=True, exist_ok=True)
        for source, place in (("board/debian/OWS.rio", "etc/owsd/OWS.rio"),
                              ("board/debian/OWS.rio", "usr/share/owsd/OWS.rio"),
                              ("src/memory/libows/ows.py", "usr/share/owsd/ows.py")):
            shutil.copy(SOURCE / source, self.root / place)
        shutil.copytree(SOURCE / "board/systemd/examples",
                        self.root / "usr/share/doc/owsd/examples")

    def owsd(self):
        """The owsd behind the page; its values are there when this returns."""
        if not self.daemon:
            self.port = owsdtest.free_port()
            self.daemon = self.scene.owsd(self.path / "stage.rio", "-l", f"127.0.0.1:{self.port}")
            self.scene.names.append(self.daemon.name + "d")
            self.scene.until(lambda: all(self.scene.get(self.daemon, n) for n in
                                         ("room1", "freezer", "buttons")), 20, "values")
        return self.daemon

    def environment(self):
        self.owsd()
        return {"PATH": str(self.path / "bin"), "STAGE": str(self.path), "NAME": self.daemon.name,
                "SERVED": str(self.port), "HOME": str(self.path), "USER": "user", "LANG": "C.UTF-8",
                "OWSD_SOURCE": str(SOURCE), "OWSD_BUILD": str(owsdtest.BUILD),
                "OWSD_BOARDS": str(SOURCE / "board/boards"), "TMPDIR": str(self.path),
                "LD_LIBRARY_PATH": str(owsdtest.BUILD), "PYTHONPATH": str(owsdtest.PYTHON), "PYTHONDONTWRITEBYTECODE": "1",
                **{k: v for k, v in os.environ.items() if "SAN_OPTIONS" in k or k in ("EXTRA_CFLAGS", "OWS_DIR")}}

    def own(self, text):
        """Text with the instance and the absolute paths of this stage."""
        self.owsd()
        text = re.sub(r'\bOWS(?=__|")|(?<=/owsd\.)OWS(?=\.)', self.daemon.name, text)
        return OF_THE_SYSTEM.sub(f"{self.root}/\\1/", text)

    def run(self, command, seconds=180):
        return subprocess.run([str(c) for c in command], cwd=self.cwd, text=True, timeout=seconds,
                              stdin=subprocess.DEVNULL, capture_output=True,
                              env=self.environment())

    def program(self, command):
        """A program of a page: it succeeds, or it goes on until it is ended, and complains of nothing.
        It goes on when it has done what it does at first and waits, for more than a second."""
        child = subprocess.Popen([str(c) for c in command], cwd=self.cwd, text=True,
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, env=self.environment())
        waits, goes_on = collections.deque(maxlen=30), False
        deadline = time.monotonic() + owsdtest.PATIENCE
        while True:
            try:
                out, err = child.communicate(timeout=0.05)
                break
            except subprocess.TimeoutExpired:
                waits.append(owsdtest.state_of(child.pid) == "S")
            if sum(waits) >= 25 or time.monotonic() > deadline:
                goes_on = True
                child.terminate()
                out, err = child.communicate(timeout=owsdtest.PATIENCE)
                break
        assert goes_on or child.returncode == 0, f"status {child.returncode}\n{out}{err}"
        assert not err, err
        return out


# --- One function for each language ---------------------------------------------------------------

def do_sh(stage, text):
    done = stage.run(["/bin/sh", "-exc", stage.own(text) + "\nwait"])
    assert done.returncode == 0, f"status {done.returncode}\n{done.stdout}{done.stderr}"


def do_console(stage, text):
    for command, expected in handbook.console(text):
        done = stage.run(["/bin/sh", "-exc", stage.own(command)])
        assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}{done.stderr}"
        assert handbook.like(expected, done.stdout), f"{command} says\n{done.stdout}and not\n{expected}"


def compiled(stage, text, compiler, suffix, flags):
    """The program that a block is, or None where it is a part of one."""
    assert "..." not in re.sub(r"/\*.*?\*/|//.*|\"[^\"]*\"", "", text, flags=re.S), \
        "words in place of code: make it whole"
    whole, face = "main(" in text, FACE in text
    if not re.search(r"^(#include|static |extern )|^\w[\w *]*\([^;{]*\)\n\{", text, re.M):
        text = "void fragment(void);\nvoid fragment(void)\n{\n" + textwrap.indent(text, "\t") + "\n}\n"
    if not whole:
        text = "#include <errno.h>\n#include <stdio.h>\n#include <ows.h>\n" + text
    source = stage.scene.file("snippet" + suffix, stage.own(text))
    output = stage.path / "snippet"
    library = [f"-L{owsdtest.BUILD}", "-lows"] if whole else ["-c"]
    if face:
        library = [owsdtest.BUILD / "core.a",
                   *re.findall(r"-l[\w.-]+", (owsdtest.BUILD / "with/ld").read_text())]
    done = stage.run([compiler, *flags, *WARN, "-D_GNU_SOURCE", f"-I{SOURCE}/src/public",
                      f"-I{SOURCE}", source, *library, "-o", output])
    assert done.returncode == 0, done.stderr
    return output if whole else None


def run_face(stage, program):
    """The face of first-face.md: it waits for owsd, serves values, takes commands, refuses what is
    none, follows a restart, and ends in order."""
    scene, rio, name, port = stage.scene, stage.path / "stage.rio", stage.scene.name(), owsdtest.free_port()
    face = scene.start([program, "-c", rio, "-n", name, "-p", str(port)])

    def ask(line):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
            client.connect(("127.0.0.1", port))
            client.settimeout(owsdtest.PATIENCE)
            client.send(f"{line}\n".encode())
            return client.recv(4096).decode().removesuffix("\n")

    def listens():
        with contextlib.suppress(ConnectionRefusedError):
            return ask("room1")

    scene.until(listens, 20, face.log)
    assert ask("room1") == "room1 - there is no such signal", face.log()
    for value in ("1", "0"):
        daemon = scene.owsd(rio, name=name)
        scene.until(lambda: re.fullmatch(r"room1 -?[\d.]+ good", ask("room1")), 20, face.log)
        scene.until(lambda said=value: ask(f"relay={said}") == "relay ok", 20, face.log)
        scene.until(lambda said=value: ask("relay") == f"relay {said} good", 20, face.log)
        for line, answer in {"relay=perhaps": 'relay "perhaps" is no value for it: expected 0 or 1',
                             "nobody": "nobody - there is no such signal",
                             "nobody=1": "nobody there is no such signal",
                             "room1=1": "room1 it is an input: Writable is off in the configuration"}.items():
            assert ask(line) == answer, face.log()
        daemon.stop()
        scene.until(lambda: ask("room1").startswith("room1 - owsd "), 20, lambda: f"{ask('room1')} {face.log()}")
    assert face.stop() == 0 and "ends: SIGTERM" in face.log(), face.log()


def do_c(stage, text):
    program = compiled(stage, text, shutil.which("gcc"), ".c", ["-std=c17"])
    if program and FACE in text:
        run_face(stage, program)
    elif program:
        stage.program([program])


def do_cpp(stage, text):
    program = compiled(stage, text, shutil.which("g++"), ".cpp", ["-std=c++17"])
    if program:
        stage.program([program])


def do_sql(_stage, text):
    assert sqlite3.complete_statement(text), "no whole statement"


def do_python(stage, text):
    stage.program([sys.executable, stage.scene.file("snippet.py", stage.own(text))])


def do_rio(stage, text):
    if not re.search(r"^OwsDrv", text, re.M):
        target = re.search(r'Target +("[^"]+")', text)
        text = (f"OwsDrv {{\n{'TargetName ' + target[1] if target else ''}\n"
                f"{textwrap.indent(text, '  ')}}}\n")
    done = stage.scene.owsd_once("--check", "-c", stage.scene.file("snippet.rio", text))
    assert done.returncode == 0 and not owsdtest.but_of_here(done.stderr), done.stderr


def do_sim(stage, text):
    done = stage.scene.owsctl(None, "-t", f"sim:{stage.scene.file('snippet.sim', text)}", "dir", "/")
    assert done.returncode == 0, done.stderr


def do_json(_stage, text):
    json.loads(text)


def do_nginx(_stage, text):
    assert text.count("{") == text.count("}"), text
    loose = [line for line in text.split("\n") if line.strip() and line.rstrip()[-1] not in "{};"]
    assert not loose, loose


def do_conf(_stage, text):
    """owserver says nothing of a key that it does not know; its help says which it knows."""
    if not shutil.which("owserver"):
        return
    known = {"server"}
    for part in ("device", "cache", "program", "job", "temperature"):
        done = subprocess.run(["owserver", "--help=" + part], capture_output=True, text=True,
                              check=False)
        known |= {k.lower() for k in re.findall(r"--?(\w+)", done.stdout + done.stderr)}
    for line in filter(None, (row.split("#")[0].strip() for row in text.split("\n"))):
        key = re.match(r"(?:!? *(?:server|http|ftp|owfs) *: *)?(\w+)", line)
        assert key and key[1].lower() in known, f"owserver knows no {line}"


def do_udev(_stage, text):
    ours = (SOURCE / "board/udev/owsd.rules").read_text().split("\n")
    for line in filter(None, text.split("\n")):
        assert line.startswith("#") or line in ours, f"board/udev/owsd.rules has no {line}"


def do_text(_stage, text):
    for line in text.split("\n"):
        command = re.sub(r"^\s*\$ ", "", line).strip()
        assert not COMMAND.match(command), f"a command that nobody runs: {command}"


LANGUAGES = {name[3:]: do for name, do in list(globals().items()) if name.startswith("do_")}


def check_block(stage, block):
    assert block.language, "a block without a language: put one of " + \
        " ".join(LANGUAGES) + " behind three backticks"
    assert block.language in LANGUAGES, f"no way to check {block.language}: say in test_docs.py how"
    if block.file and "/" not in block.file:
        stage.scene.file(block.file, stage.own(block.text))
    LANGUAGES[block.language](stage, block.text)


# --- What a page has besides blocks ---------------------------------------------------------------

def check_link(page, target):
    if re.match(r"\w+:", target):
        return
    file, _, anchor = target.partition("#")
    path = page.parent / file if file else page
    assert path.exists(), f"{target} leads nowhere"
    assert not anchor or anchor in handbook.anchors(path), f"{target}: no such heading"


def check_inline(stage, code, written):
    """A file that is named has to exist, or the page has it; a command has to have its verb and
    options."""
    if re.match(r"(?:src|hal|tests|board|docs)/[\w./*-]+$", code) and code not in written:
        assert list(SOURCE.glob(code.rstrip("/"))), f"no {code} in the source"
    program, *words = code.split()
    if program == "sudo" and words:
        program, *words = words
    if program in ("owsd", "owsd-sim", "owsctl", "owsctl-sim") and words:
        check_usage(program, words)
    elif program in (*standin.LOOKED_AT, "make", "apt", "apt-get") and \
            len(words) > (program != "make") and \
            not re.search(r"[|<>&;]|\.\.\.", code):
        done = stage.run(["/bin/sh", "-c", stage.own(code)])
        assert done.returncode == 0, f"{code}: {done.stderr}"


def check_usage(program, words):
    """Placeholders may stand for values, as in `owsctl set NAME VALUE`: so the help is asked."""
    verb = [w for before, w in zip(["", *words], words) if re.match(r"[a-z][a-z-]*$", w) and
            before not in ("-n", "-t")][:1] if program.startswith("owsctl") else []
    helps = [subprocess.run([owsdtest.BUILD / program, *v, "--help"], capture_output=True, text=True,
                            check=False) for v in ([], verb)]
    assert all(h.returncode == 0 for h in helps), helps[-1].stderr
    said = " ".join(h.stdout for h in helps)
    known = set(re.findall(r"(?<![\w-])--?[a-z]+", said, re.I))
    known |= {f"-{c}" for group in re.findall(r"\[-(\w+)\]", said) for c in group}
    for option in (w.split("=")[0] for w in words if w.startswith("-")):
        assert option in known, f"{' '.join([program, *words])}: no option {option}"


def go_through(scene, page):
    """All faults of a page, so that they can be mended at once."""
    stage, faults = Stage(scene, page.stem), []

    def attempt(line, do, *what):
        try:
            do(*what)
        except (AssertionError, ValueError, subprocess.TimeoutExpired) as fault:
            faults.append(f"{page.name}:{line}: {fault}")

    for block in handbook.blocks(page):
        if page.name != "first-family.md":  # test_first_family.py replays that one
            attempt(block.line, check_block, stage, block)
    if page.suffix == ".md":
        written = {block.file for block in handbook.blocks(page)}
        for line, target in handbook.links(page):
            attempt(line, check_link, page, target)
        for line, code in handbook.inline(page):
            attempt(line, check_inline, stage, code, written)
    return faults


def case_of(page):
    def case(scene):
        faults = go_through(scene, page)
        assert not faults, "\n" + "\n".join(faults)
    return case


INDEX = SOURCE / "docs/README.md"
for _page in PAGES + MANUALS:
    _name = "docs_readme_md" if _page == INDEX else re.sub(r"[^a-z0-9]", "_", _page.name.lower())
    globals()[f"test_{_name}_is_true"] = case_of(_page)


def test_the_tests_of_each_promise_are_there(_scene):
    named = 0
    for row in re.split(r"\n(?=[-|\n])", (SOURCE / "tests/promises.md").read_text()):
        files, text = [], ""
        for word in re.findall(r"`(tests/[^`]+|test_\w+)`", row):
            if word.startswith("tests/"):
                text = (SOURCE / word).read_text()
                files.append(word)
            elif files:
                assert re.search(rf"^(def|static void) {word}\(", text, re.M), (files[-1], word)
                named += 1
    assert named >= 15, named


def test_every_page_can_be_reached_from_the_readme(_scene):
    assert "docs/README.md" in {target for _, target in handbook.links(SOURCE / "README.md")}
    linked = {target for _, target in handbook.links(INDEX)}
    missing = [p.name for p in [*(SOURCE / "docs").glob("*.md"), *MANUALS] if p.name not in linked and p != INDEX]
    assert not missing, f"docs/README.md leads not to {missing}"


def test_messages_that_are_explained_are_those_of_the_programs(_scene):
    """What stands for %s differs, so pairs of words are looked for."""
    files = [f for d in ("src", "hal") for form in ("*.c", "*_list.h") for f in (SOURCE / d).rglob(form)]
    said = re.sub(r'"\s*\n\s*"', "", "\n".join(f.read_text() for f in files))
    said = re.sub(r"(?<=[a-z])%s", "s", said)  # of a plural
    explained = 0
    for page in ("bring-up.md", "doctor.md"):
        for line, first in handbook.items(SOURCE / "docs" / page):
            for message in re.findall(r"`([^`]+)`", "" if "owserver ends" in first else first):
                words = message.split()
                pairs = [f"{a} {b}" for a, b in zip(words, words[1:])
                         if re.fullmatch(r"[a-z']+ [a-z']+[,:]?", f"{a} {b}")]
                there = sum(pair in said for pair in pairs)
                assert there >= 0.6 * len(pairs), f"{page}:{line}: no program says {message}"
                explained += bool(pairs)
    assert explained >= 20, explained


def test_each_rung_of_the_recovery_is_explained_by_its_counter(_scene):
    said = (SOURCE / "docs/native.md").read_text().split("\n## Recovery\n")[1].split("\n## ")[0]
    names = re.findall(r'"(recover_\w+|retries|link_errors|shorts)"',
                       (SOURCE / "hal/native/state.h").read_text())
    missing = [name for name in names if f"`bus_{name}`" not in said]
    assert len(names) >= 7 and not missing, (names, missing)


def test_the_page_of_devices_is_made_of_the_tables(_scene):
    done = subprocess.run([sys.executable, SOURCE / "docs/devices.py"], capture_output=True, text=True, timeout=60,
                          env={**os.environ, "OWSD_BUILD": str(owsdtest.BUILD), "PYTHONDONTWRITEBYTECODE": "1"})
    assert done.returncode == 0, done.stderr
    assert done.stdout == (SOURCE / "docs/devices.md").read_text(), "run: make devices-page"


def test_each_counter_that_owsctl_prints_has_its_words(scene):
    page = re.sub(r"\\-", "-", (SOURCE / "docs/owsd-signals.7").read_text())
    wire = scene.file("wire.sim", "chip DS2482-100 0x18\nDS18B20 28.551DDF030000\n")
    ports = [f"127.0.0.1:{owsdtest.free_port()}" for _ in range(2)]
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}, {ports[0]}", []), "-l", ports[1])
    said = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["counters"]
    names = {re.sub(r"(?<=_wire_)\d+(?=_)", "N", counter["name"]) for counter in said}
    missing = [name for name in names if f"\n\\fB{name}\\fR " not in page]
    assert len(names) > 80 and not missing, (len(names), missing)


def test_each_option_has_its_words_in_a_manual_page(_scene):
    def told(*command):
        done = subprocess.run([owsdtest.BUILD / command[0], *command[1:], "--help"], capture_output=True, text=True,
                              timeout=owsdtest.PATIENCE, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def page(name):
        return re.sub(r"\\f.", "", (SOURCE / "docs" / name).read_text()).replace("\\-", "-")

    faces = [row[0] for row in standin.FACES if (owsdtest.BUILD / row[0]).exists()]
    pages = {"owsd": (page("owsd.8"), [told("owsd")])}
    pages |= {face: (page(f"{face}.8") + page("owsd-faces.7"), [told(face)]) for face in faces}
    verbs = re.findall(r"^  ([a-z][a-z-]*) ", told("owsctl"), re.M)
    pages["owsctl"] = page("owsctl.1"), [told("owsctl"), *(told("owsctl", verb) for verb in verbs)]
    options = 0
    for program, (text, helps) in pages.items():
        for said in helps:
            found = {*re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", said), *re.findall(r"^ +(-[a-zA-Z])\b", said, re.M)}
            missing = [option for option in found if not re.search(rf"(?<![\w-]){option}(?![\w-])", text)]
            options += len(found)
            assert not missing, (program, missing, said)
    assert len(verbs) > 20 and options > 60, (verbs, options)


def members(found):
    """All names in what a verb prints as JSON, but those of properties."""
    if isinstance(found, list):
        return set().union(*map(members, found))
    if not isinstance(found, dict):
        return set()
    return {*found}.union(*(members(more) for name, more in found.items() if name != "values"))


def test_each_member_of_json_that_owsctl_prints_stands_in_its_page(scene):
    """docs/support.md promises them. Of stats the verb's own words say what there is."""
    page = (SOURCE / "docs/owsctl.1").read_text().split("\n.SH VALUES IN JSON\n")[1].split("\n.SH ")[0]
    known = set(re.findall(r"\w+", re.sub(r"\\f.", " ", page)))
    wire = scene.file("wire.sim", "chip DS2482-100 0x18\nDS18B20 28.551DDF030000 temperature 21.5\n"
                                  "DS2408 29.B89115000000\n")
    room = "/28.551DDF030000/temperature"
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [
        {"Name": "room", "Path": room, "Type": "double", "LimitH": 20},
        {"Name": "relay", "Path": "/29.B89115000000/PIO.0", "Type": "bool", "IO": "output"}]))
    scene.until(lambda: "room" in scene.owsctl(daemon, "alarms").stdout, 20, "a value, and its alarm")
    for verb in ("wait room > -55", "set -w 20 relay 1", "list", "get room", "alarms", "journal", "who", "instances",
                 f"read {room}", "scan"):
        done = scene.owsctl(daemon, "--json", *verb.split())
        names = members(json.loads(done.stdout))
        assert names and not names - known, f"{verb}: the page does not have {sorted(names - known)}\n{done.stderr}"
    cells = set(re.findall(r"\bX\((\w+)\)", (SOURCE / "src/tool/owsctl/modbus_forms.h").read_text()))
    assert len(cells) >= 9 and not cells - known, cells


def test_the_labels_of_metrics_and_the_members_of_mqtt_stand_in_their_pages(_scene):
    """What both promise to stay; the members of discovery are words of Home Assistant."""
    verb = re.sub(r"\\f.", "", (SOURCE / "docs/owsctl.1").read_text().split("\n.SS metrics\n")[1].split("\n.SS ")[0])
    labels = set(re.findall(r'(?:next|put)_label\(p, "(\w+)"', (SOURCE / "src/faces/show/metrics.c").read_text()))
    said = set(re.findall(r"\w+", re.search("The labels are .*", verb)[0]))
    assert len(labels) >= 5 and not labels - said, (labels, said)
    page = set(re.findall(r"\w+", re.sub(r"\\f.", " ", (SOURCE / "docs/owsd-mqtt.8").read_text())))
    texts = [(SOURCE / f"src/faces/mqtt/{file}.c").read_text().split("\nvoid health_entities_json(")[0]
             for file in ("plain", "health", "devices", "ask", "arrivals")]
    found = {name for text in texts for name in re.findall(r'\bjson_[a-z]+\(&?json, "(\w+)"', text)}
    assert len(found) > 30 and not found - page, found - page


def test_the_sandboxes_of_the_services_are_those_of_the_pages(_scene):
    unit = (SOURCE / "board/systemd/owsd@.service").read_text()
    said = (SOURCE / "docs/install.md").read_text().split("\n## The service\n")[1].split("\n## ")[0]
    places = re.findall(r"^ReadWritePaths=-?(\S+)$", unit, re.M)
    places.append("/var/lib/" + re.search(r"^StateDirectory=(\S+)$", unit, re.M)[1])
    missing = [place for place in places if f"`{place}`" not in said]
    assert len(places) >= 3 and not missing, (places, missing)
    for key, words in (("TasksMax", "{} threads"), ("MemoryMax", "{} MB of memory"), ("User", "as the user `{}`")):
        assert words.format(re.search(rf"^{key}=(\w+?)M?$", unit, re.M)[1]) in said.replace("\n", " "), key
    page = (SOURCE / "docs/owsd-faces.7").read_text()
    places = [place.lstrip("-") for file in (SOURCE / "board/systemd").glob("owsd-*@.service")
              for line in re.findall("^ReadWritePaths=(.*)$", file.read_text(), re.M) for place in line.split()]
    missing = [place for place in places if f"\\fI{place}\\fR" not in page]
    assert len(places) >= 3 and not missing, (places, missing)


def test_the_decimals_of_units_are_those_of_the_table(_scene):
    page = (SOURCE / "docs/owsd.rio.5").read_text().replace("\n", " ")
    page = page.replace("\\(de", "\u00b0").replace("\\(*m", "\u00b5")
    said = re.search(r"programs get all\. Default: (.*?) \(two more", page)[1]
    counts = ("none", "one", "two", "three")
    units = {unit: counts.index(count) for count, names in re.findall(r"(none|one|two|three) for ([^;]*)", said)
             for unit in re.split(", | and ", names)}
    rows = re.search(r"\} wanted\[\] = \{(.*?)\n\};", (SOURCE / "hal/chips/facts.c").read_text(), re.S)[1]
    table = {"\u00b0C" if name == "DEGREES_C" else json.loads(name): int(decimals)
             for name, decimals in re.findall(r'\{("[^"]*"|\w+), (\d)\}', rows)}
    assert len(table) >= 20 and units == table, (units, table)


def test_each_variable_that_programs_read_stands_in_a_manual_page(_scene):
    pages = re.sub(r"\\f.", " ", "".join(page.read_text() for page in MANUALS))
    read = {name for folder in ("src", "hal") for file in (SOURCE / folder).rglob("*.c")
            for name in re.findall(r'\b(?:getenv|environment|absolute)\("([A-Z_]+)"\)', file.read_text())}
    missing = [name for name in sorted(read) if not re.search(rf"\b{name}\b", pages)]
    assert len(read) >= 15 and not missing, (read, missing)


def test_the_picture_of_the_live_table_can_be_drawn_again(scene):
    picture = scene.path / "table.svg"
    subprocess.run([sys.executable, SOURCE / "docs/live-table.py", picture], check=True, timeout=240)
    for svg in (picture, SOURCE / "docs/img/table.svg"):
        texts = {t.text: t.get("fill") for t in xml.etree.ElementTree.parse(svg).iter() if t.text}
        assert {"NAME", "boiler", "humidity", "pump"} <= set(texts), texts
        assert texts["bedroom"] and not texts["living"], "the device that is gone is red"
        assert any(text.startswith("! ") and colour for text, colour in texts.items()), "an alarm stands"


# What is wrong, and what is said of it
PLANTED = [
    ("```sh\nowsctl list --colour\n```", "unknown option: --colour"),
    ("```sh\nowsctl show room1\n```", "owsctl: there is no verb show\nowsctl --help"),
    ("```sh\nowsd -c plant.rio --daemon\n```", "unknown option: --daemon"),
    ("```sh\nowsctl get room99\n```", "there is no room99"),
    ("```sh\napt-cache policy owsd\n```", "apt-cache: not found"),
    ("```sh\nsudo apt install owsd-tools\n```", "no package owsd-tools"),
    ("```sh\nsystemctl restart ows\n```", "restart ows"),
    ("```sh\nmake tests\n```", "no target tests"),
    ("```sh\nmake deb ARCHITECTURE=arm64\n```", "no variable ARCHITECTURE"),
    ("```console\n$ owsctl get room1\nwarm\n```", "and not\nwarm"),
    ("```c\nows_fetch(NULL, 1);\n```", "ows_fetch"),
    ("```c\nint main(void)\n{\n\tchar c = \"text\";\n\n\treturn c;\n}\n```", "int-conversion"),
    ("```c\nint main(void)\n{\n\treturn 3;\n}\n```", "status 3\n"),
    ("```cpp\nint main()\n{\n\treturn nothing;\n}\n```", "nothing"),
    ("```python\nimport ows\nows.Ows(\"OWS\").fetch(\"room1\")\n```", "attribute 'fetch'"),
    ("```rio\nOwsDrv {\n  Target \"localhost\"\n}\n```", "unknown key Target"),
    ("```sim\nchip DS9999 0x18\n```", "DS9999"),
    ("```sql\nselect 1\n```", "no whole statement"),
    ("```udev\nSUBSYSTEM==\"w1\"\n```", "has no SUBSYSTEM"),
    ("```json\n{1}\n```", "property name"),
    ("```text\nowsctl lst\n```", "nobody runs: owsctl lst"),
    ("```text\n$ owsctl stat\n```", "nobody runs: owsctl stat"),
    ("```\nx\n```", "without a language"),
    ("\n    owsctl list\n", "without a language"),
    ("```perl\n1\n```", "no way to check perl"),
    ("[here](nowhere.md)", "leads nowhere"),
    ("# A heading\n\n[here](#no-heading)", "no such heading"),
    ("as in `src/daemon/engine/nothing.c`", "nothing.c in the source"),
    ("by `owsctl list --colour`", "owsctl list --colour: no option --colour"),
    ("by `owsctl show NAME`", "no verb show"),
    ("by `owsd --quiet`", "no option --quiet"),
    ("by `sudo adduser USER wheel`", "USER wheel"),
] + [("```conf\nserver: i2s = ALL\n```", "knows no server: i2s")] * bool(shutil.which("owserver"))


def test_what_is_wrong_is_noticed(scene):
    faults = go_through(scene, scene.file("planted.md", "\n\n".join(t for t, _ in PLANTED)))
    for text, said in PLANTED:
        assert any(said in fault for fault in faults), f"{text}: nothing about {said} in {faults}"
    assert len(faults) == len(PLANTED), faults


if __name__ == "__main__":
    owsdtest.main(at_once=4)
