// SPDX-License-Identifier: MIT
// A plot of signals that have one unit: the last value as a line of steps in a band from the least
// to the greatest, gaps as gaps, and below it the quality of each signal as a band. dygraphs has the
// axes and the gestures; without it there are the figures alone.
import {el, later, put, wide} from "./dom.js";
import {extremes, padded} from "./series.js";
import {UNKNOWN, clock, dateAndClock, qualityWords, stateOf, tickText, valueText, withUnit}
	from "./words.js";

const AXIS = 56, BAND = 12, SPACE = 4, SETTLED_MS = 250;
const DASHES = [[], [6, 3], [2, 2], [10, 3, 2, 3], [12, 4], [1, 4]];
const SWITCH = [-0.2, 1.2]; // of the values off and on

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const same = (a, b) => a[0] === b[0] && a[1] === b[1];

export class Plot {
	/**
	 * signals: of one unit; numbers: which line each has, 0 ..; zoom(from, until): the user has
	 * chosen a window; point(time): the user points at it, or null.
	 */
	constructor(signals, numbers, zoom, point) {
		this.signals = signals;
		this.numbers = numbers;
		this.pasts = [];
		this.time = null;
		this.chosen = null; // the least and the greatest value that the user has dragged to
		this.moving = false; // a gesture goes on, or has just ended
		this.settle = later(() => {
			this.moving = false;
			if (this.graph)
				zoom(...this.graph.xAxisRange());
		}, SETTLED_MS);
		this.band = el("canvas", {class: "band", "aria-hidden": "true"});
		this.hair = el("div", {class: "hair", hidden: true});
		this.at = el("th", {scope: "col", class: "right"}, "Last");
		this.cells = signals.map(() => ({value: el("td", {class: "right"}), range: el("td", {
			class: "right"}), quality: el("td", {})}));
		const names = signals.map((signal) => signal.name).join(", ");
		const figures = wide(`Figures of ${names}`);
		figures.append(this.#legend());
		this.node = el("figure", {class: "trend"});
		if (globalThis.Dygraph) {
			this.chart = el("div", {class: "chart",
				onpointermove: ({clientX, currentTarget}) => this.graph && point(
					this.graph.toDataXCoord(clientX - currentTarget.getBoundingClientRect().left)),
				onpointerleave: () => point(null)});
			this.node.append(el("p", {class: "unit"}, signals[0].unit || ""),
				el("div", {class: "plot", role: "img",
					"aria-label": `Trend of ${names}; the table below has figures`},
				this.chart, this.hair), this.band);
		}
		this.node.append(figures);
	}

	#legend() {
		return el("table", {class: "data legend"},
			el("caption", {class: "unseen"}, "Figures of the trend"),
			el("thead", {}, el("tr", {}, el("th", {scope: "col"}, "Signal"), this.at,
				el("th", {scope: "col", class: "right"}, "Least to greatest"),
				el("th", {scope: "col"}, "Quality"))),
			el("tbody", {}, ...this.signals.map((signal, n) => el("tr", {},
				el("th", {scope: "row"}, el("span", {class: `key line-${this.numbers[n]}`,
					"aria-hidden": "true"}), ` ${signal.name}`),
				this.cells[n].value, this.cells[n].range, this.cells[n].quality))));
	}

