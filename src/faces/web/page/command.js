// SPDX-License-Identifier: MIT
// Commands an output: a switch or a button in its row, and a dialog that asks before each command.
import {failed, post} from "./api.js";
import {announce, button, el, put} from "./dom.js";
import {store} from "./store.js";
import {valueText, withUnit} from "./words.js";

const RESULT_MS = 8000; // so long the page says that a command was taken

const RANGES = {byte: [0, 255], short: [-32768, 32767], word: [0, 65535]};
const DIFFERS = 0x1c;  // the quality "not as commanded"
const WHOLE = ["byte", "short", "long", "word", "dword", "large"];

/** The bounds of a number: of the configuration, else of a small type; null: none. */
function bounds(signal) {
	const [least, most] = RANGES[signal.type] ?? [null, null];
	const min = signal.min ?? least, max = signal.max ?? most;
	return min === null || max === null ? null : [min, max];
}

const step = (signal) => WHOLE.includes(signal.type) ? 1
	: signal.decimals > 0 ? 10 ** -Math.min(signal.decimals, 6) : 0.1;

/** The control of an output: {node, result, paint(value)}; result is in node at first. */
export function control(signal) {
	const result = el("span", {class: "result"});
	let late = null; // the words of what the bus had not confirmed in time
	result.name_ = signal.name;
	const send = async (value) => {
		if (!store.same(signal)) {
			say(signal.name, result, "refused", "not set: it is another signal since a reload");
			return;
		}
		const text = withUnit(signal, valueText(signal, value));
		late = null;
		say(signal.name, result, "pending", `setting ${text} \u2026`);
		node.classList.add("is-pending");
		try {
			const answer = await post("set", {name: signal.name, value});
			const taken = answer.result !== "pending";
			late = taken ? null : text;
			say(signal.name, result, taken ? "taken" : "pending",
				taken ? `${text}: taken` : `${text}: not confirmed yet`);
		} catch (error) {
			say(signal.name, result, "refused", `${text}: ${failed(error)}`);
		}
		node.classList.remove("is-pending");
	};
	const made = signal.type === "bool" ? switchOf(signal, send) : buttonOf(signal, send);
	const node = el("div", {class: "control"}, ...made.nodes, result);
	return {node, result, paint(value) {
		const able = Boolean(store.info?.writable) && !store.unknown;
		for (const one of made.nodes)
			one.disabled = !able;
		made.paint(value);
		if (late !== null && withUnit(signal, valueText(signal, value)) === late) {
			say(signal.name, result, "taken", `${late}: taken`);
			late = null;
		}
	}};
}

/* A reload makes rows anew: then it stands in those of that name. */
function say(name, one, state, text) {
	announce(`${name} ${text}`);
	for (const result of one.isConnected ? [one] : document.querySelectorAll(".result")) {
		if (result.name_ !== name)
			continue;
		result.className = `result is-${state}`;
		put(result, text);
		clearTimeout(result.timer);
		if (state === "taken") // a refusal stays until the next act
			result.timer = setTimeout(() => put(result, ""), RESULT_MS);
	}
}

/*
 * A switch shows what is; where that is not known it would lie, and two buttons take its place.
 * Where it reads otherwise than it was commanded, it is a hollow one of the command.
 */
function switchOf(signal, send) {
	const set = async (value) => {
		if (await confirmed(signal, value))
			send(value);
	};
	const toggle = el("button", {type: "button", role: "switch", class: "switch",
		"aria-label": signal.name, "aria-checked": "false",
		onclick: () => set(toggle.getAttribute("aria-checked") !== "true")});
	const [off, on] = ["off", "on"].map((text) => button(`Set ${text}`, () => set(text === "on"),
		{"aria-label": `Set ${signal.name} ${text}`}));
	return {nodes: [toggle, off, on], paint(value) {
		const missed = value === null && !store.unknown && signal.code === DIFFERS
			&& typeof signal.commanded === "boolean";
		toggle.hidden = value === null && !missed;
		off.hidden = on.hidden = !toggle.hidden;
		toggle.classList.toggle("is-missed", missed);
		toggle.setAttribute("aria-checked", String(missed ? signal.commanded : Boolean(Number(value))));
	}};
}

