// SPDX-License-Identifier: MIT
// A table for spreadsheets: a line for each time, in local time, and a column for each signal.
import {get} from "./api.js";
import {ask} from "./command.js";
import {el} from "./dom.js";
import {goodCode, save} from "./series.js";
import {store} from "./store.js";
import {dateAndClock, valueText} from "./words.js";

const MOST = 500000; // records of a signal; a table of more no spreadsheet opens

const quoted = (text) => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
// A text that a spreadsheet would take for a formula is kept one
const harmless = (text) => /^[=+@-]/.test(text) ? `'${text}` : text;

function cell(signal, value, exact) {
	if (value === null || value === undefined)
		return "";
	if (typeof value === "string")
		return value; // JavaScript would round it
	return signal.type === "bool" || exact ? String(Number(value)) : valueText(signal, value);
}

/**
 * all: [{signal, past}]. Each line has what held at its time; nothing where that was not good.
 * exact: with milliseconds, and values with all digits.
 */
export function csvOf(all, exact = false) {
	const times = [...new Set(all.flatMap(({past}) => past.x))].sort((a, b) => a - b);
	const heads = all.map(({signal}) => quoted(harmless(signal.name
		+ (signal.unit ? ` (${signal.unit})` : ""))));
	const lines = [["time", ...heads].join(",")], at = all.map(() => -1);
	for (const time of times) {
		const cells = all.map(({signal, past}, n) => {
			while (past.x[at[n] + 1] <= time)
				at[n]++;
			return cell(signal, past.last[at[n]], exact);
		});
		const ms = exact ? `.${String(Math.floor(time % 1000)).padStart(3, "0")}` : "";
		lines.push([`${dateAndClock(time)}${ms}`, ...cells].join(","));
	}
	// With the mark by which spreadsheets know UTF-8
	return `\ufeff${lines.join("\r\n")}\r\n`;
}

/** What the recorder has of a signal in the window, as a past with a column for each record. */
export async function recordsOf(signal, from, until) {
	const past = {name: signal.name, x: [], last: []};
	let next = Math.round(from);
	while (next && past.x.length < MOST) {
		const answer = await get("records", {name: signal.name, from: next,
			until: Math.round(until)});
		for (const [time, value, quality] of answer.records) {
			past.x.push(Math.max(from, time));
			past.last.push(quality && goodCode(quality) ? value : null);
		}
		next = answer.next > next ? answer.next : null;
	}
	if (next) {
		past.cut = next;
		past.x.push(next);
		past.last.push(null); // nobody knows here how it goes on
	}
	return past;
}

/** Ask for the kind of table, and save it; drawn: [{signal, past}]. What to tell; null: it is not. */
export async function saveTable(drawn, [from, until]) {
	const raw = el("input", {type: "checkbox", id: "csv-raw", disabled: !store.info?.history});
	if (!await ask("Save a table", "Save", [
		el("p", {}, "It has a column for each signal, and local time. A cell is empty where the value "
			+ "was not good."),
		el("label", {for: "csv-raw", class: "check"}, raw, "Each recorded value, not what is drawn"),
		el("p", {class: "hint"}, "Recorded values end at what owsd-recorder has written: the last "
			+ "minutes may not be among them.")]))
		return null;
	const all = raw.checked ? await Promise.all(drawn.map(async ({signal}) =>
		({signal, past: await recordsOf(signal, from, until)}))) : drawn;
	const stamp = new Date(until).toISOString().slice(0, 19).replaceAll(":", "");
	save(`${store.info?.instance ?? "owsd"}-${stamp}.csv`, csvOf(all, raw.checked));
	const cut = all.filter(({past}) => past.cut).map(({signal, past}) =>
		`${signal.name} is cut at ${dateAndClock(past.cut)}`);
	return cut.length ? `The table is too long: ${cut.join(", ")}. Save a shorter time.`
		: "The table is saved.";
}
