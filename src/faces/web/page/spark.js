// SPDX-License-Identifier: MIT
// Keeps the last minutes of a signal, and draws them as a small line of steps. What was not good
// stays a gap.
import {svg} from "./dom.js";

const WIDTH = 112, HEIGHT = 24, MARGIN = 2;
const SHORTEST_MS = 30000, LONGEST_MS = 600000;

const RECENT = 240;   // values of a signal that are kept
const WATCHED = 3600; // and of one that has a trend
const SLOT_MS = 500;  // what comes within such a time becomes one of them

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
	while (recent.length > (watched ? WATCHED : RECENT))
		recent.shift();
}

export function sparkline() {
	return svg("svg", {class: "spark", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true",
		focusable: "false", preserveAspectRatio: "none"}, svg("path", {}));
}

/** The path of what was recent until now (ms); "" if nothing can be drawn. */
export function sparkPath(recent, now) {
	const first = recent.find((one) => one.t >= now - LONGEST_MS);
	if (!first)
		return "";
	const from = now - Math.min(LONGEST_MS, Math.max(SHORTEST_MS, now - first.t));
	let least = Infinity, most = -Infinity;
	for (const {t, v} of recent)
		if (v !== null && t >= from) {
			least = Math.min(least, v);
			most = Math.max(most, v);
		}
	if (least > most)
		return "";
	const scale = most > least ? (HEIGHT - 2 * MARGIN) / (most - least) : 0;
	const x = (t) => (Math.max(0, t - from) / (now - from) * WIDTH).toFixed(1);
	const y = (v) => (scale ? HEIGHT - MARGIN - (v - least) * scale : HEIGHT / 2).toFixed(1);
	let path = "", open = false;
	for (const {t, v} of recent) {
		if (t < from)
			continue;
		if (open)
			path += `H${x(t)}`;
		if (v !== null)
			path += `${open ? "V" : `M${x(t)} `}${y(v)}`;
		open = v !== null;
	}
	return open ? `${path}H${WIDTH}` : path;
}

export function drawSpark(node, recent, now) {
	const path = sparkPath(recent, now);
	const line = node.firstChild;
	if (line.getAttribute("d") !== path)
		line.setAttribute("d", path);
}
