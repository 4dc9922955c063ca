// SPDX-License-Identifier: MIT
// The items of the draft: their list in the order of the file, and the form of one of them.
import {ask} from "./command.js";
import {announce, el, put} from "./dom.js";
import {draft} from "./draft.js";
import {Form, ITEM_GROUPS, setter} from "./form.js";
import {problemsOf} from "./problems.js";

const state = {query: "", selected: null, at: -1, of: 0}; // selected is number at of so many
const rows = [];
let search, count, list, editor, empty, form = null, head, fault, double, buttons;
let wrong = new Map(), shown = [];

export function build(root) {
	search = el("input", {type: "search", id: "config-search", placeholder: "Search",
		"aria-label": "Search items by name, path, type, unit", autocomplete: "off",
		oninput: () => {
			state.query = search.value;
			filter();
		}});
	count = el("p", {class: "count"});
	list = el("ol", {class: "items", "aria-label": "Items, in the order of the file",
		onkeydown: keys});
	head = el("h2", {tabindex: -1});
	fault = el("p", {class: "fault", role: "alert"});
	double = el("p", {class: "problem"}, "Two items have this name. Correct that in the text.");
	const button = (text, act, action) => el("button", {type: "button", onclick: act,
		"data-action": action}, text);
	buttons = {
		up: button("Move up", () => move(state.selected, -1), "up"),
		down: button("Move down", () => move(state.selected, 1), "down"),
		remove: button("Remove\u2026", remove, "remove"),
		add: button("Add an item\u2026", add, "add"),
	};
	editor = el("div", {class: "editor", hidden: true}, head, el("div", {class: "tools"},
		buttons.up, buttons.down, buttons.remove), double);
	empty = el("p", {class: "note"});
	root.append(fault, el("div", {class: "columns items-view"},
		el("div", {class: "picker"}, el("div", {class: "tools", role: "search"}, search,
			buttons.add, count), list,
		el("p", {class: "hint"}, "Arrow keys go through the list, Enter opens an item; with Alt "
			+ "they move it.")),
		el("div", {}, empty, editor)));
}

/** Open an item, and put the focus into the field of a key. */
export function open({item, key}) {
	if (item !== undefined && draft.item(item))
		select(item);
	if (key && form)
		form.focus(key);
	else if (item !== undefined && !editor.hidden)
		head.focus();
}

export function paint() {
	const {items} = draft.model;
	if (state.selected !== null && !draft.item(state.selected)) // renamed, or gone
		state.selected = items.length === state.of ? items[state.at]?.name ?? null : null;
	state.at = items.findIndex((item) => item.name === state.selected);
	state.of = items.length;
	wrong = new Map();
	for (const problem of draft.problems)
		if (problem.item)
			wrong.set(problem.item, [...wrong.get(problem.item) ?? [], problem]);
	while (rows.length < items.length)
		rows.push(row(rows.length));
	items.forEach((item, n) => paintRow(rows[n], item));
	if (list.childElementCount !== items.length)
		list.replaceChildren(...rows.slice(0, items.length).map(({node}) => node));
	buttons.add.disabled = !draft.editable;
	filter();
	paintEditor();
}

// --- The list -------------------------------------------------------------------------------

function row(n) {
	const name = el("span", {class: "name"}), mark = el("span", {class: "alarm", hidden: true});
	const path = el("span", {class: "description"});
	const button = el("button", {type: "button", class: "pick", tabindex: -1,
		onclick: () => {
			select(rows[n].item.name);
			head.focus();
		}}, name, " ", mark, path);
	return {n, name, mark, path, button, node: el("li", {}, button)};
}

function paintRow(one, item) {
	const {keys} = item, problems = item.name ? wrong.get(item.name)?.length ?? 0 : 1;
	one.item = item;
	put(one.name, item.name || "(without a name)");
	put(one.path, `${item.path} \u00b7 ${item.type ?? "no type"}`
		+ `${item.io === "output" ? " output" : ""}`
		+ `${keys.Unit ? ` \u00b7 ${keys.Unit}` : ""}`);
	one.mark.hidden = !problems;
	put(one.mark, problems ? `\u00d7 ${problems} problem${problems > 1 ? "s" : ""}` : "");
	one.text = [item.name, item.path, item.family, item.type, item.io, ...Object.values(keys),
		problems ? "problem" : ""].join(" ").toLowerCase();
	if (item.name === state.selected)
		one.button.setAttribute("aria-current", "true");
	else
		one.button.removeAttribute("aria-current");
}

