#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Configuration files: what is refused before anything starts, and edits that meet."""

import ctypes
import fcntl
import json
import os
import pathlib
import platform
import re
import signal
import socket
import struct
import subprocess
import time

import owsdtest

os.environ["OWSD_BOARDS"] = str(owsdtest.SOURCE / "board" / "boards")

PTRACE_TRACEME, PTRACE_SYSCALL, PTRACE_SETOPTIONS, PTRACE_GET_SYSCALL_INFO = 0, 24, 0x4200, 0x420E
PTRACE_O_TRACESYSGOOD = 1
# The numbers of write, fsync, and of all that rename
NUMBERS = {"x86_64": (1, 74, (82, 264, 316)), "aarch64": (64, 82, (38, 276))}
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
ITEM = dict(Name="x", Path="/28.000000000001/temperature", Type="double", IO="input")


def test_edits_at_once_lose_nothing(scene):
    owsdtest.need(owsdtest.OWSCTL)
    path = scene.path / "house.rio"
    script = """for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        # five seconds of a slow disk are told, and nothing is lost by that
        until said=$("$0" config "$1" add "$2$i" "/28.000000000001/temperature" 2>&1); do
            case $said in *"another program has been editing here"*) ;; *) echo "$said"; exit 1 ;; esac
        done
    done"""
    both = [scene.start(["sh", "-c", script, owsdtest.OWSCTL, path, letter]) for letter in "ab"]
    assert [process.wait(180) for process in both] == [0, 0]
    for process in both:
        process.log_path.unlink()
    listed = scene.owsctl(None, "config", path, "list")
    assert listed.returncode == 0, listed.stderr
    names = {line.split()[0] for line in listed.stdout.splitlines() if "/28." in line}
    assert names == {f"{letter}{i}" for letter in "ab" for i in range(1, 21)}
    assert os.listdir(scene.path) == ["house.rio"]


def test_an_edit_waits_five_seconds_for_another_and_says_so(scene):
    path = scene.file("house.rio", owsdtest.rio("localhost", []))
    with open(f"{path}.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature")
    assert done.returncode == 1, done
    assert "house.rio: error: another program has been editing here" in done.stderr, done.stderr


def test_nobody_who_can_only_look_at_the_directory_stops_an_edit(scene):
    path = scene.file("house.rio", owsdtest.rio("localhost", []))
    held = [os.open(what, os.O_RDONLY) for what in (scene.path, path)]
    for fd in held:
        fcntl.flock(fd, fcntl.LOCK_EX)
    pathlib.Path(f"{path}.lock").touch()  # of an edit that was killed
    done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature")
    for fd in held:
        os.close(fd)
    assert done.returncode == 0, done
    assert os.listdir(scene.path) == ["house.rio"]


def follow(command, stops=None):
    """Run command from one entry into the kernel, or return from it, to the next: to its end, or
    kill it at the stop of this number. Returns its exit status (None: killed) and the calls."""
    pid = os.fork()
    if pid == 0:
        quiet = os.open(os.devnull, os.O_RDWR)
        for fd in range(3):
            os.dup2(quiet, fd)
        # a leak checker is a tracer itself
        os.environ["ASAN_OPTIONS"] = os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"
        if libc.ptrace(PTRACE_TRACEME, 0, None, None) < 0:
            os._exit(77)
        os.execv(command[0], command)
    info, calls = ctypes.create_string_buffer(88), []
    while True:
        _, status = os.waitpid(pid, 0)
        if os.WIFEXITED(status) or os.WIFSIGNALED(status):
            return os.waitstatus_to_exitcode(status), calls
        if not calls:
            libc.ptrace(PTRACE_SETOPTIONS, pid, None, PTRACE_O_TRACESYSGOOD)
        libc.ptrace(PTRACE_GET_SYSCALL_INFO, pid, 88, info)
        op, number = struct.unpack_from("B23xQ", info)
        calls.append(number if op == 1 else None)
        if len(calls) == stops:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
            return None, calls
        libc.ptrace(PTRACE_SYSCALL, pid, None, None)


def edit_with(scene, path, stops=None):
    path.write_text(owsdtest.rio("localhost", [ITEM]))
    command = [str(owsdtest.OWSCTL), "config", str(path), "set", "x", "IO=output"]
    status, calls = follow(command, stops)
    if status == 77:
        owsdtest.skip("may not trace here")
    return status, calls


