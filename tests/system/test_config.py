#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Configuration files: what is refused before anything starts, and edits that meet."""

import fcntl
import os
import subprocess

import owsdtest


def test_edits_at_once_lose_nothing(scene):
    owsdtest.need(owsdtest.OWSCTL)
    path = scene.path / "house.rio"
    script = """for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        "$0" config "$1" add "$2$i" "/28.000000000001/temperature" || exit 1
    done"""
    both = [subprocess.Popen(["sh", "-c", script, str(owsdtest.OWSCTL), str(path), letter],
                             stdin=subprocess.DEVNULL) for letter in "ab"]
    assert [process.wait(60) for process in both] == [0, 0]
    listed = scene.owsctl(None, "config", path, "list")
    assert listed.returncode == 0, listed.stderr
    names = {line.split()[0] for line in listed.stdout.splitlines() if "/28." in line}
    assert names == {f"{letter}{i}" for letter in "ab" for i in range(1, 21)}
    assert os.listdir(scene.path) == ["house.rio"]


def test_an_edit_waits_five_seconds_for_another_and_says_so(scene):
    path = scene.file("house.rio", owsdtest.rio("localhost", []))
    directory = os.open(scene.path, os.O_RDONLY)
    try:
        fcntl.flock(directory, fcntl.LOCK_EX)
        done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature")
    finally:
        os.close(directory)
    assert done.returncode == 1, done
    assert "house.rio: error: another program has been editing here" in done.stderr, done.stderr


def test_a_key_given_twice_is_refused(scene):
    path = scene.file("house.rio", owsdtest.rio("localhost", []))
    before = path.read_text()
    done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature",
                        "Type=bool", "IO=input", "Type=byte")
    assert done.returncode == 2, done
    assert "Type is given twice" in done.stderr, done.stderr
    assert path.read_text() == before


def test_a_link_to_nowhere_is_named(scene):
    path = scene.path / "link.rio"
    path.symlink_to(scene.path / "nowhere.rio")
    done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature")
    assert done.returncode == 1, done
    assert "link.rio: error: is a symbolic link to a file that is not there" in done.stderr
    assert os.listdir(scene.path) == ["link.rio"]


if __name__ == "__main__":
    owsdtest.main()
