// SPDX-License-Identifier: MIT
// A signal as a row of the groups or of the list: built when it is shown, then only what changed is
// painted. Its parts are those of a tile, too.
import {badge, paintBadge} from "./badge.js";
import {control} from "./command.js";
import {el, mark, put} from "./dom.js";
import {fillDetail} from "./detail.js";
import {alarmWords, limitOf, lookOf, sinceOf, urgencyOf} from "./look.js";
import {cut, placeOf} from "./order.js";
import {partOf} from "./scale.js";
import {drawSpark, rangeOf, sparkline} from "./spark.js";
import {store} from "./store.js";
import {clock, span, valueText, withUnit} from "./words.js";

const BEYOND = 0x54; // the quality "out of range"

/** What all rows know: the one scale of the list; whether some signals are simulated, not all. */
export const shared = {scale: null, mixed: false};

/** What is beyond Min or Max has no value: these say what was allowed. */
const rangeWords = ({code, min, max, unit}) => code !== BEYOND ? "" : [["Min", min], ["Max", max]]
	.filter(([, limit]) => Number.isFinite(limit ?? NaN))
	.map(([name, limit]) => `${name} ${limit}${unit ? `\u202f${unit}` : ""}`).join(", ");

/** What a row and a tile have in common. */
export class Parts {
	constructor(signal) {
		this.signal = signal;
		this.now = null; // how it looks; null: to be found
	}

	get look() {
		return this.now ??= lookOf(this.signal, store.unknown, this.age);
	}

	get age() {
		return store.age(this.signal);
	}

	get value() {
		return store.value(this.signal);
	}

	get urgency() {
		return urgencyOf(this.look);
	}

	make() {
		const s = this.signal, [head, tail] = cut(s.name);
		this.name = el("button", {type: "button", class: "name", title: tail ? s.name : null},
			el("span", {class: "head"}, head), tail ? el("span", {class: "tail"}, tail) : null);
		this.number = el("span", {class: "number"});
		this.unit = el("span", {class: "unit"}, s.unit || "");
		this.shape = el("span", {class: "shape", "aria-hidden": "true"});
		this.words = el("span", {class: "words"});
		this.alarm = badge();
		this.spark = s.type === "string" ? null : sparkline(s.type === "bool");
		this.range = el("span", {class: "range"});
		this.command = s.output ? control(s) : null;
	}

	paint() {
		const s = this.signal, look = this.now = lookOf(s, store.unknown, this.age);
		const {value} = this;
		put(this.number, store.unknown ? "unknown" : value === null ? "" : valueText(s, value));
		this.unit.hidden = value === null || !s.unit;
		put(this.words, store.unknown ? "" : look.words);
		this.words.title = rangeWords(s);
		put(this.shape, look.shape);
		mark(this.node, "is-", look.state);
		mark(this.node, "edge-", look.edge);
		this.node.classList.toggle("is-late", look.late);
		paintBadge(this.alarm, look.alarm && {...look.alarm, text: alarmWords(look.alarm)});
		this.command?.paint(value);
	}

	paintLine() {
		const now = store.now();
		if (this.spark)
			drawSpark(this.spark, this.signal, now);
		const {text, since} = rangeOf(this.signal, now);
		put(this.range, text);
		this.range.title = text ? `Since ${since}` : "";
	}
}

export class Row extends Parts {
	#node = null;
	#hidden = false;
	#dot = null;

	get built() {
		return this.#node !== null;
	}

