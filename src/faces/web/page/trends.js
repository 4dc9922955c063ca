// SPDX-License-Identifier: MIT
// The view Trends: the signals that the user picks, in a window of time that is moved by buttons or
// by dragging, and that follows the present until it is.
import {announce, el, later, put} from "./dom.js";
import {Plot} from "./plot.js";
import {continued, csvOf, pastOf, save} from "./series.js";
import {store} from "./store.js";
import {dateAndClock} from "./words.js";

const SPANS = [[600, "10 min"], [3600, "1 h"], [28800, "8 h"], [86400, "1 d"], [604800, "7 d"],
	[2592000, "30 d"]];
const LINES = 6; // at most, in one colour each: that many --line-N has style.css
const LEAST_MS = 2000, FRAME_MS = 1000, FETCH_MS = 5000, POINTS = 600;

const state = {picked: [], span: 600000, until: null}; // until null: follows the present
const LIBRARY = "dygraph.min.js"; // comes when it is needed: it is as large as all else
let shown = false, ready = false, list, filter, plots = [], area, hint, absent, times, live;
let pasts = new Map(), asked = 0;

export function build(root) {
	filter = el("input", {type: "search", placeholder: "Search",
		"aria-label": "Search signals to pick", oninput: drawList});
	list = el("ul", {class: "picks"});
	const picker = el("details", {class: "picker"}, el("summary", {}, "Signals"), filter, list);
	picker.open = matchMedia("(min-width: 44rem)").matches;
	hint = el("p", {class: "hint", role: "status"});
	absent = el("p", {class: "note", role: "status", hidden: true});
	times = el("p", {class: "times"});
	area = el("div", {class: "plots"});
	live = el("button", {type: "button", "aria-pressed": "true", onclick: () => move(null)},
		"Follow");
	const move_by = (part) => move((state.until ?? store.now()) + part * state.span);
	const button = (text, label, act) => el("button", {type: "button", "aria-label": label,
		onclick: act}, text);
	const spans = SPANS.map(([seconds, text]) => el("button", {type: "button", class: "span",
		"data-span": seconds * 1000, onclick: () => {
			state.span = seconds * 1000;
			move(null);
		}}, text));
	root.append(el("div", {class: "tools", role: "group", "aria-label": "Window of time"},
		...spans, button("\u2190", "Earlier", () => move_by(-0.5)),
		button("\u2192", "Later", () => move_by(0.5)),
		button("+", "Zoom in", () => zoom(0.5)), button("\u2212", "Zoom out", () => zoom(2)), live,
		el("button", {type: "button", onclick: exported}, "Save as CSV")), times, hint, absent,
	el("div", {class: "columns"}, picker, area));
	store.addEventListener("signals", renewed);
	setInterval(frame, FRAME_MS);
	setInterval(() => shown && state.until === null && !document.hidden && fetchAll(), FETCH_MS);
	new ResizeObserver(later(() => shown && draw(), 200)).observe(area);
	matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => shown && arrange());
}

