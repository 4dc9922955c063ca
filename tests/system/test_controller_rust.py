#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The control program in Rust, which was written from docs/shared-memory.md alone, commands as any
other controller: its commands outlive a reload and a restart of owsd, and its death leaves SafeValue."""

import json
import os
import shutil
import signal
import subprocess

import owsdtest
from owsdtest import raw
from test_doors import porter_of

EXAMPLES = owsdtest.SOURCE / "docs/examples"
SWITCH = "/29.A0B1C2000003"


def item(name, kind, io="output", **more):
    return dict(Name=name, Path=f"{SWITCH}/{more.pop('property')}", Type=raw(kind), IO=raw(io), **more)


RELAYS = item("relays", "byte", property="PIO.BYTE", InitValue="3", SafeValue="7")
SENSED = item("sensed", "byte", "input", property="sensed.BYTE")


def compiled(scene, source, *more):
    """A program, built by this machine's Rust."""
    rustc = shutil.which("rustc") or shutil.which(os.path.expanduser("~/.cargo/bin/rustc"))
    if not rustc:
        owsdtest.skip("there is no rustc")
    built = scene.path / "controller"
    done = subprocess.run([rustc, "--edition", "2021", *more, "-o", built, source],
                          capture_output=True, text=True, timeout=300, check=False)
    if "error: toolchain" in done.stderr or "rustup could not" in done.stderr:
        owsdtest.skip("this rustc has no toolchain")
    assert done.returncode == 0, done.stderr
    return built


def program(scene):
    return compiled(scene, EXAMPLES / "controller.rs", "-D", "warnings")


class Controller:
    """The program as it runs; a fifo is its standard input."""

    def __init__(self, scene, built, daemon, period_ms=1000):
        fifo = scene.path / scene.name()
        os.mkfifo(fifo)
        self.scene, self.input = scene, os.open(fifo, os.O_RDWR)
        self.process = scene.start(["sh", "-c", f"exec '{built}' {daemon.name} {period_ms} <'{fifo}'"])
        scene.until(lambda: "# connected\n" in self.process.log(), 10, self.process.log)

    def say(self, line):
        os.write(self.input, f"{line}\n".encode())

    def until(self, line, after=""):
        """It has printed that line, after another."""
        def there():
            _, found, rest = self.process.log().rpartition(after or "# connected")
            return found and f"\n{line}\n" in rest
        self.scene.until(there, 10, self.process.log)

    def sets(self, line):
        self.say(line)
        self.until(f"{line}: applied")


def house(scene, *items):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS2408 29.A0B1C2000003\n")
    return owsdtest.rio(f"sim:{wire}", items or (RELAYS, SENSED), Period=0.05)


def who(scene, daemon):
    """The programs that are connected; why the command for relays is in force, and whose it is."""
    there = json.loads(scene.owsctl(daemon, "--json", "who", "relays").stdout)
    [output] = there["outputs"]
    return ([controller["by"]["program"] for controller in there["controllers"]], output["reason"],
            output["by"] and output["by"]["program"])


def get(scene, daemon):
    return scene.get(daemon, "relays")


def test_it_sets_outputs_and_reports_what_becomes_of_that(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon)
    controller.sets("relays=5")
    scene.until(lambda: get(scene, daemon) == "5", 10, "the value")
    controller.say("relays=256")
    controller.until("relays=256: Numerical result out of range (os error 34)")
    controller.say("sensed=1")
    controller.until("sensed=1: Read-only file system (os error 30)")
    controller.say("nobody=1")
    controller.until("nobody=1: No such file or directory (os error 2)")
    assert who(scene, daemon) == (["controller"], "set", "controller"), who(scene, daemon)


def test_its_goodbye_leaves_its_outputs_as_they_are(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon, 100)
    controller.sets("relays=5")
    controller.say("quit")
    controller.until("# goodbye")
    assert controller.process.wait() == 0
    scene.until(lambda: not who(scene, daemon)[0], 10, "it has left")
    assert who(scene, daemon)[1:] == ("set", "controller"), who(scene, daemon)
    assert get(scene, daemon) == "5"


