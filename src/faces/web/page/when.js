// SPDX-License-Identifier: MIT
// Windows of time in the words of people: "yesterday 18:00", "Fri 18:00 - 20:00", "last night". All
// in local time.
import {clock, dateAndClock, msOf} from "./words.js";

const DAYS = ["Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"];
const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const NIGHT = [18, 8]; // begins and ends at these hours
const DAY_MS = 86400000, WEEK_MS = 7 * DAY_MS;
const DAYS_CLEAR_MS = 6 * DAY_MS; // so far away the day of the week says which one
const NIGHT_MS = 18 * 3600000; // longer nobody means by "22:00 - 6:00"

/** A mark of an axis of time: 12:30:05, 12:30; at midnight 29 Nov, at that of a year 2026. */
export function tickText(at) {
	if (at.getSeconds())
		return clock(at.getTime());
	if (at.getHours() || at.getMinutes())
		return clock(at.getTime()).slice(0, 5);
	return at.getMonth() || at.getDate() > 1 ? `${at.getDate()} ${MONTHS[at.getMonth()]}`
		: String(at.getFullYear());
}

/**
 * A time as people say it now (ms): 14:02, Thu 21:14, 12 Nov 21:14, 2025-11-27; exact: 14:02:34.
 */
export function moment(time, now, exact = false) {
	const at = new Date(msOf(time)), today = new Date(now);
	if (Number.isNaN(at.getTime()))
		return "\u2014";
	const minute = clock(at.getTime()).slice(0, exact ? 8 : 5);
	if (at.toDateString() === today.toDateString())
		return minute;
	if (Math.abs(now - at) < DAYS_CLEAR_MS)
		return `${DAYS[at.getDay()]} ${minute}`;
	return at.getFullYear() === today.getFullYear()
		? `${at.getDate()} ${MONTHS[at.getMonth()]} ${minute}` : dateAndClock(time).slice(0, 10);
}

/** Of a day: "Sat 28 Nov". */
export function dayText(time) {
	const at = new Date(time);
	return `${DAYS[at.getDay()]} ${at.getDate()} ${MONTHS[at.getMonth()]}`;
}

const placeIn = (names, text) => names.findIndex((one) => one.toLowerCase() === text.slice(0, 3));
const same = (a, b) => new Date(a).toDateString() === new Date(b).toDateString();
/** So many days later, at the same time of the day. */
export const daysLater = (time, days) => new Date(time).setDate(new Date(time).getDate() + days);
export const midnight = (time) => new Date(time).setHours(0, 0, 0, 0);

/** From yesterday evening to this morning, or until now: [from, until]. */
export const lastNight = (now) => [new Date(daysLater(now, -1)).setHours(NIGHT[0], 0, 0, 0),
	Math.min(now, new Date(now).setHours(NIGHT[1], 0, 0, 0))];

/** "Fri 27 Nov 18:00 – Sat 18:00"; until null: "– now". */
export function windowText(from, until, now) {
	const end = until ?? now, exact = end - from < 600000;
	const year = new Date(from).getFullYear();
	const first = same(from, now) && same(end, now) ? moment(from, now, exact)
		: `${dayText(from)} ${year === new Date(now).getFullYear() ? "" : `${year} `}`
			+ moment(from, from, exact);
	const last = until === null ? "now" : same(from, end) ? moment(end, end, exact)
		: end - from < WEEK_MS ? moment(end, end + DAY_MS, exact)
			: `${dayText(end)} ${moment(end, end, exact)}`;
	return `${first} \u2013 ${last}`;
}

/* What day a text names, as its midnight; null: none. near: where a day without a year is sought. */
function dayOf(text, now) {
	const days = ["today", "yesterday"].indexOf(text);
	if (days >= 0)
		return midnight(daysLater(now, -days));
	const week = /^[a-z]{3,9}$/.test(text) ? placeIn(DAYS, text) : -1;
	if (week >= 0)
		return midnight(daysLater(now, -((new Date(now).getDay() - week + 7) % 7)));
	const [, year, month, day] = /^(\d{4})-(\d{1,2})-(\d{1,2})$/.exec(text)?.map(Number) ?? [];
	if (year)
		return dateOf(year, month - 1, day);
	const named = /^(?:[a-z]{3,9}\.?,? )?(\d{1,2})\.? ([a-z]{3,9})\.?(?: (\d{4}))?$/.exec(text);
	const at = named ? placeIn(MONTHS, named[2]) : -1;
	if (at < 0)
		return null;
	const here = new Date(now).getFullYear();
	const found = dateOf(Number(named[3] ?? here), at, Number(named[1]));
	return found > now && !named[3] ? dateOf(here - 1, at, Number(named[1])) : found;
}

function dateOf(year, month, day) {
	const date = new Date(year, month, day);
	return date.getMonth() === month && date.getDate() === day ? date.getTime() : null;
}

/* One moment; day: the midnight that is meant if the text has a time alone. */
function momentOf(text, now, day) {
	if (!text || text === "now")
		return text ? {time: now, whole: false} : null;
	const clock = /(?:^|[ t])(\d{1,2})(?::(\d{2}))?(?::(\d{2}))? ?(?:h|o'clock)?$/.exec(text);
	const rest = clock ? text.slice(0, clock.index).trim() : text;
	const isDate = clock && !clock[2] && dayOf(text, now) !== null;
	const wanted = isDate ? text : rest;
	const start = wanted ? dayOf(wanted, now) : day;
	if (start === null)
		return null;
	if (!clock || isDate)
		return {time: start, whole: true};
	const [hour, minute, second] = clock.slice(1).map((one) => Number(one ?? 0));
	if (hour > 24 || minute > 59 || second > 59)
		return null;
	return {time: new Date(start).setHours(hour, minute, second), whole: false, bare: !wanted};
}

/**
 * The window that a text names, as [from, until]: "yesterday", "yesterday 18:00", "Fri 18:00 - Sat
 * 6:00", "last night". A moment alone is its begin; it is so long then (ms), a day whole. Two times
 * of which the second is before the first are of a night, the last one. null: no window. An end that
 * is not after the begin is left to the caller.
 */
export function windowOf(text, now, span) {
	const plain = text.toLowerCase().replace(/\s+/g, " ").trim();
	if (plain === "last night")
		return lastNight(now);
	const [, first, second] = /^(.+?)(?: ?\u2013 ?| - | to | until )(.+)$/.exec(plain) ?? [];
	const from = momentOf(first ?? plain, now, midnight(now));
	if (!from)
		return null;
	if (!second)
		return [from.time, from.whole ? daysLater(from.time, 1) : from.time + span];
	const until = momentOf(second, now, midnight(from.time));
	if (!until)
		return null;
	const end = until.whole ? daysLater(until.time, 1) : until.time;
	if (end > from.time || until.whole)
		return [from.time, end];
	const night = from.bare ? [daysLater(from.time, -1), end]
		: [from.time, daysLater(end, end + DAY_MS > from.time ? 1 : 7)]; // 7: a day of the week
	const short = night[1] - night[0] <= NIGHT_MS || !until.bare && second !== "now";
	return short ? night : [from.time, end];
}

/** With what a window is compared, in days before, and the words for it. */
export function besideOf(span) {
	return span <= DAY_MS ? [1, "yesterday"] : span <= WEEK_MS ? [7, "the week before"]
		: [28, "4 weeks before"];
}
