#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl -t TARGET dir, read, write, scan: on simulated chips and on the genuine owserver."""

import json
import re
import subprocess

import owsdtest
import peer

DEVICES = """
DS18B20 28.67C6697351FF as a temperature 21.5
DS18B20 28.4AEC29CDBAAB as b temperature -5.0625
DS18S20 10.0000000000C1 as c temperature 12.5
DS2408 29.000029D60000 as d
DS2413 3A.000000000001 as e
DS2438 26.F2FBE3467CC2 as f temperature 22 vdd 5 vad 2.3
DS2401 01.000000000001 as g
"""


def sim(scene, devices=DEVICES):
    text = "i2c speed 400 combine any\nchip DS2482-100 0x18\n" + devices
    return f"sim:{scene.file('wire.sim', text)}"


def ctl(scene, target, *words, status=0, seconds=60):
    done = scene.owsctl(None, "-t", target, *words, seconds=seconds)
    assert done.returncode == status, (words, done)
    return done


def lines(scene, target, *words):
    return ctl(scene, target, *words).stdout.splitlines()


def test_dir_lists_paths_one_on_a_line(scene):
    target = sim(scene)
    found = lines(scene, target, "dir")
    assert "/28.67C6697351FF" in found and "/bus.0" in found
    assert sorted(found) == sorted(json.loads(ctl(scene, target, "--json", "dir", "/").stdout))
    assert "/29.000029D60000/PIO.BYTE" in lines(scene, target, "dir", "29.000029D60000")
    uncached = lines(scene, target, "dir", "/uncached")
    assert "/uncached/28.67C6697351FF" in uncached
    assert all(re.fullmatch(r"/uncached/[^/]+", path) for path in uncached), uncached
    assert "/uncached/uncached" not in uncached


def test_dir_of_an_owserver_is_that_of_owdir(scene):
    server = scene.owserver(mock=["28", "26"], tester=["29"])
    for path in ("/", "/uncached", server.devices()[0], "/bus.0"):
        done = subprocess.run(["owdir", "-s", server.target, path], text=True, check=True,
                              timeout=owsdtest.PATIENCE, capture_output=True)
        listed = [line for line in done.stdout.split() if line != "/uncached/uncached"]
        assert sorted(lines(scene, server.target, "dir", path)) == sorted(listed), path


def test_read_prints_what_owread_prints_but_its_padding(scene):
    server = scene.owserver(tester=["29", "26"])  # their values are computed from the id
    listed = [path for device in server.devices()
              for path in lines(scene, server.target, "dir", device)]

    def texts():
        found = {}
        for path in listed:
            try:
                found[path] = server.request(owsdtest.READ, path)[1].decode()
            except (OSError, UnicodeDecodeError):
                pass
        return found

    before = texts()
    read = json.loads(scene.owsctl(None, "-t", server.target, "--json", "read", *before).stdout)
    after = texts()
    compared = 0
    for path, row in zip(before, read):
        text = before[path]
        if not text or row["value"] is None or after.get(path) != text:
            continue
        if all(len(part) == 12 for part in text.split(",")):
            text = text.replace(" ", "")
        if isinstance(row["value"], str):
            assert row["value"] == text, (path, row, text)
        else:
            assert row["value"] == float(text), (path, row, text)
        compared += 1
    assert compared > 30, (compared, len(read))
    path = next(path for path in before if path.endswith("/PIO.BYTE"))
    done = subprocess.run(["owread", "-s", server.target, path], text=True, check=True,
                          timeout=owsdtest.PATIENCE, capture_output=True)
    assert len(done.stdout) == 12
    assert ctl(scene, server.target, "read", path).stdout == done.stdout.strip() + "\n"


def test_read_of_our_own_bus_agrees_with_owserver(scene):
    server = scene.owserver(mock=["28"])
    device = server.devices()[0]
    target = sim(scene, f"DS18B20 {device[1:]} as t temperature -5.0625\n")

    def texts(target, *names):
        return ctl(scene, target, "read", *(f"{device}/{name}" for name in names)).stdout

    for name in ("temperature", "temphigh"):
        text = texts(target, name)
        server.write(f"{device}/{name}", text.strip())
        assert texts(server.target, name) == text, name
    same = ("type", "family", "id", "address", "crc8", "r_id", "r_address", "alias")
    assert texts(target, *same) == texts(server.target, *same)
    for path in (device + "/nothing", "/28.0000000000FF/temperature"):
        errors = {ctl(scene, t, "read", path, status=1).stderr for t in (target, server.target)}
        assert len(errors) == 1, errors


