// SPDX-License-Identifier: MIT
// The view Configuration: its parts, the state of the draft, undo, import and export.
import * as blocks from "./blocks.js";
import {ask} from "./command.js";
import {able, action, attempt, button, el, put} from "./dom.js";
import {draft} from "./draft.js";
import * as found from "./found.js";
import * as items from "./items.js";
import {countWords, hashOf} from "./problems.js";
import * as saving from "./save.js";
import {save as download} from "./series.js";
import {store} from "./store.js";
import * as text from "./text.js";
import {plural} from "./words.js";

const MOST = 1 << 20; // bytes of a text that owsd-web takes

const PARTS = [["items", "Items", items], ["found", "Found", found],
	["blocks", "Targets and blocks", blocks], ["text", "Text", text],
	["save", "Review and save", saving]];

const tabs = new Map(), panels = new Map();
let part = "items", shown = false, file, state, why, fault, notice, taken, buttons, body, input;

export function build(root) {
	file = el("code", {});
	state = el("p", {class: "count", id: "draft-state", tabindex: -1});
	why = el("p", {class: "note", id: "draft-why", hidden: true});
	fault = el("p", {class: "fault", role: "alert"});
	notice = el("p", {class: "note", hidden: true});
	taken = el("p", {class: "note", id: "draft-taken", hidden: true});
	input = el("input", {type: "file", accept: ".rio,text/plain", class: "unseen", tabindex: -1,
		"aria-label": "File to import", onchange: take});
	buttons = {
		undo: action("Undo", () => step("undo"), "undo"),
		redo: action("Redo", () => step("redo"), "redo"),
		empty: action("New", anew, "new"),
		take: action("Import\u2026", () => input.click(), "import"),
		give: action("Export", give, "export"),
		drop: action("Discard draft\u2026", discard, "discard"),
	};
	const list = el("div", {class: "tabs", role: "tablist", "aria-label": "Parts of the dialog",
		onkeydown: keys});
	body = el("div", {});
	for (const [name, title, view] of PARTS) {
		const tab = button(title, () => open({part: name}), {role: "tab", id: `tab-${name}`,
			"aria-controls": `part-${name}`});
		const panel = el("div", {role: "tabpanel", id: `part-${name}`, class: "part",
			"aria-labelledby": `tab-${name}`});
		tabs.set(name, tab);
		panels.set(name, panel);
		list.append(tab);
		view.build(panel);
		body.append(panel);
	}
	root.append(el("p", {class: "hint"}, "File ", file), why, fault, notice, taken,
		el("div", {class: "draft-bar"}, el("div", {class: "tools"}, ...Object.values(buttons), input,
			state), list), body);
	draft.addEventListener("change", paint);
	draft.addEventListener("go", ({detail}) => open(detail));
	window.addEventListener("beforeunload", (event) => draft.dirty && event.preventDefault());
	// owsd has reloaded, or its connection is back: the file and the rights may be others
	let generation = store.info?.generation;
	const look = () => {
		if (store.info?.generation !== generation)
			shown && draft.load();
		({generation} = store.info ?? {});
	};
	store.addEventListener("signals", look);
	store.addEventListener("values", look);
	window.addEventListener("focus", () => shown && draft.load());
	pick(part);
}

let last = null; // the address that was shown last: the same again moves no focus

export function show(query) {
	if (!shown || !draft.ready)
		draft.load();
	shown = true;
	if (query !== last && query) {
		last = query;
		const where = Object.fromEntries(new URLSearchParams(query));
		draft.load().then(() => open({...where, line: Number(where.line) || undefined}));
	}
	saving.show(part === "save");
}

export function hide() {
	shown = false;
	found.stop();
	text.flush();
}

// --- Parts ----------------------------------------------------------------------------------

function open(where) {
	const name = panels.has(where.part) ? where.part : "items";
	if (part === "text" && name !== "text")
		text.flush();
	pick(name);
	const address = hashOf({part: name === "items" && !where.item ? undefined : name,
		item: where.item});
	last = address.split("?")[1];
	history.replaceState(null, "", last ? address : "#config");
	if (name === "save")
		draft.load();
	PARTS.find(([key]) => key === name)[2].open?.(where);
}

