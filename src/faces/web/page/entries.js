// SPDX-License-Identifier: MIT
// Entries of the journal for a window that moves on: only what is new is asked for.
import {get} from "./api.js";
import {SLEW_MS, clockWasSet, entryOf} from "./happened.js";
import {msOf} from "./words.js";

export class Entries {
	#all = [];
	#since = Infinity;

	/** All since that time (ms), newest first, at most so many. */
	async from(since, most) {
		const [newest] = this.#all, known = since >= this.#since && newest !== undefined;
		const after = known ? msOf(newest.time) - SLEW_MS : Math.round(since);
		const {entries = []} = await get("journal", {since: after, n: most});
		if (known && (clockWasSet(entries, this.#all) || Number.isInteger(newest.number)
			&& !entries.some((one) => entryOf(one) === entryOf(newest)))) {
			this.#all = [];
			return this.from(since, most);
		}
		this.#all = known ? [...entries, ...this.#all.filter(({time}) => msOf(time) < after)]
			.slice(0, most) : entries;
		this.#since = known ? this.#since : since;
		return this.#all;
	}
}