def test_memories_and_a_battery_protector_are_those_of_owserver(scene):
    server = scene.owserver(mock=["09", "31", "43"])
    devices = {d[1:3]: d for d in server.devices()}
    parts = {"09": "DS2502", "31": "DS2720", "43": "DS28EC20"}
    target = sim(scene, "".join(f"{part} {devices[f][1:]}\n" for f, part in parts.items()))

    def both(*words):
        ours, theirs = (ctl(scene, t, *words).stdout for t in (target, server.target))
        assert ours, words
        return ours, theirs

    for family, device in devices.items():
        ours, theirs = both("dir", device)
        assert sorted(ours.split()) == sorted(theirs.split()), family
        for name in ("memory", "pages/page.0", "type", "present"):
            ours, theirs = both("read", f"/structure/{family}/{name}")
            assert ours == theirs, (family, name)
        names = ("type", "family", "id", "address", "crc8", "r_id", "r_address", "alias")
        ours, theirs = both("read", *(f"{device}/{name}" for name in names))
        assert ours == theirs, family
    for name in ("cc", "lock.1", "psf", "uv"):
        ours, theirs = both("read", f"/structure/31/{name}")
        assert ours == theirs, name


def test_read_takes_several_paths_and_goes_on_after_an_error(scene):
    target = sim(scene)
    paths = ["/28.67C6697351FF/temperature12", "/28.67C6697351FF/none", "/29.000029D60000/PIO.ALL"]
    done = ctl(scene, target, "read", *paths, status=1)
    assert done.stdout == "21.5\n0,0,0,0,0,0,0,0\n"
    assert done.stderr == "owsctl: /28.67C6697351FF/none: no such property: check its " \
        "spelling; owsctl dir shows what a device has\n"
    first, second, third = json.loads(ctl(scene, target, "--json", "read", *paths, status=1).stdout)
    assert first == dict(path=paths[0], value=21.5, simulated=True, cached=False)
    assert second["value"] is None and second["error"] == "no such property"
    assert third["value"] == "0,0,0,0,0,0,0,0"


def test_write_writes(scene):
    server = scene.owserver(mock=["28"])
    path = server.devices()[0] + "/temphigh"
    for value in ("30", "-12"):
        assert ctl(scene, server.target, "write", path, value).stdout == ""
        assert ctl(scene, server.target, "read", path).stdout == value + "\n"
    target = sim(scene)
    ctl(scene, target, "write", "/29.000029D60000/PIO.BYTE", "5")
    done = ctl(scene, target, "write", "/29.000029D60000/PIO.BYTE", "five", status=1)
    assert "refuses this value" in done.stderr
    assert ctl(scene, target, "write", "/29.000029D60000/type", "x", status=1).stderr


def test_scan_shows_every_device_with_its_values(scene):
    target = sim(scene)
    table = lines(scene, target, "scan")
    assert len(table) == 8 and table[0].split()[:2] == ["PATH", "FAMILY"]
    found = {d["path"]: d for d in json.loads(ctl(scene, target, "--json", "scan").stdout)}
    assert len(found) == 7
    assert all(d["bus"] == "bus.0" and d["simulated"] for d in found.values())
    assert found["/28.4AEC29CDBAAB"]["values"] == {"temperature12": -5.0625}
    assert found["/28.4AEC29CDBAAB"]["alarm"] is True
    assert found["/10.0000000000C1"]["values"] == {"temperature": 12.5}
    assert found["/26.F2FBE3467CC2"]["type"] == "DS2438"
    assert set(found["/26.F2FBE3467CC2"]["values"]) == {"temperature", "humidity", "VDD", "VAD"}
    single = found["/01.000000000001"]
    assert single.pop("id") == "01.000000000001" and single.pop("signals") == []
    present, = single.pop("properties")
    assert (present["name"], present["value"], present["why"]) == ("present", "1", None), present
    assert single == dict(path="/01.000000000001", family="01", type="DS2401",
                          identity=None, alias=None, bus="bus.0", alarm=False,
                          simulated=True, values={"present": 1})


