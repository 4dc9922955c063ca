#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who may look, who may act, and what everybody else can do to owsd: as real other users, who need
not exist outside this test. owsd itself is the user owsd under the unit's filter."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

import faulty
import owsdtest
import private
import sandbox
from owsdtest import until

SHM = pathlib.Path("/dev/shm")
PLACE = private.room() / "place"
NOWHERE = private.room() / "nowhere"
KINDS = ("image", "command", "lock")


def place():
    """Programs where every user reaches them."""
    if not PLACE.exists():
        PLACE.mkdir(mode=0o755)
        for program in (owsdtest.OWSD, owsdtest.OWSCTL):
            shutil.copy(program, PLACE)
    return PLACE


def segment(name, kind):
    return SHM / f"owsd.{name}.{kind}"


def daemon_of(scene, text=None, name=None, ready=True):
    """owsd as its unit starts it: user, groups, no capability, filter, umask."""
    os.chmod(scene.path, 0o777)
    name = name or scene.name()
    config = scene.file(f"{name}.rio", text or faulty.house(scene))
    for path in scene.path.iterdir():
        if path.is_file():
            os.chmod(path, 0o644)
    program = place() / "owsd"
    filtered = sandbox.command()
    shutil.copy(filtered[0], place())
    filtered[0] = str(place() / "sandbox")
    daemon = Service(scene, config, name, [], None,
                     [*private.as_user("owsd"), "sh", "-c", 'umask 0077; exec "$@"', "sh", *filtered],
                     program)
    return daemon.ready() if ready else daemon


class Service(owsdtest.Owsd):
    def __init__(self, scene, config, name, options, env, prefix, program):
        real, owsdtest.OWSD = owsdtest.OWSD, program
        try:
            super().__init__(scene, config, name, options, env, prefix)
        finally:
            owsdtest.OWSD = real


def as_user(scene, who, *command):
    return scene._run([*private.as_user(who), *command], 30)


def ctl(scene, who, name, *words):
    return as_user(scene, who, place() / "owsctl", "-n", name, *words)


def python(scene, who, text):
    """A few lines of a program of his: they raise what is refused to him."""
    return as_user(scene, who, "/usr/bin/python3", "-c", "import os, mmap, fcntl, socket\n" + text)


def refused(done, *errors):
    return done.returncode != 0 and any(error in done.stderr for error in
                                        errors or ("Permission", "not permitted"))


def good(scene, name):
    until(lambda: ctl(scene, "reader", name, "get", "room").stdout.strip() == "21.5", 20, "room is good")


def test_who_may_look_and_who_may_act_are_two_groups(scene):
    name = daemon_of(scene).name
    modes = {kind: segment(name, kind).stat() for kind in KINDS}
    assert {kind: (oct(m.st_mode & 0o7777), m.st_uid, m.st_gid) for kind, m in modes.items()} == {
        "image": ("0o640", private.OWSD, private.OWSD),
        "command": ("0o660", private.OWSD, private.CONTROL),
        "lock": ("0o600", private.OWSD, private.OWSD)}
    good(scene, name)
    may = {"reader": (True, False), "plc": (True, True), "setter": (False, False),
           "stranger": (False, False)}
    for who, (look, act) in may.items():
        looked = ctl(scene, who, name, "get", "room")
        assert (looked.returncode in (0, 3)) == look, (who, looked)  # 3: it is bad, and he sees it
        acted = ctl(scene, who, name, "set", "relays", "5")
        assert (acted.returncode == 0) == act, (who, acted)
        for done, allowed in ((looked, look), (acted, act)):
            assert allowed or "ermission" in done.stderr or "group" in done.stderr, (who, done.stderr)
    until(lambda: ctl(scene, "plc", name, "get", "relays").stdout.strip() == "5", 20)


def test_a_reader_cannot_write_by_any_way(scene):
    name = daemon_of(scene).name
    image, command, lock = (segment(name, kind) for kind in KINDS)
    for who in ("reader", "plc"):
        done = python(scene, who, f"os.open('{image}', os.O_RDWR)")
        assert refused(done), done
        done = python(scene, who, f"fd = os.open('{image}', os.O_RDONLY)\n"
                                  f"mmap.mmap(fd, 4096, mmap.MAP_SHARED, mmap.PROT_WRITE)")
        assert refused(done), done
        # nor through /proc, which opens it anew
        done = python(scene, who, f"fd = os.open('{image}', os.O_RDONLY)\n"
                                  f"os.open(f'/proc/self/fd/{{fd}}', os.O_RDWR)")
        assert refused(done), done
        for what in (f"os.truncate('{image}', 0)", f"os.chmod('{image}', 0o666)",
                     f"os.open('{lock}', os.O_RDONLY)"):
            assert refused(python(scene, who, what)), (who, what)
    for how in ("O_RDONLY", "O_RDWR"):
        assert refused(python(scene, "reader", f"os.open('{command}', os.{how})"))
    good(scene, name)


