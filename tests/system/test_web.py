#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-web beside a real owsd: what a browser gets, what it may do, and what is refused."""

import base64
import contextlib
import datetime
import getpass
import grp
import gzip
import http.client
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import time

import faulty
import owsdtest
import peer
from owsdtest import BUILD, place, raw, skip, until
from recorded import recorded

WEB = BUILD / "owsd-web"
SENSOR, RELAY = "/28.A0B1C2000001", "/29.A0B1C2000004"
DIFFERS = 0x1c
STARS = '*"\\/<b>\u00b0'


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", SENSOR + "/temperature", LimitH=raw("20"), Unit="\u00b0C")
RELAYS = item("relays", RELAY + "/PIO.BYTE", "byte", "output")


def text(scene, *items, **web):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n"
                      "DS2408 29.A0B1C2000004\n")
    page = scene.path / "page"
    (page / "deeper").mkdir(parents=True, exist_ok=True)
    (page / "index.html").write_text("<!doctype html><title>owsd</title>\n")
    (page / "plot.js").write_text("export const a = 1;\n")
    (page / "deeper" / "plot.js").write_text("no\n")
    (page / ".hidden.js").write_text("no\n")
    (page / "notes.txt").write_text("no\n")
    keys = " ".join(f'{k} "{v}"' for k, v in {"Files": page, **web}.items())
    return owsdtest.rio(f"sim:{wire}", items or (ROOM, RELAYS), Period=0.05, Timeout=3,
                        Web=raw(f"{{ {keys} }}"))


class Page:
    """An owsd-web, and a client of it."""

    def __init__(self, scene, daemon, *options, env=None, prefix=()):
        if not WEB.exists():
            skip("owsd-web is not built: there is no libmicrohttpd")
        self.port = owsdtest.free_port()
        self.socket = place() / f"{daemon.name}.web"
        self.program = scene.start([*prefix, WEB, "-n", daemon.name, "-c", daemon.config,
                                    "-l", f"127.0.0.1:{self.port}", *options], env)
        until(lambda: "configuration" in self.program.log(), 20, "it runs")

    def tcp(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=owsdtest.PATIENCE)

    def unix(self):
        s = socket.socket(socket.AF_UNIX)
        s.settimeout(owsdtest.PATIENCE)
        s.connect(str(self.socket))
        return s

    def ask(self, path, method="GET", body=None, unix=False, **headers):
        """The answer (read), its status and its body."""
        c = http.client.HTTPConnection("127.0.0.1", self.port, timeout=owsdtest.PATIENCE)
        if unix:
            c.sock = self.unix()
        with contextlib.closing(c):
            c.request(method, path, body, {k.replace("_", "-"): v for k, v in headers.items()})
            answer = c.getresponse()
            return answer, answer.status, answer.read()

    def json(self, path, status=200, **more):
        answer, got, body = self.ask(path, **more)
        assert got == status, (path, got, body)
        assert answer.getheader("Content-Type") == "application/json", answer.getheaders()
        return json.loads(body)

    def raw(self, data, unix=False):
        """What comes back for these bytes, up to the end of the connection."""
        with (self.unix() if unix else self.tcp()) as s:
            s.sendall(data)
            got = b""
            with contextlib.suppress(ConnectionResetError):
                while more := s.recv(65536):
                    got += more
            return got

    def values(self):
        return {s["name"]: s["value"] for s in self.json("/api/signals")["signals"]}


class Events:
    """A stream, as a browser reads it."""

    def __init__(self, page, last=None, unix=True, after=None):
        self.socket = page.unix() if unix else page.tcp()
        again = f"Last-Event-ID: {last}\r\n" if last else ""
        path = f"/api/events?after={after}" if after else "/api/events"
        self.socket.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n{again}\r\n".encode())
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        self.chunked = False
        while (line := self.file.readline().strip()):
            self.chunked |= line.lower() == b"transfer-encoding: chunked"
        self.id, self.left = last, b""

    def _line(self):
        while b"\n" not in self.left:
            if self.chunked:
                size = int(self.file.readline(), 16)
                more = self.file.read(size)
                self.file.readline()
            else:
                more = self.file.read1(65536)
            if not more:
                raise EOFError
            self.left += more
        line, self.left = self.left.split(b"\n", 1)
        return line.decode()

    def next(self):
        """(event, data) of the next one."""
        event, data = None, None
        while True:
            line = self._line()
            if line.startswith("event: "):
                event = line[7:]
            elif line.startswith("data: "):
                data = json.loads(line[6:])
            elif line.startswith("id: "):
                self.id = line[4:]
            elif not line and event:
                return event, data

    def until(self, wanted, what=lambda data: True):
        """The data of the next event of that kind for which what() holds."""
        end = time.monotonic() + owsdtest.PATIENCE
        seen = []
        while time.monotonic() < end:
            event, data = self.next()
            if event == wanted and what(data):
                return data
            seen = [*seen[-8:], (event, data)]
        raise owsdtest.Late(f"no {wanted}: {seen}")

    def value(self, signal, value):
        return self.until("values", lambda data: any(row[:2] == [signal, value] for row in data["v"]))

    def close(self):
        self.file.close()
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def both(scene, *items, options=(), **web):
    daemon = scene.owsd(text(scene, *items, **web))
    page = Page(scene, daemon, *options)
    until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")
    return daemon, page


def set_relays(scene, daemon, value):
    done = scene.owsctl(daemon, "set", "-w", "20", "relays", value)
    assert done.returncode == 0, done


def test_the_files_of_the_page_are_served_and_no_others(scene):
    _, page = both(scene)
    answer, status, body = page.ask("/")
    assert status == 200 and b"<title>owsd</title>" in body, body
    assert answer.getheader("Content-Type") == "text/html; charset=utf-8"
    policy = answer.getheader("Content-Security-Policy")
    assert "default-src 'none'" in policy and "unsafe" not in policy, policy
    assert answer.getheader("X-Content-Type-Options") == "nosniff"
    assert answer.getheader("Referrer-Policy") == "no-referrer"
    assert answer.getheader("Cross-Origin-Resource-Policy") == "same-origin"
    assert "camera=()" in answer.getheader("Permissions-Policy")
    again = page.ask("/", If_None_Match=answer.getheader("ETag"))
    assert again[1:] == (304, b""), again
    answer, status, body = page.ask("/plot.js")
    assert (status, body) == (200, b"export const a = 1;\n")
    assert answer.getheader("Content-Type") == "text/javascript; charset=utf-8"
    for path in ("/notes.txt", "/.hidden.js", "/deeper/plot.js", "/deeper", "/deeper/",
                 "/../house.sim", "/deeper/../index.html", "/%2e%2e/house.sim", "//etc/passwd",
                 "/api/", "/api/infos"):
        assert page.json(path, 404)["error"], path
    assert page.json("/index.html%00.js", 400)["error"]
    (scene.path / "page" / "index.html").write_text("another\n")
    assert page.ask("/", If_None_Match=answer.getheader("ETag"))[2] == b"another\n"


