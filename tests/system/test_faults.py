#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a target, a consumer or the system can do to owsd, and that it survives it."""

import json
import os
import random
import time

import byhand
import owsdtest
import peer
from owsdtest import open_files, raw, settled, until

import ows  # of owsdtest.PYTHON

ROOM = "/28.AABBCCDDEE00/temperature"
HALL = "/28.AABBCCDDEE01/temperature"
RELAY = "/29.AABBCCDDEE02/PIO.BYTE"


def lying_peer():
    return peer.Peer({ROOM: "       21.5", HALL: "      19.25", RELAY: "           0"})


def house(server, timeout=30, **driver):
    """timeout: short where silence is to be noticed; elsewhere a slow machine is no fault."""
    return owsdtest.rio(server.target, [
        dict(Name="room", Path=ROOM, Type=raw("double"), IO=raw("input")),
        dict(Name="hall", Path=HALL, Type=raw("double"), IO=raw("input")),
        dict(Name="relay", Path=RELAY, Type=raw("byte"), IO=raw("output")),
    ], Timeout=timeout, Period=0.05, MaxRetries=1, AlarmPeriod=0.05, **driver)


def signals(scene, daemon):
    done = scene.owsctl(daemon, "--json", "list")
    assert done.returncode == 0, done.stderr
    return {s["name"]: s for s in json.loads(done.stdout)}


def qualities(scene, daemon):
    s = signals(scene, daemon)
    return s["room"]["quality_code"], s["hall"]["quality_code"]


def good(scene, daemon):
    return qualities(scene, daemon) == (0xC0, 0xC0)


def counter(scene, daemon, name):
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return next(c["value"] for c in stats["counters"] if c["name"] == name)


def test_every_way_of_losing_the_target_is_survived(scene):
    """Bad within Timeout, the value kept, good again by itself, no descriptor more."""
    with lying_peer() as server:
        daemon = scene.owsd(house(server, timeout=1))
        until(lambda: good(scene, daemon), 5, "good at first")
        before = settled(lambda: len(open_files(daemon)))
        for mode in ("kill", "close", "reset", "garbage", "negative", "huge", "version",
                     "endless", "flood", "wrong", "less", "hang", "stall", "accept_close", "dead"):
            server.mode = mode
            if mode in ("accept_close", "dead"):
                server.plan.append("close")  # they are about new connections
            until(lambda: qualities(scene, daemon)[0] != 0xC0, 10, f"{mode}: bad")
            assert signals(scene, daemon)["room"]["value"] == 21.5, mode
            server.plan.clear()
            server.mode = "normal"
            until(lambda: good(scene, daemon), 15, f"{mode}: good again")
            until(lambda: len(open_files(daemon)) == before, 2, f"{mode}: descriptors {before}")
        assert daemon.running()
        assert counter(scene, daemon, "bus_keepalive_floods") >= 1
        owsdtest.logged(daemon, "keep-alives without end")


def test_what_no_chip_can_say_is_never_good(scene):
    """A lying owserver's word is worth what the chip of that family can measure."""
    lies = ["-999.9", "4095", "-127", "1e300", "85", "127.938", "127.94", "127.9", "128",
            "21.5abc", "21,5", "0x15", "", " ", "nan", "inf"]
    with lying_peer() as server:
        daemon = scene.owsd(house(server))
        until(lambda: good(scene, daemon), 5, "good at first")
        for lie in lies:
            server[ROOM] = lie
            until(lambda: qualities(scene, daemon)[0] != 0xC0, 10, f"{lie}: bad")
            room, hall = (signals(scene, daemon)[name] for name in ("room", "hall"))
            assert room["value"] == 21.5 and hall["good"], (lie, room, hall)
            if lie in ("-999.9", "4095", "-127", "1e300"):
                assert room["error"] == "a value out of the chip's range", room
            server[ROOM] = "21.5"
            scene.owsctl(daemon, "set", "room_ReadEnable", "0")  # ends the waiting for its turn
            scene.owsctl(daemon, "set", "room_ReadEnable", "1")
            until(lambda: good(scene, daemon), 15, f"{lie}: good again")
        assert counter(scene, daemon, "out_of_range") >= 8
        assert counter(scene, daemon, "target_failures") == 0


