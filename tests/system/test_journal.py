#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who did what: the journal of alarms and commands, and limit alarms that are shelved."""

import json
import os
import pwd

import owsdtest
import peer
from owsdtest import until

import ows  # of owsdtest.PYTHON

FREEZER = "/28.000000000004/temperature9"
PUMP = "/29.000000000001/PIO.0"
ITEMS = [dict(Name="freezer", Path=FREEZER, Type="double", Uncached="on", LimitH=30),
         dict(Name="pump", Path=PUMP, Type="bool", IO="output")]
USER = pwd.getpwuid(os.getuid()).pw_name


def run(scene, daemon, *words):
    done = scene.owsctl(daemon, *words)
    assert (done.returncode, done.stderr) == (0, ""), (words, done.stderr)
    return done.stdout


def journal(scene, daemon, *words):
    return json.loads(run(scene, daemon, "--json", "journal", *words))


def alarms(scene, daemon):
    return json.loads(run(scene, daemon, "--json", "alarms"))


def events(scene, daemon, name):
    return [e["event"] for e in journal(scene, daemon, name)]


class Plant:
    """owsd over a peer, with a freezer that is warm and a pump."""

    def __init__(self, scene, freezer="20"):
        self.server = peer.Peer({FREEZER: freezer, PUMP: "0"})
        self.scene = scene

    def __enter__(self):
        self.server.__enter__()
        self.text = owsdtest.rio(self.server.target, ITEMS, Period=0.05)
        self.daemon = self.scene.owsd(self.text)
        until(lambda: self.scene.get(self.daemon, "freezer"), 10, "the first value")
        return self

    def __exit__(self, *problem):
        return self.server.__exit__(*problem)

    def state(self):
        return [(a["alarm"], a["state"]) for a in alarms(self.scene, self.daemon)]

    def until_state(self, *states):
        until(lambda: self.state() == list(states), 10, lambda: f"{self.state()} is {states}")


def test_the_journal_says_who_commanded_and_who_acknowledged(scene):
    with Plant(scene, "31") as plant:
        run(scene, plant.daemon, "set", "-w", "10", "pump", "1")
        plant.until_state(("high", "unacknowledged"))
        run(scene, plant.daemon, "alarms", "ack", "freezer")
        entries = journal(scene, plant.daemon)
        raised, = [e for e in entries if e["event"] == "raised"]
        assert (raised["journal"], raised["alarm"], raised["value"], raised["by"]) == \
            ("alarms", "high", 31, None), raised
        for event, name, value in (("set", "pump", True), ("acknowledged", "freezer", None)):
            entry, = [e for e in entries if e["event"] == event]
            by = entry["by"]
            assert (entry["name"], entry["value"]) == (name, value), entry
            assert (by["program"], by["uid"], by["user"]) == ("owsctl", os.getuid(), USER), by
            assert by["pid"] > 0 and by["person"] is None, by
        assert [e["time"] for e in entries] == sorted(e["time"] for e in entries)


def test_the_journal_names_the_person_for_whom_a_program_commanded(scene):
    with Plant(scene) as plant, \
            ows.Ows(plant.daemon.name, control=True, name="a\33[2Jface") as face:
        face.for_person("Anna\x9b2J\n")
        face.set("pump", True)
        entry, = until(lambda: journal(scene, plant.daemon, "pump"), 10, "the entry")
        assert entry["by"]["pid"] == os.getpid()
        assert entry["by"]["program"] == "a?[2Jface", entry["by"]
        assert entry["by"]["person"].startswith("Anna"), entry["by"]
        text = run(scene, plant.daemon, "journal", "pump")
        assert not set(text) & set("\33\x9b\r"), text
        command, = face.commands()
        assert (command.name, command.value, command.reason) == ("pump", True, "set"), command
        assert (command.who.uid, command.who.pid) == (os.getuid(), os.getpid()), command


def test_a_shelved_alarm_is_raised_only_when_its_time_is_over(scene):
    with Plant(scene) as plant:
        run(scene, plant.daemon, "alarms", "shelve", "freezer", "6", "defrosting")
        plant.server[FREEZER] = "31"
        plant.until_state(("high", "shelved"))
        alarm, = alarms(scene, plant.daemon)
        assert (alarm["why"], alarm["by"]["user"]) == ("defrosting", USER), alarm
        assert "shelved until" in run(scene, plant.daemon, "alarms")
        assert json.loads(run(scene, plant.daemon, "--json", "list", "freezer"))[0]["alarms"] == []
        assert events(scene, plant.daemon, "freezer") == ["shelved"]
        plant.until_state(("high", "unacknowledged"))
        assert events(scene, plant.daemon, "freezer") == ["shelved", "unshelved", "raised"]
        owsdtest.logged(plant.daemon, "freezer: alarm: no longer shelved")


