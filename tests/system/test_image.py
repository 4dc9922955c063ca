#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The image stages in a root directory of our own making, and the scan of the first start."""

import os
import shutil
import stat
import subprocess

import owsdtest

# The owsd of the first start scans a simulated wire
REAL = {"owsd": owsdtest.BUILD / "owsd-sim", "owsctl": owsdtest.BUILD / "owsctl-sim"}
IMAGE = owsdtest.SOURCE / "board" / "image"
PACKAGED = (owsdtest.SOURCE / "board" / "debian" / "OWS.rio").read_text()
ROUTINE = "dtparam=audio=on\n#dtparam=i2c_arm=on\n\n[pi5]\ndtoverlay=nospi10\n"
WANTED = ["dtparam=i2c_arm=on", "dtparam=i2c_arm_baudrate=400000"]


def sh(scene, *command, **env):
    return subprocess.run([str(c) for c in command], cwd=scene.path, text=True, timeout=180,
                          env=dict(os.environ, **env), stdin=subprocess.DEVNULL,
                          capture_output=True)


def root(scene, config="boot/firmware/config.txt"):
    """A root with the firmware's file and what the package brings."""
    top = scene.path / "root"
    for name, text in ((config, ROUTINE), ("usr/share/owsd/OWS.rio", PACKAGED),
                       ("etc/owsd/OWS.rio", PACKAGED),
                       ("usr/lib/modules-load.d/owsd.conf", "i2c-dev\n")):
        file = top / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return top


def everything(top):
    return {str(p.relative_to(top)): p.read_bytes() for p in top.rglob("*") if p.is_file()}


def test_a_root_gets_i2c_at_400_khz_and_the_first_start(scene):
    top = root(scene)
    done = sh(scene, IMAGE / "setup", top)
    assert done.returncode == 0, done
    lines = (top / "boot/firmware/config.txt").read_text().splitlines()
    assert lines[:5] == ROUTINE.splitlines()
    assert all(lines.index(line) > lines.index("[all]") for line in WANTED), lines
    assert "dtoverlay=w1-gpio" not in lines
    script = top / "usr/local/lib/owsd/firstboot"
    assert stat.S_IMODE(script.stat().st_mode) == 0o755
    link = top / "etc/systemd/system/multi-user.target.wants/owsd-firstboot.service"
    assert link.is_symlink() and link.exists()
    unit = link.read_text()
    assert "ExecStart=/usr/local/lib/owsd/firstboot look\n" in unit and "User=owsd\n" in unit
    assert unit.count("=+") == 1 and "ExecStartPost=+/usr/local/lib/owsd/firstboot put\n" in unit
    assert (top / "etc/owsd/OWS.rio").read_text() == PACKAGED
    before = everything(top)
    assert sh(scene, IMAGE / "setup", top).returncode == 0
    assert everything(top) == before


def test_a_line_for_another_board_is_not_taken_for_one_of_all(scene):
    top = root(scene)
    file = top / "boot/firmware/config.txt"
    file.write_text(f"[pi4]\n{WANTED[0]}\n[all]\n{WANTED[1]}\n")
    for _ in range(2):
        assert sh(scene, IMAGE / "setup", top).returncode == 0
        lines = file.read_text().splitlines()
        assert lines.count(WANTED[0]) == 2 and lines.count(WANTED[1]) == 1, lines


def test_the_overlay_of_gpio_4_comes_when_it_is_asked_for(scene):
    top = root(scene, "boot/config.txt")
    (top / "usr/lib/modules-load.d/owsd.conf").unlink()
    assert sh(scene, IMAGE / "setup", "--w1-gpio", top).returncode == 0
    lines = (top / "boot/config.txt").read_text().splitlines()
    assert lines.count("dtoverlay=w1-gpio") == 1 and set(WANTED) <= set(lines)
    assert (top / "etc/modules-load.d/owsd.conf").read_text() == "i2c-dev\n"


def test_a_root_without_firmware_or_owsd_is_refused(scene):
    top = root(scene)
    (top / "usr/share/owsd/OWS.rio").unlink()
    done = sh(scene, IMAGE / "setup", top)
    assert done.returncode == 1 and "owsd is not installed" in done.stderr, done
    (top / "boot/firmware/config.txt").unlink()
    done = sh(scene, IMAGE / "setup", top)
    assert done.returncode == 1 and "firmware" in done.stderr, done
    assert sh(scene, IMAGE / "setup", scene.path / "nowhere").returncode == 2


