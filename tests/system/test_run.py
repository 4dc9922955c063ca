#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make run: it shows live values, says which are simulated, and leaves nothing behind."""

import contextlib
import glob
import json
import os
import pty
import re
import select
import shutil
import signal
import socket
import time
import urllib.request

import owsdtest

RUN = owsdtest.SOURCE / "board/demo/run"
PROGRAMS = [owsdtest.BUILD / name for name in ("owsd-sim", "owsctl", "owsctl-sim", "owsd-recorder")]


def asked(url, **command):
    headers = {"X-Owsd": "1", "Content-Type": "application/json"} if command else {}
    request = urllib.request.Request(url, json.dumps(command).encode() if command else None, headers)
    with urllib.request.urlopen(request, timeout=20) as answer:
        return answer.read().decode()


class Terminal:
    """board/demo/run on a terminal of its own."""

    def __init__(self, scene, *arguments, name=None, build=owsdtest.BUILD, cwd=None):
        for program in PROGRAMS:
            owsdtest.need(program)
        self.name = name or scene.name()
        self.port = owsdtest.free_port()
        self.text = ""
        self.status = None
        try:
            self.pid, self.master = pty.fork()
        except OSError as why:
            owsdtest.skip(f"no pseudo-terminal to be had: {why}")
        if self.pid == 0:
            os.chdir(cwd or os.getcwd())
            os.environ.update(OWSERVER=f"127.0.0.1:{self.port}", NAME=self.name, TERM="vt100",
                              OWSD_BUILD=str(build))
            os.execvp("sh", ["sh", str(RUN), *arguments])

    def shows(self, what):
        """Read until the terminal has shown what."""
        deadline = time.monotonic() + owsdtest.PATIENCE
        while what not in self.text:
            if time.monotonic() > deadline:
                raise owsdtest.Late(f"{what!r} not within {owsdtest.PATIENCE} s in:\n{self.text}")
            if select.select([self.master], [], [], 0.1)[0]:
                try:
                    self.text += os.read(self.master, 65536).decode(errors="replace")
                except OSError:
                    raise AssertionError(f"ended without {what!r}:\n{self.text}") from None

    def group(self):
        """Processes of this terminal's session that live: of each its line in /proc."""
        found = {}
        for path in glob.glob("/proc/[0-9]*/stat"):
            try:
                with open(path, encoding="utf-8", errors="replace") as f:
                    line = f.read()
            except OSError:
                continue
            fields = line.rsplit(")", 1)[1].split()
            if int(fields[3]) == self.pid and fields[0] not in "ZX":
                found[path] = line
        return found

    def ended(self):
        if self.status is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = status
        return self.status is not None and not self.group()

    def gone(self):
        """Wait until all of it has ended, and see that nothing is left."""
        try:
            deadline = time.monotonic() + owsdtest.PATIENCE
            while not self.ended():
                if self.master is not None and select.select([self.master], [], [], 0.02)[0]:
                    try:
                        self.text += os.read(self.master, 65536).decode(errors="replace")
                    except OSError:
                        time.sleep(0.02)  # pace
                elif self.master is None:
                    time.sleep(0.02)  # pace
                assert time.monotonic() < deadline, f"still there: {self.group().values()} behind:\n{self.text}"
            # what they wrote last may still be in the terminal
            while self.master is not None and select.select([self.master], [], [], 0)[0]:
                try:
                    self.text += os.read(self.master, 65536).decode(errors="replace")
                except OSError:
                    break
        finally:
            self.end()
        with socket.socket() as s:
            assert s.connect_ex(("127.0.0.1", self.port)) != 0, "owserver still answers"

    def hang_up(self):
        os.close(self.master)
        self.master = None

    def end(self):
        for path in self.group():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(path.split("/")[2]), signal.SIGKILL)
        if self.status is None:
            os.waitpid(self.pid, 0)
            self.status = -1


def shown(scene, *arguments, says=("ALL VALUES ARE SIMULATED",), row="living", **where):
    terminal = Terminal(scene, *arguments, **where)
    try:
        for what in (*says, "Ctrl-C ends it all", row):
            terminal.shows(what)
    except BaseException:
        terminal.end()
        raise
    return terminal


