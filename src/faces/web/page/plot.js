// SPDX-License-Identifier: MIT
// A plot of signals that have one unit: the last value as a line of steps in a band from the least
// to the greatest, gaps as gaps, and below it the quality of each signal as a band.
import uPlot from "./uplot/uPlot.esm.js";
import {el, put, wide} from "./dom.js";
import {UNKNOWN, clock, dateAndClock, qualityWords, stateOf, valueText, withUnit} from "./words.js";

const HEIGHT = 220, AXIS = 64, BAND = 12, SPACE = 4;
const DASHES = [[], [6, 3], [2, 2], [10, 3, 2, 3], [12, 4], [1, 4]];

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const stepped = uPlot.paths.stepped({align: 1});

export class Plot {
	/** signals: of one unit; zoom(from, until): the user has dragged. */
	constructor(signals, numbers, zoom) {
		this.signals = signals;
		this.zoom = zoom;
		this.numbers = numbers; // which line each signal has, 0 ..
		this.pasts = [];
		this.band = el("canvas", {class: "band", "aria-hidden": "true"});
		this.at = el("th", {scope: "col", class: "right"}, "Last");
		this.cells = signals.map(() => ({value: el("td", {class: "right"}), range: el("td", {
			class: "right"}), quality: el("td", {})}));
		const names = signals.map((signal) => signal.name).join(", ");
		this.plot = el("div", {class: "plot", role: "img",
			"aria-label": `Trend of ${names}; the table below has figures`});
		this.node = el("figure", {class: "trend"}, this.plot, this.band);
		const figures = wide(`Figures of ${names}`);
		figures.append(this.#legend());
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

	#options(width) {
		const ink = css("--ink-2"), grid = css("--rule");
		const axis = {stroke: ink, grid: {stroke: grid, width: 1}, ticks: {stroke: grid, width: 1},
			font: "12px system-ui, sans-serif"};
		const switches = this.signals.every((signal) => signal.type === "bool");
		const dates = ["\n{YYYY}-{MM}-{DD}", null, "\n{MM}-{DD}", null, null, null, 1];
		const series = [{}], bands = [];
		for (const n of this.numbers) {
			const stroke = css(`--line-${n}`);
			const edge = {paths: stepped, stroke: "transparent", points: {show: false}, width: 0};
			bands.push({series: [series.length + 1, series.length], fill: `${stroke}33`});
			series.push({...edge}, {...edge}, {paths: stepped, stroke, width: 1.75, dash: DASHES[n],
				points: {show: false}});
		}
		return {
			width, height: HEIGHT, ms: 1, series, bands, legend: {show: false},
			scales: {x: {time: true, range: () => this.window},
				y: switches ? {range: [-0.2, 1.2]} : {}},
			axes: [{...axis, values: [
				[31536000000, "{YYYY}", null, null, null, null, null, null, 1],
				[86400000, "{YYYY}-{MM}-{DD}", null, null, null, null, null, null, 1],
				[60000, "{HH}:{mm}", ...dates],
				[1, "{HH}:{mm}:{ss}", ...dates],
			]}, {...axis, size: AXIS, label: this.signals[0].unit || " ", labelSize: 18,
				labelFont: axis.font, ...switches ? {splits: () => [0, 1],
					values: () => ["off", "on"]} : {}}],
			cursor: {drag: {x: true, y: false, setScale: false}, points: {show: false},
				sync: {key: "trends"}},
			hooks: {
				setSelect: [(u) => this.#selected(u)],
				setCursor: [(u) => this.#figures(u.cursor.idx)],
				draw: [() => this.#drawBand()],
			},
		};
	}

	#selected(u) {
		const {left, width} = u.select;
		if (width < 4)
			return;
		const from = u.posToVal(left, "x"), until = u.posToVal(left + width, "x");
		u.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
		this.zoom(from, until);
	}

	/** Show these pasts, one for each signal, in the window [from, until] (ms). */
	show(pasts, window) {
		this.pasts = pasts;
		this.window = window;
		const data = uPlot.join(pasts.map((past) => past.x.length
			? [past.x, past.min, past.max, past.last] : [window.slice(), [null, null], [null, null],
				[null, null]]));
		const width = Math.max(240, this.plot.clientWidth);
		if (this.u) {
			if (this.u.width !== width)
				this.u.setSize({width, height: HEIGHT});
			this.u.setData(data);
		} else {
			this.u = new uPlot(this.#options(width), data, this.plot);
		}
		this.#figures(this.u.cursor.idx);
	}

	end() {
		this.u?.destroy();
		this.u = null;
	}

	#figures(index) {
		const time = index === null || index === undefined ? null : this.u.data[0][index];
		put(this.at, time === null ? "Last" : this.window[1] - this.window[0] > 86400000
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
			const inside = (_, k) => past.x[k] >= this.window[0] && past.x[k] <= this.window[1];
			const least = past.min.filter(inside).filter((v) => v !== null);
			const most = past.max.filter(inside).filter((v) => v !== null);
			put(cells.range, least.length ? [Math.min(...least), Math.max(...most)]
				.map((value) => valueText(signal, value)).join(" to ") : "\u2014");
		});
	}

	/* Good: a bar in the colour of the line. Not good: hatched. Nothing known: a dotted line. */
	#drawBand() {
		const {u, band} = this;
		if (!u)
			return;
		const ratio = devicePixelRatio, left = u.bbox.left / ratio, width = u.bbox.width / ratio;
		const height = this.signals.length * (BAND + SPACE) + SPACE;
		band.width = u.width * ratio;
		band.height = height * ratio;
		band.style.width = `${u.width}px`;
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
				const a = left + u.valToPos(past.x[k], "x");
				const b = left + (end < past.x.length ? u.valToPos(past.x[end], "x")
					: u.valToPos(past.x.at(-1), "x"));
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
