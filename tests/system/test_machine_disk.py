#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A full disk and a full file system under owsd's directory, each a small one in a mount namespace of this test."""

import os
import pathlib
import signal
import subprocess

import faulty
import owsdtest
import private
from owsdtest import until

PLACE = pathlib.Path("/dev/shm/owsd")
OF_A_RUNNING_OWSD = ["control", "force", "image", "lock", "sock"]


def fill(scene, folder):
    """Leave no page; returns how to free it again."""
    filler = folder / f"{scene.name()}.filler"  # goes with the scene
    with open(filler, "wb", buffering=0) as file:
        try:
            while True:
                file.write(bytes(4096))
        except OSError:
            pass
    return filler.unlink


def disk(scene, size="64k"):
    folder = scene.path / "disk"
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], check=True)
    return folder


def room_is_good(scene, daemon):
    until(lambda: scene.get(daemon, "room") == "21.5", 20, "room is good")


def test_a_start_on_a_full_file_system_leaves_nothing_behind(scene):
    name = scene.name()
    free = fill(scene, PLACE)
    daemon = scene.owsd(faulty.house(scene), name=name, ready=False)
    assert daemon.wait() == 1
    owsdtest.logged(daemon, f"{PLACE} is full")
    assert faulty.leftovers(name) == []
    free()
    room_is_good(scene, scene.owsd(daemon.config, name=name))


def test_a_lock_of_before_is_taken_also_when_the_file_system_is_full(scene):
    before = scene.owsd(faulty.house(scene))
    before.kill()
    # nothing is missing but what it would add
    free = fill(scene, PLACE)
    daemon = scene.owsd(before.config, name=before.name, ready=False)
    assert daemon.wait() == 1
    owsdtest.logged(daemon, f"{PLACE} is full")
    assert "cannot lock" not in daemon.log(), daemon.log()
    assert faulty.leftovers(before.name) == ["force", "image", "lock"]
    free()
    room_is_good(scene, scene.owsd(before.config, name=before.name))


def test_a_reload_that_the_file_system_has_no_room_for_changes_nothing(scene):
    config = scene.file("house.rio", faulty.house(scene))
    daemon = scene.owsd(config)
    room_is_good(scene, daemon)
    free = fill(scene, PLACE)
    config.write_text(faulty.house(scene, more=True))
    daemon.signal(signal.SIGHUP)
    until(lambda: "all goes on as before" in daemon.log(), 10)
    owsdtest.logged(daemon, f"{PLACE} is full")
    until(lambda: faulty.leftovers(daemon.name) == OF_A_RUNNING_OWSD, 10, "nothing is left")
    assert scene.owsctl(daemon, "set", "relays", "5").returncode == 0
    until(lambda: scene.get(daemon, "relays") == "5", 10, "outputs are written")
    room_is_good(scene, daemon)
    free()
    daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(daemon, "hall") == "19.5", 20, "then it is done")
    until(lambda: scene.get(daemon, "relays") == "5", 20, "as it was commanded")
    assert daemon.stop() == 0


def test_a_reload_whose_image_cannot_be_put_in_place_is_said_and_done_later(scene):
    config = scene.file("house.rio", faulty.house(scene))
    daemon = scene.owsd(config)
    room_is_good(scene, daemon)
    image = PLACE / f"{daemon.name}.image"
    image.unlink()
    image.mkdir()
    config.write_text(faulty.house(scene, more=True))
    daemon.signal(signal.SIGHUP)
    until(lambda: "no program sees the values" in daemon.log(), 10, "it is said")
    owsdtest.logged(daemon, f": a directory of user root (0) is in the way: as root, rm -r {PLACE}/")
    owsdtest.logged(daemon, "again every second")
    until(lambda: daemon.log().count("no program sees") >= 2, 10, "and tried again")
    daemon.signal(signal.SIGHUP)  # has to wait
    image.rmdir()
    until(lambda: scene.get(daemon, "hall") == "19.5", 20, "the new table is there")
    until(lambda: daemon.log().count("reload:") == 2, 10, "and the reload that waited is done")
    until(lambda: faulty.counters(scene, daemon)["unfinished_reload"] == 0, 10)
    owsdtest.logged(daemon, "the rest of the reload is done")
    until(lambda: faulty.leftovers(daemon.name) == OF_A_RUNNING_OWSD, 10, "nothing is left")
    assert daemon.stop() == 0


def test_a_start_whose_image_cannot_be_put_in_place_is_refused_with_a_reason(scene):
    name = scene.name()
    (PLACE / f"{name}.image").mkdir()
    daemon = scene.owsd(faulty.house(scene), name=name, ready=False)
    assert daemon.wait() == 1
    owsdtest.logged(daemon, f": a directory of user root (0) is in the way: as root, rm -r {PLACE}/")
    (PLACE / f"{name}.image").rmdir()


def test_an_edit_on_a_full_disk_leaves_the_file_as_it_was(scene):
    folder = disk(scene)
    file = folder / "house.rio"
    text = faulty.house(scene)
    file.write_text(text)
    free = fill(scene, folder)
    for words in (["add", "attic", "/28.A0B1C2000009/temperature"], ["set", "room", "Uncached=off"],
                  ["remove", "room"]):
        done = scene.owsctl(None, "config", file, *words)
        assert done.returncode == 1 and "No space left" in done.stderr, (words, done)
        assert file.read_text() == text
        assert len(os.listdir(folder)) == 2, os.listdir(folder)
    free()
    assert scene.owsctl(None, "config", file, "remove", "relays").returncode == 0
    assert "relays" not in file.read_text()
    assert scene.owsd_once("--check", "-c", file).returncode == 0


def test_a_log_on_a_full_disk_stops_nothing_and_its_gap_is_told(scene):
    folder = disk(scene)
    config = scene.file("house.rio", faulty.house(scene))
    log = folder / "log"
    with open(log, "wb", buffering=0) as out:
        daemon = scene.owsd(config, prefix=["sh", "-c", f'exec "$@" 2>{log}', "sh"])
    until(lambda: "from down to up" in log.read_text(), 10, "it logs")
    free = fill(scene, folder)
    for _ in range(3):
        # more than the rest of the page that the file has
        config.write_text(faulty.house(scene) + f"# {'x' * 100}\nWrong{'y' * 2000} 1\n")
        daemon.signal(signal.SIGHUP)
    room_is_good(scene, daemon)
    until(lambda: faulty.counters(scene, daemon)["log_dropped"] > 0 or flood(daemon), 20, "lost")
    free()
    until(lambda: "lost" in log.read_text(errors="replace") or flood(daemon), 10, "the gap is told")
    assert daemon.stop() == 0


def flood(daemon):
    daemon.signal(signal.SIGHUP)
    return False


if __name__ == "__main__":
    private.main()
