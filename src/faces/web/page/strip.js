// SPDX-License-Identifier: MIT
// The adapters of the view Wire as strips of terminals, or as a table: a terminal is a wire of an
// adapter, with its chips as nodes.
import {el, table} from "./dom.js";
import {store} from "./store.js";
import {SHAPES, listOf, plural, qualityWords, stateOf, valueText, withUnit} from "./words.js";

const CHIPS = 12; // of a terminal that are shown
const TERMINALS = 16; // as strips; more are a table
const ROWS = 64; // of that table
const NAMES = 3; // signals of a chip that are named

/** Make what a node has another, and keep what is the same: the focus, a finger on a button. */
export function redraw(root, nodes) {
	nodes.forEach((wanted, n) => n < root.childNodes.length ? become(root.childNodes[n], wanted)
		: root.append(wanted));
	while (root.childNodes.length > nodes.length)
		root.lastChild.remove();
}

function become(node, wanted) {
	if (node.isEqualNode(wanted))
		return;
	if (node.nodeType !== Node.ELEMENT_NODE || node.nodeName !== wanted.nodeName) {
		node.replaceWith(wanted);
		return;
	}
	for (const {name} of [...node.attributes])
		if (!wanted.hasAttribute(name))
			node.removeAttribute(name);
	for (const {name, value} of wanted.attributes)
		if (node.getAttribute(name) !== value)
			node.setAttribute(name, value);
	redraw(node, [...wanted.childNodes]);
}

export const percent = (share, label) => el("span", {class: "load"},
	el("meter", {min: 0, max: 100, high: 90, value: share.toFixed(2), "aria-label": label}),
	el("span", {}, share && share < 0.1 ? "< 0.1 %" : `${share.toFixed(share < 10 ? 1 : 0)} %`));

const loadOf = ({load, name}) => load === null ? null : percent(load, `Load of ${name}`);
const errorsOf = ({errors}) => errors ? plural(errors, "error") : "no error";
const shortWords = `${SHAPES.bad} short`;

export const chipNames = ({signals}) => listOf(signals.map(({name}) => name), NAMES);

const valuesOf = ({signals, code}) => stateOf(code) !== "good" ? qualityWords(code)
	: listOf(signals.map((one) => withUnit(one, valueText(one, store.value(one)))), NAMES);

const node = (chip) => el("li", {class: `node is-${stateOf(chip.code)}`},
	el("a", {href: `#live?q=${encodeURIComponent(chip.id)}`}, chipNames(chip)),
	el("span", {class: "description"}, chip.family ? `${chip.family}, ` : "",
		el("span", {class: "value"}, valuesOf(chip))));

const buttonOf = ({key, name, label}, chosen, look) => el("button", {type: "button", class: look,
	"aria-pressed": String(key === chosen), "aria-label": `${label}: chips of ${name}`,
	"data-key": key}, label);

function terminalOf(terminal, chosen) {
	const {chips, short} = terminal, more = chips.length - CHIPS;
	return el("li", {class: `terminal${short ? " is-short" : ""}${chips.length ? "" : " is-empty"}`},
		buttonOf(terminal, chosen, "screws"),
		el("div", {class: "line"}, short ? el("strong", {class: "pill is-bad"}, shortWords)
			: chips.length ? loadOf(terminal) : el("span", {class: "description"}, "empty"),
		chips.length || terminal.errors
			? el("span", {class: terminal.errors ? "description errors" : "description"},
				errorsOf(terminal))
			: null),
		chips.length ? el("ul", {class: "nodes"}, ...chips.slice(0, CHIPS).map(node),
			more > 0 ? el("li", {class: "description"}, `and ${more} more`) : null) : null);
}

function stripOf(target, name, terminals, stats, chosen) {
	const up = !target || target.state === "up", load = stats?.load?.get(name);
	const chips = terminals.reduce((n, one) => n + one.chips.length, 0);
	return el("section", {class: `sheet strip${up ? "" : " edge-bad"}`},
		el("div", {class: "strip-head"}, el("h3", {}, name ?? "Adapter not known"),
			el("span", {class: "aside"}, `${plural(terminals.length, "terminal")}, `
				+ plural(chips, "chip")),
			target ? el("span", {class: `pill is-${up ? "good" : "bad"}`},
				up ? "up" : `${SHAPES.bad} ${target.state}`) : null,
			load === undefined ? null : percent(load, `Load of ${name}`)),
		up && target?.note ? el("p", {class: "held"}, target.note) : null,
		el("ol", {class: "terminals"}, ...terminals.map((one) => terminalOf(one, chosen))));
}

function tableOf(terminals, chosen) {
	const more = terminals.length - ROWS;
	return [table("Terminals", ["Terminal", "Adapter", "State", "Load", ["Errors", "right"], "Chips"],
		terminals.slice(0, ROWS).map((one) => [buttonOf(one, chosen, "terminal-key"),
			one.adapter ?? "not known", one.short ? shortWords : one.chips.length
				? `${one.chips.filter((chip) => chip.answers).length} of ${one.chips.length} answer`
				: "empty", loadOf(one) ?? "\u2014", String(one.errors),
			listOf(one.chips.map(chipNames), CHIPS)]), "owsd has no target."),
	...(more > 0 ? [el("p", {}, `and ${more} more`)] : [])];
}

/** The nodes that show the terminals; a button of one has its key as data-key. */
export function stripsOf(terminals, stats, chosen, asTable) {
	if (asTable || terminals.length > TERMINALS)
		return tableOf(terminals, chosen);
	const targets = new Map((stats?.targets ?? []).map((one) => [one.name, one]));
	return [...new Set([...targets.keys(), ...terminals.map(({adapter}) => adapter)])].map((name) =>
		stripOf(targets.get(name), name, terminals.filter(({adapter}) => adapter === name), stats,
			chosen));
}
