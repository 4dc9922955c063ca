#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes tests/fuzz/seeds: short inputs that lead each target to what it is about. The formats are
described at the top of each fuzz_*.c. Run it again after a change here, and commit what it wrote."""
import pathlib
import struct

HERE = pathlib.Path(__file__).parent


def put(target, name, content):
    if isinstance(content, str):
        content = content.encode()
    folder = HERE / "seeds" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


def rio():
    data = HERE.parent / "unit" / "data"
    driver = 'OwsDrv {\n  TargetName "%s"\n%s}\n'
    item = '  Item {\n    Name "%s"\n    Path "%s"\n%s  }\n'
    shaped = (data / "four_thermometers.rio").read_text()
    edits = ('a new /28.000000000001/temperature Type=float PerFactor=3\ns new Name=newer\n'
             's newer Uncached=on\nu newer InitValue\nr newer\ns OwsDrv Timeout=7 Period=0.2')
    put("rio", "shaped", shaped[:1500] + "\0" + edits)
    put("rio", "small", driver % ("localhost:4304", item % ("t", "/28.1/temperature12",
                                                            "    IOType 0x0018\n")) + "\0" +
        "s t IO=output Type=byte\ns t InitValue=3\nr t")
    put("rio", "targets", driver % ("localhost:4304 | i2c:/dev/i2c-1 | w1, auto, sim:a\\\\b.sim", (
        '  Bus { Target "i2c:/dev/i2c-1" PowerLine "GPIO4" PowerOffMs 500 ActiveLow on }\n'
        '  Listen "4304, 192.168.1.1:4304, [::1]:1" ListenAllow "10.0.0.0/8, fd00::/8"\n'
        '  ListenSocket "/run/owsd/s" ListenReadOnly on AlarmLine "GPIO5" HeartbeatLine "GPIO6"\n')))
    put("rio", "alarm", driver % ("w1", item % ("a b", "/uncached/29.0123456789AB/PIO.0", (
        '    Type bool IO output Readable on Writable on Alarm on LatchAlarm "latch.BYTE"\n'
        '    PorAlarm "por" SetAlarm "set_alarm=133333333" ResetLatch "" SafeValue "off"\n'))))
    put("rio", "limits", driver % ("w1", item % ("t", "/28.000000000001/t", (
        '    Type double LimitLL -10 LimitL 0 LimitH 30.5 LimitHH 40 Hysteresis 0.5 OnDelay 2\n'
        '    OffDelay 0.25 StaleAfter 2.5 PerFactor 7 InitValue "1e3"\n')))
        + "\0s t LimitH=31\nu t LimitHH LimitLL\ns t InitValue=")
    put("rio", "scaled", driver % ("w1", item % ("p", "/20.000000000001/volt.A", (
        '    Type double Points "1:0 3:2.5 5:6" Min -0.15 Max 6.15 Unit "bar" Decimals 2 MaxStep 9 Filter 2.5\n'
        '    Deadband 0.1 Description "a \\"b\\"" Calibrated "2024-02-29"\n')))
        + "\0s p Unit=\u00b0C\nu p Points\ns p Scale=-0.5 Offset=1e3")
    text = driver % ("w1", item % ("l", "/23.1/memory", (
        '    IOType 0x013C InitValue "' + "long " * 11 + '"\n    "and longer" # why\n')))
    put("rio", "large", text.replace("\n", "\r\n") + "\0s l InitValue=" + "x" * 120)
    put("rio", "cr", text.replace("\n", "\r") + "\0s l InitValue=" + "x" * 120 + "\na m /23.2/memory")
    put("rio", "lists", 'OwsDrv { Example [ 0 1 "]" # a\n ] Item { Name "x" Path a/b Type bool } }\0'
        's x Type=word\na y c/d\n')
    put("rio", "backslashes", driver % ("sim:a\\\\", item % ("l", "/23.1/memory", (
        '    Type string IO output InitValue "a\\\\" SafeValue "\\\"\\\\\\\\"\n'))) +
        "\0s l InitValue=\\")
    put("rio", "broken", 'OwsDrv {\n Timeout x\n Item { Name "a b"\nPath "//" Type foo\n}\n Item {\n'
        'Name "q\n}\n}\n{{}} [ ] "')


def owserver():
    connect = b"\0\0"                       # begin, go on
    sent = b"\0"
    all_of_it = b"\xff"                     # room of one receive

    def reply(data=b"", status=0):
        return sent + all_of_it + struct.pack("BbB", 0, status, len(data)) + data

    greeting = connect + reply() + reply(b"Simulated.0") + reply(status=-2) + reply(b"          15")
    ask = struct.pack("BB", 0x20, 0x1b)      # READ, 256 bytes, 20 s
    put("owserver", "read", greeting + ask + reply(b"     21.0625") + b"\0" + ask +
        reply(status=-1) + reply(status=0) + b"\0")
    put("owserver", "dir", greeting + b"\x06\x1c" + reply(b"/28.67C6697351FF,/alias,/bus.0") +
        reply(b"2867C6697351FF68") + b"\1")
    put("owserver", "write", greeting + b"\x11\x1a" + reply(status=0) + b"\0\x11\x1a" +
        reply(status=-22) + b"\0\x13\x1a" + reply())
    put("owserver", "alive", greeting + ask + sent + b"\xff\2\3\2\5\0\0\x04abcd\1")
    put("owserver", "numbers", greeting + ask + sent + b"\xff\3\4abcd" +
        struct.pack("<iIii", 4, 4, 4, 4) + b"\0" + ask + sent + b"\xff\3\4abcd" +
        struct.pack("<iIii", 2**31 - 1, 0, 2**31 - 1, 0))
    put("owserver", "closed", greeting + ask + sent + b"\xff\4" + connect + greeting + ask +
        reply(b"1") + b"\1\xff\xff\0\xfe")
    put("owserver", "tokens", greeting + ask + sent + b"\xff\6\4abcd\2" + b"\xff\1\x20" +
        b"x" * 32)


READ, WRITE, DIR, PRESENT, DIRALL, GET = 2, 3, 4, 6, 7, 8


def serve():
    def ask(kind, path, how=0, data=b"", client=0):
        if isinstance(path, str):
            path = bytes([len(path)]) + path.encode()
            what = 0x80
        else:
            what, path = path, b""
        return bytes([client << 6 | 1, kind, what, how]) + path + bytes([len(data)]) + data

    def answer(text=b"", error=0):
        return bytes([3, error, len(text)]) + text

    def frame(kind, path, size=64, flags=0x104, version=0, offset=0, payload=None):
        path += b"\0"
        return struct.pack(">IiiIii", version, len(path) if payload is None else payload, kind,
                           flags, size, offset) + path

    def raw(data, client=0):
        return bytes([client << 6, len(data)]) + data
    drain, second, turned = b"\7", b"\x15", b"\x27\x3d"
    put("serve", "read", ask(READ, 1) + drain + ask(READ, "/28.551DDF030000/type") +
        answer(b"DS18B20") + drain + ask(READ, "/28.551DDF030000/type") + drain)
    put("serve", "signals", ask(READ, 2) + drain + ask(DIRALL, 7) + drain + ask(DIR, 7) + drain +
        ask(READ, "/signals/room_Age") + drain + ask(PRESENT, "/signals/_TRANSACTIONS") + drain)
    put("serve", "write", ask(WRITE, 14, 0, b"1") + b"\x06\x12" + second + drain +
        ask(WRITE, 10, 0, b"new label") + second + b"\x06\x13" + drain +
        ask(WRITE, "/29.551DDF030000/PIO.1", 0, b"1") + answer() + drain)
    put("serve", "directory", ask(DIRALL, 0) + answer(b"/28.551DDF030000\n/bus.0\n/bus.3\n") +
        answer(b"/28.551DDF030000\n/29.551DDF030000\n/bus.0\n") + drain + ask(DIR, 4) +
        answer(b"/bus.0/28.551DDF030000\n") + drain + ask(9, 12) +
        answer(b"/28.551DDF030000/type\n/28.551DDF030000/errata\n") + drain)
    put("serve", "alias", ask(PRESENT, "/kitchen") + answer() + answer(b"28551DDF030000FF") +
        drain + ask(READ, 9, 0x10, b"") + b"\0\0\1\2" + answer(b"20") + answer(b"28") + drain)
    put("serve", "scales", bytes([1, READ, 0x80, 0x10]) + struct.pack("<I", 0x00010104) + b"\x1c" +
        b"/28.551DDF030000/temperature" + b"\0" + answer(b"     21.0625") + drain)
    put("serve", "lent", ask(READ, 8) + bytes([3, 0x8a]) + drain + ask(READ, 1) + b"\3\0" + drain +
        ask(DIRALL, 13) + bytes([3, 0x8c]) + raw(frame(READ, b"/signals/count")) + b"\3\0" + drain)
    put("serve", "frames", raw(frame(READ, b"/signals/room") + frame(READ, b"/signals/count")[:30]) +
        drain + raw(frame(READ, b"/signals/count")[30:]) + drain +
        raw(frame(1, b"", payload=0)) + drain)
    put("serve", "long", ask(WRITE, 8, 0x20, b"1") + answer() + drain + ask(WRITE, 3, 0xa0, b"1") +
        b"\x25" + drain)
    put("serve", "several", ask(READ, 8) + ask(DIRALL, 0, client=1) + ask(DIRALL, 0, client=2) +
        ask(DIRALL, 0, client=3) + second + answer(b"1") + b"\xd6" + second + b"\x56" + answer() +
        answer() + drain + turned)
    put("serve", "left", ask(READ, 8) + bytes([3, 0x8a]) + b"\x16" + ask(READ, 8) + second +
        b"\3\0" + answer(b"20") + drain)
    put("serve", "codes", ask(READ, 6) + drain + ask(DIR, "/settings/return_codes/") + drain +
        ask(GET, "/settings/return_codes/text.210") + ask(0xb, 0) + drain)


def controller():
    def number(item, value):
        return bytes([item << 4 | 1]) + struct.pack("<qB", value, 0)

    def real(item, value):
        return bytes([item << 4 | 9]) + struct.pack("<bB", value, 1)

    def text(item, value, how=0):
        return bytes([item << 4 | 1, how, len(value)]) + value + b"\0"

    def overlay(off, content):
        return b"\0" + struct.pack("<IB", off, len(content)) + content
    step, second = b"\x16", b"\x26"
    put("controller", "numbers", b"\0" + number(2, 9) + step + number(2, 256) + number(3, 1) + step +
        real(6, 21) + number(6, 0x7ff8 << 48) + number(8, -40000) + second + number(9, 1 << 33) +
        second)
    put("controller", "texts", b"\1" + text(4, b"boiler") + step + text(4, b"", 1) + step +
        text(5, b"a\0b", 3) + second + text(4, b"longer", 1) + second + second)
    put("controller", "flags", b"\0" + b"\x03\x01" + number(1, 5) + b"\x13\x08" + second + b"\x23\x10" +
        b"\x03\x62" + second + b"\xa3\x20" + second)
    put("controller", "beats", b"\0" + b"\x0c\5" + b"\x21" + struct.pack("<qB", 3, 1) + second +
        b"\x0c\5" + second + second + b"\x04\0" + second)
    put("controller", "header", b"\0" + overlay(0, b"\xff" * 64) + step + overlay(240, b"\xff" * 64) +
        second + b"\x07\3why\1\x3c\0\0\0" + second)
    put("controller", "bus", b"\4" + number(2, 7) + b"\x25\1" + second + b"\x25\4" + number(2, 8) +
        second + b"\x0f" + number(3, 1) + b"\x17" + second)
    put("controller", "again", b"\1" + number(2, 7) + text(4, b"x") + step + b"\x0c" + step + b"\x14" + step)


def control():
    def connect(client):
        return bytes([0, client])

    def hello(client, how=1, off=0, content=b""):
        return bytes([how << 3 | 2, client, off, len(content)]) + content

    def welcome(how, header=(0, b""), said=(0, b""), short=0):
        def overlay(off, content):
            return bytes([off, len(content)]) + content
        # each memory has a header of its own
        return bytes([how]) + overlay(*header) * (how >> 1 & 7) + overlay(*said) + bytes([short])
    turn, engine, late, reload = b"\6\0", b"\5\7", b"\x0e\xfa", b"\x0f\0"
    joined = connect(0) + turn + hello(0) + turn + engine + turn
    scribbled = bytes([4 | 8, 0, 2]) + struct.pack("<IB", 256, 8) + b"\xff" * 8 + \
        struct.pack("<IB", 128, 4) + b"\xff" * 4
    put("control", "join", b"\0" + joined + scribbled + engine + b"\3\0" + turn + engine + turn)
    put("control", "protocol", b"\0" + connect(1) + turn + b"\1\1\5hello" + turn + connect(2) + turn +
        hello(2, 1, 4, b"\1\0") + turn + connect(3) + hello(3, 3) + turn + b"\1\3\1x" + turn +
        engine + turn)
    put("control", "late", b"\0" + connect(1) + turn + connect(2) + late * 2 + hello(1) + late + turn)
    put("control", "reload", b"\0" + joined + b"\4\0" + connect(1) + turn + hello(1) + turn + reload +
        b"\4\0" + engine + reload + turn + b"\4\0\3\1" + turn + engine)
    put("control", "token", b"\0" + joined + connect(1) + turn + hello(1, 1, 16, b"\7" * 16) + turn +
        engine + turn + b"\4\1" + b"\x0b\1" + turn)
    put("control", "welcomes", b"\1" + welcome(7) + welcome(3))
    put("control", "unsealed", b"\1" + welcome(6))
    put("control", "sizes", b"\1" + welcome(7, (8, b"\xff\xff")))
    put("control", "offsets", b"\1" + welcome(7, (28, b"\xf8\xff\xff\xff")))
    put("control", "refused", b"\1" + welcome(0, said=(8, struct.pack("<i", -13))))
    put("control", "short", b"\1" + welcome(15, short=255))


def image():
    def number(off, how, later=b"", command=False, header=True):
        return bytes([command << 3 | header << 5]) + struct.pack("<IB", off, how) + later

    reads, looks, sets, reopens = b"\4\0", b"\3\0\0\0\0", b"\5", b"\7"
    put("image", "whole", b"\0\1" + looks + reads + sets + b"\x15" + b"\x95" + reads +
        b"\6\x88\x13\0\0" + reads + reopens + looks)
    put("image", "offsets", b"\7\0" + b"".join(number(64 + 4 * i, 8) for i in range(7)))
    put("image", "counts", b"\3\1" + number(72, 255, b"\1") + number(100, 4) + number(136, 4) +
        looks + reads)
    put("image", "command", b"\2\1" + number(28, 6, command=True) + number(80, 4, command=True) +
        sets)
    put("image", "record", b"\0\1" + b"\x10" + struct.pack("<IB", 1280, 8) + b"\xff" * 8 + reads +
        b"\x10" + struct.pack("<IB", 1280 + 8, 4) + b"\x09\0\xff\xff" + reads)
    put("image", "alarm", b"\0\1" + b"\0" + struct.pack("<IB", 0x25000004, 8) + looks)
    put("image", "short", b"\0\2" + struct.pack("<I", 3000) + reads)


def w1():
    """attributes and properties by their numbers, as fuzz_w1.c counts them"""
    def crc8(data):
        crc = 0
        for byte in data:
            for _ in range(8):
                crc = crc >> 1 ^ (0x8c if (crc ^ byte) & 1 else 0)
                byte >>= 1
        return crc

    def attribute(which, content, slave=0, fault=0):
        return bytes([slave << 3, which, fault, len(content)]) + content

    def everything(slave=0, most=60):
        return b"".join(bytes([3 | slave << 3, n, 1 if n % 2 else 2]) for n in range(0, most, 3))

    def pad(raw):
        nine = bytes([raw & 255, raw >> 8 & 255, 0x4b, 0x46, 0x7f, 0xff, 0x0c, 0x10])
        nine += bytes([crc8(nine)])
        text = "".join(f"{byte:02x} " for byte in nine)
        return f"{text}: crc={nine[8]:02x} YES\n{text}t=21500\n".encode()
    head = b"\x10\0"                        # DS18B20 and DS18S20, no more names
    lists, alarm, convert = b"\3\0\x60", b"\3\1\x60", b"\3\2\xa0\0011"
    put("w1", "thermometers", head + attribute(0, pad(0x158)) + attribute(0, pad(0x32), 1) +
        attribute(2, b"12\n") + attribute(3, b"10 70\n") + attribute(4, b"1\n") + lists +
        everything(0) + everything(1) + alarm + convert)
    put("w1", "temperature", head + attribute(1, b"21500\n") + attribute(1, b"-1250\n", 1) +
        attribute(3, b"-10 20\n", 1) + everything(0) + everything(1) + alarm)
    put("w1", "switches", b"\x65\0" + b"".join(
        attribute(n, b"\xa5") for n in (7, 8, 9, 10, 11, 12)) + attribute(7, b"\x5a", 1) +
        attribute(8, b"\1", 1) + everything(0) + everything(1) + alarm + b"\3\5\x82\00242")
    put("w1", "memories", b"\xdc\0" + attribute(0x45, b"text") + attribute(0x45, b"\0\1", 1) +
        everything(0, 20) + everything(1, 20) + b"\3\1\x80\005abcde")
    put("w1", "counter", b"\xaa\0" + attribute(0, b"00 " * 32 + b": crc=NO c=1\n" * 4) +
        everything(0, 30))
    put("w1", "battery", b"\x99\0" + attribute(13, b"\x08\x80\x15\x32\x01\x12\0\0") +
        attribute(14, b"\1\2\3\4\5\6\7\x08") + attribute(15, b"512\n") + attribute(16, b"-7\n") +
        everything(0, 40))
    put("w1", "others", b"\x7b\0" + attribute(8, b"x") + attribute(7, b"1", 1) +
        attribute(8, b"0", 1) + everything(0, 30) + everything(1, 30) + b"\6\x11"
        b"05-00000000000z\0a\0\0\x27\x2f\x37\1" + lists)
    put("w1", "faults", head + bytes([0, 0x80, 1, 0]) + everything(0, 12) + bytes([0, 0x81, 2, 0]) +
        bytes([0, 0xc5, 3, 2]) + b"ab" + everything(0, 12) + b"\7\0" + lists)


def netlink():
    def reply(kind, data=b"", status=None, more=b""):
        head = bytes([kind | (0x40 if status is not None else 0)])
        return head + (bytes([status]) if status is not None else b"") + bytes([len(data)]) + data + \
            more
    data, status_of_all, masters = 0x0d, 0x35, 0x05
    two = reply(masters, struct.pack("<II", 1, 2)) + reply(masters)
    thermometer = bytes.fromhex("28a1000000000000")[:7]
    crc = 0
    for byte in thermometer:
        for _ in range(8):
            crc = crc >> 1 ^ (0x8c if (crc ^ byte) & 1 else 0)
            byte >>= 1
    found = reply(data, thermometer + bytes([crc])) + reply(status_of_all)
    touch = reply(0x15) + reply(status_of_all)
    put("netlink", "search", b"\6\0" + two + b"\0" + found * 2 + b"\x0e" + found * 3)
    put("netlink", "read", b"\6\0" + two + b"\0" + found + b"\0" + touch * 8 + b"\x10" + touch * 8)
    put("netlink", "nobody", b"\6\0" + two + b"\0" + found + b"\0" + reply(0x35, status=255) * 6)
    put("netlink", "damaged", b"\6\0" + two + b"\0" + reply(2, b"\1\2", more=b"\x10\x80\4\7") +
        reply(3, thermometer, more=b"\5") + reply(1, b"\0" * 40) + reply(4, b"\1", more=b"\x35\1\1"))
    every = reply(0x0e, thermometer + bytes([crc]))
    put("netlink", "answers", b"\6\0" + two + b"\0" + found + b"\0" + (reply(0x0e) * 12 + b"\x10") * 3 +
        b"\x0e" + every * 6)
    put("netlink", "lengths", b"\6\0" + two + b"\0" + found + b"\0" + b"\x4e\0\x12" + b"\0" +
        b"\x4e\0\x41" + b"\0" + b"\x4e\0\x10")
    put("netlink", "refused", b"\6\xff\6\0" + two)
    put("netlink", "gone", b"\6\0" + two + b"\7" + b"\0" + found + b"\x0f\x0e" + found)


def scenario():
    chip = "chip DS2482-100 0x18\n"
    put("scenario", "thermometer", chip + "DS18B20 28.000000000001 as kitchen temperature sine 20 5 1h "
        "resolution 10 parasite\nDS18S20 10.000000000002 temperature ramp 20 30 10s\n"
        "at 1s unplug kitchen for 500ms\n\0set kitchen temperature 30\nbrownout kitchen\n"
        "corrupt kitchen each 2")
    put("scenario", "chips", "i2c speed 400 messages 2 combine one-read\nchip DS2482-800 0x18 times 105\n"
        "channel 7\nDS2408 29.000000000001 as board\nchip DS2484 0x1f\nDS2401 01.000000000001\n"
        "at 100ms short 0x18.7 for 50ms\nat 200ms stick 0x1f\nat 1s every 1s reset 0x18\n"
        "\0short 0x18.2 for 5s\nend short 0x18.2\nsleep 0x1f\njam 0x18 for 1s\n")
    put("scenario", "memory", chip + "DS2431 2D.000000000001 memory 0 0011aabb\n"
        "DS2438 26.000000000001 temperature steps 0:5 5s:6 vad 5 vdd 4.9\n"
        "DS2423 1D.000000000001 pin.A square 0 1 2s count.B 7\nDS2450 20.000000000001 volt.C 3\n"
        "DS2430A 14.000000000001 # why\n")
    put("scenario", "refusals", chip + "DS2413 3A.000000000001 as s\nDS2406 12.000000000001\n"
        "DS2405 05.000000000001\nat 0s refuse 0x18 each 3\nat 10ms every 2us corrupt s chance 0.5 seed 7\n"
        "at 1s remove adapter for 1s\nat 50ms refuse-data 0x18 for 1ms\n\0sleep 0x18\n")
    put("scenario", "buttons", chip + "DS18B20 28.000000000001 as t\nbutton a unplug t\n"
        "button b short 0x18\nbutton c-1 corrupt t each 2\nat 1s every 2s short 0x18 for 1s\n"
        "\0end short 0x18\nplug t\n")
    demo = (HERE.parent.parent / "board" / "demo" / "house.sim").read_text()
    put("scenario", "house", demo[:3000].rpartition("\n")[0] + "\n")
    put("scenario", "full", chip + "DS2430A 14.000000000001 memory 31 aabb\n")
    put("scenario", "wrong", chip + "DS18B20 28.000000000001 temperature 500\n")


def owsctl():
    def call(name, line, behind=b""):
        put("owsctl", name, "\n".join(line.split(" ")).encode() + b"\n\n" + behind)
    call("list", "--json list -a room*")
    call("get", "--json get room OWS__label relay_Age _TRANSACTIONS nobody rom")
    call("set", "set -w 2 relay on level 300 label x")
    call("set-for-long", "--json set -w 17 warm_WOS 1 relay_WriteEnable 0")
    call("set-json", "--json set -w 1 level 7 warm_WOS 1 relay_WriteEnable 0")
    call("watch", "--json watch -c 9 -t 5 *")
    call("watch-text", "watch -l room label")
    call("wait", "wait -t 3 room >= 22.5")
    call("wait-ever", "wait label = other --json")
    call("alarms", "--json alarms")
    call("history", "alarms history -t 1d -c 5 room")
    call("ack", "alarms ack room -a")
    call("stats", "--json stats")
    rio = (b'OwsDrv {\n TargetName "w1"\n Item {\n  Name "t"\n  Path "/28.1/t"\n'
           b'  IOType 0x0018\n }\n}\n')
    call("config-list", "--json config f.rio list", rio)
    call("config-add", "config f.rio add new /28.2/t Type=float LimitH=30", rio)
    call("config-set", "config f.rio set t Name=u InitValue=3 Uncached=on", rio)
    call("config-unset", "config f.rio unset t IOType", rio)
    listing = b"\xf0\x06/x/y\n\n" + b"\x10\0" + b"\4\0"
    call("dir", "dir -t fuzz: /28.A10000000000", b"\x10\x1a/28.A10000000000/alias\n/a/\n")
    call("dir-json", "--json dir -t fuzz:", b"\xf0\0")
    call("read", "--json read -t fuzz: /28.A10000000000/t uncached/x", b"\0\x0c        21.5\0\4\x1b[2J")
    call("write", "write -t fuzz: -w 1 /29.B1/PIO.0 1", b"\0")
    call("scan", "--json scan -t fuzz:", listing + b"\0\7DS18B20\0\7kitchen\0\4 1.5" * 8)
    call("scan-rio", "scan -t fuzz: --rio", listing + b"\0\7DS18B20\0\7kitchen\0\4 1.5" * 8)
    call("help", "watch -h")
    call("wrong", "-x --js get -- -a")
    put("owsctl", "none", b"")


def values():
    texts = ["0", "-32769", "4294967295", "-9223372036854775808", "1e-320", "0.1", "  21.0625", "on",
             "340282356779733661637539395458142568448", "room1_Age", "OWS__room1_WriteEnable",
             "_TRANSACTIONS", "28.551DDF030000", "2867C6697351FF68", "10.67C6697351FF.B8",
             "/uncached/bus.12/28.551DDF030000/errata/die", "/1F.010203040506/main/alias/HIH4000/t",
             "[::1]:4304", "localhost", "fd00::/8", "192.168.1.0/24", "::ffff:1.2.3.4:1",
             "4:0 20:100", "0.46:90 0.85:70 1.55:50 2.5:30", "-1e-320:1e308 0:1e-300 1e308:-1"]
    for i, text in enumerate(texts):
        put("values", f"{i:02}", bytes([i % 11]) + text.encode())


def modbus():
    def asks(*pdus, options=b"\0"):
        return options + b"".join(struct.pack(">HHHB", i, 0, 1 + len(p), 9) + p for i, p in enumerate(pdus))
    read = [struct.pack(">BHH", *row) for row in ((3, 0, 125), (4, 46002, 60), (1, 1, 2), (2, 10001, 30))]
    put("modbus", "read", asks(*read))
    put("modbus", "little", asks(*read, options=b"\3"))
    put("modbus", "unit", asks(*read, options=b"\x24"))
    put("modbus", "write", asks(struct.pack(">BHH", 6, 24, 7), struct.pack(">BHH", 5, 2, 0xFF00), struct.pack(">BHH", 6, 12, 1),
                                struct.pack(">BHHBff", 16, 46002, 4, 8, 21.5, -3), struct.pack(">BHHBB", 15, 1, 3, 1, 5)))
    put("modbus", "half", asks(read[0])[:-2])
    put("modbus", "other", asks(b"\x2b\x0e\1\0", b"\x10\0\x10\0\4\x08" + b"\x7f" * 8) + b"GET / HTTP/1.0")


def writer():
    head, tag = b"owsd-writer 1\n", b"base: 9f3a00c417d2e5b1\n"
    put("writer", "replace", head + b"do: replace\n" + tag + b"for: anna\nlength: 11\n\nOwsDrv {\n}\n")
    put("writer", "first", head + b"do:replace\nbase:\nlength:0\n\n")
    put("writer", "restore", head + tag + b"do: restore\n\n")
    put("writer", "rename", head + b"do: rename\nlength: 9\n\nroom\nhall")
    put("writer", "half", head + b"do: replace\n" + tag)
    put("writer", "long", head + b"for: " + b"x" * 1100)
    put("writer", "bytes", head + b"for: \xc5\xbdan\xff\x00\n" + tag + b"do: restore\n\n")


def web():
    head = b"\0GET /api/events HTTP/1.1\r\nHost: localhost:8080\r\nLast-Event-ID: 1:2\r\n"
    put("web", "get", head + b"\r\n")
    put("web", "folded", head + b"X: a\r\n b\r\n\r\n")
    post = b"\0POST /api/set HTTP/1.1\r\nHost: a\r\nX-Owsd: 1\r\nContent-Type: application/json\r\n"
    put("web", "post", post + b"Content-Length: 2\r\n\r\n{}")
    put("web", "twice", post + b"Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}")
    put("web", "chunked", post + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n")
    put("web", "set", b'\1{"name":"pump","value":true}')
    put("web", "alarm", b'\1 { "name" : "r\\u00e4\\ud83d\\ude00\\n", "do":"shelve", "seconds":-1.5e+3, "x":null}')
    put("web", "same", b"\2localhost:8080\nhttp://localhost:8080\n")
    put("web", "mdns", b"\2pi.local\nhttps://pi.local\n")
    put("web", "six", b"\2[::1]:80\nhttp://[::1]:80\n")


def sparkplug():
    def field(number, value):
        """A number, or bytes with their length, as protobuf has them."""
        def varint(n):
            return bytes([n]) if n < 0x80 else bytes([n & 0x7f | 0x80]) + varint(n >> 7)
        if isinstance(value, int):
            return varint(number << 3) + varint(value)
        return varint(number << 3 | 2) + varint(len(value)) + value

    def metric(name, datatype, *value):
        return field(2, (field(1, name) if isinstance(name, bytes) else field(2, name)) + field(4, datatype) + b"".join(value))
    node, chip, nobody, host = b"\0", b"\1", b"\2", b"\3"
    head = field(1, 1700000000000)
    put("sparkplug", "rebirth", node + head + metric(b"Node Control/Rebirth", 11, field(14, 1)))
    put("sparkplug", "types", node + head + metric(b"count", 4, field(11, 2**64 - 7)) + metric(b"label", 12, field(15, b"x\xff")) +
        metric(b"room", 10, b"\x69" + struct.pack("<d", 21.5)) + metric(b"warm", 9, b"\x65" + struct.pack("<f", float("nan"))))
    put("sparkplug", "device", chip + metric(b"relay", 11, field(14, 1)) + metric(b"level", 5, field(10, 300)))
    put("sparkplug", "alias", chip + metric(2**20 + 2, 11, field(14, 0)) + metric(2**20 + 5, 5, field(10, 7)))
    put("sparkplug", "aliases", node + metric(2**20 + 1, 10, b"\x69" + struct.pack("<d", 1e300)) + metric(2**64 - 1, 3, field(10, 1)))
    put("sparkplug", "null", chip + metric(b"relay", 11, field(7, 1)) + metric(b"room", 10, field(7, 1)))
    put("sparkplug", "nobody", nobody + metric(b"relay", 11, field(14, 1)))
    put("sparkplug", "many", node + b"\x12\0" * 101)
    put("sparkplug", "hundred", node + b"\x12\0" * 100)
    put("sparkplug", "more", node + metric(b"room", 10, field(9, field(1, b"Quality") + field(2, field(1, 3) + field(3, 192))),
                                          field(99, b"?")))
    put("sparkplug", "half", node + metric(b"room", 10)[:-3])
    put("sparkplug", "online", host + b'{"online":true,"timestamp":1700000000000}')
    put("sparkplug", "offline", host + b' { "timestamp" : 999 , "online" : false } ')
    put("sparkplug", "words", host + b'{"online":"true","timestamp":-1}\0{"online":true,"timestamp":5}')


def trace():
    for file in sorted((HERE.parent / "traces").glob("*.trace")):
        lines = file.read_text().splitlines(keepends=True)[1:120]
        put("trace", file.stem, "".join(lines))
    put("trace", "hostile", "0 1 0: link > \" strong splits slot path search verify driver\"\n> > 1\n"
        "nan nan 0: slot 1 > =9999999999\n0 1e99 0: run r - 9 > 12\n0 0 7: link > 9 \" path\"\n"
        "0 0 0: search all 00 > 28.000000000001AE\n0 0 0: has 28.000000000001AE > =1\n"
        "0 0 0: path r F0 > 28.000000000001AE29.00\n"
        "0 0 i2c: adapter > =-1\n0 0 net: sent 00 > \"0 !EIO\n#\n")


if __name__ == "__main__":
    for target in (rio, owserver, serve, controller, control, image, w1, netlink, scenario, owsctl,
                   values, web, writer, sparkplug, modbus, trace):
        target()
