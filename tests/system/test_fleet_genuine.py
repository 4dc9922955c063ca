#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Genuine owsd-mqtt in their hundreds at one broker: all are born, once each; and when the broker
restarts all are back within 15 seconds, once each. Some fifty of them share an owsd. Prints figures;
NODES=1000, else 60. The broker's own log is the witness."""

import collections
import contextlib
import os
import re
import resource
import signal
import subprocess
import time

import owsdtest
from mqtthouse import MQTT, SENSOR, item, program
from owsdtest import free_port, raw, until

NODES = int(os.environ.get("NODES", "60"))
SHARE = 50           # owsd-mqtt of one owsd: it has a place for each that follows it
BACK, AWAY = 15, 10  # seconds
KIB_EACH = 8192      # more than one needs, where all of it counts
SAID = re.compile(r"Received PUBLISH from owsd-(p\d+) .*/(NBIRTH|NDATA|DDATA|NDEATH)/")


class Broker:
    """A mosquitto that logs all; what it has logged since it started. It is read once: to read megabytes again for each
    look takes a processor from those who are to be born."""

    def __init__(self, scene):
        self.scene, self.port = scene, free_port()
        self.config = scene.file("broker.conf", f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence false\n"
                                 "user root\nlog_type all\nlog_dest stderr\nmax_queued_messages 0\n")
        self.start()

    def start(self):
        self.process = self.scene.start([program("mosquitto"), "-c", self.config])
        self.at, self.born = 0, collections.Counter()
        until(lambda: " running" in self.process.log(), 30, lambda: self.process.log())

    def births(self):
        """How often each node was born."""
        with open(self.process.log_path, "rb") as log:
            log.seek(self.at)
            text = log.read()
        whole = text[:text.rfind(b"\n") + 1]
        self.at += len(whole)
        self.born.update(node for node, verb in SAID.findall(whole.decode(errors="replace")) if verb == "NBIRTH")
        return self.born


def config(scene, node, target, port):
    return scene.file(f"{node}.rio", owsdtest.rio(target, [item("room", f"/{SENSOR}/temperature")], Period=1, Timeout=5, Mqtt=raw(
        f'{{ Broker "mqtt://127.0.0.1:{port}" Node "{node}" Topic "fleet" Profile "sparkplug" }}')))


def memory(pid):
    """RSS and its own part of that, KiB."""
    with open(f"/proc/{pid}/smaps_rollup", encoding="ascii") as f:
        found = dict(re.findall(r"^(\w+): +(\d+) kB", f.read(), re.M))
    return int(found["Rss"]), int(found["Pss"])


def cpu(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as f:
        fields = f.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def faces(scene, broker, nodes):
    """The processes, in their order; ended at the end, whatever happens."""
    target = f"sim:{scene.file('house.sim', f'chip DS2482-100 0x18{chr(10)}DS18B20 {SENSOR} temperature sine 20 10 600s{chr(10)}')}"
    started, daemon = [], None
    try:
        with open(scene.path / "faces.log", "wb") as log:
            for n, node in enumerate(nodes):
                if n % SHARE == 0:
                    daemon = scene.owsd(config(scene, f"owsd{n}", target, broker.port))
                env = dict(os.environ, STATE_DIRECTORY=str(scene.path / "state" / node))
                command = [MQTT, "-n", daemon.name, "-c", config(scene, node, target, broker.port)]
                started.append(subprocess.Popen(command, cwd=scene.path, env=env, stdin=subprocess.DEVNULL, stdout=log,
                                                stderr=subprocess.STDOUT))
            yield started
    finally:
        for process in started:
            process.send_signal(signal.SIGTERM)
        for process in started:
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def all_born(broker, nodes, seconds):
    """After how many seconds half of them, 99 in a hundred, and all are born."""
    begun, came = time.monotonic(), []

    def born():
        came.append((len(broker.births()), time.monotonic() - begun))
        return came[-1][0] == nodes
    until(born, seconds, lambda: f"{came[-1][0]} of {nodes} are born", 0.2)
    return [next(when for count, when in came if count >= nodes * part) for part in (0.5, 0.99, 1)]


def once(scene, broker):
    """Each is born once. Who loses its owsd is born again: a machine that stops them all proves nothing."""
    twice = [node for node, count in broker.births().items() if count > 1]
    if twice and "owsd is lost" in (scene.path / "faces.log").read_text():
        owsdtest.skip(f"this machine is too busy: hearts stand still, and {len(twice)} of {NODES} nodes lost their owsd")
    assert not twice, twice[:10]


def test_all_are_born_once_and_back_within_15_seconds_when_their_broker_restarts(scene):
    owsdtest.need(MQTT)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    with open("/proc/meminfo", encoding="ascii") as f:
        room = int(re.search(r"MemAvailable: +(\d+)", f.read())[1]) // 2 // KIB_EACH
    if min(most - 100, room) < NODES:
        owsdtest.skip(f"{most} files at most, and memory for {room} nodes")
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    broker, nodes = Broker(scene), [f"p{n}" for n in range(NODES)]
    with faces(scene, broker, nodes) as started:
        half, most, took = all_born(broker, NODES, 300)
        print(f"# figure: {NODES} owsd-mqtt are born {half:.1f} s (half), {most:.1f} s (99 %), {took:.1f} s (all) after the last is started")
        time.sleep(5)  # a second birth of one of them would come
        once(scene, broker)
        rss, pss = zip(*(memory(process.pid) for process in started))
        print(f"# figure: an owsd-mqtt has {sum(rss) / NODES / 1024:.1f} MiB, of which {sum(pss) / NODES / 1024:.2f} count for it alone: "
              f"a thousand of them {1000 * sum(pss) / NODES / 1024 / 1024:.2f} GiB")
        used, begun = sum(cpu(process.pid) for process in started), time.monotonic()
        time.sleep(10)  # what they cost while all is well
        used = (sum(cpu(process.pid) for process in started) - used) / (time.monotonic() - begun)
        print(f"# figure: while all is well they take {100 * used:.1f} % of a core together")
        broker.process.kill()
        time.sleep(AWAY)  # their pauses have grown by then
        broker.start()
        busy = os.getloadavg()[0] / os.cpu_count()  # of others' work
        half, most, took = all_born(broker, NODES, 120)
        print(f"# figure: the broker is back after {AWAY} s, and they are in {half:.1f} s (half), {most:.1f} s (99 %), {took:.1f} s (all); "
              f"{busy:.1f} processes for each core wanted to run")
        time.sleep(5)  # as above
        once(scene, broker)
        assert all(process.poll() is None for process in started)
        assert took < BACK * max(1, busy), (took, busy)


if __name__ == "__main__":
    owsdtest.main()
