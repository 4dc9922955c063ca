// SPDX-License-Identifier: MIT
// A document of few elements: what modules of the page make with el(), and a test reads and clicks.
// It lays out nothing and reads no markup. Import this first, and the module then.
import "./browser.js";

class Element extends EventTarget {
	parentNode = null;
	childNodes = [];
	hidden = false;
	disabled = false;
	#attributes = new Map();
	#value = null;

	constructor(name) {
		super();
		this.name = name;
	}

	get classList() {
		const names = () => new Set((this.getAttribute("class") ?? "").split(" ").filter(Boolean));
		const change = (how) => {
			const now = names();
			how(now);
			this.setAttribute("class", [...now].join(" "));
		};
		return {contains: (name) => names().has(name), [Symbol.iterator]: () => names().values(),
			add: (name) => change((now) => now.add(name)),
			remove: (name) => change((now) => now.delete(name)),
			toggle: (name, on) => change((now) => on ? now.add(name) : now.delete(name))};
	}

	get className() { return this.getAttribute("class") ?? ""; }
	set className(names) { this.setAttribute("class", names); }
	get dataset() {
		return Object.fromEntries([...this.#attributes].filter(([key]) => key.startsWith("data-"))
			.map(([key, value]) => [key.slice(5), value]));
	}
	get value() { return this.#value ?? this.getAttribute("value") ?? ""; }
	set value(value) { this.#value = String(value); }
	get children() { return this.childNodes.filter((one) => one instanceof Element); }
	get firstChild() { return this.childNodes[0] ?? null; }
	get lastChild() { return this.childNodes.at(-1) ?? null; }
	get isConnected() { return this === document.body || Boolean(this.parentNode?.isConnected); }
	get textContent() {
		return this.childNodes.map((one) => one instanceof Element ? one.textContent : one).join("");
	}
	set textContent(text) { this.replaceChildren(...text === "" ? [] : [String(text)]); }

	setAttribute(key, value) { this.#attributes.set(key, String(value)); }
	getAttribute(key) { return this.#attributes.get(key) ?? null; }
	removeAttribute(key) { this.#attributes.delete(key); }

	append(...nodes) {
		for (const node of nodes) {
			if (node instanceof Element) {
				node.remove();
				node.parentNode = this;
			}
			this.childNodes.push(node instanceof Element ? node : String(node));
		}
	}

	remove() {
		const from = this.parentNode?.childNodes;
		from?.splice(from.indexOf(this), 1);
		this.parentNode = null;
	}

	replaceChildren(...nodes) {
		for (const one of this.children)
			one.remove();
		this.childNodes = [];
		this.append(...nodes);
	}

	/** All below it, in the order of the document. */
	get all() { return this.children.flatMap((one) => [one, ...one.all]); }
	/** The first below it that is so. */
	find(is) { return this.all.find(is); }
	withText(text) { return this.find((one) => one.name === "button" && one.textContent === text); }
	contains(other) { return other === this || this.all.includes(other); }

	click() { this.dispatchEvent(new Event("click")); }
	submit() { this.dispatchEvent(new Event("submit", {cancelable: true})); }
	focus() { this.dispatchEvent(new Event("focus")); }
	select() {}
	showModal() { this.open = true; }
	close(value) {
		this.open = false;
		this.returnValue = value;
		this.dispatchEvent(new Event("close"));
	}
}

const body = new Element("body");
Object.assign(document, {
	body,
	activeElement: null,
	createElement: (name) => new Element(name),
	createElementNS: (_, name) => new Element(name),
	getElementById: (id) => body.find((one) => one.getAttribute("id") === id) ?? null,
	querySelectorAll: (selector) => body.all.filter((one) =>
		one.classList.contains(selector.slice(1))), // that of a class alone
});
for (const [name, id] of [["dialog", "command"], ["p", "announce"]]) {
	const one = new Element(name);
	one.setAttribute("id", id);
	body.append(one);
}
globalThis.requestAnimationFrame = (call) => call();