def debs(scene, arch="arm64", mark="deb13"):
    folder = scene.path / "debs"
    folder.mkdir(exist_ok=True)
    for name in (f"owsd_0.1.0+{mark}_{arch}", f"libows1_0.1.0+{mark}_{arch}",
                 f"python3-ows_0.1.0+{mark}_all", f"owsd_0.1.0+{mark}_other",
                 f"owsd_0.1.0+deb99_{arch}"):
        (folder / f"{name}.deb").write_text(name)
    return folder


def test_of_several_versions_the_newest_packages_are_taken(scene):
    folder = debs(scene)
    for version in ("0.9.0", "0.10.0"):
        for name in ("owsd", "libows1"):
            (folder / f"{name}_{version}+deb13_arm64.deb").touch()
        (folder / f"python3-ows_{version}+deb13_all.deb").touch()
    done = sh(scene, IMAGE / "debs", folder, "arm64", "trixie")
    assert done.returncode == 0 and done.stdout.count("_0.10.0+deb13") == 3, done
    assert len(done.stdout.splitlines()) == 3, done


def test_the_stage_of_pi_gen_installs_our_packages_and_sets_the_root_up(scene):
    top = root(scene)
    # what pi-gen exports to a stage: the function that runs its stdin in the root
    script = """
    on_chroot() { cat >"$ROOTFS_DIR/asked"; ls "$ROOTFS_DIR/var/cache/owsd" >"$ROOTFS_DIR/saw"; }
    export -f on_chroot
    cd "$STAGE/00-owsd" && ./00-run.sh
    """
    env = dict(ROOTFS_DIR=str(top), STAGE=str(IMAGE / "pi-gen" / "stage-owsd"), ARCH="arm64",
               RELEASE="trixie", OWSD_DEBS=str(debs(scene)), OWSD_W1_GPIO="1")
    done = sh(scene, "bash", "-ec", script, **env)
    assert done.returncode == 0, done
    assert "apt-get install -y" in (top / "asked").read_text()
    assert (top / "saw").read_text().split() == [
        "libows1_0.1.0+deb13_arm64.deb", "owsd_0.1.0+deb13_arm64.deb",
        "python3-ows_0.1.0+deb13_all.deb"]
    assert not (top / "var/cache/owsd").exists()
    assert "dtoverlay=w1-gpio" in (top / "boot/firmware/config.txt").read_text()
    done = sh(scene, "bash", "-ec", script, **dict(env, RELEASE="bookworm"))
    assert done.returncode != 0 and "make deb ARCH=arm64 SUITE=bookworm" in done.stderr, done


def test_the_layer_of_rpi_image_gen_does_the_same(scene):
    """Its hook, with a chroot that notes what it is asked."""
    layer = (IMAGE / "rpi-image-gen" / "layer" / "owsd.yaml").read_text()
    hook = layer.split("  customize-hooks:\n    - |-\n")[1]
    assert all(line.startswith("      ") for line in hook.splitlines())
    top, tools = root(scene), scene.path / "tools"
    tools.mkdir()
    for name, text in (("chroot", 'case "$*" in *print-arch*) echo arm64 ;; *) echo "$*" '
                                  '>"$1/asked"; ls "$1/var/cache/owsd" >"$1/saw" ;; esac'),
                       ("igconf", '[ "$1 $2" = "isy owsd_w1_gpio" ] && [ "$WIRE" = y ]')):
        (tools / name).write_text(f"#!/bin/sh\n{text}\n")
        (tools / name).chmod(0o755)
    env = dict(IGconf_owsd_image=str(IMAGE), IGconf_owsd_debs=str(debs(scene)),
               IGconf_owsd_suite="trixie", WIRE="n", PATH=f"{tools}:{os.environ['PATH']}")
    done = sh(scene, "sh", "-c", hook, "hook", top, **env)
    assert done.returncode == 0, done
    assert len((top / "saw").read_text().split()) == 3
    text = (top / "boot/firmware/config.txt").read_text()
    assert WANTED[1] in text and "w1-gpio" not in text
    assert sh(scene, "sh", "-c", hook, "hook", top, **dict(env, WIRE="y")).returncode == 0
    assert "dtoverlay=w1-gpio" in (top / "boot/firmware/config.txt").read_text()


