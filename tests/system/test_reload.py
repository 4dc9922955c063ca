#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""SIGHUP: a changed file is served without a gap, a broken one changes nothing."""

import json
import os
import re
import signal
import subprocess
import time

import owsdtest
from owsdtest import raw, until

import ows  # of owsdtest.PYTHON

SENSOR, OTHER, RELAY = "/28.A0B1C2000001", "/28.A0B1C2000002", "/29.A0B1C2000004"


def wire(scene, name, *devices):
    return f"sim:{scene.file(name, chr(10).join(['chip DS2482-100 0x18', *devices]) + chr(10))}"


def house(scene):
    return wire(scene, "house.sim", "DS18B20 28.A0B1C2000001 temperature 21.5",
                "DS18B20 28.A0B1C2000002 temperature 12", "DS2408 29.A0B1C2000004")


def item(name, path, kind="double", io="input", **more):
    return dict(Name=name, Path=path, Type=raw(kind), IO=raw(io), **more)


ROOM = item("room", SENSOR + "/temperature")
RELAYS = item("relays", RELAY + "/PIO.BYTE", "byte", "output")
BACK = item("back", RELAY + "/sensed.BYTE", "byte")
CELLAR = item("cellar", OTHER + "/temperature")


def rio(target, *items, **driver):
    return owsdtest.rio(target, items, **{"Period": 0.05, "Timeout": 3, "MaxRetries": 1, **driver})


def change(scene, daemon, text):
    """Write the file anew, in one step, so that nobody reads half of it, and say so."""
    newer = scene.file("newer.rio", text)
    os.replace(newer, daemon.config)
    daemon.signal(signal.SIGHUP)


def reload(scene, daemon, text):
    """The same; returns what owsd has logged when it is done."""
    before = len(daemon.log())
    change(scene, daemon, text)
    daemon.ready()
    until(lambda: any(words in daemon.log()[before:] for words in
                      ("signals from", "signal from", "as before")), 10, "the log tells of it")
    return daemon.log()[before:]


def get(scene, daemon, name):
    return scene.get(daemon, name)


def sound(signals, name):
    """The value, and is it good? A machine that keeps owsd from its heartbeat for two seconds makes
    all of them bad, which is no fault of a reload."""
    now = ows.now_ns()
    value = signals.get(name, now)
    return value, value.good or signals.beat_age(now) > 2


def start(scene, target=None, *items):
    target = target or house(scene)
    daemon = scene.owsd(rio(target, *(items or (ROOM, RELAYS, BACK))))
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room is good")
    return daemon, target


def test_signals_that_stay_go_on_and_others_come_and_go(scene):
    daemon, target = start(scene)
    assert scene.owsctl(daemon, "set", "-w", "60", "relays", "5").returncode == 0
    until(lambda: get(scene, daemon, "back") == "250", 10)
    with ows.Ows(daemon.name) as signals:
        before, _ = sound(signals, "room")
        text = reload(scene, daemon, rio(target, CELLAR, BACK, RELAYS, ROOM))
        assert "4 signals, 3 of them go on; 1 target, 1 of them" in text, text
        signals.reopen()
        after, good = sound(signals, "room")
        assert good and after.value == 21.5 and after.count >= before.count
        assert sound(signals, "relays")[1]
    until(lambda: get(scene, daemon, "cellar") == "12", 10, "the new one is read")
    until(lambda: get(scene, daemon, "back") == "250", 10, "what was set stays")
    assert scene.owsctl(daemon, "set", "-w", "60", "relays", "6").returncode == 0
    until(lambda: get(scene, daemon, "back") == "249", 10)
    reload(scene, daemon, rio(target, ROOM))
    done = scene.owsctl(daemon, "get", "cellar")
    assert done.returncode == 1 and "cellar" in done.stderr, done
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room goes on")


def totals(scene, daemon):
    """All that was counted: {(target or device, what): number}, of the counters and of the devices."""
    stats = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
    found = {(row["target"], row["name"]): row["value"] for row in stats["counters"]}
    return found | {(row["id"], key): row[key] for row in stats["devices"]
                    for key in ("answers", "errors", "retries", "wire_us") if row[key] is not None}


