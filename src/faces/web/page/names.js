// SPDX-License-Identifier: MIT
// Names of signals: which are allowed, and a good one for a property that was found. Ids of
// devices.

const BYTES = 63;

/** An id of the bus, however it is written. */
export const idOf = (text) => (text ?? "").toUpperCase().replaceAll(".", "").slice(0, 14);

/** Why a text is no name of a signal; "": it is one. The checker of owsd has the last word. */
export function faultOf(name, taken) {
	if (!name)
		return "Enter a name.";
	if (new TextEncoder().encode(name).length > BYTES)
		return `A name has at most ${BYTES} bytes.`;
	if (/[\s\p{Cc}\p{Cf}]/u.test(name))
		return "A name has no blank and no invisible character.";
	if (/[/"#{}]/.test(name) || name === "." || name === "..")
		return "A name has none of / \" # { }.";
	return taken.has(name) ? "This name is taken." : "";
}

/** As owsctl scan --rio: the alias, with the property's word where there are several; else the
 * word with the first number that is free. */
export function nameFor(device, property, taken) {
	const several = device.properties.length > 1;
	const alias = device.alias ? `${device.alias}${several ? `_${property.word}` : ""}` : "";
	if (alias && !alias.includes("\\") && !faultOf(alias, taken))
		return alias;
	for (let n = 1; ; n++)
		if (!taken.has(`${property.word}${n}`))
			return `${property.word}${n}`;
}
