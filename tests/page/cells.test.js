// SPDX-License-Identifier: MIT
// What the cells of the grid of items have, its order, its copies, and where keys lead.
import assert from "node:assert/strict";
import {test} from "node:test";

const {before, columns, copyName, copyOf, originals, sorted, stepTo, textOf}
	= await import("./page/cells.js");

const item = (name, path, keys = {}) => ({name, path, type: "double", io: "input", keys});

test("a cell has its key, and an empty text is seen", () => {
	const one = item("a", "/28/t", {LimitH: "60", PorAlarm: ""});
	assert.deepEqual(["Name", "Path", "Type", "IO", "LimitH", "PorAlarm", "Unit"]
		.map((key) => textOf(one, key)), ["a", "/28/t", "double", "input", "60", '""', ""]);
});

test("a column of the user's choice stands beside the fixed ones, and Group once", () => {
	const keys = (...given) => columns(...given).map(({key}) => key).slice(6);
	assert.deepEqual(keys("LimitH", true), ["LimitH", "Group"]);
	assert.deepEqual(keys("Group", true), ["Group"]);
	assert.deepEqual(keys("LimitH", false), ["LimitH"]);
});

test("a cell says what the file has, also where the item has another name there", () => {
	const saved = [item("a", "/1", {LimitH: "60"}), item("b", "/2"), item("gone", "/4")];
	const items = [item("a", "/1", {LimitH: "58"}), item("c", "/2", {LimitH: "1"}), item("d", "/3")];
	const was = originals(items, saved);
	assert.equal(before(was.get("a"), items[0], "LimitH"), "60");
	assert.equal(before(was.get("a"), items[0], "Path"), null);
	assert.equal(before(was.get("c"), items[1], "Name"), "b");
	assert.equal(before(was.get("c"), items[1], "LimitH"), "none");
	assert.equal(was.get("d"), null);
	assert.equal(before(null, items[2], "Name"), null);
});

test("numbers are sorted as numbers, and what has none is last either way", () => {
	const by = (down) => sorted(["t10", "", "t9", "T1"], (text) => text, down);
	assert.deepEqual(by(false), ["T1", "t9", "t10", ""]);
	assert.deepEqual(by(true), ["t10", "t9", "T1", ""]);
	assert.deepEqual(sorted([3, null, -1, 20], (n) => n, false), [-1, 3, 20, null]);
});

test("a copy has the next free name, the keys, and an identity of its own", () => {
	assert.equal(copyName("room", new Set(["room"])), "room2");
	assert.equal(copyName("room2", new Set(["room2", "room3"])), "room4");
	assert.equal(copyName("t009", new Set()), "t010");
	assert.deepEqual(copyOf(item("a", "/1", {Unit: "K", PorAlarm: "", Identity: "/0"}), "a2"), [
		{do: "add", name: "a2", path: "/1", keys: "Unit=K\nPorAlarm="},
		{do: "move", name: "a2", other: "a", where: "after"}]);
});

test("keys lead from cell to cell and not beyond the edge", () => {
	const to = (key, n, k, ctrlKey = false) => stepTo({key, ctrlKey}, n, k, 5, 3);
	assert.deepEqual(to("ArrowUp", 0, 1), [0, 1]);
	assert.deepEqual(to("ArrowDown", 1, 1), [2, 1]);
	assert.deepEqual(to("ArrowRight", 1, 3), [1, 3]);
	assert.deepEqual(to("PageDown", 1, 0), [4, 0]);
	assert.deepEqual(to("End", 1, 0), [1, 3]);
	assert.deepEqual(to("Home", 4, 2, true), [0, 0]);
	assert.equal(to("a", 1, 1), null);
});
