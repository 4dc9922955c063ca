// SPDX-License-Identifier: MIT
// The view Wire: what is wrong and what to do, the targets with the load and the errors of their
// wires, what owsd does to recover, and the devices.
import {get} from "./api.js";
import {el, later, put, table, wide} from "./dom.js";
import {simulation} from "./simulation.js";
import {store} from "./store.js";
import {SHAPES, clock, meaningOf, qualityWords, remedyOf, span, stateOf} from "./words.js";

const EVERY_MS = 2000, STEPS = 50;
const LOOKS = 16; // over which the share of a device is shown: half a minute
const NAMED = 12; // signals of a fault that are named

/** Counters that a wire's user wants to see: [name, heading, what it means]. */
const COUNTS = [
	["bus_retries", "Retries", "asked again after an error"],
	["bus_checksum_errors", "Checksum errors", "an answer was disturbed: contact, pull-up, noise"],
	["bus_shorts", "Shorts", "the data line was held at ground"],
	["bus_link_errors", "Adapter errors", "the adapter or its I\u00b2C bus failed"],
	["bus_power_faults", "Power faults", "a thermometer lost its supply: 85 or 127.94 \u00b0C"],
	["bus_devices_lost", "Devices lost", "devices that no longer answer the search"],
	["item_errors", "Item errors", "requests that failed"],
];

/** Counters of what owsd does by itself: name: words. */
const STEPS_OF = new Map([
	["bus_recover_bus_reset", "reset the wire"],
	["bus_recover_chip_reset", "reset the bridge chip"],
	["bus_recover_power_cycle", "switched the supply of the wire off and on"],
	["bus_recover_reopen", "opened the adapter again"],
	["bus_devices_lost", "lost a device"],
	["bus_devices_found", "found a device"],
	["bus_devices_restarted", "noticed that a device had restarted"],
	["bus_shorts", "found the wire short"],
	["target_failures", "lost the target"],
	["reconnects", "reached the target again"],
	["moves_in", "took signals over from another target"],
]);

let shown = false, faults, targets, steps, devices, fault, before = null, seen = [], last = null;
let looks = []; // {now, generation, wire: by device, microseconds}

export function build(root) {
	[targets, steps, devices] = ["Targets", "Recovery", "Devices"].map(wide);
	faults = el("div", {class: "faults"});
	fault = el("p", {class: "fault", role: "alert"});
	root.append(fault, el("h2", {}, "What is wrong, and what to do"), faults, simulation(),
		el("h2", {}, "Targets and wires"), targets, el("h2", {}, "Recovery"), steps,
		el("h2", {}, "Devices"), devices);
	const soon = later(() => shown && drawSignals(), 1000);
	store.addEventListener("signals", soon);
	store.addEventListener("values", soon);
	store.addEventListener("trust", () => {
		if (!shown)
			return;
		drawTargets();
		drawSignals();
	});
	setInterval(() => !document.hidden && (shown || before) && look(), EVERY_MS);
}

export function show() {
	shown = true;
	drawTargets();
	drawSteps();
	drawSignals();
	look();
}

export const hide = () => { shown = false; };

async function look() {
	if (store.unknown)
		return;
	try {
		const stats = await get("stats");
		put(fault, "");
		compare(stats);
		last = stats;
	} catch (error) {
		put(fault, `The state of the wires cannot be shown: ${error.message}.`);
		return;
	}
	if (shown) {
		drawTargets();
		drawSteps();
		drawSignals();
	}
}

// --- Targets --------------------------------------------------------------------------------

function countsOf(stats) {
	const counts = new Map();
	for (const {name, target, value} of stats.counters ?? [])
		counts.set(`${target ?? ""} ${name}`, Number(value));
	return counts;
}

