// SPDX-License-Identifier: MIT
// A draft survives that the page is loaded anew.

const KEY = `owsd-draft ${location.pathname}`;

export function remember(draft) {
	if (!draft.ready)
		return;
	try {
		if (draft.dirty)
			sessionStorage.setItem(KEY, JSON.stringify({file: draft.info.file, base: draft.base,
				text: draft.text}));
		else
			sessionStorage.removeItem(KEY);
	} catch {
		// no room: the warning before the page is left has to do
	}
}

export function recall(file) {
	try {
		const kept = JSON.parse(sessionStorage.getItem(KEY));
		return kept.file === file && typeof kept.text === "string"
			&& typeof kept.base.text === "string" ? kept : null;
	} catch {
		return null;
	}
}
