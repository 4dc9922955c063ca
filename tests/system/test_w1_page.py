#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""docs/w1.md names the files of the kernel's drivers that owsd uses: those of hal/w1, no others."""

import re

import owsdtest
from owsdtest import SOURCE

SOURCES = ["thermometer", "switches", "driver"]
MASTER = {"therm_bulk_read", "w1_master_attempts", "w1_master_search"}
RAW = {"rw"}  # of a slave without a driver
CALLS = [
    r'(?:w1_slave_(?:has|text|number|read|write)|read_digit|put_digit|put)\(\s*slave,[^;]*?\)',
    r'\.file = "\w+"',
    r'\.files = \{[^}]*\}',
    r'DRIVER\(0x\w\w, "\w+"',
    r'static const char \*const (?:files|registers)\[\w*\] = \{[^}]*\}',
    r'w1_exists\(tree, name, "\w+"\)',
    r'master_number\([^;]*?\)',
]


def rows():
    """Family codes, module, files used: of each row of the table."""
    text = (SOURCE / "docs/w1.md").read_text()
    part = text.split("## What there is\n", 1)[1].split("\n## ", 1)[0]
    for line in part.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and len(cells) == 5 and not set(cells[0]) <= set("- "):
            if cells[0] != "family":
                yield [re.findall(r"[\w.]+", cell.replace("`", " ")) for cell in cells[:3]]


def code_of(source):
    return (SOURCE / f"hal/w1/{source}.c").read_text()


def files_of(code):
    """Names of attributes in what reads, writes or looks for them."""
    found = set()
    for call in CALLS:
        for text in re.findall(call, code):
            found |= set(re.findall(r'"([a-z]\w*)"', text))
    return found


def families_of(code):
    return set(re.findall(r"(?:\.family = |DRIVER\(|EEPROM\()0x(\w\w)", code.replace("(code)", "")))


def test_each_family_of_a_driver_has_a_row(scene):
    listed = {family.lower() for families, _, _ in rows() for family in families}
    for source in SOURCES:
        assert families_of(code_of(source)), source
        assert families_of(code_of(source)) <= listed, (source, listed)


def test_what_owsd_uses_of_a_driver_is_what_its_row_says(scene):
    for source in SOURCES:
        code = code_of(source)
        families, files = families_of(code), files_of(code) - MASTER - RAW
        said = set()
        for of, module, used in rows():
            if {family.lower() for family in of} & families:
                assert set(used) <= files, f"{module}: {source}.c does not use {set(used) - files}"
                said |= set(used)
        assert said == files, f"{source}.c uses {files - said}, which docs/w1.md does not say"


def test_a_driver_that_owsd_does_not_use_is_not_in_the_sources(scene):
    known = set().union(*(families_of(code_of(source)) for source in SOURCES))
    for families, module, used in rows():
        if {family.lower() for family in families} & known:
            assert used, module
        elif module != ["none"]:
            assert not used, module


if __name__ == "__main__":
    owsdtest.main()
