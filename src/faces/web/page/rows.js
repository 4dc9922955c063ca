// SPDX-License-Identifier: MIT
// Fills the groups or the list of the view Live and paints their rows: what is on the screen at once, the rest
// in short turns, so that thousands of rows hold up neither the first frame nor a click.

const CHUNK = 32;      // rows of a part at most
const ROW_HEIGHT = 35; // of a row that was not painted yet, px
const TURN_MS = 6;     // of a turn; a frame has 16
const LATER_MS = 50;   // the first turn; the first frame is on the screen by then

/** Rows in parts: what is off the screen the browser does not lay out. */
export function chunked(rows) {
	const parts = [];
	for (let n = 0; n < rows.length; n += CHUNK)
		parts.push(rows.slice(n, n + CHUNK));
	return parts;
}

/** Have a body keep the place of its rows until it is filled. */
export function reserve(body, members) {
	body.rows_ = members;
	body.filled_ = false;
	const height = `${ROW_HEIGHT * members.length}px`;
	body.style.containIntrinsicSize = `auto ${height}`;
	body.style.minHeight = height;
}

export function fill(body) {
	if (body.filled_)
		return;
	body.filled_ = true;
	body.style.minHeight = "";
	body.append(...body.rows_.map((row) => row.node));
}

let turn = 0, left = [];

/** Fill what the screen shows, with some more, and what is built; then the rest, in turns. */
export function fillAll(bodies) {
	const enough = innerHeight / ROW_HEIGHT + CHUNK / 4;
	let rows = 0;
	left = [];
	for (const body of bodies) {
		if (rows >= enough && !body.rows_.every((row) => row.built)) {
			left.push(body);
			continue;
		}
		fill(body);
		rows += body.rows_.filter((row) => !row.hidden).length;
	}
	left.reverse();
	turn ||= setTimeout(go, LATER_MS);
}

function go() {
	const end = performance.now() + TURN_MS;
	while (left.length && performance.now() < end)
		fill(left.pop());
	turn = left.length ? setTimeout(go, 10) : 0;
}

/**
 * Paints rows of which something changed, before the next frame: those that can be seen first, then
 * the others for as long as a turn has; the rest comes in the frames after.
 */
export class Painter {
	#dirty = new Set();
	#frame = 0;
	#visible;
	#done;

	/** visible(): the bodies that can be seen; done(): some were painted. */
	constructor(visible, done) {
		this.#visible = visible;
		this.#done = done;
	}

	clear() {
		this.#dirty.clear();
	}

	soon(rows) {
		for (const row of rows)
			if (row?.built) // else it is painted when it is built
				this.#dirty.add(row);
		this.#frame ||= requestAnimationFrame(() => this.#paint());
	}

	#paint() {
		const end = performance.now() + TURN_MS;
		const one = (row) => {
			this.#dirty.delete(row);
			row.paint();
		};
		this.#frame = 0;
		for (const body of this.#visible())
			for (const row of body.rows_)
				if (this.#dirty.has(row))
					one(row);
		for (const row of this.#dirty) {
			if (performance.now() >= end)
				break;
			one(row);
		}
		if (this.#dirty.size)
			this.#frame = requestAnimationFrame(() => this.#paint());
		this.#done();
	}
}
