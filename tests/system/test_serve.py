#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The served owserver protocol: byte for byte as the genuine owserver, and what it adds."""

import os
import signal
import socket
import struct
import time

import owsdtest
from owsdtest import until

DIR, PRESENT, GET, DIRALLSLASH, GETSLASH = 4, 6, 8, 9, 10
NOP, READ, WRITE, DIRALL = 1, 2, 3, 7
PERSIST, UNCACHED = 0x4, 0x20


class Link:
    """A connection that stays open as long as the server lets it."""

    def __init__(self, port, host="127.0.0.1", path=None, seconds=owsdtest.PATIENCE):
        if path:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.settimeout(seconds)
            self.socket.connect(path)
        else:
            self.socket = socket.create_connection((host, port), timeout=seconds)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def exactly(self, n):
        data = b""
        while len(data) < n:
            more = self.socket.recv(n - len(data))
            if not more:
                raise EOFError
            data += more
        return data

    def frame(self):
        """One answer: (ret, flags, size, offset, data); keep-alives are None."""
        _, length, ret, flags, size, offset = struct.unpack(">6i", self.exactly(24))
        if length < 0:
            return None
        return ret, flags, size, offset, self.exactly(length)

    def send(self, kind, path, data=b"", size=8192, flags=0x10A, offset=0):
        body = b"" if path is None else path.encode() + b"\0" + data
        self.socket.sendall(struct.pack(">6i", 0, len(body), kind, flags,
                                        len(data) if kind == WRITE else size, offset) + body)

    def answers(self):
        """All frames of the answer to a DIR."""
        frames = []
        while not frames or frames[-1][4]:
            frames.append(self.answer())
            if frames[-1][0] < 0:
                break
        return frames

    def answer(self):
        while True:
            frame = self.frame()
            if frame:
                return frame


def ask(port, kind, path, *arguments, **keys):
    """One request on a connection of its own; of a DIR all frames."""
    with Link(port) as link:
        link.send(kind, path, *arguments, **keys)
        return link.answers() if kind == DIR else link.answer()


def served(scene, config, *options, **keys):
    """An owsd that serves, and its port."""
    port = owsdtest.free_port()
    return scene.owsd(config, "-l", str(port), *options, **keys), port


def house(scene, *options):
    """On the simulated house of the demonstration."""
    folder = owsdtest.SOURCE / "board/demo"
    daemon, port = served(scene, folder / "house.rio", "-t", f"sim:{folder}/house.sim", *options)
    until(lambda: scene.get(daemon, "boiler"), 10, "boiler is good")
    return daemon, port


def names(answer):
    ret, _, size, _, data = answer
    assert ret == 0, ret
    assert len(data) == (size + 1 if size else 0)
    return data.rstrip(b"\0").decode().split(",") if data else []


def beside(scene):
    """A genuine owserver, and an owsd in front of it: two ports that shall answer the same."""
    server = scene.owserver(tester=["28", "29", "26", "10", "1D", "20"])
    daemon, port = served(scene, owsdtest.rio(server.target, []))
    until(lambda: ask(port, PRESENT, server.devices()[0])[0] == 0, 10, "the target is up")
    return server, daemon, port


def same(genuine, port, *arguments, **keys):
    want = ask(genuine.port, *arguments, **keys)
    have = ask(port, *arguments, **keys)
    assert have == want, f"{arguments} {keys}:\n have {have}\n want {want}"


def device(server, family):
    return next(d for d in server.devices() if d.startswith("/" + family))


def test_reads_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path in (t + "/temperature", t + "/type", t + "/address", t + "/power", t + "/alias",
                 s + "/sensed.BYTE", s + "/sensed.ALL", s + "/PIO.0", s + "/set_alarm",
                 "/uncached" + t + "/temperature", "/bus.0" + t + "/temperature",
                 "/structure/28/temperature", "/system/configuration/version",
                 "/bus.0/interface/settings/name", t.replace(".", "") + "/type",
                 t.lower() + "/type", t[1:] + "/type", device(server, "26") + "/B1-R1-A/pressure"):
        for kind in (READ, GET):
            same(server, port, kind, path)
            same(server, port, kind, path, flags=0x14A)
    for size, offset in ((5, 0), (12, 4), (12, 12), (65536, 0), (65537, 0), (0, 0), (-1, 0),
                         (2, 13), (12, -1), (0x7FFFFFFF, 0)):
        same(server, port, READ, t + "/temperature", size=size, offset=offset)


