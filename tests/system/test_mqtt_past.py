#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No lost minute: what a broker of Sparkplug misses comes from the recorder's file, after the live
values, with the time of measurement."""

import contextlib
import json
import sqlite3
import time

import owsdtest
from mqtthouse import RELAY, SWITCH, Listener, item
from owsdtest import BUILD, logged, raw, until
from test_mqtt_commands import publish
from test_mqtt_sparkplug import Host, start

RECORDER = BUILD / "owsd-recorder"
DIAL = item("dial", f"/{SWITCH}/PIO.BYTE", "byte", "output")


class Plant:
    """A house that records, its host, and what the dial was set to: [(value, when)]."""

    def __init__(self, scene, flush=1, **keys):
        owsdtest.need(RECORDER)
        self.scene, self.was, self.got = scene, [], []
        self.env = {"STATE_DIRECTORY": str(scene.path / "state")}
        block = raw(f'{{ Flush {flush} Directory "{scene.path / "history"}" }}')
        self.house, self.host = start(scene, DIAL, env=self.env, top={"Recorder": block}, **keys)
        self.house.face.stop()
        self.record()
        self.house.face = self.house.start(self.env)
        if "PrimaryHost" in keys:
            self.say(True)
        self.host.hears("dbirth", SWITCH, after=len(self.host.heard))

    def record(self):
        self.recorder = self.scene.start([RECORDER, "-n", self.house.daemon.name, "-c", self.house.daemon.config])
        until(lambda: "recording " in self.recorder.log(), 20, lambda: self.recorder.log())

    def say(self, online):
        publish(self.house, "spBv1.0/STATE/scada", json.dumps({"timestamp": int(time.time() * 1000), "online": online}), "-r")

    def turn(self, *values):
        for value in values:
            self.house.set("dial", str(value))
            self.was.append((value, time.time()))

    def back(self):
        """The broker is there again; who listens is a new one."""
        self.got += self.metrics()
        self.house.broker.start()
        self.host = Host(Listener(self.scene, self.house.broker.port, "spBv1.0/#", ["-F", "=%q\t%r\t%t\t%x"]))

    def metrics(self):
        """[(message, value, time, historical)] of the dial, as it came since back()."""
        self.host.look()
        return [(i, m.value, m.timestamp.timestamp() if hasattr(m.timestamp, "timestamp") else m.timestamp / 1000,
                 bool(m.is_historical)) for i, device, m in self.host.metrics if device == SWITCH and m.value is not None]

    def all(self):
        return self.got + self.metrics()

    def has(self, value):
        """That is the newest value, and the broker has answered for it."""
        until(lambda: [m[1] for m in self.metrics()][-1:] == [value], 20, self.metrics)
        until(lambda: self.house.broker.process.log().rpartition("PUBLISH from owsd-pi7")[2].count("Sending UNSUBACK to owsd-pi7"),
              20, lambda: self.house.broker.process.log())
        publish(self.house, "any", "")  # it logs the answer before it sends it

    def complete(self):
        """Each change is there once with its right time."""
        def same():
            rows = sorted(self.all(), key=lambda m: m[2])
            runs = [m for n, m in enumerate(rows) if n == 0 or m[1] != rows[n - 1][1]]
            runs = runs[1:] if runs and runs[0][1] != self.was[0][0] else runs
            return [m[1] for m in runs] == [v for v, _ in self.was] and \
                all(abs(m[2] - when) < 3 for m, (_, when) in zip(runs, self.was))
        until(same, 60, lambda: f"{self.was}\n{sorted(self.all(), key=lambda m: m[2])}\n{self.house.face.log()}")

    def after_the_live_ones(self):
        rows = self.metrics()
        first = next(i for i, *_, historical in rows if historical)
        assert first > min(i for i, *_, historical in rows if not historical), rows
        return [m for m in rows if m[3]]


def test_what_a_broker_that_was_killed_has_missed_comes_after_the_live_values(scene):
    plant = Plant(scene)
    plant.turn(1, 2, 3)
    plant.has(3)
    plant.house.broker.process.kill()
    plant.turn(4, 5, 6)
    plant.back()
    plant.turn(7)
    plant.complete()
    past = plant.after_the_live_ones()
    # the last one may be that of the birth, which has its time
    assert [value for _, value, *_ in past] in ([4, 5], [4, 5, 6]), (past, plant.house.face.log())


def test_a_face_that_is_killed_in_the_middle_goes_on_where_the_broker_was(scene):
    plant = Plant(scene)
    plant.turn(1)
    plant.has(1)
    plant.house.broker.process.kill()
    logged(plant.house.face, "is lost")
    plant.turn(2, 3)
    plant.house.face.kill()
    plant.turn(4, 5)
    plant.back()
    plant.house.face = plant.house.start(plant.env)
    plant.turn(6)
    until(lambda: any(m[3] for m in plant.metrics()), 30, lambda: plant.house.face.log())
    plant.house.face.kill()
    plant.turn(7, 8)
    plant.house.face = plant.house.start(plant.env)
    plant.turn(9)
    plant.complete()


def test_times_are_right_though_the_clock_was_wrong_when_they_were_recorded(scene):
    plant = Plant(scene)
    plant.turn(1)
    plant.has(1)
    plant.house.broker.process.kill()
    plant.turn(2, 3)
    assert plant.recorder.stop() == 0
    with contextlib.closing(sqlite3.connect(scene.path / "history" / "history.sqlite")) as db:
        db.execute("update session set date = date - 3600000000, trusted = 0")
        db.commit()
    plant.back()
    plant.complete()
    plant.record()
    plant.turn(4)
    plant.complete()


def test_rows_that_the_recorder_writes_later_come_later(scene):
    plant = Plant(scene, flush=5)
    plant.turn(1)
    plant.has(1)
    plant.house.broker.process.kill()
    plant.turn(2, 3, 2)
    plant.back()
    plant.turn(4)
    plant.complete()


def test_what_a_host_that_was_away_has_missed_comes_when_it_is_back(scene):
    plant = Plant(scene, PrimaryHost="scada")
    plant.turn(1)
    plant.has(1)
    plant.say(False)
    logged(plant.house.face, "the primary host scada is offline")
    plant.turn(2, 3, 4)
    plant.say(True)
    plant.complete()
    plant.after_the_live_ones()


def test_without_a_history_it_says_so_once(scene):
    house, host = start(scene, RELAY)
    host.hears("dbirth", SWITCH)
    words = "what the broker misses is not sent again"
    logged(house.face, words)
    house.broker.process.kill()
    house.broker.start()
    host = Host(Listener(scene, house.broker.port, "spBv1.0/#", ["-F", "=%q\t%r\t%t\t%x"]))
    host.hears("dbirth", SWITCH)
    assert house.face.log().count(words) == 1, house.face.log()


if __name__ == "__main__":
    owsdtest.main(at_once=2)
