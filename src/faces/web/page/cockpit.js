// SPDX-License-Identifier: MIT
// The way to owsd-web within Cockpit: its bridge opens the socket as the user who is logged in.

const DIRECTORY = "/run/owsd";
const AGAIN = 2000; // until a stream that has ended is asked for again
const DENIED = 15000; // and where that was refused: each refusal is in the log of the bridge
const CHOSEN = "owsd.instance";

/** Parts of a stream of events, as a text that comes in pieces; what begins is not kept. */
export function reader(event) {
	let left = "", type = "", data = [], id = "";
	const line = (text) => {
		if (!text) {
			if (data.length)
				event(type || "message", data.join("\n"), id);
			type = "";
			data = [];
			return;
		}
		const colon = text.indexOf(":");
		const name = colon < 0 ? text : text.slice(0, colon);
		const value = colon < 0 ? "" : text.slice(colon + 1).replace(/^ /, "");
		if (name === "event")
			type = value;
		else if (name === "data")
			data.push(value);
		else if (name === "id")
			id = value;
	};
	return (text) => {
		const lines = (left + text).split("\n");
		left = lines.pop();
		for (const one of lines)
			line(one);
	};
}

/** The instances that have a page, by their sockets. */
function look(cockpit) {
	return new Promise((resolve, reject) => {
		const names = [];
		const channel = cockpit.channel({payload: "fslist1", path: DIRECTORY, watch: false});
		channel.addEventListener("message", (_, text) => {
			const {event, path} = JSON.parse(text);
			if (event === "present" && path?.endsWith(".web"))
				names.push(path.slice(0, -4));
		});
		channel.addEventListener("close", (_, {problem}) => {
			if (problem && problem !== "not-found")
				reject({problem});
			else
				resolve(names.sort());
		});
	});
}

function words({problem, message}, name) {
	if (problem === "access-denied")
		return `no connection to owsd-web: only members of the group owsd may open`
			+ ` ${DIRECTORY}/${name}.web`;
	if (problem === "not-found")
		return `no connection to owsd-web: there is no socket ${DIRECTORY}/${name ?? "*"}.web;`
			+ ` systemctl enable --now owsd-web@${name ?? "OWS"}.socket makes it`;
	if (problem === "timeout")
		return "owsd-web does not answer in time";
	return `no connection to owsd-web: ${message || problem || "the connection has ended"}`;
}

export function way(cockpit, patience) {
	// name: null, its socket is to be looked for; mine: that of the instance which the page shows
	let name = null, mine, superuser; // superuser: the person's own rights do not suffice

	async function client() {
		if (!name) {
			const names = await look(cockpit);
			const chosen = sessionStorage.getItem(CHOSEN);
			mine ??= names.includes(chosen) ? chosen : names[0];
			if (!names.includes(mine))
				throw {problem: "not-found"}; // another instance has other outputs
			name = mine;
		}
		return cockpit.http(`${DIRECTORY}/${name}.web`, superuser ? {superuser} : {});
	}

	/** After a fault: once more with administrative access, if Cockpit has it and it is needed. */
	function again({problem}, tried) {
		if (problem === "not-found")
			name = null; // it may be there next time
		if (problem !== "access-denied" || tried)
			return false;
		superuser = "try";
		return true;
	}

	async function ask(path, options = {}) {
		const {method = "GET", headers = {}, body = ""} = options, tried = superuser;
		try {
			const http = await client();
			return await new Promise((resolve, reject) => {
				const request = http.request({method, path: `/${path}`, headers, body});
				const timer = setTimeout(() => request.close("timeout"),
					options.patience ?? patience);
				request.then((text) => resolve({status: 200, text}), (fault, text) =>
					fault.status ? resolve({status: fault.status, text: text ?? ""})
						: reject(fault));
				const done = () => clearTimeout(timer);
				request.then(done, done);
			});
		} catch (fault) {
			const why = words(fault, mine);
			if (again(fault, tried))
				return ask(path, options);
			throw new Error(why, {cause: fault});
		}
	}

	function events(path, types, {opened, failed, event}) {
		let id = "", closed = false, request = null;
		const known = new Set(types);
		const end = (fault, tried) => {
			if (closed)
				return;
			const why = fault?.problem && words(fault, mine);
			if (fault && again(fault, tried)) {
				begin();
				return;
			}
			failed(false, why);
			setTimeout(begin, fault?.problem === "access-denied" ? DENIED : AGAIN);
		};
		async function begin() {
			if (closed)
				return;
			const tried = superuser;
			try {
				const http = await client();
				const read = reader((type, data, newest) => {
					id = newest || id;
					if (!closed && known.has(type))
						event(type, data, id);
				});
				request = http.request({method: "GET", path: `/${path}`, body: "",
					headers: {Accept: "text/event-stream", ...(id && {"Last-Event-ID": id})}});
				request.response((status) => status === 200 && !closed && opened());
				request.stream(read);
				request.then(() => end(), (fault) => end(fault, tried));
				if (closed)
					request.close();
			} catch (fault) {
				end(fault, tried);
			}
		}
		begin();
		return {
			close() {
				closed = true;
				request?.close();
			},
		};
	}

	return {
		ask, events,
		instances: () => look(cockpit).catch(() => []),
		choose(wanted) {
			sessionStorage.setItem(CHOSEN, wanted);
			location.reload();
		},
	};
}
