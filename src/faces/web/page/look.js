// SPDX-License-Identifier: MIT
// How a signal looks: its edge, its words, and whether somebody must look at it.
import {alarmOf, clock, qualityWords, span, stateOf, valueText, withUnit} from "./words.js";

const INITIAL = 0x20, STALE = 0x14, DIFFERS = 0x1c;
const LATE_AFTER = 3;   // usual intervals
const LATE_LEAST = 3;   // s: a page hears of a value within a second or two

/** Is the value older than its signal usually gets? A page hears of none within Deadband. */
export function isLate(signal, age) {
	const usual = signal.gap ?? signal.interval; // that of owsd is from its start on
	return !(signal.deadband > 0) && usual > 0 && age !== null && age > Math.max(LATE_AFTER * usual, LATE_LEAST);
}

/** Since when it is as it is, ms: as the page saw it, else its last measurement; null: unknown. */
export function sinceOf({recent, measured}) {
	const [before, last] = recent?.slice(-2) ?? [];
	return last && !before.old && !last.old ? last.t : measured ?? null; // old: hour.js
}

function wordsOf(signal, age) {
	const {code, commanded} = signal;
	if (code === INITIAL)
		return "not read yet";
	if (code === STALE)
		return age === null ? "stale" : `stale, nothing for ${span(age)}`;
	if (code === DIFFERS && typeof commanded === "boolean")
		return `${commanded ? "on" : "off"} was set, reads ${commanded ? "off" : "on"}`;
	return signal.text || qualityWords(code);
}

/**
 * {edge, words, shape, alarm, needs, state, late}. edge: "alarm", "alarm-2", "bad", "uncertain",
 * "initial", "unknown" or "none"; words and shape: "" where the value is good. unknown: the page
 * knows nothing.
 */
export function lookOf(signal, unknown, age) {
	if (unknown)
		return {edge: "unknown", words: "unknown", shape: "", alarm: null, needs: true,
			state: "unknown", late: false};
	const alarm = alarmOf(signal.alarm), state = stateOf(signal.code);
	const edge = signal.code === INITIAL ? "initial" : state !== "good" ? state
		: alarm?.open ? alarm.very ? "alarm-2" : "alarm" : "none";
	const shape = state === "good" ? "" : signal.code === STALE ? "\u25f7"
		: signal.code === DIFFERS ? "\u2260" : state === "bad" ? "\u00d7" : "?";
	return {edge, state, shape, alarm, words: state === "good" ? "" : wordsOf(signal, age),
		needs: edge !== "none" && edge !== "initial", late: state === "good" && isLate(signal, age)};
}

/** What wants eyes first is least. */
export const urgencyOf = ({edge, alarm, late}) =>
	["alarm-2", "alarm", "bad", "unknown", "uncertain", "initial", "none"].indexOf(edge) * 4
		+ (alarm ? 0 : late ? 1 : 2);

/** The limit that an alarm is about; null: none is known. */
export function limitOf(signal, alarm) {
	const key = {up: "h", down: "l"}[alarm?.turn] ?? "";
	return signal.limits?.[alarm?.very ? key + key : key] ?? null;
}

/** The words of an alarm for its badge; a tick: somebody has seen it. */
export const alarmWords = ({text}) => text.replace(", acknowledged", " \u2713");

// --- The sentence ---------------------------------------------------------------------------

const NAMED = 3;  // signals of one reason that are named
const REASONS = 4;

/** Why one signal needs you, in words, beside its name. */
function reasonOf({signal, look, value}) {
	if (!look.edge.startsWith("alarm")) {
		const since = look.edge === "bad" && signal.code !== STALE ? sinceOf(signal) : null;
		return since === null ? look.words : `${look.words} since ${clock(since).slice(0, 5)}`;
	}
	const limit = limitOf(signal, look.alarm);
	return [alarmWords(look.alarm), withUnit(signal, valueText(signal, value)),
		limit === null ? "" : `limit ${valueText(signal, limit)}`].filter(Boolean).join(", ");
}

const tally = (all) => {
	const counts = new Map();
	for (const {look} of all)
		counts.set(look.words, (counts.get(look.words) ?? 0) + 1);
	return [...counts].map(([words, n]) => `${n} ${words}`).join(", ");
};

/**
 * What needs you, the worst first: [{look, names, more, words}]. all: [{signal, look, value}] of
 * those; more: how many have no name here.
 */
export function needsOf(all) {
	const groups = new Map();
	for (const one of [...all].sort((a, b) => urgencyOf(a.look) - urgencyOf(b.look))) {
		const key = `${one.look.edge} ${one.look.alarm && one.look.edge.startsWith("alarm")
			? one.look.alarm.text : one.look.words}`;
		if (!groups.get(key)?.push(one))
			groups.set(key, [one]);
	}
	const made = (members, words) => ({look: members[0].look, words,
		names: members.slice(0, NAMED).map(({signal}) => signal.name),
		more: Math.max(0, members.length - NAMED)});
	const lists = [...groups.values()];
	const blind = lists.filter(([one]) => !one.look.edge.startsWith("alarm"));
	const merged = lists.length > REASONS && blind.length > 1;
	const out = lists.filter((list) => !merged || !blind.includes(list)).map((list) =>
		made(list, list.length === 1 ? reasonOf(list[0])
			: list[0].look.edge.startsWith("alarm") ? alarmWords(list[0].look.alarm) : list[0].look.words));
	if (merged)
		out.push({...made(blind.flat(), `have no value: ${tally(blind.flat())}`), names: [],
			more: blind.flat().length});
	return out;
}

/** The first line, and the quieter words beside it. all: looks of all signals. */
export function sentenceOf(looks, ages) {
	const n = looks.length, needs = looks.filter((look) => look.needs).length;
	if (looks.some(({edge}) => edge === "unknown"))
		return [`${n} signals, all unknown`, ""];
	const initial = looks.filter(({edge}) => edge === "initial").length;
	const late = looks.filter((look) => look.late).length;
	const known = ages.filter((age) => age !== null);
	const good = n - needs - initial;
	const words = needs || initial ? [[needs && good ? `${good} good` : "",
		initial ? `${initial} not read yet` : ""].filter(Boolean).join(", ")] : [];
	if (late)
		words.push(`${late} late`);
	else if (known.length)
		words.push(`All at most ${span(known.reduce((most, age) => Math.max(most, Math.ceil(age)), 1))} old`);
	return [needs ? `${needs} of ${n} need${needs === 1 ? "s" : ""} you` : initial
		? `${good} of ${n} good` : n === 1 ? "The one signal is good" : `All ${n} good`,
	words.filter(Boolean).map((one) => `${one}.`).join(" ")];
}
