// SPDX-License-Identifier: MIT
// What the page knows: the signals, their last values and a few before them, and whether it may be
// believed. Events: "signals" (others than before), "values" (detail: a set of signals), "trust"
// (why values are unknown, or that they are known again), "alarm".
import {Connection} from "./connection.js";
import {later} from "./dom.js";
import {askAll} from "./early.js";
import {keep} from "./spark.js";
import {UNKNOWN, qualityWords} from "./words.js";

const GAP_LEAST_MS = 100; // measurements that are nearer are one, in another event
const SURE_MS = 60000; // so long the event that came soonest says how the clocks differ

class Store extends EventTarget {
	info = null;
	signals = [];
	unknown = "The page has no values yet.";
	skew = 0; // clock of the server less that of the browser, ms
	#sure = -Infinity; // when an event said that
	#generation = null;
	#after = ""; // GENERATION:CURSOR of the signals; "": they were never there
	#waiting = []; // events that came while the signals were being fetched
	#loading = false;
	#again = false;
	#lost = null; // why owsd is lost
	#details = later(() => this.#load(), 1000);
	#retry = later(() => this.#load(), 2000);
	#acts = this.#actsOf();
	#connection = new Connection(this, Object.keys(this.#acts));

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

	/** The signal that has its name now; null: another one has. */
	same(shown) {
		const signal = this.find(shown.name);
		return signal?.path === shown.path ? signal : null;
	}

	async start() {
		await this.#load();
		this.#connection.start(this.#after);
	}

	#tell(type, detail) {
		this.dispatchEvent(new CustomEvent(type, {detail}));
	}

	/** Whether the connection can be trusted is another; ms since the last value that was true. */
	trust(since = 0) {
		const why = this.#lost || this.#connection.broken;
		if (why === this.unknown)
			return;
		if (why && !this.unknown)
			for (const signal of this.signals)
				this.#keep(signal, null, UNKNOWN, this.now() - since);
		this.unknown = why;
		this.#tell("trust");
	}

	// --- Events -----------------------------------------------------------------------------

	/** A stream has begun; complete: with what came after the signals that the page has. */
	opened(complete) {
		this.#lost = null;
		if (!complete)
			this.#load();
	}

	event(type, data) {
		if (this.#loading)
			this.#waiting.push(() => this.#acts[type](data));
		else
			this.#acts[type](data);
	}

	#actsOf() {
		// numbers of signals are those of one table: what is of another comes again with its list
		const ours = (data) => data.generation === this.#generation;
		return {
			values: (data) => ours(data) && this.#changes(data),
			alarm: (data) => ours(data) && this.#alarm(data),
			alive: () => {},
			missed: () => this.#load(), // alarms: the list has how they stand
			lost: (data) => {
				this.#lost = `${data.why || "owsd is not running"}.`;
				this.trust();
			},
			found: ({generation}) => {
				if (!this.unknown && generation === this.#generation)
					return; // it was fetched when the connection began
				this.#lost = null;
				this.#load();
			},
		};
	}

	// --- Signals and values -----------------------------------------------------------------

	async #load() {
		if (this.#connection.left)
			return; // all is fetched when the page is shown
		if (this.#loading) {
			this.#again = true;
			return;
		}
		this.#loading = true;
		try {
			const {source} = this.#connection, [info, list] = await askAll();
			if (source !== this.#connection.source)
				throw new Error("the connection broke meanwhile");
			this.info = info;
			this.#clock(info.now, true);
			this.#connection.works();
			this.#take(list);
			this.#after = `${list.generation}:${list.cursor}`;
		} catch (error) {
			this.#connection.fail(`The page cannot get the signals: ${error.message}.`);
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
			s.unit, s.decimals, s.device, s.path, s.description, s.min, s.max, s.group, s.terminal]));
		const same = this.#generation === list.generation
			|| (this.signals.length === list.signals.length
				&& shape(this.signals) === shape(list.signals));
		const old = new Map(this.signals.map((signal) => [signal.name, signal]));
		const fresh = list.signals.map((given) => {
			const before = old.get(given.name), signal = same ? before : null;
			// of another sensor, or in another unit, the last hour is not its own
			const own = before?.identity === given.identity && before?.unit === given.unit;
			const kept = signal ?? {recent: own ? before?.recent ?? [] : []};
			const {why, text, code, good} = given.quality;
			return this.#set(Object.assign(kept, {commanded: null, ...given, why, text}), given.value,
				code, good, given.age, now);
		});
		this.#generation = list.generation;
		this.signals = fresh;
		this.trust();
		this.#tell(same ? "values" : "signals", new Set(fresh));
		if (same)
			this.#tell("alarm");
	}

	/* heard: owsd has the value again. One that is not newer comes from a cache, in time. */
	#set(signal, value, code, good, age, now, heard = false) {
		const before = signal.measured;
		signal.value = value;
		signal.code = code;
		signal.good = Boolean(good);
		signal.measured = age === null || age === undefined ? null : now - age * 1000;
		const newer = signal.measured > before + GAP_LEAST_MS;
		if (before && !signal.output && (newer || (heard && good)))
			signal.gap = Math.max(newer ? (signal.measured - before) / 1000 : age,
				0.9 * (signal.gap ?? 0));
		this.#keep(signal, good && value !== null ? Number(value) : null, code);
		return signal;
	}

	#keep(signal, number, code, now = this.now()) {
		const t = number === null ? now : signal.measured ?? now;
		if (signal.type !== "string")
			keep(signal.recent, t, number, code, signal.watched);
	}

	/* An event that was long under way must not make its values look new; a clock may go slower. */
	#clock(now, sure = false) {
		const skew = now - Date.now(), here = performance.now();
		if (!sure && skew < this.skew && here - this.#sure < SURE_MS)
			return;
		this.skew = skew;
		this.#sure = here;
	}

	#changes({now, v}) {
		const changed = new Set();
		this.#clock(now);
		let alarms = false;
		for (const [i, value, code, good, age, alarm = null, why = null, commanded = null] of v) {
			const signal = this.signals[i]?.i === i ? this.signals[i]
				: this.signals.find((one) => one.i === i);
			if (!signal)
				continue;
			if (signal.code !== code) {
				signal.text = qualityWords(code);
				if (!good || !signal.good)
					this.#details(); // "simulated" comes with the list
			}
			alarms ||= alarm !== signal.alarm;
			Object.assign(signal, {alarm, why, commanded});
			changed.add(this.#set(signal, value, code, good, age, now, true));
		}
		if (changed.size)
			this.#tell("values", changed);
		if (alarms)
			this.#tell("alarm");
	}

	#alarm({i, alarm}) {
		const signal = this.signals.find((one) => one.i === i);
		if (signal && alarm !== undefined) {
			signal.alarm = alarm || null; // as lists and rows have it
			this.#tell("values", new Set([signal]));
		}
		this.#tell("alarm");
	}
}

export const store = new Store();