def runs(scene, text):
    """owsd takes the configuration without a word, and all its signals become good."""
    file = scene.file("found.rio", text)
    check = scene.owsd_once("--check", "-c", file, seconds=90)
    assert check.returncode == 0 and check.stderr == "", check
    daemon = scene.owsd(file)

    def rows():
        listed = json.loads(scene.owsctl(daemon, "--json", "list").stdout)
        return listed if all(row["good"] for row in listed) else None

    return {row["name"]: row for row in scene.until(rows, 30, "all signals are good")}


def test_scan_says_what_a_chip_is_whose_family_code_does_not(scene):
    target = sim(scene, """
DS2438 26.F2FBE3467CC2 as a temperature 22 vdd 5 vad 2.3
TMP1826 26.000000000001 as b temperature 21.5
DS18B20-B1 28.AA3C61551401 as c temperature 21.4375
DS18B20 28.CAD610100000 as d temperature 21.4375
DS2401 01.000000000001 as e
""")
    found = {row["path"]: row for row in json.loads(ctl(scene, target, "--json", "scan").stdout)}
    said = {path[1:3] + path[-2:]: (row["type"], row["identity"]) for path, row in found.items()}
    assert said == {
        "26C2": ("DS2438", "DS2438"), "2601": ("TMP1826", "TMP1826"),
        "2801": ("DS18B20", "DS18B20 clone, family B1"), "2800": ("DS18B20", "DS18B20"),
        "0101": ("DS2401", None)}, said
    assert found["/26.000000000001"]["values"]["temperature"] == 21.5
    assert found["/26.000000000001"]["values"]["VDD"] is None
    table = ctl(scene, target, "scan").stdout
    assert re.search(r"TMP1826 .* temperature=21.5 *$", table, re.M), table
    assert "DS18B20 clone, family B1" in table
    items = ctl(scene, target, "scan", "--rio").stdout
    assert "/26.000000000001/temperature" in items and "/26.000000000001/VDD" not in items


def test_the_configuration_of_a_scan_runs_on_simulated_chips(scene):
    rows = runs(scene, ctl(scene, sim(scene), "scan", "--rio").stdout)
    assert len(rows) == 12
    assert rows["inputs1"]["type"] == "byte" and rows["outputs1"]["io"] == "output"
    assert {rows[f"temperature{i}"]["value"] for i in range(1, 5)} == {21.5, -5.0625, 12.5, 22}


EVERY_FAMILY = """
DS18S20 10.0000000000C1 temperature 12.5
DS18B20 28.000000000001 temperature 21.5
DS1822 22.000000000002 temperature 19
DS1825 3B.000000000003 temperature 18
DS28EA00 42.000000000004 temperature 17
DS2401 01.000000000005
DS2405 05.000000000006
DS2406 12.000000000007
DS2408 29.000000000008
DS2413 3A.000000000009
DS2423 1D.00000000000A count.A 7
DS2430A 14.00000000000B
DS2431 2D.00000000000C
DS2433 23.00000000000D
DS2438 26.00000000000E temperature 22 vdd 5 vad 2.3
DS2450 20.00000000000F volt.A 1.5
DS2502 09.000000000010
DS2720 31.000000000011
DS28EC20 43.000000000012
MAX31888 54.000000000013 temperature 23
MAX31850 3B.000000000014 temperature 24 thermocouple 900
"""


def test_every_family_has_its_place_in_the_configuration_of_a_scan(scene):
    rows = runs(scene, ctl(scene, sim(scene, EVERY_FAMILY), "scan", "--rio").stdout)
    devices = {line.split()[1] for line in EVERY_FAMILY.splitlines() if line}
    assert {row["path"].split("/")[1] for row in rows.values()} == devices
    named = {row["path"][1:3]: name for name, row in sorted(rows.items(), reverse=True)}
    for family, start, kind in (("10", "temperature", "double"), ("42", "temperature", "double"),
                                ("14", "present", "bool"), ("2D", "present", "bool"),
                                ("23", "present", "bool"), ("05", "contact", "bool"),
                                ("1D", "counter_a", "dword"), ("20", "volt_a", "double"),
                                ("29", "inputs", "byte"), ("26", "humidity", "double")):
        assert named[family].startswith(start) and rows[named[family]]["type"] == kind, named
    paths = {row["path"] for row in rows.values()}
    assert {"/54.000000000013/temperature", "/3B.000000000014/thermocouple"} <= paths
    assert "/3B.000000000003/thermocouple" not in paths
    assert rows["counter_a1"]["value"] == 7 and rows["present1"]["value"] is True


