// SPDX-License-Identifier: MIT
// Before and after saving: problems, the difference to the file, what another has saved meanwhile,
// the state of the reload, and the way back to the file of before.
import {isUnknown} from "./api.js";
import {ask} from "./command.js";
import {compare} from "./diff.js";
import {able, action, announce, el, put} from "./dom.js";
import {draft} from "./draft.js";
import {lockout, vanished} from "./loss.js";
import {countWords, problemList} from "./problems.js";
import {store} from "./store.js";
import {dateAndClock, listOf, plural} from "./words.js";

const WATCH_MS = 30000;
const LINES = 1000; // of a difference that are shown
const NAMED = 10;

let problems, loss, lock, sum, heading, difference, theirs, conflict, fault, result, back, running, buttons;
let timer = 0, shown = false, clean = true, quiet = false;

export function build(root) {
	buttons = {
		save: action("Save and reload", save, "save", {class: "primary"}),
		restore: action("Make it work again as before", restore, "restore"),
		look: action("Show what was changed there", () => {
			theirs.hidden = !theirs.hidden;
			buttons.look.setAttribute("aria-expanded", String(!theirs.hidden));
			paint();
		}, "theirs"),
		drop: action("Take the file, drop my draft\u2026", drop, "drop"),
		top: action("Put my changes on top", rebase, "rebase"),
	};
	buttons.look.setAttribute("aria-expanded", "false");
	problems = el("div", {});
	loss = el("p", {class: "note", id: "save-loss"});
	lock = el("p", {class: "note is-bad", id: "save-lock", hidden: true});
	sum = el("p", {class: "count", id: "save-sum"});
	heading = el("h2", {});
	difference = el("div", {});
	theirs = el("div", {hidden: true});
	fault = el("p", {class: "fault", role: "alert"});
	result = el("p", {class: "note", id: "save-result", tabindex: -1, hidden: true});
	back = el("p", {class: "hint"});
	running = el("p", {class: "hint"});
	conflict = el("section", {class: "conflict", hidden: true, "aria-labelledby": "h-conflict"},
		el("h2", {id: "h-conflict"}, "Somebody else has saved the file"),
		el("p", {}, "The file has changed since this draft began. Nothing of that is overwritten "
			+ "before you choose. Take the file as it is, and your draft is dropped (undo brings it "
			+ "back). Or put your changes on top of it, and look at the difference."),
		el("div", {class: "tools"}, buttons.look, buttons.drop, buttons.top), theirs);
	root.append(conflict, el("h2", {}, "Problems"), problems, heading,
		difference, running, back,
	el("div", {class: "bar"}, sum, lock, loss, fault, result, el("div", {class: "tools"}, buttons.save,
		buttons.restore)));
}

export function show(yes) {
	shown = yes;
	if (yes)
		paint();
}

export function paint() {
	const {backup} = draft.info ?? {};
	if (clean && draft.dirty) // a new draft: what became of the one before is old
		result.hidden ||= quiet = !result.classList.contains("is-bad");
	clean = !draft.dirty;
	conflict.hidden = !draft.overtaken;
	able(buttons.save, draft.editable && draft.dirty && draft.valid && !draft.overtaken, result);
	buttons.drop.disabled = buttons.top.disabled = !draft.editable;
	buttons.restore.hidden = !backup;
	buttons.restore.disabled = !draft.editable;
	put(back, backup ? `The file of before, kept ${dateAndClock(backup.time)}, can take the place of `
		+ "the present one; then the present one is kept." : "No file of before is kept.");
	const {writer, configurable} = draft.info ?? {};
	put(running, configurable && writer ? `Nothing can be saved yet: ${writer}.` : "");
	if (!shown)
		return;
	problems.replaceChildren(problemList());
	put(loss, draft.dirty ? vanished() : "");
	loss.hidden = !loss.textContent;
	put(lock, draft.dirty ? lockout() : "");
	lock.hidden = !lock.textContent;
	put(heading, draft.overtaken ? "Difference to the file that your draft began with"
		: "Difference to the file on disk");
	difference.replaceChildren(differenceOf(draft.overtaken ? draft.base.text : draft.disk.text,
		draft.text, "The draft is the same as the file."));
	put(sum, draft.dirty ? `This save: ${difference.querySelector(".count")?.textContent ?? ""}` : "");
	theirs.replaceChildren(theirs.hidden ? "" : differenceOf(draft.base.text, draft.disk.text,
		"The other has changed nothing."));
}

const WORDS = {"+": "added: ", "-": "removed: ", " ": ""};

