#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Clients of owsd -l that are many, slow, half there, or talk rubbish: memory stays bounded, others
are served, a refusal is plain, and the engine loses no period."""

import asyncio
import contextlib
import json
import os
import random
import resource
import select
import signal
import socket
import struct
import threading
import time

import clients
import faulty
import owsdtest
import served
from served import (ABSENT, DIRALL, NOP, PERSIST, READ, SWITCH, THERMOMETER, USUAL, WRITE, Closed)

TYPE = THERMOMETER + "/type"
# A period is late for an engine that waits for a client, who has ten seconds, and for no busy machine
SLOW = dict(Period=5)
MEMORY_KB = 6000


def resident_kb(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as f:
        return next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))


def counter(scene, daemon, name):
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    return sum(c["value"] for c in stats["counters"] if c["name"] == name)


def many_descriptors(n):
    """This process, and what it starts, may have n descriptors."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < n:
        owsdtest.skip(f"only {hard} descriptors are allowed here")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, n), hard))


@contextlib.contextmanager
def unharmed(scene, server):
    """Whatever happens in here costs a bounded amount of memory and no period; afterwards owsd is
    there and answers."""
    daemon = server.program
    assert server.frame(READ, TYPE).data == b"DS18B20"
    before, late = resident_kb(daemon.pid), counter(scene, daemon, "late_periods")
    yield
    after = resident_kb(daemon.pid)
    assert daemon.running(), daemon.process.returncode
    owsdtest.until(lambda: answer(server), 15, "it answers afterwards", step=0.1)
    assert counter(scene, daemon, "late_periods") == late
    room = MEMORY_KB * (4 if owsdtest.BUILD.name in ("asan", "tsan") else 1)
    assert after - before < room, f"{before} kB before, {after} kB after"


def answer(server, path=TYPE):
    """What a newcomer is told, or None when he is plainly refused: the connection is closed."""
    try:
        with server.connect() as s:
            s.sendall(served.request(READ, path))
            return served.receive(s).data
    except (Closed, ConnectionError):
        return None


def nobody_is_held_up(scene, server, guests):
    """Newcomers are answered while all or some of these guests are still there, of whom each is sent
    away at last."""
    def answered():
        sent_away = counter(scene, server.program, "served_timeouts")
        assert answer(server) == b"DS18B20"
        return counter(scene, server.program, "served_timeouts") == sent_away < guests
    owsdtest.until(answered, 5, "an answer that did not wait")
    for _ in range(10):
        assert answer(server) == b"DS18B20"


def open_all(server, n):
    found = []
    for _ in range(n):
        found.append(server.connect())
    return found


def close_all(sockets):
    for s in sockets:
        s.close()


def closed_by_peer(sockets):
    """Those that the server has closed."""
    poll = select.poll()
    by_fd = {s.fileno(): s for s in sockets}
    for fd in by_fd:
        poll.register(fd, select.POLLIN | select.POLLRDHUP)
    return [by_fd[fd] for fd, _ in poll.poll(0)]


def test_what_is_reserved_for_clients_takes_no_huge_pages(scene):
    """Some kernels give huge pages to all who do not refuse: the first client would cost 2 MiB."""
    if not os.path.exists("/sys/kernel/mm/transparent_hugepage"):
        owsdtest.skip("a kernel without huge pages")
    faulty.not_sanitized("a sanitizer reserves memory of its own")
    server = served.owsd(scene, **SLOW)
    large, size, writable = [], 0, False
    with open(f"/proc/{server.program.pid}/smaps", encoding="ascii") as f:
        for line in f:
            words = line.split()
            if "-" in words[0]:
                writable = words[1] == "rw-p" and len(words) == 5  # anonymous
            elif words[0] == "Size:":
                size = int(words[1])
            elif words[0] == "VmFlags:" and writable and 16384 <= size < 1 << 20:
                large.append((size, "nh" in words))
    assert large and all(refused for _, refused in large), large


