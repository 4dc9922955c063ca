#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The owserver bus in its worker: against the genuine owserver, and against a peer that lies."""

import errno
import os
import subprocess
import sys

import owsdtest
import peer

BUS = owsdtest.BUILD / "system/bus"
T = "/28.AABBCCDDEEFF/temperature"
OUT = "/29.AABBCCDDEE01/PIO.BYTE"


class Bus:
    """A bus at our command: bus("read /28.x/temperature") is ("ok", "21.5") or ("error", 19)."""

    def __init__(self, scene, target):
        owsdtest.need(BUS)
        self.process = subprocess.Popen([str(BUS), target], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True, cwd=scene.path)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            self.process.communicate(timeout=owsdtest.PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.communicate()
            raise
        assert kind or self.process.returncode == 0, self.process.returncode

    def __call__(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        word, _, rest = self.process.stdout.readline().rstrip("\n").partition(" ")
        return (word, int(rest)) if word == "error" and rest else (word, rest)

    def ok(self, command):
        word, rest = self(command)
        assert word == "ok", f"{command}: {word} {rest}"
        return rest

    def fails(self, command, *numbers):
        word, rest = self(command)
        names = [errno.errorcode[n] for n in numbers]
        assert word == "error" and rest in numbers, f"{command}: {word} {rest}, not {names}"

    def counted(self, name):
        return int(dict(c.split("=") for c in self.ok("counters").split())[name])

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def resident_kb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as f:
            return next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))


def liar(**options):
    return peer.Peer({T: "     21.5", OUT: "0"}, **options)


# --- the genuine owserver -------------------------------------------------------------------------
def test_genuine_values_directories_and_errors(scene):
    server = scene.owserver(tester=["28", "29"])
    sensor, switch = server.devices()
    with Bus(scene, server.target) as bus:
        assert server.target in bus.ok("up")
        text = server.read(sensor + "/temperature")
        assert bus.ok(f"read {sensor}/temperature") == text.rjust(12)
        assert bus.ok(f"fresh {sensor}/type") == "DS18B20"
        bus.ok(f"write {switch}/PIO.0 1")
        bus.ok(f"probe {sensor}")
        root = bus.ok("dir /").split()
        assert root[:2] == [sensor, switch] and "/bus.0" in root and "/settings" in root, root
        assert f"{sensor}/temperature" in bus.ok(f"dir {sensor}").split()
        assert bus.ok("dir /alarm") == ""
        assert bus.ok("read /settings/timeout/volatile").strip() == "15"
        assert "/structure/28/temperature" in bus.ok("dir /structure/28").split()
        bus.fails("read /28.AABBCCDDEEFF/temperature", errno.ENODEV)
        bus.fails("probe /28.AABBCCDDEEFF", errno.ENODEV)
        bus.fails("dir /28.AABBCCDDEEFF", errno.ENODEV)
        bus.fails(f"read {sensor}/colour", errno.ENOENT)
        bus.fails(f"read {sensor}", errno.EISDIR)
        bus.fails(f"dir {sensor}/temperature", errno.ENOTDIR)
        bus.fails(f"write {sensor}/temperature 1", errno.EACCES)
        bus.fails(f"write {sensor}/templow abc", errno.EINVAL)
        assert bus.ok(f"simulated {sensor}/type") == "yes"
        assert bus.counted("connections") == 1


def test_genuine_device_with_an_alias_is_found_by_its_id(scene):
    server = scene.owserver(mock=["28", "29"])
    sensor, switch = server.devices()
    with Bus(scene, server.target) as bus:
        bus.ok("up")
        server.write(sensor + "/alias", "boiler")
        assert sorted(bus.ok("dir /").split())[:2] == [sensor, switch]
        assert f"{sensor}/temperature" in bus.ok(f"dir {sensor}").split()
        bus.ok(f"read {sensor}/temperature")
        bus.ok("read /boiler/temperature")
        bus.ok("probe /boiler/temperature")


def test_genuine_mock_gives_back_what_was_written(scene):
    server = scene.owserver(mock=["28"])
    sensor = server.devices()[0]
    with Bus(scene, server.target) as bus:
        bus.ok("up")
        bus.ok(f"write {sensor}/templow 17")
        assert bus.ok(f"read {sensor}/templow") == "          17"


def test_genuine_on_ipv6(scene):
    owsdtest.need_ipv6()
    server = scene.owserver(tester=["28"], host="::1")
    with Bus(scene, server.target) as bus:
        assert "[::1]" in bus.ok("up")
        bus.ok(f"read {server.devices()[0]}/temperature")


