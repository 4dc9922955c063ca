#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-modbus and a network that is cut: connections of which one end knows nothing. Needs root, to
make network namespaces; nothing of the machine's own network is touched."""

import re
import sys

import owsdtest
from modbushouse import MODBUS, RELAYS, ROOM, SHORT, text
from owsdtest import SOURCE, logged, until
from test_netns import V4, cable

PORT = 1502

# A PLC that sets an output and goes on to read, until it learns that its connection is over
PLC = f"""
import sys, time
sys.path.insert(0, {str(SOURCE / "tests/system")!r})
from modbushouse import Client
with Client({PORT}, host={V4[0]!r}) as plc, Client({PORT}, host={V4[0]!r}) as idle:
    idle.registers(0, 1)
    plc.write_one({32 + SHORT}, 5)
    plc.socket.settimeout(None)
    while True:
        plc.registers(0, 5)
        time.sleep(0.2)  # pace
"""


def test_a_cut_cable_leaves_outputs_safe_and_no_connection_behind(scene):
    owsdtest.need(MODBUS)
    with cable() as net:
        safe = {**RELAYS, "SafeValue": 9, "SafeDelay": 0}
        daemon = scene.owsd(text(scene, PORT, ROOM, safe, Listen=f"{V4[0]}:{PORT}", Write="on",
                                 Allow=f"relays {V4[1]}", Beat=3))
        face = scene.start([*net.inside(net.server), MODBUS, "-v", "-n", daemon.name, "-c", daemon.config],
                           {"STATE_DIRECTORY": str(scene.path / "state")})
        logged(face, f"Modbus is served at {V4[0]}:{PORT}")

        def becomes(value):
            until(lambda: scene.get(daemon, "relays") == value, 20, lambda: scene.get(daemon, "relays"))

        def plc():
            return scene.start([*net.inside(net.clients), sys.executable, "-c", PLC])

        def ask(where):
            words = PLC.replace("plc.write_one", "assert plc.registers(0, 1) == (0x4F57,); sys.exit() #")
            return scene._run([*net.inside(where), sys.executable, "-c", words], 30).returncode
        first = plc()
        becomes("5")
        net.ip("-n", net.clients, "link", "set", "wire", "down")
        becomes("9")
        assert first.running()  # it knows of nothing
        assert ask(net.server) == 0  # and others are answered as before
        ended = re.compile(re.escape(V4[1]) + r":\d+: Connection timed out")
        # the one that was answered last, and the one that was silent
        until(lambda: len(ended.findall(face.log())) == 2, 60, face.log)
        net.ip("-n", net.clients, "link", "set", "wire", "up")
        second = plc()
        becomes("5")
        # the first one's next request meets no connection
        until(lambda: not first.running(), 60, first.log)
        assert second.running() and "Connection reset" in first.log(), first.log()
        assert face.stop() == 0


if __name__ == "__main__":
    owsdtest.main()
