#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Consumers beside owsd: it is killed, stopped and restarted under them, and they misbehave."""

import concurrent.futures
import mmap
import os
import random
import shutil
import signal
import sys
import time

import byhand
import faulty
import owsdtest

import ows  # of owsdtest.PYTHON


def start(scene):
    """owsd on an owserver whose devices keep what is written to them; its configuration too."""
    server = scene.owserver(mock=["28.000000000001"])
    sensor = server.devices()[0]
    server.write(sensor + "/temperature", "21")
    config = owsdtest.rio(server.target, [
        dict(Name="room", Path=sensor + "/temperature", Type="double", IO="input"),
        dict(Name="relays", Path=sensor + "/templow", Type="byte", IO="output"),
        # no byte: past its cache a mock answers any number, and what has no good value is asked so again
        dict(Name="back", Path=sensor + "/templow", Type="double", IO="input"),
    ], Period=0.02)
    daemon = scene.owsd(config)
    daemon.restore = lambda: server.write(sensor + "/temperature", "21")
    return daemon, config


def good(signals, name):
    value = signals.get(name)
    return value if value.good else None


def reopened(signals):
    try:
        signals.reopen()
        return True
    except OSError:
        return False


def opened(scene, name, **how):
    """An open handle, where somebody has just taken a segment away."""
    def look():
        try:
            return ows.Ows(name, **how)
        except FileNotFoundError:  # it is just being replaced
            return None
    return scene.until(look, 10, "the segments are there")


def test_a_reader_of_a_killed_owsd_sees_whole_samples_that_age_and_the_next_owsd(scene):
    daemon, config = start(scene)
    with ows.Ows(daemon.name) as signals:
        scene.until(lambda: good(signals, "room"), 10, "room is good")
        name, first = daemon.name, signals.get("room")
        for _ in range(10):
            deadline = time.monotonic() + random.uniform(0.01, 0.06)
            while time.monotonic() < deadline:
                assert signals.get("room").value == 21
            daemon.kill()
            dead = signals.get("room")  # raises if no whole sample is there
            assert dead.value == 21 and not signals.stale()
            assert signals.get("room").age > dead.age
            daemon = scene.owsd(config, name=name)
            assert signals.stale()
            assert not signals.get("room", now=ows.now_ns() + 5 * 10**9).good
            scene.until(lambda: reopened(signals), 10, "the new image is there")
            scene.until(lambda: good(signals, "room"), 10, "room is good again")
        daemon.kill()
        scene.until(lambda: signals.get("room").quality == ows.Q_NO_OWSD, 10, "owsd seems dead")
        assert signals.get("room").value == first.value
        assert signals.get("_TRANSACTIONS").quality == ows.Q_NO_OWSD


def test_after_an_orderly_end_sets_are_refused_until_the_next_start(scene):
    daemon, config = start(scene)
    with ows.Ows(daemon.name, control=True) as signals:
        signals.set("relays", 5)
        scene.until(lambda: good(signals, "back") and signals.get("back").value == 5, 10, "is 5")
        assert daemon.stop() == 0
        assert signals.stale() and not signals.get("room").good
        for late in (lambda: signals.set("relays", 6), lambda: signals.beat(1000),
                     lambda: signals.acknowledge("room")):
            try:
                late()
                raise AssertionError("a stopped owsd's segment took it")
            except ows.Stale:
                pass
        assert not reopened(signals)
        scene.owsd(config, name=daemon.name)
        scene.until(lambda: reopened(signals), 10, "the new image is there")
        signals.set("relays", 6)
        scene.until(lambda: signals.get("back").value == 6, 10, "is 6")


def test_after_an_orderly_end_all_can_be_looked_at_and_nothing_set(scene):
    daemon, _ = start(scene)
    value = scene.until(lambda: scene.get(daemon, "room"), 10, "room is good")
    assert daemon.stop() == 0
    got = scene.owsctl(daemon, "get", "room")
    assert (got.returncode, got.stdout) == (3, value + "\n"), got
    listed = scene.owsctl(daemon, "list")
    assert "room" in listed.stdout and "owsd not running" in listed.stdout, listed
    assert "was stopped" in listed.stderr, listed
    stats = scene.owsctl(daemon, "stats")
    assert "stopped" in stats.stdout, stats
    done = scene.owsctl(daemon, "set", "relays", "7")
    assert done.returncode == 1 and "owsd is not running" in done.stderr, done
    with ows.Ows(daemon.name) as signals:  # opened after the end
        assert signals.get("room").quality == ows.Q_NO_OWSD and signals.stale()