def test_each_device_has_an_item_or_is_named(scene):
    parts = [line for line in (owsdtest.SOURCE / "tests/system/compare/devices.sim").read_text().splitlines()
             if line and line[0] != "#"]
    target = sim(scene, "\n".join(parts) + "\n")
    done = ctl(scene, target, "scan", "--rio", seconds=300)
    check = scene.owsd_once("--check", "-c", scene.file("found.rio", done.stdout), seconds=90)
    assert check.returncode == 0 and check.stderr == "", check
    items = set(re.findall(r'Path +"/([^/"]+)/', done.stdout))
    noted = dict(re.findall(r"# no signal for (\S+) \((\S+)\); owsctl -t \S+ dir /\1 lists", done.stdout))
    for line in parts:
        device = line.split()[1]
        assert (device in items) != (device in noted), line
        assert (f"no signal for {device} (" in done.stderr) == (device in noted), line
    left = dict(re.findall(r"# left out of (\S+) \(\S+\): (.+); owsctl -t \S+ dir /\1 lists", done.stdout))
    assert left["26.C0FFEE000033"] == "B1-R1-A/pressure, S3-R1-A/current, S3-R1-A/illuminance, vis", left
    assert set(left) <= items and all(f"left out of {device} (" in done.stderr for device in left), done.stderr
    assert not {device for device in left if device[:2] in ("28", "29", "3A")}, left
    # memories, clocks, bridges, and what takes texts: all others measure, count or switch
    assert not set(noted.values()) & {"DS1921", "DS1923", "DS2437", "DS2760", "EDS0068", "IBLSS", "LCD"}
    for path in ("EDS0068/temperature", "EDS0068/humidity", "EDS0090/input.BYTE", "EDS0082/volts.7",
                 "multitemp/temperature.5", "TH/humidity", "910/count", "amphours"):
        assert f'/{path}"' in done.stdout, path
    assert "/7E.C0FFEE000041/EDS0068" not in done.stdout
    table = ctl(scene, target, "scan", seconds=300).stdout.splitlines()[1:]
    assert len(table) == len(parts)
    for line in table:
        device = line.split()[0][1:]
        assert (f"(owsctl dir /{device})" in line) == (device in noted), line


def test_each_switch_gets_its_signal_if_it_is_asked_for(scene):
    wire = sim(scene, EVERY_FAMILY)
    rows = runs(scene, ctl(scene, wire, "scan", "--rio", "--bits").stdout)
    paths = {row["path"] for row in rows.values() if row["path"][1:3] in ("12", "29", "3A")}
    assert paths == {f"/{device}/{name}.{element}" for name in ("PIO", "sensed") for device, elements in (
        ("12.000000000007", "AB"), ("29.000000000008", "01234567"), ("3A.000000000009", "AB"))
        for element in elements}, paths
    assert {row["type"] for row in rows.values() if row["path"][1:] in paths} <= {"bool"}
    assert rows["input12"]["io"] == "input" and rows["output12"]["io"] == "output"
    names = scene.file("aliases", "29.000000000008 = board\n")
    rows = runs(scene, ctl(scene, wire, "scan", "--alias", names, "--rio", "--bits").stdout)
    assert rows["board_output3"]["path"] == "/29.000000000008/PIO.3", rows
    assert rows["board_input7"]["path"] == "/29.000000000008/sensed.7", rows
    inputs = ctl(scene, wire, "scan", "--rio", "--bits", "-i").stdout
    assert '"output"' not in inputs and "sensed.7" in inputs
    done = ctl(scene, wire, "scan", "--bits", status=2)
    assert "--bits goes with --rio" in done.stderr, done


def test_the_configuration_of_a_scan_runs_on_owserver_and_changes_no_output(scene):
    server = scene.owserver(mock=["28", "26"], tester=["29"])
    path = next(d for d in server.devices() if d.startswith("/29")) + "/PIO.BYTE"
    before = server.read(path)
    assert before != "0"
    scanned = ctl(scene, server.target, "scan", "--rio").stdout
    rows = runs(scene, scanned)
    assert str(rows["outputs1"]["value"]) == before == server.read(path)
    assert len(re.findall(r"InitValue +\"\d+\"\n +Start +last\n", scanned)) == 1, scanned
    bits = runs(scene, ctl(scene, server.target, "scan", "--rio", "--bits").stdout)
    assert before == server.read(path) and "outputs1" not in bits
    assert sum(bits[f"output{k + 1}"]["value"] << k for k in range(8)) == int(before), bits
    inputs = ctl(scene, server.target, "scan", "--rio", "-i").stdout
    assert '"output"' not in inputs and "inputs1" in inputs


