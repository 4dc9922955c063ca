// SPDX-License-Identifier: MIT
// Words for qualities, numbers, ages and times: those of libows and of docs/doctor.md.

/** code: [words, what it means, what to do] */
const QUALITIES = new Map([
// from src/ground/signal/words_list.h
	[0x04, ["no such property",
		"The device has no property of that name.",
		"Check the spelling of the path. \u201cowsctl dir\u201d lists what the device has."]],
	[0x05, ["wrong type",
		"The type of the signal does not fit the property.",
		"Take the type that the log names. Lists (.ALL) and texts take string."]],
	[0x06, ["access refused",
		"The property is read-only or write-only, or owsd has no permission.",
		"Make the item an input, or an output without Readable. Else look at the "
		+ "owserver\u2019s option readonly, or the rights of the kernel\u2019s files."]],
	[0x08, ["device absent",
		"The device does not answer on its wire.",
		"Does \u201cowsctl scan\u201d list the id? Compare it with the path. Check ground, "
		+ "data and the pull-up."]],
	[0x0c, ["device error",
		"The answer is late, fails its checksum or is out of the chip\u2019s range, or the "
		+ "device reports a fault.",
		"Look for a bad contact, a long wire without enough pull-up, or noise. \u201cowsctl "
		+ "read\u201d of the path shows the answer."]],
	[0x10, ["sensor power fault",
		"The sensor answers as one without supply: a thermometer reads 85 or 127.94 \u00b0C.",
		"Check its supply. Parasite power over a long wire needs a strong pull-up."]],
	[0x14, ["stale",
		"No newer value came within StaleAfter.",
		"Is the target up? _ReadEnable or PerFactor may hold the signal back."]],
	[0x18, ["target down",
		"The target, or one of its bridge chips, does not answer.",
		"Does owserver run at that port? Is the bridge chip at its address? owsd tries again "
		+ "by itself."]],
	[0x19, ["wire short",
		"The data line is held at ground.",
		"Unplug branches until the wire lives again."]],
	[0x1a, ["owsd not running",
		"owsd has ended or hangs.",
		"Does the service run: systemctl status owsd@*?"]],
	[0x1c, ["not as commanded",
		"The output reads otherwise than it was written.",
		"Did the device lose its supply, or did another program switch it? Set it again, or "
		+ "let Restore do so."]],
	[0x20, ["initial",
		"The signal was never read or written.",
		"An input has its first value soon. Set an output, or give it an InitValue."]],
	[0x44, ["last usable value",
		"Reading is disabled, another target has not answered yet, readings jump beyond "
		+ "MaxStep, or an output was not read or written since its target or its device was "
		+ "away.",
		"Wait for the new target, set _ReadEnable to 1, or raise MaxStep; set the output, or "
		+ "give it ReadBack."]],
	[0x54, ["out of range",
		"The value is beyond Min or Max.",
		"Is the sensor or its wire broken? Else correct Min and Max."]],
	[0x55, ["at lower limit",
		"The value is held at the lower end of its type or of Points.",
		"Take a wider type, or continue Points."]],
	[0x56, ["at upper limit",
		"The value is held at the upper end of its type or of Points.",
		"Take a wider type, or continue Points."]],
	[0x58, ["cut",
		"The text is longer than its room.",
		"Read a part of it."]],
// to here
]);

export const UNKNOWN = -1;

/** Of the quality of a value: "good", "uncertain", "bad" or "unknown". */
export function stateOf(code) {
	if (code === UNKNOWN)
		return "unknown";
	if (code === 0x20)
		return "uncertain"; // nothing is wrong yet
	return ["bad", "uncertain", "bad", "good"][(code & 0xc0) >> 6];
}

export function qualityWords(code) {
	if (code === UNKNOWN)
		return "unknown";
	return QUALITIES.get(code)?.[0] ?? (stateOf(code) === "good" ? "good" : "bad");
}

export const meaningOf = (code) => QUALITIES.get(code)?.[1] ?? "";
export const remedyOf = (code) => QUALITIES.get(code)?.[2] ?? "";

/** What kind of chip a device is: the name of its family, else the code with which its id begins. */
export const kindOf = ({family, device}) => family || `Family ${(device ?? "").slice(0, 2)}`;

/** The shape beside the words, so that no state is shown by colour alone. */
export const SHAPES = {good: "", uncertain: "?", bad: "\u00d7", unknown: "?"};

export function valueText(signal, value) {
	if (value === null || value === undefined)
		return "\u2014";
	if (typeof value === "boolean" || signal.type === "bool")
		return Number(value) ? "on" : "off";
	if (typeof value !== "number")
		return String(value);
	if (!Number.isFinite(value))
		return "\u2014";
	if (Number.isInteger(value) && !(signal.decimals > 0))
		return String(value);
	return (signal.decimals ?? -1) >= 0 ? value.toFixed(Math.min(signal.decimals, 9))
		: String(Number(value.toPrecision(7)));
}

export function withUnit(signal, text) {
	return signal.unit && text !== "\u2014" ? `${text}\u202f${signal.unit}` : text;
}

export function span(seconds) {
	if (seconds === null || seconds === undefined || !Number.isFinite(seconds))
		return "\u2014";
	const s = Math.max(0, seconds);
	if (s < 1)
		return "now";
	if (s < 90)
		return `${Math.floor(s)} s`;
	if (s < 5400)
		return `${Math.floor(s / 60)} min`;
	if (s < 172800)
		return `${Math.floor(s / 3600)} h`;
	return `${Math.floor(s / 86400)} d`;
}

/** ms, or a text of ISO 8601, as ms; NaN if it is neither. */
export function msOf(time) {
	return typeof time === "number" ? time : time ? Date.parse(time) : NaN;
}

export const plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;

/** "a, b, c and 2 more": the first of a list of texts. */
export const listOf = (texts, most) => texts.slice(0, most).join(", ")
	+ (texts.length > most ? ` and ${texts.length - most} more` : "");

/** The words of a search, small. */
export const wordsOf = (text) => text.toLowerCase().split(/\s+/).filter(Boolean);

const two = (n) => String(n).padStart(2, "0");

export function clock(time) {
	const at = new Date(msOf(time));
	return Number.isNaN(at.getTime()) ? "\u2014"
		: `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
}

export function dateAndClock(time) {
	const at = new Date(msOf(time));
	return Number.isNaN(at.getTime()) ? "\u2014"
		: `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${clock(time)}`;
}

const PLAIN = {"high high": "very high", "low low": "very low"};

/**
 * "! high high, returned" as {text, open, turn, very}: open wants eyes; turn is "up", "down" or "".
 * "" and "-" are no alarm: null.
 */
export function alarmOf(words) {
	const text = String(words ?? "").trim();
	if (!text || text === "-")
		return null;
	const plain = text.replaceAll("! ", "")
		.replace(/high high|low low/g, (kind) => PLAIN[kind]);
	return {text: plain, open: text.includes("!"), very: plain.startsWith("very "),
		turn: /^(very )?high/.test(plain) ? "up" : /^(very )?low/.test(plain) ? "down" : ""};
}
