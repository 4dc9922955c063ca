// SPDX-License-Identifier: MIT
// Edits of several items at once, each one step of undo. They return {words, focus, form}: what was
// done, and the item that gets the focus, in the grid or in the form; null: nothing was done.
import {copyName, copyOf, textOf} from "./cells.js";
import {ask} from "./command.js";
import {el, put} from "./dom.js";
import {draft} from "./draft.js";
import {controlOf, edits, hintOf, shownOf, valueOf} from "./form.js";
import {listOf} from "./words.js";

const OWN = ["Name", "Identity"]; // what two items cannot share
const NAMED = 5;

const namesOf = (items) => listOf(items.map(({name}) => name), NAMED);

/* What a filter hides is changed, too. */
const hiddenOf = ({length}, hidden) => !hidden ? ""
	: length > 1 ? `${hidden} of them not shown. ` : "It is not shown. ";

/* For ask(): do it; what is refused stays, with the reason at the field. */
const tried = (field, fault, act) => async () => {
	try {
		await act();
	} catch (error) {
		put(fault, error.message);
		field().setAttribute("aria-invalid", "true");
		field().focus();
	}
	return !fault.textContent;
};

export async function duplicate(items) {
	const taken = new Set(draft.model.items.map(({name}) => name)), steps = [];
	let first = null;
	for (const item of items) {
		const name = copyName(item.name, taken);
		taken.add(name);
		first ??= name;
		steps.push(...copyOf(item, name));
	}
	await draft.edit(...steps);
	return {focus: first, words: `${namesOf(items)}: duplicated. Each copy needs a path of its own.`};
}

export async function remove(items, hidden) {
	const left = draft.model.items, at = left.findLastIndex((item) => items.includes(item));
	const next = left.slice(at + 1).concat(left.slice(0, at).reverse())
		.find((item) => !items.includes(item));
	if (!await ask(items.length > 1 ? `Remove ${items.length} items?` : `Remove ${items[0].name}?`,
		"Remove", [el("p", {}, `${items.length > 1 ? `${namesOf(items)}. ` : ""}${hiddenOf(items, hidden)}Undo `
			+ "brings back what is removed. Its history stays on disk; an item "
			+ "with the same path goes on with it.")]))
		return null;
	await draft.edit(...items.map(({name}) => ({do: "remove", name})));
	return {focus: next?.name ?? null, words: `${namesOf(items)}: removed.`};
}

let last = "LimitH"; // the key that was set last

/* One key for all of them. */
export async function setKey(items, hidden) {
	const options = draft.options("item").filter(({key}) => !OWN.includes(key));
	const key = el("select", {id: "set-key", onchange: () => show()},
		...options.map((option) => el("option", {}, option.key)));
	const field = el("div", {}), hint = el("p", {class: "hint"});
	const fault = el("p", {class: "problem", id: "set-fault", role: "alert"});
	let option, control, value, done = false;
	const show = () => {
		const texts = new Set(items.map((item) => textOf(item, key.value)));
		option = options.find((one) => one.key === key.value);
		control = controlOf(option, {id: "set-value", "aria-describedby": "set-fault"}, texts.size > 1 ? ""
			: shownOf(option, items[0].keys[key.value] ?? textOf(items[0], key.value)));
		field.replaceChildren(control);
		put(fault, "");
		put(hint, `${hintOf(option)}${texts.size > 1 ? " They differ now." : ""} `
			+ "An empty field takes the key out.");
	};
	key.value = options.some((one) => one.key === last) ? last : options[0].key;
	show();
	if (!await ask(`Set a key of ${items.length > 1 ? `${items.length} items` : items[0].name}`, "Set",
		[el("p", {}, `${namesOf(items)}. ${hiddenOf(items, hidden)}`),
			el("label", {for: "set-key"}, "Key"), key,
			el("label", {for: "set-value"}, "Value"), field, fault, hint],
	tried(() => control, fault, async () => {
		put(fault, "");
		value = valueOf(option, control.value.trim());
		const steps = items.filter((item) => value !== null || item.keys[option.key] !== undefined)
			.flatMap(({name}) => edits({[option.key]: value}, "set", "unset", {name}));
		if (steps.length)
			await draft.edit(...steps);
		done = steps.length > 0;
	})))
		return null;
	last = option.key;
	return !done ? null : {words: `${last} of ${namesOf(items)}: ${value ?? "not set"}.`};
}

export async function add() {
	const fault = el("p", {class: "problem", id: "add-fault", role: "alert"});
	const input = (id, more) => el("input", {id, required: true, autocomplete: "off",
		"aria-describedby": "add-fault", ...more});
	const name = input("add-name"), path = input("add-path",
		{placeholder: "/28.0123456789AB/temperature12"});
	let wanted;
	const yes = await ask("Add an item", "Add", [el("label", {for: "add-name"}, "Name"), name,
		el("label", {for: "add-path"}, "Path"), path, fault,
		el("p", {class: "hint"}, "An input of type double; the form changes it. A scan adds "
			+ "devices with less typing.")], tried(() => fault.of, fault, async () => {
		put(fault, "");
		for (const one of [name, path])
			one.removeAttribute("aria-invalid");
		wanted = name.value.trim();
		fault.of = name;
		if (draft.item(wanted))
			throw new Error("Another item has this name.");
		fault.of = path;
		await draft.edit({do: "add", name: wanted, path: path.value.trim()}).catch((error) => {
			fault.of = /path|device|property/i.test(error.message) ? path : name;
			throw error;
		});
	}));
	return yes ? {form: wanted, words: `${wanted} is added.`} : null;
}
