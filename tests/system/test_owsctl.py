#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl on a running owsd: what it prints, how it ends, and what it does to a terminal."""

import fcntl
import json
import os
import pathlib
import pty
import re
import select
import signal
import struct
import subprocess
import termios

import owsdtest
import peer

import ows  # of owsdtest.PYTHON


def house(scene, **driver):
    """owserver with a thermometer and a switch, and an owsd on it."""
    server = scene.owserver(mock=["28", "05"])
    room, relay = (next(d for d in server.devices() if d.startswith(f"/{family}."))
                   for family in ("28", "05"))
    server.write(room + "/temperature", 21.5)
    text = owsdtest.rio(server.target, [
        dict(Name="room", Path=room + "/temperature", Type="double", IO="input"),
        dict(Name="relay", Path=relay + "/PIO", Type="bool", IO="output"),
        dict(Name="nobody", Path="/28.0102030405FF/temperature", Type="double", IO="input"),
    ], Period=0.05, **driver)
    daemon = scene.owsd(text)
    scene.until(lambda: scene.get(daemon, "room") == "21.5", 15, "the temperature arrives")
    return server, daemon, room, relay


def owsctl(scene, daemon, *arguments, **options):
    """owsctl that goes on running, its lines read from a pipe."""
    process = subprocess.Popen([owsdtest.OWSCTL, "-n", daemon.name, *arguments], text=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, **options)
    os.set_blocking(process.stdout.fileno(), False)
    os.set_blocking(process.stderr.fileno(), False)
    return process


class Lines:
    """All that a process has written so far."""

    def __init__(self, stream):
        self.fd = stream.fileno()
        self.data = b""

    @property
    def text(self):
        return self.data.decode(errors="replace")

    def until(self, pattern, seconds=10):
        def look():
            try:
                self.data += os.read(self.fd, 65536)
            except BlockingIOError:
                pass
            return re.search(pattern, self.text, re.M)
        return owsdtest.until(look, seconds, lambda: f"{pattern} in {self.text[-500:]}")


def test_a_value_that_is_not_good_is_shown_with_its_reason(scene):
    _, daemon, _, _ = house(scene, MaxRetries=0)
    done = owsdtest.until(lambda: (d := scene.owsctl(daemon, "get", "room", "nobody"))
                          .returncode == 3 and "absent" in d.stderr and d, 15, "nobody is absent")
    assert done.stdout == "21.5\n\n"
    assert "nobody has no value: device absent" in done.stderr
    shown = [line.split()[:3] for line in scene.owsctl(daemon, "list").stdout.splitlines()[1:]]
    assert ["room", "21.5", "°C"] in shown and ["nobody", "-", "°C"] in shown, shown
    done = scene.owsctl(daemon, "list", "--json", "nobody")
    assert json.loads(done.stdout)[0]["value"] is None, done


def test_an_output_is_confirmed_on_the_bus(scene):
    server, daemon, _, relay = house(scene)
    for value, word in (("1", "on"), ("0", "off")):
        done = scene.owsctl(daemon, "set", "-w", "60", "relay", word)
        assert (done.returncode, done.stderr) == (0, "")
        assert server.read(relay + "/PIO") == value


