// SPDX-License-Identifier: MIT
// Windows of time that people type, and how a window is written.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {besideOf, daysLater, lastNight, windowOf, windowText} = await import("./page/when.js");
const HOUR = 3600000, DAY = 24 * HOUR;
const NOW = new Date(2026, 10, 28, 19, 30).getTime(); // a Saturday
const at = (day, hour, minute = 0, month = 10, year = 2026) =>
	new Date(year, month, day, hour, minute).getTime();

test("the last night is from 18:00 to 08:00, or until now", () => {
	assert.deepEqual(lastNight(at(28, 10)), [at(27, 18), at(28, 8)]);
	assert.deepEqual(lastNight(at(28, 3)), [at(27, 18), at(28, 3)]);
	assert.deepEqual(lastNight(at(28, 22)), [at(27, 18), at(28, 8)]);
});

test("a window is understood as people say it", () => {
	for (const [text, from, until] of [
		["yesterday", at(27, 0), at(28, 0)], ["Yesterday 18:00", at(27, 18), at(27, 19)],
		["today 6", at(28, 6), at(28, 7)], ["18:00", at(28, 18), at(28, 19)],
		["18:00 - 19:15", at(28, 18), at(28, 19, 15)], ["fri 22:00 to 6:00", at(27, 22), at(28, 6)],
		["Friday 18:00 - Sat 6:00", at(27, 18), at(28, 6)], ["17:00 \u2013 now", at(28, 17), NOW],
		["12 Nov 8:30", at(12, 8, 30), at(12, 9, 30)], ["12 Nov", at(12, 0), at(13, 0)],
		["24 Dec", at(24, 0, 0, 11, 2025), at(25, 0, 0, 11, 2025)],
		["2026-11-01", at(1, 0), at(2, 0)], ["2026-11-01 10:00", at(1, 10), at(1, 11)],
		["2026-11-01 to 2026-11-08", at(1, 0), at(9, 0)], ["last night", at(27, 18), at(28, 8)],
		["  FRI   18:00 ", at(27, 18), at(27, 19)]])
		assert.deepEqual(windowOf(text, NOW, HOUR), [from, until], text);
});

test("what is no window is refused", () => {
	for (const text of ["", "soon", "25:00", "12:60", "30 Feb", "2026-13-01", "yesterday - ",
		"18:00 to soon"])
		assert.equal(windowOf(text, NOW, HOUR), null, text);
});

test("an end before the begin is the last night, or not turned round", () => {
	for (const [text, from, until] of [["22:00 - 6:00", at(27, 22), at(28, 6)],
		["19:00 to 18:00", at(28, 19), at(28, 18)], ["10:24 - 10:20", at(28, 10, 24), at(28, 10, 20)],
		["Fri 10:24 - 10:20", at(27, 10, 24), at(27, 10, 20)],
		["23:00 - now", at(28, 23), NOW],
		["2026-11-08 to 2026-11-01", at(8, 0), at(2, 0)]])
		assert.deepEqual(windowOf(text, NOW, HOUR), [from, until], text);
	assert.deepEqual(windowOf("23:00 - now", at(28, 9), HOUR), [at(27, 23), at(28, 9)]);
});

test("a window is written with as much of its dates as it needs, and can be read again", () => {
	for (const [from, until, text] of [[at(28, 18), null, "18:00 \u2013 now"],
		[at(28, 18), at(28, 19), "18:00 \u2013 19:00"],
		[at(27, 18), at(28, 18), "Fri 27 Nov 18:00 \u2013 Sat 18:00"],
		[at(27, 18), null, "Fri 27 Nov 18:00 \u2013 now"],
		[at(1, 0), at(20, 12), "Sun 1 Nov 00:00 \u2013 Fri 20 Nov 12:00"],
		[at(3, 4, 0, 1, 2025), at(3, 5, 0, 1, 2025), "Mon 3 Feb 2025 04:00 \u2013 05:00"]]) {
		assert.equal(windowText(from, until, NOW), text);
		assert.deepEqual(windowOf(text, NOW, HOUR), [from, until ?? NOW], text);
	}
	assert.equal(windowText(at(28, 18), at(28, 18, 1), NOW), "18:00:00 \u2013 18:01:00");
});

test("days are counted by the calendar, and a longer window is compared with a longer time ago", () => {
	assert.equal(daysLater(at(28, 18), -1), at(27, 18));
	assert.deepEqual([HOUR, DAY, 2 * DAY, 30 * DAY].map((span) => besideOf(span)[0]), [1, 1, 7, 28]);
});
