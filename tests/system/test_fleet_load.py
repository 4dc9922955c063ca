#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A thousand nodes at one broker, by Sparkplug: their births, a minute's changes, a broker that is
killed, and one node in ten whose network is gone for a while. One node is owsd-mqtt; what it says is
recorded, and a player says it for all others, with the same marks and the same pauses. Nothing may
be lost. Prints figures; NODES=1000, else 200."""

import collections
import heapq
import os
import random
import resource
import selectors
import socket
import sqlite3
import struct
import time

import owsdtest
from mqtthouse import MQTT, SENSOR, SWITCH, item, program
from owsdtest import BUILD, free_port, raw, until
from test_mqtt_sparkplug import Host

NODES = int(os.environ.get("NODES", "200"))
PERIOD, CHIPS = 10, 10      # each chip of a node has news so often
STEADY, AWAY, CUT = 15, 8, 15  # seconds
RECORDER = BUILD / "owsd-recorder"


def text(data):
    data = data.encode() if isinstance(data, str) else data
    return struct.pack(">H", len(data)) + data


def packet(kind, body):
    size, left = b"", len(body)
    while True:
        left, digit = left >> 7, left & 127
        size += bytes([digit | (128 if left else 0)])
        if not left:
            return bytes([kind]) + size + body


def publish(topic, payload):
    return packet(0x30, text(topic) + payload)


def stamp(data):
    """The time of a payload, its first field, and where it ends."""
    value = at = 0
    while True:
        at += 1
        value |= (data[at] & 127) << 7 * (at - 1)
        if data[at] < 128:
            return value, at + 1


def stamped(data, ms):
    """The same of another time. All times of now have the same length."""
    _, end = stamp(data)
    return data[:1] + bytes(ms >> 7 * i & 127 | (128 if i < end - 2 else 0) for i in range(end - 1)) + data[end:]


class Link:
    """A client of MQTT 3.1.1."""

    def __init__(self, fleet, name, will=b""):
        self.fleet, self.name, self.will = fleet, name, will
        self.socket, self.up, self.input, self.output, self.wanted = None, False, b"", b"", 0

    def connect(self):
        self.socket = socket.socket()
        self.socket.setblocking(False)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.connect_ex(("127.0.0.1", self.fleet.port))
        self.output = packet(0x10, text("MQTT") + bytes([4, 0x0E if self.will else 2]) + struct.pack(">H", 60) +
                             text(self.name) + (text(f"spBv1.0/plant/NDEATH/{self.name}") + text(self.will) if self.will else b""))
        self.wanted = selectors.EVENT_READ | selectors.EVENT_WRITE
        self.fleet.selector.register(self.socket, self.wanted, self)

    def close(self):
        if self.socket:
            self.fleet.selector.unregister(self.socket)
            self.socket.close()
        self.socket, self.up, self.input, self.output = None, False, b"", b""

    def send(self, data):
        self.output += data
        self.flush()

    def flush(self):
        try:
            self.output = self.output[self.socket.send(self.output):] if self.output else b""
        except OSError:
            pass  # it is full; or it has ended, as the next read finds
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if self.output else 0)
        if wanted != self.wanted:
            self.fleet.selector.modify(self.socket, wanted, self)
            self.wanted = wanted

    def ready(self, events):
        """False: the connection is over."""
        try:
            if events & selectors.EVENT_WRITE:
                self.flush()
            if events & selectors.EVENT_READ:
                more = self.socket.recv(1 << 18)
                if not more:
                    return False
                self.read(more)
        except OSError:
            return False
        return True

    def read(self, more):
        data, at = self.input + more, 0
        while len(data) - at >= 2:
            size, shift, head = 0, 0, at + 1
            while head < len(data):
                size |= (data[head] & 127) << shift
                shift, head = shift + 7, head + 1
                if data[head - 1] < 128:
                    break
            else:
                break
            if data[head - 1] >= 128 or len(data) < head + size:
                break
            self.take(data[at] & 0xF0, data[head:head + size])
            at = head + size
        self.input = data[at:]


class Node(Link):
    """Says what the recorded one said."""

    def __init__(self, fleet, name):
        super().__init__(fleet, name, stamped(fleet.tape["NDEATH"][0], int(time.time() * 1000)))
        self.unsure, self.marks, self.made, self.step, self.born_at, self.marked = [], [], [], 2.0, 0.0, False

    def take(self, kind, _body):
        if kind == 0x20:
            self.up, self.step, self.born_at, self.marked = True, 2.0, time.time(), False
            for verb, device in (("NBIRTH", ""), *(("DBIRTH", f"/{chip}") for chip in range(CHIPS))):
                self.say(verb, device, int(time.time() * 1000))
            for ms, chip in self.unsure:
                self.say("DDATA", f"/{chip}", ms)
            self.mark()
        elif kind == 0xB0:
            del self.unsure[:self.asked]
            self.marked = False

    def say(self, verb, device, ms):
        tape = self.fleet.tape[verb]
        self.send(publish(f"spBv1.0/plant/{verb}/{self.name}{device}", stamped(tape[ms % len(tape)], ms)))

    def mark(self):
        if self.up and self.unsure and not self.marked:
            self.asked, self.marked = len(self.unsure), True
            self.send(packet(0xA2, b"\0\1" + text(self.name + "/mark")))

    def change(self, chip):
        ms = max(int(time.time() * 1000), self.made[-1] + 1 if self.made else 0)
        self.made.append(ms)
        self.unsure.append((ms, chip))
        if self.up:
            self.say("DDATA", f"/{chip}", ms)

    def lost(self):
        self.close()
        pause, self.step = self.step / 8 + random.random() * self.step, min(2 * self.step, 60)
        return pause


class Reader(Link):
    """The host: what came, of each node, how often, and how old the first was."""

    def __init__(self, fleet):
        super().__init__(fleet, "host")
        self.came = collections.defaultdict(collections.Counter)
        self.births, self.ages, self.genuine = {}, [], []

    def take(self, kind, body):
        if kind == 0x20:
            self.send(packet(0x82, b"\0\1" + text("spBv1.0/#") + b"\0"))
        elif kind == 0x90:
            self.up = True
            self.send(packet(0x31, text("spBv1.0/STATE/host") + b'{"online":true,"timestamp":%d}' % (1000 * time.time())))
        elif kind == 0x30:
            size = struct.unpack(">H", body[:2])[0]
            topic, payload, now = body[2:2 + size].decode(), body[2 + size:], time.time()
            verb, node = (topic.split("/") + [""])[2:4]
            if verb == "host":
                pass
            elif node == "pi7":
                self.genuine.append([str(int(verb == "NDEATH")), "0", topic, payload.hex()])
            elif verb == "DDATA":
                ms, _ = stamp(payload)
                self.ages += [now - ms / 1000] if not self.came[node][ms] else []
                self.came[node][ms] += 1
            elif verb == "NBIRTH":
                self.births[node] = now

    def lines(self):
        """As of a Listener, of the one node that is genuine."""
        return self.genuine


class Fleet:
    def __init__(self, scene):
        self.scene, self.port, self.selector, self.tape = scene, free_port(), selectors.DefaultSelector(), None
        self.config = scene.file("broker.conf", f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence false\n"
                                 "user root\nmax_queued_messages 0\nlog_type error\n")
        self.turns, self.nodes, self.held, self.behind, self.reader = [], [], set(), 0.0, None
        self.start()

    def start(self):
        self.broker = self.scene.start([program("mosquitto"), "-c", self.config])

        def answers():
            with socket.socket() as s:
                return s.connect_ex(("127.0.0.1", self.port)) == 0
        until(answers, 20, self.broker.log)

    def at(self, when, what, *arguments):
        heapq.heappush(self.turns, (when, random.random(), what, arguments))

    def play(self, nodes):
        self.nodes = [Node(self, f"pi{100 + n}") for n in range(nodes)]
        for node in self.nodes:
            self.at(time.time() + random.random() * 2.25, self.join, node)
            for chip in range(CHIPS):
                self.at(time.time() + random.random() * PERIOD, self.change, node, chip)

    def join(self, node):
        """The host comes first, and its nodes wait for it."""
        if node is not self.reader and not self.reader.up:
            self.at(time.time() + random.random() * 2.25, self.join, node)
        elif not node.socket and node not in self.held:
            node.connect()

    def change(self, node, chip):
        node.change(chip)
        self.at(time.time() + PERIOD, self.change, node, chip)
        self.at(time.time() + 1, node.mark)

    def run(self, seconds, done=lambda: False):
        """So long, or until it is done: is it?"""
        end, looked = time.time() + seconds, 0.0
        while (now := time.time()) < end:
            if now - looked > 0.1 and done():
                return True
            looked = now if now - looked > 0.1 else looked
            while self.turns and self.turns[0][0] <= now:
                when, _, what, arguments = heapq.heappop(self.turns)
                self.behind = max(self.behind, now - when)
                what(*arguments)
            for key, events in self.selector.select(max(0, min(0.05, (self.turns[0][0] if self.turns else end) - now))):
                link = key.data
                if link.socket is key.fileobj and not link.ready(events):
                    pause = link.lost() if isinstance(link, Node) else link.close() or 0.2
                    self.at(time.time() + pause, self.join, link)
        return done()

    def missing(self):
        return sum(ms not in self.reader.came[node.name] for node in self.nodes for ms in node.made)


def cpu(process):
    fields = open(f"/proc/{process.pid}/stat").read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def percent(ages, part):
    return sorted(ages)[int(len(ages) * part)] if ages else 0


def genuine(scene, fleet):
    """The node pi7: owsd, owsd-recorder and owsd-mqtt, with a sensor that changes all the time."""
    wire = scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {SENSOR} temperature sine 20 10 20s\nDS2408 {SWITCH}\n")
    config = owsdtest.rio(f"sim:{wire}", [item("room", f"/{SENSOR}/temperature")], Period=1, Timeout=3,
                          Recorder=raw(f'{{ Flush 1 Directory "{scene.path / "history"}" }}'),
                          Mqtt=raw(f'{{ Broker "mqtt://127.0.0.1:{fleet.port}" Node "pi7" Topic "plant" Profile "sparkplug" '
                                   'PrimaryHost "host" }'))
    daemon = scene.owsd(config)
    recorder = scene.start([RECORDER, "-n", daemon.name, "-c", daemon.config])
    until(lambda: "recording " in recorder.log(), 20, recorder.log)
    return recorder, scene.start([MQTT, "-n", daemon.name, "-c", daemon.config, "-v"], {"STATE_DIRECTORY": str(scene.path / "state")})


def test_a_fleet_loses_nothing_when_its_broker_is_killed_and_one_in_ten_is_away(scene):
    for what in (MQTT, RECORDER):
        owsdtest.need(what)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    if most < 2 * NODES + 100:
        owsdtest.skip(f"{most} files at most")
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    fleet = Fleet(scene)
    fleet.reader = Reader(fleet)
    fleet.reader.connect()
    assert fleet.run(20, lambda: fleet.reader.up)
    recorder, face = genuine(scene, fleet)
    host = Host(fleet.reader)

    def said(*verbs):
        return {v: [bytes.fromhex(line[3]) for line in fleet.reader.lines() if f"/{v}/" in line[2]] for v in verbs}
    assert fleet.run(30, lambda: len(said("DDATA")["DDATA"]) > 5), face.log()
    face.stop()
    fleet.run(1)
    fleet.tape = said("NBIRTH", "DBIRTH", "DDATA", "NDEATH")
    until(lambda: all(fleet.tape.values()), 0.1, lambda: fleet.tape)
    fleet.reader.genuine.clear()
    host.births, host.seq, host.read = {}, None, 0
    face = scene.start(face.command, {"STATE_DIRECTORY": str(scene.path / "state")})

    # all come, and a minute as any other
    fleet.play(NODES)
    begun = time.time()
    assert fleet.run(60, lambda: len(fleet.reader.births) == NODES), len(fleet.reader.births)
    print(f"# figure: {NODES} births in {time.time() - begun:.1f} s")
    fleet.run(2)
    fleet.reader.ages.clear()
    before, begun, count = (cpu(fleet.broker), cpu(face)), time.time(), sum(len(n.made) for n in fleet.nodes)
    fleet.run(STEADY)
    took, made = time.time() - begun, sum(len(n.made) for n in fleet.nodes) - count
    print(f"# figure: {made / took:.0f} values/s, of a core: broker {100 * (cpu(fleet.broker) - before[0]) / took:.1f} %, "
          f"owsd-mqtt {100 * (cpu(face) - before[1]) / took:.2f} %; age p50 {1000 * percent(fleet.reader.ages, .5):.1f} ms, "
          f"p99 {1000 * percent(fleet.reader.ages, .99):.1f} ms (the player was {1000 * fleet.behind:.0f} ms late at most)")

    # the broker is killed
    fleet.broker.kill()
    fleet.run(AWAY)
    fleet.reader.births.clear()
    fleet.start()
    begun = time.time()
    assert fleet.run(20, lambda: fleet.reader.up)
    assert fleet.run(120, lambda: len(fleet.reader.births) == NODES), len(fleet.reader.births)
    print(f"# figure: after a restart of the broker {NODES} births in {time.time() - begun:.1f} s, broker {cpu(fleet.broker):.2f} s of a core")

    # one in ten is away
    fleet.held = set(fleet.nodes[::10])
    for node in fleet.held:
        node.close()
    fleet.run(CUT)
    fleet.held = set()
    for node in fleet.nodes[::10]:
        fleet.at(time.time() + random.random() * 2.25, fleet.join, node)
    fleet.run(5)
    # what is made until now is to come
    fleet.turns = [turn for turn in fleet.turns if turn[2] != fleet.change]
    heapq.heapify(fleet.turns)
    assert fleet.run(60, lambda: not fleet.missing()), (fleet.missing(), [n.name for n in fleet.nodes if not n.up][:20])
    made, twice = sum(len(n.made) for n in fleet.nodes), sum(n - 1 for came in fleet.reader.came.values() for n in came.values())
    print(f"# figure: {made} values, none is lost, {twice} came twice")

    # and the genuine one: all that its recorder kept has come, with its time
    recorder.stop()
    with sqlite3.connect(scene.path / "history" / "history.sqlite") as db:
        kept = db.execute("select value, (id + date) / 1e6 from raw join session on session.start = (select max(start) from session"
                          " where start <= id) where quality >= 192 order by id").fetchall()
    kept = [k for n, k in enumerate(kept) if (n == 0 or k[0] != kept[n - 1][0]) and k[1] > host_begin(host)]

    def lacks():
        host.look()
        got = collections.defaultdict(list)
        for _, device, metric in host.metrics:
            if device == SENSOR and metric.value is not None:
                got[metric.value].append(metric.timestamp.timestamp() if hasattr(metric.timestamp, "timestamp") else metric.timestamp / 1000)
        return [k for k in kept if not any(abs(k[1] - when) < 2 for when in got[k[0]])]
    fleet.run(40, lambda: not lacks())
    assert len(kept) > 5 and not lacks(), (lacks(), face.log())
    print(f"# figure: owsd-mqtt had {len(kept)} values to say, and has said all")


def host_begin(host):
    host.look()
    return next(m.timestamp.timestamp() if hasattr(m.timestamp, "timestamp") else m.timestamp / 1000 for _, d, m in host.metrics if d == SENSOR)


if __name__ == "__main__":
    owsdtest.main()
