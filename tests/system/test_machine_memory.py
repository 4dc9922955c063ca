#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Memory, threads and descriptors that cannot be had: owsd says so, or goes on; it never crashes."""

import concurrent.futures
import os
import resource
import signal

import faulty
import owsdtest
from owsdtest import open_files, settled, until

AT_ONCE = 3


def served(scene):
    return faulty.house(scene, more=True, ListenSocket=str(scene.path / "socket"),
                        HeartbeatLine="nochip/3")


def came_up(daemon):
    """True when it is ready, False when it ended before."""
    try:
        daemon.ready()
        return True
    except AssertionError as why:
        assert "ended with status" in str(why), why
        return False


def attempt(scene, config, what, environment):
    """One start under a fault; what became of it, after a look that it is one that may be."""
    daemon = scene.owsd(config, env=environment, ready=False)
    up = came_up(daemon)
    if up:
        until(lambda: scene.get(daemon, "room") == "21.5", 20, f"{what}: room is good")
        assert daemon.stop() == 0, f"{what}: {daemon.log()}"
    else:
        assert daemon.wait() in (1, 2), f"{what}: status {daemon.wait()}: {daemon.log()}"
        assert daemon.log().strip(), f"{what}: not a word"
        assert not [n for n in faulty.leftovers(daemon.name) if n.endswith(".new")], what
    return up, daemon.log()


def one_after_another(scene, kind):
    """Each in turn fails, until one is beyond the last; how many failed, and all that was said."""
    config = scene.file("house.rio", served(scene))

    def at(n):
        sub = owsdtest.Scene()
        with sub:
            environment = faulty.env(sub, **{kind: n})
            # they would all have the same socket
            own = sub.file("own.rio", config.read_text().replace(str(scene.path / "socket"),
                                                                 str(sub.path / "socket")))
            try:
                up, log = attempt(sub, own, f"{kind} {n}", environment)
            except AssertionError as why:
                wrong.append(str(why))
                up, log = True, ""
            return faulty.happened(sub), up, log
    ends, wrong, n = [], [], 0
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        while not ends or ends[-1][0]:
            ends += pool.map(at, range(n + 1, n + 1 + 4 * AT_ONCE))
            n += 4 * AT_ONCE
    assert not wrong, "\n".join(wrong)
    assert all(up for fired, up, _ in ends if not fired), "without a fault it does not start"
    return [end for end in ends if end[0]]


def test_each_thread_in_turn_that_cannot_be_made_at_start_is_refused_with_a_reason(scene):
    ends = one_after_another(scene, "thread")
    # the engine, the control socket and its news, two targets, the server, the lamps
    assert len(ends) == 7, ends
    for _, up, log in ends:
        assert not up and "Resource temporarily unavailable" in log, log
        assert "thread" in log or "serve" in log, log


def test_each_allocation_in_turn_that_fails_at_start_is_survived_or_said(scene):
    ends = one_after_another(scene, "memory")
    assert len(ends) > 50, len(ends)
    print(f"{len(ends)} allocations, {sum(up for _, up, _ in ends)} of them can be done without")


def test_memory_that_ends_at_any_moment_of_the_start_is_said(scene):
    """From some allocation on there is none at all: every seventh, so that it stays short."""
    wrong, refused = [], 0
    for n in range(1, 1000, 7):
        with owsdtest.Scene() as sub:
            environment = faulty.env(sub, memory=f"{n}+")
            try:
                up, _ = attempt(sub, served(sub), f"from {n} on", environment)
            except AssertionError as why:
                wrong.append(str(why))
                up = False
            refused += not up
            if not faulty.happened(sub):
                break
    assert not wrong, "\n".join(wrong)
    assert refused > 5, refused


