// SPDX-License-Identifier: MIT
// What is typed in the part Text, and a file that another saves meanwhile.
import assert from "node:assert/strict";
import {beforeEach, test} from "node:test";
import {pass, server, settle} from "./browser.js";
import "./document.js";

const {draft} = await import("./page/draft.js");
const text = await import("./page/text.js");
const disk = {text: "a\nb", tag: "t1"};
const model = {targets: [], driver: {}, buses: [], blocks: {}, items: []};

server.answers["api/config/keys"] = {keys: [{place: "item", key: "Name"}]};
server.answers["api/config"] = () => ({...disk, model, file: "/f.rio", configurable: true});
server.answers["api/config/draft"] = (_, sent) => ({text: sent.text, model, problems: [], valid: true});
text.build(document.body);
draft.addEventListener("change", text.paint);

const area = () => document.body.find(({name}) => name === "textarea");

function types(value) {
	area().value = value;
	area().dispatchEvent(new Event("input"));
}

beforeEach(async () => {
	Object.assign(disk, {text: "a\nb", tag: "t1"});
	await draft.load();
	await draft.drop();
	text.paint();
	assert.equal(area().value, "a\nb");
});

test("what is typed is in the draft when one pauses", async () => {
	types("a\nmine");
	assert.equal(draft.text, "a\nb");
	await pass(800);
	assert.deepEqual([draft.text, draft.dirty, draft.overtaken], ["a\nmine", true, false]);
});

test("who types has not seen the file that another saves then, and does not undo it", async () => {
	types("a\nmine");
	Object.assign(disk, {text: "theirs\nb", tag: "t2"});
	await draft.load();
	await pass(800);
	assert.equal(area().value, "a\nmine");
	assert.deepEqual([draft.text, draft.base.tag, draft.overtaken], ["a\nmine", "t1", true]);
	await draft.rebase();
	assert.equal(draft.text, "theirs\nmine");
});

test("what was typed and taken back leaves the draft to follow the file", async () => {
	types("a\nmine");
	types("a\nb");
	await pass(800);
	Object.assign(disk, {text: "theirs\nb", tag: "t2"});
	await draft.load();
	await settle();
	assert.deepEqual([draft.text, draft.overtaken], ["theirs\nb", false]);
	assert.equal(area().value, "theirs\nb");
});