	get node() {
		if (!this.#node) {
			this.#build();
			this.#node.hidden = this.#hidden;
			this.paint();
			this.paintLine();
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
		this.make();
		this.name.setAttribute("aria-expanded", "false");
		this.since = el("span", {class: "since"});
		this.scale = el("td", {class: "c-scale", role: "cell"});
		this.aged = el("td", {class: "c-age", role: "cell"});
		this.#node = el("tr", {class: "row", role: "row"},
			el("th", {class: "c-name", role: "rowheader", scope: "row"}, this.name,
				s.description ? el("span", {class: "description"}, s.description) : null),
			el("td", {class: "c-value", role: "cell"}, this.number, this.unit,
				el("span", {class: "quality"}, this.shape, this.words)),
			this.scale,
			el("td", {class: "c-spark", role: "cell"}, this.command?.result, this.spark, this.range),
			el("td", {class: "c-state", role: "cell"}, this.since, this.alarm, this.command?.node),
			this.aged,
			el("td", {class: "c-place", role: "cell"}, placeOf(s)));
		this.#node.row_ = this;
	}

	get open() {
		return Boolean(this.detail && !this.detail.hidden);
	}

	/** star: a button for the details. */
	toggle(star, open = !this.open) {
		if (open && !this.detail) {
			this.detail = el("td", {class: "c-detail", role: "cell"});
			this.node.append(this.detail);
		}
		this.star = star;
		if (this.detail)
			this.detail.hidden = !open;
		this.name.setAttribute("aria-expanded", String(open));
		this.#explain();
	}

	#explain() {
		if (this.open)
			fillDetail(this, this.star);
	}

	/** All but the line. */
	paint() {
		super.paint();
		this.#explain();
		this.paintAge();
		this.#paintScale();
	}

	#paintScale() {
		const {scale} = shared, {value} = this, {limits} = this.signal;
		if (!scale || value === null || this.signal.type === "bool" || Number.isNaN(Number(value))) {
			if (this.#dot)
				this.scale.replaceChildren();
			this.#dot = null;
			return;
		}
		if (!this.#dot) {
			this.#dot = el("i", {class: "dot"});
			this.band = el("i", {class: "band"});
			this.scale.replaceChildren(el("span", {class: "scale", "aria-hidden": "true"}, this.band,
				this.#dot));
		}
		const at = (v) => `${(100 * partOf(scale, v)).toFixed(1)}%`;
		const low = limits?.l ?? scale.from, high = limits?.h ?? scale.to;
		this.band.hidden = limits?.l === null && limits?.h === null || !limits;
		this.band.style.left = at(low);
		this.band.style.right = `${(100 - 100 * partOf(scale, high)).toFixed(1)}%`;
		this.#dot.style.left = at(Number(value));
		this.#dot.className = `dot${value > (limits?.h ?? Infinity) ? " up" : value
			< (limits?.l ?? -Infinity) ? " down" : ""}`;
	}

	paintAge() {
		const {age} = this, s = this.signal;
		const look = this.now = lookOf(s, store.unknown, age);
		put(this.aged, age === null ? "" : span(age));
		this.#node.classList.toggle("is-late", look.late);
		if (!store.unknown)
			put(this.words, look.words);
		const since = look.edge === "bad" && !this.command ? sinceOf(s) : null;
		put(this.since, look.late ? `\u25f7 ${span(age)} old` : since !== null
			? `since ${clock(since).slice(0, 5)}` : shared.mixed && s.simulated ? "sim" : "");
		this.since.classList.toggle("sim", this.since.textContent === "sim");
	}

	matches(words) {
		const s = this.signal, {look} = this;
		const text = `${s.name} ${s.description ?? ""} ${s.path ?? ""} ${s.device ?? ""} `
			+ `${s.family ?? ""} ${s.unit ?? ""} ${s.output ? "output" : "input"} ${s.type} `
			+ `${s.group ?? ""} ${placeOf(s)} ${look.words} ${look.alarm ? `alarm ${s.alarm}` : ""}`;
		return words.every((word) => text.toLowerCase().includes(word));
	}
}

/** "limit 65.0", for a tile in alarm. */
export function limitText({signal, look}) {
	const limit = look.alarm ? limitOf(signal, look.alarm) : null;
	return limit === null ? "" : `limit ${withUnit(signal, valueText(signal, limit))}`;
}