def test_a_command_that_the_output_does_not_follow_is_shown(scene):
    server, daemon, _, relay = house(scene)

    def row():
        rows = json.loads(scene.owsctl(daemon, "--json", "list", "relay").stdout)
        return rows[0]["value"], rows[0]["commanded"]

    def line():
        return scene.owsctl(daemon, "list", "relay").stdout
    assert row()[1] is None and "commanded" not in line()
    assert scene.owsctl(daemon, "set", "-w", "60", "relay", "on").returncode == 0
    scene.until(lambda: row() == (True, True), 10, row)
    assert "commanded" not in line()
    assert scene.owsctl(daemon, "set", "-w", "60", "relay_WE", "off").returncode == 0
    assert scene.owsctl(daemon, "set", "relay", "off").returncode == 0
    scene.until(lambda: row() == (True, False), 10, row)
    assert "good (sim); commanded 0 " in line(), line()
    assert server.read(relay + "/PIO") == "1"
    told = "owsctl: relay: commanded 0, and the device does not have it yet\n"
    assert scene.owsctl(daemon, "get", "relay").stderr == told
    assert scene.owsctl(daemon, "get", "relay_TRANSACTIONS").stderr == ""
    terminal = Terminal(daemon, 24, 120, "watch", "relay")
    terminal.until(lambda s: len(s) == 3 and "good (sim); commanded 0 " in s[2], "the command")
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)
    assert scene.owsctl(daemon, "set", "-w", "60", "relay_WE", "on").returncode == 0
    scene.until(lambda: "commanded" not in line() and row() == (False, False), 10, line)


def test_wait_sees_the_temperature_rise(scene):
    server, daemon, room, _ = house(scene)
    waiting = owsctl(scene, daemon, "wait", "room", ">", "25", "-t", "80")
    scene.until(lambda: f"{daemon.name}.image" in pathlib.Path(f"/proc/{waiting.pid}/maps").read_text(),
                10, "it has the image")
    assert waiting.poll() is None
    server.write(room + "/temperature", 25.5)
    assert waiting.wait(owsdtest.PATIENCE) == 0
    assert waiting.stdout.read() == "25.5\n"


def test_json_is_json(scene):
    _, daemon, _, _ = house(scene)
    table = json.loads(scene.owsctl(daemon, "list", "-a", "--json").stdout)
    assert [s["name"] for s in table if s["path"]] == ["room", "relay", "nobody"]
    assert all(s["identity"] == s["path"] for s in table if s["path"])
    room = next(s for s in table if s["name"] == "room")
    assert room["value"] == 21.5 and room["good"] and 0 <= room["age"] < 300

    def alive():
        stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
        return stats["daemon"]["alive"] and stats
    stats = owsdtest.until(alive, 10, "its heart beats")
    assert stats["daemon"]["pid"] == daemon.pid
    assert stats["signals"] == 3 and stats["targets"][0]["state"] == "up"


def test_watch_prints_changes_and_follows_a_killed_owsd(scene):
    server, daemon, room, _ = house(scene)
    watch = owsctl(scene, daemon, "watch", "room")
    lines, said = Lines(watch.stdout), Lines(watch.stderr)
    lines.until(r"^\S+ room 21.5 good \(sim\)$")
    server.write(room + "/temperature", 22.5)
    lines.until(r"^\S+ room 22.5 good \(sim\)$")
    daemon.kill()
    said.until("is not running: last heartbeat")
    lines.until(r"^\S+ room 22.5 owsd not running \(sim\)$")
    scene.owsd(daemon.config, name=daemon.name)
    said.until("was started again")
    lines.until(r"owsd not running.*\n(.*\n)*\S+ room 22.5 good \(sim\)$", 20)
    watch.terminate()
    assert watch.wait(owsdtest.PATIENCE) == 0


def test_watch_tells_a_reload_from_a_start(scene):
    _, daemon, _, _ = house(scene)
    watch, objects = owsctl(scene, daemon, "watch", "room"), owsctl(scene, daemon, "--json", "watch", "room")
    lines, said, told = Lines(watch.stdout), Lines(watch.stderr), Lines(objects.stdout)
    terminal = Terminal(daemon, 24, 120, "watch", "room")
    lines.until("room 21.5 good")
    told.until('"room"')
    terminal.until(lambda s: any(line.startswith("room") for line in s), "the row")
    assert scene.owsctl(daemon, "reload").returncode == 0
    said.until("has reloaded its file")
    told.until('"event": ?"reloaded"')
    terminal.until(lambda s: any("owsd has reloaded its file" in line for line in s), "the note")
    assert "started again" not in said.text
    good = daemon.config.read_text()
    daemon.config.write_text("OwsDrv { Period wrong }\n")
    assert scene.owsctl(daemon, "reload").returncode == 1
    terminal.until(lambda s: "0 not good  reload refused: " + str(daemon.config)[:20] in s[0], "the reason")
    daemon.config.write_text(good)
    assert scene.owsctl(daemon, "reload").returncode == 0
    terminal.until(lambda s: "refused" not in s[0], "it is taken over")
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)
    for program in (watch, objects):
        program.terminate()
        assert program.wait(owsdtest.PATIENCE) == 0


