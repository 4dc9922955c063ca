// SPDX-License-Identifier: MIT
// The view Alarms: what waits first, then what was acknowledged or shelved, then what happened.
import {alone} from "./alone.js";
import {failed, get, post} from "./api.js";
import {AlarmCard, keyOf} from "./card.js";
import {ask} from "./command.js";
import {announce, el, later, put} from "./dom.js";
import * as journal from "./journal.js";
import {store} from "./store.js";
import * as tell from "./tell.js";
import {moment} from "./when.js";
import {alarmOf, msOf} from "./words.js";

const SPANS = [[900, "15 minutes"], [3600, "1 hour"], [28800, "8 hours"], [86400, "1 day"],
	[604800, "7 days"]];

let shown = false, title, aside, list, fault, cards = new Map();

export function build(root) {
	title = root.querySelector("h1");
	title.tabIndex = -1;
	aside = el("p", {class: "aside"});
	fault = el("p", {class: "fault", role: "alert"});
	list = el("ul", {class: "standing", "aria-label": "Standing alarms"});
	root.append(el("div", {class: "top"}, title, aside, tell.build()), fault, list);
	journal.build(root);
	const soon = later(() => shown && look(), 300);
	store.addEventListener("alarm", soon);
	store.addEventListener("trust", soon);
	store.addEventListener("values", later(() => shown && paint(), 1000));
	const again = alone(look);
	setInterval(() => shown && !document.hidden && again(), 10000);
}

export function show() {
	shown = true;
	look();
}

export const hide = () => { shown = false; };

const paint = () => cards.forEach((card) => card.paint());
/** 0: waits for somebody; 1: was acknowledged; 2: is shelved, or cannot be armed. */
function rank({name, device, state, until}) {
	if (device)
		return alarmOf(store.find(name)?.alarm)?.open && state === "stands" ? 0 : 2;
	return until || state === "shelved" ? 2 : state === "acknowledged" ? 1 : 0;
}

async function look() {
	if (store.unknown) {
		put(title, "Which alarms stand is unknown now");
		put(aside, store.unknown);
		list.replaceChildren();
		cards.clear();
		return;
	}
	try {
		const [{alarms = []}] = await Promise.all([get("alarms"), journal.look()]);
		if (store.unknown)
			return; // it was lost meanwhile
		put(fault, "");
		draw(alarms.sort((a, b) => rank(a) - rank(b)));
		journal.draw(alarms);
	} catch (error) {
		put(fault, `The alarms cannot be shown: ${error.message}.`);
	}
}

function sentences(alarms) {
	const [open, seen] = [0, 1].map((n) => alarms.filter((one) => rank(one) === n).length);
	const last = journal.last();
	put(title, open ? `${open} alarm${open > 1 ? "s wait" : " waits"} for you`
		: alarms.length ? "No alarm waits for you" : "No alarm stands");
	const shelved = alarms.filter(({until}) => until).map(({until}) => msOf(until));
	put(aside, alarms.length ? [seen ? `${seen} acknowledged` : "",
		shelved.length ? `${shelved.length} shelved until ${moment(Math.min(...shelved), store.now())}`
			: ""].filter(Boolean).join(", ")
		: last ? `The last one was ${last.name}, ${moment(last.time, store.now())}.` : "");
}

function draw(alarms) {
	const focused = document.activeElement;
	const had = list.contains(focused) ? [...cards.values()].findIndex(({node}) =>
		node.contains(focused)) : -1;
	const old = cards;
	cards = new Map();
	for (const alarm of alarms) {
		const key = keyOf(alarm);
		const card = old.get(key) ?? new AlarmCard({send, shelve});
		card.take(alarm, !rank(alarm));
		cards.set(key, card);
	}
	sentences(alarms);
	const nodes = [...cards.values()].map(({node}) => node);
	if (nodes.some((node, n) => list.children[n] !== node) || nodes.length !== list.children.length)
		list.replaceChildren(...nodes);
	if (had < 0 || document.activeElement === focused && list.contains(focused))
		return;
	// what had the focus is gone: the same, the next one, or the head of the part
	const action = focused.dataset.action;
	(list.querySelector(`[data-action="${CSS.escape(action)}"]`)
		?? nodes[Math.min(had, nodes.length - 1)]?.querySelector("button:enabled") ?? title).focus();
}

async function send(name, action, more = {}) {
	try {
		await post("alarm", {name, do: action, ...more});
		put(fault, "");
		announce(`${name}: ${action} done`);
	} catch (error) {
		put(fault, `${action} ${name}: ${failed(error)}.`);
		return;
	}
	look();
}

async function shelve({name}) {
	const time = el("select", {id: "shelve-time"},
		...SPANS.map(([value, text]) => el("option", {value}, text)));
	const why = el("input", {id: "shelve-why", type: "text", maxlength: 63, autocomplete: "off"});
	if (await ask(`Shelve the alarm of ${name}?`, "Shelve", [
		el("p", {}, "It is not raised for that time. Then it is, if its condition is active."),
		el("label", {for: "shelve-time"}, "For"), time,
		el("label", {for: "shelve-why"}, "Why (others see it)"), why]))
		send(name, "shelve", {seconds: Number(time.value), why: why.value});
}
