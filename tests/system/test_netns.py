#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The served protocol over a network: owsd in one network namespace, its clients in another, with
a cable between the two and addresses of their own. Needs root; nothing of the machine's own network
is touched."""

import contextlib
import os
import shutil
import subprocess
import sys

import faulty
import owsdtest
from owsdtest import until

PORT = 4304  # in a namespace of its own every port is free
V4, OTHER4 = ("192.0.2.1", "192.0.2.2"), ("198.51.100.1", "198.51.100.2")
V6, OTHER6 = ("2001:db8:1::1", "2001:db8:1::2"), ("2001:db8:2::1", "2001:db8:2::2")
ROOM = "/28.A0B1C2000001/temperature9"


class Cable:
    """Two namespaces with a pair of interfaces between them: server and clients."""

    serial = 0

    def __init__(self):
        Cable.serial += 1
        self.server, self.clients = (f"owsd{os.getpid()}{side}{Cable.serial}" for side in "sc")

    def lay(self):
        for name in (self.server, self.clients):
            self.ip("netns", "add", name)
        self.ip("link", "add", "wire", "netns", self.server, "type", "veth", "peer", "name", "wire",
                "netns", self.clients)
        for side, name in enumerate((self.server, self.clients)):
            for address in (V4, OTHER4):
                self.ip("-n", name, "address", "add", f"{address[side]}/24", "dev", "wire")
            for address in (V6, OTHER6):
                self.ip("-n", name, "address", "add", f"{address[side]}/64", "dev", "wire", "nodad")
            for interface in ("lo", "wire"):
                self.ip("-n", name, "link", "set", interface, "up")

    def remove(self):
        for name in (self.server, self.clients):
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)

    @staticmethod
    def ip(*words):
        subprocess.run(["ip", *words], check=True)

    def inside(self, name):
        return ["ip", "netns", "exec", name]

    def owsd(self, scene, *listen, **driver):
        options = [word for address in listen for word in ("-l", address)]
        daemon = scene.owsd(faulty.house(scene, **driver), *options, prefix=self.inside(self.server))
        until(lambda: scene.get(daemon, "room") == "21.5", 20)
        return daemon

    def ask(self, scene, target, namespace=None):
        return scene._run([*self.inside(namespace or self.clients), owsdtest.OWSCTL, "-t", target, "read",
                           ROOM], 60)

    def client(self, scene, text):
        """A client that lives for a while: python with the module served."""
        program = "import socket, sys, time\nsys.path.insert(0, " \
                  f"{str(owsdtest.SOURCE / 'tests/system')!r})\nimport served\n" + text
        return scene.start([*self.inside(self.clients), sys.executable, "-c", program])


@contextlib.contextmanager
def cable():
    if os.geteuid():
        owsdtest.skip("needs root, to make network namespaces")
    if not shutil.which("ip"):
        owsdtest.skip("ip is not installed")
    made = Cable()
    try:
        try:
            made.lay()
        except subprocess.CalledProcessError as why:
            owsdtest.skip(f"no network namespaces: {why}")
        yield made
    finally:
        made.remove()


def told(done, value):
    return done.returncode == 0 and done.stdout.strip() == value


def test_a_port_alone_is_for_this_machine_alone(scene):
    with cable() as net:
        daemon = net.owsd(scene, str(PORT))
        for target in (f"127.0.0.1:{PORT}", f"[::1]:{PORT}"):
            assert told(net.ask(scene, target, net.server), "21.5")
        for address in (V4[0], OTHER4[0], f"[{V6[0]}]", "127.0.0.1"):
            done = net.ask(scene, f"{address}:{PORT}")
            assert done.returncode != 0 and "refused" in done.stderr, (address, done)
        # nor through a route to our own loopback address
        for command in ((*net.inside(net.clients), "sysctl", "-qw", "net.ipv4.conf.all.route_localnet=1"),
                        (*net.inside(net.clients), "ip", "route", "add", "127.77.0.0/16", "via", V4[0],
                         "src", V4[1])):
            subprocess.run(command, check=False, capture_output=True)
        assert net.ask(scene, f"127.77.0.1:{PORT}").returncode != 0
        until(lambda: faulty.counters(scene, daemon)["served_connections"] >= 2, 10)
        assert faulty.counters(scene, daemon)["served_refused_peers"] == 0


def test_only_networks_that_are_allowed_reach_an_address(scene):
    with cable() as net:
        daemon = net.owsd(scene, f"{V4[0]}:{PORT}", f"[{V6[0]}]:{PORT}",
                          ListenAllow="192.0.2.0/24, 2001:db8:1::/64")
        owsdtest.logged(daemon, "served beyond this machine")
        for target in (f"{V4[0]}:{PORT}", f"[{V6[0]}]:{PORT}"):
            assert told(net.ask(scene, target), "21.5"), target
        # an address that nobody listens at
        assert "refused" in net.ask(scene, f"{OTHER4[0]}:{PORT}").stderr
        refused = 0
        for family, source, target in (("AF_INET", OTHER4[1], V4[0]), ("AF_INET6", OTHER6[1], V6[0])):
            stranger = net.client(scene, f"""
