#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Which command is in force: one case for each row of the table in docs/semantics.md, with real
programs that end, live, hang, fork, dump core or are killed, while owsd runs and over its end. The
peer has all writes."""

import os
import signal
import struct
import sys
import time

import owsdtest
import peer

NAMES = "plain", "init", "safe", "both", "last", "last_safe"
ALL = PLAIN, INIT, SAFE, BOTH, LAST, LAST_SAFE = [f"/29.00000000000{n}/PIO.0" for n in range(1, 7)]
# Sets each output once, and beats when it promised to, until its fate: "once": it ends in order;
# "stay": it lives; at a SIGUSR1 "crash": it dumps core; "fork": it dies, and its child lives on
CONTROLLER = """
import os, signal, sys, time
import ows
name, beats, fate = sys.argv[1], float(sys.argv[2]), sys.argv[3]
told = []
signal.signal(signal.SIGUSR1, lambda *_: told.append(1))
s = ows.Ows(name, control=True, name="controller")
if beats:
    s.beat(int(beats * 1000))
for output in sys.argv[4:]:
    s.set(output, 1)
while any(s.get(o).applied == 0 for o in sys.argv[4:]):
    if beats:
        s.beat(int(beats * 1000))
    time.sleep(0.05)  # pace
print("set", flush=True)
while fate != "once":
    time.sleep(0.1)  # pace
    if told and fate == "crash":
        signal.signal(signal.SIGSEGV, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGSEGV)
    if told and fate == "fork":
        if os.fork() == 0:
            print("child", os.getpid(), flush=True)
            time.sleep(600)  # until it is killed
        os._exit(1)
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
print("beats", flush=True)
while True:
    time.sleep(0.1)  # pace
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


def commands(data):
    """What the rows of a file of last commands say, None for a row without a command: the layout of
    src/memory/shm/force.c."""
    found = []
    for row in range(struct.unpack_from("<I", data, 20)[0]):
        at = 64 + 112 * row
        slot = at + 32 + 40 * (struct.unpack_from("<I", data, at)[0] & 1)
        value, _, _, _, flags = struct.unpack_from("<qIIII", data, slot)
        found.append(value if flags & 1 else None)
    return found


class Plant:
    """A peer, an owsd on it and the controller of a command that is in force."""

    def __init__(self, scene, server, beats=0.0, fate="stay", **keys):
        self.scene, self.server = scene, server
        items = [dict(Name=name, Path=path, Type="bool", IO="output", **keys)
                 for name, path in zip(NAMES, ALL)]
        items[1]["InitValue"] = items[3]["InitValue"] = "off"
        items[2]["SafeValue"] = items[3]["SafeValue"] = items[5]["SafeValue"] = "on"
        items[4]["Start"] = items[5]["Start"] = "last"
        self.config = scene.file("plant.rio", owsdtest.rio(server.target, items, Period=0.02))
        self.environment = {"OWS_STATE_DIR": str(scene.path / "state")}
        self.daemon = scene.owsd(self.config, env=self.environment)
        self.controller = scene.start([sys.executable, "-c", CONTROLLER, self.daemon.name, str(beats), fate,
                                  *NAMES], {"PYTHONPATH": str(owsdtest.PYTHON)})
        owsdtest.until(lambda: "set" in self.controller.log(), 20, self.controller.log)
        owsdtest.until(lambda: all(server[path] == "1" for path in ALL), 20, "all are on")
        if fate == "once":
            assert self.controller.wait() == 0

    def stored(self):
        """The file of what Start "last" applies, from when both commands stand in it."""
        file = self.scene.path / "state" / f"{self.daemon.name}.last"
        owsdtest.until(lambda: file.exists() and commands(file.read_bytes()) == [1, 1], 20,
                       lambda: f"{file} has both commands")
        return file

    def again(self, ended):
        """owsd ends, stopped or killed, and starts: what it writes counts from here."""
        if ended == "reboot":
            self.stored()
        if ended == "stopped":
            assert self.daemon.stop() == 0
        else:
            self.daemon.kill()
        if ended in ("reboot", "damaged"):
            for file in owsdtest.place().glob(f"{self.daemon.name}.*"):
                file.unlink()
        self.server.requests.clear()
        self.daemon = self.scene.owsd(self.config, name=self.daemon.name, env=self.environment)
        owsdtest.logged(self.daemon, "from down to up")

    def writes(self, expected, what):
        """These writes, each once, and nothing after them."""
        expected = sorted(expected)
        owsdtest.until(lambda: len(self.server.writes) >= len(expected), 30,
                       lambda: f"{what}: {self.server.writes}")
        # longer than owsd waits for a program to come back
        owsdtest.worked(self.daemon.name, 3)
        assert sorted(self.server.writes) == expected, (what, self.server.writes)


ENDS = "stopped", "killed"
# Nobody comes back: InitValue once, else nothing; what was last
ENDED = [(INIT, b"0"), (BOTH, b"0"), (LAST, b"1"), (LAST_SAFE, b"1")]
# The controller is lost over a restart: `init` has no SafeValue, `plain` has nothing
LOST = [(INIT, b"0"), (SAFE, b"1"), (BOTH, b"1"), (LAST, b"1"), (LAST_SAFE, b"1")]


