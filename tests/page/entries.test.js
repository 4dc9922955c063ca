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
	assert.deepEqual(asked, [5, -980, -970]);
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

test("where the clock was set, forward or back, all is asked for again", async () => {
	for (const by of [3600000, -3600000]) {
		const journal = new Entries();
		const set = (step) => ["a", "b"].map((name, number) => ({journal: "alarms", number, name,
			time: at(10 * number + step)}));
		kept = set(0);
		await journal.from(1.7e12 - 1e7, 9);
		kept = set(by);
		assert.deepEqual((await journal.from(1.7e12 - 1e7, 9)).map(({name, time}) => [name, time]),
			[["b", at(10 + by)], ["a", at(by)]]);
	}
});
