#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd --board on trees of files, and what owsctl scan says of the board when it finds nothing."""

import os
import struct
import subprocess

import owsdtest

os.environ["OWSD_BOARDS"] = str(owsdtest.SOURCE / "board" / "boards")


def tree(scene, **files):
    """A root with these files; the name of each stands in FILES."""
    root = scene.path / "root"
    for name, content in files.items():
        file = root / FILES[name]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    return root


FILES = dict(model="proc/device-tree/model", config="boot/firmware/config.txt",
             speed="sys/bus/i2c/devices/i2c-1/of_node/clock-frequency", device="dev/i2c-1")


def board(scene, root, status, *more):
    done = scene.owsd_once(f"--board{''.join(more)}", "--root", root)
    assert done.returncode == status, done
    return done


def test_a_board_from_bare_to_ready(scene):
    root = tree(scene, model=b"Raspberry Pi 4 Model B Rev 1.1\0", config=b"# none\n")
    said = board(scene, root, 1).stdout
    assert "board: Raspberry Pi 4 Model B Rev 1.1 (raspberry-pi-4)" in said
    assert "missing: I2C is off" in said and "    sudo raspi-config nonint do_i2c 0" in said
    tree(scene, speed=struct.pack(">I", 100000))
    said = board(scene, root, 1).stdout
    assert "missing: there is no /dev/i2c-1" in said and "    sudo modprobe i2c-dev" in said
    tree(scene, device=b"")
    said = board(scene, root, 0).stdout
    assert "missing" not in said and "note: I2C runs at 100 kHz" in said
    tree(scene, speed=struct.pack(">I", 400000))
    said = board(scene, root, 0).stdout
    assert "/dev/i2c-1 at 400 kHz" in said and "runs at" not in said


def test_a_board_that_does_not_tell_is_named(scene):
    root = tree(scene, model=b"Raspberry Pi 3 Model B Rev 1.2\0",
                speed=struct.pack(">I", 400000), device=b"")
    assert "on it: UniPi 1.1 (unipi-1.1), 0x18" in board(scene, root, 0, "=unipi-1.1").stdout
    assert "monarco-hat" in board(scene, root, 2, "=unipy").stderr


def test_a_root_that_is_too_long_is_refused(scene):
    """Not looked at as far as there is room: that is another folder."""
    base = scene.path / "root"
    short = base / ("a" * (255 - len(str(base))))
    (short / "sys/bus/i2c/devices/i2c-1").mkdir(parents=True)
    (short / "dev").mkdir()
    (short / "dev/i2c-1").touch(0)
    for root in (f"{short}{'b' * 10}", f"{short}/{'c/' * 2000}"):
        done = scene.owsd_once("--board", "--root", root)
        assert done.returncode == 2 and "too long" in done.stderr and not done.stdout, done


def test_wrong_use_is_refused(scene):
    assert "--root goes with --board" in scene.owsd_once("--root", "/").stderr


def test_no_output_is_no_success(scene):
    root = tree(scene, model=b"x\0", speed=struct.pack(">I", 400000), device=b"")
    command = f"exec '{owsdtest.OWSD}' --board --root '{root}' >/dev/full"
    done = scene._run(["sh", "-c", command], 20)
    assert done.returncode == 1 and "cannot write" in done.stderr, done


def test_a_scan_in_vain_says_which_board_this_is(scene):
    done = scene.owsctl(None, "-t", "i2c:/dev/i2c-nowhere", "scan")
    assert done.returncode == 1 and not done.stdout, done
    lines = done.stderr.splitlines()
    assert "/dev/i2c-nowhere" in lines[0] and lines[1].startswith("board: "), done
    silent = scene.owsctl(None, "-t", f"127.0.0.1:{owsdtest.free_port()}", "scan")
    assert silent.returncode == 1 and "board: " not in silent.stderr, silent


def test_auto_is_the_first_way_that_is_there_or_says_what_each_lacks(scene):
    with owsdtest.default_port():
        done = scene.owsctl(None, "-t", "auto", "scan", "-w", "60")
    if done.returncode:
        first = done.stderr.splitlines()[0]
        assert all(f"cannot open {way}" in first for way in ("localhost:4304", "i2c:auto", "w1"))
        assert "stands for several" not in first and "board: " in done.stderr, done
    else:
        assert done.stdout.startswith("PATH"), done


def test_a_ds9490r_that_auto_leaves_to_the_kernel_is_named(scene):
    if os.geteuid() != 0:
        owsdtest.skip("only root may have another /sys/bus")
    bus = scene.path / "bus"
    (bus / "usb/devices/1-1").mkdir(parents=True)
    (bus / "usb/devices/1-1/uevent").write_text("PRODUCT=4fa/2490/2\nDEVNAME=bus/usb/001/004\n")

    def scan():
        return subprocess.run(["unshare", "-m", "-n", "sh", "-c", 'mount --bind "$0" /sys/bus && exec "$@"', bus,
                               owsdtest.OWSCTL, "-t", "auto", "scan"],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
    done = scan()
    assert done.returncode == 1 and "; -t usb: asks the DS9490R at USB 1-1" in done.stderr, done
    (bus / "w1/devices/w1_bus_master1").mkdir(parents=True)
    done = scan()
    assert "with -t usb: owsd itself drives the DS9490R at USB 1-1" in done.stderr, done


if __name__ == "__main__":
    owsdtest.main()
