// SPDX-License-Identifier: MIT
// Starts the page: the views, and which of them is shown (the address says it).
import {el} from "./dom.js";
import * as head from "./head.js";
import * as live from "./live.js";
import {store} from "./store.js";

/** A view whose modules are fetched when it is shown, so that they do not hold up the view Live. */
function fetched(load) {
	let view = null, place = null, wanted = null;
	const loading = el("p", {class: "hint"}, "Loading");
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
			const timer = setTimeout(() => view || place.append(loading), LOADING_MS);
			try {
				made ??= await load();
			} catch {
				place.append(fault);
				return;
			} finally {
				clearTimeout(timer);
				loading.remove();
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

/** A module, and the rules of its view. */
const both = (module, name) => Promise.all([module, new Promise((resolve) => {
	if (document.querySelector(`link[href="${name}"]`))
		resolve();
	else
		document.head.append(el("link", {rel: "stylesheet", href: name, onload: resolve,
			onerror: resolve}));
})]).then(([made]) => made);
const LATER = [() => both(import("./alarms.js"), "alarms.css"),
	() => both(import("./trends.js"), "trends.css"),
	() => both(both(import("./wire.js"), "views.css"), "wire.css"),
	() => both(import("./about.js"), "views.css")];
const [alarms, trends, wire, about, config] = [...LATER,
	() => both(both(import("./config.js"), "views.css"), "config.css")].map(fetched);
const AFTER = ["./keys.js", "./hour.js", "./tell.js", "./machines.js"];
const VIEWS = {live, alarms, trends, wire, config, about};
const LOADING_MS = 300; // until a view that is not there yet says so
const LATER_MS = 1000; // after the first values: then a lost connection leaves views to look at
const $ = (id) => document.getElementById(id);
let present = null;

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
	head.count(); // the title has the view
	VIEWS[wanted].show(query ?? "");
}

/**
 * Where the browser lets it, at https or localhost, a worker keeps the files. Within Cockpit or
 * another page, whose addresses change, it would keep them for nobody.
 */
const keep = async () => window.cockpit || window.parent !== window
	|| navigator.serviceWorker?.register("worker.js");

/** What comes later, by itself; if it fails, with the next signals anew. */
const begin = (name, again = false) => import(name).then((made) => made.begin()).catch((error) => {
	if (!again)
		console.warn(`${name}: ${error.message}`);
	store.addEventListener("signals", () => begin(name, true), {once: true});
});

for (const [key, view] of Object.entries(VIEWS))
	view.build($(key));
head.build();
store.addEventListener("signals", show);
store.addEventListener("signals", () => setTimeout(() =>
	[...LATER, ...AFTER.map((name) => () => begin(name)), keep]
		.forEach((load) => load().catch(() => {})), LATER_MS), {once: true});
document.querySelector(".skip").addEventListener("click", (event) => {
	event.preventDefault(); // the part behind # names the view
	$("main").focus();
});
window.addEventListener("hashchange", show);
show();
store.start();
