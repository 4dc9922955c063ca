#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The add-on of Home Assistant, as its container runs it: what make install installs, in a root, a
network and a host name of its own, with a simulated DS2482 at /dev/i2c-1. Supervisor is a mock, with
what its code has of services, discovery and ingress; the broker and Home Assistant are genuine.

OWSD_ADDON_JUDGES may name a folder with clones of frenck/action-addon-linter and
home-assistant/supervisor: then they judge the files of the add-on."""

import contextlib
import http.server
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading

import clients
import hajudge
import mqtthouse
import owsdtest
import test_web_ingress
from owsdtest import BUILD, SOURCE, until
from test_web_ingress import ANNA, ask

INSIDE = "OWSD_TEST_IN_ADDON"
HOST, TOKEN = "local-owsd", "f00dfeed"
PASSWORD = 'pass "w\\nord'  # what JSON, a shell and a .rio have an escape for
NAMES = f"localhost supervisor core-mosquitto {HOST}"
FILES = SOURCE / "board/addon"
ROOM, NEW, SWITCH = "28.A0B1C2000001", "28.A0B1C2000007", "29.A0B1C2000004"
BOARD = "ds2408_" + SWITCH.lower().replace(".", "_")
WIRE = "chip DS2482-100 0x18\nDS18B20 {} temperature {}\nDS2408 " + SWITCH + "\n"
USERS = {"owsd": 64711}
GROUPS = {"owsd": 64711, "owsd-control": 64712, "owsd-config": 64713}
# The container: the machine, with what is installed above it, and with folders of its own
ROOT = """set -e
mount -t tmpfs tmpfs "$1/c"
mkdir "$1/c/upper" "$1/c/work" "$1/c/root"
cp -a "$1/installed" "$1/c" # layers of one another are refused
mount -t overlay -o "lowerdir=$1/c/installed:/,upperdir=$1/c/upper,workdir=$1/c/work" overlay "$1/c/root"
cd "$1/c/root"
mount --rbind /proc proc
mount --rbind /sys sys
mount --rbind /tmp tmp
mount -t tmpfs -o mode=755 tmpfs run
mount -t tmpfs -o mode=755 tmpfs dev
mkdir dev/shm
mount -t tmpfs tmpfs dev/shm
for n in null:3 zero:5 full:7 random:8 urandom:9; do mknod -m 666 "dev/${n%:*}" c 1 "${n#*:}"; done
ln -s /proc/self/fd dev/fd
(umask 077 && : >dev/i2c-1)
mount --bind "$1/config" etc/owsd
mount --bind "$1/data" data
exec chroot . /usr/bin/env -i PATH=/usr/local/sbin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \\
    "SUPERVISOR_TOKEN=$2" "LD_PRELOAD=$3" "I2C_SOCKET=$4" owsd-addon"""


class Supervisor(http.server.ThreadingHTTPServer):
    """broker: the answer of services/mqtt; None: there is none. One at a time has its port."""
    daemon_threads = True
    present = None

    def __init__(self, broker=None):
        self.broker, self.announced, self.wrong = broker, [], []
        if Supervisor.present:
            Supervisor.present.shutdown()
            Supervisor.present.server_close()
        super().__init__(("127.0.0.1", 80), Answer)
        Supervisor.present = self
        threading.Thread(target=self.serve_forever, daemon=True).start()


class Answer(http.server.BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def answer(self, status, **members):
        body = json.dumps(members).encode()
        self.send_response(status)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def permitted(self):
        for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            with contextlib.suppress(OSError):
                words = path.read_bytes()
                if b"curl" in words and TOKEN.encode() in words:
                    self.server.wrong.append(("every process sees the token", words))
        right = self.headers["Host"] == "supervisor" and self.headers["Authorization"] == f"Bearer {TOKEN}"
        if not right:
            self.server.wrong.append((self.path, str(self.headers)))
            self.answer(403, result="error", message="no token")
        return right

    def do_GET(self):
        if not self.permitted():
            return
        if self.path == "/services/mqtt" and self.server.broker:
            self.answer(200, result="ok", data=self.server.broker)
        else:
            self.answer(400, result="error", message="Service not enabled")

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if not self.permitted():
            return
        if self.path == "/discovery" and set(body) == {"service", "config"} and body["service"] == "onewire":
            self.server.announced.append(body["config"])
            self.answer(200, result="ok", data={"uuid": "a" * 32})
        else:
            self.server.wrong.append((self.path, body))
            self.answer(400, result="error", message="no such service")


def program(name):
    return shutil.which(name) or owsdtest.skip(f"{name} is not here (sh board/install-deps addon)")


class House:
    """Broker, Supervisor, and the container of the add-on."""

    def __init__(self, scene, wire=WIRE.format(ROOM, 21.5), broker=True, file=None):
        for name in ("curl", "jq", "setpriv"):
            program(name)
        self.scene = scene
        self.broker = mqtthouse.Broker(scene, lines=("allow_anonymous true", f"password_file {self.passwords()}"))
        self.service = {"addon": "core_mosquitto", "host": "core-mosquitto", "port": self.broker.port, "ssl": False,
                        "username": "addons", "password": PASSWORD, "protocol": "3.1.1"}
        self.supervisor = Supervisor(self.service if broker else None)
        self.socket = scene.path / "i2c.socket"
        self.wire = self.chip(wire)
        scene.path.chmod(0o755)
        for name in ("c", "config", "data"):
            (scene.path / name).mkdir()
        self.file = scene.path / "config/OWS.rio"
        if file is not None:
            self.file.write_text(file)
        self.install(scene.path / "installed")
        self.start()

    def passwords(self):
        path = self.scene.file("passwords", "")
        subprocess.run([mqtthouse.program("mosquitto_passwd"), "-b", path, "addons", PASSWORD], check=True,
                       capture_output=True)
        return path

    def chip(self, wire):
        with contextlib.suppress(FileNotFoundError):
            self.socket.unlink()
        simulated = self.scene.start([BUILD / "system/i2c", self.scene.file("wire.sim", wire), self.socket])
        until(self.socket.exists, 20, simulated.log)
        return simulated

    def install(self, root):
        """What the packages and the Dockerfile bring."""
        environment = {k: v for k, v in os.environ.items() if not k.startswith("MAKE") and k != "MFLAGS"}
        subprocess.run(["make", "-s", "-o", BUILD / "with/cc", "-o", BUILD / "with/ld", "-C", SOURCE, f"B={BUILD}",
                        f"DESTDIR={root}", "PREFIX=/usr", "install"], check=True, capture_output=True, env=environment)
        shutil.copy(FILES / "OWS.rio", root / "usr/share/owsd/addon.rio")
        (root / "usr/local/sbin").mkdir(parents=True)
        shutil.copy(FILES / "run", root / "usr/local/sbin/owsd-addon")
        for name in ("etc/owsd", "data"):
            (root / name).mkdir(parents=True)
        own = {"passwd": [f"{name}:x:{uid}:{uid}::/nonexistent:/bin/sh" for name, uid in USERS.items()],
               "group": [f"{name}:x:{gid}:" for name, gid in GROUPS.items()]}
        for kind, lines in own.items():
            others = [line for line in pathlib.Path("/etc", kind).read_text().splitlines()
                      if line.split(":")[0] not in GROUPS]
            (root / "etc" / kind).write_text("\n".join(others + lines) + "\n")
        (root / "etc/hosts").write_text(f"127.0.0.1 {NAMES}\n")

    def start(self):
        adapter = shutil.copy(BUILD / "system/i2c.so", self.scene.path)
        command = ["unshare", "-m", "sh", "-c", ROOT, "sh", self.scene.path, TOKEN, adapter, self.socket]
        self.addon = self.scene.start(command)
        until(lambda: os.readlink(f"/proc/{self.addon.pid}/ns/mnt") != os.readlink("/proc/self/ns/mnt"), 20, self.addon.log)
        self.namespace = os.readlink(f"/proc/{self.addon.pid}/ns/mnt")

    def inside(self, *command):
        """Done in the container."""
        return subprocess.run(["nsenter", f"--target={self.addon.pid}", "--mount", "--root", "--wd",
                               "/usr/bin/env", "-i", "PATH=/usr/local/sbin:/usr/sbin:/usr/bin:/sbin:/bin", *map(str, command)],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)

    def value(self, name):
        return self.inside("owsctl", "get", name).stdout.strip()

    def shows(self, name, value):
        until(lambda: self.value(name) == value, 120, lambda: f"{name} is {value}: {self.inside('owsctl', 'list')} {self.addon.log()}")

    def pid(self, name):
        """Of a program of the container."""
        return int(self.inside("cat", f"/run/{name}.pid").stdout or 0)


def lives(house):
    """{name: user id} of what lives in the container."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if os.readlink(path / "ns/mnt") == house.namespace:
                found[(path / "comm").read_text().strip()] = path.stat().st_uid
    return found


