// SPDX-License-Identifier: MIT
// Of which alarms a browser is told: each that is raised, once, whether the page is seen or hidden.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./document.js";

const {fresh, waitingOf} = await import("./page/tell.js");
const {waiting} = await import("./page/head.js");

const names = (before, ...now) => fresh(before && new Set(before), now.map(([name, text]) =>
	({name, text}))).map(({name}) => name);

test("what waits and did not before is news, and nothing is when nothing was known", () => {
	assert.deepEqual(names([], ["a", "high"]), ["a"]);
	assert.deepEqual(names(null, ["a", "high"]), []);
	assert.deepEqual(names(["a high"], ["a", "high"], ["b", "high"]), ["b"]);
	assert.deepEqual(names(["a high"], ["a", "very high"]), ["a"]);
});

test("an alarm that returns is no news, one that is raised again is", () => {
	assert.deepEqual(names(["a high"], ["a", "high, returned"]), []);
	assert.deepEqual(names(["a high, returned"], ["a", "high, returned"]), []);
	assert.deepEqual(names(["a high, returned"], ["a", "high"]), ["a"]);
	assert.deepEqual(names([], ["a", "high, returned"]), ["a"], "it came and went unseen");
});

test("a hidden page has the same words for what waits as one that is seen", () => {
	const standing = [["a", "! device; ! high, returned", ["device", "high"]],
		["b", "! cannot be armed", ["device"]], ["c", "low, acknowledged", ["low"]],
		["d", "! high high", ["high high"]], ["e", null, ["not as commanded"]]];
	const seen = waiting(standing.map(([name, alarm]) => ({name, alarm})));
	const hidden = waitingOf(standing.flatMap(([name, words, kinds]) =>
		kinds.map((alarm) => ({name, alarm, words, state: "stands"}))));
	assert.deepEqual(hidden, seen);
	assert.equal(seen.length, 3);
});
