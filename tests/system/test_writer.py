#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-writer: a new configuration is checked, kept, put in place whole, and served."""

import concurrent.futures
import os
import resource
import shutil
import socket
import subprocess
import time

import owsdtest
import writing
from owsdtest import logged, until
from test_reload import CELLAR, RELAYS, ROOM, house, rio
from writing import Writer, activated, ask, order, tag, tag_of


def start(scene, *items):
    target = house(scene)
    daemon = scene.owsd(rio(target, *(items or (ROOM,))))
    return daemon, Writer(scene, daemon.config, daemon.name), target


def alone(scene, text=None, **more):
    """A writer without an owsd."""
    folder = scene.path / "etc"
    folder.mkdir()
    file = folder / "ALONE.rio"
    if text is not None:
        file.write_text(text)
    return Writer(scene, file, scene.name(), **more)


def test_a_new_text_is_kept_and_served_before_the_answer_comes(scene):
    daemon, writer, target = start(scene)
    old, new = daemon.config.read_text(), rio(target, ROOM, CELLAR) + "# žluťoučký\n"
    done = writer.replace(new, person="anna")
    assert (done.status, done.reload, done.why) == ("done", "done", None), done.text
    assert daemon.config.read_text() == new and done.tag == tag(new.encode())
    assert scene.owsctl(daemon, "list", "cellar").returncode == 0
    assert writer.before().read_text() == old
    kept, when = done.backup.split()
    assert kept == tag(old.encode()) and abs(int(when) / 1000 - time.time()) < 600
    assert writer.beside() == [daemon.config.name, writer.before().name]
    until(lambda: f'by user {os.getuid()} (process {os.getpid()}) for "anna": done' in writer.log(), 10,
          writer.log)
    assert writer.stop() == 0 and not writer.socket.exists()


def test_a_text_for_another_file_than_the_present_is_a_conflict(scene):
    daemon, writer, target = start(scene)
    base = tag_of(daemon.config)
    daemon.config.write_text(rio(target, ROOM, RELAYS))
    for answer in (writer.replace(rio(target, CELLAR), base), writer.replace(rio(target, CELLAR), ""),
                   writer.restore(base)):
        assert answer.status == "conflict" and answer.tag == tag_of(daemon.config), answer.text
        assert answer.reload is None, answer.text
    assert daemon.config.read_text() == rio(target, ROOM, RELAYS) and not writer.before().exists()


def test_an_invalid_text_is_not_written_and_its_problems_have_their_places(scene):
    daemon, writer, target = start(scene)
    old = daemon.config.read_text()
    for text, where, words in (
            (rio(target, ROOM).replace("Type", "Typ", 1), "E ", "Typ"),
            ("OwsDrv {\n  Period 0\n}\n", "E 2 ", "Period"),
            ("OwsDrv {\n", "E ", ""),
            ("OwsDrv {\n  TargetName \"nowhere:1:2:3\"\n}\n", "E 2 ", "nowhere"),
            ("OwsDrv {\n  TargetName \"sim:missing.sim\"\n}\n", "E 2 ", "missing.sim")):
        answer = writer.replace(text)
        assert answer.status == "invalid" and answer.tag == tag(old.encode()), answer.text
        assert any(p.startswith(where) and words in p for p in answer.problems), answer.text
    assert daemon.config.read_text() == old and writer.beside() == [daemon.config.name]
    assert "reload" not in daemon.log()


def test_check_reports_what_is_wrong_and_serves_nothing(scene):
    def check(text):
        file = scene.file("check.rio", text) if text else scene.path / "none.rio"
        return subprocess.run([writing.PROGRAM, "--check", "-n", scene.name(), "-c", file],
                              cwd=scene.path, text=True, capture_output=True, timeout=20)
    done = check(rio("localhost:4304", ROOM))
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    for text, words in (("", "none.rio: error: cannot be read"),
                        ("OwsDrv {\n  Period 0\n}\n", "check.rio:2:"),
                        ('OwsDrv {\n  TargetName "nowhere:1:2:3"\n}\n', "nowhere")):
        done = check(text)
        assert done.returncode == 2 and words in done.stderr, (done.returncode, done.stderr)


