// SPDX-License-Identifier: MIT
// What the page knows: the signals, their last values and a few before them, and whether it may be
// believed. Events: "signals" (others than before), "values" (detail: a set of signals), "trust"
// (why values are unknown, or that they are known again), "alarm". A page that is hidden holds no
// connection; it asks for all anew when it is shown.
import {get} from "./api.js";
import {later} from "./dom.js";
import {askAll} from "./early.js";
import {keep} from "./spark.js";
import {way} from "./way.js";
import {UNKNOWN, qualityWords} from "./words.js";

const FAILED_MS = 3000; // a connection that has failed for so long makes values unknown
const SILENT_MS = 5000; // without an event for so long, the page asks whether the server lives
const DEAD_MS = 35000;  // and after so long believes nothing: owsd-web sends one each 15 s
const APART_MS = 5000;  // two clocks that go apart by so much: one stood, or the other was set

/** Why values are unknown when the page is shown again, until it has them. */
export const HIDDEN = "The page was hidden and asks for the values anew.";

class Store extends EventTarget {
	info = null;
	signals = [];
	unknown = "The page has no values yet.";
	skew = 0; // clock of the server less that of the browser, ms
	#generation = null;
	#source = null;
	#after = ""; // where the first stream begins: GENERATION:CURSOR of the signals, if they are there
	#waiting = []; // events that came while the signals were being fetched
	#loading = false;
	#again = false;
	#heard = 0;
	#asked = 0;
	#apart = Date.now() - performance.now();
	#failed = 0; // timer
	#left = null; // since when the page is hidden and has no stream, as performance.now()
	#lost = null; // why owsd is lost
	#broken = "The page has no values yet."; // why the connection cannot be trusted
	#details = later(() => this.#load(), 1000);
	#retry = later(() => this.#load(), 2000);

	/** The clock of the server, ms. */
	now() {
		return Date.now() + this.skew;
	}

	/** Seconds since the measurement; null: never measured. */
	age(signal) {
		return signal.measured === null ? null : (this.now() - signal.measured) / 1000;
	}

	/** The code of the quality that the user sees. */
	quality(signal) {
		return this.unknown ? UNKNOWN : signal.code;
	}

	value(signal) {
		return this.unknown || !signal.good ? null : signal.value;
	}

	find(name) {
		return this.signals.find((signal) => signal.name === name);
	}

	async start() {
		await this.#load();
		if (document.hidden)
			this.#leave();
		else
			this.#connect();
		setInterval(() => this.#watch(), 1000);
		// a page that the browser keeps for the way back is left, too
		const leave = () => this.#leave(), back = () => this.#comeBack();
		document.addEventListener("visibilitychange", () => document.hidden ? leave() : back());
		window.addEventListener("pagehide", leave);
		window.addEventListener("pageshow", back);
	}

	#tell(type, detail) {
		this.dispatchEvent(new CustomEvent(type, {detail}));
	}

