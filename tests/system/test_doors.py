#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Nobody who is let in, or not let in, costs owsd a thread: while users of every kind do their worst at
its sockets, others join, a reload is done, SafeValue is in time, and owsd ends. So it is with the
sockets of the other programs, their own and those of a service manager: others are served, and the
program ends. The bounds are generous: an attack holds for an hour."""

import os
import shutil
import signal
import socket
import time

import faulty
import owsdtest
import private
import sandbox
import writing
from owsdtest import raw, until
from test_control import CLIENT, LOCK, PY, door
from test_privilege import ctl, daemon_of, good, programs

# What takes this long, though little else runs, waits for an attack
LONG = 5
OLD_KERNEL = owsdtest.BUILD / "system" / "old_kernel.so"
CONTROLLER = """
import sys, time
sys.path.insert(0, {path!r})
import ows
h = ows.Ows({name!r}, control=True)
h.beat(600000)
h.set("relays", 5)
while h.get("relays").value != 5:
    time.sleep(0.01)  # pace
print("controls", flush=True)
while True:
    time.sleep(0.05)  # pace
    try:
        if h.stale():
            h.reopen()
        h.set("relays", 5)
    except (FileNotFoundError, ows.Stale):
        pass
"""


def reached(file):
    """The same file where every user reaches it."""
    copy = programs() / file.name
    if not copy.exists():
        shutil.copy(file, copy)
    return copy

# Reads its news into memory that never comes, and waits for more
UNREAD = LOCK.split("libc.pwrite")[0] + """
import select
libc.read.argtypes = [ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t]
door, err, fds = hello(path, 0)
memory = mmap.mmap(fds[0], 0)
memory[144:148] = struct.pack("<I", 1)
select.select([fds[2]], [], [])
threading.Thread(target=lambda: libc.read(fds[2], at, 1), daemon=True).start()
print("holds", flush=True)
while True:
    memory[144:148] = struct.pack("<I", 1)
    time.sleep(0.001)  # pace
