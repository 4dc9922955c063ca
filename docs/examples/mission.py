#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Starts, stops, shows and downloads the mission of a logger: DS1921, DS1922, DS1923, DS2422.

    python3 mission.py [-n NAME | -t TARGET] start [-o] -i SECONDS DEVICE
    python3 mission.py [-n NAME | -t TARGET] stop | status [--json] | download [--json] DEVICE

It asks by owsctl read and owsctl write, whose -n and -t these are.
"""

import argparse
import datetime
import json
import os
import subprocess
import sys
import time

OWSCTL = os.environ.get("OWSCTL", "owsctl")
AT_ONCE = 128  # samples that are asked for together
TRIES = 3
CACHED_S = 5 * 60  # a cache may have the page of an older sample: it was whole that long ago
FIRST_CLOCK = datetime.datetime(2026, 1, 1, tzinfo=datetime.timezone.utc).timestamp()


def utc(seconds):
    return datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


class Logger:
    def __init__(self, device, options):
        self.device, self.options = device.strip("/"), options
        family = self.read(["family"])[0]
        self.minutes = family == "21"
        if family not in ("21", "41"):
            sys.exit(f"{device}: no logger; they have the families 21 and 41")

    def read(self, properties, fresh=True, tries=1):
        """Their values as texts, read past all caches unless fresh is False."""
        paths = [f"{'/uncached' if fresh else ''}/{self.device}/{name}" for name in properties]
        for _ in range(tries):
            done = subprocess.run([OWSCTL, *self.options, "--json", "read", *paths], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, check=False)
            if done.returncode == 0:
                answers = json.loads(done.stdout, parse_int=str, parse_float=str)
                return [answer["value"] for answer in answers]
        sys.stderr.write(done.stderr)
        sys.exit(1)

    def number(self, name):
        return float(self.read([name])[0])

    def write(self, name, value):
        if subprocess.run([OWSCTL, *self.options, "write", f"/{self.device}/{name}", f"{value:.0f}"],
                          check=False).returncode:
            sys.exit(1)

    def interval(self):
        """Seconds between two samples; a DS1921 has minutes."""
        return 60 * self.number("mission/frequency") if self.minutes else self.number("mission/interval")


def start(logger, wanted):
    interval, rollover = wanted.interval, wanted.rollover
    if logger.minutes and not (60 <= interval <= 255 * 60 and interval % 60 == 0):
        wanted.refuse("-i 60 to 15300 seconds, in whole minutes")
    if not logger.minutes and not (1 <= interval <= 16383 or (interval <= 16383 * 60 and interval % 60 == 0)):
        wanted.refuse("-i 1 to 16383 seconds, or whole minutes")
    if time.time() < FIRST_CLOCK:
        sys.exit(f"{wanted.device}: the clock of this computer is not set: no mission can be given its time")
    if logger.number("mission/running"):
        sys.exit(f"{wanted.device}: a mission runs; stop it first")
    logger.write("clock/udate", time.time())
    logger.write("clock/running", 1)
    logger.write("mission/delay", 0)
    logger.write("mission/rollover", rollover)
    if logger.minutes:  # it runs when its interval is written
        logger.write("mission/enable", 1)
        logger.write("mission/clear", 1)
        logger.write("mission/frequency", interval / 60)
    else:  # these when they are started
        logger.write("mission/interval", interval)
        logger.write("mission/running", 1)
    if not logger.number("mission/running"):
        sys.exit(f"{wanted.device}: the mission has not begun")
    # another program that starts one at the same time may have written its own settings between
    theirs, over = logger.interval(), bool(logger.number("mission/rollover"))
    if (theirs, over) != (interval, rollover):
        sys.exit(f"{wanted.device}: another program started a mission at the same time: it has an interval of "
                 f"{theirs:.0f} s, {'with' if over else 'without'} rollover; stop it first")


def stop(logger, _wanted):
    logger.write("mission/running", 0)


def status(logger, wanted):
    running, samples, logged, rollover, clock = (float(text) for text in logger.read([
        "mission/running", "mission/samples", "log/elements", "mission/rollover", "clock/udate"]))
    shown = {"running": running != 0, "begin": utc(logger.number("log/udate.0")) if logged else None,
             "interval": int(logger.interval()), "samples": int(samples), "logged": int(logged),
             "rollover": rollover != 0, "clock": utc(clock)}
    if wanted.json:
        print(json.dumps(shown))
        return
    for name, value in shown.items():
        text = {"True": "yes", "False": "no", "None": "-"}.get(str(value), value)
        print(f"{name:9} {text}{' s' if name == 'interval' else ''}")


def download(logger, wanted):
    elements, samples, running, clock = (float(text) for text in logger.read([
        "log/elements", "mission/samples", "mission/running", "clock/udate"]))
    elements, interval = int(elements), logger.interval()
    moves = running and samples > elements  # the log is full and rolls over: each place gets another sample
    names = ["temperature"]
    if not logger.minutes and logger.number("mission/samplinghumidity"):
        names.append("humidity")
    begin = logger.number("log/udate.0") if elements else 0
    rows = []
    for first in range(0, elements, AT_ONCE):
        count = min(AT_ONCE, elements - first)
        last = begin + interval * (first + count - 1)
        young = moves or first + count == elements or last + CACHED_S >= clock
        values = logger.read([f"log/{name}.{i}" for i in range(first, first + count) for name in names], young, TRIES)
        rows += [(utc(begin + interval * (first + i)), *values[i * len(names):(i + 1) * len(names)])
                 for i in range(count)]
    if elements and logger.number("log/udate.0") != begin:
        sys.exit(f"{wanted.device}: the log rolled over meanwhile; stop the mission, or download again")
    if wanted.json:
        print(json.dumps([{"time": row[0], **dict(zip(names, map(float, row[1:])))} for row in rows]))
        return
    print(",".join(["time", *names]))
    for row in rows:
        print(",".join(row))


def main():
    parser = argparse.ArgumentParser(description="The mission of a logger, by owsctl.")
    parser.add_argument("-n", metavar="NAME", help="the instance of owsd")
    parser.add_argument("-t", metavar="TARGET", help="what owsctl opens, in place of an owsd")
    words = parser.add_subparsers(required=True)
    for run in (start, stop, status, download):
        word = words.add_parser(run.__name__)
        word.set_defaults(run=run, refuse=word.error)
        word.add_argument("device")
        if run is start:
            word.add_argument("-i", dest="interval", type=float, required=True, help="seconds between two samples")
            word.add_argument("-o", dest="rollover", action="store_true", help="the oldest samples make room")
        elif run is not stop:
            word.add_argument("--json", action="store_true")
    wanted = parser.parse_args()
    options = [*(["-n", wanted.n] if wanted.n else []), *(["-t", wanted.t] if wanted.t else [])]
    wanted.run(Logger(wanted.device, options), wanted)


if __name__ == "__main__":
    main()
