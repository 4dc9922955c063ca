// SPDX-License-Identifier: MIT
// Asks for the signals as soon as the browser has read this line, before the other modules run.
import {get} from "./api.js";

const ask = () => Promise.all([get("info"), get("signals")]);

let first = ask();
first.catch(() => {}); // store.js takes it, and reports it

/** [info, signals]: once what was asked for first; after that it is asked for anew. */
export function askAll() {
	const given = first ?? ask();
	first = null;
	return given;
}
