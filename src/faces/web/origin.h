/* SPDX-License-Identifier: MIT */
/* From which page a browser asks, by the headers Host and Origin. Pure functions. */
#pragma once

#include <stdbool.h>

/*
 * May a browser know this machine by that Host? An address: if it is of the loopback, or the local
 * one of the connection (as inet_ntop() prints it). A name: localhost, that of the machine with or
 * without its domain, its name in .local, or one of the list. Any other name may be of a page whose
 * server gave the name this machine's address.
 */
bool origin_host(const char *host, const char *local, const char *machine, const char *list);
/*
 * Does a browser send this for a page of another origin? By the headers Host, Origin and
 * Sec-Fetch-Site; each may be NULL: it was not sent. What is no browser sends neither of the last.
 */
bool origin_foreign(const char *host, const char *origin, const char *site);