def test_no_total_falls_at_a_reload(scene):
    target = house(scene)
    daemon = scene.owsd(rio(target, ROOM, RELAYS, BACK, Period=3))
    until(lambda: totals(scene, daemon).get((target, "bus_reads"), 0) > 3, 20, "reads are counted")
    for items in ((ROOM, RELAYS, BACK, CELLAR), (ROOM, CELLAR)):
        daemon.config.write_text(rio(target, *items, Period=3))
        before = totals(scene, daemon)
        assert scene.owsctl(daemon, "reload").returncode == 0
        after = totals(scene, daemon)  # within a period: nothing has been published since
        fell = {key: (value, after.get(key)) for key, value in before.items()
                if key[0] != RELAY[1:] and after.get(key, 0) < value}
        assert not fell, fell


def test_owsctl_asks_for_a_reload_and_knows_when_it_is_done(scene):
    daemon, target = start(scene)
    daemon.config.write_text(rio(target, ROOM, CELLAR))
    done = scene.owsctl(daemon, "reload")
    assert done.returncode == 0 and done.stderr == "", done
    assert done.stdout == f"owsd {daemon.name}: reloaded\n", done
    assert scene.owsctl(daemon, "list", "cellar").returncode == 0, "it is there at once"
    until(lambda: 'reload: asked for by "owsctl" (process' in daemon.log(), 10, daemon.log)
    until(lambda: get(scene, daemon, "cellar") == "12", 10, "the new one is read")
    # many at once are answered by a reload each, or by one together
    askers = [scene.start([owsdtest.OWSCTL, "-n", daemon.name, "reload"]) for _ in range(4)]
    assert [asker.wait() for asker in askers] == [0] * 4, [asker.log() for asker in askers]


def test_a_reload_tells_who_asked_what_the_file_is_warned_of(scene):
    daemon, target = start(scene)
    lamp = item("lamp", RELAY + "/PIO.1", "bool", "output", SaveValue="0")
    one, two = rio(target, ROOM, lamp), rio(target, ROOM, lamp, PerFactr=raw("1"))
    for text, number, words in ((one, "1 warning", "is it SafeValue?"), (two, "2 warnings", "PerFactr")):
        daemon.config.write_text(text)
        line = next(n for n, row in enumerate(text.splitlines(), 1) if "SaveValue" in row or "PerFactr" in row)
        done = scene.owsctl(daemon, "reload")
        assert done.returncode == 0 and done.stderr == "", done
        assert done.stdout.startswith(f"owsd {daemon.name}: reloaded, with {number}; the first: {daemon.config}:{line}:"), done
        assert words in done.stdout and done.stdout.endswith("; owsd --check and owsctl doctor show all\n"), done
    daemon.config.write_text(rio(target, ROOM))
    assert scene.owsctl(daemon, "reload").stdout == f"owsd {daemon.name}: reloaded\n"


def said(daemon):
    """The lines STATUS= that the service manager has got."""
    lines = []
    daemon.notify.setblocking(False)
    try:
        while True:
            lines += daemon.notify.recv(4096).decode().splitlines()
    except BlockingIOError:
        return [line for line in lines if line.startswith("STATUS=")]


def refusal(scene, daemon):
    """Who reports the refused reload: what each place of owsctl has of it."""
    stats = scene.owsctl(daemon, "--json", "stats").stdout
    rows = json.loads(stats)
    metrics = scene.owsctl(daemon, "metrics").stdout.splitlines()
    return {"list": scene.owsctl(daemon, "list").stderr,
            "stats": [line for line in scene.owsctl(daemon, "stats").stdout.splitlines() if line.startswith("refused ")],
            "json": rows["daemon"]["refused_reload"],
            "counter": {row["name"]: row["value"] for row in rows["counters"]}["refused_reloads"],
            "metric": [line[-1] for line in metrics if line.startswith("ows_reload_refused{")]}


