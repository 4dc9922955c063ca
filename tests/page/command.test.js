// SPDX-License-Identifier: MIT
// The control of an output: what is sent, and what is said of it.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {pass, server, settle} from "./browser.js";
import "./document.js";

const GOOD = 0xc0, DIFFERS = 0x1c;
let store, control, wrong, list = [], generation = 1;

server.answers["api/info"] = () => ({now: Date.now(), since: 1, writable: true});
server.answers["api/signals"] = () => ({generation, cursor: 1, now: Date.now(), signals: list});

const signal = (i, name, more) => ({i, name, type: "double", output: true, path: `/${name}`,
	decimals: null, age: 0, quality: {code: GOOD, good: true, why: null, text: "good"}, ...more});
const sent = () => server.asked.filter(({path}) => path === "api/set").map(({body}) => body);
const dialog = () => document.getElementById("command");
const field = () => document.getElementById("command-value");

/* A control on the page. */
function shown(name) {
	const one = store.find(name), made = control(one);
	document.body.append(made.node);
	made.paint(store.value(one));
	return made;
}

async function fetched(...signals) {
	list = signals;
	generation++;
	store.event("missed", {});
	await settle();
}

beforeEach(async () => {
	list = [signal(0, "pump", {type: "bool", value: false}), signal(1, "dose", {value: 7.49})];
	if (!store) {
		({store} = await import("./page/store.js"));
		({control, wrong} = await import("./page/command.js"));
		await store.start();
	}
	await fetched(...list);
	assert.equal(store.unknown, null);
	server.asked.length = 0;
	server.answers["api/set"] = {result: "done"};
});

test("a switch sends the other state, and says that it was taken for some seconds", async () => {
	const {node, result} = shown("pump");
	node.find((one) => one.getAttribute("role") === "switch").click();
	await settle();
	assert.deepEqual(sent(), [{name: "pump", value: true}]);
	assert.equal(result.textContent, "on: taken");
	await pass(8100);
	assert.equal(result.textContent, "");
});

test("the dialog begins with all digits, so that what is not touched stays", async () => {
	for (const [decimals, value] of [[null, 7.49], [1, 7.4912345678]]) {
		await fetched(signal(0, "pump", {type: "bool", value: false}), signal(1, "dose", {decimals, value}));
		server.asked.length = 0;
		shown("dose").node.withText("Set\u2026").click();
		await settle();
		assert.equal(field().value, String(value));
		dialog().firstChild.submit();
		await settle();
		assert.deepEqual(sent(), [{name: "dose", value}]);
	}
});

test("a switch that reads otherwise stands at what owsd was commanded, not at what was refused here",
	async () => {
		server.answers["api/set"] = 403;
		const {node, paint, result} = shown("pump"), one = store.find("pump");
		const toggle = node.find((part) => part.getAttribute("role") === "switch");
		toggle.click();
		await settle();
		assert.equal(result.textContent, "on: refused: no");
		Object.assign(one, {code: DIFFERS, good: false, commanded: false});
		paint(store.value(one));
		assert.ok(!toggle.hidden && toggle.classList.contains("is-missed"));
		assert.equal(toggle.getAttribute("aria-checked"), "false");
		one.commanded = null;
		paint(store.value(one));
		assert.ok(toggle.hidden && !node.withText("Set on").hidden, "nobody knows: two buttons");
	});

test("what a proxy lost may have been done, what owsd-web answers with a reason was not", async () => {
	for (const [answer, words] of [[502, "on: not known whether it was done: no"],
		[504, "on: not known whether it was done: no"], [503, "on: refused: no"],
		[() => { throw new Error("cut"); }, "on: not known whether it was done: no connection to owsd-web"]]) {
		server.answers["api/set"] = answer;
		const {node, result} = shown("pump");
		node.find((one) => one.getAttribute("role") === "switch").click();
		await settle();
		assert.equal(result.textContent, words);
	}
});

const swapped = () => [signal(0, "pump", {type: "bool", value: true, path: "/valve"}),
	signal(1, "valve", {type: "bool", value: false, path: "/pump"})];

test("a click that is confirmed after a reload goes to no other device of that name", async () => {
	await fetched(signal(0, "pump", {type: "bool", value: false, confirm: true}), list[1]);
	const {node, result} = shown("pump");
	server.asked.length = 0;
	node.find((one) => one.getAttribute("role") === "switch").click();
	await settle();
	assert.match(dialog().textContent, /It is off now/);
	await fetched(...swapped());
	assert.match(dialog().textContent, /another signal/);
	dialog().firstChild.submit();
	await settle();
	assert.deepEqual(sent(), []);
	assert.match(result.textContent, /not set: it is another signal since a reload/);
});

test("a dialog that stands open says what is now", async () => {
	shown("dose").node.withText("Set\u2026").click();
	await settle();
	assert.match(dialog().textContent, /It is 7\.49 now/);
	await fetched(list[0], signal(1, "dose", {value: 8}));
	assert.match(dialog().textContent, /It is 8 now/);
	dialog().close("no");
});

test("the answer to a command stands in the row that came in place of its own", async () => {
	let answer;
	server.answers["api/set"] = () => new Promise((resolve) => { answer = resolve; });
	const old = shown("pump"), other = shown("dose");
	old.node.find((one) => one.getAttribute("role") === "switch").click();
	await settle();
	old.node.remove();
	const made = shown("pump");
	answer({status: 403, error: "ControlAllow"});
	await settle();
	assert.equal(made.result.textContent, "on: refused: ControlAllow");
	assert.equal(other.result.textContent, "");
});

test("what the bus has not confirmed in time is taken when the value is there", async () => {
	server.answers["api/set"] = {result: "pending"};
	const {node, result, paint} = shown("pump");
	node.find((one) => one.getAttribute("role") === "switch").click();
	await settle();
	paint(false);
	paint(null);
	assert.equal(result.textContent, "on: not confirmed yet");
	paint(true);
	assert.equal(result.textContent, "on: taken");
	await pass(8100);
	paint(true);
	assert.equal(result.textContent, "");
});

test("a number with a comma is none, nor is a text, an end without limits, or what is out of range", () => {
	for (const [type, text, range] of [["double", "0,5"], ["double", "1,000"], ["double", "x"], ["double", " "],
		["double", "1e999"], ["word", "1.5"], ["byte", "256", [0, 255]]])
		assert.notEqual(wrong({type}, text, range), "", text);
	for (const [type, text, range] of [["double", "0.5"], ["double", " 7 "], ["string", "0,5"], ["string", ""],
		["word", "0x5"], ["byte", "255", [0, 255]]])
		assert.equal(wrong({type}, text, range), "", text);
});
