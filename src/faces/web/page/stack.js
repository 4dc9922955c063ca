// SPDX-License-Identifier: MIT
// Plots above each other, one for each unit, in one window of time: one cursor through all, the
// quality of each signal as a line below them, one axis of time.
import {el, put} from "./dom.js";
import * as paint from "./paint.js";
import {Plot} from "./plot.js";
import {shares, timeTicks} from "./axes.js";
import {store} from "./store.js";
import {moment} from "./when.js";

const LEAST = 320, PHONE = 290, OTHER = 96, BETWEEN = 8, UNIT = 20, LINE = 10;
const FIGURE = 7; // px of a digit
const LEFT = [34, 52], RIGHT = [8, 120]; // of a phone, of more
const STEPS = 200; // of the cursor by the keys, in the window

export class Stack {
	/** act: zoom(from, until), factor(f), back(), point(time), words(time) for a reader. */
	constructor(act) {
		this.act = act;
		this.plots = [];
		this.time = null;
		this.place = el("div", {});
		this.band = el("canvas", {class: "band"});
		this.axis = el("div", {class: "axis"});
		this.hair = el("div", {class: "hair", hidden: true});
		this.at = el("span", {class: "at", hidden: true});
		this.node = el("div", {class: "stack", role: "slider", tabindex: 0, "aria-valuemin": 0,
			"aria-valuemax": 100, "aria-valuenow": 100,
			"aria-label": "Cursor of the trend; the list beside it has the figures",
			onpointermove: (event) => this.#pointed(event),
			onpointerdown: (event) => this.#pointed(event),
			onpointerleave: ({pointerType}) => pointerType === "mouse" && this.act.point(null),
			onkeydown: (event) => this.#key(event)},
		this.place, this.band, this.axis, this.hair, this.at);
		this.node.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
	}

	/** groups: [{signals, numbers}], one for each unit; those that are on or off come last. */
	arrange(groups) {
		for (const plot of this.plots)
			plot.end();
		this.plots = groups.map(({signals, numbers}) => new Plot(signals, numbers, {
			moving: (window) => this.#moving(window), zoom: this.act.zoom, back: this.act.back}));
		this.place.replaceChildren(...this.plots.map(({node}) => node));
	}

	/** Draw the window; of(signal): its past; old(signal): what it is compared with, or null. */
	show(window, of, old, alarms) {
		if (!this.node.clientWidth || !this.plots.length)
			return;
		this.window = window;
		for (const plot of this.plots)
			plot.take(plot.signals.map(of), plot.signals.map(old), window, alarms);
		const phone = matchMedia("(max-width: 37.5rem)").matches;
		for (const plot of this.plots)
			plot.narrow = phone;
		const heights = this.#heights(phone);
		const figures = Math.max(...this.plots.map((plot) => plot.figures));
		const left = Math.max(LEFT[phone ? 0 : 1], figures * FIGURE + 12);
		for (const plot of this.plots)
			plot.show(plot.wanted || heights.shift(), left, RIGHT[phone ? 0 : 1]);
		this.#drawRest();
	}

	#heights(phone) {
		const {plots} = this, curves = plots.filter(({wanted}) => !wanted).length;
		const lanes = plots.reduce((sum, {wanted}) => sum + wanted, 0);
		const signals = plots.reduce((sum, one) => sum + one.signals.length, 0);
		const below = signals * LINE + 44;
		const top = this.node.getBoundingClientRect().top + scrollY;
		const free = phone ? PHONE : Math.max(LEAST, innerHeight - top - below - 32);
		return shares(curves, free - lanes - curves * UNIT - plots.length * BETWEEN, OTHER);
	}

	get #area() {
		const {x, w} = this.plots[0].graph.getArea();
		return [x, x + w];
	}

	#x(time) {
		const [left, right] = this.#area, [from, until] = this.window;
		return left + (time - from) / (until - from) * (right - left);
	}

	#moving(window) {
		this.window = window;
		for (const plot of this.plots)
			if (!plot.busy)
				plot.follow(window);
		this.#drawRest();
	}