def nothing_is_left(terminal):
    assert not glob.glob(f"{owsdtest.place()}/{terminal.name}*")
    assert not glob.glob(f"{owsdtest.BUILD}/*{terminal.name}*")


def test_it_shows_values_and_ctrl_c_leaves_nothing_behind(scene):
    terminal = shown(scene)
    os.write(terminal.master, b"\x03")
    terminal.gone()
    nothing_is_left(terminal)


def test_the_commands_that_it_names_work_as_typed_and_are_named_again_at_its_end(scene):
    checkout = scene.path / "checkout"
    (checkout / "out").mkdir(parents=True)
    for program in PROGRAMS:
        (checkout / "out" / program.name).symlink_to(program)
    for build, begins in ((checkout / "out", "out/owsctl "), (owsdtest.BUILD, f"{owsdtest.OWSCTL.absolute()} ")):
        terminal = shown(scene, build=build, cwd=checkout)
        try:
            commands = re.findall(r"^    (\S.*?)\r?$", terminal.text.split("\033[?1049h")[0], re.M)
            assert len(commands) >= 2 and all(c.startswith(begins) for c in commands), commands
            for command in commands:
                def works(command=command):
                    done.append(scene._run(["sh", "-c", f"cd {checkout} && {command}"], 30))
                    return done[-1].returncode == 0
                done = []
                # what was, is there after a few seconds
                scene.until(works, 20, lambda: done[-1]) if " trend " in command else works()
                assert done[-1].returncode == 0, done[-1]
        finally:
            os.write(terminal.master, b"\x03")
            terminal.gone()
        after = terminal.text.rpartition("\033[?1049l")[2]
        for command in commands:
            assert f"    {command}\r\n" in after, (command, after)


def test_sigterm_leaves_nothing_behind(scene):
    terminal = shown(scene)
    os.kill(terminal.pid, signal.SIGTERM)
    terminal.gone()
    nothing_is_left(terminal)


def test_a_closed_terminal_leaves_nothing_behind(scene):
    terminal = shown(scene)
    terminal.hang_up()
    terminal.gone()
    nothing_is_left(terminal)


def test_sigkill_leaves_no_process_behind(scene):
    terminal = shown(scene)
    os.kill(terminal.pid, signal.SIGKILL)
    terminal.gone()
    shutil.rmtree(owsdtest.BUILD / f"history-{terminal.name}")


def test_it_needs_no_owserver_and_shows_good_values_marked_as_simulated(scene):
    terminal = shown(scene)
    try:
        rows = {}

        def all_are_good():
            listed = scene.owsctl(terminal.name, "--json", "list").stdout
            rows.update((row["name"], row) for row in json.loads(listed or "[]"))
            return rows and all(row["good"] for row in rows.values())

        scene.until(all_are_good, 20, f"all are good: {rows}")
        assert all(row["simulated"] for row in rows.values()), rows
        assert len(rows) >= 10

        def identities():
            devices = json.loads(scene.owsctl(terminal.name, "--json", "stats").stdout)["devices"]
            return {device["id"]: device["identity"] for device in devices}
        scene.until(lambda: len([i for i in identities() if i.startswith("28.")]) == 5
                    and all(identities().values()), 20, identities)
        assert {identities()[i] for i in identities() if i.startswith("28.")} == {"DS18B20"}, identities()
        assert scene.owsctl(terminal.name, "set", "-w", "60", "light", "on").returncode == 0
    finally:
        os.write(terminal.master, b"\x03")
        terminal.gone()


def test_it_records_and_trend_draws_what_was(scene):
    terminal = shown(scene)
    try:
        history = owsdtest.BUILD / f"history-{terminal.name}"

        def drawn():
            done = scene.owsctl(terminal.name, "trend", "-d", history, "boiler")
            return done.returncode == 0 and any("\u2581" <= c <= "\u2588" for c in done.stdout)
        scene.until(drawn, 20, "trend draws the boiler")
    finally:
        os.write(terminal.master, b"\x03")
        terminal.gone()
    nothing_is_left(terminal)


