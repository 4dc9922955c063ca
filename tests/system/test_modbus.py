#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-modbus beside a real owsd: genuine clients read what owsctl shows, at addresses that stay."""

import json
import math
import os
import re
import resource
import shutil
import signal
import socket
import struct
import subprocess
import time

import owsdtest
from modbushouse import (ABSENT, ADDRESS, AGE, ALARM, BUSY, CELLAR, COUNT, Client, DECIMALS, DOUBLE,
                         FLAGS, FLOAT, FUNCTION, GOOD, LONG, MODBUS, NO_DEVICE, NO_OWSD,
                         NO_PROPERTY, NO_TARGET, QUALITY, RELAY, RELAYS, ROOM, Refused, SENSOR,
                         SHORT, VALUE, refused, serve, text)
from owsdtest import free_port, logged, until


def known_by(scene):
    """identity -> place, as the file of the map has it."""
    lines = (scene.path / "state/map").read_text().splitlines()
    return {identity: int(place) for place, identity in (line.split(" ", 1) for line in lines if line[0] != "#")}


def test_a_signal_is_read_in_each_form_with_its_quality_age_and_alarm(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(1, GOOD)
        assert plc.number_at(16 + DOUBLE, ">d") == plc.number_at(16 + DOUBLE, ">d", 4) == 21.5
        assert plc.number_at(16 + FLOAT, ">f") == 21.5
        assert plc.number_at(16 + LONG, ">i") == plc.number_at(16 + SHORT, ">h") == 215
        assert plc.registers(16 + DECIMALS, 1) == (1,)
        until(lambda: plc.registers(16 + ALARM, 1)[0] == 0x0403, 20, "the alarm H stands, and nobody has seen it")
        assert scene.owsctl(daemon, "alarms", "ack", "room").returncode == 0
        until(lambda: plc.registers(16 + ALARM, 1)[0] == 0x0401, 20, "it is acknowledged")
        until(lambda: plc.number_at(16 + AGE, ">I") < 100, 20, "it is measured again and again")
        count = plc.registers(16 + COUNT, 1)
        until(lambda: plc.registers(16 + COUNT, 1) != count, 20, "and counted")
        # an output, of whole numbers; a string has no place
        assert scene.owsctl(daemon, "set", "-w", "20", "relays", "5").returncode == 0
        until(lambda: plc.number_at(32 + SHORT, ">h") == 5, 20, "the output is shown")
        assert plc.registers(32 + DECIMALS, 2) == (0, 0x203)  # check function; simulated, an output
        plc.becomes(3, NO_DEVICE)
        assert math.isnan(plc.number_at(48 + DOUBLE, ">d")) and math.isnan(plc.number_at(48 + FLOAT, ">f"))
        assert plc.number_at(48 + LONG, ">I") == 0x80000000 and plc.number_at(48 + SHORT, ">H") == 0x8000
        assert plc.number_at(48 + AGE, ">I") == 0xFFFFFFFF
        assert refused(plc.registers, 64, 1) == ADDRESS
        # the same in rows
        assert plc.registers(43001, 3) == (GOOD, GOOD, NO_DEVICE)
        assert plc.number_at(46002, ">f") == 21.5 and plc.number_at(56008, ">d") == 5
        assert plc.bits(1, 2, 2) == [1, 1] and plc.bits(10001, 3, 2) == [1, 1, 0] and plc.bits(20001, 3, 2) == [1, 0, 0]
        assert refused(plc.bits, 1, 3) == NO_TARGET
    assert known_by(scene) == {SENSOR + "/temperature": 1, RELAY + "/PIO.BYTE": 2, ABSENT["Path"]: 3}
    assert face.stop() == 0


def test_the_header_shows_that_owsd_lives_and_no_value_is_good_when_it_is_dead(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(1, GOOD)
        magic, version, live, heart, _, last, signals, changed, now = struct.unpack(
            ">I6HII", struct.pack(">12H", *plc.registers(0, 12)))
        assert (magic, version, live, last, signals) == (0x4F575344, 1, 1, 3, 3)
        assert abs(now - time.time()) < 60 and now - 3600 < changed <= now, (now, changed)
        until(lambda: plc.registers(4, 1)[0] != heart, 20, "its heart beats")
        daemon.kill()
        plc.becomes(1, NO_OWSD)
        assert math.isnan(plc.number_at(16 + DOUBLE, ">d")) and plc.registers(3, 1) == (0,)
        heart = plc.registers(4, 1)
        time.sleep(0.5)  # pace: five beats of a heart that beats
        assert plc.registers(4, 1) == heart
        scene.owsd(daemon.config, name=daemon.name)
        plc.becomes(1, GOOD)
        assert plc.registers(3, 1) == (1,)
    assert face.stop() == 0


def test_addresses_stay_when_signals_are_added_removed_sorted_renamed_and_replaced(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, ABSENT, RELAYS))
    face = serve(scene, daemon)

    def reload(*items):
        daemon.config.write_text(text(scene, port, *items))
        assert scene.owsctl(daemon, "reload").returncode == 0

    with Client(port) as plc:
        plc.becomes(1, GOOD)
        # sorted otherwise, renamed, one more in front, one removed
        reload(CELLAR, RELAYS, {**ROOM, "Name": "bedroom"})
        plc.becomes(4, GOOD)
        assert plc.number_at(16 * 4, ">d") == -3.25 and plc.number_at(16, ">d") == 21.5
        assert plc.quality(2) == NO_PROPERTY and math.isnan(plc.number_at(32, ">d"))
        assert plc.registers(5 + 1, 2) == (4, 3)
        # replaced by another chip, under the identity of the first
        reload({**CELLAR, "Name": "room", "Identity": SENSOR + "/temperature"}, ABSENT)
        until(lambda: plc.number_at(16, ">d") == -3.25, 20, "the other chip stands where the first stood")
        assert plc.quality(3) == plc.quality(4) == NO_PROPERTY
        # and over a new start
        assert face.stop() == 0
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(1, GOOD)
        assert plc.number_at(16, ">d") == -3.25 and plc.registers(6, 2) == (4, 2)
    assert face.stop() == 0


def test_owsctl_shows_the_addresses_as_table_csv_json_and_as_the_file_of_map(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, ABSENT, {**CELLAR, "Unit": "°C"}))

    def owsctl(*arguments):
        return scene.owsctl(daemon, *arguments, "-d", scene.path / "state")
    assert "has owsd-modbus run" in owsctl("modbus-map").stderr
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(3, GOOD)
        rows = json.loads(owsctl("--json", "modbus-map").stdout)
        assert [row["name"] for row in rows] == ["room", "absent", "cellar"]
        assert rows[2] == {"place": 3, "record": 48, "float32": 46006, "float64": 56012, "name": "cellar",
                           "type": "double", "io": "input", "unit": "°C", "identity": CELLAR["Path"]}
        assert plc.number_at(rows[2]["float32"], ">f") == plc.number_at(rows[2]["float64"], ">d") == -3.25
        assert plc.number_at(rows[2]["record"], ">d") == -3.25
        daemon.config.write_text(text(scene, port, ROOM, CELLAR))
        assert scene.owsctl(daemon, "reload").returncode == 0
        plc.becomes(2, NO_PROPERTY)
    lines = owsctl("modbus-map", "--as", "csv").stdout.splitlines()
    assert lines[0] == "place,record,float32,float64,name,type,io,unit,identity"
    assert lines[2] == f'"2","32","46004","56008","","","","","{ABSENT["Path"]}"'
    assert re.search(r"^ *3 +48 +46006 +56012 +cellar +double +input", owsctl("modbus-map").stdout, re.M)
    kept = owsctl("modbus-map", "--as", "map").stdout
    assert kept == "".join(line for line in (scene.path / "state/map").read_text().splitlines(True) if line[0] != "#")
    assert owsctl("--json", "modbus-map", "--as", "csv").returncode == 2
    assert face.stop() == 0


