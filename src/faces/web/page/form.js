// SPDX-License-Identifier: MIT
// Forms of the configuration, made from the table of options: a field for each key, in groups, with
// its help, its default and what the checker reports about it.
import {announce, el, put} from "./dom.js";
import {draft} from "./draft.js";
import {plural} from "./words.js";

const TYPES = ["bool", "byte", "short", "long", "word", "dword", "large", "float", "double",
	"string"];
const CHOICES = {flag: ["on", "off"], type: TYPES, io: ["input", "output"]};
const UNBOUNDED = 1e15;

/** What most want of an item, as people call it; of an output also the second list. */
export const FIRST = [["Name"], ["Description", "What it is"], ["Group"], ["Unit"], ["Decimals"],
	["LimitL", "Too low at"], ["LimitH", "Too high at"], ["Path"]];
export const OUTPUT = [["InitValue", "First value"], ["SafeValue", "Safe value"]];

/** The other keys of an item; what a newer table has more comes last. */
export const MORE = [
	["What it is", ["Identity", "Type", "IO", "Class"]],
	["Value", ["InitValue", "Scale", "Offset", "Points", "Min", "Max", "MaxStep", "Filter", "Deadband",
		"Calibrated"]],
	["Limits", ["LimitHH", "LimitLL", "Hysteresis", "OnDelay", "OffDelay"]],
	["Output", ["SafeValue", "SafeDelay", "Start", "Confirm", "ReadBack", "Restore"]],
	["Reading", ["PerFactor", "StaleAfter", "Readable", "Writable", "Uncached", "IOType"]],
	["Alarm of the device", ["Alarm", "LatchAlarm", "PorAlarm", "SetAlarm", "ResetLatch"]],
	["History", ["Record"]],
];

export function hintOf(option) {
	const bounded = (n) => n !== null && n !== undefined && Math.abs(n) < UNBOUNDED;
	const {least, most} = option;
	const range = bounded(least) && bounded(most) ? ` From ${least} to ${most}.`
		: bounded(least) ? ` ${least} or more.` : "";
	const help = option.help ? `${option.help[0].toUpperCase()}${option.help.slice(1)}.` : "";
	return `${help.replace(/\.\.$/, ".")}${range}`
		+ `${option.empty ? ' "" stands for an empty text.' : ""}`
		+ `${option.default ? ` Default: ${option.default}.` : ""}`;
}

/** What stands in the field: "" for an empty text that is a value, nothing for an absent key. */
export const shownOf = (option, value) => (option.empty && value === "" ? '""' : value ?? "");

/** The value of what was written into the field; null: the key goes. */
export const valueOf = (option, text) =>
	(option.empty && text === '""' ? "" : text === "" ? null : text);

/** The control of a key, with these attributes and that text in it. */
export function controlOf(option, attributes, text = "") {
	const choices = CHOICES[option.kind];
	const control = choices
		? el("select", attributes, el("option", {value: ""}, option.default
			? `not set (${option.default})` : "not set"),
		...choices.map((value) => el("option", {value}, value)))
		: el("input", {...attributes, type: "text", autocomplete: "off", spellcheck: "false",
			placeholder: option.default ?? "",
			inputmode: option.kind === "text" ? "text" : "decimal"});
	write(control, text);
	return control;
}

function write(control, value) {
	if (control.tagName === "SELECT" && ![...control.options].some((one) => one.value === value))
		control.append(el("option", {value}, value));
	control.value = value;
}

/** A field: label, control, hint, fault. change(text) is called when the user has changed it. */
export class Field {
	constructor(id, option, change, word = option.key) {
		Object.assign(this, {option, change, shown: "", refused: "", problems: []});
		this.control = controlOf(option, {id, "aria-describedby": `${id}-hint ${id}-fault`,
			"data-key": option.key, onchange: () => this.#changed()});
		this.old = el("span", {class: "old"});
		this.fault = el("p", {class: "problem", id: `${id}-fault`});
		this.node = el("div", {class: "field"}, el("label", {for: id}, word), this.control,
			el("p", {class: "hint", id: `${id}-hint`}, word === option.key ? "" : `${option.key}: `,
				hintOf(option), this.old), this.fault);
	}

	async #changed() {
		const text = this.control.value;
		this.refused = "";
		this.#report(this.problems);
		if (text === this.shown)
			return;
		try {
			await this.change(text.trim());
			const wrong = this.problems.find((one) => one.error);
			if (wrong)
				announce(`${this.option.key}: ${wrong.text}`);
		} catch (error) {
			this.refuse(error.message);
		}
	}

	/** Words at the field, until it has another value. */
	refuse(words) {
		this.refused = `${words}${/[.?]$/.test(words) ? "" : "."} The draft does not have it.`;
		this.#report(this.problems);
		announce(`${this.option.key}: ${words}`);
	}

	accept() {
		this.refused = "";
		this.#report(this.problems);
	}

	/** old: what the file has, if that is another text. */
	paint(text, problems, old = null) {
		put(this.old, old === null ? "" : ` The file has ${old}.`);
		this.node.classList.toggle("is-changed", old !== null);
		const value = shownOf(this.option, text), {control} = this;
		this.problems = problems;
		if (value !== this.shown) {
			const typing = document.activeElement === control && control.value !== this.shown;
			if (!typing)
				write(control, value);
			this.refused = "";
			this.shown = value;
		}
		this.#report(problems);
	}

	#report(problems) {
		const errors = problems.filter((one) => one.error);
		const words = [this.refused, ...problems.map((one) =>
			`${one.error ? "" : "Warning: "}${one.text}`)].filter(Boolean).join(" ");
		put(this.fault, words);
		const wrong = errors.length > 0 || Boolean(this.refused);
		this.fault.classList.toggle("is-warning", Boolean(words) && !wrong);
		if (wrong)
			this.control.setAttribute("aria-invalid", "true");
		else
			this.control.removeAttribute("aria-invalid");
	}
}

