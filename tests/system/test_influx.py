#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-influx beside a real owsd: what a server gets, also after it was away, is what there was."""

import contextlib
import ctypes
import http.server
import json
import os
import platform
import re
import shutil
import signal
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request

import owsdtest
import sandbox
from owsdtest import BUILD, SOURCE, free_port, logged, raw, until

INFLUX, RECORDER = BUILD / "owsd-influx", BUILD / "owsd-recorder"
SENSOR, RELAY = "/28.A0B1C2000001", "/29.A0B1C2000004"
LINE = re.compile(r"^(\w+),identity=[^ ,]+,instance=(\w+),signal=(\w+)(?:,unit=(\S+))? (\S+|text=\".*\",\S+) (\d+)$")
DIRECT = {"no_proxy": "*"}  # whatever this machine's environment says
VICTORIA = BUILD / "victoria"


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", SENSOR + "/temperature")
RELAYS = item("relays", RELAY + "/PIO.BYTE", "byte", "output")
TITLE = item("title", SENSOR + "/type", "string", PerFactor=20)
ABSENT = item("absent", "/28.FFFFFFFFFFFF/temperature")


def text(scene, url, *items, **keys):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n"
                      "DS2408 29.A0B1C2000004\n")
    block = {"Every": 0.2, "ClockWait": 0, **keys}
    history = {"Recorder": raw(f'{{ Flush 1 Directory "{scene.path / "history"}" }}')}
    more = {**history, "Influx": raw("{{ Url \"{}\" {} }}".format(url, " ".join(f"{k} {v}" for k, v in block.items())))}
    return owsdtest.rio(f"sim:{wire}", items or (ROOM, RELAYS, TITLE), Period=0.05, Timeout=3,
                        **(more if url else history))


class Server:
    """Takes line protocol on loopback, and answers as the test orders: a status, "hang" or "drop"."""

    def __init__(self, port=None, answer=204, words=b"", most=1 << 20):
        self.port, self.answer, self.words, self.most = port or free_port(), answer, words, most
        self.dislikes = None  # a batch that has this
        self.points, self.batches, self.requests, self.tokens = {}, [], [], []
        self.connections, self.ended = [], threading.Event()
        server = self

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"])).decode()
                answer, words = server.answer, server.words
                if len(body) > server.most:
                    answer, words = 413, b"request entity too large"
                elif server.dislikes and server.dislikes in body and answer == 204:
                    answer, words = 400, b"disliked"
                server.take(self.path, self.headers.get("Authorization"), body, answer)
                if answer in ("hang", "drop"):
                    server.ended.wait(100 if answer == "hang" else 0)
                    self.close_connection = True
                    return
                self.send_response(answer)
                self.send_header("Content-Length", str(0 if answer == 204 else len(words)))
                self.end_headers()
                if answer != 204:
                    self.wfile.write(words)

            def log_message(self, *_):
                pass

        class Quiet(http.server.ThreadingHTTPServer):
            daemon_threads = True

            def process_request(self, request, client_address):
                server.connections.append(request)
                super().process_request(request, client_address)

            def handle_error(self, *_):
                pass

        self.http = Quiet(("127.0.0.1", self.port), Handler)
        threading.Thread(target=self.http.serve_forever, args=(0.05,), daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.port}/write?db=house"

    def take(self, path, token, body, answer):
        self.requests.append(path)
        self.tokens.append(token)
        if answer not in (200, 204):
            return
        lines = [parse(line) for line in body.splitlines()]
        assert body.endswith("\n"), body
        self.batches.append(lines)
        for signal_, fields, when in lines:
            self.points.setdefault(signal_, {}).setdefault(when, set()).add(fields)

    def end(self):
        self.ended.set()
        self.http.shutdown()
        self.http.server_close()
        for connection in self.connections:
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)

    def values(self, name):
        """What the signal had, in the order of the points' times; None: no value."""
        return [value_of(fields) for _, those in sorted(self.points.get(name, {}).items())
                for fields in sorted(those)]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


def parse(line):
    found = LINE.match(line)
    assert found, f"no line of the protocol: {line!r}"
    return found[3], found[5], int(found[6])


