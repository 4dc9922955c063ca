// SPDX-License-Identifier: MIT
// The grid of the items: a row for each, cells that are edited in place. Arrows move, Enter edits,
// Esc leaves, Space chooses, Ctrl+Z takes back. The order of the rows is that of the file, or sorted.
import {NOW, columns, originals, sorted, stepTo, textOf} from "./cells.js";
import {announce, button, el, put} from "./dom.js";
import {draft} from "./draft.js";
import {controlOf, shownOf, valueOf} from "./form.js";
import {GridRow} from "./gridrow.js";
import {store} from "./store.js";

const PHONE = "(max-width: 37.5rem)"; // there a tap opens the form

export class Grid {
	chosen = new Set(); // names
	shown = []; // the rows that are seen, in their order
	sort = {key: null, down: false};
	also = "LimitH";
	keep = () => true; // is an item shown?
	#rows = [];
	#heads = "";
	#order = [];
	#active = {name: null, n: 0, key: "Name"};
	#editing = null;
	#had = null; // the cell that had the focus before the pointer came

	/** does: {edit(name, values), select(name), open(name), choose(), move(name, by), remove()} */
	constructor(does) {
		this.does = does;
		this.all = el("input", {type: "checkbox", "aria-label": "Choose all that are shown",
			onchange: () => this.#choose(this.shown.map(({item}) => item.name), this.all.checked)});
		this.head = el("div", {role: "row", class: "grid-row grid-head"});
		this.body = el("div", {role: "rowgroup", onclick: (e) => this.#click(e),
			onkeydown: (e) => this.#key(e), onfocusin: (e) => this.#focused(e),
			onpointerdown: () => { this.#had = document.activeElement; }});
		this.fault = el("p", {class: "fault", role: "alert", id: "grid-fault"});
		this.node = el("div", {}, this.fault, el("div", {class: "grid sheet", role: "grid",
			"aria-label": "Items", "aria-multiselectable": "true"},
		el("div", {role: "rowgroup"}, this.head), this.body));
	}

	paint() {
		const {items} = draft.model;
		this.columns = columns(this.also, draft.options("item").some(({key}) => key === "Group"));
		this.#paintHead();
		this.was = originals(items, draft.saved.items);
		this.#follow(items);
		this.wrong = new Map();
		for (const problem of draft.problems)
			this.wrong.set(problem.item, [...this.wrong.get(problem.item) ?? [], problem]);
		while (this.#rows.length < items.length)
			this.#rows.push(new GridRow(this.columns, (row) =>
				this.#choose([row.item.name], row.box.checked)));
		items.forEach((item, n) => this.#paintRow(this.#rows[n], item));
		this.arrange();
	}

	/** Filter and place of the focus anew; with anew the order, too. */
	arrange(anew = false) {
		const {key, down} = this.sort, all = this.#rows.slice(0, draft.model.items.length);
		const of = ({item}) => key === NOW ? store.value(store.find(item.name) ?? {}) : textOf(item, key);
		// sorted rows stay where they are while they are edited
		const order = !key ? all : !anew && this.#order.length === all.length ? this.#order
			: sorted(all, of, down);
		const inside = this.body.contains(document.activeElement) && !this.#editing;
		if (order.length !== this.#order.length || order.some((row, n) => row !== this.#order[n]))
			this.body.replaceChildren(...order.map(({node}) => node));
		this.#order = order;
		for (const row of all)
			row.node.hidden = !this.keep(row.item, row);
		this.shown = order.filter(({node}) => !node.hidden);
		this.all.checked = this.chosen.size > 0
			&& this.shown.every(({item}) => this.chosen.has(item.name));
		this.mark(this.current);
		this.#stop();
		if (inside && !this.body.contains(document.activeElement))
			this.#cell().focus();
	}

	/** Put the focus into the row of that name, or the first. */
	focus(name) {
		this.#active = {...this.#active, name};
		this.#stop();
		this.#cell()?.focus();
	}

	/** The row of that name is the one of the form. */
	mark(name) {
		this.current = name;
		for (const {node, item} of this.shown)
			node.classList.toggle("is-current", item.name === name);
	}

	/** Whether the rows are in the order of the file. */
	get plain() { return this.sort.key === null; }

	/* An item that has another name now is the same row. */
	#follow(items) {
		const {n, name} = this.#active, has = new Set(items.map((item) => item.name));
		if (name !== null && !has.has(name) && items[n] && items.length === this.count) {
			if (this.chosen.delete(name))
				this.chosen.add(items[n].name);
			this.#active.name = items[n].name;
			if (this.#editing?.name === name)
				this.#editing.name = items[n].name;
		}
		this.count = items.length;
		this.chosen = new Set([...this.chosen].filter((one) => has.has(one)));
		this.#active.n = Math.max(0, items.findIndex((item) => item.name === this.#active.name));
	}

	// --- The head ---------------------------------------------------------------------------

	#paintHead() {
		const now = this.columns.map(({key}) => key).join();
		if (now !== this.#heads) {
			this.#heads = now;
			this.#rows = [];
			this.#order = [];
			this.heads = this.columns.map(({key, title}) => el("div", {role: "columnheader",
				class: `c-${key}`, "data-key": key}, button(title, () => this.#sortBy(key))));
			this.head.replaceChildren(el("div", {role: "columnheader", class: "c-choose"}, this.all),
				...this.heads);
		}
		for (const head of this.heads)
			head.setAttribute("aria-sort", head.dataset.key !== this.sort.key ? "none"
				: this.sort.down ? "descending" : "ascending");
	}

	/* Up, down, and as the file has it. */
	#sortBy(key) {
		const {key: was, down} = this.sort;
		this.sort = was !== key ? {key, down: false} : down ? {key: null, down: false}
			: {key, down: true};
		this.#paintHead();
		this.arrange(true);
		announce(this.plain ? "In the order of the file." : `By ${key}, `
			+ `${this.sort.down ? "descending" : "ascending"}.`);
	}

	// --- Rows -------------------------------------------------------------------------------

	#paintRow(row, item) {
		row.paint(item, {was: this.was.get(item.name), chosen: this.chosen.has(item.name),
			problems: item.name ? this.wrong.get(item.name) ?? [] : [{text: "It has no name."}],
			but: this.#editing?.cell});
	}

	/** The values of now. */
	paintValues() {
		for (const row of this.shown)
			row.paintValue();
	}

	#choose(names, yes) {
		for (const name of names)
			this.chosen[yes ? "add" : "delete"](name);
		for (const row of this.shown)
			row.choose(this.chosen.has(row.item.name));
		this.does.choose();
	}

	// --- The focus --------------------------------------------------------------------------

	#rowOf(name) {
		return this.shown.find(({item}) => item.name === name) ?? this.shown[0];
	}

	#cell() {
		const row = this.#rowOf(this.#active.name);
		return row?.cells.find((cell) => cell.dataset.key === this.#active.key) ?? row?.cells[0];
	}

	/* One cell is the stop of the keyboard. */
	#stop() {
		const cell = this.#cell();
		if (cell !== this.stop)
			this.stop?.setAttribute("tabindex", "-1");
		this.stop = cell;
		cell?.setAttribute("tabindex", "0");
	}

	#focused({target}) {
		const cell = target.closest("[data-key]"), row = cell?.closest(".grid-row")?.row;
		if (!row)
			return;
		this.#active = {name: row.item.name, key: cell.dataset.key,
			n: draft.model.items.indexOf(row.item)};
		this.does.select(row.item.name);
		this.#stop();
	}

	#click({target}) {
		const cell = target.closest("[data-key]"), row = cell?.closest(".grid-row").row;
		if (!cell || cell === this.#editing?.cell)
			return;
		if (matchMedia(PHONE).matches)
			this.does.open(row.item.name);
		else if (this.#had === cell)
			this.#edit(row, cell);
	}

	#key(event) {
		const {key, altKey, ctrlKey, metaKey, shiftKey} = event;
		const row = event.target.closest(".grid-row")?.row;
		const cell = event.target.closest("[data-key]"), n = this.shown.indexOf(row);
		const k = row?.cells.indexOf(cell), with_ = ctrlKey || metaKey;
		const editing = cell && cell === this.#editing?.cell ? this.#editing : null;
		if (editing) {
			if (key === "Enter" || key === "Tab")
				this.#commit(true, key === "Tab" ? shiftKey ? -1 : 1 : 0);
			else if (key !== "Escape")
				return;
			else if (!editing.busy)
				this.#leave();
		} else if (with_ && key.toLowerCase() === "z" || with_ && key === "y") {
			this.does.undo(key === "y" || shiftKey ? "redo" : "undo");
		} else if (n < 0) {
			return;
		} else if (altKey && (key === "ArrowUp" || key === "ArrowDown")) {
			this.does.move(row.item.name, key === "ArrowUp" ? -1 : 1);
		} else if (key === "Enter" || key === "F2") {
			this.#edit(row, cell);
		} else if (key === " ") {
			this.#choose([row.item.name], !row.box.checked);
		} else if (key === "Delete") {
			this.does.remove();
		} else {
			const to = !altKey && stepTo(event, n, k, this.shown.length, row.cells.length - 1);
			if (!to)
				return;
			this.shown[to[0]].cells[to[1]].focus();
		}
		event.preventDefault();
		event.stopPropagation();
	}

	// --- Editing in place -------------------------------------------------------------------

	#edit(row, cell) {
		const {key} = cell.dataset, {item} = row;
		const option = draft.options("item").find((one) => one.key === key);
		const twins = draft.model.items.filter(({name}) => name === item.name).length > 1;
		if (!option || !draft.editable || twins)
			return;
		const shown = shownOf(option, item.keys[key] ?? textOf(item, key));
		const control = controlOf(option, {"aria-label": `${key} of ${item.name}`,
			"aria-describedby": "grid-fault", onfocusout: () => this.#commit(false, 0)}, shown);
		this.#editing = {row, name: item.name, cell, key, option, shown, control};
		put(this.fault, "");
		cell.replaceChildren(control);
		control.focus();
		control.select?.();
	}

	/* stay: the focus stays in the grid, so many columns further on. */
	async #commit(stay, by) {
		const editing = this.#editing, {name, key, option, shown, control} = editing ?? {};
		if (!editing || editing.busy)
			return;
		const text = control.value.trim(); // the row may be of another item by now
		editing.busy = true;
		try {
			if (text !== shown && !draft.item(name))
				throw new Error("There is no such item any more");
			if (text !== shown)
				await this.does.edit(name, {[key]: valueOf(option, text)});
			put(this.fault, "");
		} catch (error) {
			editing.busy = false;
			control.setAttribute("aria-invalid", "true");
			put(this.fault, `${name}, ${key}: ${error.message}`
				+ `${/[.?]$/.test(error.message) ? "" : "."} The draft does not have it.`);
			if (stay && this.#editing === editing)
				return;
		}
		this.#close(editing, stay, by);
	}

	#leave() {
		put(this.fault, "");
		this.#close(this.#editing, true);
	}

	/* Another cell may be edited meanwhile; that one goes on. */
	#close(editing, stay, by = 0) {
		const {row, cell} = editing, present = this.#editing === editing;
		if (present)
			this.#editing = null;
		cell.shown = null;
		this.#paintRow(row, row.item);
		if (stay && present)
			(row.cells[row.cells.indexOf(cell) + by] ?? cell).focus();
	}
}
