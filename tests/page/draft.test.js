// SPDX-License-Identifier: MIT
// The draft of a configuration, with the server played: undo, a second person, a reload of the
// page, an answer that is lost. And what the page says a save takes away.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {server, settle} from "./browser.js";

const {draft} = await import("./page/draft.js");
const {lockout, vanished} = await import("./page/loss.js");

const WEB = {Configure: "on", Listen: "127.0.0.1:1"};
const disk = {text: "a\nb\nc", tag: "t1"};
const model = (text) => ({targets: [], driver: {}, buses: [], blocks: {Web: WEB},
	items: text.split("\n").map((name) => ({name, path: `/${name}`}))});
const config = () => ({...disk, model: model(disk.text), file: "/f.rio", configurable: true});
const put = (text, tag) => Object.assign(disk, {text, tag});

server.answers["api/config/keys"] = {keys: [{place: "item", key: "Name"}]};
server.answers["api/config/draft"] = (_, {text}) =>
	({text, model: model(text), problems: [], valid: true});

beforeEach(async () => {
	put("a\nb\nc", "t1");
	server.answers["api/config"] = config;
	server.answers["api/config/save"] = (_, {text, base}) => {
		if (base !== disk.tag)
			return {status: 409, tag: disk.tag, error: "changed"};
		put(text, `${disk.tag}+`);
		return {tag: disk.tag, reload: "done"};
	};
	await draft.load();
	await draft.drop();
});

test("a draft without changes follows the file", async () => {
	put("x", "t2");
	await draft.load();
	assert.deepEqual([draft.text, draft.dirty, draft.overtaken], ["x", false, false]);
});

test("each step can be undone and done again", async () => {
	await draft.write("a\nb\nX");
	await draft.write("a\nb\nY");
	await draft.undo();
	assert.equal(draft.text, "a\nb\nX");
	await draft.undo();
	assert.equal(draft.dirty, false);
	await draft.redo();
	assert.equal(draft.text, "a\nb\nX");
	await draft.write("a\nb\nZ");
	assert.equal(draft.redoable, false);
});

test("undo keeps 200 steps", async () => {
	for (let n = 0; n < 210; n++)
		await draft.write(`a\n${n}`);
	for (let n = 0; n < 300 && draft.undoable; n++)
		await draft.undo();
	assert.equal(draft.text, "a\n9");
});

test("an edit that is refused changes nothing", async () => {
	const answer = server.answers["api/config/draft"];
	server.answers["api/config/draft"] = {status: 422, error: "no"};
	await assert.rejects(draft.write("a"), {status: 422});
	server.answers["api/config/draft"] = answer;
	assert.equal(draft.text, "a\nb\nc");
	assert.equal(draft.dirty, false);
});

test("edits that are made at once follow each other", async () => {
	await Promise.all([draft.write("1"), draft.write("2"), draft.write("3")]);
	assert.equal(draft.text, "3");
	await draft.undo();
	assert.equal(draft.text, "2");
});

test("what somebody else saved is not overwritten, and a merge has both", async () => {
	await draft.write("a\nb\nmine");
	put("theirs\nb\nc", "t2");
	await assert.rejects(draft.save(), {status: 409});
	assert.equal(disk.text, "theirs\nb\nc");
	assert.ok(draft.overtaken && draft.dirty);
	assert.deepEqual(await draft.rebase(), []);
	assert.equal(draft.text, "theirs\nb\nmine");
	await draft.save();
	assert.equal(disk.text, "theirs\nb\nmine");
	assert.equal(draft.dirty, false);
});

test("a save whose answer is lost is found to have been done", async () => {
	await draft.write("a\nb\nmine");
	const save = server.answers["api/config/save"];
	server.answers["api/config/save"] = (...given) => {
		save(...given);
		throw new TypeError("lost");
	};
	await assert.rejects(draft.save());
	assert.equal(draft.dirty, false);
	assert.equal(draft.overtaken, false);
});

test("a draft is kept for the time that the page is loaded anew, and not when it is as the file", async () => {
	await draft.write("a\nb\nmine");
	await settle();
	assert.equal(JSON.parse(sessionStorage.getItem("owsd-draft /")).text, "a\nb\nmine");
	await draft.undo();
	await settle();
	assert.equal(sessionStorage.getItem("owsd-draft /"), null);
});

test("signals that vanish with a save are named, and those whose history goes on or ends", () => {
	const items = (...given) => ({...model(""),
		items: given.map(([name, path, keys]) => ({name, path, keys}))});
	draft.saved = items(["return", "/28/t"], ["gone", "/29/t"], ["stays", "/30/t"]);
	draft.model = items(["return_flow", "/28/t"], ["stays", "/31/t"]);
	assert.equal(vanished(),
		"Signals that vanish with this save: gone. Their history goes on: return is return_flow now. "
		+ "Their history begins anew: stays (with Identity /30/t it goes on).");
	draft.model = items(["return", "/32/t", {Identity: "/28/t"}], ["gone", "/29/t"], ["stays", "/30/t"]);
	assert.equal(vanished(), "Their history goes on: return has another path.");
	draft.model = draft.saved;
	assert.equal(vanished(), "");
	draft.saved = items(...Array.from({length: 23}, (_, n) => [`s${n}`, `/${n}`]));
	draft.model = items();
	assert.match(vanished(), /s19 and 3 more\.$/);
});

test("a save after which the page could edit nothing is told, with the way back", () => {
	const web = (block) => ({...model(""), blocks: {Web: block}});
	draft.saved = web(WEB);
	for (const [block, words] of [[WEB, null], [{...WEB, Write: "on"}, null],
		[{...WEB, Configure: "Yes"}, null],
		[{...WEB, Configure: "off"}, /edit nothing more/], [undefined, /edit nothing more/],
		[{...WEB, Listen: "0.0.0.0:1"}, /draft changes Listen /],
		[{...WEB, Proxy: "x", Hosts: "y"}, /draft changes Hosts, Proxy /]]) {
		draft.model = web(block);
		if (words)
			assert.match(lockout(), words);
		else
			assert.equal(lockout(), "");
	}
	assert.match(lockout(), /cp \/f\.rio\.before \/f\.rio && owsctl reload$/);
});
