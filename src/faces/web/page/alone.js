// SPDX-License-Identifier: MIT
// What is asked for again and again, and may take longer than the time between.

/** A call that is left out while the one before goes on. */
export function alone(call) {
	let running = false;
	return async () => {
		if (running)
			return;
		running = true;
		try {
			await call();
		} finally {
			running = false;
		}
	};
}