THERMOMETER = "DS18B20 28.000000000002 temperature 21.5\n"


class First:
    """The first start on this machine, with simulated devices."""

    def __init__(self, scene, devices=THERMOMETER, name="first"):
        self.scene = scene
        self.here = scene.path / name
        self.etc, self.state, self.tools, self.run_of = (self.here / n for n in
                                                         ("etc", "state", "bin", "run"))
        self.found = self.run_of / "OWS.rio"
        for folder in (self.here, self.etc, self.tools, self.run_of):
            folder.mkdir()
        self.file = self.etc / "OWS.rio"
        self.packaged = self.here / "packaged.rio"
        self.net = self.here / "net.sim"
        self.file.write_text(PACKAGED)
        self.packaged.write_text(PACKAGED)
        self.wire(devices)
        for name in REAL:
            self.real(name)

    def wire(self, devices):
        self.net.write_text("chip DS2482-100 0x18\n" + devices)

    def real(self, name):
        (self.tools / name).unlink(missing_ok=True)
        (self.tools / name).symlink_to(REAL.get(name) or shutil.which(name))

    def tool(self, name, text):
        (self.tools / name).unlink(missing_ok=True)
        (self.tools / name).write_text(f"#!/bin/sh\n{text}\n")
        (self.tools / name).chmod(0o755)

    def half(self, verb):
        return sh(self.scene, "sh", IMAGE / "firstboot", verb, OWSD_ETC=str(self.etc),
                  OWSD_STATE=str(self.state), OWSD_PACKAGED=str(self.packaged),
                  OWSD_FOUND=str(self.found), OWSD_TARGET=f"sim:{self.net}",
                  PATH=f"{self.tools}:{os.environ['PATH']}")

    def run(self):
        """Both halves, as the unit does."""
        looked = self.half("look")
        if looked.returncode:
            return looked
        done = self.half("put")
        done.stderr = looked.stderr + done.stderr
        return done

    def left(self):
        return sorted(p.name for p in self.etc.iterdir())

    def done(self):
        return (self.state / "firstboot.done").exists()


def test_the_first_start_makes_the_configuration_and_no_later_one_does(scene):
    first = First(scene)
    ran = first.run()
    assert ran.returncode == 0 and "1 signal of" in ran.stderr, ran
    made = first.file.read_text()
    assert "28.000000000002" in made and first.left() == ["OWS.rio"] and first.done()
    assert stat.S_IMODE(first.file.stat().st_mode) == 0o644
    daemon = scene.owsd(first.file)
    scene.until(lambda: scene.get(daemon, "temperature1") == "21.5", 20, "the first value")
    first.file.unlink()
    assert first.run().returncode == 0 and first.left() == []


def test_a_file_that_was_changed_stays(scene):
    first = First(scene)
    first.file.write_text(PACKAGED + "# mine\n")
    ran = first.run()
    assert ran.returncode == 0 and "stays" in ran.stderr and first.done(), ran
    assert first.file.read_text() == PACKAGED + "# mine\n"


def test_a_file_that_comes_while_the_scan_goes_on_stays(scene):
    """As an installer that is about its work at the first start, too, puts it there."""
    for name, change in (("put", "echo '# mine' >"), ("removed", "rm ")):
        first = First(scene, name=name)
        first.tool("owsctl", f"{change}'{first.file}'; exec '{REAL['owsctl']}' \"$@\"")
        ran = first.run()
        assert ran.returncode == 0 and "stays" in ran.stderr and first.done(), ran
        if name == "put":
            assert first.file.read_text() == "# mine\n" and first.left() == ["OWS.rio"]
        else:
            assert first.left() == []


def test_with_nothing_found_nothing_is_written_and_the_next_start_looks_again(scene):
    first = First(scene, "")
    ran = first.run()
    assert ran.returncode == 0 and "looks again" in ran.stderr and not first.done(), ran
    assert first.file.read_text() == PACKAGED and first.left() == ["OWS.rio"]
    first.wire("DS18B20 28.000000000003 temperature 5\n")
    assert first.run().returncode == 0 and first.done()
    assert "28.000000000003" in first.file.read_text()


