// SPDX-License-Identifier: MIT
// The details of a row: what its quality means and what to do, where it is, its limits.
import {el} from "./dom.js";
import {placeOf} from "./order.js";
import {rangeOf} from "./spark.js";
import {store} from "./store.js";
import {meaningOf, remedyOf, span, valueText, withUnit} from "./words.js";

const LIMITS = [["ll", "very low"], ["l", "low"], ["h", "high"], ["hh", "very high"]];
const DAY_MS = 86400000;

export function fillDetail(row, star) {
	const s = row.signal, {detail} = row, code = store.quality(s);
	const fact = (name, text) => text ? el("span", {}, `${name} `, el("b", {}, text)) : null;
	const words = store.unknown ? [el("p", {}, store.unknown)] : row.look.state === "good" ? []
		: [s.why ? el("p", {}, `Reason: ${s.why}`) : null, el("p", {}, meaningOf(code)),
			remedyOf(code) ? el("p", {}, el("strong", {}, "Remedy: "), remedyOf(code)) : null];
	const {text, since} = rangeOf(s, store.now());
	const limits = LIMITS.filter(([key]) => Number.isFinite(s.limits?.[key] ?? NaN))
		.map(([key, name]) => `${name} ${withUnit(s, valueText(s, s.limits[key]))}`).join(", ");
	const key = JSON.stringify([code, s.why, store.unknown, text, row.star.pressed()]);
	if (detail.key_ === key) { // what has the focus stays
		detail.age_.textContent = row.age === null ? "" : `${span(row.age)} old`;
		return;
	}
	const focused = detail.contains(document.activeElement) && document.activeElement.className;
	detail.key_ = key;
	detail.age_ = el("span", {}, row.age === null ? "" : `${span(row.age)} old`);
	detail.replaceChildren(s.description ? el("p", {}, s.description) : "",
		...words.filter(Boolean), el("p", {class: "facts-line"},
		...[fact("Place", placeOf(s)), fact("Modbus", s.modbus && `register ${s.modbus}`),
			fact("Limits", limits),
			text && s.type !== "bool" ? fact(`Since ${since}`, text) : null,
			s.simulated ? el("span", {}, "Simulated") : null,
		detail.age_].filter(Boolean)),
	el("p", {class: "path"}, el("code", {}, s.path ?? "")),
	el("div", {class: "buttons"},
		s.type === "string" ? null : el("a", {class: "chip",
			href: `#trends?${new URLSearchParams({s: s.name, span: DAY_MS})}`}, "Trend"),
		el("button", {type: "button", class: "chip star", "aria-pressed": String(star.pressed()),
			onclick: star.toggle}, `${star.pressed() ? "\u2605" : "\u2606"} Tile`)));
	if (focused)
		[...detail.querySelectorAll("a, button")].find((one) => one.className === focused)?.focus();
}
