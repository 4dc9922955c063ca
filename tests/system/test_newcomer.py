#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What owsctl does for somebody who uses it for the first time."""

import os
import pty
import re
import select
import shutil
import subprocess
import time

import owsdtest

WIRE = ("chip DS2482-100 0x18\nDS18B20 28.551DDF030000 as room temperature 21.5\n"
        "DS2408 29.B89115000000 as relays\n")
ITEMS = [dict(Name="room", Path="/28.551DDF030000/temperature", Type="double", IO="input"),
         dict(Name="a_long_name_of_a_lamp_in_the_hall_upstairs", Path="/29.B89115000000/PIO.0",
              Type="bool", IO="output"),
         dict(Name="far", Path="/29.FFFFFF000000/PIO.0", Type="bool", IO="output"),
         dict(Name="lost", Path="/28.FFFFFF030000/temperature", Type="double", IO="input")]


def plant(scene):
    scene.file("wire.sim", WIRE)
    daemon = scene.owsd(owsdtest.rio("sim:wire.sim", ITEMS))
    scene.until(lambda: scene.get(daemon, "room"), 20, "a value")
    return daemon


def ctl(scene, *words, place=None, **environment):
    """owsctl without -n, in the place of this test or in one of its own."""
    env = dict(os.environ, LC_ALL="C.UTF-8", **environment)
    if place:
        env["OWS_DIR"] = str(place)
    return subprocess.run([owsdtest.OWSCTL, *words], capture_output=True, text=True, timeout=60,
                          check=False, cwd=scene.path, env=env)


def alone(scene):
    """An owsd of another name than OWS in a place where there is no other."""
    place = scene.path / "place"
    place.mkdir(mode=0o755)
    scene.file("wire.sim", WIRE)
    return scene.owsd(owsdtest.rio("sim:wire.sim", ITEMS), name="house",
                      env={"OWS_DIR": str(place)}), place


def test_the_one_instance_that_runs_is_found_by_verbs_that_look(scene):
    _, place = alone(scene)
    scene.until(lambda: ctl(scene, "get", "room", place=place).returncode == 0, 20, "a value")
    for words in (["list"], ["get", "room"], ["stats"], ["alarms"], ["who"],
                  ["read", "/28.551DDF030000/temperature"], ["dir"]):
        done = ctl(scene, *words, place=place)
        assert done.returncode == 0 and done.stdout, (words, done)
        assert done.stderr == "owsctl: no OWS has run here; this is house\n", (words, done.stderr)
    for words in (["set", "room", "1"], ["alarms", "ack", "room"]):
        done = ctl(scene, *words, place=place)
        assert done.returncode == 1 and "running: house (owsctl -n house" in done.stderr, done
    done = ctl(scene, "get", "room", place=place, OWS_NAME="house")
    assert done.returncode == 0 and not done.stderr, done
    done = ctl(scene, "get", "room", place=place, OWS_NAME="hut")
    assert done.returncode == 1 and "no owsd of the name hut" in done.stderr, done


def test_an_error_names_whom_owsctl_asked(scene):
    _, place = alone(scene)
    done = ctl(scene, "read", "/28.FFFFFF030000/temperature", place=place)
    assert done.returncode == 1 and "(asked owsd house)" in done.stderr, done
    done = ctl(scene, "dir", "/28.FFFFFF030000", place=place)
    assert done.returncode == 1 and "(asked owsd house)" in done.stderr, done


