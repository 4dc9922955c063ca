#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The examples for OpenPLC and LinuxCNC, compiled against stand-ins of their interfaces (openplc/
and linuxcnc/ beside this file) and run on an owsd with a simulated bus. The genuine are not here:
docs/openplc.md and docs/linuxcnc.md say what was seen with them."""

import json
import os
import select
import shlex
import shutil
import signal
import struct
import subprocess
import tempfile
import threading

import owsdtest
from owsdtest import SOURCE, until

EXAMPLES = SOURCE / "docs/examples"
ROOM, RELAY = "/28.000000000001", "/3A.000000000001"
_building = threading.Lock()
_built = {}


def build(name, compilers, command):
    """A program in the directory of this run, compiled once."""
    with _building:
        if name not in _built:
            compiler = shutil.which(os.environ.get(compilers[0], compilers[1]).split()[0])
            if not compiler:
                owsdtest.skip(f"no {compilers[1]} here")
            words = shlex.split(os.environ.get(compilers[0], compilers[1]))
            program = os.path.join(tempfile.mkdtemp(prefix="plc"), name)
            done = subprocess.run([*words, "-Wall", "-Wextra", "-Werror", "-O1", "-D_GNU_SOURCE",
                                   f"-I{SOURCE}/src/public", *command,
                                   *os.environ.get("EXTRA_CFLAGS", "").split(), "-o", program,
                                   str(owsdtest.BUILD / "libows.a"), "-lm", "-pthread"],
                                  text=True, capture_output=True, timeout=400)
            assert done.returncode == 0, done.stderr
            _built[name] = program
        return _built[name]


def plc_program(version):
    """With the standard that OpenPLC's own script names."""
    here = SOURCE / "tests/system/openplc"
    more = {3: ["-std=gnu++11"], 4: ["-std=gnu++17", "-DOPENPLC_V4", here / "plugin.cpp"]}
    return build(f"plc{version}", ("CXX", "c++"), [f"-I{SOURCE}", f"-I{here}", EXAMPLES / "openplc/owsd.cpp",
                                                   here / "plc.cpp", *more[version]])


def hal_program():
    here = SOURCE / "tests/system/linuxcnc"
    return build("owsd_hal", ("CC", "cc"), ["-std=gnu17", "-DULAPI", f"-I{SOURCE}", f"-I{here}",
                                            EXAMPLES / "linuxcnc/owsd_hal.c", here / "hal.c"])


class Spoken(owsdtest.Program):
    """A program that is spoken to on its standard input and answers on its output."""

    def __init__(self, scene, command, env=None):
        self.command = [str(c) for c in command]
        self.heard = ""
        self.process = subprocess.Popen(self.command, cwd=scene.path, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        env=dict(os.environ, **(env or {})))
        os.set_blocking(self.process.stdout.fileno(), False)
        self.pid = self.process.pid
        self.read = 0
        scene.programs.append(self)

    def listen(self):
        while select.select([self.process.stdout], [], [], 0)[0]:
            data = os.read(self.process.stdout.fileno(), 65536)
            if not data:
                break
            self.heard += data.decode(errors="replace")
        return self.heard

    log = listen

    def say(self, *lines):
        self.process.stdin.write("".join(f"{line}\n" for line in lines).encode())
        self.process.stdin.flush()

    def hear(self, word):
        """What was said since the last time, when a line with that beginning is in it."""
        def found():
            new = self.listen()[self.read:]
            lines = new.splitlines(keepends=True)
            return any(l.startswith(word) and l.endswith("\n") for l in lines) and new

        new = until(found, 10, f"{word!r} is said")
        self.read += len(new)
        return new


def version_of(scene):
    """Of OpenPLC, in this case."""
    return getattr(scene, "openplc", 3)