def test_watch_ends_quietly_with_its_reader(scene):
    _, daemon, _, _ = house(scene)
    watch = owsctl(scene, daemon, "watch")
    Lines(watch.stdout).until("room")
    watch.stdout.close()
    assert watch.wait(owsdtest.PATIENCE) == 0
    assert watch.stderr.read() == ""


def test_nothing_is_set_at_an_owsd_that_is_gone(scene):
    _, daemon, _, _ = house(scene)
    daemon.kill()
    owsdtest.until(lambda: scene.owsctl(daemon, "get", "room").returncode == 3, 10, "not good")
    done = scene.owsctl(daemon, "set", "relay", "1")
    assert done.returncode == 1 and "owsd is not running: nothing was set" in done.stderr


def test_nothing_is_set_at_an_owsd_that_was_just_killed(scene):
    _, daemon, _, _ = house(scene)

    def command():
        listed = json.loads(scene.owsctl(daemon, "--json", "list", "relay").stdout)
        return listed[0]["commanded"]
    before = command()
    daemon.kill()
    for words in (("relay", "1"), ("-w", "5", "relay", "1")):
        done = scene.owsctl(daemon, "set", *words)
        assert done.returncode == 1 and "owsd is not running: nothing was set" in done.stderr, done
    assert command() == before


class Terminal:
    """owsctl on a terminal of our own; screen() is its present picture, line by line."""

    def __init__(self, daemon, lines, columns, *arguments, term="xterm"):
        go, begin = os.pipe()
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.read(go, 1)  # not before the terminal has been looked at
            os.execve(owsdtest.OWSCTL, [str(owsdtest.OWSCTL), "-n", daemon.name, *arguments],
                      dict(os.environ, TERM=term, LC_ALL="C.UTF-8"))
        self.before = termios.tcgetattr(self.fd)
        self.output = b""
        self.resize(lines, columns)
        os.write(begin, b"!")
        os.close(go)
        os.close(begin)

    def resize(self, lines, columns):
        self.lines, self.columns = lines, columns
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("4H", lines, columns, 0, 0))

    def read(self):
        """What is there now. True: and nothing will come any more."""
        while select.select([self.fd], [], [], 0)[0]:
            try:
                self.output += os.read(self.fd, 65536)
            except OSError:
                return True
        return False

    def screen(self):
        self.read()
        lines = {}
        for number, text in re.findall(r"\x1b\[(\d+);1H(.*?)\x1b\[K", self.output.decode(errors="ignore"),
                                       re.S):
            lines[int(number)] = re.sub(r"\x1b\[[0-9;]*m", "", text)
        shown = [lines.get(n, "") for n in range(1, self.lines + 1)]
        while len(shown) > 1 and not shown[-1]:
            shown.pop()
        return shown

    def until(self, condition, what):
        return owsdtest.until(lambda: condition(self.screen()), 10,
                              lambda: f"{what}: {self.screen()}")

    def end(self):
        """Exit status, and is the terminal as it was?"""
        def gone():
            self.read()
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            return pid and (os.waitstatus_to_exitcode(status),)
        status, = owsdtest.until(gone, 10, "owsctl ends")
        owsdtest.until(self.read, 10, "the end of what it wrote")
        restored = (termios.tcgetattr(self.fd)[3] == self.before[3]
                    and self.output.endswith(b"\x1b[?1049l"))
        return status, restored


