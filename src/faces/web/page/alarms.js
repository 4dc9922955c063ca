// SPDX-License-Identifier: MIT
// The view Alarms: those that stand, to acknowledge or to shelve, and who did what and when.
import {get, post} from "./api.js";
import {ask} from "./command.js";
import {announce, el, later, put, table, wide} from "./dom.js";
import {store} from "./store.js";
import {clock, dateAndClock, msOf, span, valueText, withUnit} from "./words.js";

const DAY_MS = 86400000, ENTRIES = 300;
const SPANS = [[900, "15 minutes"], [3600, "1 hour"], [28800, "8 hours"], [86400, "1 day"],
	[604800, "7 days"]];
const KINDS = [["all", "all"], ["alarms", "alarms"], ["commands", "commands"]];

let shown = false, standing, past, fault, kind, entries = [];

export function build(root) {
	standing = wide("Standing alarms");
	past = wide("Who did what");
	fault = el("p", {class: "fault", role: "alert"});
	kind = el("select", {id: "kind", onchange: drawPast},
		...KINDS.map(([value, text]) => el("option", {value}, text)));
	root.append(fault, standing, el("div", {class: "tools"},
		el("label", {for: "kind"}, "History of"), kind,
		el("button", {type: "button", onclick: look}, "Look again")), past);
	const soon = later(() => shown && look(), 300);
	store.addEventListener("alarm", soon);
	store.addEventListener("trust", soon);
	setInterval(() => shown && !document.hidden && look(), 10000);
}

export function show() {
	shown = true;
	look();
}

export const hide = () => { shown = false; };

const listOf = (data, key) => Array.isArray(data) ? data : data?.[key] ?? [];

async function look() {
	if (store.unknown) {
		standing.replaceChildren(el("p", {class: "note"},
			"Which alarms stand is unknown now: ", store.unknown));
		return;
	}
	try {
		const [alarms, journal] = await Promise.all([get("alarms"),
			get("journal", {since: Math.round(store.now() - 7 * DAY_MS), n: ENTRIES})]);
		if (store.unknown)
			return; // it was lost meanwhile
		put(fault, "");
		drawStanding(listOf(alarms, "alarms"));
		entries = listOf(journal, "entries").sort((a, b) => msOf(b.time) - msOf(a.time));
		drawPast();
	} catch (error) {
		put(fault, `The alarms cannot be shown: ${error.message}.`);
	}
}

// --- Standing -------------------------------------------------------------------------------

const numberOf = (name, value) => {
	const signal = store.find(name) ?? {};
	return withUnit(signal, valueText(signal, value));
};
const good = (alarm) => alarm.good ?? true;

function drawStanding(alarms) {
	const focused = document.activeElement?.dataset.action;
	const rows = alarms.map((alarm) => {
		const since = msOf(alarm.since);
		const open = !["acknowledged", "shelved"].includes(alarm.state);
		return [
			el("span", {class: "name"}, alarm.name),
			el("span", {class: open ? "alarm open" : "alarm"}, alarm.alarm || "shelved"),
			el("span", {}, alarm.state, shelvedWords(alarm)),
			numberOf(alarm.name, good(alarm) ? alarm.value : null),
			Number.isNaN(since) ? "\u2014"
				: el("span", {}, `${dateAndClock(since)} (${span((store.now() - since) / 1000)})`),
			actions(alarm),
		];
	});
	const scroll = standing.scrollLeft;
	standing.replaceChildren(table("Standing", ["Signal", "Alarm", "State", ["Value", "right"],
		"Since", "Action"], rows, "No alarm stands."));
	standing.scrollLeft = scroll;
	if (focused)
		standing.querySelector(`[data-action="${CSS.escape(focused)}"]`)?.focus();
}

function shelvedWords(alarm) {
	if (!alarm.until)
		return null;
	const until = msOf(alarm.until);
	const far = until - store.now() > DAY_MS ? dateAndClock(until) : clock(until);
	return el("span", {class: "description"}, `until ${far}`,
		alarm.by ? `, by ${controller(alarm.by)}` : null, alarm.why ? `: ${alarm.why}` : null);
}

function actions(alarm) {
	if (alarm.device)
		return el("span", {class: "hint"}, "Ends with its cause");
	const button = (action, text, act) => el("button", {type: "button",
		disabled: !store.info?.writable, "data-action": `${action} ${alarm.name}`,
		"aria-label": `${text} ${alarm.name}`, onclick: act}, text);
	if (alarm.state === "shelved" || alarm.until)
		return button("unshelve", "Unshelve", () => send(alarm.name, "unshelve"));
	return el("span", {class: "buttons"},
		alarm.state === "acknowledged" ? null
			: button("acknowledge", "Acknowledge", () => send(alarm.name, "acknowledge")),
		button("shelve", "Shelve\u2026", () => shelve(alarm)));
}

async function send(name, action, more = {}) {
	try {
		await post("alarm", {name, action, ...more});
		put(fault, "");
		announce(`${name}: ${action} done`);
	} catch (error) {
		put(fault, `Cannot ${action} ${name}: ${error.message}.`);
		return;
	}
	look();
}

async function shelve(alarm) {
	const time = el("select", {id: "shelve-time"},
		...SPANS.map(([value, text]) => el("option", {value}, text)));
	const why = el("input", {id: "shelve-why", type: "text", maxlength: 63, autocomplete: "off"});
	if (await ask(`Shelve the alarm of ${alarm.name}?`, "Shelve", [
		el("p", {}, "It is not raised for that time. Then it is, if its condition is active."),
		el("label", {for: "shelve-time"}, "For"), time,
		el("label", {for: "shelve-why"}, "Why (others see it)"), why]))
		send(alarm.name, "shelve", {seconds: Number(time.value), why: why.value});
}

// --- Who did what ---------------------------------------------------------------------------

function controller(by) {
	if (!by)
		return "";
	if (typeof by === "string")
		return by;
	const program = `${by.program ?? ""}${by.pid ? ` (${by.pid})` : ""}`;
	return [by.person, by.user, program].filter(Boolean).join(", ");
}

function drawPast() {
	const wanted = entries.filter((entry) => kind.value === "all" || entry.journal === kind.value);
	const rows = wanted.map((entry) => [
		dateAndClock(entry.time),
		el("span", {class: "name"}, entry.name ?? ""),
		[entry.alarm, entry.event].filter(Boolean).join(", "),
		numberOf(entry.name, entry.value),
		controller(entry.by) || "owsd",
		[entry.more ? `${entry.more} more before` : "", entry.remark].filter(Boolean).join("; "),
	]);
	past.replaceChildren(table("Who did what, newest first", [["Time", "time"], "Signal", "Event",
		["Value", "right"], "By", "Remark"], rows, "Nothing in the last seven days."));
}