def value_of(fields):
    found = re.match(r'^(?:value=([^,]+)|text="(.*)"),(?:integer=\d+i,)?quality=192i$', fields)
    if not found:
        assert re.match(r"^quality=\d+i$", fields), fields
        return None
    return found[1] if found[1] is not None else found[2]


def push(scene, daemon, *options, prefix=(), env=None):
    if "owsd-influx left-out" in (BUILD / "with/libraries").read_text():
        owsdtest.skip("owsd-influx is not built: libcurl is not here")
    owsdtest.need(INFLUX)
    return scene.start([*prefix, INFLUX, "-n", daemon.name, "-c", daemon.config, *options],
                       {**DIRECT, "STATE_DIRECTORY": str(scene.path / "state"), **(env or {})})


def tells(daemon, pattern):
    """Wait until whoever has the service manager of this owsd says something like that to it."""
    said = []

    def told():
        with contextlib.suppress(BlockingIOError):
            said.append(daemon.notify.recv(4096).decode())
        return re.search(pattern, "\n".join(said))

    until(told, 20, lambda: f"the status: {said}")


def record(scene, daemon):
    owsdtest.need(RECORDER)
    recorder = scene.start([RECORDER, "-n", daemon.name, "-c", daemon.config])
    logged(recorder, "recording ")
    return recorder


def set_relays(scene, daemon, value):
    done = scene.owsctl(daemon, "set", "-w", "20", "relays", value)
    assert done.returncode == 0, done


def distinct(values):
    return [v for n, v in enumerate(values) if n == 0 or v != values[n - 1]]


def arrives(server, name, value):
    until(lambda: value in server.values(name), 20,
          lambda: f"{name} {value} arrives: {server.points.get(name)}")


def test_each_change_arrives_with_its_time_and_quality_and_what_is_bad_without_a_number(scene):
    begun = time.time_ns()
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url, ROOM, RELAYS, TITLE, ABSENT))
        face = push(scene, daemon)
        arrives(server, "room", "21.5")
        arrives(server, "title", "DS18B20")
        for value in (1, 2, 7):
            set_relays(scene, daemon, value)
            arrives(server, "relays", str(value))
        until(lambda: "quality=8i" in str(server.points.get("absent")), 20, "the device is absent")
        taken = time.time_ns()
        assert face.stop() == 0
        ended = time.time_ns()
        assert [v for v in distinct(server.values("relays")) if v] == ["1", "2", "7"], server.points
        assert set(server.values("absent")) == {None}, server.points
        # once, however often it was measured
        assert server.values("room").count("21.5") == 1, server.points
        for name, points in server.points.items():
            assert all(begun < when < ended for when in points), (name, points)
            assert all(len(those) == 1 for those in points.values()), (name, points)
        measured = json.loads(scene.owsctl(daemon, "--json", "get", "relays").stdout)
        age = measured[0]["age"] if isinstance(measured, list) else measured["age"]
        newest = max(w for w, those in server.points["relays"].items() if "value=7" in str(those))
        assert abs(taken - age * 1e9 - newest) < 5e9, (measured, newest)
        assert server.requests[0] == "/write?db=house" and server.tokens[0] is None


def test_without_the_block_nothing_happens_until_a_reload_brings_it(scene):
    with Server() as server:
        daemon = scene.owsd(text(scene, None))
        face = push(scene, daemon)
        logged(face, "has no Influx block: nothing is pushed")
        until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
        assert not (scene.path / "state").exists() and not server.requests
        daemon.config.write_text(text(scene, server.url))
        daemon.signal(signal.SIGHUP)
        arrives(server, "room", "21.5")
        daemon.config.write_text(text(scene, None))
        face.signal(signal.SIGHUP)
        until(lambda: face.log().count("nothing is pushed") >= 2, 20, "it is off again")
        sent = len(server.requests)
        set_relays(scene, daemon, 3)
        assert face.stop() == 0
        assert len(server.requests) == sent


