// SPDX-License-Identifier: MIT
// What the journals mean: one line for a whole happening, from raised to returned; by how much a
// value is beyond its limit.
import {msOf, valueText, withUnit} from "./words.js";

export const SLEW_MS = 1000; // by less a clock is drawn to the right time between two answers
const START_MS = 10000; // outputs that take their first value within it do so at one start
const LIMITS = {"high high": "hh", high: "h", low: "l", "low low": "ll"};
const LOST = ["bad", "stale", "not as commanded"];

/** The limit of this kind of alarm; null: it has none. */
export const limitOf = (signal, kind) => signal?.limits?.[LIMITS[kind]] ?? null;

/** Does this kind say that nobody can see the signal? */
export const isLost = (kind) => LOST.includes(kind);

/** "Limit 65.0, over it by 1.2"; "" for an alarm without a limit. */
export function overWords(signal, kind, value) {
	const limit = limitOf(signal, kind);
	if (limit === null)
		return "";
	const text = `Limit ${valueText(signal, limit)}`;
	const number = Number(value ?? NaN);
	const by = kind.startsWith("high") ? number - limit : limit - number;
	if (Number.isNaN(by))
		return text;
	const way = kind.startsWith("high") ? "over" : "under";
	return by > 0 ? `${text}, ${way} it by ${valueText(signal, by)}` : `${text}, within it again`;
}

/** Who it was, in few words: "anna, owsctl". */
export function actorOf(by) {
	if (!by || typeof by === "string")
		return by || "owsd";
	return [by.person ?? by.user, by.program].filter(Boolean).join(", ");
}

function commandWords({event, value}, signal) {
	const text = withUnit(signal ?? {}, valueText(signal ?? {}, value));
	return event === "set" ? `set ${text}` : `${event}: ${text}`;
}

/**
 * Entries of the journals, in any order, as happenings, newest first: {time, name, journal, alarm,
 * what, value, ended, over, seen, by, more}. ended: ms, null: not that one knows; over: it
 * has ended though. seen: {time, by} of who acknowledged it. find(name): the signal.
 */
export function happenings(entries, find) {
	const all = [], open = new Map();
	let start = null;
	for (const entry of [...entries].sort((a, b) => msOf(a.time) - msOf(b.time))) {
		const {name, journal, alarm, event, value} = entry, time = msOf(entry.time);
		const key = `${name} ${alarm}`, raised = open.get(key);
		if (event === "returned" && raised) {
			raised.ended = time;
			open.delete(key);
			continue;
		}
		if (event === "acknowledged" && raised) {
			raised.seen = {time, by: actorOf(entry.by)};
			continue;
		}
		const one = {time, name: name ?? "", journal, alarm, value: alarm ? value : null, ended: null,
			over: false, seen: null, by: actorOf(entry.by),
			more: [entry.more ? `${entry.more} more before` : "", entry.remark].filter(Boolean).join("; "),
			what: alarm ? event : commandWords(entry, find(name))};
		if (event === "raised") {
			if (raised)
				raised.over = true; // it is raised anew: of this one nobody knows the end
			open.set(key, one);
		} else if (event === "InitValue" && !entry.by) {
			if (start && time - start.time < START_MS) {
				start.names.push(name);
				continue;
			}
			start = Object.assign(one, {names: [name]});
		}
		all.push(one);
	}
	for (const one of all.filter(({names}) => names?.length > 1)) {
		one.what = `${one.names.length} outputs took their first value`;
		one.name = "owsd";
	}
	return all.reverse();
}

/** Which entry it is: of those that owsd has in memory the time follows the clock. */
export const entryOf = (one) => Number.isInteger(one.number)
	? `${one.journal} ${one.number} ${one.name}` : JSON.stringify(one);

/** Was the clock set between two answers? What is in both has another time then. */
export function clockWasSet(newer, older) {
	const times = new Map(newer.map((one) => [entryOf(one), msOf(one.time)]));
	const both = older.find((one) => times.has(entryOf(one)));
	return both !== undefined && Math.abs(times.get(entryOf(both)) - msOf(both.time)) > SLEW_MS;
}

/**
 * Newer entries before older ones, both newest first, and each once. Of newer ones that are as many
 * as are asked for at once, and begin after all older ones, those between are missing: then they
 * stand alone, as after the clock was set.
 */
export function joined(newer, older, most) {
	if (!newer.length || clockWasSet(newer, older))
		return newer;
	const end = msOf(newer.at(-1).time), kept = new Set(newer.map(entryOf));
	if (newer.length >= most && older.length && msOf(older[0].time) < end)
		return newer;
	return [...newer, ...older.filter((one) => msOf(one.time) <= end && !kept.has(entryOf(one)))];
}

/** Has it all these words somewhere? */
export function matches(one, words) {
	const {name, alarm, what, by, more, seen, names} = one;
	const text = [name, alarm, what, by, more, seen?.by, ...names ?? []].join(" ").toLowerCase();
	return words.every((word) => text.includes(word));
}

/** The hour of the day when it began, by the clock; one of the autumn is there twice. */
export const hourOf = ({time}) => new Date(time).getHours();

/** How many began in each hour of their day. */
export function hoursOf(all) {
	const hours = new Array(24).fill(0);
	for (const one of all)
		hours[hourOf(one)]++;
	return hours;
}

/**
 * The path of a curve in a box, and the height of its limit (null: outside or none); columns x (ms)
 * and last (null: a gap). {path: "", limit: null, most, least} if nothing can be drawn.
 */
export function curveOf({x, last}, from, until, limit, width, height) {
	const known = last.filter((v, n) => v !== null && x[n] >= from);
	const least = Math.min(...known, ...limit === null ? [] : [limit]);
	const most = Math.max(...known, ...limit === null ? [] : [limit]);
	if (!known.length)
		return {path: "", limit: null};
	const y = (v) => (most > least ? height - 3 - (v - least) / (most - least) * (height - 6)
		: height / 2).toFixed(1);
	let path = "", open = false;
	for (let n = 0; n < x.length; n++) {
		if (x[n] < from)
			continue;
		const at = ((x[n] - from) / (until - from) * width).toFixed(1);
		if (last[n] !== null)
			path += `${open ? "L" : "M"}${at} ${y(last[n])}`;
		open = last[n] !== null;
	}
	return {path: open ? `${path}H${width}` : path, limit: limit === null ? null : y(limit)};
}
