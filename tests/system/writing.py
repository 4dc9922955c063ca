# SPDX-License-Identifier: MIT
"""owsd-writer beside an owsd, and programs that ask it.

    writer = writing.Writer(scene, file, name)
    answer = writer.replace(text)           # for the file as it is
    answer.status, answer.tag, answer.problems
"""

import os
import socket
import sys

import owsdtest

PROGRAM = owsdtest.BUILD / "owsd-writer"


def tag(data):
    """FNV-1a of 64 bits."""
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return f"{value:016x}"


def tag_of(path):
    return tag(path.read_bytes()) if path.exists() else ""


class Answer:
    def __init__(self, text):
        assert text.endswith("\n\n") and text.count("\n\n") == 1, text
        lines = [line.partition(": ")[::2] for line in text.splitlines() if line]
        self.problems = [value for key, value in lines if key == "problem"]
        found = dict(lines)
        self.text, self.status, self.tag = text, found["status"], found.get("tag")
        self.reload, self.why, self.backup = (found.get(k) for k in ("reload", "why", "backup"))


def connect(path, seconds=60):
    door = socket.socket(socket.AF_UNIX)
    door.settimeout(seconds)
    door.connect(str(path))
    return door


def answer_of(door):
    data = b""
    while True:
        try:
            more = door.recv(65536)
        except ConnectionResetError:
            more = b""
        if not more:
            return Answer(data.decode())
        data += more


def order(base, body=None, person=None, do="replace"):
    lines = ["owsd-writer 1", f"do: {do}"]
    lines += [f"base: {base}"] if base is not None else []
    lines += [f"for: {person}"] if person else []
    lines += [f"length: {len(body)}"] if body is not None else []
    return "\n".join(lines).encode() + b"\n\n" + (body or b"")


def ask(path, data):
    with connect(path) as door:
        try:
            door.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            pass
        return answer_of(door)


# What a service manager does: the socket is descriptor 3
ACTIVATE = """
import os, socket, sys
door = socket.socket(socket.AF_UNIX)
door.bind(sys.argv[1] + ".new")
door.listen(4)
os.rename(sys.argv[1] + ".new", sys.argv[1])  # where it is found it listens
os.dup2(door.fileno(), 3)
os.set_inheritable(3, True)
os.environ.update(LISTEN_PID=str(os.getpid()), LISTEN_FDS="1")
os.execvp(sys.argv[2], sys.argv[2:])
"""


def activated(path, *command):
    """The command that runs another with a socket of the service manager there."""
    return [sys.executable, "-c", ACTIVATE, path, *command]


class Writer(owsdtest.Program):
    def __init__(self, scene, file, name, *options, prefix=(), env=None):
        self.file, self.name, self.socket = file, name, owsdtest.segment(name, "config")
        program = owsdtest.with_sim(PROGRAM, file)
        super().__init__(scene, [*prefix, program, "-n", name, "-c", file, *options], env)
        owsdtest.until(self.listens, 20, self.log)

    def listens(self):
        try:
            connect(self.socket).close()
        except OSError:
            assert self.process.poll() is None, self.log()
            return False
        return True

    def replace(self, text, base=None, person=None):
        base = tag_of(self.file) if base is None else base
        return ask(self.socket, order(base, text.encode(), person))

    def restore(self, base=None, person=None):
        base = tag_of(self.file) if base is None else base
        return ask(self.socket, order(base, None, person, "restore"))

    def rename(self, names, person=None):
        return ask(self.socket, order(None, names.encode(), person, "rename"))

    def before(self):
        return self.file.with_name(self.file.name + ".before")

    def beside(self):
        """All that stands in the directory of the file and begins as it does."""
        return sorted(f for f in os.listdir(self.file.parent) if f.startswith(self.file.name))