def test_scales_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    for path in (device(server, "28") + "/temperature", device(server, "28") + "/templow",
                 device(server, "29") + "/sensed.BYTE", device(server, "10") + "/temperature",
                 device(server, "26") + "/B1-R1-A/pressure"):
        for scale in range(4):
            for pressure in range(6):
                same(server, port, READ, path, flags=0x10A | scale << 16 | pressure << 18)
                same(server, port, READ, path, flags=0x14A | scale << 16 | pressure << 18)


def test_directories_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path in ("/bus.0", "/bus.0/", t, t + "/", s, t + "/errata", "/alarm", "/structure",
                 "/structure/28", "/structure/29", "/simultaneous", "/settings",
                 "/settings/units", "/statistics", "/statistics/cache", "/system",
                 "/system/process", "/uncached" + t, "/bus.0" + t, "/bus.0/interface",
                 "/bus.0/interface/settings", "/uncached/bus.0", "/bus.0/alarm", t[1:], "bus.0",
                 t.replace(".", ""), device(server, "26"), device(server, "1D")):
        for kind in (DIRALL, DIRALLSLASH, DIR, GET, GETSLASH):
            same(server, port, kind, path)
    for device_format in range(6):
        same(server, port, DIRALL, "/bus.0", flags=0x10A | device_format << 24)
        same(server, port, DIRALL, "/", flags=0x108 | device_format << 24)


def test_the_root_is_that_of_the_genuine_owserver_and_has_signals(scene):
    server, _, port = beside(scene)
    same(server, port, DIRALL, "/", flags=0x108)
    same(server, port, DIRALL, "/uncached", flags=0x108)
    want, have = names(ask(server.port, DIRALL, "/")), names(ask(port, DIRALL, "/"))
    assert have == want + ["/signals"], have
    want, have = names(ask(server.port, DIRALL, "/uncached")), names(ask(port, DIRALL, "/uncached"))
    assert have == want + ["/uncached/signals"], have


def test_errors_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    absent = "/28.AABBCCDDEEFF"
    for path in (absent, absent + "/temperature", t + "/nonsense", t, "/", "/nonsense", "",
                 t + "/temperature/", t + "/temperature.0", s + "/PIO", s + "/PIO.8",
                 s + "/PIO.A", t + "/temperature.ALL", "/99.112233445566/address", "/bus.9",
                 "/bus.9" + absent, "/" + t + "//address", "/structure", "/settings",
                 "/28.AABBCCDDEEFF77/temperature", t + "/", "/x" * 2000, s + "/LCD_M/message"):
        for kind in (READ, DIRALL, DIR, PRESENT, GET, GETSLASH, DIRALLSLASH):
            # of a target that is an owserver, a property that is none is as present as its device
            if kind != PRESENT or path.count("/") < 2 or path.startswith(absent):
                same(server, port, kind, path, flags=0x108)
    for path in (None, ""):
        for kind in (NOP, READ, DIRALL, DIR, PRESENT, GET):
            same(server, port, kind, path, flags=0x108)
    for kind in (0, 5, 11, 99, -1):
        same(server, port, kind, t + "/address")


def test_writes_are_those_of_the_genuine_owserver(scene):
    server, _, port = beside(scene)
    t, s = device(server, "28"), device(server, "29")
    for path, data in ((t + "/templow", b"10"), (t + "/templow", b"10.5"), (t + "/templow", b"abc"),
                       (t + "/templow", b"12abc"), (t + "/templow", b""),
                       (t + "/temperature", b"10"), (t + "/address", b"1"),
                       (t + "/nonsense", b"1"), ("/28.AABBCCDDEEFF/templow", b"1"), (t, b"1"),
                       (s + "/PIO.BYTE", b"255"), (s + "/PIO.0", b"1"), (s + "/PIO.0", b"yes"),
                       (s + "/PIO.0", b"maybe"), (s + "/PIO.ALL", b"1,0,1"), (s + "/PIO", b"1"),
                       ("/", b"1"),
                       ("/simultaneous/temperature", b"1"), ("/settings/timeout/volatile", b"15"),
                       ("/settings/timeout/nonsense", b"15")):
        same(server, port, WRITE, path, data)
    for scale in range(4):
        same(server, port, WRITE, t + "/templow", b"50", flags=0x10A | scale << 16)