def test_what_a_server_that_is_away_or_fails_could_not_take_comes_later_and_the_oldest_first(scene):
    port = free_port()
    url = f"http://127.0.0.1:{port}/write"
    daemon = scene.owsd(text(scene, url))
    face = push(scene, daemon)
    logged(face, "is lost: Failed to connect")
    set_relays(scene, daemon, 1)
    with Server(port, answer=503, words=b"no \x1b[31mroom\nsecond line") as server:
        until(lambda: len(server.requests) >= 2, 20, "it is asked again")
        set_relays(scene, daemon, 2)
        server.answer = 429
        until(lambda: len(server.requests) >= 3, 20, "and again")
        server.answer = 204
        arrives(server, "relays", "2")
        logged(face, "is back")
        got = [when for batch in server.batches for name, _, when in batch if name == "relays"]
        assert got == sorted(got), server.batches
        assert [v for v in distinct(server.values("relays")) if v] == ["1", "2"], server.points
    assert face.log().count("is lost") == 1, face.log()
    with Server(port) as server:
        set_relays(scene, daemon, 3)
        arrives(server, "relays", "3")
    assert face.stop() == 0


def test_a_server_that_hangs_or_hangs_up_is_given_up_and_nothing_is_lost(scene):
    with Server(answer="hang") as server:
        daemon = scene.owsd(text(scene, server.url))
        face = push(scene, daemon)
        until(lambda: server.requests, 20, "it is asked")
        set_relays(scene, daemon, 5)
        logged(face, "is lost: ")
        assert "timed out" in face.log(), face.log()
        set_relays(scene, daemon, 6)
        server.answer, before = "drop", len(server.requests)
        until(lambda: len(server.requests) > before, 20, "it is asked again")
        server.answer = 200
        arrives(server, "relays", "6")
        arrives(server, "room", "21.5")
        assert [v for v in distinct(server.values("relays")) if v] == ["5", "6"], server.points
        assert face.stop() == 0


def test_lines_that_the_server_refuses_are_shown_and_counted_and_the_others_go_on(scene):
    with Server(answer=400, words=b"unable to \x1b[31mparse\nsecond") as server:
        daemon = scene.owsd(text(scene, server.url))
        daemon.notify.setblocking(False)
        face = push(scene, daemon, env={"NOTIFY_SOCKET": daemon.notify.getsockname()})
        logged(face, "lines: HTTP 400: unable to ?[31mparse; the first: ows,identity=")
        set_relays(scene, daemon, 1)
        tells(daemon, r"STATUS=the server refuses lines; .* [1-9]\d* refused")
        time.sleep(1)  # longer than Every: 1 goes, too
        server.answer = 204
        set_relays(scene, daemon, 2)
        arrives(server, "relays", "2")
        assert face.log().count("refuses ") == 1, face.log()
        assert face.stop() == 0


def test_a_server_that_takes_little_at_once_gets_smaller_batches(scene):
    with Server(answer="drop", most=150) as server:
        daemon = scene.owsd(text(scene, server.url))
        face = push(scene, daemon)
        logged(face, "is lost")
        set_relays(scene, daemon, 3)
        server.answer = 204
        arrives(server, "relays", "3")
        arrives(server, "room", "21.5")
        arrives(server, "title", "DS18B20")
        logged(face, "takes less at once: HTTP 413: request entity too large; ")
        assert max(len(batch) for batch in server.batches) == 1, server.batches
        server.dislikes = "value=7,"
        for value in (6, 7, 8):
            set_relays(scene, daemon, value)
        arrives(server, "relays", "8")
        arrives(server, "relays", "6")
        logged(face, "refuses 1 lines: HTTP 400: disliked; the first: ows,identity=")
        server.dislikes, server.most = None, 10
        before = len(server.requests)
        set_relays(scene, daemon, 4)
        until(lambda: len(server.requests) > before, 20, "it is asked")
        server.most = 200
        set_relays(scene, daemon, 5)
        arrives(server, "relays", "5")  # a line that is too large alone stops nothing
        assert not {"4", "7"} & set(server.values("relays")), server.points
        assert face.stop() == 0