def test_a_scan_that_takes_long_says_how_far_it_is(scene):
    values = {}
    for n in range(8):
        values.update({f"/28.{n:012X}/{name}": value for name, value in
                       (("type", "DS18B20"), ("alias", ""), ("temperature12", "21.5"))})
    with peer.Peer(values) as server:
        server.mode = "late 0.4"
        done = ctl(scene, server.target, "scan")
    assert re.search(rf"^owsctl: \d+ of 32 answers from {server.target}$", done.stderr, re.M), done
    assert len(done.stdout.splitlines()) == 9


class Maze(peer.Peer):
    """Behind each branch of a coupler are `couplers` couplers, of the same ids or of new ones."""
    couplers, new = 3, False

    def _list(self, path):
        way = path.rstrip("/")
        if way.rsplit("/", 1)[-1] not in ("main", "aux"):
            return super()._list(path)
        first = 1 + (len(self.requests) * self.couplers if self.new else 0)
        return [f"{way}/1F.{first + n:012X}" for n in range(self.couplers)]


def test_a_scan_looks_behind_each_coupler_once(scene):
    with Maze({"/1F.000000000001/type": "DS2409"}) as server:
        paths = [line.split()[0] for line in lines(scene, server.target, "scan")]
        assert paths.count("/1F.000000000001/main/1F.000000000002") == 1, paths
        behind = [r for r in server.requests
                  if r.kind == peer.DIRALL and r.path.rstrip("/").endswith(("/main", "/aux"))]
        assert len(behind) == 2 * server.couplers, behind


def test_a_scan_of_an_owsd_whose_target_is_down_says_so(scene):
    daemon = scene.owsd(owsdtest.rio("127.0.0.1:9", [dict(Name="x", Path="/28.000000000001/temperature", Type="double")]))
    done = scene.owsctl(daemon, "scan")
    assert done.returncode == 1, done
    assert "no target of this owsd lists devices: owsctl stats shows how they do" in done.stderr, done


def test_a_scan_of_couplers_without_end_fails(scene):
    with Maze({"/1F.000000000001/type": "DS2409"}) as server:
        server.couplers, server.new = 40, True
        done = ctl(scene, server.target, "scan", status=1)
        assert "more than 512 couplers" in done.stderr, done


def test_an_alias_names_the_signals(scene):
    server = scene.owserver(mock=["28", "26"])
    battery, thermometer = server.devices()
    server.write(thermometer + "/alias", "living")
    server.write(battery + "/alias", "air")
    found = json.loads(ctl(scene, server.target, "--json", "scan").stdout)
    assert {d["alias"]: d["path"] for d in found} == {"living": thermometer, "air": battery}
    rows = runs(scene, ctl(scene, server.target, "scan", "--rio").stdout)
    assert set(rows) == {"living", "air_temperature", "air_humidity", "air_vdd", "air_vad"}


def described(text):
    """{name: description} of the items of a configuration."""
    items = re.findall(r' Name +"(.*)"\n(?:.*\n){3}(?: +Description +"(.*)"\n)?', text)
    return dict(items)


def test_an_alias_that_is_no_name_makes_one_and_the_description(scene):
    server = scene.owserver(mock=["28", "28", "1D", "28", "28"])
    for path, alias in zip(server.devices(), (
            'Strom "T" #1{a}', "Bath room", "Bath_room", "x" * 63, "Keller")):
        server.write(path + "/alias", alias)
    made = ctl(scene, server.target, "scan", "--rio").stdout
    long = "x" * 63
    assert described(made) == {
        "Strom__T___1_a__counter_a": r'Strom \"T\" #1{a}',
        "Strom__T___1_a__counter_b": r'Strom \"T\" #1{a}', "Bath_room": "Bath room",
        "Bath_room_2": "", long: "", "Keller": ""}, made
    runs(scene, made)


