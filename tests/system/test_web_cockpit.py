#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page within Cockpit: the genuine cockpit-ws and its bridge, a browser, and owsd-web at its
socket alone. What make install puts below share/cockpit is what is shown."""

import contextlib
import getpass
import json
import os
import shutil
import subprocess
import time
import urllib.error
import urllib.request

import browser
import owsdtest
import webhouse
from owsdtest import BUILD, SOURCE, place, skip, until

WS = "/usr/lib/cockpit/cockpit-ws"


def package(scene):
    """The files as they are installed, below share; they look for sockets where this test has them."""
    root = scene.path / "root"
    kept = [word for name in ("cc", "ld") for word in ("-o", f"{BUILD}/with/{name}")]
    env = {k: v for k, v in os.environ.items() if not k.startswith(("MAKE", "MFLAGS"))}
    subprocess.run(["make", "-s", *kept, "-C", SOURCE, "--no-print-directory", f"B={BUILD}",
                    f"DESTDIR={root}", "PREFIX=/usr", "install"], check=True, env=env,
                   stdout=subprocess.DEVNULL, timeout=4 * owsdtest.PATIENCE)
    way = root / "usr/share/cockpit/owsd/cockpit.js"
    text = way.read_text()
    assert text.count('"/run/owsd"') == 1, "the directory of the sockets"
    way.write_text(text.replace('"/run/owsd"', f'"{place()}"'))
    return root / "usr/share"


class Cockpit:
    """cockpit-ws with the session of the user of this test, who needs no login."""

    def __init__(self, scene, *, prefix=()):
        bridge = shutil.which("cockpit-bridge")
        if not os.path.exists(WS) or not bridge:
            skip("cockpit-ws and cockpit-bridge are not installed")
        self.port = owsdtest.free_port()
        self.address = f"http://127.0.0.1:{self.port}/cockpit/@localhost/owsd/"
        self.program = scene.start(
            [*prefix, WS, "--no-tls", "--address=127.0.0.1", f"--port={self.port}",
             f"--local-session={bridge}"],
            # the bridge starts a message bus and a key agent where there are none, and leaves them
            {"XDG_DATA_DIRS": f"{package(scene)}:/usr/share", "HOME": str(scene.path),
             "DBUS_SESSION_BUS_ADDRESS": "unix:path=/nonexistent",
             "SSH_AUTH_SOCK": "/nonexistent"})
        until(self.answers, 20, self.program.log)

    def answers(self):
        assert self.program.running(), self.program.log()
        with contextlib.suppress(urllib.error.URLError, ConnectionError):
            return urllib.request.urlopen(self.address + "index.html", timeout=5).status == 200


def start_web(scene, daemon):
    """owsd-web at its socket, and nowhere else."""
    owsdtest.need(BUILD / "owsd-web")
    web = scene.start([BUILD / "owsd-web", "-n", daemon.name, "-c", daemon.config])
    until(lambda: "the page is at the socket" in web.log(), 20, web.log)
    return web


@contextlib.contextmanager
def shown(scene, write=True):
    """owsd, owsd-web, Cockpit, and a browser that shows the page in it."""
    with browser.open_one(scene) as page:
        cockpit = Cockpit(scene)
        daemon = webhouse.house(scene, write=write)
        until(lambda: scene.get(daemon, "room") == "21.5", 15, "room is good")
        web = start_web(scene, daemon)
        page.go(cockpit.address + "index.html")
        page.until("return [...document.querySelectorAll('#live tbody .name')].some((one) => "
                   "one.textContent === 'room')", "the rows")
        yield daemon, web, page, cockpit


def cell(page, name, key="value"):
    return page.run(webhouse.CELLS).get(name, {}).get(key)


def test_the_page_in_cockpit_shows_values_and_sets_outputs(scene):
    with shown(scene) as (daemon, _, page, cockpit):
        until(lambda: cell(page, "room") == "21.5", 20, lambda: page.run(webhouse.CELLS))
        assert cell(page, "attic", "state") == "bad" and cell(page, "attic") == ""
        before = cell(page, "boiler")
        until(lambda: cell(page, "boiler") != before, 20, "values come as they change")
        page.click("[role=switch][aria-label=light][aria-checked=false]:enabled")
        page.click("dialog button.primary")
        until(lambda: scene.get(daemon, "light") == "1", 20, "the switch has commanded")
        page.find("[role=switch][aria-label=light][aria-checked=true]")
        entry = json.loads(scene.owsctl(daemon, "--json", "journal").stdout)[-1]
        assert entry["by"]["person"] == getpass.getuser(), entry
        for view in webhouse.VIEWS:
            webhouse.view(page, view)
        webhouse.shows(page, "#about", daemon.name)
        assert page.complaints() == []
        answer = urllib.request.urlopen(cockpit.address + "index.html", timeout=owsdtest.PATIENCE)
        policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "unsafe" not in policy, policy


def test_a_refusal_is_shown_in_the_words_of_owsd_web(scene):
    with shown(scene, write=False) as (_, _, page, _):
        webhouse.shows(page, "#read-only", "switched off")
        said = page.run("const {post} = await import('./api.js');"
                        "return post('set', {name: 'light', value: true})"
                        ".then(() => 'set', (error) => [error.status, error.message])")
        assert said[0] == 403 and "Write on" in said[1], said


def test_events_go_on_in_cockpit_after_owsd_web_was_away(scene):
    with shown(scene) as (daemon, web, page, _):
        page.run("""
            const {way} = await import("./way.js");
            window.kept = document.querySelector("#live tbody .row");
            window.seen = [];
            way.events("api/events", ["found", "values"], {failed() {},
                opened() { window.seen.push("opened"); },
                event(type) { window.seen.push(type); }});""")
        page.until("return window.seen.includes('values')", "values of another stream")
        assert web.stop() == 0
        webhouse.shows(page, "#banner", "All values are unknown")
        assert webhouse.all_unknown(page)
        assert scene.owsctl(daemon, "set", "-w", "20", "others", "7").returncode == 0
        start_web(scene, daemon)
        until(lambda: cell(page, "others") == "7", 20, lambda: page.run(webhouse.CELLS))
        assert scene.owsctl(daemon, "set", "-w", "20", "others", "8").returncode == 0
        until(lambda: cell(page, "others") == "8", 20, lambda: page.run(webhouse.CELLS))
        assert page.run("return window.kept === document.querySelector('#live tbody .row')"), \
            "the page was not loaded anew"
        # what was missed came without a new beginning, as the last id was sent along
        seen = page.until("const again = window.seen.indexOf('opened', 1);"
                          "return again > 0 && window.seen.length > again + 1 && window.seen",
                          lambda: page.run("return window.seen"))
        assert seen.count("found") == 1 and seen[seen.index("opened", 1) + 1] == "values", seen


def test_the_page_in_cockpit_does_not_trust_the_stream_of_an_owsd_web_that_was_killed(scene):
    with shown(scene) as (daemon, web, page, _):
        until(lambda: cell(page, "others") == "0", 20, lambda: page.run(webhouse.CELLS))
        web.kill()
        start_web(scene, daemon)
        begun = time.monotonic()
        assert scene.owsctl(daemon, "set", "-w", "20", "others", "7").returncode == 0
        until(lambda: cell(page, "others") == "7", 20, lambda: page.run(webhouse.CELLS))
        # the bridge of Debian 12 reports no end of that stream; another process answers, though
        assert time.monotonic() - begun < owsdtest.patience(30), "it waited until the stream was silent for long"


def test_one_of_several_instances_is_chosen_in_cockpit(scene):
    with shown(scene) as (daemon, _, page, _):
        other = webhouse.house(scene, room="18")
        until(lambda: scene.get(other, "room") == "18", 15, "the other room is good")
        start_web(scene, other)
        page.run("location.reload()")
        page.find("#instance select")
        names = page.run("return [...document.querySelectorAll('#instance option')]"
                         ".map((one) => [one.value, one.selected])")
        assert names == sorted([[daemon.name, daemon.name < other.name],
                                [other.name, other.name < daemon.name]]), names
        for wanted, value in ((other, "18.0"), (daemon, "21.5"), (other, "18.0")):
            page.run("const s = document.querySelector('#instance select'); s.value = arguments[0];"
                     "s.dispatchEvent(new Event('change'))", wanted.name)
            page.until("return document.querySelector('#instance select')?.value === arguments[0]",
                       "the choice", wanted.name)
            until(lambda: cell(page, "room") == value, 20, lambda: page.run(webhouse.CELLS))


def test_without_a_socket_the_page_in_cockpit_says_what_to_do(scene):
    with browser.open_one(scene) as page:
        cockpit = Cockpit(scene)
        page.go(cockpit.address + "index.html")
        webhouse.shows(page, "#banner", "there is no socket", "systemctl enable --now owsd-web@")


def test_who_may_not_open_the_socket_is_told_which_group_may(scene):
    if os.geteuid() != 0:
        skip("only root can be another user")
    with browser.open_one(scene) as page:
        daemon = webhouse.house(scene)
        start_web(scene, daemon)
        scene.path.chmod(0o755)
        place().parent.chmod(0o755)
        cockpit = Cockpit(scene, prefix=["setpriv", "--reuid=65534", "--regid=65534",
                                         "--clear-groups"])
        page.go(cockpit.address + "index.html")
        webhouse.shows(page, "#banner", "only members of the group owsd may open", f"{daemon.name}.web")


if __name__ == "__main__":
    owsdtest.main()