def test_places_of_the_configuration_win_and_a_map_that_is_none_serves_nothing(scene):
    port = free_port()
    fixed = scene.file("fixed", f"# by hand\n700 {SENSOR}/temperature\n")
    daemon = scene.owsd(text(scene, port, ROOM, RELAYS, Map=fixed))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(700, GOOD)
        assert plc.registers(16 * 701 + FLAGS, 1)[0] & 1
        assert refused(plc.registers, 16, 1) == ADDRESS
        assert serve(scene, daemon).wait() == 1  # one program has the map
        fixed.write_text("700\n")
        face.signal(signal.SIGHUP)
        logged(face, f"the map {fixed}, line 1: no place and identity: no signal is served until it can be read")
        assert refused(plc.registers, 16 * 700, 1) == ADDRESS and plc.registers(7, 1) == (0,)
        done = scene._run([MODBUS, "-c", daemon.config, "--check"], 20)
        assert done.returncode == 2 and f"Map: {fixed}:1: expected a place from 1 to 2047" in done.stderr, done
        fixed.write_text(f"7 {RELAY}/PIO.BYTE\n")
        face.signal(signal.SIGHUP)
        plc.becomes(700, GOOD)
        assert plc.registers(16 * 7 + FLAGS, 1)[0] & 1
    assert face.stop() == 0