def test_what_is_said_of_a_wrong_option_cannot_steer_the_terminal(scene):
    for words in (["-\x1b"], ["--\x1b[2J", "list"], ["-n"]):
        run = subprocess.run([owsdtest.OWSCTL, *words], text=True, capture_output=True, check=False,
                             timeout=owsdtest.PATIENCE)
        assert run.returncode == 2, run
        assert "\x1b" not in run.stderr, run
        assert run.stderr.startswith("owsctl: ") and "option" in run.stderr.splitlines()[0], run


def test_a_wrong_option_is_named_as_it_was_typed(scene):
    for words, expected in ((["--version=3"], "--version takes no value: --version=3"),
                            (["--json=yes", "list"], "--json takes no value: --json=yes"),
                            (["list", "--json=yes"], "--json takes no value: --json=yes"),
                            (["list", "--all=1"], "--all takes no value: --all=1"),
                            (["stats", "--all=1"], "unknown option: --all=1"),
                            (["scan", "--rio=x"], "--rio takes no value: --rio=x"),
                            (["get", "-J"], "unknown option: -J"),
                            (["-n"], "option without its argument: -n"),
                            (["watch", "-t"], "option without its argument: -t"),
                            (["watch", "-c", ""], '-c wants a number above 0, not ""'),
                            (["-t", "", "dir"], "-t: a target expected, as localhost:4304, "
                             "i2c:/dev/i2c-1 or w1"),
                            (["dir", "-t", ""], "-t: a target expected, as localhost:4304, "
                             "i2c:/dev/i2c-1 or w1"),
                            ([""], 'there is no verb ""')):
        run = subprocess.run([owsdtest.OWSCTL, *words], text=True, capture_output=True, check=False,
                             timeout=10)
        assert run.returncode == 2, (words, run)
        assert run.stderr.startswith(f"owsctl: {expected}\n"), (words, run.stderr)


def test_an_odd_name_is_shown_and_the_reason_behind_it_too(scene):
    for name, expected in (("", '"" cannot be the name of an instance'),
                           ("x" * 100000, "xxx cannot be the name of an instance")):
        run = subprocess.run([owsdtest.OWSCTL, "-n", name, "list"], text=True, capture_output=True,
                             check=False, timeout=10)
        assert run.returncode == 1 and run.stderr.endswith(expected + "\n"), (run.returncode, run.stderr)
        assert len(run.stderr) < 1100, len(run.stderr)


def test_the_live_table_follows_values_and_keys(scene):
    server, daemon, room, _ = house(scene)
    terminal = Terminal(daemon, 24, 100, "watch")
    terminal.until(lambda s: any(re.match(r"room +21.5 +\u00b0C +good", line) for line in s), "room")
    server.write(room + "/temperature", 23.5)
    terminal.until(lambda s: any(re.match(r"room +23.5 +\u00b0C +good", line) for line in s), "a change")
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)


def test_a_set_that_cannot_be_written_is_told_though_the_value_is_good(scene):
    server = scene.owserver(fake=["28"])
    sensor = server.devices()[0]
    daemon = scene.owsd(owsdtest.rio(server.target, [
        dict(Name="room", Path=sensor + "/temperature", Type="double", IO="input",
             Writable=owsdtest.raw("on"))], Period=0.02))
    scene.until(lambda: scene.get(daemon, "room"), 10, "room is good")

    def told():
        done = scene.owsctl(daemon, "set", "-w", "2", "room", "5")
        assert done.returncode == 1, done
        return done.stderr == "owsctl: room was not confirmed: it cannot be written\n"
    scene.until(told, 20, "why it is not")
    scene.until(lambda: scene.get(daemon, "room"), 10, "it is read as before")
    owsdtest.logged(daemon, "cannot be written")


