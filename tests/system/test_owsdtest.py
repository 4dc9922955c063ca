#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tests themselves: one that is ended leaves nothing running."""

import os
import pathlib
import signal
import sys

import owsdtest
from owsdtest import until

SCRIPT = """
import owsdtest, pathlib, threading
def case(scene):
    pathlib.Path(f"pid-{scene.start(['sleep', '600']).pid}").touch()
    threading.Event().wait()
test_one = test_two = test_three = case
owsdtest.main(at_once=%d)
"""


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


def ended(scene, at_once):
    """So many cases run at once when the test is ended: what they have started ends with it."""
    script = scene.file(f"test_{at_once}.py", SCRIPT % at_once)
    tests = scene.start([sys.executable, script], {"PYTHONPATH": str(pathlib.Path(owsdtest.__file__).parent)})
    pids = until(lambda: len(found := [int(p.name[4:]) for p in scene.path.glob("pid-*")]) == at_once and found, 20,
                 lambda: tests.log())
    tests.signal(signal.SIGTERM)
    assert tests.wait() == 143, tests.log()
    for pid in pids:
        os.unlink(scene.path / f"pid-{pid}")
    for pid in pids:
        until(lambda: "sleep" not in command_of(pid), 20, lambda: f"{pid} ends")


def test_a_test_that_is_ended_leaves_no_program(scene):
    ended(scene, 1)


def test_nor_does_one_that_has_cases_in_several_threads(scene):
    ended(scene, 2)


if __name__ == "__main__":
    owsdtest.main()