def test_a_genuine_client_reads_what_is_served(scene):
    """mbpoll, which is libmodbus."""
    if not shutil.which("mbpoll"):
        owsdtest.skip("mbpoll is not installed")
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, CELLAR))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(1, GOOD)
        plc.becomes(2, GOOD)

    def poll(*options):
        done = scene._run(["mbpoll", "-m", "tcp", "-p", port, "-0", "-1", *options, "127.0.0.1"], 20)
        assert done.returncode == 0, done
        return [float(value) for value in re.findall(r"^\[\d+\]:\s+(\S+)", done.stdout, re.M)]
    page = re.search(r"^mbpoll (.*) -c 3 192\.168\.1\.10$", (owsdtest.SOURCE / "docs/modbus.md").read_text(), re.M)
    assert poll(*page[1].split(), "-c", "2") == [21.5, -3.25]
    assert poll("-t", "4:float", "-B", "-r", "46002", "-c", "2") == [21.5, -3.25]
    assert poll("-t", "3", "-r", "43001", "-c", "2") == [GOOD, GOOD]
    assert poll("-t", "4:int", "-B", "-r", str(32 + LONG), "-c", "1") == [-33]
    assert poll("-t", "0", "-r", "1", "-c", "2") == [1, 1]
    assert face.stop() == 0


def python_with_pymodbus():
    for python in ("python3", "/usr/bin/python3"):
        if shutil.which(python) and subprocess.run([python, "-c", "import pymodbus.client"], check=False,
                                                   capture_output=True).returncode == 0:
            return python
    return owsdtest.skip("pymodbus is not installed")


PYMODBUS = """
import json, sys
from pymodbus.client import ModbusTcpClient
client = ModbusTcpClient("127.0.0.1", port=int(sys.argv[1]))
assert client.connect()
told = []
for address, count in json.loads(sys.argv[2]):
    answer = client.read_holding_registers(address, count=count)
    told.append(answer.exception_code if answer.isError() else answer.registers)
print(json.dumps(told))
"""


def test_pymodbus_reads_what_is_served(scene):
    python = python_with_pymodbus()
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, CELLAR))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(1, GOOD)
        plc.becomes(2, GOOD)
    done = scene._run([python, "-c", PYMODBUS, port, "[[56004, 8], [0, 2], [60, 1], [16, 32]]"], 20)
    assert done.returncode == 0, done
    values, magic, nothing, both = json.loads(done.stdout)
    assert struct.unpack(">dd", struct.pack(">8H", *values)) == (21.5, -3.25)
    assert magic == [0x4F57, 0x5344] and nothing == ADDRESS and len(both) == 32
    assert face.stop() == 0


SAFE = {**RELAYS, "SafeValue": 9, "SafeDelay": 0}


def commanded(scene, daemon, value):
    until(lambda: scene.get(daemon, "relays") == value, 20,
          lambda: f"relays is {value}, not {scene.get(daemon, 'relays')}")


