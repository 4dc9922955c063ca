# SPDX-License-Identifier: MIT
"""The table of suites: whole, of things that are there, and with every system test in it."""

import configparser
import importlib.machinery
import importlib.util
import pathlib
import re

TABLE = "tests/suites"
KEYS = {"rung", "why", "run", "seconds", "paths", "tests", "needs", "row", "reads"}
CHECK = pathlib.Path(__file__).resolve().parents[1] / "check"


def module():
    loader = importlib.machinery.SourceFileLoader("check", str(CHECK))
    spec = importlib.util.spec_from_loader("check", loader)
    found = importlib.util.module_from_spec(spec)
    loader.exec_module(found)
    return found


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
    names = {check.stem(pathlib.Path(f)): f for f in tree.files
             if re.fullmatch(r"tests/system/test_\w+\.(py|sh)", f)}
    run = set()
    for name, suite in suites.items():
        line = tree.line_of(TABLE, f"[{name}]")
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
