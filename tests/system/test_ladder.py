#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tests/check on a small tree: what it runs, remembers, asks for and leaves."""

import os
import re
import shutil
import signal
import subprocess
import sys

import owsdtest
from owsdtest import SOURCE, until

ALWAYS = """[lint]
rung = gate
why = form
run = echo lint >>"$RAN"
seconds = 60
[gcc]
rung = gate
why = programs
run = echo gcc >>"$RAN"
seconds = 60
"""


def suite(name, run, rung="check", **keys):
    lines = [f"[{name}]", f"rung = {rung}", f"why = {name}", f"run = echo {name} >>\"$RAN\"; {run}"]
    return "\n".join(lines + [f"{k} = {v}" for k, v in {"seconds": 60, **keys}.items()]) + "\n"


def is_ended(pid):
    try:
        return owsdtest.state_of(pid) == "Z"
    except FileNotFoundError:
        return True


class Made:
    def __init__(self, scene, *suites):
        self.scene, self.path, self.ran = scene, scene.path / "tree", scene.path / "ran"
        self.write("tests/suites", ALWAYS + "".join(suites))
        shutil.copy(SOURCE / "tests/check", self.path / "tests/check")
        self.write("board/install-deps", "exit 0\n")
        for name in ("main_job.py", "other.py", "last.sh"):
            self.write(f"tests/system/test_{name}", "")
        self.write("src/a.c", "int a;\n")
        self.write("docs/page.md", "page\n")
        self.write(".gitignore", "build/\n")
        self.git("init", "-q", "-b", "main")
        self.git("add", "-A")
        self.git("-c", "user.name=test", "-c", "user.email=test@example.org", "commit", "-q", "-m", "first")

    def write(self, name, text):
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def git(self, *words):
        subprocess.run(["git", *words], cwd=self.path, check=True, timeout=owsdtest.PATIENCE)

    def command(self, *words):
        return [sys.executable, self.path / "tests/check", *words]

    def environment(self):
        return dict(os.environ, RAN=str(self.ran), B="build")

    def check(self, *words):
        """The suites that ran, but for those that always do; its last line; its status."""
        self.ran.write_text("")
        done = subprocess.run(self.command(*words), capture_output=True, text=True, env=self.environment(),
                              timeout=owsdtest.PATIENCE)
        self.said = done.stdout + done.stderr
        return (sorted(set(self.ran.read_text().split()) - {"lint", "gcc"}), done.stdout.splitlines()[-1],
                done.returncode)


def test_what_has_passed_is_not_run_again_until_what_it_reads_changes(scene):
    tree = Made(scene, suite("one", "echo 3 passed, 0 failed"), suite("two", "true", reads="everything"),
                suite("unit", "true", reads="programs"))
    # and the packages, the form and the programs, which are looked after each time
    assert tree.check("--rung", "check") == (["one", "two", "unit"], "8 passed, 0 failed", 0), tree.said
    assert tree.check("--rung", "check") == ([], "5 passed, 0 failed", 0), tree.said
    tree.write("docs/page.md", "other\n")
    assert tree.check("--rung", "check")[0] == ["two"]
    tree.write("tests/system/test_other.py", "other\n")
    assert tree.check("--rung", "check")[0] == ["one", "two"]
    tree.write("src/new.c", "int b;\n")
    assert "left: one two unit" in (tree.check("--rung", "check"), tree.said)[1]
    assert tree.check("one")[0] == [] and tree.check("--again", "one")[0] == ["one"]


def test_what_fails_is_told_and_run_again(scene):
    tree = Made(scene, suite("bad", "echo 2 passed, 1 failed, 4 skipped; false"), suite("worse", "exit 3"),
                suite("good", "true"), suite("slow", "sleep 200", seconds=1))
    ran, line, status = tree.check("--rung", "check")
    assert ran == ["bad", "good", "slow", "worse"] and status == 1, tree.said
    assert line == "6 passed, 3 failed, 4 skipped", tree.said
    for name in ("bad", "worse", "slow"):
        assert f"=== FAIL {name}\n" in tree.said
    assert "slow: took more than 1 s" in tree.said
    assert tree.check("--rung", "check")[0] == ["bad", "slow", "worse"]


def test_status_other_than_0_with_no_failure_counted_is_a_failure(scene):
    tree = Made(scene, suite("odd", "echo 2 passed, 0 failed; exit 1"))
    assert tree.check("odd")[1:] == ("5 passed, 1 failed", 1), tree.said


def test_the_gate_runs_all_of_it_each_time_and_in_order(scene):
    tree = Made(scene, suite("third", "true", rung="gate"), suite("other", "true"))
    for _ in range(2):
        assert tree.check("--rung", "gate") == (["third"], "4 passed, 0 failed", 0), tree.said
        assert tree.ran.read_text().split() == ["lint", "gcc", "third"]
        assert re.search(r"=== third: status 0, 1 passed, 0 failed, 0 skipped, \d+ s", tree.said), tree.said


