// SPDX-License-Identifier: MIT
// Where the chips are, and what is wrong there, for the view Wire: terminals of adapters, faults.
// It touches no document.
import {kindOf, meaningOf, plural, qualityWords, remedyOf, stateOf} from "./words.js";

const ABSENT = 0x08, WRONG = 0x0c, DOWN = 0x18, SHORT = 0x19, INITIAL = 0x20;
const RANK = {good: 0, uncertain: 1, bad: 2, unknown: 3};

/** The lists of what has the same key. */
function grouped(list, keyOf) {
	const groups = new Map();
	for (const one of list) {
		const key = keyOf(one), group = groups.get(key);
		if (group)
			group.push(one);
		else
			groups.set(key, [one]);
	}
	return groups;
}

function chipOf(id, signals, device) {
	const rank = ({code}) => RANK[stateOf(code)];
	const {code} = signals.reduce((a, b) => rank(b) > rank(a) ? b : a);
	return {id, signals, code, device, family: signals[0].family ?? "",
		answers: ![ABSENT, WRONG, DOWN, SHORT, INITIAL].includes(code)};
}

/**
 * [{key, adapter, channel, name, label, chips, short, load, errors}] in the order of the adapters,
 * empty ones too. A channel that is not known is null; where an adapter has one wire, all its chips
 * are on it. stats: of api/stats, with load and share: in per cent, by the name of a target, the id
 * of a device; and wires: by the name of a target, of each {load, errors}, or null.
 */
export function terminalsOf(signals, stats) {
	const {targets = [], devices = []} = stats ?? {}, found = new Map();
	const known = new Map(devices.map((device) => [device.id.toUpperCase(), device]));
	const most = new Map(targets.map(({name}) => [name, -1])); // the greatest channel with a chip
	const of = (adapter, channel) => {
		const key = `${adapter ?? ""} ${channel ?? ""}`;
		if (!found.has(key))
			found.set(key, {key, adapter, channel, chips: [], short: false, load: null, errors: 0,
				label: String(channel ?? (most.get(adapter) > 0 ? "?" : "all")),
				name: adapter === null ? "an adapter that is not known"
					: channel === null ? adapter : `terminal ${channel} of ${adapter}`});
		return found.get(key);
	};
	for (const {target, channel} of devices)
		if (most.has(target))
			most.set(target, Math.max(most.get(target), channel ?? -1));
	for (const [target, {length}] of stats?.wires ?? [])
		most.set(target, Math.max(most.get(target), length - 1));
	for (const [name, last] of most)
		for (let n = 0; n <= last; n++)
			of(name, n);
	const placed = signals.filter(({device}) => device);
	for (const [id, all] of grouped(placed, ({device}) => device)) {
		const device = known.get(id.toUpperCase());
		const adapter = device?.target ?? (targets.length === 1 ? targets[0].name : null);
		const terminal = of(adapter, device?.channel ?? (most.get(adapter) === 0 ? 0 : null));
		const share = stats?.share?.get(device?.id);
		terminal.chips.push(chipOf(id, all, device));
		terminal.short ||= all.some(({code}) => code === SHORT);
		terminal.errors += device?.errors ?? 0;
		if (share !== undefined)
			terminal.load = (terminal.load ?? 0) + share;
	}
	for (const [adapter, of] of grouped(found.values(), (terminal) => terminal.adapter))
		if (of.length === 1 && stats?.load?.has(adapter))
			of[0].load = stats.load.get(adapter); // conversions of all chips at once count too
	for (const terminal of found.values()) {
		const wire = stats?.wires?.get(terminal.adapter)?.[terminal.channel];
		if (wire)
			Object.assign(terminal, wire); // what chips share counts too
	}
	return [...found.values()];
}

/** What answers beside a chip that does not: "Its two neighbours answer." */
function neighbours(chips, lost) {
	const answer = chips.filter((chip) => chip.answers).length, others = chips.length - lost;
	return !others ? "" : answer === others ? " All others there answer."
		: answer ? ` ${answer} of the ${others} others there answer.` : " No other there answers.";
}

function faultOf(signals, terminal) {
	const {code} = signals[0], ids = [...grouped(signals, ({device}) => device).keys()];
	const where = terminal?.name ?? "a wire", whys = [...new Set(signals.map(({why}) => why))];
	const title = code === SHORT ? `Short on ${where}`
		: code !== ABSENT ? `${qualityWords(code)}: ${plural(signals.length, "signal")}`
			: ids.length === 1 ? `${signals[0].name} does not answer`
				: `${ids.length} chips do not answer`;
	const place = code === SHORT || !terminal ? "" : code === ABSENT
		? `${ids.length === 1 ? `${kindOf(signals[0])} ${ids[0]}` : "They belong"} on ${where}.`
			+ neighbours(terminal.chips, ids.length) : `On ${where}.`;
	return {title, state: stateOf(code) === "uncertain" ? "uncertain" : "bad", signals,
		sentences: [meaningOf(code), place, whys.filter(Boolean).slice(0, 3).map((why) =>
			`Reason: ${why}.`).join(" ")], remedy: remedyOf(code)};
}

/**
 * [{title, state, signals, sentences, remedy}]: adapters that are down, then the other faults of
 * each terminal, first those of most signals. What was never read yet is not wrong.
 */
export function faultsOf(signals, targets, terminals) {
	const at = new Map(terminals.flatMap((terminal) => terminal.chips.flatMap((chip) =>
		chip.signals.map((signal) => [signal, terminal]))));
	const down = new Map(targets.filter(({state}) => state !== "up").map((one) => [one.name, one]));
	const wrong = signals.filter(({good, code}) => !good && code !== INITIAL);
	const ofDown = ({code}, adapter) => code === DOWN && down.has(adapter);
	const kinds = grouped(wrong.filter((one) => !ofDown(one, at.get(one)?.adapter)),
		(one) => `${one.code} ${at.get(one)?.key ?? ""}`);
	return [...[...down.values()].map(({name, state, note}) => ({
		title: `${name} is ${state}`, state: "bad", remedy: remedyOf(DOWN),
		signals: wrong.filter((one) => ofDown(one, at.get(one)?.adapter)
			&& at.get(one).adapter === name),
		sentences: [note ? `${note}.` : meaningOf(DOWN)]})),
	...[...kinds.values()].sort((a, b) => b.length - a.length)
		.map((of) => faultOf(of, at.get(of[0])))];
}
