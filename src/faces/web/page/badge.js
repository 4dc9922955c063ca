// SPDX-License-Identifier: MIT
// The badge of an alarm: filled while it waits, outlined with a tick when somebody has seen it. A
// triangle says above or below, two of them very high or very low.
import {el, put, svg} from "./dom.js";

const SHAPES = {up: "M6 1 11 10H1Z", down: "M6 11 1 2H11Z", up2: "M6 0 11 6H1ZM6 6 11 12H1Z",
	down2: "M6 12 1 6H11ZM6 6 1 0H11Z", none: "M5 1H7V8H5ZM5 9H7V11H5Z"};

/** alarm: as alarmOf() of words.js gives it; null: the badge is hidden. */
export function paintBadge(node, alarm) {
	node.hidden = !alarm;
	if (!alarm)
		return;
	const {text, open, turn, very} = alarm;
	node.firstChild.firstChild.setAttribute("d", SHAPES[turn && very ? `${turn}2` : turn || "none"]);
	put(node.lastChild, text);
	node.classList.toggle("open", open);
	node.classList.toggle("very", very);
}

export function badge(alarm = null) {
	const node = el("span", {class: "alarm"},
		svg("svg", {viewBox: "0 0 12 12", "aria-hidden": "true"}, svg("path")), el("span"));
	paintBadge(node, alarm);
	return node;
}