def test_what_was_broken_off_goes_on_and_nothing_of_it_is_left(scene):
    pid, go = scene.path / "pid", scene.path / "go"
    tree = Made(scene, suite("one", "true", row="tests"),
                suite("two", f"[ ! -e {go} ] || exit 0; sleep 300 & echo $! >{pid}.new; mv {pid}.new {pid}; wait",
                      row="tests"))
    tree.ran.write_text("")
    child = subprocess.Popen(tree.command("--rung", "check"), env=tree.environment(), stdout=subprocess.DEVNULL)
    until(pid.exists, 30, "the second suite runs")
    child.send_signal(signal.SIGTERM)
    assert child.wait(owsdtest.PATIENCE) == 128 + signal.SIGTERM
    assert is_ended(pid.read_text().strip())
    go.touch()
    ran, _, status = tree.check("--rung", "check")
    assert ran == ["two"] and status == 0, tree.said


def test_a_suite_leaves_no_process_of_whatever_session(scene):
    pids = [scene.path / name for name in ("same", "other", "deaf")]
    begun = ["", "setsid ", "setsid sh -c 'trap \"\" TERM; exec \"$@\"' sh "]
    tree = Made(scene, suite("one", "; ".join(
        f"{how}sh -c 'echo $$ >{pid}.new; mv {pid}.new {pid}; exec sleep 300' >/dev/null 2>&1 & "
        f"while [ ! -e {pid} ]; do sleep 0.1; done" for how, pid in zip(begun, pids))))
    assert tree.check("one")[2] == 0, tree.said
    assert all(is_ended(pid.read_text().strip()) for pid in pids)


def test_a_change_asks_for_the_suites_that_name_its_path(scene):
    tree = Made(scene, suite("one", "true", paths="src/a.c hal"), suite("two", "true", paths="*.md board"),
                suite("three", "true", paths="src"))
    assert tree.check("--touched", "main")[1] == "none"
    assert tree.check("none") == ([], "0 passed, 0 failed", 0), tree.said
    tree.write("src/new.c", "")
    assert tree.check("--touched")[1] == "three"
    tree.write("src/a.c", "int c;\n")
    tree.write("docs/page.md", "other\n")
    assert tree.check("--touched", "main")[1] == "one two three", tree.said
    assert "one        for src/a.c: one" in tree.said


def test_each_system_test_is_of_a_suite(scene):
    tree = Made(scene, suite("one", "true", rung="gate", tests="main_job"), suite("all", "true", tests="* !last"),
                suite("others", "true", tests="rest"))
    assert tree.check("--tests", "one")[1] == "test_main_job.py"
    assert tree.check("--tests", "all")[1] == "test_main_job.py test_other.py"
    assert tree.check("--tests", "others")[1] == "test_last.sh test_other.py"


def test_the_rest_of_the_system_tests_runs_with_what_the_table_gives_it(scene):
    tree = Made(scene, suite("one", "true", rung="gate", tests="main_job"),
                suite("others", 'echo "$TESTS" >given', tests="rest"))
    assert tree.check("others")[::2] == (["others"], 0), tree.said
    assert (tree.path / "given").read_text().split() == ["test_last.sh", "test_other.py"]


def test_a_suite_that_cannot_be_begun_has_failed(scene):
    tree = Made(scene, suite("one", "true"), suite("two", "true", seconds="soon"))
    for words in (["two"], ["one", "two"]):
        assert tree.check(*words)[2] == 1, tree.said
        assert "=== FAIL two" in tree.said, tree.said


def test_the_table_asks_for_what_a_change_can_break(scene):
    """Of the table itself."""
    for file, wanted in (("hal/w1/master.c", {"kernel"}), ("src/public/ows_layout.h", {"model", "kill", "tsan"}),
                         ("Makefile", {"fresh", "deb", "dist"}), ("board/install-deps", {"fresh", "deb", "dist"}),
                         ("src/history/file/keep.c", {"system", "mqtt"}), ("src/faces/kit/post.c", {"system"}),
                         ("hal/base/time.h", {"system", "units"}), ("src/ground/signal/value.c", {"system"}),
                         ("hal/gpio/gpio.c", {"gpio", "gpio-pi"}), ("docs/design.md", {"docs"})):
        done = subprocess.run([sys.executable, "-c", "import importlib.machinery, importlib.util, sys\n"
                               "sys.dont_write_bytecode = True\n"
                               "loader = importlib.machinery.SourceFileLoader('check', sys.argv[1])\n"
                               "check = importlib.util.module_from_spec(importlib.util.spec_from_loader('check', loader))\n"
                               "loader.exec_module(check)\n"
                               "print(*check.asked(check.table(), [sys.argv[2]]))", SOURCE / "tests/check", file],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=True)
        assert wanted <= set(done.stdout.split()), (file, done.stdout)


if __name__ == "__main__":
    owsdtest.main()