/* What happened since the last look: steps of recovery, and the load of each wire. */
function compare(stats) {
	const now = performance.now(), counts = countsOf(stats);
	const generation = stats.daemon?.generation;
	stats.load = new Map();
	if (before && before.generation === generation)
		for (const {name: target} of stats.targets ?? []) {
			const grown = (name) => counts.get(`${target} ${name}`)
				- before.counts.get(`${target} ${name}`);
			const load = grown("bus_wire_us") / 1000 / (now - before.now) * 100;
			if (load >= 0)
				stats.load.set(target, Math.min(100, load));
			for (const [name, words] of STEPS_OF)
				if (grown(name) > 0)
					seen.unshift({time: store.now(), target, words, times: grown(name)});
		}
	seen = seen.slice(0, STEPS);
	before = {now, counts, generation};
	compareDevices(stats, now, generation);
}

/* How much of the time each device took of its wire, in per cent. */
function compareDevices(stats, now, generation) {
	const wire = new Map((stats.devices ?? []).filter(({wire_us: us}) => us !== null)
		.map(({id, wire_us: us}) => [id, us]));
	looks = [...looks.filter((look) => look.generation === generation), {now, generation, wire}]
		.slice(-LOOKS);
	const [first] = looks;
	stats.share = new Map();
	for (const [id, us] of wire) {
		const share = (us - first.wire.get(id)) / 1000 / (now - first.now) * 100;
		if (share >= 0)
			stats.share.set(id, Math.min(100, share));
	}
}

function drawTargets() {
	if (store.unknown || !last) {
		targets.replaceChildren(el("p", {class: "note"}, "The state of the targets is unknown now."));
		return;
	}
	const counts = countsOf(last);
	const known = COUNTS.filter(([name]) =>
		(last.targets ?? []).some((target) => counts.has(`${target.name} ${name}`)));
	const rows = (last.targets ?? []).map((target) => {
		const load = last.load.get(target.name);
		return [
			el("span", {}, el("code", {}, target.name),
				target.note ? el("p", {class: "hint"}, target.note) : null),
			el("span", {class: `pill is-${target.state === "up" ? "good" : "bad"}`},
				target.state === "up" ? "up" : `\u00d7 ${target.state}`),
			String(target.wire ?? ""),
			String(target.signals ?? ""),
			load === undefined ? "\u2014" : el("span", {class: "load"},
				el("meter", {min: 0, max: 100, high: 90, value: load.toFixed(1),
					"aria-label": `Load of ${target.name}`}), ` ${load.toFixed(0)} %`),
			String(target.reconnects ?? 0),
			...known.map(([name]) => String(counts.get(`${target.name} ${name}`) ?? "\u2014")),
		];
	});
	const right = (text) => [text, "right"];
	targets.replaceChildren(table("Targets, and what was counted since the start", ["Target",
		"State", right("Wire"), right("Signals"), "Load of the wire", right("Reconnects"),
		...known.map(([, heading]) => right(heading))], rows, "owsd has no target."),
	el("p", {class: "hint"}, known.map(([, heading, words]) => `${heading}: ${words}.`).join(" ")));
}

function drawSteps() {
	steps.replaceChildren(table("Recovery since this page was opened",
		[["Time", "time"], "Target", "What owsd did"],
		seen.map(({time, target, words, times}) => [clock(time), el("code", {}, target),
			`${words}${times > 1 ? `, ${times} times` : ""}`]), "Nothing had to be recovered."));
}

// --- Devices and faults ---------------------------------------------------------------------

const RANK = {good: 0, uncertain: 1, bad: 2, unknown: 3};

/* What is known of a device, where it is: [heading, cell, is it known?]. */
const DEVICE_COLUMNS = [
	["Identity", ({identity}) => identity, ({identity}) => identity],
	["Power", ({power}) => power, ({power}) => power],
	[["Errors", "right"], ({errors, answers}) => `${errors} of ${answers}`,
		({answers, errors}) => answers + errors > 0],
	[["Retries", "right"], ({retries}) => String(retries), ({retries}) => retries !== null],
	["Share of the wire", (device, id) => share(id, last.share.get(id)),
		(device, id) => last.share.has(id)],
];
const DEVICE_HINT = "Identity: which chip it is by its behaviour. Power: parasite is from the data "
	+ "line. Errors and retries: since owsd started; retries: owsd asked again after an error. Share: "
	+ "the time of the wire that the device took in the last half minute; a conversion that all "
	+ "thermometers begin together belongs to none.";

