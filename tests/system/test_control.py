#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Who may command what, as genuine users and processes: rights by ControlAllow, crowds, programs that
stop, fork, die, hand their descriptors on, or come from another pid namespace."""

import os
import signal

import faulty
import owsdtest
import private
from owsdtest import until
from test_privilege import ctl, daemon_of, good

PY = "/usr/bin/python3"
# As a program does that knows the layout and nothing of libows
CLIENT = """
import mmap, os, socket, struct, sys, time
def hello(path, flags=1, name=b"hand made", token=b""):
    door = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    door.connect(path)
    try:
        door.send(struct.pack("<IHHII16s32s64x", 0x4853574f, 2, 0, flags, 0, token, name))
    except BrokenPipeError:
        pass
    try:
        welcome, fds, _, _ = socket.recv_fds(door, 64, 3)
    except ConnectionResetError:
        welcome, fds, _, _ = socket.recv_fds(door, 64, 3)
    return door, struct.unpack_from("<i", welcome, 8)[0], fds
def set(fds, record, value, stamp):
    with mmap.mmap(fds[0], 0) as map:
        slot_off, dirty_off = (struct.unpack_from("<I", map, at)[0] for at in (24, 48))
        slot = slot_off + 64 * record
        map[slot:slot + 8] = struct.pack("<q", value)
        map[slot + 8:slot + 12] = struct.pack("<I", stamp)
        map[dirty_off:dirty_off + 4] = struct.pack("<I", 1 << record)
        map[128:132] = struct.pack("<I", 1)
        os.write(fds[1], struct.pack("<Q", 1))
        until = time.monotonic() + 20
        while time.monotonic() < until:
            taken, _, err = struct.unpack_from("<IIi", map, slot + 48)
            if taken == stamp:
                return err
            time.sleep(0.001)  # pace
    return None
path = sys.argv[1]
"""


def door(name):
    return str(owsdtest.segment(name, "control"))


def program(scene, who, name, text):
    """A program of that user that prints what text makes of it."""
    return scene.start([*private.as_user(who), PY, "-c", CLIENT + text, door(name)])


def connected(scene, name):
    out = ctl(scene, "reader", name, "stats").stdout
    return int(next(line.split()[0] for line in out.splitlines() if "control_connections" in line))


def runs(pid):
    """As a process that has not ended, whether or not somebody has asked how it did."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def allow(scene, *entries):
    """The house with these entries of ControlAllow."""
    text = faulty.house(scene)
    lines = "".join(f'  ControlAllow "{entry}"\n' for entry in entries)
    return text.replace("OwsDrv {\n", "OwsDrv {\n" + lines, 1)


def test_ControlAllow_decides_by_user_and_group_who_may_command(scene):
    name = daemon_of(scene, allow(scene, "rel* user:stranger group:owsd")).name
    good(scene, name)
    # plc is in the group owsd; the group owsd-control counts no more for these signals
    for who, err in (("plc", "0"), ("reader", "0"), ("stranger", "0"), ("setter", "-13")):
        said = program(scene, who, name, "door, err, fds = hello(path)\n"
                                         "print(err if err else set(fds, 2, 5, 1))")
        assert said.wait() == 0 and said.log().strip() == err, (who, said.log())


def test_an_entry_for_one_signal_gives_no_right_to_another(scene):
    name = daemon_of(scene, allow(scene, "relays user:stranger", "room user:setter")).name
    good(scene, name)
    said = program(scene, "setter", name, "door, err, fds = hello(path)\n"
                                          "print(err, set(fds, 2, 5, 1))")
    assert said.wait() == 0 and said.log().strip() == "0 -13", said.log()


def test_a_reload_takes_rights_away_and_gives_them(scene):
    daemon = daemon_of(scene)
    name = daemon.name
    good(scene, name)
    asks = ("door, err, fds = hello(path)\nprint(err, set(fds, 2, 5, 1), flush=True)\n"
            "welcome, fds2, _, _ = socket.recv_fds(door, 64, 3)\n"
            "fds[0] = fds2[0]\nprint(len(fds2), set(fds, 2, 6, 2), flush=True)\n")
    controller = program(scene, "plc", name, asks)
    owsdtest.logged(controller, "0 0")
    daemon.config.write_text(allow(scene, "relays user:stranger"))
    daemon.signal(signal.SIGHUP)
    owsdtest.logged(controller, "1 -13")
    said = program(scene, "stranger", name, "door, err, fds = hello(path)\nprint(err, set(fds, 2, 7, 1))")
    assert said.wait() == 0 and said.log().strip() == "0 0", said.log()