class Plc(Spoken):
    SIZES = {"X": "B", "B": "B", "W": "H", "D": "I", "L": "Q"}

    def __init__(self, scene, daemon, text):
        path = scene.file("openplc.map", f"instance {getattr(daemon, 'name', daemon)}\n{text}")
        super().__init__(scene, [plc_program(version_of(scene))], {"OWSD_OPENPLC_MAP": str(path)})

    def cell(self, area, size, index=0, bit=0, kind=None):
        """A variable; kind says as what its bits are to be read (a letter of struct)."""
        self.say(f"show {area} {size} {index} {bit}")
        value = int(self.hear("cell").split("cell ")[1].split()[0])
        return struct.unpack(kind, struct.pack(self.SIZES[size], value))[0] if kind else value


class Hal(Spoken):
    def __init__(self, scene, daemon, *arguments):
        super().__init__(scene, [hal_program(), "-n", getattr(daemon, "name", daemon), "-p", "20",
                                 *arguments])

    def pins(self):
        self.say("show")
        rows = [line.split() for line in self.hear("end").splitlines()]
        return {row[0]: (row[1], row[2], float(row[3])) for row in rows if len(row) == 4}

    def pin(self, name):
        return self.pins()[f"owsd.{name}"][2]


def plant(scene, temperature="21.5"):
    """The configuration of a room with a relay that is read back."""
    sim = scene.file("plant.sim", "i2c speed 400\nchip DS2482-100 0x18\n"
                     f"DS18B20 {ROOM[1:]} resolution 9 temperature {temperature}\n"
                     f"DS2413 {RELAY[1:]}\n")
    return owsdtest.rio(f"sim:{sim}", [
        dict(Name="room1", Path=f"{ROOM}/temperature9", Type="double", Uncached=owsdtest.raw("on")),
        dict(Name="heater", Path=f"{RELAY}/PIO.A", Type="bool", IO="output", InitValue="0",
             SafeValue="0"),
        dict(Name="wire", Path=f"{RELAY}/PIO.A", Type="bool", Uncached=owsdtest.raw("on")),
        dict(Name="kind", Path=f"{ROOM}/type", Type="string"),
    ], Period=0.05)


def wire(scene, daemon, state):
    scene.until(lambda: scene.get(daemon, "wire") == str(state), 10, f"the relay is {state}")


def kill_without_names(daemon):
    """Its segments cannot be found by the next, who could say there that he has others."""
    daemon.freeze()
    for kind in ("image",):
        os.unlink(owsdtest.segment(daemon.name, kind))
    daemon.kill()


def test_a_plc_program_reads_a_temperature_and_drives_a_relay(scene):
    daemon = scene.owsd(plant(scene, "square 19 23 4s"))
    plc = Plc(scene, daemon, "%IW0 room1 scale 100\n%IX0.0 room1 quality\n%QX0.0 heater\n"
                             "%IX0.2 heater quality\n")
    plc.say("thermostat")
    for state in (1, 0, 1):
        wire(scene, daemon, state)
    assert plc.cell("I", "W") in (1900, 2300)
    until(lambda: plc.cell("I", "X", 0, 2) == 1, 10, "the output is good")


def test_a_plc_knows_that_owsd_is_gone_and_goes_on_when_it_is_back(scene):
    config = plant(scene, "19")
    daemon = scene.owsd(config)
    plc = Plc(scene, daemon, "%IW0 room1 scale 100\n%IX0.0 room1 quality\n%QX0.0 heater\n")
    plc.say("thermostat")
    wire(scene, daemon, 1)
    daemon.kill()
    until(lambda: plc.cell("I", "X") == 0, 10, "the temperature is not good")
    until(lambda: plc.cell("Q", "X") == 0, 10, "the program switches off")
    assert plc.cell("I", "W") == 1900, "the last value stays"
    daemon = scene.owsd(config, name=daemon.name)
    until(lambda: plc.cell("I", "X") == 1, 10, "the temperature is good")
    wire(scene, daemon, 1)
    kill_without_names(daemon)
    daemon = scene.owsd(config, name=daemon.name)
    until(lambda: plc.cell("I", "X") == 1, 10, "the temperature is good")
    wire(scene, daemon, 1)


