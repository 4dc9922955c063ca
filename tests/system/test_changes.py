#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Changes of a running owsd: each is given, so are stale values, its loss, its return, a reload."""

import signal
import time

import owsdtest
from owsdtest import raw, until
from test_serve_crowd import wakes

import ows  # of owsdtest.PYTHON

ITEMS = [dict(Name="room", Path="/28.A0B1C2000001/temperature", Type=raw("double"), IO=raw("input")),
         dict(Name="relays", Path="/29.A0B1C2000004/PIO.BYTE", Type=raw("byte"), IO=raw("output")),
         dict(Name="rare", Path="/28.A0B1C2000002/temperature", Type=raw("double"), IO=raw("input"),
              PerFactor=100000, StaleAfter=2)]
NAMES = [item["Name"] for item in ITEMS]


def start(scene):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n"
                                   "DS18B20 28.A0B1C2000002 temperature 12\nDS2408 29.A0B1C2000004\n")
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", ITEMS, Period=0.05))
    until(lambda: scene.get(daemon, "room") == "21.5", 10, "room is good")
    return daemon, ows.Ows(daemon.name)


def follow(changes, wanted):
    """Rounds until one is as wanted; it must come, and no round without a change before it."""
    end = time.monotonic() + owsdtest.PATIENCE
    for names in changes:
        assert names and time.monotonic() < end
        if wanted(names):
            return names
    return None


def everything(names):
    return names.everything


def has(name):
    return lambda names: not names.everything and name in names


def test_a_command_a_reading_and_a_value_that_turns_stale_are_changes(scene):
    daemon, signals = start(scene)
    changes = signals.changes(owsdtest.PATIENCE)
    assert next(changes) == NAMES
    follow(changes, has("room"))
    scene.owsctl(daemon, "set", "relays", "5")
    follow(changes, lambda names: "relays" in names and signals.get("relays").value == 5)
    if signals.get("rare").good:
        follow(changes, has("rare"))
    assert signals.get("rare").quality == ows.Q_STALE


def test_an_owsd_that_hangs_is_lost_and_comes_back(scene):
    daemon, signals = start(scene)
    changes = signals.changes(owsdtest.PATIENCE)
    next(changes)
    daemon.freeze()
    follow(changes, everything)
    assert not any(signals.get(name).good for name in NAMES)
    daemon.thaw()
    follow(changes, everything)
    follow(changes, lambda names: "room" in names and signals.get("room").good)


def reopened(signals):
    try:
        signals.reopen()
    except FileNotFoundError:
        return False
    return True


def go_over(signals, changes):
    """Follow to the next image, and until the room is read there."""
    try:
        while True:
            assert next(changes)
    except ows.Stale:
        until(lambda: reopened(signals), 10, "the new image is there")
    assert next(changes).everything
    if not signals.get("room").good:
        follow(changes, lambda names: "room" in names and signals.get("room").good)


def test_who_follows_outlives_a_reload_a_kill_and_an_end(scene):
    daemon, signals = start(scene)
    changes = signals.changes(owsdtest.PATIENCE)
    next(changes)
    config = open(daemon.config, encoding="utf-8").read()
    with open(daemon.config, "w", encoding="utf-8") as file:
        file.write(config.replace("100000", "200000"))
    daemon.signal(signal.SIGHUP)
    go_over(signals, changes)
    for leave in ("kill", "stop"):
        getattr(daemon, leave)()
        follow(changes, everything)
        assert not any(signals.get(name).good for name in NAMES)
        daemon = scene.owsd(daemon.config, name=daemon.name)
        go_over(signals, changes)


def test_a_busy_owsd_whose_changes_nobody_waits_for_wakes_no_thread_for_each(scene):
    server = scene.owserver(fake=["28"] * 20)
    items = [dict(Name=f"t{i}", Path=f"{path}/temperature", Type=raw("double"), IO=raw("input"))
             for i, path in enumerate(server.devices())]
    daemon = scene.owsd(owsdtest.rio(server.target, items, Period=0.01))
    signals = ows.Ows(daemon.name)
    seen = []

    def spared():
        seen[:] = seen[-1:] + [(wakes(daemon, "owsd-news")[0], signals.get("_TRANSACTIONS").value)]
        return len(seen) == 2 and 5 * (seen[1][0] - seen[0][0]) < seen[1][1] - seen[0][1]
    until(spared, 20, lambda: f"few wakes for many readings: {seen}", 0.5)
    # who comes to wait is woken all the same
    changes = signals.changes(owsdtest.PATIENCE)
    next(changes)
    follow(changes, has("t7"))


if __name__ == "__main__":
    owsdtest.main()