def test_a_server_that_does_not_let_it_in_is_said_and_asked_again_with_the_token_of_the_file(scene):
    token = scene.file("token", "wrong\n")
    token.chmod(0o600)
    with Server(answer=401, words=b"unauthorized access") as server:
        daemon = scene.owsd(text(scene, server.url, TokenFile=f'"{token}"'))
        face = push(scene, daemon)
        logged(face, "refuses us: HTTP 401: unauthorized access; TokenFile has to have its token")
        token.write_text("right\n")
        until(lambda: server.tokens[-1] == "Token right", 20, "the file is read again")
        server.answer = 204
        arrives(server, "room", "21.5")
        assert server.tokens[0] == "Token wrong", server.tokens
        assert face.stop() == 0
        assert "right" not in face.log() and "wrong" not in face.log(), face.log()
        with open(f"/proc/{daemon.pid}/cmdline", "rb") as words:
            assert b"right" not in words.read()
        token.chmod(0o644)
        server.answer = 401
        face = push(scene, daemon)
        logged(face, " is there: 3 signals")
        logged(face, "without a token: ")
        asked = len(server.requests)
        until(lambda: len(server.requests) > asked + 1, 60, "it asks again")
        assert face.log().count("without a token: ") == 1, face.log()
        assert "others may read it: chmod 600" in face.log(), face.log()
        assert face.stop() == 0


def test_what_one_that_was_killed_or_did_not_run_missed_comes_from_the_history(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, f"http://127.0.0.1:{port}/write"))
    recorder = record(scene, daemon)
    for value in range(1, 5):
        face = push(scene, daemon)
        logged(face, "is lost: ")
        set_relays(scene, daemon, value)
        face.kill()
    set_relays(scene, daemon, 5)
    with Server(port) as server:
        face = push(scene, daemon)
        for value in range(1, 6):
            arrives(server, "relays", str(value))
        # killed while it sends
        for value in range(6, 16):
            set_relays(scene, daemon, value)
            arrives(server, "relays", str(value))
            face.kill()
            face = push(scene, daemon)
        logged(face, "is there")
        assert face.stop() == 0
        set_relays(scene, daemon, 16)
        set_relays(scene, daemon, 17)
        face = push(scene, daemon)
        arrives(server, "relays", "17")
        arrives(server, "relays", "16")
        relays = [v for v in distinct(server.values("relays")) if v]
        assert relays[relays.index("1"):] == [str(v) for v in range(1, 18)], server.points
        logged(face, "pushing to")
        assert face.stop() == 0
    assert recorder.stop() == 0


def test_a_gap_of_the_history_is_a_point_without_a_value(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, f"http://127.0.0.1:{port}/write"))
    recorder = record(scene, daemon)
    face = push(scene, daemon)
    logged(face, "is lost: ")
    set_relays(scene, daemon, 1)
    face.kill()
    assert recorder.stop() == 0
    recorder = record(scene, daemon)
    set_relays(scene, daemon, 2)
    with Server(port) as server:
        face = push(scene, daemon)
        arrives(server, "relays", "1")
        until(lambda: "quality=20i" in str(server.points["relays"]), 20, lambda: server.points)
        assert None in server.values("relays")[:-1], server.points
        assert face.stop() == 0


def test_without_a_history_it_says_so_once_and_memory_bridges_an_outage(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, f"http://127.0.0.1:{port}/write"))
    face = push(scene, daemon)
    logged(face, "is lost: ")
    for value in (1, 2, 3):
        set_relays(scene, daemon, value)
    with Server(port) as server:
        arrives(server, "relays", "3")
        assert [v for v in distinct(server.values("relays")) if v] == ["1", "2", "3"], server.points
        assert face.log().count("what the server misses is not sent again") == 1, face.log()
        assert face.stop() == 0


def test_what_is_in_memory_at_the_end_is_sent(scene):
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url, Every=3600))
        face = push(scene, daemon)
        until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
        set_relays(scene, daemon, 9)
        assert not server.requests
        assert face.stop() == 0
        assert server.values("relays")[-1] == "9", server.points
        server.answer = 503
        face = push(scene, daemon)
        logged(face, "is there")
        set_relays(scene, daemon, 10)
        assert face.stop() == 0
        assert re.search(r"[1-9]\d* values in memory are lost", face.log()), face.log()