def test_a_reload_is_for_the_group_owsd_config_and_gives_no_other_right(scene):
    daemon = daemon_of(scene)
    name = daemon.name
    good(scene, name)
    for who in ("reader", "plc", "setter", "stranger"):
        refused = ctl(scene, who, name, "reload")
        assert refused.returncode == 1 and "no right to reload" in refused.stderr, (who, refused)
    assert "reload: " not in daemon.log() and daemon.log().count(" may not reload by ") >= 2, daemon.log()
    done = ctl(scene, "editor", name, "reload")
    assert done.returncode == 0 and done.stderr == "", done
    user = private.USERS["editor"][0]
    until(lambda: f", user {user})" in daemon.log(), 20, daemon.log)
    assert 'reload: asked for by "owsctl" (process' in daemon.log(), daemon.log()
    daemon.config.write_text("OwsDrv {\n  No such thing\n")
    refused = ctl(scene, "editor", name, "reload")
    assert refused.returncode == 1 and "owsd refuses the configuration" in refused.stderr, refused
    assert f"{daemon.config}:2:" in refused.stderr, refused
    # a hello for anything else is refused, though the door is open to him
    for flags in (0, 1):
        said = program(scene, "editor", name, f"print(hello(path, {flags})[1])")
        assert said.wait() == 0 and said.log().strip() == "-13", said.log()
    good(scene, name)


def test_clients_of_the_served_protocol_keep_to_ControlAllow_and_are_named(scene):
    path, port = scene.path / "served.sock", owsdtest.free_port()
    os.chmod(scene.path, 0o777)
    text = allow(scene, "rel* user:plc").replace(
        "OwsDrv {\n", f'OwsDrv {{\n  Listen "{port}"\n  ListenSocket "{path}"\n', 1)
    name = daemon_of(scene, text).name
    good(scene, name)
    device = faulty.RELAYS["Path"]

    def write(who, target, path, value):
        done = ctl(scene, who, name, "-t", f"owserver:{target}", "write", path, value)
        return "" if done.returncode == 0 else done.stderr or "failed"

    for who, target in (("setter", path), ("plc", f"127.0.0.1:{port}")):
        for what in ("/signals/relays", "/signals/relays_WriteOneShot", device, "/bus.0" + device):
            refused = write(who, target, what, "1")
            assert "no permission" in refused, (who, what, refused)
    assert write("plc", path, "/signals/relays", "9") == ""
    until(lambda: ctl(scene, "reader", name, "get", "relays").stdout.strip() == "9", 20)
    user = f"user {private.USERS['plc'][0]}"
    for view in ("who", "journal"):
        shown = ctl(scene, "reader", name, view).stdout
        assert any("owserver protocol" in line and user in line for line in shown.splitlines()), shown


def test_faults_of_ControlAllow_are_said(scene):
    for entry, fault in (("relays", "expected a pattern of signal names"),
                         ("relays plc", "expected user:NAME or group:NAME"),
                         ("relays user:", "expected user:NAME or group:NAME"),
                         ("", "expected a pattern of signal names")):
        config = scene.file("house.rio", allow(scene, entry))
        done = scene.owsd_once("--check", "-c", config)
        assert done.returncode == 2 and fault in done.stderr and "house.rio:2:" in done.stderr, done
    config = scene.file("house.rio", allow(scene, "relays user:nobody-of-that-name group:64712"))
    done = scene.owsd_once("--check", "-c", config)
    assert done.returncode == 0, done
    assert "warning" in done.stderr and "no user nobody-of-that-name here" in done.stderr, done
    assert 'ControlAllow "relays user:nobody-of-that-name group:64712"' in " ".join(done.stdout.split()), done
    assert "no signal fits" not in done.stderr, done


def test_a_pattern_of_ControlAllow_that_fits_no_signal_gets_a_warning(scene):
    config = scene.file("house.rio", allow(scene, "realys user:0", "rel[ user:0", "r?lay* user:0"))
    done = scene.owsd_once("--check", "-c", config)
    assert done.returncode == 0 and "house.rio:2:" in done.stderr, done
    assert "no signal fits the pattern realys" in done.stderr, done
    assert "no signal fits the pattern rel[" in done.stderr, done
    assert "r?lay*" not in done.stderr, done


def test_a_stranger_is_answered_and_keeps_nobody_out(scene):
    name = daemon_of(scene).name
    good(scene, name)
    crowd = program(scene, "stranger", name, "doors = [hello(path) for _ in range(500)]\n"
                                             "print(sorted({d[1] for d in doors}), flush=True)\n"
                                             "time.sleep(60)")  # until it is killed
    owsdtest.logged(crowd, "[-13]")
    assert ctl(scene, "plc", name, "set", "-w", "20", "relays", "4").returncode == 0
    until(lambda: connected(scene, name) == 0, 20)