function buttonOf(signal, send) {
	return {nodes: [button("Set\u2026", async () => {
		const value = await entered(signal);
		if (value !== null)
			send(value);
	}, {"aria-label": `Set ${signal.name}`})], paint() {}};
}

// --- The dialog -----------------------------------------------------------------------------

const dialog = () => document.getElementById("command");

/** Show the dialog with these nodes above its buttons; true: confirmed, and ready() is. */
export function ask(title, accept, nodes, ready = () => true) {
	const box = dialog();
	const yes = el("button", {type: "submit", class: "primary", value: "yes"}, accept);
	const form = el("form", {method: "dialog"}, el("h2", {id: "command-title"}, title), ...nodes,
		el("div", {class: "buttons"},
			button("Cancel", () => box.close("no")), yes));
	form.addEventListener("submit", async (event) => {
		event.preventDefault();
		if (await ready() && form.isConnected)
			box.close("yes");
	});
	box.replaceChildren(form);
	box.returnValue = "no";
	return new Promise((resolve) => {
		box.addEventListener("close", () => {
			box.replaceChildren();
			resolve(box.returnValue === "yes");
		}, {once: true});
		box.showModal();
	});
}

/* What an output is, while its dialog is open: a reload may give its name to another. */
function presentWords(shown) {
	const signal = store.same(shown), value = signal && store.value(signal);
	return !signal ? "A reload has made it another signal."
		: `It is ${value === null ? "unknown" : withUnit(signal, valueText(signal, value))} now.`;
}

async function askOf(signal, title, accept, nodes, ready) {
	const present = el("p"), events = ["signals", "values", "trust"];
	const paint = () => put(present, presentWords(signal));
	paint();
	events.forEach((type) => store.addEventListener(type, paint));
	const yes = await ask(title, accept,
		[el("p", {}, signal.description || `Path ${signal.path}`), present, ...nodes], ready);
	events.forEach((type) => store.removeEventListener(type, paint));
	return yes;
}

/** True, where the configuration wants it after the user has confirmed. */
function confirmed(signal, value) {
	if (!signal.confirm)
		return true;
	const text = valueText(signal, value);
	return askOf(signal, `Set ${signal.name} ${text}?`, `Set ${text}`, []);
}

/** The value that the user enters and confirms; null: none. */
async function entered(signal) {
	const range = signal.type === "string" ? null : bounds(signal);
	const now = store.value(signal);
	const fault = el("p", {class: "fault", role: "alert"});
	const field = el("input", {id: "command-value", autocomplete: "off", required: true,
		type: "text", inputmode: signal.type === "string" ? "text" : "decimal",
		value: now ?? ""}); // with all digits: what is not touched stays
	const slider = range && el("input", {type: "range", "aria-label": `${signal.name}, slider`,
		min: range[0], max: range[1], step: step(signal), value: now ?? range[0],
		oninput: () => { field.value = valueText(signal, Number(slider.value)); }});
	field.addEventListener("focus", () => field.select());
	field.addEventListener("input", () => {
		put(fault, "");
		if (slider && field.value.trim() && Number.isFinite(Number(field.value)))
			slider.value = field.value;
	});
	const yes = await askOf(signal, `Set ${signal.name}`, "Set", [
		el("label", {for: "command-value"},
			signal.unit ? `New value in ${signal.unit}` : "New value"),
		field, slider,
		range ? el("p", {class: "hint"}, `From ${range[0]} to ${range[1]}`) : null,
		fault], () => {
		put(fault, wrong(signal, field.value, range));
		return !fault.textContent;
	});
	if (!yes)
		return null;
	if (signal.type === "large") // a number of JavaScript has 53 bits
		return field.value.trim();
	return signal.type === "string" ? field.value : Number(field.value);
}

/** Why no command can be made of the text; "": one can. */
export function wrong(signal, text, range) {
	if (signal.type === "string")
		return "";
	const value = text.includes(",") ? NaN : Number(text);
	if (!text.trim() || !Number.isFinite(value))
		return "Enter a number; the decimal sign is the point.";
	if (WHOLE.includes(signal.type) && !Number.isInteger(value))
		return "Enter a whole number.";
	if (range && (value < range[0] || value > range[1]))
		return `Enter a number from ${range[0]} to ${range[1]}.`;
	return "";
}