def test_an_edit_that_is_killed_at_any_point_leaves_the_old_file_or_the_new_one(scene):
    owsdtest.need(owsdtest.OWSCTL)
    path = scene.path / "house.rio"
    status, calls = edit_with(scene, path)
    assert status == 0
    new = path.read_text()
    seen = []
    deadline = time.monotonic() + 5
    _, _, renames = NUMBERS.get(platform.machine(), (0, 0, ()))

    def enough():
        return seen.count(True) > 1 and seen.count(False) > 1 and \
            any(not isinstance(what, bool) for what in seen)
    # From the end: where that is too slow, the calls that load the program are left out. A run may
    # need some calls more or fewer than the first did, and may end by itself, with the new file
    for stops in range(len(calls) - 1, 0, -1):
        status, calls = edit_with(scene, path, stops)
        now = path.read_text()
        assert now in (new, owsdtest.rio("localhost", [ITEM])), f"killed at {stops}: {now!r}"
        # new from the return of rename on, old until its entry
        entry = next((i for i, number in enumerate(calls) if number in renames), len(calls))
        if status is None and renames and len(calls) != entry + 1:
            assert (now == new) == (len(calls) > entry + 1), f"killed at {stops}: {now == new}"
        seen.append(now == new)
        for left in scene.path.glob("house.rio.*"):
            left.unlink()
            seen.append(left)
        if time.monotonic() > deadline and enough():
            break
    assert enough(), seen


def test_an_edit_is_on_the_disk_before_it_takes_the_place_of_the_old_file(scene):
    if platform.machine() not in NUMBERS:
        owsdtest.skip(f"the numbers of calls on {platform.machine()} are not here")
    write, fsync, renames = NUMBERS[platform.machine()]
    status, calls = edit_with(scene, scene.path / "house.rio")
    assert status == 0
    here = [number for number in calls if number in (write, fsync, *renames)]
    rename = next(i for i, number in enumerate(here) if number in renames)
    assert here[rename - 2:rename] == [write, fsync], here
    assert here[rename + 1] == fsync, "the directory is not synced after it"


def test_a_key_given_twice_is_refused(scene):
    path = scene.file("house.rio", owsdtest.rio("localhost", []))
    before = path.read_text()
    done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature",
                        "Type=bool", "IO=input", "Type=byte")
    assert done.returncode == 2, done
    assert "Type is given twice" in done.stderr, done.stderr
    assert path.read_text() == before


def test_a_link_to_nowhere_is_named(scene):
    path = scene.path / "link.rio"
    path.symlink_to(scene.path / "nowhere.rio")
    done = scene.owsctl(None, "config", path, "add", "x", "/28.000000000001/temperature")
    assert done.returncode == 1, done
    assert "link.rio: error: is a symbolic link to a file that is not there" in done.stderr
    assert "is new" not in done.stderr, done.stderr
    assert os.listdir(scene.path) == ["link.rio"]



def test_a_simulated_target_without_the_simulator_names_the_program_that_has_it(scene):
    for target in ("sim:house.sim", "sim", "sim:", "sim:1.sim", "null:, sim:/1.sim:0x18"):
        path = scene.file("house.rio", owsdtest.rio(target, [ITEM]))
        for words in ([owsdtest.OWSD, "--check", "-c", path], [owsdtest.OWSD, "-n", scene.name(), "-c", path],
                      [owsdtest.OWSD, "--check", "-t", target, "-l", "4304"],
                      [owsdtest.OWSCTL, "-t", target.split()[-1], "scan"]):
            done = scene._run(words, 20)
            assert done.returncode == 2 and "this target needs owsd-sim" in done.stderr, (words, done)


