# SPDX-License-Identifier: MIT
"""The service's rules as far as they can be had without systemd as the first process.

    sandbox.calls()            names that SystemCallFilter= of the unit leaves
    sandbox.command()          the program, with arguments, that runs another under those rules
    sandbox.command(unit)      the same under the rules of another unit
"""

import re
import socket
import subprocess

import faulty
import owsdtest

UNITS = owsdtest.SOURCE / "board/systemd"
UNIT = UNITS / "owsd@.service"
SANDBOX = owsdtest.BUILD / "system" / "sandbox"


def settings(key, unit=UNIT):
    """All values of a key of the unit, in order."""
    return re.findall(rf"^{key}=(.*)$", unit.read_text(), re.M)


def _group(name):
    """All calls of one of systemd's groups."""
    try:
        done = subprocess.run(["systemd-analyze", "syscall-filter", name], text=True, check=True,
                              capture_output=True)
    except (OSError, subprocess.CalledProcessError) as why:
        owsdtest.skip(f"systemd-analyze cannot tell its groups: {why}")
    words = [line.strip() for line in done.stdout.splitlines()[1:]]
    return _expand(word for word in words if word and not word.startswith("#"))


def _expand(words):
    names = set()
    for word in words:
        names |= _group(word) if word.startswith("@") else {word}
    return names


def calls(unit=UNIT):
    """As systemd reads it: the first line is the list, each later one adds to it or, with ~, takes
    away."""
    faulty.not_sanitized("the sanitizer's own calls are not the program's")
    allowed = set()
    for line in settings("SystemCallFilter", unit):
        names = _expand(line.lstrip("~").split())
        allowed = allowed - names if line.startswith("~") else allowed | names
    assert allowed, "the unit has no SystemCallFilter"
    return allowed


def numbers():
    """Of every call that this machine's kernel headers know, its number."""
    done = subprocess.run(["cc", "-E", "-dM", "-x", "c", "-"], input="#include <sys/syscall.h>\n", text=True,
                          capture_output=True, check=False)
    found = dict(re.findall(r"^#define __NR_(\w+) (\d+)$", done.stdout, re.M))
    if not found:
        owsdtest.skip("no compiler that tells the numbers of system calls")
    return found


def _ranges(numbers_in_order):
    ranges = []
    for n in numbers_in_order:
        if ranges and n == ranges[-1][1] + 1:
            ranges[-1][1] = n
        else:
            ranges.append([n, n])
    return ",".join(f"{first}-{last}" for first, last in ranges)


def command(unit=UNIT):
    owsdtest.need(SANDBOX)
    number = numbers()
    # what starts a program is systemd's, before the rules hold
    wanted = sorted(int(number[name]) for name in calls(unit) | {"execve"} if name in number)
    families = [int(getattr(socket, name))
                for line in settings("RestrictAddressFamilies", unit) for name in line.split()]
    return [str(SANDBOX), _ranges(wanted), _ranges(sorted(families))]
