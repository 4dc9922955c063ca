// SPDX-License-Identifier: MIT
// Groups of signals, their order, the filters of the view Live, and what of it the address keeps.
import {kindOf} from "./words.js";

export const SIMULATOR = "/simulator/"; // paths of outputs that disturb a simulated wire
const TAIL = 8; // characters at the end of a name that are never cut
const MANY = 60; // signals from which they are a list at first

/** A name in two parts: the first may be cut, the second not, as long names differ at the end. */
export function cut(name) {
	const all = [...name];
	return all.length <= 2 * TAIL ? [name, ""]
		: [all.slice(0, -TAIL).join(""), all.slice(-TAIL).join("")];
}

/** Where the signal is: "cabinet, terminal 1"; "": not known. */
export function placeOf({terminal}) {
	if (!terminal || typeof terminal === "string")
		return terminal || "";
	const {adapter, chip, channel} = terminal;
	return [adapter, chip, channel === null || channel === undefined ? ""
		: `terminal ${channel}`].filter(Boolean).join(", ");
}

/** [{title, members}] of rows; by Group, else by place if there are several, else by chip. */
export function groupsOf(rows) {
	const found = new Map(), few = [], last = [];
	const grouped = rows.some(({signal}) => signal.group);
	const placed = new Set(rows.map(({signal}) => placeOf(signal)).filter(Boolean)).size > 1;
	const by = grouped ? ({group}) => group : placed ? placeOf : ({device}) => device;
	for (const row of rows) {
		const key = by(row.signal);
		if (row.signal.path?.startsWith(SIMULATOR) && !row.signal.group)
			last.push(row);
		else if (!key)
			few.push(row);
		else if (!found.get(key)?.push(row))
			found.set(key, [row]);
	}
	const groups = [];
	for (const [key, members] of found)
		if (grouped || placed)
			groups.push({title: key, members});
		else if (members.length > 1)
			groups.push({title: `${kindOf(members[0].signal)} ${key}`, members});
		else
			few.push(...members);
	if (few.length)
		groups.push({title: groups.length ? "Others" : "Signals",
			members: few.sort((a, b) => rows.indexOf(a) - rows.indexOf(b))});
	if (last.length)
		groups.push({title: "Simulation", members: last});
	return groups;
}

/** Groups in so many columns: each goes to the one that is the shortest then. */
export function columnsOf(groups, n) {
	const columns = Array.from({length: n}, () => ({height: 0, groups: []}));
	for (const group of groups) {
		const least = columns.reduce((a, b) => b.height < a.height ? b : a);
		least.groups.push(group);
		least.height += group.members.length + 2;
	}
	return columns.map((column) => column.groups);
}

/** "groups", "list" or "wall", as was asked, else as suits so many. */
export const showOf = (asked, rows) => ["groups", "list", "wall"].includes(asked) ? asked
	: rows.length > MANY || rows.length > 1 && groupsOf(rows).length < 2 ? "list" : "groups";

// --- Order ----------------------------------------------------------------------------------

const words = new Intl.Collator("en", {numeric: true}); // localeCompare() is ten times as slow
const byName = (a, b) => words.compare(a.signal.name, b.signal.name);
const spread = ({signal}) => {
	const all = signal.recent.filter(({v}) => v !== null);
	return all.length ? Math.max(...all.map(({high}) => high)) - Math.min(...all.map(({low}) => low))
		: null;
};
const KEYS = {
	value: ({value}) => value === null || value === "" || Number.isNaN(Number(value)) ? null
		: Number(value),
	hour: spread,
	state: ({urgency}) => urgency,
	age: ({age}) => age,
	place: ({signal}) => placeOf(signal) || null,
};
export const COLUMNS = [["name", "Name"], ["value", "Value"], ["hour", "Last hour"],
	["state", "State"], ["age", "Age"], ["place", "Place"]];

