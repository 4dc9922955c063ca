#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd -t TARGET -l PORT without a configuration file: it serves the devices and has no signals."""

import os
import subprocess

import owsdtest
import served
from owsdtest import until
from served import DEVICES, READ, THERMOMETER


def alone(scene, *options, **how):
    """owsd on the simulated network, without -c; the server that it is."""
    target = f"sim:{scene.file('served.sim', served.WIRE)}"
    port = owsdtest.free_port()
    daemon = scene.owsd(None, "-t", target, "-l", f"127.0.0.1:{port}", *options, **how)
    return served.Server(daemon, "127.0.0.1", port, False)


def test_a_target_and_a_port_are_enough_to_serve_the_devices(scene):
    server = alone(scene)
    until(lambda: server.has(DEVICES), 20, "all devices are there")
    assert server.frame(READ, THERMOMETER + "/type").data == b"DS18B20"
    assert server.entries("/signals") == []
    owsdtest.logged(server.program, "0 signals from no file")
    assert scene.owsctl(server.program, "list").stdout.count("\n") <= 1


def test_check_prints_what_would_be_served(scene):
    done = scene.owsd_once("--check", "-n", scene.name(), "-t", "null:", "-l", "4304")
    assert done.returncode == 0 and done.stderr == "", done
    assert "null:" in done.stdout and "4304" in done.stdout and "Item {" not in done.stdout, done


def test_without_either_of_them_the_error_says_what_is_missing(scene):
    for words, what in ((["-t", "null:"], "give -l PORT too"), (["-l", "0"], "give -t TARGET too")):
        for check in ([], ["--check"]):
            done = scene.owsd_once("-n", scene.name(), *words, *check)
            assert done.returncode == 2, done
            assert "No such file or directory" in done.stderr and what in done.stderr, done


def test_what_is_wrong_with_a_target_says_nothing_of_the_file_that_is_not_needed(scene):
    wrong = scene.file("wrong.sim", "chip DS2482-100 0x18\nnonsense\n")
    done = scene.owsd_once("-n", scene.name(), "-t", f"sim:{wrong}", "-l", "0")
    assert done.returncode == 2 and "wrong.sim:2:" in done.stderr, done
    assert "configuration" not in done.stderr and "-l PORT" not in done.stderr, done


def test_a_file_that_is_named_must_be_there(scene):
    missing = scene.path / "missing.rio"
    done = scene.owsd_once("-n", scene.name(), "-c", missing, "-t", "null:", "-l", "0")
    assert done.returncode == 2 and f"{missing}: error: cannot be read" in done.stderr, done


def etc(scene):
    """A program that gives what it becomes an /etc of its own; and that /etc."""
    folder = scene.path / "etc"
    (folder / "owsd").mkdir(parents=True)
    prefix = ["unshare", "-m" if os.geteuid() == 0 else "-rm", "sh", "-c",
              'mount --bind "$0" /etc && exec "$@"', str(folder)]
    try:
        subprocess.run([*prefix, "true"], check=True, capture_output=True, timeout=20)
    except (OSError, subprocess.CalledProcessError) as why:
        owsdtest.skip(f"no mount namespace to be had: {why}")
    return prefix, folder / "owsd"


def test_the_instances_file_is_taken_when_it_comes_and_missed_when_it_goes(scene):
    prefix, folder = etc(scene)
    name = scene.name()
    server = alone(scene, prefix=prefix, name=name)
    file = folder / f"{name}.rio"
    file.write_text(owsdtest.rio("null:", [dict(Name="room", Path=THERMOMETER + "/temperature12",
                                                Type="double", IO="input")]))
    server.program.signal(1)
    until(lambda: scene.get(server.program, "room") == "21.5", 20, "the file's signal is good")
    server.program.stop()

    server = alone(scene, prefix=prefix, name=name)
    until(lambda: scene.get(server.program, "room") == "21.5", 20, "the file's signal is good")
    file.unlink()
    server.program.signal(1)
    owsdtest.logged(server.program, "is refused: all goes on as before")
    assert scene.get(server.program, "room") == "21.5"


if __name__ == "__main__":
    owsdtest.main(at_once=4)
