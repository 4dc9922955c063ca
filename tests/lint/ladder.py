# SPDX-License-Identifier: MIT
"""The table of suites: whole, of things that are there, with every system test and every room."""

import configparser
import importlib.machinery
import importlib.util
import pathlib
import re

import graph
import rooms
from tree import Skip

TABLE = "tests/suites"
# In percent of the lines of a room: files of which no unit test names a function. Lower what has fallen
BARE = {"src/faces/mqtt": 30, "src/history/recorder": 30, "src/faces/web": 67, "src/faces/writer": 59, "src/faces/influx": 51, "src/history/file": 48,
        "src/faces/kit": 5, "src/config/read": 41, "src/memory/control": 32, "src/memory/shm": 28, "src/daemon/serve": 23, "src/memory/libows": 20}
KEYS = {"rung", "why", "run", "seconds", "paths", "tests", "needs", "row", "reads"}
CHECK = pathlib.Path(__file__).resolve().parents[1] / "check"


def module():
    loader = importlib.machinery.SourceFileLoader("check", str(CHECK))
    spec = importlib.util.spec_from_loader("check", loader)
    found = importlib.util.module_from_spec(spec)
    loader.exec_module(found)
    return found


def shares(tree):
    """room -> (percent of its lines, the largest file) of files of which no unit test names a function.
    A name that tests of the same kind define themselves says nothing: it is a stand-in, or another's."""
    found = rooms.graph_of(tree)
    named = set()
    for folder in ("tests/unit/", "tests/fuzz/", "tests/endurance/"):
        code = [graph.NOT_CODE.sub(" ", tree.text(f)) for f in tree.ending(".c", ".h") if f.startswith(folder)]
        own = {name for text in code for kind in (graph.FUNCTION, graph.DATA) for name in kind.findall(text)}
        named |= {name for text in code for name in graph.NAME.findall(text)} - own
    held = {found.defined[name] for name in named & set(found.defined)}
    lines = {f: tree.text(f).count("\n") for f in found.files if f.endswith(".c")}
    for room in sorted({graph.room_of(f) for f in lines}):
        of_room = [f for f in lines if graph.room_of(f) == room]
        bare = sorted((f for f in of_room if f not in held), key=lambda f: lines[f])
        if bare:
            yield room, 100 * sum(lines[f] for f in bare) // sum(lines[f] for f in of_room), bare[-1]


def check_no_room_leaves_more_to_system_tests_than_it_does(tree):
    for room, share, file in shares(tree):
        if share > BARE.get(room, 100):
            yield file, 1, f"no unit test names a function of it, nor of {share} % of the lines of {room}, " \
                f"and at most {BARE[room]} % may be so; write a unit test"


def check_make_help_has_each_target_that_pages_name(tree):
    """The head of the Makefile is what it prints."""
    if "Makefile" not in tree.files:
        raise Skip("no Makefile")
    head, rest = tree.text("Makefile").split("\nVERSION", 1)
    helped = set(" ".join(re.findall(r"make ((?:[a-z][\w-]*(?: (?=\S))?)+)", head)).split())
    rules = rest + "".join(tree.text(f) for f in tree.ending(".mk"))
    phony = set(" ".join(re.findall(r"^\.PHONY: ((?:.*\\\n)*.*)", rules, re.M)).replace("\\", "").split())
    for name in re.findall(r"^#   make ([a-z][\w-]*)", head, re.M):
        if name not in phony:
            yield "Makefile", tree.line_of("Makefile", f"#   make {name}"), f"{name} is no phony target; take it out"
    for file in tree.ending(".md"):
        for name in re.findall(r"(?:^|`|sudo )make(?: -s)? ([a-z][\w-]*)", tree.text(file), re.M):
            if name in phony and name not in helped:
                yield file, tree.line_of(file, f"make {name}"), f"make help has no {name}; say in the Makefile's head what it does"


def rooms_without(suites, check, tree):
    """Rooms whose change asks for no suite: make touched would name none. Of src it has to be one of
    system tests; a pattern of all of them is the same code made otherwise, by a sanitizer."""
    asked = [s for s in suites.values() if s.get("rung") == "check"]
    for room in sorted({graph.room_of(f) for f in tree.ending(".c", ".h") if f.startswith(("src/", "hal/"))}):
        those = [s for s in asked if not room.startswith("src/") or s.get("tests", "*")[0] != "*"]
        if not any(check.is_under(room, p) for s in those for p in s.get("paths", "").split()):
            yield TABLE, 1, f"a change of {room} asks for no suite" + \
                (" of system tests" if room.startswith("src/") else "") + "; name it in the paths of one"


def check_the_table_of_suites_is_whole(tree):
    if TABLE not in tree.files:
        return
    check = module()
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string(tree.text(TABLE))
    except configparser.Error as error:
        yield TABLE, getattr(error, "lineno", 1), f"{str(error).splitlines()[0]}; mend the table"
        return
    suites = {name: dict(parser[name]) for name in parser.sections()}
    yield from rooms_without(suites, check, tree)
    names = {check.stem(pathlib.Path(f)): f for f in tree.files
             if re.fullmatch(r"tests/system/test_\w+\.(py|sh)", f)}
    run = set()
    for name, suite in suites.items():
        line = tree.line_of(TABLE, f"[{name}]")
        if name == "none":
            yield TABLE, line, "none is what make touched prints where there is no suite; name it otherwise"
        for key in {"rung", "why", "run", "seconds"} - set(suite):
            yield TABLE, line, f"{name} has no {key}; say it"
        for key in set(suite) - KEYS:
            yield TABLE, line, f"{name} has the unknown key {key}; the head names those there are"
        if suite.get("rung") not in ("gate", "check", "hours"):
            yield TABLE, line, f"{name} stands on no rung; say gate, check or hours"
        if suite.get("rung") == "check" and "paths" not in suite:
            yield TABLE, line, f"{name} has no paths; say which changes ask for it"
        for word in suite.get("tests", "").split():
            if "*" not in word and word != "rest" and word.lstrip("!") not in names:
                yield TABLE, line, f"{name} names the test {word}, which is not there; take it out"
        for path in suite.get("paths", "").split():
            if "*" not in path and not any(check.is_under(f, path) for f in tree.files):
                yield TABLE, line, f"{name} names the path {path}, which is not there; take it out"
        if "tests" in suite and suite.get("rung") in ("gate", "check"):
            run |= set(check.tests_of(suites, name, tree.top / "tests/system"))
    for file in names.values():
        if file.split("/")[-1] not in run:
            yield file, 1, f"no suite runs it; name it in {TABLE}"
