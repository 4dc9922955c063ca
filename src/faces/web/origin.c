/* SPDX-License-Identifier: MIT */
/* Names of this machine, and where a page comes from. */
#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "src/faces/web/origin.h"

#define NAME 256

/* The name or address of "name:port" and "[v6]:port". False: it is neither. */
static bool split(const char *host, char name[NAME])
{
	bool v6 = *host == '[';
	size_t len = v6 ? strcspn(++host, "]") : strcspn(host, ":");
	const char *rest = host + len;

	if (v6 && *rest++ != ']')
		return false;
	if (!len || len >= NAME || (*rest && *rest != ':'))
		return false;
	if (*rest == ':' && strspn(rest + 1, "0123456789") != strlen(rest + 1))
		return false;
	memcpy(name, host, len);
	name[len] = '\0';
	return true;
}

static bool is_address(const char *name, bool *loopback)
{
	struct in6_addr v6;
	struct in_addr v4;

	*loopback = false;
	if (inet_pton(AF_INET, name, &v4) == 1) {
		*loopback = ntohl(v4.s_addr) >> 24 == 127;
		return true;
	}
	if (inet_pton(AF_INET6, name, &v6) != 1)
		return false;
	*loopback = IN6_IS_ADDR_LOOPBACK(&v6);
	return true;
}

static bool is_listed(const char *name, const char *list)
{
	while (*(list += strspn(list, ", \t"))) {
		size_t len = strcspn(list, ", \t");

		if (strlen(name) == len && strncasecmp(name, list, len) == 0)
			return true;
		list += len;
	}
	return false;
}

bool origin_host(const char *host, const char *local, const char *machine, const char *list)
{
	char name[NAME], mdns[NAME];
	size_t len, label = strcspn(machine, ".");
	bool loopback;

	if (!split(host, name))
		return false;
	if (is_address(name, &loopback))
		return loopback || strcasecmp(name, local) == 0;
	if (*host == '[')
		return false;
	len = strlen(name);
	if (len > 1 && name[len - 1] == '.')
		name[len - 1] = '\0';
	snprintf(mdns, sizeof(mdns), "%.*s.local", (int)label, machine);
	return strcasecmp(name, "localhost") == 0 || strcasecmp(name, machine) == 0 ||
	       (label && strlen(name) == label && strncasecmp(name, machine, label) == 0) ||
	       (label && strcasecmp(name, mdns) == 0) || (list && is_listed(name, list));
}

/* Is the page of that Origin one of that Host? */
static bool is_same(const char *origin, const char *host)
{
	const char *at = strstr(origin, "://");

	return at && (!strncmp(origin, "http:", 5) || !strncmp(origin, "https:", 6)) &&
	       at - origin <= 5 && strcasecmp(at + 3, host) == 0;
}

bool origin_foreign(const char *host, const char *origin, const char *site)
{
	/* none: somebody entered the address. same-site: another port or name of this machine */
	if (site && strcmp(site, "same-origin") != 0 && strcmp(site, "none") != 0)
		return true;
	return origin && (!host || !is_same(origin, host));
}
