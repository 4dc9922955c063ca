// SPDX-License-Identifier: MIT
// The targets with their blocks Bus, the keys of the driver, and the blocks of owsd's programs.
import {button, el, put} from "./dom.js";
import {draft} from "./draft.js";
import {Field, Form, edits, setter} from "./form.js";
import {problemsOf} from "./problems.js";

// Keys without a field here: of the driver, and of Web what only the machine itself may change
const ELSEWHERE = ["TargetName", "ItemCount", "Version", "Files"];

let root, targets, buses, fault, forms = null, busForms = new Map(), many;

export function build(into) {
	root = into;
	fault = el("p", {class: "fault", role: "alert"});
	targets = el("div", {class: "fields"});
	buses = el("div", {});
	many = el("p", {class: "hint"});
	root.append(fault, el("h2", {}, "Targets"), targets, el("h2", {}, "Options of the targets"),
		buses);
}

function make() {
	const where = draft.options("driver").find(({key}) => key === "TargetName");
	forms = new Map();
	if (where) {
		const field = new Field("targets", where, (value) => draft.edit({do: "targets", value}));
		targets.append(field.node);
		forms.set("TargetName", field);
	}
	for (const {name, place, title} of draft.singles()) {
		const form = new Form(place, place, setter(() => name), {without: ELSEWHERE});
		form.title = el("summary", {}, title);
		form.box = el("details", {class: "block"}, form.title, form.node);
		forms.set(name, form);
		root.append(form.box);
	}
	forms.get("OwsDrv").box.append(many);
}

export function paint() {
	if (!draft.keys.length)
		return;
	if (!forms)
		make();
	const {model} = draft;
	const driver = problemsOf({block: "OwsDrv"});
	const field = forms.get("TargetName");
	field?.paint(model.driver.TargetName ?? model.targets.join(","),
		driver.filter(({key}) => key === "TargetName"));
	if (field)
		field.control.disabled = !draft.editable;
	for (const {name, title} of draft.singles()) {
		const form = forms.get(name), driver_ = name === "OwsDrv";
		const keys = driver_ ? model.driver : model.blocks[name] ?? {};
		form.paint(keys, driver_ ? driver : problemsOf({block: name}));
		put(form.title, driver_ || model.blocks[name] ? title
			: `${title} (the draft has no such block; the first key makes it)`);
	}
	paintRepeated();
	paintBuses();
}

/* A key that stands several times is one of the text: a field has room for one value. */
function paintRepeated() {
	const words = draft.options("driver").filter((option) => option.repeats).map(({key}) => {
		const times = draft.text.match(new RegExp(`^\\s*${key}\\s`, "gm"))?.length ?? 0;
		const field = forms.get("OwsDrv").fields.get(key);
		field.control.disabled = times > 1;
		return times > 1 ? `${key} stands ${times} times: change it in the text.` : "";
	});
	put(many, words.join(" "));
}

function paintBuses() {
	const own = new Map(draft.model.buses.map((bus) => [bus.target, bus.keys]));
	const wanted = [...new Set([...draft.model.targets, ...own.keys()])];
	for (const [target, form] of busForms)
		if (!wanted.includes(target)) {
			form.box.remove();
			busForms.delete(target);
		}
	wanted.forEach((target, n) => {
		if (!busForms.has(target))
			busForms.set(target, busForm(target));
		const form = busForms.get(target), has = own.has(target);
		if (buses.children[n] !== form.box)
			buses.insertBefore(form.box, buses.children[n] ?? null);
		form.paint(own.get(target) ?? {}, problemsOf({block: "Bus", bus: target}));
		form.remove.hidden = !has;
		form.remove.disabled = !draft.editable;
		put(form.words, has ? "" : " (no options)");
	});
}

let serial = 0;

function busForm(target) {
	const form = new Form(`bus${serial++}`, "bus", (values) =>
		draft.edit(...edits(values, "bus-set", "bus-unset", {target})), {without: ["Target"]});
	form.words = el("span", {class: "hint"});
	form.remove = button("Remove these options", async () => {
		try {
			await draft.edit({do: "bus-remove", target});
			put(fault, "");
		} catch (error) {
			put(fault, error.message);
		}
	});
	form.box = el("details", {class: "block"},
		el("summary", {}, el("code", {}, target), form.words), form.node,
		el("div", {class: "tools"}, form.remove));
	return form;
}

/** Open the block of that name and put the focus into the field of a key. */
export function open({block, bus, key}) {
	if (block === "OwsDrv" && key === "TargetName") {
		forms?.get(key)?.control.focus();
		return;
	}
	const form = block === "Bus" ? busForms.get(bus) : forms?.get(block);
	if (!form)
		return;
	form.box.open = true;
	if (!form.focus(key))
		form.box.querySelector("summary").focus();
}
