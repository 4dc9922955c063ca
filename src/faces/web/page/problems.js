// SPDX-License-Identifier: MIT
// What the checker reports about the draft: where it belongs, and the list with links to it.
import {el} from "./dom.js";
import {draft} from "./draft.js";
import {plural} from "./words.js";

const SHOWN = 50;
const OWN = ["ItemCount", "Version", "Files"]; // keys that have no field
const BUS = "Bus:";                   // the name of a block Bus is this and its target

const has = (place, key) => draft.options(place).some((option) => option.key === key);

/** Where a problem can be corrected: {part, item, block, bus, key, line} for draft.go(). */
export function placeOf({item, block, key, line}) {
	if (item && draft.item(item) && (!key || has("item", key)))
		return {part: "items", item, key};
	if (block?.startsWith(BUS) && has("bus", key) && key !== "Target")
		return {part: "blocks", block: "Bus", bus: block.slice(BUS.length), key};
	const single = draft.singles().find(({name}) => name === block);
	if (single && has(single.place, key) && !OWN.includes(key))
		return {part: "blocks", block, key};
	return {part: "text", line};
}

/** The problems of an item, or of a block of owsd's own. */
export function problemsOf(where) {
	return draft.problems.filter((problem) => {
		const place = placeOf(problem);
		return Object.entries(where).every(([key, value]) => place[key] === value);
	});
}

export function countWords() {
	const errors = draft.problems.filter((one) => one.error).length;
	const warnings = draft.problems.length - errors;
	return [errors && plural(errors, "error"), warnings && plural(warnings, "warning")]
		.filter(Boolean).join(", ")
		|| "no problem";
}

export const hashOf = (where) => `#config?${new URLSearchParams(
	Object.entries(where).filter(([, value]) => value !== undefined && value !== null))}`;

/** The list of all problems. */
export function problemList() {
	if (!draft.problems.length)
		return el("p", {class: "fine"}, "The checker of owsd finds no problem.");
	const rows = draft.problems.slice(0, SHOWN).map((problem) => {
		const where = placeOf(problem);
		const place = [problem.item ?? where.bus ?? where.block, problem.key].filter(Boolean)
			.join(", ");
		return el("li", {class: problem.error ? "is-bad" : "is-uncertain"},
			el("span", {class: "shape", "aria-hidden": "true"}, problem.error ? "\u00d7" : "?"),
			el("span", {}, el("b", {}, problem.error ? "Error" : "Warning"), " ",
				el("a", {href: hashOf(where), onclick: (event) => {
					event.preventDefault();
					draft.go(where);
				}}, [place, problem.line ? `line ${problem.line}` : ""].filter(Boolean)
					.join(", ") || "file"), `: ${problem.text}`));
	});
	const more = draft.problems.length - SHOWN;
	return el("div", {}, el("ul", {class: "problems"}, ...rows),
		more > 0 ? el("p", {class: "hint"}, `And ${more} more.`) : null);
}
