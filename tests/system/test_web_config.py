#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-web and the configuration: who may edit it, and what edits of a draft do."""

import json
import pathlib
import re
import shutil
import socket
import subprocess
import threading

import faulty
import handbook
import owsdtest
from owsdtest import place, raw, until
from test_web import ROOM, SENSOR, Page, both
from test_writer import alone as writer_alone

MARKED = {"Content_Type": "application/json", "X_Owsd": "1"}
LARGE = 1536 * 1024


def post(page, api, status=200, unix=False, headers=None, **members):
    return page.json("/api/" + api, status, method="POST", body=json.dumps(members), unix=unix,
                     **({**MARKED, **(headers or {})}))


def draft(page, text, do, status=200, **members):
    return post(page, "config/draft", status, text=text, do=do, **members)


def editor(scene, *items, **web):
    return both(scene, *items, Configure="on", **web)


def test_the_page_gets_the_file_its_model_and_the_table_of_keys(scene):
    daemon, page = editor(scene)
    got = page.json("/api/config")
    assert got["file"] == str(daemon.config) and got["text"] == daemon.config.read_text()
    assert len(got["tag"]) == 16 and int(got["tag"], 16) and got["backup"] is None
    assert got["configurable"] and got["why"] is None
    model = got["model"]
    assert model["targets"] == [f"sim:{scene.path / 'house.sim'}"] and model["driver"]["Timeout"] == "3"
    assert model["blocks"]["Web"]["Configure"] == "on" and model["buses"] == []
    room = model["items"][0]
    assert (room["name"], room["path"], room["device"]) == (
        "room", SENSOR + "/temperature", SENSOR[1:])
    assert room["keys"] == {"Type": "double", "IO": "input", "LimitH": "20", "Unit": "\u00b0C"}
    assert (room["type"], room["io"], room["uncached"]) == ("double", "input", False)
    assert got["text"].splitlines()[room["line"] - 1].strip() == "Item {"
    keys = {(k["place"], k["key"]): k for k in page.json("/api/config/keys")["keys"]}
    assert keys["driver", "Timeout"] == {
        "place": "driver", "key": "Timeout", "kind": "seconds", "default": "20", "least": 0.001,
        "most": 86400, "repeats": False, "help": "time limit of a request, seconds", "empty": False}
    assert keys["item", "LimitH"]["least"] is None and keys["bus", "Touch"]["kind"] == "flag"
    assert all(k["help"] for k in keys.values())


def test_what_the_page_has_curl_do_is_done(scene):
    """docs/web-api.md, word for word but for the place of the socket."""
    if not shutil.which("curl"):
        owsdtest.skip("curl is not installed")
    _, page = editor(scene)
    events, checked = (subprocess.run(["sh", "-c", block.text.replace("/run/owsd/OWS.web", str(page.socket))], text=True,
                                      capture_output=True, timeout=owsdtest.PATIENCE, check=True).stdout
                       for block in handbook.blocks(owsdtest.SOURCE / "docs/web-api.md") if block.language == "sh")
    assert "event: found" in events, events
    problem, = json.loads(checked)["problems"]
    assert problem["line"] == 2 and "Timeout" in problem["text"], problem


def test_nobody_edits_unless_the_block_says_configure_on(scene):
    _, page = both(scene, Write="on")
    assert page.json("/api/info")["configurable"] is False
    for unix in (False, True):
        got = page.json("/api/config", unix=unix)
        assert got["configurable"] is False and "Configure on" in got["why"], got
        assert "Configure on" in post(page, "config/draft", 403, unix, text="", do="check")["error"]
    # the right is looked at before so large a body is kept
    large = page.json("/api/config/draft", 403, method="POST", body=b"x" * LARGE, **MARKED)
    assert "Configure on" in large["error"]


