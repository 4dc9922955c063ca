// SPDX-License-Identifier: MIT
// Cards of what is wrong, for the view Wire: what and where, since when, what it means, what to do.
import {el} from "./dom.js";
import {store} from "./store.js";
import {moment} from "./when.js";
import {SHAPES, span} from "./words.js";

const NAMED = 12; // signals of a fault that are named
const CARDS = 12;

function card({title, state, signals, sentences, remedy}) {
	const last = signals.reduce((at, one) => Math.max(at, one.measured ?? 0), 0), now = store.now();
	const more = signals.length - NAMED;
	return el("article", {class: `sheet fault-card edge-${state}`},
		el("h2", {}, el("span", {class: "shape", "aria-hidden": "true"}, SHAPES[state]),
			el("span", {}, title), last ? el("span", {class: "times"},
				`since ${moment(last, now)}, ${span((now - last) / 1000)}`) : null),
		...sentences.filter(Boolean).map((words) => el("p", {}, words)),
		signals.length ? el("p", {class: "names"}, ...signals.slice(0, NAMED).flatMap(({name}, n) =>
			[n ? ", " : "", el("a", {href: `#live?q=${encodeURIComponent(name)}`}, name)]),
		more > 0 ? ` and ${more} more` : "") : null,
		remedy ? el("p", {class: "do"}, el("strong", {}, "Do: "), remedy) : null);
}

export const faultCards = (faults) => [...faults.slice(0, CARDS).map(card),
	...(faults.length > CARDS ? [el("p", {}, `and ${faults.length - CARDS} more`)] : [])];
