// SPDX-License-Identifier: MIT
// The stream of events, as it comes in pieces within Cockpit.
import assert from "node:assert/strict";
import {test} from "node:test";
import {reader} from "./page/cockpit.js";

const TEXT = 'id: 7:40\nevent: found\ndata: {"a": 1}\n\n: a comment\nevent: alive\ndata: {}\n\n';
const EVENTS = [["found", '{"a": 1}', "7:40"], ["alive", "{}", "7:40"]];

function read(...pieces) {
	const got = [], take = reader((...event) => got.push(event));
	pieces.forEach(take);
	return got;
}

test("events are the same in whatever pieces they come", () => {
	for (let n = 0; n <= TEXT.length; n++)
		assert.deepEqual(read(TEXT.slice(0, n), TEXT.slice(n)), EVENTS, String(n));
	assert.deepEqual(read(...TEXT), EVENTS);
});

test("an event that has not ended is none", () =>
	assert.deepEqual(read(TEXT.slice(0, -1)), EVENTS.slice(0, 1)));

test("lines of data are joined, and one blank behind the colon is taken off", () =>
	assert.deepEqual(read("data: a\ndata:  b\ndata\n\n"), [["message", "a\n b\n", ""]]));

test("an event without data is none", () => assert.deepEqual(read("event: alive\n\n"), []));