def test_a_page_of_somebody_else_edits_nothing(scene):
    _, page = editor(scene)
    assert page.json("/api/info")["configurable"] is True
    for status, headers in ((403, {"Origin": "http://evil.example"}), (403, {"X_Owsd": "2"}),
                            (415, {"Content_Type": "text/plain"})):
        for size in (0, LARGE - 100):
            assert post(page, "config/draft", status, headers=headers, text="x" * size, do="check")


def test_an_edit_keeps_comments_order_and_line_ends(scene):
    _, page = editor(scene)
    text = ("# mine\r\nOwsDrv { # the house\r\n  TargetName \"sim:x\"\r\n  Timeout 7.50\r\n"
            "  # warm\r\n  Item { Name a Path \"/28.000000000001/temperature\" IOType 0x18 }\r\n"
            "  Item { Name \"b\" Path \"/28.000000000002/temperature\" Type double }\r\n}\r\n")
    got = draft(page, text, "check")
    assert got["text"] == text and got["valid"], got
    done = draft(page, text, "set", name="a", keys="Unit=°C\nLimitH=30\nType=float")
    assert done["valid"] and not done["problems"], done
    assert re.sub("  +(?=[\"3])", " ", done["text"]) == text.replace(
        "IOType 0x18", 'IOType 0x0017 Unit "°C" LimitH 30'), done["text"]
    assert [i["name"] for i in done["model"]["items"]] == ["a", "b"]
    for do, more, was, becomes in (
            ("rename", dict(name="b", keys="Name=c"), '"b"', '"c"'),
            ("unset", dict(name="b", keys="Type"), " Type double", ""),
            ("targets", dict(value="sim:x, w1"), '"sim:x"', '"sim:x, w1"'),
            ("replace", dict(old="28.000000000001", new="28.0000000000A1"), "28.000000000001",
             "28.0000000000A1")):
        got = draft(page, text, do, 422 if do == "unset" else 200, **more)
        if do == "unset":
            assert "Type" in got["error"] and got["problems"][0]["item"] == "b", got
        else:
            kept = re.sub(' Identity +"/28.000000000001/temperature"', "", got["text"])
            assert kept == text.replace(was, becomes), (do, got["text"])
            assert (kept != got["text"]) == (do == "replace"), (do, got["text"])
    moved = draft(page, text.replace("Item { Name a", "Item {\r\n Name a"), "move", name="b", other="a", where="before")
    assert [i["name"] for i in moved["model"]["items"]] == ["b", "a"] and "# warm" in moved["text"]
    added = draft(page, text, "add", name="c", path="/28.000000000003/temperature", keys="Unit=°C")
    assert added["model"]["items"][2]["keys"]["Unit"] == "°C", added
    removed = draft(page, added["text"], "remove", name="c")
    assert removed["text"] == text
    bus = draft(page, text, "bus-set", target="sim:x", keys="PowerOffMs=700")
    assert bus["model"]["buses"][0]["keys"] == {"PowerOffMs": "700"}, bus
    assert draft(page, bus["text"], "bus-unset", target="sim:x", keys="PowerOffMs")["model"][
        "buses"][0]["keys"] == {}
    assert draft(page, bus["text"], "bus-remove", target="sim:x")["text"] == text
    new = draft(page, "broken {", "new")
    assert new["valid"] and new["model"]["items"] == [], new