def test_a_plc_that_was_started_before_owsd_waits_for_it(scene):
    name = scene.name()
    plc = Plc(scene, name, "%IW0 room1 scale 100 else -9999\n%IX0.0 room1 quality\n%QX0.0 heater\n")
    assert plc.cell("I", "X") == 0 and plc.cell("I", "W", kind="h") == -9999
    daemon = scene.owsd(plant(scene), name=name)
    until(lambda: plc.cell("I", "X") == 1, 10, "the temperature is good")
    until(lambda: plc.cell("I", "W") == 2150, 10, "and there")
    plc.say("set Q X 0 0 1")
    wire(scene, daemon, 1)


def test_variables_of_every_size_get_the_value_as_their_type(scene):
    daemon = scene.owsd(plant(scene, "-12.5"))
    plc = Plc(scene, daemon, "%IW0 room1 scale 10\n%ID0 room1 real\n%ID1 room1 dint scale 1000\n"
                             "%IL0 room1 lreal\n%IL1 room1 scale 1e6\n%IB0 room1 sint\n"
                             "%IX1.0 room1 quality\n%IX1.1 wire\n%IW900 room1\n")
    until(lambda: plc.cell("I", "X", 1, 0) == 1, 10, "the temperature is good")
    assert plc.cell("I", "W", 0, kind="h") == -125
    assert plc.cell("I", "D", 0, kind="f") == -12.5
    assert plc.cell("I", "D", 1, kind="i") == -12500
    assert plc.cell("I", "L", 0, kind="d") == -12.5
    assert plc.cell("I", "L", 1, kind="q") == -12500000
    assert plc.cell("I", "B", 0, kind="b") == -13


def test_a_value_that_its_variable_cannot_hold_is_not_good(scene):
    daemon = scene.owsd(plant(scene, "-12.5"))
    plc = Plc(scene, daemon, "%IW0 room1 uint\n%IX0.0 room1 quality\n%IX0.1 wire quality\n")
    until(lambda: plc.cell("I", "X", 0, 1) == 1, 10, "owsd is there")
    until(lambda: "%IW0 room1: Numerical result out of range" in plc.listen(), 10, "it says so")
    assert plc.cell("I", "X", 0, 0) == 0 and plc.cell("I", "W") == 0


def test_a_variable_that_cannot_hold_its_value_is_said_once_beside_one_that_can(scene):
    daemon = scene.owsd(plant(scene, "-12.5"))
    plc = Plc(scene, daemon, "%IB0 room1 usint\n%IW0 room1 scale 10\n%ID0 room1_PerCount\n")
    until(lambda: "%IB0 room1: Numerical result" in plc.listen(), 10, "it says so")
    counts = set()
    until(lambda: counts.add(plc.cell("I", "D")) or len(counts) >= 2, 10, "cycles go on")
    assert plc.listen().count("%IB0 room1: ") == 1, plc.listen()


def test_a_plc_that_stops_switches_off_and_one_that_dies_leaves_the_safe_value(scene):
    daemon = scene.owsd(plant(scene))
    plc = Plc(scene, daemon, "%QX0.0 heater\n")
    plc.say("set Q X 0 0 1")
    wire(scene, daemon, 1)
    plc.say("stop")
    assert plc.wait() == 0
    wire(scene, daemon, 0)
    plc = Plc(scene, daemon, "%QD0 heater\n")
    plc.say("set Q D 0 0 1")
    wire(scene, daemon, 1)
    plc.say("stop")
    assert plc.wait() == 0
    wire(scene, daemon, 0)
    plc = Plc(scene, daemon, "%QX0.0 heater\n")
    plc.say("set Q X 0 0 1")
    wire(scene, daemon, 1)
    plc.kill()
    wire(scene, daemon, 0)


def test_a_plc_does_not_run_with_a_map_that_says_nothing_sure(scene):
    for line, words in (("%IW0", "of which signal"), ("%ZW0 room1", "no variable"),
                        ("%IX0 room1", "no variable"), ("%IW0.1 room1", "no variable"),
                        ("%IW1024 room1", "beyond"), ("%IX0.8 room1", "beyond"),
                        ("%QL0 heater", "%QL"), ("%IW0 room1 scale 0", "not 0"),
                        ("%IW0 room1 real", "'real'"), ("%QX0.0 heater else 1", "inputs"),
                        ("%QX0.0 heater quality", "%IX"), ("%IW0 a\n%IW0 b", "already there")):
        if line.startswith("%QL") and version_of(scene) == 4:
            continue
        plc = Plc(scene, "none", "# the map\n" + line + "\n")
        assert plc.wait() == 1, line
        number = 3 + line.count("\n")
        assert f"openplc.map:{number}: " in plc.listen() and words in plc.listen(), plc.listen()


