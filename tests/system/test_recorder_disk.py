#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Disks under owsd-recorder that are full, read-only or pulled, in a mount namespace of this test:
it says so once, goes on from memory, and loses nothing that fits there; owsd notices nothing."""

import contextlib
import os
import pathlib
import re
import resource
import shutil
import sqlite3
import subprocess

import faulty
import owsdtest
import private
from owsdtest import until
from recorded import Past, boot, distinct, record, set_relays, text

# What ext4 answers when its device has errors
BROKEN = ("Read-only file system", "Input/output error")


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          check=False, timeout=60)


def mount(*words):
    """None, or what is wrong."""
    done = run("mount", *words)
    return done.stderr.strip() if done.returncode else None


class Card:
    """A small file system in a folder. The history is two folders deep in it, so that the recorder
    cannot make its place anew where no card is."""

    def __init__(self, scene, folder="card"):
        self.folder = scene.path / folder
        self.folder.mkdir()
        self.history = self.folder / "plant" / "history"

    def fill(self):
        """Leave no room."""
        with open(self.folder / "filler", "wb", buffering=0) as file, contextlib.suppress(OSError):
            while True:
                file.write(bytes(1 << 16))
        # some file systems take what they cannot place, and find more room for less
        with open(self.folder / "filler", "ab", buffering=0) as file, contextlib.suppress(OSError):
            os.fsync(file.fileno())
            while True:
                file.write(bytes(512))

    def empty(self):
        (self.folder / "filler").unlink()

    def __enter__(self):
        return self

    def __exit__(self, *problem):
        run("umount", "-l", self.folder)


class Memory(Card):
    def __init__(self, scene):
        super().__init__(scene)
        wrong = mount("-t", "tmpfs", "-o", "size=1m", "tmpfs", self.folder)
        assert not wrong, wrong


class Ext4(Card):
    """On a loop device, which goes away with its mount."""

    def __init__(self, scene):
        super().__init__(scene)
        self.image = scene.path / "image"
        if not shutil.which("mkfs.ext4"):
            owsdtest.skip("mkfs.ext4 is not installed")
        with open(self.image, "wb") as file:
            file.truncate(8 << 20)
        made = run("mkfs.ext4", "-q", "-F", self.image)
        wrong = made.stderr if made.returncode else self.plug_in()
        if wrong:
            owsdtest.skip(f"no loop device with ext4 here: {wrong}")

    def plug_in(self):
        return mount("-o", "loop,errors=remount-ro", self.image, self.folder)

    def device(self):
        mounts = pathlib.Path("/proc/self/mounts").read_text(encoding="utf-8")
        return re.search(rf"^/dev/(loop\d+) {self.folder} ", mounts, re.M)[1]

    def unplug(self):
        """Once the recorder has closed what it had open there."""
        until(lambda: not run("umount", self.folder).returncode, 20, "nobody has a file open there")

    def break_down(self):
        """As ext4 does when it finds an error of its own: it takes nothing any more."""
        trigger = pathlib.Path("/sys/fs/ext4", self.device(), "trigger_fs_error")
        if not trigger.exists():
            owsdtest.skip("this kernel's ext4 has no errors on demand")
        trigger.write_text("the test\n", encoding="utf-8")

    def pull(self, recorder):
        """The device has no bytes any more; those that it had are plugged in the next time."""
        recorder.freeze()
        pulled = self.image.with_name("pulled")
        shutil.copy(self.image, pulled)
        os.truncate(self.image, 0)
        assert run("losetup", "-c", f"/dev/{self.device()}").returncode == 0
        recorder.thaw()
        self.image = pulled


def written(history):
    """Rows in its file."""
    file = history / "history.sqlite"
    if not file.exists():
        return 0
    with contextlib.closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as db:
        try:
            return db.execute("select (select count(*) from raw) + (select count(*) from event)"
                              ).fetchone()[0]
        except sqlite3.OperationalError:
            return 0


def told(recorder):
    return re.findall(r"cannot be written: ([^;]*)", recorder.log())


class Plant:
    """owsd, and a recorder into the card. What is commanded is counted from 1. All of it has to be
    recorded as commands; of the values, what stood until the recorder had time to look."""

    def __init__(self, scene, card):
        self.scene, self.card, self.commanded = scene, card, 0
        self.daemon = scene.owsd(text(scene))
        self.recorder = record(scene, self.daemon, "-v", directory=card.history)

    def command(self, count=2):
        """owsd does it as ever, whatever the disk does."""
        for _ in range(count):
            self.commanded += 1
            set_relays(self.scene, self.daemon, self.commanded)
        assert self.scene.get(self.daemon, "relays") == str(self.commanded)
        until(lambda: self.scene.get(self.daemon, "room") == "21.5", 20, "the room is good")

    def written(self):
        return written(self.card.history)

    def fails(self, *reasons):
        until(lambda: told(self.recorder), 20, "the recorder says so")
        assert told(self.recorder)[0] in reasons, self.recorder.log()

    def recovers(self):
        until(lambda: "is written again" in self.recorder.log(), 60, self.recorder.log)
        assert "is written again; 0 rows" in self.recorder.log(), self.recorder.log()

    def check(self):
        """Ends the recorder."""
        assert len(told(self.recorder)) == 1, self.recorder.log()
        assert self.recorder.stop() == 0
        assert "is lost" not in self.recorder.log(), self.recorder.log()
        past = Past(self.scene, self.card.history)
        every = [str(n + 1) for n in range(self.commanded)]
        assert [words[3] for words in past.kinds("command")] == every, past.events
        kept, expected = distinct(past.good("relays")), iter(every)
        assert all(value in expected for value in kept) and kept[-1] == every[-1], past.signals
        assert not [gap for gap in past.kinds("gap") if "disk" in " ".join(gap)], past.events


def outage(plant, begin, reasons, end):
    plant.command()
    until(plant.written, 20, "something is on the disk")
    begin()
    plant.command()
    plant.fails(*reasons)
    plant.command()
    end()
    plant.recovers()
    plant.command(1)
    plant.check()


def test_a_full_disk_gets_all_that_was_recorded_once_there_is_room(scene):
    for kind in (Memory, Ext4):
        with owsdtest.Scene() as part, kind(part) as card:
            outage(Plant(part, card), card.fill, ["No space left on device"], card.empty)


def test_a_disk_that_ext4_makes_read_only_gets_all_when_it_is_mounted_again(scene):
    with Ext4(scene) as card:
        def mount_again():
            card.unplug()
            assert not card.plug_in()
        outage(Plant(scene, card), card.break_down, BROKEN, mount_again)


def test_a_card_that_is_pulled_gets_all_when_it_is_plugged_in_again(scene):
    with Ext4(scene) as card:
        plant = Plant(scene, card)

        def plug_in_again():
            card.unplug()
            # other errors of the same card are no news
            until(lambda: "cannot be written yet: No such file" in plant.recorder.log(), 60,
                  "it looks for the card")
            assert not card.plug_in()
        outage(plant, lambda: card.pull(plant.recorder), BROKEN, plug_in_again)


def test_a_card_that_is_unmounted_under_the_recorder_gets_all_when_it_is_mounted_again(scene):
    with Ext4(scene) as card:
        def unmount():
            assert run("umount", "-l", card.folder).returncode == 0

        def mount_again():
            # the loop device goes when the recorder has closed its file
            until(lambda: not card.plug_in(), 20, "it can be mounted again")
        outage(Plant(scene, card), unmount, ["No such file or directory"], mount_again)


def test_a_start_on_a_read_only_disk_records_from_memory(scene):
    with Ext4(scene) as card:
        card.history.mkdir(parents=True)
        assert not mount("-o", "remount,ro", card.folder)
        plant = Plant(scene, card)
        plant.command()
        plant.fails("Read-only file system")
        plant.command()
        assert not mount("-o", "remount,rw", card.folder)
        plant.recovers()
        plant.check()


def test_an_end_while_the_disk_is_full_is_in_time_and_says_what_is_lost(scene):
    with Memory(scene) as card:
        plant = Plant(scene, card)
        plant.command()
        until(lambda: len(Past(scene, card.history).kinds("command")) == 2, 20,
              "both are on the disk")
        card.fill()
        plant.command()
        plant.fails("No space left on device")
        before = boot()
        assert plant.recorder.stop() == 0
        owsdtest.logged(plant.recorder, "No space left on device: what was in memory is lost")
        past = Past(scene, card.history)
        assert distinct(past.good("relays"))[-1] == "2", past.signals
        # nothing that was on the disk looks as if it had stayed so
        assert past.at("relays", before) is None and past.at("room", before) is None, past.signals


def test_a_disk_that_takes_no_larger_file_gets_all_once_it_does(scene):
    faulty.not_sanitized("its files are bound too")
    card = Card(scene)
    plant = Plant(scene, card)

    def limit(size):
        resource.prlimit(plant.recorder.pid, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
    # what the recorder logs has to fit, and a commit, of a dozen pages from anywhere in its log, must not
    outage(plant, lambda: limit(4 * 4096), ["Input/output error"],  # SQLite says no more
           lambda: limit(resource.RLIM_INFINITY))


def test_a_directory_that_cannot_be_made_was_not_deleted(scene):
    daemon = scene.owsd(text(scene))
    recorder = scene.start([owsdtest.BUILD / "owsd-recorder", "-n", daemon.name, "-c", daemon.config, "-d", "/proc/nohist"])
    until(lambda: "/proc/nohist cannot be written" in recorder.log(), 20, recorder.log)
    assert "it cannot be made: Directory or -d gives another; up to 4096 kB are kept in memory" in recorder.log(), recorder.log()
    until(lambda: "signals into memory, until it can be written: /proc/nohist" in recorder.log(), 20, recorder.log)
    assert "deleted" not in recorder.log(), recorder.log()


def test_a_directory_that_is_deleted_is_said_and_made_anew(scene):
    daemon = scene.owsd(text(scene))
    recorder = record(scene, daemon)
    history = scene.path / "history"
    set_relays(scene, daemon, 1)
    until(lambda: written(history), 20, "something is on the disk")
    shutil.rmtree(history)
    set_relays(scene, daemon, 2)
    until(lambda: "its file was deleted" in recorder.log(), 20, "the recorder says so")
    until(lambda: "is written again, in another file" in recorder.log(), 20, "and makes it anew")
    begun = boot()
    set_relays(scene, daemon, 3)
    until(lambda: "3" in Past(scene).good("relays"), 20, "it has looked since")
    ended = boot()
    assert recorder.stop() == 0
    past = Past(scene)
    assert past.at("relays", begun) == "2" and past.at("relays", ended) == "3", past.signals
    assert past.at("room", ended) == "21.5", past.signals


if __name__ == "__main__":
    private.main()
