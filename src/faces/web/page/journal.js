// SPDX-License-Identifier: MIT
// What happened, a part of the view Alarms: search, kinds, a day, how much in each hour.
import {get} from "./api.js";
import {badge} from "./badge.js";
import {button, el, put, table} from "./dom.js";
import {happenings, hourOf, hoursOf, isLost, joined, matches} from "./happened.js";
import {store} from "./store.js";
import {daysLater, dayText, midnight, moment} from "./when.js";
import {alarmOf, clock, dateAndClock, msOf, span, valueText, withUnit, wordsOf} from "./words.js";

const DAYS = 7, ENTRIES = 1000, PAGE = 50;
const KINDS = [["", "All"], ["alarms", "Alarms"], ["commands", "Commands"]];
const COLUMNS = [["Time", "time"], "Signal", "What", ["Value", "right"], ["Lasted", "right"], "By"];

const state = {words: [], kind: "", day: null, hour: null, pages: 1};
let kinds, day, hours, lines, foot, all = [], raw = [], cut = false, standing = new Set();

/** The alarm that was raised last. */
export const last = () => all.find(({what}) => what === "raised");

function change(values) {
	Object.assign(state, {pages: 1}, values);
	paint();
}

export function build(root) {
	const search = el("input", {type: "search", id: "journal-search", autocomplete: "off",
		placeholder: "Name, person, words", "aria-label": "Search what happened",
		oninput: () => change({words: wordsOf(search.value)})});
	kinds = KINDS.map(([value, text]) => button(text, () => change({kind: value}), {class: "chip",
		"aria-pressed": "false", "data-kind": value}));
	day = el("select", {id: "day", "aria-label": "Day",
		onchange: () => choose(Number(day.value))});
	hours = el("div", {class: "hours", role: "group", "aria-label": "How much in each hour"});
	lines = el("div", {});
	foot = el("p", {class: "hint"});
	root.append(el("div", {class: "tools past"}, el("h2", {id: "h-past"}, "What happened"), search,
		...kinds, day), el("div", {class: "sheet happened"}, hours, lines, foot));
}

const begin = () => daysLater(midnight(store.now()), 1 - DAYS);

/** Fetch what was before the oldest entry that is here. */
async function older() {
	const {entries = []} = await get("journal", {since: begin(), until: msOf(raw.at(-1).time) + 1,
		n: ENTRIES});
	const known = raw.length;
	raw = joined(raw, entries, Infinity);
	cut = entries.length >= ENTRIES && raw.length > known;
	all = happenings(raw, (name) => store.find(name));
}

/* A day, with all its entries. */
async function choose(value) {
	change({day: value, hour: null});
	try {
		while (cut && state.day === value && msOf(raw.at(-1).time) >= value)
			await older();
	} catch (error) {
		put(foot, `The entries of this day cannot be fetched: ${error.message}.`);
		return;
	}
	paint();
}

export async function look() {
	const {entries = []} = await get("journal", {since: begin(), n: ENTRIES});
	const known = raw.length;
	raw = joined(entries, raw, ENTRIES).filter(({time}) => msOf(time) >= begin());
	if (!known || raw.length === entries.length)
		cut = entries.length >= ENTRIES;
	all = happenings(raw, (name) => store.find(name));
	const today = midnight(store.now());
	if (Number(day.lastChild?.value) === begin())
		return;
	state.day = today;
	day.replaceChildren(...Array.from({length: DAYS}, (_, n) => {
		const at = daysLater(today, -n);
		return el("option", {value: at}, n ? dayText(at) : `${dayText(at)}, today`);
	}));
}

export function draw(alarms) {
	standing = new Set(alarms.map(({name, alarm}) => `${name} ${alarm}`));
	paint();
}

const stands = ({what, name, alarm, ended, over}) =>
	what === "raised" && ended === null && !over && standing.has(`${name} ${alarm}`);

function paint() {
	for (const chip of kinds)
		chip.setAttribute("aria-pressed", String(chip.dataset.kind === state.kind));
	const from = state.day, until = daysLater(from, 1);
	const wanted = all.filter((one) => one.time >= from && one.time < until
		&& (!state.kind || one.journal === state.kind) && matches(one, state.words));
	paintHours(hoursOf(wanted));
	paintLines(wanted.filter((one) => state.hour === null || hourOf(one) === state.hour));
}

function paintHours(counts) {
	const most = Math.max(1, ...counts);
	if (!hours.firstChild)
		hours.append(...counts.map((_, n) => el("button", {type: "button",
			onclick: () => change({hour: state.hour === n ? null : n})},
		el("i", {}), el("span", {class: "range", "aria-hidden": "true"},
			n % 3 ? "" : `${String(n).padStart(2, "0")}:00`))));
	for (const [n, count] of counts.entries()) {
		const bar = hours.children[n];
		bar.disabled = !count && state.hour !== n;
		bar.setAttribute("aria-pressed", String(state.hour === n));
		bar.setAttribute("aria-label", `${n} to ${n + 1} o'clock: ${count}`);
		bar.firstChild.style.height = count ? `${Math.max(8, count / most * 100)}%` : "0";
	}
}

function whatOf(one) {
	const {alarm, what, ended, seen, more} = one;
	if (!alarm)
		return what;
	const mark = badge(alarmOf(`${stands(one) && !seen ? "! " : ""}${alarm}`));
	return el("span", {}, mark, el("span", {class: "hint"}, " ", [
		what === "raised" ? ended === null ? "" : "and returned" : what,
		seen ? `acknowledged by ${seen.by}, ${clock(seen.time).slice(0, 5)}` : "", more]
		.filter(Boolean).join(", ")));
}

function lastedOf(one) {
	if (one.ended !== null)
		return span((one.ended - one.time) / 1000);
	return stands(one) ? `${span((store.now() - one.time) / 1000)}, stands` : "";
}

function paintLines(wanted) {
	const some = wanted.slice(0, state.pages * PAGE);
	const made = table("What happened", COLUMNS, some.map((one) => {
		const signal = store.find(one.name) ?? {};
		return [el("span", {title: dateAndClock(one.time)}, clock(one.time)),
			el("b", {class: "name"}, one.name), whatOf(one),
			one.value === null || one.value === undefined ? ""
				: withUnit(signal, valueText(signal, one.value)), lastedOf(one), one.by];
	}), state.words.length || state.kind || state.hour !== null ? "Nothing matches."
		: "Nothing happened on this day.");
	for (const [n, one] of some.entries())
		if (stands(one))
			made.tBodies[0].rows[n].firstChild.classList.add(isLost(one.alarm) ? "edge-bad" : "edge-alarm");
	lines.replaceChildren(made);
	const left = wanted.length - some.length, from = state.day;
	const focused = foot.contains(document.activeElement);
	foot.replaceChildren(left
		? button(`Older, ${left} more`, () => change({pages: state.pages + 1}))
		: "Each line is a whole happening: raised and returned are one.",
	cut && msOf(raw.at(-1).time) >= from ? button("Fetch all of this day, here is what came after "
		+ moment(raw.at(-1).time, store.now()), () => choose(state.day)) : "");
	if (focused)
		foot.querySelector("button")?.focus();
}
