// SPDX-License-Identifier: MIT
// When calls happen.
import assert from "node:assert/strict";
import {test} from "node:test";
import {pass, settle} from "./browser.js";
import {alone} from "./page/alone.js";
import {later} from "./page/dom.js";

test("a call that takes longer than its interval comes to its end before the next begins", async () => {
	const log = [], again = alone(async () => {
		log.push("begin");
		await new Promise((resolve) => setTimeout(resolve, 7000));
		log.push("end");
	});
	const timer = setInterval(again, 5000);
	await pass(24000);
	clearInterval(timer);
	assert.deepEqual(log, ["begin", "end", "begin", "end"]);
});

test("after a call that failed the next one is made", async () => {
	let count = 0;
	const again = alone(async () => {
		count++;
		throw new Error("no");
	});
	await assert.rejects(again());
	await assert.rejects(again());
	assert.equal(count, 2);
});

test("what is wished for many times happens once, later", async () => {
	let count = 0;
	const soon = later(() => count++, 100);
	soon();
	soon();
	await settle();
	assert.equal(count, 0);
	await pass(100);
	assert.equal(count, 1);
	soon();
	await pass(100);
	assert.equal(count, 2);
});
