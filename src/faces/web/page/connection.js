// SPDX-License-Identifier: MIT
// The connection to owsd-web: a stream of events, and whether it may be believed. A page that is
// hidden has none, and opens one when it is shown.
import {get} from "./api.js";
import {way} from "./way.js";

const FAILED_MS = 3000; // a connection that has failed for so long makes values unknown
const SILENT_MS = 5000; // without an event for so long, the page asks whether the server lives
const DEAD_MS = 35000;  // and after so long believes nothing: owsd-web sends one each 15 s
const APART_MS = 5000;  // two clocks that go apart by so much: one stood, or the other was set

/** Why values are unknown when the page is shown again, until it has them. */
export const HIDDEN = "The page was hidden and asks for the values anew.";

export class Connection {
	broken = "The page has no values yet."; // why it cannot be trusted; null: it can
	source = null;
	#store;
	#types;
	#heard = 0;
	#asked = 0;
	#apart = Date.now() - performance.now();
	#failed = 0; // timer
	#left = null; // since when the page is hidden, as performance.now()

	/** store: info, trust(since), opened(complete), event(type, data); types: of events */
	constructor(store, types) {
		this.#store = store;
		this.#types = types;
	}

	/** The page is hidden. */
	get left() {
		return this.#left !== null;
	}

	/** after: GENERATION:CURSOR of the signals that the page has; "": none. */
	start(after) {
		if (document.hidden)
			this.#leave();
		else
			this.#connect(after);
		setInterval(() => this.#watch(), 1000);
		// a page that the browser keeps for the way back is left, too
		const leave = () => this.#leave(), back = () => this.#comeBack();
		document.addEventListener("visibilitychange", () => document.hidden ? leave() : back());
		window.addEventListener("pagehide", leave);
		window.addEventListener("pageshow", back);
	}

	#connect(after = "") {
		this.source?.close();
		const path = after ? `api/events?after=${after}` : "api/events";
		let complete = Boolean(after); // what the page has, and this stream: nothing is between
		const source = way.events(path, this.#types, {
			opened: () => {
				this.#heard = performance.now();
				if (complete)
					this.works();
				this.#store.opened(complete);
				complete = false;
			},
			failed: (ended, why) => {
				this.fail(why ? `The page has ${why}.`
					: "The connection to owsd-web has failed.");
				if (ended)
					setTimeout(() => source === this.source && this.#connect(), 2000);
			},
			event: (type, text, id) => {
				if (this.#slept())
					return; // it may have waited here for hours
				this.#heard = performance.now();
				const data = text ? JSON.parse(text) : {};
				data.generation ??= Number((id || after).split(":")[0]);
				this.#store.event(type, data);
			},
		});
		this.source = source;
	}

	/** Something failed: it cannot be trusted if it does not work within three seconds. */
	fail(why) {
		this.#failed ||= setTimeout(() => {
			this.broken = why;
			this.#store.trust();
		}, FAILED_MS);
	}

	works() {
		clearTimeout(this.#failed);
		this.#failed = 0;
		this.broken = null;
	}

	#doubt(why, since = 0) {
		this.#heard = performance.now();
		this.broken = why;
		this.#store.trust(since);
		this.#connect();
	}

	// --- Hidden pages -----------------------------------------------------------------------

	/*
	 * Over HTTP/1.1 a browser has six connections to one server, for all its tabs and for all that
	 * they ask. Those that nobody looks at leave them to the others. What a page had counts for as
	 * long as after a failure.
	 */
	#leave() {
		if (this.left)
			return;
		this.#left = performance.now();
		this.source?.close();
		this.source = null;
		this.fail(HIDDEN);
	}

	#comeBack() {
		if (!this.left || document.hidden)
			return;
		const since = performance.now() - this.#left;
		this.#left = null;
		if (this.#slept())
			return; // that connects
		if (since < FAILED_MS) {
			this.#connect();
			return;
		}
		clearTimeout(this.#failed);
		this.#failed = 0; // a connection that fails now has its own words
		this.#doubt(HIDDEN, since);
	}

	// --- Streams that are dead --------------------------------------------------------------

	/* Of two clocks one stands while the computer sleeps, and the other can be set. */
	#slept() {
		const apart = Date.now() - performance.now(), by = Math.abs(apart - this.#apart);
		this.#apart = apart;
		if (by > APART_MS)
			this.#doubt("This computer slept, or its clock was set.");
		return by > APART_MS;
	}

	/*
	 * A connection can be dead without an error: a cable pulled, a machine asleep. That owsd-web
	 * answers another request proves nothing of the stream.
	 */
	async #watch() {
		const now = performance.now(), heard = this.#heard, {source} = this;
		if (!heard || !source || this.#slept() || now - heard < SILENT_MS)
			return;
		if (now - heard >= DEAD_MS) {
			this.#doubt("Nothing came from owsd-web for half a minute.");
			return;
		}
		if (now - this.#asked < SILENT_MS)
			return;
		this.#asked = now;
		try {
			const {since} = this.#store.info ?? {};
			this.#store.info = await get("info");
			// another process answers, and the stream of the one before it may hang
			if (this.#store.info.since !== since && source === this.source)
				this.#connect();
		} catch (error) {
			if (heard === this.#heard && source === this.source)
				this.#doubt(`The page has ${error.message}.`);
		}
	}
}