export function show(query) {
	const given = new URLSearchParams(query);
	shown = true;
	if (given.has("s"))
		state.picked = given.getAll("s").slice(0, LINES);
	if (Number(given.get("span")) >= LEAST_MS)
		state.span = Number(given.get("span"));
	if (given.has("until"))
		state.until = Number(given.get("until")) || null;
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
function remember() {
	const query = new URLSearchParams(state.picked.map((name) => ["s", name]));
	query.set("span", String(Math.round(state.span)));
	if (state.until !== null)
		query.set("until", String(Math.round(state.until)));
	history.replaceState(null, "", `#trends?${query}`);
}

const numeric = () => store.signals.filter((signal) => signal.type !== "string");
const picked = () => state.picked.map((name) => store.find(name)).filter(Boolean);

function renewed() {
	if (!shown || !ready)
		return;
	if (!state.picked.length)
		state.picked = numeric().filter((signal) => signal.unit).slice(0, 2)
			.map((signal) => signal.name);
	drawList();
	arrange();
}

function drawList() {
	const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
	const found = numeric().filter(({name, description, device}) => words.every((word) =>
		`${name} ${description ?? ""} ${device ?? ""}`.toLowerCase().includes(word)));
	list.replaceChildren(...found.map((signal) => {
		const box = el("input", {type: "checkbox", onchange: () => pick(signal.name, box)});
		box.checked = state.picked.includes(signal.name);
		return el("li", {}, el("label", {}, box, ` ${signal.name}`,
			signal.unit ? el("span", {class: "unit"}, ` ${signal.unit}`) : null));
	}));
}

function pick(name, box) {
	state.picked = state.picked.filter((one) => one !== name);
	if (box.checked && state.picked.length >= LINES) {
		box.checked = false;
		announce(`At most ${LINES} signals.`);
		put(hint, `A trend has at most ${LINES} signals.`);
	} else if (box.checked) {
		state.picked.push(name);
	}
	remember();
	arrange();
}

// --- The window of time ---------------------------------------------------------------------

const window_ = () => {
	const until = state.until ?? store.now();
	return [until - state.span, until];
};

function move(until) {
	state.until = until === null || until >= store.now() ? null : until;
	remember();
	fetchAll();
	draw();
}

function zoom(factor) {
	const [from, until] = window_(), middle = (from + until) / 2;
	state.span = Math.max(LEAST_MS, state.span * factor);
	move(state.until === null ? null : middle + state.span / 2);
}

function point(time) {
	for (const {plot} of plots)
		plot.point(time);
}

function zoomTo(from, until) {
	state.span = Math.max(LEAST_MS, until - from);
	move(until);
}

// --- Plots ----------------------------------------------------------------------------------

/** A plot for each unit. */
function arrange() {
	for (const {plot} of plots)
		plot.end();
	const units = new Map();
	picked().forEach((signal, n) => {
		signal.watched = true; // longer kept
		const key = signal.type === "bool" ? "on or off" : signal.unit || "";
		units.set(key, [...units.get(key) ?? [], {signal, n}]);
	});
	plots = [...units.values()].map((members) => ({members, plot: new Plot(
		members.map(({signal}) => signal), members.map(({n}) => n), zoomTo, point)}));
	area.replaceChildren(...(plots.length ? plots.map(({plot}) => plot.node)
		: [el("p", {class: "note"}, "Pick signals to see what they had.")]));
	fetchAll();
	draw();
}

async function fetchAll() {
	const mine = ++asked, [from, until] = window_();
	const points = Math.min(POINTS, Math.max(60, Math.round(area.clientWidth / 2)));
	try {
		const all = await Promise.all(picked().map((signal) =>
			pastOf(signal, from, until, points)));
		if (mine !== asked)
			return;
		pasts = new Map(all.map((past) => [past.name, past]));
		put(hint, store.info?.history ? "" : "Nothing is recorded (owsd-recorder does not run): "
			+ "this is what the page has seen since it was opened.");
	} catch (error) {
		if (mine === asked)
			put(hint, `The history cannot be read: ${error.message}.`);
	}
	draw();
}

const EMPTY = {x: [], min: [], max: [], last: [], code: [], gap: []};

function draw() {
	if (!shown)
		return;
	const [from, until] = window_();
	live.setAttribute("aria-pressed", String(state.until === null));
	for (const button of live.parentNode.querySelectorAll(".span"))
		button.setAttribute("aria-pressed", String(Number(button.dataset.span) === state.span));
	put(times, `${dateAndClock(from)} to ${state.until === null ? "now" : dateAndClock(until)}`);
	for (const {members, plot} of plots)
		plot.show(members.map(({signal}) => continued(pasts.get(signal.name)
			?? {name: signal.name, ...EMPTY}, signal, from, until)), [from, until]);
}

function frame() {
	if (shown && state.until === null && !document.hidden && plots.length)
		draw();
}

function exported() {
	const [from, until] = window_();
	const all = picked().map((signal) => ({signal, past: continued(pasts.get(signal.name)
		?? {name: signal.name, ...EMPTY}, signal, from, until)}));
	const stamp = new Date(until).toISOString().slice(0, 19).replaceAll(":", "");
	save(`${store.info?.instance ?? "owsd"}-${stamp}.csv`, csvOf(all));
	announce("The table is saved.");
}