def value(answer):
    ret, _, size, _, data = answer
    assert ret == size == len(data), answer
    return data.decode()


def stat(scene, daemon, name):
    for line in scene.owsctl(daemon, "stats").stdout.splitlines():
        if line.split()[1:2] == [name]:
            return int(line.split()[0])
    raise AssertionError(f"no counter {name}")


def test_signals_are_a_directory(scene):
    daemon, port = house(scene)
    table = scene.owsctl(daemon, "list").stdout
    listed = names(ask(port, DIRALL, "/signals"))
    assert "/signals/boiler" in listed and "/signals/pump" in listed, listed
    assert all(name.split("/")[2] in table for name in listed)
    assert names(ask(port, DIRALL, "/uncached/signals"))[0].startswith("/uncached/signals/")
    until(lambda: scene.get(daemon, "cellar") == "12.5", 5, "cellar is good")
    assert value(ask(port, READ, "/signals/cellar")) == "12.5"
    assert float(value(ask(port, READ, "/signals/cellar_Age"))) < 300
    assert int(value(ask(port, READ, "/signals/_TRANSACTIONS"))) > 0
    assert value(ask(port, READ, f"/signals/{daemon.name}__cellar")) == "12.5"
    assert ask(port, READ, "/signals/nobody")[0] == -1
    assert ask(port, READ, "/signals")[0] == -21
    assert ask(port, DIRALL, "/signals/cellar")[0] == -20
    assert ask(port, READ, "/signals/cellar_WriteOneShot")[0] == -95
    assert ask(port, PRESENT, "/signals/cellar")[4] == bytes(8)
    assert ask(port, PRESENT, "/signals/nobody")[0] == -1
    # a signal has no unit, whatever scale a client wants
    assert value(ask(port, READ, "/signals/cellar", flags=0x1010A)) == "12.5"


def test_a_signal_that_is_not_good_is_an_error_and_no_value(scene):
    folder = owsdtest.SOURCE / "board/demo"
    _, port = served(scene, owsdtest.rio(f"sim:{folder}/house.sim", [
        dict(Name="gone", Path="/28.AABBCCDDEEFF/temperature", Type="double", IO="input",
             InitValue="20"),
        dict(Name="cellar", Path="/10.0000000000C1/temperature", Type="double", IO="input"),
    ], MaxRetries=0))
    until(lambda: ask(port, READ, "/signals/cellar")[0] > 0, 10)
    assert ask(port, READ, "/signals/gone")[0] == -5
    assert float(value(ask(port, READ, "/signals/gone_Age"))) > 0


def test_outputs_are_commanded_as_signals_and_by_their_paths(scene):
    daemon, port = house(scene)
    relay = "/29.000000000001/PIO.1"
    for path, text, state in (("/signals/pump", b"1", "1"), (relay, b"0", "0"),
                              ("/signals/pump", b"on\n", "1"), (relay, b"0\n", "0"),
                              # owjs and SmartHomeNG end each text with a NUL
                              ("/signals/pump", b"on\0", "1"), (relay, b"0\0", "0"),
                              ("/signals/pump", b" 1\r\n\0", "1")):
        assert ask(port, WRITE, path, text)[:1] == (0,), path
        # the answer comes when the bus has it
        assert scene.owsctl(daemon, "get", "pump").stdout == state + "\n"
        assert value(ask(port, READ, "/uncached" + relay)) == state
    assert ask(port, WRITE, "/signals/boiler", b"1")[0] == -95
    assert ask(port, WRITE, "/signals/pump", b"many")[0] == -22
    assert ask(port, WRITE, "/signals/pump", b"0\0001")[0] == -22
    assert ask(port, WRITE, "/signals/pump", b"7")[0] == -34
    assert ask(port, WRITE, "/signals/nobody", b"7")[0] == -1


