#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl record, and what it recorded replayed: the target replay: of owsctl-sim and owsd-sim."""

import os
import pty
import re
import signal
import subprocess
import zlib

import owsdtest

HEAD = "i2c speed 400 combine one-read\nchip DS2482-800 0x18\n"
CHIPS = """DS18B20 28.A10000000000 as living temperature 21.5
DS18B20 28.A10000000004 as bedroom temperature 18.25
DS18S20 10.0000000000C1 as cellar temperature 12.5
DS2408 29.000000000001 as relays pin.4 1
DS2438 26.000000000001 as air temperature 22 vdd 5 vad 2.3
"""
IDS = ("A10000000000", "A10000000004", "0000000000C1", "29.000000000001", "26.000000000001")
TRACES = owsdtest.SOURCE / "tests/traces"


def sim(scene, what=""):
    return f"sim:{scene.file('wire.sim', HEAD + CHIPS + what)}"


def ctl(scene, target, *words, status=0, seconds=90):
    done = scene.owsctl(None, "-t", target, *words, seconds=seconds)
    assert done.returncode == status, (words, done)
    return done


def replay(scene, file, *words, status=0):
    """The verb on the recording; what it says of it is none of the verb's."""
    return ctl(scene, f"replay:{file}", *words, status=status)


def without_ids(table):
    return re.sub(r"\b([0-9A-F]{2})\.[0-9A-F]{12}", r"\1", table)


def recorded_path(file, ending):
    return re.search(rf'bus: read "([^"]*{ending})"', file.read_text()).group(1)


def test_a_scan_replays_with_other_ids(scene):
    file = scene.path / "it.trace"
    scanned = ctl(scene, sim(scene), "record", "--anonymous", file)
    assert re.search(r"it\.trace has \d+ lines, without your ids", scanned.stderr), scanned
    text = file.read_text()
    for id_ in IDS:
        assert id_ not in text and id_.replace(".", "") not in text, id_
    assert "wire.sim" not in text and " > " in text
    assert len(zlib.compress(text.encode())) < 30000, len(text)
    again = replay(scene, file, "scan")
    assert without_ids(again.stdout) == without_ids(scanned.stdout)
    assert again.stdout != scanned.stdout and "was" not in again.stderr, again.stderr


def test_a_fault_is_there_in_the_replay(scene):
    file = scene.path / "it.trace"
    path = "/10.0000000000C1/temperature"
    target = sim(scene, "at 0s corrupt cellar each 1 for 1h\n")
    first = ctl(scene, target, "record", "--anonymous", file, "read", path, status=1)
    wrong = first.stderr.split("temperature: ")[1].splitlines()[0]
    again = replay(scene, file, "read", recorded_path(file, "temperature"), status=1)
    assert wrong in again.stderr, (first, again)


def test_a_change_of_the_verdict_is_named(scene):
    file = scene.path / "it.trace"
    path = "/28.A10000000004/temperature"
    ctl(scene, sim(scene), "record", file, "read", path)
    text = file.read_text()
    assert "18.25" in text and path in text
    changed = scene.file("changed.trace", text.replace('18.25"', '19.25"'))
    done = replay(scene, changed, "read", path)
    assert done.stdout.strip() == "18.25"
    assert re.search(rf'changed\.trace:\d+: read "{path}" was .*19\.25.*, is .*18\.25', done.stderr), done


def test_what_was_not_asked_is_named(scene):
    file = scene.path / "it.trace"
    ctl(scene, sim(scene), "record", file, "read", "/28.A10000000004/temperature")
    done = replay(scene, file, "read", "/26.000000000001/VAD", status=1)
    assert "never asked" in done.stderr, done


def test_owsd_runs_on_a_recording(scene):
    file = scene.path / "it.trace"
    ctl(scene, sim(scene), "record", file)
    item = dict(Name="cellar", Path="/10.0000000000C1/temperature", Type=owsdtest.raw("double"),
                IO=owsdtest.raw("input"))
    # the file counts from the folder of the configuration
    daemon = scene.owsd(owsdtest.rio("replay:it.trace", [item], Period=0.2))
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 60, "the recorded temperature")


