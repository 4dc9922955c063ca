// SPDX-License-Identifier: MIT
// What the cells of the grid of items have: columns, what differs from the file, order, copies.

export const NOW = "now";
const PLAIN = {Name: "name", Path: "path", Type: "type", IO: "io"};
const order = new Intl.Collator("en", {numeric: true, sensitivity: "base"}).compare;

export const identityOf = ({path, keys}) => keys?.Identity ?? path;

/** Is a flag on? */
export const isOn = (text) => /^(on|yes|true|1)$/i.test(text);

/** The columns, with one more key of the user's choice: [{key, title}]. */
export const columns = (also, grouped) => [["Name"], ["Path"], ["Type"], ["IO", "I/O"],
	[NOW, "Now"], ["Unit"], ...also ? [[also]] : [], ...grouped && also !== "Group" ? [["Group"]] : []]
	.map(([key, title = key]) => ({key, title}));

/** The text of a key of an item as a cell shows it; "": it has none. */
export const textOf = (item, key) => (PLAIN[key] ? item[PLAIN[key]]
	: item.keys?.[key] === "" ? '""' : item.keys?.[key]) ?? "";

/** name: the item as the file has it, also under another name; null: the item is new. */
export function originals(items, saved) {
	const has = new Set(items.map(({name}) => name));
	const named = new Map(saved.map((item) => [item.name, item]));
	const gone = new Map(saved.filter(({name}) => !has.has(name))
		.map((item) => [identityOf(item), item]));
	return new Map(items.map((item) => [item.name,
		named.get(item.name) ?? gone.get(identityOf(item)) ?? null]));
}

/** What the file has in place of that text, "none" for nothing; null: the same. */
export function before(was, item, key) {
	if (!was || textOf(was, key) === textOf(item, key))
		return null;
	return textOf(was, key) || "none";
}

/** In the order of what of() returns, texts with their numbers as numbers; nothing comes last. */
export function sorted(items, of, down) {
	const empty = (value) => value === "" || value === null || value === undefined;
	const compare = (a, b) => typeof a === "number" && typeof b === "number" ? a - b
		: order(String(a), String(b));
	return items.map((item) => [of(item), item]).sort(([a], [b]) =>
		empty(a) || empty(b) ? empty(a) - empty(b) : (down ? -1 : 1) * compare(a, b))
		.map(([, item]) => item);
}

/** The next name that is free: "room2" after "room", "t010" after "t009". */
export function copyName(name, taken) {
	const [, stem, digits] = /^(.*?)(\d*)$/.exec(name);
	for (let n = BigInt(digits || 1) + 1n; ; n++) {
		const next = `${stem}${String(n).padStart(digits.length, "0")}`;
		if (!taken.has(next))
			return next;
	}
}

/** The edits that put a copy with that name behind an item. Its identity stays the item's own. */
export function copyOf(item, name) {
	const keys = Object.entries(item.keys).filter(([key]) => key !== "Identity")
		.map(([key, value]) => `${key}=${value}`).join("\n");
	return [{do: "add", name, path: item.path, keys},
		{do: "move", name, other: item.name, where: "after"}];
}

/** Where a key leads from the cell in row n and column k of so many; null: nowhere. */
export function stepTo({key, ctrlKey}, n, k, rows, last) {
	const steps = {ArrowUp: [n - 1, k], ArrowDown: [n + 1, k], ArrowLeft: [n, k - 1],
		ArrowRight: [n, k + 1], PageUp: [n - 10, k], PageDown: [n + 10, k],
		Home: [ctrlKey ? 0 : n, 0], End: [ctrlKey ? rows - 1 : n, last]}[key];
	return steps ? [Math.min(Math.max(steps[0], 0), rows - 1), Math.min(Math.max(steps[1], 0), last)]
		: null;
}
