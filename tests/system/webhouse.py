# SPDX-License-Identifier: MIT
"""A simulated house with owsd, owsd-web, and a browser that shows the page.

    with webhouse.plant(scene) as (daemon, web, page):
        webhouse.view(page, "alarms")
        webhouse.shows(page, "#alarms table", "boiler", "high")
"""

import contextlib
import json
import urllib.error
import urllib.request

import browser
import owsdtest
from owsdtest import BUILD, raw, until

VIEWS = ["live", "alarms", "trends", "wire", "config", "about"]
BOILER, ROOM, RELAY = "28.B10000000000", "28.A10000000000", "29.000000000001"
GONE = "28.0102030405FF"
CELLS = """return Object.fromEntries([...document.querySelectorAll("#live tbody .row")].map((row) =>
    [row.querySelector(".name").textContent, {
        value: row.querySelector(".number").textContent,
        unit: row.querySelector(".unit").hidden ? "" : row.querySelector(".unit").textContent,
        quality: row.querySelector(".words").textContent,
        alarm: row.querySelector(".alarm").hidden ? "" : row.querySelector(".alarm").textContent,
        state: [...row.classList].find((name) => name.startsWith("is-")
            && name !== "is-late").slice(3),
        edge: [...row.classList].find((name) => name.startsWith("edge-")).slice(5),
        age: row.querySelector(".c-age").textContent,
    }]))"""


SHOWN = """return [...document.querySelectorAll("#live tbody .row")].filter((row) =>
    row.checkVisibility()).map((row) => row.querySelector(".name").textContent)"""


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


def house(scene, name=None, write=False, recorder=None, room="21.5", also=""):
    scene.file("house.sim", f"chip DS2482-100 0x18\n"
               f"DS18B20 {BOILER} as boiler temperature sine 60 6 2m\n"
               f"DS18B20 {ROOM} temperature {room}\nDS2408 {RELAY}\n"
               f"button unplug unplug {ROOM}\n{also}")
    return scene.owsd(owsdtest.rio("sim:house.sim", [
        item("room", f"/{ROOM}/temperature12", Description="Living room, by the window"),
        item("boiler", f"/{BOILER}/temperature12", LimitH=raw("40"), Description="Flow"),
        item("attic", f"/{GONE}/temperature12"),
        item("light", f"/{RELAY}/PIO.0", "bool", "output", InitValue="0", Confirm=raw("on")),
        item("pump", f"/{RELAY}/PIO.1", "bool", "output"),
        item("others", f"/{RELAY}/PIO.BYTE", "byte", "output", Readable=raw("on"), Max=200,
             Min=0),
        item("door", f"/{RELAY}/sensed.4", "bool"),
        item("kind", f"/{ROOM}/type", "string", PerFactor=20),
        item("fault_unplug", "/simulator/unplug", "bool", "output", Readable=raw("on"),
             InitValue="0", Description="Simulation: pulls the thermometer of the room off"),
    ], Period=0.05, Timeout=3, Web=raw(f"{{ Write {'on' if write else 'off'} }}"),
        **({"Recorder": raw(f'{{ Flush 1 Directory "{recorder}" }}')} if recorder else {})),
        name=name)


@contextlib.contextmanager
def plant(scene, write=False, browser=browser):
    """owsd, owsd-web, a page that shows the signals; browser: that module, or firefox."""
    with browser.open_one(scene) as page:
        daemon = house(scene, write=write)
        until(lambda: scene.get(daemon, "room") == "21.5", 15, "room is good")
        web = serve(scene, daemon)
        page.go(web.address)
        page.until("return document.querySelectorAll('#live tbody .row').length === 9", "the rows")
        yield daemon, web, page


def serve(scene, daemon, port=None, config=None):
    owsdtest.need(BUILD / "owsd-web")
    port = port or owsdtest.free_port()
    web = scene.start([BUILD / "owsd-web", "-n", daemon.name, "-c", config or daemon.config,
                       "-l", f"127.0.0.1:{port}"])
    web.address, web.port = f"http://127.0.0.1:{port}/", port
    until(lambda: answers(web), 20, web.log)
    return web


def configured(scene, daemon):
    """owsd-web, and owsd-writer for it."""
    program = owsdtest.with_sim(BUILD / "owsd-writer", daemon.config, cwd=scene.path)
    owsdtest.need(program)
    writer = scene.start([program, "-n", daemon.name, "-c", daemon.config])
    until(lambda: owsdtest.segment(daemon.name, "config").exists() or not writer.running(), 20,
          writer.log)
    return serve(scene, daemon)


def answers(web):
    assert web.running(), web.log()
    try:
        return urllib.request.urlopen(web.address + "api/info", timeout=5).status == 200
    except (OSError, urllib.error.URLError):
        return False


def listed(scene, daemon, *names):
    rows = json.loads(scene.owsctl(daemon, "list", "--json", *names).stdout)
    return {row["name"]: row for row in rows}


def view(page, name):
    # on a phone some are behind "More"
    if not page.run("return document.querySelector(arguments[0]).checkVisibility()",
                    f"nav a[href='#{name}']"):
        page.click("#more")
    page.click(f"nav a[href='#{name}']")
    page.until("return document.querySelector('main > section:not([hidden])').id === arguments[0]",
               name, name)


def text_of(page, selector):
    return page.run("return document.querySelector(arguments[0]).innerText", selector)


def shows(page, selector, *words):
    """Wait until the text of an element has all these words."""
    page.until("const t = document.querySelector(arguments[0])?.innerText ?? '';"
               "return arguments[1].every((word) => t.includes(word))",
               lambda: f"{words} in {text_of(page, selector)}", selector, words)


def all_unknown(page):
    return all(cell["value"] == "unknown" and cell["state"] == "unknown"
               for cell in page.run(CELLS).values())
