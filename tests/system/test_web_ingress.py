#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page behind Home Assistant's ingress. The proxy here is a model of it, written from what the
code of Core (components/hassio/ingress.py, 2025) and Supervisor (api/ingress.py) does: it asks for a
cookie, takes /api/hassio_ingress/TOKEN off the path, passes on Host, Origin and all else that the
browser sent, but sets X-Remote-User-Id, -Name and -Display-Name itself, and streams what has no
Content-Length. The genuine ones need a whole Home Assistant, and are not tried here."""

import contextlib
import http.client
import http.server
import json
import socket
import threading

import browser
import faulty
import owsdtest
import webhouse
from owsdtest import until
from test_web import Events, both, status_of

TOKEN, COOKIE = "Wq3zN0", "ingress_session=5f1d"
PREFIX = f"/api/hassio_ingress/{TOKEN}/"
DROPPED = {"content-length", "content-encoding", "transfer-encoding", "accept-encoding", "connection",
           "x-remote-user-id", "x-remote-user-name", "x-remote-user-display-name"}
NOT_BACK = {"content-length", "content-encoding", "transfer-encoding", "connection"}
PROXY = "127.0.0.2"  # the address of Supervisor, in place of 172.30.32.2


class Ingress(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, target, user):
        self.target, self.user = target, user
        super().__init__(("127.0.0.1", owsdtest.free_port()), Hop)


class Hop(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        if COOKIE not in self.headers.get("Cookie", "") or not self.path.startswith(PREFIX):
            self.send_error(401)
            return
        body = self.rfile.read(int(self.headers.get("Content-Length", 0))) or None
        onward = http.client.HTTPConnection("127.0.0.1", self.server.target,
                                            source_address=(PROXY, 0),
                                            timeout=owsdtest.PATIENCE)
        with contextlib.closing(onward), contextlib.suppress(ConnectionError):
            onward.putrequest(self.command, "/" + self.path[len(PREFIX):], skip_host=True,
                              skip_accept_encoding=True)
            for name, value in self.sent():
                onward.putheader(name, value)
            if body:
                onward.putheader("Content-Length", str(len(body)))
            onward.endheaders(body)
            self.give_back(onward.getresponse())

    do_POST = do_GET

    def sent(self):
        yield from self.server.user.items()
        for name, value in self.headers.items():
            if name.lower() not in DROPPED:
                yield name, value
        yield "X-Hass-Source", "core.ingress"
        yield "X-Ingress-Path", PREFIX[:-1]
        yield "X-Forwarded-For", f"{self.client_address[0]}, 172.30.32.1"
        yield "X-Forwarded-Host", self.headers["Host"]
        yield "X-Forwarded-Proto", "http"

    def give_back(self, answer):
        self.send_response(answer.status)
        for name, value in answer.getheaders():
            if name.lower() not in NOT_BACK:
                self.send_header(name, value)
        if answer.getheader("Content-Length") is not None or answer.status == 304:
            body = answer.read()
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)
            return
        self.send_header("Transfer-Encoding", "chunked")
        self.end_headers()
        while part := answer.read1(65536):
            self.wfile.write(b"%x\r\n%s\r\n" % (len(part), part))
        self.wfile.write(b"0\r\n\r\n")


ANNA = {"X-Remote-User-Id": "0123456789abcdef0123456789abcdef", "X-Remote-User-Name": "anna",
        "X-Remote-User-Display-Name": "Anna B."}


@contextlib.contextmanager
def ingress(target, user):
    server = Ingress(target, user)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def ask(server, path, method="GET", body=None, **headers):
    c = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=owsdtest.PATIENCE)
    with contextlib.closing(c):
        c.request(method, PREFIX + path, body, {
            "Cookie": COOKIE, "Host": "house.example:8123",
            **{k.replace("_", "-"): v for k, v in headers.items()}})
        answer = c.getresponse()
        return answer.status, answer.read()


def command(server, value, **headers):
    return ask(server, "api/set", "POST", json.dumps({"name": "relays", "value": value}), **{
        "Content-Type": "application/json", "X-Owsd": "1", "Origin": "http://house.example:8123",
        **headers})


def direct(page, path="/api/info"):
    """From another address than the proxy's; both() waits for that until there is a Proxy."""
    return page.raw(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nX-Remote-User-Name: anna\r\n\r\n"
                    .encode())


def only_proxy(daemon, web):
    text = daemon.config.read_text()
    assert text.count("Write ") == 1, text
    daemon.config.write_text(text.replace("Write ", f'Proxy "{PROXY}" Write '))
    web.signal(owsdtest.signal.SIGHUP)


def behind(scene, **web):
    """An owsd-web that serves the proxy alone."""
    daemon, page = both(scene, **{"Write": "on", **web})
    only_proxy(daemon, page.program)
    until(lambda: status_of(direct(page)) == 403, 20, "others are refused")
    return daemon, page


