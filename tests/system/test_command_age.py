#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A command has an age: none that is older than two seconds moves an output, whatever held it, and
whoever waits for an answer gets the reason."""

import json
import os
import resource
import socket
import time

import faulty
import owsdtest
import served
from mqtthouse import RELAY, ROOM, SWITCH, House
from owsdtest import free_port, logged, raw, until
from test_mqtt_commands import ON, command, journal, publish, ready
from test_web import RELAYS, Page, text

OLD = "it may have waited for longer than 2 seconds: give it again"
STOP_S = 3


def held(program, give):
    """The program does not run while the command is given, nor for some time after it."""
    program.freeze()
    given = give()
    time.sleep(STOP_S)  # it is stopped for so long
    program.thaw()
    return given


# --- MQTT -----------------------------------------------------------------------------------------

def nothing_moved(house):
    assert scene_value(house) == "0" and "owsd-mqtt" not in journal(house), (house.face.log(), journal(house))


def scene_value(house):
    return house.scene.get(house.daemon, "relay")


def obeys(house):
    """A command of now is carried out."""
    def on():
        command(house, "relay", "on")
        return scene_value(house) == "1"
    until(on, 20, lambda: f"commands are taken again: {house.face.log()}", step=0.5)


def refused(house):
    logged(house.face, f"command to \"relay\" refused: {OLD}")
    nothing_moved(house)
    obeys(house)


def test_what_came_while_owsd_mqtt_was_stopped_moves_nothing(scene):
    house = ready(scene)
    house.set("relay", 0)
    held(house.face, lambda: command(house, "relay", "on"))
    refused(house)


def test_nor_does_what_the_broker_holds_for_it(scene):
    # more than it sends before the first of them is acknowledged
    house = ready(scene, lines=("allow_anonymous true", "max_inflight_messages 2"))
    house.set("relay", 0)
    held(house.face, lambda: [command(house, "relay", "on") for _ in range(12)])
    logged(house.face, f"command to \"relay\" refused: {OLD}")
    until(lambda: house.face.log().count("connected to") >= 2, 20, lambda: house.face.log())
    nothing_moved(house)
    obeys(house)


def test_nor_what_came_before_the_broker_was_killed(scene):
    house = ready(scene)
    house.set("relay", 0)

    def give():
        command(house, "relay", "on")
        house.broker.process.kill()
    held(house.face, give)
    until(lambda: " is lost: " in house.face.log() or OLD in house.face.log(), 20, lambda: house.face.log())
    nothing_moved(house)
    house.broker.start()
    obeys(house)


def test_nor_what_came_while_owsd_was_stopped(scene):
    house = ready(scene)
    house.set("relay", 0)
    held(house.daemon, lambda: command(house, "relay", "on"))
    logged(house.face, "command to \"relay\" refused: ")
    time.sleep(0.5)  # it would move now
    nothing_moved(house)
    obeys(house)


def varint(n):
    return bytes([n]) if n < 128 else bytes([n & 127 | 128]) + varint(n >> 7)


def dcmd(sent_ms=None, metric_ms=None):
    """The payload of a command of Sparkplug B that switches the relay on."""
    metric = b"\x0a\x05relay" + (b"\x18" + varint(metric_ms) if metric_ms is not None else b"") + b"\x20\x0b\x70\x01"
    return (b"\x08" + varint(sent_ms) if sent_ms is not None else b"") + b"\x12" + varint(len(metric)) + metric


def sparkplug(scene, synchronised):
    clock = faulty.Clock(scene)
    clock.jump(synchronised=synchronised)
    house = House(scene, ROOM, RELAY, Profile="sparkplug", Topic="plant", env=clock.env(scene), **ON)
    until(lambda: "DCMD/pi7/+ (QoS 1)" in house.broker.process.log(), 20, "it listens to commands")
    house.set("relay", 0)
    return house


def give_dcmd(house, *stamps):
    publish(house, f"spBv1.0/plant/DCMD/pi7/{SWITCH}", dcmd(*stamps))


def test_a_dcmd_with_an_old_stamp_moves_nothing_where_the_clock_is_right(scene):
    house = sparkplug(scene, True)
    now = int(time.time() * 1000)
    for n, stamps in enumerate(((now - 3600000, now - 3600000), (0, 0), (now, now - 3600000), (now - 3600000, None),
                                (None, 0), (now - 70000, now)), 1):
        give_dcmd(house, *stamps)
        until(lambda n=n: house.face.log().count("command to \"relay\" refused: its time stamp is more than a minute old") == n,
              20, lambda: house.face.log())
    nothing_moved(house)
    for stamps in ((now, now), (now + 3600000, None), (None, None)):
        house.set("relay", 0)
        give_dcmd(house, *stamps)
        until(lambda: scene_value(house) == "1", 20, lambda: house.face.log())


def test_a_stamp_counts_for_nothing_where_the_clock_is_not_synchronised(scene):
    house = sparkplug(scene, False)
    give_dcmd(house, 0, 0)
    until(lambda: scene_value(house) == "1", 20, lambda: house.face.log())


def test_a_dcmd_that_came_while_owsd_mqtt_was_stopped_moves_nothing(scene):
    house = sparkplug(scene, False)
    held(house.face, lambda: give_dcmd(house, int(time.time() * 1000)))
    logged(house.face, f"command to \"relay\" refused: {OLD}")
    nothing_moved(house)


# --- The page -------------------------------------------------------------------------------------

def page_of(scene):
    daemon = scene.owsd(text(scene, ROOM_OF_PAGE, RELAYS, Write="on"))
    page = Page(scene, daemon)
    assert scene.owsctl(daemon, "set", "-w", "10", "relays", "0").returncode == 0
    return daemon, page


ROOM_OF_PAGE = dict(Name="room", Path="/28.A0B1C2000001/temperature", Type=raw("double"), IO=raw("input"))


def post(page, unix, value=1):
    body = json.dumps({"name": "relays", "value": value}).encode()
    s = page.unix() if unix else page.tcp()
    s.sendall(b"POST /api/set HTTP/1.1\r\nHost: localhost\r\nX-Owsd: 1\r\nContent-Type: application/json\r\n"
              b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
    return s


def answer(s):
    with s:
        got = b""
        while more := s.recv(65536):
            got += more
    return int(got.split()[1]), json.loads(got.split(b"\r\n\r\n", 1)[1])


def page_case(unix, stopped, gives_up):
    def case(scene):
        daemon, page = page_of(scene)

        def give():
            s = post(page, unix)
            if gives_up:
                s.close()
            return s
        s = held(page.program if stopped == "page" else daemon, give)
        if not gives_up:
            status, words = answer(s)
            assert status == 503 and ("waited for longer" in words["error"] or stopped == "owsd"), (status, words)
        time.sleep(1)  # it would move now
        assert scene.get(daemon, "relays") == "0" and "owsd-web" not in scene.owsctl(daemon, "journal").stdout
        status, words = answer(post(page, unix, 5))
        assert status == 200 and words["ok"], (status, words)
        assert scene.get(daemon, "relays") == "5"
    return case


for _unix in (False, True):
    for _stopped in ("page", "owsd"):
        for _gives_up in (False, True):
            globals()["test_a_command_of_a_page_over_{}_while_{}_is_stopped_moves_nothing{}".format(
                "the_socket" if _unix else "tcp", "owsd_web" if _stopped == "page" else "owsd",
                "_for_one_who_gave_up" if _gives_up else "")] = page_case(_unix, _stopped, _gives_up)


def test_a_command_whose_client_has_hung_up_moves_nothing(scene):
    daemon, page = page_of(scene)
    for unix in (False, True):
        page.program.freeze()
        post(page, unix).close()
        page.program.thaw()
        assert scene.get(daemon, "relays") == "0"
        time.sleep(0.3)  # it would move now
        assert scene.get(daemon, "relays") == "0", unix


def test_a_command_that_waited_for_a_descriptor_of_the_page_moves_nothing(scene):
    daemon, page = page_of(scene)
    pid = page.program.process.pid
    before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
    for unix in (False, True):
        used = {int(fd) for fd in os.listdir(f"/proc/{pid}/fd")}
        free = next(n for n in range(len(used) + 1) if n not in used)
        resource.prlimit(pid, resource.RLIMIT_NOFILE, (free, before[1]))
        waits = post(page, unix)
        time.sleep(STOP_S)  # it is not accepted for so long
        resource.prlimit(pid, resource.RLIMIT_NOFILE, before)
        status, words = answer(waits)
        assert status == 503 and OLD in words["error"], (status, words)
        assert scene.get(daemon, "relays") == "0"
    status, words = answer(post(page, True, 5))
    assert status == 200 and words["ok"], (status, words)


# --- The served protocol --------------------------------------------------------------------------

# A device's property that sets no output of the table
PIO = f"/{SWITCH}/PIO.1"


def served_case(unix, gives_up, path):
    def case(scene):
        wire = scene.file("served.sim", f"chip DS2482-100 0x18\nDS2408 {SWITCH}\n")
        here, port = scene.path / "served.sock", free_port()
        daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [RELAY], Period=0.05, Timeout=3,
                                         Listen=f"127.0.0.1:{port}", ListenSocket=here))

        def connect():
            s = socket.socket(socket.AF_UNIX) if unix else socket.socket()
            s.settimeout(owsdtest.PATIENCE)
            s.connect(str(here) if unix else ("127.0.0.1", port))
            return s

        def ask(s, kind, *rest, flags=served.USUAL, **more):
            s.sendall(served.request(kind, *rest, flags=flags, **more))
            return served.receive(s)

        def value():
            with connect() as s:
                return ask(s, served.READ, path.replace("/29", "/uncached/29"), size=64).data.strip(b" \0")

        def give(s):
            s.sendall(served.request(served.WRITE, path, data=b"1", size=1))
            if gives_up:
                s.close()
            return s

        def moves_nothing(s):
            if not gives_up:
                with s:
                    assert served.receive(s).ret == -73
            time.sleep(0.3)  # it would move now
            assert value() == b"0", daemon.log()

        def writes(data):
            with connect() as s:
                return ask(s, served.WRITE, path, data=data, size=1).ret >= 0
        until(lambda: writes(b"0"), 20, "the bus is there")
        moves_nothing(held(daemon, lambda: give(connect())))
        before = connect()
        assert ask(before, served.READ, path, size=64, flags=served.USUAL | served.PERSIST).ret >= 0
        moves_nothing(held(daemon, lambda: give(before)))
        # a connection may be as old as it likes
        with connect() as s:
            time.sleep(STOP_S)  # nothing is asked for so long
            assert ask(s, served.WRITE, path, data=b"1", size=1).ret >= 0
        assert value() == b"1"
    return case


for _unix in (False, True):
    for _gives_up in (False, True):
        for _path in ("/signals/relay", PIO):
            globals()["test_a_write_of_{}_over_{}_while_owsd_is_stopped_moves_nothing{}".format(
                "a_signal" if "signals" in _path else "a_device", "a_unix_socket" if _unix else "tcp",
                "_for_one_who_gave_up" if _gives_up else "")] = served_case(_unix, _gives_up, _path)


def test_a_write_given_as_soon_as_a_long_one_is_answered_is_not_old(scene):
    wire = scene.file("large.sim", "chip DS2482-100 0x18\nDS1977 37.000000000001\n")
    server = served.owsd_of(scene, f"sim:{wire}", items=[])
    until(lambda: server.has(["/37.000000000001"]), 20, "the chip is there")
    # on one processor the client is quick enough to give it before owsd sleeps
    cpu = {min(os.sched_getaffinity(0))}
    for thread in os.listdir(f"/proc/{server.program.pid}/task"):
        os.sched_setaffinity(int(thread), cpu)
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cpu)
    try:
        with server.connect() as s:
            for size in (320, 2) * 3:
                began = time.monotonic()
                s.sendall(served.request(served.WRITE, "/37.000000000001/memory", data=os.urandom(size),
                                         flags=served.USUAL | served.PERSIST))
                assert served.receive(s).ret == 0, (size, server.program.log())
                assert size == 2 or time.monotonic() - began > STOP_S - 1, "it takes longer than 2 seconds"
    finally:
        os.sched_setaffinity(0, before)


if __name__ == "__main__":
    owsdtest.main(at_once=4)