def test_a_refused_reload_stays_visible_until_one_is_taken_over(scene):
    daemon, target = start(scene)
    good = daemon.config.read_text()
    fine = {"list": "", "stats": [], "json": None, "counter": 0, "metric": ["0"]}
    assert refusal(scene, daemon) == fine, refusal(scene, daemon)
    for n, (text, why) in enumerate([(good + "Driver {\n", f"{daemon.config}:"),
                                     (rio(target, ROOM, Listen=str(owsdtest.free_port())), "by a restart only")], 1):
        said(daemon)
        daemon.config.write_text(text)
        assert scene.owsctl(daemon, "reload").returncode == 1
        assert any(line.startswith("STATUS=reload refused") and why in line for line in said(daemon))
        until(lambda: refusal(scene, daemon)["counter"] == n, 10, "it is counted")
        found = refusal(scene, daemon)
        assert "a reload was refused" in found["list"] and why in found["list"], found
        assert why in found["stats"][0] and found["metric"] == ["1"], found
        assert found["json"]["count"] == n and why in found["json"]["why"], found
    # a long reason is cut, and stays UTF-8 wherever that is
    for n, shift in enumerate("abc", 3):
        daemon.config.write_text(good.replace('"room"', f'"{shift * (n - 2)}{"€" * 150}"'))
        assert scene.owsctl(daemon, "reload").returncode == 1
        until(lambda: refusal(scene, daemon)["counter"] == n, 10, "it is counted")
        found = refusal(scene, daemon)
        assert "€€" in found["json"]["why"] and "\ufffd" not in found["json"]["why"], found
    daemon.config.write_text(good)
    assert scene.owsctl(daemon, "reload").returncode == 0
    until(lambda: any(line.startswith("STATUS=3 signals") for line in said(daemon)), 10, "it tells its state")
    until(lambda: refusal(scene, daemon) == {**fine, "counter": 5}, 10, lambda: refusal(scene, daemon))


def test_owsctl_reload_tells_which_faces_took_the_file_over_and_which_did_not(scene):
    for face in ("owsd-web", "owsd-recorder"):
        owsdtest.need(owsdtest.BUILD / face)
    daemon, _target = start(scene)
    other = scene.file("other.rio", daemon.config.read_text())
    scene.start([owsdtest.BUILD / "owsd-web", "-n", daemon.name, "-c", other])
    recorder = scene.start([owsdtest.BUILD / "owsd-recorder", "-n", daemon.name, "-c", daemon.config, "-d", scene.path / "history"])

    def told():
        done = scene.owsctl(daemon, "reload")
        assert done.returncode == 0, done
        return done.stdout.splitlines()
    first = [f"owsd {daemon.name}: reloaded", "owsd-recorder: reloaded", "owsd-web: reloaded"]
    until(lambda: told() == first, 20, told)
    other.write_text("OwsDrv { Period wrong }\n")
    lines = told()
    assert lines[:2] == first[:2] and lines[2].startswith(f"owsd-web: goes on as before: {other}:1:17"), lines
    faces = {face["program"]: face["refused"] for face in json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["faces"]}
    assert faces["owsd-recorder"] is None and f"{other}:1:17" in faces["owsd-web"], faces
    other.write_text(daemon.config.read_text())
    assert told() == first
    recorder.freeze()
    lines = told()
    assert lines[0] == first[0] and lines[1].startswith("owsd-recorder: has not reloaded yet") and lines[2] == first[2], lines


