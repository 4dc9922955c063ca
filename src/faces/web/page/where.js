// SPDX-License-Identifier: MIT
// Where all signals of one unit are: how many in each part of the scale, and the greatest, the least
// and the one in the middle.
import {button, el, put, svg} from "./dom.js";
import {buckets, marksOf, middleOf, partOf, placeIn} from "./scale.js";
import {valueText} from "./words.js";

const COLUMNS = 60, WIDTH = 900, HEIGHT = 110, GAP = 3, BLOCK = 8;
const ENOUGH = 12; // signals for which it is worth a picture

const texts = new WeakMap(); // of limits, which are another object when they are others

function textOf(limits) {
	if (!texts.has(limits))
		texts.set(limits, JSON.stringify(limits));
	return texts.get(limits);
}

/** The limits that most of the rows have: {l, h, ...}. */
export function limitsOf(rows) {
	const counts = new Map();
	for (const {signal: {limits}} of rows) {
		const key = limits ? textOf(limits) : "{}";
		counts.set(key, (counts.get(key) ?? 0) + 1);
	}
	const [most] = [...counts].sort(([, a], [, b]) => b - a);
	return most && most[1] * 2 > rows.length ? JSON.parse(most[0]) : {};
}

/* Blocks one upon the other while there is room for them, else bars. */
function columnPath(column, count, most) {
	const x = column * WIDTH / COLUMNS + GAP / 2, w = WIDTH / COLUMNS - GAP;
	const height = Math.min(BLOCK, HEIGHT / most);
	if (height < 4)
		return `M${x} ${HEIGHT}v${-(count / most * HEIGHT).toFixed(1)}h${w}V${HEIGHT}z`;
	let path = "";
	for (let n = 0; n < count; n++)
		path += `M${x} ${HEIGHT - n * height}v${1.5 - height}h${w}v${height - 1.5}z`;
	return path;
}

export class Where {
	#paths;
	#key = "";

	/** choose(from, to): a column was clicked; open(name): show that signal; blind(): those without. */
	constructor({choose, open, blind}) {
		this.title = el("p", {class: "aside"});
		this.#paths = ["", "warned", "very"].map((name) => svg("path", {class: name}));
		this.extra = svg("g");
		this.plot = svg("svg", {viewBox: `0 -22 ${WIDTH} ${HEIGHT + 40}`, role: "img",
			preserveAspectRatio: "none"}, ...this.#paths, this.extra);
		this.marks = el("div", {class: "marks", "aria-hidden": "true"});
		this.facts = el("dl", {class: "extremes"});
		this.open = open;
		this.blind = blind;
		this.node = el("section", {class: "where sheet", "aria-label": "Where all are", hidden: true},
			el("div", {class: "histogram"}, this.title, this.plot, this.marks), this.facts);
		this.plot.addEventListener("click", ({clientX}) => {
			const {left, width} = this.plot.getBoundingClientRect(), {from, to} = this.scale;
			const n = Math.floor((clientX - left) / width * COLUMNS), step = (to - from) / COLUMNS;
			choose(from + n * step, from + (n + 1) * step);
		});
	}

	/** rows: of one unit; scale: theirs; null: several units. */
	paint(rows, unit, scale) {
		const known = rows.filter(({value}) => value !== null);
		this.node.hidden = !scale || known.length < ENOUGH;
		if (this.node.hidden)
			return;
		const values = known.map(({value}) => Number(value)), limits = limitsOf(rows);
		const counts = buckets(values, scale, COLUMNS), most = Math.max(...counts);
		const blind = rows.length - known.length;
		const [least, greatest] = [Math.min, Math.max].map((of) => values.reduce((a, b) => of(a, b)));
		const key = JSON.stringify([counts, scale, limits, unit, blind, least, greatest]);
		if (key === this.#key)
			return;
		this.#key = key;
		this.scale = scale;
		put(this.title, `Where all ${known.length} are, ${unit}`);
		const kindOf = (v) => v > (limits.hh ?? Infinity) || v < (limits.ll ?? -Infinity) ? 2
			: v > (limits.h ?? Infinity) || v < (limits.l ?? -Infinity) ? 1 : 0;
		const paths = ["", "", ""], kinds = new Array(COLUMNS).fill(0);
		for (const value of values) {
			const n = placeIn(scale, value, COLUMNS);
			kinds[n] = Math.max(kinds[n], kindOf(value));
		}
		counts.forEach((count, n) => { paths[kinds[n]] += columnPath(n, count, most); });
		this.#paths.forEach((path, n) => path.setAttribute("d", paths[n]));
		this.#paintAxis(scale, limits, known[0].signal);
		this.#paintFacts(known, values, least, greatest, blind);
	}

	#paintAxis(scale, limits, signal) {
		const at = (v) => partOf(scale, v) * WIDTH, text = (v) => valueText(signal, v);
		const inside = ["l", "h"].map((key) => limits[key]).filter((v) =>
			Number.isFinite(v ?? NaN) && v > scale.from && v < scale.to);
		this.extra.replaceChildren(svg("path", {class: "axis", d: `M0 ${HEIGHT}H${WIDTH}`}),
			...inside.map((v) => svg("path", {class: "limit", d: `M${at(v)} -22V${HEIGHT}`})));
		const put_ = (v, name, words) => {
			const node = el("span", {class: name}, words);
			node.style.left = `${100 * partOf(scale, v)}%`;
			return node;
		};
		this.marks.replaceChildren(...marksOf(scale).map((v) => put_(v, "", String(v))),
			...inside.map((v) => put_(v, "limit", `limit ${text(v)}`)));
	}

	#paintFacts(known, values, least, greatest, blind) {
		const at = (value) => known[values.indexOf(value)];
		const warm = known[0].signal.unit === "\u00b0C";
		const figure = (row, value, unit) => el("dd", {class: "figure"},
			el("span", {class: "number"}, row ? valueText(row.signal, value) : String(value)), " ",
			unit ? el("span", {class: "unit"}, unit) : null);
		const link = (text, act) => button(text, act, {class: "link"});
		const one = (title, value) => {
			const {signal} = at(value);
			return [title, link(signal.name, () => this.open(signal.name)),
				figure(at(value), value, signal.unit)];
		};
		const all = [one(warm ? "Hottest" : "Greatest", greatest),
			one(warm ? "Coldest" : "Least", least),
			["Middle", `of ${known.length}`, figure(known[0], middleOf(values), known[0].signal.unit)],
			["Without a value", blind ? link("show them", this.blind) : "none",
				figure(null, blind, "")]];
		this.facts.replaceChildren(...all.map(([title, what, node]) => el("div", {},
			el("dt", {}, title), el("dd", {}, what), node)));
	}
}
