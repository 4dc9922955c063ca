#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The compatibility kit of Sparkplug judges owsd-mqtt: the one in Go, which has the assertions of the
genuine one and is built from its source. It is the broker, and sees each packet; then it looks at what
a genuine broker hands out."""

import contextlib
import json
import re
import signal

import gobuild
import owsdtest
from mqtthouse import MQTT, SENSOR, SWITCH, Broker, item
from owsdtest import free_port, until
from test_mqtt_historian import RECORDER, Historian, Machine

TCK = ("github.com/joyautomation/sparkplug-tck-go/cmd/sparkplug-tck", "8d3410da73a10d8fb81ddae4d68e2ca5d96847b2")
PROBE = "28.A0B1C2000009"
# What it says of a conforming node: (what matches assertion and detail, why). Some only of a life with a
# second birth, a second connection, commands, or a chip that comes back; there is a life without them.
ALWAYS = (
    (r"alias-birth-requirement: .*'Node Control/Rebirth' lacks alias", "rebirth-name-aliases forbids it one"),
    (r": STATE/scada retain = false", "a broker hands out to who listens already without the flag; and it is the host's"),
)
AT_TIMES = (
    (r"(bdseq-matching|rebirth-action-3): .* bdSeq=0, .*last CONNECT Will bdSeq=1|bdseq-matching: .*NBIRTH bdSeq=0, CONNECT Will bdSeq=1",
     "it holds a birth against the will of a later connection"),
    (r": plant/pi7 NDEATH bdSeq=1, paired NBIRTH bdSeq=0", "it counts the second birth of a connection as one of the next"),
    (r"dbirth-seq-inc: .* DBIRTH seq=\d+, want \d+ \(one greater than NBIRTH", "data in between has numbers, too"),
    (r": plant/pi7 DBIRTH/28\.A0B1C2000009 after data flow started", "this chip came back then"),
    (r"seq.*: .*[DN]CMD missing seq", "it counts the host's commands, and a birth begins at 0 again"),
)


def lives(scene, machine, host, full):
    """What an edge node meets: changes, a chip that goes, its own end; full: besides commands, a chip that
    comes back, a host that asks for a birth and one that goes."""
    def hears(*topics):
        """After all that was heard until now."""
        def comes():
            found = iter(host.heard[begun:])
            return all(topic in found for topic in topics)
        until(comes, 20, lambda: f"{topics}: {host.heard[begun:]}\n{machine.face.log()}")
    begun = 0
    hears("NBIRTH/pi7", f"DBIRTH/pi7/{SENSOR}", f"DBIRTH/pi7/{PROBE}")
    begun = len(host.heard)
    machine.turn([], 1, 2)
    hears(f"DDATA/pi7/{SWITCH}")
    if full:
        host.command(f"DCMD/pi7/{SWITCH}", "dial", int_value=77)
        until(lambda: [v for _, v in host.of("dial")][-1:] == [77], 20, machine.face.log)
        host.command("NCMD/pi7", "Node Control/Rebirth", boolean_value=True)
        hears("NBIRTH/pi7", f"DBIRTH/pi7/{SWITCH}")
    for pulled, verb in (("1", "DDEATH"), ("0", "DBIRTH"))[:2 if full else 1]:
        begun = len(host.heard)
        assert scene.owsctl(machine.daemon, "set", "-w", "20", "pull", pulled).returncode == 0
        hears(f"{verb}/pi7/{PROBE}")
    if full:
        begun = len(host.heard)
        host.say(False)
        hears("NDEATH/pi7")
        machine.turn([], 3, 4)
        begun = len(host.heard)
        host.say(True)
        hears("NBIRTH/pi7", f"DBIRTH/pi7/{SWITCH}", f"DDATA/pi7/{SWITCH}")
        until(lambda: [v for _, v in host.of("dial")][-1:] == [4], 20, machine.face.log)
    begun = len(host.heard)
    assert machine.face.stop() == 0
    hears("NDEATH/pi7")


def judged(tck):
    """{assertion: {verdict: [detail]}} of what it saw."""
    tck.signal(signal.SIGINT)
    tck.wait()
    text = tck.log()
    results = json.loads(text[text.index("[\n"):text.rindex("]") + 1])
    found = {}
    for one in results:
        found.setdefault(one["assertion_id"], {}).setdefault(one["status"], []).append(
            f"{one.get('subject', '')} {one.get('detail', '')}")
    return found


@contextlib.contextmanager
def node(scene, port):
    owsdtest.need(MQTT)
    owsdtest.need(RECORDER)
    host = Historian(port)
    machine = Machine(scene, port, wire=f"DS18B20 {PROBE} as probe temperature 5\nbutton pull unplug probe\n", keys="Write on",
                      more=(item("room", f"/{SENSOR}/temperature"), item("probe", f"/{PROBE}/temperature"),
                            item("pull", "/simulator/pull", "bool", "output")))
    try:
        yield machine, host
    finally:
        host.end()


def accepted(found, full, least):
    known = ALWAYS + AT_TIMES if full else ALWAYS
    said = [f"{name}: {detail}" for name, verdicts in found.items() for detail in verdicts.get("fail", ())]
    wrong = [line for line in said if not any(re.search(pattern, line) for pattern, _ in known)]
    passed = [name for name, verdicts in found.items() if "pass" in verdicts and "fail" not in verdicts]
    print(f"# figure: {len(passed)} assertions passed, {len(said)} times it is wrong itself, "
          f"{sum(set(verdicts) == {'n/a'} for verdicts in found.values())} are not met")
    assert not wrong, "\n".join(wrong)
    assert len(passed) >= least, passed


def by_the_broker(scene, full, least):
    port = free_port()
    tck = scene.start([gobuild.program(*TCK), "-harness", "-profile", "edge-node", "-listen", f"127.0.0.1:{port}", "-duration", "10m", "-json"])
    until(lambda: "listening" in tck.log(), 20, tck.log)
    with node(scene, port) as (machine, host):
        lives(scene, machine, host, full)
        accepted(judged(tck), full, least)


def beside_a_broker(scene, full, least):
    program, broker = gobuild.program(*TCK), Broker(scene)
    tck = scene.start([program, "-broker", f"tcp://127.0.0.1:{broker.port}", "-duration", "10m", "-json"])
    until(lambda: "SUBSCRIBE" in broker.process.log() and "spBv1.0/# (QoS 1)" in broker.process.log(), 20, broker.process.log)
    with node(scene, broker.port) as (machine, host):
        lives(scene, machine, host, full)
        accepted(judged(tck), full, least)


def test_as_the_broker_it_has_nothing_against_a_plain_life(scene):
    by_the_broker(scene, False, 115)


def test_as_the_broker_it_has_nothing_against_a_full_life(scene):
    by_the_broker(scene, True, 115)


def test_beside_a_genuine_broker_it_has_nothing_against_a_plain_life(scene):
    beside_a_broker(scene, False, 185)


def test_beside_a_genuine_broker_it_has_nothing_against_a_full_life(scene):
    beside_a_broker(scene, True, 210)


if __name__ == "__main__":
    owsdtest.main(at_once=2)
