// SPDX-License-Identifier: MIT
// What the head says of the signals, and what keys ask for.
import assert from "node:assert/strict";
import {test} from "node:test";
import {pass, server, settle} from "./browser.js";
import "./document.js";

const {simulatedWords, titleOf, waiting} = await import("./page/head.js");
const {wish} = await import("./page/keys.js");

const SIGNALS = [{name: "room", alarm: ""}, {name: "cellar", alarm: "low"},
	{name: "flow", alarm: "! high"}, {name: "boiler", alarm: "! high high"}];

test("alarms wait until somebody has seen them, and the worst is first", () =>
	assert.deepEqual(waiting(SIGNALS).map(({name}) => name), ["boiler", "flow"]));

test("the title counts what waits and names the worst, or the view", () => {
	const open = waiting(SIGNALS);
	assert.equal(titleOf("Live", "house", open, false), "(2) boiler very high \u00b7 house");
	assert.equal(titleOf("Live", "house", [], false), "Live \u00b7 house");
	assert.equal(titleOf("Live", "house", open, true), "(?) Live \u00b7 house");
});

test("simulated is said of what was read", () => {
	const real = {good: true}, sim = {good: true, simulated: true}, absent = {good: false};
	assert.equal(simulatedWords([real, absent]), "");
	assert.equal(simulatedWords([sim, absent]), "Simulated");
	assert.equal(simulatedWords([sim, real]), "Partly simulated");
});

test("g and a letter ask for a view, one letter alone for nothing", () => {
	assert.deepEqual(wish("a", true), {view: "alarms"});
	assert.equal(wish("a", false), null);
	assert.equal(wish("toString", true), null);
	assert.deepEqual(["/", "?", "g", "x"].map((key) => wish(key, false)),
		["search", "help", "begin", null]);
	assert.equal(wish("g", true), "begin");
});

test("a page that is open is told that owsd refuses its file, or may not be written, and of the end",
	async () => {
		const {store} = await import("./page/store.js"), {build} = await import("./page/head.js");
		const ids = ["instance", "refused", "read-only", "alarm-count", "icon", "simulated", "more", "state",
			"state-words", "banner", "banner-words"];
		document.body.append(...ids.map((id) => Object.assign(document.createElement("p"), {hidden: true}))
			.map((one, n) => (one.setAttribute("id", ids[n]), one)));
		document.querySelector = () => ({hash: "#live"});
		const [refused, readOnly] = ["refused", "read-only"].map((id) => document.getElementById(id));
		let why = null, writable = true;
		server.answers["api/info"] = () => ({now: Date.now(), since: 1, refused: why, writable});
		server.answers["api/signals"] = () => ({generation: 1, cursor: 1, now: Date.now(), signals: [
			{i: 0, name: "pump", type: "bool", output: true, value: false, age: 0, alarm: null,
				quality: {code: 0xc0, good: true, why: null, text: "good"}}]});
		build();
		await store.start();
		for (const [now, may] of [["house.rio:7: no such key", true], [null, false], [null, true]]) {
			[why, writable] = [now, may];
			store.event("missed", {});
			await pass(500);
			await settle();
			assert.deepEqual([refused.hidden, readOnly.hidden], [!now, may]);
			assert.ok(!now || refused.textContent.endsWith(now), refused.textContent);
		}
	});
