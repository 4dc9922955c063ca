// SPDX-License-Identifier: MIT
// What a plot paints on its canvas. pen: its context; x(time), y(value): where that is, px.
import {UNKNOWN, stateOf} from "./words.js";

const DASHES = [[], [7, 4], [2, 3], [], [7, 4], [2, 3]];
const BAR = 14;

export const css = (name) =>
	getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Runs of columns that are alike: calls act(first, end), end being the first that is not. */
export function runs(count, alike, act) {
	for (let k = 0; k < count;) {
		let end = k + 1;
		while (end < count && alike(k, end))
			end++;
		act(k, end);
		k = end;
	}
}

/* Not by the lines of dygraphs: their dashes begin anew at each step. */
export function line(pen, {x: times, last}, x, y, {stroke, number = 0, width = 2}) {
	pen.save();
	pen.strokeStyle = stroke;
	pen.lineWidth = width;
	pen.setLineDash(DASHES[number]);
	pen.beginPath();
	for (let k = 0; k < times.length; k++) {
		const at = x(times[k]), joined = k && last[k - 1] !== null;
		if (joined)
			pen.lineTo(at, y(last[k - 1]));
		if (last[k] !== null)
			pen[joined ? "lineTo" : "moveTo"](at, y(last[k]));
	}
	pen.stroke();
	pen.restore();
}

/** From the least to the greatest value of each column. */
export function spread(pen, {x: times, min, max}, x, y, stroke) {
	pen.save();
	pen.globalAlpha = matchMedia("(prefers-color-scheme: dark)").matches ? 0.2 : 0.14;
	pen.fillStyle = stroke;
	for (let k = 0; k + 1 < times.length; k++)
		if (min[k] !== null && max[k] !== null)
			pen.fillRect(x(times[k]), y(max[k]), x(times[k + 1]) - x(times[k]), y(min[k]) - y(max[k]));
	pen.restore();
}

/** An output or input that is on or off: a bar while it is on, a thin line while it is off. */
export function bars(pen, {x: times, last}, x, middle) {
	pen.fillStyle = css("--edge");
	runs(times.length, (a, b) => last[a] === last[b], (k, end) => {
		const a = x(times[k]), b = x(times[Math.min(end, times.length - 1)]);
		const height = last[k] ? BAR : 1;
		if (last[k] !== null)
			pen.fillRect(a, middle - height / 2, b - a, height);
	});
}

/** A text with a ground of its own; align: "left", "right" or "center" of x. */
export function words(pen, text, x, middle, colour, align) {
	const {fontFamily, fontSize} = getComputedStyle(pen.canvas.parentNode);
	pen.save();
	pen.font = `600 ${fontSize} ${fontFamily}`;
	pen.textAlign = align;
	pen.textBaseline = "middle";
	pen.lineJoin = "round";
	pen.lineWidth = 4;
	pen.strokeStyle = css("--sheet");
	pen.strokeText(text, x, middle);
	pen.fillStyle = css(colour);
	pen.fillText(text, x, middle);
	pen.restore();
}

/** A limit: a dashed line, with its name at the left. */
export function limit(pen, left, right, y, text) {
	dashed(pen, left, right, y, {stroke: css("--warn"), width: 1.25, dash: [6, 3]});
	words(pen, text, left + 6, y - 9, "--warn", "left");
}

/**
 * An alarm: a tint over the height, and a filled strip on top. Where its words belong, from and
 * until which x: {text, x, align, from, until}.
 */
export function alarm(pen, {left, right, bottom}, a, b, text) {
	const from = Math.max(left, a), until = Math.max(from + 2, Math.min(right, b));
	pen.save();
	pen.fillStyle = css("--alarm");
	pen.globalAlpha = 0.16;
	pen.fillRect(from, 0, until - from, bottom);
	pen.globalAlpha = 1;
	pen.fillRect(from, 0, until - from, 5);
	pen.strokeStyle = css("--warn");
	pen.strokeRect(from + 0.5, 0.5, until - from - 1, 4);
	pen.restore();
	const width = text.length * 8, inside = from - left < width;
	return inside ? {text, x: from + 6, align: "left", from, until: from + 6 + width}
		: {text, x: from - 6, align: "right", from: from - 6 - width, until: from};
}

/** A gap: a hatched bar at the height of the curve, with its reason if that has room. */
export function gap(pen, a, b, y, text, known) {
	hatched(pen, a, b, y - BAR / 2, BAR, css(known ? "--bad" : "--edge"));
	if (b - a >= 60)
		words(pen, text, (a + b) / 2, y + BAR + 2, known ? "--bad" : "--ink-2", "center");
}

/** A hatched box: what cannot be seen. */
export function hatched(pen, a, b, top, height, colour) {
	const width = Math.max(1, b - a);
	pen.save();
	pen.beginPath();
	pen.rect(a, top, width, height);
	pen.clip();
	pen.strokeStyle = colour;
	pen.lineWidth = 1.5;
	pen.strokeRect(a, top, width, height);
	for (let at = a - height - (a % 6); at < b; at += 6) {
		pen.beginPath();
		pen.moveTo(at, top + height);
		pen.lineTo(at + height, top);
		pen.stroke();
	}
	pen.restore();
}

function dashed(pen, a, b, y, {stroke, width, dash}) {
	pen.save();
	pen.strokeStyle = stroke;
	pen.lineWidth = width;
	pen.setLineDash(dash);
	pen.beginPath();
	pen.moveTo(a, y);
	pen.lineTo(b, y);
	pen.stroke();
	pen.restore();
}

const dotted = (pen, a, b, middle) => b > a
	&& dashed(pen, a, b, middle, {stroke: css("--ink-2"), width: 1, dash: [1, 4]});

/** Good: a bar in this colour. Not good: hatched. Nothing known: a dotted line. */
export function quality(pen, past, x, [left, right], middle, colour) {
	const {code, gap, x: times} = past;
	let reached = left;
	runs(times.length, (a, b) => code[a] === code[b] && gap[a] === gap[b], (k, end) => {
		const a = x(times[k]), b = x(times[Math.min(end, times.length - 1)]);
		const state = stateOf(gap[k] ? UNKNOWN : code[k]);
		if (k === 0)
			dotted(pen, reached, a, middle);
		if (state === "unknown")
			dotted(pen, a, b, middle);
		else if (state === "good") {
			pen.fillStyle = colour;
			pen.fillRect(a, middle - 2, b - a, 4);
		} else {
			hatched(pen, a, b, middle - 4, 8, css("--bad"));
		}
		reached = b;
	});
	dotted(pen, reached, right, middle);
}
