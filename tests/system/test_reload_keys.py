#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each key of the blocks Web, Mqtt, Influx, Recorder and Modbus counts from a reload on. KEYS is the table:
what stands beside the key, its value, and what is seen from outside once it counts and not before;
where that takes days, the face's own words. A key of owsd without a row fails. What a key names has
to be there: --check looks."""

import contextlib
import getpass
import http.client
import http.server
import json
import re
import socket
import ssl
import threading
import time

import modbushouse
import mqtthouse
import owsdtest
from owsdtest import BUILD, SOURCE, free_port, place, raw, until

PERSON = {"X-Remote-User": "anna"}


class Server:
    """A server of line protocol: [path, token, body] of each request."""

    def __init__(self):
        self.requests = requests = []

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"])).decode()
                requests.append((self.path, self.headers.get("Authorization"), body))
                self.send_response(204)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.http = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.http.server_port}"
        threading.Thread(target=self.http.serve_forever, args=(0.05,), daemon=True).start()


class Broker:
    """A broker that takes all and hands out nothing: what each connection began with, its topics."""

    def __init__(self, context=None):
        self.context, self.connections = context, []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                accepted = self.listener.accept()[0]
            except OSError:
                return
            threading.Thread(target=self.take, args=(accepted,), daemon=True).start()

    def take(self, accepted):
        with contextlib.suppress(OSError), accepted:
            if self.context:
                accepted = self.context.wrap_socket(accepted, server_side=True)
            with accepted, accepted.makefile("rb") as stream:
                self.packets(accepted, stream)

    def packets(self, sock, stream):
        one, five = None, False
        while head := stream.read(1):
            kind, body = head[0] >> 4, stream.read(number(stream))
            at = memoryview(body)
            if kind == 1:
                one, five = connect(body), body[6] == 5
                certificate = sock.getpeercert() if self.context else None
                one["certificate"] = certificate and dict(pair for (pair,) in certificate["subject"])["commonName"]
                self.connections.append(one)
                sock.sendall(b"\x20\x03\x00\x00\x00" if five else b"\x20\x02\x00\x00")
            elif kind == 3:
                size = int.from_bytes(at[:2], "big")
                one["topics"][bytes(at[2:2 + size]).decode()] = body
                if head[0] & 6:
                    sock.sendall(b"\x40\x02" + at[2 + size:4 + size])
            elif kind == 8:
                one["asked"].append(body.decode(errors="replace"))
                # the same answer to one topic and to several: owsd-mqtt counts on no code
                sock.sendall(b"\x90" + bytes([4 if five else 3]) + at[:2] + b"\x00" * (2 if five else 1))
            elif kind == 10:
                sock.sendall(b"\xb0" + bytes([4 if five else 2]) + at[:2] + (b"\x00\x00" if five else b""))
            elif kind == 12:
                sock.sendall(b"\xd0\x00")

    def last(self):
        return self.connections[-1] if self.connections else {}


def number(stream):
    """A length of MQTT: seven bits in each byte."""
    value = shift = 0
    while True:
        byte = stream.read(1)[0]
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value


def connect(body):
    """What a CONNECT has."""
    level, flags, at = body[6], body[7], 10

    def take(at):
        end = at + 2 + int.from_bytes(body[at:at + 2], "big")
        return body[at + 2:end].decode(errors="replace"), end
    skip = (lambda at: at + 1 + body[at]) if level == 5 else (lambda at: at)
    _, at = take(skip(at))
    found = {"level": level, "will": None, "user": None, "password": None, "topics": {}, "asked": []}
    if flags & 4:
        found["will"], at = take(skip(at))
        _, at = take(at)
    if flags & 128:
        found["user"], at = take(at)
    if flags & 64:
        found["password"], at = take(at)
    return found


class House:
    """owsd with the face of a block, which a test writes."""

    def __init__(self, scene, block):
        program = BUILD / f"owsd-{block.lower()}"
        owsdtest.need(program)
        self.scene, self.block, self.server, self.broker = scene, block, Server(), Broker()
        self.page = self.files("page", "the first")
        self.base = {
            "Web": {"Files": self.page},
            "Mqtt": {"Broker": f"mqtt://127.0.0.1:{self.broker.port}", "Node": "pi7"},
            "Influx": {"Url": self.server.url + "/write", "Every": raw("0.2"), "ClockWait": raw("0")},
            "Recorder": {"Directory": scene.path / "history", "Flush": raw("1")},
            "Modbus": {"Listen": f"127.0.0.1:{free_port()}"},
        }
        self.wire = scene.file("house.sim", "chip DS2482-100 0x18\n"
                               f"DS18B20 {mqtthouse.SENSOR} temperature 21.5\nDS2408 {mqtthouse.SWITCH}\n")
        self.daemon = scene.owsd(self.text())
        self.face = scene.start([program, "-v", "-n", self.daemon.name, "-c", self.daemon.config],
                                {"STATE_DIRECTORY": str(scene.path / "state")})
        until(lambda: "is there" in self.face.log(), 20, self.face.log)
        self.read, self.relay = 0, False

    def files(self, name, words):
        path = self.scene.path / name
        path.mkdir()
        (path / "index.html").write_text(f"<!doctype html><title>{words}</title>\n")
        return path

    def text(self, **keys):
        block = " ".join(f"{k} {v}" if isinstance(v, raw) else f'{k} "{v}"'
                         for k, v in {**self.base[self.block], **keys}.items())
        return owsdtest.rio(f"sim:{self.wire}", [mqtthouse.ROOM, mqtthouse.RELAY], Period=0.05, Timeout=3,
                            **{self.block: raw(f"{{ {block} }}")})

    def reload(self, **keys):
        """The face has read the file when owsctl ends: it waits for that."""
        self.daemon.config.write_text(self.text(**keys))
        self.read = len(self.face.log())
        done = self.scene.owsctl(self.daemon, "reload")
        assert done.returncode == 0, done
        assert f"owsd-{self.block.lower()}: reloaded" in done.stdout, done

    def logged(self):
        """What the face has logged since the reload."""
        return self.face.log()[self.read:]

    def ask(self, path, port=None, **headers):
        """Status and body; port None: at the socket."""
        c = http.client.HTTPConnection("localhost", port, timeout=owsdtest.PATIENCE)
        with contextlib.closing(c):
            if not port:
                c.sock = socket.socket(socket.AF_UNIX)
                c.sock.connect(str(place() / f"{self.daemon.name}.web"))
            try:
                c.request("GET", path, headers=headers)
            except ConnectionRefusedError:
                return 0, ""
            answer = c.getresponse()
            return answer.status, answer.read().decode()

    def info(self, **headers):
        return json.loads(self.ask("/api/info", **headers)[1])

    def pushes(self):
        """Does a change come to the server within a second and a half?"""
        before = len(self.server.requests)
        self.relay = not self.relay
        assert self.scene.owsctl(self.daemon, "set", "-w", "10", "relay", int(self.relay)).returncode == 0
        deadline = time.monotonic() + 1.5
        while time.monotonic() < deadline and len(self.server.requests) == before:
            time.sleep(0.05)  # a look
        return len(self.server.requests) > before


def said(words):
    return lambda house: words in house.logged()


def pushed(fits):
    return lambda house: any(fits(*request) for request in house.server.requests)


def linked(fits, broker="broker"):
    """The last connection of the broker."""
    def look(house):
        last = getattr(house, broker).last()
        return bool(last) and fits(last)
    return look


def published(begin):
    return linked(lambda c: any(topic.startswith(begin) for topic in c["topics"]))


def password_file(scene, name, text):
    path = scene.file(name, text + "\n")
    path.chmod(0o600)
    return path


def key(name, value, effect, **given):
    return name, (value, effect, given)


def web_keys(house):
    first, second = free_port(), free_port()
    other = house.files("other", "another")
    yield key("Listen", f"127.0.0.1:{first}", lambda h: h.ask("/api/info", first)[0] == 200)
    yield key("Hosts", "house.example", lambda h: h.ask("/api/info", second, Host="house.example")[0] == 200,
              Listen=f"127.0.0.1:{second}")
    yield key("Write", raw("on"), lambda h: h.info()["writable"])
    yield key("Configure", raw("on"), lambda h: h.info()["configurable"])
    yield key("Proxy", getpass.getuser(), lambda h: h.info(**PERSON)["person"] == "anna", Write=raw("on"))
    yield key("Others", f"pi http://127.0.0.1:{first}/", lambda h: h.info()["others"] == 1)
    yield key("Files", other, lambda h: "another" in h.ask("/")[1])


def influx_keys(house):
    url = house.server.url
    token = password_file(house.scene, "token", "abc")
    yield key("Url", url + "/other", pushed(lambda path, *_: path.startswith("/other")))
    yield key("Every", raw("0.2"), House.pushes, Every=raw("3600"))
    yield key("TokenFile", token, pushed(lambda _, got, __: got and "abc" in got))
    yield key("Measurement", "plant", pushed(lambda _, __, body: "\nplant," in f"\n{body}"))
    yield key("ClockWait", raw("77"), said("ClockWait 77 s"))


def recorder_keys(house):
    history = house.scene.path / "history2"
    yield key("Directory", history, lambda _: (history / "history.sqlite").exists())
    for name, value in {"Keep": "17", "KeepMinutes": "18", "KeepHours": "19", "Size": "31", "Flush": "32"}.items():
        yield key(name, raw(value), said(f"{name} {value}"))
    yield key("Record", "off", said("recording 0 of 2 signals"))


def mqtt_keys(house):
    scene = house.scene
    mqtthouse.certificates(scene)
    mqtthouse.openssl(scene, "req", "-new", "-key", "client.key", "-out", "second.csr", "-subj", "/CN=second")
    mqtthouse.openssl(scene, "x509", "-req", "-in", "second.csr", "-CA", "ca.pem", "-CAkey", "ca.key",
                      "-CAcreateserial", "-out", "second.pem", "-days", "2")
    (scene.path / "broker.key").chmod(0o600)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(scene.path / "broker.pem", scene.path / "broker.key")
    context.load_verify_locations(scene.path / "ca.pem")
    context.verify_mode = ssl.CERT_OPTIONAL
    house.second, house.tls = Broker(), Broker(context)
    tls = {"Broker": f"mqtts://localhost:{house.tls.port}"}
    ca, client, second = (scene.path / name for name in ("ca.pem", "client.pem", "second.pem"))
    right, wrong = scene.path / "client.key", scene.path / "broker.key"
    first, other = password_file(house.scene, "first", "secret"), password_file(house.scene, "second", "other")
    yield key("Broker", f"mqtt://127.0.0.1:{house.second.port}", linked(lambda c: c["will"], "second"))
    yield key("User", "anna", linked(lambda c: c["user"] == "anna"))
    yield key("PasswordFile", other, linked(lambda c: c["password"] == "other"), User="anna", PasswordFile=first)
    yield key("CaFile", ca, linked(lambda c: c["will"], "tls"), **tls, CaFile=client)
    yield key("CertFile", second, linked(lambda c: c["certificate"] == "second", "tls"), **tls, CaFile=ca,
              CertFile=client, KeyFile=right)
    yield key("KeyFile", right, linked(lambda c: c["certificate"] == "pi7", "tls"), **tls, CaFile=ca,
              CertFile=client, KeyFile=wrong)
    yield key("Protocol", "3.1.1", linked(lambda c: c["level"] == 4))
    yield key("Node", "pi8", linked(lambda c: "/pi8/" in c["will"]))
    yield key("Topic", "plant", linked(lambda c: c["will"].startswith("plant/")))
    yield key("Profile", "sparkplug", linked(lambda c: c["will"].startswith("spBv1.0/")))
    yield key("Discovery", "ha2", published("ha2/"))
    yield key("Link", "http://page.example/",
              linked(lambda c: any(b"http://page.example/" in body for body in c["topics"].values())))
    yield key("OldReaders", raw("on"), linked(lambda c: any("/sensor/" in topic for topic in c["topics"])))
    yield key("PrimaryHost", "scada", linked(lambda c: any("STATE/scada" in asked for asked in c["asked"])),
              Profile="sparkplug")
    yield key("Write", raw("on"), linked(lambda c: any(b'"cmd_t"' in body for body in c["topics"].values())))
    yield key("Rename", raw("on"), linked(lambda c: any("+/rename" in asked for asked in c["asked"])))


def plc(fits, unit=1):
    """What a client of Modbus reads; it may be closed in the moment of a reload."""
    def look(house):
        try:
            with modbushouse.Client(int(house.base["Modbus"]["Listen"].rpartition(":")[2]), unit) as client:
                return fits(client)
        except OSError:
            return None
    return look


def has_place(place):
    return plc(lambda c: modbushouse.refused(c.registers, 16 * place, 1) is None)


def set_is(exception):
    return plc(lambda c: modbushouse.refused(c.write_one, 32 + modbushouse.SHORT, 1) == exception)


def promises(seconds):
    """The controller of a client that sets the relay."""
    def look(house):
        if not set_is(None)(house):
            return False
        who = json.loads(house.scene.owsctl(house.daemon, "--json", "who").stdout)
        return any(one["beat"] == seconds for one in who["controllers"])
    return look


def one_is_left(house):
    port = int(house.base["Modbus"]["Listen"].rpartition(":")[2])
    with modbushouse.Client(port) as first, modbushouse.Client(port) as second:
        try:
            second.registers(0, 1)
            return first.registers(0, 1) is None
        except OSError:
            return True


def modbus_keys(house):
    second = free_port()
    places = house.scene.file("places", f"700 {mqtthouse.ROOM['Path']}\n")

    def listens(_):
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", second), 5):
            return True
        return False
    may = {"Write": raw("on"), "Allow": "relay 127.0.0.1"}
    yield key("Listen", f"127.0.0.1:{second}", listens)
    yield key("UnitId", raw("7"), plc(lambda c: modbushouse.refused(c.registers, 0, 1) == modbushouse.NO_TARGET))
    yield key("WordOrder", "little", plc(lambda c: c.registers(0, 2) == (0x5344, 0x4F57)))
    yield key("BadValue", "exception", plc(lambda c: modbushouse.refused(c.registers, 32, 4) == modbushouse.NO_TARGET))
    yield key("Decimals", raw("2"), plc(lambda c: c.registers(16 + modbushouse.SHORT, 1) == (2150,)))
    yield key("Clients", raw("1"), one_is_left)
    yield key("Write", raw("on"), set_is(None), Allow=may["Allow"])
    yield key("Allow", may["Allow"], set_is(None), Write=may["Write"], Allow="relay 192.0.2.7")
    yield key("Beat", raw("7"), promises(7), **may)
    yield key("Map", places, has_place(700))


KEYS = {"Web": web_keys, "Mqtt": mqtt_keys, "Influx": influx_keys, "Recorder": recorder_keys, "Modbus": modbus_keys}


def options(block):
    """The keys of the block in owsd's own table."""
    table = (SOURCE / "src/config/read/option_list.h").read_text()
    return re.findall(rf'^OPTION\(\w+, "(\w+)", {block.upper()},', table, re.M)


