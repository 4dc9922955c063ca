// SPDX-License-Identifier: MIT
// The scan: what is found is listed, ticked, named and added; what is missing is replaced.
import {get} from "./api.js";
import {action, announce, el, put} from "./dom.js";
import {draft} from "./draft.js";
import * as missing from "./missing.js";
import {Watch, readingOf} from "./moving.js";
import {faultOf, idOf, nameFor} from "./names.js";
import {plural} from "./words.js";

const SCAN_MS = 120000; // scans of several persons follow each other

const ticks = new Map(); // "id/property": the row that is ticked
let rows = [], scanned = false, scanning = false, whole = true;
let buttons, only, count, fault, list, note, bar, watch;

const itemsOf = (device) =>
	draft.model.items.filter((item) => item.device && idOf(item.device) === idOf(device.id));

export function build(root) {
	buttons = {
		scan: action("Scan the wires", scan, "scan", {class: "primary"}),
		watch: action("Watch the readings", toggle, "watch", {"aria-pressed": "false"}),
		add: action("Add to the draft", add, "add-found", {class: "primary"}),
	};
	only = el("input", {type: "checkbox", id: "only-new", onchange: paint});
	count = el("p", {class: "count"});
	fault = el("p", {class: "fault", role: "alert"});
	note = el("p", {class: "note"}, "A scan lists what is on the wires of owsd's present targets. "
		+ "It reads, and changes nothing.");
	list = el("ul", {class: "found", "aria-label": "Devices that were found"});
	bar = el("div", {class: "tools bar", hidden: true}, buttons.add);
	watch = new Watch(() => rows.filter((row) => !row.node.hidden).map((row) => row.device), heard);
	root.append(note, el("div", {class: "tools"}, buttons.scan, buttons.watch,
		el("label", {class: "check", for: "only-new"}, only, "Only without a signal"), count),
	el("p", {class: "hint"}, "To find out which sensor is which, watch the readings and take one ",
		"into your hand: its row is marked \u201cmoving\u201d."), fault, list, bar);
	missing.build(root);
}

export const stop = () => watch.running && toggle();

async function scan() {
	scanning = true;
	put(fault, "");
	put(count, "Scanning\u2026");
	paint();
	try {
		const {devices, ...answer} = await get("devices", {}, SCAN_MS);
		ticks.clear();
		rows = devices.map(deviceRow);
		list.replaceChildren(...rows.map(({node}) => node));
		scanned = true;
		whole = answer.whole !== false;
		put(fault, !whole ? "Not all was read in time: scan again." : "");
		announce(`${plural(devices.length, "device")} found.`);
	} catch (error) {
		put(fault, `The wires cannot be scanned: ${error.message}.`);
	}
	scanning = false;
	paint();
}

// --- A device -------------------------------------------------------------------------------

function deviceRow(device) {
	const moving = el("span", {class: "moving", hidden: true});
	const signals = el("p", {class: "hint"});
	const facts = [device.identity, device.alias ? `alias ${device.alias}` : "", device.bus,
		device.simulated ? "simulated" : ""].filter(Boolean).join(", ");
	const row = {device, moving, signals, was: 0};
	row.properties = device.properties.map((property) => propertyRow(row, property));
	row.node = el("li", {"data-id": device.id}, el("p", {class: "title"},
		el("b", {}, device.type || `Family ${device.family}`), " ", el("code", {}, device.id), " ",
		moving), el("p", {class: "hint"}, facts), signals,
	...row.properties.map(({node}) => node),
	device.properties.length ? null : el("p", {class: "hint"}, "owsd proposes no property of it; "
		+ "\u201cowsctl dir\u201d lists all that it has."));
	return row;
}

function propertyRow(row, property) {
	const {device} = row, key = `${device.id}/${property.name}`;
	const id = `found-${key.replace(/[^\w]/g, "-")}`;
	const one = {key, device, property, name: ""};
	one.has = () => itemsOf(device).filter((item) => item.path.endsWith(`/${property.name}`));
	one.value = el("span", {class: "reading"});
	one.tick = el("input", {type: "checkbox", id, onchange: () => {
		if (one.tick.checked) {
			one.name = nameFor(device, property, taken(one));
			one.field.value = one.name;
			ticks.set(key, one);
		} else {
			ticks.delete(key);
		}
		paint();
	}});
	one.field = el("input", {type: "text", id: `${id}-name`, autocomplete: "off",
		spellcheck: "false", "aria-describedby": `${id}-fault`, oninput: () => {
			one.name = one.field.value.trim();
			paint();
		}});
	one.fault = el("span", {class: "problem", id: `${id}-fault`});
	one.naming = el("span", {class: "naming", hidden: true},
		el("label", {for: `${id}-name`}, `Name of ${property.word}`), one.field, one.fault);
	one.words = el("span", {class: "hint", id: `${id}-words`});
	one.pins = el("p", {class: "problem", id: `${id}-pins`, hidden: true});
	one.tick.setAttribute("aria-describedby", `${id}-words ${id}-pins`);
	one.node = el("div", {class: "property"}, el("label", {class: "check", for: id}, one.tick,
		property.name, property.output ? " (output)" : ""), one.value, one.words, one.naming,
	one.pins);
	return one;
}

