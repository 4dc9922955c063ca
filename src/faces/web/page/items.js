// SPDX-License-Identifier: MIT
// The items of the draft: the grid of all, what is done with the chosen ones, the form of one.
import {isOn} from "./cells.js";
import {action, announce, el, later, put} from "./dom.js";
import {draft} from "./draft.js";
import {FIRST, Form, MORE, OUTPUT, setter} from "./form.js";
import {Grid} from "./grid.js";
import {problemsOf} from "./problems.js";
import {Special} from "./special.js";
import * as several from "./several.js";
import {store} from "./store.js";
import {plural, qualityWords, valueText, withUnit, wordsOf} from "./words.js";

const state = {query: "", group: null, selected: null, at: -1, of: 0}; // selected: at of so many
let search, groups, count, grid, view, editor, empty, form = null, head, place, value, double, also;
let fault, buttons, special;

export function build(root) {
	search = el("input", {type: "search", id: "config-search", placeholder: "Search",
		"aria-label": "Search items by name, path, type, unit", autocomplete: "off",
		oninput: () => {
			state.query = search.value;
			filter();
		}});
	groups = el("div", {class: "buttons", role: "group", "aria-label": "Groups"});
	count = el("p", {class: "count"});
	also = el("select", {id: "also", onchange: () => {
		grid.also = also.value;
		paint();
	}});
	buttons = {
		set: action("Set a key\u2026", () => attempt(several.setKey), "set-key"),
		copy: action("Duplicate", () => attempt(several.duplicate), "duplicate"),
		remove: action("Remove\u2026", () => attempt(several.remove), "remove"),
		add: action("Add an item\u2026", () => attempt(several.add), "add"),
		up: action("Move up", () => move(state.selected, -1), "up"),
		down: action("Move down", () => move(state.selected, 1), "down"),
		back: action("\u2190 All items", back, "back"),
	};
	grid = new Grid({edit: (name, values) => apply(name, values), select, open: (name) => {
		select(name);
		view.classList.add("is-open");
		head.focus();
	}, choose: paintTools, move: (name, by) => move(name, by, true),
	remove: () => attempt(several.remove), undo: (what) => draft[what]()});
	head = el("h2", {tabindex: -1});
	place = el("span", {class: "hint"});
	value = el("span", {class: "value-now"});
	fault = el("p", {class: "fault", role: "alert"});
	double = el("p", {class: "problem"}, "Two items have this name. Correct that in the text.");
	editor = el("div", {class: "editor sheet", hidden: true}, buttons.back,
		el("div", {class: "editor-head"}, head, place, value),
		el("div", {class: "tools"}, buttons.up, buttons.down), double);
	empty = el("p", {class: "note"});
	special = new Special();
	view = el("div", {class: "items-view"}, el("div", {class: "items-list"},
		el("div", {class: "tools", role: "search"}, search, groups, count, el("span",
			{class: "spread"}, buttons.set, buttons.copy, buttons.remove, buttons.add,
			el("label", {for: "also"}, "Also show ", also))),
		grid.node, el("p", {class: "hint"}, "Arrows go from cell to cell, Enter edits, Esc leaves, "
			+ "Space chooses, Ctrl+Z takes back. With Alt, arrows move the item in the file.")),
	el("div", {class: "side"}, empty, editor));
	root.append(fault, view);
	store.addEventListener("values", later(() => {
		if (view.checkVisibility()) {
			grid.paintValues();
			paintValue();
		}
	}, 500));
}

/** Open an item, and put the focus into the field of a key. */
export function open({item, key}) {
	if (item !== undefined && draft.item(item)) {
		select(item);
		view.classList.add("is-open");
	}
	if (key && form)
		form.focus(key);
	else if (item !== undefined && !editor.hidden)
		head.focus();
}

function back() {
	view.classList.remove("is-open");
	grid.focus(state.selected);
}

export function paint() {
	const {items} = draft.model;
	if (!draft.keys.length)
		return;
	if (state.selected !== null && !draft.item(state.selected)) // renamed, or gone
		state.selected = items.length === state.of ? items[state.at]?.name ?? null : null;
	state.at = items.findIndex((item) => item.name === state.selected);
	state.of = items.length;
	if (!also.childElementCount)
		also.append(...draft.options("item").map(({key}) => el("option", {}, key)));
	also.value = grid.also;
	grid.current = state.selected;
	filter();
	paintGroups();
	paintEditor();
}

// --- The grid -------------------------------------------------------------------------------

function filter() {
	const words = wordsOf(state.query), {items} = draft.model;
	grid.keep = (item, {text}) => words.every((word) => text.includes(word))
		&& (state.group === null || (item.keys.Group ?? "") === state.group);
	grid.paint();
	const shown = grid.shown.length;
	put(count, `${shown < items.length ? `${shown} of ` : ""}${plural(items.length, "item")}`);
	paintTools();
}