def test_a_write_that_would_change_an_output_by_another_property_is_refused(scene):
    """Before, it was a success, and owsd undid it at once."""
    daemon, port = house(scene)
    relay = "/29.000000000001/PIO"
    assert ask(port, WRITE, "/signals/pump", b"1")[0] == 0
    for path in (".BYTE", ".ALL"):
        text = b"0" if path == ".BYTE" else b"0,0,0,0,0,0,0,0"
        for before in ("", "/uncached", "/bus.0"):
            assert ask(port, WRITE, before + relay + path, text)[0] == -30, (before, path)
    owsdtest.logged(daemon, f"to what the output light ({relay}.0) sets")
    assert value(ask(port, READ, f"/uncached{relay}.1")) == "1"
    assert ask(port, WRITE, relay + ".5", b"1")[0] == 0, "no output has this pin"
    assert value(ask(port, READ, f"/uncached{relay}.5")) == "1"
    assert stat(scene, daemon, "served_refused_writes") == 6


def test_a_pin_of_an_output_of_all_pins_is_refused_to_clients(scene):
    both, pair = "/29.000000000001/PIO", "/3A.000000000001/PIO"
    house = scene.file("house.sim", "chip DS2482-100 0x18\nDS2408 29.000000000001\nDS2413 3A.000000000001\n")
    daemon, port = served(scene, owsdtest.rio(f"sim:{house}", [
        dict(Name="relays", Path=both + ".BYTE", Type="byte", IO="output", InitValue=5),
        dict(Name="pair", Path=pair + ".BYTE", Type="byte", IO="output", InitValue=1)]))
    until(lambda: scene.get(daemon, "relays") == "5", 10)
    for path, text in ((both + ".1", b"1"), (both + ".ALL", b"1,1,1,1,1,1,1,1"), (pair + ".A", b"0"),
                       (pair + ".ALL", b"0,0")):
        assert ask(port, WRITE, path, text)[0] == -30, path
    assert ask(port, WRITE, both, b"1")[0] == -1, "no such property"
    asked = scene.owsctl(daemon, "write", both + ".1", "1")
    assert asked.returncode == 1 and "owsctl set relays" in asked.stderr, asked
    assert value(ask(port, READ, "/uncached" + both + ".BYTE")).strip() == "5"


def test_inputs_are_answered_from_the_table(scene):
    daemon, port = house(scene)
    def counted():
        return [stat(scene, daemon, name) for name in ("served_kept_answers", "served_bus_requests")]

    def ten_are_from_the_table():
        """For two seconds, which may be over; a little later there is a new value."""
        until(lambda: scene.get(daemon, "cellar"), 5)
        before = counted()
        for _ in range(5):
            assert value(ask(port, READ, "/10.0000000000C1/temperature")) == "        12.5"
            assert value(ask(port, READ, "/10.0000000000C1/temperature", flags=0x1014A)) == "54.5"
        until(lambda: sum(counted()) >= sum(before) + 10, 5, "all ten are counted")
        return counted()[1] == before[1]
    until(ten_are_from_the_table, 20, "the bus is not asked")


def test_a_slow_answer_is_announced_by_keep_alives(scene):
    _, port = house(scene)
    with Link(port) as link:
        link.send(READ, "/uncached/28.A30000000000/temperature12", flags=0x10E)
        link.send(NOP, None, flags=0x10E)
        frames = [link.frame() for _ in range(2)]
        while frames[-1] is None or frames[-1][4]:
            frames.append(link.frame())
    # two conversions of 750 ms with the strong pull-up are more than a second
    answers = [f for f in frames if f]
    assert len(answers) == 2 and len(answers[0][4]) == 12, frames
    assert frames[-1][0] == 0


def test_a_connection_is_kept_and_may_be_used_in_advance(scene):
    server, _, port = beside(scene)
    paths = [d + "/type" for d in server.devices()] * 20
    with Link(port) as link:
        for path in paths:
            link.send(READ, path, flags=0x10E)
        for path in paths:
            ret, flags, _, _, data = link.answer()
            assert ret > 0 and flags & PERSIST, path
            assert data.startswith(b"DS"), data
        link.send(NOP, None, flags=0x10A)
        assert link.answer()[0] == 0
        try:
            link.frame()
            raise AssertionError("the connection was not closed")
        except EOFError:
            pass


