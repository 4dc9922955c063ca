// SPDX-License-Identifier: MIT
// The tables of the view Live: one for each group, or one list whose heads put it in order.
import {button, el} from "./dom.js";
import {COLUMNS} from "./order.js";
import {shared} from "./row.js";
import {chunked, reserve} from "./rows.js";

const cell = (name, content, sort = null) => el("th", {class: `c-${name}`, scope: "col",
	role: "columnheader", "aria-sort": sort}, content);

/* A click on a head turns the order; values begin with the greatest. */
function sorter([name, text], {order, unit, choose}) {
	const mine = order.replace(/^-/, "") === name, down = order.startsWith("-");
	const words = name === "value" && unit ? `${text}, ${unit}` : text;
	const next = mine ? down ? name : `-${name}` : name === "value" ? "-value" : name;
	return cell(name === "hour" ? "spark" : name, button(`${words}${mine ? down ? " \u25be"
		: " \u25b4" : ""}`, () => choose(next)), mine ? down ? "descending" : "ascending" : "none");
}

function headsOf(list) {
	if (!list)
		return COLUMNS.slice(0, 4).map(([name, text]) => cell(name === "hour" ? "spark" : name, text));
	const cells = COLUMNS.map((column) => sorter(column, list));
	if (shared.scale)
		cells.splice(2, 0, cell("scale", el("span", {class: "ends"},
			el("span", {}, String(shared.scale.from)), "on one scale",
			el("span", {}, String(shared.scale.to)))));
	return cells;
}

/** A table of rows; list: {order, unit, choose(order)} if it is the list. Its parts join bodies. */
export function table(label, rows, bodies, list = null) {
	const made = chunked(rows).map((some) => {
		const body = el("tbody", {role: "rowgroup"});
		reserve(body, some);
		return body;
	});
	bodies.push(...made);
	return el("table", {class: `live ${list ? "is-list" : "is-group"}`, role: "table",
		"aria-label": label}, el("thead", {role: "rowgroup"},
		el("tr", {class: "heads", role: "row"}, ...headsOf(list))), ...made);
}

export const groupCard = ({title, members}, bodies) =>
	el("section", {class: "group sheet", "aria-label": title}, el("h2", {}, title, " ",
		el("span", {class: "count"}, String(members.length))), table(title, members, bodies));
