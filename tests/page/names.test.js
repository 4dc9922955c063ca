// SPDX-License-Identifier: MIT
// Names of signals that the page proposes or refuses, and ids of devices.
import assert from "node:assert/strict";
import {test} from "node:test";
import {faultOf, idOf, nameFor} from "./page/names.js";

const none = new Set();

test("an id is the same however it is written", () => {
	for (const text of ["28.A0B1C2000001", "28a0b1c2000001", "28.A0B1C2000001F3"])
		assert.equal(idOf(text), "28A0B1C2000001");
	assert.equal(idOf(null), "");
});

test("a name has 63 bytes at most, not 63 letters", () => {
	assert.equal(faultOf("a".repeat(63), none), "");
	assert.match(faultOf("a".repeat(64), none), /63 bytes/);
	assert.match(faultOf("\u00e9".repeat(32), none), /63 bytes/);
	assert.equal(faultOf("\u00e9".repeat(31), none), "");
});

test("blanks, and what cannot be seen, are in no name", () => {
	for (const wrong of ["a b", "a\tb", "a\nb", "a\u00a0b", "a\u202eb", "a\u200bb", "a\u0000b", "\ufeffa"])
		assert.match(faultOf(wrong, none), /no blank/, JSON.stringify(wrong));
});

test("what the file or a path would read otherwise is in no name", () => {
	for (const wrong of ["a/b", 'a"b', "a#b", "{a", "a}", ".", ".."])
		assert.match(faultOf(wrong, none), /has none of/, wrong);
	for (const right of ["a.b", "...", "caf\u00e9", "\u623f\u9593", "a=b", "a'b", "-a"])
		assert.equal(faultOf(right, none), "", right);
});

test("a name that is taken is refused, an empty one is asked for", () => {
	assert.match(faultOf("a", new Set(["a"])), /taken/);
	assert.match(faultOf("", none), /Enter/);
});

const device = (alias, ...words) => ({alias, properties: words.map((word) => ({word}))});

test("the alias of a device is its name, with the property where there are several", () => {
	const one = device("attic", "temperature"), two = device("attic", "temperature", "humidity");
	assert.equal(nameFor(one, one.properties[0], none), "attic");
	assert.equal(nameFor(two, two.properties[1], none), "attic_humidity");
});

test("an alias that is no name, or is taken, gives way to the word with a free number", () => {
	const taken = new Set(["attic", "temperature1"]);
	for (const alias of ["attic", "a b", "a\\x", null])
		assert.equal(nameFor(device(alias, "temperature"), {word: "temperature"}, taken), "temperature2");
});
