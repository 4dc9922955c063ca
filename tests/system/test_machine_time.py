#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Clocks that jump, a machine that was suspended, processors that others use, signals in heaps."""

import json
import multiprocessing
import os
import random
import signal
import statistics
import subprocess
import time

import faulty
import owsdtest
from owsdtest import open_files, raw, settled, until

HOUR = 3600
# One degree an hour, of the clock that counts suspend
SLOPE = """chip DS2482-100 0x18
DS18B20 28.A0B1C2000001 as room temperature ramp 0 100 100h
DS2408 29.A0B1C2000004 as board
"""


def sloping(scene, period=0.05, **driver):
    wire = scene.file("slope.sim", SLOPE)
    return owsdtest.rio(f"sim:{wire}", [dict(faulty.ROOM, StaleAfter=5, Path="/28.A0B1C2000001/temperature12"),
                                       faulty.RELAYS], Period=period, Timeout=5, **driver)


def room(scene, daemon, environment):
    """What owsctl says of room, under the same clocks."""
    done = faulty.ctl(scene, daemon, environment, "--json", "get", "room")
    assert done.returncode in (0, 3), done
    value = json.loads(done.stdout)
    return value[0] if isinstance(value, list) else value


def stats(scene, daemon, environment):
    told = json.loads(faulty.ctl(scene, daemon, environment, "--json", "stats").stdout)
    told["counter"] = {c["name"]: c["value"] for c in told["counters"] if c["target"] is None}
    return told


def test_after_a_suspend_no_value_of_before_is_good(scene):
    clock = faulty.Clock(scene)
    environment = clock.env(scene)
    daemon = scene.owsd(sloping(scene), env=environment)
    until(lambda: room(scene, daemon, environment)["good"], 20, "good at first")
    assert faulty.ctl(scene, daemon, environment, "set", "relays", "5").returncode == 0
    for hours in range(1, 8):
        time.sleep(random.random())  # at any moment
        clock.jump(boot=HOUR)
        seen = []

        def of_now():
            told = room(scene, daemon, environment)
            seen.append(told)
            if told["good"]:
                assert told["age"] < 6, (hours, told)
                assert abs(told["value"] - (hours - told["age"] / HOUR)) < 0.3, (hours, told)
            return told["good"]
        until(of_now, 20, f"good after {hours} h")
    until(lambda: faulty.ctl(scene, daemon, environment, "get", "relays").stdout == "5\n", 20,
          "outputs are as commanded")
    told = stats(scene, daemon, environment)
    # boundaries that went by meanwhile are told
    assert told["counter"]["late_periods"] > 6 * HOUR / 0.05, told["counter"]
    assert told["daemon"]["uptime"] > 7 * HOUR, told["daemon"]
    assert daemon.stop() == 0


def test_a_wall_clock_that_is_set_changes_no_age_and_no_period(scene):
    clock = faulty.Clock(scene)
    environment = clock.env(scene)
    daemon = scene.owsd(sloping(scene), env=environment)
    until(lambda: room(scene, daemon, environment)["good"], 20)
    began, begun = stats(scene, daemon, environment), time.monotonic()
    for hours in (-2, 26, -24 * 400, 24 * 800, -1, 0.01):
        clock.jump(wall=hours * HOUR)
        count = room(scene, daemon, environment)["count"]
        for _ in range(3):
            # the least jump is 36 s; what is older than StaleAfter is so because the machine is slow
            told = room(scene, daemon, environment)
            assert told["age"] < 30 and (told["good"] or told["age"] > 5), (hours, told)
        until(lambda: room(scene, daemon, environment)["count"] > count, 20, f"{hours}: goes on")
    ended, took = stats(scene, daemon, environment), time.monotonic() - begun
    assert ended["daemon"]["uptime"] < began["daemon"]["uptime"] + took + 30
    assert ended["counter"]["late_periods"] - began["counter"]["late_periods"] < (took + 30) / 0.05
    assert daemon.stop() == 0


def test_lamps_end_in_time_whatever_the_wall_clock_says(scene):
    for wall in (-HOUR, HOUR):
        clock = faulty.Clock(scene)
        clock.jump(wall=wall)
        daemon = scene.owsd(sloping(scene, HeartbeatLine="nochip/3"), env=clock.env(scene))
        assert daemon.stop() == 0
        assert "stuck" not in daemon.log(), daemon.log()


def uncounted(told, period):
    """Boundaries that are not among the periods: those before the first, those that are just due and,
    if there are such, those that were lost."""
    return told["daemon"]["uptime"] / period - told["counter"]["periods"]


def burn(until_):
    while time.monotonic() < until_:
        pass


