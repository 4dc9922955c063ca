// SPDX-License-Identifier: MIT
// The filters of the view Live, one of which is chosen, with how many signals each has.
import {el} from "./dom.js";
import {choicesOf} from "./order.js";

export const NO_CHOICE = {only: "", unit: "", group: "", from: null, to: null};

const short = (number) => String(Number(number.toPrecision(4)));

export class Chips {
	#key = "";

	/** choose(choice): somebody wants that. */
	constructor(choose) {
		this.choose = choose;
		this.node = el("div", {class: "chips", role: "group", "aria-label": "Filter"});
	}

	paint(rows, state, listed) {
		const all = choicesOf(rows, listed), {from, to} = state;
		const key = JSON.stringify([all, ...Object.keys(NO_CHOICE).map((name) => state[name])]);
		if (this.#key === key)
			return;
		this.#key = key;
		if (from !== null)
			all.push({words: `${short(from)} to ${short(to)}`, count: "\u00d7", choice: {from, to}});
		const had = [...this.node.children].indexOf(document.activeElement);
		this.node.replaceChildren(...all.map((one) => this.#chip(one, state)));
		this.node.children[Math.min(had, all.length - 1)]?.focus();
	}

	#chip({words, count, choice}, state) {
		const wanted = {...NO_CHOICE, ...choice};
		const on = Object.keys(NO_CHOICE).every((name) => wanted[name] === state[name]);
		const back = on && choice.from !== undefined;
		return el("button", {type: "button", class: "chip", "aria-pressed": String(on),
			onclick: () => this.choose(back ? NO_CHOICE : wanted)}, words, " ",
		el("span", {}, String(count)));
	}
}