def test_problems_stand_at_their_items_and_keys(scene):
    _, page = editor(scene)
    text = ("OwsDrv {\n  TargetName \"sim:x\"\n  Timeout never\n  Web { Files \"x\" }\n"
            "  Bus {\n    Target \"sim:x\"\n    PowerOffMs 0\n  }\n"
            "  Item {\n    Name \"a\u00e4\" LimitH warm\n    Path \"/28.000000000001/temperature\"\n  }\n}\n")
    got = draft(page, text, "check")
    assert got["valid"] is False and got["text"] == text
    at = {(p["item"], p["block"], p["key"]): (p["line"], p["column"]) for p in got["problems"]}
    assert at == {(None, "OwsDrv", "Timeout"): (3, 11), (None, "Web", "Files"): (4, 15),
                  (None, "Bus:sim:x", "PowerOffMs"): (7, 16), ("a\u00e4", None, "LimitH"): (10, 22),
                  ("a\u00e4", None, None): (9, 3)}, at
    assert all(p["error"] and p["text"] for p in got["problems"])
    # a wrong draft may become less wrong
    better = draft(page, text, "set", name="OwsDrv", keys="Timeout=7")
    assert len(better["problems"]) == 4 and better["model"]["driver"]["Timeout"] == "7"
    # of a text that is no document the page gets what could be read
    broken = draft(page, text.replace('"sim:x"\n  Timeout', '"sim:x"\n  } Timeout'), "check")
    assert broken["valid"] is False and broken["model"]["targets"] == ["sim:x"], broken
    unknown = draft(page, "OwsDrv {\n Item { Name a Path \"/28.000000000001/temperature\" Type double Unitt K }\n}\n",
                    "check")
    assert unknown["valid"] and not unknown["problems"][0]["error"], unknown
    assert unknown["problems"][0]["key"] == "Unitt"


DOUBTFUL = {
    "the kernel's spelling of an id": 'Path "/28-000000000001/temperature"',
    "an id that cannot exist": 'Path "/28.0000000000ZZ/temperature"',
    "a property that the family has not": 'Path "/28.000000000001/temprature"',
    "a command to what cannot be written": 'Path "/28.000000000001/temperature" IO output',
    "a text for a number": 'Path "/28.000000000001/temperature" Type string',
    "a wrong property of an alarm": 'Path "/29.000000000002/PIO.BYTE" Alarm on PorAlarm "por" LatchAlarm "latsch.BYTE"',
    "nothing": 'Path "/28.000000000001/temperature"',
}


def test_the_page_the_writer_and_owsd_check_find_the_same(scene):
    _, page = editor(scene)
    writer = writer_alone(scene, "OwsDrv {\n}\n")
    for what, item in DOUBTFUL.items():
        item = f'Item {{ Name a {item} {"" if "Type" in item else "Type double "}}}'
        text = f'OwsDrv {{\n  TargetName "null:"\n  Bus {{ Target "localhost:4399" }}\n  {item}\n}}\n'
        file = scene.file("doubtful.rio", text)
        done = scene.owsd_once("--check", "-c", file)
        assert done.returncode == 0, (what, done)
        said = [(int(line), int(column or 0), words) for line, column, words in
                re.findall(r"^.*doubtful.rio:(\d+)(?::(\d+))?: warning: (.*)$", done.stderr, re.M)]
        assert (len(said) > 1) == (what != "nothing"), (what, done.stderr)
        shown = [(p["line"], p["column"], p["text"]) for p in draft(page, text, "check")["problems"]]
        shown.sort(key=lambda problem: problem[0])  # as --check prints them
        assert shown == said, (what, shown, said)
        answer = writer.replace(text)
        assert answer.status == "done", (what, answer.text)
        written = sorted(answer.problems, key=lambda problem: int(problem.split()[1]))
        assert written == [f"W {line} {column} {words}" for line, column, words in said], \
            (what, answer.text, said)


