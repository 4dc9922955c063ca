// SPDX-License-Identifier: MIT
// The view Live: what needs somebody, the tiles, and all signals in groups or as a list.
import {Chips, NO_CHOICE} from "./chips.js";
import {button, el, later, put} from "./dom.js";
import {Headline} from "./headline.js";
import {COLUMNS, columnsOf, groupsOf, passes, readAddress, showOf, sorted, toggled,
	writeAddress} from "./order.js";
import {Row, shared} from "./row.js";
import {Painter, fill, fillAll} from "./rows.js";
import {scaleOf} from "./scale.js";
import {groupCard, table} from "./sheets.js";
import {store} from "./store.js";
import {Tiles, firstOf} from "./tiles.js";
import {clock, wordsOf} from "./words.js";
import {Where, limitsOf} from "./where.js";

const SHOWS = [["groups", "Groups"], ["list", "List"], ["wall", "Wall"]];
const ORDER_MS = 2000, ORDER_MANY_MS = 15000, MANY = 1000; // how often a list is put in order

let state = readAddress("");
let rows = [], bodies = [], drawn = "";
const rowOf = new Map(), visible = new Set();
let view, search, chips, toggle, orderOf, place, empty, headline, tiles, where, time;
let shown = false;

const widths = [matchMedia("(min-width: 112.5rem)"), matchMedia("(min-width: 62.5rem)")];

const seen = "IntersectionObserver" in window && new IntersectionObserver((entries) => {
	for (const {target, isIntersecting} of entries) {
		if (isIntersecting) {
			fill(target);
			visible.add(target);
		} else {
			visible.delete(target);
		}
	}
	tick();
}, {rootMargin: "200px"});

const mode = () => showOf(state.show, rows);

export function build(root) {
	view = root;
	state = readAddress(location.hash.startsWith("#live") ? location.hash.split("?")[1] ?? "" : "");
	root.querySelector("h1").classList.add("unseen");
	headline = new Headline(open, () => change({only: "bad", show: state.show === "wall" ? "" : state.show}));
	tiles = new Tiles(open, (names) => change({tiles: names}));
	where = new Where({choose: (from, to) => change({from, to}), open,
		blind: () => change({only: "bad"})});
	search = el("input", {type: "search", id: "search", placeholder: "Search", value: state.q,
		"aria-label": "Search signals by name, place, state", autocomplete: "off",
		oninput: () => change({q: search.value})});
	chips = new Chips(change);
	orderOf = el("select", {class: "order chip", "aria-label": "Order", onchange: () =>
		change({order: orderOf.value})}, ...[["", "as in the file"], ...COLUMNS].map(([value, text]) =>
		el("option", {value: value === "value" ? "-value" : value}, `Order: ${text.toLowerCase()}`)));
	toggle = el("div", {class: "shows", role: "group", "aria-label": "Show"},
		...SHOWS.map(([value, text]) => button(text, () => change({show: value}), {value})));
	place = el("div", {class: "place"});
	time = el("span", {class: "time"});
	empty = el("p", {class: "empty sheet", hidden: true});
	view.append(el("div", {class: "headline"}, time, ...headline.nodes), tiles.node, where.node,
		el("div", {class: "tools", role: "search"}, search, chips.node, orderOf, toggle), empty, place);
	place.addEventListener("click", clicked);
	store.addEventListener("signals", make);
	store.addEventListener("values", ({detail}) => paintSoon(detail));
	store.addEventListener("trust", () => paintSoon(store.signals));
	for (const width of widths)
		width.addEventListener("change", () => mode() === "groups" && arrange());
	setInterval(tick, 1000);
	make();
}

export function show(query) {
	shown = true;
	if (query) {
		state = readAddress(query);
		search.value = state.q;
		arrange();
		if (state.signal)
			open(state.signal);
	} else {
		remember();
	}
	wall();
	tick();
}

export function hide() {
	shown = false;
	wall();
}

const wall = () => document.documentElement.classList.toggle("is-wall", shown && mode() === "wall");

const remember = () => {
	if (shown && writeAddress(state) !== "#live" || location.hash.startsWith("#live?"))
		history.replaceState(null, "", writeAddress(state));
};

/** Somebody wants to see something else. */
function change(wanted) {
	Object.assign(state, wanted, {signal: null});
	remember();
	if (Object.keys(wanted).some((key) => ["show", "order", "unit"].includes(key)))
		arrange();
	else
		filter();
	wall();
}

function make() {
	rowOf.clear();
	painter.clear();
	const {signals} = store;
	shared.mixed = new Set(signals.filter((s) => s.good).map((s) => s.simulated)).size > 1;
	rows = signals.map((signal) => {
		const row = new Row(signal);
		rowOf.set(signal, row);
		return row;
	});
	arrange();
	if (state.signal)
		open(state.signal);
}

// --- Groups and list ------------------------------------------------------------------------

/** The one unit of what is shown as a list; null: there are several. */
function unitOf() {
	const units = new Set(rows.filter((row) => !state.unit || row.signal.unit === state.unit)
		.map(({signal}) => signal.unit).filter(Boolean));
	return units.size === 1 ? [...units][0] : null;
}