def test_files_that_a_text_names_are_looked_for_as_owsd_does(scene):
    target = f"sim:{scene.file('few.sim', 'chip DS2482-100 0x18' + chr(10))}"
    writer = alone(scene, f'OwsDrv {{\n  TargetName "{target}"\n}}\n')
    text = (f'OwsDrv {{\n  TargetName "{target}"\n  Bus {{\n    Target "{target}"\n'
            f'    Sensors "{writer.file.parent}/mine.table"\n  }}\n}}\n')
    answer = writer.replace(text)
    assert answer.status == "invalid" and any("mine.table" in p for p in answer.problems), answer.text
    table = next((owsdtest.SOURCE / "docs/examples").glob("*.table"))
    shutil.copy(table, writer.file.parent / "mine.table")
    answer = writer.replace(text)
    assert answer.status == "done", answer.text


def test_a_restore_is_undone_by_another(scene):
    daemon, writer, target = start(scene)
    old, new = daemon.config.read_text(), rio(target, CELLAR)
    answer = writer.restore()
    assert answer.status == "refused" and "nothing was saved before" in answer.why, answer.text
    assert writer.replace(new).status == "done"
    for present, before, has in ((old, new, "room"), (new, old, "cellar"), (old, new, "room")):
        done = writer.restore(person="anna")
        assert (done.status, done.reload) == ("done", "done"), done.text
        assert daemon.config.read_text() == present and writer.before().read_text() == before
        assert done.tag == tag(present.encode()) and done.backup.split()[0] == tag(before.encode())
        assert scene.owsctl(daemon, "list", has).returncode == 0


def test_a_rename_keeps_the_identity_and_the_file_of_before(scene):
    daemon, writer, _ = start(scene)
    old = daemon.config.read_text()
    for names, words in (("nobody\nhall", "nobody"), ("room\nroom", "the name that it has"), ("room\nha/ll", "one of"),
                         ("room\nha\nll", "control character"), ("room", "a line end"), (f"{'r' * 64}\nhall", "rrr")):
        answer = writer.rename(names)
        # a name that the file cannot have is a fault of the text
        assert answer.status in ("refused", "invalid") and words in answer.text, answer.text
    assert daemon.config.read_text() == old and not writer.before().exists()
    done = writer.rename("room\nhall", person="anna")
    assert (done.status, done.reload) == ("done", "done"), done.text
    assert daemon.config.read_text() == old.replace('"room"', '"hall"') and writer.before().read_text() == old
    assert done.tag == tag_of(daemon.config) and done.backup.split()[0] == tag(old.encode()), done.text
    assert scene.owsctl(daemon, "list", "hall").returncode == 0
    until(lambda: "rename by user" in writer.log(), 10, writer.log)


def test_the_text_that_the_file_has_already_leaves_the_file_of_before_alone(scene):
    daemon, writer, target = start(scene)
    old, new = daemon.config.read_text(), rio(target, ROOM, CELLAR)
    for text in (old, new):
        assert writer.replace(text).status == "done"
        kept = writer.before().stat() if writer.before().exists() else None
        done = writer.replace(text)
        assert (done.status, done.reload, done.why) == ("done", "done", None), done.text
        assert done.tag == tag(text.encode()) and daemon.config.read_text() == text, done.text
        if text is old:
            assert not writer.before().exists() and done.backup is None, done.text
    now = writer.before().stat()
    assert (now.st_ino, now.st_mtime_ns) == (kept.st_ino, kept.st_mtime_ns)
    assert writer.before().read_text() == old and done.backup.split()[0] == tag(old.encode())


def test_a_reload_that_is_refused_is_reported_with_its_reason(scene):
    daemon, writer, target = start(scene)
    done = writer.replace(rio(target, ROOM, Listen=str(owsdtest.free_port())))
    assert (done.status, done.reload) == ("done", "refused"), done.text
    assert "change by a restart only" in done.why
    done = writer.restore()
    assert (done.status, done.reload, done.why) == ("done", "done", None), done.text


def test_without_owsd_the_file_is_written_all_the_same(scene):
    writer = alone(scene)
    done = writer.replace("OwsDrv {\n}\n", base="")
    assert (done.status, done.reload, done.backup) == ("done", "none", None), done.text
    assert writer.beside() == [writer.file.name]
    answer = writer.replace("OwsDrv {\n}\n", base="")
    assert answer.status == "conflict", answer.text
    done = writer.replace("OwsDrv {\n  Period 2\n}\n")
    assert done.status == "done" and done.backup, done.text
    writer.file.unlink()
    done = writer.restore(base="")
    assert done.status == "done" and writer.file.read_text() == "OwsDrv {\n}\n", done.text