	#drawRest() {
		this.#drawBand();
		const [left, right] = this.#area;
		const ticks = timeTicks(...this.window, right - left);
		while (this.axis.children.length < ticks.length)
			this.axis.append(el("span", {}));
		[...this.axis.children].forEach((one, n) => {
			one.hidden = n >= ticks.length;
			if (!one.hidden) {
				put(one, ticks[n].label);
				one.style.left = `${this.#x(ticks[n].v)}px`;
			}
		});
		this.#drawCursor();
	}

	#drawBand() {
		const {band} = this, [left, right] = this.#area, ratio = devicePixelRatio;
		const all = this.plots.flatMap((plot) => plot.pasts.map((past, n) =>
			[past, plot.colour(n)]));
		const width = this.node.clientWidth, height = all.length * LINE;
		band.width = width * ratio;
		band.height = height * ratio;
		band.style.width = `${width}px`;
		band.style.height = `${height}px`;
		const pen = band.getContext("2d");
		pen.scale(ratio, ratio);
		pen.beginPath();
		pen.rect(left, 0, right - left, height);
		pen.clip();
		all.forEach(([past, colour], n) => paint.quality(pen, past, (time) => this.#x(time),
			[left, right], n * LINE + LINE / 2, colour));
	}

	// --- The cursor -------------------------------------------------------------------------

	/** The user points at this time, or at none: null. */
	point(time) {
		this.time = time;
		if (this.plots[0]?.graph && this.window)
			this.#drawCursor();
	}

	#drawCursor() {
		const {time, hair, at, node} = this, [from, until] = this.window;
		const shown = time !== null && time >= from && time <= until;
		for (const plot of this.plots)
			plot.point(shown ? time : null);
		hair.hidden = at.hidden = !shown;
		const where = shown ? time : until;
		node.setAttribute("aria-valuenow", Math.round((where - from) / (until - from) * 100));
		if (!shown)
			return;
		node.setAttribute("aria-valuetext", this.act.words(time));
		put(at, moment(time, store.now(), until - from < 3600000));
		const x = this.#x(time), half = at.offsetWidth / 2;
		hair.style.left = `${x}px`;
		at.style.left = `${Math.max(half, Math.min(node.clientWidth - half, x))}px`;
	}

	#timeAt(clientX) {
		const [left, right] = this.#area, [from, until] = this.window;
		const part = (clientX - this.node.getBoundingClientRect().left - left) / (right - left);
		return from + Math.max(0, Math.min(1, part)) * (until - from);
	}

	#pointed({clientX}) {
		if (this.window)
			this.act.point(this.#timeAt(clientX));
	}

	/* The wheel zooms, and moves sideways; where the page scrolls, it does so without Ctrl. */
	#wheel(event) {
		const {deltaX, deltaY, ctrlKey, shiftKey} = event, {document: page} = globalThis;
		const sideways = shiftKey || Math.abs(deltaX) > Math.abs(deltaY);
		if (!this.window || !sideways && !ctrlKey
			&& page.documentElement.scrollHeight > innerHeight + 1)
			return;
		event.preventDefault();
		const [from, until] = this.window, delta = sideways && deltaX || deltaY;
		if (sideways) {
			const by = delta / this.node.clientWidth * (until - from);
			this.act.zoom(from + by, until + by);
			return;
		}
		const fixed = this.#timeAt(event.clientX), by = 1.1 ** Math.sign(delta);
		this.act.zoom(fixed - (fixed - from) * by, fixed + (until - fixed) * by);
	}

	#key(event) {
		const {key, shiftKey, ctrlKey, altKey, metaKey} = event, {act, window} = this;
		if (ctrlKey || altKey || metaKey || !window)
			return;
		const [from, until] = window, by = (until - from) / STEPS * (shiftKey ? 10 : 1);
		const step = (n) => act.point(Math.max(from, Math.min(until, (this.time ?? until) + n * by)));
		const page = (n) => act.zoom(from + n * (until - from) / 2, until + n * (until - from) / 2);
		const does = {ArrowLeft: () => step(-1), ArrowRight: () => step(1),
			Home: () => act.point(from), End: () => act.point(until), Escape: () => act.point(null),
			PageUp: () => page(-1), PageDown: () => page(1), "+": () => act.factor(0.5),
			"-": () => act.factor(2), 0: act.back}[key];
		if (!does)
			return;
		event.preventDefault();
		does();
	}
}