/* The items that command the pins of an output by another property: PIO.0 beside PIO.BYTE. */
function rivals({device, property}) {
	const pins = (path) => path.split("/").at(-1).split(".")[0];
	return !property.output ? [] : itemsOf(device).filter((item) => item.io === "output"
		&& pins(item.path) === pins(property.name) && !item.path.endsWith(`/${property.name}`)
		&& [item.path, property.name].some((path) => /\.(BYTE|ALL)$/.test(path)));
}

function paintPins(one) {
	const names = ticks.has(one.key) ? rivals(one).map((item) => item.name) : [];
	one.pins.hidden = !names.length;
	put(one.pins, names.length ? `${names.join(", ")} command${names.length > 1 ? "" : "s"} the same `
		+ `pins: what sets ${one.property.name} sets them too, and the other way round.` : "");
}

const taken = (but) => new Set([...draft.model.items.map((item) => item.name),
	...[...ticks.values()].filter((one) => one !== but).map((one) => one.name)]);

function paintDevice(row) {
	const {device} = row, own = itemsOf(device).map((item) => item.name);
	const names = [
		device.signals.length ? `owsd has the signals ${device.signals.join(", ")}.` : "",
		own.length ? `In the draft: ${own.join(", ")}.` : ""].filter(Boolean).join(" ");
	put(row.signals, names || "It has no signal yet.");
	row.node.hidden = only.checked && own.length > 0;
	const far = watch.moved(device.id);
	row.moving.hidden = !far;
	row.node.classList.toggle("is-moving", Boolean(far));
	put(row.moving, far ? `\u2191\u2193 moving, ${far > 0 ? "+" : "\u2212"}`
		+ `${Math.abs(far).toFixed(1)}` : "");
	if (far && !row.was)
		announce(`${device.type} ${device.id} is moving.`);
	row.was = far;
	for (const one of row.properties)
		paintProperty(one);
}

function paintProperty(one) {
	const {property} = one, has = one.has();
	if (has.length)
		ticks.delete(one.key);
	one.tick.checked = ticks.has(one.key);
	one.tick.disabled = !draft.editable || has.length > 0;
	put(one.words, has.length ? `is ${has.map((item) => item.name).join(", ")}`
		: property.output ? "owsd writes nothing to it until somebody sets it" : "");
	paintPins(one);
	put(one.value, property.value ?? (property.why ? `no value: ${property.why}` : "no value"));
	one.naming.hidden = !ticks.has(one.key);
	const words = ticks.has(one.key) ? faultOf(one.name, taken(one)) : "";
	put(one.fault, words);
	if (words)
		one.field.setAttribute("aria-invalid", "true");
	else
		one.field.removeAttribute("aria-invalid");
}

export function paint() {
	rows.forEach(paintDevice);
	const shown = rows.filter((row) => !row.node.hidden).length;
	if (!scanning)
		put(count, scanned ? `${shown < rows.length ? `${shown} of ` : ""}`
			+ plural(rows.length, "device") : "");
	note.hidden = scanned;
	buttons.scan.disabled = scanning || !draft.editable;
	put(buttons.scan, scanned ? "Scan again" : "Scan the wires");
	buttons.watch.disabled = !draft.editable || !rows.some((row) => readingOf(row.device));
	bar.hidden = !ticks.size;
	put(buttons.add, `Add ${plural(ticks.size, "signal")} to the draft`);
	buttons.add.disabled = !draft.editable
		|| [...ticks.values()].some((one) => faultOf(one.name, taken(one)));
	missing.paint(scanned && whole ? rows.map((row) => row.device) : null);
}

// --- Readings -------------------------------------------------------------------------------

function toggle() {
	if (watch.running)
		watch.stop();
	else
		watch.start();
	buttons.watch.setAttribute("aria-pressed", String(watch.running));
	put(buttons.watch, watch.running ? "Stop watching" : "Watch the readings");
	paint();
}

function heard(devices) {
	const now = new Map(devices.map((device) => [device.id, device]));
	for (const row of rows)
		for (const fresh of now.get(row.device.id)?.properties ?? []) {
			const one = row.properties.find(({property}) => property.name === fresh.name);
			if (one)
				Object.assign(one.property, {value: fresh.value, why: fresh.why});
		}
	put(fault, watch.fault ? `The readings cannot be read now: ${watch.fault}.` : "");
	rows.forEach(paintDevice);
}

// --- Adding ---------------------------------------------------------------------------------

/*
 * Measurements once a second or so, as owsctl scan --rio has it. An output gets no InitValue: a
 * reload would write what the scan read, and nobody has asked for that.
 */
function keysOf({type, output}) {
	return [`Type=${type}`, `IO=${output ? "output" : "input"}`,
		!output && type === "double" ? "PerFactor=10" : ""].filter(Boolean).join("\n");
}

async function add() {
	const wanted = [...ticks.values()];
	buttons.add.disabled = true;
	try {
		await draft.edit(...wanted.map(({name, device, property}) => ({do: "add", name,
			path: `${device.path}/${property.name}`, keys: keysOf(property)})));
		put(fault, "");
		announce(`${plural(wanted.length, "signal")} added to the draft.`);
		buttons.scan.focus();
	} catch (error) {
		put(fault, `Nothing is added: ${error.message}`);
		paint();
	}
}