def test_the_help_of_each_verb_is_a_screen_with_an_example(scene):
    verbs = re.findall(r"^  ([a-z]+) ", ctl(scene, "--help").stdout, re.M)
    assert "watch" in verbs and "help" in verbs, verbs
    for verb in verbs:
        done = ctl(scene, "help", verb)
        lines = done.stdout.splitlines()
        assert done.returncode == 0 and len(lines) <= 24, (verb, lines)
        assert max(map(len, lines)) <= 80, (verb, lines)
        assert lines[0].startswith(f"usage: owsctl {verb}"), lines
        assert ctl(scene, verb, "--help").stdout == done.stdout or verb == "help", verb
        if verb == "trend":
            continue
        example = [line for line in lines if line.startswith("example: owsctl ")]
        assert example and verb in example[0], lines
        options = set(re.findall(r"(?<![\w-])-[a-zA-Z]\b", lines[0]))
        explained = "\n".join(lines[2:-2])
        missing = [o for o in options if not re.search(rf"(?<![\w-]){o}\b", explained)]
        assert not missing, (verb, missing)
    opens = sorted(verb for verb in verbs if "-t TARGET" in ctl(scene, "help", verb).stdout.split("\n")[0])
    named = re.search(r"-t TARGET +what (.*) open$", ctl(scene, "--help").stdout, re.M)[1]
    assert sorted(re.findall(r"\w+", named.replace(" and ", " "))) == opens, (named, opens)
    assert max(map(len, ctl(scene, "--help").stdout.splitlines())) <= 80
    assert ctl(scene, "config", "x", "add", "--help").stdout == ctl(scene, "help", "config").stdout


def test_a_mistyped_verb_has_the_nearest_one(scene):
    for typed, meant in (("wach", "watch"), ("lsit", "list"), ("alarm", "alarms"), ("controllers", "who"),
                         ("givers", "who"), ("signals", "list"), ("ls", "list"), ("status", "stats"),
                         ("get-all", "list"), ("ack", "alarms ack"), ("history", "trend"), ("monitr", "watch"),
                         ("sets", "set"), ("stat", "stats"), ("writes", "write")):
        done = ctl(scene, typed)
        assert done.returncode == 2 and not done.stdout, done
        assert done.stderr == (f"owsctl: there is no verb {typed}; did you mean {meant}?\n"
                               "owsctl --help lists the verbs\n"), done.stderr
    assert "did you mean" not in ctl(scene, "frobnicate").stderr


def test_get_says_that_a_command_is_on_its_way(scene):
    daemon, lamp = plant(scene), ITEMS[1]["Name"]
    # that of a board which is not plugged in stays on its way
    for name in (lamp, "far"):
        assert scene.owsctl(daemon, "set", name, "on").returncode == 0
    said = scene.owsctl(daemon, "get", "far")
    assert said.stdout == "\n" and "far has no value: " in said.stderr and "far: commanded 1, " in said.stderr, said
    scene.until(lambda: scene.owsctl(daemon, "get", lamp).stdout == "1\n", 20, "it is written")
    assert not scene.owsctl(daemon, "get", lamp).stderr


class Screen:
    """owsctl watch on a terminal of 24 lines and 80 columns."""

    def __init__(self, daemon):
        import fcntl
        import struct
        import termios
        self.lines = {}
        self.bytes = 0
        try:
            self.pid, self.master = pty.fork()
        except OSError as why:
            owsdtest.skip(f"no pseudo-terminal to be had: {why}")
        if self.pid == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
            os.execve(owsdtest.OWSCTL, ["owsctl", "-n", daemon.name, "watch"],
                      dict(os.environ, TERM="vt100", LC_ALL="C.UTF-8", NO_COLOR="1"))

    def read(self, seconds=0.1):
        if select.select([self.master], [], [], seconds)[0]:
            text = os.read(self.master, 65536).decode(errors="replace")
            self.bytes += len(text)
            for line, rest in re.findall(r"\x1b\[(\d+);1H([^\x1b]*(?:\x1b\[[012]?m[^\x1b]*)*)", text):
                self.lines[int(line)] = re.sub(r"\x1b\[\d*m", "", rest)

    def shows(self, condition, what):
        deadline = time.monotonic() + owsdtest.PATIENCE
        while not condition(self.lines):
            assert time.monotonic() < deadline, f"{what}: {self.lines}"
            self.read()

    def type(self, text):
        os.write(self.master, text.encode())


