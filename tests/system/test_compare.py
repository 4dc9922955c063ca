#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The genuine owserver and owsd read, and write, the same simulated devices: compare.py,
compare_virtual.py and compare_writes.py."""

import shutil

import compare
import compare_virtual
import compare_writes
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
    # an EDS0072 takes a sample each second
    for name in ("EDS0071/counter/samples", "EDS0072/counter/samples", "EDS0072/counter/seconds"):
        assert compare.same("7E", name, b"           1", b"           0"), name
        assert not compare.same("7E", name, b"           1", b"        2000"), name
    assert not compare.same("21", "about/samples", b"           1", b"           0")
    assert not compare.same("28", "temperature", b"        20.5", b"     20.5001")
    assert compare.same("30", "volthours", b"    1.25E-05", b"           0")
    assert not compare.same("30", "volthours", b"     0.00125", b"           0")
    assert not compare.same("30", "volts", b"    1.25E-05", b"           0")
    page = bytes(range(32))
    assert compare.same("26", "pages/page.1", page, page[:8] + b"\x0a\x09" + page[10:])
    assert not compare.same("26", "pages/page.1", page, page[:8] + b"\x88\x09" + page[10:])
    assert not compare.same("26", "pages/page.1", page, bytes(6) + page[6:])
    assert not compare.same("2D", "pages/page.1", page, page[:8] + b"\x0a\x09" + page[10:])


def test_structure_settings_and_statistics_are_owservers_but_for_what_is_recorded(scene):
    if not shutil.which("owserver"):
        owsdtest.skip("owserver is not installed")
    pairs, asked = compare_virtual.run(scene)
    paths = compare_virtual.recorded()
    fresh = [pair for pair in pairs if not compare_virtual.is_recorded(pair, paths)]
    for pair in fresh:
        compare_virtual.show(pair)
    assert asked > 10000 and not fresh, f"{len(fresh)} answers differ"
    assert not compare_virtual.unused(pairs, paths), "recorded, and does not differ"


# Of what is written a sample: `make compare` has all
SAMPLE = ("DS18B20", "DS2413", "DS2890")


def test_what_is_written_compares_as_recorded(scene):
    if not shutil.which("owserver"):
        owsdtest.skip("owserver is not installed")
    now, recorded = compare_writes.run(SAMPLE), compare_writes.recorded()
    changed = [key for key, outcome in now.items() if outcome.line()[:3] != recorded[key][:3]]
    for key in changed:
        compare_writes.show(now[key])
    assert len(now) > 6 and not changed, "\n".join(f"{k}: now {now[k].line()}" for k in changed)


def test_each_property_that_can_be_written_has_a_verdict_and_a_reason(scene):
    recorded = compare_writes.recorded()
    assert list(recorded) == compare_writes.keys()
    for key, line in recorded.items():
        assert line.verdict in ("same", "differs", "not written"), key
        assert (line.reason == "") == (line.verdict == "same"), f"{key}: {line}"
        assert line.verdict == "not written" or line.values, key
        others = set(line.others.split(", "))
        assert others == ({"-"} if line.verdict != "same" else {"same"}) or \
            line.verdict == "same" and others <= set(compare_writes.OTHERS), key


def test_what_is_not_written_the_same_is_seen(scene):
    seen = ("DS18B20", "templow", (b"1", 0), "", ["", ""], [], [])
    outcome = compare_writes.Outcome()
    outcome.add("", True, False, seen)
    outcome.add("range", True, True, seen)
    assert outcome.line("why") == ("same", 1, "same", "")
    outcome.add("range", False, True, seen)
    assert outcome.line("why") == ("same", 1, "range", "")
    outcome.add("", False, True, seen)
    assert outcome.line("why") == ("differs", 2, "-", "why")
    outcome = compare_writes.Outcome()
    outcome.add("", False, True, seen)
    assert outcome.line("why") == ("not written", 1, "-", "why")
    assert compare_writes.Outcome().line("why") == ("not written", 0, "-", "why")
    theirs, ours = [("templow", b"1", "")], [("templow", b"2", "")]
    assert compare_writes.alike("28", theirs, theirs)
    assert not compare_writes.alike("28", theirs, ours)
    assert not compare_writes.alike("28", theirs, [("templow", None, "-5")])
    assert compare_writes.alike("28", [("templow", None, "-22")], [("templow", None, "-5")])


def test_the_page_is_made_of_this(scene):
    page = (SOURCE / "docs/properties.md").read_text()
    done = scene._run(["python3", SOURCE / "docs/properties.py"], 60)
    assert done.returncode == 0, done.stderr
    assert done.stdout == page, "run: make properties-page"


if __name__ == "__main__":
    owsdtest.main()
