# SPDX-License-Identifier: MIT
"""Programs of others in Go, built once, in the user's cache: from the module proxy, or from a clone
at owsd/NAME/source there."""

import fcntl
import os
import pathlib
import shutil
import subprocess

import owsdtest

SECONDS = 400  # what was fetched until then is there the next time


def program(package, version, *flags):
    """What `go install PACKAGE@VERSION` makes; the package is .../cmd/NAME. Without it the case is skipped."""
    name = package.rsplit("/", 1)[1]
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd" / name
    go = shutil.which("go") or shutil.which("/usr/local/go/bin/go")
    made, source = base / version[:12] / name, base / "source"
    if made.exists():
        return made
    if not go:
        owsdtest.skip("there is no go")
    base.mkdir(parents=True, exist_ok=True)
    with open(base / "lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        what = ["build", *flags, "-o", made, f"./cmd/{name}"] if source.exists() else ["install", *flags, f"{package}@{version}"]
        try:
            why = subprocess.run([go, *what], cwd=source if source.exists() else base, capture_output=True, text=True,
                                 timeout=SECONDS, check=False, env={**os.environ, "GOTOOLCHAIN": "local", "CGO_ENABLED": "0",
                                                                    "GOBIN": str(made.parent)}).stderr.strip()
        except subprocess.TimeoutExpired:
            why = "it takes too long"
    if not made.exists():
        owsdtest.skip(f"{name} cannot be had; a clone of it may be at {source}: {(why.splitlines() or ['?'])[-1]}")
    return made
