// SPDX-License-Identifier: MIT
// Tells of an alarm by a notification or a sound, if the user says so: while the page is open, in
// this browser alone. A page that is hidden has no stream of events; it asks now and then.
import {get} from "./api.js";
import {button, el, later, put} from "./dom.js";
import {waiting} from "./head.js";
import {store} from "./store.js";

const HIDDEN_MS = 20000;
const KEY = {browser: "owsd.tell.browser", sound: "owsd.tell.sound"};
const WORDS = {
	browser: "This browser shows a message when an alarm is raised, while this page is open in a tab.",
	sound: "A sound is played when an alarm is raised, while this page is open in a tab. After the "
		+ "page is loaded anew the browser wants one click on it before.",
	insecure: "The browser shows messages only of a page at https or at localhost. Open the page "
		+ "behind a proxy with TLS.",
	denied: "This browser was told to show no messages of this page: allow them in its settings.",
};

let known = null, sound = null, hint;
const chips = {};
const isOn = (kind) => localStorage.getItem(KEY[kind]) === "1";

const keyOf = ({name, text}) => `${name} ${text}`;

/** What waits now and did not before (keys; null: nothing is known). A return is no news. */
export const fresh = (before, now) => before === null ? [] : now.filter(({name, text}) =>
	![text, text.replace(/, returned$/, "")].some((one) => before.has(keyOf({name, text: one}))));

/** What waits, of api/alarms: in the words that signals have. */
export const waitingOf = (alarms) => waiting([...new Map(alarms.map(({name, words}) =>
	[name, {name, alarm: words}])).values()]);

async function show(name, text) {
	const options = {body: text, tag: `owsd ${name}`, icon: "icon-waits.svg"};
	try {
		const worker = await navigator.serviceWorker?.getRegistration();
		if (worker)
			await worker.showNotification(name, options);
		else
			new Notification(name, options);
	} catch {
		// the browser does not want to: the title and the icon say it
	}
}

function beep() {
	sound ??= new AudioContext();
	sound.resume();
	for (const [n, hertz] of [880, 660].entries()) {
		const tone = new OscillatorNode(sound, {frequency: hertz});
		const loud = new GainNode(sound, {gain: 0.2});
		tone.connect(loud).connect(sound.destination);
		tone.start(sound.currentTime + n * 0.25);
		tone.stop(sound.currentTime + n * 0.25 + 0.2);
	}
}

function judge(open) {
	const news = fresh(known, open);
	known = new Set(open.map(keyOf));
	if (!news.length)
		return;
	if (isOn("browser") && globalThis.Notification?.permission === "granted")
		for (const {name, text} of news)
			show(name, text);
	if (isOn("sound"))
		beep();
}

async function askHidden() {
	if (!document.hidden || !(isOn("browser") || isOn("sound")))
		return;
	try {
		const {alarms} = await get("alarms");
		judge(waitingOf(alarms));
	} catch {
		// the next time
	}
}

/** Begin to watch, when the first signals are there. */
export function begin() {
	const look = () => store.unknown || judge(waiting(store.signals));
	look();
	store.addEventListener("signals", look);
	store.addEventListener("values", later(look, 500));
	setInterval(askHidden, HIDDEN_MS);
}

async function toggle(kind) {
	let words = WORDS[kind], on = !isOn(kind);
	if (kind === "browser" && on) {
		if (!globalThis.isSecureContext || !globalThis.Notification)
			[words, on] = [WORDS.insecure, false];
		else if (await Notification.requestPermission() !== "granted")
			[words, on] = [WORDS.denied, false];
	} else if (on) {
		beep();
	}
	localStorage.setItem(KEY[kind], on ? "1" : "0");
	put(hint, on || words !== WORDS[kind] ? words : "");
	paint();
}

function paint() {
	for (const [kind, chip] of Object.entries(chips))
		chip.setAttribute("aria-pressed", String(isOn(kind)));
}

/** The choice, for the view Alarms. */
export function build() {
	hint = el("p", {class: "hint", role: "status"});
	for (const [kind, text] of [["browser", "This browser"], ["sound", "Sound"]])
		chips[kind] = button(text, () => toggle(kind), {class: "chip"});
	paint();
	return el("div", {class: "tell"}, el("span", {class: "hint"}, "Tell me:"), chips.browser,
		chips.sound, hint);
}