const share = (id, part) => el("span", {class: "load"},
	el("meter", {min: 0, max: 100, value: part.toFixed(2), "aria-label": `Share of ${id}`}),
	part && part < 0.1 ? " < 0.1 %" : ` ${part.toFixed(1)} %`);

function drawSignals() {
	drawFaults();
	const found = new Map();
	for (const signal of store.signals)
		if (signal.device)
			found.set(signal.device, [...found.get(signal.device) ?? [], signal]);
	const known = new Map((last?.devices ?? []).map((device) => [device.id, device]));
	const columns = DEVICE_COLUMNS.filter(([, , has]) =>
		[...known].some(([id, device]) => has(device, id)));
	const rows = [...found].map(([id, signals]) => {
		const worst = signals.reduce((a, b) => RANK[stateOf(store.quality(b))]
			> RANK[stateOf(store.quality(a))] ? b : a);
		const code = store.quality(worst);
		const ages = signals.map((signal) => store.age(signal)).filter((age) => age !== null);
		return [el("code", {}, id), signals[0].family || "\u2014",
			el("span", {class: `pill is-${stateOf(code)}`},
				`${SHAPES[stateOf(code)]} ${qualityWords(code)}`.trim()),
			span(known.get(id)?.last_ok_age ?? (ages.length ? Math.min(...ages) : null)),
			...columns.map(([, show, has]) => known.has(id) && has(known.get(id), id)
				? show(known.get(id), id) : "\u2014"),
			signals.map((signal) => signal.name).join(", ")];
	});
	devices.replaceChildren(table("Devices that have signals", ["Device", "Family", "State",
		["Last answer", "right"], ...columns.map(([heading]) => heading), "Signals"], rows,
	"No signal has a device."), ...(columns.length ? [el("p", {class: "hint"}, DEVICE_HINT)] : []));
}

function drawFaults() {
	if (store.unknown) {
		faults.replaceChildren(el("p", {class: "note"}, store.unknown,
			" Is the service running? Try: systemctl status owsd@", store.info?.instance ?? "OWS"));
		return;
	}
	const kinds = new Map();
	for (const signal of store.signals)
		if (!signal.good)
			kinds.set(signal.code, [...kinds.get(signal.code) ?? [], signal]);
	const cards = [...kinds].sort(([, a], [, b]) => b.length - a.length).map(([code, signals]) => {
		const whys = [...new Set(signals.map((signal) => signal.why).filter(Boolean))].slice(0, 3);
		return el("article", {class: `card is-${stateOf(code)}`},
			el("h3", {}, el("span", {class: "shape", "aria-hidden": "true"}, SHAPES[stateOf(code)]),
				`${signals[0].text || qualityWords(code)}: ${signals.length} `
				+ `signal${signals.length === 1 ? "" : "s"}`),
			el("p", {}, meaningOf(code)),
			whys.length ? el("p", {}, `Reason: ${whys.join("; ")}`) : null,
			remedyOf(code) ? el("p", {}, el("strong", {}, "Remedy: "), remedyOf(code)) : null,
			el("p", {class: "names"}, ...signals.slice(0, NAMED).flatMap((signal) =>
				[el("a", {href: `#live?q=${encodeURIComponent(signal.name)}`}, signal.name), " "]),
			signals.length > NAMED ? `and ${signals.length - NAMED} more` : null));
	});
	// A link that has the focus stays, while nothing has changed
	if (cards.length && faults.textContent === cards.map((card) => card.textContent).join(""))
		return;
	faults.replaceChildren(...(cards.length ? cards
		: [el("p", {class: "fine"}, "All signals are good.")]));
}
