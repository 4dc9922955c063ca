// SPDX-License-Identifier: MIT
// What the page keeps of a signal, and the small line that it draws of it.
import assert from "node:assert/strict";
import {test} from "node:test";
import {keep, sparkPath} from "./page/spark.js";

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
	assert.equal(recent.length, 3600);
	keep(recent, 1e7, -1, GOOD, false);
	assert.equal(recent.length, 240);
	assert.equal(recent.at(-1).v, -1);
});

test("a line is made of steps, and a gap stays a gap", () => {
	const path = sparkPath(kept([0, 0], [10000, 10], [20000, null, ABSENT], [25000, 0]), 30000);
	assert.equal(path, "M0.0 22.0H37.3V2.0H74.7M93.3 22.0H112");
});

test("nothing is drawn of a signal that had no good value", () => {
	assert.equal(sparkPath([], 1000), "");
	assert.equal(sparkPath(kept([0, null, ABSENT]), 1000), "");
});

test("a constant is a line in the middle", () =>
	assert.equal(sparkPath(kept([0, 7]), 30000), "M0.0 12.0H112"));
