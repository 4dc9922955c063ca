// SPDX-License-Identifier: MIT
// Tables for spreadsheets: a line for each time, a column for each signal.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {server} from "./browser.js";

const {csvOf, recordsOf} = await import("./page/csv.js");
const GOOD = 0xc0, ABSENT = 0x08;
const room = {name: "room", type: "double", unit: "\u00b0C", decimals: 1};
const pump = {name: "pump", type: "bool"};

beforeEach(() => { server.asked.length = 0; });

test("each line has what held at its time, and nothing that was not good", () => {
	const csv = csvOf([{signal: room, past: {x: [0, 2000], last: [21.46, null]}},
		{signal: pump, past: {x: [1000], last: [1]}}]);
	assert.deepEqual(csv.split("\r\n"), ["\ufefftime,room (\u00b0C),pump",
		"1970-01-01 00:00:00,21.5,", "1970-01-01 00:00:01,21.5,1", "1970-01-01 00:00:02,,1", ""]);
	assert.match(csvOf([{signal: room, past: {x: [1], last: [21.4567]}}], true),
		/\n1970-01-01 00:00:00\.001,21\.4567\r/);
});

test("a table for spreadsheets has no formula and no broken line", () => {
	const past = {x: [], last: []};
	assert.equal(csvOf([{signal: {name: "=1+1", unit: 'a,"b"'}, past}]),
		"\ufefftime,\"'=1+1 (a,\"\"b\"\")\"\r\n");
	for (const sign of "+-@")
		assert.match(csvOf([{signal: {name: `${sign}x`}, past}]), new RegExp(`,'\\${sign}x\r`));
});

test("records come in several answers, and the one that held at the begin has its time", async () => {
	server.answers["api/records"] = (query) => query.get("from") === "100"
		? {records: [[50, 1, GOOD], [150, 2, GOOD]], next: 200}
		: {records: [[200, null, ABSENT], [250, 7, 0]], next: null};
	const {x, last} = await recordsOf(room, 100, 300);
	assert.deepEqual([x, last], [[100, 150, 200, 250], [1, 2, null, null]]);
	assert.equal(server.asked.length, 2);
});

test("all digits are all digits", () => {
	const past = {x: [1, 2], last: [1234567890123, 0.1234567890123]};
	assert.match(csvOf([{signal: room, past}], true), /,1234567890123\r\n.*,0\.1234567890123\r/);
	const large = {x: [1], last: ["-9007199254740993"]};
	assert.match(csvOf([{signal: {name: "meter", type: "large"}, past: large}], true),
		/,-9007199254740993\r/);
});

test("a table that is too long says where it is cut, and its cells are empty from there on", async () => {
	server.answers["api/records"] = (query) => {
		const from = Number(query.get("from"));
		return {records: Array.from({length: 100000}, (_, n) => [from + n, 7, GOOD]), next: from + 100000};
	};
	const {cut, x, last} = await recordsOf(room, 1, 1e9);
	assert.deepEqual([cut, x.at(-1), last.at(-2), last.at(-1)], [500001, 500001, 7, null]);
});