def test_900_clients_at_once_are_all_answered(scene):
    """Those that find all places taken wait for theirs."""
    many_descriptors(2048)
    server = served.owsd(scene, **SLOW)
    with unharmed(scene, server):
        sockets = open_all(server, 900)
        try:
            # else a slow server meets clients that have asked, and may end each that it has answered
            owsdtest.until(lambda: counter(scene, server.program, "served_full"), 10, "it is full")
            for s in sockets:
                s.sendall(served.request(READ, TYPE))
            answers = [served.receive(s).data for s in sockets]
        finally:
            close_all(sockets)
        assert answers == [b"DS18B20"] * 900, set(answers)
    assert counter(scene, server.program, "served_refused_errors") == 0


def reads_at_once(which, n):
    """As Home Assistant polls its entities: a connection for each, all at the same time."""
    def case(scene):
        many_descriptors(2048)
        server = served.start(scene, which)
        client = clients.AioOwnet(scene, server)
        values = [(device + "/" + name, wanted)
                  for device, family in ((d, d[1:3]) for d in served.DEVICES)
                  for name, wanted in (("family", family.encode()), ("address", None),
                                       ("type", None), ("id", device[4:].encode()))]
        values += [(f"{SWITCH}/{name}.{n}", None) for name in ("sensed", "latch", "PIO")
                   for n in range(8)]
        values = (values * 14)[:n]

        async def read(path):
            try:
                return await client.proxy.read(path)
            except Exception as error:  # which one is said where it is compared
                return repr(error)

        async def read_all():
            return await asyncio.gather(*(read(path) for path, _ in values))
        for _poll in range(2):
            answers = asyncio.run(read_all())
            wrong = [(path, answer) for (path, wanted), answer in zip(values, answers)
                     if not isinstance(answer, bytes) or wanted not in (None, answer)]
            assert not wrong, f"{len(wrong)} of {len(values)}: {wrong[:5]}"
    return case


# From some hundreds on the genuine owserver aborts now and then
test_300_reads_at_once_of_aio_ownet_are_all_answered_by_owserver = reads_at_once("owserver", 300)
test_900_reads_at_once_of_aio_ownet_are_all_answered_by_owsd = reads_at_once("owsd", 900)


class Crowd:
    """Clients that fill the house, each of which says something each second on a connection that is
    kept, and comes again at once when it was closed."""

    def __init__(self, server, n, saying):
        self.server, self.saying, self.stop = server, saying, threading.Event()
        self.poll, self.sockets = select.poll(), {}
        for _ in range(n):
            self.come()
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def come(self):
        s = self.server.connect()
        s.setblocking(False)
        self.sockets[s.fileno()] = s
        self.poll.register(s, select.POLLIN)
        s.send(self.saying)

    def run(self):
        while not self.stop.wait(1):
            for fd, _ in self.poll.poll(0):
                try:
                    gone = not self.sockets[fd].recv(4096)
                except ConnectionError:
                    gone = True
                if gone:
                    self.poll.unregister(fd)
                    self.sockets.pop(fd).close()
                    self.come()
            for s in self.sockets.values():
                with contextlib.suppress(BlockingIOError, ConnectionError):
                    s.send(self.saying)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop.set()
        self.thread.join()
        close_all(self.sockets.values())


def a_crowd_lets_others_in(saying):
    def case(scene):
        many_descriptors(2048)
        path = str(scene.path / "socket")
        server = served.owsd(scene, **SLOW, ListenSocket=path)
        with unharmed(scene, server), Crowd(server, 560, saying):
            owsdtest.until(lambda: counter(scene, server.program, "served_full"), 20, "it is full")
            for _ in range(3):
                assert answer(server) == b"DS18B20"
            # and no way in is forgotten over another one
            with socket.socket(socket.AF_UNIX) as s:
                s.settimeout(owsdtest.PATIENCE)
                s.connect(path)
                s.sendall(served.request(READ, TYPE))
                assert served.receive(s).data == b"DS18B20"
            owsdtest.until(lambda: counter(scene, server.program, "served_not_kept"), 10,
                           "connections were not kept")
    return case


