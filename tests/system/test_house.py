#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tools of the system tests: what they promise about owserver and about cleaning up."""

import os
import pathlib
import signal
import subprocess
import sys

import owsdtest

RUN = owsdtest.SOURCE / "tests/system/run"


def run_script(scene, name, text, limit=100):
    """The runner on one test of the given text: its output, its status."""
    done = subprocess.run([sys.executable, RUN, scene.file(name, text)], text=True, timeout=150,
                          capture_output=True, env=dict(os.environ, LIMIT=str(limit)))
    return done.stdout, done.returncode


def test_a_mock_device_holds_what_was_written(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices()[0] + "/temperature"
    server.write(path, 21.5)
    assert float(server.read(path)) == 21.5


def test_ids_of_simulated_devices_are_the_same_in_every_run(scene):
    first = scene.owserver(tester=["29"], mock=["28", "26"])
    before = first.devices()
    assert len(before) == 3
    first.kill()
    assert scene.again(first).devices() == before


def test_a_shell_test_passes_skips_and_fails_by_its_status(scene):
    out, status = run_script(scene, "test_a.sh", "exit 0\n")
    assert out.endswith("1 passed, 0 failed\n") and status == 0
    out, status = run_script(scene, "test_b.sh", "echo no such thing here; exit 77\n")
    assert "skip test_b: no such thing here" in out
    assert out.endswith("0 passed, 0 failed, 1 skipped\n") and status == 1
    out, status = run_script(scene, "test_c.sh", "exit 3\n")
    assert "status 3" in out and status == 1


def test_a_test_that_takes_too_long_is_ended_and_failed(scene):
    out, status = run_script(scene, "test_long.sh", "sleep 200\n", limit=1)
    assert "took more than 1 s" in out and status == 1


def test_a_file_left_in_the_current_folder_is_named(scene):
    """A person starts a Python test in the source."""
    text = "open('litter', 'w').close()\nprint('1 passed, 0 failed')\n"
    out, status = run_script(scene, "test_litter.py", text)
    assert "left in the current folder: litter" in out and status == 1, out


def test_a_process_left_in_another_session_is_found_and_ended(scene):
    pid_file = scene.path / "pid"
    out, status = run_script(scene, "test_left.sh",
                             f"setsid sh -c 'echo $$ > {pid_file}; exec sleep 200' &\n"
                             f"while [ ! -s {pid_file} ]; do sleep 0.01; done\n")
    assert "left running" in out and "sleep 200" in out and status == 1
    assert not pathlib.Path("/proc", pid_file.read_text().strip()).exists()


def test_a_python_test_without_cases_fails(scene):
    out, status = run_script(scene, "test_none.py", "import owsdtest\nowsdtest.main()\n")
    assert "no case in it" in out and status == 1


def test_a_case_ends_what_it_started(_scene):
    with owsdtest.Scene() as inner:
        sleeper = inner.start(["sleep", "200"])
        sleeper.freeze()
    assert sleeper.process.returncode == -signal.SIGTERM
    assert not inner.path.exists()


if __name__ == "__main__":
    owsdtest.main()