def test_nobody_else_can_take_away_or_replace_what_stands_there(scene):
    name = daemon_of(scene).name
    before = {kind: segment(name, kind).stat().st_ino for kind in KINDS}
    for who in ("reader", "plc", "setter", "stranger"):
        for kind in KINDS:
            path = segment(name, kind)
            for what in (f"os.unlink('{path}')", f"os.rename('{path}', '{path}.away')",
                         f"open('/dev/shm/own', 'w').close(); os.rename('/dev/shm/own', '{path}')"):
                assert refused(python(scene, who, what)), (who, what)
            # only whoever may write it may have another name for it; that is no harm
            done = python(scene, who, f"os.link('{path}', '/dev/shm/link')")
            assert refused(done) != (kind == "command" and who in ("plc", "setter")), (who, kind, done)
            (SHM / "link").unlink(missing_ok=True)
        (SHM / "own").unlink(missing_ok=True)
    assert {kind: segment(name, kind).stat().st_ino for kind in KINDS} == before
    good(scene, name)


SQUATS = {
    "a file for all": "fd = os.open({path!r}, os.O_CREAT | os.O_RDWR, 0o666); os.fchmod(fd, 0o666); "
                      "os.write(fd, b'x' * 8192)",
    "a link to a file of owsd's": "os.symlink({victim!r}, {path!r})",
    "a link to nowhere": f"os.symlink({str(NOWHERE)!r}, {{path!r}})",
    "a pipe": "os.mkfifo({path!r}, 0o666); os.chmod({path!r}, 0o666)",
    "a directory": "os.mkdir({path!r})",
    "a socket": "socket.socket(socket.AF_UNIX).bind({path!r})",
}


def test_what_a_stranger_puts_in_the_way_is_refused_and_never_used(scene):
    victim = scene.file("victim", "precious\n")
    os.chown(victim, private.OWSD, private.OWSD)
    for squat, how in SQUATS.items():
        # what is opened; the rest is only replaced
        others = ("command",) if "link to a" in squat else ()
        for kind in ("lock", "image", *others):
            name = scene.name()
            path = segment(name, kind)
            done = python(scene, "stranger", how.format(path=str(path), victim=str(victim)))
            assert done.returncode == 0, done
            inode = path.lstat().st_ino
            daemon = daemon_of(scene, name=name, ready=False)
            assert daemon.wait(20) == 1, (squat, kind, daemon.log())
            remedy = f"owsctl remove {name}" if squat == "a file for all" else f"rm -r {path}"
            owsdtest.logged(daemon, f" of user stranger ({private.USERS['stranger'][0]}) is in the "
                                    f"way: as root, {remedy}\n")
            assert path.lstat().st_ino == inode and victim.read_text() == "precious\n"
            assert not NOWHERE.exists()
            # nor does a reader believe in it
            assert ctl(scene, "plc", name, "get", "room").returncode not in (0, 3), (squat, kind)
            done = scene.owsctl(None, "remove", name)
            assert done.returncode == 0 and faulty.leftovers(name) == [], (squat, kind, done)
            assert victim.read_text() == "precious\n"
            assert daemon_of(scene, name=name).stop() == 0, (squat, kind)
            for rest in KINDS:
                segment(name, rest).unlink()


def test_no_temporary_name_that_a_stranger_takes_keeps_owsd_from_anything(scene):
    for squat, how in SQUATS.items():
        name = scene.name()
        squats = [segment(name, kind) for kind in ("image.new", "command.new")]
        for path in squats:
            done = python(scene, "stranger", how.format(path=str(path), victim="/etc/passwd"))
            assert done.returncode == 0, done
        before = [path.lstat() for path in squats]
        daemon = daemon_of(scene, name=name)
        good(scene, name)
        daemon.signal(signal.SIGHUP)
        until(lambda: "2 of them go on" in daemon.log(), 20, lambda: f"{squat}: {daemon.log()}")
        good(scene, name)
        os.truncate(segment(name, "command"), 0)
        until(lambda: ctl(scene, "plc", name, "set", "relays", "6").returncode == 0, 20, squat)
        until(lambda: ctl(scene, "plc", name, "get", "relays").stdout.strip() == "6", 20, squat)
        assert [path.lstat() for path in squats] == before, squat
        assert daemon.stop() == 0
        assert faulty.leftovers(name) == ["command", "command.new", "image", "image.new", "lock"]
        for path in squats:
            shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        for rest in KINDS:
            segment(name, rest).unlink()


HOSTILE = """
import ctypes, random, time
fd = os.open({path!r}, os.O_RDWR)
size = os.fstat(fd).st_size
map = mmap.mmap(fd, size)
random.seed({seed})
end = time.monotonic() + 2
while time.monotonic() < end:
    at = random.randrange(size)
    n = min(random.choice((1, 4, 64, 4096)), size - at)
    map[at:at + n] = random.randbytes(n)
fcntl.flock(fd, fcntl.LOCK_EX)
fcntl.lockf(fd, fcntl.LOCK_EX)
os.ftruncate(fd, 100)
time.sleep(1)
try:
    os.posix_fallocate(fd, 0, 1 << 24)
except OSError:
    pass
time.sleep(1)
"""


