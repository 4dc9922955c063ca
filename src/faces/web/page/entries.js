// SPDX-License-Identifier: MIT
// Entries of the journal for a window that moves on: only what is new is asked for.
import {get} from "./api.js";
import {msOf} from "./words.js";

export class Entries {
	#all = [];
	#since = Infinity;

	/** All since that time (ms), newest first, at most so many. */
	async from(since, most) {
		const known = since >= this.#since && this.#all.length > 0;
		const after = known ? msOf(this.#all[0].time) : Math.round(since);
		const {entries = []} = await get("journal", {since: after, n: most});
		this.#all = known ? [...entries, ...this.#all.filter(({time}) => msOf(time) < after)]
			.slice(0, most) : entries;
		this.#since = known ? this.#since : since;
		return this.#all;
	}
}