def counts(scene, block):
    house = House(scene, block)
    rows = list(KEYS[block](house))
    assert sorted(name for name, _ in rows) == sorted(options(block)), "a row for each key, a key for each row"
    for name, (value, effect, given) in rows:
        house.reload(**given)
        if block == "Mqtt" and "CaFile" not in given:
            until(lambda: house.broker.last().get("topics"), 20, "it publishes")
        assert not effect(house), f"{name}: it is so before"
        house.reload(**{**given, name: value})
        until(lambda: effect(house), 20, lambda: f"{name} {value}: {house.logged()}")


def test_each_key_of_owsd_web_counts_from_a_reload_on(scene):
    counts(scene, "Web")


def test_each_key_of_owsd_mqtt_counts_from_a_reload_on(scene):
    counts(scene, "Mqtt")


def test_each_key_of_owsd_influx_counts_from_a_reload_on(scene):
    counts(scene, "Influx")


def test_each_key_of_owsd_recorder_counts_from_a_reload_on(scene):
    counts(scene, "Recorder")


def test_each_key_of_owsd_modbus_counts_from_a_reload_on(scene):
    counts(scene, "Modbus")


CHECKED = {block: [name for name in options(block) if re.search("Files?$", name)]
           for block in ("Web", "Mqtt", "Influx", "Notify")}