def test_the_person_whom_ingress_names_commands_and_stands_in_the_journal(scene):
    daemon, page = behind(scene)
    with ingress(page.port, ANNA) as server:
        assert ask(server, "")[0] == 200 and ask(server, "plot.js")[0] == 200
        info = json.loads(ask(server, "api/info")[1])
        assert (info["instance"], info["person"], info["writable"]) == (daemon.name, "anna", True)
        status, body = command(server, 3)
        assert status == 200, body
        # an alarm of the room has no person
        entries = json.loads(ask(server, "api/journal")[1])["entries"]
        assert [e["by"]["person"] for e in entries if e["by"]][:1] == ["anna"], entries
        # Supervisor passes X-Remote-User on: it is anybody's, and does not count
        assert command(server, 4, X_Remote_User="root")[0] == 200
        assert command(server, 5, X_Remote_User_Name="root")[0] == 200
        entries = json.loads(ask(server, "api/journal")[1])["entries"]
        assert {e["by"]["person"] for e in entries if e["journal"] == "commands"} == {"anna"}
        # another page of the same browser
        for origin in ("http://evil.example", "null", "http://house.example"):
            assert command(server, 6, Origin=origin)[0] == 403, origin
        assert command(server, 6, X_Owsd="0")[0] == 403
    # a Home Assistant that names nobody
    for user in ({}, {"X-Remote-User-Id": "0" * 32, "X-Remote-User-Display-Name": "Anna"},
                 {"X-Remote-User-Name": "a b"}, {"X-Remote-User-Name": "a" * 32}):
        with ingress(page.port, user) as server:
            status, body = command(server, 7)
            assert status == 403 and b"X-Remote-User-Name" in body, body
            assert json.loads(ask(server, "api/info")[1])["writable"] is False
            signals = json.loads(ask(server, "api/signals")[1])["signals"]
            assert [s["value"] for s in signals if s["name"] == "relays"] == [5], signals


def test_the_wires_are_scanned_for_the_person_whom_ingress_names(scene):
    _, page = behind(scene, Configure="on")
    with ingress(page.port, ANNA) as server:
        # owsd has no wire yet when it begins to serve
        until(lambda: ask(server, "api/devices", X_Owsd="1")[0] == 200, 10, "a scan")
        assert ask(server, "api/devices")[0] == 403
        assert json.loads(ask(server, "api/config")[1])["configurable"]
    with ingress(page.port, {}) as server:
        stored = json.loads(ask(server, "api/config", X_Remote_User="root")[1])
        assert not stored["configurable"] and "X-Remote-User-Name" in stored["why"], stored
        # Supervisor passes that on as the browser sent it
        status, body = ask(server, "api/devices", X_Owsd="1", X_Remote_User="root")
        assert status == 403 and b"X-Remote-User-Name" in body, body


def test_at_an_address_all_but_the_proxy_are_refused_and_the_socket_is_as_before(scene):
    daemon, page = behind(scene)
    for path in ("/", "/api/info", "/api/signals", "/api/events"):
        answer = direct(page, path)
        assert status_of(answer) == 403 and b"the proxy alone" in answer, answer
    assert page.json("/api/info", unix=True)["writable"]
    twice = (b"GET /api/info HTTP/1.1\r\nHost: a\r\nX-Remote-User-Name: anna\r\n"
             b"x-remote-user-name: root\r\n\r\n")
    assert status_of(page.raw(twice)) == 400
    # the log says so, after a reload too, and of one that everybody reaches
    owsdtest.logged(page.program, f"the page is at http://127.0.0.1:{page.port}/: for the proxy alone")
    assert page.program.stop() == 0
    for proxy, who in ((True, "for the proxy alone"), (False, "whoever reaches it may command")):
        if not proxy:
            daemon.config.write_text(daemon.config.read_text().replace(f'Proxy "{PROXY}"', ""))
        port = owsdtest.free_port()
        web = scene.start([page.program.command[0], "-n", daemon.name, "-c", daemon.config, "-l", f"0.0.0.0:{port}"])
        owsdtest.logged(web, f"the page is at http://0.0.0.0:{port}/: {who}")
        assert web.stop() == 0


class Connection(socket.socket):
    """To the proxy; a request that Events sends gets the prefix and the cookie."""

    def sendall(self, data):
        super().sendall(data.replace(b"GET /", b"GET " + PREFIX.encode(), 1)
                        .replace(b"\r\n\r\n", f"\r\nCookie: {COOKIE}\r\n\r\n".encode()))


class Through:
    """What Events asks of a page, by the proxy."""

    def __init__(self, server):
        self.port = server.server_port

    def unix(self):
        connection = Connection()
        connection.settimeout(owsdtest.PATIENCE)
        connection.connect(("127.0.0.1", self.port))
        return connection


def test_events_come_through_ingress_at_once_and_go_on(scene):
    daemon, page = behind(scene)
    with ingress(page.port, ANNA) as server:
        with Events(Through(server)) as events:
            events.until("found")
            assert command(server, 1)[0] == 200
            events.value(1, 1)
            last = events.id
        assert command(server, 2)[0] == 200
        with Events(Through(server), last) as events:
            event, data = events.next()
            assert event != "found", data
            if not any(row[:2] == [1, 2] for row in data.get("v", [])):
                events.value(1, 2)
    assert daemon.running()


def test_the_page_works_below_the_prefix_of_ingress(scene):
    faulty.not_sanitized("the page is no code of ours in C, and lies beside the plain build")
    with browser.open_one(scene) as page:
        daemon = webhouse.house(scene, write=True)
        until(lambda: scene.get(daemon, "room") == "21.5", 15, "room is good")
        web = webhouse.serve(scene, daemon)
        only_proxy(daemon, web)
        with ingress(web.port, ANNA) as server:
            base = f"http://127.0.0.1:{server.server_port}"
            page.go(base + "/")
            page.run("document.cookie = arguments[0] + '; path=/'", COOKIE)
            page.complaints()
            page.go(base + PREFIX)
            page.until("return [...document.querySelectorAll('#live tbody .name')]"
                       ".some((one) => one.textContent === 'room')", "the rows")
            page.click("[role=switch][aria-label=light][aria-checked=false]:enabled")
            page.click("dialog button.primary")
            until(lambda: scene.get(daemon, "light") == "1", 20, "the switch has commanded")
            for view in webhouse.VIEWS:
                webhouse.view(page, view)
            webhouse.view(page, "alarms")
            webhouse.shows(page, "#alarms", "anna")
            assert page.complaints() == []


if __name__ == "__main__":
    owsdtest.main()
