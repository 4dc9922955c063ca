#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No lost minute, as a historian sees it: a primary host of Sparkplug with the genuine paho and the codec
of pysparkplug, which stores values by metric and time. The network is cut, the broker or the whole
machine is, the historian itself is, the clock is wrong at the boot: in the end it has each change with
its time."""

import contextlib
import json
import pathlib
import queue
import socket
import sqlite3
import threading
import time
import urllib.request
import uuid

import faulty
import owsdtest
from clients import python_client
from mqtthouse import MQTT, SENSOR, SWITCH, Broker, item
from owsdtest import BUILD, free_port, logged, raw, until
from test_influx import Victoria

RECORDER = BUILD / "owsd-recorder"
DIAL = item("dial", f"/{SWITCH}/PIO.BYTE", "byte", "output")


class Cable:
    """Between two: a relay of TCP that can hold what comes, or be cut with all that is under way."""

    def __init__(self, to):
        self.to, self.port, self.pairs, self.lock = to, free_port(), [], threading.Lock()
        self.entered = b""  # all that came in at the near end
        self.flows, self.whole = threading.Event(), True
        self.flows.set()
        self.listener = socket.create_server(("127.0.0.1", self.port))
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        with contextlib.suppress(OSError):
            while True:
                near, _ = self.listener.accept()
                self.flows.wait()
                with contextlib.suppress(OSError):
                    pair = near, socket.create_connection(("127.0.0.1", self.to))
                    with self.lock:
                        self.pairs.append(pair)
                    for one, other in (pair, pair[::-1]):
                        inside = queue.SimpleQueue()
                        threading.Thread(target=self.enter, args=(one, inside, one is near), daemon=True).start()
                        threading.Thread(target=self.leave, args=(one, inside, other), daemon=True).start()

    def enter(self, one, inside, near):
        """It takes what comes also while it holds."""
        with contextlib.suppress(OSError):
            while data := one.recv(65536):
                self.entered += data if near else b""
                inside.put(data)
        inside.put(b"")

    def leave(self, one, inside, other):
        with contextlib.suppress(OSError):
            while data := inside.get():
                self.flows.wait()
                other.sendall(data)
        # nothing of an end crosses a cable that is cut
        self.flows.wait()
        for end in (one, other):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def hold(self):
        self.flows.clear()

    def cut(self):
        """What it holds is lost, and both ends learn that the connection is."""
        with self.lock:
            for pair in self.pairs:
                for end in pair:
                    with contextlib.suppress(OSError):
                        end.shutdown(socket.SHUT_RDWR)
            self.pairs.clear()

    def go(self):
        self.flows.set()


class Historian:
    """A primary host. points: {(metric, ms): value}, of a value that is not good None."""

    def __init__(self, port, points=None, past=None):
        requirements = pathlib.Path(__file__).with_name("sparkplug.txt")
        paho = python_client("paho.mqtt.client", requirements, "sparkplug")
        self.pb = python_client("pysparkplug._protobuf", requirements, "sparkplug")
        self.points, self.past = {} if points is None else points, set() if past is None else past
        self.twice, self.names, self.heard, self.port = [], {}, [], port
        self.client = paho.Client(paho.CallbackAPIVersion.VERSION2, client_id="scada")
        self.client.reconnect_delay_set(1, 1)
        self.client.on_pre_connect = lambda client, _: client.will_set("spBv1.0/STATE/scada", self.state(False), 1, True)
        self.client.on_connect = lambda client, *_: client.subscribe("spBv1.0/plant/#")
        self.client.on_subscribe = lambda *_: self.say(True)
        self.client.on_message = lambda _client, _data, message: self.take(message.topic.split("/"), message.payload)
        self.client.connect_async("127.0.0.1", port, 5)
        self.client.loop_start()

    @staticmethod
    def state(online):
        return json.dumps({"online": online, "timestamp": int(time.time() * 1000)})

    def take(self, topic, data):
        verb = topic[2]
        self.heard.append("/".join(topic[2:]))
        if verb not in ("NBIRTH", "DBIRTH", "NDATA", "DDATA"):
            return
        for metric in self.pb.Payload.FromString(data).metrics:
            if verb.endswith("BIRTH"):
                self.names[metric.alias] = metric.name
            name, field = self.names[metric.alias], metric.WhichOneof("value")
            value = None if metric.is_null else getattr(metric, field)
            key = name, metric.timestamp
            if key in self.points and not verb.endswith("BIRTH"):
                self.twice.append((key, self.points[key], value))
            self.points[key] = value
            if metric.is_historical:
                self.past.add(key)
            self.store(name, metric, value)

    def store(self, name, metric, value):
        pass

    def of(self, name):
        """[(when, value)] of the good ones, in the order of their times."""
        return sorted((ms / 1000, value) for (n, ms), value in list(self.points.items()) if n == name and value is not None)

    def say(self, online):
        self.client.publish("spBv1.0/STATE/scada", self.state(online), 1, True)

    def command(self, topic, name, **value):
        payload = self.pb.Payload(timestamp=int(time.time() * 1000))
        payload.metrics.add(name=name, timestamp=payload.timestamp, **value)
        self.client.publish(f"spBv1.0/plant/{topic}", payload.SerializeToString(), 0)

    def end(self):
        self.say(False)
        self.client.disconnect()
        self.client.loop_stop()


class Bridge(Historian):
    """Into a database that takes InfluxDB's line protocol, as VictoriaMetrics, which has no Sparkplug."""

    def __init__(self, port, url):
        self.lines, self.url = [], url + "/write?precision=ms"
        super().__init__(port)

    def take(self, topic, data):
        super().take(topic, data)
        if self.lines:
            body = "\n".join(self.lines).encode()
            urllib.request.build_opener(urllib.request.ProxyHandler({})).open(self.url, body, 20).close()
        self.lines = []

    def store(self, name, metric, value):
        of = dict(zip(metric.properties.keys, metric.properties.values))
        if "Quality" not in of or isinstance(value, str):
            return
        fields = f"quality={of['Quality'].int_value}" + (f",value={float(value)}" if value is not None else "")
        name = name.replace(" ", r"\ ").replace(",", r"\,").replace("=", r"\=")
        self.lines.append(f"sparkplug,metric={name} {fields} {metric.timestamp}")


