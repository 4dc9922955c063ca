#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-recorder beside a real owsd: what is read back is what was there, and gaps are gaps."""

import csv
import datetime
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import faulty
import owsdtest
import sandbox
from owsdtest import BUILD, SOURCE, raw, until
from recorded import (RECORDER, RELAY, RELAYS, ROOM, SENSOR, Past, boot, distinct, item, record,
                      recorded, set_relays, text)


def test_changes_commands_and_alarms_are_recorded(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
    until(lambda: scene.get(daemon, "title") == "DS18B20", 20, "so is the text")
    for value in (1, 2, 7):
        set_relays(scene, daemon, value)
        recorded(scene, "relays", str(value))
    assert recorder.stop() == 0
    past = Past(scene)
    assert past.good("room") == ["21.5"], past.signals
    assert past.good("title") == ['"DS18B20"'], past.signals
    assert past.good("relays") == ["1", "2", "7"], past.signals
    commands = [(words[2], words[3], words[-1]) for words in past.kinds("command")]
    assert commands == [("relays", v, "owsctl") for v in "127"], commands
    assert [words[2] for words in past.kinds("alarm")] == ["room"], past.events
    times = [when for when, _, _ in past.signals["relays"]]
    assert times == sorted(times), times
    assert past.signals["relays"][-1][2] == "recorder stopped", past.signals


def test_a_killed_owsd_is_a_gap_and_what_comes_after_it_is_new(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    set_relays(scene, daemon, 5)
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
    alive = boot()
    owsdtest.worked(daemon.name, 1.5)  # more than from one heartbeat to the next
    daemon.kill()
    killed = boot()
    until(lambda: "owsd is lost" in recorder.log(), 20, "the loss is seen")
    time.sleep(1)  # it is lost for so long
    dead = boot()
    again = scene.owsd(daemon.config, name=daemon.name)
    until(lambda: recorder.log().count("recording ") == 2, 20, "it records again")
    until(lambda: scene.get(again, "room") == "21.5", 20, "the room is good again")
    set_relays(scene, again, 6)
    recorded(scene, "relays", "6")
    after = boot()
    time.sleep(0.1)  # records have whole milliseconds
    assert recorder.stop() == 0
    past = Past(scene)
    assert past.at("relays", alive) == "5", past.signals
    # from the last heartbeat on, which may be half a second before the kill
    for moment in (killed + 0.05, (killed + dead) / 2, dead):
        assert past.at("room", moment) is None, (moment, past.signals)
        assert past.at("relays", moment) is None, (moment, past.signals)
    assert past.at("room", after) == "21.5" and past.at("relays", after) == "6", past.signals
    assert set(past.good("relays")) <= {"5", "6"}, past.signals
    gaps = past.kinds("gap")
    assert gaps and all("owsd" in words for words in gaps), past.events


def test_a_recorder_that_could_not_look_has_a_gap_where_more_than_one_change_was_missed(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "the room is good")
    set_relays(scene, daemon, 5)
    recorded(scene, "relays", "5")
    known = boot()
    owsdtest.worked(daemon.name, 1)  # the recorder looks after that
    seen = boot()
    recorder.signal(signal.SIGSTOP)
    for value in (6, 7, 5):
        set_relays(scene, daemon, value)
        time.sleep(1.5)  # nobody looks for so long
    unseen = boot()
    recorder.signal(signal.SIGCONT)
    until(lambda: "could not look" in recorder.log(), 20, "the recorder says so")
    set_relays(scene, daemon, 8)
    recorded(scene, "relays", "8")
    looks = boot()
    assert recorder.stop() == 0
    past = Past(scene)
    assert past.at("relays", known) == "5" and past.at("room", looks - 0.1) == "21.5", past.signals
    for moment in (seen + 2.5, unseen - 2):
        assert past.at("relays", moment) is None, (moment, past.signals)
    assert past.good("relays")[-2:] == ["5", "8"], past.signals
    assert "too many changes" in str(past.signals["relays"]), past.signals


def test_a_killed_recorder_loses_what_was_in_memory_and_nothing_else(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    for value in range(1, 6):
        set_relays(scene, daemon, value)
    recorded(scene, "relays", "5")
    recorder.kill()
    set_relays(scene, daemon, 99)
    unseen = boot()
    time.sleep(0.3)  # no recorder runs for so long
    set_relays(scene, daemon, 6)
    recorder = record(scene, daemon)
    set_relays(scene, daemon, 7)
    recorded(scene, "relays", "7")
    assert recorder.stop() == 0
    past = Past(scene)
    assert distinct(past.good("relays")) == [*"1234567"], past.signals
    assert past.at("relays", unseen) is None, past.signals
    # the journal of owsd has what the recorder has not seen happen; nothing is there twice
    commands = [words[3] for words in past.kinds("command")]
    assert commands == ["1", "2", "3", "4", "5", "99", "6", "7"], past.events
    assert len(past.kinds("begin")) == 2, past.events


def test_a_reload_is_no_gap_and_brings_the_rules_anew(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    set_relays(scene, daemon, 5)
    off = dict(ROOM, Record="off")
    other = item("other", RELAY + "/sensed.BYTE", Record="interval 0.5, raw", Scale=raw("2"))
    daemon.config.write_text(text(scene, RELAYS, off, other))
    daemon.signal(signal.SIGHUP)
    until(lambda: "recording 2 of 3" in recorder.log(), 20, "the reload is seen")
    until(lambda: scene.get(daemon, "other") == "500", 20, "the new one is good")
    begun, values = boot(), list(range(6, 40))
    for value in values:
        set_relays(scene, daemon, value)
    recorded(scene, "relays", str(values[-1]))
    recorded(scene, "other", str(2 * (255 - values[-1])))
    took = boot() - begun
    assert recorder.stop() == 0
    past = Past(scene)
    assert distinct(past.good("relays"))[0] == "5" and past.good("relays")[-1] == "39", past.signals
    known = [(value, rest) for _, value, rest in past.signals["relays"]]
    assert (None, "owsd lost") not in known and not past.kinds("gap"), past.signals
    # what is pulled low by the relays, twice as much by Scale; the newest of each half second
    sensed = [str(2 * (255 - value)) for value in [5, *values]]
    kept = distinct(past.good("other"))
    assert set(kept) <= set(sensed) and kept[-1] == sensed[-1], past.signals
    assert 2 <= len(kept) <= took / 0.5 + 3, (took, past.signals)
    assert [float(raw) * 2 for raw in distinct(past.good("other_Raw"))] == [float(v) for v in kept]
    assert past.signals["room"][-1][1] is None, past.signals


def test_a_history_goes_on_over_another_name_and_another_chip(scene):
    config = text(scene)
    with (scene.path / "house.sim").open("a") as wire:
        wire.write("DS18B20 28.A0B1C2000002 temperature 23.5\n")
    daemon = scene.owsd(config)
    recorder = record(scene, daemon)
    recorded(scene, "room", "21.5")
    moved = item("hall", "/28.A0B1C2000002/temperature", Identity=SENSOR + "/temperature")
    for signals, value in ((dict(ROOM, Name="hall"), "21.5"), (moved, "23.5")):
        daemon.config.write_text(text(scene, signals))
        daemon.signal(signal.SIGHUP)
        recorded(scene, "hall", value)
    assert recorder.stop() == 0
    past = Past(scene)
    assert distinct(past.good("hall")) == ["21.5", "23.5"] and set(past.signals) == {
        "hall", "relays", "title"}, past.signals
    trend = ("trend", "-d", scene.path / "history", "--since", "5m", "--csv")
    now, old = (scene.owsctl(daemon, *trend, name) for name in ("hall", "room"))
    assert old.returncode == 0 and old.stdout == now.stdout and "23.5" in old.stdout, old
    # and what the recorder has not written yet
    daemon.config.write_text(text(scene, dict(moved, Name="attic")))
    daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(daemon, "attic"), 20, "it is renamed")
    new = scene.owsctl(daemon, *trend, "attic")
    assert new.returncode == 0 and new.stdout == now.stdout.replace("hall", "attic"), new


def test_it_waits_for_an_owsd_and_tells_what_is_wrong_with_its_command_line(scene):
    config = scene.file("late.rio", text(scene))
    name = scene.name()
    recorder = scene.start([RECORDER, "-n", name, "-c", config, "-d", scene.path / "history"])
    until(lambda: "waiting for it" in recorder.log(), 20, "it waits")
    daemon = scene.owsd(config, name=name)
    until(lambda: "recording 3 of 3" in recorder.log(), 20, "it records")
    recorded(scene, "room", "21.5")
    assert recorder.stop() == 0
    assert Past(scene).good("room") == ["21.5"]
    broken = scene.file("broken.rio", text(scene, dict(ROOM, Record="sometimes")))
    done = scene._run([RECORDER, "-c", broken], 20)
    assert done.returncode == 2 and re.search(r"broken\.rio:\d+:\d+: error: Record", done.stderr), done
    assert scene.owsd_once("-c", broken, "--check").returncode == 2
    done = scene._run([RECORDER, "--nothing"], 20)
    assert done.returncode == 2 and done.stderr.startswith("owsd-recorder: "), done
    done = scene._run([RECORDER, "-V"], 20)
    assert done.returncode == 0 and re.fullmatch(r"owsd-recorder \d+\.\d+\.\d+\n", done.stdout), done


def test_trend_draws_and_lists_what_was_recorded(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    for value in (1, 2, 9):
        set_relays(scene, daemon, value)
        recorded(scene, "relays", str(value))
    for name, value in (("room", "21.5"), ("title", '"DS18B20"')):
        recorded(scene, name, value)
    assert recorder.stop() == 0
    trend = ("trend", "-d", scene.path / "history", "--since", "1m")
    done = scene.owsctl(daemon, *trend, "relays", "room")
    lines = done.stdout.splitlines()
    assert done.returncode == 0 and lines[0] == "relays", done
    assert lines[1].split()[0] == "9" and lines[8].split()[0] == "1", done
    assert any("\u2581" <= c <= "\u2588" for c in lines[1]), done
    assert lines[12] == "room (°C)" and len(lines) > 20, done
    # one value all the time: what nobody recorded is blank above the line, too
    bars, line = lines[13:21], lines[21]
    known = {i for i, c in enumerate(line) if c == "─"}
    drawn = {i for bar in bars for i, c in enumerate(bar) if "\u2581" <= c <= "\u2588"}
    assert known and drawn == known, done
    done = scene.owsctl(daemon, *trend, "--csv", "relays", "title")
    rows = list(csv.DictReader(done.stdout.splitlines()))
    good = [(row["name"], row["value"]) for row in rows if row["quality"] == "good"]
    assert good == [("relays", "1"), ("relays", "2"), ("relays", "9"), ("title", "DS18B20")], done
    assert all(not row["value"] for row in rows if row["quality"] == "recorder stopped"), done
    records = json.loads(scene.owsctl(daemon, "--json", *trend, "relays").stdout)[0]["records"]
    assert [r["value"] for r in records if r.get("quality") == "good"] == [1, 2, 9], records
    assert records[-1]["value"] is None and records[-1]["reason"] == "recorder stopped", records
    points = scene.owsctl(daemon, *trend, "--influx", "relays", "room").stdout.splitlines()
    room = [re.fullmatch(rf"ows,identity={SENSOR}/temperature,instance={daemon.name},signal=room,unit=°C value=21\.5 \d{{19}}", p)
            for p in points[3:]]
    assert [p.split()[1] for p in points[:3]] == ["value=1", "value=2", "value=9"] and all(room)
    assert len(room) == 1, points
    # a part of it: up to the second value, and from there on
    times = [r["time"] for r in records if r.get("quality") == "good"]
    whole = datetime.datetime.fromisoformat(times[0]).astimezone().replace(microsecond=0)
    begin, end = (format(whole + datetime.timedelta(seconds=n), "%Y-%m-%dT%H:%M:%S") for n in (-60, 0))
    for span, some in ((("-s", begin, "-u", end), False), (("-s", end, "--until", "0.001"), True)):
        listed = scene.owsctl(daemon, "--json", *trend[:3], *span, "relays")
        assert listed.returncode == 0, listed
        part = [r["value"] for r in json.loads(listed.stdout)[0]["records"] if r.get("quality") == "good"]
        assert part == ([1, 2, 9] if some else []), (span, listed)
    for words in (("nothing",), ("title",), ("-s", "soon", "relays"), (), ("-u", "2m", "relays"),
                  ("-u", "then", "relays")):
        done = scene.owsctl(daemon, *trend, *words)
        assert done.returncode in (1, 2) and done.stderr.startswith("owsctl: "), done


def test_trend_and_journal_find_the_directory_of_the_configuration(scene):
    owsdtest.need(RECORDER)
    kept = scene.path / "kept"
    daemon = scene.owsd(text(scene, Directory=json.dumps(str(kept))))
    recorder = scene.start([RECORDER, "-n", daemon.name, "-c", daemon.config])
    until(lambda: "recording " in recorder.log(), 20, "it records")
    set_relays(scene, daemon, 5)
    recorded(scene, "relays", "5", kept)
    assert recorder.stop() == 0
    done = scene.owsctl(daemon, "trend", "--csv", "-s", "5m ago", "relays")
    assert done.returncode == 0 and ',"relays",5,' in done.stdout, done
    entries = json.loads(scene.owsctl(daemon, "--json", "journal", "-s", "today", "relays").stdout)
    assert [entry["value"] for entry in entries] == [5], entries
    daemon.kill()
    scene.owsd(text(scene), name=daemon.name)  # that of another owsd is not asked for
    done = scene.owsctl(daemon, "trend", "--csv", "relays")
    assert done.returncode == 1 and str(kept) not in done.stderr, done


def test_the_journal_is_one_over_a_restart_and_without_owsd(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    journal = ("journal", "-d", scene.path / "history")

    def commands(*words):
        done = scene.owsctl(daemon, "--json", *journal, *words)
        assert done.returncode == 0, done
        return [(e["value"], e["by"]["program"]) for e in json.loads(done.stdout)
                if e["journal"] == "commands"]

    for value in (1, 2):
        set_relays(scene, daemon, value)
        owsdtest.worked(daemon.name, 1.1)  # owsd enters one command a second
    until(lambda: len(Past(scene).kinds("command")) == 2, 20, "both are on the disk")
    # in memory and on the disk, each once
    assert commands("relays") == [(1, "owsctl"), (2, "owsctl")]
    assert scene.owsctl(daemon, *journal, "room").stdout.count("high raised") == 1
    daemon.stop()
    until(lambda: "owsd is lost" in recorder.log(), 20, "the end is seen")
    again = scene.owsd(daemon.config, name=daemon.name)
    until(lambda: recorder.log().count("recording ") == 2, 20, "it records again")
    set_relays(scene, again, 7)
    every = [(1, "owsctl"), (2, "owsctl"), (7, "owsctl")]
    # what the new one took is in its memory, and perhaps on the disk
    assert [c for c in commands("relays") if c[0] != 2][-1] == every[-1]
    set_by_users = [c for c in commands("relays") if c[1] == "owsctl"]
    assert set_by_users == every, set_by_users
    assert commands("-c", "1", "relays") == every[-1:]
    until(lambda: len([e for e in Past(scene).kinds("command") if e[-1] == "owsctl"]) >= 3, 20,
          "the last one is on the disk")
    assert [c for c in commands("relays") if c[1] == "owsctl"] == every
    assert recorder.stop() == 0
    again.stop()
    rows = scene.owsctl(again, *journal, "relays").stdout.splitlines()
    assert sum(" set " in row for row in rows) == 3, rows
    # no owsd of that name has ever run: the disk alone has them
    done = scene._run([owsdtest.OWSCTL, "-n", scene.name(), "--json", *journal, "relays"], 20)
    assert done.returncode == 0 and not done.stderr, done
    alone = [(e["value"], e["number"]) for e in json.loads(done.stdout) if e["by"]]
    assert alone == [(1, None), (2, None), (7, None)], done
    for words, status, why in ((("nothing",), 1, "the history has no signal nothing"),
                               (("-s", "soon"), 2, "-s soon: expected a time"),
                               (("-f",), 1, "has run here"),
                               (("-d", scene.path / "none"), 1, "No such file")):
        done = scene._run([owsdtest.OWSCTL, "-n", scene.name(), *journal, *words], 20)
        assert done.returncode == status and why in done.stderr, (words, done)


def test_the_example_program_reads_the_same(scene):
    example = BUILD / "examples/past"
    owsdtest.need(example)
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    for value in (1, 9):
        set_relays(scene, daemon, value)
        recorded(scene, "relays", str(value))  # a busy machine keeps the newest of two alone
    time.sleep(1.1)  # the programs begin with whole seconds of the clock
    assert recorder.stop() == 0
    time.sleep(1)  # and end with them
    done = scene._run([example, "relays", "1", scene.path / "history"], 20)
    assert done.returncode == 0 and not done.stderr, done
    lines = [line.split("  ", 1)[1] for line in done.stdout.splitlines()]
    points, commands = lines[:24], lines[24:]
    good = [p for p in points if p != "no good value, not known throughout"]
    # the values may stand at both sides of an edge of two spans
    assert good in (["1 to 9, not known throughout"], ["1 to 1, not known throughout",
                    "9 to 9, not known throughout"], ["1 to 1, not known throughout",
                    "1 to 9, not known throughout"]), done
    assert commands == ["1 by owsctl", "9 by owsctl"], done
    done = scene._run([example, "nothing", "1", scene.path / "history"], 20)
    assert done.returncode == 1 and done.stderr == "nothing: No such file or directory\n", done
    done = scene._run([example, "relays", "1", scene.path / "no-history"], 20)
    assert done.returncode == 1 and "cannot open the history" in done.stderr, done


def test_python_reads_the_same(scene):
    faulty.not_sanitized("Python loads the library, and the sanitizer has to be the first")
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    begun = time.time_ns()
    for value in (1, 9):
        set_relays(scene, daemon, value)
        recorded(scene, "relays", str(value))  # a busy machine keeps the newest of two alone
    recorded(scene, "title", '"DS18B20"')
    assert recorder.stop() == 0
    ended = time.time_ns() + 10**9
    code = scene.file("past.py", f"""
import sys
if {{without}}:
    sys.modules["numpy"] = None
import ows
with ows.History(directory={str(scene.path / "history")!r}) as h:
    print(sorted(h.names()), h.info("relays")[1:5])
    r = h.records("relays", 0, {ended})
    last = r.value[-1]
    print([i for i in r.integer if i is not None][-2:], bool(r.known[-1]), bool(last == last))
    p = h.points("relays", {begun - 10**9}, {ended}, 2)
    print(len(p.gap), max(x for x in p.max if x == x), all(p.gap))
    print([t for t in h.records("title", 0, {ended}).text if t])
    print([(e.name, e.value, e.program) for e in h.events(0, {ended}, [ows.HISTORY_COMMAND])])
    print(h.span() is not None)
    print(*{{type(column).__name__ for column in (*r, *p)}})
    if not isinstance(p.max, list):
        print(*(column.dtype.name for column in (*r, *p)))
        good = r.value[r.known & (r.quality >= ows.Q_GOOD)]
        print(good.min(), good.max(), good.size == sum(i is not None for i in r.integer))
        none = h.records("title", 5, 6)
        print(none.value.shape, none.value.dtype.name)
        try:
            import pandas
        except ImportError:
            pass
        else:
            frame = r.frame()
            print(*frame.dtypes.index, frame.value.max(), frame.index.tz, p.frame().index.name)
    kept = ows.history("relays", 3600, directory={str(scene.path / "history")!r})
    print([i for i in kept.integer if i is not None][-2:], list(kept.time_ns) == list(r.time_ns))
    drawn = ows.history("relays", 3600, n=7, directory={str(scene.path / "history")!r})
    print(len(drawn.mean), max(x for x in drawn.max if x == x))
    for call in (lambda: h.info("none"), lambda: h.points("room", 5, 5, 1)):
        try:
            call()
        except (KeyError, OSError) as e:
            print(type(e).__name__)
try:
    h.names()
except ValueError as e:
    print(e)
try:
    ows.History(directory="/no-history")
except OSError as e:
    print(e.strerror)
""".replace("{without}", "len(sys.argv) > 1"))
    has_numpy, has_pandas = (scene._run(["python3", "-c", f"import {module}"], 60).returncode == 0
                             for module in ("numpy", "pandas"))
    for arguments in ((), ("without",)):
        done = scene._run(["env", f"PYTHONPATH={owsdtest.PYTHON}",
                           "PYTHONDONTWRITEBYTECODE=1", "python3", code, *arguments], 30)
        assert done.returncode == 0 and not done.stderr, done
        lines = done.stdout.splitlines()
        assert lines[0] == "['relays', 'room', 'title'] ('', 2, True, -1)", done
        assert lines[1] == "[1, 9] False False", done
        assert lines[2] in ("2 9.0 True", "2 9.0 False"), done
        assert lines[3] == "['DS18B20']", done
        assert lines[4] == "[('relays', 1, 'owsctl'), ('relays', 9, 'owsctl')]", done
        assert lines[5] == "True", done
        rest = lines[7:]
        if has_numpy and not arguments:
            assert lines[6:10] == [
                "ndarray",
                "int64 float64 object object bool uint8 uint8 bool int64 int64 float64 float64 "
                "float64 float64 int64 int64 uint32 uint8 uint8 bool bool",
                "1.0 9.0 True", "(0,) float64"], done
            rest = lines[10:]
        else:
            assert lines[6] == "list", done
        if has_pandas and not arguments:
            assert rest.pop(0) == ("value integer text known quality reason trusted 9.0 UTC time"), done
        assert rest == ["[1, 9] True", "7 9.0", "KeyError", "OSError", "the history is closed",
                        "No such file or directory"], done


def test_under_the_units_filter_it_does_all_that_it_does(scene):
    unit = SOURCE / "board/systemd/owsd-recorder@.service"
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon, "-v", prefix=sandbox.command(unit))
    set_relays(scene, daemon, 3)
    recorded(scene, "room", "21.5")
    recorded(scene, "relays", "3")
    assert recorder.stop() == 0
    assert "ot permitted" not in recorder.log(), recorder.log()
    assert Past(scene).good("relays") == ["3"]


def test_no_call_that_it_makes_is_forbidden(scene):
    if not shutil.which("strace"):
        owsdtest.skip("strace is not installed")
    unit = SOURCE / "board/systemd/owsd-recorder@.service"
    # SQLite gives its files to the owner of the database where it runs as root
    allowed = sandbox.calls(unit) | {"execve", "fchown"}
    daemon = scene.owsd(text(scene))
    trace = scene.path / "trace"
    recorder = record(scene, daemon, prefix=("strace", "-f", "-qq", "-o", trace))
    recorded(scene, "room", "21.5")
    with open(f"/proc/{recorder.pid}/task/{recorder.pid}/children", encoding="ascii") as children:
        os.kill(int(children.read()), signal.SIGTERM)
    assert recorder.wait(20) == 0
    calls = set(re.findall(r"^(?:\d+ +)?(?:<\.\.\. )?(\w+)\(", trace.read_text(errors="replace"), re.M))
    assert len(calls) > 20 and "pwrite64" in calls, calls
    assert not calls - allowed, calls - allowed


if __name__ == "__main__":
    owsdtest.main(at_once=1)
