# SPDX-License-Identifier: MIT
"""A house with an owsd, a genuine mosquitto on loopback, somebody who listens to all of it, and
owsd-mqtt.

    house = House(scene, RELAY)
    house.arrives("room", lambda m: m["v"] == 21.5)
"""

import json
import shutil
import subprocess

import owsdtest
from owsdtest import BUILD, free_port, raw, until

MQTT = BUILD / "owsd-mqtt"
SENSOR, SWITCH = "28.A0B1C2000001", "29.A0B1C2000004"


def program(name):
    """A program of mosquitto's; else the case is skipped."""
    path = shutil.which(name, path="/usr/sbin:/usr/bin:/usr/local/sbin:/usr/local/bin")
    if not path:
        owsdtest.skip(f"no {name} here (packages mosquitto, mosquitto-clients)")
    return path


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", f"/{SENSOR}/temperature")
RELAY = item("relay", f"/{SWITCH}/PIO.0", "bool", "output")
ABSENT = item("absent", "/28.FFFFFFFFFFFF/temperature")


def openssl(scene, *arguments):
    subprocess.run([program("openssl"), *map(str, arguments)], cwd=scene.path, check=True, capture_output=True,
                   timeout=owsdtest.PATIENCE)


def certificates(scene):
    """ca.pem, and broker and client with keys that it signed."""
    openssl(scene, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", "ca.key", "-out", "ca.pem",
            "-days", "2", "-subj", "/CN=test-ca")
    for name, subject in (("broker", "/CN=localhost"), ("client", "/CN=pi7")):
        openssl(scene, "req", "-newkey", "rsa:2048", "-nodes", "-keyout", f"{name}.key", "-out", f"{name}.csr",
                "-subj", subject)
        extra = scene.file(f"{name}.ext", "subjectAltName=DNS:localhost\n")
        openssl(scene, "x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key",
                "-CAcreateserial", "-out", f"{name}.pem", "-days", "2", "-extfile", extra)
    (scene.path / "client.key").chmod(0o600)


def dated(scene, name, begins, ends):
    """NAME.pem for broker.key, by the CA of certificates(), of that time (YYYYMMDDHHMMSSZ)."""
    (scene.path / "newcerts").mkdir(exist_ok=True)
    scene.file("index.txt", "")
    scene.file("serial", "01\n")
    conf = scene.file("ca.conf", "[ca]\ndefault_ca = d\n[d]\ndatabase = index.txt\nserial = serial\nnew_certs_dir = newcerts\n"
                                 "default_md = sha256\npolicy = p\nunique_subject = no\n[p]\ncommonName = supplied\n")
    openssl(scene, "ca", "-batch", "-notext", "-config", conf, "-cert", "ca.pem", "-keyfile", "ca.key", "-in", "broker.csr",
            "-startdate", begins, "-enddate", ends, "-extfile", "broker.ext", "-out", f"{name}.pem")


class Broker:
    def __init__(self, scene, port=None, lines=("allow_anonymous true",)):
        self.scene, self.port = scene, port or free_port()
        self.config = scene.file(f"mosquitto-{self.port}.conf", "\n".join(
            [f"listener {self.port} 127.0.0.1", "persistence false", "user root", *lines, ""]))
        self.start()

    def start(self):
        self.process = self.scene.start([program("mosquitto"), "-v", "-c", self.config])
        until(lambda: " running" in self.process.log(), 20, lambda: self.process.log())

    @property
    def url(self):
        return f"mqtt://127.0.0.1:{self.port}"


class Listener:
    """All that the broker hands out from now on, and what it has kept."""

    def __init__(self, scene, port, topic="#", arguments=()):
        command = [program("stdbuf"), "-oL", program("mosquitto_sub"), "-d", "-p", str(port), "-q", "1", "-t", topic, "-F", "=%r\t%t\t%p",
                   *arguments]
        self.process = scene.start(command)
        until(lambda: "Subscribed" in self.process.log(), 20, "it listens")

    def lines(self):
        """[fields] of each message; the last line of the log may be on its way."""
        return [line[1:].split("\t") for line in self.process.log().split("\n")[:-1] if line[:1] == "="]

    def all(self, topic=None):
        """[(retained, topic, text)] in the order of their coming."""
        return [(r == "1", t, "\t".join(p)) for r, t, *p in self.lines() if topic in (None, t)]

    def last(self, topic):
        found = self.all(topic)
        return found[-1][2] if found else None


class House:
    def __init__(self, scene, *items, lines=("allow_anonymous true",), wire="", owsd=True, env=None, listen=(), top=None, **keys):
        owsdtest.need(MQTT)
        self.scene, self.top = scene, top or {}  # keys and blocks beside Mqtt
        self.broker = Broker(scene, lines=lines)
        self.listener = Listener(scene, self.broker.port, arguments=listen)
        self.wire = scene.file("house.sim", "chip DS2482-100 0x18\n"
                               f"DS18B20 {SENSOR} temperature 21.5\nDS2408 {SWITCH}\n{wire}")
        self.keys = {"Broker": self.broker.url, "Node": "pi7", **keys}
        self.keys["Broker"] = self.keys["Broker"].format(self.broker.url)
        self.daemon = scene.owsd(self.text(*(items or (ROOM, RELAY, ABSENT))))
        self.face = self.start(env)

    def text(self, *items, **more):
        keys = {**self.keys, **more}
        block = " ".join(f"{k} {v}" if isinstance(v, raw) else f'{k} "{v}"' for k, v in keys.items())
        return owsdtest.rio(f"sim:{self.wire}", items, Period=0.05, Timeout=3, **self.top, Mqtt=raw("{ " + block + " }"))

    @property
    def state(self):
        """The directory that owsd-mqtt keeps."""
        return self.scene.path / f"mqtt-{self.daemon.name}"

    def start(self, env=None):
        return self.scene.start([MQTT, "-n", self.daemon.name, "-c", self.daemon.config, "-v"],
                                {"STATE_DIRECTORY": str(self.state), **(env or {})})

    def last(self, name):
        """What was published last of a signal; None: nothing, or it was emptied."""
        text = self.listener.last(f"owsd/pi7/{name}")
        return json.loads(text) if text else None

    def arrives(self, name, fits):
        return until(lambda: self.last(name) and fits(self.last(name)) and self.last(name), 20,
                     lambda: f"{name} arrives: {self.listener.all(f'owsd/pi7/{name}')}")

    def says(self, topic, text):
        until(lambda: self.listener.last(topic) == text, 20,
              lambda: f"{topic} is {text!r}: {self.listener.all(topic)}")

    def kept(self, topic="#"):
        """{topic: text} of what the broker hands out to who comes now."""
        end = f"end/{id(self)}"
        command = [program("mosquitto_sub"), "-p", str(self.broker.port), "-t", topic, "-t", end,
                   "-F", "%t\t%p", "-W", "2", "--retained-only"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=owsdtest.PATIENCE)
        return dict(line.split("\t", 1) for line in done.stdout.splitlines())

    def set(self, name, value):
        done = self.scene.owsctl(self.daemon, "set", "-w", "20", name, value)
        assert done.returncode == 0, done
