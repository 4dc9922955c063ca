// SPDX-License-Identifier: MIT
// The view Trends: the signals that the user picks, in a window of time that is moved by buttons, by
// dragging, by the wheel or by keys, and that follows the present until it is.
import {alone} from "./alone.js";
import {saveTable} from "./csv.js";
import {el, later, put} from "./dom.js";
import {Entries} from "./entries.js";
import {alarmsOf} from "./marks.js";
import {Picker} from "./picker.js";
import {continued, emptyPast, heldAt, pastOf} from "./series.js";
import {Stack} from "./stack.js";
import {store} from "./store.js";
import {Tools} from "./tools.js";
import {besideOf, daysLater, moment} from "./when.js";
import {qualityWords, valueText, withUnit} from "./words.js";

const LINES = 6; // at most, in one colour each: that many --line-N has style.css
const LEAST_MS = 2000, FRAME_MS = 1000, FETCH_MS = 5000, REST_MS = 250, POINTS = 600, BACK = 20;
const BEFORE_MS = 86400000, ENTRIES = 1000; // of the journal, for alarms that began before

// until null: follows the present; given: the user has picked, not the page; beside: the same time
// of days before is drawn, too
const state = {picked: [], span: 600000, until: null, given: false, beside: false};
const LIBRARY = "dygraph.min.js"; // comes when it is needed: it is as large as all else
const journal = new Entries();
let shown = false, ready = false, picker, stack, hint, told, absent, tools, before = [];
let pasts = new Map(), olds = new Map(), entries = [], asked = 0, cursor = null;
let resting = 0; // a timer: the window has not moved for a while

export function build(root) {
	hint = el("p", {class: "hint", role: "status"});
	told = el("p", {class: "hint", role: "status", id: "trend-told"});
	absent = el("p", {class: "note", role: "status", hidden: true});
	picker = new Picker({add, remove: (name) => pick(state.picked.filter((one) => one !== name)),
		has: (name) => state.given && state.picked.includes(name)});
	stack = new Stack({zoom: (from, until) => goTo([from, until], true), factor: zoom, back, point,
		words: wordsAt});
	tools = new Tools({span, shift, go: goTo, follow: () => move(null), beside, link, table: exported,
		fault: (words) => put(told, words)}, root.querySelector("h1"));
	root.append(tools.node, told, hint, absent, el("div", {class: "columns"}, picker.node,
		el("figure", {class: "trend sheet"}, stack.node)));
	store.addEventListener("signals", renewed);
	setInterval(frame, FRAME_MS);
	const again = alone(fetchAll); // one that takes longer would never come to its end
	setInterval(() => shown && state.until === null && !document.hidden && again(), FETCH_MS);
	const soon = later(() => shown && draw(), 200);
	new ResizeObserver(soon).observe(stack.node);
	window.addEventListener("resize", soon);
	matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => shown && arrange());
}

export function show(query) {
	const given = new URLSearchParams(query);
	shown = true;
	if (given.has("s")) {
		state.picked = given.getAll("s").slice(0, LINES);
		state.given = true;
	}
	if (Number(given.get("span")) >= LEAST_MS)
		state.span = Number(given.get("span"));
	state.until = Number(given.get("until") ?? state.until) || null;
	state.beside = given.has("beside");
	load().then(renewed);
}

/* Without the library there are figures and no plots; the next look at the view asks again. */
async function load() {
	const came = globalThis.Dygraph || await new Promise((done) => {
		document.head.append(el("script", {src: LIBRARY, onload: () => done(true),
			onerror: () => done(false)}));
	});
	if (!came)
		put(absent, await missing());
	absent.hidden = Boolean(came);
	stack.node.parentNode.hidden = !came;
	ready = true;
}

async function missing() {
	const answer = await fetch(LIBRARY).catch(() => null);
	return answer?.status === 404 ? "This owsd-web has no plots, only figures: it was built without "
		+ "dygraphs (package libjs-dygraphs)."
		: "The page cannot get its plots from owsd-web. Choose the view again.";
}

export const hide = () => { shown = false; };

/* The choice stands in the address, so that it can be kept and sent. */
function address(until) {
	const query = new URLSearchParams(state.picked.map((name) => ["s", name]));
	query.set("span", String(Math.round(state.span)));
	if (until !== null)
		query.set("until", String(Math.round(until)));
	if (state.beside)
		query.set("beside", "1");
	return `#trends?${query}`;
}

const remember = () => history.replaceState(null, "", address(state.until));

/* With the time of now, so that it shows the same picture tomorrow. */
async function link() {
	const link = new URL(address(window_()[1]), location.href).href;
	try {
		await navigator.clipboard.writeText(link);
		put(told, "The link to this picture is copied.");
	} catch {
		put(told, `The browser lets the page copy nothing here. The link: ${link}`);
	}
}

const numeric = () => store.signals.filter((signal) => signal.type !== "string");
const picked = () => state.picked.map((name) => store.find(name)).filter(Boolean);

function renewed() {
	if (!shown || !ready)
		return;
	if (!state.picked.length && !state.given)
		state.picked = numeric().filter((signal) => signal.unit).slice(0, 2)
			.map((signal) => signal.name);
	arrange();
}

function pick(names) {
	state.picked = names;
	state.given = true;
	put(told, "");
	remember();
	arrange();
}

