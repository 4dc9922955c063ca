// SPDX-License-Identifier: MIT
// A signal as a row of the live table: built when it is shown, then only what changed is painted.
import {control} from "./command.js";
import {el, mark, put} from "./dom.js";
import {drawSpark, sparkline} from "./spark.js";
import {store} from "./store.js";
import {SHAPES, alarmOf, meaningOf, qualityWords, remedyOf, span, stateOf, valueText}
	from "./words.js";

export class Row {
	#node = null;
	#hidden = false;

	constructor(signal) {
		this.signal = signal;
	}

	get built() {
		return this.#node !== null;
	}

	get node() {
		if (!this.#node) {
			this.#build();
			this.#node.hidden = this.#hidden;
			this.paint();
		}
		return this.#node;
	}

	get hidden() {
		return this.#hidden;
	}

	set hidden(hidden) {
		this.#hidden = hidden;
		if (this.#node)
			this.#node.hidden = hidden;
	}

	#build() {
		const s = this.signal;
		this.alarm = el("span", {class: "alarm", hidden: true});
		this.number = el("span", {class: "number"});
		this.unit = el("span", {class: "unit"}, s.unit || "");
		this.spark = sparkline();
		this.shape = el("span", {class: "shape", "aria-hidden": "true"});
		this.words = el("span", {class: "words"});
		this.why = el("button", {type: "button", class: "quality", "aria-expanded": "false",
			onclick: () => this.#toggle()}, this.shape, this.words);
		this.fine = el("span", {class: "quality fine"}, "good");
		this.age = el("td", {class: "c-age", role: "cell"});
		this.command = s.output ? control(s) : null;
		this.detail = el("td", {class: "c-detail", role: "cell", hidden: true});
		this.#node = el("tr", {class: "row", role: "row"},
			el("th", {class: "c-name", role: "rowheader", scope: "row"},
				el("span", {class: "name"}, s.name), this.alarm,
				s.description ? el("span", {class: "description"}, s.description) : null),
			el("td", {class: "c-value", role: "cell"}, this.number, this.unit),
			el("td", {class: "c-spark", role: "cell"}, this.spark),
			el("td", {class: "c-quality", role: "cell"}, this.fine, this.why),
			this.age,
			el("td", {class: "c-command", role: "cell"}, this.command?.node),
			this.detail);
	}

	#toggle() {
		const open = this.detail.hidden;
		this.detail.hidden = !open;
		this.why.setAttribute("aria-expanded", String(open));
		this.#explain();
	}

	#explain() {
		const code = store.quality(this.signal);
		if (this.detail.hidden)
			return;
		if (store.unknown) {
			put(this.detail, store.unknown);
			return;
		}
		const why = this.signal.why ? el("p", {}, `Reason: ${this.signal.why}`) : null;
		const remedy = remedyOf(code);
		this.detail.replaceChildren(...[why, el("p", {}, meaningOf(code)),
			remedy ? el("p", {}, el("strong", {}, "Remedy: "), remedy) : null,
			this.signal.path ? el("p", {class: "path"}, `Path: ${this.signal.path}`) : null]
			.filter(Boolean));
	}

	/** All but the line and the age. */
	paint() {
		const s = this.signal;
		const code = store.quality(s);
		const state = stateOf(code);
		const value = store.value(s);
		const alarm = alarmOf(s.alarm);
		put(this.number, store.unknown ? "unknown" : valueText(s, value));
		this.unit.hidden = value === null || !s.unit;
		put(this.fine, s.simulated ? "good, simulated" : "good");
		this.fine.hidden = state !== "good";
		this.why.hidden = state === "good";
		put(this.words, this.#wordsOf(code));
		put(this.shape, SHAPES[state]);
		mark(this.node, "is-", state);
		this.alarm.hidden = !alarm || Boolean(store.unknown);
		put(this.alarm, alarm ? alarm.text : "");
		this.alarm.classList.toggle("open", Boolean(alarm?.open));
		this.command?.paint(value);
		if (state === "good" && !this.detail.hidden)
			this.#toggle();
		this.#explain();
		this.paintAge();
	}

	#wordsOf(code) {
		return code === this.signal.code && this.signal.text ? this.signal.text
			: qualityWords(code);
	}

	paintAge() {
		put(this.age, span(store.age(this.signal)));
	}

	paintLine() {
		drawSpark(this.spark, this.signal.recent, store.now());
	}

	/** Does the row have all these words somewhere? */
	matches(words) {
		const s = this.signal;
		const text = `${s.name} ${s.description ?? ""} ${s.path ?? ""} ${s.device ?? ""} `
			+ `${s.family ?? ""} ${s.unit ?? ""} ${s.output ? "output" : "input"} `
			+ `${s.type} ${this.#wordsOf(store.quality(s))} ${alarmOf(s.alarm) ? `alarm ${s.alarm}` : ""}`;
		return words.every((word) => text.toLowerCase().includes(word));
	}

	/** For the order by state: what wants eyes first. */
	get urgency() {
		const alarm = alarmOf(this.signal.alarm);
		const state = stateOf(store.quality(this.signal));
		return (alarm?.open ? 0 : alarm ? 1 : 2) * 4
			+ ["bad", "unknown", "uncertain", "good"].indexOf(state);
	}
}