class Machine:
    """owsd, its recorder and owsd-mqtt, of one boot, at a broker that they reach at a port."""

    def __init__(self, scene, port, env=None, name=None, *, more=(), wire="", keys=""):
        for program in (MQTT, RECORDER):
            owsdtest.need(program)
        wire = scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {SENSOR} temperature 21.5\nDS2408 {SWITCH}\n{wire}")
        block = f'Broker "mqtt://127.0.0.1:{port}" Node "pi7" Topic "plant" Profile "sparkplug" PrimaryHost "scada" {keys}'
        config = owsdtest.rio(f"sim:{wire}", [DIAL, *more], Period=0.05, Timeout=3, Mqtt=raw("{ " + block + " }"),
                              Recorder=raw(f'{{ Flush 1 Directory "{scene.path / "history"}" }}'))
        self.ahead = 0  # of our clock
        self.scene, self.env = scene, {"STATE_DIRECTORY": str(scene.path / "state"), **(env or {})}
        self.daemon = scene.owsd(config, name=name, env=env)
        names = "-n", self.daemon.name, "-c", self.daemon.config
        self.recorder = scene.start([RECORDER, *names], env)
        until(lambda: "recording " in self.recorder.log(), 20, self.recorder.log)
        self.face = scene.start([MQTT, *names, "-v"], self.env)

    def turn(self, was, *values, sent=None):
        """
        One after the other; sent(): how many messages of the dial owsd-mqtt has sent. A value is out before the
        next one comes: of changes that are less than 50 ms apart only the newest goes out.
        """
        for value in values:
            before = sent and sent()
            done = faulty.ctl(self.scene, self.daemon, self.env, "set", "-w", "20", "dial", str(value))
            assert done.returncode == 0, done
            was.append((time.time() + self.ahead, value))
            if sent:
                until(lambda: sent() > before, 20, self.face.log)

    def recorded(self, value):
        """It is on the disk."""
        def newest():
            with contextlib.closing(sqlite3.connect(self.scene.path / "history" / "history.sqlite")) as db:
                return db.execute("select value from raw join signal using (signal) where name = 'dial' order by id desc").fetchone()
        until(lambda: newest() == (value,), 20, newest)

    def power_cut(self):
        for program in (self.daemon, self.recorder, self.face):
            program.process.kill()
        for program in (self.daemon, self.recorder, self.face):
            program.wait()


