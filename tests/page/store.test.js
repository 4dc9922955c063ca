// SPDX-License-Identifier: MIT
// The page believes a value only while it is connected and in time; hidden it is not connected.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {clock, hide, open, pagehide, pageshow, pass, server, settle, streams} from "./browser.js";
import {UNKNOWN} from "./page/words.js";

const GOOD = 0xc0, ABSENT = 0x08;
const list = {generation: 7, cursor: 40, signals: []};
let value = 21, store, HIDDEN;

server.answers["api/info"] = () => ({now: Date.now(), since: 1, instance: "a"});
server.answers["api/signals"] = () => ({...list, now: Date.now(), signals: [
	{i: 0, name: "room", type: "double", value, quality: {code: GOOD, good: true, why: null,
		text: "good"}, age: 0, alarm: null},
	{i: 1, name: "attic", type: "double", value: null, quality: {code: ABSENT, good: false,
		why: "no such device there", text: "device absent"}, age: null, alarm: null}]});

/* What the page shows of the room. */
const room = () => store.value(store.find("room"));
const asked = (path) => server.asked.filter((one) => one.path === path).length;

async function found() {
	streams.at(-1).opened();
	streams.at(-1).sends("found", {now: Date.now(), generation: list.generation});
	await settle();
}

const values = (...rows) => streams.at(-1).sends("values",
	{now: Date.now(), generation: list.generation, v: rows});

/* A page that is shown and connected, of which all is known. */
beforeEach(async () => {
	if (!store) {
		({HIDDEN} = await import("./page/connection.js"));
		({store} = await import("./page/store.js"));
		await store.start();
	}
	value = 21;
	hide(false);
	await settle();
	await found();
	streams.at(-1).sends("found", {now: Date.now(), generation: ++list.generation});
	await pass(100);
	assert.equal(store.unknown, null);
	server.asked.length = 0;
});

test("the first stream begins where the signals that were fetched end", () =>
	assert.equal(streams[0].address, "api/events?after=7:40"));

test("a value that is not good is no number", () => {
	assert.equal(room(), 21);
	assert.equal(store.value(store.find("attic")), null);
	assert.equal(store.quality(store.find("attic")), ABSENT);
});

test("a page that is hidden holds no stream and asks for nothing", async () => {
	hide();
	assert.equal(open().length, 0);
	await pass(600000);
	assert.equal(open().length, 0);
	assert.deepEqual(server.asked, []);
});

test("what a hidden page had is believed for three seconds", async () => {
	hide();
	await pass(2900);
	assert.equal(room(), 21);
	await pass(200);
	assert.equal(room(), null);
	assert.equal(store.unknown, HIDDEN);
});

test("shown again it fetches all anew, and has no value before", async () => {
	hide();
	await pass(60000);
	value = 35;
	hide(false);
	assert.equal(open().length, 1);
	assert.equal(room(), null);
	streams.at(-1).opened();
	assert.equal(room(), null);
	await settle();
	assert.equal(room(), 35);
	assert.equal(asked("api/signals"), 1);
});

test("shown again at once its values stay known, and are fetched", async () => {
	hide();
	await pass(1000);
	value = 35;
	hide(false);
	assert.equal(room(), 21);
	await found();
	assert.equal(room(), 35);
	await pass(10000);
	assert.equal(store.unknown, null);
});

test("shown again at once without an answer its values are unknown when they would have been", async () => {
	hide();
	await pass(1000);
	hide(false);
	await pass(1900);
	assert.equal(room(), 21);
	await pass(200);
	assert.equal(room(), null);
});

test("a page that stood still while it was hidden believes nothing when it goes on", async () => {
	hide();
	clock.now += 60000; // no timer ran
	hide(false);
	assert.equal(room(), null);
	const {recent} = store.find("room"), last = recent.at(-1);
	assert.equal(last.v, null);
	assert.ok(last.t <= store.now() - 59000, "the gap begins when it was left");
	await found();
	assert.equal(room(), 21);
});

test("hidden and shown many times it holds one stream", async () => {
	for (let n = 0; n < 20; n++) {
		hide();
		hide(false);
	}
	assert.equal(open().length, 1);
	await found();
	await pass(60);
	assert.equal(open().length, 1);
});

