// SPDX-License-Identifier: MIT
// Devices that the draft names and the scan has not found: another of their family takes over.
import {ask} from "./command.js";
import {action, attempt, el} from "./dom.js";
import {draft} from "./draft.js";
import {readingOf} from "./moving.js";
import {idOf} from "./names.js";
import {kindOf} from "./words.js";

let box, list, fault, last = "";

export function build(root) {
	fault = el("p", {class: "fault", role: "alert"});
	list = el("ul", {class: "found", "aria-label": "Devices that are missing"});
	box = el("div", {hidden: true}, el("h2", {}, "Missing"), el("p", {class: "hint"}, "The draft "
		+ "names these devices, and the scan did not find them. If a sensor was replaced, choose "
		+ "the new one: the signals keep their names, settings and history."), fault, list);
	root.append(box);
}

/** devices: what the scan found; null: there was none, or it has not read all. */
export function paint(devices) {
	if (!devices) {
		box.hidden = true;
		return;
	}
	const found = new Set(devices.map(({id}) => idOf(id))), gone = new Map();
	for (const item of draft.model.items)
		if (item.device && !found.has(idOf(item.device)))
			gone.set(item.device, [...gone.get(item.device) ?? [], item]);
	const used = new Set(draft.model.items.map((item) => idOf(item.device)));
	const free = devices.filter((device) => !used.has(idOf(device.id)) && !device.signals.length);
	box.hidden = !gone.size;
	// drawn anew only when something has changed: the choice of the user stays
	const now = JSON.stringify([[...gone.keys()], free.map(({id, bus}) => [id, bus]), draft.editable]);
	if (now === last)
		return;
	last = now;
	list.replaceChildren(...[...gone].map(([id, items]) => row(id, items,
		free.filter((device) => idOf(device.id).slice(0, 2) === idOf(id).slice(0, 2)))));
}

function row(id, items, free) {
	const names = items.map((item) => item.name).join(", ");
	const choice = el("select", {id: `replace-${idOf(id)}`, disabled: !draft.editable},
		...free.map((device) => el("option", {value: device.id}, [device.id, device.alias,
			readingOf(device)?.value].filter(Boolean).join(", "))));
	const button = action("Replace\u2026", () => replace(id,
		free.find((device) => device.id === choice.value), names), `replace ${id}`,
	{disabled: !draft.editable});
	return el("li", {"data-id": id}, el("p", {class: "title"}, el("span", {class: "shape",
		"aria-hidden": "true"}, "\u00d7"), " ", el("b", {}, kindOf(items[0])), " ",
	el("code", {}, id)), el("p", {class: "hint"}, `Signals: ${names}`),
	free.length ? el("div", {class: "tools"}, el("label", {for: choice.id}, "Take its place"),
		choice, button) : el("p", {class: "hint"}, "The scan found no device of this family that "
		+ "has no signal."));
}

async function replace(old, {id, bus}, names) {
	if (!await ask(`Replace ${old}?`, "Replace", [el("p", {}, `${id} takes its place for the `
		+ `signals ${names}. They keep their names and settings, and their history goes on. `
		+ "Undo brings back what was.")]))
		return;
	await attempt(fault, () => draft.edit({do: "replace", old, new: id, location: bus ?? ""}),
		() => `${id} takes the place of ${old} in the draft.`);
}