def values():
    return {path: "0" for path in ALL}


# --- Over an end of owsd ---------------------------------------------------------------------------

def test_what_a_program_that_ended_has_set_is_not_repeated_and_initvalue_is_written_once(scene):
    for ended in ENDS:
        for beats in (0.0, 5.0):
            with peer.Peer(values()) as server:
                plant = Plant(scene, server, beats, "once")
                plant.again(ended)
                plant.writes(ENDED, f"{ended}, beats {beats}")
                plant.server.requests.clear()
                plant.again(ended)
                plant.writes(ENDED, f"{ended} a second time")
                assert plant.daemon.stop() == 0


def test_what_owsctl_set_is_not_repeated_and_initvalue_is_written_once(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, fate="once")
            for name in NAMES:
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "0").returncode == 0
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "1").returncode == 0
            plant.again(ended)
            plant.writes(ENDED, ended)
            assert plant.daemon.stop() == 0


def test_the_command_of_a_living_program_that_beats_stays_in_force_and_initvalue_is_withheld(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0)
            plant.again(ended)
            plant.writes([(path, b"1") for path in ALL], ended)
            owsdtest.logged(plant.controller, "reopened")
            assert plant.controller.running()
            plant.controller.stop()
            assert plant.daemon.stop() == 0


def test_a_program_that_connects_after_one_that_ended_does_not_bring_its_commands_back(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, 5.0, "once")
            follower = scene.start([sys.executable, "-c", FOLLOWER, plant.daemon.name],
                                   {"PYTHONPATH": str(owsdtest.PYTHON)})
            owsdtest.until(lambda: "beats" in follower.log(), 20, follower.log)
            plant.again(ended)
            plant.writes(ENDED, ended)
            owsdtest.logged(follower, "reopened")
            assert follower.running()
            follower.stop()
            assert plant.daemon.stop() == 0


def test_a_living_program_that_never_beats_counts_as_one_that_ended(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server)
        plant.again("stopped")
        plant.writes(ENDED, "it may set again, and does not")
        assert plant.controller.running()


def loses(scene, ended, fate, beats):
    """False: owsd was away for about as long as the program has promised to beat again."""
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, beats=beats)
        before, begun = plant.daemon, time.monotonic()
        getattr(plant.controller, fate)()
        plant.again(ended)
        early = list(server.writes)
        in_time = time.monotonic() - begun < beats - 3
        if in_time:
            assert "SafeValue" not in before.log(), before.log()
            assert not early, (fate, "before the promise is over", early)
            plant.writes(LOST, f"{ended}, {fate}")
        plant.controller.kill()
        assert plant.daemon.stop() == 0
        return in_time


def test_of_a_program_that_beat_and_hangs_or_is_dead_safevalue_is_written_else_initvalue(scene):
    for ended, fate in zip(ENDS, ("freeze", "kill")):
        assert any(loses(scene, ended, fate, beats) for beats in (8.0, 25.0, 80.0)), "too slow a machine"


def test_a_child_that_holds_the_socket_open_does_not_come_back_for_its_parent(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, 8.0, "fork")
            plant.controller.signal(signal.SIGUSR1)
            assert plant.controller.wait() == 1
            plant.again(ended)
            plant.writes(LOST, ended)
            end_child(plant.controller)
            assert plant.daemon.stop() == 0


def test_safevalue_that_stands_stays_over_a_restart(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0)
            plant.controller.kill()
            owsdtest.logged(plant.daemon, "to SafeValue")
            plant.again(ended)
            plant.writes(LOST, ended)
            assert plant.daemon.stop() == 0


def test_a_superseded_command_does_not_come_back_with_its_controller(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, beats=5.0)
            for name in NAMES:
                assert scene.owsctl(plant.daemon, "set", "-w", "10", name, "0").returncode == 0
            plant.again(ended)
            plant.writes([(INIT, b"0"), (BOTH, b"0"), (LAST, b"0"), (LAST_SAFE, b"0")],
                         "the last word was owsctl's, which ended")
            owsdtest.logged(plant.controller, "reopened")
            plant.controller.stop()
            assert plant.daemon.stop() == 0


def test_what_is_set_while_owsd_is_not_there_is_refused_or_lost_but_never_written_later(scene):
    for ended in ENDS:
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, fate="once")
            plant.daemon.stop() if ended == "stopped" else plant.daemon.kill()
            if ended == "killed":  # it cannot say so: its heart has to be still for a while
                owsdtest.until(lambda: scene.owsctl(plant.daemon, "get", "plain").returncode == 3,
                               20, "its values are not good")
            done = scene.owsctl(plant.daemon, "set", "plain", "0")
            assert done.returncode == 1 and "is not running" in done.stderr, done
            server.requests.clear()
            plant.daemon = scene.owsd(plant.config, name=plant.daemon.name, env=plant.environment)
            plant.writes(ENDED, ended)
            assert plant.daemon.stop() == 0