def test_a_dead_owsd_is_a_point_without_a_value_and_a_reload_is_none(scene):
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url))
        face = push(scene, daemon)
        set_relays(scene, daemon, 5)
        arrives(server, "relays", "5")
        daemon.config.write_text(text(scene, server.url, RELAYS))
        daemon.signal(signal.SIGHUP)
        until(lambda: scene.owsctl(daemon, "get", "room").returncode != 0, 20, "it has reloaded")
        set_relays(scene, daemon, 6)
        arrives(server, "relays", "6")
        assert max(server.points["room"].items())[1] == {"quality=4i"}, server.points["room"]
        relays = server.values("relays")
        assert None not in relays[relays.index("5"):], server.points
        daemon.kill()
        until(lambda: server.values("relays")[-1] is None, 20, "no value is good any more")
        assert "quality=26i" in str(server.points["relays"]), server.points
        again = scene.owsd(daemon.config, name=daemon.name)
        set_relays(scene, again, 7)
        arrives(server, "relays", "7")
        assert face.stop() == 0


def clock_is_synchronised():
    """What the kernel says, as adjtimex(2) has it."""
    return ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(1024)) != 5


def test_until_the_clock_is_known_nothing_is_sent_and_then_each_value_with_its_time(scene):
    if clock_is_synchronised():
        owsdtest.skip("the kernel calls this machine's clock synchronised")
    if time.clock_gettime(time.CLOCK_BOOTTIME) > 80000:
        owsdtest.skip("this machine is up for too long")
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url, ClockWait=86400))
        face = push(scene, daemon)
        until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
        logged(face, "pushing to")
        begun = time.time_ns()
        set_relays(scene, daemon, 4)
        ended = time.time_ns()
        time.sleep(1)  # longer than Every: it sends nothing
        assert not server.requests
        daemon.config.write_text(text(scene, server.url))
        face.signal(signal.SIGHUP)
        arrives(server, "relays", "4")
        logged(face, "it is believed as it is")
        times = [when for when, those in server.points["relays"].items() if "value=4," in str(those)]
        assert begun < min(times) < ended, (begun, times, ended)
        assert face.stop() == 0
        waiting = len(server.requests)
        daemon.config.write_text(text(scene, server.url, ClockWait=86400))
        daemon.notify.setblocking(False)
        face = push(scene, daemon, env={"NOTIFY_SOCKET": daemon.notify.getsockname()})
        tells(daemon, r"STATUS=.* [1-9]\d* in memory")
        assert face.stop() == 0
        assert "in memory are lost: the time is not known yet" in face.log(), face.log()
        assert len(server.requests) == waiting


def test_its_status_and_its_command_line(scene):
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url))
        daemon.notify.setblocking(False)
        face = push(scene, daemon, env={"NOTIFY_SOCKET": daemon.notify.getsockname()})
        tells(daemon, r"STATUS=pushing; [1-9]\d* values sent, \d+ in memory, 0 from the history, "
                      r"0 refused, 0 dropped")
        assert face.stop() == 0
    broken = scene.file("broken.rio", text(scene, "ftp://nowhere"))
    done = scene._run([INFLUX, "-c", broken], 20)
    assert done.returncode == 2 and re.search(r"broken\.rio:\d+:\d+: error: Url", done.stderr), done
    assert scene.owsd_once("-c", broken, "--check").returncode == 2
    done = scene._run([INFLUX, "-V"], 20)
    assert done.returncode == 0 and re.fullmatch(r"owsd-influx \d+\.\d+\.\d+\n", done.stdout), done


def ask(url, seconds=20):
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url, timeout=seconds) as answer:
        return answer.read().decode()


def victoria_here():
    """The genuine program of Debian; fetched once if it is not installed."""
    if installed := shutil.which("victoria-metrics"):
        return installed
    program = VICTORIA / "usr/bin/victoria-metrics"
    if not program.exists():
        machine = {"x86_64": "amd64", "aarch64": "arm64"}.get(platform.machine())
        if not machine:
            owsdtest.skip(f"Debian has no victoria-metrics for {platform.machine()}")
        done = subprocess.run(["sh", SOURCE / "board/fetch-debs", "-x", "-", machine, VICTORIA,
                               "victoria-metrics"], capture_output=True, text=True, timeout=300,
                              check=False)
        if done.returncode or not program.exists():
            owsdtest.skip(f"no victoria-metrics: {done.stderr.strip()[-200:]}")
    return program


