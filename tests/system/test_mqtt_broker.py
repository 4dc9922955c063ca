#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The ways of owsd-mqtt to a broker: passwords, TLS, certificates, access lists, brokers that are away
or old; what is wrong stands in the log with its remedy."""

import re
import signal
import socket
import struct
import subprocess
import threading
import time

import faulty
import owsdtest
from mqtthouse import ROOM, SENSOR, Broker, House, Listener, certificates, dated, item, openssl, program
from owsdtest import free_port, logged, raw, until

STATE = "owsd/pi7/state"


def passwords(scene):
    path = scene.file("passwords", "pi7:secret\nlooker:looker\n")
    path.chmod(0o600)
    subprocess.run([program("mosquitto_passwd"), "-U", path], check=True, timeout=owsdtest.PATIENCE)
    return path


def secret(scene, text, mode=0o600):
    path = scene.path / "password"
    path.write_text(text)
    path.chmod(mode)
    return path


def locked_house(scene, lines, **keys):
    """Its broker wants passwords; the listener has one."""
    return House(scene, ROOM, lines=lines, listen=("-u", "looker", "-P", "looker"), **keys)


def test_a_password_stands_in_a_file_that_is_ours_alone_or_in_a_credential(scene):
    lines = ("allow_anonymous false", f"password_file {passwords(scene)}")
    path = secret(scene, "secret\n", 0o644)
    house = locked_house(scene, lines, User="pi7", PasswordFile=path)
    logged(house.face, "others may read it: chmod 600")
    path.chmod(0o600)
    house.says(STATE, "online")
    house.face.stop()
    path.write_text("wrong\n")
    house.face = house.start()
    logged(house.face, "the broker does not let us in; User and PasswordFile, or its access list")
    path.write_text("secret\n")
    house.says(STATE, "online")
    house.face.stop()
    house.daemon.config.write_text(house.text(ROOM, PasswordFile="password"))
    house.face = house.start({"CREDENTIALS_DIRECTORY": str(scene.path)})
    house.says(STATE, "online")
    assert "secret" not in house.face.log()
    # without a name the node's is taken
    house.face.stop()
    del house.keys["User"]
    house.daemon.config.write_text(house.text(ROOM))
    house.says(STATE, "offline")
    house.face = house.start()
    house.says(STATE, "online")


def test_the_access_list_of_the_fleet_lets_a_node_write_its_own_alone(scene):
    page = (owsdtest.SOURCE / "docs/fleet.md").read_text()
    rules = re.search(r"^```text\n(pattern .*?)```", page, re.M | re.S)[1]
    acl = scene.file("acl", rules + "user looker\ntopic read #\ntopic write homeassistant/status\n")
    acl.chmod(0o600)
    lines = ("allow_anonymous false", f"password_file {passwords(scene)}", f"acl_file {acl}")
    house = locked_house(scene, lines, PasswordFile=secret(scene, "secret\n"), Write=raw("on"))
    house.says(STATE, "online")
    house.arrives("room", lambda m: m["good"])
    for topic in ("owsd/pi8/state", "owsd/pi7/other"):
        subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-u", "pi7", "-P", "secret", "-q", "1",
                        "-t", topic, "-m", "forged"], check=True, timeout=owsdtest.PATIENCE)
    house.says("owsd/pi7/other", "forged")
    assert not house.listener.all("owsd/pi8/state")
    birth = f"homeassistant/device/owsd_{SENSOR.replace('.', '_')}/config"
    until(lambda: house.listener.last(birth), 20, "it is announced")
    before = len(house.listener.all(birth))
    subprocess.run([program("mosquitto_pub"), "-p", str(house.broker.port), "-u", "looker", "-P", "looker", "-q", "1",
                    "-t", "homeassistant/status", "-m", "online"], check=True, timeout=owsdtest.PATIENCE)
    until(lambda: len(house.listener.all(birth)) > before, 20, "Home Assistant starts, and it is announced again")
    assert "refuses" not in house.face.log(), house.face.log()


def test_tls_takes_the_broker_that_the_ca_vouches_for_and_shows_our_certificate(scene):
    certificates(scene)
    port = free_port()
    lines = ("allow_anonymous true", f"listener {port} 127.0.0.1", f"cafile {scene.path}/ca.pem",
             f"certfile {scene.path}/broker.pem", f"keyfile {scene.path}/broker.key",
             "require_certificate true", "allow_anonymous true")
    house = House(scene, ROOM, lines=lines, Broker=f"mqtts://localhost:{port}", CaFile=scene.path / "ca.pem",
                  CertFile=scene.path / "client.pem", KeyFile=scene.path / "client.key")
    house.says(STATE, "online")
    house.arrives("room", lambda m: m["good"])
    logged(house.face, f"connected to mqtts://localhost:{port} by MQTT 5")
    house.face.stop()
    # a key that others may read
    (scene.path / "client.key").chmod(0o644)
    house.face = house.start()
    logged(house.face, "others may read it: chmod 600")
    house.face.stop()
    (scene.path / "client.key").chmod(0o600)
    # a broker that nobody vouches for
    house.daemon.config.write_text(house.text(ROOM, CaFile=scene.path / "client.pem"))
    house.face = house.start()
    logged(house.face, "self-signed certificate in certificate chain; CaFile has not the CA that signed it")
    house.face.stop()
    # another name than the certificate's
    house.daemon.config.write_text(house.text(ROOM, Broker=f"mqtts://127.0.0.1:{port}"))
    house.face = house.start()
    logged(house.face, "host name verification failed.; write a name of its certificate in Broker")
    assert "connected" not in house.face.log(), house.face.log()


def test_a_fault_of_ours_and_a_wrong_scheme_are_told_from_a_broker_that_is_away(scene):
    certificates(scene)
    port = free_port()
    lines = ("allow_anonymous true", f"listener {port} 127.0.0.1", f"cafile {scene.path}/ca.pem",
             f"certfile {scene.path}/broker.pem", f"keyfile {scene.path}/broker.key",
             "require_certificate true", "allow_anonymous true")
    house = House(scene, ROOM, lines=lines)
    house.says(STATE, "online")
    tls = dict(Broker=f"mqtts://localhost:{port}", CaFile=scene.path / "ca.pem")
    for keys, words in ((dict(User="pi7", PasswordFile="/nofile"), "is not tried: PasswordFile: /nofile: No such file"),
                        (dict(tls, CaFile="/nofile"), "is not tried: CaFile: /nofile: No such file"),
                        (tls, "certificate required; the broker wants CertFile and KeyFile"),
                        (dict(Broker=f"mqtt://localhost:{port}"), "does that port want TLS: mqtts://?"),
                        (dict(tls, Broker=f"mqtts://localhost:{house.broker.port}"),
                         "is that a port without TLS: mqtt://?")):
        house.face.stop()
        house.daemon.config.write_text(house.text(ROOM, **keys))
        house.face = house.start()
        logged(house.face, words)
        assert "does a broker run there?" not in house.face.log(), house.face.log()


def test_a_certificate_of_another_time_is_told_from_one_of_another_ca(scene):
    certificates(scene)
    ports = {}
    lines = ["allow_anonymous true"]
    for name, begins, ends in (("old", "20200101000000Z", "20210101000000Z"), ("future", "21200101000000Z", "21210101000000Z")):
        dated(scene, name, begins, ends)
        ports[name] = free_port()
        lines += [f"listener {ports[name]} 127.0.0.1", f"certfile {scene.path}/{name}.pem", f"keyfile {scene.path}/broker.key",
                  "allow_anonymous true"]
    house = House(scene, ROOM, lines=lines)
    for name, words in (("old", "certificate has expired; renew it there, or look at the clock here"),
                        ("future", "certificate is not yet valid; set the clock of this machine")):
        house.face.stop()
        house.daemon.config.write_text(house.text(ROOM, Broker=f"mqtts://localhost:{ports[name]}", CaFile=scene.path / "ca.pem"))
        house.face = house.start()
        logged(house.face, words)
        assert "connected" not in house.face.log(), house.face.log()
    # to a machine whose clock begins in 1970 the certificate of any broker is of the future
    clock = scene.path / "clock"
    clock.write_bytes(struct.pack("=3q", -int((time.time() - 3600) * 1e9), 0, 1))
    house.face.stop()
    house.daemon.config.write_text(house.text(ROOM, Broker=f"mqtts://localhost:{ports['old']}", CaFile=scene.path / "ca.pem"))
    house.face = house.start(faulty.env(scene, clock=clock))
    logged(house.face, "certificate is not yet valid; set the clock of this machine")


def test_what_is_too_large_for_the_broker_names_its_limits(scene):
    house = House(scene, ROOM, lines=("allow_anonymous true", "message_size_limit 400"))
    logged(house.face, "refuses what is published: Packet too large; raise there max_packet_size, message_size_limit")
    house.arrives("room", lambda m: m["good"])
    house.face.stop()
    house = House(scene, ROOM, lines=("allow_anonymous true", "max_packet_size 900"))
    logged(house.face, "homeassistant/device/owsd_pi7/config cannot be published: ")
    logged(house.face, "raise there max_packet_size")
    house.arrives("room", lambda m: m["good"])
    house.face.stop()
    # by MQTT 3.1.1 a broker has no word for it, and closes the connection
    house = House(scene, ROOM, lines=("allow_anonymous true", "max_packet_size 900"), Protocol="3.1.1")
    logged(house.face, "is lost: the broker closes it at the message of homeassistant/device/owsd_pi7/config, ")
    logged(house.face, " bytes; is that too large? Raise there max_packet_size")
    until(lambda: house.broker.process.log().count("New client connected") > 4, 60, house.broker.process.log)
    assert "another client" not in house.face.log(), house.face.log()


def test_the_first_way_that_works_is_taken_and_by_the_address_that_works(scene):
    house = House(scene, ROOM)
    house.says(STATE, "online")
    dead = free_port()
    # the broker has no IPv6, which localhost is first where it has both
    house.daemon.config.write_text(house.text(
        ROOM, Broker=f"mqtt://127.0.0.1:{dead} | mqtt://localhost:{house.broker.port}"))
    house.face.signal(1)
    logged(house.face, f"connected to mqtt://localhost:{house.broker.port} by MQTT 5")
    assert f"mqtt://127.0.0.1:{dead} cannot be reached: Connection refused; does a broker run there?" in house.face.log()
    other = Broker(scene, dead)
    # what works is kept; when it is lost the first is tried first
    house.broker.process.stop()
    until(lambda: f"connected to mqtt://127.0.0.1:{dead}" in house.face.log(), 60, lambda: house.face.log())
    assert other.process.running()


def test_an_access_list_that_lets_nothing_through_is_named(scene):
    acl = scene.file("acl", "topic read #\n")
    house = House(scene, ROOM, lines=("allow_anonymous true", f"acl_file {acl}"), Write=raw("on"))
    logged(house.face, "refuses what is published")
    assert "its access list has to let us write owsd/pi7/#" in house.face.log(), house.face.log()
    assert house.face.log().count("refuses what") == 1


def packets(connection):
    """What the client sends, packet by packet: the first byte and what follows the length."""
    stream = connection.makefile("rb")
    while first := stream.read(1):
        length = shift = 0
        while True:
            byte = stream.read(1)[0]
            length |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        yield first[0], stream.read(length)


def test_a_subscription_that_is_refused_is_asked_for_again(scene):
    """As by a server of a cluster that has no leader yet: commands must not be lost for good."""
    port, asked = free_port(), []

    def serve(listener):
        connection = listener.accept()[0]
        for first, rest in packets(connection):
            if first >> 4 == 1:
                connection.sendall(b"\x20\x02\x00\x00")
            elif first >> 4 == 8:
                asked.append(rest[4:-1].decode())
                code = 0x80 if asked.count(asked[-1]) < 3 and "set" in asked[-1] else 1
                connection.sendall(bytes([0x90, 3]) + rest[:2] + bytes([code]))
            elif first >> 4 == 3 and first & 6:
                at = 2 + int.from_bytes(rest[:2], "big")
                connection.sendall(b"\x40\x02" + rest[at:at + 2])
            elif first >> 4 == 12:
                connection.sendall(b"\xd0\x00")
    listener = socket.create_server(("127.0.0.1", port))
    threading.Thread(target=serve, args=(listener,), daemon=True).start()
    house = House(scene, ROOM, Broker=f"mqtt://127.0.0.1:{port}", Write=raw("on"), Protocol="3.1.1")
    until(lambda: sum("set" in topic for topic in asked) == 3, 150, lambda: asked)
    time.sleep(1)  # nothing is asked for once more
    assert all(asked.count(topic) == (3 if "set" in topic else 1) for topic in asked), asked
    assert house.face.log().count("refuses a subscription") == 1, house.face.log()
    listener.close()


def test_a_broker_without_mqtt_5_gets_3_1_1(scene):
    port, levels = free_port(), []

    def serve(listener):
        while True:
            try:
                connection = listener.accept()[0]
            except OSError:
                return
            with connection:
                head = connection.recv(4096)
                levels.append(head[8] if len(head) > 8 else None)
                if levels[-1] == 4:
                    connection.sendall(b"\x20\x02\x00\x00")
                    connection.recv(4096)
                    connection.recv(4096)
                else:
                    connection.sendall(b"\x20\x03\x00\x84\x00")
    listener = socket.create_server(("127.0.0.1", port))
    threading.Thread(target=serve, args=(listener,), daemon=True).start()
    house = House(scene, ROOM, Broker=f"mqtt://127.0.0.1:{port}", Write=raw("on"))
    logged(house.face, f"connected to mqtt://127.0.0.1:{port} by MQTT 3.1.1")
    logged(house.face, "publish commands without retain")
    assert levels[:2] == [5, 4], levels
    listener.close()


def test_two_with_one_node_are_told_so_and_do_not_flood_the_broker(scene):
    node = "pi7-" + "long-name-" * 5 + "end"
    house = House(scene, ROOM, Node=node)
    house.says(f"owsd/{node}/state", "online")
    other = house.start()
    # each of them: nobody knows in whose log a person looks
    for face in (house.face, other):
        until(lambda face=face: re.search(
            f"{house.broker.url} (was|is) lost: another client took the id owsd-{node}; "
            "look for a second owsd-mqtt of this Node", face.log()), 60, lambda face=face: face.log())
        assert face.log().count("is lost: The connection was lost") < 3, face.log()


def shows(house, words):
    """The status of owsd-mqtt has them, though its next tick may be two minutes away."""
    def stats():
        return house.scene.owsctl(house.daemon, "stats").stdout
    until(lambda: re.search(f"owsd-mqtt, pid .*{words}", stats()), 10, stats, step=0.2)


def test_a_broker_that_ends_after_a_takeover_is_lost_and_found_again(scene):
    house = House(scene, ROOM)
    house.says(STATE, "online")
    other = house.start()
    logged(house.face, "lost: another client took the id owsd-pi7")
    assert other.stop() == 0
    house.face.signal(signal.SIGHUP)  # it tries again at once
    shows(house, "publishing to")
    blamed, connected = (house.face.log().count(words) for words in ("another client", "connected to"))
    house.broker.process.kill()
    shows(house, "cannot be reached")
    house.broker.start()
    until(lambda: house.face.log().count("connected to") == connected + 1, 20, lambda: house.face.log())
    assert house.face.log().count("another client") == blamed, house.face.log()


def closes(scene, how):
    """The log of one whose broker ends each connection after a CONNACK; how: "reset" or "close"."""
    made = []

    def serve(listener):
        while True:
            try:
                connection = listener.accept()[0]
            except OSError:
                return
            with connection:
                connection.recv(4096)
                connection.sendall(b"\x20\x03\x00\x00\x00")
                connection.recv(4096)
                if how == "reset":
                    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                else:
                    connection.shutdown(socket.SHUT_WR)
                    # what is unread would make a reset of it
                    try:
                        while connection.recv(65536):
                            pass
                    except OSError:
                        pass
            made.append(how)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=serve, args=(listener,), daemon=True).start()
        house = House(scene, ROOM, Broker=f"mqtt://127.0.0.1:{listener.getsockname()[1]}")
        until(lambda: len(made) > 2 and house.face.log().count("connected to") > 2 and
              ("closes each" in house.face.log() or len(made) > 3), 60, lambda: house.face.log())
        if how == "close":
            shows(house, "is lost: the broker closes each")
        assert house.face.stop() == 0
    return house.face.log()


def test_a_connection_that_breaks_again_and_again_is_no_other_client(scene):
    log = closes(scene, "reset")
    assert "is lost: " in log and "another client" not in log, log


def test_a_broker_that_closes_again_and_again_may_have_another_client(scene):
    log = closes(scene, "close")
    assert "the broker closes each connection; has another client the id owsd-pi7?" in log, log
    assert "took the id" not in log, log


def test_a_plant_that_is_read_all_the_time_keeps_the_connection(scene):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notify:
        address = str(scene.path / "notify")
        notify.bind(address)
        notify.settimeout(20)
        house = House(scene, ROOM, env={"NOTIFY_SOCKET": address})
        house.arrives("room", lambda m: m["good"])
        # its status is of a tick, in which libmosquitto keeps the connection too
        until(lambda: b"STATUS=publishing to" in notify.recv(4096), 20, "it ticks")


def test_a_broker_that_acknowledges_nothing_keeps_the_will(scene):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        said = bytearray()

        def serve():
            with listener.accept()[0] as connection:
                connection.recv(4096)
                connection.sendall(b"\x20\x03\x00\x00\x00")
                while data := connection.recv(65536):
                    said.extend(data)
        server = threading.Thread(target=serve, daemon=True)
        server.start()
        house = House(scene, ROOM, Broker=f"mqtt://127.0.0.1:{listener.getsockname()[1]}")
        until(lambda: b"owsd/pi7/room" in said, 20, lambda: bytes(said))
        assert house.face.stop() == 0
        server.join(20)
        # a DISCONNECT would stand behind the last text
        assert not server.is_alive() and 0xE0 not in said[-4:], bytes(said[-40:])


def test_what_is_waited_for_is_logged_when_a_broker_takes_nothing(scene):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        def serve():
            with listener.accept()[0] as connection:
                connection.recv(4096)
                connection.sendall(b"\x20\x03\x00\x00\x00")
                while connection.recv(65536):
                    pass
        server = threading.Thread(target=serve, daemon=True)
        server.start()
        house = House(scene, *(item(f"room{n}", f"/{SENSOR}/temperature") for n in range(120)),
                      Broker=f"mqtt://127.0.0.1:{listener.getsockname()[1]}")
        logged(house.face, "nothing is published for 5 s: it waits for the broker to take it; 100 under way")
        assert house.face.log().count("nothing is published") == 1, house.face.log()
        assert house.face.stop() == 0
        server.join(20)


def test_a_listener_that_says_nothing_is_given_up(scene):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        house = House(scene, ROOM)
        house.says(STATE, "online")
        house.daemon.config.write_text(house.text(
            ROOM, Broker=f"mqtt://127.0.0.1:{port} | {house.broker.url}"))
        house.face.signal(1)
        logged(house.face, f"mqtt://127.0.0.1:{port} cannot be reached")
        until(lambda: house.face.log().count("connected to") == 2, 30, lambda: house.face.log())


if __name__ == "__main__":
    owsdtest.main(at_once=4)
