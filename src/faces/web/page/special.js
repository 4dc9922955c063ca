// SPDX-License-Identifier: MIT
// The special signals of a signal, beside its value: ages and counters, read while they are seen,
// and what can be done by hand: reading and writing off and on, a write at once, counters reset.
import {failed, get, post} from "./api.js";
import {ask} from "./command.js";
import {announce, el, put} from "./dom.js";
import {store} from "./store.js";

const EVERY_MS = 2000;
const WRITES = ["_WriteEnable", "_WriteOneShot"]; // what moves an output
const SECONDS = ["_Age", "_AgeMax", "_Period"]; // a hundredth is enough
const WORDS = {
	_Age: "seconds since it was measured", _AgeMax: "the greatest age since the reset",
	_PerFactor: "periods between two reads", _PerCount: "periods since the last update",
	_PerMax: "most of them since the reset", _PendCount: "periods that a request waits now",
	_PendLast: "that the last one waited", _PendMax: "most of them since the reset",
	_Period: "seconds between the last two updates", _TRANSACTIONS: "requests since the reset",
	_Raw: "the value before Scale and Offset", _ReadEnable: "owsd reads it",
	_ReadOneShot: "read it once, at once", _WriteEnable: "owsd writes what is set",
	_WriteOneShot: "write the command once, at once",
	_DGNRESET: "set counters and greatest values back",
};

/** What is shown of a special signal: {name, text, words, act}; act: "switch", "button", null. */
export function rowOf({name, value, flag, readable, writable}) {
	const act = !writable ? null : readable ? "switch" : "button";
	const on = Number(value) !== 0;
	return {name, words: WORDS[name] ?? "", act, on, text: !readable ? ""
		: value === null ? "unknown" : flag ? on ? "on" : "off"
			: SECONDS.includes(name) ? String(Number(Number(value).toFixed(2))) : value};
}

export class Special {
	#signal = null;
	#timer = 0;
	#rows = new Map();

	constructor() {
		this.summary = el("span", {class: "hint"});
		this.list = el("dl", {class: "special"});
		this.fault = el("p", {class: "fault", role: "alert"});
		this.node = el("details", {ontoggle: () => this.#read()},
			el("summary", {}, "Watch by hand ", this.summary), this.list, this.fault);
	}

	/** signal: of the store; null: there is none, or it does not run. written: owsd can write it. */
	show(signal, written) {
		this.hidden = written ? [] : WRITES;
		this.node.hidden = !signal;
		if (signal?.name === this.#signal?.name)
			return;
		this.#signal = signal;
		this.#rows.clear();
		this.list.replaceChildren();
		put(this.fault, "");
		this.#read();
	}

	async #read() {
		clearTimeout(this.#timer);
		const signal = this.#signal;
		if (!signal || !this.node.open)
			return;
		if (this.node.checkVisibility() && !document.hidden)
			try {
				const {signals} = await get("special", {name: signal.name});
				if (signal !== this.#signal)
					return;
				signals.filter(({name}) => !this.hidden.includes(name)).map(rowOf)
					.forEach((row) => this.#paint(row));
				put(this.fault, "");
			} catch (error) {
				put(this.fault, `They cannot be read now: ${error.message}.`);
			}
		clearTimeout(this.#timer);
		this.#timer = setTimeout(() => this.#read(), EVERY_MS);
	}

	#paint(row) {
		let one = this.#rows.get(row.name);
		if (!one) {
			one = {text: el("span", {}), act: row.act && el("button", {type: "button",
				"data-action": row.name, onclick: () => this.#set(row, one)})};
			this.#rows.set(row.name, one);
			this.list.append(el("dt", {}, el("code", {}, row.name), el("span", {class: "description"},
				row.words)), el("dd", {}, one.text, one.act));
		}
		one.on = row.on;
		put(one.text, row.text);
		if (!one.act)
			return;
		one.act.disabled = !store.info?.writable;
		put(one.act, row.act === "button" ? "Do it" : row.on ? "Switch off" : "Switch on");
		one.act.setAttribute("aria-label", `${one.act.textContent}: ${row.name}`);
	}

	async #set({name, act}, one) {
		const value = act === "button" || !one.on, signal = this.#signal;
		if (value && signal.confirm && WRITES.includes(name) && !await ask(
			`${signal.name}${name}?`, "Do it", [el("p", {}, `${WORDS[name]}.`)]))
			return;
		try {
			const {result} = await post("set", {name: `${signal.name}${name}`, value});
			put(this.fault, result === "pending" ? `${name}: owsd has not taken it yet.` : "");
			announce(`${name}: ${result === "pending" ? "not taken yet" : act === "button" ? "sent"
				: value ? "on" : "off"}`);
		} catch (error) {
			put(this.fault, `${name}: ${failed(error)}`);
		}
		this.#read();
	}
}
