// SPDX-License-Identifier: MIT
// Where chips are on the terminals of adapters, and what is said to be wrong there.
import assert from "node:assert/strict";
import {test} from "node:test";

const {faultsOf, terminalsOf} = await import("./page/terminals.js");

const GOOD = 0xc0, ABSENT = 0x08, DOWN = 0x18, SHORT = 0x19, INITIAL = 0x20, RANGE = 0x54;
const signal = (name, device, code = GOOD, more = {}) =>
	({name, device, code, good: code === GOOD, family: "DS18B20", ...more});
const device = (id, target, channel, more = {}) => ({id, target, channel, errors: 0, ...more});
const target = (name, state = "up", note = null) => ({name, state, note});

const CABINET = {
	targets: [target("cabinet"), target("garden")],
	devices: [device("28.A", "cabinet", 0, {errors: 2}), device("28.B", "cabinet", 2, {errors: 3}),
		device("28.C", "cabinet", 2), device("28.D", "garden", 0), device("28.E", null, null)],
	load: new Map([["cabinet", 40], ["garden", 9]]),
	share: new Map([["28.A", 3], ["28.B", 1.5], ["28.C", 1]]),
};
const HOUSE = [signal("flow", "28.A"), signal("bath", "28.b"), signal("bath_min", "28.b", RANGE),
	signal("office", "28.C", ABSENT), signal("tank", "28.D"), signal("attic", "28.E", ABSENT),
	signal("sum", null)];
const brief = (list) => list.map(({name, label, chips}) => [name, label, chips.length]);

test("a terminal is a wire of an adapter; one without a chip before another is shown, empty", () =>
	assert.deepEqual(brief(terminalsOf(HOUSE, CABINET)), [
		["terminal 0 of cabinet", "0", 1], ["terminal 1 of cabinet", "1", 0],
		["terminal 2 of cabinet", "2", 2], ["terminal 0 of garden", "0", 1],
		["an adapter that is not known", "all", 1]]));

test("a terminal has the errors of its chips and their load, a lone one that of its adapter", () => {
	const [flow, empty, bath, garden, lost] = terminalsOf(HOUSE, CABINET);
	assert.deepEqual([flow.load, flow.errors], [3, 2]);
	assert.deepEqual([empty.load, empty.errors], [null, 0]);
	assert.deepEqual([bath.load, bath.errors], [2.5, 3]);
	assert.deepEqual([garden.load, lost.load], [9, null]);
});

test("an adapter that counts its wires has all its terminals, with their own load and errors", () => {
	const wires = new Map([["cabinet", [{load: 30, errors: 7}, {load: 0, errors: 1},
		{load: null, errors: 0}, null]], ["garden", []]]);
	const found = terminalsOf(HOUSE, {...CABINET, wires});
	assert.deepEqual(found.filter(({adapter}) => adapter === "cabinet").map((one) =>
		[one.label, one.chips.length, one.load, one.errors]),
	[["0", 1, 30, 7], ["1", 0, 0, 1], ["2", 2, null, 0], ["3", 0, null, 0]]);
	const empty = {targets: [target("far")], wires: new Map([["far", [null, null]]])};
	assert.deepEqual(brief(terminalsOf([], empty)),
		[["terminal 0 of far", "0", 0], ["terminal 1 of far", "1", 0]]);
});

test("a chip is as bad as its worst signal, and answers unless nothing comes of it", () => {
	const chips = terminalsOf(HOUSE, CABINET).flatMap((terminal) => terminal.chips);
	const [, bath, office] = chips;
	assert.deepEqual([bath.code, bath.answers, bath.signals.length], [RANGE, true, 2]);
	assert.deepEqual([office.code, office.answers], [ABSENT, false]);
});

test("where one adapter has one wire, a chip that never answered is on it", () => {
	const stats = {targets: [target("usb")], devices: [device("28.A", "usb", 0)]};
	assert.deepEqual(brief(terminalsOf([signal("flow", "28.A"), signal("attic", "28.E", ABSENT)],
		stats)), [["terminal 0 of usb", "0", 2]]);
});

test("wires that are not known are one place, beside those that are with a question mark", () => {
	const far = {targets: [target("far")], devices: [device("28.A", "far", null)]};
	assert.deepEqual(brief(terminalsOf([signal("flow", "28.A")], far)), [["far", "all", 1]]);
	const part = {targets: [target("far")], devices: [device("28.A", "far", 1)]};
	assert.deepEqual(brief(terminalsOf([signal("flow", "28.A"), signal("attic", "28.E")], part)),
		[["terminal 0 of far", "0", 0], ["terminal 1 of far", "1", 1], ["far", "?", 1]]);
	assert.deepEqual(brief(terminalsOf([signal("flow", "28.A")], null)),
		[["an adapter that is not known", "all", 1]]);
});

const faults = (signals, stats) => faultsOf(signals, stats.targets, terminalsOf(signals, stats));
const titles = (signals, stats) => faults(signals, stats).map(({title}) => title);

test("each terminal has its own short, with the signals that are lost", () => {
	const short = HOUSE.map((one) => one.name === "flow" || one.device === "28.b"
		? {...one, code: SHORT, good: false} : one);
	const [first, second] = faults(short, CABINET);
	assert.equal(first.title, "Short on terminal 2 of cabinet");
	assert.deepEqual(first.signals.map(({name}) => name), ["bath", "bath_min"]);
	assert.equal(second.title, "Short on terminal 0 of cabinet");
});

test("a chip that does not answer is named with its place, its id and its neighbours", () => {
	const [range, office, attic] = faults(HOUSE, CABINET);
	assert.deepEqual([range.title, range.state], ["out of range: 1 signal", "uncertain"]);
	assert.equal(office.title, "office does not answer");
	assert.ok(office.sentences.includes(
		"DS18B20 28.C on terminal 2 of cabinet. All others there answer."), office.sentences);
	assert.equal(attic.title, "attic does not answer");
	assert.ok(office.remedy.includes("owsctl scan"), office.remedy);
});

test("an adapter that is down is one fault with its reason and what it has lost", () => {
	const stats = {...CABINET, targets: [target("cabinet"), target("garden", "down", "no answer")]};
	const lost = HOUSE.map((one) => one.name === "tank" ? {...one, code: DOWN, good: false} : one);
	const [down, ...others] = faults(lost, stats);
	assert.equal(down.title, "garden is down");
	assert.deepEqual(down.sentences, ["no answer."]);
	assert.deepEqual(down.signals.map(({name}) => name), ["tank"]);
	assert.ok(!others.some(({signals}) => signals.some(({name}) => name === "tank")));
	assert.deepEqual(titles([], stats), ["garden is down"]);
});

test("what was not read yet is not wrong", () =>
	assert.deepEqual(titles([signal("flow", "28.A", INITIAL)], CABINET), []));