BESIDE = {"Mqtt": {"Broker": "mqtts://localhost"}, "Influx": {"Url": "http://localhost/write"},
          "Notify": {"Url": "http://localhost/hook"},
          "Web": {"Files": owsdtest.SOURCE / "src/faces/web/page"}}
PAIR = {"CertFile": "KeyFile", "KeyFile": "CertFile"}


def checked(scene, block, **keys):
    keys = " ".join(f'{k} "{v}"' for k, v in {**BESIDE[block], **keys}.items())
    path = scene.file("check.rio", owsdtest.rio("null:", [], **{block: raw(f"{{ {keys} }}")}))
    program = BUILD / f"owsd-{block.lower()}"
    owsdtest.need(program)
    done = scene._run([program, "-c", path, "--check"], owsdtest.PATIENCE)
    return done.returncode, done.stderr


def test_the_check_of_each_face_refuses_a_file_that_cannot_be_used(scene):
    assert sorted(sum(CHECKED.values(), [])) == ["CaFile", "CertFile", "Files", "KeyFile", "PasswordFile", "TokenFile",
                                              "TokenFile"]
    there = password_file(scene, "there", "secret")
    for block, names in CHECKED.items():
        assert checked(scene, block) == (0, "")
        for name in names:
            pair = {PAIR[name]: there} if name in PAIR else {}
            status, why = checked(scene, block, **{**pair, name: scene.path / "nowhere"})
            assert status == 2 and f"{scene.path}/nowhere: No such file or directory; " in why, (name, why)
            if name == "Files":
                continue
            assert name in why, why
            # the shell has no credentials of the service
            status, why = checked(scene, block, **{**pair, name: "nowhere"})
            assert status == 0 and f"{name}: the service alone sees its credential nowhere" in why, (name, why)
            assert checked(scene, block, **{**pair, name: there}) == (0, ""), name
            there.chmod(0o644)
            status, why = checked(scene, block, **{**pair, name: there})
            assert (status == 2) == (name in ("PasswordFile", "TokenFile", "KeyFile") or "KeyFile" in pair), (name, why)
            there.chmod(0o600)


if __name__ == "__main__":
    owsdtest.main()