def test_a_client_writes_what_it_may_and_the_journal_has_its_address(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, RELAYS))
    face = serve(scene, daemon)

    def reload(**keys):
        daemon.config.write_text(text(scene, port, ROOM, RELAYS, **keys))
        assert scene.owsctl(daemon, "reload").returncode == 0

    def counted(name):
        return json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["faces"][0]["counters"][name]

    with Client(port) as plc:
        plc.becomes(1, GOOD)
        assert refused(plc.write_one, 32 + SHORT, 1) == FUNCTION
        reload(Write="on", Allow="relays 10.0.0.5")
        until(lambda: refused(plc.write_one, 32 + SHORT, 1) == ADDRESS, 20, "writing is on, for another")
        reload(Write="on", Allow="r* 127.0.0.1", Beat=0)
        until(lambda: refused(plc.write_one, 32 + SHORT, 1) is None, 20, "writing is on")
        commanded(scene, daemon, "1")
        for form, at, number in ((">d", DOUBLE, 2), (">f", FLOAT, 3), (">i", LONG, 4), (">h", SHORT, 5)):
            plc.write(32 + at, form, number)
            commanded(scene, daemon, str(number))
        plc.write(46004, ">f", 6)
        commanded(scene, daemon, "6")
        plc.write_one(2, 0xFF00, 5)
        commanded(scene, daemon, "1")
        plc.ask(struct.pack(">BHHBB", 15, 2, 1, 1, 0))
        commanded(scene, daemon, "0")
        before = counted("refused")
        for number in (2.5, 256, -1, math.nan, math.inf):
            assert refused(plc.write, 32 + DOUBLE, ">d", number) == VALUE, number
        assert refused(plc.write, 16 + DOUBLE, ">d", 20) == ADDRESS  # an input
        assert refused(plc.write, 32 + DOUBLE, ">f", 20) == VALUE and refused(plc.write_one, 32 + QUALITY, 1) == ADDRESS
        assert refused(plc.registers, 43003, 1) == ADDRESS  # no command
        until(lambda: counted("refused") == before + 8, 20, lambda: f"{before} refused, then {counted('refused')}")
        journal = scene.owsctl(daemon, "--json", "journal").stdout
        assert '"modbus:127.0.0.1"' in journal and '"owsd-modbus"' in journal, journal
        logged(face, "command to relays of modbus:127.0.0.1 refused: ")
        # what waited while the program was stopped moves nothing
        face.freeze()
        plc.socket.sendall(plc.frame(struct.pack(">BHH", 6, 32 + SHORT, 77)))
        time.sleep(2.2)  # longer than a command may wait
        face.thaw()
        assert plc.answer() == bytes([0x86, BUSY])
        assert scene.get(daemon, "relays") == "0"
        plc.write_one(32 + SHORT, 7)
        commanded(scene, daemon, "7")
    time.sleep(0.5)  # Beat 0: its connection is gone, and nothing happens
    assert scene.get(daemon, "relays") == "7"
    assert face.stop() == 0


def test_of_one_request_all_is_written_or_nothing(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, RELAYS, ROOM, Write="on", Allow="* 127.0.0.1"))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(2, GOOD)
        until(lambda: refused(plc.write_one, 16 + SHORT, 5) is None, 20, "it is taken")
        commanded(scene, daemon, "5")
        # an output, then an input
        assert refused(plc.write, 40001, ">hh", 7, 20) == ADDRESS
        assert refused(plc.ask, struct.pack(">BHHBB", 15, 1, 2, 1, 3)) == ADDRESS
        logged(face, "command to relays and 1 more of modbus:127.0.0.1 refused: it is an input")
        time.sleep(0.3)  # some periods
        assert scene.get(daemon, "relays") == "5"
        # each form of one value, with one request
        plc.write(16, ">dfih", 6, 6, 6, 6)
        commanded(scene, daemon, "6")
    assert face.stop() == 0


def test_outputs_of_a_client_that_falls_silent_go_to_their_safe_value(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, SAFE, Write="on", Allow="relays 127.0.0.1", Beat=3))
    face = serve(scene, daemon)

    def asks_for(plc, seconds):
        begun = time.monotonic()
        while time.monotonic() - begun < seconds:
            plc.registers(0, 5)
            assert scene.get(daemon, "relays") == "5"

    with Client(port) as plc:
        plc.becomes(1, GOOD)
        plc.write_one(32 + SHORT, 5)
        commanded(scene, daemon, "5")
        asks_for(plc, 5)  # it only reads
    commanded(scene, daemon, "9")  # it has left
    with Client(port) as plc:
        plc.write_one(32 + SHORT, 5)
        commanded(scene, daemon, "5")
        # a restart of owsd on the way
        daemon.stop()
        daemon = scene.owsd(daemon.config, name=daemon.name)
        until(lambda: refused(plc.write_one, 32 + SHORT, 5) is None, 20, "owsd is back")
        commanded(scene, daemon, "5")
        asks_for(plc, 5)
        plc.write_one(12, 1)  # its program beats from now on

        def stopped():
            plc.registers(0, 5)  # and something else goes on to ask
            return scene.get(daemon, "relays") == "9"
        until(stopped, 20, "the program has stopped")
        plc.write_one(32 + SHORT, 6)
        commanded(scene, daemon, "6")
        face.kill()
        commanded(scene, daemon, "9")
    face = serve(scene, daemon)
    with Client(port) as plc:
        until(lambda: refused(plc.write_one, 32 + SHORT, 5) is None, 20, "it is taken")
        commanded(scene, daemon, "5")
        assert face.stop() == 0
    commanded(scene, daemon, "9")


