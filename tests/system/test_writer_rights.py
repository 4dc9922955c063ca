#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-writer as its service runs it, under the unit's filter, beside an owsd as its service runs it:
who may ask, and who may read the file afterwards. As genuine users."""

import os
import re
import shutil
import time

import faulty
import owsdtest
import private
import sandbox
import writing
from owsdtest import until
from test_privilege import as_user, daemon_of, good, programs
from writing import activated, ask, order, tag, tag_of

CONFIG, OWSD = private.CONFIG, private.OWSD
WRITER, STRANGER = private.USERS["owsd-writer"][0], private.USERS["stranger"][0]
EDITOR = private.USERS["editor"][0]
UNIT = sandbox.UNITS / "owsd-writer@.service"
ASK = """
import socket, sys
door = socket.socket(socket.AF_UNIX)
door.connect(sys.argv[1])
try:
    door.sendall(sys.stdin.buffer.read() if len(sys.argv) < 3 else bytes.fromhex(sys.argv[2]))
except BrokenPipeError:
    pass
while data := door.recv(65536):
    print(data.decode(), end="")
"""


class Service:
    """A directory of the writer's user, owsd with the file in it, and the writer."""

    def __init__(self, scene, mode=0o660):
        self.scene = scene
        self.daemon = daemon_of(scene)
        good(scene, self.daemon.name)
        self.folder = scene.path / "etc"
        self.folder.mkdir()
        os.chown(self.folder, WRITER, 0)
        self.folder.chmod(0o755)
        # the file of owsd is a link into it, as where an administrator keeps it elsewhere
        self.file = self.folder / "OWS.rio"
        shutil.copy(self.daemon.config, self.file)
        self.daemon.config.unlink()
        self.daemon.config.symlink_to(self.file)
        self.socket = scene.path / f"config{mode:o}"
        self.program = programs() / "owsd-writer"
        shutil.copy(owsdtest.with_sim(writing.PROGRAM, self.file), self.program)
        filtered = sandbox.command(UNIT)
        shutil.copy(filtered[0], programs())
        filtered[0] = str(programs() / "sandbox")
        self.writer = scene.start([
            *activated(self.socket, *private.as_user("owsd-writer"), "sh", "-c",
                       'umask 0022; LISTEN_PID=$$ exec "$@"', "sh", *filtered, self.program,
                       "-n", self.daemon.name, "-c", self.file)])
        until(self.socket.exists, 20, self.writer.log)
        os.chown(self.socket, 0, CONFIG)
        self.socket.chmod(mode)

    def ask_as(self, who, data):
        return as_user(self.scene, who, "/usr/bin/python3", "-c", ASK, self.socket, data.hex())

    def give(self, text, owner, group, mode):
        self.file.unlink(missing_ok=True)
        self.file.write_text(text)
        os.chown(self.file, owner, group)
        self.file.chmod(mode)

    def rights(self, file=None):
        st = (file or self.file).stat()
        return st.st_uid, st.st_gid, oct(st.st_mode & 0o7777)


def test_who_may_ask_and_who_may_not(scene):
    service = Service(scene)
    text = service.file.read_text() + "# by the editor\n"
    data = order(tag_of(service.file), text.encode(), "anna")
    for who in ("reader", "plc", "setter", "stranger"):
        refused = service.ask_as(who, data)
        assert refused.returncode == 1 and "PermissionError" in refused.stderr, (who, refused)
    # owsd is in the group to serve it, and may not change what it is to do
    refused = writing.Answer(service.ask_as("owsd", data).stdout)
    assert refused.status == "refused" and "without the user owsd" in refused.text, refused.text
    done = service.ask_as("editor", data)
    answer = writing.Answer(done.stdout)
    assert (answer.status, answer.reload) == ("done", "done"), (done, service.writer.log())
    assert service.file.read_text() == text
    until(lambda: f"by user {EDITOR} (process" in service.writer.log() and
          'for "anna": done' in service.writer.log(), 20, service.writer.log)
    until(lambda: re.search(rf'asked for by "owsd-writer" \(process \d+, user {WRITER}\)', service.daemon.log()),
          20, service.daemon.log)


