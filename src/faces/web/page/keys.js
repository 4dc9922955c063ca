// SPDX-License-Identifier: MIT
// Keys of the whole page. Single ones act only while no field has the focus, and can be switched
// off.
import {ask} from "./command.js";
import {el} from "./dom.js";

const OFF = "owsd.keys.off";
const CHORD_MS = 1500; // between g and the key of a view
const VIEWS = {l: "live", a: "alarms", t: "trends", w: "wire", c: "config"};
const SINGLE = new Map([["/", "search"], ["?", "help"], ["g", "begin"]]);
const WORDS = [["/", "Search"], ["Esc", "Leave the search, and clear it"],
	["g l", "Live"], ["g a", "Alarms"], ["g t", "Trends"], ["g w", "Wire"],
	["g c", "Configuration"], ["\u2190 \u2192", "In the plot: the cursor. Shift: ten steps"],
	["+ \u2212 0", "In the plot: zoom, and back"], ["?", "These keys"]];

let begun = -Infinity; // when g was pressed

/** What a key asks for: "search", "help", "begin" (g), {view}; null: nothing. */
export function wish(key, chord) {
	if (chord && Object.hasOwn(VIEWS, key))
		return {view: VIEWS[key]};
	return SINGLE.get(key) ?? null;
}

const isOff = () => localStorage.getItem(OFF) === "1";

async function help() {
	const on = el("input", {type: "checkbox", id: "keys-on", checked: !isOff()});
	const rows = WORDS.flatMap(([key, text]) => [el("dt", {}, el("kbd", {}, key)),
		el("dd", {}, text)]);
	if (await ask("Keys", "Save", [el("dl", {class: "keys"}, ...rows),
		el("label", {for: "keys-on", class: "check"}, on, "Single keys act")]))
		localStorage.setItem(OFF, on.checked ? "0" : "1");
}

function search() {
	const field = [...document.querySelectorAll("main input[type=search]")]
		.find((one) => one.checkVisibility());
	field?.focus();
	field?.select();
	return Boolean(field);
}

function leave(field) {
	if (field.value) {
		field.value = "";
		field.dispatchEvent(new Event("input", {bubbles: true}));
	}
	field.blur();
}

function pressed(event) {
	const {target, key} = event;
	if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented)
		return;
	if (key === "Escape" && target.type === "search")
		leave(target);
	if (target.closest("input, textarea, select, dialog, [contenteditable]"))
		return;
	const wanted = isOff() && key !== "?" ? null : wish(key, event.timeStamp - begun < CHORD_MS);
	begun = wanted === "begin" ? event.timeStamp : -Infinity;
	if (wanted?.view)
		location.hash = wanted.view;
	else if (wanted === "help")
		help();
	else if (wanted !== "search" || !search())
		return;
	event.preventDefault();
}

export const begin = () => document.addEventListener("keydown", pressed);
