// SPDX-License-Identifier: MIT
// What a save would take away: signals, and the editing by this page.
import {draft} from "./draft.js";

const NAMED = 20;
const DOORS = ["Listen", "Hosts", "Proxy"]; // keys of Web that say how the page is reached

/** The signals of the file that the draft has not, in words; "": there are none. */
export function vanished() {
	const had = new Set(draft.saved.items.map((item) => item.name));
	const has = new Set(draft.model.items.map((item) => item.name));
	const fresh = new Map(draft.model.items.filter((item) => !had.has(item.name))
		.map((item) => [item.path, item.name]));
	const gone = draft.saved.items.filter((item) => item.name && !has.has(item.name))
		.map(({name, path}) => fresh.has(path) ? `${name} (${fresh.get(path)} has its path)` : name);
	return gone.length ? `Signals that vanish with this save: ${gone.slice(0, NAMED).join(", ")}`
		+ `${gone.length > NAMED ? ` and ${gone.length - NAMED} more` : ""}.` : "";
}

/** Why the page could edit nothing after a save, and what helps then; "": it could. */
export function lockout() {
	const had = draft.saved.blocks.Web ?? {}, has = draft.model.blocks.Web ?? {};
	if (!draft.editable)
		return "";
	const doors = DOORS.filter((key) => had[key] !== has[key]);
	const why = has.Configure !== "on" ? "this page can edit nothing more, and cannot put the file of "
		+ "before back: the draft has no \u201cConfigure on\u201d in its block Web"
		: doors.length ? `this page may not be within your reach: the draft changes ${doors.join(", ")} `
			+ "of its block Web" : "";
	const {file} = draft.info;
	return why && `After this save ${why}. The way back is then a command on that machine: `
		+ `cp ${file}.before ${file} && owsctl reload`;
}
