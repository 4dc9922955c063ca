// SPDX-License-Identifier: MIT
// The view About: version, uptime, log and counters of owsd.
import {get} from "./api.js";
import {el, put, table, wide} from "./dom.js";
import {store} from "./store.js";
import {clock, dateAndClock, span, wordsOf} from "./words.js";

let shown = false, facts, counters, lines, fault, search, last = null;

export function build(root) {
	fault = el("p", {class: "fault", role: "alert"});
	facts = el("dl", {class: "facts"});
	search = el("input", {type: "search", placeholder: "Search", "aria-label": "Search counters",
		oninput: draw});
	counters = wide("Counters");
	lines = wide("Log");
	root.append(fault, facts, el("h2", {}, "Log"), lines, el("h2", {}, "Counters"),
		el("div", {class: "tools"}, search), counters,
		el("p", {class: "hint"}, "owsctl stats shows the counters in a terminal."));
	setInterval(() => shown && !document.hidden && look(), 5000);
	store.addEventListener("trust", () => shown && look());
}

export function show() {
	shown = true;
	look();
}

export const hide = () => { shown = false; };

async function look() {
	try {
		const [info, log] = await Promise.all([get("info"), get("log")]);
		drawLog(log.lines, info.now);
		last = {info, stats: await get("stats")};
		put(fault, "");
	} catch (error) {
		put(fault, `What owsd has counted cannot be shown: ${error.message}. `
			+ "Below is what it was.");
	}
	draw();
}

function drawLog(found, now) {
	const rows = found.toReversed().map(({time, level, text}) =>
		[now - time < 86400000 ? clock(time) : dateAndClock(time), level, text]);
	lines.replaceChildren(table("The last lines of owsd, the newest first",
		[["Time", "time"], "Level", "Text"], rows, "owsd has logged nothing."));
}

function draw() {
	if (!last)
		return;
	const {info, stats} = last, daemon = stats.daemon ?? {};
	const pairs = [
		["Version", info.version], ["Instance", info.instance],
		["Board", info.board], ["Kernel", info.kernel],
		["State", daemon.state ?? (store.unknown ? "unknown" : "live")],
		["Started", info.up === null ? null
			: `${dateAndClock(info.now - info.up * 1000)}, ${span(info.up)} ago`],
		["Generation", `${info.generation}, changes at each start and reload`],
		["Period", daemon.period ? `${daemon.period} s` : null],
		["Process", daemon.pid],
		["Signals", `${info.signals}${stats.not_good >= 0 ? `, ${stats.not_good} not good` : ""}`],
		["Served protocol", stats.served || "owsd does not serve it"],
		["History", info.history ? "kept by owsd-recorder"
			: "not kept: owsd-recorder does not run"],
		["Writing by this page", info.writable ? "allowed" : "not allowed"],
		["You are", info.person],
	].filter(([, value]) => value !== null && value !== undefined);
	facts.replaceChildren(...pairs.map(([key, value]) =>
		el("div", {}, el("dt", {}, key), el("dd", {}, String(value)))));
	const words = wordsOf(search.value);
	const rows = (stats.counters ?? []).filter(({name, target}) =>
		words.every((word) => `${name} ${target ?? ""}`.toLowerCase().includes(word)))
		.map(({name, target, value}) => [el("code", {}, name), target ?? "owsd", String(value)]);
	counters.replaceChildren(table("Counters", ["Name", "Of", ["Value", "right"]], rows,
		"No counter has such a name."));
}