def test_an_edit_that_cannot_be_is_refused_with_the_reason(scene):
    daemon, page = editor(scene)
    before = daemon.config.read_text()
    for do, more, words in (
            ("set", dict(name="nobody", keys="Unit=°C"), "nobody"), ("set", dict(name="room"), "keys"),
            ("set", dict(name="room", keys="LimitH=warm"), "LimitH"),
            ("set", dict(name="room", keys="Limmit=1"), "LimitH"),
            ("set", dict(keys="a=b"), "name"), ("add", dict(name="room", path="/x/y"), "already"),
            ("add", dict(name="OwsDrv", path="/x/y"), "OwsDrv"), ("add", dict(name="z", path="//"), "path"),
            ("remove", dict(name="nobody"), "nobody"), ("remove", dict(name="OwsDrv"), "OwsDrv"),
            ("move", dict(name="room", other="relays"), "where"),
            ("replace", dict(old=SENSOR[1:], new="x"), "id"),
            ("replace", dict(old=SENSOR[1:], new="29.000000000001"), "families"),
            ("bus-set", dict(keys="Touch=on"), "target"), ("bus-set", dict(target="w1", keys="Touch=2"), "Touch"),
            ("targets", dict(value="a,,b"), "target"), ("dance", {}, "do"),
            ("set", dict(name="room", keys="Description=a\u0007b"), "control")):
        got = draft(page, before, do, 422, **more)
        assert words in got["error"], (do, got)
    for body in (b"", b"[]", b'{"text": "x"}', b'{"do": "check", "text": "\xff"}', b"{" + b"x" * 9000):
        assert page.json("/api/config/draft", 400, method="POST", body=body, **MARKED)["error"]
    assert daemon.config.read_text() == before


def test_large_texts_are_taken_up_to_a_mebibyte_and_two_at_a_time(scene):
    daemon, page = editor(scene)
    text = daemon.config.read_text()
    filled = text + "#" * ((1 << 20) - len(text.encode()) - 1) + "\n"
    assert draft(page, filled, "check")["text"] == filled
    assert "1 MiB" in draft(page, filled + "x", "check", 413)["error"]
    assert draft(page, filled, "set", 422, name="room", keys="Description=" + "x" * 40)["error"]
    head = ("POST /api/{} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nX-Owsd: 1\r\n"
            "Content-Length: {}\r\n\r\n")
    assert b" 413 " in page.raw(head.format("config/draft", LARGE + 1).encode())
    for path in ("set", "config/restore", "config/draftx", "config%2fdraft"):
        assert b" 413 " in page.raw(head.format(path, 8193).encode()), path
    slow = [page.tcp() for _ in range(2)]
    for s in slow:
        s.sendall(head.format("config/draft", LARGE).encode() + b'{"do": "check", "text": "')
    until(lambda: "try again" in post(page, "config/draft", 503, text=filled, do="check")["error"], 10,
          "both rooms are taken")
    # small ones need no room
    assert draft(page, text, "check")["valid"]
    for s in slow:
        s.close()
    until(lambda: page.ask("/api/config/draft", "POST", json.dumps(dict(text=filled, do="check")),
                           **MARKED)[1] == 200, 10, "the rooms are free again")


def test_what_large_answers_took_is_given_back(scene):
    faulty.not_sanitized("a sanitizer has memory of its own")
    daemon, page = editor(scene)
    text = daemon.config.read_text()
    filled = text + "#" * (1000 << 10) + "\n"

    def own_kib():
        with open(f"/proc/{page.program.pid}/smaps_rollup", encoding="ascii") as file:
            return int(file.read().split("Private_Dirty:")[1].split()[0])

    def work(text):
        draft(page, text, "check")
        draft(page, text, "set", name="room", keys="Description=x")
        for path in ("config", "signals", "log", "stats", "info"):
            page.json(f"/api/{path}")
    work(text)
    before = own_kib()
    for _ in range(8):
        work(filled)
    until(lambda: own_kib() < before + 400, 10, lambda: f"{before} KiB before, {own_kib()} after")


def test_a_file_that_json_would_change_is_shown_and_not_edited(scene):
    daemon, page = editor(scene)
    whole = daemon.config.read_bytes()
    daemon.config.write_bytes(whole + b"# caf\xe9\n")
    got = page.json("/api/config")
    assert got["configurable"] is False and "UTF-8" in got["why"], got
    refused = post(page, "config/save", 409, text=got["text"], base=got["tag"])
    assert refused["error"] == got["why"] and b"caf\xe9" in daemon.config.read_bytes(), refused
    daemon.config.write_bytes(whole + b"#" * (1 << 20))
    assert "1 MiB" in page.json("/api/config", 500)["error"]
    daemon.config.unlink()
    assert "cannot be read" in page.json("/api/config", 500)["error"]


