// SPDX-License-Identifier: MIT
// Asks owsd-web.
import {way} from "./way.js";

async function ask(path, options) {
	const {headers, ...more} = options;
	// a page of another site cannot send that header
	const {status, text} = await way.ask(path, {headers: {"X-Owsd": "1", ...headers}, ...more});
	let data = null;
	try {
		data = JSON.parse(text);
	} catch {
		data = null;
	}
	if (status < 200 || status > 299)
		throw Object.assign(new Error(data?.error || `refused with status ${status}`),
			{status, data});
	if (data === null)
		throw new Error("owsd-web gave an answer that is no JSON");
	return data;
}

/**
 * May what was asked for have been done nevertheless? No answer came; or a proxy or owsd-web has
 * waited for one in vain (502, 504).
 */
export const isUnknown = ({status}) => !status || status === 502 || status === 504;

/** Why a command is not known to be done. */
export const failed = (error) =>
	`${isUnknown(error) ? "not known whether it was done" : "refused"}: ${error.message}`;

const query = (values) => new URLSearchParams(
	Object.entries(values).filter(([, value]) => value !== undefined)).toString();

export const get = (path, values = {}, patience) => {
	const text = query(values);
	return ask(`api/${path}${text ? `?${text}` : ""}`, {patience});
};

/**
 * patience: ms until the answer has to be there. An error has the status and the data of the
 * answer, as far as there was one.
 */
export const post = (path, body, patience) => ask(`api/${path}`, {
	method: "POST",
	headers: {"Content-Type": "application/json"},
	body: JSON.stringify(body), patience,
});