def test_each_option_changes_what_is_served_from_a_reload_on(scene):
    port, other = free_port(), free_port()
    daemon = scene.owsd(text(scene, port, ROOM, ABSENT))
    face = serve(scene, daemon)

    def reload(at=port, **keys):
        daemon.config.write_text(text(scene, at, ROOM, ABSENT, **keys))
        assert scene.owsctl(daemon, "reload").returncode == 0

    with Client(port) as plc:
        plc.becomes(1, GOOD)
        reload(WordOrder="little")
        until(lambda: plc.registers(0, 2) == (0x5344, 0x4F57), 20, "the low word is first")
        assert plc.registers(16 + FLOAT, 2) == (0, 0x41AC) and plc.registers(16 + DOUBLE, 4) == (0, 0, 0x8000, 0x4035)
        reload(Decimals=2)
        until(lambda: plc.registers(16 + SHORT, 1) == (2150,), 20, "two decimals")
        plc.becomes(2, NO_DEVICE)
        reload(BadValue="exception")
        until(lambda: refused(plc.registers, 32, 4) == NO_TARGET, 20, "a bad value is an exception")
        assert plc.registers(32 + QUALITY, 1) == (NO_DEVICE,) and refused(plc.registers, 43003, 1) == ADDRESS
        reload(UnitId=7)
        until(lambda: refused(plc.registers, 0, 1) == NO_TARGET, 20, "one unit answers")
        plc.unit = 7
        assert plc.registers(0, 1) == (0x4F57,)
        reload(at=other)
        logged(face, f"Modbus is served at 127.0.0.1:{other}")
        with Client(other) as there:
            there.unit = 7
            assert there.registers(0, 1) == plc.registers(0, 1)
            reload(at=other, Clients=1)
            until(lambda: open_still(there) + open_still(plc) == 1, 20, "one client is left")
    daemon.config.write_text(text(scene, None, ROOM))
    face.signal(signal.SIGHUP)
    logged(face, "has no Modbus block: nothing is served")
    assert scene.owsctl(daemon, "reload").returncode == 0
    assert face.log().count("has no Modbus block") == 1, face.log()
    assert face.stop() == 0


def test_an_address_that_cannot_be_served_is_shown_everywhere_until_it_is(scene):
    port, other = owsdtest.free_port(), owsdtest.free_port()
    daemon = scene.owsd(text(scene, port, ROOM))
    face = serve(scene, daemon)
    logged(face, f"Modbus is served at 127.0.0.1:{port}")

    def shown(address, words):
        """After a reload with that address: what owsctl reload, stats and doctor say of it."""
        daemon.config.write_text(text(scene, other, ROOM, Listen=address))
        done = scene.owsctl(daemon, "reload")
        assert done.returncode == 0 and f"owsd-modbus: reloaded; {words}; " in done.stdout, done
        stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["faces"][0]
        assert stats["trouble"].startswith(f"{words}; "), stats
        until(lambda: f"; {words}\n" in scene.owsctl(daemon, "doctor").stdout, 20, "doctor has the status")
        done = scene.owsctl(daemon, "doctor")
        assert done.returncode == 1 and f"owsd-modbus says: {words}; " in done.stdout, done

    shown(f"192.0.2.7:{other}", "no interface of this machine has 192.0.2.7")
    with socket.create_server(("127.0.0.1", other)):
        shown(f"127.0.0.1:{other}", f"cannot listen at 127.0.0.1:{other}: Address already in use")
    logged(face, f"Modbus is served at 127.0.0.1:{other}")
    until(lambda: json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["faces"][0]["trouble"] is None, 20,
          "what is mended is no trouble")
    done = scene.owsctl(daemon, "reload")
    assert "owsd-modbus: reloaded\n" in done.stdout, done


def open_still(client):
    try:
        client.registers(0, 1)
    except (OSError, Refused):
        return False
    return True


