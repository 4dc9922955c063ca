#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The recipe of plc.md for LinuxCNC, with the file of owsctl modbus-map, in a genuine halrun with its
mb2hal: installed, or out of Debian's package, unpacked into the user's cache. It runs in namespaces
of its own, since a machine has one HAL."""

import fcntl
import os
import pathlib
import re
import shutil
import subprocess

import owsdtest
from modbushouse import CELLAR, GOOD, NO_OWSD, Client, ROOM, serve, text
from owsdtest import SOURCE, free_port, until

# With what else halcmd and mb2hal load
PACKAGES = ("linuxcnc-uspace", "libmodbus5", "libedit2", "libbsd0", "libmd0")
LONG = "a_signal_whose_name_is_longer_than_a_pin"
USER = "65534"  # HAL asks for one that is not root


def unpacked():
    """Where the packages lie; None: LinuxCNC is installed."""
    if shutil.which("mb2hal"):
        return None
    if not shutil.which("dpkg"):
        owsdtest.skip("LinuxCNC is not installed, and this is no Debian")
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    base.mkdir(parents=True, exist_ok=True)
    place = base / "linuxcnc"
    with open(base / "linuxcnc.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "whole").exists():
            shutil.rmtree(place, ignore_errors=True)
            arch = subprocess.run(["dpkg", "--print-architecture"], check=True, capture_output=True, text=True).stdout.strip()
            done = subprocess.run([SOURCE / "board/fetch-debs", "-x", "-", arch, place, *PACKAGES], check=False,
                                  capture_output=True, text=True, timeout=300)
            if done.returncode:
                owsdtest.skip(f"LinuxCNC is not installed, and cannot be had: {done.stderr.strip().splitlines()[-1:]}")
            (place / "whole").touch()
    return place


class Hal:
    """halrun with a file, and a look at its pins again and again."""

    def __init__(self, scene, recipe):
        if os.geteuid():
            owsdtest.skip("namespaces of its own need root")
        packages = unpacked()
        mounts = "mount -t tmpfs -o mode=1777 fifo /mnt || exit 77\n" + "".join(
            f"mount -t overlay packages -o lowerdir={packages}/{top}:/{top} /{top} || exit 77\n"
            for top in ("usr", "etc") if packages)
        looks = scene.file("looks", "#!/bin/sh\nwhile sleep 0.3; do halcmd -s show pin; echo end; done\n")
        looks.chmod(0o755)
        start = "loadrt threads name1=servo-thread period1=1000000\nstart\n"
        scene.file("recipe.hal", f"{start}{recipe}loadusr -w {looks}\n")
        self.process = scene.start(["unshare", "--mount", "--ipc", "--pid", "--fork", "--kill-child", "--mount-proc", "sh", "-c",
                                    f"{mounts}cd {scene.path} && exec halrun recipe.hal"],
                                   {"HOME": "/mnt", "RTAPI_UID": USER, "RTAPI_FIFO_PATH": "/mnt/fifo"})

    def pins(self):
        """Name -> what it is, of the last look."""
        if not self.process.running() and self.process.wait() == 77:
            owsdtest.skip("no mounts of its own here")
        looks = self.process.log().split("\nend\n")
        rows = [line.split() for line in looks[-2].splitlines()] if len(looks) > 1 else []
        return {row[4]: row[3] for row in rows if len(row) > 4}

    def becomes(self, wanted):
        until(lambda: wanted.items() <= self.pins().items(), 60, lambda: f"{wanted}\n{self.process.log()[-4000:]}")


def test_the_recipe_has_the_values_and_knows_when_there_are_none(scene):
    port = free_port()
    daemon = scene.owsd(text(scene, port, ROOM, {**CELLAR, "Name": "room1"}, {**ROOM, "Name": LONG, "Path": CELLAR["Path"],
                                                                            "Identity": "/other"}))
    face = serve(scene, daemon)
    with Client(port) as plc:
        plc.becomes(3, GOOD)
    page = (SOURCE / "docs/plc.md").read_text().split("## LinuxCNC", 1)[1].split("\n## ", 1)[0]
    command = re.search(r"```sh\nowsctl (.*) > owsd.ini\n```", page)[1]
    written = scene.owsctl(daemon, *command.replace("192.168.1.10", f"127.0.0.1:{port}").split(), "-d", scene.path / "state")
    assert written.returncode == 0, written
    scene.file("owsd.ini", written.stdout)
    hal = Hal(scene, (SOURCE / "docs/examples/linuxcnc/mb2hal.hal").read_text())
    room1 = {"owsd.room1.quality.int": str(GOOD), "lincurve.0.out": "-3.3"}
    hal.becomes({"owsd.room.value.int": "215", "owsd.room.quality.int": str(GOOD), **room1, "and2.0.out": "TRUE"})
    # mb2hal would not start with a pin of that name
    assert f"owsd.{LONG[:22]}_P3.quality.float" in hal.pins(), hal.pins()
    daemon.kill()
    hal.becomes({"owsd.room1.quality.int": str(NO_OWSD), "lincurve.0.out": "-3276.8", "and2.0.out": "FALSE"})
    scene.owsd(daemon.config, name=daemon.name)
    hal.becomes({**room1, "and2.0.out": "TRUE"})
    # it keeps what it has read last, which nothing but the heart shows; and does not connect again
    face.kill()
    hal.becomes({**room1, "and2.0.out": "FALSE"})


if __name__ == "__main__":
    owsdtest.main()
