// SPDX-License-Identifier: MIT
// A row of the grid: an item, its cells, what they were in the file, its problems, its value of now.
import {NOW, before, textOf} from "./cells.js";
import {el, put} from "./dom.js";
import {store} from "./store.js";
import {plural, qualityWords, stateOf, valueText, withUnit} from "./words.js";

export class GridRow {
	/** choose(row): its box was ticked, or not any more. */
	constructor(columns, choose) {
		this.box = el("input", {type: "checkbox", tabindex: -1, onchange: () => choose(this)});
		this.mark = el("span", {class: "alarm", hidden: true});
		this.cells = columns.map(({key}) => el("div", {class: `c-${key}`, tabindex: -1,
			role: key === "Name" ? "rowheader" : "gridcell", "data-key": key}));
		this.node = el("div", {role: "row", class: "grid-row"},
			el("div", {role: "gridcell", class: "c-choose"}, this.box), ...this.cells);
		this.node.row = this;
	}

	/** but: a cell that is being edited, and stays as it is. */
	paint(item, {was, chosen, problems, but}) {
		if (this.item?.name !== item.name)
			this.box.setAttribute("aria-label", `Choose ${item.name}`);
		Object.assign(this, {item, was});
		this.text = [item.name, item.path, item.family, item.type, item.io,
			...Object.values(item.keys), problems.length ? "problem" : ""].join(" ").toLowerCase();
		this.choose(chosen);
		this.mark.hidden = !problems.length;
		put(this.mark, `\u00d7 ${plural(problems.length, "problem")}`);
		for (const cell of this.cells)
			if (cell !== but && cell.dataset.key !== NOW)
				this.#paintCell(cell, problems.filter((one) => one.key === cell.dataset.key));
		this.paintValue();
	}

	choose(yes) {
		this.box.checked = yes;
		this.node.setAttribute("aria-selected", String(yes));
	}

	#paintCell(cell, problems) {
		const {key} = cell.dataset, {item} = this;
		const text = textOf(item, key), was = before(this.was, item, key);
		const wrong = problems.some((one) => one.error);
		const title = problems.map((one) => one.text).join(" ") || text;
		const shown = JSON.stringify([text, was, title, wrong]);
		if (cell.shown === shown)
			return;
		cell.shown = shown;
		cell.title = title;
		cell.replaceChildren(...was === null ? [] : [el("span", {class: "was"}, `${was} \u2192 `)],
			el("span", {class: key === "Name" ? "name" : "val"}, text || (key === "Name"
				? "(without a name)" : was === null ? "" : "none")),
			...key === "Name" ? [" ", this.mark] : []);
		cell.classList.toggle("is-changed", was !== null);
		cell.classList.toggle("is-wrong", wrong);
	}

	/** The value of the signal that has this name. */
	paintValue() {
		const cell = this.cells.find(({dataset}) => dataset.key === NOW);
		const fresh = this.was === null, signal = fresh ? null : store.find(this.item.name);
		const value = signal ? store.value(signal) : null;
		put(cell, fresh ? "new" : !signal ? "" : value === null ? qualityWords(store.quality(signal))
			: this.item.keys.Unit === undefined ? withUnit(signal, valueText(signal, value))
				: valueText(signal, value));
		cell.classList.toggle("is-bad", Boolean(signal) && value === null
			&& stateOf(store.quality(signal)) === "bad");
		cell.classList.toggle("is-words", value === null);
	}
}