def test_what_cannot_be_a_target_is_refused_by_check_and_start(scene):
    wrong = {
        ":": "HOST", "::1": "brackets", "[::1": "HOST", "127.0.0.1:70000": "the port '70000'",
        "127.0.0.1:26000x": "the port '26000x'", "127.0.0.1:": "the port ''",
        "localhost:0": "the port '0'", "localhost: 26000": "the port ' 26000'",
        "foo:bar": "'foo'", "owserver:w1:99999": "the port '99999'", "null:x": "null:",
        "sim:nowhere.sim": "nowhere.sim: ", "sim:": "file", "i2c:": "adapter",
        "i2c:/dev/i2c1": "write /dev/i2c-1", "i2c:/dev/i2c1:0x18": "write /dev/i2c-1",
    }
    for target, reason in wrong.items():
        path = scene.file("wrong.rio", owsdtest.rio(target, [ITEM]))
        for arguments in (["--check", "-c", path], ["-n", scene.name(), "-c", path]):
            done = scene.owsd_once(*arguments)
            assert done.returncode == 2, (target, done)
            assert done.stdout == "", (target, done)
            assert "wrong.rio:3:27: error: target \"" + target + "\": " in done.stderr, done.stderr
            assert reason in done.stderr, (target, done.stderr)
    path = scene.file("right.rio", owsdtest.rio("null:", [ITEM]))
    done = scene.owsd_once("--check", "-c", path, "-t", "127.0.0.1:70000")
    assert done.returncode == 2 and done.stderr.startswith("error: target"), done
    assert scene.owsd_once("--check", "-c", path).returncode == 0


def test_a_strict_check_refuses_what_is_only_warned_of(scene):
    whole = owsdtest.rio("null:", [ITEM])
    path = scene.file("whole.rio", whole)
    assert scene.owsd_once("--check", "--strict", "-c", path).returncode == 0
    for wrong, reason in ((whole.replace("Item {", "item {"), "unknown key item in OwsDrv is ignored; is it Item?"),
                          (whole.replace("Item {", "Item { LimitHi 5"),
                           "unknown key LimitHi in Item is ignored; is it LimitHH or LimitH?")):
        assert wrong != whole
        path = scene.file("wrong.rio", wrong)
        done = scene.owsd_once("--check", "-c", path)
        assert done.returncode == 0 and reason in done.stderr, done
        done = scene.owsd_once("--check", "--strict", "-c", path)
        assert done.returncode == 2 and done.stdout == "" and reason in done.stderr, done
        assert "owsd: --strict: " in done.stderr, done
    done = scene.owsd_once("--strict", "-c", path)
    assert done.returncode == 2 and "--strict goes with --check" in done.stderr, done


def test_a_check_shows_what_it_found_by_line(scene):
    """The number of items is judged when all are read, and the target's device last of all."""
    text = owsdtest.rio("i2c:/dev/i2c-199", [ITEM, ITEM | {"Name": "other"}])
    text = text.replace("ItemCount               2", "ItemCount 5").replace("Item {", "Item { Sensor 5")
    path = scene.file("lines.rio", text)
    done = scene.owsd_once("--check", "--strict", "-c", path)
    places = [line.removeprefix(f"{path}:").split(":") for line in done.stderr.splitlines()]
    lines = [int(place[0]) for place in places if place[0].isdigit()]
    assert lines == sorted(lines) and len(lines) == 4, done.stderr
    assert "owsd: --strict: 4 warnings" in done.stderr.splitlines()[-1], done.stderr


def test_a_device_that_is_not_here_is_a_warning_of_the_check(scene):
    nobody = str(scene.path / "nobody")
    socket.socket(socket.AF_UNIX).bind(nobody)
    for target, path in (("i2c:/dev/i2c-199", "/dev/i2c-199"), ("i2c:/dev/i2c-199:0x18.2", "/dev/i2c-199"),
                         ("gpio:gpiochip99", "gpiochip99"), ("gpio:/dev/gpiochip99", "/dev/gpiochip99"),
                         ("w1:w1_bus_master99", "/sys/bus/w1/devices/w1_bus_master99"),
                         ("w1:netlink/w1_bus_master99", "/sys/bus/w1/devices/w1_bus_master99"),
                         (f"owserver:{scene.path}/none", f"{scene.path}/none"),
                         ("gpio:pinctrl-nix", "pinctrl-nix"), ("i2c:auto", None),
                         ("localhost", None), (f"owserver:{nobody}", None)):
        done = scene.owsd_once("--check", "-c", scene.file("away.rio", owsdtest.rio(target, [ITEM])))
        warning = f'3:27: warning: target "{target}": {path} is not on this machine: ' if path else ""
        assert done.returncode == 0 and warning in done.stderr and bool(path) == bool(done.stderr), done


