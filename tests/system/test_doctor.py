#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl doctor and enable beside real programs: faults on purpose, and what is run to mend them."""

import json
import os
import re
import stat
import subprocess

import owsdtest
import recorded
from owsdtest import raw

BUSES = "i2c speed 100 combine one-read\nchip DS2482-100 0x18\n"
CHIPS = ("DS18B20 28.A10000000000 as living temperature 21\n"
         "DS18S20 10.0000000000C1 as cellar temperature 12.5\n"
         "DS2408 29.000000000001 as relays\n")
LIVING = dict(Name="living", Path="/28.A10000000000/temperature", Type=raw("double"), IO=raw("input"))
CELLAR = dict(Name="cellar", Path="/10.0000000000C1/temperature", Type=raw("double"), IO=raw("input"))

os.environ["OWSD_BOARDS"] = str(owsdtest.SOURCE / "board" / "boards")


def house(scene, what, *items):
    """A simulated house to which this happens from the start on."""
    plant = scene.file("plant.sim", BUSES + CHIPS + what)
    return scene.owsd(owsdtest.rio(f"sim:{plant}", list(items) or [LIVING, CELLAR], Period=0.05,
                                   MaxRetries=0))


def first_lines(scene, daemon, wanted):
    """What it says first, as soon as that begins so."""
    said = ""

    def look():
        nonlocal said
        said = scene.owsctl(daemon, "doctor").stdout
        return said.startswith("1. " + wanted)
    try:
        scene.until(look, 40, wanted)
    except AssertionError as err:
        raise AssertionError(f"{wanted}: {said}") from err
    return said


def well(scene, daemon):
    """What it says as soon as nothing is to be done: on a busy machine a heart may stand still."""
    said = ""

    def look():
        nonlocal said
        done = scene.owsctl(daemon, "doctor")
        said = done.stdout
        return done.returncode == 0
    scene.until(look, 40, lambda: said)
    return said


def test_a_house_that_is_well_has_nothing_to_do(scene):
    daemon = house(scene, "")
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 30, "the temperature arrives")
    said = well(scene, daemon)
    assert said.startswith("nothing is to be done\n"), said
    assert f"instance {daemon.name}: process" in said and "2 signals, 0 not good" in said


def test_the_first_line_is_the_remedy_of_what_is_wrong_on_the_wire(scene):
    for what, wanted, text in (
            ("at 0s unplug living for 10h", "does owsctl scan list the id?", "living: device absent"),
            ("at 0s corrupt cellar for 10h", "look for a bad contact", "cellar: device error: wrong"),
            ("at 0s short 0x18 for 10h", "data is held at ground: unplug branches", ": wire short")):
        daemon = house(scene, what)
        said = first_lines(scene, daemon, wanted)
        assert text in said, said
        daemon.stop()


def test_a_sensor_without_supply_and_a_dead_bridge_are_the_first_line(scene):
    daemon = house(scene, "at 0s set living temperature 127.937", LIVING)
    first_lines(scene, daemon, "look at its supply line")
    daemon.stop()
    plant = scene.file("plant.sim", BUSES + CHIPS.split("DS2408")[0] + "chip DS2482-100 0x19\n"
                       "DS2408 29.000000000001 as relays\nat 5s refuse 0x19 for 10h\n")
    relay = dict(Name="relay", Path="/29.000000000001/sensed.0", Type=raw("bool"), IO=raw("input"))
    daemon = scene.owsd(owsdtest.rio(f"sim:{plant}", [LIVING, relay], Period=0.05, MaxRetries=0))
    said = first_lines(scene, daemon, "look at its supply, SDA, SCL")
    assert "relay: target down: not found, and a bridge chip of the target does not answer" in said


def test_a_broker_that_is_away_is_the_first_line(scene):
    program = owsdtest.BUILD / "owsd-mqtt"
    owsdtest.need(program)
    plant, port = scene.file("plant.sim", BUSES + CHIPS), owsdtest.free_port()
    block = f'  Mqtt {{ Broker "mqtt://127.0.0.1:{port}" }}\n'
    daemon = scene.owsd(owsdtest.rio(f"sim:{plant}", [LIVING]).replace("  Item", block + "  Item", 1))
    scene.start([program, "-n", daemon.name, "-c", daemon.config])
    said = first_lines(scene, daemon, "")
    scene.until(lambda: "does a broker run there?" in scene.owsctl(daemon, "doctor").stdout.split("\n")[0],
                40, said)


def test_a_path_that_is_wrong_is_the_first_line(scene):
    typo = dict(LIVING, Name="typo", Path="/28.A10000000000/temprature")
    kind = dict(LIVING, Name="kind", Path="/28.A10000000000/type")
    fixed = dict(LIVING, Name="fixed", IO=raw("output"), InitValue=1)
    for item, wanted in ((typo, "check its spelling"), (kind, "choose another Type"),
                         (fixed, "IO input reads it")):
        daemon = house(scene, "", item)
        first_lines(scene, daemon, wanted)
        daemon.stop()


