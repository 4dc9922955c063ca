#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Clients of the served protocol that are many, slow, half there or not what they seem."""

import random
import resource
import socket
import struct
import threading

import owsdtest
from owsdtest import until
from test_serve import DIR, DIRALL, NOP, READ, Link, ask, house, names, served, stat

ROOM = 512  # clients at a time


def header(payload=0, kind=NOP, flags=0x10A, size=0, version=0):
    return struct.pack(">6i", version, payload, kind, flags, size, 0)


def many_descriptors(n):
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < n:
        if hard != resource.RLIM_INFINITY and hard < n:
            owsdtest.skip(f"only {hard} descriptors")
        resource.setrlimit(resource.RLIMIT_NOFILE, (n, hard))


def resident_kb(daemon):
    with open(f"/proc/{daemon.pid}/status", encoding="ascii") as f:
        return next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))


def is_closed(sock):
    try:
        return sock.recv(1) == b""
    except ConnectionError:
        return True


def test_300_clients_at_once_all_get_their_answers(scene):
    daemon, port = house(scene)
    links = [Link(port, seconds=60) for _ in range(300)]
    for i, link in enumerate(links):
        link.send(READ, ("/28.0000000000B1/type", "/10.0000000000C1/temperature",
                         "/signals/boiler")[i % 3], flags=0x10E)
    for i, link in enumerate(links):
        answer = link.answer()
        assert answer[0] > 0, (i, answer)
    for i, link in enumerate(links):
        link.send(DIRALL, "/" if i % 2 else "/signals", flags=0x10E)
    for i, link in enumerate(links):
        answer = link.answer()
        assert (b"/28.0000000000B1" if i % 2 else b"/signals/boiler") in answer[4], (i, answer)
    assert stat(scene, daemon, "served_refused_full") == 0
    for link in links:
        link.socket.close()
    until(lambda: stat(scene, daemon, "served_clients") == 0, 5)


def test_1100_idle_clients_find_room_or_a_plain_refusal(scene):
    many_descriptors(1400)
    daemon, port = served(scene, owsdtest.rio("null:", []))
    links = [Link(port) for _ in range(1100)]
    until(lambda: stat(scene, daemon, "served_refused_full") == 1100 - ROOM, 10)
    assert stat(scene, daemon, "served_clients") == ROOM
    closed = [link for link in links[ROOM:] if is_closed(link.socket)]
    assert len(closed) == 1100 - ROOM
    # who is in is served
    for link in links[:ROOM]:
        link.send(NOP, None, flags=0x10E)
    for link in links[:ROOM]:
        assert link.answer()[0] == 0
    assert resident_kb(daemon) < 12000, resident_kb(daemon)
    for link in links[:10]:
        link.socket.close()
    until(lambda: stat(scene, daemon, "served_clients") == ROOM - 10, 5)
    assert ask(port, NOP, None)[0] == 0
    for link in links:
        link.socket.close()


def test_who_does_not_read_his_answers_holds_nobody_up(scene):
    daemon, port = house(scene)
    slow = []
    for _ in range(8):
        sock = socket.socket()
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        sock.settimeout(0.2)
        sock.connect(("127.0.0.1", port))
        slow.append(sock)
        body = b"/structure/28\0"
        try:
            for _ in range(20000):
                sock.sendall(header(len(body), DIR, 0x10E) + body)
        except socket.timeout:
            pass
    for _ in range(10):
        assert ask(port, READ, "/28.0000000000B1/type")[4] == b"DS18B20"
    # there are few rooms for directories: those who hold them lose them in time
    assert "/28.0000000000B1" in names(ask_slowly(port, DIRALL, "/"))
    until(lambda: stat(scene, daemon, "served_timeouts") > 0, 30)
    for sock in slow:
        sock.close()


def ask_slowly(port, kind, path):
    with Link(port, seconds=60) as link:
        link.send(kind, path)
        return link.answer()


def test_half_a_request_is_waited_for_and_then_closed(scene):
    daemon, port = served(scene, owsdtest.rio("null:", []))
    whole = header(7, READ, size=100) + b"/alarm\0"
    for n in (1, 10, 23, 24, 25, 30):
        with Link(port) as link:
            link.socket.sendall(whole[:n])
            assert ask(port, NOP, None)[0] == 0
            link.socket.sendall(whole[n:])
            assert link.answer()[0] == -21
    for n in (0, 10, 24, 30):
        link = Link(port, seconds=20)
        link.socket.sendall(whole[:n])
        if n:
            link.socket.shutdown(socket.SHUT_WR)
            assert is_closed(link.socket)
            link.socket.close()
            continue
        # ten seconds are what the genuine owserver gives
        assert is_closed(link.socket)
    until(lambda: stat(scene, daemon, "served_timeouts") == 1, 5)