def test_what_is_here_and_can_never_be_the_target_is_an_error_of_the_check(scene):
    file = scene.file("file", "")
    for target, reason in (("i2c:/dev/null", "/dev/null is no I2C adapter"),
                           (f"i2c:{file}:0x18", f"{file} is no I2C adapter"),
                           (f"i2c:{scene.path}", f"{scene.path} is no I2C adapter"),
                           ("gpio:/dev/null", "/dev/null is not a GPIO chip"),
                           ("owserver:/dev/null", "/dev/null is no socket"),
                           (f"owserver:{file}", f"{file} is no socket")):
        done = scene.owsd_once("--check", "-c", scene.file("never.rio", owsdtest.rio(target, [ITEM])))
        assert done.returncode == 2 and not done.stdout, (target, done)
        assert f'3:27: error: target "{target}": {reason}' in done.stderr, (target, done)
    for key in ("AlarmLine", "HeartbeatLine"):
        for chip, reason in (("/dev/null", "error: {}: /dev/null is not a GPIO chip"),
                             ("nix", "warning: {}: nix is not on this machine: ")):
            text = owsdtest.rio("localhost", [ITEM], **{key: f"{chip}/4"})
            done = scene.owsd_once("--check", "-c", scene.file("line.rio", text))
            assert reason.format(key) in done.stderr, (key, chip, done)


def test_a_start_without_a_configuration_proposes_what_works(scene):
    house = owsdtest.SOURCE / "board/demo/house.sim"
    for program in ("owsd", "owsd-sim"):
        for target in (f"sim:{house}", "w1", "localhost:1,w1", "foo:bar", "sim:/none"):
            done = scene._run([owsdtest.BUILD / program, "-n", scene.name(), "-t", target], 20)
            assert done.returncode == 2, (program, target, done)
            proposed = re.search(r"; (owsctl\S*) -t (\S+) scan --rio makes one", done.stderr)
            refused = target == "foo:bar" or target.startswith("sim:") and \
                (program == "owsd" or target == "sim:/none")
            assert ("\nerror: target " in done.stderr) == refused != bool(proposed), (program, target, done)
            if proposed:
                again = scene._run([owsdtest.BUILD / proposed[1], "-t", proposed[2], "scan", "--rio"], 20)
                assert "target" not in again.stderr, again


def test_a_start_without_a_configuration_says_how_to_come_to_one(scene):
    done = scene._run([owsdtest.OWSD, "-n", scene.name()], 20)
    assert done.returncode == 2
    assert "No such file or directory" in done.stderr and "scan --rio" in done.stderr, done.stderr
    assert "without a configuration, give -t TARGET and -l PORT" in done.stderr, done.stderr
    done = scene._run([owsdtest.OWSD, "-c", scene.path / "none.rio"], 20)
    assert done.returncode == 2 and "scan --rio" not in done.stderr, done.stderr


def test_what_is_no_regular_file_is_refused_at_once(scene):
    pipe = scene.path / "pipe.rio"
    os.mkfifo(pipe)
    for file, kind in ((pipe, "pipe"), (scene.path, "directory"), ("/dev/zero", "device")):
        for words in ([owsdtest.OWSD, "--check", "-c", file], [owsdtest.OWSD, "-n", scene.name(), "-c", file],
                      [owsdtest.OWSCTL, "config", file, "list"],
                      [owsdtest.OWSCTL, "config", file, "set", "OwsDrv", "Timeout=3"],
                      [owsdtest.OWSCTL, "config", file, "add", "a", "/x/y"]):
            done = scene._run(words, 20)
            assert done.returncode == 2, (words, done)
            assert f"{file}: error: is a {kind}: only a regular file is read\n" in done.stderr, (words, done)