class Fake:
    """A writer that answers each order with the next of its texts."""

    def __init__(self, daemon, *answers):
        self.path, self.orders, self.answers = place() / f"{daemon.name}.config", [], list(answers)
        self.door = socket.socket(socket.AF_UNIX)
        self.door.bind(str(self.path))
        self.door.listen()
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self):
        for answer in self.answers:
            s, _ = self.door.accept()
            if answer is None:  # it dies with the order
                s.recv(1)
                s.close()
                continue
            data, length = b"", None
            while length is None or len(data) < length:
                data += s.recv(1 << 20)
                if length is None and b"\n\n" in data:
                    head, _, _ = data.partition(b"\n\n")
                    fields = dict(line.split(": ", 1) for line in head.decode().split("\n")[1:])
                    length = len(head) + 2 + int(fields.get("length", 0))
            self.orders.append((head.split(b"\n")[0].decode(), fields, data[len(head) + 2:].decode()))
            s.sendall(answer.encode())
            s.close()
        self.door.close()


def test_a_writer_with_a_full_queue_is_reported_as_busy(scene):
    daemon, page = editor(scene)
    got, queue = page.json("/api/config"), []
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(str(place() / f"{daemon.name}.config"))
        door.listen(1)
        try:
            for _ in range(16):
                queue.append(socket.socket(socket.AF_UNIX))
                queue[-1].setblocking(False)
                queue[-1].connect(door.getsockname())
            raise AssertionError("the queue is never full")
        except BlockingIOError:
            pass
        refused = post(page, "config/save", 503, text=got["text"], base=got["tag"])
    assert refused["error"] == "the writer is busy: try again in a minute", refused
    for waits in queue:
        waits.close()


def test_the_writer_is_asked_to_save_and_its_answer_is_passed_on(scene):
    daemon, page = editor(scene)
    got = page.json("/api/config")
    base, new, text = got["tag"], "0123456789abcdef", got["text"] + "# \u00e4\n" + "#" * 600000 + "\n"
    assert "owsd-writer@" in got["writer"], got
    refused = post(page, "config/save", 503, text=text, base=base)
    assert f"systemctl enable --now owsd-writer@{daemon.name}.socket" in refused["error"]
    fake = Fake(daemon,
                f"status: done\ntag: {new}\nreload: done\nbackup: {base} 1764000000123\nlater: x\n\n",
                f"status: done\ntag: {new}\nreload: refused\nwhy: no \u001b target\n\n",
                f"status: conflict\ntag: {new}\nwhy: changed\n\n",
                "status: invalid\nwhy: errors\nproblem: E 10 3 bad \u202e\nproblem: W 0 0 odd\n\n",
                "status: refused\nwhy: no right\n\n", "status: error\nwhy: no room\n\n",
                "nonsense\n\n", "", None)
    (scene.path / (daemon.config.name + ".before")).write_bytes(b"")
    got = page.json("/api/config")
    assert got["writer"] is None and got["backup"]["tag"] == "cbf29ce484222325", got
    done = post(page, "config/save", text=text, base=base)
    assert done == {"tag": new, "reload": "done", "why": None,
                    "backup": {"tag": base, "time": 1764000000123}}, done
    undone = post(page, "config/restore", base=new)
    assert undone == {"tag": new, "reload": "refused", "why": "no ? target", "backup": None}
    assert post(page, "config/save", 409, text=text, base=base) == {"error": "changed", "tag": new}
    assert post(page, "config/save", 422, text=got["text"], base=base) == {
        "error": "errors", "problems": [
            {"error": True, "line": 10, "column": 3, "text": "bad ?", "item": "room", "block": None,
             "key": None},
            {"error": False, "line": 0, "column": 0, "text": "odd", "item": None, "block": None,
             "key": None}]}
    assert post(page, "config/save", 403, text="x", base=base)["error"] == "no right"
    assert post(page, "config/save", 500, text="x", base=base)["error"] == "no room"
    for _ in range(2):
        assert "same version" in post(page, "config/save", 502, text="x", base="")["error"]
    assert "not known whether" in post(page, "config/save", 504, text="x", base="")["error"]
    fake.thread.join(20)
    first, fields, body = fake.orders[0]
    assert first == "owsd-writer 1" and body == text, (first, fields)
    assert fields == {"do": "replace", "base": base, "for": "127.0.0.1",
                      "length": str(len(text.encode()))}, fields
    assert fake.orders[1][1:] == ({"do": "restore", "base": new, "for": "127.0.0.1"}, "")
    fake.path.unlink()


