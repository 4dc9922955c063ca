# SPDX-License-Identifier: MIT
"""The files that are checked: those of git, or all of a tree without it, but for what is built."""

import functools
import os
import pathlib
import subprocess

OURS = ("src/", "hal/", "tests/")


class Skip(Exception):
    pass


class Tree:
    def __init__(self, top):
        self.top = pathlib.Path(top)
        done = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=top,
                              capture_output=True, check=False)
        if done.returncode == 0:
            names = set(done.stdout.decode().split("\0")) - {""}
        else:
            names = {str(pathlib.Path(folder, n).relative_to(top)) for folder, _, some in os.walk(top)
                     for n in some if not folder.startswith(str(self.top / "build"))}
        self.files = sorted(n for n in names if (self.top / n).is_file() and
                            not (self.top / n).is_symlink())

    @functools.cache
    def bytes(self, file):
        return (self.top / file).read_bytes()

    @functools.cache
    def text(self, file):
        return self.bytes(file).decode(errors="replace")

    def ending(self, *suffixes):
        return [f for f in self.files if f.endswith(suffixes)]

    def c(self):
        """C of ours."""
        return [f for f in self.ending(".c", ".h") if f.startswith(OURS)]

    def scripts(self, *interpreters):
        """Files whose first line names one of these."""
        def first(file):
            return self.bytes(file)[:80].split(b"\n")[0].decode(errors="replace")
        return [f for f in self.files if first(f).startswith("#!") and
                os.path.basename(first(f).split()[-1].split("/")[-1]).rstrip("3") in interpreters]

    def line_of(self, file, words):
        """The line where words stand first."""
        return self.text(file)[:max(self.text(file).find(words), 0)].count("\n") + 1


def parallel(command, files, at_once=None):
    """The outputs of a command, for some files each, beside each other."""
    at_once = at_once or os.cpu_count() or 1
    size = max(1, min(64, len(files) // (4 * at_once) + 1))
    running, outputs = [], []
    for part in (files[n:n + size] for n in range(0, len(files), size)):
        running.append(subprocess.Popen([*command, *part], stdin=subprocess.DEVNULL, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        errors="replace"))
        if len(running) >= at_once:
            outputs.append(running.pop(0).communicate()[0])
    return outputs + [child.communicate()[0] for child in running]
