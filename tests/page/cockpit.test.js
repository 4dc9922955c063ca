// SPDX-License-Identifier: MIT
// The stream of events, as it comes in pieces within Cockpit.
import assert from "node:assert/strict";
import {test} from "node:test";
import "./browser.js";
import {reader, way} from "./page/cockpit.js";

const TEXT = 'id: 7:40\nevent: found\ndata: {"a": 1}\n\n: a comment\nevent: alive\ndata: {}\n\n';
const EVENTS = [["found", '{"a": 1}', "7:40"], ["alive", "{}", "7:40"]];

function read(...pieces) {
	const got = [], take = reader((...event) => got.push(event));
	pieces.forEach(take);
	return got;
}

test("events are the same in whatever pieces they come", () => {
	for (let n = 0; n <= TEXT.length; n++)
		assert.deepEqual(read(TEXT.slice(0, n), TEXT.slice(n)), EVENTS, String(n));
	assert.deepEqual(read(...TEXT), EVENTS);
});

test("an event that has not ended is none", () =>
	assert.deepEqual(read(TEXT.slice(0, -1)), EVENTS.slice(0, 1)));

test("lines of data are joined, and one blank behind the colon is taken off", () =>
	assert.deepEqual(read("data: a\ndata:  b\ndata\n\n"), [["message", "a\n b\n", ""]]));

test("an event without data is none", () => assert.deepEqual(read("event: alive\n\n"), []));

/* A Cockpit: names() of the sockets that are there; answers with the path of the socket. */
const cockpitOf = (names) => ({
	channel: () => ({addEventListener: (type, call) => setImmediate(() => {
		for (const name of type === "message" ? names() : [])
			call(null, JSON.stringify({event: "present", path: `${name}.web`}));
		if (type === "close")
			call(null, {});
	})}),
	http: (path) => ({request: () => names().some((name) => path.endsWith(`/${name}.web`))
		? Promise.resolve(path) : Promise.reject({problem: "not-found"})}),
});

test("a page shows one instance: it does not go to another when the socket of that one is gone", async () => {
	let names = ["A", "B"];
	sessionStorage.setItem("owsd.instance", "B");
	const {ask} = way(cockpitOf(() => names), 1000);
	assert.match((await ask("api/info")).text, /B\.web$/);
	names = ["A"];
	for (let n = 0; n < 3; n++)
		await assert.rejects(ask("api/info"), /there is no socket .*B\.web/);
	names = ["A", "B"];
	assert.match((await ask("api/info")).text, /B\.web$/);
	sessionStorage.setItem("owsd.instance", "C");
	assert.match((await way(cockpitOf(() => names), 1000).ask("x")).text, /A\.web$/, "the chosen one is not there");
	names = [];
	await assert.rejects(way(cockpitOf(() => names), 1000).ask("x"), /no socket .*\*\.web/);
});
