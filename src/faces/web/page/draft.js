// SPDX-License-Identifier: MIT
// The draft: a text of the configuration that is edited in this browser alone, with undo, and the
// calls that edit, check and save it. Events: "change" (anything below), "go" (show a place of it).
import {get, isUnknown, post} from "./api.js";
import {hunks, merge} from "./diff.js";
import {idOf} from "./names.js";
import {store} from "./store.js";
import {recall, remember} from "./kept.js";

const STEPS = 200;            // of undo
const CHARACTERS = 32 << 20;  // of all texts that undo keeps
const SAVE_MS = 60000;        // a reload waits for what is on the bus
const EMPTY = {targets: [], driver: {}, blocks: {}, buses: [], items: []};

class Draft extends EventTarget {
	info = null;               // the answer of api/config, without text and model
	keys = [];                 // the table of options
	fault = "";                // why nothing can be shown
	base = {tag: null, text: ""};  // the file that the draft started from
	disk = this.base;              // the file as it was seen last
	saved = EMPTY;                 // the model of that file
	text = "";
	model = EMPTY;
	problems = [];
	valid = true;
	restored = false; // the draft is of before the page was loaded anew
	typed = false; // the part Text has more than the draft, of the same base
	#past = [];
	#future = [];
	#turn = Promise.resolve();

	get ready() { return this.info !== null; }
	get dirty() { return this.text !== this.base.text; }
	get editable() { return Boolean(this.info?.configurable); }
	get undoable() { return this.#past.length > 0; }
	get redoable() { return this.#future.length > 0; }
	/** Somebody else has changed the file since the draft began. */
	get overtaken() { return this.disk.tag !== this.base.tag; }

	item(name) {
		return this.model.items.find((item) => item.name === name);
	}

	/** The keys of a place: "item", "driver", ... */
	options(place) {
		return this.keys.filter((key) => key.place === place);
	}

	/** The driver and the blocks of programs, which stand once: {name, place, title}. */
	singles() {
		return [...new Set(this.keys.map(({place}) => place))]
			.filter((place) => place !== "item" && place !== "bus").map((place) => {
				const title = place[0].toUpperCase() + place.slice(1);
				return {name: place === "driver" ? "OwsDrv" : title, place, title};
			});
	}

	go(where) {
		this.dispatchEvent(new CustomEvent("go", {detail: where}));
	}

	// --- What the file has ------------------------------------------------------------------

	/** Look at the file. A draft without changes follows it, another stays as it is. */
	load() {
		return this.#queue(async () => {
			try {
				const answer = await get("config");
				if (!this.keys.length)
					this.keys = (await get("config/keys")).keys;
				await this.#see(answer);
				this.fault = "";
			} catch (error) {
				this.fault = error.status === 404
					? "This owsd-web has no access to the configuration."
					: `The configuration cannot be shown: ${error.message}.`;
			}
		});
	}