def found(house):
    def has():
        assert house.addon.running(), house.addon.log()
        return house.file.exists() and "Item {" in house.file.read_text()
    until(has, 240, lambda: f"signals of what was found: {house.addon.log()}")


def page(server, path, status=200, method="GET", **members):
    headers = {"Content-Type": "application/json", "X-Owsd": "1", "Origin": "http://house.example:8123"}
    got, body = ask(server, "api/" + path, method, json.dumps(members) if members else None, **headers)
    assert got == status, (path, got, body)
    return json.loads(body)


def test_nothing_is_typed_and_a_replaced_chip_keeps_its_history(scene):
    house = House(scene)
    judge = hajudge.HomeAssistant(scene, house.broker.port)
    found(house)
    judge.shows("sensor.temperature1", "21.5", 60)
    assert house.service["password"] not in house.addon.log() + house.file.read_text()
    assert house.supervisor.announced == [{"host": HOST, "port": 4304}], house.supervisor.announced
    # the clients of owserver reach it there
    done = subprocess.run([program("owread"), "-s", "127.0.0.1:4304", f"/{ROOM}/temperature"], capture_output=True,
                          text=True, timeout=owsdtest.PATIENCE, check=False)
    assert done.stdout.strip() == "21.5", done
    # the page, for Anna; nobody else
    with test_web_ingress.ingress(8099, ANNA) as server:
        assert page(server, "info")["person"] == "anna"
        assert {s["name"] for s in page(server, "signals")["signals"]} >= {"temperature1"}
        with socket.create_connection(("127.0.0.1", 8099)) as other:
            other.sendall(b"GET /api/info HTTP/1.1\r\nHost: localhost\r\nX-Remote-User-Name: anna\r\n\r\n")
            assert b" 403 " in other.recv(100)
        # Home Assistant moves an output
        assert not [name for name in judge.states() if name.startswith("number.")], judge.states()
        judge.act("switch.turn_on", f"switch.{BOARD}_output1")
        name = next(s["name"] for s in page(server, "signals")["signals"] if s["path"] == f"/{SWITCH}/PIO.0")
        house.shows(name, "1")
        # another thermometer in the place of the first
        device = judge.states()["sensor.temperature1"][1]
        house.wire.stop()
        house.wire = house.chip(WIRE.format(NEW, 18.25))
        until(lambda: judge.state("sensor.temperature1") == "unavailable", 60, lambda: judge.states())

        def listed():
            with contextlib.suppress(AssertionError):  # its target may be down meanwhile, and lists none
                return NEW in json.dumps(page(server, "devices"))
        until(listed, 60, "the new one is found")
        config = page(server, "config")
        done = page(server, "config/draft", method="POST", text=config["text"], do="replace", old=ROOM, new=NEW)
        saved = page(server, "config/save", method="POST", text=done["text"], base=config["tag"])
        assert saved["reload"] == "done", saved
        judge.shows("sensor.temperature1", "18.25", 60)
        assert judge.states()["sensor.temperature1"][1] == device
        assert not [name for name in judge.states() if "temperature2" in name]
        assert house.addon.stop(60) == 0
    assert not judge.complaints(), "\n".join(judge.complaints())
    past = subprocess.run([BUILD / "system/history", scene.path / "data/owsd-recorder/OWS"], capture_output=True, text=True,
                          timeout=owsdtest.PATIENCE, check=True).stdout
    values = re.findall(r"^temperature1 \S+ (\S+) c0$", past, re.M)
    assert "21.5" in values and values[-1] == "18.25", past
    assert not house.supervisor.wrong, house.supervisor.wrong


