// SPDX-License-Identifier: MIT
// What signals had: columns of the recorder, continued by what the page has heard.
import {get} from "./api.js";
import {store} from "./store.js";
import {UNKNOWN, stateOf} from "./words.js";

const UNWRITTEN_MS = 660000; // at most: the longest Flush, and a little

export const goodCode = (code) => code !== UNKNOWN && stateOf(code) === "good";

export const emptyPast = (name) =>
	({name, x: [], min: [], max: [], last: [], code: [], gap: []});

/**
 * The past of a signal as {name, x, min, max, last, code, gap}: arrays of one length. x is when a
 * column begins, ms; each holds until the next. The code of a column of which nothing is known is
 * UNKNOWN. min, max, last are null where there is no good value.
 */
export async function pastOf(signal, from, until, points) {
	const past = emptyPast(signal.name);
	if (!store.info?.history || signal.type === "string")
		return past;
	try {
		take(past, await get("trend", {name: signal.name, from: Math.round(from),
			until: Math.round(until), points}));
	} catch (error) {
		if (error.status !== 404)
			throw error; // 404: the recorder has nothing of this signal
	}
	return past;
}

function take(past, data) {
	const {from = [], min = [], max = [], last = [], quality = [], gap = []} = data;
	for (let n = 0; n < from.length; n++) {
		const good = quality[n] !== null && goodCode(quality[n]);
		const known = quality[n] !== 0 && quality[n] !== null;
		past.x.push(from[n]);
		past.min.push(min[n] ?? null);
		past.max.push(max[n] ?? null);
		past.last.push(good ? last[n] ?? null : null);
		past.code.push(known ? quality[n] : UNKNOWN);
		past.gap.push(Boolean(gap[n]));
	}
	// What the recorder has not written yet is no gap: the page may know it
	while (past.x.length && past.code.at(-1) === UNKNOWN)
		for (const column of [past.x, past.min, past.max, past.last, past.code, past.gap])
			column.pop();
	if (past.x.length < from.length && past.x.length)
		past.gap[past.x.length - 1] = false;
}

/** The past with what the page has heard since, until the time (ms). */
export function continued(past, signal, from, until) {
	const all = Object.fromEntries(Object.entries(past).map(([key, value]) =>
		[key, Array.isArray(value) ? [...value] : value]));
	const add = (t, v, code, low = v, high = v) => {
		all.x.push(t);
		all.min.push(low);
		all.max.push(high);
		all.last.push(v);
		all.code.push(code);
		all.gap.push(false);
	};
	const end = Math.min(until, store.now());
	// Where the last column ends; what comes then, only the page can know
	const start = all.x.length ? all.x.at(-1) + (all.x[1] - all.x[0] || 0) : from;
	const known = signal.recent.findLast(({t}) => t <= start);
	const heard = signal.recent.filter(({t}) => t > start && t <= end);
	// Until the recorder has written what came just before the page was opened, that held on
	const held = known ?? (all.x.length && heard[0]?.t - start <= UNWRITTEN_MS
		? {v: all.last.at(-1), code: all.code.at(-1)} : null);
	if (start < end)
		add(start, held?.v ?? null, held?.code ?? UNKNOWN);
	for (const {t, v, code, low, high} of heard)
		add(t, v, code, low, high);
	if (all.x.length && all.x.at(-1) < end)
		add(end, store.unknown ? null : all.last.at(-1), store.unknown ? UNKNOWN : all.code.at(-1));
	return all;
}

/** The least and the greatest good value of the columns that begin in the window, or null. */
export function extremes(past, [from, until]) {
	const good = (values) => values.filter((value, n) => value !== null && past.x[n] >= from
		&& past.x[n] <= until);
	const least = good(past.min), most = good(past.max);
	return least.length ? [Math.min(...least), Math.max(...most)] : null;
}

/** The number of the column that holds at a time; null: the last one; -1: none. */
export function heldAt(past, time) {
	let at = past.x.length - 1;
	while (time !== null && at >= 0 && past.x[at] > time)
		at--;
	return at;
}

/** For which part of the time in the window of which something is known it was on; or null. */
export function onPart({x, last}, [from, until]) {
	let known = 0, on = 0;
	for (let n = 0; n + 1 < x.length; n++) {
		const time = Math.min(x[n + 1], until) - Math.max(x[n], from);
		if (time <= 0 || last[n] === null)
			continue;
		known += time;
		on += last[n] ? time : 0;
	}
	return known ? on / known : null;
}

/** The values that an axis shows for these pairs of a least and a greatest: all, and a margin. */
export function padded(pairs) {
	if (!pairs.length)
		return [0, 1];
	const least = Math.min(...pairs.map(([value]) => value));
	const most = Math.max(...pairs.map(([, value]) => value));
	const margin = (most - least || Math.abs(most) || 1) / 10;
	return [least - margin, most + margin];
}

export function save(name, text, type = "text/csv") {
	const url = URL.createObjectURL(new Blob([text], {type}));
	const link = document.createElement("a");
	link.href = url;
	link.download = name;
	link.click();
	setTimeout(() => URL.revokeObjectURL(url), 10000);
}
