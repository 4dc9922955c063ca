// SPDX-License-Identifier: MIT
// The axes of plots: where their marks are, what stands at them, and how plots share a height.
import {tickText} from "./when.js";

const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600,
	43200];
const DAYS = [1, 2, 4, 7, 14], MONTHS = [1, 2, 3, 6, 12, 24, 60, 120];
const DAY_S = 86400;

/* Marks in local time that are so many seconds, days or months apart; they stand where they are
 * while the window moves. */
function* marks(from, until, {seconds, days, months}) {
	const start = new Date(from), year = start.getFullYear(), month = start.getMonth();
	const day = start.getDate(), number = Math.floor(Date.UTC(year, month, day) / 1000 / DAY_S);
	const at = seconds ? (n) => new Date(year, month, day, 0, 0, n * seconds)
		: days ? (n) => new Date(year, month, day - number % days + n * days)
			: (n) => new Date(year, (Math.floor((month + year * 12) / months) + n) * months
				- year * 12);
	let n = seconds ? Math.floor((from - at(0)) / 1000 / seconds) : 0, last = -Infinity;
	for (; ;n++) {
		const v = at(n).getTime();
		if (v > until)
			return;
		if (v >= from && v > last)
			yield last = v;
	}
}

/** Marks of an axis of time so wide: [{v, label}], as many as have least px between them. */
export function timeTicks(from, until, width, least = 72) {
	const wanted = (until - from) / 1000 / width * least;
	const seconds = SECONDS.find((one) => one >= wanted);
	const days = DAYS.find((one) => one * DAY_S >= wanted);
	const months = MONTHS.find((one) => one * 28 * DAY_S >= wanted) ?? MONTHS.at(-1);
	return [...marks(from, until, seconds ? {seconds} : days ? {days} : {months})].map((v) =>
		({v, label: tickText(new Date(v))}));
}

/** Marks of an axis of numbers so high: [{v, label}], at least so many px apart. */
export function numberTicks(from, until, height, least = 36) {
	// no finer than numbers of that size are: else the next mark is the same one, for ever
	const wanted = Math.max((until - from) / Math.max(1, height) * least,
		Math.max(Math.abs(from), Math.abs(until)) * 2 ** -48);
	const ten = 10 ** Math.floor(Math.log10(wanted));
	const step = [1, 2, 5, 10].map((one) => one * ten).find((one) => one >= wanted * 0.999);
	const digits = Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9)));
	const ticks = [];
	for (let n = Math.ceil(from / step - 1e-9); n * step <= until + step * 1e-9; n++) {
		const v = n * step;
		ticks.push({v, label: Math.abs(v) >= 1e6 ? v.toExponential(1) : v.toFixed(digits)});
	}
	return ticks;
}

/** Heights of so many plots that share a total: the first has two thirds, none less than least. */
export function shares(count, total, least) {
	const other = count > 1 ? Math.max(least, total / 3 / (count - 1)) : 0;
	return Array.from({length: count}, (_, n) => Math.floor(n ? other
		: Math.max(least, total - other * (count - 1))));
}

/** Where texts stand that want these places, so many px apart from each other and within 0..most. */
export function apart(wanted, gap, most) {
	const order = wanted.map((_, n) => n).sort((a, b) => wanted[a] - wanted[b]);
	const places = [...wanted];
	order.forEach((n, k) => {
		places[n] = Math.max(places[n], k ? places[order[k - 1]] + gap : 0);
	});
	let limit = most;
	for (const n of order.reverse()) {
		places[n] = Math.max(0, Math.min(places[n], limit));
		limit = places[n] - gap;
	}
	return places;
}
