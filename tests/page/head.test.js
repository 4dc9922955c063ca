// SPDX-License-Identifier: MIT
// What the head says of the signals, and what keys ask for.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

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
