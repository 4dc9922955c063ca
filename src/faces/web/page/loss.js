// SPDX-License-Identifier: MIT
// What a save would take away: signals, and the editing by this page.
import {identityOf, isOn} from "./cells.js";
import {draft} from "./draft.js";
import {listOf} from "./words.js";

const NAMED = 20;
const DOORS = ["Listen", "Hosts", "Proxy"]; // keys of Web that say how the page is reached

const list = (words, of) => of.length ? `${words}: ${listOf(of, NAMED)}.` : "";

/** What a save does to signals of the file and to their history, in words; "": nothing. */
export function vanished() {
	const saved = draft.saved.items.filter((item) => item.name);
	const had = new Set(saved.map((item) => item.name));
	const has = new Map(draft.model.items.map((item) => [item.name, item]));
	const fresh = new Map(draft.model.items.filter((item) => !had.has(item.name))
		.map((item) => [identityOf(item), item.name]));
	const gone = [], goesOn = [], begins = [];
	for (const item of saved) {
		const {name, path} = item, now = has.get(name), identity = identityOf(item);
		if (!now && fresh.has(identity))
			goesOn.push(`${name} is ${fresh.get(identity)} now`);
		else if (!now)
			gone.push(name);
		else if (identityOf(now) !== identity)
			begins.push(`${name} (with Identity ${identity} it goes on)`);
		else if (now.path !== path)
			goesOn.push(`${name} has another path`);
	}
	return [list("Signals that vanish with this save", gone), list("Their history goes on", goesOn),
		list("Their history begins anew", begins)].filter(Boolean).join(" ");
}

/** Why the page could edit nothing after a save, and what helps then; "": it could. */
export function lockout() {
	const had = draft.saved.blocks.Web ?? {}, has = draft.model.blocks.Web ?? {};
	if (!draft.editable || draft.info.edit) // owsd-web --edit
		return "";
	const doors = DOORS.filter((key) => had[key] !== has[key]);
	const why = !isOn(has.Configure) ? "this page can edit nothing more, and cannot put the file of "
		+ "before back: the draft has no \u201cConfigure on\u201d in its block Web"
		: doors.length ? `this page may not be within your reach: the draft changes ${doors.join(", ")} `
			+ "of its block Web" : "";
	const {file} = draft.info;
	return why && `After this save ${why}. The way back is then a command on that machine: `
		+ `cp ${file}.before ${file} && owsctl reload`;
}
