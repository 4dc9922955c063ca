// SPDX-License-Identifier: MIT
// The first line of the view Live: how many signals need somebody, and each of them with its reason.
import {badge} from "./badge.js";
import {announce, button, el, put} from "./dom.js";
import {needsOf, sentenceOf} from "./look.js";
import {store} from "./store.js";

const SAY_MS = 10000; // a reader hears of another count so often at most

export class Headline {
	#key = "";
	#said = "";
	#at = -Infinity;

	/** open(name): show that signal; more(): show all that need somebody. */
	constructor(open, more) {
		this.open = open;
		this.more = more;
		this.words = el("span", {});
		this.aside = el("span", {class: "aside"});
		this.needs = el("ul", {class: "needs", "aria-label": "What needs you"});
		this.nodes = [el("p", {class: "sentence", id: "sentence"}, this.words, " ", this.aside),
			this.needs];
	}

	paint(rows) {
		if (!rows.length) {
			put(this.words, store.info ? "owsd has no signal yet" : "Loading signals");
			put(this.aside, "");
			this.needs.hidden = true;
			return;
		}
		const ages = rows.filter(({signal, look}) => !signal.output && look.edge !== "initial"
			&& look.state === "good").map(({age}) => age);
		const [words, aside] = sentenceOf(rows.map(({look}) => look), ages);
		put(this.words, words);
		put(this.aside, aside);
		const needs = store.unknown ? [] : needsOf(rows.filter(({look}) => look.needs));
		const key = JSON.stringify(needs.map((one) => [one.look.edge, one.names, one.more, one.words]));
		if (key !== this.#key && !this.needs.contains(document.activeElement)) {
			this.#key = key;
			this.needs.replaceChildren(...needs.map((one) => this.#item(one)));
		}
		this.needs.hidden = !needs.length;
		this.#say(words);
	}

	#say(words) {
		if (words === this.#said || performance.now() < this.#at + SAY_MS || store.unknown)
			return;
		if (this.#said)
			announce(words);
		this.#said = words;
		this.#at = performance.now();
	}

	#item({look, names, more, words}) {
		const alarm = look.edge.startsWith("alarm") ? look.alarm : null;
		const mark = alarm ? badge({...alarm, text: ""})
			: el("span", {class: "shape", "aria-hidden": "true"}, look.shape);
		const link = (name) => el("a", {href: `#live?${new URLSearchParams({signal: name})}`,
			onclick: (event) => {
				event.preventDefault();
				this.open(name);
			}}, name);
		const all = names.flatMap((name, n) => [n ? ", " : "", link(name)]);
		const rest = more ? [names.length ? " and " : "", button(names.length ? `${more} more`
			: String(more), this.more, {class: "link"})] : [];
		return el("li", {class: `need edge-${look.edge} is-washed`}, mark,
			el("span", {}, el("b", {}, ...all, ...rest), ` ${words}`));
	}
}