def test_read_only_refuses_every_write(scene):
    folder = owsdtest.SOURCE / "board/demo"
    config = (folder / "house.rio").read_text().replace("OwsDrv {", "OwsDrv {\n  ListenReadOnly on", 1)
    daemon, port = served(scene, config, "-t", f"sim:{folder}/house.sim")
    for path in ("/signals/pump", "/29.000000000001/PIO.1", "/28.B10000000000/templow",
                 "/settings/timeout/volatile", "/simultaneous/temperature"):
        assert ask(port, WRITE, path, b"1")[0] == -30, path
    until(lambda: stat(scene, daemon, "served_refused_writes") == 5, 5)


def test_a_unix_socket_serves_too_and_belongs_to_those_who_may_command(scene):
    path = str(scene.path / "owserver.sock")
    folder = owsdtest.SOURCE / "board/demo"
    config = (folder / "house.rio").read_text().replace(
        "OwsDrv {", f'OwsDrv {{\n  ListenSocket "{path}"', 1)
    daemon = scene.owsd(config, "-t", f"sim:{folder}/house.sim")
    assert os.stat(path).st_mode & 0o777 in (0o600, 0o660)
    with Link(0, path=path) as link:
        link.send(READ, "/settings/return_codes/text.0")
        assert link.answer()[4] == b"good"
    assert daemon.stop() == 0
    assert not os.path.exists(path)


def test_a_killed_owsd_leaves_no_socket_in_the_way(scene):
    path = str(scene.path / "owserver.sock")
    config = scene.file("a.rio", owsdtest.rio("null:", []).replace(
        "OwsDrv {", f'OwsDrv {{\n  ListenSocket "{path}"', 1))
    scene.owsd(config).kill()
    assert os.path.exists(path)
    scene.owsd(config)
    done = scene.owsd_once("-n", scene.name(), "-c", config)
    assert done.returncode == 1 and "another process serves it" in done.stderr, done.stderr


def test_signals_do_not_wait_for_an_address_that_is_not_there_yet(scene):
    owsdtest.need_ipv6()
    folder = owsdtest.SOURCE / "board/demo"
    port = owsdtest.free_port()
    config = (folder / "house.rio").read_text().replace(
        "OwsDrv {", f'OwsDrv {{\n  Listen "{port}, 192.0.2.77:{port}, [2001:db8::77]:{port}"', 1)
    daemon = scene.owsd(config, "-t", f"sim:{folder}/house.sim")
    for address in ("192.0.2.77", "2001:db8::77"):
        owsdtest.logged(daemon, f"no interface of this machine has {address}; ip addr lists")
    until(lambda: stat(scene, daemon, "served_absent") == 2, 20, "they are counted")
    done = scene.owsctl(daemon, "doctor")
    assert done.returncode == 1 and "of Listen: no interface of this machine has " in done.stdout, done
    done = scene.owsctl(daemon, "reload")
    assert "reloaded, with 2 warnings; the first: no interface of this machine has 192.0.2.77" in done.stdout, done
    assert ask(port, READ, "/settings/return_codes/text.0")[4] == b"good"


def test_a_port_in_use_is_said(scene):
    server = scene.owserver(tester=["28"])
    done = scene.owsd_once("-n", scene.name(), "-c", scene.file("a.rio", owsdtest.rio("null:", [])),
                           "-l", str(server.port))
    assert done.returncode == 1, done
    assert f"cannot listen at 127.0.0.1:{server.port}: Address already in use" in done.stderr


def test_wrong_addresses_are_refused_with_their_place(scene):
    for key, text, what in (("Listen", "here:4304", "expected an address of this machine"),
                            ("Listen", "4304, 4304", "is given twice"),
                            ("Listen", "70000", "expected"),
                            ("ListenAllow", "10.0.0.0/33", "expected an address or a range"),
                            ("ListenSocket", "a.sock", "expected a path from the root")):
        config = scene.file("a.rio", owsdtest.rio("null:", [], **{key: text}))
        done = scene.owsd_once("--check", "-c", config)
        assert done.returncode == 2 and what in done.stderr and "a.rio:4:" in done.stderr, done


