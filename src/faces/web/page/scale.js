// SPDX-License-Identifier: MIT
// One scale for many values: its ends and marks, and how many lie in each part of it.

/** {from, to, step}: round ends around all values, and the limits that are near; null: no value. */
export function scaleOf(values, limits = []) {
	let least = Infinity, most = -Infinity;
	for (const value of values) {
		least = Math.min(least, value);
		most = Math.max(most, value);
	}
	if (least > most)
		return null;
	const room = most - least || Math.abs(most) || 1;
	for (const limit of limits) // one that is far off would make all else small
		if (limit >= least - room && limit <= most + room) {
			least = Math.min(least, limit);
			most = Math.max(most, limit);
		}
	const rough = (most - least || room) / 6, power = 10 ** Math.floor(Math.log10(rough));
	const step = [1, 2, 5, 10].find((one) => one * power >= rough * 0.999) * power;
	const from = Math.floor(least / step) * step, to = Math.ceil(most / step) * step;
	return {from, to: to > from ? to : from + step, step};
}

/** The part of the scale where a value lies, 0 to 1. */
export const partOf = ({from, to}, value) =>
	Math.min(1, Math.max(0, (value - from) / (to - from)));

/** The number of the part where a value lies, of n equal ones. */
export const placeIn = (scale, value, n) => Math.min(n - 1, Math.floor(partOf(scale, value) * n));

/** How many values are in each of n equal parts. */
export function buckets(values, scale, n) {
	const counts = new Array(n).fill(0);
	for (const value of values)
		counts[placeIn(scale, value, n)]++;
	return counts;
}

/** The marks of an axis. */
export function marksOf({from, to, step}) {
	const marks = [];
	for (let n = 0; from + n * step <= to + step / 1000; n++)
		marks.push(Number((from + n * step).toPrecision(12)));
	return marks;
}

/** The value in the middle of them. */
export function middleOf(values) {
	const all = [...values].sort((a, b) => a - b), half = all.length >> 1;
	return !all.length ? null : all.length % 2 ? all[half] : (all[half - 1] + all[half]) / 2;
}
