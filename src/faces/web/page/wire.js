// SPDX-License-Identifier: MIT
// The view Wire: what is wrong and what to do, the adapters as strips of terminals, what was
// counted, what owsd does to recover. Faults of the simulation and the devices are last.
import {get} from "./api.js";
import {button, el, later, put, table, wide} from "./dom.js";
import {faultCards} from "./faults.js";
import {simulation} from "./simulation.js";
import {store} from "./store.js";
import {chipNames, percent, redraw, stripsOf} from "./strip.js";
import {faultsOf, terminalsOf} from "./terminals.js";
import {SHAPES, clock, plural, qualityWords, span, stateOf} from "./words.js";

const EVERY_MS = 2000, STEPS = 50;
const LOOKS = 16; // over which the share of a device is shown: half a minute
const ROWS = 12; // devices that the table shows at once

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

let shown = false, sentence, aside, faults, strips, figures, steps, devices, heading, search, fault;
let before = null, seen = [], last = null, chosen = null, asTable = false;
let looks = []; // {now, counts, generation, wire: by device, microseconds}

export function build(root) {
	[figures, steps, devices] = ["Figures", "Recovery", "Devices"].map(wide);
	sentence = root.querySelector("h1");
	aside = el("p", {class: "aside"});
	fault = el("p", {class: "fault", role: "alert"});
	faults = el("div", {class: "faults"});
	strips = el("div", {class: "strips", onclick: choose});
	heading = el("h2", {});
	search = el("input", {type: "search", "aria-label": "Search devices by id, kind or signal",
		placeholder: "Search devices", oninput: draw});
	const turn = button("As a table", () => {
		asTable = !asTable;
		turn.setAttribute("aria-pressed", String(asTable));
		draw();
	}, {"aria-pressed": "false"});
	root.append(el("div", {class: "wire-top"}, sentence, aside), fault, faults,
		el("div", {class: "tools"}, el("h2", {}, "Adapters and terminals"), turn), strips, figures,
		steps, simulation(), el("div", {class: "tools"}, heading, search), devices);
	const soon = later(() => shown && draw(), 1000);
	store.addEventListener("signals", soon);
	store.addEventListener("values", soon);
	store.addEventListener("trust", () => shown && draw());
	setInterval(() => !document.hidden && (shown || before) && look(), EVERY_MS);
}

function choose({target}) {
	const {key} = target.closest("[data-key]")?.dataset ?? {};
	if (key === undefined)
		return;
	chosen = key === chosen ? null : key;
	draw();
}

function draw() {
	const terminals = store.unknown ? [] : terminalsOf(store.signals, last);
	const wrong = store.unknown ? [] : faultsOf(store.signals, last?.targets ?? [], terminals);
	const chips = terminals.flatMap((one) => one.chips);
	const answer = chips.filter((one) => one.answers).length;
	put(sentence, store.unknown ? "The state of the wires is unknown"
		: wrong.length ? `${plural(wrong.length, "thing")} ${wrong.length === 1 ? "is" : "are"} wrong`
			: "All wires are good");
	put(aside, store.unknown ? `${store.unknown} Is the service running? Try: systemctl status `
		+ `owsd@${store.info?.instance ?? "OWS"}` : answer === chips.length
		? "All chips answer." : `${answer} of ${chips.length} chips answer.`);
	redraw(faults, faultCards(wrong));
	redraw(strips, stripsOf(terminals, last, chosen, asTable));
	drawFigures();
	drawSteps();
	drawDevices(terminals, chips);
}

export function show() {
	shown = true;
	draw();
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
	if (shown)
		draw();
}

// --- What was counted ------------------------------------------------------------------------

function countsOf(stats) {
	const counts = new Map();
	for (const {name, target, value} of stats.counters ?? [])
		counts.set(`${target ?? ""} ${name}`, Number(value));
	return counts;
}

/* The wires of an adapter: {load, errors}; null: it is not counted by itself. */
const wiresOf = (counts, target) => Array.from({length: counts.get(`${target} bus_wires`) ?? 0},
	(_, n) => counts.has(`${target} bus_wire_${n}_errors`)
		? {load: null, errors: counts.get(`${target} bus_wire_${n}_errors`)} : null);

/* What happened since the last look: steps of recovery, and the load of each wire. */
function compare(stats) {
	const now = performance.now(), counts = countsOf(stats);
	const generation = stats.daemon?.generation;
	stats.load = new Map();
	stats.wires = new Map((stats.targets ?? []).map(({name}) => [name, wiresOf(counts, name)]));
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
	compareWires(stats, now, counts, generation);
}

