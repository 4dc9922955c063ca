#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The drawn alarm machine is the one that runs."""

import re
import subprocess
import sys
import xml.etree.ElementTree

import owsdtest
from owsdtest import SOURCE

SCRIPT = SOURCE / "docs/alarm-states.py"
PICTURE = SOURCE / "docs/img/alarm-states.svg"
TABLE = SOURCE / "src/daemon/engine/alarm/alarm_fsm.c"


def drawn(scene, change=None):
    """What the script makes of the table, or of a table that was changed: output, error."""
    table = TABLE.read_text()
    changed = change(table) if change else table
    assert change is None or changed != table
    scene.file("alarm_fsm.h", TABLE.with_suffix(".h").read_text())
    done = subprocess.run([sys.executable, SCRIPT, scene.file("alarm_fsm.c", changed)], text=True,
                          capture_output=True, timeout=owsdtest.PATIENCE)
    return done.stdout, done.stderr


def test_the_picture_in_the_page_is_made_of_the_table(scene):
    assert drawn(scene)[0] == PICTURE.read_text(), "run: make diagrams"
    assert "img/alarm-states.svg" in (SOURCE / "docs/alarms.md").read_text()


def test_every_state_of_the_header_is_in_the_picture_with_its_number(scene):
    texts = {"".join(t.itertext()) for t in xml.etree.ElementTree.parse(PICTURE).iter()
             if t.tag.endswith("}text")}
    header = TABLE.with_suffix(".h").read_text()
    names = re.findall(r"^\tX\((\w+)\)", header, re.M)
    assert len(names) == 20
    for number, name in enumerate(names, -1):
        assert f"{number} {name}" in texts


def test_a_row_that_goes_another_way_cannot_be_drawn_unseen(scene):
    out, error = drawn(scene, lambda t: t.replace("FACT_FAILED, 0, ALARM_BYPASS",
                                                  "FACT_FAILED, 0, INIT"))
    assert not out
    assert "ALARM_DIR to INIT: in the table, not drawn" in error
    assert "ALARM_DIR to ALARM_BYPASS: drawn, not in the table" in error


def test_a_row_that_the_script_cannot_read_is_not_left_out(scene):
    out, error = drawn(scene, lambda t: t.replace('"por is zero"', "POR_IS_ZERO"))
    assert not out and "understood" in error


def test_a_row_that_becomes_a_ruling_changes_the_picture(scene):
    out, error = drawn(scene, lambda t: t.replace('"por is zero"', 'RULING "por is zero"'))
    assert out and not error and out != PICTURE.read_text()


if __name__ == "__main__":
    owsdtest.main()
