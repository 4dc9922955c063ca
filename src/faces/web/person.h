/* SPDX-License-Identifier: MIT */
/* Who asks, and what that person may do. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define PERSON 32 /* as ows_for() takes it */

struct config_web;

enum person_deed {
	PERSON_LOOK,      /* all that reach the page */
	PERSON_WRITE,     /* outputs, acknowledgements */
	PERSON_CONFIGURE, /* the configuration */
};
/*
 * May the peer of this connection do that? With who it is in person: for a reverse proxy the one
 * that it names (http_named()). If not, the reason is in *why. Reads /etc/passwd and /etc/group.
 */
bool person_may_do(int fd, const struct config_web *options, enum person_deed deed,
                   const char *named, char person[PERSON], const char **why);
/* Is the peer the reverse proxy of Proxy: that user at the socket, or that address? */
bool person_is_proxy(int fd, const struct config_web *options);
/*
 * A number for who asks: the same for all connections of a user, of an address, or of a person that
 * the proxy names. Others have the same by a rare chance.
 */
uint64_t person_number(int fd, const struct config_web *options, const char *named);
/* Is it a TCP connection? Then local gets its address at this end. */
#define PERSON_ADDRESS 64
bool person_is_tcp(int fd, char local[PERSON_ADDRESS]);
