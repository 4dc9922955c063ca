#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page of owsd-web in Firefox, as it is in Chromium: each view, also at the size of a phone, the
loss of owsd, a command."""

import firefox
import owsdtest
from owsdtest import until
from webhouse import BOILER, CELLS, ROOM, VIEWS, all_unknown, house, listed, plant, shows, view


def test_live_shows_what_owsctl_lists_and_nothing_after_a_loss_until_owsd_is_back(scene):
    with plant(scene, browser=firefox) as (daemon, _, page):
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 20, lambda: page.run(CELLS))
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30,
              lambda: page.run(CELLS)["attic"])
        cells, rows = page.run(CELLS), listed(scene, daemon)
        assert set(cells) == set(rows), cells
        for name, row in rows.items():
            assert (cells[name]["state"] == "good") == row["good"], (cells[name], row)
        assert cells["boiler"]["alarm"].startswith("high"), cells["boiler"]
        assert not page.complaints()
        daemon.kill()
        until(lambda: all_unknown(page), 20, lambda: page.run(CELLS))
        shows(page, "#banner", "unknown since")
        house(scene, daemon.name)
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 30, lambda: page.run(CELLS))


def test_each_view_shows_what_it_is_for_also_on_a_phone(scene):
    words = {"live": ["2 of 9 need you", "room", "21.5", "device absent"],
             "alarms": ["boiler", "high", "waits for you"], "trends": ["Following", "room"],
             "wire": [ROOM, BOILER, "device absent", "Do:"], "config": ["room", "boiler"],
             "about": ["Version", "Generation"]}
    with plant(scene, browser=firefox) as (_, _, page):
        for width in (1280, 360):
            page.size(width, 740)
            for name in VIEWS:
                view(page, name)
                shows(page, f"#{name}", *words[name])
                page.until("return document.documentElement.scrollWidth <= arguments[0]",
                           f"{name} fits {width} pixels", width)
        view(page, "trends")
        page.find("#trends .chart canvas")
        shows(page, "#trends .legend", "room", "21.5")
        assert not page.complaints()


def test_a_switch_commands(scene):
    with plant(scene, write=True, browser=firefox) as (daemon, _, page):
        page.click("[role=switch][aria-label=light][aria-checked=false]:enabled")
        shows(page, "dialog", "Set light on?")
        page.click("dialog button.primary")
        shows(page, "#live", "on: taken")
        assert scene.get(daemon, "light") == "1"
        view(page, "alarms")
        page.click("[data-action='acknowledge boiler']")
        shows(page, "#alarms .standing", "boiler", "acknowledged")
        assert not page.complaints()


def test_an_error_of_a_script_is_a_complaint(scene):
    with plant(scene, browser=firefox) as (_, _, page):
        page.run("const s = document.createElement('script'); s.src = 'nothing.js';"
                 "document.body.append(s)")
        until(page.complaints, 20, "the script that is not there")


if __name__ == "__main__":
    owsdtest.main()