def test_the_reload_of_each_service_fails_for_a_file_that_is_refused(scene):
    """By the commands of its unit that stand before the signal, or in its place."""
    daemon, target = start(scene)
    page = raw(f'{{ Files "{owsdtest.SOURCE}/src/faces/web/page" }}')
    good = rio(target, ROOM, Web=page)
    units = [unit for unit in (owsdtest.SOURCE / "board/systemd").glob("owsd*@.service")
             if "ExecReload=" in unit.read_text()]
    assert len(units) == 7, units
    for unit in units:
        words = re.search(r"ExecReload=@S?BINDIR@/(\S+) -n %i (\S+)$", unit.read_text(), re.M)
        assert words, f"{unit}: its reload tells nobody what became of it"
        program, verb = words.groups()
        may_run = re.search(r"^ExecPaths=(.*)$", unit.read_text(), re.M)[1].split()
        assert set(re.findall(r"^Exec\w+=(@\w+@)/", unit.read_text(), re.M)) <= set(may_run), (unit, may_run)
        owsdtest.need(owsdtest.BUILD / program)
        file = [] if program == "owsctl" else ["-c", daemon.config]
        for text, why in ((good, ""), ("OwsDrv { Period wrong }\n", f"{daemon.config}:1:17: error")):
            daemon.config.write_text(text)
            done = subprocess.run([owsdtest.BUILD / program, "-n", daemon.name, *file, verb],
                                  capture_output=True, text=True, timeout=owsdtest.PATIENCE)
            assert (done.returncode == 0) == (not why), (unit, done)
            assert why in done.stderr, (unit, done)


def test_a_reload_that_is_refused_says_why_to_who_asked(scene):
    daemon, target = start(scene)
    daemon.config.write_text(rio(target, ROOM) + "Driver {\n")
    refused = scene.owsctl(daemon, "reload")
    assert refused.returncode == 1 and f"{daemon.config}:" in refused.stderr, refused
    assert "goes on as before" in refused.stderr, refused
    daemon.config.write_text(rio(target, ROOM).replace("Type", "Typ"))
    refused = scene.owsctl(daemon, "reload")
    assert refused.returncode == 1 and "is Typ meant to be Type?" in refused.stderr, refused
    daemon.config.write_text(rio(target, ROOM, Listen=str(owsdtest.free_port())))
    refused = scene.owsctl(daemon, "reload")
    assert refused.returncode == 1 and "change by a restart only" in refused.stderr, refused
    assert get(scene, daemon, "room") == "21.5"


def test_a_reload_of_an_owsd_that_is_not_there_or_hangs_fails(scene):
    daemon, _ = start(scene)
    daemon.freeze()
    refused = scene.owsctl(daemon, "reload", "-w", "0.2")
    assert refused.returncode == 1 and "has not reloaded in time" in refused.stderr, refused
    daemon.thaw()
    daemon.kill()
    refused = scene.owsctl(daemon, "reload")
    assert refused.returncode == 1 and "is not running" in refused.stderr, refused
    for words in (["-w", "soon"], ["now"]):
        assert scene.owsctl(daemon, "reload", *words).returncode == 2


def test_a_storm_of_reloads_is_bounded_and_inputs_arrive_in_it(scene):
    daemon, target = start(scene)
    begun, asked = time.monotonic(), 0

    with ows.Ows(daemon.name) as signals:
        first = signals.get("room").count

        def arrive():
            nonlocal asked
            asked += 1
            change(scene, daemon, rio(target, ROOM, item(f"last{asked}", OTHER + "/temperature")))
            if signals.stale():
                try:
                    signals.reopen()
                except OSError:
                    pass
            return asked > 100 and signals.get("room").count > first + 5
        until(arrive, 30, "room is read on", step=0.01)

        def last_is_there():
            try:
                signals.reopen()
            except OSError:
                return False
            return f"last{asked}" in signals.names()
        until(last_is_there, 10, "the last file is served")
        owsdtest.logged(daemon, "reload: ")
        reloads, took = daemon.log().count("reload: "), time.monotonic() - begun
        assert reloads <= took / 0.2 + 1, (reloads, took)


