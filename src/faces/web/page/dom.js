// SPDX-License-Identifier: MIT
// Makes elements. Text goes in by textContent only, style by classes or the CSSOM.

/** el("td", {class: "value", "aria-label": "x", onclick: f}, "text", node, ...) */
export function el(name, attributes = {}, ...children) {
	return fill(document.createElement(name), attributes, children);
}

/** A button, with more attributes. */
export const button = (text, onclick, more = {}) =>
	el("button", {type: "button", onclick, ...more}, text);

/** The same with a name for what it does. */
export const action = (text, onclick, name, more = {}) =>
	button(text, onclick, {"data-action": name, ...more});

const SVG = "http://www.w3.org/2000/svg";

export function svg(name, attributes = {}, ...children) {
	return fill(document.createElementNS(SVG, name), attributes, children);
}

function fill(node, attributes, children) {
	for (const [key, value] of Object.entries(attributes)) {
		if (value === null || value === undefined || value === false)
			continue;
		if (key.startsWith("on"))
			node.addEventListener(key.slice(2), value);
		else
			node.setAttribute(key, value === true ? "" : String(value));
	}
	node.append(...children.filter((child) => child !== null && child !== undefined));
	return node;
}

/** Set the text of a node, if it is another one. */
export function put(node, text) {
	if (node.textContent !== text)
		node.textContent = text;
}

/** Set a class to one of a kind: mark(node, "is-", "bad") */
export function mark(node, prefix, state) {
	const wanted = prefix + state;
	if (node.classList.contains(wanted))
		return;
	for (const name of [...node.classList])
		if (name.startsWith(prefix))
			node.classList.remove(name);
	node.classList.add(wanted);
}

/** A table with a head: columns are texts, or [text, class]; rows are lists of texts or nodes. */
export function table(caption, columns, rows, empty = "None.") {
	const heads = columns.map((column) => {
		const [text, name] = Array.isArray(column) ? column : [column, null];
		return el("th", {scope: "col", class: name}, text);
	});
	const body = rows.map((row) => el("tr", {}, ...row.map((cell, n) => {
		const name = Array.isArray(columns[n]) ? columns[n][1] : null;
		const label = Array.isArray(columns[n]) ? columns[n][0] : columns[n];
		return n === 0 ? el("th", {scope: "row", class: name, role: "rowheader"}, cell)
			: el("td", {class: name, role: "cell", "data-label": label}, cell ?? "");
	})));
	for (const row of body)
		row.setAttribute("role", "row");
	if (!body.length)
		body.push(el("tr", {role: "row"},
			el("td", {class: "none", role: "cell", colspan: columns.length}, empty)));
	return el("table", {class: "data", role: "table"},
		el("caption", {}, caption),
		el("thead", {role: "rowgroup"}, el("tr", {role: "row"}, ...heads)),
		el("tbody", {role: "rowgroup"}, ...body));
}

/** A place for a table that may be wider than the screen: the keyboard can scroll it. */
export const wide = (label) =>
	el("div", {class: "wide", role: "group", tabindex: 0, "aria-label": label});

/** Let a button act or not. One that has the focus, and acts no more, hands it on. */
export function able(button, yes, next) {
	if (!yes && document.activeElement === button)
		next.focus();
	button.disabled = !yes;
}

/** Do it, and announce words(what it returns); what is refused stands in the fault. */
export async function attempt(fault, call, words) {
	try {
		const done = await call();
		put(fault, "");
		announce(words(done));
	} catch (error) {
		put(fault, error.message);
	}
}

/** The live region: few words, and only what the user waits for or must know. */
export function announce(text) {
	const region = document.getElementById("announce");
	region.textContent = "";
	requestAnimationFrame(() => { region.textContent = text; });
}

/** A call that happens once, so many ms after the first wish for it. */
export function later(call, ms) {
	let timer = 0;
	return () => {
		if (timer)
			return;
		timer = setTimeout(() => {
			timer = 0;
			call();
		}, ms);
	};
}