def test_an_owserver_that_is_away_is_the_first_line(scene):
    port = owsdtest.free_port()
    daemon = scene.owsd(owsdtest.rio(f"localhost:{port}", [LIVING]))
    said = first_lines(scene, daemon, f"owsd says: 127.0.0.1:{port}: Connection refused; does an owserver run")
    assert f"target localhost:{port} is down" in said
    found = json.loads(scene.owsctl(daemon, "--json", "doctor").stdout)
    assert found[0]["kind"] == "todo" and found[0]["check"] == "targets" and not found[0]["safe"]


def test_a_refused_reload_is_the_first_line_until_it_is_taken(scene):
    daemon = house(scene, "")
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 30, "the temperature arrives")
    good = daemon.config.read_text()
    daemon.config.write_text(good.replace("double", "doubel"))
    assert scene.owsctl(daemon, "reload").returncode == 1
    said = first_lines(scene, daemon, "correct line ")
    assert "doubel" in said
    daemon.config.write_text(good)
    said = first_lines(scene, daemon, f"sudo owsctl -n {daemon.name} reload")
    assert "a reload was refused" in said
    daemon.config.write_text(good.replace("  Item", f'  Listen "{owsdtest.free_port()}"\n  Item', 1))
    assert scene.owsctl(daemon, "reload").returncode == 1
    first_lines(scene, daemon, f"sudo systemctl restart owsd@{daemon.name}")
    daemon.config.write_text(good.replace("living", "restart"))  # a name is no advice
    daemon.config.write_text(daemon.config.read_text().replace("double", "doubel", 1))
    assert scene.owsctl(daemon, "reload").returncode == 1
    daemon.config.write_text(good)
    first_lines(scene, daemon, f"sudo owsctl -n {daemon.name} reload")
    assert scene.owsctl(daemon, "reload").returncode == 0
    well(scene, daemon)


def test_an_owsd_that_has_ended_is_the_first_line(scene):
    daemon = house(scene, "")
    daemon.stop()
    assert f"owsd {daemon.name} does not run" in scene.owsctl(daemon, "doctor").stdout


def test_a_history_that_cannot_be_written_is_the_first_line(scene):
    daemon = house(scene, "")
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 30, "the temperature arrives")
    (scene.path / "past" / "history.sqlite").mkdir(parents=True)
    recorded.record(scene, daemon, wait=False, directory=scene.path / "past")
    said = first_lines(scene, daemon, f"owsd-recorder says: {scene.path}/past cannot be written: ")
    assert "history.sqlite is in the way: move it away" in said and "   owsd-recorder: " in said


def test_a_database_that_is_away_is_the_first_line(scene):
    plant = scene.file("plant.sim", BUSES + CHIPS)
    block = f'  Influx {{ Url "http://127.0.0.1:{owsdtest.free_port()}/write" ClockWait 0.1 }}\n'
    daemon = scene.owsd(owsdtest.rio(f"sim:{plant}", [LIVING]).replace("  Item", block + "  Item", 1))
    scene.start([owsdtest.BUILD / "owsd-influx", "-n", daemon.name, "-c", daemon.config])
    first_lines(scene, daemon, "owsd-influx says: the server is lost: look at Url")


def stand_ins(scene, *programs, says=""):
    """Programs of the system that only write down what they are asked, and say something."""
    folder = scene.path / "bin"
    folder.mkdir(exist_ok=True)
    for program in programs:
        file = folder / program
        file.write_text(f'#!/bin/sh\necho {program} "$@" >>{scene.path}/asked\nprintf "{says}"\n')
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
    os.environ["PATH"] = f"{folder}:{os.environ['PATH']}"
    return scene.path / "asked"


