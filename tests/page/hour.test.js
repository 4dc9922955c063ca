// SPDX-License-Identifier: MIT
// What the recorder has of the hour before the page was opened, put before what the page heard.
import "./browser.js";
import assert from "node:assert/strict";
import {test} from "node:test";
const {precede} = await import("./page/hour.js");
const {sinceOf} = await import("./page/look.js");
const {rangeOf} = await import("./page/spark.js");

const GOOD = 0xc0, ABSENT = 0x08, UNKNOWN = -1, STEP = 120000;
const heard = (v, code = GOOD, t = 30 * STEP) => ({t, v, low: v, high: v, code});
const columns = (...some) => ({min: some.map(([low]) => low), max: some.map(([, high]) => high),
	last: some.map(([, , last]) => last), quality: some.map(([, , , code = GOOD]) => code)});
const NONE = [null, null, null, null];
const filled = (n, one) => Array.from({length: n}, () => one);

test("the hour before comes first, each stretch with its least and greatest", () => {
	const recent = [heard(7)];
	precede(recent, columns(...filled(28, NONE), [1, 9, 5], [5, 6, 6]), 0, STEP);
	assert.deepEqual(recent.map(({t, v, low, high}) => [t / STEP, v, low, high]),
		[[28, 5, 1, 9], [29, 6, 5, 6], [30, 7, 7, 7]]);
	assert.equal(rangeOf({type: "double", recent}, 30 * STEP).text, "1 \u2013 9");
});

test("what the recorder has not written yet is bridged, a time without it is a gap", () => {
	const late = [heard(7)], gone = [heard(7)];
	precede(late, columns(...filled(29, [5, 5, 5]), NONE), 0, STEP);
	assert.deepEqual(late.map(({v}) => v), [5, 7]);
	precede(gone, columns(...filled(20, [5, 5, 5]), ...filled(10, NONE)), 0, STEP);
	assert.deepEqual(gone.map(({t, v, code}) => [t / STEP, v, code]),
		[[0, 5, GOOD], [20, null, UNKNOWN], [30, 7, GOOD]]);
});

test("what was not good has no value, and nobody is told since when by a stretch", () => {
	const recent = [heard(null, ABSENT)];
	precede(recent, columns(...filled(10, [5, 5, 5]), ...filled(20, [null, null, null, ABSENT])), 0,
		STEP);
	assert.deepEqual(recent.map(({t, v}) => [t / STEP, v]), [[0, 5], [10, null]]);
	assert.equal(sinceOf({recent, measured: 1234}), 1234);
	recent.push(heard(5, GOOD, 31 * STEP), heard(null, ABSENT, 32 * STEP));
	assert.equal(sinceOf({recent, measured: 1234}), 32 * STEP);
});

test("on and off have the minute of a change only where the page has seen it", () => {
	const recent = [heard(1)];
	precede(recent, columns(...filled(10, [0, 0, 0]), ...filled(20, [1, 1, 1])), 0, STEP);
	assert.equal(rangeOf({type: "bool", recent}, 30 * STEP).text, "");
	recent.push(heard(0, GOOD, 31 * STEP));
	assert.equal(rangeOf({type: "bool", recent}, 32 * STEP).text, "since 01:02");
});
