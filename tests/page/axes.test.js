// SPDX-License-Identifier: MIT
// Axes: labels never collide, whatever the width, and stand at round places of local time.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {apart, numberTicks, shares, timeTicks} = await import("./page/axes.js");
const NOW = Date.UTC(2026, 10, 29, 12, 34, 56), HOUR = 3600000, DAY = 24 * HOUR;

test("marks of time are apart by what a label needs, and some are there", () => {
	for (const span of [2000, 600000, 7000000, 8 * HOUR, DAY, 7 * DAY, 30 * DAY, 500 * DAY, 9000 * DAY])
		for (const width of [300, 500, 700, 1000, 1300, 2300]) {
			const ticks = timeTicks(NOW - span, NOW, width);
			const places = ticks.map(({v}) => (v - NOW + span) / span * width);
			for (let n = 1; n < places.length; n++)
				assert.ok(places[n] - places[n - 1] > (span > 20 * DAY ? 60 : 71.9)
					|| ticks[n].label.length < 7, `${span} ${width} ${places}`);
			assert.ok(ticks.length >= Math.min(2, Math.floor(width / 200)) && places.every((x) => x >= 0
				&& x <= width), `${span} ${width}: ${ticks.map(({label}) => label)}`);
		}
});

test("marks stand where they are while the window moves", () => {
	for (const span of [600000, DAY, 30 * DAY]) {
		const one = timeTicks(NOW - span, NOW, 900).map(({v}) => v);
		const two = timeTicks(NOW - span + 1000, NOW + 1000, 900).map(({v}) => v);
		assert.ok(one.slice(1, -1).every((v) => two.includes(v)), String(span));
	}
});

test("marks of hours stand at local midnight too, which is labelled with its day", () => {
	const midnight = new Date(2026, 10, 29).getTime();
	const ticks = timeTicks(midnight - 12 * HOUR, midnight + 12 * HOUR, 900);
	assert.ok(ticks.some(({v, label}) => v === midnight && label === "29 Nov"), ticks);
	assert.equal(timeTicks(midnight - 40 * DAY, midnight, 900).filter(({label}) =>
		/^\d+ \w{3}$/.test(label)).length, timeTicks(midnight - 40 * DAY, midnight, 900).length);
});

test("values that differ by rounding alone have few marks, not marks for ever", () => {
	for (const [from, until] of [[21.3, 21.300000000000004], [-1e-9, -1e-9 * (1 - 2 ** -52)],
		[1e16, 1e16 + 2], [1e308, 1e308 * (1 + 2 ** -52)], [5, 5], [0, 0]])
		for (const height of [0, 96, 200, 400])
			assert.ok(numberTicks(from, until, height).length <= 12, `${from} ${until} ${height}`);
});

test("marks of numbers are round, and have the digits of their step", () => {
	assert.deepEqual(numberTicks(-0.24, 1.1, 144).map(({label}) => label), ["0.0", "0.5", "1.0"]);
	assert.deepEqual(numberTicks(18, 72, 220).map(({label}) => label),
		["20", "30", "40", "50", "60", "70"]);
	assert.deepEqual(numberTicks(0, 3e6, 120).map(({label}) => label),
		["0", "1.0e+6", "2.0e+6", "3.0e+6"]);
	for (const [from, until] of [[0, 1e-4], [-1000, 3], [1e8, 1e8 + 7]]) {
		const ticks = numberTicks(from, until, 400);
		assert.ok(ticks.length >= 4 && ticks.length <= 12, ticks);
	}
});

test("the first plot has two thirds of the height, and none less than it needs", () => {
	assert.deepEqual(shares(1, 600, 90), [600]);
	assert.deepEqual(shares(2, 600, 90), [400, 200]);
	assert.deepEqual(shares(3, 300, 90), [120, 90, 90]);
	assert.deepEqual(shares(2, 100, 90), [90, 90]);
	assert.deepEqual(shares(0, 100, 90), []);
});

test("names at the ends of curves are pushed apart, and stay in their order and in the plot", () => {
	assert.deepEqual(apart([50, 10, 12], 16, 200), [50, 10, 26]);
	assert.deepEqual(apart([198, 190, 199], 16, 200), [184, 168, 200]);
	assert.deepEqual(apart([-20, -20], 16, 200), [0, 16]);
});