def test_the_page_does_not_choose_the_directory_of_its_files(scene):
    daemon, page = editor(scene)
    got, fake = page.json("/api/config"), Fake(daemon, "status: done\ntag: 0123456789abcdef\n\n")
    for other in ('Files "/etc"', f'Files "{scene.path}"', ""):
        text = re.sub(r'Files "[^"]*"', other, got["text"])
        assert text != got["text"]
        refused = post(page, "config/save", 403, text=text, base=got["tag"])
        assert "Files of the block Web" in refused["error"], refused
        before = pathlib.Path(f"{daemon.config}.before")
        before.write_text(text)
        refused = post(page, "config/restore", 403, base=got["tag"])
        assert "Files of the block Web" in refused["error"], refused
        before.unlink()
    assert fake.orders == []
    assert post(page, "config/save", text=got["text"] + "#\n", base=got["tag"])["reload"] == "none"
    fake.thread.join(20)
    fake.path.unlink()


def test_what_is_no_order_does_not_reach_the_writer(scene):
    daemon, page = editor(scene)
    fake = Fake(daemon, "status: done\ntag: 0123456789abcdef\n\n")
    for members in (dict(text="x"), dict(base=""), dict(text="x", base="x"), dict(text=5, base=""),
                    dict(text="x", base="0123456789abcdef\ndo: restore")):
        assert post(page, "config/save", 400, **members)["error"], members
    assert post(page, "config/save", 413, text="x" * ((1 << 20) + 1), base="")["error"]
    post(page, "config/restore", 400)
    post(page, "config/save", 403, headers={"Origin": "http://evil.example"}, text="", base="")
    assert fake.orders == []
    assert post(page, "config/save", text="x", base="")["tag"] == "0123456789abcdef"
    fake.path.unlink()


def devices(page, query="", status=200):
    return page.json(f"/api/devices{query}", status, X_Owsd="1")


def test_all_devices_are_found_with_their_signals_and_present_values(scene):
    daemon, page = editor(scene)
    until(lambda: page.values()["room"] == 21.5, 20, "the bus is up")
    got = devices(page)
    assert got["whole"], got
    sensor, relay = got["devices"]
    assert (sensor["id"], sensor["path"], sensor["family"], sensor["type"]) == (
        SENSOR[1:], SENSOR, "28", "DS18B20"), sensor
    assert sensor["bus"] == "bus.0" and sensor["simulated"] and sensor["signals"] == ["room"]
    assert sensor["alias"] is None and sensor["identity"]
    assert sensor["properties"] == [
        {"name": "temperature12", "word": "temperature", "type": "double", "output": False,
         "value": "21.5", "why": None}]
    assert relay["signals"] == ["relays"], relay
    outputs = relay["properties"][1]
    assert (outputs["name"], outputs["output"], outputs["value"]) == ("PIO.BYTE", True, "0"), outputs
    again = devices(page, f"?ids={SENSOR[1:].replace('.', '')},28.0000000000FF")["devices"]
    assert again[0]["properties"] == sensor["properties"] and again[0]["signals"] == ["room"]
    gone = again[1]["properties"][0]
    assert gone["value"] is None and gone["why"], gone
    for wrong in ("", "x", "28.00", SENSOR[1:] + ",", ",".join([SENSOR[1:]] * 129)):
        status = 200 if wrong.endswith(",") and wrong else 400
        devices(page, f"?ids={wrong}", status)
    daemon.stop()
    assert "is not running" in devices(page, status=503)["error"]