def test_an_edit_of_the_file_of_a_running_owsd_says_how_it_is_loaded(scene):
    file = scene.file("house.rio", owsdtest.rio("null:", [ITEM]))
    other = scene.file("other.rio", owsdtest.rio("null:", [ITEM]))

    def said(path, *words):
        done = scene.owsctl(None, "config", path, *words)
        assert done.returncode == 0, done
        return done.stderr
    assert said(file, "set", "x", "Unit=K") == "", "nobody runs"
    daemon = scene.owsd(file)
    hint = f"owsctl: owsd {daemon.name} goes on as before until you run: owsctl -n {daemon.name} reload\n"
    assert said(file, "rename", "x", "kitchen") == hint
    assert said(file, "unset", "kitchen", "Unit") == hint
    # a block of a program beside it is read by that one
    hint = f"owsctl: owsd-mqtt goes on as before until you run: sudo owsctl -n {daemon.name} enable mqtt\n"
    assert said(file, "set", "Mqtt", "Write=on") == hint
    assert said(file, "unset", "Mqtt", "Write") == hint
    assert said(other, "rename", "x", "kitchen") == ""
    assert said(file, "list") == ""
    assert scene.owsctl(daemon, "reload").returncode == 0
    assert "kitchen" in scene.owsctl(daemon, "list").stdout
    for words in (("rename", "kitchen"), ("rename", "kitchen", "a", "b"), ("rename", "kitchen", "a b"),
                  ("rename", "kitchen", "kitchen"), ("rename", "none", "a")):
        before = file.read_bytes()
        done = scene.owsctl(None, "config", file, *words)
        assert done.returncode == 2 and done.stderr and file.read_bytes() == before, done


def test_a_list_takes_json_behind_it(scene):
    file = scene.file("list.rio", owsdtest.rio("localhost", [ITEM]))
    before, behind = (scene._run([owsdtest.OWSCTL, *words], 20) for words in
                      (["--json", "config", file, "list"], ["config", file, "list", "--json"]))
    assert before.returncode == 0 and before.stdout.startswith("{"), before
    assert before.stdout == behind.stdout, behind
    for words, status in ((["more"], 1), (["-x"], 2)):
        assert scene._run([owsdtest.OWSCTL, "config", file, "list", *words], 20).returncode == status


def test_a_list_shows_what_protects_a_plant_and_one_item_alone(scene):
    file = scene.file("list.rio", owsdtest.rio("localhost", [
        dict(Name="freezer", Path="/28.000000000001/temperature", Type="double", LimitHH=-5, LimitH=-15.5,
             LimitLL=-40, Hysteresis=1, OnDelay=300, OffDelay=60, PerFactor=10, StaleAfter=90),
        dict(Name="valve", Path="/05.000000000002/PIO", Type="bool", IO="output", SafeValue="1"),
        ITEM]))
    table = scene.owsctl(None, "config", file, "list").stdout
    lines = [line.split() for line in table.splitlines()]
    titles = next(line for line in lines if line and line[0] == "Name")
    freezer, valve = (dict(zip(titles, line)) for line in lines if line and line[0] in ("freezer", "valve"))
    assert (freezer["LimitLL"], freezer["LimitH"], freezer["LimitHH"]) == ("-40", "-15.5", "-5"), table
    assert (freezer["PerFactor"], freezer["StaleAfter"], freezer["SafeValue"]) == ("10", "90", "-"), table
    assert (valve["SafeValue"], valve["LimitHH"], valve["IO"]) == ("1", "-", "output"), table
    assert "LimitL" not in titles and "InitValue" not in titles and "Alarm" not in titles, table
    one = scene.owsctl(None, "config", file, "list", "x").stdout
    assert "freezer" not in one and "Limit" not in one and "/28.000000000001" in one, one
    told = json.loads(scene.owsctl(None, "--json", "config", file, "list", "fre*", "x").stdout)["items"]
    assert [i["Name"] for i in told] == ["freezer", "x"] and told[1]["LimitHH"] is None
    assert {key: told[0][key] for key in told[0] if key.startswith("Limit") or key.endswith("Delay")} == dict(
        LimitLL=-40, LimitL=None, LimitH=-15.5, LimitHH=-5, SafeDelay=None, OnDelay=300, OffDelay=60)
    assert told[0]["Hysteresis"] == 1 and told[0]["Alarm"] is False and told[0]["IO"] == "input"
    done = scene.owsctl(None, "config", file, "list", "freezr")
    assert done.returncode == 1 and "no item matches" in done.stderr and not done.stdout


