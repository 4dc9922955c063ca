// SPDX-License-Identifier: MIT
// Differences of texts by lines: Myers' shortest edit script within bounds, and the merge of two
// changed texts over the one that both began with.

const MOST = 1000; // changed lines that are told apart; beyond, all between is one change

/* Pairs [i, j] of equal lines, ascending: a[i] is b[j]. */
function matches(a, b) {
	const n = a.length, m = b.length, most = Math.min(n + m, MOST), o = most + 1;
	const reach = new Int32Array(2 * most + 3), trace = [];
	const down = (v, k, d) => k === -d || (k !== d && v[o + k - 1] < v[o + k + 1]);
	for (let d = 0; d <= most; d++) {
		trace.push(reach.slice());
		for (let k = -d; k <= d; k += 2) {
			let x = down(reach, k, d) ? reach[o + k + 1] : reach[o + k - 1] + 1;
			while (x < n && x - k < m && a[x] === b[x - k])
				x++;
			reach[o + k] = x;
			if (x >= n && x - k >= m)
				return walkBack(trace, n, m, (v, k2, d2) => down(v, k2, d2) ? k2 + 1 : k2 - 1, o);
		}
	}
	return [];
}

function walkBack(trace, n, m, before, o) {
	const pairs = [];
	let x = n, y = m;
	for (let d = trace.length - 1; d >= 0; d--) {
		const k = before(trace[d], x - y, d), px = trace[d][o + k];
		while (x > px && y > px - k)
			pairs.push([--x, --y]);
		x = px;
		y = px - k;
	}
	return pairs.reverse();
}

/** What to change in the lines a to get b: [{from, to, lines}], to replace a[from] to a[to - 1]. */
export function hunks(a, b) {
	let head = 0, tail = 0;
	const least = Math.min(a.length, b.length);
	while (head < least && a[head] === b[head])
		head++;
	while (tail < least - head && a[a.length - 1 - tail] === b[b.length - 1 - tail])
		tail++;
	const found = [];
	let x = head, y = head;
	const end = [a.length - tail - head, b.length - tail - head];
	const pairs = matches(a.slice(head, a.length - tail), b.slice(head, b.length - tail));
	for (const [i, j] of [...pairs, end]) {
		if (x < head + i || y < head + j)
			found.push({from: x, to: head + i, lines: b.slice(y, head + j)});
		x = head + i + 1;
		y = head + j + 1;
	}
	return found;
}

/** The lines a with these hunks in them, or those from a[from] to a[to - 1] alone. */
export function patched(a, changes, from = 0, to = a.length) {
	const lines = [];
	let at = from;
	for (const change of changes) {
		lines.push(...a.slice(at, change.from), ...change.lines);
		at = change.to;
	}
	return [...lines, ...a.slice(at, to)];
}

const empty = (one) => one.from === one.to;
const meet = (a, b) => (empty(a) && empty(b) ? a.from === b.from
	: a.from < b.to && b.from < a.to);

/* All hunks of both lists that meet each other, beginning with the first; they leave the lists. */
function take(left, right) {
	const first = [left[0], right[0]].filter(Boolean).sort((a, b) =>
		a.from - b.from || a.to - b.to)[0];
	const region = {from: first.from, to: first.to, mine: [], theirs: []};
	for (let grown = true; grown;) {
		grown = false;
		for (const [list, into] of [[left, region.mine], [right, region.theirs]])
			if (list.length && (list[0] === first || meet(list[0], region))) {
				region.to = Math.max(region.to, list[0].to);
				into.push(list.shift());
				grown = true;
			}
	}
	return region;
}

const keyOf = (line) => /^\s*([A-Za-z]\w*)\s/.exec(line)?.[1];
const plain = (lines) => !lines.some((line) => /[{}]/.test(line));

/* Lines that both inserted at one place of one block: a key of both stands there once, as mine. */
function join(here, there) {
	const keys = new Set(plain(here) && plain(there) ? here.map(keyOf).filter(Boolean) : []);
	const doubled = there.filter((line) => keys.has(keyOf(line)));
	return {lines: [...there.filter((line) => !doubled.includes(line)), ...here],
		clash: doubled.some((line) => !here.includes(line))};
}

/**
 * Both changes of the base: {lines, clashes}. Where both changed the same lines, mine are taken,
 * and clashes has {mine, theirs} of the place; where both inserted, theirs come first, but for keys
 * that mine have too.
 */
export function merge(base, mine, theirs) {
	const left = hunks(base, mine), right = hunks(base, theirs), clashes = [], changes = [];
	while (left.length || right.length) {
		const region = take(left, right), {from, to} = region;
		const here = patched(base, region.mine, from, to);
		const there = patched(base, region.theirs, from, to);
		let lines = region.mine.length ? here : there;
		if (region.mine.length && region.theirs.length && here.join("\n") !== there.join("\n")) {
			const both = from === to ? join(here, there) : {lines, clash: true};
			({lines} = both);
			if (both.clash)
				clashes.push({mine: here, theirs: there});
		}
		changes.push({from, to, lines});
	}
	return {lines: patched(base, changes), clashes};
}

/** {added, removed, parts}: parts are lists of [" ", "+" or "-", line, number], with context. */
export function compare(before, after, context = 3) {
	const a = before.split("\n"), b = after.split("\n"), groups = [];
	let added = 0, removed = 0, shift = 0;
	for (const change of hunks(a, b)) {
		if (groups.length && change.from - groups.at(-1).at(-1).to <= 2 * context)
			groups.at(-1).push(change);
		else
			groups.push([change]);
	}
	const parts = groups.map((group) => {
		const part = [];
		const keep = (from, to) => {
			for (let n = from; n < to; n++)
				part.push([" ", a[n], n + 1 + shift]);
		};
		let at = Math.max(0, group[0].from - context);
		for (const {from, to, lines} of group) {
			keep(at, from);
			for (at = from; at < to; at++)
				part.push(["-", a[at], at + 1]);
			lines.forEach((line, n) => part.push(["+", line, from + shift + n + 1]));
			added += lines.length;
			removed += to - from;
			shift += lines.length - (to - from);
		}
		keep(at, Math.min(at + context, a.length));
		return part;
	});
	return {added, removed, parts};
}