def test_whoever_may_set_outputs_can_do_no_more_than_that(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    hostile = subprocess.Popen([*private.as_user("setter"), "/usr/bin/python3", "-c", "import os, mmap, "
                                "fcntl\n" + HOSTILE.format(path=str(segment(daemon.name, "command")),
                                                           seed=os.getpid())])
    try:
        while hostile.poll() is None:
            done = ctl(scene, "reader", daemon.name, "get", "room")
            assert done.returncode in (0, 3), done
            assert done.returncode == 3 or done.stdout.strip() == "21.5", done
            assert daemon.running(), daemon.log()
            time.sleep(0.05)
        # it has held its locks, and filled /dev/shm, as long as it lived
        assert hostile.returncode == 0
    finally:
        hostile.kill()
        hostile.wait()
    good(scene, daemon.name)
    until(lambda: ctl(scene, "plc", daemon.name, "set", "relays", "9").returncode == 0, 20, "sets work")
    until(lambda: ctl(scene, "plc", daemon.name, "get", "relays").stdout.strip() == "9", 20)
    assert daemon.stop() == 0


def test_the_socket_is_for_those_who_may_act(scene):
    door = scene.path / "socket"
    name = daemon_of(scene, faulty.house(scene, ListenSocket=str(door))).name
    good(scene, name)
    about = door.stat()
    assert (oct(about.st_mode & 0o777), about.st_gid) == ("0o660", private.CONTROL)
    for who, may in (("plc", True), ("setter", True), ("reader", False), ("stranger", False)):
        done = as_user(scene, who, place() / "owsctl", "-t", f"owserver:{door}", "read",
                       "/28.A0B1C2000001/temperature9")
        assert (done.returncode == 0) == may, (who, done)


def test_another_users_owsd_of_that_name_is_refused_and_harms_nothing(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    for who in ("stranger", "plc"):
        done = as_user(scene, who, place() / "owsd", "-n", daemon.name, "-c", daemon.config)
        assert done.returncode == 1 and "rm " not in done.stderr, done
        assert (f"instance {daemon.name} belongs to user owsd ({private.OWSD}): run owsd as that user, "
                "or name another instance with -n") in done.stderr, done
    good(scene, daemon.name)
    # one of his own he may have
    own = scene.name()
    mine = scene.start([*private.as_user("stranger"), place() / "owsd", "-n", own, "-c", daemon.config])
    until(lambda: ctl(scene, "stranger", own, "get", "room").returncode == 0, 20, "it serves him")
    assert ctl(scene, "plc", own, "get", "room").returncode not in (0, 3), "and nobody else believes it"
    assert mine.stop() == 0


def test_a_running_owsd_whose_lock_a_stranger_took_is_shown_and_not_removed(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    lock = segment(daemon.name, "lock")
    daemon.freeze()
    lock.unlink()
    squat = SQUATS["a file for all"].format(path=str(lock))
    assert python(scene, "stranger", squat).returncode == 0
    for state in ("hangs", "running"):
        until(lambda: f" {state} " in scene.owsctl(None, "instances").stdout, 10, state)
        before = faulty.leftovers(daemon.name)
        done = scene.owsctl(None, "remove", daemon.name)
        assert done.returncode == 1 and f"is running (process {daemon.pid})" in done.stderr, done
        assert faulty.leftovers(daemon.name) == before
        assert "it runs without its lock" in scene.owsctl(None, "instances").stdout
        daemon.thaw()
    until(lambda: "cannot be made again" in daemon.log(), 10, "it is said")
    assert "rm -" not in daemon.log()
    assert daemon.stop() == 0
    assert scene.owsctl(None, "remove", daemon.name).returncode == 0


def test_a_strangers_failed_start_leaves_nothing_that_stops_owsd(scene):
    name = scene.name()
    config = scene.file("stranger.rio", faulty.house(scene))
    os.chmod(scene.path, 0o777)
    os.chmod(config, 0o644)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        done = as_user(scene, "stranger", place() / "owsd", "-n", name, "-c", config, "-l",
                       str(taken.getsockname()[1]))
    assert done.returncode == 1 and "cannot listen" in done.stderr, done
    assert faulty.leftovers(name) == []
    assert daemon_of(scene, name=name).stop() == 0


def test_owsd_has_no_right_and_gets_none(scene):
    daemon = daemon_of(scene)
    facts = dict(line.split(":", 1) for line in
                 pathlib.Path(f"/proc/{daemon.pid}/status").read_text().splitlines())
    for kind in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
        assert int(facts[kind], 16) == 0, (kind, facts[kind])
    assert facts["NoNewPrivs"].strip() == "1" and facts["Seccomp"].strip() == "2"
    assert facts["Uid"].split() == [str(private.OWSD)] * 4


def test_segments_that_no_group_gets_are_told(scene):
    """As a filter without these calls, or a user who is not in the group, would have it."""
    real = sandbox.calls
    sandbox.calls = lambda: real() - {"fchown", "chown", "fchownat"}
    try:
        daemon = daemon_of(scene)
    finally:
        sandbox.calls = real
    owsdtest.logged(daemon, "no other user can look at the signals")
    assert ctl(scene, "reader", daemon.name, "get", "room").returncode not in (0, 3)


if __name__ == "__main__":
    private.main(users=True)