def test_a_link_stays_and_its_target_is_replaced(scene):
    writer = alone(scene)
    target = scene.file("real.rio", "OwsDrv {\n}\n")
    writer.file.symlink_to(target)
    done = writer.replace("OwsDrv {\n  Period 2\n}\n")
    assert done.status == "done", done.text
    assert writer.file.is_symlink() and target.read_text() == "OwsDrv {\n  Period 2\n}\n"
    assert writer.before().read_text() == "OwsDrv {\n}\n" and not writer.before().is_symlink()
    # one in the place of the file of before leads nowhere
    other = scene.file("other", "precious")
    writer.before().unlink()
    writer.before().symlink_to(other)
    assert writer.replace("OwsDrv {\n  Period 3\n}\n").status == "done"
    assert other.read_text() == "precious" and not writer.before().is_symlink()
    target.unlink()
    answer = writer.replace("OwsDrv {\n}\n", base="")
    assert answer.status == "error" and "is a symbolic link to a file that is not there" in answer.why, answer.text


def test_mode_and_group_stay_as_they_were(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    for mode in (0o600, 0o640, 0o644, 0o664, 0o400):
        writer.file.chmod(mode)
        done = writer.replace(f"OwsDrv {{\n  Period {mode / 100}\n}}\n")
        assert done.status == "done", done.text
        for file in (writer.file, writer.before()):
            st = file.stat()
            assert (st.st_mode & 0o7777, st.st_uid, st.st_gid) == (mode, os.getuid(), os.getgid())


def test_what_is_no_request_is_refused_and_changes_nothing(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    base, text = tag_of(writer.file), b"OwsDrv {\n  Period 2\n}\n"
    for data, words in (
            (b"GET / HTTP/1.1\r\nHost: a\r\n\r\n", "owsd-writer 1"),
            (b"\0" * 4096, "owsd-writer 1"),
            (b"owsd-writer 1\n" + b"x" * 4096, "longer than 1024"),
            (order(base, text) + b"more", "more bytes came"),
            (order(base, text).replace(b"length: 22", b"length: 99999999"), "longer than"),
            (order(base, text, do="remove"), "restore or rename")):
        answer = ask(writer.socket, data)
        assert answer.status == "refused" and words in answer.why, (data[:40], answer.text)
    for cut in (5, 40, len(order(base, text)) - 3):
        with writing.connect(writer.socket) as door:
            door.sendall(order(base, text)[:cut])
            door.shutdown(socket.SHUT_WR)
            answer = writing.answer_of(door)
            assert answer.status == "refused" and "ends before its end" in answer.why, answer.text
    with writing.connect(writer.socket) as door:
        door.sendall(order(base, text)[:-3])
    assert writer.file.read_text() == "OwsDrv {\n}\n" and writer.beside() == [writer.file.name]
    # who sends in pieces is understood
    with writing.connect(writer.socket) as door:
        for i in range(0, len(order(base, text)), 7):
            door.sendall(order(base, text)[i:i + 7])
        assert writing.answer_of(door).status == "done"


def test_a_peer_that_is_slow_keeps_nobody_waiting_and_is_refused_after_ten_seconds(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    slow = [writing.connect(writer.socket) for _ in range(2)]  # a user has four places
    for door in slow:
        door.sendall(b"owsd-writer 1\ndo: rep")
    begun = time.monotonic()
    done = writer.replace("OwsDrv {\n  Period 2\n}\n")
    assert done.status == "done" and time.monotonic() - begun < 8, done.text
    for door in slow:
        answer = writing.answer_of(door)
        assert answer.status == "refused" and "longer than ten seconds" in answer.why, answer.text
    assert 8 < time.monotonic() - begun < owsdtest.patience(15)


def test_without_room_for_descriptors_it_loses_none_of_its_own(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    had, limits = owsdtest.settled(lambda: owsdtest.open_files(writer)), resource.prlimit(writer.pid, resource.RLIMIT_NOFILE)
    for more in range(4):
        resource.prlimit(writer.pid, resource.RLIMIT_NOFILE, (had[-1] + 1 + more, limits[1]))
        with writing.connect(writer.socket) as door:
            door.settimeout(0.5)
            try:
                door.recv(1)
            except TimeoutError:
                pass
        until(lambda: owsdtest.open_files(writer) == had, 10, lambda: owsdtest.open_files(writer))
    assert "no process for a request" in writer.log()
    resource.prlimit(writer.pid, resource.RLIMIT_NOFILE, limits)
    assert writer.replace("OwsDrv {\n  Period 2\n}\n").status == "done", writer.log()


def test_a_text_that_names_an_endless_file_keeps_nobody_waiting(scene):
    target = f"sim:{scene.file('few.sim', 'chip DS2482-100 0x18' + chr(10))}"
    old = f'OwsDrv {{\n  TargetName "{target}"\n}}\n'
    writer = alone(scene, old)
    endless = writer.file.parent / "endless.table"
    os.mkfifo(endless)
    held = os.open(endless, os.O_RDWR)  # what opens it waits for bytes
    text = old.replace("}", f'  Bus {{\n    Target "{target}"\n    Sensors "{endless}"\n  }}\n}}')
    with writing.connect(writer.socket) as door:
        door.sendall(order(tag_of(writer.file), text.encode()))
        begun = time.monotonic()
        until(lambda: writer.replace(old.replace("}", "  Period 2\n}")).status == "done", 60, writer.log)
        assert time.monotonic() - begun < owsdtest.patience(15), writer.log()
    os.close(held)
    assert writer.stop() == 0


def still_open(pid):
    """The descriptors that a process has open for longer than a moment."""
    def seen():
        return {int(fd) for fd in os.listdir(f"/proc/{pid}/fd")}
    before = seen()
    while True:
        time.sleep(0.2)  # what is open for a moment is closed again
        now = seen()
        if now == before:
            return now
        before = now


def test_without_descriptors_for_a_process_it_serves_again_when_there_are_some(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    pid = writer.process.pid
    before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
    used = still_open(pid)
    free = next(n for n in range(len(used) + 1) if n not in used)
    for more in (1, 2):  # for the connection alone, and for one end of the pipe to its process
        resource.prlimit(pid, resource.RLIMIT_NOFILE, (free + more, before[1]))
        with writing.connect(writer.socket) as door:
            assert not door.recv(1), writer.log()
        logged(writer, "no process for a request: Too many open files")
    resource.prlimit(pid, resource.RLIMIT_NOFILE, before)
    assert {int(fd) for fd in os.listdir(f"/proc/{pid}/fd")} == used, writer.log()
    assert writer.replace("OwsDrv {\n  Period 2\n}\n").status == "done", writer.log()


def test_the_end_waits_for_no_request(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    slow = writing.connect(writer.socket)
    slow.sendall(b"owsd-writer 1\ndo: rep")
    assert writer.replace("OwsDrv {\n  Period 2\n}\n").status == "done"
    begun = time.monotonic()
    assert writer.stop() == 0 and time.monotonic() - begun < 5, writer.log()


def test_of_many_at_once_one_wins_and_the_others_learn_it(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    base = tag_of(writer.file)
    with concurrent.futures.ThreadPoolExecutor(12) as pool:
        texts = [f"OwsDrv {{\n  Period {n + 1}\n}}\n" for n in range(12)]
        answers = list(pool.map(lambda text: writer.replace(text, base), texts))
    assert sorted(a.status for a in answers) == ["conflict"] * 11 + ["done"], [a.text for a in answers]
    won = next(text for text, answer in zip(texts, answers) if answer.status == "done")
    assert writer.file.read_text() == won and writer.before().read_text() == "OwsDrv {\n}\n"


def test_a_large_text_is_taken_up_to_the_limit(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    text = "OwsDrv {\n}\n" + "# " + "x" * 97 + "\n"
    text += ("#" + "y" * 99 + "\n") * ((16 << 20) // 101 - 2)
    assert len(text) < 16 << 20
    done = writer.replace(text)
    assert done.status == "done" and writer.file.read_text() == text, done.text


def test_a_disk_that_takes_no_more_leaves_all_as_it_was(scene):
    if not shutil.which("prlimit"):
        owsdtest.skip("prlimit is not installed")
    old = "OwsDrv {\n}\n"
    writer = alone(scene, old, prefix=("prlimit", "--fsize=3000"))
    answer = writer.replace(old + "#" * 3000 + "\n")
    assert answer.status == "error" and "File too large" in answer.why, answer.text
    assert writer.file.read_text() == old and writer.beside() == [writer.file.name]
    # the present file does not fit a second time: nothing is replaced without a file of before
    writer.file.write_text(old + "#" * 3500 + "\n")
    answer = writer.replace(old)
    assert answer.status == "error" and ".before" in answer.why, answer.text
    assert len(writer.file.read_text()) > 3000 and writer.beside() == [writer.file.name]
    writer.file.write_text(old)
    assert writer.replace("OwsDrv {\n  Period 2\n}\n").status == "done"


def killed_at(scene, calls, nth, do, text):
    """Have the writer killed at its nth of these calls; what then stands in the file and in that of
    before, and what the writer has answered."""
    folder = scene.path / f"{do}-{calls.split(',')[0]}-{nth}"
    folder.mkdir()
    file, before = folder / "K.rio", folder / "K.rio.before"
    file.write_text("OwsDrv {\n  Period 1\n}\n")
    before.write_text("OwsDrv {\n  Period 3\n}\n")
    writer = Writer(scene, file, scene.name(), prefix=(
        "strace", "-D", "-f", "-qq", "-o", "/dev/null", "-e", f"trace={calls}",
        "-e", f"inject={calls}:signal=SIGKILL:when={nth}"))
    with writing.connect(writer.socket) as door:
        door.sendall(order(tag_of(file), text.encode() if do == "replace" else None, None, do))
        data = b""
        try:
            while more := door.recv(65536):
                data += more
        except ConnectionResetError:
            pass
    return file.read_text(), before.read_text(), data


def test_killed_at_any_point_it_leaves_the_old_file_or_the_new_one(scene):
    if not shutil.which("strace"):
        owsdtest.skip("strace is not installed")
    old, kept, new = (f"OwsDrv {{\n  Period {n}\n}}\n" for n in (1, 3, 2))
    for do, after in (("replace", new), ("restore", kept)):
        seen = set()
        for calls, least in (("fchmod", 2), ("fsync", 4), ("rename,?renameat,?renameat2", 2)):
            for nth in range(1, 20):
                file, before, data = killed_at(scene, calls, nth, do, new)
                assert file in (old, after) and before in (old, kept), (do, calls, nth, file, before)
                # of a replace the present text is never lost, of a restore the one that comes back
                assert (old if do == "replace" else kept) in (file, before), (do, calls, nth)
                seen.add((file, before))
                if data:
                    assert writing.Answer(data.decode()).status == "done", data
                    break
            assert nth > least, (do, calls, nth)
        assert {(old, kept), (after, old)} <= seen and len(seen) == 3, (do, seen)


def test_the_service_managers_socket_is_used_and_left_when_nobody_asks(scene):
    folder = scene.path / "etc"
    folder.mkdir()
    file = folder / "S.rio"
    writer = scene.start(activated(scene.path / "s.config", writing.PROGRAM, "-n", scene.name(),
                                   "-c", file))
    until((scene.path / "s.config").exists, 20, writer.log)
    done = ask(scene.path / "s.config", order("", b"OwsDrv {\n}\n"))
    assert done.status == "done" and file.read_text() == "OwsDrv {\n}\n", done.text
    begun = time.monotonic()
    assert writer.wait(40) == 0 and time.monotonic() - begun > 20, writer.log()
    assert (scene.path / "s.config").exists()


def test_two_writers_of_one_socket_and_wrong_usage_are_refused(scene):
    writer = alone(scene, "OwsDrv {\n}\n")
    second = scene._run([writing.PROGRAM, "-n", writer.name, "-c", writer.file], 20)
    assert second.returncode == 1 and "another owsd-writer listens there" in second.stderr, second
    assert writer.replace("OwsDrv {\n  Period 2\n}\n").status == "done"
    for words, status in ((["-n", "a/b"], 2), (["file"], 2), (["-x"], 2), (["-h"], 0), (["-V"], 0)):
        assert scene._run([writing.PROGRAM, *words], 20).returncode == status, words


if __name__ == "__main__":
    owsdtest.main()