def test_its_page_shows_the_house_and_switches_the_light(scene):
    owsdtest.need(owsdtest.BUILD / "owsd-web")
    terminal = shown(scene)
    try:
        page = re.search(r"Open it in a browser: (http://127\.0\.0\.1:\d+/)", terminal.text).group(1)
        assert "<title>" in asked(page)

        def value(name):
            return {s["name"]: s for s in json.loads(asked(page + "api/signals"))["signals"]}[name]["value"]
        scene.until(lambda: isinstance(value("boiler"), float), 20, "the boiler is good")
        scene.until(lambda: value("light") is False, 20, "the light is off")
        assert json.loads(asked(page + "api/set", name="light", value=True))["ok"]
        scene.until(lambda: value("light") is True, 20, "the light is on")
        scene.until(lambda: value("lamp") is True, 20, "the lamp follows")

        def drawn():
            now = time.time_ns() // 1000000
            trend = json.loads(asked(f"{page}api/trend?name=boiler&from={now - 60000}&until={now}&points=6"))
            return any(value is not None for value in trend["last"])
        scene.until(drawn, 20, "the recorder's values are there")
    finally:
        os.write(terminal.master, b"\x03")
        terminal.gone()
    nothing_is_left(terminal)


def test_the_house_has_a_limit_alarm_and_a_device_alarm_that_come_and_go(scene):
    demo = owsdtest.SOURCE / "board/demo"
    wire = (demo / "house.sim").read_text().replace("sine 60 6 2m", "sine 60 6 16s")
    quick = wire.replace("0:1 10s:0 11s:1 repeat 30s", "0:1 2s:0 3s:1 repeat 4s")
    assert quick.count("16s") == 1 and "repeat 4s" in quick, "the curves are those of the demonstration"
    scene.file("house.sim", quick)
    config = (demo / "house.rio").read_text().replace("sim:board/demo/house.sim",
                                                      f"sim:{scene.path}/house.sim")
    daemon = scene.owsd(config)

    def events():
        listed = json.loads(scene.owsctl(daemon, "--json", "alarms", "history").stdout or "[]")
        return [(e["name"], e["alarm"], e["event"]) for e in listed]
    for name, alarm in (("boiler", "high"), ("button", "device")):
        for event in ("raised", "returned"):
            owsdtest.until(lambda n=name, a=alarm, e=event: (n, a, e) in events(), 40,
                           lambda n=name, e=event: f"{n} has {e}: {events()}")
    assert scene.owsctl(daemon, "alarms", "ack", "boiler").returncode == 0


def test_each_fault_on_demand_is_seen_and_survived(scene):
    terminal = shown(scene)
    try:
        def qualities(*names):
            listed = scene.owsctl(terminal.name, "--json", "list", *names).stdout
            return {row["name"]: row["quality"] for row in json.loads(listed or "[]")}

        def are(quality, *names):
            return set(qualities(*names).values()) == {quality}
        others = ("bedroom", "outside", "door", "lamp")
        all_names = ("living", "cellar", *others)
        scene.until(lambda: are("good", *all_names, "button"), 30, lambda: qualities(*all_names))
        for fault, quality, names in (("fault_unplug", "device absent", ["living"]),
                                      ("fault_noise", "device error", ["cellar"]),
                                      ("fault_short", "wire short", (*all_names, "button"))):
            assert scene.owsctl(terminal.name, "set", "-w", "20", fault, "on").returncode == 0
            scene.until(lambda q=quality, n=names: are(q, *n), 60,
                        lambda f=fault, n=names: f"{f}: {qualities(*n)}")
            if "button" not in names:
                assert are("good", *others), (fault, qualities(*others))
            assert scene.get(terminal.name, fault) == "1"
            assert scene.owsctl(terminal.name, "set", "-w", "20", fault, "off").returncode == 0
            scene.until(lambda: are("good", *all_names, "button"), 60,
                        lambda f=fault: f"after {f}: {qualities(*all_names)}")
    finally:
        os.write(terminal.master, b"\x03")
        terminal.gone()
    nothing_is_left(terminal)


