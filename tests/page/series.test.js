// SPDX-License-Identifier: MIT
// Trends: columns of the recorder, joined with what the page has heard. A time of which nothing is
// known is a gap, never a line.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {server} from "./browser.js";
import {UNKNOWN} from "./page/words.js";

const {continued, extremes, goodCode, heldAt, onPart, padded, pastOf} = await import("./page/series.js");
const {store} = await import("./page/store.js");
const GOOD = 0xc0, UNCERTAIN = 0x54, ABSENT = 0x08;
const signal = {name: "room", type: "double", unit: "\u00b0C", recent: []};
const EMPTY = {name: "room", x: [], min: [], max: [], last: [], code: [], gap: []};
const now = () => Date.now() + store.skew;
const points = (all) => all.x.map((x, n) => [x, all.last[n], all.code[n]]);

beforeEach(() => {
	store.info = {history: true};
	store.unknown = null;
	signal.recent = [];
	server.asked.length = 0;
});

const past = (data) => {
	server.answers["api/trend"] = data;
	return pastOf(signal, 0, 5000, 60);
};

test("a column is good, bad or unknown, and only a good one has a last value", async () => {
	const got = await past({from: [0, 1, 2, 3], min: [1, 2, null, null], max: [3, 4, null, null],
		last: [2, 3, 9, 9], quality: [GOOD, UNCERTAIN, ABSENT, GOOD], gap: [0, 1, 0, 0]});
	assert.deepEqual(got.last, [2, null, null, 9]);
	assert.deepEqual(got.code, [GOOD, UNCERTAIN, ABSENT, GOOD]);
	assert.deepEqual(got.gap, [false, true, false, false]);
	assert.ok(goodCode(GOOD) && !goodCode(UNKNOWN) && !goodCode(UNCERTAIN));
});

test("a gap in the middle stays one; what the recorder has not written yet is none", async () => {
	const got = await past({from: [0, 1, 2, 3], min: [1, null, 1, null], max: [1, null, 1, null],
		last: [1, null, 1, null], quality: [GOOD, null, GOOD, 0]});
	assert.deepEqual(got.x, [0, 1, 2]);
	assert.deepEqual(got.code, [GOOD, UNKNOWN, GOOD]);
	assert.equal(got.last[1], null);
});

test("a signal that the recorder does not have is empty, another error is told", async () => {
	assert.deepEqual(await past(404), EMPTY);
	await assert.rejects(past(503), {status: 503});
});

test("without a recorder, and of texts, nothing is asked", async () => {
	assert.deepEqual((await pastOf({...signal, type: "string"}, 0, 1, 1)).x, []);
	store.info = {history: false};
	assert.deepEqual((await past({from: [1]})).x, []);
	assert.equal(server.asked.length, 0);
});

test("the past goes on with what was heard after it, and no sooner", () => {
	const end = now(), at = (n) => end - 10000 + n * 1000;
	signal.recent = [{t: at(1), v: 1, low: 1, high: 1, code: GOOD},
		{t: at(5), v: 5, low: 4, high: 6, code: GOOD}];
	const all = continued({...EMPTY, x: [at(0), at(2)], min: [7, 7], max: [7, 7], last: [7, 7],
		code: [GOOD, GOOD], gap: [false, false]}, signal, at(0), end);
	assert.deepEqual(points(all), [[at(0), 7, GOOD], [at(2), 7, GOOD], [at(4), 1, GOOD],
		[at(5), 5, GOOD], [end, 5, GOOD]]);
	assert.deepEqual([all.min[3], all.max[3]], [4, 6]);
});

test("before the first thing that was heard nothing is known", () => {
	const end = now();
	signal.recent = [{t: end - 1000, v: 1, low: 1, high: 1, code: GOOD}];
	assert.deepEqual(points(continued(EMPTY, signal, end - 5000, end)),
		[[end - 5000, null, UNKNOWN], [end - 1000, 1, GOOD], [end, 1, GOOD]]);
});

test("a value of which the page does not know any more does not reach to the present", () => {
	const end = now();
	signal.recent = [{t: end - 1000, v: 1, low: 1, high: 1, code: GOOD}];
	store.unknown = "owsd is not running.";
	assert.deepEqual(points(continued(EMPTY, signal, end - 5000, end)).at(-1), [end, null, UNKNOWN]);
});

test("a window that ends in the past shows nothing that came after it", () => {
	const end = now();
	signal.recent = [{t: end - 9000, v: 1, low: 1, high: 1, code: GOOD},
		{t: end - 1000, v: 2, low: 2, high: 2, code: GOOD}];
	assert.deepEqual(points(continued(EMPTY, signal, end - 8000, end - 5000)),
		[[end - 8000, 1, GOOD], [end - 5000, 1, GOOD]]);
});

test("what is continued leaves the columns as they were", () => {
	const columns = {...EMPTY, x: [1], min: [1], max: [1], last: [1], code: [GOOD], gap: [false]};
	continued(columns, signal, 0, now());
	assert.deepEqual(columns.x, [1]);
});

test("the least and the greatest are those of good columns in the window", () => {
	const all = {x: [0, 10, 20, 30], min: [-50, 2, null, 1], max: [90, 3, null, 7]};
	assert.deepEqual(extremes(all, [10, 30]), [1, 7]);
	assert.deepEqual(extremes(all, [10, 29]), [2, 3]);
	assert.equal(extremes(all, [15, 25]), null);
});

test("an axis has a margin, also around one value and none", () => {
	assert.deepEqual(padded([[0, 5], [-10, 10]]), [-12, 12]);
	assert.deepEqual(padded([[20, 20]]), [18, 22]);
	assert.deepEqual(padded([[0, 0]]), [-0.1, 0.1]);
	assert.deepEqual(padded([]), [0, 1]);
});

test("what holds at a time is the last column that has begun", () => {
	const all = {x: [10, 20, 30]};
	assert.deepEqual([5, 10, 25, 99, null].map((time) => heldAt(all, time)), [-1, 0, 1, 2, 2]);
});

test("of a switch it is known for which part of the window it was on", () => {
	const all = {x: [0, 10, 20, 30, 40], last: [1, 0, null, 1, 1]};
	assert.equal(onPart(all, [0, 40]), 20 / 30);
	assert.equal(onPart(all, [5, 15]), 0.5);
	assert.equal(onPart(all, [20, 30]), null);
});

test("between the last record and the first value that is heard the value held, if not for long", () => {
	const end = now(), columns = {...EMPTY, x: [end - 9000, end - 8000], min: [1, 1], max: [1, 1],
		last: [1, 1], code: [GOOD, GOOD], gap: [false, false]};
	signal.recent = [{t: end - 2000, v: 2, low: 2, high: 2, code: GOOD}];
	assert.deepEqual(points(continued(columns, signal, end - 9000, end))[2], [end - 7000, 1, GOOD]);
	const long = {...columns, x: [end - 790000, end - 789000]};
	assert.deepEqual(points(continued(long, signal, end - 790000, end))[2], [end - 788000, null, UNKNOWN]);
	const flushed = {...columns, x: [end - 302000, end - 301000]};
	assert.deepEqual(points(continued(flushed, signal, end - 302000, end))[2], [end - 300000, 1, GOOD]);
});
