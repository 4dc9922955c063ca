// SPDX-License-Identifier: MIT
// The buttons and the field above a trend: how long its window is, where, and what is done with it.
import {button, el, put} from "./dom.js";
import {store} from "./store.js";
import {besideOf, lastNight, windowOf, windowText} from "./when.js";

const SPANS = [[600, "10 min"], [3600, "1 h"], [28800, "8 h"], [86400, "1 d"], [604800, "7 d"],
	[2592000, "30 d"]];

export class Tools {
	/**
	 * act: span(ms), shift(part of the window), go([from, until]), follow(), beside(), link(),
	 * table(), fault(words): what was typed is no window.
	 */
	constructor(act, title) {
		this.act = act;
		this.spans = SPANS.map(([seconds, text]) => button(text, () => act.span(seconds * 1000),
			{"data-span": seconds * 1000}));
		this.field = el("input", {type: "text", class: "times", autocomplete: "off",
			spellcheck: "false", "aria-describedby": "trend-told",
			"aria-label": "Window of time; for example: yesterday 18:00",
			onchange: () => this.#typed(), onfocus: () => this.field.select(),
			onblur: () => this.draw(this.state), onkeydown: (event) => this.#key(event)});
		this.date = el("input", {type: "datetime-local", class: "date", tabindex: -1,
			"aria-hidden": "true", onchange: () => this.date.value && this.#begin()});
		this.beside = button("Beside yesterday", act.beside);
		this.live = button("Follow", act.follow, {class: "follow"});
		this.node = el("div", {class: "tools"}, title,
			el("div", {class: "joined", role: "group", "aria-label": "How long"}, ...this.spans),
			el("div", {class: "joined moves", role: "group", "aria-label": "Which time"},
				button("\u2039", () => act.shift(-0.5), {"aria-label": "Earlier"}), this.field,
				button("\u25be", () => this.date.showPicker(), {"aria-label": "Choose a date"}),
				button("\u203a", () => act.shift(0.5), {"aria-label": "Later"}), this.date),
			button("Last night", () => act.go(lastNight(store.now()))), this.beside, this.live,
			button("CSV\u2026", act.table, {class: "csv"}), button("Copy link", act.link));
	}

	/** Show the window: from, until (null: now), span, beside. */
	draw(state) {
		const {from, until, span, beside} = this.state = state;
		for (const one of this.spans)
			one.setAttribute("aria-pressed", String(Number(one.dataset.span) === span));
		this.live.setAttribute("aria-pressed", String(until === null));
		put(this.live, until === null ? "Following" : "Follow");
		this.beside.setAttribute("aria-pressed", String(beside));
		put(this.beside, `Beside ${besideOf(span)[1]}`);
		if (this.field === document.activeElement)
			return;
		this.field.removeAttribute("aria-invalid");
		this.field.value = windowText(from, until, store.now());
	}

	#begin() {
		const from = Date.parse(this.date.value);
		this.act.go([from, from + this.state.span]);
	}

	#typed() {
		const {value} = this.field, wanted = windowOf(value, store.now(), this.state.span);
		const turned = wanted && wanted[1] <= wanted[0];
		const past = wanted && !turned && wanted[0] < store.now();
		this.field.setAttribute("aria-invalid", String(!past));
		if (past) {
			this.field.blur();
			this.act.go(wanted);
			return;
		}
		this.act.fault(turned ? `\u201c${value}\u201d ends before it begins.`
			: `\u201c${value}\u201d is no time that was. Type \u201cyesterday 18:00\u201d, `
			+ "\u201cFri 18:00 \u2013 Sat 8:00\u201d or \u201c12 Nov\u201d.");
	}

	#key({key}) {
		if (key !== "Escape")
			return;
		this.field.value = windowText(this.state.from, this.state.until, store.now());
		this.field.blur();
	}
}
