#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""README.md word by word: its blocks are pasted into two terminals, on the simulated house."""

import os
import pty
import re
import select
import signal
import subprocess
import time

import handbook
import owsdtest

README = owsdtest.SOURCE / "README.md"


def use_it():
    """The first blocks of "Use it": to install, to start, and for another terminal."""
    text = README.read_text()
    first = text.count("\n", 0, text.index("\n## Use it")) + 2
    last = text.count("\n", 0, text.index("\nIn a C program"))
    return [b.text for b in handbook.blocks(README) if first < b.line < last and b.language == "sh"]


class Terminal:
    """A shell on a terminal of its own, in a folder that looks like the source."""

    def __init__(self, path):
        environment = {"PATH": f"{owsdtest.BUILD}:{os.environ['PATH']}", "TERM": "vt100",
                       "OWS_DIR": os.environ["OWS_DIR"], "PS1": "", "LC_ALL": "C.UTF-8",
                       **{k: v for k, v in os.environ.items() if "SAN_OPTIONS" in k}}
        try:
            self.pid, self.master = pty.fork()
        except OSError as why:
            owsdtest.skip(f"no pseudo-terminal to be had: {why}")
        if self.pid == 0:
            os.chdir(path)
            os.execve("/bin/sh", ["sh"], environment)
        self.text = ""

    def paste(self, text):
        os.write(self.master, text.encode())

    def shows(self, pattern):
        """Read until the terminal has shown it."""
        deadline = time.monotonic() + owsdtest.PATIENCE
        while not (found := re.search(pattern, self.text)):
            if time.monotonic() > deadline:
                raise owsdtest.Late(f"{pattern!r} is not shown:\n{self.text[-4000:]}")
            if select.select([self.master], [], [], 0.1)[0]:
                self.text += os.read(self.master, 65536).decode(errors="replace")
        return found

    def interrupt(self):
        """Ctrl-C ends what runs in front. To owsd, the SIGHUP of a window that closes is a reload."""
        self.paste("\x03")
        self.paste("echo en''ded\n")
        self.shows(r"\r\nended\r\n")

    def close(self):
        """The terminal is closed, as by its window."""
        os.close(self.master)
        os.kill(self.pid, signal.SIGHUP)
        os.waitpid(self.pid, 0)


def test_the_blocks_of_use_it_work_when_they_are_pasted(scene):
    install, start, other = use_it()
    assert "make" in install and start.startswith("TARGET=sim:"), (install, start)
    (scene.path / "board").symlink_to(owsdtest.SOURCE / "board")
    scene.names.append("OWS")
    first = Terminal(scene.path)
    try:
        first.paste(start)
        first.shows(r"from down to up")
        good = [owsdtest.OWSCTL, "get", "temperature1"]
        scene.until(lambda: subprocess.run(good, capture_output=True, check=False).returncode == 0,
                    20, "a value")
        assert not re.search(r"error|warning", first.text), first.text
        second = Terminal(scene.path)
        try:
            assert "set -w 5 outputs1 5 " in other, other
            second.paste(other.replace("set -w 5 ", "set -w 60 "))  # a sanitizer takes its time
            second.shows(r"\ntemperature1 +12\.5 .* in ")  # list
            second.shows(r"\r\n12\.5\r\n")  # get
            second.shows(r"\x1b\[\?1049h")  # the screen of watch
            assert not re.search(r"owsctl: ", second.text), second.text
            second.paste("q")
            second.shows(r"\x1b\[\?1049l")
            second.paste("owsctl get outputs1\n")
            second.shows(r"(?:\n|\x1b\[\?1049l)5\r\n")  # what set wrote; watch may have taken the echo
        finally:
            second.close()
    finally:
        try:
            first.interrupt()
        finally:
            first.close()


if __name__ == "__main__":
    owsdtest.main()
