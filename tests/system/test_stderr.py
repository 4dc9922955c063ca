#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What owsd writes to its stderr; one that nobody reads holds owsd up in nothing."""

import fcntl
import os
import re
import signal
import subprocess
import time

import owsdtest


def full_pipe():
    """Both ends of a pipe that is full; the writing one blocks, as a shell's does."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    try:
        while os.write(writer, b"." * 4096):
            pass
    except BlockingIOError:
        pass
    os.set_blocking(writer, True)
    return reader, writer


def start(scene, writer):
    owsdtest.need(owsdtest.OWSD)
    name = scene.name()
    target = f"127.0.0.1:{owsdtest.free_port()}"  # nobody there: owsd says so
    config = scene.file("full.rio", owsdtest.rio(target, [
        dict(Name="room", Path="/28.000000000001/temperature", Type="double", IO="input")]))
    command = [owsdtest.OWSD, "-v", "-v", "-n", name, "-c", config]
    return name, subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=writer)


def test_a_full_stderr_does_not_keep_owsd_from_ending(scene):
    reader, writer = full_pipe()
    name, process = start(scene, writer)
    try:
        owsdtest.until(lambda: owsdtest.segment(name, "image").exists(), 10, "image is made")
        owsdtest.until(lambda: scene.owsctl(name, "get", "room").returncode == 3, 10, "it runs")
        time.sleep(0.5)  # its supervisor has had lines to write
        process.send_signal(signal.SIGTERM)
        assert process.wait(owsdtest.PATIENCE) == 0
    finally:
        process.kill()
        process.wait()
        os.close(reader)
        os.close(writer)


def test_lines_come_when_a_full_stderr_is_read_again(scene):
    reader, writer = full_pipe()
    name, process = start(scene, writer)
    try:
        owsdtest.until(lambda: owsdtest.segment(name, "image").exists(), 10, "image is made")
        os.set_blocking(reader, False)
        text = b""

        def said():
            nonlocal text
            try:
                text += os.read(reader, 65536)
            except BlockingIOError:
                pass
            return b"instance" in text

        owsdtest.until(said, 10, "the first line")
        # others may share it: it has to block as it did
        assert not fcntl.fcntl(writer, fcntl.F_GETFL) & os.O_NONBLOCK
    finally:
        process.kill()
        process.wait()
        os.close(reader)
        os.close(writer)


def test_the_trace_shows_each_request_to_each_kind_of_target(scene):
    server = scene.owserver(tester=["29"])
    relay = server.devices(0)[0] + "/PIO.0"
    house = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.0000000000A1 as room temperature 21.5\n")
    items = [dict(Name="relay", Path=relay, Type="bool", IO="output", InitValue="1"),
             dict(Name="switch", Path=relay.replace("PIO", "sensed"), Type="bool", IO="input"),
             dict(Name="room", Path="/28.0000000000A1/temperature9", Type="double", IO="input"),
             dict(Name="typo", Path="/28.0000000000A1/temprature", Type="double", IO="input")]
    config = owsdtest.rio(f"{server.target}, sim:{house}", items, Period=0.05)
    daemon = scene.owsd(config, "-v", "-v", "-v")
    for request in (rf"{server.target}: write {relay} \"1\": done", rf"{server.target}: read .*sensed.0: \"[01]\"",
                    r'sim:.*: read /28.0000000000A1/temperature9: "21.5"',
                    r"sim:.*: read /28.0000000000A1/temprature: no such property"):
        owsdtest.until(lambda r=request: re.search(rf"^trace: {r}, [0-9.]+ ms$", daemon.log(), re.M), 20,
                       lambda r=request: f"{r} in the trace:\n{daemon.log()}")
    quiet = scene.owsd(config, "-v", "-v")
    owsdtest.until(lambda: scene.get(quiet, "room"), 10, "it reads")
    owsdtest.logged(quiet, "up")
    assert "trace:" not in quiet.log()


if __name__ == "__main__":
    owsdtest.main()
