// SPDX-License-Identifier: MIT
// Forms of the configuration, made from the table of options: a field for each key, in groups, with
// its help, its default and what the checker reports about it.
import {announce, el, put} from "./dom.js";
import {draft} from "./draft.js";

const TYPES = ["bool", "byte", "short", "long", "word", "dword", "large", "float", "double",
	"string"];
const CHOICES = {flag: ["on", "off"], type: TYPES, io: ["input", "output"]};
const UNBOUNDED = 1e15;

/** The keys of an item as people think of them; what a newer table has more comes last. */
export const ITEM_GROUPS = [
	["What it is", ["Name", "Path", "Identity", "Type", "IO", "Description", "Group"]],
	["Value", ["InitValue", "Unit", "Decimals", "Scale", "Offset", "Points", "Min", "Max", "MaxStep",
		"Filter", "Deadband", "Calibrated"]],
	["Limits", ["LimitHH", "LimitH", "LimitL", "LimitLL", "Hysteresis", "OnDelay", "OffDelay"]],
	["Output", ["SafeValue", "SafeDelay", "Start", "Confirm", "ReadBack", "Restore"]],
	["Reading", ["PerFactor", "StaleAfter", "Readable", "Writable", "Uncached", "IOType"]],
	["Alarm of the device", ["Alarm", "LatchAlarm", "PorAlarm", "SetAlarm", "ResetLatch"]],
	["History", ["Record"]],
];

function hintOf(option) {
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

/** A field: label, control, hint, fault. change(text) is called when the user has changed it. */
export class Field {
	constructor(id, option, change) {
		Object.assign(this, {option, change, shown: "", refused: "", problems: []});
		const choices = CHOICES[option.kind];
		const attributes = {id, "aria-describedby": `${id}-hint ${id}-fault`,
			"data-key": option.key, onchange: () => this.#changed()};
		this.control = choices
			? el("select", attributes, el("option", {value: ""}, option.default
				? `not set (${option.default})` : "not set"),
			...choices.map((value) => el("option", {value}, value)))
			: el("input", {...attributes, type: "text", autocomplete: "off", spellcheck: "false",
				placeholder: option.default ?? "",
				inputmode: option.kind === "text" ? "text" : "decimal"});
		this.fault = el("p", {class: "problem", id: `${id}-fault`});
		this.node = el("div", {class: "field"}, el("label", {for: id}, option.key), this.control,
			el("p", {class: "hint", id: `${id}-hint`}, hintOf(option)), this.fault);
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

	paint(text, problems) {
		const value = shownOf(this.option, text), {control} = this;
		this.problems = problems;
		if (value !== this.shown) {
			const typing = document.activeElement === control && control.value !== this.shown;
			if (control.tagName === "SELECT" && ![...control.options].some((one) =>
				one.value === value))
				control.append(el("option", {value}, value));
			if (!typing)
				control.value = value;
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

/**
 * The fields of a place. groups: [[title, keys], ...], null: one group. apply(values) changes the
 * keys of an object and returns a promise; the value is null to remove a key.
 */
export class Form {
	#painted = false;
	#refused = {}; // values that were refused, and may be right together: LimitH before LimitHH

	constructor(id, place, apply, groups = null, without = []) {
		const options = draft.options(place).filter(({key}) => !without.includes(key));
		const named = new Set((groups ?? []).flatMap(([, keys]) => keys));
		const rest = options.map(({key}) => key).filter((key) => !named.has(key));
		this.fields = new Map();
		this.parts = [...groups ?? [], [groups ? "More" : null, rest]].map(([title, keys]) => {
			const fields = keys.map((key) => options.find((one) => one.key === key)).filter(Boolean)
				.map((option) => {
					const field = new Field(`${id}-${option.key}`, option,
						(text) => this.#change(apply, option.key, valueOf(option, text)));
					this.fields.set(option.key, field);
					return field;
				});
			return {title, fields};
		}).filter(({fields}) => fields.length);
		for (const part of this.parts) {
			const inside = el("div", {class: "fields"}, ...part.fields.map((field) => field.node));
			part.count = el("span", {class: "hint"});
			part.node = part.title ? el("details", {}, el("summary", {}, part.title, " ",
				part.count), inside) : inside;
		}
		this.node = el("fieldset", {class: "plain"}, ...this.parts.map(({node}) => node));
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

	/** Show these keys, and the problems at their fields. */
	paint(keys, problems) {
		this.node.disabled = !draft.editable;
		const first = !this.#painted;
		for (const [n, {fields, count, node, title}] of this.parts.entries()) {
			let set = 0, wrong = 0;
			for (const field of fields) {
				const {key} = field.option, value = keys[key];
				const own = problems.filter((one) => one.key === key);
				field.paint(value, own);
				set += shownOf(field.option, value) === "" ? 0 : 1;
				wrong += own.length;
			}
			put(count, `${set ? `${set} set` : ""}`
				+ `${wrong ? `, \u00d7 ${wrong} problem${wrong > 1 ? "s" : ""}` : ""}`);
			if (title && (wrong || (first && (set || n < 2))))
				node.open = true;
		}
		this.#painted = true;
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