def test_a_signal_that_is_not_there_is_said_and_not_good(scene):
    daemon = scene.owsd(plant(scene))
    plc = Plc(scene, daemon, "%IX0.0 nobody quality\n%QX0.1 nobody\n%IX0.1 room1 quality\n")
    until(lambda: plc.cell("I", "X", 0, 1) == 1, 10, "owsd is there")
    assert plc.cell("I", "X", 0, 0) == 0
    assert plc.listen().count("no signal nobody") == 1


def test_the_map_and_the_plant_of_the_example_belong_together(scene):
    shutil.copy(EXAMPLES / "openplc/plant.sim", scene.path)
    daemon = scene.owsd((EXAMPLES / "openplc/plant.rio").read_text())
    text = (EXAMPLES / "openplc/openplc.map").read_text().replace("instance OWS", "")
    plc = Plc(scene, daemon, text)
    for bit in range(3):
        until(lambda: plc.cell("I", "X", 0, bit) == 1, 10, f"%IX0.{bit} is good")
    assert plc.cell("I", "D", 0, kind="f") == 55
    assert "no signal" not in plc.listen()


def with_4(case):
    def case_with_4(scene):
        scene.openplc = 4
        case(scene)
    return case_with_4


# each case of OpenPLC 3 as one of OpenPLC 4
for _name, _case in [(n, c) for n, c in globals().items() if n.startswith("test_")]:
    globals()[f"{_name}_with_openplc_4"] = with_4(_case)


def test_signals_are_pins_of_their_type_and_a_text_is_left_out(scene):
    daemon = scene.owsd(plant(scene))
    hal = Hal(scene, daemon)
    hal.hear("ready")
    until(lambda: hal.pin("room1.ok") == 1, 10, "the temperature is good")
    pins = hal.pins()
    assert pins["owsd.room1"] == ("float", "out", 21.5)
    assert pins["owsd.room1.age"][:2] == ("float", "out") and pins["owsd.room1.age"][2] < 300
    assert pins["owsd.heater"][:2] == ("bit", "in") and pins["owsd.wire"][:2] == ("bit", "out")
    assert pins["owsd.alive"][:2] == ("bit", "out")
    until(lambda: hal.pin("alive") == 1, 10, "owsd is alive")
    assert "owsd.kind" not in pins and "owsd_hal: kind: " in hal.listen()


def test_a_pin_that_is_set_drives_the_relay(scene):
    daemon = scene.owsd(plant(scene))
    hal = Hal(scene, daemon, "heater", "room1_Age")
    hal.hear("ready")
    hal.say("setp owsd.heater 1")
    wire(scene, daemon, 1)
    until(lambda: hal.pin("heater.ok") == 1, 10, "the output is good")
    assert set(hal.pins()) == {f"owsd.{n}" for n in (
        "alive", "heater", "heater.ok", "heater.age", "room1_Age", "room1_Age.ok", "room1_Age.age")}
    # Loaded while the relay is on, it changes nothing by itself
    hal.kill()
    wire(scene, daemon, 0)
    scene.owsctl(daemon, "set", "heater", "1")
    wire(scene, daemon, 1)
    hal = Hal(scene, daemon, "heater")
    hal.hear("ready")
    owsdtest.worked(daemon.name, 0.3)
    assert hal.pin("heater") == 1
    until(lambda: scene.get(daemon, "heater") == "1", 10, "it stays on")
    wire(scene, daemon, 1)