def test_a_broken_file_is_refused_and_all_goes_on(scene):
    daemon, target = start(scene)
    for bad, said in (("OwsDrv {\n", "error"), (rio("nonsense:x", ROOM), "nonsense"),
                      (rio(target, ROOM, ROOM), "is given twice"),
                      (rio(f"{target}, sim:/nowhere.sim", ROOM), "/nowhere.sim")):
        text = reload(scene, daemon, bad)
        assert "goes on as before" in text and said in text, text
        until(lambda: get(scene, daemon, "room") == "21.5", 10, "room goes on")
    os.unlink(daemon.config)
    daemon.signal(signal.SIGHUP)
    until(lambda: daemon.log().count("goes on as before") == 5, 10)
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room goes on")
    change(scene, daemon, rio(target, ROOM, CELLAR))
    until(lambda: get(scene, daemon, "cellar") == "12", 10, "the mended file is taken")


def test_a_reader_never_misses_a_good_value(scene):
    daemon, target = start(scene)
    texts = rio(target, ROOM, RELAYS), rio(target, CELLAR, ROOM, BACK)
    bad = []
    with ows.Ows(daemon.name) as signals:
        def look():
            if signals.stale():
                try:
                    signals.reopen()
                except OSError:  # they are just being exchanged: the old one is right
                    pass
            value, good = sound(signals, "room")
            if value.value != 21.5 or not good:
                bad.append(value)

        def looked_long():
            end = time.monotonic() + 0.05
            while time.monotonic() < end:
                look()
            return time.monotonic() > begun + 0.2 and daemon.log().count("them go on") > turn
        for turn in range(20):
            begun = time.monotonic()
            change(scene, daemon, texts[turn % 2])
            until(looked_long, 10, f"reload {turn} is done", step=0)
        assert not bad, bad[:3]
    stats = scene.owsctl(daemon, "stats").stdout
    assert "reloads" in stats, stats


def test_what_is_set_while_it_reloads_is_not_lost(scene):
    daemon, target = start(scene)
    texts = rio(target, ROOM, RELAYS, BACK), rio(target, BACK, RELAYS, CELLAR)
    with ows.Ows(daemon.name, control=True) as signals:
        for turn in range(30):
            change(scene, daemon, texts[turn % 2])
            value = turn * 7 % 256

            def put():
                try:
                    signals.set("relays", value)
                    return True
                except OSError:
                    try:
                        signals.reopen()
                    except OSError:
                        pass
                    return False
            until(put, 5, "set")
            until(lambda: get(scene, daemon, "back") == str(255 - value), 10, f"turn {turn}")


def test_a_target_that_changes_is_exchanged_and_its_outputs_written_there(scene):
    daemon, _ = start(scene)
    assert scene.owsctl(daemon, "set", "-w", "60", "relays", "5").returncode == 0
    other = wire(scene, "other.sim", "DS18B20 28.A0B1C2000001 temperature 30",
                 "DS2408 29.A0B1C2000004")
    text = reload(scene, daemon, rio(other, ROOM, RELAYS, BACK))
    assert "1 target, 0 of them" in text, text
    until(lambda: get(scene, daemon, "room") == "30", 10, "the other one's")
    until(lambda: get(scene, daemon, "back") == "250", 10, "the output is written there")


def test_a_wire_is_added_and_the_first_one_does_not_notice(scene):
    daemon, target = start(scene)
    other = wire(scene, "other.sim", "DS18B20 28.A0B1C2000009 temperature 30")
    reload(scene, daemon, rio(f"{other}, {target}", ROOM, item("far", "/28.A0B1C2000009/temperature")))
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room goes on")
    until(lambda: get(scene, daemon, "far") == "30", 10)
    assert "from up to down" not in daemon.log(), daemon.log()
    reload(scene, daemon, rio(target, ROOM))
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room goes on")
    assert daemon.stop() == 0


def test_a_server_that_hangs_does_not_hold_a_reload(scene):
    server = scene.owserver(tester=["28"])
    sensor = server.devices()[0]
    far = item("far", sensor + "/temperature")
    target = house(scene)
    daemon = scene.owsd(rio(f"{target}, {server.target}", ROOM, far))
    until(lambda: get(scene, daemon, "far"), 15, "far is good")
    server.freeze()
    text = reload(scene, daemon, rio(target, ROOM))
    assert "2 targets" not in text
    until(lambda: get(scene, daemon, "room") == "21.5", 5)
    assert daemon.stop() == 0