/* How much of the time a wire was busy, and each device took of its wire, in per cent. */
function compareWires(stats, now, counts, generation) {
	const wire = new Map((stats.devices ?? []).filter(({wire_us: us}) => us !== null)
		.map(({id, wire_us: us}) => [id, us]));
	looks = [...looks.filter((look) => look.generation === generation), {now, counts, generation,
		wire}].slice(-LOOKS);
	const [first] = looks, parted = (us) => Math.min(100, us / 1000 / (now - first.now) * 100);
	for (const [target, wires] of first.now < now ? stats.wires : [])
		for (const [n, one] of wires.entries()) {
			const name = `${target} bus_wire_${n}_us`;
			if (one)
				one.load = Math.max(0, parted(counts.get(name) - first.counts.get(name)));
		}
	stats.share = new Map();
	for (const [id, us] of wire) {
		const share = parted(us - first.wire.get(id));
		if (share >= 0)
			stats.share.set(id, share);
	}
}

function drawFigures() {
	if (store.unknown || !last) {
		redraw(figures, []);
		return;
	}
	const counts = countsOf(last), {targets = []} = last;
	const known = COUNTS.filter(([name]) => targets.some((one) => counts.has(`${one.name} ${name}`)));
	const right = (text) => [text, "right"];
	redraw(figures, [table("Adapters, and what was counted since owsd started", ["Adapter",
		right("Wire"), right("Signals"), right("Reconnects"),
		...known.map(([, words]) => right(words))], targets.map((target) => [target.name,
		...[target.wire, target.signals, target.reconnects].map((n) => String(n ?? "\u2014")),
		...known.map(([name]) => String(counts.get(`${target.name} ${name}`) ?? "\u2014"))]),
	"owsd has no target."),
	el("p", {class: "hint"}, known.map(([, words, meaning]) => `${words}: ${meaning}.`).join(" "),
		" A target that a reload adds, or whose block Bus it changes, counts from then on.")]);
}

function drawSteps() {
	redraw(steps, [table("Recovery since this page was opened", [["Time", "time"], "Adapter",
		"What owsd did"], seen.map(({time, target, words, times}) => [clock(time), target,
		`${words}${times > 1 ? `, ${times} times` : ""}`]), "Nothing had to be recovered.")]);
}

// --- Devices ---------------------------------------------------------------------------------

/** What is known of a device, where it is: [heading, cell, is it known?]. */
const DEVICE_COLUMNS = [
	["Health", ({health}) => health, ({health}) => health],
	["Identity", ({identity}) => identity, ({identity}) => identity],
	["Power", ({power}) => power, ({power}) => power],
	[["Errors", "right"], ({errors, answers}) => `${errors} of ${answers}`,
		({answers, errors}) => answers + errors > 0],
	[["Retries", "right"], ({retries}) => String(retries), ({retries}) => retries !== null],
	["Share of the wire", ({id}) => percent(last.share.get(id), `Share of ${id}`),
		({id}) => last.share.has(id)],
];
const DEVICE_HINT = "Health: in the words of NAMUR NE 107. Identity: which chip it is by its behaviour. "
	+ "Power: parasite is from the data line. Errors and retries: since owsd started; "
	+ "retries: owsd asked again after an error. Share: the time of the wire "
	+ "that the device took in the last half minute; "
	+ "a conversion that all thermometers begin together belongs to none.";

function drawDevices(terminals, chips) {
	const words = search.value.trim().toLowerCase();
	const of = words ? null : terminals.find(({key}) => key === chosen);
	put(heading, of ? `Chips of ${of.name}` : "Devices");
	const found = (of ? of.chips : chips).filter(({id, family, signals}) => !words
		|| `${id} ${family}`.toLowerCase().includes(words)
		|| signals.some(({name}) => name.toLowerCase().includes(words)));
	const columns = DEVICE_COLUMNS.filter(([, , has]) =>
		found.some(({device}) => device && has(device)));
	const place = new Map(terminals.flatMap((one) => one.chips.map(({id}) => [id, one.name])));
	const rows = found.slice(0, ROWS).map((chip) => [el("code", {}, chip.id), chip.family || "\u2014",
		place.get(chip.id), el("span", {class: `pill is-${stateOf(chip.code)}`},
			`${SHAPES[stateOf(chip.code)]} ${qualityWords(chip.code)}`.trim()),
		span(chip.device?.last_ok_age),
		...columns.map(([, show, has]) =>
			chip.device && has(chip.device) ? show(chip.device) : "\u2014"),
		chipNames(chip)]);
	redraw(devices, [table("Devices that have signals", ["Device", "Family", "Place", "State",
		["Last answer", "right"], ...columns.map(([words]) => words), "Signals"], rows,
	words ? "No device matches." : "No signal has a device."),
	...(found.length > ROWS ? [el("p", {}, `and ${found.length - ROWS} more: search for one`)] : []),
	...(columns.length ? [el("p", {class: "hint"}, DEVICE_HINT)] : [])]);
}
