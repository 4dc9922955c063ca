#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random requests, and a table and clients that want the same bus; more in test_serve_crowd.py."""

import random
import struct
import threading

import faulty
import owsdtest
from owsdtest import until
from test_serve import NOP, READ, WRITE, Link, ask, house, served, stat

def header(payload=0, kind=NOP, flags=0x10A, size=0, version=0):
    return struct.pack(">6i", version, payload, kind, flags, size, 0)


def test_random_requests_harm_nobody(scene):
    daemon, port = house(scene)
    seed = random.randrange(2**32)
    rng = random.Random(seed)
    words = ["uncached", "alarm", "bus.0", "bus.9", "bus.", "signals", "boiler", "settings",
             "28.B10000000000", "temperature", "PIO.BYTE", "PIO.99", "structure", "28", "", "..",
             "x" * 300, "%s%n", "\x01", "ž", "return_codes", "text.ALL", "text.999", "1F.main",
             "simultaneous", "29,12", "address", "_Age", "_DGNRESET", "main", "aux"]
    for _ in range(80):
        path = "/".join(rng.choice(words) for _ in range(rng.randrange(6)))
        data = bytes(rng.randrange(256) for _ in range(rng.randrange(40)))
        body = path.encode() + rng.choice([b"\0", b""]) + data
        head = header(len(body) + rng.choice([0] * 12 + [-1, 1, 9]), rng.randrange(-1, 13),
                      rng.getrandbits(31), rng.choice([0, 1, 3, len(data), 8192, -1, 2**31 - 1]),
                      rng.choice([0, 0, 0, 1, 0x10000, 0x10001]))
        with Link(port) as link:
            link.socket.settimeout(0.2)
            try:
                link.socket.sendall(head + body)
                link.frame()
            except (EOFError, OSError):
                pass
        assert daemon.running(), f"seed {seed}"
    assert ask(port, READ, "/28.B10000000000/type")[4] == b"DS18B20", f"seed {seed}"


def test_a_link_that_takes_the_place_of_the_socket_gives_no_other_file_to_the_group(scene):
    """As who may write the folder makes it, while owsd is about to set the socket's rights."""
    victim = scene.path / "secret"
    victim.write_text("of its owner alone\n")
    victim.chmod(0o400)
    config = owsdtest.rio("null:", [], ListenSocket=str(scene.path / "socket"))
    daemon = scene.owsd(config, env=faulty.env(scene, socket=victim), ready=False)
    assert daemon.wait() == 1 and "cannot listen at" in daemon.log(), daemon.log()
    assert faulty.happened(scene)
    status = victim.stat()
    assert status.st_mode & 0o777 == 0o400, oct(status.st_mode)


def test_of_a_client_that_cannot_be_watched_nothing_is_written(scene):
    """Before, its first request was done, and the connection was closed without an answer."""
    full = scene.path / "full"
    daemon, port = served(scene, faulty.house(scene), env=faulty.env(scene, watch=full))
    until(lambda: scene.get(daemon, "room") == "21.5", 20)
    low, pins = "/uncached/28.A0B1C2000001/templow", "/uncached/29.A0B1C2000004/PIO.BYTE"
    before = [ask(port, READ, path)[4] for path in (low, pins)]
    full.touch()
    for path, data in ((low, b"33"), (pins, b"5"), ("/signals/relays", b"6")):
        with Link(port) as link:
            link.send(WRITE, path, data)
            try:
                raise AssertionError(f"{path}: {link.answer()}")
            except (EOFError, ConnectionError):
                pass
    assert faulty.happened(scene)
    full.unlink()
    until(lambda: stat(scene, daemon, "served_refused_errors") == 3, 10, "it is counted")
    owsdtest.logged(daemon, "a client of the owserver protocol was refused: No space left")
    assert [ask(port, READ, path)[4] for path in (low, pins)] == before
    assert ask(port, WRITE, low, b"33")[0] == 0
    assert ask(port, READ, low)[4].strip() == b"33"


def test_a_busy_table_starves_no_client_and_clients_starve_no_table(scene):
    server = scene.owserver(tester=["28"] * 30)
    items = [dict(Name=f"t{i}", Path=d + "/temperature", Type="double", IO="input")
             for i, d in enumerate(server.devices())]
    daemon, port = served(scene, owsdtest.rio(server.target, items, Period=0.01))
    until(lambda: scene.get(daemon, "t0"), 10)
    stop = threading.Event()

    def hammer():
        with Link(port) as link:
            while not stop.is_set():
                link.send(READ, "/uncached/simultaneous/temperature", flags=0x10E)
                link.answer()

    threads = [threading.Thread(target=hammer) for _ in range(8)]
    for thread in threads:
        thread.start()
    try:
        for _ in range(20):
            assert ask(port, READ, "/uncached" + server.devices()[3] + "/templow")[0] == 12
        until(lambda: stat(scene, daemon, "served_bus_requests") > 500, 300)
        reads = until(lambda: table_reads(scene, daemon), 5)
        until(lambda: table_reads(scene, daemon) > reads + 100, 300, "the table is read on")
    finally:
        stop.set()
        for thread in threads:
            thread.join()


def table_reads(scene, daemon):
    """Of the signals, without those of clients."""
    return stat(scene, daemon, "reads")


if __name__ == "__main__":
    owsdtest.main()