def test_enable_shows_each_command_and_the_address_of_the_page(scene):
    asked = stand_ins(scene, "systemctl", "usermod")
    plant = scene.file("plant.sim", BUSES + CHIPS)
    name = scene.name()
    text = owsdtest.rio(f"sim:{plant}", [LIVING])
    web = '  Web { Listen "127.0.0.1:8099" Write on Configure on }\n'
    daemon = scene.owsd(text.replace("  Item", web + "  Item", 1), name=name)
    done = scene.owsctl(daemon, "enable", "--dry-run", "web")
    assert done.returncode == 0, done
    assert done.stdout.splitlines() == [
        "+ usermod -aG owsd-control owsd-web",
        "+ usermod -aG owsd-config owsd-web",
        f"+ systemctl enable --now owsd-writer@{name}.socket",
        f"+ systemctl enable --now owsd-web@{name}.socket",
        f"+ systemctl enable owsd-web@{name}.service",
        f"+ systemctl restart owsd-web@{name}.service",
        f"page: http://127.0.0.1:8099/ /run/owsd/{name}.web"], done.stdout
    done = scene.owsctl(daemon, "enable", "--dry-run", "history")
    assert done.stdout.splitlines()[:2] == [f"+ systemctl enable owsd-recorder@{name}.service",
                                            f"+ systemctl restart owsd-recorder@{name}.service"]
    mqtt = '  Mqtt { Broker "mqtt://127.0.0.1:1" Rename on }\n'
    other = scene.owsd(text.replace("  Item", mqtt + "  Item", 1), name=scene.name())
    done = scene.owsctl(other, "enable", "--dry-run", "mqtt")
    assert done.stdout.splitlines()[:2] == ["+ usermod -aG owsd-config owsd-mqtt",
                                            f"+ systemctl enable --now owsd-writer@{other.name}.socket"], done.stdout
    done = scene.owsctl(daemon, "disable", "--dry-run", "web")
    assert done.stdout == (f"+ systemctl disable --now owsd-web@{name}.service "
                           f"owsd-web@{name}.socket\n"), done.stdout
    assert not asked.exists()
    if os.geteuid() != 0:
        return  # what follows is for root, and refused
    assert scene.owsctl(daemon, "enable", "mqtt").returncode in (0, 1)  # installed here, or not
    asked = asked.read_text() if asked.exists() else ""
    assert asked in ("", f"systemctl enable owsd-mqtt@{name}.service\n"
                         f"systemctl restart owsd-mqtt@{name}.service\n"), asked


