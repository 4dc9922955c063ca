#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What board/fleet has for many machines: the role of Ansible is run by Ansible itself, on this
machine with an /etc of its own and a running owsd."""

import fcntl
import json
import os
import pathlib
import re
import shutil
import stat
import subprocess
import sys

import owsdtest
import private
from owsdtest import BUILD, SOURCE, until

FLEET = SOURCE / "board/fleet"
WANTED = SOURCE / "tests/system/ansible.txt"
SENSOR = "28.A0B1C2000001"
RIO = """OwsDrv {{
  TargetName              "sim:{wire}"
  # {{{{ inventory_hostname }}}}
  ItemCount               1
  Item {{ Name "{name}" Path "/{sensor}/temperature" Type double IO input }}
}}
"""


def ansible():
    """ansible-playbook: the machine's, else out of the user's cache or, once, from the package index."""
    found = shutil.which("ansible-playbook")
    if found:
        return found
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    place = base / "ansible"
    try:
        base.mkdir(parents=True, exist_ok=True)
    except OSError:
        owsdtest.skip("no ansible-playbook here, and no cache for one")
    with open(base / "ansible.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / WANTED.name).exists() or (place / WANTED.name).read_text() != WANTED.read_text():
            shutil.rmtree(place, ignore_errors=True)
            for command in ([sys.executable, "-m", "venv", place],
                            [place / "bin/python", "-m", "pip", "--quiet", "--disable-pip-version-check", "--retries", "1",
                             "--timeout", "30", "install", "-r", WANTED]):
                done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=400)
                if done.returncode:
                    shutil.rmtree(place, ignore_errors=True)
                    last = ((done.stderr or done.stdout).strip().splitlines() or ["?"])[-1]
                    owsdtest.skip(f"not cached and cannot be had: Ansible: {last}")
            shutil.copy(WANTED, place)
    return place / "bin/ansible-playbook"


class Machine:
    """This machine with an /etc of its own, which has what the packages put there."""

    def __init__(self, scene):
        self.scene, self.play = scene, ansible()
        if not shutil.which("systemctl"):
            owsdtest.skip("no systemctl here")
        etc = scene.path / "etc"
        subprocess.run(["cp", "-a", "/etc", etc], check=True)
        subprocess.run(["mount", "--bind", etc, "/etc"], check=True)
        shutil.rmtree("/etc/owsd", ignore_errors=True)
        pathlib.Path("/etc/owsd").mkdir()
        for unit in (SOURCE / "board/systemd").glob("owsd*.service"):
            pathlib.Path("/etc/systemd/system", unit.name).write_text(unit.read_text().replace("@SBINDIR@", "/usr/sbin").replace("@BINDIR@", "/usr/bin"))
        self.wire = scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {SENSOR} temperature 21.5\n")
        bin_dir = scene.path / "bin"
        bin_dir.mkdir()
        (bin_dir / "owsd").symlink_to(BUILD / "owsd-sim")  # the wire is simulated
        (bin_dir / "owsctl").symlink_to(BUILD / "owsctl")
        self.env = dict(os.environ, PATH=f"{bin_dir}:{os.environ['PATH']}", SYSTEMD_OFFLINE="1", HOME=str(scene.path),
                        LC_ALL="C.UTF-8", ANSIBLE_HOME=str(scene.path / "ansible"), ANSIBLE_PIPELINING="1", ANSIBLE_NOCOLOR="1", ANSIBLE_NOCOWS="1",
                        ANSIBLE_ROLES_PATH=str(FLEET / "ansible/roles"))
        self.name = scene.name()
        self.file = pathlib.Path(f"/etc/owsd/{self.name}.rio")
        shutil.copy(SOURCE / "board/debian/OWS.rio", self.file)
        self.file.write_text(self.file.read_text().replace('"auto"', f'"sim:{self.wire}"'))
        self.daemon = scene.owsd(self.file, name=self.name)

    def close(self):
        subprocess.run(["umount", "/etc"], check=True)

    def rio(self, name):
        path = self.scene.file("site.rio.j2", RIO.format(wire=self.wire, name=name, sensor=SENSOR))
        return str(path)

    def run(self, **variables):
        """Returns status, what it says, and how much it changed."""
        play = self.scene.file("play.yml", json.dumps([{
            "hosts": "pi7", "connection": "local", "gather_facts": False, "roles": ["owsd"],
            "vars": {"ansible_python_interpreter": sys.executable, "owsd_instance": self.name, "owsd_packages": [], **variables}}]))
        done = subprocess.run([self.play, "-i", "pi7,", play], env=self.env, capture_output=True, text=True, check=False,
                              cwd=self.scene.path, stdin=subprocess.DEVNULL, timeout=300)
        recap = re.search(r"^pi7 .* changed=(\d+) ", done.stdout, re.M)
        return done.returncode, done.stdout + done.stderr, int(recap[1]) if recap else None


def test_the_role_makes_a_machine_and_its_second_run_changes_nothing(scene):
    machine = Machine(scene)
    try:
        secret = {"face": "mqtt", "name": "mqtt-password", "content": "it's {secret}"}
        variables = dict(owsd_rio=machine.rio("room"), owsd_controllers=["stranger"], owsd_readers=["setter"],
                         owsd_credentials=[secret])
        status, text, changed = machine.run(**variables)
        assert status == 0 and changed, text
        # loaded, before the role ended
        assert "room" in scene.owsctl(machine.daemon, "list").stdout, text
        assert "# pi7" in machine.file.read_text() and stat.S_IMODE(machine.file.stat().st_mode) == 0o644
        kept = pathlib.Path("/etc/credstore/owsd-mqtt.mqtt-password")
        assert kept.read_text() == "it's {secret}\n" and stat.S_IMODE(kept.stat().st_mode) == 0o600
        assert stat.S_IMODE(kept.parent.stat().st_mode) == 0o700 and "it's" not in text
        drop_in = pathlib.Path(f"/etc/systemd/system/owsd-mqtt@{machine.name}.service.d/credentials.conf").read_text()
        assert drop_in.count("LoadCredential=") == 1 and f"LoadCredential=mqtt-password:{kept}\n" in drop_in, drop_in
        groups = {line.split(":")[0]: line.rstrip().split(":")[3].split(",")
                  for line in pathlib.Path("/etc/group").read_text().splitlines()}
        assert "stranger" in groups["owsd"] and "stranger" in groups["owsd-control"], groups
        assert "setter" in groups["owsd"], groups
        for unit, wants in (("owsd", "owsd"), ("owsd-mqtt", "owsd-mqtt"), ("owsd-recorder", "owsd-recorder")):
            assert os.path.lexists(f"/etc/systemd/system/{wants}.service.wants/{unit}@{machine.name}.service"), unit
        # the same once more, and then a little different
        before = machine.file.stat().st_mtime_ns, machine.file.stat().st_ino
        status, text, changed = machine.run(**variables)
        assert (status, changed) == (0, 0), text
        assert (machine.file.stat().st_mtime_ns, machine.file.stat().st_ino) == before
        status, text, changed = machine.run(**{**variables, "owsd_rio": machine.rio("kitchen")})
        assert status == 0 and changed, text
        until(lambda: scene.get(machine.daemon, "kitchen") == "21.5", 20, "the kitchen is read")
    finally:
        machine.close()


def test_a_broken_configuration_replaces_nothing(scene):
    machine = Machine(scene)
    try:
        assert machine.run(owsd_rio=machine.rio("room"))[0] == 0
        good = machine.file.read_text()
        status, text, _ = machine.run(owsd_rio=machine.rio('a" LimitH "warm'))
        assert status != 0 and "failed to validate" in text and "expected a number" in text, text
        assert machine.file.read_text() == good
        assert "room" in scene.owsctl(machine.daemon, "list").stdout
        assert not [f for f in os.listdir("/etc/owsd") if f != machine.file.name]
    finally:
        machine.close()


def test_a_reload_that_was_refused_fails_in_each_run_until_it_is_taken(scene):
    machine = Machine(scene)
    try:
        variables = dict(owsd_rio=machine.rio("room"))
        assert machine.run(**variables)[0] == 0
        template = pathlib.Path(variables["owsd_rio"])
        # a file without an error, which takes a restart
        template.write_text(template.read_text().replace("  ItemCount", f'  Listen "{owsdtest.free_port()}"\n  ItemCount'))
        for _ in range(2):
            status, text, _ = machine.run(**variables)
            assert status != 0 and "Listen" in text, text
        machine.daemon.stop()
        machine.daemon = scene.owsd(machine.file, name=machine.name)
        status, text, changed = machine.run(**variables)
        assert (status, changed) == (0, 0), text
    finally:
        machine.close()


def test_a_program_that_goes_on_as_before_fails_a_run_and_is_asked_again_in_the_next(scene):
    owsdtest.need(BUILD / "owsd-recorder")
    machine = Machine(scene)
    try:
        variables = dict(owsd_rio=machine.rio("room"))
        assert machine.run(**variables)[0] == 0
        file = scene.file("other.rio", machine.file.read_text())
        recorder = scene.start([BUILD / "owsd-recorder", "-n", machine.daemon.name, "-c", file, "-d", scene.path / "history"])
        until(lambda: "recording" in recorder.log(), 20, recorder.log)
        file.write_text("OwsDrv { Period wrong }\n")
        assert f"{file}:1:17" in scene.owsctl(machine.daemon, "reload").stdout
        status, text, _ = machine.run(**variables)
        assert status != 0 and f"{file}:1:17" in text, text
        # the file on the machine stays as it is: it is the program that was not asked
        file.write_text(machine.file.read_text())
        status, text, changed = machine.run(**variables)
        assert status == 0 and changed, text
        status, text, changed = machine.run(**variables)
        assert (status, changed) == (0, 0), text
    finally:
        machine.close()


def test_a_program_whose_user_has_another_group_is_started_again(scene):
    machine = Machine(scene)
    try:
        with open("/etc/passwd", "a", encoding="ascii") as users:
            users.write("owsd-mqtt:x:64990:64990::/:/bin/false\n")
        variables = dict(owsd_controllers=["owsd-mqtt", "stranger"])
        for again in (True, False):
            status, text, _ = machine.run(**variables)
            _, found, rest = text.partition("HANDLER [owsd : Restart the programs whose users have other groups]")
            assert status == 0 and bool(found) == again, text
            assert not again or rest.count("(item=owsd-") == rest.count("(item=owsd-mqtt)") == 1, text
    finally:
        machine.close()


def test_the_role_names_packages_and_units_that_there_are(_scene):
    packages = set(re.findall(r"^Package: (\S+)$", (SOURCE / "board/debian/control").read_text(), re.M))
    defaults = (FLEET / "ansible/roles/owsd/defaults/main.yml").read_text()
    faces = re.search(r"^owsd_faces: \[(.*)\]$", defaults, re.M)[1].split(", ")
    assert faces and {f"owsd-{face}" for face in [*faces, "influx", "web"]} <= packages, (faces, packages)
    for face in [*faces, "influx"]:
        assert (SOURCE / f"board/systemd/owsd-{face}@.service").exists(), face
        assert "ExecReload=" in (SOURCE / f"board/systemd/owsd-{face}@.service").read_text(), face
    assert (SOURCE / "board/systemd/owsd-web@.socket").exists()


def test_the_example_of_the_role_is_a_configuration(scene):
    text = (FLEET / "ansible/roles/owsd/templates/OWS.rio.j2").read_text()
    done = scene.owsd_once("--check", "-c", scene.file("OWS.rio", text))
    assert done.returncode == 0 and not owsdtest.but_of_here(done.stderr), done


if __name__ == "__main__":
    private.main(users=True)
