/* SPDX-License-Identifier: MIT */
/*
 * Netlink family KOBJECT_UEVENT: a datagram each, "add@/devices/..." and NAME=VALUE, each with NUL.
 */
#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/w1/uevent.h"

#define FROM_KERNEL 1 /* group; udev's own is 2 */
#define EVENT_MAX 4096

int w1_uevents_open(void)
{
	struct sockaddr_nl address = {.nl_family = AF_NETLINK, .nl_groups = FROM_KERNEL};
	int uevents = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK,
	                     NETLINK_KOBJECT_UEVENT);

	if (uevents >= 0 && bind(uevents, (struct sockaddr *)&address, sizeof(address)) < 0)
		w1_uevents_close(&uevents);
	return uevents;
}

void w1_uevents_close(int *uevents)
{
	if (*uevents >= 0)
		close(*uevents);
	*uevents = -1;
}

static bool is_ours(const char *text, size_t n)
{
	static const char ours[] = "SUBSYSTEM=w1";

	for (size_t at = 0; at < n;) {
		size_t len = strnlen(text + at, n - at);

		if (len == sizeof(ours) - 1 && memcmp(text + at, ours, len) == 0)
			return true;
		at += len + 1;
	}
	return false;
}

bool w1_uevents_taken(int uevents)
{
	char text[EVENT_MAX];
	bool taken = false;

	while (uevents >= 0) {
		struct sockaddr_nl from = {0};
		socklen_t room = sizeof(from);
		ssize_t n = recvfrom(uevents, text, sizeof(text), MSG_DONTWAIT,
		                     (struct sockaddr *)&from, &room);

		if (n < 0 && errno == ENOBUFS)
			taken = true;
		else if (n < 0)
			break;
		else if (from.nl_family != AF_NETLINK || from.nl_pid == 0)
			taken |= is_ours(text, (size_t)n);
	}
	return taken;
}