function filter() {
	const words = state.query.toLowerCase().split(/\s+/).filter(Boolean);
	const all = rows.slice(0, draft.model.items.length);
	for (const one of all)
		one.node.hidden = !words.every((word) => one.text.includes(word));
	shown = all.filter((one) => !one.node.hidden);
	const at = shown.find((one) => one.item.name === state.selected) ?? shown[0];
	for (const one of all)
		one.button.tabIndex = one === at ? 0 : -1;
	put(count, `${shown.length < all.length ? `${shown.length} of ` : ""}${all.length} item`
		+ `${all.length === 1 ? "" : "s"}`);
}

function keys(event) {
	const at = shown.findIndex((one) => one.button === document.activeElement);
	const by = {ArrowUp: -1, ArrowDown: 1, Home: -at, End: shown.length - 1 - at}[event.key];
	if (at < 0 || by === undefined)
		return;
	event.preventDefault();
	if (event.altKey && Math.abs(by) === 1) {
		move(shown[at].item.name, by, true);
		return;
	}
	const next = shown[Math.min(Math.max(at + by, 0), shown.length - 1)];
	shown[at].button.tabIndex = -1;
	next.button.tabIndex = 0;
	next.button.focus();
}

function select(name) {
	if (state.selected === name && form)
		return;
	state.selected = name;
	form?.node.remove();
	const set = setter(() => state.selected);
	form = new Form("item", "item", async (values) => {
		if (values.Name === null)
			throw new Error("A signal needs a name.");
		if (values.Name && draft.item(values.Name))
			throw new Error("Another item has this name.");
		await set(values);
	}, ITEM_GROUPS);
	editor.append(form.node);
	paint();
}

function paintEditor() {
	const item = state.selected === null ? null : draft.item(state.selected);
	editor.hidden = !item;
	empty.hidden = Boolean(item);
	put(empty, draft.model.items.length ? "Choose an item of the list."
		: "The draft has no item. Scan for devices, or add an item.");
	if (!item)
		return;
	put(head, item.name);
	double.hidden = !twins(item.name);
	form.paint({Name: item.name, Path: item.path, ...bitsOf(item), ...item.keys},
		problemsOf({part: "items", item: item.name}));
	form.node.disabled ||= twins(item.name);
	const at = shown.findIndex((one) => one.item.name === item.name);
	buttons.up.disabled = !draft.editable || at <= 0;
	buttons.down.disabled = !draft.editable || at < 0 || at === shown.length - 1;
	buttons.remove.disabled = !draft.editable;
}

/* What IOType has as bits is shown in words. */
const bitsOf = ({keys: {IOType}, type, io, uncached}) => IOType === undefined ? {}
	: {Type: type, IO: io, Uncached: uncached ? "on" : undefined};

const twins = (name) => draft.model.items.filter((one) => one.name === name).length > 1;

// --- Edits ----------------------------------------------------------------------------------

async function attempt(act, words) {
	try {
		await act();
		put(fault, "");
		announce(words());
	} catch (error) {
		put(fault, error.message);
	}
}

function move(name, by, stay = false) {
	const at = shown.findIndex((one) => one.item.name === name);
	const other = shown[at + by]?.item.name;
	if (!draft.editable || at < 0 || !other)
		return;
	attempt(async () => {
		await draft.edit({do: "move", name, other, where: by < 0 ? "before" : "after"});
		if (stay) {
			const there = shown.find((one) => one.item.name === name);
			for (const one of shown)
				one.button.tabIndex = one === there ? 0 : -1;
			there?.button.focus();
		}
	}, () => `${name} is now number ${draft.model.items.findIndex((one) => one.name === name) + 1}`
		+ ` of ${draft.model.items.length}.`);
}

async function remove() {
	const name = state.selected;
	if (!await ask(`Remove ${name}?`, "Remove", [el("p", {}, "Undo brings it back. Its history "
		+ "stays on disk.")]))
		return;
	attempt(async () => {
		await draft.edit({do: "remove", name});
		search.focus();
	}, () => `${name} is removed.`);
}

async function add() {
	const name = el("input", {id: "add-name", required: true, autocomplete: "off"});
	const path = el("input", {id: "add-path", required: true, autocomplete: "off",
		placeholder: "/28.0123456789AB/temperature12"});
	const refusal = el("p", {class: "fault", role: "alert"});
	const yes = await ask("Add an item", "Add", [el("label", {for: "add-name"}, "Name"), name,
		el("label", {for: "add-path"}, "Path"), path,
		el("p", {class: "hint"}, "An input of type double; the form changes it. A scan adds "
			+ "devices with less typing."), refusal], () => {
		put(refusal, draft.item(name.value.trim()) ? "Another item has this name." : "");
		return !refusal.textContent;
	});
	if (!yes)
		return;
	const wanted = name.value.trim();
	attempt(async () => {
		await draft.edit({do: "add", name: wanted, path: path.value.trim()});
		select(wanted);
		form.focus("Description");
	}, () => `${wanted} is added.`);
}