ONEWIRE = """
import asyncio, sys
from homeassistant import bootstrap, config_entries, loader
from homeassistant.core import HomeAssistant
from homeassistant.helpers.service_info.hassio import HassioServiceInfo

async def main():
    hass = HomeAssistant(sys.argv[1])
    hass.config.skip_pip = True
    loader.async_setup(hass)
    hass.config_entries = config_entries.ConfigEntries(hass, {})
    await bootstrap.async_load_base_functionality(hass)
    config = {"host": sys.argv[2], "port": int(sys.argv[3]), "addon": "owsd 1-Wire"}
    info = HassioServiceInfo(config=config, name="owsd 1-Wire", slug="local_owsd", uuid="a" * 32)
    flows = hass.config_entries.flow
    shown = await flows.async_init("onewire", context={"source": "hassio"}, data=info)
    print(shown["type"], shown["step_id"], shown["description_placeholders"]["host"])
    made = await flows.async_configure(shown["flow_id"], {})
    print(made["type"], made["title"], made["data"])
    await hass.async_block_till_done()
    for state in hass.states.async_all():
        print(state.entity_id, state.state)
    await hass.async_stop(force=True)

asyncio.run(main())
"""


def test_the_integration_that_is_told_of_it_reads_it(scene):
    """Home Assistant's own code for what Supervisor passes on, with the client that it uses."""
    house = House(scene, broker=False)
    found(house)
    house.shows("temperature1", "21.5")
    told = until(lambda: house.supervisor.announced, 30, house.addon.log)[0]
    (scene.path / "core").mkdir()
    client = pathlib.Path(clients.python_client("pyownet.protocol").__file__).parent
    shutil.copytree(client, scene.path / "client/pyownet")
    done = subprocess.run([hajudge.python("2025"), "-c", ONEWIRE, scene.path / "core", told["host"], str(told["port"])],
                          capture_output=True, text=True, timeout=300, check=False, env=dict(os.environ, PYTHONPATH=str(scene.path / "client")))
    lines = done.stdout.splitlines()
    assert len(lines) > 2, f"{done.stdout}\n{done.stderr[-4000:]}"
    assert lines[0] == f"form discovery_confirm {HOST}", done
    assert lines[1] == f"create_entry owsd 1-Wire {told}", done
    assert any(line.startswith("sensor.") and line.endswith(" 21.5") for line in lines), done


