// SPDX-License-Identifier: MIT
// The head of the page: what waits, in the navigation, the title and the icon; simulated or not;
// whether values are known.
import {HIDDEN} from "./connection.js";
import {announce, el, later, mark, put} from "./dom.js";
import {store} from "./store.js";
import {way} from "./way.js";
import {alarmOf, clock} from "./words.js";

const $ = (id) => document.getElementById(id);
const PATIENCE_MS = 1000; // values that are on their way need no words
let banner = 0;

/** The title of the tab: "(1) boiler_flow high · house", else the view. */
export function titleOf(view, instance, open, unknown) {
	const count = unknown ? "(?) " : open.length ? `(${open.length}) ` : "";
	const [first] = open;
	return `${count}${first && !unknown ? `${first.name} ${first.text}` : view} \u00b7 ${instance}`;
}

/** The alarms that nobody has acknowledged, what is worst first. */
export const waiting = (signals) => signals.flatMap(({name, alarm}) => {
	const one = alarmOf(alarm);
	return one?.open ? [{name, ...one}] : [];
}).sort((a, b) => b.very - a.very);

/** Whether none, some or all of what was read is simulated, in a word. */
export function simulatedWords(signals) {
	const read = signals.filter(({good}) => good);
	const count = read.filter(({simulated}) => simulated).length;
	return !count ? "" : count === read.length ? "Simulated" : "Partly simulated";
}

export function count() {
	const {unknown, signals, info} = store;
	if (unknown === HIDDEN)
		return;
	const open = unknown ? [] : waiting(signals), lost = Boolean(unknown) && signals.length > 0;
	const badge = $("alarm-count");
	badge.hidden = !open.length && !lost;
	put(badge, lost ? "?" : open.length ? String(open.length) : "");
	badge.setAttribute("aria-label", lost ? "unknown how many" : `${open.length} not acknowledged`);
	const view = document.querySelector("nav [aria-current]").hash.slice(1);
	const icon = open.length || lost ? "icon-waits.svg" : "icon.svg";
	if ($("icon").getAttribute("href") !== icon)
		$("icon").setAttribute("href", icon);
	document.title = titleOf(view[0].toUpperCase() + view.slice(1), info?.instance ?? "owsd", open,
		lost);
	const words = simulatedWords(signals);
	$("simulated").hidden = !words;
	put($("simulated"), words);
}

function trust() {
	const why = store.unknown;
	mark($("state"), "is-", why ? "unknown" : "good");
	put($("state-words"), why ? "Values unknown" : "Connected");
	clearTimeout(banner);
	$("banner").hidden = !why || why === HIDDEN;
	if (why === HIDDEN)
		banner = setTimeout(() => { $("banner").hidden = false; }, PATIENCE_MS);
	put($("banner-words"), why ? `${why} All values are unknown since ${clock(store.now())}. `
		+ "The page tries again by itself." : "");
	if (why !== HIDDEN)
		announce(why ? `Values are unknown. ${why}` : "Values are known.");
	count();
}

function renewed() {
	const {info, signals} = store, {refused} = info ?? {};
	if (!$("instance").firstElementChild)
		put($("instance"), info?.instance ?? "");
	$("refused").hidden = !refused;
	put($("refused"), refused
		? `owsd has refused its file and goes on with what it loaded before: ${refused}` : "");
	$("read-only").hidden = !info || info.writable || !signals.some((signal) => signal.output);
	count();
}

/** Where one way leads to several instances, the name of the present one becomes a choice. */
async function choose() {
	const names = await way.instances();
	if (names.length < 2)
		return;
	const present = store.info?.instance;
	$("instance").replaceChildren(el("select", {"aria-label": "Instance",
		onchange: (event) => way.choose(event.target.value)},
	...names.map((name) => el("option", {selected: name === present}, name))));
}

/** On a phone what is behind "More" opens above the bar, until one looks elsewhere. */
function more() {
	const open = (wanted) => $("more").setAttribute("aria-expanded", String(wanted));
	const isOpen = () => $("more").getAttribute("aria-expanded") === "true";
	$("more").addEventListener("click", () => open(!isOpen()));
	document.addEventListener("click", ({target}) => {
		if (!$("more").contains(target))
			open(false);
	});
	document.addEventListener("keydown", ({key}) => {
		if (key !== "Escape" || !isOpen())
			return;
		open(false);
		$("more").focus();
	});
}

export function build() {
	store.addEventListener("trust", trust);
	store.addEventListener("signals", renewed);
	store.addEventListener("signals", choose, {once: true});
	store.addEventListener("values", later(renewed, 200));
	more();
}