def test_a_user_who_takes_all_he_can_leaves_room_for_others(scene):
    name = daemon_of(scene).name
    good(scene, name)
    crowd = program(scene, "setter", name, "doors = [hello(path) for _ in range(300)]\n"
                                           "print([sum(d[1] == e for d in doors) for e in (0, -28)])\n"
                                           "sys.stdout.flush()\ntime.sleep(60)")
    owsdtest.logged(crowd, "[32, 268]")
    half = program(scene, "plc", name, "doors = []\nfor _ in range(100):\n"
                                       "    door = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)\n"
                                       "    door.connect(path)\n    doors.append(door)\n"
                                       "print('connected', flush=True)\ntime.sleep(60)")
    owsdtest.logged(half, "connected")
    until(lambda: connected(scene, name) == 64, 20)
    # who says nothing loses its places in two seconds
    until(lambda: connected(scene, name) == 32, 20)
    assert ctl(scene, "plc", name, "set", "-w", "20", "relays", "4").returncode == 0
    crowd.kill()
    until(lambda: connected(scene, name) == 0, 20)


def test_a_stopped_program_holds_up_neither_others_nor_a_reload(scene):
    daemon = daemon_of(scene)
    name = daemon.name
    good(scene, name)
    stopped = program(scene, "plc", name, "all = [hello(path) for _ in range(20)]\nprint('in', flush=True)\n"
                                          "time.sleep(600)")  # until it is killed
    owsdtest.logged(stopped, "in")
    stopped.freeze()
    for i in range(5):
        daemon.config.write_text(faulty.house(scene) + f"# {i}\n")
        assert scene.owsctl(daemon, "reload").returncode == 0, daemon.log()
        assert ctl(scene, "plc", name, "set", "-w", "20", "relays", str(i)).returncode == 0
    until(lambda: connected(scene, name) == 20, 20)
    stopped.kill()
    until(lambda: connected(scene, name) == 0, 20)


def test_a_program_that_dies_is_lost_though_its_child_has_all_it_had(scene):
    name = daemon_of(scene).name
    good(scene, name)
    goes_on = scene.file("goes on", "")
    parent = program(scene, "plc", name, "door, err, fds = hello(path)\nset(fds, 2, 3, 1)\n"
                                         f"child = os.fork()\nwhile not child and os.path.exists('{goes_on}'):\n"
                                         "    time.sleep(0.05)  # pace\n"
                                         "print('forked', child, flush=True)\ntime.sleep(60 if child else 0)")
    owsdtest.logged(parent, "forked")
    child = int(parent.log().split()[1])
    until(lambda: connected(scene, name) == 1, 20)
    os.kill(parent.pid, signal.SIGKILL)
    until(lambda: connected(scene, name) == 0, 20)
    # it never beat: what it commanded stays
    until(lambda: ctl(scene, "reader", name, "get", "relays").stdout.strip() == "3", 20)
    assert runs(child)
    os.unlink(goes_on)
    until(lambda: not runs(child), 20)


def test_what_is_handed_on_carries_the_rights_of_who_connected(scene):
    """A memory is as good as a key: whoever has its descriptor commands, and who does it is the controller."""
    name = daemon_of(scene).name
    good(scene, name)
    controller = program(scene, "plc", name, "door, err, fds = hello(path)\n"
                                        "if os.fork() == 0:\n    print(set(fds, 2, 9, 1), flush=True)\n"
                                        "    os._exit(0)\nos.wait()\nprint('done', flush=True)\ntime.sleep(60)")
    owsdtest.logged(controller, "done")
    assert controller.log().split() == ["0", "done"]
    until(lambda: ctl(scene, "reader", name, "get", "relays").stdout.strip() == "9", 20)
    assert f"{controller.pid}" in ctl(scene, "reader", name, "who").stdout


def test_a_hole_in_a_memory_harms_its_controller_alone(scene):
    name = daemon_of(scene).name
    good(scene, name)
    controller = program(scene, "plc", name, "import ctypes\ndoor, err, fds = hello(path)\nset(fds, 2, 1, 1)\n"
                                        "size = os.fstat(fds[0]).st_size\n"
                                        "libc = ctypes.CDLL(None, use_errno=True)\n"
                                        "libc.fallocate.argtypes = [ctypes.c_int] * 2 + [ctypes.c_long] * 2\n"
                                        "print(libc.fallocate(fds[0], 3, 0, size), flush=True)\n"
                                        "while True:\n    os.write(fds[1], struct.pack('<Q', 1))\n"
                                        "    time.sleep(0.01)  # pace")
    owsdtest.logged(controller, "0")
    assert ctl(scene, "plc", name, "set", "-w", "20", "relays", "7").returncode == 0
    good(scene, name)
    controller.kill()
    until(lambda: connected(scene, name) == 0, 20)