let opened = false; // the part More, of the item before

/**
 * The fields of a place: first those of [key, word], and behind More the others, in groups
 * [title, keys]; without a first list all of them. apply(values) changes the keys of an object and
 * returns a promise; the value is null to remove a key.
 */
export class Form {
	#refused = {}; // values that were refused, and may be right together: LimitH before LimitHH

	constructor(id, place, apply, {first = null, groups = [], without = []} = {}) {
		const options = draft.options(place).filter(({key}) => !without.includes(key));
		this.fields = new Map();
		const fieldsOf = (keys) => el("div", {class: "fields"}, ...keys.map(([key, word]) => {
			const option = options.find((one) => one.key === key);
			if (!option || this.fields.has(key))
				return null;
			const field = new Field(`${id}-${key}`, option,
				(text) => this.#change(apply, key, valueOf(option, text)), word);
			this.fields.set(key, field);
			return field.node;
		}));
		const all = options.map(({key}) => [key]);
		this.node = el("fieldset", {class: "plain"}, fieldsOf(first ?? all));
		this.behind = all.filter(([key]) => !this.fields.has(key)).length;
		if (!this.behind)
			return;
		const parts = [...groups, ["Others", all.flat()]].map(([title, keys]) =>
			[title, fieldsOf(keys.map((key) => [key]))]).filter(([, box]) => box.childElementCount);
		this.count = el("span", {class: "hint"});
		this.more = el("details", {open: opened, ontoggle: () => { opened = this.more.open; }},
			el("summary", {}, "More ", this.count),
			...parts.flatMap(([title, box]) => [el("h3", {}, title), box]));
		this.node.append(this.more);
	}

	/* What was refused before is tried again after a change, or with it: that may be right. */
	async #change(apply, key, value) {
		const own = {[key]: value};
		delete this.#refused[key];
		let refusal = await apply(own).then(() => null, (error) => error);
		for (const [other, text] of Object.entries(this.#refused))
			try {
				await apply(refusal ? {[other]: text, ...own} : {[other]: text});
				refusal = null;
				delete this.#refused[other];
				this.fields.get(other).accept();
			} catch {
				// it stays refused
			}
		if (refusal) {
			this.#refused[key] = value;
			throw refusal;
		}
	}

	/** Show these keys, and the problems at their fields; was: the keys of the file, if it has them. */
	paint(keys, problems, was = null) {
		const set = [];
		let wrong = 0;
		this.node.disabled = !draft.editable;
		for (const [key, field] of this.fields) {
			const own = problems.filter((one) => one.key === key), {option} = field;
			const [now, old] = [keys, was ?? keys].map((of) => shownOf(option, of[key]));
			field.paint(keys[key], own, now === old ? null : old || "none");
			if (!this.more?.contains(field.node))
				continue;
			wrong += own.length;
			if (now !== "")
				set.push(key);
		}
		if (!this.more)
			return;
		this.more.open ||= wrong > 0;
		put(this.count, `${this.behind} keys${set.length ? `, ${set.length} set: ${set.join(", ")}` : ""}`
			+ `${wrong ? `, \u00d7 ${plural(wrong, "problem")}` : ""}`);
	}

	/** Put the focus into the field of a key. */
	focus(key) {
		const field = this.fields.get(key), box = field?.node.closest("details");
		if (box)
			box.open = true;
		field?.control.focus();
		return Boolean(field);
	}
}

/** The edits that change such keys: set and unset are the names of the edits, with more members. */
export function edits(values, set, unset, more) {
	const given = Object.entries(values).filter(([, value]) => value !== null);
	const gone = Object.keys(values).filter((key) => values[key] === null);
	const keys = given.map(([key, value]) => `${key}=${value}`).join("\n");
	return [given.length ? {do: set, ...more, keys} : null,
		gone.length ? {do: unset, ...more, keys: gone.join("\n")} : null].filter(Boolean);
}

/** apply() of a Form for the item or block of that name. */
export const setter = (name) => (values) =>
	draft.edit(...edits(values, "set", "unset", {name: name()}));