def test_the_served_protocol_goes_on(scene):
    port = owsdtest.free_port()
    target = house(scene)
    daemon = scene.owsd(rio(target, ROOM, Listen=str(port)))
    until(lambda: get(scene, daemon, "room") == "21.5", 10, "room is good")
    peer = owsdtest.Owserver.__new__(owsdtest.Owserver)
    peer.host, peer.port = "127.0.0.1", port
    assert float(peer.read("/signals/room")) == 21.5
    text = reload(scene, daemon, rio(target, CELLAR, ROOM, Listen=str(port)))
    assert "2 signals, 1 of them" in text, text
    assert float(peer.read("/signals/room")) == 21.5
    until(lambda: get(scene, daemon, "cellar") == "12", 10)
    assert float(peer.read("/signals/cellar")) == 12
    assert float(peer.read(OTHER + "/temperature")) == 12
    text = reload(scene, daemon, rio(target, ROOM, Listen=str(owsdtest.free_port())))
    assert "restart" in text and "as before" in text, text
    assert float(peer.read("/signals/cellar")) == 12


def test_a_file_that_changes_while_it_is_being_reloaded_is_read_again(scene):
    daemon, target = start(scene)
    many = [item(f"t{i}", SENSOR + "/temperature") for i in range(3000)]
    with ows.Ows(daemon.name) as signals:
        for turn in range(20):
            change(scene, daemon, rio(target, ROOM, *many))
            time.sleep(0.004 * turn)  # at any moment of the reload
            last = item(f"last{turn}", SENSOR + "/temperature")
            change(scene, daemon, rio(target, ROOM, last))

            def taken():
                try:
                    if signals.stale():
                        signals.reopen()
                except OSError:  # they are just being exchanged
                    pass
                return last["Name"] in signals.names()
            until(taken, 10, f"the newer file is served, {4 * turn} ms after the older one")


def test_what_is_no_regular_file_is_not_waited_for(scene):
    daemon, target = start(scene)
    os.unlink(daemon.config)
    os.mkfifo(daemon.config)
    daemon.signal(signal.SIGHUP)
    until(lambda: "is refused: all goes on as before" in daemon.log(), 10)
    assert "is a pipe: only a regular file is read" in daemon.log(), daemon.log()
    os.unlink(daemon.config)
    daemon.config.write_text(rio(target, ROOM, CELLAR))
    daemon.signal(signal.SIGHUP)
    until(lambda: get(scene, daemon, "cellar") == "12", 10, "the file is taken")


def pending(daemon, number):
    """Is a signal of this number still to be taken?"""
    with open(f"/proc/{daemon.pid}/status", encoding="ascii", errors="replace") as status:
        bits = next(line.split()[1] for line in status if line.startswith("ShdPnd:"))
    return int(bits, 16) >> (number - 1) & 1


def test_a_reload_that_has_to_wait_reads_the_file_once(scene):
    daemon, target = start(scene)
    way = owsdtest.segment(daemon.name, "image")
    text = rio(target, ROOM, CELLAR, Nonsense=raw("1"))

    os.unlink(way)
    os.mkdir(way)
    try:
        daemon.signal(signal.SIGHUP)
        until(lambda: "no program sees the values" in daemon.log(), 10)
        daemon.config.write_text(text)
        daemon.signal(signal.SIGHUP)
        until(lambda: not pending(daemon, signal.SIGHUP), 10, "it has the second SIGHUP")
        assert "unknown key Nonsense" not in daemon.log(), daemon.log()
    finally:
        os.rmdir(way)
    until(lambda: get(scene, daemon, "cellar") == "12", 20, "then it is taken")
    owsdtest.logged(daemon, "unknown key Nonsense")
    assert daemon.log().count("unknown key Nonsense") == 1, daemon.log()


if __name__ == "__main__":
    owsdtest.main()