/** Rows in an order: a key of COLUMNS, "-" before it: the greatest first; "": as in the file. */
export function sorted(rows, order) {
	const down = order.startsWith("-") ? -1 : 1, key = order.replace(/^-/, "");
	if (key === "name")
		return [...rows].sort((a, b) => down * byName(a, b));
	const of = KEYS[key];
	if (!of)
		return [...rows];
	const all = rows.map((row) => ({row, key: of(row)}));
	const compare = (a, b) => typeof a === "string" ? words.compare(a, b) : a - b;
	return all.sort((a, b) => (a.key === null) - (b.key === null)
		|| (a.key === null ? 0 : down * compare(a.key, b.key)) || byName(a.row, b.row))
		.map(({row}) => row);
}

// --- Filters --------------------------------------------------------------------------------

const TAGS = 8;  // groups that are filters, too
const UNITS = 4; // of more, those of one signal are no filter

const PLAIN = {
	bad: ({look}) => look.needs || look.edge === "initial",
	output: ({signal}) => signal.output,
	bool: ({signal}) => signal.type === "bool",
};

export function passes(row, {only, unit, group, from, to}) {
	const v = Number(row.value);
	return (!only || !PLAIN[only] || PLAIN[only](row)) && (!unit || row.signal.unit === unit)
		&& (!group || row.signal.group === group)
		&& (from === null || row.value !== null && v >= from && v < to);
}

/** What can be chosen: [{words, count, choice}], the first: all. listed: groups, too. */
export function choicesOf(rows, listed) {
	const counted = (key) => {
		const counts = new Map();
		for (const {signal} of rows)
			if (signal[key])
				counts.set(signal[key], (counts.get(signal[key]) ?? 0) + 1);
		return [...counts].map(([value, count]) => ({words: value, count, choice: {[key]: value}}));
	};
	const plain = (words_, only) => ({words: words_, choice: {only},
		count: rows.filter(PLAIN[only]).length});
	const units = counted("unit"), groups = listed ? counted("group") : [];
	return [{words: "All", count: rows.length, choice: {}}, plain("Not good", "bad"), ...units,
		plain("Outputs", "output"), plain("on / off", "bool"), ...groups.length <= TAGS ? groups : []]
		.filter(({count: n, choice}) => !Object.keys(choice).length || choice.only === "bad"
			|| n > 0 && n < rows.length && (n > 1 || units.length <= UNITS || !choice.unit));
}

// --- The address ----------------------------------------------------------------------------

const escape = (name) => name.replaceAll("%", "%25").replaceAll(",", "%2C");
const unescape = (name) => name.replaceAll("%2C", ",").replaceAll("%25", "%");
const TEXTS = ["q", "show", "order", "only", "unit", "group"];

/** What an address says: {q, show, order, only, unit, group, from, to, tiles, signal}. */
export function readAddress(text) {
	const query = new URLSearchParams(text), tiles = query.get("tiles");
	const number = (key) => query.get(key) && Number.isFinite(Number(query.get(key)))
		? Number(query.get(key)) : null;
	const from = number("from"), to = number("to");
	return {...Object.fromEntries(TEXTS.map((key) => [key, query.get(key) ?? ""])),
		from: to === null ? null : from, to: from === null ? null : to,
		tiles: tiles === null ? null : tiles.split(",").filter(Boolean).map(unescape),
		signal: query.get("signal")};
}

export function writeAddress(state) {
	const query = new URLSearchParams();
	for (const key of TEXTS)
		if (state[key])
			query.set(key, state[key]);
	if (state.from !== null) {
		query.set("from", state.from);
		query.set("to", state.to);
	}
	if (state.tiles)
		query.set("tiles", state.tiles.map(escape).join(","));
	const text = String(query).replaceAll("%2C", ",");
	return `#live${text ? `?${text}` : ""}`;
}

export const toggled = (names, name) =>
	names.includes(name) ? names.filter((one) => one !== name) : [...names, name];

export function moved(names, name, by) {
	const from = names.indexOf(name), to = Math.min(names.length - 1, Math.max(0, from + by));
	const out = names.filter((one) => one !== name);
	out.splice(to, 0, name);
	return out;
}
