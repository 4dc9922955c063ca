#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes at an offset: owsd on a simulated wire, and owsd with a genuine owserver as its target,
beside the genuine owserver."""

import json
import time

import owsdtest
import served
from owsdtest import until
from served import ABSENT, MEMORY, READ, SWITCH, THERMOMETER, WRITE

WHOLE = MEMORY + "/memory"
PAGE = MEMORY + "/pages/page."
# Path, data, offset
OF_BYTES = [(path, data, offset)
            for path in (WHOLE, PAGE + "3")
            for data in (b"", b"a", b"bcde", b"f" * 40)
            for offset in (0, 1, 8, 30, 31, 32, 126, 127, 128, 100000, -1, -0x80000000)] + [
                (WHOLE, b"g" * 130, 3), ("/uncached" + WHOLE, b"hi", 9), ("/bus.0" + WHOLE, b"jk", 7)]
REFUSED = [(ABSENT + "/memory", b"x", 4), (MEMORY, b"x", 4), ("/", b"x", 4), ("/nonsense", b"x", 4),
           (MEMORY + "/nonsense", b"x", 4), (PAGE + "4", b"x", 4), (PAGE + "ALL", b"x" * 4, 4),
           (PAGE + "ALL", b"x" * 128, 4), ("/settings/return_codes/text.1", b"x", 4)]
# The genuine owserver takes these and forgets the offset: a part of a number would be another number
OF_NUMBERS = [(THERMOMETER + "/templow", b"13", 4), (SWITCH + "/PIO.0", b"1", 1),
              (SWITCH + "/PIO.BYTE", b"255", 1), (THERMOMETER + "/alias", b"x", 3),
              (THERMOMETER + "/templow", b"13", -1), ("/signals/relays", b"5", 1)]


def compare(genuine, server, cases):
    wrong = []
    for path, data, offset in cases:
        left, right = (s.frame(WRITE, path, data=data, offset=offset) for s in (genuine, server))
        if left != right:
            wrong.append(f"{path} {len(data)} bytes at {offset}: {right}, not {left}")
    assert not wrong, "\n".join([f"{len(wrong)} of {len(cases)}", *wrong[:20]])


def test_answers_on_a_wire_are_those_of_the_genuine_owserver(scene):
    compare(served.owserver(scene), served.owsd(scene), OF_BYTES + REFUSED)


def test_answers_through_an_owserver_are_its_own(scene):
    genuine = served.owserver(scene)
    server = served.owsd_of(scene, genuine.target, items=[])
    until(lambda: server.has(served.DEVICES), 20, "its devices are there")
    compare(genuine, server, OF_BYTES + REFUSED)


def test_what_is_written_through_two_owsd_is_on_the_wire(scene):
    """The first is an owserver to the second."""
    near = served.owsd(scene)
    far = served.owsd_of(scene, near.target, items=[])
    until(lambda: far.has(served.DEVICES), 20, "its devices are there")
    want = bytearray(b"." * 128)
    assert far.frame(WRITE, WHOLE, data=bytes(want)).size == 128
    for path, data, offset in OF_BYTES:
        start, size = (32 * int(path[-1]), 32) if PAGE in path else (0, 128)
        room = max(0, size - offset) if offset >= 0 else 0
        taken = data[:room]
        want[start + offset:start + offset + len(taken)] = taken if taken else \
            want[start + offset:start + offset]
        frame = far.frame(WRITE, path, data=data, offset=offset)
        assert (frame.ret, frame.size) == (0, len(taken)), (path, len(data), offset, frame)
    assert near.frame(READ, "/uncached" + WHOLE).data == bytes(want)
    assert far.frame(READ, "/uncached" + WHOLE).data == bytes(want)


def test_a_part_of_what_is_no_bytes_is_refused_and_changes_nothing(scene):
    server = served.owsd(scene)
    through = served.owsd_of(scene, served.owserver(scene).target, items=[])
    until(lambda: through.has(served.DEVICES), 20, "its devices are there")
    for path, data, offset in OF_NUMBERS:
        before = server.frame(READ, path)
        # relays of the table is PIO.BYTE: what sets its pins is refused as that, part or whole
        assert server.frame(WRITE, path, data=data, offset=offset).ret == (-30 if "PIO.0" in path else -22), path
        assert server.frame(READ, "/uncached" + path).data == before.data, path
        if not path.startswith("/signals"):
            assert through.frame(WRITE, path, data=data, offset=offset).ret == -22, path


def test_a_client_that_hangs_up_ends_its_reading_of_a_large_memory(scene):
    """All of it takes 79 seconds; other requests are served meanwhile and prove nothing."""
    wire = scene.file("large.sim", "chip DS2482-100 0x18\nDS1977 37.000000000001\n")
    server = served.owsd_of(scene, f"sim:{wire}", items=[])
    until(lambda: server.has(["/37.000000000001"]), 20, "the chip is there")

    def errors():
        stats = json.loads(scene.owsctl(server.program, "--json", "stats").stdout)
        return sum(c["value"] for c in stats["counters"] if c["name"] == "guest_errors")

    before = errors()
    with server.connect() as client:
        client.sendall(served.request(READ, "/uncached/37.000000000001/memory", size=32704))
        time.sleep(1)  # it does not end by itself
        assert errors() == before
    until(lambda: errors() == before + 1, 20, "the reading has ended")


if __name__ == "__main__":
    owsdtest.main(at_once=4)
