#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Many pages of owsd-web in one browser, over HTTP/1.1: each commands while the others are open. A
page that is hidden, frozen or kept behind another holds no connection, and has true values when it
comes back."""

import subprocess
import time

import owsdtest
from owsdtest import until
from webhouse import CELLS, plant, shows

TABS = 8  # a browser has six connections to one server
STALE_S = 4  # so long after a page is hidden its values are no longer believed, and a little more
PUMP = "[role=switch][aria-label=pump]"
# What the page says of the room in the first frame after it is shown again, and then
WITNESS = """window.seen = [];
const room = () => [...document.querySelectorAll("#live tbody .row")].find((row) =>
    row.querySelector(".name").textContent === "room")?.querySelector(".number").textContent;
const note = () => seen.at(-1) !== room() && seen.push(room());
let frames = 0;
const back = () => {
    seen.length = 0;
    requestAnimationFrame(function watch() {
        note();
        if (frames++ < 1000)
            requestAnimationFrame(watch);
    });
};
document.addEventListener("visibilitychange", () => !document.hidden && back());
window.addEventListener("pageshow", (event) => event.persisted && (window.kept = true, back()));"""


def streams(web):
    """Connections that are open to owsd-web."""
    got = subprocess.run(["ss", "-Htn", "state", "established", f"( sport = :{web.port} )"],
                         check=True, capture_output=True, text=True)
    return len(got.stdout.splitlines())


def has_value(page, name, value):
    until(lambda: page.run(CELLS).get(name, {}).get("value") == value, 20,
          lambda: page.run(CELLS).get(name))


def test_eight_tabs_of_one_browser_command_one_after_the_other(scene):
    with plant(scene, write=True) as (daemon, web, page):
        scene.owsctl(daemon, "set", "pump", "0")
        tabs = [page.tab()]
        for _ in range(TABS - 1):
            tabs.append(page.tab(web.address))
            page.until("return document.querySelectorAll('#live tbody .row').length === 9", "the rows")
        for number, tab in enumerate(tabs + tabs[::-1], 1):
            page.show(tab)
            page.click(f"{PUMP}[aria-checked={'true' if number % 2 == 0 else 'false'}]:enabled")
            until(lambda: scene.get(daemon, "pump") == str(number % 2), 5,
                  lambda: f"command {number}: {page.run(CELLS)['pump']}")


def test_a_hidden_page_holds_no_connection_and_is_right_when_it_is_shown(scene):
    with plant(scene, write=True) as (daemon, web, page):
        scene.owsctl(daemon, "set", "pump", "0")
        has_value(page, "pump", "off")
        page.run(WITNESS.replace('"room"', '"pump"'))
        first = page.tab()
        assert streams(web) > 0
        page.tab("about:blank")
        until(lambda: streams(web) == 0, 20, "no connection is left")
        scene.owsctl(daemon, "set", "pump", "1")
        time.sleep(STALE_S)  # what is shown has become too old to be believed
        page.show(first)
        has_value(page, "pump", "on")
        until(lambda: page.run("return window.seen") in (["unknown", "on"], ["on"]), 10,
              lambda: page.run("return window.seen"))
        until(lambda: streams(web) == 1, 20, "one stream again")
        # and what comes then
        scene.owsctl(daemon, "set", "pump", "0")
        has_value(page, "pump", "off")
        assert not page.complaints()


def test_a_command_is_carried_out_though_the_page_is_hidden_at_once(scene):
    with plant(scene, write=True) as (daemon, _, page):
        scene.owsctl(daemon, "set", "pump", "0")
        first, other = page.tab(), page.tab("about:blank")
        for want in ("1", "0", "1"):
            page.show(first)
            page.click(f"{PUMP}[aria-checked={'false' if want == '1' else 'true'}]:enabled")
            page.show(other)
            until(lambda: scene.get(daemon, "pump") == want, 10, "the command is carried out")
        page.show(first)
        has_value(page, "pump", "on")
        shows(page, "#live", "on: taken")


def test_a_page_that_is_shown_at_once_again_never_calls_its_values_unknown(scene):
    with plant(scene) as (_, web, page):
        has_value(page, "room", "21.5")
        page.run(WITNESS)
        first, other = page.tab(), page.tab("about:blank")
        for _ in range(3):
            page.show(other)
            page.show(first)
            assert page.run("return window.seen.every((one) => one === '21.5')"), \
                page.run("return window.seen")
        until(lambda: streams(web) == 1, 20, "one stream")


def test_pages_that_a_browser_keeps_for_the_way_back_hold_no_connection(scene):
    with plant(scene, write=True) as (daemon, web, page):
        scene.owsctl(daemon, "set", "pump", "0")
        for _ in range(TABS):
            page.go("data:text/html,another site")
            page.go(web.address)
            has_value(page, "pump", "off")
        page.run(WITNESS.replace('"room"', '"pump"'))
        page.go("data:text/html,another site")
        until(lambda: streams(web) == 0, 20, "no connection is left")
        scene.owsctl(daemon, "set", "pump", "1")
        time.sleep(STALE_S)  # what is shown has become too old to be believed
        page.ask("POST", f"{page.base}/back", {})
        assert page.run("return window.kept"), "the browser kept the page"
        has_value(page, "pump", "on")
        until(lambda: page.run("return window.seen") in (["unknown", "on"], ["on"]), 10,
              lambda: page.run("return window.seen"))
        page.click(f"{PUMP}[aria-checked=true]:enabled")
        until(lambda: scene.get(daemon, "pump") == "0", 10, "it commands")
        until(lambda: streams(web) == 1, 20, "one stream")


def test_a_frozen_page_holds_no_connection_and_is_right_when_it_goes_on(scene):
    with plant(scene, write=True) as (daemon, web, page):
        scene.owsctl(daemon, "set", "pump", "0")
        has_value(page, "pump", "off")
        page.devtools("Page.setWebLifecycleState", state="frozen")
        until(lambda: streams(web) == 0, 20, "no connection is left")
        scene.owsctl(daemon, "set", "pump", "1")
        page.devtools("Page.setWebLifecycleState", state="active")
        first = page.tab()
        page.tab("about:blank")
        page.show(first)
        has_value(page, "pump", "on")
        until(lambda: streams(web) == 1, 20, "one stream again")


if __name__ == "__main__":
    owsdtest.main()
