#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No lost minute: what a broker of Sparkplug misses comes from the recorder's file, after the live
values, with the time of measurement."""

import collections
import contextlib
import itertools
import json
import random
import sqlite3
import time

import owsdtest
from mqtthouse import RELAY, ROOM, SWITCH, Listener, item
from owsdtest import BUILD, logged, raw, settled, until
from test_mqtt_commands import publish
from test_mqtt_sparkplug import Host, start

RECORDER = BUILD / "owsd-recorder"
DIAL = item("dial", f"/{SWITCH}/PIO.BYTE", "byte", "output")
PROBE = "28.A0B1C2000009"


class Plant:
    """A house that records, its host, and what the dial was set to: [(value, when)]."""

    def __init__(self, scene, *items, flush=1, **keys):
        owsdtest.need(RECORDER)
        self.scene, self.was, self.got = scene, [], []
        self.env = {"STATE_DIRECTORY": str(scene.path / "state")}
        block = raw(f'{{ Flush {flush} Directory "{scene.path / "history"}" }}')
        self.house, self.host = start(scene, DIAL, *items, env=self.env, top={"Recorder": block}, **keys)
        self.house.face.stop()
        self.record()
        self.house.face = self.house.start(self.env)
        if "PrimaryHost" in keys:
            self.say(True)
        self.host.hears("dbirth", SWITCH, after=len(self.host.heard))

    @property
    def file(self):
        return self.scene.path / "history" / "history.sqlite"

    @property
    def reached(self):
        return next((self.scene.path / "state").rglob("reached"))

    def recorded(self, *values):
        """They are in the file."""
        def there():
            with contextlib.closing(sqlite3.connect(self.file)) as db:
                return [int(v) for v, in db.execute("select value from raw join signal using (signal) where name = 'dial' order by id")]
        until(lambda: there()[-len(values):] == list(values), 20, there)

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
        """The broker is there again; who listens is a new one, and hears all."""
        self.got += self.metrics()
        if self.house.face.running():
            self.house.face.freeze()
        self.house.broker.start()
        self.host = Host(Listener(self.scene, self.house.broker.port, "spBv1.0/#", ["-F", "=%q\t%r\t%t\t%x"]))
        self.house.face.thaw()

    def metrics(self):
        """[(message, value, time, historical)] of the dial, as it came since back()."""
        self.host.look()
        return [(i, m.value, m.timestamp.timestamp() if hasattr(m.timestamp, "timestamp") else m.timestamp / 1000,
                 bool(m.is_historical)) for i, device, m in self.host.metrics if device == SWITCH and m.value is not None]

    def all(self):
        return self.got + self.metrics()

    def arrives(self, value):
        until(lambda: [m[1] for m in self.metrics()][-1:] == [value], 20, self.metrics)

    def has(self, value):
        """That is the newest value, and the broker has answered for it."""
        self.arrives(value)
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
    for value in (1, 2, 3):
        plant.turn(value)
        plant.arrives(value)  # of changes that are less than 50 ms apart only the newest goes out
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


def certain(plant):
    """Up to then the broker had all, as was written down: 2 s before that nothing comes again."""
    numbers = plant.reached.read_text().split()[4:-1]
    walls = [int(number) / 1e6 for number in numbers[2::3]]
    return min(walls[:1] + walls[2::2]) - 2.1


def births(plant):
    return [verb for verb, *_ in settled(lambda: list(plant.host.look()))].count("nbirth")


def test_after_kills_at_any_moment_only_what_was_not_certain_comes_again(scene):
    plant, chance = Plant(scene), random.Random(20)
    least = {}  # by the number of the session: its history begins after that
    plant.house.face.kill()
    for value in range(1, 151):
        if not plant.house.face.running():
            least[births(plant)] = certain(plant)  # of one that is killed before its birth the next one's counts
            plant.house.face = plant.house.start(plant.env)
            due = time.time() + chance.uniform(0.05, 4)
        plant.turn(value)
        time.sleep(0.08)  # of changes that are less than 50 ms apart only the newest goes out
        if time.time() > due:
            plant.house.face.kill()
    if not plant.house.face.running():
        least[births(plant)] = certain(plant)
        plant.house.face = plant.house.start(plant.env)
    plant.complete()
    verbs, came = [verb for verb, *_ in plant.host.heard], collections.Counter()
    for session, moment in least.items():
        rows = [m for m in plant.metrics() if m[3] and verbs[:m[0] + 1].count("nbirth") == session + 1]
        assert len({m[1] for m in rows}) == len(rows), (session, rows)  # once in one session
        assert not [m for m in rows if m[2] < moment], (session, moment, rows)
        came.update(m[1] for m in rows)
    print(f"# figure: after {len(least)} kills {len(came)} of 150 values came from the history, {max(came.values())} times at most")
    assert len(least) > 5, least


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


def test_a_history_that_comes_after_owsd_mqtt_is_taken_up_with_what_was_kept(scene):
    plant = Plant(scene)
    plant.turn(1)
    plant.has(1)
    assert plant.house.face.stop() == 0
    plant.turn(2, 3)
    plant.recorded(2, 3)
    assert plant.recorder.stop() == 0
    away = plant.file.rename(plant.file.with_name("away"))
    plant.house.face = plant.house.start(plant.env)
    logged(plant.house.face, "what the broker misses is not sent again")
    until(lambda: plant.metrics()[-1][1] == 3, 20, plant.metrics)
    plant.turn(4)
    until(lambda: plant.metrics()[-1][1] == 4, 20, plant.metrics)
    assert not [m for m in plant.metrics() if m[3]], plant.metrics()
    away.rename(plant.file)
    plant.record()
    logged(plant.house.face, "there is a history of owsd-recorder now")
    plant.complete()
    # and the session goes on as one that began with it
    plant.turn(5)
    plant.has(5)
    plant.house.broker.process.kill()
    plant.turn(6, 7)
    plant.back()
    plant.complete()


def test_what_was_after_a_boot_that_a_new_history_does_not_know_is_sent(scene):
    plant = Plant(scene)
    plant.turn(1)
    plant.has(1)
    assert plant.house.face.stop() == 0
    # the power was cut there, and the recorder began a new file
    name, version, key, count, boot, *moments = plant.reached.read_text().split()
    plant.reached.write_text(" ".join([name, version, key, count, str(int(boot) ^ 1), *moments]) + "\n")
    plant.turn(2, 3)
    plant.recorded(2, 3)
    plant.house.face = plant.house.start(plant.env)
    plant.turn(4)
    plant.complete()


def test_a_chip_that_is_away_is_born_once_for_what_it_had_and_dies_behind_it(scene):
    plant = Plant(scene, item("probe", f"/{PROBE}/temperature"), item("pull", "/simulator/pull", "bool", "output"),
                  wire=f"DS18B20 {PROBE} as probe temperature 5\nbutton pull unplug probe\n")
    plant.host.hears("dbirth", PROBE)
    plant.turn(1)
    plant.has(1)
    plant.house.broker.process.kill()
    plant.turn(2)
    plant.house.set("pull", "1")
    until(lambda: scene.owsctl(plant.house.daemon, "get", "probe").returncode, 20, "it is unplugged")
    plant.turn(3)
    plant.recorded(2, 3)
    assert plant.recorder.stop() == 0
    # more than goes in a batch, before its loss
    with contextlib.closing(sqlite3.connect(plant.file)) as db:
        (begin,), (end, number) = (db.execute(f"select {what} from raw join signal using (signal) where {which}").fetchone() for what, which in
                                   (("max(id)", "name = 'dial' and value = 2"), ("max(id), signal", "name = 'probe'")))
        step = (end - begin) // 1000
        assert step > 0, (begin, end)
        db.executemany("insert into raw (id, signal, value, quality) values (?, ?, ?, 192)",
                       [(begin + n * step, number, float(n)) for n in range(1, 901)])
        db.commit()
    plant.back()

    def values():
        return [m.value for _, device, m in plant.host.metrics if device == PROBE and m.is_historical and m.value is not None]
    until(lambda: plant.host.look() and values()[-1:] == [900.0], 60, lambda: (values()[-5:], plant.house.face.log()))
    # its birth had what it measured first; where that stands in the file after the face's start, it comes with the rest
    assert values()[-900:] == [float(n) for n in range(1, 901)] and set(values()[:-900]) <= {5.0}, values()
    plant.host.hears("ddeath", PROBE)
    verbs = [verb for verb, device, _ in settled(lambda: list(plant.host.look())) if device == PROBE]
    assert [verb for verb, _ in itertools.groupby(verbs)] == ["dbirth", "ddata", "ddeath"], verbs


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
