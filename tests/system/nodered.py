# SPDX-License-Identifier: MIT
"""A genuine Node-RED from the registry of npm, kept in the user's cache: a flow is imported and run.

    judge = nodered.start(scene, flow)                  # flow: the list of its nodes
    judge = nodered.start(scene, flow, "node-red-contrib-modbus@5.23.3")    # with nodes of others
"""

import fcntl
import json
import os
import pathlib
import shutil
import subprocess

import owsdtest

# The Node-RED, and the Node.js that it runs on
NODE_RED = ("node-red@5.0.7", "node@22.23.3")
INSTALL_SECONDS = 300  # less than what a test may take


def _installed(name, packages, *options):
    """The folder node_modules of them, out of the cache or, once, from the registry."""
    npm = shutil.which("npm") or owsdtest.skip("no npm here (package npm)")
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    base.mkdir(parents=True, exist_ok=True)
    place = base / name
    with open(base / f"{name}.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "versions").exists() or (place / "versions").read_text() != str(packages):
            shutil.rmtree(place, ignore_errors=True)
            place.mkdir()
            try:
                done = subprocess.run([npm, "install", "--prefix", place, "--no-audit", "--no-fund", *options, *packages],
                                      check=False, capture_output=True, text=True, timeout=INSTALL_SECONDS)
                last = done.stderr.strip().splitlines()[-1:]
            except subprocess.TimeoutExpired:
                done, last = None, "it takes too long"
            if not done or done.returncode:
                owsdtest.skip(f"not cached and cannot be had: {packages[0]}: {last}")
            (place / "versions").write_text(str(packages))
    return place / "node_modules"


def start(scene, flow, nodes=None):
    """nodes: a package of nodes, without what it can do without."""
    modules, place = _installed("node-red", NODE_RED), scene.path / "node-red"
    place.mkdir()
    if nodes:
        name = nodes.rpartition("@")[0]
        (place / "node_modules").symlink_to(_installed(name, (nodes,), "--omit=optional", "--ignore-scripts"))
        # Node-RED loads those that its user has asked for
        (place / "package.json").write_text(json.dumps({"dependencies": {name: nodes.rpartition("@")[2]}}))
    (place / "flows.json").write_text(json.dumps(flow))
    (place / "settings.js").write_text('module.exports = {flowFile: "flows.json", uiHost: "127.0.0.1", '
                                       f'uiPort: {owsdtest.free_port()}, telemetry: {{enabled: false}}}};\n')
    return scene.start([modules / "node/bin/node", modules / "node-red/red.js", "-u", place, "-s", place / "settings.js"],
                       {"HOME": str(place)})
