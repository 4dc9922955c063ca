// SPDX-License-Identifier: MIT
// The hour before the page was opened, from the recorder, for the small lines beside the values.
import {get} from "./api.js";
import {goodCode} from "./series.js";
import {store} from "./store.js";
import {UNKNOWN} from "./words.js";

/**
 * Put the columns of the recorder, which begin at from and are step apart (ms), before what the
 * page has heard. Those that nothing is known of are a gap.
 */
export function precede(recent, {min, max, last, quality}, from, step) {
	const begin = recent[0]?.t ?? Infinity, all = [];
	const add = (one) => {
		const before = all.at(-1);
		if (before?.v !== one.v || before.code !== one.code) {
			all.push(one);
		} else if (one.v !== null) {
			before.low = Math.min(before.low, one.low);
			before.high = Math.max(before.high, one.high);
		}
	};
	const end = quality.findLastIndex((code) => code);
	quality.forEach((code, n) => {
		const t = from + n * step, v = code && goodCode(code) ? last[n] ?? null : null;
		// the recorder writes a little later: what it has not yet is no gap, unless it lasts
		if (t < begin && (n <= end || begin - from > (end + 2) * step))
			add({t, v, low: min[n] ?? v, high: max[n] ?? v, code: code || UNKNOWN, old: true});
	});
	recent.forEach(add);
	recent.splice(0, recent.length, ...all.slice(all[0]?.code === UNKNOWN && all[0].old ? 1 : 0));
}

export async function begin() {
	if (!store.info?.history)
		return;
	for (let first = 0; first !== null;) {
		const {from, step, signals, next} = await get("hour", {first});
		for (const signal of store.signals)
			if (Object.hasOwn(signals, signal.name))
				precede(signal.recent, signals[signal.name], from, step);
		first = next ?? null;
	}
}
