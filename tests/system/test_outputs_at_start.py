#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What owsd writes when it starts: one case for each row of "A command is in force" in
docs/semantics.md, with real programs that end, live, hang or are killed. The peer has all writes."""

import sys
import time

import owsdtest
import peer

PLAIN, INIT, SAFE, BOTH = (f"/29.00000000000{n}/PIO.0" for n in range(1, 5))
ALL = PLAIN, INIT, SAFE, BOTH
# Sets each output once, and beats when it promised to; "once": it ends after that, in order
GIVER = """
import sys, time
import ows
name, beats, once = sys.argv[1], float(sys.argv[2]), sys.argv[3] == "once"
s = ows.Ows(name, control=True)
if beats:
    s.beat(int(beats * 1000))
for output in ("plain", "init", "safe", "both"):
    s.set(output, 1)
while any(s.get(o).applied == 0 for o in ("plain", "init", "safe", "both")):
    if beats:
        s.beat(int(beats * 1000))
    time.sleep(0.05)
print("set", flush=True)
while not once:
    time.sleep(0.1)
    try:
        if beats:
            s.beat(int(beats * 1000))
    except ows.Stale:
        pass
    try:
        if s.stale():
            s.reopen()
            print("reopened", flush=True)
    except OSError:
        pass
s.close()
"""

# Sets nothing, and beats
FOLLOWER = """
import sys, time
import ows
s = ows.Ows(sys.argv[1], control=True)
s.beat(500)
print("sits in place", s.client, flush=True)
while True:
    time.sleep(0.1)
    try:
        s.beat(500)
    except ows.Stale:
        pass
    try:
        if s.stale():
            s.reopen()
            print("reopened", flush=True)
    except OSError:
        pass
