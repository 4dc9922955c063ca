// SPDX-License-Identifier: MIT
// What stands in a plot beside the curves: gaps with their reason, limits, alarms.
import {happenings, isLost} from "./happened.js";
import {UNKNOWN, alarmOf, qualityWords, span, valueText} from "./words.js";

const KINDS = [["hh", "very high limit"], ["h", "limit"], ["l", "limit"], ["ll", "very low limit"]];
const INITIAL = 0x20; // not read yet: nothing is wrong
const NEAR = 0.5; // of what the values span: a limit so far away is shown

/** Stretches without a good value, next to one that had one: [{from, until, value, code, words}]. */
export function gapsOf({x, last, code}) {
	const gaps = [];
	let value = null;
	for (let k = 0; k < x.length;) {
		let end = k + 1;
		while (end < x.length && last[end] === null && last[k] === null && code[end] === code[k])
			end++;
		if (last[k] !== null) {
			value = last[k];
			for (const gap of gaps)
				gap.value ??= value;
		} else if (value !== null || code[k] !== UNKNOWN) {
			const until = x[Math.min(end, x.length - 1)];
			gaps.push({from: x[k], until, value, code: code[k], words:
				`${code[k] === UNKNOWN ? "nothing known" : qualityWords(code[k])}, `
				+ span((until - x[k]) / 1000)});
		}
		k = end;
	}
	return gaps.filter((gap) => gap.value !== null && gap.code !== INITIAL);
}

/** The limits of a signal that are shown beside these values: [{value, words}]. */
export function limitsOf(signal, extremes) {
	const [least, most] = extremes, room = (most - least || Math.abs(most) / 10 || 1) * NEAR;
	return KINDS.map(([key, words]) => ({value: signal.limits?.[key] ?? null,
		words: `${signal.name} ${words} ${valueText(signal, signal.limits?.[key])}`}))
		.filter(({value}) => value !== null && value >= least - room && value <= most + room);
}

/**
 * The line of each label {from, until}, so that no two of a line overlap: 0, 1, ...; -1: there are
 * no more than most lines. The last are the newest, and the first to have a line.
 */
export function linesOf(labels, most) {
	const ends = []; // of each line: where its leftmost label begins
	const lines = labels.map(() => -1);
	const order = labels.map((_, n) => n).sort((a, b) => labels[b].until - labels[a].until);
	for (const n of order) {
		let line = ends.findIndex((from) => labels[n].until <= from);
		if (line < 0 && ends.length < most)
			line = ends.push(Infinity) - 1;
		if (line < 0)
			continue;
		ends[line] = labels[n].from;
		lines[n] = line;
	}
	return lines;
}

/**
 * Alarms of these signals in the window, by entries of the journal and by how they stand now:
 * [{name, kind, turn, from, until}]; until null: it is not known how long it lasted.
 */
export function alarmsOf(entries, signals, [from, until], now) {
	const find = (name) => signals.find((signal) => signal.name === name);
	const all = [], standing = new Set();
	for (const {time, name, alarm, what, ended} of happenings(entries, find)) {
		const signal = find(name);
		if (!signal || !alarm || isLost(alarm) || what !== "raised" && what !== "returned")
			continue;
		const kind = alarmOf(alarm), stands = ended === null && what === "raised"
			&& !standing.has(name) && alarmOf(signal.alarm)?.text.startsWith(kind.text)
			&& !signal.alarm.includes("returned");
		if (stands)
			standing.add(name);
		all.push({name, kind: kind.text, turn: kind.turn, from: what === "raised" ? time : from,
			until: what === "returned" ? time : ended ?? (stands ? now : null)});
	}
	for (const {name, alarm} of signals) {
		const kind = alarmOf(alarm);
		if (kind?.turn && !standing.has(name) && !/returned|shelved/.test(kind.text))
			all.push({name, kind: kind.text.split(",")[0], turn: kind.turn, from, until: now});
	}
	return all.filter((one) => one.from <= until && (one.until ?? one.from) >= from)
		.map((one) => ({...one, from: Math.max(from, one.from)}));
}