def test_its_death_leaves_safevalue(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon, 500)
    controller.sets("relays=5")
    controller.process.kill()
    scene.until(lambda: get(scene, daemon) == "7", 10, "SafeValue")


def test_while_it_hangs_there_is_safevalue_and_its_next_command_counts(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon, 500)
    controller.sets("relays=5")
    controller.process.freeze()
    scene.until(lambda: get(scene, daemon) == "7", 10, "SafeValue")
    assert who(scene, daemon) == (["controller"], "SafeValue", "controller"), who(scene, daemon)
    controller.process.thaw()
    controller.sets("relays=9")
    assert get(scene, daemon) == "9"


def test_its_command_outlives_a_killed_owsd(scene):
    config = house(scene)
    built, daemon = program(scene), scene.owsd(config)
    controller = Controller(scene, built, daemon)
    controller.sets("relays=5")
    daemon.kill()
    daemon = scene.owsd(config, name=daemon.name)
    controller.until("relays=5: applied", after="# another owsd")
    assert get(scene, daemon) == "5"
    assert who(scene, daemon) == (["controller"], "returned", "controller"), who(scene, daemon)
    controller.sets("relays=9")
    assert get(scene, daemon) == "9"


def test_it_goes_on_over_a_reload(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon)
    controller.sets("relays=5")
    os.replace(scene.file("newer.rio", house(scene, SENSED, RELAYS)), daemon.config)
    daemon.signal(signal.SIGHUP)
    controller.until("relays=5: applied", after="# reloaded")
    controller.sets("relays=9")
    assert get(scene, daemon) == "9"


def test_a_welcome_that_is_lost_is_asked_for_by_another_connection(scene):
    built, daemon = program(scene), scene.owsd(house(scene))
    controller = Controller(scene, built, daemon, 20000)
    controller.sets("relays=5")
    scene.until(lambda: porter_of(daemon), 10, "the porter")
    porter = porter_of(daemon)
    os.kill(porter, signal.SIGSTOP)
    os.replace(scene.file("newer.rio", house(scene, SENSED, RELAYS)), daemon.config)
    daemon.signal(signal.SIGHUP)
    scene.until(lambda: daemon.log().count(f"instance {daemon.name}, ") == 2, 10, daemon.log)
    scene.until(lambda: "# away" in controller.process.log(), 10, controller.process.log)
    os.kill(porter, signal.SIGKILL)  # with the welcome in its queue
    controller.until("relays=5: applied", after="# reloaded")
    controller.sets("relays=9")
    assert get(scene, daemon) == "9"


CONFIRMS = """
#![allow(dead_code)]
#[path = "{0}/controller_calls.rs"]
mod calls;
#[path = "{0}/controller_image.rs"]
mod image;
#[path = "{0}/controller_memory.rs"]
mod memory;

fn main() {{
    for before in [0u32, 5, 0x7fffffff, 0x80000001] {{
        let (first, second) = (before.wrapping_add(0x80000011), before.wrapping_add(0x80000012));
        assert!(!memory::confirms(before, first, first));
        assert!(!memory::confirms(before, second, first));
        assert!(!memory::confirms(before, second, second));
        assert!(memory::confirms(first, second, first));
        assert!(!memory::confirms(first, second, second));
        assert!(memory::confirms(second, second, first));
    }}
    assert!(memory::confirms(7, 0, 7) && !memory::confirms(7, 0, 8)); // carried over a start
}}
"""


def test_what_was_confirmed_2_to_the_31_commands_ago_confirms_no_new_one(scene):
    built = compiled(scene, scene.file("confirms.rs", CONFIRMS.format(EXAMPLES)))
    done = subprocess.run([built], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


if __name__ == "__main__":
    owsdtest.main(at_once=2)