def test_a_removed_image_is_told(scene):
    daemon, _ = start(scene)
    with ows.Ows(daemon.name) as signals:
        os.unlink(owsdtest.segment(daemon.name, "image"))
        scene.until(lambda: "restart owsd" in daemon.log(), 10, "it says what to do")
        owsdtest.logged(daemon, f"{owsdtest.segment(daemon.name, 'image')} was removed")
        owsdtest.worked(signals, 1.5)
    assert daemon.log().count("was removed") == 1
    assert daemon.stop() == 0


def lose_image(name, how):
    image = str(owsdtest.segment(name, "image"))
    if how == "removed":
        os.unlink(image)
    elif how == "renamed":
        os.rename(image, image + ".away")
    else:
        shutil.copy(image, image + ".copy")
        os.rename(image + ".copy", image)


def test_readers_of_an_image_that_lost_its_name_follow_a_reload(scene):
    for how in ("removed", "renamed", "replaced"):
        daemon, _ = start(scene)
        with ows.Ows(daemon.name) as signals:
            scene.until(lambda: good(signals, "room"), 10, "room is good")
            lose_image(daemon.name, how)
            scene.until(lambda: "reload or restart owsd" in daemon.log(), 10, "it says what to do")
            scene.until(lambda: good(signals, "room"), 10, how)
            assert not signals.stale(), how
            daemon.signal(signal.SIGHUP)
            scene.until(signals.stale, 10, "the one without a name is retired")
            scene.until(lambda: reopened(signals), 10, "there is another")
            scene.until(lambda: good(signals, "room"), 10, "room is good")
        assert daemon.stop() == 0


def test_consumers_of_a_removed_image_follow_the_owsd_after_a_kill(scene):
    """Nobody can say anything in the old image: not the dead owsd, and the next cannot find it."""
    daemon, config = start(scene)
    name = daemon.name
    control = scene.start([owsdtest.BUILD / "examples/control", "room", "relays", "30", "0", name])
    reader = scene.start([owsdtest.BUILD / "examples/reader", name, "600"])
    watch = scene.start([owsdtest.OWSCTL, "-n", name, "watch", "-l", "room"])
    for program in (reader, watch):
        scene.until(lambda: "room" in program.log(), 10, "it has opened the image")
    with ows.Ows(name) as signals, concurrent.futures.ThreadPoolExecutor() as pool:
        for how in ("removed", "replaced"):
            scene.until(lambda: good(signals, "back") and signals.get("back").value == 1, 10,
                        "the controller heats")
            sleeper = pool.submit(sleep_until_stale, ows.Ows(name))
            seen = watch.log().count("was started again")
            lose_image(name, how)
            daemon.kill()
            daemon = scene.owsd(config, name=name)
            scene.until(signals.stale, 10, "the orphan is found out")
            assert not signals.get("room").good
            scene.until(lambda: reopened(signals), 10, "there is another")
            assert sleeper.result(), "it woke by itself"
            scene.until(lambda: good(signals, "room"), 10, "room is good")
            scene.until(lambda: watch.log().count("was started again") > seen, 10, "owsctl is led on")
            lines = reader.log().count("\n")
            scene.until(lambda: [g for g in signals.controllers() if g.who.name == "control" and
                                 g.commands > 3], 10, "the controller's sets arrive")
            scene.until(lambda: [line for line in reader.log()[lines:].splitlines()
                                 if line.startswith("room") and " good," in line], 10,
                        "the reader is led on")
    assert control.running() and reader.running() and watch.running()


def sleep_until_stale(signals):
    with signals:
        news, until = 0, time.monotonic() + owsdtest.PATIENCE
        try:
            while time.monotonic() < until:
                news = signals.wait(news, 5)
        except ows.Stale:
            return True
    return False


def lock_file(name):
    return owsdtest.segment(name, "lock")