def test_a_genuine_owserver_is_recorded_and_replayed_without_it(scene):
    server = scene.owserver(tester=["28", "29", "26"])
    file = scene.path / "it.trace"
    scanned = ctl(scene, server.target, "record", "--anonymous", file)
    server.process.kill()
    again = replay(scene, file, "scan")
    assert without_ids(again.stdout) == without_ids(scanned.stdout), (scanned, again)
    assert again.stdout != scanned.stdout
    assert "net: sent " in file.read_text() and server.target not in file.read_text()


def test_ctrl_c_ends_a_recording_whole(scene):
    file = scene.path / "it.trace"
    path = "/28.A10000000004/temperature"
    program = owsdtest.with_sim(owsdtest.OWSCTL, "sim:")
    owner, terminal = pty.openpty()
    recorder = subprocess.Popen([program, "-t", sim(scene), "record", "--anonymous", "--for", "3600",
                                 file, "read", path], cwd=scene.path, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=terminal, text=True)
    os.close(terminal)
    said = ""

    def look():
        nonlocal said
        said += os.read(owner, 4096).decode()
        return re.search(r"recording: ([4-9]\d|\d{3,}) lines", said)
    scene.until(look, 60, "it shows how far it is")
    recorder.send_signal(signal.SIGINT)
    out = recorder.communicate(timeout=owsdtest.PATIENCE)[0]
    os.close(owner)
    assert recorder.returncode == 0 and out.strip() == "18.25", (recorder.returncode, out)
    text = file.read_text()
    assert text.endswith("\n") and text.count('bus: read "/28.') > 1
    assert path not in text, [line for line in text.splitlines() if path in line][:3]


def test_what_cannot_be_recorded_is_refused(scene):
    target = sim(scene)
    file = scene.file("there.trace", "mine")
    assert "already" in ctl(scene, target, "record", file, status=1).stderr
    assert file.read_text() == "mine"
    assert "which file" in ctl(scene, target, "record", status=2).stderr
    assert "opens no target" in ctl(scene, target, "record", "x", "list", status=2).stderr
    assert "opens no target" in ctl(scene, target, "record", "x", "record", "y", status=2).stderr
    assert not (scene.path / "x").exists()
    assert "no recording" in replay(scene, file, "scan", status=2).stderr
    plain = subprocess.run([owsdtest.OWSCTL, "-t", f"replay:{file}", "scan"], text=True,
                           capture_output=True, timeout=owsdtest.PATIENCE)
    assert plain.returncode == 2 and "owsctl-sim" in plain.stderr, plain


def test_a_verb_that_fails_is_tried_again_after_a_pause_and_a_misused_one_is_not(scene):
    said = ctl(scene, "serial:/dev/null", "record", "--for", "2", "x", "scan", status=1).stderr
    assert 2 <= said.count("no serial port") <= 4, said
    said = ctl(scene, sim(scene), "record", "--for", "2", "x", "read", status=2).stderr
    assert said.count("usage:") == 1, said


def test_the_recordings_of_tests_traces_have_the_answers_that_they_had(scene):
    files = sorted(TRACES.glob("*.trace"))
    assert files
    for file in files:
        text = file.read_text()
        words = text.splitlines()[1].split()[5:]  # owsctl 0.10.0 -t TARGET VERB
        done = scene.owsctl(None, "-t", f"replay:{file}", *words, seconds=90)
        assert done.stdout or "wrong checksum" in done.stderr, (file, done)
        assert not re.search(r"\bwas .*, is |never asked", done.stderr), (file, done.stderr)
        if words[0] == "read":
            values = re.findall(r'bus: read "[^"]*" > " *([^"]*)"', text)
            assert done.stdout.splitlines() == values, (file, done.stdout)


if __name__ == "__main__":
    owsdtest.main()
