// SPDX-License-Identifier: MIT
// The view Live without a document: groups, order, filters, the address, states, the scale.
import assert from "node:assert/strict";
import {test} from "node:test";
import {isLate, lookOf, needsOf, sentenceOf} from "./page/look.js";
import {choicesOf, columnsOf, cut, groupsOf, moved, passes, placeOf, readAddress, showOf, sorted,
	toggled, writeAddress} from "./page/order.js";
import {buckets, marksOf, middleOf, scaleOf} from "./page/scale.js";

const GOOD = 0xc0, ABSENT = 0x08, INITIAL = 0x20, STALE = 0x14, DIFFERS = 0x1c, RANGE = 0x54;
const signal = (name, more = {}) => ({name, code: GOOD, type: "double", unit: "\u00b0C", decimals: 1,
	recent: [], path: "/x", alarm: null, limits: null, measured: null, ...more});
const row = (name, value = 1, more = {}) => {
	const one = signal(name, more), look = lookOf(one, null, 1);
	return {signal: one, value, look, age: 1, urgency: 0};
};
const names = (rows) => rows.map((one) => one.signal.name);

// --- Names, places, groups ------------------------------------------------------------------

test("of a long name the last eight characters are kept", () => {
	assert.deepEqual(cut("room"), ["room", ""]);
	assert.deepEqual(cut("a_name_of_sixteen"), ["a_name_of", "_sixteen"]);
	assert.equal(cut("\u{1f321}".repeat(20))[1], "\u{1f321}".repeat(8));
});

test("a place is what owsd-web calls it, or put together of its parts", () => {
	assert.equal(placeOf({terminal: "cabinet, terminal 1"}), "cabinet, terminal 1");
	assert.equal(placeOf({terminal: {adapter: "cabinet", chip: null, channel: 0}}), "cabinet, terminal 0");
	assert.equal(placeOf({}), "");
});

const titles = (rows) => groupsOf(rows).map(({title, members}) => [title, ...names(members)]);

test("groups are those of the file, in its order; what has none is last", () => assert.deepEqual(
	titles([row("a", 1, {group: "Rooms"}), row("b"), row("c", 1, {group: "Heating"}),
		row("d", 1, {group: "Rooms"})]),
	[["Rooms", "a", "d"], ["Heating", "c"], ["Others", "b"]]));

test("without a group the place is one, else a chip that has several signals", () => {
	assert.deepEqual(titles([row("a", 1, {terminal: "t 1"}), row("b", 1, {terminal: "t 2"})]),
		[["t 1", "a"], ["t 2", "b"]]);
	assert.deepEqual(titles([row("a", 1, {device: "28.1"}), row("b", 1, {device: "29.1", family: "DS2408"}),
		row("c", 1, {device: "29.1"}), row("s", 1, {path: "/simulator/x"}), row("d")]),
	[["DS2408 29.1", "b", "c"], ["Others", "a", "d"], ["Simulation", "s"]]);
});

test("each group goes to the column that is the shortest", () => {
	const group = (title, n) => ({title, members: new Array(n)});
	assert.deepEqual(columnsOf([group("a", 8), group("b", 2), group("c", 3), group("d", 1)], 2)
		.map((column) => column.map(({title}) => title)), [["a"], ["b", "c", "d"]]);
});

test("many signals, or one group, are a list at first", () => {
	const two = [row("a", 1, {group: "A"}), row("b", 1, {group: "B"})];
	assert.equal(showOf("", two), "groups");
	assert.equal(showOf("list", two), "list");
	assert.equal(showOf("rubbish", [row("a"), row("b")]), "list");
	assert.equal(showOf("", Array.from({length: 61}, (_, n) => row(`${n}`, 1, {group: `${n % 9}`}))), "list");
});

// --- Order and filters ----------------------------------------------------------------------

