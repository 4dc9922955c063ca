// SPDX-License-Identifier: MIT
// Differences and merges of texts: no line is lost, and no clash is hidden.
import assert from "node:assert/strict";
import {test} from "node:test";
import {compare, hunks, merge, patched} from "./page/diff.js";

let seed = 1;
const chance = (n) => {
	seed = (seed * 48271) % 2147483647;
	return seed % n;
};
const lines = (n, kinds) => Array.from({length: n}, () => "abcdefgh"[chance(kinds)]);

/* A text with some lines taken out, put in or turned. */
function changed(text, times) {
	const made = [...text];
	for (let n = 0; n < times; n++)
		made.splice(chance(made.length + 1), chance(3), ...lines(chance(3), 8));
	return made;
}

const merged = (base, mine, theirs) => {
	const both = merge([...base], [...mine], [...theirs]);
	return [both.lines.join(""), both.clashes.length];
};

test("a text with its difference to another is that other", () => {
	for (const [a, b] of [["", ""], ["", "ab"], ["ab", ""], ["abc", "abc"], ["abc", "axc"],
		["aaa", "aa"], ["abcabba", "cbabac"]])
		assert.equal(patched([...a], hunks([...a], [...b])).join(""), b);
	for (let n = 0; n < 500; n++) {
		const a = lines(chance(30), 1 + chance(6)), b = changed(a, chance(6));
		assert.deepEqual(patched(a, hunks(a, b)), b, JSON.stringify([a, b]));
	}
});

test("a difference is the shortest", () => {
	const cost = (a, b) => hunks([...a], [...b]).reduce((sum, one) =>
		sum + one.to - one.from + one.lines.length, 0);
	assert.equal(cost("abcabba", "cbabac"), 5);
	assert.equal(cost("abc", "abc"), 0);
	assert.equal(cost("aaaa", "aa"), 2);
	assert.equal(cost("abcd", "acbd"), 2);
});

test("texts that have nothing in common are one change, however long", () => {
	const a = Array.from({length: 1500}, (_, n) => `a${n}`);
	const b = Array.from({length: 1200}, (_, n) => `b${n}`);
	assert.deepEqual(patched(a, hunks(a, b)), b);
	assert.equal(hunks(a, b).length, 1);
});

test("hunks ascend and do not touch each other", () => {
	for (let n = 0; n < 200; n++) {
		const a = lines(20, 4), found = hunks(a, changed(a, 4));
		for (let k = 1; k < found.length; k++)
			assert.ok(found[k].from > found[k - 1].to, JSON.stringify(found));
	}
});

test("where one of two changed nothing the merge is the other, without a clash", () => {
	for (let n = 0; n < 300; n++) {
		const base = lines(chance(20), 5), other = changed(base, 3);
		assert.deepEqual(merge(base, other, base), {lines: other, clashes: []});
		assert.deepEqual(merge(base, base, other), {lines: other, clashes: []});
		assert.deepEqual(merge(base, other, other), {lines: other, clashes: []});
	}
});

test("changes at different places are both there", () => {
	assert.deepEqual(merged("abcd", "aXcd", "abcdY"), ["aXcdY", 0]);
	assert.deepEqual(merged("abcdef", "abXdef", "bcdef"), ["bXdef", 0]);
	assert.deepEqual(merged("abcdef", "bcdef", "abcde"), ["bcde", 0]);
	assert.deepEqual(merged("abcd", "aXcd", "abYd"), ["aXYd", 0], "lines beside each other");
});

test("where both changed the same line mine is taken, and the clash is told", () => {
	assert.deepEqual(merged("abc", "aMc", "aTc"), ["aMc", 1]);
	assert.deepEqual(merge(["a", "b", "c"], ["a", "M", "c"], ["a", "c"]).clashes,
		[{mine: ["M"], theirs: []}]);
	assert.deepEqual(merged("abc", "ac", "ac"), ["ac", 0]);
});

test("one change of mine over several of theirs is one place", () => {
	assert.deepEqual(merged("abcdef", "a1ef", "aXcYef"), ["a1ef", 1]);
	assert.deepEqual(merged("abcdef", "aXcYef", "a1ef"), ["aXcYef", 1]);
});

test("of lines that both inserted theirs come first", () =>
	assert.deepEqual(merged("ab}", "abM}", "abT}"), ["abTM}", 0]));

test("a key that both inserted stands there once, as mine, and is a clash if it differs", () => {
	const both = (mine, theirs) => {
		const {lines: got, clashes} = merge(["{", "}"], ["{", ...mine, "}"], ["{", ...theirs, "}"]);
		return [got.join(""), clashes.length];
	};
	assert.deepEqual(both([" Unit K", " Period 1"], [" Min 0", " Unit C"]),
		["{ Min 0 Unit K Period 1}", 1]);
	assert.deepEqual(both([" Unit K", " Max 1"], [" Min 0", " Unit K"]), ["{ Min 0 Unit K Max 1}", 0]);
});

test("items that both inserted are both there, though their keys have the same names", () => {
	const item = (name) => [`Item {`, `  Name "${name}"`, "}"];
	const {lines: got, clashes} = merge(["{", "}"], ["{", ...item("m"), "}"], ["{", ...item("t"), "}"]);
	assert.deepEqual(got, ["{", ...item("t"), ...item("m"), "}"]);
	assert.equal(clashes.length, 0);
});

test("no line of mine is lost in a merge", () => {
	for (let n = 0; n < 300; n++) {
		const base = Array.from({length: 12}, (_, k) => `line ${k}`);
		const mine = [...base], theirs = [...base];
		mine.splice(chance(12), chance(2), `mine ${n}`);
		theirs.splice(chance(12), chance(2), `theirs ${n}`);
		const {lines: got, clashes} = merge(base, mine, theirs);
		assert.ok(got.includes(`mine ${n}`), JSON.stringify(got));
		assert.ok(got.includes(`theirs ${n}`) || clashes.some((one) =>
			one.theirs.includes(`theirs ${n}`)), JSON.stringify([got, clashes]));
	}
});

test("a shown difference counts lines, and numbers them as the text has them", () => {
	const {added, removed, parts} = compare("a\nb\nc\nd\ne\nf\ng\nh\n", "a\nb\nX\nY\nd\ne\nf\ng\nh\n", 1);
	assert.deepEqual([added, removed], [2, 1]);
	assert.deepEqual(parts, [[[" ", "b", 2], ["-", "c", 3], ["+", "X", 3], ["+", "Y", 4], [" ", "d", 5]]]);
});

test("changes that are near each other are shown as one part, others apart", () => {
	const text = Array.from({length: 30}, (_, n) => `line ${n}`);
	const at = (...numbers) => compare(text.join("\n"),
		text.map((line, n) => numbers.includes(n) ? "new" : line).join("\n")).parts.length;
	assert.equal(at(3, 9), 1);
	assert.equal(at(3, 11), 2);
	assert.equal(at(), 0);
});
