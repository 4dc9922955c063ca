// SPDX-License-Identifier: MIT
// All modules of the page are read as a browser reads them: their syntax, the files that they
// import, and the names in them. Nothing of them runs.
import assert from "node:assert/strict";
import {existsSync, readFileSync, readdirSync} from "node:fs";
import {test} from "node:test";
import {fileURLToPath} from "node:url";
import vm from "node:vm";

const page = new URL("./page/", import.meta.url);
const files = readdirSync(page).filter((name) => name.endsWith(".js"));

const moduleOf = (url, text = readFileSync(url, "utf8")) =>
	new vm.SourceTextModule(text, {identifier: fileURLToPath(url)});

/* Links a module with all that it imports. */
function link(module) {
	const read = new Map([[module.identifier, module]]);
	return module.link((path, {identifier}) => {
		const url = new URL(path, `file://${identifier}`), file = fileURLToPath(url);
		if (!read.has(file))
			read.set(file, moduleOf(url));
		return read.get(file);
	});
}

for (const name of files)
	test(`${name} is a module whose imports are there`, async () => {
		const url = new URL(name, page);
		await link(moduleOf(url));
		for (const [, path] of readFileSync(url, "utf8").matchAll(/import\("([^"]+)"\)/g))
			assert.ok(existsSync(new URL(path, url)), path);
	});

test("a name that a module does not export is a fault", async () => {
	const wrong = moduleOf(new URL("wrong.js", page), 'import {no} from "./words.js"; no();');
	await assert.rejects(link(wrong), /no/);
});

test("files are small, and text goes in as text", () => {
	const all = readdirSync(page).filter((name) => /\.(js|css|html|svg)$/.test(name));
	const forbidden = ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function",
		"http://", "https://", " style=", " onclick="];
	assert.ok(all.length > 12);
	for (const name of all) {
		const text = readFileSync(new URL(name, page), "utf8");
		assert.match(text.slice(0, 120), /SPDX-License-Identifier[:] MIT/, name);
		assert.ok(text.split("\n").length <= (name.endsWith(".js") ? 301 : 500), `${name} is too long`);
		const own = text.replaceAll("http://www.w3.org/2000/svg", "");
		for (const word of forbidden)
			assert.ok(!own.includes(word), `${name}: ${word}`);
	}
});