s = socket.socket(socket.{family})
s.settimeout(60)
s.bind(({source!r}, 0))
s.connect(({target!r}, {PORT}))
try:
    s.sendall(served.request(served.READ, {ROOM!r}))
    print('got', s.recv(1))
except ConnectionError as why:
    print('got', why)
""")
            assert stranger.wait(30) == 0, stranger.log()
            assert any(end in stranger.log() for end in ("got b''", "reset", "Broken pipe")), stranger.log()
            refused += 1
            until(lambda: faulty.counters(scene, daemon)["served_refused_peers"] == refused, 10)
        owsdtest.logged(daemon, f"refused: {OTHER4[1]} is not in ListenAllow")
        assert told(net.ask(scene, f"{V4[0]}:{PORT}"), "21.5"), "the others are still served"


def test_read_only_is_read_only_from_everywhere(scene):
    with cable() as net:
        net.owsd(scene, f"{V4[0]}:{PORT}", ListenReadOnly="on", ListenAllow="192.0.2.0/24")
        assert told(net.ask(scene, f"{V4[0]}:{PORT}"), "21.5")
        done = scene._run([*net.inside(net.clients), owsdtest.OWSCTL, "-t", f"{V4[0]}:{PORT}", "write",
                           "/29.A0B1C2000004/PIO.BYTE", "7"], 30)
        assert done.returncode != 0, done


def clients(scene, daemon):
    return faulty.counters(scene, daemon)["served_clients"]


def sockets(daemon):
    """How many descriptors are sockets; files come and go."""
    found = 0
    for entry in os.scandir(f"/proc/{daemon.pid}/fd"):
        with contextlib.suppress(FileNotFoundError):
            found += os.readlink(entry.path).startswith("socket:")
    return found


def test_a_cable_that_is_pulled_in_the_middle_leaves_no_client_behind(scene):
    with cable() as net:
        daemon = net.owsd(scene, f"{V4[0]}:{PORT}", ListenAllow="192.0.2.0/24")
        before = sockets(daemon)
        # one with more answers than fit on the way, of which none is taken, and one with half a request
        two = net.client(scene, f"""
s = socket.create_connection(({V4[0]!r}, {PORT}))
s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
s.settimeout(1)
try:
    while True:
        s.sendall(served.request(served.DIRALL, '/', served.USUAL | served.PERSIST) * 50)
except OSError:
    pass
half = socket.create_connection(({V4[0]!r}, {PORT}))
half.sendall(served.request(served.READ, {ROOM!r})[:30])
print('both', flush=True)
time.sleep(600)  # until it is killed
""")
        until(lambda: "both" in two.log(), 30)
        until(lambda: faulty.counters(scene, daemon)["served_connections"] == 2, 10)
        net.ip("-n", net.clients, "link", "set", "wire", "down")
        until(lambda: scene.get(daemon, "room") == "21.5", 10, "the table does not mind")
        until(lambda: clients(scene, daemon) == 0, 40, "both are dropped")
        until(lambda: sockets(daemon) == before, 10, "with their descriptors")
        until(lambda: faulty.counters(scene, daemon)["served_timeouts"] == 2, 10, "for want of a word")
        net.ip("-n", net.clients, "link", "set", "wire", "up")
        until(lambda: told(net.ask(scene, f"{V4[0]}:{PORT}"), "21.5"), 30, "served again")


def test_a_client_that_sends_a_byte_now_and_then_is_dropped_at_the_deadline(scene):
    with cable() as net:
        daemon = net.owsd(scene, f"[{V6[0]}]:{PORT}", ListenAllow="2001:db8:1::/64")
        # the whole of it takes longer than we wait
        slow = net.client(scene, f"""
s = socket.create_connection(({V6[0]!r}, {PORT}))
for byte in served.request(served.READ, '/x' * 1000):
    try:
        s.sendall(bytes([byte]))
    except OSError:
        print('dropped', flush=True)
        break
    time.sleep(0.25)  # a client that is slow
""")
        assert slow.wait(90) == 0 and "dropped" in slow.log(), slow.log()
        until(lambda: clients(scene, daemon) == 0, 10)
        assert told(net.ask(scene, f"[{V6[0]}]:{PORT}"), "21.5")


def test_an_owsd_on_the_other_side_takes_a_cut_as_a_target_that_is_down(scene):
    """owsd over owsd through the cable: bad while it is cut, good again by itself."""
    with cable() as net:
        net.owsd(scene, f"{V4[0]}:{PORT}", ListenAllow="192.0.2.0/24")
        far = scene.owsd(owsdtest.rio(f"{V4[0]}:{PORT}", [faulty.ROOM], Period=0.05, Timeout=3),
                         prefix=net.inside(net.clients))
        until(lambda: scene.get(far, "room") == "21.5", 20)
        net.ip("-n", net.server, "link", "set", "wire", "down")
        until(lambda: scene.owsctl(far, "get", "room").returncode == 3, 20, "it is not good any more")
        net.ip("-n", net.server, "link", "set", "wire", "up")
        until(lambda: scene.get(far, "room") == "21.5", 60, "good again")


if __name__ == "__main__":
    owsdtest.main(at_once=3)