def test_silence_is_a_failure_of_the_target_and_turns_all_bad_at_once(scene):
    with lying_peer() as server:
        daemon = scene.owsd(house(server, timeout=1))
        until(lambda: good(scene, daemon), 5)
        server.mode = "hang"
        before = server.connections
        until(lambda: server.connections > before, 10, "the connection is given up")
        asked = len(server.requests)
        # what is asked now, is asked after the failure; and only one of the two was asked before it
        until(lambda: len(server.requests) > asked, 10, "it is asked again")
        assert qualities(scene, daemon) == (0x18, 0x18)
        assert signals(scene, daemon)["relay"]["quality_code"] in (0x18, 0x20)


def test_a_slow_answer_with_keep_alives_is_an_error_of_that_signal_only(scene):
    with lying_peer() as server:
        daemon = scene.owsd(house(server, timeout=3))
        until(lambda: good(scene, daemon), 5)
        server.ways[ROOM] = "alive"
        until(lambda: qualities(scene, daemon)[0] != 0xC0, 20, "bad")
        count = signals(scene, daemon)["hall"]["count"]
        until(lambda: signals(scene, daemon)["hall"]["count"] > count, 20, "the other is read")
        assert qualities(scene, daemon) == (0x0C, 0xC0)
        assert counter(scene, daemon, "target_failures") == 0, "the target itself never failed"
        server.ways.clear()
        until(lambda: good(scene, daemon), 10, "good again")


def test_a_refused_persistence_costs_speed_and_nothing_else(scene):
    with lying_peer() as server:
        server.mode = "refuse"
        daemon = scene.owsd(house(server))
        until(lambda: good(scene, daemon), 5)
        connections = server.connections
        until(lambda: server.connections > connections + 10, 10, "it connects for each request")
        assert good(scene, daemon)
        assert counter(scene, daemon, "target_failures") == 0


def test_fragments_and_trailing_bytes_are_read_right(scene):
    with lying_peer() as server:
        server.mode = "fragments"
        daemon = scene.owsd(house(server))
        until(lambda: good(scene, daemon), 10)
        assert signals(scene, daemon)["hall"]["value"] == 19.25


def test_a_write_is_neither_lost_nor_repeated_when_the_target_goes(scene):
    with lying_peer() as server:
        daemon = scene.owsd(house(server))
        until(lambda: good(scene, daemon), 5)
        server.down()
        until(lambda: 0x18 in qualities(scene, daemon), 5)
        assert scene.owsctl(daemon, "set", "relay", "5").returncode == 0
        server.up()
        until(lambda: server.writes, 15, "written after the return")
        reads = server.reads(ROOM)
        until(lambda: server.reads(ROOM) > reads + 5, 15, "the lane goes round and round")
        assert [w for w in server.writes] == [(RELAY, b"5")], server.writes


def test_the_genuine_owserver_killed_hanging_and_started_again(scene):
    server = scene.owserver(mock=["28", "29"])
    path = next(d for d in server.devices(0) if d.startswith("/28.")) + "/temperature"
    # long enough for an owserver that is only slow: each reconnection is to have its reason
    config = owsdtest.rio(server.target, [
        dict(Name="room", Path=path, Type=raw("double"), IO=raw("input"))], Timeout=4, Period=0.02)
    daemon = scene.owsd(config)
    until(lambda: scene.get(daemon, "room"), 5)
    before = settled(lambda: len(open_files(daemon)))
    for _ in range(5):
        server.kill()
        until(lambda: scene.owsctl(daemon, "get", "room").returncode == 3, 5, "bad")
        server = scene.again(server)
        until(lambda: scene.get(daemon, "room"), 15, "good again")
    server.freeze()
    until(lambda: scene.owsctl(daemon, "get", "room").returncode == 3, 5, "hanging: bad")
    server.thaw()
    until(lambda: scene.get(daemon, "room"), 15, "good again")
    reconnects = int(until(lambda: scene.get(daemon, "_RECONNECTS"), 10))
    assert reconnects == 6, (reconnects, daemon.log())
    until(lambda: len(open_files(daemon)) == before, 10, f"descriptors {before}")


