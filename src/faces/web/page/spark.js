// SPDX-License-Identifier: MIT
// Keeps what the page heard of a signal, of an hour at most, and draws it as a small line of steps:
// on and off as bars. What was not good stays a gap.
import {svg} from "./dom.js";
import {clock, valueText} from "./words.js";

const WIDTH = 84, HEIGHT = 22, MARGIN = 3;
const SHORTEST_MS = 30000, LONGEST_MS = 3600000;

const RECENT = 240;   // values of a signal that are kept
const WATCHED = 3600; // and of one that has a trend
const SLOT_MS = 500;  // what comes within such a time becomes one of them

/* One in place of each two values; a gap stays one. */
function thin(recent) {
	let n = 0;
	for (let i = 0; i < recent.length; i++) {
		const one = recent[i], next = recent[i + 1];
		recent[n++] = one;
		if (i + 2 < recent.length && one.v !== null && next.v !== null) {
			recent[n - 1] = {...next, t: one.t, low: Math.min(one.low, next.low),
				high: Math.max(one.high, next.high)};
			i++;
		}
	}
	recent.length = n;
}

/** Add what a signal has at the time t, ms; v: null if that is not good. */
export function keep(recent, t, v, code, watched) {
	const last = recent.at(-1);
	if (last && last.v === v && last.code === code)
		return;
	if (last && last.v !== null && v !== null && t < last.t + SLOT_MS) {
		last.v = v;
		last.low = Math.min(last.low, v);
		last.high = Math.max(last.high, v);
		return;
	}
	recent.push({t: Math.max(t, last?.t ?? 0), v, low: v, high: v, code});
	const most = watched ? WATCHED : RECENT;
	while (recent.length > most && recent[1].t < t - LONGEST_MS)
		recent.shift();
	for (let before = Infinity; recent.length > most && recent.length < before;) {
		before = recent.length;
		thin(recent);
	}
	if (recent.length > most)
		recent.splice(0, recent.length - most);
}

/** What of it lies in the last hour: {from, least, most}; null: no value. */
export function extentOf(recent, now) {
	const begin = now - LONGEST_MS, first = Math.max(0, recent.findLastIndex(({t}) => t <= begin));
	let least = Infinity, most = -Infinity;
	for (let n = first; n < recent.length; n++)
		if (recent[n].v !== null) {
			least = Math.min(least, recent[n].low);
			most = Math.max(most, recent[n].high);
		}
	return least > most ? null
		: {from: Math.max(begin, Math.min(recent[first].t, now - SHORTEST_MS)), least, most, first};
}

/** {line, dot} as paths: what was recent until now (ms), and where it is now; "" is nothing. */
export function sparkPaths(recent, now, isBool = false) {
	const extent = extentOf(recent, now);
	if (!extent)
		return {line: "", dot: ""};
	const {from, least, most, first} = extent;
	const scale = most > least ? (HEIGHT - 2 * MARGIN) / (most - least) : 0;
	const x = (t) => (Math.max(0, t - from) / (now - from) * (WIDTH - MARGIN)).toFixed(1);
	const y = (v) => (scale ? HEIGHT - MARGIN - (v - least) * scale : HEIGHT / 2).toFixed(1);
	const last = recent.at(-1).v;
	if (isBool) {
		let bars = "";
		for (let n = first; n < recent.length; n++)
			if (recent[n].v)
				bars += `M${x(recent[n].t)} 11H${x(recent[n + 1]?.t ?? now)}`;
		return {line: `M0 11H${WIDTH - MARGIN}`, dot: bars};
	}
	let path = "", open = false;
	for (let n = first; n < recent.length; n++) {
		const {t, v} = recent[n];
		if (open)
			path += `H${x(t)}`;
		if (v !== null)
			path += `${open ? "V" : `M${x(t)} `}${y(v)}`;
		open = v !== null;
	}
	const end = WIDTH - MARGIN;
	return {line: open ? `${path}H${end}` : path, dot: open ? `M${end} ${y(last)}h0` : ""};
}

/** Words for the range beside the line, and since when that is. */
export function rangeOf(signal, now) {
	const extent = signal.type === "string" ? null : extentOf(signal.recent, now);
	if (!extent)
		return {text: "", since: ""};
	const since = clock(extent.from).slice(0, 5);
	if (signal.type === "bool") {
		const {recent} = signal, changed = recent.length - 1 > extent.first;
		return {since, text: changed ? recent.at(-1).old ? "" // of some minutes: hour.js
			: `since ${clock(recent.at(-1).t).slice(0, 5)}`
			: now - extent.from >= LONGEST_MS ? "all hour" : ""};
	}
	const [least, most] = [extent.least, extent.most].map((v) => valueText(signal, v));
	return {since, text: least === most ? "" : `${least} \u2013 ${most}`};
}

export function sparkline(isBool = false) {
	return svg("svg", {class: `spark${isBool ? " bars" : ""}`, viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
		"aria-hidden": "true", focusable: "false", preserveAspectRatio: "none"}, svg("path"),
	svg("path", {class: "dot"}));
}

export function drawSpark(node, {recent, type}, now) {
	const {line, dot} = sparkPaths(recent, now, type === "bool");
	for (const [one, path] of [[node.firstChild, line], [node.lastChild, dot]])
		if (one.getAttribute("d") !== path)
			one.setAttribute("d", path);
}
