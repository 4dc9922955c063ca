#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Clients of owserver that no package index has, with the genuine owserver and with owsd -l before
the same wire: what they find, read and write is the same.

They are not of this project. OWSD_PEERS names a directory with clones of them, and a case whose
client is not there is skipped:

    evok        github.com/UniPiTechnology/evok
    fhem        github.com/fhem/fhem-mirror
    smarthome   github.com/smarthomeNG/plugins
"""

import contextlib
import importlib.util
import os
import pathlib
import re
import shutil
import socket
import sys

import clients
import owsdtest
import served
from owsdtest import until


def peer(name):
    """The file or directory of a clone."""
    if not os.environ.get("OWSD_PEERS"):
        owsdtest.skip("OWSD_PEERS names no directory with clones")
    found = pathlib.Path(os.environ["OWSD_PEERS"]) / name
    return found if found.exists() else owsdtest.skip(f"not there: {found}")


def the_same(ask):
    """What ask(scene, server) returns, a dictionary, is the same of both servers."""
    answers = []
    for genuine in True, False:
        with owsdtest.Scene() as scene:
            wire = scene.file("wire.sim", served.WIRE)
            server = served.owserver_of(scene, wire) if genuine else \
                served.owsd_of(scene, f"sim:{wire}", items=[])
            until(lambda: server.has(served.DEVICES), 60, "all devices are there")
            answers.append(ask(scene, server))
    theirs, ours = answers
    assert theirs
    assert theirs == ours, "\n".join(f"{key}: owserver {theirs.get(key)!r}, owsd {ours.get(key)!r}"
                                     for key in {**theirs, **ours}
                                     if theirs.get(key) != ours.get(key))


# --- EVOK of Unipi --------------------------------------------------------------------------------
def evok_session(owdevice, server):
    import anyio

    @contextlib.asynccontextmanager
    async def here(**how):
        async with OWFS(**how) as ow:
            add_server = ow.add_server
            ow.add_server = lambda *_: add_server(server.host, server.port)  # EVOK's is 4304
            yield ow

    async def work(bus, answers):
        def all_read():
            return len(bus.mysensors) >= 6 and all(s.readtime and not s.lost for s in bus.mysensors)
        with anyio.fail_after(owsdtest.PATIENCE):
            while not all_read():
                await anyio.sleep(0.05)
        for sensor in bus.mysensors:
            sensor.alias = sensor.alias if hasattr(sensor, "alias") else ""  # its DS2408 has none
            answers[sensor.address] = (sensor.type, sensor.value,
                                       {**sensor.full(), "time": None})
        for sensor in [s for s in bus.mysensors if s.type in ("DS2406", "DS2408", "DS2413")]:
            rest = [0] * (6 if sensor.type == "DS2408" else 0)
            for value in ([1, 1, *rest], [0, 1, *rest]):
                await sensor.sens.set_PIO_all(value)
                answers[sensor.address, str(value)] = (await sensor.sens.get_PIO_all(),
                                                       await sensor.sens.get_sensed_all())
            await sensor.sens.set_PIO(0, 1)
            answers[sensor.address, "PIO.0"] = await sensor.sens.get_PIO(0)

    async def session():
        answers, bus = {}, owdevice.OwBusDriver("1", interval=1)
        async with anyio.create_task_group() as group:
            group.start_soon(bus.run)
            await work(bus, answers)
            answers["list"] = {kind: sorted(ids) for kind, ids in bus.list().items()}
            group.cancel_scope.cancel()
        return answers

    OWFS, owdevice.OWFS = owdevice.OWFS, here
    try:
        return anyio.run(session)
    finally:
        owdevice.OWFS = OWFS


def test_evok_finds_reads_and_switches_the_same(scene):
    where = peer("evok/evok/owdevice.py").parents[1]
    if sys.version_info < (3, 11):
        owsdtest.skip("asyncowfs is pinned with anyio for Python 3.11")
    messages = clients.python_client("asyncowfs.protocol")
    for message in (messages.AttrGetMsg, messages.AttrSetMsg, messages.DirMsg):
        message.timeout = owsdtest.PATIENCE
    sys.path.insert(0, str(where))
    sys.dont_write_bytecode = True
    owdevice = importlib.import_module("evok.owdevice")
    the_same(lambda _scene, server: evok_session(owdevice, server))


# --- FHEM -----------------------------------------------------------------------------------------
# What takes a genuine owserver long, or is of boards that are not there
SLOW = re.compile("page|memory|temperature1|CO2|TAI|T8A|8bit|volt2|alarm/")
SETS = {
    "28": [("temphigh", "61"), ("templow", "-3")],
    "10": [("temphigh", "40")],
    "29": [("PIO.0", "1"), ("PIO.BYTE", "165"), ("PIO.ALL", "0,1,0,1,0,1,0,1"), ("por", "0"),
           ("set_alarm", "133333333"), ("strobe", "1"), ("latch.BYTE", "0")],
    "12": [("PIO.A", "1"), ("PIO.BYTE", "3"), ("set_alarm", "331"), ("latch.A", "1")],
    "3A": [("PIO.A", "1"), ("PIO.ALL", "0,1")],
    "05": [("PIO", "1")],
    "1D": [],
    "20": [("set_alarm/volthigh.ALL", "1,2,3,4"), ("PIO.A", "1")],
}


class Telnet:
    """FHEM's port for commands: telnet(command) is its answer."""

    def __init__(self, port):
        self.s = socket.create_connection(("127.0.0.1", port), timeout=owsdtest.PATIENCE)
        self.serial = 0

    def __call__(self, command):
        self.serial += 1
        end = f"end {self.serial}\n"
        self.s.sendall(f"{command}\n{{ 'end {self.serial}' }}\n".encode())
        answer = ""
        while not answer.removesuffix("fhem> ").endswith(end):
            more = self.s.recv(65536)
            assert more, answer
            answer += more.decode("latin-1").replace("\r", "")
        return answer.removesuffix("fhem> ").removesuffix(end).replace("fhem> ", "").strip()