SLOW = """
import socket, sys, time
doors = [socket.socket(socket.AF_UNIX) for _ in range(20)]
for door in doors:
    door.connect(sys.argv[1])
    door.sendall(b"owsd-writer 1\\n")
print("there", flush=True)
answers = [door.recv(4096).decode() for door in doors]
print("over", sum("too many requests" in text for text in answers),
      sum("longer than ten seconds" in text for text in answers), flush=True)
"""


def test_slow_requests_of_a_user_keep_no_other_user_waiting(scene):
    service = Service(scene)
    slow = scene.start([*private.as_user("editor"), "/usr/bin/python3", "-c", SLOW, service.socket])
    until(lambda: "there" in slow.log(), 20, slow.log)
    begun = time.monotonic()
    answer = writing.Answer(service.ask_as("owsd-writer", order(tag_of(service.file), b"nonsense")).stdout)
    assert answer.status == "invalid" and time.monotonic() - begun < 8, answer.text
    until(lambda: "over 16 4" in slow.log(), 60, slow.log)


def test_at_a_socket_that_is_open_to_all_the_kernels_word_decides(scene):
    service = Service(scene, 0o666)
    old = service.file.read_text()
    data = order(tag_of(service.file), (old + "#\n").encode())
    for who in ("reader", "plc", "setter", "stranger", "owsd"):
        answer = writing.Answer(service.ask_as(who, data).stdout)
        assert answer.status == "refused" and "the group owsd-config" in answer.why, (who, answer.text)
    assert service.file.read_text() == old and "reload" not in service.daemon.log()
    for who in ("editor", "owsd-writer"):
        data = order(tag_of(service.file), (service.file.read_text() + "#\n").encode())
        assert writing.Answer(service.ask_as(who, data).stdout).status == "done", who


def test_nobody_loses_or_gains_the_right_to_read(scene):
    service = Service(scene)
    house = faulty.house(scene)
    for path in scene.path.iterdir():
        if path.is_file():
            os.chmod(path, 0o644)
    for n, (owner, group, mode, then) in enumerate((
            (0, 0, 0o644, (WRITER, CONFIG, 0o644)),
            (0, OWSD, 0o640, (WRITER, OWSD, 0o640)),
            (OWSD, OWSD, 0o640, (WRITER, OWSD, 0o640)),
            (OWSD, OWSD, 0o440, (WRITER, OWSD, 0o440)),
            (WRITER, OWSD, 0o640, (WRITER, OWSD, 0o640)),
            (0, OWSD, 0o660, (WRITER, OWSD, 0o660)),
            (0, 0, 0o664, (WRITER, CONFIG, 0o644)),
            (STRANGER, 0, 0o644, (WRITER, CONFIG, 0o644)),
            # the owner would lose it
            (STRANGER, OWSD, 0o640, None),
            (OWSD, CONFIG, 0o640, None),
            # the writer itself cannot read it
            (0, 0, 0o640, None),
            (0, 0, 0o600, None))):
        text = house + f"# {n}\n"
        service.give(text, owner, group, mode)
        before = service.rights()
        answer = ask(service.socket, order(tag_of(service.file), (text + "# new\n").encode()))
        if then is None:
            assert answer.status == "error" and ("chgrp" in answer.why or "ermission" in answer.why), (
                n, answer.text)
            assert service.rights() == before and service.file.read_text() == text
        else:
            assert (answer.status, answer.reload) == ("done", "done"), (n, answer.text)
            for file in (service.file, service.folder / "OWS.rio.before"):
                assert service.rights(file) == (*then[:2], oct(then[2])), (n, service.rights(file))
            assert as_user(scene, "owsd", "cat", service.file).returncode == 0


def test_a_first_file_is_for_all_to_read_and_a_foreign_directory_is_left_alone(scene):
    service = Service(scene)
    text = service.file.read_text()
    service.file.unlink()
    answer = ask(service.socket, order("", text.encode()))
    assert (answer.status, answer.reload) == ("done", "done"), answer.text
    assert service.rights() == (WRITER, CONFIG, oct(0o644))
    os.chown(service.folder, 0, 0)
    answer = ask(service.socket, order(tag(text.encode()), (text + "#\n").encode()))
    assert answer.status == "error" and "Permission denied" in answer.why, answer.text
    assert service.file.read_text() == text and os.listdir(service.folder) == ["OWS.rio"]


if __name__ == "__main__":
    private.main(users=True)
