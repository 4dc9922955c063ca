#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The structured text for CODESYS that reads the image: its structures are those of ows_layout.h, and
translated into Python, with the functions of SysFile, it has the values of a real owsd."""

import ctypes
import os
import re
import subprocess
import time

import owsdtest
from owsdtest import SOURCE, raw, until

SENSOR = "28.A0B1C2000001"
SIZES = {"BYTE": ctypes.c_uint8, "BOOL": ctypes.c_bool, "UINT": ctypes.c_uint16, "UDINT": ctypes.c_uint32,
         "DWORD": ctypes.c_uint32, "DINT": ctypes.c_int32, "LINT": ctypes.c_int64, "LREAL": ctypes.c_double,
         "TIME": ctypes.c_uint32, "RTS_IEC_HANDLE": ctypes.c_int64, "RTS_IEC_RESULT": ctypes.c_uint32}
HEADER = {"OwsHeader": "ows_image_header", "OwsArea": "ows_area_entry", "OwsInfo": "ows_info_entry",
          "OwsSample": "ows_sample", "OwsSlot": "ows_slot", "OwsRecord": "ows_record"}
RENAMED = {("OwsRecord", "kind"): "type", ("OwsSample", "length"): "len"}  # which mean something in structured text


def source():
    return (SOURCE / "docs/examples/codesys/owsd_number.st").read_text()


def variables(text, types):
    """[(name, type)] of lines of declarations; pointers are left to Python."""
    found = []
    for names, kind in re.findall(r"^ +([\w, ]+?) : (.+);$", text, re.M):
        array = re.fullmatch(r"ARRAY \[0\.\.(\d+)\] OF (\w+)", kind)
        length = re.fullmatch(r"STRING\((\d+)\)", kind)
        if kind.startswith("POINTER"):
            continue
        if array:
            kind = types[array[2]] * (int(array[1]) + 1)
        elif length:
            kind = ctypes.c_char * (int(length[1]) + 1)
        else:
            kind = types[kind]
        found += [(name.strip(), kind) for name in names.split(",")]
    return found


def structures(text):
    types = dict(SIZES)
    for name, body in re.findall(r"\{attribute 'pack_mode' := '1'\}\nTYPE (\w+) : STRUCT\n(.*?)END_STRUCT\nEND_TYPE\n", text, re.S):
        types[name] = type(name, (ctypes.Structure,), {"_pack_": 1, "_fields_": variables(body, types)})
    return types


def test_the_structures_are_those_of_the_layout(scene):
    types = structures(source())
    asserts = []
    for name, of in HEADER.items():
        for field, kind in types[name]._fields_:
            at = f"struct {of}, {RENAMED.get((name, field), field)}"
            asserts += [f"offsetof({at}) == {getattr(types[name], field).offset}",
                        f"sizeof((({at.replace(', ', ' *)0)->')}) == {ctypes.sizeof(kind)}"]
    # what is an array has the size of its entries
    asserts += [f"sizeof(struct {HEADER[name]}) == {ctypes.sizeof(types[name])}" for name in ("OwsArea", "OwsSample", "OwsSlot")]
    numbers = dict(kind.split(" ") for kind in ("OWS_IMAGE_MAGIC 0x4953574Fu", "OWS_LAYOUT_MAJOR 2", "OWS_STATE_LIVE 1",
                                                "OWS_AREA_RECORDS 1", "OWS_AREA_INFOS 2"))
    asserts += [f"{name} == {number}" for name, number in numbers.items()]
    program = scene.file("check.c", '#include <stddef.h>\n#include "src/public/ows.h"\n#include "src/public/ows_layout.h"\n' + "".join(
        f'_Static_assert({one}, "{one}");\n' for one in [*asserts, "OWS_FLOAT == 7", "OWS_DOUBLE == 8"]))
    done = subprocess.run(["cc", "-std=c17", "-fsyntax-only", "-I", SOURCE, program], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


WORDS = (("AND", "and"), ("OR", "or"), ("XOR", "^"), ("MOD", "%"), ("TRUE", "True"), ("FALSE", "False"))


def expression(text, names):
    """names: the variables of the block, members of v."""
    parts = re.split(r"('[^']*')", text)
    for i in range(0, len(parts), 2):
        part = re.sub(r"\b(ADR|SIZEOF)\((\w+)\)", r'\1("\2")', parts[i])
        part = re.sub(r"T#(\d+)S", r"\g<1>000", part.replace("16#", "0x").replace("^", ""))
        part = re.sub(r"(?<![:<>])=", "==", part).replace("<>", "!=").replace(" / ", " // ")
        for word, python in WORDS:
            part = re.sub(rf"\b{word}\b", python, part)
        parts[i] = re.sub(r"(?<![\w.\"])([A-Za-z]\w*)(?![\w(\"])", lambda m: f"v.{m[1]}" if m[1] in names else m[1], part)
    return "".join(parts)


def translated(name, body, names, arguments=""):
    """A function of Python, of statements."""
    lines, depth = [f"def {name}({arguments}):"], 1
    for statement in re.sub(r"\n +(AND|OR) ", r" \1 ", body).split("\n"):
        statement = statement.strip().rstrip(";")
        word, _, rest = statement.partition(" ")
        loop = re.fullmatch(r"FOR (\w+) := (.*) TO (.*) DO", statement)
        to, assigns, what = statement.partition(" := ")
        if word in ("END_IF", "END_FOR", "ELSIF"):
            depth -= 1
        if word in ("END_IF", "END_FOR", ""):
            continue
        if word in ("IF", "ELSIF"):
            line = f"{word.lower().replace('s', '')} {expression(rest.removesuffix(' THEN'), names)}:"
        elif loop:
            line = f"for v.{loop[1]} in range({expression(loop[2], names)}, {expression(loop[3], names)} + 1):"
        elif assigns:
            line = f"{'return' if to == name else expression(to, names) + ' ='} {expression(what, names)}"
        else:
            line = "return" if word == "RETURN" else expression(statement, names)
        lines.append("    " * depth + line)
        depth += word in ("IF", "ELSIF", "FOR")
    return "\n".join(lines) + "\n"


class Plc:
    """The block, with the functions of SysFile for the image at a path."""

    def __init__(self, path, name):
        text = source()
        head, rest = text[text.index("FUNCTION_BLOCK"):].split("\nEND_FUNCTION_BLOCK\n", 1)
        declared, body = head.rsplit("END_VAR\n", 1)
        self.v = type("Block", (ctypes.Structure,), {"_fields_": variables(declared, structures(text))})(name=name.encode())
        names = {field for field, _ in self.v._fields_}
        program = translated("cycle", body, names)
        for method, inputs, body in re.findall(r"METHOD (\w+)[^\n]*\n(?:VAR_INPUT\n(.*?)END_VAR\n)?(.*?)END_METHOD\n", rest, re.S):
            program += translated(method, body, names, ", ".join(re.findall(r"(\w+) :", inputs)))
        functions = {"v": self.v, "ADR": self.address, "SIZEOF": lambda of: getattr(type(self.v), of).size, "LEN": len, "MAX": max,
                     "SHR": lambda of, n: of >> n, "TIME": lambda: int(1000 * time.monotonic()), "LINT_TO_TIME": int,
                     "AM_READ": 0, "RTS_INVALID_HANDLE": -1, "SysFileOpen": self.open, "SysFileClose": os.close,
                     "SysFileSetPos": lambda file, at: os.lseek(file, at, 0) - at, "SysFileRead": self.read}
        exec(program, functions)  # pylint: disable=exec-used
        self.path, self.run = path, functions["cycle"]

    def address(self, of):
        where = ctypes.addressof(self.v) + getattr(type(self.v), of).offset
        return (ctypes.c_uint32 * (getattr(type(self.v), of).size // 4)).from_address(where)

    def open(self, name, how, _):
        assert (name, how) == ("/run/owsd/OWS.image", 0), name
        try:
            return os.open(self.path, os.O_RDONLY)
        except FileNotFoundError:
            return -1

    @staticmethod
    def read(file, to, size, _):
        data = os.read(file, size)
        ctypes.memmove(to, data, len(data))
        return len(data)

    def cycle(self):
        self.run()
        return self.v.value if self.v.good else None


def config(scene, items):
    wire = scene.file("house.sim", f"chip DS2482-100 0x18\nDS18B20 {SENSOR} temperature 21.5\nbutton pull unplug {SENSOR}\n")
    rooms = [dict(Name=name, Path=path, Type=raw(kind), IO=raw(io)) for name, path, kind, io in items]
    return owsdtest.rio(f"sim:{wire}", rooms, Period=0.05, Timeout=1)


KIND, ROOM = ("kind", f"/{SENSOR}/type", "string", "input"), ("room1", f"/{SENSOR}/temperature", "double", "input")
ROOM2, PULL = ("room1_2", f"/{SENSOR}/temperature9", "float", "input"), ("pull", "/simulator/pull", "bool", "output")


def test_the_block_has_the_value_while_it_is_good_and_over_a_reload_and_a_new_start(scene):
    daemon = scene.owsd(config(scene, [KIND, ROOM2, ROOM, PULL]))
    plc, other = (Plc(owsdtest.segment(daemon.name, "image"), name) for name in ("room1", "pull"))
    until(lambda: scene.get(daemon, "room1") == "21.5", 20)
    # one look does not show whether owsd lives
    assert plc.cycle() is None
    until(lambda: plc.cycle() == 21.5, 20, "it is read")
    scene.owsctl(daemon, "set", "pull", "1")
    until(lambda: plc.cycle() is None, 20, "the sensor is not there")
    scene.owsctl(daemon, "set", "pull", "0")
    until(lambda: plc.cycle() == 21.5, 20, "it is there again")
    # the signal is another record of another image
    daemon.config.write_text(config(scene, [ROOM, PULL]))
    assert scene.owsctl(daemon, "reload").returncode == 0
    until(lambda: plc.cycle() == 21.5 and plc.v.place == 1, 20, "it is found again")
    assert other.cycle() is None and other.v.place == 2, "no float"
    daemon.kill()
    begun = time.monotonic()
    until(lambda: plc.cycle() is None, 20, "owsd is dead")
    assert time.monotonic() - begun < 3
    assert Plc(plc.path, "room1").cycle() is None
    daemon = scene.owsd(daemon.config, name=daemon.name)
    until(lambda: plc.cycle() == 21.5, 20, "owsd is back")
    assert daemon.stop() == 0
    assert plc.cycle() is None


if __name__ == "__main__":
    owsdtest.main()