def test_what_is_no_request_is_closed_without_an_answer(scene):
    daemon, port = served(scene, owsdtest.rio("null:", []))
    garbage = [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", header(payload=-1), header(payload=-5),
               header(payload=0x7FFFFFFF), header(payload=70000), header(version=0x1FFFF),
               header(version=-1), header(payload=10, kind=3, size=11) + b"/a\0bcdefgh",
               header(payload=10, kind=3, size=-1) + b"/a\0bcdefgh", b"\xff" * 24]
    for bytes_ in garbage:
        with Link(port) as link:
            link.socket.sendall(bytes_)
            assert is_closed(link.socket), bytes_
    until(lambda: stat(scene, daemon, "served_garbage") == len(garbage), 5)
    assert ask(port, NOP, None)[0] == 0


def test_random_requests_harm_nobody(scene):
    daemon, port = house(scene)
    seed = random.randrange(2**32)
    rng = random.Random(seed)
    words = ["uncached", "alarm", "bus.0", "bus.9", "bus.", "signals", "boiler", "settings",
             "28.0000000000B1", "temperature", "PIO.BYTE", "PIO.99", "structure", "28", "", "..",
             "x" * 300, "%s%n", "\x01", "ž", "return_codes", "text.ALL", "text.999", "1F.main",
             "simultaneous", "29,12", "address", "_Age", "_DGNRESET", "main", "aux"]
    for _ in range(200):
        path = "/".join(rng.choice(words) for _ in range(rng.randrange(6)))
        data = bytes(rng.randrange(256) for _ in range(rng.randrange(40)))
        body = path.encode() + rng.choice([b"\0", b""]) + data
        head = header(len(body) + rng.choice([0] * 12 + [-1, 1, 9]), rng.randrange(-1, 13),
                      rng.getrandbits(31), rng.choice([0, 1, 3, len(data), 8192, -1, 2**31 - 1]),
                      rng.choice([0, 0, 0, 1, 0x10000, 0x10001]))
        with Link(port, seconds=0.2) as link:
            try:
                link.socket.sendall(head + body)
                link.frame()
            except (EOFError, OSError):
                pass
        assert daemon.running(), f"seed {seed}"
    assert ask(port, READ, "/28.0000000000B1/type")[4] == b"DS18B20", f"seed {seed}"


def test_clients_that_leave_in_the_middle_leave_nothing_behind(scene):
    daemon, port = house(scene)
    for i in range(60):
        link = Link(port)
        link.send(DIRALL if i % 2 else READ, ("/", "/uncached/28.0000000000A3/temperature",
                                              "/structure/28", "/28.0000000000A1/temperature9")[i % 4])
        if i % 3:
            link.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        link.socket.close()
    until(lambda: stat(scene, daemon, "served_clients") == 0, 20)
    assert ask(port, READ, "/28.0000000000B1/type")[4] == b"DS18B20"


def test_a_busy_table_starves_no_client_and_clients_starve_no_table(scene):
    server = scene.owserver(tester=["28"] * 30)
    items = [dict(Name=f"t{i}", Path=d + "/temperature", Type="double", IO="input")
             for i, d in enumerate(server.devices())]
    daemon, port = served(scene, owsdtest.rio(server.target, items, Period=0.01))
    until(lambda: scene.get(daemon, "t0"), 10)
    stop = threading.Event()

    def hammer():
        with Link(port, seconds=60) as link:
            while not stop.is_set():
                link.send(READ, "/uncached/simultaneous/temperature", flags=0x10E)
                link.answer()

    threads = [threading.Thread(target=hammer) for _ in range(8)]
    for thread in threads:
        thread.start()
    try:
        for _ in range(20):
            assert ask(port, READ, "/uncached" + server.devices()[3] + "/templow")[0] == 12
        until(lambda: stat(scene, daemon, "served_bus_requests") > 500, 30)
        reads = [until(lambda: table_reads(scene, daemon), 5)]
        until(lambda: table_reads(scene, daemon) > reads[0] + 100, 30, "the table is read on")
    finally:
        stop.set()
        for thread in threads:
            thread.join()


def table_reads(scene, daemon):
    """Of the signals, without those of clients."""
    return stat(scene, daemon, "reads")


if __name__ == "__main__":
    owsdtest.main()