def test_genuine_by_name(scene):
    server = scene.owserver(tester=["28"])
    with Bus(scene, f"owserver:localhost:{server.port}") as bus:
        bus.ok("up")
        bus.ok("dir /")


# What another user does: between the program and the owserver, at the other loopback address
PROXY = """import os, socket, sys, threading
os.setuid(12345)
port = int(sys.argv[1])
listener = socket.socket(socket.AF_INET6)
listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
listener.bind(("::1", port))
listener.listen()
print("ready", flush=True)
def pass_on(here, there):
    while data := here.recv(4096):
        there.sendall(data.replace(b"2", b"9"))
while True:
    client = listener.accept()[0]
    server = socket.socket()
    server.connect(("127.0.0.1", port))
    for ends in ((client, server), (server, client)):
        threading.Thread(target=pass_on, args=ends, daemon=True).start()
"""


def test_a_server_of_another_person_is_not_believed(scene):
    owsdtest.need_ipv6()
    if os.geteuid():
        owsdtest.skip("only root becomes another user")
    server = scene.owserver(tester=["28"])
    target = f"localhost:{server.port}"
    with subprocess.Popen([sys.executable, "-c", PROXY, str(server.port)], stdout=subprocess.PIPE,
                          text=True) as proxy:
        try:
            assert proxy.stdout.readline() == "ready\n"
            with Bus(scene, target) as bus:
                assert f"127.0.0.1:{server.port}" in bus.ok("up")
            asked = scene.owsctl(None, "-t", f"[::1]:{server.port}", "scan")
            assert asked.returncode and "user 12345" in asked.stderr, asked
        finally:
            proxy.kill()


# It is in no list of listeners when owsd looks for it there
QUICK = """import os, socket
os.setuid(12345)
listener = socket.socket(socket.AF_INET6)
listener.bind(("::1", 0))
listener.listen()
print(listener.getsockname()[1], flush=True)
client = listener.accept()[0]
listener.close()
try:
    print("asked", len(client.recv(4096)))
except ConnectionError:
    print("asked 0")
"""


def test_a_person_who_closes_the_listener_at_once_is_not_believed(scene):
    owsdtest.need_ipv6()
    if os.geteuid():
        owsdtest.skip("only root becomes another user")
    for _ in range(10):
        with subprocess.Popen([sys.executable, "-c", QUICK], stdout=subprocess.PIPE, text=True) as quick:
            try:
                asked = scene.owsctl(None, "-t", f"[::1]:{quick.stdout.readline().strip()}", "scan")
                assert asked.returncode and quick.stdout.readline() == "asked 0\n", asked
            finally:
                quick.kill()


def test_genuine_that_refuses_persistence_serves_all_the_same(scene):
    server = scene.owserver(tester=["28"], options=["--clients_persistent_low=0",
                                                    "--clients_persistent_high=1"])
    sensor = server.devices()[0]
    with Bus(scene, server.target) as first, Bus(scene, server.target) as second:
        first.ok("up")
        second.ok("up")

        def refused():
            first.ok(f"read {sensor}/temperature")
            second.ok(f"read {sensor}/temperature")
            return first.counted("refused_persistence") + second.counted("refused_persistence") >= 20
        owsdtest.until(refused, 20, "it refuses again and again", step=0)
        assert first.counted("timeouts") + second.counted("garbage") == 0


def test_genuine_that_closes_idle_connections_is_never_seen_down(scene):
    server = scene.owserver(tester=["28"], options=["--timeout_persistent_low=1",
                                                    "--timeout_persistent_high=1"])
    sensor = server.devices()[0]
    with Bus(scene, server.target) as bus:
        bus.ok("up")

        def stale():
            bus.ok(f"read {sensor}/temperature")
            bus.ok(f"write {sensor}/templow 1")
            return bus.counted("stale_connection") >= 2
        owsdtest.until(stale, 20, "closed connections are found", step=1.2)
        assert bus.counted("reconnects") == 0


def test_genuine_killed_frozen_and_started_again(scene):
    server = scene.owserver(tester=["28"])
    sensor = server.devices()[0]
    with Bus(scene, server.target) as bus:
        bus.ok("up")
        bus.ok(f"read {sensor}/temperature")
        server.kill()
        bus.fails(f"read {sensor}/temperature", errno.ECONNRESET, errno.ENOTCONN)
        why = bus.ok("down")  # the port of a process that ends may take one more connection
        assert any(word in why for word in ("refused", "closed", "reset")), why
        server = scene.again(server)
        bus.ok("up")
        bus.ok(f"read {sensor}/temperature")
        server.freeze()
        bus.ok("timeout 300")
        bus.fails(f"read {sensor}/temperature", errno.ETIMEDOUT)
        bus.ok("down")
        server.thaw()
        bus.ok("up")
        bus.ok("timeout 60000")
        bus.ok(f"repeat 100 {sensor}/temperature")
        assert bus.counted("reconnects") == 2


