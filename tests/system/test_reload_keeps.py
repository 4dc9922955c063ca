#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reloads without end cost nothing: with all faces, a program that commands all the time and one
that does not, owsd and they have as many descriptors and memories as at the begin. RELOADS: how
many, three seconds apart."""

import json
import os
import time

import mqtthouse
import owsdtest
import recorded
from owsdtest import BUILD, PYTHON, raw, until

RELOADS = int(os.environ.get("RELOADS", "8"))
APART = 3  # owsd keeps what a controller had for two seconds
IDLE = """import ows, signal, sys
with ows.Ows(sys.argv[1], control=True) as o:
    o.set('relay', 1)
    signal.pause()
"""
BUSY = """import errno, ows, sys, time
with ows.Ows(sys.argv[1], control=True) as o:
    while True:
        try:
            o.set('other', int(time.monotonic() * 20) % 2)
        except OSError as e:
            if e.errno != errno.ESTALE:
                raise
            try:
                o.reopen()
            except OSError as e:  # owsd has 20 ms to answer: the next round tries again
                if e.errno in (errno.ENOSPC, errno.EACCES, errno.EPERM):
                    raise
        time.sleep(0.05)  # pace
"""


def holds(program):
    """How many descriptors it has, and how many of them are memories of controllers."""
    links = []
    for fd in owsdtest.open_files(program):
        try:
            links.append(os.readlink(f"/proc/{program.pid}/fd/{fd}"))
        except FileNotFoundError:
            pass
    return len(links), sum("owsd-controller" in link for link in links)


def counters(scene, daemon):
    rows = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["counters"]
    return {row["name"]: row["value"] for row in rows if row["name"].startswith("control_")}


def test_a_reload_costs_no_descriptor_no_memory_and_no_place(scene):
    blocks = {"Web": raw("{ Write on }"), "Recorder": raw("{ Flush 1 }"),
              "Influx": raw(f'{{ Url "http://127.0.0.1:{owsdtest.free_port()}/write" }}')}
    house = mqtthouse.House(
        scene, mqtthouse.ROOM, mqtthouse.RELAY,
        mqtthouse.item("other", f"/{mqtthouse.SWITCH}/PIO.1", "bool", "output"),
        mqtthouse.item("third", f"/{mqtthouse.SWITCH}/PIO.2", "bool", "output"),
        top=blocks, Write=raw("on"))
    daemon = house.daemon
    web = scene.start([BUILD / "owsd-web", "-n", daemon.name, "-c", daemon.config,
                       "-l", f"127.0.0.1:{owsdtest.free_port()}"])
    recorder = recorded.record(scene, daemon)
    programs = {"owsd": daemon, "mqtt": house.face, "web": web, "recorder": recorder}
    if "owsd-influx left-out" not in (BUILD / "with/libraries").read_text():
        programs["influx"] = scene.start([BUILD / "owsd-influx", "-n", daemon.name, "-c",
                                          daemon.config])
    for name, text in (("idle", IDLE), ("busy", BUSY)):
        programs[name] = scene.start(["python3", "-c", text, daemon.name], {"PYTHONPATH": str(PYTHON)})
    # owsd-mqtt has commanded once, and is idle then
    scene.start([mqtthouse.program("mosquitto_pub"), "-p", str(house.broker.port), "-t",
                 "owsd/pi7/third/set", "-m", "1"]).wait()
    for name in ("relay", "other", "third"):
        until(lambda: name in scene.owsctl(daemon, "who").stdout, 20, f"{name} is commanded")

    def reload(times):
        for _ in range(times):
            time.sleep(APART)  # pace
            done = scene.owsctl(daemon, "reload")
            assert done.returncode == 0, done
            ended = [name for name, one in programs.items() if not one.running()]
            assert not ended, ended

    def all_hold():
        return {name: holds(one) for name, one in programs.items()}

    # one welcome then lies unread in the socket of those that command no more, and one waits for it
    reload(2)
    time.sleep(APART)  # pace
    began = owsdtest.settled(all_hold, 40)
    joined = counters(scene, daemon)
    reload(RELOADS)
    until(lambda: all_hold() == began, 20, lambda: f"before {began}, now {all_hold()}")
    until(lambda: counters(scene, daemon)["control_connections"] == joined["control_connections"], 20,
          lambda: f"before {joined}, now {counters(scene, daemon)}")
    now = counters(scene, daemon)
    for name, count in joined.items():
        if name not in ("control_asked", "control_connections"):
            assert now[name] == count, f"{name}: {count}, now {now[name]}"


if __name__ == "__main__":
    owsdtest.main()
