// SPDX-License-Identifier: MIT
// The scan, and what it did not find.
import assert from "node:assert/strict";
import {test} from "node:test";
import {server, settle} from "./browser.js";
import "./document.js";

const {draft} = await import("./page/draft.js");
const found = await import("./page/found.js");

test("a device is missing where a scan has read all, not where it ended before", async () => {
	draft.info = {configurable: true};
	draft.model.items = [{name: "room", path: "/28.A/temperature", device: "28.A0B1C2000001"}];
	found.build(document.body);
	const [head] = document.body.all.filter(({name, textContent}) => name === "h2" && textContent === "Missing");
	for (const [whole, hidden] of [[true, false], [false, true], [undefined, false]]) {
		server.answers["api/devices"] = {devices: [], whole};
		document.body.find((one) => one.getAttribute("data-action") === "scan").click();
		await settle();
		assert.equal(head.parentNode.hidden, hidden, String(whole));
	}
});
