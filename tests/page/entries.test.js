// SPDX-License-Identifier: MIT
// The journal of a trend that follows the present: nothing is asked for twice, and nothing missed.
import assert from "node:assert/strict";
import {test} from "node:test";
import {server} from "./browser.js";

const {Entries} = await import("./page/entries.js");
let kept = [];
const at = (n) => new Date(1.7e12 + n).toISOString();
const names = (entries) => entries.map(({name}) => name).join("");
const asked = [];

server.answers["api/journal"] = (query) => {
	const since = Number(query.get("since")), n = Number(query.get("n"));
	asked.push(since - 1.7e12);
	return {entries: kept.filter(({time}) => Date.parse(time) >= since).reverse().slice(0, n)};
};

test("only what is new is asked for, and entries of one moment come once", async () => {
	const journal = new Entries();
	kept = [{name: "a", time: at(10)}, {name: "b", time: at(20)}];
	assert.equal(names(await journal.from(1.7e12 + 5, 9)), "ba");
	kept.push({name: "c", time: at(20)}, {name: "d", time: at(30)});
	assert.equal(names(await journal.from(1.7e12 + 6, 9)), "dcba");
	assert.equal(names(await journal.from(1.7e12 + 7, 9)), "dcba");
	assert.deepEqual(asked, [5, 20, 30]);
	assert.equal(names(await journal.from(1.7e12 + 7, 3)), "dcb");
});

test("an earlier window is asked for whole", async () => {
	const journal = new Entries();
	asked.length = 0;
	kept = [{name: "a", time: at(10)}, {name: "b", time: at(20)}];
	assert.equal(names(await journal.from(1.7e12 + 15, 9)), "b");
	assert.equal(names(await journal.from(1.7e12 + 5, 9)), "ba");
	assert.deepEqual(asked, [15, 5]);
	kept = [];
	assert.equal(names(await new Entries().from(1.7e12, 9)), "");
});
