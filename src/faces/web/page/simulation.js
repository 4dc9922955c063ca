// SPDX-License-Identifier: MIT
// Faults of the simulation, a part of the view Wire: a switch for each output of a simulated target
// that begins and ends a fault, and what one should see of it. Without such an output: nothing.
import {control} from "./command.js";
import {el, mark, put} from "./dom.js";
import {store} from "./store.js";

const PLACE = "/simulator/";

/** What one should see, by the name that the fault has in the file of the simulation. */
const EXPECTED = {
	unplug: ["owsd marks the signals of the device \u201cdevice absent\u201d within some 5 seconds. "
		+ "The others go on.", "owsd finds the device again within some 5 seconds."],
	noise: ["owsd refuses each answer whose checksum is wrong, asks again, and marks the signal "
		+ "\u201cdevice error\u201d within some 5 seconds. No false value is shown.",
	"The signal is good again within some 5 seconds."],
	short: ["owsd marks all signals of the wire \u201cwire short\u201d within some 5 seconds.",
		"owsd tries the wire again by itself: all signals are good again after some 10 seconds."],
};
const OTHER = ["owsd marks the signals that the fault touches bad. No false value is shown.",
	"The signals are good again by themselves."];

let section, cards, switches = [];

/** The part of the view, which follows the signals by itself. */
export function simulation() {
	cards = el("div", {class: "faults"});
	section = el("details", {class: "simulation", hidden: true},
		el("summary", {}, el("h2", {}, "Faults of the simulation")),
		el("p", {class: "hint"}, "These switches disturb the simulated wire. Watch above what owsd "
			+ "makes of it, and that it survives."), cards);
	store.addEventListener("signals", make);
	for (const event of ["values", "trust"])
		store.addEventListener(event, paint);
	make();
	return section;
}

function make() {
	const found = store.signals.filter((signal) =>
		signal.output && signal.type === "bool" && signal.path?.startsWith(PLACE));
	switches = found.map((signal) => new Switch(signal));
	cards.replaceChildren(...switches.map((one) => one.node));
	section.hidden = !found.length;
	paint();
}

function paint() {
	for (const one of switches)
		one.paint();
}

class Switch {
	constructor(signal) {
		this.signal = signal;
		this.control = control(signal);
		this.state = el("strong");
		const [begun, ended] = EXPECTED[signal.path.slice(PLACE.length)] ?? OTHER;
		this.node = el("article", {class: "card", "data-fault": signal.name},
			el("h3", {}, signal.name),
			signal.description ? el("p", {}, signal.description) : null,
			el("p", {}, "State: ", this.state), this.control.node,
			el("p", {}, el("strong", {}, "On: "), begun),
			el("p", {}, el("strong", {}, "Off: "), ended));
	}

	paint() {
		const value = store.value(this.signal);
		const lasts = value !== null && Boolean(Number(value));
		put(this.state, value === null ? "not known" : lasts ? "on, the fault lasts" : "off, no fault");
		mark(this.node, "is-", lasts ? "bad" : "good");
		this.control.paint(value);
	}
}
