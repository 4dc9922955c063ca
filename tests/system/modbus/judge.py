#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A client of owsd-modbus by a library of others, which reads the same records again and again:

    judge.py LIBRARY PORT SECONDS EXPECTED [PROGRAM]

EXPECTED, as JSON, is the number that each place from 1 on has for good: a record has that in all its
forms and quality 192, or none in any form. Ends with 1 and says why where it is otherwise, else
prints how many of each were read. PROGRAM is that of client.c beside this, for libmodbus."""

import json
import math
import re
import socket
import struct
import subprocess
import sys
import time

RECORD = 16
GOOD, BAD_LONG, BAD_SHORT = 192, -0x80000000, -0x8000


class Busy(Exception):
    """owsd has reloaded just now: ask again."""


def with_pymodbus(port, first, count):
    from pymodbus.client import ModbusTcpClient
    client = ModbusTcpClient("127.0.0.1", port=port, timeout=20)
    assert client.connect()
    while True:
        answer = client.read_holding_registers(first, count=count)
        if answer.isError() and getattr(answer, "exception_code", None) == 6:
            yield None
            continue
        assert not answer.isError(), answer
        yield answer.registers


def with_umodbus(port, first, count):
    from umodbus.client import tcp
    from umodbus.exceptions import ServerDeviceBusyError
    with socket.create_connection(("127.0.0.1", port), 20) as connection:
        while True:
            try:
                yield tcp.send_message(tcp.read_holding_registers(1, first, count), connection)
            except ServerDeviceBusyError:
                yield None


def with_mbpoll(port, first, count):
    """A program for each look."""
    while True:
        done = subprocess.run(["mbpoll", "-m", "tcp", "-p", str(port), "-0", "-1", "-t", "4", "-o", "5", "-r", str(first),
                               "-c", str(count), "127.0.0.1"], check=False, capture_output=True, text=True)
        if "busy" in done.stderr:
            yield None
            continue
        assert done.returncode == 0, done
        yield [int(word) for word in re.findall(r"^\[\d+\]:\s+(\d+)", done.stdout, re.M)]


def with_libmodbus(port, first, count):
    with subprocess.Popen([sys.argv[5], str(port), str(first), str(count)], stdout=subprocess.PIPE, text=True) as program:
        for line in program.stdout:
            yield None if "busy" in line else [int(word) for word in line.split()]
    raise AssertionError("it has ended")


def look(record, number):
    """Is the record good? What is not as it has to be is asserted."""
    double, single, whole, short, quality = struct.unpack(">dfihH", struct.pack(">10H", *record[:10]))
    forms = double, single, whole / 10 ** record[14], short / 10 ** record[14]
    if quality == GOOD:
        assert forms == (number,) * 4, (forms, number)
        return True
    assert math.isnan(double) and math.isnan(single) and (whole, short) == (BAD_LONG, BAD_SHORT), (quality, forms)
    return False


def main():
    library, port, seconds, expected = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), json.loads(sys.argv[4])
    counts = {"good": 0, "bad": 0, "busy": 0}
    ends = time.monotonic() + seconds
    for words in globals()[f"with_{library}"](port, RECORD, RECORD * len(expected)):
        if words is None:
            counts["busy"] += 1
        else:
            assert len(words) == RECORD * len(expected), words
            for place, number in enumerate(expected):
                is_good = look(words[RECORD * place:RECORD * (place + 1)], number)
                counts["good" if is_good else "bad"] += 1
        if time.monotonic() > ends:
            break
        time.sleep(0.02)  # pace
    print(json.dumps(counts), flush=True)


if __name__ == "__main__":
    main()
