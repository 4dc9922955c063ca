#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Pages that know of each other: three owsd-web, one of them stopped and one by its socket, and
servers that are none, which send without end, slowly, too much, elsewhere, or markup."""

import contextlib
import json
import os
import socket
import threading
import time

import browser
import owsdtest
from owsdtest import free_port, raw, until
from test_web import Page, item, text
from test_web_everywhere import axe
from webhouse import serve, shows, text_of, view

GOOD = json.dumps({"instance": "OWS", "host": "<b>pi</b>", "version": "<script>", "first": None, "alarm": None,
                   "live": True, "signals": 3, "not_good": 0, "alarms": 0, "needs": 0, "up": 9})


def house(scene, name, *items, **web):
    daemon = scene.owsd(text(scene, *items, **web), name=name)
    until(lambda: scene.owsctl(daemon, "list", "--json").returncode == 0, 20, "owsd is there")
    return daemon


class Server:
    """Answers each connection by act(connection) on a thread of its own, and keeps what was asked."""

    def __init__(self, act):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.act, self.asked, self.sent = act, [], 0
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        with contextlib.suppress(OSError):
            while True:
                threading.Thread(target=self.answer, args=self.socket.accept()[:1], daemon=True).start()

    def answer(self, connection):
        with contextlib.suppress(OSError), connection:
            self.asked.append(connection.recv(4096).decode())
            self.act(self, connection)

    def send(self, connection, data):
        connection.sendall(data)
        self.sent += len(data)


HEAD = b"HTTP/1.0 200 OK\r\nContent-Type: application/json\r\n\r\n"


def endless(server, connection):
    server.send(connection, HEAD)
    while True:
        server.send(connection, b"x" * 1000)


def slow(server, connection):
    for byte in HEAD * 100:
        server.send(connection, bytes([byte]))
        time.sleep(0.1)  # a byte is so slow that its answer has no end in time


def silent(server, connection):
    time.sleep(owsdtest.PATIENCE)  # longer than anybody waits


def redirect(server, connection):
    server.send(connection, b"HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1:1/<script>\r\n\r\n")


def noise(server, connection):
    server.send(connection, os.urandom(4000))


def markup(server, connection):
    server.send(connection, HEAD + GOOD.encode())


def liar(server, connection):
    server.send(connection, HEAD + GOOD.replace('"needs": 0', '"needs": 9999999999').encode())


def others(page):
    return {one["name"]: one for one in page.json("/api/others")["others"]}


def at(port):
    return f"http://127.0.0.1:{port}/"


def test_a_page_says_in_a_line_how_its_instance_is(scene):
    daemon = house(scene, "A", item("room", "/28.A0B1C2000001/temperature", LimitH=raw("20")),
                   item("gone", "/28.0102030405FF/temperature"), item("relays", "/29.A0B1C2000004/PIO.BYTE", "byte"))
    page = Page(scene, daemon)
    until(lambda: page.json("/api/summary")["needs"] == 2, 20, lambda: page.json("/api/summary"))
    summary = page.json("/api/summary")
    assert summary["live"] and summary["instance"] == "A" and summary["host"] == socket.gethostname()
    assert (summary["signals"], summary["not_good"], summary["alarms"]) == (3, 1, 1)
    assert (summary["first"], summary["alarm"]) == ("room", "! high")
    assert 0 <= summary["up"] < 300
    assert scene.owsctl(daemon, "alarms", "ack", "room").returncode == 0
    until(lambda: page.json("/api/summary")["alarms"] == 0, 20, lambda: page.json("/api/summary"))
    assert page.json("/api/summary")["needs"] == 1 and page.json("/api/summary")["first"] is None
    daemon.kill()
    until(lambda: not page.json("/api/summary")["live"], 20, lambda: page.json("/api/summary"))
    assert page.json("/api/summary")["up"] is None


def test_a_page_lists_two_others_and_says_which_has_stopped(scene):
    second, third = house(scene, "B"), house(scene, "C")
    other, socketed = Page(scene, second), Page(scene, third)
    first = house(scene, "A", Others=f"boiler {at(other.port)}, attic {socketed.socket} https://attic.example/owsd/")
    page = Page(scene, first)
    assert page.json("/api/info")["others"] == 2
    until(lambda: all(one["answers"] for one in others(page).values()), 20, lambda: others(page))
    got = others(page)
    assert got["boiler"]["page"] == at(other.port) and got["attic"]["page"] == "https://attic.example/owsd/"
    assert [got[n]["summary"]["instance"] for n in ("boiler", "attic")] == ["B", "C"]
    assert got["boiler"]["summary"]["signals"] == 2 and got["boiler"]["age"] < 13 and got["boiler"]["why"] is None
    other.program.freeze()
    try:
        until(lambda: others(page)["boiler"]["answers"] is False, 20, lambda: others(page))
        stopped = others(page)["boiler"]
        assert stopped["summary"] is None and stopped["age"] is None and stopped["why"] == "it does not answer in time"
        assert stopped["since"] < 30, "since it answered last"
        assert others(page)["attic"]["answers"], "the other one is as it was"
    finally:
        other.program.thaw()
    until(lambda: others(page)["boiler"]["answers"], 20, lambda: others(page))
    assert others(page)["boiler"]["since"] < 13


def test_servers_that_are_none_cost_little_and_say_nothing_of_their_own(scene):
    acts = (endless, slow, silent, redirect, noise, liar, markup)
    servers = {act.__name__: Server(act) for act in acts}
    gone = free_port()
    listed = [f"{name} {at(server.port)}" for name, server in servers.items()]
    first = house(scene, "A", Others=", ".join([*listed, f"gone {at(gone)}"]))
    page = Page(scene, first)
    until(lambda: all(one["answers"] is not None for one in others(page).values()), 20, lambda: others(page))
    got = others(page)
    assert [name for name, one in got.items() if one["answers"]] == ["markup"], got
    assert got["markup"]["summary"]["host"] == "<b>pi</b>", "a text stays a text"
    whys = {name: one["why"] for name, one in got.items()}
    assert whys["endless"] == "its answer is longer than 16 KiB", whys
    assert whys["slow"] == whys["silent"] == "it does not answer in time", whys
    assert "leads elsewhere" in whys["redirect"] and "HTTP" in whys["noise"], whys
    assert whys["liar"] == "its answer is no summary of an owsd-web" and "refused" in whys["gone"], whys
    assert servers["endless"].sent < 8 << 20, "the connection was ended"
    request = servers["markup"].asked[0]
    assert request.startswith("GET /api/summary HTTP/1.0\r\n") and f"Host: 127.0.0.1:{servers['markup'].port}\r\n" in request
    for name, server in servers.items():
        assert len(server.asked) == 1, (name, server.asked)
    assert page.values()["room"] == 21.5, "the page itself works"


def test_a_list_that_is_another_after_a_reload_is_followed(scene):
    server = Server(markup)
    first = house(scene, "A")
    page = Page(scene, first)
    assert page.json("/api/info")["others"] == 0 and others(page) == {}
    for names in (["pi"], ["pi", "pj"], []):
        listed = ", ".join(f"{name} {at(server.port)}" for name in names)
        first.config.write_text(text(scene, **({"Others": listed} if names else {})))
        assert scene.owsctl(first, "reload").returncode == 0
        until(lambda: list(others(page)) == names, 20, lambda: others(page))
        until(lambda: all(one["answers"] for one in others(page).values()), 20, lambda: others(page))


def test_the_check_names_what_is_wrong(scene):
    config = scene.file("wrong.rio", text(scene, Others="boiler https://pi2/, attic pi3"))
    got = scene.owsd_once("-c", config, "--check")
    assert got.returncode and "ssh -L" in got.stderr and 'Others "attic pi3": expected http://' in got.stderr, got


def test_the_page_shows_the_machines_and_a_link_to_each(scene):
    owsdtest.need(owsdtest.BUILD / "owsd-web")
    with browser.open_one(scene) as shown:
        second = house(scene, "B", item("room", "/28.A0B1C2000001/temperature", LimitH=raw("20")))
        other = serve(scene, second)
        hostile = Server(markup)
        first = scene.owsd(owsdtest.rio(f"sim:{scene.path / 'house.sim'}", [
            item("room", "/28.A0B1C2000001/temperature")], Period=0.05, Timeout=3,
            Web=raw(f'{{ Others "boiler {other.address}, pi {at(hostile.port)}, gone {at(free_port())}" }}')),
            name="A")
        until(lambda: scene.get(first, "room") == "21.5", 15, "room is good")
        web = serve(scene, first)
        shown.go(web.address)
        shows(shown, "#machines", "A", "the one signal is good", "boiler", "high", "pi", "all 3 good",
              "gone", "no answer since", "refused")
        assert "<" not in text_of(shown, "#machines")
        shown.run(axe())
        for scheme, width in (("light", 1280), ("dark", 360)):
            shown.scheme(scheme)
            shown.size(width, 800)
            assert shown.run("return axe.run(document).then((r) => r.violations.map((v) => v.id))") == []
            assert shown.run("return document.documentElement.scrollWidth") == width
        shown.size(1280, 800)
        view(shown, "wire")
        shows(shown, "#machines", "boiler")  # above each view
        web.freeze()
        try:
            shown.until("return document.querySelectorAll('#machines .edge-unknown').length === 4",
                        "nothing is known", seconds=40)
        finally:
            web.thaw()
        shows(shown, "#machines", "all 3 good")
        assert not shown.complaints()
        shown.click("#machines a")
        shown.until("return location.href === arguments[0]", "the other page", other.address)


if __name__ == "__main__":
    owsdtest.main()