	#options() {
		const {dateTicker, defaultInteractionModel: gestures} = globalThis.Dygraph;
		const rule = css("--rule");
		const y = this.#switches() ? {ticker: () => [{v: 0, label: "off"}, {v: 1, label: "on"}]} : {};
		return {
			labels: ["time", "all"], highlightCircleSize: 0, gridLineColor: rule,
			axisLineColor: rule, axisLabelFontSize: 12, plotter: (all) => this.#drawAll(all),
			drawCallback: (graph) => this.#drawn(graph),
			axes: {x: {ticker: dateTicker, axisLabelFormatter: (time) => tickText(new Date(time))},
				y: {axisLabelWidth: AXIS, ...y}},
			// Time alone is moved; a drag up or down chooses values, until a double click
			interactionModel: {...gestures, mousedown: (event, graph, context) => {
				gestures.mousedown(event, graph, context);
				context.is2DPan = false;
			}, touchstart: (event, graph, context) => {
				// One finger up or down scrolls the page
				gestures.touchstart({touches: event.touches, preventDefault: () =>
					event.touches.length > 1 && event.preventDefault()}, graph, context);
				context.touchDirections = {x: true, y: false};
			}, dblclick: () => {
				this.chosen = null;
				this.show(this.pasts, this.window);
			}},
		};
	}

	#switches() {
		return this.signals.every((signal) => signal.type === "bool");
	}

	/** Show these pasts, one for each signal, in the window [from, until] (ms). */
	show(pasts, window) {
		this.pasts = pasts;
		this.window = window;
		this.#figures();
		if (!this.chart?.clientWidth || this.moving)
			return;
		this.range = this.chosen ?? (this.#switches() ? SWITCH
			: padded(pasts.map((past) => extremes(past, window)).filter(Boolean)));
		const wanted = {file: window.map((time) => [time, null]), dateWindow: window,
			valueRange: this.range};
		if (!this.graph) {
			const {Dygraph} = globalThis;
			// Its legend sets an attribute style, which the policy of the page refuses
			Dygraph.PLUGINS = Dygraph.PLUGINS.filter((one) => one !== Dygraph.Plugins.Legend);
			this.graph = new Dygraph(this.chart, wanted.file, {...this.#options(), ...wanted});
			return;
		}
		if (this.width !== this.chart.clientWidth)
			this.graph.resize();
		this.graph.updateOptions(wanted);
	}

	/** The user points at this time in one of the plots, or at none: null. */
	point(time) {
		this.time = time;
		this.#figures();
		this.hair.hidden = time === null || !this.graph;
		if (!this.hair.hidden)
			this.hair.style.left = `${this.graph.toDomXCoord(time)}px`;
	}

	end() {
		this.graph?.destroy();
		this.graph = null;
	}

	#figures() {
		const {time, window} = this;
		put(this.at, time === null ? "Last" : window[1] - window[0] > 86400000
			? dateAndClock(time) : clock(time));
		this.signals.forEach((signal, n) => {
			const past = this.pasts[n], cells = this.cells[n];
			let at = past.x.length - 1;
			while (time !== null && at >= 0 && past.x[at] > time)
				at--;
			const code = at < 0 ? UNKNOWN : past.code[at];
			put(cells.value, withUnit(signal, valueText(signal, at < 0 ? null : past.last[at])));
			put(cells.quality, code === UNKNOWN ? "unknown" : qualityWords(code)
				+ (past.gap[at] ? ", with a gap" : ""));
			put(cells.range, extremes(past, window)?.map((value) => valueText(signal, value))
				.join(" to ") ?? "\u2014");
		});
	}

	/* What the graph shows is what was wanted, or a gesture has moved it. */
	#drawn(graph) {
		this.graph ??= graph; // the first time, its constructor has not returned
		this.width = this.chart.clientWidth;
		if (!same(graph.yAxisRange(), this.range))
			this.chosen = graph.yAxisRange();
		if (!same(graph.xAxisRange(), this.window)) {
			this.moving = true;
			this.settle();
		}
		this.#drawBand();
	}

	/* Not by the lines of dygraphs: their dashes begin anew at each step. */
	#drawAll({drawingContext: pen, dygraph: graph}) {
		const y = (value) => graph.toDomYCoord(value);
		this.pasts.forEach(({x: times, min, max, last}, n) => {
			const x = times.map((time) => graph.toDomXCoord(time));
			const stroke = css(`--line-${this.numbers[n]}`);
			pen.save();
			pen.fillStyle = `${stroke}33`;
			for (let k = 0; k + 1 < x.length; k++)
				if (min[k] !== null && max[k] !== null)
					pen.fillRect(x[k], y(max[k]), x[k + 1] - x[k], y(min[k]) - y(max[k]));
			pen.strokeStyle = stroke;
			pen.lineWidth = 1.75;
			pen.setLineDash(DASHES[this.numbers[n]]);
			pen.beginPath();
			for (let k = 0; k < x.length; k++) {
				if (k && last[k - 1] !== null)
					pen.lineTo(x[k], y(last[k - 1]));
				if (last[k] !== null)
					pen[k && last[k - 1] !== null ? "lineTo" : "moveTo"](x[k], y(last[k]));
			}
			pen.stroke();
			pen.restore();
		});
	}

	/* Good: a bar in the colour of the line. Not good: hatched. Nothing known: a dotted line. */
	#drawBand() {
		const {graph, band} = this, {x: left, w: width} = graph.getArea();
		const ratio = devicePixelRatio;
		const height = this.signals.length * (BAND + SPACE) + SPACE;
		band.width = this.width * ratio;
		band.height = height * ratio;
		band.style.width = `${this.width}px`;
		band.style.height = `${height}px`;
		const pen = band.getContext("2d");
		pen.scale(ratio, ratio);
		pen.beginPath();
		pen.rect(left, 0, width, height);
		pen.clip();
		this.pasts.forEach((past, n) => {
			const top = SPACE + n * (BAND + SPACE);
			let reached = left;
			for (let k = 0; k < past.x.length;) {
				let end = k + 1;
				while (end < past.x.length && past.code[end] === past.code[k]
					&& past.gap[end] === past.gap[k])
					end++;
				const a = graph.toDomXCoord(past.x[k]);
				const b = graph.toDomXCoord(past.x[Math.min(end, past.x.length - 1)]);
				if (k === 0)
					dotted(pen, reached, a, top);
				paintPart(pen, past.gap[k] ? UNKNOWN : past.code[k], a, b, top, this.numbers[n]);
				reached = b;
				k = end;
			}
			dotted(pen, reached, left + width, top);
		});
	}
}

function paintPart(pen, code, a, b, top, number) {
	const state = stateOf(code);
	if (state === "unknown") {
		dotted(pen, a, b, top);
		return;
	}
	if (state === "good") {
		pen.fillStyle = css(`--line-${number}`);
		pen.fillRect(a, top + BAND / 2 - 2, b - a, 4);
		return;
	}
	pen.save();
	pen.beginPath();
	pen.rect(a, top, Math.max(1, b - a), BAND);
	pen.clip();
	pen.strokeStyle = pen.fillStyle = css("--bad");
	pen.lineWidth = 1.5;
	pen.strokeRect(a, top, Math.max(1, b - a), BAND);
	for (let x = a - BAND - (a % 6); x < b; x += 6) {
		pen.beginPath();
		pen.moveTo(x, top + BAND);
		pen.lineTo(x + BAND, top);
		pen.stroke();
	}
	pen.restore();
}

function dotted(pen, a, b, top) {
	if (b <= a)
		return;
	pen.save();
	pen.strokeStyle = css("--ink-2");
	pen.setLineDash([1, 4]);
	pen.beginPath();
	pen.moveTo(a, top + BAND / 2);
	pen.lineTo(b, top + BAND / 2);
	pen.stroke();
	pen.restore();
}
