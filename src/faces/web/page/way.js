// SPDX-License-Identifier: MIT
// The way to owsd-web: that of a browser, or within Cockpit that of Cockpit. A way has
//   ask(path, {method, headers, body, patience}): {status, text}, or an error that says why
//     there is none
//   events(path, types, {opened(), failed(ended, why), event(type, data, id)}): something to
//     close(). It goes on by itself where it was, unless it has ended
//   instances(): the names of those to choose from; choose(name)
// All addresses are relative, so that the page works below any prefix.

const PATIENCE = 10000;

const browser = {
	async ask(path, {patience = PATIENCE, ...options}) {
		let answer;
		try {
			answer = await fetch(path, {
				cache: "no-store", credentials: "same-origin",
				signal: AbortSignal.timeout(patience), ...options,
			});
		} catch (error) {
			throw new Error(error.name === "TimeoutError" ? "owsd-web does not answer in time"
				: "no connection to owsd-web");
		}
		return {status: answer.status, text: await answer.text()};
	},

	events(path, types, {opened, failed, event}) {
		const source = new EventSource(path);
		source.onopen = opened;
		source.onerror = () => failed(source.readyState === EventSource.CLOSED);
		for (const type of types)
			source.addEventListener(type, (e) => event(type, e.data, e.lastEventId));
		return source;
	},

	async instances() {
		return [];
	},
};

export const way = window.cockpit ? (await import("./cockpit.js")).way(window.cockpit, PATIENCE)
	: browser;