def has_each(historian, was, machine, of=None):
    """Each change is there with its time, and nothing else is. How often each is. of: as Historian.of."""
    of = of or historian.of

    def runs():
        found = of("dial")
        changed = [point for n, point in enumerate(found) if not n or point[1] != found[n - 1][1]]
        return [point for point in changed if point[0] > was[0][0] - 3]
    until(lambda: [v for _, v in runs()] == [v for _, v in was] and all(abs(a - b) < 3 for (a, _), (b, _) in zip(runs(), was)),
          90, lambda: f"\n{was}\n{of('dial')}\n{machine.face.log()}")
    assert all(before == after for _, before, after in historian.twice), historian.twice
    return {value: sum(v == value for _, v in of("dial")) for _, value in was}


def arrives(historian, value):
    until(lambda: [v for _, v in historian.of("dial")][-1:] == [value], 20, lambda: historian.of("dial"))


@contextlib.contextmanager
def plant(scene, cable=False, make=Historian, **keys):
    broker = Broker(scene)
    way = Cable(broker.port) if cable else broker
    historian = make(broker.port)
    machine = Machine(scene, way.port, **keys)
    try:
        until(lambda: any(n == "dial" for n, _ in historian.points), 20, machine.face.log)
        yield historian, machine, way
    finally:
        historian.end()


def test_a_cable_that_holds_for_a_while_loses_nothing_and_repeats_nothing(scene):
    with plant(scene, cable=True) as (historian, machine, cable):
        was = []
        def sent():
            return cable.entered.count(f"/DDATA/pi7/{SWITCH}".encode())
        machine.turn(was, 1, 2, sent=sent)
        arrives(historian, 2)
        cable.hold()
        machine.turn(was, 3, 4, 5, sent=sent)
        assert [v for _, v in historian.of("dial")] == [1, 2], historian.of("dial")
        cable.go()
        machine.turn(was, 6)
        assert set(has_each(historian, was, machine).values()) == {1}, historian.of("dial")


def test_what_was_under_way_when_the_cable_was_cut_comes_again(scene):
    with plant(scene, cable=True) as (historian, machine, cable):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        machine.turn(was, 2)
        arrives(historian, 2)
        cable.hold()
        machine.turn(was, 3, 4, 5)
        cable.cut()
        cable.go()
        machine.turn(was, 6)
        has_each(historian, was, machine)
        assert {v for key, v in historian.points.items() if key in historian.past} >= {3, 4}, historian.past


def test_a_cable_that_nobody_sees_to_be_cut_is_given_up_and_nothing_is_lost(scene):
    """It takes a minute: no end of a connection comes, so only silence tells."""
    with plant(scene, cable=True) as (historian, machine, cable):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        cable.hold()
        machine.turn(was, 2, 3)
        until(lambda: " is lost: " in machine.face.log(), 90, machine.face.log, step=0.5)
        machine.turn(was, 4)
        cable.cut()
        cable.go()
        machine.turn(was, 5)
        has_each(historian, was, machine)


def test_a_historian_that_was_away_gets_what_it_missed(scene):
    """The broker was there all the time."""
    with plant(scene) as (historian, machine, _):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        historian.end()
        logged(machine.face, "the primary host scada is offline")
        machine.turn(was, 2, 3)
        again = Historian(historian.port, historian.points, historian.past)
        try:
            machine.turn(was, 4)
            has_each(again, was, machine)
        finally:
            again.end()


