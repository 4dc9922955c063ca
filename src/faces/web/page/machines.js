// SPDX-License-Identifier: MIT
// The machines above each view, where owsd-web asks the pages of others: this one, then each other
// with its state in a line, as a link. Without others there is nothing here.
import {get} from "./api.js";
import {badge} from "./badge.js";
import {el, later} from "./dom.js";
import {waiting} from "./head.js";
import {lookOf} from "./look.js";
import {store} from "./store.js";
import {redraw} from "./strip.js";
import {moment} from "./when.js";
import {SHAPES, alarmOf, span} from "./words.js";

const EVERY_MS = 10000;
const AGED_S = 15; // an answer that is older has its age beside it

let root = null, list = [], lost = false, at = 0;

/** What api/summary has of an instance, in a line: {edge, shape, alarm, words}. */
export function lineOf({live, signals, needs, first, alarm}) {
	const worst = alarmOf(alarm);
	if (!live)
		return {edge: "bad", shape: SHAPES.bad, alarm: null, words: "owsd is not running there"};
	if (worst && first)
		return {edge: worst.very ? "alarm-2" : "alarm", shape: "", alarm: worst,
			words: needs > 1 ? `${first} and ${needs - 1} more` : first};
	if (needs)
		return {edge: "bad", shape: SHAPES.bad, alarm: null,
			words: `${needs} of ${signals} need${needs === 1 ? "s" : ""} you`};
	return {edge: "none", shape: "", alarm: null, words: !signals ? "no signal yet"
		: signals === 1 ? "the one signal is good" : `all ${signals} good`};
}

/** A machine as api/others has it; now: ms, when that came; unknown: nothing is known any more. */
export function otherLine({answers, since, age, why, summary}, now, unknown) {
	const blind = (edge, words, reason = "") => ({edge, shape: SHAPES[edge] ?? "", alarm: null, words,
		why: reason});
	if (unknown)
		return blind("unknown", "not known");
	if (answers === null)
		return blind("initial", "not asked yet");
	if (!answers)
		return blind("bad", `no answer since ${moment(now - since * 1000, now)}`, why ?? "");
	return {...lineOf(summary), why: age > AGED_S ? `as of ${span(age)} ago` : ""};
}

/** This machine, by what the page itself knows. */
export function ownSummary(signals, unknown) {
	const [worst] = unknown ? [] : waiting(signals);
	return {live: !unknown, signals: signals.length, first: worst?.name ?? null,
		alarm: worst ? `! ${worst.text}` : null,
		needs: signals.filter((one) => lookOf(one, unknown, null).needs).length};
}

function item(name, page, {edge, shape, alarm, words, why}, present) {
	const content = [el("span", {class: "name"}, name), alarm ? badge(alarm) : null,
		el("span", {class: "says"}, shape
			? el("span", {class: "shape", "aria-hidden": "true"}, shape) : null, words),
		why ? el("span", {class: "hint"}, why) : null];
	const look = {class: `machine sheet edge-${edge}`};
	return el("li", {}, page ? el("a", {...look, href: page,
		target: window.parent !== window ? "_blank" : null, rel: "noopener"}, ...content)
		: el("div", {...look, "aria-current": present ? "true" : null}, ...content));
}

function draw() {
	root.hidden = !list.length;
	if (!list.length)
		return;
	const {info, unknown, signals} = store, own = unknown ? {edge: "unknown", shape: SHAPES.unknown,
		alarm: null, words: "not known"} : lineOf(ownSummary(signals, false));
	redraw(root.firstChild, [item(info.instance === "OWS" && info.host ? info.host : info.instance,
		null, own, true), ...list.map((one) => item(one.name, one.page,
		otherLine(one, at, lost || store.unknown)))]);
}

async function ask() {
	if (document.hidden)
		return;
	try {
		list = store.info?.others ? (await get("others")).others : [];
		lost = false;
	} catch {
		lost = true;
	}
	at = store.now();
	draw();
}

export function begin() {
	root = el("section", {id: "machines", "aria-label": "Machines", hidden: true},
		el("ul", {class: "machines"}));
	document.getElementById("banner").after(root);
	document.head.append(el("link", {rel: "stylesheet", href: "machines.css"}));
	const soon = later(draw, 1000);
	store.addEventListener("values", soon);
	store.addEventListener("trust", soon);
	store.addEventListener("signals", ask);
	document.addEventListener("visibilitychange", ask);
	setInterval(ask, EVERY_MS);
	ask();
}
