// SPDX-License-Identifier: MIT
// A plot of signals that have one unit: the last value as a line of steps in a band from the least
// to the greatest, gaps as gaps, and names at the end of the curves; or of signals that are on or
// off: a bar each. dygraphs has the axes and the gestures.
import {el, later, put} from "./dom.js";
import {gapsOf, limitsOf, linesOf} from "./marks.js";
import * as paint from "./paint.js";
import {apart, numberTicks, timeTicks} from "./axes.js";
import {extremes, heldAt, padded} from "./series.js";
import {UNKNOWN} from "./words.js";

const SETTLED_MS = 250, LANE = 24, NAME = 16, TAPS_MS = 350;
const LABELS = 3; // lines of them, of alarms that are near each other
const SHAPES = {up: "\u25b2", down: "\u25bc"};
const same = (a, b) => a[0] === b[0] && a[1] === b[1];

export class Plot {
	/**
	 * signals: of one unit; numbers: which line each has, 0 ..; moving(window): a gesture moves it
	 * now; zoom(from, until): the user has chosen a window; back(): wants the one before.
	 */
	constructor(signals, numbers, {moving, zoom, back}) {
		Object.assign(this, {signals, numbers, back, lanes: signals[0].type === "bool"});
		this.pasts = [];
		this.olds = []; // the same of days before, null: none
		this.chosen = null; // the least and the greatest value that the user has dragged to
		this.busy = false; // a gesture goes on, or has just ended
		this.gesture = (window) => {
			this.busy = true;
			this.settle();
			moving(window);
		};
		this.settle = later(() => {
			this.busy = false;
			if (this.graph)
				zoom(...this.graph.xAxisRange());
		}, SETTLED_MS);
		this.chart = el("div", {class: "chart"});
		this.names = signals.map((signal, n) => el("span", {class: `end ink-${this.#ink(n)}`},
			signal.name));
		this.dots = signals.map((_, n) => el("i", {class: `dot ink-${this.#ink(n)}`, hidden: true}));
		this.unit = el("span", {class: "unit"}, this.lanes ? "" : signals[0].unit || "");
		this.node = el("div", {class: this.lanes ? "plot lanes" : "plot"}, this.unit, this.chart,
			...this.names, ...this.dots);
	}