def test_a_property_that_the_family_has_not_is_refused_with_the_one_that_was_meant(scene):
    file = scene.file("a.rio", owsdtest.rio("localhost", [ITEM]))
    before = file.read_text()
    for words in (("add", "y", "/28.000000000001/temprature12"),
                  ("add", "y", "/uncached/28.000000000001/Temperature12"),
                  ("set", "x", "Path=/28.000000000001/tempeature12")):
        done = scene.owsctl(None, "config", file, *words)
        assert done.returncode == 2 and "did you mean temperature12?" in done.stderr, done
        assert file.read_text() == before
    done = scene.owsctl(None, "config", file, "add", "y", "/29.000000000001/sensd.3")
    assert done.returncode == 2 and "did you mean sensed.3?" in done.stderr, done
    # another server may know more families and properties than this program
    for number, (path, said) in enumerate((("/28.000000000001/quux", "owsd knows no quux of a DS18B20"),
                                           ("/28.000000000001/errata/die", "is a text or a list"), ("/kitchen/temprature", ""),
                                           ("/6F.000000000001/temprature", ""), ("/29.000000000001/PIO.ALL", "is a text or a list"),
                                           ("/26.000000000001/HIH4000/humidity", ""))):
        for words in (("add", f"z{number}", path), ("set", "x", f"Path={path}")):
            done = scene.owsctl(None, "config", file, *words)
            assert done.returncode == 0 and said in done.stderr and bool(said) == bool(done.stderr), done


def test_a_mistyped_item_has_the_nearest_one(scene):
    file = scene.file("a.rio", owsdtest.rio("localhost", [dict(ITEM, Name=name) for name in ("kitchen", "hall")]))
    before = file.read_text()
    for words in (("set", "kitchn", "Unit=C"), ("unset", "kitchn", "Unit"), ("rename", "kitchn", "x"),
                  ("remove", "kitchn"), ("show", "kitchn"), ("move", "kitchn", "--after", "hall"),
                  ("move", "hall", "--after", "kitchn")):
        done = scene.owsctl(None, "config", file, *words)
        assert 'there is no item "kitchn"; did you mean "kitchen"?\n' in done.stderr, done
        done = scene.owsctl(None, "config", file, *(word.replace("kitchn", "cellar") for word in words))
        assert done.stderr.endswith('there is no item "cellar"\n'), done
    done = scene.owsctl(None, "config", file, "rename", "hall", "hall")
    assert done.returncode == 2 and '"hall" is the name that it has' in done.stderr, done
    assert file.read_text() == before


def test_an_item_is_moved_and_nothing_else_changes(scene):
    items = {name: f"  # about {name}\n  Item {{\n    Name \"{name}\"   # mine\n"
                   f"    Path \"/28.00000000000{name}/temperature\"\n    Type double\n  }}\n" for name in "abc"}
    head, tail = 'OwsDrv {\n  TargetName "localhost"\n', "  # the end\n}\n"
    file = scene.file("a.rio", head + "".join(items.values()) + tail)
    for words, order in ((("c", "--before", "a"), "cab"), (("c", "--after", "b"), "abc"),
                         (("a", "--after", "b"), "bac"), (("a", "--before", "b"), "abc"),
                         (("a", "--before", "b"), "abc"), (("a", "--after", "a"), "abc")):
        done = scene.owsctl(None, "config", file, "move", *words)
        assert (done.returncode, done.stderr) == (0, ""), done
        assert file.read_text() == head + "".join(items[name] for name in order) + tail, words
    for words, what in ((("a", "--before", "d"), 'there is no item "d"'), (("a", "before", "b"), "expected"),
                        (("a", "--before"), "expected"), (("a", "--before", "b", "c"), "expected")):
        done = scene.owsctl(None, "config", file, "move", *words)
        assert done.returncode == 2 and what in done.stderr, done


def test_each_of_several_targets_is_checked(scene):
    path = scene.file("two.rio", owsdtest.rio("localhost:4304 | null:x", [ITEM]))
    for arguments in (["--check", "-c", path], ["-n", scene.name(), "-c", path]):
        done = scene.owsd_once(*arguments)
        assert done.returncode == 2, done
        assert 'two.rio:3:27: error: target "null:x": nothing may follow' in done.stderr, done
    done = scene.owsd_once("--check", "-c", path, "-t", "null:, auto", "-t", "far:4304")
    assert done.returncode == 0, done
    assert '"null:, localhost:4304 | i2c:auto | w1, far:4304"' in done.stdout, done.stdout
    done = scene.owsd_once("--check", "-c", path, "-t", ",".join(f"h{i}" for i in range(65)))
    assert done.returncode == 2 and "at most 64 targets" in done.stderr, done


