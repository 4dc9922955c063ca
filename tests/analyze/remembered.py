# SPDX-License-Identifier: MIT
"""What an analyzer found nothing in, kept in the user's cache so that it is not read again.

The key of a result is a hash of all that the analyzer sees: the command, the version and the binary
of the tool, .clang-tidy, and the names and bytes of the file and of every header that it includes,
those of the system too, as the compiler lists them (-M) at that moment. Only clean results are kept:
what was found is found again in each run. A result that is not used for DAYS days is removed.
"""

import hashlib
import os
import pathlib
import shlex
import subprocess
import time

WHERE = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd/analyze"
DAYS = 30
LIMIT = 60
FORMAT = "1"


def binary_of(program):
    """What says that a program is the same: where it is, size and time of the file."""
    real = os.path.realpath(program)
    about = os.stat(real)
    return f"{real} {about.st_size} {about.st_mtime_ns}"


class Memory:
    """Of one tool. `lists` is the compiler that lists headers as the tool sees them."""

    def __init__(self, lists, version, binaries, flags):
        self.lists, self.flags = lists, flags
        self.about = [FORMAT, version, *map(binary_of, binaries)]
        self.hashes = {}

    def hash_of(self, path):
        about = os.stat(path)
        seen = (path, about.st_size, about.st_mtime_ns, about.st_ino)
        if seen not in self.hashes:
            self.hashes[seen] = hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
        return self.hashes[seen]

    def key_of(self, file, command):
        """None: nothing can be said of this file."""
        try:
            listed = subprocess.run([*self.lists, *self.flags, "-M", file], stdin=subprocess.DEVNULL,
                                    capture_output=True, text=True, timeout=LIMIT, check=True).stdout
            read = shlex.split(listed.replace("\\\n", " "))[1:]
            if file not in read:
                return None
            read.append(".clang-tidy")
            parts = [*self.about, *command, *(f"{path} {self.hash_of(path)}" for path in read)]
        except (OSError, ValueError, subprocess.SubprocessError):
            return None
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()

    def is_clean(self, key):
        if not key:
            return False
        try:
            os.utime(WHERE / key)
        except OSError:
            return False
        return True

    def keep(self, key):
        if not key:
            return
        try:
            WHERE.mkdir(parents=True, exist_ok=True)
            (WHERE / key).touch()
        except OSError:
            pass  # it is read again then


class Nothing:
    """Remembers nothing."""

    def key_of(self, _file, _command):
        return None

    def is_clean(self, _key):
        return False

    def keep(self, _key):
        pass


def memory_of(tool, program, version, flags):
    """For gcc and clang-tidy; a tool whose parts are not where they are expected remembers nothing."""
    if os.environ.get("OWSD_ANALYZE_ALL", "0") != "0":
        return Nothing()
    try:
        real = os.path.realpath(program)
        if tool == "gcc":
            inside = subprocess.run([program, "-print-prog-name=cc1"], capture_output=True, text=True,
                                    timeout=LIMIT, check=True).stdout.strip()
            return Memory([program], version, [real, inside], flags)
        clang = os.path.join(os.path.dirname(real), "clang")
        return Memory([clang], version, [real, clang], flags)
    except (OSError, subprocess.SubprocessError):
        return Nothing()


def forget_old():
    try:
        for entry in os.scandir(WHERE):
            if entry.stat().st_mtime < time.time() - DAYS * 86400:
                os.unlink(entry.path)
    except OSError:
        pass