def test_a_scan_of_a_hundred_devices_takes_seconds(scene):
    chips = f"DS18B20 {SENSOR[1:]} temperature 1\n" + "".join(f"DS18B20 28.0000000001{i:02X} temperature {i % 50}\n" for i in range(100))
    wire = scene.file("hundred.sim", "chip DS2482-100 0x18\n" + chips)
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [ROOM], Timeout=10, Web=raw("{ Configure on }")))
    page = Page(scene, daemon)
    until(lambda: page.json("/api/info")["live"] and page.values()["room"] == 1, 30, "the bus is up")
    # the first one finds out what they all are, too; a busy machine may not list a target in time
    wanted = {f"28.0000000001{i:02X}": str(i % 50) for i in range(100)} | {SENSOR[1:]: "1"}

    def whole():
        _, status, body = page.ask("/api/devices", X_Owsd="1")
        got = json.loads(body)
        if status != 200 or not got["whole"]:
            return None
        read = {d["id"]: (d["properties"][0]["value"], d["properties"][0]["why"]) for d in got["devices"]}
        wrong = {i: r for i, r in read.items() if r[0] not in (None, wanted.get(i))}
        assert set(read) == set(wanted) and not wrong, (sorted(set(wanted) ^ set(read)), wrong)
        # nor read one
        return not any(why for _, why in read.values())
    until(whole, 90, "a scan has read all")


def test_only_who_may_configure_has_the_wires_scanned(scene):
    _, page = both(scene)
    assert "Configure on" in devices(page, status=403)["error"]



def test_a_file_is_begun_and_saved_without_an_owsd(scene):
    file, port = scene.path / "begun.rio", owsdtest.free_port()
    web = scene.start([owsdtest.BUILD / "owsd-web", "--edit", file, "-l", f"127.0.0.1:{port}"])
    page = Page.__new__(Page)
    page.port = port
    socket_of_writer = place() / "begun.config"
    until(lambda: socket_of_writer.exists() and "configuration" in web.log(), 20, web.log)
    got = page.json("/api/config")
    assert got["configurable"] and got["file"] == str(file), got
    assert got["model"]["blocks"]["Web"] == {"Configure": "on"}
    assert "owsd begun is not running: start it" in devices(page, status=503)["error"]
    scene.file("house.sim", "chip DS2482-100 0x18\n")
    simulated = got["text"].replace("localhost:4304", f"sim:{scene.path}/house.sim")
    got = {**got, **post(page, "config/save", text=simulated, base=got["tag"])}
    edited = draft(page, got["text"], "add", name="room", path="/28.FF/temperature")
    saved = post(page, "config/save", text=edited["text"], base=got["tag"])
    assert saved["reload"] == "none" and '"room"' in file.read_text(), saved
    # the file says that nobody configures, and still --edit may
    closed = edited["text"].replace("Configure             on", "Configure off")
    post(page, "config/save", text=closed, base=saved["tag"])
    assert page.json("/api/config")["configurable"]
    web.stop()
    until(lambda: not socket_of_writer.exists(), 20, "the writer ends with owsd-web")
    web = scene.start([owsdtest.BUILD / "owsd-web", "--edit", file, "-l", f"127.0.0.1:{port}"])
    until(socket_of_writer.exists, 20, web.log)
    web.process.kill()
    until(lambda: not socket_of_writer.exists(), 20, "it ends with a killed one, too")
    refused = subprocess.run([owsdtest.BUILD / "owsd-web", "--edit", scene.path / "no" / "x.rio"],
                             capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "No such file" in refused.stderr, refused


if __name__ == "__main__":
    owsdtest.main()