def test_pins_that_are_linked_follow_their_signal(scene):
    daemon = scene.owsd(plant(scene, "square 19 23 2s"))
    hal = Hal(scene, daemon)
    hal.hear("ready")
    hal.say("net owsd.room1", "net owsd.room1.ok", "net owsd.alive", "net owsd.heater",
            "setp owsd.heater 1", "setp owsd.alive 0", "setp owsd.room1.ok 0")
    wire(scene, daemon, 1)
    until(lambda: hal.pin("alive") == 1 and hal.pin("room1.ok") == 1, 10, "the linked pins live")
    for value in (19, 23, 19):
        until(lambda: hal.pin("room1") == value, 10, f"room1 is {value}")


def test_a_machine_goes_on_when_owsd_is_killed_and_when_it_is_back(scene):
    config = plant(scene)
    daemon = scene.owsd(config)
    hal = Hal(scene, daemon)
    hal.hear("ready")
    hal.say("setp owsd.heater 1")
    wire(scene, daemon, 1)
    until(lambda: hal.pin("room1.ok") == 1, 10, "the temperature is good")
    daemon.kill()
    until(lambda: not (hal.pin("room1.ok") or hal.pin("heater.ok") or hal.pin("alive")), 10,
          "nothing is good")
    assert hal.running() and hal.pin("room1") == 21.5
    daemon = scene.owsd(config, name=daemon.name)
    until(lambda: hal.pin("room1.ok") and hal.pin("heater.ok") and hal.pin("alive"), 10,
          "all is good again")
    wire(scene, daemon, 1)
    kill_without_names(daemon)
    daemon = scene.owsd(config, name=daemon.name)
    until(lambda: hal.pin("room1.ok") and hal.pin("heater.ok") and hal.pin("alive"), 10,
          "all is good in the new image")
    wire(scene, daemon, 1)


def test_a_pin_whose_signal_has_another_type_after_a_reload_is_not_ok(scene):
    def has_type(name):
        rows = json.loads(scene.owsctl(daemon, "--json", "list").stdout)
        return next(r for r in rows if r["name"] == "room1")["type"] == name

    config = scene.file("plant.rio", plant(scene, "21"))
    daemon = scene.owsd(config)
    config.write_text(config.read_text().replace('"double"', '"long"'))
    daemon.signal(signal.SIGHUP)
    until(lambda: has_type("long") and scene.get(daemon, "room1") == "21", 10, "it is a whole number")
    hal = Hal(scene, daemon, "room1", "wire")
    hal.hear("ready")
    until(lambda: hal.pin("room1.ok") == 1, 10, "the temperature is good")
    before = hal.pins()["owsd.room1"]
    assert before[0] == "s32" and before[2] == 21
    config.write_text(config.read_text().replace('"long"', '"double"'))
    daemon.signal(signal.SIGHUP)
    until(lambda: has_type("double"), 10, "it may have a fraction again")
    until(lambda: "room1: " in hal.listen(), 10, f"it says so: {hal.pins()}")
    until(lambda: hal.pin("wire.ok") == 1, 10, "the other one is")
    pins = hal.pins()
    assert pins["owsd.room1.ok"][2] == 0 and pins["owsd.room1"] == before, pins


def test_outputs_go_to_their_safe_value_when_the_component_is_unloaded(scene):
    daemon = scene.owsd(plant(scene))
    hal = Hal(scene, daemon)
    hal.hear("ready")
    hal.say("setp owsd.heater 1")
    wire(scene, daemon, 1)
    hal.signal(signal.SIGTERM)
    assert hal.wait() == 0
    wire(scene, daemon, 0)


def test_a_component_that_cannot_have_its_signals_is_not_loaded(scene):
    daemon = scene.owsd(plant(scene))
    hal = Hal(scene, daemon, "nobody")
    assert hal.wait() == 1
    assert "owsd_hal: nobody: " in hal.listen()
    hal = Hal(scene, scene.name(), "-w", "0")
    assert hal.wait() == 1
    assert "cannot open owsd" in hal.listen()
    long = "a" * 40
    hal = Hal(scene, daemon, "-c", long, "room1")
    assert hal.wait() == 1
    assert "room1: File name too long" in hal.listen()


if __name__ == "__main__":
    owsdtest.main(4)