def test_a_damaged_memory_of_commands_is_logged_and_nothing_of_it_is_in_force(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, beats=5.0)
        plant.daemon.kill()
        with open(owsdtest.segment(plant.daemon.name, "force"), "r+b") as file:
            file.seek(64)
            file.write(os.urandom(400))
        plant.again("killed")
        # and Start "last" has what was stored
        plant.writes(ENDED, "damaged")
        owsdtest.logged(plant.daemon, "does not know which commands are in force")


# --- A reboot: only the disk is left ---------------------------------------------------------------

def test_after_a_reboot_an_output_has_initvalue_or_what_was_stored_last(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, beats=5.0)
        plant.controller.kill()
        plant.again("reboot")
        plant.writes(ENDED, "reboot")


def test_a_damaged_file_of_last_commands_is_logged_and_initvalue_counts(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, fate="once")
        assert plant.daemon.stop() == 0
        file = plant.stored()
        data = bytearray(file.read_bytes())
        at = data.index(struct.pack("<q", 1), 64)  # of the first command
        data[at] = 0
        file.write_bytes(data)
        plant.again("damaged")
        plant.writes([(INIT, b"0"), (BOTH, b"0")], "damaged")
        owsdtest.logged(plant.daemon, "the file is damaged")


def test_what_cannot_be_stored_is_written_and_never_applied(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, fate="once")
        state = scene.path / "state"
        state.rename(scene.path / "away")
        state.write_text("no directory", encoding="ascii")
        done = scene.owsctl(plant.daemon, "set", "-w", "3", "last", "0")
        assert done.returncode != 0, done
        assert server[LAST] == "0"
        owsdtest.logged(plant.daemon, "cannot be stored")
        state.unlink()
        (scene.path / "away").rename(state)
        owsdtest.logged(plant.daemon, "stored again")
        assert scene.owsctl(plant.daemon, "set", "-w", "10", "last", "1").returncode == 0


# --- owsd runs -------------------------------------------------------------------------------------

def end_child(controller):
    for line in controller.log().splitlines():
        if line.startswith("child "):
            os.kill(int(line.split()[1]), signal.SIGKILL)


def test_a_program_that_dies_in_any_way_leaves_safevalue_when_its_time_is_over(scene):
    fates = {"kill": ("stay", lambda g: g.kill()),
             "hang": ("stay", lambda g: g.freeze()),
             "crash": ("crash", lambda g: (g.signal(signal.SIGUSR1), g.wait())),
             "fork": ("fork", lambda g: (g.signal(signal.SIGUSR1), g.wait()))}
    for what, (fate, lose) in fates.items():
        with peer.Peer(values()) as server:
            plant = Plant(scene, server, 2.0, fate)
            text = scene.owsctl(plant.daemon, "set", "-w", "10", "plain", "1")
            assert text.returncode == 0, text
            lose(plant.controller)
            owsdtest.logged(plant.daemon, "3 outputs go to SafeValue")
            for name in NAMES:
                whose = scene.owsctl(plant.daemon, "who", name).stdout
                assert ("SafeValue" in whose) == (name in ("safe", "both", "last_safe")), whose
                assert name == "plain" or "controller" in whose, whose
            end_child(plant.controller)
            plant.controller.thaw() if what == "hang" else None
            assert plant.daemon.stop() == 0


def test_a_program_that_never_beat_leaves_its_outputs_as_they_are_however_it_ends(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server)
        server.requests.clear()
        plant.controller.kill()
        plant.writes([], "killed")
        assert "SafeValue" not in plant.daemon.log()


def test_with_safe_delay_0_safevalue_follows_a_death_at_once(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, 300.0, SafeDelay=owsdtest.raw("0"))
        plant.controller.kill()
        owsdtest.logged(plant.daemon, "3 outputs go to SafeValue")


def test_a_reload_leaves_every_command_in_force_and_writes_nothing(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, fate="once")
        server.requests.clear()
        with open(plant.config, "a", encoding="ascii") as file:
            file.write("\n# another text\n")
        plant.daemon.signal(1)
        owsdtest.logged(plant.daemon, "reload: 6 signals, 6 of them go on")
        plant.writes([], "nothing")
        assert scene.owsctl(plant.daemon, "get", "both").stdout == "1\n"


def test_a_reload_under_a_program_that_beats_leaves_its_commands_in_force(scene):
    with peer.Peer(values()) as server:
        plant = Plant(scene, server, 5.0)
        server.requests.clear()
        with open(plant.config, "a", encoding="ascii") as file:
            file.write("\n# another text\n")
        plant.daemon.signal(1)
        owsdtest.logged(plant.daemon, "reload: 6 signals, 6 of them go on")
        plant.writes([], "nothing")
        owsdtest.logged(plant.controller, "reopened")
        assert "SafeValue" not in plant.daemon.log()
        plant.controller.stop()


if __name__ == "__main__":
    owsdtest.main(at_once=4)