def asks_on(greedy):
    """Sends requests for long answers, and reads none."""
    try:
        while True:
            greedy.socket.send(greedy.frame(struct.pack(">BHH", 3, 0, 32)) * 100)
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def processor_seconds(face):
    fields = (owsdtest.pathlib.Path(f"/proc/{face.pid}/stat").read_text()).rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_a_client_that_stops_in_the_middle_or_takes_no_answer_holds_up_nobody(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM))
    face = serve(scene, daemon, "-v")
    with Client(port) as plc, Client(port) as half, Client(port) as greedy, Client(port) as other:
        plc.becomes(1, GOOD)
        half.socket.sendall(half.frame(struct.pack(">BHH", 3, 0, 1))[:-1])
        greedy.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        greedy.socket.setblocking(False)
        other.socket.sendall(b"GET / HTTP/1.0\r\n\r\n")
        assert other.socket.recv(1) == b""
        for _ in range(100):
            assert plc.number_at(16, ">d") == 21.5
        logged(face, "closed: its request is not whole in time")
        until(lambda: asks_on(greedy) or "closed: it does not take its answers" in face.log(), 20, "it is closed")
        logged(face, "closed: it speaks no Modbus TCP")
        before = processor_seconds(face)
        time.sleep(1)  # nothing to do: it costs nothing
        assert processor_seconds(face) - before < 0.1
        assert plc.number_at(16, ">d") == 21.5
        # a byte at a time is whole in the end
        for byte in plc.frame(struct.pack(">BHH", 3, 16, 1)):
            plc.socket.sendall(bytes([byte]))
        assert plc.answer()[0] == 3
        # and several at once are answered in their order
        frames = [plc.frame(struct.pack(">BHH", 3, 16, 1)) for _ in range(60)]
        plc.number -= len(frames)
        plc.socket.sendall(b"".join(frames))
        for _ in frames:
            plc.number += 1
            assert plc.answer()[0] == 3
    assert face.stop() == 0


def test_who_waits_for_a_descriptor_costs_nothing_and_commands_nothing(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, RELAYS, Write="on", Allow="* 127.0.0.1"))
    face = serve(scene, daemon)
    with Client(port) as plc:
        until(lambda: refused(plc.write_one, 16 + SHORT, 5) is None, 20, "it is taken")
        commanded(scene, daemon, "5")
    until(lambda: "0 clients" in scene.owsctl(daemon, "stats").stdout, 20, "it has left")
    before = resource.prlimit(face.pid, resource.RLIMIT_NOFILE)
    used = owsdtest.open_files(face)
    resource.prlimit(face.pid, resource.RLIMIT_NOFILE, (min(set(range(len(used) + 1)) - set(used)), before[1]))
    with Client(port) as plc:
        plc.socket.sendall(plc.frame(struct.pack(">BHH", 6, 16 + SHORT, 7)))
        logged(face, "no client can connect: Too many open files")
        spent = processor_seconds(face)
        time.sleep(2.2)  # longer than a command may wait
        assert processor_seconds(face) - spent < 0.2
        resource.prlimit(face.pid, resource.RLIMIT_NOFILE, before)
        assert plc.answer() == bytes([0x86, BUSY])
        assert scene.get(daemon, "relays") == "5"
        plc.write_one(16 + SHORT, 7)
        commanded(scene, daemon, "7")
    assert face.stop() == 0


def test_of_too_many_clients_the_most_silent_give_way_and_each_is_answered(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, Clients=128))
    face = serve(scene, daemon, "-v")
    clients = [Client(port) for _ in range(64)]
    try:
        clients[0].becomes(1, GOOD)
        took = []
        for _ in range(20):
            for client in clients:
                begun = time.monotonic()
                assert client.registers(0, 32)[:2] == (0x4F57, 0x5344)
                took.append(time.monotonic() - begun)
        took.sort()
        print(f"64 clients: half within {took[len(took) // 2] * 1e3:.2f} ms, 99 % within {took[-len(took) // 100] * 1e3:.2f} ms")
        # one address has half of the places
        clients[0].registers(0, 1)
        clients.append(Client(port))
        logged(face, "a new connection of its address takes its place")
        assert open_still(clients[0]) and open_still(clients[64]) and not open_still(clients[1])
        assert sum(open_still(client) for client in clients) == 64
    finally:
        for client in clients:
            client.socket.close()
    assert face.stop() == 0


if __name__ == "__main__":
    owsdtest.main()