function differenceOf(before, after, none) {
	if (before === after)
		return el("p", {class: "fine"}, none);
	const {added, removed, parts} = compare(before, after);
	let left = LINES;
	const shownParts = parts.map((part) => part.slice(0, Math.max(0, left -= part.length)
		? part.length : Math.max(0, left + part.length))).filter((part) => part.length);
	return el("div", {}, el("p", {class: "count"}, `${plural(added, "line")} added, `
		+ `${removed} removed.`), ...shownParts.map(hunk),
	left < 0 ? el("p", {class: "hint"}, `And ${-left} lines more.`) : null);
}

const hunk = (part) => el("pre", {class: "diff", tabindex: 0, role: "group",
	"aria-label": `Line ${part[0][2]} and what follows`},
...part.map(([sign, line, number]) => el(sign === "+" ? "ins" : sign === "-" ? "del" : "span",
	{class: "line"}, el("span", {class: "unseen"}, WORDS[sign]),
	el("span", {class: "at", "aria-hidden": "true"}, `${String(number).padStart(5)} ${sign} `),
	`${line}\n`)));

// --- Saving ---------------------------------------------------------------------------------

function say(state, words) {
	result.hidden = false;
	result.className = `note is-${state}`;
	put(result, words);
	buttons.restore.classList.toggle("primary", state === "bad");
}

/* Words, and an announcement of them. */
function report(state, words) {
	say(state, words);
	announce(words);
}

async function act(words, call) {
	clearInterval(timer);
	quiet = false;
	put(fault, "");
	say("pending", words);
	const good = store.unknown ? [] : store.signals.filter((signal) => signal.good)
		.map((signal) => signal.name);
	try {
		told(await call(), good);
	} catch (error) {
		result.hidden = true;
		if (error.status === 409)
			announce("Somebody else has saved the file meanwhile. Nothing was saved.");
		put(fault, error.status === 409 ? "Not saved: somebody else has saved the file meanwhile. "
			+ "Choose above what to do." : !isUnknown(error) ? `Not saved: ${error.message}`
			: `It is not known whether that was saved: ${error.message}. Look at the file again.`);
		if (error.status === 409) {
			conflict.scrollIntoView();
			buttons.look.focus({preventScroll: true});
		}
	}
}

function told({reload, why}, good) {
	const because = why ? `: ${why}` : "";
	if (reload === "refused")
		report("bad", `Saved, but owsd refused it${because}. It goes on with what it had. Correct `
			+ "the draft, or take the file of before.");
	else if (reload === "none")
		report("good", `Saved. owsd is not running${because}; it takes the file when it starts.`);
	else
		watch(good);
}

/* Do signals that were good become good again? */
function watch(good) {
	let until = performance.now() + WATCH_MS;
	const look = () => {
		if (document.hidden) { // it gets no values
			until = performance.now() + WATCH_MS;
			return;
		}
		const lost = good.filter((name) => store.find(name) && !store.find(name).good);
		const names = listOf(lost, NAMED);
		const over = performance.now() > until;
		if (over)
			clearInterval(timer);
		if (store.unknown)
			(over ? report : say)(over ? "bad" : "pending", "Saved, and owsd has reloaded. Since "
				+ "then its values are unknown.");
		else if (lost.length)
			(over ? report : say)(over ? "bad" : "pending", "Saved, and owsd has reloaded. Good "
				+ `before and not good ${over ? "for half a minute" : "yet"}: ${names}.`);
		else if (quiet)
			result.hidden = true;
		else
			say("good", `Saved, and owsd has reloaded.${good.length ? " All signals that were "
				+ "good are good." : ""}${over ? "" : " The page goes on looking for half a minute."}`);
	};
	report("pending", "Saved, and owsd has reloaded.");
	timer = setInterval(look, 1000);
}

async function save() {
	const locked = lockout();
	if (!locked || await ask("Save, and edit no more by this page?", "Save it nevertheless",
		[el("p", {}, locked), el("p", {}, vanished())]))
		act("Saving\u2026", () => draft.save());
}

const restore = () => act("Putting the file of before back\u2026", () => draft.restore());

async function drop() {
	if (!await ask("Drop your draft?", "Drop it", [el("p", {}, "The draft becomes what the file "
		+ "has. Undo brings your changes back.")]))
		return;
	await choose(() => draft.drop(), () => "The draft is what the file has.");
}

const rebase = () => choose(() => draft.rebase(), (clashes) => `${onTop(clashes)}${draft.valid ? ""
	: ` The draft has ${countWords()}: the list of problems has the places.`}`);

const onTop = (clashes) => clashes.length
	? `Your changes are on top. At ${plural(clashes.length, "place")} both had `
		+ "changed the same lines, and the draft has yours there: look at the difference before you "
		+ "save." : "Your changes are on top of the other file. Look at the difference, and save.";

async function choose(call, words) {
	try {
		const answer = await call();
		put(fault, "");
		report("good", words(answer));
		buttons.save.focus();
	} catch (error) {
		put(fault, error.message);
	}
}
