// SPDX-License-Identifier: MIT
// The search for signals of a trend.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {found, often, searched} = await import("./page/picker.js");
const named = (...names) => names.map((name) => ({name, unit: "\u00b0C"}));
const names = (signals) => signals.map(({name}) => name);

test("a search finds words anywhere, and names that begin with it first", () => {
	const texts = searched([{name: "old_boiler"}, {name: "pump", description: "Boiler, flow"},
		{name: "boiler_flow"}, {name: "room", device: "28.FF"}]);
	assert.deepEqual(names(found(texts, "Boil").signals), ["boiler_flow", "old_boiler", "pump"]);
	assert.deepEqual(names(found(texts, "boiler flow").signals), ["boiler_flow", "pump"]);
	assert.deepEqual(names(found(texts, "28.ff").signals), ["room"]);
	assert.deepEqual(found(texts, "attic"), {count: 0, signals: []});
	assert.equal(found(texts, "").count, 4);
});

test("ten of 10 000 are shown, and all are counted, within 100 ms", () => {
	const texts = searched(named(...Array.from({length: 10000}, (_, n) => `sensor_${n}_flow`)));
	const begun = process.cpuUsage();
	const {count, signals} = found(texts, "sensor flow 99");
	assert.ok(process.cpuUsage(begun).user < 100e3); // of the processor's time, us
	assert.equal(signals.length, 10);
	assert.equal(count, texts.filter(({text}) => text.includes("99")).length);
});

test("signals of the same group are offered before those of the same unit", () => {
	const [flow, back, attic, rain] = [{name: "flow", unit: "\u00b0C", group: "Heating"},
		{name: "back", group: "Heating"}, {name: "attic", unit: "\u00b0C"}, {name: "rain", unit: "mm"}];
	assert.deepEqual(names(often([flow, rain, attic, back], [flow])), ["back", "attic"]);
	assert.deepEqual(often([flow], [flow]), []);
});