/* What the page has picked by itself goes when the user does. */
function add(name) {
	const names = state.given ? state.picked : [];
	if (names.length < LINES) {
		pick([...names.filter((one) => one !== name), name]);
		return;
	}
	put(told, `A trend has at most ${LINES} signals. Remove one first.`);
}

// --- The window of time ---------------------------------------------------------------------

const window_ = () => {
	const until = state.until ?? store.now();
	return [until - state.span, until];
};

function move(until) {
	state.until = until === null || until >= store.now() ? null : until;
	put(told, "");
	asked++; // an answer for the window of before comes too late
	clearTimeout(resting);
	resting = setTimeout(() => {
		resting = 0;
		fetchAll();
	}, REST_MS);
	remember();
	draw();
}

function span(ms) {
	keep();
	state.span = ms;
	move(state.until);
}

const shift = (part) => move((state.until ?? store.now()) + part * state.span);

function beside() {
	state.beside = !state.beside;
	remember();
	fetchAll();
}

function goTo([from, until], series = false) {
	keep(series);
	state.span = Math.max(LEAST_MS, until - from);
	move(until);
}

/* For the way back: where a series of moves began. */
function keep(series = false) {
	if (!series || !resting)
		before = [...before.slice(1 - BACK), [state.span, state.until]];
}

function back() {
	if (!before.length)
		return;
	[state.span, state.until] = before.pop();
	move(state.until);
}

function zoom(factor) {
	const [from, until] = window_(), middle = (from + until) / 2;
	keep();
	state.span = Math.max(LEAST_MS, state.span * factor);
	move(state.until === null ? null : middle + state.span / 2);
}

// --- Plots ----------------------------------------------------------------------------------

/** A plot for each unit; those that are on or off are below. */
function arrange() {
	const units = new Map(), all = picked().map((signal, number) => ({signal, number}));
	for (const {signal, number} of all) {
		signal.watched = true; // longer kept
		const key = signal.type === "bool" ? null : signal.unit || "";
		const group = units.get(key) ?? {signals: [], numbers: []};
		group.signals.push(signal);
		group.numbers.push(number);
		units.set(key, group);
	}
	picker.take(numeric(), all);
	const switches = units.get(null);
	units.delete(null);
	if (globalThis.Dygraph)
		stack.arrange([...units.values(), ...switches ? [switches] : []]);
	fetchAll();
	draw();
}

const days = () => besideOf(state.span)[0];

async function fetchAll() {
	const mine = ++asked, [from, until] = window_();
	const points = Math.min(POINTS, Math.max(60, Math.round(stack.node.clientWidth / 2)));
	try {
		const all = (start, end) => Promise.all(picked().map((signal) =>
			pastOf(signal, start, end, points)));
		const [happened, now, old] = await Promise.all([
			journal.from(from - BEFORE_MS, ENTRIES), all(from, until),
			state.beside ? all(daysLater(from, -days()), daysLater(until, -days())) : []]);
		if (mine !== asked)
			return;
		entries = happened;
		pasts = new Map(now.map((past) => [past.name, past]));
		olds = new Map(old.map((past) => [past.name, {...past, x: past.x.map((time) =>
			daysLater(time, days()))}]));
		put(hint, store.info?.history ? "" : "Nothing is recorded (owsd-recorder does not run): "
			+ "this is what the page has seen since it was opened.");
	} catch (error) {
		if (mine === asked)
			put(hint, `The history cannot be read: ${error.message}.`);
	}
	draw();
}

const pastNow = (signal) => continued(pasts.get(signal.name) ?? emptyPast(signal.name), signal,
	...window_());

function draw() {
	if (!shown || !ready)
		return;
	const [from, until] = window_(), all = new Map(picked().map((signal) =>
		[signal, pastNow(signal)]));
	tools.draw({from, until: state.until, span: state.span, beside: state.beside});
	stack.show([from, until], (signal) => all.get(signal), (signal) => state.beside
		? olds.get(signal.name) : null, alarmsOf(entries, picked(), [from, until], store.now()));
	figures([...all.values()]);
}

function figures(all = picked().map(pastNow)) {
	picker.figures(all, window_(), cursor, cursor === null
		? state.until === null ? "of now" : `at the end, ${moment(state.until, store.now())}`
		: `at the cursor, ${moment(cursor, store.now(), state.span < 3600000)}`);
}

function point(time) {
	cursor = time;
	stack.point(time);
	figures();
}

/** For a reader: the time, and what each signal had. */
function wordsAt(time) {
	return [moment(time, store.now(), true), ...picked().map((signal) => {
		const past = pastNow(signal), at = heldAt(past, time);
		const value = at < 0 ? null : past.last[at];
		return `${signal.name} ${value === null ? at < 0 ? "unknown" : qualityWords(past.code[at])
			: withUnit(signal, valueText(signal, value))}`;
	})].join("; ");
}

function frame() {
	if (shown && state.until === null && !document.hidden)
		draw();
}

async function exported() {
	try {
		const words = await saveTable(picked().map((signal) => ({signal, past: pastNow(signal)})),
			window_());
		if (words)
			put(told, words);
	} catch (error) {
		put(told, `The table cannot be made: ${error.message}.`);
	}
}