def test_a_removed_lock_is_taken_again_and_keeps_others_out(scene):
    daemon, config = start(scene)
    os.unlink(lock_file(daemon.name))
    scene.until(lambda: "lock was removed: made again" in daemon.log(), 10, "it is said")
    other = scene.owsd(config, name=daemon.name, ready=False)
    assert other.wait() == 1
    assert f"already served by process {daemon.pid}" in other.log()
    assert daemon.stop() == 0


def test_of_two_owsd_of_one_instance_the_one_whose_lock_was_removed_ends(scene):
    first, config = start(scene)
    scene.until(lambda: scene.get(first, "room") == "21", 10, "is 21")
    first.freeze()
    os.unlink(lock_file(first.name))
    second = scene.owsd(config, name=first.name)
    owsdtest.logged(second, f"taken over from owsd {first.pid}, which had not stopped; there is "
                            "still a process of that number")
    first.thaw()
    assert first.wait() == 1
    owsdtest.logged(first, f"process {second.pid} serves the instance now")
    assert os.path.exists(owsdtest.segment(second.name, "sock")), "the second one still serves there"
    scene.until(lambda: scene.get(second, "room") == "21", 10, "the other goes on")
    # thawed, the first one may have put its own image there before it saw the lock
    with opened(scene, second.name, control=True) as signals:
        owsdtest.worked(signals, 2.5)
        signals.set("relays", 9)
        scene.until(lambda: signals.get("back").value == 9, 10, "and takes commands")
        assert not signals.stale()
    assert second.stop() == 0


def test_a_killed_owsds_memory_takes_no_sets_when_the_next_one_is_there(scene):
    daemon, config = start(scene)
    with ows.Ows(daemon.name, control=True) as signals:
        signals.set("relays", 9)
        daemon.kill()
        scene.owsd(config, name=daemon.name)
        try:
            signals.set("relays", 1)
            raise AssertionError("the old memory took a set")
        except ows.Stale:
            pass


def test_a_controller_cannot_truncate_its_memory_and_a_hole_in_it_harms_itself_alone(scene):
    daemon, _ = start(scene)
    other = scene.start([owsdtest.BUILD / "examples/control", "room", "relays", "30", "0",
                         daemon.name])
    with ows.Ows(daemon.name) as signals, byhand.Controller(daemon.name) as controller:
        scene.until(lambda: signals.get("back").value == 1, 10, "the controller heats")
        for size in (0, 256, 1 << 20):
            try:
                os.ftruncate(controller.fd, size)
                raise AssertionError("its size changed")
            except PermissionError:
                pass
        controller.memory.madvise(mmap.MADV_REMOVE)
        controller.ring()
        with ows.Ows(daemon.name, control=True) as again:
            stamp = again.set("relays", 77)
            scene.until(lambda: again.get("relays").applied == stamp or
                        again.origin("relays").who.name == "control", 10, "owsd takes sets")
            scene.until(lambda: again.get("relays").value == 1, 10, "and the controller's after")
        scene.until(lambda: good(signals, "room"), 10, "room is good")
        assert daemon.running() and other.running()


def test_rubbish_in_the_memory_of_a_controller_harms_nothing(scene):
    seed = int(os.environ.get("SEED", time.time_ns() & 0xFFFFFF))
    print("seed", seed)
    rng = random.Random(seed)
    daemon, config = start(scene)
    with ows.Ows(daemon.name) as signals:
        scene.until(lambda: good(signals, "room"), 10, "room is good")
        with byhand.Controller(daemon.name) as controller:
            for _ in range(400):
                controller.scribble(rng)
                time.sleep(0.002)  # rubbish comes at this pace
            scene.until(signals.alive, 10, "its heart beats")

        def sane():
            try:
                with ows.Ows(daemon.name, control=True) as control:
                    # What rubbish may do is what its writer has the right to
                    for name in ("room", "back"):
                        control.set(name + "_RE", 1)
                    control.set("relays_WE", 1)
                    control.set("relays", 3)
                    return True
            except OSError:
                return False
        scene.until(sane, 10, "another controller's sets are taken")
        scene.until(lambda: signals.get("back").value == 3, 10, "is 3")
        daemon.restore()
        scene.until(lambda: good(signals, "room") and signals.get("room").value == 21, 20,
                    "room is read on")


