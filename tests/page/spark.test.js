// SPDX-License-Identifier: MIT
// What the page keeps of a signal, and the small line that it draws of it.
import assert from "node:assert/strict";
import {test} from "node:test";
import {keep, rangeOf, sparkPaths} from "./page/spark.js";

const GOOD = 0xc0, ABSENT = 0x08;
const kept = (...events) => {
	const recent = [];
	for (const [t, v, code = GOOD] of events)
		keep(recent, t, v, code);
	return recent;
};

test("what has not changed is kept once", () =>
	assert.equal(kept([0, 1], [1000, 1], [2000, 1]).length, 1));

test("what comes within half a second is one value, with its least and greatest", () =>
	assert.deepEqual(kept([0, 5], [100, 9], [200, 2], [499, 4]), [{t: 0, v: 4, low: 2, high: 9, code: GOOD}]));

test("a loss is never joined with a value, however short", () =>
	assert.deepEqual(kept([0, 5], [10, null, ABSENT], [20, 5]).map(({v}) => v), [5, null, 5]));

test("time does not go backwards", () =>
	assert.deepEqual(kept([5000, 1], [3000, null, ABSENT], [4000, 2]).map(({t}) => t), [5000, 5000, 5000]));

test("the number of values is bounded, and greater while a trend shows the signal", () => {
	const recent = [];
	for (let n = 0; n < 5000; n++)
		keep(recent, n * 1000, n, GOOD, true);
	assert.ok(recent.length <= 3600 && recent.length > 1800, recent.length);
	for (let n = 1; n < 500; n++)
		keep(recent, 1e7 + n * 1000, -n, GOOD, false);
	assert.ok(recent.length <= 240 && recent.length > 60, recent.length);
	assert.equal(recent.at(-1).v, -499);
});

test("what is thinned out keeps its least, its greatest and its gaps", () => {
	const events = Array.from({length: 400}, (_, n) => n === 7 ? [7000, 99] : n === 150
		? [150000, null, ABSENT] : [n * 1000, n % 5]);
	const recent = kept(...events);
	assert.ok(recent.length <= 240);
	assert.equal(Math.max(...recent.map(({high}) => high)), 99);
	assert.ok(recent.some(({v, t}) => v === null && t === 150000));
});

test("a line is made of steps, and a gap stays a gap", () => {
	const {line, dot} = sparkPaths(kept([0, 0], [10000, 10], [20000, null, ABSENT], [25000, 0]), 30000);
	assert.equal(line, "M0.0 19.0H27.0V3.0H54.0M67.5 19.0H81");
	assert.equal(dot, "M81 19.0h0");
});

test("on and off are bars", () =>
	assert.deepEqual(sparkPaths(kept([0, 0], [10000, 1], [20000, 0]), 30000, true),
		{line: "M0 11H81", dot: "M27.0 11H54.0"}));

test("what has no value now has no point at its end", () =>
	assert.equal(sparkPaths(kept([0, 5], [20000, null, ABSENT]), 30000).dot, ""));

test("beside the line is its range, of on and off since when", () => {
	const recent = kept([0, 20.41], [10000, 22.24]);
	assert.deepEqual(rangeOf({type: "double", decimals: 1, recent}, 3600000),
		{text: "20.4 \u2013 22.2", since: "00:00"});
	assert.equal(rangeOf({type: "bool", recent: kept([0, 0], [120000, 1])}, 300000).text, "since 00:02");
	assert.equal(rangeOf({type: "bool", recent: kept([0, 0])}, 3600000).text, "all hour");
	assert.equal(rangeOf({type: "bool", recent: kept([0, 0])}, 60000).text, "");
	assert.equal(rangeOf({type: "string", recent: []}, 1).text, "");
});
