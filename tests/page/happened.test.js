// SPDX-License-Identifier: MIT
// What happened, as lines of whole happenings, and the curve of an alarm.
import assert from "node:assert/strict";
import {test} from "node:test";
import {actorOf, curveOf, happenings, hoursOf, isLost, joined, limitOf, matches, overWords}
	from "./page/happened.js";

const at = (clock) => `2026-11-28T${clock}Z`;
const alarm = (clock, event, more = {}) => ({time: at(clock), journal: "alarms", name: "flow",
	alarm: "high", event, value: null, by: null, more: 0, remark: null, ...more});
const command = (clock, event, name, value, by = null) => ({time: at(clock), journal: "commands",
	name, alarm: null, event, value, by, more: 0, remark: null});
const ANNA = {program: "page", person: "anna", user: "www-data", pid: 1};
const none = () => undefined;

test("raised, acknowledged and returned are one line, with how long and by whom", () => {
	const [one, ...others] = happenings([alarm("10:08:00", "returned"),
		alarm("10:02:00", "acknowledged", {by: ANNA}),
		alarm("10:00:00", "raised", {value: 65.1})], none);
	assert.equal(others.length, 0);
	assert.equal(one.ended - one.time, 480000);
	assert.deepEqual([one.value, one.seen.by, one.what], [65.1, "anna, page", "raised"]);
});

test("an alarm that stands has no end, and one that returned before the window has its own line", () => {
	const all = happenings([alarm("09:00:00", "returned"), alarm("10:00:00", "raised"),
		alarm("11:00:00", "raised", {alarm: "high high"})], none);
	assert.deepEqual(all.map(({what, ended}) => [what, ended]),
		[["raised", null], ["raised", null], ["returned", null]]);
});

test("of what is raised again, as after a restart of owsd, only the newest can stand", () => {
	const all = happenings([alarm("09:00:00", "raised"), alarm("10:00:00", "raised"),
		alarm("11:00:00", "raised"), alarm("11:30:00", "raised", {alarm: "high high"})], none);
	assert.deepEqual(all.map(({over}) => over), [false, false, true, true]);
});

test("what outputs take at a start is one line, and a command is another", () => {
	const all = happenings([command("07:00:00", "InitValue", "light", false),
		command("07:00:01", "InitValue", "pump", false),
		command("07:00:05", "set", "pump", true, ANNA)], (name) => ({name, type: "bool"}));
	assert.deepEqual(all.map(({name, what, by}) => [name, what, by]), [
		["pump", "set on", "anna, page"], ["owsd", "2 outputs took their first value", "owsd"]]);
	assert.ok(matches(all[1], ["light"]) && matches(all[0], ["anna", "set"]));
	assert.ok(!matches(all[0], ["anna", "light"]));
	assert.equal(happenings([command("07:00:00", "InitValue", "x", 1)], none)[0].what,
		"InitValue: 1");
});

test("a command of 64 bits has all its digits", () => {
	const large = "9007199254740993";
	assert.equal(happenings([command("07:00:00", "set", "meter", large)],
		(name) => ({name, type: "large"}))[0].what, `set ${large}`);
	const signal = {type: "large", limits: {h: 5}};
	assert.equal(overWords(signal, "high", "9007199254740992"),
		`Limit 5, over it by ${2 ** 53 - 5}`);
	assert.equal(overWords(signal, "high", undefined), "Limit 5");
});

test("an hour counts what began in it", () => {
	const all = happenings([alarm("10:00:00", "raised"), alarm("10:59:59", "raised", {name: "b"}),
		alarm("23:00:00", "raised", {name: "c"})], none);
	const hours = hoursOf(all);
	assert.deepEqual([hours[10], hours[23], hours.reduce((a, b) => a + b)], [2, 1, 3]);
});

test("a value is so much over or under its limit, or within it again", () => {
	const signal = {decimals: 1, limits: {hh: null, h: 65, l: 10, ll: 5}};
	assert.equal(overWords(signal, "high", 66.2), "Limit 65.0, over it by 1.2");
	assert.equal(overWords(signal, "low", 9.8), "Limit 10.0, under it by 0.2");
	assert.equal(overWords(signal, "low low", 4), "Limit 5.0, under it by 1.0");
	assert.equal(overWords(signal, "high", 64), "Limit 65.0, within it again");
	assert.equal(overWords(signal, "high", null), "Limit 65.0");
	assert.equal(overWords(signal, "high high", 99), "");
	assert.equal(overWords({}, "stale", 1), "");
	assert.equal(limitOf(undefined, "high"), null);
	assert.deepEqual(["stale", "high"].map(isLost), [true, false]);
});

test("who it was is the person, else the user, and owsd by itself", () => {
	assert.equal(actorOf(ANNA), "anna, page");
	assert.equal(actorOf({program: "owsctl", user: "root", person: null}), "root, owsctl");
	assert.deepEqual([actorOf(null), actorOf("anna")], ["owsd", "anna"]);
});

test("a curve has its limit in its box, and a gap where nothing was good", () => {
	const {path, limit} = curveOf({x: [0, 10, 20, 30], last: [1, null, 3, 3]}, 0, 40, 5, 40, 26);
	assert.equal(path, "M0.0 23.0M20.0 13.0L30.0 13.0H40");
	assert.equal(limit, "3.0");
	assert.deepEqual(curveOf({x: [0], last: [null]}, 0, 40, 5, 40, 26), {path: "", limit: null});
	assert.equal(curveOf({x: [0, 10], last: [2, 2]}, 0, 20, null, 20, 26).path, "M0.0 13.0L10.0 13.0H20");
});

test("what is fetched anew and what was here before are each once, and leave no gap unseen", () => {
	const [a, b, c, d] = ["10:04:00", "10:03:00", "10:02:00", "10:01:00"].map((clock) =>
		alarm(clock, "raised"));
	assert.deepEqual(joined([a, b], [b, c, d], 2), [a, b, c, d]);
	assert.deepEqual(joined([a, b], [a, b, c], Infinity), [a, b, c]);
	assert.deepEqual(joined([a, b], [c, d], 2), [a, b], "between b and c others may be missing");
	assert.deepEqual(joined([a, b], [c, d], 3), [a, b, c, d], "these are all that there are");
	assert.deepEqual(joined([], [c], 2), []);
	const same = {...b, name: "other"}; // at the same time as b
	assert.deepEqual(joined([a, b], [same, b], Infinity), [a, b, same]);
});

test("entries that were here before the clock was set do not stand beside the same ones", () => {
	const [b, a] = [alarm("10:01:00", "returned", {number: 1}), alarm("10:00:00", "raised", {number: 0})];
	for (const hour of ["11", "09"]) {
		const later = [b, a].map((one) => ({...one, time: one.time.replace("T10", `T${hour}`)}));
		assert.deepEqual(joined(later, [b, a], 1000), later);
	}
	const slewed = [b, a].map((one) => ({...one, time: one.time.replace("00Z", "00.120Z")}));
	assert.equal(joined([slewed[0]], [b, a], 1000).length, 2, "drawn by some ms it was not set");
});