def test_names_come_from_an_alias_file(scene):
    server = scene.owserver(mock=["28", "26", "28", "28"])
    battery, *others = server.devices()
    server.write(battery + "/alias", "air")
    server.write(others[0] + "/alias", "old")
    full = scene.owsctl(None, "-t", server.target, "read", others[2] + "/address").stdout.strip()
    aliases = scene.file("alias", f"# names\n\n{others[0][1:]} = kitchen\n{others[1]}=bath room\r\n"
                                  f"  {full} : cellar  \n28.0000000000EE = gone\nnothing = x\n"
                                  f"{battery[1:]}\n")
    done = scene.owsctl(None, "-t", server.target, "scan", "--rio", "--alias", aliases)
    assert done.returncode == 0, done
    assert set(described(done.stdout)) == {
        "kitchen", "bath_room", "cellar", "air_temperature", "air_humidity", "air_vdd", "air_vad"}
    assert [line.split(": ", 2)[2] for line in done.stderr.splitlines() if str(aliases) in line] == [
        "28.0000000000EE was not found", "nothing is no id of a device",
        f"{battery[1:]} has no name here"], done.stderr
    found = json.loads(ctl(scene, server.target, "--json", "scan", "--alias", aliases).stdout)
    assert {d["alias"] for d in found} == {"air", "kitchen", "bath room", "cellar"}
    done = scene.owsctl(None, "-t", server.target, "scan", "--alias", "/nowhere/alias")
    assert done.returncode == 1 and "/nowhere/alias: No such file" in done.stderr, done


def test_what_is_wrong_is_said_with_its_status(scene):
    target = sim(scene)
    nobody = f"127.0.0.1:{owsdtest.free_port()}"
    for words, status, what in (
            (("-t", nobody, "dir"), 1, "Connection refused"),
            (("-t", "sim:/nowhere.sim", "scan"), 2, "/nowhere.sim"),
            (("-t", "i2c:/dev/i2c-nowhere", "scan"), 1, "/dev/i2c-nowhere"),
            (("-t", "none:", "dir"), 2, "unknown kind of target"),
            (("-t", "none:", "dir"), 2, "gpio:, and HOST, HOST:PORT"),
            (("-t", target, "list"), 2, "-t TARGET is for dir"),
            (("-t", target, "read"), 2, "read what?"),
            (("-t", target, "read", "/" + "x" * 300), 1, "longer than 255"),
            (("-t", target, "write", "/x"), 2, "a path and a value"),
            (("-t", target, "scan", "-i"), 2, "goes with --rio"),
            (("-t", target, "--json", "scan", "--rio"), 2, "no JSON"),
            (("-t", target, "dir", "-w", "soon"), 2, "not a number of seconds"),
            (("-t", target, "dir", "/28.0000000000FF"), 1, "no such device"),
            (("list", "--rio"), 2, "unknown option")):
        done = scene.owsctl(None, *words)
        assert done.returncode == status and what in done.stderr, (words, done)
        assert not done.stdout, (words, done)


def test_a_silent_target_is_given_up_in_time(scene):
    server = scene.owserver(mock=["28"])
    server.freeze()
    # with more time it is the greeting that is given up, in other words
    done = scene.owsctl(None, "dir", "-t", server.target, "-w", "0.5")
    assert done.returncode == 1 and "no answer in time" in done.stderr, done
    done = scene.owsctl(None, "dir", "-t", server.target, "-w", "60")
    assert done.returncode == 1 and "answer" in done.stderr, done
    assert "no answer in time" not in done.stderr, done


def test_a_scan_that_finds_nothing_says_so_and_has_a_status_of_its_own(scene):
    target = sim(scene, "")
    for words, out in ((("scan",), ""), (("--json", "scan"), "[]\n"), (("scan", "--rio"), ""),
                       (("scan", "--rio", "-i"), "")):
        done = ctl(scene, target, *words, status=4)
        assert done.stdout == out and "no device is there: look at the wires" in done.stderr, done
    nobody = f"127.0.0.1:{owsdtest.free_port()}"
    for words in (("scan",), ("scan", "--rio")):
        done = ctl(scene, nobody, *words, status=1)
        assert done.stdout == "" and "cannot open" in done.stderr, done


def test_devices_that_make_no_signal_make_no_configuration(scene):
    server = scene.owserver(fake=["2C"])
    assert len(lines(scene, server.target, "scan")) == 2
    done = ctl(scene, server.target, "scan", "--rio", status=4)
    assert done.stdout == "" and "has 1 device, and none that" in done.stderr, done


