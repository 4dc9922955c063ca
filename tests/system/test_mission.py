#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""docs/examples/mission.py: the mission of a logger that an owsd serves."""

import json
import os
import re
import subprocess
import sys

import owsdtest
import peer
from owsdtest import OWSCTL, SOURCE, until

PROGRAM = SOURCE / "docs/examples/mission.py"

WIRE = """
chip DS2482-100 0x18
DS1923  41.000000000001 as fridge  temperature 4.5 humidity 60
DS1921G 21.000000000001 as crate   temperature 12
DS18B20 28.000000000001 as room
"""
FRIDGE, CRATE, ROOM = "41.000000000001", "/21.000000000001", "28.000000000001"


def run(target, *words):
    return subprocess.run([sys.executable, PROGRAM, "-t", target, *words], capture_output=True, text=True,
                          env={**os.environ, "OWSCTL": str(OWSCTL)}, timeout=120, check=False)


def served(scene):
    """owsd on the simulated loggers; how they are asked."""
    port = owsdtest.free_port()
    scene.owsd(None, "-t", f"sim:{scene.file('loggers.sim', WIRE)}", "-l", f"127.0.0.1:{port}")

    def mission(*words):
        return run(f"127.0.0.1:{port}", *words)

    def write(path, value):
        return subprocess.run([OWSCTL, "-t", f"127.0.0.1:{port}", "write", path, value],
                              capture_output=True, text=True, timeout=20, check=False)
    mission.set, mission.target = write, f"127.0.0.1:{port}"
    until(lambda: mission("status", FRIDGE).returncode == 0, 20, "the logger is found")
    return mission


def status(mission, device):
    done = mission("status", "--json", device)
    assert done.returncode == 0, done
    return json.loads(done.stdout)


def test_a_mission_is_started_followed_stopped_and_downloaded(scene):
    mission = served(scene)
    now = status(mission, FRIDGE)
    assert now["running"] is False and now["begin"] is None, now
    done = mission("start", "-i", "1", FRIDGE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", ""), done
    now = until(lambda: (s := status(mission, FRIDGE))["logged"] >= 3 and s, 20, "it logs")
    assert now["running"] is True and now["interval"] == 1 and now["begin"] <= now["clock"], now
    assert mission("stop", FRIDGE).returncode == 0
    now = status(mission, FRIDGE)
    assert now["running"] is False and now["logged"] == now["samples"], now
    lines = mission("download", FRIDGE).stdout.splitlines()
    assert lines[0] == "time,temperature,humidity", lines
    assert len(lines) == 1 + now["logged"], (lines, now)
    for line in lines[1:]:
        when, temperature, humidity = line.split(",")
        assert re.fullmatch(r"20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ", when), line
        assert temperature == "4.5" and abs(float(humidity) - 60) < 0.1, line
    assert lines[1].startswith(now["begin"]), (lines, now)
    samples = json.loads(mission("download", "--json", FRIDGE).stdout)
    assert len(samples) == now["logged"] and samples[0]["temperature"] == 4.5, samples
    assert [s["time"] for s in samples] == sorted({s["time"] for s in samples}), samples


def test_a_download_has_what_was_logged_since_the_last_one(scene):
    """The page that was read then is in the caches, without the samples that came into it since."""
    mission = served(scene)
    assert mission.set("/settings/timeout/volatile", "60").returncode == 0
    assert mission("start", "-i", "1", FRIDGE).returncode == 0
    for least in (2, 5, 8):
        until(lambda: status(mission, FRIDGE)["logged"] >= least, 20, "it logs")
        lines = mission("download", FRIDGE).stdout.splitlines()[1:]
        assert len(lines) >= least, lines
        assert {line.split(",")[1] for line in lines} == {"4.5"}, lines


def test_the_clock_is_set_and_the_interval_of_a_thermochron_is_whole_minutes(scene):
    mission = served(scene)
    for wrong in ("59", "90", "15360", "0"):
        done = mission("start", "-i", wrong, CRATE)
        assert done.returncode == 2 and "60 to 15300 seconds" in done.stderr, done
    done = mission("start", "-o", "-i", "120", CRATE)
    assert done.returncode == 0, done
    text = mission("status", CRATE).stdout
    assert re.search(r"^running +yes$", text, re.M), text
    assert re.search(r"^interval +120 s$", text, re.M), text
    assert re.search(r"^rollover +yes$", text, re.M), text
    assert re.search(r"^clock +20[2-9]\d-", text, re.M), text
    assert mission("download", CRATE).stdout == "time,temperature\n"


def test_a_mission_that_runs_is_not_started_anew(scene):
    mission = served(scene)
    assert mission("start", "-i", "60", FRIDGE).returncode == 0
    done = mission("start", "-i", "1", FRIDGE)
    assert done.returncode == 1 and "a mission runs; stop it first" in done.stderr, done
    assert status(mission, FRIDGE)["interval"] == 60


class Spoiled(peer.Peer):
    """An owserver with a logger: whatever is written to the one path, another program's value is in
    it at the start."""
    def __init__(self, path, theirs):
        super().__init__({f"{CRATE}/{name}": "0" for name in (
            "clock/udate", "clock/running", "mission/delay", "mission/rollover", "mission/enable",
            "mission/clear", "mission/frequency", "mission/running")} | {f"{CRATE}/family": "21"})
        self.path, self.theirs = path, theirs

    def _answer(self, r):
        r = r._replace(path=r.path.replace("/uncached/", "/"))
        if r.kind == peer.WRITE and r.path == self.path:
            r = r._replace(data=self.theirs)
        if r.kind == peer.WRITE and r.path == f"{CRATE}/mission/frequency":
            self[f"{CRATE}/mission/running"] = "1"
        return super()._answer(r)


def test_a_start_that_another_program_spoiled_is_an_error(_scene):
    """Both have seen that none runs; the settings of the other are in the mission that began."""
    for setting, theirs, words in (("frequency", b"7", "an interval of 420 s, without rollover"),
                                   ("rollover", b"1", "an interval of 60 s, with rollover"),
                                   ("delay", b"0", None)):
        server = Spoiled(f"{CRATE}/mission/{setting}", theirs)
        done = run(server.target, "start", "-i", "60", CRATE)
        server.down()
        assert done.returncode == (1 if words else 0), done
        assert words is None or words in done.stderr, done


def test_a_mission_starts_only_where_the_time_is_known(scene):
    """A board without a battery has the time of its last end, or of 1970, until it hears of it."""
    mission = served(scene)
    early = "import runpy, sys, time; time.time = lambda: 1e9; sys.argv[:] = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
    for device in (FRIDGE, CRATE):
        done = subprocess.run([sys.executable, "-c", early, PROGRAM, "-t", mission.target, "start", "-i", "60", device],
                              capture_output=True, text=True, env={**os.environ, "OWSCTL": str(OWSCTL)}, timeout=60,
                              check=False)
        assert done.returncode == 1 and "the clock of this computer is not set" in done.stderr, done
        assert status(mission, device)["running"] is False


def test_what_is_no_logger_and_what_is_no_word_is_refused(scene):
    mission = served(scene)
    done = mission("status", ROOM)
    assert done.returncode == 1 and "no logger" in done.stderr, done
    for words in (["begin", FRIDGE], ["status"], ["status", FRIDGE, CRATE],
                  ["stop", "-i", "1", FRIDGE], ["start", FRIDGE]):
        done = mission(*words)
        assert done.returncode == 2 and done.stdout == "", (words, done)


if __name__ == "__main__":
    owsdtest.main()
