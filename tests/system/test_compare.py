#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine owserver and owsd read the same simulated devices: compare.py."""

import shutil

import compare
import owsdtest
from owsdtest import SOURCE


def test_the_texts_of_all_properties_compare_as_recorded(scene):
    if not shutil.which("owserver"):
        owsdtest.skip("owserver is not installed")
    now, recorded = compare.run(), compare.recorded()
    changed = [(row, now.of(row)) for row in compare.rows_of()
               if now.of(row) != recorded[row.family, row.property][:2]]
    now.show([(row.family, row.property) for row, _ in changed])
    assert not changed, "\n".join(f"{r.family}/{r.property}: now {v}" for r, v in changed)


def test_each_property_has_a_verdict_and_what_is_not_the_same_a_reason(scene):
    recorded = compare.recorded()
    assert list(recorded) == [(row.family, row.property) for row in compare.rows_of()]
    for key, (verdict, texts, reason) in recorded.items():
        assert verdict in ("same", "differs", "not compared"), key
        assert (texts > 0) == (verdict != "not compared"), f"{key}: {texts} texts"
        assert (reason == "") == (verdict == "same"), f"{key}: {reason!r}"


def test_each_family_that_owserver_states_has_a_device(scene):
    families = {device[:2] for _, device, _ in compare.devices()}
    assert families == {row.family for row in compare.rows_of()}


def test_what_is_not_the_same_is_seen(scene):
    one = compare.Verdicts()
    row = compare.Row("28", "temperature", "t", "-", "ro", "always")
    one.add("DS18B20", "28.0", {"temperature": (b"20", "")}, {"temperature": (b"20", "")})
    assert one.of(row) == ("same", 1)
    one.add("DS18B20", "28.0", {"temperature": (b"20", "")}, {"temperature": (b"21", "")})
    assert one.of(row) == ("differs", 2)
    for theirs, ours in (((None, "-22"), (b"1", "")), ((b"1", ""), (None, "-5"))):
        one = compare.Verdicts()
        one.add("DS18B20", "28.0", {"temperature": theirs}, {"temperature": ours})
        assert one.of(row) == ("differs", 1)
    one = compare.Verdicts()
    one.add("DS18B20", "28.0", {"temperature": (None, "-22")}, {"temperature": (None, "-5")})
    assert one.of(row) == ("not compared", 0)


def test_what_is_written_of_one_part_leaves_the_lines_of_other_families(scene):
    old = compare.recorded()
    lines = compare.lines_of(compare.Verdicts(), old, ["DS2438"])
    assert list(lines) == list(old)
    assert {key: line for key, line in lines.items() if key[0] != "26"} == \
        {key: line for key, line in old.items() if key[0] != "26"}
    assert {line[0] for key, line in lines.items() if key[0] == "26"} == {"not compared"}
    assert set(compare.whole(["DS2438"])) == \
        {part for part, device, _ in compare.devices() if device.startswith("26")}


def test_only_what_runs_may_differ_and_not_by_much(scene):
    assert compare.same("24", "udate", b"  1000000000", b"  1000000030")
    assert not compare.same("24", "udate", b"  1000000000", b"  1000000300")
    assert compare.same("24", "date", b"Sun Sep  9 01:46:40 2001", b"Sun Sep  9 01:47:00 2001")
    assert not compare.same("24", "date", b"Sun Sep  9 01:46:40 2001", b"Sun Sep  9 02:47:00 2001")
    assert not compare.same("28", "temperature", b"        20.5", b"     20.5001")
    assert compare.same("30", "volthours", b"    1.25E-05", b"           0")
    assert not compare.same("30", "volthours", b"     0.00125", b"           0")
    assert not compare.same("30", "volts", b"    1.25E-05", b"           0")
    page = bytes(range(32))
    assert compare.same("26", "pages/page.1", page, page[:8] + b"\x0a\x09" + page[10:])
    assert not compare.same("26", "pages/page.1", page, page[:8] + b"\x88\x09" + page[10:])
    assert not compare.same("26", "pages/page.1", page, bytes(6) + page[6:])
    assert not compare.same("2D", "pages/page.1", page, page[:8] + b"\x0a\x09" + page[10:])


def test_the_page_is_made_of_this(scene):
    page = (SOURCE / "docs/properties.md").read_text()
    done = scene._run(["python3", SOURCE / "docs/properties.py"], 60)
    assert done.returncode == 0, done.stderr
    assert done.stdout == page, "run: make properties-page"


if __name__ == "__main__":
    owsdtest.main()