test_a_crowd_that_says_nops_lets_others_in = a_crowd_lets_others_in(
    served.request(NOP, None, flags=USUAL | PERSIST))
test_a_crowd_that_reads_lets_others_in = a_crowd_lets_others_in(
    served.request(READ, TYPE, flags=USUAL | PERSIST))


def wakes(daemon, thread):
    """How often the thread of this name has woken, and whether it sleeps now."""
    for task in os.listdir(f"/proc/{daemon.pid}/task"):
        with open(f"/proc/{daemon.pid}/task/{task}/status", encoding="ascii") as f:
            status = dict(line.rstrip("\n").split(":\t", 1) for line in f)
        if status["Name"] == thread:
            return int(status["voluntary_ctxt_switches"]), status["State"].startswith("S")
    raise AssertionError(f"no thread {thread}")


def test_who_waits_gets_the_place_that_was_idle_for_longest_and_costs_nothing(scene):
    """NOPs make a connection no less idle."""
    many_descriptors(2048)
    server = served.owsd(scene, **SLOW)
    with unharmed(scene, server):
        sockets = []
        try:
            for _ in range(512):
                s = server.connect()
                sockets.append(s)
                s.sendall(served.request(READ, TYPE, flags=USUAL | PERSIST))
                assert served.receive(s).flags & PERSIST
            for s in sockets[:100]:
                s.sendall(served.request(NOP, None, flags=USUAL | PERSIST))
                assert served.receive(s).flags & PERSIST
            with server.connect() as late:
                late.sendall(served.request(READ, TYPE))
                owsdtest.until(lambda: counter(scene, server.program, "served_full") == 1, 10,
                               "it waits")
                before, at = wakes(server.program, "owsd-serve")[0], time.monotonic()
                owsdtest.until(lambda: wakes(server.program, "owsd-serve")[1], 10, "it sleeps")
                late.settimeout(owsdtest.PATIENCE)
                late.recv(1, socket.MSG_PEEK)
                assert wakes(server.program, "owsd-serve")[0] - before < 2000, "it waits busily"
                assert served.receive(late).data == b"DS18B20"
                print(f"it waited {time.monotonic() - at:.1f} s")
            assert closed_by_peer(sockets) == sockets[:1]
            owsdtest.until(lambda: counter(scene, server.program, "served_evicted") == 1, 10,
                           "it is counted")
        finally:
            close_all(sockets)


def test_1100_idle_clients_do_not_keep_others_out_for_long(scene):
    """Half of them never said a word, half asked to persist; the genuine owserver aborts here."""
    many_descriptors(4096)
    server = served.owsd(scene, **SLOW)
    with unharmed(scene, server):
        sockets, persist = open_all(server, 300), 0
        try:
            for i in range(800):
                s = server.connect()
                sockets.append(s)
                if i % 3 == 0:
                    continue
                try:
                    s.sendall(served.request(READ, TYPE, flags=USUAL | PERSIST))
                    persist += bool(served.receive(s).flags & PERSIST)
                except (Closed, ConnectionError):
                    pass  # plainly refused
            assert persist >= 16, persist
            answer(server)  # served or refused, but told so
            owsdtest.until(lambda: answer(server) == b"DS18B20", 30, "a newcomer is served",
                           step=0.2)
        finally:
            close_all(sockets)


def test_a_full_house_is_counted_and_said_with_its_number(scene):
    many_descriptors(2048)
    server = served.owsd(scene, **SLOW)
    sockets = open_all(server, 700)

    def said():
        """One more of those who wait gets a place at a time, and the next one waits."""
        for s in sockets[:20]:
            s.close()
        del sockets[:20]
        sockets.extend(open_all(server, 20))
        return "others wait (2 times since the last such line)" in server.program.log()
    owsdtest.until(said, 60, "how often it was full")
    close_all(sockets)
    lines = server.program.log().count("others wait")
    assert lines >= 3, server.program.log()
    # a line at the first, second, fourth, eighth, ... of them
    owsdtest.until(lambda: counter(scene, server.program, "served_full") >= 2 ** (lines - 1),
                   10, "all of them are counted")


