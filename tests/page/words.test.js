// SPDX-License-Identifier: MIT
// Words, numbers and times of the page, and that qualities have the words that libows has.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {test} from "node:test";
import {dayText, moment, tickText} from "./page/when.js";
import {UNKNOWN, alarmOf, clock, dateAndClock, kindOf, meaningOf, msOf,
	qualityWords, remedyOf, span, stateOf, valueText, withUnit} from "./page/words.js";

const source = (path) => readFileSync(`${process.env.PAGE_SOURCE}/${path}`, "utf8");

/** [code, words] of libows, from its header and its table. */
function qualities() {
	const codes = new Map([...source("src/public/ows.h").matchAll(
		/(OWS_Q_\w+)\s*=\s*(0x[0-9a-f]+)/gi)].map(([, name, code]) => [name, Number(code)]));
	return [...source("src/ground/signal/words_list.h").matchAll(/^QUALITY\((\w+), \w+,\s*"([^"]+)"/gm)]
		.map(([, name, words]) => [codes.get(`OWS_Q_${name}`), words]);
}

test("each quality has the words that libows has, a meaning and a remedy", () => {
	const found = qualities();
	assert.ok(found.length > 12, JSON.stringify(found));
	for (const [code, words] of found) {
		assert.equal(typeof code, "number", words);
		assert.equal(qualityWords(code), words);
		if (stateOf(code) !== "good")
			assert.ok(meaningOf(code) && remedyOf(code), words);
	}
});

test("the state of a quality is in its two highest bits", () => {
	for (const [code, state] of [[0x00, "bad"], [0x08, "bad"], [0x3c, "bad"], [0x40, "uncertain"],
		[0x54, "uncertain"], [0x80, "bad"], [0xc0, "good"], [0xd8, "good"], [0xff, "good"]])
		assert.equal(stateOf(code), state, code.toString(16));
});

test("what was never read is uncertain, since nothing is wrong yet", () =>
	assert.equal(stateOf(0x20), "uncertain"));

test("unknown is no quality of owsd, and has no number of its own", () => {
	assert.equal(stateOf(UNKNOWN), "unknown");
	assert.equal(qualityWords(UNKNOWN), "unknown");
	assert.equal(remedyOf(UNKNOWN), "");
});

test("a code without words of its own is called by its state", () => {
	assert.equal(qualityWords(0xc1), "good");
	assert.equal(qualityWords(0x01), "bad");
});

test("a value that is not there is a dash, never a number", () => {
	for (const value of [null, undefined, NaN, Infinity, -Infinity])
		assert.equal(valueText({type: "double", decimals: 2}, value), "\u2014");
	assert.equal(valueText({type: "bool"}, null), "\u2014");
});

test("a switch is on or off, also as a number", () => {
	for (const [value, text] of [[true, "on"], [false, "off"], [1, "on"], [0, "off"], ["0", "off"]])
		assert.equal(valueText({type: "bool"}, value), text);
});

test("a number has the decimals of the configuration, nine at most, else seven digits", () => {
	for (const [decimals, value, text] of [[4, 21.5, "21.5000"], [0, 21.5, "22"], [1, 3, "3.0"],
		[20, 0.5, "0.500000000"], [-1, 21.123456789, "21.12346"], [undefined, 7, "7"],
		[-1, 1e-9, "1e-9"], [2, -0.001, "-0.00"], [null, 7.49, "7.49"], [null, 0.43, "0.43"]])
		assert.equal(valueText({type: "double", decimals}, value), text);
});

test("a number of 64 bits comes as a text and loses no digit", () =>
	assert.equal(valueText({type: "large"}, "9007199254740993"), "9007199254740993"));

test("a unit stands behind a value, not behind a dash", () => {
	assert.equal(withUnit({unit: "\u00b0C"}, "21.5"), "21.5\u202f\u00b0C");
	assert.equal(withUnit({unit: "\u00b0C"}, "\u2014"), "\u2014");
	assert.equal(withUnit({unit: ""}, "7"), "7");
});

test("an age is rounded down, and changes its unit before two of the next", () => {
	for (const [seconds, text] of [[-5, "now"], [0.99, "now"], [1, "1 s"], [89.9, "89 s"], [90, "1 min"],
		[5399, "89 min"], [5400, "1 h"], [172799, "47 h"], [172800, "2 d"], [null, "\u2014"],
		[undefined, "\u2014"], [Infinity, "\u2014"], [NaN, "\u2014"]])
		assert.equal(span(seconds), text, String(seconds));
});

test("a time is ms or a text, and what is neither is a dash", () => {
	assert.equal(msOf("1970-01-01T00:00:01Z"), 1000);
	assert.equal(msOf(5), 5);
	assert.equal(clock(3661000), "01:01:01");
	assert.equal(dateAndClock("2026-02-03T04:05:06Z"), "2026-02-03 04:05:06");
	for (const none of [null, undefined, "", "soon", NaN])
		assert.equal(clock(none), "\u2014", String(none));
});

test("a mark of an axis of time has what is new at it", () => {
	for (const [time, text] of [["2026-02-03T04:05:06Z", "04:05:06"], ["2026-02-03T04:05:00Z", "04:05"],
		["2026-02-03T00:05:00Z", "00:05"], ["2026-02-03T00:00:00Z", "3 Feb"],
		["2026-01-01T00:00:00Z", "2026"]])
		assert.equal(tickText(new Date(time)), text);
});

test("a time is said with as much of its date as it needs", () => {
	const now = Date.parse("2026-11-28T14:48:03Z");
	for (const [time, text] of [["2026-11-28T14:02:09Z", "14:02"],
		["2026-11-26T21:14:00Z", "Thu 21:14"], ["2026-11-29T08:00:00Z", "Sun 08:00"],
		["2026-11-12T08:30:00Z", "12 Nov 08:30"], ["2025-11-27T08:30:00Z", "2025-11-27"],
		[null, "\u2014"]])
		assert.equal(moment(time, now), text);
	assert.equal(dayText(now), "Sat 28 Nov");
});

test("an alarm with an exclamation mark wants eyes, and a dash is none", () => {
	for (const [words, text, open, turn, very] of [
		["! high, returned", "high, returned", true, "up", false],
		["high", "high", false, "up", false], ["! high high", "very high", true, "up", true],
		["! low low", "very low", true, "down", true], ["low", "low", false, "down", false],
		["! stale", "stale", true, "", false]])
		assert.deepEqual(alarmOf(words), {text, open, turn, very});
	for (const none of ["", "-", " ", null, undefined])
		assert.equal(alarmOf(none), null);
});

test("a chip of which no family is known is one of the code in its id", () => {
	assert.equal(kindOf({family: "DS18B20", device: "28.0123456789AB"}), "DS18B20");
	for (const family of [undefined, null, ""])
		assert.equal(kindOf({family, device: "28.0123456789AB"}), "Family 28");
});
