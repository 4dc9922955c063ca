// SPDX-License-Identifier: MIT
// What is shown of the special signals, and what can be done with them.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";

const {rowOf} = await import("./page/special.js");

const of = (name, value, more = {}) => rowOf({name, value, flag: false, readable: true,
	writable: false, ...more});

test("a counter is shown, and one without a value is not a number", () => {
	assert.equal(of("_PerCount", "7").text, "7");
	assert.equal(of("_PerCount", "7").act, null);
	assert.equal(of("_Age", null).text, "unknown");
	assert.equal(of("_Something", "1").words, "");
	assert.equal(of("_Age", "0.123456789").text, "0.12");
	assert.equal(of("_Raw", "0.123456789").text, "0.123456789");
});

test("a flag that can be read is a switch, and one that cannot is a button", () => {
	const flag = {flag: true, writable: true};
	assert.deepEqual([of("_ReadEnable", "1", flag)].map(({act, on, text}) => [act, on, text]),
		[["switch", true, "on"]]);
	assert.equal(of("_WriteEnable", "0", flag).text, "off");
	assert.deepEqual([of("_DGNRESET", null, {...flag, readable: false})]
		.map(({act, text}) => [act, text]), [["button", ""]]);
});