def test_a_packed_file_goes_to_the_browser_that_takes_it(scene):
    _, page = both(scene)
    plain = b"export const a = 1;\n"
    (scene.path / "page" / "plot.js.gz").write_bytes(gzip.compress(plain * 1000))
    for takes, encoding in (("br", None), ("gzip;q=0", None), ("gzip, deflate, br", "gzip")):
        answer, status, body = page.ask("/plot.js", Accept_Encoding=takes)
        assert status == 200 and answer.getheader("Content-Encoding") == encoding, (takes, status)
        assert (gzip.decompress(body) == plain * 1000) if encoding else body == plain, takes
        assert answer.getheader("Content-Type") == "text/javascript; charset=utf-8"
        assert answer.getheader("Vary") == "Accept-Encoding"
        head, status, none = page.ask("/plot.js", "HEAD", Accept_Encoding=takes)
        assert (status, none) == (200, b""), takes
        assert head.getheader("Content-Length") == str(len(body)), head.getheaders()
        again, status, none = page.ask("/plot.js", Accept_Encoding=takes,
                                       If_None_Match=answer.getheader("ETag"))
        assert (status, none) == (304, b"") and again.getheader("Vary") == "Accept-Encoding", takes
    # the tag of one encoding is none of another
    assert page.ask("/plot.js", If_None_Match=answer.getheader("ETag"))[1:] == (200, plain)
    assert page.json("/plot.js.gz", 404)["error"]
    until(lambda: (scene.path / "page" / "plot.js").write_text("2;\n") and
          page.ask("/plot.js", Accept_Encoding="gzip")[2] == b"2;\n", 5, "what is newer is served")


def test_signals_come_in_the_order_of_the_file_with_all_that_is_known_of_them(scene):
    odd = item("odd", SENSOR + "/temperature", Group="Ground & <i>",
               Description=STARS.replace('"', "").replace("\\", ""),
               Min=raw("-10"), Max=raw("50"))
    daemon, page = both(scene, RELAYS, ROOM, odd,
                        item("gone", "/28.A0B1C20000FF/temperature"), item("text", SENSOR + "/type", "string"))
    until(lambda: page.values()["room"] == 21.5, 20, "the room is good")
    until(lambda: page.values()["text"] == "DS18B20", 20, "so is the text")
    until(lambda: page.json("/api/signals")["signals"][3]["quality"]["code"] == 8, 20, "one is gone")
    all_of_it = page.json("/api/signals")
    signals = all_of_it["signals"]
    assert [(s["i"], s["name"]) for s in signals] == [
        (0, "relays"), (1, "room"), (2, "odd"), (3, "gone"), (4, "text")], signals
    room = signals[1]
    assert room["quality"] == {"good": True, "code": 192, "text": "good", "why": None, "remedy": None}, room
    assert (room["unit"], room["type"], room["output"], room["family"]) == ("\u00b0C", "double", False, "DS18B20")
    assert room["limits"] == {"hh": None, "h": 20, "l": None, "ll": None} and room["alarm"] == "! high"
    assert 0 <= room["age"] < 60, room
    assert (signals[2]["min"], signals[2]["max"], signals[2]["limits"]) == (-10, 50, None), signals[2]
    assert signals[2]["description"] == "*/<b>\u00b0", signals[2]
    assert signals[2]["group"] == "Ground & <i>", signals[2]
    assert room["terminal"]["channel"] == 0 and room["terminal"]["adapter"].startswith("sim:"), room
    assert room["interval"] is None or 0.01 < room["interval"] < 20, room
    assert signals[0]["interval"] is None, signals[0]
    gone = signals[3]
    assert gone["value"] is None and not gone["quality"]["good"], gone
    assert gone["quality"]["why"] == "no such device there" and "owsctl scan" in gone["quality"]["remedy"], gone
    info = page.json("/api/info")
    assert info["instance"] == daemon.name and info["signals"] == 5 and info["writable"] is False, info
    assert info["generation"] == all_of_it["generation"], info
    uname = os.uname()
    assert info["kernel"] == f"{uname.sysname} {uname.release} {uname.machine}", info
    model = pathlib.Path("/proc/device-tree/model")
    assert info["board"] == (model.read_text().rstrip("\0") if model.exists() else None), info
    assert abs(info["now"] / 1000 - time.time()) < 60, info
    assert page.json("/api/info", unix=True)["instance"] == daemon.name


def test_a_stream_has_each_change_and_goes_on_where_it_was(scene):
    daemon, page = both(scene)
    set_relays(scene, daemon, 1)
    with Events(page, unix=False) as events:
        assert events.status == 200
        event, data = events.next()
        assert event == "found" and data["generation"] == page.json("/api/info")["generation"]
        set_relays(scene, daemon, 2)
        events.value(1, 2)
        set_relays(scene, daemon, 3)
        events.value(1, 3)
        last = events.id
    set_relays(scene, daemon, 4)
    # what was missed comes at once, without a new beginning
    with Events(page, last) as events:
        event, data = events.next()
        assert event != "found", data
        if not any(row[:2] == [1, 4] for row in data.get("v", [])):
            events.value(1, 4)
    # another owsd-web of the same owsd understands it too
    assert page.program.stop() == 0
    page = Page(scene, daemon)
    until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")
    with Events(page, last) as events:
        event, data = events.next()
        assert event != "found", data
        if not any(row[:2] == [1, 4] for row in data.get("v", [])):
            events.value(1, 4)
    for wrong in ("1:1", "x", "999999999999:1", f"{last}0", f"{last};", last.split(":")[0]):
        with Events(page, wrong) as events:
            assert events.next()[0] == "found", wrong


def test_a_stream_begins_after_the_signals_that_were_fetched_before(scene):
    daemon, page = both(scene)
    set_relays(scene, daemon, 1)
    fetched = page.json("/api/signals")
    after = f"{fetched['generation']}:{fetched['cursor']}"
    set_relays(scene, daemon, 2)
    with Events(page, after=after) as events:
        event, data = events.next()
        assert event != "found", data
        if not any(row[:2] == [1, 2] for row in data.get("v", [])):
            events.value(1, 2)
        last = events.id
    set_relays(scene, daemon, 3)
    # the header is of a later time: a browser that comes back has both
    with Events(page, last, after="1:1") as events:
        assert events.next()[0] != "found"
    with Events(page, after="1:1") as events:
        assert events.next()[0] == "found"



def test_the_loss_of_owsd_makes_all_values_unknown_and_its_return_is_told(scene):
    daemon, page = both(scene)
    until(lambda: page.values()["room"] == 21.5, 20, "the room is good")
    with Events(page) as events:
        first = events.until("found")["generation"]
        daemon.kill()
        assert events.until("lost")["why"]
        last = events.id
        signals = page.json("/api/signals")["signals"]
        assert all(s["value"] is None and not s["quality"]["good"] for s in signals), signals
        assert signals[0]["quality"]["why"] == "owsd has ended or hangs.", signals[0]
        assert signals[0]["quality"]["remedy"].startswith("Does the service run"), signals[0]
        assert page.json("/api/info")["up"] is None
        # a browser that comes now learns it too
        with Events(page) as another:
            assert another.next()[0] == "lost"
        again = scene.owsd(daemon.config, name=daemon.name)
        second = events.until("found")["generation"]
        assert second != first
        until(lambda: page.values()["room"] == 21.5, 20, "the room is good again")
    with Events(page, last) as events:
        assert events.next()[0] == "found"
    with Events(page) as events:
        events.until("found")
        again.signal(owsdtest.signal.SIGHUP)
        assert events.until("found")["generation"] != second