def test_genuine_started_after_the_bus(scene):
    port = owsdtest.free_port()
    with Bus(scene, f"127.0.0.1:{port}") as bus:
        assert "refused" in bus.ok("down")
        bus.fails("read /", errno.ENOTCONN)
        server = scene.owserver(tester=["28"], port=port)
        bus.ok("up")
        bus.ok(f"read {server.devices()[0]}/temperature")


# --- a peer that lies -----------------------------------------------------------------------------
def test_every_loss_takes_it_down_once_and_it_comes_back(scene):
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        for mode in ("kill", "reset reset", "close close"):
            server.plan.extend(mode.split())
            bus.fails(f"read {T}", errno.ECONNRESET)
            bus.ok("down")
            bus.ok("up")
            assert bus.ok(f"read {T}") == "     21.5"


def test_every_garbage_takes_it_down_and_it_comes_back(scene):
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        for mode in ("garbage", "trailing", "negative", "huge", "version", "wrong", "endless"):
            server.plan.append(mode)
            bus.fails(f"read {T}", errno.EPROTO)
            bus.ok("down")
            bus.ok("up")
            assert bus.ok(f"read {T}") == "     21.5", mode
        assert bus.counted("garbage") == 7
        assert bus.ok(f"simulated {T}") == "no"


def test_slow_with_keep_alives_is_served_and_too_slow_is_no_loss(scene):
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        server.plan.append("slow 0.7")
        assert bus.ok(f"read {T}") == "     21.5"
        assert bus.counted("keepalives") >= 2
        bus.ok("timeout 3000")
        server.plan.extend(["alive", "endless", "stall"])
        bus.fails(f"read {T}", errno.EINPROGRESS)
        bus.fails("dir /", errno.EINPROGRESS)
        bus.fails(f"read {T}", errno.EINPROGRESS)
        bus.ok(f"read {T}")
        assert bus.counted("reconnects") == 0


def test_silence_is_a_loss(scene):
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        bus.ok("timeout 300")
        server.plan.append("hang")
        bus.fails(f"read {T}", errno.ETIMEDOUT)
        bus.ok("down")
        bus.ok("up")
        bus.ok("timeout 60000")
        bus.ok(f"read {T}")


def test_a_write_reaches_the_server_once_whatever_happens(scene):
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        bus.ok(f"write {OUT} 1")
        server.plan.append("close")
        bus.fails(f"write {OUT} 2", errno.ECONNRESET)
        assert server.writes == [(OUT, b"1"), (OUT, b"2")]


def test_fragments_refusals_and_ipv6(scene):
    owsdtest.need_ipv6()
    with liar(host="::1") as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        server.plan.extend(["fragments", "refuse", "refuse", "close_after"])
        for _ in range(6):
            assert bus.ok(f"read {T}") == "     21.5"
        assert bus.counted("refused_persistence") == 2
        assert bus.counted("reconnects") == 0


def test_a_server_that_accepts_and_closes_or_never_speaks_is_not_up(scene):
    with liar() as server:
        server.mode = "accept_close"
        with Bus(scene, server.target) as bus:
            bus.ok("down")
            bus.fails(f"read {T}", errno.ENOTCONN)
            server.mode = "dead"
            before = server.connections
            owsdtest.until(lambda: server.connections > before, 10, "it tries again")
            bus.fails(f"read {T}", errno.ENOTCONN)
            server.down()
            server.mode = "normal"
            server.up()
            bus.ok("up")


def test_faults_without_end_leak_neither_descriptors_nor_memory(scene):
    modes = ["kill", "close", "reset", "garbage", "refuse", "fragments", "normal", "huge"]
    with liar() as server, Bus(scene, server.target) as bus:
        bus.ok("up")
        bus.ok("dir /")
        bus.ok("timeout 200")
        for i in range(160):
            if i == 80:
                before = (bus.descriptors(), bus.resident_kb())
            server.plan.append(modes[i % len(modes)])
            bus(f"read {T}" if i % 3 else f"write {OUT} 1")
            if i % 10 == 9:
                server.plan.clear()
                bus.ok("up") if bus(f"probe {T}") == ("error", errno.ENOTCONN) else None
        assert bus.descriptors() <= before[0] + 1
        # A part of what there is, because a sanitizer's shadow grows with it
        assert bus.resident_kb() <= before[1] * 1.25, (bus.resident_kb(), before[1])


if __name__ == "__main__":
    owsdtest.main()