const orderNow = () => state.order || (mode() === "list" && unitOf() ? "-value" : "");

function measure() {
	const unit = mode() === "list" ? unitOf() : null;
	const members = rows.filter(({signal}) => unit && signal.unit === unit);
	const limits = limitsOf(members);
	shared.scale = unit && scaleOf(members.map(({value}) => value).filter((v) => v !== null)
		.map(Number), [limits.l, limits.h].filter((v) => Number.isFinite(v ?? NaN)));
	where.paint(members, unit, shared.scale);
	place.classList.toggle("no-scale", !shared.scale);
	return unit;
}

function arrange() {
	visible.clear();
	seen?.disconnect();
	bodies = [];
	const now = mode(), unit = measure();
	if (now === "list") {
		place.replaceChildren(el("div", {class: "sheet"},
			table("Signals", sorted(rows, orderNow()), bodies,
				{order: orderNow(), unit, choose: (order) => change({order})})));
	} else {
		const columns = widths[0].matches ? 3 : widths[1].matches ? 2 : 1;
		place.replaceChildren(...columnsOf(groupsOf(rows), columns).map((groups) =>
			el("div", {class: "column"}, ...groups.map((group) => groupCard(group, bodies)))));
	}
	place.className = `place is-${now}${shared.scale ? "" : " no-scale"}`;
	drawn = names();
	for (const button of toggle.children)
		button.setAttribute("aria-pressed", String(button.value === now));
	orderOf.value = orderNow();
	orderOf.hidden = now !== "list";
	filter();
	fillAll(bodies);
	for (const body of bodies)
		if (seen)
			seen.observe(body);
		else
			visible.add(body);
}

const names = () => mode() === "list" ? sorted(rows, orderNow()).map(({signal}) => signal.i).join() : "";

function filter() {
	const words = wordsOf(state.q);
	for (const row of rows)
		row.hidden = words.length > 0 && !row.matches(words) || !passes(row, state);
	for (const body of bodies)
		body.hidden = body.rows_.every((row) => row.hidden);
	for (const card of place.querySelectorAll(".group"))
		card.hidden = [...card.querySelectorAll("tbody")].every((body) => body.hidden);
	const none = rows.length > 0 && rows.every((row) => row.hidden);
	const wanted = state.q ? `matches \u201c${state.q}\u201d` : "is like that";
	empty.hidden = !none;
	place.hidden = none;
	if (none)
		empty.replaceChildren(`No signal ${wanted}. `, button(`Show all ${rows.length}.`, clear,
			{class: "link"}));
	tiles.set(tileNames());
	summary();
}

function clear() {
	search.value = "";
	change({q: "", ...NO_CHOICE});
	search.focus();
}

// --- What one clicks ------------------------------------------------------------------------

/* At first some, but where a picture shows where all are. */
const tileNames = () => state.tiles ?? (where.node.hidden ? firstOf(store.signals) : []);

const starOf = (row) => ({pressed: () => tileNames().includes(row.signal.name),
	toggle: () => {
		change({tiles: toggled(tileNames(), row.signal.name)});
		row.paint();
	}});

function clicked({target}) {
	const row = target.closest("tr.row")?.row_;
	if (!row || target.closest(".control, .c-detail, thead")
		|| !target.closest("button") && String(getSelection()))
		return;
	row.toggle(starOf(row));
}

/** Show a row with its details. */
function open(name) {
	const row = rows.find(({signal}) => signal.name === name);
	if (!row)
		return;
	if (mode() === "wall")
		change({show: ""});
	if (row.hidden)
		clear();
	fill(bodies.find((body) => body.rows_.includes(row)));
	row.toggle(starOf(row), true);
	row.name.focus({preventScroll: true});
	row.node.scrollIntoView({block: "center"});
}

// --- Painting -------------------------------------------------------------------------------

const summary = () => {
	for (const row of rows)
		row.now = null; // what was not painted may be late meanwhile
	headline.paint(rows);
	chips.paint(rows, state, mode() === "list");
	if (mode() === "list")
		measure();
};
const [soon, lessSoon] = [200, 1000].map((ms) => later(summary, ms));
const summarySoon = () => rows.length > MANY ? lessSoon() : soon();
let ordered = 0;

/* Not while somebody points at a row, or has the focus in one. */
function reorder() {
	if (mode() !== "list" || place.matches(":hover") || place.contains(document.activeElement)
		|| performance.now() < ordered + (rows.length > MANY ? ORDER_MANY_MS : ORDER_MS))
		return;
	ordered = performance.now();
	if (names() !== drawn)
		arrange();
}

const painter = new Painter(() => visible, summarySoon);

function paintSoon(signals) {
	painter.soon([...signals].map((signal) => rowOf.get(signal)));
	tiles.paint(signals instanceof Set ? signals : null);
	summarySoon();
}

/* Ages count up and lines move on, of what can be seen. */
function tick() {
	put(time, clock(store.now()).slice(0, 5));
	if (!shown || document.hidden)
		return;
	tiles.paintLines();
	for (const body of visible)
		for (const row of body.rows_ ?? [])
			if (row.built && !row.hidden) {
				row.paintAge();
				row.paintLine();
			}
	reorder();
	summarySoon();
}
