#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd under the unit's own filter of system calls and addresses: all that it does it still does."""

import collections
import os
import re
import shutil
import signal

import faulty
import owsdtest
import private
import sandbox
from owsdtest import until

CALL = re.compile(r"^(?:\d+ +)?(?:<\.\.\. )?(\w+)\(.*")


def everything(scene, more=False):
    """Every kind of target and of door that a configuration can have."""
    port = scene.port = getattr(scene, "port", None) or owsdtest.free_port()
    text = faulty.house(scene, more=more, ListenSocket=str(scene.path / "socket"),
                        Listen=f"127.0.0.1:{port}", HeartbeatLine="nochip/3")
    gone = owsdtest.free_port()
    return text.replace('"sim:', f'"127.0.0.1:{gone}, i2c:/dev/i2c-199, w1, gpio:nochip, sim:', 1)


def live(scene, *prefix):
    """Start, values, commands, both doors, a reload, the end: what the log said."""
    config = scene.file("house.rio", everything(scene))
    daemon = faulty.Traced.start(scene, config, prefix, "-v") if prefix[0] == "strace" else \
        scene.owsd(config, "-v", prefix=prefix, env={"WATCHDOG_USEC": "400000"})
    until(lambda: scene.get(daemon, "room") == "21.5", 30, "room is good")
    assert scene.owsctl(daemon, "set", "relays", "5").returncode == 0
    until(lambda: scene.get(daemon, "relays") == "5", 30, "an output is written")
    for door in (f"owserver:{scene.path}/socket", f"127.0.0.1:{scene.port}"):
        for words in (("dir", "/"), ("read", "/uncached/28.A0B1C2000001/temperature9"),
                      ("write", "/28.A0B1C2000001/temphigh", "60")):
            done = scene.owsctl(None, "-t", door, *words)
            assert done.returncode == 0, done
    config.write_text(everything(scene, more=True))
    daemon.signal(signal.SIGHUP)
    until(lambda: scene.get(daemon, "hall") == "19.5", 30, "the reload is done")
    return daemon


def test_under_the_units_filter_it_does_all_that_it_does(scene):
    daemon = live(scene, *sandbox.command())
    with open(f"/proc/{daemon.pid}/status", encoding="ascii") as status:
        facts = dict(line.rstrip("\n").split(":\t", 1) for line in status if ":\t" in line)
    assert facts["Seccomp"].strip() == "2" and facts["NoNewPrivs"].strip() == "1", facts
    assert daemon.stop() == 0
    assert "ot permitted" not in daemon.log(), daemon.log()


def test_no_call_that_it_makes_is_forbidden(scene):
    if not shutil.which("strace"):
        owsdtest.skip("strace is not installed")
    trace = scene.path / "trace"
    allowed = sandbox.calls()
    daemon = live(scene, "strace", "-f", "-qq", "-o", trace)
    daemon.signal(signal.SIGTERM)
    assert daemon.wait(20) == 0
    made = collections.Counter(call[1] for call in map(CALL.match, trace.read_text(
        errors="replace").splitlines()) if call)
    assert len(made) > 30 and made["socket"] and made["clone3"] + made["clone"], made
    forbidden = {name: n for name, n in made.items() if name not in allowed | {"execve"}}
    assert not forbidden, f"owsd@.service forbids {forbidden}"
    print(f"{len(made)} kinds of calls of {len(allowed)} that are allowed")


def setting(name):
    return re.search(rf"^{name}=(.*)$", sandbox.UNIT.read_text(), re.M).group(1)