def with_etc(daemon, etc, verb, program):
    """What owsctl would run on a machine with that /etc."""
    done = subprocess.run(["unshare", "-m", "sh", "-c", 'mount --bind "$0" /etc && exec "$@"', etc, owsdtest.OWSCTL,
                           "-n", daemon.name, verb, "--dry-run", program],
                          capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
    assert done.returncode == 0, done
    return done.stdout


def test_a_group_that_no_file_asks_for_any_more_is_taken_back(scene):
    if os.geteuid() != 0:
        owsdtest.skip("only root may have another /etc")
    plant = scene.file("plant.sim", BUSES + CHIPS)
    text = owsdtest.rio(f"sim:{plant}", [LIVING])

    def keys(words):
        return text.replace("  Item", f"  Web {{ {words} }}\n  Item", 1)
    daemon = scene.owsd(keys("Configure on"), name=scene.name())
    etc = scene.path / "etc"
    (etc / "owsd").mkdir(parents=True)
    (etc / "group").write_text("owsd-control:x:990:anna,owsd-web\nowsd-config:x:991:owsd-web\nowsd-mqtt:x:992:\n")

    def taken(verb, program):
        return re.findall(r"\+ gpasswd -d owsd-(?:web|writer) owsd-(.*)", with_etc(daemon, etc, verb, program))
    assert taken("enable", "web") == ["control"]
    assert taken("disable", "web") == ["control", "config"]
    assert not taken("enable", "mqtt")
    assert not taken("disable", "writer")  # which has its group from the package
    # an instance beside it has the same users; of a file with errors nobody knows what it asks for
    other = etc / "owsd/other.rio"
    other.write_text(keys("Write on"))
    assert taken("disable", "web") == ["config"]
    other.write_text(keys("Write off"))
    assert taken("disable", "web") == ["control", "config"]
    other.write_text("OwsDrv {")
    assert not taken("disable", "web")


def test_the_writer_goes_with_the_last_program_that_asks_it(scene):
    if os.geteuid() != 0:
        owsdtest.skip("only root may have another /etc")
    plant = scene.file("plant.sim", BUSES + CHIPS)
    blocks = '  Web { Configure on }\n  Mqtt { Broker "mqtt://127.0.0.1:1" Rename on }\n'
    daemon = scene.owsd(owsdtest.rio(f"sim:{plant}", [LIVING]).replace("  Item", blocks + "  Item", 1), name=scene.name())
    etc = scene.path / "etc"
    wants = etc / "systemd/system/any.target.wants"
    wants.mkdir(parents=True)
    units = {word: wants / f"owsd-{word}@{daemon.name}.{kind}"
             for word, kind in (("writer", "socket"), ("web", "socket"), ("mqtt", "service"))}
    for unit in units.values():
        unit.touch()

    def goes(verb, program, *members):
        (etc / "group").write_text(f"owsd-config:x:991:{','.join(('owsd', 'owsd-writer', 'owsd-web', *members))}\n")
        return f"+ systemctl disable --now {units['writer'].name}\n" in with_etc(daemon, etc, verb, program)
    assert not goes("disable", "web"), "owsd-mqtt asks it"
    assert not goes("disable", "mqtt"), "owsd-web asks it"
    units["mqtt"].unlink()
    assert goes("disable", "web")
    assert not goes("disable", "web", "anna"), "anna may ask it"
    assert not goes("disable", "modbus"), "which cannot ask it"
    assert not goes("enable", "web")
    # the keys that ask it are off by now
    daemon.config.write_text(daemon.config.read_text().replace(" on }", " off }"))
    assert goes("enable", "web")
    units["writer"].unlink()
    assert not goes("disable", "web"), "it is disabled already"


def test_what_is_safe_is_run_by_fix_and_shown(scene):
    if os.geteuid() != 0:
        owsdtest.skip("only root may have it mended")
    stand_ins(scene, "timedatectl", says="Timezone=UTC\\nCanNTP=yes\\nNTP=no\\nNTPSynchronized=no\\n")
    asked = stand_ins(scene, "systemd-tmpfiles")
    daemon = house(scene, "")
    stand_ins(scene, "systemctl", says=f"owsd@{daemon.name}.service loaded active running\\n")
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 30, "the temperature arrives")
    # of a machine that has lost /run/owsd; the signals of this one are elsewhere
    lost = 'mount -t tmpfs tmpfs /run && exec "$@"'
    done = subprocess.run(["unshare", "-m", "sh", "-c", lost, "sh", owsdtest.OWSCTL, "-n", daemon.name, "doctor", "--fix"],
                          capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
    assert done.stdout.splitlines()[0] == "+ systemd-tmpfiles --create", done
    # what somebody may have decided is left
    assert "    sudo timedatectl set-ntp true" in done.stdout, done
    asked = [line for line in asked.read_text().splitlines() if not line.startswith("systemctl list-units")]
    assert asked == ["timedatectl show", "systemd-tmpfiles --create", "timedatectl show"], asked


def test_what_is_for_root_names_the_instance(scene):
    daemon = house(scene, "")
    # nobody is root in a user namespace without a map
    prefix = [] if os.geteuid() else ["unshare", "-U"]
    for words in (("enable", "mqtt"), ("disable", "web"), ("doctor", "--fix")):
        done = scene._run([*prefix, owsdtest.OWSCTL, "-n", daemon.name, *words], owsdtest.PATIENCE)
        assert done.returncode == 1 and f"sudo owsctl -n {daemon.name} {' '.join(words)}" in done.stderr, done


def df_says(scene, at):
    stand_ins(scene, "df", says="Filesystem 1024-blocks Used Available Capacity Mounted on\\n"
                                f"/dev/sda1 100000 99900 100 100%% {at}\\n")


def test_a_full_disk_is_the_first_line(scene):
    df_says(scene, "/var")
    daemon = house(scene, "at 0s short 0x18 for 10h")
    first_lines(scene, daemon, "make room on /var: ")


def test_a_disk_that_cannot_be_written_is_not_full(scene):
    if os.geteuid() != 0:
        owsdtest.skip("only root may mount")
    disk = scene.path / "disk"
    disk.mkdir()
    df_says(scene, disk)
    daemon = house(scene, "")
    scene.until(lambda: scene.get(daemon, "cellar") == "12.5", 30, "the temperature arrives")
    for mode in ("ro", "rw"):
        done = subprocess.run(["unshare", "-m", "sh", "-c", f'mount -t tmpfs -o {mode} tmpfs {disk} && exec "$@"',
                               "sh", owsdtest.OWSCTL, "-n", daemon.name, "doctor"],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
        assert (f"make room on {disk}" in done.stdout) == (mode == "rw"), done


def test_a_page_without_an_address_says_how_to_give_it_one(scene):
    daemon = house(scene, "")
    said = scene.owsctl(daemon, "enable", "--dry-run", "web").stdout
    assert f"+ systemctl try-restart owsd-web@{daemon.name}.service" in said
    assert f"page: /run/owsd/{daemon.name}.web" in said and 'Listen "127.0.0.1:8080"' in said
    assert f"and again: sudo owsctl -n {daemon.name} enable web" in said, said


def test_a_block_is_asked_for_of_a_program_that_can_have_one(scene):
    daemon = house(scene, "")
    for program, told in (("mqtt", True), ("writer", False)):
        done = scene.owsctl(daemon, "enable", "--dry-run", program)
        assert done.returncode == 0 and ("has no block for" in done.stdout) == told, done


def test_a_program_without_signals_is_told_where_they_come_from(scene):
    plant = scene.file("plant.sim", BUSES + CHIPS)
    for items, told in (([], True), ([LIVING], False)):
        daemon = scene.owsd(owsdtest.rio(f"sim:{plant}", items))
        said = scene.owsctl(daemon, "enable", "--dry-run", "mqtt").stdout
        assert ("has no signals, so there is nothing to show: owsctl doctor" in said) is told, said


if __name__ == "__main__":
    owsdtest.main()