def test_a_target_that_was_stopped_with_owsd_was_not_silent(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices(0)[0] + "/temperature"
    daemon = scene.owsd(owsdtest.rio(server.target, [
        dict(Name="room", Path=path, Type=raw("double"), IO=raw("input"), Uncached=raw("on"))], Timeout=1, Period=0.02))
    until(lambda: scene.get(daemon, "room"), 20)
    for _ in range(3):
        server.freeze()
        time.sleep(0.1)  # a request is on its way
        daemon.freeze()
        time.sleep(1.5)  # longer than Timeout
        daemon.thaw()
        server.thaw()
        count = signals(scene, daemon)["room"]["count"]
        until(lambda: signals(scene, daemon)["room"]["count"] > count, 20, "it is read on")
    assert "no sign of life" not in daemon.log() and "no answer" not in daemon.log(), daemon.log()
    assert scene.get(daemon, "_RECONNECTS") == "0"


def segment(daemon, kind):
    return owsdtest.segment(daemon.name, kind)


def good_or_disabled(scene, daemon):
    """That an input is not read can be commanded too, if it is a rare chance of rubbish."""
    return all(quality == 0xC0 or scene.get(daemon, name + "_ReadEnable") == "0"
               for name, quality in zip(("room", "hall"), qualities(scene, daemon)))


def test_rubbish_in_a_controllers_memory_harms_nobody(scene):
    seed = random.randrange(1 << 32)
    print("seed", seed)
    rng = random.Random(seed)
    with lying_peer() as server:
        daemon = scene.owsd(house(server))
        until(lambda: good(scene, daemon), 5)
        with byhand.Controller(daemon.name) as controller:
            for _ in range(200):
                controller.scribble(rng)
                time.sleep(0.005)  # rubbish comes at this pace
        assert daemon.running()
        # what rubbish can still command is what its type can hold
        for path, data in server.writes:
            assert path == RELAY and 0 <= int(data) <= 255, (path, data)
        until(lambda: good_or_disabled(scene, daemon), 5, "inputs live")
        # and the next one takes over what it finds without falling over it
        daemon.kill()
        again = scene.owsd(daemon.config, name=daemon.name)
        until(lambda: good_or_disabled(scene, again), 10, "inputs live again")


def test_a_period_longer_than_the_watchdogs_time_starves_no_watchdog(scene):
    with lying_peer() as server:
        text = owsdtest.rio(server.target, [
            dict(Name="room", Path=ROOM, Type=raw("double"), IO=raw("input"))], Period=30)
        daemon = scene.owsd(text, env={"WATCHDOG_USEC": "400000"})
        fed = []

        def often():
            try:
                fed.append(b"WATCHDOG=1" in daemon.notify.recv(4096))
            except OSError:
                pass
            return sum(fed) >= 5
        until(often, 10, "the watchdog is fed")


def test_readers_of_a_killed_owsd_see_whole_samples_that_grow_old(scene):
    with lying_peer() as server:
        daemon = scene.owsd(house(server).replace("Period                  0.05",
                                                  "Period                  0.001"))
        until(lambda: good(scene, daemon), 5)
        h = ows.Ows(daemon.name)
        for _ in range(1000):
            assert h.get("room").value == 21.5
        daemon.kill()
        first = h.get("room")
        assert first.value == 21.5
        until(lambda: h.get("room").age > first.age, 5, "it grows old")
        assert h.get("room").value == 21.5
        until(lambda: (h.get("room").quality & 0xC0) != 0xC0, 5, "not good any more")


def test_a_full_file_system_is_refused_at_start_with_a_reason(scene):
    items = [dict(Name=f"s{i}", Path=f"/28.AABBCCDD{i:04X}/temperature", Type=raw("double"),
                  IO=raw("input")) for i in range(9000)]
    file = scene.file("many.rio", owsdtest.rio("127.0.0.1:1", items))
    name = scene.name()
    done = scene._run(["unshare", "-rm", "sh", "-c",
                       f"mount -t tmpfs -o size=1m tmpfs /dev/shm && OWS_DIR=/dev/shm/owsd exec "
                       f"{owsdtest.OWSD} -n {name} -c {file}"], 20)
    if "unshare" in done.stderr and "full" not in done.stderr:
        owsdtest.skip("no user namespaces: " + done.stderr.strip())
    assert done.returncode == 1, done
    assert "/dev/shm/owsd is full" in done.stderr, done.stderr


def test_a_file_system_that_fills_up_between_two_starts_loses_no_command_of_a_living_program(scene):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS2408 29.A0B1C2000004\n")
    file = scene.file("house.rio", owsdtest.rio(f"sim:{wire}", [
        dict(Name="relays", Path="/29.A0B1C2000004/PIO.BYTE", Type=raw("byte"), IO=raw("output")),
    ]))
    controller = scene.file("controller.py", """
import time
import ows

def opened():
    while True:
        try:
            return ows.Ows("T", control=True)
        except OSError:
            time.sleep(0.05)  # pace

with opened() as s:
    is_set = False
    while True:
        try:
            s.beat(600000)
            if not is_set:
                s.set("relays", 5)
            is_set = True
        except ows.Stale:  # on a machine that is busy even an owsd that lives
            try:
                s.reopen()
            except OSError:
                pass
        time.sleep(0.1)  # pace
""")
    script = scene.file("script", """
        mount -t tmpfs -o size=4m tmpfs /dev/shm || exit 77
        export OWS_DIR=/dev/shm/owsd
        trap 'kill -9 $pid $controller 2>/dev/null' EXIT
        trap 'exit 1' TERM
        start() {
            "$owsd" -n T -c "$1" >>log 2>&1 &
            pid=$!
        }
        reads_5() {
            for i in $(seq 1000); do
                [ "$("$owsctl" -n T get relays 2>&1)" != 5 ] || return 0
                sleep 0.05
            done
            cat log
            exit 2
        }
        start "$1"
        python3 "$2" &
        controller=$!
        reads_5
        kill -9 $pid
        wait $pid
        for i in $(seq 1000); do
            "$owsctl" -n T get relays >/dev/null 2>&1 || break
            sleep 0.05
        done
        cat /dev/zero >/dev/shm/filler 2>/dev/null
        start "$1"
        wait $pid
        echo "full: status $?"
        grep -o '/dev/shm/owsd is full' log
        find /dev/shm -name '*.new'
        rm /dev/shm/filler
        start "$1"
        reads_5
        echo "again: 5"
    """)
    done = scene._run(["unshare", "-rm", "env", f"owsd={owsdtest.with_sim(owsdtest.OWSD, file)}",
                       f"owsctl={owsdtest.OWSCTL}",
                       f"PYTHONPATH={owsdtest.PYTHON}",
                       "sh", script, file, controller], 200)
    if done.returncode == 77 or done.stderr.startswith("unshare"):
        owsdtest.skip("no user namespaces: " + done.stderr.strip())
    assert done.stdout == "full: status 1\n/dev/shm/owsd is full\nagain: 5\n", done


def test_a_file_of_somebody_else_in_the_way_is_named(scene):
    name = scene.name()
    os.makedirs(owsdtest.segment(name, "lock"))
    try:
        done = scene.owsd_once("-n", name, "-c", scene.file("a.rio", "OwsDrv {\n}\n"))
        assert done.returncode == 1 and name in done.stderr, done
    finally:
        os.rmdir(owsdtest.segment(name, "lock"))


if __name__ == "__main__":
    owsdtest.main()