test("a page that is kept for the way back holds no stream, and comes back right", async () => {
	pagehide();
	hide();
	assert.equal(open().length, 0);
	clock.now += 60000;
	value = 35;
	hide(false);
	pageshow();
	assert.equal(open().length, 1);
	assert.equal(room(), null);
	await found();
	assert.equal(room(), 35);
});

test("signals that are under way when the page is hidden are not believed later", async () => {
	let give;
	const answer = server.answers["api/signals"];
	server.answers["api/signals"] = () => new Promise((resolve) => { give = () => resolve(answer()); });
	streams.at(-1).sends("found", {now: Date.now(), generation: ++list.generation});
	await settle();
	hide();
	server.answers["api/signals"] = answer;
	give();
	await pass(3100);
	assert.equal(room(), null);
	await pass(60000);
	assert.equal(room(), null);
	assert.equal(open().length, 0);
	hide(false);
	await found();
	assert.equal(room(), 21);
});

test("after a hidden time a server that is away has its own words", async () => {
	hide();
	await pass(10000);
	hide(false);
	streams.at(-1).failed();
	await pass(3100);
	assert.match(store.unknown, /connection to owsd-web has failed/);
});

test("a connection that fails makes values unknown after three seconds, not before", async () => {
	streams.at(-1).failed();
	await pass(2900);
	assert.equal(room(), 21);
	await pass(200);
	assert.equal(room(), null);
});

test("a connection that is back within three seconds leaves them known", async () => {
	streams.at(-1).failed();
	await pass(2000);
	await found();
	await pass(5000);
	assert.equal(room(), 21);
});

test("a stream that has ended is opened again", async () => {
	const before = streams.length;
	streams.at(-1).failed(true);
	await pass(2100);
	assert.equal(streams.length, before + 1);
});

test("a stream that was silent for 35 seconds is dead, though the server answers", async () => {
	const source = streams.at(-1);
	await pass(34000);
	assert.equal(room(), 21);
	await pass(2500);
	assert.equal(source.readyState, 2);
	assert.equal(room(), null);
});

test("a stream that says that it lives is believed", async () => {
	for (let n = 0; n < 8; n++) {
		await pass(15000);
		streams.at(-1).sends("alive", {});
	}
	assert.equal(room(), 21);
	assert.equal(open().length, 1);
});

test("another owsd-web behind the same address has its stream opened anew", async () => {
	const source = streams.at(-1), info = server.answers["api/info"];
	server.answers["api/info"] = () => ({...info(), since: 2});
	await pass(7000);
	server.answers["api/info"] = info;
	assert.equal(source.readyState, 2);
	assert.equal(open().length, 1);
});

test("the loss of owsd makes all unknown at once, in its words", () => {
	streams.at(-1).sends("lost", {why: "owsd is not running"});
	assert.equal(store.unknown, "owsd is not running.");
	assert.equal(room(), null);
	assert.equal(store.quality(store.find("room")), UNKNOWN);
});

test("a clock that was set, or a computer that slept, makes all unknown until it is fetched", async () => {
	clock.wall += 3600000;
	await pass(1100);
	assert.equal(room(), null);
	await found();
	assert.equal(room(), 21);
	assert.ok(store.age(store.find("room")) < 2);
});

test("an event that waited for hours while the computer slept is not believed", () => {
	clock.wall += 7200000;
	values([0, 99, GOOD, 1, 0]);
	assert.equal(room(), null);
});

test("numbers of signals of another table mean nothing here", () => {
	streams.at(-1).sends("values", {now: Date.now(), generation: 1, v: [[0, 99, GOOD, 1, 0]]});
	assert.equal(room(), 21);
});

test("a change is shown at once, and its reason in words is fetched within a second", async () => {
	values([0, null, ABSENT, 0, 3]);
	assert.equal(room(), null);
	assert.equal(store.find("room").text, "device absent");
	assert.equal(asked("api/signals"), 0);
	await pass(1100);
	assert.equal(asked("api/signals"), 1);
});

test("of a first good value the rest is fetched too: whether it is simulated", async () => {
	values([1, 7, GOOD, 1, 0]);
	assert.equal(store.value(store.find("attic")), 7);
	await pass(1100);
	assert.equal(asked("api/signals"), 1);
});