test("those without a value are last, whichever the order", () => {
	const rows = [row("none", null), row("b", 2), row("a", 10), row("c", -1)];
	assert.deepEqual(names(sorted(rows, "value")), ["c", "b", "a", "none"]);
	assert.deepEqual(names(sorted(rows, "-value")), ["a", "b", "c", "none"]);
	assert.deepEqual(names(sorted(rows, "")), ["none", "b", "a", "c"]);
	assert.deepEqual(names(sorted(rows, "-name")), ["none", "c", "b", "a"]);
	assert.deepEqual(names(sorted(rows, "rubbish")), ["none", "b", "a", "c"]);
});

test("the last hour is in the order of how much moved; places are counted as people do", () => {
	const recent = (low, high) => [{v: low, low, high}];
	assert.deepEqual(names(sorted([row("still", 1, {recent: recent(1, 1)}),
		row("moves", 1, {recent: recent(0, 9)}), row("new")], "-hour")), ["moves", "still", "new"]);
	assert.deepEqual(names(sorted([row("a", 1, {terminal: "t 10"}), row("b", 1, {terminal: "t 9"})],
		"place")), ["b", "a"]);
});

test("filters have their counts, and none that changes nothing", () => {
	const rows = [row("a"), row("b", null, {code: ABSENT}), row("c", 1, {unit: "bar"}),
		row("p", true, {unit: null, type: "bool", output: true})];
	assert.deepEqual(choicesOf(rows, true).map(({words, count}) => [words, count]), [["All", 4],
		["Not good", 1], ["\u00b0C", 2], ["bar", 1], ["Outputs", 1], ["on / off", 1]]);
	assert.deepEqual(choicesOf([row("a"), row("b")], true).map(({words}) => words), ["All", "Not good"]);
});

test("a column of the picture is a filter: from, and less than to", () => {
	const choice = {from: 1, to: 2};
	assert.deepEqual([0.9, 1, 1.9, 2, null].map((value) => passes(row("a", value), choice)),
		[false, true, true, false, false]);
});

// --- The address ----------------------------------------------------------------------------

test("the address keeps what is shown", () => {
	for (const text of ["#live", "#live?show=list&order=-value&unit=%C2%B0C", "#live?tiles=a,b",
		"#live?q=x&from=1&to=2", "#live?tiles="])
		assert.equal(writeAddress(readAddress(text.split("?")[1] ?? "")), text);
});

test("a name with a comma can be a tile, and rubbish is none", () => {
	const tiles = ["a,b", "50%", "%2C"];
	const state = readAddress(writeAddress({...readAddress(""), tiles}).split("?")[1]);
	assert.deepEqual(state.tiles, tiles);
	assert.deepEqual([readAddress("from=x&to=1").from, readAddress("from=x&to=1").to], [null, null]);
});

test("a tile is put in, taken out, and moved, not beyond the ends", () => {
	assert.deepEqual(toggled(["a"], "b"), ["a", "b"]);
	assert.deepEqual(toggled(["a", "b"], "a"), ["b"]);
	assert.deepEqual(moved(["a", "b", "c"], "c", -2), ["c", "a", "b"]);
	assert.deepEqual(moved(["a", "b", "c"], "c", 5), ["a", "b", "c"]);
});

// --- States ---------------------------------------------------------------------------------

const looks = (more, age = 1, unknown = null) => lookOf(signal("a", more), unknown, age);

test("each state has its edge, and says whether somebody is needed", () => {
	const cases = [[{}, "none", "", false], [{code: INITIAL}, "initial", "not read yet", false],
		[{code: RANGE}, "uncertain", "out of range", true],
		[{code: ABSENT}, "bad", "device absent", true],
		[{code: STALE}, "bad", "stale, nothing for 4 min", true],
		[{code: DIFFERS, commanded: true}, "bad", "on was set, reads off", true],
		[{code: DIFFERS}, "bad", "not as commanded", true],
		[{alarm: "! high"}, "alarm", "", true], [{alarm: "! high high"}, "alarm-2", "", true],
		[{alarm: "low, acknowledged"}, "none", "", false],
		[{alarm: "! high", code: ABSENT}, "bad", "device absent", true]];
	for (const [more, edge, words, needs] of cases)
		assert.deepEqual(Object.values((({edge: e, words: w, needs: n}) => ({e, w, n}))(looks(more, 250))),
			[edge, words, needs], JSON.stringify(more));
	assert.equal(looks({}, 1, "owsd is gone").edge, "unknown");
	assert.ok(looks({alarm: "! high", code: ABSENT}).alarm);
});

