#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who may look, who may act, and what everybody else can do to owsd: as real other users, who need
not exist outside this test. owsd itself is the user owsd under the unit's filter."""

import json
import os
import pathlib
import re
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

PROGRAMS = private.room() / "programs"
NOWHERE = private.room() / "nowhere"
KINDS = ("image", "force", "control", "lock")
# All names that owsd makes there
NAMES = (*KINDS, "image.new", "force.new")


def programs():
    """Programs where every user reaches them."""
    if not PROGRAMS.exists():
        PROGRAMS.mkdir(mode=0o755)
        for program in (owsdtest.OWSD, owsdtest.with_sim(owsdtest.OWSD, "sim:"), owsdtest.OWSCTL,
                        owsdtest.PYTHON / "ows.py", owsdtest.PYTHON / "libows.so.1"):
            shutil.copy(program, PROGRAMS)
    return PROGRAMS


def daemon_of(scene, text=None, name=None, ready=True, env=None):
    """owsd as its unit starts it: user, groups, no capability, filter, umask."""
    os.chmod(scene.path, 0o777)
    name = name or scene.name()
    config = scene.file(f"{name}.rio", text or faulty.house(scene))
    for path in scene.path.iterdir():
        if path.is_file():
            os.chmod(path, 0o644)
    program = programs() / "owsd"
    filtered = sandbox.command()
    shutil.copy(filtered[0], programs())
    filtered[0] = str(programs() / "sandbox")
    daemon = Service(scene, config, name, [], env,
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


def at_home(who, **environment):
    """As he is without a word of the test: his own place, and the service's."""
    return [*private.as_user(who), "env", "-u", "OWS_DIR", "-u", "XDG_RUNTIME_DIR",
            *(f"{key}={value}" for key, value in environment.items())]


def folder_of(who, where, mode=0o700):
    where.mkdir()
    os.chown(where, private.USERS[who][0], private.USERS[who][0])
    where.chmod(mode)
    return where


def ctl(scene, who, name, *words):
    return as_user(scene, who, programs() / "owsctl", "-n", name, *words)


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
    modes = {kind: owsdtest.segment(name, kind).stat() for kind in KINDS}
    assert {kind: (oct(m.st_mode & 0o7777), m.st_uid, m.st_gid) for kind, m in modes.items()} == {
        "image": ("0o640", private.OWSD, private.OWSD),
        "force": ("0o600", private.OWSD, private.OWSD),
        # all may connect, and are answered by who they are
        "control": ("0o666", private.OWSD, private.OWSD),
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
    image, force, _, lock = (owsdtest.segment(name, kind) for kind in KINDS)
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
                     f"os.open('{lock}', os.O_RDONLY)", f"os.open('{force}', os.O_RDONLY)",
                     f"os.open('{force}', os.O_RDWR)"):
            assert refused(python(scene, who, what)), (who, what)
    good(scene, name)


def test_nobody_else_can_take_away_or_replace_what_stands_there(scene):
    name = daemon_of(scene).name
    here = owsdtest.place()
    before = {kind: owsdtest.segment(name, kind).stat().st_ino for kind in KINDS}
    for who in ("reader", "plc", "setter", "stranger"):
        own = private.room() / "own"
        for kind in KINDS:
            path = owsdtest.segment(name, kind)
            for what in (f"os.unlink('{path}')", f"os.rename('{path}', '{path}.away')",
                         f"open('{own}', 'w').close(); os.rename('{own}', '{path}')",
                         f"os.rename('{here}', '{here}.away')", f"os.rmdir('{here}')",
                         f"os.chmod('{here}', 0o777)"):
                done = python(scene, who, what)
                assert refused(done, "Permission", "not permitted", "cross-device"), (who, what, done)
        own.unlink(missing_ok=True)
    assert {kind: owsdtest.segment(name, kind).stat().st_ino for kind in KINDS} == before
    good(scene, name)


SQUATS = {
    "a file for all": "fd = os.open({path!r}, os.O_CREAT | os.O_RDWR, 0o666); os.fchmod(fd, 0o666)",
    "a link to a file of owsd's": "os.symlink({victim!r}, {path!r})",
    "a hard link to what he may connect to": "os.link({control!r}, {path!r})",
    "a link to nowhere": f"os.symlink({str(NOWHERE)!r}, {{path!r}})",
    "a pipe": "os.mkfifo({path!r}, 0o666)",
    "a directory": "os.mkdir({path!r})",
    "a socket": "socket.socket(socket.AF_UNIX).bind({path!r})",
}


def test_nobody_else_makes_a_name_there_by_any_way(scene):
    """Neither beside a running owsd nor for one that is not yet started; so nothing is in its way."""
    daemon = daemon_of(scene)
    control = owsdtest.segment(daemon.name, "control")
    victim = scene.file("victim", "precious\n")
    os.chown(victim, private.OWSD, private.OWSD)
    future = scene.name()
    for who in ("plc", "stranger"):
        for squat, how in SQUATS.items():
            for path in (owsdtest.segment(name, kind) for name in (daemon.name, future) for kind in NAMES):
                done = python(scene, who, how.format(path=str(path), victim=str(victim),
                                                     control=str(control)))
                # a socket cannot be opened as a file
                assert refused(done, "Permission", "not permitted", "exists", "in use", "No such device"), \
                    (who, squat, path)
    assert faulty.leftovers(future) == [] and victim.read_text() == "precious\n"
    good(scene, daemon.name)
    daemon.signal(signal.SIGHUP)
    until(lambda: "2 of them go on" in daemon.log(), 20, daemon.log)
    good(scene, daemon.name)
    assert daemon_of(scene, name=future).stop() == 0


def refused_place(scene, who, why, environment):
    """Neither owsd nor a consumer uses such a place, and both name the reason."""
    config = scene.file("house.rio", faulty.house(scene))
    os.chmod(scene.path, 0o777)
    os.chmod(config, 0o644)
    for words in (["owsd-sim", "-n", "X", "-c", str(config)], ["owsctl", "-n", "X", "list"],
                  ["owsctl", "instances"]):
        done = scene._run([*at_home(who, **environment), programs() / words[0], *words[1:]], 30)
        assert done.returncode == 1 and why in done.stderr, (words, done)


def test_a_place_that_others_may_write_into_is_refused(scene):
    for mode in (0o777, 0o1777, 0o775):
        where = folder_of("plc", private.room() / f"open{mode:o}", mode)
        refused_place(scene, "plc", f"others may write into {where} (mode {mode:04o})", {"OWS_DIR": where})
        assert list(where.iterdir()) == []


def test_a_place_that_another_has_made_first_is_refused(scene):
    """In /dev/shm everybody can: then owsd has no place, and does not take his."""
    uid, his = private.USERS["plc"][0], private.USERS["stranger"][0]
    where = pathlib.Path(f"/dev/shm/owsd-{uid}")
    whose = f"{where} belongs to user stranger ({his})"
    own = folder_of("plc", private.room() / "plcs own", 0o755)
    for how, why in ((f"os.mkdir('{where}')", whose), (f"os.mkdir('{where}', 0o700)", "Permission denied"),
                     (f"os.symlink('{own}', '{where}')", f"{where} is a link"),
                     (f"os.symlink('{NOWHERE}', '{where}')", f"{where} is a link"),
                     (f"open('{where}', 'w').close()", f"{where} is no directory")):
        done = python(scene, "stranger", how)
        assert done.returncode == 0, done
        refused_place(scene, "plc", why, {})
        # a kernel with protected_symlinks follows no link of another there
        where.unlink() if where.is_symlink() or not where.is_dir() else where.rmdir()
    assert list(own.iterdir()) == [] and not NOWHERE.exists()


def test_a_runtime_directory_of_somebody_else_is_refused(scene):
    his = folder_of("stranger", private.room() / "his", 0o755)
    folder_of("stranger", his / "owsd", 0o755)
    refused_place(scene, "plc", f"{his}/owsd belongs to user stranger", {"XDG_RUNTIME_DIR": his})
    # the service has a place of its own, whatever this says
    done = scene._run([*at_home("owsd", XDG_RUNTIME_DIR=his), programs() / "owsctl", "instances"], 30)
    assert str(his) not in done.stdout + done.stderr, done


# Whoever may set outputs does with his memory what he can; past libows, which would not
HOSTILE = """
import random, struct, time
door = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
door.connect({path!r})
door.send(struct.pack("<IHHII16s32s64x", 0x4853574f, 2, 0, 1, 0, b"", b"hostile"))
_, (fd, bell, news), _, _ = socket.recv_fds(door, 64, 3)
size = os.fstat(fd).st_size
map = mmap.mmap(fd, size)
random.seed({seed})
end = time.monotonic() + 3
while time.monotonic() < end:
    at = random.randrange(size)
    n = min(random.choice((1, 4, 64, 4096)), size - at)
    map[at:at + n] = random.randbytes(n)
    map[128:132] = struct.pack("<I", 1)
    os.write(bell, struct.pack("<Q", 1))
for cut in (0, 100, size * 2):
    try:
        os.ftruncate(fd, cut)
        raise SystemExit("cut")
    except PermissionError:
        pass
fcntl.flock(fd, fcntl.LOCK_EX)
fcntl.lockf(fd, fcntl.LOCK_EX)
# its flags are its own: owsd's writes do not block
fcntl.fcntl(news, fcntl.F_SETFL, 0)
fcntl.fcntl(bell, fcntl.F_SETFL, 0)
time.sleep(1)  # holds its locks for so long
"""


def test_whoever_may_set_outputs_can_do_no_more_than_that(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    hostile = subprocess.Popen([*private.as_user("setter"), "/usr/bin/python3", "-c", "import os, mmap, "
                                "fcntl, socket\n" + HOSTILE.format(
                                    path=str(owsdtest.segment(daemon.name, "control")), seed=os.getpid())])
    try:
        while hostile.poll() is None:
            done = ctl(scene, "reader", daemon.name, "get", "room")
            assert done.returncode in (0, 3), done
            assert done.returncode == 3 or done.stdout.strip() == "21.5", done
            assert daemon.running(), daemon.log()
            # another controller is not kept waiting
            done = ctl(scene, "plc", daemon.name, "set", "relays", "9")
            assert done.returncode == 0, done
        assert hostile.returncode == 0
    finally:
        hostile.kill()
        hostile.wait()
    # it may have switched room's reading off, as it has the right to
    until(lambda: ctl(scene, "plc", daemon.name, "set", "room_ReadEnable", "1").returncode == 0, 20)
    good(scene, daemon.name)
    until(lambda: ctl(scene, "plc", daemon.name, "set", "relays_WriteEnable", "1").returncode == 0, 20)
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
        done = as_user(scene, who, programs() / "owsctl", "-t", f"owserver:{door}", "read",
                       "/28.A0B1C2000001/temperature9")
        assert (done.returncode == 0) == may, (who, done)


def test_another_users_owsd_of_that_name_is_refused_and_harms_nothing(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    for who in ("stranger", "plc"):
        done = as_user(scene, who, programs() / "owsd-sim", "-n", daemon.name, "-c", daemon.config)
        assert done.returncode == 1 and "rm " not in done.stderr, done
        assert (f"instance {daemon.name} belongs to user owsd ({private.OWSD}): run owsd as that user, "
                "or name another instance with -n") in done.stderr, done
    good(scene, daemon.name)
    # in his own place he may have one of the same name, which nobody else sees
    home = folder_of("stranger", private.room() / "home")
    mine = scene.start([*at_home("stranger", XDG_RUNTIME_DIR=home), programs() / "owsd-sim", "-n", daemon.name,
                        "-c", daemon.config])
    own = [*at_home("stranger", XDG_RUNTIME_DIR=home), programs() / "owsctl", "-n", daemon.name]
    until(lambda: scene._run([*own, "get", "room"], 30).returncode == 0, 20, "it serves him")
    assert scene._run([*own, "set", "relays", "3"], 30).returncode == 0
    until(lambda: scene._run([*own, "get", "relays"], 30).stdout == "3\n", 20, "and is his")
    assert ctl(scene, "reader", daemon.name, "get", "relays").stdout != "3\n"
    assert mine.stop() == 0


def test_the_doctor_names_the_group_that_is_missing_and_two_owsd_of_one_name(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    done = ctl(scene, "stranger", daemon.name, "doctor")
    assert done.returncode == 1, done
    assert done.stdout.startswith("1. sudo adduser stranger owsd    # then log in again\n"
                                  "   stranger may not look at the signals\n"), done
    home = folder_of("reader", private.room() / "reader")
    own = at_home("reader", XDG_RUNTIME_DIR=home)
    mine = scene.start([*own, programs() / "owsd-sim", "-n", daemon.name, "-c", daemon.config])
    doctor = [*own, programs() / "owsctl", "-n", daemon.name, "doctor"]
    until(lambda: f"1. kill {mine.process.pid} " in scene._run(doctor, 30).stdout, 30,
          lambda: scene._run(doctor, 30).stdout)


def test_the_doctor_says_of_no_file_that_it_may_not_read_that_it_is_wrong(scene):
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    for mode in (0o640, 0o644):
        os.chmod(daemon.config, mode)
        said = ctl(scene, "reader", daemon.name, "doctor").stdout
        told = f"note: this user may not read {daemon.config}\n    sudo owsctl -n {daemon.name} doctor\n"
        assert (told in said) == (mode == 0o640) and "correct " not in said, said


# Where the image is that a program has mapped
PLACE = """
import os
def place():
    with open("/proc/self/maps") as maps:
        return next(os.path.dirname(line.split()[5]) for line in maps if ".image" in line)
"""
WATCH = PLACE + """
import sys, time
import ows
s = ows.Ows(sys.argv[1])
while True:
    if s.stale():
        try:
            s.reopen()
        except OSError:
            pass
    print(place(), s.get("room").good, flush=True)
    time.sleep(0.05)  # pace
"""

# The same for a program that follows the changes
CHANGES = PLACE + """
import sys
import ows
s = ows.Ows(sys.argv[1])
changes = s.changes()
while True:
    try:
        for names in changes:
            if "room" in names:
                print(place(), s.get("room").good, flush=True)
    except ows.Stale:
        try:
            s.reopen()
        except OSError:
            pass
"""


def test_a_user_sees_the_nearest_owsd_of_a_name_that_lives(scene):
    service = daemon_of(scene)
    good(scene, service.name)
    home = folder_of("plc", private.room() / "nearest")
    as_plc = at_home("plc", XDG_RUNTIME_DIR=home, PYTHONPATH=programs())
    command = [*as_plc, programs() / "owsd-sim", "-n", service.name, "-c", service.config]
    own = scene.start(command)

    def served_by(daemon):
        done = scene._run([*as_plc, programs() / "owsctl", "-n", service.name, "--json", "stats"], 30)
        python3 = scene._run([*as_plc, "/usr/bin/python3", "-c",
                              PLACE + f"import ows; s = ows.Ows('{service.name}'); print(place())"], 30)
        where = owsdtest.place() if daemon is service else home / "owsd"
        return done.returncode == 0 and python3.stdout == f"{where}\n" and \
            json.loads(done.stdout)["daemon"]["pid"] == daemon.pid

    until(lambda: served_by(own), 20, "his own is the nearest")
    assert f"another owsd {service.name} runs, in {owsdtest.place()}: owsctl of this user sees the one in " \
        f"{home}/owsd; end one of them, or name this one otherwise with -n" in own.log(), own.log()
    assert "another owsd" not in service.log()
    rows = scene._run([*as_plc, programs() / "owsctl", "instances"], 30).stdout
    for daemon, where in ((own, home / "owsd"), (service, owsdtest.place())):
        assert re.search(rf"^{service.name} +running +{daemon.pid} .* {where} ", rows, re.M), rows
    watch = scene.start([*as_plc, "/usr/bin/python3", "-c", WATCH, service.name])
    until(lambda: f"{home}/owsd True" in watch.log(), 20, "it looks at his own")
    own.kill()
    until(lambda: served_by(service), 20, "of a dead one and a living one the living one")
    said = scene._run([*as_plc, programs() / "owsctl", "-n", service.name, "doctor"], 30).stdout
    assert f"note: {home}/owsd has values of another owsd {service.name}, which ended" in said, said
    assert f"    owsctl remove {service.name}\n" in said, said
    until(lambda: watch.log().endswith("False\n"), 20, "an open handle stays where it was")
    own = scene.start(command)
    until(lambda: served_by(own), 20, "his own again")
    until(lambda: watch.log().endswith("True\n"), 20, "and follows its owsd")
    assert str(owsdtest.place()) not in watch.log()
    assert own.stop() == 0 and service.stop() == 0
    done = scene._run([*as_plc, programs() / "owsctl", "-n", service.name, "list"], 30)
    assert f"owsd {service.name} of {home}/owsd was stopped" in done.stderr, done
    own = scene.start(command)
    until(lambda: "from down to up" in own.log(), 20, "it runs alone")
    assert "another owsd" not in own.log() and own.stop() == 0
    done = scene._run([*as_plc, programs() / "owsctl", "remove", service.name], 30)
    assert done.returncode == 0 and list((home / "owsd").iterdir()) == [], "he removes what is his"
    assert "image" in faulty.leftovers(service.name)
    done = scene._run([*as_plc, programs() / "owsctl", "remove", service.name], 30)
    assert done.returncode == 1 and "no right to remove" in done.stderr, done


def test_a_program_that_found_the_image_of_a_dead_owsd_finds_the_one_that_lives(scene):
    service = daemon_of(scene)
    good(scene, service.name)
    home = folder_of("plc", private.room() / "dead")
    as_plc = at_home("plc", XDG_RUNTIME_DIR=home, PYTHONPATH=programs())
    owsctl = [*as_plc, programs() / "owsctl", "-n", service.name]
    for end in (owsdtest.Program.stop, owsdtest.Program.kill):
        own = scene.start([*as_plc, programs() / "owsd-sim", "-n", service.name, "-c", service.config])
        until(lambda: "from down to up" in own.log(), 20, own.log)
        end(own)
        service.freeze()
        until(lambda: f"of {home}/owsd " in scene._run([*owsctl, "list"], 30).stderr, 20, "none of them lives")
        watch = scene.start([*as_plc, "/usr/bin/python3", "-c", WATCH, service.name])
        follow = scene.start([*owsctl, "watch", "-l", "room"])
        changes = scene.start([*as_plc, "/usr/bin/python3", "-c", CHANGES, service.name])
        until(lambda: f"{home}/owsd False" in watch.log() and "False" in changes.log(), 20, watch.log)
        service.thaw()
        until(lambda: watch.log().endswith(f"{owsdtest.place()} True\n"), 20, watch.log)
        until(lambda: changes.log().endswith(f"{owsdtest.place()} True\n"), 20, changes.log)
        until(lambda: re.search("room.*21.5.*good", follow.log()), 20, follow.log)


def test_a_strangers_failed_start_leaves_nothing_that_stops_owsd(scene):
    name = scene.name()
    config = scene.file("stranger.rio", faulty.house(scene))
    os.chmod(scene.path, 0o777)
    os.chmod(config, 0o644)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        where = folder_of("stranger", private.room() / "runtime")
        done = scene._run([*at_home("stranger", XDG_RUNTIME_DIR=where), programs() / "owsd-sim", "-n", name,
                           "-c", config, "-l", str(taken.getsockname()[1])], 30)
    assert done.returncode == 1 and "cannot listen" in done.stderr, done
    assert faulty.leftovers(name) == [] and list((where / "owsd").iterdir()) == []
    assert daemon_of(scene, name=name).stop() == 0


def test_owsd_has_no_right_and_gets_none(scene):
    daemon = daemon_of(scene)
    facts = dict(line.split(":", 1) for line in
                 pathlib.Path(f"/proc/{daemon.pid}/status").read_text().splitlines())
    for kind in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
        assert int(facts[kind], 16) == 0, (kind, facts[kind])
    assert facts["NoNewPrivs"].strip() == "1" and facts["Seccomp"].strip() == "2"
    assert facts["Uid"].split() == [str(private.OWSD)] * 4


def test_the_kernels_files_of_a_slave_are_for_owsd_alone(scene):
    """The command of the udev rule, on a folder as the kernel makes it."""
    del scene
    rules = (owsdtest.SOURCE / "board/udev/owsd.rules").read_text()
    command = re.search(r"""^SUBSYSTEM=="w1".*RUN\+="/bin/sh -c '(.*)'"$""", rules, re.M).group(1)
    slave = private.room() / "slave"
    slave.mkdir(mode=0o755)
    for name, mode in (("rw", 0o644), ("output", 0o664), ("alarms", 0o644), ("id", 0o444)):
        (slave / name).touch()
        (slave / name).chmod(mode)
    subprocess.run(["sh", "-c", command.replace("/sys%p", str(slave)).replace("$$", "$")], check=True)
    for user in private.USERS:
        for name in ("rw", "output", "alarms", "id"):
            done = subprocess.run([*private.as_user(user), "sh", "-c", f": >>{slave}/{name}"],
                                  capture_output=True, check=False)
            assert (done.returncode == 0) == (user == "owsd" and name != "id"), (user, name, done)


def test_segments_that_no_group_gets_are_told(scene):
    """As a filter without these calls, or a user who is not in the group, would have it."""
    real = sandbox.calls
    sandbox.calls = lambda _unit: real() - {"fchown", "chown", "fchownat"}
    try:
        daemon = daemon_of(scene)
    finally:
        sandbox.calls = real
    owsdtest.logged(daemon, "no other user can look at the signals")
    assert ctl(scene, "reader", daemon.name, "get", "room").returncode not in (0, 3)


if __name__ == "__main__":
    private.main(users=True)