def test_a_page_is_told_of_a_refused_reload_and_of_the_next_that_is_not(scene):
    daemon, page = both(scene)
    until(lambda: page.values()["room"] == 21.5, 20, "the room is good")
    assert page.json("/api/info")["refused"] is None
    good = daemon.config.read_text()
    with Events(page) as events:
        events.until("found")
        daemon.config.write_text(good + "Driver {\n")
        assert scene.owsctl(daemon, "reload").returncode == 1
        events.until("missed")  # it asks for all again, then
        assert f"{daemon.config}:" in page.json("/api/info")["refused"]
        daemon.config.write_text(good)
        assert scene.owsctl(daemon, "reload").returncode == 0
        events.until("found")
        assert page.json("/api/info")["refused"] is None


def fetched(port, path="/api/info"):
    """The body of an answer at that port of loopback; None: nobody listens there."""
    c = http.client.HTTPConnection("127.0.0.1", port, timeout=owsdtest.PATIENCE)
    try:
        c.request("GET", path)
        return c.getresponse().read().decode()
    except ConnectionRefusedError:
        return None
    finally:
        c.close()


def test_doors_and_files_follow_the_file_at_a_reload(scene):
    first, second, taken = (owsdtest.free_port() for _ in range(3))
    daemon = scene.owsd(text(scene))
    web = scene.start([WEB, "-n", daemon.name, "-c", daemon.config])
    until(lambda: "the page is at the socket" in web.log(), 20, "it serves")
    page = Page.__new__(Page)  # a client of it without -l
    page.port = first
    page.socket = place() / f"{daemon.name}.web"

    def reload(program=None, **keys):
        daemon.config.write_text(text(scene, **keys))
        if program:
            program.signal(owsdtest.signal.SIGHUP)
        else:
            assert scene.owsctl(daemon, "reload").returncode == 0

    assert fetched(first) is None
    reload(Listen=f"127.0.0.1:{first}")
    until(lambda: fetched(first), 20, "what owsd has reloaded is followed")
    reload(web, Listen=f"127.0.0.1:{second}, 127.0.0.1:{first}")
    until(lambda: fetched(second), 20, "SIGHUP alone is followed")
    assert fetched(first)
    reload(Listen=f"127.0.0.1:{second}")
    until(lambda: fetched(first) is None, 20, "what is no longer there is closed")
    assert fetched(second) and f"no longer at http://127.0.0.1:{first}/" in web.log()
    assert page.json("/api/info", unix=True)["instance"] == daemon.name, "the socket stays"
    with socket.create_server(("127.0.0.1", taken)):
        reload(Listen=f"127.0.0.1:{taken}")
        owsdtest.logged(web, f"cannot listen at 127.0.0.1:{taken}: Address already in use; sudo ss -ltnp")
    until(lambda: fetched(taken), 20, "it is free, and taken without another reload")
    other = scene.path / "other"
    other.mkdir()
    (other / "index.html").write_text("<!doctype html><title>another</title>\n")
    reload(Listen=f"127.0.0.1:{taken}", Files=other)
    until(lambda: "another" in fetched(taken, "/"), 20, "the files of another directory are served")
    assert web.log().count("cannot") == 1


def test_a_port_that_is_taken_is_named_with_its_remedy_until_it_is_free(scene):
    daemon = scene.owsd(text(scene))
    for option in (False, True):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            daemon.config.write_text(text(scene, **({} if option else {"Listen": f"127.0.0.1:{port}"})))
            web = scene.start([WEB, "-n", daemon.name, "-c", daemon.config, *(["-l", f"127.0.0.1:{port}"] * option)])
            owsdtest.logged(web, f"cannot listen at 127.0.0.1:{port}: Address already in use; sudo ss -ltnp")
            until(lambda: "the page is at the socket" in web.log(), 20, "it serves at its socket")
            until(lambda: "cannot listen at" in scene.owsctl(daemon, "doctor").stdout, 20, "doctor names it")
        until(lambda: fetched(port), 20, "it is taken when it is free")
        assert web.stop() == 0


def command(page, path, unix=True, headers=None, status=200, **body):
    """The answer to a POST as the page of the same origin sends it."""
    more = {"Content-Type": "application/json", "X-Owsd": "1", "Origin": "http://localhost",
            "Host": "localhost", **(headers or {})}
    return page.json(path, status, method="POST", body=json.dumps(body), unix=unix,
                     **{k: v for k, v in more.items() if v is not None})


def test_alarms_journal_and_stats_are_those_of_owsctl(scene):
    daemon, page = both(scene)
    until(lambda: page.json("/api/alarms")["alarms"], 20, "the room is in alarm")
    alarm = page.json("/api/alarms")["alarms"][0]
    told = json.loads(scene.owsctl(daemon, "--json", "alarms").stdout)[0]
    same = ("name", "alarm", "state", "device", "polled")
    assert [alarm[k] for k in same] == [told[k] for k in same], (alarm, told)
    assert alarm["i"] == 0 and alarm["value"] == 21.5 and alarm["quality"]["good"], alarm
    assert alarm["words"] == page.json("/api/signals")["signals"][0]["alarm"] == "! high", alarm
    for value in (1, 2, 3):
        set_relays(scene, daemon, value)
    entries = page.json("/api/journal")["entries"]
    assert [e["value"] for e in entries if e["journal"] == "commands"] == [3, 2, 1], entries
    assert entries[0]["by"]["program"] == "owsctl", entries
    assert [e["event"] for e in entries if e["journal"] == "alarms"] == ["raised"], entries
    assert len(page.json("/api/journal?n=2")["entries"]) == 2
    later = int((time.time() + 60) * 1000)
    assert page.json(f"/api/journal?since={later}")["entries"] == []
    assert page.json(f"/api/journal?until={later}")["entries"] == entries
    newest = int(datetime.datetime.fromisoformat(entries[0]["time"].replace("Z", "+00:00")).timestamp() * 1000)
    before = page.json(f"/api/journal?until={newest}")["entries"]
    assert 0 < len(before) < len(entries) and before == entries[-len(before):], (entries, before)
    stats = page.json("/api/stats")
    told = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    assert stats.keys() == told.keys() and stats["daemon"].keys() == told["daemon"].keys()
    assert [c["name"] for c in stats["counters"]] == [c["name"] for c in told["counters"]]
    for wrong in ("n=0", "n=x", "since=-1", "n=99999999999999999999"):
        assert page.json(f"/api/journal?{wrong}", 400)["error"], wrong
    lines = page.json("/api/log")["lines"]
    logged = [line for line in daemon.log().splitlines() if line]
    assert [line["text"] for line in lines] == logged[-len(lines):], (lines, logged)
    assert [line["number"] for line in lines] == list(range(1, len(lines) + 1)), lines
    assert any(line["level"] == "notice" and "target" in line["text"] for line in lines), lines
    assert abs(lines[-1]["time"] / 1000 - time.time()) < 60, lines[-1]
    daemon.kill()
    until(lambda: not page.json("/api/info")["live"], 20, "it is lost")
    assert "start" in page.json("/api/alarms", 503)["error"]
    assert page.json("/api/log")["lines"][:len(lines)] == lines, "why it ended may stand there"