test("values that were long under way do not look new", () => {
	streams.at(-1).sends("values", {now: Date.now() - 4000, generation: list.generation,
		v: [[0, 22, GOOD, 1, 0]]});
	assert.ok(store.age(store.find("room")) >= 4);
	assert.equal(room(), 22);
});

test("where the clock of the server goes slower, or is set back, values do not look old for long",
	async () => {
		const age = () => store.age(store.find("room"));
		for (const behind of [2000, 3600000]) {
			for (let n = 0; n < 70; n++) {
				await pass(1000);
				streams.at(-1).sends("values", {now: Date.now() - behind, generation: list.generation,
					v: [[0, 21 + n, GOOD, 1, 0]]});
			}
			assert.ok(age() < 2, `${age()} s, ${behind} ms behind`);
			streams.at(-1).sends("values", {now: Date.now() - behind - 4000, generation: list.generation,
				v: [[0, 22, GOOD, 1, 0]]});
			assert.ok(age() >= 4, "an event that was under way for long is still seen to be");
		}
	});

test("a reload that changes no signal keeps what the page had seen of them", async () => {
	const before = store.find("room");
	streams.at(-1).sends("found", {now: Date.now(), generation: ++list.generation});
	await settle();
	assert.equal(store.find("room"), before);
});

test("a row says how the alarms of its signal stand, also where that changes without an entry", async () => {
	let told = 0;
	const count = () => told++, alarm = () => store.find("room").alarm;
	store.addEventListener("alarm", count);
	values([0, 21, GOOD, 1, 0, "! cannot be reset"]);
	assert.equal(alarm(), "! cannot be reset");
	values([0, 22, GOOD, 1, 0, "! cannot be reset"]);
	assert.equal(told, 1, "it stands as it stood");
	values([0, 22, GOOD, 1, 0]);
	assert.equal(alarm(), null);
	assert.equal(told, 2);
	streams.at(-1).sends("alarm", {now: Date.now(), generation: list.generation, i: 0, alarm: ""});
	assert.equal(told, 3);
	values([0, 23, GOOD, 1, 0]);
	assert.equal(told, 3, "the row says the same as the event");
	store.removeEventListener("alarm", count);
});

test("a row of a bad value has its reason, which may be another one of the same quality", () => {
	for (const why of ["no such device there", "the answer fails its checksum"]) {
		values([0, null, ABSENT, 0, 3, null, why]);
		assert.equal(store.find("room").why, why);
	}
	values([0, 21, GOOD, 1, 0]);
	assert.equal(store.find("room").why, null);
});

test("what an output was commanded is what owsd says, whoever it was, and ends with the difference", () => {
	const commanded = () => store.find("room").commanded;
	values([0, null, 0x1c, 0, 1, null, "it reads otherwise", true]);
	assert.equal(commanded(), true);
	values([0, null, 0x1c, 0, 1, null, "it reads otherwise", false]);
	assert.equal(commanded(), false);
	values([0, false, GOOD, 1, 0]);
	assert.equal(commanded(), null);
});

test("a name that another sensor has now, or another unit, begins its last hour anew", async () => {
	const answer = server.answers["api/signals"];
	let more;
	server.answers["api/signals"] = () => {
		const given = answer();
		Object.assign(given.signals[0], {identity: "/28.A", unit: "C"}, more);
		return given;
	};
	const fetched = async (values) => {
		more = values;
		streams.at(-1).sends("found", {now: Date.now(), generation: ++list.generation});
		await settle();
		return store.find("room").recent;
	};
	for (const [other, kept] of [[{description: "new"}, true], [{identity: "/28.B", path: "/28.B"}, false],
		[{unit: "K"}, false]]) {
		const before = await fetched({});
		assert.equal(await fetched(other) === before, kept, JSON.stringify(other));
	}
	server.answers["api/signals"] = answer;
});

test("what a cache answers again and again is not late, what nothing is heard of is", async () => {
	const {isLate} = await import("./page/look.js");
	Object.assign(store.find("room"), {interval: 1, gap: undefined});
	for (let age = 1; age <= 20; age++) {
		await pass(1000);
		values([0, 21, GOOD, 1, age]);
		assert.ok(!isLate(store.find("room"), store.age(store.find("room"))), `${age} s old`);
	}
	assert.ok(!isLate(store.find("room"), 60) && isLate(store.find("room"), 61));
});