def test_a_value_that_cannot_be_set_is_told_why(scene):
    sensor = "/28.000000000001"
    daemon = scene.owsd(owsdtest.rio("null:", [
        dict(Name="room", Path=sensor + "/temperature", Type="double", IO="input"),
        dict(Name="relay", Path="/29.000000000002/PIO.BYTE", Type="byte", IO="output"),
        dict(Name="back", Path=sensor + "/temperature", Type="double", IO="input",
             Writable=owsdtest.raw("on"))]))
    assert scene.owsctl(daemon, "set", "-w", "60", "back_WE", "off").returncode == 0
    cannot = "{}: it is an input: Writable is off in the configuration"
    done = scene.owsctl(daemon, "get", "OTHER__room")
    assert done.returncode == 1 and "did you mean room, or -n OTHER?" in done.stderr, done
    for words, reason in (
            (("relay", "1.5"), 'relay: "1.5" is no value for it: expected 0 to 255'),
            (("relay", "on"), 'relay: "on" is no value for it: expected 0 to 255'),
            (("relay", "256"), 'relay: "256" is no value for it: expected 0 to 255'),
            (("room", "5"), cannot.format("room")), (("room_WE", "on"), cannot.format("room_WE")),
            (("room_WriteOneShot", "1"), cannot.format("room_WriteOneShot")),
            (("back", "5"), "back is not writable: it is an input, and its _WriteEnable is 0")):
        done = scene.owsctl(daemon, "set", *words)
        assert done.returncode == 1 and done.stderr == f"owsctl: {reason}\n", (words, done)
    assert scene.owsctl(daemon, "set", "-w", "60", "back_WE", "on").returncode == 0
    assert scene.owsctl(daemon, "set", "-w", "60", "back", "5").returncode == 0
    scene.until(lambda: scene.get(daemon, "back") == "5", 5, "is 5")


def test_the_live_table_fits_small_terminals_and_scrolls(scene):
    _, daemon, _, _ = house(scene)
    terminal = Terminal(daemon, 4, 30, "watch", "-a")
    terminal.until(lambda s: len(s) == 4 and s[3].startswith("1 to 1 of 5"), "the first row")
    assert all(len(line) <= 30 for line in terminal.screen()), terminal.screen()
    os.write(terminal.fd, b"\x1b[B\x1b[B")
    terminal.until(lambda s: s[-1].startswith("3 to 3 of 5") and s[2].startswith("room"), "room")
    terminal.resize(20, 90)
    terminal.until(lambda s: len(s) == 7, "all rows after the terminal grew")
    os.write(terminal.fd, b"\x03")
    assert terminal.end() == (0, True)


def test_at_80_columns_each_row_has_its_path_and_the_head_has_their_target(scene):
    server, daemon, room, _ = house(scene)
    terminal = Terminal(daemon, 24, 80, "watch")
    terminal.until(lambda s: len(s) == 5 and s[2].startswith("room"), "the rows")
    head, titles, *rows = terminal.screen()
    assert server.target in head and "3 signals" in head and "in alarm" not in head, head
    assert titles.split() == ["NAME", "VALUE", "UNIT", "QUALITY", "AGE", "PATH"], titles
    assert room[:16] in rows[0] and "/28.0102030405FF" in rows[2], rows
    assert all(len(line) <= 80 for line in terminal.screen()), terminal.screen()
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)


def test_the_live_table_marks_an_alarm_without_colour(scene):
    chips = scene.file("net.sim", "i2c speed 400\nchip DS2482-100 0x18\n"
                       "DS18B20 28.000000000001 temperature 31\nDS18B20 28.000000000002 temperature 4\n")
    daemon = scene.owsd(owsdtest.rio(f"sim:{chips}", [
        dict(Name="boiler", Path="/28.000000000001/temperature9", Type="double", LimitH=30),
        dict(Name="outside", Path="/28.000000000002/temperature9", Type="double")], Period=0.05))
    scene.until(lambda: "! high" in scene.owsctl(daemon, "list").stdout, 15, "the alarm stands")
    terminal = Terminal(daemon, 24, 80, "watch")
    terminal.until(lambda s: len(s) == 4 and "2 signals, 0 not good, 1 in alarm" in s[0]
                   and re.match(r"boiler +31 +\u00b0C +good \(sim\) +! high +", s[2])
                   and re.match(r"outside +4 +\u00b0C +good \(sim\) +- +", s[3])
                   and "/28.00000000000" in s[2], "the mark")
    assert scene.owsctl(daemon, "alarms", "ack", "-a").returncode == 0
    terminal.until(lambda s: re.match(r"boiler +31 +\u00b0C +good \(sim\) +high, ack", s[2]), "acknowledged")
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)


