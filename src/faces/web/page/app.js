// SPDX-License-Identifier: MIT
// Starts the page: the views, which of them is shown (the address says it), and the state of all.
import {HIDDEN} from "./connection.js";
import {announce, el, later, mark, put} from "./dom.js";
import * as live from "./live.js";
import {store} from "./store.js";
import {way} from "./way.js";
import {alarmOf, clock} from "./words.js";

/** A view whose modules are fetched when it is shown, so that they do not hold up the view Live. */
function fetched(load) {
	let view = null, place = null, wanted = null;
	const fault = el("p", {class: "fault", role: "alert"}, "This view cannot be fetched from "
		+ "owsd-web. Choose it again when the page is connected; if that does not help, load the "
		+ "page anew.");
	return {
		build(root) {
			place = root;
		},
		async show(query) {
			wanted = query;
			let made = view;
			try {
				made ??= await load();
			} catch {
				place.append(fault);
				return;
			}
			fault.remove();
			if (!view) {
				view = made;
				view.build(place);
			}
			if (wanted !== null)
				view.show(wanted);
		},
		hide() {
			wanted = null;
			view?.hide();
		},
	};
}

const LATER = [() => import("./alarms.js"), () => import("./trends.js"), () => import("./wire.js"),
	() => import("./about.js")];
const [alarms, trends, wire, about] = LATER.map(fetched);
const config = fetched(() => import("./config.js"));
const VIEWS = {live, alarms, trends, wire, config, about};
const LATER_MS = 1000; // after the first values: then a lost connection leaves views to look at
const $ = (id) => document.getElementById(id);
const PATIENCE_MS = 1000; // values that are on their way need no words
let present = null, banner = 0;

function show() {
	const [name, query] = location.hash.slice(1).split("?");
	const wanted = VIEWS[name] ? name : "live";
	for (const link of document.querySelectorAll("nav a")) {
		if (link.hash === `#${wanted}`)
			link.setAttribute("aria-current", "page");
		else
			link.removeAttribute("aria-current");
	}
	for (const key of Object.keys(VIEWS))
		$(key).hidden = key !== wanted;
	if (present && present !== wanted)
		VIEWS[present].hide();
	if (present && present !== wanted)
		window.scrollTo(0, 0);
	present = wanted;
	const title = $(wanted).querySelector("h1").textContent;
	document.title = `${title} \u2013 `
		+ `${store.info?.instance ?? "owsd"}`;
	VIEWS[wanted].show(query ?? "");
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
}

function renewed() {
	if (!$("instance").firstElementChild)
		put($("instance"), store.info?.instance ?? "");
	const refused = store.info?.refused;
	$("refused").hidden = !refused;
	put($("refused"), refused ? `owsd has refused its file and goes on with what it loaded before: ${refused}` : "");
	$("read-only").hidden = !store.info || store.info.writable
		|| !store.signals.some((signal) => signal.output);
	show();
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

function count() {
	const open = store.unknown ? 0
		: store.signals.filter((signal) => alarmOf(signal.alarm)?.open).length;
	const badge = $("alarm-count");
	badge.hidden = !open;
	put(badge, open ? String(open) : "");
	badge.setAttribute("aria-label", `${open} not acknowledged`);
}

for (const [key, view] of Object.entries(VIEWS))
	view.build($(key));
store.addEventListener("trust", trust);
store.addEventListener("signals", renewed);
store.addEventListener("signals", choose, {once: true});
store.addEventListener("signals", () => setTimeout(() =>
	LATER.forEach((load) => load().catch(() => {})), LATER_MS), {once: true});
store.addEventListener("signals", count);
store.addEventListener("values", later(count, 200));
store.addEventListener("trust", count);
document.querySelector(".skip").addEventListener("click", (event) => {
	event.preventDefault(); // the part behind # names the view
	$("main").focus();
});
window.addEventListener("hashchange", show);
show();
store.start();
