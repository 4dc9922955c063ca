// SPDX-License-Identifier: MIT
// Reads found devices again and again, and judges whose reading moves: the sensor in a warm hand.
import {get} from "./api.js";

const PAUSE_MS = 2000;   // between two rounds
const WINDOW_MS = 30000; // a reading is compared with those of so long
const STEP = 0.5;        // kelvin, and what else is measured, by which a reading has moved
const AT_ONCE = 8;       // devices of a request

/** The property of a device that a hand moves; null: it has none. */
export const readingOf = (device) =>
	device.properties.find((one) => one.word === "temperature" && !one.output) ?? null;

export class Watch {
	#timer = 0;
	#seen = new Map(); // id: [{time, value}]
	running = false;
	fault = "";

	/** devices(): those to read; heard(devices): these were read again. */
	constructor(devices, heard) {
		Object.assign(this, {devices, heard});
	}

	start() {
		this.running = true;
		this.#seen.clear();
		this.#round();
	}

	stop() {
		this.running = false;
		clearTimeout(this.#timer);
	}

	async #round() {
		const ids = document.hidden ? [] : this.devices().filter(readingOf).map(({id}) => id);
		for (let n = 0; n < ids.length && this.running; n += AT_ONCE)
			try {
				const some = ids.slice(n, n + AT_ONCE).join(",");
				const {devices} = await get("devices", {ids: some}, 30000);
				this.fault = "";
				for (const device of devices)
					this.#note(device);
				if (this.running)
					this.heard(devices);
			} catch (error) {
				this.fault = error.message;
				this.heard([]);
			}
		if (this.running)
			this.#timer = setTimeout(() => this.#round(), PAUSE_MS);
	}

	#note(device) {
		const text = readingOf(device)?.value, now = performance.now();
		const value = text === null || text === undefined || text === "" ? NaN : Number(text);
		const kept = (this.#seen.get(device.id) ?? []).filter(({time}) => now - time < WINDOW_MS);
		if (Number.isFinite(value))
			kept.push({time: now, value});
		this.#seen.set(device.id, kept);
	}

	/** How far the reading has moved; 0: it rests, or too little is known. */
	moved(id) {
		const kept = this.running ? this.#seen.get(id) ?? [] : [];
		if (kept.length < 2)
			return 0;
		const last = kept.at(-1).value, values = kept.map(({value}) => value);
		const far = [Math.min(...values), Math.max(...values)].map((value) => last - value)
			.sort((a, b) => Math.abs(b) - Math.abs(a))[0];
		return Math.abs(far) >= STEP ? far : 0;
	}
}
