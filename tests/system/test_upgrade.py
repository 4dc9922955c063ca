#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd starts where an owsd of layout 1 has been, whose segments were in /dev/shm: here a small one of
this test's own. What programs with the library of that time see is in tests/unit/shm/test_retire.c."""

import fcntl
import os
import pathlib
import struct

import faulty
import owsdtest
import private
from owsdtest import until

SHM = pathlib.Path("/dev/shm")
DATA = owsdtest.SOURCE / "tests/unit/data"
LIVE, STOPPED = 1, 3


def put(name, kind):
    """A segment that owsd 0.1 has made."""
    head, *lines = (DATA / f"segments-0.1.0.{kind}").read_text().splitlines()
    memory = bytearray(int(head.split()[1], 16))
    for line in lines:
        at, data = line.split(":")
        data = bytes.fromhex(data)
        memory[int(at, 16):int(at, 16) + len(data)] = data
    path = SHM / f"owsd.{name}.{kind}"
    path.write_bytes(memory)
    path.chmod(0o640)
    return path


def head_of(file):
    """Magic, major, minor, size, generation, state."""
    file.seek(0)
    return struct.unpack("<4sHHIII", file.read(20))


def test_its_segments_are_retired_and_a_stub_is_in_their_place(scene):
    name = scene.name()
    paths = {kind: put(name, kind) for kind in ("image", "command")}
    kept = {kind: path.open("rb", buffering=0) for kind, path in paths.items()}
    assert all(head_of(file)[5] == LIVE for file in kept.values())
    daemon = scene.owsd(faulty.house(scene), name=name)
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "room is good")
    for kind, file in kept.items():
        assert head_of(file)[5] == STOPPED, kind
        with paths[kind].open("rb") as stub:
            assert head_of(stub)[1:] == (2, 0, 256, 0, STOPPED), kind
            assert len(stub.read()) == 256 - 20
        file.close()
    said = "an older owsd has left segments in /dev/shm"
    owsdtest.logged(daemon, said)
    assert daemon.stop() == 0
    again = scene.owsd(daemon.config, name=name)
    until(lambda: scene.get(again, "room") == "21.5", 20, "room is good")
    assert said not in again.log(), "it is said once"
    for path in paths.values():
        path.unlink()


def test_beside_one_that_runs_no_other_starts(scene):
    name = scene.name()
    image = put(name, "image")
    lock = SHM / f"owsd.{name}.lock"
    lock.write_text(f"{os.getpid()}\n")
    lock.chmod(0o600)
    with lock.open("r+") as file:
        fcntl.fcntl(file, 37, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 0, 1, 0))  # F_OFD_SETLK
        daemon = scene.owsd(faulty.house(scene), name=name, ready=False)
        assert daemon.wait() == 1
        owsdtest.logged(daemon, f"instance {name} is already served by process {os.getpid()}, an older owsd; "
                                "end it or choose another name with -n")
        with image.open("rb") as of_it:
            assert head_of(of_it)[5] == LIVE, "its programs go on"
    assert scene.owsd(daemon.config, name=name).stop() == 0
    assert not lock.exists()
    image.unlink()


def test_without_any_nothing_is_made_or_said(scene):
    daemon = scene.owsd(faulty.house(scene))
    assert daemon.stop() == 0
    assert "older owsd" not in daemon.log()
    assert not list(SHM.glob(f"owsd.{daemon.name}.*"))


if __name__ == "__main__":
    private.main()
