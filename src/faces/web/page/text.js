// SPDX-License-Identifier: MIT
// The text of the draft, to look at and to edit, with numbers of lines and the problems.
import {el, later, put} from "./dom.js";
import {draft} from "./draft.js";
import {problemList} from "./problems.js";

const REST_MS = 700; // after the last key, until the text is checked

let area, gutter, fault, problems, timer = 0, sent = null;

export function build(root) {
	gutter = el("pre", {class: "gutter", "aria-hidden": "true"});
	area = el("textarea", {id: "config-text", wrap: "off", spellcheck: "false", rows: 24,
		autocapitalize: "off", "aria-label": "Text of the draft", "aria-describedby": "text-hint",
		oninput: () => {
			draft.typed = true;
			clearTimeout(timer);
			timer = setTimeout(flush, REST_MS);
			number();
		},
		onchange: flush,
		onscroll: () => { gutter.scrollTop = area.scrollTop; }});
	fault = el("p", {class: "fault", role: "alert"});
	problems = el("div", {});
	root.append(el("p", {class: "hint", id: "text-hint"}, "What you type is checked when you "
		+ "pause. owsd.rio(5) explains the format."), fault,
	el("div", {class: "text"}, gutter, area), el("h2", {}, "Problems"), problems);
}

/* A text area has LF alone; the file keeps the line ends that it has. */
const endOf = (text) => /\r\n|\n|\r/.exec(text)?.[0] ?? "\n";
const shownText = (text) => text.replace(/\r\n|\r/g, "\n");
const isOther = () => area.value !== shownText(draft.text);

/** Have the draft take what was typed. */
export async function flush() {
	clearTimeout(timer);
	timer = 0;
	draft.typed = isOther();
	if (!draft.typed || area.value === sent)
		return;
	const mine = area.value;
	sent = mine;
	try {
		const end = endOf(draft.text);
		await draft.write(end === "\n" ? mine : mine.replaceAll("\n", end));
		draft.typed = isOther();
		put(fault, "");
	} catch (error) {
		put(fault, `The text cannot be checked: ${error.message}. It is not in the draft yet.`);
	}
	sent = null;
}

export function paint() {
	area.readOnly = !draft.editable;
	if (!timer && sent === null && isOther() && !fault.textContent)
		area.value = shownText(draft.text);
	problems.replaceChildren(problemList());
	number();
}

const number = later(() => {
	const wrong = new Set(draft.problems.map(({line}) => line));
	const lines = area.value.split("\n").length;
	put(gutter, Array.from({length: lines}, (_, n) => `${wrong.has(n + 1) ? "\u00d7" : ""}`
		+ `${n + 1}`).join("\n"));
	gutter.scrollTop = area.scrollTop;
}, 50);

/** Put the cursor into a line. */
export function open({line}) {
	if (!line)
		return;
	const lines = area.value.split("\n"), from = lines.slice(0, line - 1).join("\n").length;
	area.focus();
	area.setSelectionRange(line > 1 ? from + 1 : 0, from + (line > 1 ? 1 : 0)
		+ (lines[line - 1]?.length ?? 0));
	area.scrollTop = area.scrollHeight / lines.length * Math.max(0, line - 4);
}
