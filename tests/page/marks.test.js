// SPDX-License-Identifier: MIT
// Gaps, limits and alarms of a plot.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";
import {UNKNOWN} from "./page/words.js";

const {alarmsOf, gapsOf, limitsOf, linesOf} = await import("./page/marks.js");
const GOOD = 0xc0, ABSENT = 0x08, STALE = 0x14, MIN = 60000;
const boiler = {name: "boiler", decimals: 1, limits: {hh: null, h: 65, l: 10, ll: null}, alarm: ""};
const raised = (time, more) => ({time, name: "boiler", journal: "alarms", alarm: "high",
	event: "raised", value: 66, by: null, ...more});

test("a gap lies at the height of the value before it, and says why", () => {
	const gaps = gapsOf({x: [0, 1, 2, 3, 4, 5].map((n) => n * MIN), last: [7, null, null, null, 9, 9],
		code: [GOOD, ABSENT, ABSENT, STALE, GOOD, GOOD]});
	assert.deepEqual(gaps.map(({from, until, value, words}) => [from / MIN, until / MIN, value, words]),
		[[1, 3, 7, "device absent, 2 min"], [3, 4, 7, "stale, 60 s"]]);
});

test("at the begin a gap lies at the value after it; a time before the records is none", () => {
	const x = [0, 1, 2].map((n) => n * MIN), last = [null, 5, 5];
	assert.equal(gapsOf({x, last, code: [ABSENT, GOOD, GOOD]})[0].value, 5);
	assert.deepEqual(gapsOf({x, last, code: [UNKNOWN, GOOD, GOOD]}), []);
	assert.deepEqual(gapsOf({x, last, code: [0x20, GOOD, GOOD]}), []);
	assert.deepEqual(gapsOf({x, last: [5, null, null], code: [GOOD, UNKNOWN, UNKNOWN]})[0].until, 2 * MIN);
	assert.deepEqual(gapsOf({x, last: [null, null, null], code: [ABSENT, ABSENT, ABSENT]}), []);
});

test("a limit is shown where values come near it", () => {
	assert.deepEqual(limitsOf(boiler, [50, 60]), [{value: 65, words: "boiler limit 65.0"}]);
	assert.deepEqual(limitsOf(boiler, [40, 45]), []);
	assert.deepEqual(limitsOf({name: "a", limits: null}, [0, 1]), []);
});

test("labels that would overlap stand in lines below each other, as far as there are lines", () => {
	const at = (from, until) => ({from, until});
	assert.deepEqual(linesOf([at(0, 10), at(20, 30), at(10, 20)], 3), [0, 0, 0]);
	assert.deepEqual(linesOf([at(0, 10), at(5, 15), at(8, 30)], 3), [2, 1, 0]);
	assert.deepEqual(linesOf([at(0, 10), at(0, 10), at(0, 10)], 2).filter((line) => line < 0), [-1]);
	assert.deepEqual(linesOf([], 2), []);
});

test("an alarm is drawn from raised to returned, or to the present while it stands", () => {
	const window = [0, 100 * MIN], at = (entries, alarm = "") => alarmsOf(entries,
		[{...boiler, alarm}], window, 90 * MIN).map(({from, until, kind, turn}) =>
		[from / MIN, until === null ? null : until / MIN, kind, turn]);
	const returned = raised(20 * MIN, {event: "returned"});
	assert.deepEqual(at([raised(10 * MIN), returned]), [[10, 20, "high", "up"]]);
	assert.deepEqual(at([returned]), [[0, 20, "high", "up"]]);
	assert.deepEqual(at([raised(10 * MIN)], "! high"), [[10, 90, "high", "up"]]);
	assert.deepEqual(at([raised(10 * MIN)]), [[10, null, "high", "up"]]);
	assert.deepEqual(at([], "high high"), [[0, 90, "very high", "up"]]);
	assert.deepEqual(at([], "high, returned"), []);
	assert.deepEqual(at([raised(10 * MIN, {alarm: "bad"}), raised(5 * MIN, {name: "other"}),
		raised(10 * MIN, {event: "shelved"})]), []);
});
