# SPDX-License-Identifier: MIT
"""owsd-recorder beside an owsd on a simulated house, and what its history has:

    daemon = scene.owsd(recorded.text(scene))
    recorder = recorded.record(scene, daemon)
    recorded.set_relays(scene, daemon, 5)
    assert recorder.stop() == 0
    assert recorded.Past(scene).good("relays") == ["5"]

What changes between the recorder's last look and its end is not known: it looks each second at
least.
"""

import time

import owsdtest
from owsdtest import BUILD, raw, until

RECORDER, HISTORY = BUILD / "owsd-recorder", BUILD / "system" / "history"
SENSOR, RELAY = "/28.A0B1C2000001", "/29.A0B1C2000004"
GOOD = "c0"


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", SENSOR + "/temperature", LimitH=raw("20"))
RELAYS = item("relays", RELAY + "/PIO.BYTE", "byte", "output")
TITLE = item("title", SENSOR + "/type", "string", PerFactor=20)


def text(scene, *items, flush=1, **recorder):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\n"
                      "DS18B20 28.A0B1C2000001 temperature 21.5\nDS2408 29.A0B1C2000004\n")
    keys = " ".join(f"{k} {v}" for k, v in {"Flush": flush, **recorder}.items())
    return owsdtest.rio(f"sim:{wire}", items or (ROOM, RELAYS, TITLE), Period=0.05, Timeout=3,
                        Recorder=raw(f"{{ {keys} }}"))


def record(scene, daemon, *options, prefix=(), wait=True, directory=None):
    """Into DIRECTORY, else the folder history of the scene; returns when it records."""
    owsdtest.need(RECORDER)
    recorder = scene.start([*prefix, RECORDER, "-n", daemon.name, "-c", daemon.config, "-d",
                            directory or scene.path / "history", *options])
    if wait:
        until(lambda: "recording " in recorder.log(), 20, "it records")
    return recorder


def set_relays(scene, daemon, value):
    done = scene.owsctl(daemon, "set", "-w", "20", "relays", value)
    assert done.returncode == 0, done


def recorded(scene, name, value, directory=None):
    """Wait until that is the last good value of the signal that is on the disk."""
    until(lambda: Past(scene, directory).good(name)[-1:] == [value], 20, f"{name} {value} is recorded")


class Past:
    """What the history has: of each signal (time, value or None, quality or reason); events."""

    def __init__(self, scene, directory=None):
        owsdtest.need(HISTORY)
        done = scene._run([HISTORY, directory or scene.path / "history"], 30)
        assert done.returncode == 0 and not done.stderr, done
        self.signals, self.events = {}, []
        for line in done.stdout.splitlines():
            name, *words = line.split(" ")
            if name == "!":
                self.events.append(words)
                continue
            value = None if words[1] == "-" else words[1]
            rest = " ".join(words[2:])
            self.signals.setdefault(name, []).append((float(words[0]), value, rest))

    def good(self, name):
        return [value for _, value, quality in self.signals.get(name, []) if quality == GOOD]

    def at(self, name, boot):
        """The value that is held at that time; None: nothing is known."""
        held = None
        for when, value, quality in self.signals[name]:
            if when <= boot:
                held = value if quality == GOOD else None
        return held

    def kinds(self, kind):
        return [words for words in self.events if words[0] == kind]


def boot():
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def distinct(values):
    """Runs of the same value count once: it is recorded anew after a gap."""
    return [v for n, v in enumerate(values) if n == 0 or v != values[n - 1]]
