#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page of owsd-web in headless Chromium, on a simulated house: each view shows what owsctl
does, the loss of owsd makes values unknown, commands are confirmed. WRITE=1 writes the pictures of
the docs."""

import json
import os
import shutil
import time
import urllib.error
import urllib.request

import browser
import owsdtest
from owsdtest import BUILD, SOURCE, until
from webhouse import (BOILER, CELLS, GONE, RELAY, ROOM, SHOWN, all_unknown, house, item, listed,
                      plant, serve, shows, text_of, view)


# --- Views ----------------------------------------------------------------------------------


def test_live_shows_what_owsctl_lists(scene):
    with plant(scene) as (daemon, _, page):
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 20, "room has its value")
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30,
              lambda: page.run(CELLS)["attic"])
        cells, rows = page.run(CELLS), listed(scene, daemon)
        assert list(cells) != [] and set(cells) == set(rows), cells
        for name, row in rows.items():
            cell = cells[name]
            assert (cell["state"] == "good") == row["good"], (cell, row)
            assert cell["unit"] == ((row["unit"] or "") if row["good"] else ""), (cell, row)
            if not row["good"]:
                assert cell["value"] == "" and cell["quality"], cell
            if row["good"]:
                assert cell["quality"] == "", cell  # what is good has no words
        assert cells["kind"]["value"] == "DS18B20" and cells["door"]["value"] in ("on", "off")
        assert "high" in cells["boiler"]["alarm"], cells["boiler"]
        assert not page.complaints()


def test_a_quality_that_is_not_good_is_explained_with_its_remedy(scene):
    with plant(scene) as (_, _, page):
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30, "absent")
        page.click("#live .row.is-bad .words")
        shows(page, "#live .row.is-bad .c-detail", "Remedy:", "pull-up", GONE)
        assert not page.complaints()


def test_the_details_of_a_row_have_the_whole_description(scene):
    with plant(scene) as (_, _, page):
        page.run("[...document.querySelectorAll('#live tbody .row .name')].find((one) =>"
                 "one.textContent === 'room').click()")
        shows(page, "#live .c-detail", "Living room, by the window")


def test_the_search_and_the_order_stand_in_the_address(scene):
    with plant(scene) as (_, web, page):
        page.type("#search", "relay 29.0")
        until(lambda: page.run(SHOWN) == [], 10, "no signal matches")
        page.type("#search", "29.0 output")
        until(lambda: page.run(SHOWN) == ["light", "pump", "others"], 10,
              lambda: page.run(SHOWN))
        page.click(".shows [value=list]")
        page.click("#live .heads .c-name button")
        page.find("#live .heads .c-name[aria-sort=ascending]")
        address = page.run("return location.href")
        assert "show=list" in address and "order=name" in address, address
        page.go("about:blank")
        page.go(address)
        until(lambda: page.run(SHOWN) == ["light", "others", "pump"], 20,
              lambda: page.run(SHOWN))
        assert address.startswith(web.address) and not page.complaints()


TILES = """return [...document.querySelectorAll("#live .tile .name")].map((one) => one.textContent)"""


def test_the_first_line_names_what_needs_somebody_and_a_click_shows_it(scene):
    with plant(scene) as (_, _, page):
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30, "absent")
        shows(page, "#sentence", "of 9 need you")
        shows(page, "#live .needs", "boiler", "high", "limit 40", "attic", "device absent")
        page.click("#live .needs a[href*='signal=attic']")
        shows(page, "#live .row.is-bad .c-detail", "Remedy:", GONE)
        assert page.run("return document.activeElement.textContent") == "attic"
        assert page.run(CELLS)["attic"]["edge"] == "bad" and page.run(CELLS)["room"]["edge"] == "none"
        assert not page.complaints()


def test_tiles_are_chosen_by_the_star_moved_by_keys_and_kept_in_the_address(scene):
    with plant(scene) as (_, _, page):
        first = page.run(TILES)
        assert len(first) == 6 and "door" not in first, first
        page.type("#search", "door")
        until(lambda: page.run(SHOWN) == ["door"], 10, lambda: page.run(SHOWN))
        page.click("#live .row .name")
        page.click("#live .c-detail .star")
        until(lambda: page.run(TILES) == [*first, "door"], 10, lambda: page.run(TILES))
        page.run("[...document.querySelectorAll('#live .tile .name')].at(-1).focus()")
        page.chord("alt", "left")
        moved = [*first[:-1], "door", first[-1]]
        until(lambda: page.run(TILES) == moved, 10, lambda: page.run(TILES))
        assert page.run("return document.activeElement.textContent") == "door", "it keeps the focus"
        page.run("document.querySelector('#search').value = ''; document.querySelector('#search')"
                 ".dispatchEvent(new Event('input', {bubbles: true}))")
        until(lambda: len(page.run(SHOWN)) > 1, 10, lambda: page.run(SHOWN))
        assert page.run("return document.activeElement.textContent") == "door", "and in a filter"
        address = page.run("return location.href")
        assert f"tiles={','.join(moved)}" in address, address
        page.go("about:blank")
        page.go(address)
        until(lambda: page.run(TILES) == moved, 20, lambda: page.run(TILES))
        assert not page.complaints()


def test_a_list_is_filtered_by_a_chip_and_those_without_a_value_are_last(scene):
    with plant(scene) as (_, _, page):
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30, "absent")
        page.click(".shows [value=list]")  # all have one unit: the greatest first
        page.find("#live .heads .c-value[aria-sort=descending]")
        names = page.run(SHOWN)
        assert names.index("boiler") < names.index("room") < names.index("attic"), names
        page.run("[...document.querySelectorAll('#live .chips button')].find((one) =>"
                 "one.textContent.startsWith('Not good')).click()")
        until(lambda: "room" not in page.run(SHOWN) and "attic" in page.run(SHOWN), 10,
              lambda: page.run(SHOWN))
        assert "only=bad" in page.run("return location.hash")
        page.type("#search", "atic")
        shows(page, "#live .empty", "No signal matches", "Show all 9")
        page.click("#live .empty button")
        until(lambda: len(page.run(SHOWN)) == 9, 10, lambda: page.run(SHOWN))
        assert not page.complaints()


def test_a_list_is_put_in_order_but_not_below_the_focus(scene):
    with plant(scene) as (daemon, _, page):
        page.click(".shows [value=list]")
        page.run("document.querySelector('#live tbody .name').focus()")
        last = "return document.querySelector('#live tbody .row .name').textContent"
        first = page.run(last)
        # what is greatest now, as the page knows it
        page.run("return import('./store.js').then(({store}) => { setInterval(() => {"
                 "store.find('door').value = 1000; }, 50); })")
        time.sleep(5)  # a list that nobody is in is put in order every 2 s
        assert page.run(last) == first, "somebody has the focus there"
        page.run("document.activeElement.blur()")
        until(lambda: page.run(last) == "door", 10, lambda: page.run(last))
        assert daemon.running() and not page.complaints()


def test_an_age_counts_up_while_nothing_comes(scene):
    with plant(scene) as (daemon, _, page):
        scene.owsctl(daemon, "set", "room_RE", "0")
        until(lambda: page.run(CELLS)["room"]["age"] not in ("now", "1 s", "2 s"), 20,
              lambda: page.run(CELLS)["room"])
        cell = page.run(CELLS)["room"]
        assert cell["value"] == "" and cell["quality"] == "last usable value", cell


def test_an_alarm_is_acknowledged_and_the_journal_says_by_whom(scene):
    with plant(scene, write=True) as (daemon, _, page):
        page.until("return document.title.startsWith('(1) boiler high')", "the title has it")
        page.find("#alarm-count")
        assert page.run("return document.querySelector('#icon').getAttribute('href')"
                        ) == "icon-waits.svg"
        view(page, "alarms")
        shows(page, "#h-alarms", "1 alarm waits for you")
        shows(page, "#alarms .edge-alarm", "boiler", "high", "Limit 40.0, over it by", "since")
        page.click("[data-action='acknowledge boiler']")
        shows(page, "#h-alarms", "No alarm waits for you")
        shows(page, "#alarms .standing", "boiler", "acknowledged")
        page.until("return !document.querySelector(\"[data-action='acknowledge boiler']\")",
                   "nothing is left to acknowledge")
        focus = page.run("return document.activeElement.dataset.action")
        assert focus == "shelve boiler", focus
        row, = json.loads(scene.owsctl(daemon, "alarms", "--json").stdout)
        assert row["name"] == "boiler" and row["state"] == "acknowledged", row
        shows(page, "#alarms table", "boiler", "high", "stands", "acknowledged by", "owsd-web",
              "outputs took their first value")
        page.until("return document.title === `Alarms \u00b7 ${arguments[0]}`", "the title",
                   daemon.name)
        assert not page.complaints()


def test_what_happened_is_searched_by_words_kinds_and_hours(scene):
    with plant(scene, write=True) as (daemon, _, page):
        scene.owsctl(daemon, "set", "pump", "1")
        view(page, "alarms")
        shows(page, "#alarms table", "boiler", "pump", "set on")
        focus = "return document.activeElement.type === 'search'"
        until(lambda: page.run(focus) or page.press("/"), 20, "keys, which come after the first values")
        page.press(*"pump set")
        page.until("return document.querySelectorAll('#alarms tbody tr').length === 1",
                   lambda: text_of(page, "#alarms table"))
        page.press("escape")
        shows(page, "#alarms table", "boiler")
        page.click("[data-kind=alarms]")
        page.until("return !document.querySelector('#alarms table').innerText.includes('pump')",
                   "alarms alone")
        page.click("#alarms .hours button:enabled")
        shows(page, "#alarms table", "boiler")
        page.type("#journal-search", "nobody")
        shows(page, "#alarms table", "Nothing matches.")
        assert not page.complaints()


def test_keys_choose_views_and_can_be_switched_off(scene):
    with plant(scene) as (_, _, page):
        shown = "return document.querySelector('main > section:not([hidden])').id"
        until(lambda: page.run(f"{shown} === 'alarms'") or page.press("g", "a"), 20, "keys, which come after the first values")
        page.press("?")
        shows(page, "dialog", "Keys", "Trends")
        page.click("#keys-on")
        page.click("dialog .primary")
        page.press("g", "l")
        page.press("?")
        shows(page, "dialog", "Keys")
        assert page.run(shown) == "alarms"
        assert not page.complaints()


def test_a_browser_that_was_told_so_tells_of_an_alarm(scene):
    with plant(scene, write=True) as (daemon, _, page):
        view(page, "alarms")
        page.run("window.told = []; window.Notification = class { static permission = 'granted';"
                 "static requestPermission = async () => 'granted'; constructor(title, {body}) {"
                 "told.push([title, body]); } };"
                 "navigator.serviceWorker.getRegistration = async () => undefined;")
        page.click(".tell button:first-of-type[aria-pressed=false]")
        shows(page, ".tell", "while this page is open")
        page.click("[data-action='acknowledge boiler']")
        page.until("return document.title.startsWith('Alarms')", "none waits")
        scene.owsctl(daemon, "alarms", "shelve", "boiler", "1s")
        page.until("return JSON.stringify(told) === '[[\"boiler\",\"high\"]]'",
                   lambda: page.run("return told"))
        assert not page.complaints()


def test_an_alarm_is_shelved_for_a_time_with_a_reason(scene):
    with plant(scene, write=True) as (daemon, _, page):
        view(page, "alarms")
        page.click("[data-action='shelve boiler']")
        page.type("#shelve-why", "pump is being changed")
        page.click("dialog button.primary")
        shows(page, "#alarms .standing", "shelved until", "pump is being changed")
        row, = json.loads(scene.owsctl(daemon, "alarms", "--json").stdout)
        assert row["state"] == "shelved" and row["why"] == "pump is being changed", row
        page.click("[data-action='unshelve boiler']")
        page.find("[data-action='acknowledge boiler']")
        assert not page.complaints()


def test_the_outputs_that_disturb_a_simulated_wire_are_a_group_of_their_own(scene):
    with plant(scene) as (_, _, page):
        groups = page.run("return [...document.querySelectorAll('#live .group h2')].map((one) =>"
                          "one.firstChild.textContent)")
        assert "Simulation" in groups and len(set(groups)) == len(groups), groups
        assert not [group for group in groups if BOILER in group], "a chip with one signal has no group"


def test_an_id_of_a_device_stands_in_one_line(scene):
    with plant(scene) as (_, _, page):
        view(page, "wire")
        page.find("#wire tbody th code")
        lines = page.until("return [...document.querySelectorAll('#wire tbody th code')].filter((one) =>"
                           "/^[0-9A-F]{2}[.]/.test(one.textContent)).map((one) => one.offsetHeight"
                           "/ parseFloat(getComputedStyle(one).fontSize))", "the devices")
        assert max(lines) < 2, lines


def test_a_trend_goes_on_and_a_drag_zooms(scene):
    with plant(scene) as (_, _, page):
        view(page, "trends")
        page.find("#trends .chart canvas")
        shows(page, "#trends .legend", "room", "boiler", "21.5")
        page.type(".picks input", "liv")
        shows(page, "#trends .matches", "room", "Living room")
        page.press("enter")  # what the page has chosen goes when somebody chooses
        page.until("return document.querySelectorAll('#trends .legend li').length === 1", "room alone")
        shows(page, "#trends .legend", "room", "21.5", "21.5 \u2013 21.5")
        before = page.run("return location.hash")
        page.drag("#trends .chart canvas", 0.3, 0.6)
        page.until("return new URLSearchParams(location.hash.split('?')[1]).get('until')",
                   lambda: f"another window than {before}")
        span = page.run("return new URLSearchParams(location.hash.split('?')[1]).get('span')")
        assert 150_000 < float(span) < 260_000, span  # of the plot, which names narrow
        assert not page.complaints(), page.complaints()


GESTURE = """const canvas = document.querySelector("#trends .chart canvas:last-of-type");
    const {left, top, width, height} = canvas.getBoundingClientRect();
    const at = (x, y = 0.5) => ({clientX: left + x * width, clientY: top + y * height,
        pageX: left + x * width, pageY: top + scrollY + y * height, bubbles: true});
    const mouse = (type, where, on = document) => on.dispatchEvent(new MouseEvent(type,
        {...where, shiftKey: true}));
    const touch = (type, ...all) => canvas.dispatchEvent(new TouchEvent(type, {bubbles: true,
        cancelable: true, touches: all.map((where, identifier) => new Touch({...where, identifier,
        target: canvas}))}));
    """
WINDOW = """const q = new URLSearchParams(location.hash.split("?")[1]);
    return [Number(q.get("span")), Number(q.get("until"))]"""


def test_a_trend_is_moved_with_shift_read_by_a_finger_and_widened_by_two(scene):
    with plant(scene) as (_, _, page):
        view(page, "trends")
        page.find("#trends .chart canvas")

        def moved(gesture):
            before = page.run(WINDOW)
            page.run(GESTURE + gesture)
            until(lambda: page.run(WINDOW) != before, 10, lambda: (gesture, page.run(WINDOW)))
            return page.run(WINDOW)
        now = time.time() * 1000
        span, end = moved("mouse('mousedown', at(0.4), canvas); mouse('mousemove', at(0.6));"
                          "mouse('mouseup', at(0.6))")
        assert abs(span - 600_000) < 10 and 100_000 < now - end < 160_000, (span, now - end)
        page.run(GESTURE + "for (const type of ['pointerdown', 'pointermove'])"
                 "canvas.dispatchEvent(new PointerEvent(type, {...at(0.6, 0.9), pointerType: 'touch'}))")
        shows(page, "#trends .picker", "at the cursor")  # one finger reads, and the page scrolls
        assert page.run(WINDOW) == [span, end]
        span, _ = moved("touch('touchstart', at(0.4), at(0.6)); touch('touchmove', at(0.3), at(0.7))")
        assert abs(span - 300_000) < 3_000, span
        assert not page.complaints()


def test_the_axes_of_a_trend_never_collide_and_the_plots_fill_the_window(scene):
    with plant(scene) as (_, web, page):
        page.go(web.address + "#trends?s=room&s=boiler&s=pump&s=others")
        page.find("#trends .chart canvas")
        for width in (360, 768, 1024, 1440, 2560):
            page.size(width, 900)
            for span in ("10 min", "1 d", "30 d"):
                page.run("[...document.querySelectorAll('#trends [data-span]')].find((one) =>"
                         "one.textContent === arguments[0]).click()", span)
                page.until("""const texts = (part) => [...document.querySelectorAll(part)].filter(
                    (one) => one.checkVisibility()).map((one) => one.getBoundingClientRect());
                    const free = (all, a, b) => all.every((one, n) => all.every((two, m) => n === m
                    || one[b] <= two[a] || two[b] <= one[a]));
                    const axis = texts("#trends .axis span"), charts = texts("#trends .chart");
                    return axis.length > 1 && charts.length === 3 && free(axis, "left", "right")
                    && charts.every(({top, bottom}) => free(texts("#trends .dygraph-axis-label-y")
                    .filter((one) => one.top >= top - 9 && one.bottom <= bottom + 9), "top", "bottom"))
                    && free(texts("#trends .plot:first-child .end"), "top", "bottom")""",
                           lambda: f"{width} px, {span}: marks beside each other")
            if width > 1000:
                page.until("const {bottom} = document.querySelector('#trends .trend')"
                           ".getBoundingClientRect(); return bottom > 860 && bottom <= 900",
                           f"the plots reach the lower edge at {width} px")
        assert not page.complaints()


def test_one_cursor_goes_through_all_plots_by_keys_too(scene):
    with plant(scene) as (_, web, page):
        page.go(web.address + "#trends?s=room&s=others&s=absent")
        page.find("#trends .chart canvas")
        page.until("return performance.now() > 10000", "the page has heard more than a step of the cursor")
        page.run("document.querySelector('#trends .stack').focus()")
        page.press("right")  # from now on: of before nothing is known
        shows(page, "#trends .picker", "at the cursor", "room", "21.5")
        page.until("const words = document.querySelector('#trends .stack').getAttribute("
                   "'aria-valuetext'); return /^..:..:..; room 21[.]5.*; others 0/.test(words)", "words")
        assert page.run("return document.querySelector('#trends .hair').checkVisibility()")
        for key, span in (("+", 300_000), ("+", 150_000), ("0", 300_000), ("-", 600_000)):
            page.press(key)
            page.until("return new URLSearchParams(location.hash.split('?')[1]).get('span') === "
                       "arguments[0]", f"{key}: {span}", str(span))
        page.press("escape")
        shows(page, "#trends .picker", "Figures of now")
        assert not page.complaints()


def test_a_window_that_ends_before_it_begins_is_refused_at_its_field(scene):
    with plant(scene) as (_, web, page):
        page.go(web.address + "#trends?s=room")
        page.find("#trends .chart canvas")
        before = page.run(WINDOW)[0]
        page.run("const t = document.querySelector('#trends .times'); t.blur(); t.focus()")  # all is selected
        page.press(*"10:24 - 10:20", "enter")
        page.find("#trends .times[aria-invalid=true]")
        shows(page, "#trend-told", "10:24 - 10:20", "ends before it begins")
        assert page.run(WINDOW)[0] == before
        page.run("const t = document.querySelector('#trends .times'); t.blur(); t.focus()")  # all is selected
        page.press(*"22:00 - 6:00", "enter")
        until(lambda: page.run(WINDOW)[0] == 8 * 3_600_000, 10, lambda: page.run(WINDOW))
        assert not page.complaints(), page.complaints()


def test_a_turn_of_the_wheel_is_one_step_back_and_asks_once(scene):
    with plant(scene) as (_, web, page):
        page.go(web.address + "#trends?s=room&until=1000000000000&span=600000")
        page.find("#trends .chart canvas")
        asked = ("return performance.getEntriesByType('resource').filter(({name}) =>"
                 "name.includes('api/journal?')).length")
        page.until(asked, "it has asked")
        page.run("return new Promise((done) => setTimeout(done, 500))")
        before = page.run(asked)
        page.run("const {left, top} = document.querySelector('#trends .stack').getBoundingClientRect();"
                 "for (let n = 0; n < 30; n++) document.querySelector('#trends .stack').dispatchEvent("
                 "new WheelEvent('wheel', {deltaY: 100, ctrlKey: true, clientX: left + 200,"
                 "clientY: top + 9, cancelable: true}))")
        page.run("return new Promise((done) => setTimeout(done, 1000))")
        assert page.run(asked) == before + 1, (before, page.run(asked))
        assert page.run(WINDOW)[0] > 5_000_000, page.run(WINDOW)
        page.run("document.querySelector('#trends .stack').focus()")
        page.press("0")
        until(lambda: page.run(WINDOW)[0] == 600_000, 10, lambda: page.run(WINDOW))
        assert not page.complaints(), page.complaints()


def test_without_dygraphs_a_trend_has_figures_and_says_why_there_is_no_plot(scene):
    with browser.open_one(scene) as page:
        daemon = house(scene)
        files = scene.path / "page"
        shutil.copytree(BUILD / "page", files, ignore=shutil.ignore_patterns("dygraph*"))
        config = scene.path / "figures.rio"
        config.write_text(daemon.config.read_text().replace("{ Write off", f'{{ Files "{files}" Write off'))
        web = serve(scene, daemon, config=config)
        page.go(web.address + "#trends?s=room&span=60000")
        shows(page, "#trends", "without dygraphs", "libjs-dygraphs")
        shows(page, "#trends .legend", "room", "21.5")
        assert not page.run("return document.querySelector('#trends .stack').checkVisibility()")


def test_a_trend_has_what_the_recorder_kept_and_the_time_without_owsd_is_a_gap(scene):
    kept = scene.path / "history"
    with browser.open_one(scene) as page:
        daemon = house(scene, recorder=kept)
        owsdtest.need(BUILD / "owsd-recorder")
        recorder = scene.start([BUILD / "owsd-recorder", "-n", daemon.name, "-c", daemon.config])
        until(lambda: "recording " in recorder.log(), 20, recorder.log)
        web = serve(scene, daemon)

        def last():
            now = round(time.time() * 1000)
            try:
                with urllib.request.urlopen(f"{web.address}api/trend?name=room&points=60&"
                                            f"from={now - 60000}&until={now}") as answer:
                    return json.load(answer)["last"]
            except urllib.error.HTTPError:
                return []  # nothing is written yet
        # the gap begins with the last that the recorder knows of owsd, up to 2 s before the kill
        until(lambda: last().count(21.5) > 4, 30, last)
        daemon.kill()
        until(lambda: not json.loads(urllib.request.urlopen(
            web.address + "api/info", timeout=9).read())["live"], 20, "owsd is lost")
        house(scene, daemon.name, recorder=kept)
        until(lambda: last()[-20:].count(21.5) > 2, 30, last)
        page.go(web.address + "#trends?s=room&span=60000")
        shows(page, "#trends .legend", "room", "21.5")
        page.until("return !document.querySelector('#trends [role=status]').textContent", "no complaint")
        page.until("return performance.getEntriesByType('resource').some((one) =>"
                   "one.name.includes('api/trend') && one.responseEnd)", "the past has come")
        time.sleep(1)  # it is drawn
        page.devtools("Browser.setDownloadBehavior", behavior="allow",
                      downloadPath=str(scene.path))
        page.click("#trends .csv")
        page.click("dialog .primary")
        tables = lambda: {file for file in scene.path.glob("*.csv") if file.stat().st_size}  # noqa: E731
        saved = list(until(tables, 20, "the table"))
        def rows(file):
            lines = file.read_text(encoding="utf-8-sig").splitlines()
            assert lines[0] == "time,room (\u00b0C)", lines[0]
            return [line.split(",")[1] for line in lines[1:]]
        values = rows(saved[0])
        good = [n for n, value in enumerate(values) if value]
        assert "" in values[good[0]:good[-1]], values  # the part in which owsd had ended
        assert {value for value in values if value} == {"21.5"}, values
        time.sleep(1)  # the second stands in the name of the file
        page.click("#trends .csv")
        page.click("#csv-raw")
        page.click("dialog .primary")
        other = until(lambda: tables() - set(saved), 20, "the records")
        assert "21.5" in rows(other.pop()), "a record"
        assert not page.complaints()


def test_wire_names_what_is_wrong_and_what_to_do(scene):
    with plant(scene) as (daemon, _, page):
        view(page, "wire")
        shows(page, "#wire .faults", "attic does not answer", "Do:", "The device does not answer")
        shows(page, "#wire .strip", "1 terminal", "room", "21.5")
        assert page.run("return document.querySelector('#wire .screws').textContent") == "0"
        target, = json.loads(scene.owsctl(daemon, "stats", "--json").stdout)["targets"]
        shows(page, "#wire", target["name"], ROOM, BOILER, GONE, "up")
        page.until("return [...document.querySelectorAll('#wire meter')].some((m) => m.value > 0)",
                   "the load of the wire")
        assert not page.complaints()


def test_wire_shows_what_each_device_is_and_what_it_costs(scene):
    with plant(scene) as (daemon, _, page):
        view(page, "wire")
        shows(page, "#wire", "Identity", "Power", "Errors", "Retries", "Share of the wire",
              "external")
        known = {device["id"]: device for device in
                 json.loads(scene.owsctl(daemon, "stats", "--json").stdout)["devices"]}
        row = "[...document.querySelectorAll('#wire tr')].find((r) => " \
              "r.querySelector('th')?.textContent === arguments[0])"
        page.until(f"return {row}?.textContent.includes(arguments[1])",
                   lambda: text_of(page, "#wire"), ROOM, known[ROOM]["identity"])
        page.until(f"return {row}?.querySelector('meter')?.value > 0", "its share", RELAY)
        assert page.run(f"return {row}.textContent.includes('%')", RELAY)
        assert not page.run(f"return Boolean({row}.querySelector('meter'))", GONE)
        assert not page.complaints()


def test_about_shows_the_state_the_log_and_the_counters_of_owsctl_stats(scene):
    with plant(scene) as (daemon, _, page):
        view(page, "about")
        stats = json.loads(scene.owsctl(daemon, "stats", "--json").stdout)
        shows(page, "#about .facts", daemon.name, str(stats["daemon"]["generation"]))
        shows(page, "#about [aria-label=Log]", "notice", *[line for line in daemon.log().splitlines() if line.startswith("owsd ")][:1])
        shows(page, "#about [aria-label=Counters]", *(counter["name"] for counter in stats["counters"]))
        assert not page.complaints()


def test_the_view_live_weighs_at_most_60_kb_as_it_is_served(scene):
    with plant(scene) as (_, _, page):
        name = "return performance.getEntriesByType('resource').find((r) => r.name.endsWith('/alarms.js'))"
        page.until(name, "modules of other views")
        files = page.run("""const all = performance.getEntriesByType('resource'),
            later = all.find((r) => r.name.endsWith('/alarms.js')).startTime;
            return [...performance.getEntriesByType('navigation'),
                ...all.filter((r) => r.startTime < later)].map((r) =>
                [r.name.split('/').pop(), r.encodedBodySize, r.decodedBodySize]);""")
        assert {"live.js", "live.css", "signals"} <= {name for name, *_ in files}, files
        assert sum(served for _, served, _ in files) < 60_000, files
        assert all(0 < served < whole for name, served, whole in files if "." in name), files


def test_of_many_rows_those_on_the_screen_come_first_and_all_are_there_in_the_end(scene):
    with browser.open_one(scene) as page:
        scene.file("many.sim", f"chip DS2482-100 0x18\nDS2408 {RELAY}\n")
        daemon = scene.owsd(owsdtest.rio("sim:many.sim", [
            item(f"door{n}", f"/{RELAY}/sensed.{n % 8}", "bool", PerFactor=50)
            for n in range(300)], Period=0.05, Timeout=3))
        until(lambda: scene.get(daemon, "door299") in ("0", "1"), 30, "the last one has a value")
        page.devtools("Page.addScriptToEvaluateOnNewDocument", source="""
            window.counts = [];
            const look = () => {
                const n = document.querySelectorAll("#live tbody .row").length;
                if (n && n !== counts.at(-1))
                    counts.push(n);
                requestAnimationFrame(look);
            };
            look();""")
        page.go(serve(scene, daemon).address)
        until(lambda: len(page.run(CELLS)) == 300, 20, lambda: page.run("return counts"))
        assert page.run("return counts[0]") < 150, page.run("return counts")
        until(lambda: {cell["value"] for cell in page.run(CELLS).values()} <= {"on", "off"}, 20,
              "all have their value")
        last = "return document.querySelector('#live tbody:last-child .row:last-child')"
        page.run(f"{last}.scrollIntoView()")
        page.until(f"return {last[7:]}.getBoundingClientRect().bottom <= innerHeight",
                   "the last one can be reached")
        page.type("#search", "door299")
        until(lambda: page.run(SHOWN) == ["door299"], 10, lambda: page.run(SHOWN))
        daemon.kill()
        until(lambda: all_unknown(page), 20, "rows that cannot be seen are unknown too")
        assert not page.complaints()


# --- What may be believed -------------------------------------------------------------------


def test_the_loss_of_owsd_makes_every_value_unknown_until_it_is_back(scene):
    with plant(scene) as (daemon, _, page):
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 20, "room has its value")
        daemon.kill()
        until(lambda: all_unknown(page), 20, lambda: page.run(CELLS))
        shows(page, "#banner", "unknown since")
        again = house(scene, daemon.name)
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 30, lambda: page.run(CELLS))
        assert again.running() and not page.run("return document.querySelector('#banner')"
                                                ".checkVisibility()")


def test_the_loss_of_the_connection_makes_every_value_unknown_until_it_is_back(scene):
    with plant(scene) as (daemon, web, page):
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 20, "room has its value")
        web.kill()
        until(lambda: all_unknown(page), 20, lambda: page.run(CELLS))
        serve(scene, daemon, port=web.port)
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 30, lambda: page.run(CELLS))


def test_a_server_that_hangs_makes_every_value_unknown(scene):
    with plant(scene) as (_, web, page):
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 20, "room has its value")
        web.freeze()
        until(lambda: all_unknown(page), 60, lambda: page.run(CELLS))
        web.thaw()
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 30, lambda: page.run(CELLS))


def test_the_page_opens_without_owsd_web_and_says_that_it_is_not_there(scene):
    with plant(scene) as (_, web, page):
        manifest = json.load(urllib.request.urlopen(web.address + "manifest.webmanifest"))
        assert manifest["display"] == "standalone" and manifest["icons"], manifest
        page.until("return navigator.serviceWorker.controller", "the worker")
        kept = "return caches.keys().then((names) => caches.open(names[0])).then((cache) =>" \
               "cache.keys()).then((all) => all.map(({url}) => url))"
        page.go(web.address + "#alarms")  # with the worker, which keeps what it fetches
        page.run("location.reload()")
        shows(page, "#h-alarms", "1 alarm waits for you")
        until(lambda: any(url.endswith("/tell.js") for url in page.run(kept)), 20,
              lambda: page.run(kept))
        assert web.address in page.run(kept), page.run(kept)
        assert not [url for url in page.run(kept) if "/api/" in url], page.run(kept)
        web.kill()
        page.run("location.reload()")
        shows(page, "#banner", "no connection to owsd-web")
        shows(page, "#h-alarms", "unknown now")


# --- Commands -------------------------------------------------------------------------------


def test_a_switch_commands_after_a_confirmation_where_the_file_wants_it(scene):
    with plant(scene, write=True) as (daemon, _, page):
        switch = "[role=switch][aria-label=light]"
        page.click(f"{switch}[aria-checked=false]:enabled")
        shows(page, "dialog", "Set light on?")
        page.press("escape")
        page.until("return !document.querySelector('dialog').open", "the dialog is closed")
        page.click(switch)
        page.click("dialog button.primary")
        shows(page, "#live", "on: taken")
        page.find(f"{switch}[aria-checked=true]")
        assert scene.get(daemon, "light") == "1"
        assert not page.complaints()


def test_an_output_that_was_never_written_has_no_switch_that_lies(scene):
    with plant(scene, write=True) as (daemon, _, page):
        page.click("[aria-label='Set pump on']:enabled")
        page.find("[role=switch][aria-label=pump][aria-checked=true]")
        assert scene.get(daemon, "pump") == "1"
        assert not page.run("return document.querySelector('dialog').open"), "nobody asked for it"


def test_a_fault_of_the_simulation_is_begun_and_ended_on_the_view_wire(scene):
    with plant(scene, write=True) as (_, _, page):
        card = "#wire [data-fault=fault_unplug]"
        until(lambda: page.run(CELLS)["room"]["state"] == "good", 30, lambda: page.run(CELLS))
        view(page, "wire")
        page.click("#wire .simulation summary")
        shows(page, card, "pulls the thermometer of the room off", "off, no fault",
              "device absent")
        page.click(f"{card} [role=switch][aria-checked=false]:enabled")
        shows(page, card, "on, the fault lasts")
        until(lambda: page.run(CELLS)["room"]["quality"] == "device absent", 40,
              lambda: page.run(CELLS)["room"])
        shows(page, "#wire .faults", "do not answer", "room", "attic")
        assert page.run(CELLS)["boiler"]["state"] == "good", page.run(CELLS)
        page.click(f"{card} [role=switch][aria-checked=true]")
        shows(page, card, "off, no fault")
        until(lambda: page.run(CELLS)["room"]["value"] == "21.5", 40,
              lambda: page.run(CELLS)["room"])
        assert not page.complaints()


def test_a_house_without_a_fault_on_demand_shows_no_faults_of_a_simulation(scene):
    with browser.open_one(scene) as page:
        scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {ROOM} temperature 21.5\n")
        daemon = scene.owsd(owsdtest.rio("sim:house.sim", [
            item("room", f"/{ROOM}/temperature12")], Web=owsdtest.raw("{ Write on }")))
        page.go(serve(scene, daemon).address)
        view(page, "wire")
        shows(page, "#wire", "Adapters and terminals", "All wires are good", ROOM)
        assert not page.run("return document.querySelector('#wire .simulation').checkVisibility()")


def test_a_target_that_is_down_has_its_reason_on_the_view_wire(scene):
    with browser.open_one(scene) as page:
        scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {ROOM} temperature 21.5\n")
        daemon = scene.owsd(owsdtest.rio("sim:house.sim,i2c:/dev/i2c-77", [
            item("room", f"/{ROOM}/temperature12")]))
        page.go(serve(scene, daemon).address)
        view(page, "wire")
        shows(page, "#wire .faults", "i2c:/dev/i2c-77 is down", "Do:")
        shows(page, "#wire .strips", "i2c:/dev/i2c-77", "\u00d7 down")
        targets = json.loads(scene.owsctl(daemon, "stats", "--json").stdout)["targets"]
        notes = {target["name"]: target["note"] for target in targets}
        assert notes["sim:house.sim"] is None and "/dev/i2c-77" in notes["i2c:/dev/i2c-77"], notes
        shows(page, "#wire .faults", notes["i2c:/dev/i2c-77"])


def test_a_number_is_entered_by_slider_or_field_and_checked(scene):
    with plant(scene, write=True) as (daemon, _, page):
        page.click("[aria-label='Set others']:enabled")
        assert page.run("return document.querySelector('dialog [type=range]').max") == "200"
        for wrong, words in (("201", "from 0 to 200"), ("1.5", "whole"), ("x", "number")):
            page.type("#command-value", wrong)
            page.press("enter")
            shows(page, "dialog .fault", words)
        page.type("#command-value", "36")
        page.press("enter")
        shows(page, "#live", "36: taken")
        assert scene.get(daemon, "others") == "36"
        assert not page.complaints()


def test_a_refusal_is_shown_with_its_reason(scene):
    with plant(scene, write=True) as (daemon, _, page):
        page.run("return import('./store.js').then(({store}) => {"
                 "store.find('others').max = 255; })")  # the page would refuse it first
        page.click("[aria-label='Set others']:enabled")
        page.type("#command-value", "250")
        page.press("enter")
        shows(page, "#live", "250: refused: ")
        assert scene.get(daemon, "others") == "0"


def test_a_page_without_the_right_to_write_has_its_outputs_disabled(scene):
    with plant(scene) as (_, _, page):
        shows(page, "#read-only", "switched off")
        assert page.run("return [...document.querySelectorAll('.control button')]"
                        ".every((one) => one.disabled)")
        view(page, "alarms")
        page.find("[data-action='acknowledge boiler']:disabled")


# --- Pictures -------------------------------------------------------------------------------


def write_pictures(scene):
    with browser.open_one(scene) as page:
        daemon = house(scene, "demo", True, scene.path / "history", "sine 24 8 1m",
                       "at 50s unplug boiler for 15s\n")
        scene.start([BUILD / "owsd-recorder", "-n", "demo", "-c", daemon.config])
        page.go(serve(scene, daemon).address + "#wire")
        page.until("return document.querySelector('#live tbody .row')", "the rows")
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30, "absent")
        scene.owsctl(daemon, "set", "-w", "9", "others", "36")
        scene.owsctl(daemon, "alarms", "ack", "boiler")
        for state in ("bad", "good"):
            page.until("return [...document.querySelectorAll('#live .row')].find((row) => row"
                       ".textContent.startsWith('boiler')).classList.contains(arguments[0])",
                       "the boiler is unplugged and back", f"is-{state}", seconds=120)
        until(lambda: scene.get(daemon, "room_Age") and float(listed(scene, daemon, "boiler")
              ["boiler"]["value"]) < 56, 120, "the trend has some length")
        page.run("location.hash = '#trends?s=room&s=boiler&span=120000'")
        for name, width, height, scheme, where in (
                ("live", 1280, 620, "light", "live"), ("live-dark", 1280, 620, "dark", "live"),
                ("alarms", 1280, 560, "light", "alarms"), ("trends", 1280, 640, "light", "trends"),
                ("wire", 1280, 860, "light", "wire"), ("phone", 360, 740, "light", "live")):
            page.scheme(scheme)
            page.size(width, height, mobile=width < 500, scale=2 if width < 500 else 1)
            view(page, where)
            page.find(f"#{where} :is(td, canvas)")
            picture = page.picture()
            assert len(picture) <= 150_000, (name, len(picture))
            (SOURCE / f"docs/img/web-{name}.png").write_bytes(picture)


if os.environ.get("WRITE") == "1":
    test_the_pictures_of_the_docs_are_written = write_pictures

if __name__ == "__main__":
    owsdtest.main(at_once=2)