/* A chip for each group, where there is one. */
function paintGroups() {
	const {items} = draft.model, counts = new Map();
	for (const {keys} of items)
		counts.set(keys.Group ?? "", (counts.get(keys.Group ?? "") ?? 0) + 1);
	const names = [...counts.keys()].filter(Boolean).sort();
	if (state.group !== null && !counts.has(state.group))
		state.group = null;
	const chip = (text, group, of) => el("button", {type: "button", class: "chip",
		"data-group": group ?? "*", "aria-pressed": String(state.group === group), onclick: () => {
			state.group = group;
			paint();
			groups.querySelector("[aria-pressed=true]").focus();
		}}, text, el("span", {class: "hint"}, String(of)));
	groups.hidden = !names.length;
	const drawn = JSON.stringify([state.group, ...counts]);
	if (groups.drawn !== drawn)
		groups.replaceChildren(chip("All", null, items.length),
			...names.map((name) => chip(name, name, counts.get(name))));
	groups.drawn = drawn;
}

/** The items that are chosen, in their order; else the one that is open. */
const wanted = () => {
	const chosen = draft.model.items.filter(({name}) => grid.chosen.has(name));
	return chosen.length ? chosen : [draft.item(state.selected)].filter(Boolean);
};

function paintTools() {
	const {size} = grid.chosen, able = draft.editable && wanted().length > 0;
	put(buttons.set, size ? `Set a key of ${size}\u2026` : "Set a key\u2026");
	put(buttons.copy, size ? `Duplicate ${size}` : "Duplicate");
	put(buttons.remove, size ? `Remove ${size}\u2026` : "Remove\u2026");
	buttons.set.disabled = buttons.copy.disabled = buttons.remove.disabled = !able;
	buttons.add.disabled = !draft.editable;
}

// --- The form -------------------------------------------------------------------------------

/* Refuses what the checker would only find in the whole. */
function apply(name, values) {
	if (values.Name === null)
		throw new Error("A signal needs a name.");
	if (values.Name && draft.item(values.Name))
		throw new Error("Another item has this name.");
	return setter(() => name)(values);
}

/* An output has two fields more among the first. */
function makeForm(io) {
	form?.node.remove();
	form = new Form("item", "item", async (values) => apply(state.selected, values),
		{first: io === "output" ? [...FIRST, ...OUTPUT] : FIRST, groups: MORE});
	form.io = io;
	editor.append(form.node, special.node);
}

function select(name) {
	if (state.selected === name && form)
		return;
	state.selected = name;
	makeForm(draft.item(name)?.io);
	state.at = draft.model.items.findIndex((item) => item.name === name);
	grid.mark(name);
	paintEditor();
	paintTools();
}

function paintEditor() {
	const item = state.selected === null ? null : draft.item(state.selected);
	editor.hidden = !item;
	empty.hidden = Boolean(item);
	if (!item)
		view.classList.remove("is-open");
	put(empty, draft.model.items.length ? "Choose an item of the list."
		: "The draft has no item. Scan for devices, or add an item.");
	if (!item)
		return;
	const at = grid.shown.findIndex((row) => row.item.name === item.name);
	put(head, item.name);
	put(place, `${state.at + 1} of ${state.of}`);
	double.hidden = !twins(item.name);
	if (form.io !== item.io && !form.node.contains(document.activeElement))
		makeForm(item.io);
	const was = grid.was.get(item.name);
	form.paint(keysOf(item), problemsOf({part: "items", item: item.name}), was && keysOf(was));
	form.node.disabled ||= twins(item.name);
	buttons.up.disabled = !draft.editable || !grid.plain || at <= 0;
	buttons.down.disabled = !draft.editable || !grid.plain || at < 0 || at === grid.shown.length - 1;
	paintValue();
}

function paintValue() {
	const signal = store.find(state.selected);
	const {io, keys} = draft.item(state.selected) ?? {};
	special.show(store.unknown ? null : signal ?? null, io === "output" || isOn(keys?.Writable));
	const now = signal ? store.value(signal) : null;
	put(value, !signal ? "" : now === null ? qualityWords(store.quality(signal))
		: withUnit(signal, valueText(signal, now)));
}

/* What IOType has as bits is shown in words. */
const bitsOf = ({keys: {IOType}, type, io, uncached}) => IOType === undefined ? {}
	: {Type: type, IO: io, Uncached: uncached ? "on" : undefined};

const keysOf = (item) => ({Name: item.name, Path: item.path, ...bitsOf(item), ...item.keys});

const twins = (name) => draft.model.items.filter((one) => one.name === name).length > 1;

// --- Edits ----------------------------------------------------------------------------------

/* act(items) returns {words, focus, form}: what to announce, and where the focus goes; null: no. */
async function attempt(act) {
	try {
		const items = wanted(), shown = new Set(grid.shown.map(({item}) => item));
		const done = await act(items, items.filter((item) => !shown.has(item)).length);
		put(fault, "");
		if (!done)
			return;
		if (done.form) {
			open({item: done.form, key: "Description"});
		} else if (done.focus !== undefined) {
			grid.focus(done.focus);
			if (!grid.shown.length)
				search.focus();
		}
		announce(done.words);
	} catch (error) {
		put(fault, error.message);
	}
}

function move(name, by, stay = false) {
	const at = grid.shown.findIndex(({item}) => item.name === name);
	const other = grid.shown[at + by]?.item.name;
	if (!draft.editable || at < 0 || !other || !grid.plain)
		return;
	attempt(async () => {
		await draft.edit({do: "move", name, other, where: by < 0 ? "before" : "after"});
		return {focus: stay ? name : undefined, words: `${name} is now number `
			+ `${draft.model.items.findIndex((one) => one.name === name) + 1} of `
			+ `${draft.model.items.length}.`};
	});
}