test("a value is late after three usual intervals", () => {
	assert.ok(!isLate({interval: 10}, 30) && isLate({interval: 10}, 31));
	assert.ok(!isLate({interval: 0.05}, 2), "the page hears of it with some delay");
	assert.ok(!isLate({}, 1e6) && !isLate({interval: 1}, null));
	assert.ok(isLate({gap: 2}, 7), "what the page saw, until owsd-web says it");
	assert.ok(looks({interval: 1}, 34).late && !looks({interval: 1}, 34).needs);
	assert.ok(isLate({interval: 1, deadband: 0}, 34));
	assert.ok(!isLate({interval: 1, deadband: 0.5}, 34) && !isLate({gap: 2, deadband: 0.5}, 1e6),
		"of what stays within it no page hears");
});

test("the sentence is the answer", () => {
	const good = looks({}), bad = looks({code: ABSENT}), first = looks({code: INITIAL});
	assert.deepEqual(sentenceOf([good, good], [3, 8.2]), ["All 2 good", "All at most 9 s old."]);
	assert.deepEqual(sentenceOf([good, bad, first], [3]), ["1 of 3 needs you",
		"1 good, 1 not read yet. All at most 3 s old."]);
	assert.deepEqual(sentenceOf([good, looks({interval: 1}, 34)], [3, 34]), ["All 2 good", "1 late."]);
	assert.deepEqual(sentenceOf([looks({}, 1, "gone")], []), ["1 signals, all unknown", ""]);
});

test("what needs you has its name and its reason, the worst first", () => {
	const rows = [row("attic", null, {code: ABSENT}),
		row("boiler", 66.2, {alarm: "! high", limits: {h: 65}})];
	assert.deepEqual(needsOf(rows).map((one) => [one.names, one.words]), [
		[["boiler"], "high, 66.2\u202f\u00b0C, limit 65.0"], [["attic"], "device absent"]]);
});

test("many that need you are told by their reasons", () => {
	const rows = [...Array.from({length: 5}, (_, n) => row(`h${n}`, 9, {alarm: "! high"})),
		row("l", 1, {alarm: "! low"}), row("v", 1, {alarm: "! high high"}),
		...Array.from({length: 4}, (_, n) => row(`a${n}`, null, {code: ABSENT})),
		row("r", null, {code: RANGE})];
	assert.deepEqual(needsOf(rows).map(({names: some, more, words}) => [some.length, more, words]), [
		[1, 0, "very high, 1.0\u202f\u00b0C"], [3, 2, "high"], [1, 0, "low, 1.0\u202f\u00b0C"],
		[0, 5, "have no value: 4 device absent, 1 out of range"]]);
});

// --- The scale ------------------------------------------------------------------------------

test("a scale has round ends, and limits that are near", () => {
	assert.deepEqual(scaleOf([14.1, 33.4], [15, 30]), {from: 10, to: 35, step: 5});
	assert.deepEqual(scaleOf([20, 21], [1000]), {from: 20, to: 21, step: 0.2});
	const one = scaleOf([5]);
	assert.ok(one.from <= 5 && one.to > one.from, JSON.stringify(one));
	assert.equal(scaleOf([]), null);
	assert.deepEqual(marksOf({from: 0, to: 0.6, step: 0.2}), [0, 0.2, 0.4, 0.6]);
});

test("each value is counted once, those at the ends too", () =>
	assert.deepEqual(buckets([0, 1, 5, 9.9, 10], {from: 0, to: 10}, 5), [2, 0, 1, 0, 2]));

test("the middle is the one in the middle, or between two", () =>
	assert.deepEqual([middleOf([3, 1, 2]), middleOf([4, 1, 2, 3]), middleOf([])], [2, 2.5, null]));
