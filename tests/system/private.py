# SPDX-License-Identifier: MIT
"""A test in a mount namespace of its own, in place of owsdtest.main():

    private.main(users=True)

/dev/shm is a small one, and has the directory of owsd. With users (needs root) that is /run/owsd, as
the service's, in a /run of the test's own; /etc/passwd and /etc/group have, beside what they had, the
user and the groups of the package and the people that USERS lists; room() is a folder that
all of them reach, and where the test's own files are; nothing of the machine is changed.
as_user(NAME) begins a command that runs as one of them, without any right of root.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import owsdtest

INSIDE = "OWSD_TEST_IN_NAMESPACE"
# Whose contents nobody misses while an empty file system is over one of them
ROOMS = ("/tmp", "/mnt", "/media", "/srv", "/var/tmp")
OWSD, CONTROL, CONFIG = 64711, 64712, 64713
# name: user id, groups; the first group is his own
USERS = {
    "owsd": (OWSD, (OWSD, CONTROL, CONFIG)),
    "reader": (64721, (64721, OWSD)),
    "plc": (64722, (64722, OWSD, CONTROL)),
    "setter": (64723, (64723, CONTROL)),
    "stranger": (64724, (64724,)),
    "editor": (64725, (64725, CONFIG)),
    "owsd-writer": (64726, (CONFIG, OWSD)),
}


def as_user(name):
    uid, groups = USERS[name]
    return ["setpriv", f"--reuid={uid}", f"--regid={groups[0]}", f"--groups={','.join(map(str, groups))}",
            "--bounding-set=-all", "--inh-caps=-all", "--no-new-privs"]


def room():
    return pathlib.Path(os.environ.get(INSIDE, "/tmp"))


def _free_room():
    """The first that has neither the checkout, nor the build, nor this Python."""
    needed = [pathlib.Path(path).resolve() for path in (owsdtest.SOURCE, owsdtest.BUILD, sys.argv[0], sys.prefix)]
    for name in ROOMS:
        path = pathlib.Path(name).resolve()
        if path.is_dir() and not any(need.is_relative_to(path) for need in needed):
            return str(path)
    _skip(f"the checkout and its build leave none of {', '.join(ROOMS)} to it")


def _write_users(folder):
    groups = {"owsd": OWSD, "owsd-control": CONTROL, "owsd-config": CONFIG}
    for kind, lines in (("passwd", [f"{name}:x:{uid}:{g[0]}::/nonexistent:/bin/sh"
                                    for name, (uid, g) in USERS.items()]),
                        ("group", [f"{name}:x:{gid}:" for name, gid in groups.items()])):
        own = [line for line in pathlib.Path("/etc", kind).read_text().splitlines()
               if line.split(":")[0] not in {**USERS, **groups}]
        (folder / kind).write_text("\n".join(own + lines) + "\n")
    return " && ".join(f"mount --bind {folder}/{kind} /etc/{kind}" for kind in ("passwd", "group"))


def _skip(why):
    print(f"skip all: {why}")
    print("0 passed, 0 failed, 1 skipped")
    sys.exit(0)


def main(users=False, at_once=1):
    if os.environ.get(INSIDE):
        os.environ["TMPDIR"] = str(room())
        if users:
            os.chown(owsdtest.place(), OWSD, OWSD)
        owsdtest.main(at_once)
    root = os.geteuid() == 0
    if users and not root:
        _skip("needs root, to become other users")
    if users and not shutil.which("setpriv"):
        _skip("setpriv is not installed")
    place = _free_room() if users else "/tmp"
    where = "/run/owsd" if users else "/dev/shm/owsd"
    with tempfile.TemporaryDirectory() as folder:
        mounts = "mount -t tmpfs -o size=3m,mode=1777 tmpfs /dev/shm"
        if users:
            mounts += " && mount -t tmpfs -o size=3m,mode=755 tmpfs /run"
            # programs and files where everybody reaches them
            mounts += " && " + _write_users(pathlib.Path(folder)) + \
                f" && mount -t tmpfs -o mode=1777 tmpfs {place}"
        inside = [shutil.which("unshare") or "unshare", "-m", *([] if root else ["-r"]), "sh", "-c",
                  f'{mounts} && cd {place} && exec "$@"', "sh"]
        try:
            subprocess.run([*inside, "true"], check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError) as why:
            _skip(f"no mount namespace of one's own: {getattr(why, 'stderr', why)}")
        status = subprocess.run([*inside, sys.executable, os.path.abspath(sys.argv[0]), *sys.argv[1:]],
                                env=dict(os.environ, OWS_DIR=where, **{INSIDE: place}), check=False).returncode
    sys.exit(status)