def test_prometheus_scrapes_what_owsctl_metrics_prints(scene):
    daemon = scene.owsd(text(scene))
    page = Page(scene, daemon)
    until(lambda: page.values().get("room") == 21.5, 20, "room has a value")
    answer, status, body = page.ask("/metrics")
    assert status == 200, body
    assert answer.getheader("Content-Type") == (
        "application/openmetrics-text; version=1.0.0; charset=utf-8"), answer.getheaders()
    printed = scene.owsctl(daemon, "metrics").stdout
    names = [line.split(" ")[0] for line in printed.splitlines() if not line.startswith("#")]
    served = body.decode()
    assert [line.split(" ")[0] for line in served.splitlines() if not line.startswith("#")] == names
    assert served.endswith("# EOF\n"), served[-100:]
    daemon.kill()
    until(lambda: "\nows_up{" in (lost := page.ask("/metrics")[2].decode())
          and 'ows_up{owsd="%s"} 0' % daemon.name in lost and "\nows_value{" not in lost,
          20, "no value of a lost owsd is left")
    if not shutil.which("prometheus"):
        skip("prometheus is not installed")
    again = scene.owsd(daemon.config, name=daemon.name)
    port = owsdtest.free_port()
    scene.file("prometheus.yml", "global: {scrape_interval: 1s}\nscrape_configs:\n"
               "  - job_name: owsd\n    static_configs:\n"
               f"      - targets: ['127.0.0.1:{page.port}']\n")
    scene.start(["prometheus", f"--config.file={scene.path}/prometheus.yml",
                 f"--storage.tsdb.path={scene.path}/tsdb", f"--web.listen-address=127.0.0.1:{port}"])

    def scraped():
        with contextlib.suppress(OSError, ValueError), contextlib.closing(  # it starts
                http.client.HTTPConnection("127.0.0.1", port, timeout=owsdtest.PATIENCE)) as c:
            c.request("GET", "/api/v1/query?query=ows_value")
            found = json.loads(c.getresponse().read())["data"]["result"]
            return {one["metric"]["signal"]: float(one["value"][1]) for one in found}

    until(lambda: (scraped() or {}).get("room") == 21.5, 40, lambda: f"Prometheus has it: {scraped()}")
    assert again.stop() == 0


def test_an_alarm_is_an_event_with_its_entry(scene):
    limit = item("level", RELAY + "/PIO.BYTE", "byte", "output", Readable=raw("on"), LimitH=raw("5"))
    daemon, page = both(scene, limit, **{"Write": "on"})
    with Events(page) as events:
        events.until("found")
        assert command(page, "/api/set", name="level", value=9)["result"] == "taken"
        data = events.until("alarm")
        assert data["i"] == 0 and data["alarm"] == "! high", data
        assert data["entry"]["name"] == "level" and data["entry"]["event"] == "raised", data
        command(page, "/api/alarm", name="level", do="ack")
        data = events.until("alarm", lambda data: data["entry"]["event"] == "acknowledged")
        assert data["alarm"] == "high, acknowledged", data
        command(page, "/api/alarm", name="level", do="shelve", seconds=60, why="test")
        assert events.until("alarm")["alarm"] == "high, shelved"
        assert page.json("/api/alarms")["alarms"][0]["why"] == "test"
        command(page, "/api/alarm", name="level", do="unshelve")
        events.until("alarm", lambda data: data["entry"]["event"] == "unshelved")


def test_an_alarm_that_ends_without_an_entry_ends_in_a_row(scene):
    board = {RELAY + "/sensed.BYTE": "255", RELAY + "/latch.BYTE": "8", RELAY + "/por": "0",
             RELAY + "/set_alarm": "133331111"}
    with peer.Peer(board) as server:
        server.alarms = {RELAY[1:]}
        door = item("door", RELAY + "/sensed.BYTE", "byte", Alarm=raw("on"), LatchAlarm="latch.BYTE", PorAlarm="por",
                    SetAlarm="set_alarm=133331111", ResetLatch="latch.BYT=0")
        daemon = scene.owsd(owsdtest.rio(server.target, [door], Period=0.05, Web=raw("{ }")))
        page = Page(scene, daemon)
        until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")

        def alarm():
            return page.json("/api/signals")["signals"][0]["alarm"] or ""

        until(lambda: "! cannot be reset" in alarm(), 30, alarm)
        with Events(page) as events:
            events.until("found")
            server.values[RELAY + "/latch.BYT"] = b"0"
            events.until("values", lambda data: any("cannot be" not in str(row[5:6]) for row in data["v"]))
            assert "cannot be" not in alarm()


def test_an_output_that_reads_otherwise_is_among_the_alarms_with_what_was_commanded(scene):
    with peer.Peer({RELAY + "/PIO.0": "0"}) as server:
        pump = item("pump", RELAY + "/PIO.0", "bool", "output", ReadBack=raw("0.2"))
        daemon = scene.owsd(owsdtest.rio(server.target, [pump], Period=0.05, Web=raw("{ Write on }")))
        page = Page(scene, daemon)
        until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")
        assert command(page, "/api/set", name="pump", value=True)["result"] == "taken"
        with Events(page) as events:
            events.until("found")
            server.values[RELAY + "/PIO.0"] = b"0"
            row = events.until("values", lambda data: data["v"] and data["v"][-1][2] == DIFFERS)["v"][-1]
            assert row[1] is None and row[5] is None and row[6] and row[7] is True, row
        alarm, = page.json("/api/alarms")["alarms"]
        told, = json.loads(scene.owsctl(daemon, "--json", "alarms").stdout)
        assert (alarm["alarm"], alarm["state"]) == (told["alarm"], told["state"]), (alarm, told)
        assert alarm["alarm"] == "not as commanded" and not alarm["device"], alarm
        assert page.json("/api/signals")["signals"][0]["commanded"] is True
        server.values[RELAY + "/PIO.0"] = b"1"
        until(lambda: not page.json("/api/alarms")["alarms"], 20, "it reads as commanded")
        assert page.json("/api/signals")["signals"][0].get("commanded") is None