	#ink(n) {
		return this.lanes ? "bar" : this.numbers[n];
	}

	colour(n) {
		return paint.css(this.lanes ? "--edge" : `--line-${this.numbers[n]}`);
	}

	/* On a phone the name of a bar stands above it, else at its end. */
	get #lanePx() {
		return LANE + (this.narrow ? NAME : 0);
	}

	/** The height that lanes need; 0: a plot takes what there is. */
	get wanted() {
		return this.lanes ? this.signals.length * this.#lanePx : 0;
	}

	/** Characters of the widest figure of the axis. */
	get figures() {
		return this.lanes ? 0 : Math.max(0, ...numberTicks(...this.#range(), this.height ?? 200)
			.map(({label}) => label.length));
	}

	#options() {
		const {defaultInteractionModel: gestures} = globalThis.Dygraph;
		const rule = paint.css("--rule");
		let tapped = -Infinity;
		return {
			labels: ["time", "all"], highlightCircleSize: 0, gridLineColor: rule, gridLineWidth: 1,
			axisTickSize: 4, axisLineColor: "transparent", axisLabelFontSize: 12,
			plotter: (all) => this.#draw(all), drawCallback: (graph) => this.#drawn(graph),
			axes: {x: {drawAxis: false, ticker: (from, until, width) => timeTicks(from, until, width)},
				y: {drawGrid: !this.lanes, ticker: (from, until, height) => this.lanes ? []
					: numberTicks(from, until, height)}},
			// Time alone is moved; a drag up or down chooses values, until a double click
			interactionModel: {...gestures, mousedown: (event, graph, context) => {
				gestures.mousedown(event, graph, context);
				context.is2DPan = false;
			}, touchstart: (event, graph, context) => {
				if (event.touches.length < 2)
					return; // one finger has the cursor, or scrolls the page
				gestures.touchstart(event, graph, context);
				context.touchDirections = {x: true, y: false};
			}, touchmove: (event, graph, context) =>
				event.touches.length > 1 && gestures.touchmove(event, graph, context),
			touchend: (event) => {
				if (event.touches.length)
					return;
				if (event.timeStamp - tapped < TAPS_MS)
					this.#reset();
				tapped = event.timeStamp;
			}, dblclick: () => this.#reset()},
		};
	}

	/* To all values, or, where those are shown, to the window of before. */
	#reset() {
		if (!this.chosen)
			this.back();
		this.chosen = null;
		this.graph.updateOptions({valueRange: this.range = this.#range()});
	}

	#range() {
		if (this.lanes || this.chosen)
			return this.chosen ?? [0, this.signals.length];
		const limits = this.#limits().map(({value}) => [value, value]);
		return padded([...limits, ...[...this.pasts, ...this.olds].filter(Boolean).map((past) =>
			extremes(past, this.window)).filter(Boolean)]);
	}

	#limits() {
		const all = this.pasts.map((past) => extremes(past, this.window)).filter(Boolean);
		return this.lanes || !all.length ? [] : this.signals.flatMap((signal) => limitsOf(signal,
			[Math.min(...all.map(([least]) => least)), Math.max(...all.map(([, most]) => most))]));
	}

	take(pasts, olds, window, alarms) {
		this.alarms = alarms;
		this.pasts = pasts;
		this.olds = olds;
		this.window = window;
	}

	/** Draw what was taken, so high, with so much room at the left and at the right (px). */
	show(height, left, right) {
		if (this.busy)
			return;
		this.range = this.#range();
		const wanted = {file: this.window.map((time) => [time, null]), dateWindow: this.window,
			valueRange: this.range, rightGap: right, axes: {y: {axisLabelWidth: left - 8}}};
		if (this.height !== height)
			this.chart.style.height = `${height}px`;
		this.height = height;
		if (this.sides !== `${left} ${right}`)
			this.end(); // dygraphs clears only its area: what was drawn beside it would stay
		this.sides = `${left} ${right}`;
		this.right = right;
		this.unit.style.minWidth = `${left - 4}px`;
		if (!this.graph) {
			const {Dygraph} = globalThis;
			// Its legend sets an attribute style, which the policy of the page refuses
			Dygraph.PLUGINS = Dygraph.PLUGINS.filter((one) => one !== Dygraph.Plugins.Legend);
			const options = this.#options();
			this.graph = new Dygraph(this.chart, wanted.file, {...options, ...wanted,
				axes: {x: options.axes.x, y: {...options.axes.y, ...wanted.axes.y}}});
			return;
		}
		const resized = this.size !== `${this.chart.clientWidth} ${height}`;
		this.graph.updateOptions(wanted, resized);
		if (resized)
			this.graph.resize();
	}

	/** Another plot of the stack is moved by a gesture. */
	follow(window) {
		this.window = window;
		this.graph?.updateOptions({dateWindow: window});
	}

	/** The user points at this time, or at none: null. */
	point(time) {
		this.dots.forEach((dot, n) => {
			const past = this.pasts[n], at = time === null ? -1 : heldAt(past, time);
			dot.hidden = this.lanes || at < 0 || past.last[at] === null || !this.graph;
			if (!dot.hidden) {
				dot.style.left = `${this.graph.toDomXCoord(time)}px`;
				dot.style.top = `${this.#y(past.last[at])}px`;
			}
		});
	}

	#y(value) {
		return this.chart.offsetTop + this.graph.toDomYCoord(value);
	}

	end() {
		this.graph?.destroy();
		this.graph = null;
	}

	/* What the graph shows is what was wanted, or a gesture has moved it. */
	#drawn(graph) {
		this.graph ??= graph; // the first time, its constructor has not returned
		this.size = `${this.chart.clientWidth} ${this.height}`;
		if (!this.lanes && !same(graph.yAxisRange(), this.range))
			this.chosen = graph.yAxisRange();
		if (!same(graph.xAxisRange(), this.window)) {
			this.window = graph.xAxisRange();
			this.gesture(this.window);
		}
		this.#nameEnds(graph.getArea());
	}

	#nameEnds({x, w}) {
		const ends = this.pasts.map((past, n) => this.lanes ? this.#y(this.#lane(n))
			: this.#y(past.last.findLast((value) => value !== null) ?? this.range[1]));
		const above = this.narrow && this.lanes;
		const places = above ? ends.map((y) => y - LANE / 2 - NAME)
			: apart(ends.map((y) => y - NAME / 2), NAME, this.chart.offsetTop + this.height - NAME);
		this.names.forEach((name, n) => {
			name.hidden = this.narrow && !this.lanes;
			name.style.left = `${above ? x : x + w + 8}px`;
			name.style.maxWidth = `${above ? w : this.right - 8}px`;
			name.style.top = `${places[n]}px`;
			put(name, this.signals[n].name);
		});
	}

	#lane(n) {
		return this.signals.length - n - 1 + LANE / 2 / this.#lanePx;
	}

	#draw({drawingContext: pen, dygraph: graph}) {
		const x = (time) => graph.toDomXCoord(time), y = (value) => graph.toDomYCoord(value);
		const {x: left, w, y: top, h} = graph.getArea();
		const area = {left, right: left + w, bottom: top + h};
		const labels = this.alarms.filter(({name}) =>
			this.signals.some((signal) => signal.name === name)).map(({name, kind, turn, from, until}) =>
			paint.alarm(pen, area, x(from), x(until ?? from), `${SHAPES[turn] ?? ""} ${
				this.signals.length > 1 ? `${name} ` : ""}${kind}`));
		linesOf(labels, Math.min(LABELS, Math.floor(h / 2 / NAME))).forEach((line, n) => line >= 0
			&& paint.words(pen, labels[n].text, labels[n].x, 14 + line * NAME, "--warn",
				labels[n].align));
		for (const {value, words} of this.#limits())
			paint.limit(pen, area.left, area.right, y(value), words);
		for (const old of this.lanes ? [] : this.olds.filter(Boolean))
			paint.line(pen, old, x, y, {stroke: paint.css("--edge"), width: 1});
		this.pasts.forEach((past, n) => {
			const stroke = this.colour(n);
			if (this.lanes) {
				paint.bars(pen, past, x, y(this.#lane(n)));
				return;
			}
			paint.spread(pen, past, x, y, stroke);
			paint.line(pen, past, x, y, {stroke, number: this.numbers[n]});
			for (const {from, until, value, code, words} of gapsOf(past))
				paint.gap(pen, Math.max(area.left, x(from)), Math.min(area.right, x(until)), y(value),
					words, code !== UNKNOWN);
		});
	}
}