function pick(name) {
	part = name;
	for (const [key, tab] of tabs) {
		tab.setAttribute("aria-selected", String(key === name));
		tab.tabIndex = key === name ? 0 : -1;
		panels.get(key).hidden = key !== name;
	}
	saving.show(name === "save");
}

function keys(event) {
	const names = [...tabs.keys()], by = {ArrowLeft: -1, ArrowRight: 1}[event.key];
	if (!by)
		return;
	event.preventDefault();
	const next = names[(names.indexOf(part) + by + names.length) % names.length];
	open({part: next});
	tabs.get(next).focus();
}

function paint() {
	const {info} = draft;
	put(fault, draft.fault);
	body.hidden = !draft.ready;
	if (!info)
		return;
	put(file, info.file);
	why.hidden = info.configurable;
	put(why, info.configurable ? "" : `You can look at the configuration, not change it. `
		+ `${info.why ?? ""}`);
	taken.hidden ||= !draft.dirty;
	put(state, draft.dirty ? `Draft with ${plural(draft.changes, "change")}, `
		+ `not saved; ${countWords()}` : `As on disk; ${countWords()}`);
	draft.restored &&= draft.dirty;
	notice.hidden = !draft.restored && !(draft.overtaken && draft.dirty);
	put(notice, draft.overtaken && draft.dirty ? "Somebody else has saved the file since this "
		+ "draft began. \u201cReview and save\u201d shows the difference and what you can do."
		: draft.restored ? "This draft is of before the page was loaded anew. It is not saved." : "");
	buttons.redo.disabled &&= !draft.editable || !draft.redoable; // it may get the focus
	able(buttons.undo, draft.editable && draft.undoable, buttons.redo);
	able(buttons.redo, draft.editable && draft.redoable, buttons.undo);
	able(buttons.drop, draft.dirty, state);
	buttons.empty.disabled = buttons.take.disabled = !draft.editable;
	put(tabs.get("save"), draft.dirty ? "Review and save \u2022" : "Review and save");
	for (const [, , view] of PARTS)
		view.paint();
}

// --- The whole draft ------------------------------------------------------------------------

const step = (what) => attempt(fault, () => draft[what](),
	() => `${what === "undo" ? "Undone" : "Done again"}: ${countWords()}.`);

async function anew() {
	if (!draft.dirty || await ask("Begin with an empty configuration?", "Begin anew",
		[el("p", {}, "The draft is replaced. Undo brings it back, and the file stays as it is.")]))
		attempt(fault, () => begin({do: "new"}), () => "The draft is an empty configuration. "
			+ taken.textContent);
}

/* A new text; what it takes over from the file is named. */
async function begin(step) {
	const {kept, lost} = await draft.begin(step);
	const blocks = (names) => `block${names.length > 1 ? "s" : ""} ${names.join(", ")}`;
	put(taken, [kept.length ? `The new text had no ${blocks(kept)}: kept from the file.` : "",
		lost.length ? `The new text has no ${blocks(lost)}, and has errors: correct it, and add what `
			+ "you need." : ""].filter(Boolean).join(" "));
	taken.hidden = !taken.textContent;
}

async function discard() {
	if (await ask("Discard the draft?", "Discard", [el("p", {}, "The draft becomes what the file "
		+ "on disk has. Undo brings your changes back as long as the page is open.")]))
		attempt(fault, () => draft.drop(), () => "The draft is what the file has.");
}

function give() {
	const name = draft.info?.file?.split("/").at(-1) || "OWS.rio";
	download(name, draft.text, "text/plain");
}

function take() {
	const [chosen] = input.files;
	if (!chosen)
		return;
	attempt(fault, async () => {
		if (chosen.size > MOST)
			throw new Error(`${chosen.name} has more than 1 MiB.`);
		let text;
		try {
			text = new TextDecoder("utf-8", {fatal: true, ignoreBOM: false})
				.decode(await chosen.arrayBuffer());
		} catch {
			throw new Error(`${chosen.name} is not UTF-8: convert it, as with iconv.`);
		}
		await begin({do: "check", text});
	}, () => `${chosen.name} is the draft now: ${countWords()}. ${taken.textContent}`);
	input.value = "";
}
