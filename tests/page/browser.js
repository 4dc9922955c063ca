// SPDX-License-Identifier: MIT
// What modules of the page find in place of a browser: a clock that the test moves, a server that
// it plays, a document that is hidden or shown. Import this first, and the module then.

const real = {setImmediate, setTimeout};
const timers = new Map();
let number = 0;

/** Time, ms: since the page was loaded, and what the clock of the computer is ahead of that. */
export const clock = {now: 1000, wall: 1.7e12};

export async function settle() {
	for (let n = 0; n < 10; n++)
		await new Promise((resolve) => real.setImmediate(resolve));
}

/** Let so much time pass, with all timers that end in it. */
export async function pass(ms) {
	const end = clock.now + ms;
	await settle();
	for (;;) {
		const [first] = [...timers].filter(([, one]) => one.at <= end)
			.sort(([, a], [, b]) => a.at - b.at);
		if (!first)
			break;
		const [key, {at, every, call}] = first;
		clock.now = Math.max(clock.now, at);
		if (every)
			timers.get(key).at += every;
		else
			timers.delete(key);
		call();
		await settle();
	}
	clock.now = end;
}

const start = (call, ms, every) => {
	timers.set(++number, {at: clock.now + ms, every, call});
	return number;
};
globalThis.setTimeout = (call, ms = 0) => start(call, ms, 0);
globalThis.setInterval = (call, ms) => start(call, ms, ms);
globalThis.clearTimeout = globalThis.clearInterval = (key) => timers.delete(key);
Object.defineProperty(globalThis, "performance", {value: {now: () => clock.now}});
Date.now = () => clock.wall + clock.now;
globalThis.CustomEvent ??= class extends Event { // node 18 has none
	constructor(type, {detail} = {}) {
		super(type);
		this.detail = detail;
	}
};

const fired = (target, type, more) => target.dispatchEvent(Object.assign(new Event(type), more));

globalThis.window = new EventTarget();
globalThis.document = Object.assign(new EventTarget(), {hidden: false});
globalThis.location = {pathname: "/"};
const kept = new Map();
globalThis.sessionStorage = {
	getItem: (key) => kept.get(key) ?? null,
	setItem: (key, text) => kept.set(key, String(text)),
	removeItem: (key) => kept.delete(key),
};

export function hide(hidden = true) {
	document.hidden = hidden;
	fired(document, "visibilitychange");
}

export const pagehide = () => fired(window, "pagehide", {persisted: true});
export const pageshow = () => fired(window, "pageshow", {persisted: true});

/**
 * answers: path without its query: what the server answers, or a function of (query, body) that
 * returns or throws it; a number is a status. asked: all that it was asked.
 */
export const server = {answers: {}, asked: []};

globalThis.fetch = async (address, {method = "GET", body, headers} = {}) => {
	const {pathname, searchParams} = new URL(address, "http://a/");
	const path = pathname.slice(1), answer = server.answers[path];
	server.asked.push({path, query: searchParams, method, headers,
		body: body === undefined ? undefined : JSON.parse(body)});
	if (answer === undefined)
		return {status: 404, text: async () => '{"error": "there is no such path"}'};
	const given = typeof answer === "function"
		? await answer(searchParams, server.asked.at(-1).body) : answer;
	const {status = 200, ...data} = typeof given === "number" ? {status: given, error: "no"} : given;
	return {status, text: async () => JSON.stringify(data)};
};

/** Streams of events that the page has opened, the newest last. */
export const streams = [];

globalThis.EventSource = class extends EventTarget {
	static CLOSED = 2;
	readyState = 0;

	constructor(address) {
		super();
		this.address = address;
		streams.push(this);
	}

	close() {
		this.readyState = 2;
	}

	opened() {
		this.readyState = 1;
		this.onopen();
	}

	failed(ended = false) {
		this.readyState = ended ? 2 : 0;
		this.onerror();
	}

	sends(type, data, lastEventId = "") {
		if (this.readyState !== 2)
			this.dispatchEvent(Object.assign(new Event(type),
				{data: JSON.stringify(data), lastEventId}));
	}
};

export const open = () => streams.filter((one) => one.readyState !== 2);
