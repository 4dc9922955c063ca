// SPDX-License-Identifier: MIT
// The signals of a trend: found by a search, each with its figures at the cursor.
import {announce, button, el, put} from "./dom.js";
import {extremes, heldAt, onPart} from "./series.js";
import {UNKNOWN, qualityWords, stateOf, valueText, wordsOf} from "./words.js";

const MOST = 10, OFTEN = 4;

/** Texts to search in, made once for a list of signals: 10 000 of them are searched at each key. */
export const searched = (signals) => signals.map((signal) => ({signal, text: [signal.name,
	signal.description, signal.device, signal.group, signal.unit].join(" ").toLowerCase()}));

/** The signals that have all words, those whose name begins with the first one before others. */
export function found(texts, query, most = MOST) {
	const words = wordsOf(query);
	const first = [], others = [];
	let count = 0;
	for (const {signal, text} of texts) {
		if (!words.every((word) => text.includes(word)))
			continue;
		count++;
		const place = text.startsWith(words[0] ?? "") ? first : others;
		if (place.length < most)
			place.push(signal);
	}
	return {count, signals: [...first, ...others].slice(0, most)};
}

/** Signals that are looked at together with these: of their group, else of their unit. */
export function often(signals, picked) {
	const others = signals.filter((one) => !picked.includes(one));
	const of = (key) => others.filter((one) => one[key] && picked.some((two) => two[key] === one[key]));
	return [...new Set([...of("group"), ...of("unit")])].slice(0, OFTEN);
}

export class Picker {
	/** act: add(name), remove(name): the user wants a signal, or not; has(name): he has chosen it. */
	constructor(act) {
		this.act = act;
		this.texts = [];
		this.rows = [];
		this.field = el("input", {type: "search", placeholder: "Add a signal", autocomplete: "off",
			"aria-label": "Search signals to add", "aria-controls": "trend-found",
			oninput: () => this.#search(), onfocus: () => this.#search()});
		this.matches = el("ul", {class: "matches", id: "trend-found", hidden: true});
		const search = el("div", {class: "picks", onkeydown: (event) => this.#key(event),
			onfocusout: ({relatedTarget}) => search.contains(relatedTarget) || this.#close()},
		this.field, this.matches);
		this.list = el("ul", {class: "legend sheet", "aria-label": "Signals of the trend"});
		this.hint = el("p", {class: "hint"});
		this.often = el("div", {class: "often"});
		this.node = el("div", {class: "picker"}, search, this.list, this.hint, this.often);
	}

	/** all: signals that can be picked; picked: [{signal, number}], number being that of its line. */
	take(all, picked) {
		this.all = all;
		this.picked = picked;
		this.texts = searched(all);
		const focused = this.list.contains(document.activeElement)
			? [...this.list.children].findIndex((row) => row.contains(document.activeElement)) : -1;
		this.rows = picked.map(({signal, number}) => this.#row(signal, number));
		this.list.replaceChildren(...this.rows.map(({node}) => node));
		this.list.hidden = !picked.length;
		if (focused >= 0)
			(this.list.querySelectorAll("button")[Math.min(focused, picked.length - 1)]
				?? this.field).focus();
		const more = often(all, picked.map(({signal}) => signal));
		this.often.replaceChildren(...more.length && picked.length
			? [el("h2", {}, "Often with these"), ...more.map(({name}) => button(`+ ${name}`,
				() => this.act.add(name), {class: "chip"}))] : []);
	}

	#row(signal, number) {
		const figure = el("span", {class: "figure"}), range = el("span", {class: "range"});
		const kind = signal.type === "bool" ? "key bar" : `key line-${number}`;
		return {signal, figure, range, node: el("li", {},
			el("span", {class: kind, "aria-hidden": "true"}),
			el("span", {class: "what"}, el("b", {class: "name"}, signal.name), range), figure,
			button("\u00d7", () => this.act.remove(signal.name), {class: "plain",
				"aria-label": `Remove ${signal.name}`}))};
	}

	/** Show what these pasts have at the time; null: now. at: that time in words. */
	figures(pasts, window, time, at) {
		this.rows.forEach(({signal, figure, range}, n) => {
			const past = pasts[n], k = heldAt(past, time), code = k < 0 ? UNKNOWN : past.code[k];
			const value = k < 0 ? null : past.last[k];
			figure.classList.toggle("words", value === null);
			const unit = value === null || !signal.unit ? "" : `\u202f${signal.unit}`;
			const text = value === null ? qualityWords(code) : valueText(signal, value);
			if (figure.textContent !== text + unit)
				figure.replaceChildren(text, el("span", {class: "unit"}, unit));
			const not = value !== null && stateOf(code) !== "good" ? `, ${qualityWords(code)}` : "";
			put(range, this.#rangeWords(signal, past, window) + not);
		});
		put(this.hint, this.rows.length ? `Figures ${at}. Below the name: least and greatest of what `
			+ "is shown." : "Search for a signal to see what it had.");
	}

	#rangeWords(signal, past, window) {
		if (signal.type === "bool") {
			const part = onPart(past, window);
			return part === null ? "nothing known" : `on ${Math.round(part * 100)} % of it`;
		}
		const both = extremes(past, window);
		return both ? both.map((value) => valueText(signal, value)).join(" \u2013 ")
			: "nothing known";
	}

	// --- The search -------------------------------------------------------------------------

	#close() {
		this.matches.hidden = true;
	}

	#search() {
		const {count, signals} = found(this.texts, this.field.value);
		this.matches.replaceChildren(...signals.map(({name, unit, description}) => el("li", {},
			el("button", {type: "button", "aria-pressed": String(this.act.has(name)),
				onclick: () => this.#choose(name, this.act.has(name))},
			el("b", {}, name), el("span", {class: "unit"}, unit ?? ""),
			el("span", {class: "description"}, description ?? "")))),
		...count > signals.length ? [el("li", {class: "hint"}, `and ${count - signals.length} more`)]
			: [], ...count ? [] : [el("li", {class: "hint"}, "No signal matches.")]);
		this.matches.hidden = false;
	}

	#choose(name, picked) {
		this.act[picked ? "remove" : "add"](name);
		this.field.value = "";
		this.field.focus();
		this.#close();
		announce(`${name} ${picked ? "removed" : "added"}`);
	}

	#key(event) {
		const buttons = [...this.matches.querySelectorAll("button")];
		const n = buttons.indexOf(document.activeElement);
		if (event.key === "Escape" && !this.matches.hidden) {
			this.#close();
			this.field.focus();
		} else if (event.key === "Enter" && n < 0 && this.field.value) {
			buttons[0]?.click();
		} else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
			if (this.matches.hidden)
				this.#search();
			const next = n + (event.key === "ArrowDown" ? 1 : -1);
			(buttons[Math.min(next, buttons.length - 1)] ?? this.field).focus();
		} else {
			return;
		}
		event.preventDefault();
	}
}