def test_of_one_thing_nothing_speaks_in_the_plural(scene):
    chips = scene.file("net.sim", "i2c speed 400\nchip DS2482-100 0x18\nDS2413 3A.000000000001\n")
    text = owsdtest.rio(f"sim:{chips}", [
        dict(Name="valve", Path="/3A.000000000001/PIO.A", Type="bool", IO="output", SafeValue="0")])
    daemon = scene.owsd(text.replace("ItemCount               1", "ItemCount               2"))
    said = [scene.owsctl(daemon, *words) for words in
            (("list",), ("stats",), ("watch", "-c", "1"), ("alarms",))]
    terminal = Terminal(daemon, 24, 80, "watch")
    terminal.until(lambda s: len(s) == 3, "a picture")
    said.append(terminal.screen())
    os.write(terminal.fd, b"q")
    assert terminal.end() == (0, True)
    daemon.config.write_text(daemon.config.read_text().replace("PIO.A", "PIO.B"))
    daemon.signal(signal.SIGHUP)
    owsdtest.logged(daemon, "1 target, 1 of them")
    said.append(daemon.log())
    daemon.stop()
    said.append(scene.owsctl(None, "remove", daemon.name))
    for text in map(str, said):
        assert not re.search(r"\b1 (?!alarms\b)[a-z]+[^s]s\b", text), text


def test_a_terminal_is_given_back_on_sigterm(scene):
    _, daemon, _, _ = house(scene)
    terminal = Terminal(daemon, 10, 60, "watch")
    terminal.until(lambda s: len(s) > 3, "a picture")
    os.kill(terminal.pid, signal.SIGTERM)
    assert terminal.end() == (0, True)


def test_a_dumb_terminal_gets_lines(scene):
    _, daemon, _, _ = house(scene)
    terminal = Terminal(daemon, 10, 60, "watch", "-c", "1", term="dumb")
    assert terminal.end()[0] == 0
    assert re.search(rb" room 21.5 good", terminal.output) and b"\x1b" not in terminal.output, terminal.output


def test_no_byte_of_a_binary_property_is_lost_on_the_way(scene):
    """Into JSON and into Python; text stays text."""
    page, name = "/23.A0B1C2000001/pages/page.0", "/23.A0B1C2000001/memory"
    binary, plain = bytes(range(256)), "Kälte \0 \x85".encode()
    with peer.Peer({page: binary, name: plain}) as server:
        daemon = scene.owsd(owsdtest.rio(server.target, [
            dict(Name="page", Path=page, Type="string", IO="input"),
            dict(Name="text", Path=name, Type="string", IO="input")], Period=0.05))
        scene.until(lambda: all(s["good"] for s in json.loads(
            scene.owsctl(daemon, "--json", "list").stdout)), 15)
        for arguments in (["-n", daemon.name, "list"], ["-n", daemon.name, "get", "page", "text"],
                          ["-t", server.target, "read", page, name]):
            done = scene.owsctl(None, "--json", *arguments)
            assert done.returncode == 0, done.stderr
            rows = json.loads(done.stdout)
            assert bytes.fromhex(rows[0]["hex"]) == binary, (arguments, rows)
            assert rows[1]["value"].encode() == plain and "hex" not in rows[1], (arguments, rows)
        with ows.Ows(daemon.name) as signals:
            assert signals.get("page").data == binary
            assert signals.get("text").data == plain and signals.get("text").value == plain.decode()
            assert signals.get("_TRANSACTIONS").data is None


if __name__ == "__main__":
    owsdtest.main()