def test_threads_that_a_reload_cannot_make_are_made_later(scene):
    block = scene.path / "block"
    config = scene.file("house.rio", faulty.house(scene))
    daemon = scene.owsd(config, env=faulty.env(scene, thread=block))
    until(lambda: scene.get(daemon, "room") == "21.5", 20)
    block.touch()
    config.write_text(faulty.house(scene, more=True, HeartbeatLine="nochip/3"))
    daemon.signal(signal.SIGHUP)
    until(lambda: "cannot start the thread of target" in daemon.log(), 10, "it is said")
    until(lambda: faulty.counters(scene, daemon)["unfinished_reload"] == 1, 10, "and counted")
    until(lambda: scene.get(daemon, "room") == "21.5", 10, "what was there goes on")
    assert scene.get(daemon, "hall") is None
    until(lambda: daemon.log().count("owsd tries again") >= 2, 10, "owsd tries again")
    assert faulty.happened(scene)
    block.unlink()
    until(lambda: scene.get(daemon, "hall") == "19.5", 20, "the rest follows by itself")
    until(lambda: faulty.counters(scene, daemon)["unfinished_reload"] == 0, 10)
    until(lambda: "HeartbeatLine" in daemon.log(), 10, "the lamps' thread runs")
    owsdtest.logged(daemon, "the rest of the reload is done")
    assert daemon.stop() == 0


def limit_descriptors(daemon, number):
    before = resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE)
    resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, (number, before[1]))
    return before


def test_a_start_with_too_few_descriptors_is_refused_with_a_reason(scene):
    refused = 0
    for number in range(3, 40):
        with owsdtest.Scene() as sub:
            daemon = sub.owsd(served(sub), ready=False, prefix=["prlimit", f"--nofile={number}"])
            if came_up(daemon):
                until(lambda: sub.get(daemon, "room") == "21.5", 20)
                assert daemon.stop() == 0
                break
            refused += 1
            # the C library itself needs one to load the program
            assert daemon.wait() in (1, 2, 127), (number, daemon.wait(), daemon.log())
            if number > 3:
                assert "oo many open files" in daemon.log() or "descriptor" in daemon.log(), \
                    (number, daemon.log())
    assert 3 < refused < 36, refused


def ask(scene):
    """A client of the served protocol: what it is told, or None."""
    done = scene._run([owsdtest.OWSCTL, "-t", f"owserver:{scene.path}/socket", "read", "-w", "80",
                       "/28.A0B1C2000001/temperature9"], 90)
    return done.stdout.strip() if done.returncode == 0 else None


def test_without_descriptors_it_serves_what_it_has_and_takes_clients_again_later(scene):
    config = scene.file("house.rio", faulty.house(scene, ListenSocket=str(scene.path / "socket")))
    daemon = scene.owsd(config)
    until(lambda: scene.get(daemon, "room") == "21.5", 20)
    alone = settled(lambda: len(open_files(daemon)))
    until(lambda: ask(scene) == "21.5", 20)
    # it sees that a client has gone after the client does
    until(lambda: len(open_files(daemon)) == alone, 10, "the client's is closed")
    # none is free below, wherever the last one stands
    taken = open_files(daemon)
    before = limit_descriptors(daemon, min(set(range(len(taken) + 1)) - set(taken)))
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(ask, scene)
        count = int(until(lambda: scene.get(daemon, "_TRANSACTIONS"), 20))
        until(lambda: int(scene.get(daemon, "_TRANSACTIONS") or 0) > count + 3, 20, "the engine goes on")
        config.write_text(faulty.house(scene, more=True, ListenSocket=str(scene.path / "socket")))
        daemon.signal(signal.SIGHUP)
        until(lambda: "all goes on as before" in daemon.log(), 10, "the reload is refused")
        owsdtest.logged(daemon, "oo many open files")
        until(lambda: scene.get(daemon, "room") == "21.5", 20, "it reads on")
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, before)
        # who waited at the door is let in when somebody else comes
        until(lambda: ask(scene) == "21.5", 20, "clients are served again")
        assert waiting.result(owsdtest.PATIENCE) == "21.5"
    until(lambda: len(open_files(daemon)) == alone, 10, "none is lost")
    daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(daemon, "hall") == "19.5", 20, "and the reload is done")
    assert daemon.stop() == 0


if __name__ == "__main__":
    owsdtest.main()