def test_an_input_is_not_written_by_any_way(scene):
    """By libows, owsctl, the served protocol, a program that writes past libows, and a reload."""
    door = scene.path / "door"
    server = scene.owserver(mock=["28.000000000001"])
    sensor = server.devices()[0]
    server.write(sensor + "/templow", "21")

    def text(io, **keys):
        return owsdtest.rio(server.target, [
            dict(Name="low", Path=sensor + "/templow", Type="byte", IO=io, **keys)],
            Period=0.02, ListenSocket=str(door))
    config = scene.file("low.rio", text("input"))
    daemon = scene.owsd(config)

    def refused_by_all():
        for name in ("low", "low_WriteEnable", "low_WE", "low_WriteOneShot", "low_WOS"):
            done = scene.owsctl(daemon, "set", name, "1")
            assert done.returncode == 1 and "is an input" in done.stderr, done
            done = scene._run([owsdtest.OWSCTL, "-t", f"owserver:{door}", "write",
                               f"/signals/{name}", "1"], 20)
            assert done.returncode == 1, done
            with opened(scene, daemon.name, control=True) as control:
                try:
                    control.set(name, 1)
                    raise AssertionError(name)
                except PermissionError:
                    pass
        with opened(scene, daemon.name) as signals, byhand.Controller(daemon.name) as controller:
            refused = faulty.counters(scene, daemon)["refused_commands"]
            on, off = 2, 1
            controller.command(1, {byhand.WRITE_ENABLE: 4 + on, byhand.STAMP: 1, byhand.ONE_SHOT: 1}, 99)
            scene.until(lambda: faulty.counters(scene, daemon)["refused_commands"] > refused, 10)
            controller.command(1, {byhand.WRITE_ENABLE: 8 + off})
            then = signals.get("_TRANSACTIONS").value + 5
            scene.until(lambda: signals.get("_TRANSACTIONS").value > then, 10, "five more requests")
        assert server.read(sensor + "/templow").strip() == "21"

    scene.until(lambda: scene.get(daemon, "low") == "21", 10, "is 21")
    refused_by_all()
    config.write_text(text("output", Writable=owsdtest.raw("off")))
    assert scene.owsctl(daemon, "reload").returncode == 0  # the new image is shown when it returns
    assert scene.owsctl(daemon, "set", "low_WE", "1").returncode == 0
    scene.until(lambda: scene.get(daemon, "low_WE") == "1", 10)
    config.write_text(text("input"))
    assert scene.owsctl(daemon, "reload").returncode == 0
    refused_by_all()


def test_a_bell_rung_without_end_does_not_stop_the_inputs(scene):
    daemon, _ = start(scene)
    code = "import byhand, sys\ncontroller = byhand.Controller(sys.argv[1])\nwhile True: controller.ring()"
    scene.start([sys.executable, "-c", code, daemon.name],
                {"PYTHONPATH": str(owsdtest.SOURCE / "tests/system")})
    with ows.Ows(daemon.name) as signals:
        scene.until(lambda: good(signals, "room"), 10, "room is good")
        before = signals.get("room").count
        scene.until(lambda: signals.get("room").count > before + 5, 10, "room is read on")
        scene.until(signals.alive, 10, "its heart beats")


def test_the_reader_example_prints_every_signal(scene):
    daemon, config = start(scene)
    with ows.Ows(daemon.name) as signals:
        scene.until(lambda: good(signals, "room"), 10, "room is good")
    done = scene._run([owsdtest.BUILD / "examples/reader", daemon.name, "1"], 20)
    assert done.returncode == 0, done.stderr
    for name in ("room", "relays", "back"):
        assert name in done.stdout, done.stdout
    assert "21" in done.stdout and "good" in done.stdout


def test_the_image_and_what_a_restart_needs_stay_in_the_place(scene):
    daemon, config = start(scene)
    assert daemon.stop() == 0
    left = set(faulty.leftovers(daemon.name)) - {"lock"}
    assert left == {"image", "force"}, left


if __name__ == "__main__":
    owsdtest.main()