def test_a_machine_whose_power_is_cut_while_the_broker_is_away_sends_all_that_its_disk_has(scene):
    with plant(scene) as (historian, machine, broker):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        broker.process.kill()
        machine.turn(was, 2, 3)
        machine.recorded(3)
        machine.power_cut()
        again = Machine(scene, broker.port, name=machine.daemon.name)
        again.turn(was, 4, 5)
        broker.start()
        again.turn(was, 6)
        has_each(historian, was, again)


def boot(scene, name, **clock):
    """The clock and the environment of another boot."""
    found = faulty.Clock(scene, f"clock-{name}")
    found.jump(**clock)
    return found, found.env(scene, boot=scene.file(f"boot-{name}", f"{uuid.uuid4()}\n"))


def test_a_clock_that_is_wrong_after_the_power_cut_gives_no_value_a_wrong_time(scene):
    _, before = boot(scene, "before", synchronised=True)
    with plant(scene, env=before) as (historian, machine, broker):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        broker.process.kill()
        machine.turn(was, 2, 3)
        machine.recorded(3)
        machine.power_cut()
        # as without a clock of its own: it goes on from a time that it had, until it is set
        uptime = time.clock_gettime(time.CLOCK_BOOTTIME)
        clock, env = boot(scene, "after", wall=-3600, boot=20 - uptime, synchronised=False)
        again = Machine(scene, broker.port, env, machine.daemon.name)
        again.turn(was, 4, 5)
        broker.start()
        again.turn(was, 6)
        # what is live before has the time of the clock as it is
        until(lambda: any(when < was[0][0] - 3000 for when, _ in historian.of("dial")), 20, again.face.log)
        clock.jump(wall=3600, synchronised=True)
        again.turn(was, 7)
        has_each(historian, was, again)


def test_the_log_says_when_the_recorder_writes_no_more(scene):
    clock = faulty.Clock(scene)
    with plant(scene, env=clock.env(scene)) as (historian, machine, broker):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        assert machine.recorder.stop() == 0
        broker.process.kill()
        logged(machine.face, " is lost: ")
        clock.jump(wall=60, boot=60)
        machine.ahead = 60
        machine.turn(was, 2)
        broker.start()
        arrives(historian, 2)
        words = "is sent again when owsd-recorder has written it: does that run?"
        assert words not in machine.face.log()
        # what its end has written may still be under way
        until(lambda: words in machine.face.log() or clock.jump(wall=700, boot=700), 30, machine.face.log, step=1)


def test_victoriametrics_has_each_change_once_after_an_hour_without_a_broker(scene):
    server = Victoria(scene, "-dedup.minScrapeInterval=1ms")  # of the same millisecond it keeps one
    clock = faulty.Clock(scene)

    def stored(name, of="value"):
        return sorted((ms / 1000, value) for ms, value in server.exported(f'__name__="sparkplug_{of}",metric="{name}"')[0])
    with plant(scene, make=lambda port: Bridge(port, server.url), env=clock.env(scene)) as (historian, machine, broker):
        was = []
        machine.turn(was, 1)
        arrives(historian, 1)
        machine.turn(was, 2)
        arrives(historian, 2)
        broker.process.kill()
        machine.turn(was, 3)
        for half_hour in (4, 5):
            time.sleep(0.5)  # pace: the recorder takes a change by the clock that stands when it comes
            clock.jump(wall=1800, boot=1800)
            machine.ahead += 1800
            until(lambda: faulty.ctl(scene, machine.daemon, machine.env, "get", "dial").returncode == 0, 10, "owsd beats")
            machine.turn(was, half_hour)
        broker.start()
        machine.turn(was, 6)
        has_each(historian, was, machine, stored)
        # a value that comes again was not known in between, as when the clock jumped; but for that of the birth
        # after the hour: it says once more what came before it, as it was read last
        values, bad = stored("dial"), [when for when, quality in stored("dial", "quality") if quality != 192]
        again = [(b, after) for (a, before), (b, after) in zip(values, values[1:])
                 if before == after and not any(a < when < b for when in bad)]
        assert len(again) <= 1, (values, bad)


if __name__ == "__main__":
    owsdtest.main(at_once=3)
