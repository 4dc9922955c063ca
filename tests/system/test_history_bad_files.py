#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Files in the place of a history that are none, or damaged: owsd-recorder puts them aside by name
or refuses them by name, and owsctl says what is wrong; a user of the group reads what there is."""

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


def test_a_newer_file_and_one_of_another_program_are_refused_by_name_and_left_alone(scene):
    daemon, folder = history(scene)
    for change, reason in (("pragma user_version = 77", "of a newer owsd-recorder"),
                           ("pragma application_id = 5", "is no history of owsd")):
        with contextlib.closing(sqlite3.connect(folder / FILE)) as db:
            db.execute(change)
            db.execute("pragma wal_checkpoint(truncate)")
        before = (folder / FILE).read_bytes()
        done = scene._run([RECORDER, "-n", daemon.name, "-c", daemon.config, "-d", folder], 20)
        assert done.returncode == 1 and FILE in done.stderr and reason in done.stderr, done
        assert trend(scene, daemon, folder).returncode == 1
        assert (folder / FILE).read_bytes() == before


def test_a_folder_or_a_pipe_in_its_place_is_said_and_kept(scene):
    daemon = scene.owsd(text(scene))
    pipe, folder = scene.path / "pipe", scene.path / "folder"
    pipe.mkdir()
    os.mkfifo(pipe / FILE)
    done = scene._run([RECORDER, "-n", daemon.name, "-c", daemon.config, "-d", pipe], 20)
    assert done.returncode == 1 and "is no history of owsd" in done.stderr, done
    (folder / FILE).mkdir(parents=True)
    recorder = record(scene, daemon, directory=folder)
    until(lambda: "cannot be written: Is a directory" in recorder.log(), 20, "it says so")
    set_relays(scene, daemon, 7)
    (folder / FILE).rmdir()
    until(lambda: "is written again" in recorder.log(), 60, "it catches up")
    assert recorder.stop() == 0
    assert Past(scene, folder).good("relays")[-1] == "7"


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