def test_it_is_served_to_this_machine_alone_unless_asked(scene):
    owsdtest.need_ipv6()
    daemon, port = served(scene, owsdtest.rio("null:", []))
    assert ask(port, NOP, None)[0] == 0
    with Link(port, host="::1") as link:
        link.send(NOP, None)
        assert link.answer()[0] == 0
    assert "beyond this machine" not in daemon.log(), daemon.log()

    def listening():
        with open("/proc/net/tcp", encoding="ascii") as table:
            rows = [line.split() for line in table]
        return {row[1].split(":")[0] for row in rows
                if row[1].endswith(f":{port:04X}") and row[3] == "0A"}
    # others come and go while the table is read
    until(lambda: listening() == {"0100007F"}, 5, lambda: f"loopback alone: {listening()}")
    port = owsdtest.free_port()
    daemon = scene.owsd(owsdtest.rio("null:", []), "-l", f"0.0.0.0:{port}")
    assert ask(port, NOP, None)[0] == 0
    owsdtest.logged(daemon, "beyond this machine and lets everybody write")


def test_all_addresses_are_those_of_ipv4_too(scene):
    owsdtest.need_ipv6()

    def reached(port, host):
        with Link(port, host=host) as link:
            link.send(NOP, None)
            return link.answer()[0] == 0

    for listen in (["[::]"], ["0.0.0.0", "[::]"], ["127.0.0.1", "[::]"]):
        port = owsdtest.free_port()
        options = [word for host in listen for word in ("-l", f"{host}:{port}")]
        scene.owsd(owsdtest.rio("null:", [], ListenAllow="192.0.2.0/24"), *options)
        assert reached(port, "127.0.0.1") and reached(port, "::1"), listen


def test_several_targets_are_one_network(scene):
    server = scene.owserver(tester=["28", "29"])
    other = scene.owserver(tester=["26"])
    folder = owsdtest.SOURCE / "board/demo"
    daemon, port = served(scene, owsdtest.rio(
        f"{server.target}, sim:{folder}/house.sim, {other.target}", []))
    everything = ["/28.B10000000000", *other.devices(), *server.devices()]
    until(lambda: all(path.encode() in ask(port, DIRALL, "/", flags=0x108)[4]
                      for path in everything), 10, "all targets are up")
    listed = names(ask(port, DIRALL, "/"))
    assert len(listed) == len(set(listed)), listed
    assert [n for n in listed if n.startswith("/bus")] == ["/bus.0", "/bus.1", "/bus.2"], listed
    for path in everything:
        assert ask(port, READ, path + "/type")[0] > 0, path
        assert ask(port, PRESENT, path)[0] == 0, path
    held = {n: next(b for b in range(3) if f"/bus.{b}{n}" in names(ask(port, DIRALL, f"/bus.{b}")))
            for n in everything}
    assert len(set(held.values())) == 3, held
    for path, bus in held.items():
        assert ask(port, READ, f"/bus.{bus}{path}/type")[0] > 0
    assert ask(port, READ, "/28.AABBCCDDEEFF/type")[0] == -1
    assert ask(port, READ, "/bus.3/28.AABBCCDDEEFF/type")[0] == -1
    assert "/structure/28" in names(ask(port, DIRALL, "/structure"))
    assert ask(port, WRITE, "/simultaneous/temperature", b"1")[0] == 0


def test_a_target_that_is_down_is_an_error_at_once(scene):
    _, port = served(scene, owsdtest.rio(f"127.0.0.1:{owsdtest.free_port()}", [], Timeout=600))
    assert ask(port, READ, "/28.AABBCCDDEEFF/type")[0] == -5
    assert ask(port, DIRALL, "/")[0] == -5


def test_it_ends_at_once_with_idle_clients(scene):
    daemon, port = served(scene, owsdtest.rio("null:", []))
    links = [Link(port) for _ in range(20)]
    for link in links[:10]:
        link.send(NOP, None, flags=0x10E)
        assert link.answer()[0] == 0
    until(lambda: stat(scene, daemon, "served_connections") >= 20, 10, "all are let in")
    assert daemon.stop() == 0  # an idle one may stay for ten minutes
    for link in links:
        assert link.socket.recv(1) == b""
        link.socket.close()


if __name__ == "__main__":
    owsdtest.main()
