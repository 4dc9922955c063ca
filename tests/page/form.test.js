// SPDX-License-Identifier: MIT
// What the fields of a form show, and what they write.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {edits, shownOf, valueOf} = await import("./page/form.js");

const alarm = {key: "PorAlarm", kind: "text", empty: true};
const init = {key: "InitValue", kind: "text", empty: false};

test("an empty text that is a value is not shown as no key", () => {
	assert.equal(shownOf(alarm, undefined), "");
	assert.equal(shownOf(alarm, ""), '""');
	assert.equal(shownOf(alarm, "por"), "por");
	assert.equal(shownOf(init, ""), "");
});

test("what is shown is written again as it was", () => {
	for (const [option, values] of [[alarm, [null, "", "por", '"']], [init, [null, "1", '""']]])
		for (const value of values)
			assert.equal(valueOf(option, shownOf(option, value)), value, option.key);
});

test("an empty field takes the key out, and two quotes write an empty text", () => {
	assert.deepEqual(edits({PorAlarm: valueOf(alarm, "")}, "set", "unset", {name: "a"}),
		[{do: "unset", name: "a", keys: "PorAlarm"}]);
	assert.deepEqual(edits({PorAlarm: valueOf(alarm, '""')}, "set", "unset", {name: "a"}),
		[{do: "set", name: "a", keys: "PorAlarm="}]);
});
