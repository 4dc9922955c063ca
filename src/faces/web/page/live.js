// SPDX-License-Identifier: MIT
// The view Live: all signals with value, quality and age, by device, by name or by state.
import {el, later, put} from "./dom.js";
import {Row} from "./row.js";
import {Painter, chunked, fill, fillAll, reserve} from "./rows.js";
import {store} from "./store.js";
import {alarmOf, stateOf} from "./words.js";

const SIMULATOR = "/simulator/"; // paths of outputs that disturb a simulated wire
const OTHERS = {[SIMULATOR]: "Simulation", "": "Without a device"};

const state = {query: "", order: "device"};
let rows = [];
const rowOf = new Map(), visible = new Set();
let view, list, count, shown = false;

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

export function build(root) {
	view = root;
	const search = el("input", {type: "search", id: "search", placeholder: "Search",
		"aria-label": "Search signals by name, device, state", autocomplete: "off",
		oninput: () => {
			state.query = search.value;
			filter();
			remember();
		}});
	const order = el("select", {id: "order", onchange: () => {
		state.order = order.value;
		arrange();
		remember();
	}}, ...[["device", "device"], ["name", "name"], ["state", "state"]].map(([value, text]) =>
		el("option", {value}, text)));
	const given = new URLSearchParams(location.hash.split("?")[1] ?? "");
	search.value = state.query = given.get("q") ?? "";
	order.value = ["name", "state"].includes(given.get("order")) ? given.get("order") : "device";
	state.order = order.value;
	count = el("p", {class: "count", id: "count"});
	list = el("table", {class: "live", role: "table", "aria-label": "Signals"});
	view.append(el("div", {class: "tools", role: "search"}, search,
		el("label", {for: "order"}, "Order by"), order, count), list);
	view.refresh = (text) => {
		const asked = new URLSearchParams(text);
		search.value = state.query = asked.get("q") ?? state.query;
		filter();
	};
	store.addEventListener("signals", make);
	store.addEventListener("values", ({detail}) => paintSoon(detail));
	store.addEventListener("trust", () => paintSoon(store.signals));
	setInterval(tick, 1000);
	make();
}

export function show(query) {
	shown = true;
	if (query)
		view.refresh(query);
	tick();
}

export const hide = () => { shown = false; };

function remember() {
	const query = new URLSearchParams();
	if (state.query)
		query.set("q", state.query);
	if (state.order !== "device")
		query.set("order", state.order);
	history.replaceState(null, "", `#live${query.size ? `?${query}` : ""}`);
}

function make() {
	rowOf.clear();
	painter.clear();
	rows = store.signals.map((signal) => {
		const row = new Row(signal);
		rowOf.set(signal, row);
		return row;
	});
	arrange();
}

// --- Order and groups -----------------------------------------------------------------------

const byName = (a, b) => a.signal.name.localeCompare(b.signal.name, "en", {numeric: true});

function groups() {
	if (state.order === "device") {
		const found = new Map();
		for (const row of rows) {
			const key = row.signal.device || (row.signal.path?.startsWith(SIMULATOR) ? SIMULATOR : "");
			if (!found.get(key)?.push(row))
				found.set(key, [row]);
		}
		return [...found].map(([key, members]) => ({members, title: OTHERS[key]
			?? `${members[0].signal.family || "Device"} ${key}`}));
	}
	return [{title: null, members: [...rows].sort(state.order === "name" ? byName
		: (a, b) => a.urgency - b.urgency || byName(a, b))}];
}

function arrange() {
	visible.clear();
	seen?.disconnect();
	const bodies = chunked(groups()).map(({members, title}) => {
		const head = title && el("tr", {class: "group", role: "row"},
			el("th", {scope: "rowgroup", role: "rowheader", "aria-colspan": 6}, title));
		const body = el("tbody", {role: "rowgroup"}, head);
		reserve(body, members, title ? 1 : 0);
		return body;
	});
	const heads = [["Signal", "c-name"], ["Value", "c-value"], ["Last minutes", "c-spark"],
		["Quality", "c-quality"], ["Age", "c-age"], ["Command", "c-command"]];
	list.replaceChildren(el("thead", {role: "rowgroup"}, el("tr", {class: "row", role: "row"},
		...heads.map(([text, name]) => el("th", {class: name, scope: "col", role: "columnheader"},
			text)))), ...bodies);
	list.classList.toggle("read-only", !rows.some((row) => row.signal.output));
	filter();
	fillAll(bodies);
	for (const body of bodies)
		if (seen)
			seen.observe(body);
		else
			visible.add(body);
}

const filter = () => {
	const words = state.query.toLowerCase().split(/\s+/).filter(Boolean);
	for (const row of rows)
		row.hidden = words.length > 0 && !row.matches(words);
	for (const body of list.tBodies)
		body.hidden = body.rows_.every((row) => row.hidden);
	summary();
};

// --- Painting -------------------------------------------------------------------------------

const summary = () => {
	const bad = rows.filter((row) => stateOf(store.quality(row.signal)) !== "good").length;
	const alarms = rows.filter((row) => alarmOf(row.signal.alarm)).length;
	const found = rows.filter((row) => !row.hidden).length;
	put(count, store.unknown && !rows.length ? "" : store.unknown
		? `${rows.length} signals, all unknown`
		: `${found < rows.length ? `${found} of ` : ""}${rows.length} signals, `
			+ `${bad ? `${bad} not good` : "all good"}`
			+ `${alarms ? `, ${alarms} in alarm` : ""}`);
};
const summarySoon = later(summary, 200);
const orderSoon = later(() => {
	if (state.order === "state" && !view.contains(document.activeElement))
		arrange();
}, 2000);

const painter = new Painter(() => visible, (turned) => {
	summarySoon();
	if (turned)
		orderSoon();
});

const paintSoon = (signals) => painter.soon([...signals].map((signal) => rowOf.get(signal)));

/* Ages count up and lines move on, of what can be seen. */
function tick() {
	if (!shown || document.hidden)
		return;
	for (const body of visible)
		for (const row of body.rows_ ?? [])
			if (row.built && !row.hidden) {
				row.paintAge();
				row.paintLine();
			}
}