def test_a_power_cut_leaves_the_old_file_whole(scene):
    """Power goes while the scan is written, while it is checked, and before it is named."""
    for name, at in (("owsctl", "echo 'OwsDrv {'; kill -9 $PPID"), ("owsd", "kill -9 $PPID"),
                     ("sync", "kill -9 $PPID"), ("mv", "kill -9 $PPID")):
        first = First(scene, name=name)
        first.tool(name, at)
        assert first.run().returncode == -9
        assert first.file.read_text() == PACKAGED and not first.done(), name
        first.real(name)
        assert first.run().returncode == 0 and first.done(), name
        assert "28.000000000002" in first.file.read_text() and first.left() == ["OWS.rio"], name


def test_a_full_disk_leaves_the_old_file_and_is_said(scene):
    first = First(scene)
    # half of a scan, as a disk that is full keeps it
    first.tool("owsctl", f"'{REAL['owsctl']}' \"$@\" | head -c 300")
    ran = first.run()
    assert ran.returncode == 1 and "could not be written whole" in ran.stderr, ran
    assert first.file.read_text() == PACKAGED and not first.done()
    assert first.left() == ["OWS.rio"]
    first.tool("owsctl", f"exec '{REAL['owsctl']}' \"$@\" >/dev/full")
    ran = first.run()
    assert ran.returncode == 0 and "cannot write" in ran.stderr, ran
    assert first.file.read_text() == PACKAGED and first.left() == ["OWS.rio"]


LEFT = {
    "a link to a file of root's": lambda found, secret: found.symlink_to(secret),
    "a link to a device": lambda found, _: found.symlink_to("/dev/zero"),
    "a pipe": lambda found, _: os.mkfifo(found),
    "a directory": lambda found, _: found.mkdir(),
    "an empty file": lambda found, _: found.touch(),
    "a file without end": lambda found, _: (found.touch(), os.truncate(found, 1 << 40)),
}


def test_root_takes_nothing_but_a_file_of_what_the_scan_left(scene):
    """As an owsd that the wire has taken over would leave it."""
    secret = scene.file("secret", "of root\n")
    for n, (what, leave) in enumerate(LEFT.items()):
        first = First(scene, name=f"left{n}")
        leave(first.found, secret)
        done = first.half("put")
        assert done.returncode == 1 and "could not be written whole" in done.stderr, (what, done)
        assert first.file.read_text() == PACKAGED and not first.done(), what
        assert first.left() == ["OWS.rio"], what
        assert secret.read_text() == "of root\n"


def test_root_makes_no_file_where_a_link_leads(scene):
    first = First(scene)
    first.state.mkdir()
    (first.state / "firstboot.done").symlink_to(first.here / "nologin")
    assert first.half("look").returncode == 0
    done = first.half("put")
    assert done.returncode == 0 and "cannot write" in done.stderr, done
    assert not (first.here / "nologin").exists()


def test_the_half_of_the_first_start_that_runs_as_root_runs_no_program_of_ours(scene):
    first = First(scene)
    assert first.half("look").returncode == 0 and first.found.exists()
    assert first.file.read_text() == PACKAGED and not first.done()
    for name in ("owsd", "owsctl"):
        first.tool(name, f"touch '{first.here}/ran'")
    assert first.half("put").returncode == 0 and first.done()
    assert "28.000000000002" in first.file.read_text()
    assert not (first.here / "ran").exists()
    assert sh(scene, "sh", IMAGE / "firstboot", OWSD_STATE=str(first.here / "none")).returncode == 2


def test_the_sandbox_of_the_first_start_is_as_tight_as_that_of_the_service(scene):
    program = shutil.which("systemd-analyze")
    if not program:
        owsdtest.skip("systemd-analyze is not installed")
    done = sh(scene, program, "security", "--offline=true", "--threshold=15", "--no-pager",
              IMAGE / "owsd-firstboot.service")
    assert done.returncode == 0, done.stdout[-300:] + done.stderr


if __name__ == "__main__":
    owsdtest.main()
