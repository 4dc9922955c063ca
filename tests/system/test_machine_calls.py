#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every kind of system call that owsd makes is interrupted by a signal, kind after kind: at the
start, while it runs, at a reload, at the end. It gives up with a reason before it is ready, or does
what it would have done; and no false value is ever good."""

import collections
import concurrent.futures
import os
import re
import shutil
import signal
import subprocess
import time

import faulty
import owsdtest
from owsdtest import until

AT_ONCE = 4
CALL = re.compile(r"^(?:\d+ +)?(\w+)\(")
# They do not return, or nothing would be left that could be looked at
NEVER = {"execve", "exit", "exit_group", "rt_sigreturn", "restart_syscall", "vfork"}
# The C library's own, which the kernel never interrupts: it takes the answer for an address, ends the
# program, or goes on with all signals blocked
NEVER |= {"brk", "rseq", "rt_sigprocmask"}
# A call that wakes is not interrupted either, and one that waits cannot be told from it by name: these
# are interrupted by real signals, in test_machine_time
NEVER |= {"futex"}
CLIENT = "/28.A0B1C2000001/temperature9"


def strace():
    if not shutil.which("strace"):
        owsdtest.skip("strace is not installed")
    probe = subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"], capture_output=True, check=False)
    if probe.returncode:
        owsdtest.skip(f"strace may not trace: {probe.stderr.decode().strip()}")
    faulty.not_sanitized("the sanitizer's own calls would be interrupted")
    return "strace"


def served(scene):
    return faulty.house(scene, ListenSocket=str(scene.path / "socket"), HeartbeatLine="nochip/3")


def more(scene):
    return faulty.house(scene, more=True, ListenSocket=str(scene.path / "socket"),
                        HeartbeatLine="nochip/3")


def ask(scene):
    done = scene._run([owsdtest.OWSCTL, "-t", f"owserver:{scene.path}/socket", "read", CLIENT], 60)
    return done.stdout.strip() if done.returncode == 0 else None


def true_or_bad(scene, daemon):
    """room, where there is a table; fails when it is good and false."""
    done = scene.owsctl(daemon, "get", "room")
    if done.returncode == 0:
        assert done.stdout.strip() == "21.5", done
    return done.returncode == 0


def life(scene, daemon, config):
    """All that owsd does, once; what must not work under a fault need not."""
    scene.owsctl(daemon, "set", "relays", "5")
    ask(scene)
    true_or_bad(scene, daemon)
    config.write_text(more(scene))
    daemon.signal(signal.SIGHUP)
    for _ in range(4):
        time.sleep(0.1)  # in all this time
        true_or_bad(scene, daemon)


def start_traced(scene, *options):
    """owsd under strace from its beginning; not yet ready."""
    config = scene.file("house.rio", served(scene))
    return faulty.Traced.start(scene, config, [strace(), "-f", "-qq", *options]), config


def kinds(scene):
    """Of every call that owsd makes: how many its first thread makes before main()."""
    trace = scene.path / "trace"
    daemon, config = start_traced(scene, "-o", trace)
    daemon.ready(30)
    until(lambda: true_or_bad(scene, daemon), 30)
    life(scene, daemon, config)
    until(lambda: scene.get(daemon, "hall") == "19.5", 30)
    daemon.signal(signal.SIGTERM)
    assert daemon.wait(20) == 0
    before, seen, started = collections.Counter(), set(), False
    for line in trace.read_text(errors="replace").splitlines():
        call = CALL.match(line)
        if not call:
            continue
        # the first thing that main() does
        started = started or '"/dev/null"' in line
        seen.add(call[1])
        if not started:
            before[call[1]] += 1
    assert started and len(seen) > 30, seen
    return {kind: before[kind] for kind in sorted(seen - NEVER)}


def each(scene, attempt):
    """attempt(own scene, kind, calls before main()) for each kind; the failures of all."""
    def at(item):
        try:
            with owsdtest.Scene() as sub:
                return attempt(sub, *item)
        except AssertionError as why:
            wrong.append(f"{item[0]}: {why}")
            return None
    wrong, all_kinds = [], kinds(scene)
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        ends = dict(zip(all_kinds, pool.map(at, all_kinds.items())))
    assert not wrong, "\n".join(wrong)
    return ends


def start_and_end(scene, kind, before):
    daemon, _ = start_traced(scene, "-o", "/dev/null", "-e",
                             f"inject={kind}:error=EINTR:when={before + 1}+3")

    def ready():
        try:
            return daemon.ready(0)
        except owsdtest.Late:
            log = daemon.log()  # it may end yet
            return "NOTIFY_SOCKET cannot be used" in log and ": instance " in log
    try:
        until(ready, 10, "it is ready, or says why it cannot say so")
    except AssertionError as why:
        assert "ended with status" in str(why), why
        assert daemon.wait() in (1, 2) and daemon.log().strip(), (daemon.wait(), daemon.log())
        return False
    for _ in range(5):
        true_or_bad(scene, daemon)
        time.sleep(0.05)  # in all this time
    daemon.signal(signal.SIGTERM)
    assert daemon.wait(20) == 0, (daemon.wait(), daemon.log())
    return True


def test_interrupted_at_start_and_end_it_gives_up_with_a_reason_or_works(scene):
    ends = each(scene, start_and_end)
    print("given up at the start:", " ".join(kind for kind, up in ends.items() if not up))


def traced(daemon):
    """Does a tracer have all its threads?"""
    for task in os.listdir(f"/proc/{daemon.pid}/task"):
        with open(f"/proc/{daemon.pid}/task/{task}/status", encoding="ascii", errors="replace") as file:
            if "\nTracerPid:\t0\n" in file.read():
                return False
    return True


def while_it_runs(scene, kind, _before):
    config = scene.file("house.rio", served(scene))
    daemon = scene.owsd(config)
    until(lambda: true_or_bad(scene, daemon), 30)
    tracer = scene.start(["strace", "-f", "-qq", "-o", "/dev/null", "-e",
                          f"inject={kind}:error=EINTR:when=1+3", "-p", str(daemon.pid)])
    until(lambda: traced(daemon) or not tracer.running(), 20, "strace has it")
    if not tracer.running():
        return None
    life(scene, daemon, config)
    assert daemon.running(), daemon.log()
    tracer.signal(signal.SIGINT)
    tracer.wait(20)
    # nothing of it lasts
    daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(daemon, "hall") == "19.5", 30, "the reload is done")
    until(lambda: true_or_bad(scene, daemon), 30, "room is good")
    until(lambda: ask(scene) == "21.5", 30, "clients are served")
    # the reload may just be changing the memory: owsctl says so, and to try again
    until(lambda: scene.owsctl(daemon, "set", "relays", "6").returncode == 0, 30, "outputs are set")
    until(lambda: scene.get(daemon, "relays") == "6", 30, "outputs are written")
    assert daemon.stop() == 0
    return True


def test_interrupted_while_it_runs_nothing_of_it_lasts(scene):
    ends = each(scene, while_it_runs)
    if not any(ends.values()):
        owsdtest.skip("strace may not be attached to a process that runs")


if __name__ == "__main__":
    owsdtest.main()