class Victoria:
    def __init__(self, scene, *options):
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        self.process = scene.start([victoria_here(), f"-httpListenAddr=127.0.0.1:{port}", "-retentionPeriod=1y",
                                    f"-storageDataPath={scene.path / 'data'}", "-memory.allowedBytes=64MB", *options])
        until(self.here, 60, "it answers")

    def here(self):
        try:
            return ask(self.url + "/health")
        except (OSError, urllib.error.URLError):
            assert self.process.running(), self.process.log()
            return None

    def exported(self, match):
        """[(ms, value)] of what fits, and the series."""
        ask(self.url + "/internal/force_flush")
        lines = ask(f"{self.url}/api/v1/export?end={time.time() + 86400:.0f}&match[]={{{match}}}")
        series = [json.loads(line) for line in lines.splitlines()]
        return [p for s in series for p in zip(s["timestamps"], s["values"])], series


def test_the_genuine_victoriametrics_has_what_owsctl_said(scene):
    server = Victoria(scene)
    url = server.url

    def exported(metric, name):
        return server.exported(f'__name__="ows_{metric}",signal="{name}"')

    daemon = scene.owsd(text(scene, url + "/write", ROOM, RELAYS, ABSENT))
    face = push(scene, daemon)
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
    said = []
    for value in (1, 2, 9):
        set_relays(scene, daemon, value)
        said.append((time.time() * 1000, float(scene.get(daemon, "relays"))))
        until(lambda: [v for _, v in exported("value", "relays")[0]][-1:] == [value], 60,
              lambda: f"{value} arrives: {exported('value', 'relays')}")
    points, series = exported("value", "relays")
    assert [v for _, v in sorted(points)] == [v for _, v in said], (points, said)
    for (when, _), (by, _) in zip(sorted(points), said):
        assert by - 20000 < when <= by, (points, said)
    assert series[0]["metric"]["instance"] == daemon.name, series
    room, series = exported("value", "room")
    assert [v for _, v in room] == [21.5] and series[0]["metric"]["unit"] == "°C", series
    assert exported("value", "absent")[0] == []
    assert [v for _, v in exported("quality", "absent")[0]][-1] == 8
    assert face.stop() == 0
    assert server.process.stop() == 0


def test_under_the_units_filter_it_does_all_that_it_does(scene):
    unit = SOURCE / "board/systemd/owsd-influx@.service"
    with Server() as server:
        # a name is looked up by a thread
        url = server.url.replace("127.0.0.1", "localhost")
        daemon = scene.owsd(text(scene, url))
        face = push(scene, daemon, "-v", prefix=sandbox.command(unit))
        arrives(server, "room", "21.5")
        assert face.stop() == 0
        assert "ot permitted" not in face.log(), face.log()


def test_no_call_that_it_makes_is_forbidden(scene):
    if not shutil.which("strace"):
        owsdtest.skip("strace is not installed")
    unit = SOURCE / "board/systemd/owsd-influx@.service"
    allowed = sandbox.calls(unit) | {"execve", "fchown"}  # by SQLite, of root alone
    trace = scene.path / "trace"
    with Server() as server:
        daemon = scene.owsd(text(scene, server.url.replace("127.0.0.1", "localhost")))
        record(scene, daemon)
        face = push(scene, daemon)
        arrives(server, "room", "21.5")
        assert face.stop() == 0
        set_relays(scene, daemon, 1)
        set_relays(scene, daemon, 2)
        face = push(scene, daemon, prefix=("strace", "-f", "-qq", "-o", trace))
        arrives(server, "relays", "1")
        with open(f"/proc/{face.pid}/task/{face.pid}/children", encoding="ascii") as children:
            os.kill(int(children.read()), signal.SIGTERM)
        assert face.wait(20) == 0
    calls = set(re.findall(r"^(?:\d+ +)?(?:<\.\.\. )?(\w+)\(", trace.read_text(errors="replace"), re.M))
    assert len(calls) > 20 and "pread64" in calls and "connect" in calls, calls
    assert not calls - allowed, calls - allowed


if __name__ == "__main__":
    owsdtest.main(at_once=1)