	async #see({text, model, ...info}) {
		const first = !this.ready, kept = first ? recall(info.file) : null;
		this.info = info;
		this.disk = {tag: info.tag, text};
		this.saved = model;
		if (kept) {
			this.base = kept.base;
			await this.#show(kept.text);
			this.restored = this.dirty;
		} else if (first || (!this.dirty && !this.typed && this.overtaken)) {
			this.base = this.disk;
			await this.#show(text, model);
		} else if (text === this.text) {
			this.base = this.disk; // the other has done the same
		}
	}

	/* Take a text that is not of an edit; one that the person may not edit is shown unchecked. */
	async #show(text, model = EMPTY) {
		this.#take({text, model, problems: [], valid: true});
		if (this.editable)
			this.#take(await post("config/draft", {do: "check", text}));
	}

	/* What a chip is called is known of owsd's signals. */
	#take({text, model, problems, valid}) {
		const families = new Map(store.signals.map(({device, family}) => [idOf(device), family]));
		for (const item of model.items)
			item.family = item.device ? families.get(idOf(item.device)) : null;
		Object.assign(this, {text, model, problems, valid});
	}

	// --- Edits ------------------------------------------------------------------------------

	/** Do these edits as one step; throws why they are refused, and then nothing is changed. */
	edit(...steps) {
		return this.#queue(async () => {
			const step = steps.length === 1 ? steps[0]
				: {do: "steps", steps: steps.map((one) => JSON.stringify(one)).join("\n")};
			this.#step(await post("config/draft", {...step, text: this.text}));
		});
	}

	/** Take another text in place of all. */
	write(text) {
		return this.#queue(async () =>
			this.#step(await post("config/draft", {do: "check", text})));
	}

	/**
	 * Begin anew with the answer to this edit, "new" or "check". Blocks of programs that the file has
	 * and the new text lacks come along: without Web nobody could edit any more. {kept, lost}: names;
	 * a text with errors cannot take them.
	 */
	begin(step) {
		return this.#queue(async () => {
			let answer = await post("config/draft", step);
			const kept = [], lost = [];
			for (const [name, block] of Object.entries(this.saved.blocks)) {
				const keys = Object.entries(block);
				if (!keys.length || answer.model.blocks[name])
					continue;
				try {
					answer = await post("config/draft", {do: "set", name, text: answer.text,
						keys: keys.map(([key, value]) => `${key}=${value}`).join("\n")});
					kept.push(name);
				} catch (error) {
					if (error.status !== 422)
						throw error;
					lost.push(name);
				}
			}
			this.#step(answer);
			return {kept, lost};
		});
	}

	#step(answer) {
		if (answer.text !== this.text) {
			this.#past.push(this.text);
			this.#future = [];
			let size = 0;
			const from = this.#past.findLastIndex((text) => (size += text.length) > CHARACTERS);
			this.#past = this.#past.slice(Math.max(from + 1, this.#past.length - STEPS));
		}
		this.#take(answer);
	}

	undo() { return this.#back(this.#past, this.#future); }
	redo() { return this.#back(this.#future, this.#past); }

	#back(from, to) {
		return this.#queue(async () => {
			if (!from.length)
				return;
			const answer = await post("config/draft", {do: "check", text: from.at(-1)});
			to.push(this.text);
			from.pop();
			this.#take(answer);
		});
	}

	/* One at a time, each with the text that the one before left. */
	#queue(act) {
		const done = this.#turn.then(act);
		this.#turn = done.catch(() => {}).then(() => {
			remember(this);
			this.dispatchEvent(new Event("change"));
		});
		return this.#turn.then(() => done);
	}

	// --- The file ---------------------------------------------------------------------------

	/** Save; throws: status 409, somebody else has changed the file; 422: problems. */
	save() {
		return this.#write("save", () => ({text: this.text, base: this.base.tag}));
	}

	/** Put the file of before back. */
	restore() {
		return this.#write("restore", () => ({base: this.disk.tag}));
	}

	#write(what, body) {
		return this.#queue(async () => {
			const clean = what === "save" || !this.dirty, sent = body();
			let answer;
			try {
				answer = await post(`config/${what}`, sent, SAVE_MS);
			} catch (error) {
				if (error.status === 409 || isUnknown(error))
					await this.#look().catch(() => {});
				if (this.disk.text === this.text)
					this.base = this.disk; // it was saved, by whomever
				if (error.status === 422 && error.data?.problems)
					this.problems = error.data.problems;
				throw error;
			}
			await this.#look().catch(() => this.#believe(answer, sent));
			if (what === "save" && this.disk.tag === answer.tag)
				this.base = this.disk;
			else if (clean)
				await this.#follow();
			else if (this.disk.tag === answer.tag)
				this.base = this.disk; // the user did it, and sees the difference to it
			return answer;
		});
	}

	/* What was saved is on the disk, though the file cannot be looked at now. */
	#believe({tag}, {text}) {
		if (text === undefined)
			return;
		this.disk = {tag, text};
		this.saved = this.model;
	}

	async #look() {
		const {text, model, ...info} = await get("config");
		this.info = info;
		this.disk = {tag: info.tag, text};
		this.saved = model;
	}

	/* The file in place of the draft; undo brings the draft back. */
	async #follow() {
		const {text} = this.disk;
		this.#step(this.editable ? await post("config/draft", {do: "check", text})
			: {text, model: this.saved, problems: [], valid: true});
		this.base = this.disk;
	}

	/** Drop the draft for what the file has. */
	drop() {
		return this.#queue(async () => {
			await this.#look();
			await this.#follow();
		});
	}

	/** Put the changes of the draft on top of the file; the places where both differ. */
	rebase() {
		return this.#queue(async () => {
			const lines = (text) => text.split("\n");
			const {lines: both, clashes} = merge(lines(this.base.text), lines(this.text),
				lines(this.disk.text));
			this.#step(await post("config/draft", {do: "check", text: both.join("\n")}));
			if (this.model.driver.ItemCount !== undefined
				&& Number(this.model.driver.ItemCount) !== this.model.items.length)
				this.#take(await post("config/draft", {do: "set", name: "OwsDrv",
					keys: `ItemCount=${this.model.items.length}`, text: this.text}));
			this.base = this.disk;
			return clashes.filter(({mine}) => !mine.every((line) => /^\s*ItemCount\s/.test(line)));
		});
	}

	/** Lines that the draft changes in the file. */
	get changes() {
		return hunks(this.base.text.split("\n"), this.text.split("\n")).length;
	}
}

export const draft = new Draft();