def test_a_scan_that_fails_says_that_its_file_is_empty(scene):
    for target, status in ((sim(scene, ""), 4), (f"127.0.0.1:{owsdtest.free_port()}", 1)):
        with open(scene.path / "plant.rio", "w", encoding="utf-8") as out:
            done = subprocess.run([owsdtest.with_sim(owsdtest.OWSCTL, target), "-t", target, "scan", "--rio"], stdout=out,
                                  stderr=subprocess.PIPE, text=True, check=False,
                                  timeout=owsdtest.PATIENCE)
        assert done.returncode == status and "output goes to is empty" in done.stderr, done


BEFORE = """
DS18B20 28.2022DB060000 as a temperature 21.5
DS18B20 28.4AEC29CDBAAB as b temperature -5.0625
DS2413  3A.000000000001 as c
"""
# b was exchanged for another; a DS2438 came, and a thermometer whose id sorts before all others
AFTER = """
DS18B20 28.2022DB060000 as a temperature 21.5
DS18B20 28.7777777777AB as b temperature -5.0625
DS2413  3A.000000000001 as c
DS2438  26.F2FBE3467CC2 as d temperature 22 vdd 5 vad 2.3
"""


def plant(scene):
    """A configuration that was made by a scan and then worked on."""
    text = ctl(scene, sim(scene, BEFORE), "scan", "--rio").stdout
    text = text.replace('Name                    "temperature1"',
                        '# the living room\n    Name "room"   # mine\n    LimitH 26.50')
    text = text.replace("  TargetName", "  Timeout 20.0\n  TargetName", 1)
    assert "room" in text and '"temperature2"' in text and "20.0" in text
    return text


def without(text, *lines_out):
    return "".join(line for line in text.splitlines(True) if not any(x in line for x in lines_out))


def test_a_merge_changes_nothing_where_nothing_changed(scene):
    for end in ("\n", "\r\n"):
        text = plant(scene).replace("\n", end)
        file = scene.path / "plant.rio"
        file.write_bytes(text.encode())
        done = subprocess.run([owsdtest.with_sim(owsdtest.OWSCTL, "sim:"), "-t", sim(scene, BEFORE), "scan",
                               "--rio", "--merge", file], capture_output=True, check=False, timeout=owsdtest.PATIENCE)
        assert (done.returncode, done.stderr) == (0, b""), done
        assert done.stdout == text.encode()


def test_a_merge_keeps_every_byte_and_says_new_missing_and_perhaps_replaced(scene):
    text = plant(scene)
    file = scene.file("plant.rio", text)
    done = ctl(scene, sim(scene, AFTER), "scan", "--rio", "--merge", file)
    head, tail = text[:text.rindex("}")], done.stdout
    assert without(tail, "ItemCount").startswith(without(head, "ItemCount")), tail
    assert file.read_text() == text
    for said in ("owsctl: missing: temperature2: 28.4AEC29CDBAAB was not found; its items stay\n",
                 "owsctl: new: temperature1 to vad1: 26.F2FBE3467CC2 (DS2438)\n",
                 "owsctl: new: temperature3: 28.7777777777AB (DS18B20)\n",
                 "--replace 28.4AEC29CDBAAB=28.7777777777AB\n"):
        assert said in done.stderr, done.stderr
    assert "room" not in done.stderr and "3A.0000" not in done.stderr, done.stderr
    names = re.findall(r'\bName +"(.*)"', tail)
    assert len(set(names)) == len(names) and "temperature2" in names, names
    check = scene.owsd_once("--check", "-c", scene.file("merged.rio", tail))
    assert check.returncode == 0 and check.stderr == "", check


def test_a_device_is_replaced_only_when_it_is_asked_for(scene):
    text = plant(scene)
    file = scene.file("plant.rio", text)
    target = sim(scene, AFTER)
    for old in ("28.4AEC29CDBAAB", "temperature2", "/284AEC29CDBAAB"):
        done = ctl(scene, target, "scan", "--rio", "-i", "--merge", file, "--replace",
                   f"{old}=28.7777777777AB")
        assert "owsctl: replaced: temperature2: 28.4AEC29CDBAAB by 28.7777777777AB\n" in done.stderr
        assert "missing" not in done.stderr, done.stderr
        expected = text[:text.rindex("}")].replace("/28.4AEC29CDBAAB/", "/28.7777777777AB/")
        assert without(done.stdout, "ItemCount", "Identity").startswith(without(expected, "ItemCount"))
        # its history goes on
        assert re.findall(r'Identity +"(.*)"', done.stdout) == ["/28.4AEC29CDBAAB/temperature12"], done