def test_a_row_of_a_bad_value_has_its_reason(scene):
    daemon, page = both(scene, item("attic", "/28.A0B1C2000009/temperature"))
    until(lambda: page.json("/api/signals")["signals"][0]["quality"]["text"] == "device absent", 20, "it is absent")
    at = page.json("/api/signals")
    why = at["signals"][0]["quality"]["why"]
    with Events(page, after=f"{at['generation']}:1") as events:
        data = events.until("values", lambda data: data["v"])
        assert [row[5:] for row in data["v"]] == [[None, why]], (data, why)


def test_trends_come_from_the_recorder(scene):
    history = scene.path / "history"
    daemon = scene.owsd(text(scene).replace("  Web ", f'  Recorder {{ Directory "{history}" Flush 1 }}\n  Web '))
    page = Page(scene, daemon)
    until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")
    assert page.json("/api/info")["history"] is False
    assert "owsd-recorder" in page.json("/api/trend?name=room", 404)["error"]
    assert "owsd-recorder" in page.json("/api/hour", 404)["error"]
    recorder = scene.start([BUILD / "owsd-recorder", "-n", daemon.name, "-c", daemon.config])
    until(lambda: "recording " in recorder.log(), 20, "it records")
    for value in (5, 9, 7):
        set_relays(scene, daemon, value)
        recorded(scene, "relays", str(value), history)

    def trend(name="relays", **more):
        now = int(time.time() * 1000)
        words = {"name": name, "from": now - 3600000, "until": now, "points": 10, **more}
        return page.json("/api/trend?" + "&".join(f"{k}={v}" for k, v in words.items()))
    until(lambda: page.ask("/api/trend?name=relays")[1] == 200 and 7 in trend()["last"], 20, "it is recorded")
    assert page.json("/api/info")["history"] is True
    got = trend()
    assert all(len(got[c]) == 10 for c in ("from", "min", "max", "last", "quality", "gap")), got
    assert (got["min"][-1], got["max"][-1], got["last"][-1]) == (5, 9, 7), got
    assert got["quality"][-1] == 192 and got["min"][0] is None and got["gap"][0] == 1, got
    assert got["from"] == sorted(got["from"]) and got["from"][1] - got["from"][0] == 360000, got
    hour = page.json("/api/hour")
    assert hour["step"] == 120_000 and set(hour["signals"]) == {"room", "relays"}, hour
    assert hour["next"] is None and set(page.json("/api/hour?first=1")["signals"]) == {"relays"}, hour
    assert page.json("/api/hour?first=9")["signals"] == {} and page.json("/api/hour?first=x", 400)["error"]
    relays = hour["signals"]["relays"]
    assert all(len(relays[c]) == 30 for c in ("min", "max", "last", "quality")), relays
    assert [v for v in relays["last"] if v is not None][-1] == 7 and relays["quality"][-1] == 192
    assert 9 in relays["max"] and relays["min"][0] is None and relays["quality"][0] == 0, relays
    assert trend("room")["unit"] == "\u00b0C"
    assert "nothing" in page.json("/api/trend?name=nothing", 404)["error"]
    records = page.json("/api/records?name=relays")
    assert records["next"] is None and 7 in [value for _, value, _ in records["records"]], records
    assert all(value is None or quality >= 0xc0 for _, value, quality in records["records"]), records
    assert "nothing" in page.json("/api/records?name=nothing", 404)["error"]
    for wrong in ("points=0", "points=2001", "points=x", "from=x", "from=9&until=8", "until=0"):
        assert page.json(f"/api/trend?name=room&{wrong}", 400)["error"], wrong
    assert page.json("/api/trend", 400)["error"]
    assert "commands" in {e["journal"] for e in page.json("/api/journal")["entries"]}
    # another name has its history at once, also before the recorder has written it
    assert recorder.stop() == 0
    renamed = daemon.config.read_text().replace('"relays"', '"ports"')
    assert renamed.count('"ports"') == 1, renamed
    daemon.config.write_text(renamed)
    assert scene.owsctl(daemon, "reload").returncode == 0
    until(lambda: page.ask("/api/trend?name=ports")[1] == 200, 20, "the page has seen the reload")
    got = trend("ports")
    assert got["name"] == "ports" and max(v for v in got["max"] if v is not None) == 9, got


def test_writing_is_off_unless_the_block_says_write_on(scene):
    daemon, page = both(scene)
    for unix in (False, True):
        assert "Write" in command(page, "/api/set", unix, status=403, name="relays", value=1)["error"]
        command(page, "/api/alarm", unix, status=403, name="room", do="ack")
    assert page.values()["relays"] is None
    text_on = re.sub(r"(Web +\{)", r"\1 Write on ", daemon.config.read_text())
    daemon.config.write_text(text_on)
    page.program.signal(owsdtest.signal.SIGHUP)
    until(lambda: page.json("/api/info")["writable"], 20, "it has read the file again")
    for unix, value in ((False, 3), (True, 4)):
        assert command(page, "/api/set", unix, name="relays", value=value) == {"ok": True, "result": "taken"}
        assert page.values()["relays"] == value
    entries = page.json("/api/journal")["entries"]
    assert [e["by"]["person"] for e in entries if e["journal"] == "commands"] == [
        getpass.getuser(), "127.0.0.1"], entries
    assert {e["by"]["program"] for e in entries if e["by"]} == {"owsd-web"}, entries
    for status, body in ((404, dict(name="nobody", value=1)), (400, dict(name="relays", value=256)),
                         (400, dict(name="relays", value="x")), (400, dict(name="relays")),
                         (400, dict(value=1)), (403, dict(name="room", value=1)),
                         (400, dict(name="relays", value=[1])), (400, dict(name=5, value=1))):
        assert command(page, "/api/set", status=status, **body)["error"], body
    for status, body in ((400, dict(name="room", do="dance")), (400, dict(name="room", do="shelve")),
                         (400, dict(name="relays", do="ack")), (404, dict(name="nobody", do="ack")),
                         (400, dict(name="room", do="shelve", seconds=0))):
        assert command(page, "/api/alarm", status=status, **body)["error"], body


def test_special_signals_are_read_and_those_that_can_be_are_set(scene):
    daemon, page = both(scene, Write="on")

    def special():
        signals = page.json("/api/special?name=room")["signals"]
        return {one["name"]: one for one in signals}

    until(lambda: float(special()["_Age"]["value"]) < 60, 20, special)
    assert special()["_ReadEnable"] == {"name": "_ReadEnable", "flag": True, "readable": True,
                                        "writable": True, "value": "1"}
    assert special()["_DGNRESET"]["value"] is None and "_Alarm" not in special()
    assert command(page, "/api/set", name="room_ReadEnable", value=False)["result"] == "taken"
    assert special()["_ReadEnable"]["value"] == "0", "it is what was answered"
    assert command(page, "/api/set", name="room_DGNRESET", value=True)["result"] == "sent"
    command(page, "/api/set", status=404, name="room_Age", value=1)
    command(page, "/api/set", status=400, name="room_ReadEnable", value="maybe")
    command(page, "/api/alarm", status=400, name="room_ReadEnable", do="ack")
    page.json("/api/special?name=nobody", 404)
    page.json("/api/special", 404)


