// SPDX-License-Identifier: MIT
// The card of an alarm that stands: value, limit, since when, its last hour, what one can do.
import {badge, paintBadge} from "./badge.js";
import {action, el, put, svg} from "./dom.js";
import {actorOf, curveOf, isLost, limitOf, overWords} from "./happened.js";
import {continued, emptyPast, pastOf} from "./series.js";
import {store} from "./store.js";
import {moment} from "./when.js";
import {alarmOf, msOf, qualityWords, span, valueText} from "./words.js";

const WIDTH = 180, HEIGHT = 44, HOUR_MS = 3600000, POINTS = 90;
const AGAIN_MS = 60000; // until the past is fetched anew

/** Which card an alarm has: a device alarm that stands, and whose reset is refused, has two. */
export const keyOf = ({name, alarm, device, state}) => `${name} ${alarm} ${device ? state : ""}`;

export class AlarmCard {
	#alarm = null;
	#acts;
	#past = null;
	#asked = -Infinity;

	/** acts: send(name, action), shelve(alarm) */
	constructor(acts) {
		this.#acts = acts;
		this.badge = badge();
		this.name = el("b", {class: "name"});
		this.description = el("span", {class: "description"});
		this.number = el("span", {class: "figure"});
		this.unit = el("span", {class: "unit"});
		this.over = el("span");
		this.since = el("span", {class: "description"});
		this.buttons = el("span", {class: "buttons"});
		this.curve = svg("svg", {class: "curve", viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
			preserveAspectRatio: "none", "aria-hidden": "true"},
		svg("path", {class: "limit"}), svg("path"));
		this.node = el("li", {class: "sheet"},
			el("span", {class: "who"}, this.badge, " ", this.name, this.description),
			el("span", {class: "now"}, this.number, this.unit),
			el("span", {class: "why"}, this.over, this.since), this.curve, this.buttons);
	}

	take(alarm, open) {
		const {name, alarm: kind, state} = alarm;
		const changed = this.#alarm?.state !== state || this.#alarm?.until !== alarm.until;
		this.#alarm = alarm;
		const shape = alarmOf(`${open ? "! " : ""}${kind === "none" ? "shelved" : kind || "shelved"}`);
		paintBadge(this.badge, shape);
		put(this.name, name);
		this.node.className = `sheet ${!open ? "" : isLost(kind) ? "edge-bad"
			: shape.very ? "edge-alarm-2" : "edge-alarm"}`;
		if (changed || this.writable !== store.info?.writable)
			this.buttons.replaceChildren(...this.#buttons(open));
		this.writable = store.info?.writable;
		this.paint();
		this.#draw();
	}

	#buttons(open) {
		const {name, device, alarm: kind, state, until} = this.#alarm;
		if (device || kind === "not as commanded")
			return [el("span", {class: "hint"}, "Ends with its cause")];
		const button = (what, text, act, look) => action(text, act, `${what} ${name}`, {class: look,
			disabled: !store.info?.writable, "aria-label": `${text} ${name}`});
		if (state === "shelved" || until)
			return [button("unshelve", "Unshelve", () => this.#acts.send(name, "unshelve"))];
		return [button("shelve", "Shelve\u2026", () => this.#acts.shelve(this.#alarm)),
			...open ? [button("acknowledge", "Acknowledge",
				() => this.#acts.send(name, "acknowledge"), "primary")] : []];
	}

	/** What changes with the value and the time. */
	paint() {
		const {name, alarm: kind} = this.#alarm;
		const signal = store.find(name) ?? {}, value = signal.name ? store.value(signal) : null;
		put(this.description, signal.description ?? "");
		put(this.number, value === null ? store.unknown ? "unknown"
			: signal.text ?? qualityWords(signal.code) : valueText(signal, value));
		this.number.classList.toggle("words", value === null);
		put(this.unit, value === null ? "" : signal.unit ?? "");
		put(this.over, overWords(signal, kind, value) || this.#stateWords());
		put(this.since, this.#sinceWords());
	}

	#stateWords() {
		const {device, state, alarm} = this.#alarm;
		return device || state.startsWith("returned") ? state : isLost(alarm) ? "No value to trust" : "";
	}

	#sinceWords() {
		const {since, until, by, why, state} = this.#alarm, now = store.now();
		const begun = msOf(since);
		return [Number.isNaN(begun) ? "" : `since ${moment(begun, now)}, ${span((now - begun) / 1000)}`,
			until ? `shelved until ${moment(until, now)}${by ? ` by ${actorOf(by)}` : ""}` : "", why,
			state === "acknowledged" ? "acknowledged" : "",
			state.startsWith("returned") ? "returned" : ""].filter(Boolean).join(" \u00b7 ");
	}

	async #draw() {
		const {name, alarm: kind} = this.#alarm, signal = store.find(name);
		if (!signal || signal.type === "string")
			return;
		const until = store.now(), from = until - HOUR_MS;
		if (until - this.#asked > AGAIN_MS) {
			this.#asked = until;
			try {
				this.#past = await pastOf(signal, from, until, POINTS);
			} catch {
				this.#past ??= emptyPast(name);
			}
		}
		if (!this.#past)
			return;
		const {path, limit} = curveOf(continued(this.#past, signal, from, until), from, until,
			limitOf(signal, kind), WIDTH, HEIGHT);
		this.curve.firstChild.setAttribute("d", limit === null ? "" : `M0 ${limit}H${WIDTH}`);
		this.curve.lastChild.setAttribute("d", path);
	}
}
