/* SPDX-License-Identifier: MIT */
/*
 * Reports a program's state to the service manager by the notification protocol of sd_notify(3):
 * datagrams to the socket named in NOTIFY_SOCKET. Without that variable all functions do nothing.
 *
 * Room src/ground/service: what a program in the background needs of the system: service manager,
 * signals, streams, listeners.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/un.h>

struct notify {
	int fd;    /* -1: there is no service manager */
	bool deaf; /* it took nothing in the time that is waited for it */
	socklen_t len;
	struct sockaddr_un address;
	int64_t watchdog_ns; /* send NOTIFY_WATCHDOG at least twice in this time; 0: not wanted */
};

enum notify_news {
	NOTIFY_READY,
	NOTIFY_RELOADING, /* followed by NOTIFY_READY when done */
	NOTIFY_STOPPING,
	NOTIFY_WATCHDOG,
};

/*
 * Read NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID. Returns 0, also when there is no service
 * manager; -EINVAL when NOTIFY_SOCKET is neither a path nor an abstract name, or is too long; or
 * another negative errno of socket().
 */
int notify_open(struct notify *notify);
void notify_close(struct notify *notify);

/*
 * Returns 0, or the negative errno of sending, which the caller may ignore. All but NOTIFY_WATCHDOG
 * wait for room up to 5 s, for they are told once: a unit whose NOTIFY_READY is lost never runs. A
 * manager that took nothing meanwhile is not waited for again until it takes something.
 */
int notify_send(struct notify *notify, enum notify_news news);
/* What `systemctl status` shows; cut at 255 bytes, control characters become '?'. */
int notify_status(struct notify *notify, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
