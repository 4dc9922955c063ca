#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Files in the place of a history that are none, or damaged: owsd-recorder puts them aside by name,
or says by name what is in its way and goes on in memory, and owsctl says what is wrong; a user of
the group reads what there is."""

import contextlib
import os
import random
import sqlite3

import owsdtest
from owsdtest import until
from recorded import RECORDER, Past, record, set_relays, text

FILE = "history.sqlite"


def history(scene):
    """The daemon, and the folder of a history with relays 1 and 2."""
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    for value in (1, 2):
        set_relays(scene, daemon, value)
    until(lambda: "2" in Past(scene).good("relays"), 20, "it is on the disk")
    assert recorder.stop() == 0
    return daemon, scene.path / "history"


def trend(scene, daemon, folder):
    return scene.owsctl(daemon, "trend", "-d", folder, "--csv", "--since", "1h", "relays")


def test_a_damaged_file_is_put_aside_and_another_is_begun(scene):
    daemon, folder = history(scene)
    damaged = random.Random(17).randbytes(100000)
    (folder / FILE).write_bytes(damaged)
    for log in folder.glob("history.sqlite-*"):
        log.unlink()
    done = trend(scene, daemon, folder)
    assert done.returncode == 1 and "Bad message" in done.stderr, done
    recorder = record(scene, daemon)
    assert "history-damaged-1.sqlite" in recorder.log(), recorder.log()
    set_relays(scene, daemon, 3)
    until(lambda: "3" in Past(scene).good("relays"), 20, "it records")
    assert recorder.stop() == 0
    assert (folder / "history-damaged-1.sqlite").read_bytes() == damaged
    assert "1" not in Past(scene).good("relays")


def in_memory_until_it_is_moved_away(scene, daemon, folder, reason, value):
    """The recorder says REASON and what to do, and has the value when the way is free."""
    recorder = record(scene, daemon, directory=folder)
    until(lambda: "cannot be written: " in recorder.log(), 20, "it says so")
    line = next(line for line in recorder.log().splitlines() if "cannot be written" in line)
    assert reason in line and FILE in line and "move" in line, line
    set_relays(scene, daemon, value)
    assert trend(scene, daemon, folder).returncode == 1
    (folder / FILE).rename(folder / f"away-{value}")
    until(lambda: "is written again" in recorder.log(), 90, "it catches up")
    assert recorder.stop() == 0
    assert Past(scene, folder).good("relays")[-1] == str(value)


def test_a_newer_file_and_one_of_another_program_are_left_alone_until_they_are_moved(scene):
    daemon, folder = history(scene)
    for value, change, reason in ((3, "pragma user_version = 77", "of a newer owsd-recorder"),
                                  (4, "pragma application_id = 5", "is no history of owsd")):
        with contextlib.closing(sqlite3.connect(folder / FILE)) as db:
            db.execute(change)
            db.execute("pragma wal_checkpoint(truncate)")
        before = (folder / FILE).read_bytes()
        in_memory_until_it_is_moved_away(scene, daemon, folder, reason, value)
        assert (folder / f"away-{value}").read_bytes() == before


def test_a_folder_a_pipe_or_a_link_in_its_place_is_said_and_kept(scene):
    daemon = scene.owsd(text(scene))
    for value, make, reason in ((5, os.mkfifo, "is no history of owsd"),
                                (6, os.mkdir, "Is a directory"),
                                (7, lambda path: os.symlink("/etc/passwd", path), "is a link")):
        folder = scene.path / f"history-{value}"
        folder.mkdir()
        make(folder / FILE)
        in_memory_until_it_is_moved_away(scene, daemon, folder, reason, value)


def test_plain_sql_reads_names_times_and_words(scene):
    _, folder = history(scene)
    with contextlib.closing(sqlite3.connect(f"file:{folder / FILE}?mode=ro", uri=True)) as db:
        rows = db.execute("select time, value, quality from trend where name = 'relays' "
                          "and quality = 'good' order by time").fetchall()
        assert [row[1] for row in rows][-2:] == [1, 2], rows
        assert all(row[0].endswith("Z") and row[0][10] == "T" for row in rows), rows
        events = db.execute("select kind, name, value, program from trend_event "
                            "where kind = 'command' order by time").fetchall()
        assert events == [("command", "relays", 1, "owsctl"), ("command", "relays", 2, "owsctl")]


if __name__ == "__main__":
    owsdtest.main()
