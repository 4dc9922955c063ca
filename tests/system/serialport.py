# SPDX-License-Identifier: MIT
"""Simulated serial adapters (serial.c), for owsd and for the genuine programs.

    adapter = serialport.Adapter(scene, HOUSE, "--ds2480b", "--strict")
    adapter.name                    # /dev/pts/N
    adapter("unplug kitchen")       # a command, and its answer
    adapter.stats()["overruns"]
    adapter.pull()                  # as a USB adapter is: its file is gone
"""

import os
import subprocess

import owsdtest

# For genuine programs, which flush more than a pseudo-terminal bears
GENUINE = {"LD_PRELOAD": str(owsdtest.BUILD / "system/serial.so")}


class Adapter(owsdtest.Program):
    def __init__(self, scene, house, *options):
        program = owsdtest.BUILD / "system/serial"
        owsdtest.need(program)
        self.command = [str(program), *options, str(scene.file("serial.sim", house))]
        self.log_path = scene.file("serial.log", "")
        with open(self.log_path, "wb") as log:
            self.process = subprocess.Popen(self.command, text=True, stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=log)
        self.pid = self.process.pid
        scene.programs.append(self)
        self.name = self.process.stdout.readline().strip()
        assert self.name, "the simulated adapter did not start"

    def __call__(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().strip()

    def stats(self):
        words = self("stats").split()
        return {name: int(value) for name, value in zip(words[::2], words[1::2])}

    def pull(self):
        self.kill()


def environment():
    return dict(os.environ, **GENUINE)