"""


class Plant:
    """A peer, an owsd on it and the giver of a command that is in force."""

    def __init__(self, scene, server, beats=0.0, once=False):
        self.scene, self.server = scene, server
        items = [dict(Name=name, Path=path, Type="bool", IO="output")
                 for name, path in zip(("plain", "init", "safe", "both"), ALL)]
        items[1]["InitValue"] = items[3]["InitValue"] = "off"
        items[2]["SafeValue"] = items[3]["SafeValue"] = "on"
        self.config = scene.file("plant.rio", owsdtest.rio(server.target, items, Period=0.02))
        self.daemon = scene.owsd(self.config)
        self.giver = scene.start([sys.executable, "-c", GIVER, self.daemon.name, str(beats),
                                  "once" if once else "stay"],
                                 {"PYTHONPATH": str(owsdtest.SOURCE / "src/libows")})
        owsdtest.until(lambda: "set" in self.giver.log(), 20, self.giver.log)
        owsdtest.until(lambda: all(server[path] == "1" for path in ALL), 20, "all are on")
        if once:
            assert self.giver.wait() == 0

    def again(self, ended):
        """owsd ends, stopped or killed, and starts: what it writes counts from here."""
        if ended == "stopped":
            assert self.daemon.stop() == 0
        else:
            self.daemon.kill()
        self.server.requests.clear()
        self.daemon = self.scene.owsd(self.config, name=self.daemon.name)
        owsdtest.until(lambda: self.server.requests, 20, "it asks the server")

    def writes(self, expected, what):
        """These writes, each once, and nothing after them."""
        expected = sorted(expected)
        owsdtest.until(lambda: len(self.server.writes) >= len(expected), 30,
                       lambda: f"{what}: {self.server.writes}")
        time.sleep(3)  # longer than owsd waits for a program to come back
        assert sorted(self.server.writes) == expected, (what, self.server.writes)


ENDS = "stopped", "killed"


def values():
    return {path: "0" for path in ALL}


def test_what_a_program_that_ended_has_set_is_not_repeated_and_initvalue_is_written_once(scene):
    for ended in ENDS:
        for beats in (0.0, 5.0):
            with peer.Peer(values()) as server:
                plant = Plant(scene, server, beats, once=True)
                plant.again(ended)
                plant.writes([(INIT, b"0"), (BOTH, b"0")], f"{ended}, beats {beats}")
                plant.server.requests.clear()
                plant.again(ended)
                plant.writes([(INIT, b"0"), (BOTH, b"0")], f"{ended} a second time")
                assert plant.daemon.stop() == 0


def test_what_owsctl_set_is_not_repeated_and_initvalue_is_written_once(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, once=True)
            for name in ("plain", "init", "safe", "both"):
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "0").returncode == 0
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "1").returncode == 0
            plant.again(ended)
            plant.writes([(INIT, b"0"), (BOTH, b"0")], ended)
            assert plant.daemon.stop() == 0


def test_the_command_of_a_living_program_that_beats_stays_in_force_and_initvalue_is_withheld(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0)
            plant.again(ended)
            plant.writes([(path, b"1") for path in ALL], ended)
            assert "reopened" in plant.giver.log() and plant.giver.running()
            plant.giver.stop()
            assert plant.daemon.stop() == 0


def test_a_program_that_takes_the_place_of_one_that_ended_does_not_bring_its_commands_back(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0, once=True)
            follower = scene.start([sys.executable, "-c", FOLLOWER, plant.daemon.name],
                                   {"PYTHONPATH": str(owsdtest.SOURCE / "src/libows")})
            owsdtest.until(lambda: "sits in place 0" in follower.log(), 20, follower.log)
            plant.again(ended)
            plant.writes([(INIT, b"0"), (BOTH, b"0")], ended)
            assert "reopened" in follower.log() and follower.running()
            follower.stop()
            assert plant.daemon.stop() == 0


def test_a_living_program_that_never_beats_counts_as_one_that_ended(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server)
        plant.again("stopped")
        plant.writes([(INIT, b"0"), (BOTH, b"0")], "it may set again, and does not")
        assert plant.giver.running()


def test_of_a_program_that_beat_and_hangs_or_is_dead_safevalue_is_written_else_initvalue(scene):
    # `init` has no SafeValue: InitValue; `plain` has neither: nothing
    expected = [(INIT, b"0"), (SAFE, b"1"), (BOTH, b"1")]
    for ended, fate in zip(ENDS, ("freeze", "kill")):
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=8.0)
            before = plant.daemon
            getattr(plant.giver, fate)()
            plant.again(ended)
            assert "stopped beating" not in before.log(), "the machine is too slow for this"
            assert not server.writes, (fate, "before the promise is over", server.writes)
            plant.writes(expected, f"{ended}, {fate}")
            plant.giver.kill()
            assert plant.daemon.stop() == 0


def test_safevalue_that_stands_stays_over_a_restart(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=2.0)
            plant.giver.kill()
            owsdtest.logged(plant.daemon, "stopped beating")
            plant.again(ended)
            plant.writes([(INIT, b"0"), (SAFE, b"1"), (BOTH, b"1")], ended)
            assert plant.daemon.stop() == 0


def test_a_reload_leaves_every_command_in_force_and_writes_nothing(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, once=True)
        server.requests.clear()
        with open(plant.config, "a", encoding="ascii") as file:
            file.write("\n# another text\n")
        plant.daemon.signal(1)
        owsdtest.logged(plant.daemon, "reload: 4 signals, 4 of them go on")
        plant.writes([], "nothing")
        assert scene.owsctl(plant.daemon, "get", "both").stdout == "1\n"


def test_a_superseded_command_does_not_come_back_with_its_giver(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0)
            for name in ("plain", "init", "safe", "both"):
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "0").returncode == 0
            plant.again(ended)
            plant.writes([(INIT, b"0"), (BOTH, b"0")], "the last word was owsctl's, which ended")
            assert "reopened" in plant.giver.log()
            plant.giver.stop()
            assert plant.daemon.stop() == 0


def test_what_is_set_while_owsd_is_not_there_is_refused_or_lost_but_never_written_later(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, once=True)
            plant.daemon.stop() if ended == "stopped" else plant.daemon.kill()
            if ended == "killed":  # it cannot say so: its heart has to be still for a while
                owsdtest.until(lambda: scene.owsctl(plant.daemon, "get", "plain").returncode == 3,
                               20, "its values are not good")
            done = scene.owsctl(plant.daemon, "set", "plain", "0")
            assert done.returncode == 1 and "owsd is not running" in done.stderr, done
            server.requests.clear()
            plant.daemon = scene.owsd(plant.config, name=plant.daemon.name)
            plant.writes([(INIT, b"0"), (BOTH, b"0")], ended)
            assert plant.daemon.stop() == 0


if __name__ == "__main__":
    owsdtest.main(at_once=4)
