// SPDX-License-Identifier: MIT
// Keeps the files of the page, so that an installed page opens without owsd-web and says that it is
// not there. It keeps no answer of the api, so no value; and it asks owsd-web first, so a file of
// another version stays for no longer than owsd-web is away.
const KEPT = `owsd ${registration.scope}`;
const FILE = /^([\w-]+\.(js|css|svg|webmanifest))?$/;

async function answer(request, name) {
	const cache = await caches.open(KEPT);
	try {
		const fresh = await fetch(request);
		if (fresh.ok && !fresh.redirected && fresh.type === "basic")
			await cache.put(name, fresh.clone());
		return fresh;
	} catch (error) {
		const kept = await cache.match(name);
		if (!kept)
			throw error;
		return kept;
	}
}

addEventListener("install", () => skipWaiting());
addEventListener("activate", (event) => event.waitUntil(clients.claim()));
addEventListener("fetch", (event) => {
	const {request} = event, [path] = request.url.split(/[?#]/), {scope} = registration;
	const name = path.slice(scope.length);
	if (request.method === "GET" && path.startsWith(scope) && FILE.test(name))
		event.respondWith(answer(request, `${scope}${name}`));
});
addEventListener("notificationclick", (event) => {
	event.notification.close();
	event.waitUntil(clients.matchAll({type: "window"}).then(([page]) =>
		page ? page.focus() : clients.openWindow(`${registration.scope}#alarms`)));
});