def test_owserver_without_a_host_is_warned_of(scene):
    path = scene.file("bare.rio", owsdtest.rio("owserver:", [ITEM]))
    done = scene.owsd_once("--check", "-c", path)
    assert done.returncode == 0, done
    assert "bare.rio:3:27: warning: owserver: names no host" in done.stderr, done.stderr


def test_what_cannot_be_printed_is_an_error(scene):
    path = scene.file("right.rio", owsdtest.rio("null:", [ITEM]))
    daemon = scene.owsd(owsdtest.rio("null:", [ITEM]))
    owsd, owsctl = str(owsdtest.OWSD), [str(owsdtest.OWSCTL), "-n", daemon.name]
    for command in ([owsd, "--check", "-c", str(path)], [owsd, "-V"], [owsd, "-h"],
                    [*owsctl, "list"], [*owsctl, "watch"], [*owsctl, "get", "_RECONNECTS"]):
        with open("/dev/full", "wb") as full:
            done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True,
                                  stdin=subprocess.DEVNULL, timeout=owsdtest.PATIENCE, check=False)
        assert done.returncode == 1, (command, done)
        assert "cannot write: No space left on device" in done.stderr, (command, done.stderr)


def test_a_file_that_may_not_grow_is_an_error_and_no_end_by_signal(scene):
    path = scene.file("right.rio", owsdtest.rio("null:", [
        dict(ITEM, Name=f"x{i}") for i in range(100)]))
    for command in ([owsdtest.OWSD, "--check", "-c", path],
                    [owsdtest.OWSCTL, "config", path, "list"]):
        out = scene.path / "out"
        done = subprocess.run(["sh", "-c", 'ulimit -f 1; exec "$@" >out', "sh",
                               *map(str, command)], cwd=scene.path, stderr=subprocess.PIPE,
                              text=True, stdin=subprocess.DEVNULL, timeout=owsdtest.PATIENCE, check=False)
        assert done.returncode == 1, (command, done)
        assert "cannot write: File too large" in done.stderr, (command, done.stderr)
        out.unlink()


def test_messages_do_not_steer_the_terminal(scene):
    daemon = scene.owsd(owsdtest.rio("null:", [ITEM]))
    evil = "a\x1b[31m\u202e\x9b"
    for done in (scene.owsctl(daemon, "get", evil), scene.owsctl(daemon, "set", evil, "1"),
                 scene.owsctl(daemon, evil), scene.owsctl(evil, "list"),
                 scene.owsctl(None, "config", scene.path / "a.rio", "remove", evil),
                 scene.owsd_once("-n", evil), scene.owsd_once(evil),
                 scene.owsd_once("-c", scene.path / evil)):
        assert done.returncode in (1, 2), done
        assert done.stderr and not set(done.stderr) & set("\x1b\u202e\x9b"), ascii(done.stderr)


def test_one_line_cannot_be_two_lamps(scene):
    text = owsdtest.rio("null:", [], AlarmLine="gpiochip0/4", HeartbeatLine="gpiochip0/4")
    done = scene.owsd_once("--check", "-c", scene.file("lamps.rio", text))
    assert done.returncode == 2 and "the same line" in done.stderr, done


def test_what_is_wrong_with_a_lamp_has_its_line_and_column(scene):
    for key in ("AlarmLine", "HeartbeatLine"):
        file = scene.file("lamp.rio", f'OwsDrv {{\n  TargetName "null:"\n  {key} "x"\n}}\n')
        done = scene.owsd_once("--check", "-c", file)
        assert done.returncode == 2 and f"{file}:3:{4 + len(key)}: error: {key}: " in done.stderr, done


def test_the_usage_of_a_program_has_its_name(scene):
    for name in ("owsd", "owsd-sim", "owsctl", "owsctl-sim"):
        done = scene._run([owsdtest.BUILD / name, "--help"], 20)
        assert done.returncode == 0 and done.stdout.startswith(f"usage: {name} "), done


if __name__ == "__main__":
    owsdtest.main()