"""


def kernels():
    """This one, and one that cannot refuse descriptors."""
    faulty.not_sanitized("the sanitizer has a library of its own before the program's")
    return None, {"LD_PRELOAD": str(reached(OLD_KERNEL))}


def plant(scene, env=None, **driver):
    relays = dict(faulty.RELAYS, SafeValue="7", SafeDelay=raw("0"))
    wire = scene.file("house.sim", faulty.WIRE)
    daemon = daemon_of(scene, owsdtest.rio(f"sim:{wire}", [faulty.ROOM, relays], Period=0.05,
                                           **driver), env=env)
    good(scene, daemon.name)
    return daemon


def attack(scene, who, what, path, number=0):
    """One that holds; None: the kernel does not let it happen."""
    enemy = scene.start([*private.as_user(who), reached(owsdtest.BUILD / "system" / "doors"), what, path,
                         number])
    until(lambda: enemy.log() or not enemy.running(), 60, f"{what} by {who}")
    assert enemy.log().strip() in ("ready", "refused"), enemy.log()
    return enemy if "ready" in enemy.log() else None


def controller(scene, daemon):
    """A program that commands and promises to beat for ten minutes."""
    program = scene.start([*private.as_user("plc"), PY, "-c",
                           CONTROLLER.format(path=str(programs()), name=daemon.name)])
    owsdtest.logged(program, "controls")
    return program


def lasts(action, what):
    begin = time.monotonic()
    action()
    took = time.monotonic() - begin
    assert took < owsdtest.patience(LONG), f"{what} took {took:.1f} s"


def join(scene, daemon):
    said = scene.start([*private.as_user("reader"), PY, "-c", CLIENT + "print(hello(path, 0)[1])",
                        door(daemon.name)])
    assert said.wait() == 0 and said.log().strip() == "0", said.log()


def served(scene, daemon, where):
    done = ctl(scene, "plc", daemon.name, "-t", f"owserver:{where}", "read", "/28.A0B1C2000001/type")
    assert done.stdout.strip() == "DS18B20", done


def unharmed(scene, daemon, plc):
    """All that a hostile user is not to hold up, in the end the end."""
    name = daemon.name
    lasts(lambda: join(scene, daemon), "joining")
    lasts(lambda: ctl(scene, "plc", name, "set", "-w", "20", "relays", "6"), "a command")
    reloads = daemon.log().count("reload: 2 signals")
    daemon.signal(signal.SIGHUP)
    lasts(lambda: until(lambda: daemon.log().count("reload: 2 signals") > reloads, 20), "a reload")
    lasts(lambda: join(scene, daemon), "joining after the reload")
    relays = lambda: ctl(scene, "reader", name, "get", "relays").stdout.strip()
    lasts(lambda: until(lambda: relays() == "5", 20, "its command"), "its command after the reload")
    plc.kill()
    lasts(lambda: until(lambda: relays() == "7", 20, "SafeValue"), "SafeValue")
    lasts(lambda: daemon.stop(), "the end")
    assert "did not end" not in daemon.log() and "stuck" not in daemon.log(), daemon.log()


def test_descriptors_that_are_slow_to_close_cost_no_thread(scene):
    for env in kernels():
        daemon = plant(scene, env)
        plc = controller(scene, daemon)
        path = door(daemon.name)
        held = [attack(scene, "reader", "linger", path, 0), attack(scene, "plc", "linger", path, 1),
                attack(scene, "stranger", "stranger", path)]
        assert env is None or all(held), held
        unharmed(scene, daemon, plc)


def test_the_same_at_the_sockets_of_the_served_protocol(scene):
    for env in kernels():
        where = scene.path / "served.sock"
        daemon = plant(scene, env, ListenSocket=str(where))
        plc = controller(scene, daemon)
        own = owsdtest.segment(daemon.name, "sock")
        held = [attack(scene, "plc", "served", where), attack(scene, "owsd", "served", own)]
        assert env is None or all(held), held
        for _ in range(5):
            lasts(lambda: served(scene, daemon, where), "a served reading")
        unharmed(scene, daemon, plc)


REQUEST = "GET /api/info HTTP/1.1\r\nHost: localhost\r\n\r\n"
ORDER = "owsd-writer 1\ndo: restore\nbase: 0000000000000000\n\n"


def doors_of(scene, program, user, daemon, env, *options):
    """The program with a socket of its own, and with one that it is handed over; under the filter of
    its unit."""
    filtered = sandbox.command(sandbox.UNITS / f"{program}@.service")
    filtered[0] = reached(sandbox.SANDBOX)
    command = [*filtered, reached(owsdtest.BUILD / program), "-n", daemon.name, "-c", daemon.config, *options]
    own, handed = owsdtest.segment(daemon.name, "web"), scene.path / "handed.sock"
    alone = command
    if program == "owsd-writer":  # the place of the sockets is that of the user of owsd
        own = scene.path / "own.sock"
        alone = [*command, "-l", own]
    for path, start in ((own, alone), (handed, writing.activated(handed, *command))):
        face = scene.start([*private.as_user(user), *start], env=env)
        until(path.exists, 20, face.log)
        os.chmod(path, 0o666)
        yield face, path
        path.unlink(missing_ok=True)


def asked(path, request, expected):
    """At a path, or at a port of this machine."""
    local = not isinstance(path, int)
    with socket.socket(socket.AF_UNIX if local else socket.AF_INET) as door:
        door.settimeout(60)
        door.connect(str(path) if local else ("127.0.0.1", path))
        door.sendall(request.encode())
        answer = b""
        while more := door.recv(65536):
            answer += more
    assert expected in answer.decode(), answer


def test_the_same_at_the_page_and_at_the_writer(scene):
    for env in kernels():
        daemon = plant(scene)
        port = owsdtest.free_port()
        for program, user, enemy, text, expected, options in (
                ("owsd-web", "owsd", "reader", REQUEST, '"signals"', ("-l", f"127.0.0.1:{port}")),
                ("owsd-writer", "owsd-writer", "editor", ORDER, "conflict", ())):
            for face, path in doors_of(scene, program, user, daemon, env, *options):
                lasts(lambda: asked(path, text, expected), "the first request")
                held = attack(scene, enemy, "stream", path, text)
                assert env is None or held, (program, path)
                for _ in range(3):
                    lasts(lambda: asked(path, text, expected), f"{program} at {path}")
                    if options:
                        lasts(lambda: asked(port, text, expected), "the page at its address")
                lasts(face.stop, f"the end of {program}")
                assert "ot permitted" not in face.log(), face.log()
        assert daemon.stop() == 0


ASK = """
import socket, sys
door = socket.socket(socket.AF_UNIX)
door.connect(sys.argv[1])
door.sendall(sys.argv[2].encode())
while data := door.recv(65536):
    print(data.decode(), end="")
