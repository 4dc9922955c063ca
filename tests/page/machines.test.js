// SPDX-License-Identifier: MIT
// The machines above each view: what a summary and an answer mean in a line.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {lineOf, otherLine, ownSummary} = await import("./page/machines.js");

const GOOD = {live: true, signals: 9, not_good: 0, alarms: 0, needs: 0, first: null, alarm: null};
const NOW = Date.parse("2026-11-29T12:00:00");
const other = (more) => ({name: "boiler", page: null, answers: true, since: 60, age: 2, why: null,
	summary: GOOD, ...more});

test("a house in order has no edge, and one that needs somebody says how many", () => {
	assert.deepEqual([lineOf(GOOD).edge, lineOf(GOOD).words], ["none", "all 9 good"]);
	assert.equal(lineOf({...GOOD, needs: 1}).words, "1 of 9 needs you");
	assert.equal(lineOf({...GOOD, needs: 2}).edge, "bad");
	assert.equal(lineOf({...GOOD, signals: 0}).words, "no signal yet");
});

test("an alarm that waits is named, and what needs somebody besides is counted", () => {
	const line = lineOf({...GOOD, needs: 3, alarms: 1, first: "flow", alarm: "! high high"});
	assert.deepEqual([line.edge, line.words, line.alarm.text], ["alarm-2", "flow and 2 more", "very high"]);
	assert.equal(lineOf({...GOOD, needs: 1, alarms: 1, first: "flow", alarm: "! low"}).words, "flow");
});

test("a machine without owsd, or that does not answer, has no number", () => {
	assert.match(lineOf({...GOOD, live: false, needs: 9}).words, /is not running/);
	const line = otherLine(other({answers: false, since: 600, why: "it does not answer in time",
		summary: null}), NOW, false);
	assert.deepEqual([line.edge, line.words, line.why],
		["bad", "no answer since 11:50", "it does not answer in time"]);
	assert.equal(otherLine(other({answers: null, since: null, summary: null}), NOW, false).words,
		"not asked yet");
});

test("an answer that is old has its age, and none is believed when this page knows nothing", () => {
	assert.equal(otherLine(other({age: 2}), NOW, false).why, "");
	assert.equal(otherLine(other({age: 24}), NOW, false).why, "as of 24 s ago");
	assert.deepEqual(otherLine(other({}), NOW, true).words, "not known");
});

test("this machine says of itself what its summary says to others", () => {
	const signal = (name, code, alarm = "") => ({name, code, alarm, good: code >= 0xc0});
	const own = ownSummary([signal("a", 0xc0), signal("b", 0x08), signal("c", 0x20),
		signal("d", 0xc0, "! high"), signal("e", 0xc0, "high, acknowledged")], null);
	assert.deepEqual(own, {live: true, signals: 5, needs: 2, first: "d", alarm: "! high"});
	assert.equal(ownSummary([signal("a", 0xc0)], "gone").live, false);
});