def test_a_replacement_keeps_the_form_of_the_path(scene):
    chips = "DS18B20 28.7777777777AB as b temperature -5.0625\n"
    paths = {"/uncached/28.4AEC29CDBAAB/temperature9": "/uncached/28.7777777777AB/temperature9",
             "284aec29cdbaab/temperature": "287777777777AB/temperature",
             "/bus.3/28.4AEC29CDBAAB/temperature": "/bus.0/28.7777777777AB/temperature"}
    file = scene.file("plant.rio", owsdtest.rio("", [
        dict(Name=f"t{i}", Path=path, Type="double") for i, path in enumerate(paths)]))
    done = ctl(scene, sim(scene, chips), "scan", "--rio", "--merge", file, "--replace",
               "t1=28.7777777777AB")
    assert re.findall(r'Path +"(.*)"', done.stdout) == list(paths.values()), done
    assert re.findall(r'Identity +"(.*)"', done.stdout) == [
        "/28.4AEC29CDBAAB/temperature9", "/284aec29cdbaab/temperature", "/bus.3/28.4AEC29CDBAAB/temperature"], done


def test_what_cannot_be_merged_is_refused_and_nothing_is_printed(scene):
    file = scene.file("plant.rio", plant(scene))
    target = sim(scene, AFTER)
    broken = scene.file("broken.rio", "OwsDrv {\n  Item {\n")
    merge = ("scan", "--rio", "--merge", file)
    b, new = "28.4AEC29CDBAAB", "28.7777777777AB"
    for words, status, what in (
            (("scan", "--merge", file), 2, "--merge goes with --rio"),
            (("--json", *merge), 2, "--rio prints no JSON"),
            (("scan", "--rio", "--replace", f"{b}={new}"), 2, "--replace goes with --merge"),
            ((*merge, "--replace", b), 2, "expected OLD=NEW"),
            ((*merge, "--replace", f"kitchen={new}"), 2, "neither the id of a device nor"),
            ((*merge, "--replace", f"{new}={new}"), 1, "no item of the file has this device"),
            ((*merge, "--replace", f"room={new}"), 1, "the old device is still there"),
            ((*merge, "--replace", f"{b}=28.0000000000FF"), 1, "was not found"),
            ((*merge, "--replace", f"{b}=28.2022DB060000"), 1, "has items in the file already"),
            ((*merge, "--replace", f"{b}=26.F2FBE3467CC2"), 1, "of different families"),
            (("scan", "--rio", "--merge", "/nowhere.rio"), 1, "/nowhere.rio"),
            (("scan", "--rio", "--merge", broken), 2, "broken.rio:")):
        done = ctl(scene, target, *words, status=status)
        assert done.stdout == "" and what in done.stderr, (words, done)
    done = ctl(scene, sim(scene, ""), *merge, status=4)
    assert done.stdout == "" and "no device is there" in done.stderr, done
    for redirect in (">", ">>"):
        done = subprocess.run(["/bin/sh", "-c", f'"$0" -t {target} scan --rio --merge x.rio {redirect} x.rio',
                               owsdtest.with_sim(owsdtest.OWSCTL, target)], cwd=scene.path, capture_output=True, text=True,
                              check=False, timeout=owsdtest.PATIENCE)
        assert done.returncode == 1 and "x.rio is where the output goes" in done.stderr, done


def test_items_that_name_no_id_are_not_called_missing(scene):
    server = scene.owserver(mock=["28"])
    thermometer, = server.devices()
    server.write(thermometer + "/alias", "living")
    file = scene.file("plant.rio", owsdtest.rio(server.target, [
        dict(Name="room", Path="/living/temperature", Type="double"),
        dict(Name="attic", Path="/attic/temperature", Type="double")]))
    done = ctl(scene, server.target, "scan", "--rio", "--merge", file)
    assert done.stdout == file.read_text(), done
    assert done.stderr == ("owsctl: not judged: attic: its path, /attic/temperature, has no id of a "
                           "device\n"), done


if __name__ == "__main__":
    owsdtest.main()
