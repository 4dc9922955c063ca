#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-web with many clients, and with slow ones: memory is bounded, and a stream that was too slow
for the alarms is told so."""

import contextlib
import json
import os

import faulty
import owsdtest
from owsdtest import until
from test_web import Events, Page, both, set_relays, status_of

ALARMS = 64  # that owsd-web keeps for streams
BUDGET = 64 << 20


def resident(page):
    with open(f"/proc/{page.program.pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def shelved(page):
    """So many entries has the journal of alarms."""
    return sum(e["journal"] == "alarms" for e in page.json("/api/journal?n=200")["entries"])


def shelve(page, entries):
    """As many entries more, in the journal of alarms, and few beyond: a slow machine is not told in
    time of what was done, and does it twice."""
    def done(**body):
        return page.ask("/api/alarm", "POST", json.dumps({"name": "room", **body}), unix=True, **{
            "Content-Type": "application/json", "X-Owsd": "1"})[1] == 200
    entries += shelved(page)
    while shelved(page) < entries:
        # owsd takes so many in a second
        until(lambda: done(do="shelve", seconds=600, why="w" * 60), 20, "shelved", step=0.05)
        until(lambda: done(do="unshelve"), 20, "unshelved", step=0.05)


def test_a_stream_that_missed_alarms_is_told_to_look_at_all(scene):
    daemon, page = both(scene, **{"Write": "on"})
    with Events(page) as events:
        events.until("found")
        shelve(page, 2)
        events.until("alarm", lambda data: data["entry"]["event"] == "unshelved")
        set_relays(scene, daemon, 1)
        events.value(1, 1)
        last = events.id
    shelve(page, ALARMS - 8)
    with Events(page, last) as events:
        seen = [events.next()[0] for _ in range(ALARMS - 8)]
        assert set(seen) <= {"alarm", "values"}, seen
    shelve(page, 10)
    with Events(page, last) as events:
        assert events.next()[0] == "missed"
        seen = [events.next()[0] for _ in range(ALARMS)]
        assert seen == ["alarm"] * ALARMS, seen
    # another owsd-web cannot know what came before it
    assert page.program.stop() == 0
    page = Page(scene, daemon)
    until(lambda: page.json("/api/info")["live"], 20, "it has found owsd")
    with Events(page, last) as events:
        events.until("missed")
    with Events(page) as events:
        assert [events.next()[0] for _ in range(2)] == ["found", "values"]


def test_a_thousand_streams_get_each_change_one_more_is_refused_and_others_come_after_them(scene):
    daemon, page = both(scene)
    with contextlib.ExitStack() as all_of_them:
        streams = [all_of_them.enter_context(Events(page)) for _ in range(1000)]
        for stream in streams:
            assert stream.until("found")
        with Events(page) as another:
            assert another.status == 503
        for value in (7, 8):
            set_relays(scene, daemon, value)
            for stream in streams:
                stream.value(1, value)
        assert page.json("/api/info")["signals"] == 2
        assert page.program.running() and len(owsdtest.open_files(page.program)) > 1000
    # that a client has gone is noticed when something is written to it
    set_relays(scene, daemon, 9)
    until(lambda: len(owsdtest.open_files(page.program)) < 100, 30, "they have gone")
    with contextlib.ExitStack() as all_of_them:
        statuses = [all_of_them.enter_context(Events(page)).status for _ in range(1000)]
        assert set(statuses) == {200}, statuses.count(200)


def test_slow_readers_of_large_answers_cost_a_bounded_memory(scene):
    faulty.not_sanitized("a sanitizer keeps memory that was freed")
    daemon, page = both(scene)
    with open(daemon.config, "a", encoding="ascii") as file:
        file.write("# a long comment of a file that somebody else made\n" * 10000)
    size = len(page.ask("/api/config")[2])
    assert size > 400 << 10, size
    many = BUDGET // size + 20
    with contextlib.ExitStack() as open_ones:
        statuses = []
        for _ in range(many):
            s = open_ones.enter_context(page.unix())
            s.sendall(b"GET /api/config HTTP/1.1\r\nHost: localhost\r\n\r\n")
            statuses.append(status_of(s.recv(40)))
        assert set(statuses) == {200, 503}, set(statuses)
        assert statuses.count(200) * size > BUDGET * 0.9, statuses.count(200)
        assert resident(page) < 1.5 * BUDGET, resident(page)
        refused = page.json("/api/config", 503)
        assert "slow readers" in refused["error"], refused
        # what is short is given all the same
        assert page.json("/api/info")["live"] and page.json("/api/journal?n=3")["entries"]
        with Events(page) as events:
            events.until("found")
    until(lambda: page.ask("/api/config")[1] == 200, 60, "they have gone")


if __name__ == "__main__":
    owsdtest.main()
