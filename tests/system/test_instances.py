#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl instances, remove and stats: what runs, what has run, and taking away what it left."""

import contextlib
import json
import os
import re
import shutil
import socket
import subprocess
import tempfile

import owsdtest

TARGET = "null:"


@contextlib.contextmanager
def place_in(folder):
    """Another directory of owsd, for as long."""
    before = os.environ["OWS_DIR"]
    os.environ["OWS_DIR"] = f"{folder}/place"
    try:
        yield
    finally:
        os.environ["OWS_DIR"] = before


def start(scene, **options):
    return scene.owsd(owsdtest.rio(TARGET, [
        dict(Name="room", Path="/28.000000000001/temperature", Type="double")]), **options)


def instance(scene, name):
    """What instances says of this one, or None."""
    done = scene.owsctl(None, "--json", "instances")
    assert done.returncode == 0, done
    return next((i for i in json.loads(done.stdout) if i["instance"] == name), None)


def files(name):
    return [str(path) for path in owsdtest.place().glob(f"{name}.*")]


def beats(scene, daemon, state="running"):
    scene.until(lambda: (instance(scene, daemon.name) or {}).get("state") == state, 10, state)
    return instance(scene, daemon.name)


def test_instances_shows_what_runs_hangs_was_stopped_and_was_killed(scene):
    daemons = {state: start(scene) for state in ("running", "hangs", "stopped", "killed")}
    for daemon in daemons.values():
        beats(scene, daemon)
    daemons["hangs"].freeze()
    assert daemons["stopped"].stop() == 0
    daemons["killed"].kill()
    for state, daemon in daemons.items():
        row = beats(scene, daemon, state)
        assert row["pid"] == daemon.pid and row["signals"] == 1 and row["targets"] == TARGET, row
        assert re.match(r"\d{4}-\d\d-\d\dT", row["since"]) and row["error"] is None, row
        assert row["config"] == (str(daemon.config) if state in ("running", "hangs") else None), row
    table = scene.owsctl(None, "instances").stdout
    for state, daemon in daemons.items():
        assert re.search(rf"^{daemon.name} +{state} +{daemon.pid} ", table, re.M), table
    daemons["hangs"].thaw()
    beats(scene, daemons["hangs"])


def test_what_an_instance_left_is_removed(scene):
    for end in ("stop", "kill"):
        daemon = start(scene)
        getattr(daemon, end)()
        before = files(daemon.name)
        assert before, "it leaves something"
        done = scene.owsctl(None, "remove", daemon.name)
        assert (done.returncode, done.stderr) == (0, ""), done
        assert done.stdout == f"removed {daemon.name}: {len(before)} files\n", done
        assert files(daemon.name) == [] and instance(scene, daemon.name) is None
        assert scene.owsctl(daemon, "list").returncode == 1
        done = scene.owsctl(None, "--json", "remove", daemon.name)
        assert done.returncode == 1 and f"nothing is there of an owsd of the name {daemon.name}" in done.stderr
        assert json.loads(done.stdout) == [dict(instance=daemon.name, removed=False, files=0)]
        again = start(scene, name=daemon.name)
        again.stop()


def test_a_running_instance_is_not_removed(scene):
    daemon, hanging = start(scene), start(scene)
    hanging.freeze()
    beats(scene, hanging, "hangs")
    beats(scene, daemon)
    for which in (daemon, hanging):
        before = files(which.name)
        done = scene.owsctl(None, "remove", which.name)
        assert done.returncode == 1 and f"is running (process {which.pid})" in done.stderr, done
        assert files(which.name) == before and done.stdout == ""
    # also when somebody took its lock away
    for which in (daemon, hanging):
        os.unlink(owsdtest.segment(which.name, "lock"))
        before = files(which.name)
        done = scene.owsctl(None, "remove", which.name)
        assert done.returncode == 1 and f"is running (process {which.pid})" in done.stderr, done
        # one that runs may have made its lock again
        assert set(before) <= set(files(which.name)) and done.stdout == ""
    hanging.thaw()