def test_its_page_edits_a_copy_of_the_configuration(scene):
    for program in ("owsd-web", "owsd-writer"):
        owsdtest.need(owsdtest.BUILD / program)
    demo = owsdtest.SOURCE / "board/demo/house.rio"
    before = demo.read_bytes()
    terminal = shown(scene)
    try:
        page = re.search(r"Open it in a browser: (http://127\.0\.0\.1:\d+/)", terminal.text).group(1)
        config = json.loads(asked(page + "api/config"))
        assert config["configurable"] and "house.sim" in config["text"], config
        text = config["text"].replace('"Living room"', '"The best room"')
        saved = json.loads(asked(page + "api/config/save", text=text, base=config["tag"]))
        assert saved["reload"] == "done", saved

        def is_shown():
            try:
                return "The best room" in asked(page + "api/signals")
            except urllib.error.HTTPError as error:  # while it opens what the reload made
                assert error.code == 503, error
                return False
        scene.until(is_shown, 20, "the reload")
        scene.until(lambda: scene.get(terminal.name, "living"), 20, "living is good again")
        assert demo.read_bytes() == before, "the demonstration's own file is as it was"
    finally:
        os.write(terminal.master, b"\x03")
        terminal.gone()
    nothing_is_left(terminal)


def test_an_owserver_with_simulated_devices_is_started_and_ended(scene):
    if shutil.which("owserver") is None:
        owsdtest.skip("owserver is not installed")
    terminal = shown(scene, "owserver", row="valve")
    os.write(terminal.master, b"\x03")
    terminal.gone()
    nothing_is_left(terminal)


def test_an_owserver_that_was_there_is_read_and_left_alone(scene):
    server = scene.owserver(mock=["28", "26"], tester=["29"])
    terminal = shown(scene, server.target, says=("write nothing", "VALUES ARE SIMULATED"),
                     row="temperature1")
    listed = json.loads(scene.owsctl(terminal.name, "--json", "list").stdout)
    assert {row["io"] for row in listed} == {"input"}, listed
    os.write(terminal.master, b"\x03")
    terminal.gone()
    nothing_is_left(terminal)
    assert server.answers()


def test_a_simulated_target_of_ones_own_is_scanned(scene):
    scenario = scene.file("own.sim", "i2c speed 400 combine any\nchip DS2482-100 0x18\n"
                                     "DS18B20 28.B10000000000 as boiler temperature 60\n")
    terminal = shown(scene, f"sim:{scenario}", says=("write nothing", "VALUES ARE SIMULATED"),
                     row="temperature1")
    os.write(terminal.master, b"\x03")
    terminal.gone()


def test_an_instance_that_is_another_s_is_left_alone(scene):
    daemon = scene.owsd(owsdtest.SOURCE / "board/demo/house.rio", "-t",
                        f"sim:{owsdtest.SOURCE}/board/demo/house.sim")
    near = str(owsdtest.segment(daemon.name, "near.image"))
    with open(near, "wb"):
        pass
    try:
        before = glob.glob(f"{owsdtest.place()}/{daemon.name}*")
        terminal = Terminal(scene, name=daemon.name)
        try:
            terminal.shows(f"already served by process {daemon.pid}")
        finally:
            terminal.gone()
        assert os.waitstatus_to_exitcode(terminal.status) == 1
        assert sorted(glob.glob(f"{owsdtest.place()}/{daemon.name}*")) == sorted(before)
        assert len(before) == 6 and "was removed" not in daemon.log(), before
    finally:
        os.unlink(near)


def test_an_instance_with_a_longer_name_is_left_alone(scene):
    name = scene.name()
    near = str(owsdtest.segment(name, "near.image"))
    with open(near, "wb"):
        pass
    try:
        terminal = Terminal(scene, name=name)
        terminal.shows("Ctrl-C ends it all")
        os.write(terminal.master, b"\x03")
        terminal.gone()
        assert glob.glob(f"{owsdtest.place()}/{name}*") == [near]
    finally:
        os.path.exists(near) and os.unlink(near)


def test_a_target_that_does_not_answer_is_said(scene):
    for target, what in ((f"127.0.0.1:{owsdtest.free_port()}", "Connection refused"),
                         ("i2c:/dev/i2c-nowhere", "/dev/i2c-nowhere")):
        terminal = Terminal(scene, target)
        try:
            terminal.shows(what)
        finally:
            terminal.gone()
        assert os.waitstatus_to_exitcode(terminal.status) == 1


if __name__ == "__main__":
    owsdtest.main()