def test_it_ends_in_order_and_begins_where_it_was(scene):
    house = House(scene)
    listener = mqtthouse.Listener(scene, house.broker.port)
    found(house)
    until(lambda: listener.last("owsd/homeassistant/state") == "online", 60, house.addon.log)
    before = house.file.read_text()
    living = lives(house)
    assert {name for name, uid in living.items() if uid == USERS["owsd"]} >= {"owsd", "owsd-web", "owsd-mqtt", "owsd-recorder"}
    assert not [name for name, uid in living.items() if uid == 0 and name.startswith("owsd") and name != "owsd-addon"], living

    def said():
        faces = json.loads(house.inside("owsctl", "--json", "stats").stdout)["faces"]
        return {face["program"] for face in faces if face["alive"]} >= {"owsd-web", "owsd-mqtt", "owsd-recorder"}
    until(said, 20, lambda: house.inside("owsctl", "stats").stdout)
    assert house.addon.stop(60) == 0
    assert not lives(house), lives(house)
    assert listener.last("owsd/homeassistant/state") == "offline"
    assert "recording" in house.addon.log() and "started again" not in house.addon.log(), house.addon.log()
    house.start()
    house.shows("temperature1", "21.5")
    assert house.file.read_text() == before


def test_what_dies_is_started_again_and_nothing_else(scene):
    house = House(scene)
    found(house)
    house.shows("temperature1", "21.5")
    until(lambda: house.pid("owsd-web"), 20, "the page")
    owsd, web = house.pid("owsd"), house.pid("owsd-web")
    os.kill(web, signal.SIGKILL)
    until(lambda: house.pid("owsd-web") not in (0, web), 30, house.addon.log)
    assert house.pid("owsd") == owsd and "owsd-web has ended with status 137" in house.addon.log()
    # a backup has the recorder hold still
    recorder = house.pid("owsd-recorder")
    for do, state in (("hold", "T"), ("go", "S")):
        assert house.inside("owsd-addon", do).returncode == 0
        until(lambda s=state: owsdtest.state_of(recorder) == s, 20, do)
    # also while there is none: nothing else is started, or stopped
    os.kill(recorder, signal.SIGKILL)
    until(lambda: "owsd-recorder has ended" in house.addon.log(), 20, house.addon.log)
    assert [house.inside("owsd-addon", do).returncode for do in ("hold", "go", "sto")] == [0, 0, 2]
    until(lambda: house.pid("owsd-recorder") not in (0, recorder), 30, house.addon.log)
    # nor does one that is held keep the add-on from its end
    assert house.inside("owsd-addon", "hold").returncode == 0
    # nor is a file lost that nobody understands
    house.file.write_text("OwsDrv {\n  Timeout never\n}\n")
    assert house.addon.stop(60) == 0
    house.start()
    until(lambda: "OWS.rio:2:" in house.addon.log(), 30, house.addon.log)
    house.file.write_text(FILES.joinpath("OWS.rio").read_text())
    found(house)
    house.shows("temperature1", "21.5")
    # and once it is understood, it gets what each start gives it
    until(lambda: 'Proxy "172.30.32.2"' in " ".join(house.file.read_text().split()), 30, house.file.read_text)
    until(lambda: house.pid("owsd-web"), 30, house.addon.log)


