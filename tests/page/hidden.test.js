// SPDX-License-Identifier: MIT
// A page that was opened in a tab behind others has never had a stream.
import assert from "node:assert/strict";
import {test} from "node:test";
import {hide, open, pass, server, settle, streams} from "./browser.js";

let value = 1;

server.answers["api/info"] = () => ({now: Date.now(), since: 1});
server.answers["api/signals"] = () => ({generation: 1, cursor: 5, now: Date.now(), signals: [
	{i: 0, name: "room", type: "double", value, quality: {code: 0xc0, good: true}, age: 0}]});

test("a page that begins hidden opens its stream when it is shown, and fetches before it believes",
	async () => {
		document.hidden = true;
		const {store} = await import("./page/store.js");
		await store.start();
		await pass(60000);
		assert.equal(open().length, 0);
		assert.equal(store.value(store.find("room")), null);
		value = 2;
		hide(false);
		// where the signals of long ago end is no place to go on
		assert.equal(streams.at(-1).address, "api/events");
		streams.at(-1).opened();
		assert.equal(store.value(store.find("room")), null);
		await settle();
		assert.equal(store.value(store.find("room")), 2);
	});