def test_only_the_proxy_of_the_block_names_a_person(scene):
    me = getpass.getuser()
    daemon, page = both(scene, **{"Write": "on", "Proxy": me})

    def person(value, status=200, unix=True, name=None):
        def people():
            return [entry["by"]["person"] for entry in page.json("/api/journal")["entries"] if entry["by"]]
        headers, before = {"X-Remote-User": name}, len(people())
        got = command(page, "/api/set", unix, headers, status, name="relays", value=value)
        if status != 200:
            return got["error"]
        until(lambda: len(people()) > before, 20, people)
        return people()[0]
    assert person(1, name="anna") == "anna"
    assert person(2, name="J\u00fcrgen".encode()) == "J\u00fcrgen"
    for name in (None, "", "a" * 32, "a b", b"\xff", "\u202e".encode()):
        assert "X-Remote-User" in person(3, 403, name=name), name
    info = page.json("/api/info", unix=True, **{"X-Remote-User": "anna"})
    assert (info["writable"], info["person"]) == (True, "anna"), info
    assert page.json("/api/info", unix=True)["writable"] is False
    # at an address the header means nothing
    assert person(4, unix=False, name="root") == "127.0.0.1"
    text_without = re.sub(r'Proxy "[^"]*"', "", daemon.config.read_text())
    daemon.config.write_text(text_without)
    page.program.signal(owsdtest.signal.SIGHUP)
    until(lambda: person(5, name="anna") == me, 20, "without Proxy it means nothing")


def nginx_of_the_page():
    block = re.search(r"```nginx\n(.*?)```", (owsdtest.SOURCE / "docs/web.md").read_text(), re.S)
    return block[1]