"""
EVENTS = REQUEST.replace("info", "events")


def page_of(scene, daemon):
    port, path = owsdtest.free_port(), owsdtest.segment(daemon.name, "web")
    page = scene.start([*private.as_user("owsd"), reached(owsdtest.BUILD / "owsd-web"), "-n", daemon.name,
                        "-c", daemon.config, "-l", f"127.0.0.1:{port}"])
    until(path.exists, 20, page.log)
    return page, path, port


def said_to(scene, who, path):
    done = scene.start([*private.as_user(who), PY, "-c", ASK, path, REQUEST])
    done.wait()
    return done.log()


def test_watches_of_a_peer_cost_the_peer_its_connection(scene):
    where, port = scene.path / "served.sock", owsdtest.free_port()
    # a change in each period, for the streams
    daemon = plant(scene, ListenSocket=str(where), Listen=f"127.0.0.1:{port}")
    page, path, web_port = page_of(scene, daemon)
    attack_of = reached(owsdtest.BUILD / "system" / "doors")
    for who, at, text in (("stranger", port, "/28.A0B1C2000001/type"), ("plc", where, "/28.A0B1C2000001/type"),
                          ("stranger", web_port, EVENTS), ("reader", path, EVENTS)):
        enemy = scene.start([*private.as_user(who), attack_of, "watches", at, text])
        until(lambda: "ready" in enemy.log() or not enemy.running(), 60, "the watches")
        if "watches: No space" in enemy.log():
            owsdtest.skip("this kernel gives a user too few watches")
        until(lambda: "closed" in enemy.log(), 120, f"{who} at {at} is closed: {enemy.log()}")
        enemy.kill()
    for at in (path, web_port):
        lasts(lambda: asked(at, REQUEST, '"signals"'), "the page")
    for _ in range(3):
        lasts(lambda: served(scene, daemon, where), "a served reading")
    assert page.stop() == 0


def test_a_user_leaves_places_of_the_page_to_others(scene):
    daemon = plant(scene)
    page, path, port = page_of(scene, daemon)
    attack_of = reached(owsdtest.BUILD / "system" / "doors")
    for text in ("G", REQUEST.replace("GET", "POST").replace("\r\n\r\n", "\r\nContent-Length: 9\r\n\r\n")):
        enemy = scene.start([*private.as_user("reader"), attack_of, "places", path, text])
        until(lambda: "ready" in enemy.log() or not enemy.running(), 60, enemy.log)
        assert enemy.log().split()[0] == "64", enemy.log()
        for who in ("plc", "owsd"):
            assert '"signals"' in said_to(scene, who, path), who
        asked(port, REQUEST, '"signals"')
        enemy.kill()
        until(lambda: "signals" in said_to(scene, "reader", path), 20, "its places are free again")
    assert page.stop() == 0


def porter_of(daemon):
    """The process that carries out what peers make slow; None: there is none."""
    pid = daemon.pid
    for child in open(f"/proc/{pid}/task/{pid}/children").read().split():
        try:
            if open(f"/proc/{child}/comm").read().strip() == "owsd-porter":
                return int(child)
        except OSError:
            pass  # it has just ended
    return None


def test_a_porter_of_the_page_that_is_killed_comes_back(scene):
    daemon = plant(scene)
    page, path, _ = page_of(scene, daemon)
    until(lambda: porter_of(page), 10, "the porter")
    killed = porter_of(page)
    os.kill(killed, signal.SIGKILL)
    until(lambda: "owsd-porter, was killed" in page.log(), 20, page.log)
    lasts(lambda: asked(path, REQUEST, '"signals"'), "the page without a porter")
    until(lambda: "runs again" in page.log(), 20, page.log)
    assert porter_of(page) not in (None, killed), page.log()
    assert page.stop() == 0


def test_a_porter_that_is_killed_comes_back_and_defends_as_before(scene):
    for env in kernels():
        daemon = plant(scene, env)
        plc = controller(scene, daemon)
        until(lambda: porter_of(daemon), 10, "the porter")
        for times in (1, 2):
            killed = porter_of(daemon)
            os.kill(killed, signal.SIGKILL)
            until(lambda: daemon.log().count("owsd-porter, was killed") == times, 20, daemon.log)
            # until it is back owsd does its work
            lasts(lambda: join(scene, daemon), "joining without a porter")
            until(lambda: daemon.log().count("runs again") == times, 20, daemon.log)
            assert porter_of(daemon) not in (None, killed), daemon.log()
        path = door(daemon.name)
        held = [attack(scene, "reader", "linger", path, 0), attack(scene, "stranger", "stranger", path)]
        assert env is None or all(held), held
        unharmed(scene, daemon, plc)


def test_a_reader_that_never_comes_to_read_its_news_holds_up_nobody(scene):
    if os.uname().machine != "x86_64":
        owsdtest.skip("the number of userfaultfd is that of x86-64")
    daemon = plant(scene)
    plc = controller(scene, daemon)
    uid, groups = private.USERS["reader"]
    enemy = scene.start([PY, "-c", CLIENT + UNREAD.format(uid=uid, groups=list(groups)), door(daemon.name)])
    until(lambda: "holds" in enemy.log() or "skip" in enemy.log(), 20, enemy.log)
    if "skip" in enemy.log():
        owsdtest.skip("no userfaultfd here")
    unharmed(scene, daemon, plc)


if __name__ == "__main__":
    private.main(users=True)