def test_what_a_program_plants_in_its_folders_gives_it_nothing(scene):
    """Root starts all of them, and meets what the user owsd, or a guest of Samba, has left."""
    house = House(scene, broker=False, file="")  # as a power cut in the first start leaves it
    found(house)
    assert house.addon.stop(60) == 0
    house.file.unlink()
    house.file.symlink_to("/usr/share/owsd/addon.rio")
    state = scene.path / "data/owsd-notify/OWS"
    shutil.rmtree(state)
    state.symlink_to("/usr/local/sbin")
    house.start()
    until(lambda: house.pid("owsd"), 30, house.addon.log)
    owners = house.inside("stat", "-c", "%U %a", "/usr/share/owsd/addon.rio", "/usr/local/sbin").stdout
    assert owners == "root 644\nroot 755\n", owners


def test_a_broker_that_comes_later_is_taken_and_one_of_ones_own_stays(scene):
    house = House(scene, broker=False)
    listener = mqtthouse.Listener(scene, house.broker.port)
    until(lambda: "knows no MQTT broker" in house.addon.log(), 30, house.addon.log)
    found(house)
    house.supervisor.broker = house.service
    until(lambda: '"v":21.5' in (listener.last("owsd/homeassistant/temperature1") or ""), 90, house.addon.log)
    assert house.addon.stop(60) == 0
    own = house.file.read_text()
    own = re.sub(r'( Broker +)".*"', r'\1"mqtt://localhost:9"', own)
    own = re.sub(r"\n *(User|PasswordFile) .*", "", own)
    own = re.sub(r"\n +(Broker )", r" \1", own)  # as a person may have written it
    assert re.search(r"\S +Broker ", own), own
    house.file.write_text(own)
    house.start()
    house.shows("temperature1", "21.5")
    assert '"mqtt://localhost:9"' in house.file.read_text()
    assert not house.supervisor.wrong, house.supervisor.wrong


