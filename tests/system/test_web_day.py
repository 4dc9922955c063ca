#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A page that nobody loads anew for a day, hurried: in each round owsd, owsd-web, the network or the
computer of the browser fails, and values change meanwhile. What was unknown never comes back as it
was before, each round ends with what owsctl lists, and the browser needs no more memory at the end.
ROUNDS says how many; each kind comes in turn."""

import contextlib
import os
import random
import re
import socket
import statistics
import threading
import time

import browser
import owsdtest
from owsdtest import until
from webhouse import CELLS, house, listed, serve, shows, text_of, view

ROUNDS = int(os.environ.get("ROUNDS", "22"))
HOUR_MS = 3_600_000
DOUBTS_MS = 4000  # a page that slept says after so long that it knows nothing
# What is on the screen, each time that it is another; a clock that can be set; and waits in the page,
# because chromedriver has the browser keep what each of its calls returns
WITNESS = """
    window.shift = 0;
    window.seen = [];
    window.cells = () => { %s };
    window.allUnknown = () => Object.values(cells()).every(({value}) => value === "unknown");
    window.until = (condition) => new Promise((done) => {
        const look = () => condition() ? done(true) : setTimeout(look, 100);
        look();
    });
    const now = Date.now.bind(Date);
    Date.now = () => now() + window.shift;
    const look = () => {
        requestAnimationFrame(look);
        const rows = [...document.querySelectorAll("#live tbody .row")];
        const text = (name) => rows.find((row) => row.querySelector(".name").textContent === name)
            ?.querySelector(".number").textContent;
        const one = {room: text("room"), others: text("others"), at: performance.now()};
        const last = window.seen.at(-1);
        if (one.room !== undefined && (one.room !== last?.room || one.others !== last?.others))
            window.seen.push(one);
    };
    look();""" % CELLS


class Line:
    """The network between browser and owsd-web."""

    def __init__(self, target):
        self.target, self.port = target, owsdtest.free_port()
        self.through = threading.Event()
        self.through.set()
        self.ends, self.listener = set(), None
        self.mend()

    def _accept(self, listener):
        with contextlib.suppress(OSError):
            while True:
                here, _ = listener.accept()
                there = socket.socket()
                self.ends |= {here, there}
                if there.connect_ex(("127.0.0.1", self.target)):
                    self._end(here, there)
                for pair in ((here, there), (there, here)):
                    threading.Thread(target=self._carry, args=pair, daemon=True).start()

    def _carry(self, source, sink):
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                self.through.wait()
                sink.sendall(data)
        self._end(source, sink)

    def _end(self, *ends):
        for one in ends:
            self.ends.discard(one)
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()

    def hold(self):
        """Nothing arrives any more, and nobody is told; with mend() it comes late."""
        self.through.clear()

    def cut(self):
        """Connections end, new ones are refused."""
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        self._end(*self.ends)

    def mend(self):
        self.through.set()
        if self.listener is None or self.listener.fileno() < 0:
            self.listener = socket.create_server(("127.0.0.1", self.port))
            threading.Thread(target=self._accept, args=(self.listener,), daemon=True).start()


class Day:
    """The house, the page, and what is true of it."""

    def __init__(self, scene, page):
        self.scene, self.page, self.random = scene, page, random.Random(1)
        self.number = 0
        self.daemon = house(scene, room="20.0")
        self.truth = {"room": 20.0, "others": None}
        self.had, self.hung = [], False  # in this round
        self.web = serve(scene, self.daemon)
        self.line = Line(self.web.port)
        self.set_others()

    def set_others(self):
        """What an output has is another value."""
        self.number += 1
        value = self.number * 2 % 200  # light, which is bit 0, was commanded off
        until(lambda: self.scene.owsctl(self.daemon, "set", "-w", "20", "others", value)
              .returncode == 0, 30, "it is set")
        until(lambda: self.scene.get(self.daemon, "others") == str(value), 20, "it is read back")
        self.truth["others"] = float(value)
        self.had.append(self.truth["others"])

    def unknown(self, why):
        try:
            self.page.run("return until(allUnknown)")
        except browser.Fault as fault:
            raise owsdtest.Late(f"{why}: {self.page.run(CELLS)}") from fault

    def doubted_since(self, begun, why):
        self.unknown(why)
        late = self.page.run("return window.seen.at(-1).at") - begun
        assert late < DOUBTS_MS, f"{why}, and the page showed old values for {late:.0f} ms"

    # --- What happens -----------------------------------------------------------------------

    def owsd_ends(self):
        self.daemon.kill()
        self.unknown("owsd has ended")
        self.number += 1
        self.truth["room"] = 20 + self.number % 40 / 2
        self.daemon = house(self.scene, self.daemon.name, room=str(self.truth["room"]))
        self.set_others()

    def owsd_is_there_again_at_once(self):
        self.daemon.stop()
        self.number += 1
        self.truth["room"] = 20 + self.number % 40 / 2
        self.daemon = house(self.scene, self.daemon.name, room=str(self.truth["room"]))
        self.set_others()

    def owsd_hangs(self):
        self.daemon.freeze()
        self.unknown("owsd hangs")
        self.hung = True  # nothing could change meanwhile
        self.daemon.thaw()
        self.set_others()

    def the_file_is_loaded_anew(self):
        file = self.daemon.config
        file.write_text(re.sub('"Flow.*"', f'"Flow {self.number}"', file.read_text()))
        assert self.scene.owsctl(self.daemon, "reload").returncode == 0
        self.set_others()
        self.page.until("return document.querySelector('#live').textContent.includes(arguments[0])",
                        "the new description", f"Flow {self.number - 1}")

    def owsd_web_ends(self):
        self.web.kill()
        if self.random.random() < 0.5:
            self.unknown("owsd-web has ended")
        self.set_others()
        self.web = serve(self.scene, self.daemon, port=self.web.port)

    def owsd_web_hangs(self):
        self.web.freeze()
        self.set_others()
        self.unknown("owsd-web hangs")
        self.web.thaw()

    def the_network_is_cut(self):
        self.line.cut()
        self.set_others()
        self.unknown("there is no network")
        self.line.mend()

    def the_network_is_silent(self):
        self.line.hold()
        self.set_others()
        self.unknown("nothing comes")
        self.line.mend()

    def the_page_is_frozen(self):
        self.page.devtools("Page.setWebLifecycleState", state="frozen")
        self.set_others()
        if self.random.random() < 0.5:
            self.line.cut()
            self.set_others()
            self.line.mend()
        self.page.devtools("Page.setWebLifecycleState", state="active")
        window = self.page.devtools("Browser.getWindowForTarget")["windowId"]
        for state in ("minimized", "normal"):  # else it stays hidden
            self.page.devtools("Browser.setWindowBounds", windowId=window,
                               bounds={"windowState": state})

    def the_computer_sleeps(self):
        """The clock went on, the timers did not; the connection is no more, and nobody says so."""
        self.line.hold()
        self.set_others()
        begun = self.page.run(f"window.shift += {8 * HOUR_MS}; return performance.now()")
        self.doubted_since(begun, "it slept")
        self.line.mend()

    def the_clock_is_set_back(self):
        self.line.hold()
        self.set_others()
        self.doubted_since(self.page.run(f"window.shift -= {8 * HOUR_MS}; return performance.now()"),
                           "its clock was set")
        self.line.mend()

    # --- What must be -----------------------------------------------------------------------

    def wrong(self):
        """What the page shows otherwise than owsctl."""
        rows = listed(self.scene, self.daemon)
        for name, value in self.truth.items():
            if rows[name]["value"] != value or not rows[name]["good"]:
                return rows[name]
        return self.page.run("""const rows = cells(), wrong = [];
            for (const [name, good, value] of arguments[0]) {
                const row = rows[name] ?? {};
                delete rows[name];
                if ((row.state === "good") !== good || good && value !== null
                    && Number(row.value) !== value || good && name === "boiler"
                    && !/^(now|[1-9] s)$/.test(row.age))
                    wrong.push(name, good, value, row);
            }
            return [...wrong, ...Object.keys(rows)];""", [
                [name, row["good"], row["value"] if name in self.truth and row["good"] else None]
                for name, row in rows.items()])

    def witnessed(self, before):
        """What changed while it was unknown was never shown again as it was before."""
        name = "room" if self.truth["room"] != before["room"] else "others"
        shown = self.page.run("""
            const frame = () => new Promise(requestAnimationFrame);
            // what is on the screen now is seen: the next round begins with it
            return frame().then(frame).then(() =>
                window.seen.splice(0, window.seen.length - 1).map((one) => one[arguments[0]]));
        """, name)
        changed = [text for n, text in enumerate(shown) if n == 0 or shown[n - 1] != text]
        good = {n: float(text) for n, text in enumerate(changed)
                if text not in ("unknown", "")}
        allowed = {before[name], self.truth[name], *(self.had if name == "others" else [])}
        assert set(good.values()) <= allowed, (name, changed, allowed)
        if before[name] != self.truth[name] and not self.hung:
            assert before[name] not in [good[n] for n in good if n], (name, changed, before[name])
        self.had, self.hung = [], False

    def weight(self):
        """Bytes, nodes and listeners after the garbage was collected."""
        for _ in range(2):
            self.page.devtools("HeapProfiler.collectGarbage")
        counts = self.page.devtools("Memory.getDOMCounters")
        heap = self.page.devtools("Runtime.getHeapUsage")["usedSize"]
        return {"bytes": heap, "nodes": counts["nodes"], "listeners": counts["jsEventListeners"],
                "documents": counts["documents"]}


KINDS = [Day.the_clock_is_set_back, Day.owsd_ends, Day.the_page_is_frozen, Day.owsd_web_ends,
         Day.the_file_is_loaded_anew, Day.the_network_is_cut, Day.the_computer_sleeps,
         Day.owsd_is_there_again_at_once, Day.owsd_web_hangs, Day.owsd_hangs,
         Day.the_network_is_silent]


def flat(weights):
    """The end of the day needs no more than its middle. Before that the lists of so many values fill;
    and chromedriver has the browser keep some kilobytes of each round."""
    part = len(weights) // 3
    allowed = {"bytes": 300_000 + 10_000 * part, "nodes": 200, "listeners": 20, "documents": 0}
    for key, more in allowed.items():
        middle, end = (statistics.median(one[key] for one in some)
                       for some in (weights[part:-part], weights[-part:]))
        assert end <= middle + more, (key, [one[key] for one in weights])


VIEWS = ["live", "alarms", "trends?s=room", "wire", "about", "config"]


def test_a_day_of_faults_shows_what_is_true_or_unknown_and_needs_no_more_memory(scene):
    with browser.open_one(scene) as page:
        day = Day(scene, page)
        page.devtools("Page.addScriptToEvaluateOnNewDocument", source=WITNESS)
        page.ask("POST", f"{page.base}/timeouts", {"script": owsdtest.PATIENCE * 900})
        page.go(f"http://127.0.0.1:{day.line.port}/")
        for name in VIEWS:
            page.run("location.hash = arguments[0]", name)
            page.until("return document.querySelector('main > section:not([hidden])')"
                       ".querySelector('td, canvas, li, [role=gridcell]')", name)
        weights = []
        for n in range(ROUNDS + 1):
            kind = KINDS[n % len(KINDS)]
            before, begun = dict(day.truth), time.monotonic()
            if n:
                # views that are not seen do what they do by themselves
                page.run(f"location.hash = '#{VIEWS[n % len(VIEWS)]}'")
                kind(day)
                page.run("location.hash = '#live'")
            until(lambda: not day.wrong(), 60, day.wrong, step=0.2)
            day.witnessed(before)
            weights.append(day.weight())
            print(f"{n}, {kind.__name__ if n else 'begin'}: {time.monotonic() - begun:.1f} s, "
                  f"{weights[-1]}", flush=True)
        uncaught = [text for text in page.complaints() if "Uncaught" in text]
        assert not uncaught, uncaught
        flat(weights)


def test_a_view_that_cannot_be_fetched_says_so_and_comes_when_it_is_chosen_again(scene):
    with browser.open_one(scene) as page:
        daemon = house(scene)
        line = Line(serve(scene, daemon).port)
        page.go(f"http://127.0.0.1:{line.port}/")
        page.until("return document.querySelectorAll('#live tbody .row').length === 9", "the rows")
        line.cut()
        view(page, "config")
        shows(page, "#config", "cannot be fetched", "Choose it again")
        line.mend()
        view(page, "live")
        view(page, "config")
        page.until("return document.querySelector('#config').innerText.includes('room')",
                   "the configuration")
        assert "cannot be fetched" not in text_of(page, "#config")


if __name__ == "__main__":
    owsdtest.main()