def test_the_example_for_nginx_works(scene):
    nginx = shutil.which("nginx", path=os.environ["PATH"] + ":/usr/sbin")
    if not nginx:
        skip("nginx is not installed")
    me, port = getpass.getuser(), owsdtest.free_port()
    daemon, page = both(scene, **{"Write": "on", "Proxy": me})
    users = scene.file("users", "anna:{PLAIN}secret\n")
    server = re.sub(r"(?m)^ *ssl_.*\n", "", nginx_of_the_page())
    for old, new in (("listen 443 ssl http2", f"listen 127.0.0.1:{port}"), ("/run/owsd/OWS.web", str(page.socket)),
                     ("/etc/nginx/owsd.users", str(users)), ("server_name house.example", "server_name _")):
        assert old in server, old
        server = server.replace(old, new)
    temp = "".join(f"{kind}_temp_path {scene.path}/{kind};\n" for kind in
                   ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
    conf = scene.file("nginx.conf", f"""
daemon off; master_process off; pid {scene.path}/nginx.pid; error_log stderr;
{f"user {me};" if os.geteuid() == 0 else ""}
events {{}}
http {{
{temp} access_log off;
{server}
}}
""")
    proxy = scene.start([nginx, "-e", "stderr", "-p", scene.path, "-c", conf])
    host = f"127.0.0.1:{port}"
    login = {"Authorization": "Basic " + base64.b64encode(b"anna:secret").decode()}

    def ask(path, method="GET", body=None, **headers):
        c = http.client.HTTPConnection("127.0.0.1", port, timeout=owsdtest.PATIENCE)
        with contextlib.closing(c):
            c.request(method, path, body, {**login, **headers})
            answer = c.getresponse()
            return answer.status, answer.read()

    def listens():
        with contextlib.suppress(ConnectionRefusedError), socket.create_connection(("127.0.0.1", port)):
            return True
        assert proxy.running(), proxy.log()
    until(listens, 20, "nginx listens")
    assert ask("/owsd/api/info", Authorization="Basic eDp5")[0] == 401
    assert ask("/owsd/")[0] == 200 and json.loads(ask("/owsd/api/info")[1])["instance"] == daemon.name
    mine = {"Content-Type": "application/json", "X-Owsd": "1", "Origin": f"http://{host}"}
    # what a client says of itself does not reach owsd-web
    status, body = ask("/owsd/api/set", "POST", '{"name":"relays","value":6}', **mine, **{"X-Remote-User": "root"})
    assert status == 200, body
    assert page.json("/api/journal")["entries"][0]["by"]["person"] == "anna"
    assert ask("/owsd/api/set", "POST", '{"name":"relays","value":7}', **{**mine, "Origin": "http://evil"})[0] == 403
    with socket.create_connection(("127.0.0.1", port), timeout=owsdtest.PATIENCE) as s, s.makefile("rb") as file:
        s.sendall(f"GET /owsd/api/events HTTP/1.1\r\nHost: {host}\r\nAuthorization: {login['Authorization']}\r\n\r\n"
                  .encode())
        until(lambda: b"event: found" in file.readline(), 20, "events come through at once", step=0)


ASK = """
import os, socket, sys
os.setgroups([int(g) for g in sys.argv[2].split(",") if g]); os.setgid(65534); os.setuid(65534)
s = socket.socket(socket.AF_UNIX); s.connect(sys.argv[1]); s.sendall(sys.argv[3].encode())
got = b""
while more := s.recv(65536): got += more
print(got.decode())
"""


def test_rights_are_those_of_the_peer_on_the_socket(scene):
    if os.geteuid() != 0:
        skip("only root can be another user")
    _, page = both(scene, **{"Write": "on"})
    body = '{"name":"relays","value":1}'
    post = ("POST /api/set HTTP/1.1\r\nHost: x\r\nX-Owsd: 1\r\nContent-Type: application/json\r\n"
            f"X-Remote-User: root\r\nContent-Length: {len(body)}\r\n\r\n{body}")
    os.chmod(place().parent, 0o755)
    os.chmod(page.socket, 0o666)  # as if another group might open it

    def ask(groups, text):
        return subprocess.run(["python3", "-c", ASK, str(page.socket), groups, text], capture_output=True,
                              text=True, timeout=owsdtest.PATIENCE)
    get = "GET /api/info HTTP/1.1\r\nHost: x\r\n\r\n"
    assert status_of(ask("", get).stdout.encode()) == 200
    refused = ask("", post)
    assert status_of(refused.stdout.encode()) == 403 and "owsd-control" in refused.stdout, refused
    with contextlib.suppress(KeyError):
        assert status_of(ask(str(grp.getgrnam("owsd-control").gr_gid), post).stdout.encode()) == 200
    os.chmod(page.socket, 0o660)
    assert "PermissionError" in ask("", get).stderr


def test_a_command_of_another_page_is_refused(scene):
    _, page = both(scene, **{"Write": "on"})
    host = f"127.0.0.1:{page.port}"
    good = {"Host": host, "Origin": f"http://{host}"}
    for unix in (False, True):
        command(page, "/api/set", unix, good, name="relays", value=1)
        command(page, "/api/set", unix, {**good, "Origin": None}, name="relays", value=1)
        for wrong in ({"Origin": "http://evil.example"}, {"Origin": "null"},
                      {"Origin": f"http://{host}.evil.example"}, {"Origin": f"ftp://{host}"},
                      {"Origin": "http://127.0.0.1"}, {"X-Owsd": None}, {"X-Owsd": "0"}):
            assert command(page, "/api/set", unix, {**good, **wrong}, 403, name="relays", value=2), wrong
        for wrong in ("text/plain", "application/x-www-form-urlencoded", None):
            command(page, "/api/set", unix, {**good, "Content-Type": wrong}, 415, name="relays", value=2)
    # nothing but a POST commands, and no preflight is answered with leave
    assert page.json("/api/set", 404)
    answer, status, _ = page.ask("/api/set", "OPTIONS", Origin="http://evil.example")
    assert status == 405 and not answer.getheader("Access-Control-Allow-Origin")
    assert page.values()["relays"] == 1


def served_paths():
    """What has data: (path, whether it is posted to)."""
    table = (owsdtest.SOURCE / "src/faces/web/api.c").read_text()
    found = [("/" + path, ".post = true" in how)
             for path, how in re.findall(r'\{"([a-z/]+)", (\.[^}]+)\},', table)]
    assert len(found) > 20 and ("/api/devices", False) in found and ("/api/set", True) in found, found
    return found


def test_no_path_with_data_answers_what_another_site_has_a_browser_send(scene):
    _, page = both(scene, **{"Write": "on", "Configure": "on"})
    host = f"127.0.0.1:{page.port}"
    foreign = [{"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"}, {"Sec-Fetch-Site": "x"},
               {"Origin": "http://evil.example"}, {"Origin": "null"}, {"Origin": "http://127.0.0.1"},
               {"Sec-Fetch-Site": "cross-site", "Origin": f"http://{host}"},
               {"Sec-Fetch-Site": "same-origin", "Origin": "http://evil.example"}]
    own = [{}, {"Sec-Fetch-Site": "same-origin"}, {"Sec-Fetch-Site": "none"}, {"Origin": f"http://{host}"}]
    body = json.dumps({"name": "relays", "value": 3, "do": "check", "text": "x", "base": "0" * 16})
    for path, posted in served_paths():
        method = ["POST"] if posted else ["GET", "HEAD"]
        for unix in (False, True):
            for headers in foreign:
                for one in method:
                    answer, status, words = page.ask(
                        path, one, body if posted else None, unix, Host=host, X_Owsd="1",
                        Content_Type="application/json", **headers)
                    assert status == 403, (path, one, headers, status)
                    assert one == "HEAD" or b"another page" in words, (path, words)
                    assert answer.getheader("Cross-Origin-Resource-Policy") == "same-origin"
    assert page.values()["relays"] != 3
    for headers in own:
        for unix in (False, True):
            page.json("/api/signals", unix=unix, Host=host, **headers)
            page.json("/api/devices", unix=unix, Host=host, X_Owsd="1", **headers)
            command(page, "/api/set", unix, {"Host": host, "Origin": None, **headers}, name="relays", value=1)
    # a link to the page leads there from anywhere
    for headers in foreign:
        assert page.ask("/", Host=host, **headers)[1] == 200
    # a browser sends no Sec-Fetch-Site to http:// but of the loopback: what has an effect needs more
    assert "X-Owsd" in page.json("/api/devices", 403, Host=host)["error"]


def test_another_name_than_this_machines_is_refused_at_an_address(scene):
    _, page = both(scene, Hosts="house.example, other.example")
    for name in ("localhost", "127.0.0.1", "127.0.0.9", "[::1]", socket.gethostname(), "house.example",
                 "OTHER.example", "localhost."):
        for port in ("", f":{page.port}"):
            page.json("/api/info", 200, Host=name + port)
    for name in ("evil.example", "localhost.evil.example", "192.168.1.9", "house.example.", "127.0.0.1.nip.io",
                 "evil.example:80", "localhost:x", "a b", "[::1", "::1", "[evil]"):
        if name != "house.example.":
            assert "Hosts" in page.json("/api/info", 421, Host=name)["error"], name
    # the socket has rights; what the proxy sends as Host is its own
    page.json("/api/info", unix=True, Host="evil.example")


def status_of(answer):
    return int(answer.split(b" ", 2)[1]) if answer.startswith(b"HTTP/1.1 ") else answer


def test_heads_that_a_proxy_could_read_otherwise_are_refused(scene):
    _, page = both(scene, **{"Write": "on"})
    head = b"GET /api/info HTTP/1.1\r\nHost: localhost\r\n"
    inner = b"GET /api/stats HTTP/1.1\r\nHost: localhost\r\n\r\n"
    post = b"POST /api/set HTTP/1.1\r\nHost: localhost\r\nX-Owsd: 1\r\nContent-Type: application/json\r\n"
    body = b'{"name":"relays","value":5}'
    cases = [
        (200, head + b"\r\n"), (200, head + b"X:\r\nY: \t a b \r\n\r\n"),
        (400, head + b"Content-Length: 5\r\n\r\nhello"),
        (400, post + b"Content-Length: 5\r\nContent-Length: 27\r\n\r\n" + body),
        (400, post + b"Content-Length: 27\r\nContent-Length: 27\r\n\r\n" + body),
        (400, post + b"Content-Length: 27, 27\r\n\r\n" + body),
        (400, post + b"Content-Length: +27\r\n\r\n" + body),
        (400, post + b"Content-Length: 0x1b\r\n\r\n" + body),
        (400, post + b"Content-Length:\r\n\r\n" + body),
        (400, post + b"Content-Length : 27\r\n\r\n" + body),
        (501, post + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"),
        (501, post + b"Content-Length: 27\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"),
        (501, post + b"transfer-encoding: identity\r\n\r\n"),
        (413, post + b"Content-Length: 8193\r\n\r\n"),
        (413, post + b"Content-Length: 99999999999999999999999\r\n\r\n"),
        (400, head + b"X: a\r\n b\r\n\r\n"), (400, head + b"X: a\r\n\tb\r\n\r\n"),
        (400, head.replace(b"\r\n", b"\n") + b"\n"), (400, head + b"X: a\nX-Remote-User: root\r\n\r\n"),
        (400, head + b"X: a\rb\r\n\r\n"), (400, head + b"X: \0\r\n\r\n"), (400, head + b"X\r\n\r\n"),
        (400, head + b": a\r\n\r\n"), (400, head + b"X(y): a\r\n\r\n"), (400, head + b"Host: b\r\n\r\n"),
        (400, head + b"X-Remote-User: a\r\nx-remote-user: b\r\n\r\n"),
        (400, b"GET /api/info HTTP/1.1\r\n\r\n"), (400, b"\r\n" + head + b"\r\n"),
        (400, b"GET  /api/info HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        (400, b"GET http://localhost/ HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        (400, b"GET /a%00b HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        (400, b"GET /\xff HTTP/1.1\r\nHost: localhost\r\n\r\n"), (400, b"GET /\r\n"),
        (505, b"GET / HTTP/2.0\r\nHost: localhost\r\n\r\n"), (505, b"GET / HTTP/1.1x\r\nHost: a\r\n\r\n"),
        (400, b"\x16\x03\x01\x02\x00\x01\x00"), (400, b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        (431, head + b"X: " + b"a" * 9000 + b"\r\n\r\n"), (431, b"G" * 9000), (431, head + b"X: a\r\n" * 2000),
        (405, b"DELETE /api/info HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        (200, b"HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n"),
    ]
    for status, data in cases:
        for unix in (False, True):
            got = page.raw(data, unix)
            assert status_of(got) == status, (data[:200], got)
            assert got.count(b"HTTP/1.1 ") == 1, got
    # one request for each connection: what comes after it is never read as another
    got = page.raw(head + b"\r\n" + inner)
    assert status_of(got) == 200 and got.count(b"HTTP/1.1 ") == 1 and b"counters" not in got, got
    got = page.raw(post + b"Content-Length: 2\r\n\r\n{}" + inner)
    assert status_of(got) == 400 and got.count(b"HTTP/1.1 ") == 1, got
    assert page.values()["relays"] is None


def test_head_is_answered_as_get_without_the_body(scene):
    _, page = both(scene)
    streams = "/api/events", "/api/signals"
    for path, status in (("/", 200), ("/api/info", 200), ("/none", 404), *((p, 200) for p in streams)):
        head = page.raw(f"HEAD {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert status_of(head) == status and head.index(b"\r\n\r\n") == len(head) - 4, head
        if path not in streams:
            _, _, body = page.ask(path)
            assert f"Content-Length: {len(body)}\r\n".encode() in head, (head, body)
    with Events(page) as stream:
        assert stream.until("found")


def test_a_head_may_come_in_pieces_and_who_sends_none_holds_up_nobody(scene):
    _, page = both(scene)
    with contextlib.ExitStack() as open_ones:
        for _ in range(40):
            s = open_ones.enter_context(page.tcp())
            s.sendall(b"GET /api/info HTTP/1.1\r\nHost: local")
        page.json("/api/info")
        with page.unix() as s:
            for byte in b"GET /api/info HTTP/1.1\r\nHost: localhost\r\n\r\n":
                s.sendall(bytes([byte]))
            assert s.recv(100).startswith(b"HTTP/1.1 200 ")
        # more than one address may have
        for _ in range(40):
            open_ones.enter_context(page.tcp()).sendall(b"G")
        assert status_of(page.raw(b"GET / HTTP/1.1\r\n")) == 503
        page.json("/api/info", unix=True)
    until(lambda: status_of(page.raw(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")) == 200, 20, "they have gone")


def test_three_hundred_streams_get_each_change(scene):
    daemon, page = both(scene)
    with contextlib.ExitStack() as all_of_them:
        streams = [all_of_them.enter_context(Events(page)) for _ in range(300)]
        for stream in streams:
            assert stream.until("found")
        for value in (7, 8):
            set_relays(scene, daemon, value)
            for stream in streams:
                stream.value(1, value)
        assert page.json("/api/info")["signals"] == 2
    # those that have gone are noticed with the next line for them
    until(lambda: len(owsdtest.open_files(page.program)) < 60, 60, "they are closed")


def test_a_client_that_reads_nothing_gets_the_newest_state_and_costs_no_memory(scene):
    faulty.not_sanitized("a sanitizer keeps memory that was freed")
    items = [item(f"relays{i}", RELAY + "/PIO.BYTE", "byte", "input") for i in range(300)]
    daemon, page = both(scene, RELAYS, *items)

    def resident():
        with open(f"/proc/{page.program.pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    with contextlib.ExitStack() as all_of_them:
        slow = [all_of_them.enter_context(Events(page)) for _ in range(30)]
        for s in slow:
            s.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        with Events(page) as quick:
            quick.until("found")
            for value in range(1, 60):
                set_relays(scene, daemon, value)
            quick.value(0, 59)
        assert resident() < 20 << 20, resident()
        for s in slow:
            s.value(0, 59)


def test_the_page_needs_little_memory(scene):
    faulty.not_sanitized("a sanitizer has memory of its own")
    _, page = both(scene)
    with open(f"/proc/{page.program.pid}/smaps_rollup", encoding="ascii") as file:
        lines = dict(line.split(":") for line in file.read().splitlines()[1:])
    own, resident = (int(lines[key].split()[0]) for key in ("Private_Dirty", "Rss"))
    assert own < 2048, lines
    assert resident < 5120 or os.uname().machine != "x86_64", lines


def test_a_second_owsd_web_is_refused_and_a_stale_socket_is_not(scene):
    daemon, page = both(scene)
    second = scene.start([WEB, "-n", daemon.name, "-c", daemon.config])
    assert second.wait() == 1 and "another owsd-web" in second.log(), second.log()
    page.json("/api/info", unix=True)
    page.program.kill()
    assert page.socket.exists()
    again = Page(scene, daemon)
    again.json("/api/info", unix=True)
    assert oct(again.socket.stat().st_mode & 0o777) == "0o660"
    assert again.program.stop() == 0 and not again.socket.exists()


def test_its_report_has_a_status_from_the_first_on(scene):
    if not WEB.exists():
        skip("owsd-web is not built: there is no libmicrohttpd")
    daemon = scene.owsd(text(scene))
    report, seen = place() / f"{daemon.name}.owsd-web", set()
    scene.start([WEB, "-n", daemon.name, "-c", daemon.config])

    def settled():
        with contextlib.suppress(FileNotFoundError):
            seen.add(next(line for line in report.read_text().splitlines() if line.startswith("status")))
        return any("streams" in line for line in seen)
    until(settled, 20, lambda: seen, step=0.001)
    assert "status " not in seen, seen


def test_a_socket_of_the_service_manager_is_taken_and_outlives_the_program(scene):
    if not WEB.exists():
        skip("owsd-web is not built: there is no libmicrohttpd")
    daemon = scene.owsd(text(scene))
    path = str(scene.path / "given")

    def asked():
        c = http.client.HTTPConnection("localhost", timeout=owsdtest.PATIENCE)
        c.sock = socket.socket(socket.AF_UNIX)
        c.sock.settimeout(owsdtest.PATIENCE)
        c.sock.connect(path)
        with contextlib.closing(c):
            c.request("GET", "/api/info")
            return c.getresponse().status
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen()
        os.dup2(listener.fileno(), 3, inheritable=True) if listener.fileno() != 3 else None
        # who restarts it finds the socket as it was
        for _ in range(2):
            started = subprocess.Popen(
                ["sh", "-c", 'LISTEN_PID=$$ LISTEN_FDS=1 exec "$@"', "sh", str(WEB), "-n", daemon.name,
                 "-c", str(daemon.config)], pass_fds=[3], stdin=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL)
            try:
                assert asked() == 200
                assert not (place() / f"{daemon.name}.web").exists()
            finally:
                started.terminate()
                assert started.wait(owsdtest.PATIENCE) == 0
        os.close(3)


if __name__ == "__main__":
    owsdtest.main()