def test_a_start_that_fails_leaves_what_was_there_and_no_more(scene):
    daemon = start(scene)
    daemon.stop()
    before = sorted(files(daemon.name))
    fresh = scene.name()
    with socket.create_server(("127.0.0.1", 0)) as taken:
        for name, there in ((fresh, []), (daemon.name, before)):
            done = scene.owsd_once("-n", name, "-c", daemon.config, "-l", str(taken.getsockname()[1]))
            assert done.returncode == 1 and "cannot listen" in done.stderr, done
            assert sorted(files(name)) == there


def test_one_that_cannot_be_removed_does_not_keep_the_others(scene):
    running, ended = start(scene), start(scene)
    ended.stop()
    done = scene.owsctl(None, "--json", "remove", running.name, "a/b", ended.name)
    assert done.returncode == 1 and "a/b cannot be the name of an instance" in done.stderr, done
    assert [i["removed"] for i in json.loads(done.stdout)] == [False, False, True], done
    assert not files(ended.name) and files(running.name)


def test_neighbours_whose_names_begin_alike_stay(scene):
    ended = start(scene)
    ended.stop()
    other = start(scene, name=ended.name + ".image")
    scene.names.append(other.name)
    before = files(other.name)
    for suffix in ("image.new", "force.new"):
        with open(owsdtest.segment(ended.name, suffix), "w", encoding="ascii"):
            pass
    assert scene.owsctl(None, "remove", ended.name).returncode == 0
    assert sorted(files(ended.name)) == sorted(before) and before


def test_what_belongs_to_another_is_not_removed(scene):
    if os.geteuid() != 0:
        owsdtest.skip("needs root to be another user")
    # the build, and what the tests have for their files, may lie in what is closed to others
    with tempfile.TemporaryDirectory(dir="/var/tmp") as folder, place_in(folder):
        os.chmod(folder, 0o755)
        daemon = start(scene)
        daemon.stop()
        owsctl = shutil.copy(owsdtest.OWSCTL, folder)
        # a sanitizer's options name a file of the source
        nobody = subprocess.run([owsctl, "remove", daemon.name], user=65534, group=65534,
                                extra_groups=[], capture_output=True, text=True, check=False,
                                timeout=owsdtest.PATIENCE, cwd=folder,
                                env={k: v for k, v in os.environ.items() if k != "TSAN_OPTIONS"})
        assert nobody.returncode == 1 and "no right to remove" in nobody.stderr, nobody
        assert files(daemon.name)
        # and root removes what a user left
        for file in files(daemon.name):
            os.chown(file, 65534, 65534)
        assert scene.owsctl(None, "remove", daemon.name).returncode == 0
        assert not files(daemon.name)


def test_a_place_that_cannot_be_entered_is_named(scene):
    with tempfile.TemporaryDirectory() as folder, place_in(folder):
        daemon = start(scene)
        owsdtest.place().chmod(0o777)
        why = f"others may write into {owsdtest.place()} (mode 0777)"
        for verb in (["list"], ["instances"], ["remove", daemon.name]):
            done = scene.owsctl(daemon, *verb)
            assert (done.returncode, done.stdout) == (1, "") and why in done.stderr, done
        owsdtest.place().chmod(0o755)
        beats(scene, daemon)


def test_stats_of_an_owsd_that_ended_are_told_to_be_its_last(scene):
    for end, word in (("kill", "dead"), ("stop", "stopped")):
        daemon = start(scene)
        beats(scene, daemon)
        assert ": up, " in scene.owsctl(daemon, "stats").stdout
        getattr(daemon, end)()
        scene.until(lambda: f", {word} since" in scene.owsctl(daemon, "stats").stdout, 10, word)
        done = scene.owsctl(daemon, "stats")
        assert re.search(rf"^owsd +pid {daemon.pid}, {word} since \d{{4}}-.*; all below is what it was "
                         "then$", done.stdout, re.M), done
        assert re.search(r"^target 0 +null:: was up, ", done.stdout, re.M), done
        assert f"owsd {daemon.name} " in done.stderr and "not running" in done.stderr or \
            "was stopped" in done.stderr, done
        told = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)
        assert told["targets"][0]["state"] == "unknown" and told["targets"][0]["last_state"] == "up"
        assert told["daemon"]["alive"] is False and told["daemon"]["last_heartbeat"], told


if __name__ == "__main__":
    owsdtest.main()