def test_a_client_that_does_not_read_gets_no_memory_and_holds_nobody_up(scene):
    server = served.owsd(scene, **SLOW)
    with unharmed(scene, server):
        one = served.request(DIRALL, THERMOMETER, flags=USUAL | PERSIST)
        lazy = []
        try:
            for _ in range(8):
                s = server.connect()
                s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
                s.setblocking(False)
                lazy.append(s)
                sent = 0
                with contextlib.suppress(BlockingIOError, ConnectionError):
                    while sent < 4_000_000:
                        sent += s.send(one * 100)
            nobody_is_held_up(scene, server, len(lazy))
        finally:
            close_all(lazy)


def test_half_a_request_is_given_up(scene):
    server = served.owsd(scene, **SLOW)
    whole = served.request(READ, TYPE)
    with unharmed(scene, server):
        halves = []
        for part in (b"", whole[:1], whole[:10], whole[:23], whole[:24], whole[:30],
                     served.header(WRITE, 70000, size=65000), served.header(READ, 100050)):
            s = server.connect()
            s.sendall(part)
            halves.append(s)
        nobody_is_held_up(scene, server, len(halves))
        try:
            owsdtest.until(lambda: len(closed_by_peer(halves)) == len(halves), 40,
                           "they are all closed", step=0.2)
        finally:
            close_all(halves)


def test_clients_that_leave_without_a_word(scene):
    """Reset while an answer is on its way, or closed in the middle of a request."""
    server = served.owsd(scene, **SLOW)
    whole = served.request(DIRALL, THERMOMETER)
    with unharmed(scene, server):
        for i in range(200):
            s = server.connect()
            s.sendall(whole if i % 2 else whole[:i % len(whole)])
            s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            s.close()
        path = "/uncached" + THERMOMETER + "/temperature"  # takes most of a second
        for _ in range(20):
            with server.connect() as s:
                s.sendall(served.request(READ, path))


def test_garbage_is_refused(scene):
    seed = int(os.environ.get("SEED", time.time_ns() % 1_000_000))
    print(f"SEED={seed}")
    rng = random.Random(seed)
    server = served.owsd(scene, **SLOW)
    whole = served.request(READ, TYPE)

    def garbage():
        kind = rng.randrange(5)
        if kind == 0:
            return rng.randbytes(rng.randrange(1, 200))
        if kind == 1:  # a header of any numbers
            return struct.pack(">6I", *(rng.choice((0, 1, 7, 0xffffffff, 0x7fffffff, 0x80000000,
                                                    rng.getrandbits(32))) for _ in range(6)))
        if kind == 2:  # a request with some bytes changed
            data = bytearray(whole)
            for _ in range(rng.randrange(1, 6)):
                data[rng.randrange(len(data))] = rng.getrandbits(8)
            return bytes(data)
        if kind == 3:  # a path of rubbish
            body = rng.randbytes(rng.randrange(1, 600))
            return served.header(rng.randrange(12), len(body), size=rng.randrange(-5, 70000),
                                 flags=rng.getrandbits(31), offset=rng.randrange(-5, 70000)) + body
        path = "/" + "/".join(rng.choice(("uncached", "alarm", "bus.0", "structure", "settings", "..",
                                          "", "28", "28.67C6697351FF", "type", "signals", "room1",
                                          "%s%n", "temperature.", "PIO.ALL", ".", "bus.99999999999"))
                              for _ in range(rng.randrange(1, 9)))
        return served.request(rng.choice((READ, DIRALL, served.DIR, served.PRESENT, served.GET)), path)

    with unharmed(scene, server):
        for i in range(400):
            with server.connect() as s, contextlib.suppress(ConnectionError):
                s.sendall(garbage())
                if i % 20 == 0:
                    s.settimeout(0.05)
                    with contextlib.suppress(TimeoutError):
                        s.recv(4096)
        # the house may still be full of it
        owsdtest.until(lambda: answer(server) == b"DS18B20", 15, f"SEED={seed}", step=0.1)


