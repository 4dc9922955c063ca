// SPDX-License-Identifier: MIT
// The card of an alarm that stands, and what can be done with it.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import "./document.js";

const {AlarmCard, keyOf} = await import("./page/card.js");
const {store} = await import("./page/store.js");

beforeEach(() => {
	store.info = {writable: true};
	store.unknown = null;
	store.signals = [{name: "pump", type: "bool", good: false, code: 0x1c, value: null, alarm: null,
		measured: null, recent: []}];
});

function actions(alarm) {
	const card = new AlarmCard({});
	card.take({name: "pump", device: false, since: null, ...alarm}, true);
	return card.node.all.filter(({name}) => name === "button").map(({textContent}) => textContent);
}

test("an alarm of a limit is acknowledged or shelved, a shelved one unshelved", () => {
	assert.deepEqual(actions({alarm: "high", state: "unacknowledged"}),
		["Shelve\u2026", "Acknowledge"]);
	assert.deepEqual(actions({alarm: "high", state: "shelved", until: "2026-11-30T00:00:00Z"}),
		["Unshelve"]);
});

test("what ends with its cause has no buttons, which would act on another alarm of that name", () => {
	assert.deepEqual(actions({alarm: "device", device: true, state: "stands"}), []);
	assert.deepEqual(actions({alarm: "not as commanded", state: "stands"}), []);
});

test("each alarm of a signal has its own card, which it keeps while a limit alarm changes", () => {
	const of = (alarm, state, device = false) => keyOf({name: "pump", alarm, state, device});
	const all = [of("device", "stands", true), of("device", "cannot be reset: ResetLatch", true),
		of("high", "unacknowledged"), of("not as commanded", "stands")];
	assert.equal(new Set(all).size, all.length);
	assert.equal(of("high", "unacknowledged"), of("high", "acknowledged"));
});