def test_beside_busy_processors_the_heart_beats_and_ages_are_honest(scene):
    period = 0.02
    daemon = scene.owsd(sloping(scene, period))
    until(lambda: room(scene, daemon, {})["good"], 20)
    end = time.monotonic() + 4
    burners = [multiprocessing.Process(target=burn, args=(end,)) for _ in range(2)]
    # one look may come between a boundary and its count, or late between the two that it tells
    before = [stats(scene, daemon, {}) for _ in range(9)]
    for process in burners:
        process.start()
    try:
        while time.monotonic() < end:
            told = room(scene, daemon, {})
            assert not told["good"] or told["age"] <= 5.1, told
            here = stats(scene, daemon, {})["daemon"]
            assert here["alive"] == (here["heartbeat_age"] <= 2), here
    finally:
        for process in burners:
            process.join(20)
    missing = statistics.median(uncounted(told, period) for told in before)
    after = []

    def none_is_lost():
        """Each was kept, or is one of the late ones; a second is left for the looks."""
        after[:] = [stats(scene, daemon, {})]
        return abs(uncounted(after[0], period) - missing) <= 1 / period
    until(none_is_lost, 10, lambda: f"no period is lost: {missing} before, {uncounted(after[0], period)} now")
    periods, late = (after[0]["counter"][n] - before[0]["counter"][n] for n in ("periods", "late_periods"))
    assert 0 <= late <= periods and periods > 0, (periods, late)
    print(f"{periods} periods, {late} of them late")
    until(lambda: room(scene, daemon, {})["good"], 20, "good afterwards")


HARMLESS = [signal.SIGWINCH, signal.SIGCONT, signal.SIGURG, signal.SIGCHLD, signal.SIGPIPE]


def test_signals_in_heaps_interrupt_nothing_for_good(scene):
    daemon = scene.owsd(sloping(scene))
    until(lambda: room(scene, daemon, {})["good"], 20)
    count = room(scene, daemon, {})["count"]
    for n in range(3000):
        daemon.signal(HARMLESS[n % len(HARMLESS)])
        if n % 100 == 0:
            daemon.freeze()
            daemon.thaw()
            told = room(scene, daemon, {})
            assert not told["good"] or told["age"] <= 5.1, told
    until(lambda: room(scene, daemon, {})["count"] > count + 2, 20, "it reads on")
    until(lambda: room(scene, daemon, {})["good"], 20)
    assert daemon.stop() == 0


def test_reloads_in_heaps_end_with_the_last_file(scene):
    config = scene.file("house.rio", faulty.house(scene))
    daemon = scene.owsd(config)
    for n in range(60):
        config.with_suffix(".new").write_text(faulty.house(scene, more=n % 2 == 1))
        config.with_suffix(".new").rename(config)
        daemon.signal(signal.SIGHUP)
        time.sleep(random.random() / 50)  # at any moment
    until(lambda: scene.get(daemon, "hall") == "19.5", 20, "the table of the last file")
    fds, reloads = settled(lambda: (len(open_files(daemon)), daemon.log().count("reload:")))
    daemon.signal(signal.SIGHUP)
    until(lambda: daemon.log().count("reload:") > reloads, 10, "it reloads")
    until(lambda: len(open_files(daemon)) == fds, 10, "no descriptor more")
    assert daemon.stop() == 0


def start_without(scene, closed, name):
    config = scene.file("house.rio", faulty.house(scene))
    return scene.start(["sh", "-c", f'exec "$@" {closed}', "sh",
                        owsdtest.with_sim(owsdtest.OWSD, config), "-v", "-v", "-n", name,
                        "-c", config])


def test_closed_standard_streams_are_taken_for_nothing_else(scene):
    for closed in ("2>&-", "<&- >&- 2>&-", "0<&-", ">&-"):
        name = scene.name()
        daemon = start_without(scene, closed, name)
        until(lambda: scene.get(name, "room") == "21.5", 20, f"{closed}: good")
        for fd in (0, 1, 2):
            to = os.readlink(f"/proc/{daemon.pid}/fd/{fd}")
            assert "place" not in to and "anon_inode" not in to and "socket" not in to, (closed, fd, to)
        generation = json.loads(scene.owsctl(name, "--json", "stats").stdout)["daemon"]["generation"]
        daemon.signal(signal.SIGHUP)
        until(lambda: json.loads(scene.owsctl(name, "--json", "stats").stdout)["daemon"]["generation"] >
              generation, 10, f"{closed}: it reloads")
        with open(owsdtest.segment(name, "lock"), "rb") as lock:
            assert lock.read() == f"{daemon.pid}\n".encode()
        until(lambda: scene.get(name, "room") == "21.5", 20, f"{closed}: good again")
        assert daemon.stop() == 0


def test_an_edit_with_a_closed_stderr_writes_no_message_into_the_file(scene):
    text = faulty.house(scene)
    file = scene.file("house.rio", text)
    for words in (["set", "room", "Wrong=1"], ["add", "room", "/x/y"], ["set", "room", "PerFactor=0"]):
        status = subprocess.run(["sh", "-c", 'exec "$@" 2>&- >&-', "sh", owsdtest.OWSCTL, "config", file,
                                 *words], timeout=owsdtest.PATIENCE, check=False).returncode
        assert status != 0, words
        assert file.read_text() == text, words


if __name__ == "__main__":
    owsdtest.main()
