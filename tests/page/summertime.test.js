// SPDX-License-Identifier: MIT
// Days of 25 and of 23 hours in what happened.
import assert from "node:assert/strict";
import {test} from "node:test";
import {clock, server} from "./browser.js";
import "./document.js";

process.env.TZ = "Europe/Prague"; // summer time ends on 25 October 2026, and began on 29 March

const {hourOf, hoursOf} = await import("./page/happened.js");
const journal = await import("./page/journal.js");

test("an alarm stands in the hour that the clock showed", () => {
	assert.equal(new Date("2026-10-25T13:20Z").getHours(), 14, "the time zone is known here");
	for (const [time, hour] of [["2026-10-25T13:20Z", 14], ["2026-10-25T22:30Z", 23],
		["2026-10-25T00:30Z", 2], ["2026-10-25T01:30Z", 2], ["2026-03-29T01:30Z", 3],
		["2026-03-29T21:30Z", 23]]) {
		assert.equal(hourOf({time: Date.parse(time)}), hour, time);
		assert.equal(hoursOf([{time: Date.parse(time)}])[hour], 1, time);
	}
});

test("the seven days stay the same ones all day, also in the week after a change", async () => {
	server.answers["api/journal"] = (query) => {
		asked.push(Number(query.get("since")));
		return {entries: []};
	};
	const asked = [];
	journal.build(document.body);
	const day = document.body.find((one) => one.getAttribute("id") === "day");
	for (const [now, first] of [["2026-10-28T22:30Z", "2026-10-21T22:00Z"],
		["2026-03-31T22:30Z", "2026-03-25T23:00Z"],
		["2026-10-25T12:00Z", "2026-10-18T22:00Z"], ["2026-07-01T12:00Z", "2026-06-24T22:00Z"]]) {
		clock.wall = Date.parse(now) - clock.now;
		await journal.look();
		const made = day.firstChild;
		assert.equal(Number(day.lastChild.value), Date.parse(first), now);
		assert.equal(asked.at(-1), Date.parse(first));
		assert.equal(new Set(day.children.map(({value}) => value)).size, 7);
		await journal.look();
		assert.equal(day.firstChild, made, "nothing is made anew: the choice stays");
	}
});
