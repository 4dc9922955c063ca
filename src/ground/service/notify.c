/* SPDX-License-Identifier: MIT */
/* The notification protocol of sd_notify(3): state, status and watchdog for the service manager. */
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "src/ground/service/notify.h"
#include "src/ground/text/printable.h"

/* With a manager that loads its units anew; in a container it takes ten datagrams meanwhile. */
#define PATIENCE_S 5

/* A whole number greater than 0, else 0. */
static int64_t positive(const char *text)
{
	char *end;
	long long number;

	if (!text || *text < '0' || *text > '9')
		return 0;
	errno = 0;
	number = strtoll(text, &end, 10);
	return errno || *end || number < 0 ? 0 : number;
}

static int64_t watchdog_ns(void)
{
	const char *pid = getenv("WATCHDOG_PID");
	int64_t us = positive(getenv("WATCHDOG_USEC"));

	if (pid && positive(pid) != (int64_t)getpid())
		return 0;
	return us > INT64_MAX / 1000 ? 0 : us * 1000;
}

int notify_open(struct notify *notify)
{
	const char *name = getenv("NOTIFY_SOCKET");
	size_t len;

	memset(notify, 0, sizeof(*notify));
	notify->fd = -1;
	if (!name || !*name)
		return 0;
	len = strlen(name);
	if ((name[0] != '/' && name[0] != '@') || len < 2 ||
	    len >= sizeof(notify->address.sun_path))
		return -EINVAL;
	notify->address.sun_family = AF_UNIX;
	memcpy(notify->address.sun_path, name, len);
	if (name[0] == '@')
		notify->address.sun_path[0] = '\0';
	else
		len++;
	notify->len = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + len);
	notify->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (notify->fd < 0)
		return -errno;
	setsockopt(notify->fd, SOL_SOCKET, SO_SNDTIMEO, &(struct timeval){.tv_sec = PATIENCE_S},
	           sizeof(struct timeval));
	notify->watchdog_ns = watchdog_ns();
	return 0;
}

void notify_close(struct notify *notify)
{
	if (notify->fd >= 0)
		close(notify->fd);
	notify->fd = -1;
}

static int send_text(struct notify *notify, const char *text, int flags)
{
	ssize_t sent = 0;

	if (notify->fd < 0)
		return 0;
	if (notify->deaf)
		flags |= MSG_DONTWAIT;
	do
		sent = sendto(notify->fd, text, strlen(text), flags | MSG_NOSIGNAL,
		              (const struct sockaddr *)&notify->address, notify->len);
	while (sent < 0 && errno == EINTR);
	if (sent >= 0)
		notify->deaf = false;
	else if (!(flags & MSG_DONTWAIT))
		notify->deaf = true;
	return sent < 0 ? -errno : 0;
}

int notify_send(struct notify *notify, enum notify_news news)
{
	static const char *const texts[] = {
		[NOTIFY_READY] = "READY=1",
		[NOTIFY_RELOADING] = "RELOADING=1",
		[NOTIFY_STOPPING] = "STOPPING=1",
		[NOTIFY_WATCHDOG] = "WATCHDOG=1",
	};
	struct timespec now;
	char text[64];

	if (news != NOTIFY_RELOADING)
		return send_text(notify, texts[news], news == NOTIFY_WATCHDOG ? MSG_DONTWAIT : 0);
	clock_gettime(CLOCK_MONOTONIC, &now);
	snprintf(text, sizeof(text), "%s\nMONOTONIC_USEC=%" PRId64, texts[news],
	         (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000);
	return send_text(notify, text, 0);
}

int notify_status(struct notify *notify, const char *format, ...)
{
	char text[7 + 256] = "STATUS=";
	va_list args;

	va_start(args, format);
	vsnprintf(text + 7, sizeof(text) - 7, format, args);
	va_end(args);
	/* systemd takes no status that is not UTF-8 */
	text[printable(text, printable_cut(text, sizeof(text) - 1))] = '\0';
	return send_text(notify, text, 0);
}