def test_an_alarm_that_is_unshelved_and_stands_is_raised_though_it_was_acknowledged(scene):
    with Plant(scene, "31") as plant:
        plant.until_state(("high", "unacknowledged"))
        run(scene, plant.daemon, "alarms", "ack", "freezer")
        run(scene, plant.daemon, "alarms", "shelve", "freezer", "2d")
        plant.until_state(("high", "shelved"))
        run(scene, plant.daemon, "alarms", "unshelve", "freezer")
        plant.until_state(("high", "unacknowledged"))


def test_what_is_shelved_stays_so_over_a_reload_a_restart_and_a_kill(scene):
    with Plant(scene, "31") as plant:
        run(scene, plant.daemon, "alarms", "shelve", "freezer", "1h", "defrosting")
        run(scene, plant.daemon, "reload")
        plant.until_state(("high", "shelved"))
        for end in ("stop", "kill"):
            getattr(plant.daemon, end)()
            plant.daemon = scene.owsd(plant.text, name=plant.daemon.name)
            until(lambda: scene.get(plant.daemon, "freezer"), 10, "the first value")
            plant.until_state(("high", "shelved"))
            assert alarms(scene, plant.daemon)[0]["why"] == "defrosting"
            assert "raised" not in events(scene, plant.daemon, "freezer")


def test_what_cannot_be_shelved_is_refused(scene):
    with Plant(scene) as plant:
        for words, status, why in ((("pump", "1h"), 1, "pump has no limit alarms"),
                                   (("freezr", "1h"), 1, "did you mean freezer?"),
                                   (("freezer", "8d"), 2, "at most 7d"),
                                   (("freezer", "soon"), 2, "soon is no time"),
                                   (("freezer", "0"), 2, "0 is no time"),
                                   (("freezer",), 2, "takes a name, a time")):
            done = scene.owsctl(plant.daemon, "alarms", "shelve", *words)
            assert done.returncode == status and why in done.stderr, (words, done.stderr)
        assert plant.state() == []


def test_control_answers_each_line_and_acknowledges_only_what_has_limits(scene):
    answers = {"pump=1": "ok", "pump=on": "ok", "pump=maybe": 'error "maybe" is no value for it: expected 0 or 1',
               "pump=300": 'error "300" is no value for it: expected 0 or 1',
               "pump_WE=x": 'error "x" is no value for it: expected 0 or 1',
               "pumpe=1": "error there is no such name: pumpe; did you mean pump?",
               "freezer=1": "error it is an input: Writable is off in the configuration",
               "beat soon": "error beat takes a number of milliseconds", "beat 3600000": "ok",
               "beat 3600001": "error the longest beat is 3600000 milliseconds, an hour",
               "ack freezer": "ok", "ack pump": "error it has no limit alarms",
               "shelve pump 5": "error it has no limit alarms", "quit": "ok"}
    with Plant(scene, "31") as plant:
        plant.until_state(("high", "unacknowledged"))
        lines = scene.file("lines", "\n".join(answers) + "\n")
        done = scene._run(["sh", "-c", '"$0" -n "$1" control <"$2"', owsdtest.OWSCTL,
                           plant.daemon.name, lines], 20)
        assert done.returncode == 0, done
        assert dict(zip(answers, done.stdout.splitlines(), strict=True)) == answers, done
        plant.until_state(("high", "acknowledged"))


def test_the_journal_is_followed_over_a_restart(scene):
    with Plant(scene) as plant:
        name = plant.daemon.name
        follow = scene.start([owsdtest.OWSCTL, "-n", name, "--json", "journal", "-f"])
        run(scene, plant.daemon, "set", "pump", "1")
        until(lambda: '"event":"set"' in follow.log(), 10, follow.log)
        plant.daemon.kill()
        plant.daemon = scene.owsd(plant.text, name=name)
        until(lambda: "was started again" in follow.log(), 10, follow.log)
        plant.server[FREEZER] = "31"
        until(lambda: '"event":"raised"' in follow.log(), 20, follow.log)
        for line in follow.log().splitlines():
            if line.startswith("{"):
                assert json.loads(line)["name"] in ("pump", "freezer")


if __name__ == "__main__":
    owsdtest.main()