def test_the_units_limits_leave_room_for_the_largest_owsd(scene):
    faulty.not_sanitized("a sanitizer's memory is not the program's")
    # As many targets as there can be with both doors, then 2 000 signals that are loaded again:
    # the room is for many times as many
    door = scene.path / "door"
    wires = [scene.file(f"{n}.sim", f"chip DS2482-100 0x18\nDS18B20 28.{n:012X}\n") for n in range(1, 17)]
    daemon = scene.owsd(owsdtest.rio(", ".join(f"sim:{wire}" for wire in wires), [
        dict(Name="room", Path="/28.000000000001/temperature", Type="double", IO="input")],
        ListenSocket=str(door), Listen=f"127.0.0.1:{owsdtest.free_port()}"))
    until(lambda: scene.get(daemon, "room"), 30, "room is good")
    assert 16 < len(os.listdir(f"/proc/{daemon.pid}/task")) <= int(setting("TasksMax")) // 2
    daemon.stop()
    many = [dict(Name=f"s{n}", Path="/28.000000000001/temperature", Type="double", IO="input",
                 PerFactor=1000) for n in range(2000)]
    file = scene.file("many.rio", owsdtest.rio("null:", many))
    daemon = scene.owsd(file)
    file.write_text(owsdtest.rio("null:", many[1:]))
    daemon.signal(signal.SIGHUP)
    until(lambda: "reload:" in daemon.log(), 30, "it is loaded again")
    with open(f"/proc/{daemon.pid}/status", encoding="ascii") as status:
        peak = int(re.search(r"^VmHWM:\s+(\d+) kB", status.read(), re.M).group(1)) * 1024
    assert setting("MemoryMax") == "512M" and peak * 20 < 512 << 20, peak
    assert setting("LimitCORE") == "0"


# What a drop-in of the examples takes away, as its page says
TAKEN = {"local.conf": {("ReadWritePaths", "-/sys/devices")}, "realtime.conf": {("RestrictRealtime", "yes"),
         ("ExecStart", "@SBINDIR@/owsd -n %i $OWSD_OPTIONS")}}
# Of these keys the last value counts, of the others all of them
ONE = {"RestrictRealtime", "LimitRTPRIO", "LimitMEMLOCK"}


def joined(*files):
    """Keys and values of [Service] as systemd reads a unit and its drop-ins: an empty value takes away
    all that came before."""
    values = collections.defaultdict(list)
    for file in files:
        for key, value in re.findall(r"^(\w+)=(.*)$", file.read_text().partition("[Service]")[2], re.M):
            values[key] = values[key] + [value] if value and key not in ONE else [value][:bool(value)]
    return {(key, value) for key, found in values.items() for value in found}


def test_a_drop_in_takes_away_no_more_than_it_says(scene):
    del scene
    drop_ins = sorted((sandbox.UNITS / "examples").glob("*.conf"))
    assert {file.name for file in drop_ins} > set(TAKEN)
    unit = joined(sandbox.UNIT)
    for file in drop_ins:
        assert unit - joined(sandbox.UNIT, file) == TAKEN.get(file.name, set()), file


# In which module of Debian's kernel a group of devices is; one that is built in needs none
MODULES = {"char-i2c": {"i2c_dev"}, "char-gpiochip": set(), "char-tty?*": {"usbserial", "cdc_acm"},
           "char-usb_device": set()}


def test_the_drivers_of_allowed_devices_are_there_before_it_starts(scene):
    del scene
    allowed = {line.split()[0] for line in sandbox.settings("DeviceAllow")}
    modules = {f"modprobe@{name}.service" for group in allowed for name in MODULES[group]}
    for key in ("Wants", "After"):
        assert modules <= set(" ".join(sandbox.settings(key)).split()), key


def test_the_rules_hold(scene):
    """The filter is no empty one: what it forbids fails, and so does a foreign address."""
    tries = {"os.nice(1)": False, "os.chroot('/')": False, "os.sched_setscheduler(0, 1, os.sched_param(1))":
             False, "socket.socket(socket.AF_PACKET, socket.SOCK_RAW)": False,
             "socket.socket(socket.AF_INET, socket.SOCK_STREAM)": True, "os.getpid()": True}
    for what, works in tries.items():
        done = scene._run([*sandbox.command(), shutil.which("python3"), "-c",
                           f"import os, socket\n{what}"], 30)
        assert (done.returncode == 0) == works, (what, done)
        assert works or "ermi" in done.stderr or "not supported" in done.stderr, (what, done)


if __name__ == "__main__":
    # with the groups there are more calls: the segments are given to them
    private.main(users=True) if os.geteuid() == 0 else owsdtest.main()