	/* since: how long ago the last value came that was true, ms */
	#trust(since = 0) {
		const why = this.#lost || this.#broken;
		if (why === this.unknown)
			return;
		if (why && !this.unknown)
			for (const signal of this.signals)
				this.#keep(signal, null, UNKNOWN, this.now() - since);
		this.unknown = why;
		this.#tell("trust");
	}

	// --- Connection -------------------------------------------------------------------------

	#connect() {
		this.#source?.close();
		const acts = this.#acts();
		const after = this.#after;
		const path = after ? `api/events?after=${after}` : "api/events";
		let complete = Boolean(after); // what the page has, and this stream: nothing is between
		this.#after = "";
		const source = way.events(path, Object.keys(acts), {
			opened: () => {
				this.#lost = null;
				this.#heard = performance.now();
				if (complete)
					this.#works();
				else
					this.#load();
				complete = false;
			},
			failed: (ended, why) => {
				this.#fail(why ? `The page has ${why}.`
					: "The connection to owsd-web has failed.");
				if (ended)
					setTimeout(() => source === this.#source && this.#connect(), 2000);
			},
			event: (type, text, id) => {
				if (this.#slept())
					return; // it may have waited here for hours
				this.#heard = performance.now();
				const data = text ? JSON.parse(text) : {};
				data.generation ??= Number((id || after).split(":")[0]);
				if (this.#loading)
					this.#waiting.push(() => acts[type](data));
				else
					acts[type](data);
			},
		});
		this.#source = source;
	}

	/** What each kind of event does. */
	#acts() {
		// numbers of signals are those of one table: what is of another comes again with its list
		const ours = (data) => data.generation === this.#generation;
		return {
			values: (data) => ours(data) && this.#changes(data),
			alarm: (data) => ours(data) && this.#alarm(data),
			alive: () => {},
			missed: () => this.#load(), // alarms: the list has how they stand
			lost: (data) => {
				this.#lost = `${data.why || "owsd does not run"}.`;
				this.#trust();
			},
			found: ({generation}) => {
				if (!this.unknown && generation === this.#generation)
					return; // it was fetched when the connection began
				this.#lost = null;
				this.#load();
			},
		};
	}

	#fail(why) {
		this.#failed ||= setTimeout(() => {
			this.#broken = why;
			this.#trust();
		}, FAILED_MS);
	}

	#works() {
		clearTimeout(this.#failed);
		this.#failed = 0;
		this.#broken = null;
	}

	#doubt(why, since = 0) {
		this.#heard = performance.now();
		this.#broken = why;
		this.#trust(since);
		this.#connect();
	}

	/*
	 * Over HTTP/1.1 a browser has six connections to one server, for all its tabs and for all that
	 * they ask. Those that nobody looks at leave them to the others. What a page had counts for as
	 * long as after a failure.
	 */
	#leave() {
		if (this.#left !== null)
			return;
		this.#left = performance.now();
		this.#source?.close();
		this.#source = null;
		this.#after = "";
		this.#fail(HIDDEN);
	}

	#comeBack() {
		if (this.#left === null || document.hidden)
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
		const now = performance.now(), heard = this.#heard, source = this.#source;
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
			const {since} = this.info ?? {};
			this.info = await get("info");
			// another process answers, and the stream of the one before it may hang
			if (this.info.since !== since && source === this.#source)
				this.#connect();
		} catch (error) {
			if (heard === this.#heard && source === this.#source)
				this.#doubt(`The page has ${error.message}.`);
		}
	}

	// --- Signals and values -----------------------------------------------------------------

	async #load() {
		if (this.#left !== null)
			return; // all is fetched when the page is shown
		if (this.#loading) {
			this.#again = true;
			return;
		}
		this.#loading = true;
		try {
			const source = this.#source, [info, list] = await askAll();
			if (source !== this.#source)
				throw new Error("the connection broke meanwhile");
			this.info = info;
			this.skew = info.now - Date.now();
			this.#works();
			this.#take(list);
			if (!this.#source)
				this.#after = `${list.generation}:${list.cursor}`;
		} catch (error) {
			this.#fail(`The page cannot get the signals: ${error.message}.`);
			this.#retry();
		}
		this.#loading = false;
		for (const act of this.#waiting.splice(0))
			act();
		if (this.#again) {
			this.#again = false;
			this.#load();
		}
	}

	#take(list) {
		const now = this.now();
		const shape = (signals) => JSON.stringify(signals.map((s) => [s.i, s.name, s.type, s.output,
			s.unit, s.decimals, s.device, s.path, s.description, s.min, s.max]));
		const same = this.#generation === list.generation
			|| (this.signals.length === list.signals.length
				&& shape(this.signals) === shape(list.signals));
		const old = new Map(this.signals.map((signal) => [signal.name, signal]));
		const fresh = list.signals.map((given) => {
			const signal = same ? old.get(given.name) : null;
			return this.#set(Object.assign(signal ?? {recent: old.get(given.name)?.recent ?? []},
				{...given, why: given.quality.why, remedy: given.quality.remedy,
					text: given.quality.text}), given.value,
			given.quality.code, given.quality.good, given.age, now);
		});
		this.#generation = list.generation;
		this.signals = fresh;
		this.#trust();
		this.#tell(same ? "values" : "signals", new Set(fresh));
		if (same)
			this.#tell("alarm");
	}

	#set(signal, value, code, good, age, now) {
		signal.value = value;
		signal.code = code;
		signal.good = Boolean(good);
		signal.measured = age === null || age === undefined ? null : now - age * 1000;
		this.#keep(signal, good && value !== null ? Number(value) : null, code);
		return signal;
	}

	#keep(signal, number, code, now = this.now()) {
		const t = number === null ? now : signal.measured ?? now;
		if (signal.type !== "string")
			keep(signal.recent, t, number, code, signal.watched);
	}

	#changes({now, v}) {
		const changed = new Set();
		// an event that was long under way must not make its values look new
		this.skew = Math.max(this.skew, now - Date.now());
		for (const [i, value, code, good, age] of v) {
			const signal = this.signals[i]?.i === i ? this.signals[i]
				: this.signals.find((one) => one.i === i);
			if (!signal)
				continue;
			if (signal.code !== code) {
				signal.text = qualityWords(code);
				signal.why = signal.remedy = null;
				if (!good)
					this.#details(); // the reason in words comes with the list
			}
			changed.add(this.#set(signal, value, code, good, age, now));
		}
		if (changed.size)
			this.#tell("values", changed);
	}

	#alarm({i, alarm}) {
		const signal = this.signals.find((one) => one.i === i);
		if (signal && alarm !== undefined) {
			signal.alarm = alarm;
			this.#tell("values", new Set([signal]));
		}
		this.#tell("alarm");
	}
}

export const store = new Store();