def test_watch_writes_what_changes_and_has_search_and_order(scene):
    screen = Screen(plant(scene))
    screen.shows(lambda at: at.get(3, "").startswith("room "), "in the order of the file")
    assert at_name(screen, "a_long").count("~") and "/29.B8" in at_name(screen, "a_long"), screen.lines
    screen.type("!")
    screen.shows(lambda at: at.get(6, "").startswith("room "), "bad first")
    screen.type("!")
    screen.shows(lambda at: at.get(3, "").startswith("room "), "as before")
    screen.type("/28.55\n")
    screen.shows(lambda at: at.get(3, "").startswith("room ") and not at.get(4), "only that one")
    # ten seconds of whole pictures at ten a second were 146 kB
    before, until = screen.bytes, time.monotonic() + 3
    while time.monotonic() < until:
        screen.read()
    assert screen.bytes - before < 3 * 2000, screen.bytes - before
    screen.type("q")
    assert os.waitpid(screen.pid, 0)[1] == 0
    os.close(screen.master)


def completed(scene, place, *words):
    """What bash offers for the last word."""
    script = (f'. {owsdtest.SOURCE}/board/completion/owsctl.bash; COMP_WORDS=("$@")\n'
              'COMP_CWORD=$(($# - 1)); _owsctl; printf "%s\\n" "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "-c", script, "bash", "owsctl", *words], capture_output=True,
                          text=True, check=False, cwd=scene.path, timeout=60,
                          env=dict(os.environ, OWS_DIR=str(place),
                                   OWSD_BOARDS=str(owsdtest.SOURCE / "board/boards"),
                                   PATH=f"{owsdtest.BUILD}:{os.environ['PATH']}"))
    assert done.returncode == 0 and not done.stderr, done
    return done.stdout.split()


def test_bash_completes_verbs_signals_and_instances(scene):
    _, place = alone(scene)
    for words, expected in ((["wa"], ["watch", "wait"]), (["help", "al"], ["alarms"]),
                            (["get", "ro"], ["room"]), (["-n", "house", "set", "fa"], ["far"]),
                            (["-n", ""], ["house"]), (["remove", "h"], ["house"]),
                            (["watch", "-l"], ["-l"]), (["alarms", "ac"], ["ack"]),
                            (["config", "wire.s"], ["wire.sim"]), (["config", "x", "mo"], ["move"]),
                            (["convert", "--mbdrv", "wire.s"], ["wire.sim"]),
                            (["enable", "we"], ["web"]), (["disable", "mq"], ["mqtt"]),
                            (["stats", ""], [])):
        assert sorted(completed(scene, place, *words)) == sorted(expected), words
    known = subprocess.run(["bash", "-c", f". {owsdtest.SOURCE}/board/completion/owsctl.bash; complete -p owsctl-sim"],
                           capture_output=True, text=True, check=False, timeout=60)
    assert known.stdout == "complete -F _owsctl owsctl-sim\n", known


def test_zsh_completes_the_same(scene):
    if not shutil.which("zsh"):
        owsdtest.skip("zsh is not installed")
    first = (owsdtest.SOURCE / "board/completion/_owsctl").read_text().splitlines()[0]
    assert first.split() == ["#compdef", "owsctl", "owsctl-sim"]
    _, place = alone(scene)
    for typed, expected in (("wa", {"watch", "wait"}), ("get ro", {"room"}), ("enable we", {"web"})):
        script = (f"compadd() {{ print -l -- ${{@:#--}} }}; words=(owsctl {typed}); CURRENT=$#words; "
                  f". {owsdtest.SOURCE}/board/completion/_owsctl")
        done = subprocess.run(["zsh", "-fc", script], capture_output=True, text=True, check=False,
                              cwd=scene.path, timeout=60,
                              env=dict(os.environ, OWS_DIR=str(place),
                                       PATH=f"{owsdtest.BUILD}:{os.environ['PATH']}"))
        assert expected <= set(done.stdout.split()), done


def at_name(screen, name):
    return next((line for line in screen.lines.values() if line.startswith(name)), "")


if __name__ == "__main__":
    owsdtest.main()