def fhem_session(scene, server):
    port = owsdtest.free_port()
    where = peer("fhem/fhem/fhem.pl")
    devices = [device for device in served.DEVICES if device[1:3] in SETS]
    config = ["attr global logfile -", "attr global nofork 1", f"attr global modpath {where.parent}",
              f"attr global statefile {scene.path}/state", "attr global sendStatistics never",
              f"define telnet telnet {port}", f"define ow OWServer 127.0.0.1:{server.port} 3.2p4"]
    config += [f"define D{device[1:3]} OWDevice {device[1:]}" for device in devices]
    program = scene.start([shutil.which("perl") or owsdtest.skip("no perl"), where,
                           scene.file("fhem.cfg", "\n".join(config) + "\n")],
                          {"HOME": str(scene.path)})

    def connected():
        assert program.running(), program.log()
        with contextlib.suppress(OSError):
            return Telnet(port)
        return None
    ask = until(connected, 60, "FHEM answers")
    answers = {"state": ask("list ow STATE")}
    for family in (device[1:3] for device in devices):
        listed = ask(f"get D{family} ?").split("choose one of ")[1].split()
        names = [name for name in listed if not SLOW.search(name)]
        for uncached in 0, 1:
            ask(f"attr D{family} uncached {uncached}")
            # of the DS2405 a genuine owserver has it once so and once so
            answers.update({(family, uncached, name): ask(f"get D{family} {name}")
                            for name in names if (family, name[-7:]) != ("05", "locator")})
        for name, value in SETS[family]:
            answers[family, name, value] = (ask(f"set D{family} {name} {value}"),
                                            name in listed and ask(f"get D{family} {name}"))
    return answers


def test_fhem_gets_and_sets_the_same(scene):
    the_same(fhem_session)


# --- SmartHomeNG ----------------------------------------------------------------------------------
def smarthome_session(module, server):
    answers = {}

    def ask(name, call, *words):
        try:
            answer = call(*words)
        except Exception as error:  # whatever it makes of it
            answer = f"{type(error).__name__}: {error}"
        if isinstance(answer, list):
            answer = sorted(entry for entry in answer if not entry.endswith("/signals/"))
        answers[name, *words] = answer
        return answer

    base = module.OwBase(server.host, server.port)
    base.connect()
    base._sock.settimeout(owsdtest.PATIENCE)
    for path in "/", "/uncached", "/uncached/bus.0/", "/28.AABBCCDDEEFF":
        ask("dir", base.dir, path)
    for device in ask("dir", base.dir, "/bus.0/"):
        if re.search("/(alarm|interface|simultaneous)/", device):
            continue
        keys, _ = ask("identify", base.identify_sensor, device)
        for key, name in (keys or {}).items():
            for value in (1, 0) if key[0] == "O" else ():
                ask(f"write {value}", base.write, device + name, value)
                ask(f"then {value}", base.read, "/uncached" + device + name)
            if key not in ("B", "BM"):
                ask("read", base.read, device + name)
    ask("write", base.write, served.THERMOMETER + "/alias", "Kueche")
    for path in "/settings/alias/list", "/bus.0/Kueche/temperature", served.ABSENT + "/type":
        ask("read", base.read, path)
    ask("identify", base.identify_sensor, "/bus.0/Kueche/")
    base.close()
    return answers


def test_smarthomeng_finds_reads_and_writes_the_same(scene):
    spec = importlib.util.spec_from_file_location("owbase", peer("smarthome/onewire/owbase.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    the_same(lambda _scene, server: smarthome_session(module, server))


if __name__ == "__main__":
    sys.exit(owsdtest.main())
