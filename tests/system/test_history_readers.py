#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The queries of docs/history-queries.md, word for word, and the examples for pandas and DuckDB, on a
history that owsd-recorder writes meanwhile: by sqlite3 (also what is pasted into Grafana, whose
macros stand in its place), pandas and DuckDB. Two days of it are rows that were put into the file;
their sums are the recorder's."""

import contextlib
import datetime
import json
import os
import re
import shutil
import sqlite3
import subprocess
import sys
import threading
import time

import clients
import handbook
import owsdtest
from owsdtest import SOURCE, until
from recorded import RELAYS, ROOM, TITLE, record, recorded, text

PAGE = SOURCE / "docs/history-queries.md"
WANTED = owsdtest.SOURCE / "tests/system/history-readers.txt"
MINUTE = 60 * 10**6
DAYS, HOLE = 2, range(1000, 1060)  # minutes in which nothing is known
ALARM_S = 90
NOBODY = 65534
KINDS = 6  # of queries, of each program


def value_of(minute):
    return 20 + minute % 60 / 10


def put_past(file):
    """Two days of room1 each minute, of relays each hour, a gap and an alarm; returns their begin."""
    begun = (time.time_ns() // 1000 // MINUTE - DAYS * 1440) * MINUTE
    with contextlib.closing(sqlite3.connect(file)) as db:
        first, = db.execute("select min(start) from session").fetchone()
        number = dict(db.execute("select name, signal from signal"))
        reason, = db.execute("select reason from reason where text = 'recorder stopped'").fetchone()
        end = (first - begun) // MINUTE - 2
        db.execute("delete from hour")
        db.execute("delete from minute")
        db.execute("insert into session values (?, 99, ?, 0, 1, null)", (begun, begun))
        for minute in range(end):
            if minute not in HOLE:
                at = begun + minute * MINUTE
                db.execute("insert into raw values (?, ?, ?, 192)",
                           (at, number["room1"], value_of(minute)))
                if minute % 60 == 0 or minute - 1 in HOLE:
                    db.execute("insert into raw values (?, ?, 5, 192)", (at + 1, number["relays"]))
        for at, done in ((HOLE.start, HOLE.stop), (end, None)):
            db.execute("insert into gap values (?, 0, ?, ?)", (
                begun + at * MINUTE, first if done is None else begun + done * MINUTE, reason))
        for at, event in ((7, 1), (7 + ALARM_S / 60, 2)):
            at = int(begun + at * MINUTE) + 5
            db.execute("insert into event (id, time, kind, signal, type, quality, reason, event, value)"
                       " values (?, ?, 8, ?, 8, 192, 4, ?, 25.5)", (at, at, number["room1"], event))
        db.commit()
    return begun


class House:
    """An owsd, its recorder, and somebody who has relays move all the time."""

    def __init__(self, scene):
        self.scene, self.folder = scene, scene.path / "history"
        if os.geteuid() == 0:
            for folder in (scene.path, scene.path.parent):  # another user comes to the file
                folder.chmod(folder.stat().st_mode | 0o011)
        self.daemon = scene.owsd(text(scene, dict(ROOM, Name="room1"), RELAYS, TITLE))
        recorder = record(scene, self.daemon)
        assert scene.owsctl(self.daemon, "set", "-w", "20", "relays", "1").returncode == 0
        recorded(scene, "relays", "1")
        recorded(scene, "room1", "21.5")
        assert recorder.stop() == 0
        self.begun = put_past(self.folder / "history.sqlite")
        self.recorder = record(scene, self.daemon)
        self.ended = threading.Event()
        self.mover = threading.Thread(target=self.move)
        until(lambda: self.ask("select count(*) from trend_hour where name = 'room1'")[0][0] > 40, 60,
              "the recorder has made the sums")

    def ask(self, query):
        with contextlib.closing(sqlite3.connect(f"file:{self.folder}/history.sqlite?mode=ro",
                                                uri=True)) as db:
            return db.execute(query).fetchall()

    def move(self):
        import ows
        with ows.Ows(self.daemon.name, control=True) as signals:
            value = 0
            while not self.ended.wait(0.03):
                value = (value + 1) % 200
                signals.set("relays", value)

    def __enter__(self):
        self.mover.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.mover.join()

    def newest(self):
        return self.ask("select max(id) from raw")[0][0]

    def commits(self, what):
        before = self.newest()
        until(lambda: self.newest() > before, 20, f"the recorder commits {what}")


def sections():
    """Of each heading of the page its blocks."""
    found = {}
    for part in re.split(r"^## ", PAGE.read_text(), flags=re.M)[1:]:
        heading, _, rest = part.partition("\n")
        found[heading] = [b.text for b in handbook.markdown_blocks(PAGE.name, rest.split("\n"))]
    return found


def by_sqlite3(house, query):
    """As somebody who may read, and neither write nor make files there."""
    done = subprocess.run(["sqlite3", "-readonly", "-json", "history.sqlite"], input=query, text=True,
                          capture_output=True, cwd=house.folder, timeout=owsdtest.PATIENCE, check=False,
                          **({"user": NOBODY, "group": NOBODY} if os.geteuid() == 0 else {}))
    assert done.returncode == 0 and not done.stderr, (query, done)
    return json.loads(done.stdout or "[]")


def for_grafana(query, begin_ms, end_ms):
    return query.replace("$__from", str(begin_ms)).replace("$__to", str(end_ms))


def open_to_all(house):
    for place in (house.scene.path, house.folder):
        place.chmod(0o755)
    for file in house.folder.glob("history.sqlite*"):
        file.chmod(0o644)


def wall(us):
    return datetime.datetime.fromtimestamp(us / 1e6).strftime("%Y-%m-%d %H:%M:%S")


def local_days(house):
    """Least and most of each local date, of all rows of room1."""
    days = {}
    for us, value in house.ask("select id, value from raw join signal using (signal) where name ="
                               " 'room1' and quality = 192"):
        days.setdefault(wall(us)[:10], []).append(value)
    return days


def check_past(house, rows, key):
    """A row of each minute of the last day; key: of its value."""
    had = {row["time" if "time" in row else "minute"]: row[key] for row in rows}
    last = (time.time_ns() // 1000 - house.begun) // MINUTE
    for minute in range(last - 1400, last - 130):
        if minute not in HOLE:
            assert had.get(wall(house.begun + minute * MINUTE)) == value_of(minute), (minute, had)


def test_what_is_pasted_into_sqlite3_is_read_beside_the_recorder(scene):
    if not shutil.which("sqlite3"):
        owsdtest.skip("sqlite3 is not installed")
    queries, took = sections()["sqlite3"], []
    assert len(queries) == KINDS, queries
    with House(scene) as house:
        open_to_all(house)
        answers = []
        for query in queries:
            house.commits("before a query")
            begun = time.monotonic()
            answers.append(by_sqlite3(house, query))
            took.append(time.monotonic() - begun)
        day, minutes, days, alarms, then, gaps = answers
        check_past(house, day, "value")
        assert {row["quality"] for row in day} >= {"good", "recorder stopped"}, day[-3:]
        check_past(house, minutes, "mean")
        known = local_days(house)
        assert len(days) >= DAYS and all(
            (row["least"], row["most"]) == (min(known[row["date"]]), max(known[row["date"]]))
            for row in days[:-1]), (days, known)
        assert [(a["alarm"], a["seconds"]) for a in alarms][:1] == [("high", ALARM_S)], alarms
        assert alarms[-1]["alarm"] == "high" and alarms[-1]["until"] is None, alarms
        assert {row["name"]: row["quality"] for row in then} == {"room1": "good", "relays": "good"}, then
        hole = [(g["name"], g["since"], g["until"]) for g in gaps if g["why"] == "recorder stopped"]
        ends = [wall(house.begun + at * MINUTE) for at in (HOLE.start, HOLE.stop)]
        assert all((name, *ends) in hole for name in ("room1", "relays")), gaps
        command = re.search(r'^\$ (sqlite3 .*?")$', (SOURCE / "docs/history.md").read_text(), re.M | re.S)[1]
        done = subprocess.run(["sh", "-c", command], text=True, capture_output=True, cwd=house.folder,
                              timeout=owsdtest.PATIENCE, check=False)
        assert re.search(r"^\d{4}-\d\d-\d\dT[\d:]{8}\.\d{3}Z\|[\d.]+\|\u00b0C\|good$", done.stdout, re.M), done
        # a reader that stays in the middle of its answer holds nobody up
        with contextlib.closing(sqlite3.connect(house.folder / "history.sqlite")) as slow:
            rows = slow.execute("select * from trend order by id")
            rows.fetchone()
            house.commits("beside a reader")
            house.commits("again")
        assert max(took) < owsdtest.patience(5), took
        assert house.recorder.running() and "lock" not in house.recorder.log(), house.recorder.log()
    print("seconds of each query: " + " ".join(f"{t:.2f}" for t in took))


def test_what_is_pasted_into_grafana_is_read_beside_the_recorder(scene):
    if not shutil.which("sqlite3"):
        owsdtest.skip("sqlite3 is not installed")
    queries = sections()["Grafana"]
    assert len(queries) == KINDS, queries
    with House(scene) as house:
        open_to_all(house)
        end = time.time_ns() // 10**6
        values, minutes, days, alarms, then, gaps = (
            by_sqlite3(house, for_grafana(query, house.begun // 1000, end)) for query in queries)
        # times as the plug-in takes them: RFC 3339, or seconds since 1970
        assert all(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", row["time"])
                   for rows in (values, minutes, alarms, then, gaps) for row in rows)
        assert all(row["room1"] is None or isinstance(row["room1"], float) for row in values)
        assert sum(row["room1"] is not None for row in values) > DAYS * 1440 - 70, len(values)
        assert any(row["room1"] is None for row in values), values
        times = [row["time"] for row in minutes]
        assert times == sorted(times) and len(times) > DAYS * 1440 - 200, len(times)
        hole = datetime.datetime.fromtimestamp((house.begun + HOLE.start * MINUTE) / 1e6, datetime.UTC)
        at = times.index(hole.strftime("%Y-%m-%dT%H:%M:%S.000Z"))
        assert minutes[at]["mean"] is None and minutes[at - 1]["mean"] is not None, minutes[at - 1:at + 2]
        known = local_days(house)
        for row in days[:-1]:
            date = wall(row["time"] * 10**6)
            assert date.endswith(" 00:00:00") and row["most"] == max(known[date[:10]]), (row, known)
        assert [a["seconds"] for a in alarms][:1] == [ALARM_S] and alarms[-1]["until"] is None, alarms
        assert {"room1", "relays"} <= {row["name"] for row in then}, then
        assert {row["name"] for row in gaps} >= {"room1", "relays"}, gaps
        assert "lock" not in house.recorder.log(), house.recorder.log()


def by_python(house, module, tail):
    """The example with that module, and after it what prints its results as JSON."""
    clients.python_client(module, WANTED, "history-readers")
    packages = sys.path[0]
    block = (owsdtest.SOURCE / f"docs/examples/history_{module}.py").read_text()
    home = house.scene.path / "home"
    for file in (house.scene.path.__class__(packages)).glob(
            "duckdb_extension_sqlite_scanner/extensions/*/*.duckdb_extension"):
        kept = home / ".duckdb/extensions" / file.parent.name / "linux_amd64"
        kept.mkdir(parents=True)
        (kept / file.name).symlink_to(file)
    done = subprocess.run([sys.executable, "-c", block + tail], cwd=house.folder, capture_output=True,
                          text=True, timeout=2 * owsdtest.PATIENCE, check=False,
                          env={**os.environ, "PYTHONPATH": packages, "HOME": str(home)})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def check_results(house, found):
    assert found["last_day"] > 1440 - 70 and found["minutes"] > 1440 - 200, found
    known = [value for values in local_days(house).values() for value in values]
    assert [found["least"], found["most"]] == [min(known), max(known)], found
    assert ALARM_S in found["alarms"], found
    assert set(found["then"]) >= {"room1", "relays"} and found["then"]["relays"] == 5, found
    assert {"room1", "relays"} <= set(found["gaps"]), found
    assert "lock" not in house.recorder.log(), house.recorder.log()


def test_what_pandas_is_given_is_read_beside_the_recorder(scene):
    with House(scene) as house:
        check_results(house, by_python(house, "pandas", """
import json
assert str(minutes.index.tz) == "Europe/Berlin", minutes.index
print(json.dumps({"last_day": len(last_day), "minutes": len(minutes),
    "least": days.least.min(), "most": days.most.max(), "alarms": alarms.seconds.dropna().tolist(),
    "then": dict(zip(then.name, then.value)), "gaps": gaps.name.unique().tolist()}))
"""))


def test_what_duckdb_is_given_is_read_beside_the_recorder(scene):
    with House(scene) as house:
        check_results(house, by_python(house, "duckdb", """
import json
print(json.dumps({"last_day": len(last_day), "minutes": len(minutes),
    "least": min(row[1] for row in days.fetchall()), "most": max(row[2] for row in days.fetchall()),
    "alarms": [row[3] for row in alarms.fetchall()],
    "then": {row[0]: row[1] for row in then.fetchall()},
    "gaps": sorted({row[0] for row in gaps.fetchall()})}))
"""))


if __name__ == "__main__":
    owsdtest.main(at_once=1)