def test_make_addon_makes_a_repository_of_the_packages_that_are_there(scene):
    names = ["owsd", "libows1", "libows-history1", *{line.split("|")[2].strip() for line in
             (SOURCE / "board/faces").read_text().splitlines() if line.startswith("owsd")}]
    debs = scene.path / "debs"
    debs.mkdir()

    def make(*arguments):
        return subprocess.run(["sh", SOURCE / "board/make-addon", "--debs", debs, "--out", scene.path / "addon", *arguments],
                              capture_output=True, text=True, timeout=owsdtest.PATIENCE, check=False)
    for name in names:
        done = make("amd64")
        assert done.returncode and f"make deb ARCH=amd64 SUITE=trixie" in done.stderr, done
        for version in ("0.9.0", "0.10.0"):
            (debs / f"{name}_{version}+deb13_amd64.deb").touch()
    assert make("amd64").returncode == 0
    assert make().returncode, "there is nothing for arm64"
    for name in names:
        (debs / f"{name}_0.10.0+deb13_arm64.deb").touch()
    done = make("--url", "https://example.org/here")
    assert done.returncode == 0, done
    tree = scene.path / "addon"
    laid = sorted(path.name for path in (tree / "owsd/packages").iterdir())
    assert laid == sorted(f"{name}_0.10.0+deb13_{arch}.deb" for name in names for arch in ("amd64", "arm64"))
    assert "arch: [amd64, aarch64]" in (tree / "owsd/config.yaml").read_text()
    assert "@" not in (tree / "owsd/config.yaml").read_text().split("\n", 2)[2] + (tree / "owsd/Dockerfile").read_text()
    # Supervisor puts its own name in the place of the only one that begins a line
    assert re.findall(r"^profile (\S+)", (tree / "owsd/apparmor.txt").read_text(), re.M) == ["owsd"]
    assert (tree / "owsd/icon.png").read_bytes().startswith(b"\x89PNG")
    assert "https://example.org/here" in (tree / "repository.yaml").read_text()
    judge(tree)


SCHEMA = """
import sys, yaml, voluptuous
sys.path.insert(0, sys.argv[1])
from supervisor.apps.validate import SCHEMA_APP_CONFIG, SCHEMA_APP_TRANSLATIONS
from supervisor.store.validate import SCHEMA_REPOSITORY_CONFIG
for schema, name in ((SCHEMA_APP_CONFIG, "owsd/config.yaml"), (SCHEMA_APP_TRANSLATIONS, "owsd/translations/en.yaml"),
                     (SCHEMA_REPOSITORY_CONFIG, "repository.yaml")):
    had = yaml.safe_load(open(f"{sys.argv[2]}/{name}"))
    got = schema(dict(had))
    assert set(had) <= set(got), (name, set(had) - set(got))
"""


def judge(tree):
    """By the genuine schema of Supervisor, which drops keys that it does not know, and the linter."""
    clones = os.environ.get("OWSD_ADDON_JUDGES")
    if not clones:
        print("# no OWSD_ADDON_JUDGES: linter and schema were not asked")
        return
    text = pathlib.Path(clones, "action-addon-linter/src/lint.py").read_text().replace('"/', f'"{clones}/action-addon-linter/src/')
    environment = dict(os.environ, INPUT_PATH=str(tree / "owsd"), INPUT_COMMUNITY="false")
    for script, arguments in ((text, []), (SCHEMA, [f"{clones}/supervisor", tree])):
        done = subprocess.run([f"{clones}/python/bin/python", "-c", script, *arguments], env=environment, capture_output=True,
                              text=True, timeout=owsdtest.PATIENCE, check=False)
        assert done.returncode == 0 and not done.stdout, done.stdout + done.stderr


def main():
    if os.environ.get(INSIDE):
        owsdtest.main()
    network = f"""ip link set lo up && ip addr add {test_web_ingress.PROXY}/32 dev lo && hostname {HOST} &&
        hosts=$(mktemp) && echo "127.0.0.1 {NAMES}" >"$hosts" && mount --bind "$hosts" /etc/hosts && rm $hosts"""
    inside = ["unshare", "-m", "-n", "-u", "sh", "-c", f'{network} && exec "$@"', "sh"]
    try:
        subprocess.run([*inside, "true"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as why:
        print(f"skip all: no namespaces of one's own: {getattr(why, 'stderr', why)}")
        print("0 passed, 0 failed, 1 skipped")
        sys.exit(0)
    sys.exit(subprocess.run([*inside, sys.executable, os.path.abspath(sys.argv[0]), *sys.argv[1:]], check=False,
                            env=dict(os.environ, **{INSIDE: "1"})).returncode)


if __name__ == "__main__":
    test_web_ingress.PROXY = "172.30.32.2"
    main()