def test_of_another_pid_namespace_the_user_counts_and_the_process_is_unknown(scene):
    name = daemon_of(scene).name
    good(scene, name)
    done = scene._run(["unshare", "--pid", "--fork", "true"], 20)
    if done.returncode:
        owsdtest.skip("no pid namespaces here")
    goes_on = scene.file("goes on", "")
    text = ("door, err, fds = hello(path)\nprint(err, set(fds, 2, 8, 1), flush=True)\n"
            f"while os.path.exists('{goes_on}'):\n    time.sleep(0.05)")  # pace
    inside = [*private.as_user("plc"), PY, "-c", CLIENT + text, door(name)]
    controller = scene.start(["unshare", "--pid", "--fork", "--kill-child", *inside])
    owsdtest.logged(controller, "0 0")
    until(lambda: ctl(scene, "reader", name, "get", "relays").stdout.strip() == "8", 20)
    until(lambda: connected(scene, name) == 1, 20)
    os.unlink(goes_on)
    assert controller.wait() == 0
    until(lambda: connected(scene, name) == 0, 20)


def test_memory_that_a_program_keeps_beyond_its_end_is_emptied(scene):
    """Else it would count as owsd's; a descriptor of O_PATH holds it and shows nowhere."""
    daemon = daemon_of(scene)
    good(scene, daemon.name)
    keeper = program(scene, "setter", daemon.name, """
kept = []
while len(kept) < 200:
    one, err, fds = hello(path)
    if not err:
        kept.append((os.open(f"/proc/self/fd/{fds[0]}", os.O_PATH), mmap.mmap(fds[0], 0)))
    one.close()
    for fd in fds:
        os.close(fd)
while any(os.fstat(file).st_blocks for file, _ in kept):
    time.sleep(0.01)  # pace
print("all are empty", flush=True)
time.sleep(60)  # until it is killed
""")
    owsdtest.logged(keeper, "all are empty")


# A page that never comes, as of a file system of its own: who writes from there waits in the kernel
LOCK = """
import ctypes, fcntl, threading
libc = ctypes.CDLL(None, use_errno=True)
faults = libc.syscall(ctypes.c_long(323), os.O_CLOEXEC)
if faults < 0:
    print("skip", ctypes.get_errno(), flush=True)
    sys.exit()
fcntl.ioctl(faults, 0xc018aa3f, bytearray(struct.pack("QQQ", 0xaa, 0, 0)))
page = mmap.mmap(-1, 4096)
at = ctypes.addressof(ctypes.c_char.from_buffer(page))
fcntl.ioctl(faults, 0xc020aa00, bytearray(struct.pack("QQQQ", at, 4096, 1, 0)))
os.setgroups({groups})
os.setresgid({uid}, {uid}, {uid})
os.setresuid({uid}, {uid}, {uid})
libc.pwrite.argtypes = [ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_long]
def connect():
    door, err, fds = hello(path)
    threading.Thread(target=lambda: libc.pwrite(fds[0], at, 64, 512), daemon=True).start()
    os.read(faults, 32)  # it waits for the page
    return door, err
stays = connect()
leaves = connect()
leaves[0].close()
print("holds", stays[1], leaves[1], flush=True)
time.sleep(600)  # until it is killed
"""


def test_a_program_that_holds_the_lock_of_its_memorys_file_holds_up_nobody(scene):
    if os.uname().machine != "x86_64":
        owsdtest.skip("the number of userfaultfd is that of x86-64")
    daemon = daemon_of(scene)
    name = daemon.name
    good(scene, name)
    uid, groups = private.USERS["plc"]
    holder = scene.start([PY, "-c", CLIENT + LOCK.format(uid=uid, groups=list(groups)), door(name)])
    until(lambda: "holds" in holder.log() or "skip" in holder.log(), 20, holder.log)
    if "skip" in holder.log():
        owsdtest.skip("no userfaultfd here")
    assert "holds 0 0" in holder.log(), holder.log()
    until(lambda: connected(scene, name) == 1, 20)
    assert ctl(scene, "plc", name, "set", "-w", "20", "relays", "4").returncode == 0
    assert scene.owsctl(daemon, "reload").returncode == 0, daemon.log()
    assert ctl(scene, "plc", name, "set", "-w", "20", "relays", "5").returncode == 0
    assert daemon.stop() == 0


if __name__ == "__main__":
    private.main(users=True)