def test_a_header_that_asks_for_too_much_is_refused_at_once(scene):
    server = served.owsd(scene, **SLOW)
    with unharmed(scene, server):
        for header in (served.header(READ, 0x7fffffff), served.header(READ, 200000),
                       served.header(WRITE, 0x7fffffff, size=0x7fffffff), served.header(READ, -5),
                       served.header(READ, 10, version=0x1ffff)):
            with server.connect() as s:
                s.sendall(header)
                try:
                    frame = served.receive(s)
                    assert frame.ret < 0, frame
                except Closed:
                    pass
        assert counter(scene, server.program, "served_timeouts") == 0, "not for want of the rest"


def test_a_write_is_refused_in_read_only_mode(scene):
    genuine = served.owserver(scene, "--readonly")
    server = served.owsd(scene, limits=False, ListenReadOnly="on")
    before = server.frame(READ, THERMOMETER + "/templow").data
    for path, value in ((THERMOMETER + "/templow", b"5"), (SWITCH + "/PIO.BYTE", b"255")):
        left, right = (s.frame(WRITE, path, data=value) for s in (genuine, server))
        assert left == right and right.ret == -30, (left, right)
    for path in ("/signals/relays", "/simultaneous/temperature", THERMOMETER + "/alias",
                 "/settings/timeout/volatile", ABSENT + "/templow"):
        assert server.frame(WRITE, path, data=b"1").ret < 0, path
    shell = clients.Shell(scene, server)
    try:
        shell.write(THERMOMETER + "/templow", b"5")
        raise AssertionError("owwrite says nothing")
    except clients.Refused:
        pass
    assert server.frame(READ, "/uncached" + THERMOMETER + "/templow").data == before
    assert shell.read(TYPE) == b"DS18B20"


def test_sigterm_with_idle_clients_ends_it(scene):
    server = served.owsd(scene)
    idle = open_all(server, 20)
    for s in idle[:10]:
        s.sendall(served.request(READ, TYPE, flags=USUAL | PERSIST))
        served.receive(s)
    idle[10].sendall(served.request(READ, TYPE)[:20])
    idle[11].sendall(served.request(READ, "/uncached" + THERMOMETER + "/temperature"))
    try:
        server.program.signal(signal.SIGTERM)
        assert server.program.wait() == 0
    finally:
        close_all(idle)


def test_a_port_alone_is_served_on_loopback_only(scene):
    server = served.owsd_of(scene, f"sim:{scene.file('a.sim', served.WIRE)}")
    port = f"{server.port:04X}"

    def listens():
        found = []
        for table in ("tcp", "tcp6"):
            with contextlib.suppress(FileNotFoundError), \
                    open(f"/proc/net/{table}", encoding="ascii") as f:
                found += [line.split()[1].split(":")[0] for line in f
                          if line.split()[1].endswith(":" + port) and line.split()[3] == "0A"]
        return found
    listening = owsdtest.until(listens, 5, "it listens")
    loopback = {"0100007F", "00000000000000000000000001000000"}
    assert set(listening) <= loopback, listening


def test_a_port_in_use_is_said_at_start(scene):
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        s.listen(1)
        port = s.getsockname()[1]
        config = scene.file("used.rio", owsdtest.rio("null:", []))
        done = scene.owsd_once("-n", scene.name(), "-c", config, "-l", f"127.0.0.1:{port}")
        assert done.returncode != 0 and str(port) in done.stderr and "in use" in done.stderr, done


def test_it_listens_again_at_once_after_a_restart(scene):
    server = served.owsd(scene)
    with server.connect() as s:
        s.sendall(served.request(NOP, None, flags=USUAL | PERSIST))
        served.receive(s)
        assert server.program.stop() == 0
        daemon = scene.owsd(server.program.config, "-l", f"127.0.0.1:{server.port}",
                            name=server.program.name)
        owsdtest.until(server.answers, 10, "it answers on the same port")
        assert daemon.running()


if __name__ == "__main__":
    owsdtest.main(at_once=4)
