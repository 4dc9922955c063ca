// SPDX-License-Identifier: MIT
// The tiles: the signals that somebody wants large. As a wall they are alone.
import {el, put} from "./dom.js";
import {moved} from "./order.js";
import {Parts, limitText} from "./row.js";
import {store} from "./store.js";

const FIRST = 6; // tiles, until somebody chooses

/** The names of the tiles, where nobody has chosen. */
export const firstOf = (signals) => signals.filter(({type, path}) => type !== "string"
	&& !path?.startsWith("/simulator/")).slice(0, FIRST).map(({name}) => name);

class Tile extends Parts {
	constructor(signal, {open, move}) {
		super(signal);
		this.make();
		this.name.addEventListener("click", () => open(signal.name));
		this.limit = el("span", {class: "range limit"});
		this.node = el("li", {class: "tile sheet is-washed", draggable: "true"},
			el("div", {class: "top"}, this.name, this.alarm, this.command?.node),
			el("p", {class: "figure"}, this.number, " ", this.unit,
				el("span", {class: "quality"}, this.shape, this.words)),
			el("p", {class: "foot"}, this.command?.result, this.spark, this.limit, this.range));
		this.node.addEventListener("keydown", (event) => {
			const by = {ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1}[event.key];
			if (!by || !event.altKey)
				return;
			event.preventDefault();
			move(signal.name, by);
		});
		this.node.addEventListener("dragstart", ({dataTransfer}) =>
			dataTransfer.setData("text/plain", signal.name));
		this.node.addEventListener("dragover", (event) => event.preventDefault());
		this.node.addEventListener("drop", (event) => {
			event.preventDefault();
			move(event.dataTransfer.getData("text/plain"), 0, signal.name);
		});
	}

	get length() {
		const text = this.number.textContent;
		return Math.max(text.length - (text.includes(".") ? 0.5 : 0), 3)
			+ (this.signal.unit?.length ?? 0) / 2;
	}

	paint() {
		super.paint();
		put(this.limit, limitText(this));
		this.node.style.setProperty("--n", this.length);
	}
}

export class Tiles {
	#tiles = new Map();
	names = [];

	/** open(name): the details of it; changed(names): somebody has put them in another order. */
	constructor(open, changed) {
		this.node = el("ul", {class: "tiles", "aria-label": "Tiles"});
		this.acts = {open, move: (name, by, before) => {
			if (!this.names.includes(name))
				return;
			const step = before ? this.names.indexOf(before) - this.names.indexOf(name) : by;
			changed(moved(this.names, name, step));
			this.#tiles.get(name).name.focus();
		}};
	}

	set(names) {
		const known = names.map((name) => store.find(name)).filter(Boolean);
		this.names = known.map(({name}) => name);
		const tiles = known.map((signal) => {
			const old = this.#tiles.get(signal.name);
			return old?.signal === signal ? old : new Tile(signal, this.acts);
		});
		this.#tiles = new Map(tiles.map((tile) => [tile.signal.name, tile]));
		const nodes = tiles.map(({node}) => node), had = this.node.children;
		if (nodes.length !== had.length || nodes.some((one, n) => one !== had[n]))
			this.node.replaceChildren(...nodes); // which loses the focus
		this.node.hidden = !tiles.length;
		this.paint();
		this.paintLines();
	}

	paint(signals = null) {
		let most = 0;
		for (const tile of this.#tiles.values()) {
			if (!signals || signals.has(tile.signal))
				tile.paint();
			most = Math.max(most, tile.length);
		}
		this.node.style.setProperty("--most", most || 1);
	}

	paintLines() {
		for (const tile of this.#tiles.values())
			tile.paintLine();
	}
}
